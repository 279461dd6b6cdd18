/* SPDX-License-Identifier: MIT */
/* Textures made of noise, and mixes by direction, against their formulas and counts of area. */
#include "make.h"

#include <math.h>

static struct sr_point point_at(float x, float y, float z)
{
    return (struct sr_point){.p = {x, y, z}, .n = {0, 0, 1}, .uv = {x, y}};
}

static struct sr_transform *transform_of(struct made *m)
{
    return (void *)((char *)m->self + sr_texture_transform_offset(m->model));
}

TEST(octaves_of_noise_are_read_in_the_space_of_the_texture)
{
    static const char *const names[] = {"fbm", "wrinkled", "windy"};
    struct sr_transform t = sr_transform_scale((sr_vec3){2, 3, 4});
    for (int i = 0; i < 3; ++i) {
        struct made m = make(names[i], true);
        *transform_of(&m) = t;
        if (i < 2) {
            *(int32_t *)made_member(&m, "octaves") = 5;
            *(float *)made_member(&m, "roughness") = 0.7f;
        }
        struct sr_texture texture = made_texture(&m, SR_PARAM_ALBEDO);
        for (int k = 0; k < 50; ++k) {
            struct sr_point x = point_at(0.13f * (float)k, 0.31f - 0.17f * (float)k, 0.011f * (float)(k * k));
            sr_vec3 q = {2 * x.p.x, 3 * x.p.y, 4 * x.p.z}, none = {0, 0, 0}, dx = {0, 0.3f, 0}, dy = {0.02f, 0, 0};
            if (k % 2) {
                x.dpdx = (sr_vec3){0, 0.1f, 0};
                x.dpdy = (sr_vec3){0.01f, 0, 0};
            } else
                dx = dy = none;
            double expected =
                i == 0   ? (double)sr_fbm(q, dx, dy, 0.7f, 5)
                : i == 1 ? (double)sr_turbulence(q, dx, dy, 0.7f, 5)
                         : fabs((double)sr_fbm(sr_scale(0.1f, q), sr_scale(0.1f, dx), sr_scale(0.1f, dy), 0.5f, 3)) *
                               (double)sr_fbm(q, dx, dy, 0.5f, 6);
            EXPECT_NEAR(sr_texture_float(texture, &x), expected, 2e-5);
        }
        sr_arena_free(&m.arena);
    }
}

/* de Casteljau's construction, where the texture weighs by Bernstein's polynomials */
static void curve(double t, double rgb[3])
{
    static const double c[9][3] = {{.58, .58, .6}, {.58, .58, .6}, {.58, .58, .6}, {.5, .5, .5},  {.6, .59, .58},
                                   {.58, .58, .6}, {.58, .58, .6}, {.2, .2, .33},  {.58, .58, .6}};
    int k = (int)(t * 6) < 5 ? (int)(t * 6) : 5;
    double u = t * 6 - k;
    for (int i = 0; i < 3; ++i) {
        double p[4] = {c[k][i], c[k + 1][i], c[k + 2][i], c[k + 3][i]};
        for (int n = 3; n > 0; --n)
            for (int j = 0; j < n; ++j)
                p[j] += u * (p[j + 1] - p[j]);
        rgb[i] = 1.5 * p[0];
    }
}

TEST(marble_has_its_colours_along_the_sine_of_the_bent_height)
{
    struct made m = make("marble", false);
    *transform_of(&m) = sr_transform_identity();
    *(float *)made_member(&m, "scale") = 2;
    *(float *)made_member(&m, "variation") = 3;
    struct sr_texture texture = made_texture(&m, SR_PARAM_ALBEDO);
    struct sr_wavelengths w = wavelengths();
    double least = 1, most = 0;
    for (int k = 0; k < 400; ++k) {
        struct sr_point x = point_at(0.7f, 0.01f * (float)k, -0.3f);
        sr_vec3 q = sr_scale(2, x.p), none = {0, 0, 0};
        double t = 0.5 + 0.5 * sin((double)(q.y + 3 * sr_fbm(q, none, none, 0.5f, 8))), rgb[3];
        if (fabs(t * 6 - round(t * 6)) < 1e-4) // at a seam
            continue;
        curve(t, rgb);
        struct sr_spd expected =
            sr_spd_from_rgb_albedo(SR_SRGB, (struct sr_rgb){(float)rgb[0], (float)rgb[1], (float)rgb[2]});
        sr_spectrum s = sr_texture_spectrum(texture, &x, &w), e = sr_spd_eval(&expected, w.lambda);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            EXPECT_NEAR(s[i], e[i], 1e-4);
        least = fmin(least, (double)s[SR_LAMBDA_COUNT / 2]);
        most = fmax(most, (double)s[SR_LAMBDA_COUNT / 2]);
    }
    EXPECT(least < 0.75 && most > 0.85 && most <= 0.92); // veins there are
    sr_arena_free(&m.arena);
}

TEST(dots_cover_the_area_of_a_circle_in_each_cell_that_has_one)
{
    struct made m = make("dots", true);
    *(struct sr_texture *)made_member(&m, "inside") = sr_texture_constant_float(&m.arena, 5);
    *(struct sr_texture *)made_member(&m, "outside") = sr_texture_constant_float(&m.arena, 2);
    struct sr_texture texture = made_texture(&m, SR_PARAM_ALBEDO);
    enum { CELLS = 16, FINE = 100 };
    int dotted = 0;
    double inside = 0;
    for (int i = -CELLS; i < CELLS; ++i)
        for (int j = -CELLS; j < CELLS; ++j)
            dotted += sr_noise((sr_vec3){(float)i + 0.5f, (float)j + 0.5f, 0.5f}) > 0;
    for (int i = 0; i < 2 * CELLS * FINE; ++i)
        for (int j = 0; j < 2 * CELLS * FINE; ++j) {
            struct sr_point x =
                point_at(((float)i + 0.5f) / FINE - CELLS - 0.5f, ((float)j + 0.5f) / FINE - CELLS - 0.5f, 0);
            float value = sr_texture_float(texture, &x);
            EXPECT(value == 5 || value == 2);
            inside += value == 5 ? 1.0 / (FINE * FINE) : 0;
        }
    EXPECT(dotted > CELLS * CELLS && dotted < 3 * CELLS * CELLS);
    EXPECT_RELATIVE(inside, dotted * 3.14159265 * 0.35 * 0.35, 1e-3);
    sr_arena_free(&m.arena);

    struct made s = make("dots", false); // the same places for spectra
    struct sr_texture spectral = made_texture(&s, SR_PARAM_ALBEDO);
    struct sr_wavelengths w = wavelengths();
    for (int k = 0; k < 300; ++k) {
        struct sr_point x = point_at(0.07f * (float)k, 0.3f * sinf((float)k), 0);
        struct made f = make("dots", true);
        EXPECT_NEAR(sr_texture_spectrum(spectral, &x, &w)[3], sr_texture_float(made_texture(&f, SR_PARAM_ALBEDO), &x),
                    1e-6);
        sr_arena_free(&f.arena);
    }
    sr_arena_free(&s.arena);
}

TEST(directionmix_weighs_by_the_cosine_to_its_direction)
{
    struct sr_wavelengths w = wavelengths();
    for (int is_float = 0; is_float < 2; ++is_float) {
        struct made m = make("directionmix", is_float);
        *(sr_vec3 *)made_member(&m, "dir") = is_float ? (sr_vec3){NAN, NAN, NAN} : (sr_vec3){0, 5, 0};
        struct sr_transform turn = sr_transform_rotate(90, (sr_vec3){1, 0, 0}); // y of the texture is z of the world
        *transform_of(&m) = sr_transform_invert(&turn);
        struct sr_texture texture = made_texture(&m, SR_PARAM_ALBEDO);
        for (int k = -4; k <= 4; ++k) {
            float z = (float)k / 4;
            struct sr_point x = {.n = {sqrtf(1 - z * z), 0, z}};
            float value = is_float ? sr_texture_float(texture, &x) : sr_texture_spectrum(texture, &x, &w)[2];
            EXPECT_NEAR(value, 1 - fabs((double)z), 1e-6); // tex1 is 0, tex2 is 1
        }
        sr_arena_free(&m.arena);
    }
    struct made m = make("directionmix", true);
    *transform_of(&m) = sr_transform_identity();
    *(sr_vec3 *)made_member(&m, "dir") = (sr_vec3){0, 0, 0};
    EXPECT(m.model->prepare(m.self, (struct sr_texture_use){SR_PARAM_ALBEDO, SR_SRGB}, &m.arena, &m.error) ==
           SR_ERROR_INPUT);
    sr_arena_free(&m.arena);
}
