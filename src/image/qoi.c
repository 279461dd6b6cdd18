/* SPDX-License-Identifier: MIT */
/* QOI, read: bytes of RGB or RGBA, as differences to the pixel before and look-backs to the last 64 colours.
 *
 * "The Quite OK Image Format, Specification 1.0" (D. Szablewski, 2022). Limits: not written; the end marker is not
 * asked for. */
#include "image/codec.h"

#include <string.h>

static bool is_mine(const uint8_t *data, size_t size)
{
    return size >= 4 && memcmp(data, "qoif", 4) == 0;
}

static uint32_t big_endian(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

struct pixel {
    uint8_t r, g, b, a;
};

static struct pixel moved(struct pixel p, int dr, int dg, int db)
{
    return (struct pixel){(uint8_t)(p.r + dr), (uint8_t)(p.g + dg), (uint8_t)(p.b + db), p.a};
}

/* How many bytes the chunk has that begins with this one. */
static size_t chunk_size(uint8_t tag)
{
    return tag == 0xff ? 5 : tag == 0xfe ? 4 : tag >> 6 == 2 ? 2 : 1;
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    const uint8_t *at = source->data, *end = source->data + source->size;
    if (source->size < 14)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is cut short after %zu bytes: a QOI header of 14 was expected",
                       source->label, source->size);
    uint32_t width = big_endian(at + 4), height = big_endian(at + 8), channels = at[12];
    if (channels != 3 && channels != 4)
        return sr_fail(error, SR_ERROR_INPUT, "%s: has %u channels, a QOI image has 3 or 4", source->label,
                       (unsigned)channels);
    sr_status status = sr_image_create_for(source, width, height, channels, NULL, SR_IMAGE_BYTES, image, error);
    if (status != SR_OK)
        return status;
    (*image)->encoding = source->encoding;
    struct pixel seen[64] = {0}, p = {0, 0, 0, 255};
    uint8_t *out = NULL;
    size_t pixels = (size_t)width * height;
    int run = 0;
    at += 14;
    for (size_t i = 0; i < pixels; ++i, out += channels) {
        if (i % width == 0)
            out = sr_image_row(source, *image, (uint32_t)(i / width));
        if (run > 0) {
            --run;
        } else {
            if (at >= end || (size_t)(end - at) < chunk_size(*at)) {
                sr_image_free(*image);
                *image = NULL;
                return sr_fail(error, SR_ERROR_INPUT, "%s: is cut short after %zu of %zu pixels", source->label, i,
                               pixels);
            }
            uint8_t tag = *at, low = tag & 63;
            if (tag >= 0xfe)
                p = (struct pixel){at[1], at[2], at[3], tag == 0xff ? at[4] : p.a};
            else if (tag >> 6 == 0)
                p = seen[low];
            else if (tag >> 6 == 1)
                p = moved(p, (low >> 4) - 2, (low >> 2 & 3) - 2, (low & 3) - 2);
            else if (tag >> 6 == 2)
                p = moved(p, low - 32 + (at[1] >> 4) - 8, low - 32, low - 32 + (at[1] & 15) - 8);
            else
                run = low; // and this one
            at += chunk_size(tag);
            seen[(p.r * 3 + p.g * 5 + p.b * 7 + p.a * 11) % 64] = p;
        }
        memcpy(out, &p, channels);
    }
    return SR_OK;
}

const struct sr_image_codec sr_image_codec_qoi = {"QOI", {".qoi"}, is_mine, decode, NULL};
