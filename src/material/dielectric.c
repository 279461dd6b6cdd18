/* SPDX-License-Identifier: MIT */
/* Glass, water, plastic without pigment: the boundary of a clear medium of index eta, polished or rough.
 *
 * Where eta varies with wavelength the path goes on with its first wavelength alone. */
#include "material/private.h"

struct dielectric {
    struct bound_spectrum eta; // [1] inside over outside
    struct bound_ggx ggx;
    bool remap;
};

#define OFFSET(member) offsetof(struct dielectric, member)
static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED_TEXTURE, "eta", "1", 0, INFINITY, 1.5, OFFSET(eta.texture), "index inside over index outside"},
    {SR_PARAM_FLOAT_TEXTURE, "roughness", "1", 0, INFINITY, 0, OFFSET(ggx.roughness), "of both directions"},
    {SR_PARAM_FLOAT_TEXTURE, "uroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.u_roughness), "along the tangent"},
    {SR_PARAM_FLOAT_TEXTURE, "vroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.v_roughness), "across the tangent"},
    {SR_PARAM_BOOL, "remaproughness", "1", 0, 1, 1, OFFSET(remap),
     "alpha is the root of roughness; else roughness itself"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena, (void)error;
    struct dielectric *m = self;
    bind_spectrum(&m->eta, sr_spd_constant(1.5f));
    bind_ggx(&m->ggx, m->remap);
    return SR_OK;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct dielectric *m = self;
    struct sr_bsdf_dielectric *b = (void *)out->data;
    b->eta = eval_index(&m->eta, c);
    b->ggx = eval_ggx(&m->ggx, m->remap, c);
    out->model = &sr_bsdf_dielectric;
}

const struct sr_material_model sr_material_dielectric = {
    .name = "dielectric",
    .params = params,
    .size = sizeof(struct dielectric),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
