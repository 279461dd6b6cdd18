/* SPDX-License-Identifier: MIT */
/* Private to this room: directions for rough matte surfaces, from a cosine lobe that is clipped and sheared.
 *
 * With probability p even over the hemisphere, else w = M h / |M h| where h has a cosine lobe, clipped to those that M
 * keeps above the surface; M and p are fits in the roughness r (0: plain cosine) and in mu = cos_theta_o, in the frame
 * whose x axis is the viewer's azimuth:
 *
 *     pdf = p / (2 pi) + (1 - p) (det M / |adj(M) w|^2)^2 (adj(M) w).z / (pi q)   [1/sr]
 *
 * q is the part of the lobe that is left. J. Portsmouth, P. Kutz & S. Hill, EON: a practical energy-preserving rough
 * diffuse BRDF, 2024. */
#ifndef SR_BSDF_CLIPPED_LTC_H
#define SR_BSDF_CLIPPED_LTC_H

#include "bsdf/hemisphere.h"

struct clipped_ltc {
    float a, b, c, d;   // M = [[a, 0, b], [0, c, 0], [d, 0, 1]]
    float even;         // p
    float left;         // q
    float cos_x, sin_x; // of the viewer's azimuth
};

static inline struct clipped_ltc clipped_ltc_of(sr_vec3 wo, float r)
{
    float mu = wo.z, sine = sqrtf(sin2_theta(wo));
    struct clipped_ltc t = {
        .a = 1 + r * (0.303392f + (-0.518982f + 0.111709f * mu) * mu + (-0.276266f + 0.335918f * mu) * r),
        .b = r * (-1.16407f + 1.15859f * mu + (0.150815f - 0.150105f * mu) * r) / (mu * mu * mu - 1.43545f),
        .c = 1 + (0.20013f + (-0.506373f + 0.261777f * mu) * mu) * r,
        .d = r * (0.540852f + (-1.01625f + 0.475392f * mu) * mu) / (-1.0743f + mu * (0.0725628f + mu)),
        .even = r > 0 ? powf(r, 0.1f) * (0.162925f + mu * (-0.372058f + (0.538233f - 0.290822f * mu) * mu)) : 0,
        .cos_x = sine > 0 ? wo.x / sine : 1,
        .sin_x = sine > 0 ? wo.y / sine : 0,
    };
    t.even = sr_clamp(t.even, 0, 1);
    t.left = 0.5f + 0.5f / sqrtf(1 + t.d * t.d);
    return t;
}

static inline float clipped_ltc_pdf(const struct clipped_ltc *t, sr_vec3 wi)
{
    float x = wi.x * t->cos_x + wi.y * t->sin_x, y = wi.y * t->cos_x - wi.x * t->sin_x;
    float e = t->a - t->b * t->d, det = t->c * e;
    sr_vec3 w = {t->c * (x - t->b * wi.z), e * y, t->c * (t->a * wi.z - t->d * x)};
    float l2 = sr_length2(w);
    float lobe = w.z > 0 && l2 > 0 ? sr_sqr(det / l2) * w.z * SR_INV_PI / t->left : 0;
    return t->even * (0.5f * SR_INV_PI) + (1 - t->even) * lobe;
}

static inline sr_vec3 clipped_ltc_draw(const struct clipped_ltc *t, float u_lobe, sr_vec2 u)
{
    if (u_lobe < t->even)
        return sr_warp_uniform_hemisphere(u);
    float r = sqrtf(u.x), sine, cosine;
    sr_sin_cos_turn(u.y, &sine, &cosine);
    float y = r * sine, x = -((1 - t->left) * sr_safe_sqrt(1 - y * y) + t->left * r * cosine);
    sr_vec3 h = {x, y, sr_safe_sqrt(1 - x * x - y * y)};
    sr_vec3 w = sr_normalize((sr_vec3){t->a * h.x + t->b * h.z, t->c * h.y, t->d * h.x + h.z});
    return (sr_vec3){w.x * t->cos_x - w.y * t->sin_x, w.x * t->sin_x + w.y * t->cos_x, w.z};
}

#endif
