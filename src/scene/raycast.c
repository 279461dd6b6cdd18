/* SPDX-License-Identifier: MIT */
/* The two operators of the theory: raycast(p, w), the nearest surface point; visible(p, p'), the visibility function V.
 */
#include "scene/private.h"

#include <string.h>

typedef float f4 __attribute__((vector_size(16)));

/* Embree ends the program at numbers beyond its own largest, and at what is no number. Such rays meet nothing. */
bool scene_can_cast(const struct RTCRay *r, float farthest)
{
    f4 o = *(const f4 *)&r->org_x, d = *(const f4 *)&r->dir_x, most = {farthest, farthest, farthest, farthest};
    typedef int32_t i4 __attribute__((vector_size(16)));
    i4 within = (o <= most) & (o >= -most) & (d <= most) & (d >= -most);
    uint64_t halves[2];
    memcpy(halves, &within, sizeof halves);
    return (halves[0] & halves[1]) == UINT64_MAX && !isnan(r->tfar);
}

static void fill_ray(struct RTCRay *r, sr_vec3 o, sr_vec3 d, float time, float t_max)
{
    // a plane through a coordinate's zero has no rounding error there, so that rays start on it exactly: 0 is no
    // meeting
    const float nearest = 1e-20f;                    // [m]
    *(f4 *)&r->org_x = (f4){o.x, o.y, o.z, nearest}; // org, tnear
    *(f4 *)&r->dir_x = (f4){d.x, d.y, d.z, time};    // dir, time
    r->tfar = t_max;
    r->mask = ~0u;
    r->id = 0;
    r->flags = 0;
}

/* The point of an instanced object, in the world. Its place is known to float's rounding, in both directions: on the
 * way back to where the surface is, a ray must not be on its other side. roundings: of a coordinate on that way. */
static void to_world(struct sr_point *x, const struct sr_transform *t, int roundings)
{
    sr_vec3 error;
    x->p = sr_transform_point_error(t, x->p, x->p_error, &error);
    x->n = sr_normalize(sr_transform_normal(t, x->n));
    x->ns = sr_face_forward(sr_normalize(sr_transform_normal(t, x->ns)), x->n);
    x->dpdu = sr_transform_vector(t, x->dpdu);
    x->dpdv = sr_transform_vector(t, x->dpdv);
    x->dpdus = sr_transform_vector(t, x->dpdus);
    x->dndu = sr_transform_normal(t, x->dndu);
    x->dndv = sr_transform_normal(t, x->dndv);
    float back[3], gamma = sr_gamma(roundings), *e = &error.x;
    for (int i = 0; i < 3; ++i)
        back[i] = gamma * (fabsf(t->inverse[i][0] * x->p.x) + fabsf(t->inverse[i][1] * x->p.y) +
                           fabsf(t->inverse[i][2] * x->p.z) + fabsf(t->inverse[i][3]));
    for (int i = 0; i < 3; ++i)
        e[i] += fabsf(t->m[i][0]) * back[0] + fabsf(t->m[i][1]) * back[1] + fabsf(t->m[i][2]) * back[2];
    x->p_error = error;
}

/* What a ray that seems to have slipped out meets beside. */
static bool cast_beside(const struct sr_scene *scene, const struct sr_ray *ray, struct RTCRayHit *rh)
{
    for (int i = 0; i < SLIP_ATTEMPTS + (isinf(ray->t_max) ? SLIP_RING : 0); ++i) {
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        fill_ray(&rh->ray, ray->o, scene_beside(ray->d, i), ray->time, SLIP_SHARE * ray->t_max);
        rh->hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene->embree, &context, rh);
        bool has_met = rh->hit.geomID != RTC_INVALID_GEOMETRY_ID;
        if (has_met == (i < SLIP_ATTEMPTS))
            return has_met;
    }
    return rh->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

static bool is_free(const struct sr_scene *scene, const struct sr_ray *ray, sr_vec3 d, float t_max)
{
    struct RTCRay r;
    fill_ray(&r, ray->o, d, ray->time, t_max);
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (SR_UNLIKELY(!scene_can_cast(&r, scene->farthest)))
        return true;
    rtcOccluded1(scene->embree, &context, &r);
    return r.tfar >= 0;
}

SR_INLINE bool raycast(const struct sr_scene *scene, const struct sr_ray *ray, bool bare, struct sr_hit *hit)
{
    struct RTCRayHit rh;
    fill_ray(&rh.ray, ray->o, ray->d, ray->time, ray->t_max);
    rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (SR_UNLIKELY(!scene_can_cast(&rh.ray, scene->farthest)))
        return false;
    rtcIntersect1(scene->embree, &context, &rh);
    if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID &&
        !(scene->closed_count && scene_may_have_slipped(scene, ray) && cast_beside(scene, ray, &rh)))
        return false;

    const struct instance *instance = rh.hit.instID[0] == RTC_INVALID_GEOMETRY_ID
                                          ? NULL
                                          : &scene->instances[rh.hit.instID[0] - scene->first_instance];
    const struct object *object = instance ? instance->object : scene->world;
    const struct placed_shape *s = &object->shapes[rh.hit.geomID];
    sr_vec2 at = {rh.hit.u, rh.hit.v};
    uint32_t primitive = primitive_met(s, rh.hit.primID, &at);
    if (bare && s->is_plain && !instance && s->shape.model->bare_point) {
        s->shape.model->bare_point(s->shape.self, primitive, at, &hit->point);
        hit->point.dpdus = (sr_vec3){0, 0, 0};
    } else if (SR_UNLIKELY(s->shape.model->seen_point)) {
        sr_vec3 d = ray->d;
        if (instance) {
            struct sr_transform t = instance_transform(instance, ray->time);
            d = sr_inverse_vector(&t, d);
        }
        s->shape.model->seen_point(s->shape.self, primitive, at, d, &hit->point);
    } else {
        s->shape.model->point(s->shape.self, primitive, at, &hit->point);
    }
    hit->point.time = ray->time;
    hit->point.outward = s->outward;
    if (SR_UNLIKELY(instance)) {
        if (!instance->is_watched)
            hit->point.outward = 0;
        if (instance->boxes) {
            struct sr_transform now = instance_transform(instance, ray->time);
            to_world(&hit->point, &now, 5);
        } else { // Embree inverts the matrix in float
            to_world(&hit->point, &instance->object_to_world, 10);
        }
    }
    hit->t = rh.ray.tfar;
    hit->material = s->material;
    hit->media = s->media;
    hit->light =
        s->first_light == SR_NO_LIGHT ? SR_NO_LIGHT : s->first_light + (s->per_light == 2 ? primitive / 2 : primitive);
    hit->object = s->number;
    hit->material_number = s->material_number;
    hit->has_footprint = s->has_footprint;
    hit->is_plain = s->is_plain;
    hit->lambert = s->lambert;
    return true;
}

bool sr_raycast(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit)
{
    return raycast(scene, ray, false, hit);
}

bool sr_raycast_bare(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit)
{
    return raycast(scene, ray, true, hit);
}

bool sr_is_free(const struct sr_scene *scene, const struct sr_ray *ray)
{
    if (!is_free(scene, ray, ray->d, ray->t_max))
        return false;
    if (!scene->closed_count || !scene_may_have_slipped(scene, ray))
        return true;
    for (int i = 0; i < SLIP_ATTEMPTS + (isinf(ray->t_max) ? SLIP_RING : 0); ++i) {
        bool free = is_free(scene, ray, scene_beside(ray->d, i), SLIP_SHARE * ray->t_max);
        if (free == (i >= SLIP_ATTEMPTS))
            return free;
    }
    return !isinf(ray->t_max);
}

bool sr_visible(const struct sr_scene *scene, const struct sr_point *x, const struct sr_light_sample *s)
{
    struct sr_ray ray = sr_shadow_ray(x, s);
    return sr_is_free(scene, &ray);
}

uint64_t sr_scene_replay(const struct sr_scene *scene, const struct sr_ray_log *log)
{
    uint64_t met = 0;
    for (uint64_t i = 0; i < log->count; ++i) {
        const struct sr_logged_ray *l = &log->rays[i];
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        struct RTCRayHit rh;
        fill_ray(&rh.ray, l->o, l->d, 0, l->t_max);
        if (l->is_shadow) {
            rtcOccluded1(scene->embree, &context, &rh.ray);
            met += rh.ray.tfar < 0;
        } else {
            rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rh.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene->embree, &context, &rh);
            met += rh.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
    }
    return met;
}

void sr_point_set_footprint(struct sr_point *x, sr_vec3 dpdx, sr_vec3 dpdy)
{
    x->dpdx = dpdx;
    x->dpdy = dpdy;
    // least squares of dpdx = dudx dpdu + dvdx dpdv
    float a00 = sr_dot(x->dpdu, x->dpdu), a01 = sr_dot(x->dpdu, x->dpdv), a11 = sr_dot(x->dpdv, x->dpdv);
    float determinant = sr_difference_of_products(a00, a11, a01, a01);
    float inverse = determinant != 0 ? 1 / determinant : 0;
    if (!isfinite(inverse))
        inverse = 0;
    float b0x = sr_dot(x->dpdu, dpdx), b1x = sr_dot(x->dpdv, dpdx), b0y = sr_dot(x->dpdu, dpdy),
          b1y = sr_dot(x->dpdv, dpdy);
    x->dudx = sr_clamp((a11 * b0x - a01 * b1x) * inverse, -1e8f, 1e8f);
    x->dvdx = sr_clamp((a00 * b1x - a01 * b0x) * inverse, -1e8f, 1e8f);
    x->dudy = sr_clamp((a11 * b0y - a01 * b1y) * inverse, -1e8f, 1e8f);
    x->dvdy = sr_clamp((a00 * b1y - a01 * b0y) * inverse, -1e8f, 1e8f);
}
