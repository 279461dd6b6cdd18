/* SPDX-License-Identifier: MIT */
/* Elements of a buffer as numbers.
 *
 *     element i lies at byteOffset + i stride,   stride = byteStride or the element's size
 *     normalised:  f = c / 255, c / 65535, max(c / 127, -1), max(c / 32767, -1)
 *
 * A sparse accessor replaces some elements, whose indices increase. glTF 2.0, 3.6.2 and 3.11. */
#include "import/gltf/gltf.h"

#include <string.h>

enum { BYTE = 5120, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT = 5125, FLOAT };

static uint32_t size_of(uint32_t type)
{
    return type == BYTE || type == UNSIGNED_BYTE ? 1 : type == SHORT || type == UNSIGNED_SHORT ? 2 : 4;
}

static uint32_t read_type(struct sr_gltf *g, const struct sr_gltf_at *at)
{
    uint32_t type = (uint32_t)sr_gltf_size(g, at, "componentType", 0, 1 << 16);
    if (sr_gltf_is_well(g) && (type < BYTE || type > FLOAT || type == 5124))
        sr_gltf_fail(g, at, "componentType %u: expected 5120, 5121, 5122, 5123, 5125 or 5126", type);
    return type;
}

static uint32_t read_components(struct sr_gltf *g, const struct sr_gltf_at *at)
{
    static const char *const words[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    static const uint32_t counts[] = {1, 2, 3, 4, 4, 9, 16};
    const char *word = sr_gltf_string(g, at, "type");
    for (int i = 0; i < 7 && word; ++i)
        if (strcmp(word, words[i]) == 0)
            return counts[i];
    if (sr_gltf_is_well(g))
        sr_gltf_fail(g, at, "expected a \"type\", SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    return 1;
}

/* Whether count elements fit. */
static void check_fit(struct sr_gltf *g, const struct sr_gltf_at *at, struct sr_gltf_buffer view, uint64_t offset,
                      uint64_t count, uint64_t stride, uint64_t size)
{
    uint64_t end = offset + (count - 1) * stride + size;
    if (sr_gltf_is_well(g) && end > view.size)
        sr_gltf_fail(g, at, "%llu elements end at byte %llu of a buffer view of %zu", (unsigned long long)count,
                     (unsigned long long)end, view.size);
}

static void read_sparse(struct sr_gltf *g, struct sr_gltf_accessor *a)
{
    struct sr_gltf_at sparse = sr_gltf_object(g, &a->at, "sparse");
    if (!sparse.json)
        return;
    struct sr_gltf_at indices = sr_gltf_object(g, &sparse, "indices"), values = sr_gltf_object(g, &sparse, "values");
    size_t unused;
    uint64_t count = sr_gltf_size(g, &sparse, "count", 0, a->count);
    a->sparse_type = read_type(g, &indices);
    uint64_t i_offset = sr_gltf_size(g, &indices, "byteOffset", 0, (uint64_t)1 << 50);
    uint64_t v_offset = sr_gltf_size(g, &values, "byteOffset", 0, (uint64_t)1 << 50);
    struct sr_gltf_buffer i_view = sr_gltf_view(g, &indices, "bufferView", &unused),
                          v_view = sr_gltf_view(g, &values, "bufferView", &unused);
    if (!sr_gltf_is_well(g) || count == 0)
        return;
    uint32_t i_size = size_of(a->sparse_type), v_size = a->components * size_of(a->type);
    if (a->sparse_type != UNSIGNED_BYTE && a->sparse_type != UNSIGNED_SHORT && a->sparse_type != UNSIGNED_INT)
        sr_gltf_fail(g, &indices, "expected a componentType without sign");
    check_fit(g, &indices, i_view, i_offset, count, i_size, i_size);
    check_fit(g, &values, v_view, v_offset, count, v_size, v_size);
    if (!sr_gltf_is_well(g))
        return;
    a->sparse_indices = i_view.data + i_offset;
    a->sparse_values = v_view.data + v_offset;
    struct sr_gltf_accessor list = {.type = a->sparse_type, .data = a->sparse_indices, .stride = i_size};
    for (uint32_t i = 0, last = 0; i < count; ++i) {
        uint32_t index = sr_gltf_whole(&list, i, 0);
        if (index >= a->count || (i > 0 && index <= last)) {
            sr_gltf_fail(g, &indices, "index %u at place %u: expected less than %u, and increasing", index, i,
                         a->count);
            return;
        }
        last = index;
    }
    a->sparse_count = (uint32_t)count;
}

struct sr_gltf_accessor sr_gltf_accessor(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key,
                                         uint32_t components)
{
    struct sr_gltf_accessor a = {0}, none = {0};
    uint32_t index1 = sr_gltf_index1(g, at, key, sr_gltf_root_count(g, "accessors"));
    if (!index1)
        return none;
    a.at = sr_gltf_entry(g, "accessors", index1 - 1);
    a.type = read_type(g, &a.at);
    a.components = read_components(g, &a.at);
    a.count = (uint32_t)sr_gltf_size(g, &a.at, "count", 0, INT32_MAX);
    a.normalized = sr_gltf_bool(g, &a.at, "normalized", false);
    uint64_t offset = sr_gltf_size(g, &a.at, "byteOffset", 0, (uint64_t)1 << 50), size = a.components * size_of(a.type);
    struct sr_gltf_buffer view = sr_gltf_view(g, &a.at, "bufferView", &a.stride);
    a.stride = a.stride ? a.stride : size;
    if (sr_gltf_is_well(g) && a.count == 0)
        sr_gltf_fail(g, &a.at, "expected a \"count\" of 1 or more");
    if (components && a.components != components)
        sr_gltf_fail(g, &a.at, "has %u numbers in an element: expected %u, as %s of %s", a.components, components, key,
                     at->pointer);
    if (!sr_gltf_is_well(g))
        return none;
    if (a.stride < size)
        sr_gltf_fail(g, &a.at, "elements of %u bytes are %u apart", (unsigned)size, (unsigned)a.stride);
    if (view.data || json_object_get(a.at.json, "bufferView")) {
        check_fit(g, &a.at, view, offset, a.count, a.stride, size);
        a.data = view.data ? view.data + offset : NULL;
    }
    read_sparse(g, &a);
    return sr_gltf_is_well(g) ? a : none;
}

/* Where element i lies; NULL: zeros. */
static const uint8_t *element(const struct sr_gltf_accessor *a, uint32_t i)
{
    struct sr_gltf_accessor list = {
        .type = a->sparse_type, .data = a->sparse_indices, .stride = size_of(a->sparse_type)};
    uint32_t lo = 0, hi = a->sparse_count;
    while (lo < hi) {
        uint32_t middle = lo + (hi - lo) / 2, index = sr_gltf_whole(&list, middle, 0);
        if (index == i)
            return a->sparse_values + (size_t)middle * a->components * size_of(a->type);
        if (index < i)
            lo = middle + 1;
        else
            hi = middle;
    }
    return a->data ? a->data + (size_t)i * a->stride : NULL;
}

static float number(const uint8_t *p, uint32_t type, bool normalized)
{
    int16_t s16;
    uint16_t u16;
    uint32_t u32;
    float f;
    switch (type) {
    case BYTE:
        return normalized ? sr_max((float)(int8_t)*p / 127, -1) : (float)(int8_t)*p;
    case UNSIGNED_BYTE:
        return normalized ? (float)*p / 255 : (float)*p;
    case SHORT:
        memcpy(&s16, p, 2);
        return normalized ? sr_max((float)s16 / 32767, -1) : (float)s16;
    case UNSIGNED_SHORT:
        memcpy(&u16, p, 2);
        return normalized ? (float)u16 / 65535 : (float)u16;
    case UNSIGNED_INT:
        memcpy(&u32, p, 4);
        return (float)u32;
    default:
        memcpy(&f, p, 4);
        return f;
    }
}

void sr_gltf_floats(const struct sr_gltf_accessor *a, uint32_t i, float *out)
{
    const uint8_t *p = element(a, i);
    uint32_t size = size_of(a->type);
    for (uint32_t k = 0; k < a->components; ++k)
        out[k] = p ? number(p + (size_t)k * size, a->type, a->normalized) : 0;
}

uint32_t sr_gltf_whole(const struct sr_gltf_accessor *a, uint32_t i, uint32_t component)
{
    const uint8_t *p = a->sparse_count ? element(a, i) : a->data ? a->data + (size_t)i * a->stride : NULL;
    uint16_t u16;
    uint32_t u32;
    if (!p)
        return 0;
    p += (size_t)component * size_of(a->type);
    if (a->type == UNSIGNED_BYTE)
        return *p;
    if (a->type == UNSIGNED_SHORT) {
        memcpy(&u16, p, 2);
        return u16;
    }
    memcpy(&u32, p, 4);
    return u32;
}
