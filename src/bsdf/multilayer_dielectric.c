/* SPDX-License-Identifier: MIT */
/* Glass under a coating of up to 16 thin layers: dielectric mirrors, anti-reflection stacks, dichroic filters.
 *
 *     reflection:   f = R(|wo.m|) D G / (4 |zo| |zi|)                                          [1/sr]
 *     transmission: f = T(|wo.m|) D G |wi.m| |wo.m| / (|zo| |zi| (wi.m + wo.m / eta)^2)   [1/sr]
 *         (over eta^2 for radiance)
 *
 * R and T from the coherent sum over all layers (film.h), which is what the product of characteristic matrices gives;
 * mean of both polarisations, at each of the path's wavelengths. Layers alternate between a high and a low index, or
 * come from a file (multilayer.h), where they may absorb. Abeles 1950; Parratt 1954; Born & Wolf, 7th ed., 1.6.
 *
 * Limits: even layers, coherent throughout; with eta = 1 the surface is smooth whatever its alpha; a path bears one
 * index eta of the glass; indices from a file are the same at all wavelengths. */
#include "bsdf/multilayer.h"

struct multilayer {
    sr_spectrum lambda; // [nm]
    struct recipe recipe;
    float eta; // [1] inside over outside
    struct sr_ggx ggx;
};

static const struct sr_param params[] = {
    RECIPE_ROWS(struct multilayer),
    {SR_PARAM_FLOAT, "eta", "1", 0.25, 4, 1.5, offsetof(struct multilayer, eta),
     "index of refraction of what is below the layers: inside over outside"},
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
    return stack_of_recipe(&m->recipe, SR_BLACK + m->eta, SR_BLACK);
}

static uint32_t lobes(const void *self)
{
    const struct multilayer *m = self;
    return film_glass_lobes(m->eta, m->ggx);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct multilayer *m = self;
    struct film_stack stack = stack_of(m);
    return film_glass_f_pdf(&stack, m->eta, m->ggx, m->lambda, wo, wi, mode, p);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_multilayer_dielectric.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_multilayer_dielectric.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct multilayer *m = self;
    struct film_stack stack = stack_of(m);
    return film_glass_sample(&stack, m->eta, m->ggx, m->lambda, wo, u_lobe, u, mode, s);
}

/* In the form for importance. */
static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct multilayer *m = self;
    struct film_stack stack = stack_of(m);
    if (!film_glass_is_smooth(m->eta, m->ggx))
        return SR_BLACK + NAN;
    float cos_t;
    fresnel_and_cos(fabsf(wo.z), wo.z < 0 ? 1 / m->eta : m->eta, &cos_t);
    struct film_shares s = film_shares(&stack, m->lambda, fabsf(wo.z), cos_t, wo.z < 0);
    return s.R + s.T;
}

const struct sr_bsdf_model sr_bsdf_multilayer_dielectric = {
    .name = "multilayer_dielectric",
    .title = "Optical coating on glass (multilayer)",
    .source =
        "F. Abeles 1950; L. G. Parratt 1954; M. Born & E. Wolf, Principles of Optics, 7th ed., 1.6; Walter et al. 2007",
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
