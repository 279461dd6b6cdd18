/* SPDX-License-Identifier: MIT */
/* Directions drawn from data: their density is the one that pdf tells, and they estimate the albedo. */
#include "fixtures.h"

static struct gloss satin = {.base = 0.4f, .lobe = 0.8f, .exponent = 60};

/* Counts in cells of the half vector (the guide's cells by twos), against the integral of pdf over them by 8 x 8
 * points: in solid angle of m the density is smooth inside of a cell, but for the horizon. What is lost below it is a
 * cell of its own. */
static void expect_sampler_draws_by_pdf(const struct sr_measured *m, bool is_isotropic, sr_vec3 wo)
{
    enum { NU = 16, NV = 16, SUB = 8, DRAWS = 40000 };
    int nu = is_isotropic ? 16 : 10, nv = is_isotropic ? 16 : 12;
    static double observed[2 * NU * NV + 1], expected[2 * NU * NV + 1];
    memset(observed, 0, sizeof observed);
    memset(expected, 0, sizeof expected);
    double phi_o = is_isotropic ? atan2((double)wo.y, (double)wo.x) : 0, total = 0;
    sr_vec3 up = {wo.x, wo.y, fabsf(wo.z)};
    for (int cell = 0; cell < 2 * nu * nv; ++cell) {
        int side = cell / nu / nv, i = cell / nv % nu, j = cell % nv;
        double sum = 0;
        for (int k = 0; k < SUB * SUB; ++k) {
            double u = (i + (k % SUB + 0.5) / SUB) / nu, half = 0.5 / SUB / nu,
                   phi = phi_o + 2 * PI * (j + (k / SUB + 0.5) / SUB) / nv;
            double theta = u * u * PI / 2, lo = (u - half) * (u - half) * PI / 2, hi = (u + half) * (u + half) * PI / 2;
            // exact, as pdf may be large near n
            double omega = 2 * sin((lo + hi) / 2) * sin((hi - lo) / 2) * 2 * PI / nv / SUB;
            sr_vec3 h = direction(theta * 180 / PI, phi * 180 / PI);
            float c = sr_dot(up, h);
            sr_vec3 wi = sr_sub(sr_scale(2 * c, h), up);
            if (!(c > 0 && wi.z > 0))
                continue;
            wi.z = (wo.z < 0) != (side == 1) ? -wi.z : wi.z;
            sum += (double)sr_measured_pdf(m, wo, wi) * 4 * (double)c * omega;
        }
        expected[cell] = fmax(sum * DRAWS, 1e-6); // of slivers above the horizon no point may be seen
        total += expected[cell];
    }
    int last = 2 * nu * nv;
    expected[last] = fmax(DRAWS - total, 0);
    struct sr_rng rng = sr_rng_seed(7, 1);
    for (int n = 0; n < DRAWS; ++n) {
        sr_vec3 wi;
        float pdf, u = sr_rng_float(&rng);
        sr_vec2 v = {sr_rng_float(&rng), sr_rng_float(&rng)};
        if (!sr_measured_sample(m, wo, u, v, &wi, &pdf)) {
            observed[last]++;
            continue;
        }
        EXPECT_NEAR(sr_length(wi), 1, 1e-5);
        EXPECT_RELATIVE(pdf, sr_measured_pdf(m, wo, wi), 0);
        int side = wo.z * wi.z < 0;
        sr_vec3 h = sr_normalize(sr_add(up, (sr_vec3){wi.x, wi.y, fabsf(wi.z)}));
        double theta = atan2(sqrt((double)(h.x * h.x + h.y * h.y)), (double)h.z),
               turn = (atan2((double)h.y, (double)h.x) - phi_o) / (2 * PI);
        int i = (int)fmin(nu - 1, nu * sqrt(theta * 2 / PI)), j = (int)fmin(nv - 1, nv * (turn - floor(turn)));
        observed[(side * nu + i) * nv + j]++;
    }
    EXPECT_CHI2(observed, expected, (size_t)last + 1);
}

/* Mean of f |cos| / pdf against the integral of f |cos_theta_i| dwi. */
static void expect_weights_average_to_the_albedo(const struct sr_measured *m, sr_vec3 wo)
{
    struct sr_rng rng = sr_rng_seed(5, 1);
    struct sr_tally tally = {0};
    for (int n = 0; n < 40000; ++n) {
        sr_vec3 wi;
        float pdf, u = sr_rng_float(&rng);
        sr_vec2 v = {sr_rng_float(&rng), sr_rng_float(&rng)};
        bool drawn = sr_measured_sample(m, wo, u, v, &wi, &pdf);
        sr_tally_add(&tally, drawn ? (double)(sr_measured_f(m, wo, wi, SR_BLACK + 550)[0] * fabsf(wi.z) / pdf) : 0);
    }
    enum { N = 200 };
    double sum = 0, x[N], w[N];
    sr_gauss_legendre(N, 0, 1, x, w);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
            double theta = PI / 2 * x[i], phi = 2 * PI * (j + 0.5) / N;
            for (int side = 0; side < 2; ++side) {
                sr_vec3 wi = direction(side ? 180 - theta * 180 / PI : theta * 180 / PI, phi * 180 / PI);
                sum += w[i] * PI / 2 * 2 * PI / N * sin(theta) * cos(theta) *
                       (double)sr_measured_f(m, wo, wi, SR_BLACK + 550)[0];
            }
        }
    double error = sr_tally_standard_error(&tally);
    if (!(fabs(tally.mean - sum) < 4.9 * error + 0.003 * sum)) // the quadrature's own error at jumps and peaks
        test_fail(__FILE__, __LINE__, "weights average to %g +- %g, the albedo is %g", tally.mean, error, sum);
}

static void check(const struct sr_measured *m, bool is_isotropic, bool has_back)
{
    static const double theta[] = {0, 23, 60, 84};
    for (int i = 0; i < 4; ++i) {
        sr_vec3 wo = direction(theta[i], 40);
        expect_sampler_draws_by_pdf(m, is_isotropic, wo);
        if (i < 3)
            expect_weights_average_to_the_albedo(m, wo);
    }
    if (has_back)
        expect_sampler_draws_by_pdf(m, is_isotropic, direction(150, -70));
}

TEST(sampler_of_an_isotropic_table_draws_by_pdf)
{
    struct bytes b = rgl_file(gloss_f, &satin, 0, false);
    struct sr_arena arena = {0};
    const struct sr_measured *m = parse(&arena, &b);
    check(m, true, true);
    // light is drawn where it is: weights do not scatter much more than a good lobe's
    struct sr_rng rng = sr_rng_seed(2, 1);
    struct sr_tally tally = {0};
    for (int n = 0; n < 20000; ++n) {
        sr_vec3 wi, wo = direction(45, 0);
        float pdf, u = sr_rng_float(&rng);
        sr_vec2 v = {sr_rng_float(&rng), sr_rng_float(&rng)};
        bool drawn = sr_measured_sample(m, wo, u, v, &wi, &pdf);
        sr_tally_add(&tally, drawn ? (double)(sr_measured_f(m, wo, wi, SR_BLACK + 550)[0] * wi.z / pdf) : 0);
    }
    EXPECT(sqrt(sr_tally_variance(&tally)) < 0.4 * tally.mean);
    sr_arena_free(&arena);
    drop(&b);
}

static sr_spectrum brushed_f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    (void)user;
    (void)lambda;
    sr_vec3 h = sr_normalize(sr_add(wo, wi));
    return SR_BLACK + 0.05f + 2 * expf(-(8 * h.x * h.x + 120 * h.y * h.y));
}

TEST(sampler_of_an_anisotropic_file_draws_by_pdf)
{
    struct bytes b = rgl_file(brushed_f, NULL, 2, false);
    struct sr_arena arena = {0};
    check(parse(&arena, &b), false, true);
    sr_arena_free(&arena);
    drop(&b);
}

/* Patches of Klems' quarter basis are the cells; in each of them p is a number times the cosine. */
static void expect_patches_are_drawn_by_pdf(const struct sr_measured *m, sr_vec3 wo)
{
    static const double edges[6] = {0, 9, 27, 45, 63, 90};
    static const int phis[5] = {1, 8, 12, 12, 8};
    enum { DRAWS = 40000 };
    double observed[83] = {0}, expected[83] = {0}, total = 0;
    int first[2][5], cell = 0;
    for (int side = 0; side < 2; ++side)
        for (int ring = 0; ring < 5; ++ring) {
            first[side][ring] = cell;
            double lo = pow(cos(edges[ring] * PI / 180), 2), hi = pow(cos(edges[ring + 1] * PI / 180), 2);
            for (int p = 0; p < phis[ring]; ++p, ++cell) {
                for (int k = 0; k < 64; ++k) {
                    double c = sqrt(lo + (hi - lo) * (k % 8 + 0.5) / 8),
                           phi = 2 * PI * (p + (k / 8 + 0.5) / 8 - 0.5) / phis[ring];
                    sr_vec3 wi = {(float)(sqrt(1 - c * c) * cos(phi)), (float)(sqrt(1 - c * c) * sin(phi)),
                                  (float)(side ? -c : c)};
                    expected[cell] += DRAWS * (double)sr_measured_pdf(m, wo, wi) / c * PI * (lo - hi) / phis[ring] / 64;
                }
                total += expected[cell];
            }
        }
    EXPECT_NEAR(total, DRAWS, 1e-3 * DRAWS); // nothing is lost
    struct sr_rng rng = sr_rng_seed(7, 1);
    struct sr_tally tally = {0};
    for (int n = 0; n < DRAWS; ++n) {
        sr_vec3 wi;
        float pdf, u = sr_rng_float(&rng);
        sr_vec2 v = {sr_rng_float(&rng), sr_rng_float(&rng)};
        EXPECT(sr_measured_sample(m, wo, u, v, &wi, &pdf));
        double theta = acos(fmin(1, fabs((double)wi.z))) * 180 / PI,
               turn = atan2((double)wi.y, (double)wi.x) / (2 * PI);
        int ring = 0;
        while (ring < 4 && theta >= edges[ring + 1])
            ++ring;
        int p = (int)((turn - floor(turn)) * phis[ring] + 0.5) % phis[ring];
        observed[first[wi.z < 0][ring] + p]++;
        sr_tally_add(&tally, (double)(sr_measured_f(m, wo, wi, SR_BLACK + 550)[0] * fabsf(wi.z) / pdf));
    }
    EXPECT_CHI2(observed, expected, 83);
    EXPECT(sqrt(sr_tally_variance(&tally)) < 1e-4 * tally.mean); // what is drawn exactly has no variance
}

TEST(sampler_of_a_sheet_draws_both_sides_by_pdf_without_variance)
{
    static const char *const ways[4] = {"Transmission Front", "Transmission Back", "Reflection Front",
                                        "Reflection Back"};
    for (int missing = 0; missing < 5; ++missing) { // a way of transmission that is missing is the other reversed
        struct bytes b = {0};
        struct sr_arena arena = {0};
        xml_begin(&b, missing == 2 ? "Rows" : "Columns");
        for (int d = 0; d < 4; ++d) {
            if (d == missing && d != 2)
                continue;
            xml_block_begin(&b, "Visible", ways[d], "LBNL/Klems Quarter", false);
            for (int i = 0; i < 41 * 41; ++i)
                print(&b, "%g ", (i % 42 == 0 ? 2.0 : 0.02 * (d + 1)) + 0.01 * (i % 7));
            xml_block_end(&b);
        }
        xml_end(&b);
        const struct sr_measured *m = parse(&arena, &b);
        static const double theta[] = {0, 23, 60, 84, 150};
        for (int i = 0; i < 5; ++i)
            expect_patches_are_drawn_by_pdf(m, direction(theta[i], 40));
        sr_arena_free(&arena);
        drop(&b);
    }
}

TEST(sampler_of_scattered_measurements_draws_by_pdf)
{
    struct bytes b = cornell_file(gloss_f, &satin);
    struct sr_arena arena = {0};
    check(parse(&arena, &b), true, false);
    sr_arena_free(&arena);
    drop(&b);
}

TEST(sampler_of_a_narrow_peak_draws_by_pdf)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    print(&b, "ABg\n1e-4 1e-6 2.5\n");
    const struct sr_measured *m = parse(&arena, &b);
    for (int i = 0; i < 3; ++i)
        expect_sampler_draws_by_pdf(m, true, direction(30 * i, 0));
    sr_arena_free(&arena);
    drop(&b);
}

TEST(sampler_of_a_black_file_still_draws_by_pdf)
{
    struct bytes b = {0};
    struct sr_arena arena = {0};
    for (int i = 0; i < 4; ++i)
        print(&b, "%d 0 0 0 0\n", 10 * i);
    expect_sampler_draws_by_pdf(parse(&arena, &b), true, direction(30, 10));
    sr_arena_free(&arena);
    drop(&b);
}
