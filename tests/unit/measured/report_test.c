/* SPDX-License-Identifier: MIT */
/* The report, on tables whose faults are known. */
#include "fixtures.h"

/* f = c (1 + k cos_theta_i) / pi: not reciprocal. E(wi) = c (1 + k cos_theta_i), the largest at normal incidence; for
 * cosine-weighted pairs of which no cosine is below 0.1, with t = cos^2 even in 0.01 … 1:
 *     mean |f - f'| / mean max(f, f') = k <|c1 - c2|> / (1 + k <max(c1, c2)>) */
static float strength;
static sr_spectrum lopsided_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    (void)user;
    (void)wo;
    (void)lambda;
    return SR_BLACK + 0.7f * SR_INV_PI * (1 + strength * wi.z);
}

TEST(report_measures_a_known_asymmetry_and_energy_above_one)
{
    static const float k[] = {0, 0.3f, 0.8f};
    for (int n = 0; n < 3; ++n) {
        strength = k[n];
        struct bytes b = table_file(lopsided_f, NULL, 3, "");
        struct sr_arena arena = {0};
        struct sr_measured_report r;
        sr_measured_report(parse(&arena, &b), &r);
        enum { N = 400 };
        double difference = 0, greater = 0;
        for (int i = 0; i < N; ++i)
            for (int j = 0; j < N; ++j) {
                double a = sqrt(0.01 + 0.99 * (i + 0.5) / N), c = sqrt(0.01 + 0.99 * (j + 0.5) / N);
                difference += (double)k[n] * fabs(a - c);
                greater += 1 + (double)k[n] * fmax(a, c);
            }
        EXPECT_NEAR(r.reciprocity_mean, difference / greater, 0.02 * difference / greater + 1e-6);
        double most = (double)k[n] * 0.9 / (1 + (double)k[n]); // at the edge of what is drawn
        EXPECT(r.reciprocity_max <= most + 1e-4 && r.reciprocity_max >= 0.9 * most);
        EXPECT_NEAR(r.largest_albedo, 0.7 * (1 + (double)k[n]), 0.002);
        if (n > 0) {
            EXPECT_NEAR(r.largest_theta, 0, 10); // flat there: cos(10 deg) is 0.985
            double away[2] = {fabs(90 - r.reciprocity_theta[0]), fabs(90 - r.reciprocity_theta[1])};
            EXPECT(fmin(away[0], away[1]) < 15 && fmax(away[0], away[1]) > 60); // one grazing, one near the normal
        }
        for (int i = 0; i < SR_MEASURED_REPORT_ANGLES; ++i)
            EXPECT_NEAR(r.scatter[i].reflected, 0.7 * (1 + (double)k[n] * cos(r.scatter[i].theta * PI / 180)), 0.002);
        sr_arena_free(&arena);
        drop(&b);
    }
}

TEST(report_tells_what_the_angles_cover)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    for (int i = 20; i <= 60; i += 20)
        for (int o = 0; o <= 45; o += 15)
            for (int p = 0; p <= 180; p += 90)
                print(&b, "%d 0 %d %d %g\n", i, o, p, i == 20 && o == 0 ? -0.01 : 0.2);
    struct sr_measured_report r;
    sr_measured_report(parse(&arena, &b), &r);
    EXPECT_NEAR(r.theta_i_min, 20, 1e-3);
    EXPECT_NEAR(r.theta_i_max, 60, 1e-3);
    EXPECT_NEAR(r.theta_o_max, 45, 1e-3);
    EXPECT_NEAR(r.coverage, (0.75 - pow(sin(PI / 9), 2)) * 0.5, 1e-5); // sin^2 from edge to edge
    EXPECT_EQUAL_INT(r.values, 36);
    EXPECT_EQUAL_INT(r.invalid, 3);
    sr_arena_free(&arena);
    drop(&b);
}
