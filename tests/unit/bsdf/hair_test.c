/* SPDX-License-Identifier: MIT */
/* Hair: nothing is lost that is not absorbed, absorption is the path's through a cylinder, and lobes stand where a
 * smooth cylinder sends light. */
#include "quadrature.h"

/* INTEGRAL g dwi over the sphere, in the hair's own coordinates: sin theta along x by Gauss-Legendre, phi by midpoints.
 */
static double all_around(const struct sr_bsdf *b, sr_vec3 wo, double (*g)(const void *, sr_vec3))
{
    enum { ALONG = 120, AROUND = 256 };
    struct albedo_query q = {b, wo};
    double x[ALONG], w[ALONG], sum = 0;
    sr_gauss_legendre(ALONG, -QUADRATURE_PI / 2, QUADRATURE_PI / 2, x, w);
    for (int i = 0; i < ALONG; ++i)
        for (int j = 0; j < AROUND; ++j) {
            double c = cos(x[i]), phi = 2 * QUADRATURE_PI * (j + 0.5) / AROUND;
            sum += w[i] * c * g(&q, (sr_vec3){(float)sin(x[i]), (float)(c * cos(phi)), (float)(c * sin(phi))});
        }
    return sum * 2 * QUADRATURE_PI / AROUND;
}

/* F + (1 - F)^2 / (1 - F) = 1. */
TEST(hair_without_absorption_returns_all_light)
{
    static const double h[] = {-1, -0.7, 0, 0.3, 0.95}, beta_m[] = {0.25, 0.6, 1}, beta_n[] = {0.3, 0.7, 1};
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 3; ++j) {
            struct sr_bsdf b = specimen("hair", "sigma_a", 0.0, "h", h[i], "beta_m", beta_m[j], "beta_n",
                                        beta_n[(i + j) % 3], "scale_tilt", 2.0 * i, NULL);
            sr_vec3 wo = direction(20 + 60 * i, 77 * j);
            EXPECT_NEAR(all_around(&b, wo, albedo_integrand), 1, 2e-5);
            EXPECT_NEAR(all_around(&b, wo, pdf_integrand), 1, 2e-5);
            EXPECT_NEAR(b.model->albedo(b.data, wo)[0], 1, 2e-6);
        }
}

/* Down the axis' normal, h = 0: the way through and back is 2 diameters of 2 radii; T = exp(-2 sigma_a) a crossing. */
TEST(hair_absorbs_along_its_diameter)
{
    double F = pow(0.55 / 2.55, 2), sigma = 0.4, T = exp(-2 * sigma);
    struct sr_bsdf b = specimen("hair", "sigma_a", sigma, "beta_m", 0.5, "beta_n", 0.5, NULL);
    double expected = F + (1 - F) * (1 - F) * T / (1 - T * F);
    EXPECT_NEAR(all_around(&b, direction(0, 0), albedo_integrand), expected, 1e-5);
    EXPECT_NEAR(b.model->albedo(b.data, direction(0, 0))[0], expected, 1e-6);
    // along the fibre at 40 deg the way is longer by 1 / cos of the refracted angle
    sr_vec3 wo = direction(40, 0);
    double cos_t = sqrt(1 - pow(sin(40 * QUADRATURE_PI / 180) / 1.55, 2));
    F = (double)sr_fresnel_dielectric(wo.z, 1.55f);
    T = exp(-2 * sigma / cos_t);
    EXPECT_NEAR(all_around(&b, wo, albedo_integrand), F + (1 - F) * (1 - F) * T / (1 - T * F), 1e-5);
}

/* From the normal, nearly smooth and without tilt: R comes back at 2 asin h, TT leaves behind, turned by 2 (gamma_t -
 * gamma_o): the brightest azimuths. */
TEST(hair_lobes_stand_where_a_cylinder_sends_light)
{
    double h = 0.5, gamma_o = asin(h), gamma_t = asin(h / 1.55);
    struct sr_bsdf b = specimen("hair", "sigma_a", 0.0, "h", h, "beta_m", 0.3, "beta_n", 0.12, "scale_tilt", 0.0, NULL);
    const double centres[2] = {-2 * gamma_o, 2 * gamma_t - 2 * gamma_o + QUADRATURE_PI};
    for (int p = 0; p < 2; ++p) {
        double best = 0, at = 0;
        for (int k = -300; k <= 300; ++k) { // phi is counted from y to z, wo is z
            double phi = centres[p] + k * 0.002, a = phi + QUADRATURE_PI / 2;
            sr_vec3 wi = {0, (float)cos(a), (float)sin(a)};
            double f = (double)(sr_bsdf_f(&b, direction(0, 0), wi, SR_RADIANCE)[0] * fabsf(wi.z));
            if (f > best) {
                best = f;
                at = phi;
            }
        }
        EXPECT_NEAR(at, centres[p], 0.003);
    }
}

/* The scales tilt R toward the root by twice their angle: brightest at theta_i = -theta_o + 2 alpha. */
TEST(hair_scales_shift_the_highlight)
{
    for (int tilt = 0; tilt <= 6; tilt += 3) {
        struct sr_bsdf b =
            specimen("hair", "sigma_a", 20.0, "beta_m", 0.15, "beta_n", 1.0, "scale_tilt", (double)tilt, NULL);
        sr_vec3 wo = {sinf(0.4f), 0, cosf(0.4f)};
        double best = 0, at = 0;
        for (double theta = -0.9; theta < 0.3; theta += 0.001) {
            sr_vec3 wi = {(float)sin(theta), 0, (float)cos(theta)};
            double M = (double)(sr_bsdf_f(&b, wo, wi, SR_RADIANCE)[0] * wi.z);
            if (M > best) {
                best = M;
                at = theta;
            }
        }
        EXPECT_NEAR(at, -0.4 + 2 * tilt * QUADRATURE_PI / 180, 0.003);
    }
}

/* The two forms of Bessel's function meet at 12, seen through M: a jump there would show in its integral over beta_m.
 */
TEST(hair_is_normalised_at_every_roughness)
{
    for (double beta = 0.16; beta < 1; beta += 0.04) {
        struct sr_bsdf b = specimen("hair", "sigma_a", 0.0, "beta_m", beta, "beta_n", 1.0, NULL);
        EXPECT_NEAR(all_around(&b, direction(60, 30), albedo_integrand), 1, 3e-5);
    }
}

/* The fit from colours: sigma_a = (ln c / 5.969)^2 as beta_n goes to 0; at 0.3 by its polynomial. */
TEST(hair_takes_its_absorption_from_a_colour)
{
    double n = 0.3, q = 5.969 - 0.215 * n + 2.532 * n * n - 10.73 * pow(n, 3) + 5.574 * pow(n, 4) + 0.245 * pow(n, 5);
    struct sr_bsdf a = specimen("hair", "colour_from", 1.0, "reflectance", 0.2, NULL);
    struct sr_bsdf b = specimen("hair", "sigma_a", pow(log(0.2) / q, 2), NULL);
    EXPECT_RELATIVE(a.model->albedo(a.data, direction(30, 20))[0], b.model->albedo(b.data, direction(30, 20))[0], 1e-6);
}

/* Melanin is absorption: what d'Eon et al. give for red, green and blue, at three wavelengths, and monotonic between.
 */
TEST(hair_is_dyed_by_melanin)
{
    static const double nm[3] = {610, 545, 465}, eu[3] = {.419, .697, 1.37}, pheo[3] = {.187, .4, 1.05};
    sr_vec3 wo = direction(40, 70), wi = direction(130, 200);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            double e = k == 1 ? 0 : 1.3, p = k == 0 ? 0 : 0.8;
            struct sr_bsdf dyed =
                specimen("hair", "colour_from", 2.0, "eumelanin", e, "pheomelanin", p, "h", 0.3, NULL);
            struct sr_bsdf given = specimen("hair", "sigma_a", e * eu[i] + p * pheo[i], "h", 0.3, NULL);
            specimen_ready(&dyed, (float)nm[i]);
            EXPECT_RELATIVE(sr_bsdf_f(&dyed, wo, wi, SR_RADIANCE)[0], sr_bsdf_f(&given, wo, wi, SR_RADIANCE)[0], 1e-5);
        }
    struct sr_bsdf dyed = specimen("hair", "colour_from", 2.0, "h", 0.3, NULL);
    double last = 0;
    for (int nm_at = 380; nm_at <= 780; nm_at += 20) {
        specimen_ready(&dyed, (float)nm_at);
        double f = (double)sr_bsdf_f(&dyed, wo, wi, SR_RADIANCE)[0];
        EXPECT(f > last);
        last = f;
    }
}
