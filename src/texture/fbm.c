/* SPDX-License-Identifier: MIT */
/* Noise over space: sums of octaves, as they are and of their absolute values, and waves under a wind.
 *
 *     fbm       sum_i roughness^i  noise(1.99^i q)
 *     wrinkled  sum_i roughness^i |noise(1.99^i q)|
 *     windy     |fbm(q / 10), 3 octaves| * fbm(q), 6 octaves       both with roughness 1/2
 *
 * [1] of q [m], the point in the texture's space. Octaves finer than the footprint are left out, and wrinkled puts
 * their mean in their place. Pharr, Jakob & Humphreys 2023, 10.6; the noise is sr_noise. */
#include "texture/private.h"

struct fbm {
    int32_t octaves;
    float roughness; // [1] factor of an octave's height from one to the next
    struct sr_transform world_to_texture;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "octaves", "1", 0, 64, 8, offsetof(struct fbm, octaves), "number of octaves at most"},
    {SR_PARAM_FLOAT, "roughness", "1", 0, INFINITY, 0.5, offsetof(struct fbm, roughness),
     "height of an octave over the one before"},
    {0},
};
static const struct sr_param no_params[] = {{0}};

static float eval_fbm(const void *self, const struct sr_point *x)
{
    const struct fbm *t = self;
    struct sr_in_space q = sr_in_space(&t->world_to_texture, x);
    return sr_fbm(q.p, q.dpdx, q.dpdy, t->roughness, t->octaves);
}

static float eval_wrinkled(const void *self, const struct sr_point *x)
{
    const struct fbm *t = self;
    struct sr_in_space q = sr_in_space(&t->world_to_texture, x);
    return sr_turbulence(q.p, q.dpdx, q.dpdy, t->roughness, t->octaves);
}

static float eval_windy(const void *self, const struct sr_point *x)
{
    const struct fbm *t = self;
    struct sr_in_space q = sr_in_space(&t->world_to_texture, x);
    float wind = sr_fbm(sr_scale(0.1f, q.p), sr_scale(0.1f, q.dpdx), sr_scale(0.1f, q.dpdy), 0.5f, 3);
    return fabsf(wind) * sr_fbm(q.p, q.dpdx, q.dpdy, 0.5f, 6);
}

#define MODEL(word, table, function)                                                                                   \
    const struct sr_texture_model sr_texture_##word = {                                                                \
        .name = #word,                                                                                                 \
        .params = table,                                                                                               \
        .size = sizeof(struct fbm),                                                                                    \
        .is_float = true,                                                                                              \
        .texels_offset = SR_TEXTURE_NOWHERE,                                                                           \
        .mapping_offset = SR_TEXTURE_NOWHERE,                                                                          \
        .transform_offset = offsetof(struct fbm, world_to_texture),                                                    \
        .eval_float = function,                                                                                        \
    }
MODEL(fbm, params, eval_fbm);
MODEL(wrinkled, params, eval_wrinkled);
MODEL(windy, no_params, eval_windy);
