/* SPDX-License-Identifier: MIT */
/* All of it together: described, then finished, then never changed.
 *
 * Describe with sr_scene_add_*, call sr_scene_finish once; from then on any number of threads may ask. The first
 * mistake sticks, and sr_scene_finish tells it. Everything that definitions point to lives in sr_scene_arena, or
 * longer. */
#ifndef SR_SCENE_SCENE_H
#define SR_SCENE_SCENE_H

#include "light/light.h"
#include "material/material.h"
#include "medium/medium.h"
#include "shape/shape.h"

struct sr_scene;

typedef struct sr_object_id {
    uint32_t index1; // 0: the world itself
} sr_object_id;

/* What is on the two sides of a surface where media meet; a medium without model is vacuum. */
struct sr_media {
    struct sr_medium inside, outside; // outside is where n points to
};

struct sr_shape_def {
    struct sr_shape shape;                    // prepared
    const struct sr_material *material;       // NULL or without model: interface
    struct sr_texture alpha;                  // float texture [1], or none: opaque
    const struct sr_light_emission *emission; // prepared; NULL: dark
    sr_object_id object;                      // the object that it belongs to; none: the world
    const struct sr_media *media;             // NULL: the same medium on both sides
    const struct sr_motion *motion; // NULL: it stands; else into its object's space, or the world. It may not glow
    struct sr_location where;       // for messages; file NULL: nobody knows
};

struct sr_scene *sr_scene_create(void); // NULL: no memory
void sr_scene_destroy(struct sr_scene *scene);
struct sr_arena *sr_scene_arena(struct sr_scene *scene);
struct sr_error *sr_scene_error(struct sr_scene *scene); // where mistakes stick
void sr_scene_add_shape(struct sr_scene *scene, const struct sr_shape_def *def);
sr_object_id sr_scene_add_object(struct sr_scene *scene);
/* An object whose shapes are the very ones of an earlier object, in other materials: where nothing but the material
 * differs, both have one acceleration structure, and the shapes are counted once. */
sr_object_id sr_scene_add_object_like(struct sr_scene *scene, sr_object_id earlier);
void sr_scene_add_instance(struct sr_scene *scene, sr_object_id object, const struct sr_transform *object_to_world);
void sr_scene_add_moving_instance(struct sr_scene *scene, sr_object_id object,
                                  const struct sr_motion *motion); // of object to world
void sr_scene_add_light(struct sr_scene *scene, struct sr_light light);
/* What is around the sensor; without model: vacuum, as it is if nobody says anything. */
void sr_scene_set_sensor_medium(struct sr_scene *scene, struct sr_medium medium);
/* threads: for building the acceleration structure. */
sr_status sr_scene_finish(struct sr_scene *scene, int threads, enum sr_light_choice choice);

/* ---- what a finished scene answers ---- */

/* A point of the scene: geometry and what is there. */
struct sr_hit {
    struct sr_point point;
    float t;                            // [m] along the ray
    const struct sr_material *material; // NULL: interface
    const struct sr_media *media;       // NULL: the ray's medium goes on behind the surface
    const struct sr_sigmoid *lambert;   // its reflectance, if it is plain and Lambert's; or NULL
    uint32_t light;                     // index of the area light here, or SR_NO_LIGHT
    uint32_t object;                    // number of the shape, from 1
    uint32_t material_number;           // from 1; 0: interface
    bool has_footprint;                 // its material looks at the point's footprint
    bool is_plain;                      // its material looks at p, n and ns alone
};
#define SR_NO_LIGHT UINT32_MAX

/* The ray-casting operator: the nearest surface point along the ray. false: the ray escapes. */
bool sr_raycast(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit);
/* The same, where nobody but the material and the light of the surface looks at the point: what they do not look at is
 * not computed, and there is no tangent (dpdus 0) where they need none. */
bool sr_raycast_bare(const struct sr_scene *scene, const struct sr_ray *ray, struct sr_hit *hit);
/* The visibility function V between x and the point (or, at infinite distance, the direction) of a light sample. */
bool sr_visible(const struct sr_scene *scene, const struct sr_point *x, const struct sr_light_sample *s);
/* The same in two steps: the segment (direction not of unit length, t from 0 to t_max), and whether it is free. */
static inline struct sr_ray sr_shadow_ray(const struct sr_point *x, const struct sr_light_sample *s)
{
    const float share = 1 - 1e-4f; // it ends this much before its target, which lies on a surface itself
    sr_vec3 o = sr_point_offset(x, s->wi);
    bool is_outward = sr_is_outward(x, s->wi), is_far = isinf(s->distance);
    return (struct sr_ray){.o = o,
                           .is_outward = is_outward,
                           .d = is_far ? s->wi : sr_sub(s->p, o),
                           .time = x->time,
                           .t_max = is_far ? INFINITY : share};
}
bool sr_is_free(const struct sr_scene *scene, const struct sr_ray *segment);
/* A ray that leaves x toward w. */
static inline struct sr_ray sr_leave(const struct sr_point *x, sr_vec3 w)
{
    return (struct sr_ray){
        .o = sr_point_offset(x, w), .d = w, .time = x->time, .t_max = INFINITY, .is_outward = sr_is_outward(x, w)};
}
/* The point's footprint from the sensor ray's differentials, or a cone: fills dpdx … dvdy. */
void sr_point_set_footprint(struct sr_point *x, sr_vec3 dpdx, sr_vec3 dpdy);

/* Rays in the order in which a render asked for them, to be replayed through the bare ray caster. */
struct sr_ray_log {
    struct sr_logged_ray {
        sr_vec3 o, d;
        float t_max; // [in lengths of d]
        bool is_shadow;
    } * rays;
    uint64_t count, capacity;
};
/* Asks the ray caster the same questions again and does nothing with the answers: what the rays alone cost. Returns how
 * many met something. */
uint64_t sr_scene_replay(const struct sr_scene *scene, const struct sr_ray_log *log);

const struct sr_lights *sr_scene_lights(const struct sr_scene *scene);
/* Whether there is any medium but vacuum; and whether light passes surfaces behind which another one begins. */
bool sr_scene_has_media(const struct sr_scene *scene);
bool sr_scene_has_interfaces(const struct sr_scene *scene);
/* A medium as rays carry it along: NULL is vacuum. */
const struct sr_medium *sr_scene_sensor_medium(const struct sr_scene *scene);
/* Where the ray begins: what is on this side of the first surface along it that has media, whatever is in between;
 * where there is none, what is around the scene: the outermost surface's outside, or else the sensor's medium. */
const struct sr_medium *sr_scene_medium_at(const struct sr_scene *scene, const struct sr_ray *ray);
/* On the side of the surface that w points to, for light that has come through `medium`. */
static inline const struct sr_medium *sr_hit_medium(const struct sr_hit *hit, sr_vec3 w, const struct sr_medium *medium)
{
    if (!hit->media)
        return medium;
    const struct sr_medium *m = sr_dot(hit->point.n, w) > 0 ? &hit->media->outside : &hit->media->inside;
    return m->model ? m : NULL;
}
bool sr_scene_has_footprints(const struct sr_scene *scene); // whether any material looks at them
// whether any material, seen straight on, is a mirror or clear glass
bool sr_scene_has_mirrors(const struct sr_scene *scene);
bool sr_scene_has_subsurface(const struct sr_scene *scene); // whether light comes out of any material elsewhere
bool sr_scene_moves(const struct sr_scene *scene);          // whether anything does while the shutter is open
struct sr_box sr_scene_bounds(const struct sr_scene *scene);

struct sr_scene_counts {
    uint64_t triangles, patches, quadrics, curves, instances, objects, lights, materials; // [1]
    uint64_t geometry_B, acceleration_B;                                                  // [B]
    uint64_t degenerate, too_large, not_finite; // [1] primitives that no ray meets: without
                                                // area, beyond 1e18 m, with numbers that are none
    double build_s;                             // [s]
};
struct sr_scene_counts sr_scene_count(const struct sr_scene *scene);
/* Triangles that have the corners of another one of their mesh, in any order: both are there, and which is met is left
 * to rounding. Takes 16 to 32 bytes a triangle while it looks; less memory: 0. */
uint64_t sr_scene_count_duplicates(const struct sr_scene *scene);
/* Warnings of primitives that no ray meets: for each file and kind one, with the first place, up to ten. */
void sr_scene_tell_degenerate(const struct sr_scene *scene, struct sr_log *log);

#endif
