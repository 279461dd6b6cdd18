/* SPDX-License-Identifier: MIT */
/* Free flight through media: exact where they are uniform, by null collisions where they are not.
 *
 * A collision at t against the majorant m is real with the share sigma_t / m. With P = T_m(t) = exp(-m t),
 *
 *     scattered:  f *= sigma_s P,      q *= sigma_t P
 *     null:       f *= (m - sigma_t) P,  q *= (m - sigma_t) P,   r *= m P     (a light's way does not ask, and goes on)
 *     through:    f *= P,  q *= P,  r *= P                                     each over the first wavelength's density
 *
 * Where nothing scatters, no collision is real: what is absorbed is a weight. Uniform media (m = sigma_t) have no null
 * collisions, light's ways through them are not drawn at all, and what they emit is integrated. */
#include "integrator/flight.h"

#include <float.h>

enum { MOST_PASSED = 1000 };

// (1 - exp(-x)) / x for small x
static sr_spectrum mean_transmittance(sr_spectrum x)
{
    return 1.0f - x * (0.5f - x * (1.0f / 6 - x * (1.0f / 24 - x * (1.0f / 120))));
}

static inline bool is_any(sr_spectrum s)
{
    return sr_spectrum_any(s > 0.0f);
}

static enum sr_flight fly_uniform(const struct sr_medium *medium, float length, float *depth,
                                  const struct sr_medium_at *at, struct sr_carried *c, float *t)
{
    sr_spectrum sigma_t = at->sigma_a + at->sigma_s;
    length = sr_min(length, FLT_MAX); // 0 of something infinite is still nothing
    if (medium->model->glows(medium->self)) {
        sr_spectrum tau = sigma_t * length, emission = at->sigma_a * at->Le;
        sr_spectrum thick = sr_spectrum_select(
            sigma_t > 0.0f, emission / sr_spectrum_select(sigma_t > 0.0f, sigma_t, SR_ONE), SR_BLACK);
        sr_spectrum emitted = sr_spectrum_select(tau > 0.1f, thick * (1.0f - sr_spectrum_exp(-tau)),
                                                 emission * length * mean_transmittance(tau));
        c->L += c->f * emitted * (1 / sr_spectrum_mean(c->q));
    }
    if (!is_any(at->sigma_s)) {
        c->f *= sr_spectrum_exp(-sigma_t * length);
        return SR_FLIGHT_THROUGH;
    }
    float first = sigma_t[0], tau = first * length;
    if (*depth >= tau) { // others are relative to the first, whose own exponential is that of light's ways
        sr_spectrum T = sr_spectrum_exp((first - sigma_t) * length);
        *depth -= tau;
        c->f *= T;
        c->q *= T;
        c->r *= sr_spectrum_exp(SR_BLACK + tau);
        return SR_FLIGHT_THROUGH;
    }
    *t = *depth / first;
    sr_spectrum T = sr_spectrum_exp((first - sigma_t) * *t) * (1 / first);
    c->f *= at->sigma_s * T;
    c->q *= sigma_t * T;
    return is_any(c->f) ? SR_FLIGHT_SCATTERED : SR_FLIGHT_LOST;
}

enum sr_flight sr_fly(const struct sr_medium *medium, const struct sr_ray *ray, float length,
                      const struct sr_wavelengths *w, struct sr_rng *rng, float *depth, struct sr_medium_at *at,
                      struct sr_carried *c, float *t)
{
    const struct sr_medium_model *model = medium->model;
    if (model->is_uniform)
        return fly_uniform(medium, length, depth, at, c, t);
    bool glows = model->glows(medium->self);
    struct sr_medium_walk walk;
    struct sr_medium_segment s;
    model->begin(medium->self, ray->o, ray->d, length, w, &walk);
    while (model->next(medium->self, &walk, &s)) {
        float first = s.majorant[0];
        *t = s.t0;
        for (int nulls = 0;; ++nulls) {
            float rest = s.t1 - *t;
            if (*depth >= first * rest) {
                sr_spectrum P = sr_spectrum_exp((first - s.majorant) * rest);
                *depth -= first * rest;
                c->f *= P;
                c->q *= P;
                c->r *= P;
                break;
            }
            float step = *depth / first;
            sr_spectrum P = sr_spectrum_exp((first - s.majorant) * step) * (1 / first);
            *t += step;
            model->at(medium->self, sr_mad(ray->o, *t, ray->d), w, at);
            if (glows && is_any(at->Le * at->sigma_a))
                c->L += c->f * P * at->sigma_a * at->Le * (1 / sr_spectrum_mean(c->q * P * s.majorant));
            sr_spectrum sigma_t = at->sigma_a + at->sigma_s;
            sr_spectrum real = is_any(at->sigma_s) ? sigma_t : SR_BLACK, null = s.majorant - sigma_t;
            float share = sr_min(real[0] / first, 1);
            if (sr_rng_float(rng) < share) {
                P *= 1 / share;
                c->f *= at->sigma_s * P;
                c->q *= real * P;
                return is_any(c->f) ? SR_FLIGHT_SCATTERED : SR_FLIGHT_LOST;
            }
            P *= 1 / (1 - share);
            c->f *= sr_spectrum_select(null > 0.0f, null, SR_BLACK) * P;
            c->q *= sr_spectrum_select(s.majorant > real, s.majorant - real, SR_BLACK) * P;
            c->r *= s.majorant * P;
            if (SR_UNLIKELY(nulls >= SR_MOST_NULLS))
                c->L = c->f = SR_BLACK + NAN;
            if (!is_any(c->f))
                return SR_FLIGHT_LOST;
            *depth = -log1pf(-sr_rng_float(rng));
        }
    }
    return SR_FLIGHT_THROUGH;
}

bool sr_pass(const struct sr_medium *medium, sr_vec3 o, sr_vec3 d, float length, const struct sr_wavelengths *w,
             struct sr_rng *rng, struct sr_passage *p)
{
    const struct sr_medium_model *model = medium->model;
    struct sr_medium_at at;
    if (model->is_uniform) {
        model->at(medium->self, o, w, &at);
        sr_spectrum T = sr_spectrum_exp(-(at.sigma_a + at.sigma_s) * sr_min(length, FLT_MAX));
        p->T *= T;
        if (is_any(at.sigma_s))
            p->U *= T;
        return is_any(p->T);
    }
    struct sr_medium_walk walk;
    struct sr_medium_segment s;
    float depth = -log1pf(-sr_rng_float(rng));
    model->begin(medium->self, o, d, length, w, &walk);
    while (model->next(medium->self, &walk, &s)) {
        float first = s.majorant[0], t = s.t0;
        for (int nulls = 0;; ++nulls) {
            float rest = s.t1 - t;
            bool is_through = depth >= first * rest;
            float step = is_through ? rest : depth / first;
            sr_spectrum P = sr_spectrum_exp((first - s.majorant) * step);
            if (is_through) {
                depth -= first * rest;
                p->T *= P;
                p->S *= P;
                p->U *= P;
                break;
            }
            t += step;
            P *= 1 / first;
            model->at(medium->self, sr_mad(o, t, d), w, &at);
            sr_spectrum null = s.majorant - (at.sigma_a + at.sigma_s);
            null = sr_spectrum_select(null > 0.0f, null, SR_BLACK);
            p->T *= null * P;
            p->S *= s.majorant * P;
            p->U *= (is_any(at.sigma_s) ? null : s.majorant) * P;
            if (SR_UNLIKELY(nulls >= SR_MOST_NULLS)) {
                p->T = SR_BLACK + NAN;
                return true;
            }
            // what is almost nothing ends by lot, the same for whichever wavelength is the first
            float left = sr_spectrum_max(p->T) / sr_spectrum_mean(p->S);
            if (left < 0.05f) {
                if (!(left > 0) || sr_rng_float(rng) >= 0.25f)
                    return false;
                p->T *= 4.0f;
            }
            depth = -log1pf(-sr_rng_float(rng));
        }
    }
    return true;
}

bool sr_pass_to_light(const struct sr_scene *scene, const struct sr_point *x, const struct sr_medium *medium,
                      const struct sr_light_sample *l, const struct sr_wavelengths *w, struct sr_rng *rng,
                      struct sr_worker *worker, struct sr_passage *p)
{
    *p = (struct sr_passage){SR_ONE, SR_ONE, SR_ONE};
    if (!sr_scene_has_interfaces(scene))
        return sr_unoccluded(scene, x, l, worker) && (!medium || sr_pass(medium, x->p, l->wi, l->distance, w, rng, p));

    struct sr_ray ray = sr_shadow_ray(x, l);
    bool is_far = isinf(l->distance);
    for (int passed = 0; passed < MOST_PASSED; ++passed) {
        struct sr_hit hit;
        float unit = is_far ? 1 : sr_length(ray.d); // [m] of the ray's own measure
        bool is_hit = sr_trace_bare(scene, &ray, &hit, worker);
        if (is_hit && hit.material)
            return false;
        float length = is_hit ? hit.t * unit : is_far ? INFINITY : unit;
        if (medium && length > 0 && !sr_pass(medium, ray.o, sr_scale(1 / unit, ray.d), length, w, rng, p))
            return false;
        if (!is_hit)
            return true;
        medium = sr_hit_medium(&hit, l->wi, medium);
        ray.o = sr_point_offset(&hit.point, l->wi);
        ray.d = is_far ? l->wi : sr_sub(l->p, ray.o);
    }
    return false;
}
