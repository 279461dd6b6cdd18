/* SPDX-License-Identifier: MIT */
/* A rough matte surface that keeps all light: Fujii's Oren-Nayar with what it loses scattered again.
 *
 *     s = wi.wo - cos_theta_i cos_theta_o,   t = max(cos_theta_i, cos_theta_o) where s > 0, else 1,
 *         A = 1 / (1 + (1/2 - 2/(3 pi)) r)
 *     f1 = rho / pi A (1 + r s / t)   [1/sr]: alone it is the variant "fon"
 *     E1(mu) = A (1 + r / pi (S (acos mu - S mu) + 2/3 (S / mu (1 - S^3) - S))),  S = sin theta;
 *         <E1> = A (1 + (2/3 - 28/(15 pi)) r)
 *     f  = f1 + rho2 / pi (1 - E1(mu_i)) (1 - E1(mu_o)) / (1 - <E1>),   rho2 = rho^2 <E1> / (1 - rho (1 - <E1>))
 *     E  = rho E1 + rho2 (1 - E1): 1 where rho = 1
 *
 * r = roughness; 0 is Lambert's surface. M. Fujii, 2012 ("fon"); J. Portsmouth, P. Kutz & S. Hill, EON: a practical
 * energy-preserving rough diffuse BRDF, 2024. Limits: saturation rises with roughness, as it does between real grooves.
 */
#include "bsdf/clipped_ltc.h"

struct eon {
    sr_spectrum reflectance;
    float roughness;
    int32_t variant;
    float A;           // by ready
    sr_spectrum rho2;  // by ready: that of f
    sr_spectrum again; // by ready: rho2 / (pi (1 - <E1>))
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct eon, reflectance),
     "share of light that the matter reflects"},
    {SR_PARAM_FLOAT, "roughness", "1", 0, 1, 0.5, offsetof(struct eon, roughness), "0: smooth, 1: roughest"},
    {SR_PARAM_ENUM, "variant", "", 0, 1, 0, offsetof(struct eon, variant), "eon|fon"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct eon *m = self;
    (void)at;
    float k1 = 0.5f - 2 / (3 * SR_PI), k2 = 2 / 3.0f - 28 / (15 * SR_PI);
    m->A = 1 / (1 + k1 * m->roughness);
    m->rho2 = m->again = SR_BLACK;
    float lost = (k1 - k2) * m->roughness * m->A; // 1 - <E1>
    if (m->variant == 1 || !(lost > 0))
        return;
    m->rho2 = m->reflectance * m->reflectance * ((1 - lost) / (1 - m->reflectance * lost));
    m->again = m->rho2 * (SR_INV_PI / lost);
}

static uint32_t lobes(const void *self)
{
    const struct eon *m = self;
    return sr_spectrum_is_black(m->reflectance) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

/* 1 - E1, by terms that vanish with r */
static float missing(const struct eon *m, sr_vec3 w)
{
    float S = sqrtf(sin2_theta(w)), mu = w.z;
    float G = S * (atan2f(S, mu) - S * mu) + (2 / 3.0f) * S * (mu * (1 + S + S * S) / (1 + S) - 1);
    return sr_max(0, m->roughness * m->A * (0.5f - 2 / (3 * SR_PI) - SR_INV_PI * G));
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct eon *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float s = wo.x * wi.x + wo.y * wi.y;
    float once = SR_INV_PI * m->A * sr_max(0, 1 + m->roughness * s / (s > 0 ? sr_max(wo.z, wi.z) : 1));
    if (m->variant == 1 || m->roughness == 0)
        return m->reflectance * once;
    return m->reflectance * once + m->again * (missing(m, wo) * missing(m, wi));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct eon *m = self;
    (void)mode;
    if (!lobes(m) || !upper(&wo, &wi))
        return 0;
    struct clipped_ltc t = clipped_ltc_of(wo, m->roughness);
    return clipped_ltc_pdf(&t, wi);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct eon *m = self;
    struct clipped_ltc t = clipped_ltc_of((sr_vec3){wo.x, wo.y, fabsf(wo.z)}, m->roughness);
    return finish(&sr_bsdf_eon, self, wo, clipped_ltc_draw(&t, u_lobe, u), SR_LOBE_DIFFUSE, mode, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct eon *m = self;
    float lost = missing(m, (sr_vec3){wo.x, wo.y, sr_abs_cos_theta(wo)});
    return m->reflectance * (1 - lost) + m->rho2 * lost;
}

const struct sr_bsdf_model sr_bsdf_eon = {
    .name = "eon",
    .title = "EON, energy-preserving Oren-Nayar",
    .source = "J. Portsmouth, P. Kutz & S. Hill, EON: a practical energy-preserving rough diffuse BRDF, 2024",
    .params = params,
    .size = sizeof(struct eon),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
};
