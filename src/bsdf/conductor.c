/* SPDX-License-Identifier: MIT */
/* A metal: Fresnel's reflection with a complex index, from a mirror or from Trowbridge-Reitz microfacets.
 *
 *     f = F(|wo.m|) D(m) G(wo, wi) / (4 cos_theta_o cos_theta_i)   [1/sr],    m = (wo + wi) / |wo + wi|
 *     pdf = D(m) G1(wo) / (4 cos_theta_o)                          [1/sr]
 *
 * eta and k are relative to the outside. Torrance & Sparrow 1967; Cook & Torrance 1982; Walter et al. 2007.
 * A mirror (both alpha below 1e-3) is a delta function. Rough metals lose what scatters twice. */
#include "bsdf/microfacet.h"

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct sr_bsdf_conductor, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct sr_bsdf_conductor, k), "absorption index"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0, 1, 0, offsetof(struct sr_bsdf_conductor, ggx.alpha_x),
     "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0, 1, 0, offsetof(struct sr_bsdf_conductor, ggx.alpha_y), "slope width across it"},
    {0},
};

static uint32_t lobes(const void *self)
{
    const struct sr_bsdf_conductor *m = self;
    return SR_LOBE_REFLECTION | (ggx_is_smooth(m->ggx) ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct sr_bsdf_conductor *m = self;
    (void)mode;
    *p = 0;
    if (ggx_is_smooth(m->ggx))
        return SR_BLACK;
    float cos_m;
    float shape = ggx_reflection(ggx_usable(m->ggx), wo, wi, p, &cos_m);
    return shape > 0 ? conductor_fresnel(cos_m, m->eta, m->k) * shape : SR_BLACK;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_conductor.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_conductor.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_conductor *m = self;
    (void)u_lobe;
    (void)mode;
    if (wo.z == 0)
        return false;
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = lobes(self)};
    if (ggx_is_smooth(m->ggx)) {
        s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
        s->pdf = 1;
        s->f = conductor_fresnel(fabsf(wo.z), m->eta, m->k) / fabsf(wo.z);
        return true;
    }
    float weight, cos_m;
    if (!ggx_sample_reflection(ggx_usable(m->ggx), wo, u, &s->wi, &weight, &s->pdf, &cos_m))
        return false;
    s->f = conductor_fresnel(cos_m, m->eta, m->k) * (weight * s->pdf / fabsf(s->wi.z));
    return true;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sr_bsdf_conductor *m = self;
    return ggx_is_smooth(m->ggx) ? conductor_fresnel(fabsf(wo.z), m->eta, m->k) : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_conductor = {
    .name = "conductor",
    .title = "Metal: mirror or GGX microfacets",
    .source = "B. Walter et al., Microfacet models for refraction, 2007; E. Heitz, Understanding the masking-shadowing "
              "function, 2014",
    .limits = "light that meets two facets is lost: a rough metal is too dark, at alpha = 1 by up to two thirds",
    .params = params,
    .size = sizeof(struct sr_bsdf_conductor),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
