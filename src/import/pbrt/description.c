/* SPDX-License-Identifier: MIT */
/* Services around a description: memory for small things, messages with their place, suggestions, look-up by name. */
#include "import/pbrt/description.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { CHUNK = 64 * 1024 };

void *sr_pbrt_words(struct sr_pbrt_description *d, size_t size)
{
    size = (size + 16 + 15) & ~(size_t)15;
    if (size > CHUNK / 4)
        return sr_arena_alloc(&d->words, size);
    if (size > d->chunk_left) {
        d->chunk = sr_arena_alloc(&d->words, CHUNK);
        d->chunk_left = d->chunk ? CHUNK : 0;
        if (!d->chunk)
            return NULL;
    }
    void *p = d->chunk;
    d->chunk += size;
    d->chunk_left -= size;
    return p;
}

const char *sr_pbrt_text(struct sr_pbrt_description *d, const char *text, size_t length)
{
    char *copy = sr_pbrt_words(d, length + 1);
    if (copy)
        memcpy(copy, text, length);
    return copy;
}

void sr_pbrt_description_free(struct sr_pbrt_description *d)
{
    struct sr_array *arrays[] = {&d->files,    &d->options,   &d->transforms, &d->materials,     &d->named_materials,
                                 &d->textures, &d->media,     &d->lights,     &d->area_lights,   &d->shapes,
                                 &d->objects,  &d->instances, &d->meters,     &d->uncertainties, &d->memory_files};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i)
        sr_array_free(arrays[i]);
    struct sr_pbrt_names *names[] = {&d->object_names, &d->material_names, &d->medium_names, &d->float_textures,
                                     &d->spectrum_textures};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i)
        sr_pbrt_names_free(names[i]);
    sr_arena_free(&d->words);
    *d = (struct sr_pbrt_description){0};
}

static struct sr_pbrt_entity default_entity(const char *directive, const char *model)
{
    return (struct sr_pbrt_entity){.directive = directive, .model = model, .space = SR_SRGB};
}

bool sr_pbrt_description_start(struct sr_pbrt_description *d, struct sr_arena *data, struct sr_log *log)
{
    *d = (struct sr_pbrt_description){.data = data, .log = log, .transform_end_time = 1, .film_space = SR_SRGB};
    d->camera = default_entity("Camera", "perspective");
    d->film = default_entity("Film", "rgb");
    d->sampler = default_entity("Sampler", "zsobol");
    d->filter = default_entity("PixelFilter", "gaussian");
    d->integrator = default_entity("Integrator", "volpath");
    d->accelerator = default_entity("Accelerator", "bvh");
    struct sr_pbrt_entity *material = sr_array_push(&d->materials, sizeof *material);
    struct sr_pbrt_transform *transform = sr_array_push(&d->transforms, sizeof *transform);
    if (!material || !transform)
        return false;
    *material = default_entity("Material", "diffuse");
    transform->start = transform->end = sr_matrix_identity();
    return true;
}

const struct sr_pbrt_memory_file *sr_pbrt_memory_file(const struct sr_pbrt_description *d, const char *name)
{
    for (size_t i = 0; i < d->memory_files.count; ++i) {
        const struct sr_pbrt_memory_file *f = SR_PBRT_AT(d->memory_files, struct sr_pbrt_memory_file, i);
        if (strcmp(f->name, name) == 0)
            return f;
    }
    return NULL;
}

/* "file:line:column: sentence (included from …)" */
static void compose(const struct sr_pbrt_description *d, struct sr_location where, char *text, size_t size,
                    const char *format, va_list arguments)
{
    int n = !where.file  ? 0
            : where.line ? snprintf(text, size, "%s:%d:%d: ", where.file, where.line, where.column)
                         : snprintf(text, size, "%s: ", where.file);
    if (n < 0 || (size_t)n >= size)
        return;
    int m = vsnprintf(text + n, size - (size_t)n, format, arguments);
    n = m < 0 ? n : n + m;
    for (int depth = 0; depth < 8 && where.file && (size_t)n < size; ++depth) {
        const struct sr_pbrt_file *file = NULL;
        for (size_t i = 0; i < d->files.count && !file; ++i) {
            const struct sr_pbrt_file *f = *SR_PBRT_AT(d->files, struct sr_pbrt_file *, i);
            file = f->path == where.file ? f : NULL;
        }
        if (!file || !file->from.file)
            return;
        where = file->from;
        n += snprintf(text + n, size - (size_t)n, " (included from %s:%d:%d)", where.file, where.line, where.column);
    }
}

sr_status sr_pbrt_fail(const struct sr_pbrt_description *d, struct sr_location where, struct sr_error *error,
                       sr_status status, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    compose(d, where, text, sizeof text, format, arguments);
    va_end(arguments);
    return sr_fail(error, status, "%s", text);
}

void sr_pbrt_warn(const struct sr_pbrt_description *d, struct sr_location where, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    compose(d, where, text, sizeof text, format, arguments);
    va_end(arguments);
    sr_log(d->log, SR_WARNING, "%s", text);
}

/* ---- suggestions ---- */

enum { WORD_MAX = 48 };

/* Optimal string alignment: insertions, deletions, substitutions and swaps of neighbours. */
static int distance(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b);
    if (n > WORD_MAX || m > WORD_MAX)
        return WORD_MAX;
    int rows[3][WORD_MAX + 1];
    for (size_t j = 0; j <= m; ++j)
        rows[0][j] = (int)j;
    for (size_t i = 1; i <= n; ++i) {
        int *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = (int)i;
        for (size_t j = 1; j <= m; ++j) {
            int ca = tolower((unsigned char)a[i - 1]), cb = tolower((unsigned char)b[j - 1]);
            int best = above[j - 1] + (ca != cb);
            best = above[j] + 1 < best ? above[j] + 1 : best;
            best = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
            if (i > 1 && j > 1 && ca == tolower((unsigned char)b[j - 2]) && cb == tolower((unsigned char)a[i - 2]))
                best = above2[j - 2] + 1 < best ? above2[j - 2] + 1 : best;
            row[j] = best;
        }
    }
    return rows[n % 3][m];
}

void sr_pbrt_suggest(struct sr_pbrt_suggestion *s, const char *candidate)
{
    int d = distance(s->word, candidate);
    if (!s->best || d < s->distance) {
        s->best = candidate;
        s->distance = d;
    }
}

const char *sr_pbrt_suggestion_text(const struct sr_pbrt_suggestion *s, char buffer[160])
{
    buffer[0] = 0;
    if (s->best && s->distance <= 1 + (int)strlen(s->word) / 3 && s->distance < (int)strlen(s->word))
        snprintf(buffer, 160, ": did you mean \"%s\"?", s->best);
    return buffer;
}

/* ---- look-up ---- */

struct sr_pbrt_param *sr_pbrt_peek(const struct sr_pbrt_params *params, const char *name)
{
    for (uint32_t i = 0; i < params->count; ++i)
        if (strcmp(params->items[i].name, name) == 0)
            return &params->items[i];
    return NULL;
}

struct sr_pbrt_param *sr_pbrt_find(const struct sr_pbrt_params *params, const char *name)
{
    struct sr_pbrt_param *p = sr_pbrt_peek(params, name);
    if (p)
        p->used = true;
    return p;
}

static sr_status get(const struct sr_pbrt_description *d, const struct sr_pbrt_params *params, const char *name,
                     enum sr_pbrt_type type, const struct sr_pbrt_param **p, struct sr_error *error)
{
    *p = sr_pbrt_find(params, name);
    if (!*p || ((*p)->type == type && (*p)->count == 1))
        return SR_OK;
    struct sr_location where = (*p)->where;
    if ((*p)->type == type)
        return sr_pbrt_fail(d, where, error, SR_ERROR_INPUT, "\"%s %s\" has %u values: expected one",
                            sr_pbrt_type_name(type), name, (*p)->count);
    return sr_pbrt_fail(d, where, error, SR_ERROR_INPUT, "\"%s %s\" has the wrong type: expected \"%s %s\"",
                        sr_pbrt_type_name((*p)->type), name, sr_pbrt_type_name(type), name);
}

sr_status sr_pbrt_get_float(const struct sr_pbrt_description *d, const struct sr_pbrt_params *params, const char *name,
                            float *value, struct sr_error *e)
{
    const struct sr_pbrt_param *p;
    sr_status status = get(d, params, name, SR_PBRT_FLOAT, &p, e);
    if (status == SR_OK && p)
        *value = p->floats[0];
    return status;
}

sr_status sr_pbrt_get_int(const struct sr_pbrt_description *d, const struct sr_pbrt_params *params, const char *name,
                          int32_t *value, struct sr_error *e)
{
    const struct sr_pbrt_param *p;
    sr_status status = get(d, params, name, SR_PBRT_INTEGER, &p, e);
    if (status == SR_OK && p)
        *value = p->ints[0];
    return status;
}

sr_status sr_pbrt_get_bool(const struct sr_pbrt_description *d, const struct sr_pbrt_params *params, const char *name,
                           bool *value, struct sr_error *e)
{
    const struct sr_pbrt_param *p;
    sr_status status = get(d, params, name, SR_PBRT_BOOL, &p, e);
    if (status == SR_OK && p)
        *value = p->ints[0] != 0;
    return status;
}

sr_status sr_pbrt_get_string(const struct sr_pbrt_description *d, const struct sr_pbrt_params *params, const char *name,
                             const char **value, struct sr_error *e)
{
    const struct sr_pbrt_param *p;
    sr_status status = get(d, params, name, SR_PBRT_STRING_TYPE, &p, e);
    if (status == SR_OK && p)
        *value = p->strings[0];
    return status;
}
