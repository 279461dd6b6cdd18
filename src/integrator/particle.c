/* SPDX-License-Identifier: MIT */
/* One particle of light from its birth to its end: what power balances and goniophotometers count.
 *
 *     flux that arrives = flux that goes on + flux that is absorbed           [lm], at each wavelength of the particle
 *
 * What goes on is beta f |cos theta| / pdf, so that its expectation is the albedo's share; a particle survives by the
 * share of its strongest wavelength, as a photon would, and then carries on what it had: so sums balance only in the
 * mean, and how well they do tells something. Media take part; that they glow does not. Limits: shading normals that
 * differ from the surface's neither absorb nor keep exactly. */
#include "integrator/flight.h"
#include "integrator/shade.h"
#include "integrator/vertices.h"

enum { MOST_SCATTERINGS = 100000, MOST_PASSED = 1000 };

// the wavelengths share what any of them would have drawn; one that dispersion has left alone does not
static sr_spectrum flux_of(const struct sr_carried *c, const struct sr_wavelengths *w)
{
    return c->f * (1 / (sr_wavelengths_secondary_terminated(w) ? c->q[0] : sr_spectrum_mean(c->q)));
}

static float strongest(sr_spectrum beta, const struct sr_wavelengths *w)
{
    return sr_wavelengths_secondary_terminated(w) ? beta[0] : sr_spectrum_max(beta);
}

/* Through a medium as far as `length`. What the throughput loses is absorbed, whether it is a chance or a weight; where
 * chance has it that more goes on, less than nothing is. false: nothing is left. */
static bool go_through(const struct sr_medium *medium, float length, const struct sr_particle_watch *watch,
                       const struct sr_wavelengths *w, struct sr_rng *rng, struct sr_ray *ray, struct sr_carried *c,
                       bool *is_scattered)
{
    struct sr_medium_at at;
    if (medium->model->is_uniform)
        medium->model->at(medium->self, ray->o, w, &at);
    float depth = -log1pf(-sr_rng_float(rng)), t;
    sr_spectrum before = flux_of(c, w);
    enum sr_flight flight = sr_fly(medium, ray, length, w, rng, &depth, &at, c, &t);
    sr_spectrum after = flux_of(c, w);
    watch->event(watch->user, SR_PARTICLE_ABSORBED, &(struct sr_hit){.t = length}, ray->d, before - after, w);
    float survive = strongest(after, w) / strongest(before, w);
    if (flight == SR_FLIGHT_LOST || !(survive > 0) || sr_rng_float(rng) >= survive)
        return false;
    c->f *= survive < 1 ? 1 / survive : 1;
    *is_scattered = flight == SR_FLIGHT_SCATTERED;
    if (*is_scattered) {
        ray->o = sr_mad(ray->o, t, ray->d);
        sr_phase_hg_sample(ray->d, at.g, (sr_vec2){sr_rng_float(rng), sr_rng_float(rng)}, &ray->d);
    }
    return true;
}

void sr_follow_particle(const struct sr_scene *scene, const struct sr_sampler *sampler, struct sr_wavelengths *w,
                        const struct sr_particle_watch *watch, struct sr_worker *worker)
{
    sr_u4 u = sr_sample4(sampler, SR_USE_LIGHT_PATH), u_place = sr_sample4(sampler, SR_USE_LIGHT_PATH + 1);
    struct sr_light_ray r;
    if (!sr_lights_emit(sr_scene_lights(scene), u[2], (sr_vec2){u_place[0], u_place[1]}, (sr_vec2){u[0], u[1]}, w,
                        &r) ||
        !sr_has_come_in(scene, &r, worker))
        return;
    bool has_surface = sr_length2(r.from.n) > 0;
    struct sr_carried c = {.q = SR_ONE};
    c.f = r.L * ((has_surface ? fabsf(sr_dot(r.from.n, r.w)) : 1) / (r.pmf * r.pdf_area * r.pdf_direction));
    watch->event(watch->user, SR_PARTICLE_EMITTED, NULL, r.w, c.f, w);
    struct sr_ray ray = sr_leave(&r.from, r.w);
    ray.time = u_place[2];
    struct sr_rng rng = sr_rng_seed((uint64_t)sampler->key << 32 | sampler->sample, SR_USE_LIGHT_PATH);
    const struct sr_medium *medium = sr_scene_medium_at(scene, &ray);
    for (int scatterings = 0, passed = 0;;) {
        struct sr_hit x;
        bool is_hit = sr_trace_bare(scene, &ray, &x, worker);
        if (medium && scatterings < MOST_SCATTERINGS) {
            bool is_scattered;
            if (!go_through(medium, is_hit ? x.t : INFINITY, watch, w, &rng, &ray, &c, &is_scattered))
                return;
            scatterings += is_scattered;
            worker->vertices += is_scattered;
            if (is_scattered)
                continue;
        }
        if (!is_hit) {
            watch->event(watch->user, SR_PARTICLE_ESCAPED, NULL, ray.d, flux_of(&c, w), w);
            return;
        }
        if (scatterings >= MOST_SCATTERINGS || passed > MOST_PASSED) {
            watch->event(watch->user, SR_PARTICLE_GIVEN_UP, &x, ray.d, flux_of(&c, w), w);
            return;
        }
        struct sr_bsdf bsdf = {.model = NULL};
        struct sr_frame frame;
        sr_u4 u_survive, u_bsdf;
        if (x.material) {
            uint32_t group = SR_USE_LIGHT_PATH + 2 + 2 * (uint32_t)scatterings;
            sr_sample8(sampler, group, &u_survive, &u_bsdf);
            sr_point_set_footprint(&x.point, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 0});
            uint32_t seed = sr_shade_seed(sampler, group);
            sr_material_shade(x.material, &x.point, sr_neg(ray.d), u_bsdf[3], seed, w, &bsdf, &frame);
        }
        if (!bsdf.model) {
            ++passed;
            medium = sr_hit_medium(&x, ray.d, medium);
            ray = sr_leave(&x.point, ray.d);
            continue;
        }
        ++scatterings;
        worker->vertices += 1;
        sr_vec3 back = sr_to_local(&frame, sr_neg(ray.d));
        struct sr_bsdf_sample s;
        sr_spectrum rest = SR_BLACK;
        sr_vec3 out = sr_neg(ray.d);
        if (back.z != 0 && sr_bsdf_sample(&bsdf, back, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, SR_IMPORTANCE, &s)) {
            out = sr_to_world(&frame, s.wi);
            float in_cos = fabsf(sr_dot(x.point.n, ray.d)), out_cos = fabsf(sr_dot(x.point.n, out));
            rest = c.f * s.f * (in_cos > 0 ? sr_abs_cos_theta(back) * out_cos / (in_cos * s.pdf) : 0);
        }
        sr_spectrum before = flux_of(&c, w);
        float survive = strongest(rest, w) / strongest(c.f, w);
        c.f = rest;
        watch->event(watch->user, SR_PARTICLE_ABSORBED, &x, ray.d, before - flux_of(&c, w), w);
        if (!(survive > 0) || u_survive[3] >= survive)
            return;
        c.f *= survive < 1 ? 1 / survive : 1;
        ray = sr_leave(&x.point, out);
        medium = sr_hit_medium(&x, out, medium);
    }
}
