/* SPDX-License-Identifier: MIT */
/* Images and numbers that several tests of this room need. */
#ifndef TEST_IMAGE_MAKE_H
#define TEST_IMAGE_MAKE_H

#include "image/image.h"
#include "test.h"

static inline uint32_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33) * 2654435761u;
}

static inline double next_uniform(uint64_t *state)
{
    return (next_random(state) + 0.5) / 4294967296.0;
}

static inline double next_gaussian(uint64_t *state)
{
    double u = next_uniform(state), v = next_uniform(state);
    return sqrt(-2 * log(u)) * cos(2 * (double)SR_PI * v);
}

static inline struct sr_image *make_image(uint32_t width, uint32_t height, uint32_t channels, const char *const *names)
{
    struct sr_image *image;
    struct sr_error error = {0};
    if (sr_image_create(width, height, channels, names, SR_IMAGE_FLOATS, &image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return image;
}

static inline struct sr_image *make_bytes(uint32_t width, uint32_t height, uint32_t channels)
{
    struct sr_image *image;
    struct sr_error error = {0};
    if (sr_image_create(width, height, channels, NULL, SR_IMAGE_BYTES, &image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    uint64_t state = width * 31u + height;
    for (size_t i = 0; i < (size_t)width * height * channels; i++)
        image->bytes[i] = (uint8_t)(next_random(&state) >> 24);
    return image;
}

static inline struct sr_image *read_or_fail(const char *path)
{
    struct sr_image *image;
    struct sr_error error = {0};
    if (sr_image_read(path, &image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return image;
}

static inline const char *path_in_folder(const char *name)
{
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    return path;
}

/* Through memory and back. */
static inline struct sr_image *round_trip(const struct sr_image *image, const char *ending)
{
    void *data;
    size_t size;
    struct sr_error error = {0};
    struct sr_image *back = NULL;
    if (sr_image_encode(ending, image, NULL, &data, &size, &error) != SR_OK ||
        sr_image_decode(ending, data, size, SR_IMAGE_SRGB, &back, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    sr_free(data);
    return back;
}

#endif
