/* SPDX-License-Identifier: MIT */
/* texelmap, attribute, product, threshold: channels, wraps, transforms, values of corners. */
#include "make.h"

static const uint8_t bytes[2 * 2 * 4] = {255, 0, 51, 255, 0, 255, 102, 0, 0, 0, 153, 128, 255, 255, 204, 64};
static float linear[256];

static struct sr_texels texels(void)
{
    for (int i = 0; i < 256; ++i)
        linear[i] = (float)i / 255;
    return (struct sr_texels){
        .width = 2, .height = 2, .channels = 4, .bytes = bytes, .decode = linear, .space = SR_SRGB};
}

static struct made map(bool is_float)
{
    struct made m = make("texelmap", is_float);
    *(struct sr_texels *)((char *)m.self + sr_texture_texels_offset(m.model)) = texels();
    return m;
}

static float at(struct sr_texture t, float u, float v)
{
    struct sr_point x = {.uv = {u, v}};
    return sr_texture_float(t, &x);
}

TEST(texelmap_reads_one_channel)
{
    static const float upper_left[5] = {1, 0, 0.2f, 1, 0.4f};
    for (int channel = 0; channel < 5; ++channel) {
        struct made m = map(true);
        *(int32_t *)made_member(&m, "channel") = channel;
        *(float *)made_member(&m, "scale") = 2;
        *(float *)made_member(&m, "offset") = -1;
        struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
        EXPECT_NEAR(at(t, 0.25f, 0.75f), 2 * upper_left[channel] - 1, 1e-6); // the top row is at v = 1
        sr_arena_free(&m.arena);
    }
}

TEST(texelmap_wraps_each_direction_in_its_own_way)
{
    static const float blue[2][2] = {{0.2f, 0.4f}, {0.6f, 0.8f}};
    struct made m = map(true);
    *(int32_t *)made_member(&m, "channel") = 2;
    *(int32_t *)made_member(&m, "filter") = 1;
    *(int32_t *)made_member(&m, "swrap") = 2;
    *(int32_t *)made_member(&m, "twrap") = 1;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    for (int i = -6; i < 6; ++i) {
        int period = ((i % 4) + 4) % 4, column = period < 2 ? period : 3 - period; // 0 1 1 0 0 1 1 0 …
        EXPECT_NEAR(at(t, 0.25f + 0.5f * (float)i, 0.75f), blue[0][column], 1e-6);
        EXPECT_NEAR(at(t, 0.25f, 1 - (0.25f + 0.5f * (float)i)), blue[i < 1 ? 0 : 1][0], 1e-6);
    }
    sr_arena_free(&m.arena);
    m = map(true); // repeated: between the last and the first
    *(int32_t *)made_member(&m, "channel") = 2;
    t = made_texture(&m, SR_PARAM_ALBEDO);
    EXPECT_NEAR(at(t, 0, 0.75f), 0.3, 1e-6);
    EXPECT_NEAR(at(t, 7.25f, -3.25f), 0.2, 1e-5);
    EXPECT_NEAR(at(t, NAN, 0.75f), 0.5, 1e-6); // a corner, where all four meet
    sr_arena_free(&m.arena);
}

TEST(texelmap_moves_coordinates)
{
    static const float turn[6] = {0, 1, 0.5f, -1, 0, 1}; // s = v + 1/2, t = 1 - u
    struct made m = map(true);
    *(int32_t *)made_member(&m, "channel") = 2;
    *(struct sr_slice *)made_member(&m, "transform") = (struct sr_slice){turn, 6};
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    EXPECT_NEAR(at(t, 0.25f, 0.25f), 0.4, 1e-6); // (s, t) = (3/4, 3/4)
    EXPECT_NEAR(at(t, 0.75f, 0.25f), 0.8, 1e-6);
    sr_arena_free(&m.arena);
    m = map(true);
    *(struct sr_slice *)made_member(&m, "transform") = (struct sr_slice){turn, 5};
    EXPECT(m.model->prepare(m.self, (struct sr_texture_use){SR_PARAM_ALBEDO, SR_SRGB}, &m.arena, &m.error) ==
           SR_ERROR_INPUT);
    sr_arena_free(&m.arena);
}

/* The colour of a texture under its own white [linear sRGB]. */
static struct sr_rgb colour_of(struct sr_texture t, const struct sr_point *x)
{
    const struct sr_colour_space *space = sr_colour_space(SR_SRGB);
    double sum[3] = {0}, white = 0;
    struct sr_spd illuminant = {.kind = SR_SPD_TABLE, .scale = 1, .table = space->illuminant};
    for (int nm = 360; nm <= 830; nm += SR_LAMBDA_COUNT) {
        struct sr_wavelengths w = {0};
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            w.lambda[k] = (float)(nm + k);
        sr_spectrum value = sr_texture_spectrum(t, x, &w) * sr_spd_eval(&illuminant, w.lambda);
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
            double xyz[3];
            sr_observer_1931(nm + k, xyz);
            for (int i = 0; i < 3; ++i)
                sum[i] += (double)value[k] * xyz[i];
            white += (double)sr_spd_at(&illuminant, (float)(nm + k)) * xyz[1];
        }
    }
    double rgb[3] = {0};
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            rgb[i] += space->rgb_from_xyz[i][k] * sum[k] / white;
    return (struct sr_rgb){(float)rgb[0], (float)rgb[1], (float)rgb[2]};
}

TEST(texelmap_tints_component_by_component)
{
    static const float factor[3] = {0.5f, 0.5f, 0.8f};
    struct made m = map(false);
    *(struct sr_slice *)made_member(&m, "factor") = (struct sr_slice){factor, 3};
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    struct sr_point x = {.uv = {0.75f, 0.25f}}; // (1, 1, 0.8)
    struct sr_rgb c = colour_of(t, &x);
    EXPECT_NEAR(c.r, 0.5, 4e-3);
    EXPECT_NEAR(c.g, 0.5, 4e-3);
    EXPECT_NEAR(c.b, 0.64, 4e-3);
    sr_arena_free(&m.arena);
}

TEST(attribute_interpolates_values_of_corners)
{
    static const float values[2 * 3 * 4] = {0,    0,    0,    1, 0,    0,    0,    2, 0,    0,    0,    4,
                                            0.8f, 0.2f, 0.2f, 5, 0.2f, 0.8f, 0.2f, 6, 0.2f, 0.2f, 0.8f, 7};
    struct made m = make("attribute", true), s = make("attribute", false);
    *(struct sr_slice *)made_member(&m, "values") = *(struct sr_slice *)made_member(&s, "values") =
        (struct sr_slice){values, 24};
    *(int32_t *)made_member(&m, "components") = *(int32_t *)made_member(&s, "components") = 4;
    *(int32_t *)made_member(&m, "component") = 3;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO), colour = made_texture(&s, SR_PARAM_ALBEDO);
    struct sr_point x = {.uv = {0.25f, 0.5f}};
    EXPECT_NEAR(sr_texture_float(t, &x), 0.25 * 1 + 0.25 * 2 + 0.5 * 4, 1e-6);
    x.face = 1;
    EXPECT_NEAR(sr_texture_float(t, &x), 0.25 * 5 + 0.25 * 6 + 0.5 * 7, 1e-6);
    struct sr_rgb c = colour_of(colour, &x);
    EXPECT_NEAR(c.r, 0.35, 3e-3);
    EXPECT_NEAR(c.g, 0.35, 3e-3);
    EXPECT_NEAR(c.b, 0.5, 3e-3);
    x.face = 17; // of another mesh: no harm
    EXPECT(isfinite(sr_texture_float(t, &x)));
    sr_arena_free(&m.arena);
    sr_arena_free(&s.arena);
}

TEST(product_and_threshold)
{
    struct made p = make("product", false), h = make("threshold", true);
    *(struct sr_texture *)made_member(&p, "tex1") = sr_texture_constant_spectrum(&p.arena, sr_spd_constant(0.5f));
    *(struct sr_texture *)made_member(&p, "tex2") = sr_texture_constant_spectrum(&p.arena, sr_spd_constant(0.4f));
    struct sr_wavelengths w = wavelengths();
    struct sr_point x = {.uv = {0, 0}};
    EXPECT_NEAR(sr_texture_spectrum(made_texture(&p, SR_PARAM_ALBEDO), &x, &w)[2], 0.2, 1e-7);
    *(float *)made_member(&h, "cutoff") = 0.3f;
    float value;
    for (int i = 0; i < 3; ++i) {
        *(struct sr_texture *)made_member(&h, "tex") = sr_texture_constant_float(&h.arena, 0.2f + 0.1f * (float)i);
        struct sr_texture t = made_texture(&h, SR_PARAM_ALBEDO);
        EXPECT(at(t, 0, 0) == (i > 0) && sr_texture_is_constant_float(t, &value) && value == (i > 0));
    }
    sr_arena_free(&p.arena);
    sr_arena_free(&h.arena);
}
