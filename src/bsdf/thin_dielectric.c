/* SPDX-License-Identifier: MIT */
/* A window pane: two smooth parallel boundaries, seen as one surface; light goes straight through or is mirrored.
 *
 *     R = [ 2 Rs / (1 + Rs) + 2 Rp / (1 + Rp) ] / 2,    T = 1 - R    [1]
 *
 * with Fresnel's reflectances Rs and Rp of one boundary for the two polarisations: all bounces inside, incoherent, each
 * polarisation by itself, for it stays what it is from bounce to bounce (Stokes 1862). sums_as_pbrt puts the mean of Rs
 * and Rp in the place of both: T of n = 1.52 is then too small by 0.003 at 45 deg and 0.013 at 60. Nothing is absorbed.
 */
#include "bsdf/microfacet.h"

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "eta", "1", 0.25, 4, 1.5, offsetof(struct sr_bsdf_thin_dielectric, eta),
     "index of refraction of the pane"},
    {0},
};

// reflectance of the pane, with cos_i on its outside
static float pane(float cos_i, float eta, bool sums_as_pbrt)
{
    cos_i = cos_i < 1 ? cos_i : 1;
    float g2 = (eta - 1) * (eta + 1) + cos_i * cos_i; // (eta cos_t)^2
    if (!(g2 > 0))
        return 1;
    float g = sqrtf(g2), dense = eta * eta * cos_i;
    float r_p = sr_sqr((dense - g) / (dense + g)), r_s = sr_sqr((cos_i - g) / (cos_i + g));
    if (sums_as_pbrt)
        r_p = r_s = (r_p + r_s) * 0.5f;
    return r_p / (1 + r_p) + r_s / (1 + r_s);
}

static uint32_t lobes(const void *self)
{
    const struct sr_bsdf_thin_dielectric *m = self;
    return SR_LOBE_TRANSMISSION | SR_LOBE_SPECULAR | (m->eta == 1 ? 0 : SR_LOBE_REFLECTION);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self;
    (void)wo;
    (void)wi;
    (void)mode;
    return SR_BLACK; // two delta functions
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self;
    (void)wo;
    (void)wi;
    (void)mode;
    return 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_thin_dielectric *m = self;
    (void)u;
    (void)mode;
    if (wo.z == 0)
        return false;
    float R = pane(fabsf(wo.z), m->eta, m->sums_as_pbrt);
    bool reflects = u_lobe < R;
    float share = reflects ? R : 1 - R;
    *s = (struct sr_bsdf_sample){.wi = reflects ? (sr_vec3){-wo.x, -wo.y, wo.z} : sr_neg(wo),
                                 .f = SR_BLACK + share / fabsf(wo.z),
                                 .pdf = share,
                                 .eta = 1,
                                 .lobe = (reflects ? SR_LOBE_REFLECTION : SR_LOBE_TRANSMISSION) | SR_LOBE_SPECULAR};
    return share > 0;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    (void)self;
    (void)wo;
    return SR_ONE;
}

const struct sr_bsdf_model sr_bsdf_thin_dielectric = {
    .name = "thin_dielectric",
    .title = "Pane of clear glass",
    .source =
        "G. G. Stokes, On the intensity of the light reflected from or transmitted through a pile of plates, 1862",
    .limits = "no absorption, no displacement of the ray, no interference",
    .params = params,
    .size = sizeof(struct sr_bsdf_thin_dielectric),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
};
