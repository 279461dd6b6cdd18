/* SPDX-License-Identifier: MIT */
/* Textures that pbrt does not know, as the nearest that it knows: single channels of images, and images times a colour,
 * become images of their own, of 8 bits, beside the text; colours of vertices, and the products with them, are lost. */
#include "image/image.h"
#include "import/pbrt/closest.h"

#include <string.h>

struct baker {
    struct sr_pbrt_description *d;
    struct sr_arena *arena;
    const char *main_path, *out;
    struct sr_error *error;
};

static float number(const struct sr_pbrt_entity *e, const char *name, float initial)
{
    const struct sr_pbrt_param *p = sr_pbrt_peek(&e->params, name);
    return p && p->floats && p->count ? p->floats[0] : initial;
}

static const char *word(const struct sr_pbrt_entity *e, const char *name, const char *initial)
{
    const struct sr_pbrt_param *p = sr_pbrt_peek(&e->params, name);
    return p && p->strings && p->count ? p->strings[0] : initial;
}

static void no_memory(struct baker *b)
{
    sr_fail(b->error, SR_ERROR_RESOURCE, "%s: not enough memory", b->main_path);
}

/* ---- parameters ---- */

static void add(struct baker *b, struct sr_pbrt_params *to, enum sr_pbrt_type type, const char *name,
                const void *values, uint32_t count)
{
    bool has_words = type == SR_PBRT_STRING_TYPE || type == SR_PBRT_TEXTURE;
    size_t size = count * (has_words ? sizeof(char *) : sizeof(float));
    void *copy = sr_pbrt_words(b->d, size);
    if (!copy) {
        no_memory(b);
        return;
    }
    memcpy(copy, values, size);
    to->items[to->count++] = (struct sr_pbrt_param){.type = type,
                                                    .name = name,
                                                    .count = count,
                                                    .strings = has_words ? copy : NULL,
                                                    .floats = has_words ? NULL : copy};
}

static struct sr_pbrt_params room(struct baker *b)
{
    struct sr_pbrt_params p = {sr_pbrt_words(b->d, 16 * sizeof(struct sr_pbrt_param)), 0};
    if (!p.items)
        no_memory(b);
    return p;
}

static void warn(struct baker *b, const struct sr_pbrt_entity *e, const char *text)
{
    sr_pbrt_warn(b->d, e->where, "texture \"%s\": %s", e->name, text);
}

/* ---- images ---- */

static struct sr_image *read_image(struct baker *b, const char *name, bool is_linear)
{
    const struct sr_pbrt_memory_file *memory = sr_pbrt_memory_file(b->d, name);
    const char *path = memory ? name : sr_path_beside(b->arena, b->main_path, name);
    enum sr_image_encoding encoding = is_linear ? SR_IMAGE_LINEAR : SR_IMAGE_SRGB;
    struct sr_image *image = NULL;
    if (!path)
        no_memory(b);
    else if ((memory ? sr_image_decode(name, memory->data, memory->size, encoding, &image, b->error)
                     : sr_image_read_as(path, encoding, &image, b->error)) != SR_OK ||
             sr_image_to_float(image, b->error) != SR_OK) {
        sr_image_free(image);
        return NULL;
    }
    return image;
}

static unsigned char byte_of(float v)
{
    return (unsigned char)(v >= 1 ? 255 : v > 0 ? v * 255 + 0.5f : 0);
}

/* channel: 0 to 3, or 4 for the mean; negative: colours, times factor. Where cutoff is positive, 1 from there on and 0
 * below. */
struct recipe {
    int channel;
    float scale, offset, cutoff; // [1]
    float factor[3];             // [1]
};

static float pixel(const struct sr_image *image, size_t i, const struct recipe *r)
{
    const float *p = image->floats + i * image->channel_count;
    uint32_t n = image->channel_count, colours = n >= 3 ? 3 : 1;
    float v = 0;
    if (r->channel == 3)
        v = n == 2 || n >= 4 ? p[n == 2 ? 1 : 3] : 1;
    else if (r->channel < 3)
        v = p[(uint32_t)r->channel < colours ? r->channel : 0];
    else
        for (uint32_t k = 0; k < colours; ++k)
            v += p[k] / (float)colours;
    v = r->offset + r->scale * v;
    return r->cutoff > 0 ? (v >= r->cutoff ? 1 : 0) : v;
}

/* The image by that recipe in a file beside the text; its name there, or NULL. */
static const char *bake(struct baker *b, const struct sr_image *image, const struct recipe *r, const char *name)
{
    bool is_colour = r->channel < 0;
    struct sr_image *made = NULL;
    if (sr_image_create(image->width, image->height, is_colour ? 3 : 1, NULL, SR_IMAGE_BYTES, &made, b->error) != SR_OK)
        return NULL;
    made->encoding = is_colour ? SR_IMAGE_SRGB : SR_IMAGE_LINEAR;
    for (size_t i = 0; i < (size_t)image->width * image->height; ++i) {
        const float *p = image->floats + i * image->channel_count;
        for (int k = 0; is_colour && k < 3; ++k)
            made->bytes[3 * i + (size_t)k] =
                byte_of(sr_image_encode_srgb(r->factor[k] * p[image->channel_count >= 3 ? k : 0]));
        if (!is_colour)
            made->bytes[i] = byte_of(pixel(image, i, r));
    }
    const char *path = sr_convert_beside(b->arena, b->out, name, ".png"), *slash = path ? strrchr(path, '/') : NULL;
    if (!path)
        no_memory(b);
    else
        sr_image_write(path, made, NULL, b->error);
    sr_image_free(made);
    return b->error->status == SR_OK ? (slash ? slash + 1 : path) : NULL;
}

/* ---- models ---- */

static void add_mapping(struct baker *b, const struct sr_pbrt_entity *e, struct sr_pbrt_params *to)
{
    static const char *const names[] = {"uscale", "vscale", "udelta", "vdelta"};
    static const float plain[4] = {1, 1, 0, 0};
    const struct sr_pbrt_param *t = sr_pbrt_peek(&e->params, "transform");
    const char *s_wrap = word(e, "swrap", "repeat"), *t_wrap = word(e, "twrap", "repeat");
    if (t && t->floats && t->count == 6) {
        const float *m = t->floats, values[4] = {m[0], m[4], m[2], m[5]};
        if (fabsf(m[1]) > 1e-6f || fabsf(m[3]) > 1e-6f)
            warn(b, e, "pbrt does not turn images: it lies as if it were not turned");
        for (int i = 0; i < 4; ++i)
            if (values[i] != plain[i])
                add(b, to, SR_PBRT_FLOAT, names[i], &values[i], 1);
    }
    if (sr_pbrt_peek(&e->params, "uv"))
        warn(b, e, "pbrt has one set of texture coordinates: this one's are lost");
    if (strcmp(s_wrap, "clamp") == 0 && strcmp(t_wrap, "clamp") == 0)
        add(b, to, SR_PBRT_STRING_TYPE, "wrap", &s_wrap, 1);
    else if (strcmp(s_wrap, "repeat") != 0 || strcmp(t_wrap, "repeat") != 0)
        warn(b, e, "pbrt wraps images in one way in both directions, and does not mirror them: repeated");
    if (strcmp(word(e, "filter", "bilinear"), "point") == 0)
        add(b, to, SR_PBRT_STRING_TYPE, "filter", &(const char *){"point"}, 1);
}

static bool change_texelmap(struct baker *b, struct sr_pbrt_texture *t)
{
    static const char *const channels[] = {"r", "g", "b", "a", "mean"}, *const linear = "linear";
    struct sr_pbrt_entity *e = &t->entity;
    struct sr_pbrt_params params = room(b);
    const struct sr_pbrt_param *factor = sr_pbrt_peek(&e->params, "factor");
    const char *filename = word(e, "filename", ""), *encoding = word(e, "encoding", "sRGB");
    bool is_linear = strcmp(encoding, "linear") == 0,
         is_tinted = factor && factor->count == 3 &&
                     !(factor->floats[0] == factor->floats[1] && factor->floats[1] == factor->floats[2]);
    struct recipe r = {
        .channel = -1, .scale = number(e, "scale", 1), .offset = number(e, "offset", 0), .factor = {1, 1, 1}};
    if (t->is_float)
        for (r.channel = 0; r.channel < 4 && strcmp(channels[r.channel], word(e, "channel", "mean")) != 0;)
            ++r.channel;
    else if (is_tinted)
        memcpy(r.factor, factor->floats, sizeof r.factor);
    bool bakes = t->is_float || is_tinted;
    if (bakes && b->error->status == SR_OK) {
        struct sr_image *image = read_image(b, filename, is_linear);
        filename = image ? bake(b, image, &r, e->name) : NULL;
        sr_image_free(image);
    }
    if (b->error->status != SR_OK)
        return false;
    add(b, &params, SR_PBRT_STRING_TYPE, "filename", &filename, 1);
    if (t->is_float || (is_linear && !bakes))
        add(b, &params, SR_PBRT_STRING_TYPE, "encoding", &linear, 1);
    if (!bakes && factor && factor->count && factor->floats[0] != 1)
        add(b, &params, SR_PBRT_FLOAT, "scale", factor->floats, 1);
    add_mapping(b, e, &params);
    e->model = "imagemap";
    e->params = params;
    return bakes;
}

static void change_attribute(struct baker *b, struct sr_pbrt_texture *t)
{
    static const float white[3] = {1, 1, 1};
    struct sr_pbrt_params params = room(b);
    if (!params.items)
        return;
    warn(b, &t->entity, "pbrt has no colours of vertices: white instead");
    add(b, &params, t->is_float ? SR_PBRT_FLOAT : SR_PBRT_RGB, "value", white, t->is_float ? 1 : 3);
    t->entity.model = "constant";
    t->entity.params = params;
}

/* The second factor is the colour of vertices, which is lost. */
static void change_product(struct baker *b, struct sr_pbrt_texture *t)
{
    struct sr_pbrt_params params = room(b);
    const struct sr_pbrt_param *first = sr_pbrt_peek(&t->entity.params, "tex1");
    if (!params.items)
        return;
    if (first) {
        params.items[params.count++] = *first;
        params.items[0].name = "tex";
    }
    t->entity.model = "scale";
    t->entity.params = params;
}

static bool change_threshold(struct baker *b, struct sr_pbrt_texture *t)
{
    const struct sr_pbrt_param *p = sr_pbrt_peek(&t->entity.params, "tex");
    uint32_t index1 = p && p->type == SR_PBRT_TEXTURE ? sr_pbrt_names_find(&b->d->float_textures, p->strings[0]) : 0;
    const struct sr_pbrt_entity *from =
        index1 ? &SR_PBRT_AT(b->d->textures, struct sr_pbrt_texture, index1 - 1)->entity : NULL;
    struct sr_pbrt_params params = room(b);
    if (!params.items)
        return false;
    if (!from || strcmp(from->model, "imagemap") != 0) {
        warn(b, &t->entity, "pbrt has no thresholds: what is partly there is partly seen");
        if (p) {
            params.items[params.count++] = *p;
            params.items[0].name = "tex";
        }
        t->entity.model = "scale";
        t->entity.params = params;
        return false;
    }
    const char *path = sr_path_beside(b->arena, b->out, word(from, "filename", "")); // which has been made here
    struct recipe r = {.channel = 0, .scale = 1, .cutoff = number(&t->entity, "cutoff", 0.5f)};
    struct sr_image *image = NULL;
    const char *name = NULL;
    if (path && sr_image_read_as(path, SR_IMAGE_LINEAR, &image, b->error) == SR_OK &&
        sr_image_to_float(image, b->error) == SR_OK)
        name = bake(b, image, &r, t->entity.name);
    sr_image_free(image);
    for (uint32_t i = 0; name && i < from->params.count; ++i) {
        params.items[params.count] = from->params.items[i];
        if (strcmp(from->params.items[i].name, "filename") == 0)
            add(b, &params, SR_PBRT_STRING_TYPE, "filename", &name, 1);
        else
            ++params.count;
    }
    t->entity.model = "imagemap";
    t->entity.params = params;
    return true;
}

sr_status sr_pbrt_closest_texture(struct sr_pbrt_description *d, struct sr_arena *arena, const char *main_path,
                                  const char *out, struct sr_pbrt_texture *t, bool *is_made, struct sr_error *error)
{
    struct baker b = {.d = d, .arena = arena, .main_path = main_path, .out = out, .error = error};
    const char *model = t->entity.model;
    *is_made = false;
    if (strcmp(model, "texelmap") == 0)
        *is_made = change_texelmap(&b, t);
    else if (strcmp(model, "attribute") == 0)
        change_attribute(&b, t);
    else if (strcmp(model, "product") == 0)
        change_product(&b, t);
    else if (strcmp(model, "threshold") == 0)
        *is_made = change_threshold(&b, t);
    return error->status;
}

/* ---- normals ---- */

static bool is_normal(const char *name)
{
    return strcmp(name, "normalx") == 0 || strcmp(name, "normaly") == 0 || strcmp(name, "normalz") == 0;
}

bool sr_pbrt_is_normal_texture(const struct sr_pbrt_description *d, const char *name)
{
    for (size_t i = 0; i < d->named_materials.count; ++i) {
        const struct sr_pbrt_params *p = &SR_PBRT_AT(d->named_materials, struct sr_pbrt_entity, i)->params;
        for (uint32_t k = 0; k < p->count; ++k)
            if (is_normal(p->items[k].name) && p->items[k].type == SR_PBRT_TEXTURE &&
                strcmp(p->items[k].strings[0], name) == 0)
                return true;
    }
    return false;
}

sr_status sr_pbrt_closest_normals(struct sr_pbrt_description *d, struct sr_pbrt_entity *e, struct sr_error *error)
{
    const struct sr_pbrt_param *x = sr_pbrt_peek(&e->params, "normalx");
    uint32_t index1 = x && x->type == SR_PBRT_TEXTURE ? sr_pbrt_names_find(&d->float_textures, x->strings[0]) : 0;
    if (!index1)
        return SR_OK;
    struct baker b = {.d = d, .error = error, .main_path = ""};
    const struct sr_pbrt_entity *map = &SR_PBRT_AT(d->textures, struct sr_pbrt_texture, index1 - 1)->entity;
    struct sr_pbrt_params params = {sr_pbrt_words(d, (e->params.count + 1) * sizeof(struct sr_pbrt_param)), 0};
    const char *filename = word(map, "filename", NULL);
    if (!params.items || !filename)
        return params.items ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the materials");
    for (uint32_t i = 0; i < e->params.count; ++i)
        if (!is_normal(e->params.items[i].name))
            params.items[params.count++] = e->params.items[i];
    add(&b, &params, SR_PBRT_STRING_TYPE, "normalmap", &filename, 1);
    if (number(map, "scale", 2) != 2 || sr_pbrt_peek(&map->params, "transform") || sr_pbrt_peek(&map->params, "uv"))
        sr_pbrt_warn(d, e->where, "material \"%s\": the scale and the place of its normal map are lost",
                     e->name ? e->name : "");
    e->params = params;
    return error->status;
}
