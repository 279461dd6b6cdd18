/* SPDX-License-Identifier: MIT */
/* glTF files that tests put together, and what they become. */
#ifndef SR_TESTS_UNIT_IMPORT_GLTF_MADE_H
#define SR_TESTS_UNIT_IMPORT_GLTF_MADE_H

#include "test.h"

#include "import/gltf/gltf.h"
#include "import/import.h"

#include <stdio.h>
#include <string.h>

static uint8_t buffer[4096];
static size_t buffer_size;
static char notes[8192];

static inline size_t put(const void *data, size_t size) // its offset
{
    size_t at = buffer_size;
    memcpy(buffer + at, data, size);
    buffer_size = (at + size + 3) / 4 * 4;
    return at;
}
#define PUT(type, ...) put((const type[]){__VA_ARGS__}, sizeof((const type[]){__VA_ARGS__}))

static inline const char *base64(void)
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

static inline void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    if (severity == SR_WARNING && strlen(notes) + strlen(text) + 2 < sizeof notes)
        strcat(strcat(notes, text), "\n");
}

/* The text with the buffer in it as "buffers", and one view of all of it, number 0. */
static inline const char *with_buffer(const char *rest)
{
    static char text[20000];
    snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:application/octet-stream;base64,%s\"}],%s}",
        buffer_size, base64(), rest);
    return text;
}

static struct sr_arena data;
static struct sr_error error;
static struct sr_pbrt_description d;

static inline sr_status read_text(const char *text)
{
    static const struct sr_import_options none;
    struct sr_log log = {.write = note};
    notes[0] = 0;
    error = (struct sr_error){0};
    return sr_gltf_read_bytes("m.gltf", text, strlen(text), &none, &data, &log, &d, &error);
}

static inline void describe(const char *rest)
{
    if (read_text(with_buffer(rest)) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

static inline void done(void)
{
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
    buffer_size = 0;
}

static inline void expect_error(const char *rest, const char *message)
{
    EXPECT_EQUAL_INT(read_text(with_buffer(rest)), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(error.text, message);
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}

static inline const struct sr_pbrt_shape *shape(size_t i)
{
    EXPECT(i < d.shapes.count);
    return SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, i);
}

static inline const float *floats_of(size_t i, const char *name, uint32_t count)
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&shape(i)->entity.params, name);
    EXPECT(p && p->floats && p->count == count);
    return p->floats;
}

static inline sr_vec3 placed(size_t i, uint32_t vertex) // in the world
{
    const struct sr_pbrt_param *p = sr_pbrt_find(&shape(i)->entity.params, "P");
    const float *P = p->floats + 3 * (size_t)vertex;
    EXPECT(3 * vertex + 2 < p->count);
    struct sr_transform to_world =
        sr_matrix_to_transform(&SR_PBRT_AT(d.transforms, struct sr_pbrt_transform, shape(i)->entity.transform)->start);
    return sr_transform_point(&to_world, (sr_vec3){P[0], P[1], P[2]});
}

static inline const struct sr_pbrt_param *material_param(const char *material, const char *name)
{
    uint32_t index1 = sr_pbrt_names_find(&d.material_names, material);
    EXPECT(index1 != 0);
    return sr_pbrt_find(&SR_PBRT_AT(d.named_materials, struct sr_pbrt_entity, index1 - 1)->params, name);
}

/* a triangle of three positions at the buffer's start: accessor 0, view 0 */
static inline void put_triangle(void)
{
    buffer_size = 0;
    PUT(float, 0, 0, 0, 1, 0, 0, 0, 1, 0);
}
#define VIEWS "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}"
#define ACCESSORS "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
#define TRIANGLE VIEWS "]," ACCESSORS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"
#define SHOWN "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]"

#endif
