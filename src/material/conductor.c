/* SPDX-License-Identifier: MIT */
/* A metal, polished or rough: by its complex index eta - i k (copper where nothing is given) or by its reflectance. */
#include "material/private.h"

struct conductor {
    struct bound_metal metal;
    struct bound_ggx ggx;
    bool remap;
};

#define OFFSET(member) offsetof(struct conductor, member)
static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED_TEXTURE, "eta", "1", 0, INFINITY, NAN, OFFSET(metal.eta.texture),
     "index of refraction; copper"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "k", "1", 0, INFINITY, NAN, OFFSET(metal.k.texture), "absorption index; copper"},
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, NAN, OFFSET(metal.reflectance.texture),
     "at normal incidence, in place of eta and k"},
    {SR_PARAM_FLOAT_TEXTURE, "roughness", "1", 0, INFINITY, 0, OFFSET(ggx.roughness), "of both directions"},
    {SR_PARAM_FLOAT_TEXTURE, "uroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.u_roughness), "along the tangent"},
    {SR_PARAM_FLOAT_TEXTURE, "vroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.v_roughness), "across the tangent"},
    {SR_PARAM_BOOL, "remaproughness", "1", 0, 1, 1, OFFSET(remap),
     "alpha is the root of roughness; else roughness itself"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct conductor *m = self;
    bind_ggx(&m->ggx, m->remap);
    return bind_metal(&m->metal, error);
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct conductor *m = self;
    struct sr_bsdf_conductor *b = (void *)out->data;
    eval_metal(&m->metal, c, &b->eta, &b->k);
    b->ggx = eval_ggx(&m->ggx, m->remap, c);
    out->model = &sr_bsdf_conductor;
}

const struct sr_material_model sr_material_conductor = {
    .name = "conductor",
    .params = params,
    .size = sizeof(struct conductor),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
