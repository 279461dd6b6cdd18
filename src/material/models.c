/* SPDX-License-Identifier: MIT */
/* What scenes may name: the materials of this room's files, then those that follow from the tables of the other BSDFs.
 */
#include "material/private.h"

#include <string.h>

static const struct sr_material_model *const own[] = {
    &sr_material_diffuse,          &sr_material_diffuse_transmission,
    &sr_material_conductor,        &sr_material_dielectric,
    &sr_material_thin_dielectric,  &sr_material_coated_diffuse,
    &sr_material_coated_conductor, &sr_material_mix,
    &sr_material_interface,        &sr_material_hair,
    &sr_material_subsurface,
};
enum { OWN = sizeof own / sizeof own[0] };

// BSDFs that the files of this room bind, by other words
static bool is_bound_here(const struct sr_bsdf_model *b)
{
    return b == &sr_bsdf_diffuse || b == &sr_bsdf_diffuse_transmission || b == &sr_bsdf_conductor ||
           b == &sr_bsdf_dielectric || b == &sr_bsdf_thin_dielectric || b == &sr_bsdf_coated_diffuse ||
           b == &sr_bsdf_coated_conductor || b == &sr_bsdf_hair;
}

const struct sr_material_model *sr_material_model(int i)
{
    if (i < OWN)
        return own[i];
    for (int k = 0, n = OWN; sr_bsdf_models[k]; ++k)
        if (!is_bound_here(sr_bsdf_models[k]) && n++ == i)
            return sr_material_of_bsdf(sr_bsdf_models[k]);
    return NULL;
}

const struct sr_material_model *sr_material_model_find(const char *name)
{
    const struct sr_material_model *m;
    for (int i = 0; (m = sr_material_model(i)); ++i)
        if (strcmp(m->name, name) == 0)
            return m;
    return NULL;
}
