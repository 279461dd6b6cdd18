/* SPDX-License-Identifier: MIT */
/* glTF files: whatever the bytes, the reader says what is wrong or gives shapes whose indices and runs are whole, in memory
 * that the size of the file bounds.
 *
 * FUZZ_SEED: 0 text with a buffer in it, 1 GLB. Runs as fuzz_measured.c does. */
#include "fuzz/seeds.h"
#include "import/gltf/gltf.h"

#include <stdio.h>
#include <stdlib.h>

/* One of each: skin, morph, sparse, colours, two sets of coordinates, an instance, a light, a camera, all extensions. */
#define BODY                                                                                                           \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":192},{\"buffer\":0,\"byteLength\":192,\"byteStride\":16}],"          \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                          \
    "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"                       \
    "{\"bufferView\":0,\"byteOffset\":80,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"},"   \
    "{\"bufferView\":0,\"byteOffset\":96,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"                     \
    "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":"      \
    "{\"bufferView\":0,\"byteOffset\":97,\"componentType\":5121},\"values\":{\"bufferView\":0}}},"                     \
    "{\"bufferView\":0,\"byteOffset\":64,\"componentType\":5126,\"count\":1,\"type\":\"MAT4\"},"                       \
    "{\"bufferView\":0,\"byteOffset\":128,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"}],"                     \
    "\"images\":[{\"bufferView\":0}],\"textures\":[{\"source\":0}],"                                                   \
    "\"materials\":[{\"alphaMode\":\"MASK\",\"normalTexture\":{\"index\":0,\"texCoord\":1},\"pbrMetallicRoughness\":"  \
    "{\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[2,0]}}}},\"extensions\":" \
    "{\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.5,\"anisotropyRotation\":1},"                             \
    "\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":{\"thicknessFactor\":1,"       \
    "\"attenuationDistance\":2,\"attenuationColor\":[0.5,0.5,0]}}},{\"emissiveFactor\":[1,2,3]}],"                     \
    "\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"mode\":5,\"attributes\":{\"POSITION\":0,\"NORMAL\":4,"          \
    "\"TEXCOORD_0\":1,\"TEXCOORD_1\":1,\"COLOR_0\":2},\"indices\":3,\"material\":0,\"targets\":[{\"POSITION\":4}]},"   \
    "{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":6,\"WEIGHTS_0\":2},\"material\":1,\"targets\":[{}]}]}],"                \
    "\"skins\":[{\"joints\":[0],\"inverseBindMatrices\":5}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":"   \
    "{\"yfov\":1,\"aspectRatio\":1.5}}],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\"}]}},"  \
    "\"nodes\":[{\"children\":[1,2,3]},{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":"       \
    "{\"TRANSLATION\":0}}}},{\"mesh\":0,\"skin\":0},{\"camera\":0,\"rotation\":[0,0,0,1],\"extensions\":"              \
    "{\"KHR_lights_punctual\":{\"light\":0}}}],\"scenes\":[{\"nodes\":[0]}]}"

static void gltf_seed(int which, struct seed *s)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint8_t bytes[192] = {0};
    for (int i = 0; i < 192; i += 12)
        memcpy(bytes + i, "\x01\x00\x80\x3f", 4);
    memcpy(bytes + 96, "\0\1\2\3\2\1", 6);
    memset(bytes + 128, 0, 16);
    s->size = 0;
    if (which == 0) {
        seed_print(s, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":192,\"uri\":\"data:;base64,");
        for (int i = 0; i < 192; i += 3) {
            uint32_t bits = (uint32_t)bytes[i] << 16 | (uint32_t)bytes[i + 1] << 8 | bytes[i + 2];
            seed_print(s, "%c%c%c%c", digits[bits >> 18], digits[bits >> 12 & 63], digits[bits >> 6 & 63], digits[bits & 63]);
        }
        seed_print(s, "\"}],");
        seed_put(s, BODY, strlen(BODY));
        s->header = s->size;
        return;
    }
    static const char head[] = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":192}],";
    uint32_t length = (uint32_t)(strlen(head) + strlen(BODY)) / 4 * 4 + 4;
    uint32_t words[5] = {0x46546c67, 2, 20 + length + 8 + 192, length, 0x4e4f534a}, chunk[2] = {192, 0x004e4942};
    memcpy(s->data, words, 20);
    s->size = 20;
    seed_print(s, "%s", head);
    seed_put(s, BODY, strlen(BODY));
    while (s->size < 20 + length)
        seed_print(s, " ");
    memcpy(s->data + s->size, chunk, 8);
    s->size += 8;
    s->header = s->size;
    seed_put(s, bytes, sizeof bytes);
}

static void judge_shape(const struct sr_pbrt_shape *s)
{
    const struct sr_pbrt_param *P = sr_pbrt_find(&s->entity.params, "P"), *indices = sr_pbrt_find(&s->entity.params, "indices");
    const struct sr_pbrt_param *uv = sr_pbrt_find(&s->entity.params, "uv"), *N = sr_pbrt_find(&s->entity.params, "N");
    if (!P || !indices || P->count % 3 || indices->count % 3 || (uv && 3 * uv->count != 2 * P->count) || (N && N->count != P->count))
        abort();
    for (uint32_t i = 0; i < indices->count; ++i)
        if (indices->ints[i] < 0 || (uint32_t)indices->ints[i] >= P->count / 3)
            abort();
}

static void judge(const uint8_t *bytes, size_t size)
{
    static const struct sr_import_options none;
    struct sr_arena data = {0};
    struct sr_error error = {0};
    struct sr_pbrt_description d;
    sr_status status = sr_gltf_read_bytes("model.gltf", (const char *)bytes, size, &none, &data, NULL, &d, &error);
    if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]))
        abort(); // a refusal has a reason
    if (data.total + d.words.total > 16 * size + ((size_t)64 << 20))
        abort();
    for (size_t i = 0; i < d.shapes.count && status == SR_OK; ++i)
        judge_shape(SR_PBRT_AT(d.shapes, struct sr_pbrt_shape, i));
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
}

static void make_seed(int number, struct seed *seed)
{
    gltf_seed(number, seed);
}

static const char *seed_name(int number)
{
    return number ? "glb" : "gltf";
}

#include "fuzz/driver.h"
