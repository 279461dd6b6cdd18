/* SPDX-License-Identifier: MIT */
/* The list of meters, and what all have: a name and a detector. */
#include "meter/private.h"

#include <string.h>

const struct sr_meter_model *const sr_meter_models[] = {
    &meter_irradiance,
    &meter_cylindrical,
    &meter_semicylindrical,
    &meter_hemispherical,
    &meter_spherical,
    &meter_fluence,
    &meter_radiance,
    &meter_flux,
    &meter_irradiancemap,
    &meter_intensity,
    NULL,
};

const struct sr_meter_model *sr_meter_model_find(const char *name)
{
    for (int i = 0; sr_meter_models[i]; ++i)
        if (strcmp(sr_meter_models[i]->name, name) == 0)
            return sr_meter_models[i];
    return NULL;
}

#define MEMBER(m) offsetof(struct sr_meter_common, m)
const struct sr_param sr_meter_common_params[] = {
    {SR_PARAM_STRING, "name", "1", 0, 0, NAN, MEMBER(name), "by which it is asked for and printed"},
    {SR_PARAM_STRING, "surface", "1", 0, 0, NAN, MEMBER(surface_name), "the name of a shape, for meters with an area"},
    {SR_PARAM_ENUM, "reading", "1", 0, 0, SR_READ_VALUE, MEMBER(reading), "value|spectrum|colour"},
    {SR_PARAM_FLOATS, "lambda", "nm", 0, INFINITY, NAN, MEMBER(lambda), "of a spectrum: first, step, last"},
    {SR_PARAM_FLOAT, "fwhm", "nm", 1e-3, 1000, NAN, MEMBER(fwhm),
     "width of the bandpass at half its height; none: the step"},
    {SR_PARAM_ENUM, "bandpass", "1", 0, 0, SR_BAND_TRIANGULAR, MEMBER(bandpass), "triangular|rectangular"},
    {.name = NULL},
};

sr_vec3 meter_or_z(sr_vec3 v)
{
    return isnan(v.x) ? (sr_vec3){0, 0, 1} : v;
}

sr_status meter_direction(const char *name, sr_vec3 *v, struct sr_error *error)
{
    float length = sr_length(*v);
    if (!(length > 0) || !isfinite(length))
        return sr_fail(error, SR_ERROR_INPUT, "\"%s\" has no direction: expected three numbers that are not all 0",
                       name);
    *v = sr_scale(1 / length, *v);
    return SR_OK;
}

sr_vec3 meter_p_error(sr_vec3 p)
{
    return (sr_vec3){1e-6f * fabsf(p.x), 1e-6f * fabsf(p.y), 1e-6f * fabsf(p.z)};
}

void meter_place_on(const struct sr_point *x, float weight, struct sr_meter_place *place)
{
    *place = (struct sr_meter_place){.x = *x, .frame = sr_frame_from_z(x->n), .weight = weight};
}
