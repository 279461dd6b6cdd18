/* SPDX-License-Identifier: MIT */
/* All directions around a point, as an environment map has them. y is up, as for the other cameras.
 *
 *     equirectangular   theta = pi y / height from above, phi = 2 pi x / width:
 *                       d = (sin theta cos phi, cos theta, sin theta sin phi)
 *     equalarea         Clarberg's octahedral square (2008), its pole z turned to y: all pixels see alike [sr]
 *
 * Pixels for each solid angle: width height / (4 pi), or width height / (2 pi^2 sin theta). Limits: a point is seen
 * once, in the picture, also by pixels at its border whose wide filter reaches over it. */
#include "sensor/private.h"

enum { EQUAL_AREA, EQUIRECTANGULAR };

struct spherical {
    struct sr_sensor_common common;
    int32_t mapping;
    sr_vec3 origin;              // [m] in the world
    float inv_width, inv_height; // [1/pixel]
    float determinant;           // of world to camera: a transform that is no rotation squeezes solid angles
};

static const struct sr_param params[] = {
    {SR_PARAM_ENUM, "mapping", "1", 0, 1, 0, offsetof(struct spherical, mapping), "equalarea|equirectangular"},
    SENSOR_SHUTTER_ROWS(struct spherical),
    {0},
};

static sr_status prepare(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct spherical *s = self;
    sr_status status = sensor_common_prepare(&s->common, raster, camera_to_world, error);
    if (status != SR_OK)
        return status;
    s->origin = sr_transform_point(camera_to_world, (sr_vec3){0, 0, 0});
    s->inv_width = 1 / (float)raster.width;
    s->inv_height = 1 / (float)raster.height;
    const struct sr_transform *t = camera_to_world;
    sr_vec3 x = {t->inverse[0][0], t->inverse[0][1], t->inverse[0][2]},
            y = {t->inverse[1][0], t->inverse[1][1], t->inverse[1][2]},
            z = {t->inverse[2][0], t->inverse[2][1], t->inverse[2][2]};
    s->determinant = fabsf(sr_dot(x, sr_cross(y, z)));
    return SR_OK;
}

// outside the square the sphere goes on: over an edge, mirrored at the edge's middle
static sr_vec2 wrap_square(sr_vec2 p)
{
    if (p.x < 0 || p.x > 1)
        p = (sr_vec2){p.x < 0 ? -p.x : 2 - p.x, 1 - p.y};
    if (p.y < 0 || p.y > 1)
        p = (sr_vec2){1 - p.x, p.y < 0 ? -p.y : 2 - p.y};
    return p;
}

static sr_vec3 direction(const struct spherical *s, float x, float y)
{
    sr_vec2 p = {x * s->inv_width, y * s->inv_height};
    sr_vec3 d;
    if (s->mapping == EQUAL_AREA) {
        d = sr_equal_area_square_to_sphere(wrap_square(p));
    } else {
        float theta = SR_PI * p.y;
        d = sr_spherical_direction(sinf(theta), cosf(theta), 2 * SR_PI * p.x);
    }
    return sr_normalize(sr_transform_vector(&s->common.camera_to_world, (sr_vec3){d.x, d.z, d.y}));
}

static bool ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    (void)u_lens; // a point sees all: there is no lens
    const struct spherical *s = self;
    sr_vec3 d = direction(s, raster.x, raster.y);
    *out = (struct sr_sensor_ray){
        .ray = {.o = s->origin, .d = d, .time = u_time, .t_max = INFINITY},
        .dddx = sr_sub(direction(s, raster.x + 1, raster.y), d),
        .dddy = sr_sub(direction(s, raster.x, raster.y + 1), d),
        .weight = 1,
    };
    return true;
}

static float density(const void *self, sr_vec3 d, float distance, float time)
{
    (void)time;
    const struct spherical *s = self;
    sr_vec3 local = sr_inverse_vector(&s->common.camera_to_world, d);
    float length = sr_length(local), pixels = 1 / (s->inv_width * s->inv_height);
    float per_sr = s->mapping == EQUAL_AREA ? pixels * (SR_INV_PI / 4)
                                            : pixels * (SR_INV_PI * SR_INV_PI / 2) /
                                                  sr_max(sqrtf(sr_sqr(local.x) + sr_sqr(local.z)) / length, 1e-6f);
    return per_sr * s->determinant / (length * length * length * distance * distance);
}

static bool connect(const void *self, sr_vec3 p, float time, sr_vec2 u_lens, struct sr_sensor_view *view)
{
    (void)u_lens;
    const struct spherical *s = self;
    sr_vec3 to = sr_sub(p, s->origin);
    float distance = sr_length(to);
    if (!(distance > 0))
        return false;
    sr_vec3 w = sr_scale(1 / distance, to), local = sr_normalize(sr_inverse_vector(&s->common.camera_to_world, w));
    sr_vec2 square;
    if (s->mapping == EQUAL_AREA)
        square = sr_equal_area_sphere_to_square((sr_vec3){local.x, local.z, local.y});
    else
        square =
            (sr_vec2){sr_angle_of(local.z, local.x) * (0.5f * SR_INV_PI), acosf(sr_clamp(local.y, -1, 1)) * SR_INV_PI};
    *view = (struct sr_sensor_view){.p = s->origin,
                                    .wi = sr_neg(w),
                                    .distance = distance,
                                    .weight = density(self, w, distance, time),
                                    .raster = {square.x / s->inv_width, square.y / s->inv_height}};
    return view->weight < INFINITY;
}

const struct sr_sensor_model sr_sensor_spherical = {
    .name = "spherical",
    .params = params,
    .size = sizeof(struct spherical),
    .prepare = prepare,
    .ray = ray,
    .connect = connect,
    .density = density,
};
