/* SPDX-License-Identifier: MIT */
/* Paint to metal by words an artist knows: smooth, metallic, transparent, of a colour.
 *
 *     a = 2 theta_i / pi, b = 2 theta_o / pi;
 *         light comes from i and is seen from o; s, m, t = smoothness, metalness, transparency
 *     F(x) = (1/(x - 1.12)^2 - 1/1.12^2) / (1/0.12^2 - 1/1.12^2),
 *         G(x) = (1/0.01^2 - 1/(x - 1.01)^2) / (1/0.01^2 - 1/1.01^2)
 *     rd = (1 - s^3)(1 - t),   rn = (1 - t) - rd,   rj = min(1, rn + (rn + 0.1) F(a) G(a) G(b)),   e = 3 / (1 - s)
 *     f = (1 - m s) rd C / pi + rj (1 + m (1 - F(a))(C - 1)) (e + 1) / (2 pi) max(0, r.wi)^e / cos_theta_i   [1/sr]
 *
 * C = reflectance, r the mirror of wo. P. S. Strauss, A realistic lighting model for computer animators, 1990, is a
 * formula for shading: the factors 1 / pi and (e + 1) / (2 pi), which it lacks, make a BRDF of it. F and G imitate
 * Fresnel's law and shadowing. Limits: not reciprocal, because light's angle enters where the viewer's does not; more
 * light leaves than arrives near grazing, without bound as 1 / cos_theta_i (here down to 1e-5). Light paths see f with
 * both directions exchanged, so that all estimators agree. */
#include "bsdf/hemisphere.h"

struct strauss {
    sr_spectrum reflectance;
    float smoothness, metalness, transparency;
    float rd, rn, diffuse, exponent, diffuse_share; // by ready; diffuse = (1 - m s) rd
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct strauss, reflectance), "C, the colour"},
    {SR_PARAM_FLOAT, "smoothness", "1", 0, 0.97, 0.6, offsetof(struct strauss, smoothness), "0: matte, 1: a mirror"},
    {SR_PARAM_FLOAT, "metalness", "1", 0, 1, 0.5, offsetof(struct strauss, metalness),
     "whether the highlight has the colour"},
    {SR_PARAM_FLOAT, "transparency", "1", 0, 1, 0, offsetof(struct strauss, transparency),
     "share of light that the surface lets through (and that is lost here)"},
    {0},
};

#define LEAST_COSINE 1e-5f // of the light, to divide by

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct strauss *m = self;
    float s = m->smoothness;
    (void)at;
    m->rd = (1 - s * s * s) * (1 - m->transparency);
    m->rn = 1 - m->transparency - m->rd;
    m->diffuse = (1 - m->metalness * s) * m->rd;
    m->exponent = 3 / (1 - s);
    float d = sr_spectrum_mean(m->reflectance) * m->diffuse;
    m->diffuse_share = sr_clamp(d / (d + m->rn + 0.1f), 0.1f, 0.9f);
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY;
}

static float angle(sr_vec3 w) // 2 theta / pi
{
    return 2 * SR_INV_PI * atan2f(sqrtf(sin2_theta(w)), w.z);
}
static float fresnel_like(float x)
{
    const float k = 1.12f, k0 = 1 / (k * k), k1 = 1 / ((1 - k) * (1 - k));
    return (1 / sr_sqr(x - k) - k0) / (k1 - k0);
}
static float shadow_like(float x)
{
    const float k = 1.01f, k0 = 1 / (k * k), k1 = 1 / ((1 - k) * (1 - k));
    return sr_max(0, (k1 - 1 / sr_sqr(x - k)) / (k1 - k0));
}

static float highlight(const struct strauss *m, sr_vec3 wo, sr_vec3 wi)
{
    sr_vec3 r = {-wo.x, -wo.y, wo.z};
    float c = sr_dot(r, wi);
    return c > 0 ? power_of_cos(sr_length2(sr_cross(r, wi)), c * c, m->exponent) : 0;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct strauss *m = self;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    sr_vec3 light = mode == SR_RADIANCE ? wi : wo, view = mode == SR_RADIANCE ? wo : wi;
    sr_spectrum value = m->reflectance * (m->diffuse * SR_INV_PI);
    float power = highlight(m, wo, wi);
    if (!(power > 0))
        return value;
    float a = angle(light), F = fresnel_like(a);
    float rj = sr_min(1, m->rn + (m->rn + 0.1f) * F * shadow_like(a) * shadow_like(angle(view)));
    sr_spectrum colour = 1 + m->metalness * (1 - F) * (m->reflectance - 1);
    return value + colour * (rj * (m->exponent + 1) * 0.5f * SR_INV_PI * power / sr_max(light.z, LEAST_COSINE));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct strauss *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return 0;
    return m->diffuse_share * wi.z * SR_INV_PI +
           (1 - m->diffuse_share) * pdf_power_of_cos(highlight(m, wo, wi), m->exponent);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct strauss *m = self;
    if (u_lobe < m->diffuse_share)
        return finish(&sr_bsdf_strauss, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    sr_vec3 wi = draw_power_of_cos((sr_vec3){-wo.x, -wo.y, fabsf(wo.z)}, m->exponent, u);
    return finish(&sr_bsdf_strauss, self, wo, wi, SR_LOBE_GLOSSY, mode, s);
}

const struct sr_bsdf_model sr_bsdf_strauss = {
    .name = "strauss",
    .title = "Strauss",
    .source = "P. S. Strauss, A realistic lighting model for computer animators, 1990",
    .limits = "Not reciprocal, and no bound to its energy near grazing.",
    .params = params,
    .size = sizeof(struct strauss),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .asymmetry = 1,
    .largest_albedo = 5300, // of light that grazes by less than LEAST_COSINE
};
