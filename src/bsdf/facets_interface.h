/* SPDX-License-Identifier: MIT */
/* Private to this room: a boundary of microfacets between two media, for a choice of slopes and of masking.
 *
 *     reflection:   f = F D G / (4 |zo| |zi|)                                                           [1/sr]
 *     transmission: f = (1 - F) D G' |wi.m| |wo.m| / (|zo| |zi| (wi.m + wo.m / eta)^2)                   [1/sr]
 *
 * in the form for importance; eta = index on wi's side over that on wo's. Light that passes is masked above and below,
 * where heights work against each other: with a = Lambda(wo) and b = Lambda(wi)
 *
 *     beta     G = 1 / (1 + a + b),    G' = B(1 + a, 1 + b) = Gamma(1 + a) Gamma(1 + b) / Gamma(2 + a + b)
 *     product  G = G' = 1 / ((1 + a) (1 + b))
 *     sum      G = G' = 1 / (1 + a + b)
 *
 * Walter et al. 2007 (product); Heitz 2014, Dupuy et al. 2016 (beta: exact for Smith's surface). sum has no derivation
 * for opposite sides, but is what some renderers use. */
#ifndef SR_BSDF_FACETS_INTERFACE_H
#define SR_BSDF_FACETS_INTERFACE_H

#include "bsdf/facets.h"

enum passing { PASSING_BETA, PASSING_PRODUCT, PASSING_SUM };

struct rough_interface {
    float eta; // [1] below over above
    struct facets facets;
    int32_t passing;
    bool is_smooth; // then a delta function, see interface_sample
};

static inline struct rough_interface rough_interface_of(float eta, int32_t slopes, int32_t passing, float alpha_x,
                                                        float alpha_y)
{
    int32_t masking = passing == PASSING_PRODUCT ? MASKING_PRODUCT : MASKING_SMITH;
    // where the indices match, the half vector of refraction is lost in rounding
    return (struct rough_interface){eta, facets_of(slopes, masking, alpha_x, alpha_y), passing,
                                    fabsf(eta - 1) < 1e-3f || ggx_is_smooth((struct sr_ggx){alpha_x, alpha_y})};
}
static inline struct interface mirror_of(const struct rough_interface *a)
{
    return (struct interface){.eta = a->eta, .is_smooth = true};
}

/* ln Gamma(x) - ((x - 1/2) ln x - x + ln(2 pi) / 2) for x >= 3: Stieltjes' continued fraction, error < 2e-8. */
static inline float stirling_rest(float x)
{
    return (1.0f / 12) / (x + (1.0f / 30) / (x + (53.0f / 210) / (x + (195.0f / 371) / x)));
}

/* Euler's B(x, y) for x, y >= 1, by B(x + 2, y + 2) and Stirling's series; no cancellation for large x or y. */
static inline float euler_beta(float x, float y)
{
    float s = x + y, X = x + 2, Y = y + 2, S = s + 4, small = sr_min(X, Y), large = larger(X, Y);
    float up = s / x * ((s + 1) / (x + 1)) * ((s + 2) / y) * ((s + 3) / (y + 1));
    float power = (large - 0.5f) * log1pf(-small / S) + (small - 0.5f) * logf(small / S);
    return up * 2.50662827f / sqrtf(S) * expf(power + stirling_rest(X) + stirling_rest(Y) - stirling_rest(S));
}

/* G' / (|zo| |zi|) */
static inline float passing_mask(const struct rough_interface *a, float zo, float zi, float area_o, float area_i)
{
    if (a->passing == PASSING_PRODUCT)
        return 1 / (area_o * area_i);
    if (a->passing == PASSING_SUM)
        return 1 / (area_o * zi + (area_i - zi) * zo);
    if (zo < 1e-6f * area_o || zi < 1e-6f * area_i)
        return 0; // at the horizon
    return euler_beta(larger(area_o / zo, 1), larger(area_i / zi, 1)) / (zo * zi);
}

/* f in the form for importance, and the density that rough_interface_sample has. */
static inline float rough_interface_f_pdf(const struct rough_interface *a, sr_vec3 wo, sr_vec3 wi, float *pdf)
{
    *pdf = 0;
    struct turn t;
    if (a->is_smooth || !turn_at(wo, wi, a->eta, &t))
        return 0;
    float R = turn_fresnel(&t), share = t.transmits ? 1 - R : R;
    if (!(share > 0))
        return 0;
    float area_o = facets_area(&a->facets, wo), area_i = facets_area(&a->facets, wi);
    float G = t.transmits ? passing_mask(a, fabsf(wo.z), fabsf(wi.z), area_o, area_i)
                          : facets_masking(&a->facets, wo, wi, t.m, t.cos_o, area_o, area_i);
    float seen = share * facets_D(&a->facets, t.m) * t.cos_o * t.jacobian;
    *pdf = seen / area_o;
    if (!(*pdf > 0 && *pdf < INFINITY))
        return *pdf = 0;
    return seen * G;
}

/* Draws by facets as they are seen and by Fresnel's share; weight in the form for importance. */
static inline bool rough_interface_sample(const struct rough_interface *a, sr_vec3 wo, float u_lobe, sr_vec2 u,
                                          struct interface_sample *s)
{
    if (a->is_smooth) {
        struct interface mirror = mirror_of(a);
        return interface_sample(&mirror, wo, u_lobe, u, SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION, s);
    }
    if (wo.z == 0)
        return false;
    sr_vec3 m = facets_sample(&a->facets, wo, 0, u);
    if (wo.z < 0)
        m = sr_neg(m);
    float eta = wo.z < 0 ? 1 / a->eta : a->eta, cos_o = sr_dot(wo, m), cos_t;
    if (!(cos_o > 0))
        return false;
    float R = fresnel_and_cos(cos_o, eta, &cos_t);
    s->transmits = u_lobe >= R;
    float share = s->transmits ? 1 - R : R;
    s->eta = s->transmits ? eta : 1;
    s->wi = s->transmits ? sr_normalize(sr_mad(sr_scale(-1 / eta, wo), cos_o / eta - cos_t, m)) : sr_reflect(wo, m);
    if (s->wi.z == 0 || sr_same_hemisphere(wo, s->wi) == s->transmits)
        return false;
    float zo = fabsf(wo.z), zi = fabsf(s->wi.z);
    float area_o = facets_area(&a->facets, wo), area_i = facets_area(&a->facets, s->wi);
    float G = s->transmits ? passing_mask(a, zo, zi, area_o, area_i)
                           : facets_masking(&a->facets, wo, s->wi, m, cos_o, area_o, area_i);
    float jacobian = s->transmits ? cos_t / sr_sqr(cos_t - cos_o / eta) : 1 / (4 * cos_o);
    s->pdf = share * facets_D(&a->facets, m) * cos_o * jacobian / area_o;
    s->weight = G * area_o * zi;
    return s->pdf > 0 && s->pdf < INFINITY;
}

/* What sr_bsdf_sample tells of it. */
static inline struct sr_bsdf_sample rough_interface_told(const struct rough_interface *a,
                                                         const struct interface_sample *i, enum sr_transport mode)
{
    float value = i->weight * i->pdf / fabsf(i->wi.z);
    if (mode == SR_RADIANCE && i->transmits)
        value /= i->eta * i->eta;
    return (struct sr_bsdf_sample){.wi = i->wi,
                                   .f = SR_BLACK + value,
                                   .pdf = i->pdf,
                                   .eta = i->eta,
                                   .lobe = (i->transmits ? SR_LOBE_TRANSMISSION : SR_LOBE_REFLECTION) |
                                           (a->is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY)};
}

#endif
