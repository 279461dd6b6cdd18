/* SPDX-License-Identifier: MIT */
/* A pbrt file, anew: the same directives in the same order with the same names and comments, in one form.
 *
 * Statement by statement, so that memory does not grow with the scene but for the text. Comments within a statement go
 * before it, directives in comments #@ behind it, where they were read as well. */
#include "import/pbrt/format.h"

#include "import/pbrt/statement.h"

#include <string.h>

enum { MAX_DEPTH = 64, WORDS_KEPT_B = 4 << 20 };
static const size_t max_text_B = (size_t)8 << 30;

struct formatter {
    struct sr_pbrt_parser p; // its description holds one statement
    struct sr_pbrt_description d;
    struct sr_arena data, keep; // of one statement; of all
    const struct sr_convert_options *o;
    struct sr_pbrt_upgrade upgrade;
    struct sr_print *out;
    bool is_moved; // the text will lie in another folder
    uint32_t mesh_count;
    int nesting;
    bool may_trail; // the line that was printed last belongs to the statement before the comment
};

static sr_status no_memory(struct formatter *f)
{
    return sr_fail(f->p.error, SR_ERROR_RESOURCE, "%s: not enough memory", f->p.main_path);
}

/* ---- names of files ---- */

/* The file that a name means is found as the reader finds it; NULL: there is none. */
static const char *find_file(struct formatter *f, const char *name, struct sr_location where)
{
    const char *path = sr_path_beside(&f->data, f->p.main_path, name);
    if (path && sr_file_exists(path))
        return path;
    path = where.file ? sr_path_beside(&f->data, where.file, name) : NULL;
    return path && sr_file_exists(path) ? path : NULL;
}

static const char *moved(struct formatter *f, const char *name, struct sr_location where)
{
    const char *path = f->is_moved && name[0] && name[0] != '/' ? find_file(f, name, where) : NULL,
               *text = path ? sr_path_seen_from(&f->data, f->o->out, path) : NULL;
    return text ? text : name;
}

static bool names_file(const struct sr_pbrt_statement *s, const struct sr_pbrt_param *p)
{
    static const char *const names[] = {"filename", "normalmap", "lensfile", "emissionfilename",
                                        "aperture", "mapname",   "bsdffile"};
    if (p->type == SR_PBRT_SPECTRUM)
        return p->is_text && sr_spd_named(p->strings[0]).kind == SR_SPD_NONE;
    if (p->type != SR_PBRT_STRING_TYPE || p->count != 1 || strcmp(s->word, "Film") == 0)
        return false;
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i)
        if (strcmp(p->name, names[i]) == 0)
            return true;
    return false;
}

static sr_status move_names(struct formatter *f, struct sr_pbrt_statement *s)
{
    for (uint32_t i = 0; i < s->params.count; ++i) {
        struct sr_pbrt_param *p = &s->params.items[i];
        const char **copy = names_file(s, p) ? sr_pbrt_words(&f->d, sizeof *copy) : NULL;
        if (!copy)
            continue;
        *copy = moved(f, p->strings[0], p->where);
        p->strings = copy;
    }
    return SR_OK;
}

/* ---- meshes ---- */

/* A large mesh becomes a file of its own, beside the text. */
static sr_status set_mesh_apart(struct formatter *f, struct sr_pbrt_statement *s)
{
    struct sr_print_mesh mesh;
    if (!f->o->ply_above || strcmp(s->word, "Shape") != 0 ||
        !sr_print_is_mesh(s->strings[0], &s->params, f->o->ply_above, &mesh))
        return SR_OK;
    const char *name = sr_convert_mesh_name(&f->data, f->o->out, ++f->mesh_count);
    return name ? sr_print_mesh_apart(&f->d, name, &mesh, &s->strings[0], &s->params, f->p.error) : no_memory(f);
}

/* ---- statements ---- */

static sr_status format_file(struct formatter *f, const char *path, struct sr_location from);

static sr_status include(struct formatter *f, const char *name, struct sr_location where, bool is_import)
{
    const char *path = find_file(f, name, where), *kept = sr_arena_string(&f->keep, path ? path : name);
    if (!kept)
        return no_memory(f);
    if (f->nesting >= MAX_DEPTH)
        return sr_pbrt_fail(&f->d, where, f->p.error, SR_ERROR_INPUT, "\"%s\": files are nested more than %d deep",
                            name, MAX_DEPTH);
    for (size_t i = 0; i < f->d.files.count; ++i) {
        const struct sr_pbrt_file *file = *SR_PBRT_AT(f->d.files, struct sr_pbrt_file *, i);
        if (file->is_open && strcmp(file->path, kept) == 0)
            return sr_pbrt_fail(&f->d, where, f->p.error, SR_ERROR_INPUT,
                                "\"%s\": this file is being read already, it includes itself", name);
    }
    if (f->d.files.count >= SR_PBRT_MAX_FILES)
        return sr_pbrt_fail(&f->d, where, f->p.error, SR_ERROR_INPUT,
                            "\"%s\": more than %d files are included, each as often as it is", name, SR_PBRT_MAX_FILES);
    int depth = f->out->depth;
    if (is_import) { // what it changes ends with it
        sr_print_line(f->out, 0);
        sr_print_word(f->out, "AttributeBegin\n");
        ++f->out->depth;
    }
    sr_status status = format_file(f, kept, where);
    if (is_import && status == SR_OK && f->out->depth != depth + 1)
        return sr_pbrt_fail(&f->d, where, f->p.error, SR_ERROR_INPUT,
                            "Import \"%s\": expected as many AttributeEnd as AttributeBegin in the file", name);
    if (is_import) {
        --f->out->depth;
        sr_print_line(f->out, 0);
        sr_print_word(f->out, "AttributeEnd\n");
    }
    return status;
}

static bool ends_with(const char *word, const char *end)
{
    size_t n = strlen(word), m = strlen(end);
    return n >= m && strcmp(word + n - m, end) == 0;
}

static sr_status upgrade(struct formatter *f, struct sr_pbrt_statement *s)
{
    f->upgrade.s = s;
    return sr_pbrt_upgrade(&f->upgrade);
}

static sr_status print_statement(struct formatter *f, struct sr_pbrt_statement *s)
{
    bool is_include = strcmp(s->word, "Include") == 0, is_import = strcmp(s->word, "Import") == 0;
    f->may_trail = false;
    if ((is_include || is_import) && f->o->flattens) {
        const char *name = sr_arena_string(&f->keep, s->strings[0]);
        return name ? include(f, name, s->where, is_import) : no_memory(f);
    }
    if (is_include || is_import)
        s->strings[0] = moved(f, s->strings[0], s->where);
    sr_status status = move_names(f, s);
    if (status == SR_OK && f->o->upgrades)
        status = upgrade(f, s);
    if (status == SR_OK)
        status = set_mesh_apart(f, s);
    if (status != SR_OK || s->is_dropped || strcmp(s->word, "WorldEnd") == 0)
        return status;
    bool is_world = strcmp(s->word, "WorldBegin") == 0;
    if (ends_with(s->word, "End") && --f->out->depth < 0)
        return sr_pbrt_fail(&f->d, s->where, f->p.error, SR_ERROR_INPUT, "%s without %.*sBegin before it", s->word,
                            (int)strlen(s->word) - 3, s->word);
    sr_pbrt_statement_print(f->out, s);
    f->may_trail = true;
    f->out->depth += ends_with(s->word, "Begin") && !is_world;
    return f->out->has_failed ? no_memory(f) : SR_OK;
}

/* ---- comments and blank lines ---- */

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static bool has_blank_line_before(const char *start, const char *p)
{
    int lines = 0;
    for (; p > start && (is_blank(p[-1]) || p[-1] == '\n'); --p)
        lines += p[-1] == '\n';
    return p > start && lines >= 2;
}

static bool begins_line(const char *start, const char *p)
{
    while (p > start && is_blank(p[-1]))
        --p;
    return p == start || p[-1] == '\n';
}

static void print_blank_line(struct sr_print *out)
{
    if (out->size > 1 && !(out->text[out->size - 1] == '\n' && out->text[out->size - 2] == '\n'))
        sr_print_word(out, "\n");
}

static size_t comment_length(const char *p)
{
    size_t n = strcspn(p, "\n");
    while (n > 0 && is_blank(p[n - 1]))
        --n;
    return n;
}

static void print_comment(struct formatter *f, const char *start, const char *p, bool is_behind)
{
    struct sr_print *out = f->out;
    if (is_behind && f->may_trail && !begins_line(start, p)) {
        out->size -= 1; // the end of the line
        sr_print_word(out, " ");
    } else {
        if (is_behind && has_blank_line_before(start, p))
            print_blank_line(out);
        sr_print_line(out, 0);
    }
    sr_print_bytes(out, p, comment_length(p));
    sr_print_word(out, "\n");
    f->may_trail = false;
}

static bool is_annotation(const char *p)
{
    return p[1] == '@' && (p[2] == ' ' || p[2] == '\t');
}

/* The directives of a comment #@ and of those right below it; where they end. */
static sr_status print_annotation(struct formatter *f, const char *start, const struct sr_pbrt_annotation *comment,
                                  const char **end)
{
    struct sr_pbrt_annotation a = {comment->p + 2, comment->line_start, comment->line};
    struct sr_pbrt_lexer lexer = sr_pbrt_lexer_start_annotation(f->p.lexer, &a), *outer = f->p.lexer;
    struct sr_pbrt_token token;
    sr_status status;
    if (has_blank_line_before(start, comment->p))
        print_blank_line(f->out);
    f->p.lexer = &lexer;
    while ((status = sr_pbrt_lexer_next(&lexer, &token, f->p.error)) == SR_OK && token.kind != SR_PBRT_END) {
        struct sr_pbrt_statement s;
        if (!sr_pbrt_statement_is_known(&token, true)) { // stays a comment, to the end of its line
            size_t n = comment_length(token.text);
            sr_print_line(f->out, 0);
            sr_print_word(f->out, "#@ ");
            sr_print_bytes(f->out, token.text, n);
            sr_print_word(f->out, "\n");
            lexer.p = token.text + n;
            continue;
        }
        if ((status = sr_pbrt_statement_read(&f->p, &token, true, &s)) != SR_OK ||
            (status = print_statement(f, &s)) != SR_OK)
            break;
    }
    f->p.lexer = outer;
    *end = lexer.p;
    f->may_trail = false;
    return status;
}

/* Comments that have been passed: those among a statement's words, or those behind it. */
static sr_status print_comments(struct formatter *f, const char *start, const struct sr_pbrt_annotation *c,
                                size_t count, bool is_behind)
{
    const char *done = NULL;
    for (size_t i = 0; i < count; ++i) {
        if (done && c[i].p < done)
            continue;
        if (!is_annotation(c[i].p))
            print_comment(f, start, c[i].p, is_behind);
        else if (print_annotation(f, start, &c[i], &done) != SR_OK)
            return f->p.error->status;
    }
    return SR_OK;
}

/* How many of the comments lie between a statement's words, with the next statement at `next`. */
static size_t count_inner(const struct sr_pbrt_annotation *c, size_t count, const char *next)
{
    while (count > 0) {
        const char *p = c[count - 1].p + strcspn(c[count - 1].p, "\n");
        while (p < next && (is_blank(*p) || *p == '\n'))
            ++p;
        if (p < next)
            return count;
        next = c[--count].p;
    }
    return 0;
}

/* ---- files ---- */

static void forget_statement(struct formatter *f)
{
    if (f->d.words.total > WORDS_KEPT_B) {
        sr_arena_free(&f->d.words);
        f->d.chunk = NULL;
        f->d.chunk_left = 0;
    }
    sr_arena_free(&f->data);
}

static sr_status format_text(struct formatter *f, const char *path, const char *text, size_t size)
{
    struct sr_array comments = {0};
    struct sr_pbrt_lexer lexer = sr_pbrt_lexer_start(path, text, size, &f->d.words), *outer = f->p.lexer;
    struct sr_pbrt_token token;
    lexer.annotations = &comments;
    lexer.keeps_comments = true;
    f->p.lexer = &lexer;
    f->may_trail = false;
    sr_status status = sr_pbrt_lexer_peek(&lexer, &token, f->p.error);
    if (status == SR_OK)
        status = print_comments(f, text, comments.data, comments.count, true);
    while (status == SR_OK && (status = sr_pbrt_lexer_next(&lexer, &token, f->p.error)) == SR_OK &&
           token.kind != SR_PBRT_END) {
        const char *at = token.text - (token.kind == SR_PBRT_STRING);
        struct sr_pbrt_statement s;
        struct sr_pbrt_token next;
        comments.count = 0;
        if ((status = sr_pbrt_statement_read(&f->p, &token, false, &s)) != SR_OK ||
            (status = sr_pbrt_lexer_peek(&lexer, &next, f->p.error)) != SR_OK)
            break;
        if (has_blank_line_before(text, at))
            print_blank_line(f->out);
        struct sr_pbrt_annotation *c = comments.data;
        size_t inner = count_inner(c, comments.count, next.text);
        for (size_t i = 0; i < inner; ++i)
            if (!is_annotation(c[i].p))
                print_comment(f, text, c[i].p, false);
        status = print_statement(f, &s);
        for (size_t i = 0; i < inner && status == SR_OK; ++i)
            if (is_annotation(c[i].p) && (i == 0 || !is_annotation(c[i - 1].p)))
                status = print_comments(f, text, &c[i], 1, true);
        if (status == SR_OK)
            status = print_comments(f, text, c + inner, comments.count - inner, true);
        if (next.kind != SR_PBRT_STRING) // which may lie in the words
            forget_statement(f);
    }
    f->p.lexer = outer;
    sr_array_free(&comments);
    return status;
}

static sr_status format_file(struct formatter *f, const char *path, struct sr_location from)
{
    struct sr_pbrt_file **slot = sr_array_push(&f->d.files, sizeof *slot),
                        *file = sr_arena_alloc(&f->keep, sizeof *file);
    char *text;
    size_t size;
    struct sr_error error = {0};
    if (!slot || !file)
        return no_memory(f);
    *slot = file;
    *file = (struct sr_pbrt_file){.path = path, .from = from, .is_open = true};
    sr_status status = sr_file_read(path, max_text_B, &text, &size, &error);
    if (status != SR_OK)
        return from.file ? sr_pbrt_fail(&f->d, from, f->p.error, status, "%s", error.text)
                         : sr_fail(f->p.error, status, "%s", error.text);
    ++f->nesting;
    status = format_text(f, path, text, size);
    --f->nesting;
    file->is_open = false;
    sr_free(text);
    return status;
}

sr_status sr_pbrt_format(const char *path, const struct sr_convert_options *o, struct sr_print *out, struct sr_log *log,
                         struct sr_error *error)
{
    struct formatter f = {.o = o, .out = out};
    f.d = (struct sr_pbrt_description){.data = &f.data, .log = log};
    f.p = (struct sr_pbrt_parser){.d = &f.d, .error = error, .main_path = path};
    f.d.reads_v3 = o->upgrades;
    f.upgrade = (struct sr_pbrt_upgrade){.p = &f.p, .out = out, .for_steradian = o->for_steradian, .arena = &f.keep};
    f.is_moved = !sr_path_same_folder(path, o->out);
    sr_status status = format_file(&f, path, (struct sr_location){0});
    if (status == SR_OK && out->depth != 0)
        status = sr_fail(
            error, SR_ERROR_INPUT,
            "%s: the file ends, and not all of AttributeBegin, ObjectBegin and TransformBegin have their end", path);
    sr_array_free(&f.upgrade.renamed);
    sr_pbrt_scratch_free(&f.p.scratch);
    sr_arena_free(&f.data);
    sr_arena_free(&f.keep);
    sr_pbrt_description_free(&f.d);
    return status;
}
