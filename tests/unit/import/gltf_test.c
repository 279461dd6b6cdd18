/* SPDX-License-Identifier: MIT */
/* glTF files made here: what each feature becomes, and what bad files are told. */
#include "gltf_made.h"

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
        EXPECT(sr_gltf_read_bytes("m.glb", file, cut, &none, &data, NULL, &d, &error) == SR_ERROR_INPUT &&
               error.text[0]);
        sr_pbrt_description_free(&d);
    }
    done();
}

TEST(gltf_sparse_accessor_replaces_elements)
{
    put_triangle();
    size_t indices = PUT(uint16_t, 2), values = PUT(float, 7, 8, 9);
    char rest[1024];
    snprintf(
        rest, sizeof rest,
        VIEWS
        ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":2},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":12}],"
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
    describe(
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36,\"byteStride\":12}],"
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
        snprintf(
            rest, sizeof rest,
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],"
            "\"meshes\":[{\"primitives\":[{\"mode\":%d,\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
            mode);
        describe(rest);
        const struct sr_pbrt_param *p = sr_pbrt_find(&shape(0)->entity.params, "indices");
        EXPECT_EQUAL_INT(p->count, 6);
        for (int t = 0; t < 2; ++t) {
            sr_vec3 a = placed(0, (uint32_t)p->ints[3 * t]), b = placed(0, (uint32_t)p->ints[3 * t + 1]),
                    c = placed(0, (uint32_t)p->ints[3 * t + 2]);
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
    snprintf(
        rest, sizeof rest,
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
    describe(
        VIEWS
        "]," ACCESSORS
        "],\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":0}},{\"attributes\":{\"POSITION\":0}}]}]," SHOWN);
    EXPECT_EQUAL_INT(d.shapes.count, 1);
    EXPECT_EQUAL_TEXT(notes, "m.gltf: /meshes/0/primitives/0: points have no surface and are left out\n");
    done();
}

/* ---- nodes ---- */

TEST(gltf_nodes_inherit_places)
{
    put_triangle();
    describe(
        TRIANGLE
        ",\"nodes\":[{\"children\":[1],\"translation\":[0,0,5],\"scale\":[2,2,2]},"
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

/* Three meshes of the same accessors, 3000 triangles of the one corner (accessors without a view are zeros), in two
 * materials. */
static void describe_one_form(const char *second_material)
{
    char rest[4096];
    put_triangle();
    snprintf(
        rest, sizeof rest,
        VIEWS
        "]," ACCESSORS ",{\"componentType\":5123,\"count\":9000,\"type\":\"SCALAR\"}],"
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
    snprintf(
        rest, sizeof rest,
        VIEWS
        ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":36}]," ACCESSORS
        ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
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
        const char *text =
            with_buffer(mirrored ? TRIANGLE ",\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,1]}],\"scenes\":[{\"nodes\":[0]}]"
                                 : TRIANGLE "," SHOWN);
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
    size_t joints = PUT(uint8_t, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0),
           weights = PUT(float, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0);
    size_t bind =
        PUT(float, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1);
    char rest[2048];
    snprintf(
        rest, sizeof rest,
        VIEWS
        ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":12},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":128}]," ACCESSORS
        ",{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"},{\"bufferView\":2,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"},"
        "{\"bufferView\":3,\"componentType\":5126,\"count\":2,\"type\":\"MAT4\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}}]}],"
        "\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":3}],"
        "\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[100,0,0]},{\"translation\":[0,0,3],\"children\":[2]},{\"translation\":[0,1,0],\"scale\":[2,2,2]}],"
        "\"scenes\":[{\"nodes\":[0,1]}]",
        joints, weights, bind);
    describe(rest);
    // joint 0 lifts by 3; joint 1, bound at (0,1,0), doubles about it and lifts by 3; the mesh's own node counts for
    // nothing
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
        snprintf(
            rest, sizeof rest,
            VIEWS
            ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":36}]," ACCESSORS
            ",{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
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
    snprintf(
        rest, sizeof rest,
        TRIANGLE
        ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[%s]}},\"nodes\":[{\"mesh\":0},{\"translation\":[5,5,5],\"scale\":[3,3,3],"
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
    // along -z, whatever the node's scale; 30 degrees off the axis between cones of 20 and 40 there is some, at 50
    // there is none
    const char *spot =
        "{\"type\":\"spot\",\"intensity\":100,\"spot\":{\"innerConeAngle\":0.3490658504,\"outerConeAngle\":0.6981317008}}";
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
    const char *camera = TRIANGLE
        ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1.0,\"aspectRatio\":0.5,\"znear\":0.1}},"
        "{\"name\":\"flat\",\"type\":\"orthographic\",\"orthographic\":{\"xmag\":4,\"ymag\":2,\"znear\":0,\"zfar\":9}}],"
        "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"translation\":[0,0,6],\"scale\":[2,2,2]},{\"camera\":1}],\"scenes\":[{\"nodes\":[0,1,2]}]";
    describe(camera);
    float fov = 0;
    int32_t width = 0, height = 0;
    EXPECT(sr_pbrt_get_float(&d, &d.camera.params, "fov", &fov, &error) == SR_OK);
    EXPECT_NEAR(fov, 2 * atan(tan(0.5) / 2) * 180 / 3.14159265358979, 1e-4); // of the shorter side, the width
    EXPECT(sr_pbrt_get_int(&d, &d.film.params, "xresolution", &width, &error) == SR_OK && width == 720);
    EXPECT(sr_pbrt_get_int(&d, &d.film.params, "yresolution", &height, &error) == SR_OK && height == 1440);
    struct sr_transform to_camera =
        sr_matrix_to_transform(&SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, d.camera.transform)->start);
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
    EXPECT_EQUAL_INT(sr_gltf_read_bytes("m.gltf", text, strlen(text), &options, &data, NULL, &d, &error),
                     SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, "m.gltf: there is no camera \"none\": the file has 2");
    done();
}

TEST(gltf_without_light_and_camera_gets_both)
{
    put_triangle();
    describe(TRIANGLE "," SHOWN);
    EXPECT_EQUAL_INT(d.lights.count, 1);
    EXPECT_EQUAL_TEXT(SR_PBRT_AT(d.lights, struct sr_pbrt_light, 0)->entity.model, "infinite");
    struct sr_transform camera = sr_matrix_to_transform(
                            &SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, d.camera.transform)->start),
                        *to_camera = &camera;
    for (uint32_t i = 0; i < 3; ++i) { // all of it in front, inside of 40 degrees
        sr_vec3 p = sr_transform_point(to_camera, placed(0, i));
        EXPECT(p.z > 0 && fabsf(p.y) < p.z * 0.364f && fabsf(p.x) < p.z * 0.364f * 16 / 9);
    }
    done();
}

/* ---- bad files ---- */

TEST(gltf_tells_where_a_file_is_wrong)
{
    put_triangle();
    expect_error("\"bufferViews\":[{\"buffer\":0,\"byteLength\":37}]," ACCESSORS
                 "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
                 "m.gltf: /bufferViews/0: bytes 0 to 37 of a buffer of 36");
    expect_error(
        VIEWS
        "],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
        "m.gltf: /accessors/0: 4 elements end at byte 48 of a buffer view of 36");
    expect_error(
        VIEWS
        "],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":-1,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
        "m.gltf: /accessors/0/count: expected a whole number from 0 to 2147483647");
    expect_error(VIEWS "]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]," SHOWN,
                 "m.gltf: /meshes/0/primitives/0/attributes/POSITION: index 1: there are 1");
    expect_error(VIEWS "]," ACCESSORS
                       "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":0}]}]," SHOWN,
                 "m.gltf: /accessors/0: has 3 numbers in an element: expected 1, as indices of /meshes/0/primitives/0");
    expect_error(TRIANGLE ",\"nodes\":[{\"mesh\":0,\"matrix\":[1,2]}],\"scenes\":[{\"nodes\":[0]}]",
                 "m.gltf: /nodes/0/matrix: expected 16 numbers");
    expect_error(TRIANGLE ",\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[1]}]",
                 "m.gltf: /scenes/0/nodes/0: index 1: there are 1");
    expect_error(TRIANGLE ",\"nodes\":{},\"scenes\":[{\"nodes\":[0]}]", "m.gltf: /nodes: expected a list");
    // zeros without a buffer, more than a small file may ask for
    expect_error(
        "\"accessors\":[{\"componentType\":5126,\"count\":2000000000,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]," SHOWN,
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
             VIEWS ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":6}]," ACCESSORS
                   ",{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]," SHOWN,
             indices);
    expect_error(rest, "m.gltf: /accessors/1: index 3 at place 2: there are 3 vertices");
    done();
}

/* ---- files of others ---- */

TEST(gltf_sample_models_load)
{
    static const char *const models[] = {"AlphaBlendModeTest/glTF/AlphaBlendModeTest.gltf",
                                         "AnisotropyStrengthTest/glTF-Binary/AnisotropyStrengthTest.glb",
                                         "BoxInterleaved/glTF/BoxInterleaved.gltf",
                                         "BoxVertexColors/glTF/BoxVertexColors.gltf",
                                         "Cameras/glTF/Cameras.gltf",
                                         "NegativeScaleTest/glTF-Binary/NegativeScaleTest.glb",
                                         "OrientationTest/glTF-Binary/OrientationTest.glb",
                                         "SimpleInstancing/glTF-Binary/SimpleInstancing.glb",
                                         "SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf",
                                         "UnlitTest/glTF-Binary/UnlitTest.glb"};
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
    EXPECT_EQUAL_INT(
        sr_file_read(test_reference_file("gltf/BoxVertexColors/glTF/BoxVertexColors.gltf"), 1 << 24, &bytes, &size, &e),
        SR_OK);
    for (int i = 0; i < 100; ++i) {
        error = (struct sr_error){0};
        EXPECT(sr_gltf_read_bytes("m.gltf", bytes, size * (size_t)i / 100, &none, &data, NULL, &d, &error) ==
                   SR_ERROR_INPUT &&
               error.text[0]);
        sr_pbrt_description_free(&d);
    }
    sr_free(bytes);
    done();
}
