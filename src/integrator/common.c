/* SPDX-License-Identifier: MIT */
/* What the estimators share: counted rays, footprints, emission. */
#include "integrator/integrator.h"

#include <string.h>

static void record(struct sr_ray_log *log, const struct sr_ray *ray, bool is_shadow)
{
    if (log->count < log->capacity)
        log->rays[log->count++] = (struct sr_logged_ray){ray->o, ray->d, ray->t_max, is_shadow};
}

bool sr_trace(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit, struct sr_worker *worker)
{
    worker->rays += 1;
    if (SR_UNLIKELY(worker->log))
        record(worker->log, ray, false);
    return sr_raycast(scene, ray, hit);
}

bool sr_trace_bare(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit, struct sr_worker *worker)
{
    worker->rays += 1;
    if (SR_UNLIKELY(worker->log))
        record(worker->log, ray, false);
    return sr_raycast_bare(scene, ray, hit);
}

bool sr_unoccluded(const struct sr_scene *scene, const struct sr_point *x, const struct sr_light_sample *s,
                   struct sr_worker *worker)
{
    struct sr_ray segment = sr_shadow_ray(x, s);
    worker->shadow_rays += 1;
    if (SR_UNLIKELY(worker->log))
        record(worker->log, &segment, true);
    return sr_is_free(scene, &segment);
}

void sr_first_footprint(const struct sr_path_start *start, struct sr_point *x)
{
    // the tangent plane n . (q - p) = 0, met by the neighbouring rays
    sr_vec3 offsets[2] = {{0, 0, 0}, {0, 0, 0}};
    const sr_vec3 *dod[2] = {&start->dodx, &start->dody}, *ddd[2] = {&start->dddx, &start->dddy};
    for (int i = 0; i < 2; ++i) {
        sr_vec3 o = sr_add(start->ray.o, *dod[i]), d = sr_add(start->ray.d, *ddd[i]);
        float cosine = sr_dot(x->n, d);
        float t = cosine != 0 ? sr_dot(x->n, sr_sub(x->p, o)) / cosine : 0;
        if (isfinite(t))
            offsets[i] = sr_sub(sr_mad(o, t, d), x->p);
    }
    sr_point_set_footprint(x, offsets[0], offsets[1]);
}

void sr_seen_footprint(const struct sr_path_start *start, struct sr_point *x)
{
    struct sr_path_start seen = *start;
    sr_vec3 a = start->ray.d, way = sr_sub(x->p, start->ray.o);
    float distance2 = sr_length2(way);
    if (distance2 > 0) {
        // the smallest rotation that takes a to b: v + k x v + k x (k x v) / (1 + a . b), k = a x b
        sr_vec3 b = sr_scale(1 / sqrtf(distance2), way), k = sr_cross(a, b);
        float c = 1 + sr_dot(a, b);
        seen.ray.d = b;
        if (c > 1e-4f) {
            sr_vec3 *turned[4] = {&seen.dodx, &seen.dody, &seen.dddx, &seen.dddy};
            for (int i = 0; i < 4; ++i) {
                sr_vec3 once = sr_cross(k, *turned[i]);
                *turned[i] = sr_mad(sr_add(*turned[i], once), 1 / c, sr_cross(k, once));
            }
        }
    }
    sr_first_footprint(&seen, x);
}

void sr_path_footprint(const struct sr_path_start *start, struct sr_hit *x, bool is_first, bool is_scattered,
                       float spread, float *width)
{
    if (is_first) {
        sr_first_footprint(start, &x->point);
        *width = 0.5f * (sr_length(x->point.dpdx) + sr_length(x->point.dpdy));
        return;
    }
    *width += is_scattered ? 0 : spread * x->t;
    if (x->has_footprint && is_scattered) {
        sr_seen_footprint(start, &x->point);
    } else if (x->has_footprint) {
        struct sr_frame tangent = sr_frame_from_z(x->point.n);
        sr_point_set_footprint(&x->point, sr_scale(*width, tangent.x), sr_scale(*width, tangent.y));
    }
}

const char *sr_integrator_blind(const struct sr_integrator *i, const struct sr_scene *scene)
{
    if (sr_scene_has_media(scene) && !i->model->knows_media)
        return "media are taken for vacuum, as by pbrt's estimators of that kind; volpath knows them";
    const char *own = i->model->blind ? i->model->blind(i->self, scene) : NULL;
    if (!own && sr_scene_has_subsurface(scene) && !(i->model->enters_bodies && i->model->enters_bodies(i->self)))
        return "translucent bodies (\"subsurface\") are taken for clear ones: the light that they scatter is missing";
    return own;
}

bool sr_has_delta_lights(const struct sr_scene *scene)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    for (uint32_t i = 0; i < lights->count; ++i)
        if (lights->lights[i].model->is_delta)
            return true;
    return false;
}

bool sr_has_come_in(const struct sr_scene *scene, const struct sr_light_ray *r, struct sr_worker *worker)
{
    struct sr_light_sample outside = {.wi = sr_neg(r->w), .distance = INFINITY};
    return SR_LIKELY(!r->has_passed) || sr_unoccluded(scene, &r->from, &outside, worker);
}

sr_spectrum sr_escape_Le(const struct sr_scene *scene, const struct sr_ray *ray,
                         const struct sr_wavelengths *wavelengths)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    sr_spectrum Le = SR_BLACK;
    for (uint32_t i = 0; i < lights->infinite_count; ++i) {
        struct sr_light light = lights->lights[lights->infinite[i]];
        if (!light.model->is_delta)
            Le += sr_light_escaping(light, ray->o, ray->d, wavelengths);
    }
    return Le;
}

sr_spectrum sr_hit_Le(const struct sr_scene *scene, const struct sr_hit *hit, sr_vec3 w,
                      const struct sr_wavelengths *wavelengths)
{
    if (hit->light == SR_NO_LIGHT)
        return SR_BLACK;
    struct sr_light light = sr_scene_lights(scene)->lights[hit->light];
    return light.model->Le(light.self, &hit->point, w, wavelengths);
}

extern const struct sr_integrator_model sr_integrator_light_path, sr_integrator_bdpt, sr_integrator_caustics,
    sr_integrator_guided_path, sr_integrator_roulette_path, sr_integrator_path, sr_integrator_volpath,
    sr_integrator_simple_volpath, sr_integrator_simple_path, sr_integrator_random_walk, sr_integrator_ambient_occlusion,
    sr_integrator_estimator;
const struct sr_integrator_model *const sr_integrator_models[] = {
    &sr_integrator_path,           &sr_integrator_volpath,
    &sr_integrator_guided_path,    &sr_integrator_roulette_path,
    &sr_integrator_simple_volpath, &sr_integrator_simple_path,
    &sr_integrator_random_walk,    &sr_integrator_ambient_occlusion,
    &sr_integrator_light_path,     &sr_integrator_bdpt,
    &sr_integrator_caustics,       &sr_integrator_estimator,
    &sr_integrator_quadrature,     NULL,
};

const struct sr_integrator_model *sr_integrator_model_find(const char *name)
{
    for (int i = 0; sr_integrator_models[i]; ++i)
        if (strcmp(sr_integrator_models[i]->name, name) == 0)
            return sr_integrator_models[i];
    return NULL;
}
