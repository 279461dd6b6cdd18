/* SPDX-License-Identifier: MIT */
/* Any sensor, while it moves: its rays are made in its own space, and led into the world as it stands at their time.
 *
 *     o' = M(t) o,   d' ~ L(t) d,   weight' = weight |det N| / |N w|,   distance = |N w| distance',   N = L(t)^-1
 *
 * A tube of rays has the volume area times length; N changes the first by |det N| and the second by |N w|, w of unit
 * length, and so the area across by their ratio. Where one place of the lens sees a pixel at one time, all others do at
 * all times: lens and time are drawn independently. */
#include "sensor/private.h"

struct moving {
    struct sr_sensor_common common;
    struct sr_sensor still;
    struct sr_motion motion;
};

static sr_vec3 turned(const struct sr_transform *t, sr_vec3 d, sr_vec3 change, sr_vec3 unit)
{
    return sr_sub(sr_normalize(sr_transform_vector(t, sr_add(d, change))), unit);
}

static bool ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    const struct moving *s = self;
    struct sr_sensor_ray own;
    if (!s->still.model->ray(s->still.self, raster, u_lens, u_time, &own))
        return false;
    struct sr_transform t;
    sr_motion_at(&s->motion, u_time, &t);
    sr_vec3 d = sr_normalize(sr_transform_vector(&t, own.ray.d));
    *out = (struct sr_sensor_ray){
        .ray = {.o = sr_transform_point(&t, own.ray.o), .d = d, .time = u_time, .t_max = INFINITY},
        .dodx = sr_transform_vector(&t, own.dodx),
        .dody = sr_transform_vector(&t, own.dody),
        .dddx = turned(&t, own.ray.d, own.dddx, d),
        .dddy = turned(&t, own.ray.d, own.dddy, d),
        .weight = own.weight,
    };
    return true;
}

// of N
static float determinant(const struct sr_transform *t)
{
    const float(*n)[4] = t->inverse;
    sr_vec3 x = {n[0][0], n[0][1], n[0][2]}, y = {n[1][0], n[1][1], n[1][2]}, z = {n[2][0], n[2][1], n[2][2]};
    return fabsf(sr_dot(x, sr_cross(y, z)));
}

static float density(const void *self, sr_vec3 d, float distance, float time)
{
    const struct moving *s = self;
    struct sr_transform t;
    sr_motion_at(&s->motion, time, &t);
    sr_vec3 own = sr_inverse_vector(&t, d);
    float length = sr_length(own);
    return s->still.model->density(s->still.self, sr_scale(1 / length, own), length * distance, time) *
           determinant(&t) / length;
}

static bool connect(const void *self, sr_vec3 p, float time, sr_vec2 u_lens, struct sr_sensor_view *view)
{
    const struct moving *s = self;
    struct sr_transform t;
    sr_motion_at(&s->motion, time, &t);
    if (!s->still.model->connect(s->still.self, sr_inverse_point(&t, p), time, u_lens, view))
        return false;
    sr_vec3 wi = sr_transform_vector(&t, view->wi);
    float length = 1 / sr_length(wi); // of N w for the w of unit length in the world
    view->p = sr_transform_point(&t, view->p);
    view->wi = sr_scale(length, wi);
    view->distance /= length;
    view->weight *= determinant(&t) / length;
    return true;
}

/* Where paths from the lights cannot be told to the sensor that moves. */
static const struct sr_sensor_model moving_model = {.name = "moving",
                                                    .size = sizeof(struct moving),
                                                    .ray = ray,
                                                    .connect = connect,
                                                    .density = density},
                                    deaf_model = {.name = "moving", .size = sizeof(struct moving), .ray = ray};

sr_status sr_sensor_move(struct sr_sensor still, const struct sr_motion *motion, struct sr_arena *arena,
                         struct sr_sensor *out, struct sr_error *error)
{
    struct moving *s = sr_arena_alloc(arena, sizeof *s);
    if (!s)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a camera");
    *s = (struct moving){.common = *(const struct sr_sensor_common *)still.self, .still = still, .motion = *motion};
    s->common.camera_to_world = motion->start;
    *out = (struct sr_sensor){still.model->connect ? &moving_model : &deaf_model, s};
    return SR_OK;
}
