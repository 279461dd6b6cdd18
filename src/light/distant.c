/* SPDX-License-Identifier: MIT */
/* Light from infinitely far, in one direction: a sun without extent.
 *
 *     E = E_perpendicular cos_theta         [lx]
 *
 * L is scaled to the illuminance `scale` [lx] of a surface that faces it, or with `illuminance` to scale * illuminance.
 * It travels from `from` to `to`. Limits: shadows are sharp; the sun's are not (it is 0.53 deg wide). */
#include "light/emission.h"

struct distant {
    struct sr_light_common common;
    struct sr_spd L;
    float scale, illuminance; // [1] [lx]
    sr_vec3 from, to;
    sr_vec3 wi;             // derived: toward the light [1]
    sr_vec3 centre;         // of the scene's sphere [m]
    float radius;           // [m]
    float luminous, choice; // [lx]
};

static const struct sr_param params[] = {
    {SR_PARAM_ILLUMINANT, "L", "lx", 0, INFINITY, NAN, offsetof(struct distant, L),
     "irradiance; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct distant, scale), "factor"},
    {SR_PARAM_FLOAT, "illuminance", "lx", -INFINITY, INFINITY, NAN, offsetof(struct distant, illuminance),
     "of a surface that faces the light, if above 0"},
    {SR_PARAM_POINT3, "from", "m", -INFINITY, INFINITY, 0, offsetof(struct distant, from), "light travels from here"},
    {SR_PARAM_POINT3, "to", "m", -INFINITY, INFINITY, NAN, offsetof(struct distant, to),
     "to here; (0, 0, 1) if not given"},
    {.name = NULL},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct distant *m = self;
    if (isnan(m->to.x))
        m->to = (sr_vec3){0, 0, 1};
    sr_vec3 w = sr_transform_vector(&m->common.light_to_world, sr_sub(m->from, m->to));
    if (!sr_is_finite(w) || !(sr_length2(w) > 0))
        return sr_fail(error, SR_ERROR_INPUT, "a distant light needs two different points \"from\" and \"to\"");
    m->wi = sr_normalize(w);
    if (sr_light_set_brightness(&m->L, m->common.space, m->common.is_absolute, m->scale, m->illuminance, error))
        return error->status;
    m->luminous = (float)sr_spd_luminous_integral(&m->L);
    m->choice = sr_light_choice_weight(&m->L);
    return SR_OK;
}

static void place(void *self, sr_vec3 scene_centre, float scene_radius)
{
    struct distant *m = self;
    m->centre = scene_centre;
    m->radius = scene_radius;
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)reference, (void)u;
    const struct distant *m = self;
    *s = (struct sr_light_sample){
        .L = sr_spd_eval(&m->L, w->lambda), .wi = m->wi, .distance = INFINITY, .pdf = 1, .is_delta = true};
    return true;
}

static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    (void)u_direction;
    const struct distant *m = self;
    if (!(m->radius > 0))
        return false;
    *ray = (struct sr_light_ray){.from = {.p = sr_light_outside(m->centre, m->radius, m->wi, u_place)},
                                 .w = sr_neg(m->wi),
                                 .L = sr_spd_along(&m->L, w),
                                 .pdf_area = SR_INV_PI / sr_sqr(m->radius),
                                 .pdf_direction = 1};
    return true;
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)n, (void)w;
    const struct distant *m = self;
    *pdf_area = m->radius > 0 ? SR_INV_PI / sr_sqr(m->radius) : 0;
    *pdf_direction = 1;
}

static float power(const void *self)
{
    const struct distant *m = self;
    return SR_PI * m->radius * m->radius * m->luminous;
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct distant *m = self;
    float radius = m->radius > 0 ? m->radius : 1; // a scene without extent is lit, too
    *b = (struct sr_light_bounds){.power = SR_PI * radius * radius * m->choice};
    return false;
}

const struct sr_light_model sr_light_distant = {
    .name = "distant",
    .params = params,
    .size = sizeof(struct distant),
    .is_infinite = true,
    .is_delta = true,
    .prepare = prepare,
    .place = place,
    .sample = sample,
    .pdf = sr_light_delta_pdf,
    .Le = sr_light_delta_Le,
    .bounds = bounds,
    .emit = emit,
    .emit_pdf = emit_pdf,
    .power = power,
};
