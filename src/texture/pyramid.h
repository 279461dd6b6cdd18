/* SPDX-License-Identifier: MIT */
/* An image as textures keep it: every level of detail, ready to be weighed into a number or a spectrum. */
#ifndef SR_TEXTURE_PYRAMID_H
#define SR_TEXTURE_PYRAMID_H

#include "texture/texture.h"

enum { SR_PYRAMID_MAX_LEVELS = 32 };

/* A texel as a curve over wavelength, 8 bytes: the sigmoid's argument at three anchors, as half floats, and a scale. */
struct sr_packed_texel {
    uint16_t anchor[3]; // [1] x(400 nm), x(550 nm), x(700 nm) of 1/2 + x / (2 sqrt(1 + x^2)), IEEE binary16
    uint16_t scale;     // [1] upper bits of a positive float: 8 of exponent, 8 of mantissa
};

struct sr_pyramid_level {
    uint32_t width, height;
    const float *values;                   // a float texture's, or NULL
    const struct sr_packed_texel *spectra; // a spectrum texture's, or NULL
};

struct sr_pyramid {
    uint32_t count; // levels; the last is one texel
    struct sr_pyramid_level levels[SR_PYRAMID_MAX_LEVELS];
};

/* How the numbers of the file become those of the texture: v -> max(0, scale v), inverted: max(0, 1 - scale v). */
struct sr_pyramid_adjust {
    float scale; // [1]
    bool invert;
};

/* Halves the image by box filters, in linear light, until one texel is left: each level has the image's mean. Float:
 * the grey value, alpha where there is one that is not 1 everywhere, or the mean of R, G and B. Spectrum: the curve
 * that the use gives RGB. */
sr_status sr_pyramid_build(struct sr_pyramid *p, const struct sr_texels *texels, bool is_float,
                           struct sr_pyramid_adjust adjust, struct sr_texture_use use, struct sr_arena *arena,
                           struct sr_error *error);

/* For tests: one texel's packing and its value at wavelengths. */
struct sr_packed_texel sr_packed_texel_encode(struct sr_texture_use use, struct sr_rgb rgb);
/* SUM over i of weight[i] * texel[i](lambda), count <= 4 */
sr_spectrum sr_packed_texels_sum(const struct sr_packed_texel *const texel[], const float weight[], int count,
                                 bool has_scale, sr_spectrum lambda);

#endif
