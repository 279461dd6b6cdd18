/* SPDX-License-Identifier: MIT */
/* A share of each of two textures by the way the surface faces:  value = a tex1 + (1 - a) tex2,  a = |n . dir|.
 *
 * n is the geometric normal, dir [1] a direction of the texture's space, turned into the world and made of unit length.
 * The share of tex1 is a, as in pbrt-v4 (Pharr, Jakob & Humphreys 2023, 10.3); in "mix", amount is that of tex2. */
#include "texture/private.h"

struct directionmix {
    struct sr_texture tex1, tex2;
    sr_vec3 dir;
    struct sr_transform world_to_texture;
    sr_vec3 axis; // derived: dir in the world, of unit length
};

#define OFFSET(member) offsetof(struct directionmix, member)
#define DIR_ROW                                                                                                        \
    {                                                                                                                  \
        SR_PARAM_VECTOR3, "dir", "1", -INFINITY, INFINITY, NAN, OFFSET(dir), "where tex1 faces, (0,1,0) by default"    \
    }
static const struct sr_param params_float[] = {
    {SR_PARAM_FLOAT_TEXTURE, "tex1", "1", -INFINITY, INFINITY, 0, OFFSET(tex1), "where the normal is along dir"},
    {SR_PARAM_FLOAT_TEXTURE, "tex2", "1", -INFINITY, INFINITY, 1, OFFSET(tex2), "where it is across dir"},
    DIR_ROW,
    {0},
};
static const struct sr_param params_spectrum[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "tex1", "1", 0, INFINITY, 0, OFFSET(tex1), "where the normal is along dir"},
    {SR_PARAM_ALBEDO_TEXTURE, "tex2", "1", 0, INFINITY, 1, OFFSET(tex2), "where it is across dir"},
    DIR_ROW,
    {0},
};

static sr_status prepare(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use, (void)arena;
    struct directionmix *t = self;
    if (isnan(t->dir.x) && isnan(t->dir.y) && isnan(t->dir.z))
        t->dir = (sr_vec3){0, 1, 0};
    t->axis = sr_normalize(sr_inverse_vector(&t->world_to_texture, t->dir));
    return sr_is_finite(t->axis) ? SR_OK : sr_fail(error, SR_ERROR_INPUT, "\"dir\" must have a finite length above 0");
}

static float share_of_tex1(const struct directionmix *t, const struct sr_point *x)
{
    return sr_min(fabsf(sr_dot(x->n, t->axis)), 1);
}

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct directionmix *t = self;
    float share = share_of_tex1(t, x);
    return share * sr_texture_float(t->tex1, x) + (1 - share) * sr_texture_float(t->tex2, x);
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct directionmix *t = self;
    float share = share_of_tex1(t, x);
    return share * sr_texture_spectrum(t->tex1, x, w) + (1 - share) * sr_texture_spectrum(t->tex2, x, w);
}

const struct sr_texture_model sr_texture_directionmix_float = {
    .name = "directionmix",
    .params = params_float,
    .size = sizeof(struct directionmix),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = OFFSET(world_to_texture),
    .prepare = prepare,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_directionmix_spectrum = {
    .name = "directionmix",
    .params = params_spectrum,
    .size = sizeof(struct directionmix),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = OFFSET(world_to_texture),
    .prepare = prepare,
    .eval_spectrum = eval_spectrum,
};
