/* SPDX-License-Identifier: MIT */
/* Words, strings and brackets of a pbrt file in memory; comments run from # to the end of the line. "#@" and a blank
 * begin comments that are kept: what follows are directives that are ours alone, so that other readers skip them. */
#include "import/pbrt/lexer.h"

#include "import/number.h"

#include <string.h>

struct sr_pbrt_lexer sr_pbrt_lexer_start(const char *file, const char *text, size_t size, struct sr_arena *arena)
{
    const char *start = text;
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) // the mark that some editors write first
        start += 3;
    return (struct sr_pbrt_lexer){
        .file = file, .p = start, .end = text + size, .line_start = start, .line = 1, .arena = arena};
}

static struct sr_location location(const struct sr_pbrt_lexer *l, const char *p)
{
    return (struct sr_location){l->file, l->line, (int)(p - l->line_start) + 1};
}

struct sr_location sr_pbrt_lexer_number_where(const struct sr_pbrt_lexer *lexer)
{
    return location(lexer, lexer->number);
}

struct sr_pbrt_lexer sr_pbrt_lexer_start_annotation(const struct sr_pbrt_lexer *lexer,
                                                    const struct sr_pbrt_annotation *a)
{
    return (struct sr_pbrt_lexer){.file = lexer->file,
                                  .p = a->p,
                                  .end = lexer->end,
                                  .line_start = a->line_start,
                                  .line = a->line,
                                  .arena = lexer->arena,
                                  .is_annotation = true};
}

static bool is_annotation(const char *p)
{
    return p[0] == '#' && p[1] == '@' && (p[2] == ' ' || p[2] == '\t');
}

/* p at the # of a comment: the character before its line's end. */
static const char *skip_comment(struct sr_pbrt_lexer *l, const char *p)
{
    if (l->annotations && (l->keeps_comments || is_annotation(p))) {
        struct sr_pbrt_annotation *a = sr_array_push(l->annotations, sizeof *a);
        l->has_no_memory |= !a;
        if (a)
            *a = (struct sr_pbrt_annotation){l->keeps_comments ? p : p + 2, l->line_start, l->line};
    }
    const char *newline = memchr(p, '\n', (size_t)(l->end - p));
    return newline ? newline - 1 : l->end - 1;
}

/* p at a line's end within an annotation: behind the #@ of the next line, or NULL where there is none. */
static const char *next_annotation(const char *p)
{
    ++p;
    while (*p == ' ' || *p == '\t' || *p == '\r')
        ++p;
    return is_annotation(p) ? p + 2 : NULL;
}

/* to the next character that means something */
static inline void skip_space(struct sr_pbrt_lexer *l)
{
    const char *p = l->p;
    for (;; ++p) {
        char c = *p;
        if (c == ' ' || c == '\t' || c == '\r')
            continue;
        if (c == '\n') {
            const char *next = SR_UNLIKELY(l->is_annotation) ? next_annotation(p) : p + 1;
            if (!next)
                break;
            ++l->line;
            l->line_start = p + 1;
            p = next - 1;
        } else if (c == '#') {
            p = skip_comment(l, p);
        } else
            break;
    }
    l->p = p;
}

static inline bool ends_word(char c)
{
    return c == ' ' || c == '\n' || c == ']' || c == '\t' || c == '\r' || c == '[' || c == '"' || c == '#' || c == 0;
}

static char unescape(char c)
{
    switch (c) {
    case 'b':
        return '\b';
    case 'f':
        return '\f';
    case 'n':
        return '\n';
    case 'r':
        return '\r';
    case 't':
        return '\t';
    case '\\':
    case '\'':
    case '"':
        return c;
    default:
        return 0;
    }
}

static sr_status lex_string(struct sr_pbrt_lexer *l, struct sr_pbrt_token *token, struct sr_error *error)
{
    const char *start = l->p + 1, *p = start;
    bool has_escape = false;
    for (; *p != '"'; ++p) {
        if (*p == '\n' || p >= l->end)
            return sr_fail(error, SR_ERROR_INPUT, "%s:%d:%d: this string has no closing \" on its line", l->file,
                           token->where.line, token->where.column);
        if (*p == '\\') {
            struct sr_location where = location(l, p);
            has_escape = true;
            ++p;
            if (p >= l->end || !unescape(*p))
                return sr_fail(error, SR_ERROR_INPUT,
                               "%s:%d:%d: unknown escape in a string: expected \\b \\f \\n \\r \\t \\\\ \\' or \\\"",
                               l->file, where.line, where.column);
        }
    }
    token->kind = SR_PBRT_STRING;
    token->text = start;
    token->length = (size_t)(p - start);
    l->p = p + 1;
    if (has_escape) {
        char *copy = sr_arena_alloc(l->arena, token->length + 1), *to = copy;
        if (!copy)
            return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", l->file);
        for (const char *from = start; from < p; ++from)
            *to++ = *from == '\\' ? unescape(*++from) : *from;
        token->text = copy;
        token->length = (size_t)(to - copy);
    }
    return SR_OK;
}

sr_status sr_pbrt_lexer_next(struct sr_pbrt_lexer *l, struct sr_pbrt_token *token, struct sr_error *error)
{
    if (l->has_next) {
        l->has_next = false;
        *token = l->next_token;
        return SR_OK;
    }
    skip_space(l);
    if (SR_UNLIKELY(l->has_no_memory))
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", l->file);
    *token = (struct sr_pbrt_token){.text = l->p, .length = 1, .where = location(l, l->p)};
    switch (*l->p) {
    case '[':
        token->kind = SR_PBRT_OPEN;
        ++l->p;
        return SR_OK;
    case ']':
        token->kind = SR_PBRT_CLOSE;
        ++l->p;
        return SR_OK;
    case '"':
        return lex_string(l, token, error);
    case '\n': // of an annotation
        token->kind = SR_PBRT_END;
        token->length = 0;
        return SR_OK;
    case 0:
        if (l->p < l->end)
            return sr_fail(error, SR_ERROR_INPUT, "%s:%d:%d: a NUL byte in the text: this is not a pbrt file", l->file,
                           token->where.line, token->where.column);
        token->kind = SR_PBRT_END;
        token->length = 0;
        return SR_OK;
    default:
        token->kind = SR_PBRT_WORD;
        while (!ends_word(*l->p))
            ++l->p;
        token->length = (size_t)(l->p - token->text);
        return SR_OK;
    }
}

sr_status sr_pbrt_lexer_peek(struct sr_pbrt_lexer *l, struct sr_pbrt_token *token, struct sr_error *error)
{
    if (!l->has_next) {
        sr_status status = sr_pbrt_lexer_next(l, &l->next_token, error);
        if (status != SR_OK)
            return status;
        l->has_next = true;
    }
    *token = l->next_token;
    return SR_OK;
}

static const char *read_number(const char *p, double *value)
{
    const char *end = sr_number_read(p, value);
    if (SR_LIKELY(end && ends_word(*end)))
        return end;
    end = sr_number_read_hex(p, value);
    return end && ends_word(*end) ? end : NULL;
}

enum sr_pbrt_number_result sr_pbrt_lexer_number(struct sr_pbrt_lexer *l, double *value)
{
    if (SR_UNLIKELY(l->has_next)) {
        if (l->next_token.kind == SR_PBRT_CLOSE) {
            l->has_next = false;
            return SR_PBRT_IS_CLOSE;
        }
        if (l->next_token.kind != SR_PBRT_WORD || !sr_pbrt_token_number(&l->next_token, value))
            return SR_PBRT_IS_OTHER;
        l->has_next = false;
        l->number = l->next_token.text;
        return SR_PBRT_IS_NUMBER;
    }
    skip_space(l);
    l->number = l->p;
    const char *end = read_number(l->p, value);
    if (SR_LIKELY(end != NULL)) {
        l->p = end;
        return SR_PBRT_IS_NUMBER;
    }
    if (*l->p == ']') {
        ++l->p;
        return SR_PBRT_IS_CLOSE;
    }
    return SR_PBRT_IS_OTHER;
}

bool sr_pbrt_token_number(const struct sr_pbrt_token *token, double *value)
{
    return token->kind == SR_PBRT_WORD && read_number(token->text, value) == token->text + token->length;
}
