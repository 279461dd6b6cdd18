/* SPDX-License-Identifier: MIT */
/* The list of materials. */
#include "material/private.h"

#include <string.h>

const struct sr_material_model *const sr_material_models[] = {
    &sr_material_diffuse,          &sr_material_diffuse_transmission,
    &sr_material_conductor,        &sr_material_dielectric,
    &sr_material_thin_dielectric,  &sr_material_coated_diffuse,
    &sr_material_coated_conductor, &sr_material_mix,
    &sr_material_interface,        NULL,
};

const struct sr_material_model *sr_material_model_find(const char *name)
{
    for (int i = 0; sr_material_models[i]; ++i)
        if (strcmp(sr_material_models[i]->name, name) == 0)
            return sr_material_models[i];
    return NULL;
}
