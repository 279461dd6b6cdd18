/* SPDX-License-Identifier: MIT */
/* Reading parameter lists: the declaration, then as many values as its type asks for.
 *
 * float, point, normal, rgb, spectrum and blackbody values become floats, integers and booleans int32, the rest
 * strings. */
#include "import/pbrt/params.h"

#include <limits.h>
#include <string.h>

enum storage { FLOATS, INTS, BOOLS, STRINGS };

static const struct type_row {
    const char *word;
    enum sr_pbrt_type type;
    enum storage storage;
    uint32_t arity; // values of one item
} types[] = {
    {"float", SR_PBRT_FLOAT, FLOATS, 1},
    {"integer", SR_PBRT_INTEGER, INTS, 1},
    {"point3", SR_PBRT_POINT3, FLOATS, 3},
    {"string", SR_PBRT_STRING_TYPE, STRINGS, 1},
    {"rgb", SR_PBRT_RGB, FLOATS, 3},
    {"texture", SR_PBRT_TEXTURE, STRINGS, 1},
    {"bool", SR_PBRT_BOOL, BOOLS, 1},
    {"spectrum", SR_PBRT_SPECTRUM, FLOATS, 2},
    {"blackbody", SR_PBRT_BLACKBODY, FLOATS, 1},
    {"normal", SR_PBRT_NORMAL, FLOATS, 3},
    {"normal3", SR_PBRT_NORMAL, FLOATS, 3},
    {"point2", SR_PBRT_POINT2, FLOATS, 2},
    {"vector2", SR_PBRT_VECTOR2, FLOATS, 2},
    {"vector3", SR_PBRT_VECTOR3, FLOATS, 3},
    {"point", SR_PBRT_POINT3, FLOATS, 3},
    {"vector", SR_PBRT_VECTOR3, FLOATS, 3},
    {NULL, 0, 0, 0},
};
static const struct type_row v3_types[] = {
    {"color", SR_PBRT_RGB, FLOATS, 3},
    {"xyz", SR_PBRT_RGB, FLOATS, 3},
    {NULL, 0, 0, 0},
};

const char *sr_pbrt_type_name(enum sr_pbrt_type type)
{
    for (const struct type_row *t = types; t->word; ++t)
        if (t->type == type)
            return t->word;
    return "?";
}

void sr_pbrt_scratch_free(struct sr_pbrt_scratch *s)
{
    sr_array_free(&s->floats);
    sr_array_free(&s->ints);
    sr_array_free(&s->strings);
    sr_array_free(&s->params);
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t';
}

static const struct type_row *find_type(const struct type_row *t, const char *word, size_t length)
{
    while (t->word && !(strlen(t->word) == length && memcmp(t->word, word, length) == 0))
        ++t;
    return t->word ? t : NULL;
}

/* "type name" into its two words */
static sr_status split_declaration(struct sr_pbrt_description *d, const struct sr_pbrt_token *token,
                                   struct sr_pbrt_param *p, const struct type_row **row, struct sr_error *error)
{
    const char *a = token->text, *end = token->text + token->length;
    while (a < end && is_space(*a))
        ++a;
    const char *b = a;
    while (b < end && !is_space(*b))
        ++b;
    const char *c = b;
    while (c < end && is_space(*c))
        ++c;
    const char *name_end = c;
    while (name_end < end && !is_space(*name_end))
        ++name_end;
    const char *rest = name_end;
    while (rest < end && is_space(*rest))
        ++rest;
    if (a == b || c == name_end || rest != end)
        return sr_pbrt_fail(d, token->where, error, SR_ERROR_INPUT,
                            "parameter \"%.*s\": expected \"type name\", such as \"float radius\"",
                            token->length > 80 ? 80 : (int)token->length, token->text);
    *row = find_type(types, a, (size_t)(b - a));
    if (!*row && d->reads_v3)
        *row = find_type(v3_types, a, (size_t)(b - a));
    if (*row) {
        p->type = (*row)->type;
        p->where = token->where;
        p->name = sr_pbrt_text(d, c, (size_t)(name_end - c));
        return p->name ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", token->where.file);
    }
    char buffer[160], word[64];
    size_t n = (size_t)(b - a) < sizeof word - 1 ? (size_t)(b - a) : sizeof word - 1;
    memcpy(word, a, n);
    word[n] = 0;
    struct sr_pbrt_suggestion s = {.word = word};
    for (const struct type_row *t = types; t->word; ++t)
        sr_pbrt_suggest(&s, t->word);
    return sr_pbrt_fail(d, token->where, error, SR_ERROR_INPUT,
                        "unknown parameter type \"%s\"; expected bool, float, integer, point2, point3, vector2, "
                        "vector3, normal, string, "
                        "texture, rgb, blackbody or spectrum%s",
                        word, sr_pbrt_suggestion_text(&s, buffer));
}

static sr_status no_memory(const struct sr_pbrt_param *p, struct sr_error *error)
{
    return sr_fail(error, SR_ERROR_RESOURCE, "%s:%d:%d: not enough memory for the values of \"%s\"", p->where.file,
                   p->where.line, p->where.column, p->name);
}

static sr_status wrong_value(struct sr_pbrt_description *d, const struct sr_pbrt_param *p,
                             const struct sr_pbrt_token *token, const char *expected, struct sr_error *error)
{
    int length = token->length > 60 ? 60 : (int)token->length;
    if (token->kind == SR_PBRT_END)
        return sr_pbrt_fail(d, token->where, error, SR_ERROR_INPUT,
                            "the file ends among the values of \"%s %s\": expected %s", sr_pbrt_type_name(p->type),
                            p->name, expected);
    const char *quote = token->kind == SR_PBRT_STRING ? "\"" : "";
    return sr_pbrt_fail(d, token->where, error, SR_ERROR_INPUT, "%s%.*s%s is no value for \"%s %s\": expected %s",
                        quote, length, token->text, quote, sr_pbrt_type_name(p->type), p->name, expected);
}

static sr_status push_number(struct sr_pbrt_description *d, const struct sr_pbrt_param *p, enum storage storage,
                             double value, struct sr_pbrt_scratch *s, struct sr_location where, struct sr_error *error)
{
    if (storage == FLOATS) {
        float *f = sr_array_push(&s->floats, sizeof *f);
        if (!f)
            return no_memory(p, error);
        *f = (float)value;
        return SR_OK;
    }
    if (!(value >= INT32_MIN && value <= INT32_MAX && value == (double)(int32_t)value))
        return sr_pbrt_fail(d, where, error, SR_ERROR_INPUT,
                            "%.9g is no value for \"integer %s\": expected a whole number of 32 bits", value, p->name);
    int32_t *i = sr_array_push(&s->ints, sizeof *i);
    if (!i)
        return no_memory(p, error);
    *i = (int32_t)value;
    return SR_OK;
}

/* one value that is a token of its own: a string, true or false, or a single number */
static sr_status read_token_value(struct sr_pbrt_description *d, struct sr_pbrt_param *p, enum storage *storage,
                                  const struct sr_pbrt_token *token, struct sr_pbrt_scratch *s, struct sr_error *error)
{
    double number;
    if (*storage == FLOATS && p->type == SR_PBRT_SPECTRUM && token->kind == SR_PBRT_STRING && s->floats.count == 0)
        *storage = STRINGS; // by name
    switch (*storage) {
    case STRINGS: {
        if (token->kind != SR_PBRT_STRING)
            return wrong_value(d, p, token, "a string in quotes", error);
        const char **text = sr_array_push(&s->strings, sizeof *text);
        if (!text || !(*text = sr_pbrt_text(d, token->text, token->length)))
            return no_memory(p, error);
        return SR_OK;
    }
    case BOOLS: {
        bool is_true = token->length == 4 && memcmp(token->text, "true", 4) == 0;
        bool is_false = token->length == 5 && memcmp(token->text, "false", 5) == 0;
        if (token->kind == SR_PBRT_OPEN || token->kind == SR_PBRT_END || (!is_true && !is_false))
            return wrong_value(d, p, token, "true or false", error);
        int32_t *value = sr_array_push(&s->ints, sizeof *value);
        if (!value)
            return no_memory(p, error);
        *value = is_true;
        return SR_OK;
    }
    default:
        if (!sr_pbrt_token_number(token, &number))
            return wrong_value(d, p, token,
                               p->type == SR_PBRT_SPECTRUM ? "a number or the name of a spectrum" : "a number", error);
        return push_number(d, p, *storage, number, s, token->where, error);
    }
}

/* numbers between brackets, the quick way; stops at the bracket, or at what is no number */
static sr_status read_numbers(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer, struct sr_pbrt_param *p,
                              enum storage storage, struct sr_pbrt_scratch *s, bool *is_closed, struct sr_error *error)
{
    double value;
    enum sr_pbrt_number_result r;
    if (storage == FLOATS) {
        while ((r = sr_pbrt_lexer_number(lexer, &value)) == SR_PBRT_IS_NUMBER) {
            if (SR_UNLIKELY(s->floats.count == s->floats.capacity) &&
                !sr_array_reserve(&s->floats, s->floats.count + 1, sizeof(float)))
                return no_memory(p, error);
            ((float *)s->floats.data)[s->floats.count++] = (float)value;
        }
    } else {
        while ((r = sr_pbrt_lexer_number(lexer, &value)) == SR_PBRT_IS_NUMBER) {
            sr_status status = push_number(d, p, storage, value, s, sr_pbrt_lexer_number_where(lexer), error);
            if (SR_UNLIKELY(status != SR_OK))
                return status;
        }
    }
    *is_closed = r == SR_PBRT_IS_CLOSE;
    return SR_OK;
}

static sr_status read_values(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer, struct sr_pbrt_param *p,
                             enum storage *storage, struct sr_pbrt_scratch *s, struct sr_error *error)
{
    struct sr_pbrt_token token;
    s->floats.count = s->ints.count = s->strings.count = 0;
    sr_status status = sr_pbrt_lexer_next(lexer, &token, error);
    if (status == SR_OK && token.kind != SR_PBRT_OPEN)
        return read_token_value(d, p, storage, &token, s, error);
    bool is_closed = false;
    while (status == SR_OK && !is_closed) {
        if (*storage == FLOATS || *storage == INTS)
            status = read_numbers(d, lexer, p, *storage, s, &is_closed, error);
        if (status == SR_OK && !is_closed)
            status = sr_pbrt_lexer_next(lexer, &token, error);
        if (status == SR_OK && !is_closed && !(is_closed = token.kind == SR_PBRT_CLOSE))
            status = read_token_value(d, p, storage, &token, s, error);
    }
    return status;
}

/* From the scratch to where it stays, with 16 readable bytes behind. */
static sr_status keep_values(struct sr_pbrt_description *d, struct sr_pbrt_param *p, enum storage storage,
                             const struct sr_pbrt_scratch *s, struct sr_error *error)
{
    const struct sr_array *from = storage == FLOATS ? &s->floats : storage == STRINGS ? &s->strings : &s->ints;
    size_t size = from->count * (storage == FLOATS    ? sizeof(float)
                                 : storage == STRINGS ? sizeof(char *)
                                                      : sizeof(int32_t));
    if (from->count > INT32_MAX)
        return sr_pbrt_fail(d, p->where, error, SR_ERROR_INPUT, "\"%s\" has %zu values; expected at most 2147483647",
                            p->name, from->count);
    void *to = sr_pbrt_words(d, size + 16);
    if (!to)
        return no_memory(p, error);
    if (size)
        memcpy(to, from->data, size);
    p->count = (uint32_t)from->count;
    p->floats = storage == FLOATS ? to : NULL;
    p->strings = storage == STRINGS ? to : NULL;
    p->ints = storage == INTS || storage == BOOLS ? to : NULL;
    p->is_text = p->type == SR_PBRT_SPECTRUM && storage == STRINGS;
    return SR_OK;
}

static sr_status check_values(struct sr_pbrt_description *d, const struct sr_pbrt_param *p, uint32_t arity,
                              struct sr_error *error)
{
    const char *type = sr_pbrt_type_name(p->type);
    if (p->is_text && p->count != 1)
        return sr_pbrt_fail(d, p->where, error, SR_ERROR_INPUT, "\"%s %s\" has %u names: expected one", type, p->name,
                            p->count);
    if (!p->is_text && p->count % arity != 0)
        return sr_pbrt_fail(d, p->where, error, SR_ERROR_INPUT, "\"%s %s\" has %u values: expected a multiple of %u",
                            type, p->name, p->count, arity);
    if (p->count == 0 && (p->type == SR_PBRT_RGB || p->type == SR_PBRT_BLACKBODY || p->type == SR_PBRT_SPECTRUM))
        return sr_pbrt_fail(d, p->where, error, SR_ERROR_INPUT, "\"%s %s\" has no values", type, p->name);
    if (p->type == SR_PBRT_RGB)
        for (uint32_t i = 0; i < p->count; ++i)
            if (!(p->floats[i] >= 0))
                return sr_pbrt_fail(d, p->where, error, SR_ERROR_INPUT,
                                    "\"rgb %s\" has the component %g: expected 0 or more", p->name,
                                    (double)p->floats[i]);
    for (uint32_t i = 0; p->type == SR_PBRT_SPECTRUM && !p->is_text && i + 2 < p->count; i += 2)
        if (!(p->floats[i] < p->floats[i + 2]))
            return sr_pbrt_fail(d, p->where, error, SR_ERROR_INPUT,
                                "\"spectrum %s\" has the wavelength %g after %g: expected pairs of wavelength (nm, "
                                "increasing) and value",
                                p->name, (double)p->floats[i + 2], (double)p->floats[i]);
    return SR_OK;
}

/* what sRGB cannot show is cut off */
static void xyz_to_rgb(struct sr_array *values)
{
    const struct sr_colour_space *space = sr_colour_space(SR_SRGB);
    float *v = values->data;
    for (size_t i = 0; i + 2 < values->count; i += 3) {
        double xyz[3] = {(double)v[i], (double)v[i + 1], (double)v[i + 2]};
        for (int k = 0; k < 3; ++k) {
            const double *row = space->rgb_from_xyz[k];
            double c = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
            v[i + (size_t)k] = c > 0 ? (float)c : 0;
        }
    }
}

static sr_status read_param(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer, struct sr_pbrt_scratch *scratch,
                            enum sr_colour_space_id space, struct sr_pbrt_param *p, struct sr_error *error)
{
    struct sr_pbrt_token token;
    const struct type_row *row = NULL;
    sr_status status = sr_pbrt_lexer_next(lexer, &token, error);
    if (status == SR_OK)
        status = split_declaration(d, &token, p, &row, error);
    if (status != SR_OK)
        return status;
    p->space = space;
    enum storage storage = row->storage;
    status = read_values(d, lexer, p, &storage, scratch, error);
    if (status == SR_OK && row == &v3_types[1])
        xyz_to_rgb(&scratch->floats);
    if (status == SR_OK)
        status = keep_values(d, p, storage, scratch, error);
    return status == SR_OK ? check_values(d, p, row->arity, error) : status;
}

sr_status sr_pbrt_params_read(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer,
                              struct sr_pbrt_scratch *scratch, enum sr_colour_space_id space,
                              struct sr_pbrt_params defaults, struct sr_pbrt_params *out, struct sr_error *error)
{
    scratch->params.count = 0;
    struct sr_pbrt_token token;
    sr_status status;
    while ((status = sr_pbrt_lexer_peek(lexer, &token, error)) == SR_OK && token.kind == SR_PBRT_STRING) {
        struct sr_pbrt_param p = {0};
        status = read_param(d, lexer, scratch, space, &p, error);
        if (status != SR_OK)
            return status;
        struct sr_pbrt_param *earlier = scratch->params.data, *slot = NULL;
        for (size_t i = 0; i < scratch->params.count && !slot; ++i)
            slot = strcmp(earlier[i].name, p.name) == 0 ? &earlier[i] : NULL;
        if (slot)
            sr_pbrt_warn(d, p.where, "\"%s\" is given twice (first at line %d): the last one counts", p.name,
                         slot->where.line);
        else
            slot = sr_array_push(&scratch->params, sizeof *slot);
        if (!slot)
            return no_memory(&p, error);
        *slot = p;
    }
    if (status != SR_OK)
        return status;
    size_t own = scratch->params.count, count = own + defaults.count;
    *out = (struct sr_pbrt_params){NULL, (uint32_t)count};
    if (count == 0)
        return SR_OK;
    out->items = sr_pbrt_words(d, count * sizeof *out->items);
    if (!out->items)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", lexer->file);
    if (own)
        memcpy(out->items, scratch->params.data, own * sizeof *out->items);
    out->count = (uint32_t)own;
    for (size_t i = 0; i < defaults.count; ++i) {
        bool is_shadowed = false;
        for (size_t k = 0; k < own && !is_shadowed; ++k)
            is_shadowed = strcmp(out->items[k].name, defaults.items[i].name) == 0;
        if (is_shadowed)
            continue;
        struct sr_pbrt_param *p = &out->items[out->count++];
        *p = defaults.items[i];
        p->is_default = true;
        p->used = false;
    }
    return SR_OK;
}

sr_status sr_pbrt_option_read(struct sr_pbrt_description *d, struct sr_pbrt_lexer *lexer,
                              struct sr_pbrt_scratch *scratch, struct sr_pbrt_params *out, struct sr_error *error)
{
    struct sr_pbrt_token token, value;
    sr_status status = sr_pbrt_lexer_peek(lexer, &token, error);
    if (status != SR_OK || token.kind != SR_PBRT_STRING || memchr(token.text, ' ', token.length))
        return status != SR_OK
                   ? status
                   : sr_pbrt_params_read(d, lexer, scratch, SR_SRGB, (struct sr_pbrt_params){NULL, 0}, out, error);
    sr_pbrt_lexer_next(lexer, &token, error);
    struct sr_pbrt_param p = {.where = token.where, .name = sr_pbrt_text(d, token.text, token.length)};
    *out = (struct sr_pbrt_params){sr_pbrt_words(d, sizeof p), 1};
    if (!p.name || !out->items)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", lexer->file);
    if ((status = sr_pbrt_lexer_peek(lexer, &value, error)) != SR_OK)
        return status;
    double number;
    bool is_number = sr_pbrt_token_number(&value, &number),
         is_whole = is_number && !memchr(value.text, '.', value.length);
    p.type = value.kind == SR_PBRT_STRING ? SR_PBRT_STRING_TYPE
             : is_whole                   ? SR_PBRT_INTEGER
             : is_number                  ? SR_PBRT_FLOAT
                                          : SR_PBRT_BOOL;
    enum storage storage = p.type == SR_PBRT_STRING_TYPE ? STRINGS
                           : p.type == SR_PBRT_INTEGER   ? INTS
                           : p.type == SR_PBRT_FLOAT     ? FLOATS
                                                         : BOOLS;
    status = read_values(d, lexer, &p, &storage, scratch, error);
    if (status == SR_OK)
        status = keep_values(d, &p, storage, scratch, error);
    out->items[0] = p;
    return status;
}
