/* SPDX-License-Identifier: MIT */
/* The camera that the file has, or one that sees all of it; and the film, as wide as the camera says.
 *
 * A camera of glTF looks along -z of its node, y up. yfov is the whole vertical angle; "fov" is that of the shorter
 * side. glTF 2.0, 3.10. */
#include "import/framing.h"
#include "import/gltf/gltf.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Width and height of the picture: 720 pixels on the shorter side, or what the options say. */
static double place_film(struct sr_gltf *g, double aspect)
{
    int32_t width = aspect >= 1 ? (int32_t)fmin(round(720 * aspect), 16384) : 720,
            height = aspect >= 1 ? 720 : (int32_t)fmin(round(720 / aspect), 16384);
    sr_compose_int(&g->c, "xresolution", width);
    sr_compose_int(&g->c, "yresolution", height);
    sr_compose_setting(&g->c, "Film", "rgb");
    uint32_t w = g->options->width ? g->options->width : (uint32_t)width,
             h = g->options->height ? g->options->height : (uint32_t)height;
    return (double)w / h;
}

static void put_fov(struct sr_gltf *g, double yfov, double aspect)
{
    double shorter = aspect >= 1 ? yfov : 2 * atan(tan(yfov / 2) * aspect);
    sr_compose_float(&g->c, "fov", (float)(shorter * 180 / pi));
}

/* The node's place without its scale; z turned around. */
static struct sr_transform looking(const double world[4][4])
{
    double m[4][4];
    memcpy(m, world, sizeof m);
    for (int j = 0; j < 3; ++j) {
        double length = sqrt(m[0][j] * m[0][j] + m[1][j] * m[1][j] + m[2][j] * m[2][j]), side = j == 2 ? -1 : 1;
        for (int i = 0; i < 3; ++i)
            m[i][j] *= length > 0 ? side / length : 0;
    }
    return sr_gltf_transform_of(m);
}

static bool place_own(struct sr_gltf *g, uint32_t node, const struct sr_gltf_at *camera)
{
    const char *type = sr_gltf_string(g, camera, "type");
    struct sr_gltf_at p = sr_gltf_object(g, camera, "perspective"), o = sr_gltf_object(g, camera, "orthographic");
    struct sr_transform to_world = looking((const double(*)[4])g->nodes[node].world);
    if (!sr_transform_is_valid(&to_world)) {
        sr_gltf_warn(g, camera, "its node is shrunk to nothing: the camera is not used");
        return false;
    }
    if (type && strcmp(type, "perspective") == 0 && p.json) {
        double aspect = sr_gltf_number(g, &p, "aspectRatio", 16.0 / 9, 1e-3, 1e3),
               yfov = sr_gltf_number(g, &p, "yfov", 0.8, 1e-4, pi - 1e-4);
        aspect = place_film(g, aspect);
        put_fov(g, yfov, aspect);
        sr_compose_camera(&g->c, "perspective", &to_world);
    } else if (type && strcmp(type, "orthographic") == 0 && o.json) {
        float *window = sr_pbrt_words(g->c.d, 4 * sizeof *window);
        double x = fabs(sr_gltf_number(g, &o, "xmag", 1, -1e30, 1e30)),
               y = fabs(sr_gltf_number(g, &o, "ymag", 1, -1e30, 1e30));
        if (!window || !(x > 0) || !(y > 0)) {
            sr_gltf_fail(g, &o, "expected xmag and ymag other than 0");
            return false;
        }
        place_film(g, fmin(fmax(x / y, 1e-3), 1e3));
        memcpy(window, (float[4]){(float)-x, (float)x, (float)-y, (float)y}, 4 * sizeof *window);
        sr_compose_floats(&g->c, SR_PBRT_FLOAT, "screenwindow", window, 4);
        sr_compose_camera(&g->c, "orthographic", &to_world);
    } else
        sr_gltf_fail(g, camera, "expected a \"type\", perspective or orthographic, and an object of that name");
    return sr_gltf_is_well(g);
}

/* By the name of the camera or its node, or by its number from 1. */
static bool is_meant(struct sr_gltf *g, const struct sr_gltf_at *node, const struct sr_gltf_at *camera, uint32_t number)
{
    const char *word = g->options->camera;
    char *end;
    if (!word)
        return number == 1;
    return strcmp(word, sr_gltf_name(g, camera)) == 0 || strcmp(word, sr_gltf_name(g, node)) == 0 ||
           (strtoul(word, &end, 10) == number && *word && !*end);
}

void sr_gltf_place_camera(struct sr_gltf *g, sr_vec3 *key)
{
    uint32_t count = sr_gltf_root_count(g, "cameras"), number = 0;
    bool is_placed = false;
    *key = sr_normalize((sr_vec3){-0.5f, 0.8f, 0.6f});
    for (uint32_t i = 0; i < g->node_count && sr_gltf_is_well(g); ++i) {
        struct sr_gltf_at node = sr_gltf_entry(g, "nodes", i);
        uint32_t camera1 = g->nodes[i].is_of_scene ? sr_gltf_index1(g, &node, "camera", count) : 0;
        if (!camera1)
            continue;
        struct sr_gltf_at camera = sr_gltf_entry(g, "cameras", camera1 - 1);
        ++number;
        bool is_chosen = !is_placed && is_meant(g, &node, &camera, number) && place_own(g, i, &camera);
        if (number <= 100)
            sr_log(g->c.d->log, SR_INFO, "%s: camera %u \"%s\"%s", g->c.path, number,
                   sr_gltf_name(g, *sr_gltf_name(g, &camera) ? &camera : &node), is_chosen ? ", used" : "");
        is_placed = is_placed || is_chosen;
    }
    if (g->options->camera && !is_placed && sr_gltf_is_well(g))
        sr_gltf_fail(g, NULL, "there is no camera \"%.60s\": the file has %u", g->options->camera, number);
    if (!is_placed && sr_gltf_is_well(g))
        *key = sr_frame_camera(&g->c, g->options, g->bounds, (sr_vec3){0, 1, 0});
}
