/* SPDX-License-Identifier: MIT */
/* Fills a description by calls. */
#include "import/pbrt/compose.h"

#include <stdio.h>
#include <string.h>

static void no_memory(struct sr_compose *c)
{
    sr_fail(c->error, SR_ERROR_RESOURCE, "%s: not enough memory", c->path);
}

void sr_compose_begin(struct sr_compose *c, const char *path, struct sr_arena *data, struct sr_log *log,
                      struct sr_pbrt_description *d, struct sr_error *error)
{
    *c = (struct sr_compose){.d = d, .error = error, .path = path, .where = {path, 0, 0}};
    if (!sr_pbrt_description_start(d, data, log))
        no_memory(c);
}

sr_status sr_compose_end(struct sr_compose *c)
{
    c->d->has_world = true;
    sr_array_free(&c->params);
    return c->error->status;
}

sr_status sr_compose_fail(struct sr_compose *c, sr_status status, const char *format, ...)
{
    char text[900];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return sr_pbrt_fail(c->d, c->where, c->error, status, "%s", text);
}

void sr_compose_warn(struct sr_compose *c, const char *format, ...)
{
    char text[900];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sr_pbrt_warn(c->d, c->where, "%s", text);
}

const char *sr_compose_word(struct sr_compose *c, const char *word)
{
    const char *copy = sr_pbrt_text(c->d, word, strlen(word));
    if (copy)
        return copy;
    no_memory(c);
    return "";
}

const char *sr_compose_printf(struct sr_compose *c, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return sr_compose_word(c, text);
}

static void *push(struct sr_compose *c, struct sr_array *array, size_t size)
{
    void *item = c->error->status == SR_OK ? sr_array_push(array, size) : NULL;
    if (!item)
        no_memory(c);
    return item;
}

uint32_t sr_compose_matrix(struct sr_compose *c, const struct sr_matrix *a)
{
    struct sr_pbrt_transform *slot = push(c, &c->d->transforms, sizeof *slot);
    if (!slot)
        return 0;
    *slot = (struct sr_pbrt_transform){*a, *a};
    return (uint32_t)c->d->transforms.count - 1;
}

uint32_t sr_compose_transform(struct sr_compose *c, const struct sr_transform *t)
{
    struct sr_matrix a = sr_matrix_of(t);
    return sr_compose_matrix(c, &a);
}

/* ---- parameters ---- */

static struct sr_pbrt_param *add(struct sr_compose *c, enum sr_pbrt_type type, const char *name, size_t count)
{
    if (count > INT32_MAX)
        sr_compose_fail(c, SR_ERROR_INPUT, "\"%s\" has %zu values: expected at most 2147483647", name, count);
    struct sr_pbrt_param *p = push(c, &c->params, sizeof *p);
    if (p)
        *p = (struct sr_pbrt_param){.type = type,
                                    .space = SR_SRGB,
                                    .name = sr_compose_word(c, name),
                                    .where = c->where,
                                    .count = (uint32_t)count};
    return p;
}

static void *copy(struct sr_compose *c, const void *values, size_t size)
{
    void *to = sr_pbrt_words(c->d, size);
    if (to)
        memcpy(to, values, size);
    else
        no_memory(c);
    return to;
}

void sr_compose_floats(struct sr_compose *c, enum sr_pbrt_type type, const char *name, const float *values,
                       size_t count)
{
    struct sr_pbrt_param *p = add(c, type, name, count);
    if (p)
        p->floats = values;
}

void sr_compose_ints(struct sr_compose *c, const char *name, const int32_t *values, size_t count)
{
    struct sr_pbrt_param *p = add(c, SR_PBRT_INTEGER, name, count);
    if (p)
        p->ints = values;
}

void sr_compose_bool(struct sr_compose *c, const char *name, bool value)
{
    struct sr_pbrt_param *p = add(c, SR_PBRT_BOOL, name, 1);
    if (p)
        p->ints = copy(c, &(int32_t){value}, sizeof(int32_t));
}

void sr_compose_int(struct sr_compose *c, const char *name, int32_t value)
{
    sr_compose_ints(c, name, copy(c, &value, sizeof value), 1);
}

void sr_compose_float(struct sr_compose *c, const char *name, float value)
{
    sr_compose_floats(c, SR_PBRT_FLOAT, name, copy(c, &value, sizeof value), 1);
}

void sr_compose_blackbody(struct sr_compose *c, const char *name, float kelvin)
{
    sr_compose_floats(c, SR_PBRT_BLACKBODY, name, copy(c, &kelvin, sizeof kelvin), 1);
}

void sr_compose_rgb(struct sr_compose *c, const char *name, struct sr_rgb value)
{
    sr_compose_floats(c, SR_PBRT_RGB, name, copy(c, &value, 3 * sizeof(float)), 3);
}

void sr_compose_tuple(struct sr_compose *c, enum sr_pbrt_type type, const char *name, sr_vec3 value)
{
    sr_compose_floats(c, type, name, copy(c, &value, 3 * sizeof(float)), 3);
}

static void add_string(struct sr_compose *c, enum sr_pbrt_type type, const char *name, const char *value)
{
    struct sr_pbrt_param *p = add(c, type, name, 1);
    const char *word = sr_compose_word(c, value);
    if (p) {
        p->strings = copy(c, &word, sizeof word);
        p->is_text = type == SR_PBRT_SPECTRUM;
    }
}

void sr_compose_string(struct sr_compose *c, const char *name, const char *value)
{
    add_string(c, SR_PBRT_STRING_TYPE, name, value);
}

void sr_compose_texture_name(struct sr_compose *c, const char *name, const char *texture)
{
    add_string(c, SR_PBRT_TEXTURE, name, texture);
}

void sr_compose_spectrum(struct sr_compose *c, const char *name, const char *spectrum)
{
    add_string(c, SR_PBRT_SPECTRUM, name, spectrum);
}

/* ---- entities ---- */

static struct sr_pbrt_entity entity(struct sr_compose *c, const char *directive, const char *name, const char *model)
{
    struct sr_pbrt_entity e = {.directive = directive,
                               .model = sr_compose_word(c, model),
                               .name = name ? sr_compose_word(c, name) : NULL,
                               .where = c->where,
                               .space = SR_SRGB,
                               .transform = c->transform};
    if (c->params.count)
        e.params.items = copy(c, c->params.data, c->params.count * sizeof(struct sr_pbrt_param));
    if (e.params.items)
        e.params.count = (uint32_t)c->params.count;
    c->params.count = 0;
    return e;
}

void sr_compose_setting(struct sr_compose *c, const char *directive, const char *model)
{
    struct sr_pbrt_entity e = entity(c, directive, NULL, model),
                          *settings[] = {&c->d->film, &c->d->sampler, &c->d->filter, &c->d->integrator};
    for (size_t i = 0; i < sizeof settings / sizeof *settings; ++i)
        if (strcmp(settings[i]->directive, directive) == 0) {
            e.directive = settings[i]->directive;
            *settings[i] = e;
        }
}

void sr_compose_camera(struct sr_compose *c, const char *model, const struct sr_transform *camera_to_world)
{
    struct sr_matrix to_world = sr_matrix_of(camera_to_world), to_camera = sr_matrix_invert(&to_world);
    uint32_t kept = c->transform;
    c->transform = sr_compose_matrix(c, &to_camera);
    c->d->camera = entity(c, "Camera", NULL, model);
    c->transform = kept;
}

static void add_name(struct sr_compose *c, struct sr_pbrt_names *names, const char *name, size_t index1)
{
    if (sr_pbrt_names_find(names, name))
        sr_compose_fail(c, SR_ERROR_INPUT, "the name \"%s\" is taken", name);
    else if (!sr_pbrt_names_add(names, name, (uint32_t)index1))
        no_memory(c);
}

void sr_compose_material(struct sr_compose *c, const char *name, const char *model)
{
    struct sr_pbrt_entity e = entity(c, "MakeNamedMaterial", name, model),
                          *slot = push(c, &c->d->named_materials, sizeof *slot);
    if (!slot)
        return;
    *slot = e;
    add_name(c, &c->d->material_names, e.name, c->d->named_materials.count);
}

void sr_compose_medium(struct sr_compose *c, const char *name, const char *model)
{
    struct sr_pbrt_entity e = entity(c, "MakeNamedMedium", name, model), *slot = push(c, &c->d->media, sizeof *slot);
    if (!slot)
        return;
    *slot = e;
    add_name(c, &c->d->medium_names, e.name, c->d->media.count);
}

void sr_compose_texture(struct sr_compose *c, const char *name, bool is_float, const char *model)
{
    struct sr_pbrt_texture t = {entity(c, "Texture", name, model), is_float},
                           *slot = push(c, &c->d->textures, sizeof *slot);
    if (!slot)
        return;
    *slot = t;
    add_name(c, is_float ? &c->d->float_textures : &c->d->spectrum_textures, t.entity.name, c->d->textures.count);
}

void sr_compose_light(struct sr_compose *c, const char *model)
{
    struct sr_pbrt_light light = {.entity = entity(c, "LightSource", NULL, model),
                                  .outside = c->outside,
                                  .medium_where = c->where},
                         *slot = push(c, &c->d->lights, sizeof *slot);
    if (slot)
        *slot = light;
}

uint32_t sr_compose_area_light(struct sr_compose *c)
{
    struct sr_pbrt_entity e = entity(c, "AreaLightSource", NULL, "diffuse"),
                          *slot = push(c, &c->d->area_lights, sizeof *slot);
    if (!slot)
        return 0;
    *slot = e;
    return (uint32_t)c->d->area_lights.count;
}

void sr_compose_named_shape(struct sr_compose *c, const char *name, const char *model)
{
    struct sr_pbrt_shape shape = {.entity = entity(c, "Shape", NULL, model),
                                  .material = {.name = c->material, .where = c->where},
                                  .area_light1 = c->area_light1,
                                  .object1 = c->object1,
                                  .reverse_orientation = c->reverse_orientation,
                                  .inside = c->inside,
                                  .outside = c->outside,
                                  .medium_where = c->where,
                                  .name = name ? sr_compose_word(c, name) : NULL},
                         *slot = push(c, &c->d->shapes, sizeof *slot);
    if (slot)
        *slot = shape;
}

void sr_compose_shape(struct sr_compose *c, const char *model)
{
    sr_compose_named_shape(c, NULL, model);
}

uint32_t sr_compose_object(struct sr_compose *c, const char *name)
{
    struct sr_pbrt_object *slot = push(c, &c->d->objects, sizeof *slot);
    if (!slot)
        return 0;
    *slot = (struct sr_pbrt_object){.name = sr_compose_word(c, name), .where = c->where};
    add_name(c, &c->d->object_names, slot->name, c->d->objects.count);
    return (uint32_t)c->d->objects.count;
}

void sr_compose_instance(struct sr_compose *c, const char *object)
{
    struct sr_pbrt_instance *slot = push(c, &c->d->instances, sizeof *slot);
    if (slot)
        *slot = (struct sr_pbrt_instance){sr_compose_word(c, object), c->where, c->transform};
}

void sr_compose_file(struct sr_compose *c, const char *name, const void *data, size_t size)
{
    struct sr_pbrt_memory_file *slot = push(c, &c->d->memory_files, sizeof *slot);
    if (slot)
        *slot = (struct sr_pbrt_memory_file){sr_compose_word(c, name), data, size};
}
