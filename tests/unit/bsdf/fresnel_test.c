/* SPDX-License-Identifier: MIT */
/* Fresnel's formulas against closed forms, complex arithmetic and quadrature. */
#include "bsdf/bsdf.h"
#include "test.h"

#include <complex.h>

static float cosd(double deg)
{
    return (float)cos(deg * 3.14159265358979324 / 180);
}

TEST(fresnel_dielectric_knows_the_textbook_values)
{
    EXPECT_NEAR(sr_fresnel_dielectric(1, 1.5f), 0.04, 1e-7);
    EXPECT_NEAR(sr_fresnel_dielectric(cosd(45), 1.5f), 0.0502399110122, 1e-7); // n = 1.5, 45 deg
    EXPECT_NEAR(sr_fresnel_dielectric(cosd(80), 1.5f), 0.387704354691, 1e-6);
    // from inside, where the cosine is negative: 30 deg, then beyond the critical angle of 41.81 deg
    EXPECT_NEAR(sr_fresnel_dielectric(-cosd(30), 1.5f), 0.055190, 1e-6);
    EXPECT_NEAR(sr_fresnel_dielectric(-cosd(42), 1.5f), 1, 0);
    EXPECT_NEAR(sr_fresnel_dielectric(0, 1.5f), 1, 1e-7);
    EXPECT_NEAR(sr_fresnel_dielectric(0.3f, 1), 0, 1e-12);
}

/* At Brewster's angle atan n the parallel part vanishes: F = R_s / 2 = ((n^2 - 1) / (n^2 + 1))^2 / 2. */
TEST(fresnel_at_brewsters_angle_is_half_of_the_perpendicular_part)
{
    EXPECT_NEAR(sr_fresnel_dielectric(cosf(atanf(1.5f)), 1.5f), 0.147928994083 / 2, 1e-7);
}

/* Light that comes back along its way is reflected as much. */
TEST(fresnel_is_the_same_from_both_ends_of_a_ray)
{
    for (int i = 1; i < 100; ++i) {
        sr_vec3 n = {0, 0, 1}, wi = {0, sqrtf(1 - sr_sqr((float)i / 100)), (float)i / 100}, wt;
        float eta_path;
        EXPECT(sr_refract(wi, n, 1.7f, &eta_path, &wt));
        EXPECT_NEAR(sr_length(wt), 1, 1e-6);
        EXPECT_NEAR(eta_path, 1.7, 1e-6);
        EXPECT_NEAR(sr_fresnel_dielectric(wi.z, 1.7f), sr_fresnel_dielectric(wt.z, 1.7f), 1e-4);
    }
}

TEST(refraction_obeys_snell)
{
    sr_vec3 n = {0, 0, 1}, wi = {0, sinf(SR_PI / 3), 0.5f}, wt;
    float eta_path;
    EXPECT(sr_refract(wi, n, 1.5f, &eta_path, &wt)); // 60 deg into n = 1.5
    EXPECT_NEAR(atan2(-(double)wt.y, -(double)wt.z) * 180 / 3.14159265358979, 35.2643896828, 1e-4);
    EXPECT(!sr_refract((sr_vec3){0, sinf(0.8f), -cosf(0.8f)}, n, 1.5f, &eta_path, &wt)); // 45.8 deg from inside
    EXPECT(sr_refract((sr_vec3){0, sinf(0.7f), -cosf(0.7f)}, n, 1.5f, &eta_path, &wt));  // 40.1 deg
    EXPECT_NEAR(eta_path, 1 / 1.5, 1e-6);
}

TEST(fresnel_conductor_knows_gold_like_values)
{
    sr_spectrum eta = SR_BLACK + 0.43f, k = SR_BLACK + 2.455f; // about gold at 550 nm
    EXPECT_NEAR(sr_fresnel_conductor(1, eta, k)[0], 0.786915760491, 1e-6);
    EXPECT_NEAR(sr_fresnel_conductor(0.5f, eta, k)[SR_LAMBDA_COUNT - 1], 0.788131903203, 1e-6);
    EXPECT_NEAR(sr_fresnel_conductor(0, eta, k)[0], 1, 1e-6);
}

/* (|r_s|^2 + |r_p|^2) / 2 with complex cosines, in double. */
static double complex_fresnel(double c, double n, double k)
{
    double complex m = n + I * k, ct = csqrt(1 - (1 - c * c) / (m * m));
    double complex rs = (c - m * ct) / (c + m * ct), rp = (m * c - ct) / (m * c + ct);
    return (creal(rs * conj(rs)) + creal(rp * conj(rp))) / 2;
}
TEST(fresnel_conductor_agrees_with_complex_arithmetic)
{
    struct sr_rng rng = sr_rng_seed(1, 2);
    for (int i = 0; i < 2000; ++i) {
        sr_spectrum eta = SR_BLACK, k = SR_BLACK;
        for (int j = 0; j < SR_LAMBDA_COUNT; ++j) {
            eta[j] = 0.02f + 4 * sr_rng_float(&rng) * sr_rng_float(&rng);
            k[j] = 10 * sr_rng_float(&rng);
        }
        float c = sr_rng_float(&rng);
        sr_spectrum F = sr_fresnel_conductor(c, eta, k);
        for (int j = 0; j < SR_LAMBDA_COUNT; ++j)
            EXPECT_NEAR(F[j], complex_fresnel((double)c, (double)eta[j], (double)k[j]), 3e-6);
    }
}
TEST(fresnel_conductor_without_absorption_is_a_dielectric)
{
    for (int i = 1; i <= 50; ++i)
        EXPECT_NEAR(sr_fresnel_conductor((float)i / 50, SR_BLACK + 1.6f, SR_BLACK)[0],
                    sr_fresnel_dielectric((float)i / 50, 1.6f), 2e-6);
}

/* 2 INTEGRAL_0^1 F(c) c dc against Walsh's closed form, in both directions through the boundary. */
TEST(diffuse_fresnel_is_the_integral_of_fresnel)
{
    EXPECT_NEAR(sr_fresnel_diffuse(1.5), 0.0917779593424, 1e-12);
    EXPECT_NEAR(sr_fresnel_diffuse(1 / 1.5), 0.596345759708, 1e-12);
    static const double eta[] = {1.00005, 1.01, 1.1, 1.33, 2.42};
    double x[256], w[256];
    sr_gauss_legendre(256, 0, 1, x, w);
    for (int e = 0; e < 5; ++e) {
        double outside = 0;
        for (int i = 0; i < 256; ++i) {
            double c = x[i] * x[i];
            outside += w[i] * 4 * c * x[i] * complex_fresnel(c, eta[e], 0);
        }
        EXPECT_NEAR(sr_fresnel_diffuse(eta[e]), outside, 2e-5 * (eta[e] - 1) + 1e-7);
    }
}

static float thin_share(float eta, double deg, uint32_t lobe, bool sums_as_pbrt)
{
    struct sr_bsdf b = {.model = &sr_bsdf_thin_dielectric};
    *(struct sr_bsdf_thin_dielectric *)b.data = (struct sr_bsdf_thin_dielectric){eta, sums_as_pbrt};
    struct sr_bsdf_sample s;
    sr_vec3 wo = {(float)sin(deg * 3.14159265358979 / 180), 0, cosd(deg)};
    EXPECT(sr_bsdf_sample(&b, wo, lobe == SR_LOBE_REFLECTION ? 0 : 0.999f, (sr_vec2){0.5f, 0.5f}, SR_RADIANCE, &s));
    EXPECT_EQUAL_INT(s.lobe, lobe | SR_LOBE_SPECULAR);
    EXPECT_NEAR(s.eta, 1, 0);
    EXPECT_NEAR(s.f[0] / s.pdf * fabsf(s.wi.z), 1, 1e-6); // probability = share: the weight is 1
    return s.pdf;
}
/* Each polarisation has its own series; at normal incidence they agree. pbrt sums 2 F / (1 + F) of the mean. */
TEST(thin_dielectric_sums_the_bounces_in_a_pane)
{
    EXPECT_NEAR(thin_share(1.52f, 0, SR_LOBE_TRANSMISSION, false), 0.918318028033, 1e-6);
    EXPECT_NEAR(thin_share(1.52f, 30, SR_LOBE_TRANSMISSION, false), 0.91595731338, 1e-6);
    EXPECT_NEAR(thin_share(1.52f, 45, SR_LOBE_TRANSMISSION, false), 0.902528262167, 1e-6);
    EXPECT_NEAR(thin_share(1.52f, 60, SR_LOBE_TRANSMISSION, false), 0.843470671821, 1e-6);
    EXPECT_NEAR(thin_share(1.5f, 60, SR_LOBE_REFLECTION, false), 0.151871590, 1e-6);
    EXPECT_NEAR(thin_share(1.5f, 0, SR_LOBE_REFLECTION, true), 0.076923, 1e-6);
    EXPECT_NEAR(thin_share(1.5f, 30, SR_LOBE_REFLECTION, true), 0.079734, 1e-6);
    EXPECT_NEAR(thin_share(1.5f, 60, SR_LOBE_REFLECTION, true), 0.163768, 1e-6);
    EXPECT_NEAR(thin_share(1.5f, 80, SR_LOBE_REFLECTION, true), 0.558771, 2e-6);
}
