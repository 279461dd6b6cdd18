/* SPDX-License-Identifier: MIT */
/* A rough matte surface: V-shaped grooves whose walls are Lambert's, with Gaussian slopes; it looks flat where
 * Lambert's ball is shaded, because the walls that face the light are seen too.
 *
 *     a = max(theta_i, theta_o), b = min(theta_i, theta_o), p = cos(phi_i - phi_o), s = sigma   [rad]
 *     qualitative: f = rho / pi (1 - s^2 / (2 s^2 + 0.66) + C2 max(0, p) sin a tan b),  C2 = 0.45 s^2 / (s^2 + 0.09)
 *         [1/sr]
 *     full:        f = rho / pi (1 - s^2 / (2 s^2 + 0.66) + p C2 B tan b + (1 - |p|) C3 tan((a + b) / 2))
 *                      + 0.17 rho^2 / pi s^2 / (s^2 + 0.13) (1 - p (2 b / pi)^2)
 *                  B = sin a, less (2 b / pi)^3 where p < 0;   C3 = s^2 / (8 s^2 + 0.72) (4 a b / pi^2)^2
 *     qualitative: E = rho (A + 2 C2 / pi (sin t (t / 2 - sin 2t / 4) + tan t (1 - sin^3 t) / 3)),  t = theta_o
 *
 * M. Oren & S. K. Nayar, Generalization of Lambert's reflectance model, 1994. Limits: both forms are fits to the
 * integrals over the grooves, and lose light as sigma grows, the qualitative one because it leaves out what walls cast
 * on each other. The full one returns up to 5 % more than arrives near grazing (rho = 1, sigma = 0.3), and opposite the
 * light at grazing angles its fit falls below 0 for sigma > 0.6: it is 0 there. */
#include "bsdf/clipped_ltc.h"

struct oren_nayar {
    sr_spectrum reflectance;
    float sigma;
    int32_t variant;
    float C1, C2, C3, L2, r; // by ready; r: roughness for drawing
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct oren_nayar, reflectance),
     "share of light that a wall reflects"},
    {SR_PARAM_FLOAT, "sigma", "rad", 0, 0.785, 0.35, offsetof(struct oren_nayar, sigma),
     "standard deviation of the walls' slope angle"},
    {SR_PARAM_ENUM, "variant", "", 0, 1, 0, offsetof(struct oren_nayar, variant), "full|qualitative"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct oren_nayar *m = self;
    float s2 = m->sigma * m->sigma;
    (void)at;
    m->C1 = 1 - 0.5f * s2 / (s2 + 0.33f);
    m->C2 = 0.45f * s2 / (s2 + 0.09f);
    m->C3 = 0.125f * s2 / (s2 + 0.09f);
    m->L2 = 0.17f * s2 / (s2 + 0.13f);
    m->r = m->C2 / m->C1;
}

static uint32_t lobes(const void *self)
{
    const struct oren_nayar *m = self;
    return sr_spectrum_is_black(m->reflectance) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct oren_nayar *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float sin_o = sqrtf(sin2_theta(wo)), sin_i = sqrtf(sin2_theta(wi)), sines = sin_o * sin_i;
    float dot = wo.x * wi.x + wo.y * wi.y; // sin_o sin_i p
    float cos_a = sr_min(wo.z, wi.z), cos_b = sr_max(wo.z, wi.z);
    if (m->variant == 1)
        return m->reflectance * (SR_INV_PI * (m->C1 + m->C2 * sr_max(dot, 0) / cos_b));

    float p = sines > 0 ? sr_clamp(dot / sines, -1, 1) : 1;
    float sin_a = sr_max(sin_o, sin_i), sin_b = sr_min(sin_o, sin_i);
    float a = atan2f(sin_a, cos_a), b = atan2f(sin_b, cos_b), x = 2 / SR_PI * b;
    float groove = sin_a;
    if (p < 0) { // sin a - x^3; near grazing by the complements of both, because tan b magnifies what is left
        float c = 2 / SR_PI * atan2f(cos_b, sin_b);
        groove = b > 0.7f ? c * (3 - c * (3 - c)) - cos_a * cos_a / (1 + sin_a) : sin_a - x * x * x;
    }
    float C3 = m->C3 * sr_sqr(4 / (SR_PI * SR_PI) * a * b);
    float L1 = m->C1 + m->C2 * p * groove * (sin_b / cos_b) + (1 - fabsf(p)) * C3 * (sin_a + sin_b) / (cos_a + cos_b);
    sr_spectrum rho = m->reflectance,
                value = rho * (SR_INV_PI * L1) + rho * rho * (SR_INV_PI * m->L2 * (1 - p * x * x));
    return L1 < 0 ? sr_spectrum_clamp(value, 0, INFINITY) : value;
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct oren_nayar *m = self;
    (void)mode;
    if (!lobes(m) || !upper(&wo, &wi))
        return 0;
    struct clipped_ltc t = clipped_ltc_of(wo, m->r);
    return clipped_ltc_pdf(&t, wi);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct oren_nayar *m = self;
    struct clipped_ltc t = clipped_ltc_of((sr_vec3){wo.x, wo.y, fabsf(wo.z)}, m->r);
    return finish(&sr_bsdf_oren_nayar, self, wo, clipped_ltc_draw(&t, u_lobe, u), SR_LOBE_DIFFUSE, mode, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct oren_nayar *m = self;
    float c = sr_abs_cos_theta(wo), s = sqrtf(sin2_theta(wo)), t = atan2f(s, c);
    if (m->variant == 0)
        return SR_BLACK + NAN;
    float third = s * c * (1 + s + s * s) / (3 * (1 + s)); // tan t (1 - sin^3 t) / 3
    return m->reflectance * (m->C1 + 2 * m->C2 / SR_PI * (s * (t - s * c) / 2 + third));
}

const struct sr_bsdf_model sr_bsdf_oren_nayar = {
    .name = "oren_nayar",
    .title = "Oren-Nayar",
    .source = "M. Oren & S. K. Nayar, Generalization of Lambert's reflectance model, 1994",
    .limits = "Fits to single and double scattering in grooves: loses light as sigma grows, and makes 5 % at grazing.",
    .params = params,
    .size = sizeof(struct oren_nayar),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
    .largest_albedo = 1.052f, // full, toward grazing: reflectance 1, sigma 0.3
};
