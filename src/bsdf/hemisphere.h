/* SPDX-License-Identifier: MIT */
/* Private to this room: what models that reflect on the side they are looked at have in common.
 *
 * A model of this kind sees both directions above the surface (upper), draws from mixtures of the densities below, and
 * lets finish ask its own functions for f and pdf, so that a sample tells exactly what they tell. */
#ifndef SR_BSDF_HEMISPHERE_H
#define SR_BSDF_HEMISPHERE_H

#include "bsdf/bsdf.h"

/* Mirrors both directions to the side of +z. False where they are on different sides: nothing is reflected. */
static inline bool upper(sr_vec3 *wo, sr_vec3 *wi)
{
    if (!sr_same_hemisphere(*wo, *wi))
        return false;
    wo->z = fabsf(wo->z);
    wi->z = fabsf(wi->z);
    return true;
}

static inline float sin2_theta(sr_vec3 w) // not 1 - z^2, which cancels near the normal
{
    return w.x * w.x + w.y * w.y;
}

/* cos^n of an angle by its squared sine and cosine (times the same factor), accurate for a narrow lobe's large n. */
static inline float power_of_cos(float sin2, float cos2, float n)
{
    return cos2 > 0 ? expf(-0.5f * n * log1pf(sr_min(sin2 / cos2, 1e30f))) : n > 0 ? 0 : 1.0f;
}

/* The direction at an angle about an axis of unit length: (sin, cos) of the angle, and its azimuth as a share of the
 * turn. */
static inline sr_vec3 about(sr_vec3 axis, float s, float c, float turn)
{
    float sine, cosine, sign = copysignf(1, axis.z), a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
    sr_sin_cos_turn(turn, &sine, &cosine);
    sr_vec3 t = {1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x}; // Duff et al. 2017
    sr_vec3 q = {b, sign + axis.y * axis.y * a, -axis.y};
    return sr_normalize(sr_mad(sr_mad(sr_scale(c, axis), s * cosine, t), s * sine, q));
}

/* About an axis with density (n + 1) / (2 pi) cos^n [1/sr], n >= 0. */
static inline sr_vec3 draw_power_of_cos(sr_vec3 axis, float n, sr_vec2 u)
{
    float log_c = logf(sr_max(1 - u.x, 1e-30f)) / (n + 1);
    float c = expf(log_c);
    return about(axis, sr_safe_sqrt(-expm1f(2 * log_c)), c, u.y);
}
static inline float pdf_power_of_cos(float power, float n) // where power = cos^n
{
    return (n + 1) * (0.5f * SR_INV_PI) * power;
}

/* Between even and Lambert's: density (1 + 2 cos) / (4 pi) [1/sr], for models with 1 / (cos_theta_o + cos_theta_i). */
static inline sr_vec3 draw_half_cosine(sr_vec2 u)
{
    float s, t, c = 4 * u.x / (1 + sqrtf(1 + 8 * u.x)), r = sr_safe_sqrt((1 - c) * (1 + c));
    sr_sin_cos_turn(u.y, &s, &t);
    return (sr_vec3){r * t, r * s, c};
}
static inline float pdf_half_cosine(float cos_theta)
{
    return (1 + 2 * cos_theta) * (0.25f * SR_INV_PI);
}

/* Henyey & Greenstein 1941 for both directions away from the point, mean 1 over the sphere: cos_phase = wi.wo; g > 0
 * sends light on, g < 0 back. */
static inline float henyey_greenstein(float cos_phase, float g)
{
    float d = sr_max(1 + g * g + 2 * g * cos_phase, 1e-6f);
    return (1 - g * g) / (d * sqrtf(d));
}

/* Completes a sample whose wi has been drawn for wo above the surface; false where it points below. */
static inline bool finish(const struct sr_bsdf_model *model, const void *self, sr_vec3 wo, sr_vec3 wi, uint32_t lobe,
                          enum sr_transport mode, struct sr_bsdf_sample *s)
{
    if (!(wi.z > 0) || wo.z == 0)
        return false;
    wi.z = copysignf(wi.z, wo.z);
    *s = (struct sr_bsdf_sample){.wi = wi, .eta = 1, .lobe = SR_LOBE_REFLECTION | lobe};
    if (model->f_pdf) {
        s->f = model->f_pdf(self, wo, wi, mode, &s->pdf);
    } else {
        s->f = model->f(self, wo, wi, mode);
        s->pdf = model->pdf(self, wo, wi, mode);
    }
    return s->pdf > 0 && s->pdf < INFINITY;
}

#endif
