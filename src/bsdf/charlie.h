/* SPDX-License-Identifier: MIT */
/* Private to this room: the "Charlie" distribution of fibres and its two maskings; equations in sheen.c.
 *
 * A. C. Estevez & C. Kulla 2017; D. Neubelt & M. Pettineo 2013. */
#ifndef SR_BSDF_CHARLIE_H
#define SR_BSDF_CHARLIE_H

#include "bsdf/bsdf.h"

struct charlie {
    float alpha;    // [1]
    float fit[5];   // A ... E
    float fit_half; // L(1/2)
};

static inline float charlie_fitted(const float *p, float x)
{
    return p[0] / (1 + p[1] * powf(x, p[2])) + p[3] * x + p[4];
}
static inline struct charlie charlie_of(float alpha)
{
    static const float sharp[5] = {25.3245f, 3.32435f, 0.16801f, -1.27393f, -4.85967f};
    static const float broad[5] = {21.5473f, 3.82987f, 0.19823f, -1.97760f, -4.32054f};
    struct charlie m = {.alpha = alpha};
    for (int i = 0; i < 5; ++i)
        m.fit[i] = sr_lerp(sr_sqr(1 - alpha), broad[i], sharp[i]);
    m.fit_half = charlie_fitted(m.fit, 0.5f);
    return m;
}
static inline float charlie_D(const struct charlie *m, sr_vec3 wo, sr_vec3 wi) // [1/sr]
{
    sr_vec3 h = sr_add(wo, wi); // not normalised
    float sin2 = (h.x * h.x + h.y * h.y) / sr_length2(h);
    return (2 + 1 / m->alpha) * powf(sin2, 0.5f / m->alpha) * (SR_INV_PI / 2);
}
static inline float charlie_lambda(const struct charlie *m, float c)
{
    return expf(c < 0.5f ? charlie_fitted(m->fit, c) : 2 * m->fit_half - charlie_fitted(m->fit, sr_max(1 - c, 0)));
}
static inline float neubelt_V(float ci, float co)
{
    return 1 / (4 * (ci + co - ci * co));
}
static inline float estevez_V(const struct charlie *m, float ci, float co)
{
    ci = sr_max(ci, 1e-4f); // the fit ends: below, Lambda grows less than 1 / c
    co = sr_max(co, 1e-4f);
    return 1 / (4 * ci * co * (1 + charlie_lambda(m, ci) + charlie_lambda(m, co)));
}

#endif
