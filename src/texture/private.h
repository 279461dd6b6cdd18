/* SPDX-License-Identifier: MIT */
/* What the files of this room share among themselves: the models' names, and the mapping's checks. */
#ifndef SR_TEXTURE_PRIVATE_H
#define SR_TEXTURE_PRIVATE_H

#include "texture/texture.h"

extern const struct sr_texture_model sr_texture_constant_model_float, sr_texture_constant_model_spectrum,
    sr_texture_scale_float, sr_texture_scale_spectrum, sr_texture_mix_float, sr_texture_mix_spectrum,
    sr_texture_bilerp_float, sr_texture_bilerp_spectrum, sr_texture_checkerboard_float,
    sr_texture_checkerboard_spectrum, sr_texture_imagemap_float, sr_texture_imagemap_spectrum;

/* Puts the planar axes' defaults where none are given, and refuses a kind that does not exist. */
sr_status sr_mapping_prepare(struct sr_mapping *m, struct sr_error *error);

#endif
