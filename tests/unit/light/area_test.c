/* SPDX-License-Identifier: MIT */
/* Glowing surfaces against closed forms. */
#include "scenery.h"

static const double pi = 3.14159265358979323846;

static const struct scenery_quad lamp = {{-0.5f, -1, 2}, {0, 2, 0}, {1, 0, 0}}; // 1 m x 2 m, 2 m above, shines down

/* configuration factor of a parallel rectangle a x b whose corner is over the receiver, at height h */
static double corner(double a, double b, double h)
{
    double A = a / h, B = b / h;
    return (A / sqrt(1 + A * A) * atan(B / sqrt(1 + A * A)) + B / sqrt(1 + B * B) * atan(A / sqrt(1 + B * B))) /
           (2 * pi);
}

static sr_spectrum draw_E(struct sr_light light, const struct sr_point *x, struct sr_rng *rng,
                          const struct sr_wavelengths *w)
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

static struct sr_light pictured(const sr_vec3 P[4], const struct sr_light_emission *e)
{
    struct sr_shape_patches *patch = sr_arena_alloc(&scenery_arena, sizeof *patch);
    struct sr_light_area *area = sr_arena_alloc(&scenery_arena, sizeof *area);
    struct sr_shape_placement in_place = {sr_transform_identity(), false};
    struct sr_error error = {0};
    patch->P = (struct sr_slice){sr_arena_copy(&scenery_arena, P, 4 * sizeof *P), 4};
    EXPECT(sr_shape_bilinearmesh.prepare(patch, &in_place, &scenery_arena, &error) == SR_OK);
    *area = sr_light_area_of((struct sr_shape){&sr_shape_bilinearmesh, patch}, 0, e, false);
    EXPECT_EQUAL_INT(area->kind, SR_LIGHT_PICTURE);
    return (struct sr_light){&sr_light_area, area};
}

/* A patch with an image: draws agree with the illuminance by cubature over (u, v), and better than without the image.
 */
static void expect_illuminance_of_picture(const sr_vec3 P[4], sr_vec3 from)
{
    enum { side = 16 };
    static float texels[side * side * 3];
    struct sr_rng rng = sr_rng_seed(21, 1);
    for (int i = 0; i < side * side; ++i) {
        float bright = i % 37 == 5 ? 20 : i % 3 == 0 ? 0.2f : 0;
        texels[3 * i] = bright * sr_rng_float(&rng), texels[3 * i + 1] = bright, texels[3 * i + 2] = 0.5f * bright;
    }
    struct sr_light_emission e = {
        .scale = 1, .power = NAN, .two_sided = true, .texels = {side, side, 3, NULL, texels, NULL, SR_SRGB}};
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    EXPECT(e.picture != NULL);
    struct sr_light light = pictured(P, &e);
    const void *patch = ((const struct sr_light_area *)light.self)->shape.self;
    struct sr_wavelengths w = scenery_wavelengths(20);
    struct sr_point x = {.p = from, .n = {0, 0, 1}, .ns = {0, 0, 1}};

    enum { nodes = 20 * side };
    double E = 0;
    for (int i = 0; i < nodes; ++i)
        for (int j = 0; j < nodes; ++j) {
            struct sr_point there;
            sr_shape_bilinearmesh.point(patch, 0, (sr_vec2){((float)i + 0.5f) / nodes, ((float)j + 0.5f) / nodes},
                                        &there);
            sr_vec3 d = sr_sub(from, there.p), wi = sr_normalize(d);
            double G = (double)sr_length(sr_cross(there.dpdu, there.dpdv)) * fabs((double)sr_dot(wi, there.n)) *
                       fmax(0, -(double)wi.z) / (double)sr_length2(d);
            E += G * (double)sr_light_area.Le(light.self, &there, wi, &w)[3] / ((double)nodes * nodes);
        }
    struct sr_tally drawn = {0}, by_shape = {0};
    for (int i = 0; i < 40000; ++i) {
        struct sr_light_sample s;
        sr_vec2 u = {sr_rng_float(&rng), sr_rng_float(&rng)};
        bool is_drawn = sr_light_draw(light, &x, u, &w, &s);
        sr_tally_add(&drawn, is_drawn ? (double)(s.L[3] / s.pdf) * fmax(0, (double)s.wi.z) : 0);
        struct sr_shape_sample p;
        struct sr_point there = {0};
        if (sr_shape_bilinearmesh.sample(patch, 0, &x, u, &p)) {
            there = (struct sr_point){.p = p.p, .n = p.n, .uv = p.uv};
            sr_vec3 wi = sr_normalize(sr_sub(p.p, x.p));
            double value = (double)sr_light_area.Le(light.self, &there, sr_neg(wi), &w)[3] * fmax(0, (double)wi.z);
            sr_tally_add(&by_shape, value / (double)p.pdf);
        }
    }
    EXPECT_MEAN(drawn, E);
    EXPECT_MEAN(by_shape, E);
    EXPECT(sr_tally_variance(&drawn) < 0.5 * sr_tally_variance(&by_shape)); // that is what it is for
}

TEST(a_picture_on_a_patch_is_drawn_by_its_brightness)
{
    const sr_vec3 rectangle[4] = {{-1, -1, 2}, {1, -1, 2}, {-1, 1, 2}, {1, 1, 2}};
    const sr_vec3 saddle[4] = {{-1, -1, 2}, {1.5f, -1, 3}, {-1, 1.2f, 3.5f}, {0.7f, 1, 1.8f}};
    expect_illuminance_of_picture(rectangle, (sr_vec3){0.2f, 0.1f, 0});
    expect_illuminance_of_picture(rectangle, (sr_vec3){3, 1, 0});
    expect_illuminance_of_picture(saddle, (sr_vec3){0, 0, 0});
}

/* Each draw's density is what pdf says of the point drawn. */
TEST(density_of_a_picture_is_that_of_its_draws)
{
    static const float texels[] = {1, 1, 1, 0, 0, 0, 0.25f, 0.25f, 0.25f, 5, 5, 5};
    struct sr_light_emission e = {.scale = 10, .power = NAN, .texels = {2, 2, 3, NULL, texels, NULL, SR_SRGB}};
    struct sr_error error = {0};
    EXPECT(sr_light_emission_prepare(&e, 2, &scenery_arena, &error) == SR_OK);
    const sr_vec3 saddle[4] = {{-1, -1, 2}, {-1, 1.2f, 3.5f}, {1.5f, -1, 3}, {0.7f, 1, 1.8f}};
    struct sr_light light = pictured(saddle, &e);
    const struct sr_light_area *m = light.self;
    struct sr_wavelengths w = scenery_wavelengths(20);
    struct sr_rng rng = sr_rng_seed(22, 1);
    struct sr_point x = {.p = {0.1f, 0.2f, 0}, .n = {0, 0, 1}, .ns = {0, 0, 1}};
    int n = 0;
    for (int i = 0; i < 2000; ++i) {
        struct sr_light_sample s;
        if (!sr_light_draw(light, &x, (sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}, &w, &s))
            continue;
        float t;
        sr_vec2 hit;
        EXPECT(m->shape.model->intersect(m->shape.self, m->primitive, x.p, s.wi, 0, INFINITY, &t, &hit));
        struct sr_point there;
        m->shape.model->point(m->shape.self, m->primitive, hit, &there);
        // of a cell
        bool is_near_edge = fabsf(fmodf(2 * hit.x, 1) - 0.5f) > 0.499f || fabsf(fmodf(2 * hit.y, 1) - 0.5f) > 0.499f;
        if (!is_near_edge)
            EXPECT_RELATIVE(sr_light_density(light, &x, s.wi, &there), (double)s.pdf, 1e-3);
        ++n;
    }
    EXPECT(n > 1000);
}
