/* SPDX-License-Identifier: MIT */
/* What triangles and patches share: checking and placing vertex arrays, and turning densities by area into densities by
 * solid angle. Private to the room. */
#ifndef SR_SHAPE_MESH_H
#define SR_SHAPE_MESH_H

#include "shape/shape.h"

/* The arrays of a mesh; S may be NULL (no such parameter). */
struct sr_mesh_arrays {
    const char *name; // of the shape, for messages
    uint32_t corners; // vertices a primitive
    struct sr_slice *indices, *P, *N, *S, *uv, *face_indices;
    uint32_t *left_out; // primitives with numbers that are not finite
};

/* Checks all, and replaces all by copies: P, N and S in the space of placement. Primitives with numbers that are not
 * finite are left out. */
sr_status sr_mesh_place(const struct sr_mesh_arrays *m, const struct sr_shape_placement *placement, bool *flip_normals,
                        struct sr_arena *arena, struct sr_error *error);

/* Fills the planes of a small mesh of triangles. */
void sr_mesh_keep_planes(struct sr_shape_mesh *m, struct sr_arena *arena);

/* pdf [1/sr] at `from` = pdf_area [1/m^2] r^2 / |cos theta|; 0 where the surface is seen edge on or from itself.
 * Without n's sign: both sides count, the light decides which of them shines. */
static inline float sr_density_seen_from(sr_vec3 from, sr_vec3 p, sr_vec3 n, float pdf_area)
{
    sr_vec3 d = sr_sub(p, from);
    float r2 = sr_dot(d, d);
    float n_d = fabsf(sr_dot(n, d)); // r |cos theta|
    return n_d > 1e-7f * sqrtf(r2) && r2 > 0 ? pdf_area * r2 * sqrtf(r2) / n_d : 0;
}

/* How much light from direction d (any length) counts at a receiver: |cos theta|, never nothing, for transmission and
 * rough normals (a weight of sampling alone, so any positive number is right). 1 where the reference has no normal. */
static inline float sr_receiver_weight(const struct sr_point *reference, sr_vec3 d, float inverse_length)
{
    return sr_max(0.01f, fabsf(sr_dot(reference->ns, d)) * inverse_length);
}
static inline bool sr_has_normal(const struct sr_point *reference)
{
    return reference->ns.x != 0 || reference->ns.y != 0 || reference->ns.z != 0;
}

/* A unit normal of a vector product of edges that may be too small or too large for squares in float; (0,0,1) if zero.
 */
static inline sr_vec3 sr_unit_normal(sr_vec3 c)
{
    float l2 = sr_dot(c, c);
    if (SR_LIKELY(l2 > 1e-30f && l2 < 1e30f))
        return sr_scale(1 / sqrtf(l2), c);
    double l = sqrt((double)c.x * (double)c.x + (double)c.y * (double)c.y + (double)c.z * (double)c.z);
    if (!(l > 0))
        return (sr_vec3){0, 0, 1};
    return (sr_vec3){(float)((double)c.x / l), (float)((double)c.y / l), (float)((double)c.z / l)};
}

#endif
