/* SPDX-License-Identifier: MIT */
/* STL: triangles with nothing else, as text or in 50 bytes each; and PLY files alone. Both are grey, with a camera and
 * a sky.
 *
 * A binary file is 80 bytes, the number of triangles, and for each a normal, three vertices and two bytes that some use
 * for colour. Normals are left aside: facets have their own. Corners at the same place are one vertex. z is up. */
#include "import/framing.h"
#include "import/number.h"
#include "import/obj.h"
#include "import/ply.h"

#include <string.h>

static const size_t max_B = (size_t)8 << 30;

struct stl {
    struct sr_compose c;
    struct sr_array P; // sr_vec3, of all corners
};

static uint32_t word_at(const char *p)
{
    const unsigned char *b = (const unsigned char *)p;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void read_binary(struct stl *s, const char *bytes, uint32_t count)
{
    if (!sr_array_reserve(&s->P, 3 * (size_t)count, sizeof(sr_vec3))) {
        sr_fail(s->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", s->c.path);
        return;
    }
    float *to = s->P.data;
    for (uint32_t i = 0; i < count; ++i)
        for (int k = 0; k < 9; ++k, ++to) {
            uint32_t bits = word_at(bytes + 84 + 50 * (size_t)i + 12 + 4 * k);
            memcpy(to, &bits, 4);
            if (!isfinite(*to)) {
                sr_compose_fail(&s->c, SR_ERROR_INPUT, "triangle %u has a corner that is nowhere (%g)", (unsigned)i,
                                (double)*to);
                return;
            }
        }
    s->P.count = 3 * (size_t)count;
}

static void read_ascii(struct stl *s, const char *text)
{
    int line = 1;
    for (const char *p = text; *p && s->c.error->status == SR_OK; p = sr_obj_next_line(p, &line)) {
        p = sr_obj_skip(p);
        double v[3];
        if (!sr_obj_is_word(p, "vertex"))
            continue;
        s->c.where.line = line;
        s->c.where.column = 1;
        sr_vec3 *to = sr_array_push(&s->P, sizeof *to);
        if (!to)
            sr_fail(s->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", s->c.path);
        else if (sr_obj_numbers(p + 6, 3, v) == 3)
            *to = (sr_vec3){(float)v[0], (float)v[1], (float)v[2]};
        if (to && (sr_obj_numbers(p + 6, 3, v) != 3 || !sr_is_finite(*to)))
            sr_compose_fail(&s->c, SR_ERROR_INPUT, "vertex: expected three numbers that are finite");
    }
    s->c.where.line = 0;
    if (s->c.error->status == SR_OK && s->P.count % 3 != 0)
        sr_compose_fail(&s->c, SR_ERROR_INPUT, "%zu vertices: expected three for each facet; the file has been cut",
                        s->P.count);
}

/* Corners to vertices: equal places become one. */
static void compose_mesh(struct stl *s, struct sr_box *bounds)
{
    size_t n = s->P.count, slots = 64, unique = 0;
    while (slots < n + n / 2)
        slots *= 2;
    sr_vec3 *P = s->P.data;
    struct sr_arena scratch = {0};
    uint32_t *map = sr_arena_alloc(&scratch, slots * sizeof *map);
    int32_t *indices = sr_arena_alloc(s->c.d->data, n * sizeof *indices + 16);
    for (size_t i = 0; map && indices && i < n; ++i) {
        uint32_t bits[3];
        sr_vec3 p = {P[i].x + 0.0f, P[i].y + 0.0f, P[i].z + 0.0f}; // -0 is 0
        memcpy(bits, &p, sizeof bits);
        uint64_t h = bits[0] * 0x9e3779b97f4a7c15u ^ bits[1] * 0xc2b2ae3d27d4eb4fu ^ bits[2] * 0x165667b19e3779f9u;
        size_t at = (size_t)(h >> 29) & (slots - 1);
        while (map[at] && memcmp(&P[map[at] - 1], &p, 12) != 0)
            at = (at + 1) & (slots - 1);
        if (!map[at]) { // unique ones move to the front, behind which nobody looks any more
            P[unique] = p;
            map[at] = (uint32_t)++unique;
            *bounds = sr_box_add(*bounds, p);
        }
        indices[i] = (int32_t)map[at] - 1;
    }
    sr_arena_free(&scratch);
    float *kept = indices ? sr_arena_alloc(&s->c.d->words, unique * 12 + 16) : NULL;
    if (!map || !kept) {
        sr_fail(s->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", s->c.path);
        return;
    }
    memcpy(kept, P, unique * 12);
    sr_compose_floats(&s->c, SR_PBRT_POINT3, "P", kept, 3 * unique);
    sr_compose_ints(&s->c, "indices", indices, n);
    sr_compose_shape(&s->c, "trianglemesh");
}

static void finish(struct sr_compose *c, const struct sr_import_options *options, struct sr_box bounds, sr_vec3 up)
{
    if (c->error->status != SR_OK)
        return;
    sr_vec3 key = sr_frame_camera(c, options, bounds, up);
    if (c->error->status == SR_OK)
        sr_frame_sky(c, key, up);
    sr_compose_setting(c, "Integrator", "path");
}

sr_status sr_stl_read_bytes(const char *label, const char *bytes, size_t size, const struct sr_import_options *options,
                            struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                            struct sr_error *error)
{
    struct stl s = {0};
    struct sr_box bounds = sr_box_empty();
    sr_compose_begin(&s.c, label, data, log, out, error);
    s.c.path = s.c.where.file = sr_compose_word(&s.c, label);
    uint64_t claimed = size >= 84 ? word_at(bytes + 80) : 0;
    bool is_ascii = size >= 5 && memcmp(bytes, "solid", 5) == 0 && !memchr(bytes, 0, size) &&
                    !(size >= 84 && size == 84 + 50 * claimed);
    if (error->status == SR_OK && is_ascii)
        read_ascii(&s, bytes);
    else if (error->status == SR_OK && size < 84)
        sr_compose_fail(&s.c, SR_ERROR_INPUT, "%zu bytes: expected \"solid\", or 84 bytes and more", size);
    else if (error->status == SR_OK && 84 + 50 * claimed > size)
        sr_compose_fail(&s.c, SR_ERROR_INPUT, "says that it has %u triangles, %llu bytes, and has %zu bytes",
                        (unsigned)claimed, (unsigned long long)(84 + 50 * claimed), size);
    else if (error->status == SR_OK && claimed > INT32_MAX / 4)
        sr_compose_fail(&s.c, SR_ERROR_INPUT, "%u triangles: expected less than 2^29", (unsigned)claimed);
    else if (error->status == SR_OK)
        read_binary(&s, bytes, (uint32_t)claimed);
    if (error->status == SR_OK && s.P.count == 0)
        sr_compose_fail(&s.c, SR_ERROR_INPUT, "there is not one triangle");
    if (error->status == SR_OK)
        compose_mesh(&s, &bounds);
    finish(&s.c, options, bounds, (sr_vec3){0, 0, 1});
    out->text_B = size;
    out->hash = sr_pbrt_hash(out->hash, bytes, size);
    sr_array_free(&s.P);
    return sr_compose_end(&s.c);
}

sr_status sr_stl_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error)
{
    char *bytes;
    size_t size;
    *out = (struct sr_pbrt_description){0};
    if (sr_file_read(path, max_B, &bytes, &size, error) != SR_OK)
        return error->status;
    sr_status status = sr_stl_read_bytes(path, bytes, size, options, data, log, out, error);
    sr_free(bytes);
    return status;
}

/* ---- PLY ---- */

/* Read here for its size alone; the scene names the file. */
sr_status sr_ply_scene_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                            struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error)
{
    struct sr_compose c;
    struct sr_ply_mesh mesh = {0};
    struct sr_box bounds = sr_box_empty();
    sr_compose_begin(&c, path, data, log, out, error);
    c.path = c.where.file = sr_compose_word(&c, path);
    if (error->status == SR_OK && sr_ply_read(path, &mesh, error) == SR_OK) {
        for (uint32_t i = 0; i < mesh.vertex_count; ++i)
            bounds = sr_box_add(bounds, mesh.P[i]);
        const char *slash = strrchr(path, '/');
        sr_compose_string(&c, "filename", slash ? slash + 1 : path);
        sr_compose_shape(&c, "plymesh");
        sr_ply_free(&mesh);
    }
    finish(&c, options, bounds, (sr_vec3){0, 1, 0});
    return sr_compose_end(&c);
}
