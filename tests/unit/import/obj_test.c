/* SPDX-License-Identifier: MIT */
/* OBJ, STL and PLY alone as scenes: what is drawn, and what is refused. */
#include "import/obj.h"

#include "import/polygon.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

static struct sr_arena data;
static struct sr_pbrt_description d;
static struct sr_error error;
static unsigned warnings;

static void count_warning(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    (void)text;
    warnings += severity == SR_WARNING;
}

static sr_status read_as(bool is_stl, const char *bytes, size_t size)
{
    static const struct sr_import_options nothing;
    struct sr_log log = {.write = count_warning};
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
    error = (struct sr_error){0};
    warnings = 0;
    return is_stl ? sr_stl_read_bytes("t.stl", bytes, size, &nothing, &data, &log, &d, &error)
                  : sr_obj_read_text("t.obj", bytes, size, &nothing, &data, &log, &d, &error);
}

static void release(void)
{
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}

static const struct sr_pbrt_param *param(size_t shape, const char *name)
{
    return sr_pbrt_find(&SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, shape)->entity.params, name);
}

/* the area of a shape [m^2], and as a vector, which folds would make smaller */
static double area_of(size_t shape, double *of_vector)
{
    const struct sr_pbrt_param *P = param(shape, "P"), *indices = param(shape, "indices");
    double area = 0, sum[3] = {0, 0, 0};
    for (uint32_t i = 0; i + 2 < indices->count; i += 3) {
        const float *a = P->floats + 3 * indices->ints[i], *b = P->floats + 3 * indices->ints[i + 1],
                    *c = P->floats + 3 * indices->ints[i + 2];
        double u[3], v[3], n[3];
        for (int k = 0; k < 3; ++k) {
            u[k] = (double)b[k] - (double)a[k];
            v[k] = (double)c[k] - (double)a[k];
        }
        for (int k = 0; k < 3; ++k) {
            n[k] = (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]) / 2;
            sum[k] += n[k];
        }
        area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    *of_vector = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    return area;
}

TEST(obj_quads_share_corners_that_agree)
{
    static const char text[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nf 1/1 2/1 3/1 4/1\nf 2/1 5/2 6/2 3/1\n";
    EXPECT(read_as(false, text, strlen(text)) == SR_OK);
    EXPECT_EQUAL_INT(d.shapes.count, 1);
    EXPECT_EQUAL_INT(param(0, "P")->count, 18);
    EXPECT_EQUAL_INT(param(0, "indices")->count, 12);
    EXPECT_EQUAL_INT(param(0, "uv")->count, 12);
    EXPECT(param(0, "N") == NULL);
    EXPECT_EQUAL_INT(d.lights.count, 1); // the sky
    EXPECT_EQUAL_TEXT(d.camera.model, "perspective");
    release();
}

TEST(obj_corners_with_two_normals_are_two_vertices)
{
    static const char text[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 2//2 4//2 3//2\n";
    EXPECT(read_as(false, text, strlen(text)) == SR_OK);
    EXPECT_EQUAL_INT(param(0, "P")->count, 18);
    EXPECT_EQUAL_INT(param(0, "N")->count, 18);
    release();
}

/* An L of area 3: a fan of its corners would fold over itself. */
TEST(obj_concave_polygons_are_cut_without_folds)
{
    static const char text[] = "v 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nf -6 -5 -4 -3 -2 -1\n";
    double of_vector;
    EXPECT(read_as(false, text, strlen(text)) == SR_OK);
    EXPECT_NEAR(area_of(0, &of_vector), 3, 1e-6);
    EXPECT_NEAR(of_vector, 3, 1e-6);
    EXPECT_EQUAL_INT(warnings, 0);
    release();
}

/* Stars of 5 to 100 points in any plane: area n sin(pi/n) r R. */
TEST(polygons_of_stars_keep_their_area)
{
    for (int n = 5; n <= 100; n += 19) {
        sr_vec3 P[200];
        int32_t corners[200];
        uint32_t triangles[3 * 198];
        int64_t budget = 100000000;
        double area = 0;
        for (int i = 0; i < 2 * n; ++i) {
            double r = i % 2 ? 0.4 : 1, a = i * 3.14159265358979 / n;
            double x = r * cos(a), y = r * sin(a);
            P[i] = (sr_vec3){(float)(0.6 * x), (float)(0.8 * x), (float)y};
            corners[i] = i;
        }
        EXPECT(sr_polygon_triangulate(P, corners, 1, 2 * (uint32_t)n, &budget, triangles));
        for (int i = 0; i < 2 * n - 2; ++i) {
            sr_vec3 a = P[triangles[3 * i]], b = P[triangles[3 * i + 1]], c = P[triangles[3 * i + 2]];
            area += (double)sr_length(sr_cross(sr_sub(b, a), sr_sub(c, a))) / 2;
        }
        EXPECT_NEAR(area, n * sin(3.14159265358979 / n) * 0.4, 1e-4);
    }
}

TEST(obj_groups_and_materials_make_shapes)
{
    static const char text[] =
        "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl nothing\nf 1 2 3\ng b c\nf 3 2 1\no a\nf 3 2 1 \\\n 2\n";
    EXPECT(read_as(false, text, strlen(text)) == SR_OK);
    EXPECT_EQUAL_INT(d.shapes.count, 2); // an unknown material is none
    EXPECT_EQUAL_TEXT(SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, 1)->name, "b c");
    EXPECT_EQUAL_INT(warnings, 1);
    release();
}

/* A library that is named again brings materials of names that are taken. Of long names all were once cut to one. */
TEST(obj_materials_of_one_name_get_names_of_their_own)
{
    char name[960], library[1024], path[600], text[8192] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    struct sr_error ignored = {0};
    memset(name, 'a', sizeof name);
    name[sizeof name - 1] = 0;
    snprintf(path, sizeof path, "%s/names.mtl", test_folder());
    int size = snprintf(library, sizeof library, "newmtl %s\nKd .1 .2 .3\n", name);
    EXPECT(sr_file_write(path, library, (size_t)size, &ignored) == SR_OK);
    for (int k = 0; k < 4; ++k) {
        size_t n = strlen(text);
        snprintf(text + n, sizeof text - n, "mtllib %s\nusemtl %s\nf 1 2 3\n", path, name);
    }
    EXPECT(read_as(false, text, strlen(text)) == SR_OK);
    EXPECT_EQUAL_INT(d.shapes.count, 4);
    EXPECT_EQUAL_INT(d.named_materials.count, 4);
    for (size_t i = 0; i < d.named_materials.count; ++i)
        for (size_t k = 0; k < i; ++k)
            EXPECT(strcmp(SR_PBRT_AT(d.named_materials, struct sr_pbrt_entity, i)->name,
                          SR_PBRT_AT(d.named_materials, struct sr_pbrt_entity, k)->name) != 0);
    release();
}

TEST(obj_that_is_wrong_is_refused_with_its_line)
{
    static const char *const bad[][2] = {
        {"", "not one face"},
        {"v 0 0 0\nf 1 1 1\n", "not one face"},
        {"v 0 0\n", "t.obj:1:1: v: expected 3 numbers"},
        {"v 0 0 1e99\n", "finite"},
        {"v 0 0 0\n\nf 1 2 3\n", "t.obj:3:1: f: 2 is no vertex"},
        {"v 0 0 0\nf 0 1 1\n", "f: 0 is no vertex"},
        {"v 0 0 0\nf -2 1 1\n", "f: -2 is no vertex"},
        {"v 0 0 0\nf 1/1 1/1 1/1\n", "texture coordinate"},
        {"v 0 0 0\nf 1//9 1 1\n", "normal"},
        {"v 0 0 0\nf 1x 1 1\n", "expected corners such as"},
        {"v 0 0 0\nf 99999999999999999999 1 1\n", "is no vertex"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        EXPECT(read_as(false, bad[i][0], strlen(bad[i][0])) == SR_ERROR_INPUT);
        if (!strstr(error.text, bad[i][1]))
            test_fail(__FILE__, __LINE__, "\"%s\" was expected in: %s", bad[i][1], error.text);
    }
    release();
}

static void put_float(char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    for (int i = 0; i < 4; ++i)
        to[i] = (char)(bits >> 8 * i & 255);
}

TEST(stl_binary_and_ascii_are_one_mesh)
{
    static const float P[2][9] = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, 0, 0, 1, 1, 0, 0, 1, 0}};
    static const char text[] =
        "solid quad\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 1 0 0\n vertex 1 1 0\nvertex -0 1 0\nendloop\nendfacet\nendsolid\n";
    char binary[185] = "solid, though it is not text"; // as some programs write it
    binary[80] = 2;
    for (int t = 0; t < 2; ++t)
        for (int k = 0; k < 9; ++k)
            put_float(binary + 84 + 50 * t + 12 + 4 * k, P[t][k]);
    double of_vector;
    EXPECT(read_as(true, binary, 184) == SR_OK);
    EXPECT_EQUAL_INT(param(0, "P")->count, 12);
    EXPECT_NEAR(area_of(0, &of_vector), 1, 1e-6);
    EXPECT(read_as(true, text, strlen(text)) == SR_OK);
    EXPECT_EQUAL_INT(param(0, "P")->count, 12);
    EXPECT_NEAR(area_of(0, &of_vector), 1, 1e-6);
    EXPECT(read_as(true, binary, 183) == SR_ERROR_INPUT); // cut
    put_float(binary + 100, INFINITY);
    EXPECT(read_as(true, binary, 184) == SR_ERROR_INPUT);
    EXPECT(read_as(true, "solid\nvertex 1 2 3\n", 19) == SR_ERROR_INPUT);
    EXPECT(read_as(true, "solid\nvertex 1 2\n", 17) == SR_ERROR_INPUT);
    EXPECT(read_as(true, "xyz", 3) == SR_ERROR_INPUT);
    release();
}
