/* SPDX-License-Identifier: MIT */
/* Skies against quadrature: Le, densities, sampler, and the sum of both ways of finding light. */
#include "scenery.h"

static const double pi = 3.14159265358979323846;
#define SIZE 16u

static const struct sr_light_model *sky(void)
{
    return sr_light_model_find("infinite");
}

/* a dim gradient, a bright sun of one texel and a dark corner */
static const float *texels(void)
{
    static float t[SIZE * SIZE * 3];
    for (uint32_t i = 0; i < SIZE * SIZE; ++i)
        for (uint32_t k = 0; k < 3; ++k)
            t[3 * i + k] = i % SIZE < 3 && i / SIZE < 3
                               ? 0
                               : 0.2f + 0.5f * (float)((i * (k + 3)) % 17) / 17 + (i == 5 * SIZE + 9 ? 60 : 0);
    return t;
}

static struct sr_light image_light(const struct sr_transform *t, float scale)
{
    struct sr_light_common *self = scenery_new(sky());
    self->texels = (struct sr_texels){SIZE, SIZE, 3, NULL, texels(), NULL, SR_SRGB};
    self->light_to_world = *t;
    SCENERY_FLOAT(sky(), self, "scale", scale);
    return scenery_finish(sky(), self);
}

/* E = pi L (1 + cos beta) / 2 of a hemisphere seen by a receiver tilted by beta: here a full uniform sky, cut by the
 * test */
TEST(a_uniform_dome_gives_pi_L_times_the_share_that_a_tilted_receiver_sees)
{
    void *self = scenery_new(sky());
    struct sr_light light = scenery_finish(sky(), self);
    double L = scenery_luminance(light, NULL, (sr_vec3){0.6f, 0, 0.8f});
    EXPECT_RELATIVE(L, 1, 1e-5);
    const double expected[][2] = {
        {0, 3.14159265359}, {30, 2.93114584997}, {60, 2.35619449019}, {90, 1.57079632679}, {120, 0.785398163397}};
    struct sr_wavelengths w = scenery_wavelengths(25);
    for (int i = 0; i < 5; ++i) {
        double beta = expected[i][0] * pi / 180, E = 0;
        int n = 400;
        for (int a = 0; a < n; ++a)
            for (int b = 0; b < n; ++b) {
                double z = (a + 0.5) / n, phi = 2 * pi * (b + 0.5) / n, r = sqrt(1 - z * z);
                sr_vec3 wi = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
                double cosine = sin(beta) * (double)wi.x + cos(beta) * (double)wi.z;
                if (cosine > 0)
                    E += 2 * pi / ((double)n * n) * cosine * L *
                         (double)(light.model->Le(light.self, NULL, sr_neg(wi), &w)[0] /
                                  light.model->Le(light.self, NULL, (sr_vec3){0, 0, 1}, &w)[0]);
            }
        EXPECT_RELATIVE(E, expected[i][1], 1e-3);
    }
    struct sr_point x = {0};
    struct sr_light_sample s;
    EXPECT(!sr_light_draw(light, &x, (sr_vec2){0.3f, 0.4f}, &w, &s)); // for the surface's own choice
    EXPECT(light.model->pdf(light.self, &x, (sr_vec3){0, 0, 1}, NULL) == 0);
    EXPECT(light.model->power(light.self) == 0);
}

TEST(a_uniform_sky_of_100_lx_has_the_luminance_100_over_pi)
{
    void *self = scenery_new(sky());
    SCENERY_FLOAT(sky(), self, "illuminance", 100);
    SCENERY_SPD(sky(), self, "L", sr_spd_blackbody(6500));
    EXPECT_RELATIVE(scenery_luminance(scenery_finish(sky(), self), NULL, (sr_vec3){0, 0, 1}), 100 / pi, 1e-5);
}

TEST(white_texels_have_the_luminance_of_scale)
{
    static float white[3 * 4] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    struct sr_light_common *self = scenery_new(sky());
    self->texels = (struct sr_texels){2, 2, 3, NULL, white, NULL, SR_SRGB};
    SCENERY_FLOAT(sky(), self, "scale", 12);
    struct sr_light light = scenery_finish(sky(), self);
    EXPECT_RELATIVE(scenery_luminance(light, NULL, (sr_vec3){0.6f, 0, -0.8f}), 12, 2e-3);
    EXPECT_RELATIVE(light.model->power(light.self), 12 * 4 * pi * pi * 4, 1e-5);
    // nothing stands out: the plain, uniform density
    struct sr_point x = {0};
    EXPECT_RELATIVE(light.model->pdf(light.self, &x, (sr_vec3){0.6f, 0, -0.8f}, NULL), 1 / (4 * pi), 1e-5);
}

/* the sum of L cos over the upper half of the square, at the texels and with a fine grid */
TEST(an_image_scaled_to_an_illuminance_gives_it)
{
    struct sr_light_common *self = scenery_new(sky());
    self->texels = (struct sr_texels){SIZE, SIZE, 3, NULL, texels(), NULL, SR_SRGB};
    SCENERY_FLOAT(sky(), self, "illuminance", 5000);
    struct sr_light light = scenery_finish(sky(), self);
    double E = 0;
    uint32_t n = 4 * SIZE;
    for (uint32_t i = 0; i < n * n; ++i) {
        sr_vec3 wi = sr_equal_area_square_to_sphere(
            (sr_vec2){((float)(i % n) + 0.5f) / (float)n, ((float)(i / n) + 0.5f) / (float)n});
        if (wi.z > 0)
            E += 4 * pi / ((double)n * n) * (double)wi.z * scenery_luminance(light, NULL, sr_neg(wi));
    }
    EXPECT_RELATIVE(E, 5000, 1e-2); // texels are taken at their centres
}

TEST(images_that_are_no_octahedral_map_are_refused)
{
    static float t[3 * 8];
    struct sr_error error = {0};
    struct sr_light_common *self = scenery_new(sky());
    self->texels = (struct sr_texels){4, 2, 3, NULL, t, NULL, SR_SRGB};
    EXPECT(sky()->prepare(self, &scenery_arena, &error) == SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "4 x 2") != NULL);
    error = (struct sr_error){0};
    self->texels = (struct sr_texels){2, 2, 1, NULL, t, NULL, SR_SRGB};
    EXPECT(sky()->prepare(self, &scenery_arena, &error) == SR_ERROR_INPUT);
    error = (struct sr_error){0};
    self->texels = (struct sr_texels){2, 2, 3, NULL, t, NULL, SR_SRGB};
    t[4] = INFINITY;
    EXPECT(sky()->prepare(self, &scenery_arena, &error) == SR_ERROR_INPUT);
}

// one that turns, one that mirrors, one that squeezes
static struct sr_transform transform(int i)
{
    struct sr_transform turn = sr_transform_rotate(70, (sr_vec3){1, 2, 3}), other = sr_transform_identity();
    if (i == 1)
        other = sr_transform_scale((sr_vec3){-3, 3, 3});
    if (i == 2)
        other = sr_transform_scale((sr_vec3){1, 0.5f, 2});
    return sr_transform_multiply(&turn, &other);
}

TEST(the_density_of_an_image_integrates_to_1_whatever_the_transform)
{
    for (int k = 0; k < 3; ++k) {
        struct sr_transform t = transform(k);
        struct sr_light light = image_light(&t, 1);
        struct sr_point x = {0};
        struct sr_rng rng = sr_rng_seed(3, (uint64_t)k);
        struct sr_tally sum = {0};
        for (int i = 0; i < 400000; ++i)
            sr_tally_add(&sum, 4 * pi * (double)light.model->pdf(light.self, &x, scenery_unit(&rng), NULL));
        EXPECT_MEAN(sum, 1);
    }
}

TEST(samples_of_an_image_agree_with_its_density_and_Le)
{
    for (int k = 0; k < 3; ++k) {
        struct sr_transform t = transform(k);
        struct sr_light light = image_light(&t, 2);
        struct sr_point x = {0};
        struct sr_wavelengths w = scenery_wavelengths(22);
        struct sr_rng rng = sr_rng_seed(4, (uint64_t)k);
        int differs = 0;
        for (int i = 0; i < 20000; ++i) {
            struct sr_light_sample s;
            if (!sr_light_draw(light, &x, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &s))
                continue;
            EXPECT_NEAR(sr_length(s.wi), 1, 1e-5);
            EXPECT(isinf(s.distance) && !s.is_delta && s.pdf > 0);
            double pdf = (double)light.model->pdf(light.self, &x, s.wi, NULL);
            bool is_same = fabs(pdf / (double)s.pdf - 1) < 1e-3 &&
                           fabsf(light.model->Le(light.self, NULL, sr_neg(s.wi), &w)[2] / s.L[2] - 1) < 1e-4f;
            differs += !is_same; // rounding may lead to the next texel
        }
        EXPECT(differs < 20);
    }
}

/* chi-square over a coarse grid of cos theta and phi in the world */
TEST(the_sampler_of_an_image_follows_its_density)
{
    enum { Z = 12, PHI = 16, DRAWS = 100000, FINE = 60 };
    for (int k = 0; k < 3; ++k) {
        struct sr_transform t = transform(k);
        struct sr_light light = image_light(&t, 1);
        struct sr_point x = {0};
        struct sr_wavelengths w = scenery_wavelengths(22);
        struct sr_rng rng = sr_rng_seed(5, (uint64_t)k);
        double observed[Z * PHI + 1] = {0}, expected[Z * PHI + 1] = {0}, all = 0;
        for (int i = 0; i < DRAWS; ++i) {
            struct sr_light_sample s;
            if (!sr_light_draw(light, &x, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &s)) {
                observed[Z * PHI] += 1;
                continue;
            }
            float phi = atan2f(s.wi.y, s.wi.x);
            int a = (int)fminf((s.wi.z + 1) / 2 * Z, Z - 1),
                b = (int)fminf((phi < 0 ? phi + 2 * SR_PI : phi) / (2 * SR_PI) * PHI, PHI - 1);
            observed[a * PHI + b] += 1;
        }
        for (int i = 0; i < Z * FINE; ++i)
            for (int j = 0; j < PHI * FINE; ++j) {
                double z = 2 * (i + 0.5) / (Z * FINE) - 1, phi = 2 * pi * (j + 0.5) / (PHI * FINE), r = sqrt(1 - z * z);
                sr_vec3 wi = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
                double p = (double)light.model->pdf(light.self, &x, wi, NULL) * DRAWS * 4 * pi /
                           ((double)Z * FINE * PHI * FINE);
                expected[i / FINE * PHI + j / FINE] += p;
                all += p;
            }
        EXPECT_RELATIVE(all, DRAWS, 2e-3);
        for (int i = 0; i < Z * PHI; ++i)
            expected[i] *= DRAWS / all;
        EXPECT_CHI2(observed, expected, Z * PHI + 1);
    }
}

/* E = INTEGRAL L cos: by the texels one by one; by draws from the image and from a cosine lobe, balanced */
TEST(image_and_surface_together_find_all_the_light)
{
    for (int k = 0; k < 3; ++k) {
        struct sr_transform t = transform(k);
        struct sr_light light = image_light(&t, 1);
        struct sr_wavelengths w = scenery_wavelengths(22);
        struct sr_point x = {.n = {0, 0, 1}};
        double E = 0;
        int n = 1500;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                double z = (i + 0.5) / n, phi = 2 * pi * (j + 0.5) / n, r = sqrt(1 - z * z);
                sr_vec3 wi = {(float)(r * cos(phi)), (float)(r * sin(phi)), (float)z};
                E += 2 * pi / ((double)n * n) * z * (double)light.model->Le(light.self, NULL, sr_neg(wi), &w)[2];
            }
        struct sr_rng rng = sr_rng_seed(6, (uint64_t)k);
        struct sr_tally tally = {0};
        for (int i = 0; i < 100000; ++i) {
            double sum = 0;
            struct sr_light_sample s;
            if (sr_light_draw(light, &x, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &s) && s.wi.z > 0)
                sum += (double)(s.L[2] * s.wi.z / (s.pdf + sr_warp_cosine_hemisphere_pdf(s.wi.z)));
            sr_vec3 wi = sr_warp_cosine_hemisphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
            float pdf = sr_warp_cosine_hemisphere_pdf(wi.z);
            if (pdf > 0)
                sum += (double)(light.model->Le(light.self, NULL, sr_neg(wi), &w)[2] * wi.z /
                                (pdf + light.model->pdf(light.self, &x, wi, NULL)));
            sr_tally_add(&tally, sum);
        }
        printf("    image sky: E %.6g, estimate %.6g +- %.2g\n", E, tally.mean, sr_tally_standard_error(&tally));
        EXPECT(sr_tally_standard_error(&tally) > 1e-3 * E * 0.1); // the quadrature's error is far below
        EXPECT_MEAN(tally, E);
    }
}
