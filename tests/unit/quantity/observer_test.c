/* SPDX-License-Identifier: MIT */
/* Observers against the definition of the candela, the photon's energy, and black bodies. */
#include "quantity/quantity.h"
#include "test.h"

TEST(the_candela_holds_in_every_luminous_system)
{
    const double candela = 555.016;                                   // [nm] 540 THz in standard air
    EXPECT_RELATIVE(sr_observer_at(SR_PHOTOPIC, candela), 683, 3e-6); // K_m is rounded from 683.0016
    EXPECT_RELATIVE(sr_observer_at(SR_SCOTOPIC, candela), 683, 1e-5);
    EXPECT_RELATIVE(sr_observer_at(SR_CONES_2, candela), 683, 1e-6);
    EXPECT_RELATIVE(sr_observer_at(SR_CONES_10, candela), 683, 1e-6);
}

TEST(efficacies_peak_where_the_cie_says)
{
    EXPECT_NEAR(sr_observer_at(SR_PHOTOPIC, 555), 683, 0);
    EXPECT_NEAR(sr_observer_at(SR_SCOTOPIC, 507), 1700.05, 0.05);
    EXPECT_NEAR(sr_observer_at(SR_CONES_2, 556), 683.358, 0.01); // 683.358 lm/W of CIE 170-2:2015, whose table is finer
    EXPECT_NEAR(sr_observer_at(SR_CONES_10, 556), 683.144, 0.04);                 // 683.144 lm/W
    EXPECT_RELATIVE(1e-3 * sr_observer_at(SR_PHOTOPIC, 532), 0.6044293192, 1e-7); // a laser of 1 mW [lm]
    for (double lambda = 300; lambda < 900; lambda += 0.37) {
        EXPECT(sr_observer_at(SR_SCOTOPIC, lambda) <= sr_observer_at(SR_SCOTOPIC, 507));
        EXPECT(sr_observer_at(SR_PHOTOPIC, lambda) <= 683);
        EXPECT(sr_observer_at(SR_RADIOMETRIC, lambda) == 1);
        EXPECT_RELATIVE(sr_observer_at(SR_PHOTOPIC, lambda), 683 * sr_luminous_efficiency(lambda), 1e-6);
    }
    EXPECT(sr_observer_at(SR_PHOTOPIC, 359.9) == 0 && sr_observer_at(SR_PHOTOPIC, 830.1) == 0);
    EXPECT(sr_observer_at(SR_SCOTOPIC, 781.1) == 0 && sr_observer_at(SR_CONES_2, 388.9) == 0);
    EXPECT(sr_observer_at(SR_PHOTOPIC, NAN) == 0);
}

TEST(photons_of_a_joule)
{
    // lambda / (h c N_A): h c N_A = 0.119626565638697 J m/mol
    EXPECT_RELATIVE(sr_observer_at(SR_PHOTON, 555), 4.639437712157, 1e-12);
    EXPECT_RELATIVE(sr_observer_at(SR_PAR, 555), 4.639437712157, 1e-12);
    EXPECT_RELATIVE(sr_observer_at(SR_PHOTON, 1000), 8.359347229112, 1e-12);
    EXPECT(sr_observer_at(SR_PAR, 400) > 0 && sr_observer_at(SR_PAR, 700) > 0);
    EXPECT(sr_observer_at(SR_PAR, 399.99) == 0 && sr_observer_at(SR_PAR, 700.01) == 0);
}

/* Planck's law by 1 nm: rows I11 and I11b; the scotopic one by an own sum. */
TEST(black_bodies_have_their_efficacies)
{
    double T = 2856, luminance = 0;
    for (int lambda = 360; lambda <= 830; ++lambda)
        luminance += sr_planck(lambda, T) * sr_observer_at(SR_PHOTOPIC, lambda);
    EXPECT_RELATIVE(luminance, 19749726.1611, 1e-7);
    double radiance = 5.670374419184429e-8 * T * T * T * T / 3.14159265358979324; // [W m^-2 sr^-1], all wavelengths
    EXPECT_RELATIVE(luminance / radiance, 16.4462797642 * 683 / 683.002, 1e-6);

    struct sr_spd body = sr_spd_blackbody((float)T);
    double top = sr_planck(2.897771955e6 / T, T); // Planck's maximum, by Wien
    EXPECT_RELATIVE(top * sr_observer_integral(SR_PHOTOPIC, &body, 360, 830), luminance, 1e-5);
    double ratio =
        sr_observer_integral(SR_SCOTOPIC, &body, 360, 830) / sr_observer_integral(SR_PHOTOPIC, &body, 360, 830);
    EXPECT_NEAR(ratio, 1.41, 0.01); // S/P ratio of illuminant A as lighting tables print it
}

/* Paths see what integrals say, in all systems at once. */
TEST(paths_estimate_the_integrals)
{
    struct sr_spd body = sr_spd_blackbody(5000);
    struct sr_lambda_range range = {SR_LAMBDA_MIN, SR_LAMBDA_MAX};
    double sums[SR_SYSTEM_COUNT] = {0}, Y = 0;
    enum { COUNT = 20000 };
    for (int i = 0; i < COUNT; ++i) {
        struct sr_wavelengths w = sr_wavelengths_sample(range, ((float)i + 0.5f) / COUNT);
        sr_spectrum X = sr_spd_eval(&body, w.lambda) * SR_KM;
        double readings[SR_SYSTEM_COUNT];
        sr_observe(X, &w, readings);
        for (int s = 0; s < SR_SYSTEM_COUNT; ++s)
            sums[s] += readings[s] / COUNT;
        Y += (double)sr_spectrum_to_xyz(X, &w).y / COUNT;
        EXPECT_RELATIVE(readings[SR_PHOTOPIC], sr_spectrum_to_xyz(X, &w).y, 1e-5);
    }
    for (int s = 0; s < SR_SYSTEM_COUNT; ++s) {
        double integral = 0; // trapezoids by 0.1 nm
        for (int i = 0; i <= 4700; ++i)
            integral += 0.1 * (i % 4700 ? 1 : 0.5) * sr_observer_at((enum sr_system)s, 360 + 0.1 * i) *
                        (double)sr_spd_at(&body, 360 + 0.1f * (float)i);
        EXPECT_RELATIVE(sums[s], integral, s == SR_PAR ? 5e-4 : 2e-5);
    }
    EXPECT_RELATIVE(sums[SR_PHOTOPIC], Y, 1e-6);
}

TEST(wavelengths_that_have_ended_do_not_count)
{
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){360, 830}, 0.3f);
    double all[SR_SYSTEM_COUNT], first[SR_SYSTEM_COUNT];
    sr_wavelengths_terminate_secondary(&w);
    sr_observe(SR_ONE, &w, all);
    sr_spectrum only = SR_BLACK;
    only[0] = 1;
    sr_observe(only, &w, first);
    for (int s = 0; s < SR_SYSTEM_COUNT; ++s)
        EXPECT(all[s] == first[s] && isfinite(all[s]));
}

TEST(systems_are_found_by_name)
{
    for (int s = 0; s < SR_SYSTEM_COUNT; ++s) {
        enum sr_system found = SR_SYSTEM_COUNT;
        EXPECT(sr_system_find(sr_system_name((enum sr_system)s), &found) && (int)found == s);
    }
    enum sr_system none;
    EXPECT(!sr_system_find("phot", &none));
}
