/* SPDX-License-Identifier: MIT */
/* Files come back as they went: every bit of a float in EXR and PFM, every byte in PNG, one part in 128 in RGBE. */
#include "make.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

/* Random bits: floats of every size and sign, NaN with payloads, infinities, denormals. */
static void fill_with_random_bits(struct sr_image *image)
{
    static const uint32_t special[] = {0x00000000, 0x80000000, 0x7f800000, 0xff800000, 0x7fc00000,
                                       0xffc12345, 0x00000001, 0x807fffff, 0x7f7fffff};
    size_t n = (size_t)image->width * image->height * image->channel_count, specials = sizeof special / sizeof *special;
    uint64_t state = 7;
    for (size_t i = 0; i < n; i++) {
        uint32_t bits = i < specials ? special[i] : next_random(&state);
        memcpy(&image->floats[i], &bits, 4);
    }
}

static void expect_same_bits(const struct sr_image *a, const struct sr_image *b)
{
    EXPECT_EQUAL_INT(b->width, a->width);
    EXPECT_EQUAL_INT(b->height, a->height);
    EXPECT_EQUAL_INT(b->channel_count, a->channel_count);
    EXPECT(a->floats && b->floats);
    EXPECT(memcmp(a->floats, b->floats, (size_t)a->width * a->height * a->channel_count * sizeof(float)) == 0);
}

TEST(exr_keeps_every_bit_of_every_channel)
{
    static const char *const names[] = {"R", "G", "B", "A", "SE.B", "SE.G", "SE.R", "diffuse direct.Y", "zz"};
    uint32_t sizes[][2] = {{1, 1}, {37, 53}, {64, 16}, {5, 100}};
    for (size_t k = 0; k < 4; k++) {
        struct sr_image *image = make_image(sizes[k][0], sizes[k][1], 9, names);
        fill_with_random_bits(image);
        struct sr_image *back = round_trip(image, ".exr");
        expect_same_bits(image, back);
        for (uint32_t c = 0; c < 9; c++)
            EXPECT_EQUAL_TEXT(back->channels[c].name, names[c]);
        sr_image_free(image);
        sr_image_free(back);
    }
}

TEST(exr_keeps_units_attributes_chromaticities_and_the_crop)
{
    struct sr_image *image = make_image(8, 6, 3, NULL), *part, *back;
    struct sr_error error = {0};
    sr_image_set_unit(image, 0, "W/(sr m^2)");
    sr_image_set_unit(image, 2, "cd/m^2");
    char longer[2000];
    memset(longer, 'x', sizeof longer);
    longer[sizeof longer - 1] = 0;
    EXPECT(sr_image_set_attribute(image, "scene", "cornell-box", &error) == SR_OK);
    EXPECT(sr_image_set_attribute(image, "an attribute with a name longer than thirty-one bytes", longer, &error) ==
           SR_OK);
    EXPECT(sr_image_set_attribute(image, "scene", "veach-mis", &error) == SR_OK);
    EXPECT(sr_image_set_attribute(image, "empty", "", &error) == SR_OK);
    EXPECT_EQUAL_INT(image->attribute_count, 3);
    image->has_chromaticities = true;
    double k[4][2] = {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};
    memcpy(image->chromaticities, k, sizeof k);
    EXPECT(sr_image_crop(image, 3, 1, 4, 5, &part, &error) == SR_OK);
    back = round_trip(part, ".exr");
    EXPECT_EQUAL_TEXT(back->channels[0].unit, "W/(sr m^2)");
    EXPECT_EQUAL_TEXT(back->channels[1].unit, "");
    EXPECT_EQUAL_TEXT(back->channels[2].unit, "cd/m^2");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(back, "scene"), "veach-mis");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(back, "an attribute with a name longer than thirty-one bytes"), longer);
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(back, "empty"), "");
    EXPECT(sr_image_get_attribute(back, "unit.R") == NULL);
    EXPECT_EQUAL_INT(back->attribute_count, 3);
    EXPECT(back->has_chromaticities);
    for (int i = 0; i < 8; i++)
        EXPECT_NEAR(back->chromaticities[i / 2][i % 2], k[i / 2][i % 2], 1e-7);
    EXPECT_EQUAL_INT(back->x0, 3);
    EXPECT_EQUAL_INT(back->y0, 1);
    EXPECT_EQUAL_INT(back->width, 4);
    EXPECT_EQUAL_INT(back->full_width, 8);
    EXPECT_EQUAL_INT(back->full_height, 6);
    sr_image_free(image);
    sr_image_free(part);
    sr_image_free(back);
}

TEST(exr_takes_many_channels)
{
    const char *names[81];
    static char text[81][16];
    for (int c = 0; c < 81; c++) {
        snprintf(text[c], sizeof text[c], "S0.%03d,5nm", 400 + 5 * c);
        names[c] = text[c];
    }
    struct sr_image *image = make_image(19, 21, 81, names);
    fill_with_random_bits(image);
    struct sr_image *back = round_trip(image, ".exr");
    expect_same_bits(image, back);
    sr_image_free(image);
    sr_image_free(back);
}

TEST(exr_refuses_channels_of_one_name)
{
    static const char *const names[] = {"Y", "Y"};
    struct sr_image *image = make_image(2, 2, 2, names);
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_image_write(path_in_folder("twice.exr"), image, NULL, &error), SR_ERROR_USAGE);
    EXPECT(!sr_file_exists(path_in_folder("twice.exr")));
    sr_image_free(image);
}

TEST(pfm_keeps_every_bit)
{
    for (uint32_t channels = 1; channels <= 3; channels += 2) {
        struct sr_image *image = make_image(13, 7, channels, NULL);
        fill_with_random_bits(image);
        struct sr_image *back = round_trip(image, ".pfm");
        expect_same_bits(image, back);
        sr_image_free(image);
        sr_image_free(back);
    }
}

TEST(pfm_is_read_big_endian_bottom_row_first_and_scaled)
{
    // two rows of one grey pixel: 2.0 below, 1.0 above, times 3
    static const char file[] = "Pf\n1 2\n3.0\n\x40\x00\x00\x00\x3f\x80\x00\x00";
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT(sr_image_decode("x.pfm", file, sizeof file - 1, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT_NEAR(image->floats[0], 3, 0);
    EXPECT_NEAR(image->floats[1], 6, 0);
    sr_image_free(image);
    static const char dos[] = "Pf\r\n1 1\r\n-1.0\r\n\x00\x00\x80\x3f";
    EXPECT(sr_image_decode("x.pfm", dos, sizeof dos - 1, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT_NEAR(image->floats[0], 1, 0);
    sr_image_free(image);
}

TEST(hdr_keeps_colours_to_one_part_in_128_of_the_largest)
{
    // widths below 8 go without run lengths; the left half is constant, so that runs occur
    uint32_t widths[] = {1, 7, 8, 300, 1000};
    for (size_t k = 0; k < 5; k++) {
        struct sr_image *image = make_image(widths[k], 20, 3, NULL);
        uint64_t state = 3;
        size_t n = (size_t)widths[k] * 20;
        for (size_t p = 0; p < n; p++) {
            double scale = p % widths[k] < widths[k] / 2 ? 2 : exp2(40 * next_uniform(&state) - 20);
            for (int c = 0; c < 3; c++)
                image->floats[3 * p + c] = (float)(scale * (scale == 2 ? 0.3 * (c + 1) : next_uniform(&state)));
        }
        struct sr_image *back = round_trip(image, ".hdr");
        double bias = 0;
        for (size_t p = 0; p < n; p++) {
            const float *a = image->floats + 3 * p, *b = back->floats + 3 * p;
            double largest = fmax(a[0], fmax(a[1], a[2]));
            for (int c = 0; c < 3; c++) {
                EXPECT_NEAR(b[c], a[c], largest / 256);
                bias += (double)(b[c] - a[c]) / largest / (3.0 * (double)n);
            }
        }
        // cut mantissas with half a step added: no bias on average; |error| <= 1/256 is uniform, sd 1/443
        if (widths[k] == 1000)
            EXPECT_NEAR(bias, 0, 3e-4);
        sr_image_free(image);
        sr_image_free(back);
    }
}

TEST(hdr_writes_no_negative_and_no_nan)
{
    struct sr_image *image = make_image(8, 1, 3, NULL);
    image->floats[0] = -1;
    image->floats[1] = NAN;
    image->floats[3] = INFINITY;
    struct sr_image *back = round_trip(image, ".hdr");
    EXPECT(back->floats[0] == 0 && back->floats[1] == 0);
    EXPECT(back->floats[3] > 1e37f && isfinite(back->floats[3]));
    sr_image_free(image);
    sr_image_free(back);
}

TEST(hdr_reads_the_older_run_lengths_exposure_and_upward_rows)
{
    // bottom row: (m + 1/2) 2^(e - 136) with m = 127, e = 129, which is 127.5 / 128, repeated 3 times; top row: black
    // the exposures multiply to 2, which halves
    static const char file[] = "#?RADIANCE\n# comment\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=4\nEXPOSURE=0.5\n\n+Y 2 +X 4\n"
                               "\x7f\x7f\x7f\x81\x01\x01\x01\x03\x00\x00\x00\x00\x01\x01\x01\x03";
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT(sr_image_decode("x.hdr", file, sizeof file - 1, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    for (int i = 0; i < 12; i++) {
        EXPECT_NEAR(image->floats[i], 0, 0);
        EXPECT_NEAR(image->floats[12 + i], 127.5 / 128 / 2, 1e-7);
    }
    sr_image_free(image);
}

TEST(hdr_converts_xyze_and_keeps_primaries)
{
    // X, Y, Z = 0.9505, 1, 1.0890 (D65) to half a step of 1/128: grey within 2 %
    static const char file[] = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x79\x80\x8b\x81";
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT(sr_image_decode("x.hdr", file, sizeof file - 1, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    for (int c = 0; c < 3; c++)
        EXPECT_NEAR(image->floats[c], 1, 0.02);
    sr_image_free(image);
    image = make_image(9, 1, 3, NULL);
    double rec2020[4][2] = {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
    image->has_chromaticities = true;
    memcpy(image->chromaticities, rec2020, sizeof rec2020);
    struct sr_image *back = round_trip(image, ".hdr");
    EXPECT(back->has_chromaticities);
    for (int i = 0; i < 8; i++)
        EXPECT_NEAR(back->chromaticities[i / 2][i % 2], rec2020[i / 2][i % 2], 1e-6);
    sr_image_free(image);
    sr_image_free(back);
}

TEST(png_keeps_every_byte)
{
    for (uint32_t channels = 1; channels <= 4; channels++) {
        struct sr_image *image = make_bytes(61, 17, channels), *back = round_trip(image, ".png");
        EXPECT(back->bytes && back->channel_count == channels && back->encoding == SR_IMAGE_SRGB);
        EXPECT(memcmp(image->bytes, back->bytes, 61 * 17 * channels) == 0);
        sr_image_free(image);
        sr_image_free(back);
    }
}

TEST(png_of_floats_is_their_srgb_value)
{
    struct sr_image *image = make_image(3, 1, 1, NULL);
    image->floats[0] = 0.2158605f; // 128/255 encoded
    image->floats[1] = 2;
    image->floats[2] = NAN;
    struct sr_image *back = round_trip(image, ".png");
    EXPECT_EQUAL_INT(back->channel_count, 3);
    EXPECT_EQUAL_INT(back->bytes[0], 128);
    EXPECT_EQUAL_INT(back->bytes[3], 255);
    EXPECT_EQUAL_INT(back->bytes[6], 0);
    sr_image_free(image);
    sr_image_free(back);
}

TEST(tga_is_read_with_runs_palettes_and_any_origin)
{
    struct sr_image *image;
    struct sr_error error = {0};
    // type 10, 24 bits, 3 x 1: a run of two (B,G,R) = (1,2,3), then one (4,5,6)
    static const uint8_t runs[] = {0, 0, 10, 0,  0,    0,    0, 0, 0, 0,    0, 0, 3,
                                   0, 1, 0,  24, 0x20, 0x81, 1, 2, 3, 0x00, 4, 5, 6};
    EXPECT(sr_image_decode("a.tga", runs, sizeof runs, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT(memcmp(image->bytes, "\3\2\1\3\2\1\6\5\4", 9) == 0);
    sr_image_free(image);
    // type 1: palette of two 24-bit colours from index 5 on; 1 x 2, the bottom row first
    static const uint8_t palette[] = {1, 1, 1, 5, 0,   2, 0, 24, 0, 0, 0, 0, 1, 0,
                                      2, 0, 8, 0, 'i', 1, 2, 3,  4, 5, 6, 5, 6};
    EXPECT(sr_image_decode("b.TGA", palette, sizeof palette, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT(memcmp(image->bytes, "\6\5\4\3\2\1", 6) == 0);
    sr_image_free(image);
    // an index outside of it
    uint8_t outside[sizeof palette];
    memcpy(outside, palette, sizeof palette);
    outside[sizeof palette - 1] = 7;
    EXPECT_EQUAL_INT(sr_image_decode("b.tga", outside, sizeof outside, SR_IMAGE_SRGB, &image, &error), SR_ERROR_INPUT);
    EXPECT(image == NULL && strstr(error.text, "palette"));
    // type 2, 16 bits 0rrrrrgggggbbbbb, right to left: red then blue are stored
    static const uint8_t high[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 16, 0x30, 0x00, 0x7c, 0x1f, 0x00};
    EXPECT(sr_image_decode("c.tga", high, sizeof high, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT(memcmp(image->bytes, "\0\0\xff\xff\0\0", 6) == 0);
    sr_image_free(image);
    // type 3 grey, and type 2 with 32 bits and 8 of alpha
    static const uint8_t grey[] = {0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 8, 0x20, 99};
    EXPECT(sr_image_decode("d.tga", grey, sizeof grey, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT(image->channel_count == 1 && image->bytes[0] == 99);
    sr_image_free(image);
    static const uint8_t alpha[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32, 0x28, 1, 2, 3, 4};
    EXPECT(sr_image_decode("e.tga", alpha, sizeof alpha, SR_IMAGE_SRGB, &image, &error) == SR_OK);
    EXPECT(image->channel_count == 4 && memcmp(image->bytes, "\3\2\1\4", 4) == 0);
    sr_image_free(image);
}

static int count_files(const char *folder)
{
    DIR *open = opendir(folder);
    int n = 0;
    for (struct dirent *entry; open && (entry = readdir(open));)
        n += entry->d_name[0] != '.';
    if (open)
        closedir(open);
    return n;
}

TEST(a_write_that_fails_leaves_nothing_behind)
{
    static const char *const endings[] = {"exr", "pfm", "hdr", "png"};
    struct sr_image *image = make_image(4, 4, 3, NULL);
    char folder[4096], path[4200];
    snprintf(folder, sizeof folder, "%s", path_in_folder("writes"));
    mkdir(folder, 0777);
    for (int i = 0; i < 4; i++) {
        struct sr_error error = {0};
        snprintf(path, sizeof path, "%s/absent/x.%s", folder, endings[i]);
        EXPECT_EQUAL_INT(sr_image_write(path, image, NULL, &error), SR_ERROR_RESOURCE);
        EXPECT(strstr(error.text, path) != NULL);
        snprintf(path, sizeof path, "%s/folder.%s", folder, endings[i]);
        EXPECT(mkdir(path, 0777) == 0);
        error = (struct sr_error){0};
        EXPECT_EQUAL_INT(sr_image_write(path, image, NULL, &error), SR_ERROR_RESOURCE);
        EXPECT_EQUAL_INT(count_files(folder), 1);
        EXPECT_EQUAL_INT(count_files(path), 0);
        EXPECT(rmdir(path) == 0);
    }
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/x.gif", folder);
    EXPECT_EQUAL_INT(sr_image_write(path, image, NULL, &error), SR_ERROR_USAGE);
    for (int i = 0; i < 4; i++) {
        snprintf(path, sizeof path, "%s/good.%s", folder, endings[i]);
        error = (struct sr_error){0};
        EXPECT_EQUAL_INT(sr_image_write(path, image, NULL, &error), SR_OK);
        EXPECT_EQUAL_INT(count_files(folder), i + 1);
        struct sr_image *back = read_or_fail(path);
        EXPECT(back->width == 4 && back->height == 4);
        sr_image_free(back);
    }
    sr_image_free(image);
}

TEST(the_content_tells_the_format_not_the_ending)
{
    struct sr_image *image = make_image(9, 9, 3, NULL), *back;
    struct sr_error error = {0};
    void *data;
    size_t size;
    EXPECT(sr_image_encode(".exr", image, NULL, &data, &size, &error) == SR_OK);
    EXPECT(sr_image_decode("picture.png", data, size, SR_IMAGE_SRGB, &back, &error) == SR_OK);
    sr_image_free(back);
    EXPECT_EQUAL_INT(sr_image_decode("picture.png", "hello", 5, SR_IMAGE_SRGB, &back, &error), SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "picture.png") != NULL);
    sr_free(data);
    sr_image_free(image);
}

/* The library leaves out an attribute that it has no memory for, and goes on: the picture would be of other colours. */
TEST(exr_is_read_whole_or_not_at_all_when_memory_ends)
{
    struct sr_image *image = make_image(8, 6, 3, NULL), *whole;
    struct sr_error error = {0};
    char path[512];
    for (uint32_t c = 0; c < 3; ++c)
        sr_image_set_unit(image, c, "cd/m^2");
    EXPECT(sr_image_set_attribute(image, "scene", "cornell-box", &error) == SR_OK);
    image->has_chromaticities = true;
    double k[4][2] = {{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};
    memcpy(image->chromaticities, k, sizeof k);
    snprintf(path, sizeof path, "%s/memory.exr", test_folder());
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    uint64_t before = sr_alloc_count();
    EXPECT(sr_image_read(path, &whole, &error) == SR_OK);
    uint64_t all = sr_alloc_count() - before;
    for (uint64_t i = 0; i < all; ++i) {
        error = (struct sr_error){0};
        sr_alloc_fail(i, 1);
        sr_status status = sr_image_read(path, &image, &error);
        sr_alloc_fail(0, 0);
        EXPECT(status == SR_OK || status == SR_ERROR_RESOURCE);
        if (status != SR_OK)
            continue;
        EXPECT(image->has_chromaticities);
        EXPECT_EQUAL_INT(image->full_width, 8);
        for (uint32_t c = 0; c < 3; ++c)
            EXPECT_EQUAL_TEXT(image->channels[c].unit, "cd/m^2");
        EXPECT_EQUAL_TEXT(sr_image_get_attribute(image, "scene"), "cornell-box");
        EXPECT_EQUAL_INT(image->attribute_count, whole->attribute_count);
        sr_image_free(image);
    }
    sr_image_free(whole);
}
