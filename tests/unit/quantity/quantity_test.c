/* SPDX-License-Identifier: MIT */
/* Values with uncertainty: sums, products, ratios, refusals, Welch & Satterthwaite, and how they are printed. */
#include "quantity/quantity.h"
#include "sample/sample.h"
#include "test.h"

static const enum sr_kind kinds[] = {SR_KIND_ENERGY,    SR_KIND_FLUX,     SR_KIND_FLUX_DENSITY,
                                     SR_KIND_INTENSITY, SR_KIND_RADIANCE, SR_KIND_EXPOSURE};

static const char *unit_name(struct sr_unit unit)
{
    static char text[96];
    return sr_unit_text(unit, text, sizeof text);
}

static const char *name_of(enum sr_kind kind, enum sr_system system, bool is_spectral)
{
    return unit_name(sr_unit_of(kind, system, is_spectral));
}

static struct sr_quantity lux(double value, double u, double degrees)
{
    return (struct sr_quantity){
        .value = value, .u = u, .degrees = degrees, .unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, false)};
}

TEST(units_have_their_names)
{
    static const char *const radiometric[] = {"J", "W", "W/m^2", "W/sr", "W/(m^2 sr)", "J/m^2"};
    static const char *const photopic[] = {"lm s", "lm", "lx", "cd", "cd/m^2", "lx s"};
    static const char *const photon[] = {"umol",        "umol/s",          "umol/(m^2 s)",
                                         "umol/(sr s)", "umol/(m^2 sr s)", "umol/m^2"};
    for (int i = 0; i < SR_KIND_COUNT; ++i) {
        EXPECT_EQUAL_TEXT(name_of(kinds[i], SR_RADIOMETRIC, false), radiometric[i]);
        EXPECT_EQUAL_TEXT(name_of(kinds[i], SR_PHOTOPIC, false), photopic[i]);
        EXPECT_EQUAL_TEXT(name_of(kinds[i], SR_PHOTON, false), photon[i]);
    }
    EXPECT_EQUAL_TEXT(name_of(SR_KIND_RADIANCE, SR_RADIOMETRIC, true), "W/(m^2 sr nm)");
    EXPECT_EQUAL_TEXT(name_of(SR_KIND_FLUX_DENSITY, SR_SCOTOPIC, false), "scotopic lx");
    EXPECT_EQUAL_TEXT(name_of(SR_KIND_RADIANCE, SR_CONES_10, false), "CIE2015-10 cd/m^2");
    EXPECT_EQUAL_TEXT(name_of(SR_KIND_FLUX_DENSITY, SR_PAR, false), "PAR umol/(m^2 s)");
    EXPECT_EQUAL_TEXT(unit_name((struct sr_unit){0}), "1");
    EXPECT_EQUAL_TEXT(unit_name(sr_unit_power(0, -1, 0)), "1/sr");
    EXPECT_EQUAL_TEXT(unit_name(sr_unit_power(2, 0, 0)), "m^2");
    char small[4];
    EXPECT_EQUAL_TEXT(sr_unit_text(sr_unit_of(SR_KIND_RADIANCE, SR_PHOTOPIC, false), small, sizeof small), "cd/");
}

TEST(all_units_differ)
{
    for (int a = 0; a < SR_KIND_COUNT * SR_SYSTEM_COUNT * 2; ++a)
        for (int b = 0; b < a; ++b) {
            struct sr_unit x =
                sr_unit_of((enum sr_kind)(a / 2 % SR_KIND_COUNT), (enum sr_system)(a / 2 / SR_KIND_COUNT), a & 1);
            struct sr_unit y =
                sr_unit_of((enum sr_kind)(b / 2 % SR_KIND_COUNT), (enum sr_system)(b / 2 / SR_KIND_COUNT), b & 1);
            char text[96];
            EXPECT(!sr_unit_equal(x, y));
            EXPECT(strcmp(sr_unit_text(x, text, sizeof text), unit_name(y)) != 0);
        }
}

TEST(only_equal_units_are_added)
{
    struct sr_quantity a = lux(3, 0.3, 8), b = lux(4, 0.4, 8), c;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_quantity_add(&a, &b, &c, &error), SR_OK);
    EXPECT_NEAR(c.value, 7, 0);
    EXPECT_NEAR(c.u, 0.5, 1e-15);
    EXPECT_RELATIVE(c.degrees, 0.0625 / (0.0081 / 8 + 0.0256 / 8), 1e-12); // (GUM G.4.1)
    EXPECT_EQUAL_INT(sr_quantity_subtract(&a, &b, &c, &error), SR_OK);
    EXPECT_NEAR(c.value, -1, 0);
    EXPECT_NEAR(c.u, 0.5, 1e-15);

    struct sr_quantity wrong[] = {b, b, b, b};
    wrong[0].unit = sr_unit_of(SR_KIND_RADIANCE, SR_PHOTOPIC, false);
    wrong[1].unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_SCOTOPIC, false);
    wrong[2].unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, true);
    wrong[3].unit = (struct sr_unit){0};
    for (int i = 0; i < 4; ++i) {
        error = (struct sr_error){0};
        EXPECT_EQUAL_INT(sr_quantity_add(&a, &wrong[i], &c, &error), SR_ERROR_USAGE);
        EXPECT(isnan(c.value) && isnan(c.u) && strstr(error.text, "lx and "));
        EXPECT_EQUAL_INT(sr_quantity_subtract(&wrong[i], &a, &c, NULL), SR_ERROR_USAGE);
        EXPECT(isnan(c.value));
    }
}

TEST(geometry_turns_one_kind_into_another)
{
    struct sr_quantity L = {.value = 100,
                            .u = 1,
                            .degrees = 15,
                            .unit = sr_unit_of(SR_KIND_RADIANCE, SR_PHOTOPIC, false)},
                       out;
    struct sr_error error = {0};
    struct sr_unit sr = sr_unit_power(0, 1, 0), m2 = sr_unit_power(2, 0, 0), s = sr_unit_power(0, 0, 1);
    EXPECT_EQUAL_INT(sr_quantity_times(&L, 0.5, sr, sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, false), &out, &error),
                     SR_OK);
    EXPECT_NEAR(out.value, 50, 0);
    EXPECT_NEAR(out.u, 0.5, 0);
    EXPECT_NEAR(out.degrees, 15, 0);
    EXPECT_EQUAL_TEXT(unit_name(out.unit), "lx");
    struct sr_quantity E = out;
    EXPECT_EQUAL_INT(sr_quantity_times(&E, 2, m2, sr_unit_of(SR_KIND_FLUX, SR_PHOTOPIC, false), &out, &error), SR_OK);
    EXPECT_EQUAL_TEXT(unit_name(out.unit), "lm");
    struct sr_quantity flux = out;
    EXPECT_EQUAL_INT(sr_quantity_times(&flux, 60, s, sr_unit_of(SR_KIND_ENERGY, SR_PHOTOPIC, false), &out, &error),
                     SR_OK);
    EXPECT_EQUAL_TEXT(unit_name(out.unit), "lm s");
    EXPECT_EQUAL_INT(sr_quantity_times(&L, 2, m2, sr_unit_of(SR_KIND_INTENSITY, SR_PHOTOPIC, false), &out, &error),
                     SR_OK);
    EXPECT_EQUAL_TEXT(unit_name(out.unit), "cd");
    EXPECT_EQUAL_INT(sr_quantity_times(&E, 2, sr, sr_unit_of(SR_KIND_FLUX, SR_PHOTOPIC, false), &out, &error),
                     SR_ERROR_USAGE);
    EXPECT(isnan(out.value));
    EXPECT_EQUAL_TEXT(error.text, "lx times sr is not lm");
}

/* Against the spread of the function itself over random inputs. */
TEST(products_and_ratios_carry_their_uncertainty)
{
    struct sr_quantity a = {.value = 683, .u = 5, .degrees = 20, .unit = sr_unit_of(SR_KIND_FLUX, SR_PHOTOPIC, false)};
    struct sr_quantity b = {
        .value = 2, .u = 0.02, .degrees = 30, .unit = sr_unit_of(SR_KIND_FLUX, SR_RADIOMETRIC, false)};
    struct sr_quantity ratio = sr_quantity_ratio(&a, &b), product = sr_quantity_product(&ratio, &b);
    EXPECT_EQUAL_TEXT(unit_name(ratio.unit), "lm/W");
    EXPECT_EQUAL_TEXT(unit_name(product.unit), "lm");
    EXPECT(sr_unit_equal(product.unit, a.unit));
    struct sr_tally tally = {0}, times = {0};
    enum { STEPS = 300 };
    for (int i = 0; i < STEPS; ++i)
        for (int j = 0; j < STEPS; ++j) {
            double x = a.value + a.u * sr_normal_quantile((i + 0.5) / STEPS),
                   y = b.value + b.u * sr_normal_quantile((j + 0.5) / STEPS);
            sr_tally_add(&tally, x / y);
            sr_tally_add(&times, x * y);
        }
    EXPECT_RELATIVE(ratio.u, sqrt(sr_tally_variance(&tally)), 0.01);
    EXPECT_RELATIVE(sr_quantity_product(&a, &b).u, sqrt(sr_tally_variance(&times)), 0.01);
    EXPECT(ratio.degrees > 20 && ratio.degrees < 50);
    struct sr_quantity exact = sr_quantity_exact(2, b.unit);
    EXPECT_NEAR(sr_quantity_ratio(&a, &exact).u, 2.5, 1e-12);
    EXPECT_NEAR(sr_quantity_ratio(&a, &exact).degrees, 20, 1e-9);
    EXPECT(isinf(sr_quantity_product(&exact, &exact).degrees));
}

TEST(photons_over_watts_are_photons_of_a_joule)
{
    struct sr_quantity n = sr_quantity_exact(1, sr_unit_of(SR_KIND_FLUX, SR_PHOTON, false)),
                       W = sr_quantity_exact(1, sr_unit_of(SR_KIND_FLUX, SR_RADIOMETRIC, false));
    EXPECT_EQUAL_TEXT(unit_name(sr_quantity_ratio(&n, &W).unit), "umol/J");
}

/* ---- printing ---- */

static const char *print(struct sr_quantity q)
{
    static char text[160];
    return sr_quantity_text("E", &q, text, sizeof text);
}

TEST(values_are_rounded_to_their_uncertainty)
{
    // k = 2.131449546 for 15 degrees
    EXPECT_EQUAL_TEXT(print(lux(19.8943678865, 0.01, 15)), "E = 19.894 lx ± 0.021 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(19.8943678865, 0.0467, 15)),
                      "E = 19.89 lx ± 0.10 lx (95 %, k = 2.13, ν = 15)"); // U = 0.09954
    EXPECT_EQUAL_TEXT(print(lux(123456.7, 560, 15)), "E = 123500 lx ± 1200 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(123456.7, 6, 15)), "E = 123457 lx ± 13 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(-2, 1, INFINITY)), "E = -2.0 lx ± 2.0 lx (95 %, k = 1.96, ν = ∞)");
    EXPECT_EQUAL_TEXT(print(lux(0, 1, 7.25)), "E = 0.0 lx ± 2.3 lx (95 %, k = 2.35, ν = 7.2)");
    char text[160];
    struct sr_quantity q = lux(1, 0.1, 15);
    EXPECT_EQUAL_TEXT(sr_quantity_text(NULL, &q, text, sizeof text), "1.00 lx ± 0.21 lx (95 %, k = 2.13, ν = 15)");
    q.unit = (struct sr_unit){0};
    EXPECT_EQUAL_TEXT(sr_quantity_text("rho", &q, text, sizeof text), "rho = 1.00 ± 0.21 (95 %, k = 2.13, ν = 15)");
}

TEST(huge_and_small_values_share_a_power_of_ten)
{
    EXPECT_EQUAL_TEXT(print(lux(1.23456789e-7, 1e-9, 15)), "E = 1.235e-7 lx ± 0.021e-7 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(1.974972616e7, 1000, 15)), "E = 1.97497e7 lx ± 0.00021e7 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(1e-9, 1e-3, 15)), "E = 0.0000 lx ± 0.0021 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(1.5, 1e300, 15)), "E = 0.0e300 lx ± 2.1e300 lx (95 %, k = 2.13, ν = 15)");
}

TEST(what_is_not_known_is_not_called_zero)
{
    EXPECT_EQUAL_TEXT(print(lux(19.8943678865, 0, 15)), "E = 19.8943679 lx ± 0 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(19.8943678865, 1e-12, 15)), "E = 19.8943679 lx ± 2e-12 lx (95 %, k = 2.13, ν = 15)");
    EXPECT_EQUAL_TEXT(print(lux(19.8943678865, 0, INFINITY)), "E = 19.8943679 lx (exact)");
    EXPECT_EQUAL_TEXT(print(lux(0, 0, 15)), "E = 0 lx (nothing was found, and no bound is known)");
    EXPECT_EQUAL_TEXT(print(lux(2.5, NAN, 15)), "E = 2.5 lx (uncertainty not known)");
    EXPECT_EQUAL_TEXT(print(lux(2.5, 1, 0)), "E = 2.5 lx (uncertainty not known)");
    EXPECT_EQUAL_TEXT(print(lux(INFINITY, 1, 15)), "E = inf lx (not a number that was measured)");
    struct sr_unit lx = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, false);
    EXPECT_EQUAL_TEXT(print(sr_quantity_bounded(5, 1000, lx)), "E < 0.015 lx (95 %, one-sided: nothing was found)");
    EXPECT_EQUAL_TEXT(print(sr_quantity_bounded(0, 1000, lx)), "E = 0 lx (uncertainty not known)");
    const char *nan_text = print(lux(NAN, 1, 15));
    EXPECT(strstr(nan_text, "nan lx (not a number") != NULL);
    char tiny[8];
    struct sr_quantity q = lux(19.89, 0.01, 15);
    EXPECT(strlen(sr_quantity_text("E", &q, tiny, sizeof tiny)) == 7);
}

TEST(a_bound_counts_as_an_uncertainty_as_wide_as_it_is)
{
    struct sr_unit lx = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, false);
    struct sr_quantity none = sr_quantity_bounded(1, 100, lx), some = lux(10, 0.04, 15), sum;
    EXPECT_EQUAL_INT(sr_quantity_add(&none, &some, &sum, NULL), SR_OK);
    EXPECT_NEAR(sum.value, 10, 0);
    EXPECT_NEAR(sum.u, 0.05, 1e-15);
    EXPECT(sum.upper == 0);
    EXPECT_NEAR(sr_quantity_scale(&none, -2).upper, 0.06, 1e-15);
}

TEST(a_tally_of_replicates_becomes_a_quantity)
{
    struct sr_tally t = {0};
    for (int i = 1; i <= 4; ++i)
        sr_tally_add(&t, i);
    struct sr_quantity q = sr_quantity_of_tally(&t, (struct sr_unit){0});
    EXPECT_NEAR(q.value, 2.5, 1e-15);
    EXPECT_NEAR(q.u, sqrt(5.0 / 3 / 4), 1e-15);
    EXPECT_NEAR(q.degrees, 3, 0);
    EXPECT_NEAR(sr_quantity_expanded(&q, 0.95), 3.182446305 * q.u, 1e-8); // tables of Student's t
    q.degrees = INFINITY;
    EXPECT_NEAR(sr_quantity_expanded(&q, 0.95), 1.959963985 * q.u, 1e-8);
    t.n = 1;
    EXPECT(isnan(sr_quantity_of_tally(&t, (struct sr_unit){0}).u));
}

/* ---- the jackknife ---- */

static double first_over_second(const double *means)
{
    return means[0] / means[1];
}

static double first_alone(const double *means)
{
    return means[0];
}

TEST(the_jackknife_of_a_mean_is_the_mean)
{
    const double rows[] = {1, 9, 2, 9, 4, 9, 9, 9};
    struct sr_tally t = {0};
    for (int r = 0; r < 4; ++r)
        sr_tally_add(&t, rows[2 * r]);
    struct sr_quantity q = sr_quantity_jackknife(rows, 4, 2, first_alone, (struct sr_unit){0});
    EXPECT_RELATIVE(q.value, t.mean, 1e-14);
    EXPECT_RELATIVE(q.u, sr_tally_standard_error(&t), 1e-14);
    EXPECT_NEAR(q.degrees, 3, 0);
}

/* 1 + noise over 1 + the same and other noise: the plain ratio is too large by about its variance, the jackknife is
 * not, and its interval covers. */
TEST(the_jackknife_of_a_ratio_is_nearly_unbiased_and_covers)
{
    enum { ROUNDS = 4000, R = 16 };
    struct sr_rng rng = sr_rng_seed(1, 2);
    struct sr_tally plain = {0}, jackknifed = {0};
    int covered = 0;
    for (int k = 0; k < ROUNDS; ++k) {
        double rows[2 * R], sum[2] = {0};
        for (int r = 0; r < R; ++r) {
            double a = sr_normal_quantile((sr_rng_u32(&rng) + 0.5) * 0x1p-32),
                   b = sr_normal_quantile((sr_rng_u32(&rng) + 0.5) * 0x1p-32);
            rows[2 * r] = 1 + 0.2 * a;
            rows[2 * r + 1] = 1 + 0.1 * a + 0.4 * b;
            sum[0] += rows[2 * r], sum[1] += rows[2 * r + 1];
        }
        struct sr_quantity q = sr_quantity_jackknife(rows, R, 2, first_over_second, (struct sr_unit){0});
        sr_tally_add(&plain, sum[0] / sum[1]);
        sr_tally_add(&jackknifed, q.value);
        covered += fabs(q.value - 1) <= sr_quantity_expanded(&q, 0.95);
    }
    EXPECT(plain.mean > 1 + 4.9 * sr_tally_standard_error(&plain)); // 1 + (0.17 - 0.02) / 16
    EXPECT(fabs(jackknifed.mean - 1) < 4.9 * sr_tally_standard_error(&jackknifed));
    EXPECT(covered > 0.935 * ROUNDS && covered < 0.97 * ROUNDS);
}

TEST(uncertainties_that_are_none_are_told_as_such)
{
    char text[96];
    const struct sr_quantity odd[] = {{.value = 0, .u = -1, .degrees = INFINITY},
                                      {.value = 1, .u = -1, .degrees = 15},
                                      {.value = 1, .u = INFINITY, .degrees = 15},
                                      {.value = 1, .u = 1e308, .degrees = 15},
                                      {.value = 1, .u = 0.1, .degrees = NAN}};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; ++i)
        EXPECT(strstr(sr_quantity_text("E", &odd[i], text, sizeof text), "uncertainty not known"));
    const struct sr_quantity q = {.value = 1, .u = 0.1, .degrees = 15};
    const double levels[] = {-1, 2, NAN};
    for (size_t i = 0; i < sizeof levels / sizeof levels[0]; ++i)
        EXPECT(isnan(sr_quantity_expanded(&q, levels[i])));
}
