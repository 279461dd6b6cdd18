/* SPDX-License-Identifier: MIT */
/* Which arguments each directive takes; reading them, printing them. */
#include "import/pbrt/statement.h"

#include <string.h>

enum { CTM = 16, IN_TEXT = 1, IN_COMMENT = 2, IN_BOTH = 3 };
static const struct form {
    const char *word;
    uint32_t strings, numbers;
    bool has_params;
    int place; // where it may stand
} forms[] = {
    {"Shape", 1, 0, true, IN_TEXT},
    {"Material", 1, 0, true, IN_TEXT},
    {"MakeNamedMaterial", 1, 0, true, IN_TEXT},
    {"NamedMaterial", 1, 0, false, IN_TEXT},
    {"Texture", 3, 0, true, IN_TEXT},
    {"LightSource", 1, 0, true, IN_BOTH},
    {"AreaLightSource", 1, 0, true, IN_TEXT},
    {"MakeNamedMedium", 1, 0, true, IN_TEXT},
    {"MediumInterface", 2, 0, false, IN_TEXT},
    {"Attribute", 1, 0, true, IN_TEXT},
    {"Camera", 1, 0, true, IN_BOTH},
    {"Film", 1, 0, true, IN_TEXT},
    {"Sampler", 1, 0, true, IN_TEXT},
    {"PixelFilter", 1, 0, true, IN_TEXT},
    {"Integrator", 1, 0, true, IN_TEXT},
    {"Accelerator", 1, 0, true, IN_TEXT},
    {"Option", 0, 0, true, IN_BOTH},
    {"Transform", 0, CTM, false, IN_TEXT},
    {"ConcatTransform", 0, CTM, false, IN_TEXT},
    {"Translate", 0, 3, false, IN_TEXT},
    {"Scale", 0, 3, false, IN_TEXT},
    {"Rotate", 0, 4, false, IN_TEXT},
    {"LookAt", 0, 9, false, IN_TEXT},
    {"TransformTimes", 0, 2, false, IN_TEXT},
    {"Identity", 0, 0, false, IN_TEXT},
    {"CoordinateSystem", 1, 0, false, IN_TEXT},
    {"CoordSysTransform", 1, 0, false, IN_TEXT},
    {"ColorSpace", 1, 0, false, IN_TEXT},
    {"ObjectBegin", 1, 0, false, IN_TEXT},
    {"ObjectEnd", 0, 0, false, IN_TEXT},
    {"ObjectInstance", 1, 0, false, IN_TEXT},
    {"Include", 1, 0, false, IN_TEXT},
    {"Import", 1, 0, false, IN_TEXT},
    {"AttributeBegin", 0, 0, false, IN_TEXT},
    {"AttributeEnd", 0, 0, false, IN_TEXT},
    {"TransformBegin", 0, 0, false, IN_TEXT},
    {"TransformEnd", 0, 0, false, IN_TEXT},
    {"ReverseOrientation", 0, 0, false, IN_TEXT},
    {"ActiveTransform", 0, 0, false, IN_TEXT}, // and a word
    {"WorldBegin", 0, 0, false, IN_TEXT},
    {"WorldEnd", 0, 0, false, IN_TEXT},
    {"Meter", 1, 0, true, IN_COMMENT},
    {"Name", 1, 0, false, IN_COMMENT},
    {"Uncertainty", 1, 0, true, IN_COMMENT},
    {NULL, 0, 0, false, 0},
};

static const struct form *find_form(const struct sr_pbrt_token *token, bool is_annotation)
{
    const struct form *f = forms;
    while (f->word && !(token->kind == SR_PBRT_WORD && (f->place & (is_annotation ? IN_COMMENT : IN_TEXT)) &&
                        strlen(f->word) == token->length && memcmp(f->word, token->text, token->length) == 0))
        ++f;
    return f->word ? f : NULL;
}

bool sr_pbrt_statement_is_known(const struct sr_pbrt_token *token, bool is_annotation)
{
    return find_form(token, is_annotation) != NULL;
}

static sr_status unknown(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token)
{
    char word[64], buffer[160];
    size_t n = token->length < 63 ? token->length : 63;
    memcpy(word, token->text, n);
    word[n] = 0;
    struct sr_pbrt_suggestion suggestion = {.word = word};
    for (const struct form *f = forms; f->word; ++f)
        sr_pbrt_suggest(&suggestion, f->word);
    return sr_pbrt_fail(p->d, token->where, p->error, SR_ERROR_INPUT, "%s stands where a directive was expected%s",
                        word, sr_pbrt_suggestion_text(&suggestion, buffer));
}

/* ActiveTransform's word becomes a string */
static sr_status read_active(struct sr_pbrt_parser *p, struct sr_pbrt_statement *s)
{
    static const char *const words[] = {"All", "StartTime", "EndTime"};
    struct sr_pbrt_token token;
    if (sr_pbrt_lexer_next(p->lexer, &token, p->error) != SR_OK)
        return p->error->status;
    for (int i = 0; i < 3; ++i)
        if (token.kind == SR_PBRT_WORD && token.length == strlen(words[i]) &&
            memcmp(token.text, words[i], token.length) == 0)
            s->strings[0] = words[i];
    if (!s->strings[0])
        return sr_pbrt_fail(p->d, token.where, p->error, SR_ERROR_INPUT,
                            "ActiveTransform: expected All, StartTime or EndTime");
    return SR_OK;
}

static sr_status read_strings(struct sr_pbrt_parser *p, const struct form *form, struct sr_pbrt_statement *s)
{
    bool is_medium = strcmp(form->word, "MediumInterface") == 0;
    sr_status status = SR_OK;
    for (uint32_t i = 0; i < form->strings && status == SR_OK; ++i) {
        struct sr_pbrt_token token;
        if (is_medium && i == 1) { // the second may be left out
            if ((status = sr_pbrt_lexer_peek(p->lexer, &token, p->error)) != SR_OK || token.kind != SR_PBRT_STRING)
                break;
        }
        status = sr_pbrt_read_string(p, "a string in quotes", &s->strings[i]);
        ++s->string_count;
    }
    return status;
}

sr_status sr_pbrt_statement_read(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token, bool is_annotation,
                                 struct sr_pbrt_statement *s)
{
    const struct form *form = find_form(token, is_annotation);
    *s = (struct sr_pbrt_statement){.where = token->where, .is_annotation = is_annotation};
    if (!form)
        return unknown(p, token);
    s->word = p->directive = form->word;
    p->where = token->where;
    s->number_count = form->numbers;
    if (strcmp(form->word, "ActiveTransform") == 0)
        return read_active(p, s);
    sr_status status = read_strings(p, form, s);
    if (status == SR_OK && form->numbers)
        status = sr_pbrt_read_numbers(p, (int)form->numbers, s->numbers);
    if (status == SR_OK && strcmp(form->word, "Option") == 0)
        return sr_pbrt_option_read(p->d, p->lexer, &p->scratch, &s->params, p->error);
    if (status == SR_OK && form->has_params)
        status = sr_pbrt_params_read(p->d, p->lexer, &p->scratch, SR_SRGB, (struct sr_pbrt_params){NULL, 0}, &s->params,
                                     p->error);
    return status;
}

/* ---- printing ---- */

static void print_numbers(struct sr_print *out, const struct sr_pbrt_statement *s)
{
    uint32_t group = s->number_count == CTM ? 4 : s->number_count == 9 ? 3 : CTM;
    sr_print_word(out, s->number_count == CTM ? " [" : "");
    for (uint32_t i = 0; i < s->number_count; ++i) {
        sr_print_word(out, i > 0 && i % group == 0 ? "  " : " ");
        sr_print_double(out, s->numbers[i]);
    }
    sr_print_word(out, s->number_count == CTM ? " ]" : "");
}

/* Option "name" value, as pbrt reads it; in our own comments with its type */
static void print_option(struct sr_print *out, const struct sr_pbrt_statement *s)
{
    const struct sr_pbrt_param *p = s->params.items;
    sr_print_word(out, " ");
    sr_print_quoted(out, p->name);
    sr_print_word(out, " ");
    if (p->strings)
        sr_print_quoted(out, p->strings[0]);
    else if (p->floats)
        sr_print_double(out, (double)p->floats[0]);
    else if (p->type == SR_PBRT_BOOL)
        sr_print_word(out, p->ints[0] ? "true" : "false");
    else
        sr_print_double(out, p->ints[0]);
    sr_print_word(out, "\n");
}

void sr_pbrt_statement_print(struct sr_print *out, const struct sr_pbrt_statement *s)
{
    out->prefix = s->is_annotation ? "#@ " : NULL;
    sr_print_line(out, 0);
    sr_print_word(out, s->word);
    for (uint32_t i = 0; i < s->string_count; ++i) {
        sr_print_word(out, " ");
        sr_print_quoted(out, s->strings[i]);
    }
    if (strcmp(s->word, "ActiveTransform") == 0) {
        sr_print_word(out, " ");
        sr_print_word(out, s->strings[0]);
    }
    if (s->number_count)
        print_numbers(out, s);
    if (strcmp(s->word, "Option") == 0 && !s->is_annotation && s->params.count == 1 && s->params.items[0].count == 1)
        print_option(out, s);
    else
        sr_print_params(out, &s->params);
    out->prefix = NULL;
}
