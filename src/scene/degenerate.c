/* SPDX-License-Identifier: MIT */
/* What of a scene no ray meets, and what stands twice: counted, and told.
 *
 * Three kinds are never met: primitives whose area is 0 in float; those with a coordinate beyond 1.844e18 m, the square
 * root of the largest float, where the ray caster leaves them out; those with numbers that are not finite, left out
 * when a mesh is placed. Limits: of curves and quadrics only the area is looked at. Copies are looked for within one
 * mesh. */
#include "scene/private.h"

#include <stdio.h>
#include <string.h>

static const float LARGEST = SR_CAST_LARGEST; // [m]
enum { TOLD = 10 };

static bool is_large(sr_vec3 p)
{
    return !(sr_max(fabsf(p.x), sr_max(fabsf(p.y), fabsf(p.z))) < LARGEST);
}

static bool has_large_vertex(struct sr_slice P)
{
    const sr_vec3 *p = P.data;
    for (uint32_t i = 0; i < P.count; ++i)
        if (is_large(p[i]))
            return true;
    return false;
}

void scene_count_degenerate(struct sr_scene *scene, const struct sr_shape_def *def)
{
    const struct sr_shape *s = &def->shape;
    uint32_t n = s->model->primitive_count(s->self);
    struct degenerate d = {.where = def->where, .model = s->model->name, .count = n};
    bool may_be_large = false;
    if (s->model == &sr_shape_trianglemesh) {
        const struct sr_shape_mesh *m = s->self;
        d.not_finite = m->left_out;
        may_be_large = has_large_vertex(m->P);
    } else if (s->model == &sr_shape_bilinearmesh) {
        const struct sr_shape_patches *m = s->self;
        d.not_finite = m->left_out;
        may_be_large = has_large_vertex(m->P);
    }
    for (uint32_t i = 0; i < n; ++i) {
        if (may_be_large) {
            struct sr_box b = s->model->bounds(s->self, i);
            if (is_large(b.lo) || is_large(b.hi)) {
                ++d.too_large;
                continue;
            }
        }
        d.without_area += !(s->model->area(s->self, i) > 0);
    }
    d.count += d.not_finite;
    scene->counts.degenerate += d.without_area;
    scene->counts.too_large += d.too_large;
    scene->counts.not_finite += d.not_finite;
    if (d.without_area + d.too_large + d.not_finite == 0)
        return;
    struct degenerate *slot = sr_array_push(&scene->degenerates, sizeof *slot);
    if (slot)
        *slot = d;
    else
        scene_no_memory(scene);
}

/* ---- telling: once for each file and kind ---- */

struct group {
    const struct degenerate *first;
    int kind;
    uint64_t unmet, of, shapes;
};

/* The name alone: places within glTF files are a part of it. */
static size_t name_length(const struct sr_location *where)
{
    const char *file = where->file ? where->file : "", *inside = where->line ? NULL : strstr(file, ": /");
    return inside ? (size_t)(inside - file) : strlen(file);
}

static bool is_same_file(const struct sr_location *a, const struct sr_location *b)
{
    size_t n = name_length(a);
    return n == name_length(b) && (n == 0 || memcmp(a->file, b->file, n) == 0);
}

static void tell(const struct group *g, struct sr_log *log)
{
    static const char *const why[3] = {"have no area", "reach beyond 1.844e+18 m", "have numbers that are not finite"};
    const struct sr_location *where = &g->first->where;
    char place[600] = "", more[100] = "";
    if (where->file)
        snprintf(place, sizeof place, where->line ? "%s:%d:%d: " : "%s: ", where->file, where->line, where->column);
    if (g->shapes > 1)
        snprintf(more, sizeof more, " (of %llu shapes of this file; this is the first)", (unsigned long long)g->shapes);
    sr_log(log, SR_WARNING, "%s%s: %llu of %llu primitives %s, and no ray meets them%s", place, g->first->model,
           (unsigned long long)g->unmet, (unsigned long long)g->of, why[g->kind], more);
}

void sr_scene_tell_degenerate(const struct sr_scene *scene, struct sr_log *log)
{
    const struct degenerate *all = scene->degenerates.data;
    struct group groups[TOLD];
    size_t count = 0, untold = 0;
    for (size_t i = 0; i < scene->degenerates.count; ++i) {
        const uint64_t unmet[3] = {all[i].without_area, all[i].too_large, all[i].not_finite};
        for (int kind = 0; kind < 3; ++kind) {
            size_t at = 0;
            while (at < count && !(groups[at].kind == kind && is_same_file(&groups[at].first->where, &all[i].where)))
                ++at;
            if (unmet[kind] == 0 || at == TOLD) {
                untold += unmet[kind] != 0;
                continue;
            }
            if (at == count)
                groups[count++] = (struct group){.first = &all[i], .kind = kind};
            groups[at].unmet += unmet[kind];
            groups[at].of += all[i].count;
            ++groups[at].shapes;
        }
    }
    for (size_t i = 0; i < count; ++i)
        tell(&groups[i], log);
    if (untold)
        sr_log(log, SR_WARNING, "%zu shapes of other files have primitives that no ray meets", untold);
}

/* ---- copies ---- */

/* The same for corners in any order; -0 is 0. */
static uint64_t key_of(const sr_vec3 *P, const int32_t *corners)
{
    uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
        sr_vec3 p = P[corners[k]];
        float c[3] = {p.x + 0, p.y + 0, p.z + 0};
        key += sr_hash_bytes(c, sizeof c, 1);
    }
    return key ? key : 1;
}

static uint64_t count_duplicates(const struct sr_shape_mesh *m)
{
    uint64_t n = m->indices.count / 3, size = 16, found = 0;
    while (size < 2 * n)
        size *= 2;
    uint64_t *table = sr_alloc(size * sizeof *table);
    for (uint64_t i = 0; table && i < n; ++i) {
        uint64_t key = key_of(m->P.data, (const int32_t *)m->indices.data + 3 * i), at = key & (size - 1);
        while (table[at] && table[at] != key)
            at = (at + 1) & (size - 1);
        found += table[at] == key;
        table[at] = key;
    }
    sr_free(table);
    return found;
}

uint64_t sr_scene_count_duplicates(const struct sr_scene *scene)
{
    uint64_t found = 0;
    struct object *const *objects = scene->objects.data;
    for (size_t i = 0; i < scene->objects.count; ++i)
        for (uint32_t k = 0; k < objects[i]->shape_count; ++k)
            if (objects[i]->shapes[k].is_mesh)
                found += count_duplicates(objects[i]->shapes[k].shape.self);
    return found;
}
