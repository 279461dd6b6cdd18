/* SPDX-License-Identifier: MIT */
/* Parallelograms to triangles and back, where nothing of the surface changes by it.
 *
 * With p11 = p10 + p01 - p00 the bilinear p(u, v) is affine, and so it is over each half. The same must hold of uv and
 * N. */
#include "shape/shape.h"

static bool is_affine3(const sr_vec3 *a, const int32_t *c, float tolerance)
{
    sr_vec3 e = sr_sub(a[c[1]], a[c[0]]), f = sr_sub(a[c[2]], a[c[0]]), g = sr_sub(a[c[3]], a[c[1]]);
    float extent = sr_max(sr_max_component((sr_vec3){fabsf(e.x), fabsf(e.y), fabsf(e.z)}),
                          sr_max_component((sr_vec3){fabsf(f.x), fabsf(f.y), fabsf(f.z)}));
    sr_vec3 rest = sr_sub(g, f);
    return sr_max(fabsf(rest.x), sr_max(fabsf(rest.y), fabsf(rest.z))) <= tolerance * extent;
}

static bool is_affine2(const sr_vec2 *a, const int32_t *c, float tolerance)
{
    float x = a[c[3]].x - a[c[1]].x - a[c[2]].x + a[c[0]].x, y = a[c[3]].y - a[c[1]].y - a[c[2]].y + a[c[0]].y;
    float extent = sr_max(sr_max(fabsf(a[c[1]].x - a[c[0]].x), fabsf(a[c[1]].y - a[c[0]].y)),
                          sr_max(fabsf(a[c[2]].x - a[c[0]].x), fabsf(a[c[2]].y - a[c[0]].y)));
    return sr_max(fabsf(x), fabsf(y)) <= tolerance * extent;
}

static bool may_split(const struct sr_shape_patches *m, const int32_t *c)
{
    const float tolerance = 1e-6f; // of the edges: rounding of the file
    return is_affine3(m->P.data, c, tolerance) && (!m->N.count || is_affine3(m->N.data, c, tolerance)) &&
           (!m->uv.count || is_affine2(m->uv.data, c, tolerance));
}

uint32_t sr_shape_split_planar_quads(const struct sr_shape_patches *patches, struct sr_arena *arena,
                                     struct sr_shape_mesh *triangles, struct sr_shape_patches *rest)
{
    static const int32_t counting[4] = {0, 1, 2, 3};
    static const sr_vec2 square[4] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    const struct sr_shape_patches *m = patches;
    const int32_t *indices = m->indices.count ? m->indices.data : counting;
    uint32_t count = m->indices.count ? m->indices.count / 4 : m->P.count == 4, moved = 0;
    for (uint32_t i = 0; i < count; ++i)
        moved += may_split(m, indices + 4 * (size_t)i);

    *triangles = (struct sr_shape_mesh){0};
    *rest = *m;
    if (moved == 0)
        return 0;
    size_t vertices = 4 * (size_t)moved, left = count - moved;
    int32_t *corners = sr_arena_alloc(arena, 6 * (size_t)moved * sizeof(int32_t)),
            *kept = sr_arena_alloc(arena, 4 * left * sizeof(int32_t) + 4);
    int32_t *faces = sr_arena_alloc(arena, 2 * (size_t)moved * sizeof(int32_t)),
            *kept_faces = sr_arena_alloc(arena, left * sizeof(int32_t) + 4);
    sr_vec3 *P = sr_arena_alloc(arena, vertices * sizeof(sr_vec3) + 4),
            *N = sr_arena_alloc(arena, vertices * sizeof(sr_vec3));
    sr_vec2 *uv = sr_arena_alloc(arena, vertices * sizeof(sr_vec2));
    if (!corners || !kept || !faces || !kept_faces || !P || !N || !uv)
        return UINT32_MAX;

    uint32_t out = 0, stay = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const int32_t *c = indices + 4 * (size_t)i;
        int32_t face = m->face_indices.count ? ((const int32_t *)m->face_indices.data)[i] : 0;
        if (!may_split(m, c)) {
            for (int j = 0; j < 4; ++j)
                kept[4 * stay + j] = c[j];
            kept_faces[stay++] = face;
            continue;
        }
        for (int j = 0; j < 4; ++j) {
            P[4 * out + j] = ((const sr_vec3 *)m->P.data)[c[j]];
            if (m->N.count)
                N[4 * out + j] = ((const sr_vec3 *)m->N.data)[c[j]];
            uv[4 * out + j] = m->uv.count ? ((const sr_vec2 *)m->uv.data)[c[j]] : square[j];
        }
        static const int32_t order[6] = {0, 1, 3, 0, 3, 2}; // both wound as dpdu x dpdv
        for (int j = 0; j < 6; ++j)
            corners[6 * out + j] = (int32_t)(4 * out) + order[j];
        faces[2 * out] = faces[2 * out + 1] = face;
        ++out;
    }
    *triangles = (struct sr_shape_mesh){.indices = {corners, 6 * moved}, .P = {P, 4 * moved}, .uv = {uv, 4 * moved}};
    if (m->N.count)
        triangles->N = (struct sr_slice){N, 4 * moved};
    if (m->face_indices.count) {
        triangles->face_indices = (struct sr_slice){faces, 2 * moved};
        rest->face_indices = (struct sr_slice){kept_faces, stay};
    }
    rest->indices = (struct sr_slice){kept, 4 * stay};
    if (stay == 0)
        *rest = (struct sr_shape_patches){0};
    return moved;
}

static bool is_same(sr_vec3 a, sr_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* The corners (0,0) (1,0) (0,1) (1,1) of the parallelogram whose halves are v[0 … 2] and v[3 … 5], wound alike. */
static bool join_pair(const sr_vec3 v[6], sr_vec3 corner[4])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            sr_vec3 a = v[i], b = v[(i + 1) % 3], c = v[(i + 2) % 3], d = v[3 + j];
            if (!is_same(c, v[3 + (j + 1) % 3]) || !is_same(b, v[3 + (j + 2) % 3]))
                continue;
            const sr_vec3 found[4] = {a, b, c, d};
            static const int32_t order[4] = {0, 1, 2, 3};
            for (int k = 0; k < 4; ++k)
                corner[k] = found[k];
            return is_affine3(found, order, 1e-6f);
        }
    return false;
}

bool sr_shape_join_triangles(const struct sr_shape_mesh *triangles, struct sr_arena *arena,
                             struct sr_shape_patches *patches, struct sr_error *error)
{
    const struct sr_shape_mesh *m = triangles;
    uint32_t count = m->indices.count / 6;
    if (m->N.count || count == 0 || m->indices.count != 6 * count)
        return false;
    sr_vec3 *P = NULL;
    int32_t *indices = NULL;
    for (uint32_t i = 0; i < count; ++i) {
        sr_vec3 v[6], corner[4];
        for (int j = 0; j < 6; ++j)
            v[j] = ((const sr_vec3 *)m->P.data)[((const int32_t *)m->indices.data)[6 * (size_t)i + j]];
        if (!join_pair(v, corner))
            return false;
        if (!P) { // not before the first pair fits
            P = sr_arena_alloc(arena, 4 * (size_t)count * sizeof *P + 4);
            indices = sr_arena_alloc(arena, 4 * (size_t)count * sizeof *indices);
            if (!P || !indices)
                return false;
        }
        for (int j = 0; j < 4; ++j) {
            P[4 * (size_t)i + j] = corner[j];
            indices[4 * (size_t)i + j] = (int32_t)(4 * i) + j;
        }
    }
    *patches = (struct sr_shape_patches){.indices = {indices, 4 * count}, .P = {P, 4 * count}};
    const struct sr_shape_placement here = {.object_to_world = sr_transform_identity()};
    if (sr_shape_bilinearmesh.prepare(patches, &here, arena, error) != SR_OK)
        return false;
    patches->flip_normals = m->flip_normals;
    return true;
}
