/* SPDX-License-Identifier: MIT */
/* steradian brdf check: the certificate of a model, a file of measured data or a material. */
#include "brdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian brdf check SPECIMEN … [OPTIONS]\n"
    "       steradian brdf check --all [--markdown FILE] [OPTIONS]\n"
    "\n"
    "Measures whether a model keeps the laws of light and does what it says: reciprocity, energy, densities that are "
    "those\n"
    "of its samples, functions that agree. Without parameters: over sets drawn from its table. With parameters, of a "
    "file\n"
    "or of a sum: of the specimen as it is. What a model breaks by its nature is compared with its documented amount.\n"
    "\n"
    "      --sets N            sets of parameters (64); 0: only the parameters given\n"
    "      --samples N         samples of each statistical test (65536)\n"
    "      --seed N            of all random numbers (1)\n"
    "      --significance P    probability that a sound model fails any of its statistical tests (1e-6)\n"
    "      --quick             8 sets, 16384 samples\n"
    "      --soak N            N calls more, looking for NaN, infinity and negative values only\n"
    "      --all               all models, one line each\n"
    "      --markdown FILE     with --all: writes the certificates as a document\n"
    "      --json              the same as JSON on standard output\n"
    "\n"
    "Exit code 1 when a check fails.\n"
    "\n"
    "Examples:\n"
    "  steradian brdf check conductor\n"
    "  steradian brdf check conductor alpha_x=.1 alpha_y=.3 --json\n"
    "  steradian brdf check scene.pbrt:leather --samples 1000000\n"
    "  steradian brdf check --all --markdown certificates.md\n";

static const struct option long_options[] = {
    {"sets", required_argument, NULL, 'n'}, {"samples", required_argument, NULL, 'k'},
    {"seed", required_argument, NULL, 's'}, {"significance", required_argument, NULL, 'p'},
    {"quick", no_argument, NULL, 'Q'},      {"soak", required_argument, NULL, 'w'},
    {"all", no_argument, NULL, 'a'},        {"markdown", required_argument, NULL, 'm'},
    {"json", no_argument, NULL, 'j'},       {NULL, 0, NULL, 0},
};

struct arguments {
    struct sr_certificate_options options;
    uint64_t soak;
    bool json, all, has_sets;
    const char *markdown;
};

static const char *const verdicts[] = {"passed", "documented", "FAILED", "skipped"};

/* ---- telling ---- */

/* Five digits; what depends is left out. */
static void figure(char text[32], double value)
{
    if (isnan(value))
        snprintf(text, 32, "-");
    else
        snprintf(text, 32, "%.5g", value);
}

static void print(const char *title, const struct sr_certificate *c)
{
    printf("%s\n\n  %-17s %-11s %11s %9s %-5s\n", title, "check", "verdict", "measured", "limit", "unit");
    for (int i = 0; i < c->count; ++i) {
        const struct sr_check *k = &c->checks[i];
        char measured[32], limit[32];
        figure(measured, k->measured);
        figure(limit, k->verdict == SR_SKIPPED ? (double)NAN : k->limit);
        printf("  %-17s %-11s %11s %9s %-5s %s\n", k->name, verdicts[k->verdict], measured, limit,
               k->verdict == SR_SKIPPED ? "" : k->unit, k->text);
    }
    printf("\n%s, %llu evaluations\n", c->passed ? "passed" : "FAILED", (unsigned long long)c->evaluations);
}

static json_t *certificate_json(const char *title, const struct sr_certificate *c,
                                const struct sr_certificate_options *o)
{
    json_t *checks = json_array();
    for (int i = 0; i < c->count; ++i) {
        const struct sr_check *k = &c->checks[i];
        json_array_append_new(
            checks, json_pack("{s:s, s:s, s:I, s:o, s:o, s:o}", "name", k->name, "verdict", verdicts[k->verdict],
                              "count", (json_int_t)k->count, "measured", command_json_quantity(k->measured, k->unit),
                              "limit", command_json_quantity(k->limit, k->unit), "text", command_json_text(k->text)));
    }
    return json_pack("{s:o, s:b, s:o, s:I, s:{s:i, s:i, s:i, s:f}}", "specimen", command_json_text(title), "passed",
                     c->passed, "checks", checks, "evaluations", (json_int_t)c->evaluations, "options", "sets",
                     (int)o->sets, "samples", (int)o->samples, "seed", (int)o->seed, "significance", o->significance);
}

/* ---- all models ---- */

static bool is_drawable(const struct sr_bsdf_model *m)
{
    for (const struct sr_param *p = m->params; p->name; ++p)
        if (p->kind == SR_PARAM_FILE || p->kind == SR_PARAM_STRING)
            return false;
    return true;
}

/* The worst words of a certificate: what failed, or what is documented. */
static void summary(const struct sr_certificate *c, char *text, size_t size)
{
    size_t n = 0;
    text[0] = 0;
    for (int pass = 0; pass < 2; ++pass)
        for (int i = 0; i < c->count; ++i)
            if (c->checks[i].verdict == (pass ? SR_DOCUMENTED : SR_FAILED) && n + 80 < size)
                n += (size_t)snprintf(text + n, size - n, "%s%s %s: %.4g of %.4g", n ? "; " : "", c->checks[i].name,
                                      verdicts[c->checks[i].verdict], c->checks[i].measured, c->checks[i].limit);
}

static void write_markdown(FILE *out, const struct sr_bsdf_model *m, const struct sr_certificate *c)
{
    fprintf(out, "\n## %s\n\n%s. %s%s%s\n", m->name, m->title ? m->title : m->name, m->source ? "Source: " : "",
            m->source ? m->source : "", m->source ? "." : "");
    if (m->limits)
        fprintf(out, "Limits: %s.\n", m->limits);
    fprintf(out, "\n| check | verdict | measured | limit | unit | where it is worst |\n|---|---|---:|---:|---|---|\n");
    for (int i = 0; i < c->count; ++i) {
        const struct sr_check *k = &c->checks[i];
        char measured[32], limit[32];
        figure(measured, k->measured);
        figure(limit, k->verdict == SR_SKIPPED ? (double)NAN : k->limit);
        fprintf(out, "| %s | %s | %s | %s | %s | %s |\n", k->name, verdicts[k->verdict], measured, limit,
                k->verdict == SR_SKIPPED ? "" : k->unit, k->text);
    }
}

static void markdown_head(FILE *out, const struct sr_certificate_options *o)
{
    fprintf(
        out,
        "# Certificates of the scattering models\n"
        "\n"
        "Written by `steradian brdf check --all --markdown docs/brdf-certificates.md --sets %u --samples %u --seed %u\n"
        "--significance %g`, from a real run: %u sets of parameters of each model, drawn from its table, %u samples "
        "for\n"
        "each statistical test. What is measured, and what the words mean: [the laboratory](guide/brdf.md).\n"
        "\n"
        "A model that breaks a law by its nature is *documented*: its table tells the most that it may deviate, and "
        "the\n"
        "measured amount is within it, or beyond it by no more than chance: +- is a standard error.\n",
        (unsigned)o->sets, (unsigned)o->samples, (unsigned)o->seed, o->significance, (unsigned)o->sets,
        (unsigned)o->samples);
}

static int check_all(const struct arguments *a)
{
    struct sr_error error = {0};
    struct command_page page;
    if (command_page_open(a->markdown, &page, &error) != SR_OK)
        return command_fail("brdf check", &error);
    if (page.out)
        markdown_head(page.out, &a->options);
    json_t *all = json_array();
    bool passed = true;
    for (int i = 0; sr_bsdf_models[i] && !error.status; ++i) {
        const struct sr_bsdf_model *m = sr_bsdf_models[i];
        struct sr_certificate c;
        if (!is_drawable(m)) {
            if (!a->json)
                printf("%-26s skipped     it reads files: check a file\n", m->name);
            continue;
        }
        if (sr_certify_model(m, &a->options, &c, &error) != SR_OK)
            break;
        passed &= c.passed;
        char text[400];
        summary(&c, text, sizeof text);
        if (!a->json) {
            printf("%-26s %-11s %s\n", m->name, c.passed ? "passed" : "FAILED", text);
            fflush(stdout);
        } else
            json_array_append_new(all, certificate_json(m->name, &c, &a->options));
        if (page.out)
            write_markdown(page.out, m, &c);
    }
    command_page_close(&page, &error);
    if (error.status) {
        json_decref(all);
        return command_fail("brdf check", &error);
    }
    if (a->json) {
        int code = command_print_json("brdf check", json_pack("{s:o, s:b}", "certificates", all, "passed", passed));
        return code ? code : passed ? 0 : SR_ERROR_CHECK;
    }
    json_decref(all);
    return passed ? 0 : SR_ERROR_CHECK;
}

/* ---- one ---- */

static int check_one(const struct arguments *a, int argc, char **argv)
{
    struct sr_arena arena = {0};
    struct sr_specimen specimen;
    struct sr_certificate c;
    struct sr_error error = {0};
    struct sr_certificate_options o = a->options;
    int code = brdf_read_specimen(&brdf_check, argc, argv, &arena, &specimen);
    if (code == 0) {
        const struct sr_bsdf_model *m = specimen.part_count == 1 ? specimen.parts[0].model : NULL;
        if (!a->has_sets && (optind + 1 < argc || !m || !is_drawable(m)))
            o.sets = 0;
        sr_certify(&specimen, &o, &c, &error);
        if (!error.status && a->soak)
            sr_soak(&specimen, a->soak, &o, &c, &error);
        if (error.status)
            code = command_fail("brdf check", &error);
        else if (a->json)
            code = command_print_json("brdf check", certificate_json(specimen.title, &c, &o));
        else
            print(specimen.title, &c);
        if (code == 0 && !c.passed)
            code = SR_ERROR_CHECK;
    }
    sr_arena_free(&arena);
    return code;
}

static int run(int argc, char **argv)
{
    struct arguments a = {.options = {.sets = 64, .samples = 65536, .seed = 1, .significance = 1e-6}};
    int option, index = 0;
    uint64_t n;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1)
        switch (option) {
        case 'n':
            if (!command_parse_uint(&brdf_check, "sets", optarg, 0, 100000, &n))
                return SR_ERROR_USAGE;
            a.options.sets = (uint32_t)n;
            a.has_sets = true;
            break;
        case 'k':
            if (!command_parse_uint(&brdf_check, "samples", optarg, 2048, 1 << 30, &n))
                return SR_ERROR_USAGE;
            a.options.samples = (uint32_t)n;
            break;
        case 's':
            if (!command_parse_uint(&brdf_check, "seed", optarg, 0, UINT32_MAX, &n))
                return SR_ERROR_USAGE;
            a.options.seed = (uint32_t)n;
            break;
        case 'p':
            if (!command_parse_float(&brdf_check, "significance", optarg, 1e-12, 0.5, &a.options.significance))
                return SR_ERROR_USAGE;
            break;
        case 'Q':
            a.options.sets = 8;
            a.options.samples = 16384;
            break;
        case 'w':
            if (!command_parse_uint(&brdf_check, "soak", optarg, 1, 1000000000000, &a.soak))
                return SR_ERROR_USAGE;
            break;
        case 'a':
            a.all = true;
            break;
        case 'm':
            a.markdown = optarg;
            break;
        case 'j':
            a.json = true;
            break;
        default:
            return command_bad_option(&brdf_check, long_options, option, argv);
        }
    if (a.all && optind < argc)
        return command_usage(&brdf_check, "--all is of all models: \"%s\" was not expected", argv[optind]);
    if (a.markdown && !a.all)
        return command_usage(&brdf_check, "--markdown goes with --all");
    return a.all ? check_all(&a) : check_one(&a, argc, argv);
}

const struct command brdf_check = {"brdf check", "whether a model keeps the laws of light and does what it says", help,
                                   run};
