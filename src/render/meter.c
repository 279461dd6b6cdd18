/* SPDX-License-Identifier: MIT */
/* Irradiance at a point, by rays over its hemisphere.
 *
 *     E = integral L(w) cos theta dw = pi E[ L ]     with directions in proportion to the cosine     [lx], [W m^-2]
 *
 * Independently scrambled replicates give Student's interval. */
#include "render/render.h"

static void add_estimate(const struct sr_render_job *job, const struct sr_point *x, const struct sr_frame *frame, uint32_t replicate, uint32_t sample,
                         struct sr_worker *worker, double *E_v, double *E_e)
{
    struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, UINT32_MAX, UINT32_MAX, replicate, sample);
    sr_u4 u = sr_sample4(&sampler, SR_USE_FILM);
    struct sr_wavelengths w = sr_wavelengths_sample(job->lambda, u[2]);
    struct sr_path_start start = {.ray = sr_leave(x, sr_to_world(frame, sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]})))};
    start.ray.time = u[3];
    sr_spectrum L = job->integrator.model->L(job->integrator.self, job->scene, &start, &sampler, &w, NULL, worker);
    *E_v += (double)SR_PI * (double)sr_spectrum_to_xyz(L, &w).y;
    double integral = 0; // of L over wavelength
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        integral += w.pdf[i] > 0 ? (double)(L[i] / w.pdf[i]) / SR_LAMBDA_COUNT : 0;
    *E_e += (double)SR_PI * integral / (double)SR_KM;
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
