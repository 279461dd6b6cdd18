/* SPDX-License-Identifier: MIT */
/* Light tracing: the rendering equation from the other end. Particles leave the lights and tell the target, a picture
 * or a meter, of every surface that scatters them.
 *
 *     I = integral We(x, w) L(x, w) |cos theta| dA dw = E[ sum over vertices beta f(w, wi) |cos theta| We V ]
 *
 * J. Arvo, Backward ray tracing, 1986; the adjoint: E. Veach, 1997, 4. Light that the sensor sees without scattering
 * comes by its own rays. Limits: nothing is seen in mirrors and through clear glass, for no particle leaves them
 * straight toward the target; paths end after 100 scatterings. */
#include "integrator/vertices.h"

struct light_path {
    int32_t max_depth;
    int32_t light_sampler; // enum sr_light_choice: of receivers; particles are begun by power
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct light_path, max_depth),
     "most scatterings of a path; 100 at most are followed"},
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct light_path, light_sampler),
     "bvh|power|uniform|exhaustive"},
    {.name = NULL},
};

static sr_spectrum light_path_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                                const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                                struct sr_worker *worker)
{
    (void)self;
    (void)sampler;
    struct sr_ray ray = start->ray;
    sr_spectrum L = SR_BLACK;
    for (int passed = 0; passed < 1000; ++passed) {
        struct sr_hit hit;
        bool is_hit = sr_trace(scene, &ray, &hit, worker);
        if (first && passed == 0) {
            *first = is_hit ? hit : (struct sr_hit){.t = INFINITY};
            if (is_hit)
                sr_first_footprint(start, &first->point);
        }
        if (!is_hit || hit.light != SR_NO_LIGHT)
            L += sr_met_at_once(scene, start, is_hit ? &hit : NULL, ray.d, w);
        if (!is_hit || hit.material)
            break;
        ray = sr_leave(&hit.point, ray.d);
    }
    return L;
}

static void light_path_splat(const void *self, const struct sr_scene *scene, struct sr_wavelengths *w,
                             struct sr_worker *worker)
{
    const struct light_path *m = self;
    const struct sr_target *target = worker->target;
    struct sr_vertex v[SR_MAX_SCATTERINGS + 1];
    struct sr_walk walk = {.scene = scene,
                           .mode = SR_IMPORTANCE,
                           .start = target->middle,
                           .sampler = &target->sampler,
                           .first_group = SR_USE_LIGHT_PATH + 2,
                           .max_scatterings = m->max_depth < SR_MAX_SCATTERINGS ? m->max_depth : SR_MAX_SCATTERINGS,
                           .w = w,
                           .worker = worker};
    struct sr_light_path path = sr_light_vertices(&walk, v);
    for (int s = 1; s < path.count; ++s) {
        sr_u4 u = sr_sample4(&target->sampler, walk.first_group + 2 * (uint32_t)(s - 1));
        struct sr_sensor_view view;
        sr_spectrum gain;
        if (sr_vertex_seen(&v[s], target, (sr_vec2){u[0], u[1]}, &view, &gain) &&
            sr_vertices_see(scene, &v[s], view.p, view.wi, view.distance, worker))
            target->add(target->user, view.raster, gain, w);
    }
}

static const char *blind(const void *self, const struct sr_scene *scene)
{
    if (sr_scene_has_mirrors(scene))
        return "what is seen in a mirror or through clear glass is missing: paths from the lights do not lead from there to the sensor";
    return sr_long_paths_missing(((const struct light_path *)self)->max_depth);
}

const struct sr_integrator_model sr_integrator_light_path = {
    .blind = blind,
    .name = "lightpath",
    .text = "paths from the lights alone: the adjoint equation",
    .params = params,
    .size = sizeof(struct light_path),
    .L = light_path_L,
    .knows_receivers = true,
    .splats = true,
    .splat = light_path_splat,
};
