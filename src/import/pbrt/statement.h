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
sr_status sr_pbrt_statement_read(struct sr_pbrt_parser *p, const struct sr_pbrt_token *token, bool is_annotation,
                                 struct sr_pbrt_statement *s);
/* Whether there is such a directive. */
bool sr_pbrt_statement_is_known(const struct sr_pbrt_token *token, bool is_annotation);
void sr_pbrt_statement_print(struct sr_print *out, const struct sr_pbrt_statement *s);

/* ---- upgrade.c: from pbrt-v3's words to pbrt-v4's ---- */

struct sr_pbrt_upgrade {
    struct sr_pbrt_parser *p;
    struct sr_pbrt_statement *s; // at work
    struct sr_print *out;        // where statements that must come before it go
    bool for_steradian;
    struct sr_arena *arena;         // of names, as long as the upgrade
    struct sr_array renamed;        // struct sr_pbrt_renamed
    int count;                      // of names made
    bool has_filter;                // PixelFilter was there
    int block_depth;                // of TransformBegin
    struct sr_location changed[64]; // in each of them, the latest directive that it undoes in pbrt-v4 alone
    uint32_t room;                  // for parameters of s
};
/* Changes u->s; parameters and words that it adds live in p->d. */
sr_status sr_pbrt_upgrade(struct sr_pbrt_upgrade *u);
/* upgrade_materials.c: of a Material, or of a MakeNamedMaterial whose type is *model. */
void sr_pbrt_upgrade_material(struct sr_pbrt_upgrade *u, const char **model);
/* What a name of that kind ("material", "object", "float", "spectrum") has become. */
const char *sr_pbrt_upgrade_name(struct sr_pbrt_upgrade *u, const char *kind, const char *name);

/* The statement's parameters. */
struct sr_pbrt_param *sr_pbrt_edit_find(struct sr_pbrt_upgrade *u, const char *name); // NULL: none
void sr_pbrt_edit_remove(struct sr_pbrt_upgrade *u, const char *name);
void sr_pbrt_edit_rename(struct sr_pbrt_upgrade *u, const char *name, const char *to);
/* A new one, or in place of the one of that name; zeroed but for type and name. NULL: no memory. */
struct sr_pbrt_param *sr_pbrt_edit_set(struct sr_pbrt_upgrade *u, enum sr_pbrt_type type, const char *name,
                                       const void *values, uint32_t count);
void sr_pbrt_edit_float(struct sr_pbrt_upgrade *u, const char *name, float value);
void sr_pbrt_edit_string(struct sr_pbrt_upgrade *u, enum sr_pbrt_type type, const char *name, const char *value);
/* Whether it is a number, or colours that are one; a default where it is not given. */
bool sr_pbrt_edit_grey(struct sr_pbrt_upgrade *u, const char *name, float initial, float *value);

#endif
