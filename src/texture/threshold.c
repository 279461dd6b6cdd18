/* SPDX-License-Identifier: MIT */
/* Yes or no:  value = 1 where tex >= cutoff, else 0. */
#include "texture/private.h"

struct threshold {
    struct sr_texture tex;
    float cutoff; // [1]
};

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT_TEXTURE, "tex", "1", -INFINITY, INFINITY, 1, offsetof(struct threshold, tex), "what is compared"},
    {SR_PARAM_FLOAT, "cutoff", "1", -INFINITY, INFINITY, 0.5, offsetof(struct threshold, cutoff),
     "the least value that counts as 1"},
    {0},
};

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct threshold *t = self;
    return sr_texture_float(t->tex, x) >= t->cutoff;
}

static bool constant_float(const void *self, float *value)
{
    const struct threshold *t = self;
    if (!sr_texture_is_constant_float(t->tex, value))
        return false;
    *value = *value >= t->cutoff;
    return true;
}

const struct sr_texture_model sr_texture_threshold = {
    .name = "threshold",
    .params = params,
    .size = sizeof(struct threshold),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .eval_float = eval_float,
    .constant_float = constant_float,
};
