/* SPDX-License-Identifier: MIT */
/* A wide field around the view direction in one disk: what glare is judged from. y is up, z forward.
 *
 *     r = 1 at the rim, theta_m = fov / 2 from the axis there:
 *     equidistant    theta = r theta_m                               (angular; Radiance's -vta)
 *     equisolid      sin(theta/2) = r sin(theta_m/2)                 all pixels see the same solid angle
 *     orthographic   sin theta = r sin theta_m              all pixels weigh alike in the illuminance (Radiance's -vth)
 *     stereographic  tan(theta/2) = r tan(theta_m/2)                 keeps shapes (Radiance's -vts)
 *
 * The disk touches the shorter sides of the picture. Light comes to three pixels beyond the rim, so that those which
 * the rim cuts tell the mean of what they see, and to none further out. The solid angle of a pixel is the integral
 * along its border
 *
 *     Omega = CLOSED INTEGRAL (1 - cos theta) dphi [sr],    Omega_p = CLOSED INTEGRAL 1/2 sin^2 theta dphi [sr]
 *
 * (Green's theorem for what depends on r alone), constant beyond the rim: sums over pixels have no error of quadrature.
 * K. Miyamoto, Fish eye lens, 1964. */
#include "sensor/private.h"

#include <stdlib.h>

static const double half_pi = 1.57079632679489662;

/* ---- the projection ---- */

double sr_fisheye_angle(enum sr_fisheye kind, double r, double rim)
{
    switch (kind) {
    case SR_FISHEYE_EQUIDISTANT:
        return r * rim;
    case SR_FISHEYE_EQUISOLID:
        return 2 * asin(fmin(1, r * sin(rim / 2)));
    case SR_FISHEYE_ORTHOGRAPHIC:
        return asin(fmin(1, r * sin(rim)));
    case SR_FISHEYE_STEREOGRAPHIC:
        return 2 * atan(r * tan(rim / 2));
    }
    return 0;
}

/* 1 - cos theta, and sin^2 theta / 2, at the squared radius */
static void caps(enum sr_fisheye kind, double r2, double rim, double out[2])
{
    double s;
    switch (kind) {
    case SR_FISHEYE_EQUIDISTANT: {
        double half = sin(sqrt(r2) * rim / 2);
        s = half * half;
        break;
    }
    case SR_FISHEYE_EQUISOLID:
        s = r2 * sin(rim / 2) * sin(rim / 2);
        break;
    case SR_FISHEYE_ORTHOGRAPHIC: {
        double sin2 = r2 * sin(rim) * sin(rim);
        s = sin2 / (2 * (1 + sqrt(fmax(0, 1 - sin2)))); // (1 - sqrt(1 - sin2)) / 2
        break;
    }
    default: {
        double t2 = r2 * tan(rim / 2) * tan(rim / 2);
        s = t2 / (1 + t2);
    }
    }
    out[0] = 2 * s;
    out[1] = 2 * s * (1 - s); // s = sin^2(theta/2)
}

/* What a piece of a straight line that does not cross the rim adds to both integrals. */
static void add_piece(enum sr_fisheye kind, double rim, const double a[2], const double b[2], double sum[2])
{
    static const double node[3] = {0, 0.5384693101056831, 0.9061798459386640},
                        weight[3] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    double cross = a[0] * b[1] - a[1] * b[0], g[2];
    if (cross == 0)
        return;
    double mx = (a[0] + b[0]) / 2, my = (a[1] + b[1]) / 2;
    if (mx * mx + my * my >= 1) {
        caps(kind, 1, rim, g);
        double phi = atan2(cross, a[0] * b[0] + a[1] * b[1]);
        sum[0] += g[0] * phi;
        sum[1] += g[1] * phi;
        return;
    }
    for (int k = -2; k <= 2; ++k) {
        double t = 0.5 + 0.5 * (k < 0 ? -node[-k] : node[k]), x = a[0] + t * (b[0] - a[0]),
               y = a[1] + t * (b[1] - a[1]), r2 = x * x + y * y;
        caps(kind, r2, rim, g);
        double share = r2 > 1e-24 ? 0.5 * weight[abs(k)] * cross / r2 : 0; // dphi = cross dt / r^2
        sum[0] += share * g[0];
        sum[1] += share * g[1];
    }
}

static void add_edge(enum sr_fisheye kind, double rim, const double a[2], const double b[2], double sum[2])
{
    // where |a + t (b - a)| = 1
    double d[2] = {b[0] - a[0], b[1] - a[1]}, A = d[0] * d[0] + d[1] * d[1], B = a[0] * d[0] + a[1] * d[1],
           C = a[0] * a[0] + a[1] * a[1] - 1;
    double cut[4] = {0, 1, 1, 1}, root = B * B - A * C;
    int n = 1;
    if (root > 0 && A > 0)
        for (int side = -1; side <= 1; side += 2) {
            double t = (-B + side * sqrt(root)) / A;
            if (t > 0 && t < 1)
                cut[n++] = t;
        }
    cut[n] = 1;
    for (int k = 0; k < n; ++k) {
        double from[2] = {a[0] + cut[k] * d[0], a[1] + cut[k] * d[1]},
               to[2] = {a[0] + cut[k + 1] * d[0], a[1] + cut[k + 1] * d[1]};
        add_piece(kind, rim, from, to, sum);
    }
}

void sr_fisheye_pixel(enum sr_fisheye kind, double rim, struct sr_sensor_raster raster, uint32_t x, uint32_t y,
                      double *omega, double *projected)
{
    double scale = 2.0 / (raster.width < raster.height ? raster.width : raster.height);
    double x0 = (x - raster.width / 2.0) * scale, y0 = (y - raster.height / 2.0) * scale, x1 = x0 + scale,
           y1 = y0 + scale, sum[2] = {0, 0};
    const double corner[5][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}};
    double near_x = fmax(fmax(x0, -x1), 0), near_y = fmax(fmax(y0, -y1), 0);
    if (near_x * near_x + near_y * near_y < 1)
        for (int k = 0; k < 4; ++k)
            add_edge(kind, rim, corner[k], corner[k + 1], sum);
    *omega = fmax(0, sum[0]);
    *projected = rim > half_pi + 1e-6 ? (double)NAN : fmax(0, sum[1]);
}

bool sr_fisheye_direction(enum sr_fisheye kind, double rim, struct sr_sensor_raster raster, double x, double y,
                          double d[3])
{
    double scale = 2.0 / (raster.width < raster.height ? raster.width : raster.height);
    double u = (x - raster.width / 2.0) * scale, v = (raster.height / 2.0 - y) * scale, r = sqrt(u * u + v * v);
    if (r > 1 + 3 * scale)
        return false;
    double theta = sr_fisheye_angle(kind, r, rim), s = r > 0 ? sin(theta) / r : 0;
    d[0] = u * s;
    d[1] = v * s;
    d[2] = cos(theta);
    return true;
}

/* ---- the sensor ---- */

struct fisheye {
    struct sr_sensor_common common;
    int32_t mapping;
    float fov;  // [deg]
    double rim; // [rad]
    sr_vec3 origin;
};

static const struct sr_param params[] = {
    {SR_PARAM_ENUM, "mapping", "1", 0, 3, 0, offsetof(struct fisheye, mapping),
     "equidistant|equisolid|orthographic|stereographic"},
    {SR_PARAM_FLOAT, "fov", "deg", 1, 360, 180, offsetof(struct fisheye, fov), "angle across the disk"},
    SENSOR_SHUTTER_ROWS(struct fisheye),
    {0},
};

static sr_status prepare(void *self, struct sr_sensor_raster raster, const struct sr_transform *camera_to_world,
                         struct sr_arena *arena, struct sr_error *error)
{
    (void)arena;
    struct fisheye *s = self;
    sr_status status = sensor_common_prepare(&s->common, raster, camera_to_world, error);
    if (status != SR_OK)
        return status;
    float most = s->mapping == SR_FISHEYE_ORTHOGRAPHIC ? 180 : s->mapping == SR_FISHEYE_STEREOGRAPHIC ? 350 : 360;
    if (s->fov > most)
        return sr_fail(error, SR_ERROR_INPUT, "fov %g deg: this projection reaches %g deg at most", (double)s->fov,
                       (double)most);
    s->rim = (double)s->fov * half_pi / 180;
    s->origin = sr_transform_point(camera_to_world, (sr_vec3){0, 0, 0});
    return SR_OK;
}

static bool direction(const struct fisheye *s, double x, double y, sr_vec3 *out)
{
    double d[3];
    if (!sr_fisheye_direction((enum sr_fisheye)s->mapping, s->rim, s->common.raster, x, y, d))
        return false;
    *out =
        sr_normalize(sr_transform_vector(&s->common.camera_to_world, (sr_vec3){(float)d[0], (float)d[1], (float)d[2]}));
    return true;
}

static bool ray(const void *self, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out)
{
    (void)u_lens; // a point sees all: there is no lens
    const struct fisheye *s = self;
    sr_vec3 d, dx, dy;
    double x = (double)raster.x, y = (double)raster.y, half_x = s->common.raster.width / 2.0,
           half_y = s->common.raster.height / 2.0;
    if (!direction(s, x, y, &d))
        return false;
    // toward the middle, where there is a neighbour always
    double step_x = x < half_x ? 1 : -1, step_y = y < half_y ? 1 : -1;
    if (!direction(s, x + step_x, y, &dx))
        dx = d;
    if (!direction(s, x, y + step_y, &dy))
        dy = d;
    *out = (struct sr_sensor_ray){.ray = {.o = s->origin, .d = d, .time = u_time, .t_max = INFINITY},
                                  .dddx = sr_scale((float)step_x, sr_sub(dx, d)),
                                  .dddy = sr_scale((float)step_y, sr_sub(dy, d)),
                                  .weight = 1};
    return true;
}

const struct sr_sensor_model sr_sensor_fisheye = {
    .name = "fisheye", .params = params, .size = sizeof(struct fisheye), .prepare = prepare, .ray = ray};
