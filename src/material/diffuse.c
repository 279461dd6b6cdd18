/* SPDX-License-Identifier: MIT */
/* Lambert's surface whose reflectance may vary over it. The reflectance is held in 0 … 1. */
#include "material/private.h"

struct diffuse {
    struct bound_spectrum reflectance; // [1]
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, 0.5, offsetof(struct diffuse, reflectance.texture),
     "share of the arriving light that leaves again"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena, (void)error;
    struct diffuse *m = self;
    bind_spectrum(&m->reflectance, sr_spd_constant(0.5f));
    return SR_OK;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct diffuse *m = self;
    struct sr_bsdf_diffuse *b = (void *)out->data;
    b->reflectance = eval_albedo(&m->reflectance, c);
    out->model = &sr_bsdf_diffuse;
}

const struct sr_sigmoid *sr_material_lambert(const struct sr_material *material)
{
    if (!material || material->model != &sr_material_diffuse || !sr_material_is_plain(material))
        return NULL;
    const struct sr_spd *s = &((const struct diffuse *)material->self)->reflectance.constant;
    return s->kind == SR_SPD_SIGMOID && s->scale == 1 ? &s->sigmoid : NULL;
}

const struct sr_material_model sr_material_diffuse = {
    .name = "diffuse",
    .params = params,
    .size = sizeof(struct diffuse),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
