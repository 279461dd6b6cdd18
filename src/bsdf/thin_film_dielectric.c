/* SPDX-License-Identifier: MIT */
/* Glass or water under one thin film, or a film in air: oil on water, an anti-reflection coating, a soap bubble.
 *
 *     reflection:   f = R(|wo.m|) D G / (4 |zo| |zi|)                                          [1/sr]
 *     transmission: f = T(|wo.m|) D G |wi.m| |wo.m| / (|zo| |zi| (wi.m + wo.m / eta)^2)   [1/sr]
 *         (over eta^2 for radiance)
 *     r = (r01 + r12 e^2) / (1 + r01 r12 e^2),   e = exp(2 pi i n1 d cos_1 / lambda),   R = (|r_s|^2 + |r_p|^2) / 2
 *
 * Airy's sum of all coherent bounces, at each of the path's wavelengths. Light leaves in the directions that bare glass
 * would give it. T = 1 - R where the film is clear; a film that absorbs (film_k) looks different from its two sides and
 * lets through the same. Airy 1833; Born & Wolf, 7th ed., 1.6.4; Walter et al. 2007; Belcour & Barla 2017.
 *
 * Limits: as thin_film_conductor.c; with eta = 1 (a film in air) the surface is smooth whatever its alpha, and a path
 * bears one index eta of the glass. */
#include "bsdf/film.h"

struct thin_film {
    sr_spectrum film_eta, film_k; // [1]
    sr_spectrum lambda;           // [nm]
    float thickness;              // [nm]
    float eta;                    // [1] inside over outside
    struct sr_ggx ggx;
};

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "film_thickness", "nm", 0, 2000, 300, offsetof(struct thin_film, thickness), "of the film"},
    {SR_PARAM_UNBOUNDED, "film_eta", "1", 1, 4, 1.33, offsetof(struct thin_film, film_eta),
     "index of refraction of the film"},
    {SR_PARAM_UNBOUNDED, "film_k", "1", 0, 4, 0, offsetof(struct thin_film, film_k), "absorption index of the film"},
    {SR_PARAM_FLOAT, "eta", "1", 0.25, 4, 1.5, offsetof(struct thin_film, eta),
     "index of refraction of what is below the film: inside over outside"},
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
    struct film_stack f = {.film_count = 1, .layer_count = 1, .n = SR_BLACK + m->eta};
    f.films[0] = (struct film){m->film_eta, m->film_k, m->thickness};
    return f;
}

static uint32_t lobes(const void *self)
{
    const struct thin_film *m = self;
    return film_glass_lobes(m->eta, m->ggx);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct thin_film *m = self;
    struct film_stack stack = stack_of(m);
    return film_glass_f_pdf(&stack, m->eta, m->ggx, m->lambda, wo, wi, mode, p);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_thin_film_dielectric.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_thin_film_dielectric.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct thin_film *m = self;
    struct film_stack stack = stack_of(m);
    return film_glass_sample(&stack, m->eta, m->ggx, m->lambda, wo, u_lobe, u, mode, s);
}

/* In the form for importance. */
static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct thin_film *m = self;
    struct film_stack stack = stack_of(m);
    if (!film_glass_is_smooth(m->eta, m->ggx))
        return SR_BLACK + NAN;
    float cos_t;
    fresnel_and_cos(fabsf(wo.z), wo.z < 0 ? 1 / m->eta : m->eta, &cos_t);
    struct film_shares s = film_shares(&stack, m->lambda, fabsf(wo.z), cos_t, wo.z < 0);
    return s.R + s.T;
}

const struct sr_bsdf_model sr_bsdf_thin_film_dielectric = {
    .name = "thin_film_dielectric",
    .title = "Thin film on glass, or in air (Airy)",
    .source = "G. B. Airy 1833; M. Born & E. Wolf, Principles of Optics, 7th ed., 1.6.4; Walter et al. 2007",
    .limits =
        "the film is even and fully coherent: fringes finer than the sampling are noise, not their mean; a film in "
        "air (eta = 1) is smooth",
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
