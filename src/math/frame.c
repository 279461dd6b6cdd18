/* SPDX-License-Identifier: MIT */
/* Frames around a direction, origins of rays that leave a surface, and the equal-area map of the sphere.
 *
 *     offset: o = p +- (|n| . p_error) n, each coordinate rounded away from p            [m]
 *     map:    r = 1 - |1 - (|u| + |v|)|, z = +-(1 - r^2), phi = pi/4 (1 + (|v| - |u|) / r), u, v in -1 … 1
 *
 * T. Duff et al., Building an Orthonormal Basis, Revisited, 2017; M. Pharr et al., Physically Based Rendering,
 * 2023, 6.8.6; P. Clarberg, Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD, 2008. Directions must have unit
 * length. */
#include "math/math.h"

struct sr_frame sr_frame_from_zx(sr_vec3 z, sr_vec3 x)
{
    sr_vec3 across = sr_mad(x, -sr_dot(x, z), z);
    float length2 = sr_length2(across);
    // what is left of a nearly parallel x is rounding, not a direction
    if (!(length2 > 1e-12f * sr_length2(x)) || !isfinite(length2))
        return sr_frame_from_z(z);
    sr_vec3 y = sr_normalize(sr_cross(z, across));
    return (struct sr_frame){.x = sr_cross(y, z), .y = y, .z = z};
}

sr_vec3 sr_equal_area_square_to_sphere(sr_vec2 p)
{
    float u = 2 * p.x - 1, v = 2 * p.y - 1;
    float a = fabsf(u), b = fabsf(v);
    bool upper = a + b <= 1;
    // sums of what is small at the pole: r loses no digits there
    float r = upper ? a + b : (1 - a) + (1 - b);
    float s, c; // of phi
    sr_sin_cos_turn((r > 0 ? (b - a) / r + 1 : 1) * 0.125f, &s, &c);
    float sin_theta = r * sr_safe_sqrt(2 - r * r);
    float z = 1 - r * r;
    return (sr_vec3){copysignf(c, u) * sin_theta, copysignf(s, v) * sin_theta, upper ? z : -z};
}

sr_vec2 sr_equal_area_sphere_to_square(sr_vec3 d)
{
    float x = fabsf(d.x), y = fabsf(d.y), z = fabsf(d.z);
    float r = sqrtf((x * x + y * y) / (1 + z)); // sqrt(1 - z) without its cancellation at the pole
    float larger = sr_max(x, y);
    float turn = larger > 0 ? sr_atan_eighth(sr_min(x, y) / larger) * (2 * SR_INV_PI) : 0; // [quarter turns]
    float v = r * (x < y ? 1 - turn : turn);
    float u = r - v;
    if (d.z < 0) {
        float folded = 1 - v;
        v = 1 - u;
        u = folded;
    }
    return (sr_vec2){(copysignf(u, d.x) + 1) * 0.5f, (copysignf(v, d.y) + 1) * 0.5f};
}
