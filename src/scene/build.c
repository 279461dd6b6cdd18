/* SPDX-License-Identifier: MIT */
/* The acceleration structure: one Embree scene for the world and one for each object, robust traversal.
 *
 * Triangles are Embree's own; patches and quadrics are user geometry met by their exact equations. Alpha is a filter.
 * Where an object has many triangles and most follow a neighbour, Embree gets them by pairs, as quads, each half of
 * which it meets by the very formula for triangles: two thirds of the memory, half the time to build, and rays are no
 * slower. */
#include "scene/private.h"

#include <stdio.h>
#include <string.h>

static bool count_memory(void *user, ssize_t bytes, bool post)
{
    struct sr_scene *scene = user;
    __atomic_fetch_add(&scene->counts.acceleration_B, (uint64_t)bytes, __ATOMIC_RELAXED);
    return bytes < 0 || post || sr_alloc_allowed();
}

/* ---- callbacks of the ray caster ---- */

static void user_bounds(const struct RTCBoundsFunctionArguments *a)
{
    const struct placed_shape *s = a->geometryUserPtr;
    struct sr_box b = s->shape.model->bounds(s->shape.self, a->primID);
    *a->bounds_o = (struct RTCBounds){.lower_x = b.lo.x,
                                      .lower_y = b.lo.y,
                                      .lower_z = b.lo.z,
                                      .upper_x = b.hi.x,
                                      .upper_y = b.hi.y,
                                      .upper_z = b.hi.z};
}

static bool meet_user(const struct placed_shape *s, uint32_t primitive, const struct RTCRay *r, float *t, sr_vec2 *hit)
{
    sr_vec3 o = {r->org_x, r->org_y, r->org_z}, d = {r->dir_x, r->dir_y, r->dir_z};
    float t_min = r->tnear;
    // behind a hole of the alpha mask the same primitive may be met again
    while (s->shape.model->intersect(s->shape.self, primitive, o, d, t_min, r->tfar, t, hit)) {
        if (!s->alpha.model || scene_alpha_accepts(s, primitive, *hit, o, d))
            return true;
        t_min = nextafterf(*t, INFINITY) * (1 + 4 * SR_MACHINE_EPSILON);
    }
    return false;
}

static void user_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    if (!a->valid[0])
        return;
    struct RTCRayHit *rh = (struct RTCRayHit *)a->rayhit;
    float t;
    sr_vec2 hit;
    if (!meet_user(a->geometryUserPtr, a->primID, &rh->ray, &t, &hit))
        return;
    rh->ray.tfar = t;
    rh->hit.u = hit.x;
    rh->hit.v = hit.y;
    rh->hit.primID = a->primID;
    rh->hit.geomID = a->geomID;
    rh->hit.instID[0] = a->context->instID[0];
}

static void user_occluded(const struct RTCOccludedFunctionNArguments *a)
{
    if (!a->valid[0])
        return;
    struct RTCRay *r = (struct RTCRay *)a->ray;
    const struct placed_shape *s = a->geometryUserPtr;
    if (!s->material) // an interface that glows lets light pass
        return;
    float t;
    sr_vec2 hit;
    if (meet_user(s, a->primID, r, &t, &hit))
        r->tfar = -INFINITY;
}

/* ---- instances that move: their place is asked for anew by each ray, so that what it meets is exactly where it is
 * then; and those of which Embree's floats know no inverse ---- */

enum { MOVING_STEPS = 65 };

struct sr_transform instance_transform(const struct instance *instance, float time)
{
    struct sr_transform outer = instance->object_to_world, inner;
    if (instance->outer)
        sr_motion_at(instance->outer, time, &outer);
    if (!instance->inner)
        return outer;
    sr_motion_at(instance->inner, time, &inner);
    return sr_transform_is_identity(&outer) ? inner : sr_transform_multiply(&outer, &inner);
}

static void moving_bounds(const struct RTCBoundsFunctionArguments *a)
{
    const struct instance *instance = a->geometryUserPtr;
    struct sr_box b = instance->boxes[a->timeStep];
    *a->bounds_o = (struct RTCBounds){.lower_x = b.lo.x,
                                      .lower_y = b.lo.y,
                                      .lower_z = b.lo.z,
                                      .upper_x = b.hi.x,
                                      .upper_y = b.hi.y,
                                      .upper_z = b.hi.z};
}

/* Embree has boxes go evenly from one step to the next: each holds what its two neighbouring intervals do. */
static void set_boxes(struct instance *instance, int steps)
{
    struct RTCBounds e;
    rtcGetSceneBounds(instance->object->embree, &e);
    struct sr_box own = {{e.lower_x, e.lower_y, e.lower_z}, {e.upper_x, e.upper_y, e.upper_z}};
    for (int i = 0; i < steps; ++i) {
        float t0 = (float)(i > 0 ? i - 1 : 0) / (MOVING_STEPS - 1),
              t1 = (float)(i + 1 < MOVING_STEPS ? i + 1 : i) / (MOVING_STEPS - 1);
        struct sr_box b = instance->inner ? sr_motion_box(instance->inner, own, t0, t1) : own;
        instance->boxes[i] = sr_box_is_empty(own) ? own
                             : instance->outer    ? sr_motion_box(instance->outer, b, t0, t1)
                                                  : sr_box_transform(&instance->object_to_world, b);
    }
}

struct saved_ray {
    sr_vec3 o, d;
};

static struct saved_ray enter(const struct instance *instance, struct RTCRay *r, struct RTCIntersectContext *context,
                              uint32_t number)
{
    struct saved_ray saved = {{r->org_x, r->org_y, r->org_z}, {r->dir_x, r->dir_y, r->dir_z}};
    struct sr_transform t = instance_transform(instance, r->time);
    sr_vec3 o = sr_inverse_point(&t, saved.o), d = sr_inverse_vector(&t, saved.d);
    r->org_x = o.x, r->org_y = o.y, r->org_z = o.z;
    r->dir_x = d.x, r->dir_y = d.y, r->dir_z = d.z;
    context->instID[0] = number;
    return saved;
}

static void leave(struct RTCRay *r, struct RTCIntersectContext *context, struct saved_ray saved)
{
    r->org_x = saved.o.x, r->org_y = saved.o.y, r->org_z = saved.o.z;
    r->dir_x = saved.d.x, r->dir_y = saved.d.y, r->dir_z = saved.d.z;
    context->instID[0] = RTC_INVALID_GEOMETRY_ID;
}

static void moving_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    if (!a->valid[0])
        return;
    const struct instance *instance = a->geometryUserPtr;
    struct RTCRayHit *rh = (struct RTCRayHit *)a->rayhit;
    struct saved_ray saved = enter(instance, &rh->ray, a->context, a->geomID);
    if (scene_can_cast(&rh->ray, SR_CAST_LARGEST))
        rtcIntersect1(instance->object->embree, a->context, rh);
    leave(&rh->ray, a->context, saved);
}

static void moving_occluded(const struct RTCOccludedFunctionNArguments *a)
{
    if (!a->valid[0])
        return;
    const struct instance *instance = a->geometryUserPtr;
    struct RTCRay *r = (struct RTCRay *)a->ray;
    struct saved_ray saved = enter(instance, r, a->context, a->geomID);
    if (scene_can_cast(r, SR_CAST_LARGEST))
        rtcOccluded1(instance->object->embree, a->context, r);
    leave(r, a->context, saved);
}

static void filter_intersect(const struct RTCFilterFunctionNArguments *a)
{
    if (a->valid[0] != -1)
        return;
    const struct RTCRay *r = (const struct RTCRay *)a->ray;
    const struct RTCHit *h = (const struct RTCHit *)a->hit;
    sr_vec3 o = {r->org_x, r->org_y, r->org_z}, d = {r->dir_x, r->dir_y, r->dir_z};
    sr_vec2 at = {h->u, h->v};
    uint32_t primitive = primitive_met(a->geometryUserPtr, h->primID, &at);
    if (!scene_alpha_accepts(a->geometryUserPtr, primitive, at, o, d))
        a->valid[0] = 0;
}

static void filter_occluded(const struct RTCFilterFunctionNArguments *a)
{
    if (a->valid[0] != -1)
        return;
    const struct placed_shape *s = a->geometryUserPtr;
    if (!s->material)
        a->valid[0] = 0;
    else if (s->alpha.model)
        filter_intersect(a);
}

bool scene_alpha_accepts(const struct placed_shape *s, uint32_t primitive, sr_vec2 hit, sr_vec3 o, sr_vec3 d)
{
    struct sr_point x = {.uv = s->shape.model->uv(s->shape.self, primitive, hit), .face = (int32_t)primitive};
    float alpha = sr_texture_float(s->alpha, &x);
    if (alpha >= 1)
        return true;
    if (!(alpha > 0))
        return false;
    uint32_t bits[6], h = sr_hash_combine(s->number, primitive);
    memcpy(bits, &o, sizeof o);
    memcpy(bits + 3, &d, sizeof d);
    for (int i = 0; i < 6; ++i)
        h = sr_hash_combine(h, bits[i]);
    return sr_u32_to_float(h) < alpha;
}

/* ---- building ---- */

/* Pairs whose corners stand side by side in the indices; where some triangles stay alone, a list. */
static const void *quads_of(struct sr_scene *scene, const struct sr_shape_mesh *m, size_t *stride)
{
    const int32_t *c = m->indices.data;
    size_t n = m->indices.count / 3, pairs = m->pairs;
    *stride = (2 * pairs == n ? 6 : 4) * sizeof *c;
    if (2 * pairs == n)
        return c + 1;
    int32_t(*quads)[4] = sr_arena_alloc(&scene->arena, (n - pairs) * sizeof *quads);
    if (!quads) {
        sr_fail(&scene->error, SR_ERROR_RESOURCE, "not enough memory for %zu triangles", n);
        return NULL;
    }
    for (size_t i = 0; i < pairs; ++i)
        memcpy(quads[i], c + 6 * i + 1, sizeof *quads);
    for (size_t i = pairs; i < n - pairs;
         ++i) { // of a b c c one half is a b c, as it stands, and the other has no area
        const int32_t *t = c + 3 * (i + pairs);
        memcpy(quads[i], (int32_t[4]){t[0], t[1], t[2], t[2]}, sizeof *quads);
    }
    return quads;
}

static RTCGeometry make_mesh(struct sr_scene *scene, const struct placed_shape *s)
{
    const struct sr_shape_mesh *m = s->shape.self;
    size_t stride = 3 * sizeof(int32_t), count = m->indices.count / 3;
    const void *indices = s->is_paired ? quads_of(scene, m, &stride) : m->indices.data;
    RTCGeometry g = rtcNewGeometry(scene->device, s->is_paired ? RTC_GEOMETRY_TYPE_QUAD : RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, m->P.data, 0, sizeof(sr_vec3),
                               m->P.count);
    if (indices)
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, s->is_paired ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT3,
                                   indices, 0, stride, count - (s->is_paired ? m->pairs : 0));
    if (s->alpha.model)
        rtcSetGeometryIntersectFilterFunction(g, filter_intersect);
    if (s->alpha.model || !s->material)
        rtcSetGeometryOccludedFilterFunction(g, filter_occluded);
    return g;
}

static RTCGeometry make_geometry(struct sr_scene *scene, const struct placed_shape *s)
{
    RTCGeometry g;
    if (s->is_mesh) {
        g = make_mesh(scene, s);
    } else {
        g = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(g, s->shape.model->primitive_count(s->shape.self));
        rtcSetGeometryBoundsFunction(g, user_bounds, NULL);
        rtcSetGeometryIntersectFunction(g, user_intersect);
        rtcSetGeometryOccludedFunction(g, user_occluded);
    }
    rtcSetGeometryUserData(g, (void *)(uintptr_t)s);
    rtcCommitGeometry(g);
    return g;
}

static void attach(RTCScene embree, RTCGeometry g, uint32_t number)
{
    rtcAttachGeometryByID(embree, g, number);
    rtcReleaseGeometry(g);
}

/* Triangles by pairs, if there are many and most have a partner. Lamps keep theirs in order, as lights are numbered by
 * it. */
static void pair_triangles(struct sr_scene *scene, struct object *object)
{
    const uint64_t many = 4096;
    uint64_t triangles = 0, pairs = 0;
    for (uint32_t i = 0; i < object->shape_count; ++i) {
        const struct placed_shape *s = &object->shapes[i];
        triangles += s->is_mesh ? s->shape.model->primitive_count(s->shape.self) : 0;
    }
    for (uint32_t i = 0; triangles >= many && i < object->shape_count; ++i)
        pairs += object->shapes[i].is_mesh && object->shapes[i].first_light == SR_NO_LIGHT
                     ? sr_shape_count_pairs(object->shapes[i].shape.self)
                     : 0;
    if (triangles < many || 2 * pairs < triangles / 4 * 3)
        return;
    for (uint32_t i = 0; i < object->shape_count; ++i) {
        struct placed_shape *s = &object->shapes[i];
        if (!s->is_mesh)
            continue;
        if (s->first_light == SR_NO_LIGHT)
            sr_shape_pair_triangles((struct sr_shape_mesh *)(uintptr_t)s->shape.self, &scene->arena,
                                    &scene->error); // before it is shared
        s->is_paired = true;
    }
}

/* Whether the ray caster cannot tell one from the other: meshes only, no filters, which know their shapes. */
static bool is_alike(const struct object *a, const struct object *b)
{
    bool is = a->shape_count == b->shape_count;
    for (uint32_t i = 0; i < a->shape_count && is; ++i) {
        const struct placed_shape *s = &a->shapes[i], *t = &b->shapes[i];
        is = s->shape.self == t->shape.self && s->is_mesh && !s->alpha.model && !t->alpha.model && s->material &&
             t->material;
    }
    return is;
}

static void build_object(struct sr_scene *scene, struct object *object)
{
    const struct object *like = object->like ? ((struct object **)scene->objects.data)[object->like] : NULL;
    if (like && is_alike(object, like)) {
        for (uint32_t i = 0; i < object->shape_count; ++i)
            object->shapes[i].is_paired = like->shapes[i].is_paired;
        object->embree = like->embree;
        rtcRetainScene(object->embree);
        return;
    }
    pair_triangles(scene, object);
    object->embree = rtcNewScene(scene->device);
    rtcSetSceneFlags(object->embree, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(object->embree, RTC_BUILD_QUALITY_MEDIUM);
    for (uint32_t i = 0; i < object->shape_count; ++i)
        attach(object->embree, make_geometry(scene, &object->shapes[i]), i);
}

static RTCGeometry make_moving(struct sr_scene *scene, struct instance *instance)
{
    int steps = instance->outer || instance->inner ? MOVING_STEPS : 1;
    instance->boxes = sr_arena_alloc(&scene->arena, (size_t)steps * sizeof *instance->boxes);
    if (!instance->boxes)
        return NULL;
    set_boxes(instance, steps);
    scene->moves |= (instance->outer && instance->outer->moves) || (instance->inner && instance->inner->moves);
    RTCGeometry g = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, 1);
    rtcSetGeometryTimeStepCount(g, (unsigned)steps);
    rtcSetGeometryBoundsFunction(g, moving_bounds, NULL);
    rtcSetGeometryIntersectFunction(g, moving_intersect);
    rtcSetGeometryOccludedFunction(g, moving_occluded);
    rtcSetGeometryUserData(g, instance);
    return g;
}

/* How much longer vectors may become on their way into the object, and how far away its origin is from there. Embree
 * inverts the matrix in float, whose cubes overflow or vanish beyond the bounds: such instances do as those that move.
 */
static bool can_stand(struct sr_scene *scene, const struct instance *instance)
{
    const struct sr_transform *t = &instance->object_to_world;
    double stretch = 0, shift = 0, grown = 0;
    for (int i = 0; i < 3; ++i) {
        double there = 0, back = 0;
        for (int k = 0; k < 3; ++k) {
            there += fabs((double)t->m[i][k]);
            back += fabs((double)t->inverse[i][k]);
        }
        grown = fmax(grown, there);
        stretch = fmax(stretch, back);
        shift = fmax(shift, fabs((double)t->inverse[i][3]));
    }
    const double most = 2e6, half = 0.49 * (double)SR_CAST_LARGEST;
    if (!(grown < most && stretch < most && shift < half))
        return false;
    scene->farthest = sr_min(scene->farthest, (float)(half / stretch));
    return true;
}

static RTCGeometry make_standing(struct sr_scene *scene, const struct instance *instance)
{
    RTCGeometry g = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(g, instance->object->embree);
    float m[12]; // rows first, three of them
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            m[4 * row + column] = instance->object_to_world.m[row][column];
    rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, m);
    return g;
}

static void add_instances(struct sr_scene *scene, struct object *world)
{
    const struct instance_def *defs = scene->instance_defs.data;
    size_t n = scene->instance_defs.count;
    struct instance *instances = sr_arena_alloc(&scene->arena, n * sizeof *instances);
    if (!instances) {
        sr_fail(&scene->error, SR_ERROR_RESOURCE, "not enough memory for %zu instances", n);
        return;
    }
    scene->instances = instances;
    scene->first_instance = world->shape_count;
    for (size_t i = 0; i < n; ++i) {
        struct object *object = ((struct object **)scene->objects.data)[defs[i].object.index1];
        instances[i] = (struct instance){.object_to_world = defs[i].object_to_world,
                                         .object = object,
                                         .outer = defs[i].outer,
                                         .inner = defs[i].inner};
        bool moves = instances[i].outer || instances[i].inner || !can_stand(scene, &instances[i]);
        RTCGeometry g = moves ? make_moving(scene, &instances[i]) : make_standing(scene, &instances[i]);
        if (!g) {
            sr_fail(&scene->error, SR_ERROR_RESOURCE, "not enough memory for %zu instances", n);
            return;
        }
        rtcCommitGeometry(g);
        attach(world->embree, g, scene->first_instance + (uint32_t)i);
    }
    sr_array_free(&scene->instance_defs);
}

static void embree_error(void *user, enum RTCError code, const char *text)
{
    struct sr_scene *scene = user;
    sr_fail(&scene->error, code == RTC_ERROR_OUT_OF_MEMORY ? SR_ERROR_RESOURCE : SR_ERROR_INPUT,
            "the acceleration structure cannot be built: %s", text ? text : "unknown reason");
}

void scene_build_embree(struct sr_scene *scene, int threads)
{
    char settings[64];
    snprintf(settings, sizeof settings, "threads=%d", threads > 0 ? threads : 1);
    scene->device = rtcNewDevice(settings);
    if (!scene->device) {
        sr_fail(&scene->error, SR_ERROR_RESOURCE, "Embree does not start (error %d)", (int)rtcGetDeviceError(NULL));
        return;
    }
    rtcSetDeviceErrorFunction(scene->device, embree_error, scene);
    rtcSetDeviceMemoryMonitorFunction(scene->device, count_memory, scene);
    scene->farthest = SR_CAST_LARGEST;
    struct object **objects = scene->objects.data;
    for (size_t k = 1; k <= scene->objects.count;
         ++k) { // objects before the world that holds them, and before those that are like them
        size_t i = k % scene->objects.count;
        build_object(scene, objects[i]);
        if (i == 0)
            add_instances(scene, objects[0]);
        rtcCommitScene(objects[i]->embree);
    }
    scene->embree = objects[0]->embree;
    struct RTCBounds b;
    rtcGetSceneBounds(scene->embree, &b);
    scene->bounds = (struct sr_box){{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
    if (sr_box_is_empty(scene->bounds))
        scene->bounds = (struct sr_box){{0, 0, 0}, {0, 0, 0}};
}
