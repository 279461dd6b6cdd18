/* SPDX-License-Identifier: MIT */
/* A thin clear sheet, as a window pane: light goes straight on or is mirrored.
 *
 * Where eta varies with wavelength the path goes on with its first wavelength alone, as pbrt has it, although the
 * direction is the same for all. Its bounces are summed as pbrt does, or with "unbiased" for each polarisation. */
#include "material/private.h"

struct thin_dielectric {
    struct bound_spectrum eta; // [1] of the sheet over its surroundings
    bool unbiased;
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED_TEXTURE, "eta", "1", 0, INFINITY, 1.5, offsetof(struct thin_dielectric, eta.texture),
     "index of the sheet over index around it"},
    {SR_PARAM_BOOL, "unbiased", "1", 0, 1, 0, offsetof(struct thin_dielectric, unbiased),
     "sums the bounces for each polarisation; pbrt-v4 takes their mean first, which passes up to 2 % too little"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena, (void)error;
    struct thin_dielectric *m = self;
    bind_spectrum(&m->eta, sr_spd_constant(1.5f));
    return SR_OK;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct thin_dielectric *m = self;
    struct sr_bsdf_thin_dielectric *b = (void *)out->data;
    b->eta = eval_index(&m->eta, c);
    b->sums_as_pbrt = !m->unbiased;
    out->model = &sr_bsdf_thin_dielectric;
}

const struct sr_material_model sr_material_thin_dielectric = {
    .name = "thindielectric",
    .params = params,
    .size = sizeof(struct thin_dielectric),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
