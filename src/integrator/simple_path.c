/* SPDX-License-Identifier: MIT */
/* The plain twin of the path tracer: no weighing of two strategies, no roulette.
 *
 *     L(x, wo) = Le(x, wo) + integral f(wo, wi) L(x, wi) |cos theta_i| dwi        [W m^-2 sr^-1 nm^-1]
 *
 * Light arrives either by light sampling or by the surface's own directions, never by both, so each is counted once. */
#include "integrator/shade.h"

struct simple_path {
    int32_t max_depth; // most scatterings of a path
    bool sample_lights, sample_bsdf;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct simple_path, max_depth), "most scatterings of a path"},
    {SR_PARAM_BOOL, "samplelights", "1", 0, 1, 1, offsetof(struct simple_path, sample_lights),
     "light by sampling the lights"},
    {SR_PARAM_BOOL, "samplebsdf", "1", 0, 1, 1, offsetof(struct simple_path, sample_bsdf),
     "directions by the BSDF, else uniform"},
    {.name = NULL},
};

static sr_spectrum simple_path_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                                 const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                                 struct sr_worker *worker)
{
    const struct simple_path *path = self;
    const struct sr_lights *lights = sr_scene_lights(scene);
    struct sr_ray ray = start->ray;
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    bool count_Le = true; // light sampling has not yet counted what this ray may meet
    int passed = 0;

    for (int bounce = 0;;) {
        struct sr_hit x;
        bool is_hit = sr_trace(scene, &ray, &x, worker);
        if (first && bounce == 0)
            *first = is_hit ? x : (struct sr_hit){.t = INFINITY};
        if (!is_hit) {
            for (uint32_t i = 0; i < lights->infinite_count; ++i) {
                struct sr_light l = lights->lights[lights->infinite[i]];
                float density; // some can only be met
                sr_spectrum Le = l.model->Le_pdf(l.self, ray.o, ray.d, w, &density);
                if (count_Le || !(density > 0))
                    L += beta * Le;
            }
            return L;
        }
        if (count_Le)
            L += beta * sr_hit_Le(scene, &x, sr_neg(ray.d), w);
        if (bounce == path->max_depth && x.material)
            return L;
        if (bounce == 0) {
            sr_first_footprint(start, &x.point);
            if (first)
                first->point = x.point;
        }
        uint32_t group = SR_USE_BOUNCE + 2 * (uint32_t)bounce;
        sr_u4 u_light = sr_sample4(sampler, group), u_bsdf = sr_sample4(sampler, group + 1);
        struct sr_bsdf bsdf;
        struct sr_frame frame;
        if (!sr_shade(&x, ray.d, u_bsdf[3], sr_hash_combine(sampler->key + sampler->sample, group), w, &bsdf, &frame)) {
            if (!sr_pass_by(&x, &ray, &passed))
                return L;
            continue;
        }
        worker->vertices += 1;
        sr_vec3 wo = sr_to_local(&frame, sr_neg(ray.d));

        uint32_t index;
        float pmf;
        struct sr_light_sample l;
        if (path->sample_lights && sr_lights_pick(lights, &x.point, u_light[2], &index, &pmf) &&
            sr_light_draw(lights->lights[index], &x.point, (sr_vec2){u_light[0], u_light[1]}, w, &l)) {
            sr_vec3 wi = sr_to_local(&frame, l.wi);
            sr_spectrum f = sr_bsdf_f(&bsdf, wo, wi, SR_RADIANCE) * sr_abs_cos_theta(wi);
            if (sr_spectrum_max(f) > 0 && sr_unoccluded(scene, &x.point, &l, worker))
                L += beta * f * l.L / (pmf * l.pdf);
        }

        uint32_t lobes = sr_bsdf_lobes(&bsdf);
        if (path->sample_bsdf || (lobes & SR_LOBE_SPECULAR)) {
            struct sr_bsdf_sample s;
            if (!sr_bsdf_sample(&bsdf, wo, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, SR_RADIANCE, &s))
                return L;
            beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
            count_Le = !path->sample_lights || (s.lobe & SR_LOBE_SPECULAR);
            ray = sr_leave(&x.point, sr_to_world(&frame, s.wi));
        } else {
            sr_vec3 wi = sr_warp_uniform_hemisphere((sr_vec2){u_bsdf[0], u_bsdf[1]});
            float pdf = 1 / (2 * SR_PI);
            bool reflects = lobes & SR_LOBE_REFLECTION, transmits = lobes & SR_LOBE_TRANSMISSION;
            if (reflects && transmits) {
                wi = sr_warp_uniform_sphere((sr_vec2){u_bsdf[0], u_bsdf[1]});
                pdf = 1 / (4 * SR_PI);
            } else if ((wo.z < 0) == reflects) {
                wi.z = -wi.z;
            }
            beta *= sr_bsdf_f(&bsdf, wo, wi, SR_RADIANCE) * (sr_abs_cos_theta(wi) / pdf);
            count_Le = !path->sample_lights;
            ray = sr_leave(&x.point, sr_to_world(&frame, wi));
        }
        if (!(sr_spectrum_max(beta) > 0))
            return L;
        ++bounce;
    }
}

static const char *blind(const void *self, const struct sr_scene *scene)
{
    return !((const struct simple_path *)self)->sample_lights && sr_has_delta_lights(scene)
               ? "point, spot and distant lights are missing: no direction that is drawn leads to them"
               : NULL;
}

const struct sr_integrator_model sr_integrator_simple_path = {
    .name = "simplepath",
    .text = "paths from the sensor; lights sampled, or BSDFs, nothing weighed",
    .params = params,
    .size = sizeof(struct simple_path),
    .L = simple_path_L,
    .blind = blind};
