/* SPDX-License-Identifier: MIT */
/* Declared uncertainties: numbers of the scene that are known to so much (type B of the GUM), and scenes with one of
 * them shifted.
 *
 *     #@ Uncertainty "wall" "string material" "wall" "string parameter" "reflectance" "float u" 0.001
 *
 * The shift is added to every number of a float, rgb or blackbody, and to the values of a spectrum given as pairs. */
#include "import/pbrt/build.h"

#include <stdlib.h>
#include <string.h>

struct declared {
    const char *material;           // of a MakeNamedMaterial, or "#2": the second Material
    const char *light, *area_light; // "#2": the second
    const char *parameter;
    float u, a;
    bool relative;
};

static const struct sr_param table[] = {
    {SR_PARAM_STRING, "material", "1", 0, 0, 0, offsetof(struct declared, material), NULL},
    {SR_PARAM_STRING, "light", "1", 0, 0, 0, offsetof(struct declared, light), NULL},
    {SR_PARAM_STRING, "arealight", "1", 0, 0, 0, offsetof(struct declared, area_light), NULL},
    {SR_PARAM_STRING, "parameter", "1", 0, 0, 0, offsetof(struct declared, parameter), NULL},
    {SR_PARAM_FLOAT, "u", "1", 0, INFINITY, NAN, offsetof(struct declared, u),
     "standard uncertainty, in the parameter's unit"},
    {SR_PARAM_FLOAT, "a", "1", 0, INFINITY, NAN, offsetof(struct declared, a),
     "instead of u: half the width of a rectangular distribution"},
    {SR_PARAM_BOOL, "relative", "1", 0, 1, 0, offsetof(struct declared, relative), "u and a are shares of the value"},
    {.name = NULL},
};
const struct sr_param *const sr_pbrt_uncertainty_params = table;

/* The entity that "#2" or a name stands for; first: of the list's members that directives have made. */
static struct sr_pbrt_entity *at_number(const struct sr_array *list, size_t stride, size_t first, const char *word)
{
    char *end = NULL;
    unsigned long number = word[0] == '#' ? strtoul(word + 1, &end, 10) : 0;
    if (!end || *end || number < 1 || number > list->count - first)
        return NULL;
    return (struct sr_pbrt_entity *)(void *)((char *)list->data +
                                             (first + number - 1) * stride); // entities come first in what holds them
}

static struct sr_pbrt_entity *find_entity(struct sr_pbrt_build *b, const struct declared *u)
{
    const struct sr_pbrt_description *d = b->d;
    if (u->light)
        return at_number(&d->lights, sizeof(struct sr_pbrt_light), 0, u->light);
    if (u->area_light)
        return at_number(&d->area_lights, sizeof(struct sr_pbrt_entity), 0, u->area_light);
    uint32_t index1 = sr_pbrt_names_find(&d->material_names, u->material);
    return index1 ? SR_PBRT_AT(d->named_materials, struct sr_pbrt_entity, index1 - 1)
                  : at_number(&d->materials, sizeof(struct sr_pbrt_entity), 1, u->material);
}

static bool has_numbers(const struct sr_pbrt_param *p)
{
    return p->floats && p->count > 0 &&
           (p->type == SR_PBRT_FLOAT || p->type == SR_PBRT_RGB || p->type == SR_PBRT_BLACKBODY ||
            p->type == SR_PBRT_SPECTRUM);
}

static sr_status shift_parameter(struct sr_pbrt_build *b, struct sr_pbrt_param *p, double by)
{
    float *copy = sr_pbrt_words(b->d, p->count * sizeof *copy);
    if (!copy)
        return sr_pbrt_no_memory(b);
    bool has_pairs = p->type == SR_PBRT_SPECTRUM;
    for (uint32_t i = 0; i < p->count; ++i)
        copy[i] = p->floats[i] + (has_pairs && i % 2 == 0 ? 0 : (float)by);
    p->floats = copy;
    return SR_OK;
}

static sr_status read_one(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, uint32_t index,
                          struct sr_declared_uncertainty *out)
{
    struct declared u = {0};
    if (sr_pbrt_bind(b, table, e, (struct sr_pbrt_use){SR_PARAM_ALBEDO, false}, &u) != SR_OK)
        return b->error->status;
    sr_pbrt_warn_unused(b, e, table, NULL);
    if (!u.parameter || (u.material != NULL) + (u.light != NULL) + (u.area_light != NULL) != 1 ||
        isnan(u.u) == isnan(u.a))
        return sr_pbrt_fail(
            b->d, e->where, b->error, SR_ERROR_INPUT,
            "Uncertainty \"%s\": expected one of \"material\", \"light\", \"arealight\"; and \"parameter\"; and one of \"u\", \"a\"",
            e->model);
    struct sr_pbrt_entity *of = find_entity(b, &u);
    if (!of)
        return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT, "Uncertainty \"%s\": there is no %s \"%s\"",
                            e->model,
                            u.material ? "material"
                            : u.light  ? "light"
                                       : "area light",
                            u.material ? u.material
                            : u.light  ? u.light
                                       : u.area_light);
    struct sr_pbrt_param *p = sr_pbrt_peek(&of->params, u.parameter);
    if (!p || !has_numbers(p))
        return sr_pbrt_fail(
            b->d, e->where, b->error, SR_ERROR_INPUT,
            "Uncertainty \"%s\": %s \"%s\" gives no numbers for \"%s\": expected float, rgb, blackbody, or a spectrum of pairs",
            e->model, of->directive, of->name ? of->name : of->model, u.parameter);
    *out = (struct sr_declared_uncertainty){.name = sr_arena_string(b->arena, e->model), .is_rectangular = isnan(u.u)};
    out->value = (double)p->floats[p->type == SR_PBRT_SPECTRUM ? 1 : 0];
    out->u = (isnan(u.u) ? (double)u.a / sqrt(3) : (double)u.u) * (u.relative ? fabs(out->value) : 1);
    if (!out->name)
        return sr_pbrt_no_memory(b);
    return b->options->shifted == index + 1 ? shift_parameter(b, p, b->options->shift * out->u) : SR_OK;
}

sr_status sr_pbrt_uncertainties(struct sr_pbrt_build *b)
{
    size_t n = b->d->uncertainties.count;
    struct sr_declared_uncertainty *all = sr_arena_alloc(b->arena, (n + 1) * sizeof *all);
    if (!all)
        return sr_pbrt_no_memory(b);
    for (uint32_t i = 0; i < n; ++i)
        if (read_one(b, SR_PBRT_AT(b->d->uncertainties, struct sr_pbrt_entity, i), i, &all[i]) != SR_OK)
            return b->error->status;
    b->result->uncertainties = all;
    b->result->uncertainty_count = (uint32_t)n;
    return SR_OK;
}
