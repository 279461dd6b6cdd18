/* SPDX-License-Identifier: MIT */
/* A metal under one thin film: an oxide, anodised titanium, oil on steel; mirror or Trowbridge-Reitz microfacets.
 *
 *     f = R(|wo.m|) D(m) G(wo, wi) / (4 cos_theta_o cos_theta_i)   [1/sr],    m = (wo + wi) / |wo + wi|
 *     R = (|r_s|^2 + |r_p|^2) / 2,   r = (r01 + r12 e^2) / (1 + r01 r12 e^2),   e = exp(2 pi i n1 d cos_1 / lambda)
 *
 * Airy's sum of all coherent bounces in the film, at each of the path's wavelengths; indices relative to the outside.
 * The film follows the microfacets. Airy 1833; Born & Wolf, 7th ed., 1.6.4; Belcour & Barla 2017 (in a microfacet
 * model).
 *
 * Limits: single scattering between facets, one even thickness, light coherent over the film: for thicknesses of many
 * wavelengths the fringes are finer than a picture's samples and appear as noise, not as their mean. */
#include "bsdf/film.h"

struct thin_film {
    sr_spectrum eta, k, film_eta, film_k; // [1]
    sr_spectrum lambda;                   // [nm]
    float thickness;                      // [nm]
    struct sr_ggx ggx;
};
_Static_assert(sizeof(struct thin_film) <= SR_BSDF_SIZE, "too large for a BSDF at a point");

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "film_thickness", "nm", 0, 2000, 300, offsetof(struct thin_film, thickness), "of the film"},
    {SR_PARAM_UNBOUNDED, "film_eta", "1", 1, 4, 1.5, offsetof(struct thin_film, film_eta),
     "index of refraction of the film"},
    {SR_PARAM_UNBOUNDED, "film_k", "1", 0, 4, 0, offsetof(struct thin_film, film_k), "absorption index of the film"},
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct thin_film, eta), "index of refraction of the metal"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct thin_film, k), "absorption index of the metal"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0, 1, 0, offsetof(struct thin_film, ggx.alpha_x), "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0, 1, 0, offsetof(struct thin_film, ggx.alpha_y), "slope width across it"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    ((struct thin_film *)self)->lambda = at->lambda;
}

static struct film_stack stack_of(const struct thin_film *m)
{
    struct film_stack f = {.film_count = 1, .layer_count = 1, .n = m->eta, .k = m->k};
    f.films[0] = (struct film){m->film_eta, m->film_k, m->thickness};
    return f;
}

static uint32_t lobes(const void *self)
{
    const struct thin_film *m = self;
    return SR_LOBE_REFLECTION | (ggx_is_smooth(m->ggx) ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct thin_film *m = self;
    (void)mode;
    struct film_stack stack = stack_of(m);
    return film_metal_f_pdf(&stack, m->ggx, m->lambda, wo, wi, p);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_thin_film_conductor.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_thin_film_conductor.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct thin_film *m = self;
    (void)u_lobe;
    (void)mode;
    struct film_stack stack = stack_of(m);
    return film_metal_sample(&stack, m->ggx, m->lambda, wo, u, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct thin_film *m = self;
    struct film_stack stack = stack_of(m);
    return ggx_is_smooth(m->ggx) ? film_reflectance(&stack, m->lambda, fabsf(wo.z)) : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_thin_film_conductor = {
    .name = "thin_film_conductor",
    .title = "Thin film on a metal (Airy)",
    .source = "G. B. Airy 1833; M. Born & E. Wolf, Principles of Optics, 7th ed., 1.6.4",
    .limits = "the film is even and fully coherent: fringes finer than the sampling are noise, not their mean",
    .params = params,
    .size = sizeof(struct thin_film),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
