/* SPDX-License-Identifier: MIT */
/* A generalised cosine lobe: a matrix turns the viewer into the axis of the highlight, so that it may be a mirror's,
 * lean away from the mirror direction, point back to the light, or be longer one way than the other.
 *
 *     f   = reflectance / pi + specular N max(0, c_x xo xi + c_y yo yi + c_z zo zi)^n   [1/sr],    n = exponent
 *     N   = (n + 2) / (2 pi max(|c_x|, |c_y|, |c_z|)^n), normalisation "unit": E_specular <= specular;  or 1, "none"
 *     pdf = p_d cos_theta_i / pi + p_s (n + 1) / (2 pi) cos^n of the angle to (c_x xo, c_y yo, c_z zo)   [1/sr]
 *
 * Both directions point away from the surface: the mirror is c_x = c_y = -1, c_z = 1, a retroreflector has all at 1.
 * Published fits use two or three lobes: a sum of models. E. Lafortune, S.-C. Foo, K. Torrance & D. Greenberg,
 * Non-linear approximation of reflectance functions, 1997. Limits: with normalisation "none", as published fits have
 * it, no law keeps the energy. */
#include "bsdf/hemisphere.h"

struct lafortune {
    sr_spectrum reflectance, specular;
    float c_x, c_y, c_z, exponent;
    int32_t normalisation;
    float N, largest2, diffuse_share; // by ready; largest2 = max(c^2)
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.3, offsetof(struct lafortune, reflectance),
     "share of light that the matte part reflects"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.3, offsetof(struct lafortune, specular), "height of the lobe"},
    {SR_PARAM_FLOAT, "c_x", "1", -1, 1, -1, offsetof(struct lafortune, c_x),
     "turns the lobe; -1: to the mirror, 1: back"},
    {SR_PARAM_FLOAT, "c_y", "1", -1, 1, -1, offsetof(struct lafortune, c_y), "the same across the tangent"},
    {SR_PARAM_FLOAT, "c_z", "1", -1, 1, 0.9, offsetof(struct lafortune, c_z),
     "below |c_x|: the lobe leans to the ground"},
    {SR_PARAM_FLOAT, "exponent", "1", 1, 1e4, 20, offsetof(struct lafortune, exponent), "sharpness of the lobe"},
    {SR_PARAM_ENUM, "normalisation", "", 0, 1, 0, offsetof(struct lafortune, normalisation), "unit|none"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct lafortune *m = self;
    float n = m->exponent;
    (void)at;
    m->largest2 = sr_max(m->c_x * m->c_x, sr_max(m->c_y * m->c_y, m->c_z * m->c_z));
    m->N = m->normalisation == 0 ? (n + 2) * 0.5f * SR_INV_PI : 1;
    float d = sr_spectrum_mean(m->reflectance), s = sr_spectrum_mean(m->specular) * m->N * 2 * SR_PI / (n + 2);
    if (m->normalisation == 1)
        s *= powf(m->largest2, 0.5f * n);
    bool is_glossy = !sr_spectrum_is_black(m->specular) && m->largest2 > 0;
    m->diffuse_share = d > 0 ? is_glossy ? sr_clamp(d / (d + s), 0.05f, 0.95f) : 1 : 0;
}

static uint32_t lobes(const void *self)
{
    const struct lafortune *m = self;
    uint32_t kind = (sr_spectrum_is_black(m->reflectance) ? 0u : SR_LOBE_DIFFUSE) |
                    (sr_spectrum_is_black(m->specular) || m->largest2 == 0 ? 0u : SR_LOBE_GLOSSY);
    return kind ? SR_LOBE_REFLECTION | kind : 0;
}

static sr_vec3 axis(const struct lafortune *m, sr_vec3 wo) // its length is part of f
{
    return (sr_vec3){m->c_x * wo.x, m->c_y * wo.y, m->c_z * wo.z};
}

/* cos^n of wi's angle to the axis; its logarithm before, for f */
static float lobe(const struct lafortune *m, sr_vec3 d, sr_vec3 wi, float *power)
{
    float c = sr_dot(d, wi), length2 = sr_length2(d);
    *power = c > 0 && length2 > 0 ? power_of_cos(sr_length2(sr_cross(d, wi)), c * c, m->exponent) : 0;
    if (!(*power > 0))
        return 0;
    float scale2 = m->normalisation == 0 ? length2 / m->largest2 : length2; // |d|^n, over the largest |c|^n
    return *power * expf(0.5f * m->exponent * logf(scale2));
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct lafortune *m = self;
    float power;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    return m->reflectance * SR_INV_PI + m->specular * (m->N * lobe(m, axis(m, wo), wi, &power));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct lafortune *m = self;
    (void)mode;
    if (!lobes(m) || !upper(&wo, &wi))
        return 0;
    float power;
    lobe(m, axis(m, wo), wi, &power);
    return m->diffuse_share * wi.z * SR_INV_PI + (1 - m->diffuse_share) * pdf_power_of_cos(power, m->exponent);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct lafortune *m = self;
    if (u_lobe < m->diffuse_share)
        return finish(&sr_bsdf_lafortune, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    sr_vec3 d = axis(m, (sr_vec3){wo.x, wo.y, fabsf(wo.z)});
    if (!(sr_length2(d) > 0))
        return false;
    return finish(&sr_bsdf_lafortune, self, wo, draw_power_of_cos(sr_normalize(d), m->exponent, u), SR_LOBE_GLOSSY,
                  mode, s);
}

const struct sr_bsdf_model sr_bsdf_lafortune = {
    .name = "lafortune",
    .title = "Lafortune's generalised cosine lobe",
    .source =
        "E. Lafortune, S.-C. Foo, K. Torrance & D. Greenberg, Non-linear approximation of reflectance functions, 1997",
    .limits = "Without normalisation, as published fits have it, no law keeps the energy.",
    .params = params,
    .size = sizeof(struct lafortune),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .largest_albedo = 2.1f, // 2 pi / 3: normalisation none, specular 1, exponent 1
};
