/* SPDX-License-Identifier: MIT */
/* Photometry and colorimetry of known spectra against published and independently computed values. The ids are those of
 * the validation catalogue; sums by 1 nm from 360 to 830 nm. */
#include "sample/sample.h"
#include "spectrum/spectrum.h"
#include "test.h"

static void chromaticity(const double xyz[3], double xy[2])
{
    for (int i = 0; i < 2; ++i)
        xy[i] = xyz[i] / (xyz[0] + xyz[1] + xyz[2]);
}

// sums by `step` from `lo` to `hi` nm with the observer's own samples
static void sum_xyz(const struct sr_spd *s, double lo, double hi, double step, double xyz[3])
{
    xyz[0] = xyz[1] = xyz[2] = 0;
    for (double lambda = lo; lambda <= hi; lambda += step) {
        double bar[3];
        sr_observer_1931(lambda, bar);
        for (int i = 0; i < 3; ++i)
            xyz[i] += step * bar[i] * (double)sr_spd_at(s, (float)lambda);
    }
}

TEST(observer_integrals_are_those_of_the_tables)
{
    struct sr_spd one = sr_spd_constant(1);
    double xyz[3], xy[2];
    sr_spd_xyz(&one, xyz);
    EXPECT_RELATIVE(xyz[0], 106.86546949, 1e-6);  // I6X
    EXPECT_RELATIVE(xyz[1], 106.856917101, 1e-6); // I6Y
    EXPECT_RELATIVE(xyz[2], 106.892251279, 1e-6); // I6Z
    EXPECT_RELATIVE(sr_spd_luminous_integral(&one), 106.856917101, 1e-6);
    chromaticity(xyz, xy);
    EXPECT_RELATIVE(xy[0], 0.333314380777, 1e-6); // I6ex
    EXPECT_RELATIVE(xy[1], 0.333287705799, 1e-6); // I6ey
    EXPECT_RELATIVE(SR_CIE_Y_INTEGRAL, 106.856917101, 1e-6);
}

struct illuminant_case {
    const char *name;
    double x, y, X, Z, X5, Z5;
    double xy_tolerance, XYZ_tolerance;
};

TEST(standard_illuminants_have_their_chromaticities)
{
    // A comes from the CIE formula, the catalogue's I7.A from a table of 5 nm: the practical bound is used there
    static const struct illuminant_case cases[] = {
        {"stdillum-A", 0.44756076888, 0.407431233766, 109.849400779, 35.5907906259, 109.84899315, 35.5824734011, 2e-5,
         0.01}, // I7.A
        {"stdillum-D65", 0.312726932468, 0.329023221548, 95.0470702331, 108.882845502, 95.0429669488, 108.880054204,
         0.31e-6, 95e-6}, // I7.D65
        {"stdillum-D50", 0.336805575569, 0.357981649164, 94.0845924243, 85.2593354939, 94.0788779913, 85.2578089913,
         0.33e-6, 85e-6}, // I7.D50
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); ++i) {
        const struct illuminant_case *c = &cases[i];
        struct sr_spd s = sr_spd_named(c->name);
        double xyz[3], xy[2];
        sr_spd_xyz(&s, xyz);
        chromaticity(xyz, xy);
        EXPECT_NEAR(xy[0], c->x, c->xy_tolerance);
        EXPECT_NEAR(xy[1], c->y, c->xy_tolerance);
        EXPECT_NEAR(100 * xyz[0] / xyz[1], c->X, c->XYZ_tolerance);
        EXPECT_NEAR(100 * xyz[2] / xyz[1], c->Z, c->XYZ_tolerance);
        sum_xyz(&s, 380, 780, 5, xyz);
        EXPECT_NEAR(100 * xyz[0] / xyz[1], c->X5, c->XYZ_tolerance);
        EXPECT_NEAR(100 * xyz[2] / xyz[1], c->Z5, c->XYZ_tolerance);
    }
}

TEST(cie_d50_is_not_what_pbrt_calls_so)
{
    struct sr_spd s = sr_spd_named("illum-cieD50");
    double xyz[3], xy[2];
    sr_spd_xyz(&s, xyz);
    chromaticity(xyz, xy);
    EXPECT_NEAR(xy[0], 0.34567, 2e-5); // CIE 015:2018
    EXPECT_NEAR(xy[1], 0.35850, 2e-5);
}

TEST(illuminant_a_follows_its_formula)
{
    struct sr_spd a = sr_spd_named("stdillum-A");
    double xyz[3], xy[2];
    sr_spd_xyz(&a, xyz);
    chromaticity(xyz, xy);
    EXPECT_RELATIVE(xy[0], 0.447573548572, 1e-6); // I8.x
    EXPECT_RELATIVE(xy[1], 0.407439392691, 1e-6); // I8.y
    EXPECT_RELATIVE(sr_spd_at(&a, 560), 100, 1e-6);
}

TEST(photometry_of_lines)
{
    EXPECT_RELATIVE(683.0 * sr_luminous_efficiency(555), 683.0, 1e-6);               // I12
    EXPECT_RELATIVE(1e-3 * 683.0 * sr_luminous_efficiency(532), 0.6044293192, 1e-6); // I12b
    EXPECT_RELATIVE(683.0 / sr_luminous_efficiency(299792458.0 / 1.00027726 / 540e12 * 1e9), 683.001565986,
                    1e-6); // I12c, standard air
    EXPECT_NEAR(sr_luminous_efficiency(359.9), 0, 0);
    EXPECT_NEAR(sr_luminous_efficiency(830.1), 0, 0);
    EXPECT(sr_luminous_efficiency(830) > 0);
}

/* The mean over paths of what the film adds is the integral, whatever the spectrum. */
static void expect_estimate(struct sr_spd s, struct sr_lambda_range range, bool dispersed)
{
    struct sr_tally tally[3] = {0};
    for (uint32_t i = 0; i < 20000; ++i) {
        struct sr_wavelengths w = sr_wavelengths_sample(range, sr_u32_to_float(sr_hash_combine(i, 17)));
        if (dispersed)
            sr_wavelengths_terminate_secondary(&w);
        struct sr_xyz xyz = sr_spectrum_to_xyz(sr_spd_eval(&s, w.lambda), &w);
        sr_tally_add(&tally[0], (double)xyz.x);
        sr_tally_add(&tally[1], (double)xyz.y);
        sr_tally_add(&tally[2], (double)xyz.z);
    }
    double expected[3];
    sum_xyz(&s, 360, 830, 0.125, expected);
    for (int i = 0; i < 3; ++i)
        EXPECT_MEAN(tally[i], expected[i]);
}

TEST(film_estimates_are_unbiased)
{
    struct sr_lambda_range visible = {SR_LAMBDA_MIN, SR_LAMBDA_MAX}, wide = {300, 1000};
    expect_estimate(sr_spd_constant(1), visible, false);
    expect_estimate(sr_spd_named("stdillum-D65"), visible, false);
    expect_estimate(sr_spd_named("stdillum-F11"), visible, false);
    expect_estimate(sr_spd_named("stdillum-D65"), visible, true);
    expect_estimate(sr_spd_blackbody(3000), wide, false);
    expect_estimate(sr_spd_named("metal-Au-eta"), wide, true);
}

TEST(film_ignores_ended_wavelengths)
{
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){360, 830}, 0.3f);
    sr_wavelengths_terminate_secondary(&w);
    sr_spectrum L = SR_BLACK + NAN; // a dead lane may hold anything
    L[0] = 2;
    double bar[3];
    sr_observer_1931((double)w.lambda[0], bar);
    struct sr_xyz xyz = sr_spectrum_to_xyz(L, &w);
    EXPECT_RELATIVE(xyz.y, 2 * bar[1] / (double)w.pdf[0] / SR_LAMBDA_COUNT, 1e-5);
}

TEST(colour_checker_under_d65)
{
    static const struct {
        int patch; // column of the table
        double X, Y, Z;
    } cases[] = {
        {1, 11.1469, 10.0775, 6.8055},   {2, 37.2069, 34.5980, 25.2608},  {4, 10.5978, 13.3081, 6.9527},
        {7, 37.1302, 29.6839, 6.3449},   {13, 7.9663, 6.1396, 28.2167},   {15, 19.6231, 11.7537, 5.0282},
        {16, 56.0328, 59.3643, 9.3246},  {18, 14.6594, 19.9786, 39.2748}, {19, 86.2154, 91.2349, 95.3085},
        {22, 18.0713, 19.1279, 20.8696}, {24, 3.0525, 3.2008, 3.5399},
    };
    FILE *file = fopen(test_reference_file("spectra/colour_science_io/babelcolor_average.csv"), "r");
    EXPECT(file != NULL);
    // constant beyond 380 and 730 nm
    static float lambda[64], values[25][64];
    char line[1024];
    int count = 1;
    EXPECT(fgets(line, sizeof(line), file) != NULL);
    while (fgets(line, sizeof(line), file)) {
        char *word = line;
        lambda[count] = strtof(word, &word);
        for (int p = 1; p <= 24; ++p)
            values[p][count] = strtof(word + 1, &word);
        ++count;
    }
    fclose(file);
    EXPECT_EQUAL_INT(count, 37);
    lambda[0] = 350;
    lambda[count] = 850;
    struct sr_spd d65 = sr_spd_named("stdillum-D65");
    double white = sr_spd_luminous_integral(&d65);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); ++i) {
        float *v = values[cases[i].patch];
        v[0] = v[1];
        v[count] = v[count - 1];
        struct sr_arena arena = {0};
        struct sr_error error = {0};
        struct sr_spd patch = sr_spd_from_samples(&arena, lambda, v, count + 1, &error);
        EXPECT_EQUAL_INT(error.status, SR_OK);
        double xyz[3] = {0};
        for (int l = 360; l <= 830; ++l) {
            double bar[3];
            sr_observer_1931(l, bar);
            for (int k = 0; k < 3; ++k)
                xyz[k] +=
                    100 / white * bar[k] * (double)sr_spd_at(&d65, (float)l) * (double)sr_spd_at(&patch, (float)l);
        }
        // the catalogue gives four decimals
        EXPECT_NEAR(xyz[0], cases[i].X, 1e-4);
        EXPECT_NEAR(xyz[1], cases[i].Y, 1e-4);
        EXPECT_NEAR(xyz[2], cases[i].Z, 1e-4);
        sr_arena_free(&arena);
    }
}
