/* SPDX-License-Identifier: MIT */
/* One particle of light from its birth to its end: what power balances and goniophotometers count.
 *
 *     flux that arrives = flux that goes on + flux that is absorbed           [lm], at each wavelength of the particle
 *
 * What goes on is beta f |cos theta| / pdf, so that its expectation is the albedo's share; a particle survives by the share
 * of its strongest wavelength, as a photon would, and then carries on what it had: so sums balance only in the mean, and how
 * well they do tells something. Limits: shading normals that differ from the surface's neither absorb nor keep exactly. */
#include "integrator/vertices.h"

enum { MOST_SCATTERINGS = 100000, MOST_PASSED = 1000 };

static float strongest(sr_spectrum beta, const struct sr_wavelengths *w)
{
    return sr_wavelengths_secondary_terminated(w) ? beta[0] : sr_spectrum_max(beta);
}

void sr_follow_particle(const struct sr_scene *scene, const struct sr_sampler *sampler, struct sr_wavelengths *w, const struct sr_particle_watch *watch,
                        struct sr_worker *worker)
{
    sr_u4 u = sr_sample4(sampler, SR_USE_LIGHT_PATH), u_place = sr_sample4(sampler, SR_USE_LIGHT_PATH + 1);
    struct sr_light_ray r;
    if (!sr_lights_emit(sr_scene_lights(scene), u[2], (sr_vec2){u_place[0], u_place[1]}, (sr_vec2){u[0], u[1]}, w, &r) || !sr_has_come_in(scene, &r, worker))
        return;
    bool has_surface = sr_length2(r.from.n) > 0;
    sr_spectrum beta = r.L * ((has_surface ? fabsf(sr_dot(r.from.n, r.w)) : 1) / (r.pmf * r.pdf_area * r.pdf_direction));
    watch->event(watch->user, SR_PARTICLE_EMITTED, NULL, r.w, beta, w);
    struct sr_ray ray = sr_leave(&r.from, r.w);
    ray.time = u_place[2];
    for (int scatterings = 0, passed = 0;;) {
        struct sr_hit x;
        if (!sr_trace_bare(scene, &ray, &x, worker)) {
            watch->event(watch->user, SR_PARTICLE_ESCAPED, NULL, ray.d, beta, w);
            return;
        }
        if (scatterings >= MOST_SCATTERINGS || passed > MOST_PASSED) {
            watch->event(watch->user, SR_PARTICLE_GIVEN_UP, &x, ray.d, beta, w);
            return;
        }
        struct sr_bsdf bsdf = {.model = NULL};
        struct sr_frame frame;
        sr_u4 u_survive, u_bsdf;
        if (x.material) {
            uint32_t group = SR_USE_LIGHT_PATH + 2 + 2 * (uint32_t)scatterings;
            sr_sample8(sampler, group, &u_survive, &u_bsdf);
            sr_point_set_footprint(&x.point, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 0});
            uint32_t seed = sampler->key + sampler->sample * 0x9e3779b9u + group * 0x85ebca6bu;
            sr_material_shade(x.material, &x.point, sr_neg(ray.d), u_bsdf[3], seed, w, &bsdf, &frame);
        }
        if (!bsdf.model) {
            ++passed;
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
            rest = beta * s.f * (in_cos > 0 ? sr_abs_cos_theta(back) * out_cos / (in_cos * s.pdf) : 0);
        }
        watch->event(watch->user, SR_PARTICLE_ABSORBED, &x, ray.d, beta - rest, w);
        float survive = strongest(rest, w) / strongest(beta, w);
        if (!(survive > 0) || u_survive[3] >= survive)
            return;
        beta = rest * (survive < 1 ? 1 / survive : 1);
        ray = sr_leave(&x.point, out);
    }
}
