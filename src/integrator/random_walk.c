/* SPDX-License-Identifier: MIT */
/* The barest estimator: directions uniform over the sphere, light only where a ray happens to meet it.
 *
 *     L(x, wo) = Le(x, wo) + 4 pi E[ f(wo, wi) |cos theta_i| L(x, wi) ]           [W m^-2 sr^-1 nm^-1]
 *
 * It cannot see through mirrors and glass, whose directions have no chance of being drawn. */
#include "integrator/shade.h"

struct random_walk {
    int32_t max_depth; // most scatterings of a path
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct random_walk, max_depth), "most scatterings of a path"},
    {.name = NULL},
};

static sr_spectrum random_walk_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                                 const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                                 struct sr_worker *worker)
{
    const struct random_walk *walk = self;
    struct sr_ray ray = start->ray;
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    int passed = 0;
    for (int bounce = 0;;) {
        struct sr_hit x;
        bool is_hit = sr_trace(scene, &ray, &x, worker);
        if (first && bounce == 0)
            *first = is_hit ? x : (struct sr_hit){.t = INFINITY};
        if (!is_hit)
            return L + beta * sr_escape_Le(scene, &ray, w);
        L += beta * sr_hit_Le(scene, &x, sr_neg(ray.d), w);
        if (bounce == walk->max_depth && x.material)
            return L;
        if (bounce == 0) {
            sr_first_footprint(start, &x.point);
            if (first)
                first->point = x.point;
        }
        uint32_t group = SR_USE_BOUNCE + 2 * (uint32_t)bounce;
        sr_u4 u = sr_sample4(sampler, group + 1);
        struct sr_bsdf bsdf;
        struct sr_frame frame;
        if (!sr_shade(&x, ray.d, u[3], sr_hash_combine(sampler->key + sampler->sample, group), w, &bsdf, &frame)) {
            if (!sr_pass_by(&x, &ray, &passed))
                return L;
            continue;
        }
        worker->vertices += 1;
        sr_vec3 wi = sr_warp_uniform_sphere((sr_vec2){u[0], u[1]});
        beta *=
            sr_bsdf_f(&bsdf, sr_to_local(&frame, sr_neg(ray.d)), wi, SR_RADIANCE) * (sr_abs_cos_theta(wi) * 4 * SR_PI);
        if (!(sr_spectrum_max(beta) > 0))
            return L;
        ray = sr_leave(&x.point, sr_to_world(&frame, wi));
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

const struct sr_integrator_model sr_integrator_random_walk = {
    .name = "randomwalk",
    .text = "directions even over the sphere; light where a ray happens to meet it",
    .params = params,
    .size = sizeof(struct random_walk),
    .L = random_walk_L,
    .blind = blind};
