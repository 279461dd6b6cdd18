/* SPDX-License-Identifier: MIT */
/* steradian-mpi whose units are slept instead of rendered: deals, messages, batches and the film are the real ones, and
 * only what a unit costs comes from a log. So any number of ranks can be timed by the clock on a machine that has fewer
 * processors, and compared with bench/simulate-ranks.
 *
 *     efficiency = sum of what the units cost / (threads of all ranks * time of the pass)
 *
 * A sleep ends late by a while; so much less is slept in the thread's next one. Limits: the film holds sums of colour
 * and what is seen first, no splats and no spectra; ranks are on one machine, so that messages go through its memory.
 */
#define _POSIX_C_SOURCE 200809L
#include "recorded.h"

#include "../tools/steradian-mpi/ranks.h"
#include "render/private.h"
#include "render_command.h"

#include <mpi.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char help[] =
    "Usage: mpirun -n N [--oversubscribe] rehearse-ranks UNIT-LOG [OPTIONS]\n"
    "\n"
    "Deals the units of steradian-mpi --unit-log to N ranks, as steradian-mpi does, and sleeps what each has cost. Prints\n"
    "ranks, cores, time [s], efficiency, messages, bytes and the share of the time that rank 0 takes sums in.\n"
    "\n"
    "      --threads T      of each rank (default: 1)\n"
    "      --samples K      each unit costs K times as much (default: 1)\n"
    "      --pixels K       K pictures below each other (default: 1)\n"
    "      --unit-log FILE  a log of the rehearsal\n";

/* What steradian-mpi has of the command `render`. */
struct render_crew render_crew;
atomic_bool render_interrupted;
void hush_end(void)
{
}

struct rehearsal {
    struct crew *crew;
    struct recorded log;
    double samples;
    uint32_t pixels;
    struct sr_film *film;
    struct sr_crew_batches *batches;
    atomic_uint *tile_blocks;
    pthread_rwlock_t film_lock;
    struct ending ending;
};

static double nap(double s)
{
    double start_s = sr_clock_s();
    if (s > 0)
        nanosleep(&(struct timespec){(time_t)s, (long)((s - (double)(time_t)s) * 1e9)}, NULL);
    return sr_clock_s() - start_s;
}

static void work(void *context, int thread)
{
    (void)thread;
    struct rehearsal *r = context;
    const struct recorded *log = &r->log;
    uint32_t most = 0;
    for (uint32_t i = 0; i < log->tiles; ++i)
        most = log->of_tile[i].width * log->of_tile[i].height > most ? log->of_tile[i].width * log->of_tile[i].height
                                                                     : most;
    struct sr_film_block *blocks = sr_alloc(most * sizeof *blocks);
    double late_s = 0;
    uint64_t unit;
    for (uint32_t i = 0; blocks && i < most; ++i)
        blocks[i] = (struct sr_film_block){.n = 1};
    while (blocks && r->crew->hooks.next(r->crew, &unit)) {
        uint32_t tiles = log->tiles * r->pixels, tile = (uint32_t)(unit % tiles), block = (uint32_t)(unit / tiles);
        const struct recorded_tile *t = &log->of_tile[tile / r->pixels];
        uint32_t y0 = t->y + tile % r->pixels * log->height, count = t->width * t->height;
        struct sr_crew_unit u = {.tile = tile,
                                 .block = block,
                                 .x0 = t->x,
                                 .y0 = y0,
                                 .x1 = t->x + t->width,
                                 .y1 = y0 + t->height,
                                 .cost_s = log->cost_s[(size_t)(tile / r->pixels) * log->blocks + block] * r->samples};
        struct sr_film *splats;
        struct sr_crew_batch *batch = r->batches ? sr_crew_enter(r->batches, &splats) : NULL;
        late_s += nap(u.cost_s - late_s) - u.cost_s;
        while (atomic_load(&r->tile_blocks[tile]) != block)
            nap(1e-4); // a thread that renders yields; here others want its processor
        if (batch) {
            sr_crew_leave(r->batches, batch, &u, count, blocks, NULL, &(struct sr_render_counts){0});
        } else {
            pthread_rwlock_rdlock(&r->film_lock);
            for (uint32_t i = 0; i < count; ++i)
                sr_film_store(r->film, u.x0 + i % t->width, u.y0 + i / t->width, &blocks[i]);
            r->crew->hooks.note(r->crew, &u);
            pthread_rwlock_unlock(&r->film_lock);
        }
        atomic_store(&r->tile_blocks[tile], block + 1);
    }
    sr_free(blocks);
}

static void take(void *run, const void *bytes, size_t size)
{
    struct rehearsal *r = run;
    struct sr_crew_reader reader = {.film = r->film, .crew = &r->crew->hooks};
    pthread_rwlock_rdlock(&r->film_lock);
    sr_crew_read(&reader, bytes, size);
    pthread_rwlock_unlock(&r->film_lock);
}

static void tick(void *run)
{
    (void)run;
}

static sr_status rehearse(struct rehearsal *r, struct sr_error *error)
{
    struct crew *c = r->crew;
    const struct sr_render_crew *hooks = &c->hooks;
    int32_t width = (int32_t)r->log.width, height = (int32_t)(r->log.height * r->pixels);
    struct sr_render_job job = {.film = {.width = width,
                                         .height = height,
                                         .x1 = width,
                                         .y1 = height,
                                         .iso = 100,
                                         .exposure_time = 1,
                                         .max_component = INFINITY},
                                .with_aov = true,
                                .crew = hooks};
    struct sr_crew_pass pass = {.tiles = r->log.tiles * r->pixels,
                                .blocks = r->log.blocks,
                                .threads = c->place.all[c->place.rank].threads,
                                .run = r,
                                .take = take,
                                .tick = tick};
    pthread_rwlock_init(&r->film_lock, NULL);
    r->tile_blocks = sr_alloc(pass.tiles * sizeof *r->tile_blocks);
    if (!r->tile_blocks)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    sr_status status = sr_crew_film_create(&job, &r->film, error);
    if (status == SR_OK && hooks->is_helper && !(r->batches = sr_crew_batches_create(&job, r->film, error)))
        status = error->status;
    if (status == SR_OK)
        status = hooks->meet(c, error);
    if (status == SR_OK)
        status = hooks->begin(c, &pass, error);
    if (status == SR_OK) {
        sr_parallel(pass.threads, work, r);
        if (r->batches && !sr_crew_finish(r->batches))
            return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
        status = hooks->end(c, false, error);
    }
    return status;
}

static void *rehearse_in_thread(void *p)
{
    struct rehearsal *r = p;
    struct sr_error error = {0};
    sr_status status = rehearse(r, &error);
    if (status != SR_OK)
        fprintf(stderr, "rehearse-ranks: error: %s\n", error.text);
    pthread_mutex_lock(&r->crew->lock);
    r->ending.code = (int)status;
    r->ending.is_ended = true;
    pthread_mutex_unlock(&r->crew->lock);
    return NULL;
}

int main(int argc, char **argv)
{
    static struct crew crew;
    static struct rehearsal r = {.crew = &crew, .samples = 1, .pixels = 1};
    const char *path = NULL, *unit_log = NULL;
    int provided, threads = 1;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    for (int i = 1; i < argc; ++i) {
        const char *value = i + 1 < argc ? argv[i + 1] : "0";
        if (strcmp(argv[i], "--threads") == 0)
            threads = atoi(value), ++i;
        else if (strcmp(argv[i], "--samples") == 0)
            r.samples = atof(value), ++i;
        else if (strcmp(argv[i], "--pixels") == 0)
            r.pixels = (uint32_t)atoi(value), ++i;
        else if (strcmp(argv[i], "--unit-log") == 0)
            unit_log = value, ++i;
        else
            path = argv[i];
    }
    place_find(&crew.place, true, threads);
    bool is_owner = crew.place.rank == 0;
    int code = SR_ERROR_USAGE;
    if (!path || path[0] == '-' || threads < 1 || r.pixels < 1 || !(r.samples > 0) || !recorded_read(path, &r.log)) {
        if (is_owner)
            fputs(help, stderr);
    } else {
        crew_begin(&crew);
        render_crew = (struct render_crew){
            .hooks = &crew.hooks, .identity = "a rehearsal\n", .threads = threads, .processes = crew.place.renderers};
        if (!unit_log_open(&crew, unit_log))
            MPI_Abort(MPI_COMM_WORLD, SR_ERROR_RESOURCE);
        pthread_t thread;
        if (pthread_create(&thread, NULL, rehearse_in_thread, &r) != 0)
            MPI_Abort(MPI_COMM_WORLD, SR_ERROR_RESOURCE);
        code = pump(&crew, &r.ending);
        pthread_join(thread, NULL);
        unit_log_close(&crew);
        double cost_s = recorded_total_s(&r.log) * r.samples * r.pixels;
        if (is_owner && !code)
            printf("%d\t%u\t%.4f\t%.4f\t%llu\t%llu\t%.5f\n", crew.place.renderers, crew.pool.threads, crew.passes_s,
                   cost_s / (crew.pool.threads * crew.passes_s), (unsigned long long)crew.messages,
                   (unsigned long long)crew.message_B, crew.took_s / crew.passes_s);
    }
    fflush(NULL);
    MPI_Finalize();
    return is_owner ? code : 0;
}
