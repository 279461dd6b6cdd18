/* SPDX-License-Identifier: MIT */
/* Where matter is: one file a shape.
 *
 * A shape consists of primitives (triangles of a mesh, patches; a quadric has one). All that is asked of a primitive is
 * here: its box, where a ray meets it, what the surface is like there, and points on it drawn toward a receiver. After
 * `prepare` everything is in the shape's space of placement (the world, or the object that is instanced). */
#ifndef SR_SHAPE_SHAPE_H
#define SR_SHAPE_SHAPE_H

#include "math/math.h"
#include "sample/sample.h"

/* A point on a shape, drawn as seen from a reference point, or by area. */
struct sr_shape_sample {
    sr_vec3 p, p_error; // [m]
    sr_vec3 n;          // [1] geometric normal, outside
    sr_vec2 uv;         // [1]
    float pdf;          // [1/sr] as seen from the reference point; [1/m^2] if there was none
};

/* A primitive with one normal: p = corner + u e + v f with u, v in 0 … 1, and u + v <= 1 if it is a triangle. */
struct sr_shape_flat {
    sr_vec3 corner, e, f; // [m]
    sr_vec3 n;            // [1] outside
    bool is_triangle;
};

/* A primitive that is a whole sphere in the world. */
struct sr_shape_round {
    sr_vec3 centre; // [m]
    float radius;   // [m]
    float side;     // [1] 1, or -1 where outside is inside
};

struct sr_shape_placement {
    struct sr_transform object_to_world;
    bool reverse_orientation; // as the scene file says; handedness of the transform comes on top
};

struct sr_shape_model {
    const char *name; // the scene file's word
    const struct sr_param *params;
    size_t size;
    const struct sr_shape_model
        *becomes; // after prepare self begins with a self of this model, which is the shape; NULL: none

    /* Checks the parameters, transforms what is stored in world space, computes what is derived. */
    sr_status (*prepare)(void *self, const struct sr_shape_placement *placement, struct sr_arena *arena,
                         struct sr_error *error);
    uint32_t (*primitive_count)(const void *self);
    struct sr_box (*bounds)(const void *self, uint32_t primitive);
    float (*area)(const void *self, uint32_t primitive); // [m^2]

    /* Nearest meeting in (t_min, t_max) of the ray o + t d; hit is the primitive's own coordinates. Triangles have
     * none: the ray caster meets them itself, hit = barycentrics of vertices 1 and 2. */
    bool (*intersect)(const void *self, uint32_t primitive, sr_vec3 o, sr_vec3 d, float t_min, float t_max, float *t,
                      sr_vec2 *hit);
    /* The surface at a hit; p is found from the hit, not from t, so that p_error is small. time and footprint are the
     * caller's. */
    void (*point)(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x);
    /* The same for surfaces without texture and tangent: p, p_error, n and ns alone. NULL: point serves. */
    void (*bare_point)(const void *self, uint32_t primitive, sr_vec2 hit, struct sr_point *x);
    /* The same for surfaces that turn to whoever looks at them along d (any length). NULL: point serves. */
    void (*seen_point)(const void *self, uint32_t primitive, sr_vec2 hit, sr_vec3 d, struct sr_point *x);
    sr_vec2 (*uv)(const void *self, uint32_t primitive, sr_vec2 hit); // texture coordinates alone, for alpha tests

    /* A point on the primitive for light that arrives at reference; NULL reference: by area. false: none. Where sample
     * is NULL the shape cannot shine, nor be measured on. */
    bool (*sample)(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec2 u,
                   struct sr_shape_sample *s);
    /* Density [1/sr] with which sample(reference) would have drawn the direction wi that meets the primitive at
     * `there`. */
    float (*pdf)(const void *self, uint32_t primitive, const struct sr_point *reference, sr_vec3 wi,
                 const struct sr_point *there);
    /* Density [1/m^2] with which sample(NULL) would have drawn `there`. NULL: 1 / area. */
    float (*area_pdf)(const void *self, uint32_t primitive, const struct sr_point *there);
    /* Cone of the outside normals: axis and cos of its half angle (-1: all directions). */
    void (*normals)(const void *self, uint32_t primitive, sr_vec3 *axis, float *cos_theta);
    /* Whether it is a triangle or a parallelogram of one normal, and which. NULL: none is. */
    bool (*flat)(const void *self, uint32_t primitive, struct sr_shape_flat *flat);
    /* The same of a sphere. */
    bool (*round)(const void *self, uint32_t primitive, struct sr_shape_round *round);
};
extern const struct sr_shape_model *const sr_shape_models[]; // ends with NULL
const struct sr_shape_model *sr_shape_model_find(const char *name);

/* A shape of a scene: two words. */
struct sr_shape {
    const struct sr_shape_model *model;
    const void *self;
};

/* ---- meshes: all arrays are copied by `prepare`, stored once, shared with the ray caster ---- */

struct sr_shape_mesh {
    struct sr_slice indices;      // int32, three a triangle
    struct sr_slice P;            // sr_vec3 [m]; the array is followed by at least 4 readable bytes
    struct sr_slice N;            // sr_vec3 [1] shading normals, or empty
    struct sr_slice S;            // sr_vec3 [1] shading tangents, or empty
    struct sr_slice uv;           // sr_vec2 [1], or empty
    struct sr_slice face_indices; // int32, one a triangle, or empty
    bool flip_normals;            // derived: outside is on the other side of the winding
    uint32_t left_out;            // derived: triangles with numbers that are not finite
    const struct sr_shape_plane { // derived: NULL, or of each triangle: small meshes keep them
        sr_vec3 n;                // [1] by the winding
        float error;              // [m] along n: how far from where it is a ray caster may find it
    } * planes;
    uint32_t pairs; // derived: the first 2 pairs triangles are pairs, as sr_shape_pair_triangles leaves them
    const uint8_t
        *turns; // derived: NULL, or of triangle i turns[i & turn_mask]: the place at which its first corner stands
    uint32_t turn_mask;
};
/* Bilinear patches: four vertices a patch, (0,0) (1,0) (0,1) (1,1). Same members and the same meaning. */
struct sr_shape_patches {
    struct sr_slice indices; // int32, four a patch
    struct sr_slice P, N, uv, face_indices;
    bool flip_normals;
    const char *emission_filename; // not looked at
    uint32_t left_out;             // derived: patches with numbers that are not finite
    const uint8_t *kinds;          // derived, one a patch: what it is geometrically, which chooses how it is sampled
};

/* Parallelograms whose uv and N are affine too (or absent) are the same surface as two triangles, and a ray caster
 * meets triangles faster. Before `prepare`: such patches are written to `triangles` (two each, in order, with vertices
 * of their own, uv (0,0) (1,0) (0,1) (1,1) where the patches had none, and the patch's face index), the others stay in
 * `rest`. Position, normals, uv and derivatives are equal to rounding. Area lights had better stay patches: a rectangle
 * is sampled as one, by solid angle. Returns the number of patches moved; UINT32_MAX: no memory. Indices must be in
 * range. */
uint32_t sr_shape_split_planar_quads(const struct sr_shape_patches *patches, struct sr_arena *arena,
                                     struct sr_shape_mesh *triangles, struct sr_shape_patches *rest);

/* The other way, for lights: whether the prepared mesh consists of parallelograms, triangles 2 i and 2 i + 1 being the
 * halves of one, without N; then patch i is the same surface, prepared, with the same outside, but without uv. */
bool sr_shape_join_triangles(const struct sr_shape_mesh *triangles, struct sr_arena *arena,
                             struct sr_shape_patches *patches, struct sr_error *error);

/* For ray casters that meet two triangles at a time: puts the triangles of the prepared mesh that follow each other and
 * share an edge first, and turns them so that those of pair i are (d, a, b) (c, d, b) of the quad a b c d around both:
 * its corners stand side by side in the indices, from 6 i + 1 on. Nothing of the surface changes but the numbers of the
 * triangles. */
sr_status sr_shape_pair_triangles(struct sr_shape_mesh *m, struct sr_arena *arena, struct sr_error *error);
uint32_t sr_shape_count_pairs(const struct sr_shape_mesh *m); // how many it would make
/* A point of the quad a b c d at u and v, as ray casters count them: (1-u-v) a + u b + v d, where that is not on the
 * side of c; there u and v count from c, as 1-u and 1-v. Returns which triangle of the pair it is on, and where. */
static inline uint32_t sr_shape_half_of_pair(sr_vec2 *at)
{
    uint32_t second = at->x + at->y > 1;
    *at = second ? (sr_vec2){1 - at->x, 1 - at->y} : (sr_vec2){1 - at->x - at->y, at->x};
    return second;
}

/* ---- what becomes a mesh ---- */

struct sr_shape_loopsubdiv {
    struct sr_shape_mesh mesh; // derived
    int32_t levels;            // [1]
    int32_t scheme;            // loop is the only one
    bool unbiased;             // the limit surface itself; false: pbrt's points and normals, close to it
    struct sr_slice indices;   // int32, three a triangle
    struct sr_slice P;         // sr_vec3 [m]
};

/* ---- curves ---- */

/* What one directive says. */
struct sr_shape_curve {
    float width, width0, width1; // [m] NaN: width
    int32_t degree, basis, type; // 2 or 3; bezier, bspline; flat, ribbon, cylinder
    int32_t split_depth;         // [1]
    struct sr_slice P;           // sr_vec3 [m]
    struct sr_slice N;           // sr_vec3 [1], of ribbons
};
/* Any number of segments of one type. Its hit is (u, v). */
struct sr_shape_curves {
    struct sr_shape_curve one; // parameters, where it is made of one
    // derived
    struct sr_transform object_to_world;
    bool is_here; // all is in the space of placement, else in object space
    bool flip_normals;
    int32_t type;
    uint32_t count, split; // segments, each of 2^split primitives
    const struct sr_shape_curve_segment *segments;
    const void *normals;
};
/* Checks them; how many segments they have, or 0 and an error. */
uint32_t sr_shape_curve_segments(const struct sr_shape_curve *c, struct sr_error *error);
/* Many curves as one shape; what the curves point to is copied. The first one's type and split_depth are those of all.
 */
sr_status sr_shape_curves_make(const struct sr_shape_curve *curves, uint32_t count,
                               const struct sr_shape_placement *placement, struct sr_arena *arena,
                               struct sr_shape_curves *out, struct sr_error *error);

/* ---- quadrics ----
 * They live in object space in double and are placed by an affine transform. Outside is away from the axis or centre
 * (disk: +z of the object), transformed as a normal; a mirror leaves it outside, reverse_orientation turns it. A
 * partial quadric is sampled exactly where it exists. Hit coordinates: sphere, octahedral direction; disk, object x and
 * y; cylinder, u and v. */
struct sr_shape_quadric {
    double to_world[3][4], to_object[3][4]; // [1], last column [m]
    double determinant;                     // [1] |det| of the linear part
    double side;                            // [1] -1: outside is reversed
};
struct sr_shape_sphere {
    float radius, z_min, z_max; // [m]
    float phi_max;              // [deg]
    struct sr_transform object_to_world;
    bool flip_normals;
    float theta_z_min, theta_z_max, phi_max_rad; // derived [rad]
    bool is_full, is_rigid;                      // a full sphere; the transform keeps it a sphere: then centre and
    sr_vec3 centre;                              // [m] in the world
    float world_radius;                          // [m]
    struct sr_shape_quadric quadric;             // derived, as in all three
};
struct sr_shape_disk {
    float height, radius, inner_radius, phi_max; // [m] [m] [m] [deg]
    struct sr_transform object_to_world;
    bool flip_normals;
    float phi_max_rad; // derived [rad]
    struct sr_shape_quadric quadric;
};
struct sr_shape_cylinder {
    float radius, z_min, z_max, phi_max; // [m] [m] [m] [deg]
    struct sr_transform object_to_world;
    bool flip_normals;
    float phi_max_rad; // derived [rad]
    struct sr_shape_quadric quadric;
};
extern const struct sr_shape_model sr_shape_trianglemesh, sr_shape_bilinearmesh, sr_shape_sphere, sr_shape_disk,
    sr_shape_cylinder, sr_shape_loopsubdiv, sr_shape_curve;

#endif
