/* SPDX-License-Identifier: MIT */
/* For lights made of an image: directions in the light's space, and texels as emission spectra. */
#ifndef SR_LIGHT_PIXELS_H
#define SR_LIGHT_PIXELS_H

#include "light/emission.h"

/* Directions of the world in the space of a light and back; solid angles change where the transform is no rotation. */
struct sr_light_turn {
    sr_vec3 rows[3], columns[3]; // world to light; light to world
    float determinant;           // of world to light, absolute
};
struct sr_light_turn sr_light_turn_of(const struct sr_transform *light_to_world);

/* Unit direction w of the world in the light's space, of unit length; *jacobian: solid angle there over that of the
 * world. */
static inline sr_vec3 sr_light_turned(const struct sr_light_turn *t, sr_vec3 w, float *jacobian)
{
    sr_vec3 d = {sr_dot(t->rows[0], w), sr_dot(t->rows[1], w), sr_dot(t->rows[2], w)};
    float inverse_length = 1 / sr_length(d);
    *jacobian = t->determinant * inverse_length * inverse_length * inverse_length;
    return sr_scale(inverse_length, d);
}
static inline sr_vec3 sr_light_turned_back(const struct sr_light_turn *t, sr_vec3 d)
{
    return sr_normalize(
        sr_add(sr_add(sr_scale(d.x, t->columns[0]), sr_scale(d.y, t->columns[1])), sr_scale(d.z, t->columns[2])));
}

/* Texels as spectra: factor * rgb * white of their space. Looked up without interpolation, so that they are the cells
 * of a piecewise constant density. */
struct sr_light_pixels {
    const struct sr_texels *texels;
    const struct sr_table *white;
    float factor;
    struct sr_light_pixel {
        struct sr_sigmoid sigmoid;
        float scale;
    } * cells; // one a texel; NULL: too many
};
sr_status sr_light_pixels_build(struct sr_light_pixels *p, const struct sr_texels *texels, float factor,
                                const char *filename, struct sr_arena *arena, struct sr_error *error);
sr_spectrum sr_light_pixel_at(const struct sr_light_pixels *p, sr_vec2 uv, const struct sr_wavelengths *w);

static inline uint32_t sr_light_texel_index(float u, uint32_t n)
{
    float i = u * (float)n;
    return i > 0 ? (uint32_t)sr_min(i, (float)(n - 1)) : 0;
}

static inline float sr_light_grey(const struct sr_texels *t, uint32_t x, uint32_t y)
{
    struct sr_rgb c = sr_light_texel(t, x, y);
    return (c.r + c.g + c.b) / 3;
}

#endif
