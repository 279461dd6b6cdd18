/* SPDX-License-Identifier: MIT */
/* Loop's subdivision surface: the control mesh is split `levels` times, then its vertices are moved to the limit
 * surface.
 *
 * One step splits each triangle into four. With n neighbours p_i of p, along boundaries the two neighbours b_i only:
 *     inside     p' = (1 - n beta) p + beta SUM p_i,  beta = 3/(8 n), 3/16 for n = 3     edge: (3 (p + q) + r + s) / 8
 *     boundary   p' = 3/4 p + 1/8 (b_0 + b_1)                                            edge: (p + q) / 2
 * Limit, the left eigenvector of eigenvalue 1:
 *     inside     p = (1 - n gamma) p + gamma SUM p_i,  gamma = 1 / (n + 3/(8 beta))
 *     boundary   p = 2/3 p + 1/6 (b_0 + b_1)
 * Tangents, those of the next ones: inside SUM cos(2 pi i/n) p_i and SUM sin(2 pi i/n) p_i; on a boundary with n
 * neighbours b_1 - b_0 and, with t = pi/(n-1), SUM sin(i t) p_i + k (b_0 + b_1) - (2 k + cot(t/2)) p, k = (sin t -
 * cot(t/2)) / (1 + 2 cos t). C. Loop, Smooth subdivision surfaces based on triangles, 1987; H. Hoppe and others,
 * Piecewise smooth surface reconstruction, 1994. N points against the winding, as in pbrt-v4. What is above is so where
 * "unbiased" is true; else as in pbrt, whose boundaries go to the limit by 3/5 and 1/5, and so stray from their own
 * rule by 1/30 of a second difference, and whose tangents are those of points that have been moved to the limit
 * already: highlights of coarse meshes lie elsewhere. Limits: each edge has one or two triangles, wound alike, and each
 * vertex one fan of them. */
#include "shape/shape.h"

#include <string.h>

enum { MAX_TRIANGLES = 1 << 25 }; // after the last step: about 2 GiB

#define L struct sr_shape_loopsubdiv
static const struct sr_param params[] = {
    {SR_PARAM_INT, "levels", "1", 0, 30, 3, offsetof(L, levels), "how often each triangle is split into four"},
    {SR_PARAM_INTS, "indices", "1", 0, INT32_MAX, NAN, offsetof(L, indices), "three vertices a triangle"},
    {SR_PARAM_POINT3S, "P", "m", -INFINITY, INFINITY, NAN, offsetof(L, P), "positions of the control vertices"},
    {SR_PARAM_ENUM, "scheme", "1", 0, 0, 0, offsetof(L, scheme), "loop"},
    {SR_PARAM_BOOL, "unbiased", "1", 0, 1, 0, offsetof(L, unbiased),
     "points and normals of the limit surface itself; false: pbrt's, close to it"},
    {0},
};
#undef L

typedef struct dvec3 {
    double x, y, z;
} dvec3;

static void add(dvec3 *a, double w, sr_vec3 b)
{
    a->x += w * (double)b.x;
    a->y += w * (double)b.y;
    a->z += w * (double)b.z;
}

static sr_vec3 rounded(dvec3 a)
{
    return (sr_vec3){(float)a.x, (float)a.y, (float)a.z};
}

/* Half-edge h goes from corner[h] to corner[next(h)], around triangle h / 3. */
struct net {
    uint32_t triangles, vertices;
    int32_t *corner; // vertex by half-edge
    int32_t *twin;   // the half-edge that goes back, or -1 on the boundary
    int32_t *first;  // by vertex: a half-edge that leaves it, the one along the boundary if there is one; -1: none does
    sr_vec3 *P;
};

static int32_t next(int32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}
static int32_t previous(int32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

static void free_net(struct net *m)
{
    sr_free(m->corner);
    sr_free(m->twin);
    sr_free(m->first);
    sr_free(m->P);
    *m = (struct net){0};
}

static bool alloc_net(struct net *m, uint32_t triangles, uint32_t vertices)
{
    *m = (struct net){.triangles = triangles, .vertices = vertices};
    m->corner = sr_alloc(3 * (size_t)triangles * sizeof(int32_t));
    m->twin = sr_alloc(3 * (size_t)triangles * sizeof(int32_t));
    m->first = sr_alloc((size_t)vertices * sizeof(int32_t));
    m->P = sr_alloc((size_t)vertices * sizeof(sr_vec3));
    bool is_whole = m->corner && m->twin && m->first && m->P;
    if (!is_whole)
        free_net(m);
    return is_whole;
}

static sr_status no_memory(struct sr_error *error)
{
    return sr_fail(error, SR_ERROR_RESOURCE, "loopsubdiv: not enough memory");
}

/* ---- one ring ---- */

/* What the masks need of a vertex's neighbours, which are visited counterclockwise, from boundary to boundary. */
struct ring {
    int count;
    bool is_boundary;
    dvec3 sum, ends;
};

typedef void (*visitor)(void *context, int i, sr_vec3 p);

static struct ring walk(const struct net *m, uint32_t v, visitor visit, void *context)
{
    struct ring r = {0};
    int32_t start = m->first[v];
    for (int32_t h = start; h >= 0;) {
        sr_vec3 p = m->P[m->corner[next(h)]];
        add(&r.sum, 1, p);
        if (r.count == 0)
            add(&r.ends, 1, p);
        if (visit)
            visit(context, r.count, p);
        ++r.count;
        int32_t back = previous(h);
        h = m->twin[back];
        if (h < 0) {
            p = m->P[m->corner[back]];
            add(&r.sum, 1, p);
            add(&r.ends, 1, p);
            if (visit)
                visit(context, r.count, p);
            ++r.count;
            r.is_boundary = true;
        } else if (h == start) {
            break;
        }
    }
    return r;
}

static double beta(int n)
{
    return n == 3 ? 3.0 / 16 : 3.0 / (8.0 * n);
}

static sr_vec3 mask(sr_vec3 p, const struct ring *r, double inside, double boundary)
{
    const dvec3 *s = r->is_boundary ? &r->ends : &r->sum;
    double w = r->is_boundary ? boundary : inside, n = r->is_boundary ? 2 : r->count;
    dvec3 q = {w * s->x, w * s->y, w * s->z};
    add(&q, 1 - n * w, p);
    return rounded(q);
}

static sr_vec3 smoothed(const struct net *m, uint32_t v)
{
    struct ring r = walk(m, v, NULL, NULL);
    return r.count ? mask(m->P[v], &r, beta(r.count), 1.0 / 8) : m->P[v];
}

static sr_vec3 limit(const struct net *m, uint32_t v, bool unbiased)
{
    struct ring r = walk(m, v, NULL, NULL);
    return r.count ? mask(m->P[v], &r, 1 / (r.count + 3 / (8 * beta(r.count))), unbiased ? 1.0 / 6 : 1.0 / 5) : m->P[v];
}

struct tangents {
    dvec3 s, t;
    int n;
    bool is_boundary;
    double ends; // weight of the two ends of a boundary
};

static void add_tangent(void *context, int i, sr_vec3 p)
{
    struct tangents *k = context;
    if (k->is_boundary) {
        bool is_end = i == 0 || i == k->n - 1;
        add(&k->s, i == 0 ? -1 : is_end ? 1 : 0, p);
        add(&k->t, is_end ? k->ends : sin((double)SR_PI * i / (k->n - 1)), p);
    } else {
        double angle = 2 * (double)SR_PI * i / k->n;
        add(&k->s, cos(angle), p);
        add(&k->t, -sin(angle), p);
    }
}

static sr_vec3 limit_normal(const struct net *m, uint32_t v, bool unbiased)
{
    struct ring r = walk(m, v, NULL, NULL);
    int count = r.count;
    struct tangents k = {.n = count, .is_boundary = r.is_boundary};
    if (count == 0)
        return (sr_vec3){0, 0, 0};
    if (r.is_boundary) {
        double t = (double)SR_PI / (count - 1), cot = count == 2 ? 0 : 1 / tan(t / 2);
        k.ends = count == 2 ? 1 : unbiased || count < 5 ? (sin(t) - cot) / (1 + 2 * cos(t)) : -cot / 2;
        add(&k.t, -(2 * k.ends + cot), m->P[v]);
    }
    walk(m, v, add_tangent, &k);
    dvec3 n = {k.s.y * k.t.z - k.s.z * k.t.y, k.s.z * k.t.x - k.s.x * k.t.z, k.s.x * k.t.y - k.s.y * k.t.x};
    double l = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    return l > 0 ? rounded((dvec3){n.x / l, n.y / l, n.z / l}) : (sr_vec3){0, 0, 0};
}

/* ---- the control mesh ---- */

/* Finds the twins by a table of edges; slots hold 1 + the first half-edge of an edge. */
static sr_status find_twins(struct net *m, struct sr_error *error)
{
    uint32_t n = 3 * m->triangles, size = 16;
    while (size < 2 * n)
        size *= 2;
    uint32_t *slots = sr_alloc((size_t)size * sizeof *slots);
    if (!slots)
        return no_memory(error);
    for (uint32_t h = 0; h < n && error->status == SR_OK; ++h) {
        int32_t a = m->corner[h], b = m->corner[next((int32_t)h)], lo = a < b ? a : b, hi = a < b ? b : a;
        uint32_t slot = sr_hash_combine((uint32_t)lo, (uint32_t)hi) & (size - 1), other = 0;
        for (m->twin[h] = -1; slots[slot]; slot = (slot + 1) & (size - 1)) {
            other = slots[slot] - 1;
            int32_t c = m->corner[other], d = m->corner[next((int32_t)other)];
            if ((c == lo && d == hi) || (c == hi && d == lo))
                break;
        }
        if (a == b) {
            sr_fail(error, SR_ERROR_INPUT, "loopsubdiv: triangle %u has vertex %d twice, expected three different ones",
                    h / 3, a);
        } else if (!slots[slot]) {
            slots[slot] = h + 1;
        } else if (m->twin[other] >= 0) {
            sr_fail(error, SR_ERROR_INPUT,
                    "loopsubdiv: the edge from vertex %d to %d belongs to triangles %u, %d and %u, expected one or two",
                    lo, hi, other / 3, m->twin[other] / 3, h / 3);
        } else if (m->corner[other] == a) {
            sr_fail(error, SR_ERROR_INPUT,
                    "loopsubdiv: triangles %u and %u are not wound alike: both go from vertex %d to %d", other / 3,
                    h / 3, a, b);
        } else {
            m->twin[h] = (int32_t)other;
            m->twin[other] = (int32_t)h;
        }
    }
    sr_free(slots);
    return error->status;
}

/* Half-edges that leave each vertex: along the boundary where there is one. */
static void find_first(struct net *m)
{
    for (uint32_t v = 0; v < m->vertices; ++v)
        m->first[v] = -1;
    for (int32_t h = 0; h < (int32_t)(3 * m->triangles); ++h)
        if (m->first[m->corner[h]] < 0 || m->twin[h] < 0)
            m->first[m->corner[h]] = h;
}

/* The triangles around a vertex must be one fan, or walking would miss some. */
static sr_status check_fans(const struct net *m, struct sr_error *error)
{
    int32_t *leaving = sr_alloc((size_t)m->vertices * sizeof *leaving);
    if (!leaving)
        return no_memory(error);
    for (uint32_t h = 0; h < 3 * m->triangles; ++h)
        ++leaving[m->corner[h]];
    for (uint32_t v = 0; v < m->vertices && error->status == SR_OK; ++v) {
        struct ring r = walk(m, v, NULL, NULL);
        if (r.count - r.is_boundary != leaving[v])
            sr_fail(error, SR_ERROR_INPUT,
                    "loopsubdiv: vertex %u joins parts of the surface that have no edge in common", v);
    }
    sr_free(leaving);
    return error->status;
}

static sr_status check(const struct sr_shape_loopsubdiv *l, struct sr_error *error)
{
    const int32_t *indices = l->indices.data;
    const sr_vec3 *P = l->P.data;
    if (l->P.count == 0 || l->indices.count == 0)
        return sr_fail(error, SR_ERROR_INPUT, "loopsubdiv: \"%s\" is missing", l->P.count ? "indices" : "P");
    if (l->indices.count % 3 != 0)
        return sr_fail(error, SR_ERROR_INPUT, "loopsubdiv: %u \"indices\", expected a multiple of 3", l->indices.count);
    for (uint32_t i = 0; i < l->indices.count; ++i)
        if (indices[i] < 0 || (uint32_t)indices[i] >= l->P.count)
            return sr_fail(error, SR_ERROR_INPUT,
                           "loopsubdiv: index %d at place %u is out of range, expected 0 to %u as there are %u \"P\"",
                           indices[i], i, l->P.count - 1, l->P.count);
    for (uint32_t i = 0; i < l->P.count; ++i)
        if (!sr_is_finite(P[i]))
            return sr_fail(error, SR_ERROR_INPUT, "loopsubdiv: \"P\" number %u is not finite", i);
    double triangles = l->indices.count / 3 * pow(4, l->levels);
    if (triangles > MAX_TRIANGLES || l->P.count > MAX_TRIANGLES)
        return sr_fail(error, SR_ERROR_INPUT,
                       "loopsubdiv: %d \"levels\" make %.3g triangles of %u, expected at most %d", l->levels, triangles,
                       l->indices.count / 3, MAX_TRIANGLES);
    return SR_OK;
}

static sr_status read_net(const struct sr_shape_loopsubdiv *l, struct net *m, struct sr_error *error)
{
    if (check(l, error) != SR_OK)
        return error->status;
    if (!alloc_net(m, l->indices.count / 3, l->P.count))
        return no_memory(error);
    memcpy(m->corner, l->indices.data, l->indices.count * sizeof(int32_t));
    memcpy(m->P, l->P.data, l->P.count * sizeof(sr_vec3));
    if (find_twins(m, error) != SR_OK)
        return error->status;
    find_first(m);
    return check_fans(m, error);
}

/* ---- one step ---- */

static sr_vec3 edge_point(const struct net *m, int32_t h)
{
    dvec3 p = {0, 0, 0};
    int32_t t = m->twin[h];
    double w = t < 0 ? 1.0 / 2 : 3.0 / 8;
    add(&p, w, m->P[m->corner[h]]);
    add(&p, w, m->P[m->corner[next(h)]]);
    if (t >= 0) {
        add(&p, 1.0 / 8, m->P[m->corner[previous(h)]]);
        add(&p, 1.0 / 8, m->P[m->corner[previous(t)]]);
    }
    return rounded(p);
}

/* Child j < 3 keeps corner j in its place, child 3 is the middle one, whose corner j is the middle of edge j. */
static void split_triangle(const struct net *from, const int32_t *middle, uint32_t f, struct net *to)
{
    int32_t child = 4 * (int32_t)f;
    for (int j = 0; j < 3; ++j) {
        int n = (j + 1) % 3, p = (j + 2) % 3;
        int32_t h = 3 * (int32_t)f + j, back = 3 * (int32_t)f + p, at = 3 * (child + j), centre = 3 * (child + 3);
        int32_t out = from->twin[h], in = from->twin[back];
        to->corner[at + j] = from->corner[h];
        to->corner[at + n] = middle[h];
        to->corner[at + p] = middle[back];
        to->corner[centre + j] = middle[h];
        int32_t o = out < 0 ? -1 : next(out);
        to->twin[at + j] = out < 0 ? -1 : 3 * (4 * (o / 3) + o % 3) + (o + 2) % 3;
        to->twin[at + n] = centre + p;
        to->twin[at + p] = in < 0 ? -1 : 3 * (4 * (in / 3) + in % 3) + in % 3;
        to->twin[centre + p] = at + n;
    }
}

static sr_status split(struct net *m, struct sr_error *error)
{
    int32_t n = 3 * (int32_t)m->triangles, vertices = (int32_t)m->vertices;
    int32_t *middle = sr_alloc((size_t)n * sizeof *middle);
    if (!middle)
        return no_memory(error);
    for (int32_t h = 0; h < n; ++h)
        middle[h] = m->twin[h] < 0 || m->twin[h] > h ? vertices++ : middle[m->twin[h]];
    struct net fine;
    if (!alloc_net(&fine, 4 * m->triangles, (uint32_t)vertices)) {
        sr_free(middle);
        return no_memory(error);
    }
    for (uint32_t v = 0; v < m->vertices; ++v)
        fine.P[v] = smoothed(m, v);
    for (int32_t h = 0; h < n; ++h)
        if (m->twin[h] < h) // once an edge; a boundary has -1
            fine.P[middle[h]] = edge_point(m, h);
    for (uint32_t f = 0; f < m->triangles; ++f)
        split_triangle(m, middle, f, &fine);
    find_first(&fine);
    sr_free(middle);
    free_net(m);
    *m = fine;
    return SR_OK;
}

static sr_status finish(const struct net *m, bool unbiased, struct sr_arena *arena, struct sr_shape_mesh *out,
                        struct sr_error *error)
{
    sr_vec3 *P = sr_arena_alloc(arena, (size_t)m->vertices * sizeof *P + 4),
            *N = sr_arena_alloc(arena, (size_t)m->vertices * sizeof *N);
    int32_t *indices = sr_arena_copy(arena, m->corner, 3 * (size_t)m->triangles * sizeof *indices);
    if (!P || !N || !indices)
        return no_memory(error);
    for (uint32_t v = 0; v < m->vertices; ++v)
        P[v] = limit(m, v, unbiased);
    struct net moved = *m; // whose masks pbrt asks for tangents
    moved.P = P;
    for (uint32_t v = 0; v < m->vertices; ++v)
        N[v] = limit_normal(unbiased ? m : &moved, v, unbiased);
    *out = (struct sr_shape_mesh){.indices = {indices, 3 * m->triangles}, .P = {P, m->vertices}, .N = {N, m->vertices}};
    return SR_OK;
}

static sr_status prepare(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error)
{
    struct sr_shape_loopsubdiv *l = self;
    struct net m = {0};
    sr_status status = read_net(l, &m, error);
    for (int i = 0; i < l->levels && status == SR_OK; ++i)
        status = split(&m, error);
    struct sr_arena made = {0};
    if (status == SR_OK)
        status = finish(&m, l->unbiased, &made, &l->mesh, error);
    free_net(&m);
    if (status == SR_OK)
        status = sr_shape_trianglemesh.prepare(&l->mesh, placement, arena, error);
    sr_arena_free(&made);
    return status;
}

const struct sr_shape_model sr_shape_loopsubdiv = {
    .name = "loopsubdiv",
    .params = params,
    .size = sizeof(struct sr_shape_loopsubdiv),
    .prepare = prepare,
    .becomes = &sr_shape_trianglemesh,
};
