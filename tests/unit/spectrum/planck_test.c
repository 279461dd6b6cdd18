/* SPDX-License-Identifier: MIT */
/* Black bodies against closed forms. The ids are those of the validation catalogue. */
#include "spectrum/spectrum.h"
#include "test.h"

// integral of Planck's law from lo to hi [nm], by Gauss-Legendre in log(lambda)
static double integral(double T, double lo, double hi)
{
    enum { N = 256 };
    double x[N], w[N], sum = 0;
    sr_gauss_legendre(N, log(lo), log(hi), x, w);
    for (int i = 0; i < N; ++i)
        sum += w[i] * exp(x[i]) * sr_planck(exp(x[i]), T);
    return sum;
}

TEST(planck_values)
{
    EXPECT_RELATIVE(sr_planck(555, 2856), 258.476928115, 1e-9);     // I2.2856
    EXPECT_RELATIVE(sr_planck(500, 5778), 26375.6698666, 1e-9);     // I2.5778
    EXPECT_RELATIVE(sr_planck(10000, 300), 0.00992403333007, 1e-9); // I2.300
}

TEST(planck_integrates_to_stefan_boltzmann)
{
    double all = integral(5778, 50, 1e7);
    EXPECT_RELATIVE(all, 20117407.54, 1e-8);                                        // I3
    EXPECT_RELATIVE(3.14159265358979 * all / pow(5778, 4), 5.67037441918e-8, 1e-8); // I1
    EXPECT_RELATIVE(integral(2856, 400, 700) / (5.67037441918e-8 * pow(2856, 4) / 3.14159265358979), 0.0652716939857,
                    1e-9);                                                 // I5.2856
    EXPECT_RELATIVE(integral(5778, 400, 700) / all, 0.366659443156, 1e-8); // I5.5778
}

TEST(planck_peaks_where_wien_says)
{
    double lo = 500, hi = 2000;
    while (hi - lo > 1e-7) { // slope by a symmetric difference
        double mid = (lo + hi) / 2;
        *(sr_planck(mid + 0.01, 2856) > sr_planck(mid - 0.01, 2856) ? &lo : &hi) = mid;
    }
    EXPECT_RELATIVE(lo, 1014.62603466, 1e-6); // I4
}

TEST(planckian_locus_and_efficacy)
{
    static const double cases[2][3] = {{2856, 0.447535144304, 0.407428289726},
                                       {6500, 0.313525880402, 0.323628304672}}; // I10
    for (int i = 0; i < 2; ++i) {
        double exact[3] = {0};
        for (int l = 360; l <= 830; ++l) {
            double bar[3];
            sr_observer_1931(l, bar);
            for (int k = 0; k < 3; ++k)
                exact[k] += bar[k] * sr_planck(l, cases[i][0]);
        }
        EXPECT_RELATIVE(exact[0] / (exact[0] + exact[1] + exact[2]), cases[i][1], 1e-6);
        EXPECT_RELATIVE(exact[1] / (exact[0] + exact[1] + exact[2]), cases[i][2], 1e-6);
        struct sr_spd body = sr_spd_blackbody((float)cases[i][0]);
        double xyz[3];
        sr_spd_xyz(&body, xyz);
        EXPECT_RELATIVE(xyz[0] / (xyz[0] + xyz[1] + xyz[2]), cases[i][1], 1e-6);
        EXPECT_RELATIVE(xyz[1] / (xyz[0] + xyz[1] + xyz[2]), cases[i][2], 1e-6);
        if (i == 0) {
            EXPECT_RELATIVE(683 * exact[1], 19749726.1611, 1e-6); // I11b
            EXPECT_RELATIVE(683.002 * exact[1] / (5.67037441918e-8 * pow(2856, 4) / 3.14159265358979), 16.4462797642,
                            1e-6); // I11
        }
    }
}

TEST(blackbody_is_planck_over_its_maximum)
{
    static const float temperatures[] = {300, 1000, 2856, 6500, 25000, 1e5f, 1e6f};
    for (size_t i = 0; i < sizeof(temperatures) / sizeof(temperatures[0]); ++i) {
        float T = temperatures[i];
        struct sr_spd s = sr_spd_blackbody(T);
        double peak = sr_planck(2.897771955185e6 / (double)T, (double)T);
        for (float lambda = 360; lambda <= 830; lambda += 7.3f) {
            double expected = sr_planck((double)lambda, (double)T) / peak;
            if (expected > 1e-28) // exp of an argument with one rounding: relative error grows with x = c2 / (lambda T)
                EXPECT_RELATIVE(sr_spd_at(&s, lambda), expected, 2e-6 + 2e-7 * 1.4388e7 / (double)(lambda * T));
            EXPECT(sr_spd_at(&s, lambda) <= 1 + 1e-6f && sr_spd_at(&s, lambda) >= 0);
        }
        EXPECT(sr_spd_max(&s) >= sr_spd_at(&s, 500));
    }
    struct sr_spd warm = sr_spd_blackbody(5000); // its peak is inside the observer's range
    EXPECT_RELATIVE(sr_spd_max(&warm), 1, 1e-6);
}
