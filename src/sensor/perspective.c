/* SPDX-License-Identifier: MIT */
/* A pinhole, or a thin lens that is sharp in one plane.
 *
 *     d ~ k (x, y, 1 / k) - l / F,      k = tan(fov / 2)
 *
 * (x, y) on the screen [1], l on the lens [m], F the distance to the sharp plane [m]: all rays of one pixel meet in
 * F (k x, k y, 1). fov spans the image's shorter side. A ray brings its radiance with weight 1: the falloff of cos^4
 * that a flat film has is no part of this camera, its pixels are radiances. Cook, Porter & Carpenter 1984.
 *
 * Seen from a point at distance r, with the direction v = d0 + X dx + Y dy - l/F of a ray through raster (X, Y) and the
 * screen's normal n = dx x dy, on which v has the length K = n . v for all rays alike:
 *
 *     dw = |n . v| / |v|^3 dX dY = |n . w|^3 / K^2 dX dY,  w = v / |v|     so     weight = K^2 / (|n . w|^3 r^2) */
#include "sensor/private.h"

struct perspective {
    struct sr_sensor_common common;
    struct projection projection;
    float fov;                 // [deg] in the file
    sr_vec3 origin;            // [m] in the world
    sr_vec3 lens_x, lens_y;    // [m] from the lens' middle to its rim
    sr_vec3 d0, dx, dy;        // direction = d0 + x dx + y dy, x and y in pixels; length 1 along the camera's axis
    float inv_focal;           // [1/m]
    sr_vec3 n, dual_x, dual_y; // across the screen; and the coordinates along dx and dy
    float K;
};

#define OFFSET(member) offsetof(struct perspective, member)
static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "fov", "deg", 0, 180, 90, OFFSET(fov), "angle that the shorter side spans"},
    SENSOR_PROJECTION_ROWS(struct perspective),
    {0},
};

static sr_status prepare(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct perspective *s = self;
    sr_status status = sensor_common_prepare(&s->common, raster, camera_to_world, error);
    if (status == SR_OK)
        status = projection_prepare(&s->projection, raster, error);
    if (status != SR_OK)
        return status;
    if (!(s->fov > 0) || !(s->fov < 180))
        return sr_fail(error, SR_ERROR_INPUT, "fov is between 0 and 180 degrees, not %g", (double)s->fov);

    const struct projection *p = &s->projection;
    struct sensor_axes axes = sensor_axes(camera_to_world);
    float k = (float)tan((double)s->fov * (3.14159265358979323846 / 360));
    s->origin = axes.origin;
    s->d0 = sr_mad(sr_mad(axes.z, k * p->x0, axes.x), k * p->y0, axes.y);
    s->dx = sr_scale(k * p->x_step, axes.x);
    s->dy = sr_scale(k * p->y_step, axes.y);
    s->lens_x = sr_scale(p->lens_radius, axes.x);
    s->lens_y = sr_scale(p->lens_radius, axes.y);
    s->inv_focal = 1 / p->focal_distance;
    sensor_duals(s->dx, s->dy, &s->n, &s->dual_x, &s->dual_y);
    s->K = sr_dot(s->n, axes.z);
    return SR_OK;
}

// along d, which need not have unit length
static inline sr_vec3 origin(const struct perspective *s, sr_vec2 raster, sr_vec2 u_lens, sr_vec3 *d)
{
    *d = sr_mad(sr_mad(s->d0, raster.x, s->dx), raster.y, s->dy);
    if (!(s->projection.lens_radius > 0))
        return s->origin;
    sr_vec2 l = sr_warp_disk(u_lens);
    sr_vec3 lens = sr_add(sr_scale(l.x, s->lens_x), sr_scale(l.y, s->lens_y));
    *d = sr_mad(*d, -s->inv_focal, lens);
    return sr_add(s->origin, lens);
}

static bool bare_ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    sr_vec3 d, o = origin(self, raster, u_lens, &d);
    *out =
        (struct sr_sensor_ray){.ray = {.o = o, .d = sr_normalize(d), .time = u_time, .t_max = INFINITY}, .weight = 1};
    return true;
}

static bool ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    const struct perspective *s = self;
    sr_vec3 d, o = origin(s, raster, u_lens, &d), unit = sr_normalize(d);
    *out = (struct sr_sensor_ray){
        .ray = {.o = o, .d = unit, .time = u_time, .t_max = INFINITY},
        .dddx = sr_sub(sr_normalize(sr_add(d, s->dx)), unit),
        .dddy = sr_sub(sr_normalize(sr_add(d, s->dy)), unit),
        .weight = 1,
    };
    return true;
}

static float density(const void *self, sr_vec3 d, float distance, float time)
{
    (void)time;
    const struct perspective *s = self;
    float c = sr_dot(s->n, d);
    return c * s->K > 0 ? s->K * s->K / (fabsf(c * c * c) * distance * distance) : 0;
}

static bool connect(const void *self, sr_vec3 p, float time, sr_vec2 u_lens, struct sr_sensor_view *view)
{
    const struct perspective *s = self;
    sr_vec3 lens = {0, 0, 0};
    if (s->projection.lens_radius > 0) {
        sr_vec2 l = sr_warp_disk(u_lens);
        lens = sr_add(sr_scale(l.x, s->lens_x), sr_scale(l.y, s->lens_y));
    }
    sr_vec3 o = sr_add(s->origin, lens), to = sr_sub(p, o);
    float t = sr_dot(s->n, to) / s->K, distance = sr_length(to); // to = t v
    if (!(t > 0) || !(distance > 0))
        return false;
    sr_vec3 on_screen = sr_sub(sr_mad(sr_scale(1 / t, to), s->inv_focal, lens), s->d0), w = sr_scale(1 / distance, to);
    *view = (struct sr_sensor_view){.p = o,
                                    .wi = sr_neg(w),
                                    .distance = distance,
                                    .weight = density(self, w, distance, time),
                                    .raster = {sr_dot(s->dual_x, on_screen), sr_dot(s->dual_y, on_screen)}};
    return view->weight > 0 && view->weight < INFINITY;
}

const struct sr_sensor_model sr_sensor_perspective = {
    .name = "perspective",
    .params = params,
    .size = sizeof(struct perspective),
    .prepare = prepare,
    .ray = ray,
    .connect = connect,
    .density = density,
    .bare_ray = bare_ray,
};
