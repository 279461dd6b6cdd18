/* SPDX-License-Identifier: MIT */
/* One directive with its arguments, as it stands in a file, before it does anything. */
#ifndef SR_IMPORT_PBRT_STATEMENT_H
#define SR_IMPORT_PBRT_STATEMENT_H

#include "import/pbrt/parser.h"
#include "import/pbrt/print.h"

struct sr_pbrt_statement {
    const char *word;
    struct sr_location where;
    const char *strings[3];
    double numbers[16];
    uint32_t string_count, number_count;
    struct sr_pbrt_params params;
    bool is_annotation, is_dropped;
};

/* Reads what comes behind the directive that token holds. Directives of one line of #@ have more kinds. */
sr_status sr_pbrt_statement_read(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token, bool is_annotation, struct sr_pbrt_statement *s);
/* Whether there is such a directive. */
bool sr_pbrt_statement_is_known(const struct sr_pbrt_token *token, bool is_annotation);
void sr_pbrt_statement_print(struct sr_print *out, const struct sr_pbrt_statement *s);

/* upgrade.c: from pbrt-v3's words to pbrt-v4's. */
struct sr_pbrt_upgrade {
    struct sr_arena *arena;  // of names, as long as the upgrade
    struct sr_array renamed; // struct sr_pbrt_renamed
    int count;               // of names made
};
/* Changes the statement; parameters and words that it adds live in p->d. */
sr_status sr_pbrt_upgrade(struct sr_pbrt_upgrade *u, struct sr_pbrt_parser *p, struct sr_pbrt_statement *s);

#endif
