/* SPDX-License-Identifier: MIT */
/* steradian brdf list and show: which models there are, and what each is told. */
#include "brdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct option long_options[] = {
    {"json", no_argument, NULL, 'j'},
    {NULL, 0, NULL, 0},
};

static const char *title_of(const struct sr_bsdf_model *m)
{
    return m->title ? m->title : m->name;
}

/* The number of a limit, "inf" as JSON's null. */
static void limit(char text[32], double value)
{
    if (isinf(value))
        snprintf(text, 32, "%s", value < 0 ? "-inf" : "inf");
    else
        snprintf(text, 32, "%g", value);
}

static const char *kind_name(enum sr_param_kind kind)
{
    switch (kind) {
    case SR_PARAM_BOOL:
        return "true or false";
    case SR_PARAM_INT:
        return "whole number";
    case SR_PARAM_FLOAT:
        return "number";
    case SR_PARAM_ENUM:
        return "choice";
    case SR_PARAM_FILE:
        return "file";
    case SR_PARAM_ALBEDO:
    case SR_PARAM_UNBOUNDED:
        return "spectrum";
    default:
        return "text";
    }
}

/* The n-th of "a|b|c", cut out. */
static void choice(char text[64], const char *choices, int n)
{
    for (; n > 0 && strchr(choices, '|'); --n)
        choices = strchr(choices, '|') + 1;
    snprintf(text, 64, "%.*s", (int)strcspn(choices, "|"), choices);
}

/* Range and default of a row as text. */
static void describe(const struct sr_param *p, char range[80], char initial[64])
{
    char lo[32], hi[32];
    limit(lo, p->min);
    limit(hi, p->max);
    snprintf(range, 80, "%s … %s", lo, hi);
    snprintf(initial, 64, "%g", p->initial);
    if (p->kind == SR_PARAM_ENUM) {
        snprintf(range, 80, "see below");
        choice(initial, p->text, isfinite(p->initial) ? (int)p->initial : 0);
    } else if (p->kind == SR_PARAM_BOOL) {
        snprintf(range, 80, "true, false");
        snprintf(initial, 64, "%s", p->initial > 0 ? "true" : "false");
    } else if (p->kind == SR_PARAM_FILE) {
        snprintf(range, 80, "a file");
        snprintf(initial, 64, "none");
    }
}

static json_t *model_json(const struct sr_bsdf_model *m)
{
    json_t *rows = json_array();
    for (const struct sr_param *p = m->params; p->name; ++p) {
        char range[80], initial[64];
        describe(p, range, initial);
        bool is_number = p->kind == SR_PARAM_FLOAT || p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ALBEDO ||
                         p->kind == SR_PARAM_UNBOUNDED;
        json_t *row = json_pack("{s:s, s:s, s:s, s:o, s:s}", "name", p->name, "kind", kind_name(p->kind), "unit",
                                p->unit, "default", is_number ? command_json_number(p->initial) : json_string(initial),
                                "text", p->kind == SR_PARAM_ENUM ? "" : p->text);
        if (is_number) {
            json_object_set_new(row, "min", command_json_number(p->min));
            json_object_set_new(row, "max", command_json_number(p->max));
        }
        if (p->kind == SR_PARAM_ENUM)
            json_object_set_new(row, "choices", json_string(p->text));
        json_array_append_new(rows, row);
    }
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:b, s:o, s:o}", "name", m->name, "title", title_of(m), "source",
                     command_json_text(m->source), "limits", command_json_text(m->limits), "parameters", rows,
                     "is_random", m->is_random, "documented_asymmetry",
                     command_json_quantity((double)m->asymmetry, "1"), "documented_largest_albedo",
                     m->largest_albedo > 1 ? command_json_quantity((double)m->largest_albedo, "1") : json_null());
}

/* ---- list ---- */

static const char list_help[] =
    "Usage: steradian brdf list [--json]\n"
    "\n"
    "Lists the models: each is a word of 'steradian brdf …' and of scene files (Material \"NAME\").\n"
    "\n"
    "      --json    with their parameters, as JSON on standard output\n"
    "\n"
    "Example:\n"
    "  steradian brdf list\n";

static int list(int argc, char **argv)
{
    bool json = false;
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1)
        if (option == 'j')
            json = true;
        else
            return command_bad_option(&brdf_list, long_options, option, argv);
    if (optind != argc)
        return command_usage(&brdf_list, "\"%s\" was not expected; 'steradian brdf show %s' tells of one model",
                             argv[optind], argv[optind]);
    if (json) {
        json_t *models = json_array();
        for (int i = 0; sr_bsdf_models[i]; ++i)
            json_array_append_new(models, model_json(sr_bsdf_models[i]));
        return command_print_json("brdf list", json_pack("{s:o}", "models", models));
    }
    for (int i = 0; sr_bsdf_models[i]; ++i)
        printf("%-26s %s\n", sr_bsdf_models[i]->name, title_of(sr_bsdf_models[i]));
    return 0;
}

const struct command brdf_list = {"brdf list", "which models there are", list_help, list};

/* ---- show ---- */

static const char show_help[] =
    "Usage: steradian brdf show MODEL [--json]\n"
    "\n"
    "Tells of a model: its parameters with unit, range, default and meaning; its source; where it must\n"
    "not be trusted; which laws it breaks by its nature, and by how much at most.\n"
    "\n"
    "      --json    the same as JSON on standard output\n"
    "\n"
    "Example:\n"
    "  steradian brdf show conductor\n";

/* Text, broken at blanks so that lines stay below 110 columns; further lines are indented. */
static void print_wrapped(const char *label, const char *text)
{
    size_t column = (size_t)printf("%-10s", label);
    while (*text) {
        size_t n = strcspn(text, " ");
        if (column + n > 110) {
            printf("\n%-10s", "");
            column = 10;
        }
        printf("%.*s", (int)n, text);
        column += n + 1;
        text += n;
        if (*text == ' ') {
            ++text;
            if (column + strcspn(text, " ") <= 110)
                putchar(' ');
        }
    }
    putchar('\n');
}

static int show(int argc, char **argv)
{
    bool json = false;
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1)
        if (option == 'j')
            json = true;
        else
            return command_bad_option(&brdf_show, long_options, option, argv);
    if (optind + 1 != argc)
        return command_usage(&brdf_show,
                             optind == argc ? "a model was expected ('steradian brdf list')"
                                            : "one model was expected, there are %d words",
                             argc - optind);
    const struct sr_bsdf_model *m = sr_bsdf_model_find(argv[optind]);
    if (!m) {
        const char *names[256];
        size_t n = 0;
        for (; n < 256 && sr_bsdf_models[n]; ++n)
            names[n] = sr_bsdf_models[n]->name;
        const char *nearest = command_nearest(argv[optind], names, sizeof names[0], n);
        struct sr_error error = {0};
        sr_fail(&error, SR_ERROR_INPUT, "there is no model \"%s\"%s%s%s; 'steradian brdf list' tells them",
                argv[optind], nearest ? ", did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
        return command_fail("brdf show", &error);
    }
    if (json)
        return command_print_json("brdf show", model_json(m));
    printf("%s: %s\n\n", m->name, title_of(m));
    if (m->params[0].name)
        printf("  %-20s %-14s %-6s %-18s %-10s\n", "parameter", "kind", "unit", "range", "default");
    else
        printf("  it has no parameters\n");
    for (const struct sr_param *p = m->params; p->name; ++p) {
        char range[80], initial[64];
        describe(p, range, initial);
        int dots = strstr(range, "…") ? 2 : 0; // bytes of a letter that fills one column
        printf("  %-20s %-14s %-6s %-*s %-10s %s%s\n", p->name, kind_name(p->kind), p->unit, 18 + dots, range, initial,
               p->kind == SR_PARAM_ENUM ? "one of " : "", p->text);
    }
    putchar('\n');
    if (m->source)
        print_wrapped("source", m->source);
    if (m->limits)
        print_wrapped("limits", m->limits);
    if (m->is_random)
        print_wrapped("random", "f is an unbiased estimate that depends on a seed");
    if (m->asymmetry > 0)
        printf("%-10sby its nature not reciprocal: |f(a, b) - f(b, a)| is up to %g of the larger of them\n",
               "asymmetry", (double)m->asymmetry);
    if (m->largest_albedo > 1)
        printf("%-10sby its nature it can return up to %g of the light that arrives\n", "energy",
               (double)m->largest_albedo);
    return 0;
}

const struct command brdf_show = {"brdf show", "a model's parameters, source and limits", show_help, show};
