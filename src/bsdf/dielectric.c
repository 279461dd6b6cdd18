/* SPDX-License-Identifier: MIT */
/* Glass, water: a boundary that reflects Fresnel's share F and refracts the rest, smooth or of Trowbridge-Reitz facets.
 *
 *     reflection:   f = F D G / (4 |zo| |zi|)                                                          [1/sr]
 *     transmission: f = (1 - F) D G |wi.m| |wo.m| / (|zo| |zi| (wi.m + wo.m / eta)^2)                   [1/sr]
 *
 * with m the facet that sends wo to wi, and eta the index on wi's side over that on wo's side; radiance is compressed
 * with its solid angle: f / eta^2. Walter et al. 2007. Refracted light is masked by the same height-correlated G as
 * reflected light, as the renderers that we compare with do; the exact form for opposite sides is a little darker.
 * A path bears one index: for dispersion give the index of its first wavelength. */
#include "bsdf/microfacet.h"

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "eta", "1", 0.25, 4, 1.5, offsetof(struct sr_bsdf_dielectric, eta),
     "index of refraction: inside over outside"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0, 1, 0, offsetof(struct sr_bsdf_dielectric, ggx.alpha_x),
     "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0, 1, 0, offsetof(struct sr_bsdf_dielectric, ggx.alpha_y),
     "slope width across it"},
    {0},
};

#define BOTH (SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION)

static uint32_t lobes(const void *self)
{
    const struct sr_bsdf_dielectric *m = self;
    if (m->eta == 1)
        return SR_LOBE_TRANSMISSION | SR_LOBE_SPECULAR;
    return BOTH | (ggx_is_smooth(m->ggx) ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct sr_bsdf_dielectric *m = self;
    struct interface a = interface_of(m->eta, m->ggx);
    float value = interface_f_pdf(&a, wo, wi, BOTH, p);
    if (mode == SR_RADIANCE && wo.z * wi.z < 0)
        value *= sr_sqr(wo.z > 0 ? 1 / m->eta : m->eta);
    return SR_BLACK + value;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_dielectric.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_dielectric.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_dielectric *m = self;
    struct interface a = interface_of(m->eta, m->ggx);
    struct interface_sample i;
    if (!interface_sample(&a, wo, u_lobe, u, BOTH, &i))
        return false;
    float value = i.weight * i.pdf / fabsf(i.wi.z);
    if (mode == SR_RADIANCE && i.transmits)
        value /= i.eta * i.eta;
    *s = (struct sr_bsdf_sample){.wi = i.wi,
                                 .f = SR_BLACK + value,
                                 .pdf = i.pdf,
                                 .eta = i.eta,
                                 .lobe = (i.transmits ? SR_LOBE_TRANSMISSION : SR_LOBE_REFLECTION) |
                                         (a.is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY)};
    return true;
}

/* In the form for importance: nothing is lost at a smooth boundary. */
static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sr_bsdf_dielectric *m = self;
    (void)wo;
    return m->eta == 1 || ggx_is_smooth(m->ggx) ? SR_ONE : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_dielectric = {
    .name = "dielectric",
    .title = "Glass: clear or of GGX microfacets",
    .source = "B. Walter et al., Microfacet models for refraction through rough surfaces, 2007",
    .limits = "light that meets two facets is lost; one index for all wavelengths of a path",
    .params = params,
    .size = sizeof(struct sr_bsdf_dielectric),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
