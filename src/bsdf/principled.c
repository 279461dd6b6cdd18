/* SPDX-License-Identifier: MIT */
/* Disney's BSDF of 2015: the surface of 2012 with a true index of refraction, glass, and a diffuse lobe in two parts.
 *
 *     wd = (1 - metallic)(1 - t),  wt = (1 - metallic) t,   t = specular_transmission
 *     above and below:  f = wd (C / pi ((1 - FL/2)(1 - FV/2) + R (FL + FV + FL FV (R - 1))) + sheen (1 - cd)^5 C_sheen)
 *                         + (metallic Fm + wd F(cd, eta) + wt F(cd, eta of this side)) D G / (4 ci co) + f_c     [1/sr]
 *     through:          f = wt sqrt(C) (1 - F) D G |wi.m| |wo.m| / (ci co (wi.m + wo.m / eta)^2)
 *         (over eta^2 for radiance)
 *     FL = (1 - ci)^5,  FV = (1 - co)^5,  R = 2 roughness cd^2,  Fm = C + (1 - C)(1 - cd)^5
 *     alpha_x = roughness^2 / a, alpha_y = roughness^2 a,
 *         a = sqrt(1 - 0.9 anisotropic), Trowbridge-Reitz, height-correlated
 *
 * with ci, co the cosines of wi and wo, cd = wo.m, m the half vector; f_c: clear coat and C_sheen as in disney.c. What
 * does not let light through looks the same from both sides; the glass (wt) is inside below. B. Burley, Extending the
 * Disney BRDF to a BSDF with Integrated Subsurface Scattering, 2015; Walter et al. 2007. The paper's thin surfaces and
 * its subsurface scattering are other models' work.
 *
 * Limits: reciprocal, but lobes are added without taking from each other: gains energy as disney.c does, less of it. */
#include "bsdf/burley.h"

struct principled {
    sr_spectrum reflectance;          // [1]
    sr_spectrum sheen_colour, filter; // [1] derived
    float metallic, roughness, anisotropic, eta, transmission, sheen, sheen_tint, clearcoat, clearcoat_gloss; // [1]
    struct sr_ggx ggx;                                                                                        // derived
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct principled, reflectance), "base colour"},
    {SR_PARAM_FLOAT, "metallic", "1", 0, 1, 0, offsetof(struct principled, metallic), "0: plastic or glass, 1: metal"},
    {SR_PARAM_FLOAT, "specular_transmission", "1", 0, 1, 0, offsetof(struct principled, transmission),
     "0: plastic, 1: glass"},
    {SR_PARAM_FLOAT, "eta", "1", 1.05, 3, 1.5, offsetof(struct principled, eta),
     "index of refraction: inside over outside"},
    {SR_PARAM_FLOAT, "roughness", "1", 0, 1, 0.5, offsetof(struct principled, roughness),
     "square root of the slope width"},
    {SR_PARAM_FLOAT, "anisotropic", "1", 0, 1, 0, offsetof(struct principled, anisotropic),
     "stretches along the tangent"},
    {SR_PARAM_FLOAT, "sheen", "1", 0, 1, 0, offsetof(struct principled, sheen), "cloth's light at grazing angles"},
    {SR_PARAM_FLOAT, "sheen_tint", "1", 0, 1, 0.5, offsetof(struct principled, sheen_tint), "towards the base colour"},
    {SR_PARAM_FLOAT, "clearcoat", "1", 0, 1, 0, offsetof(struct principled, clearcoat), "a second, clear lobe"},
    {SR_PARAM_FLOAT, "clearcoat_gloss", "1", 0, 1, 1, offsetof(struct principled, clearcoat_gloss),
     "0: satin, 1: gloss"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct principled *m = self;
    m->sheen_colour = SR_ONE;
    if (m->sheen_tint > 0)
        m->sheen_colour += m->sheen_tint * (tint_of(m->reflectance, at->lambda) - 1);
    m->filter = sr_spectrum_sqrt(m->reflectance);
    m->ggx = burley_ggx(m->roughness, m->anisotropic);
}

static uint32_t lobes(const void *self)
{
    const struct principled *m = self;
    float opaque = 1 - m->metallic;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | (opaque * (1 - m->transmission) > 0 ? SR_LOBE_DIFFUSE : 0) |
           (opaque * m->transmission > 0 ? SR_LOBE_TRANSMISSION : 0);
}

struct choice { // [1] probabilities; a facet of the specular lobe reflects or transmits by its own Fresnel's shares
    float diffuse, clearcoat, specular;
};
static struct choice choices(const struct principled *m, float co)
{
    float base = sr_spectrum_mean(m->reflectance), plastic = (1 - m->metallic) * (1 - m->transmission);
    float unused, F = fresnel_and_cos(co, m->eta, &unused);
    struct choice c = {plastic * (base + 0.1f * m->sheen), m->clearcoat * clearcoat_weight(co),
                       m->metallic * base + plastic * F + (1 - m->metallic) * m->transmission + 1e-3f};
    float sum = c.diffuse + c.clearcoat + c.specular;
    return (struct choice){c.diffuse / sum, c.clearcoat / sum, c.specular / sum};
}

/* Of a facet that is seen at the cosine cd: its reflectance, and the share of its samples that pass through. */
static sr_spectrum facet(const struct principled *m, float cd, bool below, float *F_glass, float *through)
{
    float unused, F = fresnel_and_cos(cd, m->eta, &unused);
    *F_glass = below ? fresnel_and_cos(cd, 1 / m->eta, &unused) : F;
    float plastic = (1 - m->metallic) * (1 - m->transmission), glass = (1 - m->metallic) * m->transmission;
    sr_spectrum metal = m->reflectance + (1 - m->reflectance) * schlick_weight(cd);
    sr_spectrum R = m->metallic * metal + (plastic * F + glass * *F_glass);
    float T = glass * (1 - *F_glass);
    *through = T > 0 ? T / (T + sr_spectrum_mean(R)) : 0;
    return R;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct principled *m = self;
    *p = 0;
    bool below = wo.z < 0;
    float glass = (1 - m->metallic) * m->transmission;
    struct turn t;
    if (!turn_at(wo, wi, m->eta, &t) || (t.transmits && !(glass > 0)))
        return SR_BLACK;
    float ci = fabsf(wi.z), co = fabsf(wo.z), so = ggx_stretched(m->ggx, wo), si = ggx_stretched(m->ggx, wi);
    float F_glass, through, cos_o = t.cos_o, seen = 2 * ggx_D(m->ggx, t.m) * cos_o * t.jacobian;
    sr_spectrum R = facet(m, cos_o, below, &F_glass, &through);
    struct choice choose = choices(m, co);
    float visible = seen / (co + so), shape = seen / (so * ci + si * co);
    if (t.transmits) {
        *p = choose.specular * through * visible;
        if (mode == SR_RADIANCE)
            shape /= t.eta * t.eta;
        return m->filter * (glass * (1 - F_glass) * shape);
    }
    *p = choose.specular * (1 - through) * visible + choose.diffuse * ci * SR_INV_PI;
    float FL = schlick_weight(ci), FV = schlick_weight(co), FH = schlick_weight(cos_o);
    float retro = 2 * m->roughness * cos_o * cos_o;
    float matte = (1 - 0.5f * FL) * (1 - 0.5f * FV) + retro * (FL + FV + FL * FV * (retro - 1));
    sr_spectrum value = R * shape;
    value += ((1 - m->metallic) * (1 - m->transmission)) *
             (m->reflectance * (matte * SR_INV_PI) + m->sheen_colour * (m->sheen * FH));
    if (m->clearcoat > 0) {
        float pdf_c;
        value += m->clearcoat * clearcoat_f(m->clearcoat_gloss, below ? sr_neg(t.m) : t.m, cos_o, ci, co, &pdf_c);
        *p += choose.clearcoat * pdf_c;
    }
    return value;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_principled.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_principled.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct principled *m = self;
    if (wo.z == 0)
        return false;
    bool below = wo.z < 0, transmits = false;
    sr_vec3 up = below ? sr_neg(wo) : wo;
    struct choice choose = choices(m, up.z);
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION | SR_LOBE_GLOSSY};
    if (u_lobe < choose.diffuse) {
        s->wi = sr_warp_cosine_hemisphere(u);
        s->lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
    } else if (u_lobe < choose.diffuse + choose.clearcoat)
        s->wi = sr_reflect(up, clearcoat_sample(m->clearcoat_gloss, u));
    else {
        float rest = (u_lobe - choose.diffuse - choose.clearcoat) / choose.specular, F_glass, through, cos_t;
        sr_vec3 h = ggx_sample_visible(m->ggx, up, u);
        float cd = sr_dot(up, h), eta = below ? 1 / m->eta : m->eta;
        if (!(cd > 0))
            return false;
        facet(m, cd, below, &F_glass, &through);
        transmits = rest < through;
        if (transmits) {
            fresnel_and_cos(cd, eta, &cos_t);
            s->wi = sr_mad(sr_scale(-1 / eta, up), cd / eta - cos_t, h);
            s->eta = eta;
            s->lobe = SR_LOBE_TRANSMISSION | SR_LOBE_GLOSSY;
        } else
            s->wi = sr_reflect(up, h);
    }
    if (s->wi.z == 0 || (s->wi.z < 0) != transmits)
        return false;
    s->wi = sr_normalize(below ? sr_neg(s->wi) : s->wi);
    s->f = sr_bsdf_principled.f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0 && s->pdf < INFINITY;
}

const struct sr_bsdf_model sr_bsdf_principled = {
    .name = "principled",
    .title = "Disney BSDF (Burley 2015), solid",
    .source = "B. Burley, Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering, 2015",
    .limits =
        "gains energy: lobes are added without taking from each other, and the sheen's tint multiplies colours; no "
        "subsurface scattering, no thin surfaces",
    .params = params,
    .size = sizeof(struct principled),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = 3.2f,
};
