/* SPDX-License-Identifier: MIT */
/* A texture times a number that may itself vary:  value = tex * scale. */
#include "texture/private.h"

struct scale {
    struct sr_texture tex;
    struct sr_texture scale; // [1], float
};

#define SCALE_ROW                                                                                                      \
    {                                                                                                                  \
        SR_PARAM_FLOAT_TEXTURE, "scale", "1", -INFINITY, INFINITY, 1, offsetof(struct scale, scale), "factor"          \
    }
static const struct sr_param params_float[] = {
    {SR_PARAM_FLOAT_TEXTURE, "tex", "1", -INFINITY, INFINITY, 1, offsetof(struct scale, tex), "what is scaled"},
    SCALE_ROW,
    {0},
};
static const struct sr_param params_spectrum[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "tex", "1", 0, INFINITY, 1, offsetof(struct scale, tex), "what is scaled"},
    SCALE_ROW,
    {0},
};

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct scale *t = self;
    return sr_texture_float(t->tex, x) * sr_texture_float(t->scale, x);
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct scale *t = self;
    float factor = sr_texture_float(t->scale, x);
    return factor == 0 ? SR_BLACK : sr_texture_spectrum(t->tex, x, w) * factor;
}

static bool constant_float(const void *self, float *value)
{
    const struct scale *t = self;
    float a, b;
    if (!sr_texture_is_constant_float(t->tex, &a) || !sr_texture_is_constant_float(t->scale, &b))
        return false;
    *value = a * b;
    return true;
}

static bool constant_spectrum(const void *self, struct sr_spd *value)
{
    const struct scale *t = self;
    float factor;
    if (!sr_texture_is_constant_spectrum(t->tex, value) || !sr_texture_is_constant_float(t->scale, &factor))
        return false;
    value->scale *= factor;
    return true;
}

const struct sr_texture_model sr_texture_scale_float = {
    .name = "scale",
    .params = params_float,
    .size = sizeof(struct scale),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_float = eval_float,
    .constant_float = constant_float,
};
const struct sr_texture_model sr_texture_scale_spectrum = {
    .name = "scale",
    .params = params_spectrum,
    .size = sizeof(struct scale),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_spectrum = eval_spectrum,
    .constant_spectrum = constant_spectrum,
};
