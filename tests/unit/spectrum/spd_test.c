/* SPDX-License-Identifier: MIT */
#include "sample/sample.h"
#include "spectrum/spectrum.h"
#include "test.h"

TEST(exp_is_accurate_everywhere)
{
    double worst = 0;
    for (int i = 0; i <= 1750000; i += SR_LAMBDA_COUNT) {
        sr_spectrum x;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            x[k] = -87.3f + 1e-4f * (float)(i + k);
        sr_spectrum y = sr_spectrum_exp(x);
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            if (x[k] < 88.7f)
                worst = fmax(worst, fabs((double)y[k] / exp((double)x[k]) - 1));
    }
    EXPECT_NEAR(worst, 0, 2.5e-7);
    sr_spectrum special = SR_BLACK;
    special[0] = -INFINITY;
    special[1] = INFINITY;
    special[2] = NAN;
    special = sr_spectrum_exp(special);
    EXPECT(special[0] == 0 && special[1] == INFINITY && isnan(special[2]) && special[3] == 1);
    EXPECT(sr_spectrum_exp(SR_BLACK - 1000.0f)[0] == 0);
}

TEST(lanes_agree_with_single_wavelengths)
{
    struct sr_spd all[] = {
        sr_spd_constant(0.3f),
        sr_spd_named("metal-Au-k"),
        sr_spd_from_rgb_albedo(SR_SRGB, (struct sr_rgb){0.2f, 0.7f, 0.1f}),
        sr_spd_from_rgb_illuminant(SR_REC2020, (struct sr_rgb){3, 1, 2}),
        sr_spd_blackbody(4000),
        {.kind = SR_SPD_NONE},
    };
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); ++i) {
        struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){300, 900}, 0.11f * (float)i);
        sr_spectrum value = sr_spd_eval(&all[i], w.lambda);
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
            EXPECT_NEAR(value[k], sr_spd_at(&all[i], w.lambda[k]), 0);
            if (w.lambda[k] >= 360 && w.lambda[k] <= 830)
                EXPECT(value[k] <= sr_spd_max(&all[i]) * 1.001f);
        }
    }
}

TEST(sigmoid_is_bounded_and_its_maximum_is_found)
{
    for (uint32_t i = 0; i < 2000; ++i) {
        float v[3];
        for (uint32_t k = 0; k < 3; ++k)
            v[k] = sr_u32_to_float(sr_hash_combine(i, k));
        struct sr_spd s = sr_spd_from_rgb_albedo(SR_DCI_P3, (struct sr_rgb){v[0], v[1], v[2]});
        float max = 0;
        for (float lambda = 360; lambda <= 830; lambda += 1) {
            float at = sr_spd_at(&s, lambda);
            EXPECT(at >= 0 && at <= 1);
            max = fmaxf(max, at);
        }
        EXPECT(sr_spd_max(&s) >= max - 1e-5f &&
               sr_spd_max(&s) <= max + 0.02f); // c0, c1, c2 cancel: x has about 5 digits
    }
    struct sr_sigmoid c = {1e-4f, -0.11f, 28};
    double x = (1e-4 * 517 - 0.11) * 517 + 28;
    EXPECT_RELATIVE(sr_sigmoid_eval(c, SR_BLACK + 517.0f)[1], 0.5 + x / (2 * sqrt(1 + x * x)), 2e-5);
}

TEST(samples_are_linear_between_and_zero_outside)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    const float lambda[] = {400, 405, 500, 620.5f}, values[] = {1, 3, 0, 2};
    struct sr_spd s = sr_spd_from_samples(&arena, lambda, values, 4, &error);
    EXPECT_EQUAL_INT(error.status, SR_OK);
    EXPECT_EQUAL_INT(s.kind, SR_SPD_TABLE);
    EXPECT_NEAR(sr_spd_at(&s, 399.9f), 0, 0);
    EXPECT_NEAR(sr_spd_at(&s, 620.6f), 0, 0);
    EXPECT_NEAR(sr_spd_at(&s, 400), 1, 1e-5);
    EXPECT_NEAR(sr_spd_at(&s, 620.5f), 2, 1e-5);
    for (float l = 400; l < 620; l += 3.1f) {
        int k = l < 405 ? 0 : l < 500 ? 1 : 2;
        float t = (l - lambda[k]) / (lambda[k + 1] - lambda[k]);
        // the even table cannot bend inside a step: near a kink it is off by at most (change of slope) * step / 4
        bool at_kink = fabsf(l - 405) < 1 || fabsf(l - 500) < 1;
        EXPECT_NEAR(sr_spd_at(&s, l), sr_lerp(t, values[k], values[k + 1]), at_kink ? 0.15 : 1e-4);
    }
    // even pairs are taken as they are
    const float even[] = {300, 1300, 2300}, ramp[] = {0, 1, 0};
    s = sr_spd_from_samples(&arena, even, ramp, 3, &error);
    EXPECT_EQUAL_INT(s.table->count, 3);
    EXPECT_NEAR(sr_spd_at(&s, 800), 0.5, 1e-6);
    EXPECT_NEAR(sr_spd_at(&s, 1800), 0.5, 1e-6);
    EXPECT_NEAR(sr_spd_at(&s, 2300), 0, 1e-6);
    // a narrow line is kept: its area is height times half width
    const float line[] = {400, 545.9f, 546.1f, 546.3f, 700}, peak[] = {0, 0, 10, 0, 0};
    s = sr_spd_from_samples(&arena, line, peak, 5, &error);
    double area = 0;
    for (int32_t i = 0; i < s.table->count; ++i)
        area += (double)s.table->values[i] * (double)s.table->step;
    EXPECT_NEAR(area, 2.0, 0.1);
    EXPECT_EQUAL_INT(error.status, SR_OK);
    sr_arena_free(&arena);
}

static void expect_refused(const float *lambda, const float *values, int count, const char *word)
{
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct sr_spd s = sr_spd_from_samples(&arena, lambda, values, count, &error);
    EXPECT_EQUAL_INT(s.kind, SR_SPD_NONE);
    EXPECT(s.table == NULL);
    EXPECT_EQUAL_INT(error.status, SR_ERROR_INPUT);
    EXPECT(strstr(error.text, word) != NULL);
    sr_arena_free(&arena);
}

TEST(samples_that_make_no_sense_are_refused)
{
    expect_refused((const float[]){500, 400, 600}, (const float[]){1, 1, 1}, 3, "increase");
    expect_refused((const float[]){500, 500}, (const float[]){1, 2}, 2, "increase");
    expect_refused(NULL, NULL, 0, "two pairs");
    expect_refused((const float[]){500}, (const float[]){1}, 1, "two pairs");
    expect_refused((const float[]){400, NAN, 600}, (const float[]){1, 1, 1}, 3, "finite");
    expect_refused((const float[]){400, 500}, (const float[]){1, INFINITY}, 2, "finite");
    expect_refused((const float[]){-400, 500}, (const float[]){1, 1}, 2, "positive");
}

TEST(named_spectra_resolve)
{
    static const char *const pbrt[] = {
        "glass-BK7",    "glass-BAF10",    "glass-FK51A",  "glass-LASF9",    "glass-F5",     "glass-F10",
        "glass-F11",    "metal-Ag-eta",   "metal-Ag-k",   "metal-Al-eta",   "metal-Al-k",   "metal-Au-eta",
        "metal-Au-k",   "metal-Cu-eta",   "metal-Cu-k",   "metal-CuZn-eta", "metal-CuZn-k", "metal-MgO-eta",
        "metal-MgO-k",  "metal-TiO2-eta", "metal-TiO2-k", "stdillum-A",     "stdillum-D50", "stdillum-D65",
        "stdillum-E",   "stdillum-F1",    "stdillum-F2",  "stdillum-F3",    "stdillum-F4",  "stdillum-F5",
        "stdillum-F6",  "stdillum-F7",    "stdillum-F8",  "stdillum-F9",    "stdillum-F10", "stdillum-F11",
        "stdillum-F12", "illum-acesD60",  "illum-cieD50", "glass-SF5",      "glass-SF10",   "glass-SF11",
    };
    int count = 0;
    while (sr_spd_name(count))
        ++count;
    EXPECT_EQUAL_INT(count, sizeof(pbrt) / sizeof(pbrt[0]));
    EXPECT(sr_spd_name(-1) == NULL);
    for (int i = 0; i < count; ++i) {
        struct sr_spd s = sr_spd_named(pbrt[i]);
        EXPECT(s.kind != SR_SPD_NONE);
        EXPECT(sr_spd_named(sr_spd_name(i)).kind != SR_SPD_NONE);
        bool may_be_zero = strcmp(pbrt[i] + strlen(pbrt[i]) - 2, "-k") == 0;
        for (float lambda = 360; lambda <= 830; lambda += 10) // no gap at either end
            EXPECT(may_be_zero ? sr_spd_at(&s, lambda) >= 0 : sr_spd_at(&s, lambda) > 0);
    }
    EXPECT_EQUAL_INT(sr_spd_named("metal-Xx-eta").kind, SR_SPD_NONE);
}

TEST(materials_have_their_published_values)
{
    // n_d at 587.56 nm and the Abbe number (n_d - 1) / (n_F - n_C), as Schott's catalogue prints them
    static const struct {
        const char *name;
        double n_d, abbe;
    } glasses[] = {{"glass-BK7", 1.51680, 64.17},   {"glass-BAF10", 1.67003, 47.11}, {"glass-FK51A", 1.48656, 84.47},
                   {"glass-LASF9", 1.85025, 32.17}, {"glass-F5", 1.67271, 32.25},    {"glass-F10", 1.72828, 28.53},
                   {"glass-SF11", 1.78472, 25.68}};
    for (size_t i = 0; i < sizeof(glasses) / sizeof(glasses[0]); ++i) {
        struct sr_spd s = sr_spd_named(glasses[i].name);
        double n_d = (double)sr_spd_at(&s, 587.5618f);
        EXPECT_NEAR(n_d, glasses[i].n_d, 1e-5);
        EXPECT_NEAR((n_d - 1) / ((double)sr_spd_at(&s, 486.1327f) - (double)sr_spd_at(&s, 656.2725f)), glasses[i].abbe,
                    0.02);
    }
    static const struct {
        const char *name;
        float lambda;
        double value;
    } metals[] = {{"metal-Cu-eta", 563.564453f, 0.826},    {"metal-Cu-k", 652.548279f, 3.67},
                  {"metal-MgO-eta", 589.258972f, 1.73737}, {"metal-TiO2-eta", 520.049988f, 3.0},
                  {"metal-CuZn-eta", 500, 0.686},          {"metal-CuZn-k", 655, 3.7365},
                  {"metal-Cu-eta", 360, 1.2803835},        {"metal-MgO-eta", 829, 1.72872}};
    for (size_t i = 0; i < sizeof(metals) / sizeof(metals[0]); ++i) {
        struct sr_spd s = sr_spd_named(metals[i].name);
        EXPECT_NEAR(sr_spd_at(&s, metals[i].lambda), metals[i].value, 3e-3); // tables of 1 nm cut kinks
    }
}
