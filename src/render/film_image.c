/* SPDX-License-Identifier: MIT */
/* A film as an image: channels with names and units. */
#include "render/render.h"

#include <stdio.h>
#include <string.h>

static const struct channel {
    const char *name, *unit;
} picture[] = {{"R", "cd/m^2"}, {"G", "cd/m^2"}, {"B", "cd/m^2"}},
  errors[] = {{"SE.R", "cd/m^2"}, {"SE.G", "cd/m^2"}, {"SE.B", "cd/m^2"}, {"samples", "1"}},
  auxiliary[] = {{"albedo.R", "1"},    {"albedo.G", "1"},  {"albedo.B", "1"}, {"N.X", "1"},  {"N.Y", "1"},
                 {"N.Z", "1"},         {"Ns.X", "1"},      {"Ns.Y", "1"},     {"Ns.Z", "1"}, {"P.X", "m"},
                 {"P.Y", "m"},         {"P.Z", "m"},       {"depth", "m"},    {"u", "1"},    {"v", "1"},
                 {"id.material", "1"}, {"id.object", "1"}, {"coverage", "1"}},
  gbuffer[] = {{"Albedo.R", "1"},
               {"Albedo.G", "1"},
               {"Albedo.B", "1"},
               {"N.X", "1"},
               {"N.Y", "1"},
               {"N.Z", "1"},
               {"Ns.X", "1"},
               {"Ns.Y", "1"},
               {"Ns.Z", "1"},
               {"P.X", "m"},
               {"P.Y", "m"},
               {"P.Z", "m"},
               {"depth", "m"},
               {"u", "1"},
               {"v", "1"},
               {"id.material", "1"},
               {"id.object", "1"},
               {"coverage", "1"}, // as above
               {"dzdx", "m"},
               {"dzdy", "m"},
               {"Variance.R", "cd^2/m^4"},
               {"Variance.G", "cd^2/m^4"},
               {"Variance.B", "cd^2/m^4"},
               {"RelativeVariance.R", "cd/m^2"},
               {"RelativeVariance.G", "cd/m^2"},
               {"RelativeVariance.B", "cd/m^2"}};

enum {
    PICTURE = 3,
    ERRORS = 4,
    AUXILIARY = sizeof auxiliary / sizeof auxiliary[0],
    GBUFFER = sizeof gbuffer / sizeof gbuffer[0],
    BUCKET_NAME = 32
};

static void add_names(const struct channel *list, int n, const char **names, const char **units, uint32_t *count)
{
    for (int i = 0; i < n; ++i) {
        names[*count] = list[i].name;
        units[(*count)++] = list[i].unit;
    }
}

static float *put_unit_vector(float *out, const float v[3])
{
    float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int c = 0; c < 3; ++c)
        *out++ = length > 0 ? v[c] / length : 0;
    return out;
}

static float *put_auxiliary(float *out, const struct sr_film_aov *a)
{
    float per_hit = a->hits ? 1 / (float)a->hits : 0;
    for (int c = 0; c < 3; ++c)
        *out++ = a->albedo[c] * per_hit;
    out = put_unit_vector(out, a->n);
    out = put_unit_vector(out, a->ns);
    for (int c = 0; c < 3; ++c)
        *out++ = a->p[c] * per_hit;
    *out++ = a->depth * per_hit;
    *out++ = a->uv[0] * per_hit;
    *out++ = a->uv[1] * per_hit;
    *out++ = (float)a->material;
    *out++ = (float)a->object;
    *out++ = a->n_samples ? (float)a->hits / (float)a->n_samples : 0;
    return out;
}

/* Variance of one sample that meets something, as pbrt has it; and that over the mean. */
static float *put_gbuffer(float *out, const struct sr_film_aov *a)
{
    float per_hit = a->hits ? 1 / (float)a->hits : 0, relative[3];
    *out++ = a->dzdx * per_hit;
    *out++ = a->dzdy * per_hit;
    for (int c = 0; c < 3; ++c) {
        double n = a->hits, mean = n > 0 ? a->rgb[c] / n : 0,
               variance = n > 1 ? fmax(0, a->square[c] - n * mean * mean) / (n - 1) : 0;
        *out++ = (float)variance;
        relative[c] = mean != 0 ? (float)(variance / mean) : 0;
    }
    for (int c = 0; c < 3; ++c)
        *out++ = relative[c];
    return out;
}

/* "S0.374,688nm", as in the layout of A. Fichet, R. Pacanowski & A. Wilkie, 2021: the middle of the bucket. */
static void name_bucket(const struct sr_film_settings *s, uint32_t bucket, char name[BUCKET_NAME])
{
    double lambda =
        (double)s->lambda_min + ((double)bucket + 0.5) / s->buckets * ((double)s->lambda_max - (double)s->lambda_min);
    snprintf(name, BUCKET_NAME, "S0.%.3fnm", lambda);
    for (char *c = name + 3; *c; ++c)
        if (*c == '.')
            *c = ',';
}

static sr_status create(const struct sr_film *film, const char **names, const char **units, uint32_t count,
                        char (*bucket_names)[BUCKET_NAME], struct sr_image **image, struct sr_error *error)
{
    for (uint32_t i = 0; i < film->settings.buckets; ++i) {
        name_bucket(&film->settings, i, bucket_names[i]);
        names[count] = bucket_names[i];
        bool is_radiance = film->settings.bucket_scale < 1 && sr_film_is_radiance(&film->settings);
        units[count++] = is_radiance ? "W/(m^2 sr nm)" : "1"; // of photometric scenes: as pbrt counts
    }
    if (sr_image_create(film->width, film->height, count, names, SR_IMAGE_FLOATS, image, error) != SR_OK)
        return error->status;
    bool is_luminance = sr_film_is_luminance(&film->settings);
    for (uint32_t c = 0; c < count; ++c)
        sr_image_set_unit(*image, c, strncmp(units[c], "cd", 2) != 0 || is_luminance ? units[c] : "");
    return SR_OK;
}

struct filling {
    const struct sr_film *film;
    struct sr_image *out;
    bool with_error, is_replicated;
};

static void fill_pixel(const struct filling *f, uint32_t x, uint32_t y, const double se[3])
{
    const struct sr_film *film = f->film;
    float *p = f->out->floats + sr_image_index(f->out, x, y);
    double mean[3];
    sr_film_pixel_mean(film, x, y, mean);
    for (int c = 0; c < 3; ++c)
        *p++ = (float)mean[c];
    size_t i = (size_t)y * film->width + x;
    if (f->with_error) {
        for (int c = 0; c < 3; ++c)
            *p++ = (float)se[c];
        *p++ = (float)film->pixels[i].n;
    }
    if (film->has_aov)
        p = put_auxiliary(p, &film->aov[i]);
    if (film->has_aov && film->settings.is_gbuffer)
        p = put_gbuffer(p, &film->aov[i]);
    for (uint32_t k = 0; k < film->settings.buckets; ++k)
        *p++ = (float)sr_film_bucket(film, x, y, k);
}

enum { BAND = 16, STRIP = 64 };

static void fill_band(void *context, uint64_t band)
{
    const struct filling *f = context;
    const struct sr_film *film = f->film;
    uint32_t y0 = (uint32_t)band * BAND, y1 = film->height - y0 < BAND ? film->height : y0 + BAND;
    for (uint32_t x0 = 0; x0 < film->width; x0 += STRIP) {
        double se[BAND * STRIP][3] = {{0}};
        uint32_t x1 = film->width - x0 < STRIP ? film->width : x0 + STRIP;
        if (f->with_error)
            sr_film_errors(film, x0, y0, x1, y1, !f->is_replicated, se[0]);
        for (uint32_t y = y0; y < y1; ++y)
            for (uint32_t x = x0; x < x1; ++x)
                fill_pixel(f, x, y, se[(y - y0) * (x1 - x0) + x - x0]);
    }
}

sr_status sr_render_image(const struct sr_film *film, bool with_error, bool is_replicated, struct sr_image **image,
                          struct sr_error *error)
{
    enum { MOST = PICTURE + ERRORS + GBUFFER };
    uint32_t count = 0, buckets = film->settings.buckets;
    bool is_gbuffer = film->settings.is_gbuffer;
    const char **names = sr_alloc(2 * (MOST + buckets) * sizeof *names), **units = names + MOST + buckets;
    char(*bucket_names)[BUCKET_NAME] = sr_alloc((buckets + 1) * sizeof *bucket_names);
    if (!names || !bucket_names) {
        sr_free(names);
        sr_free(bucket_names);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a picture");
    }
    add_names(picture, PICTURE, names, units, &count);
    if (with_error)
        add_names(errors, ERRORS, names, units, &count);
    if (film->has_aov)
        add_names(is_gbuffer ? gbuffer : auxiliary, is_gbuffer ? GBUFFER : AUXILIARY, names, units, &count);
    sr_status status = create(film, names, units, count, bucket_names, image, error);
    sr_free(names);
    sr_free(bucket_names);
    if (status != SR_OK)
        return status;
    struct sr_image *out = *image;
    if (buckets && (sr_image_set_attribute(out, "spectralLayoutVersion", "1.0", error) != SR_OK ||
                    sr_image_set_attribute(out, "emissiveUnits", "W.m^-2.sr^-1", error) != SR_OK)) {
        sr_image_free(out);
        *image = NULL;
        return error->status;
    }
    out->x0 = film->settings.x0;
    out->y0 = film->settings.y0;
    out->full_width = (uint32_t)film->settings.width;
    out->full_height = (uint32_t)film->settings.height;
    const struct sr_colour_space *space = sr_colour_space(film->settings.space);
    out->has_chromaticities = true;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 2; ++k)
            out->chromaticities[i][k] = space->xy[i][k];

    struct filling filling = {.film = film, .out = out, .with_error = with_error, .is_replicated = is_replicated};
    sr_parallel_for(sr_thread_count(), (film->height + BAND - 1) / BAND, fill_band, &filling);
    return SR_OK;
}
