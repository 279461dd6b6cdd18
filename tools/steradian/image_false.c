/* SPDX-License-Identifier: MIT */
/* False colour: values as a path of even lightness steps, the scale beside them with its unit.
 *
 *     Y = y_r R + y_g G + y_b B       [cd/m^2 or whatever unit the channels bear], by the primaries of the picture
 *
 * Without --scale from 0 (logarithmic: a ten-thousandth of the top) to the 99.9th percentile, so that a few pixels of a
 * lamp do not leave the room dark; what is beyond either end has the colour of that end. */
#include "image_false.h"

#include "plot/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* rounded up to 1, 2 or 5 times a power of ten */
static double round_up(double v)
{
    double power = pow(10, floor(log10(v))), m = v / power;
    return power * (m <= 1 ? 1 : m <= 2 ? 2 : m <= 5 ? 5 : 10);
}

static sr_status choose_scale(const struct false_colour *how, const double *values, size_t n, double scale[2],
                              struct sr_error *error)
{
    double *sorted = sr_alloc((n + 1) * sizeof *sorted);
    size_t count = 0;
    if (!sorted)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to sort a picture's values");
    for (size_t i = 0; i < n; ++i)
        if (isfinite(values[i]) && values[i] > 0)
            sorted[count++] = values[i];
    qsort(sorted, count, sizeof *sorted, compare);
    double top = count ? sorted[(size_t)(0.999 * (double)(count - 1))] : 0;
    sr_free(sorted);
    if (!(top > 0))
        return sr_fail(error, SR_ERROR_INPUT,
                       "the picture has no value above 0 to show; --scale LO,HI chooses a scale");
    scale[1] = round_up(top);
    scale[0] = how->is_log ? scale[1] / 1e4 : 0;
    return SR_OK;
}

sr_status image_write_false_colour(const char *path, const struct sr_image *image, const struct false_colour *how,
                                   struct sr_error *error)
{
    int channel[3] = {0, 0, 0};
    double weight[3] = {1, 0, 0}, scale[2] = {how->scale[0], how->scale[1]};
    if (image->channel_count > 1 && !sr_image_luminance_weights(image, channel, weight))
        return sr_fail(error, SR_ERROR_INPUT, "the picture has no luminance; --channel NAME chooses what is shown");
    size_t n = (size_t)image->width * image->height;
    double *values = sr_alloc(n * sizeof *values);
    if (!values)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a figure of %u x %u pixels", image->width,
                       image->height);
    for (uint32_t y = 0; y < image->height; ++y)
        for (uint32_t x = 0; x < image->width; ++x) { // maps begin below
            const float *at = image->floats + sr_image_index(image, x, image->height - 1 - y);
            double v = 0;
            for (int c = 0; c < 3; ++c)
                v += weight[c] != 0 ? weight[c] * (double)at[channel[c]] : 0;
            values[(size_t)y * image->width + x] = how->is_log && !(v > 0) ? how->has_scale ? scale[0] : 0 : v;
        }
    if (how->has_scale || choose_scale(how, values, n, scale, error) == SR_OK) {
        for (size_t i = 0; i < n && how->is_log; ++i)
            values[i] = values[i] < scale[0] ? scale[0] : values[i];
        const char *unit = image->channels[channel[0]].unit;
        const char *label = strcmp(unit, "cd/m^2") == 0 ? "L_{v}"
                            : strcmp(unit, "lx") == 0   ? "E_{v}"
                            : weight[1] == 0            ? image->channels[channel[0]].name
                                                        : "Y";
        const char *shown = strcmp(unit, "cd/m^2") == 0 ? "cd/m^{2}" : unit[0] ? unit : "no unit";
        struct sr_plot_panel panel = {
            .kind = SR_PLOT_MAP,
            .values = values,
            .rows = image->height,
            .columns = image->width,
            .has_no_frame = true,
            .has_contours = how->has_contours,
            .z = {.label = label, .unit = shown, .is_log = how->is_log, .from = scale[0], .to = scale[1]}};
        // each pixel one of the figure, small pictures enlarged by whole numbers, and room for the legend
        double times = fmax(1, floor(400 / fmax(image->width, image->height)));
        double fit = fmin(1, 4000 / (times * fmax(image->width, image->height)));
        struct sr_plot_figure figure = {.title = how->title,
                                        .width = 24 + 110 + fit * times * image->width,
                                        .height = 16 + 14 + (how->title ? 26 : 0) + fit * times * image->height,
                                        .panels = &panel,
                                        .panel_count = 1,
                                        .scale = 1};
        figure.height = fmax(figure.height, 200);
        sr_plot_write(&figure, path, error);
    }
    sr_free(values);
    return error->status;
}
