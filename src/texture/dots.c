/* SPDX-License-Identifier: MIT */
/* Round dots, one or none in each cell of size 1 of the plane, where noise puts them.
 *
 *     cell (i, j) = floor((s, t) + 1/2) has a dot where noise(i + 1/2, j + 1/2) > 0,
 *     of radius 0.35 about (i, j) + 0.15 (noise(i + 1.5, j + 2.8), noise(i + 4.5, j + 9.8))
 *
 * with noise(x, y) = sr_noise(x, y, 1/2), as pbrt-v4 (Pharr, Jakob & Humphreys 2004, 11.5). Not filtered: edges are
 * smooth by the film's samples alone. */
#include "texture/private.h"

struct dots {
    struct sr_texture inside, outside;
    struct sr_mapping mapping;
};

#define OFFSET(member) offsetof(struct dots, member)
static const struct sr_param params_float[] = {
    {SR_PARAM_FLOAT_TEXTURE, "inside", "1", -INFINITY, INFINITY, 1, OFFSET(inside), "of the dots"},
    {SR_PARAM_FLOAT_TEXTURE, "outside", "1", -INFINITY, INFINITY, 0, OFFSET(outside), "of what is between them"},
    {0},
};
static const struct sr_param params_spectrum[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "inside", "1", 0, INFINITY, 1, OFFSET(inside), "of the dots"},
    {SR_PARAM_ALBEDO_TEXTURE, "outside", "1", 0, INFINITY, 0, OFFSET(outside), "of what is between them"},
    {0},
};

static float noise(float x, float y)
{
    return sr_noise((sr_vec3){x, y, 0.5f});
}

static struct sr_texture texture_at(const struct dots *t, const struct sr_point *x)
{
    const float radius = 0.35f, shift = 0.5f - radius; // a dot stays within its cell
    sr_vec2 st = sr_mapping_apply(&t->mapping, x).st;
    float i = floorf(st.x + 0.5f), j = floorf(st.y + 0.5f);
    if (!(noise(i + 0.5f, j + 0.5f) > 0))
        return t->outside;
    float ds = st.x - i - shift * noise(i + 1.5f, j + 2.8f), dt = st.y - j - shift * noise(i + 4.5f, j + 9.8f);
    return ds * ds + dt * dt < radius * radius ? t->inside : t->outside;
}

static sr_status prepare(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use, (void)arena;
    return sr_mapping_prepare(&((struct dots *)self)->mapping, error);
}

static float eval_float(const void *self, const struct sr_point *x)
{
    return sr_texture_float(texture_at(self, x), x);
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    return sr_texture_spectrum(texture_at(self, x), x, w);
}

const struct sr_texture_model sr_texture_dots_float = {
    .name = "dots",
    .params = params_float,
    .size = sizeof(struct dots),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = OFFSET(mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_dots_spectrum = {
    .name = "dots",
    .params = params_spectrum,
    .size = sizeof(struct dots),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = OFFSET(mapping),
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare,
    .eval_spectrum = eval_spectrum,
};
