/* SPDX-License-Identifier: MIT */
/* Geometry that makes no sense, or too much of it: built, counted, told by file and line, rendered to finite pixels. */
#include "test.h"

#include "import/import.h"
#include "render/render.h"

#include <math.h>

static char messages[4096];

static void hear(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    if (severity == SR_WARNING)
        snprintf(messages + strlen(messages), sizeof messages - strlen(messages), "%s\n", text);
}

static const char *write_file(const char *name, const void *data, size_t size)
{
    static char path[1024];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    if (sr_file_write(path, data, size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return path;
}

/* Reads, and renders a few pixels, all of which are finite. */
static struct sr_scene_counts try_scene(const char *text, uint64_t *duplicates)
{
    const char *path = write_file("scene.pbrt", text, strlen(text));
    struct sr_import_options options = {.threads = 1, .width = 8, .height = 6, .spp = 1};
    struct sr_import_result r;
    struct sr_error error = {0};
    struct sr_log log = {.write = hear};
    messages[0] = 0;
    if (sr_import_pbrt(path, &options, &r, &log, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&r);
    job.spp = 4;
    job.threads = 1;
    struct sr_film *film;
    struct sr_render_report report;
    EXPECT_EQUAL_INT(sr_render(&job, &film, &report, &error), SR_OK);
    EXPECT_EQUAL_INT(report.dropped, 0);
    struct sr_scene_counts counts = sr_scene_count(r.scene);
    if (duplicates)
        *duplicates = sr_scene_count_duplicates(r.scene);
    sr_film_destroy(film);
    sr_import_result_free(&r);
    return counts;
}

#define CAMERA "LookAt 0 0 5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40 WorldBegin\nLightSource \"infinite\"\n"

TEST(triangles_without_area_are_counted_and_told_by_line)
{
    struct sr_scene_counts c =
        try_scene(CAMERA "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 2 0 0 1e-30 0 0 0 1e-30 0] "
                         "\"integer indices\" [0 1 2  0 0 1  0 1 3  0 4 5]\nShape \"sphere\"\n",
                  NULL);
    EXPECT_EQUAL_INT(c.triangles, 4);
    EXPECT_EQUAL_INT(c.degenerate, 3); // two corners in one place, three on a line, an area below the least float
    EXPECT(strstr(messages, "scene.pbrt:3:1: trianglemesh: 3 of 4 primitives have no area, and no ray meets them\n"));
}

TEST(what_no_ray_meets_is_told_once_for_each_file_and_kind)
{
    char text[4096], *p = text;
    p += sprintf(p, CAMERA);
    for (int i = 0; i < 30; ++i) // every other one has its corners on a line
        p += sprintf(p, "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 %s]\n", i & 1 ? "2 0 0" : "0 1 0");
    static const char more[] = "Shape \"sphere\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 2 0 0]\n";
    write_file("more.pbrt", more, sizeof more - 1);
    sprintf(p, "Include \"more.pbrt\"\n");
    struct sr_scene_counts c = try_scene(text, NULL);
    EXPECT_EQUAL_INT(c.degenerate, 16);
    EXPECT(strstr(
        messages,
        "scene.pbrt:4:1: trianglemesh: 15 of 15 primitives have no area, and no ray meets them (of 15 shapes of this file; this is the first)\n"));
    EXPECT(strstr(messages, "more.pbrt:1:16: trianglemesh: 1 of 1 primitives have no area, and no ray meets them\n"));
    EXPECT(!strstr(messages, "beyond"));
    int lines = 0;
    for (const char *at = messages; (at = strchr(at, '\n')); ++at)
        ++lines;
    EXPECT_EQUAL_INT(lines, 2);
}

TEST(lights_without_area_shine_with_what_they_have)
{
    struct sr_scene_counts c =
        try_scene(CAMERA "AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 2 0 0] "
                         "\"integer indices\" [0 1 2  0 0 1  0 1 3]\n",
                  NULL);
    EXPECT_EQUAL_INT(c.degenerate, 2);
    c = try_scene(CAMERA "AreaLightSource \"diffuse\" Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 0 0 1 0 0]\n",
                  NULL);
    EXPECT_EQUAL_INT(c.degenerate, 1);
}

TEST(a_light_that_has_lost_all_its_triangles_is_dark)
{
    struct sr_scene_counts c = try_scene(
        CAMERA
        "AreaLightSource \"diffuse\" Scale 1e38 1 1 Shape \"trianglemesh\" \"point3 P\" [10 0 0 11 0 0 10 1 0]\n",
        NULL);
    EXPECT_EQUAL_INT(c.not_finite, 1);
    EXPECT_EQUAL_INT(c.triangles, 0);
}

TEST(triangles_too_large_for_the_ray_caster_are_counted)
{
    struct sr_scene_counts c =
        try_scene(CAMERA "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1e19 0 0 3e38 0 1e38] "
                         "\"integer indices\" [0 1 2  0 1 3  0 4 2]\n",
                  NULL);
    EXPECT_EQUAL_INT(c.too_large, 2);
    EXPECT(strstr(messages, "2 of 3 primitives reach beyond 1.844e+18 m"));
}

TEST(triangles_with_denormal_corners_are_there)
{
    struct sr_scene_counts c =
        try_scene(CAMERA "Shape \"trianglemesh\" \"point3 P\" [1e-40 -1e-42 1e-44 1 1e-41 0 0 1 1e-39]\n", NULL);
    EXPECT_EQUAL_INT(c.triangles, 1);
    EXPECT_EQUAL_INT(c.degenerate + c.too_large + c.not_finite, 0);
}

TEST(a_ply_mesh_loses_the_faces_whose_numbers_are_none)
{
    char file[2048];
    int n = snprintf(
        file, sizeof file,
        "ply\nformat binary_little_endian 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n");
    float P[6][5] = {{0, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 0, 1}, {NAN, 0, 0}, {0, INFINITY, 0}, {1, 1, 0, 1, 1}};
    int faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 4, 2}, {1, 5, 2}};
    memcpy(file + n, P, sizeof P);
    n += (int)sizeof P;
    for (int i = 0; i < 4; ++i) {
        file[n++] = 3;
        memcpy(file + n, faces[i], 12);
        n += 12;
    }
    write_file("holes.ply", file, (size_t)n);
    static const char *const around[] = {"", "AreaLightSource \"diffuse\" "};
    for (int i = 0; i < 2; ++i) {
        char text[1024];
        snprintf(text, sizeof text, CAMERA "%sShape \"plymesh\" \"string filename\" \"holes.ply\"\n", around[i]);
        struct sr_scene_counts c = try_scene(text, NULL);
        EXPECT_EQUAL_INT(c.triangles, 2);
        EXPECT_EQUAL_INT(c.not_finite, 2);
        EXPECT(strstr(messages, "2 of 4 primitives have numbers that are not finite"));
    }
}

TEST(copies_of_triangles_are_counted_in_any_order_of_their_corners)
{
    uint64_t duplicates;
    struct sr_scene_counts c = try_scene(CAMERA "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 -0 0 0 1 1 0] "
                                                "\"integer indices\" [0 1 2  2 0 1  1 0 2  3 1 2  1 4 2]\n",
                                         &duplicates);
    EXPECT_EQUAL_INT(c.triangles, 5);
    EXPECT_EQUAL_INT(duplicates, 3);
}

TEST(surfaces_in_one_plane_give_one_of_them)
{
    try_scene(
        CAMERA
        "Material \"diffuse\" Shape \"disk\" Shape \"disk\" \"float radius\" 2 Material \"dielectric\" Shape \"sphere\" Shape \"sphere\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0]\n",
        NULL);
}

TEST(nothing_at_all_is_a_scene)
{
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\n"
        "property list uchar int vertex_indices\nend_header\n";
    write_file("empty.ply", ply, sizeof ply - 1);
    struct sr_scene_counts c = try_scene("WorldBegin\n", NULL);
    EXPECT_EQUAL_INT(c.triangles + c.instances + c.lights, 0);
    EXPECT(strstr(messages, "the scene is empty"));
    c = try_scene(CAMERA "ObjectBegin \"o\" ObjectEnd ObjectInstance \"o\"\n", NULL);
    EXPECT_EQUAL_INT(c.instances, 0);
    struct sr_import_result r; // a mesh of nothing is a mistake
    struct sr_error error = {0};
    static const char text[] = CAMERA "Shape \"plymesh\" \"string filename\" \"empty.ply\"\n";
    EXPECT_EQUAL_INT(sr_import_pbrt(write_file("scene.pbrt", text, sizeof text - 1), NULL, &r, NULL, &error),
                     SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "scene.pbrt:3:1") && strstr(error.text, "at least one face"));
}

/* ---- many ---- */

/* What building costs of the processor; a ray finds its way through in time. */
static double build_s(const float *P, uint32_t vertices, const int32_t *indices, uint32_t corners)
{
    struct sr_scene *scene = sr_scene_create();
    struct sr_arena *arena = sr_scene_arena(scene);
    struct sr_error error = {0};
    struct sr_shape_mesh *m = sr_arena_alloc(arena, sizeof *m);
    m->P = (struct sr_slice){P, vertices};
    m->indices = (struct sr_slice){indices, corners};
    struct sr_shape_placement placement = {.object_to_world = sr_transform_identity()};
    EXPECT_EQUAL_INT(sr_shape_trianglemesh.prepare(m, &placement, arena, &error), SR_OK);
    struct sr_shape_def def = {.shape = {&sr_shape_trianglemesh, m},
                               .media = sr_arena_alloc(arena, sizeof(struct sr_media))};
    sr_scene_add_shape(scene, &def);
    double start_s = test_processor_s();
    EXPECT_EQUAL_INT(sr_scene_finish(scene, 1, SR_LIGHTS_BVH), SR_OK);
    double built_s = test_processor_s();
    struct sr_hit hit;
    struct sr_ray ray = {.o = {0.3f, 0.3f, 5}, .d = {0, 0, -1}, .t_max = INFINITY};
    sr_raycast(scene, &ray, &hit);
    EXPECT(test_processor_s() - built_s < 5);
    sr_scene_destroy(scene);
    return built_s - start_s;
}

static bool is_whole_effort(void)
{
    const char *effort = getenv("STERADIAN_TEST_EFFORT");
    return effort && atof(effort) >= 10;
}

/* Against as many small triangles side by side that share no corner, which is what copies are to a ray caster. */
TEST(a_million_triangles_in_one_place_are_built_as_fast_as_others)
{
    uint32_t n = is_slow_build() ? 20000 : is_whole_effort() ? 1000000 : 200000, side = (uint32_t)sqrt(n);
    n = side * side;
    float *P = malloc(sizeof(float) * 9 * n), T[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    int32_t *apart = malloc(sizeof(int32_t) * 3 * n), *same = malloc(sizeof(int32_t) * 3 * n);
    if (!P || !apart || !same)
        abort();
    for (uint32_t i = 0; i < 3 * n; ++i) {
        float x = (float)(i / 3 % side) + (i % 3 == 1 ? 0.9f : 0), y = (float)(i / 3 / side) + (i % 3 == 2 ? 0.9f : 0);
        P[3 * i] = x / (float)side, P[3 * i + 1] = y / (float)side,
              P[3 * i + 2] = 0.05f * sinf(0.1f * x) * cosf(0.2f * y);
        apart[i] = (int32_t)i;
        same[i] = (int32_t)(i % 3);
    }
    double normal = INFINITY, degenerate = INFINITY;
    for (int i = 0; i < 5; ++i) { // the best of each, one after the other, as the machine may be busy for a while
        normal = fmin(normal, build_s(P, 3 * n, apart, 3 * n));
        degenerate = fmin(degenerate, build_s(T, 3, same, 3 * n));
    }
    printf("[   NOTE   ] %u triangles: side by side %.3f s, in one place %.3f s\n", n, normal, degenerate);
    EXPECT(is_slow_build() || degenerate < 2 * normal);
    free(P);
    free(apart);
    free(same);
}

TEST(a_million_instances_are_built_in_memory_that_is_told)
{
    uint32_t n = is_slow_build() ? 2000 : is_whole_effort() ? 1000000 : 50000;
    size_t size = 100 + (size_t)n * 60;
    char *text = malloc(size), *p = text;
    EXPECT(text != NULL);
    p += sprintf(p, CAMERA "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ObjectEnd\n");
    for (uint32_t i = 0; i < n && (size_t)(p - text) + 100 < size; ++i)
        p += sprintf(p, "Translate %u 0 %d ObjectInstance \"o\"\n", i % 3, i % 2 ? 1 : -1);
    double start = sr_clock_s();
    struct sr_scene_counts c = try_scene(text, NULL);
    printf("[   NOTE   ] %llu instances: %.2f s, geometry %.0f B and acceleration %.0f B each\n",
           (unsigned long long)c.instances, sr_clock_s() - start, (double)c.geometry_B / (double)c.instances,
           (double)c.acceleration_B / (double)c.instances);
    EXPECT(c.geometry_B + c.acceleration_B < 2000 * c.instances + (64 << 20));
    free(text);
}
