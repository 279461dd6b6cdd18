/* SPDX-License-Identifier: MIT */
/* Work units and workers: every tile gets its blocks of samples in order, and any thread may make any of them. */
#define _POSIX_C_SOURCE 200809L
#include "render/private.h"

#include <pthread.h>
#include <sched.h>

enum { DEFAULT_TILE = 16, ORDINARY_BLOCKS = 4 };
static const float PIXEL_SHARE = 0.125f; // of a pixel's footprint: see sample_pixel

/* What all samples of a job share. */
struct response {
    float rgb_from_xyz[3][3];
    struct sr_lambda_law law;
    uint32_t buckets;
    float lambda_min, lambda_step; // [nm] of a bucket
    float imaging_ratio, bucket_scale; // the latter with the former
    bool (*ray)(const void *sensor, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out);
};

struct run {
    const struct sr_render_job *job;
    const struct sr_render_pass *pass;
    struct sr_film *film;
    struct response response;
    uint32_t tile, tiles_x, tiles_y, blocks;
    atomic_ullong next_unit;
    atomic_uint *tile_blocks;      // how many blocks of a tile are in the film
    atomic_ullong rays, shadow_rays, vertices, paths, dropped;
    atomic_ullong units_done;
    atomic_bool cancelled;
    pthread_rwlock_t film_lock;    // stores share it, whoever looks at the whole film has it alone
    pthread_mutex_t progress_lock; // guards the members below
    double last_progress_s;
    uint32_t first_dropped[4];     // x, y, replicate, sample
    bool has_dropped;
    struct sr_film_block *scratch; // tile * tile for each thread
    double *buckets;               // as many times the film's buckets; NULL: it has none
    struct sr_path_start middle;   // a ray of the sensor's, for the footprints of light paths
    bool has_middle;
    void *shared;                  // of the integrator's samples
};

/* ---- one sample ---- */

/* Reflectance of the first surface under the output space's white, for the albedo channel. */
static void first_albedo(const struct sr_render_job *job, struct sr_hit *hit, sr_vec3 d, const struct sr_sampler *sampler,
                         const struct sr_wavelengths *wavelengths, float albedo[3])
{
    struct sr_wavelengths w = *wavelengths;
    struct sr_bsdf bsdf;
    struct sr_frame frame;
    sr_u4 u = sr_sample4(sampler, SR_USE_BOUNCE + 1);
    uint32_t seed = sr_hash_combine(sampler->key + sampler->sample, SR_USE_BOUNCE);
    sr_material_shade(hit->material, &hit->point, sr_neg(d), u[3], seed, &w, &bsdf, &frame);
    if (!bsdf.model)
        return;
    sr_vec3 wo = sr_to_local(&frame, sr_neg(d));
    sr_spectrum rho = SR_BLACK;
    struct sr_bsdf_sample s;
    if (bsdf.model->albedo)
        rho = bsdf.model->albedo(bsdf.data, wo);
    else if (sr_bsdf_sample(&bsdf, wo, u[2], (sr_vec2){u[0], u[1]}, SR_RADIANCE, &s))
        rho = s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
    const struct sr_colour_space *space = sr_colour_space(job->film.space);
    struct sr_spd white = {.kind = SR_SPD_TABLE, .scale = (float)(1 / space->illuminant_luminous_integral), .table = space->illuminant};
    struct sr_rgb rgb = sr_rgb_from_xyz(space, sr_spectrum_to_xyz(rho * sr_spd_eval(&white, w.lambda), &w));
    albedo[0] = rgb.r, albedo[1] = rgb.g, albedo[2] = rgb.b;
}

static struct response response_of(const struct sr_render_job *job)
{
    const struct sr_sensor_model *sensor = job->sensor.model;
    bool is_bare = sensor->bare_ray && !sr_scene_has_footprints(job->scene) && !job->film.is_gbuffer;
    const struct sr_film_settings *f = &job->film;
    struct response r = {.law = sr_lambda_law(job->lambda), .buckets = f->buckets, .lambda_min = f->lambda_min,
                         .lambda_step = f->buckets ? (f->lambda_max - f->lambda_min) / (float)f->buckets : 0, .imaging_ratio = f->exposure_time * f->iso / 100, .bucket_scale = f->bucket_scale * f->exposure_time * f->iso / 100, .ray = is_bare ? sensor->bare_ray : sensor->ray};
    sr_film_response(&job->film, r.rgb_from_xyz);
    return r;
}

/* Wavelengths of a film that keeps them apart: even over its range, as pbrt's. */
static struct sr_wavelengths even_wavelengths(const struct response *r, float u)
{
    struct sr_wavelengths w = {.pdf = SR_BLACK + 1 / (r->lambda_step * (float)r->buckets)};
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float v = u + (float)i / SR_LAMBDA_COUNT;
        w.lambda[i] = r->lambda_min + (v < 1 ? v : v - 1) * r->lambda_step * (float)r->buckets;
    }
    return w;
}

/* A wavelength's share of its bucket's mean: L / (pdf N step). One that dispersion has ended counts nothing, and the first one
 * more, so that the mean stays right. */
static void add_to_buckets(const struct response *r, sr_spectrum L, const struct sr_wavelengths *w, float weight, double *buckets)
{
    float scale = weight * r->bucket_scale / (SR_LAMBDA_COUNT * r->lambda_step);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        int bucket = (int)((w->lambda[i] - r->lambda_min) / r->lambda_step);
        if (w->pdf[i] > 0 && isfinite(L[i]))
            buckets[bucket < 0 ? 0 : bucket < (int)r->buckets ? bucket : (int)r->buckets - 1] += (double)(scale * L[i] / w->pdf[i]);
    }
}

/* The first surface as a G-buffer has it: seen from the front, in the space that is asked for. */
static void fill_gbuffer(const struct sr_render_job *job, const struct sr_path_start *start, struct sr_point *x, struct sr_first_hit *first)
{
    const struct sr_film_settings *f = &job->film;
    struct sr_transform t;
    float least = 1 / sqrtf((float)job->spp), samples = sr_max(PIXEL_SHARE, least) / (job->jitter_pixel ? PIXEL_SHARE : 1);
    sr_first_footprint(start, x);
    first->n = sr_face_forward(first->n, sr_neg(start->ray.d));
    first->ns = sr_face_forward(first->ns, sr_neg(start->ray.d));
    if (f->camera) {
        sr_motion_at(f->camera, x->time, &t);
        first->dzdx = samples * sr_inverse_vector(&t, x->dpdx).z;
        first->dzdy = samples * sr_inverse_vector(&t, x->dpdy).z;
    }
    if (!f->of_points)
        return;
    sr_motion_at(f->of_points, x->time, &t);
    t = sr_transform_invert(&t);
    first->p = sr_transform_point(&t, first->p);
    first->n = sr_normalize(sr_transform_normal(&t, first->n));
    first->ns = sr_normalize(sr_transform_normal(&t, first->ns));
}

/* What the sensor takes, and where the film is to be kept from bright samples, less of it. */
static void sense(const struct sr_render_job *job, const struct response *r, sr_spectrum L, const struct sr_wavelengths *w, float weight, float values[3],
                  float *share)
{
    if (SR_UNLIKELY(job->film.camera1)) {
        sr_film_camera_values(job->film.camera1, L, w, values);
    } else {
        struct sr_xyz xyz = sr_spectrum_to_xyz(L, w);
        values[0] = xyz.x, values[1] = xyz.y, values[2] = xyz.z;
    }
    *share = 1;
    float largest = weight * r->imaging_ratio * sr_max(values[0], sr_max(values[1], values[2]));
    if (SR_UNLIKELY(largest > job->film.max_component))
        *share = job->film.max_component / largest;
}

static bool sample_pixel(const struct sr_render_job *job, const struct response *response, uint32_t x, uint32_t y, const struct sr_sampler *sampler,
                         float rgb[3], double *buckets, struct sr_first_hit *first, struct sr_worker *worker)
{
    if (first)
        *first = (struct sr_first_hit){0}; // where the sensor sees nothing at all
    sr_u4 u, u_lens;
    sr_sample8(sampler, SR_USE_FILM, &u, &u_lens);
    float weight = 1;
    sr_vec2 offset = job->jitter_pixel ? sr_filter_sample(&job->filter, (sr_vec2){u[0], u[1]}, &weight) : (sr_vec2){0, 0};
    float u_lambda = job->jitter_lambda ? u[2] : 0.5f;
    struct sr_wavelengths w = SR_UNLIKELY(response->buckets) ? even_wavelengths(response, u_lambda) : sr_wavelengths_draw(&response->law, u_lambda);
    sr_wavelengths_know(&w, sr_scene_lights(job->scene)->white);
    struct sr_sensor_ray view;
    rgb[0] = rgb[1] = rgb[2] = 0;
    sr_vec2 raster = {(float)x + 0.5f + offset.x, (float)y + 0.5f + offset.y};
    if (!response->ray(job->sensor.self, raster, (sr_vec2){u_lens[0], u_lens[1]}, u[3], &view))
        return true;

    // jittered samples smooth a pixel themselves, so that textures need little filtering. pbrt's share at 64 samples and
    // more; the same at any count, or the picture's expectation would depend on it (bump maps: by a factor of 2)
    float share = job->jitter_pixel ? PIXEL_SHARE : 1;
    struct sr_path_start start = {.ray = view.ray, .dodx = sr_scale(share, view.dodx), .dody = sr_scale(share, view.dody),
                                  .dddx = sr_scale(share, view.dddx), .dddy = sr_scale(share, view.dddy),
                                  .medium = sr_scene_sensor_medium(job->scene)};
    struct sr_hit hit;
    sr_spectrum L = job->integrator.model->L(job->integrator.self, job->scene, &start, sampler, &w, first ? &hit : NULL, worker);
    float v[3], kept;
    sense(job, response, L, &w, view.weight, v, &kept);
    weight *= view.weight * kept;
    const float(*m)[3] = response->rgb_from_xyz;
    for (int c = 0; c < 3; ++c)
        rgb[c] = weight * (m[c][0] * v[0] + m[c][1] * v[1] + m[c][2] * v[2]);
    if (SR_UNLIKELY(buckets))
        add_to_buckets(response, L, &w, weight, buckets);

    if (first) {
        *first = (struct sr_first_hit){.is_hit = hit.material != NULL};
        if (hit.material) {
            first->n = hit.point.n;
            first->ns = hit.point.ns;
            first->p = hit.point.p;
            first->depth = hit.t;
            first->uv = hit.point.uv;
            first->material = hit.material_number;
            first->object = hit.object;
            if (job->film.is_gbuffer)
                fill_gbuffer(job, &start, &hit.point, first);
            for (int c = 0; c < 3; ++c)
                first->rgb[c] = rgb[c];
            first_albedo(job, &hit, view.ray.d, sampler, &w, first->albedo);
        }
    }
    return isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
}

bool sr_render_sample(const struct sr_render_job *job, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample, float rgb[3],
                      struct sr_first_hit *first, struct sr_worker *worker)
{
    struct response response = response_of(job);
    struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, x, y, replicate, sample);
    return sample_pixel(job, &response, x, y, &sampler, rgb, NULL, first, worker);
}

/* ---- paths from the lights ---- */

/* Where they are told, by one thread. */
struct splatting {
    struct run *run;
    uint32_t group;
    struct sr_target target;
};

static void add_splat(void *user, sr_vec2 raster, sr_spectrum gain, const struct sr_wavelengths *w)
{
    struct splatting *s = user;
    const struct sr_render_job *job = s->run->job;
    float rgb[3], v[3], kept;
    // one path goes with a sample of one pixel: that share counts where values are clamped
    sense(job, &s->run->response, gain, w, 1 / s->target.pixels, v, &kept);
    const float(*m)[3] = s->run->response.rgb_from_xyz;
    for (int c = 0; c < 3; ++c)
        rgb[c] = kept * (m[c][0] * v[0] + m[c][1] * v[1] + m[c][2] * v[2]);
    sr_film_splat(s->run->film, &job->filter, s->group, raster, rgb);
}

/* The path that goes with sample i of the pixel: all of them are points of one net, in the order of the samples. */
static void aim(struct splatting *s, uint32_t pixel, uint32_t replicate, uint32_t i)
{
    uint64_t index = (uint64_t)i * ((uint64_t)s->run->film->width * s->run->film->height) + pixel;
    s->target.sampler = sr_sampler_start(s->run->job->sampler, s->run->job->seed, UINT32_MAX, (uint32_t)(index >> 32), replicate, (uint32_t)index);
}

static void splat(const struct run *run, struct sr_worker *worker)
{
    const struct sr_render_job *job = run->job;
    sr_u4 u = sr_sample4(&worker->target->sampler, SR_USE_FILM);
    struct sr_wavelengths w = sr_wavelengths_draw(&run->response.law, job->jitter_lambda ? u[2] : 0.5f);
    sr_wavelengths_know(&w, sr_scene_lights(job->scene)->white);
    job->integrator.model->splat(job->integrator.self, job->scene, &w, worker);
}

static void find_middle(struct run *run)
{
    const struct sr_film_settings *f = &run->job->film;
    struct sr_sensor_ray view;
    sr_vec2 raster = {0.5f * (float)f->width, 0.5f * (float)f->height};
    float share = run->job->jitter_pixel ? PIXEL_SHARE : 1;
    run->has_middle = run->job->sensor.model->ray(run->job->sensor.self, raster, (sr_vec2){0.5f, 0.5f}, 0, &view);
    run->middle = (struct sr_path_start){.ray = view.ray, .dodx = sr_scale(share, view.dodx), .dody = sr_scale(share, view.dody),
                                         .dddx = sr_scale(share, view.dddx), .dddy = sr_scale(share, view.dddy)};
}

static struct splatting begin_splatting(struct run *run)
{
    const struct sr_sensor *sensor = &run->job->sensor;
    return (struct splatting){.run = run, .target = {.self = sensor->self, .connect = sensor->model->connect, .density = sensor->model->density,
                                                     .pixels = (float)run->film->width * (float)run->film->height,
                                                     .middle = run->has_middle ? &run->middle : NULL, .add = add_splat}};
}

/* ---- one unit: a tile times a block ---- */

static void remember_dropped(struct run *run, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample)
{
    atomic_fetch_add_explicit(&run->dropped, 1, memory_order_relaxed);
    pthread_mutex_lock(&run->progress_lock);
    // the first in picture order, so that the report does not depend on who was faster
    uint32_t now[4] = {x, y, replicate, sample};
    uint32_t *old = run->first_dropped;
    if (!run->has_dropped || y < old[1] || (y == old[1] && (x < old[0] || (x == old[0] && (replicate < old[2] || (replicate == old[2] && sample < old[3])))))) {
        for (int i = 0; i < 4; ++i)
            old[i] = now[i];
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

/* The samples of one pixel in one block; false: cancelled, nothing of it counts. */
static bool fill_block(struct run *run, uint32_t x, uint32_t y, uint32_t block, struct sr_film_block *b, double *buckets, struct splatting *splatting, struct sr_worker *worker)
{
    const struct sr_render_job *job = run->job;
    const struct sr_render_pass *pass = run->pass;
    *b = (struct sr_film_block){0};
    for (uint32_t i = 0; buckets && i < run->response.buckets; ++i)
        buckets[i] = 0;
    uint32_t pixel = (y - (uint32_t)job->film.y0) * run->film->width + x - (uint32_t)job->film.x0;
    uint32_t replicate = 0, begin = 0, end = pass->counts ? pass->counts[pixel] : pass->per_replicate;
    if (end > 0)
        replicate = pass->first_replicate + block;
    else {
        begin = (uint32_t)((uint64_t)job->spp * block / run->blocks);
        end = (uint32_t)((uint64_t)job->spp * (block + 1) / run->blocks);
    }
    struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, x, y, replicate, begin);
    worker->replicate = replicate;
    if (splatting)
        splatting->group = block % run->film->splats->groups;
    for (uint32_t i = begin; i < end; ++i) {
        sampler.sample = i;
        if (splatting) {
            aim(splatting, pixel, replicate, i);
            if (job->integrator.model->splat)
                splat(run, worker);
        }
        float rgb[3];
        struct sr_first_hit first;
        bool is_finite = sample_pixel(job, &run->response, x, y, &sampler, rgb, buckets, job->with_aov ? &first : NULL, worker);
        if (SR_UNLIKELY(!is_finite))
            remember_dropped(run, x, y, replicate, i);
        sr_film_block_add(b, rgb, is_finite);
        if (job->with_aov)
            sr_film_block_add_first(b, &first);
        if ((i & 255) == 255 && is_cancelled(run))
            break;
    }
    if (splatting)
        sr_film_splat_paths(run->film, splatting->group, b->n); // also those of a block that is given up: they have splatted
    return b->n == end - begin;
}

static void tell_progress(struct run *run, double share)
{
    const struct sr_render_job *job = run->job;
    if (!job->progress || pthread_mutex_trylock(&run->progress_lock) != 0)
        return;
    double now = sr_clock_s();
    if (now - run->last_progress_s >= job->progress_interval_s) {
        run->last_progress_s = now;
        const struct sr_render_pass *pass = run->pass;
        double elapsed = now - pass->start_s;
        share = pass->share_begin + share * (pass->share_end - pass->share_begin);
        pthread_rwlock_wrlock(&run->film_lock);
        struct sr_render_progress p = {
            .share = share, .elapsed_s = elapsed, .left_s = share > 0 ? elapsed * (1 - share) / share : NAN,
            .rays = atomic_load(&run->rays) + atomic_load(&run->shadow_rays), .film = run->film,
        };
        job->progress(job->user, &p);
        pthread_rwlock_unlock(&run->film_lock);
    }
    pthread_mutex_unlock(&run->progress_lock);
}

static bool do_unit(struct run *run, uint64_t unit, struct sr_film_block *scratch, double *buckets, struct splatting *splatting, struct sr_worker *worker)
{
    uint32_t tiles = run->tiles_x * run->tiles_y, tile = (uint32_t)(unit % tiles), block = (uint32_t)(unit / tiles);
    uint32_t x0 = tile % run->tiles_x * run->tile, y0 = tile / run->tiles_x * run->tile;
    uint32_t x1 = x0 + run->tile < run->film->width ? x0 + run->tile : run->film->width;
    uint32_t y1 = y0 + run->tile < run->film->height ? y0 + run->tile : run->film->height;
    uint32_t left = (uint32_t)run->film->settings.x0, top = (uint32_t)run->film->settings.y0, done = 0;
    uint64_t paths = 0;
    for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x, ++done) {
            if (is_cancelled(run) || !fill_block(run, left + x, top + y, block, &scratch[done], buckets ? buckets + (size_t)done * run->response.buckets : NULL, splatting, worker))
                return false;
            paths += scratch[done].n;
        }
    // blocks of a tile go in by their order; the one before is being made by a thread that does not wait for us
    while (atomic_load_explicit(&run->tile_blocks[tile], memory_order_acquire) != block) {
        if (is_cancelled(run))
            return false;
        sched_yield();
    }
    pthread_rwlock_rdlock(&run->film_lock);
    uint32_t i = 0;
    for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x) {
            if (buckets)
                sr_film_store_buckets(run->film, x, y, buckets + (size_t)i * run->response.buckets);
            sr_film_store(run->film, x, y, &scratch[i++]);
        }
    pthread_rwlock_unlock(&run->film_lock);
    atomic_store_explicit(&run->tile_blocks[tile], block + 1, memory_order_release);
    atomic_fetch_add_explicit(&run->paths, paths, memory_order_relaxed);
    return true;
}

static void work(void *context, int thread)
{
    struct run *run = context;
    struct sr_film_block *scratch = run->scratch + (size_t)thread * run->tile * run->tile;
    double *buckets = run->buckets ? run->buckets + (size_t)thread * run->tile * run->tile * run->response.buckets : NULL;
    uint64_t units = (uint64_t)run->tiles_x * run->tiles_y * run->blocks;
    struct splatting splatting = begin_splatting(run);
    splatting.target.user = &splatting;
    bool splats = run->film->splats != NULL;
    struct sr_worker worker = {.log = thread == 0 ? run->job->log : NULL, .target = splats ? &splatting.target : NULL, .shared = run->shared};
    for (;;) {
        uint64_t unit = atomic_fetch_add_explicit(&run->next_unit, 1, memory_order_relaxed);
        if (unit >= units || is_cancelled(run) || !do_unit(run, unit, scratch, buckets, splats ? &splatting : NULL, &worker))
            break;
        uint64_t done = atomic_fetch_add_explicit(&run->units_done, 1, memory_order_relaxed) + 1;
        atomic_fetch_add_explicit(&run->rays, worker.rays, memory_order_relaxed);
        atomic_fetch_add_explicit(&run->shadow_rays, worker.shadow_rays, memory_order_relaxed);
        atomic_fetch_add_explicit(&run->vertices, worker.vertices, memory_order_relaxed);
        worker.rays = worker.shadow_rays = worker.vertices = 0;
        tell_progress(run, (double)done / (double)units);
    }
}

static void add_to_report(const struct run *run, struct sr_render_report *report)
{
    if (report->dropped == 0 && run->dropped > 0) {
        report->dropped_x = run->first_dropped[0], report->dropped_y = run->first_dropped[1];
        report->dropped_replicate = run->first_dropped[2], report->dropped_sample = run->first_dropped[3];
    }
    report->paths += run->paths;
    report->rays += run->rays;
    report->shadow_rays += run->shadow_rays;
    report->vertices += run->vertices;
    report->dropped += run->dropped + (run->film->splats ? run->film->splats->dropped : 0);
    report->render_s = sr_clock_s() - run->pass->start_s;
    report->is_complete = !run->cancelled;
}

sr_status sr_render_pass(const struct sr_render_job *job, const struct sr_render_pass *pass, struct sr_render_report *report, struct sr_error *error)
{
    struct run run = {.job = job, .pass = pass, .film = pass->film, .tile = job->tile > 0 ? (uint32_t)job->tile : DEFAULT_TILE, .blocks = pass->blocks};
    run.response = response_of(job);
    run.tiles_x = (pass->film->width + run.tile - 1) / run.tile;
    run.tiles_y = (pass->film->height + run.tile - 1) / run.tile;
    if (pass->film->splats)
        find_middle(&run);
    int threads = job->threads > 0 ? job->threads : sr_thread_count();
    struct sr_arena arena = {0};
    run.tile_blocks = sr_arena_alloc(&arena, (size_t)run.tiles_x * run.tiles_y * sizeof *run.tile_blocks);
    run.scratch = sr_arena_alloc(&arena, (size_t)threads * run.tile * run.tile * sizeof *run.scratch);
    run.buckets = run.response.buckets ? sr_arena_alloc(&arena, (size_t)threads * run.tile * run.tile * run.response.buckets * sizeof *run.buckets) : NULL;
    if (!run.tile_blocks || !run.scratch || (run.response.buckets && !run.buckets)) {
        sr_arena_free(&arena);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %d workers", threads);
    }
    const struct sr_integrator *integrator = &job->integrator;
    struct sr_picture_plan plan = {.pixels = (uint64_t)pass->film->width * pass->film->height, .per_replicate = pass->per_replicate, .seed = job->seed,
                                   .sampler = job->sampler, .law = run.response.law, .jitter_lambda = job->jitter_lambda, .threads = threads};
    if (integrator->model->begin && integrator->model->begin(integrator->self, job->scene, &plan, &run.shared, error) != SR_OK) {
        sr_arena_free(&arena);
        return error->status;
    }
    pthread_rwlock_init(&run.film_lock, NULL);
    pthread_mutex_init(&run.progress_lock, NULL);
    run.last_progress_s = sr_clock_s();
    sr_parallel(threads, work, &run);
    pthread_rwlock_destroy(&run.film_lock);
    pthread_mutex_destroy(&run.progress_lock);
    add_to_report(&run, report);
    if (run.shared)
        integrator->model->end(run.shared);
    sr_arena_free(&arena);
    return run.cancelled ? SR_CANCELLED : SR_OK;
}

sr_status sr_render(const struct sr_render_job *wanted, struct sr_film **film, struct sr_render_report *report, struct sr_error *error)
{
    struct sr_render_job own = *wanted, *job = &own;
    own.with_aov |= own.film.is_gbuffer;
    *film = NULL;
    *report = (struct sr_render_report){0};
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
    bool splats = job->integrator.model->splats && job->sensor.model->connect && !job->film.buckets;
    if (job->adaptive.is_on && (splats || job->integrator.model->begin))
        return sr_fail(error, SR_ERROR_USAGE, "the estimator %s brings light to the whole picture at a time, and cannot spend samples on some pixels alone",
                       job->integrator.model->name);
    if (job->adaptive.is_on)
        return sr_render_adaptive(job, film, report, error);
    if (job->replicates == 1 || (job->replicates && job->spp % job->replicates != 0))
        return sr_fail(error, SR_ERROR_USAGE, "%u samples per pixel cannot be split into %u replicates of equal size (2 or more)", job->spp, job->replicates);
    if (sr_film_create(&job->film, job->with_aov, film, error) != SR_OK)
        return error->status;
    struct sr_render_pass pass = {.film = *film, .start_s = sr_clock_s(), .share_end = 1};
    // where samples of a number share something over the whole picture, all pixels take them one after the other
    uint32_t blocks = job->spp < ORDINARY_BLOCKS || job->integrator.model->begin ? job->spp : ORDINARY_BLOCKS;
    pass.blocks = job->replicates ? job->replicates : blocks;
    pass.per_replicate = job->replicates ? job->spp / job->replicates : 0;
    sr_status status = splats ? sr_film_add_splats(*film, pass.blocks, error) : SR_OK;
    if (status == SR_OK)
        status = sr_render_pass(job, &pass, report, error);
    if (status != SR_OK && status != SR_CANCELLED) {
        sr_film_destroy(*film);
        *film = NULL;
    }
    return status;
}
