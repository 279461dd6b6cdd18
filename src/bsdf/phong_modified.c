/* SPDX-License-Identifier: MIT */
/* Phong's highlight about the mirror direction r, made reciprocal by leaving out the division by the cosine, over a
 * Lambert surface.
 *
 *     f   = reflectance / pi + specular (n + 2) / (2 pi) max(0, r.wi)^n   [1/sr],    n = exponent
 *     pdf = p_d cos_theta_i / pi + p_s (n + 1) / (2 pi) max(0, r.wi)^n   [1/sr]
 *
 * E(0) = specular (+ reflectance); while the whole lobe is above the surface, E_specular = specular cos_theta_o.
 * B. T. Phong 1975; R. Lewis, Making shaders more physically plausible, 1993; E. Lafortune & Y. Willems, Using the
 * modified Phong reflectance model for physically based rendering, 1994. Limits: the highlight darkens to grazing,
 * where real ones grow brighter. */
#include "bsdf/hemisphere.h"

struct phong_modified {
    sr_spectrum reflectance, specular;
    float exponent;
    float diffuse_share; // by ready
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0, offsetof(struct phong_modified, reflectance),
     "share of light that the matte part reflects"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.5, offsetof(struct phong_modified, specular),
     "share that the highlight reflects at normal incidence; the two together not above 1"},
    {SR_PARAM_FLOAT, "exponent", "1", 0, 1e5, 20, offsetof(struct phong_modified, exponent),
     "sharpness of the highlight"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct phong_modified *m = self;
    float d = sr_spectrum_mean(m->reflectance), s = sr_spectrum_mean(m->specular);
    (void)at;
    m->diffuse_share = d > 0 ? d / (d + s) : 0;
}

static uint32_t lobes(const void *self)
{
    const struct phong_modified *m = self;
    uint32_t kind = (sr_spectrum_is_black(m->reflectance) ? 0u : SR_LOBE_DIFFUSE) |
                    (sr_spectrum_is_black(m->specular) ? 0u : SR_LOBE_GLOSSY);
    return kind ? SR_LOBE_REFLECTION | kind : 0;
}

static float highlight(const struct phong_modified *m, sr_vec3 wo, sr_vec3 wi)
{
    sr_vec3 mirror = {-wo.x, -wo.y, wo.z};
    float c = sr_dot(mirror, wi);
    return c > 0 ? power_of_cos(sr_length2(sr_cross(mirror, wi)), c * c, m->exponent) : 0;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct phong_modified *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    return m->reflectance * SR_INV_PI + m->specular * ((m->exponent + 2) * 0.5f * SR_INV_PI * highlight(m, wo, wi));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct phong_modified *m = self;
    (void)mode;
    if (!lobes(m) || !upper(&wo, &wi))
        return 0;
    return m->diffuse_share * wi.z * SR_INV_PI +
           (1 - m->diffuse_share) * pdf_power_of_cos(highlight(m, wo, wi), m->exponent);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct phong_modified *m = self;
    if (u_lobe < m->diffuse_share)
        return finish(&sr_bsdf_phong_modified, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    sr_vec3 wi = draw_power_of_cos((sr_vec3){-wo.x, -wo.y, fabsf(wo.z)}, m->exponent, u);
    return finish(&sr_bsdf_phong_modified, self, wo, wi, SR_LOBE_GLOSSY, mode, s);
}

const struct sr_bsdf_model sr_bsdf_phong_modified = {
    .name = "phong_modified",
    .title = "Modified Phong",
    .source =
        "E. Lafortune & Y. Willems, Using the modified Phong reflectance model for physically based rendering, 1994",
    .limits = "The highlight darkens to grazing, where real ones grow brighter.",
    .params = params,
    .size = sizeof(struct phong_modified),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
};
