/* SPDX-License-Identifier: MIT */
/* What each directive does to the graphics state or adds to the description. */
#include "import/pbrt/build.h"
#include "import/pbrt/parser.h"

#include <ctype.h>
#include <string.h>

static const struct sr_pbrt_params no_defaults = {NULL, 0};

static sr_status no_memory(struct sr_pbrt_parser *p)
{
    return sr_fail(p->error, SR_ERROR_RESOURCE, "%s: not enough memory", p->main_path);
}

/* ---- before the world ---- */

static sr_status read_single(struct sr_pbrt_parser *p, struct sr_pbrt_entity *entity)
{
    return sr_pbrt_read_entity(p, "the name of a kind", no_defaults, entity);
}

/* The current transform takes the world to the camera; "camera" is the way back. */
static sr_status read_camera(struct sr_pbrt_parser *p)
{
    sr_status status = read_single(p, &p->d->camera);
    struct sr_pbrt_transform t = {sr_matrix_invert(&p->state.ctm.start), sr_matrix_invert(&p->state.ctm.end)};
    p->d->camera_medium = p->state.outside;
    p->d->camera_medium_where = p->state.medium_where;
    return status == SR_OK ? sr_pbrt_name_coordinates(p, "camera", &t) : status;
}

static sr_status read_film(struct sr_pbrt_parser *p)
{
    p->d->film_space = p->state.space;
    return read_single(p, &p->d->film);
}

static sr_status read_sampler(struct sr_pbrt_parser *p)
{
    return read_single(p, &p->d->sampler);
}

static sr_status read_filter(struct sr_pbrt_parser *p)
{
    return read_single(p, &p->d->filter);
}

static sr_status read_integrator(struct sr_pbrt_parser *p)
{
    return read_single(p, &p->d->integrator);
}

static sr_status read_accelerator(struct sr_pbrt_parser *p)
{
    return read_single(p, &p->d->accelerator);
}

/* Option "type name" value; names are compared in lower case without - and _ */
static sr_status read_option(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_params params;
    sr_status status = sr_pbrt_option_read(p->d, p->lexer, &p->scratch, &params, p->error);
    if (status == SR_OK && params.count != 1)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "Option: expected one \"type name\" and its value");
    if (status != SR_OK)
        return status;
    struct sr_pbrt_option *option = sr_array_push(&p->d->options, sizeof *option);
    char *name = option ? sr_pbrt_words(p->d, strlen(params.items[0].name) + 1) : NULL, *to = name;
    if (!name)
        return no_memory(p);
    for (const char *c = params.items[0].name; *c; ++c)
        if (*c != '-' && *c != '_')
            *to++ = (char)tolower((unsigned char)*c);
    *option = (struct sr_pbrt_option){name, params.items[0]};
    struct sr_pbrt_suggestion s = {.word = name};
    char buffer[160];
    for (const struct sr_param *known = sr_pbrt_option_params; known->name; ++known) {
        if (strcmp(name, known->name) == 0)
            return SR_OK;
        sr_pbrt_suggest(&s, known->name);
    }
    return sr_pbrt_fail(p->d, option->value.where, p->error, SR_ERROR_INPUT, "Option: unknown option \"%s\"%s",
                        option->value.name, sr_pbrt_suggestion_text(&s, buffer));
}

static sr_status read_world_begin(struct sr_pbrt_parser *p)
{
    struct sr_matrix one = sr_matrix_identity();
    p->d->has_world = true;
    p->state.ctm = (struct sr_pbrt_transform){one, one};
    p->state.transform = UINT32_MAX;
    p->state.at_start = p->state.at_end = true;
    return sr_pbrt_name_coordinates(p, "world", &p->state.ctm);
}

static sr_status read_world_end(struct sr_pbrt_parser *p)
{
    sr_pbrt_warn(p->d, p->where, "WorldEnd is a word of older formats and means nothing here");
    return SR_OK;
}

/* ---- the stack ---- */

static sr_status push(struct sr_pbrt_parser *p, bool is_object)
{
    struct sr_pbrt_saved_state *saved = sr_array_push(&p->stack, sizeof *saved);
    if (!saved)
        return no_memory(p);
    *saved = (struct sr_pbrt_saved_state){p->state, p->where, is_object};
    return SR_OK;
}

static sr_status pop(struct sr_pbrt_parser *p, bool is_object)
{
    if (p->stack.count == 0)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "%s without %s before it", p->directive,
                            is_object ? "ObjectBegin" : "AttributeBegin");
    const struct sr_pbrt_saved_state *saved = SR_PBRT_AT(p->stack, struct sr_pbrt_saved_state, p->stack.count - 1);
    if (saved->is_object != is_object)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "%s: expected %s, which belongs to line %d",
                            p->directive, saved->is_object ? "ObjectEnd" : "AttributeEnd", saved->where.line);
    p->state = saved->state;
    --p->stack.count;
    return SR_OK;
}

static sr_status read_attribute_begin(struct sr_pbrt_parser *p)
{
    return push(p, false);
}

static sr_status read_attribute_end(struct sr_pbrt_parser *p)
{
    return pop(p, false);
}

static sr_status read_transform_begin(struct sr_pbrt_parser *p)
{
    if (!p->has_warned_transform)
        sr_pbrt_warn(
            p->d, p->where,
            "TransformBegin and TransformEnd are deprecated; they are read as AttributeBegin and AttributeEnd");
    p->has_warned_transform = true;
    return push(p, false);
}

static sr_status read_attribute(struct sr_pbrt_parser *p)
{
    static const char *const targets[] = {"shape", "light", "material", "medium", "texture"};
    const char *target;
    sr_status status = sr_pbrt_read_string(p, "\"shape\", \"light\", \"material\", \"medium\" or \"texture\"", &target);
    for (int i = 0; i < SR_PBRT_ATTRIBUTE_COUNT && status == SR_OK; ++i)
        if (strcmp(target, targets[i]) == 0) // the newest come first, and so win
            return sr_pbrt_params_read(p->d, p->lexer, &p->scratch, p->state.space, p->state.attributes[i],
                                       &p->state.attributes[i], p->error);
    return status != SR_OK
               ? status
               : sr_pbrt_fail(
                     p->d, p->where, p->error, SR_ERROR_INPUT,
                     "Attribute \"%s\": expected \"shape\", \"light\", \"material\", \"medium\" or \"texture\"",
                     target);
}

static sr_status read_reverse_orientation(struct sr_pbrt_parser *p)
{
    p->state.reverse_orientation = !p->state.reverse_orientation;
    return SR_OK;
}

static sr_status read_colour_space(struct sr_pbrt_parser *p)
{
    const char *name;
    sr_status status = sr_pbrt_read_string(p, "the name of a colour space", &name);
    if (status == SR_OK && !sr_colour_space_find(name, &p->state.space))
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "ColorSpace \"%s\": expected srgb, dci-p3, rec2020 or aces2065-1", name);
    return status;
}

/* ---- matter and light ---- */

static sr_status read_material(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_entity *entity = sr_array_push(&p->d->materials, sizeof *entity);
    if (!entity)
        return no_memory(p);
    p->state.material = (struct sr_pbrt_material_ref){(uint32_t)p->d->materials.count - 1, NULL, p->where};
    return sr_pbrt_read_entity(p, "the name of a kind of material", p->state.attributes[SR_PBRT_OF_MATERIAL], entity);
}

static sr_status read_named_material(struct sr_pbrt_parser *p)
{
    const char *name;
    sr_status status = sr_pbrt_read_string(p, "the name of a material", &name);
    if (status == SR_OK)
        p->state.material = (struct sr_pbrt_material_ref){0, name, p->where};
    return status;
}

/* MakeNamedMaterial and MakeNamedMedium: the first string is the name, the kind is "string type" */
static sr_status read_named(struct sr_pbrt_parser *p, struct sr_array *list, struct sr_pbrt_names *names,
                            enum sr_pbrt_attribute attribute)
{
    struct sr_pbrt_entity e;
    sr_status status = sr_pbrt_read_entity(p, "a name", p->state.attributes[attribute], &e);
    if (status != SR_OK)
        return status;
    e.name = e.model;
    e.model = NULL;
    uint32_t taken = sr_pbrt_names_find(names, e.name);
    if (taken) {
        struct sr_location other = SR_PBRT_AT(*list, struct sr_pbrt_entity, taken - 1)->where;
        return sr_pbrt_fail(p->d, e.where, p->error, SR_ERROR_INPUT, "%s \"%s\": the name is taken, by %s:%d",
                            e.directive, e.name, other.file, other.line);
    }
    status = sr_pbrt_get_string(p->d, &e.params, "type", &e.model, p->error);
    if (status == SR_OK && !e.model)
        return sr_pbrt_fail(p->d, e.where, p->error, SR_ERROR_INPUT, "%s \"%s\": expected a parameter \"string type\"",
                            e.directive, e.name);
    struct sr_pbrt_entity *slot = status == SR_OK ? sr_array_push(list, sizeof *slot) : NULL;
    if (status != SR_OK)
        return status;
    if (!slot || !sr_pbrt_names_add(names, e.name, (uint32_t)list->count))
        return no_memory(p);
    *slot = e;
    return SR_OK;
}

static sr_status read_make_named_material(struct sr_pbrt_parser *p)
{
    return read_named(p, &p->d->named_materials, &p->d->material_names, SR_PBRT_OF_MATERIAL);
}

static sr_status read_make_named_medium(struct sr_pbrt_parser *p)
{
    return read_named(p, &p->d->media, &p->d->medium_names, SR_PBRT_OF_MEDIUM);
}

/* one name: both sides */
static sr_status read_medium_interface(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_token token;
    sr_status status = sr_pbrt_read_string(p, "the name of the medium inside", &p->state.inside);
    p->state.outside = p->state.inside;
    p->state.medium_where = p->where;
    if (status == SR_OK && (status = sr_pbrt_lexer_peek(p->lexer, &token, p->error)) == SR_OK &&
        token.kind == SR_PBRT_STRING)
        status = sr_pbrt_read_string(p, "the name of the medium outside", &p->state.outside);
    return status;
}

static void warn_of_motion(struct sr_pbrt_parser *p)
{
    if (!p->has_warned_motion && memcmp(p->state.ctm.start.m, p->state.ctm.end.m, sizeof p->state.ctm.start.m) != 0) {
        p->has_warned_motion = true;
        sr_pbrt_warn(
            p->d, p->where,
            "this %s moves while the shutter is open: lights, textures and media cannot, and stand as when it opens",
            p->directive);
    }
}

static sr_status read_texture(struct sr_pbrt_parser *p)
{
    const char *name, *type;
    sr_status status = sr_pbrt_read_string(p, "a name for the texture", &name);
    if (status == SR_OK)
        status = sr_pbrt_read_string(p, "\"float\" or \"spectrum\"", &type);
    if (status != SR_OK)
        return status;
    bool is_float = strcmp(type, "float") == 0;
    if (!is_float && strcmp(type, "spectrum") != 0)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "Texture \"%s\" \"%s\": expected \"float\" or \"spectrum\"", name, type);
    struct sr_pbrt_names *names = is_float ? &p->d->float_textures : &p->d->spectrum_textures;
    uint32_t taken = sr_pbrt_names_find(names, name);
    if (taken) {
        struct sr_location other = SR_PBRT_AT(p->d->textures, struct sr_pbrt_texture, taken - 1)->entity.where;
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "Texture \"%s\": the name is taken, by %s:%d",
                            name, other.file, other.line);
    }
    struct sr_pbrt_texture *texture = sr_array_push(&p->d->textures, sizeof *texture);
    if (!texture || !sr_pbrt_names_add(names, name, (uint32_t)p->d->textures.count))
        return no_memory(p);
    texture->is_float = is_float;
    warn_of_motion(p);
    status = sr_pbrt_read_entity(p, "the name of a kind of texture", p->state.attributes[SR_PBRT_OF_TEXTURE],
                                 &texture->entity);
    texture->entity.name = name;
    return status;
}

static sr_status read_light(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_light *light = sr_array_push(&p->d->lights, sizeof *light);
    if (!light)
        return no_memory(p);
    warn_of_motion(p);
    light->outside = p->state.outside;
    light->medium_where = p->state.medium_where;
    return sr_pbrt_read_entity(p, "the name of a kind of light", p->state.attributes[SR_PBRT_OF_LIGHT], &light->entity);
}

static sr_status read_area_light(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_entity *light = sr_array_push(&p->d->area_lights, sizeof *light);
    if (!light)
        return no_memory(p);
    p->state.area_light1 = (uint32_t)p->d->area_lights.count;
    return sr_pbrt_read_entity(p, "the name of a kind of area light", p->state.attributes[SR_PBRT_OF_LIGHT], light);
}

static sr_status read_shape(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_shape *shape = sr_array_push(&p->d->shapes, sizeof *shape);
    if (!shape)
        return no_memory(p);
    const struct sr_pbrt_state *s = &p->state;
    *shape = (struct sr_pbrt_shape){.material = s->material,
                                    .area_light1 = s->area_light1,
                                    .object1 = p->object1,
                                    .reverse_orientation = s->reverse_orientation,
                                    .inside = s->inside,
                                    .outside = s->outside,
                                    .medium_where = s->medium_where,
                                    .name = p->shape_name};
    p->shape_name = NULL;
    return sr_pbrt_read_entity(p, "the name of a kind of shape", s->attributes[SR_PBRT_OF_SHAPE], &shape->entity);
}

/* ---- objects ---- */

static sr_status read_object_begin(struct sr_pbrt_parser *p)
{
    const char *name;
    sr_status status = sr_pbrt_read_string(p, "a name for the object", &name);
    if (status == SR_OK && p->object1)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "ObjectBegin \"%s\" inside of another object: expected ObjectEnd before it", name);
    if (status == SR_OK && sr_pbrt_names_find(&p->d->object_names, name))
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "ObjectBegin \"%s\": the name is taken", name);
    struct sr_pbrt_object *object = status == SR_OK ? sr_array_push(&p->d->objects, sizeof *object) : NULL;
    if (!object)
        return status != SR_OK ? status : no_memory(p);
    *object = (struct sr_pbrt_object){.name = name, .where = p->where};
    p->object1 = (uint32_t)p->d->objects.count;
    if (!sr_pbrt_names_add(&p->d->object_names, name, p->object1))
        return no_memory(p);
    return push(p, true);
}

static sr_status read_object_end(struct sr_pbrt_parser *p)
{
    sr_status status = pop(p, true);
    p->object1 = 0;
    return status;
}

static sr_status read_object_instance(struct sr_pbrt_parser *p)
{
    const char *name;
    sr_status status = sr_pbrt_read_string(p, "the name of an object", &name);
    if (status != SR_OK)
        return status;
    if (p->object1)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "ObjectInstance \"%s\" inside of an object: expected outside", name);
    uint32_t transform = sr_pbrt_store_transform(p);
    struct sr_pbrt_instance *instance =
        transform == UINT32_MAX ? NULL : sr_array_push(&p->d->instances, sizeof *instance);
    if (!instance)
        return no_memory(p);
    *instance = (struct sr_pbrt_instance){name, p->where, transform};
    return SR_OK;
}

/* ---- files ---- */

static sr_status read_include(struct sr_pbrt_parser *p)
{
    const char *name;
    sr_status status = sr_pbrt_read_string(p, "the name of a file", &name);
    return status == SR_OK ? sr_pbrt_include(p, name) : status;
}

/* As Include, but what the file does to the graphics state ends with it. */
static sr_status read_import(struct sr_pbrt_parser *p)
{
    const char *name;
    struct sr_location where = p->where;
    sr_status status = sr_pbrt_read_string(p, "the name of a file", &name);
    if (status == SR_OK && p->object1)
        return sr_pbrt_fail(p->d, where, p->error, SR_ERROR_INPUT,
                            "Import \"%s\" inside of an object: expected outside", name);
    struct sr_pbrt_state state = p->state;
    size_t depth = p->stack.count;
    if (status == SR_OK)
        status = sr_pbrt_include(p, name);
    if (status == SR_OK && p->stack.count != depth)
        return sr_pbrt_fail(p->d, where, p->error, SR_ERROR_INPUT,
                            "Import \"%s\": expected as many AttributeEnd as AttributeBegin in the file", name);
    p->state = state;
    return status;
}

const struct sr_pbrt_directive sr_pbrt_directives[] = {
    {"Shape", SR_PBRT_IN_WORLD, read_shape},
    {"AttributeBegin", SR_PBRT_IN_WORLD, read_attribute_begin},
    {"AttributeEnd", SR_PBRT_IN_WORLD, read_attribute_end},
    {"NamedMaterial", SR_PBRT_IN_WORLD, read_named_material},
    {"Material", SR_PBRT_IN_WORLD, read_material},
    {"MakeNamedMaterial", SR_PBRT_IN_WORLD, read_make_named_material},
    {"Texture", SR_PBRT_IN_WORLD, read_texture},
    {"Transform", SR_PBRT_ANYWHERE, sr_pbrt_read_transform},
    {"ConcatTransform", SR_PBRT_ANYWHERE, sr_pbrt_read_concat_transform},
    {"Translate", SR_PBRT_ANYWHERE, sr_pbrt_read_translate},
    {"Scale", SR_PBRT_ANYWHERE, sr_pbrt_read_scale},
    {"Rotate", SR_PBRT_ANYWHERE, sr_pbrt_read_rotate},
    {"LookAt", SR_PBRT_ANYWHERE, sr_pbrt_read_look_at},
    {"Identity", SR_PBRT_ANYWHERE, sr_pbrt_read_identity},
    {"CoordinateSystem", SR_PBRT_ANYWHERE, sr_pbrt_read_coordinate_system},
    {"CoordSysTransform", SR_PBRT_ANYWHERE, sr_pbrt_read_coord_sys_transform},
    {"ActiveTransform", SR_PBRT_ANYWHERE, sr_pbrt_read_active_transform},
    {"TransformTimes", SR_PBRT_IN_OPTIONS, sr_pbrt_read_transform_times},
    {"TransformBegin", SR_PBRT_IN_WORLD, read_transform_begin},
    {"TransformEnd", SR_PBRT_IN_WORLD, read_attribute_end},
    {"ReverseOrientation", SR_PBRT_IN_WORLD, read_reverse_orientation},
    {"Attribute", SR_PBRT_ANYWHERE, read_attribute},
    {"ColorSpace", SR_PBRT_ANYWHERE, read_colour_space},
    {"AreaLightSource", SR_PBRT_IN_WORLD, read_area_light},
    {"LightSource", SR_PBRT_IN_WORLD, read_light},
    {"MediumInterface", SR_PBRT_ANYWHERE, read_medium_interface},
    {"MakeNamedMedium", SR_PBRT_ANYWHERE, read_make_named_medium},
    {"ObjectBegin", SR_PBRT_IN_WORLD, read_object_begin},
    {"ObjectEnd", SR_PBRT_IN_WORLD, read_object_end},
    {"ObjectInstance", SR_PBRT_IN_WORLD, read_object_instance},
    {"Include", SR_PBRT_ANYWHERE, read_include},
    {"Import", SR_PBRT_IN_WORLD, read_import},
    {"Camera", SR_PBRT_IN_OPTIONS, read_camera},
    {"Film", SR_PBRT_IN_OPTIONS, read_film},
    {"Sampler", SR_PBRT_IN_OPTIONS, read_sampler},
    {"PixelFilter", SR_PBRT_IN_OPTIONS, read_filter},
    {"Integrator", SR_PBRT_IN_OPTIONS, read_integrator},
    {"Accelerator", SR_PBRT_IN_OPTIONS, read_accelerator},
    {"Option", SR_PBRT_IN_OPTIONS, read_option},
    {"WorldBegin", SR_PBRT_IN_OPTIONS, read_world_begin},
    {"WorldEnd", SR_PBRT_IN_WORLD, read_world_end},
    {NULL, 0, NULL},
};

/* ---- comments that are meant for this program ---- */

static sr_status read_meter(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_entity *meter = sr_array_push(&p->d->meters, sizeof *meter);
    if (!meter)
        return no_memory(p);
    if (p->object1)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "Meter inside of an object: expected outside");
    return sr_pbrt_read_entity(p, "the name of a kind of meter", no_defaults, meter);
}

/* The name of the next shape, by which a meter finds it. */
static sr_status read_name(struct sr_pbrt_parser *p)
{
    sr_status status = sr_pbrt_read_string(p, "a name for the next shape", &p->shape_name);
    p->shape_name_where = p->where;
    return status;
}

static sr_status read_uncertainty(struct sr_pbrt_parser *p)
{
    struct sr_pbrt_entity *declared = sr_array_push(&p->d->uncertainties, sizeof *declared);
    return declared ? sr_pbrt_read_entity(p, "a name for what is uncertain", no_defaults, declared) : no_memory(p);
}

const struct sr_pbrt_directive sr_pbrt_annotations[] = {
    {"Uncertainty", SR_PBRT_ANYWHERE, read_uncertainty},
    {"Option", SR_PBRT_IN_OPTIONS, read_option},
    {"Meter", SR_PBRT_IN_WORLD, read_meter},
    {"Name", SR_PBRT_IN_WORLD, read_name},
    {"LightSource", SR_PBRT_IN_WORLD, read_light}, // of kinds that pbrt does not know
    {"Camera", SR_PBRT_IN_OPTIONS, read_camera},   // the last one counts
    {NULL, 0, NULL},
};
