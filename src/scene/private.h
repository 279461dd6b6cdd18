/* SPDX-License-Identifier: MIT */
/* The inside of a scene: only files of this folder include it, and nothing else includes Embree. */
#ifndef SR_SCENE_PRIVATE_H
#define SR_SCENE_PRIVATE_H

#include "scene/scene.h"

#include <embree3/rtcore.h>

/* A shape where the ray caster finds it: by its geometry number within the world or within an object. */
struct placed_shape {
    struct sr_shape shape;
    const struct sr_material *material;
    struct sr_texture alpha;
    const struct sr_media *media;
    uint32_t first_light;             // SR_NO_LIGHT: dark
    uint32_t per_light;               // primitives that make one light
    uint32_t number;                  // from 1, in the order of description
    uint32_t material_number;         // from 1; 0: interface
    const struct sr_sigmoid *lambert; // reflectance, if that is all
    bool has_footprint;               // its material looks at footprints
    bool is_plain;                    // neither its material nor its light looks at more than p, n and ns
    bool is_mesh;                     // of triangles, which Embree meets itself
    bool is_paired;                   // which gets them two at a time, those that stay alone with an empty second half
    int8_t outward;                   // as of struct sr_point
};

/* What instances share; index 0 is the world. */
struct object {
    struct sr_array defs;        // struct sr_shape_def, until finished
    struct placed_shape *shapes; // by geometry number
    uint32_t shape_count;
    RTCScene embree;
    uint32_t number; // index in the scene's objects
    uint32_t like;   // index of the object whose shapes it has; 0: they are its own
};

struct instance {
    struct sr_transform object_to_world; // where it stands
    const struct object *object;
    const struct sr_motion *outer, *inner; // NULL, NULL: it stands; else outer after inner, either may be NULL
    struct sr_box *boxes; // of one that moves, or is far larger or smaller than its object, at its time steps
    bool is_watched;      // some of it is among the scene's `closed`
};
/* Of a moving instance. */
struct sr_transform instance_transform(const struct instance *instance, float time);

/* A closed mesh in the world, or what is closed of an instance. */
enum { CLOSED_MAX = 16, SLIP_ATTEMPTS = 3, SLIP_RING = 4 };
struct closed {
    struct sr_box box;
    float volume;               // [m^3] of the box
    int8_t side;                // of a mesh: as of struct sr_point
    struct placed_shape *shape; // NULL: an instance
    struct instance *instance;
};

struct sr_scene {
    struct sr_arena arena;
    struct sr_error error;
    bool is_finished, has_footprints, has_media, has_subsurface, has_interfaces, moves;
    struct sr_medium sensor_medium;
    const struct sr_medium *around; // beyond all surfaces; NULL: vacuum
    struct sr_array objects;        // struct object *
    struct sr_array instance_defs;  // struct instance_def
    struct sr_array mover_defs;     // struct mover_def
    struct sr_array light_defs;     // struct sr_light
    struct sr_array material_list;  // const struct sr_material *, in the order of first use
    struct sr_array degenerates;    // struct degenerate, in the order of description
    const struct object *world;
    struct instance *instances; // by geometry number - world's shape count
    uint32_t first_instance;
    float farthest; // [m] coordinate of rays that can be cast
    RTCDevice device;
    RTCScene embree;
    struct sr_lights lights;
    struct sr_box bounds;
    struct closed closed[CLOSED_MAX];
    uint32_t closed_count;
    struct sr_scene_counts counts;
};

struct instance_def {
    struct sr_transform object_to_world;
    sr_object_id object;
    const struct sr_motion *outer, *inner; // as of struct instance
};

/* A shape that moves is an object of its own, in its parent's instances or in the world. */
struct mover_def {
    sr_object_id parent, object;
    const struct sr_motion *motion;
};

/* Primitives of a shape that no ray meets. */
struct degenerate {
    struct sr_location where;
    const char *model;
    uint64_t count, without_area, too_large, not_finite; // of all; of those that no ray meets
};

/* Counted so that nothing is lost in silence. */
void scene_no_memory(struct sr_scene *scene);
void scene_count_degenerate(struct sr_scene *scene, const struct sr_shape_def *def);
void scene_find_media(struct sr_scene *scene);  // once rays can be cast
void scene_find_closed(struct sr_scene *scene); // once the instances are there
/* Whether a ray that met nothing began within something closed, and not on the way out, and went on to its outside. */
bool scene_may_have_slipped(const struct sr_scene *scene, const struct sr_ray *ray);
/* The direction, a few roundings beside, attempt 0 … SLIP_ATTEMPTS - 1; then 0.5 mrad beside on all sides, SLIP_RING of
 * them, all of which must meet something before one is believed: else silhouettes would grow by as much. Only for rays
 * without end. */
sr_vec3 scene_beside(sr_vec3 d, int attempt);
/* Of its way a segment is asked again: beside its end there may be the lamp that it aims at. One that meets the lamp at
 * a cosine of 2^-16 / (1 - share) or more stays clear of it. */
#define SLIP_SHARE (1 - 0x1p-6f)
#define SR_CAST_LARGEST 1.844e18f // [m] coordinate that Embree takes
bool scene_can_cast(const struct RTCRay *r, float farthest);
void scene_build_embree(struct sr_scene *scene, int threads);

/* Which primitive of the shape the ray caster means; on paired triangles *at is put right. */
static inline uint32_t primitive_met(const struct placed_shape *s, uint32_t met, sr_vec2 *at)
{
    if (!s->is_paired)
        return met;
    uint32_t pairs = ((const struct sr_shape_mesh *)s->shape.self)->pairs;
    return met < pairs ? 2 * met + sr_shape_half_of_pair(at) : pairs + met;
}
/* Alpha test of a hit: true where the surface is. Partial coverage is decided by a hash of the ray. */
bool scene_alpha_accepts(const struct placed_shape *s, uint32_t primitive, sr_vec2 hit, sr_vec3 o, sr_vec3 d);

#endif
