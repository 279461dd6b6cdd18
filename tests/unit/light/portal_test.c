/* SPDX-License-Identifier: MIT */
/* The sky through a portal: against sums over the portal and over directions, its densities against counts. */
#include "scenery.h"

#define SIDE 32u
static const double pi = 3.14159265358979323846;
static const sr_vec3 corners[4] = {{0.5f, 0.2f, 2}, {0.5f, 1.4f, 2}, {2.5f, 1.4f, 2}, {2.5f, 0.2f, 2}}; // outside is +z

static struct sr_light portal_light(const float *texels, const sr_vec3 *p, float scale)
{
    struct sr_light_common *self = scenery_new(&sr_light_portal);
    if (texels)
        self->texels = (struct sr_texels){SIDE, SIDE, 3, NULL, texels, NULL, SR_SRGB};
    self->light_to_world = sr_transform_rotate(70, (sr_vec3){1, 2, 3});
    scenery_set(&sr_light_portal, self, "portal", &(struct sr_slice){p, 4}, sizeof(struct sr_slice));
    SCENERY_FLOAT(&sr_light_portal, self, "scale", scale);
    return scenery_finish(&sr_light_portal, self);
}

static const float *sky(void)
{
    static float t[SIDE * SIDE * 3];
    for (uint32_t i = 0; i < SIDE * SIDE * 3; ++i)
        t[i] = i / 3 % 5 == 0 ? 0 : 0.3f + 0.5f * (float)(i * 7 % 17) / 17;
    for (uint32_t i = 0; i < SIDE * SIDE; i += 53) // suns, some of them in the window
        t[3 * i] = t[3 * i + 1] = t[3 * i + 2] = 30;
    return t;
}

static const struct sr_point receivers[] = {{.p = {0, 0, 0}, .n = {0, 0, 1}},
                                            {.p = {1.5f, 0.8f, 1.8f}, .n = {0, 0.6f, 0.8f}},
                                            {.p = {-6, 3, 1}, .n = {1, 0, 0}}};

static double value_of(sr_spectrum L)
{
    return (double)L[2];
}

// INTEGRAL sky cos cos' / r^2 dA over the portal
static double irradiance(struct sr_light light, const struct sr_point *x, const struct sr_wavelengths *w)
{
    enum { N = 400 };
    double sum = 0;
    for (int i = 0; i < N * N; ++i) {
        float a = ((float)(i % N) + 0.5f) / N, b = ((float)(i / N) + 0.5f) / N;
        sr_vec3 p = {0.5f + 2 * a, 0.2f + 1.2f * b, 2}, d = sr_sub(p, x->p), wi = sr_normalize(d);
        double cosine = (double)sr_dot(x->n, wi);
        if (cosine > 0)
            sum += cosine * (double)wi.z / (double)sr_length2(d) * 2.4 / ((double)N * N) *
                   value_of(sr_light_escaping(light, x->p, wi, w));
    }
    return sum;
}

TEST(what_comes_through_a_portal_is_the_sum_over_it)
{
    struct sr_wavelengths w = scenery_wavelengths(25);
    for (int image = 0; image < 2; ++image) {
        struct sr_light light = portal_light(image ? sky() : NULL, corners, 3);
        for (size_t k = 0; k < 3; ++k) {
            const struct sr_point *x = &receivers[k];
            struct sr_rng rng = sr_rng_seed(k, (uint64_t)image);
            struct sr_tally t = {0};
            for (int i = 0; i < 100000; ++i) {
                struct sr_light_sample s;
                bool is_drawn = sr_light_draw(light, x, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &s);
                double cosine = is_drawn ? (double)sr_dot(x->n, s.wi) : 0;
                sr_tally_add(&t, cosine > 0 ? cosine * value_of(s.L) / (double)s.pdf : 0);
                if (!is_drawn)
                    continue;
                EXPECT(isinf(s.distance) && !s.is_delta);
                float pdf;
                sr_spectrum Le = light.model->Le_pdf(light.self, x->p, s.wi, &w, &pdf);
                if (i % 64 == 0 && pdf > 0 && fabsf(pdf / s.pdf - 1) < 1e-3f) // not within rounding of an edge
                    EXPECT_NEAR(value_of(Le), value_of(s.L), 1e-4 * value_of(s.L));
            }
            double E = irradiance(light, x, &w), se = sr_tally_standard_error(&t);
            printf("    portal, %s: E %.6g, estimate %.6g +- %.2g\n", image ? "image" : "uniform", E, t.mean, se);
            EXPECT(E > 0 && fabs(t.mean - E) < 4.9 * se + 2e-3 * E);
        }
        struct sr_light_sample s; // from outside, and from its own plane, nothing is seen
        EXPECT(!sr_light_draw(light, &(struct sr_point){.p = {1, 1, 3}}, (sr_vec2){0.4f, 0.6f}, &w, &s));
        EXPECT(!sr_light_draw(light, &(struct sr_point){.p = {-1, 1, 2}}, (sr_vec2){0.4f, 0.6f}, &w, &s));
        EXPECT(sr_spectrum_is_black(sr_light_escaping(light, (sr_vec3){1, 1, 0}, (sr_vec3){0, 0, -1}, &w)));
        EXPECT(sr_spectrum_is_black(sr_light_escaping(light, (sr_vec3){3, 1, 0}, (sr_vec3){0, 0, 1}, &w)));
        EXPECT(sr_spectrum_is_black(sr_light_escaping(light, (sr_vec3){1, 1, 3}, (sr_vec3){0, 0, 1}, &w)));
    }
}

/* Counts over the portal's own area, where the window's edges are those of the cells. */
TEST(directions_through_a_portal_come_as_their_density_says)
{
    enum { CELLS = 12, DRAWS = 100000, FINE = 30 };
    struct sr_wavelengths w = scenery_wavelengths(25);
    for (int image = 0; image < 2; ++image) {
        struct sr_light light = portal_light(image ? sky() : NULL, corners, 1);
        const struct sr_point *x = &receivers[0];
        static double observed[CELLS * CELLS], expected[CELLS * CELLS];
        memset(observed, 0, sizeof observed);
        memset(expected, 0, sizeof expected);
        struct sr_rng rng = sr_rng_seed(5, (uint64_t)image);
        double dark = 0, sum = 0;
        for (int i = 0; i < DRAWS; ++i) {
            struct sr_light_sample s;
            if (!sr_light_draw(light, x, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &s)) {
                dark += 1; // a texel that is black
                continue;
            }
            float a = (2 * s.wi.x / s.wi.z - 0.5f) / 2, b = (2 * s.wi.y / s.wi.z - 0.2f) / 1.2f;
            EXPECT(a > -1e-4f && a < 1.0001f && b > -1e-4f && b < 1.0001f);
            int i_a = (int)sr_clamp(a * CELLS, 0, CELLS - 1), i_b = (int)sr_clamp(b * CELLS, 0, CELLS - 1);
            observed[i_b * CELLS + i_a] += 1;
        }
        for (int i = 0; i < CELLS * CELLS * FINE * FINE; ++i) {
            int ia = i % (CELLS * FINE), ib = i / (CELLS * FINE);
            sr_vec3 p = {0.5f + 2 * ((float)ia + 0.5f) / (CELLS * FINE),
                         0.2f + 1.2f * ((float)ib + 0.5f) / (CELLS * FINE), 2},
                    wi = sr_normalize(p);
            double density = (double)light.model->pdf(light.self, x, wi, NULL) * (double)wi.z / (double)sr_length2(p) *
                             2.4 / (CELLS * CELLS * FINE * FINE);
            sum += density;
            if (!sr_spectrum_is_black(sr_light_escaping(light, x->p, wi, &w)))
                expected[ib / FINE * CELLS + ia / FINE] += density * DRAWS;
        }
        EXPECT_NEAR(sum, 1, 5e-3);
        EXPECT(image || dark == 0);
        double scale = 0;
        for (int i = 0; i < CELLS * CELLS; ++i)
            scale += expected[i];
        EXPECT_NEAR(scale, DRAWS - dark, 0.004 * DRAWS);
        for (int i = 0; i < CELLS * CELLS; ++i) // the sum's own error in black texels aside
            expected[i] *= (DRAWS - dark) / scale;
        EXPECT_CHI2(observed, expected, CELLS * CELLS);
    }
}

TEST(what_enters_through_a_portal_is_its_power)
{
    for (int image = 0; image < 2; ++image) {
        struct sr_light light = portal_light(image ? sky() : NULL, corners, 3);
        double known = pi * 2.4 * 3, flux = (double)light.model->power(light.self);
        if (image) { // A INTEGRAL L cos dw
            enum { N = 300 };
            known = 0;
            for (int i = 0; i < N * N; ++i) {
                sr_vec3 d =
                    sr_equal_area_square_to_sphere((sr_vec2){((float)(i % N) + .5f) / N, ((float)(i / N) + .5f) / N});
                if (d.z > 0)
                    known += 2.4 * 4 * pi / ((double)N * N) * (double)d.z * scenery_luminance(light, NULL, sr_neg(d));
            }
        }
        EXPECT_RELATIVE(flux, known, image ? 1e-2 : 1e-4);
        struct sr_rng rng = sr_rng_seed(3, (uint64_t)image);
        struct sr_tally t = {0};
        for (int i = 0; i < 200000; ++i) {
            struct sr_wavelengths w =
                sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, sr_rng_float(&rng));
            struct sr_light_ray r;
            if (!light.model->emit(light.self, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)},
                                   (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &r)) {
                sr_tally_add(&t, 0);
                continue;
            }
            EXPECT(r.has_passed && r.w.z < 0 && r.from.p.z == 2 && r.from.p.x >= 0.5f && r.from.p.y <= 1.4001f);
            float pdf_area, pdf_direction;
            light.model->emit_pdf(light.self, r.from.n, r.w, &pdf_area, &pdf_direction);
            EXPECT(pdf_area == r.pdf_area && pdf_direction == r.pdf_direction);
            // what goes on inside sees it the same way
            if (i % 100 == 0)
                EXPECT_NEAR(value_of(sr_light_escaping(light, sr_add(r.from.p, r.w), sr_neg(r.w), &w)), value_of(r.L),
                            1e-4 * value_of(r.L));
            sr_tally_add(&t, (double)sr_spectrum_to_xyz(r.L, &w).y / ((double)r.pdf_area * (double)r.pdf_direction));
        }
        double se = sr_tally_standard_error(&t);
        printf("    portal, %s: %.5g lm +- %.1g, known %.5g lm\n", image ? "image" : "uniform", t.mean, se, known);
        EXPECT(fabs(t.mean - known) < 4.9 * se + 5e-3 * known);
    }
}

TEST(portals_that_are_no_rectangles_are_refused)
{
    static const sr_vec3 wrong[4][4] = {{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0.2f, 0}}, // no right angles
                                        {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}},    // crosses itself
                                        {{0, 0, 0}, {0, 0, 0}, {1, 1, 0}, {1, 1, 0}},    // no area
                                        {{0, 0, 0}, {0, 1, 0}, {1, 1, NAN}, {1, 0, 0}}};
    for (int i = 0; i < 5; ++i) {
        struct sr_error error = {0};
        struct sr_light_common *self = scenery_new(&sr_light_portal);
        scenery_set(&sr_light_portal, self, "portal", &(struct sr_slice){i < 4 ? wrong[i] : corners, i < 4 ? 4 : 3},
                    sizeof(struct sr_slice));
        EXPECT(sr_light_portal.prepare(self, &scenery_arena, &error) == SR_ERROR_INPUT && strstr(error.text, "portal"));
    }
}
