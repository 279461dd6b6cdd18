/* SPDX-License-Identifier: MIT */
/* Tallies and Pearson's test: against sums done by hand, and against their own promised error rate. */
#include "test.h"

static uint32_t draw(uint32_t *state) // xorshift
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    return *state ^= *state << 5;
}

TEST(tally_gives_mean_variance_and_largest)
{
    struct sr_tally t = {0};
    double x[] = {-5, -3, -8, -1};
    for (int i = 0; i < 4; ++i)
        sr_tally_add(&t, x[i] + 1e9);
    EXPECT_NEAR(t.mean, 1e9 - 4.25, 1e-6);
    EXPECT_NEAR(sr_tally_variance(&t), 26.75 / 3, 1e-6);
    EXPECT_NEAR(sr_tally_standard_error(&t), sqrt(26.75 / 12), 1e-6);
    EXPECT_NEAR(t.max, 1e9 - 1, 0);
    struct sr_tally negative = {0};
    sr_tally_add(&negative, -2);
    EXPECT_NEAR(negative.max, -2, 0);
}

TEST(merged_tallies_equal_one_tally)
{
    uint32_t state = 5;
    struct sr_tally all = {0}, part[3] = {{0}}, merged = {0};
    for (int i = 0; i < 1000; ++i) {
        double x = draw(&state) * 0x1p-32;
        sr_tally_add(&all, x);
        sr_tally_add(&part[i < 100 ? 0 : 1], x);
    }
    for (int i = 0; i < 3; ++i)
        sr_tally_merge(&merged, &part[i]);
    EXPECT_EQUAL_INT(merged.n, 1000);
    EXPECT_NEAR(merged.mean, all.mean, 1e-14);
    EXPECT_RELATIVE(merged.m2, all.m2, 1e-12);
    EXPECT_NEAR(merged.max, all.max, 0);
}

TEST(chi_square_rejects_true_hypotheses_as_often_as_promised)
{
    uint32_t state = 77;
    double expected[20], total = 2000;
    for (int i = 0; i < 20; ++i)
        expected[i] = total * (2 * i + 1) / 400; // from 5 to 195
    int rejected = 0, runs = 2000;
    for (int run = 0; run < runs; ++run) {
        double observed[20] = {0}, chi2;
        int degrees;
        for (int i = 0; i < 2000; ++i)
            observed[(int)(20 * sqrt(draw(&state) * 0x1p-32))] += 1;
        rejected += sr_chi2_test(observed, expected, 20, 5, &chi2, &degrees) < 0.1;
        EXPECT_EQUAL_INT(degrees, 19);
    }
    EXPECT_NEAR(rejected / (double)runs, 0.1, 5 * sqrt(0.09 / runs));
}

TEST(chi_square_sees_a_difference_pools_and_knows_the_impossible)
{
    double chi2;
    int degrees;
    double p = sr_chi2_test((double[]){60, 40}, (double[]){50, 50}, 2, 5, &chi2, &degrees);
    EXPECT_NEAR(chi2, 4, 1e-12);
    EXPECT_NEAR(p, 0.0455002638963584, 1e-12);
    // 2 + 3 make a bin of 5; the 1 that is left joins the last
    p = sr_chi2_test((double[]){4, 4, 10, 2}, (double[]){2, 3, 10, 1}, 4, 5, &chi2, &degrees);
    EXPECT_EQUAL_INT(degrees, 1);
    EXPECT_NEAR(chi2, 9.0 / 5 + 1.0 / 11, 1e-12);
    EXPECT(sr_chi2_test((double[]){50, 50, 1}, (double[]){50, 50, 0}, 3, 5, &chi2, &degrees) == 0);
    EXPECT(sr_chi2_test((double[]){3, 0}, (double[]){2, 1}, 2, 5, &chi2, &degrees) == 1);
}
