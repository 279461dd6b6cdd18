/* SPDX-License-Identifier: MIT */
/* Veins: layers of stone across y, bent by noise, coloured along a chain of cubic curves.
 *
 *     t = 1/2 + sin(y + variation * fbm(q)) / 2,     rgb = 1.5 * curve(t),     q = (x, y, z) = scale * point      [1]
 *
 * Curve k of six runs over t in k/6 … (k+1)/6 with the colours k … k+3 as the control points of a Bezier curve, so that
 * at the seams the colour jumps: that is pbrt's marble (Pharr, Jakob & Humphreys 2023, 10.6), and its veins' edges. The
 * colour is an sRGB reflectance in every use; only its octaves of noise are filtered. */
#include "texture/private.h"

struct marble {
    int32_t octaves;
    float roughness, scale, variation; // [1] [1/m] [1]
    struct sr_transform world_to_texture;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "octaves", "1", 0, 64, 8, offsetof(struct marble, octaves), "of the noise, at most"},
    {SR_PARAM_FLOAT, "roughness", "1", 0, INFINITY, 0.5, offsetof(struct marble, roughness),
     "height of an octave over the one before"},
    {SR_PARAM_FLOAT, "scale", "m^-1", -INFINITY, INFINITY, 1, offsetof(struct marble, scale), "layers per 2 pi"},
    {SR_PARAM_FLOAT, "variation", "1", -INFINITY, INFINITY, 0.2, offsetof(struct marble, variation),
     "how far noise bends them"},
    {0},
};

enum { CURVES = 6 };
static const struct sr_rgb colours[CURVES + 3] = {
    {0.58f, 0.58f, 0.6f}, {0.58f, 0.58f, 0.6f}, {0.58f, 0.58f, 0.6f}, {0.5f, 0.5f, 0.5f},   {0.6f, 0.59f, 0.58f},
    {0.58f, 0.58f, 0.6f}, {0.58f, 0.58f, 0.6f}, {0.2f, 0.2f, 0.33f},  {0.58f, 0.58f, 0.6f},
};

static struct sr_rgb colour_at(float t)
{
    t = sr_max(t, 0); // the sine of what has overflowed is none, and counts as 0
    int k = (int)sr_min(t * CURVES, CURVES - 1);
    float u = t * CURVES - (float)k, v = 1 - u;
    const float weight[4] = {v * v * v, 3 * v * v * u, 3 * v * u * u, u * u * u};
    struct sr_rgb sum = {0};
    for (int i = 0; i < 4; ++i) {
        sum.r += 1.5f * weight[i] * colours[k + i].r;
        sum.g += 1.5f * weight[i] * colours[k + i].g;
        sum.b += 1.5f * weight[i] * colours[k + i].b;
    }
    return sum;
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct marble *t = self;
    struct sr_in_space q = sr_in_space(&t->world_to_texture, x);
    sr_vec3 p = sr_scale(t->scale, q.p);
    float bend = sr_fbm(p, sr_scale(t->scale, q.dpdx), sr_scale(t->scale, q.dpdy), t->roughness, t->octaves);
    struct sr_spd colour = sr_spd_from_rgb_albedo(SR_SRGB, colour_at(0.5f + 0.5f * sinf(p.y + t->variation * bend)));
    return sr_spd_eval(&colour, w->lambda);
}

const struct sr_texture_model sr_texture_marble = {
    .name = "marble",
    .params = params,
    .size = sizeof(struct marble),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = offsetof(struct marble, world_to_texture),
    .eval_spectrum = eval_spectrum,
};
