/* SPDX-License-Identifier: MIT */
/* PFM, the portable float map: "PF" (colour) or "Pf" (grey), width, height, scale, then floats, the bottom row first.
 *
 *     value = |scale| * float                 little-endian where scale < 0
 *
 * P. Debevec's format as described by P. Bourke. Written little-endian with scale -1: the bits of every float are
 * kept, NaN and denormals too. Limits: channels beyond R, G, B (or one grey) are not written. */
#include "image/codec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_mine(const uint8_t *data, size_t size)
{
    return size >= 3 && data[0] == 'P' && (data[1] == 'F' || data[1] == 'f') && strchr(" \t\r\n", data[2]) && data[2];
}

/* The next word of the header, ended by one white space that belongs to it. */
static bool take_word(const struct sr_image_source *source, size_t *at, char word[32])
{
    size_t i = *at, n = 0;
    while (i < source->size && strchr(" \t\r\n", source->data[i]) && source->data[i])
        i++;
    while (i < source->size && n < 31 && source->data[i] > ' ')
        word[n++] = (char)source->data[i++];
    word[n] = 0;
    if (n == 0 || i >= source->size || source->data[i] > ' ')
        return false;
    // "\r\n" after the scale counts as one line end, unless the length says that \n is the first byte of a float
    *at = i + 1;
    return true;
}

static bool read_size(const char *word, uint64_t *value)
{
    char *end;
    long long v = strtoll(word, &end, 10);
    *value = v > 0 ? (uint64_t)v : 0;
    return *end == 0 && v > 0;
}

static float get_float(const uint8_t *p, bool is_little)
{
    uint32_t bits = is_little ? (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24
                              : (uint32_t)p[3] | (uint32_t)p[2] << 8 | (uint32_t)p[1] << 16 | (uint32_t)p[0] << 24;
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    uint32_t channels = source->data[1] == 'F' ? 3 : 1;
    size_t at = 2;
    char words[3][32], *end = words[2];
    uint64_t width = 0, height = 0;
    double scale = 0;
    bool ok = take_word(source, &at, words[0]) && take_word(source, &at, words[1]) &&
              take_word(source, &at, words[2]) && read_size(words[0], &width) && read_size(words[1], &height);
    if (ok)
        scale = strtod(words[2], &end);
    if (!ok || *end || !isfinite(scale) || scale == 0)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: the PFM header is damaged: width, height and a scale that is not 0 were expected",
                       source->label);
    if (height > (source->size - at) / 4 / channels / width)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: is cut short: %zu bytes of pixels, %llu x %llu pixels of %u bytes were expected",
                       source->label, source->size - at, (unsigned long long)width, (unsigned long long)height,
                       4 * channels);
    sr_status status = sr_image_create_for(source, width, height, channels, NULL, SR_IMAGE_FLOATS, image, error);
    if (status != SR_OK)
        return status;
    size_t row = (size_t)width * channels, needed = row * height * 4;
    if (source->size - at == needed + 1 && source->data[at - 1] == '\r' && source->data[at] == '\n')
        at++;
    float factor = (float)fabs(scale);
    for (size_t y = 0; y < height; y++) {
        const uint8_t *from = source->data + at + (height - 1 - y) * row * 4;
        float *to = (*image)->floats + y * row;
        for (size_t i = 0; i < row; i++)
            to[i] = get_float(from + 4 * i, scale < 0);
        for (size_t i = 0; factor != 1 && i < row; i++)
            to[i] *= factor;
    }
    return SR_OK;
}

static sr_status encode(const struct sr_image *image, const struct sr_image_write_options *options,
                        struct sr_array *out, struct sr_error *error)
{
    (void)options;
    int rgb[3];
    bool is_colour = sr_image_find_rgb(image, rgb);
    uint32_t channels = is_colour ? 3 : 1;
    char header[64];
    int n = snprintf(header, sizeof header, "%s\n%u %u\n-1.0\n", is_colour ? "PF" : "Pf", image->width, image->height);
    size_t row = (size_t)image->width * channels * 4;
    bool ok = sr_array_reserve(out, (size_t)n + row * image->height, 1) && sr_image_put(out, header, (size_t)n);
    if (!ok)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to write a PFM file");
    uint8_t *to = (uint8_t *)out->data + out->count;
    for (uint32_t y = image->height; y-- > 0;)
        for (uint32_t x = 0; x < image->width; x++)
            for (uint32_t c = 0; c < channels; c++) {
                float value = sr_image_value(image, sr_image_index(image, x, y) + (size_t)rgb[c], (uint32_t)rgb[c]);
                uint32_t bits;
                memcpy(&bits, &value, 4);
                *to++ = (uint8_t)bits;
                *to++ = (uint8_t)(bits >> 8);
                *to++ = (uint8_t)(bits >> 16);
                *to++ = (uint8_t)(bits >> 24);
            }
    out->count += row * image->height;
    return SR_OK;
}

const struct sr_image_codec sr_image_codec_pfm = {"PFM", {".pfm"}, is_mine, decode, encode};
