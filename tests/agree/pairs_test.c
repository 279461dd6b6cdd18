/* SPDX-License-Identifier: MIT */
/* A mesh that the ray caster gets by pairs and the same one in an order that has none are met at the same points. */
#include "agree/render_helper.h"

#include <string.h>

enum { RINGS = 64, QUADS = 2 * RINGS * RINGS, RAYS = 20000 };

/* A bumpy ball of some 16000 triangles with holes by an alpha texture; in the second order no triangle follows a
 * neighbour. In one that is `odd` each 17th quad lacks a half, which is another mesh's. */
static const char *make_ball(const char *name, bool is_paired, bool is_odd)
{
    size_t size = 1 << 21, used;
    char *text = sr_alloc(size);
    used = (size_t)snprintf(
        text, size,
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\n"
        "Texture \"holes\" \"float\" \"checkerboard\" \"float uscale\" 3 \"float vscale\" 3 \"float tex1\" 0 \"float tex2\" 1\n");
    for (int part = 0; part < (is_odd ? 2 : 1); ++part) {
        used += (size_t)snprintf(text + used, size - used, "Shape \"trianglemesh\" %s \"point3 P\" [",
                                 is_odd ? "\"texture alpha\" \"holes\"" : "");
        for (int i = 0; i <= RINGS; ++i)
            for (int k = 0; k < 2 * RINGS; ++k) {
                double theta = M_PI * i / RINGS, phi = M_PI * k / RINGS, r = 1 + 0.05 * sin(9 * theta) * cos(6 * phi),
                       s = i == 0 || i == RINGS ? 0 : sin(theta);
                used += (size_t)snprintf(text + used, size - used, "%.6g %.6g %.6g ", r * s * cos(phi),
                                         r * s * sin(phi), r * cos(theta));
            }
        used += (size_t)snprintf(text + used, size - used, "] \"integer indices\" [");
        for (int pass = 0; pass < (is_paired ? 1 : 2); ++pass)
            for (int q = 0; q < QUADS; ++q) {
                int i = q / (2 * RINGS), k = q % (2 * RINGS), a = i * 2 * RINGS + k,
                    b = i * 2 * RINGS + (k + 1) % (2 * RINGS), c = a + 2 * RINGS, d = b + 2 * RINGS;
                bool has_first = part == 0 && (is_paired || pass == 0),
                     has_second = (is_paired || pass == 1) && (is_odd && q % 17 == 0 ? part == 1 : part == 0);
                if (has_first)
                    used += (size_t)snprintf(text + used, size - used, "%d %d %d ", c, d, a);
                if (has_second)
                    used += (size_t)snprintf(text + used, size - used, "%d %d %d ", a, d, b);
            }
        used += (size_t)snprintf(text + used, size - used, "]\n");
    }
    EXPECT(used < size);
    const char *path = scene_file(name, text);
    sr_free(text);
    return path;
}

static bool close(sr_vec3 a, sr_vec3 b, float tolerance)
{
    return sr_length(sr_sub(a, b)) <= tolerance;
}

static void expect_same_hits(bool is_odd)
{
    struct sr_import_result scenes[2];
    struct sr_error error = {0};
    for (int k = 0; k < 2; ++k)
        if (!import_scene(make_ball(k ? "scattered.pbrt" : "paired.pbrt", k == 0, is_odd), NULL, &scenes[k], &error))
            test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_scene_counts paired = sr_scene_count(scenes[0].scene), scattered = sr_scene_count(scenes[1].scene);
    EXPECT_EQUAL_INT(paired.triangles, scattered.triangles);
    EXPECT(paired.acceleration_B <
           scattered.acceleration_B * 3 / 4); // else the pairs were not used, and this test shows nothing
    struct sr_rng rng = sr_rng_seed(5, 1);
    int met = 0, apart = 0, leaks = 0;
    for (int r = 0; r < RAYS; ++r) {
        sr_vec3 o =
            sr_scale(r % 2 ? 3 : 0.5f, sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}));
        sr_vec3 target = sr_scale(0.9f, sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)}));
        struct sr_ray ray = {.o = o, .d = sr_normalize(sr_sub(target, o)), .t_max = INFINITY};
        struct sr_hit x, y;
        bool hits = sr_raycast(scenes[0].scene, &ray, &x), hits_too = sr_raycast(scenes[1].scene, &ray, &y);
        leaks += !is_odd && r % 2 == 0 && !hits;
        met += hits;
        ray.t_max = 10;
        // a ray along an edge may meet either side of it
        apart += hits != hits_too || sr_is_free(scenes[0].scene, &ray) == hits ||
                 (hits && !(close(x.point.p, y.point.p, 1e-5f) && close(x.point.n, y.point.n, 1e-3f) &&
                            close(x.point.dpdu, y.point.dpdu, 1e-3f) &&
                            fabsf(x.point.uv.x - y.point.uv.x) + fabsf(x.point.uv.y - y.point.uv.y) < 1e-3f));
    }
    EXPECT(met > RAYS / 2);
    EXPECT_EQUAL_INT(leaks, 0);
    if (apart > RAYS / 1000)
        test_fail(__FILE__, __LINE__, "%d of %d rays differ", apart, RAYS);
    for (int k = 0; k < 2; ++k)
        sr_import_result_free(&scenes[k]);
}

TEST(pairs_are_met_where_triangles_are)
{
    expect_same_hits(false);
}

TEST(pairs_and_single_triangles_with_holes_are_too)
{
    expect_same_hits(true);
}
