/* SPDX-License-Identifier: MIT */
/* Wavefront OBJ: vertices, faces of any number of corners, groups, materials. The text is gone through twice: to count,
 * and to read into arrays of the right size. One triangle mesh for each group and material; corners that agree in
 * position, texture coordinates and normal are one vertex.
 *
 * Format: Wavefront Technologies, Advanced Visualizer manual, appendix B1 (1995). Curves, surfaces, points, lines: left
 * out. */
#include "import/obj.h"

#include "import/framing.h"
#include "import/number.h"
#include "import/polygon.h"

#include <string.h>
#include <strings.h>

enum { MOST_PARTS = 4096 };
static const size_t max_text_B = (size_t)8 << 30;

struct part {
    uint32_t material1; // index from 1; 0: none
    const char *group;
    uint32_t faces, corners;
};

struct obj {
    struct sr_compose c;
    struct sr_arena scratch;
    uint32_t v_count, vt_count, vn_count, face_count, corner_count; // as counted, then as read
    uint32_t vertices, textures, normals, faces, corners;
    sr_vec3 *v, *vn;
    sr_vec2 *vt;
    int32_t *corner;      // three for each: position, texture coordinates, normal; from 0, -1 none
    uint32_t *face_start; // in corner, face_count + 1 of them
    uint32_t *face_part;
    struct sr_array parts, materials; // struct part, struct sr_obj_material
    struct sr_pbrt_names part_names, material_names;
    uint32_t dropped, unknown;
    const char *group;
    uint32_t material1, part1;
    int64_t budget; // of cutting ears
    struct sr_box bounds;

    struct sr_array unique, map; // of the part at work: int32_t[3]; uint32_t, from 1
};

/* ---- words ---- */

const char *sr_obj_skip(const char *p)
{
    for (;; ++p) {
        if (*p == '\\' && (p[1] == '\n' || (p[1] == '\r' && p[2] == '\n')))
            p += p[1] == '\r' ? 2 : 1;
        else if (*p != ' ' && *p != '\t' && *p != '\r')
            return p;
    }
}

const char *sr_obj_next_line(const char *p, int *line)
{
    for (; *p && *p != '\n'; ++p)
        if (*p == '\\' && (p[1] == '\n' || (p[1] == '\r' && p[2] == '\n'))) {
            p += p[1] == '\r' ? 2 : 1;
            ++*line;
        }
    ++*line;
    return *p ? p + 1 : p;
}

size_t sr_obj_word_length(const char *p)
{
    size_t n = 0;
    while (p[n] && p[n] != ' ' && p[n] != '\t' && p[n] != '\r' && p[n] != '\n')
        ++n;
    return n;
}

bool sr_obj_is_word(const char *p, const char *word)
{
    size_t n = strlen(word);
    return sr_obj_word_length(p) == n && strncasecmp(p, word, n) == 0;
}

int sr_obj_numbers(const char *p, int count, double *values)
{
    int n = 0;
    for (const char *end; n < count && (end = sr_number_read(p = sr_obj_skip(p), &values[n])); p = end)
        ++n;
    return n;
}

/* the rest of the line, without blanks at its end */
static size_t rest_length(const char *p)
{
    size_t n = strcspn(p, "\n");
    while (n > 0 && (p[n - 1] == ' ' || p[n - 1] == '\t' || p[n - 1] == '\r'))
        --n;
    return n;
}

/* ---- the first time through ---- */

static void count(struct obj *o, const char *text)
{
    int line = 1;
    uint64_t v = 0, vt = 0, vn = 0, f = 0, corners = 0;
    for (const char *p = text; *p; p = sr_obj_next_line(p, &line)) {
        p = sr_obj_skip(p);
        v += sr_obj_is_word(p, "v");
        vt += sr_obj_is_word(p, "vt");
        vn += sr_obj_is_word(p, "vn");
        if (sr_obj_is_word(p, "f") || sr_obj_is_word(p, "fo")) {
            ++f;
            for (p = sr_obj_skip(p + sr_obj_word_length(p)); *p && *p != '\n';
                 p = sr_obj_skip(p + sr_obj_word_length(p)))
                ++corners;
        }
    }
    if (v > INT32_MAX / 4 || corners > INT32_MAX / 4) {
        sr_compose_fail(&o->c, SR_ERROR_INPUT, "%llu vertices and %llu corners of faces: expected less than 2^29",
                        (unsigned long long)v, (unsigned long long)corners);
        return;
    }
    o->v_count = (uint32_t)v;
    o->vt_count = (uint32_t)vt;
    o->vn_count = (uint32_t)vn;
    o->face_count = (uint32_t)f;
    o->corner_count = (uint32_t)corners;
}

static bool make_room(struct obj *o)
{
    o->v = sr_arena_alloc(&o->scratch, (o->v_count + 1) * sizeof *o->v + 16);
    o->vt = sr_arena_alloc(&o->scratch, (o->vt_count + 1) * sizeof *o->vt);
    o->vn = sr_arena_alloc(&o->scratch, (o->vn_count + 1) * sizeof *o->vn + 16);
    o->corner = sr_arena_alloc(&o->scratch, (3 * (size_t)o->corner_count + 1) * sizeof *o->corner);
    o->face_start = sr_arena_alloc(&o->scratch, (o->face_count + 1) * sizeof *o->face_start);
    o->face_part = sr_arena_alloc(&o->scratch, (o->face_count + 1) * sizeof *o->face_part);
    return o->v && o->vt && o->vn && o->corner && o->face_start && o->face_part;
}

static void no_memory(struct obj *o)
{
    sr_fail(o->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", o->c.path);
}

/* ---- the second time ---- */

static bool read_vector(struct obj *o, const char *p, const char *word, int least, float *out, int most)
{
    double values[3] = {0, 0, 0};
    int n = sr_obj_numbers(p, most, values);
    for (int i = 0; i < most; ++i) {
        out[i] = (float)values[i];
        if (!isfinite(out[i]))
            n = -1;
    }
    if (n < least)
        sr_compose_fail(&o->c, SR_ERROR_INPUT, "%s: expected %d numbers that are finite", word, least);
    return n >= least;
}

/* One number of "7/2/-1": from 1, or backwards from those read so far. */
static const char *read_index(struct obj *o, const char *p, const char *what, uint32_t so_far, uint32_t all,
                              int32_t *index)
{
    bool is_negative = *p == '-';
    int64_t n = 0;
    size_t length = sr_obj_word_length(p);
    const char *word = p, *start = p += is_negative;
    for (; *p >= '0' && *p <= '9'; ++p)
        n = n < INT32_MAX ? n * 10 + (*p - '0') : n;
    n = is_negative ? (int64_t)so_far - n : n - 1;
    if (p == start || n < 0 || n >= (int64_t)all) {
        sr_compose_fail(&o->c, SR_ERROR_INPUT, "f: %.*s is no %s: expected 1 to %u, or -1 to -%u",
                        (int)(length > 40 ? 40 : length), word, what, (unsigned)all, (unsigned)so_far);
        return NULL;
    }
    *index = (int32_t)n;
    return p;
}

static const char *read_corner(struct obj *o, const char *p, int32_t corner[3])
{
    corner[1] = corner[2] = -1;
    p = read_index(o, p, "vertex", o->vertices, o->v_count, &corner[0]);
    if (p && *p == '/' && p[1] != '/')
        p = read_index(o, p + 1, "texture coordinate", o->textures, o->vt_count, &corner[1]);
    else if (p && *p == '/')
        ++p;
    if (p && *p == '/')
        p = read_index(o, p + 1, "normal", o->normals, o->vn_count, &corner[2]);
    if (p && sr_obj_word_length(p) > 0) {
        sr_compose_fail(&o->c, SR_ERROR_INPUT, "f: expected corners such as 1, 1/2, 1//3 or 1/2/3");
        return NULL;
    }
    return p;
}

/* The mesh that faces of this group and material go to; of the material alone, where there are too many. */
static uint32_t find_part(struct obj *o)
{
    const char *group = o->parts.count < MOST_PARTS ? o->group : "";
    const char *key = sr_compose_printf(&o->c, "%u %.900s", (unsigned)o->material1, group);
    uint32_t index1 = sr_pbrt_names_find(&o->part_names, key);
    if (index1)
        return index1;
    struct part *part = sr_array_push(&o->parts, sizeof *part);
    if (!part || !sr_pbrt_names_add(&o->part_names, key, (uint32_t)o->parts.count)) {
        no_memory(o);
        return 0;
    }
    *part = (struct part){.material1 = o->material1, .group = group};
    return (uint32_t)o->parts.count;
}

static void read_face(struct obj *o, const char *p)
{
    uint32_t start = o->corners;
    for (p = sr_obj_skip(p); *p && *p != '\n' && *p != '#'; p = sr_obj_skip(p)) {
        int32_t *corner = &o->corner[3 * (size_t)o->corners];
        if (!(p = read_corner(o, p, corner)))
            return;
        bool repeats = o->corners > start && corner[-3] == corner[0];
        o->corners += !repeats;
    }
    while (o->corners > start + 1 && o->corner[3 * (size_t)(o->corners - 1)] == o->corner[3 * (size_t)start])
        --o->corners;
    if (o->corners - start < 3) {
        o->corners = start;
        ++o->dropped;
        return;
    }
    if (!o->part1 && !(o->part1 = find_part(o)))
        return;
    struct part *part = SR_PBRT_AT(o->parts, struct part, o->part1 - 1);
    ++part->faces;
    part->corners += o->corners - start;
    o->face_part[o->faces] = o->part1 - 1;
    o->face_start[o->faces++] = start;
}

static void use_material(struct obj *o, const char *p)
{
    const char *name = sr_pbrt_text(o->c.d, p, rest_length(p));
    if (!name) {
        no_memory(o);
        return;
    }
    o->part1 = 0;
    o->material1 = sr_pbrt_names_find(&o->material_names, name);
    if (!o->material1 && ++o->unknown <= 10)
        sr_compose_warn(&o->c, "usemtl: there is no material \"%.100s\": grey instead", name);
}

static void read_materials(struct obj *o, const char *p)
{
    size_t before = o->materials.count;
    const char *name = sr_pbrt_text(o->c.d, p, rest_length(p));
    char *path = name ? sr_path_beside(&o->scratch, o->c.path, name) : NULL;
    if (!path) {
        no_memory(o);
        return;
    }
    struct sr_location where = o->c.where;
    sr_obj_materials_read(&o->c, path, &o->materials);
    o->c.where = where;
    for (size_t i = before; i < o->materials.count; ++i) // a later one of the same name takes its place
        if (!sr_pbrt_names_add(&o->material_names, SR_PBRT_AT(o->materials, struct sr_obj_material, i)->name,
                               (uint32_t)i + 1))
            no_memory(o);
}

static void read_line(struct obj *o, const char *p)
{
    const char *rest = sr_obj_skip(p + sr_obj_word_length(p));
    if (sr_obj_is_word(p, "v")) {
        if (read_vector(o, rest, "v", 3, &o->v[o->vertices].x, 3))
            ++o->vertices;
    } else if (sr_obj_is_word(p, "vt")) {
        if (read_vector(o, rest, "vt", 1, &o->vt[o->textures].x, 2))
            ++o->textures;
    } else if (sr_obj_is_word(p, "vn")) {
        if (read_vector(o, rest, "vn", 3, &o->vn[o->normals].x, 3))
            ++o->normals;
    } else if (sr_obj_is_word(p, "f") || sr_obj_is_word(p, "fo"))
        read_face(o, rest);
    else if (sr_obj_is_word(p, "usemtl"))
        use_material(o, rest);
    else if (sr_obj_is_word(p, "mtllib"))
        read_materials(o, rest);
    else if (sr_obj_is_word(p, "g") || sr_obj_is_word(p, "o")) {
        const char *name = sr_pbrt_text(o->c.d, rest, rest_length(rest));
        o->group = name ? name : "";
        o->part1 = 0;
    }
}

/* ---- meshes ---- */

static uint32_t hash_of(const int32_t k[3])
{
    uint64_t h = (uint64_t)(uint32_t)k[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)(uint32_t)k[1] * 0xc2b2ae3d27d4eb4fu ^
                 (uint64_t)(uint32_t)k[2] * 0x165667b19e3779f9u;
    return (uint32_t)(h >> 32);
}

static bool grow_map(struct obj *o, size_t slots)
{
    sr_array_free(&o->map);
    if (!sr_array_reserve(&o->map, slots, sizeof(uint32_t)))
        return false;
    o->map.count = slots;
    memset(o->map.data, 0, slots * sizeof(uint32_t));
    const int32_t(*unique)[3] = o->unique.data;
    uint32_t *map = o->map.data;
    for (uint32_t i = 0; i < o->unique.count; ++i) {
        size_t at = hash_of(unique[i]) & (slots - 1);
        while (map[at])
            at = (at + 1) & (slots - 1);
        map[at] = i + 1;
    }
    return true;
}

/* the number of the vertex that this corner is */
static uint32_t find_vertex(struct obj *o, const int32_t k[3])
{
    if (2 * (o->unique.count + 1) > o->map.count && !grow_map(o, o->map.count ? 2 * o->map.count : 64)) {
        no_memory(o);
        return 0;
    }
    uint32_t *map = o->map.data;
    size_t at = hash_of(k) & (o->map.count - 1);
    for (; map[at]; at = (at + 1) & (o->map.count - 1))
        if (memcmp(((int32_t(*)[3])o->unique.data)[map[at] - 1], k, 3 * sizeof *k) == 0)
            return map[at] - 1;
    int32_t(*slot)[3] = sr_array_push(&o->unique, 3 * sizeof *k);
    if (!slot) {
        no_memory(o);
        return 0;
    }
    memcpy(*slot, k, 3 * sizeof *k);
    map[at] = (uint32_t)o->unique.count;
    return map[at] - 1;
}

static void compose_part(struct obj *o, const struct part *part, const int32_t *indices, size_t index_count)
{
    size_t n = o->unique.count;
    const int32_t(*unique)[3] = o->unique.data;
    bool has_normals = true, has_uv = false;
    for (size_t i = 0; i < n; ++i) {
        has_normals = has_normals && unique[i][2] >= 0;
        has_uv = has_uv || unique[i][1] >= 0;
    }
    float *P = sr_arena_alloc(&o->c.d->words, n * 12 + 16),
          *N = has_normals ? sr_arena_alloc(&o->c.d->words, n * 12 + 16) : NULL,
          *uv = has_uv ? sr_arena_alloc(o->c.d->data, n * 8 + 16) : NULL;
    if (!P || (has_normals && !N) || (has_uv && !uv)) {
        no_memory(o);
        return;
    }
    for (size_t i = 0; i < n; ++i) {
        memcpy(P + 3 * i, &o->v[unique[i][0]], 12);
        o->bounds = sr_box_add(o->bounds, o->v[unique[i][0]]);
        if (N)
            memcpy(N + 3 * i, &o->vn[unique[i][2]], 12);
        if (uv && unique[i][1] >= 0)
            memcpy(uv + 2 * i, &o->vt[unique[i][1]], 8);
    }
    struct sr_obj_material *m =
        part->material1 ? SR_PBRT_AT(o->materials, struct sr_obj_material, part->material1 - 1) : NULL;
    o->c.material = NULL;
    o->c.area_light1 = 0;
    if (m) {
        sr_obj_material_wear(&o->c, m);
        sr_obj_material_alpha(&o->c, m);
        if (m->is_textured && !has_uv)
            sr_compose_warn(&o->c, "\"%.100s\" wears \"%.100s\", which has textures, and has no texture coordinates",
                            part->group, m->name);
    }
    sr_compose_floats(&o->c, SR_PBRT_POINT3, "P", P, 3 * n);
    if (N)
        sr_compose_floats(&o->c, SR_PBRT_NORMAL, "N", N, 3 * n);
    if (uv)
        sr_compose_floats(&o->c, SR_PBRT_POINT2, "uv", uv, 2 * n);
    sr_compose_ints(&o->c, "indices", indices, index_count);
    sr_compose_named_shape(&o->c, part->group[0] ? part->group : NULL, "trianglemesh");
}

/* faces: of this part, in the order of the file */
static void build_part(struct obj *o, const struct part *part, const uint32_t *faces, uint32_t *triangles,
                       uint32_t *vertex, bool *has_fans)
{
    size_t index_count = 3 * ((size_t)part->corners - 2 * (size_t)part->faces), at = 0;
    int32_t *indices = sr_arena_alloc(o->c.d->data, index_count * sizeof *indices + 16);
    if (!indices) {
        no_memory(o);
        return;
    }
    o->unique.count = 0;
    if (o->map.count)
        memset(o->map.data, 0, o->map.count * sizeof(uint32_t));
    for (uint32_t i = 0; i < part->faces && o->c.error->status == SR_OK; ++i) {
        const int32_t *corner = &o->corner[3 * (size_t)o->face_start[faces[i]]];
        uint32_t n = o->face_start[faces[i] + 1] - o->face_start[faces[i]];
        *has_fans = !sr_polygon_triangulate(o->v, corner, 3, n, &o->budget, triangles) || *has_fans;
        for (uint32_t k = 0; k < n; ++k)
            vertex[k] = find_vertex(o, corner + 3 * (size_t)k);
        for (uint32_t k = 0; k < 3 * (n - 2); ++k)
            indices[at++] = (int32_t)vertex[triangles[k]];
    }
    if (o->c.error->status == SR_OK)
        compose_part(o, part, indices, index_count);
}

static void build(struct obj *o)
{
    uint32_t largest = 3;
    size_t parts = o->parts.count;
    o->face_start[o->faces] = o->corners;
    for (uint32_t f = 0; f < o->faces; ++f)
        largest = o->face_start[f + 1] - o->face_start[f] > largest ? o->face_start[f + 1] - o->face_start[f] : largest;
    uint32_t *order = sr_arena_alloc(&o->scratch, (o->faces + 1) * sizeof *order),
             *start = sr_arena_alloc(&o->scratch, (parts + 1) * sizeof *start),
             *triangles = sr_arena_alloc(&o->scratch, 3 * (size_t)largest * sizeof *triangles),
             *vertex = sr_arena_alloc(&o->scratch, largest * sizeof *vertex);
    if (!order || !start || !triangles || !vertex) {
        no_memory(o);
        return;
    }
    for (size_t i = 0; i < parts; ++i)
        start[i + 1] = start[i] + SR_PBRT_AT(o->parts, struct part, i)->faces;
    for (uint32_t f = 0; f < o->faces; ++f)
        order[start[o->face_part[f]]++] = f;
    bool has_fans = false;
    uint32_t first = 0;
    for (size_t i = 0; i < parts && o->c.error->status == SR_OK; ++i) {
        const struct part *part = SR_PBRT_AT(o->parts, struct part, i);
        build_part(o, part, order + first, triangles, vertex, &has_fans);
        first += part->faces;
    }
    if (has_fans)
        sr_compose_warn(
            &o->c,
            "some polygons cross themselves, or are too large to be cut properly: they became fans of triangles");
    if (o->dropped)
        sr_compose_warn(&o->c, "%u faces of fewer than three corners are left out", (unsigned)o->dropped);
}

static bool any_light(const struct obj *o)
{
    return o->c.d->area_lights.count > 0;
}

static void read_all(struct obj *o, const char *text, const struct sr_import_options *options)
{
    static const sr_vec3 up = {0, 1, 0};
    count(o, text);
    if (o->c.error->status == SR_OK && !make_room(o))
        no_memory(o);
    int line = 1;
    for (const char *p = text; *p && o->c.error->status == SR_OK; p = sr_obj_next_line(p, &line)) {
        o->c.where.line = line;
        o->c.where.column = 1;
        read_line(o, sr_obj_skip(p));
    }
    o->c.where.line = 0;
    if (o->c.error->status == SR_OK && o->faces == 0)
        sr_compose_fail(&o->c, SR_ERROR_INPUT, "there is not one face: expected an OBJ file with lines \"f …\"");
    if (o->c.error->status == SR_OK)
        build(o);
    if (o->c.error->status != SR_OK)
        return;
    o->c.material = NULL;
    o->c.area_light1 = 0;
    sr_vec3 key = sr_frame_camera(&o->c, options, o->bounds, up);
    if (o->c.error->status == SR_OK && !any_light(o))
        sr_frame_sky(&o->c, key, up);
    sr_compose_setting(&o->c, "Integrator", "path");
}

sr_status sr_obj_read_text(const char *label, const char *text, size_t size, const struct sr_import_options *options,
                           struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                           struct sr_error *error)
{
    struct obj o = {.group = "", .budget = 200 * 1000 * 1000, .bounds = sr_box_empty()};
    sr_compose_begin(&o.c, label, data, log, out, error);
    o.c.path = o.c.where.file = sr_compose_word(&o.c, label);
    if (error->status == SR_OK && memchr(text, 0, size))
        sr_compose_fail(&o.c, SR_ERROR_INPUT, "a NUL byte in the text: this is no OBJ file");
    if (error->status == SR_OK)
        read_all(&o, text, options);
    out->text_B += size;
    out->hash = sr_pbrt_hash(out->hash, text, size);
    struct sr_array *arrays[] = {&o.parts, &o.materials, &o.unique, &o.map};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i)
        sr_array_free(arrays[i]);
    sr_pbrt_names_free(&o.part_names);
    sr_pbrt_names_free(&o.material_names);
    sr_arena_free(&o.scratch);
    return sr_compose_end(&o.c);
}

sr_status sr_obj_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error)
{
    char *text;
    size_t size;
    *out = (struct sr_pbrt_description){0};
    if (sr_file_read(path, max_text_B, &text, &size, error) != SR_OK)
        return error->status;
    sr_status status = sr_obj_read_text(path, text, size, options, data, log, out, error);
    sr_free(text);
    return status;
}
