/* SPDX-License-Identifier: MIT */
/* The list of all models: a new one is a file and a line here. */
#include "bsdf/bsdf.h"

#include <string.h>

const struct sr_bsdf_model *const sr_bsdf_models[] = {
    &sr_bsdf_diffuse,         &sr_bsdf_diffuse_transmission, &sr_bsdf_conductor,        &sr_bsdf_dielectric,
    &sr_bsdf_thin_dielectric, &sr_bsdf_coated_diffuse,       &sr_bsdf_coated_conductor, NULL,
};

const struct sr_bsdf_model *sr_bsdf_model_find(const char *name)
{
    for (int i = 0; sr_bsdf_models[i]; ++i)
        if (strcmp(sr_bsdf_models[i]->name, name) == 0)
            return sr_bsdf_models[i];
    return NULL;
}
