/* SPDX-License-Identifier: MIT */
/* The light of a luminaire file: illuminance I cos / r^2, flux, where it points, and what it refuses. */
#include "scenery.h"
#include "unit/measured/luminaires.h"

static struct sr_light lamp(intensity_of *I, enum sr_photometry_symmetry symmetry, uint32_t c_steps,
                            const struct sr_transform *place, float scale, float power)
{
    const struct sr_light_model *model = sr_light_model_find("ies");
    struct sr_photometry p = luminaire_make(&scenery_arena, symmetry, I, c_steps, 360);
    struct sr_error error = {0};
    char *path = sr_arena_printf(&scenery_arena, "%s/lamp%u.%s", test_folder(), c_steps, c_steps % 2 ? "ldt" : "ies");
    if (sr_photometry_write(path, &p, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    void *self = scenery_new(model);
    scenery_set(model, self, "filename", &(const char *){path}, sizeof path);
    SCENERY_FLOAT(model, self, "scale", scale);
    SCENERY_FLOAT(model, self, "power", power);
    if (place)
        *(struct sr_transform *)(void *)((char *)self + sr_light_transform_offset(model)) = *place;
    return scenery_finish(model, self);
}

TEST(hundred_lumens_of_a_file_give_the_illuminance_of_theory)
{
    struct sr_light_sample s;
    // straight below and 1 m away: 100 / pi lx, and 100 / (4 pi) lx in all directions
    struct sr_light light = lamp(lambertian, SR_PHOTOMETRY_AXIAL, 0, NULL, 1, NAN);
    EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){0, 0, -1}, &s), 31.830989, 1e-5);
    EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){0, 2, -2}, &s), 31.830989 * sqrt(0.5) / 8, 1e-4);
    EXPECT_NEAR(scenery_illuminance(light, (sr_vec3){0, 2, 0.1f}, &s), 0, 0);
    EXPECT_RELATIVE(light.model->power(light.self), 100, 1e-4);
    light = lamp(isotropic, SR_PHOTOMETRY_AXIAL, 0, NULL, 1, NAN);
    EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){0, 0, -1}, &s), 7.9577472, 1e-5);
    EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){0.6f, 0, 0.8f}, &s), 7.9577472, 1e-5);
    // power replaces the file's flux, scale multiplies
    light = lamp(lambertian, SR_PHOTOMETRY_AXIAL, 0, NULL, 2, 500);
    EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){0, 0, -1}, &s), 10 * 31.830989, 1e-4);
    EXPECT_RELATIVE(light.model->power(light.self), 1000, 1e-5);
}

TEST(asymmetric_lamps_follow_their_transform)
{
    struct sr_transform there = sr_transform_translate((sr_vec3){1, 2, 3}),
                        turned = sr_transform_rotate(40, (sr_vec3){1, -2, 0.5f});
    struct sr_transform turn = sr_transform_multiply(&there, &turned);
    for (uint32_t steps = 72; steps < 74; ++steps) { // the second as EULUMDAT
        struct sr_light light = lamp(lopsided, SR_PHOTOMETRY_ALL_PLANES, steps, &turn, 1, NAN);
        EXPECT_RELATIVE(light.model->power(light.self), 200 * 3.14159265358979, 2e-3);
        for (int k = 0; k < 40; ++k) {
            double c = fmod(k * 137.5, 360), gamma = 2 + k * 4.3, g = gamma * RADIANS, a = c * RADIANS,
                   r = 0.5 + 0.1 * k;
            sr_vec3 d = {(float)(sin(g) * cos(a)), (float)(sin(g) * sin(a)), (float)-cos(g)};
            struct sr_light_sample s;
            double E = scenery_illuminance(light, sr_transform_point(&turn, sr_scale((float)r, d)), &s);
            EXPECT_NEAR(E * r * r, lopsided(c, gamma), 0.1);
            EXPECT_NEAR(s.distance, r, 1e-5);
            EXPECT(s.is_delta && s.pdf == 1);
        }
    }
}

TEST(bounds_hold_all_directions_with_light)
{
    struct sr_light light = lamp(cos20, SR_PHOTOMETRY_AXIAL, 0, NULL, 1, NAN);
    struct sr_light_bounds b;
    EXPECT(light.model->bounds(light.self, &b));
    EXPECT_NEAR(b.axis.z, -1, 1e-6);
    EXPECT_NEAR(b.cos_theta_o, 0, 2e-3);
    EXPECT(b.power >= 4 * SR_PI * 1000);
}

TEST(files_that_are_missing_or_wrong_are_told)
{
    const struct sr_light_model *model = sr_light_model_find("ies");
    struct sr_error error = {0};
    void *self = scenery_new(model);
    EXPECT_EQUAL_INT(model->prepare(self, &scenery_arena, &error), SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "filename"));
    error = (struct sr_error){0};
    scenery_set(model, self, "filename", &(const char *){"no/such/lamp.ies"}, sizeof(char *));
    EXPECT(model->prepare(self, &scenery_arena, &error) != SR_OK && strstr(error.text, "no/such/lamp.ies"));
}
