/* SPDX-License-Identifier: MIT */
/* A description as text: settings, then media, textures and materials by name, then lights, objects, shapes, instances.
 */
#include "import/describe.h"
#include "import/pbrt/closest.h"
#include "import/pbrt/format.h"
#include "import/pbrt/statement.h"

#include <string.h>

struct writer {
    struct sr_pbrt_description d;
    struct sr_arena data;
    const struct sr_convert_options *o;
    const char *path;
    struct sr_print *out;
    struct sr_error *error;
    uint32_t mesh_count;
};

static bool is_identity(const struct sr_matrix *t)
{
    struct sr_matrix one = sr_matrix_identity();
    return memcmp(t->m, one.m, sizeof one.m) == 0;
}

/* A float's few digits, unless the number is finer than that: places far away. */
static double print_number(double x)
{
    double few = sr_print_few_digits((float)x);
    return fabs(few - x) <= 1e-7 || fabs(few - x) <= 1e-9 * fabs(x) ? few : x;
}

static void print_transform(struct writer *w, const char *word, uint32_t index)
{
    const struct sr_matrix *t = &SR_PBRT_AT(w->d.transforms, struct sr_pbrt_transform, index)->start;
    if (is_identity(t))
        return;
    struct sr_pbrt_statement s = {.word = word, .number_count = 16};
    for (int i = 0; i < 16; ++i)
        s.numbers[i] = print_number(t->m[i % 4][i / 4]); // column by column
    sr_pbrt_statement_print(w->out, &s);
}

static void print_words(struct writer *w, const char *word, const char *a, const char *b, const char *c,
                        const struct sr_pbrt_params *params)
{
    struct sr_pbrt_statement s = {
        .word = word, .strings = {a, b, c}, .string_count = (a != NULL) + (b != NULL) + (c != NULL)};
    if (params)
        s.params = *params;
    sr_pbrt_statement_print(w->out, &s);
}

/* ---- files ---- */

/* An image that lay in the file is written beside the text. */
static const char *unpack(struct writer *w, const struct sr_pbrt_memory_file *file)
{
    const char *stem = strrchr(file->name, '/'),
               *path = sr_convert_beside(&w->data, w->o->out, stem ? stem + 1 : file->name, "");
    if (!path || sr_file_write(path, file->data, file->size, w->error) != SR_OK)
        return NULL;
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bool names_file(const char *name)
{
    static const char *const names[] = {"filename", "normalmap", "emissionfilename"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

static sr_status move_files(struct writer *w, struct sr_pbrt_params *params)
{
    for (uint32_t i = 0; i < params->count; ++i) {
        struct sr_pbrt_param *p = &params->items[i];
        if (p->type != SR_PBRT_STRING_TYPE || p->count != 1 || !names_file(p->name))
            continue;
        const struct sr_pbrt_memory_file *file = sr_pbrt_memory_file(&w->d, p->strings[0]);
        const char **copy = sr_pbrt_words(&w->d, sizeof *copy),
                   *beside = sr_path_beside(&w->data, w->path, p->strings[0]);
        if (!copy || !beside)
            return sr_fail(w->error, SR_ERROR_RESOURCE, "%s: not enough memory", w->path);
        *copy = file                      ? unpack(w, file)
                : p->strings[0][0] == '/' ? p->strings[0]
                                          : sr_path_seen_from(&w->data, w->o->out, beside);
        if (w->error->status != SR_OK)
            return w->error->status;
        if (!*copy)
            *copy = p->strings[0];
        p->strings = copy;
    }
    return SR_OK;
}

/* ---- entities ---- */

static sr_status print_settings(struct writer *w)
{
    const struct sr_pbrt_entity *all[] = {&w->d.film, &w->d.sampler, &w->d.filter, &w->d.integrator};
    for (size_t i = 0; i < w->d.options.count; ++i) {
        const struct sr_pbrt_option *o = SR_PBRT_AT(w->d.options, struct sr_pbrt_option, i);
        struct sr_pbrt_param value = o->value;
        struct sr_pbrt_params params = {&value, 1};
        print_words(w, "Option", NULL, NULL, NULL, &params);
    }
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        if (all[i]->params.count || strcmp(all[i]->model, i == 0   ? "rgb"
                                                          : i == 1 ? "zsobol"
                                                          : i == 2 ? "gaussian"
                                                                   : "volpath") != 0)
            print_words(w, all[i]->directive, all[i]->model, NULL, NULL, &all[i]->params);
    if (w->d.camera_medium && w->d.camera_medium[0])
        print_words(w, "MediumInterface", "", w->d.camera_medium, NULL, NULL);
    print_transform(w, "Transform", w->d.camera.transform);
    print_words(w, "Camera", w->d.camera.model, NULL, NULL, &w->d.camera.params);
    sr_print_word(w->out, "\nWorldBegin\n\n");
    return SR_OK;
}

/* with its transform, if it has one, in a block of its own */
static void begin_block(struct writer *w, uint32_t transform)
{
    print_words(w, "AttributeBegin", NULL, NULL, NULL, NULL);
    ++w->out->depth;
    print_transform(w, "Transform", transform);
}

static void end_block(struct writer *w)
{
    --w->out->depth;
    print_words(w, "AttributeEnd", NULL, NULL, NULL, NULL);
}

static bool is_placed(const struct writer *w, uint32_t transform)
{
    return !is_identity(&SR_PBRT_AT(w->d.transforms, struct sr_pbrt_transform, transform)->start);
}

/* MakeNamed… "name" "string type" "kind" … */
static void print_named(struct writer *w, const char *word, const struct sr_pbrt_entity *e)
{
    struct sr_pbrt_param *items = sr_pbrt_words(&w->d, (e->params.count + 1) * sizeof *items);
    const char **model = sr_pbrt_words(&w->d, sizeof *model);
    if (!items || !model) {
        w->out->has_failed = true;
        return;
    }
    *model = e->model;
    items[0] = (struct sr_pbrt_param){.type = SR_PBRT_STRING_TYPE, .name = "type", .count = 1, .strings = model};
    if (e->params.count)
        memcpy(items + 1, e->params.items, e->params.count * sizeof *items);
    struct sr_pbrt_params params = {items, e->params.count + 1};
    print_words(w, word, e->name, NULL, NULL, &params);
}

static sr_status print_named_things(struct writer *w)
{
    for (size_t i = 0; i < w->d.media.count; ++i) {
        const struct sr_pbrt_entity *e = SR_PBRT_AT(w->d.media, struct sr_pbrt_entity, i);
        begin_block(w, e->transform);
        print_named(w, "MakeNamedMedium", e);
        end_block(w);
    }
    for (size_t i = 0; i < w->d.textures.count; ++i) {
        struct sr_pbrt_texture *t = SR_PBRT_AT(w->d.textures, struct sr_pbrt_texture, i);
        bool is_made = false;
        if (!w->o->for_steradian && sr_pbrt_is_normal_texture(&w->d, t->entity.name))
            continue; // the material has a normal map instead
        if (!w->o->for_steradian &&
            sr_pbrt_closest_texture(&w->d, &w->data, w->path, w->o->out, t, &is_made, w->error) != SR_OK)
            return w->error->status;
        if (!is_made && move_files(w, &t->entity.params) != SR_OK)
            return w->error->status;
        if (is_placed(w, t->entity.transform))
            begin_block(w, t->entity.transform);
        print_words(w, "Texture", t->entity.name, t->is_float ? "float" : "spectrum", t->entity.model,
                    &t->entity.params);
        if (is_placed(w, t->entity.transform))
            end_block(w);
    }
    for (size_t i = 0; i < w->d.named_materials.count; ++i) {
        struct sr_pbrt_entity *e = SR_PBRT_AT(w->d.named_materials, struct sr_pbrt_entity, i);
        if ((!w->o->for_steradian && sr_pbrt_closest_normals(&w->d, e, w->error) != SR_OK) ||
            move_files(w, &e->params) != SR_OK)
            return w->error->status;
        if (!w->o->for_steradian && sr_pbrt_closest_material(&w->d, e, w->out, w->error) != SR_OK)
            return w->error->status;
        print_named(w, "MakeNamedMaterial", e);
    }
    sr_print_word(w->out, "\n");
    return SR_OK;
}

static sr_status print_lights(struct writer *w)
{
    for (size_t i = 0; i < w->d.area_lights.count; ++i) // several shapes may be lit by one
        if (move_files(w, &SR_PBRT_AT(w->d.area_lights, struct sr_pbrt_entity, i)->params) != SR_OK)
            return w->error->status;
    for (size_t i = 0; i < w->d.lights.count; ++i) {
        struct sr_pbrt_light *l = SR_PBRT_AT(w->d.lights, struct sr_pbrt_light, i);
        if (move_files(w, &l->entity.params) != SR_OK)
            return w->error->status;
        begin_block(w, l->entity.transform);
        print_words(w, "LightSource", l->entity.model, NULL, NULL, &l->entity.params);
        end_block(w);
    }
    return SR_OK;
}

static sr_status set_mesh_apart(struct writer *w, struct sr_pbrt_shape *s)
{
    struct sr_print_mesh mesh;
    if (!w->o->ply_above || !sr_print_is_mesh(s->entity.model, &s->entity.params, w->o->ply_above, &mesh))
        return SR_OK;
    const char *name = sr_convert_mesh_name(&w->data, w->o->out, ++w->mesh_count);
    return name ? sr_print_mesh_apart(&w->d, name, &mesh, &s->entity.model, &s->entity.params, w->error)
                : sr_fail(w->error, SR_ERROR_RESOURCE, "%s: not enough memory", w->path);
}

static sr_status print_shape(struct writer *w, struct sr_pbrt_shape *s)
{
    begin_block(w, s->entity.transform);
    if (s->reverse_orientation)
        print_words(w, "ReverseOrientation", NULL, NULL, NULL, NULL);
    if ((s->inside && s->inside[0]) || (s->outside && s->outside[0]))
        print_words(w, "MediumInterface", s->inside ? s->inside : "", s->outside ? s->outside : "", NULL, NULL);
    if (s->material.name)
        print_words(w, "NamedMaterial", s->material.name, NULL, NULL, NULL);
    if (s->area_light1) {
        struct sr_pbrt_entity *light = SR_PBRT_AT(w->d.area_lights, struct sr_pbrt_entity, s->area_light1 - 1);
        print_words(w, "AreaLightSource", light->model, NULL, NULL, &light->params);
    }
    if (s->name) {
        sr_print_line(w->out, 0);
        sr_print_word(w->out, "#@ Name ");
        sr_print_quoted(w->out, s->name);
        sr_print_word(w->out, "\n");
    }
    if (set_mesh_apart(w, s) != SR_OK)
        return w->error->status;
    print_words(w, "Shape", s->entity.model, NULL, NULL, &s->entity.params);
    end_block(w);
    return w->out->has_failed ? sr_fail(w->error, SR_ERROR_RESOURCE, "%s: not enough memory", w->path) : SR_OK;
}

static sr_status print_shapes(struct writer *w, uint32_t object1)
{
    for (size_t i = 0; i < w->d.shapes.count; ++i) {
        struct sr_pbrt_shape *s = SR_PBRT_AT(w->d.shapes, struct sr_pbrt_shape, i);
        if (s->object1 == object1 && print_shape(w, s) != SR_OK)
            return w->error->status;
    }
    return SR_OK;
}

static sr_status print_world(struct writer *w)
{
    sr_status status = print_named_things(w);
    if (status == SR_OK)
        status = print_lights(w);
    for (uint32_t i = 0; i < w->d.objects.count && status == SR_OK; ++i) {
        print_words(w, "ObjectBegin", SR_PBRT_AT(w->d.objects, struct sr_pbrt_object, i)->name, NULL, NULL, NULL);
        ++w->out->depth;
        status = print_shapes(w, i + 1);
        --w->out->depth;
        print_words(w, "ObjectEnd", NULL, NULL, NULL, NULL);
    }
    if (status == SR_OK)
        status = print_shapes(w, 0);
    for (size_t i = 0; i < w->d.instances.count && status == SR_OK; ++i) {
        const struct sr_pbrt_instance *instance = SR_PBRT_AT(w->d.instances, struct sr_pbrt_instance, i);
        begin_block(w, instance->transform);
        print_words(w, "ObjectInstance", instance->name, NULL, NULL, NULL);
        end_block(w);
    }
    return status;
}

sr_status sr_pbrt_write(const char *path, const struct sr_convert_options *o, struct sr_print *out, struct sr_log *log,
                        struct sr_error *error)
{
    static const struct sr_import_options nothing;
    struct writer w = {.o = o, .path = path, .out = out, .error = error};
    struct sr_arena kept = {0};
    sr_status status = sr_describe(path, &nothing, &kept, log, &w.d, error);
    if (status == SR_OK)
        status = print_settings(&w);
    if (status == SR_OK)
        status = print_world(&w);
    sr_pbrt_description_free(&w.d);
    sr_arena_free(&w.data);
    sr_arena_free(&kept);
    return status;
}
