/* SPDX-License-Identifier: MIT */
/* steradian-mpi: the hooks that a render calls. They talk to the pump alone, through members that the lock guards. */
#define _GNU_SOURCE // dladdr
#include "ranks.h"

#include "render_command.h"

#include <dlfcn.h>
#include <math.h>
#include <string.h>
#include <time.h>

enum { MOST_OUT_B = 256 << 20 }; // that may wait to be sent before those who make them wait
static const double TICK_S = 0.25,
                    GIVE_UP_S = 0.7; // [s] after which the owner waits no more for helpers, once cancelled:
                                     // mpirun kills all ranks 1 s after it has passed SIGTERM on

_Thread_local int crew_taking_from;

static sr_status fail(const struct crew *c, struct sr_error *error)
{
    if (c->is_over)
        return sr_fail(error, SR_CANCELLED, "the render is over");
    return sr_fail(error, (sr_status)c->failed_status, "%s", c->failure);
}

static bool is_lost(const struct crew *c)
{
    return c->is_over || c->failed_status;
}

/* FNV-1a. */
static uint64_t hash_file(const char *path, uint64_t hash)
{
    FILE *file = fopen(path, "rb");
    static uint8_t bytes[1 << 16];
    for (size_t n; file && (n = fread(bytes, 1, sizeof bytes, file)) > 0;)
        for (size_t i = 0; i < n; ++i)
            hash = (hash ^ bytes[i]) * 0x100000001b3;
    if (file)
        fclose(file);
    return hash;
}

/* What the render says of itself, and then, as it tells a user less, the bytes of the program, and of the library where
 * that renders. */
static char *identity_of_all(void)
{
    uint64_t hash = hash_file("/proc/self/exe", 0xcbf29ce484222325);
    Dl_info program, library;
    if (dladdr((void *)(uintptr_t)identity_of_all, &program) && dladdr((void *)(uintptr_t)sr_fail, &library) &&
        library.dli_fbase != program.dli_fbase)
        hash = hash_file(library.dli_fname, hash);
    size_t size = strlen(render_crew.identity) + 64;
    char *text = sr_alloc(size);
    if (text)
        snprintf(text, size, "%sprogram %016llx\n", render_crew.identity, (unsigned long long)hash);
    return text;
}

static sr_status meet(void *self, struct sr_error *error)
{
    struct crew *c = self;
    char *identity = identity_of_all();
    if (!identity)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    pthread_mutex_lock(&c->lock);
    c->identity = identity;
    c->meeting = MEETING_WANTED;
    while (c->meeting == MEETING_WANTED && !is_lost(c))
        pthread_cond_wait(&c->changed, &c->lock);
    sr_status status = is_lost(c) ? fail(c, error) : SR_OK;
    c->start_s = sr_clock_s();
    pthread_mutex_unlock(&c->lock);
    return status;
}

static sr_status share(void *self, void *data, size_t size, struct sr_error *error)
{
    struct crew *c = self;
    pthread_mutex_lock(&c->lock);
    c->shared = data;
    c->shared_B = size;
    while (c->shared && !is_lost(c))
        pthread_cond_wait(&c->changed, &c->lock);
    c->shared = NULL;
    sr_status status = is_lost(c) ? fail(c, error) : SR_OK;
    pthread_mutex_unlock(&c->lock);
    return status;
}

static sr_status begin(void *self, const struct sr_crew_pass *pass, struct sr_error *error)
{
    struct crew *c = self;
    pthread_mutex_lock(&c->lock);
    sr_status status = is_lost(c) ? fail(c, error) : SR_OK;
    c->pool = (struct pool){.tiles = pass->tiles, .shares = pass->is_dealt_once ? (uint32_t)c->place.renderers : 0};
    for (int i = 0; i < c->place.ranks; ++i)
        c->pool.threads += (uint32_t)c->place.all[i].threads;
    c->deal_count = 0;
    c->position = 0;
    c->passed = 0;
    c->has_share = c->is_exhausted = c->is_asked = c->is_ended = false;
    ++c->pass_number;
    c->pass_start_s = sr_clock_s();
    c->pass = pass; // from here on the pump deals
    pthread_mutex_unlock(&c->lock);
    return status;
}

uint64_t crew_waiting_units(const struct crew *c)
{
    uint64_t units = 0;
    for (int i = 0; i < c->deal_count; ++i)
        units += (uint64_t)deal_tiles(&c->deals[i]) * c->pass->blocks;
    return units - c->position;
}

/* Takes the next unit of what this process has. */
static bool take_own(struct crew *c, uint64_t *unit)
{
    if (!c->deal_count)
        return false;
    const struct deal *d = &c->deals[0];
    uint32_t tiles = deal_tiles(d);
    // all tiles of a deal get one block, then the next one: threads seldom meet in a tile
    uint32_t tile = d->begin + (uint32_t)(c->position % tiles) * d->step, block = (uint32_t)(c->position / tiles);
    *unit = tile + (uint64_t)block * c->pass->tiles;
    if (++c->position == (uint64_t)tiles * c->pass->blocks) {
        memmove(&c->deals[0], &c->deals[1], (size_t)--c->deal_count * sizeof c->deals[0]);
        c->position = 0;
    }
    return true;
}

static bool next(void *self, uint64_t *unit)
{
    struct crew *c = self;
    pthread_mutex_lock(&c->lock);
    bool has_unit = false;
    while (!is_lost(c) && !(has_unit = take_own(c, unit))) {
        if (!c->hooks.is_helper) {
            if (!pool_deal(&c->pool, (uint32_t)c->pass->threads, c->number, &c->has_share, &c->deals[0]))
                break;
            c->deal_count = 1;
        } else if (c->is_exhausted) {
            break;
        } else {
            pthread_cond_wait(&c->changed, &c->lock);
        }
    }
    pthread_mutex_unlock(&c->lock);
    return has_unit;
}

static void hand(void *self, void *bytes, size_t size)
{
    struct crew *c = self;
    struct parcel *parcel = sr_alloc(sizeof *parcel);
    pthread_mutex_lock(&c->lock);
    while (c->out_B > MOST_OUT_B && !is_lost(c))
        pthread_cond_wait(&c->changed, &c->lock);
    if (parcel) {
        *parcel = (struct parcel){.bytes = bytes, .size = size};
        *c->out_end = parcel;
        c->out_end = &parcel->next;
        c->out_B += size;
    } else {
        sr_free(bytes);
        c->failed_status = SR_ERROR_RESOURCE;
        snprintf(c->failure, sizeof c->failure, "not enough memory for what is to be sent");
    }
    pthread_mutex_unlock(&c->lock);
}

static void note(void *self, const struct sr_crew_unit *u)
{
    struct crew *c = self;
    pthread_mutex_lock(&c->lock);
    c->pool.cost_s += u->cost_s;
    c->pool.done += u->block + 1 == c->pass->blocks;
    unit_log_note(c, u);
    pthread_mutex_unlock(&c->lock);
}

static void wait_for(struct crew *c, double s)
{
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    long ns = until.tv_nsec + (long)(1e9 * s);
    until.tv_sec += ns / 1000000000;
    until.tv_nsec = ns % 1000000000;
    pthread_cond_timedwait(&c->changed, &c->lock, &until);
}

static sr_status end(void *self, bool is_cancelled, struct sr_error *error)
{
    struct crew *c = self;
    int helpers = c->place.renderers - 1;
    double give_up_s = is_cancelled ? sr_clock_s() + GIVE_UP_S : INFINITY;
    pthread_mutex_lock(&c->lock);
    if (is_cancelled)
        c->pool.next = c->pool.tiles;
    c->is_ended = true;
    while (!is_lost(c) && (c->hooks.is_helper ? c->pass != NULL : c->passed < helpers) && sr_clock_s() < give_up_s) {
        wait_for(c, TICK_S);
        if (isinf(give_up_s) && atomic_load(&render_interrupted) && !c->hooks.is_helper)
            give_up_s = sr_clock_s() + GIVE_UP_S;
        if (c->hooks.is_helper || is_cancelled)
            continue;
        pthread_mutex_unlock(&c->lock);
        c->pass->tick(c->pass->run);
        pthread_mutex_lock(&c->lock);
    }
    while (c->is_taking)
        pthread_cond_wait(&c->changed, &c->lock);
    c->pass = NULL; // the pump takes nothing any more
    c->passes_s += sr_clock_s() - c->pass_start_s;
    sr_status status = is_lost(c) && !is_cancelled ? fail(c, error) : SR_OK;
    pthread_mutex_unlock(&c->lock);
    return status;
}

void crew_begin(struct crew *c)
{
    c->hooks = (struct sr_render_crew){.self = c,
                                       .is_helper = c->place.rank > 0,
                                       .meet = meet,
                                       .share = share,
                                       .begin = begin,
                                       .next = next,
                                       .hand = hand,
                                       .note = note,
                                       .end = end};
    for (int i = 0; i < c->place.rank; ++i)
        c->number += c->place.all[i].threads > 0;
    c->out_end = &c->out;
    pthread_mutex_init(&c->lock, NULL);
    pthread_cond_init(&c->changed, NULL);
}
