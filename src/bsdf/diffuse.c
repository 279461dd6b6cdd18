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
    return sr_diffuse_lobes(self);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    float unused;
    return sr_diffuse_f_pdf(self, wo, wi, &unused);
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    float density;
    sr_diffuse_f_pdf(self, wo, wi, &density);
    return density;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)u_lobe;
    (void)mode;
    return sr_diffuse_sample(self, wo, u, s);
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
