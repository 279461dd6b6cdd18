/* SPDX-License-Identifier: MIT */
/* Values at the corners of a mesh's triangles, such as vertex colours:  value = b0 v0 + b1 v1 + b2 v2  (corners.h).
 *
 * A spectrum texture takes the first three components as linear RGB and interpolates the corners' curves, which is
 * linear in the spectrum, as between texels (pyramid.c). A float texture takes one component. */
#include "texture/corners.h"
#include "texture/private.h"
#include "texture/pyramid.h"

struct attribute {
    struct sr_slice values; // components for each corner, three corners a triangle
    int32_t components, component;
    uint32_t triangle_count;              // derived
    const struct sr_packed_texel *curves; // derived, one a corner
    struct sr_spd white;                  // for emission: the spectrum of RGB (1,1,1); else kind NONE
};

#define OFFSET(member) offsetof(struct attribute, member)
static const struct sr_param params_float[] = {
    {SR_PARAM_FLOATS, "values", "1", -INFINITY, INFINITY, NAN, OFFSET(values), "of each triangle's corners"},
    {SR_PARAM_INT, "components", "1", 1, 4, 1, OFFSET(components), "how many belong to a corner"},
    {SR_PARAM_INT, "component", "1", 0, 3, 0, OFFSET(component), "which of them, from 0"},
    {0},
};
static const struct sr_param params_spectrum[] = {
    {SR_PARAM_FLOATS, "values", "1", 0, INFINITY, NAN, OFFSET(values), "of each triangle's corners: red, green, blue"},
    {SR_PARAM_INT, "components", "1", 3, 4, 3, OFFSET(components), "how many belong to a corner"},
    {0},
};

static float eval_float(const void *self, const struct sr_point *x)
{
    const struct attribute *m = self;
    float w[3];
    size_t first = corners_at(x, m->triangle_count, w), n = (size_t)m->components;
    const float *v = (const float *)m->values.data + first * n + m->component;
    return w[0] * v[0] + w[1] * v[n] + w[2] * v[2 * n];
}

static sr_spectrum eval_spectrum(const void *self, const struct sr_point *x, const struct sr_wavelengths *w)
{
    const struct attribute *m = self;
    float weight[3];
    const struct sr_packed_texel *c = m->curves + corners_at(x, m->triangle_count, weight);
    const struct sr_packed_texel *const corner[3] = {c, c + 1, c + 2};
    sr_spectrum s = sr_packed_texels_sum(corner, weight, 3, true, w->lambda);
    return m->white.kind == SR_SPD_NONE ? s : s * sr_spd_eval(&m->white, w->lambda);
}

static sr_status check(struct attribute *m, struct sr_error *error)
{
    uint32_t n = 3 * (uint32_t)m->components;
    if (m->values.count == 0 || m->values.count % n || m->component >= m->components)
        return sr_fail(error, SR_ERROR_INPUT, "\"values\" has %u numbers: expected %d for each corner of each triangle",
                       m->values.count, m->components);
    m->triangle_count = m->values.count / n;
    const float *v = m->values.data;
    for (uint32_t i = 0; i < m->values.count; ++i)
        if (!isfinite(v[i]))
            return sr_fail(error, SR_ERROR_INPUT, "\"values\" must be finite numbers");
    return SR_OK;
}

static sr_status prepare_float(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    (void)use, (void)arena;
    return check(self, error);
}

static sr_status prepare_spectrum(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error)
{
    struct attribute *m = self;
    if (check(m, error))
        return error->status;
    size_t corner_count = 3 * (size_t)m->triangle_count;
    struct sr_packed_texel *curves = sr_arena_alloc(arena, corner_count * sizeof *curves);
    if (!curves)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the values of %u triangles", m->triangle_count);
    const float *v = m->values.data;
    for (size_t i = 0; i < corner_count; ++i, v += m->components)
        curves[i] = sr_packed_texel_encode(use, (struct sr_rgb){sr_max(v[0], 0), sr_max(v[1], 0), sr_max(v[2], 0)});
    m->curves = curves;
    if (use.rgb_use == SR_PARAM_ILLUMINANT)
        m->white = sr_spd_from_rgb_illuminant(use.space, (struct sr_rgb){1, 1, 1});
    return SR_OK;
}

const struct sr_texture_model sr_texture_attribute_float = {
    .name = "attribute",
    .params = params_float,
    .size = sizeof(struct attribute),
    .is_float = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_float,
    .eval_float = eval_float,
};
const struct sr_texture_model sr_texture_attribute_spectrum = {
    .name = "attribute",
    .params = params_spectrum,
    .size = sizeof(struct attribute),
    .is_spectrum = true,
    .texels_offset = SR_TEXTURE_NOWHERE,
    .mapping_offset = SR_TEXTURE_NOWHERE,
    .transform_offset = SR_TEXTURE_NOWHERE,
    .prepare = prepare_spectrum,
    .eval_spectrum = eval_spectrum,
};
