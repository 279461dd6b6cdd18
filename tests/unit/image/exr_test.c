/* SPDX-License-Identifier: MIT */
/* EXR files of other layouts than ours: half, float and uint samples, tiles, each compression, windows off the
 * origin. */
#include "make.h"

#if __has_include(<OpenEXR/openexr.h>)
#include <OpenEXR/openexr.h>

enum { WIDTH = 45, HEIGHT = 39, X0 = -7, Y0 = 13, TILE = 16 };

/* A value that half, float and uint hold exactly. */
static unsigned value_at(uint32_t x, uint32_t y, int channel)
{
    return x * 8 + y * 3 + (unsigned)channel * 500;
}

/* Bits of a whole number below 2048 as a half. */
static uint16_t half_of(unsigned v)
{
    int exponent = 0;
    for (unsigned u = v; u > 1; u >>= 1)
        exponent++;
    unsigned bits = (unsigned)(exponent + 15) << 10 | (((v << 10) >> exponent) & 0x3ff);
    return (uint16_t)(v == 0 ? 0 : bits);
}

struct planes {
    uint16_t half[HEIGHT][WIDTH];
    float real[HEIGHT][WIDTH];
    uint32_t whole[HEIGHT][WIDTH];
};

static struct planes planes;

static void point_at(exr_encode_pipeline_t *pipeline, uint32_t x, uint32_t y)
{
    for (int c = 0; c < pipeline->channel_count; c++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[c];
        bool is_half = channel->data_type == EXR_PIXEL_HALF, is_float = channel->data_type == EXR_PIXEL_FLOAT;
        const void *from = is_half    ? (const void *)&planes.half[y][x]
                           : is_float ? (const void *)&planes.real[y][x]
                                      : (const void *)&planes.whole[y][x];
        channel->encode_from_ptr = from;
        channel->user_pixel_stride = is_half ? 2 : 4;
        channel->user_line_stride = channel->user_pixel_stride * WIDTH;
    }
}

#define MUST(call) EXPECT((call) == EXR_ERR_SUCCESS)

static void write_foreign(const char *path, exr_compression_t compression, bool is_tiled)
{
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            planes.half[y][x] = half_of(value_at(x, y, 0));
            planes.real[y][x] = (float)value_at(x, y, 1);
            planes.whole[y][x] = value_at(x, y, 2);
        }
    exr_context_t exr;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    int part;
    exr_attr_box2i_t data = {.min = {.x = X0, .y = Y0}, .max = {.x = X0 + WIDTH - 1, .y = Y0 + HEIGHT - 1}};
    exr_attr_box2i_t display = {.min = {.x = -10, .y = 10}, .max = {.x = 89, .y = 59}};
    exr_attr_v2f_t centre = {.x = 0, .y = 0};
    MUST(exr_start_write(&exr, path, EXR_WRITE_FILE_DIRECTLY, &init));
    MUST(exr_add_part(exr, "first", is_tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &part));
    MUST(exr_initialize_required_attr(exr, part, &display, &data, 1, &centre, 1, EXR_LINEORDER_INCREASING_Y,
                                      compression));
    if (is_tiled)
        MUST(exr_set_tile_descriptor(exr, part, TILE, TILE, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN));
    MUST(exr_add_channel(exr, part, "R", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    MUST(exr_add_channel(exr, part, "depth", EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    MUST(exr_add_channel(exr, part, "id", EXR_PIXEL_UINT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    MUST(exr_write_header(exr));
    int32_t lines = TILE;
    if (!is_tiled)
        MUST(exr_get_scanlines_per_chunk(exr, part, &lines));
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    bool is_first = true;
    for (int y = 0; y < HEIGHT; y += lines)
        for (int x = 0; x < WIDTH; x += is_tiled ? TILE : WIDTH) {
            exr_chunk_info_t info;
            if (is_tiled)
                MUST(exr_write_tile_chunk_info(exr, part, x / TILE, y / TILE, 0, 0, &info));
            else
                MUST(exr_write_scanline_chunk_info(exr, part, Y0 + y, &info));
            MUST(is_first ? exr_encoding_initialize(exr, part, &info, &pipeline)
                          : exr_encoding_update(exr, part, &info, &pipeline));
            point_at(&pipeline, (uint32_t)x, (uint32_t)y);
            if (is_first)
                MUST(exr_encoding_choose_default_routines(exr, part, &pipeline));
            is_first = false;
            MUST(exr_encoding_run(exr, part, &pipeline));
        }
    MUST(exr_encoding_destroy(exr, &pipeline));
    MUST(exr_finish(&exr));
}

TEST(exr_of_each_layout_and_compression_gives_the_same_values)
{
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                                     EXR_COMPRESSION_ZIP,  EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24};
    for (size_t k = 0; k < 2 * sizeof compressions / sizeof *compressions; k++) {
        const char *path = path_in_folder("foreign.exr");
        write_foreign(path, compressions[k / 2], k % 2);
        struct sr_image *image = read_or_fail(path);
        EXPECT(image->width == WIDTH && image->height == HEIGHT && image->channel_count == 3);
        EXPECT(image->x0 == 3 && image->y0 == 3 && image->full_width == 100 && image->full_height == 50);
        EXPECT_EQUAL_TEXT(image->channels[0].name, "R");
        EXPECT_EQUAL_TEXT(image->channels[1].name, "depth");
        EXPECT_EQUAL_TEXT(image->channels[2].name, "id");
        for (uint32_t y = 0; y < HEIGHT; y++)
            for (uint32_t x = 0; x < WIDTH; x++)
                for (int c = 0; c < 3; c++)
                    if (image->floats[sr_image_index(image, x, y) + (size_t)c] != (float)value_at(x, y, c))
                        test_fail(__FILE__, __LINE__,
                                  "compression %d, tiled %d, pixel (%u, %u), channel %d: %g, expected %u",
                                  (int)compressions[k / 2], (int)(k % 2), x, y, c,
                                  (double)image->floats[sr_image_index(image, x, y) + (size_t)c], value_at(x, y, c));
        sr_image_free(image);
    }
}

TEST(exr_in_b44_is_read_to_its_precision)
{
    for (int is_tiled = 0; is_tiled < 2; is_tiled++) {
        const char *path = path_in_folder("b44.exr");
        write_foreign(path, is_tiled ? EXR_COMPRESSION_B44A : EXR_COMPRESSION_B44, is_tiled);
        struct sr_image *image = read_or_fail(path);
        for (uint32_t y = 0; y < HEIGHT; y++)
            for (uint32_t x = 0; x < WIDTH; x++) {
                const float *v = image->floats + sr_image_index(image, x, y);
                EXPECT_NEAR(v[0], value_at(x, y, 0), 0.1 * value_at(x, y, 0) + 8);
                EXPECT(v[1] == (float)value_at(x, y, 1) && v[2] == (float)value_at(x, y, 2));
            }
        sr_image_free(image);
    }
}
#endif
