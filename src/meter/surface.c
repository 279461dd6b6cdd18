/* SPDX-License-Identifier: MIT */
/* Surfaces to measure on that are not there: a rectangle, a disk, a sphere, which light passes. */
#include "meter/private.h"

static float draw_rectangle(const void *self, sr_vec2 u, struct sr_point *x)
{
    const struct meter_surface_self *s = self;
    *x = (struct sr_point){.p = sr_mad(sr_mad(s->p, u.x, s->u), u.y, s->v), .n = s->n, .ns = s->n, .uv = u};
    x->p_error = meter_p_error(x->p);
    return s->density;
}

static float draw_disk(const void *self, sr_vec2 u, struct sr_point *x)
{
    const struct meter_surface_self *s = self;
    sr_vec2 d = sr_warp_disk(u);
    *x = (struct sr_point){.p = sr_mad(sr_mad(s->p, d.x, s->u), d.y, s->v), .n = s->n, .ns = s->n, .uv = u};
    x->p_error = meter_p_error(x->p);
    return s->density;
}

static float draw_sphere(const void *self, sr_vec2 u, struct sr_point *x)
{
    const struct meter_surface_self *s = self;
    sr_vec3 n = sr_warp_uniform_sphere(u);
    *x = (struct sr_point){.p = sr_mad(s->p, s->radius, n), .n = n, .ns = n, .uv = u};
    x->p_error = meter_p_error(x->p);
    return s->density;
}

static sr_status prepare_rectangle(const struct meter_surface_params *p, const struct sr_transform *t,
                                   struct meter_surface_self *s, double *area, struct sr_error *error)
{
    if (isnan(p->u.x) || isnan(p->v.x))
        return sr_fail(error, SR_ERROR_INPUT,
                       "a rectangle has a corner \"p\" and two edges: expected \"vector3 u\" and \"vector3 v\"");
    s->u = sr_transform_vector(t, p->u);
    s->v = sr_transform_vector(t, p->v);
    s->n = sr_cross(s->u, s->v);
    *area = (double)sr_length(s->n);
    if (!(*area > 0))
        return sr_fail(error, SR_ERROR_INPUT,
                       "the rectangle has no area: expected edges \"u\" and \"v\" in two directions");
    s->n = sr_normalize(s->n);
    return SR_OK;
}

static sr_status prepare_disk(const struct meter_surface_params *p, const struct sr_transform *t,
                              struct meter_surface_self *s, double *area, struct sr_error *error)
{
    // the two radii in the plane, then moved: a disk that the transform makes an ellipse is one
    sr_vec3 n = meter_or_z(p->n);
    sr_status status = meter_direction("n", &n, error);
    if (status != SR_OK)
        return status;
    struct sr_frame frame = sr_frame_from_z(n);
    s->u = sr_transform_vector(t, sr_scale(p->radius, frame.x));
    s->v = sr_transform_vector(t, sr_scale(p->radius, frame.y));
    *area = (double)SR_PI * (double)sr_length(sr_cross(s->u, s->v));
    s->n = sr_transform_normal(t, n);
    return *area > 0 ? meter_direction("n", &s->n, error) : sr_fail(error, SR_ERROR_INPUT, "the disk has no area");
}

static sr_status prepare_sphere(const struct meter_surface_params *p, const struct sr_transform *t,
                                struct meter_surface_self *s, double *area, struct sr_error *error)
{
    float a = sr_length(sr_transform_vector(t, (sr_vec3){1, 0, 0})),
          b = sr_length(sr_transform_vector(t, (sr_vec3){0, 1, 0})),
          c = sr_length(sr_transform_vector(t, (sr_vec3){0, 0, 1}));
    if (fabsf(a - b) > 1e-4f * a || fabsf(a - c) > 1e-4f * a)
        return sr_fail(error, SR_ERROR_INPUT,
                       "the transform makes an ellipsoid of the sphere: expected the same scale along all axes");
    s->radius = p->radius * a;
    *area = 4 * (double)SR_PI * (double)s->radius * (double)s->radius;
    return *area > 0 ? SR_OK : sr_fail(error, SR_ERROR_INPUT, "the sphere has no area");
}

sr_status meter_surface_prepare(struct sr_meter_common *common, const struct meter_surface_params *p,
                                const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    if (common->surface.draw) // a shape's, found by its name
        return SR_OK;
    struct meter_surface_self *s = sr_arena_alloc(arena, sizeof *s);
    if (!s)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    s->p = sr_transform_point(t, p->p);
    sr_status status = p->shape == METER_RECTANGLE ? prepare_rectangle(p, t, s, &common->surface.area, error)
                       : p->shape == METER_DISK    ? prepare_disk(p, t, s, &common->surface.area, error)
                                                   : prepare_sphere(p, t, s, &common->surface.area, error);
    if (status == SR_OK && !(sr_is_finite(s->p) && isfinite(common->surface.area)))
        status = sr_fail(error, SR_ERROR_INPUT, "the surface is not finite");
    s->density = (float)(1 / common->surface.area);
    common->surface.self = s;
    common->surface.draw = p->shape == METER_RECTANGLE ? draw_rectangle
                           : p->shape == METER_DISK    ? draw_disk
                                                       : draw_sphere;
    return status;
}
