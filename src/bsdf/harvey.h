/* SPDX-License-Identifier: MIT */
/* Private to this room: stray light of polished surfaces, which depends on one number only, how far the direction
 * cosines are from those of the mirror:
 *
 *     r = |(wo + wi)_xy|     [1]
 *
 * and how it is drawn: in the plane of direction cosines, about the mirror's point, by the density
 *
 *     q(r) = N (1 + r^2 / l^2)^(-g / 2)    [1 per projected sr],    r < 1 + sin theta_o,    pdf = q |zi|   [1/sr]
 *
 * whose integral INTEGRAL q 2 pi r dr has an inverse in closed form. What falls outside the unit disk is no direction:
 * lost. */
#ifndef SR_BSDF_HARVEY_H
#define SR_BSDF_HARVEY_H

#include "bsdf/hemisphere.h"

struct harvey {
    float l, g; // [1] width of the shoulder, slope beyond
};

static inline float harvey_r2(sr_vec3 wo, sr_vec3 wi)
{
    return sr_sqr(wo.x + wi.x) + sr_sqr(wo.y + wi.y);
}
/* (1 + x)^p - 1, over p: also for p = 0 */
static inline float harvey_power(float log_1_x, float p)
{
    return fabsf(p * log_1_x) < 1e-4f ? log_1_x * (1 + 0.5f * p * log_1_x) : expm1f(p * log_1_x) / p;
}
static inline float harvey_pdf(const struct harvey *h, float r2,
                               float most) // of the projected solid angle, within r < most
{
    float p = 1 - 0.5f * h->g, l2 = h->l * h->l, whole = harvey_power(log1pf(most * most / l2), p);
    return expf((p - 1) * log1pf(r2 / l2)) / (SR_PI * l2 * whole);
}
static inline float harvey_draw(const struct harvey *h, float u, float most) // r
{
    float p = 1 - 0.5f * h->g, l2 = h->l * h->l, x = u * harvey_power(log1pf(most * most / l2), p), q = p * x;
    return h->l * sqrtf(expm1f(fabsf(q) < 1e-4f ? x * (1 - 0.5f * q) : log1pf(q) / p));
}
static inline float harvey_reach(sr_vec3 wo)
{
    return 1 + sqrtf(sin2_theta(wo));
}
/* False where there is no such direction. */
static inline bool harvey_direction(const struct harvey *h, sr_vec3 wo, sr_vec2 u, sr_vec3 *wi)
{
    float r = harvey_draw(h, u.x, harvey_reach(wo)), sine, cosine;
    sr_sin_cos_turn(u.y, &sine, &cosine);
    float x = r * cosine - wo.x, y = r * sine - wo.y, z2 = 1 - x * x - y * y;
    if (!(z2 > 0))
        return false;
    *wi = sr_normalize((sr_vec3){x, y, copysignf(sqrtf(z2), wo.z)});
    return wi->z != 0;
}

/* A mirror's share that nothing roughens. */
static inline bool harvey_mirror(sr_vec3 wo, sr_spectrum specular, float probability, struct sr_bsdf_sample *s)
{
    *s = (struct sr_bsdf_sample){.wi = {-wo.x, -wo.y, wo.z},
                                 .f = specular / fabsf(wo.z),
                                 .pdf = probability,
                                 .eta = 1,
                                 .lobe = SR_LOBE_REFLECTION | SR_LOBE_SPECULAR};
    return true;
}

#endif
