/* SPDX-License-Identifier: MIT */
/* A point that shines into a cone, with a soft rim.
 *
 *     I(theta) = I0 S((cos_theta - cos_total) / (cos_start - cos_total)),   S(t) = t^2 (3 - 2 t) on [0, 1]   [cd]
 *     Phi      = 2 pi I0 ((1 - cos_start) + (cos_start - cos_total) / 2)                                      [lm]
 *
 * total = coneangle, start = coneangle - conedeltaangle. The rim is smooth in the cosine, not in the angle (as
 * pbrt-v4); S has the mean 1/2, hence Phi. I0 is scaled to the luminous intensity `scale`, or so that Phi = scale *
 * power. Limits: a transform that is no similarity turns the axis but leaves the cone round. */
#include "light/emission.h"

struct spot {
    struct sr_light_common common;
    struct sr_spd I;
    float scale, power, coneangle, conedeltaangle; // [1] [lm] [deg] [deg]
    sr_vec3 from, to;
    sr_vec3 p, axis;    // derived [m] [1]
    float start, total; // [rad]
    float cos_start, cos_total;
    float luminous, choice; // [cd]
};

static const struct sr_param params[] = {
    {SR_PARAM_ILLUMINANT, "I", "cd", 0, INFINITY, NAN, offsetof(struct spot, I),
     "intensity on the axis; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct spot, scale), "factor"},
    {SR_PARAM_FLOAT, "power", "lm", -INFINITY, INFINITY, NAN, offsetof(struct spot, power),
     "luminous flux of the whole light, if above 0"},
    {SR_PARAM_FLOAT, "coneangle", "deg", 0, 180, 30, offsetof(struct spot, coneangle),
     "from the axis to where the light ends"},
    {SR_PARAM_FLOAT, "conedeltaangle", "deg", 0, 180, 5, offsetof(struct spot, conedeltaangle),
     "width of the rim inside it"},
    {SR_PARAM_POINT3, "from", "m", -INFINITY, INFINITY, 0, offsetof(struct spot, from), "where it is"},
    {SR_PARAM_POINT3, "to", "m", -INFINITY, INFINITY, NAN, offsetof(struct spot, to),
     "a point on its axis; (0, 0, 1) if not given"},
    {.name = NULL},
};

// flux over intensity on the axis [sr]
static float solid_angle(const struct spot *m)
{
    return 2 * SR_PI * ((1 - m->cos_start) + (m->cos_start - m->cos_total) / 2);
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct spot *m = self;
    if (isnan(m->to.x))
        m->to = (sr_vec3){0, 0, 1};
    m->total = sr_radians(m->coneangle);
    m->start = sr_radians(sr_max(m->coneangle - m->conedeltaangle, 0));
    m->cos_start = cosf(m->start);
    m->cos_total = cosf(m->total);
    sr_vec3 axis = sr_transform_vector(&m->common.light_to_world, sr_sub(m->to, m->from));
    m->p = sr_transform_point(&m->common.light_to_world, m->from);
    if (!sr_is_finite(m->p) || !(sr_length2(axis) > 0))
        return sr_fail(error, SR_ERROR_INPUT, "a spot light needs two different points \"from\" and \"to\"");
    m->axis = sr_normalize(axis);
    float angle = solid_angle(m);
    if (m->power > 0 && !(angle > 0))
        return sr_fail(error, SR_ERROR_INPUT, "a spot light with \"power\" needs a cone wider than %g deg",
                       (double)m->coneangle);
    if (sr_light_set_brightness(&m->I, m->common.space, m->common.is_absolute, m->scale, m->power / angle, error))
        return error->status;
    m->luminous = (float)sr_spd_luminous_integral(&m->I);
    m->choice = sr_light_choice_weight(&m->I);
    return SR_OK;
}

static float falloff(const struct spot *m, float cos_theta)
{
    if (cos_theta >= m->cos_start)
        return 1;
    if (cos_theta <= m->cos_total)
        return 0;
    float t = (cos_theta - m->cos_total) / (m->cos_start - m->cos_total);
    return t * t * (3 - 2 * t);
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)u;
    const struct spot *m = self;
    sr_vec3 d = sr_sub(m->p, reference->p);
    float r2 = sr_length2(d), r = sqrtf(r2);
    if (!(r2 > 0))
        return false;
    sr_vec3 wi = sr_scale(1 / r, d);
    float share = falloff(m, -sr_dot(wi, m->axis));
    if (share <= 0)
        return false;
    *s = (struct sr_light_sample){.L = sr_spd_eval(&m->I, w->lambda) * (share / r2),
                                  .wi = wi,
                                  .distance = r,
                                  .p = m->p,
                                  .pdf = 1,
                                  .is_delta = true};
    return true;
}

// where the rim's share u of the flux between cos_total and cos_start ends: the t of 2 t^3 - t^4 = u, by Newton's
// method
static float rim(float u)
{
    float t = cbrtf(u / 2);
    for (int i = 0; i < 5 && t > 0; ++i)
        t = sr_clamp(t - (t * t * t * (2 - t) - u) / (2 * t * t * (3 - 2 * t)), 0, 1);
    return t;
}

// in proportion to I(theta), so that all rays carry the same flux
static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    (void)u_place;
    const struct spot *m = self;
    float inner = 1 - m->cos_start, outer = (m->cos_start - m->cos_total) / 2, at = u_direction.x * (inner + outer);
    if (!(inner + outer > 0))
        return false;
    float rest =
        at < inner ? at
                   : 1 - sr_lerp(rim(sr_min(1, 1 - (at - inner) / outer)), m->cos_total, m->cos_start); // 1 - cos_theta
    float sin_theta = sr_safe_sqrt(rest * (2 - rest)), cos_theta = 1 - rest, sin_phi, cos_phi,
          share = falloff(m, cos_theta);
    sr_sin_cos_turn(u_direction.y, &sin_phi, &cos_phi);
    struct sr_frame frame = sr_frame_from_z(m->axis);
    *ray =
        (struct sr_light_ray){.from = {.p = m->p},
                              .w = sr_to_world(&frame, (sr_vec3){sin_theta * cos_phi, sin_theta * sin_phi, cos_theta}),
                              .L = sr_spd_along(&m->I, w) * share,
                              .pdf_area = 1,
                              .pdf_direction = share / solid_angle(m)};
    return ray->pdf_direction > 0;
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n;
    const struct spot *m = self;
    float share = falloff(m, sr_dot(w, m->axis));
    *pdf_area = 1;
    *pdf_direction = share > 0 ? share / solid_angle(m) : 0;
}

static float emit_weight(const void *self)
{
    const struct spot *m = self;
    return m->choice * solid_angle(m);
}

static float power(const void *self)
{
    const struct spot *m = self;
    return m->luminous * solid_angle(m);
}

// the tree compares intensities, so power is that of a point light as bright as the axis
static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct spot *m = self;
    *b = (struct sr_light_bounds){.box = {m->p, m->p},
                                  .axis = m->axis,
                                  .cos_theta_o = m->cos_start,
                                  .cos_theta_e = cosf(sr_min(m->total - m->start, SR_PI)),
                                  .power = solid_angle(m) > 0 ? 4 * SR_PI * m->choice : 0};
    return true;
}

const struct sr_light_model sr_light_spot = {
    .name = "spot",
    .params = params,
    .size = sizeof(struct spot),
    .is_delta = true,
    .prepare = prepare,
    .sample = sample,
    .pdf = sr_light_delta_pdf,
    .Le = sr_light_delta_Le,
    .bounds = bounds,
    .emit = emit,
    .emit_pdf = emit_pdf,
    .emit_weight = emit_weight,
    .power = power,
};
