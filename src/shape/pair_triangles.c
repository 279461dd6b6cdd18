/* SPDX-License-Identifier: MIT */
/* Triangles by pairs: each with the next one, where they share an edge that they walk in opposite directions.
 *
 * Modellers cut quads into triangles that follow each other, so most triangles have such a neighbour, and looking no
 * further costs one pass and no memory. What the first corner of a triangle was matters only where there is no uv: then
 * it is kept. */
#include "shape/mesh.h"

#include <string.h>

/* The corner of each that the other lacks, or false: t[i] … t[i+1] is walked back by u. */
static bool find_opposite(const int32_t *t, const int32_t *u, int *of_t, int *of_u)
{
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (t[i] == u[(k + 1) % 3] && t[(i + 1) % 3] == u[k]) {
                *of_t = (i + 2) % 3;
                *of_u = (k + 2) % 3;
                return true;
            }
    return false;
}

uint32_t sr_shape_count_pairs(const struct sr_shape_mesh *m)
{
    const int32_t *c = m->indices.data;
    uint32_t n = m->indices.count / 3, pairs = 0;
    int of_t, of_u;
    for (uint32_t i = 0; i + 1 < n; ++i) {
        bool is_pair = find_opposite(c + 3 * (size_t)i, c + 3 * (size_t)i + 3, &of_t, &of_u);
        pairs += is_pair;
        i += is_pair;
    }
    return pairs;
}

static void put_turned(int32_t *to, const int32_t *t, int first)
{
    for (int i = 0; i < 3; ++i)
        to[i] = t[(first + i) % 3];
}

/* One entry for all if every pair is turned alike. */
static void keep_turns(struct sr_shape_mesh *m, const uint8_t *turns, uint32_t n)
{
    bool is_even = 2 * m->pairs == n;
    for (uint32_t i = 2; i < n && is_even; ++i)
        is_even = turns[i] == turns[i & 1];
    m->turns = turns;
    m->turn_mask = is_even ? 1 : UINT32_MAX;
}

sr_status sr_shape_pair_triangles(struct sr_shape_mesh *m, struct sr_arena *arena, struct sr_error *error)
{
    uint32_t n = m->indices.count / 3, pairs = sr_shape_count_pairs(m), alone = 0, done = 0;
    if (m->pairs || pairs == 0)
        return SR_OK;
    // prepared, so these are the mesh's own
    int32_t *c = (int32_t *)(uintptr_t)m->indices.data, *faces = (int32_t *)(uintptr_t)m->face_indices.data;
    int32_t *rest = sr_alloc(4 * (size_t)(n - 2 * pairs) * sizeof *rest); // corners and face of those that stay alone
    uint8_t *turns = m->uv.count ? NULL : sr_arena_alloc(arena, n);
    if (!rest || (!m->uv.count && !turns)) {
        sr_free(rest);
        return sr_fail(error, SR_ERROR_RESOURCE, "trianglemesh: no memory for %u triangles", n);
    }
    for (uint32_t i = 0; i < n; ++i) { // what is written never overtakes what is read
        int of_t = 0, of_u = 0;
        int32_t t[6], face[2] = {faces ? faces[i] : 0, faces && i + 1 < n ? faces[i + 1] : 0};
        memcpy(t, c + 3 * (size_t)i, (i + 1 < n ? 6 : 3) * sizeof *t);
        if (i + 1 == n || !find_opposite(t, t + 3, &of_t, &of_u)) {
            memcpy(rest + 4 * (size_t)alone, t, 3 * sizeof *t);
            rest[4 * (size_t)alone++ + 3] = face[0];
            continue;
        }
        put_turned(c + 3 * (size_t)done, t, (of_t + 2) % 3); // (d, a, b): a is the opposite one
        put_turned(c + 3 * (size_t)done + 3, t + 3, of_u);   // (c, d, b)
        if (turns) {
            turns[done] = (uint8_t)((4 - of_t) % 3);
            turns[done + 1] = (uint8_t)((3 - of_u) % 3);
        }
        if (faces)
            memcpy(faces + done, face, sizeof face);
        done += 2;
        ++i;
    }
    for (uint32_t i = 0; i < alone; ++i, ++done) {
        memcpy(c + 3 * (size_t)done, rest + 4 * (size_t)i, 3 * sizeof *c);
        if (faces)
            faces[done] = rest[4 * (size_t)i + 3];
    }
    sr_free(rest);
    m->pairs = pairs;
    sr_mesh_keep_planes(m, arena); // in the new order
    if (turns)
        keep_turns(m, turns, n);
    return SR_OK;
}
