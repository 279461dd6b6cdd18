/* SPDX-License-Identifier: MIT */
/* A share of each of two textures:  value = (1 - amount) tex1 + amount tex2. */
#include "texture/private.h"

struct mix {
    struct sr_texture tex1, tex2;
    struct sr_texture amount; // [1], float: the share of tex2
};

#define AMOUNT_ROW                                                                                                     \
    {                                                                                                                  \
        SR_PARAM_FLOAT_TEXTURE, "amount", "1", -INFINITY, INFINITY, 0.5, offsetof(struct mix, amount), "share of tex2" \
    }
static const struct sr_param params_float[] = {
    {SR_PARAM_FLOAT_TEXTURE, "tex1", "1", -INFINITY, INFINITY, 0, offsetof(struct mix, tex1), "where amount is 0"},
    {SR_PARAM_FLOAT_TEXTURE, "tex2", "1", -INFINITY, INFINITY, 1, offsetof(struct mix, tex2), "where amount is 1"},
    AMOUNT_ROW,
    {0},
};
static const struct sr_param params_spectrum[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "tex1", "1", 0, INFINITY, 0, offsetof(struct mix, tex1), "where amount is 0"},
    {SR_PARAM_ALBEDO_TEXTURE, "tex2", "1", 0, INFINITY, 1, offsetof(struct mix, tex2), "where amount is 1"},
    AMOUNT_ROW,
    {0},
};

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct mix *t = self;
    float amount = sr_texture_float(t->amount, x);
    return (amount != 1 ? (1 - amount) * sr_texture_float(t->tex1, x) : 0) +
           (amount != 0 ? amount * sr_texture_float(t->tex2, x) : 0);
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct mix *t = self;
    float amount = sr_texture_float(t->amount, x);
    sr_spectrum sum = amount != 1 ? (1 - amount) * sr_texture_spectrum(t->tex1, x, w) : SR_BLACK;
    return amount != 0 ? sum + amount * sr_texture_spectrum(t->tex2, x, w) : sum;
}

static bool constant_float(const void *self, float *value)
{
    const struct mix *t = self;
    float a, b, amount;
    if (!sr_texture_is_constant_float(t->tex1, &a) || !sr_texture_is_constant_float(t->tex2, &b) ||
        !sr_texture_is_constant_float(t->amount, &amount))
        return false;
    *value = sr_lerp(amount, a, b);
    return true;
}

// two different curves have no common form, except where the amount chooses one or both are flat
static bool constant_spectrum(const void *self, struct sr_spd *value)
{
    const struct mix *t = self;
    struct sr_spd a, b;
    float amount;
    if (!sr_texture_is_constant_float(t->amount, &amount))
        return false;
    if (amount == 0)
        return sr_texture_is_constant_spectrum(t->tex1, value);
    if (amount == 1)
        return sr_texture_is_constant_spectrum(t->tex2, value);
    if (!sr_texture_is_constant_spectrum(t->tex1, &a) || !sr_texture_is_constant_spectrum(t->tex2, &b) ||
        !sr_spd_is_constant(&a) || !sr_spd_is_constant(&b))
        return false;
    *value = sr_spd_constant(sr_lerp(amount, a.scale, b.scale));
    return true;
}

const struct sr_texture_model sr_texture_mix_float = {
    .name = "mix",
    .params = params_float,
    .size = sizeof(struct mix),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_float = eval_float,
    .constant_float = constant_float,
};
const struct sr_texture_model sr_texture_mix_spectrum = {
    .name = "mix",
    .params = params_spectrum,
    .size = sizeof(struct mix),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_spectrum = eval_spectrum,
    .constant_spectrum = constant_spectrum,
};
