/* SPDX-License-Identifier: MIT */
/* The list of all shapes. */
#include "shape/shape.h"

#include <string.h>

const struct sr_shape_model *const sr_shape_models[] = {
    &sr_shape_trianglemesh, &sr_shape_bilinearmesh, &sr_shape_sphere, &sr_shape_disk,
    &sr_shape_cylinder,     &sr_shape_loopsubdiv,   &sr_shape_curve,  NULL,
};

const struct sr_shape_model *sr_shape_model_find(const char *name)
{
    for (size_t i = 0; sr_shape_models[i]; ++i) {
        if (strcmp(sr_shape_models[i]->name, name) == 0)
            return sr_shape_models[i];
    }
    return NULL;
}
