/* SPDX-License-Identifier: MIT */
/* The list of all models, out of the one in the door. */
#include "bsdf/bsdf.h"

#include <string.h>

#define ADDRESS(name) &sr_bsdf_##name,
const struct sr_bsdf_model *const sr_bsdf_models[] = {SR_BSDF_MODELS(ADDRESS) NULL};

const struct sr_bsdf_model *sr_bsdf_model_find(const char *name)
{
    for (int i = 0; sr_bsdf_models[i]; ++i)
        if (strcmp(sr_bsdf_models[i]->name, name) == 0)
            return sr_bsdf_models[i];
    return NULL;
}
