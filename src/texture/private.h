/* SPDX-License-Identifier: MIT */
/* What the files of this room share among themselves: the models' names, and the mapping's checks. */
#ifndef SR_TEXTURE_PRIVATE_H
#define SR_TEXTURE_PRIVATE_H

#include "texture/texture.h"

extern const struct sr_texture_model sr_texture_constant_model_float, sr_texture_constant_model_spectrum,
    sr_texture_scale_float, sr_texture_scale_spectrum, sr_texture_mix_float, sr_texture_mix_spectrum,
    sr_texture_bilerp_float, sr_texture_bilerp_spectrum, sr_texture_checkerboard_float,
    sr_texture_checkerboard_spectrum, sr_texture_imagemap_float, sr_texture_imagemap_spectrum, sr_texture_dots_float,
    sr_texture_dots_spectrum, sr_texture_directionmix_float, sr_texture_directionmix_spectrum, sr_texture_fbm,
    sr_texture_wrinkled, sr_texture_windy, sr_texture_marble;

extern const struct sr_texture_model sr_texture_texelmap_float, sr_texture_texelmap_spectrum,
    sr_texture_attribute_float, sr_texture_attribute_spectrum, sr_texture_product,
    sr_texture_threshold; // for what other formats say

/* Puts the planar axes' defaults where none are given, and refuses a kind that does not exist. */
sr_status sr_mapping_prepare(struct sr_mapping *m, struct sr_error *error);

/* 3-D mapping: a point of a surface and its footprint in the texture's space [m]. */
struct sr_in_space {
    sr_vec3 p, dpdx, dpdy;
};
static inline struct sr_in_space sr_in_space(const struct sr_transform *world_to_texture, const struct sr_point *x)
{
    return (struct sr_in_space){sr_transform_point(world_to_texture, x->p),
                                sr_transform_vector(world_to_texture, x->dpdx),
                                sr_transform_vector(world_to_texture, x->dpdy)};
}

#endif
