/* SPDX-License-Identifier: MIT */
/* Rough reflection put together from parts: a distribution of slopes, a masking and a Fresnel term of one's choice.
 *
 *     f = F(|wo.m|) D(m) G(wo, wi) / (4 |zo| |zi|)    [1/sr],    m = (wo + wi) / |wo + wi|
 *
 *     distribution  ggx       D = 1 / (pi ax ay (m.x^2/ax^2 + m.y^2/ay^2 + m.z^2)^2)               [1/sr]
 *                   beckmann  D = exp(-(m.x^2/ax^2 + m.y^2/ay^2) / m.z^2) / (pi ax ay m.z^4)
 *                   phong     D = m.z^n / (pi ax ay),  n + 2 = 2 (m.x^2/ax^2 + m.y^2/ay^2) / (m.x^2 + m.y^2)
 *     masking       smith     1 / (1 + Lambda(wo) + Lambda(wi))
 *                   product   1 / ((1 + Lambda(wo)) (1 + Lambda(wi)))
 *                   v_cavity  min(1, 2 m.z |zo| / |wo.m|, 2 m.z |zi| / |wo.m|)
 *     fresnel       conductor (eta, k relative to the outside)
 *                   schlick   F0 + (1 - F0) (1 - c)^5 with F0 = specular
 *                   one       1: for looking at shapes, and for furnaces
 *
 * Walter et al. 2007 (masking by the product), Heitz 2014 (height-correlated), Cook & Torrance 1982 (V-cavities),
 * Schlick 1994. Phong's slopes have no Lambda in closed form; like Walter's they borrow Beckmann's, so that a little
 * more or less light is masked than such a surface would, and where n is small E passes 1. Single scattering: what
 * bounces between facets is lost. */
#include "bsdf/facets.h"

enum { CONDUCTOR, SCHLICK, UNITY };

struct microfacet {
    sr_spectrum eta, k, specular; // [1]
    float alpha_x, alpha_y;
    int32_t distribution, masking, fresnel;
};

static const struct sr_param params[] = {
    {SR_PARAM_ENUM, "distribution", "1", 0, 2, 0, offsetof(struct microfacet, distribution), "ggx|beckmann|phong"},
    {SR_PARAM_ENUM, "masking", "1", 0, 2, 0, offsetof(struct microfacet, masking), "smith|product|v_cavity"},
    {SR_PARAM_ENUM, "fresnel", "1", 0, 2, 0, offsetof(struct microfacet, fresnel), "conductor|schlick|one"},
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct microfacet, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct microfacet, k), "absorption index"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.04, offsetof(struct microfacet, specular),
     "reflectance of a facet seen straight on, for Schlick's formula"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0.001, 1, 0.3, offsetof(struct microfacet, alpha_x),
     "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0.001, 1, 0.3, offsetof(struct microfacet, alpha_y), "slope width across it"},
    {0},
};

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY;
}

static struct facets facets(const struct microfacet *m)
{
    return facets_of(m->distribution, m->masking, m->alpha_x, m->alpha_y);
}

static sr_spectrum reflectance(const struct microfacet *m, float c)
{
    if (m->fresnel == CONDUCTOR)
        return conductor_fresnel(c, m->eta, m->k);
    if (m->fresnel == UNITY)
        return SR_ONE;
    float d = 1 - sr_min(c, 1), d2 = d * d;
    return m->specular + (1 - m->specular) * (d2 * d2 * d);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct microfacet *m = self;
    (void)mode;
    struct facets a = facets(m);
    float cos_m, shape = facets_reflection(&a, wo, wi, p, &cos_m);
    return shape > 0 ? reflectance(m, cos_m) * shape : SR_BLACK;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_microfacet.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_microfacet.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct microfacet *m = self;
    (void)mode;
    struct facets a = facets(m);
    float shape, cos_m;
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = lobes(self)};
    if (!facets_sample_reflection(&a, wo, u_lobe, u, &s->wi, &shape, &s->pdf, &cos_m))
        return false;
    s->f = reflectance(m, cos_m) * shape;
    return true;
}

const struct sr_bsdf_model sr_bsdf_microfacet = {
    .name = "microfacet",
    .title = "Microfacets, in parts",
    .source = "B. Walter et al., Microfacet models for refraction through rough surfaces, 2007, eq. 20",
    .limits =
        "Light that bounces between facets is lost, up to 69 % at alpha = 1; Phong's slopes borrow another's masking",
    .params = params,
    .size = sizeof(struct microfacet),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = 1.8f, // toward grazing: Phong's slopes, Smith's masking of Beckmann's, alpha 1, Fresnel one
};
