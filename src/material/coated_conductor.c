/* SPDX-License-Identifier: MIT */
/* A clear or cloudy coat over a metal: lacquered brass, car paint's base.
 *
 * The metal's index and absorption are given against vacuum; the metal lies under the coat, so both are divided by the
 * coat's index. */
#include "material/private.h"

struct coated_conductor {
    struct bound_metal metal;
    struct bound_spectrum eta, albedo; // [1] of the coat
    struct bound_ggx coat_ggx, metal_ggx;
    struct bound_float thickness, g; // [mean free paths], [1]
    int32_t max_depth, sample_count;
    bool remap, unbiased;
};

#define OFFSET(member) offsetof(struct coated_conductor, member)
static const struct sr_param params[] = {
    {SR_PARAM_FLOAT_TEXTURE, "interface.roughness", "1", 0, INFINITY, 0, OFFSET(coat_ggx.roughness),
     "of the coat, both directions"},
    {SR_PARAM_FLOAT_TEXTURE, "interface.uroughness", "1", 0, INFINITY, NAN, OFFSET(coat_ggx.u_roughness),
     "of the coat, along the tangent"},
    {SR_PARAM_FLOAT_TEXTURE, "interface.vroughness", "1", 0, INFINITY, NAN, OFFSET(coat_ggx.v_roughness),
     "of the coat, across the tangent"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "interface.eta", "1", 0, INFINITY, 1.5, OFFSET(eta.texture),
     "index of the coat over index outside"},
    {SR_PARAM_FLOAT_TEXTURE, "thickness", "1", 0, INFINITY, 0.01, OFFSET(thickness.texture),
     "of the coat, in mean free paths"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "conductor.eta", "1", 0, INFINITY, NAN, OFFSET(metal.eta.texture),
     "index of the metal; copper"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "conductor.k", "1", 0, INFINITY, NAN, OFFSET(metal.k.texture),
     "absorption index of the metal; copper"},
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, NAN, OFFSET(metal.reflectance.texture),
     "of the bare metal, in place of eta and k"},
    {SR_PARAM_FLOAT_TEXTURE, "conductor.roughness", "1", 0, INFINITY, 0, OFFSET(metal_ggx.roughness),
     "of the metal, both directions"},
    {SR_PARAM_FLOAT_TEXTURE, "conductor.uroughness", "1", 0, INFINITY, NAN, OFFSET(metal_ggx.u_roughness),
     "of the metal, along the tangent"},
    {SR_PARAM_FLOAT_TEXTURE, "conductor.vroughness", "1", 0, INFINITY, NAN, OFFSET(metal_ggx.v_roughness),
     "of the metal, across the tangent"},
    {SR_PARAM_BOOL, "remaproughness", "1", 0, 1, 1, OFFSET(remap),
     "alpha is the root of roughness; else roughness itself"},
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
    (void)arena;
    struct coated_conductor *m = self;
    bind_spectrum(&m->eta, sr_spd_constant(1.5f));
    bind_spectrum(&m->albedo, sr_spd_constant(0));
    bind_ggx(&m->coat_ggx, m->remap);
    bind_ggx(&m->metal_ggx, m->remap);
    bind_float(&m->thickness, 0.01f);
    bind_float(&m->g, 0);
    return bind_metal(&m->metal, error);
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct coated_conductor *m = self;
    struct sr_bsdf_coated *b = (void *)out->data;
    float coat_eta = eval_index(&m->eta, c);
    sr_spectrum eta, k;
    eval_metal(&m->metal, c, &eta, &k);
    *b = (struct sr_bsdf_coated){
        .base_eta = eta / coat_eta,
        .base_k = k / coat_eta,
        .albedo = eval_albedo(&m->albedo, c),
        .coat_ggx = eval_ggx(&m->coat_ggx, m->remap, c),
        .base_ggx = eval_ggx(&m->metal_ggx, m->remap, c),
        .coat_eta = coat_eta,
        .thickness = sr_max(eval_float(&m->thickness, c), 0),
        .g = sr_clamp(eval_float(&m->g, c), -1, 1),
        .max_depth = m->max_depth,
        .sample_count = m->sample_count,
        .seed = c->seed,
        .weighs_as_pbrt = !m->unbiased,
    };
    out->model = &sr_bsdf_coated_conductor;
}

const struct sr_material_model sr_material_coated_conductor = {
    .name = "coatedconductor",
    .params = params,
    .size = sizeof(struct coated_conductor),
    .prepare = prepare,
    .bsdf = bsdf,
    .is_isotropic = true,
};
