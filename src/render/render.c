/* SPDX-License-Identifier: MIT */
/* Work units and workers: every tile gets its blocks of samples in order, and any thread may make any of them. */
#define _POSIX_C_SOURCE 200809L
#include "render/private.h"

#include <pthread.h>
#include <sched.h>
#include <string.h>
#include <time.h>

enum { DEFAULT_TILE = 16, ORDINARY_BLOCKS = 4 };
struct run {
    const struct sr_render_job *job;
    const struct sr_render_pass *pass;
    struct sr_film *film;
    struct sr_picture picture;
    uint32_t tile, tiles_x, tiles_y, blocks;
    uint32_t first_block, end_block; // that are to be made
    struct sr_render_report base;  // of what came before this pass
    uint32_t *had;                 // blocks of each pixel that a resumed render began with; NULL: a new one
    atomic_ullong next_unit;
    atomic_uint *tile_blocks;      // how many blocks of a tile are in the film
    atomic_ullong rays, shadow_rays, vertices, paths, dropped; // of what is in the film
    atomic_ullong units_done;
    atomic_bool cancelled;
    pthread_rwlock_t film_lock;    // stores share it, whoever looks at the whole film has it alone
    pthread_mutex_t gate_lock;     // guards the gate: where units change the film long before they store, none may be under way
    pthread_cond_t gate;
    uint32_t active;               // workers that are past the gate
    bool is_closed;
    pthread_mutex_t progress_lock; // guards the members below; locks are taken in this order: gate, progress, film
    double last_progress_s;
    uint32_t first_dropped[4];     // x, y, replicate, sample
    bool has_dropped;
    struct sr_film_block *scratch; // tile * tile for each thread
    struct sr_block_tree *trees;   // one for each thread
    double *buckets;               // as many times the film's buckets; NULL: it has none
    void *shared;                  // of the integrator's samples
    struct sr_crew_batches *batches; // NULL: the film is here, else where a helper's units go
};

/* ---- one unit: a tile times a block ---- */

bool sr_render_is_earlier(const uint32_t a[4], const uint32_t b[4])
{
    static const int order[4] = {1, 0, 2, 3};
    for (int i = 0; i < 4; ++i)
        if (a[order[i]] != b[order[i]])
            return a[order[i]] < b[order[i]];
    return false;
}

static void remember_dropped(struct run *run, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample)
{
    pthread_mutex_lock(&run->progress_lock);
    // the first in picture order, so that the report does not depend on who was faster
    uint32_t now[4] = {x, y, replicate, sample};
    if (!run->has_dropped || sr_render_is_earlier(now, run->first_dropped)) {
        memcpy(run->first_dropped, now, sizeof now);
        run->has_dropped = true;
    }
    pthread_mutex_unlock(&run->progress_lock);
}

static bool is_cancelled(struct run *run)
{
    if (run->job->cancel && atomic_load_explicit(run->job->cancel, memory_order_relaxed))
        atomic_store_explicit(&run->cancelled, true, memory_order_relaxed);
    return atomic_load_explicit(&run->cancelled, memory_order_relaxed);
}

/* Of a block's samples begin <= i < end, those that the pass is to take: all, or those of a part. */
static void clip(const struct sr_render_pass *pass, uint64_t block_begin, uint32_t *begin, uint32_t *end)
{
    int64_t lo = (int64_t)pass->range.begin - (int64_t)block_begin, hi = (int64_t)pass->range.end - (int64_t)block_begin;
    *begin = lo > *begin ? (uint32_t)lo : *begin;
    *end = hi < *end ? (uint32_t)hi : *end;
}

/* The samples of one pixel in one block; false: cancelled, nothing of it counts. */
static bool fill_block(struct run *run, uint32_t x, uint32_t y, uint32_t block, struct sr_block_tree *tree, struct sr_splatting *splatting, struct sr_worker *worker)
{
    const struct sr_render_job *job = run->job;
    const struct sr_render_pass *pass = run->pass;
    uint32_t pixel = (y - (uint32_t)job->film.y0) * run->film->width + x - (uint32_t)job->film.x0;
    uint32_t replicate = 0, begin = 0, end = pass->counts ? pass->counts[pixel] : pass->per_replicate;
    if (end > 0)
        replicate = pass->first_replicate + block;
    else {
        begin = (uint32_t)((uint64_t)job->spp * block / run->blocks);
        end = (uint32_t)((uint64_t)job->spp * (block + 1) / run->blocks);
    }
    uint32_t from = begin, to = end;
    if (pass->part)
        clip(pass, pass->per_replicate ? (uint64_t)block * pass->per_replicate : 0, &from, &to);
    struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, x, y, replicate, from);
    worker->replicate = replicate;
    if (splatting)
        splatting->group = block % splatting->film->splats->groups;
    sr_block_tree_begin(tree, from - begin);
    uint32_t together = splatting ? 1 : SR_PICTURE_SAMPLES; // what has been splatted must stay: one after the other
    for (uint32_t i = from, count; i < to; i += count) {
        count = to - i < together ? to - i : together;
        sampler.sample = i;
        if (splatting) {
            sr_splatting_aim(splatting, pixel, replicate, i);
            if (job->integrator.model->splat)
                sr_picture_splat(&run->picture, worker);
        }
        struct sr_picture_sample samples[SR_PICTURE_SAMPLES];
        sr_picture_samples(&run->picture, x, y, &sampler, count, job->with_aov, samples, worker);
        for (uint32_t k = 0; k < count; ++k) {
            const struct sr_picture_sample *s = &samples[k];
            double *buckets;
            struct sr_film_block *b = sr_block_tree_sample(tree, &buckets);
            if (SR_UNLIKELY(!s->is_finite))
                remember_dropped(run, x, y, replicate, i + k);
            if (SR_UNLIKELY(buckets))
                sr_picture_add_to_buckets(&run->picture, s, buckets);
            sr_film_block_add(b, s->rgb, s->is_finite);
            if (job->with_aov)
                sr_film_block_add_first(b, &s->first);
            sr_block_tree_done(tree);
        }
        if (!splatting && is_cancelled(run))
            break;
    }
    if (splatting)
        sr_film_splat_paths(splatting->film, splatting->group, tree->next - tree->first);
    if (to - from == end - begin)
        sr_block_tree_fold(tree);
    return tree->next == to - begin;
}

/* Blocks of a tile go in by their order; false: cancelled before. The one before is being made by a thread that does not wait for us. */
static bool wait_for_turn(struct run *run, uint32_t tile, uint32_t block)
{
    while (atomic_load_explicit(&run->tile_blocks[tile], memory_order_acquire) != block) {
        if (is_cancelled(run))
            return false;
        sched_yield();
    }
    return true;
}

/* Whether the pixel's block came from a checkpoint. */
static bool is_there(const struct run *run, uint32_t x, uint32_t y, uint32_t block)
{
    return SR_UNLIKELY(run->had != NULL) && run->had[(size_t)y * run->film->width + x] > run->pass->blocks_before + block - run->first_block;
}

/* The unit's pixels go into the film, as many as are done. */
static void store_unit(struct run *run, const struct sr_crew_unit *u, uint32_t done, const struct sr_film_block *blocks, const double *buckets)
{
    uint32_t width = u->x1 - u->x0;
    for (uint32_t i = 0; i < done; ++i) {
        uint32_t x = u->x0 + i % width, y = u->y0 + i / width;
        if (is_there(run, x, y, u->block))
            continue;
        if (run->pass->part) {
            run->film->pixels[(size_t)y * run->film->width + x].blocks += 1;
            continue;
        }
        if (buckets)
            sr_film_store_buckets(run->film, x, y, buckets + (size_t)i * run->picture.response.buckets);
        sr_film_store(run->film, x, y, &blocks[i]);
    }
    const struct sr_render_crew *crew = run->job->crew;
    if (crew && crew->note)
        crew->note(crew->self, u);
}

static void count(struct run *run, const struct sr_render_counts *c)
{
    atomic_fetch_add_explicit(&run->paths, c->paths, memory_order_relaxed);
    atomic_fetch_add_explicit(&run->dropped, c->dropped, memory_order_relaxed);
    atomic_fetch_add_explicit(&run->rays, c->rays, memory_order_relaxed);
    atomic_fetch_add_explicit(&run->shadow_rays, c->shadow_rays, memory_order_relaxed);
    atomic_fetch_add_explicit(&run->vertices, c->vertices, memory_order_relaxed);
}

/* [s] of a processor that this thread has had. */
static double thread_clock_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Cancelled, the pixels that are done come in; with splats that takes one pixel's block at most, without no time. */
static bool do_unit(struct run *run, uint64_t unit, struct sr_film_block *scratch, double *buckets, struct sr_block_tree *tree, struct sr_splatting *splatting, struct sr_worker *worker)
{
    uint32_t tiles = run->tiles_x * run->tiles_y, tile = (uint32_t)(unit % tiles), block = run->first_block + (uint32_t)(unit / tiles);
    struct sr_crew_unit u = {.tile = tile, .block = block, .x0 = tile % run->tiles_x * run->tile, .y0 = tile / run->tiles_x * run->tile};
    u.x1 = u.x0 + run->tile < run->film->width ? u.x0 + run->tile : run->film->width;
    u.y1 = u.y0 + run->tile < run->film->height ? u.y0 + run->tile : run->film->height;
    uint32_t left = (uint32_t)run->film->settings.x0, top = (uint32_t)run->film->settings.y0;
    uint32_t width = u.x1 - u.x0, pixels = width * (u.y1 - u.y0), done = 0;
    struct sr_render_part *part = run->pass->part;
    struct sr_render_counts counts = {0};
    if (splatting && !wait_for_turn(run, tile, block)) // once it has begun it comes in
        return false;
    struct sr_film *splats = run->film;
    struct sr_crew_batch *batch = run->batches ? sr_crew_enter(run->batches, &splats) : NULL;
    if (splatting)
        splatting->film = splats;
    double start_s = thread_clock_s();
    for (; done < pixels; ++done) {
        uint32_t x = u.x0 + done % width, y = u.y0 + done / width;
        if (is_there(run, x, y, block))
            continue;
        if (is_cancelled(run) || !fill_block(run, left + x, top + y, block, tree, splatting, worker))
            break;
        counts.paths += tree->next - tree->first;
        for (uint32_t i = 0; i < tree->depth; ++i)
            counts.dropped += tree->nodes[i].dropped;
        counts.rays = worker->rays, counts.shadow_rays = worker->shadow_rays, counts.vertices = worker->vertices;
        if (part) { // not while a checkpoint reads it
            pthread_rwlock_rdlock(&run->film_lock);
            sr_part_keep(part, block, x, y, tree);
            pthread_rwlock_unlock(&run->film_lock);
            continue;
        }
        scratch[done] = tree->nodes[0];
        if (buckets)
            memcpy(buckets + (size_t)done * tree->bucket_count, tree->buckets, tree->bucket_count * sizeof *buckets);
    }
    u.cost_s = thread_clock_s() - start_s;
    worker->rays = worker->shadow_rays = worker->vertices = 0;
    if (!wait_for_turn(run, tile, block)) {
        done = 0;
        counts = (struct sr_render_counts){0};
    }
    if (batch) {
        pthread_mutex_lock(&run->progress_lock);
        counts.has_dropped = run->has_dropped;
        memcpy(counts.first_dropped, run->first_dropped, sizeof counts.first_dropped);
        pthread_mutex_unlock(&run->progress_lock);
        sr_crew_leave(run->batches, batch, &u, done, scratch, buckets, &counts);
    } else if (done) {
        pthread_rwlock_rdlock(&run->film_lock);
        store_unit(run, &u, done, scratch, buckets);
        count(run, &counts);
        pthread_rwlock_unlock(&run->film_lock);
    }
    if (done < pixels)
        return false;
    atomic_store_explicit(&run->tile_blocks[tile], block + 1, memory_order_release);
    return true;
}

/* ---- what looks at the whole film while it grows ---- */

static void pass_gate(struct run *run)
{
    pthread_mutex_lock(&run->gate_lock);
    while (run->is_closed)
        pthread_cond_wait(&run->gate, &run->gate_lock);
    run->active += 1;
    pthread_mutex_unlock(&run->gate_lock);
}

static void leave_gate(struct run *run)
{
    pthread_mutex_lock(&run->gate_lock);
    if (--run->active == 0)
        pthread_cond_broadcast(&run->gate);
    pthread_mutex_unlock(&run->gate_lock);
}

static void hold(void *user)
{
    struct run *run = user;
    pthread_mutex_lock(&run->gate_lock);
    run->is_closed = true;
    while (run->active > 0)
        pthread_cond_wait(&run->gate, &run->gate_lock);
    pthread_mutex_unlock(&run->gate_lock);
    pthread_mutex_lock(&run->progress_lock);
    pthread_rwlock_wrlock(&run->film_lock);
}

static void let_go(void *user)
{
    struct run *run = user;
    pthread_rwlock_unlock(&run->film_lock);
    pthread_mutex_unlock(&run->progress_lock);
    pthread_mutex_lock(&run->gate_lock);
    run->is_closed = false;
    pthread_cond_broadcast(&run->gate);
    pthread_mutex_unlock(&run->gate_lock);
}

static void add_to_report(const struct run *run, struct sr_render_report *report)
{
    *report = run->base;
    report->paths += run->paths;
    report->rays += run->rays;
    report->shadow_rays += run->shadow_rays;
    report->vertices += run->vertices;
    report->dropped += run->dropped;
    if (run->has_dropped) {
        report->dropped_x = run->first_dropped[0], report->dropped_y = run->first_dropped[1];
        report->dropped_replicate = run->first_dropped[2], report->dropped_sample = run->first_dropped[3];
    }
    report->render_s = sr_clock_s() - run->pass->start_s;
    report->is_complete = !run->cancelled;
}

static uint64_t units_of(const struct run *run)
{
    return (uint64_t)run->tiles_x * run->tiles_y * (run->end_block - run->first_block);
}

/* Share of the whole work that is done [1]. */
static double share_of(const struct run *run, uint64_t units_done)
{
    const struct sr_render_pass *pass = run->pass;
    double share = (double)units_done / (double)units_of(run);
    return pass->share_begin + share * (pass->share_end - pass->share_begin);
}

static double tell(void *user, struct sr_render_report *report)
{
    struct run *run = user;
    add_to_report(run, report);
    return share_of(run, run->units_done);
}

static void tell_progress(struct run *run, uint64_t units_done)
{
    const struct sr_render_job *job = run->job;
    if (!job->progress || pthread_mutex_trylock(&run->progress_lock) != 0)
        return;
    double now = sr_clock_s();
    if (now - run->last_progress_s >= job->progress_interval_s) {
        run->last_progress_s = now;
        double elapsed = now - run->pass->start_s, share = share_of(run, units_done);
        pthread_rwlock_wrlock(&run->film_lock);
        struct sr_render_progress p = {
            .share = share, .elapsed_s = elapsed, .left_s = share > 0 ? elapsed * (1 - share) / share : NAN,
            .rays = run->base.rays + run->base.shadow_rays + atomic_load(&run->rays) + atomic_load(&run->shadow_rays), .film = run->film,
        };
        job->progress(job->user, &p);
        pthread_rwlock_unlock(&run->film_lock);
    }
    pthread_mutex_unlock(&run->progress_lock);
}

static bool next_unit(struct run *run, uint64_t *unit)
{
    const struct sr_render_crew *crew = run->job->crew;
    if (crew)
        return crew->next(crew->self, unit);
    *unit = atomic_fetch_add_explicit(&run->next_unit, 1, memory_order_relaxed);
    return *unit < units_of(run);
}

static void work(void *context, int thread)
{
    struct run *run = context;
    struct sr_film_block *scratch = run->scratch + (size_t)thread * run->tile * run->tile;
    double *buckets = run->buckets ? run->buckets + (size_t)thread * run->tile * run->tile * run->picture.response.buckets : NULL;
    struct sr_block_tree *tree = &run->trees[thread];
    struct sr_splatting splatting = sr_splatting_begin(&run->picture);
    splatting.target.user = &splatting;
    bool splats = run->film->splats != NULL;
    struct sr_worker worker = {.log = thread == 0 ? run->job->log : NULL, .target = splats ? &splatting.target : NULL, .shared = run->shared};
    for (;;) {
        if (splats)
            pass_gate(run);
        uint64_t unit;
        bool is_done = !is_cancelled(run) && next_unit(run, &unit) && do_unit(run, unit, scratch, buckets, tree, splats ? &splatting : NULL, &worker);
        if (splats)
            leave_gate(run);
        if (!is_done)
            break;
        tell_progress(run, atomic_fetch_add_explicit(&run->units_done, 1, memory_order_relaxed) + 1);
    }
}

/* ---- a crew ---- */

static void take_batch(void *context, const void *bytes, size_t size)
{
    struct run *run = context;
    struct sr_crew_reader reader = {.film = run->film, .crew = run->job->crew, .had = run->had, .blocks_before = run->pass->blocks_before};
    pthread_rwlock_rdlock(&run->film_lock);
    sr_crew_read(&reader, bytes, size);
    count(run, &reader.counts);
    pthread_rwlock_unlock(&run->film_lock);
    atomic_fetch_add_explicit(&run->units_done, reader.units, memory_order_relaxed);
    const uint32_t *d = reader.counts.first_dropped;
    if (reader.counts.has_dropped)
        remember_dropped(run, d[0], d[1], d[2], d[3]);
}

static void tick(void *context)
{
    struct run *run = context;
    tell_progress(run, atomic_load(&run->units_done));
}

/* The threads of this process, and what they make together with those of others. */
static sr_status work_all(struct run *run, int threads, struct sr_error *error)
{
    const struct sr_render_job *job = run->job;
    const struct sr_render_crew *crew = job->crew;
    if (!crew) {
        sr_parallel(threads, work, run);
        return SR_OK;
    }
    if (crew->is_helper && !(run->batches = sr_crew_batches_create(job, run->film, error)))
        return error->status;
    struct sr_crew_pass pass = {.tiles = run->tiles_x * run->tiles_y, .blocks = run->blocks, .is_dealt_once = job->integrator.model->begin != NULL,
                                .threads = threads, .run = run, .take = take_batch, .tick = tick};
    sr_status status = crew->begin(crew->self, &pass, error);
    if (status == SR_OK) {
        sr_parallel(threads, work, run);
        if (run->batches && !sr_crew_finish(run->batches))
            status = sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for what is to be sent");
        if (status == SR_OK)
            status = crew->end(crew->self, run->cancelled, error);
        if (run->units_done < units_of(run)) // helpers may have been told to stop while nobody here was at work
            is_cancelled(run);
    }
    sr_crew_batches_destroy(run->batches);
    return status;
}

/* Which block the sample of this number is in. */
static uint32_t block_of(uint32_t spp, uint32_t blocks, uint32_t sample)
{
    uint32_t b = (uint32_t)((uint64_t)sample * blocks / spp);
    while ((uint64_t)spp * (b + 1) / blocks <= sample)
        ++b;
    return b;
}

static void try_sample(const void *picture, uint32_t x, uint32_t y, const struct sr_sampler *sampler, struct sr_worker *worker)
{
    struct sr_picture_sample sample;
    sr_picture_samples(picture, x, y, sampler, 1, false, &sample, worker);
}

sr_status sr_render_pass(const struct sr_render_job *job, const struct sr_render_pass *pass, struct sr_render_report *report, struct sr_error *error)
{
    struct run run = {.job = job, .pass = pass, .film = pass->film, .base = *report, .tile = job->tile > 0 ? (uint32_t)job->tile : DEFAULT_TILE, .blocks = pass->blocks, .end_block = pass->blocks};
    if (pass->part) {
        run.first_block = block_of(job->spp, pass->blocks, pass->range.begin);
        run.end_block = block_of(job->spp, pass->blocks, pass->range.end - 1) + 1;
    }
    sr_picture_begin(&run.picture, job, pass->film);
    run.tiles_x = (pass->film->width + run.tile - 1) / run.tile;
    run.tiles_y = (pass->film->height + run.tile - 1) / run.tile;
    int threads = job->threads > 0 ? job->threads : sr_thread_count();
    struct sr_arena arena = {0};
    run.tile_blocks = sr_arena_alloc(&arena, (size_t)run.tiles_x * run.tiles_y * sizeof *run.tile_blocks);
    run.scratch = sr_arena_alloc(&arena, (size_t)threads * run.tile * run.tile * sizeof *run.scratch);
    run.trees = sr_arena_alloc(&arena, (size_t)threads * sizeof *run.trees);
    uint32_t buckets = run.picture.response.buckets;
    run.buckets = buckets ? sr_arena_alloc(&arena, (size_t)threads * run.tile * run.tile * buckets * sizeof *run.buckets) : NULL;
    bool is_resumed = pass->keeper && pass->keeper->kept.is_resumed;
    size_t pixels = (size_t)pass->film->width * pass->film->height;
    run.had = is_resumed ? sr_arena_alloc(&arena, pixels * sizeof *run.had) : NULL;
    double *tree_buckets = buckets ? sr_arena_alloc(&arena, (size_t)threads * SR_BLOCK_TREE_NODES * buckets * sizeof *tree_buckets) : NULL;
    if (!run.tile_blocks || !run.scratch || !run.trees || (is_resumed && !run.had) || (buckets && (!run.buckets || !tree_buckets))) {
        sr_arena_free(&arena);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %d workers", threads);
    }
    for (int i = 0; buckets && i < threads; ++i) {
        run.trees[i].bucket_count = buckets;
        run.trees[i].buckets = tree_buckets + (size_t)i * SR_BLOCK_TREE_NODES * buckets;
    }
    for (size_t i = 0; run.had && i < pixels; ++i)
        run.had[i] = pass->film->pixels[i].blocks;
    if (run.had && sr_crew_share(job, run.had, pixels, error) != SR_OK) {
        sr_arena_free(&arena);
        return error->status;
    }
    for (uint32_t i = 0; pass->part && i < run.tiles_x * run.tiles_y; ++i)
        run.tile_blocks[i] = run.first_block;
    if (report->dropped) {
        run.has_dropped = true;
        memcpy(run.first_dropped, (uint32_t[4]){report->dropped_x, report->dropped_y, report->dropped_replicate, report->dropped_sample}, sizeof run.first_dropped);
    }
    const struct sr_integrator *integrator = &job->integrator;
    struct sr_worker counted = {0};
    struct sr_picture_plan plan = {.x0 = (uint32_t)job->film.x0, .y0 = (uint32_t)job->film.y0, .width = pass->film->width, .height = pass->film->height,
                                   .spp = job->spp, .per_replicate = pass->per_replicate, .seed = job->seed, .sampler = job->sampler,
                                   .law = run.picture.response.law, .jitter_lambda = job->jitter_lambda, .threads = threads,
                                   .try = try_sample, .picture = &run.picture, .cancel = job->cancel, .counted = &counted, .remark = run.base.remark};
    if (integrator->model->begin && integrator->model->begin(integrator->self, job->scene, &plan, &run.shared, error) != SR_OK) {
        sr_arena_free(&arena);
        return error->status;
    }
    run.rays = counted.rays;
    run.shadow_rays = counted.shadow_rays;
    run.vertices = counted.vertices;
    pthread_rwlock_init(&run.film_lock, NULL);
    pthread_mutex_init(&run.progress_lock, NULL);
    pthread_mutex_init(&run.gate_lock, NULL);
    pthread_cond_init(&run.gate, NULL);
    run.last_progress_s = sr_clock_s();
    struct sr_keeper_watch *watch =
        sr_keeper_watch_begin(pass->keeper, &(struct sr_keeper_view){.run = &run, .film = pass->film, .hold = hold, .let_go = let_go, .tell = tell});
    sr_status status = work_all(&run, threads, error);
    sr_keeper_watch_end(watch);
    pthread_cond_destroy(&run.gate);
    pthread_mutex_destroy(&run.gate_lock);
    pthread_rwlock_destroy(&run.film_lock);
    pthread_mutex_destroy(&run.progress_lock);
    add_to_report(&run, report);
    if ((run.cancelled || status != SR_OK) && pass->keeper)
        sr_keeper_write(pass->keeper, report, share_of(&run, run.units_done));
    if (run.shared)
        integrator->model->end(run.shared);
    sr_arena_free(&arena);
    return status == SR_OK && run.cancelled ? SR_CANCELLED : status;
}

/* Whether paths from the lights bring light to any place of the picture. */
static bool has_splats(const struct sr_render_job *job)
{
    return job->integrator.model->splats && job->sensor.model->connect && !job->film.buckets;
}

/* What cannot be rendered. */
static sr_status check(const struct sr_render_job *job, struct sr_error *error)
{
    if (job->spp < 1)
        return sr_fail(error, SR_ERROR_USAGE, "at least one sample per pixel is needed");
    if (job->integrator.model == &sr_integrator_quadrature)
        return sr_fail(error, SR_ERROR_USAGE, "the estimator quadrature reads meters and makes no pictures: a pixel is an integral of more than two "
                                              "dimensions; use path");
    if (job->integrator.model->splat && !job->sensor.model->connect)
        return sr_fail(error, SR_ERROR_USAGE, "the estimator %s needs to know which ray of the sensor meets a given point, and the sensor %s cannot say; use path or bdpt",
                       job->integrator.model->name, job->sensor.model->name);
    if (job->integrator.model->splat && job->film.buckets)
        return sr_fail(error, SR_ERROR_USAGE, "the estimator %s brings light to the picture as colours, which a film of spectra cannot take; use path or bdpt",
                       job->integrator.model->name);
    if (job->adaptive.is_on && (has_splats(job) || job->integrator.model->begin))
        return sr_fail(error, SR_ERROR_USAGE, "the estimator %s works on the whole picture at a time, and cannot spend samples on some pixels alone",
                       job->integrator.model->name);
    if (!job->adaptive.is_on && (job->replicates == 1 || (job->replicates && job->spp % job->replicates != 0)))
        return sr_fail(error, SR_ERROR_USAGE, "%u samples per pixel cannot be split into %u replicates of equal size (2 or more)", job->spp, job->replicates);
    return SR_OK;
}

static struct sr_render_pass pass_of(const struct sr_render_job *job)
{
    // where samples of a number share something over the whole picture, all pixels take them one after the other
    uint32_t blocks = job->spp < ORDINARY_BLOCKS || job->integrator.model->by_turns ? job->spp : ORDINARY_BLOCKS;
    return (struct sr_render_pass){.share_end = 1, .blocks = job->replicates ? job->replicates : blocks,
                                   .per_replicate = job->replicates ? job->spp / job->replicates : 0};
}

static void count_lost_splats(const struct sr_film *film, struct sr_render_report *report)
{
    report->dropped += film->splats ? film->splats->dropped : 0;
}

sr_status sr_render(const struct sr_render_job *wanted, struct sr_film **film, struct sr_render_report *report, struct sr_error *error)
{
    struct sr_render_job own = *wanted, *job = &own;
    own.with_aov |= own.film.is_gbuffer;
    *film = NULL;
    *report = (struct sr_render_report){0};
    if (check(job, error) != SR_OK)
        return error->status;
    if (job->crew && job->crew->meet(job->crew->self, error) != SR_OK)
        return error->status;
    if (job->adaptive.is_on)
        return sr_render_adaptive(job, film, report, error);
    if (sr_crew_film_create(job, film, error) != SR_OK)
        return error->status;
    struct sr_render_pass pass = pass_of(job);
    struct sr_keeper keeper = {.keep = job->keep, .films = {*film}, .film_count = 1};
    pass.film = *film;
    pass.keeper = &keeper;
    sr_status status = has_splats(job) ? sr_film_add_splats(*film, pass.blocks, error) : SR_OK;
    if (status == SR_OK)
        status = sr_keeper_resume(&keeper, report, error);
    if (status == SR_OK)
        status = sr_crew_share_keeper(job, &keeper, error);
    pass.start_s = sr_clock_s() - report->render_s;
    if (status == SR_OK && !keeper.is_complete)
        status = sr_render_pass(job, &pass, report, error);
    sr_keeper_end(&keeper, report);
    if (!keeper.is_complete) // else they have been counted
        count_lost_splats(*film, report);
    if (status != SR_OK && status != SR_CANCELLED) {
        sr_film_destroy(*film);
        *film = NULL;
    }
    return status;
}

double sr_render_samples_B(const struct sr_render_job *job, struct sr_render_range range)
{
    return (double)sr_part_nodes(job->spp, pass_of(job).blocks, range) * (double)sr_part_node_B(job);
}

sr_status sr_render_samples(const struct sr_render_job *wanted, struct sr_render_range range, struct sr_render_part **part, struct sr_render_report *report,
                            struct sr_error *error)
{
    struct sr_render_job own = *wanted, *job = &own;
    own.with_aov |= own.film.is_gbuffer;
    *part = NULL;
    *report = (struct sr_render_report){0};
    if (check(job, error) != SR_OK)
        return error->status;
    if (job->adaptive.is_on)
        return sr_fail(error, SR_ERROR_USAGE, "adaptive sampling decides by the values of all samples which ones follow: its pictures cannot be made in parts");
    if (job->crew)
        return sr_fail(error, SR_ERROR_USAGE, "a range of samples is made by one process: parts are for processes that do not know each other");
    if (range.begin >= range.end || range.end > job->spp)
        return sr_fail(error, SR_ERROR_USAGE, "samples %u-%u: a range within 0-%u was expected", range.begin, range.end, job->spp);
    struct sr_render_pass pass = pass_of(job);
    pass.range = range;
    sr_status status = sr_part_create(job, pass.blocks, range, &pass.part, error);
    if (status != SR_OK)
        return status;
    pass.film = sr_part_splats_film(pass.part);
    struct sr_keeper keeper = {.keep = job->keep, .films = {pass.film}, .film_count = 1, .part = pass.part};
    pass.keeper = &keeper;
    status = has_splats(job) ? sr_film_add_splats(pass.film, pass.blocks, error) : SR_OK;
    if (status == SR_OK)
        status = sr_keeper_resume(&keeper, report, error);
    pass.start_s = sr_clock_s() - report->render_s;
    if (status == SR_OK && !keeper.is_complete)
        status = sr_render_pass(job, &pass, report, error);
    sr_keeper_end(&keeper, report);
    if (!keeper.is_complete)
        count_lost_splats(pass.film, report);
    *sr_part_report(pass.part) = *report;
    if (status == SR_OK)
        *part = pass.part;
    else
        sr_render_part_destroy(pass.part);
    return status;
}
