/* SPDX-License-Identifier: MIT */
/* steradian image --region --statistics: a region as a measurement.
 *
 *     several pictures, independent replicates:
 *         L = mean of the pictures' means, u from their spread, nu = pictures - 1
 *     one picture:
 *         u^2 = SUM u_pixel^2 / n^2,  nu = (SUM u_pixel^2)^2 / SUM u_pixel^4 / nu_pixel
 *
 * Limits: the second form takes pixels for independent, as those of a render are but for light that splats; the spread
 * of pictures takes in whatever they share. Luminance of one picture adds the channels' errors, for they come from the
 * same samples. */
#include "image_region.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { Y, R, G, B, FORMS };
static const char *const form_names[FORMS] = {"L_v", "R", "G", "B"};

/* A linear form of the channels over the region. */
struct form {
    double mean, variance, fourth; // of one picture: sums of pixels' variances, and of their squares over nu
    double least, most;
    uint32_t at_least[2], at_most[2]; // [pixel]
};

struct source {
    const struct sr_image *image;
    int value[3], error[3]; // channels; -1: there is none
    double y_weights[3];
    double degrees; // of a pixel's error
};

static sr_status open_source(const char *file, const struct sr_image *image, const struct image_region *region,
                             struct source *s, struct sr_error *error)
{
    *s = (struct source){.image = image, .degrees = INFINITY};
    if (region->x1 > image->width || region->y1 > image->height)
        return sr_fail(error, SR_ERROR_INPUT, "%s: the region ends at %u,%u, the picture at %u,%u", file, region->x1,
                       region->y1, image->width, image->height);
    if (!sr_image_luminance_weights(image, s->value, s->y_weights))
        return sr_fail(error, SR_ERROR_INPUT, "%s: has no channels R, G, B or Y to be measured", file);
    static const char *const errors[] = {"SE.R", "SE.G", "SE.B"};
    for (int c = 0; c < 3; ++c)
        s->error[c] = sr_image_find_channel(image, errors[c]);
    const char *replicates = sr_image_get_attribute(image, "steradian.replicates");
    double n = replicates ? strtod(replicates, NULL) : 0;
    if (n >= 2)
        s->degrees = n - 1;
    return SR_OK;
}

static void measure_form(const struct source *s, const struct image_region *region, int form, struct form *f)
{
    *f = (struct form){.least = INFINITY, .most = -INFINITY};
    double count = (double)(region->x1 - region->x0) * (double)(region->y1 - region->y0);
    for (uint32_t y = region->y0; y < region->y1; ++y)
        for (uint32_t x = region->x0; x < region->x1; ++x) {
            const float *p = s->image->floats + sr_image_index(s->image, x, y);
            double value = 0, u = 0;
            for (int c = 0; c < 3; ++c) {
                double w = form == Y ? s->y_weights[c] : form == R + c;
                value += w * (double)p[s->value[c]];
                u += w == 0 ? 0 : s->error[c] >= 0 ? fabs(w) * (double)p[s->error[c]] : NAN;
            }
            f->mean += value / count;
            f->variance += u * u;
            f->fourth += u * u * u * u / s->degrees;
            if (value < f->least)
                f->least = value, f->at_least[0] = x, f->at_least[1] = y;
            if (value > f->most)
                f->most = value, f->at_most[0] = x, f->at_most[1] = y;
        }
    f->variance /= count * count;
    f->fourth /= count * count * count * count;
}

/* The forms of all pictures, one after the other. */
static sr_status measure_all(const char *const *files, int count, const struct image_region *region, struct form *forms,
                             bool *is_luminous, struct sr_error *error)
{
    for (int i = 0; i < count && !error->status; ++i) {
        struct sr_image *image;
        struct source s;
        if (sr_image_read(files[i], &image, error) != SR_OK)
            break;
        if (sr_image_to_float(image, error) == SR_OK && open_source(files[i], image, region, &s, error) == SR_OK) {
            for (int k = 0; k < FORMS; ++k)
                measure_form(&s, region, k, &forms[i * FORMS + k]);
            *is_luminous = strcmp(image->channels[s.value[0]].unit, "cd/m^2") == 0;
        }
        sr_image_free(image);
    }
    return error->status;
}

static struct sr_quantity quantity_of(const struct form *forms, int count, int k, struct sr_unit unit)
{
    if (count > 1) {
        struct sr_tally t = {0};
        for (int i = 0; i < count; ++i)
            sr_tally_add(&t, forms[i * FORMS + k].mean);
        return sr_quantity_of_tally(&t, unit);
    }
    const struct form *f = &forms[k];
    if (f->mean == 0 && f->variance == 0) // nothing was found: that is not sure to be all
        return (struct sr_quantity){.u = NAN, .unit = unit};
    return (struct sr_quantity){.value = f->mean,
                                .u = sqrt(f->variance),
                                .degrees = f->fourth > 0 ? f->variance * f->variance / f->fourth : INFINITY,
                                .unit = unit};
}

static double first_over_second(const double *means)
{
    return means[0] / means[1];
}

/* R/G and B/G of replicates: the colour of the light, by the jackknife, for both come from the same paths. */
static struct sr_quantity ratio_to_green(const struct form *forms, int count, int k)
{
    double *rows = calloc((size_t)count, 2 * sizeof *rows);
    struct sr_quantity q = {.value = NAN, .u = NAN};
    if (!rows)
        return q;
    for (int i = 0; i < count; ++i) {
        rows[2 * i] = forms[i * FORMS + k].mean;
        rows[2 * i + 1] = forms[i * FORMS + G].mean;
    }
    q = sr_quantity_jackknife(rows, (uint32_t)count, 2, first_over_second, (struct sr_unit){0});
    free(rows);
    return q;
}

static json_t *pixel_json(const uint32_t at[2])
{
    return json_pack("[i,i]", (int)at[0], (int)at[1]);
}

int image_print_region(const char *const *files, int count, const struct image_region *region, bool as_json)
{
    struct sr_error error = {0};
    struct form *forms = calloc((size_t)count * FORMS, sizeof *forms);
    bool is_luminous = false;
    if (!forms)
        sr_fail(&error, SR_ERROR_RESOURCE, "not enough memory");
    if (error.status || measure_all(files, count, region, forms, &is_luminous, &error) != SR_OK) {
        free(forms);
        return command_fail("image", &error);
    }
    struct sr_unit unit = is_luminous ? sr_unit_of(SR_KIND_RADIANCE, SR_PHOTOPIC, false) : (struct sr_unit){0};
    const char *assumption = count > 1 ? "from the spread of independent pictures"
                                       : "from the pixels' standard errors, which are taken for independent";
    json_t *values = json_object();
    if (!as_json)
        printf("region %u,%u to %u,%u: %u x %u pixels of %s%s\nuncertainty %s\n", region->x0, region->y0, region->x1,
               region->y1, region->x1 - region->x0, region->y1 - region->y0, files[0],
               count > 1 ? " and its replicates" : "", assumption);
    for (int k = 0; k < FORMS; ++k) {
        const struct form *f = &forms[k]; // least and most: of the first picture
        struct sr_quantity q = quantity_of(forms, count, k, unit);
        char text[160];
        bool has_any = f->least <= f->most;
        if (!as_json)
            printf("%-4s mean %s; ", form_names[k], sr_quantity_text(NULL, &q, text, sizeof text));
        if (!as_json && has_any)
            printf("least %.6g at %u,%u; most %.6g at %u,%u\n", f->least, f->at_least[0], f->at_least[1], f->most,
                   f->at_most[0], f->at_most[1]);
        else if (!as_json)
            printf("no pixel is finite\n");
        json_object_set_new(
            values, form_names[k],
            json_pack("{s:o, s:o, s:o, s:o, s:o}", "mean", command_json_measured(&q), "least",
                      command_json_number(f->least), "least_at", has_any ? pixel_json(f->at_least) : json_null(),
                      "most", command_json_number(f->most), "most_at", has_any ? pixel_json(f->at_most) : json_null()));
    }
    for (int k = R; k <= B && count > 1; k += B - R) {
        struct sr_quantity q = ratio_to_green(forms, count, k);
        const char *name = k == R ? "R/G" : "B/G";
        char text[160];
        if (!as_json)
            printf("%-4s %s\n", name, sr_quantity_text(NULL, &q, text, sizeof text));
        json_object_set_new(values, name, json_pack("{s:o}", "mean", command_json_measured(&q)));
    }
    free(forms);
    if (as_json)
        return command_print_json("image",
                                  json_pack("{s:o, s:i, s:{s:[i,i,i,i], s:s}, s:s, s:o}", "file",
                                            command_json_text(files[0]), "pictures", count, "region", "corners",
                                            (int)region->x0, (int)region->y0, (int)region->x1, (int)region->y1, "unit",
                                            "pixel", "uncertainty", assumption, "values", values));
    json_decref(values);
    return 0;
}
