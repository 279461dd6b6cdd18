/* SPDX-License-Identifier: MIT */
/* glTF files made here: what each feature becomes, and what bad files are told. */
#include "test.h"

#include "import/gltf/gltf.h"
#include "import/import.h"

#include <stdio.h>
#include <string.h>

/* ---- files ---- */

static uint8_t buffer[4096];
static size_t buffer_size;
static char notes[8192];

static size_t put(const void *data, size_t size) // its offset
{
    size_t at = buffer_size;
    memcpy(buffer + at, data, size);
    buffer_size = (at + size + 3) / 4 * 4;
    return at;
}
#define PUT(type, ...) put((const type[]){__VA_ARGS__}, sizeof((const type[]){__VA_ARGS__}))

static const char *base64(void)
{
    static char text[8192];
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t n = 0;
    for (size_t i = 0; i < buffer_size; i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < buffer_size ? buffer[i + k] : 0);
        for (int k = 0; k < 4; ++k)
            text[n++] = i + (size_t)k > buffer_size ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    text[n] = 0;
    return text;
}

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    if (severity == SR_WARNING && strlen(notes) + strlen(text) + 2 < sizeof notes)
        strcat(strcat(notes, text), "\n");
}

/* The text with the buffer in it as "buffers", and one view of all of it, number 0. */
static const char *with_buffer(const char *rest)
{
    static char text[20000];
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:application/octet-stream;base64,%s\"}],%s}",
             buffer_size, base64(), rest);
    return text;
}

static struct sr_arena data;
static struct sr_error error;
static struct sr_pbrt_description d;

static sr_status read_text(const char *text)
{
    static const struct sr_import_options none;
    struct sr_log log = {.write = note};
    notes[0] = 0;
    error = (struct sr_error){0};
    return sr_gltf_read_bytes("m.gltf", text, strlen(text), &none, &data, &log, &d, &error);
}

static void describe(const char *rest)
{
    if (read_text(with_buffer(rest)) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

static void done(void)
{
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
    buffer_size = 0;
}

static void expect_error(const char *rest, const char *message)
{
    EXPECT_EQUAL_INT(read_text(with_buffer(rest)), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, message);
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}

static const struct sr_pbrt_shape *shape(size_t i)
{
    EXPECT(i < d.shapes.count);
    return SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, i);
}

static const float *floats_of(size_t i, const char *name, uint32_t count)
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&shape(i)->entity.params, name);
    EXPECT(p && p->floats && p->count == count);
    return p->floats;
}

static sr_vec3 placed(size_t i, uint32_t vertex) // in the world
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&shape(i)->entity.params, "P");
    const float *P = p->floats + 3 * (size_t)vertex;
    EXPECT(3 * vertex + 2 < p->count);
    struct sr_transform to_world = sr_matrix_to_transform(&SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, shape(i)->entity.transform)->start);
    return sr_transform_point(&to_world, (sr_vec3){P[0], P[1], P[2]});
}

static const struct sr_pbrt_param *material_param(const char *material, const char *name)
{
    uint32_t index1 = sr_pbrt_names_find(&d.material_names, material);
    EXPECT(index1 != 0);
    return sr_pbrt_find(&SR_PBRT_AT(d.named_materials, struct sr_pbrt_entity, index1 - 1)->params, name);
}

/* a triangle of three positions at the buffer's start: accessor 0, view 0 */
static void put_triangle(void)
{
    buffer_size = 0;
    PUT(float, 0, 0, 0, 1, 0, 0, 0, 1, 0);
}
#define VIEWS "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}"
#define ACCESSORS "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
#define TRIANGLE VIEWS "]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"
#define SHOWN "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]"

/* ---- buffers ---- */

TEST(gltf_base64_and_percent)
{
    uint8_t out[16];
    EXPECT(sr_gltf_base64("TWFu", 4, out) == 3 && memcmp(out, "Man", 3) == 0);
    EXPECT(sr_gltf_base64("TWE=", 4, out) == 2 && memcmp(out, "Ma", 2) == 0);
    EXPECT(sr_gltf_base64("TQ==", 4, out) == 1 && out[0] == 'M');
    EXPECT(sr_gltf_base64("T", 1, out) == SIZE_MAX && sr_gltf_base64("T*Fu", 4, out) == SIZE_MAX);
    struct sr_arena arena = {0};
    EXPECT_EQUAL_TEXT(sr_gltf_unescape(&arena, "a%20b%C3%A9.bin"), "a b\xc3\xa9.bin");
    EXPECT(!sr_gltf_unescape(&arena, "a%2") && !sr_gltf_unescape(&arena, "%zz") && !sr_gltf_unescape(&arena, "%00"));
    sr_arena_free(&arena);
}

TEST(gltf_binary_file)
{
    const char *json = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36}]," TRIANGLE "," SHOWN "}  ";
    float P[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t length = (uint32_t)strlen(json) / 4 * 4, total = 12 + 8 + length + 8 + 36;
    char file[2048];
    uint32_t head[5] = {0x46546c67, 2, total, length, 0x4e4f534a}, chunk[2] = {36, 0x004e4942};
    memcpy(file, head, 20);
    memcpy(file + 20, json, length);
    memcpy(file + 20 + length, chunk, 8);
    memcpy(file + 28 + length, P, 36);
    static const struct sr_import_options none;
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_gltf_read_bytes("m.glb", file, total, &none, &data, NULL, &d, &error), SR_OK);
    EXPECT_NEAR(placed(0, 1).x, 1, 0);
    sr_pbrt_description_free(&d);
    for (uint32_t cut = 0; cut < total; cut += 7) { // never more than a message
        error = (struct sr_error){0};
        EXPECT(sr_gltf_read_bytes("m.glb", file, cut, &none, &data, NULL, &d, &error) == SR_ERROR_INPUT && error.text[0]);
        sr_pbrt_description_free(&d);
    }
    done();
}

TEST(gltf_sparse_accessor_replaces_elements)
{
    put_triangle();
    size_t indices = PUT(uint16_t, 2), values = PUT(float, 7, 8, 9);
    char rest[1024];
    snprintf(rest, sizeof rest,
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":2},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":12}],"
                   "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":1,"
                   "\"indices\":{\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":2}}}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
             indices, values);
    describe(rest);
    EXPECT_NEAR(placed(0, 1).x, 1, 0);
    EXPECT_NEAR(placed(0, 2).x, 7, 0);
    EXPECT_NEAR(placed(0, 2).z, 9, 0);
    done();
}

TEST(gltf_strides_and_quantized_positions)
{
    buffer_size = 0; // position as normalised shorts, then four bytes of something else
    PUT(int16_t, 0, 0, 0, 0, 99, 99, 32767, 0, 0, 0, 99, 99, 0, -32768, 16384, 0, 99, 99);
    describe("\"bufferViews\":[{\"buffer\":0,\"byteLength\":36,\"byteStride\":12}],"
             "\"accessors\":[{\"bufferView\":0,\"componentType\":5122,\"normalized\":true,\"count\":3,\"type\":\"VEC3\"}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN);
    EXPECT_NEAR(placed(0, 1).x, 1, 0);
    EXPECT_NEAR(placed(0, 2).y, -1, 0); // -32768 is -1 as well
    EXPECT_NEAR(placed(0, 2).z, 16384 / 32767.0, 1e-7);
    done();
}

TEST(gltf_strips_and_fans_keep_their_side)
{
    for (int mode = 5; mode <= 6; ++mode) {
        buffer_size = 0;
        if (mode == 5)
            PUT(float, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0);
        else
            PUT(float, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0);
        char rest[1024];
        snprintf(rest, sizeof rest,
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],"
                 "\"meshes\":[{\"primitives\":[{\"mode\":%d,\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
                 mode);
        describe(rest);
        const struct sr_pbrt_param *p = sr_pbrt_find(&shape(0)->entity.params, "indices");
        EXPECT_EQUAL_INT(p->count, 6);
        for (int t = 0; t < 2; ++t) {
            sr_vec3 a = placed(0, (uint32_t)p->ints[3 * t]), b = placed(0, (uint32_t)p->ints[3 * t + 1]), c = placed(0, (uint32_t)p->ints[3 * t + 2]);
            EXPECT_NEAR(sr_cross(sr_sub(b, a), sr_sub(c, a)).z, 1, 1e-6);
        }
        done();
    }
}

TEST(gltf_keeps_only_vertices_that_are_used)
{
    buffer_size = 0;
    PUT(float, 9, 9, 9, 0, 0, 0, 1, 0, 0, 9, 9, 9, 0, 1, 0);
    size_t indices = PUT(uint8_t, 1, 2, 4);
    char rest[1024];
    snprintf(rest, sizeof rest,
             "\"bufferViews\":[{\"buffer\":0,\"byteLength\":60},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":3}],"
             "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]," SHOWN,
             indices);
    describe(rest);
    const float *P = floats_of(0, "P", 9);
    EXPECT(P[3] == 1 && P[7] == 1);
    done();
}

TEST(gltf_points_and_lines_are_told)
{
    put_triangle();
    describe(VIEWS "]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":0}},{\"attributes\":{\"POSITION\":0}}]}]," SHOWN);
    EXPECT_EQUAL_INT(d.shapes.count, 1);
    EXPECT_EQUAL_TEXT(notes, "m.gltf: /meshes/0/primitives/0: points have no surface and are left out\n");
    done();
}

/* ---- nodes ---- */

TEST(gltf_nodes_inherit_places)
{
    put_triangle();
    describe(TRIANGLE ",\"nodes\":[{\"children\":[1],\"translation\":[0,0,5],\"scale\":[2,2,2]},"
                      "{\"mesh\":0,\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],\"translation\":[1,0,0]}],\"scenes\":[{\"nodes\":[0]}]");
    sr_vec3 p = placed(0, 1); // (1,0,0) turned to (0,1,0), moved to (1,1,0), doubled, raised
    EXPECT_NEAR(p.x, 2, 1e-6);
    EXPECT_NEAR(p.y, 2, 1e-6);
    EXPECT_NEAR(p.z, 5, 1e-6);
    done();
}

TEST(gltf_mesh_of_two_nodes_is_an_object)
{
    put_triangle();
    describe(TRIANGLE ",\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[3,0,0]}],\"scenes\":[{\"nodes\":[0,1]}]");
    EXPECT_EQUAL_INT(d.shapes.count, 1);
    EXPECT_EQUAL_INT(d.instances.count, 2);
    EXPECT_EQUAL_INT(shape(0)->object1, 1);
    const struct sr_pbrt_instance *second = SR_PBRT_AT(d.instances, struct sr_pbrt_instance, 1);
    EXPECT_NEAR(SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, second->transform)->start.m[0][3], 3, 0);
    done();
}

/* Three meshes of the same accessors, 3000 triangles of the one corner (accessors without a view are zeros), in two materials. */
static void describe_one_form(const char *second_material)
{
    char rest[4096];
    put_triangle();
    snprintf(rest, sizeof rest,
             VIEWS "]," ACCESSORS ",{\"componentType\":5123,\"count\":9000,\"type\":\"SCALAR\"}],"
                   "\"materials\":[{},{%s}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]},"
                   "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]},"
                   "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":1}]}],"
                   "\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"translation\":[3,0,0]},{\"mesh\":2,\"translation\":[6,0,0]}],\"scenes\":[{\"nodes\":[0,1,2]}]",
             second_material);
    describe(rest);
}

TEST(gltf_meshes_of_the_same_accessors_are_objects_that_are_like_one_another)
{
    describe_one_form("\"pbrMetallicRoughness\":{\"metallicFactor\":0}");
    EXPECT_EQUAL_INT(d.shapes.count, 3);
    EXPECT_EQUAL_INT(d.instances.count, 3);
    EXPECT(floats_of(0, "P", 3) == floats_of(2, "P", 3)); // the very same
    for (uint32_t i = 0; i < 3; ++i)
        EXPECT_EQUAL_INT(SR_PBRT_AT(d.objects, struct sr_pbrt_object, i)->like1, i ? 1 : 0);
    EXPECT(strcmp(shape(0)->material.name, shape(2)->material.name) != 0);
    done();
}

TEST(gltf_meshes_that_glow_stand_for_themselves)
{
    describe_one_form("\"emissiveFactor\":[1,1,1]");
    EXPECT_EQUAL_INT(d.shapes.count, 3);
    EXPECT_EQUAL_INT(d.instances.count, 0); // two are left of one form, which saves less than it costs
    done();
}

TEST(gltf_instances_of_one_node)
{
    put_triangle();
    size_t at = PUT(float, 1, 0, 0, 2, 0, 0, 3, 0, 0);
    char rest[1024];
    snprintf(rest, sizeof rest,
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":36}]," ACCESSORS ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"translation\":[10,0,0],"
                   "\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":1}}}}],\"scenes\":[{\"nodes\":[0]}]",
             at);
    describe(rest);
    EXPECT_EQUAL_INT(d.instances.count, 3);
    const struct sr_pbrt_instance *last = SR_PBRT_AT(d.instances, struct sr_pbrt_instance, 2);
    EXPECT_NEAR(SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, last->transform)->start.m[0][3], 13, 0);
    done();
}

TEST(gltf_refuses_circles_of_nodes)
{
    put_triangle();
    expect_error(TRIANGLE ",\"nodes\":[{\"children\":[1]},{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]",
                 "m.gltf: /nodes/0: is below more than one node, or below itself");
    done();
}

/* What rays meet: the outside of a mirrored triangle is where it was. */
TEST(gltf_mirrored_node_keeps_its_outside)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/mirrored.gltf", test_folder());
    for (int mirrored = 0; mirrored < 2; ++mirrored) {
        put_triangle();
        struct sr_import_result result;
        struct sr_error e = {0};
        const char *text = with_buffer(mirrored ? TRIANGLE ",\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,1]}],\"scenes\":[{\"nodes\":[0]}]" : TRIANGLE "," SHOWN);
        EXPECT_EQUAL_INT(sr_file_write(path, text, strlen(text), &e), SR_OK);
        EXPECT_EQUAL_INT(sr_import_pbrt(path, NULL, &result, NULL, &e), SR_OK);
        struct sr_ray ray = {.o = {mirrored ? -0.2f : 0.2f, 0.2f, 4}, .d = {0, 0, -1}, .t_max = INFINITY};
        struct sr_hit hit;
        EXPECT(sr_raycast(result.scene, &ray, &hit));
        EXPECT_NEAR(hit.point.n.z, 1, 1e-6);
        sr_import_result_free(&result);
    }
    done();
}

/* ---- poses ---- */

TEST(gltf_skin_moves_vertices)
{
    put_triangle();
    size_t joints = PUT(uint8_t, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0), weights = PUT(float, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0);
    size_t bind = PUT(float, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1);
    char rest[2048];
    snprintf(rest, sizeof rest,
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":12},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":128}]," ACCESSORS
                   ",{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"},{\"bufferView\":2,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"},"
                   "{\"bufferView\":3,\"componentType\":5126,\"count\":2,\"type\":\"MAT4\"}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}}]}],"
                   "\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":3}],"
                   "\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[100,0,0]},{\"translation\":[0,0,3],\"children\":[2]},{\"translation\":[0,1,0],\"scale\":[2,2,2]}],"
                   "\"scenes\":[{\"nodes\":[0,1]}]",
             joints, weights, bind);
    describe(rest);
    // joint 0 lifts by 3; joint 1, bound at (0,1,0), doubles about it and lifts by 3; the mesh's own node counts for nothing
    EXPECT_NEAR(placed(0, 0).z, 3, 1e-6);
    EXPECT_NEAR(placed(0, 0).x, 0, 1e-6);
    EXPECT_NEAR(placed(0, 1).x, 0.5 * 1 + 0.5 * 2, 1e-6);
    EXPECT_NEAR(placed(0, 1).y, 0.5 * 0 + 0.5 * -1, 1e-6);
    EXPECT_NEAR(placed(0, 2).y, 1, 1e-6);
    EXPECT_NEAR(placed(0, 2).z, 3, 1e-6);
    done();
}

TEST(gltf_morph_targets_add)
{
    put_triangle();
    size_t target = PUT(float, 0, 0, 1, 0, 0, 2, 0, 0, 4);
    for (int own = 0; own < 2; ++own) {
        char rest[1024];
        snprintf(rest, sizeof rest,
                 VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":36}]," ACCESSORS ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
                       "\"meshes\":[{\"weights\":[0.25],\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":1}]}]}],"
                       "\"nodes\":[{\"mesh\":0%s}],\"scenes\":[{\"nodes\":[0]}]",
                 target, own ? ",\"weights\":[0.5]" : "");
        describe(rest);
        EXPECT_NEAR(placed(0, 2).z, own ? 2 : 1, 1e-6);
        sr_pbrt_description_free(&d);
    }
    done();
}

/* ---- lights and cameras ---- */

/* Illuminance at p on a surface that faces the only light [lx]. */
static double illuminance(const struct sr_scene *scene, sr_vec3 p)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    EXPECT_EQUAL_INT(lights->count, 1);
    struct sr_point x = {.p = p, .n = {0, 0, 1}, .ns = {0, 0, 1}};
    double sum = 0;
    for (int nm = 360; nm < 830; nm += SR_LAMBDA_COUNT) {
        struct sr_wavelengths w = {0};
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            w.lambda[k] = (float)(nm + k);
        struct sr_light_sample s;
        if (!sr_light_draw(lights->lights[0], &x, (sr_vec2){0.5f, 0.5f}, &w, &s))
            return 0;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
            double xyz[3];
            sr_observer_1931(nm + k, xyz);
            sum += (double)(s.L[k] / s.pdf) * xyz[1];
        }
    }
    return sum;
}

static double lit(const char *light, sr_vec3 p)
{
    char path[1024], rest[1024];
    put_triangle();
    snprintf(path, sizeof path, "%s/light.gltf", test_folder());
    snprintf(rest, sizeof rest,
             TRIANGLE ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[%s]}},\"nodes\":[{\"mesh\":0},{\"translation\":[5,5,5],\"scale\":[3,3,3],"
                      "\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\"scenes\":[{\"nodes\":[0,1]}]",
             light);
    const char *text = with_buffer(rest);
    struct sr_import_result result;
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_file_write(path, text, strlen(text), &e), SR_OK);
    EXPECT_EQUAL_INT(sr_import_pbrt(path, NULL, &result, NULL, &e), SR_OK);
    double E = illuminance(result.scene, p);
    sr_import_result_free(&result);
    buffer_size = 0;
    return E;
}

TEST(gltf_lights_are_in_candela_and_lux)
{
    EXPECT_NEAR(lit("{\"type\":\"point\",\"intensity\":100}", (sr_vec3){5, 5, 3}), 25, 25e-4);
    EXPECT_NEAR(lit("{\"type\":\"point\",\"intensity\":100}", (sr_vec3){5, 9, 5}), 100 / 16.0, 1e-3);
    EXPECT_NEAR(lit("{\"type\":\"directional\",\"intensity\":321}", (sr_vec3){-7, 2, 1}), 321, 0.03);
    // along -z, whatever the node's scale; 30 degrees off the axis between cones of 20 and 40 there is some, at 50 there is none
    const char *spot = "{\"type\":\"spot\",\"intensity\":100,\"spot\":{\"innerConeAngle\":0.3490658504,\"outerConeAngle\":0.6981317008}}";
    EXPECT_NEAR(lit(spot, (sr_vec3){5, 5, 3}), 25, 25e-4);
    double between = lit(spot, (sr_vec3){5 + 2 * 0.57735027f, 5, 3});
    EXPECT(between > 1 && between < 18);
    EXPECT_NEAR(lit(spot, (sr_vec3){5 + 2 * 1.1917536f, 5, 3}), 0, 0);
    EXPECT_NEAR(lit(spot, (sr_vec3){5, 5, 7}), 0, 0);
    // a colour is a factor
    EXPECT_NEAR(lit("{\"type\":\"point\",\"intensity\":100,\"color\":[0.5,0.5,0.5]}", (sr_vec3){5, 5, 3}), 12.5, 0.05);
}

TEST(gltf_cameras)
{
    put_triangle();
    const char *camera = TRIANGLE ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1.0,\"aspectRatio\":0.5,\"znear\":0.1}},"
                                  "{\"name\":\"flat\",\"type\":\"orthographic\",\"orthographic\":{\"xmag\":4,\"ymag\":2,\"znear\":0,\"zfar\":9}}],"
                                  "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"translation\":[0,0,6],\"scale\":[2,2,2]},{\"camera\":1}],\"scenes\":[{\"nodes\":[0,1,2]}]";
    describe(camera);
    float fov = 0;
    int32_t width = 0, height = 0;
    EXPECT(sr_pbrt_get_float(&d, &d.camera.params, "fov", &fov, &error) == SR_OK);
    EXPECT_NEAR(fov, 2 * atan(tan(0.5) / 2) * 180 / 3.14159265358979, 1e-4); // of the shorter side, the width
    EXPECT(sr_pbrt_get_int(&d, &d.film.params, "xresolution", &width, &error) == SR_OK && width == 720);
    EXPECT(sr_pbrt_get_int(&d, &d.film.params, "yresolution", &height, &error) == SR_OK && height == 1440);
    struct sr_transform to_camera = sr_matrix_to_transform(&SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, d.camera.transform)->start);
    sr_vec3 p = sr_transform_point(&to_camera, (sr_vec3){1, 2, 0}); // x right, y up, six metres ahead
    EXPECT_NEAR(p.x, 1, 1e-6);
    EXPECT_NEAR(p.y, 2, 1e-6);
    EXPECT_NEAR(p.z, 6, 1e-6);
    sr_pbrt_description_free(&d);

    struct sr_import_options options = {.camera = "flat"};
    error = (struct sr_error){0};
    const char *text = with_buffer(camera);
    EXPECT_EQUAL_INT(sr_gltf_read_bytes("m.gltf", text, strlen(text), &options, &data, NULL, &d, &error), SR_OK);
    EXPECT_EQUAL_TEXT(d.camera.model, "orthographic");
    const struct sr_pbrt_param *window = sr_pbrt_find(&d.camera.params, "screenwindow");
    EXPECT(window && window->count == 4 && window->floats[0] == -4 && window->floats[3] == 2);
    sr_pbrt_description_free(&d);
    options.camera = "none";
    EXPECT_EQUAL_INT(sr_gltf_read_bytes("m.gltf", text, strlen(text), &options, &data, NULL, &d, &error), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "m.gltf: there is no camera \"none\": the file has 2");
    done();
}

TEST(gltf_without_light_and_camera_gets_both)
{
    put_triangle();
    describe(TRIANGLE "," SHOWN);
    EXPECT_EQUAL_INT(d.lights.count, 1);
    EXPECT_EQUAL_TEXT(SR_PBRT_AT(d.lights, struct sr_pbrt_light, 0)->entity.model, "infinite");
    struct sr_transform camera = sr_matrix_to_transform(&SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, d.camera.transform)->start), *to_camera = &camera;
    for (uint32_t i = 0; i < 3; ++i) { // all of it in front, inside of 40 degrees
        sr_vec3 p = sr_transform_point(to_camera, placed(0, i));
        EXPECT(p.z > 0 && fabsf(p.y) < p.z * 0.364f && fabsf(p.x) < p.z * 0.364f * 16 / 9);
    }
    done();
}

/* ---- materials ---- */

#define IMAGE "\"images\":[{\"uri\":\"t%%20.png\"}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648,\"magFilter\":9728}],\"textures\":[{\"source\":0,\"sampler\":0}]"

static void put_textured(const char *material)
{
    static char rest[3000];
    put_triangle();
    size_t uv = PUT(float, 0, 0, 1, 0, 0, 1);
    snprintf(rest, sizeof rest,
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":24}]," ACCESSORS ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":0}]}]," IMAGE ",\"materials\":[%s]," SHOWN,
             uv, material);
    describe(rest);
}

static const struct sr_pbrt_entity *texture_of(const struct sr_pbrt_param *p, bool is_float)
{
    EXPECT(p && p->type == SR_PBRT_TEXTURE);
    uint32_t index1 = sr_pbrt_names_find(is_float ? &d.float_textures : &d.spectrum_textures, p->strings[0]);
    EXPECT(index1 != 0);
    return &SR_PBRT_AT(d.textures, struct sr_pbrt_texture, index1 - 1)->entity;
}

static const char *text_of(const struct sr_pbrt_entity *e, const char *name)
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&e->params, name);
    return p ? p->strings[0] : "";
}

TEST(gltf_metallic_roughness_textures)
{
    put_textured("{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.25,1],\"baseColorTexture\":{\"index\":0},\"metallicFactor\":0.5,"
                 "\"metallicRoughnessTexture\":{\"index\":0}}}");
    const struct sr_pbrt_entity *base = texture_of(material_param("material0", "base_color"), false);
    EXPECT_EQUAL_TEXT(text_of(base, "filename"), "t .png");
    EXPECT_EQUAL_TEXT(text_of(base, "swrap"), "clamp");
    EXPECT_EQUAL_TEXT(text_of(base, "twrap"), "mirror");
    EXPECT_EQUAL_TEXT(text_of(base, "filter"), "point");
    EXPECT_NEAR(sr_pbrt_find(&base->params, "factor")->floats[2], 0.25, 0);
    const struct sr_pbrt_entity *metal = texture_of(material_param("material0", "base_metalness"), true);
    EXPECT_EQUAL_TEXT(text_of(metal, "channel"), "b");
    EXPECT_EQUAL_TEXT(text_of(metal, "encoding"), "linear");
    EXPECT_NEAR(sr_pbrt_find(&metal->params, "scale")->floats[0], 0.5, 0);
    EXPECT_EQUAL_TEXT(text_of(texture_of(material_param("material0", "specular_roughness"), true), "channel"), "g");
    const float *uv = floats_of(0, "uv", 6); // v upward
    EXPECT(uv[1] == 1 && uv[5] == 0);
    done();
}

TEST(gltf_texture_transform)
{
    put_textured("{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":"
                 "{\"offset\":[0.1,0.2],\"rotation\":0.5235987755982988,\"scale\":[2,3]}}}}}");
    const float *m = sr_pbrt_find(&texture_of(material_param("material0", "base_color"), false)->params, "transform")->floats;
    // (u, v) = (0.3, 0.6) of the file: scaled to (0.6, 1.8), turned by 30 degrees, moved
    double s = 0.6 * sqrt(0.75) + 1.8 * 0.5 + 0.1, t = -0.6 * 0.5 + 1.8 * sqrt(0.75) + 0.2, u = 0.3, v = 1 - 0.6;
    EXPECT_NEAR((double)m[0] * u + (double)m[1] * v + (double)m[2], s, 1e-6);
    EXPECT_NEAR(1 - ((double)m[3] * u + (double)m[4] * v + (double)m[5]), t, 1e-6);
    done();
}

TEST(gltf_emission_is_an_area_light)
{
    put_textured("{\"emissiveFactor\":[1,0.5,0],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":40}},\"doubleSided\":true}");
    EXPECT_EQUAL_INT(shape(0)->area_light1, 1);
    const struct sr_pbrt_entity *light = SR_PBRT_AT(d.area_lights, struct sr_pbrt_entity, 0);
    const struct sr_pbrt_param *L = sr_pbrt_find(&light->params, "L"), *sides = sr_pbrt_find(&light->params, "twosided");
    EXPECT(L && L->floats[0] == 40 && L->floats[1] == 20 && L->floats[2] == 0 && sides && sides->ints[0]);
    done();
}

TEST(gltf_alpha_modes)
{
    put_textured("{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.3,\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.8],\"baseColorTexture\":{\"index\":0}}}");
    const struct sr_pbrt_entity *mask = texture_of(sr_pbrt_find(&shape(0)->entity.params, "alpha"), true);
    EXPECT_EQUAL_TEXT(mask->model, "threshold");
    EXPECT_NEAR(sr_pbrt_find(&mask->params, "cutoff")->floats[0], 0.3f, 0);
    const struct sr_pbrt_entity *alpha = texture_of(sr_pbrt_find(&mask->params, "tex"), true);
    EXPECT_EQUAL_TEXT(text_of(alpha, "channel"), "a");
    EXPECT_NEAR(sr_pbrt_find(&alpha->params, "scale")->floats[0], 0.8f, 0);
    sr_pbrt_description_free(&d);
    put_textured("{\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.25]}}");
    const struct sr_pbrt_entity *blend = texture_of(sr_pbrt_find(&shape(0)->entity.params, "alpha"), true);
    EXPECT_EQUAL_TEXT(blend->model, "constant");
    sr_pbrt_description_free(&d);
    put_textured("{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.25]}}"); // opaque
    EXPECT(!sr_pbrt_find(&shape(0)->entity.params, "alpha"));
    done();
}

TEST(gltf_vertex_colours_give_each_triangle_its_vertices)
{
    put_triangle();
    size_t colours = PUT(uint8_t, 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 51);
    char rest[1024];
    snprintf(rest, sizeof rest,
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":12}]," ACCESSORS ",{\"bufferView\":1,\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC4\"}],"
                   "\"materials\":[{\"alphaMode\":\"BLEND\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"COLOR_0\":1},\"material\":0}]}]," SHOWN,
             colours);
    describe(rest);
    EXPECT_EQUAL_TEXT(shape(0)->material.name, "material0.mesh0.0");
    const struct sr_pbrt_entity *colour = texture_of(material_param("material0.mesh0.0", "base_color"), false);
    EXPECT_EQUAL_TEXT(colour->model, "attribute");
    const struct sr_pbrt_param *values = sr_pbrt_find(&colour->params, "values");
    EXPECT(values->count == 12 && values->floats[0] == 1 && values->floats[5] == 1 && values->floats[10] == 1 && fabsf(values->floats[11] - 0.2f) < 1e-6f);
    const float *uv = floats_of(0, "uv", 6);
    EXPECT(uv[0] == 0 && uv[2] == 1 && uv[5] == 1);
    EXPECT(sr_pbrt_find(&shape(0)->entity.params, "alpha") != NULL);
    done();
}

/* ---- bad files ---- */

TEST(gltf_tells_where_a_file_is_wrong)
{
    put_triangle();
    expect_error("\"bufferViews\":[{\"buffer\":0,\"byteLength\":37}]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
                 "m.gltf: /bufferViews/0: bytes 0 to 37 of a buffer of 36");
    expect_error(VIEWS "],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
                 "m.gltf: /accessors/0: 4 elements end at byte 48 of a buffer view of 36");
    expect_error(VIEWS "],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":-1,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
                 "m.gltf: /accessors/0/count: expected a whole number from 0 to 2147483647");
    expect_error(VIEWS "]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]," SHOWN,
                 "m.gltf: /meshes/0/primitives/0/attributes/POSITION: index 1: there are 1");
    expect_error(VIEWS "]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":0}]}]," SHOWN,
                 "m.gltf: /accessors/0: has 3 numbers in an element: expected 1, as indices of /meshes/0/primitives/0");
    expect_error(TRIANGLE ",\"nodes\":[{\"mesh\":0,\"matrix\":[1,2]}],\"scenes\":[{\"nodes\":[0]}]", "m.gltf: /nodes/0/matrix: expected 16 numbers");
    expect_error(TRIANGLE ",\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]}]", "m.gltf: /scenes/0/nodes/0: index 1: there are 1");
    expect_error(TRIANGLE ",\"nodes\":{},\"scenes\":[{\"nodes\":[0]}]", "m.gltf: /nodes: expected a list");
    // zeros without a buffer, more than a small file may ask for
    expect_error("\"accessors\":[{\"componentType\":5126,\"count\":2000000000,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
                 "m.gltf: /meshes/0/primitives/0: asks for more than 50336848 bytes of memory, which is too much for a file of 325 bytes");
    done();
    EXPECT_EQUAL_INT(read_text("{\"asset\":{\"version\":\"1.0\"}}"), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "m.gltf: /asset: version \"1.0\" of glTF: expected 2.0");
    sr_pbrt_description_free(&d);
    EXPECT_EQUAL_INT(read_text("{\"asset\":"), SR_ERROR_INPUT);
    EXPECT(strncmp(error.text, "m.gltf:1:9: ", 12) == 0);
    done();
}

TEST(gltf_index_beyond_the_vertices)
{
    put_triangle();
    size_t indices = PUT(uint16_t, 0, 1, 3);
    char rest[1024];
    snprintf(rest, sizeof rest,
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":6}]," ACCESSORS ",{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]," SHOWN,
             indices);
    expect_error(rest, "m.gltf: /accessors/1: index 3 at place 2: there are 3 vertices");
    done();
}

/* ---- files of others ---- */

TEST(gltf_sample_models_load)
{
    static const char *const models[] = {"AlphaBlendModeTest/glTF/AlphaBlendModeTest.gltf", "AnisotropyStrengthTest/glTF-Binary/AnisotropyStrengthTest.glb",
                                         "BoxInterleaved/glTF/BoxInterleaved.gltf", "BoxVertexColors/glTF/BoxVertexColors.gltf",
                                         "Cameras/glTF/Cameras.gltf", "NegativeScaleTest/glTF-Binary/NegativeScaleTest.glb",
                                         "OrientationTest/glTF-Binary/OrientationTest.glb", "SimpleInstancing/glTF-Binary/SimpleInstancing.glb",
                                         "SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf", "UnlitTest/glTF-Binary/UnlitTest.glb"};
    for (size_t i = 0; i < sizeof models / sizeof *models; ++i) {
        char name[256];
        snprintf(name, sizeof name, "gltf/%s", models[i]);
        struct sr_import_result result;
        struct sr_error e = {0};
        if (sr_import_pbrt(test_reference_file(name), NULL, &result, NULL, &e) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", e.text);
        EXPECT(sr_scene_count(result.scene).triangles > 0);
        sr_import_result_free(&result);
    }
}

/* A file cut anywhere is told to be wrong, or reads as a smaller scene; never more. */
TEST(gltf_cut_files_are_refused)
{
    char *bytes;
    size_t size;
    struct sr_error e = {0};
    static const struct sr_import_options none;
    EXPECT_EQUAL_INT(sr_file_read(test_reference_file("gltf/BoxVertexColors/glTF/BoxVertexColors.gltf"), 1 << 24, &bytes, &size, &e), SR_OK);
    for (int i = 0; i < 100; ++i) {
        error = (struct sr_error){0};
        EXPECT(sr_gltf_read_bytes("m.gltf", bytes, size * (size_t)i / 100, &none, &data, NULL, &d, &error) == SR_ERROR_INPUT && error.text[0]);
        sr_pbrt_description_free(&d);
    }
    sr_free(bytes);
    done();
}
