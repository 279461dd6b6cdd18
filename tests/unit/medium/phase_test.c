/* SPDX-License-Identifier: MIT */
/* Henyey & Greenstein's phase function: normalised, drawn as it says, and with the mean cosine g. */
#include "test.h"
#include "medium/medium.h"

static const float gs[] = {-0.95f, -0.5f, -1e-3f, -1e-6f, 0, 1e-6f, 1e-3f, 0.3f, 0.8f, 0.99f};
enum { G_COUNT = sizeof gs / sizeof gs[0] };

static double integral(float g, double a, double b) // of 2 pi p over the cosine, by 64 nodes
{
    double x[64], w[64], sum = 0;
    sr_gauss_legendre(64, a, b, x, w);
    for (int i = 0; i < 64; ++i)
        sum += w[i] * 2 * 3.14159265358979 * (double)sr_phase_hg((float)x[i], g);
    return sum;
}

TEST(a_phase_function_is_normalised)
{
    for (int i = 0; i < G_COUNT; ++i) {
        double sum = 0, edge = gs[i] < 0 ? -1 : 1; // in pieces that grow away from the peak
        for (double lo = 0, width = 1e-4; lo < 2; lo += width, width *= 2) {
            double hi = fmin(lo + width, 2);
            sum += edge > 0 ? integral(gs[i], 1 - hi, 1 - lo) : integral(gs[i], lo - 1, hi - 1);
        }
        EXPECT_NEAR(sum, 1, fabsf(gs[i]) > 0.9f ? 2e-4 : 1e-5); // the cosine in single precision
    }
}

TEST(directions_are_drawn_as_the_phase_function_says_and_have_the_mean_cosine_g)
{
    enum { CELLS = 40, DRAWS = 40000 };
    sr_vec3 d = sr_normalize((sr_vec3){0.3f, -0.7f, 0.4f});
    struct sr_frame frame = sr_frame_from_z(d);
    for (int i = 0; i < G_COUNT; ++i) {
        float g = gs[i];
        struct sr_rng rng = sr_rng_seed(7, (uint64_t)i);
        double observed[CELLS * 4] = {0}, expected[CELLS * 4];
        struct sr_tally cosine = {0};
        for (int k = 0; k < DRAWS; ++k) {
            sr_vec3 out;
            float u = sr_rng_float(&rng), pdf = sr_phase_hg_sample(d, g, (sr_vec2){u, sr_rng_float(&rng)}, &out);
            double c = fmin(1, fmax(-1, (double)sr_dot(d, out)));
            sr_tally_add(&cosine, c);
            EXPECT_NEAR(sr_length(out), 1, 1e-6);
            if (fabsf(g) < 0.9f) // nearer to a peak the cosine in single precision has not the digits
                EXPECT_RELATIVE(pdf, sr_phase_hg((float)c, g), 2e-4);
            int cell = (int)fmin((c + 1) / 2 * CELLS, CELLS - 1);
            observed[4 * cell + (sr_dot(out, frame.x) > 0) + 2 * (sr_dot(out, frame.y) > 0)] += 1;
        }
        EXPECT_MEAN(cosine, g);
        for (int cell = 0; cell < CELLS; ++cell) { // Henyey & Greenstein's distribution function is known
            double p[2], G = (double)g;
            for (int side = 0; side < 2; ++side) {
                double c = -1 + 2.0 * (cell + side) / CELLS;
                p[side] = fabs(G) < 1e-5 ? (1 + c) / 2 - 0.75 * G * (1 - c * c)
                                         : (1 - G * G) / (2 * G) * (1 / sqrt(1 + G * G - 2 * G * c) - 1 / (1 + G));
            }
            for (int k = 0; k < 4; ++k)
                expected[4 * cell + k] = DRAWS * (p[1] - p[0]) / 4;
        }
        EXPECT_CHI2(observed, expected, CELLS * 4);
    }
}
