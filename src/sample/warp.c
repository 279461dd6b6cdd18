/* SPDX-License-Identifier: MIT */
/* Warps of the unit square to spheres, cones and simple densities (those of the innermost loop are in sample.h).
 *
 *     sphere: z = 1 - 2 u;   cone: 1 - z = u (1 - cos_max);   exponential: x = -log(1 - u) / a */
#include "sample/sample.h"

sr_vec3 sr_warp_uniform_sphere(sr_vec2 u)
{
    float s, c, sin_theta = 2 * sqrtf(u.x * (1 - u.x));
    sr_sin_cos_turn(u.y, &s, &c);
    return (sr_vec3){sin_theta * c, sin_theta * s, 1 - 2 * u.x};
}

sr_vec3 sr_warp_uniform_hemisphere(sr_vec2 u)
{
    float s, c, sin_theta = sqrtf((1 - u.x) * (1 + u.x));
    sr_sin_cos_turn(u.y, &s, &c);
    return (sr_vec3){sin_theta * c, sin_theta * s, u.x};
}

sr_vec3 sr_warp_uniform_cone(sr_vec2 u, float one_minus_cos_max)
{
    float s, c, one_minus_cos = u.x * one_minus_cos_max;
    float sin_theta = sr_safe_sqrt(one_minus_cos * (2 - one_minus_cos));
    sr_sin_cos_turn(u.y, &s, &c);
    return (sr_vec3){sin_theta * c, sin_theta * s, 1 - one_minus_cos};
}

float sr_warp_exponential(float u, float a)
{
    return -log1pf(-u) / a;
}

// x in 0 … 1 with density proportional to lerp(x, a, b)
static float sample_linear(float u, float a, float b)
{
    float root = a + sqrtf(sr_lerp(u, a * a, b * b));
    return root > 0 ? sr_min(u * (a + b) / root, SR_ONE_MINUS_EPSILON) : u;
}

sr_vec2 sr_warp_bilinear(sr_vec2 u, const float w[4])
{
    float y = sample_linear(u.y, w[0] + w[1], w[2] + w[3]);
    float x = sample_linear(u.x, sr_lerp(y, w[0], w[2]), sr_lerp(y, w[1], w[3]));
    return (sr_vec2){x, y};
}

float sr_warp_bilinear_pdf(sr_vec2 p, const float w[4])
{
    if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1))
        return 0;
    float sum = w[0] + w[1] + w[2] + w[3];
    return sum > 0 ? 4 * sr_lerp(p.y, sr_lerp(p.x, w[0], w[1]), sr_lerp(p.x, w[2], w[3])) / sum : 1;
}
