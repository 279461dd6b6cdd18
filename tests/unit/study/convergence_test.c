/* SPDX-License-Identifier: MIT */
/* Errors fall as theory says: n^-1/2 for independent numbers, up to n^-3/2 for scrambled nets on smooth functions. */
#include "study/study.h"
#include "test.h"

enum { SEEDS = 64, FIRST = 16, LAST = 4096 };

static struct sr_study_slope slope_of(const char *name, int strategy, enum sr_sampler_kind sampler)
{
    const struct sr_study_integral *integral = sr_study_integral_find(name);
    double n[SR_STUDY_POINTS], error[SR_STUDY_POINTS], time_s;
    uint32_t count = 0;
    for (uint32_t k = FIRST; k <= LAST; k *= 2, ++count) {
        n[count] = k;
        error[count] = sr_study_error(integral, strategy, sampler, 1, k, SEEDS, &time_s);
    }
    struct sr_study_slope s;
    EXPECT(sr_study_fit(n, error, count, &s));
    printf("    %-10s %-10s %-12s n^%.3f (%.3f to %.3f), error %.2e at %d\n", name, integral->strategies[strategy].name,
           sampler == SR_SAMPLER_SOBOL ? "sobol" : "independent", s.slope, s.low, s.high, error[count - 1], LAST);
    return s;
}

TEST(independent_numbers_converge_as_the_root_of_their_count)
{
    for (const struct sr_study_integral *i = sr_study_integrals; i->name; ++i)
        for (int s = 0; s < SR_STUDY_STRATEGIES && i->strategies[s].name; ++s)
            EXPECT_NEAR(slope_of(i->name, s, SR_SAMPLER_INDEPENDENT).slope, -0.5, 0.06); // RMS of 64 seeds: +-9 % each
}

TEST(scrambled_nets_converge_as_smoothness_lets_them)
{
    static const struct {
        const char *name;
        int strategy;
        double low, high;
    } expected[] = {
        {"smooth-1d", 0, -1.6, -1.4}, {"smooth-1d", 1, -1.6, -1.4}, {"smooth-2d", 0, -1.6, -1.2},
        {"smooth-2d", 1, -1.6, -1.0}, {"disk-2d", 0, -0.85, -0.65}, {"pole-2d", 0, -1.2, -0.6},
        {"pole-2d", 1, -1.6, -0.9},   {"peaked-1d", 1, -1.7, -1.2},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; ++i) {
        double slope = slope_of(expected[i].name, expected[i].strategy, SR_SAMPLER_SOBOL).slope;
        EXPECT(slope > expected[i].low && slope < expected[i].high);
    }
}

TEST(importance_sampling_reduces_the_error_where_it_follows_the_function)
{
    static const struct {
        const char *name;
        double factor; // at least
    } cases[] = {{"smooth-1d", 2}, {"peaked-1d", 3}, {"smooth-2d", 1.05}, {"pole-2d", 2.5}};
    for (size_t i = 0; i < 4; ++i) {
        const struct sr_study_integral *integral = sr_study_integral_find(cases[i].name);
        double time_s, uniform = sr_study_error(integral, 0, SR_SAMPLER_INDEPENDENT, 2, 1024, 256, &time_s),
                       importance = sr_study_error(integral, 1, SR_SAMPLER_INDEPENDENT, 2, 1024, 256, &time_s);
        printf("    %-10s uniform %.2e, importance %.2e\n", cases[i].name, uniform, importance);
        EXPECT(uniform > cases[i].factor * importance);
    }
}

TEST(fits_find_a_line_and_how_well_it_is_known)
{
    double x[12], y[12];
    struct sr_rng rng = sr_rng_seed(3, 1);
    int inside = 0;
    for (int k = 0; k < 1000; ++k) {
        for (int i = 0; i < 12; ++i) {
            x[i] = pow(2, i);
            double u = (double)sr_rng_float(&rng) + 1e-9;
            y[i] = 3 * pow(x[i], -0.75) * exp(0.1 * sr_normal_quantile(fmin(u, 1 - 1e-9)));
        }
        struct sr_study_slope s;
        EXPECT(sr_study_fit(x, y, 12, &s));
        inside += s.low <= -0.75 && -0.75 <= s.high;
    }
    EXPECT_NEAR(inside / 1000.0, 0.95, 4.9 * sqrt(0.95 * 0.05 / 1000));
    struct sr_study_slope s;
    EXPECT(!sr_study_fit(x, (const double[]){1, 0, 2, NAN}, 4, &s));
}
