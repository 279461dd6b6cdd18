/* SPDX-License-Identifier: MIT */
/* Private to this room: light between a dielectric coat and a base, by walks that have a depth and no position.
 *
 *     f(wo, wi) = f_coat(wo, wi) + E[ beta_walk f_base or p_medium toward the refracted wi  T_coat(wi) ]     [1/sr]
 *     transmittance of a crossing = exp(-thickness / |w.z|)      [1],   z counted in mean free paths
 *
 * A walk enters through the coat from wo; each of its meetings with the base or the medium is joined to a direction
 * that was sampled through the coat from wi, and, where the coat is rough, also through the coat by the walk's own next
 * direction, both weighed by the power heuristic. Guo, Hasan & Zhao 2018. An event is one crossing: max_depth of them
 * at most, so that coats of high index over white bases lose some light (see coated_diffuse.c); 100 is as good as all.
 * A medium with a black albedo absorbs: only thickness 0 is clear.
 *
 * Both sides of the surface are coated. All functions here want wo.z > 0 and wi.z > 0. What they return is the same
 * for radiance and importance: what the index takes on the way in it gives on the way out. */
#ifndef SR_BSDF_LAYERED_H
#define SR_BSDF_LAYERED_H

#include "bsdf/microfacet.h"

#include <float.h>
#include <string.h>

_Static_assert(sizeof(struct sr_bsdf_coated) <= SR_BSDF_SIZE, "a BSDF at a point must hold the layers");

struct layers {
    const struct sr_bsdf_coated *c;
    struct interface top;
    struct sr_ggx base;
    bool base_is_smooth;
    bool has_medium; // that scatters
};

static inline struct layers layers_of(const struct sr_bsdf_coated *c, bool metal)
{
    return (struct layers){.c = c,
                           .top = interface_of(c->coat_eta, c->coat_ggx),
                           .base = ggx_usable(c->base_ggx),
                           .base_is_smooth = metal && ggx_is_smooth(c->base_ggx),
                           .has_medium = !sr_spectrum_is_black(c->albedo)};
}

/* exp(-x) for x >= 0; relative error < 3e-7. Taylor's series of 2^f about 0, times a power of two. */
static inline float exp_minus(float x)
{
#ifdef SR_DOUBLE
    return exp(-x);
#else
    float t = larger(x * -1.44269504f, -126);
    float whole = rintf(t), f = (t - whole) * 0.69314718f;
    float p = 1 + f * (1 + f * (1.0f / 2 + f * (1.0f / 6 + f * (1.0f / 24 + f * (1.0f / 120 + f * (1.0f / 720))))));
    int32_t bits = ((int32_t)whole + 127) << 23;
    float power;
    memcpy(&power, &bits, 4);
    return p * power;
#endif
}
/* -ln x for normal x > 0. ln m = 2 artanh((m - 1) / (m + 1)) of the mantissa; relative error < 3e-7. */
static inline float minus_log(float x)
{
#ifdef SR_DOUBLE
    return -log(x);
#else
    int32_t bits;
    memcpy(&bits, &x, 4);
    int32_t exponent = (bits - 0x3f3504f3) >> 23; // the mantissa in sqrt(1/2) ... sqrt(2)
    bits -= exponent * (1 << 23);
    float m;
    memcpy(&m, &bits, 4);
    float s = (m - 1) / (m + 1), s2 = s * s;
    return -2 * s * (1 + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))))) -
           (float)exponent * 0.69314718f;
#endif
}
static inline float crossing(float distance, sr_vec3 w) // transmittance
{
    return distance > FLT_MIN ? exp_minus(distance / fabsf(w.z)) : 1;
}

static inline uint32_t float_bits(float x)
{
#ifdef SR_DOUBLE
    uint64_t bits; // folded: a number that a float can hold has zeros below
    memcpy(&bits, &x, 8);
    return (uint32_t)(bits ^ bits >> 32) ^ (uint32_t)(bits >> 26);
#else
    uint32_t bits;
    memcpy(&bits, &x, 4);
    return bits;
#endif
}
/* Numbers that belong to this vertex and these directions: the estimates are pure functions. */
static inline struct sr_rng rng_of(uint32_t seed, sr_vec3 a, float b, float c, float d)
{
    uint64_t key = ((uint64_t)float_bits(a.x) << 32 | float_bits(a.y)) * 0x9e3779b97f4a7c15u;
    key = (key ^ (key >> 29) ^ ((uint64_t)float_bits(a.z) << 32 | float_bits(b))) * 0xbf58476d1ce4e5b9u;
    key = (key ^ (key >> 32) ^ ((uint64_t)float_bits(c) << 32 | float_bits(d))) * 0x94d049bb133111ebu;
    return sr_rng_seed(key ^ (key >> 31), seed);
}
static inline sr_vec2 uniform2(struct sr_rng *rng)
{
    float x = sr_rng_float(rng);
    return (sr_vec2){x, sr_rng_float(rng)};
}
static inline sr_vec3 cosine_direction(sr_vec2 u)
{
    float s, c, r = sqrtf(u.y);
    sin_cos_turn(u.x, &s, &c);
    return (sr_vec3){r * c, r * s, sqrtf(1 - u.y)};
}
static inline float power_heuristic(float a, float b)
{
    float a2 = a * a;
    return a2 < INFINITY ? a2 / (a2 + b * b) : 1;
}

static inline bool draw_top(const struct layers *l, sr_vec3 wo, uint32_t lobes, struct sr_rng *rng,
                            struct interface_sample *s)
{
    if (l->top.is_smooth) // nothing to draw within a lobe
        return interface_sample(&l->top, wo, 0.5f, (sr_vec2){0, 0}, lobes, s);
    return interface_sample(&l->top, wo, 0.5f, uniform2(rng), lobes, s);
}

/* The coat from w below to wi above: f in the form for radiance over eta^2, and the density with which w would have
 * been drawn from wi, which is what the other way of joining does. pbrt-v4 takes the density of the opposite way there,
 * so that its two weights do not sum to 1 and its f is too bright; on request we do the same. */
static inline float leave_f_pdf(const struct layers *l, sr_vec3 w, sr_vec3 wi, float *pdf)
{
    sr_vec3 back = sr_neg(w);
    float f = interface_f_pdf(&l->top, wi, back, SR_LOBE_TRANSMISSION, pdf);
    if (l->c->weighs_as_pbrt && f > 0)
        interface_f_pdf(&l->top, back, wi, SR_LOBE_TRANSMISSION, pdf);
    return f;
}

static inline sr_spectrum base_f_pdf(const struct layers *l, bool metal, sr_vec3 wo, sr_vec3 wi, float *pdf)
{
    if (!metal) {
        *pdf = fabsf(wi.z) * SR_INV_PI;
        return l->c->base_reflectance * SR_INV_PI;
    }
    float cos_m;
    float shape = ggx_reflection(l->base, wo, wi, pdf, &cos_m);
    return shape > 0 ? conductor_fresnel(cos_m, l->c->base_eta, l->c->base_k) * shape : SR_BLACK;
}

/* weight = f cos / pdf */
static inline bool base_sample(const struct layers *l, bool metal, sr_vec3 wo, struct sr_rng *rng, sr_vec3 *wi,
                               sr_spectrum *weight, float *pdf)
{
    if (!metal) {
        *wi = cosine_direction(uniform2(rng));
        *pdf = wi->z * SR_INV_PI;
        *weight = l->c->base_reflectance;
        return wi->z > 0;
    }
    float masking = 1, cos_m = wo.z;
    if (l->base_is_smooth) {
        *wi = (sr_vec3){-wo.x, -wo.y, wo.z};
        *pdf = 1;
    } else if (!ggx_sample_reflection(l->base, wo, uniform2(rng), wi, &masking, pdf, &cos_m))
        return false;
    *weight = conductor_fresnel(cos_m, l->c->base_eta, l->c->base_k) * masking;
    return true;
}

/* Henyey & Greenstein 1941: c is the cosine between the ways before and after. [1/sr] */
static inline float phase(float g, float c)
{
    float d = larger(1 + g * g - 2 * g * c, 1e-7f);
    return (1 - g * g) / (4 * SR_PI * d * sqrtf(d));
}
static inline sr_vec3 phase_sample(float g, sr_vec3 w, sr_vec2 u, float *pdf)
{
    float c = fabsf(g) < 1e-3f ? 1 - 2 * u.x : (1 + g * g - sr_sqr((1 - g * g) / (1 - g + 2 * g * u.x))) / (2 * g);
    c = sr_clamp(c, -1, 1);
    float s, t, r = sr_safe_sqrt((1 - c) * (1 + c));
    sin_cos_turn(u.y, &s, &t);
    *pdf = phase(g, c);
    struct sr_frame frame = sr_frame_from_z(w);
    return sr_to_world(&frame, (sr_vec3){r * t, r * s, c});
}

/* Between two mirrors nothing but the medium can turn light toward wi; it may still see the mirrors before it leaves:
 * down and up, or up, down and up, and so on. Returns the sum over those ways; `up` is wi's direction under the coat.
 */
static inline sr_spectrum through_mirrors(const struct layers *l, sr_vec3 w, float z, sr_vec3 up, int events)
{
    const struct sr_bsdf_coated *c = l->c;
    sr_vec3 down = {up.x, up.y, -up.z};
    float t = crossing(c->thickness, up);
    float R = fresnel(-up.z, l->top.eta);
    sr_spectrum base = conductor_fresnel(up.z, c->base_eta, c->base_k) * t;
    sr_spectrum sum = SR_BLACK, from_down = base * (phase(c->g, sr_dot(w, down)) * crossing(z, up));
    sr_spectrum from_up = base * (phase(c->g, sr_dot(w, up)) * crossing(c->thickness - z, up) * R * t);
    for (int n = 1; n <= events; n += 2) {
        sum += from_down;
        if (n + 1 <= events)
            sum += from_up;
        from_down *= base * (R * t);
        from_up *= base * (R * t);
    }
    return sum;
}

static inline sr_spectrum layered_f(const struct layers *l, bool metal, sr_vec3 wo, sr_vec3 wi)
{
    const struct sr_bsdf_coated *c = l->c;
    const int count = c->sample_count > 0 ? c->sample_count : 1;
    const bool rough_top = !l->top.is_smooth;
    const float top_z = larger(c->thickness, FLT_MIN);
    float unused;
    sr_spectrum sum = SR_BLACK + (float)count * interface_f_pdf(&l->top, wo, wi, SR_LOBE_REFLECTION, &unused);
    struct sr_rng rng = rng_of(c->seed, wo, wi.x, wi.y, wi.z);

    for (int n = 0; n < count; ++n) {
        struct interface_sample enter, leave, s;
        if (!draw_top(l, wo, SR_LOBE_TRANSMISSION, &rng, &enter))
            continue;
        if (!draw_top(l, wi, SR_LOBE_TRANSMISSION, &rng, &leave)) {
            if (!rough_top || c->weighs_as_pbrt)
                continue;
            // of no weight: the other way still leads out
            leave = (struct interface_sample){.wi = {0, 0, -1}, .pdf = 1};
        }
        sr_vec3 up = sr_neg(leave.wi);
        float leave_f = leave.weight / up.z; // f / pdf of the way out
        sr_spectrum beta = SR_ONE * (enter.weight / (l->top.eta * l->top.eta));
        sr_vec3 w = enter.wi;
        float z = top_z;

        for (int depth = 0; depth < c->max_depth; ++depth) {
            float most = sr_spectrum_max(beta);
            if (!(most > 0))
                break;
            if (depth > 3 && most < 0.25f) {
                if (sr_rng_float(&rng) >= most)
                    break;
                beta *= 1 / most;
            }

            if (l->has_medium) {
                float step = minus_log(1 - sr_rng_float(&rng)) * w.z; // w.z < 0: downward
                float next = z + step;
                if (next == z)
                    continue;
                if (next > 0 && next < top_z) {
                    z = next;
                    float p = phase(c->g, sr_dot(w, up));
                    float weigh = rough_top ? power_heuristic(leave.pdf, p) : 1;
                    beta *= c->albedo;
                    sum += beta * (p * weigh * crossing(top_z - z, up) * leave_f);
                    if (!rough_top && l->base_is_smooth)
                        sum += beta * leave_f * through_mirrors(l, w, z, up, c->max_depth - 1 - depth);
                    float pdf;
                    w = phase_sample(c->g, w, uniform2(&rng), &pdf);
                    if (w.z == 0)
                        break;
                    if (w.z > 0 && rough_top) {
                        float leave_pdf;
                        float f = leave_f_pdf(l, w, wi, &leave_pdf);
                        if (f > 0)
                            sum += beta * (crossing(top_z - z, w) * f * power_heuristic(pdf, leave_pdf));
                    }
                    continue;
                }
                z = w.z < 0 ? 0 : top_z;
            } else {
                z = w.z < 0 ? 0 : top_z;
                beta *= crossing(top_z, w);
            }

            if (z > 0) { // under the coat
                if (!draw_top(l, sr_neg(w), SR_LOBE_REFLECTION, &rng, &s))
                    break;
                beta *= s.weight;
                w = s.wi;
                continue;
            }
            sr_vec3 back = sr_neg(w);
            if (!l->base_is_smooth) { // toward wi by the direction sampled from there
                float pdf;
                sr_spectrum f = base_f_pdf(l, metal, back, up, &pdf);
                float weigh = rough_top ? power_heuristic(leave.pdf, pdf) : 1;
                sum += beta * f * (weigh * crossing(top_z, up) * leave.weight);
            }
            sr_spectrum weight;
            float pdf;
            if (!base_sample(l, metal, back, &rng, &w, &weight, &pdf))
                break;
            beta *= weight;
            if (rough_top) { // toward wi by the direction that the base prefers
                float leave_pdf;
                float f = leave_f_pdf(l, w, wi, &leave_pdf);
                if (f > 0)
                    sum += beta * (crossing(top_z, w) * f * (l->base_is_smooth ? 1 : power_heuristic(pdf, leave_pdf)));
            }
        }
    }
    return sum / (float)count;
}

/* A walk until it leaves. s->f / s->pdf |cos| is its throughput; the density itself is unknown. */
static inline bool layered_sample(const struct layers *l, bool metal, sr_vec3 wo, float u_lobe, sr_vec2 u,
                                  struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_coated *c = l->c;
    const uint32_t both = SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION;
    const float top_z = larger(c->thickness, FLT_MIN);
    struct interface_sample i;
    if (!interface_sample(&l->top, wo, u_lobe, u, both, &i))
        return false;
    *s = (struct sr_bsdf_sample){.eta = 1,
                                 .lobe = SR_LOBE_REFLECTION | (l->top.is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY)};
    if (!i.transmits) {
        s->wi = i.wi;
        s->pdf = i.pdf;
        s->f = SR_BLACK + i.weight * i.pdf / i.wi.z;
        s->pdf_is_proportional = !l->top.is_smooth;
        return true;
    }
    struct sr_rng rng = rng_of(c->seed ^ 0x5bd1e995u, wo, u_lobe, u.x, u.y);
    sr_spectrum beta = SR_ONE * i.weight;
    sr_vec3 w = i.wi;
    float z = top_z;
    bool mirrored = l->top.is_smooth; // by delta functions all the way

    for (int depth = 0; depth < c->max_depth; ++depth) {
        float most = sr_spectrum_max(beta);
        if (!(most > 0))
            return false;
        if (depth > 3 && most < 0.25f) {
            if (sr_rng_float(&rng) >= most)
                return false;
            beta *= 1 / most;
        }
        if (l->has_medium) {
            float next = z + minus_log(1 - sr_rng_float(&rng)) * w.z;
            if (next > 0 && next < top_z && next != z) {
                float pdf;
                z = next;
                w = phase_sample(c->g, w, uniform2(&rng), &pdf);
                if (w.z == 0)
                    return false;
                beta *= c->albedo;
                mirrored = false;
                continue;
            }
        } else {
            beta *= crossing(top_z, w);
        }
        z = w.z < 0 ? 0 : top_z;
        if (z == 0) {
            sr_spectrum weight;
            float pdf;
            if (!base_sample(l, metal, sr_neg(w), &rng, &w, &weight, &pdf))
                return false;
            beta *= weight;
            mirrored &= l->base_is_smooth;
            continue;
        }
        float choice = sr_rng_float(&rng);
        if (!interface_sample(&l->top, sr_neg(w), choice, l->top.is_smooth ? u : uniform2(&rng), both, &i))
            return false;
        beta *= i.weight;
        w = i.wi;
        if (i.transmits) {
            s->wi = w;
            s->pdf = 1;
            s->f = beta / w.z;
            s->lobe = SR_LOBE_REFLECTION | (mirrored                  ? SR_LOBE_SPECULAR
                                            : metal && !l->has_medium ? SR_LOBE_GLOSSY
                                                                      : SR_LOBE_DIFFUSE);
            s->pdf_is_proportional = !mirrored;
            return w.z > 0;
        }
    }
    return false;
}

#endif
