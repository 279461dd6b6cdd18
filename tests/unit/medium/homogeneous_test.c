/* SPDX-License-Identifier: MIT */
/* The uniform medium and the presets. */
#include "test.h"
#include "scenery.h"

TEST(a_uniform_medium_is_one_segment_whose_majorant_is_what_it_has)
{
    const struct sr_medium_model *model = sr_medium_model_find("homogeneous");
    char *self = scenery_medium(model);
    *(struct sr_spd *)scenery_member(model, self, "sigma_a") = sr_spd_constant(0.25f);
    *(struct sr_spd *)scenery_member(model, self, "sigma_s") = sr_spd_constant(0.5f);
    *(float *)scenery_member(model, self, "scale") = 3;
    scenery_prepare(model, self);
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){380, 720}, 0.4f);
    struct sr_medium_at at;
    model->at(self, (sr_vec3){9, 9, 9}, &w, &at);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        EXPECT_NEAR(at.sigma_a[i], 0.75, 1e-6);
        EXPECT_NEAR(at.sigma_s[i], 1.5, 1e-6);
        EXPECT_NEAR(at.Le[i], 0, 0);
    }
    EXPECT(model->is_uniform && !model->glows(self));
    struct sr_medium_walk walk;
    struct sr_medium_segment s;
    model->begin(self, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 1}, 7, &w, &walk);
    EXPECT(model->next(self, &walk, &s));
    EXPECT_NEAR(s.t0, 0, 0);
    EXPECT_NEAR(s.t1, 7, 0);
    EXPECT_NEAR(s.majorant[3], 2.25, 1e-6);
    EXPECT(!model->next(self, &walk, &s));
}

/* Jensen et al. 2001, table 1, and Narasimhan et al. 2006, table 2 */
TEST(presets_have_the_colours_that_were_measured)
{
    static const struct {
        const char *name;
        double scattering[3], absorption[3]; // [1/mm]
    } printed[] = {
        {"Wholemilk", {2.55, 3.21, 3.77}, {0.0011, 0.0024, 0.014}},
        {"Ketchup", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}},
        {"Merlot", {2.1129e-5, 0, 0}, {0.11632, 0.25191, 0.29434}},
    };
    for (int k = 0; k < 3; ++k) {
        struct sr_spd s[2];
        EXPECT(sr_medium_preset(printed[k].name, &s[1], &s[0]));
        for (int which = 0; which < 2; ++which) { // under the white of sRGB, as the colour of a reflectance is
            const double *expected = which ? printed[k].absorption : printed[k].scattering;
            const struct sr_colour_space *srgb = sr_colour_space(SR_SRGB);
            double xyz[3] = {0, 0, 0}, largest = fmax(expected[0], fmax(expected[1], expected[2]));
            for (int lambda = 360; lambda <= 830; ++lambda) {
                double bar[3];
                sr_observer_1931(lambda, bar);
                struct sr_spd white = {.kind = SR_SPD_TABLE, .scale = 1, .table = srgb->illuminant};
                for (int i = 0; i < 3; ++i)
                    xyz[i] += bar[i] *
                              (double)(sr_spd_at(&s[which], (float)lambda) * sr_spd_at(&white, (float)lambda)) /
                              srgb->illuminant_luminous_integral;
            }
            struct sr_rgb rgb = sr_rgb_from_xyz(srgb, (struct sr_xyz){(float)xyz[0], (float)xyz[1], (float)xyz[2]});
            EXPECT_NEAR(rgb.r, expected[0], 0.01 * largest);
            EXPECT_NEAR(rgb.g, expected[1], 0.01 * largest);
            EXPECT_NEAR(rgb.b, expected[2], 0.01 * largest);
        }
    }
    int n = 0;
    for (; sr_medium_preset_name(n); ++n) {
        struct sr_spd a, b;
        EXPECT(sr_medium_preset(sr_medium_preset_name(n), &a, &b));
    }
    EXPECT_EQUAL_INT(n, 47);
    struct sr_spd a, b;
    EXPECT(!sr_medium_preset("Gravy", &a, &b));
}

TEST(emission_has_the_luminance_that_the_scene_says)
{
    const struct sr_medium_model *model = sr_medium_model_find("homogeneous");
    for (int kind = 0; kind < 3; ++kind) {
        char *self = scenery_medium(model);
        *(struct sr_spd *)scenery_member(model, self, "Le") =
            kind == 0   ? sr_spd_blackbody(3000)
            : kind == 1 ? sr_spd_from_rgb_illuminant(SR_SRGB, (struct sr_rgb){0.5f, 0.5f, 0.5f})
                        : sr_spd_constant(0.2f);
        *(float *)scenery_member(model, self, "Lescale") = 4;
        ((struct sr_medium_common *)(void *)self)->is_absolute = kind == 2;
        scenery_prepare(model, self);
        EXPECT(model->glows(self));
        const struct sr_spd *Le = scenery_member(model, self, "Le");
        double luminance = sr_spd_luminous_integral(Le);
        EXPECT_RELATIVE(luminance, kind == 0 ? 4 : kind == 1 ? 2 : 4 * 0.2 * 683 * SR_CIE_Y_INTEGRAL, 2e-3);
    }
}

TEST(nonsense_is_refused)
{
    const struct sr_medium_model *model = sr_medium_model_find("homogeneous");
    struct sr_error error = {0};
    char *self = scenery_medium(model);
    *(const char **)scenery_member(model, self, "preset") = "Gravy";
    EXPECT(model->prepare(self, scenery_arena(), &error) == SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "there is no preset \"Gravy\"");
    self = scenery_medium(model);
    error = (struct sr_error){0};
    *(struct sr_spd *)scenery_member(model, self, "sigma_a") = sr_spd_constant(1e30f);
    *(float *)scenery_member(model, self, "scale") = 1e30f;
    EXPECT(model->prepare(self, scenery_arena(), &error) == SR_ERROR_INPUT);
}
