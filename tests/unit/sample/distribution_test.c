/* SPDX-License-Identifier: MIT */
/* Discrete and piecewise constant distributions: frequencies, densities, degenerate weights. */
#include "sample/sample.h"

#include "test.h"

static sr_u4 draw(uint32_t i)
{
    struct sr_sampler s = {.key = 11, .sample = i, .kind = SR_SAMPLER_INDEPENDENT};
    return sr_sample4(&s, 4);
}

TEST(alias_draws_each_outcome_as_often_as_its_pmf_says)
{
    struct sr_arena arena = {0};
    for (uint32_t count = 1; count <= 300; count = count * 3 + 1) {
        float weights[512];
        double expected[512], observed[512] = {0}, sum = 0, low[512] = {0};
        for (uint32_t i = 0; i < count; ++i) {
            weights[i] = i % 5 == 2 ? 0 : expf(4 * sr_u32_to_float(sr_hash_u32(i)));
            sum += (double)weights[i];
        }
        struct sr_alias a;
        EXPECT(sr_alias_build(&arena, weights, count, &a));
        int n = 100000, lows = 0;
        for (int i = 0; i < n; ++i) {
            float pmf, u = draw((uint32_t)i)[0], again;
            uint32_t k = sr_alias_sample(&a, u, &pmf, &again);
            EXPECT(weights[k] > 0 && again >= 0 && again < 1);
            EXPECT_RELATIVE(pmf, (double)weights[k] / sum, 1e-6);
            observed[k] += 1;
            low[k] += again < 0.5f;
            lows += again < 0.5f;
        }
        // granted exactly: the thresholds add up to the weights
        double share[512] = {0};
        for (uint32_t i = 0; i < count; ++i) {
            share[i] += (double)a.threshold[i] / count;
            share[a.other[i]] += (1 - (double)a.threshold[i]) / count;
            expected[i] = (double)weights[i] / sum * n;
        }
        for (uint32_t i = 0; i < count; ++i)
            EXPECT_NEAR(share[i], (double)weights[i] / sum, 1e-7);
        EXPECT_CHI2(observed, expected, count);
        EXPECT_NEAR(lows / (double)n, 0.5, 5 * 0.5 / sqrt(n));
    }
    struct sr_alias a;
    EXPECT(!sr_alias_build(&arena, (float[]){0, 0, -1, NAN}, 4, &a));
    EXPECT(!sr_alias_build(&arena, NULL, 0, &a));
    sr_arena_free(&arena);
}

TEST(piecewise1_draws_by_its_density_and_never_where_it_is_zero)
{
    struct sr_arena arena = {0};
    float f[40];
    for (int i = 0; i < 40; ++i)
        f[i] = i < 3 || i > 36 || i % 7 == 0 ? 0 : sr_u32_to_float(sr_hash_u32((uint32_t)i));
    struct sr_piecewise1 d;
    EXPECT(sr_piecewise1_build(&arena, f, 40, -3, 5, &d));
    double sum = 0, observed[40] = {0}, expected[40];
    for (int i = 0; i < 40; ++i)
        sum += (double)f[i];
    EXPECT_RELATIVE(d.integral, sum * 8 / 40, 1e-6);
    int n = 200000;
    for (int i = 0; i < 40; ++i)
        expected[i] = n * (double)f[i] / sum;
    for (int i = 0; i < n; ++i) {
        float pdf, u = i == 0 ? 0 : i == 1 ? SR_ONE_MINUS_EPSILON : draw((uint32_t)i)[0];
        uint32_t cell;
        float x = sr_piecewise1_sample(&d, u, &pdf, &cell);
        EXPECT(pdf > 0 && f[cell] > 0 && x >= -3 && x < 5);
        EXPECT(sr_piecewise1_pdf(&d, x) == pdf);
        EXPECT_RELATIVE(pdf, (double)f[cell] / d.integral, 1e-4);
        observed[cell] += 1;
    }
    EXPECT_CHI2(observed, expected, 40);
    EXPECT(sr_piecewise1_pdf(&d, 5.1f) == 0 && sr_piecewise1_pdf(&d, -3.1f) == 0 && sr_piecewise1_pdf(&d, NAN) == 0);
    // where u is on the very edge of a cell, sample and density still agree
    for (int i = 0; i < 40; ++i)
        for (int step = 0; step < 2; ++step) {
            float u = step ? d.cdf[i] : nextafterf(d.cdf[i], 0), pdf;
            if (u >= 1)
                continue;
            float x = sr_piecewise1_sample(&d, u, &pdf, NULL);
            EXPECT(sr_piecewise1_pdf(&d, x) == pdf && pdf > 0);
        }
    EXPECT(sr_piecewise1_build(&arena, (float[3]){0, 0, 0}, 3, 0, 2, &d) && d.integral == 0);
    EXPECT_NEAR(sr_piecewise1_pdf(&d, 1.9f), 0.5, 1e-6);
    EXPECT_NEAR(sr_piecewise1_sample(&d, 0.25f, NULL, NULL), 0.5, 1e-6);
    sr_arena_free(&arena);
}

TEST(piecewise2_draws_by_its_density_and_never_in_empty_rows)
{
    struct sr_arena arena = {0};
    enum { NX = 37, NY = 23 };
    static float f[NX * NY];
    static double observed[NX * NY], expected[NX * NY];
    double sum = 0;
    for (int i = 0; i < NX * NY; ++i) {
        f[i] = i / NX == 0 || i / NX == 7 || i % NX == 36 ? 0 : sr_u32_to_float(sr_hash_u32((uint32_t)i));
        sum += (double)f[i];
    }
    struct sr_piecewise2 d;
    EXPECT(sr_piecewise2_build(&arena, f, NX, NY, &d));
    EXPECT_RELATIVE(d.integral, sum / (NX * NY), 1e-6);
    int n = 300000;
    for (int i = 0; i < n; ++i) {
        sr_u4 u = draw((uint32_t)i);
        float pdf;
        sr_vec2 p = sr_piecewise2_sample(&d, (sr_vec2){u[0], u[1]}, &pdf);
        EXPECT(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
        EXPECT(sr_piecewise2_pdf(&d, p) == pdf && pdf > 0);
        int cell = (int)(p.y * NY) * NX + (int)(p.x * NX);
        EXPECT_RELATIVE(pdf, (double)f[cell] / d.integral, 1e-3);
        observed[cell] += 1;
    }
    double total = 0;
    for (int i = 0; i < NX * NY; ++i) {
        expected[i] = n * (double)f[i] / sum;
        total +=
            (double)sr_piecewise2_pdf(&d, (sr_vec2){((float)(i % NX) + 0.5f) / NX, ((float)(i / NX) + 0.5f) / NY}) /
            (NX * NY);
    }
    EXPECT_NEAR(total, 1, 1e-5);
    EXPECT_CHI2(observed, expected, NX * NY);
    static float zero[12];
    EXPECT(sr_piecewise2_build(&arena, zero, 4, 3, &d) && d.integral == 0);
    EXPECT_NEAR(sr_piecewise2_pdf(&d, (sr_vec2){0.3f, 0.9f}), 1, 1e-6);
    EXPECT(sr_piecewise2_pdf(&d, (sr_vec2){0.3f, 1.1f}) == 0 && sr_piecewise2_pdf(&d, (sr_vec2){-0.1f, 0.5f}) == 0);
    EXPECT(!sr_piecewise2_build(&arena, zero, 0, 3, &d));
    sr_arena_free(&arena);
}
