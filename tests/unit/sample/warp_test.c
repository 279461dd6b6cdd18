/* SPDX-License-Identifier: MIT */
/* Warps against their densities (chi-square over grids) and against closed forms. */
#include "sample/sample.h"

#include "test.h"

static sr_u4 draw(uint32_t i)
{
    struct sr_sampler s = {.key = 2024, .sample = i, .kind = SR_SAMPLER_INDEPENDENT};
    return sr_sample4(&s, 1);
}

static sr_vec2 uv(uint32_t i)
{
    sr_u4 u = draw(i);
    return (sr_vec2){u[0], u[1]};
}

enum { GRID = 24, DRAWS = 200000 };

/* counts over cells that should be equally likely: a share of 0 … 1 in each of two coordinates */
static void expect_uniform(double (*coordinates)(sr_vec2 u, double *b))
{
    static double observed[GRID * GRID], expected[GRID * GRID];
    memset(observed, 0, sizeof observed);
    for (uint32_t i = 0; i < DRAWS; ++i) {
        double b, a = coordinates(uv(i), &b);
        EXPECT(a > -1e-6 && a < 1 + 1e-6 && b > -1e-6 && b < 1 + 1e-6);
        int x = (int)fmin(fmax(a * GRID, 0), GRID - 1), y = (int)fmin(fmax(b * GRID, 0), GRID - 1);
        observed[y * GRID + x] += 1;
    }
    for (int i = 0; i < GRID * GRID; ++i)
        expected[i] = (double)DRAWS / (GRID * GRID);
    EXPECT_CHI2(observed, expected, GRID * GRID);
}

static double azimuth(float x, float y)
{
    double turn = atan2((double)y, (double)x) / (2 * M_PI);
    return turn < 0 ? turn + 1 : turn;
}

static double of_disk(sr_vec2 u, double *b)
{
    sr_vec2 d = sr_warp_disk(u);
    *b = azimuth(d.x, d.y);
    return (double)(d.x * d.x + d.y * d.y);
}

static double of_sphere(sr_vec2 u, double *b)
{
    sr_vec3 d = sr_warp_uniform_sphere(u);
    EXPECT_NEAR(sr_length(d), 1, 1e-6);
    *b = azimuth(d.x, d.y);
    return 0.5 * (1 + (double)d.z);
}

static double of_hemisphere(sr_vec2 u, double *b)
{
    sr_vec3 d = sr_warp_uniform_hemisphere(u);
    EXPECT_NEAR(sr_length(d), 1, 1e-6);
    *b = azimuth(d.x, d.y);
    return (double)d.z;
}

static double of_cosine(sr_vec2 u, double *b)
{
    sr_vec3 d = sr_warp_cosine_hemisphere(u);
    EXPECT_NEAR(sr_length(d), 1, 1e-6);
    EXPECT(d.z >= 0);
    *b = azimuth(d.x, d.y);
    return (double)(d.z * d.z);
}

static double of_wide_cone(sr_vec2 u, double *b)
{
    sr_vec3 d = sr_warp_uniform_cone(u, 1.5f);
    EXPECT_NEAR(sr_length(d), 1, 1e-6);
    *b = azimuth(d.x, d.y);
    return (1 - (double)d.z) / 1.5;
}

static double of_tiny_cone(sr_vec2 u, double *b)
{
    // 1 - cos = 1e-10, an angle of 14 microradians: z is 1 in floats, sin^2 = 2 (1 - cos)
    sr_vec3 d = sr_warp_uniform_cone(u, 1e-10f);
    *b = azimuth(d.x, d.y);
    return ((double)d.x * (double)d.x + (double)d.y * (double)d.y) / 2e-10;
}

static double of_triangle(sr_vec2 u, double *b)
{
    // back by the textbook map b0 = 1 - sqrt(a), b1 = b sqrt(a)
    sr_vec2 t = sr_warp_triangle(u);
    EXPECT(t.x >= 0 && t.y >= 0 && t.x + t.y <= 1);
    double root = 1 - (double)t.x;
    *b = (double)t.y / root;
    return root * root;
}

static double of_exponential(sr_vec2 u, double *b)
{
    *b = 1 - exp(-0.1 * (double)sr_warp_exponential(u.y, 0.1f));
    return 1 - exp(-300 * (double)sr_warp_exponential(u.x, 300));
}

TEST(warps_spread_evenly_over_their_shapes)
{
    expect_uniform(of_disk);
    expect_uniform(of_sphere);
    expect_uniform(of_hemisphere);
    expect_uniform(of_cosine);
    expect_uniform(of_wide_cone);
    expect_uniform(of_tiny_cone);
    expect_uniform(of_triangle);
    expect_uniform(of_exponential);
}

TEST(warps_take_the_corners_of_the_square)
{
    float edge[] = {0, 0x1p-24f, 0.25f, 0.5f, 0.75f, SR_ONE_MINUS_EPSILON};
    for (int i = 0; i < 36; ++i) {
        sr_vec2 u = {edge[i / 6], edge[i % 6]};
        sr_vec2 d = sr_warp_disk(u);
        EXPECT(d.x * d.x + d.y * d.y <= 1 + 1e-6f);
        EXPECT_NEAR(sr_length(sr_warp_uniform_sphere(u)), 1, 1e-6);
        EXPECT_NEAR(sr_length(sr_warp_cosine_hemisphere(u)), 1, 1e-6);
        EXPECT(isfinite(sr_warp_exponential(u.x, 3)));
        sr_vec3 w = sr_warp_uniform_sphere(u);
        double sin_theta = sqrt(1 - (double)w.z * (double)w.z);
        EXPECT_NEAR(w.x, sin_theta * cos(2 * M_PI * (double)u.y), 1e-6);
        EXPECT_NEAR(w.y, sin_theta * sin(2 * M_PI * (double)u.y), 1e-6);
    }
}

TEST(sine_and_cosine_of_a_turn_are_those_of_the_library)
{
    for (int i = 0; i <= 100000; ++i) {
        float turn = i < 1000 ? (float)i * 1e-9f : (float)i / 100000, s, c;
        sr_sin_cos_turn(turn, &s, &c);
        EXPECT_NEAR(s, sin(2 * M_PI * (double)turn), 1.5e-7);
        EXPECT_NEAR(c, cos(2 * M_PI * (double)turn), 1.5e-7);
        if (i < 1000)
            EXPECT_RELATIVE(s, sin(2 * M_PI * (double)turn), 2e-7);
    }
}

TEST(bilinear_warp_has_its_density)
{
    float cases[][4] = {{1, 2, 3, 4}, {0, 0, 0, 1}, {1, 0, 0, 1}, {0, 0, 0, 0}, {5, 0, 0, 0}, {1, 1, 1, 1}};
    for (int k = 0; k < 6; ++k) {
        static double observed[GRID * GRID], expected[GRID * GRID];
        memset(observed, 0, sizeof observed);
        double x[2], w[2], total = 0;
        for (int i = 0; i < DRAWS; ++i) {
            sr_vec2 p = sr_warp_bilinear(uv((uint32_t)i), cases[k]);
            EXPECT(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            observed[(int)(p.y * GRID) * GRID + (int)(p.x * GRID)] += 1;
        }
        sr_gauss_legendre(2, 0, 1.0 / GRID, x, w); // exact for a bilinear density
        for (int c = 0; c < GRID * GRID; ++c) {
            expected[c] = 0;
            for (int q = 0; q < 4; ++q) {
                sr_vec2 p = {(float)((c % GRID) / (double)GRID + x[q % 2]),
                             (float)((c / GRID) / (double)GRID + x[q / 2])};
                expected[c] += DRAWS * w[q % 2] * w[q / 2] * (double)sr_warp_bilinear_pdf(p, cases[k]);
            }
            total += expected[c];
        }
        EXPECT_RELATIVE(total, DRAWS, 1e-5);
        EXPECT_CHI2(observed, expected, GRID * GRID);
    }
    EXPECT(sr_warp_bilinear_pdf((sr_vec2){1.1f, 0.5f}, cases[0]) == 0);
}
