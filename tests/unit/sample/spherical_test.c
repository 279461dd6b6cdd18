/* SPDX-License-Identifier: MIT */
/* Spherical triangles and rectangles: their solid angle, evenness and inverse.
 * A density over directions is 1 / Omega exactly when points of the surface have the density cos / (distance^2 Omega):
 * counts over cells of the surface are compared with that integral, in double. */
#include "sample/sample.h"

#include "test.h"

static float uniform(uint32_t i, float lo, float hi)
{
    return sr_lerp(sr_u32_to_float(sr_hash_u32(i * 2654435761u + 17)), lo, hi);
}

static sr_vec3 point(uint32_t i, float size)
{
    return (sr_vec3){uniform(3 * i, -size, size), uniform(3 * i + 1, -size, size), uniform(3 * i + 2, -size, size)};
}

static sr_u4 draw(uint32_t key, uint32_t i)
{
    struct sr_sampler s = {.key = key, .sample = i, .kind = SR_SAMPLER_INDEPENDENT};
    return sr_sample4(&s, 0);
}

/* the solid angle of a parallelogram's part: s + a ex + b ey for a0 < a < a1, b0 < b < b1, by quadrature [sr] */
static double part(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey, double a0, double a1, double b0, double b1,
                   bool triangle)
{
    double x[32], w[32], sum = 0;
    sr_gauss_legendre(32, 0, 1, x, w);
    double d[3] = {(double)s.x - (double)p.x, (double)s.y - (double)p.y, (double)s.z - (double)p.z};
    double u[3] = {(double)ex.x, (double)ex.y, (double)ex.z}, v[3] = {(double)ey.x, (double)ey.y, (double)ey.z};
    double volume = 0;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += d[i] * (u[j] * v[k] - u[k] * v[j]);
    }
    for (int q = 0; q < 1024; ++q) {
        double a = a0 + (a1 - a0) * x[q % 32], b = b0 + (b1 - b0) * x[q / 32], jacobian = (a1 - a0) * (b1 - b0), r2 = 0;
        if (triangle) { // (a, b) are those of the textbook map onto barycentrics of corners 1 and 2
            double t = a * b;
            jacobian *= a;
            b = t;
            a -= t;
        }
        for (int i = 0; i < 3; ++i) {
            double r = d[i] + a * u[i] + b * v[i];
            r2 += r * r;
        }
        sum += w[q % 32] * w[q / 32] * jacobian * fabs(volume) / (r2 * sqrt(r2));
    }
    return sum;
}

enum { GRID = 12, DRAWS = 30000 };

TEST(spherical_triangle_area_has_closed_forms)
{
    EXPECT_NEAR(sr_spherical_triangle_area((sr_vec3){1, 0, 0}, (sr_vec3){0, 1, 0}, (sr_vec3){0, 0, 1}), M_PI / 2,
                1e-15);
    // with a right-angled tip of two legs s seen face-on far away: s^2 / 2
    sr_vec3 a = {0, 0, 1}, b = {1e-4f, 0, 1}, c = {0, 1e-4f, 1};
    EXPECT_RELATIVE(sr_spherical_triangle_area(a, sr_normalize(b), sr_normalize(c)), 0.5e-8, 1e-3);
}

TEST(spherical_triangles_are_sampled_evenly_and_inverted)
{
    float sizes[] = {5, 1, 0.1f, 0.003f};
    for (uint32_t k = 0; k < 48; ++k) {
        float size = sizes[k % 4];
        sr_vec3 p = point(1000 + k, 0.3f), centre = sr_add(p, sr_normalize(point(2000 + k, 1)));
        sr_vec3 v[3] = {sr_add(centre, point(9 * k, size)), sr_add(centre, point(9 * k + 3, size)),
                        sr_add(centre, point(9 * k + 6, size))};
        sr_vec3 e1 = sr_sub(v[1], v[0]), e2 = sr_sub(v[2], v[0]);
        double observed[GRID * GRID] = {0}, expected[GRID * GRID], total = 0;
        for (int c = 0; c < GRID * GRID; ++c) {
            int x = c % GRID, y = c / GRID;
            total += expected[c] =
                part(p, v[0], e1, e2, x / (double)GRID, (x + 1.0) / GRID, y / (double)GRID, (y + 1.0) / GRID, true);
        }
        double worst = 0;
        for (uint32_t i = 0; i < DRAWS; ++i) {
            sr_u4 r = draw(k, i);
            sr_vec2 u = {r[0], r[1]};
            float b[3], pdf;
            sr_spherical_triangle_sample(v, p, u, b, &pdf);
            EXPECT(pdf > 0 && b[0] >= 0 && b[1] >= 0 && b[2] >= 0);
            EXPECT_NEAR(b[0] + b[1] + b[2], 1, 1e-6);
            EXPECT_RELATIVE(sr_spherical_triangle_pdf(v, p), pdf, 1e-6);
            EXPECT_RELATIVE(pdf, 1 / total, 2e-4);
            double a = 1 - (double)b[0], share = a > 0 ? (double)b[2] / a : 0;
            int x = (int)fmin(a * GRID, GRID - 1), y = (int)fmin(share * GRID, GRID - 1);
            observed[y * GRID + x] += 1;
            if (i < 2000) {
                sr_vec3 q = sr_add(sr_add(sr_scale(b[0], sr_sub(v[0], p)), sr_scale(b[1], sr_sub(v[1], p))),
                                   sr_scale(b[2], sr_sub(v[2], p)));
                sr_vec2 back = sr_spherical_triangle_invert(v, p, sr_normalize(q));
                // near corner 1 all u.x meet: weigh by the width there
                worst = fmax(worst, fabs((double)(back.x - u.x)) * sqrt((double)u.y));
                worst = fmax(worst, fabs((double)(back.y - u.y)));
            }
        }
        if (worst > 1e-3 || total > 6)
            fprintf(stderr, "triangle %u: Omega %.3g sr, round trip %.2g\n", k, total, worst);
        EXPECT(worst < (size < 0.01f ? 1e-2 : 1e-3));
        for (int c = 0; c < GRID * GRID; ++c)
            expected[c] *= DRAWS / total;
        EXPECT_CHI2(observed, expected, GRID * GRID);
    }
}

TEST(spherical_rectangles_are_sampled_evenly_and_inverted)
{
    float sizes[] = {8, 1, 0.1f, 0.003f};
    for (uint32_t k = 0; k < 48; ++k) {
        float size = sizes[k % 4];
        sr_vec3 p = point(1000 + k, 0.3f), centre = sr_add(p, sr_normalize(point(3000 + k, 1)));
        struct sr_frame f = sr_frame_from_z(sr_normalize(point(4000 + k, 1)));
        sr_vec3 ex = sr_scale(size * uniform(5000 + k, 0.2f, 1), f.x),
                ey = sr_scale(size * uniform(6000 + k, 0.2f, 1), f.y);
        sr_vec3 s = sr_mad(sr_mad(centre, -uniform(7000 + k, 0, 1), ex), -uniform(8000 + k, 0, 1), ey);
        double observed[GRID * GRID] = {0}, expected[GRID * GRID], total = 0;
        for (int c = 0; c < GRID * GRID; ++c) {
            int x = c % GRID, y = c / GRID;
            total += expected[c] =
                part(p, s, ex, ey, x / (double)GRID, (x + 1.0) / GRID, y / (double)GRID, (y + 1.0) / GRID, false);
        }
        double worst = 0;
        for (uint32_t i = 0; i < DRAWS; ++i) {
            sr_u4 r = draw(k, i);
            sr_vec2 u = {r[0], r[1]};
            float pdf;
            sr_vec3 q = sr_spherical_rectangle_sample(p, s, ex, ey, u, &pdf), d = sr_sub(q, s);
            EXPECT_RELATIVE(pdf, 1 / total, 2e-4);
            EXPECT_RELATIVE(sr_spherical_rectangle_pdf(p, s, ex, ey), pdf, 1e-6);
            float a = sr_dot(d, ex) / sr_length2(ex), b = sr_dot(d, ey) / sr_length2(ey);
            EXPECT(a > -1e-3f && a < 1.001f && b > -1e-3f && b < 1.001f);
            int x = (int)sr_clamp(a * GRID, 0, GRID - 1), y = (int)sr_clamp(b * GRID, 0, GRID - 1);
            observed[y * GRID + x] += 1;
            sr_vec2 back = sr_spherical_rectangle_invert(p, s, ex, ey, q);
            worst = fmax(worst, fabs((double)(back.x - u.x)));
            worst = fmax(worst, fabs((double)(back.y - u.y)));
        }
        EXPECT(worst < 1e-3);
        for (int c = 0; c < GRID * GRID; ++c)
            expected[c] *= DRAWS / total;
        EXPECT_CHI2(observed, expected, GRID * GRID);
    }
}

TEST(degenerate_triangles_and_rectangles_give_no_density)
{
    sr_vec3 p = {0, 0, 0};
    sr_vec3 cases[][3] = {
        {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, // a line seen from its end
        {{1, 1, 0}, {1, 1, 0}, {2, 0, 1}}, // two corners in one
        {{1, 0, 0}, {2, 1, 0}, {3, 3, 0}}, // edge-on
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, // p is a corner
        {{NAN, 0, 0}, {1, 0, 0}, {0, 1, 1}},
    };
    for (int k = 0; k < 5; ++k) {
        float b[3], pdf = 7;
        sr_spherical_triangle_sample(cases[k], p, (sr_vec2){0.3f, 0.6f}, b, &pdf);
        EXPECT(pdf == 0 && sr_spherical_triangle_pdf(cases[k], p) == 0);
        sr_vec2 u = sr_spherical_triangle_invert(cases[k], p, (sr_vec3){0, 0, 1});
        EXPECT(k == 3 || k == 4 || (u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1));
    }
    sr_vec3 x = {1, 0, 0}, y = {0, 1, 0}, nothing = {0, 0, 0};
    sr_vec3 rectangles[][3] = {
        {{1, 1, 0}, x, y}, {{1, 1, 1}, nothing, y}, {{-0.5f, -0.5f, 0}, x, y}, {{0, 0, NAN}, x, y}};
    for (int k = 0; k < 4; ++k) {
        float pdf = 7;
        sr_spherical_rectangle_sample(p, rectangles[k][0], rectangles[k][1], rectangles[k][2], (sr_vec2){0.3f, 0.6f},
                                      &pdf);
        EXPECT(pdf == 0);
    }
}

TEST(far_and_tiny_triangles_keep_their_digits)
{
    // 1 cm seen from 1 km: an area of 5e-5 m^2 makes 5e-11 sr, evenly
    sr_vec3 v[3] = {{0, 0, 1000}, {0.01f, 0, 1000}, {0, 0.01f, 1000}}, p = {0, 0, 0};
    struct sr_tally mean[3] = {{0}}, square = {0};
    for (uint32_t i = 0; i < 20000; ++i) {
        sr_u4 r = draw(1, i);
        float b[3], pdf;
        sr_spherical_triangle_sample(v, p, (sr_vec2){r[0], r[1]}, b, &pdf);
        EXPECT_RELATIVE(pdf, 2e10, 1e-3);
        for (int k = 0; k < 3; ++k)
            sr_tally_add(&mean[k], (double)b[k]);
        sr_tally_add(&square, (double)(b[0] * b[2]));
    }
    for (int k = 0; k < 3; ++k)
        EXPECT_MEAN(mean[k], 1.0 / 3);
    EXPECT_MEAN(square, 1.0 / 12);
}
