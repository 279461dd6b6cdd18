/* SPDX-License-Identifier: MIT */
/* Images: whatever the bytes, the reader says what is wrong or gives an image whose pixels are all there, of a size that the file
 * can back.
 *
 * FUZZ_SEED: 0 EXR, 1 PNG, 2 JPEG, 3 PFM, 4 HDR, 5 QOI, 6 TGA. Runs as fuzz_measured.c does. */
#include "fuzz/seeds.h"
#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

enum { SIDE = 20 };
static const char *const endings[] = {".exr", ".png", ".jpg", ".pfm", ".hdr", ".qoi", ".tga"};

static void encode(const char *ending, bool is_bytes, struct seed *s)
{
    struct sr_error error = {0};
    struct sr_image *image;
    void *data;
    size_t size;
    if (sr_image_create(SIDE, SIDE, 4, NULL, is_bytes ? SR_IMAGE_BYTES : SR_IMAGE_FLOATS, &image, &error) != SR_OK)
        exit(4);
    for (int i = 0; i < SIDE * SIDE * 4; ++i)
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

static void encode_jpeg(struct seed *s)
{
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    unsigned char row[SIDE * 3], *rows[1] = {row}, *data = NULL;
    unsigned long size = 0;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &data, &size);
    jpeg.image_width = jpeg.image_height = SIDE;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < SIDE; ++y) {
        for (int i = 0; i < SIDE * 3; ++i)
            row[i] = (unsigned char)(i * 5 + y * 9);
        jpeg_write_scanlines(&jpeg, rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    seed_put(s, data, size);
    s->header = s->size;
    free(data);
}

static void encode_by_hand(bool is_qoi, struct seed *s)
{
    static const uint8_t qoi[14] = {'q', 'o', 'i', 'f', 0, 0, 0, SIDE, 0, 0, 0, SIDE, 4, 0};
    static const uint8_t tga[18] = {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, SIDE, 0, SIDE, 0, 32, 8};
    seed_put(s, is_qoi ? qoi : tga, is_qoi ? sizeof qoi : sizeof tga);
    s->header = s->size;
    for (int i = 0; i < SIDE * SIDE / 4; ++i) {
        const uint8_t chunk[] = {0xfe, (uint8_t)i, 30, 40, 0xc1, (uint8_t)(i & 63)}; // a colour, twice more, one of before
        const uint8_t packet[] = {0x83, 10, (uint8_t)i, 30, 255};                    // a colour, four times
        seed_put(s, is_qoi ? chunk : packet, is_qoi ? sizeof chunk : sizeof packet);
    }
}

static void make_seed(int number, struct seed *seed)
{
    seed->size = seed->header = 0;
    if (number == 2)
        encode_jpeg(seed);
    else if (number >= 5)
        encode_by_hand(number == 5, seed);
    else
        encode(endings[number], number == 1, seed);
}

static const char *seed_name(int number)
{
    return endings[number] + 1;
}

static void judge(const uint8_t *data, size_t size)
{
    char label[16];
    struct sr_error error = {0};
    struct sr_image *image;
    snprintf(label, sizeof label, "file%s", endings[FUZZ_SEED]);
    sr_status status = sr_image_decode(label, data, size, SR_IMAGE_SRGB, &image, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status == SR_OK) != (image != NULL) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (status == SR_OK) {
        size_t count = (size_t)image->width * image->height * image->channel_count;
        uint64_t sum = 0;
        if (!image->bytes == !image->floats || count * (image->bytes ? 1 : 4) > sr_image_limit_B(size))
            abort();
        for (size_t i = 0; i < count; ++i) // each is there
            sum += image->bytes ? image->bytes[i] : ((const uint32_t *)image->floats)[i];
        __asm__ volatile("" : : "r"(sum));
    }
    sr_image_free(image);
}

#include "fuzz/driver.h"
