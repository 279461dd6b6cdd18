/* SPDX-License-Identifier: MIT */
/* Private to this room: the inner arithmetic of Fresnel's and Trowbridge & Reitz's formulas, inline for the hot loops.
 *
 * With the stretched length  s(w) = sqrt(z^2 + (ax x)^2 + (ay y)^2)  Smith's functions lose their divisions:
 *
 *     1 + Lambda(w) = (1 + s/|z|) / 2      G1 = 2 |z| / (|z| + s)
 *     G2 / (|zo| |zi|) = 2 / (so |zi| + si |zo|)      (height-correlated, 1 / (1 + Lambda_o + Lambda_i))
 *
 * Trowbridge & Reitz 1975; Walter et al. 2007; Heitz 2014; Dupuy & Benyoub 2023. */
#ifndef SR_BSDF_MICROFACET_H
#define SR_BSDF_MICROFACET_H

#include "bsdf/bsdf.h"

#define GGX_SMOOTH 1e-3f    // [1] below this slope width a surface is a mirror
#define GGX_MIN_ALPHA 1e-4f // [1] narrower slopes cannot be told apart by float directions

/* fmaxf and fminf are calls into libm, because of NaN; these are one instruction. NaN in a gives b. */
static inline float larger(float a, float b)
{
    return a > b ? a : b;
}
/* sin and cos of 2 pi u for u in [0, 1]; |error| < 2e-7. */
static inline void sin_cos_turn(float u, float *s, float *c)
{
    float v = 4 * u;
    int quarter = (int)(v + 0.5f);
    float x = (v - (float)quarter) * (SR_PI / 2), x2 = x * x; // in -pi/4 ... pi/4: Taylor's series
    float sine = x * (1 + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880)))));
    float cosine = 1 + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
    float a = (quarter & 1) ? cosine : sine;
    float b = (quarter & 1) ? sine : cosine;
    *s = (quarter & 2) ? -a : a;
    *c = ((quarter + 1) & 2) ? -b : b;
}

/* Fresnel's reflectance of the cosines on both sides; g = eta cos_t. */
static inline float fresnel_of(float cos_i, float g, float eta)
{
    float dense = eta * eta * cos_i, r_p = (dense - g) / (dense + g), r_s = (cos_i - g) / (cos_i + g);
    return (r_p * r_p + r_s * r_s) * 0.5f;
}

/* Fresnel's reflectance and the cosine of the refracted direction; cos_i in 0 ... 1, eta = transmitted / incident side.
 * With g = eta cos_t = sqrt((eta - 1) (eta + 1) + cos_i^2), which keeps its digits where 1 - sin_t^2 cancels. */
static inline float fresnel_and_cos(float cos_i, float eta, float *cos_t)
{
    cos_i = sr_min(cos_i, 1);
    float g2 = (eta - 1) * (eta + 1) + cos_i * cos_i;
    *cos_t = 0;
    if (!(g2 > 0))
        return 1;
    float g = sqrtf(g2);
    *cos_t = g / eta;
    return fresnel_of(cos_i, g, eta);
}

/* cos_i signed: negative means from behind, where the relative index is 1 / eta. */
static inline float fresnel(float cos_i, float eta)
{
    float unused;
    return cos_i < 0 ? fresnel_and_cos(-cos_i, 1 / eta, &unused) : fresnel_and_cos(cos_i, eta, &unused);
}

static inline bool ggx_is_smooth(struct sr_ggx g)
{
    return larger(g.alpha_x, g.alpha_y) < GGX_SMOOTH;
}
static inline struct sr_ggx ggx_usable(struct sr_ggx g)
{
    return (struct sr_ggx){larger(g.alpha_x, GGX_MIN_ALPHA), larger(g.alpha_y, GGX_MIN_ALPHA)};
}
static inline float ggx_D(struct sr_ggx g, sr_vec3 m)
{
    float e = sr_sqr(m.x / g.alpha_x) + sr_sqr(m.y / g.alpha_y) + m.z * m.z;
    return 1 / (SR_PI * g.alpha_x * g.alpha_y * e * e);
}
static inline float ggx_stretched(struct sr_ggx g, sr_vec3 w) // s(w) above
{
    return sqrtf(w.z * w.z + sr_sqr(g.alpha_x * w.x) + sr_sqr(g.alpha_y * w.y));
}

/* Normals in proportion to how much of them w sees: a cap of the sphere in the stretched space where the surface's
 * slopes are those of a hemisphere. Always on the side of +z. */
static inline sr_vec3 ggx_sample_visible(struct sr_ggx g, sr_vec3 w, sr_vec2 u)
{
    sr_vec3 v = {g.alpha_x * w.x, g.alpha_y * w.y, w.z};
    v = sr_scale((w.z < 0 ? -1.0f : 1.0f) / sr_length(v), v);
    float sine, cosine;
    sin_cos_turn(u.x, &sine, &cosine);
    float z = (1 - u.y) * (1 + v.z) - v.z;
    float r = sr_safe_sqrt((1 - z) * (1 + z));
    sr_vec3 m = {g.alpha_x * (r * cosine + v.x), g.alpha_y * (r * sine + v.y), larger(z + v.z, 1e-9f)};
    return sr_normalize(m);
}

/* The microfacet that mirrors wo to wi, on the side of wo. The cosine there is |wo + wi| / 2 of two unit vectors: wo.m
 * is off by the rounding of their lengths, which at grazing is more than the cosine itself, and may even be below 0. */
static inline bool mirror_facet(sr_vec3 wo, sr_vec3 wi, sr_vec3 *m, float *cos_m)
{
    *m = sr_add(wo, wi);
    float length2 = sr_length2(*m);
    *cos_m = 0;
    if (!(length2 > 1e-20f))
        return false;
    float length = sqrtf(length2);
    *m = sr_scale(1 / length, *m);
    *cos_m = sr_min(0.5f * length, 1);
    return true;
}

/* Where a facet turns light from wo to wi at a boundary; eta = index on wi's side over that on wo's. */
struct turn {
    sr_vec3 m; // on the side of wo
    float eta, cos_o, cos_i;
    float jacobian; // [1] |dm / dwi|
    bool transmits;
};
static inline bool turn_at(sr_vec3 wo, sr_vec3 wi, float eta_below, struct turn *t)
{
    t->transmits = wo.z * wi.z < 0;
    t->eta = wo.z < 0 ? 1 / eta_below : eta_below;
    if (!t->transmits) {
        bool turns = wo.z * wi.z > 0 && mirror_facet(wo, wi, &t->m, &t->cos_o);
        t->cos_i = t->cos_o;
        t->jacobian = 1 / (4 * t->cos_o);
        return turns;
    }
    t->m = sr_mad(wo, t->eta, wi);
    float length2 = sr_length2(t->m);
    if (!(length2 > 1e-20f))
        return false;
    t->m = sr_scale((t->m.z * wo.z < 0 ? -1.0f : 1.0f) / sqrtf(length2), t->m);
    t->cos_o = sr_dot(wo, t->m);
    t->cos_i = sr_dot(wi, t->m);
    t->jacobian = -t->cos_i / sr_sqr(t->cos_i + t->cos_o / t->eta);
    return t->cos_o > 0 && t->cos_i < 0; // else the facet is seen from behind
}

/* Where light is refracted, wi tells the cosine better than Snell's law does near total reflection. */
static inline float turn_fresnel(const struct turn *t)
{
    float unused;
    return t->transmits ? fresnel_of(t->cos_o, -t->cos_i * t->eta, t->eta) : fresnel_and_cos(t->cos_o, t->eta, &unused);
}

/* A dielectric boundary between two half spaces: grey, because one path bears one index. */
struct interface {
    float eta; // [1] below over above
    struct sr_ggx ggx;
    bool is_smooth;
};
struct interface_sample {
    sr_vec3 wi;
    float weight; // [1] f |cos_theta_i| / pdf in the form for importance
    float pdf;    // [1/sr], or the lobe's probability where smooth
    float eta;    // [1] relative index along the way: 1 for reflection
    bool transmits;
};

static inline struct interface interface_of(float eta, struct sr_ggx ggx)
{
    return (struct interface){eta, ggx_usable(ggx), eta == 1 || ggx_is_smooth(ggx)};
}

/* Draws one of the lobes asked for in proportion to Fresnel's shares of the microfacet that was drawn. */
static inline bool interface_sample(const struct interface *a, sr_vec3 wo, float u_lobe, sr_vec2 u, uint32_t lobes,
                                    struct interface_sample *s)
{
    if (wo.z == 0)
        return false;
    sr_vec3 m = {0, 0, 1};
    if (!a->is_smooth)
        m = ggx_sample_visible(a->ggx, wo, u);
    if (wo.z < 0)
        m = sr_neg(m); // m on the side of wo
    float eta = wo.z < 0 ? 1 / a->eta : a->eta;
    float cos_o = sr_dot(wo, m), cos_t;
    if (!(cos_o > 0))
        return false;
    float R = fresnel_and_cos(cos_o, eta, &cos_t);
    float share_r = lobes & SR_LOBE_REFLECTION ? R : 0, share_t = lobes & SR_LOBE_TRANSMISSION ? 1 - R : 0;
    float sum = share_r + share_t;
    if (!(sum > 0))
        return false;
    s->transmits = u_lobe * sum >= share_r;
    float probability = (s->transmits ? share_t : share_r) / sum;
    if (!(probability > 0))
        return false;
    s->eta = s->transmits ? eta : 1;
    if (s->transmits)
        s->wi = sr_mad(sr_scale(-1 / eta, wo), cos_o / eta - cos_t, m);
    else if (a->is_smooth)
        s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
    else
        s->wi = sr_reflect(wo, m);
    if (s->wi.z == 0 || sr_same_hemisphere(wo, s->wi) == s->transmits)
        return false;
    s->weight = sum;
    s->pdf = probability;
    if (a->is_smooth)
        return true;
    if (s->transmits)
        s->wi = sr_normalize(s->wi);

    // visible normals: weight = G2 / G1, pdf = D G1 cos_o / |wo.z| times |dm / dwi|
    float zo = fabsf(wo.z), zi = fabsf(s->wi.z);
    float so = ggx_stretched(a->ggx, wo), si = ggx_stretched(a->ggx, s->wi);
    float visible = 2 * ggx_D(a->ggx, m) * cos_o / (zo + so);
    s->weight *= zi * (zo + so) / (so * zi + si * zo);
    if (s->transmits)
        s->pdf *= visible * cos_t / sr_sqr(cos_t - cos_o / eta);
    else
        s->pdf *= visible / (4 * cos_o);
    return s->pdf > 0 && s->pdf < INFINITY;
}

/* f [1/sr] in the form for importance, and the density that interface_sample has with the same lobes. */
static inline float interface_f_pdf(const struct interface *a, sr_vec3 wo, sr_vec3 wi, uint32_t lobes, float *pdf)
{
    *pdf = 0;
    struct turn t;
    if (a->is_smooth || !turn_at(wo, wi, a->eta, &t) ||
        !(lobes & (t.transmits ? SR_LOBE_TRANSMISSION : SR_LOBE_REFLECTION)))
        return 0;
    float R = turn_fresnel(&t);
    float share_r = lobes & SR_LOBE_REFLECTION ? R : 0, share_t = lobes & SR_LOBE_TRANSMISSION ? 1 - R : 0;
    float share = t.transmits ? share_t : share_r;
    if (!(share > 0))
        return 0;
    float zo = fabsf(wo.z), zi = fabsf(wi.z);
    float so = ggx_stretched(a->ggx, wo), si = ggx_stretched(a->ggx, wi);
    float seen = 2 * ggx_D(a->ggx, t.m) * t.cos_o * t.jacobian;
    *pdf = share / (share_r + share_t) * seen / (zo + so);
    return share * seen / (so * zi + si * zo);
}

/* A conductor's reflectance per wavelength; c = |cos theta|. The real form of Fresnel's formulas. */
static inline sr_spectrum conductor_fresnel(float c, sr_spectrum eta, sr_spectrum k)
{
    c = sr_min(c, 1);
    float c2 = c * c, s2 = (1 - c) * (1 + c);
    sr_spectrum nk = eta * k;
    sr_spectrum t0 = eta * eta - k * k - s2;
    sr_spectrum ab = sr_spectrum_sqrt(t0 * t0 + 4 * nk * nk);
    // a = sqrt((ab + t0) / 2); where t0 < 0 by the product a b = n k, which does not cancel
    sr_spectrum magnitude = sr_spectrum_abs(t0);
    sr_spectrum big = sr_spectrum_sqrt(0.5f * (ab + magnitude));
    sr_spectrum other = nk / (big + 1e-30f);
    sr_spectrum_int negative = t0 < 0;
    sr_spectrum a = (sr_spectrum)(((sr_spectrum_int)other & negative) | ((sr_spectrum_int)big & ~negative));
    sr_spectrum x = ab + c2, y = 2 * c * a;
    sr_spectrum Rs = (x - y) / (x + y + 1e-30f);
    sr_spectrum p = c2 * ab + s2 * s2, q = y * s2;
    sr_spectrum Rp = Rs * ((p - q) / (p + q + 1e-30f));
    return 0.5f * (Rs + Rp);
}

/* Trowbridge-Reitz reflection, without Fresnel's factor: D G / (4 |zo| |zi|), with the density of visible normals and
 * the cosine at the microfacet. 0 where nothing reflects. */
static inline float ggx_reflection(struct sr_ggx g, sr_vec3 wo, sr_vec3 wi, float *pdf, float *cos_m)
{
    *pdf = 0;
    *cos_m = 0;
    sr_vec3 m;
    if (!(wo.z * wi.z > 0) || !mirror_facet(wo, wi, &m, cos_m))
        return 0;
    float zo = fabsf(wo.z), zi = fabsf(wi.z);
    float so = ggx_stretched(g, wo), si = ggx_stretched(g, wi);
    float D = ggx_D(g, m);
    *pdf = D / (2 * (zo + so));
    return D / (2 * (so * zi + si * zo));
}

/* Draws wi by visible normals: weight = G2 / G1. False where it points below. */
static inline bool ggx_sample_reflection(struct sr_ggx g, sr_vec3 wo, sr_vec2 u, sr_vec3 *wi, float *weight, float *pdf,
                                         float *cos_m)
{
    if (wo.z == 0)
        return false;
    sr_vec3 m = ggx_sample_visible(g, wo, u);
    if (wo.z < 0)
        m = sr_neg(m);
    *cos_m = sr_dot(wo, m);
    *wi = sr_reflect(wo, m);
    if (!(*cos_m > 0) || !(wo.z * wi->z > 0))
        return false;
    float zo = fabsf(wo.z), zi = fabsf(wi->z);
    float so = ggx_stretched(g, wo), si = ggx_stretched(g, *wi);
    *pdf = ggx_D(g, m) / (2 * (zo + so));
    *weight = zi * (zo + so) / (so * zi + si * zo);
    return *pdf > 0 && *pdf < INFINITY;
}

#endif
