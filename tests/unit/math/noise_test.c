/* SPDX-License-Identifier: MIT */
/* Gradient noise: a published value, its zeros, its period and symmetry, and sums of octaves against their definition.
 */
#include "test.h"

static const sr_vec3 nothing;

TEST(noise_has_perlins_value)
{
    // the value that "Improving noise" implementations print for this point
    EXPECT_NEAR(sr_noise((sr_vec3){3.14f, 42, 7}), 0.136919958784, 1e-6);
}

TEST(noise_is_zero_at_whole_numbers_and_repeats_after_256)
{
    for (int i = -40; i < 40; ++i) {
        sr_vec3 whole = {(float)i, (float)(3 * i + 1), (float)(7 - 5 * i)};
        EXPECT(sr_noise(whole) == 0);
        sr_vec3 p = {whole.x + 0.25f, whole.y + 0.5f, whole.z + 0.125f};
        EXPECT_NEAR(sr_noise(p), sr_noise(sr_add(p, (sr_vec3){256, -256, 512})), 0);
        EXPECT(fabsf(sr_noise(p)) <= 1.04f);
    }
    EXPECT(isfinite(sr_noise((sr_vec3){1e30f, INFINITY, NAN})));
}

TEST(noise_is_smooth_across_cells)
{
    // value, slope and curvature are continuous at a cell's border: the third difference shrinks as its step
    for (int i = 0; i < 20; ++i) {
        double h = 1.0 / 64, f[4];
        for (int k = 0; k < 4; ++k)
            f[k] = (double)sr_noise((sr_vec3){(float)(i - 1.5 * h + k * h), 0.37f + (float)i, 0.61f});
        EXPECT_NEAR((f[3] - 3 * f[2] + 3 * f[1] - f[0]) / (h * h), 0, 1.5);
    }
}

TEST(octaves_add_up_and_the_footprint_ends_them)
{
    sr_vec3 p = {0.3f, 1.7f, -2.2f};
    double sum = 0, absolute = 0, frequency = 1, weight = 1;
    for (int i = 0; i < 6; ++i) {
        double n = (double)sr_noise(sr_scale((float)frequency, p));
        sum += weight * n;
        absolute += weight * fabs(n);
        frequency *= 1.99;
        weight *= 0.6;
    }
    EXPECT_NEAR(sr_fbm(p, nothing, nothing, 0.6f, 6), sum, 1e-5);
    EXPECT_NEAR(sr_turbulence(p, nothing, nothing, 0.6f, 6), absolute + weight * 0.2, 1e-5);
    // a footprint of 2^-4: log2 of its inverse, less 1, is 3 octaves
    sr_vec3 footprint = {0, 0x1p-4f, 0};
    EXPECT_NEAR(sr_fbm(p, nothing, footprint, 0.6f, 6), sr_fbm(p, nothing, nothing, 0.6f, 3), 1e-5);
    EXPECT(sr_fbm(p, (sr_vec3){1, 0, 0}, nothing, 0.6f, 6) == 0);
    // a quarter of an octave is not shown, three quarters are shown whole, a half by half
    sr_vec3 quarter = {0x1p-4f / exp2f(0.25f), 0, 0}, half = {0x1p-4f / exp2f(0.5f), 0, 0};
    EXPECT_NEAR(sr_fbm(p, quarter, nothing, 0.6f, 6), sr_fbm(p, nothing, nothing, 0.6f, 3), 1e-5);
    float between = 0.5f * (sr_fbm(p, nothing, nothing, 0.6f, 3) + sr_fbm(p, nothing, nothing, 0.6f, 4));
    EXPECT_NEAR(sr_fbm(p, half, nothing, 0.6f, 6), between, 1e-5);
}
