/* SPDX-License-Identifier: MIT */
/* Closed meshes, and rays that slip out between their triangles.
 *
 * A mesh is closed when its boundary is nothing: each edge runs as often one way as the other. With a hash h of an
 * edge's two ends (by position, as seams of texture coordinates double vertices) that is
 *
 *     sum over all edges of +-h(a, b) = 0    modulo 2^64,
 *
 * the sign by which end comes first; another sum vanishes by chance with probability 2^-64. The volume that it encloses
 * (Gauss) tells which side is inside.
 *
 * The ray caster decides by the signs of three edge functions of each triangle. Neighbours share the rounding of their
 * edge, so nothing slips through edges; but at a vertex to the last bit the edges around it may be rounded all to one
 * side, and then every triangle refuses the ray. Such gaps are some roundings wide, but where an edge e points at the
 * ray's origin, v away: its function is e x v . d, known to u |e| |v|, so its line is off by u |e| |v| / |e x v|, while
 * it is |e x v| / |v|^2 long; gaps as wide as both are sqrt(u |e| / |v|) wide, 2^-12 [rad] at most. A ray that meets
 * nothing although it began within the box of a closed mesh, and not on the way out, is therefore asked again a few
 * roundings beside (docs/decisions/0022-rays-through-vertices.md). */
#include "scene/private.h"

#include <string.h>

static uint64_t mix(uint64_t x) // the finaliser of splitmix64 (S. Vigna, 2015)
{
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static uint64_t hash_of(sr_vec3 p)
{
    p = sr_add(p, (sr_vec3){0, 0, 0}); // -0 is 0
    uint32_t b[3];
    memcpy(b, &p, sizeof b);
    return mix((b[0] | (uint64_t)b[1] << 32) ^ (uint64_t)b[2] * 0x9e3779b97f4a7c15u);
}

static uint64_t edge(uint64_t a, uint64_t b)
{
    uint64_t h = a < b ? mix(a + 3 * b) : mix(b + 3 * a);
    return a < b ? h : a > b ? -h : 0;
}

/* 0: open, or of no volume; 1: the normals point out; -1: they point in. */
static int8_t outward_side(const struct sr_shape_mesh *m)
{
    const sr_vec3 *P = m->P.data, *N = m->N.count ? m->N.data : NULL;
    const int32_t *t = m->indices.data;
    sr_vec3 o = P[t[0]];
    uint64_t boundary = 0;
    double volume = 0, agreement = 0;
    for (uint32_t i = 0; i + 2 < m->indices.count; i += 3) {
        sr_vec3 a = P[t[i]], b = P[t[i + 1]], c = P[t[i + 2]];
        uint64_t ha = hash_of(a), hb = hash_of(b), hc = hash_of(c);
        boundary += edge(ha, hb) + edge(hb, hc) + edge(hc, ha);
        sr_vec3 n = sr_cross(sr_sub(b, a), sr_sub(c, a));
        volume += (double)sr_dot(sr_sub(a, o), n);
        if (N)
            agreement += (double)sr_dot(n, N[t[i]]);
    }
    if (boundary != 0 || !(fabs(volume) > 0))
        return 0;
    int8_t winding = volume > 0 ? 1 : -1;
    return N ? (agreement > 0 ? winding : (int8_t)-winding) : m->flip_normals ? (int8_t)-winding : winding;
}

/* The largest ones are watched: what holds other things is large. */
static void watch(struct sr_scene *scene, struct closed candidate)
{
    sr_vec3 d = sr_box_diagonal(candidate.box);
    candidate.volume = d.x * d.y * d.z;
    struct closed *c = scene->closed;
    uint32_t n = scene->closed_count;
    if (n == CLOSED_MAX && !(candidate.volume > c[n - 1].volume))
        return;
    uint32_t at = n < CLOSED_MAX ? scene->closed_count++ : n - 1;
    for (; at > 0 && candidate.volume > c[at - 1].volume; --at)
        c[at] = c[at - 1];
    c[at] = candidate;
}

static struct sr_box box_of(const struct sr_shape_mesh *m)
{
    struct sr_box box = sr_box_empty();
    for (uint32_t i = 0; i < m->P.count; ++i)
        box = sr_box_add(box, ((const sr_vec3 *)m->P.data)[i]);
    return box;
}

/* The box of what is closed in the object; empty: nothing is. Marks the shapes. */
static struct sr_box find_in(struct sr_scene *scene, struct object *object, bool is_world)
{
    struct sr_box all = sr_box_empty();
    for (uint32_t i = 0; i < object->shape_count; ++i) {
        struct placed_shape *s = &object->shapes[i];
        int8_t side = s->is_mesh && s->material && !s->alpha.model ? outward_side(s->shape.self) : 0;
        if (!side)
            continue;
        struct sr_box box = box_of(s->shape.self);
        all = sr_box_union(all, box);
        if (is_world)
            watch(scene, (struct closed){.box = box, .shape = s, .side = side});
        else
            s->outward = side;
    }
    return all;
}

void scene_find_closed(struct sr_scene *scene)
{
    struct object **objects = scene->objects.data;
    struct sr_box *boxes = sr_arena_alloc(&scene->arena, scene->objects.count * sizeof *boxes);
    if (!boxes) {
        sr_fail(&scene->error, SR_ERROR_RESOURCE, "not enough memory for the scene");
        return;
    }
    for (size_t i = 0; i < scene->objects.count; ++i)
        boxes[i] = find_in(scene, objects[i], i == 0);
    for (size_t i = 0; i < scene->counts.instances; ++i) {
        struct instance *instance = &scene->instances[i];
        struct sr_box box = boxes[instance->object->number];
        if (!instance->boxes && !sr_box_is_empty(box)) // those that move are not watched
            watch(scene,
                  (struct closed){.box = sr_box_transform(&instance->object_to_world, box), .instance = instance});
    }
    for (uint32_t i = 0; i < scene->closed_count; ++i) {
        struct closed *c = &scene->closed[i];
        if (c->instance)
            c->instance->is_watched = true;
        else
            c->shape->outward = c->side;
    }
}

bool scene_may_have_slipped(const struct sr_scene *scene, const struct sr_ray *ray)
{
    bool is_endless = isinf(ray->t_max);
    sr_vec3 end = is_endless ? ray->o : sr_mad(ray->o, ray->t_max, ray->d);
    int holds = ray->is_outward ? -1 : 0;
    for (uint32_t i = 0; i < scene->closed_count; ++i) {
        struct sr_box box = scene->closed[i].box;
        holds += sr_box_contains(box, ray->o) && (is_endless || !sr_box_contains(box, end));
    }
    return holds > 0;
}

sr_vec3 scene_beside(sr_vec3 d, int attempt)
{
    static const sr_vec3 ways[SLIP_ATTEMPTS + SLIP_RING] = {{0.62f, -0.81f, 0.37f},
                                                            {-0.93f, -0.29f, 0.71f},
                                                            {0.43f, 0.97f, -0.58f},
                                                            // a tetrahedron: whichever way it is seen, around d
                                                            {0.58f, 0.58f, 0.58f},
                                                            {0.58f, -0.58f, -0.58f},
                                                            {-0.58f, 0.58f, -0.58f},
                                                            {-0.58f, -0.58f, 0.58f}};
    static const float far[SLIP_ATTEMPTS] = {0x1p-20f, 0x1p-18f, 0x1p-16f}; // [rad]; 16 to 256 roundings
    const float ring = 0x1p-11f;                                            // [rad]; beside a gap of 2^-12
    float size = sr_max(fabsf(d.x), sr_max(fabsf(d.y), fabsf(d.z)));
    return sr_mad(d, (attempt < SLIP_ATTEMPTS ? far[attempt] : ring) * size, ways[attempt]);
}
