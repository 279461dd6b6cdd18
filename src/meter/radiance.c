/* SPDX-License-Identifier: MIT */
/* A radiance meter: along a ray, or the mean over a cone of acceptance.
 *
 *     L,    or    1/Omega INTEGRAL over the cone of L dw,   Omega = 2 pi (1 - cos(half angle))
 *         [cd m^-2], [W m^-2 sr^-1] */
#include "meter/private.h"

struct radiance {
    struct sr_meter_common common;
    sr_vec3 p, d, to; // [m] [1] [m]
    float half_angle_deg;
    struct sr_frame frame;
    float cos_max, one_minus_cos, inverse_omega;
};

#define MEMBER(m) offsetof(struct radiance, m)
static const struct sr_param params[] = {
    {SR_PARAM_POINT3, "p", "m", 0, 0, 0, MEMBER(p), "where it stands"},
    {SR_PARAM_VECTOR3, "d", "1", 0, 0, NAN, MEMBER(d), "the direction in which it looks; none: toward \"to\", or +z"},
    {SR_PARAM_POINT3, "to", "m", 0, 0, NAN, MEMBER(to), "the point that it looks at, in place of d"},
    {SR_PARAM_FLOAT, "halfangle", "deg", 0, 180, 0, MEMBER(half_angle_deg), "of the cone of acceptance; 0: a ray"},
    {.name = NULL},
};

static sr_status prepare(void *self, const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct radiance *m = self;
    if (!isnan(m->d.x) && !isnan(m->to.x))
        return sr_fail(error, SR_ERROR_INPUT, "\"d\" and \"to\" are given: expected one of them");
    sr_vec3 d = isnan(m->to.x) ? meter_or_z(m->d) : sr_sub(m->to, m->p);
    d = sr_transform_vector(t, d);
    m->p = sr_transform_point(t, m->p);
    if (!sr_is_finite(m->p))
        return sr_fail(error, SR_ERROR_INPUT, "\"p\" is no point: expected three finite numbers");
    sr_status status = meter_direction(isnan(m->to.x) ? "d" : "to", &d, error);
    m->frame = sr_frame_from_z(d);
    double angle = (double)m->half_angle_deg * (double)SR_PI / 180, half = sin(angle / 2),
           one_minus_cos = 2 * half * half;
    m->one_minus_cos = (float)one_minus_cos;
    m->cos_max = (float)(1 - one_minus_cos);
    m->inverse_omega = (float)(1 / (2 * (double)SR_PI * one_minus_cos));
    return status;
}

static bool place(const void *self, sr_vec2 u, struct sr_meter_place *out)
{
    (void)u;
    const struct radiance *m = self;
    *out = (struct sr_meter_place){.x = {.p = m->p}, .frame = m->frame, .weight = 1};
    return true;
}

static bool is_inside(const struct radiance *m, sr_vec3 wi)
{
    // of a narrow cone by the sine, which keeps its digits
    if (m->one_minus_cos < 0.01f)
        return wi.z > 0 && wi.x * wi.x + wi.y * wi.y <= m->one_minus_cos * (2 - m->one_minus_cos);
    return wi.z >= m->cos_max;
}
static float response(const void *self, sr_vec3 wi)
{
    const struct radiance *m = self;
    if (m->half_angle_deg == 0)
        return 1;
    return is_inside(m, wi) ? m->inverse_omega : 0;
}
static float pdf(const void *self, sr_vec3 wi)
{
    return response(self, wi);
}
static float sample(const void *self, sr_u4 u, sr_vec3 *wi)
{
    const struct radiance *m = self;
    *wi = m->half_angle_deg == 0 ? (sr_vec3){0, 0, 1} : sr_warp_uniform_cone((sr_vec2){u[0], u[1]}, m->one_minus_cos);
    return m->half_angle_deg == 0 ? 1 : m->inverse_omega;
}
static bool is_ray(const void *self)
{
    return ((const struct radiance *)self)->half_angle_deg == 0;
}
static double extent(const void *self)
{
    (void)self;
    return 1;
}

const struct sr_meter_model meter_radiance = {
    .name = "radiance",
    .what = "radiance",
    .law = "L along a ray, or its mean over a cone",
    .suffix = "",
    .kind = SR_KIND_RADIANCE,
    .params = params,
    .size = sizeof(struct radiance),
    .prepare = prepare,
    .place = place,
    .response = response,
    .sample = sample,
    .pdf = pdf,
    .is_ray = is_ray,
    .extent = extent,
};

struct sr_meter sr_meter_radiance_along(struct sr_arena *arena, sr_vec3 p, sr_vec3 d, float half_angle)
{
    struct radiance *m = sr_arena_alloc(arena, sizeof *m);
    struct sr_transform one = sr_transform_identity();
    struct sr_error error = {0};
    if (!m)
        return (struct sr_meter){NULL, NULL};
    *m = (struct radiance){
        .p = p, .d = d, .to = {NAN, NAN, NAN}, .half_angle_deg = half_angle * (180 / SR_PI), .common.fwhm = NAN};
    return prepare(m, &one, arena, &error) == SR_OK ? (struct sr_meter){&meter_radiance, m}
                                                    : (struct sr_meter){NULL, NULL};
}
