/* SPDX-License-Identifier: MIT */
/* Images in memory: limits, crop, the curve of sRGB, statistics, exposure and tone. */
#include "make.h"

TEST(an_image_that_cannot_be_fails_cleanly)
{
    struct sr_image *image = (struct sr_image *)1;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_image_create(1000000000, 1000000000, 3, NULL, SR_IMAGE_FLOATS, &image, &error),
                     SR_ERROR_RESOURCE);
    EXPECT(image == NULL && strstr(error.text, "1000000000 x 1000000000"));
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_create(UINT32_MAX, 1, 1, NULL, SR_IMAGE_BYTES, &image, &error), SR_ERROR_INPUT);
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_create(0, 5, 1, NULL, SR_IMAGE_BYTES, &image, &error), SR_ERROR_INPUT);
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_create(5, 5, 0, NULL, SR_IMAGE_BYTES, &image, &error), SR_ERROR_INPUT);
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_create(1 << 30, 1 << 30, 65536, NULL, SR_IMAGE_FLOATS, &image, &error),
                     SR_ERROR_RESOURCE);
}

TEST(a_crop_keeps_its_place_and_refuses_what_lies_outside)
{
    struct sr_image *image = make_image(5, 4, 2, NULL), *part, *smaller;
    struct sr_error error = {0};
    for (int i = 0; i < 40; i++)
        image->floats[i] = (float)i;
    EXPECT(sr_image_crop(image, 1, 2, 3, 2, &part, &error) == SR_OK);
    EXPECT(sr_image_crop(part, 2, 1, 1, 1, &smaller, &error) == SR_OK);
    EXPECT_NEAR(smaller->floats[0], (3 * 5 + 3) * 2, 0);
    EXPECT_NEAR(smaller->floats[1], (3 * 5 + 3) * 2 + 1, 0);
    EXPECT(smaller->x0 == 3 && smaller->y0 == 3 && smaller->full_width == 5 && smaller->full_height == 4);
    sr_image_free(part);
    EXPECT_EQUAL_INT(sr_image_crop(image, 4, 0, 2, 1, &part, &error), SR_ERROR_USAGE);
    EXPECT(part == NULL);
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_image_crop(image, 1, 0, UINT32_MAX, 1, &part, &error), SR_ERROR_USAGE);
    sr_image_free(smaller);
    sr_image_free(image);
}

TEST(srgb_goes_there_and_back)
{
    EXPECT_NEAR(sr_image_decode_srgb(0.5f), 0.21404114, 1e-6);
    EXPECT_NEAR(sr_image_decode_srgb(0.04f), 0.04 / 12.92, 1e-8);
    for (int i = 0; i < 256; i++) {
        float v = sr_image_encode_srgb(sr_image_decode_srgb((float)i / 255));
        EXPECT_EQUAL_INT((int)(v * 255 + 0.5f), i);
    }
}

TEST(bytes_become_linear_floats_and_alpha_stays_linear)
{
    struct sr_image *image = make_bytes(1, 1, 4);
    struct sr_error error = {0};
    memset(image->bytes, 128, 4);
    EXPECT(sr_image_to_float(image, &error) == SR_OK);
    EXPECT_NEAR(image->floats[0], 0.21586050, 1e-6);
    EXPECT_NEAR(image->floats[3], 128.0 / 255, 1e-6);
    EXPECT(!image->bytes);
    sr_image_free(image);
    image = make_bytes(1, 1, 1);
    image->bytes[0] = 51;
    image->encoding = SR_IMAGE_LINEAR;
    EXPECT(sr_image_to_float(image, &error) == SR_OK);
    EXPECT_NEAR(image->floats[0], 0.2, 1e-7);
    sr_image_free(image);
}

TEST(statistics_are_those_computed_by_hand)
{
    struct sr_image *image = make_image(8, 1, 2, NULL);
    float values[8] = {4, 1, NAN, 3, INFINITY, -2, 0, -INFINITY};
    for (int i = 0; i < 8; i++)
        image->floats[2 * i + 1] = values[i];
    struct sr_image_statistics s;
    struct sr_error error = {0};
    EXPECT(sr_image_statistics(image, 1, &s, &error) == SR_OK);
    EXPECT_EQUAL_INT(s.count, 5);
    EXPECT_EQUAL_INT(s.nan_count, 1);
    EXPECT_EQUAL_INT(s.infinite_count, 2);
    EXPECT_EQUAL_INT(s.negative_count, 2);
    EXPECT_EQUAL_INT(s.zero_count, 1);
    EXPECT_NEAR(s.sum, 6, 0);
    EXPECT_NEAR(s.mean, 1.2, 1e-15);
    EXPECT_NEAR(s.deviation, sqrt((2.8 * 2.8 + 0.2 * 0.2 + 1.8 * 1.8 + 3.2 * 3.2 + 1.2 * 1.2) / 4), 1e-12);
    EXPECT_NEAR(s.min, -2, 0);
    EXPECT_NEAR(s.max, 4, 0);
    EXPECT_NEAR(s.percentile_50, 1, 0);
    EXPECT_NEAR(s.percentile_95, 3.8, 1e-12);
    EXPECT_NEAR(s.percentile_5, -1.6, 1e-12);
    EXPECT_EQUAL_INT(sr_image_statistics(image, 2, &s, &error), SR_ERROR_USAGE);
    sr_image_free(image);
}

TEST(auto_exposure_brings_the_log_average_to_18_percent)
{
    struct sr_image *image = make_image(100, 100, 3, NULL);
    for (int i = 0; i < 30000; i++)
        image->floats[i] = 0.18f * 8;
    EXPECT_NEAR(sr_image_auto_exposure(image), -3, 1e-5);
    // a half-black image: black pixels do not count
    for (int i = 0; i < 15000; i++)
        image->floats[i] = 0;
    EXPECT_NEAR(sr_image_auto_exposure(image), -3, 1e-5);
    // 2 % of highlights at 1000 guard: the 99th percentile ends at 4
    for (int i = 0; i < 30000; i++)
        image->floats[i] = i < 600 ? 1000.0f : 0.01f;
    EXPECT_NEAR(sr_image_auto_exposure(image), log2(4.0 / 1000), 1e-5);
    memset(image->floats, 0, 30000 * sizeof(float));
    EXPECT_NEAR(sr_image_auto_exposure(image), 0, 0);
    sr_image_free(image);
}

static void expect_mapped(const struct sr_image *image, struct sr_tone tone, int r, int g, int b)
{
    struct sr_image *mapped;
    struct sr_error error = {0};
    EXPECT(sr_image_tone_map(image, &tone, &mapped, &error) == SR_OK);
    EXPECT_NEAR(mapped->bytes[0], r, 1);
    EXPECT_NEAR(mapped->bytes[1], g, 1);
    EXPECT_NEAR(mapped->bytes[2], b, 1);
    sr_image_free(mapped);
}

static int encoded(double linear)
{
    return (int)(255 * sr_image_encode_srgb((float)linear) + 0.5f);
}

TEST(tone_operators_follow_their_formulas)
{
    struct sr_image *image = make_image(1, 1, 3, NULL);
    image->floats[0] = 0.25f;
    image->floats[1] = 0.5f;
    image->floats[2] = 4;
    expect_mapped(image, (struct sr_tone){SR_TONE_LINEAR, false, 0}, encoded(0.25), encoded(0.5), 255);
    expect_mapped(image, (struct sr_tone){SR_TONE_LINEAR, false, -2}, encoded(0.0625), encoded(0.125), 255);
    double Y = 0.2126 * 0.25 + 0.7152 * 0.5 + 0.0722 * 4, s = (1 + Y / 16) / (1 + Y);
    expect_mapped(image, (struct sr_tone){SR_TONE_REINHARD, false, 0}, encoded(0.25 * s), encoded(0.5 * s), 255);
    image->floats[0] = image->floats[1] = image->floats[2] = 4;
    expect_mapped(image, (struct sr_tone){SR_TONE_REINHARD, false, 0}, 255, 255, 255);
    image->floats[0] = image->floats[1] = image->floats[2] = 11.2f;
    expect_mapped(image, (struct sr_tone){SR_TONE_FILMIC, false, 0}, 255, 255, 255);
    image->floats[0] = -1;
    image->floats[1] = NAN;
    image->floats[2] = INFINITY;
    for (int op = 0; op < 3; op++)
        if (op != SR_TONE_REINHARD)
            expect_mapped(image, (struct sr_tone){(enum sr_tone_operator)op, false, 0}, 0, 0, 255);
    sr_image_free(image);
}

TEST(white_stays_white_whatever_the_primaries)
{
    // ACES AP0, whose white is D60; and XYZ of D65
    struct sr_image *image = make_image(1, 1, 3, NULL);
    double ap0[4][2] = {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};
    image->has_chromaticities = true;
    memcpy(image->chromaticities, ap0, sizeof ap0);
    image->floats[0] = image->floats[1] = image->floats[2] = 0.5f;
    expect_mapped(image, (struct sr_tone){0}, encoded(0.5), encoded(0.5), encoded(0.5));
    // Rec. 2020 green is more than sRGB can show: red would be negative; its luminance is 0.678
    double rec2020[4][2] = {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
    memcpy(image->chromaticities, rec2020, sizeof rec2020);
    image->floats[0] = 0;
    image->floats[1] = 0.5f;
    image->floats[2] = 0;
    expect_mapped(image, (struct sr_tone){0}, 0, encoded(0.5 * 1.1329), 0);
    sr_image_free(image);
    static const char *const names[] = {"X", "Y", "Z"};
    image = make_image(1, 1, 3, names);
    image->floats[0] = 0.95047f * 0.3f;
    image->floats[1] = 0.3f;
    image->floats[2] = 1.08883f * 0.3f;
    expect_mapped(image, (struct sr_tone){0}, encoded(0.3), encoded(0.3), encoded(0.3));
    sr_image_free(image);
}
