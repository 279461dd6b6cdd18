/* SPDX-License-Identifier: MIT */
/* Displaced meshes: triangles are halved until their edges are short, then vertices move along their normals.
 *
 *     p' = p + d(u, v, p) n [m],  the edges of the triangles before that are shorter than edgelength in the world
 *
 * A triangle is halved at the middle of its longest edge, on which the vertices with the smaller numbers decide where
 * several are equally long (M.-C. Rivara, 1984). An edge that is too long is halved in both of its triangles, at one
 * vertex, so that what was closed stays closed. Normals of new vertices are the mean of both ends; after moving, all
 * are those of the unit normals of the triangles around (M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering,
 * 4th ed. 2023: plymesh). Limits: vertices that merely lie in the same place, along seams of (u, v), move each by its
 * own normal. */
#include "import/pbrt/build.h"

#include <string.h>

enum { MAX_TRIANGLES = 1 << 25, MAX_DEPTH = 256 }; // about 2 GiB

/* The middle vertices of halved edges, by the edge's ends. */
struct middle {
    int32_t lo, hi, vertex; // hi 0: free
};

struct dicing {
    struct sr_array P, N, uv, triangles, faces; // growing; triangles: int32_t[3]
    struct middle *slots;
    uint32_t slot_count, used;
    const struct sr_transform *to_world;
    double longest2; // [m^2] of an edge, not reached
    const char *trouble;
};

struct triangle {
    int32_t v[3];
};

static double length2(const struct dicing *m, int32_t a, int32_t b)
{
    const sr_vec3 *P = m->P.data;
    sr_vec3 d = sr_sub(sr_transform_point(m->to_world, P[a]), sr_transform_point(m->to_world, P[b]));
    return (double)d.x * (double)d.x + (double)d.y * (double)d.y + (double)d.z * (double)d.z;
}

static struct middle *find_slot(struct middle *slots, uint32_t count, int32_t lo, int32_t hi)
{
    uint32_t i = sr_hash_combine((uint32_t)lo, (uint32_t)hi) & (count - 1);
    while (slots[i].hi && !(slots[i].lo == lo && slots[i].hi == hi))
        i = (i + 1) & (count - 1);
    return &slots[i];
}

static bool grow_slots(struct dicing *m)
{
    uint32_t count = m->slot_count ? 2 * m->slot_count : 1024;
    struct middle *slots = sr_alloc(count * sizeof *slots);
    if (!slots)
        return false;
    for (uint32_t i = 0; i < m->slot_count; ++i)
        if (m->slots[i].hi)
            *find_slot(slots, count, m->slots[i].lo, m->slots[i].hi) = m->slots[i];
    sr_free(m->slots);
    m->slots = slots;
    m->slot_count = count;
    return true;
}

/* -1: no memory */
static int32_t middle_of(struct dicing *m, int32_t a, int32_t b)
{
    int32_t lo = a < b ? a : b, hi = a < b ? b : a;
    if (2 * m->used >= m->slot_count && !grow_slots(m))
        return -1;
    struct middle *slot = find_slot(m->slots, m->slot_count, lo, hi);
    if (slot->hi)
        return slot->vertex;
    sr_vec3 *p = sr_array_push(&m->P, sizeof *p), *n = sr_array_push(&m->N, sizeof *n);
    sr_vec2 *uv = sr_array_push(&m->uv, sizeof *uv);
    if (!p || !n || !uv)
        return -1;
    const sr_vec3 *P = m->P.data, *N = m->N.data;
    const sr_vec2 *t = m->uv.data;
    *p = sr_scale(0.5f, sr_add(P[lo], P[hi]));
    sr_vec3 sum = sr_add(N[lo], N[hi]);
    *n = sr_length2(sum) > 0 ? sr_normalize(sum) : sum;
    *uv = (sr_vec2){0.5f * (t[lo].x + t[hi].x), 0.5f * (t[lo].y + t[hi].y)};
    *slot = (struct middle){lo, hi, (int32_t)m->P.count - 1};
    ++m->used;
    return slot->vertex;
}

/* The edge k, from corner k on, that is to be halved; -1: all are short. */
static int longest_edge(const struct dicing *m, const int32_t v[3])
{
    int best = -1;
    double most = 0;
    for (int k = 0; k < 3; ++k) {
        double l2 = length2(m, v[k], v[(k + 1) % 3]);
        int32_t lo = v[k] < v[(k + 1) % 3] ? v[k] : v[(k + 1) % 3];
        int32_t best_lo = best < 0 ? 0 : v[best] < v[(best + 1) % 3] ? v[best] : v[(best + 1) % 3];
        if (l2 >= m->longest2 && (best < 0 || l2 > most || (l2 == most && lo < best_lo))) {
            best = k;
            most = l2;
        }
    }
    return best;
}

static bool dice(struct dicing *m, struct triangle t, int32_t face)
{
    struct triangle stack[MAX_DEPTH];
    int depth = 0;
    stack[depth++] = t;
    while (depth > 0) {
        t = stack[--depth];
        int k = longest_edge(m, t.v);
        if (k < 0) {
            struct triangle *out = sr_array_push(&m->triangles, sizeof *out);
            int32_t *f = sr_array_push(&m->faces, sizeof *f);
            if (!out || !f)
                return false;
            *out = t;
            *f = face;
            continue;
        }
        if (depth + 2 > MAX_DEPTH || m->triangles.count + (size_t)depth >= MAX_TRIANGLES) {
            m->trouble = "\"edgelength\" is too short for this mesh";
            return false;
        }
        int32_t a = t.v[k], b = t.v[(k + 1) % 3], c = t.v[(k + 2) % 3], middle = middle_of(m, a, b);
        if (middle < 0)
            return false;
        stack[depth++] = (struct triangle){{middle, b, c}};
        stack[depth++] = (struct triangle){{a, middle, c}};
    }
    return true;
}

static void find_normals(struct dicing *m)
{
    const sr_vec3 *P = m->P.data;
    sr_vec3 *N = m->N.data;
    const struct triangle *t = m->triangles.data;
    memset(N, 0, m->N.count * sizeof *N);
    for (size_t i = 0; i < m->triangles.count; ++i) {
        const int32_t *v = t[i].v;
        sr_vec3 n = sr_cross(sr_sub(P[v[1]], P[v[0]]), sr_sub(P[v[2]], P[v[0]]));
        for (int k = 0; k < 3 && sr_length2(n) > 0; ++k)
            N[v[k]] = sr_add(N[v[k]], sr_normalize(n));
    }
    for (size_t i = 0; i < m->N.count; ++i)
        if (sr_length2(N[i]) > 0)
            N[i] = sr_normalize(N[i]);
}

static bool push_all(struct sr_array *a, const void *data, size_t count, size_t size)
{
    if (!sr_array_reserve(a, count, size))
        return false;
    if (data)
        memcpy(a->data, data, count * size);
    a->count = count;
    return true;
}

static bool dice_all(struct dicing *m, const struct sr_ply_mesh *ply)
{
    struct triangle t;
    bool is_whole = true;
    for (uint32_t i = 0; i < ply->triangle_count && is_whole; ++i) {
        memcpy(&t, ply->triangles + 3 * (size_t)i, sizeof t);
        is_whole = dice(m, t, ply->face_indices ? ply->face_indices[i] : 0);
    }
    for (uint32_t i = 0; i < 2 * ply->quad_count && is_whole; ++i) {
        const int32_t *q = ply->quads + 4 * (size_t)(i / 2);
        t = i % 2 ? (struct triangle){{q[0], q[2], q[3]}} : (struct triangle){{q[0], q[1], q[2]}};
        is_whole = dice(m, t, ply->face_indices ? ply->face_indices[ply->triangle_count + i / 2] : 0);
    }
    return is_whole;
}

/* Triangles that there will be at least: one with edges below e has less than sqrt(3)/4 e^2, and a long one is cut
 * often. */
static double least_triangles(const struct sr_ply_mesh *ply, const struct sr_transform *to_world, double edge)
{
    double sum = 0;
    for (uint32_t i = 0; i < ply->triangle_count + ply->quad_count; ++i) {
        const int32_t *v = i < ply->triangle_count ? ply->triangles + 3 * (size_t)i
                                                   : ply->quads + 4 * (size_t)(i - ply->triangle_count);
        sr_vec3 a = sr_transform_point(to_world, ply->P[v[0]]), b = sr_transform_point(to_world, ply->P[v[1]]),
                c = sr_transform_point(to_world, ply->P[v[2]]);
        sr_vec3 e = sr_sub(b, a), f = sr_sub(c, a);
        double area = 0.5 * (double)sr_length(sr_cross(e, f)), longest = (double)sr_max(sr_length(e), sr_length(f));
        sum += fmax(area / (0.4331 * edge * edge), longest / edge);
    }
    return sum;
}

/* Of meshes that tell none: as those of the displaced one. */
static bool find_first_normals(struct dicing *m, const struct sr_ply_mesh *ply)
{
    double edge2 = m->longest2;
    m->longest2 = INFINITY;
    bool is_whole = dice_all(m, ply); // halves nothing
    if (is_whole)
        find_normals(m);
    m->triangles.count = m->faces.count = 0;
    m->longest2 = edge2;
    return is_whole;
}

static void move_vertices(struct dicing *m, struct sr_texture displacement)
{
    sr_vec3 *P = m->P.data;
    const sr_vec3 *N = m->N.data;
    const sr_vec2 *uv = m->uv.data;
    for (size_t i = 0; i < m->P.count; ++i) {
        sr_vec3 n = sr_transform_normal(m->to_world, N[i]);
        n = sr_length2(n) > 0 ? sr_normalize(n) : (sr_vec3){0, 0, 1};
        struct sr_frame f = sr_frame_from_z(n);
        struct sr_point x = {.p = sr_transform_point(m->to_world, P[i]),
                             .n = n,
                             .ns = n,
                             .dpdu = f.x,
                             .dpdv = f.y,
                             .dpdus = f.x,
                             .uv = uv[i]};
        P[i] = sr_mad(P[i], sr_texture_float(displacement, &x), N[i]);
    }
}

/* Takes a growing array over into the mesh's memory, followed by readable bytes. */
static void *keep(struct sr_ply_mesh *ply, const struct sr_array *a, size_t size)
{
    void *copy = sr_arena_alloc(&ply->memory, a->count * size + 16);
    if (copy)
        memcpy(copy, a->data, a->count * size);
    return copy;
}

static bool finish(struct dicing *m, struct sr_ply_mesh *ply)
{
    ply->P = keep(ply, &m->P, sizeof(sr_vec3));
    ply->N = keep(ply, &m->N, sizeof(sr_vec3));
    ply->uv = keep(ply, &m->uv, sizeof(sr_vec2));
    ply->triangles = keep(ply, &m->triangles, sizeof(struct triangle));
    bool has_faces = ply->face_indices != NULL;
    ply->face_indices = has_faces ? keep(ply, &m->faces, sizeof(int32_t)) : NULL;
    ply->vertex_count = (uint32_t)m->P.count;
    ply->triangle_count = (uint32_t)m->triangles.count;
    ply->quad_count = 0;
    return ply->P && ply->N && ply->uv && ply->triangles && (ply->face_indices || !has_faces);
}

static bool is_finite(const sr_vec3 *P, const struct sr_transform *t, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (!sr_is_finite(sr_transform_point(t, P[i])))
            return false;
    return true;
}

sr_status sr_pbrt_displace(struct sr_ply_mesh *ply, const struct sr_transform *object_to_world, float edge_length,
                           struct sr_texture displacement, struct sr_error *error)
{
    if (!ply->uv)
        return sr_fail(error, SR_ERROR_INPUT,
                       "\"displacement\" needs texture coordinates (u and v, or s and t) of the vertices");
    if (!(edge_length > 0))
        return sr_fail(error, SR_ERROR_INPUT, "\"edgelength\" is %g, expected a positive number of metres",
                       (double)edge_length);
    if (!is_finite(ply->P, object_to_world, ply->vertex_count))
        return sr_fail(error, SR_ERROR_INPUT, "a mesh with \"displacement\" must have finite vertices");
    double least = least_triangles(ply, object_to_world, (double)edge_length);
    if (!(least < MAX_TRIANGLES))
        return sr_fail(
            error, SR_ERROR_INPUT,
            "\"edgelength\" %g is too short for this mesh: it makes more than %.3g triangles, expected at most %d",
            (double)edge_length, least, MAX_TRIANGLES);
    struct dicing m = {.to_world = object_to_world, .longest2 = (double)edge_length * (double)edge_length};
    uint32_t n = ply->vertex_count;
    bool is_whole = push_all(&m.P, ply->P, n, sizeof(sr_vec3)) && push_all(&m.N, ply->N, n, sizeof(sr_vec3)) &&
                    push_all(&m.uv, ply->uv, n, sizeof(sr_vec2)) && (ply->N || find_first_normals(&m, ply)) &&
                    dice_all(&m, ply);
    if (is_whole) {
        move_vertices(&m, displacement);
        find_normals(&m);
        is_whole = finish(&m, ply);
    }
    if (!is_whole)
        sr_fail(error, m.trouble ? SR_ERROR_INPUT : SR_ERROR_RESOURCE, "%s",
                m.trouble ? m.trouble : "not enough memory for the displaced mesh");
    sr_array_free(&m.P);
    sr_array_free(&m.N);
    sr_array_free(&m.uv);
    sr_array_free(&m.triangles);
    sr_array_free(&m.faces);
    sr_free(m.slots);
    return error->status;
}
