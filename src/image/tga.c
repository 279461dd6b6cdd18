/* SPDX-License-Identifier: MIT */
/* Truevision TGA, read only: grey, palette and true colour, plain or in run-length packets, from any corner.
 *
 * Truevision TGA file format specification 2.0, 1991. The format has no magic bytes, so the ending decides and the
 * header is checked field by field. Limits: the alpha of 32 bits is kept where the descriptor tells alpha bits;
 * that of 16 bits not. */
#include "image/codec.h"

#include <string.h>

struct header {
    uint32_t type, depth, width, height, palette_first, palette_count, palette_depth, alpha_bits;
    bool is_packed, is_palette, is_grey, is_bottom_up, is_right_to_left;
    uint32_t channels;
};

static uint32_t get16(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8;
}

static bool read_header(const uint8_t *p, struct header *h)
{
    *h = (struct header){.type = p[2] & 7u,
                         .is_packed = p[2] & 8,
                         .palette_first = get16(p + 3),
                         .palette_count = get16(p + 5),
                         .palette_depth = p[7],
                         .width = get16(p + 12),
                         .height = get16(p + 14),
                         .depth = p[16],
                         .alpha_bits = p[17] & 15u,
                         .is_right_to_left = p[17] & 16,
                         .is_bottom_up = !(p[17] & 32)};
    h->is_palette = h->type == 1;
    h->is_grey = h->type == 3;
    uint32_t colour_depth = h->is_palette ? h->palette_depth : h->depth;
    bool known_colour = colour_depth == 15 || colour_depth == 16 || colour_depth == 24 || colour_depth == 32;
    bool ok = p[1] <= 1 && (p[2] & ~11) == 0 && h->type >= 1 && h->type <= 3 && (p[17] & 0xc0) == 0;
    ok = ok && (h->is_grey ? h->depth == 8 : known_colour) &&
         (!h->is_palette || (p[1] == 1 && (h->depth == 8 || h->depth == 16)));
    h->channels = h->is_grey ? 1 : colour_depth == 32 && h->alpha_bits ? 4 : 3;
    return ok;
}

static void put_colour(const uint8_t *p, uint32_t depth, uint32_t channels, uint8_t *to)
{
    if (depth <= 16) {
        uint32_t v = get16(p);
        for (int c = 0; c < 3; c++)
            to[c] = (uint8_t)(((v >> (10 - 5 * c) & 31) * 255 + 15) / 31);
    } else {
        to[0] = p[2];
        to[1] = p[1];
        to[2] = p[0];
    }
    if (channels == 4)
        to[3] = p[3];
}

/* One pixel as stored at p; an index outside of the palette is false. */
static bool put_pixel(const struct header *h, const uint8_t *palette, const uint8_t *p, uint8_t *to)
{
    if (h->is_grey) {
        *to = *p;
        return true;
    }
    if (!h->is_palette) {
        put_colour(p, h->depth, h->channels, to);
        return true;
    }
    uint32_t index = h->depth == 8 ? *p : get16(p);
    if (index < h->palette_first || index - h->palette_first >= h->palette_count)
        return false;
    put_colour(palette + (index - h->palette_first) * ((h->palette_depth + 7) / 8), h->palette_depth, h->channels, to);
    return true;
}

static const char *unpack(const struct sr_image_source *source, size_t at, const struct header *h,
                          const uint8_t *palette, struct sr_image *image)
{
    size_t bytes = (h->depth + 7) / 8, count = (size_t)h->width * h->height, run = 0;
    bool is_repeated = false;
    for (size_t i = 0; i < count; i++) {
        if (h->is_packed && run == 0) {
            if (at >= source->size)
                return "is cut short";
            is_repeated = source->data[at] & 128;
            run = (size_t)(source->data[at++] & 127) + 1;
        }
        if (source->size - at < bytes)
            return "is cut short";
        uint32_t x = (uint32_t)(i % h->width), y = (uint32_t)(i / h->width);
        x = h->is_right_to_left ? h->width - 1 - x : x;
        y = h->is_bottom_up ? h->height - 1 - y : y;
        if (!put_pixel(h, palette, source->data + at,
                       (uint8_t *)sr_image_row(source, image, y) + (size_t)x * h->channels))
            return "names a colour that is not in its palette";
        run -= h->is_packed;
        // a repeated pixel is passed when its run ends
        if (!h->is_packed || !is_repeated || run == 0)
            at += bytes;
    }
    return NULL;
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    struct header h;
    if (source->size < 18 || !read_header(source->data, &h))
        return sr_fail(
            error, SR_ERROR_INPUT,
            "%s: is no TGA file that can be read: type 1, 2, 3, 9, 10 or 11 with 8, 15, 16, 24 or 32 bits was expected",
            source->label);
    size_t at = 18 + (size_t)source->data[0];
    const uint8_t *palette = source->data + at;
    if (source->data[1] == 1)
        at += (size_t)h.palette_count * ((h.palette_depth + 7) / 8);
    if (at > source->size)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is cut short: a palette of %u colours was expected", source->label,
                       h.palette_count);
    sr_status status = SR_OK;
    const char *wrong = "is cut short";
    if (h.is_packed || (size_t)h.width * h.height * ((h.depth + 7) / 8) <= source->size - at) {
        status = sr_image_create_for(source, h.width, h.height, h.channels, NULL, SR_IMAGE_BYTES, image, error);
        wrong = status == SR_OK ? unpack(source, at, &h, palette, *image) : NULL;
    }
    if (!wrong)
        return status;
    sr_image_free(*image);
    *image = NULL;
    return sr_fail(error, SR_ERROR_INPUT, "%s: %s: the pixels of a TGA image of %u x %u were expected", source->label,
                   wrong, h.width, h.height);
}

const struct sr_image_codec sr_image_codec_tga = {"TGA", {".tga"}, NULL, decode, NULL};
