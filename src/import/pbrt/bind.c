/* SPDX-License-Identifier: MIT */
/* Parameters of the file into the struct of a model, row by row of its table. */
#include "import/pbrt/build.h"

#include <stdio.h>
#include <string.h>

sr_status sr_pbrt_no_memory(struct sr_pbrt_build *b)
{
    return sr_fail(b->error, SR_ERROR_RESOURCE, "%s: not enough memory for the scene", b->main_path);
}

sr_status sr_pbrt_wrap(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_error *inner)
{
    return sr_pbrt_fail(b->d, e->where, b->error, inner->status, "%s \"%s\": %s", e->directive,
                        e->name ? e->name : e->model, inner->text);
}

sr_status sr_pbrt_unsupported(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const char *const *names,
                              size_t count)
{
    char list[512];
    size_t n = 0;
    list[0] = 0;
    for (size_t i = 0; i < count && n < sizeof list; ++i)
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", names[i]);
    return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT, "%s \"%s\" is not supported yet; supported: %s",
                        e->directive, e->model, list);
}

/* ---- messages about one parameter ---- */

static sr_status wrong_type(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                            const char *expected)
{
    return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                        "\"%s %s\" of %s \"%s\" has the wrong type: expected %s", sr_pbrt_type_name(p->type), p->name,
                        e->directive, e->model, expected);
}

static sr_status wrong_count(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                             uint32_t expected)
{
    return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT, "\"%s %s\" of %s \"%s\" has %u values: expected %u",
                        sr_pbrt_type_name(p->type), p->name, e->directive, e->model, p->count, expected);
}

static sr_status check_range(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                             const struct sr_param *row, double value)
{
    if (value >= row->min && value <= row->max)
        return SR_OK;
    const char *unit = row->unit && strcmp(row->unit, "1") != 0 ? row->unit : "";
    if (isinf(row->max))
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"%s %s\" of %s \"%s\" is %g: expected %g or more%s%s", sr_pbrt_type_name(p->type),
                            p->name, e->directive, e->model, value, row->min, *unit ? " " : "", unit);
    return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT, "\"%s %s\" of %s \"%s\" is %g: expected %g to %g%s%s",
                        sr_pbrt_type_name(p->type), p->name, e->directive, e->model, value, row->min, row->max,
                        *unit ? " " : "", unit);
}

/* ---- kinds ---- */

static bool is_vector3(enum sr_pbrt_type t)
{
    return t == SR_PBRT_POINT3 || t == SR_PBRT_VECTOR3 || t == SR_PBRT_NORMAL;
}

static sr_status one_number(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                            const struct sr_param *row, double *value)
{
    if (p->type != SR_PBRT_FLOAT && p->type != SR_PBRT_INTEGER)
        return wrong_type(b, e, p, "float");
    if (p->count != 1)
        return wrong_count(b, e, p, 1);
    *value = p->type == SR_PBRT_FLOAT ? (double)p->floats[0] : p->ints[0];
    return check_range(b, e, p, row, *value);
}

/* index of word in "a|b|c", or -1 */
static int find_choice(const char *choices, const char *word)
{
    int index = 0;
    for (const char *c = choices; *c; ++index) {
        size_t n = strcspn(c, "|");
        if (strlen(word) == n && strncmp(c, word, n) == 0)
            return index;
        c += n + (c[n] == '|');
    }
    return -1;
}

static sr_status bind_text(struct sr_pbrt_build *b, const struct sr_param *row, const struct sr_pbrt_entity *e,
                           const struct sr_pbrt_param *p, void *member)
{
    if (p->type != SR_PBRT_STRING_TYPE)
        return wrong_type(b, e, p, "string");
    if (p->count != 1)
        return wrong_count(b, e, p, 1);
    if (row->kind == SR_PARAM_ENUM) {
        int index = find_choice(row->text, p->strings[0]);
        if (index < 0)
            return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                                "\"string %s\" of %s \"%s\" is \"%s\": expected %s", p->name, e->directive, e->model,
                                p->strings[0], row->text);
        *(int32_t *)member = index;
        return SR_OK;
    }
    const char *text = row->kind == SR_PARAM_FILE ? sr_pbrt_resolve(b, b->arena, p->strings[0], p->where)
                                                  : sr_arena_string(b->arena, p->strings[0]);
    *(const char **)member = text;
    if (text && row->kind == SR_PARAM_FILE)
        sr_pbrt_hash_file(b, text);
    return text ? SR_OK : sr_pbrt_no_memory(b);
}

static sr_status bind_tuple(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                            uint32_t arity, void *member)
{
    bool is_2d = p->type == SR_PBRT_POINT2 || p->type == SR_PBRT_VECTOR2 || p->type == SR_PBRT_FLOAT;
    if (arity == 2 ? !is_2d : !is_vector3(p->type))
        return wrong_type(b, e, p, arity == 2 ? "point2" : "point3, vector3 or normal");
    if (p->count != arity)
        return wrong_count(b, e, p, arity);
    memcpy(member, p->floats, arity * sizeof(float));
    return SR_OK;
}

/* The description's values end with it, so that what stays is copied to the scene. */
static sr_status bind_run(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                          const struct sr_param *row, void *member)
{
    if (row->kind == SR_PARAM_RGBS ? p->type != SR_PBRT_RGB : p->type == SR_PBRT_RGB)
        return wrong_type(b, e, p, row->kind == SR_PARAM_RGBS ? "rgb" : "numbers");
    uint32_t arity = row->kind == SR_PARAM_INTS || row->kind == SR_PARAM_FLOATS ? 1
                     : row->kind == SR_PARAM_POINT2S                            ? 2
                                                                                : 3;
    if (row->kind == SR_PARAM_INTS ? p->type != SR_PBRT_INTEGER : !p->floats)
        return wrong_type(b, e, p,
                          row->kind == SR_PARAM_INTS ? "integer"
                          : arity == 1               ? "float"
                          : arity == 2               ? "point2"
                                                     : "point3, vector3 or normal");
    if (arity == 3 && row->kind != SR_PARAM_RGBS && !is_vector3(p->type))
        return wrong_type(b, e, p, "point3, vector3 or normal");
    if (arity == 2 && p->type != SR_PBRT_POINT2 && p->type != SR_PBRT_VECTOR2 && p->type != SR_PBRT_FLOAT)
        return wrong_type(b, e, p, "point2");
    if (p->count % arity != 0)
        return sr_pbrt_fail(b->d, p->where, b->error, SR_ERROR_INPUT,
                            "\"%s %s\" has %u values: expected a multiple of %u", sr_pbrt_type_name(p->type), p->name,
                            p->count, arity);
    size_t size = p->count * sizeof(float);
    const void *data = p->ints ? (const void *)p->ints : p->floats;
    if (!b->is_borrowing) {
        void *copy = sr_arena_alloc(b->arena, size + 16);
        if (!copy)
            return sr_pbrt_no_memory(b);
        memcpy(copy, data, size);
        data = copy;
    }
    *(struct sr_slice *)member = (struct sr_slice){data, p->count / arity};
    return SR_OK;
}

static enum sr_param_kind spectrum_kind(enum sr_param_kind row, struct sr_pbrt_use use)
{
    if (use.is_child && (row == SR_PARAM_ALBEDO || row == SR_PARAM_ALBEDO_TEXTURE))
        return use.parent;
    return row == SR_PARAM_ALBEDO_TEXTURE      ? SR_PARAM_ALBEDO
           : row == SR_PARAM_UNBOUNDED_TEXTURE ? SR_PARAM_UNBOUNDED
                                               : row;
}

static sr_status check_spectrum(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                                const struct sr_param *row, const struct sr_spd *s)
{
    double largest = sr_spd_max(s);
    return largest > row->max * (1 + 1e-5) ? check_range(b, e, p, row, largest) : SR_OK;
}

static sr_status bind_spectrum(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                               const struct sr_param *row, enum sr_param_kind kind, struct sr_spd *s)
{
    sr_status status = sr_pbrt_spectrum(b, e, p, kind, s);
    return status == SR_OK ? check_spectrum(b, e, p, row, s) : status;
}

static sr_status bind_texture(struct sr_pbrt_build *b, const struct sr_param *row, const struct sr_pbrt_entity *e,
                              const struct sr_pbrt_param *p, struct sr_pbrt_use use, struct sr_texture *member)
{
    bool is_float = row->kind == SR_PARAM_FLOAT_TEXTURE;
    enum sr_param_kind kind = spectrum_kind(row->kind, use);
    if (p->type == SR_PBRT_TEXTURE)
        return p->count != 1 ? wrong_count(b, e, p, 1) : sr_pbrt_named_texture(b, p, is_float, kind, member);
    sr_status status;
    if (is_float) {
        double value;
        if (p->type != SR_PBRT_FLOAT && p->type != SR_PBRT_INTEGER)
            return wrong_type(b, e, p, "float or texture");
        if ((status = one_number(b, e, p, row, &value)) != SR_OK)
            return status;
        *member = sr_texture_constant_float(b->arena, (float)value);
    } else {
        struct sr_spd s;
        if ((status = bind_spectrum(b, e, p, row, kind, &s)) != SR_OK)
            return status;
        *member = sr_texture_constant_spectrum(b->arena, s);
    }
    return member->model ? SR_OK : sr_pbrt_no_memory(b);
}

static sr_status bind_value(struct sr_pbrt_build *b, const struct sr_param *row, const struct sr_pbrt_entity *e,
                            struct sr_pbrt_param *p, struct sr_pbrt_use use, void *member)
{
    double number;
    sr_status status;
    switch (row->kind) {
    case SR_PARAM_BOOL:
        if (p->type != SR_PBRT_BOOL)
            return wrong_type(b, e, p, "bool");
        if (p->count != 1)
            return wrong_count(b, e, p, 1);
        *(bool *)member = p->ints[0] != 0;
        return SR_OK;
    case SR_PARAM_INT:
        if (p->type != SR_PBRT_INTEGER)
            return wrong_type(b, e, p, "integer");
        if ((status = one_number(b, e, p, row, &number)) == SR_OK)
            *(int32_t *)member = (int32_t)number;
        return status;
    case SR_PARAM_FLOAT:
        if ((status = one_number(b, e, p, row, &number)) == SR_OK)
            *(float *)member = (float)number;
        return status;
    case SR_PARAM_ENUM:
    case SR_PARAM_STRING:
    case SR_PARAM_FILE:
        return bind_text(b, row, e, p, member);
    case SR_PARAM_POINT2:
        return bind_tuple(b, e, p, 2, member);
    case SR_PARAM_POINT3:
    case SR_PARAM_VECTOR3:
    case SR_PARAM_NORMAL3:
        return bind_tuple(b, e, p, 3, member);
    case SR_PARAM_ALBEDO:
    case SR_PARAM_UNBOUNDED:
    case SR_PARAM_ILLUMINANT:
        return bind_spectrum(b, e, p, row, spectrum_kind(row->kind, use), member);
    case SR_PARAM_FLOAT_TEXTURE:
    case SR_PARAM_ALBEDO_TEXTURE:
    case SR_PARAM_UNBOUNDED_TEXTURE:
        return bind_texture(b, row, e, p, use, member);
    case SR_PARAM_MATERIALS:
        if (p->type != SR_PBRT_STRING_TYPE)
            return wrong_type(b, e, p, "string");
        return sr_pbrt_materials(b, p, member);
    case SR_PARAM_INTS:
    case SR_PARAM_FLOATS:
    case SR_PARAM_POINT2S:
    case SR_PARAM_POINT3S:
    case SR_PARAM_VECTOR3S:
    case SR_PARAM_NORMAL3S:
    case SR_PARAM_RGBS:
        return bind_run(b, e, p, row, member);
    }
    return SR_OK;
}

static sr_status bind_default(struct sr_pbrt_build *b, const struct sr_param *row, const struct sr_pbrt_entity *e,
                              struct sr_pbrt_use use, void *member)
{
    float v = (float)row->initial;
    bool is_none = isnan(row->initial);
    struct sr_texture *texture = member;
    switch (row->kind) {
    case SR_PARAM_BOOL:
        *(bool *)member = row->initial != 0 && !is_none;
        break;
    case SR_PARAM_INT:
    case SR_PARAM_ENUM:
        *(int32_t *)member = is_none ? 0 : (int32_t)row->initial;
        break;
    case SR_PARAM_FLOAT:
        *(float *)member = v;
        break;
    case SR_PARAM_STRING:
        *(const char **)member = is_none ? NULL : row->text;
        break;
    case SR_PARAM_POINT2:
        *(sr_vec2 *)member = (sr_vec2){v, v};
        break;
    case SR_PARAM_POINT3:
    case SR_PARAM_VECTOR3:
    case SR_PARAM_NORMAL3:
        *(sr_vec3 *)member = (sr_vec3){v, v, v};
        break;
    case SR_PARAM_ILLUMINANT: // that of the colour space, unless an image takes its place
        if (!is_none && !sr_pbrt_find(&e->params, "filename"))
            *(struct sr_spd *)member = sr_spd_from_rgb_illuminant(e->space, (struct sr_rgb){v, v, v});
        break;
    case SR_PARAM_ALBEDO:
    case SR_PARAM_UNBOUNDED:
        if (!is_none)
            *(struct sr_spd *)member = use.is_child && use.parent == SR_PARAM_ILLUMINANT
                                           ? sr_spd_from_rgb_illuminant(e->space, (struct sr_rgb){v, v, v})
                                           : sr_spd_constant(v);
        break;
    case SR_PARAM_FLOAT_TEXTURE:
        if (!is_none)
            *texture = sr_texture_constant_float(b->arena, v);
        return is_none || texture->model ? SR_OK : sr_pbrt_no_memory(b);
    case SR_PARAM_ALBEDO_TEXTURE:
    case SR_PARAM_UNBOUNDED_TEXTURE:
        if (!is_none)
            *texture = sr_texture_constant_spectrum(b->arena,
                                                    use.is_child && use.parent == SR_PARAM_ILLUMINANT
                                                        ? sr_spd_from_rgb_illuminant(e->space, (struct sr_rgb){v, v, v})
                                                        : sr_spd_constant(v));
        return is_none || texture->model ? SR_OK : sr_pbrt_no_memory(b);
    default: // files and runs: nothing
        break;
    }
    return SR_OK;
}

sr_status sr_pbrt_bind(struct sr_pbrt_build *b, const struct sr_param *table, const struct sr_pbrt_entity *e,
                       struct sr_pbrt_use use, void *self)
{
    for (const struct sr_param *row = table; row && row->name; ++row) {
        void *member = (char *)self + row->offset;
        struct sr_pbrt_param *p = sr_pbrt_find(&e->params, row->name);
        sr_status status = p ? bind_value(b, row, e, p, use, member) : bind_default(b, row, e, use, member);
        if (status != SR_OK)
            return status;
    }
    return SR_OK;
}

void sr_pbrt_warn_unused(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_param *table,
                         const struct sr_param *more)
{
    for (uint32_t i = 0; i < e->params.count; ++i) {
        const struct sr_pbrt_param *p = &e->params.items[i];
        if (p->used || p->is_default)
            continue;
        struct sr_pbrt_suggestion s = {.word = p->name};
        char buffer[160];
        for (const struct sr_param *row = table; row && row->name; ++row)
            sr_pbrt_suggest(&s, row->name);
        for (const struct sr_param *row = more; row && row->name; ++row)
            sr_pbrt_suggest(&s, row->name);
        sr_pbrt_warn(b->d, p->where, "unused parameter \"%s %s\" of %s \"%s\"%s", sr_pbrt_type_name(p->type), p->name,
                     e->directive, e->model, sr_pbrt_suggestion_text(&s, buffer));
    }
}
