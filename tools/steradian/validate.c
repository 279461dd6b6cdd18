/* SPDX-License-Identifier: MIT */
/* steradian validate: scenes whose answers are known, measured and compared.
 *
 *     z = (measured - expected) / sqrt(u^2 + u_expected^2),   |z| < 4.9: one false alarm in a million cases
 *
 * A case also passes within 1e-5 of its value, which is what single precision resolves; and its own relative standard
 * uncertainty must reach the goal, so that a wide bar cannot pass for agreement. */
#include "command.h"
#include "render/render.h"
#include "render_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: steradian validate [CASES.tsv] [OPTIONS]\n"
    "\n"
    "Measures the meters of the scenes that a table of cases names, and compares them with what is expected\n"
    "(default: validation/cases.tsv). A case passes if |z| < 4.9 (or within 1e-5, the resolution of single precision) with a\n"
    "relative standard uncertainty within the goal.\n"
    "\n"
    "      --case TEXT        only cases whose id or scene contains it\n"
    "      --estimator NAME   (also --integrator) in place of the scene's\n"
    "      --goal E           relative standard uncertainty to reach: 1% or 0.000125 (default: 1%)\n"
    "      --samples N        the most samples of a case (default: 400/E^2, at most 2^28)\n"
    "      --seed S, --threads N\n"
    "      --markdown FILE    the table as a page as well\n"
    "      --json             the table as JSON\n"
    "\n"
    "Exit codes: 0 all pass, 1 one does not, 2 usage, 3 a bad table or scene, 4 out of resources, 129/130/143 interrupted.\n"
    "\n"
    "Examples:\n"
    "  steradian validate\n"
    "  steradian validate --goal 0.0125% --markdown validation.md\n"
    "  steradian validate --case disk --estimator bdpt\n";

enum { OPT_CASE = 256, OPT_ESTIMATOR, OPT_GOAL, OPT_SAMPLES, OPT_SEED, OPT_THREADS, OPT_MARKDOWN, OPT_JSON };
static const struct option long_options[] = {
    {"case", required_argument, NULL, OPT_CASE},
    {"estimator", required_argument, NULL, OPT_ESTIMATOR},
    {"integrator", required_argument, NULL, OPT_ESTIMATOR},
    {"goal", required_argument, NULL, OPT_GOAL},
    {"samples", required_argument, NULL, OPT_SAMPLES},
    {"seed", required_argument, NULL, OPT_SEED},
    {"threads", required_argument, NULL, OPT_THREADS},
    {"markdown", required_argument, NULL, OPT_MARKDOWN},
    {"json", no_argument, NULL, OPT_JSON},
    {NULL, 0, NULL, 0},
};

enum { REPLICATES = 32, COLUMNS = 8, LINE = 4096 };
static const double LARGEST_Z = 4.9, FLOAT_RESOLUTION = 1e-5;

struct arguments {
    const char *table, *only, *markdown;
    struct sr_import_options import;
    double goal; // [1]
    uint64_t samples, seed, threads;
    bool json;
};

/* A row of the table, and what was found. */
struct found {
    const char *id, *scene, *meter, *what, *source;
    double expected, uncertainty; // [unit]
    struct sr_quantity measured;
    double z, relative; // [1]
    bool is_sharp, passes;
};

static int parse(int argc, char **argv, struct arguments *a)
{
    *a = (struct arguments){.table = "validation/cases.tsv", .goal = 0.01, .seed = 1};
    int option, index = 0;
    char *end;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1) {
        const char *name = option >= OPT_CASE ? long_options[index].name : "";
        bool ok = true;
        switch (option) {
        case OPT_CASE:
            a->only = optarg;
            break;
        case OPT_ESTIMATOR:
            a->import.integrator = optarg;
            break;
        case OPT_MARKDOWN:
            a->markdown = optarg;
            break;
        case OPT_JSON:
            a->json = true;
            break;
        case OPT_SAMPLES:
            ok = command_parse_uint(&command_validate, name, optarg, 64, (uint64_t)1 << 40, &a->samples);
            break;
        case OPT_SEED:
            ok = command_parse_uint(&command_validate, name, optarg, 0, UINT32_MAX, &a->seed);
            break;
        case OPT_THREADS:
            ok = command_parse_uint(&command_validate, name, optarg, 1, 1024, &a->threads);
            break;
        case OPT_GOAL:
            a->goal = strtod(optarg, &end);
            if (strcmp(end, "%") == 0)
                a->goal *= 0.01, ++end;
            if (end == optarg || *end || !(a->goal > 0 && a->goal < 1))
                return command_usage(&command_validate, "--goal %s: a share such as 1%% or 0.01 was expected", optarg);
            break;
        default:
            return command_bad_option(&command_validate, long_options, option, argv);
        }
        if (!ok)
            return SR_ERROR_USAGE;
    }
    if (!a->samples)
        a->samples = (uint64_t)fmin(400 / (a->goal * a->goal), 1 << 28);
    if (optind < argc)
        a->table = argv[optind++];
    return optind == argc ? 0 : command_usage(&command_validate, "one table of cases was expected");
}

/* Student's t as a normal deviate of the same probability. */
static double deviate(double difference, double u, double degrees)
{
    if (!(u > 0))
        return difference == 0 ? 0 : copysign(INFINITY, difference);
    double t = fabs(difference) / u;
    return copysign(t > 30 ? t : -sr_normal_quantile(fmax(sr_student_p_two_sided(t, degrees), 1e-300) / 2), difference);
}

static void judge(struct found *f, double goal)
{
    double difference = f->measured.value - f->expected;
    f->relative = difference / f->expected;
    f->z = deviate(difference, hypot(f->measured.u, f->uncertainty), f->measured.degrees);
    bool is_right = fabs(f->z) < LARGEST_Z || fabs(f->relative) <= FLOAT_RESOLUTION;
    f->is_sharp = f->measured.u <= goal * fabs(f->expected);
    f->passes = is_right && f->is_sharp;
}

static const char *verdict(const struct found *f)
{
    return f->passes ? "pass" : f->is_sharp ? "WRONG" : "NOT SHARP";
}

/* Measures the meter of one case. */
static sr_status measure(const struct arguments *a, const char *folder, struct found *f, struct sr_error *error)
{
    char path[LINE + 16];
    snprintf(path, sizeof path, "%s%s", folder, f->scene);
    bool quiet = true;
    struct sr_log log = command_log(&quiet);
    struct sr_import_result scene;
    if (sr_import_pbrt(path, &a->import, &scene, &log, error) != SR_OK)
        return error->status;
    const struct sr_meter *meter = NULL;
    for (uint32_t i = 0; i < scene.meter_count; ++i)
        if (strcmp(sr_meter_common(&scene.meters[i])->name, f->meter) == 0)
            meter = &scene.meters[i];
    if (!meter) {
        sr_import_result_free(&scene);
        return sr_fail(error, SR_ERROR_INPUT, "%s has no meter \"%s\", which %s names", path, f->meter, a->table);
    }
    struct sr_render_job job = sr_render_job_of(&scene);
    job.sampler = SR_SAMPLER_SOBOL;
    job.seed = (uint32_t)a->seed;
    job.threads = (int)a->threads;
    job.cancel = &render_interrupted;
    // the target is an expanded uncertainty, the goal a standard one; rounds stop a little below
    double k = sr_student_quantile(0.975, REPLICATES - 1);
    struct sr_measure_settings settings = {
        .samples = a->samples, .replicates = REPLICATES, .error = 0.9 * k * a->goal, .system = SR_PHOTOPIC};
    struct sr_arena arena = {0};
    struct sr_measurement m;
    sr_status status = sr_measure(&job, meter, &settings, &arena, &m, error);
    f->measured = m.value[SR_PHOTOPIC];
    sr_arena_free(&arena);
    sr_import_result_free(&scene);
    return status;
}

/* Splits at tabs; the number of columns. */
static int split(char *line, char *column[COLUMNS])
{
    int n = 0;
    line[strcspn(line, "\r\n")] = 0;
    for (char *p = line; p && n < COLUMNS; ++n) {
        column[n] = p;
        p = strchr(p, '\t');
        if (p)
            *p++ = 0;
    }
    return n;
}

static void print_row(FILE *out, const struct found *f, bool is_markdown)
{
    char reading[256];
    sr_quantity_text(NULL, &f->measured, reading, sizeof reading);
    if (is_markdown)
        fprintf(out, "| %s | [%s](../validation/%s) | %.9g | %s | %+.1e | %+.2f | %s |\n", f->id, f->what, f->scene,
                f->expected, reading, f->relative, f->z, verdict(f));
    else
        fprintf(out, "%-16.16s %-34.34s %-13.9g %-52s %+9.1e %+6.2f %s\n", f->id,
                f->scene + (strncmp(f->scene, "scenes/", 7) == 0 ? 7 : 0), f->expected, reading, f->relative, f->z,
                verdict(f));
    fflush(out);
}

static json_t *row_json(const struct found *f)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:f, s:f, s:o, s:o, s:o, s:s}", "case", command_json_text(f->id),
                     "scene", command_json_text(f->scene), "meter", command_json_text(f->meter), "what",
                     command_json_text(f->what), "source", command_json_text(f->source), "expected", f->expected,
                     "expected_uncertainty", f->uncertainty, "measured", command_json_measured(&f->measured),
                     "relative_difference", command_json_number(f->relative), "z", command_json_number(f->z), "verdict",
                     verdict(f));
}

static sr_status open_page(const struct arguments *a, struct command_page *page, struct sr_error *error)
{
    if (command_page_open(a->markdown, page, error) != SR_OK || !page->out)
        return error->status;
    fprintf(
        page->out,
        "# Validation\n\n"
        "Scenes whose answers are known, measured by `steradian validate --goal %g` (estimator: %s). Each is a pbrt-v4 file in\n"
        "`validation/scenes`, written from its closed form by `validation/generate.py`; expected values also stand in\n"
        "`validation/cases.tsv`, so that other programs can be run on them. Rows named CIE 171 are of the kinds of cases of\n"
        "CIE 171:2006, with closed forms of our own: validated against, never certified. Intervals: 95 %%, Student, from %d\n"
        "replicates. A case passes if |z| < %g, or within %g of its value.\n\n"
        "| case | what | expected | measured | relative difference | z | verdict |\n|---|---|---|---|---|---|---|\n",
        a->goal, a->import.integrator ? a->import.integrator : "that of each scene", REPLICATES, LARGEST_Z,
        FLOAT_RESOLUTION);
    return SR_OK;
}

static sr_status run_table(const struct arguments *a, FILE *table, FILE *page, json_t *rows, int counts[2],
                           struct sr_error *error)
{
    char line[LINE], folder[LINE] = "", *column[COLUMNS];
    const char *slash = strrchr(a->table, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash + 1 - a->table) : 0, a->table);
    for (int number = 1; fgets(line, sizeof line, table) && !error->status; ++number) {
        int n = split(line, column);
        if (number == 1 || (n == 1 && !*column[0]))
            continue;
        char *end = "";
        struct found f = {.id = column[0]};
        if (n >= COLUMNS) {
            f = (struct found){
                .id = column[0], .scene = column[1], .meter = column[2], .what = column[6], .source = column[7]};
            f.expected = strtod(column[3], &end);
            f.uncertainty = fabs(f.expected) * strtod(column[5], NULL);
        }
        if (n < COLUMNS || *end || !(fabs(f.expected) > 0))
            return sr_fail(
                error, SR_ERROR_INPUT,
                "%s:%d: case, scene, meter, expected value (not 0), unit, its relative uncertainty, what, source were expected, "
                "separated by tabs",
                a->table, number);
        if (a->only && !strstr(f.id, a->only) && !strstr(f.scene, a->only))
            continue;
        if (measure(a, folder, &f, error) != SR_OK)
            break;
        judge(&f, a->goal);
        counts[0] += 1;
        counts[1] += f.passes;
        if (rows)
            json_array_append_new(rows, row_json(&f));
        else
            print_row(stdout, &f, false);
        if (page)
            print_row(page, &f, true);
    }
    return error->status;
}

static int run(int argc, char **argv)
{
    struct arguments a;
    int code = parse(argc, argv, &a), counts[2] = {0};
    if (code)
        return code;
    struct sr_error error = {0};
    struct command_page page;
    FILE *table = fopen(a.table, "r");
    if (!table) {
        sr_fail(&error, SR_ERROR_INPUT, "%s cannot be read: a table of cases was expected", a.table);
        return command_fail("validate", &error);
    }
    json_t *rows = a.json ? json_array() : NULL;
    render_catch_interrupts();
    if (open_page(&a, &page, &error) == SR_OK) {
        if (!rows)
            printf("%-16s %-34s %-13s %-52s %9s %6s verdict\n", "case", "scene", "expected", "measured", "relative",
                   "z");
        run_table(&a, table, page.out, rows, counts, &error);
    }
    fclose(table);
    if (page.out)
        fprintf(page.out, "\n%d of %d cases pass.\n", counts[1], counts[0]);
    if (!error.status && counts[0] == 0)
        sr_fail(&error, SR_ERROR_INPUT, "%s holds no case%s%s", a.table, a.only ? " with " : "", a.only ? a.only : "");
    command_page_close(&page, &error);
    if (error.status == SR_CANCELLED || atomic_load(&render_interrupted)) {
        json_decref(rows);
        return render_interrupt_exit();
    }
    if (error.status) {
        json_decref(rows);
        return command_fail("validate", &error);
    }
    if (rows)
        code = command_print_json("validate", json_pack("{s:s, s:f, s:i, s:i, s:o}", "version", SR_VERSION, "goal",
                                                        a.goal, "cases", counts[0], "passed", counts[1], "rows", rows));
    else
        printf("%d of %d cases pass\n", counts[1], counts[0]);
    return code ? code : counts[0] == counts[1] ? 0 : 1;
}

const struct command command_validate = {"validate", "scenes whose answers are known, measured and compared", help,
                                         run};
