/* SPDX-License-Identifier: MIT */
#include "make.h"

static float at(struct sr_texture t, float s, float tt, float footprint)
{
    struct sr_point x = {.uv = {s, tt}, .dudx = footprint, .dvdy = footprint};
    return sr_texture_float(t, &x);
}

TEST(the_cell_at_the_origin_is_the_first_and_neighbours_differ)
{
    struct made m = make("checkerboard", true);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    for (int i = -3; i < 4; ++i)
        for (int j = -3; j < 4; ++j) {
            float expected = ((i + j) & 1) ? 0 : 1;
            EXPECT_NEAR(at(t, (float)i + 0.01f, (float)j + 0.99f, 0), expected, 0);
            EXPECT_NEAR(at(t, (float)i + 0.5f, (float)j + 0.5f, 0.1f), expected, 0);
        }
    EXPECT_NEAR(at(t, 0, 0, 0), 1, 0); // borders belong to the cell that begins there
    EXPECT_NEAR(at(t, 1, 0, 0), 0, 0);
    sr_arena_free(&m.arena);
}

/* The triangle filter integrated numerically: share of tex2 = 1/2 - 1/2 g(s) g(t), g = INTEGRAL c(x + a) tri(a) da. */
static double filtered(double x, double r)
{
    const int n = 40000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        double a = (2 * (i + 0.5) / n - 1) * r;
        double c = fmod(floor(x + a), 2) == 0 ? 1 : -1;
        sum += c * (1 - fabs(a) / r);
    }
    return sum * 2 / n;
}

TEST(the_footprint_filters_exactly)
{
    struct made m = make("checkerboard", true);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    const float footprints[] = {0.01f, 0.1f, 0.3f, 0.34f, 0.5f, 0.9f, 2, 7};
    const float places[] = {0.02f, 0.31f, 0.499f, 0.501f, 0.98f, 1.07f, 1.9f, 131.3f};
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            double r = 1.5 * (double)footprints[i];
            double expected = 0.5 + 0.5 * filtered((double)places[j], r) * filtered((double)places[7 - j], r);
            EXPECT_NEAR(at(t, places[j], places[7 - j], footprints[i]), expected, 2e-4);
        }
    EXPECT_NEAR(at(t, 0.3f, 0.3f, 1e6f), 0.5, 1e-6);
    sr_arena_free(&m.arena);
}

TEST(the_mean_of_a_checkerboard_is_the_mean_of_its_cells_whatever_the_footprint)
{
    struct made m = make("checkerboard", true);
    *(struct sr_texture *)made_member(&m, "tex1") = sr_texture_constant_float(&m.arena, 0.8f);
    *(struct sr_texture *)made_member(&m, "tex2") = sr_texture_constant_float(&m.arena, 0.2f);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    const float footprints[] = {0, 0.2f, 0.6f, 1.3f};
    for (int k = 0; k < 4; ++k) {
        double sum = 0;
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j)
                sum += (double)at(t, 0.02f * (float)i + 0.01f, 0.02f * (float)j + 0.01f, footprints[k]);
        EXPECT_NEAR(sum / 10000, 0.5, 1e-6);
    }
    sr_arena_free(&m.arena);
}

TEST(cells_in_space_follow_the_transform_of_the_texture)
{
    struct made m = make("checkerboard", true);
    *(int32_t *)made_member(&m, "dimension") = 3;
    made_mapping(&m)->world_to_texture = sr_transform_scale((sr_vec3){2, 2, 2}); // cells of half a metre
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    struct sr_point x = {.p = {0.1f, 0.2f, 0.3f}};
    EXPECT_NEAR(sr_texture_float(t, &x), 1, 0);
    x.p = (sr_vec3){0.6f, 0.2f, 0.3f};
    EXPECT_NEAR(sr_texture_float(t, &x), 0, 0);
    x.p = (sr_vec3){0.6f, -0.2f, 0.3f};
    EXPECT_NEAR(sr_texture_float(t, &x), 1, 0);
    x.p = (sr_vec3){0.6f, -0.2f, -0.3f};
    EXPECT_NEAR(sr_texture_float(t, &x), 0, 0);
    sr_arena_free(&m.arena);
}

TEST(a_checkerboard_of_one_dimension_is_refused)
{
    struct made m = make("checkerboard", false);
    *(int32_t *)made_member(&m, "dimension") = 1;
    struct sr_texture_use use = {SR_PARAM_ALBEDO, SR_SRGB};
    EXPECT_EQUAL_INT(m.model->prepare(m.self, use, &m.arena, &m.error), SR_ERROR_INPUT);
    EXPECT(strstr(m.error.text, "dimension") != NULL);
    sr_arena_free(&m.arena);
}
