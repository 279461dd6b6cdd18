/* SPDX-License-Identifier: MIT */
/* A pass over the picture: its workers, alone or as part of a crew. Every tile gets its blocks of samples in order, and
 * any thread may make any of them. */
#define _POSIX_C_SOURCE 200809L
#include "render/pass.h"

#include <string.h>

enum { DEFAULT_TILE = 16 };

static bool next_unit(struct run *run, uint64_t *unit)
{
    const struct sr_render_crew *crew = run->job->crew;
    if (crew)
        return crew->next(crew->self, unit);
    *unit = atomic_fetch_add_explicit(&run->next_unit, 1, memory_order_relaxed);
    return *unit < sr_run_units(run);
}

static void work(void *context, int thread)
{
    struct run *run = context;
    struct sr_film_block *scratch = run->scratch + (size_t)thread * run->tile * run->tile;
    double *buckets =
        run->buckets ? run->buckets + (size_t)thread * run->tile * run->tile * run->picture.response.buckets : NULL;
    struct sr_block_tree *tree = &run->trees[thread];
    struct sr_splatting splatting = sr_splatting_begin(&run->picture);
    splatting.target.user = &splatting;
    bool splats = run->film->splats != NULL;
    struct sr_worker worker = {
        .log = thread == 0 ? run->job->log : NULL, .target = splats ? &splatting.target : NULL, .shared = run->shared};
    for (;;) {
        if (splats)
            sr_gate_enter(run);
        uint64_t unit;
        bool is_done = !sr_run_is_cancelled(run) && next_unit(run, &unit) &&
                       sr_run_do_unit(run, unit, scratch, buckets, tree, splats ? &splatting : NULL, &worker);
        if (splats)
            sr_gate_leave(run);
        if (!is_done)
            break;
        sr_run_tell_progress(run, atomic_fetch_add_explicit(&run->units_done, 1, memory_order_relaxed) + 1);
    }
}

/* ---- a crew ---- */

static void take_batch(void *context, const void *bytes, size_t size)
{
    struct run *run = context;
    struct sr_crew_reader reader = {
        .film = run->film, .crew = run->job->crew, .had = run->had, .blocks_before = run->pass->blocks_before};
    pthread_rwlock_rdlock(&run->film_lock);
    sr_crew_read(&reader, bytes, size);
    sr_run_count(run, &reader.counts);
    pthread_rwlock_unlock(&run->film_lock);
    atomic_fetch_add_explicit(&run->units_done, reader.units, memory_order_relaxed);
    const uint32_t *d = reader.counts.first_dropped;
    if (reader.counts.has_dropped)
        sr_run_remember_dropped(run, d[0], d[1], d[2], d[3]);
}

static void tick(void *context)
{
    struct run *run = context;
    sr_run_tell_progress(run, atomic_load(&run->units_done));
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
    struct sr_crew_pass pass = {.tiles = run->tiles_x * run->tiles_y,
                                .blocks = run->blocks,
                                .is_dealt_once = job->integrator.model->begin != NULL,
                                .threads = threads,
                                .run = run,
                                .take = take_batch,
                                .tick = tick};
    sr_status status = crew->begin(crew->self, &pass, error);
    if (status == SR_OK) {
        sr_parallel(threads, work, run);
        if (run->batches && !sr_crew_finish(run->batches))
            status = sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for what is to be sent");
        if (status == SR_OK)
            status = crew->end(crew->self, run->cancelled, error);
        if (run->units_done < sr_run_units(run)) // helpers may have been told to stop while nobody here was at work
            sr_run_is_cancelled(run);
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

static void try_sample(const void *picture, uint32_t x, uint32_t y, const struct sr_sampler *sampler,
                       struct sr_worker *worker)
{
    struct sr_picture_sample sample;
    sr_picture_samples(picture, x, y, sampler, 1, false, &sample, worker);
}

/* Memory for each thread, and which blocks a resumed film has had. */
static sr_status make_room(struct run *run, int threads, struct sr_arena *arena, struct sr_error *error)
{
    const struct sr_film *film = run->film;
    bool is_resumed = run->pass->keeper && run->pass->keeper->kept.is_resumed;
    size_t n = (size_t)threads, places = n * run->tile * run->tile, pixels = (size_t)film->width * film->height;
    uint32_t tiles = run->tiles_x * run->tiles_y, buckets = run->picture.response.buckets;
    double *tree_buckets = NULL;
    run->tile_blocks = sr_arena_alloc(arena, tiles * sizeof *run->tile_blocks);
    run->scratch = sr_arena_alloc(arena, places * sizeof *run->scratch);
    run->trees = sr_arena_alloc(arena, n * sizeof *run->trees);
    if (buckets) {
        run->buckets = sr_arena_alloc(arena, places * buckets * sizeof *run->buckets);
        tree_buckets = sr_arena_alloc(arena, n * SR_BLOCK_TREE_NODES * buckets * sizeof *tree_buckets);
    }
    if (is_resumed)
        run->had = sr_arena_alloc(arena, pixels * sizeof *run->had);
    if (!run->tile_blocks || !run->scratch || !run->trees || (is_resumed && !run->had) ||
        (buckets && (!run->buckets || !tree_buckets)))
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %d workers", threads);
    for (size_t i = 0; buckets && i < n; ++i) {
        run->trees[i].bucket_count = buckets;
        run->trees[i].buckets = tree_buckets + i * SR_BLOCK_TREE_NODES * buckets;
    }
    for (uint32_t i = 0; run->pass->part && i < tiles; ++i)
        run->tile_blocks[i] = run->first_block;
    for (size_t i = 0; run->had && i < pixels; ++i)
        run->had[i] = film->pixels[i].blocks;
    return run->had ? sr_crew_share(run->job, run->had, pixels, error) : SR_OK;
}

/* What the integrator does before the first sample; its rays count once, also where a checkpoint goes on. */
static sr_status begin_integrator(struct run *run, int threads, struct sr_error *error)
{
    const struct sr_render_job *job = run->job;
    const struct sr_render_pass *pass = run->pass;
    if (!job->integrator.model->begin)
        return SR_OK;
    struct sr_worker counted = {0};
    struct sr_picture_plan plan = {.x0 = (uint32_t)job->film.x0,
                                   .y0 = (uint32_t)job->film.y0,
                                   .width = pass->film->width,
                                   .height = pass->film->height,
                                   .spp = job->spp,
                                   .per_replicate = pass->per_replicate,
                                   .seed = job->seed,
                                   .sampler = job->sampler,
                                   .law = run->picture.response.law,
                                   .jitter_lambda = job->jitter_lambda,
                                   .threads = threads,
                                   .try = try_sample,
                                   .picture = &run->picture,
                                   .cancel = job->cancel,
                                   .counted = &counted,
                                   .remark = run->base.remark};
    if (job->integrator.model->begin(job->integrator.self, job->scene, &plan, &run->shared, error) != SR_OK)
        return error->status;
    if (!run->had) { // else the checkpoint has counted them
        run->rays = counted.rays;
        run->shadow_rays = counted.shadow_rays;
        run->vertices = counted.vertices;
    }
    return SR_OK;
}

sr_status sr_render_pass(const struct sr_render_job *job, const struct sr_render_pass *pass,
                         struct sr_render_report *report, struct sr_error *error)
{
    struct run run = {.job = job,
                      .pass = pass,
                      .film = pass->film,
                      .base = *report,
                      .tile = job->tile > 0 ? (uint32_t)job->tile : DEFAULT_TILE,
                      .blocks = pass->blocks,
                      .end_block = pass->blocks};
    if (pass->part) {
        run.first_block = block_of(job->spp, pass->blocks, pass->range.begin);
        run.end_block = block_of(job->spp, pass->blocks, pass->range.end - 1) + 1;
    }
    if (report->dropped) {
        run.has_dropped = true;
        memcpy(run.first_dropped,
               (uint32_t[4]){report->dropped_x, report->dropped_y, report->dropped_replicate, report->dropped_sample},
               sizeof run.first_dropped);
    }
    sr_picture_begin(&run.picture, job, pass->film);
    run.tiles_x = (pass->film->width + run.tile - 1) / run.tile;
    run.tiles_y = (pass->film->height + run.tile - 1) / run.tile;
    int threads = job->threads > 0 ? job->threads : sr_thread_count();
    struct sr_arena arena = {0};
    if (make_room(&run, threads, &arena, error) != SR_OK || begin_integrator(&run, threads, error) != SR_OK) {
        sr_arena_free(&arena);
        return error->status;
    }
    sr_gate_begin(&run);
    struct sr_keeper_view view = sr_gate_view(&run);
    struct sr_keeper_watch *watch = sr_keeper_watch_begin(pass->keeper, &view);
    sr_status status = work_all(&run, threads, error);
    sr_keeper_watch_end(watch);
    sr_gate_end(&run);
    sr_run_report(&run, report);
    if ((run.cancelled || status != SR_OK) && pass->keeper)
        sr_keeper_write(pass->keeper, report, sr_run_share(&run, run.units_done));
    if (run.shared)
        job->integrator.model->end(run.shared);
    sr_arena_free(&arena);
    return status == SR_OK && run.cancelled ? SR_CANCELLED : status;
}
