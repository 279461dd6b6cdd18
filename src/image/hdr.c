/* SPDX-License-Identifier: MIT */
/* Radiance pictures (.hdr, .pic): three mantissas that share one exponent.
 *
 *     value = (m + 1/2) 2^(e - 136) / EXPOSURE          [W/(sr m^2) by the format's custom]
 *
 * G. Ward, Real Pixels, Graphics Gems II, 1991. Writers cut the mantissa off, so the half makes the mean right;
 * e = 0 is black. XYZE is converted to sRGB's primaries. Both run-length schemes are read, the newer is written.
 * Limits: one part in 128 of the largest component; negative and NaN become 0 when written; only the row-major
 * orders (-Y +X, +Y +X, …) are read. */
#include "image/codec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_mine(const uint8_t *data, size_t size)
{
    return size >= 2 && data[0] == '#' && data[1] == '?';
}

struct cursor {
    const uint8_t *data;
    size_t at, size;
};

static bool take_line(struct cursor *c, char *line, size_t capacity)
{
    size_t n = 0;
    while (c->at < c->size && c->data[c->at] != '\n') {
        if (n + 1 < capacity)
            line[n++] = (char)c->data[c->at];
        c->at++;
    }
    if (n && line[n - 1] == '\r')
        n--;
    line[n] = 0;
    return c->at++ < c->size;
}

/* The older scheme: pixels, where (1, 1, 1, n) repeats the one before; several in a row make a number in base 256. */
static bool take_old_row(struct cursor *c, uint8_t *rgbe, uint32_t width)
{
    unsigned shift = 0;
    for (uint32_t x = 0; x < width;) {
        if (c->size - c->at < 4)
            return false;
        const uint8_t *p = c->data + c->at;
        c->at += 4;
        if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
            uint64_t count = shift < 32 ? (uint64_t)p[3] << shift : UINT32_MAX;
            if (x == 0 || count > width - x)
                return false;
            for (; count; count--, x++)
                memcpy(rgbe + 4 * x, rgbe + 4 * (x - 1), 4);
            shift += 8;
        } else {
            memcpy(rgbe + 4 * x++, p, 4);
            shift = 0;
        }
    }
    return true;
}

static bool take_row(struct cursor *c, uint8_t *rgbe, uint32_t width)
{
    if (c->at > c->size || c->size - c->at < 4)
        return false;
    const uint8_t *p = c->data + c->at;
    if (width < 8 || width > 32767 || p[0] != 2 || p[1] != 2 || (uint32_t)(p[2] << 8 | p[3]) != width)
        return take_old_row(c, rgbe, width);
    c->at += 4;
    for (uint32_t component = 0; component < 4; component++)
        for (uint32_t x = 0; x < width;) {
            if (c->size - c->at < 2)
                return false;
            uint32_t code = c->data[c->at++];
            uint32_t count = code > 128 ? code - 128 : code;
            if (count == 0 || count > width - x || (code <= 128 && c->size - c->at < count))
                return false;
            for (uint32_t i = 0; i < count; i++)
                rgbe[4 * x++ + component] = c->data[code > 128 ? c->at : c->at + i];
            c->at += code > 128 ? 1 : count;
        }
    return true;
}

struct header {
    uint64_t width, height;
    bool is_xyz, is_bottom_up, is_right_to_left, has_primaries;
    double exposure, primaries[4][2];
};

static const char *read_header(struct cursor *c, struct header *h)
{
    char line[512];
    h->exposure = 1;
    while (take_line(c, line, sizeof line) && line[0]) {
        double v[8];
        if (strncmp(line, "FORMAT=", 7) == 0) {
            h->is_xyz = strcmp(line + 7, "32-bit_rle_xyze") == 0;
            if (!h->is_xyz && strcmp(line + 7, "32-bit_rle_rgbe") != 0)
                return "has a FORMAT other than 32-bit_rle_rgbe and 32-bit_rle_xyze";
        } else if (strncmp(line, "EXPOSURE=", 9) == 0) {
            double exposure = strtod(line + 9, NULL); // several multiply
            if (isfinite(exposure) && exposure > 0)
                h->exposure *= exposure;
        } else if (sscanf(line, "PRIMARIES=%lf %lf %lf %lf %lf %lf %lf %lf", v, v + 1, v + 2, v + 3, v + 4, v + 5,
                          v + 6, v + 7) == 8) {
            memcpy(h->primaries, v, sizeof h->primaries);
            h->has_primaries = true;
        }
    }
    char y, x, sign_y, sign_x;
    unsigned long width, height;
    if (!take_line(c, line, sizeof line) || strlen(line) > 60 ||
        sscanf(line, "%c%c %10lu %c%c %10lu", &sign_y, &y, &height, &sign_x, &x, &width) != 6 || y != 'Y' || x != 'X' ||
        !strchr("+-", sign_y) || !strchr("+-", sign_x))
        return "has a damaged header: a line such as '-Y 480 +X 640' was expected after an empty line";
    h->width = width;
    h->height = height;
    h->is_bottom_up = sign_y == '+';
    h->is_right_to_left = sign_x == '-';
    return NULL;
}

static void put_pixel(const struct header *h, const uint8_t *rgbe, float *to)
{
    double scale = rgbe[3] ? ldexp(1 / h->exposure, rgbe[3] - 136) : 0;
    double v[3];
    for (int c = 0; c < 3; c++)
        v[c] = (rgbe[c] + 0.5) * scale;
    if (h->is_xyz) { // IEC 61966-2-1, XYZ to linear sRGB
        double X = v[0], Y = v[1], Z = v[2];
        v[0] = 3.2406 * X - 1.5372 * Y - 0.4986 * Z;
        v[1] = -0.9689 * X + 1.8758 * Y + 0.0415 * Z;
        v[2] = 0.0557 * X - 0.2040 * Y + 1.0570 * Z;
    }
    for (int c = 0; c < 3; c++)
        to[c] = (float)v[c];
}

static sr_status decode(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error)
{
    struct cursor c = {source->data, 0, source->size};
    struct header h = {0};
    const char *wrong = read_header(&c, &h);
    if (wrong)
        return sr_fail(error, SR_ERROR_INPUT, "%s: %s", source->label, wrong);
    sr_status status = sr_image_create_for(source, h.width, h.height, 3, NULL, SR_IMAGE_FLOATS, image, error);
    if (status != SR_OK)
        return status;
    uint32_t width = (uint32_t)h.width, height = (uint32_t)h.height;
    uint8_t *rgbe = sr_alloc((size_t)width * 4);
    bool ok = rgbe;
    uint32_t y = 0;
    for (; ok && y < height; y++) {
        ok = take_row(&c, rgbe, width);
        float *row = sr_image_row(source, *image, h.is_bottom_up ? height - 1 - y : y);
        for (uint32_t x = 0; ok && x < width; x++)
            put_pixel(&h, rgbe + 4 * (size_t)x, row + 3 * (size_t)(h.is_right_to_left ? width - 1 - x : x));
    }
    status = ok     ? SR_OK
             : rgbe ? sr_fail(error, SR_ERROR_INPUT,
                              "%s: is damaged or cut short in row %u: %u rows of %u pixels were expected",
                              source->label, y - 1, height, width)
                    : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", source->label);
    sr_free(rgbe);
    if (status == SR_OK && h.has_primaries && !h.is_xyz) {
        (*image)->has_chromaticities = true;
        memcpy((*image)->chromaticities, h.primaries, sizeof h.primaries);
    }
    if (status != SR_OK) {
        sr_image_free(*image);
        *image = NULL;
    }
    return status;
}

static void pack(const float rgb[3], uint8_t rgbe[4])
{
    float v[3], largest = 0;
    for (int c = 0; c < 3; c++) {
        v[c] = rgb[c] > 0 ? fminf(rgb[c], 0x1.fep126f) : 0; // also NaN becomes 0
        largest = fmaxf(largest, v[c]);
    }
    memset(rgbe, 0, 4);
    if (largest < 0x1p-127f)
        return;
    int exponent;
    frexpf(largest, &exponent);
    for (int c = 0; c < 3; c++)
        rgbe[c] = (uint8_t)ldexpf(v[c], 8 - exponent);
    rgbe[3] = (uint8_t)(exponent + 128);
}

/* The bytes of one component of a row: runs of 4 and more, and what lies between. */
static bool put_runs(struct sr_array *out, const uint8_t *rgbe, uint32_t width)
{
    for (uint32_t x = 0; x < width;) {
        uint32_t start = x, run = 0;
        while (start < width) {
            for (run = 1; run < 127 && start + run < width && rgbe[4 * (start + run)] == rgbe[4 * start];)
                run++;
            if (run >= 4)
                break;
            start += run;
        }
        for (; x < start;) {
            uint32_t count = start - x < 128 ? start - x : 128;
            uint8_t plain[129] = {(uint8_t)count};
            for (uint32_t i = 0; i < count; i++)
                plain[1 + i] = rgbe[4 * x++];
            if (!sr_image_put(out, plain, count + 1))
                return false;
        }
        if (start < width) {
            if (!sr_image_put(out, (uint8_t[2]){(uint8_t)(128 + run), rgbe[4 * start]}, 2))
                return false;
            x = start + run;
        }
    }
    return true;
}

static bool put_header(const struct sr_image *image, struct sr_array *out)
{
    char text[512];
    int n = snprintf(text, sizeof text, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n");
    if (image->has_chromaticities) {
        const double(*k)[2] = image->chromaticities;
        n += snprintf(text + n, sizeof text - (size_t)n, "PRIMARIES=%.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f\n", k[0][0],
                      k[0][1], k[1][0], k[1][1], k[2][0], k[2][1], k[3][0], k[3][1]);
    }
    n += snprintf(text + n, sizeof text - (size_t)n, "\n-Y %u +X %u\n", image->height, image->width);
    return sr_image_put(out, text, (size_t)n);
}

static sr_status encode(const struct sr_image *image, const struct sr_image_write_options *options,
                        struct sr_array *out, struct sr_error *error)
{
    (void)options;
    int rgb[3];
    sr_image_find_rgb(image, rgb);
    uint32_t width = image->width;
    bool is_packed = width >= 8 && width <= 32767;
    uint8_t *row = sr_alloc((size_t)width * 4);
    bool ok = row && put_header(image, out);
    for (uint32_t y = 0; ok && y < image->height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            float v[3];
            for (int c = 0; c < 3; c++)
                v[c] = sr_image_value(image, sr_image_index(image, x, y) + (size_t)rgb[c], (uint32_t)rgb[c]);
            pack(v, row + 4 * (size_t)x);
        }
        if (is_packed) {
            ok = sr_image_put(out, (uint8_t[4]){2, 2, (uint8_t)(width >> 8), (uint8_t)width}, 4);
            for (int c = 0; c < 4 && ok; c++)
                ok = put_runs(out, row + c, width);
        } else
            ok = sr_image_put(out, row, (size_t)width * 4);
    }
    sr_free(row);
    return ok ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to write a Radiance file");
}

const struct sr_image_codec sr_image_codec_hdr = {"Radiance HDR", {".hdr", ".pic", ".rgbe"}, is_mine, decode, encode};
