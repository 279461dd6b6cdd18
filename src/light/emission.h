/* SPDX-License-Identifier: MIT */
/* For the files of this room: what emission means before it has a shape. */
#ifndef SR_LIGHT_EMISSION_H
#define SR_LIGHT_EMISSION_H

#include "light/light.h"

/* Makes s mean `luminance` [cd/m^2], or whatever its luminous integral stands for: luminous intensity, illuminance.
 * Nothing given is the white of the colour space. Of an RGB emission only the white counts: rgb multiplies it. */
sr_status sr_light_normalise(struct sr_spd *s, enum sr_colour_space_id space, float luminance, struct sr_error *error);

/* Makes s as bright as a scene says: `scale` times its share of the light's power or illuminance (share; not above 0:
 * not given). Photometric: share is in lm or lx per what the light needs to turn it into its own unit, and 1 stands
 * where none is given. Absolute spectra and black bodies: s as it stands is in W m^-2 sr^-1 nm^-1 (or W sr^-1 nm^-1, W
 * m^-2 nm^-1), share in W or W/m^2 of 360 to 830 nm. RGB and the white where nothing is given are photometric always.
 */
sr_status sr_light_set_brightness(struct sr_spd *s, enum sr_colour_space_id space, bool is_absolute, float scale,
                                  float share, struct sr_error *error);

/* The weight of s where lights are chosen: its luminous integral and a grain of its maximum, so that light that the eye
 * hardly sees is found, too. */
float sr_light_choice_weight(const struct sr_spd *s);

/* All texels are numbers. */
sr_status sr_light_check_finite(const struct sr_texels *t, const char *filename, struct sr_error *error);
/* The same, and there are three channels. */
sr_status sr_light_check_texels(const struct sr_texels *t, const char *filename, struct sr_error *error);
/* Mean luminance of the texels where white is 1 [1]. */
double sr_light_mean_luminance(const struct sr_texels *t);

/* Texel (x, y), nothing negative. */
static inline struct sr_rgb sr_light_texel(const struct sr_texels *t, uint32_t x, uint32_t y)
{
    size_t i = ((size_t)y * t->width + x) * t->channels;
    size_t g = t->channels >= 3 ? 1 : 0, b = t->channels >= 3 ? 2 : 0;
    struct sr_rgb c =
        t->bytes ? (struct sr_rgb){t->decode[t->bytes[i]], t->decode[t->bytes[i + g]], t->decode[t->bytes[i + b]]}
                 : (struct sr_rgb){t->floats[i], t->floats[i + g], t->floats[i + b]};
    return (struct sr_rgb){c.r > 0 ? c.r : 0, c.g > 0 ? c.g : 0, c.b > 0 ? c.b : 0};
}
static inline double sr_light_texel_luminance(const struct sr_texels *t, uint32_t x, uint32_t y) // of white: 1
{
    const double *y_of_rgb = sr_colour_space(t->space)->xyz_from_rgb[1];
    struct sr_rgb c = sr_light_texel(t, x, y);
    return y_of_rgb[0] * (double)c.r + y_of_rgb[1] * (double)c.g + y_of_rgb[2] * (double)c.b;
}

/* Where light that travels against wi enters the scene: on a disk as wide as the scene's sphere, before it. */
static inline sr_vec3 sr_light_outside(sr_vec3 centre, float radius, sr_vec3 wi, sr_vec2 u)
{
    struct sr_frame frame = sr_frame_from_z(wi);
    sr_vec2 d = sr_warp_disk(u);
    return sr_add(centre, sr_scale(radius, sr_to_world(&frame, (sr_vec3){d.x, d.y, 1.001f})));
}

/* For lights that no ray meets. */
float sr_light_delta_pdf(const void *self, const struct sr_point *reference, sr_vec3 wi, const struct sr_point *there);
sr_spectrum sr_light_delta_Le(const void *self, const struct sr_point *there, sr_vec3 w,
                              const struct sr_wavelengths *wavelengths);

#endif
