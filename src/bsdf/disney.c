/* SPDX-License-Identifier: MIT */
/* Disney's BRDF of 2012: one surface for artists, from cloth to car paint, by ten numbers in 0 ... 1 and a colour C.
 *
 *     f = (lerp(subsurface, Fd, ss) C / pi + sheen (1 - cd)^5 C_sheen) (1 - metallic) + f_s + f_c         [1/sr]
 *     Fd = (1 + (F90 - 1)(1 - ci)^5)(1 + (F90 - 1)(1 - co)^5),   F90 = 1/2 + 2 cd^2 roughness
 *     ss = 1.25 (Fss (1 / (ci + co) - 1/2) + 1/2),   Fss as Fd with F90 = cd^2 roughness
 *     f_s = (C_s + (1 - C_s)(1 - cd)^5) D(m) / ((ci + s(wi)) (co + s(wo))),   Trowbridge-Reitz, masked separately,
 *         alpha_x = roughness^2 / a, alpha_y = roughness^2 a, a = sqrt(1 - 0.9 anisotropic), at least 0.001 each
 *         C_s = lerp(metallic, 0.08 specular lerp(specular_tint, 1, C_tint), C)
 *     C_tint = C / luminance(C),   C_sheen = lerp(sheen_tint, 1, C_tint);   f_c: clear coat, see burley.h
 *
 * with ci, co the cosines of wi and wo, cd = wo.m. B. Burley, Physically Based Shading at Disney, 2012, as in Disney's
 * BRDF Explorer (which masks by alpha, not by the paper's widened roughness).
 *
 * Limits: reciprocal, but not bound by energy: lobes are added without taking from each other, the diffuse one exceeds
 * 1 by itself at grazing, and tints multiply (up to 10 times for saturated colours). */
#include "bsdf/burley.h"

struct disney {
    sr_spectrum reflectance;             // [1]
    sr_spectrum specular0, sheen_colour; // [1] derived
    float metallic, subsurface, specular, roughness, specular_tint, anisotropic, sheen, sheen_tint, clearcoat,
        clearcoat_gloss; // [1]
    struct sr_ggx ggx;   // derived
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct disney, reflectance), "base colour"},
    {SR_PARAM_FLOAT, "metallic", "1", 0, 1, 0, offsetof(struct disney, metallic), "0: plastic, 1: metal"},
    {SR_PARAM_FLOAT, "subsurface", "1", 0, 1, 0, offsetof(struct disney, subsurface), "flattens the diffuse lobe"},
    {SR_PARAM_FLOAT, "specular", "1", 0, 1, 0.5, offsetof(struct disney, specular),
     "reflectance at normal incidence / 0.08"},
    {SR_PARAM_FLOAT, "roughness", "1", 0, 1, 0.5, offsetof(struct disney, roughness), "square root of the slope width"},
    {SR_PARAM_FLOAT, "specular_tint", "1", 0, 1, 0, offsetof(struct disney, specular_tint), "towards the base colour"},
    {SR_PARAM_FLOAT, "anisotropic", "1", 0, 1, 0, offsetof(struct disney, anisotropic), "stretches along the tangent"},
    {SR_PARAM_FLOAT, "sheen", "1", 0, 1, 0, offsetof(struct disney, sheen), "cloth's light at grazing angles"},
    {SR_PARAM_FLOAT, "sheen_tint", "1", 0, 1, 0.5, offsetof(struct disney, sheen_tint), "towards the base colour"},
    {SR_PARAM_FLOAT, "clearcoat", "1", 0, 1, 0, offsetof(struct disney, clearcoat), "a second, clear lobe"},
    {SR_PARAM_FLOAT, "clearcoat_gloss", "1", 0, 1, 1, offsetof(struct disney, clearcoat_gloss), "0: satin, 1: gloss"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct disney *m = self;
    sr_spectrum tint = SR_ONE;
    if (m->specular_tint > 0 || m->sheen_tint > 0)
        tint = tint_of(m->reflectance, at->lambda);
    sr_spectrum plastic = 0.08f * m->specular * (SR_ONE + m->specular_tint * (tint - 1));
    m->specular0 = plastic + m->metallic * (m->reflectance - plastic);
    m->sheen_colour = SR_ONE + m->sheen_tint * (tint - 1);
    m->ggx = burley_ggx(m->roughness, m->anisotropic);
}

static uint32_t lobes(const void *self)
{
    const struct disney *m = self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | (m->metallic < 1 ? SR_LOBE_DIFFUSE : 0);
}

struct choice { // [1] probabilities
    float diffuse, specular, clearcoat;
};
static struct choice choices(const struct disney *m, float co)
{
    float w = schlick_weight(co);
    struct choice c = {(1 - m->metallic) * (sr_spectrum_mean(m->reflectance) + 0.1f * m->sheen),
                       sr_spectrum_mean(m->specular0 + (1 - m->specular0) * w) + 1e-3f,
                       m->clearcoat * clearcoat_weight(co)};
    float sum = c.diffuse + c.specular + c.clearcoat;
    return (struct choice){c.diffuse / sum, c.specular / sum, c.clearcoat / sum};
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct disney *m = self;
    (void)mode;
    *p = 0;
    sr_vec3 h;
    float ci = fabsf(wi.z), co = fabsf(wo.z), cd;
    if (!(wo.z * wi.z > 0) || !mirror_facet(wo, wi, &h, &cd))
        return SR_BLACK;
    h.z = fabsf(h.z); // on either side the same
    float FL = schlick_weight(ci), FV = schlick_weight(co), FH = schlick_weight(cd);
    float F90 = 0.5f + 2 * cd * cd * m->roughness, flat90 = cd * cd * m->roughness;
    float Fd = (1 + (F90 - 1) * FL) * (1 + (F90 - 1) * FV), Fss = (1 + (flat90 - 1) * FL) * (1 + (flat90 - 1) * FV);
    float ss = 1.25f * (Fss * (1 / (ci + co) - 0.5f) + 0.5f);
    sr_spectrum value =
        ((sr_lerp(m->subsurface, Fd, ss) * SR_INV_PI) * m->reflectance + (m->sheen * FH) * m->sheen_colour) *
        (1 - m->metallic);
    struct choice choose = choices(m, co);
    *p = choose.diffuse * ci * SR_INV_PI;

    float so = ggx_stretched(m->ggx, wo), si = ggx_stretched(m->ggx, wi), D = ggx_D(m->ggx, h);
    value += (m->specular0 + (1 - m->specular0) * FH) * (D / ((ci + si) * (co + so)));
    *p += choose.specular * D / (2 * (co + so));
    if (m->clearcoat > 0) {
        float pdf_c;
        value += m->clearcoat * clearcoat_f(m->clearcoat_gloss, h, cd, ci, co, &pdf_c);
        *p += choose.clearcoat * pdf_c;
    }
    return value;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_disney.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_disney.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct disney *m = self;
    if (wo.z == 0)
        return false;
    sr_vec3 up = wo.z < 0 ? sr_neg(wo) : wo;
    struct choice choose = choices(m, up.z);
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION | SR_LOBE_GLOSSY};
    if (u_lobe < choose.diffuse) {
        s->wi = sr_warp_cosine_hemisphere(u);
        s->lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
    } else if (u_lobe < choose.diffuse + choose.clearcoat)
        s->wi = sr_reflect(up, clearcoat_sample(m->clearcoat_gloss, u));
    else
        s->wi = sr_reflect(up, ggx_sample_visible(m->ggx, up, u));
    if (!(s->wi.z > 0))
        return false;
    s->wi = sr_normalize(wo.z < 0 ? sr_neg(s->wi) : s->wi);
    s->f = sr_bsdf_disney.f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0 && s->pdf < INFINITY;
}

const struct sr_bsdf_model sr_bsdf_disney = {
    .name = "disney",
    .title = "Disney BRDF (Burley 2012)",
    .source = "B. Burley, Physically Based Shading at Disney, 2012; Disney's BRDF Explorer, disney.brdf",
    .limits = "gains energy: lobes are added without taking from each other, and tints multiply saturated colours",
    .params = params,
    .size = sizeof(struct disney),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = 3.2f,
};
