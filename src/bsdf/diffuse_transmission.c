/* SPDX-License-Identifier: MIT */
/* A thin sheet like paper: Lambert's law on both sides, with a share reflected and a share let through.
 *
 *     f = rho / pi on wo's side, tau / pi on the other  [1/sr];    rho + tau <= 1 keeps energy
 *     pdf = P(side) |cos_theta_i| / pi  [1/sr],    P in proportion to the largest of rho and of tau
 *
 * The same medium is on both sides, so no factor eta^2. J. H. Lambert 1760. */
#include "bsdf/microfacet.h"

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.25, offsetof(struct sr_bsdf_diffuse_transmission, reflectance),
     "share of light that is reflected"},
    {SR_PARAM_ALBEDO, "transmittance", "1", 0, 1, 0.25, offsetof(struct sr_bsdf_diffuse_transmission, transmittance),
     "share of light that passes"},
    {0},
};

static uint32_t lobes(const void *self)
{
    const struct sr_bsdf_diffuse_transmission *m = self;
    uint32_t lobe = 0;
    if (!sr_spectrum_is_black(m->reflectance))
        lobe |= SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
    if (!sr_spectrum_is_black(m->transmittance))
        lobe |= SR_LOBE_TRANSMISSION | SR_LOBE_DIFFUSE;
    return lobe;
}

static float reflection_probability(const struct sr_bsdf_diffuse_transmission *m)
{
    float r = sr_spectrum_max(m->reflectance), t = sr_spectrum_max(m->transmittance);
    return r + t > 0 ? r / (r + t) : 0;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct sr_bsdf_diffuse_transmission *m = self;
    (void)mode;
    float side = wo.z * wi.z;
    return side > 0 ? m->reflectance * SR_INV_PI : side < 0 ? m->transmittance * SR_INV_PI : SR_BLACK;
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct sr_bsdf_diffuse_transmission *m = self;
    (void)mode;
    float side = wo.z * wi.z;
    if (side == 0 || !lobes(self))
        return 0;
    float p = reflection_probability(m);
    return (side > 0 ? p : 1 - p) * (fabsf(wi.z) * SR_INV_PI);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_diffuse_transmission *m = self;
    (void)mode;
    if (!lobes(self) || wo.z == 0)
        return false;
    float p = reflection_probability(m);
    bool reflects = u_lobe < p;
    sr_vec3 wi = sr_warp_cosine_hemisphere(u);
    wi.z = copysignf(wi.z, reflects ? wo.z : -wo.z);
    *s = (struct sr_bsdf_sample){.wi = wi,
                                 .f = (reflects ? m->reflectance : m->transmittance) * SR_INV_PI,
                                 .pdf = (reflects ? p : 1 - p) * (fabsf(wi.z) * SR_INV_PI),
                                 .eta = 1,
                                 .lobe = (reflects ? SR_LOBE_REFLECTION : SR_LOBE_TRANSMISSION) | SR_LOBE_DIFFUSE};
    return s->pdf > 0;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sr_bsdf_diffuse_transmission *m = self;
    (void)wo;
    return m->reflectance + m->transmittance;
}

const struct sr_bsdf_model sr_bsdf_diffuse_transmission = {
    .name = "diffuse_transmission",
    .title = "Lambert, reflecting and transmitting",
    .source = "J. H. Lambert, Photometria, 1760; both sides of a thin sheet in one medium",
    .params = params,
    .size = sizeof(struct sr_bsdf_diffuse_transmission),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
};
