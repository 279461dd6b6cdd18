/* SPDX-License-Identifier: MIT */
/* Fresnel's formulas and Snell's law at a plane boundary, for light without polarisation.
 *
 *     r_s = (cos_i - eta cos_t) / (cos_i + eta cos_t)      r_p = (eta cos_i - cos_t) / (eta cos_i + cos_t)      [1]
 *     F = (|r_s|^2 + |r_p|^2) / 2,    sin_t = sin_i / eta;    conductors: eta becomes eta + i k
 *
 * A. Fresnel 1823; diffuse incidence in closed form: J. W. T. Walsh 1926. Far from resonances of thin films. */
#include "bsdf/microfacet.h"

float sr_fresnel_dielectric(float cos_theta_i, float eta)
{
    return fresnel(sr_clamp(cos_theta_i, -1, 1), eta);
}

sr_spectrum sr_fresnel_conductor(float cos_theta_i, sr_spectrum eta, sr_spectrum k)
{
    return conductor_fresnel(fabsf(cos_theta_i), eta, k);
}

double sr_fresnel_diffuse(double n)
{
    if (n < 1) // from inside: what leaves the dense side is 1/n^2 of all directions
        return 1 - (1 - sr_fresnel_diffuse(1 / n)) * n * n;
    double n2 = n * n, n4 = n2 * n2;
    if (n - 1 < 1e-4) // the closed form cancels; reflection here is that of grazing directions, O(n - 1)
        return (n - 1) / 3;
    return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
           n2 * (n2 - 1) * (n2 - 1) / ((n2 + 1) * (n2 + 1) * (n2 + 1)) * log((n - 1) / (n + 1)) -
           2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
           8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * log(n);
}

bool sr_refract(sr_vec3 wi, sr_vec3 n, float eta, float *eta_path, sr_vec3 *wt)
{
    float cos_i = sr_dot(n, wi);
    if (cos_i < 0) {
        eta = 1 / eta;
        cos_i = -cos_i;
        n = sr_neg(n);
    }
    float g2 = (eta - 1) * (eta + 1) + sr_sqr(sr_min(cos_i, 1)); // (eta cos_t)^2
    if (!(g2 > 0))
        return false;
    float cos_t = sqrtf(g2) / eta;
    *wt = sr_mad(sr_scale(-1 / eta, wi), cos_i / eta - cos_t, n);
    *eta_path = eta;
    return true;
}
