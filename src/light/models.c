/* SPDX-License-Identifier: MIT */
/* The list of lights. A new one is its file and one line here. */
#include "light/light.h"

#include <string.h>

extern const struct sr_light_model sr_light_point, sr_light_spot, sr_light_ies, sr_light_goniometric,
    sr_light_projection, sr_light_distant, sr_light_infinite;

const struct sr_light_model *const sr_light_models[] = {
    &sr_light_point,      &sr_light_spot,    &sr_light_ies,      &sr_light_goniometric,
    &sr_light_projection, &sr_light_distant, &sr_light_infinite, NULL,
};

const struct sr_light_model *sr_light_model_find(const char *name)
{
    for (int i = 0; sr_light_models[i]; ++i)
        if (strcmp(sr_light_models[i]->name, name) == 0)
            return sr_light_models[i];
    return NULL;
}

size_t sr_light_transform_offset(const struct sr_light_model *model)
{
    return model == &sr_light_area ? SIZE_MAX : offsetof(struct sr_light_common, light_to_world);
}

size_t sr_light_space_offset(const struct sr_light_model *model)
{
    return model == &sr_light_area ? SIZE_MAX : offsetof(struct sr_light_common, space);
}

size_t sr_light_absolute_offset(const struct sr_light_model *model)
{
    return model == &sr_light_area ? SIZE_MAX : offsetof(struct sr_light_common, is_absolute);
}

size_t sr_light_texels_offset(const struct sr_light_model *model)
{
    for (const struct sr_param *row = model == &sr_light_area || model->reads_own_file ? NULL : model->params;
         row && row->name; ++row)
        if (row->kind == SR_PARAM_FILE)
            return offsetof(struct sr_light_common, texels);
    return SIZE_MAX;
}
