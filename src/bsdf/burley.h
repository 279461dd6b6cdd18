/* SPDX-License-Identifier: MIT */
/* Private to this room: what Burley's models of 2012 and 2015 share: Schlick's weight, tints, and the clear coat.
 *
 *     coat:  f = 1/4 w D(m) F(cd) / ((ci + s(ci)) (co + s(co)))
 *     F = 0.04 + 0.96 (1 - cd)^5,   s(c) = sqrt(a^2 + c^2 - a^2 c^2), a = 1/4
 *     D = (1 - g^2) / (pi ln(1/g^2) (sin^2 + g^2 cos^2))   [1/sr],   g = 0.1 ... 0.001 by gloss
 *
 * B. Burley, Physically Based Shading at Disney, 2012. */
#ifndef SR_BSDF_BURLEY_H
#define SR_BSDF_BURLEY_H

#include "bsdf/microfacet.h"

#define TINT_MAX 10.0f // [1] what pure blue has

static inline float schlick_weight(float c) // (1 - c)^5
{
    float x = sr_clamp(1 - c, 0, 1), x2 = x * x;
    return x2 * x2 * x;
}

/* A colour over its luminance. The luminance is estimated from the path's wavelengths, weighed by V(lambda): exact for
 * grey, close for what varies slowly. */
static inline sr_spectrum tint_of(sr_spectrum colour, sr_spectrum lambda)
{
    float sum = 0, weights = 0;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float v = (float)sr_luminous_efficiency(lambda[i]) + 1e-6f;
        sum += v * colour[i];
        weights += v;
    }
    return sum > 0 ? sr_spectrum_clamp(colour * (weights / sum), 0, TINT_MAX) : SR_ONE;
}

static inline struct sr_ggx burley_ggx(float roughness, float anisotropic)
{
    float aspect = sqrtf(1 - 0.9f * anisotropic), r2 = roughness * roughness;
    return (struct sr_ggx){sr_max(0.001f, r2 / aspect), sr_max(0.001f, r2 * aspect)};
}

/* The clear coat's lobe without its weight; pdf: of its half vectors. m is the half vector on +z, cd = wo.m. */
static inline float clearcoat_f(float gloss, sr_vec3 m, float cd, float ci, float co, float *pdf)
{
    float g = sr_lerp(gloss, 0.1f, 0.001f), g2 = g * g;
    float D = (1 - g2) / (SR_PI * -logf(g2) * (m.x * m.x + m.y * m.y + g2 * m.z * m.z));
    const float a2 = 0.0625f;
    float si = sqrtf(a2 + ci * ci * (1 - a2)), so = sqrtf(a2 + co * co * (1 - a2));
    *pdf = D * m.z / (4 * cd);
    return 0.25f * D * (0.04f + 0.96f * schlick_weight(cd)) / ((ci + si) * (co + so));
}
static inline sr_vec3 clearcoat_sample(float gloss, sr_vec2 u)
{
    float g = sr_lerp(gloss, 0.1f, 0.001f), g2 = g * g;
    float sin2 = sr_clamp((powf(g2, 1 - u.x) - g2) / (1 - g2), 0, 1), r = sqrtf(sin2), s, c;
    sin_cos_turn(u.y, &s, &c);
    return (sr_vec3){r * c, r * s, sqrtf(1 - sin2)};
}
static inline float clearcoat_weight(float c) // for choosing: half its Fresnel reflectance
{
    return 0.25f * (0.04f + 0.96f * schlick_weight(c));
}

#endif
