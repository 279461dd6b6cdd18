/* SPDX-License-Identifier: MIT */
/* A clear or cloudy coat over Lambert's surface: paint, plastic, glazed clay. */
#include "material/private.h"

struct coated_diffuse {
    struct bound_spectrum reflectance, eta, albedo; // [1]
    struct bound_ggx ggx;
    struct bound_float thickness, g; // [mean free paths], [1]
    int32_t max_depth, sample_count;
    bool remap, unbiased;
};

#define OFFSET(member) offsetof(struct coated_diffuse, member)
static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, 0.5, OFFSET(reflectance.texture), "of the base"},
    {SR_PARAM_FLOAT_TEXTURE, "roughness", "1", 0, INFINITY, 0, OFFSET(ggx.roughness), "of the coat, both directions"},
    {SR_PARAM_FLOAT_TEXTURE, "uroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.u_roughness),
     "of the coat, along the tangent"},
    {SR_PARAM_FLOAT_TEXTURE, "vroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.v_roughness),
     "of the coat, across the tangent"},
    {SR_PARAM_BOOL, "remaproughness", "1", 0, 1, 1, OFFSET(remap),
     "alpha is the root of roughness; else roughness itself"},
    {SR_PARAM_FLOAT_TEXTURE, "thickness", "1", 0, INFINITY, 0.01, OFFSET(thickness.texture),
     "of the coat, in mean free paths"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "eta", "1", 0, INFINITY, 1.5, OFFSET(eta.texture),
     "index of the coat over index outside"},
    {SR_PARAM_FLOAT_TEXTURE, "g", "1", -1, 1, 0, OFFSET(g.texture), "Henyey-Greenstein asymmetry in the coat"},
    {SR_PARAM_ALBEDO_TEXTURE, "albedo", "1", 0, 1, 0, OFFSET(albedo.texture),
     "single-scattering albedo in the coat; 0: clear"},
    {SR_PARAM_INT, "maxdepth", "1", 1, 1e6, 10, OFFSET(max_depth), "longest walk between the layers"},
    {SR_PARAM_INT, "nsamples", "1", 1, 1e6, 1, OFFSET(sample_count), "walks of one evaluation"},
    {SR_PARAM_BOOL, "unbiased", "1", 0, 1, 0, OFFSET(unbiased),
     "rough coats: exact weights; otherwise those of pbrt, which shine a few percent too much"},
    {0},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena, (void)error;
    struct coated_diffuse *m = self;
    bind_spectrum(&m->reflectance, sr_spd_constant(0.5f));
    bind_spectrum(&m->eta, sr_spd_constant(1.5f));
    bind_spectrum(&m->albedo, sr_spd_constant(0));
    bind_ggx(&m->ggx, m->remap);
    bind_float(&m->thickness, 0.01f);
    bind_float(&m->g, 0);
    return SR_OK;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct coated_diffuse *m = self;
    struct sr_bsdf_coated *b = (void *)out->data;
    *b = (struct sr_bsdf_coated){
        .base_reflectance = eval_albedo(&m->reflectance, c),
        .albedo = eval_albedo(&m->albedo, c),
        .coat_ggx = eval_ggx(&m->ggx, m->remap, c),
        .coat_eta = eval_index(&m->eta, c),
        .thickness = sr_max(eval_float(&m->thickness, c), 0),
        .g = sr_clamp(eval_float(&m->g, c), -1, 1),
        .max_depth = m->max_depth,
        .sample_count = m->sample_count,
        .seed = c->seed,
        .weighs_as_pbrt = !m->unbiased,
    };
    out->model = &sr_bsdf_coated_diffuse;
}

const struct sr_material_model sr_material_coated_diffuse = {
    .name = "coateddiffuse",
    .params = params,
    .size = sizeof(struct coated_diffuse),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
