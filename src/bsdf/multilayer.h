/* SPDX-License-Identifier: MIT */
/* Private to this room: the recipe of an optical coating, periodic or from a file.
 *
 * Periodic: layer_count layers from the outside in, high, low, high, …  A file has a line "n k thickness_nm" for each
 * layer, from the outside in; '#' begins a comment. It replaces the periodic layers. Its indices are the same at all
 * wavelengths. */
#ifndef SR_BSDF_MULTILAYER_H
#define SR_BSDF_MULTILAYER_H

#include "bsdf/film.h"

#include <stdlib.h>
#include <string.h>

struct given_layers {
    int count;
    float n[FILM_LAYERS], k[FILM_LAYERS], thickness[FILM_LAYERS]; // [1] [1] [nm]
};

struct recipe {
    sr_spectrum high_eta, low_eta;       // [1]
    float high_thickness, low_thickness; // [nm]
    int32_t layer_count;
    const char *file;
    const struct given_layers *given; // NULL: periodic
};

/* The rows of a recipe that is the member `recipe` of a model's struct. Default: seven quarter waves at 550 nm. */
// rows of a table: one line each, or two
// clang-format off
#define RECIPE_ROWS(type) \
    {SR_PARAM_INT, "layer_count", "1", 0, FILM_LAYERS, 7, offsetof(type, recipe.layer_count), \
     "layers from the outside in: high, low, high, …"}, \
    {SR_PARAM_UNBOUNDED, "high_eta", "1", 1, 4, 2.35, offsetof(type, recipe.high_eta), \
     "index of refraction of the first, third, … layer"}, \
    {SR_PARAM_FLOAT, "high_thickness", "nm", 0, 500, 58.5106383, offsetof(type, recipe.high_thickness), \
     "of the first, third, … layer"}, \
    {SR_PARAM_UNBOUNDED, "low_eta", "1", 1, 4, 1.38, offsetof(type, recipe.low_eta), \
     "index of refraction of the second, fourth, … layer"}, \
    {SR_PARAM_FLOAT, "low_thickness", "nm", 0, 500, 99.6376812, offsetof(type, recipe.low_thickness), \
     "of the second, fourth, … layer"}, \
    {SR_PARAM_FILE, "layers", "1", 0, 1, 0, offsetof(type, recipe.file), \
     "instead of these: lines \"n k thickness_nm\" from the outside in"}
// clang-format on

static inline bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == ',';
}

/* Reads one number; false where there is none or where it is outside lo ... hi. */
static inline bool read_number(const char **at, float lo, float hi, float *value)
{
    char word[48];
    size_t length = 0;
    while (is_blank(**at))
        ++*at;
    while (**at && **at != '\n' && **at != '#' && !is_blank(**at)) {
        if (length + 1 == sizeof word)
            return false;
        word[length++] = *(*at)++;
    }
    word[length] = 0;
    char *end;
    double d = strtod(word, &end);
    if (length == 0 || *end || !(d >= (double)lo && d <= (double)hi))
        return false;
    *value = (float)d;
    return true;
}

static inline sr_status load_recipe(struct recipe *r, struct sr_arena *arena, struct sr_error *error)
{
    r->given = NULL;
    if (!r->file || !*r->file)
        return SR_OK;
    char *text;
    size_t size;
    sr_status status = sr_file_read(r->file, 1 << 16, &text, &size, error);
    if (status != SR_OK)
        return status;
    struct given_layers layers = {0};
    int line = 0;
    for (const char *at = text; status == SR_OK && *at; at += *at == '\n') {
        ++line;
        while (is_blank(*at))
            ++at;
        if (*at && *at != '\n' && *at != '#') {
            int i = layers.count;
            if (i == FILM_LAYERS)
                status = sr_fail(error, SR_ERROR_INPUT, "%s:%d: more than %d layers", r->file, line, FILM_LAYERS);
            else if (!read_number(&at, 0.02f, 10, &layers.n[i]) || !read_number(&at, 0, 10, &layers.k[i]) ||
                     !read_number(&at, 0, 10000, &layers.thickness[i]))
                status =
                    sr_fail(error, SR_ERROR_INPUT,
                            "%s:%d: expected \"n k thickness_nm\" with n in 0.02 to 10, k in 0 to 10, thickness in 0 "
                            "to 10000 nm",
                            r->file, line);
            else {
                while (is_blank(*at))
                    ++at;
                if (*at && *at != '\n' && *at != '#')
                    status = sr_fail(error, SR_ERROR_INPUT, "%s:%d: more than three numbers in a line", r->file, line);
            }
            ++layers.count;
        }
        while (status == SR_OK && *at && *at != '\n')
            ++at;
    }
    if (status == SR_OK && strlen(text) != size)
        status = sr_fail(error, SR_ERROR_INPUT, "%s: expected text, not binary data", r->file);
    sr_free(text);
    if (status != SR_OK)
        return status;
    r->given = sr_arena_copy(arena, &layers, sizeof layers);
    return r->given ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "%s: out of memory", r->file);
}

static inline struct film_stack stack_of_recipe(const struct recipe *r, sr_spectrum n, sr_spectrum k)
{
    struct film_stack f = {.n = n, .k = k};
    if (r->given) {
        f.film_count = f.layer_count = r->given->count;
        for (int i = 0; i < f.film_count; ++i) {
            f.films[i] = (struct film){SR_BLACK + r->given->n[i], SR_BLACK + r->given->k[i], r->given->thickness[i]};
            f.sequence[i] = (uint8_t)i;
        }
        return f;
    }
    f.film_count = 2;
    f.layer_count = r->layer_count < 0 ? 0 : r->layer_count > FILM_LAYERS ? FILM_LAYERS : r->layer_count;
    f.films[0] = (struct film){r->high_eta, SR_BLACK, r->high_thickness};
    f.films[1] = (struct film){r->low_eta, SR_BLACK, r->low_thickness};
    for (int i = 0; i < f.layer_count; ++i)
        f.sequence[i] = (uint8_t)(i & 1);
    return f;
}

#endif
