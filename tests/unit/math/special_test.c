/* SPDX-License-Identifier: MIT */
/* Special functions against closed forms, identities and quadrature. */
#include "test.h"

static double quadrature(double (*f)(double x, double a, double b), double a, double b, double lo, double hi)
{
    double x[64], w[64], sum = 0;
    for (int part = 0; part < 64; ++part) {
        sr_gauss_legendre(64, lo + (hi - lo) * part / 64, lo + (hi - lo) * (part + 1) / 64, x, w);
        for (int i = 0; i < 64; ++i)
            sum += w[i] * f(x[i], a, b);
    }
    return sum;
}

static double gamma_density(double t, double a, double b)
{
    (void)b;
    return exp((a - 1) * log(t) - t - lgamma(a));
}

static double beta_density(double t, double a, double b)
{
    return exp((a - 1) * log(t) + (b - 1) * log1p(-t) - lgamma(a) - lgamma(b) + lgamma(a + b));
}

TEST(gauss_legendre_is_exact_for_polynomials_and_weights_sum_to_the_length)
{
    static double x[512], w[512];
    for (int n = 1; n <= 512; n = n < 12 ? n + 1 : n * 2 - 3) {
        sr_gauss_legendre(n, -1, 3, x, w);
        double sum = 0, power = 0;
        int degree = 2 * n - 1 < 40 ? 2 * n - 1 : 40;
        for (int i = 0; i < n; ++i) {
            sum += w[i];
            power += w[i] * pow(x[i] / 3, degree);
            EXPECT(i == 0 || x[i] > x[i - 1]);
        }
        EXPECT_NEAR(sum, 4, 2e-13);
        double expected = 3 * (1 - pow(-1.0 / 3, degree + 1)) / (degree + 1);
        EXPECT_NEAR(power, expected, 1e-13);
    }
    // the published three-point rule
    sr_gauss_legendre(3, -1, 1, x, w);
    EXPECT_NEAR(x[2], sqrt(0.6), 1e-15);
    EXPECT_NEAR(w[1], 8.0 / 9, 1e-15);
}

TEST(incomplete_gamma_agrees_with_closed_forms_and_quadrature)
{
    for (double x = 1e-6; x < 600; x *= 1.7) {
        EXPECT_RELATIVE(sr_incomplete_gamma_upper(1, x), exp(-x), 1e-12);
        EXPECT_RELATIVE(sr_incomplete_gamma_upper(0.5, x), erfc(sqrt(x)), 1e-11);
        EXPECT_RELATIVE(sr_incomplete_gamma_upper(3, x), exp(-x) * (1 + x + x * x / 2), 1e-11);
    }
    double a[] = {2.5, 19.5, 20, 77.25, 1500};
    for (int i = 0; i < 5; ++i)
        for (int k = -2; k <= 4; ++k) {
            double x = a[i] + k * sqrt(a[i]), top = a[i] + 60 * sqrt(a[i]) + 60;
            if (x > 0)
                EXPECT_RELATIVE(sr_incomplete_gamma_upper(a[i], x), quadrature(gamma_density, a[i], 0, x, top), 3e-10);
        }
    // recurrence Q(a + 1, x) = Q(a, x) + x^a e^-x / Gamma(a + 1), across the change of method at a = 20
    for (double b = 0.25; b < 60; b += 0.5)
        for (double x = 0.5; x < 90; x += 3.7)
            EXPECT_NEAR(sr_incomplete_gamma_upper(b + 1, x) - sr_incomplete_gamma_upper(b, x),
                        exp(b * log(x) - x - lgamma(b + 1)), 2e-14);
}

TEST(incomplete_beta_agrees_with_closed_forms_and_quadrature)
{
    for (double x = 0.001; x < 1; x += 0.0371) {
        EXPECT_RELATIVE(sr_incomplete_beta(1, 1, x), x, 1e-13);
        EXPECT_RELATIVE(sr_incomplete_beta(3.5, 1, x), pow(x, 3.5), 1e-12);
        EXPECT_RELATIVE(sr_incomplete_beta(1, 7, x), -expm1(7 * log1p(-x)), 1e-12);
        EXPECT_RELATIVE(sr_incomplete_beta(0.5, 0.5, x), 2 / M_PI * asin(sqrt(x)), 1e-12);
        EXPECT_NEAR(sr_incomplete_beta(25, 33, x) + sr_incomplete_beta(33, 25, 1 - x), 1, 1e-12);
    }
    double ab[][2] = {{2.5, 3}, {19, 400}, {25, 33}, {300, 4}, {2000, 1000}};
    for (int i = 0; i < 5; ++i) {
        double a = ab[i][0], b = ab[i][1], mean = a / (a + b), sigma = sqrt(mean * (1 - mean) / (a + b + 1));
        for (int k = -3; k <= 3; ++k) {
            double x = mean + k * sigma;
            if (x > 0 && x < 1)
                EXPECT_RELATIVE(sr_incomplete_beta(a, b, x),
                                quadrature(beta_density, a, b, fmax(0, mean - 40 * sigma), x), 1e-9);
        }
    }
}

TEST(chi_square_has_the_published_quantiles)
{
    EXPECT_NEAR(sr_chi2_p(3.841458820694124, 1), 0.05, 1e-13);
    EXPECT_NEAR(sr_chi2_p(18.307038053275146, 10), 0.05, 1e-13);
    EXPECT_NEAR(sr_chi2_p(124.34211340400407, 100), 0.05, 1e-12);
    EXPECT_RELATIVE(sr_chi2_p(100, 2), exp(-50.0), 1e-13);
    EXPECT_EQUAL_INT(sr_chi2_p(0, 5), 1);
}

TEST(normal_has_the_published_quantiles_and_inverts)
{
    EXPECT_NEAR(sr_normal_quantile(0.975), 1.959963984540054, 1e-14);
    EXPECT_NEAR(sr_normal_quantile(0.5), 0, 1e-15);
    EXPECT_NEAR(sr_normal_quantile(0.0013498980316300933), -3, 1e-13);
    EXPECT_RELATIVE(sr_normal_p_two_sided(1.959963984540054), 0.05, 1e-13);
    for (double z = -37; z < -0.1; z += 0.37)
        EXPECT_RELATIVE(sr_normal_quantile(0.5 * erfc(-z / sqrt(2))), z, 1e-12);
}

TEST(student_has_the_published_quantiles_and_inverts)
{
    EXPECT_RELATIVE(sr_student_quantile(0.975, 1), 12.706204736174706, 1e-12);
    EXPECT_RELATIVE(sr_student_quantile(0.975, 2), 4.302652729749464, 1e-12);
    EXPECT_RELATIVE(sr_student_quantile(0.975, 10), 2.228138851986274, 1e-12);
    EXPECT_RELATIVE(sr_student_quantile(0.995, 30), 2.749995653567231, 1e-12);
    EXPECT_RELATIVE(sr_student_quantile(0.975, 1e9), 1.959963986, 1e-8);
    EXPECT_RELATIVE(sr_student_quantile(0.025, 10), -2.228138851986274, 1e-12);
    for (double t = 0.01; t < 100; t *= 1.9) {
        EXPECT_RELATIVE(sr_student_p_two_sided(t, 1), 1 - 2 / M_PI * atan(t), 1e-11);
        EXPECT_RELATIVE(sr_student_p_two_sided(t, 2), 1 - t / sqrt(2 + t * t), 1e-10);
    }
    for (double degrees = 1; degrees < 1e6; degrees *= 3.3)
        for (double p = 0.51; p < 1; p += 0.07)
            EXPECT_RELATIVE(sr_student_p_two_sided(sr_student_quantile(p, degrees), degrees), 2 * (1 - p), 1e-11);
    // the limit of many degrees, with the first term of the approach: (t^3 + t) / (4 degrees)
    for (double p = 0.6; p < 1; p += 0.13) {
        double z = sr_normal_quantile(p);
        EXPECT_RELATIVE(sr_student_quantile(p, 1e6), z + (z * z * z + z) / 4e6, 1e-11);
    }
}
