/* SPDX-License-Identifier: MIT */
/* The container: JSON text, or GLB (a header of 12 bytes, then chunks of length, type and bytes, little-endian; the
 * first is JSON, the second may be buffer 0); then the buffers and the views of them. glTF 2.0, 3.6 and 4. */
#include "import/gltf/gltf.h"

#include <string.h>

static uint32_t little(const char *p)
{
    const uint8_t *b = (const uint8_t *)p;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* Finds the JSON text of a GLB file and its binary chunk. */
static bool open_chunks(struct sr_gltf *g, const char *bytes, size_t size, struct sr_gltf_buffer *json)
{
    if (size < 20 || little(bytes + 4) != 2)
        sr_gltf_fail(g, NULL, size < 20 ? "a GLB file of %u bytes ends in its header" : "version %u of GLB: expected 2",
                     size < 20 ? (unsigned)size : little(bytes + 4));
    uint64_t total = size < 20 ? 0 : little(bytes + 8);
    if (sr_gltf_is_well(g) && total > size)
        sr_gltf_fail(g, NULL, "the GLB header tells %llu bytes, the file has %zu", (unsigned long long)total, size);
    for (uint64_t at = 12, number = 0; sr_gltf_is_well(g) && at + 8 <= total; ++number) {
        uint64_t length = little(bytes + at);
        uint32_t type = little(bytes + at + 4);
        const uint8_t *data = (const uint8_t *)bytes + at + 8;
        if (at + 8 + length > total)
            sr_gltf_fail(g, NULL, "GLB chunk %u of %llu bytes ends after the file", (unsigned)number,
                         (unsigned long long)length);
        else if (number == 0 && type == 0x4e4f534au)
            *json = (struct sr_gltf_buffer){data, length};
        else if (number == 1 && type == 0x004e4942u)
            g->binary = (struct sr_gltf_buffer){data, length};
        at += 8 + (length + 3) / 4 * 4;
    }
    if (sr_gltf_is_well(g) && !json->data)
        sr_gltf_fail(g, NULL, "the first chunk of the GLB file is no JSON");
    return sr_gltf_is_well(g);
}

/* What the tree of values will take, from above: a text of many braces must not become a hundred times as large. */
static uint64_t tree_size(const uint8_t *text, size_t size)
{
    uint64_t sum = 0;
    bool is_string = false;
    for (size_t i = 0; i < size; ++i) {
        uint8_t c = text[i];
        if (c == '"')
            is_string = !is_string;
        else if (is_string)
            i += c == '\\';
        else
            sum += c == '{' ? 320 : c == '[' ? 160 : c == ',' ? 48 : c == ':' ? 64 : 0;
    }
    return sum + size;
}

static bool open_json(struct sr_gltf *g, struct sr_gltf_buffer text)
{
    json_error_t error;
    if (!sr_gltf_charge(g, NULL, tree_size(text.data, text.size)))
        return false;
    g->root = json_loadb((const char *)text.data, text.size, 0, &error);
    if (!g->root) {
        if (json_error_code(&error) == json_error_out_of_memory)
            sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory for its JSON", g->c.path);
        else if (error.line > 0)
            sr_fail(g->c.error, SR_ERROR_INPUT, "%s:%d:%d: %s", g->c.path, error.line, error.column, error.text);
        else
            sr_gltf_fail(g, NULL, "%s", error.text);
    } else if (!json_is_object(g->root))
        sr_gltf_fail(g, NULL, "expected a JSON object");
    return sr_gltf_is_well(g);
}

static void check_asset(struct sr_gltf *g)
{
    struct sr_gltf_at root = {.json = g->root}, asset = sr_gltf_object(g, &root, "asset");
    const char *version = sr_gltf_string(g, &asset, "version"), *least = sr_gltf_string(g, &asset, "minVersion");
    if (!version)
        sr_gltf_fail(g, &asset, "expected an object with the \"version\" of glTF");
    else if (strncmp(version, "2.", 2) != 0)
        sr_gltf_fail(g, &asset, "version \"%.20s\" of glTF: expected 2.0", version);
    else if (least && strcmp(least, "2.0") != 0)
        sr_gltf_fail(g, &asset, "needs version \"%.20s\" of glTF: expected 2.0", least);
}

/* What a file says it cannot do without. Compressed things are refused where they are met. */
static void check_extensions(struct sr_gltf *g)
{
    static const char *const known[] = {
        "EXT_mesh_gpu_instancing", "KHR_lights_punctual",       "KHR_materials_anisotropy",
        "KHR_materials_clearcoat", "KHR_materials_dispersion",  "KHR_materials_emissive_strength",
        "KHR_materials_ior",       "KHR_materials_iridescence", "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_sheen",     "KHR_materials_specular",    "KHR_materials_transmission",
        "KHR_materials_unlit",     "KHR_materials_variants",    "KHR_materials_volume",
        "KHR_mesh_quantization",   "KHR_texture_transform"};
    struct sr_gltf_at required = sr_gltf_list(g, "extensionsRequired"), used = sr_gltf_list(g, "extensionsUsed");
    for (int pass = 0; pass < 2; ++pass) {
        const struct sr_gltf_at *list = pass == 0 ? &required : &used;
        for (uint32_t i = 0; i < sr_gltf_count(list) && i < 1000; ++i) {
            const char *name = json_string_value(json_array_get(list->json, i));
            bool is_known = !name;
            for (size_t k = 0; k < sizeof known / sizeof *known && !is_known; ++k)
                is_known = strcmp(known[k], name) == 0;
            if (!is_known && pass == 0)
                sr_gltf_warn(g, NULL,
                             "the extension %.60s is not supported, and the file says that it cannot do without", name);
            else if (!is_known)
                sr_gltf_warn(g, NULL, "the extension %.60s is not supported and does nothing", name);
        }
    }
}

static void open_buffers(struct sr_gltf *g)
{
    struct sr_gltf_at list = sr_gltf_list(g, "buffers");
    uint32_t count = sr_gltf_count(&list);
    g->buffers = sr_arena_alloc(&g->scratch, count * sizeof *g->buffers);
    if (!g->buffers)
        sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
    for (uint32_t i = 0; i < count && sr_gltf_is_well(g); ++i) {
        struct sr_gltf_at at = sr_gltf_element(g, &list, i);
        const char *uri = sr_gltf_string(g, &at, "uri");
        uint64_t length = sr_gltf_size(g, &at, "byteLength", 0, (uint64_t)1 << 50);
        struct sr_gltf_buffer b = {NULL, 0};
        if (uri)
            sr_gltf_fetch(g, &at, uri, &b);
        else if (i == 0)
            b = g->binary;
        if (!sr_gltf_is_well(g))
            return;
        if (b.size < length)
            sr_gltf_fail(g, &at, "byteLength is %llu, but %s has %zu bytes", (unsigned long long)length,
                         uri && !sr_gltf_is_data_uri(uri) ? uri : "the buffer", b.size);
        if (!sr_gltf_is_well(g))
            return;
        b.size = length;
        g->buffers[i] = b;
        if (b.size)
            g->c.d->hash = sr_pbrt_hash(g->c.d->hash, b.data, b.size);
        bool is_another = uri && !sr_gltf_is_data_uri(uri);
        g->input_B += is_another ? b.size : 0;
        g->most_B += is_another ? 16 * (uint64_t)b.size : 0;
    }
}

bool sr_gltf_open(struct sr_gltf *g, const char *bytes, size_t size)
{
    struct sr_gltf_buffer json = {(const uint8_t *)bytes, size};
    g->input_B = size;
    g->most_B = 16 * (uint64_t)size + ((uint64_t)48 << 20); // grows with the buffers
    if (size)
        g->c.d->hash = sr_pbrt_hash(g->c.d->hash, bytes, size);
    bool is_binary = size >= 4 && memcmp(bytes, "glTF", 4) == 0;
    if ((is_binary && !open_chunks(g, bytes, size, &json)) || !open_json(g, json))
        return false;
    check_asset(g);
    check_extensions(g);
    open_buffers(g);
    return sr_gltf_is_well(g);
}

struct sr_gltf_buffer sr_gltf_view(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, size_t *stride)
{
    static const struct sr_gltf_buffer none = {NULL, 0};
    uint32_t index1 = sr_gltf_index1(g, at, key, sr_gltf_root_count(g, "bufferViews"));
    if (!index1)
        return none;
    struct sr_gltf_at view = sr_gltf_entry(g, "bufferViews", index1 - 1);
    struct sr_gltf_at packed = sr_gltf_extension(g, &view, "EXT_meshopt_compression");
    uint32_t buffer1 = sr_gltf_index1(g, &view, "buffer", sr_gltf_root_count(g, "buffers"));
    uint64_t offset = sr_gltf_size(g, &view, "byteOffset", 0, (uint64_t)1 << 50);
    uint64_t length = sr_gltf_size(g, &view, "byteLength", 0, (uint64_t)1 << 50);
    *stride = sr_gltf_size(g, &view, "byteStride", 0, 252);
    if (packed.json)
        sr_gltf_fail(g, &packed, "compressed by EXT_meshopt_compression, which is not supported");
    if (sr_gltf_is_well(g) && !buffer1)
        sr_gltf_fail(g, &view, "expected a \"buffer\"");
    if (!sr_gltf_is_well(g))
        return none;
    const struct sr_gltf_buffer *b = &g->buffers[buffer1 - 1];
    if (offset + length > b->size) {
        sr_gltf_fail(g, &view, "bytes %llu to %llu of a buffer of %zu", (unsigned long long)offset,
                     (unsigned long long)(offset + length), b->size);
        return none;
    }
    return (struct sr_gltf_buffer){b->data + offset, length};
}
