/* SPDX-License-Identifier: MIT */
/* Regolith: grains that scatter by a phase law, isotropic multiple scattering, the surge of brightness at opposition,
 * and relief that shadows itself, as planetary science fits it to moons and asteroids.
 *
 *     f = w / (4 pi) mu_ie / (mu_ie + mu_oe) ((1 + B(a)) p(a) + H(mu_ie) H(mu_oe) - 1) (1 + C(a)) S / mu_i   [1/sr]
 *     p = (1 + c)/2 HG(-b) + (1 - c)/2 HG(b),  HG(g) = (1 - g^2) / (1 + 2 g cos a + g^2)^(3/2);
 *         or 1 + b cos a + c (3 cos^2 a - 1)/2
 *     B = B0 / (1 + tan(a/2) / h)            shadow hiding
 *     C = C0 (1 + (1 - exp(-y)) / y) / (2 (1 + y)^2),  y = tan(a/2) / hc            coherent backscatter
 *     H(x) = 1 / (1 - w x (r0 + (1 - 2 r0 x)/2 ln((1 + x)/x))),  r0 = (1 - sqrt(1 - w)) / (1 + sqrt(1 - w))   (2002)
 *     H(x) = (1 + 2 x) / (1 + 2 x sqrt(1 - w))                                                          (1981)
 *
 * a is the phase angle (cos a = wi.wo; 0: light from behind the viewer), w the albedo of a grain; mu_ie, mu_oe and S
 * are the effective cosines and the shadowing of slopes whose mean angle is theta_bar (Hapke 1984), mu_i, mu_o and 1
 * where it is 0. Hapke's own r is f mu_i; papers print I/F = pi r. Authors differ in the sign of c: here c > 0 sends
 * light back. B. Hapke, Bidirectional reflectance spectroscopy 1 (1981), 3 (1984), 5 (2002); Theory of Reflectance,
 * 2012, with K = 1. Limits: H is within 4 % (1981) or 1 % (2002) of Chandrasekhar's; multiple scattering is taken as
 * isotropic, so that bright grains with a strong backward lobe or surge return more light than arrives. */
#include "bsdf/hemisphere.h"

struct hapke {
    sr_spectrum albedo;
    float b, c, surge, surge_width, coherent, coherent_width, theta_bar;
    int32_t phase, version;
    // by ready
    sr_spectrum gamma, r0;
    float tangent, X; // of theta_bar; 0, 1: smooth
    float backward;   // share of the samples about wo
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "albedo", "1", 0, 1, 0.3, offsetof(struct hapke, albedo), "share of light that a grain scatters"},
    {SR_PARAM_FLOAT, "b", "1", -0.8, 0.8, 0.3, offsetof(struct hapke, b),
     "narrowness of the grains' two lobes; in Legendre's form the factor of cos a"},
    {SR_PARAM_FLOAT, "c", "1", -1, 1, 0.4, offsetof(struct hapke, c),
     "1: all in the backward lobe, -1: in the forward one; in Legendre's form the factor of (3 cos^2 a - 1) / 2"},
    {SR_PARAM_FLOAT, "surge", "1", 0, 1, 1, offsetof(struct hapke, surge), "B0, height of the shadow-hiding surge"},
    {SR_PARAM_FLOAT, "surge_width", "1", 0.005, 1, 0.06, offsetof(struct hapke, surge_width),
     "h, half its half width [rad]"},
    {SR_PARAM_FLOAT, "coherent", "1", 0, 1, 0, offsetof(struct hapke, coherent), "C0, height of the coherent surge"},
    {SR_PARAM_FLOAT, "coherent_width", "1", 0.005, 1, 0.01, offsetof(struct hapke, coherent_width), "hc, its width"},
    {SR_PARAM_FLOAT, "theta_bar", "deg", 0, 45, 0, offsetof(struct hapke, theta_bar), "mean slope of the relief"},
    {SR_PARAM_ENUM, "phase", "", 0, 1, 0, offsetof(struct hapke, phase), "henyey_greenstein|legendre"},
    {SR_PARAM_ENUM, "version", "", 0, 1, 0, offsetof(struct hapke, version), "2002|1981"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct hapke *m = self;
    (void)at;
    m->gamma = sr_spectrum_sqrt(1 - m->albedo);
    m->r0 = (1 - m->gamma) / (1 + m->gamma);
    m->tangent = m->theta_bar >= 0.1f ? tanf(sr_radians(m->theta_bar)) : 0;
    m->X = 1 / sqrtf(1 + SR_PI * m->tangent * m->tangent);
    m->backward = m->phase == 0 ? 0.25f * (1 + (m->b < 0 ? -m->c : m->c)) : 0;
}

static uint32_t lobes(const void *self)
{
    const struct hapke *m = self;
    return sr_spectrum_is_black(m->albedo) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum H(const struct hapke *m, float x)
{
    if (m->version == 1)
        return (1 + 2 * x) / (1 + 2 * x * m->gamma);
    float half_log = 0.5f * log1pf(1 / sr_max(x, 1e-20f));
    return 1 / (1 - m->albedo * x * (m->r0 + (1 - 2 * m->r0 * x) * half_log));
}

struct relief {   // of one direction
    float F1, F2; // 1 - E1, 1 - E2 of Hapke's: small near grazing
    float eta;    // effective cosine without the other direction
};
static struct relief relief_of(const struct hapke *m, sr_vec3 w)
{
    float s = sqrtf(sin2_theta(w)), x = w.z / (SR_PI * m->tangent * sr_max(s, 1e-10f)); // cot theta_bar cot theta / pi
    struct relief r = {.F1 = -expm1f(-2 * x), .F2 = -expm1f(-SR_PI * x * x)};
    r.eta = m->X * (w.z + s * m->tangent * (1 - r.F2) / (1 + r.F1));
    return r;
}

/* The effective cosines, and S mu_ie / mu_i. Told for the direction nearer to the normal (u) and the other one (v), so
 * that nothing changes when wo and wi are exchanged. psi = azimuth between them. */
static float shadow(const struct hapke *m, sr_vec3 wo, sr_vec3 wi, float *cos_o, float *cos_i)
{
    bool swapped = wi.z < wo.z;
    sr_vec3 u = swapped ? wo : wi, v = swapped ? wi : wo;
    struct relief a = relief_of(m, u), b = relief_of(m, v);
    float su = sqrtf(sin2_theta(u)), sv = sqrtf(sin2_theta(v)), sines = su * sv;
    float cos_psi = sines > 0 ? sr_clamp((u.x * v.x + u.y * v.y) / sines, -1, 1) : 1;
    float sin_psi = sines > 0 ? sr_min(fabsf(u.x * v.y - u.y * v.x) / sines, 1) : 0;
    float turn = sr_min(atan2f(sin_psi, cos_psi) * SR_INV_PI, 1), far = 0.5f * (1 - cos_psi),
          near = 0.5f * (1 + cos_psi);
    float beyond = near > 0 ? expf(-sin_psi / near) : 0; // exp(-2 tan(psi / 2))
    float K = sr_max(b.F1 + (1 - turn) + turn * a.F1, 1e-12f);
    float ue = m->X * (u.z + su * m->tangent * (near - cos_psi * b.F2 - far * a.F2) / K);
    float ve = m->X * (v.z + sv * m->tangent * (near - b.F2 + far * a.F2) / K);
    ue = sr_max(ue, 1e-3f * u.z); // rounding, where both graze from opposite sides
    ve = sr_max(ve, 1e-3f * v.z);
    *cos_o = swapped ? ue : ve;
    *cos_i = swapped ? ve : ue;
    return (ue / a.eta) * (ve / b.eta) * m->X / (1 - beyond + beyond * m->X * u.z / a.eta);
}

static float phase(const struct hapke *m, float cos_a)
{
    if (m->phase == 1)
        return sr_max(0, 1 + m->b * cos_a + m->c * (1.5f * cos_a * cos_a - 0.5f));
    return 0.5f * ((1 + m->c) * henyey_greenstein(cos_a, -m->b) + (1 - m->c) * henyey_greenstein(cos_a, m->b));
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct hapke *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float cos_o = wo.z, cos_i = wi.z, shadowed = 1; // S mu_ie / mu_i
    if (m->tangent > 0)
        shadowed = shadow(m, wo, wi, &cos_o, &cos_i);

    float half_tangent = sr_length(sr_sub(wo, wi)) / sr_max(sr_length(sr_add(wo, wi)), 1e-10f); // tan(a / 2)
    float B = m->surge / (1 + half_tangent / m->surge_width), C = 0;
    if (m->coherent > 0) {
        float y = half_tangent / m->coherent_width;
        C = m->coherent * (1 + (y > 1e-6f ? -expm1f(-y) / y : 1)) / (2 * sr_sqr(1 + y));
    }
    sr_spectrum once_and_more = (1 + B) * phase(m, sr_dot(wo, wi)) + (H(m, cos_i) * H(m, cos_o) - 1);
    return m->albedo * once_and_more * (SR_INV_PI / 4 * shadowed * (1 + C) / (cos_i + cos_o));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct hapke *m = self;
    (void)mode;
    if (!lobes(m) || !upper(&wo, &wi))
        return 0;
    float p = (1 - m->backward) * pdf_half_cosine(wi.z);
    if (m->backward > 0)
        p += m->backward * SR_INV_PI / 4 * henyey_greenstein(sr_dot(wo, wi), -fabsf(m->b));
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct hapke *m = self;
    if (u_lobe >= m->backward)
        return finish(&sr_bsdf_hapke, self, wo, draw_half_cosine(u), SR_LOBE_DIFFUSE, mode, s);
    float g = fabsf(m->b), k = 1 + g - 2 * g * u.x;                               // Henyey & Greenstein's lobe about wo
    float less = sr_clamp((1 - g) * (1 - g) * u.x / k * ((1 + g) / k + 1), 0, 2); // 1 - cos of the angle to it
    sr_vec3 up = {wo.x, wo.y, fabsf(wo.z)};
    return finish(&sr_bsdf_hapke, self, wo, about(up, sr_safe_sqrt(less * (2 - less)), 1 - less, u.y), SR_LOBE_DIFFUSE,
                  mode, s);
}

const struct sr_bsdf_model sr_bsdf_hapke = {
    .name = "hapke",
    .title = "Hapke, with opposition surge and roughness",
    .source = "B. Hapke, Bidirectional reflectance spectroscopy, 1981, 1984 and 2002",
    .limits =
        "Multiple scattering is isotropic and H approximate: bright grains with strong lobes break the energy law.",
    .params = params,
    .size = sizeof(struct hapke),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .largest_albedo = 2.71f, // along the normal: albedo, c, both surges and their widths 1, b 0.8
};
