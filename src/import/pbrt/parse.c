/* SPDX-License-Identifier: MIT */
/* Files into directives: reads a file, finds each directive in the list, sees to it that it stands where it may. */
#include "import/pbrt/parser.h"

#include <string.h>

enum { MAX_DEPTH = 64 };
static const size_t max_text_B = (size_t)8 << 30;

/* ---- arguments ---- */

static sr_status wrong_argument(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token, const char *expected)
{
    if (token->kind == SR_PBRT_END)
        return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT, "%s: the file ends: expected %s",
                            p->directive, expected);
    const char *quote = token->kind == SR_PBRT_STRING ? "\"" : "";
    return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT, "%s: %s%.*s%s: expected %s", p->directive, quote,
                        token->length > 60 ? 60 : (int)token->length, token->text, quote, expected);
}

/* a string, alone or in brackets */
sr_status sr_pbrt_read_string(struct sr_pbrt_parser *p, const char *expected, const char **text)
{
    struct sr_pbrt_token token, close = {0};
    sr_status status = sr_pbrt_lexer_next(p->lexer, &token, p->error);
    bool has_bracket = status == SR_OK && token.kind == SR_PBRT_OPEN;
    if (has_bracket)
        status = sr_pbrt_lexer_next(p->lexer, &token, p->error);
    if (status == SR_OK && token.kind != SR_PBRT_STRING)
        return wrong_argument(p, &token, expected);
    if (status == SR_OK && has_bracket)
        status = sr_pbrt_lexer_next(p->lexer, &close, p->error);
    if (status == SR_OK && has_bracket && close.kind != SR_PBRT_CLOSE)
        return wrong_argument(p, &close, "] after one string");
    if (status != SR_OK)
        return status;
    *text = sr_pbrt_text(p->d, token.text, token.length);
    return *text ? SR_OK : sr_fail(p->error, SR_ERROR_RESOURCE, "%s: not enough memory", p->main_path);
}

sr_status sr_pbrt_read_numbers(struct sr_pbrt_parser *p, int count, double *values)
{
    struct sr_pbrt_token token;
    sr_status status = sr_pbrt_lexer_peek(p->lexer, &token, p->error);
    bool has_bracket = status == SR_OK && token.kind == SR_PBRT_OPEN;
    if (has_bracket)
        status = sr_pbrt_lexer_next(p->lexer, &token, p->error);
    for (int i = 0; i < count && status == SR_OK; ++i) {
        status = sr_pbrt_lexer_next(p->lexer, &token, p->error);
        if (status == SR_OK && !sr_pbrt_token_number(&token, &values[i])) {
            char expected[64] = "16 numbers";
            if (count < 10)
                memcpy(expected, (char[]){(char)('0' + count), ' ', 'n', 'u', 'm', 'b', 'e', 'r', 's', 0}, 10);
            return wrong_argument(p, &token, expected);
        }
    }
    if (status == SR_OK && has_bracket)
        status = sr_pbrt_lexer_next(p->lexer, &token, p->error);
    if (status == SR_OK && has_bracket && token.kind != SR_PBRT_CLOSE)
        return wrong_argument(p, &token, "] after the last number");
    return status;
}

sr_status sr_pbrt_read_entity(struct sr_pbrt_parser *p, const char *expected, struct sr_pbrt_params defaults,
                              struct sr_pbrt_entity *entity)
{
    *entity = (struct sr_pbrt_entity){.directive = p->directive, .where = p->where, .space = p->state.space};
    sr_status status = sr_pbrt_read_string(p, expected, &entity->model);
    if (status == SR_OK)
        status = sr_pbrt_params_read(p->d, p->lexer, &p->scratch, p->state.space, defaults, &entity->params, p->error);
    if (status == SR_OK && (entity->transform = sr_pbrt_store_transform(p)) == UINT32_MAX)
        status = p->error->status;
    return status;
}

/* ---- directives ---- */

static void copy_word(const struct sr_pbrt_token *token, char word[64])
{
    size_t n = token->length < 63 ? token->length : 63;
    memcpy(word, token->text, n);
    word[n] = 0;
}

static const struct sr_pbrt_directive *find_directive(const struct sr_pbrt_directive *d,
                                                      const struct sr_pbrt_token *token)
{
    while (d->word && (strlen(d->word) != token->length || memcmp(d->word, token->text, token->length) != 0))
        ++d;
    return d->word ? d : NULL;
}

static sr_status check_block(struct sr_pbrt_parser *p, const struct sr_pbrt_directive *d,
                             const struct sr_pbrt_token *token)
{
    if (d->block & (p->d->has_world ? SR_PBRT_IN_WORLD : SR_PBRT_IN_OPTIONS))
        return SR_OK;
    return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT,
                        p->d->has_world ? "%s may not stand after WorldBegin: expected before it"
                                        : "%s may not stand before WorldBegin: expected after it",
                        d->word);
}

static sr_status unknown_directive(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token)
{
    char word[64], buffer[160];
    copy_word(token, word);
    double number;
    if (sr_pbrt_token_number(token, &number))
        return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT,
                            "the number %s stands alone%s%s: expected a directive", word, p->directive ? " after " : "",
                            p->directive ? p->directive : "");
    struct sr_pbrt_suggestion s = {.word = word};
    for (const struct sr_pbrt_directive *d = sr_pbrt_directives; d->word; ++d)
        sr_pbrt_suggest(&s, d->word);
    return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT, "unknown directive %s%s", word,
                        sr_pbrt_suggestion_text(&s, buffer));
}

static sr_status read_directive(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token)
{
    if (token->kind != SR_PBRT_WORD)
        return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT,
                            "%s%.*s%s stands alone: expected a directive, such as Shape",
                            token->kind == SR_PBRT_STRING ? "\"" : "", token->length > 60 ? 60 : (int)token->length,
                            token->text, token->kind == SR_PBRT_STRING ? "\"" : "");
    const struct sr_pbrt_directive *d = find_directive(sr_pbrt_directives, token);
    if (!d)
        return unknown_directive(p, token);
    if (check_block(p, d, token) != SR_OK)
        return p->error->status;
    p->directive = d->word;
    p->where = token->where;
    return d->read(p);
}

/* ---- comments that are meant for this program ---- */

/* The rest of what an unknown word may have for arguments: to the next word that begins a line. */
static sr_status skip_annotation(struct sr_pbrt_lexer *lexer, int line, struct sr_error *error)
{
    struct sr_pbrt_token token;
    sr_status status;
    double number;
    while ((status = sr_pbrt_lexer_peek(lexer, &token, error)) == SR_OK && token.kind != SR_PBRT_END) {
        if (token.kind == SR_PBRT_WORD && token.where.line != line && !sr_pbrt_token_number(&token, &number))
            break;
        line = token.where.line;
        sr_pbrt_lexer_next(lexer, &token, error);
    }
    return status;
}

static sr_status read_annotation(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token)
{
    const struct sr_pbrt_directive *d = token->kind == SR_PBRT_WORD ? find_directive(sr_pbrt_annotations, token) : NULL;
    if (!d) {
        char word[64], buffer[160];
        copy_word(token, word);
        struct sr_pbrt_suggestion s = {.word = word};
        for (d = sr_pbrt_annotations; d->word; ++d)
            sr_pbrt_suggest(&s, d->word);
        sr_pbrt_warn(p->d, token->where, "#@ %s is not known, and stays a comment%s", word,
                     sr_pbrt_suggestion_text(&s, buffer));
        return skip_annotation(p->lexer, token->where.line, p->error);
    }
    if (check_block(p, d, token) != SR_OK)
        return p->error->status;
    p->directive = d->word;
    p->where = token->where;
    return d->read(p);
}

/* The comments #@ that have been passed since the last directive. */
static sr_status read_annotations(struct sr_pbrt_parser *p)
{
    struct sr_array passed = p->annotations; // lexers of the comments add none
    struct sr_pbrt_lexer *outer = p->lexer;
    const char *done = NULL;
    sr_status status = SR_OK;
    for (size_t i = 0; i < passed.count && status == SR_OK; ++i) {
        const struct sr_pbrt_annotation *a = SR_PBRT_AT(passed, struct sr_pbrt_annotation, i);
        if (done && a->p <= done)
            continue;
        struct sr_pbrt_lexer lexer = sr_pbrt_lexer_start_annotation(outer, a);
        struct sr_pbrt_token token;
        p->lexer = &lexer;
        while ((status = sr_pbrt_lexer_next(&lexer, &token, p->error)) == SR_OK && token.kind != SR_PBRT_END)
            if ((status = read_annotation(p, &token)) != SR_OK)
                break;
        done = lexer.p;
    }
    p->lexer = outer;
    p->annotations.count = 0;
    return status;
}

static sr_status read_text(struct sr_pbrt_parser *p, const char *path, const char *text, size_t size)
{
    struct sr_pbrt_lexer lexer = sr_pbrt_lexer_start(path, text, size, &p->d->words), *outer = p->lexer;
    struct sr_pbrt_token token;
    lexer.annotations = &p->annotations; // empty: those before an Include have been read
    p->lexer = &lexer;
    p->d->text_B += size;
    p->d->hash = sr_pbrt_hash(p->d->hash, text, size);
    sr_status status;
    while ((status = sr_pbrt_lexer_next(&lexer, &token, p->error)) == SR_OK) {
        if (p->annotations.count)
            status = read_annotations(p);
        if (status != SR_OK || token.kind == SR_PBRT_END || (status = read_directive(p, &token)) != SR_OK)
            break;
    }
    p->lexer = outer;
    return status;
}

/* ---- files ---- */

static struct sr_pbrt_file *add_file(struct sr_pbrt_parser *p, const char *path, struct sr_location from)
{
    struct sr_pbrt_file **slot = sr_array_push(&p->d->files, sizeof(struct sr_pbrt_file *));
    struct sr_pbrt_file *file = slot ? sr_pbrt_words(p->d, sizeof *file) : NULL;
    if (!file || !(file->path = sr_pbrt_text(p->d, path, strlen(path)))) {
        p->d->files.count -= slot != NULL;
        sr_fail(p->error, SR_ERROR_RESOURCE, "%s: not enough memory", path);
        return NULL;
    }
    *slot = file;
    file->from = from;
    return file;
}

static sr_status read_file(struct sr_pbrt_parser *p, struct sr_pbrt_file *file)
{
    char *text;
    size_t size;
    struct sr_error error = {0};
    sr_status status = sr_file_read(file->path, max_text_B, &text, &size, &error);
    if (status != SR_OK)
        return file->from.file ? sr_pbrt_fail(p->d, file->from, p->error, status, "%s", error.text)
                               : sr_fail(p->error, status, "%s", error.text);
    file->is_open = true;
    status = read_text(p, file->path, text, size);
    file->is_open = false;
    sr_free(text);
    return status;
}

/* Names count from the folder of the first file; where nothing is there, from the folder of the file that names it. */
sr_status sr_pbrt_include(struct sr_pbrt_parser *p, const char *name)
{
    char *path = sr_path_beside(&p->d->words, p->main_path, name);
    if (path && !sr_file_exists(path)) {
        char *nearer = sr_path_beside(&p->d->words, p->where.file, name);
        path = nearer && sr_file_exists(nearer) ? nearer : path;
    }
    if (!path)
        return sr_fail(p->error, SR_ERROR_RESOURCE, "%s: not enough memory", p->main_path);
    for (size_t i = 0; i < p->d->files.count; ++i) {
        const struct sr_pbrt_file *f = *SR_PBRT_AT(p->d->files, struct sr_pbrt_file *, i);
        if (f->is_open && strcmp(f->path, path) == 0)
            return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                                "%s \"%s\": this file is being read already, it includes itself", p->directive, name);
    }
    if (p->depth >= MAX_DEPTH)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT, "%s \"%s\": files are nested more than %d deep",
                            p->directive, name, MAX_DEPTH);
    if (p->d->files.count >= SR_PBRT_MAX_FILES)
        return sr_pbrt_fail(p->d, p->where, p->error, SR_ERROR_INPUT,
                            "%s \"%s\": more than %d files are included, each as often as it is", p->directive, name,
                            SR_PBRT_MAX_FILES);
    struct sr_pbrt_file *file = add_file(p, path, p->where);
    if (!file)
        return p->error->status;
    ++p->depth;
    sr_status status = read_file(p, file);
    --p->depth;
    return status;
}

/* ---- the whole ---- */

static sr_status start(struct sr_pbrt_parser *p, const char *path, struct sr_arena *data, struct sr_log *log,
                       struct sr_pbrt_description *d, struct sr_error *error)
{
    struct sr_matrix one = sr_matrix_identity();
    *p = (struct sr_pbrt_parser){.d = d, .error = error, .main_path = path};
    p->state = (struct sr_pbrt_state){.ctm = {one, one}, .at_start = true, .at_end = true, .space = SR_SRGB};
    return sr_pbrt_description_start(d, data, log) ? SR_OK
                                                   : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", path);
}

static sr_status finish(struct sr_pbrt_parser *p, sr_status status, const struct sr_pbrt_file *file)
{
    if (status == SR_OK && p->stack.count) {
        const struct sr_pbrt_saved_state *open = SR_PBRT_AT(p->stack, struct sr_pbrt_saved_state, p->stack.count - 1);
        status =
            sr_pbrt_fail(p->d, open->where, p->error, SR_ERROR_INPUT, "%s",
                         open->is_object ? "ObjectBegin without ObjectEnd" : "AttributeBegin without AttributeEnd");
    }
    if (status == SR_OK && !p->d->has_world)
        status = sr_fail(p->error, SR_ERROR_INPUT, "%s: the file ends before WorldBegin: expected a scene", file->path);
    if (status == SR_OK && p->shape_name)
        sr_pbrt_warn(p->d, p->shape_name_where, "#@ Name \"%s\": no shape comes after it", p->shape_name);
    sr_array_free(&p->annotations);
    sr_array_free(&p->stack);
    sr_array_free(&p->coordinates);
    sr_pbrt_scratch_free(&p->scratch);
    return status;
}

sr_status sr_pbrt_read(const char *path, struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                       struct sr_error *error)
{
    struct sr_pbrt_parser p;
    sr_status status = start(&p, path, data, log, out, error);
    struct sr_pbrt_file *file = status == SR_OK ? add_file(&p, path, (struct sr_location){0}) : NULL;
    return finish(&p, file ? read_file(&p, file) : error->status, file);
}

sr_status sr_pbrt_read_text(const char *label, const char *text, size_t size, struct sr_arena *data, struct sr_log *log,
                            struct sr_pbrt_description *out, struct sr_error *error)
{
    struct sr_pbrt_parser p;
    sr_status status = start(&p, label, data, log, out, error);
    struct sr_pbrt_file *file = status == SR_OK ? add_file(&p, label, (struct sr_location){0}) : NULL;
    return finish(&p, file ? read_text(&p, file->path, text, size) : error->status, file);
}
