/* SPDX-License-Identifier: MIT */
/* Vertex arrays: checked once, then stored where the ray caster and the shading find them, in the space of placement.
 *
 *     P' = M P [m]    N' = M^-T N / |M^-T N| [1]    S' = M S [1]
 *
 * rounded once from double. Reversed orientation turns the shading normals too, since where there are any, they say
 * which side is outside (M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering, 4th ed. 2023, section 6.5). */
#include "shape/mesh.h"

#include <string.h>

static bool all_finite(const float *x, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (!isfinite(x[i]))
            return false;
    }
    return true;
}

static bool is_finite_vertex(const struct sr_mesh_arrays *m, int32_t vertex)
{
    const struct sr_slice *const vectors[] = {m->P, m->N, m->S};
    for (int i = 0; i < 3; ++i)
        if (vectors[i] && vectors[i]->count && !sr_is_finite(((const sr_vec3 *)vectors[i]->data)[vertex]))
            return false;
    return !m->uv->count || all_finite((const float *)m->uv->data + 2 * vertex, 2);
}

/* Primitives with a vertex that is not all numbers are left out, and counted; such a vertex then is 0. The slices are
 * the arena's own. */
static uint32_t leave_out(const struct sr_mesh_arrays *m)
{
    int32_t *indices = (int32_t *)(uintptr_t)m->indices->data, *faces = (int32_t *)(uintptr_t)m->face_indices->data;
    uint32_t n = m->indices->count / m->corners, kept = 0;
    for (uint32_t i = 0; i < n; ++i) {
        bool is_good = true;
        for (uint32_t k = 0; k < m->corners; ++k)
            is_good = is_good && is_finite_vertex(m, indices[i * m->corners + k]);
        if (!is_good)
            continue;
        memmove(indices + kept * m->corners, indices + i * m->corners, m->corners * sizeof *indices);
        if (m->face_indices->count)
            faces[kept] = faces[i];
        ++kept;
    }
    m->indices->count = kept * m->corners;
    if (m->face_indices->count)
        m->face_indices->count = kept;
    sr_vec3 *P = (sr_vec3 *)(uintptr_t)m->P->data;
    for (uint32_t i = 0; i < m->P->count; ++i)
        if (!sr_is_finite(P[i]))
            P[i] = (sr_vec3){0, 0, 0};
    return n - kept;
}

static sr_status check_count(const struct sr_mesh_arrays *m, const char *what, const struct sr_slice *s,
                             uint32_t expected, const char *because, struct sr_error *error)
{
    if (s->count != 0 && s->count != expected)
        return sr_fail(error, SR_ERROR_INPUT, "%s: \"%s\" has %u values, expected %u, %s", m->name, what, s->count,
                       expected, because);
    return SR_OK;
}

static sr_status check(const struct sr_mesh_arrays *m, const struct sr_shape_placement *placement,
                       struct sr_error *error)
{
    uint32_t vertices = m->P->count, corners = m->indices->count;
    if (vertices == 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: \"P\" is missing, expected the positions of the vertices", m->name);
    if (corners == 0)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: \"indices\" are missing, and may be only with exactly %u \"P\", not %u", m->name,
                       m->corners, vertices);
    if (corners % m->corners != 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: %u \"indices\", expected a multiple of %u", m->name, corners,
                       m->corners);
    const int32_t *indices = m->indices->data;
    for (uint32_t i = 0; i < corners; ++i) {
        if (indices[i] < 0 || (uint32_t)indices[i] >= vertices)
            return sr_fail(error, SR_ERROR_INPUT,
                           "%s: index %d at place %u is out of range, expected 0 to %u as there are %u \"P\"", m->name,
                           indices[i], i, vertices - 1, vertices);
    }
    sr_status status = check_count(m, "N", m->N, vertices, "one for each \"P\"", error);
    if (status == SR_OK && m->S)
        status = check_count(m, "S", m->S, vertices, "one for each \"P\"", error);
    if (status == SR_OK)
        status = check_count(m, "uv", m->uv, vertices, "one for each \"P\"", error);
    if (status == SR_OK)
        status = check_count(m, "faceIndices", m->face_indices, corners / m->corners, "one for each face", error);
    if (status != SR_OK)
        return status;
    if (!sr_transform_is_valid(&placement->object_to_world))
        return sr_fail(error, SR_ERROR_INPUT, "%s: the transform must be finite and invertible", m->name);
    return SR_OK;
}

/* M v + w c, where c is the column of translation; divided by the fourth coordinate for points (w = 1). */
static sr_vec3 place(const float m[4][4], sr_vec3 v, double w)
{
    double r[4];
    for (int i = 0; i < 4; ++i)
        r[i] = (double)m[i][0] * (double)v.x + (double)m[i][1] * (double)v.y + (double)m[i][2] * (double)v.z +
               (double)m[i][3] * w;
    double s = w != 0 && r[3] != 1 ? 1 / r[3] : 1;
    return (sr_vec3){(float)(r[0] * s), (float)(r[1] * s), (float)(r[2] * s)};
}

static sr_vec3 place_normal(const struct sr_transform *t, sr_vec3 n, double side)
{
    double r[3];
    for (int i = 0; i < 3; ++i)
        r[i] = (double)t->inverse[0][i] * (double)n.x + (double)t->inverse[1][i] * (double)n.y +
               (double)t->inverse[2][i] * (double)n.z;
    double l = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    double s = l > 0 ? side / l : 0;
    return (sr_vec3){(float)(r[0] * s), (float)(r[1] * s), (float)(r[2] * s)};
}

/* The values of s, if there are any, are the arena's own from now on. */
static bool own(struct sr_slice *s, size_t size, struct sr_arena *arena)
{
    return s->count == 0 || (s->data = sr_arena_copy(arena, s->data, s->count * size)) != NULL;
}

sr_status sr_mesh_place(const struct sr_mesh_arrays *m, const struct sr_shape_placement *placement, bool *flip_normals,
                        struct sr_arena *arena, struct sr_error *error)
{
    static const int32_t counting[4] = {0, 1, 2, 3};
    if (m->indices->count == 0 && m->P->count == m->corners)
        *m->indices = (struct sr_slice){counting, m->corners};
    sr_status status = check(m, placement, error);
    if (status != SR_OK)
        return status;

    const struct sr_transform *t = &placement->object_to_world;
    size_t bytes = (size_t)m->P->count * sizeof(sr_vec3);
    sr_vec3 *P = sr_arena_alloc(arena, bytes + 4); // ray casters read 16 bytes a vertex
    sr_vec3 *N = m->N->count ? sr_arena_alloc(arena, bytes) : NULL;
    sr_vec3 *S = m->S && m->S->count ? sr_arena_alloc(arena, bytes) : NULL;
    if (!P || (m->N->count && !N) || (m->S && m->S->count && !S) || !own(m->indices, sizeof(int32_t), arena) ||
        !own(m->uv, sizeof(sr_vec2), arena) || !own(m->face_indices, sizeof(int32_t), arena))
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: no memory for %u vertices", m->name, m->P->count);

    double side = placement->reverse_orientation ? -1 : 1;
    bool is_finite = all_finite(m->uv->data, 2 * (size_t)m->uv->count);
    for (uint32_t i = 0; i < m->P->count; ++i) {
        P[i] = place(t->m, ((const sr_vec3 *)m->P->data)[i], 1);
        if (N)
            N[i] = place_normal(t, ((const sr_vec3 *)m->N->data)[i], side);
        if (S)
            S[i] = place(t->m, ((const sr_vec3 *)m->S->data)[i], 0);
        is_finite = is_finite && sr_is_finite(P[i]) && (!N || sr_is_finite(N[i])) && (!S || sr_is_finite(S[i]));
    }
    m->P->data = P;
    m->N->data = N;
    if (m->S)
        m->S->data = S;
    *m->left_out = is_finite ? 0 : leave_out(m);
    *flip_normals = placement->reverse_orientation != sr_transform_swaps_handedness(t);
    return SR_OK;
}
