/* SPDX-License-Identifier: MIT */
/* Displaced meshes: where vertices go by closed form, that nothing tears, and how short the edges become. */
#include "import/import.h"
#include "import/pbrt/build.h"
#include "test.h"

static struct sr_import_result result;
static struct sr_error error;

static sr_status import(const char *text)
{
    static const char plane[] =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";
    char path[1024], ply[1024];
    struct sr_import_options options = {.threads = 1};
    snprintf(path, sizeof path, "%s/displace.pbrt", test_folder());
    snprintf(ply, sizeof ply, "%s/plane.ply", test_folder());
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_file_write(path, text, strlen(text), &error), SR_OK);
    EXPECT_EQUAL_INT(sr_file_write(ply, plane, sizeof plane - 1, &error), SR_OK);
    return sr_import_pbrt(path, &options, &result, NULL, &error);
}

#define HILL                                                                                                           \
    "Texture \"hill\" \"float\" \"bilerp\" \"float v00\" 0.5 \"float v10\" 1 \"float v01\" -0.25 \"float v11\" 2\n"
#define DISPLACED "Shape \"plymesh\" \"string filename\" \"plane.ply\" \"texture displacement\" \"hill\" "

TEST(a_plane_is_displaced_by_a_bilinear_texture)
{
    EXPECT_EQUAL_INT(import("WorldBegin\n" HILL "Scale 2 2 2\n" DISPLACED "\"float edgelength\" 0.1\n"), SR_OK);
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int i = 0; i < 2000; ++i) {
        float u = 0.001f + 0.998f * sr_rng_float(&rng), v = 0.001f + 0.998f * sr_rng_float(&rng);
        struct sr_ray ray = {.o = {2 * u, 2 * v, 10}, .d = {0, 0, -1}, .t_max = INFINITY};
        struct sr_hit hit;
        EXPECT(sr_raycast(result.scene, &ray, &hit));
        // v01 is at u = 0, v = 1; what is linear between vertices strays by the mixed derivative 1.75 times du dv / 4
        // at most
        double d = 0.5 * (1 - (double)u) * (1 - (double)v) + 1 * (double)u * (1 - (double)v) -
                   0.25 * (1 - (double)u) * (double)v + 2 * (double)u * (double)v;
        EXPECT_NEAR(hit.point.p.z, 2 * d, 2 * 1.75 * 0.05 * 0.05 / 4);
        // the normal of z(x, y) = 2 d(x / 2, y / 2)
        double du = 0.5 + 1.75 * (double)v, dv = -0.75 + 1.75 * (double)u, l = sqrt(1 + du * du + dv * dv);
        EXPECT_NEAR(hit.point.ns.x, -du / l, 0.06);
        EXPECT_NEAR(hit.point.ns.y, -dv / l, 0.06);
        EXPECT_NEAR(hit.point.uv.x, u, 1e-5);
    }
    sr_import_result_free(&result);
}

static uint64_t triangles_of(const char *text)
{
    if (import(text) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    uint64_t n = sr_scene_count(result.scene).triangles;
    sr_import_result_free(&result);
    return n;
}

TEST(edge_length_is_measured_in_the_world_and_scaled_by_the_option)
{
    EXPECT_EQUAL_INT(triangles_of("WorldBegin\n" HILL DISPLACED "\"float edgelength\" 1.5\n"), 2);
    EXPECT_EQUAL_INT(triangles_of("WorldBegin\n" HILL DISPLACED "\n"),
                     8); // halved at the diagonal, then at the edges of length 1
    EXPECT_EQUAL_INT(triangles_of("WorldBegin\n" HILL DISPLACED "\"float edgelength\" 0.75\n"), 8);
    EXPECT_EQUAL_INT(triangles_of("WorldBegin\n" HILL "Scale 2 2 2\n" DISPLACED "\"float edgelength\" 1.5\n"), 8);
    EXPECT_EQUAL_INT(triangles_of("Option \"float displacementedgescale\" 0.5\nWorldBegin\n" HILL DISPLACED
                                  "\"float edgelength\" 1.5\n"),
                     8);
    EXPECT_EQUAL_INT(
        triangles_of("WorldBegin\nShape \"plymesh\" \"string filename\" \"plane.ply\" \"float edgelength\" 0.1\n"),
        2); // a flat parallelogram
}

/* An octahedron stretched, with all uv alike, after displacement by a constant. */
static struct sr_ply_mesh displaced(float edge_length, float by)
{
    static const sr_vec3 P[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 3}, {0, 0, -3}};
    static const int32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    struct sr_ply_mesh ply = {.vertex_count = 6, .triangle_count = 8};
    ply.P = sr_arena_copy(&ply.memory, P, sizeof P);
    ply.uv = sr_arena_alloc(&ply.memory, 6 * sizeof(sr_vec2));
    ply.triangles = sr_arena_copy(&ply.memory, faces, sizeof faces);
    struct sr_transform to_world = sr_transform_scale((sr_vec3){2, 1, 1});
    struct sr_arena textures = {0};
    error = (struct sr_error){0};
    if (sr_pbrt_displace(&ply, &to_world, edge_length, sr_texture_constant_float(&textures, by), &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    sr_arena_free(&textures);
    return ply;
}

TEST(a_closed_mesh_stays_closed)
{
    struct sr_ply_mesh ply = displaced(0.4f, 0);
    const int32_t *c = ply.triangles;
    uint32_t n = 3 * ply.triangle_count;
    double longest = 0, area = 0;
    int single = 0;
    for (uint32_t h = 0; h < n; ++h) {
        int32_t a = c[h], b = c[h % 3 == 2 ? h - 2 : h + 1];
        int twins = 0;
        for (uint32_t k = 0; k < n; ++k)
            twins += c[k] == b && c[k % 3 == 2 ? k - 2 : k + 1] == a;
        single += twins != 1;
        sr_vec3 e = sr_sub(ply.P[b], ply.P[a]);
        e.x *= 2;
        longest = fmax(longest, (double)sr_length(e));
        if (h % 3 == 0)
            area +=
                0.5 * (double)sr_length(sr_cross(sr_sub(ply.P[c[h + 1]], ply.P[a]), sr_sub(ply.P[c[h + 2]], ply.P[a])));
    }
    EXPECT_EQUAL_INT(single, 0);
    EXPECT_EQUAL_INT(ply.vertex_count - n / 2 + n / 3, 2); // Euler
    EXPECT(longest < 0.4 && longest > 0.2);
    EXPECT_RELATIVE(area, 8 * 0.5 * sqrt(2 * 2 * 3 * 3 + 3 * 3 + 2 * 2), 1e-5);
    sr_ply_free(&ply);
}

TEST(vertices_move_along_their_normals)
{
    struct sr_ply_mesh before = displaced(0.5f, 0), after = displaced(0.5f, 0.25f);
    EXPECT_EQUAL_INT(before.vertex_count, after.vertex_count);
    for (uint32_t i = 0; i < before.vertex_count; ++i) {
        sr_vec3 d = sr_sub(after.P[i], before.P[i]);
        EXPECT_NEAR(sr_length(d), 0.25, 1e-6);
        EXPECT(sr_dot(d, before.P[i]) > 0);
    }
    const sr_vec3 first = sr_sub(after.P[0], before.P[0]);
    EXPECT_NEAR(first.x, 0.25, 1e-6); // by symmetry
    sr_ply_free(&before);
    sr_ply_free(&after);
}

static void expect_error(const char *text, const char *says)
{
    EXPECT(import(text) != SR_OK);
    if (!strstr(error.text, says))
        test_fail(__FILE__, __LINE__, "expected \"%s\" in \"%s\"", says, error.text);
}

TEST(what_is_wrong_with_displacement_is_told)
{
    expect_error("WorldBegin\n" HILL DISPLACED "\"float edgelength\" 0\n", "expected a positive number");
    expect_error("WorldBegin\n" HILL DISPLACED "\"float edgelength\" -1\n", "expected 0 or more");
    expect_error("WorldBegin\n" HILL DISPLACED "\"float edgelength\" 1e-6\n", "too short for this mesh");
    expect_error("WorldBegin\n" HILL DISPLACED "\"float edgelength\" 1e-30\n", "too short for this mesh");
    expect_error("WorldBegin\n" DISPLACED "\n", "hill");
    expect_error("Option \"float displacementedgescale\" 0\nWorldBegin\n", "expected one positive number");
    expect_error("Option \"string displacementedgescale\" \"x\"\nWorldBegin\n", "expected one positive number");
    struct sr_ply_mesh bare = {0};
    struct sr_transform here = sr_transform_identity();
    struct sr_error e = {0};
    EXPECT(sr_pbrt_displace(&bare, &here, 1, (struct sr_texture){0}, &e) == SR_ERROR_INPUT &&
           strstr(e.text, "texture coordinates"));
}
