/* SPDX-License-Identifier: MIT */
/* The plain twin of volumetric path tracing: photons of one wavelength, played out as they are.
 *
 *     P(absorbed) : P(scattered) : P(nothing) = sigma_a : sigma_s : m - sigma_t
 *         at each collision against the majorant m
 *
 * No light is sampled, nothing is weighed, no closed form is used: what it finds, volpath must find (Pharr, Jakob &
 * Humphreys 2023, 14.2.1, which knows no surfaces; here they scatter by their BSDFs). */
#include "integrator/flight.h"

enum { GROUPS = 2, MOST_PASSED = 1000 };

struct simple_volpath {
    int32_t max_depth; // most scatterings of a path
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct simple_volpath, max_depth),
     "most scatterings of a path"},
    {.name = NULL},
};

enum event { THROUGH, ABSORBED, SCATTERED, GIVEN_UP };

static enum event collide(const struct sr_medium *medium, const struct sr_ray *ray, float length,
                          const struct sr_wavelengths *w, struct sr_rng *rng, float *t, struct sr_medium_at *at)
{
    struct sr_medium_walk walk;
    struct sr_medium_segment s;
    medium->model->begin(medium->self, ray->o, ray->d, length, w, &walk);
    while (medium->model->next(medium->self, &walk, &s)) {
        *t = s.t0;
        for (int nulls = 0;; ++nulls) {
            *t -= log1pf(-sr_rng_float(rng)) / s.majorant[0];
            if (!(*t < s.t1))
                break;
            medium->model->at(medium->self, sr_mad(ray->o, *t, ray->d), w, at);
            float u = sr_rng_float(rng) * s.majorant[0];
            if (u < at->sigma_a[0])
                return ABSORBED;
            if (u < at->sigma_a[0] + at->sigma_s[0])
                return SCATTERED;
            if (nulls >= SR_MOST_NULLS)
                return GIVEN_UP;
        }
    }
    return THROUGH;
}

static sr_spectrum simple_volpath_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                                    const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                                    struct sr_worker *worker)
{
    int max_depth = ((const struct simple_volpath *)self)->max_depth;
    struct sr_ray ray = start->ray;
    const struct sr_medium *medium = start->medium;
    struct sr_rng rng = sr_rng_seed((uint64_t)sampler->key << 32 | sampler->sample, SR_USE_BOUNCE);
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    sr_wavelengths_terminate_secondary(w);
    for (int bounce = 0, passed = 0;;) {
        struct sr_hit x;
        bool is_hit = sr_trace(scene, &ray, &x, worker);
        if (first && bounce == 0)
            *first = is_hit ? x : (struct sr_hit){.t = INFINITY};
        struct sr_medium_at at;
        float t;
        enum event event = medium ? collide(medium, &ray, is_hit ? x.t : INFINITY, w, &rng, &t, &at) : THROUGH;
        if (event == ABSORBED)
            return L + beta * at.Le;
        if (event == GIVEN_UP)
            return SR_BLACK + NAN;
        if (event == SCATTERED) {
            if (bounce++ == max_depth)
                return L;
            worker->vertices += 1;
            ray.o = sr_mad(ray.o, t, ray.d);
            sr_phase_hg_sample(ray.d, at.g, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &ray.d);
            continue;
        }
        if (!is_hit)
            return L + beta * sr_escape_Le(scene, &ray, w);
        L += beta * sr_hit_Le(scene, &x, sr_neg(ray.d), w);
        struct sr_bsdf bsdf = {.model = NULL};
        struct sr_frame frame;
        if (x.material && bounce == max_depth)
            return L;
        if (x.material) {
            if (bounce == 0)
                sr_first_footprint(start, &x.point);
            sr_material_shade(x.material, &x.point, sr_neg(ray.d), sr_rng_float(&rng), sr_rng_u32(&rng), w, &bsdf,
                              &frame);
        }
        if (!bsdf.model) {
            if (++passed > MOST_PASSED)
                return L;
            medium = sr_hit_medium(&x, ray.d, medium);
            ray = sr_leave(&x.point, ray.d);
            continue;
        }
        worker->vertices += 1;
        struct sr_bsdf_sample s;
        sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
        if (!sr_bsdf_sample(&bsdf, sr_to_local(&frame, sr_neg(ray.d)), sr_rng_float(&rng), u, SR_RADIANCE, &s))
            return L;
        beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
        ray = sr_leave(&x.point, sr_to_world(&frame, s.wi));
        medium = sr_hit_medium(&x, ray.d, medium);
        ++bounce;
    }
}

static const char *blind(const void *self, const struct sr_scene *scene)
{
    (void)self;
    return sr_has_delta_lights(scene)
               ? "point, spot and distant lights are missing: no direction that is drawn leads to them"
               : NULL;
}

const struct sr_integrator_model sr_integrator_simple_volpath = {
    .name = "simplevolpath",
    .text = "photons of one wavelength through media, played out as they are",
    .params = params,
    .size = sizeof(struct simple_volpath),
    .L = simple_volpath_L,
    .blind = blind,
    .knows_media = true,
};
