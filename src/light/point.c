/* SPDX-License-Identifier: MIT */
/* A point that shines evenly in all directions.
 *
 *     E = I cos_theta / r^2          [cd/m^2 sr = lx]         Phi = 4 pi I        [lm]
 *
 * I is scaled to the luminous intensity `scale` [cd], or with `power` to scale * power / (4 pi).
 * J. H. Lambert, Photometria, 1760. Limits: without extent; receivers nearer than a real lamp's size get too much. */
#include "light/emission.h"

struct point {
    struct sr_light_common common;
    struct sr_spd I;
    float scale, power;
    sr_vec3 from;
    sr_vec3 p;              // derived [m]
    float luminous, choice; // [cd]
};

static const struct sr_param params[] = {
    {SR_PARAM_ILLUMINANT, "I", "cd", 0, INFINITY, NAN, offsetof(struct point, I),
     "intensity; only its shape counts, rgb its brightness, too"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct point, scale), "factor"},
    {SR_PARAM_FLOAT, "power", "lm", -INFINITY, INFINITY, NAN, offsetof(struct point, power),
     "luminous flux of the whole light, if above 0"},
    {SR_PARAM_POINT3, "from", "m", -INFINITY, INFINITY, 0, offsetof(struct point, from), "where it is"},
    {.name = NULL},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct point *m = self;
    if (sr_light_set_brightness(&m->I, m->common.space, m->common.is_absolute, m->scale, m->power / (4 * SR_PI), error))
        return error->status;
    m->p = sr_transform_point(&m->common.light_to_world, m->from);
    if (!sr_is_finite(m->p))
        return sr_fail(error, SR_ERROR_INPUT, "the place of a point light is not finite");
    m->luminous = (float)sr_spd_luminous_integral(&m->I);
    m->choice = sr_light_choice_weight(&m->I);
    return SR_OK;
}

static bool sample(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s)
{
    (void)u;
    const struct point *m = self;
    sr_vec3 d = sr_sub(m->p, reference->p);
    float r2 = sr_length2(d), r = sqrtf(r2);
    if (!(r2 > 0))
        return false;
    *s = (struct sr_light_sample){.L = sr_spd_eval(&m->I, w->lambda) / r2,
                                  .wi = sr_scale(1 / r, d),
                                  .distance = r,
                                  .p = m->p,
                                  .pdf = 1,
                                  .is_delta = true};
    return true;
}

static bool emit(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray)
{
    (void)u_place;
    const struct point *m = self;
    *ray = (struct sr_light_ray){.from = {.p = m->p},
                                 .w = sr_warp_uniform_sphere(u_direction),
                                 .L = sr_spd_along(&m->I, w),
                                 .pdf_area = 1,
                                 .pdf_direction = SR_INV_PI / 4};
    return true;
}

static void emit_pdf(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction)
{
    (void)self, (void)n, (void)w;
    *pdf_area = 1;
    *pdf_direction = SR_INV_PI / 4;
}

static float power(const void *self)
{
    return 4 * SR_PI * ((const struct point *)self)->luminous;
}

static bool bounds(const void *self, struct sr_light_bounds *b)
{
    const struct point *m = self;
    *b = (struct sr_light_bounds){
        .box = {m->p, m->p}, .axis = {0, 0, 1}, .cos_theta_o = -1, .cos_theta_e = 0, .power = 4 * SR_PI * m->choice};
    return true;
}

const struct sr_light_model sr_light_point = {
    .name = "point",
    .params = params,
    .size = sizeof(struct point),
    .is_delta = true,
    .prepare = prepare,
    .sample = sample,
    .pdf = sr_light_delta_pdf,
    .Le = sr_light_delta_Le,
    .bounds = bounds,
    .emit = emit,
    .emit_pdf = emit_pdf,
    .power = power,
};
