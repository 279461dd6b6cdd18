/* SPDX-License-Identifier: MIT */
/* The description of a scene, and its end: the list of lights, the order of things, the acceleration structure. */
#include "scene/private.h"

#include <string.h>

void scene_no_memory(struct sr_scene *scene)
{
    sr_fail(&scene->error, SR_ERROR_RESOURCE, "not enough memory for the scene (%zu MiB so far)",
            scene->arena.total >> 20);
}

struct sr_scene *sr_scene_create(void)
{
    struct sr_scene *scene = sr_alloc(sizeof *scene);
    if (!scene)
        return NULL;
    sr_scene_add_object(scene); // the world
    return scene;
}

void sr_scene_destroy(struct sr_scene *scene)
{
    if (!scene)
        return;
    struct object **objects = scene->objects.data;
    for (size_t i = 0; i < scene->objects.count; ++i) {
        if (objects[i] && objects[i]->embree)
            rtcReleaseScene(objects[i]->embree);
        if (objects[i])
            sr_array_free(&objects[i]->defs);
    }
    if (scene->device)
        rtcReleaseDevice(scene->device);
    sr_array_free(&scene->objects);
    sr_array_free(&scene->instance_defs);
    sr_array_free(&scene->mover_defs);
    sr_array_free(&scene->light_defs);
    sr_array_free(&scene->material_list);
    sr_array_free(&scene->degenerates);
    sr_arena_free(&scene->arena);
    sr_free(scene);
}

struct sr_arena *sr_scene_arena(struct sr_scene *scene)
{
    return &scene->arena;
}

struct sr_error *sr_scene_error(struct sr_scene *scene)
{
    return &scene->error;
}

sr_object_id sr_scene_add_object(struct sr_scene *scene)
{
    struct object **slot = sr_array_push(&scene->objects, sizeof *slot);
    if (slot)
        *slot = sr_arena_alloc(&scene->arena, sizeof **slot);
    if (!slot || !*slot)
        scene_no_memory(scene);
    else
        (*slot)->number = (uint32_t)scene->objects.count - 1;
    return (sr_object_id){(uint32_t)scene->objects.count - 1}; // the world is the first, its handle "none"
}

sr_object_id sr_scene_add_object_like(struct sr_scene *scene, sr_object_id earlier)
{
    sr_object_id id = sr_scene_add_object(scene);
    if (scene->error.status == SR_OK)
        ((struct object **)scene->objects.data)[id.index1]->like = earlier.index1;
    return id;
}

void sr_scene_add_shape(struct sr_scene *scene, const struct sr_shape_def *def)
{
    if (scene->error.status != SR_OK)
        return;
    sr_object_id id = def->object;
    if (def->motion) {
        id = sr_scene_add_object(scene);
        struct mover_def *mover = sr_array_push(&scene->mover_defs, sizeof *mover);
        if (mover)
            *mover = (struct mover_def){def->object, id, def->motion};
        else
            scene_no_memory(scene);
        if (scene->error.status != SR_OK)
            return;
    }
    struct object *object = ((struct object **)scene->objects.data)[id.index1];
    struct sr_shape_def *copy = sr_array_push(&object->defs, sizeof *copy);
    if (!copy) {
        scene_no_memory(scene);
        return;
    }
    *copy = *def;
}

static void add_instance(struct sr_scene *scene, struct instance_def def)
{
    if (scene->error.status != SR_OK)
        return;
    struct instance_def *copy = sr_array_push(&scene->instance_defs, sizeof *copy);
    if (!copy)
        scene_no_memory(scene);
    else
        *copy = def;
}

void sr_scene_add_instance(struct sr_scene *scene, sr_object_id object, const struct sr_transform *object_to_world)
{
    add_instance(scene, (struct instance_def){.object_to_world = *object_to_world, .object = object});
}

void sr_scene_add_moving_instance(struct sr_scene *scene, sr_object_id object, const struct sr_motion *motion)
{
    add_instance(scene, (struct instance_def){.object_to_world = motion->start, .object = object, .outer = motion});
}

/* Shapes that move: one instance in the world, or one for each instance of the object that they belong to. */
static void add_movers(struct sr_scene *scene)
{
    const struct mover_def *movers = scene->mover_defs.data;
    size_t stated = scene->instance_defs.count;
    for (size_t i = 0; i < scene->mover_defs.count; ++i) {
        const struct mover_def *m = &movers[i];
        if (!m->parent.index1)
            add_instance(scene, (struct instance_def){.object_to_world = sr_transform_identity(),
                                                      .object = m->object,
                                                      .inner = m->motion});
        for (size_t k = 0; m->parent.index1 && k < stated; ++k) {
            struct instance_def def = ((struct instance_def *)scene->instance_defs.data)[k];
            if (def.object.index1 != m->parent.index1)
                continue;
            def.object = m->object;
            def.inner = m->motion;
            add_instance(scene, def);
        }
    }
    sr_array_free(&scene->mover_defs);
}

void sr_scene_add_light(struct sr_scene *scene, struct sr_light light)
{
    if (scene->error.status != SR_OK)
        return;
    struct sr_light *copy = sr_array_push(&scene->light_defs, sizeof *copy);
    if (!copy)
        scene_no_memory(scene);
    else
        *copy = light;
}

/* ---- finishing ---- */

static uint32_t number_material(struct sr_scene *scene, const struct sr_material *material)
{
    if (!material || !material->model)
        return 0;
    const struct sr_material **list = scene->material_list.data;
    for (size_t i = scene->material_list.count; i-- > 0;) // the newest is the likeliest
        if (list[i] == material)
            return (uint32_t)i + 1;
    const struct sr_material **slot = sr_array_push(&scene->material_list, sizeof *slot);
    if (!slot) {
        scene_no_memory(scene);
        return 0;
    }
    *slot = material;
    return (uint32_t)scene->material_list.count;
}

/* One light for each primitive of a glowing shape, or for each pair of triangles that makes a parallelogram:
 * *per_light. */
static uint32_t add_area_lights(struct sr_scene *scene, const struct sr_shape_def *def, bool is_ghost,
                                uint32_t *per_light)
{
    struct sr_shape shape = def->shape;
    struct sr_shape_patches joined;
    *per_light = 1;
    if (shape.model == &sr_shape_trianglemesh && !def->emission->texels.width &&
        sr_shape_join_triangles(shape.self, &scene->arena, &joined, &scene->error)) {
        shape = (struct sr_shape){&sr_shape_bilinearmesh, sr_arena_copy(&scene->arena, &joined, sizeof joined)};
        *per_light = 2;
    }
    if (!shape.self) {
        scene_no_memory(scene);
        return SR_NO_LIGHT;
    }
    uint32_t n = shape.model->primitive_count(shape.self);
    uint32_t first = (uint32_t)scene->light_defs.count;
    struct sr_light_area *areas = sr_arena_alloc(&scene->arena, (size_t)n * sizeof *areas);
    if (!areas || !sr_array_reserve(&scene->light_defs, first + (size_t)n, sizeof(struct sr_light))) {
        scene_no_memory(scene);
        return SR_NO_LIGHT;
    }
    for (uint32_t i = 0; i < n; ++i) {
        areas[i] = sr_light_area_of(shape, i, def->emission, is_ghost);
        sr_scene_add_light(scene, (struct sr_light){&sr_light_area, &areas[i]});
    }
    return first;
}

static void count_primitives(struct sr_scene_counts *counts, struct sr_shape shape, uint32_t n)
{
    if (shape.model == &sr_shape_trianglemesh)
        counts->triangles += n;
    else if (shape.model == &sr_shape_bilinearmesh)
        counts->patches += n;
    else if (shape.model == &sr_shape_curve)
        counts->curves += ((const struct sr_shape_curves *)shape.self)->count;
    else
        counts->quadrics += n;
}

/* What rays can meet of an object, in the order of description. */
static void place_shapes(struct sr_scene *scene, struct object *object, bool is_world)
{
    const struct sr_shape_def *defs = object->defs.data;
    object->shapes = sr_arena_alloc(&scene->arena, object->defs.count * sizeof *object->shapes);
    if (!object->shapes) {
        scene_no_memory(scene);
        return;
    }
    for (size_t i = 0; i < object->defs.count; ++i) {
        const struct sr_shape_def *def = &defs[i];
        uint32_t material_number = number_material(scene, def->material);
        uint32_t number = ++scene->counts.objects > UINT32_MAX ? UINT32_MAX : (uint32_t)scene->counts.objects;
        float alpha = 1;
        bool is_invisible = def->alpha.model && sr_texture_is_constant_float(def->alpha, &alpha) && alpha <= 0;
        bool has_light = def->emission && is_world && def->shape.model->sample;
        uint32_t per_light = 1,
                 first_light = has_light ? add_area_lights(scene, def, is_invisible, &per_light) : SR_NO_LIGHT;
        uint32_t n = def->shape.model->primitive_count(def->shape.self);
        bool is_mesh = def->shape.model == &sr_shape_trianglemesh;
        if (!object->like) {
            count_primitives(&scene->counts, def->shape, n);
            scene_count_degenerate(scene, def);
        }
        // a surface that neither scatters nor glows nor parts media is not there; nor is one without coverage
        if (n == 0 || is_invisible || (material_number == 0 && !has_light && !def->media))
            continue;
        if (def->media) {
            scene->has_media |= def->media->inside.model || def->media->outside.model;
            scene->has_interfaces |= material_number == 0;
        }
        object->shapes[object->shape_count++] = (struct placed_shape){
            .shape = def->shape,
            .material = material_number ? def->material : NULL,
            .first_light = first_light,
            .per_light = per_light,
            .number = number,
            .media = def->media,
            .alpha = def->alpha.model && !(sr_texture_is_constant_float(def->alpha, &alpha) && alpha >= 1)
                         ? def->alpha
                         : (struct sr_texture){0},
            .material_number = material_number,
            .has_footprint = material_number && sr_material_has_footprint(def->material),
            .is_mesh = is_mesh,
            .lambert = sr_material_lambert(material_number ? def->material : NULL),
            .is_plain = sr_material_is_plain(material_number ? def->material : NULL) &&
                        !(has_light && def->emission->texels.width)};
        scene->has_footprints |= object->shapes[object->shape_count - 1].has_footprint;
        scene->has_subsurface |= sr_material_has_bssrdf(def->material);
    }
    sr_array_free(&object->defs);
}

static void place_lights(struct sr_scene *scene, enum sr_light_choice choice)
{
    sr_vec3 centre;
    float radius;
    sr_box_bounding_sphere(scene->bounds, &centre, &radius);
    uint32_t n = (uint32_t)scene->light_defs.count;
    struct sr_light *lights = sr_arena_copy(&scene->arena, scene->light_defs.data, n * sizeof *lights);
    if (n && !lights) {
        scene_no_memory(scene);
        return;
    }
    sr_array_free(&scene->light_defs);
    for (uint32_t i = 0; i < n; ++i)
        if (lights[i].model->place)
            lights[i].model->place((void *)(uintptr_t)lights[i].self, centre,
                                   radius); // the last change before it is shared
    scene->counts.lights = n;
    scene->counts.materials = scene->material_list.count;
    sr_lights_build(&scene->arena, lights, n, choice, &scene->lights, &scene->error);
}

sr_status sr_scene_finish(struct sr_scene *scene, int threads, enum sr_light_choice choice)
{
    if (scene->error.status != SR_OK || scene->is_finished)
        return scene->error.status;
    double start_s = sr_clock_s();
    add_movers(scene);
    struct object **objects = scene->objects.data;
    for (size_t i = 0; i < scene->objects.count && scene->error.status == SR_OK; ++i)
        place_shapes(scene, objects[i], i == 0);
    scene->world = objects[0];
    scene->counts.instances = scene->instance_defs.count;
    if (scene->error.status == SR_OK)
        scene_build_embree(scene, threads);
    if (scene->error.status == SR_OK)
        scene_find_closed(scene);
    if (scene->error.status == SR_OK)
        scene_find_media(scene);
    if (scene->error.status == SR_OK)
        place_lights(scene, choice);
    scene->counts.geometry_B = scene->arena.total;
    scene->counts.build_s = sr_clock_s() - start_s;
    scene->is_finished = scene->error.status == SR_OK;
    return scene->error.status;
}

bool sr_scene_has_footprints(const struct sr_scene *scene)
{
    return scene->has_footprints;
}

bool sr_scene_moves(const struct sr_scene *scene)
{
    return scene->moves;
}

const struct sr_lights *sr_scene_lights(const struct sr_scene *scene)
{
    return &scene->lights;
}

struct sr_box sr_scene_bounds(const struct sr_scene *scene)
{
    return scene->bounds;
}

bool sr_scene_has_subsurface(const struct sr_scene *scene)
{
    return scene->has_subsurface;
}

bool sr_scene_has_mirrors(const struct sr_scene *scene)
{
    const struct sr_material *const *list = scene->material_list.data;
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, 0.5f);
    sr_vec3 up = {0, 0, 1};
    for (size_t i = 0; i < scene->material_list.count; ++i) {
        struct sr_point x = {.n = up, .ns = up, .dpdu = {1, 0, 0}, .dpdv = {0, 1, 0}, .dpdus = {1, 0, 0}};
        struct sr_bsdf bsdf = {0};
        struct sr_frame frame;
        if (!list[i])
            continue;
        sr_material_shade(list[i], &x, up, 0.5f, 1, &w, &bsdf, &frame);
        if (bsdf.model && sr_bsdf_lobes(&bsdf) & SR_LOBE_SPECULAR)
            return true;
    }
    return false;
}

struct sr_scene_counts sr_scene_count(const struct sr_scene *scene)
{
    return scene->counts;
}
