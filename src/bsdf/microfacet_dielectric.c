/* SPDX-License-Identifier: MIT */
/* Ground glass put together from parts: a distribution of slopes and a masking of one's choice.
 *
 *     reflection:   f = F D G / (4 |zo| |zi|)                                                           [1/sr]
 *     transmission: f = (1 - F) D G' |wi.m| |wo.m| / (|zo| |zi| (wi.m + wo.m / eta)^2)                   [1/sr]
 *
 *     masking, with a = Lambda(wo), b = Lambda(wi):
 *         beta     G = 1 / (1 + a + b),  G' = B(1 + a, 1 + b)      exact for Smith's surface
 *         product  G = G' = 1 / ((1 + a) (1 + b))                  Walter et al. 2007
 *         sum      G = G' = 1 / (1 + a + b)                        what some renderers use, and our model dielectric
 *
 * eta is the index on wi's side over that on wo's; radiance is compressed with its solid angle: f / eta^2. Both alpha
 * below 1e-3, or indices within 1e-3 of each other: a delta function. What scatters twice is lost. */
#include "bsdf/facets_interface.h"

struct microfacet_dielectric {
    float eta; // [1] inside over outside
    float alpha_x, alpha_y;
    int32_t distribution, masking;
};

static const struct sr_param params[] = {
    {SR_PARAM_ENUM, "distribution", "1", 0, 1, 0, offsetof(struct microfacet_dielectric, distribution), "ggx|beckmann"},
    {SR_PARAM_ENUM, "masking", "1", 0, 2, 0, offsetof(struct microfacet_dielectric, masking), "beta|product|sum"},
    {SR_PARAM_FLOAT, "eta", "1", 0.25, 4, 1.5, offsetof(struct microfacet_dielectric, eta),
     "index of refraction: inside over outside"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0, 1, 0.3, offsetof(struct microfacet_dielectric, alpha_x),
     "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0, 1, 0.3, offsetof(struct microfacet_dielectric, alpha_y),
     "slope width across it"},
    {0},
};

static struct rough_interface boundary(const struct microfacet_dielectric *m)
{
    return rough_interface_of(m->eta, m->distribution, m->masking, m->alpha_x, m->alpha_y);
}

static uint32_t lobes(const void *self)
{
    return SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION | (boundary(self).is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct microfacet_dielectric *m = self;
    struct rough_interface a = boundary(m);
    float value = rough_interface_f_pdf(&a, wo, wi, p);
    if (mode == SR_RADIANCE && wo.z * wi.z < 0)
        value *= sr_sqr(wo.z > 0 ? 1 / m->eta : m->eta);
    return SR_BLACK + value;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_microfacet_dielectric.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_microfacet_dielectric.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    struct rough_interface a = boundary(self);
    struct interface_sample i;
    if (!rough_interface_sample(&a, wo, u_lobe, u, &i))
        return false;
    *s = rough_interface_told(&a, &i, mode);
    return true;
}

/* In the form for importance: nothing is lost at a smooth boundary. */
static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    (void)wo;
    return boundary(self).is_smooth ? SR_ONE : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_microfacet_dielectric = {
    .name = "microfacet_dielectric",
    .title = "Glass of microfacets, in parts",
    .source =
        "B. Walter et al., Microfacet models for refraction through rough surfaces, 2007, eqs. 20 and 21; E. Heitz, "
        "Understanding the masking-shadowing function in microfacet-based BRDFs, 2014",
    .limits = "Light that bounces between facets is lost",
    .params = params,
    .size = sizeof(struct microfacet_dielectric),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
