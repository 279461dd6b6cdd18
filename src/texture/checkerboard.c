/* SPDX-License-Identifier: MIT */
/* Cells of size 1 that alternate between two textures, in the plane or in space, filtered exactly.
 *
 *     c(x) = +1 where floor(x) is even, -1 where odd;    share of tex2 = 1/2 - 1/2 PRODUCT c(x_i) * filter
 *
 * so the cell that begins at the origin is tex1. Each axis is convolved with a triangle of half width r = 1.5 times the
 * footprint:  INTEGRAL c(x+a) (1 - |a|/r) / r da = (D(x+r) - 2 D(x) + D(x-r)) / r^2,  D'' = c.
 * Pharr, Jakob & Humphreys 2023, 10.3. Where r <= 1/2 only one edge is in reach, and the convolution has a form without
 * cancellation: with e = distance beyond the edge / r, it is q = e (2 - |e|) between the two sides' values. */
#include "texture/private.h"

struct checkerboard {
    struct sr_texture tex1, tex2;
    int32_t dimension; // 2: in (s, t); 3: in the texture's space [m]
    struct sr_mapping mapping;
};

#define OFFSET(member) offsetof(struct checkerboard, member)
#define DIMENSION_ROW                                                                                                  \
    {                                                                                                                  \
        SR_PARAM_INT, "dimension", "1", 2, 3, 2, OFFSET(dimension), "2: cells in the plane; 3: cells in space"         \
    }
static const struct sr_param params_float[] = {
    DIMENSION_ROW,
    {SR_PARAM_FLOAT_TEXTURE, "tex1", "1", -INFINITY, INFINITY, 1, OFFSET(tex1), "of the cell at the origin"},
    {SR_PARAM_FLOAT_TEXTURE, "tex2", "1", -INFINITY, INFINITY, 0, OFFSET(tex2), "of its neighbours"},
    {0},
};
static const struct sr_param params_spectrum[] = {
    DIMENSION_ROW,
    {SR_PARAM_ALBEDO_TEXTURE, "tex1", "1", 0, INFINITY, 1, OFFSET(tex1), "of the cell at the origin"},
    {SR_PARAM_ALBEDO_TEXTURE, "tex2", "1", 0, INFINITY, 0, OFFSET(tex2), "of its neighbours"},
    {0},
};

// second antiderivative of c with D(0) = 0, for any x: a line x/2 plus a wave of period 2 and height 1/8 about 0
static float D(float x)
{
    float y = x / 2 - floorf(x / 2) - 0.5f;
    return x / 2 + y * (1 - 2 * fabsf(y));
}

// c at x, seen through a triangle of half width r
static float filtered(float x, float r)
{
    x -= 2 * floorf(x / 2); // c has period 2, and small numbers lose less in the differences below
    float side = x < 1 ? 1.0f : -1.0f;
    if (r <= 0.5f) {
        float edge = x < 0.5f ? 0 : x < 1.5f ? 1 : 2;
        float beyond = x - edge;
        if (fabsf(beyond) >= r)
            return side;
        float e = beyond / r;
        return (edge == 1 ? -1.0f : 1.0f) * e * (2 - fabsf(e));
    }
    if (!(r < 1e3f)) // so wide that no more than the mean is left: |c * filter| <= 1 / (4 r^2)
        return 0;
    return (D(x + r) - 2 * D(x) + D(x - r)) / (r * r);
}

static float share_of_tex2(const struct checkerboard *t, const struct sr_point *x)
{
    if (t->dimension == 2) {
        struct sr_mapped m = sr_mapping_apply(&t->mapping, x);
        float rs = 1.5f * sr_max(fabsf(m.dsdx), fabsf(m.dsdy)), rt = 1.5f * sr_max(fabsf(m.dtdx), fabsf(m.dtdy));
        return 0.5f - 0.5f * filtered(m.st.x, rs) * filtered(m.st.y, rt);
    }
    struct sr_in_space q = sr_in_space(&t->mapping.world_to_texture, x);
    return 0.5f - 0.5f * filtered(q.p.x, 1.5f * sr_max(fabsf(q.dpdx.x), fabsf(q.dpdy.x))) *
                      filtered(q.p.y, 1.5f * sr_max(fabsf(q.dpdx.y), fabsf(q.dpdy.y))) *
                      filtered(q.p.z, 1.5f * sr_max(fabsf(q.dpdx.z), fabsf(q.dpdy.z)));
}

static sr_status prepare(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use, (void)arena;
    struct checkerboard *t = self;
    if (t->dimension != 2 && t->dimension != 3)
        return sr_fail(error, SR_ERROR_INPUT, "a checkerboard has dimension 2 or 3, not %d", (int)t->dimension);
    return sr_mapping_prepare(&t->mapping, error);
}

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct checkerboard *t = self;
    float share = share_of_tex2(t, x);
    return (share != 1 ? (1 - share) * sr_texture_float(t->tex1, x) : 0) +
           (share != 0 ? share * sr_texture_float(t->tex2, x) : 0);
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct checkerboard *t = self;
    float share = share_of_tex2(t, x);
    sr_spectrum sum = share != 1 ? (1 - share) * sr_texture_spectrum(t->tex1, x, w) : SR_BLACK;
    return share != 0 ? sum + share * sr_texture_spectrum(t->tex2, x, w) : sum;
}

const struct sr_texture_model sr_texture_checkerboard_float = {
    .name = "checkerboard",
    .params = params_float,
    .size = sizeof(struct checkerboard),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = OFFSET(mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_checkerboard_spectrum = {
    .name = "checkerboard",
    .params = params_spectrum,
    .size = sizeof(struct checkerboard),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = OFFSET(mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare,
    .eval_spectrum = eval_spectrum,
};
