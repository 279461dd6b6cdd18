/* SPDX-License-Identifier: MIT */
/* Private to this room: rough surfaces made of small mirrors, for a choice of their slopes and of how they hide each
 * other.
 *
 *     f = F(|wo.m|) D(m) G(wo, wi) / (4 |zo| |zi|)    [1/sr],    INTEGRAL D(m) m.z dm = 1
 *
 * Smith's masking is told by the area of the facets that w sees, s(w) = |z| (1 + Lambda(w)) [1], finite at grazing:
 *
 *     Trowbridge-Reitz   s = (|z| + sqrt(z^2 + r^2)) / 2                              r^2 = (ax x)^2 + (ay y)^2
 *     Beckmann           s = |z| (1 + erf a) / 2 + r exp(-a^2) / (2 sqrt(pi))         a = |z| / r
 *     height-correlated  G / (|zo| |zi|) = 1 / (s(wo) |zi| + s(wi) |zo| - |zo| |zi|)
 *     product            G / (|zo| |zi|) = 1 / (s(wo) s(wi))
 *     V-cavities         G = min(1, 2 m.z |zo| / |wo.m|, 2 m.z |zi| / |wo.m|)
 *
 * Phong's slopes, D = (1 / (pi ax ay)) m.z^n with n + 2 = 2 / alpha^2 along each azimuth, have no area in closed form;
 * they borrow Beckmann's (Walter et al. 2007), and are drawn by D m.z. All others are drawn as w sees them. Cook &
 * Torrance 1982; Walter et al. 2007; Heitz 2014; Heitz & d'Eon 2014 (visible normals). */
#ifndef SR_BSDF_FACETS_H
#define SR_BSDF_FACETS_H

#include "bsdf/microfacet.h"

enum slopes { SLOPES_GGX, SLOPES_BECKMANN, SLOPES_PHONG };
enum masking { MASKING_SMITH, MASKING_PRODUCT, MASKING_V };

struct facets {
    int32_t slopes, masking;
    float alpha_x, alpha_y; // [1] slope widths, 1e-4 at least
};

static inline struct facets facets_of(int32_t slopes, int32_t masking, float alpha_x, float alpha_y)
{
    return (struct facets){slopes, masking, larger(alpha_x, GGX_MIN_ALPHA), larger(alpha_y, GGX_MIN_ALPHA)};
}

static inline float beckmann_D(float alpha_x, float alpha_y, sr_vec3 m)
{
    float c2 = m.z * m.z, e = sr_sqr(m.x / alpha_x) + sr_sqr(m.y / alpha_y);
    return e < 80 * c2 ? expf(-e / c2) / (SR_PI * alpha_x * alpha_y * c2 * c2) : 0;
}

/* Twice the exponent's share: n(phi) + 2 = 2 q, where m's azimuth has the slope width 1 / sqrt(q). */
static inline float phong_D(float alpha_x, float alpha_y, sr_vec3 m)
{
    float s2 = m.x * m.x + m.y * m.y, e = sr_sqr(m.x / alpha_x) + sr_sqr(m.y / alpha_y);
    float n = s2 > 0 ? 2 * (e / s2 - 1) : 0; // times ln(1) where s2 = 0
    return n > 0 && !(s2 < 1) ? 0 : expf(0.5f * n * log1pf(-sr_min(s2, 0.9999999f))) / (SR_PI * alpha_x * alpha_y);
}

static inline float facets_D(const struct facets *a, sr_vec3 m)
{
    m.z = fabsf(m.z);
    if (a->slopes == SLOPES_GGX)
        return ggx_D((struct sr_ggx){a->alpha_x, a->alpha_y}, m);
    return a->slopes == SLOPES_BECKMANN ? beckmann_D(a->alpha_x, a->alpha_y, m) : phong_D(a->alpha_x, a->alpha_y, m);
}

/* s of a surface with alpha = 1 seen along a vector of height c >= 0 and width r >= 0, up to the slope x: all is seen
 * at x = c / r. As a function of x it is the distribution of the slopes that are seen (Heitz & d'Eon 2014). */
static inline float beckmann_area(float c, float r, float x)
{
    return 0.5f * c * erfcf(-x) + r * expf(-x * x) * 0.28209479f; // 1 / (2 sqrt(pi))
}

static inline float facets_area(const struct facets *a, sr_vec3 w) // s(w) above
{
    float z = fabsf(w.z), r2 = sr_sqr(a->alpha_x * w.x) + sr_sqr(a->alpha_y * w.y);
    if (a->slopes == SLOPES_GGX)
        return 0.5f * (z + sqrtf(z * z + r2));
    float r = sqrtf(r2);
    return r * 6 < z ? z : beckmann_area(z, r, z / r); // erfc(6) is 2e-17
}

/* The slope below which the share u of the seen area lies, for a view of height c and width r (c^2 + r^2 = 1). Halley's
 * iteration inside a bracket: as the density is (c - r x) exp(-x^2) / sqrt(pi), all derivatives are at hand. */
static inline float beckmann_visible_slope(float c, float r, float u)
{
    float lo = -6, hi = c < 6 * r ? c / r : 6;
    float goal = u * beckmann_area(c, r, hi);
    float x = sr_clamp(0.4155f * logf((u + 1e-9f) / (1 - u + 1e-9f)) - 0.4f * r, lo, hi); // as of a logistic curve
    for (int i = 0; i < 20; ++i) {
        float excess = beckmann_area(c, r, x) - goal;
        if (excess > 0)
            hi = x;
        else
            lo = x;
        float height = c - r * x, slope = height * expf(-x * x) * 0.56418958f; // 1 / sqrt(pi)
        float newton = excess / slope, bend = -0.5f * (r / height + 2 * x);
        float next = x - newton / sr_clamp(1 - newton * bend, 0.5f, 2);
        if (!(next > lo && next < hi))
            next = 0.5f * (lo + hi);
        if (fabsf(next - x) < 1e-6f)
            return next;
        x = next;
    }
    return x;
}

static inline sr_vec3 beckmann_sample_visible(float alpha_x, float alpha_y, sr_vec3 w, sr_vec2 u)
{
    sr_vec3 v = {alpha_x * w.x, alpha_y * w.y, fabsf(w.z)};
    float r = sqrtf(v.x * v.x + v.y * v.y), length = sqrtf(r * r + v.z * v.z);
    float cosine = r > 0 ? v.x / r : 1, sine = r > 0 ? v.y / r : 0;
    if (w.z < 0) {
        cosine = -cosine;
        sine = -sine;
    }
    // toward the viewer and across
    float x = beckmann_visible_slope(v.z / length, r / length, u.x), y = beckmann_visible_slope(1, 0, u.y);
    return sr_normalize((sr_vec3){-alpha_x * (x * cosine - y * sine), -alpha_y * (x * sine + y * cosine), 1});
}

/* Normals with the density D(m) m.z [1/sr]. */
static inline sr_vec3 facets_sample_projected(const struct facets *a, sr_vec2 u)
{
    float sine, cosine;
    sin_cos_turn(u.x, &sine, &cosine);
    float x = a->alpha_x * cosine, y = a->alpha_y * sine;
    if (a->slopes == SLOPES_PHONG) {
        float q = 1 / (x * x + y * y); // (cos^2 / ax^2 + sin^2 / ay^2) of m's azimuth
        float log_c = log1pf(-u.y) / (2 * q), s = sqrtf(-expm1f(2 * log_c) * q);
        return sr_normalize((sr_vec3){x * s, y * s, larger(expf(log_c), 1e-9f)});
    }
    float slope = sqrtf(a->slopes == SLOPES_GGX ? u.y / (1 - u.y) : -log1pf(-u.y));
    return sr_normalize((sr_vec3){x * slope, y * slope, 1});
}

/* Normals as w sees them, on the side of +z; u_flip chooses the side of the cavity, where there are any. */
static inline sr_vec3 facets_sample(const struct facets *a, sr_vec3 w, float u_flip, sr_vec2 u)
{
    if (a->masking != MASKING_V && a->slopes == SLOPES_GGX)
        return ggx_sample_visible((struct sr_ggx){a->alpha_x, a->alpha_y}, w, u);
    if (a->masking != MASKING_V && a->slopes == SLOPES_BECKMANN)
        return beckmann_sample_visible(a->alpha_x, a->alpha_y, w, u);
    sr_vec3 m = facets_sample_projected(a, u);
    if (a->masking == MASKING_V) {
        if (w.z < 0)
            w = sr_neg(w);
        sr_vec3 other = {-m.x, -m.y, m.z};
        float c = larger(sr_dot(w, m), 0), d = larger(sr_dot(w, other), 0);
        if (!(u_flip * (c + d) < c))
            m = other;
    }
    return m;
}

/* The density of that, [1/sr] of m, over the cosine |w.m|; D and s(w) as above. */
static inline float facets_pdf(const struct facets *a, sr_vec3 w, sr_vec3 m, float cos_m, float D, float area)
{
    float z = fabsf(w.z), mz = fabsf(m.z);
    if (a->masking == MASKING_V)
        return D * sr_min(1 / z, 2 * mz / cos_m);
    return a->slopes == SLOPES_PHONG ? D * mz / cos_m : D / area;
}

/* G / (|zo| |zi|); areas are needed where the masking is Smith's. */
static inline float facets_masking(const struct facets *a, sr_vec3 wo, sr_vec3 wi, sr_vec3 m, float cos_m, float area_o,
                                   float area_i)
{
    float zo = fabsf(wo.z), zi = fabsf(wi.z);
    if (a->masking == MASKING_V) {
        float least = sr_min(zo, zi), most = larger(zo, zi);
        return sr_min(1 / least, 2 * fabsf(m.z) / cos_m) / most;
    }
    if (a->masking == MASKING_PRODUCT)
        return 1 / (area_o * area_i);
    return 1 / (area_o * zi + (area_i - zi) * zo);
}

/* D G / (4 |zo| |zi|) [1/sr], the density of facets_sample_reflection, and the cosine at the facet. 0: nothing
 * reflects. */
static inline float facets_reflection(const struct facets *a, sr_vec3 wo, sr_vec3 wi, float *pdf, float *cos_m)
{
    *pdf = 0;
    *cos_m = 0;
    sr_vec3 m;
    if (!(wo.z * wi.z > 0) || !mirror_facet(wo, wi, &m, cos_m))
        return 0;
    float area_o = facets_area(a, wo), D = facets_D(a, m);
    *pdf = 0.25f * facets_pdf(a, wo, m, *cos_m, D, area_o);
    if (!(*pdf > 0 && *pdf < INFINITY))
        return *pdf = 0;
    return 0.25f * D * facets_masking(a, wo, wi, m, *cos_m, area_o, facets_area(a, wi));
}

/* Draws wi; value as of facets_reflection. False where it points below. */
static inline bool facets_sample_reflection(const struct facets *a, sr_vec3 wo, float u_flip, sr_vec2 u, sr_vec3 *wi,
                                            float *value, float *pdf, float *cos_m)
{
    if (wo.z == 0)
        return false;
    sr_vec3 m = facets_sample(a, wo, u_flip, u);
    if (wo.z < 0)
        m = sr_neg(m);
    *cos_m = sr_dot(wo, m);
    *wi = sr_reflect(wo, m);
    if (!(*cos_m > 0) || !(wo.z * wi->z > 0))
        return false;
    float area_o = facets_area(a, wo), D = facets_D(a, m);
    *pdf = 0.25f * facets_pdf(a, wo, m, *cos_m, D, area_o);
    *value = 0.25f * D * facets_masking(a, wo, *wi, m, *cos_m, area_o, facets_area(a, *wi));
    return *pdf > 0 && *pdf < INFINITY && *value < INFINITY;
}

#endif
