/* SPDX-License-Identifier: MIT */
/* Irradiance at a point, by rays over its hemisphere and by the lights.
 *
 *     E = integral L(w) cos theta dw                                              [lx], [W m^-2]
 *
 * estimated twice, by directions in proportion to the cosine and by directions toward a light, weighed by their densities
 * (Veach 1997). Independently scrambled replicates give Student's interval. */
#include "render/render.h"

/* Light straight from a light: L cos theta / pdf, with its weight. */
static sr_spectrum direct(const struct sr_scene *scene, const struct sr_point *x, sr_u4 u, const struct sr_wavelengths *w, struct sr_worker *worker)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    uint32_t index;
    float pmf;
    struct sr_light_sample l;
    if (!sr_lights_pick(lights, x, u[2], &index, &pmf) || !sr_light_draw(lights->lights[index], x, (sr_vec2){u[0], u[1]}, w, &l))
        return SR_BLACK;
    float cos_theta = sr_dot(l.wi, x->n), pdf = pmf * l.pdf;
    if (!(cos_theta > 0) || !sr_unoccluded(scene, x, &l, worker))
        return SR_BLACK;
    return l.L * (cos_theta * (l.is_delta ? 1 : sr_mis_weight(pdf, cos_theta * SR_INV_PI)) / pdf);
}

static void add_estimate(const struct sr_render_job *job, const struct sr_point *x, const struct sr_frame *frame, uint32_t replicate, uint32_t sample,
                         struct sr_worker *worker, double *E_v, double *E_e)
{
    struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, UINT32_MAX, UINT32_MAX, replicate, sample);
    sr_u4 u = sr_sample4(&sampler, SR_USE_FILM), u_light = sr_sample4(&sampler, SR_USE_LENS);
    struct sr_wavelengths w = sr_wavelengths_sample(job->lambda, u[2]);
    sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]});
    struct sr_path_start start = {.ray = sr_leave(x, sr_to_world(frame, wi))};
    start.ray.time = u[3];
    sr_spectrum E = SR_BLACK;
    if (job->integrator.model->knows_receivers) {
        E = direct(job->scene, x, u_light, &w, worker);
        start.receiver = x;
        start.pdf = sr_warp_cosine_hemisphere_pdf(wi.z);
    }
    if (wi.z > 0)
        E += job->integrator.model->L(job->integrator.self, job->scene, &start, &sampler, &w, NULL, worker) * SR_PI;
    *E_v += (double)sr_spectrum_to_xyz(E, &w).y;
    double integral = 0; // of E over wavelength
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        integral += w.pdf[i] > 0 ? (double)(E[i] / w.pdf[i]) / SR_LAMBDA_COUNT : 0;
    *E_e += integral / (double)SR_KM;
}

struct measuring {
    const struct sr_render_job *job;
    struct sr_point x;
    struct sr_frame frame;
    uint32_t samples;
    double *E_v, *E_e; // of each replicate
};

static void measure_replicate(void *context, uint64_t r)
{
    struct measuring *m = context;
    struct sr_worker worker = {0};
    for (uint32_t i = 0; i < m->samples; ++i)
        add_estimate(m->job, &m->x, &m->frame, (uint32_t)r, i, &worker, &m->E_v[r], &m->E_e[r]);
}

struct sr_irradiance sr_render_irradiance(const struct sr_render_job *job, sr_vec3 p, sr_vec3 n, uint32_t samples, uint32_t replicates)
{
    struct sr_irradiance E = {NAN, NAN, NAN, NAN, replicates - 1}; // until measured: no memory, no number
    struct sr_arena arena = {0};
    struct measuring m = {.job = job, .samples = samples, .x = {.p = p, .n = sr_normalize(n)}};
    m.x.ns = m.x.n;
    m.x.p_error = (sr_vec3){1e-6f * (1 + fabsf(p.x)), 1e-6f * (1 + fabsf(p.y)), 1e-6f * (1 + fabsf(p.z))}; // off a surface that it lies on
    m.frame = sr_frame_from_z(m.x.n);
    m.E_v = sr_arena_alloc(&arena, replicates * sizeof *m.E_v);
    m.E_e = sr_arena_alloc(&arena, replicates * sizeof *m.E_e);
    if (m.E_v && m.E_e) {
        sr_parallel_for(job->threads > 0 ? job->threads : sr_thread_count(), replicates, measure_replicate, &m);
        struct sr_tally v = {0}, e = {0};
        for (uint32_t r = 0; r < replicates; ++r) {
            sr_tally_add(&v, m.E_v[r] / samples);
            sr_tally_add(&e, m.E_e[r] / samples);
        }
        E.E_v = v.mean, E.E_v_error = sr_tally_standard_error(&v);
        E.E_e = e.mean, E.E_e_error = sr_tally_standard_error(&e);
    }
    sr_arena_free(&arena);
    return E;
}
