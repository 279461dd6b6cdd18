/* SPDX-License-Identifier: MIT */
/* What the files of this room share. */
#ifndef SR_METER_PRIVATE_H
#define SR_METER_PRIVATE_H

#include "meter/meter.h"

extern const struct sr_meter_model meter_irradiance, meter_cylindrical, meter_semicylindrical, meter_hemispherical,
    meter_spherical, meter_fluence, meter_radiance, meter_flux, meter_irradiancemap, meter_intensity;

sr_vec3 meter_or_z(sr_vec3 v); // z where none was given
/* Makes it of unit length, or tells that it has none. */
sr_status meter_direction(const char *name, sr_vec3 *v, struct sr_error *error);
/* How far a ray starts off a surface that the point is meant to lie on. */
sr_vec3 meter_p_error(sr_vec3 p);
/* A place of a surface whose normal is the frame's z. */
void meter_place_on(const struct sr_point *x, float weight, struct sr_meter_place *place);

/* ---- surfaces ---- */

enum { METER_RECTANGLE, METER_DISK, METER_SPHERE };
/* What the file says of a surface that is the meter's own. */
struct meter_surface_params {
    int32_t shape;
    sr_vec3 p, n, u, v; // [m] corner or centre, [1] normal, [m] edges
    float radius;       // [m]
};
// rows of a table: one line each, or two
// clang-format off
#define METER_SURFACE_ROWS(type, member) \
    {SR_PARAM_ENUM, "shape", "1", 0, 0, METER_RECTANGLE, \
     offsetof(type, member) + offsetof(struct meter_surface_params, shape), "rectangle|disk|sphere"}, \
    {SR_PARAM_POINT3, "p", "m", 0, 0, 0, \
     offsetof(type, member) + offsetof(struct meter_surface_params, p), \
     "corner of the rectangle, centre of disk or sphere"}, \
    {SR_PARAM_NORMAL3, "n", "1", 0, 0, NAN, \
     offsetof(type, member) + offsetof(struct meter_surface_params, n), "the disk's normal; none: +z"}, \
    {SR_PARAM_VECTOR3, "u", "m", 0, 0, NAN, \
     offsetof(type, member) + offsetof(struct meter_surface_params, u), "an edge of the rectangle"}, \
    {SR_PARAM_VECTOR3, "v", "m", 0, 0, NAN, \
     offsetof(type, member) + offsetof(struct meter_surface_params, v), "the other; the front is u x v"}, \
    {SR_PARAM_FLOAT, "radius", "m", 0, INFINITY, 1, \
     offsetof(type, member) + offsetof(struct meter_surface_params, radius), "of disk and sphere"}
// clang-format on

struct meter_surface_self {
    sr_vec3 p, u, v, n; // [m] [m] [m] [1]
    float radius;       // [m]
    float density;      // [1/m^2]
};
/* Makes the surface of the parameters, unless a shape of the scene has been found already. */
sr_status meter_surface_prepare(struct sr_meter_common *common, const struct meter_surface_params *p,
                                const struct sr_transform *t, struct sr_arena *arena, struct sr_error *error);

#endif
