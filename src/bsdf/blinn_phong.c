/* SPDX-License-Identifier: MIT */
/* Blinn's highlight about the half vector h, as plastic has it, over a Lambert surface.
 *
 *     f = reflectance / pi + specular N (n.h)^exponent   [1/sr],    h = (wo + wi) / |wo + wi|
 *     N = (e + 2)(e + 4) / (8 pi (2^(-e/2) + e)), e = exponent: all that arrives along the normal leaves,
 *         E(0) = specular
 *     N = (e + 8) / (8 pi): the usual fit to it, up to 7.5 % too bright
 *     pdf = p_d cos_theta_i / pi + p_s (e + 1) / (2 pi) (n.h)^e / (4 wo.h)   [1/sr]
 *
 * (e + 2) / (2 pi), also found, makes (n.h)^e a distribution of microfacets; it is no constant for a lobe that stands
 * alone. J. F. Blinn, Models of light reflection, 1977; the exact N: P.-P. Sloan, in Akenine-Moeller et al., Real-Time
 * Rendering, 2008. Limits: no Fresnel; the highlight fades to grazing where real ones grow. */
#include "bsdf/hemisphere.h"

struct blinn_phong {
    sr_spectrum reflectance, specular;
    float exponent;
    int32_t normalisation;
    float N, diffuse_share; // by ready: [1/sr], [1] of the samples
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.4, offsetof(struct blinn_phong, reflectance),
     "share of light that the matte part reflects"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.4, offsetof(struct blinn_phong, specular),
     "share that the highlight reflects at normal incidence; the two together not above 1"},
    {SR_PARAM_FLOAT, "exponent", "1", 0, 1e5, 50, offsetof(struct blinn_phong, exponent), "sharpness of the highlight"},
    {SR_PARAM_ENUM, "normalisation", "", 0, 1, 0, offsetof(struct blinn_phong, normalisation), "exact|energy_plus_8"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct blinn_phong *m = self;
    float n = m->exponent, d = sr_spectrum_mean(m->reflectance), s = sr_spectrum_mean(m->specular);
    (void)at;
    m->N = m->normalisation == 0 ? (n + 2) * (n + 4) / (8 * SR_PI * (expf(-0.5f * logf(2.0f) * n) + n))
                                 : (n + 8) / (8 * SR_PI);
    m->diffuse_share = d > 0 ? d / (d + s) : 0;
}

static uint32_t lobes(const void *self)
{
    const struct blinn_phong *m = self;
    uint32_t kind = (sr_spectrum_is_black(m->reflectance) ? 0u : SR_LOBE_DIFFUSE) |
                    (sr_spectrum_is_black(m->specular) ? 0u : SR_LOBE_GLOSSY);
    return kind ? SR_LOBE_REFLECTION | kind : 0;
}

/* (n.h)^exponent, and wo.h; wo and wi above the surface */
static float highlight(const struct blinn_phong *m, sr_vec3 wo, sr_vec3 wi, float *cos_h)
{
    sr_vec3 h = sr_add(wo, wi);
    *cos_h = 0.5f * sr_length(h);
    return *cos_h > 1e-10f ? power_of_cos(sin2_theta(h), h.z * h.z, m->exponent) : 0;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct blinn_phong *m = self;
    float cos_h;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    return m->reflectance * SR_INV_PI + m->specular * (m->N * highlight(m, wo, wi, &cos_h));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct blinn_phong *m = self;
    (void)mode;
    if (!lobes(m) || !upper(&wo, &wi))
        return 0;
    float cos_h, power = highlight(m, wo, wi, &cos_h);
    return m->diffuse_share * wi.z * SR_INV_PI +
           (power > 0 ? (1 - m->diffuse_share) * pdf_power_of_cos(power, m->exponent) / (4 * cos_h) : 0);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct blinn_phong *m = self;
    if (u_lobe < m->diffuse_share)
        return finish(&sr_bsdf_blinn_phong, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    sr_vec3 up = {wo.x, wo.y, fabsf(wo.z)}, h = draw_power_of_cos((sr_vec3){0, 0, 1}, m->exponent, u);
    return sr_dot(up, h) > 0 && finish(&sr_bsdf_blinn_phong, self, wo, sr_reflect(up, h), SR_LOBE_GLOSSY, mode, s);
}

const struct sr_bsdf_model sr_bsdf_blinn_phong = {
    .name = "blinn_phong",
    .title = "Blinn-Phong",
    .source = "J. F. Blinn, Models of light reflection for computer synthesized pictures, 1977",
    .limits = "No Fresnel: the highlight fades to grazing, where real ones grow.",
    .params = params,
    .size = sizeof(struct blinn_phong),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .largest_albedo = 1.0753f, // of energy_plus_8, at normal incidence and exponent 8.8
};
