/* SPDX-License-Identifier: MIT */
/* A material of layers that pbrt does not know, as a coated matte body, glass or metal that it knows.
 *
 * Where it is metal in part, or a texture says where, a mix of two. Roughness r means slopes of width alpha = r^2 in
 * all of these models; pbrt is told alpha itself ("remaproughness" false), of a texture its square. Coats, sheen and
 * tints are left out. */
#include "import/pbrt/closest.h"

#include "import/pbrt/statement.h"

#include <stdio.h>
#include <string.h>

static const struct family {
    const char *model, *colour, *metal, *rough, *clear, *eta;
    float initial_colour, initial_rough; // [1]
} families[] = {
    {"openpbr", "base_color", "base_metalness", "specular_roughness", "transmission_weight", "specular_ior", 0.8f,
     0.3f},
    {"principled", "reflectance", "metallic", "roughness", "specular_transmission", "eta", 0.5f, 0.5f},
    {"disney", "reflectance", "metallic", "roughness", "", "", 0.5f, 0.5f},
};
static const char *const known[] = {
    "diffuse", "coateddiffuse", "coatedconductor", "conductor", "dielectric", "thindielectric", "diffusetransmission",
    "hair",    "measured",      "subsurface",      "mix",       "interface",  "none",           ""};

struct change {
    struct sr_pbrt_description *d;
    struct sr_print *out;
    struct sr_error *error;
    const struct sr_pbrt_entity *from;
    const struct family *family;
};

/* the next free row of a list that has room */
static struct sr_pbrt_param *add(struct sr_pbrt_params *to, const struct sr_pbrt_param *p, const char *name)
{
    struct sr_pbrt_param *row = &to->items[to->count++];
    if (p)
        *row = *p;
    row->name = name;
    return row;
}

static void *keep(struct change *c, const void *data, size_t size)
{
    void *copy = sr_pbrt_words(c->d, size);
    if (copy)
        memcpy(copy, data, size);
    else
        sr_fail(c->error, SR_ERROR_RESOURCE, "not enough memory for the materials");
    return copy;
}

static void add_float(struct change *c, struct sr_pbrt_params *to, const char *name, float value)
{
    *add(to, NULL, name) = (struct sr_pbrt_param){
        .type = SR_PBRT_FLOAT, .name = name, .count = 1, .floats = keep(c, &value, sizeof value)};
}

static void add_word(struct change *c, struct sr_pbrt_params *to, enum sr_pbrt_type type, const char *name,
                     const char *word)
{
    *add(to, NULL, name) =
        (struct sr_pbrt_param){.type = type, .name = name, .count = 1, .strings = keep(c, &word, sizeof word)};
}

static void print(struct change *c, const char *word, const char *a, const char *b, const char *kind,
                  struct sr_pbrt_params params)
{
    struct sr_pbrt_statement s = {
        .word = word, .strings = {a, b, kind}, .string_count = 1u + (b != NULL) + (kind != NULL), .params = params};
    if (c->error->status == SR_OK)
        sr_pbrt_statement_print(c->out, &s);
}

static const char *named(struct change *c, const char *tail)
{
    char text[512];
    snprintf(text, sizeof text, "%s, %s", c->from->name ? c->from->name : "material", tail);
    const char *word = sr_pbrt_text(c->d, text, strlen(text));
    return word ? word : (sr_fail(c->error, SR_ERROR_RESOURCE, "not enough memory for the materials"), "");
}

static struct sr_pbrt_params room(struct change *c)
{
    struct sr_pbrt_params p = {sr_pbrt_words(c->d, 16 * sizeof(struct sr_pbrt_param)), 0};
    if (!p.items)
        sr_fail(c->error, SR_ERROR_RESOURCE, "not enough memory for the materials");
    return p;
}

static void add_roughness(struct change *c, struct sr_pbrt_params *to)
{
    const struct sr_pbrt_param *r = sr_pbrt_peek(&c->from->params, c->family->rough);
    if (r && r->type == SR_PBRT_TEXTURE) {
        const char *squared = named(c, "roughness squared");
        struct sr_pbrt_params params = room(c);
        if (c->error->status != SR_OK)
            return;
        add(&params, r, "tex");
        add(&params, r, "scale");
        if (!sr_pbrt_names_find(&c->d->material_names, squared)) // once for both parts of a mix
            print(c, "Texture", squared, "float", "scale", params);
        sr_pbrt_names_add(&c->d->material_names, squared, 1);
        add_word(c, to, SR_PBRT_TEXTURE, "roughness", squared);
    } else {
        float value = r && r->floats ? r->floats[0] : c->family->initial_rough;
        add_float(c, to, "roughness", value * value);
    }
    *add(to, NULL, "remaproughness") = (struct sr_pbrt_param){
        .type = SR_PBRT_BOOL, .name = "remaproughness", .count = 1, .ints = keep(c, &(int32_t){0}, sizeof(int32_t))};
}

static const char *add_part(struct change *c, bool is_metal, bool is_clear, struct sr_pbrt_params *to)
{
    static const char *const both[] = {"displacement", "normalmap"};
    const struct sr_pbrt_param *colour = sr_pbrt_peek(&c->from->params, c->family->colour),
                               *eta = sr_pbrt_peek(&c->from->params, c->family->eta);
    for (int i = 0; i < 2; ++i)
        if (sr_pbrt_peek(&c->from->params, both[i]))
            add(to, sr_pbrt_peek(&c->from->params, both[i]), both[i]);
    if (!is_clear && colour)
        add(to, colour, "reflectance");
    else if (!is_clear) {
        float grey[3] = {c->family->initial_colour, c->family->initial_colour, c->family->initial_colour};
        *add(to, NULL, "reflectance") = (struct sr_pbrt_param){
            .type = SR_PBRT_RGB, .name = "reflectance", .count = 3, .floats = keep(c, grey, sizeof grey)};
    }
    if (!is_metal && eta && eta->type == SR_PBRT_FLOAT)
        add(to, eta, "eta");
    add_roughness(c, to);
    return is_metal ? "conductor" : is_clear ? "dielectric" : "coateddiffuse";
}

static void tell_losses(struct change *c)
{
    const struct family *f = c->family;
    const char *kept[] = {f->colour, f->metal, f->rough, f->clear, f->eta, "displacement", "normalmap"};
    char list[256] = "";
    for (uint32_t i = 0; i < c->from->params.count; ++i) {
        const char *name = c->from->params.items[i].name;
        bool is_kept = false;
        for (size_t k = 0; k < sizeof kept / sizeof *kept; ++k)
            is_kept = is_kept || strcmp(name, kept[k]) == 0;
        if (!is_kept && strlen(list) + strlen(name) + 3 < sizeof list) {
            strcat(list, list[0] ? ", " : "");
            strcat(list, name);
        }
    }
    if (list[0])
        sr_pbrt_warn(c->d, c->from->where, "material \"%s\": pbrt has no %s; left out: %s",
                     c->from->name ? c->from->name : "", f->model, list);
}

/* The share of something that is no texture; a texture counts as half. */
static float share(const struct sr_pbrt_entity *e, const char *name)
{
    const struct sr_pbrt_param *p = sr_pbrt_peek(&e->params, name);
    return !p ? 0 : p->type == SR_PBRT_TEXTURE || !p->floats ? 0.5f : p->floats[0];
}

static void change(struct change *c, struct sr_pbrt_entity *e)
{
    float metal = share(e, c->family->metal), clear = share(e, c->family->clear);
    struct sr_pbrt_params params = room(c);
    if (c->error->status != SR_OK)
        return;
    tell_losses(c);
    if (metal <= 0 || metal >= 1) {
        e->model = add_part(c, metal >= 1, metal <= 0 && clear > 0.5f, &params);
        e->params = params;
        return;
    }
    const char *names[2] = {named(c, "body"), named(c, "metal")};
    for (int i = 0; i < 2; ++i) { // the second by the amount
        struct sr_pbrt_params part = room(c);
        if (c->error->status != SR_OK)
            return;
        add_word(c, &part, SR_PBRT_STRING_TYPE, "type", "");
        const char *model = add_part(c, i == 1, i == 0 && clear > 0.5f, &part);
        part.items[0].strings = keep(c, &model, sizeof model);
        print(c, "MakeNamedMaterial", names[i], NULL, NULL, part);
    }
    *add(&params, NULL, "materials") = (struct sr_pbrt_param){
        .type = SR_PBRT_STRING_TYPE, .name = "materials", .count = 2, .strings = keep(c, names, sizeof names)};
    add(&params, sr_pbrt_peek(&e->params, c->family->metal), "amount");
    e->model = "mix";
    e->params = params;
}

sr_status sr_pbrt_closest_material(struct sr_pbrt_description *d, struct sr_pbrt_entity *e, struct sr_print *out,
                                   struct sr_error *error)
{
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (strcmp(e->model, known[i]) == 0)
            return SR_OK;
    struct sr_pbrt_entity from = *e;
    struct change c = {.d = d, .out = out, .error = error, .from = &from};
    for (size_t i = 0; i < sizeof families / sizeof *families; ++i)
        if (strcmp(e->model, families[i].model) == 0)
            c.family = &families[i];
    if (c.family)
        change(&c, e);
    else {
        sr_pbrt_warn(d, e->where, "material \"%s\": pbrt has no %s: diffuse instead", e->name ? e->name : "", e->model);
        struct sr_pbrt_params params = room(&c);
        const struct sr_pbrt_param *colour = sr_pbrt_peek(&e->params, "reflectance");
        if (params.items && colour)
            add(&params, colour, "reflectance");
        e->model = "diffuse";
        e->params = params;
    }
    return error->status;
}
