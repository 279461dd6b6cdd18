/* SPDX-License-Identifier: MIT */
/* Small glTF files. */
#ifndef TEST_FUZZ_GLTF_SEEDS_H
#define TEST_FUZZ_GLTF_SEEDS_H

#include "fuzz/seeds.h"

/* One of each: skin, morph, sparse, colours, two sets of coordinates, an instance, a light, a camera, all extensions.
 */
#define SEED_GLTF_BODY                                                                                                  \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":192},{\"buffer\":0,\"byteLength\":192,\"byteStride\":16}],"          \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                           \
    "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"                        \
    "{\"bufferView\":0,\"byteOffset\":80,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"},"    \
    "{\"bufferView\":0,\"byteOffset\":96,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"                      \
    "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":"       \
    "{\"bufferView\":0,\"byteOffset\":97,\"componentType\":5121},\"values\":{\"bufferView\":0}}},"                      \
    "{\"bufferView\":0,\"byteOffset\":64,\"componentType\":5126,\"count\":1,\"type\":\"MAT4\"},"                        \
    "{\"bufferView\":0,\"byteOffset\":128,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"}],"                      \
    "\"images\":[{\"bufferView\":0}],\"textures\":[{\"source\":0}],"                                                    \
    "\"materials\":[{\"alphaMode\":\"MASK\",\"normalTexture\":{\"index\":0,\"texCoord\":1},\"pbrMetallicRoughness\":"   \
    "{\"baseColorTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[2,0]}}}},\"extensions\":" \
    "{\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.5,\"anisotropyRotation\":1},"                              \
    "\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_volume\":{\"thicknessFactor\":1,"        \
    "\"attenuationDistance\":2,\"attenuationColor\":[0.5,0.5,0]}}},{\"emissiveFactor\":[1,2,3]}],"                      \
    "\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"mode\":5,\"attributes\":{\"POSITION\":0,\"NORMAL\":4,"           \
    "\"TEXCOORD_0\":1,\"TEXCOORD_1\":1,\"COLOR_0\":2},\"indices\":3,\"material\":0,\"targets\":[{\"POSITION\":4}]},"    \
    "{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":6,\"WEIGHTS_0\":2},\"material\":1,\"targets\":[{}]}]}],"              \
    "\"skins\":[{\"joints\":[0],\"inverseBindMatrices\":5}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":"    \
    "{\"yfov\":1,\"aspectRatio\":1.5}}],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\"}]}},"   \
    "\"nodes\":[{\"children\":[1,2,3]},{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":"        \
    "{\"TRANSLATION\":0}}}},{\"mesh\":0,\"skin\":0},{\"camera\":0,\"rotation\":[0,0,0,1],\"extensions\":"               \
    "{\"KHR_lights_punctual\":{\"light\":0}}}],\"scenes\":[{\"nodes\":[0]}]}"

static inline void gltf_seed(int which, struct seed *s)
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
            seed_print(s, "%c%c%c%c", digits[bits >> 18], digits[bits >> 12 & 63], digits[bits >> 6 & 63],
                       digits[bits & 63]);
        }
        seed_print(s, "\"}],");
        seed_put(s, SEED_GLTF_BODY, strlen(SEED_GLTF_BODY));
        s->header = s->size;
        return;
    }
    static const char head[] = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":192}],";
    uint32_t length = (uint32_t)(strlen(head) + strlen(SEED_GLTF_BODY)) / 4 * 4 + 4;
    uint32_t words[5] = {0x46546c67, 2, 20 + length + 8 + 192, length, 0x4e4f534a}, chunk[2] = {192, 0x004e4942};
    memcpy(s->data, words, 20);
    s->size = 20;
    seed_print(s, "%s", head);
    seed_put(s, SEED_GLTF_BODY, strlen(SEED_GLTF_BODY));
    while (s->size < 20 + length)
        seed_print(s, " ");
    memcpy(s->data + s->size, chunk, 8);
    s->size += 8;
    s->header = s->size;
    seed_put(s, bytes, sizeof bytes);
}

#endif
