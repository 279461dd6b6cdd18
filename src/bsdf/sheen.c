/* SPDX-License-Identifier: MIT */
/* Cloth's sheen: fibres that stand up and scatter at grazing angles, as microfacets of the "Charlie" distribution.
 *
 *     f = C D(m) V(wo, wi)   [1/sr],     D = (2 + 1/alpha) sin^(1/alpha)(theta_m) / (2 pi)   [1/sr]
 *     V = 1 / (4 (ci + co - ci co))                            "neubelt": Neubelt & Pettineo 2013
 *     V = 1 / (4 ci co (1 + Lambda(ci) + Lambda(co)))          "estevez": fitted masking,
 *         Lambda(c) = exp(L(c)) for c < 1/2, else exp(2 L(1/2) - L(1 - c)),   L(x) = A / (1 + B x^C) + D x + E,
 *         (A ... E) = those of alpha = 0 times (1 - alpha)^2 + those of alpha = 1 times the rest
 *
 * A. C. Estevez & C. Kulla, Production Friendly Microfacet Sheen BRDF, 2017. D is normalised, INTEGRAL D cos dm = 1,
 * but belongs to no height field, and there is no Fresnel factor: the lobe gains energy where all is grazing and alpha
 * is small (neubelt). To be put on top of something else by a material that takes its share away from below. Sampled
 * uniformly over the hemisphere. */
#include "bsdf/charlie.h"

enum { NEUBELT, ESTEVEZ };

struct sheen {
    sr_spectrum reflectance; // [1]
    float alpha;             // [1]
    int32_t visibility;
    struct charlie charlie; // derived
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 1, offsetof(struct sheen, reflectance), "colour of the fibres"},
    {SR_PARAM_FLOAT, "alpha", "1", 0.1, 1, 0.3, offsetof(struct sheen, alpha),
     "roughness: how far the fibres spread from the horizon"},
    {SR_PARAM_ENUM, "visibility", "1", 0, 1, NEUBELT, offsetof(struct sheen, visibility), "neubelt|estevez"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct sheen *m = self;
    (void)at;
    m->charlie = charlie_of(m->alpha);
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct sheen *m = self;
    (void)mode;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    float ci = fabsf(wi.z), co = fabsf(wo.z);
    float V = m->visibility == ESTEVEZ ? estevez_V(&m->charlie, ci, co) : neubelt_V(ci, co);
    return m->reflectance * (charlie_D(&m->charlie, wo, wi) * V);
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self;
    (void)mode;
    return wo.z * wi.z > 0 ? SR_INV_PI / 2 : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)u_lobe;
    float z = 1 - u.x, r = sr_safe_sqrt((1 - z) * (1 + z)); // z in (0, 1]
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = lobes(self)};
    s->wi = (sr_vec3){r * cosf(2 * SR_PI * u.y), r * sinf(2 * SR_PI * u.y), wo.z < 0 ? -z : z};
    s->pdf = pdf(self, wo, s->wi, mode);
    s->f = f(self, wo, s->wi, mode);
    return s->pdf > 0;
}

const struct sr_bsdf_model sr_bsdf_sheen = {
    .name = "sheen",
    .title = "Charlie sheen",
    .source =
        "A. C. Estevez & C. Kulla, Production Friendly Microfacet Sheen BRDF, 2017; D. Neubelt & M. Pettineo 2013",
    .limits = "belongs to no height field; gains light within 2 degrees of grazing where alpha is below 0.2",
    .params = params,
    .size = sizeof(struct sheen),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .largest_albedo = 1.355f,
};
