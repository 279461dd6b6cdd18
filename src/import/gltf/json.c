/* SPDX-License-Identifier: MIT */
/* Values of the JSON text: each access checks type and range and tells the JSON pointer (RFC 6901) of what is wrong. */
#include "import/gltf/gltf.h"

#include <stdio.h>
#include <string.h>

/* ---- messages ---- */

void sr_gltf_fail(struct sr_gltf *g, const struct sr_gltf_at *at, const char *format, ...)
{
    char text[700];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sr_fail(g->c.error, SR_ERROR_INPUT, "%s: %s%s%s", g->c.path, at ? at->pointer : "", at ? ": " : "", text);
}

static bool is_told(struct sr_gltf *g, const char *text)
{
    for (size_t i = 0; i < g->told.count; ++i)
        if (strcmp(SR_PBRT_AT(g->told, const char *, i)[0], text) == 0)
            return true;
    const char **slot = g->told.count < 1000 ? sr_array_push(&g->told, sizeof *slot) : NULL;
    if (!slot) // of so many nobody reads one more
        return true;
    *slot = sr_compose_word(&g->c, text);
    return false;
}

void sr_gltf_warn(struct sr_gltf *g, const struct sr_gltf_at *at, const char *format, ...)
{
    char text[700];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!is_told(g, text))
        sr_log(g->c.d->log, SR_WARNING, "%s: %s%s%s", g->c.path, at ? at->pointer : "", at ? ": " : "", text);
}

void sr_gltf_note(struct sr_gltf *g, const char *what, const char *why)
{
    if (!is_told(g, what))
        sr_log(g->c.d->log, SR_INFO, "%s: %s: %s", g->c.path, what, why);
}

/* ---- places ---- */

static struct sr_gltf_at below(const struct sr_gltf_at *at, json_t *json, const char *key)
{
    struct sr_gltf_at r = {.json = json};
    snprintf(r.pointer, sizeof r.pointer, "%.80s/%.38s", at ? at->pointer : "", key);
    return r;
}

static struct sr_gltf_at typed(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, json_type type)
{
    json_t *json = at->json ? json_object_get(at->json, key) : NULL;
    struct sr_gltf_at r = below(at, json, key);
    if (json && json_typeof(json) != type) {
        sr_gltf_fail(g, &r, "expected %s",
                     type == JSON_OBJECT  ? "an object"
                     : type == JSON_ARRAY ? "a list"
                                          : "a string");
        r.json = NULL;
    }
    return r;
}

struct sr_gltf_at sr_gltf_object(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key)
{
    return typed(g, at, key, JSON_OBJECT);
}

struct sr_gltf_at sr_gltf_array(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key)
{
    return typed(g, at, key, JSON_ARRAY);
}

struct sr_gltf_at sr_gltf_list(struct sr_gltf *g, const char *key)
{
    struct sr_gltf_at root = {.json = g->root};
    return sr_gltf_array(g, &root, key);
}

uint32_t sr_gltf_count(const struct sr_gltf_at *list)
{
    return list->json ? (uint32_t)json_array_size(list->json) : 0;
}

uint32_t sr_gltf_root_count(struct sr_gltf *g, const char *key)
{
    struct sr_gltf_at list = sr_gltf_list(g, key);
    return sr_gltf_count(&list);
}

struct sr_gltf_at sr_gltf_element(struct sr_gltf *g, const struct sr_gltf_at *list, uint32_t i)
{
    char key[16];
    snprintf(key, sizeof key, "%u", i);
    struct sr_gltf_at r = below(list, list->json ? json_array_get(list->json, i) : NULL, key);
    if (r.json && !json_is_object(r.json)) {
        sr_gltf_fail(g, &r, "expected an object");
        r.json = NULL;
    }
    return r;
}

struct sr_gltf_at sr_gltf_entry(struct sr_gltf *g, const char *list, uint32_t i)
{
    struct sr_gltf_at all = sr_gltf_list(g, list);
    return sr_gltf_element(g, &all, i);
}

struct sr_gltf_at sr_gltf_extension(struct sr_gltf *g, const struct sr_gltf_at *at, const char *name)
{
    struct sr_gltf_at extensions = sr_gltf_object(g, at, "extensions");
    return sr_gltf_object(g, &extensions, name);
}

/* ---- values ---- */

double sr_gltf_number(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, double otherwise, double min,
                      double max)
{
    json_t *json = at->json ? json_object_get(at->json, key) : NULL;
    if (!json)
        return otherwise;
    double value = json_number_value(json);
    if (json_is_number(json) && value >= min && value <= max)
        return value;
    struct sr_gltf_at here = below(at, json, key);
    if (!json_is_number(json))
        sr_gltf_fail(g, &here, "expected a number");
    else if (isinf(max))
        sr_gltf_fail(g, &here, "%g: expected %g or more", value, min);
    else
        sr_gltf_fail(g, &here, "%g: expected %g to %g", value, min, max);
    return otherwise;
}

uint64_t sr_gltf_size(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, uint64_t otherwise, uint64_t max)
{
    json_t *json = at->json ? json_object_get(at->json, key) : NULL;
    if (!json)
        return otherwise;
    double value = json_number_value(json);
    if (json_is_number(json) && value >= 0 && value <= (double)max && value == floor(value))
        return (uint64_t)value;
    struct sr_gltf_at here = below(at, json, key);
    sr_gltf_fail(g, &here, "expected a whole number from 0 to %llu", (unsigned long long)max);
    return otherwise;
}

bool sr_gltf_bool(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, bool otherwise)
{
    json_t *json = at->json ? json_object_get(at->json, key) : NULL;
    if (!json || json_is_boolean(json))
        return json ? json_is_true(json) : otherwise;
    struct sr_gltf_at here = below(at, json, key);
    sr_gltf_fail(g, &here, "expected true or false");
    return otherwise;
}

const char *sr_gltf_string(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key)
{
    struct sr_gltf_at here = typed(g, at, key, JSON_STRING);
    return here.json ? json_string_value(here.json) : NULL;
}

const char *sr_gltf_name(struct sr_gltf *g, const struct sr_gltf_at *at)
{
    const char *name = sr_gltf_string(g, at, "name");
    return name ? name : "";
}

bool sr_gltf_numbers(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, uint32_t n, double *out)
{
    struct sr_gltf_at list = sr_gltf_array(g, at, key);
    if (!list.json)
        return false;
    bool is_good = json_array_size(list.json) == n;
    for (uint32_t i = 0; i < n && is_good; ++i)
        is_good = json_is_number(json_array_get(list.json, i)) &&
                  fabs(json_number_value(json_array_get(list.json, i))) < 1e30;
    if (!is_good) {
        sr_gltf_fail(g, &list, "expected %u numbers", n);
        return false;
    }
    for (uint32_t i = 0; i < n; ++i)
        out[i] = json_number_value(json_array_get(list.json, i));
    return true;
}

static uint32_t index1_from(struct sr_gltf *g, const struct sr_gltf_at *here, uint32_t count)
{
    if (json_is_integer(here->json)) {
        json_int_t value = json_integer_value(here->json);
        if (value >= 0 && value < (json_int_t)count)
            return (uint32_t)value + 1;
        sr_gltf_fail(g, here, "index %lld: there are %u", (long long)value, count);
    } else
        sr_gltf_fail(g, here, "expected an index");
    return 0;
}

uint32_t sr_gltf_index1(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, uint32_t count)
{
    json_t *json = at->json ? json_object_get(at->json, key) : NULL;
    if (!json)
        return 0;
    struct sr_gltf_at here = below(at, json, key);
    return index1_from(g, &here, count);
}

uint32_t sr_gltf_index1_of(struct sr_gltf *g, const struct sr_gltf_at *at, uint32_t i, uint32_t count)
{
    char key[16];
    snprintf(key, sizeof key, "%u", i);
    struct sr_gltf_at here = below(at, json_array_get(at->json, i), key);
    return index1_from(g, &here, count);
}

bool sr_gltf_charge(struct sr_gltf *g, const struct sr_gltf_at *at, uint64_t bytes)
{
    if (sr_gltf_is_well(g) && g->made_B + bytes > g->most_B)
        sr_gltf_fail(g, at, "asks for more than %llu bytes of memory, which is too much for a file of %llu bytes",
                     (unsigned long long)g->most_B, (unsigned long long)g->input_B);
    g->made_B += bytes;
    return sr_gltf_is_well(g);
}

void *sr_gltf_array_for(struct sr_gltf *g, const struct sr_gltf_at *at, struct sr_arena *arena, uint64_t count,
                        size_t size)
{
    void *p = sr_gltf_charge(g, at, count * size + 16) ? sr_arena_alloc(arena, count * size + 16) : NULL;
    if (!p)
        sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
    return p;
}
