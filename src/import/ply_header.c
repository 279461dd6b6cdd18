/* SPDX-License-Identifier: MIT */
/* Reading the head of a PLY file (Turk 1994): lines of words, from "ply" to "end_header". */
#include "import/ply_header.h"

#include <stdio.h>
#include <string.h>

enum { MAX_WORDS = 8, WORD_SIZE = 64 };

struct line {
    char words[MAX_WORDS][WORD_SIZE];
    int count;
    int number; // from 1
};

/* The next line's words; *at moves past it. false: no line end before the end of the data. */
static bool next_line(const char *data, size_t size, size_t *at, struct line *line)
{
    const char *newline = *at < size ? memchr(data + *at, '\n', size - *at) : NULL;
    if (!newline)
        return false;
    line->count = 0;
    ++line->number;
    const char *p = data + *at;
    while (p < newline) {
        while (p < newline && (*p == ' ' || *p == '\t' || *p == '\r'))
            ++p;
        size_t n = 0;
        char *word = line->count < MAX_WORDS ? line->words[line->count] : NULL;
        const char *start = p;
        for (; p < newline && *p != ' ' && *p != '\t' && *p != '\r'; ++p)
            if (word && n < WORD_SIZE - 1)
                word[n++] = *p;
        if (word)
            word[n] = 0;
        line->count += word && p > start;
    }
    for (int i = line->count; i < MAX_WORDS; ++i)
        line->words[i][0] = 0;
    *at = (size_t)(newline - data) + 1;
    return true;
}

static bool find_type(const char *word, enum sr_ply_type *type)
{
    static const struct {
        const char *word;
        enum sr_ply_type type;
    } words[] = {{"char", SR_PLY_INT8},      {"int8", SR_PLY_INT8},       {"uchar", SR_PLY_UINT8},
                 {"uint8", SR_PLY_UINT8},    {"short", SR_PLY_INT16},     {"int16", SR_PLY_INT16},
                 {"ushort", SR_PLY_UINT16},  {"uint16", SR_PLY_UINT16},   {"int", SR_PLY_INT32},
                 {"int32", SR_PLY_INT32},    {"uint", SR_PLY_UINT32},     {"uint32", SR_PLY_UINT32},
                 {"float", SR_PLY_FLOAT32},  {"float32", SR_PLY_FLOAT32}, {"double", SR_PLY_FLOAT64},
                 {"float64", SR_PLY_FLOAT64}};
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i)
        if (strcmp(word, words[i].word) == 0) {
            *type = words[i].type;
            return true;
        }
    return false;
}

static bool read_count(const char *word, uint64_t *count)
{
    *count = 0;
    for (const char *c = word; *c; ++c) {
        if (*c < '0' || *c > '9' || *count > (uint64_t)1 << 50)
            return false;
        *count = *count * 10 + (uint64_t)(*c - '0');
    }
    return *word != 0;
}

static sr_status read_element(const char *label, const struct line *l, struct sr_ply_header *h, struct sr_error *error)
{
    if (h->element_count == SR_PLY_MAX_ELEMENTS)
        return sr_fail(error, SR_ERROR_INPUT, "%s:%d: more than %d kinds of elements", label, l->number,
                       SR_PLY_MAX_ELEMENTS);
    struct sr_ply_element *e = &h->elements[h->element_count];
    *e = (struct sr_ply_element){0};
    if (l->count != 3 || strlen(l->words[1]) >= sizeof e->name || !read_count(l->words[2], &e->count))
        return sr_fail(error, SR_ERROR_INPUT, "%s:%d: expected \"element NAME COUNT\"", label, l->number);
    memcpy(e->name, l->words[1], strlen(l->words[1]) + 1);
    ++h->element_count;
    return SR_OK;
}

static sr_status read_property(const char *label, const struct line *l, struct sr_ply_header *h, struct sr_error *error)
{
    if (h->element_count == 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s:%d: a property before any element", label, l->number);
    struct sr_ply_element *e = &h->elements[h->element_count - 1];
    if (e->property_count == SR_PLY_MAX_PROPERTIES)
        return sr_fail(error, SR_ERROR_INPUT, "%s:%d: more than %d properties", label, l->number,
                       SR_PLY_MAX_PROPERTIES);
    struct sr_ply_property *p = &e->properties[e->property_count];
    *p = (struct sr_ply_property){.is_list = strcmp(l->words[1], "list") == 0, .offset = e->least_size};
    const char *name = l->words[p->is_list ? 4 : 2];
    bool ok = l->count == (p->is_list ? 5 : 3) && find_type(l->words[p->is_list ? 3 : 1], &p->type);
    if (p->is_list)
        ok = ok && find_type(l->words[2], &p->count_type) && p->count_type < SR_PLY_FLOAT32;
    if (!ok)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s:%d: expected \"property TYPE NAME\" or \"property list INTEGER_TYPE TYPE NAME\"", label,
                       l->number);
    snprintf(p->name, sizeof p->name, "%.31s", name);
    // in ascii each value takes at least one digit and one space
    e->least_size += h->format == SR_PLY_ASCII ? 2 : sr_ply_type_size(p->is_list ? p->count_type : p->type);
    e->list_count += p->is_list;
    ++e->property_count;
    return SR_OK;
}

sr_status sr_ply_header_read(const char *label, const char *data, size_t size, struct sr_ply_header *h,
                             struct sr_error *error)
{
    struct line l = {.count = 0};
    bool has_format = false;
    size_t at = 0;
    *h = (struct sr_ply_header){0};
    if (!next_line(data, size, &at, &l) || strcmp(l.words[0], "ply") != 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: expected a PLY file, which begins with the line \"ply\"", label);
    while (next_line(data, size, &at, &l)) {
        const char *word = l.words[0];
        sr_status status = SR_OK;
        if (strcmp(word, "format") == 0) {
            static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
            has_format = false;
            for (int i = 0; i < 3; ++i)
                if (strcmp(l.words[1], formats[i]) == 0) {
                    h->format = (enum sr_ply_format)i;
                    has_format = true;
                }
            if (!has_format || h->element_count)
                return sr_fail(
                    error, SR_ERROR_INPUT,
                    "%s:%d: expected \"format ascii|binary_little_endian|binary_big_endian 1.0\" before the elements",
                    label, l.number);
        } else if (strcmp(word, "element") == 0)
            status = read_element(label, &l, h, error);
        else if (strcmp(word, "property") == 0)
            status = read_property(label, &l, h, error);
        else if (strcmp(word, "end_header") == 0) {
            h->size = at;
            return has_format ? SR_OK
                              : sr_fail(error, SR_ERROR_INPUT, "%s: expected a line \"format …\" in the head", label);
        } else if (l.count && strcmp(word, "comment") != 0 && strcmp(word, "obj_info") != 0)
            return sr_fail(error, SR_ERROR_INPUT,
                           "%s:%d: unknown word in the head: expected format, comment, element, property or end_header",
                           label, l.number);
        if (status != SR_OK)
            return status;
        if (l.number > 4096)
            break;
    }
    return sr_fail(error, SR_ERROR_INPUT, "%s: the head is cut short: expected \"end_header\"", label);
}

int sr_ply_find_property(const struct sr_ply_element *element, const char *name)
{
    for (uint32_t i = 0; i < element->property_count; ++i)
        if (strcmp(element->properties[i].name, name) == 0)
            return (int)i;
    return -1;
}
