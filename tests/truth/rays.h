/* SPDX-License-Identifier: MIT */
/* Rays whose answer is known: from inside of closed meshes, which must meet something, and leaving convex surfaces,
 * which must not meet them again. Ray number i is the same whoever casts it: parts of a long run may be cast in any
 * order. */
#ifndef SR_TESTS_TRUTH_RAYS_H
#define SR_TESTS_TRUTH_RAYS_H

#include "test.h"

#include "scene/scene.h"

/* ---- closed meshes ---- */

enum body { BODY_BALL, BODY_SPIKES, BODY_CUBE, BODIES };
enum aim { AIM_ANYWHERE, AIM_VERTEX, AIM_EDGE, AIM_AXIS, AIM_AXIS_VERTEX, AIM_PLANE, AIMS };
extern const char *const body_names[BODIES], *const aim_names[AIMS];

struct closed_mesh {
    struct sr_scene *scene;
    double centre, radius; // [m] the centre is (centre, centre, centre)
    const sr_vec3 *P;
    const int32_t *indices;
    uint32_t vertices, triangles;
};
/* rings: of the ball, 4 rings^2 triangles. offset: of the centre along each axis, in radii. is_instance: as an instance
 * that is turned. */
struct closed_mesh make_closed_mesh(enum body body, int rings, double radius, double offset, bool is_instance);
void free_closed_mesh(struct closed_mesh *m);

struct leaks {
    uint64_t rays, leaks, shadows; // of the nearest point, and of visibility
    uint64_t last;                 // number of the last ray that leaked
};
struct leaks cast_from_inside(const struct closed_mesh *m, enum aim aim, uint64_t begin, uint64_t end);

/* ---- surfaces that see nothing of themselves ---- */

enum convex {
    CONVEX_SPHERE,
    CONVEX_DISK,
    CONVEX_CYLINDER,
    CONVEX_PATCH,
    CONVEX_TRIANGLES,
    CONVEX_RIBBON,
    CONVEX_BALL,
    CONVEXES
};
extern const char *const convex_names[CONVEXES];

struct convex_surface {
    struct sr_scene *scene;
    enum convex kind;
    double scale;   // [m]
    sr_vec3 centre; // [m]
};
struct convex_surface make_convex(enum convex kind, double scale, bool is_instance);
void free_convex(struct convex_surface *s);

struct self_hits {
    uint64_t rays, hits;     // that left the surface outward, and met it again
    uint64_t inward, missed; // that went into a closed body, and met nothing
};
struct self_hits leave_convex(const struct convex_surface *s, uint64_t begin, uint64_t end);

/* ---- floors: one quad of 1 to 10^4 m, of any attitude or tilted by 1e-7 to 1e-2, whole or a needle ---- */

struct tilted_floor {
    struct sr_scene *scene;
    sr_vec3 corners[4];
    double span;    // [m]
    bool is_needle; // its width is down to a thousandth of its length
    bool has_lid;
};
/* Number 0 is a floor that a well-known scene has. is_paired: in a mesh of thousands of triangles, below, which the ray
 * caster gets by pairs. has_lid: 1e-5 spans above it there is the same quad again, somewhat smaller. */
struct tilted_floor make_floor(uint64_t number, bool is_paired, bool has_lid);
void free_floor(struct tilted_floor *f);
/* hits: rays that left the floor upward and met it again. Of a floor with a lid, inward: rays that left either for the
 * other, missed: that did not meet it. */
struct self_hits leave_floor(const struct tilted_floor *f, uint64_t begin, uint64_t end);

#endif
