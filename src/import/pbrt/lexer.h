/* SPDX-License-Identifier: MIT */
/* The words of a pbrt file, one after the other, each with its line and column. */
#ifndef SR_IMPORT_PBRT_LEXER_H
#define SR_IMPORT_PBRT_LEXER_H

#include "base/base.h"

enum sr_pbrt_token_kind {
    SR_PBRT_END,    // of the file
    SR_PBRT_WORD,   // a directive, a number, true, false
    SR_PBRT_STRING, // text is what stands between the quotes, escapes resolved
    SR_PBRT_OPEN,   // [
    SR_PBRT_CLOSE,  // ]
};

struct sr_pbrt_token {
    enum sr_pbrt_token_kind kind;
    const char *text; // not ended by NUL
    size_t length;    // [B]
    struct sr_location where;
};

struct sr_pbrt_lexer {
    const char *file;    // name for messages
    const char *p, *end; // *end is NUL
    const char *line_start;
    const char *number; // where the latest of sr_pbrt_lexer_number began
    int line;
    struct sr_arena *arena; // for strings with escapes
    bool has_next;          // one token has been looked at and not taken
    struct sr_pbrt_token next_token;
    bool is_annotation;           // it reads the words of comments "#@ …" alone, and ends with the last of them
    struct sr_array *annotations; // NULL, or struct sr_pbrt_annotation: where comments "#@" have been passed
    bool keeps_comments;          // annotations takes all comments, whose p is then at the #
    bool has_no_memory;           // for one of them
};

/* A comment that begins with #@ says something to this program that pbrt does not know. */
struct sr_pbrt_annotation {
    const char *p, *line_start; // behind the #@
    int line;
};

/* text must be followed by a NUL and live as long as the tokens. */
struct sr_pbrt_lexer sr_pbrt_lexer_start(const char *file, const char *text, size_t size, struct sr_arena *arena);
/* Over the words of that comment, and of the comments #@ on the lines right below it. */
struct sr_pbrt_lexer sr_pbrt_lexer_start_annotation(const struct sr_pbrt_lexer *lexer,
                                                    const struct sr_pbrt_annotation *a);
/* Each fills *token; the error bears file:line:column. */
sr_status sr_pbrt_lexer_next(struct sr_pbrt_lexer *lexer, struct sr_pbrt_token *token, struct sr_error *error);
sr_status sr_pbrt_lexer_peek(struct sr_pbrt_lexer *lexer, struct sr_pbrt_token *token, struct sr_error *error);

/* Between brackets, where only numbers are wanted: the next number, without a token; or what stands there instead,
 * which stays there unless it is the closing bracket. */
enum sr_pbrt_number_result { SR_PBRT_IS_NUMBER, SR_PBRT_IS_CLOSE, SR_PBRT_IS_OTHER };
enum sr_pbrt_number_result sr_pbrt_lexer_number(struct sr_pbrt_lexer *lexer, double *value);
/* The number that a word spells. */
bool sr_pbrt_token_number(const struct sr_pbrt_token *token, double *value);
struct sr_location sr_pbrt_lexer_number_where(const struct sr_pbrt_lexer *lexer); // of the latest

#endif
