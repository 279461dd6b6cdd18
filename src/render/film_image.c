/* SPDX-License-Identifier: MIT */
/* A film as an image: channels with names and units. */
#include "render/render.h"

#include <stdio.h>

static const struct channel {
    const char *name, *unit;
} picture[] = {{"R", "cd/m^2"}, {"G", "cd/m^2"}, {"B", "cd/m^2"}},
  errors[] = {{"SE.R", "cd/m^2"}, {"SE.G", "cd/m^2"}, {"SE.B", "cd/m^2"}, {"samples", "1"}},
  auxiliary[] = {{"albedo.R", "1"}, {"albedo.G", "1"}, {"albedo.B", "1"}, {"N.X", "1"}, {"N.Y", "1"}, {"N.Z", "1"},
                 {"Ns.X", "1"}, {"Ns.Y", "1"}, {"Ns.Z", "1"}, {"P.X", "m"}, {"P.Y", "m"}, {"P.Z", "m"},
                 {"depth", "m"}, {"u", "1"}, {"v", "1"}, {"id.material", "1"}, {"id.object", "1"}, {"coverage", "1"}};

enum { PICTURE = 3, ERRORS = 4, AUXILIARY = sizeof auxiliary / sizeof auxiliary[0] };

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

sr_status sr_render_image(const struct sr_film *film, bool with_error, bool is_replicated, struct sr_image **image, struct sr_error *error)
{
    const char *names[PICTURE + ERRORS + AUXILIARY], *units[PICTURE + ERRORS + AUXILIARY];
    uint32_t count = 0;
    add_names(picture, PICTURE, names, units, &count);
    if (with_error)
        add_names(errors, ERRORS, names, units, &count);
    if (film->has_aov)
        add_names(auxiliary, AUXILIARY, names, units, &count);
    if (sr_image_create(film->width, film->height, count, names, SR_IMAGE_FLOATS, image, error) != SR_OK)
        return error->status;
    struct sr_image *out = *image;
    for (uint32_t c = 0; c < count; ++c)
        sr_image_set_unit(out, c, units[c]);
    out->x0 = film->settings.x0;
    out->y0 = film->settings.y0;
    out->full_width = (uint32_t)film->settings.width;
    out->full_height = (uint32_t)film->settings.height;
    const struct sr_colour_space *space = sr_colour_space(film->settings.space);
    out->has_chromaticities = true;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 2; ++k)
            out->chromaticities[i][k] = space->xy[i][k];

    for (uint32_t y = 0; y < film->height; ++y)
        for (uint32_t x = 0; x < film->width; ++x) {
            float *p = out->floats + sr_image_index(out, x, y);
            double mean[3], se[3];
            sr_film_pixel_mean(film, x, y, mean);
            for (int c = 0; c < 3; ++c)
                *p++ = (float)mean[c];
            size_t i = (size_t)y * film->width + x;
            if (with_error) {
                sr_film_pixel_error(film, x, y, !is_replicated, se);
                for (int c = 0; c < 3; ++c)
                    *p++ = (float)se[c];
                *p++ = (float)film->pixels[i].n;
            }
            if (film->has_aov)
                put_auxiliary(p, &film->aov[i]);
        }
    return SR_OK;
}
