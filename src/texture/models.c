/* SPDX-License-Identifier: MIT */
/* The list of textures, and what is common to all. */
#include "texture/texture.h"

#include "texture/private.h"

#include <string.h>

const struct sr_texture_model *const sr_texture_models[] = {
    &sr_texture_constant_model_float,
    &sr_texture_constant_model_spectrum,
    &sr_texture_scale_float,
    &sr_texture_scale_spectrum,
    &sr_texture_mix_float,
    &sr_texture_mix_spectrum,
    &sr_texture_bilerp_float,
    &sr_texture_bilerp_spectrum,
    &sr_texture_checkerboard_float,
    &sr_texture_checkerboard_spectrum,
    &sr_texture_imagemap_float,
    &sr_texture_imagemap_spectrum,
    &sr_texture_dots_float,
    &sr_texture_dots_spectrum,
    &sr_texture_directionmix_float,
    &sr_texture_directionmix_spectrum,
    &sr_texture_fbm,
    &sr_texture_wrinkled,
    &sr_texture_windy,
    &sr_texture_marble,
    &sr_texture_texelmap_float,
    &sr_texture_texelmap_spectrum,
    &sr_texture_attribute_float,
    &sr_texture_attribute_spectrum,
    &sr_texture_product,
    &sr_texture_threshold,
    NULL,
};

const struct sr_texture_model *sr_texture_model_find(const char *name, bool is_float)
{
    for (int i = 0; sr_texture_models[i]; ++i)
        if (sr_texture_models[i]->is_float == is_float && strcmp(sr_texture_models[i]->name, name) == 0)
            return sr_texture_models[i];
    return NULL;
}

bool sr_texture_is_constant_float(struct sr_texture t, float *value)
{
    return t.model && t.model->constant_float && t.model->constant_float(t.self, value);
}

bool sr_texture_is_constant_spectrum(struct sr_texture t, struct sr_spd *value)
{
    return t.model && t.model->constant_spectrum && t.model->constant_spectrum(t.self, value);
}

size_t sr_texture_texels_offset(const struct sr_texture_model *model)
{
    return model->texels_offset;
}

size_t sr_texture_mapping_offset(const struct sr_texture_model *model)
{
    return model->mapping_offset;
}

size_t sr_texture_transform_offset(const struct sr_texture_model *model)
{
    return model->transform_offset;
}
