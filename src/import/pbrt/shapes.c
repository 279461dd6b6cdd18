/* SPDX-License-Identifier: MIT */
/* Shapes, objects and instances. PLY files are read ahead, several at a time; everything is added in the file's order.
 */
#include "import/pbrt/build.h"
#include "import/ply.h"

#include <string.h>

/* What every shape has besides its model's own, and what a PLY mesh has. */
struct common {
    struct sr_texture alpha;
};
static const struct sr_param common_params[] = {
    {SR_PARAM_FLOAT_TEXTURE, "alpha", "1", -INFINITY, INFINITY, NAN, offsetof(struct common, alpha), "opacity"},
    {.name = NULL},
};
const struct sr_param *const sr_pbrt_shape_params = common_params;
struct displaced {
    struct sr_texture displacement;
    float edge_length; // [m]
};
static const struct sr_param ply_params[] = {
    {.kind = SR_PARAM_FILE, .name = "filename", .text = "a PLY file, which gzip may have packed"},
    {SR_PARAM_FLOAT_TEXTURE, "displacement", "m", -INFINITY, INFINITY, NAN, offsetof(struct displaced, displacement),
     "of the vertices along their normals"},
    {SR_PARAM_FLOAT, "edgelength", "m", 0, INFINITY, 1, offsetof(struct displaced, edge_length),
     "that no edge reaches, in the world, before displacement"},
    {.name = NULL},
};
const struct sr_param *const sr_pbrt_ply_params = ply_params;

struct loaded {
    const char *path; // NULL: no PLY mesh
    struct sr_ply_mesh mesh;
    struct sr_error error;
    uint64_t hash;
};

struct adder {
    struct sr_pbrt_build *b;
    sr_object_id *objects;
    struct sr_shape *first_shapes; // of each object; model NULL: none yet
    struct loaded *window;
    size_t window_start, window_size;
    bool has_warned_object_light, has_warned_curve_light;
    uint32_t emission_of; // area_light1 of
    const struct sr_light_emission *emission;
    const struct sr_media *media; // of the last shape that had some
    const char *file, *kept_file; // of the last shape; its name in the scene's arena
};

static bool is_ply(const struct sr_pbrt_shape *s)
{
    return strcmp(s->entity.model, "plymesh") == 0;
}

/* ---- reading ahead ---- */

static void load_one(void *context, uint64_t i)
{
    struct loaded *l = &((struct loaded *)context)[i];
    char *data;
    size_t size;
    if (!l->path || sr_file_read(l->path, (size_t)64 << 30, &data, &size, &l->error) != SR_OK)
        return;
    l->hash = sr_pbrt_hash(0, data, size);
    sr_ply_decode(l->path, data, size, &l->mesh, &l->error);
    sr_free(data);
}

static void free_window(struct adder *a)
{
    for (size_t i = 0; i < a->window_size; ++i)
        sr_ply_free(&a->window[i].mesh);
    sr_free(a->window);
    a->window = NULL;
    a->window_size = 0;
}

static sr_status load_window(struct adder *a, size_t start, size_t size)
{
    struct sr_pbrt_build *b = a->b;
    a->window = sr_alloc(size * sizeof *a->window);
    if (!a->window)
        return sr_pbrt_no_memory(b);
    a->window_start = start;
    a->window_size = size;
    size_t files = 0;
    for (size_t i = 0; i < size; ++i) {
        const struct sr_pbrt_shape *s = SR_PBRT_AT(b->d->shapes, struct sr_pbrt_shape, start + i);
        const char *name = NULL;
        if (!is_ply(s))
            continue;
        if (sr_pbrt_get_string(b->d, &s->entity.params, "filename", &name, b->error) != SR_OK)
            return b->error->status;
        if (!name)
            return sr_pbrt_fail(b->d, s->entity.where, b->error, SR_ERROR_INPUT,
                                "Shape \"plymesh\": expected \"string filename\"");
        if (!(a->window[i].path = sr_pbrt_resolve(b, &b->scratch, name, s->entity.where)))
            return sr_pbrt_no_memory(b);
        ++files;
    }
    if (files)
        sr_parallel_for(b->threads, size, load_one, a->window);
    return SR_OK;
}

/* ---- one shape ---- */

static float area_of(struct sr_shape shape)
{
    double sum = 0;
    uint32_t n = shape.model->primitive_count(shape.self);
    for (uint32_t i = 0; i < n; ++i)
        sum += (double)shape.model->area(shape.self, i);
    return (float)sum;
}

// lamps do not: they stand where they are when the shutter opens
static bool moves(const struct sr_pbrt_build *b, const struct sr_pbrt_shape *s)
{
    return sr_pbrt_moves(b, s->entity.transform) && (!s->area_light1 || s->object1);
}

/* What moves is made in its own space. */
static struct sr_shape_placement placement_of(const struct sr_pbrt_build *b, const struct sr_pbrt_shape *s)
{
    struct sr_transform own =
        moves(b, s) ? sr_transform_identity() : sr_pbrt_transform_of(b, s->entity.transform, sr_pbrt_place_of(s));
    return (struct sr_shape_placement){own, s->reverse_orientation};
}

static sr_status prepare(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s, const struct sr_shape_model *m,
                         void *self, struct sr_shape *out)
{
    struct sr_shape_placement placement = placement_of(b, s);
    struct sr_error inner = {0};
    *out = (struct sr_shape){m->becomes ? m->becomes : m, self};
    return m->prepare(self, &placement, b->arena, &inner) == SR_OK ? SR_OK : sr_pbrt_wrap(b, &s->entity, &inner);
}

static struct sr_slice slice(const void *data, uint32_t count)
{
    return (struct sr_slice){data, data ? count : 0};
}

/* Quads go around the face, patches go by rows: the last two change places. */
static void reorder_quads(int32_t *indices, uint32_t quads)
{
    for (uint32_t i = 0; i < quads; ++i) {
        int32_t *q = indices + 4 * (size_t)i, third = q[2];
        q[2] = q[3];
        q[3] = third;
    }
}

static sr_status make_triangles(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s, const struct sr_ply_mesh *ply,
                                struct sr_shape *out)
{
    struct sr_shape_mesh *m = sr_arena_alloc(b->arena, sizeof *m);
    if (!m)
        return sr_pbrt_no_memory(b);
    m->P = slice(ply->P, ply->vertex_count);
    m->N = slice(ply->N, ply->vertex_count);
    m->uv = slice(ply->uv, ply->vertex_count);
    m->indices = slice(ply->triangles, 3 * ply->triangle_count);
    m->face_indices = slice(ply->face_indices, ply->triangle_count);
    return prepare(b, s, &sr_shape_trianglemesh, m, out);
}

/* Patches, of which those that are flat parallelograms become triangles unless they shine. */
static sr_status add_patches(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s, struct sr_shape_patches *patches,
                             struct sr_shape shapes[], int *count)
{
    struct sr_shape_mesh *triangles = sr_arena_alloc(b->arena, sizeof *triangles);
    struct sr_shape_patches *rest = sr_arena_alloc(b->arena, sizeof *rest);
    if (!triangles || !rest)
        return sr_pbrt_no_memory(b);
    *rest = *patches;
    uint32_t moved = s->area_light1 ? 0 : sr_shape_split_planar_quads(patches, &b->scratch, triangles, rest);
    if (moved == UINT32_MAX)
        return sr_pbrt_no_memory(b);
    sr_status status = SR_OK;
    uint32_t all = patches->indices.count ? patches->indices.count / 4 : 1;
    if (moved)
        status = prepare(b, s, &sr_shape_trianglemesh, triangles, &shapes[(*count)++]);
    if (status == SR_OK && moved < all)
        status = prepare(b, s, &sr_shape_bilinearmesh, rest, &shapes[(*count)++]);
    return status;
}

static sr_status make_quads(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s, struct sr_ply_mesh *ply,
                            struct sr_shape shapes[], int *count)
{
    reorder_quads(ply->quads, ply->quad_count);
    struct sr_shape_patches m = {
        .P = slice(ply->P, ply->vertex_count),
        .N = slice(ply->N, ply->vertex_count),
        .uv = slice(ply->uv, ply->vertex_count),
        .indices = slice(ply->quads, 4 * ply->quad_count),
        .face_indices = slice(ply->face_indices ? ply->face_indices + ply->triangle_count : NULL, ply->quad_count)};
    return add_patches(b, s, &m, shapes, count);
}

static sr_status displace(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s, struct sr_ply_mesh *ply)
{
    struct displaced d;
    const struct sr_param *table = ply_params + 1; // without the file
    sr_status status = sr_pbrt_bind(b, table, &s->entity, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, &d);
    if (status == SR_OK && sr_pbrt_find(&s->entity.params, "displacement"))
        status = sr_pbrt_finish_textures(b); // so that they can be asked now
    if (status != SR_OK || !sr_pbrt_find(&s->entity.params, "displacement"))
        return status;
    struct sr_error inner = {0};
    // as textures take it
    struct sr_transform to_world = sr_pbrt_transform_of(b, s->entity.transform, SR_PBRT_TO_WORLD);
    return sr_pbrt_displace(ply, &to_world, d.edge_length * b->edge_scale, d.displacement, &inner) == SR_OK
               ? SR_OK
               : sr_pbrt_wrap(b, &s->entity, &inner);
}

static sr_status make_ply(struct adder *a, const struct sr_pbrt_shape *s, struct loaded *l, struct sr_shape shapes[],
                          int *count)
{
    struct sr_pbrt_build *b = a->b;
    if (l->error.status != SR_OK)
        return sr_pbrt_fail(b->d, s->entity.where, b->error, l->error.status, "%s", l->error.text);
    b->hash = sr_pbrt_hash(b->hash, &l->hash, sizeof l->hash);
    struct sr_ply_mesh *ply = &l->mesh;
    if (ply->fan_count)
        sr_pbrt_warn(b->d, s->entity.where, "%s: %u faces have more than four corners: each became a fan of triangles",
                     l->path, ply->fan_count);
    if (ply->dropped_count)
        sr_pbrt_warn(b->d, s->entity.where, "%s: %u faces have fewer than three corners: left out", l->path,
                     ply->dropped_count);
    sr_status status = displace(b, s, ply);
    if (status == SR_OK && ply->triangle_count)
        status = make_triangles(b, s, ply, &shapes[(*count)++]);
    if (status == SR_OK && ply->quad_count)
        status = make_quads(b, s, ply, shapes, count);
    sr_ply_free(ply);
    return status;
}

static sr_status unsupported_shape(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e)
{
    const char *names[40];
    size_t n = 0;
    for (; sr_shape_models[n] && n < 39; ++n)
        names[n] = sr_shape_models[n]->name;
    names[n++] = "plymesh";
    return sr_pbrt_unsupported(b, e, names, n);
}

static sr_status make_shape(struct adder *a, const struct sr_pbrt_shape *s, struct loaded *l, struct sr_shape shapes[],
                            int *count)
{
    struct sr_pbrt_build *b = a->b;
    if (is_ply(s))
        return make_ply(a, s, l, shapes, count);
    const struct sr_shape_model *m = sr_shape_model_find(s->entity.model);
    if (!m)
        return unsupported_shape(b, &s->entity);
    void *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    b->is_borrowing = true; // shapes copy what they keep
    sr_status status = sr_pbrt_bind(b, m->params, &s->entity, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, self);
    b->is_borrowing = false;
    return status == SR_OK ? prepare(b, s, m, self, &shapes[(*count)++]) : status;
}

/* That of another object; its parameters are known there. */
static void take_shape(const struct sr_pbrt_shape *s, struct sr_shape shape, struct sr_shape shapes[], int *count)
{
    for (uint32_t i = 0; i < s->entity.params.count; ++i)
        s->entity.params.items[i].used = true;
    shapes[(*count)++] = shape;
}

static sr_status find_emission(struct adder *a, const struct sr_pbrt_shape *s, const struct sr_shape shapes[],
                               int count, const struct sr_light_emission **out)
{
    struct sr_pbrt_build *b = a->b;
    *out = NULL;
    if (!s->area_light1)
        return SR_OK;
    if (s->object1) {
        if (!a->has_warned_object_light)
            sr_pbrt_warn(b->d, s->entity.where,
                         "a shape of an object cannot shine: its area light is left out, as pbrt does");
        a->has_warned_object_light = true;
        return SR_OK;
    }
    if (!shapes[0].model->sample) {
        if (!a->has_warned_curve_light)
            sr_pbrt_warn(b->d, s->entity.where,
                         "a %s cannot shine: its area light is left out (pbrt ends when it draws from one)",
                         shapes[0].model->name);
        a->has_warned_curve_light = true;
        return SR_OK;
    }
    if (a->emission_of == s->area_light1 && !(a->emission->power >= 0)) { // the same for every area
        *out = a->emission;
        return SR_OK;
    }
    float area = 0;
    for (int i = 0; i < count; ++i)
        area += area_of(shapes[i]);
    sr_status status = sr_pbrt_emission(b, s->area_light1, area, out);
    a->emission_of = status == SR_OK ? s->area_light1 : 0;
    a->emission = *out;
    const struct sr_pbrt_param *p = sr_pbrt_find(&s->entity.params, "emissionfilename");
    if (status == SR_OK && p && !(*out)->texels.width)
        sr_pbrt_warn(
            b->d, p->where,
            "\"emissionfilename\" does not glow, here as in pbrt: \"string filename\" of AreaLightSource would");
    return status;
}

/* Where both sides are the same, the surface says nothing of media, and light takes on its own, as in pbrt. */
static sr_status find_media(struct adder *a, const struct sr_pbrt_shape *s, const struct sr_media **out)
{
    struct sr_media media;
    sr_status status = sr_pbrt_medium(a->b, s->inside, s->medium_where, &media.inside);
    if (status == SR_OK)
        status = sr_pbrt_medium(a->b, s->outside, s->medium_where, &media.outside);
    if (status != SR_OK || media.inside.self == media.outside.self)
        return status;
    if (!a->media || a->media->inside.self != media.inside.self || a->media->outside.self != media.outside.self)
        a->media = sr_arena_copy(a->b->arena, &media, sizeof media);
    *out = a->media;
    return *out ? SR_OK : sr_pbrt_no_memory(a->b);
}

static sr_status make_curves(struct adder *a, const struct sr_pbrt_shape *s, struct sr_shape *shape, size_t *run)
{
    struct sr_shape_placement placement = placement_of(a->b, s);
    return sr_pbrt_curves(a->b, s, &placement, shape, run);
}

/* For messages that come when the description has gone. */
static struct sr_location where_of(struct adder *a, const struct sr_pbrt_shape *s)
{
    struct sr_location where = s->entity.where;
    if (where.file && where.file != a->file) {
        a->file = where.file;
        a->kept_file = sr_arena_string(a->b->arena, where.file);
    }
    where.file = where.file ? a->kept_file : NULL;
    return where;
}

/* Adds one shape, or a run of curves: *run is how many directives it is made of. */
static sr_status add_shape(struct adder *a, const struct sr_pbrt_shape *s, struct loaded *l, size_t *run)
{
    struct sr_pbrt_build *b = a->b;
    struct sr_shape shapes[4];
    int count = 0;
    struct common common = {{NULL, NULL}};
    struct sr_shape_def def = {.where = where_of(a, s),
                               .object = s->object1 ? a->objects[s->object1 - 1] : (sr_object_id){0}};
    *run = 1;
    sr_status status = find_media(a, s, &def.media);
    if (status == SR_OK)
        status = sr_pbrt_material(b, &s->material, &def.material);
    if (status == SR_OK)
        status = sr_pbrt_bind(b, common_params, &s->entity, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, &common);
    uint32_t like1 = s->object1 ? SR_PBRT_AT(b->d->objects, struct sr_pbrt_object, s->object1 - 1)->like1 : 0;
    if (like1)
        take_shape(s, a->first_shapes[like1 - 1], shapes, &count);
    else if (status == SR_OK)
        status = sr_pbrt_is_curve(s) ? make_curves(a, s, &shapes[count++], run) : make_shape(a, s, l, shapes, &count);
    if (status == SR_OK)
        status = find_emission(a, s, shapes, count, &def.emission);
    if (status != SR_OK)
        return status;
    float alpha;
    bool is_opaque = !common.alpha.model || (sr_texture_is_constant_float(common.alpha, &alpha) && alpha >= 1);
    def.alpha = is_opaque ? (struct sr_texture){NULL, NULL} : common.alpha;
    if (moves(b, s) &&
        sr_pbrt_motion(b, s->entity.transform, sr_pbrt_place_of(s), "Shape", s->entity.where, &def.motion) != SR_OK)
        return b->error->status;
    if (sr_pbrt_moves(b, s->entity.transform) && !def.motion)
        sr_pbrt_warn(b->d, s->entity.where,
                     "a shape that shines cannot move: it stands where it is when the shutter opens");
    if (s->object1 && count > 0 && !a->first_shapes[s->object1 - 1].model)
        a->first_shapes[s->object1 - 1] = shapes[0];
    for (int i = 0; i < count; ++i) {
        def.shape = shapes[i];
        sr_scene_add_shape(b->result->scene, &def);
        if (!s->name)
            continue;
        struct sr_pbrt_named_shape *named = sr_array_push(&b->named_shapes, sizeof *named);
        if (!named)
            return sr_pbrt_no_memory(b);
        *named = (struct sr_pbrt_named_shape){s->name, shapes[i], s->object1 != 0, def.motion != NULL};
    }
    const struct sr_shape_model *m = is_ply(s) ? NULL : sr_shape_model_find(s->entity.model);
    for (size_t i = 0; i < *run; ++i)
        sr_pbrt_warn_unused(b, &s[i].entity, m ? m->params : ply_params, common_params);
    return SR_OK;
}

/* ---- all of them ---- */

static sr_status add_instances(struct adder *a)
{
    struct sr_pbrt_build *b = a->b;
    for (size_t i = 0; i < b->d->instances.count; ++i) {
        const struct sr_pbrt_instance *instance = SR_PBRT_AT(b->d->instances, struct sr_pbrt_instance, i);
        uint32_t object1 = sr_pbrt_names_find(&b->d->object_names, instance->name);
        if (!object1) {
            struct sr_pbrt_suggestion s = {.word = instance->name};
            char buffer[160];
            sr_pbrt_names_suggest(&b->d->object_names, &s);
            return sr_pbrt_fail(b->d, instance->where, b->error, SR_ERROR_INPUT,
                                "ObjectInstance \"%s\": no object has this name%s", instance->name,
                                sr_pbrt_suggestion_text(&s, buffer));
        }
        sr_object_id object = a->objects[object1 - 1];
        const struct sr_motion *motion;
        if (!object.index1)
            continue;
        struct sr_transform to_world = sr_pbrt_transform_of(b, instance->transform, SR_PBRT_TO_WORLD);
        if (!sr_pbrt_moves(b, instance->transform))
            sr_scene_add_instance(b->result->scene, object, &to_world);
        else if (sr_pbrt_motion(b, instance->transform, SR_PBRT_TO_WORLD, "ObjectInstance", instance->where, &motion) ==
                 SR_OK)
            sr_scene_add_moving_instance(b->result->scene, object, motion);
        else
            return b->error->status;
    }
    return SR_OK;
}

static sr_status build(struct adder *a)
{
    struct sr_pbrt_build *b = a->b;
    const struct sr_pbrt_shape *shapes = b->d->shapes.data;
    size_t n = b->d->shapes.count, window = 32 * (size_t)b->threads;
    for (size_t i = 0; i < n; ++i) { // empty objects stay out
        uint32_t object1 = shapes[i].object1,
                 like1 = object1 ? SR_PBRT_AT(b->d->objects, struct sr_pbrt_object, object1 - 1)->like1 : 0;
        if (object1 && !a->objects[object1 - 1].index1)
            a->objects[object1 - 1] = like1 ? sr_scene_add_object_like(b->result->scene, a->objects[like1 - 1])
                                            : sr_scene_add_object(b->result->scene);
    }
    sr_status status = SR_OK;
    for (size_t start = 0; start < n && status == SR_OK;) {
        size_t size = n - start < window ? n - start : window, run;
        status = load_window(a, start, size);
        for (size_t i = 0; i < size && status == SR_OK; i += run, start += run)
            status = add_shape(a, &shapes[start], &a->window[i], &run);
        free_window(a);
    }
    return status == SR_OK ? add_instances(a) : status;
}

sr_status sr_pbrt_build_shapes(struct sr_pbrt_build *b)
{
    struct adder a = {.b = b,
                      .objects = sr_arena_alloc(&b->scratch, b->d->objects.count * sizeof(sr_object_id)),
                      .first_shapes = sr_arena_alloc(&b->scratch, b->d->objects.count * sizeof(struct sr_shape))};
    return a.objects && a.first_shapes ? build(&a) : sr_pbrt_no_memory(b);
}
