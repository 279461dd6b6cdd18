/* SPDX-License-Identifier: MIT */
/* Two images: how far apart, and whether by more than their noise.
 *
 *     d = a - b,   RMSE = sqrt(<d^2>) [unit],   relMSE = < d^2 / (b^2 + 0.01 <b>^2) > [1]
 *     z = d / sqrt(SE_a^2 + SE_b^2) [1],        z of the mean = sum d / sqrt(sum (SE_a^2 + SE_b^2))
 *
 * over the n pixels where both are finite. Where the two images estimate the same thing and tell their errors
 * rightly, z is standard normal; many samples a pixel make it so (central limit), fireflies do not. Limits: the z
 * of the mean takes the pixels as independent, which a wide reconstruction filter breaks. */
#include "image/codec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int find_error_channel(const struct sr_image *image, const char *name)
{
    char key[80];
    snprintf(key, sizeof key, "SE.%s", name);
    int c = sr_image_find_channel(image, key);
    if (c < 0) {
        snprintf(key, sizeof key, "stderr.%s", name);
        c = sr_image_find_channel(image, key);
    }
    return c;
}

static bool is_error_channel(const char *name)
{
    return strncmp(name, "SE.", 3) == 0 || strncmp(name, "stderr.", 7) == 0;
}

/* The square of a standard error [unit^2]; 0 where the picture tells none, not finite where it does not know it. */
static double variance_at(const struct sr_image *image, uint32_t x, uint32_t y, int channel)
{
    if (channel < 0)
        return 0;
    double e = (double)sr_image_value(image, sr_image_index(image, x, y) + (size_t)channel, (uint32_t)channel);
    return e * e;
}

struct sums {
    double a, b, d, d2, variance, d_with_variance, z2;
    uint64_t above[3]; // |z| > 2, 3, 4
};

static void add_pixel(struct sr_image_difference *r, struct sums *s, double a, double b, double variance, uint32_t x,
                      uint32_t y)
{
    double d = a - b;
    r->count++;
    s->a += a;
    s->b += b;
    s->d += d;
    s->d2 += d * d;
    if (fabs(d) > r->max_difference) {
        r->max_difference = fabs(d);
        r->max_x = x;
        r->max_y = y;
    }
    if (!(variance > 0 && isfinite(variance))) // of one sample nobody knows the error: that is no error of 0
        return;
    double z = d / sqrt(variance);
    r->z_count++;
    s->variance += variance;
    s->d_with_variance += d;
    s->z2 += z * z;
    for (int k = 0; k < 3; k++)
        s->above[k] += fabs(z) > 2 + k;
    r->max_z = fmax(r->max_z, fabs(z));
}

static double rel_mse(const struct sr_image *a, const struct sr_image *b, uint32_t ca, uint32_t cb, double mean_b,
                      uint64_t count)
{
    double sum = 0, epsilon = 0.01 * mean_b * mean_b;
    for (size_t p = 0; p < (size_t)a->width * a->height; p++) {
        double va = (double)sr_image_value(a, p * a->channel_count + ca, ca),
               vb = (double)sr_image_value(b, p * b->channel_count + cb, cb);
        double floor = vb * vb + epsilon;
        // two black images do not differ
        if (isfinite(va) && isfinite(vb) && va != vb)
            sum += (va - vb) * (va - vb) / floor;
    }
    return count ? sum / (double)count : 0;
}

static void compare_channel(const struct sr_image *a, const struct sr_image *b, uint32_t ca, uint32_t cb,
                            struct sr_image_difference *r)
{
    memcpy(r->name, a->channels[ca].name, sizeof r->name);
    memcpy(r->unit, a->channels[ca].unit, sizeof r->unit);
    int ea = find_error_channel(a, r->name), eb = find_error_channel(b, r->name);
    struct sums s = {0};
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x++) {
            double va = (double)sr_image_value(a, sr_image_index(a, x, y) + ca, ca);
            double vb = (double)sr_image_value(b, sr_image_index(b, x, y) + cb, cb);
            if (isfinite(va) && isfinite(vb))
                add_pixel(r, &s, va, vb, variance_at(a, x, y, ea) + variance_at(b, x, y, eb), x, y);
            else
                r->skipped_count++;
        }
    double n = (double)r->count;
    if (r->count) {
        r->mean_a = s.a / n;
        r->mean_b = s.b / n;
        r->mean_ratio = r->mean_a == r->mean_b ? 1 : r->mean_a / r->mean_b;
        r->bias = s.d / n;
        r->rmse = sqrt(s.d2 / n);
        r->rel_mse = rel_mse(a, b, ca, cb, r->mean_b, r->count);
    } else
        r->mean_a = r->mean_b = r->mean_ratio = r->bias = r->rmse = r->rel_mse = r->max_difference = NAN;
    r->has_z = r->z_count > 0;
    if (r->has_z) {
        double nz = (double)r->z_count;
        r->mean_z = s.d_with_variance / sqrt(s.variance);
        r->share_above_2 = (double)s.above[0] / nz;
        r->share_above_3 = (double)s.above[1] / nz;
        r->share_above_4 = (double)s.above[2] / nz;
        r->chi2_per_pixel = s.z2 / nz;
    }
}

static sr_status check_sizes(const struct sr_image *a, const struct sr_image *b, struct sr_error *error)
{
    if (a->width == b->width && a->height == b->height)
        return SR_OK;
    return sr_fail(error, SR_ERROR_INPUT,
                   "images of %u x %u and %u x %u pixels cannot be compared: the same size was expected", a->width,
                   a->height, b->width, b->height);
}

sr_status sr_image_compare(const struct sr_image *a, const struct sr_image *b, struct sr_image_comparison *comparison,
                           struct sr_error *error)
{
    *comparison = (struct sr_image_comparison){0};
    sr_status status = check_sizes(a, b, error);
    if (status != SR_OK)
        return status;
    comparison->channels = sr_alloc(a->channel_count * sizeof *comparison->channels);
    if (!comparison->channels)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to compare two images");
    double sum_mse = 0;
    for (uint32_t c = 0; c < a->channel_count; c++) {
        int other = sr_image_find_channel(b, a->channels[c].name);
        if (other < 0 || is_error_channel(a->channels[c].name))
            continue;
        struct sr_image_difference *r = &comparison->channels[comparison->channel_count++];
        compare_channel(a, b, c, (uint32_t)other, r);
        sum_mse += r->rmse * r->rmse;
        comparison->rel_mse += r->rel_mse;
        comparison->max_abs_mean_z = fmax(comparison->max_abs_mean_z, fabs(r->mean_z));
    }
    if (comparison->channel_count == 0) {
        sr_image_comparison_free(comparison);
        return sr_fail(error, SR_ERROR_INPUT,
                       "the images have no channel of the same name: '%s' is the first of one, '%s' of the other",
                       a->channels[0].name, b->channels[0].name);
    }
    comparison->rmse = sqrt(sum_mse / comparison->channel_count);
    comparison->rel_mse /= comparison->channel_count;
    return SR_OK;
}

void sr_image_comparison_free(struct sr_image_comparison *comparison)
{
    sr_free(comparison->channels);
    *comparison = (struct sr_image_comparison){0};
}

/* ---- a picture of the difference ---- */

static float luminance_at(const struct sr_image *image, const int rgb[3], size_t pixel)
{
    static const float weights[3] = {0.2126f, 0.7152f, 0.0722f};
    float Y = 0;
    if (rgb[0] == rgb[1])
        return sr_image_value(image, pixel * image->channel_count + (size_t)rgb[0], (uint32_t)rgb[0]);
    for (int c = 0; c < 3; c++)
        Y += weights[c] * sr_image_value(image, pixel * image->channel_count + (size_t)rgb[c], (uint32_t)rgb[c]);
    return Y;
}

static int compare_magnitudes(const void *a, const void *b)
{
    float x = fabsf(*(const float *)a), y = fabsf(*(const float *)b);
    return (x > y) - (x < y);
}

static sr_status pick_scale(const float *d, size_t pixels, double *scale, struct sr_error *error)
{
    float *sorted = sr_alloc(pixels * sizeof *sorted);
    if (!sorted)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to compare two images");
    size_t n = 0;
    for (size_t p = 0; p < pixels; p++)
        if (isfinite(d[p]))
            sorted[n++] = d[p];
    qsort(sorted, n, sizeof *sorted, compare_magnitudes);
    *scale = n ? fabs((double)sorted[(size_t)(0.99 * (double)(n - 1))]) : 0;
    // a few pixels that differ in an image that does not
    if (*scale == 0 && n)
        *scale = fabs((double)sorted[n - 1]);
    if (*scale == 0)
        *scale = 1;
    sr_free(sorted);
    return SR_OK;
}

static void paint(float d, double scale, uint8_t rgb[3])
{
    double t = fmin(fabs((double)d) / scale, 1);
    float rest = (float)(1 - t);
    uint8_t faded = (uint8_t)(255 * sr_image_encode_srgb(rest) + 0.5f);
    rgb[0] = d >= 0 ? 255 : faded;
    rgb[1] = faded;
    rgb[2] = d <= 0 ? 255 : faded;
    if (!isfinite(d))
        memcpy(rgb, (uint8_t[3]){0, 255, 0}, 3);
}

sr_status sr_image_difference_picture(const struct sr_image *a, const struct sr_image *b, double scale,
                                      struct sr_image **picture, double *used_scale, struct sr_error *error)
{
    *picture = NULL;
    sr_status status = check_sizes(a, b, error);
    if (status != SR_OK)
        return status;
    size_t pixels = (size_t)a->width * a->height;
    float *d = sr_alloc(pixels * sizeof *d);
    if (!d)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to compare two images");
    int rgb_a[3], rgb_b[3];
    sr_image_find_rgb(a, rgb_a);
    sr_image_find_rgb(b, rgb_b);
    for (size_t p = 0; p < pixels; p++)
        d[p] = luminance_at(a, rgb_a, p) - luminance_at(b, rgb_b, p);
    if (!(scale > 0))
        status = pick_scale(d, pixels, &scale, error);
    if (status == SR_OK)
        status = sr_image_create(a->width, a->height, 3, NULL, SR_IMAGE_BYTES, picture, error);
    for (size_t p = 0; status == SR_OK && p < pixels; p++)
        paint(d[p], scale, (*picture)->bytes + 3 * p);
    if (used_scale)
        *used_scale = scale;
    sr_free(d);
    return status;
}
