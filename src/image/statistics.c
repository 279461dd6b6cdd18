/* SPDX-License-Identifier: MIT */
/* What the values of one channel are like: mean, spread, percentiles, and how many are no proper numbers.
 *
 * A percentile p of n sorted values is interpolated linearly at p (n - 1). Sums are carried in double with pairwise
 * blocks of one row, so that 10^9 pixels lose no digit that a float has. */
#include "image/codec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double percentile(const float *sorted, size_t n, double p)
{
    double at = p * (double)(n - 1);
    size_t i = (size_t)at;
    return i + 1 < n ? (double)sorted[i] + (at - (double)i) * ((double)sorted[i + 1] - (double)sorted[i])
                     : (double)sorted[n - 1];
}

sr_status sr_image_statistics(const struct sr_image *image, uint32_t channel, struct sr_image_statistics *statistics,
                              struct sr_error *error)
{
    struct sr_image_statistics s = {0};
    s.mean = s.deviation = s.min = s.max = NAN;
    s.percentile_1 = s.percentile_5 = s.percentile_50 = s.percentile_95 = s.percentile_99 = NAN;
    *statistics = s;
    if (channel >= image->channel_count)
        return sr_fail(error, SR_ERROR_USAGE, "the image has %u channels, number %u was asked for",
                       image->channel_count, channel);
    size_t pixels = (size_t)image->width * image->height;
    float *values = sr_alloc(pixels * sizeof *values);
    if (!values)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the statistics of %zu pixels", pixels);
    for (uint32_t y = 0; y < image->height; y++) {
        double row = 0;
        for (uint32_t x = 0; x < image->width; x++) {
            float v = sr_image_value(image, sr_image_index(image, x, y) + channel, channel);
            s.nan_count += isnan(v);
            s.infinite_count += isinf(v) != 0;
            s.negative_count += v < 0;
            s.zero_count += v == 0;
            if (isfinite(v)) {
                values[s.count++] = v;
                row += (double)v;
            }
        }
        s.sum += row;
    }
    if (s.count) {
        s.mean = s.sum / (double)s.count;
        double m2 = 0;
        for (size_t i = 0; i < s.count; i++)
            m2 += ((double)values[i] - s.mean) * ((double)values[i] - s.mean);
        s.deviation = s.count > 1 ? sqrt(m2 / (double)(s.count - 1)) : 0;
        qsort(values, s.count, sizeof *values, compare_floats);
        s.min = (double)values[0];
        s.max = (double)values[s.count - 1];
        s.percentile_1 = percentile(values, s.count, 0.01);
        s.percentile_5 = percentile(values, s.count, 0.05);
        s.percentile_50 = percentile(values, s.count, 0.50);
        s.percentile_95 = percentile(values, s.count, 0.95);
        s.percentile_99 = percentile(values, s.count, 0.99);
    }
    sr_free(values);
    *statistics = s;
    return SR_OK;
}
