/* SPDX-License-Identifier: MIT */
/* Glowing surfaces against closed forms. */
#include "scenery.h"

static const double pi = 3.14159265358979323846;

static const struct scenery_quad lamp = {{-0.5f, -1, 2}, {0, 2, 0}, {1, 0, 0}}; // 1 m x 2 m, 2 m above, shines down

/* configuration factor of a parallel rectangle a x b whose corner is over the receiver, at height h */
static double corner(double a, double b, double h)
{
    double A = a / h, B = b / h;
    return (A / sqrt(1 + A * A) * atan(B / sqrt(1 + A * A)) + B / sqrt(1 + B * B) * atan(A / sqrt(1 + B * B))) / (2 * pi);
}

static sr_spectrum draw_E(struct sr_light light, const struct sr_point *x, struct sr_rng *rng, const struct sr_wavelengths *w)
{
    struct sr_light_sample s;
    if (!sr_light_draw(light, x, (sr_vec2){sr_rng_float(rng), sr_rng_float(rng)}, w, &s))
        return SR_BLACK;
    return s.L * (fmaxf(sr_dot(x->n, s.wi), 0) / s.pdf);
}

/* E = pi L F */
TEST(a_rectangle_overhead_gives_pi_L_times_the_configuration_factor)
{
    struct sr_light_emission e = scenery_emission();
    e.scale = 50;
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    struct sr_light light = scenery_quad_light(&lamp, 0, &e);
    struct sr_point x = {.n = {0, 0, 1}, .ns = {0, 0, 1}};
    struct sr_wavelengths w = scenery_wavelengths(20);
    struct sr_rng rng = sr_rng_seed(1, 1);
    struct sr_tally E = {0};
    for (int i = 0; i < 20000; ++i)
        sr_tally_add(&E, (double)draw_E(light, &x, &rng, &w)[3] * SR_CIE_Y_INTEGRAL); // a constant spectrum
    EXPECT_MEAN(E, pi * 50 * 4 * corner(0.5, 1, 2));

    struct sr_point above = {.p = {0, 0, 4}, .n = {0, 0, -1}};
    EXPECT(sr_spectrum_is_black(draw_E(light, &above, &rng, &w))); // the back is dark
    struct sr_point there = {.p = {0, 0, 2}, .n = {0, 0, -1}};
    EXPECT(scenery_luminance(light, &there, (sr_vec3){0, 0, 1}) == 0);
    EXPECT_RELATIVE(scenery_luminance(light, &there, (sr_vec3){0, 0.6f, -0.8f}), 50, 1e-5);
    EXPECT_RELATIVE(light.model->power(light.self), pi * 2 * 50, 1e-5);
}

/* E = pi L F from either side; Phi = 2 pi A L */
TEST(a_two_sided_light_of_200_lm_gives_off_100_lm_a_side)
{
    struct sr_light_emission e = scenery_emission();
    e.two_sided = true;
    e.power = 200;
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    struct sr_light light = scenery_quad_light(&lamp, 0, &e);
    EXPECT_RELATIVE(light.model->power(light.self), 200, 1e-5);
    struct sr_point there = {.p = {0, 0, 2}, .n = {0, 0, -1}};
    EXPECT_RELATIVE(scenery_luminance(light, &there, (sr_vec3){0, 0, 1}), 100 / (2 * pi), 1e-5);
    EXPECT_RELATIVE(scenery_luminance(light, &there, (sr_vec3){0, 0, -1}), 100 / (2 * pi), 1e-5);
}

TEST(power_of_a_shape_is_shared_by_area)
{
    const struct scenery_quad quads[2] = {lamp, {{5, 5, 5}, {1, 0, 0}, {0, 3, 0}}};
    struct sr_light_emission e = scenery_emission();
    e.power = 1000;
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 5, &scenery_arena, &error) == SR_OK);
    struct sr_light a = scenery_quad_light(quads, 0, &e), b = scenery_quad_light(quads, 1, &e);
    EXPECT_RELATIVE(a.model->power(a.self), 400, 1e-5);
    EXPECT_RELATIVE(b.model->power(b.self), 600, 1e-5);
}

/* the top row of an image is at v = 1 */
TEST(an_image_shines_right_side_up_with_its_mean_flux)
{
    static const float texels[] = {1, 1, 1, 0, 0, 0, 0.25f, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f}; // two rows of two
    struct sr_light_emission e = {.scale = 10, .power = NAN, .texels = {2, 2, 3, NULL, texels, NULL, SR_SRGB}};
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    struct sr_light light = scenery_quad_light(&lamp, 0, &e);
    struct sr_point there = {.n = {0, 0, -1}, .uv = {0.25f, 0.75f}};
    sr_vec3 down = {0, 0, -1};
    EXPECT_RELATIVE(scenery_luminance(light, &there, down), 10, 3e-3);
    there.uv = (sr_vec2){0.75f, 0.25f};
    EXPECT_RELATIVE(scenery_luminance(light, &there, down), 7.5, 3e-3);
    there.uv = (sr_vec2){0.5f, 0.5f};
    EXPECT_RELATIVE(scenery_luminance(light, &there, down), 5, 3e-3);
    there.uv = (sr_vec2){0.9f, 0.9f};
    EXPECT(scenery_luminance(light, &there, down) == 0);
    // Phi by quadrature over (u, v), which is the area
    double L = 0;
    for (int i = 0; i < 16; ++i)
        for (int j = 0; j < 16; ++j) {
            there.uv = (sr_vec2){((float)i + 0.5f) / 16, ((float)j + 0.5f) / 16};
            L += scenery_luminance(light, &there, down) / 256;
        }
    EXPECT_RELATIVE(pi * 2 * L, light.model->power(light.self), 3e-3);
    e.power = 300;
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    EXPECT_RELATIVE(light.model->power(light.self), 3000, 1e-5); // scale times power
    e.L = sr_spd_constant(1);
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_ERROR_INPUT);
}

TEST(a_ghost_is_found_by_light_sampling_alone)
{
    struct sr_light_emission e = scenery_emission();
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    struct sr_light light = scenery_quad_light(&lamp, 0, &e);
    ((struct sr_light_area *)(uintptr_t)light.self)->is_ghost = true;
    struct sr_point x = {0}, there = {.p = {0, 0, 2}, .n = {0, 0, -1}};
    struct sr_wavelengths w = scenery_wavelengths(20);
    struct sr_light_sample s;
    EXPECT(sr_light_draw(light, &x, (sr_vec2){0.5f, 0.5f}, &w, &s) && s.is_delta && s.pdf != 1);
    EXPECT(light.model->pdf(light.self, &x, (sr_vec3){0, 0, 1}, &there) == 0);
}
