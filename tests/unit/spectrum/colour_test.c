/* SPDX-License-Identifier: MIT */
#include "spectrum/spectrum.h"
#include "test.h"

TEST(colour_spaces_follow_from_their_chromaticities)
{
    static const char *const names[] = {"srgb", "dci-p3", "rec2020", "aces2065-1"};
    for (int id = 0; id < SR_COLOUR_SPACE_COUNT; ++id) {
        const struct sr_colour_space *s = sr_colour_space((enum sr_colour_space_id)id);
        enum sr_colour_space_id found;
        EXPECT(sr_colour_space_find(names[id], &found) && (int)found == id);
        EXPECT_EQUAL_TEXT(s->name, names[id]);
        double white[3] = {0};
        for (int i = 0; i < 3; ++i) {
            const double(*m)[3] = s->xyz_from_rgb;
            double sum = m[0][i] + m[1][i] + m[2][i];
            EXPECT_NEAR(m[0][i] / sum, s->xy[i][0], 1e-12); // each column is a primary
            EXPECT_NEAR(m[1][i] / sum, s->xy[i][1], 1e-12);
            for (int j = 0; j < 3; ++j) {
                white[i] += m[i][j];
                double product = 0; // and the other matrix is its inverse
                for (int k = 0; k < 3; ++k)
                    product += s->rgb_from_xyz[i][k] * m[k][j];
                EXPECT_NEAR(product, i == j, 1e-12);
            }
        }
        EXPECT_NEAR(white[1], 1, 1e-12);
        EXPECT_NEAR(white[0] / (white[0] + white[1] + white[2]), s->xy[3][0], 1e-9);
        EXPECT_NEAR(white[1] / (white[0] + white[1] + white[2]), s->xy[3][1], 1e-9);
        // and the white is that of the illuminant
        struct sr_spd light = {.kind = SR_SPD_TABLE, .scale = 1, .table = s->illuminant};
        double xyz[3];
        sr_spd_xyz(&light, xyz);
        EXPECT_NEAR(xyz[0] / xyz[1], white[0], 1e-6);
        EXPECT_NEAR(xyz[2] / xyz[1], white[2], 1e-6);
        EXPECT_RELATIVE(xyz[1], s->illuminant_luminous_integral, 1e-6);
        struct sr_rgb rgb = sr_rgb_from_xyz(s, sr_xyz_from_rgb(s, (struct sr_rgb){0.2f, 0.5f, 1.5f}));
        EXPECT_NEAR(rgb.r, 0.2, 1e-6);
        EXPECT_NEAR(rgb.g, 0.5, 1e-6);
        EXPECT_NEAR(rgb.b, 1.5, 1e-6);
    }
    enum sr_colour_space_id none;
    EXPECT(!sr_colour_space_find("cmyk", &none));
}

TEST(srgb_matrix_and_curve_are_the_standard_ones)
{
    // IEC 61966-2-1 prints four decimals, and x = 0.3127, y = 0.3290 for the white: 3e-5 from the illuminant's own
    static const double printed[3][3] = {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(sr_colour_space(SR_SRGB)->xyz_from_rgb[i][j], printed[i][j], 2.5e-4);
    for (int i = 0; i <= 255; ++i) {
        float encoded = (float)i / 255;
        EXPECT_NEAR(sr_srgb_encode(sr_srgb_decode(encoded)), encoded, 1e-6);
    }
    EXPECT_NEAR(sr_srgb_decode(0.5f), 0.21404114, 1e-6);
    EXPECT_NEAR(sr_srgb_encode(1), 1, 1e-6);
}

TEST(daylight_locus)
{
    double xy[2];
    sr_daylight_xy(6503.6, xy);
    EXPECT_RELATIVE(xy[0], 0.31272027326, 1e-6);  // I9.x
    EXPECT_RELATIVE(xy[1], 0.329125276333, 1e-6); // I9.y
    sr_daylight_xy(5003, xy);
    EXPECT_NEAR(xy[0], 0.3457, 2e-4);
    double below[2], above[2];
    sr_daylight_xy(7000, below);
    sr_daylight_xy(7000.001, above);
    EXPECT_NEAR(below[0], above[0], 1e-5); // its two branches meet
}

TEST(white_balance_takes_white_to_white)
{
    const double a[2] = {0.44757, 0.40745}, d65[2] = {0.31272, 0.32903};
    double m[3][3], back[3][3];
    sr_white_balance(a, d65, m);
    sr_white_balance(d65, a, back);
    double from[3] = {a[0] / a[1], 1, (1 - a[0] - a[1]) / a[1]},
           to[3] = {d65[0] / d65[1], 1, (1 - d65[0] - d65[1]) / d65[1]};
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(m[i][0] * from[0] + m[i][1] * from[1] + m[i][2] * from[2], to[i], 1e-12);
        for (int j = 0; j < 3; ++j) {
            double product = 0;
            for (int k = 0; k < 3; ++k)
                product += m[i][k] * back[k][j];
            EXPECT_NEAR(product, i == j, 1e-9);
        }
    }
    // Lindbloom's published Bradford matrix from D65 to D50
    static const double published[3][3] = {
        {1.0478112, 0.0228866, -0.0501270}, {0.0295424, 0.9904844, -0.0170491}, {-0.0092345, 0.0150436, 0.7521316}};
    const double x65[2] = {0.95047 / (0.95047 + 1 + 1.08883), 1 / (0.95047 + 1 + 1.08883)},
                 x50[2] = {0.96422 / (0.96422 + 1 + 0.82521), 1 / (0.96422 + 1 + 0.82521)};
    sr_white_balance(x65, x50, m);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            EXPECT_NEAR(m[i][j], published[i][j], 1e-6);
}
