/* SPDX-License-Identifier: MIT */
/* Wavelength sampling: the density is the stated one, it integrates to 1, and the samples follow it. */
#include "sample/sample.h"
#include "spectrum/spectrum.h"
#include "test.h"

static const struct sr_lambda_range ranges[] = {{360, 830},  {380, 780}, {549, 551},      {300, 2500},
                                                {700, 1100}, {250, 400}, {632.7f, 632.9f}};
#define RANGES (sizeof(ranges) / sizeof(ranges[0]))

// share of the sech^2 law between lo and x
static double law(struct sr_lambda_range r, double x)
{
    double a = 0.0072, b = 538, lo = tanh(a * ((double)r.lo - b)), hi = tanh(a * ((double)r.hi - b));
    return (tanh(a * (x - b)) - lo) / (hi - lo);
}

TEST(wavelengths_have_the_density_they_claim)
{
    for (size_t k = 0; k < RANGES; ++k) {
        for (uint32_t i = 0; i < 1000; ++i) {
            float u = sr_u32_to_float(sr_hash_u32(i + 1));
            struct sr_wavelengths w = sr_wavelengths_sample(ranges[k], u);
            for (int j = 0; j < SR_LAMBDA_COUNT; ++j) {
                double lambda = (double)w.lambda[j], c = cosh(0.0072 * (lambda - 538));
                double width =
                    tanh(0.0072 * ((double)ranges[k].hi - 538)) - tanh(0.0072 * ((double)ranges[k].lo - 538));
                double v = fmod((double)u + j / (double)SR_LAMBDA_COUNT, 1);
                EXPECT(w.lambda[j] >= ranges[k].lo && w.lambda[j] <= ranges[k].hi);
                // an ulp of a wavelength moves the density by up to 2 a ulp = 3.5e-6 (beyond 2048 nm)
                EXPECT_RELATIVE(w.pdf[j], 0.0072 / (c * c) / width, 8e-6);
                EXPECT_NEAR(law(ranges[k], lambda), v, 1e-6 + 1e-4 * (double)w.pdf[j]); // within 1e-4 nm
            }
        }
    }
}

TEST(wavelengths_follow_their_density)
{
    enum { CELLS = 64, N = 40000 };
    for (size_t k = 0; k < 2; ++k) {
        double observed[CELLS] = {0}, expected[CELLS];
        double step = (double)(ranges[k].hi - ranges[k].lo) / CELLS;
        for (uint32_t i = 0; i < N; ++i) {
            // one random lane of each draw: lanes of the same path are not independent
            uint32_t h = sr_hash_combine(i, 5);
            struct sr_wavelengths w = sr_wavelengths_sample(ranges[k], sr_u32_to_float(h));
            int cell = (int)(((double)w.lambda[sr_hash_u32(h) % SR_LAMBDA_COUNT] - (double)ranges[k].lo) / step);
            observed[cell < CELLS ? cell : CELLS - 1] += 1;
        }
        for (int c = 0; c < CELLS; ++c) {
            double from = (double)ranges[k].lo + c * step;
            expected[c] = N * (law(ranges[k], from + step) - law(ranges[k], from));
        }
        EXPECT_CHI2(observed, expected, CELLS);
    }
}

TEST(wavelengths_are_stratified_and_finite_at_the_ends)
{
    struct sr_wavelengths first = sr_wavelengths_sample(ranges[0], 0),
                          last = sr_wavelengths_sample(ranges[0], SR_ONE_MINUS_EPSILON);
    EXPECT_NEAR(first.lambda[0], 360, 0);
    EXPECT_NEAR(last.lambda[0], 830, 1e-3);
    for (int j = 1; j < SR_LAMBDA_COUNT; ++j)
        EXPECT(first.lambda[j] > first.lambda[j - 1]);
    // far infrared: the density has vanished there, but nothing may break
    struct sr_wavelengths far = sr_wavelengths_sample((struct sr_lambda_range){8000, 14000}, 0.7f);
    for (int j = 0; j < SR_LAMBDA_COUNT; ++j)
        EXPECT(isfinite(far.lambda[j]) && far.lambda[j] >= 8000 && far.lambda[j] <= 14000 && isfinite(far.pdf[j]) &&
               far.pdf[j] > 0);
}

TEST(wavelengths_end_once)
{
    struct sr_wavelengths w = sr_wavelengths_sample(ranges[0], 0.4f);
    EXPECT(!sr_wavelengths_secondary_terminated(&w));
    float pdf = w.pdf[0];
    for (int i = 0; i < 2; ++i) {
        sr_wavelengths_terminate_secondary(&w);
        EXPECT(sr_wavelengths_secondary_terminated(&w));
        EXPECT_NEAR(w.pdf[0], pdf / SR_LAMBDA_COUNT, 0);
        for (int j = 1; j < SR_LAMBDA_COUNT; ++j)
            EXPECT(w.pdf[j] == 0);
    }
}
