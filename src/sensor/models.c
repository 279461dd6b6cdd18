/* SPDX-License-Identifier: MIT */
/* The list of sensors, and what the projective ones share.
 *
 * The screen is the plane z = 1 in front of the camera, in units in which the image's shorter side goes from -1 to 1;
 * an image wider than high goes from -aspect to aspect in x, one higher than wide from -1/aspect to 1/aspect in y. */
#include "sensor/private.h"

#include <string.h>

const struct sr_sensor_model *const sr_sensor_models[] = {
    &sr_sensor_perspective, &sr_sensor_orthographic, &sr_sensor_spherical,
    &sr_sensor_fisheye,     &sr_sensor_realistic,    NULL,
};

const struct sr_sensor_model *sr_sensor_model_find(const char *name)
{
    for (int i = 0; sr_sensor_models[i]; ++i)
        if (strcmp(sr_sensor_models[i]->name, name) == 0)
            return sr_sensor_models[i];
    return NULL;
}

struct sensor_axes sensor_axes(const struct sr_transform *camera_to_world)
{
    return (struct sensor_axes){
        .origin = sr_transform_point(camera_to_world, (sr_vec3){0, 0, 0}),
        .x = sr_transform_vector(camera_to_world, (sr_vec3){1, 0, 0}),
        .y = sr_transform_vector(camera_to_world, (sr_vec3){0, 1, 0}),
        .z = sr_transform_vector(camera_to_world, (sr_vec3){0, 0, 1}),
    };
}

sr_status sensor_common_prepare(struct sr_sensor_common *c, struct sr_sensor_raster raster,
                                const struct sr_transform *camera_to_world, struct sr_error *error)
{
    if (raster.width == 0 || raster.height == 0)
        return sr_fail(error, SR_ERROR_INPUT, "a camera serves no image of %u x %u pixels", (unsigned)raster.width,
                       (unsigned)raster.height);
    if (!sr_transform_is_valid(camera_to_world))
        return sr_fail(error, SR_ERROR_INPUT, "the camera's transform has no inverse");
    c->raster = raster;
    c->camera_to_world = *camera_to_world;
    return SR_OK;
}

sr_status projection_prepare(struct projection *p, struct sr_sensor_raster raster, struct sr_error *error)
{
    if (!(p->lens_radius >= 0) || !(p->focal_distance > 0))
        return sr_fail(error, SR_ERROR_INPUT, "lensradius %g must not be negative, focaldistance %g must be positive",
                       (double)p->lens_radius, (double)p->focal_distance);
    float width = (float)raster.width, height = (float)raster.height;
    float aspect = isnan(p->frame_aspect_ratio) ? width / height : p->frame_aspect_ratio;
    if (!(aspect > 0) || !isfinite(aspect))
        return sr_fail(error, SR_ERROR_INPUT, "frameaspectratio %g must be positive", (double)aspect);
    float half_x = aspect > 1 ? aspect : 1, half_y = aspect > 1 ? 1 : 1 / aspect;
    float window[4] = {-half_x, half_x, -half_y, half_y};
    if (p->screen_window.count == 4)
        memcpy(window, p->screen_window.data, sizeof window);
    else if (p->screen_window.count != 0)
        return sr_fail(error, SR_ERROR_INPUT, "screenwindow has four numbers x0 x1 y0 y1, not %u",
                       (unsigned)p->screen_window.count);
    if (window[0] == window[1] || window[2] == window[3])
        return sr_fail(error, SR_ERROR_INPUT, "screenwindow is empty");
    p->x0 = window[0];
    p->x_step = (window[1] - window[0]) / width;
    p->y0 = window[3];
    p->y_step = (window[2] - window[3]) / height;
    return SR_OK;
}
