/* SPDX-License-Identifier: MIT */
/* A thin clear sheet, as a window pane: light goes straight on or is mirrored.
 *
 * Where eta varies with wavelength the path goes on with its first wavelength alone, as pbrt has it, although the
 * direction is the same for all. */
#include "material/private.h"

struct thin_dielectric {
    struct bound_spectrum eta; // [1] of the sheet over its surroundings
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED_TEXTURE, "eta", "1", 0, INFINITY, 1.5, offsetof(struct thin_dielectric, eta.texture),
     "index of the sheet over index around it"},
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
    out->model = &sr_bsdf_thin_dielectric;
}

const struct sr_material_model sr_material_thin_dielectric = {
    .name = "thindielectric",
    .params = params,
    .size = sizeof(struct thin_dielectric),
    .prepare = prepare,
    .bsdf = bsdf,
};
