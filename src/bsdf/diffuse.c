/* SPDX-License-Identifier: MIT */
/* Lambert's surface: equally bright from wherever it is seen, on the side that the light falls on.
 *
 *     f = rho / pi  [1/sr],    pdf = |cos_theta_i| / pi  [1/sr],    so f |cos_theta_i| / pdf = rho without variance
 *
 * rho is the share of the arriving flux that leaves again. J. H. Lambert, Photometria, 1760. */
#include "bsdf/microfacet.h"

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct sr_bsdf_diffuse, reflectance),
     "share of light that is reflected"},
    {0},
};

static uint32_t lobes(const void *self)
{
    const struct sr_bsdf_diffuse *m = self;
    return sr_spectrum_is_black(m->reflectance) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct sr_bsdf_diffuse *m = self;
    (void)mode;
    return sr_same_hemisphere(wo, wi) ? m->reflectance * SR_INV_PI : SR_BLACK;
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self;
    (void)mode;
    return sr_same_hemisphere(wo, wi) ? fabsf(wi.z) * SR_INV_PI : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_diffuse *m = self;
    (void)u_lobe;
    (void)mode;
    sr_vec3 wi = sr_warp_cosine_hemisphere(u);
    wi.z = copysignf(wi.z, wo.z);
    *s = (struct sr_bsdf_sample){.wi = wi,
                                 .f = m->reflectance * SR_INV_PI,
                                 .pdf = fabsf(wi.z) * SR_INV_PI,
                                 .eta = 1,
                                 .lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE};
    return s->pdf > 0 && wo.z != 0 && lobes(self);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sr_bsdf_diffuse *m = self;
    (void)wo;
    return m->reflectance;
}

const struct sr_bsdf_model sr_bsdf_diffuse = {
    .name = "diffuse",
    .title = "Lambert",
    .source = "J. H. Lambert, Photometria, 1760",
    .params = params,
    .size = sizeof(struct sr_bsdf_diffuse),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
};
