/* SPDX-License-Identifier: MIT */
/* The same value everywhere. Materials ask for it once (sr_texture_is_constant_*), and evaluate no texture at hits. */
#include "texture/private.h"

struct constant_float {
    float value; // [the unit of what the texture is bound to]
};
struct constant_spectrum {
    struct sr_spd value; // [the same, at each wavelength]
};

static const struct sr_param params_float[] = {
    {SR_PARAM_FLOAT, "value", "1", -INFINITY, INFINITY, 1, offsetof(struct constant_float, value), "the value"},
    {0},
};
static const struct sr_param params_spectrum[] = {
    {SR_PARAM_ALBEDO, "value", "1", 0, INFINITY, 1, offsetof(struct constant_spectrum, value), "the value"},
    {0},
};

static float eval_float(const void *self, const struct sr_point *x)
{
    (void)x;
    const struct constant_float *t = self;
    return t->value;
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    (void)x;
    const struct constant_spectrum *t = self;
    return sr_spd_eval(&t->value, w->lambda);
}

static bool constant_float(const void *self, float *value)
{
    *value = ((const struct constant_float *)self)->value;
    return true;
}

static bool constant_spectrum(const void *self, struct sr_spd *value)
{
    *value = ((const struct constant_spectrum *)self)->value;
    return true;
}

const struct sr_texture_model sr_texture_constant_model_float = {
    .name = "constant",
    .params = params_float,
    .size = sizeof(struct constant_float),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_float = eval_float,
    .constant_float = constant_float,
};
const struct sr_texture_model sr_texture_constant_model_spectrum = {
    .name = "constant",
    .params = params_spectrum,
    .size = sizeof(struct constant_spectrum),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_spectrum = eval_spectrum,
    .constant_spectrum = constant_spectrum,
};

struct sr_texture sr_texture_constant_float(struct sr_arena *arena, float value)
{
    struct constant_float t = {value};
    const void *self = sr_arena_copy(arena, &t, sizeof t);
    return (struct sr_texture){self ? &sr_texture_constant_model_float : NULL, self};
}

struct sr_texture sr_texture_constant_spectrum(struct sr_arena *arena, struct sr_spd value)
{
    struct constant_spectrum t = {value};
    const void *self = sr_arena_copy(arena, &t, sizeof t);
    return (struct sr_texture){self ? &sr_texture_constant_model_spectrum : NULL, self};
}
