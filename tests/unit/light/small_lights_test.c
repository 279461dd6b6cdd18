/* SPDX-License-Identifier: MIT */
/* Lights without extent against Lambert's laws, and what their brightness means. */
#include "scenery.h"

static const double pi = 3.14159265358979323846;

static const struct sr_light_model *model(const char *name)
{
    const struct sr_light_model *m = sr_light_model_find(name);
    EXPECT(m != NULL);
    return m;
}

TEST(models_are_found_by_name_and_say_where_their_common_part_is)
{
    EXPECT(sr_light_model_find("candle") == NULL);
    for (int i = 0; sr_light_models[i]; ++i) {
        const struct sr_light_model *m = sr_light_models[i];
        EXPECT(sr_light_model_find(m->name) == m);
        EXPECT(m->size >= sizeof(struct sr_light_common));
        EXPECT_EQUAL_INT(sr_light_transform_offset(m), offsetof(struct sr_light_common, light_to_world));
        bool has_image = strcmp(m->name, "infinite") == 0 || strcmp(m->name, "goniometric") == 0 ||
                         strcmp(m->name, "projection") == 0;
        EXPECT((sr_light_texels_offset(m) == SIZE_MAX) == !has_image);
        for (const struct sr_param *p = m->params; p->name; ++p)
            EXPECT(p->offset >= sizeof(struct sr_light_common) && p->offset < m->size);
    }
}

/* E = Phi / (4 pi r^2), whatever the spectrum: 1000 lm at 2 m give 19.894 lx */
TEST(a_point_of_1000_lm_gives_19_89_lx_at_2_m)
{
    const struct sr_spd spectra[] = {sr_spd_constant(7), sr_spd_blackbody(2856), sr_spd_named("stdillum-F11"), {0}};
    for (int i = 0; i < 4; ++i) {
        void *self = scenery_new(model("point"));
        SCENERY_SPD(model("point"), self, "I", spectra[i]);
        SCENERY_FLOAT(model("point"), self, "power", 1000);
        SCENERY_POINT(model("point"), self, "from", 1, -2, 3);
        struct sr_light light = scenery_finish(model("point"), self);
        struct sr_light_sample s;
        EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){1, 0, 3}, &s), 19.8943678865, 1e-5);
        EXPECT(s.is_delta && s.pdf == 1);
        EXPECT_NEAR(s.wi.y, -1, 1e-6);
        EXPECT_NEAR(s.distance, 2, 1e-6);
        EXPECT_RELATIVE(light.model->power(light.self), 1000, 1e-5);
    }
}

/* E = I h / r^3 */
TEST(a_point_over_a_tilted_receiver_gives_1_9099_lx)
{
    void *self = scenery_new(model("point"));
    SCENERY_FLOAT(model("point"), self, "power", 1000);
    ((struct sr_light_common *)self)->light_to_world = sr_transform_translate((sr_vec3){0, 0, 3});
    struct sr_light_sample s;
    double E = scenery_illuminance(scenery_finish(model("point"), self), (sr_vec3){4, 0, 0}, &s);
    EXPECT_RELATIVE(E * (double)s.wi.z, 1.9098593171, 1e-5);
    EXPECT_NEAR(s.distance, 5, 1e-6);
}

/* without power, scale is the luminous intensity; rgb multiplies it, since white alone is normalised */
TEST(rgb_white_has_the_brightness_of_scale_and_grey_half_of_it)
{
    for (int i = 1; i <= 2; ++i) {
        void *self = scenery_new(model("point"));
        float v = (float)i / 2;
        SCENERY_SPD(model("point"), self, "I", sr_spd_from_rgb_illuminant(SR_SRGB, (struct sr_rgb){v, v, v}));
        SCENERY_FLOAT(model("point"), self, "scale", 40);
        struct sr_light_sample s;
        EXPECT_RELATIVE(scenery_illuminance(scenery_finish(model("point"), self), (sr_vec3){2, 0, 0}, &s),
                        (double)v * 10, 2e-3);
    }
}

/* scale multiplies power */
TEST(scale_multiplies_power)
{
    void *self = scenery_new(model("point"));
    SCENERY_FLOAT(model("point"), self, "power", 100);
    SCENERY_FLOAT(model("point"), self, "scale", 3);
    struct sr_light light = scenery_finish(model("point"), self);
    EXPECT_RELATIVE(light.model->power(light.self), 300, 1e-5);
}

TEST(emission_without_luminance_is_refused_and_black_is_black)
{
    struct sr_error error = {0};
    const float lambda[] = {300, 320, 340}, values[] = {0, 1, 0};
    struct sr_spd invisible = sr_spd_from_samples(&scenery_arena, lambda, values, 3, &error);
    EXPECT(error.status == SR_OK);
    void *self = scenery_new(model("point"));
    SCENERY_SPD(model("point"), self, "I", invisible);
    sr_status status = model("point")->prepare(self, &scenery_arena, &error);
    EXPECT(status == SR_ERROR_INPUT ||
           sr_spd_max(&invisible) == 0); // a table of nothing in range may also count as black
    self = scenery_new(model("point"));
    SCENERY_SPD(model("point"), self, "I", sr_spd_constant(0));
    struct sr_light light = scenery_finish(model("point"), self);
    EXPECT(light.model->power(light.self) == 0);
}

/* E = E_perpendicular cos 60 deg = 500, toward where it comes from */
TEST(a_distant_light_of_1000_lx_gives_500_lx_at_60_deg)
{
    void *self = scenery_new(model("distant"));
    SCENERY_FLOAT(model("distant"), self, "illuminance", 1000);
    SCENERY_POINT(model("distant"), self, "from", sinf(SR_PI / 3), 0, 0.5f);
    SCENERY_POINT(model("distant"), self, "to", 0, 0, 0);
    struct sr_light light = scenery_finish(model("distant"), self);
    struct sr_light_sample s;
    double E = scenery_illuminance(light, (sr_vec3){4, 5, 6}, &s);
    EXPECT_RELATIVE(E * (double)s.wi.z, 500, 1e-5);
    EXPECT(isinf(s.distance) && s.is_delta && s.pdf == 1);
    EXPECT_RELATIVE(light.model->power(light.self), 1000 * pi * 4, 1e-5); // the scene's radius is 2
}

TEST(a_distant_light_comes_from_minus_z_by_default_and_turns_with_its_transform)
{
    void *self = scenery_new(model("distant"));
    ((struct sr_light_common *)self)->light_to_world = sr_transform_rotate(90, (sr_vec3){0, 1, 0});
    struct sr_light_sample s;
    EXPECT_RELATIVE(scenery_illuminance(scenery_finish(model("distant"), self), (sr_vec3){0, 0, 0}, &s), 1, 1e-5);
    EXPECT_NEAR(s.wi.x, -1, 1e-6); // -z is turned to -x
}

/* Phi = INTEGRAL I dw = 2 pi I0 ((1 - cos 20) + (cos 20 - cos 30) / 2) = 61.0355 lm for 100 cd */
TEST(a_spot_of_100_cd_from_20_to_30_deg_gives_61_0355_lm)
{
    void *self = scenery_new(model("spot"));
    SCENERY_FLOAT(model("spot"), self, "scale", 100);
    SCENERY_FLOAT(model("spot"), self, "coneangle", 30);
    SCENERY_FLOAT(model("spot"), self, "conedeltaangle", 10);
    SCENERY_POINT(model("spot"), self, "from", 1, 1, 1);
    SCENERY_POINT(model("spot"), self, "to", 1, 5, 1);
    struct sr_light light = scenery_finish(model("spot"), self);
    const double c20 = cos(20 * pi / 180), c30 = cos(30 * pi / 180);
    const double limits[] = {1, c20, c30, 0.5};
    double Phi = 0, x[40], w[40];
    for (int part = 0; part < 3; ++part) {
        sr_gauss_legendre(40, limits[part + 1], limits[part], x, w);
        for (int i = 0; i < 40; ++i) {
            struct sr_light_sample s;
            sr_vec3 d = sr_spherical_direction((float)sqrt(1 - x[i] * x[i]), (float)x[i], (float)i);
            Phi +=
                2 * pi * w[i] * scenery_illuminance(light, (sr_vec3){1 + d.x, 1 + d.z, 1 + d.y}, &s); // axis +y, r = 1
        }
    }
    EXPECT_RELATIVE(Phi, 61.0354826735, 2e-5);
    EXPECT_RELATIVE(light.model->power(light.self), 61.0354826735, 1e-5);
}

TEST(a_spot_with_power_gives_off_that_power)
{
    void *self = scenery_new(model("spot"));
    SCENERY_FLOAT(model("spot"), self, "power", 500);
    struct sr_light light = scenery_finish(model("spot"), self);
    EXPECT_RELATIVE(light.model->power(light.self), 500, 1e-5);
    double c25 = cos(25 * pi / 180), c30 = cos(30 * pi / 180);
    struct sr_light_sample s;
    EXPECT_RELATIVE(scenery_illuminance(light, (sr_vec3){0, 0, 2}, &s),
                    500 / (2 * pi * ((1 - c25) + (c25 - c30) / 2)) / 4, 1e-5);
    EXPECT(scenery_illuminance(light, (sr_vec3){0, 0, -2}, &s) == 0);
}
