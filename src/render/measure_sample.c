/* SPDX-License-Identifier: MIT */
/* One sample of a meter: a point of it, a direction, what arrives.
 *
 *     reading = INTEGRAL INTEGRAL response(x, wi) L(x, wi) dwi dA
 *
 * estimated twice, by directions in proportion to the response and by directions toward a light, weighed by their
 * densities (Veach 1997, power heuristic). An estimator that does not know receivers is asked along the first kind
 * alone, and lights that no direction meets are added; one that gathers does it all by itself. Paths from the lights
 * are joined to the meter's point at each vertex:
 *
 *     reading = E[ sum beta f |cos theta| response(wi) / r^2 V / density ] */
#include "render/measure.h"

/* The numbers of a sample beside those of its bounces, far from their groups. */
enum { USE_PLACE = 1 << 24 };

/* Light straight from a light: response L / pdf, with its weight. */
static sr_spectrum direct(const struct measuring *m, const struct sr_meter_place *at, sr_u4 u,
                          const struct sr_wavelengths *w, struct sr_worker *worker)
{
    const struct sr_scene *scene = m->job->scene;
    const struct sr_lights *lights = sr_scene_lights(scene);
    uint32_t index;
    float pmf;
    struct sr_light_sample l;
    if (!sr_lights_pick(lights, &at->x, u[2], &index, &pmf) ||
        !sr_light_draw(lights->lights[index], &at->x, (sr_vec2){u[0], u[1]}, w, &l))
        return SR_BLACK;
    sr_vec3 wi = sr_to_local(&at->frame, l.wi);
    float response = m->meter->model->response(m->meter->self, wi), pdf = pmf * l.pdf;
    if (response == 0 || (m->aim == AIM_AT_DELTAS && !l.is_delta) || !sr_unoccluded(scene, &at->x, &l, worker))
        return SR_BLACK;
    return l.L * (response * (l.is_delta ? 1 : sr_mis_weight(pdf, m->meter->model->pdf(m->meter->self, wi))) / pdf);
}

/* A place of the meter, for paths from the lights. */
struct receiving {
    const struct sr_meter *meter;
    const struct sr_meter_place *at;
    sr_spectrum sum;
};

static bool connect(const void *self, sr_vec3 p, float time, sr_vec2 u, struct sr_sensor_view *view)
{
    (void)u, (void)time;
    const struct receiving *r = self;
    sr_vec3 to = sr_sub(r->at->x.p, p);
    float r2 = sr_length2(to), distance = sqrtf(r2);
    if (!(r2 > 0))
        return false;
    sr_vec3 wi = sr_scale(1 / distance, to), back = sr_neg(wi);
    *view = (struct sr_sensor_view){
        .p = sr_point_offset(&r->at->x, back),
        .wi = wi,
        .distance = distance,
        .weight = r->meter->model->response(r->meter->self, sr_to_local(&r->at->frame, back)) / r2};
    return view->weight != 0;
}

static void receive(void *user, sr_vec2 raster, sr_spectrum gain, const struct sr_wavelengths *w)
{
    (void)raster, (void)w;
    ((struct receiving *)user)->sum += gain;
}

static sr_spectrum from_lights(const struct measuring *m, const struct sr_meter_place *at,
                               const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_worker *worker)
{
    struct receiving r = {m->meter, at, SR_BLACK};
    struct sr_target target = {
        .self = &r, .connect = connect, .pixels = 1, .sampler = *sampler, .add = receive, .user = &r};
    worker->target = &target;
    m->job->integrator.model->splat(m->job->integrator.self, m->job->scene, w, worker);
    worker->target = NULL;
    return r.sum;
}

static void add_escaped(void *user, enum sr_particle_event event, const struct sr_hit *hit, sr_vec3 d, sr_spectrum flux,
                        const struct sr_wavelengths *w)
{
    (void)hit, (void)d, (void)w;
    if (event == SR_PARTICLE_ESCAPED)
        *(sr_spectrum *)user += flux;
}

/* Where an estimator finds lights that no direction meets, wherever it scatters, the meter finds them, too. */
void measure_prepare(struct measuring *m)
{
    const struct sr_integrator *integrator = &m->job->integrator;
    bool is_ray = m->meter->model->is_ray && m->meter->model->is_ray(m->meter->self);
    bool is_blind = integrator->model->blind && integrator->model->blind(integrator->self, m->job->scene);
    m->aim = is_ray                               ? AIM_NEVER
             : integrator->model->knows_receivers ? AIM_AT_ALL
             : is_blind                           ? AIM_NEVER
                                                  : AIM_AT_DELTAS;
}

static sr_spectrum estimate(const struct measuring *m, const struct sr_sampler *sampler, struct sr_wavelengths *w,
                            struct sr_worker *worker)
{
    const struct sr_meter_model *model = m->meter->model;
    const void *self = m->meter->self;
    const struct sr_integrator *integrator = &m->job->integrator;
    sr_u4 u, u_light, u_place = sr_sample4(sampler, USE_PLACE);
    sr_sample8(sampler, SR_USE_FILM, &u, &u_light);
    *w = sr_wavelengths_sample(m->lambda, m->job->jitter_lambda ? u_place[2] : 0.5f);
    sr_wavelengths_know(w, sr_scene_lights(m->job->scene)->white);
    if (model->far) {
        sr_spectrum flux = SR_BLACK;
        sr_follow_particle(m->job->scene, sampler, w, &(struct sr_particle_watch){add_escaped, &flux}, worker);
        return flux;
    }
    struct sr_meter_place at;
    sr_vec2 where = {u_place[0], u_place[1]};
    if (!(m->cell == UINT32_MAX ? model->place(self, where, &at) : model->place_in(self, m->cell, where, &at)))
        return SR_BLACK;
    measure_settle(m->job->scene, &at);
    at.x.time = u_place[3];
    bool is_ray = model->is_ray && model->is_ray(self);
    if (integrator->model->gather && !is_ray) {
        bool is_upper = sr_length2(at.x.n) > 0 &&
                        model->response(self, (sr_vec3){0, 0, -1}) == 0; // a surface element, not its net flux
        struct sr_receiver receiver = {at.x, at.frame, self, model->response, model->sample, model->pdf, is_upper};
        return integrator->model->gather(integrator->self, m->job->scene, &receiver, sampler, w, worker) * at.weight;
    }
    sr_vec3 wi;
    float pdf = model->sample(self, u, &wi);
    sr_spectrum sum = SR_BLACK;
    if (m->aim != AIM_NEVER)
        sum = direct(m, &at, u_light, w, worker);
    float response = pdf > 0 ? model->response(self, wi) : 0;
    if (response != 0) {
        struct sr_path_start start = {.ray = sr_leave(&at.x, sr_to_world(&at.frame, wi)),
                                      .receiver = m->aim == AIM_AT_ALL ? &at.x : NULL,
                                      .pdf = pdf};
        start.medium = sr_scene_medium_at(m->job->scene, &start.ray);
        sum +=
            integrator->model->L(integrator->self, m->job->scene, &start, sampler, w, NULL, worker) * (response / pdf);
    }
    if (integrator->model->splat && !is_ray)
        sum += from_lights(m, &at, sampler, w, worker);
    return sum * at.weight;
}

bool measure_add(const struct measuring *m, sr_spectrum X, const struct sr_wavelengths *w, double *channels,
                 double *looked_at)
{
    const struct sr_lambda_range range = m->job->lambda;
    const struct sr_spectrometer *spectrometer = &m->settings->spectrometer;
    if (spectrometer->count) { // its bins may reach beyond the wavelengths that all else is summed over
        sr_spectrometer_add(spectrometer, X, w, channels + MEASURE_BINS);
        X = sr_spectrum_select((w->lambda >= range.lo) & (w->lambda <= range.hi), X, SR_BLACK);
    }
    double readings[SR_SYSTEM_COUNT];
    sr_observe(X, w, readings);
    struct sr_xyz xyz = sr_spectrum_to_xyz(X, w);
    *looked_at = fabs(readings[m->settings->system]);
    if (!isfinite(*looked_at))
        return false;
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
        channels[i] += readings[i];
    channels[MEASURE_X] += (double)xyz.x;
    channels[MEASURE_Z] += (double)xyz.z;
    return true;
}

bool measure_sample(const struct measuring *m, uint32_t replicate, uint32_t sample, struct sr_worker *worker,
                    double *channels, double *looked_at, bool *is_hit)
{
    const struct sr_render_job *job = m->job;
    struct sr_sampler sampler =
        sr_sampler_start(job->sampler, job->seed, m->stream, UINT32_MAX - m->round, replicate, sample);
    struct sr_wavelengths w;
    sr_spectrum X = estimate(m, &sampler, &w, worker);
    *is_hit = sr_spectrum_any(X != 0.0f);
    *looked_at = 0;
    if (!*is_hit)
        return true;
    if (!sr_spectrum_is_finite(X))
        return false;
    return measure_add(m, X, &w, channels, looked_at);
}

bool measure_place(const struct measuring *m, uint32_t replicate, uint32_t sample, struct sr_meter_place *at)
{
    const struct sr_render_job *job = m->job;
    struct sr_sampler sampler =
        sr_sampler_start(job->sampler, job->seed, m->stream, UINT32_MAX - m->round, replicate, sample);
    sr_u4 u = sr_sample4(&sampler, USE_PLACE);
    bool is_there = m->meter->model->place(m->meter->self, (sr_vec2){u[0], u[1]}, at);
    if (is_there)
        measure_settle(job->scene, at);
    return is_there;
}

bool measure_is_cancelled(const struct sr_render_job *job)
{
    return job->cancel && atomic_load_explicit(job->cancel, memory_order_relaxed);
}

bool measure_run(const struct measuring *m, uint32_t replicate, uint64_t begin, uint64_t end, struct measure_sums *sums)
{
    struct sr_worker worker = {0};
    for (uint64_t i = begin; i < end; ++i) {
        double looked_at;
        bool is_hit;
        if (measure_sample(m, replicate, (uint32_t)i, &worker, sums->channels, &looked_at, &is_hit)) {
            sums->hits += is_hit;
            sums->total += looked_at;
            sums->largest = fmax(sums->largest, looked_at);
            sums->least = fmin(sums->least, looked_at);
        } else
            ++sums->dropped;
        ++sums->samples;
        if ((i & 63) == 63 && measure_is_cancelled(m->job))
            return false;
    }
    return true;
}
