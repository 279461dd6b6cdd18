/* SPDX-License-Identifier: MIT */
/* What looks: perspective, orthographic, spherical, fisheye, realistic: one file a kind. */
#ifndef SR_SENSOR_SENSOR_H
#define SR_SENSOR_SENSOR_H

#include "math/math.h"
#include "sample/sample.h"

/* A ray into the scene, and how it changes from one pixel to the next. */
struct sr_sensor_ray {
    struct sr_ray ray;
    sr_vec3 dodx, dody; // [m] change of the origin for one pixel in x, y
    sr_vec3 dddx, dddy; // [1] change of the direction for one pixel
    float weight;       // [1] of the radiance that the ray brings
};

/* How a sensor sees a point, were nothing in between: one of its rays, backwards. What the picture gains by radiance L
 * that leaves a surface element dA at the point is L weight |cos theta| dA, at the place `raster`, in [radiance
 * pixel^2]: a pixel is the mean of that over its filter, which has the integral 1 over [pixel^2]. That is Veach's
 * importance We, in the convention of films whose pixels are radiances. */
struct sr_sensor_view {
    sr_vec3 p;      // [m] where the ray begins
    sr_vec3 wi;     // [1] from the point toward it
    float distance; // [m]
    sr_vec2 raster; // [pixel] also outside the picture, where a wide filter still sees it
    float weight;   // [pixel^2/m^2] raster for each area across wi at the point
};

/* What a sensor with wants_lens is told before it is prepared; its struct begins as struct sr_sensor_with_lens. */
struct sr_sensor_lens {
    float diagonal;        // [m] of the picture on the film
    const float *surfaces; // four numbers each, as in a lens file
    uint32_t surface_count, aperture_width, aperture_height;
    const float *aperture; // NULL, or what the square about the stop lets through, rows from below
};

/* The picture that a sensor serves, in pixels. */
struct sr_sensor_raster {
    uint32_t width, height;
};

struct sr_sensor_model {
    const char *name;
    bool wants_lens;
    const struct sr_param *params;
    size_t size;
    sr_status (*prepare)(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error);
    /* raster: position in pixels, (0,0) the upper left corner; u_lens, u_time uniform. false: no light comes */
    bool (*ray)(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out);
    /* The ray through a point of the lens that meets p; false: there is none. NULL, and density NULL: nobody knows it.
     */
    bool (*connect)(const void *self, sr_vec3 p, float time, sr_vec2 u_lens, struct sr_sensor_view *view);
    /* The same weight, of a ray's direction, at a distance along it [pixel^2/m^2]. */
    float (*density)(const void *self, sr_vec3 d, float distance, float time);
    /* The same where nobody looks at the changes, which are 0. NULL: ray serves. */
    bool (*bare_ray)(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out);
};
extern const struct sr_sensor_model *const sr_sensor_models[]; // ends with NULL
const struct sr_sensor_model *sr_sensor_model_find(const char *name);

struct sr_sensor {
    const struct sr_sensor_model *model;
    const void *self;
};

/* A sensor that moves: `still` has been prepared in its own space, and motion leads from there to the world. */
sr_status sr_sensor_move(struct sr_sensor still, const struct sr_motion *motion, struct sr_arena *arena,
                         struct sr_sensor *out, struct sr_error *error);

/* ---- fisheye projections: fisheye.c; rim: the angle from the axis at the rim of the disk [rad] ---- */

enum sr_fisheye { SR_FISHEYE_EQUIDISTANT, SR_FISHEYE_EQUISOLID, SR_FISHEYE_ORTHOGRAPHIC, SR_FISHEYE_STEREOGRAPHIC };
double sr_fisheye_angle(enum sr_fisheye kind, double r, double rim); // [rad] from the axis, r = 1 at the rim
/* The direction in the camera's space (z forward, y up) of a point of the picture [pixel]; false: more than three
 * pixels outside of the disk. */
bool sr_fisheye_direction(enum sr_fisheye kind, double rim, struct sr_sensor_raster raster, double x, double y,
                          double d[3]);
/* The solid angle [sr] that a pixel sees, exactly, and that weighed by cos theta; NaN for the latter where the disk
 * sees behind. */
void sr_fisheye_pixel(enum sr_fisheye kind, double rim, struct sr_sensor_raster raster, uint32_t x, uint32_t y,
                      double *omega, double *projected);

/* Common to the projective cameras (perspective, orthographic); their params tables list these too. Each camera's
 * struct begins with struct sr_sensor_common. */
struct sr_sensor_common {
    float shutter_open, shutter_close; // [s]
    struct sr_transform camera_to_world;
    struct sr_sensor_raster raster;
};
struct sr_sensor_with_lens {
    struct sr_sensor_common common;
    struct sr_sensor_lens lens;
};

#endif
