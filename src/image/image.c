/* SPDX-License-Identifier: MIT */
/* Images in memory: life, channels, attributes, and the transfer curve of sRGB (IEC 61966-2-1:1999):
 *
 *     linear = v / 12.92                      v <= 0.04045     [1]
 *     linear = ((v + 0.055) / 1.055)^2.4      above
 *
 * Limits: a side of 2^30 pixels, 65536 channels, the memory of the machine. */
#include "image/codec.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { MAX_SIDE = 1 << 30, MAX_CHANNELS = 65536 };

static size_t machine_memory_B(void)
{
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? (size_t)pages * (size_t)page : SIZE_MAX / 8;
}

static void name_channels(struct sr_image *image, const char *const *names)
{
    static const char *const usual[4][4] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    for (uint32_t c = 0; c < image->channel_count; c++) {
        char *name = image->channels[c].name;
        if (names)
            snprintf(name, sizeof image->channels[c].name, "%s", names[c]);
        else if (image->channel_count <= 4)
            snprintf(name, sizeof image->channels[c].name, "%s", usual[image->channel_count - 1][c]);
        else
            snprintf(name, sizeof image->channels[c].name, "C%u", c);
    }
}

/* Size of the pixels [B], or false where it cannot be had. */
static bool pixel_bytes(uint64_t width, uint64_t height, uint32_t channel_count, enum sr_image_type type, size_t *size)
{
    size_t n;
    return !__builtin_mul_overflow(width, height, &n) && !__builtin_mul_overflow(n, (size_t)channel_count, &n) &&
           !__builtin_mul_overflow(n, type == SR_IMAGE_FLOATS ? sizeof(float) : 1, size);
}

/* With memory for so many of its rows. */
static sr_status create(uint32_t width, uint32_t height, uint32_t rows, uint32_t channel_count,
                        const char *const *names, enum sr_image_type type, struct sr_image **image,
                        struct sr_error *error)
{
    *image = NULL;
    if (width == 0 || height == 0 || channel_count == 0 || width > MAX_SIDE || height > MAX_SIDE ||
        channel_count > MAX_CHANNELS)
        return sr_fail(
            error, SR_ERROR_INPUT,
            "an image of %u x %u pixels with %u channels: sides of 1 to %d and 1 to %d channels were expected", width,
            height, channel_count, (int)MAX_SIDE, (int)MAX_CHANNELS);
    size_t size;
    bool fits = pixel_bytes(width, height, channel_count, type, &size) && size <= machine_memory_B();
    struct sr_image *made = fits ? sr_alloc(sizeof *made) : NULL;
    if (made) {
        *made = (struct sr_image){.width = width,
                                  .height = height,
                                  .channel_count = channel_count,
                                  .full_width = width,
                                  .full_height = height};
        made->channels = sr_arena_alloc(&made->arena, channel_count * sizeof *made->channels);
        void *pixels = made->channels ? sr_alloc(size / height * rows) : NULL;
        if (type == SR_IMAGE_FLOATS)
            made->floats = pixels;
        else
            made->bytes = pixels;
        if (!pixels) {
            sr_image_free(made);
            made = NULL;
        }
    }
    if (!made)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for an image of %u x %u pixels with %u channels",
                       width, height, channel_count);
    name_channels(made, names);
    *image = made;
    return SR_OK;
}

sr_status sr_image_create(uint32_t width, uint32_t height, uint32_t channel_count, const char *const *names,
                          enum sr_image_type type, struct sr_image **image, struct sr_error *error)
{
    return create(width, height, height, channel_count, names, type, image, error);
}

size_t sr_image_limit_B(size_t file_B)
{
    return ((size_t)256 << 20) + (file_B < SIZE_MAX / 4096 ? file_B * 2000 : SIZE_MAX / 2);
}

/* What a file's size backs, whatever it says. */
static size_t free_B(const struct sr_image_source *source)
{
    return ((size_t)64 << 20) + 16 * source->size;
}

sr_status sr_image_create_for(const struct sr_image_source *source, uint64_t width, uint64_t height,
                              uint32_t channel_count, const char *const *names, enum sr_image_type type,
                              struct sr_image **image, struct sr_error *error)
{
    *image = NULL;
    size_t size;
    if (width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE)
        return sr_fail(error, SR_ERROR_INPUT, "%s: tells a size of %llu x %llu pixels, sides of 1 to %d were expected",
                       source->label, (unsigned long long)width, (unsigned long long)height, (int)MAX_SIDE);
    if (!pixel_bytes(width, height, channel_count, type, &size) || size > sr_image_limit_B(source->size) ||
        size / height > free_B(source))
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: tells a size of %llu x %llu pixels with %u channels, which its %zu bytes cannot hold",
                       source->label, (unsigned long long)width, (unsigned long long)height, channel_count,
                       source->size);
    struct sr_error why = {0};
    bool is_trial = !source->is_proven && size > free_B(source);
    sr_status status = create((uint32_t)width, (uint32_t)height, is_trial ? 1 : (uint32_t)height, channel_count, names,
                              type, image, &why);
    if (status == SR_OK)
        (*image)->encoding = source->encoding;
    return status == SR_OK ? status : sr_fail(error, status, "%s: %s", source->label, why.text);
}

static size_t size_of(const struct sr_image *image, size_t rows)
{
    return rows * image->width * image->channel_count * (image->floats ? sizeof(float) : 1);
}

bool sr_image_is_trial(const struct sr_image_source *source, const struct sr_image *image)
{
    return !source->is_proven && size_of(image, image->height) > free_B(source);
}

void *sr_image_row(const struct sr_image_source *source, const struct sr_image *image, uint32_t y)
{
    char *pixels = image->floats ? (char *)image->floats : (char *)image->bytes;
    return pixels + size_of(image, sr_image_is_trial(source, image) ? 0 : y);
}

void sr_image_free(struct sr_image *image)
{
    if (!image)
        return;
    sr_free(image->floats);
    sr_free(image->bytes);
    struct sr_arena arena = image->arena;
    sr_arena_free(&arena);
    sr_free(image);
}

static sr_status copy_attributes(struct sr_image *to, const struct sr_image *from, struct sr_error *error)
{
    memcpy(to->channels, from->channels, from->channel_count * sizeof *from->channels);
    to->has_chromaticities = from->has_chromaticities;
    memcpy(to->chromaticities, from->chromaticities, sizeof to->chromaticities);
    to->encoding = from->encoding;
    sr_status status = SR_OK;
    for (uint32_t i = 0; i < from->attribute_count && status == SR_OK; i++)
        status = sr_image_set_attribute(to, from->attributes[i].name, from->attributes[i].text, error);
    return status;
}

sr_status sr_image_crop(const struct sr_image *image, uint32_t x, uint32_t y, uint32_t width, uint32_t height,
                        struct sr_image **cropped, struct sr_error *error)
{
    *cropped = NULL;
    if (width == 0 || height == 0 || x >= image->width || y >= image->height || width > image->width - x ||
        height > image->height - y)
        return sr_fail(error, SR_ERROR_USAGE,
                       "a part of %u x %u pixels at (%u, %u) does not lie in an image of %u x %u", width, height, x, y,
                       image->width, image->height);
    struct sr_image *part;
    sr_status status = sr_image_create(width, height, image->channel_count, NULL,
                                       image->floats ? SR_IMAGE_FLOATS : SR_IMAGE_BYTES, &part, error);
    if (status != SR_OK)
        return status;
    status = copy_attributes(part, image, error);
    if (status != SR_OK) {
        sr_image_free(part);
        return status;
    }
    size_t n = (size_t)width * image->channel_count;
    for (uint32_t row = 0; row < height; row++) {
        if (image->floats)
            memcpy(part->floats + row * n, image->floats + sr_image_index(image, x, y + row), n * sizeof(float));
        else
            memcpy(part->bytes + row * n, image->bytes + sr_image_index(image, x, y + row), n);
    }
    part->x0 = image->x0 + (int32_t)x;
    part->y0 = image->y0 + (int32_t)y;
    part->full_width = image->full_width;
    part->full_height = image->full_height;
    *cropped = part;
    return SR_OK;
}

/* ---- channels and attributes ---- */

int sr_image_find_channel(const struct sr_image *image, const char *name)
{
    for (uint32_t c = 0; c < image->channel_count; c++)
        if (strcmp(image->channels[c].name, name) == 0)
            return (int)c;
    return -1;
}

bool sr_image_find_rgb(const struct sr_image *image, int rgb[3])
{
    static const char *const names[3] = {"R", "G", "B"};
    bool is_colour = true;
    for (int i = 0; i < 3; i++) {
        rgb[i] = sr_image_find_channel(image, names[i]);
        is_colour = is_colour && rgb[i] >= 0;
    }
    if (is_colour)
        return true;
    int grey = sr_image_find_channel(image, "Y");
    rgb[0] = rgb[1] = rgb[2] = grey >= 0 ? grey : 0;
    return false;
}

const char *sr_image_get_attribute(const struct sr_image *image, const char *name)
{
    for (uint32_t i = 0; i < image->attribute_count; i++)
        if (strcmp(image->attributes[i].name, name) == 0)
            return image->attributes[i].text;
    return NULL;
}

sr_status sr_image_set_attribute(struct sr_image *image, const char *name, const char *text, struct sr_error *error)
{
    const char *copy = sr_arena_string(&image->arena, text);
    for (uint32_t i = 0; copy && i < image->attribute_count; i++)
        if (strcmp(image->attributes[i].name, name) == 0) {
            image->attributes[i].text = copy;
            return SR_OK;
        }
    const char *key = copy ? sr_arena_string(&image->arena, name) : NULL;
    uint32_t n = image->attribute_count;
    // the list doubles when its length is a power of two
    if (key && (n == 0 || (n & (n - 1)) == 0)) {
        struct sr_image_attribute *grown = sr_arena_alloc(&image->arena, (n ? 2 * (size_t)n : 1) * sizeof *grown);
        if (grown && n)
            memcpy(grown, image->attributes, n * sizeof *grown);
        if (!grown)
            key = NULL;
        else
            image->attributes = grown;
    }
    if (!key)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the image attribute '%s'", name);
    image->attributes[image->attribute_count++] = (struct sr_image_attribute){key, copy};
    return SR_OK;
}

void sr_image_set_unit(struct sr_image *image, uint32_t channel, const char *unit)
{
    snprintf(image->channels[channel].unit, sizeof image->channels[channel].unit, "%s", unit);
}

/* ---- transfer curve ---- */

float sr_image_decode_srgb(float v)
{
    return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

float sr_image_encode_srgb(float v)
{
    return v <= 0.0031308f ? v * 12.92f : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
}

static bool is_alpha(const struct sr_image *image, uint32_t channel)
{
    return strcmp(image->channels[channel].name, "A") == 0;
}

float sr_image_value(const struct sr_image *image, size_t i, uint32_t channel)
{
    if (image->floats)
        return image->floats[i];
    float v = (float)image->bytes[i] / 255;
    return image->encoding == SR_IMAGE_SRGB && !is_alpha(image, channel) ? sr_image_decode_srgb(v) : v;
}

sr_status sr_image_to_float(struct sr_image *image, struct sr_error *error)
{
    if (image->floats)
        return SR_OK;
    size_t n = (size_t)image->width * image->height;
    float *floats =
        n * image->channel_count <= SIZE_MAX / 8 ? sr_alloc(n * image->channel_count * sizeof(float)) : NULL;
    if (!floats)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to turn an image of %u x %u pixels into floats",
                       image->width, image->height);
    for (uint32_t c = 0; c < image->channel_count; c++) {
        bool is_curved = image->encoding == SR_IMAGE_SRGB && !is_alpha(image, c);
        float table[256];
        for (int v = 0; v < 256; v++)
            table[v] = is_curved ? sr_image_decode_srgb((float)v / 255) : (float)v / 255;
        for (size_t i = 0; i < n; i++)
            floats[i * image->channel_count + c] = table[image->bytes[i * image->channel_count + c]];
    }
    sr_free(image->bytes);
    image->bytes = NULL;
    image->floats = floats;
    image->encoding = SR_IMAGE_LINEAR;
    return SR_OK;
}
