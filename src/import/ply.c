/* SPDX-License-Identifier: MIT */
/* The body of a PLY file: vertices and faces, the rest is skipped.
 *
 * Vertices: x y z, nx ny nz, and u v, s t, texture_u texture_v or texture_s texture_t. Faces: a list vertex_indices (or
 * vertex_index) of any integer type, and face_indices. Binary little-endian files whose faces are all triangles or all
 * quads are copied in strides; everything else goes value by value. No index outside of the vertices ever leaves this
 * file. */
#include "import/ply.h"

#include "import/number.h"
#include "import/ply_header.h"

#include <string.h>

static const size_t max_file_B = (size_t)64 << 30;

struct reader {
    const char *label, *p, *end;
    enum sr_ply_format format;
    struct sr_error *error;
};

static sr_status cut_short(const struct reader *r, const char *element, uint64_t i, uint64_t count)
{
    return sr_fail(r->error, SR_ERROR_INPUT, "%s: is cut short: it ends in %s %llu, expected %llu of them", r->label,
                   element, (unsigned long long)i + 1, (unsigned long long)count);
}

/* ---- single values ---- */

static inline double load_binary(const char *from, enum sr_ply_type type, bool is_swapped)
{
    uint64_t bits = 0;
    uint32_t n = sr_ply_type_size(type);
    for (uint32_t i = 0; i < n; ++i)
        bits |= (uint64_t)(unsigned char)from[i] << (8 * (is_swapped ? n - 1 - i : i));
    switch (type) {
    case SR_PLY_INT8:
        return (int8_t)bits;
    case SR_PLY_UINT8:
        return (uint8_t)bits;
    case SR_PLY_INT16:
        return (int16_t)bits;
    case SR_PLY_UINT16:
        return (uint16_t)bits;
    case SR_PLY_INT32:
        return (int32_t)bits;
    case SR_PLY_UINT32:
        return (uint32_t)bits;
    case SR_PLY_FLOAT32: {
        uint32_t low = (uint32_t)bits;
        float value;
        memcpy(&value, &low, sizeof value);
        return (double)value;
    }
    default: {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    }
}

static bool is_word_end(char c)
{
    return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == 0;
}

/* false: no value here */
static inline bool read_value(struct reader *r, enum sr_ply_type type, double *value)
{
    if (r->format == SR_PLY_ASCII) {
        while (*r->p == ' ' || *r->p == '\n' || *r->p == '\t' || *r->p == '\r')
            ++r->p;
        const char *end = sr_number_read(r->p, value);
        if (!end) { // nan and inf, as C's printf writes them
            const char *word = r->p + (*r->p == '-' || *r->p == '+');
            bool is_nan = strncmp(word, "nan", 3) == 0, is_inf = strncmp(word, "inf", 3) == 0;
            if (!is_nan && !is_inf)
                return false;
            *value = is_nan ? (double)NAN : *r->p == '-' ? -(double)INFINITY : (double)INFINITY;
            for (end = word; !is_word_end(*end); ++end)
                ;
        }
        if (!is_word_end(*end))
            return false;
        r->p = end;
        return true;
    }
    uint32_t n = sr_ply_type_size(type);
    if ((size_t)(r->end - r->p) < n)
        return false;
    *value = load_binary(r->p, type, r->format == SR_PLY_BIG_ENDIAN);
    r->p += n;
    return true;
}

static bool skip_list(struct reader *r, const struct sr_ply_property *p)
{
    double count, ignored;
    if (!read_value(r, p->count_type, &count) || !(count >= 0 && count < 0x1p53))
        return false;
    if (r->format != SR_PLY_ASCII) {
        uint64_t size = (uint64_t)count * sr_ply_type_size(p->type);
        if (size > (uint64_t)(r->end - r->p))
            return false;
        r->p += size;
        return true;
    }
    for (uint64_t i = 0; i < (uint64_t)count; ++i)
        if (!read_value(r, p->type, &ignored))
            return false;
    return true;
}

static bool skip_property(struct reader *r, const struct sr_ply_property *p)
{
    double ignored;
    return p->is_list ? skip_list(r, p) : read_value(r, p->type, &ignored);
}

static sr_status skip_element(struct reader *r, const struct sr_ply_element *e)
{
    if (r->format != SR_PLY_ASCII && e->list_count == 0) {
        r->p += (uint64_t)e->least_size * e->count; // checked against the size of the file
        return SR_OK;
    }
    for (uint64_t i = 0; i < e->count && e->property_count; ++i)
        for (uint32_t k = 0; k < e->property_count; ++k)
            if (!skip_property(r, &e->properties[k]))
                return cut_short(r, e->name, i, e->count);
    return SR_OK;
}

/* ---- vertices ---- */

enum { COMPONENTS = 8 }; // x y z nx ny nz u v

static void find_vertex_properties(const struct sr_ply_element *e, int which[COMPONENTS])
{
    static const char *const names[6] = {"x", "y", "z", "nx", "ny", "nz"};
    static const char *const uv[4][2] = {
        {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
    for (int c = 0; c < 6; ++c)
        which[c] = sr_ply_find_property(e, names[c]);
    which[6] = which[7] = -1;
    for (int i = 0; i < 4 && which[6] < 0; ++i)
        for (int c = 0; c < 2; ++c)
            which[6 + c] = sr_ply_find_property(e, uv[i][c]);
    for (int c = 0; c < COMPONENTS; ++c)
        if (which[c] >= 0 && e->properties[which[c]].is_list)
            which[c] = -1;
    if (which[3] < 0 || which[4] < 0 || which[5] < 0)
        which[3] = which[4] = which[5] = -1;
    if (which[6] < 0 || which[7] < 0)
        which[6] = which[7] = -1;
}

static bool are_floats_in_a_row(const struct sr_ply_element *e, const int which[], int count)
{
    for (int c = 0; c < count; ++c)
        if (which[c] != which[0] + c || e->properties[which[c]].type != SR_PLY_FLOAT32)
            return false;
    return true;
}

/* count runs of `size` bytes, `stride` apart, made dense */
static inline void gather_runs(void *to, const char *from, size_t stride, size_t size, uint64_t count)
{
    char *out = to;
    for (uint64_t i = 0; i < count; ++i)
        memcpy(out + i * size, from + i * stride, size);
}

static void gather(void *to, const char *from, size_t stride, size_t size, uint64_t count)
{
    if (stride == size)
        memcpy(to, from, size * count);
    else if (size == 12)
        gather_runs(to, from, stride, 12, count);
    else if (size == 8)
        gather_runs(to, from, stride, 8, count);
    else
        gather_runs(to, from, stride, size, count);
}

static bool is_little_endian(void)
{
    const uint16_t one = 1;
    unsigned char low;
    memcpy(&low, &one, 1);
    return low == 1;
}

static sr_status read_vertices(struct reader *r, const struct sr_ply_element *e, struct sr_ply_mesh *mesh)
{
    int which[COMPONENTS];
    find_vertex_properties(e, which);
    if (which[0] < 0 || which[1] < 0 || which[2] < 0)
        return sr_fail(r->error, SR_ERROR_INPUT, "%s: its vertices have no x, y and z", r->label);
    if (e->count > INT32_MAX)
        return sr_fail(r->error, SR_ERROR_INPUT, "%s: has %llu vertices, expected at most 2147483647", r->label,
                       (unsigned long long)e->count);
    size_t n = (size_t)e->count;
    mesh->vertex_count = (uint32_t)n;
    mesh->P = sr_arena_alloc(&mesh->memory, n * sizeof(sr_vec3) + 16);
    mesh->N = which[3] >= 0 ? sr_arena_alloc(&mesh->memory, n * sizeof(sr_vec3) + 16) : NULL;
    mesh->uv = which[6] >= 0 ? sr_arena_alloc(&mesh->memory, n * sizeof(sr_vec2) + 16) : NULL;
    if (!mesh->P || (which[3] >= 0 && !mesh->N) || (which[6] >= 0 && !mesh->uv))
        return sr_fail(r->error, SR_ERROR_RESOURCE, "%s: not enough memory for its %zu vertices", r->label, n);

    if (r->format == SR_PLY_LITTLE_ENDIAN && is_little_endian() && e->list_count == 0 &&
        are_floats_in_a_row(e, which, 3) && (which[3] < 0 || are_floats_in_a_row(e, which + 3, 3)) &&
        (which[6] < 0 || are_floats_in_a_row(e, which + 6, 2))) {
        gather(mesh->P, r->p + e->properties[which[0]].offset, e->least_size, sizeof(sr_vec3), n);
        if (mesh->N)
            gather(mesh->N, r->p + e->properties[which[3]].offset, e->least_size, sizeof(sr_vec3), n);
        if (mesh->uv)
            gather(mesh->uv, r->p + e->properties[which[6]].offset, e->least_size, sizeof(sr_vec2), n);
        r->p += n * e->least_size;
        return SR_OK;
    }
    int component_of[SR_PLY_MAX_PROPERTIES];
    for (uint32_t k = 0; k < e->property_count; ++k) {
        component_of[k] = -1;
        for (int c = 0; c < COMPONENTS; ++c)
            component_of[k] = which[c] == (int)k ? c : component_of[k];
    }
    for (size_t i = 0; i < n; ++i) {
        double values[COMPONENTS] = {0};
        for (uint32_t k = 0; k < e->property_count; ++k) {
            double value = 0;
            bool ok = e->properties[k].is_list ? skip_list(r, &e->properties[k])
                                               : read_value(r, e->properties[k].type, &value);
            if (!ok)
                return cut_short(r, e->name, i, e->count);
            if (component_of[k] >= 0)
                values[component_of[k]] = value;
        }
        mesh->P[i] = (sr_vec3){(float)values[0], (float)values[1], (float)values[2]};
        if (mesh->N)
            mesh->N[i] = (sr_vec3){(float)values[3], (float)values[4], (float)values[5]};
        if (mesh->uv)
            mesh->uv[i] = (sr_vec2){(float)values[6], (float)values[7]};
    }
    return SR_OK;
}

/* ---- faces ---- */

static sr_status no_memory_for_faces(const struct reader *r, uint64_t count)
{
    return sr_fail(r->error, SR_ERROR_RESOURCE, "%s: not enough memory for its %llu faces", r->label,
                   (unsigned long long)count);
}

/* All faces have `corners` corners and nothing else, in 32 bits: copied in strides. */
static sr_status read_uniform_faces(struct reader *r, const struct sr_ply_element *e, uint32_t corners,
                                    struct sr_ply_mesh *mesh, bool *done)
{
    size_t n = (size_t)e->count, stride = 1 + 4 * (size_t)corners;
    *done = false;
    if (n == 0 || (size_t)(r->end - r->p) / stride < n)
        return SR_OK;
    for (size_t i = 0; i < n; ++i)
        if ((unsigned char)r->p[i * stride] != corners)
            return SR_OK;
    int32_t *to = sr_arena_alloc(&mesh->memory, n * corners * sizeof(int32_t) + 16);
    if (!to)
        return no_memory_for_faces(r, n);
    if (corners == 3)
        gather_runs(to, r->p + 1, 13, 12, n);
    else
        gather_runs(to, r->p + 1, 17, 16, n);
    *(corners == 3 ? &mesh->triangles : &mesh->quads) = to;
    *(corners == 3 ? &mesh->triangle_count : &mesh->quad_count) = (uint32_t)n;
    r->p += n * stride;
    *done = true;
    return SR_OK;
}

struct face_lists {
    struct sr_array triangles, quads, triangle_faces, quad_faces, corners; // of int32_t
};

static bool push_int(struct sr_array *a, int32_t value)
{
    int32_t *slot = sr_array_push(a, sizeof *slot);
    if (slot)
        *slot = value;
    return slot != NULL;
}

static bool push_face(struct face_lists *l, int32_t face, struct sr_ply_mesh *mesh)
{
    const int32_t *c = l->corners.data;
    size_t n = l->corners.count;
    bool ok = true;
    if (n < 3)
        ++mesh->dropped_count;
    else if (n == 4) {
        for (int i = 0; i < 4; ++i)
            ok = ok && push_int(&l->quads, c[i]);
        return ok && push_int(&l->quad_faces, face);
    }
    for (size_t i = 2; i < n && ok; ++i)
        ok = push_int(&l->triangles, c[0]) && push_int(&l->triangles, c[i - 1]) && push_int(&l->triangles, c[i]) &&
             push_int(&l->triangle_faces, face);
    mesh->fan_count += n > 4;
    return ok;
}

static sr_status read_corners(struct reader *r, const struct sr_ply_property *p, struct face_lists *l, uint64_t i,
                              uint64_t count)
{
    double corners, value;
    l->corners.count = 0;
    if (!read_value(r, p->count_type, &corners))
        return cut_short(r, "face", i, count);
    if (!(corners >= 0 && corners <= (double)(r->end - r->p)))
        return sr_fail(r->error, SR_ERROR_INPUT,
                       "%s: face %llu says that it has %.0f corners, more than the file holds", r->label,
                       (unsigned long long)i + 1, corners);
    for (uint32_t k = 0; k < (uint32_t)corners; ++k) {
        if (!read_value(r, p->type, &value))
            return cut_short(r, "face", i, count);
        if (!(value >= INT32_MIN && value <= INT32_MAX))
            value = -1; // found by the check of the indices
        if (!push_int(&l->corners, (int32_t)value))
            return no_memory_for_faces(r, count);
    }
    return SR_OK;
}

static sr_status read_faces_one_by_one(struct reader *r, const struct sr_ply_element *e, int corners, int face_index,
                                       struct face_lists *l, struct sr_ply_mesh *mesh)
{
    for (uint64_t i = 0; i < e->count; ++i) {
        double face = 0;
        l->corners.count = 0;
        for (uint32_t k = 0; k < e->property_count; ++k) {
            const struct sr_ply_property *p = &e->properties[k];
            if ((int)k == corners) {
                sr_status status = read_corners(r, p, l, i, e->count);
                if (status != SR_OK)
                    return status;
            } else if ((int)k == face_index ? !read_value(r, p->type, &face) : !skip_property(r, p))
                return cut_short(r, e->name, i, e->count);
        }
        if (!push_face(l, face >= INT32_MIN && face <= INT32_MAX ? (int32_t)face : 0, mesh))
            return no_memory_for_faces(r, e->count);
    }
    return SR_OK;
}

static int32_t *keep(struct sr_ply_mesh *mesh, const struct sr_array *a, const struct sr_array *b)
{
    size_t count = a->count + (b ? b->count : 0);
    int32_t *to = sr_arena_alloc(&mesh->memory, count * sizeof *to + 16);
    if (to && a->count)
        memcpy(to, a->data, a->count * sizeof *to);
    if (to && b && b->count)
        memcpy(to + a->count, b->data, b->count * sizeof *to);
    return to;
}

static sr_status read_faces(struct reader *r, const struct sr_ply_element *e, struct sr_ply_mesh *mesh)
{
    int corners = sr_ply_find_property(e, "vertex_indices"), face_index = sr_ply_find_property(e, "face_indices");
    if (corners < 0)
        corners = sr_ply_find_property(e, "vertex_index");
    if (corners < 0 || !e->properties[corners].is_list || e->properties[corners].type >= SR_PLY_FLOAT32)
        return sr_fail(r->error, SR_ERROR_INPUT, "%s: its faces have no list of whole numbers \"vertex_indices\"",
                       r->label);
    if (e->count > INT32_MAX / 4) // so that numbers of corners are as small
        return sr_fail(r->error, SR_ERROR_INPUT, "%s: has %llu faces, expected at most %d", r->label,
                       (unsigned long long)e->count, INT32_MAX / 4);
    if (face_index >= 0 && e->properties[face_index].is_list)
        face_index = -1;

    const struct sr_ply_property *p = &e->properties[corners];
    if (r->format == SR_PLY_LITTLE_ENDIAN && is_little_endian() && e->property_count == 1 &&
        sr_ply_type_size(p->count_type) == 1 && sr_ply_type_size(p->type) == 4) {
        bool done = false;
        sr_status status = read_uniform_faces(r, e, 3, mesh, &done);
        if (status == SR_OK && !done)
            status = read_uniform_faces(r, e, 4, mesh, &done);
        if (status != SR_OK || done)
            return status;
    }
    struct face_lists l = {0};
    sr_status status = read_faces_one_by_one(r, e, corners, face_index, &l, mesh);
    if (status == SR_OK && l.triangles.count + l.quads.count > INT32_MAX)
        status = sr_fail(r->error, SR_ERROR_INPUT, "%s: has too many faces", r->label);
    if (status == SR_OK) {
        mesh->triangle_count = (uint32_t)(l.triangles.count / 3);
        mesh->quad_count = (uint32_t)(l.quads.count / 4);
        mesh->triangles = keep(mesh, &l.triangles, NULL);
        mesh->quads = keep(mesh, &l.quads, NULL);
        mesh->face_indices = face_index >= 0 ? keep(mesh, &l.triangle_faces, &l.quad_faces) : NULL;
        if (!mesh->triangles || !mesh->quads || (face_index >= 0 && !mesh->face_indices))
            status = no_memory_for_faces(r, e->count);
    }
    struct sr_array *lists[] = {&l.triangles, &l.quads, &l.triangle_faces, &l.quad_faces, &l.corners};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; ++i)
        sr_array_free(lists[i]);
    return status;
}

static sr_status check_indices(const struct reader *r, const int32_t *indices, size_t count, uint32_t vertex_count)
{
    uint32_t largest = 0;
    for (size_t i = 0; i < count; ++i)
        largest = (uint32_t)indices[i] > largest ? (uint32_t)indices[i] : largest;
    if (count == 0 || largest < vertex_count)
        return SR_OK;
    size_t i = 0;
    while ((uint32_t)indices[i] < vertex_count)
        ++i;
    return sr_fail(r->error, SR_ERROR_INPUT, "%s: a face names vertex %d, expected 0 to %lld", r->label,
                   (int)indices[i], (long long)vertex_count - 1);
}

/* ---- the whole ---- */

static sr_status read_body(struct reader *r, const struct sr_ply_header *h, struct sr_ply_mesh *mesh)
{
    bool has_vertices = false, has_faces = false;
    for (uint32_t i = 0; i < h->element_count; ++i) {
        const struct sr_ply_element *e = &h->elements[i];
        // the last value of an ascii file may end without a space
        uint64_t left = (uint64_t)(r->end - r->p) + (h->format == SR_PLY_ASCII);
        if (e->least_size && e->count > left / e->least_size)
            return sr_fail(r->error, SR_ERROR_INPUT,
                           "%s: is cut short: its head promises %llu of element \"%s\", at least %u bytes each, but "
                           "%llu bytes are left",
                           r->label, (unsigned long long)e->count, e->name, e->least_size,
                           (unsigned long long)(r->end - r->p));
        sr_status status;
        if (strcmp(e->name, "vertex") == 0 && !has_vertices) {
            has_vertices = true;
            status = read_vertices(r, e, mesh);
        } else if (strcmp(e->name, "face") == 0 && !has_faces) {
            has_faces = true;
            status = read_faces(r, e, mesh);
        } else
            status = skip_element(r, e);
        if (status != SR_OK)
            return status;
    }
    if (!has_vertices || !has_faces || mesh->triangle_count + mesh->quad_count == 0)
        return sr_fail(r->error, SR_ERROR_INPUT, "%s: expected elements \"vertex\" and \"face\", and at least one face",
                       r->label);
    sr_status status = check_indices(r, mesh->triangles, (size_t)mesh->triangle_count * 3, mesh->vertex_count);
    return status == SR_OK ? check_indices(r, mesh->quads, (size_t)mesh->quad_count * 4, mesh->vertex_count) : status;
}

sr_status sr_ply_decode(const char *label, const char *data, size_t size, struct sr_ply_mesh *mesh,
                        struct sr_error *error)
{
    struct sr_ply_header *header = sr_alloc(sizeof *header); // too large for the stack of a thread
    *mesh = (struct sr_ply_mesh){0};
    if (!header)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", label);
    sr_status status = sr_ply_header_read(label, data, size, header, error);
    struct reader r = {
        .label = label, .p = data + header->size, .end = data + size, .format = header->format, .error = error};
    if (status == SR_OK)
        status = read_body(&r, header, mesh);
    sr_free(header);
    if (status != SR_OK)
        sr_ply_free(mesh);
    return status;
}

sr_status sr_ply_read(const char *path, struct sr_ply_mesh *mesh, struct sr_error *error)
{
    char *data;
    size_t size;
    *mesh = (struct sr_ply_mesh){0};
    sr_status status = sr_file_read(path, max_file_B, &data, &size, error);
    if (status != SR_OK)
        return status;
    status = sr_ply_decode(path, data, size, mesh, error);
    sr_free(data);
    return status;
}

void sr_ply_free(struct sr_ply_mesh *mesh)
{
    sr_arena_free(&mesh->memory);
    *mesh = (struct sr_ply_mesh){0};
}
