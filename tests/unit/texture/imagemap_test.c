/* SPDX-License-Identifier: MIT */
#include "make.h"

enum { BILINEAR, POINT, TRILINEAR, EWA };
enum { REPEAT, CLAMP, BLACK, OCTAHEDRAL };

static struct made image(bool is_float, uint32_t width, uint32_t height, uint32_t channels, const float *floats)
{
    struct made m = make("imagemap", is_float);
    *(struct sr_texels *)(void *)((char *)m.self + sr_texture_texels_offset(m.model)) =
        (struct sr_texels){.width = width, .height = height, .channels = channels, .floats = floats, .space = SR_SRGB};
    return m;
}

static float at(struct sr_texture t, float s, float tt, float footprint)
{
    struct sr_point x = {.uv = {s, tt}, .dudx = footprint, .dvdy = footprint};
    return sr_texture_float(t, &x);
}

static const float ramp[8] = {1, 2, 3, 4, 10, 20, 30, 40}; // 4 x 2: the second row is the lower

TEST(texel_centres_give_texels_and_the_first_row_is_the_upper)
{
    struct made m = image(true, 4, 2, 1, ramp);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(at(t, ((float)i + 0.5f) / 4, 0.75f, 0), ramp[i], 1e-6);
        EXPECT_NEAR(at(t, ((float)i + 0.5f) / 4, 0.25f, 0), ramp[4 + i], 1e-5);
    }
    EXPECT_NEAR(at(t, 0.25f, 0.5f, 0), (1 + 2 + 10 + 20) / 4.0, 1e-5);
    EXPECT_NEAR(at(t, 0.375f + 0.0625f, 0.75f, 0), 2 * 0.75 + 3 * 0.25, 1e-5);
    sr_arena_free(&m.arena);
}

TEST(wraps_say_what_is_beyond_the_border)
{
    struct made m = image(true, 4, 2, 1, ramp);
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    int32_t *wrap = made_member(&m, "wrap");
    *wrap = REPEAT;
    EXPECT_NEAR(at(t, 0, 0.75f, 0), (4 + 1) / 2.0, 1e-6);
    EXPECT_NEAR(at(t, 5.125f, -7.25f, 0), 1, 1e-5);
    *wrap = CLAMP;
    EXPECT_NEAR(at(t, 0, 0.75f, 0), 1, 1e-6);
    EXPECT_NEAR(at(t, 9, -9, 0), 40, 1e-5);
    *wrap = BLACK;
    EXPECT_NEAR(at(t, 0, 0.75f, 0), 0.5, 1e-6);
    EXPECT_NEAR(at(t, 9, -9, 0), 0, 0);
    *wrap = OCTAHEDRAL; // the left neighbour of texel (0, 0) is (0, 1), the upper one (3, 0)
    EXPECT_NEAR(at(t, 0, 0.75f, 0), (1 + 10) / 2.0, 1e-6);
    EXPECT_NEAR(at(t, 0.125f, 1, 0), (1 + 4) / 2.0, 1e-6);
    for (int w = REPEAT; w <= OCTAHEDRAL; ++w) { // nothing strange may crash
        *wrap = w;
        EXPECT(isfinite(at(t, NAN, 1e30f, 0)) && isfinite(at(t, -1e30f, INFINITY, NAN)));
    }
    sr_arena_free(&m.arena);
}

TEST(point_filter_takes_the_nearest_texel)
{
    struct made m = image(true, 4, 2, 1, ramp);
    *(int32_t *)made_member(&m, "filter") = POINT;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    EXPECT_NEAR(at(t, 0.49f, 0.51f, 0), 2, 0);
    EXPECT_NEAR(at(t, 0.51f, 0.49f, 0), 30, 0);
    EXPECT_NEAR(at(t, 1.01f, 0.51f, 0), 1, 0);
    sr_arena_free(&m.arena);
}

TEST(scale_comes_before_invert_and_nothing_is_negative)
{
    static const float values[2] = {0.25f, 0.75f};
    struct made m = image(true, 2, 1, 1, values);
    *(float *)made_member(&m, "scale") = 2;
    *(bool *)made_member(&m, "invert") = true;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    EXPECT_NEAR(at(t, 0.25f, 0.5f, 0), 0.5, 1e-7);
    EXPECT_NEAR(at(t, 0.75f, 0.5f, 0), 0, 0); // max(0, 1 - 1.5)
    sr_arena_free(&m.arena);
}

TEST(a_float_texture_takes_the_mean_of_rgb_or_alpha)
{
    static const float rgb[3] = {0.1f, 0.2f, 0.6f}, rgba[4] = {0.1f, 0.2f, 0.6f, 0.7f};
    struct made m = image(true, 1, 1, 3, rgb), n = image(true, 1, 1, 4, rgba);
    EXPECT_NEAR(at(made_texture(&m, SR_PARAM_ALBEDO), 0.5f, 0.5f, 0), 0.3, 1e-6);
    EXPECT_NEAR(at(made_texture(&n, SR_PARAM_ALBEDO), 0.5f, 0.5f, 0), 0.7, 1e-6);
    static const float opaque[4] = {0.1f, 0.2f, 0.6f, 1};
    struct made o = image(true, 1, 1, 4, opaque); // as pbrt: an alpha of 1 everywhere is none
    EXPECT_NEAR(at(made_texture(&o, SR_PARAM_ALBEDO), 0.5f, 0.5f, 0), 0.3, 1e-6);
    sr_arena_free(&o.arena);
    sr_arena_free(&m.arena);
    sr_arena_free(&n.arena);
}

/* Every level has the mean of the image, powers of two or not; the last is the mean. */
TEST(each_level_keeps_the_mean)
{
    enum { W = 13, H = 6 };
    static float values[W * H];
    double mean = 0;
    for (int i = 0; i < W * H; ++i) {
        values[i] = (float)((i * 7919) % 101) / 100;
        mean += (double)values[i] / (W * H);
    }
    struct made m = image(true, W, H, 1, values);
    *(int32_t *)made_member(&m, "filter") = POINT;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    for (int level = 0; level <= 4; ++level) { // 13 x 6, 7 x 3, 4 x 2, 2 x 1, 1 x 1
        float footprint = 0.5f * exp2f((float)level - 4 + 0.5f);
        uint32_t w = W, h = H;
        for (int k = 0; k < level; ++k)
            w = (w + 1) / 2, h = (h + 1) / 2;
        double sum = 0;
        for (uint32_t y = 0; y < h; ++y)
            for (uint32_t x = 0; x < w; ++x)
                sum += (double)at(t, ((float)x + 0.5f) / (float)w, ((float)y + 0.5f) / (float)h, footprint);
        EXPECT_NEAR(sum / (w * h), mean, 1e-6);
    }
    EXPECT_NEAR(at(t, 0.3f, 0.3f, 100), mean, 1e-6);
    sr_arena_free(&m.arena);
}

TEST(trilinear_mixes_two_levels_and_ewa_follows_a_long_footprint)
{
    static float values[64];
    for (int i = 0; i < 64; ++i)
        values[i] = (float)((i * 37) % 11);
    struct made m = image(true, 8, 8, 1, values), e = image(true, 8, 8, 1, values);
    *(int32_t *)made_member(&m, "filter") = TRILINEAR;
    *(int32_t *)made_member(&e, "filter") = EWA;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO), ewa = made_texture(&e, SR_PARAM_ALBEDO);
    // level = 3 + log2(2 footprint): 1 and 2 at 1/8 and 1/4; halfway the mean of both
    float one = at(t, 0.3f, 0.6f, 0.125f), two = at(t, 0.3f, 0.6f, 0.25f);
    EXPECT_NEAR(at(t, 0.3f, 0.6f, 0.125f * sqrtf(2)), (one + two) / 2, 1e-5);
    for (float f = 1; f < 8; f *= 1.5f) // the whole image: both are its mean
        EXPECT_NEAR(at(ewa, 0.3f, 0.6f, f), at(t, 0.3f, 0.6f, f), 1e-5);
    // a long one averages along itself: columns of alternating texels become their mean, across stays sharp
    for (int i = 0; i < 64; ++i)
        values[i] = (float)(i / 8 % 2 * 2); // rows 0, 2, 0, 2, …
    struct made r = image(true, 8, 8, 1, values);
    *(int32_t *)made_member(&r, "filter") = EWA;
    struct sr_texture rows = made_texture(&r, SR_PARAM_ALBEDO);
    struct sr_point along = {.uv = {0.3f, 1 - 0.1875f}, .dudx = 0.4f, .dvdy = 0.06f};
    EXPECT_NEAR(sr_texture_float(rows, &along), 2,
                0.2); // its neighbours count a little: the ellipse is a texel wide at least
    struct sr_point across = {.uv = {0.3f, 1 - 0.1875f}, .dudx = 0.06f, .dvdy = 0.4f};
    EXPECT_NEAR(sr_texture_float(rows, &across), 1, 0.35);
    sr_arena_free(&m.arena);
    sr_arena_free(&e.arena);
    sr_arena_free(&r.arena);
}

/* The sum over all texels of an image of which copies lie in all directions. */
static double ewa_by_definition(const float *values, int n, double s, double t, const double a[2], const double b[2])
{
    double A = a[1] * a[1] + b[1] * b[1] + 1, B = -2 * (a[0] * a[1] + b[0] * b[1]), C = a[0] * a[0] + b[0] * b[0] + 1;
    double F = A * C - B * B / 4, sum = 0, weights = 0;
    for (int j = -2 * n; j < 3 * n; ++j)
        for (int i = -2 * n; i < 3 * n; ++i) {
            double x = i + 0.5 - s * n, y = j + 0.5 - t * n, r2 = (A * x * x + B * x * y + C * y * y) / F;
            if (r2 < 1) {
                sum += (exp(-2 * r2) - exp(-2)) * (double)values[(j + 2 * n) % n * n + (i + 2 * n) % n];
                weights += exp(-2 * r2) - exp(-2);
            }
        }
    return sum / weights;
}

TEST(ewa_weighs_the_texels_under_the_ellipse)
{
    enum { N = 16 };
    static float values[N * N];
    for (int i = 0; i < N * N; ++i)
        values[i] = (float)((i * 7919) % 101) / 100;
    struct made m = image(true, N, N, 1, values);
    *(int32_t *)made_member(&m, "filter") = EWA;
    *(float *)made_member(&m, "maxanisotropy") = 4;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    // minor axes of at most one texel, so that the image itself is read; along and across the rows, and slanted
    const double axes[][4] = {
        {2, 0, 0, 0.9}, {0, 0.5, 1.8, 0}, {2, 1.5, -0.4, 0.6}, {0.7, 0.3, 1, 2.5}, {0.1, 0, 0, 0.1}};
    for (size_t k = 0; k < sizeof axes / sizeof *axes; ++k)
        for (int p = 0; p < 20; ++p) {
            double s = 0.137 * p + 0.03, v = 0.31 * p - 1.2; // in several periods
            struct sr_point x = {.uv = {(float)s, (float)(1 - v)},
                                 .dudx = (float)(axes[k][0] / N),
                                 .dvdx = (float)(-axes[k][1] / N),
                                 .dudy = (float)(axes[k][2] / N),
                                 .dvdy = (float)(-axes[k][3] / N)};
            double expected = ewa_by_definition(values, N, s - floor(s), v - floor(v), axes[k], axes[k] + 2);
            EXPECT_NEAR(sr_texture_float(t, &x), expected, 2e-4);
        }
    // an ellipse longer than maxanisotropy times its width is widened to that
    double major[2] = {8, 0}, minor[2] = {0, 2};
    struct sr_point thin = {.uv = {0.3f, 0.4f}, .dudx = 8.0f / N, .dvdy = 0.1f / N};
    double one = ewa_by_definition(values, N, 0.3, 0.6, major, minor); // of level 1 in fact: only near
    EXPECT_NEAR(sr_texture_float(t, &thin), one, 0.05);
    sr_arena_free(&m.arena);
}

/* Over a whole period, each filter gives back the mean of the texels, however wide, and black beyond borders aside. */
TEST(every_filter_keeps_the_mean_of_the_texels)
{
    enum { W = 24, H = 8, FINE = 2 };
    static float values[3 * W * H];
    double mean = 0;
    for (int i = 0; i < 3 * W * H; ++i) {
        values[i] = (float)((i * 7919) % 101) / 100;
        mean += i % 3 == 0 ? (double)values[i] / (W * H) : 0;
    }
    static float red[W * H];
    for (int i = 0; i < W * H; ++i)
        red[i] = values[3 * i];
    const float axes[][4] = {{0, 0, 0, 0},
                             {0.05f, 0, 0, 0.05f},
                             {0.2f, 0.03f, -0.02f, 0.04f},
                             {0.01f, 0.3f, 0.1f, 0},
                             {0.3f, 0.3f, 0.02f, -0.02f}};
    for (int filter = BILINEAR; filter <= EWA; ++filter) {
        struct made m = image(true, W, H, 1, red), c = image(false, W, H, 3, values);
        *(int32_t *)made_member(&m, "filter") = filter;
        *(int32_t *)made_member(&c, "filter") = filter;
        struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO), spectral = made_texture(&c, SR_PARAM_ALBEDO);
        struct sr_wavelengths w = wavelengths();
        double first = 0;
        for (size_t k = 0; k < sizeof axes / sizeof *axes; ++k) {
            double sum = 0, sum_of_spectra = 0;
            for (int j = 0; j < H * FINE; ++j)
                for (int i = 0; i < W * FINE; ++i) {
                    struct sr_point x = {.uv = {((float)i + 0.25f) / (W * FINE), ((float)j + 0.25f) / (H * FINE)},
                                         .dudx = axes[k][0],
                                         .dvdx = axes[k][1],
                                         .dudy = axes[k][2],
                                         .dvdy = axes[k][3]};
                    sum += (double)sr_texture_float(t, &x) / (W * H * FINE * FINE);
                    sum_of_spectra +=
                        (double)sr_texture_spectrum(spectral, &x, &w)[3 * SR_LAMBDA_COUNT / 8] / (W * H * FINE * FINE);
                }
            EXPECT_NEAR(sum, mean, 2e-6);
            first = k == 0 ? sum_of_spectra : first;
            EXPECT_NEAR(sum_of_spectra, first, 0.02); // levels are curves of mean RGB: metamers
        }
        sr_arena_free(&m.arena);
        sr_arena_free(&c.arena);
    }
}

TEST(bytes_are_decoded_and_alpha_is_not)
{
    static float decode[256];
    for (int i = 0; i < 256; ++i)
        decode[i] = (float)i * (float)i; // anything but linear
    static const uint8_t grey[1] = {5}, rgba[4] = {1, 2, 3, 51};
    struct made m = image(true, 1, 1, 1, NULL), n = image(true, 1, 1, 4, NULL);
    struct sr_texels *t = (void *)((char *)m.self + sr_texture_texels_offset(m.model));
    t->bytes = grey;
    t->decode = decode;
    EXPECT_NEAR(at(made_texture(&m, SR_PARAM_ALBEDO), 0, 0, 0), 25, 0);
    t = (void *)((char *)n.self + sr_texture_texels_offset(n.model));
    t->bytes = rgba;
    t->decode = decode;
    EXPECT_NEAR(at(made_texture(&n, SR_PARAM_ALBEDO), 0, 0, 0), 0.2, 1e-7);
    sr_arena_free(&m.arena);
    sr_arena_free(&n.arena);
}

static double colour_error(struct sr_texture t, struct sr_point x, const double expected[3], bool is_emission)
{
    // the colour of the reflectance under the space's illuminant (or of the emission): integrals of 1 nm steps
    const struct sr_colour_space *space = sr_colour_space(SR_SRGB);
    struct sr_spd white = {.kind = SR_SPD_TABLE, .scale = 1, .table = space->illuminant};
    struct sr_spd emitted_white = sr_spd_from_rgb_illuminant(SR_SRGB, (struct sr_rgb){1, 1, 1});
    double xyz[3] = {0}, norm = 0;
    for (int lambda = 360; lambda <= 830; lambda += SR_LAMBDA_COUNT) {
        struct sr_wavelengths w;
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            w.lambda[i] = (float)(lambda + i);
        sr_spectrum s = sr_texture_spectrum(t, &x, &w);
        sr_spectrum light = sr_spd_eval(is_emission ? &emitted_white : &white, w.lambda);
        for (int i = 0; i < SR_LAMBDA_COUNT && lambda + i <= 830; ++i) {
            double bar[3];
            sr_observer_1931(lambda + i, bar);
            for (int k = 0; k < 3; ++k)
                xyz[k] += (is_emission ? (double)s[i] : (double)(s[i] * light[i])) * bar[k];
            norm += (double)light[i] * bar[1];
        }
    }
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
        double value = 0;
        for (int j = 0; j < 3; ++j)
            value += space->rgb_from_xyz[k][j] * xyz[j] / norm;
        worst = fmax(worst, fabs(value - expected[k]));
    }
    return worst;
}

/* Interpolation is linear in the spectrum, so the colour of what is between texels is the interpolated RGB. */
TEST(the_colour_between_texels_is_the_interpolated_rgb)
{
    static const float rgb[4 * 3] = {0.8f, 0.1f, 0.1f, 0.1f, 0.7f, 0.2f, 0.05f, 0.1f, 0.6f, 0.9f, 0.9f, 0.9f};
    const float places[3][2] = {{0.25f, 0.75f}, {0.5f, 0.5f}, {0.35f, 0.6f}};
    for (int use = 0; use < 3; ++use) {
        const enum sr_param_kind kinds[3] = {SR_PARAM_ALBEDO, SR_PARAM_UNBOUNDED, SR_PARAM_ILLUMINANT};
        float scale = use == 0 ? 1 : 7.3f;
        struct made m = image(false, 2, 2, 3, rgb);
        *(float *)made_member(&m, "scale") = scale;
        struct sr_texture t = made_texture(&m, kinds[use]);
        for (int p = 0; p < 3; ++p) {
            struct sr_point x = {.uv = {places[p][0], places[p][1]}};
            double s = 2 * (double)places[p][0] - 0.5, v = 2 * (1 - (double)places[p][1]) - 0.5, expected[3];
            for (int k = 0; k < 3; ++k)
                expected[k] = (double)scale * ((1 - v) * ((1 - s) * (double)rgb[k] + s * (double)rgb[3 + k]) +
                                               v * ((1 - s) * (double)rgb[6 + k] + s * (double)rgb[9 + k]));
            EXPECT_NEAR(colour_error(t, x, expected, use == 2), 0, 2e-3 * (double)scale);
        }
        sr_arena_free(&m.arena);
    }
}

TEST(a_texel_is_the_curve_of_its_rgb)
{
    struct sr_wavelengths w = wavelengths();
    for (int i = 0; i < 27; ++i) {
        float rgb[3] = {(float)(i % 3) / 2, (float)(i / 3 % 3) / 2, (float)(i / 9) / 2};
        struct made m = image(false, 1, 1, 3, rgb);
        struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
        struct sr_spd expected = sr_spd_from_rgb_albedo(SR_SRGB, (struct sr_rgb){rgb[0], rgb[1], rgb[2]});
        sr_spectrum a = sr_texture_spectrum(t, &(struct sr_point){0}, &w), b = sr_spd_eval(&expected, w.lambda);
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            EXPECT_NEAR(a[k], b[k], 1e-3); // the corners of the cube are the worst
        sr_arena_free(&m.arena);
    }
}

TEST(texels_that_are_no_numbers_do_no_harm)
{
    static const float rgb[6] = {NAN, INFINITY, -1, -INFINITY, 1e38f, 0.5f};
    struct sr_wavelengths w = wavelengths();
    const enum sr_param_kind kinds[3] = {SR_PARAM_ALBEDO, SR_PARAM_UNBOUNDED, SR_PARAM_ILLUMINANT};
    for (int use = 0; use < 3; ++use) {
        struct made m = image(false, 2, 1, 3, rgb);
        struct sr_texture t = made_texture(&m, kinds[use]);
        struct sr_point x = {.uv = {0.4f, 0.5f}};
        sr_spectrum s = sr_texture_spectrum(t, &x, &w);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            EXPECT(isfinite(s[i]) && s[i] >= 0);
        sr_arena_free(&m.arena);
    }
}

/* Colours that repeat are converted once in a band of rows: each texel must still be its own, also where two colours
 * that differ in green alone fall on one another in the converter's memory. */
TEST(every_texel_of_a_large_image_is_its_own)
{
    enum { SIZE = 300 };
    static float rgb[SIZE * SIZE * 3];
    for (int i = 0; i < SIZE * SIZE; ++i) {
        rgb[3 * i] = rgb[3 * i + 2] = 0.5f;
        rgb[3 * i + 1] = (float)((uint32_t)(i % 20000) * 2654435761u >> 8) * 0x1p-24f;
    }
    struct made m = image(false, SIZE, SIZE, 3, rgb);
    *(int32_t *)made_member(&m, "filter") = POINT;
    struct sr_texture t = made_texture(&m, SR_PARAM_ALBEDO);
    struct sr_wavelengths w = wavelengths();
    for (int i = 0; i < SIZE * SIZE; i += 7) {
        struct sr_point x = {.uv = {((float)(i % SIZE) + 0.5f) / SIZE, 1 - ((float)(i / SIZE) + 0.5f) / SIZE}};
        struct sr_spd expected = sr_spd_from_rgb_albedo(SR_SRGB, (struct sr_rgb){0.5f, rgb[3 * i + 1], 0.5f});
        sr_spectrum s = sr_texture_spectrum(t, &x, &w), e = sr_spd_eval(&expected, w.lambda);
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            EXPECT_NEAR(s[k], e[k], 1e-3);
    }
    sr_arena_free(&m.arena);
}

TEST(an_image_without_texels_is_refused)
{
    struct made m = image(false, 0, 0, 3, NULL);
    struct sr_texture_use use = {SR_PARAM_ALBEDO, SR_SRGB};
    EXPECT_EQUAL_INT(m.model->prepare(m.self, use, &m.arena, &m.error), SR_ERROR_INPUT);
    sr_arena_free(&m.arena);
}

TEST(textures_of_one_image_share_its_levels_where_they_are_the_same)
{
    struct made first = image(true, 4, 2, 1, ramp), like = image(true, 4, 2, 1, ramp),
                darker = image(true, 4, 2, 1, ramp);
    *(int32_t *)made_member(&like, "filter") = POINT;
    *(float *)made_member(&darker, "scale") = 0.5f;
    struct sr_texture t = made_texture(&first, SR_PARAM_ALBEDO);
    first.model->share(like.self, first.self);
    first.model->share(darker.self, first.self);
    struct sr_texture a = made_texture(&like, SR_PARAM_ALBEDO), b = made_texture(&darker, SR_PARAM_ALBEDO);
    EXPECT(like.arena.total < first.arena.total && darker.arena.total == first.arena.total);
    EXPECT_NEAR(at(t, 0.49f, 0.75f, 0), 2.46, 1e-5);
    EXPECT_NEAR(at(a, 0.49f, 0.75f, 0), 2, 0);
    EXPECT_NEAR(at(b, 0.125f, 0.25f, 0), 5, 1e-6);
    sr_arena_free(&first.arena);
    sr_arena_free(&like.arena);
    sr_arena_free(&darker.arena);
}
