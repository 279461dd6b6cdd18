/* SPDX-License-Identifier: MIT */
/* Ambient occlusion: how much of the hemisphere is free within a distance.
 *
 *     A(x) = 1/pi integral V(x, x + wi max_distance) cos theta_i dwi              [1]
 *
 * shown under the output colour space's white, so that a free surface is 1. */
#include "integrator/integrator.h"

struct ambient_occlusion {
    bool cosine;        // directions in proportion to the cosine, else uniform
    float max_distance; // [m]
};

static const struct sr_param params[] = {
    {SR_PARAM_BOOL, "cossample", "1", 0, 1, 1, offsetof(struct ambient_occlusion, cosine),
     "cosine-weighted directions"},
    {SR_PARAM_FLOAT, "maxdistance", "m", 0, INFINITY, INFINITY, offsetof(struct ambient_occlusion, max_distance),
     "farthest occluder"},
    {.name = NULL},
};

static sr_spectrum ambient_occlusion_L(const void *self, const struct sr_scene *scene,
                                       const struct sr_path_start *start, const struct sr_sampler *sampler,
                                       struct sr_wavelengths *w, struct sr_hit *first, struct sr_worker *worker)
{
    const struct ambient_occlusion *ao = self;
    struct sr_ray ray = start->ray;
    struct sr_hit x;
    bool is_hit = false;
    for (int passed = 0; passed < 1000; ++passed) {
        is_hit = sr_trace(scene, &ray, &x, worker);
        if (!is_hit || x.material)
            break;
        ray = sr_leave(&x.point, ray.d);
    }
    if (first)
        *first = is_hit ? x : (struct sr_hit){.t = INFINITY};
    if (!is_hit || !x.material)
        return SR_BLACK;
    sr_first_footprint(start, &x.point);
    if (first)
        first->point = x.point;

    sr_u4 u = sr_sample4(sampler, SR_USE_BOUNCE);
    sr_vec3 n = sr_face_forward(x.point.n, sr_neg(ray.d));
    struct sr_frame frame = sr_frame_from_zx(n, x.point.dpdu);
    sr_vec3 wi = ao->cosine ? sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]})
                            : sr_warp_uniform_hemisphere((sr_vec2){u[0], u[1]});
    float pdf = ao->cosine ? sr_warp_cosine_hemisphere_pdf(wi.z) : 1 / (2 * SR_PI);
    if (!(pdf > 0))
        return SR_BLACK;
    struct sr_light_sample target = {.wi = sr_to_world(&frame, wi), .distance = ao->max_distance};
    target.p = sr_mad(x.point.p, isinf(ao->max_distance) ? 0 : ao->max_distance, target.wi);
    if (!sr_unoccluded(scene, &x.point, &target, worker))
        return SR_BLACK;
    const struct sr_colour_space *srgb = sr_colour_space(SR_SRGB);
    struct sr_spd white = {
        .kind = SR_SPD_TABLE, .scale = (float)(1 / srgb->illuminant_luminous_integral), .table = srgb->illuminant};
    return sr_spd_eval(&white, w->lambda) * (wi.z / (SR_PI * pdf));
}

const struct sr_integrator_model sr_integrator_ambient_occlusion = {
    .name = "ambientocclusion",
    .text = "how much of the hemisphere is free, cosine-weighted",
    .params = params,
    .size = sizeof(struct ambient_occlusion),
    .L = ambient_occlusion_L,
};
