/* SPDX-License-Identifier: MIT */
/* What of a scene no ray meets, and what stands twice: counted, and told.
 *
 * Three kinds are never met: primitives whose area is 0 in float; those with a coordinate beyond 1.844e18 m, the square root of the
 * largest float, where the ray caster leaves them out; those with numbers that are not finite, left out when a mesh is placed.
 * Limits: of curves and quadrics only the area is looked at. Copies are looked for within one mesh. */
#include "scene/private.h"

#include <stdio.h>

static const float LARGEST = 1.844e18f; // [m]
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

static void no_memory(struct sr_scene *scene)
{
    sr_fail(&scene->error, SR_ERROR_RESOURCE, "not enough memory for the scene (%zu MiB so far)", scene->arena.total >> 20);
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
        no_memory(scene);
}

void sr_scene_tell_degenerate(const struct sr_scene *scene, struct sr_log *log)
{
    const struct degenerate *all = scene->degenerates.data;
    size_t n = scene->degenerates.count;
    for (size_t i = 0; i < n && i < TOLD; ++i) {
        const struct degenerate *d = &all[i];
        char place[600] = "";
        if (d->where.file)
            snprintf(place, sizeof place, d->where.line ? "%s:%d:%d: " : "%s: ", d->where.file, d->where.line, d->where.column);
        sr_log(log, SR_WARNING, "%s%s: of %llu primitives no ray meets %llu without area, %llu beyond %g m, %llu with numbers that are not finite", place,
               d->model, (unsigned long long)d->count, (unsigned long long)d->without_area, (unsigned long long)d->too_large, (double)LARGEST,
               (unsigned long long)d->not_finite);
    }
    if (n > TOLD)
        sr_log(log, SR_WARNING, "%zu more shapes have primitives that no ray meets", n - TOLD);
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
