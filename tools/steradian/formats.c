/* SPDX-License-Identifier: MIT */
/* steradian formats: everything that a scene file may say, from the tables that the reader reads by. docs/format.md is
 * its output. */
#include "command.h"
#include "formats_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum style { PLAIN, MARKDOWN, JSON };
struct printer {
    enum style style;
    const char *kind, *name; // only these; NULL: all
    const char *last_kind;
    json_t *json;
    int count;
    bool is_here[256]; // of the rows of format_pbrt
};

/* ---- what tables hold, in words ---- */

static const char *type_of(enum sr_param_kind kind)
{
    switch (kind) {
    case SR_PARAM_BOOL:
        return "bool";
    case SR_PARAM_INT:
        return "integer";
    case SR_PARAM_FLOAT:
        return "float";
    case SR_PARAM_ENUM:
    case SR_PARAM_STRING:
        return "string";
    case SR_PARAM_FILE:
        return "string (file)";
    case SR_PARAM_POINT2:
        return "point2";
    case SR_PARAM_POINT3:
        return "point3";
    case SR_PARAM_VECTOR3:
        return "vector3";
    case SR_PARAM_NORMAL3:
        return "normal";
    case SR_PARAM_ALBEDO:
    case SR_PARAM_UNBOUNDED:
        return "rgb, spectrum";
    case SR_PARAM_ILLUMINANT:
        return "rgb, spectrum, blackbody";
    case SR_PARAM_FLOAT_TEXTURE:
        return "float, texture";
    case SR_PARAM_ALBEDO_TEXTURE:
    case SR_PARAM_UNBOUNDED_TEXTURE:
        return "rgb, spectrum, texture";
    case SR_PARAM_MATERIALS:
        return "string[] (materials)";
    case SR_PARAM_INTS:
        return "integer[]";
    case SR_PARAM_FLOATS:
        return "float[]";
    case SR_PARAM_POINT2S:
        return "point2[]";
    case SR_PARAM_POINT3S:
        return "point3[]";
    case SR_PARAM_VECTOR3S:
        return "vector3[]";
    case SR_PARAM_NORMAL3S:
        return "normal[]";
    case SR_PARAM_RGBS:
        return "rgb[]";
    }
    return "?";
}

static bool is_number(enum sr_param_kind kind)
{
    return kind != SR_PARAM_BOOL && kind != SR_PARAM_ENUM && kind != SR_PARAM_STRING && kind != SR_PARAM_FILE &&
           kind != SR_PARAM_MATERIALS;
}

static const char *default_of(const struct sr_param *p, char buffer[128])
{
    if (p->kind == SR_PARAM_STRING)
        return isnan(p->initial) || !p->text ? "" : p->text;
    if (isnan(p->initial) || p->kind == SR_PARAM_FILE || p->kind >= SR_PARAM_MATERIALS)
        return "";
    if (p->kind == SR_PARAM_BOOL)
        return p->initial != 0 ? "true" : "false";
    if (p->kind == SR_PARAM_ENUM) {
        const char *word = p->text;
        for (int i = 0; i < (int)p->initial; ++i)
            word += strcspn(word, "|") + 1;
        snprintf(buffer, 128, "%.*s", (int)strcspn(word, "|"), word);
    } else
        snprintf(buffer, 128, "%.7g", p->initial);
    return buffer;
}

static const char *range_of(const struct sr_param *p, char buffer[160])
{
    buffer[0] = 0;
    if (p->kind == SR_PARAM_ENUM) { // a bar would end a cell of a table
        char *to = buffer;
        for (const char *c = p->text; *c && to < buffer + 150; ++c)
            to = *c == '|' ? (memcpy(to, ", ", 2), to + 2) : (*to = *c, to + 1);
        *to = 0;
    } else if (is_number(p->kind) && p->min < p->max && !(isinf(p->min) && isinf(p->max))) {
        if (!isinf(p->max) && p->max < 1 << 30)
            snprintf(buffer, 160, "%.7g … %.7g", p->min, p->max);
        else if (p->min > -1e9)
            snprintf(buffer, 160, "%.7g …", p->min);
    }
    return buffer;
}

static bool has_word(const char *list, const char *word)
{
    size_t n = strlen(word);
    for (const char *p = list; (p = strstr(p, word)); p += n)
        if ((p == list || p[-1] == ' ') && (p[n] == 0 || p[n] == ' '))
            return true;
    return false;
}

static const char *find_word(const struct format_word *words, const char *kind, const char *name)
{
    for (; words->kind; ++words)
        if (strcmp(words->kind, kind) == 0 && strcmp(words->name, name) == 0)
            return words->text;
    return NULL;
}

/* Textures are listed as of one type, or of both. */
static const char *general(const char *kind)
{
    return strncmp(kind, "Texture", 7) == 0 ? "Texture" : kind;
}

static const char *pbrt_list(const struct sr_import_plugin *plugin)
{
    const char *list = find_word(format_pbrt, plugin->kind, plugin->name);
    return list ? list : find_word(format_pbrt, general(plugin->kind), plugin->name);
}

static bool is_read_by_pbrt(const struct sr_import_plugin *plugin, const char *parameter)
{
    const char *own = pbrt_list(plugin), *common = find_word(format_pbrt, general(plugin->kind), "");
    return own && (has_word(own, parameter) || (common && has_word(common, parameter)));
}

static const char *meaning(const struct sr_import_plugin *plugin, const struct sr_param *p)
{
    const char *text = find_word(format_meanings, general(plugin->kind), p->name);
    return text ? text : p->kind == SR_PARAM_ENUM || p->kind == SR_PARAM_STRING || !p->text ? "" : p->text;
}

/* ---- printing ---- */

static bool is_word(const char *kind)
{
    return strcmp(kind, "directive") == 0 || strcmp(kind, "annotation") == 0;
}

static const char *title_of(const char *kind)
{
    return strcmp(kind, "directive") == 0    ? "Directives"
           : strcmp(kind, "annotation") == 0 ? "Directives in comments `#@`"
                                             : kind;
}

static void print_heading(struct printer *pr, const struct sr_import_plugin *plugin)
{
    if (!pr->last_kind || strcmp(pr->last_kind, plugin->kind) != 0)
        printf(pr->style == MARKDOWN ? "\n## %s\n" : "\n%s\n", title_of(plugin->kind));
    if (is_word(plugin->kind)) {
        const char *text = find_word(format_texts, plugin->kind, plugin->name);
        if (pr->style == MARKDOWN && (!pr->last_kind || strcmp(pr->last_kind, plugin->kind) != 0))
            printf("\n");
        printf(pr->style == MARKDOWN ? "- `%s` %s\n" : "  %-18s %s\n", plugin->name, text ? text : "");
        return;
    }
    const char *pbrt = pbrt_list(plugin);
    const char *who = pbrt ? "" : " (Steradian only)";
    if (pr->style == MARKDOWN)
        printf(plugin->name[0] ? "\n### %s \"%s\"%s\n" : "\n### %s%.0s: what all have%s\n", plugin->kind, plugin->name,
               who);
    else
        printf(plugin->name[0] ? "\n  %s \"%s\"%s\n" : "\n  %s%.0s: what all have%s\n", plugin->kind, plugin->name,
               who);
}

static void print_row(const struct printer *pr, const struct sr_import_plugin *plugin, const struct sr_param *p)
{
    char initial[128], range[160];
    const char *unit = p->unit && is_number(p->kind) && strcmp(p->unit, "1") != 0 ? p->unit : "";
    const char *by = is_read_by_pbrt(plugin, p->name) ? "pbrt-v4" : "Steradian only";
    if (pr->style == MARKDOWN)
        printf("| `%s` | %s | %s | %s | %s | %s | %s |\n", p->name, type_of(p->kind), unit, range_of(p, range),
               default_of(p, initial), meaning(plugin, p), by);
    else
        printf("    %-22s %-24s %-6s %-22s %-10s %s%s\n", p->name, type_of(p->kind), unit, range_of(p, range),
               default_of(p, initial), meaning(plugin, p), is_read_by_pbrt(plugin, p->name) ? "" : " [Steradian only]");
}

/* Parameters that pbrt reads and the table does not have. */
static void print_missing(const struct printer *pr, const struct sr_import_plugin *plugin)
{
    const char *p = pbrt_list(plugin);
    char word[64];
    for (int n; p && sscanf(p, " %63s%n", word, &n) == 1; p += n) {
        const struct sr_param *row = plugin->params;
        while (row && row->name && strcmp(row->name, word) != 0)
            ++row;
        if (row && row->name)
            continue;
        printf(pr->style == MARKDOWN ? "| `%s` | | | | | | pbrt-v4 only |\n" : "    %-22s [pbrt-v4 only]\n", word);
    }
}

static json_t *json_row(const struct sr_import_plugin *plugin, const struct sr_param *p)
{
    char initial[128], range[160];
    json_t *row = json_object();
    json_object_set_new(row, "name", command_json_text(p->name));
    json_object_set_new(row, "type", command_json_text(type_of(p->kind)));
    json_object_set_new(row, "unit", command_json_text(p->unit && is_number(p->kind) ? p->unit : "1"));
    json_object_set_new(row, "range", command_json_text(range_of(p, range)));
    json_object_set_new(row, "default", command_json_text(default_of(p, initial)));
    json_object_set_new(row, "meaning", command_json_text(meaning(plugin, p)));
    json_object_set_new(row, "pbrt", json_boolean(is_read_by_pbrt(plugin, p->name)));
    return row;
}

static void add_json(struct printer *pr, const struct sr_import_plugin *plugin)
{
    const char *text = find_word(format_texts, plugin->kind, plugin->name);
    json_t *one = json_object(), *rows = json_array();
    json_object_set_new(one, "kind", command_json_text(plugin->kind));
    json_object_set_new(one, "name", command_json_text(plugin->name));
    json_object_set_new(one, "pbrt", json_boolean(strcmp(plugin->kind, "directive") == 0 || pbrt_list(plugin)));
    json_object_set_new(one, "text", command_json_text(text));
    for (const struct sr_param *p = plugin->params; p && p->name; ++p)
        json_array_append_new(rows, json_row(plugin, p));
    json_object_set_new(one, "parameters", rows);
    json_array_append_new(pr->json, one);
}

static void visit(void *context, const struct sr_import_plugin *plugin)
{
    struct printer *pr = context;
    if ((pr->kind && strcasecmp(pr->kind, plugin->kind) != 0 && strcasecmp(pr->kind, general(plugin->kind)) != 0) ||
        (pr->name && strcmp(pr->name, plugin->name) != 0))
        return;
    ++pr->count;
    for (int i = 0; format_pbrt[i].kind; ++i)
        if (strcmp(format_pbrt[i].name, plugin->name) == 0 &&
            strcmp(general(format_pbrt[i].kind), general(plugin->kind)) == 0)
            pr->is_here[i] = true;
    if (pr->style == JSON) {
        add_json(pr, plugin);
        return;
    }
    print_heading(pr, plugin);
    pr->last_kind = plugin->kind;
    if (is_word(plugin->kind))
        return;
    bool has_rows = plugin->params && plugin->params->name;
    if (pr->style == MARKDOWN && has_rows)
        printf("\n| parameter | type | unit | range | default | meaning | read by |\n|---|---|---|---|---|---|---|\n");
    for (const struct sr_param *p = plugin->params; p && p->name; ++p)
        print_row(pr, plugin, p);
    print_missing(pr, plugin);
}

/* Plugins of pbrt that are not here under their name. */
static void print_absent(const struct printer *pr)
{
    bool has_begun = false;
    for (int i = 0; format_pbrt[i].kind; ++i) {
        const struct format_word *w = &format_pbrt[i];
        if (pr->is_here[i] || !w->name[0])
            continue;
        if (!has_begun)
            printf("\n%sOf pbrt-v4, without a table of its own here\n\n", pr->style == MARKDOWN ? "## " : "");
        has_begun = true;
        printf(pr->style == MARKDOWN ? "- %s \"%s\": %s\n" : "  %s \"%s\": %s\n", w->kind, w->name,
               w->text[0] ? w->text : "no parameters");
    }
}

static const char help[] =
    "steradian formats: everything that a scene file may say\n\n"
    "Usage: steradian formats [OPTIONS] [KIND [NAME]]\n\n"
    "Directives, options, and every plugin with its parameters: type, unit, range, default, meaning, and whether pbrt-v4\n"
    "reads it too. KIND is a directive, such as Shape, Material, Texture, LightSource; NAME one of its kinds.\n\n"
    "  --markdown   as docs/format.md\n"
    "  --json       for programs\n\n"
    "Examples:\n"
    "  steradian formats Shape sphere\n"
    "  steradian formats LightSource\n"
    "  steradian formats --json | jq '.[] | select(.kind == \"Material\") | .name'\n";

static int run(int argc, char **argv)
{
    static const struct option options[] = {
        {"markdown", no_argument, NULL, 'm'}, {"json", no_argument, NULL, 'j'}, {NULL, 0, NULL, 0}};
    struct printer pr = {.style = PLAIN};
    for (int o; (o = command_next_option(argc, argv, ":", options, NULL)) != -1;) {
        if (o != 'm' && o != 'j')
            return command_bad_option(&command_formats, options, o, argv);
        pr.style = o == 'm' ? MARKDOWN : JSON;
    }
    if (argc - optind > 2)
        return command_usage(&command_formats, "a kind and a name were expected, and nothing more");
    pr.kind = optind < argc ? argv[optind] : NULL;
    pr.name = optind + 1 < argc ? argv[optind + 1] : NULL;
    if (pr.style == JSON)
        pr.json = json_array();
    if (pr.style == MARKDOWN && !pr.kind)
        printf(
            "# What a scene file may say\n\n"
            "Made by `make format-reference` from the tables by which scenes are read; do not edit. In the last column: `pbrt-v4`, both\n"
            "renderers read it; `Steradian only`, write it in a comment `#@`, or pbrt refuses the file; `pbrt-v4 only`, it is named in a\n"
            "warning and does nothing. Defaults left empty: none, or said in the meaning. Lengths are in metres, unless the scene's unit\n"
            "is another. How the words work together: [units](units.md), [conventions](conventions.md).\n");
    sr_import_plugins(visit, &pr);
    if (pr.style == JSON)
        return command_print_json("formats", pr.json);
    if (!pr.kind)
        print_absent(&pr);
    if (pr.count == 0)
        return command_usage(&command_formats, "there is no %s%s%s%s", pr.kind, pr.name ? " \"" : "",
                             pr.name ? pr.name : "", pr.name ? "\"" : "");
    return 0;
}

const struct command command_formats = {
    .name = "formats", .summary = "tell everything that a scene file may say", .help = help, .run = run};
