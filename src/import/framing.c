/* SPDX-License-Identifier: MIT */
/* A camera that sees a box whole: it stands so far back that each corner lies within the picture's pyramid.
 *
 *     distance = max over corners c of  c.back + max(|c.right| / tan(x/2), |c.up| / tan(y/2))       [m]
 *
 * with c from the middle of the box; 5 % are left on each side. The sky, k being to the upper left of the camera:
 *
 *     L(w) = 0.25 + 0.5 (1 + w.up) / 2 + 3 exp(12 (w.k - 1))      [cd/m^2] */
#include "import/framing.h"

#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double fov = 40; // [deg] of the shorter side

sr_vec3 sr_frame_camera(struct sr_compose *c, const struct sr_import_options *o, struct sr_box bounds, sr_vec3 up)
{
    enum { WIDTH = 1280, HEIGHT = 720 };
    sr_compose_int(c, "xresolution", WIDTH);
    sr_compose_int(c, "yresolution", HEIGHT);
    sr_compose_setting(c, "Film", "rgb");
    float aspect = (float)(o->width ? o->width : WIDTH) / (float)(o->height ? o->height : HEIGHT),
          t = 0.95f * (float)tan(fov / 2 * pi / 180);
    float ty = aspect >= 1 ? t : t / aspect, tx = aspect >= 1 ? t * aspect : t;
    bool is_empty = sr_box_is_empty(bounds), is_z = up.z > 0.5f;
    sr_vec3 centre = is_empty ? (sr_vec3){0, 0, 0} : sr_box_centre(bounds),
            half = is_empty ? (sr_vec3){1, 1, 1} : sr_scale(0.5f, sr_box_diagonal(bounds));
    sr_vec3 back = sr_normalize(is_z ? (sr_vec3){0.3f, -1, 0.25f} : (sr_vec3){0.3f, 0.25f, 1}),
            right = sr_normalize(sr_cross(up, back)), above = sr_cross(back, right);
    float distance = 1e-6f;
    for (int k = 0; k < 8; ++k) {
        sr_vec3 corner = {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z};
        distance = sr_max(distance, sr_dot(corner, back) +
                                        sr_max(fabsf(sr_dot(corner, right)) / tx, fabsf(sr_dot(corner, above)) / ty));
    }
    sr_vec3 eye = sr_mad(centre, distance, back);
    float m[4][4] = {{right.x, above.x, -back.x, eye.x},
                     {right.y, above.y, -back.y, eye.y},
                     {right.z, above.z, -back.z, eye.z},
                     {0, 0, 0, 1}};
    struct sr_transform to_world = sr_transform_from_matrix((const float(*)[4])m);
    if (!sr_transform_is_valid(&to_world)) {
        sr_compose_fail(c, SR_ERROR_INPUT, "no camera can see all of it: from (%g, %g, %g) to (%g, %g, %g) m",
                        (double)bounds.lo.x, (double)bounds.lo.y, (double)bounds.lo.z, (double)bounds.hi.x,
                        (double)bounds.hi.y, (double)bounds.hi.z);
        return up;
    }
    sr_compose_float(c, "fov", (float)fov);
    sr_compose_camera(c, "perspective", &to_world);
    sr_log(c->d->log, SR_INFO, "%s: has no camera: one at (%g, %g, %g) m sees all of it", c->path, (double)eye.x,
           (double)eye.y, (double)eye.z);
    return sr_normalize(sr_add(sr_add(back, sr_scale(-0.6f, right)), sr_scale(0.9f, above)));
}

/* An equal-area octahedral map as PFM, whose rows begin at the bottom. */
void sr_frame_sky(struct sr_compose *c, sr_vec3 key, sr_vec3 up)
{
    enum { SIDE = 64 };
    char head[32];
    int length = snprintf(head, sizeof head, "PF\n%d %d\n-1.0\n", SIDE, SIDE);
    size_t size = (size_t)length + SIDE * SIDE * 3 * sizeof(float);
    char *bytes = sr_arena_alloc(&c->d->words, size);
    if (!bytes) {
        sr_fail(c->error, SR_ERROR_RESOURCE, "%s: not enough memory", c->path);
        return;
    }
    memcpy(bytes, head, (size_t)length);
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            sr_vec3 w = sr_equal_area_square_to_sphere((sr_vec2){((float)x + 0.5f) / SIDE, ((float)y + 0.5f) / SIDE});
            float L = 0.25f + 0.25f * (1 + sr_dot(w, up)) + 3 * expf(12 * (sr_dot(w, key) - 1)), rgb[3] = {L, L, L};
            memcpy(bytes + length + (size_t)((SIDE - 1 - y) * SIDE + x) * sizeof rgb, rgb, sizeof rgb);
        }
    const char *slash = strrchr(c->path, '/'), *name = sr_compose_printf(c, "%s#sky.pfm", slash ? slash + 1 : c->path);
    sr_compose_file(c, name, bytes, size);
    sr_compose_string(c, "filename", name);
    sr_compose_light(c, "infinite");
    sr_log(c->d->log, SR_INFO,
           "%s: has no lights of its own: lit by a grey sky of 0.25 to 0.75 cd/m^2, with a bright region of 3 cd/m^2",
           c->path);
}
