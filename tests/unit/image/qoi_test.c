/* SPDX-License-Identifier: MIT */
/* QOI by the letter of its specification: one chunk of each kind, and files that are cut or lie. */
#include "image/image.h"
#include "test.h"

static const uint8_t file[] = {
    'q',  'o',  'i', 'f', 0, 0, 0, 5, 0, 0, 0, 2, 4, 0, // 5 x 2, RGBA
    0xfe, 16,   32,  48,                                // RGB
    0x72,                                               // differences 1, -2, 0
    0xaa, 0x5c,                                         // green 10, red -3 and blue 4 more than green
    0xc2,                                               // three more of it
    0xff, 1,    2,   3,   4,                            // RGBA
    0x15,                                               // the colour at place (3 16 + 5 32 + 7 48 + 11 255) mod 64 = 21
    0xfe, 0,    0,   255,                               // RGB, alpha stays
    0x5b,                                               // differences -1, 0, 1, which wrap around
    0,    0,    0,   0,   0, 0, 0, 1,
};
static const uint8_t pixels[10][4] = {{16, 32, 48, 255}, {17, 30, 48, 255}, {24, 40, 62, 255}, {24, 40, 62, 255},
                                      {24, 40, 62, 255}, {24, 40, 62, 255}, {1, 2, 3, 4},      {16, 32, 48, 255},
                                      {0, 0, 255, 255},  {255, 0, 0, 255}};

TEST(qoi_chunks_of_all_kinds_are_read)
{
    struct sr_image *image;
    struct sr_error error = {0};
    if (sr_image_decode("a", file, sizeof file, SR_IMAGE_SRGB, &image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    EXPECT_EQUAL_INT(image->width, 5);
    EXPECT_EQUAL_INT(image->height, 2);
    EXPECT_EQUAL_INT(image->channel_count, 4);
    EXPECT(image->encoding == SR_IMAGE_SRGB);
    for (int i = 0; i < 40; ++i)
        EXPECT_EQUAL_INT(image->bytes[i], pixels[i / 4][i % 4]);
    sr_image_free(image);
    uint8_t rgb[sizeof file];
    memcpy(rgb, file, sizeof file);
    rgb[12] = 3;
    EXPECT(sr_image_decode("a.qoi", rgb, sizeof rgb, SR_IMAGE_LINEAR, &image, &error) == SR_OK);
    for (int i = 0; i < 30; ++i)
        EXPECT_EQUAL_INT(image->bytes[i], pixels[i / 3][i % 3]);
    sr_image_free(image);
}

TEST(qoi_files_that_are_cut_or_lie_are_refused)
{
    struct sr_image *image;
    for (size_t size = 1; size < sizeof file - 8; ++size) {
        struct sr_error error = {0};
        EXPECT(sr_image_decode("a.qoi", file, size, SR_IMAGE_SRGB, &image, &error) == SR_ERROR_INPUT && !image);
    }
    for (int k = 0; k < 4; ++k) {
        static const int at[4] = {4, 7, 12, 12};
        static const uint8_t wrong[4] = {0x7f, 0, 2, 200};
        uint8_t broken[sizeof file];
        struct sr_error error = {0};
        memcpy(broken, file, sizeof file);
        broken[at[k]] = wrong[k];
        EXPECT(sr_image_decode("a.qoi", broken, sizeof broken, SR_IMAGE_SRGB, &image, &error) != SR_OK && !image &&
               error.text[0]);
    }
}
