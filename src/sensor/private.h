/* SPDX-License-Identifier: MIT */
/* What the projective cameras share: the window on the screen, and the axes of the camera in the world. */
#ifndef SR_SENSOR_PRIVATE_H
#define SR_SENSOR_PRIVATE_H

#include "sensor/sensor.h"

extern const struct sr_sensor_model sr_sensor_perspective, sr_sensor_orthographic, sr_sensor_spherical,
    sr_sensor_fisheye, sr_sensor_realistic;

/* Parameters of projective cameras, and the affine map from raster to screen that follows from them. */
struct projection {
    float lens_radius, focal_distance; // [m] in the camera's space
    float frame_aspect_ratio;          // [1] width / height, NaN: the raster's
    struct sr_slice screen_window;     // [1] x0 x1 y0 y1, empty: the shorter side goes from -1 to 1
    float x0, x_step;                  // [1] screen x = x0 + x_step * raster x
    float y0, y_step;                  // [1] the same; rasters count downward, so y_step < 0
};

// rows of a table: one line each, or two
// clang-format off
#define SENSOR_SHUTTER_ROWS(type) \
    {SR_PARAM_FLOAT, "shutteropen", "s", -INFINITY, INFINITY, 0, offsetof(type, common.shutter_open), \
     "exposure begins"}, \
    {SR_PARAM_FLOAT, "shutterclose", "s", -INFINITY, INFINITY, 1, offsetof(type, common.shutter_close), \
     "exposure ends"}
#define SENSOR_PROJECTION_ROWS(type) \
    SENSOR_SHUTTER_ROWS(type), \
    {SR_PARAM_FLOAT, "lensradius", "m", 0, INFINITY, 0, offsetof(type, projection.lens_radius), \
     "0: everything is sharp"}, \
    {SR_PARAM_FLOAT, "focaldistance", "m", 0, INFINITY, 1e6, offsetof(type, projection.focal_distance), \
     "to the plane that is sharp"}, \
    {SR_PARAM_FLOAT, "frameaspectratio", "1", 0, INFINITY, NAN, offsetof(type, projection.frame_aspect_ratio), \
     "width / height; the image's"}, \
    {SR_PARAM_FLOATS, "screenwindow", "1", -INFINITY, INFINITY, NAN, offsetof(type, projection.screen_window), \
     "x0 x1 y0 y1 of the image's borders"}
// clang-format on

/* The camera's origin [m] and axes (not normalised: the transform may scale) in the world. */
struct sensor_axes {
    sr_vec3 origin, x, y, z;
};
struct sensor_axes sensor_axes(const struct sr_transform *camera_to_world);

/* Coordinates of a vector by two others that span a plane: dot products with these. n: their cross product. */
static inline void sensor_duals(sr_vec3 a, sr_vec3 b, sr_vec3 *n, sr_vec3 *dual_a, sr_vec3 *dual_b)
{
    *n = sr_cross(a, b);
    float inverse = 1 / sr_length2(*n);
    *dual_a = sr_scale(inverse, sr_cross(b, *n));
    *dual_b = sr_scale(inverse, sr_cross(*n, a));
}

/* Keeps what all sensors are given; refuses an empty raster and a transform without an inverse. */
sr_status sensor_common_prepare(struct sr_sensor_common *c, struct sr_sensor_raster raster,
                                const struct sr_transform *camera_to_world, struct sr_error *error);
sr_status projection_prepare(struct projection *p, struct sr_sensor_raster raster, struct sr_error *error);

#endif
