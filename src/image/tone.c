/* SPDX-License-Identifier: MIT */
/* From linear values to bytes that a display shows.
 *
 *     v = 2^EV L                                                         [1]
 *     Reinhard   Y' = Y (1 + Y / 16) / (1 + Y),   rgb' = rgb Y' / Y      white at Y = 4
 *     filmic     h(v) / h(11.2),  h(v) = (v (A v + C B) + D E) / (v (A v + B) + D F) - E / F
 *
 * Reinhard et al., Photographic Tone Reproduction for Digital Images, 2002, eqs. 1 and 4; J. Hable, Uncharted 2:
 * HDR Lighting, GDC 2010 (A = 0.15, B = 0.50, C = 0.10, D = 0.20, E = 0.02, F = 0.30). Limits: global operators; no
 * dither. */
#include "image/codec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Linear sRGB from the image's three colour channels: a matrix, and where they stand. */
struct colour {
    int channel[3];
    float m[3][3];
};

static void multiply(double a[3][3], double b[3][3], double out[3][3])
{
    double r[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    memcpy(out, r, sizeof r);
}

static bool invert(double a[3][3], double out[3][3])
{
    double r[3][3], det = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int p = (j + 1) % 3, q = (j + 2) % 3, s = (i + 1) % 3, t = (i + 2) % 3;
            r[i][j] = a[p][s] * a[q][t] - a[p][t] * a[q][s];
        }
    for (int j = 0; j < 3; j++)
        det += a[0][j] * r[j][0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[i][j] = r[i][j] / det;
    return isfinite(1 / det);
}

/* XYZ of the three primaries, scaled so that (1, 1, 1) is the white with Y = 1. */
static bool xyz_from_rgb(const double k[4][2], double m[3][3], double white[3])
{
    double inverse[3][3];
    for (int c = 0; c < 4; c++) {
        double xyz[3] = {k[c][0] / k[c][1], 1, (1 - k[c][0] - k[c][1]) / k[c][1]};
        for (int i = 0; i < 3; i++)
            *(c < 3 ? &m[i][c] : &white[i]) = xyz[i];
    }
    bool ok = invert(m, inverse);
    for (int c = 0; c < 3; c++) {
        double scale = inverse[c][0] * white[0] + inverse[c][1] * white[1] + inverse[c][2] * white[2];
        for (int i = 0; i < 3; i++)
            m[i][c] *= scale;
        ok = ok && isfinite(scale);
    }
    return ok;
}

static const double srgb_primaries[4][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};

/* The Bradford transform from one white to another: a scaling of sharpened cone responses. */
static bool adapt(const double from[3], const double to[3], double m[3][3])
{
    double cones[3][3] = {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}, back[3][3],
           scaled[3][3];
    bool ok = invert(cones, back);
    for (int i = 0; i < 3; i++) {
        double a = 0, b = 0;
        for (int j = 0; j < 3; j++) {
            a += cones[i][j] * from[j];
            b += cones[i][j] * to[j];
        }
        ok = ok && isfinite(b / a);
        for (int j = 0; j < 3; j++)
            scaled[i][j] = cones[i][j] * (b / a);
    }
    multiply(back, scaled, m);
    return ok;
}

static struct colour find_colour(const struct sr_image *image)
{
    struct colour colour = {.m = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    double srgb[3][3], d65[3], to_srgb[3][3], matrix[3][3];
    bool is_rgb = sr_image_find_rgb(image, colour.channel), has_matrix = false;
    xyz_from_rgb(srgb_primaries, srgb, d65);
    invert(srgb, to_srgb);
    int x = sr_image_find_channel(image, "X"), y = sr_image_find_channel(image, "Y"),
        z = sr_image_find_channel(image, "Z");
    if (!is_rgb && x >= 0 && y >= 0 && z >= 0) {
        memcpy(colour.channel, (int[3]){x, y, z}, sizeof colour.channel);
        memcpy(matrix, to_srgb, sizeof matrix);
        has_matrix = true;
    } else if (is_rgb && image->has_chromaticities) {
        double white[3], to_xyz[3][3], adaptation[3][3];
        has_matrix = xyz_from_rgb(image->chromaticities, to_xyz, white) && adapt(white, d65, adaptation);
        if (has_matrix) {
            multiply(adaptation, to_xyz, matrix);
            multiply(to_srgb, matrix, matrix);
        }
    }
    for (int i = 0; has_matrix && i < 3; i++)
        for (int j = 0; j < 3; j++)
            colour.m[i][j] = fabs(matrix[i][j] - (i == j)) < 1e-5 ? (float)(i == j) : (float)matrix[i][j];
    return colour;
}

bool sr_image_luminance_weights(const struct sr_image *image, int channel[3], double weight[3])
{
    double m[3][3], white[3];
    bool is_rgb = sr_image_find_rgb(image, channel);
    memcpy(weight, (double[3]){1, 0, 0}, 3 * sizeof *weight);
    int y = sr_image_find_channel(image, "Y");
    if (is_rgb && channel[0] != channel[1])
        return (xyz_from_rgb(image->has_chromaticities ? image->chromaticities : srgb_primaries, m, white) ||
                xyz_from_rgb(srgb_primaries, m, white)) &&
               memcpy(weight, m[1], 3 * sizeof *weight);
    if (y < 0 && !is_rgb && image->channel_count > 1)
        return false;
    channel[0] = channel[1] = channel[2] = y >= 0 ? y : 0;
    return true;
}

static void get_colour(const struct sr_image *image, const struct colour *colour, size_t pixel, float rgb[3])
{
    float v[3];
    for (int c = 0; c < 3; c++)
        v[c] = sr_image_value(image, pixel * image->channel_count + (size_t)colour->channel[c],
                              (uint32_t)colour->channel[c]);
    bool is_grey = colour->channel[0] == colour->channel[1];
    for (int i = 0; i < 3; i++) {
        rgb[i] = is_grey ? v[0] : colour->m[i][0] * v[0] + colour->m[i][1] * v[1] + colour->m[i][2] * v[2];
        // zero times infinity must not spoil the other channels of an identity
        if (!is_grey && colour->m[i][i] == 1 && colour->m[i][(i + 1) % 3] == 0 && colour->m[i][(i + 2) % 3] == 0)
            rgb[i] = v[i];
    }
}

static float luminance(const float rgb[3])
{
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

float sr_image_auto_exposure(const struct sr_image *image)
{
    struct colour colour = find_colour(image);
    size_t pixels = (size_t)image->width * image->height, n = 0;
    // a million pixels tell the log-average to well below 0.01 EV
    size_t step = pixels / 1000000 + 1;
    float *Y = sr_alloc((pixels / step + 1) * sizeof(float));
    double log_sum = 0;
    for (size_t p = 0; Y && p < pixels; p += step) {
        float rgb[3];
        get_colour(image, &colour, p, rgb);
        float value = luminance(rgb);
        if (!(value > 0) || !isfinite(value))
            continue;
        log_sum += log2(value);
        Y[n++] = value;
    }
    double exposure_EV = 0;
    if (n) {
        qsort(Y, n, sizeof *Y, compare_floats);
        double guard = log2(4.0 / (double)Y[(size_t)(0.99 * (double)(n - 1))]);
        exposure_EV = fmin(log2(0.18) - log_sum / (double)n, guard);
    }
    sr_free(Y);
    return (float)exposure_EV;
}

static float hable(float v)
{
    const float A = 0.15f, B = 0.50f, C = 0.10f, D = 0.20f, E = 0.02f, F = 0.30f;
    return (v * (A * v + C * B) + D * E) / (v * (A * v + B) + D * F) - E / F;
}

static void apply(enum sr_tone_operator op, float rgb[3])
{
    const float highest = 1e12f; // infinities become finite here, far above every white
    for (int c = 0; c < 3; c++)
        rgb[c] = rgb[c] > 0 ? fminf(rgb[c], highest) : 0; // also NaN becomes 0
    float Y = luminance(rgb);
    float scale = op == SR_TONE_REINHARD && Y > 0 ? (1 + Y / 16) / (1 + Y) : 1;
    for (int c = 0; c < 3; c++) {
        if (op == SR_TONE_FILMIC)
            rgb[c] = hable(rgb[c]) / hable(11.2f);
        rgb[c] = fminf(fmaxf(rgb[c] * scale, 0), 1);
    }
}

sr_status sr_image_tone_map(const struct sr_image *image, const struct sr_tone *tone, struct sr_image **mapped,
                            struct sr_error *error)
{
    static const struct sr_tone plain = {0};
    tone = tone ? tone : &plain;
    sr_status status = sr_image_create(image->width, image->height, 3, NULL, SR_IMAGE_BYTES, mapped, error);
    if (status != SR_OK)
        return status;
    struct colour colour = find_colour(image);
    float gain = exp2f(tone->exposure_EV + (tone->is_auto ? sr_image_auto_exposure(image) : 0));
    for (size_t p = 0; p < (size_t)image->width * image->height; p++) {
        float rgb[3];
        get_colour(image, &colour, p, rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] *= gain;
        apply(tone->op, rgb);
        for (int c = 0; c < 3; c++)
            (*mapped)->bytes[3 * p + (size_t)c] = (uint8_t)(255 * sr_image_encode_srgb(rgb[c]) + 0.5f);
    }
    (*mapped)->x0 = image->x0;
    (*mapped)->y0 = image->y0;
    (*mapped)->full_width = image->full_width;
    (*mapped)->full_height = image->full_height;
    return SR_OK;
}
