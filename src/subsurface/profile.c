/* SPDX-License-Identifier: MIT */
/* Photon beam diffusion: what a thin beam that enters a half space makes at the distance r on its surface. Mean free
 * path 1.
 *
 *     multiple: INTEGRAL_0^oo  sigma_t' exp(-sigma_t' z) kappa rho'^2 (C_phi phi(r, z) + C_E E(r, z)) dz       [1/m^2]
 *     phi = (exp(-sigma_tr d_r) / d_r - exp(-sigma_tr d_v) / d_v) / (4 pi D)
 *     E   = (z_r (1 + sigma_tr d_r) exp(-sigma_tr d_r) / d_r^3
 *         - z_v (1 + sigma_tr d_v) exp(-sigma_tr d_v) / d_v^3) / (4 pi)
 *     z_r = z, z_v = -z - 4 D A, A = (1 + 3 F_2) / (1 - 2 F_1), d = sqrt(r^2 + z^2)
 *     D = (2 sigma_a + sigma_s') / (3 sigma_t'^2), sigma_tr = sqrt(sigma_a / D),
 *     sigma_s' = sigma_s (1 - g), rho' = sigma_s' / sigma_t'
 *     C_phi = (1 - 2 F_1) / 4, C_E = (1 - 3 F_2) / 2, F_k = INTEGRAL_0^1 F(mu from inside) mu^k dmu,
 *     kappa = 1 - exp(-2 sigma_t' (d_r + z))
 *
 *     single: INTEGRAL_{t_c}^oo  sigma_s exp(-(t + d)) p(-cos) (1 - F(cos from inside)) cos / d^2 dt,
 *     d = sqrt(r^2 + t^2), cos = t / d, t_c = r sqrt(eta^2 - 1): below, nothing but total reflection
 *
 * The beam goes straight down. Habel, Christensen & Jarosz, Photon Beam Diffusion, 2013, with Grosjean's D and the
 * source after one scattering; kappa is their empirical correction near the beam; d'Eon & Irving 2011 for A, C_phi,
 * C_E. Limits: a flat half space, isotropy after g has shortened sigma_s; the single part is infinite at r = 0, where 2
 * pi r times it is not. The integrals are taken in ln z: 64 Gauss-Legendre nodes for a relative error below 1e-5. */
#include "subsurface/private.h"

static double fresnel_from_inside(double mu, double eta)
{
    double sine2 = eta * eta * (1 - mu * mu);
    if (sine2 >= 1)
        return 1;
    double cosine = sqrt(1 - sine2);
    double s = (eta * mu - cosine) / (eta * mu + cosine), p = (mu - eta * cosine) / (mu + eta * cosine);
    return (s * s + p * p) / 2;
}

struct subsurface_kernel subsurface_kernel_of(double g, double eta)
{
    struct subsurface_kernel k = {.g = g, .eta = eta, .critical = eta > 1 ? sqrt(eta * eta - 1) : 0};
    // F_1 and F_2: all beyond the critical angle, and a root's end there, which mu = m + (1 - m) x^2 takes away
    double m = eta > 1 ? sqrt(1 - 1 / (eta * eta)) : 0, F1 = m * m / 2, F2 = m * m * m / 3;
    double x[SUBSURFACE_NODES], w[SUBSURFACE_NODES];
    sr_gauss_legendre(SUBSURFACE_NODES, 0, 1, x, w);
    for (int i = 0; i < SUBSURFACE_NODES; ++i) {
        double mu = m + (1 - m) * x[i] * x[i], F = fresnel_from_inside(mu, eta) * w[i] * 2 * (1 - m) * x[i];
        F1 += F * mu;
        F2 += F * mu * mu;
    }
    k.A = (1 + 3 * F2) / (1 - 2 * F1);
    k.C_phi = (1 - 2 * F1) / 4;
    k.C_E = (1 - 3 * F2) / 2;
    sr_gauss_legendre(SUBSURFACE_NODES, log(1e-7), log(50), k.z, k.w);
    for (int i = 0; i < SUBSURFACE_NODES; ++i) {
        k.z[i] = exp(k.z[i]);
        k.w[i] *= k.z[i];
    }
    return k;
}

double subsurface_single(const struct subsurface_kernel *k, double albedo, double r)
{
    double t_c = r * k->critical, sum = 0;
    for (int i = 0; i < SUBSURFACE_NODES; ++i) {
        double t = t_c + k->z[i], d2 = r * r + t * t, d = sqrt(d2), cosine = t / d;
        double q = 1 + k->g * k->g + 2 * k->g * cosine; // light comes down and leaves upward
        double p = (1 - k->g * k->g) / (4 * M_PI * q * sqrt(q));
        sum += k->w[i] * exp(-t - d) * p * (1 - fresnel_from_inside(cosine, k->eta)) * cosine / d2;
    }
    return albedo * sum;
}

double subsurface_multiple(const struct subsurface_kernel *k, double albedo, double r)
{
    double sigma_a = 1 - albedo, scattering = albedo * (1 - k->g), extinction = sigma_a + scattering;
    if (!(scattering > 0))
        return 0;
    double rho = scattering / extinction, D = (2 * sigma_a + scattering) / (3 * extinction * extinction);
    double sigma_tr = sqrt(sigma_a / D), mirror = 4 * D * k->A, sum = 0;
    for (int i = 0; i < SUBSURFACE_NODES; ++i) {
        double z = k->z[i] / extinction, v = z + mirror; // v: height of the mirror source
        double dr = sqrt(r * r + z * z), dv = sqrt(r * r + v * v);
        double er = exp(-sigma_tr * dr) / dr, ev = exp(-sigma_tr * dv) / dv;
        double phi = (er - ev) / (4 * M_PI * D);
        double E = (z * (1 + sigma_tr * dr) * er / (dr * dr) + v * (1 + sigma_tr * dv) * ev / (dv * dv)) / (4 * M_PI);
        double kappa = -expm1(-2 * extinction * (dr + z));
        sum += k->w[i] * exp(-k->z[i]) * kappa * (k->C_phi * phi + k->C_E * E);
    }
    return rho * rho * sum;
}

double sr_diffusion_single(double albedo, double g, double eta, double r)
{
    struct subsurface_kernel k = subsurface_kernel_of(g, eta);
    return subsurface_single(&k, albedo, r);
}

double sr_diffusion_multiple(double albedo, double g, double eta, double r)
{
    struct subsurface_kernel k = subsurface_kernel_of(g, eta);
    return subsurface_multiple(&k, albedo, r);
}
