/* SPDX-License-Identifier: MIT */
/* Parallel rays: what is far looks as large as what is near.
 *
 *     o = (x, y, 0) + l,     d ~ (0, 0, 1) - l / F
 *
 * (x, y) on the screen [m], l on the lens [m], F the distance to the plane that is sharp [m]. A pixel is as large
 * across its rays wherever it looks: weight = 1 / |(dx x dy) . d|. */
#include "sensor/private.h"

struct orthographic {
    struct sr_sensor_common common;
    struct projection projection;
    sr_vec3 o0, dx, dy;        // [m] origin = o0 + x dx + y dy, x and y in pixels
    sr_vec3 lens_x, lens_y;    // [m] from the lens' middle to its rim
    sr_vec3 d;                 // [1] along the camera's axis
    float inv_focal;           // [1/m]
    sr_vec3 n, dual_x, dual_y; // across the screen; and the coordinates along dx and dy
};

static const struct sr_param params[] = {
    SENSOR_PROJECTION_ROWS(struct orthographic),
    {0},
};

static sr_status prepare(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct orthographic *s = self;
    sr_status status = sensor_common_prepare(&s->common, raster, camera_to_world, error);
    if (status == SR_OK)
        status = projection_prepare(&s->projection, raster, error);
    if (status != SR_OK)
        return status;

    const struct projection *p = &s->projection;
    struct sensor_axes axes = sensor_axes(camera_to_world);
    s->o0 = sr_mad(sr_mad(axes.origin, p->x0, axes.x), p->y0, axes.y);
    s->dx = sr_scale(p->x_step, axes.x);
    s->dy = sr_scale(p->y_step, axes.y);
    s->lens_x = sr_scale(p->lens_radius, axes.x);
    s->lens_y = sr_scale(p->lens_radius, axes.y);
    s->d = axes.z;
    s->inv_focal = 1 / p->focal_distance;
    sensor_duals(s->dx, s->dy, &s->n, &s->dual_x, &s->dual_y);
    return SR_OK;
}

static bool ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    const struct orthographic *s = self;
    sr_vec3 o = sr_mad(sr_mad(s->o0, raster.x, s->dx), raster.y, s->dy);
    sr_vec3 d = s->d;
    if (s->projection.lens_radius > 0) {
        sr_vec2 l = sr_warp_disk(u_lens);
        sr_vec3 lens = sr_add(sr_scale(l.x, s->lens_x), sr_scale(l.y, s->lens_y));
        o = sr_add(o, lens);
        d = sr_mad(d, -s->inv_focal, lens);
    }
    *out = (struct sr_sensor_ray){
        .ray = {.o = o, .d = sr_normalize(d), .time = u_time, .t_max = INFINITY},
        .dodx = s->dx,
        .dody = s->dy,
        .weight = 1,
    };
    return true;
}

static float density(const void *self, sr_vec3 d, float distance, float time)
{
    (void)time;
    (void)distance;
    const struct orthographic *s = self;
    return 1 / fabsf(sr_dot(s->n, d));
}

static bool connect(const void *self, sr_vec3 p, float time, sr_vec2 u_lens, struct sr_sensor_view *view)
{
    const struct orthographic *s = self;
    sr_vec3 lens = {0, 0, 0}, d = s->d;
    if (s->projection.lens_radius > 0) {
        sr_vec2 l = sr_warp_disk(u_lens);
        lens = sr_add(sr_scale(l.x, s->lens_x), sr_scale(l.y, s->lens_y));
        d = sr_mad(d, -s->inv_focal, lens);
    }
    float length = sr_length(d), t = sr_dot(s->n, sr_sub(p, s->o0)) / sr_dot(s->n, d); // p = o + t d
    if (!(t > 0) || !(length > 0))
        return false;
    sr_vec3 o = sr_mad(p, -t, d), on_screen = sr_sub(sr_sub(o, s->o0), lens), w = sr_scale(1 / length, d);
    *view = (struct sr_sensor_view){.p = o,
                                    .wi = sr_neg(w),
                                    .distance = t * length,
                                    .weight = density(self, w, t * length, time),
                                    .raster = {sr_dot(s->dual_x, on_screen), sr_dot(s->dual_y, on_screen)}};
    return view->weight < INFINITY;
}

const struct sr_sensor_model sr_sensor_orthographic = {
    .name = "orthographic",
    .params = params,
    .size = sizeof(struct orthographic),
    .prepare = prepare,
    .ray = ray,
    .connect = connect,
    .density = density,
};
