/* SPDX-License-Identifier: MIT */
/* A metal under a coating of up to 16 thin layers: enhanced mirrors, selective absorbers, interference filters.
 *
 *     f = R(|wo.m|) D(m) G(wo, wi) / (4 cos_theta_o cos_theta_i)   [1/sr],    m = (wo + wi) / |wo + wi|
 *
 * R from the coherent sum over all layers (film.h), which is what the product of characteristic matrices gives; mean of
 * both polarisations, at each of the path's wavelengths. Layers alternate between a high and a low index, or come from
 * a file (multilayer.h). Abeles 1950; Parratt 1954; Born & Wolf, 7th ed., 1.6.
 *
 * Limits: even layers, coherent throughout; single scattering between facets; indices from a file are the same at all
 * wavelengths. */
#include "bsdf/multilayer.h"

struct multilayer {
    sr_spectrum eta, k; // [1]
    sr_spectrum lambda; // [nm]
    struct recipe recipe;
    struct sr_ggx ggx;
};
_Static_assert(sizeof(struct multilayer) <= SR_BSDF_SIZE, "too large for a BSDF at a point");

static const struct sr_param params[] = {
    RECIPE_ROWS(struct multilayer),
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct multilayer, eta),
     "index of refraction of the metal"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct multilayer, k), "absorption index of the metal"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0, 1, 0, offsetof(struct multilayer, ggx.alpha_x),
     "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0, 1, 0, offsetof(struct multilayer, ggx.alpha_y), "slope width across it"},
    {0},
};

static sr_status load(void *self, struct sr_arena *arena, struct sr_error *error)
{
    return load_recipe(&((struct multilayer *)self)->recipe, arena, error);
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    ((struct multilayer *)self)->lambda = at->lambda;
}

static struct film_stack stack_of(const struct multilayer *m)
{
    return stack_of_recipe(&m->recipe, m->eta, m->k);
}

static uint32_t lobes(const void *self)
{
    const struct multilayer *m = self;
    return SR_LOBE_REFLECTION | (ggx_is_smooth(m->ggx) ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct multilayer *m = self;
    (void)mode;
    struct film_stack stack = stack_of(m);
    return film_metal_f_pdf(&stack, m->ggx, m->lambda, wo, wi, p);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_multilayer_conductor.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_multilayer_conductor.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct multilayer *m = self;
    (void)u_lobe;
    (void)mode;
    struct film_stack stack = stack_of(m);
    return film_metal_sample(&stack, m->ggx, m->lambda, wo, u, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct multilayer *m = self;
    struct film_stack stack = stack_of(m);
    return ggx_is_smooth(m->ggx) ? film_reflectance(&stack, m->lambda, fabsf(wo.z)) : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_multilayer_conductor = {
    .name = "multilayer_conductor",
    .title = "Optical coating on a metal (multilayer)",
    .source = "F. Abeles 1950; L. G. Parratt 1954; M. Born & E. Wolf, Principles of Optics, 7th ed., 1.6",
    .limits = "layers are even and fully coherent: fringes finer than the sampling are noise, not their mean",
    .params = params,
    .size = sizeof(struct multilayer),
    .load = load,
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
