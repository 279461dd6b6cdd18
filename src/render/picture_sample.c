/* SPDX-License-Identifier: MIT */
/* One sample of a picture: numbers into a ray of the sensor, its radiance into what the film takes,
 *
 *     rgb = weight M integral L(lambda) (xbar, ybar, zbar)(lambda) dlambda        [cd/m^2],
 *
 * and the path from a light that goes with it, where the estimator has such. */
#include "render/private.h"

#include <string.h>

static const float PIXEL_SHARE = 0.125f; // of a pixel's footprint: see look

/* Reflectance of the first surface under the output space's white, for the albedo channel. */
static void first_albedo(const struct sr_render_job *job, struct sr_hit *hit, sr_vec3 d,
                         const struct sr_sampler *sampler, const struct sr_wavelengths *wavelengths, float albedo[3])
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
    struct sr_spd white = {
        .kind = SR_SPD_TABLE, .scale = (float)(1 / space->illuminant_luminous_integral), .table = space->illuminant};
    struct sr_rgb rgb = sr_rgb_from_xyz(space, sr_spectrum_to_xyz(rho * sr_spd_eval(&white, w.lambda), &w));
    albedo[0] = rgb.r, albedo[1] = rgb.g, albedo[2] = rgb.b;
}

static struct sr_response response_of(const struct sr_render_job *job)
{
    const struct sr_sensor_model *sensor = job->sensor.model;
    bool is_bare = sensor->bare_ray && !sr_scene_has_footprints(job->scene) && !job->film.is_gbuffer;
    const struct sr_film_settings *f = &job->film;
    struct sr_response r = {.law = sr_lambda_law(job->lambda),
                            .buckets = f->buckets,
                            .lambda_min = f->lambda_min,
                            .lambda_step = f->buckets ? (f->lambda_max - f->lambda_min) / (float)f->buckets : 0,
                            .imaging_ratio = f->exposure_time * f->iso / 100,
                            .bucket_scale = f->bucket_scale * f->exposure_time * f->iso / 100,
                            .ray = is_bare ? sensor->bare_ray : sensor->ray,
                            .is_bare = is_bare};
    sr_film_response(&job->film, r.rgb_from_xyz);
    return r;
}

/* Wavelengths of a film that keeps them apart: even over its range, as pbrt's. */
static struct sr_wavelengths even_wavelengths(const struct sr_response *r, float u)
{
    struct sr_wavelengths w = {.pdf = SR_BLACK + 1 / (r->lambda_step * (float)r->buckets)};
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float v = u + (float)i / SR_LAMBDA_COUNT;
        w.lambda[i] = r->lambda_min + (v < 1 ? v : v - 1) * r->lambda_step * (float)r->buckets;
    }
    return w;
}

/* A wavelength's share of its bucket's mean: L / (pdf N step). One that dispersion has ended counts nothing, and the
 * first one more, so that the mean stays right. */
void sr_picture_add_to_buckets(const struct sr_picture *picture, const struct sr_picture_sample *s, double *buckets)
{
    const struct sr_response *r = &picture->response;
    float scale = s->weight * r->bucket_scale / (SR_LAMBDA_COUNT * r->lambda_step);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        int bucket = (int)((s->w.lambda[i] - r->lambda_min) / r->lambda_step);
        if (s->w.pdf[i] > 0 && isfinite(s->L[i]))
            buckets[bucket < 0                 ? 0
                    : bucket < (int)r->buckets ? bucket
                                               : (int)r->buckets - 1] += (double)(scale * s->L[i] / s->w.pdf[i]);
    }
}

/* The first surface as a G-buffer has it: seen from the front, in the space that is asked for. */
static void fill_gbuffer(const struct sr_render_job *job, const struct sr_path_start *start, struct sr_point *x,
                         struct sr_first_hit *first)
{
    const struct sr_film_settings *f = &job->film;
    struct sr_transform t;
    float least = 1 / sqrtf((float)job->spp),
          samples = sr_max(PIXEL_SHARE, least) / (job->jitter_pixel ? PIXEL_SHARE : 1);
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
static void sense(const struct sr_render_job *job, const struct sr_response *r, sr_spectrum L,
                  const struct sr_wavelengths *w, float weight, float values[3], float *share)
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

/* From the numbers of a sample to its ray, with the wavelengths and what the sample weighs; false: the sensor sees
 * nothing there. */
static __attribute__((noinline)) bool look(const struct sr_picture *picture, uint32_t x, uint32_t y,
                                           const struct sr_sampler *sampler, struct sr_picture_sample *out)
{
    const struct sr_render_job *job = picture->job;
    const struct sr_response *response = &picture->response;
    sr_u4 u, u_lens;
    sr_sample8(sampler, SR_USE_FILM, &u, &u_lens);
    out->weight = 1;
    out->view_weight = 0;
    sr_vec2 offset =
        job->jitter_pixel ? sr_filter_sample(&job->filter, (sr_vec2){u[0], u[1]}, &out->weight) : (sr_vec2){0, 0};
    float u_lambda = job->jitter_lambda ? u[2] : 0.5f;
    out->w = SR_UNLIKELY(response->buckets) ? even_wavelengths(response, u_lambda)
                                            : sr_wavelengths_draw(&response->law, u_lambda);
    sr_wavelengths_know(&out->w, sr_scene_lights(job->scene)->white);
    struct sr_sensor_ray view;
    sr_vec2 raster = {(float)x + 0.5f + offset.x, (float)y + 0.5f + offset.y};
    if (!response->ray(job->sensor.self, raster, (sr_vec2){u_lens[0], u_lens[1]}, u[3], &view))
        return false;

    // jittered samples smooth a pixel themselves, so that textures need little filtering. pbrt's share at 64 samples
    // and more; the same at any count, or the picture's expectation would depend on it (bump maps: by a factor of 2)
    float share = job->jitter_pixel ? PIXEL_SHARE : 1;
    out->start = (struct sr_path_start){.ray = view.ray, .medium = sr_scene_sensor_medium(job->scene)};
    if (!response->is_bare) {
        out->start.dodx = sr_scale(share, view.dodx), out->start.dody = sr_scale(share, view.dody);
        out->start.dddx = sr_scale(share, view.dddx), out->start.dddy = sr_scale(share, view.dddy);
    }
    out->view_weight = view.weight;
    return true;
}

/* From radiance to what the film takes. */
static __attribute__((noinline)) void develop(const struct sr_picture *picture, struct sr_picture_sample *s)
{
    float v[3], kept;
    sense(picture->job, &picture->response, s->L, &s->w, s->view_weight, v, &kept);
    s->weight *= s->view_weight * kept;
    const float(*m)[3] = picture->response.rgb_from_xyz;
    for (int c = 0; c < 3; ++c)
        s->rgb[c] = s->weight * (m[c][0] * v[0] + m[c][1] * v[1] + m[c][2] * v[2]);
    s->is_finite = isfinite(s->rgb[0]) && isfinite(s->rgb[1]) && isfinite(s->rgb[2]);
}

static void see_first(const struct sr_render_job *job, struct sr_picture_sample *s, struct sr_hit *hit,
                      const struct sr_sampler *sampler)
{
    struct sr_first_hit *first = &s->first;
    *first = (struct sr_first_hit){.is_hit = hit->material != NULL};
    if (!hit->material)
        return;
    first->n = hit->point.n;
    first->ns = hit->point.ns;
    first->p = hit->point.p;
    first->depth = hit->t;
    first->uv = hit->point.uv;
    first->material = hit->material_number;
    first->object = hit->object;
    if (job->film.is_gbuffer)
        fill_gbuffer(job, &s->start, &hit->point, first);
    first_albedo(job, hit, s->start.ray.d, sampler, &s->w, first->albedo);
}

/* Three rounds (look and develop are never part of their loops, so that a sample's bytes do not depend on its place
 * there): rays of all samples, then their radiance, then their colours, so that in the first and the last one the
 * processor does several at once. */
void sr_picture_samples(const struct sr_picture *picture, uint32_t x, uint32_t y, const struct sr_sampler *start,
                        uint32_t count, bool with_first, struct sr_picture_sample *out, struct sr_worker *worker)
{
    const struct sr_render_job *job = picture->job;
    sr_u8 ahead[SR_AHEAD_GROUPS / 2 * SR_AHEAD];
    struct sr_sampler sampler = *start;
    uint32_t drawn = count > 1 ? sr_sampler_draw_ahead(start, count, ahead) : 0;
    bool sees[SR_PICTURE_SAMPLES];
    for (uint32_t k = 0; k < count; ++k) {
        sampler.sample = start->sample + k, sampler.drawn = drawn, sampler.ahead = ahead + k;
        sees[k] = look(picture, x, y, &sampler, &out[k]);
    }
    for (uint32_t k = 0; k < count; ++k) {
        sampler.sample = start->sample + k, sampler.drawn = drawn, sampler.ahead = ahead + k;
        if (with_first)
            out[k].first = (struct sr_first_hit){0}; // where the sensor sees nothing at all
        out[k].L = SR_BLACK;
        if (SR_UNLIKELY(!sees[k]))
            continue;
        struct sr_hit hit;
        out[k].L = job->integrator.model->L(job->integrator.self, job->scene, &out[k].start, &sampler, &out[k].w,
                                            with_first ? &hit : NULL, worker);
        if (with_first)
            see_first(job, &out[k], &hit, &sampler);
    }
    for (uint32_t k = 0; k < count; ++k) {
        develop(picture, &out[k]);
        if (with_first && out[k].first.is_hit)
            memcpy(out[k].first.rgb, out[k].rgb, sizeof out[k].rgb);
    }
}

bool sr_render_sample(const struct sr_render_job *job, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample,
                      float rgb[3], struct sr_first_hit *first, struct sr_worker *worker)
{
    struct sr_picture picture = {.job = job, .response = response_of(job)};
    struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, x, y, replicate, sample);
    struct sr_picture_sample s;
    sr_picture_samples(&picture, x, y, &sampler, 1, first != NULL, &s, worker);
    memcpy(rgb, s.rgb, sizeof s.rgb);
    if (first)
        *first = s.first;
    return s.is_finite;
}

/* ---- paths from the lights ---- */

static void add_splat(void *user, sr_vec2 raster, sr_spectrum gain, const struct sr_wavelengths *w)
{
    struct sr_splatting *s = user;
    const struct sr_render_job *job = s->picture->job;
    float rgb[3], v[3], kept;
    // one path goes with a sample of one pixel: that share counts where values are clamped
    sense(job, &s->picture->response, gain, w, 1 / s->target.pixels, v, &kept);
    const float(*m)[3] = s->picture->response.rgb_from_xyz;
    for (int c = 0; c < 3; ++c)
        rgb[c] = kept * (m[c][0] * v[0] + m[c][1] * v[1] + m[c][2] * v[2]);
    sr_film_splat(s->film, &job->filter, s->group, raster, rgb);
}

/* The path that goes with sample i of the pixel: all of them are points of one net, in the order of the samples. */
void sr_splatting_aim(struct sr_splatting *s, uint32_t pixel, uint32_t replicate, uint32_t i)
{
    uint64_t index = (uint64_t)i * ((uint64_t)s->picture->film->width * s->picture->film->height) + pixel;
    s->target.sampler = sr_sampler_start(s->picture->job->sampler, s->picture->job->seed, UINT32_MAX,
                                         (uint32_t)(index >> 32), replicate, (uint32_t)index);
}

void sr_picture_splat(const struct sr_picture *picture, struct sr_worker *worker)
{
    const struct sr_render_job *job = picture->job;
    sr_u4 u = sr_sample4(&worker->target->sampler, SR_USE_FILM);
    struct sr_wavelengths w = sr_wavelengths_draw(&picture->response.law, job->jitter_lambda ? u[2] : 0.5f);
    sr_wavelengths_know(&w, sr_scene_lights(job->scene)->white);
    job->integrator.model->splat(job->integrator.self, job->scene, &w, worker);
}

static void find_middle(struct sr_picture *picture)
{
    const struct sr_film_settings *f = &picture->job->film;
    struct sr_sensor_ray view;
    sr_vec2 raster = {0.5f * (float)f->width, 0.5f * (float)f->height};
    float share = picture->job->jitter_pixel ? PIXEL_SHARE : 1;
    picture->has_middle =
        picture->job->sensor.model->ray(picture->job->sensor.self, raster, (sr_vec2){0.5f, 0.5f}, 0, &view);
    picture->middle = (struct sr_path_start){.ray = view.ray,
                                             .dodx = sr_scale(share, view.dodx),
                                             .dody = sr_scale(share, view.dody),
                                             .dddx = sr_scale(share, view.dddx),
                                             .dddy = sr_scale(share, view.dddy)};
}

void sr_picture_begin(struct sr_picture *picture, const struct sr_render_job *job, struct sr_film *film)
{
    *picture = (struct sr_picture){.job = job, .film = film, .response = response_of(job)};
    if (film->splats)
        find_middle(picture);
}

struct sr_splatting sr_splatting_begin(const struct sr_picture *picture)
{
    const struct sr_sensor *sensor = &picture->job->sensor;
    return (struct sr_splatting){.picture = picture,
                                 .film = picture->film,
                                 .target = {.self = sensor->self,
                                            .connect = sensor->model->connect,
                                            .density = sensor->model->density,
                                            .pixels = (float)picture->film->width * (float)picture->film->height,
                                            .middle = picture->has_middle ? &picture->middle : NULL,
                                            .add = add_splat}};
}
