/* SPDX-License-Identifier: MIT */
/* pbrt-v3's directives and parameters as pbrt-v4's, one statement at a time; materials are in upgrade_materials.c.
 *
 * Where only the word has changed, so does the word. Where the default has, it is written. Where the meaning has, the
 * number is computed, or a warning tells the place: light that a file gives as a spectrum is scaled to luminance 1 by
 * pbrt-v4, so that
 *
 *     scale_v4 = scale_v3 integral L ybar / integral ybar                                   [1]
 *
 * Renames follow what pbrt's own --upgrade does (Pharr, Jakob & Humphreys, format of pbrt-v4). */
#include "import/pbrt/statement.h"

#include <stdio.h>
#include <string.h>

struct sr_pbrt_renamed {
    const char *kind, *name, *now;
};

/* ---- parameters ---- */

static void no_memory(struct sr_pbrt_upgrade *u)
{
    sr_fail(u->p->error, SR_ERROR_RESOURCE, "%s: not enough memory", u->p->main_path);
}

struct sr_pbrt_param *sr_pbrt_edit_find(struct sr_pbrt_upgrade *u, const char *name)
{
    return sr_pbrt_peek(&u->s->params, name);
}

void sr_pbrt_edit_remove(struct sr_pbrt_upgrade *u, const char *name)
{
    struct sr_pbrt_param *p = sr_pbrt_edit_find(u, name);
    if (p) {
        struct sr_pbrt_param *end = u->s->params.items + u->s->params.count--;
        memmove(p, p + 1, (size_t)(end - p - 1) * sizeof *p);
    }
}

void sr_pbrt_edit_rename(struct sr_pbrt_upgrade *u, const char *name, const char *to)
{
    struct sr_pbrt_param *p = sr_pbrt_edit_find(u, name);
    if (p) {
        if (strcmp(name, to) != 0)
            sr_pbrt_edit_remove(u, to);
        sr_pbrt_edit_find(u, name)->name = to;
    }
}

struct sr_pbrt_param *sr_pbrt_edit_set(struct sr_pbrt_upgrade *u, enum sr_pbrt_type type, const char *name,
                                       const void *values, uint32_t count)
{
    struct sr_pbrt_param *p = sr_pbrt_edit_find(u, name);
    bool has_words = type == SR_PBRT_STRING_TYPE || type == SR_PBRT_TEXTURE;
    size_t size = count * (has_words ? sizeof(char *) : sizeof(float));
    void *copy = sr_pbrt_words(u->p->d, size);
    if (!copy || (!p && u->s->params.count >= u->room)) {
        no_memory(u);
        return NULL;
    }
    if (!p)
        p = &u->s->params.items[u->s->params.count++];
    memcpy(copy, values, size);
    *p = (struct sr_pbrt_param){.type = type, .name = name, .count = count, .where = u->s->where};
    if (has_words)
        p->strings = copy;
    else if (type == SR_PBRT_BOOL || type == SR_PBRT_INTEGER)
        p->ints = copy;
    else
        p->floats = copy;
    return p;
}

void sr_pbrt_edit_float(struct sr_pbrt_upgrade *u, const char *name, float value)
{
    sr_pbrt_edit_set(u, SR_PBRT_FLOAT, name, &value, 1);
}

void sr_pbrt_edit_string(struct sr_pbrt_upgrade *u, enum sr_pbrt_type type, const char *name, const char *value)
{
    sr_pbrt_edit_set(u, type, name, &value, 1);
}

bool sr_pbrt_edit_grey(struct sr_pbrt_upgrade *u, const char *name, float initial, float *value)
{
    const struct sr_pbrt_param *p = sr_pbrt_edit_find(u, name);
    *value = initial;
    if (!p)
        return true;
    if (!p->floats || p->count == 0)
        return false;
    bool has_pairs = p->type == SR_PBRT_SPECTRUM;
    *value = p->floats[has_pairs ? 1 : 0];
    for (uint32_t i = has_pairs ? 3 : 1; i < p->count; i += has_pairs ? 2 : 1)
        if (p->floats[i] != *value)
            return false;
    return p->type == SR_PBRT_FLOAT || p->type == SR_PBRT_RGB || has_pairs;
}

/* Without a word: nothing reads them any more, and they have not changed the picture. */
static void drop(struct sr_pbrt_upgrade *u, const char *const *names)
{
    for (; *names; ++names)
        sr_pbrt_edit_remove(u, *names);
}

static void set_default(struct sr_pbrt_upgrade *u, const char *name, float value)
{
    if (!sr_pbrt_edit_find(u, name))
        sr_pbrt_edit_float(u, name, value);
}

static bool is(const char *a, const char *b)
{
    return strcmp(a, b) == 0;
}

static void warn(struct sr_pbrt_upgrade *u, const char *text)
{
    sr_pbrt_warn(u->p->d, u->s->where, "%s \"%s\": %s", u->s->word, u->s->strings[0] ? u->s->strings[0] : "", text);
}

/* ---- names: pbrt-v3 let a later one take an earlier one's place ---- */

static struct sr_pbrt_renamed *find_name(struct sr_pbrt_upgrade *u, const char *kind, const char *name)
{
    for (size_t i = u->renamed.count; i > 0; --i) {
        struct sr_pbrt_renamed *r = SR_PBRT_AT(u->renamed, struct sr_pbrt_renamed, i - 1);
        if (is(r->kind, kind) && is(r->name, name))
            return r;
    }
    return NULL;
}

static void define(struct sr_pbrt_upgrade *u, const char *kind, const char **name)
{
    struct sr_pbrt_renamed *r = find_name(u, kind, *name);
    if (r) {
        r->now = sr_arena_printf(u->arena, "%s-%d", *name, ++u->count);
        warn(u, "the name was taken already: renamed from here on");
    } else if ((r = sr_array_push(&u->renamed, sizeof *r)))
        *r = (struct sr_pbrt_renamed){kind, sr_arena_string(u->arena, *name), sr_arena_string(u->arena, *name)};
    if (!r || !r->now || !r->name) {
        no_memory(u);
        return;
    }
    *name = r->now;
}

const char *sr_pbrt_upgrade_name(struct sr_pbrt_upgrade *u, const char *kind, const char *name)
{
    const struct sr_pbrt_renamed *r = find_name(u, kind, name);
    return r ? r->now : name;
}

/* Textures of floats and of colours are two lists. */
static void refer_textures(struct sr_pbrt_upgrade *u)
{
    for (uint32_t i = 0; i < u->s->params.count; ++i) {
        struct sr_pbrt_param *p = &u->s->params.items[i];
        if (p->type != SR_PBRT_TEXTURE || p->count != 1)
            continue;
        const char *now = sr_pbrt_upgrade_name(u, "float", p->strings[0]);
        if (is(now, p->strings[0]))
            now = sr_pbrt_upgrade_name(u, "spectrum", p->strings[0]);
        if (!is(now, p->strings[0]))
            sr_pbrt_edit_string(u, SR_PBRT_TEXTURE, p->name, now);
    }
}

/* ---- settings ---- */

static void upgrade_filter(struct sr_pbrt_upgrade *u)
{
    const char *name = u->s->strings[0];
    float alpha = 2, radius = is(name, "box") ? 0.5f : is(name, "sinc") ? 4 : 2;
    u->has_filter = true;
    sr_pbrt_edit_rename(u, "xwidth", "xradius");
    sr_pbrt_edit_rename(u, "ywidth", "yradius");
    set_default(u, "xradius", radius);
    set_default(u, "yradius", radius);
    if (is(name, "gaussian")) {
        sr_pbrt_edit_grey(u, "alpha", 2, &alpha);
        sr_pbrt_edit_remove(u, "alpha");
        sr_pbrt_edit_float(u, "sigma", 1 / sqrtf(2 * (alpha > 0 ? alpha : 2)));
    }
}

static void upgrade_film(struct sr_pbrt_upgrade *u)
{
    float scale;
    if (is(u->s->strings[0], "image"))
        u->s->strings[0] = "rgb";
    sr_pbrt_edit_rename(u, "maxsampleluminance", "maxcomponentvalue");
    if (sr_pbrt_edit_grey(u, "scale", 1, &scale) && scale != 1)
        sr_pbrt_edit_float(u, "iso", 100 * scale);
    sr_pbrt_edit_remove(u, "scale");
}

static void upgrade_sampler(struct sr_pbrt_upgrade *u)
{
    static const char *const gone[] = {"dimensions", "samplepixelcenter", NULL};
    const char **name = &u->s->strings[0];
    if (is(*name, "lowdiscrepancy") || is(*name, "02sequence"))
        *name = "paddedsobol";
    else if (is(*name, "maxmindist"))
        *name = "pmj02bn";
    else if (is(*name, "random"))
        *name = "independent";
    if (sr_pbrt_edit_find(u, "samplepixelcenter"))
        warn(u, "\"samplepixelcenter\" is left out: Option \"disablepixeljitter\" is the word of today");
    drop(u, gone);
}

static void upgrade_integrator(struct sr_pbrt_upgrade *u)
{
    static const char *const gone[] = {"rrthreshold", "imagewritefrequency", "strategy",
                                       "pixelbounds", "lightsamplestrategy", NULL};
    const char **name = &u->s->strings[0];
    const struct sr_pbrt_param *choice = sr_pbrt_edit_find(u, "lightsamplestrategy");
    if (sr_pbrt_edit_find(u, "numiterations") || sr_pbrt_edit_find(u, "iterations"))
        warn(u, "the number of iterations is the Sampler's number of samples now");
    sr_pbrt_edit_remove(u, "numiterations");
    sr_pbrt_edit_remove(u, "iterations");
    if (choice && choice->strings)
        sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "lightsampler",
                            is(choice->strings[0], "spatial") ? "bvh" : choice->strings[0]);
    if (sr_pbrt_edit_find(u, "pixelbounds"))
        warn(u, "\"pixelbounds\" is left out: the Film has it now");
    if (is(*name, "directlighting") || is(*name, "whitted")) {
        warn(u, "\"path\" instead: with direct light alone, mirrors and glass show nothing beyond one reflection");
        *name = "path";
        sr_pbrt_edit_set(u, SR_PBRT_INTEGER, "maxdepth", &(int32_t){1}, 1);
    }
    if (is(*name, "ambientocclusion"))
        sr_pbrt_edit_remove(u, "nsamples");
    drop(u, gone);
}

static void upgrade_camera(struct sr_pbrt_upgrade *u)
{
    float half;
    if (is(u->s->strings[0], "environment")) {
        u->s->strings[0] = "spherical";
        sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "mapping", "equirectangular");
    }
    sr_pbrt_edit_remove(u, "simpleweighting");
    if (sr_pbrt_edit_find(u, "halffov") && sr_pbrt_edit_grey(u, "halffov", 45, &half)) {
        sr_pbrt_edit_remove(u, "halffov");
        sr_pbrt_edit_float(u, "fov", 2 * half);
    }
}

/* ---- light ---- */

/* The scale that keeps what a spectrum meant, luminance 1 being the measure of pbrt-v4. */
static double luminance_of(struct sr_pbrt_upgrade *u, const char *name)
{
    struct sr_pbrt_param *p = sr_pbrt_edit_find(u, name);
    struct sr_arena arena = {0};
    double scale = 1;
    if (p && p->type == SR_PBRT_BLACKBODY && p->count == 2) { // temperature [K], scale; the greatest value was 1
        struct sr_spd s = sr_spd_blackbody(p->floats[0]);
        scale = (double)p->floats[1] * sr_spd_luminous_integral(&s) / (double)sr_spd_max(&s) / SR_CIE_Y_INTEGRAL;
        sr_pbrt_edit_set(u, SR_PBRT_BLACKBODY, name, p->floats, 1);
    } else if (p && p->type == SR_PBRT_SPECTRUM && !p->is_text && p->floats) {
        int count = (int)p->count / 2;
        float *lambda = sr_arena_alloc(&arena, (size_t)count * sizeof *lambda),
              *values = sr_arena_alloc(&arena, (size_t)count * sizeof *values);
        struct sr_error error = {0};
        for (int i = 0; lambda && values && i < count; ++i) {
            lambda[i] = p->floats[2 * i];
            values[i] = p->floats[2 * i + 1];
        }
        struct sr_spd s =
            lambda && values ? sr_spd_from_samples(&arena, lambda, values, count, &error) : sr_spd_constant(1);
        if (error.status == SR_OK)
            scale = sr_spd_luminous_integral(&s) / SR_CIE_Y_INTEGRAL;
    } else if (p && p->type == SR_PBRT_SPECTRUM)
        warn(u, "a spectrum by name or file is scaled to luminance 1 in pbrt-v4, and it was not: see to \"scale\"");
    sr_arena_free(&arena);
    return scale;
}

static void upgrade_light(struct sr_pbrt_upgrade *u)
{
    static const char *const gone[] = {"samples", "nsamples", NULL};
    const char *colour = sr_pbrt_edit_find(u, "I") ? "I" : "L";
    bool has_map = sr_pbrt_edit_find(u, "mapname") != NULL;
    double scale = luminance_of(u, colour);
    float grey;
    if (sr_pbrt_edit_grey(u, "scale", 1, &grey))
        scale *= (double)grey;
    else {
        const struct sr_pbrt_param *tint = sr_pbrt_edit_find(u, "scale"), *old = sr_pbrt_edit_find(u, colour);
        if (tint->type == SR_PBRT_RGB && !has_map && (!old || (old->type == SR_PBRT_RGB && old->count == 3))) {
            float product[3];
            for (int i = 0; i < 3; ++i)
                product[i] = tint->floats[i] * (old ? old->floats[i] : 1);
            sr_pbrt_edit_set(u, SR_PBRT_RGB, colour, product, 3);
        } else
            warn(u, "a \"scale\" that is coloured is left out: it is one number in pbrt-v4");
    }
    sr_pbrt_edit_remove(u, "scale");
    if (has_map && !is(u->s->strings[0], "goniometric")) { // the image alone gives the colours
        if (sr_pbrt_edit_grey(u, colour, 1, &grey))
            scale *= (double)grey;
        else
            warn(u, "the colour beside an image is left out");
        sr_pbrt_edit_remove(u, colour);
    }
    if (has_map && is(u->s->strings[0], "infinite"))
        warn(
            u,
            "pbrt-v4 wants the image as an equal-area map of the octahedron: pbrt's imgtool makeequiarea makes it of this one");
    if (is(u->s->strings[0], "projection"))
        set_default(u, "fov", 45);
    if (is(u->s->word, "AreaLightSource") && is(u->s->strings[0], "area"))
        u->s->strings[0] = "diffuse";
    sr_pbrt_edit_rename(u, "mapname", "filename");
    if (scale != 1)
        sr_pbrt_edit_float(u, "scale", (float)scale);
    drop(u, gone);
}

/* ---- textures ---- */

static void upgrade_scale_texture(struct sr_pbrt_upgrade *u)
{
    static const char *const names[] = {"tex1", "tex2"};
    if (is(u->s->strings[1], "float")) {
        sr_pbrt_edit_rename(u, "tex1", "tex");
        sr_pbrt_edit_rename(u, "tex2", "scale");
        return;
    }
    for (int i = 1; i >= 0; --i) { // one of the two is a number
        float value;
        if (!sr_pbrt_edit_grey(u, names[i], 1, &value))
            continue;
        sr_pbrt_edit_remove(u, names[i]);
        sr_pbrt_edit_rename(u, names[1 - i], "tex");
        sr_pbrt_edit_float(u, "scale", value);
        return;
    }
    warn(u, "the product of two colours is not in pbrt-v4: the first one alone");
    sr_pbrt_edit_remove(u, "tex2");
    sr_pbrt_edit_rename(u, "tex1", "tex");
}

static void upgrade_texture(struct sr_pbrt_upgrade *u)
{
    const char **strings = u->s->strings;
    if (is(strings[1], "color"))
        strings[1] = "spectrum";
    refer_textures(u);
    define(u, is(strings[1], "float") ? "float" : "spectrum", &strings[0]);
    const struct sr_pbrt_param *p = sr_pbrt_edit_find(u, "trilinear");
    if (p && p->ints) {
        sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "filter", p->ints[0] ? "trilinear" : "bilinear");
        sr_pbrt_edit_remove(u, "trilinear");
    } else if (is(strings[2], "imagemap") && !sr_pbrt_edit_find(u, "filter"))
        sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "filter", "ewa"); // what was used
    if ((p = sr_pbrt_edit_find(u, "gamma"))) {
        char text[64];
        snprintf(text, sizeof text, "gamma %.6g", p->floats ? (double)p->floats[0] : 2.2);
        const char *encoding =
            p->type == SR_PBRT_BOOL ? (p->ints[0] ? "sRGB" : "linear") : sr_pbrt_text(u->p->d, text, strlen(text));
        sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "encoding", encoding ? encoding : "sRGB");
        sr_pbrt_edit_remove(u, "gamma");
    }
    sr_pbrt_edit_remove(u, "aamode");
    if (is(strings[2], "scale"))
        upgrade_scale_texture(u);
    if (is(strings[2], "uv")) {
        warn(u, "pbrt-v4 has no texture that shows u and v: grey instead");
        strings[2] = "constant";
        u->s->params.count = 0;
        if (is(strings[1], "float"))
            sr_pbrt_edit_float(u, "value", 0.5f);
        else
            sr_pbrt_edit_set(u, SR_PBRT_RGB, "value", (const float[]){0.5f, 0.5f, 0.5f}, 3);
    }
}

/* ---- shapes, media ---- */

static void upgrade_shape(struct sr_pbrt_upgrade *u)
{
    static const char *const absent[] = {"cone", "hyperboloid", "paraboloid", "heightfield", "nurbs", NULL};
    static const char *const gone[] = {"discarddegenerateUVs", "shadowalpha", NULL};
    static const char *const of_material[] = {"Kd", "Ks", "Kr", "Kt", "roughness", "bumpmap", "opacity", "index", NULL};
    struct sr_pbrt_param *p;
    for (int i = 0; absent[i]; ++i)
        if (is(u->s->strings[0], absent[i])) {
            warn(u, "pbrt-v4 has no such shape: left out");
            u->s->is_dropped = true;
        }
    sr_pbrt_edit_rename(u, "nlevels", "levels");
    sr_pbrt_edit_rename(u, "st", "uv");
    if ((p = sr_pbrt_edit_find(u, "uv")) && p->type == SR_PBRT_FLOAT && p->count % 2 == 0)
        p->type = SR_PBRT_POINT2;
    for (int i = 0; of_material[i]; ++i)
        if (sr_pbrt_edit_find(u, of_material[i])) {
            warn(u, "parameters of a material on the shape itself are left out");
            drop(u, of_material);
        }
    if (sr_pbrt_edit_find(u, "shadowalpha"))
        warn(u, "\"shadowalpha\" is left out");
    refer_textures(u);
    drop(u, gone);
}

static void upgrade_named_material(struct sr_pbrt_upgrade *u)
{
    const struct sr_pbrt_param *type = sr_pbrt_edit_find(u, "type");
    const char *model = type && type->strings ? type->strings[0] : "matte";
    sr_pbrt_edit_remove(u, "type");
    refer_textures(u);
    define(u, "material", &u->s->strings[0]);
    sr_pbrt_upgrade_material(u, &model);
    sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "type", model);
    struct sr_pbrt_param last = u->s->params.items[u->s->params.count - 1]; // it comes first, as people write it
    memmove(u->s->params.items + 1, u->s->params.items, (u->s->params.count - 1) * sizeof last);
    u->s->params.items[0] = last;
}

static void upgrade_medium(struct sr_pbrt_upgrade *u)
{
    const struct sr_pbrt_param *type = sr_pbrt_edit_find(u, "type");
    if (type && type->strings && is(type->strings[0], "heterogeneous"))
        sr_pbrt_edit_string(u, SR_PBRT_STRING_TYPE, "type", "uniformgrid");
}

/* ---- state ---- */

/* TransformBegin kept the material; AttributeBegin, its successor, does not. */
static void watch_block(struct sr_pbrt_upgrade *u)
{
    static const char *const state[] = {"Material", "NamedMaterial", "AreaLightSource", "MediumInterface",
                                        "ReverseOrientation"};
    if (is(u->s->word, "TransformBegin")) {
        u->s->word = "AttributeBegin";
        if (++u->block_depth < 64)
            u->changed[u->block_depth] = (struct sr_location){0};
    } else if (is(u->s->word, "TransformEnd")) {
        u->s->word = "AttributeEnd";
        if (u->block_depth > 0 && u->block_depth < 64 && u->changed[u->block_depth].file)
            sr_pbrt_warn(u->p->d, u->changed[u->block_depth],
                         "what this sets held beyond TransformEnd in pbrt-v3, and does not in pbrt-v4");
        u->block_depth -= u->block_depth > 0;
    }
    for (size_t i = 0; u->block_depth > 0 && u->block_depth < 64 && i < sizeof state / sizeof *state; ++i)
        if (is(u->s->word, state[i]))
            u->changed[u->block_depth] = u->s->where;
}

static void add_filter(struct sr_pbrt_upgrade *u)
{
    static const float half = 0.5f;
    struct sr_pbrt_param radii[2] = {{.type = SR_PBRT_FLOAT, .name = "xradius", .count = 1, .floats = &half},
                                     {.type = SR_PBRT_FLOAT, .name = "yradius", .count = 1, .floats = &half}};
    struct sr_pbrt_statement box = {.word = "PixelFilter", .strings = {"box"}, .string_count = 1, .params = {radii, 2}};
    if (!u->has_filter) // the default that was
        sr_pbrt_statement_print(u->out, &box);
}

sr_status sr_pbrt_upgrade(struct sr_pbrt_upgrade *u)
{
    static const struct {
        const char *word;
        void (*upgrade)(struct sr_pbrt_upgrade *u);
    } words[] = {
        {"PixelFilter", upgrade_filter},
        {"Film", upgrade_film},
        {"Sampler", upgrade_sampler},
        {"Integrator", upgrade_integrator},
        {"Camera", upgrade_camera},
        {"LightSource", upgrade_light},
        {"AreaLightSource", upgrade_light},
        {"Texture", upgrade_texture},
        {"Shape", upgrade_shape},
        {"MakeNamedMaterial", upgrade_named_material},
        {"MakeNamedMedium", upgrade_medium},
        {"WorldBegin", add_filter},
    };
    struct sr_pbrt_statement *s = u->s;
    u->room = s->params.count + 16;
    struct sr_pbrt_param *items = sr_pbrt_words(u->p->d, u->room * sizeof *items);
    if (!items) {
        no_memory(u);
        return u->p->error->status;
    }
    if (s->params.count)
        memcpy(items, s->params.items, s->params.count * sizeof *items);
    s->params.items = items;
    watch_block(u);
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i)
        if (is(s->word, words[i].word))
            words[i].upgrade(u);
    if (is(s->word, "Material")) {
        refer_textures(u);
        sr_pbrt_upgrade_material(u, &s->strings[0]);
    } else if (is(s->word, "NamedMaterial"))
        s->strings[0] = sr_pbrt_upgrade_name(u, "material", s->strings[0]);
    else if (is(s->word, "ObjectBegin"))
        define(u, "object", &s->strings[0]);
    else if (is(s->word, "ObjectInstance"))
        s->strings[0] = sr_pbrt_upgrade_name(u, "object", s->strings[0]);
    return u->p->error->status;
}
