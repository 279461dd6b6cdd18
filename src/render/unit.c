/* SPDX-License-Identifier: MIT */
/* Units of work: a tile times a block of samples, made by any thread and stored in the order of the tile's blocks. */
#define _POSIX_C_SOURCE 200809L
#include "render/pass.h"

#include <sched.h>
#include <string.h>
#include <time.h>

bool sr_render_is_earlier(const uint32_t a[4], const uint32_t b[4])
{
    static const int order[4] = {1, 0, 2, 3};
    for (int i = 0; i < 4; ++i)
        if (a[order[i]] != b[order[i]])
            return a[order[i]] < b[order[i]];
    return false;
}

void sr_run_remember_dropped(struct run *run, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample)
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

bool sr_run_is_cancelled(struct run *run)
{
    if (run->job->cancel && atomic_load_explicit(run->job->cancel, memory_order_relaxed))
        atomic_store_explicit(&run->cancelled, true, memory_order_relaxed);
    return atomic_load_explicit(&run->cancelled, memory_order_relaxed);
}

/* Of a block's samples begin <= i < end, those that the pass is to take: all, or those of a part. */
static void clip(const struct sr_render_pass *pass, uint64_t block_begin, uint32_t *begin, uint32_t *end)
{
    int64_t lo = (int64_t)pass->range.begin - (int64_t)block_begin,
            hi = (int64_t)pass->range.end - (int64_t)block_begin;
    *begin = lo > *begin ? (uint32_t)lo : *begin;
    *end = hi < *end ? (uint32_t)hi : *end;
}

/* A unit may be hours of work: whoever wants to be told, or to stop, is asked while it is under way. */
static void tell_now_and_then(struct run *run, struct sr_worker *worker, uint32_t samples)
{
    enum { SAMPLES = 1024 }; // so many that the clock and the lock cost nothing
    worker->untold += samples;
    if (worker->untold < SAMPLES)
        return;
    worker->untold = 0;
    sr_run_tell_progress(run, atomic_load_explicit(&run->units_done, memory_order_relaxed));
}

/* The samples of one pixel in one block; false: cancelled, nothing of it counts. */
static bool fill_block(struct run *run, uint32_t x, uint32_t y, uint32_t block, struct sr_block_tree *tree,
                       struct sr_splatting *splatting, struct sr_worker *worker)
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
                sr_run_remember_dropped(run, x, y, replicate, i + k);
            if (SR_UNLIKELY(buckets))
                sr_picture_add_to_buckets(&run->picture, s, buckets);
            sr_film_block_add(b, s->rgb, s->is_finite);
            if (job->with_aov)
                sr_film_block_add_first(b, &s->first);
            sr_block_tree_done(tree);
        }
        tell_now_and_then(run, worker, count);
        if (!splatting && sr_run_is_cancelled(run))
            break;
    }
    if (splatting)
        sr_film_splat_paths(splatting->film, splatting->group, tree->next - tree->first);
    if (to - from == end - begin)
        sr_block_tree_fold(tree);
    return tree->next == to - begin;
}

/* Blocks of a tile go in by their order; false: cancelled before. The one before is being made by a thread that does
 * not wait for us. */
static bool wait_for_turn(struct run *run, uint32_t tile, uint32_t block)
{
    while (atomic_load_explicit(&run->tile_blocks[tile], memory_order_acquire) != block) {
        if (sr_run_is_cancelled(run))
            return false;
        sched_yield();
    }
    return true;
}

/* Whether the pixel's block came from a checkpoint. */
static bool is_there(const struct run *run, uint32_t x, uint32_t y, uint32_t block)
{
    return SR_UNLIKELY(run->had != NULL) &&
           run->had[(size_t)y * run->film->width + x] > run->pass->blocks_before + block - run->first_block;
}

/* The unit's pixels go into the film, as many as are done. */
static void store_unit(struct run *run, const struct sr_crew_unit *u, uint32_t done, const struct sr_film_block *blocks,
                       const double *buckets)
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

void sr_run_count(struct run *run, const struct sr_render_counts *c)
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

bool sr_run_do_unit(struct run *run, uint64_t unit, struct sr_film_block *scratch, double *buckets,
                    struct sr_block_tree *tree, struct sr_splatting *splatting, struct sr_worker *worker)
{
    uint32_t tiles = run->tiles_x * run->tiles_y, tile = (uint32_t)(unit % tiles),
             block = run->first_block + (uint32_t)(unit / tiles);
    struct sr_crew_unit u = {
        .tile = tile, .block = block, .x0 = tile % run->tiles_x * run->tile, .y0 = tile / run->tiles_x * run->tile};
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
        if (sr_run_is_cancelled(run) || !fill_block(run, left + x, top + y, block, tree, splatting, worker))
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
        sr_run_count(run, &counts);
        pthread_rwlock_unlock(&run->film_lock);
    }
    if (done < pixels)
        return false;
    atomic_store_explicit(&run->tile_blocks[tile], block + 1, memory_order_release);
    return true;
}
