/* SPDX-License-Identifier: MIT */
/* What looks: perspective, orthographic, spherical: one file a kind. */
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

/* The picture that a sensor serves, in pixels. */
struct sr_sensor_raster {
    uint32_t width, height;
};

struct sr_sensor_model {
    const char *name;
    const struct sr_param *params;
    size_t size;
    sr_status (*prepare)(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error);
    /* raster: position in pixels, (0,0) the upper left corner; u_lens, u_time uniform. false: no light comes */
    bool (*ray)(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out);
};
extern const struct sr_sensor_model *const sr_sensor_models[]; // ends with NULL
const struct sr_sensor_model *sr_sensor_model_find(const char *name);

struct sr_sensor {
    const struct sr_sensor_model *model;
    const void *self;
};

/* Common to the projective cameras (perspective, orthographic); their params tables list these too. Each camera's
 * struct begins with struct sr_sensor_common. */
struct sr_sensor_common {
    float shutter_open, shutter_close; // [s]
    struct sr_transform camera_to_world;
    struct sr_sensor_raster raster;
};

#endif
