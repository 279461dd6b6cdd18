/* SPDX-License-Identifier: MIT */
/* Private to this room: thin coherent layers on a facet, and the two surfaces that bear them, metal and glass.
 *
 * Layers j = 1 ... N of complex index n_j and thickness d_j lie between 0 (real n_0) and the substrate. With the normal
 * components w_j = sqrt(n_j^2 - n_0^2 sin^2) and the tilted admittances a_j = w_j (s), w_j / n_j^2 (p), amplitudes add
 * up from the substrate (Airy's sum, layer by layer):
 *
 *     r_ij = (a_i - a_j) / (a_i + a_j),   t_ij = 2 a_i / (a_i + a_j),   e_j = exp(2 pi i w_j d_j / lambda)
 *     r <- (r_ij + r e_j^2) / (1 + r_ij r e_j^2),   t <- t_ij e_j t / (1 + r_ij r e_j^2)
 *     R = |r|^2,   T = Re(a_sub) / a_0 |t|^2                                                         [1]
 *
 * which equals the product of characteristic matrices and, unlike it, never overflows: |e_j| <= 1. Time factor
 * exp(-i omega t), n + i k, so that Im w_j >= 0. Airy 1833; Abeles 1950; Parratt 1954; Born & Wolf, 7th ed., 1.6.
 *
 * Each wavelength for itself and fully coherent: fringes finer than a film can resolve (2 n d cos > lambda^2 /
 * bandwidth) are not averaged but sampled. Substrates are half spaces. */
#ifndef SR_BSDF_FILM_H
#define SR_BSDF_FILM_H

#include "bsdf/microfacet.h"

#define FILM_LAYERS 16 // at most

/* Complex numbers, one for each wavelength. */
struct wave {
    sr_spectrum re, im;
};
static inline struct wave wave_add(struct wave a, struct wave b)
{
    return (struct wave){a.re + b.re, a.im + b.im};
}
static inline struct wave wave_mul(struct wave a, struct wave b)
{
    return (struct wave){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
static inline sr_spectrum wave_power(struct wave a)
{
    return a.re * a.re + a.im * a.im;
}
static inline struct wave wave_div(struct wave a, struct wave b)
{
    sr_spectrum d = 1 / (wave_power(b) + 1e-30f);
    return (struct wave){(a.re * b.re + a.im * b.im) * d, (a.im * b.re - a.re * b.im) * d};
}
/* The root in the first quadrant of a number in the upper half plane, without cancellation. */
static inline struct wave wave_sqrt(struct wave a)
{
    struct wave root;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float x = a.re[i], y = sr_max(a.im[i], 0), big = sqrtf(0.5f * (sqrtf(x * x + y * y) + fabsf(x)));
        float other = big > 0 ? y / (2 * big) : 0;
        root.re[i] = x < 0 ? other : big;
        root.im[i] = x < 0 ? big : other;
    }
    return root;
}

/* A material and how much of it; a stack is a sequence of them. */
struct film {
    sr_spectrum n, k; // [1] relative to the outside
    float thickness;  // [nm]
};
struct film_stack {
    struct film films[FILM_LAYERS];
    uint8_t sequence[FILM_LAYERS]; // from the outside to the substrate: which film
    int film_count, layer_count;
    sr_spectrum n, k; // [1] of the substrate
};
struct film_power { // [1] shares of power for both polarisations
    sr_spectrum Rs, Rp, Ts, Tp;
};

struct film_wave {     // a film as light at one angle meets it
    struct wave s, p;  // a_j above
    struct wave phase; // e_j
};

static inline struct wave index_squared(sr_spectrum n, sr_spectrum k)
{
    return (struct wave){n * n - k * k, 2 * n * k};
}

/* s2 = n_0^2 sin^2 of the angle, the same in all layers. */
static inline struct film_wave film_wave(sr_spectrum n, sr_spectrum k, float thickness, sr_spectrum lambda,
                                         sr_spectrum s2)
{
    struct wave e = index_squared(n, k);
    struct film_wave f = {.s = wave_sqrt((struct wave){e.re - s2, e.im})};
    f.p = wave_div(f.s, e);
    sr_spectrum turns = f.s.re * (thickness / lambda), decay = f.s.im * ((2 * SR_PI) * thickness / lambda);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float angle = (2 * SR_PI) * (turns[i] - floorf(turns[i])), length = decay[i] > 0 ? expf(-decay[i]) : 1;
        f.phase.re[i] = length * cosf(angle);
        f.phase.im[i] = length * sinf(angle);
    }
    return f;
}

/* One more boundary, between a above and b below; r and t are those of all that lies below b, e b's own phase. */
static inline void add_boundary(struct wave a, struct wave b, struct wave e, struct wave *r, struct wave *t)
{
    struct wave sum = wave_add(a, b);
    struct wave rij = wave_div((struct wave){a.re - b.re, a.im - b.im}, sum);
    struct wave tij = wave_div((struct wave){2 * a.re, 2 * a.im}, sum);
    struct wave below = wave_mul(*r, wave_mul(e, e));
    struct wave echo = wave_mul(rij, below);
    echo.re += 1;
    *r = wave_div(wave_add(rij, below), echo);
    *t = wave_div(wave_mul(tij, wave_mul(e, *t)), echo);
}

/* Light from above (the outside, index 1), or from below: from the substrate, which must then be clear. c = |cos|
 * there, c_out = |cos| beyond a clear substrate or outside: near total reflection it says more than c does; 0: total,
 * or a metal. */
static inline struct film_power film_reflect(const struct film_stack *f, sr_spectrum lambda, float c, float c_out,
                                             bool from_below)
{
    c = sr_clamp(c, 1e-6f, 1);
    c_out = sr_min(c_out, 1);
    sr_spectrum zero = SR_BLACK, n0 = from_below ? f->n : SR_ONE, n_out = from_below ? SR_ONE : f->n;
    sr_spectrum s2 = n0 * n0 * ((1 - c) * (1 + c));
    if (c_out > 0 && n0[0] > n_out[0])
        s2 = n_out * n_out * ((1 - c_out) * (1 + c_out));
    struct film_wave waves[FILM_LAYERS];
    for (int i = 0; i < f->film_count; ++i)
        waves[i] = film_wave(f->films[i].n, f->films[i].k, f->films[i].thickness, lambda, s2);

    struct wave in_s = {n0 * c, zero}, in_p = {c / n0, zero}; // before the first boundary
    struct film_wave out = film_wave(n_out, from_below ? zero : f->k, 0, lambda, s2);
    if (c_out > 0) {
        out.s = (struct wave){n_out * c_out, zero};
        out.p = (struct wave){c_out / n_out, zero};
    }
    struct wave one = {SR_ONE, zero}, none = {zero, zero};
    struct wave rs = none, ts = one, rp = none, tp = one;
    struct wave below_s = out.s, below_p = out.p, phase = one;
    for (int j = f->layer_count; j-- > 0;) {
        const struct film_wave *w = &waves[f->sequence[from_below ? f->layer_count - 1 - j : j]];
        add_boundary(w->s, below_s, phase, &rs, &ts);
        add_boundary(w->p, below_p, phase, &rp, &tp);
        below_s = w->s;
        below_p = w->p;
        phase = w->phase;
    }
    add_boundary(in_s, below_s, phase, &rs, &ts);
    add_boundary(in_p, below_p, phase, &rp, &tp);
    struct film_power power = {wave_power(rs), wave_power(rp), out.s.re / in_s.re * wave_power(ts),
                               out.p.re / in_p.re * wave_power(tp)};
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) { // rounding must not make light
        float s = 1 / sr_max(1, power.Rs[i] + power.Ts[i]), p = 1 / sr_max(1, power.Rp[i] + power.Tp[i]);
        power.Rs[i] *= s;
        power.Ts[i] *= s;
        power.Rp[i] *= p;
        power.Tp[i] *= p;
    }
    return power;
}

/* ---- a metal under films ---- */

static inline sr_spectrum film_reflectance(const struct film_stack *f, sr_spectrum lambda, float c)
{
    struct film_power p = film_reflect(f, lambda, c, 0, false);
    return 0.5f * (p.Rs + p.Rp);
}

static inline sr_spectrum film_metal_f_pdf(const struct film_stack *f, struct sr_ggx ggx, sr_spectrum lambda,
                                           sr_vec3 wo, sr_vec3 wi, float *pdf)
{
    *pdf = 0;
    if (ggx_is_smooth(ggx))
        return SR_BLACK;
    float cos_m, shape = ggx_reflection(ggx_usable(ggx), wo, wi, pdf, &cos_m);
    return shape > 0 ? film_reflectance(f, lambda, cos_m) * shape : SR_BLACK;
}

static inline bool film_metal_sample(const struct film_stack *f, struct sr_ggx ggx, sr_spectrum lambda, sr_vec3 wo,
                                     sr_vec2 u, struct sr_bsdf_sample *s)
{
    if (wo.z == 0)
        return false;
    bool smooth = ggx_is_smooth(ggx);
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION | (smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY)};
    float weight = 1, cos_m = fabsf(wo.z);
    if (smooth) {
        s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
        s->pdf = 1;
    } else if (!ggx_sample_reflection(ggx_usable(ggx), wo, u, &s->wi, &weight, &s->pdf, &cos_m))
        return false;
    s->f = film_reflectance(f, lambda, cos_m) * (weight * s->pdf / fabsf(s->wi.z));
    return true;
}

/* ---- glass under films ----
 *
 * As dielectric.c, but with R and T of the films for each wavelength; lobes are chosen by their means over the
 * wavelengths, R' / (R' + T'). Without a step of the index (eta = 1: a film in air) the surface is smooth. */

struct film_shares {
    sr_spectrum R, T;
    float reflection, transmission; // [1] probabilities
};
static inline struct film_shares film_shares(const struct film_stack *f, sr_spectrum lambda, float c, float c_out,
                                             bool from_below)
{
    struct film_power p = film_reflect(f, lambda, c, c_out, from_below);
    struct film_shares s = {0.5f * (p.Rs + p.Rp), 0.5f * (p.Ts + p.Tp), 1, 0};
    float R = sr_spectrum_mean(s.R), T = sr_spectrum_mean(s.T);
    if (T > 0) {
        s.reflection = R / (R + T);
        s.transmission = T / (R + T);
    }
    return s;
}
static inline bool film_glass_is_smooth(float eta, struct sr_ggx ggx)
{
    return eta == 1 || ggx_is_smooth(ggx);
}

static inline sr_spectrum film_glass_f_pdf(const struct film_stack *f, float eta_below, struct sr_ggx ggx,
                                           sr_spectrum lambda, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                           float *pdf)
{
    *pdf = 0;
    struct turn t;
    if (film_glass_is_smooth(eta_below, ggx) || !turn_at(wo, wi, eta_below, &t))
        return SR_BLACK;
    ggx = ggx_usable(ggx);
    float cos_t = -t.cos_i;
    if (!t.transmits)
        fresnel_and_cos(t.cos_o, t.eta, &cos_t);
    struct film_shares share = film_shares(f, lambda, t.cos_o, cos_t, wo.z < 0);
    float zo = fabsf(wo.z), zi = fabsf(wi.z);
    float so = ggx_stretched(ggx, wo), si = ggx_stretched(ggx, wi), seen = 2 * ggx_D(ggx, t.m) * t.cos_o * t.jacobian;
    *pdf = (t.transmits ? share.transmission : share.reflection) * seen / (zo + so);
    sr_spectrum value = (t.transmits ? share.T : share.R) * (seen / (so * zi + si * zo));
    return mode == SR_RADIANCE && t.transmits ? value / (t.eta * t.eta) : value;
}

static inline bool film_glass_sample(const struct film_stack *f, float eta_below, struct sr_ggx ggx, sr_spectrum lambda,
                                     sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                     struct sr_bsdf_sample *s)
{
    if (wo.z == 0)
        return false;
    bool smooth = film_glass_is_smooth(eta_below, ggx);
    ggx = ggx_usable(ggx);
    sr_vec3 m = {0, 0, 1};
    if (!smooth)
        m = ggx_sample_visible(ggx, wo, u);
    if (wo.z < 0)
        m = sr_neg(m);
    float eta = wo.z < 0 ? 1 / eta_below : eta_below, cos_o = sr_dot(wo, m), cos_t;
    if (!(cos_o > 0))
        return false;
    fresnel_and_cos(cos_o, eta, &cos_t);
    struct film_shares share = film_shares(f, lambda, cos_o, cos_t, wo.z < 0);
    bool transmits = u_lobe >= share.reflection;
    float probability = transmits ? share.transmission : share.reflection;
    if (!(probability > 0) || (transmits && !(cos_t > 0)))
        return false;
    *s = (struct sr_bsdf_sample){.eta = transmits ? eta : 1, .pdf = probability};
    s->lobe = (transmits ? SR_LOBE_TRANSMISSION : SR_LOBE_REFLECTION) | (smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
    if (transmits)
        s->wi = sr_normalize(sr_mad(sr_scale(-1 / eta, wo), cos_o / eta - cos_t, m));
    else
        s->wi = smooth ? (sr_vec3){-wo.x, -wo.y, wo.z} : sr_reflect(wo, m);
    if (s->wi.z == 0 || sr_same_hemisphere(wo, s->wi) == transmits)
        return false;
    float zo = fabsf(wo.z), zi = fabsf(s->wi.z), weight = 1;
    if (!smooth) {
        float so = ggx_stretched(ggx, wo), si = ggx_stretched(ggx, s->wi);
        float visible = 2 * ggx_D(ggx, m) * cos_o / (zo + so);
        weight = zi * (zo + so) / (so * zi + si * zo);
        s->pdf *= visible * (transmits ? cos_t / sr_sqr(cos_t - cos_o / eta) : 1 / (4 * cos_o));
        if (!(s->pdf > 0 && s->pdf < INFINITY))
            return false;
    }
    s->f = (transmits ? share.T : share.R) * (weight * s->pdf / (probability * zi));
    if (mode == SR_RADIANCE && transmits)
        s->f /= eta * eta;
    return true;
}

static inline uint32_t film_glass_lobes(float eta, struct sr_ggx ggx)
{
    return SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION |
           (film_glass_is_smooth(eta, ggx) ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

#endif
