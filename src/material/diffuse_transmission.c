/* SPDX-License-Identifier: MIT */
/* A thin sheet that scatters light diffusely to both sides. Both shares are scaled, then held in 0 … 1. */
#include "material/private.h"

struct diffuse_transmission {
    struct bound_spectrum reflectance, transmittance; // [1]
    float scale;                                      // [1]
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, 0.25,
     offsetof(struct diffuse_transmission, reflectance.texture), "share that leaves to the side where it came from"},
    {SR_PARAM_ALBEDO_TEXTURE, "transmittance", "1", 0, 1, 0.25,
     offsetof(struct diffuse_transmission, transmittance.texture), "share that leaves to the other side"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, offsetof(struct diffuse_transmission, scale), "factor of both"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena, (void)error;
    struct diffuse_transmission *m = self;
    bind_spectrum(&m->reflectance, sr_spd_constant(0.25f));
    bind_spectrum(&m->transmittance, sr_spd_constant(0.25f));
    return SR_OK;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct diffuse_transmission *m = self;
    struct sr_bsdf_diffuse_transmission *b = (void *)out->data;
    b->reflectance = sr_spectrum_clamp(m->scale * eval_spectrum(&m->reflectance, c), 0, 1);
    b->transmittance = sr_spectrum_clamp(m->scale * eval_spectrum(&m->transmittance, c), 0, 1);
    out->model = &sr_bsdf_diffuse_transmission;
}

const struct sr_material_model sr_material_diffuse_transmission = {
    .name = "diffusetransmission",
    .params = params,
    .size = sizeof(struct diffuse_transmission),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
