/* SPDX-License-Identifier: MIT */
/* Four values at the corners of the unit square, bilinear between (and beyond) them.
 *
 *     value = (1-s)(1-t) v00 + (1-s) t v01 + s (1-t) v10 + s t v11 */
#include "texture/private.h"

struct bilerp_float {
    float v00, v01, v10, v11; // [the unit of what the texture is bound to] v(s)(t)
    struct sr_mapping mapping;
};
struct bilerp_spectrum {
    struct sr_spd v00, v01, v10, v11;
    struct sr_mapping mapping;
};

#define FLOAT_ROW(member, initial)                                                                                     \
    {                                                                                                                  \
        SR_PARAM_FLOAT, #member, "1", -INFINITY, INFINITY, initial, offsetof(struct bilerp_float, member),             \
            "at the corner (s,t)"                                                                                      \
    }
#define SPECTRUM_ROW(member, initial)                                                                                  \
    {                                                                                                                  \
        SR_PARAM_ALBEDO, #member, "1", 0, INFINITY, initial, offsetof(struct bilerp_spectrum, member),                 \
            "at the corner (s,t)"                                                                                      \
    }
static const struct sr_param params_float[] = {
    FLOAT_ROW(v00, 0), FLOAT_ROW(v01, 1), FLOAT_ROW(v10, 0), FLOAT_ROW(v11, 1), {0},
};
static const struct sr_param params_spectrum[] = {
    SPECTRUM_ROW(v00, 0), SPECTRUM_ROW(v01, 1), SPECTRUM_ROW(v10, 0), SPECTRUM_ROW(v11, 1), {0},
};

static sr_status prepare_float(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use, (void)arena;
    return sr_mapping_prepare(&((struct bilerp_float *)self)->mapping, error);
}

static sr_status prepare_spectrum(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use, (void)arena;
    return sr_mapping_prepare(&((struct bilerp_spectrum *)self)->mapping, error);
}

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct bilerp_float *b = self;
    sr_vec2 st = sr_mapping_apply(&b->mapping, x).st;
    return (1 - st.x) * (1 - st.y) * b->v00 + (1 - st.x) * st.y * b->v01 + st.x * (1 - st.y) * b->v10 +
           st.x * st.y * b->v11;
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct bilerp_spectrum *b = self;
    sr_vec2 st = sr_mapping_apply(&b->mapping, x).st;
    return (1 - st.x) * (1 - st.y) * sr_spd_eval(&b->v00, w->lambda) +
           (1 - st.x) * st.y * sr_spd_eval(&b->v01, w->lambda) + st.x * (1 - st.y) * sr_spd_eval(&b->v10, w->lambda) +
           st.x * st.y * sr_spd_eval(&b->v11, w->lambda);
}

const struct sr_texture_model sr_texture_bilerp_float = {
    .name = "bilerp",
    .params = params_float,
    .size = sizeof(struct bilerp_float),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = offsetof(struct bilerp_float, mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_float,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_bilerp_spectrum = {
    .name = "bilerp",
    .params = params_spectrum,
    .size = sizeof(struct bilerp_spectrum),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = offsetof(struct bilerp_spectrum, mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_spectrum,
    .eval_spectrum = eval_spectrum,
};
