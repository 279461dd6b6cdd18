/* SPDX-License-Identifier: MIT */
/* PNG and JPEG files of kinds that are only read: 16 bits, few bits, palettes, transparency, interlacing; grey and
 * CMYK. */
#include "make.h"

#if __has_include(<png.h>) && __has_include(<jpeglib.h>)
#include <jpeglib.h>
#include <png.h>

struct png_kind {
    int depth, type, interlace;
    uint32_t channels; // expected after reading
};

enum { WIDTH = 21, HEIGHT = 13 };

static unsigned sample_at(uint32_t x, uint32_t y, uint32_t c, int depth)
{
    return (x * 7919 + y * 104729 + c * 1299709) & ((1u << depth) - 1);
}

static void pack(uint8_t *row, size_t i, int depth, unsigned value)
{
    if (depth == 16) {
        row[2 * i] = (uint8_t)(value >> 8);
        row[2 * i + 1] = (uint8_t)value;
    } else {
        size_t bit = i * (size_t)depth;
        row[bit / 8] |= (uint8_t)(value << (8 - (size_t)depth - bit % 8));
    }
}

static void write_png(const char *path, struct png_kind kind)
{
    FILE *file = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, WIDTH, HEIGHT, kind.depth, kind.type, kind.interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_color palette[256];
    png_byte alpha[256];
    for (int i = 0; i < 256; i++) {
        palette[i] = (png_color){(png_byte)i, (png_byte)(255 - i), (png_byte)(3 * i)};
        alpha[i] = (png_byte)(7 * i);
    }
    if (kind.type == PNG_COLOR_TYPE_PALETTE) {
        png_set_PLTE(png, info, palette, 1 << kind.depth);
        if (kind.channels == 4)
            png_set_tRNS(png, info, alpha, 1 << kind.depth, NULL);
    }
    png_write_info(png, info);
    uint32_t stored = kind.type == PNG_COLOR_TYPE_PALETTE ? 1 : kind.channels;
    for (int pass = png_set_interlace_handling(png); pass > 0; pass--)
        for (uint32_t y = 0; y < HEIGHT; y++) {
            uint8_t row[WIDTH * 4 * 2] = {0};
            for (uint32_t x = 0; x < WIDTH; x++)
                for (uint32_t c = 0; c < stored; c++)
                    pack(row, x * stored + c, kind.depth, sample_at(x, y, c, kind.depth));
            png_write_row(png, row);
        }
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

static double expected_value(struct png_kind kind, uint32_t x, uint32_t y, uint32_t c)
{
    if (kind.type == PNG_COLOR_TYPE_PALETTE) {
        unsigned i = sample_at(x, y, 0, kind.depth);
        unsigned colour[4] = {i, 255 - i, (3 * i) & 255, (7 * i) & 255};
        return colour[c] / 255.0;
    }
    return sample_at(x, y, c, kind.depth) / (double)((1u << kind.depth) - 1);
}

TEST(png_of_each_kind_gives_the_same_values)
{
    static const struct png_kind kinds[] = {
        {1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, 1},       {2, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7, 1},
        {4, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, 1},       {8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_ADAM7, 3},
        {8, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_INTERLACE_NONE, 2}, {16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7, 1},
        {16, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, 3},       {16, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_ADAM7, 4},
        {1, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, 3},    {4, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_ADAM7, 3},
        {8, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, 4},
    };
    for (size_t k = 0; k < 2 * sizeof kinds / sizeof *kinds; k++) {
        struct png_kind kind = kinds[k / 2];
        enum sr_image_encoding encoding = k % 2 ? SR_IMAGE_LINEAR : SR_IMAGE_SRGB;
        const char *path = path_in_folder("foreign.png");
        write_png(path, kind);
        struct sr_image *image;
        struct sr_error error = {0};
        if (sr_image_read_as(path, encoding, &image, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "kind %zu: %s", k / 2, error.text);
        EXPECT_EQUAL_INT(image->channel_count, kind.channels);
        EXPECT((image->floats != NULL) == (kind.depth == 16));
        EXPECT(sr_image_to_float(image, &error) == SR_OK);
        for (uint32_t y = 0; y < HEIGHT; y++)
            for (uint32_t x = 0; x < WIDTH; x++)
                for (uint32_t c = 0; c < kind.channels; c++) {
                    double expected = expected_value(kind, x, y, c);
                    if (encoding == SR_IMAGE_SRGB && image->channels[c].name[0] != 'A')
                        expected = (double)sr_image_decode_srgb((float)expected);
                    EXPECT_NEAR(image->floats[sr_image_index(image, x, y) + c], expected, 2e-7);
                }
        sr_image_free(image);
    }
}

/* A smooth ramp, so that the loss is small. */
static void write_jpeg(const char *path, int components, J_COLOR_SPACE space, bool is_progressive)
{
    FILE *file = fopen(path, "wb");
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_stdio_dest(&jpeg, file);
    jpeg.image_width = 64;
    jpeg.image_height = 48;
    jpeg.input_components = components;
    jpeg.in_color_space = space;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 98, TRUE);
    if (is_progressive)
        jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < 48; y++) {
        JSAMPLE row[64 * 4];
        JSAMPROW rows[1] = {row};
        for (int i = 0; i < 64 * components; i++)
            row[i] = (JSAMPLE)(2 * (i / components) + y + 20 * (i % components));
        jpeg_write_scanlines(&jpeg, rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    fclose(file);
}

TEST(jpeg_grey_and_colour_are_read_and_cmyk_is_refused)
{
    const char *path = path_in_folder("foreign.jpg");
    for (int k = 0; k < 4; k++) {
        int components = k % 2 ? 3 : 1;
        write_jpeg(path, components, components == 3 ? JCS_RGB : JCS_GRAYSCALE, k >= 2);
        struct sr_image *image = read_or_fail(path);
        EXPECT(image->width == 64 && image->height == 48 && image->channel_count == (uint32_t)components);
        for (int y = 0; y < 48; y++)
            for (int i = 0; i < 64 * components; i++)
                EXPECT_NEAR(image->bytes[y * 64 * components + i], 2 * (i / components) + y + 20 * (i % components), 4);
        sr_image_free(image);
    }
    write_jpeg(path, 4, JCS_CMYK, false);
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(sr_image_read(path, &image, &error), SR_ERROR_INPUT);
    EXPECT(image == NULL && strstr(error.text, "4 colour components"));
}
#endif
