/* SPDX-License-Identifier: MIT */
/* Images: whatever the bytes, the reader says what is wrong or gives an image whose pixels are all there, of a size
 * that the file can back.
 *
 * FUZZ_SEED: 0 EXR, 1 PNG, 2 JPEG, 3 PFM, 4 HDR, 5 QOI, 6 TGA. Runs as fuzz_measured.c does. */
#include "fuzz/image_seeds.h"
#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>

static void make_seed(int number, struct seed *seed)
{
    image_seed(number, seed);
}

static const char *seed_name(int number)
{
    return seed_image_endings[number] + 1;
}

static void judge(const uint8_t *data, size_t size)
{
    char label[16];
    struct sr_error error = {0};
    struct sr_image *image;
    snprintf(label, sizeof label, "file%s", seed_image_endings[FUZZ_SEED]);
    sr_status status = sr_image_decode(label, data, size, SR_IMAGE_SRGB, &image, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status == SR_OK) != (image != NULL) ||
        (status != SR_OK && !error.text[0]))
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
