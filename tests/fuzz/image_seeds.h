/* SPDX-License-Identifier: MIT */
/* Small images of each format. */
#ifndef TEST_FUZZ_IMAGE_SEEDS_H
#define TEST_FUZZ_IMAGE_SEEDS_H

#include "fuzz/seeds.h"
#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

enum { SEED_IMAGE_SIDE = 20 };
static const char *const seed_image_endings[] = {".exr", ".png", ".jpg", ".pfm", ".hdr", ".qoi", ".tga"};

static inline void encode(const char *ending, bool is_bytes, struct seed *s)
{
    struct sr_error error = {0};
    struct sr_image *image;
    void *data;
    size_t size;
    if (sr_image_create(SEED_IMAGE_SIDE, SEED_IMAGE_SIDE, 4, NULL, is_bytes ? SR_IMAGE_BYTES : SR_IMAGE_FLOATS, &image,
                        &error) != SR_OK)
        exit(4);
    for (int i = 0; i < SEED_IMAGE_SIDE * SEED_IMAGE_SIDE * 4; ++i)
        if (is_bytes)
            image->bytes[i] = (uint8_t)(i / 7 * 3);
        else
            image->floats[i] = (float)(i / 9 % 50) * 0.125f;
    sr_image_set_unit(image, 0, "W");
    if (sr_image_set_attribute(image, "note", "seed", &error) != SR_OK ||
        sr_image_encode(ending, image, NULL, &data, &size, &error) != SR_OK)
        exit(4);
    seed_put(s, data, size);
    s->header = s->size < 400 ? s->size : 400;
    sr_free(data);
    sr_image_free(image);
}

static inline void encode_jpeg(struct seed *s)
{
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    unsigned char row[SEED_IMAGE_SIDE * 3], *rows[1] = {row}, *data = NULL;
    unsigned long size = 0;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &data, &size);
    jpeg.image_width = jpeg.image_height = SEED_IMAGE_SIDE;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < SEED_IMAGE_SIDE; ++y) {
        for (int i = 0; i < SEED_IMAGE_SIDE * 3; ++i)
            row[i] = (unsigned char)(i * 5 + y * 9);
        jpeg_write_scanlines(&jpeg, rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    seed_put(s, data, size);
    s->header = s->size;
    free(data);
}

static inline void encode_by_hand(bool is_qoi, struct seed *s)
{
    static const uint8_t qoi[14] = {'q', 'o', 'i', 'f', 0, 0, 0, SEED_IMAGE_SIDE, 0, 0, 0, SEED_IMAGE_SIDE, 4, 0};
    static const uint8_t tga[18] = {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, SEED_IMAGE_SIDE, 0, SEED_IMAGE_SIDE, 0, 32, 8};
    seed_put(s, is_qoi ? qoi : tga, is_qoi ? sizeof qoi : sizeof tga);
    s->header = s->size;
    for (int i = 0; i < SEED_IMAGE_SIDE * SEED_IMAGE_SIDE / 4; ++i) {
        const uint8_t chunk[] = {0xfe, (uint8_t)i, 30,
                                 40,   0xc1,       (uint8_t)(i & 63)}; // a colour, twice more, one of before
        const uint8_t packet[] = {0x83, 10, (uint8_t)i, 30, 255};      // a colour, four times
        seed_put(s, is_qoi ? chunk : packet, is_qoi ? sizeof chunk : sizeof packet);
    }
}

static inline void image_seed(int number, struct seed *seed)
{
    seed->size = seed->header = 0;
    if (number == 2)
        encode_jpeg(seed);
    else if (number >= 5)
        encode_by_hand(number == 5, seed);
    else
        encode(seed_image_endings[number], number == 1, seed);
}

#endif
