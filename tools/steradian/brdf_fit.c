/* SPDX-License-Identifier: MIT */
/* steradian brdf fit: the parameters with which a model comes nearest to data, their uncertainties, and what is left.
 */
#include "brdf.h"
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian brdf fit DATA … --model 'MODEL [name=value …]' [OPTIONS]\n"
    "\n"
    "Least squares of a model to data: measured, or any other specimen. The model's values are where the search "
    "begins.\n"
    "\n"
    "      --model WORDS        the model to fit; needed\n"
    "      --fix NAME[,NAME …]  parameters that stay as given\n"
    "      --lambda NM[,NM …]   wavelengths [nm], up to " BRDF_MOST_LAMBDAS
    " (450,550,650): spectra get a value at each, the rest is "
    "shared\n"
    "      --metric WORD        cube-root (weighs bright and dark as eyes do), log (relative) or linear (cube-root)\n"
    "      --points N           pairs of directions (4000)\n"
    "      --starts N           searches, from the given and from other values (8)\n"
    "      --theta-max DEG      directions no closer to grazing than this (80)\n"
    "      --seed N             of the directions (1)\n"
    "      --plot FILE          data, model and residuals, as .svg or .png\n"
    "      --json               the same as JSON on standard output\n"
    "\n"
    "Intervals are of 95 %; the scatter that they come from is mostly what the model cannot follow.\n"
    "\n"
    "Examples:\n"
    "  steradian brdf fit blue-acrylic.brdf --model 'ward_gmd alpha_x=.1 alpha_y=.1' --plot fit.svg\n"
    "  steradian brdf fit sample.bsdf --model ggx_conductor_ms --fix eta,k --metric log --json\n";

static const struct option long_options[] = {
    {"model", required_argument, NULL, 'm'},
    {"fix", required_argument, NULL, 'f'},
    {"lambda", required_argument, NULL, 'l'},
    {"metric", required_argument, NULL, 'c'},
    {"points", required_argument, NULL, 'p'},
    {"starts", required_argument, NULL, 't'},
    {"theta-max", required_argument, NULL, 'g'},
    {"seed", required_argument, NULL, 's'},
    {"plot", required_argument, NULL, 'o'},
    {"json", no_argument, NULL, 'j'},
    {NULL, 0, NULL, 0},
};

enum { WORDS = 128 };
static const char *const metrics[] = {"cube-root", "log", "linear"};

struct arguments {
    char *model, *plot;
    const char *fixed[WORDS];
    uint64_t points, starts, seed;
    double theta_max; // [deg]
    struct brdf_lambda lambda;
    int fixed_count, metric;
    bool json;
};

// the pieces of text between separators, in place
static int split(char *text, const char *separators, const char **words)
{
    int count = 0;
    for (char *word; count < WORDS && (word = strtok_r(text, separators, &text));)
        words[count++] = word;
    return count;
}

static double half_interval(const struct sr_fit *fit, const struct sr_fit_parameter *p)
{
    return sr_student_quantile(0.975, fit->degrees_of_freedom) * p->standard_uncertainty;
}

static int print_json(const struct sr_fit *fit, const struct sr_specimen *data)
{
    json_t *parameters = json_array();
    for (int i = 0; i < fit->count; ++i) {
        const struct sr_fit_parameter *p = &fit->parameters[i];
        json_t *o =
            json_pack("{s:s, s:o, s:s, s:o, s:o, s:b}", "name", p->name, "value", command_json_number(p->value), "unit",
                      p->unit, "standard_uncertainty", command_json_number(p->standard_uncertainty), "half_interval_95",
                      command_json_number(half_interval(fit, p)), "is_at_bound", p->is_at_bound);
        if (p->lambda > 0)
            json_object_set_new(o, "lambda", command_json_quantity(p->lambda, "nm"));
        json_array_append_new(parameters, o);
    }
    return command_print_json(
        "brdf fit",
        json_pack("{s:o, s:s, s:o, s:o, s:o, s:i, s:o, s:b, s:o}", "data", command_json_text(data->title), "model",
                  fit->model->name, "parameters", parameters, "rms_of_metric", command_json_quantity(fit->rms, "1"),
                  "rms_of_f_cos", command_json_quantity(fit->rms_relative, "1"), "points", (int)fit->point_count,
                  "degrees_of_freedom", command_json_number(fit->degrees_of_freedom), "has_converged",
                  fit->has_converged, "specimen", command_json_text(fit->words)));
}

static void print_text(const struct sr_fit *fit, const struct sr_specimen *data)
{
    printf("%s\nfitted by %s (%s), %u pairs of directions\n\n", data->title, fit->model->name,
           fit->model->title ? fit->model->title : fit->model->name, (unsigned)fit->point_count);
    printf("%-22s %9s %14s %14s  %s\n", "parameter", "nm", "value", "+- (95 %)", "unit");
    for (int i = 0; i < fit->count; ++i) {
        const struct sr_fit_parameter *p = &fit->parameters[i];
        char nm[16] = "", interval[24] = "at its bound";
        if (p->lambda > 0)
            snprintf(nm, sizeof nm, "%g", p->lambda);
        if (isfinite(p->standard_uncertainty))
            snprintf(interval, sizeof interval, "%.3g", half_interval(fit, p));
        else if (!p->is_at_bound)
            snprintf(interval, sizeof interval, "unknown");
        printf("%-22s %9s %14.7g %14s  %s\n", p->name, nm, p->value, interval, p->unit);
    }
    printf("\nresiduals: rms %.3g %% of the data in the metric, %.3g %% in f cos theta_i\n", 100 * fit->rms,
           100 * fit->rms_relative);
    if (!fit->has_converged)
        printf("warning: the search ended before it had converged\n");
    printf("specimen: %s\n", fit->words);
}

/* ---- the figure: slices through data and model, and residuals over the half angle ---- */

enum { SLICES = 3, STEPS = 171 };

struct figure {
    double theta[STEPS], f[2 * SLICES][STEPS];
    char labels[2 * SLICES][48];
    struct sr_plot_curve curves[2 * SLICES], cloud;
};

static void fill_slices(struct figure *g, const struct sr_specimen *specimens[2], sr_spectrum lambda)
{
    static const double theta_i[SLICES] = {15, 45, 70};
    static struct sr_specimen_at at;
    for (int which = 0; which < 2; ++which) {
        sr_specimen_at(specimens[which], lambda, 1, &at);
        for (int s = 0; s < SLICES; ++s) {
            int row = 2 * s + which;
            double a = theta_i[s] * M_PI / 180;
            sr_vec3 wi = {(float)-sin(a), 0, (float)cos(a)};
            for (int k = 0; k < STEPS; ++k) {
                double t = g->theta[k] = k - 85.0, b = t * M_PI / 180;
                double f = (double)sr_bsdf_f(&at.bsdf, (sr_vec3){(float)sin(b), 0, (float)cos(b)}, wi, SR_RADIANCE)[0];
                g->f[row][k] = f > 0 ? f : NAN;
            }
            snprintf(g->labels[row], sizeof g->labels[row], which ? "model" : "data, θ_{i} = %g°", theta_i[s]);
            g->curves[row] = (struct sr_plot_curve){.label = which && s ? NULL : g->labels[row],
                                                    .x = g->theta,
                                                    .y = g->f[row],
                                                    .count = STEPS,
                                                    .colour = s + 1,
                                                    .dash = which ? SR_PLOT_DASHED : SR_PLOT_SOLID};
        }
    }
}

static sr_status plot(const struct arguments *a, const struct sr_fit *fit, const struct sr_specimen *data,
                      struct sr_arena *arena, struct sr_error *error)
{
    struct figure *g = sr_arena_alloc(arena, sizeof *g);
    double *x = sr_arena_alloc(arena, fit->point_count * sizeof *x),
           *y = sr_arena_alloc(arena, fit->point_count * sizeof *y);
    struct sr_specimen model;
    char *copy = sr_arena_string(arena, fit->words);
    const char *words[WORDS];
    if (!g || !x || !y || !copy)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    int count = split(copy, " ", words);
    bool quiet = true;
    if (sr_specimen_read(arena, count, words, &model, command_log(&quiet), error) != SR_OK)
        return error->status;
    fill_slices(g, (const struct sr_specimen *[2]){data, &model}, SR_BLACK + a->lambda.lambda[0]);
    for (uint32_t i = 0; i < fit->point_count; ++i) {
        const struct sr_fit_point *p = &fit->points[i];
        sr_vec3 h = sr_normalize(sr_add(p->wo, p->wi));
        x[i] = acos(fmin(1, (double)fabsf(h.z))) * 180 / M_PI;
        y[i] = p->data[0] > 0 ? 100 * (p->model[0] - p->data[0]) / (p->model[0] + p->data[0]) : NAN;
    }
    g->cloud = (struct sr_plot_curve){
        .x = x, .y = y, .count = fit->point_count, .colour = -1, .has_points = true, .has_no_line = true, .width = 0.6};
    char title[256], slices[64];
    snprintf(title, sizeof title, "%.110s fitted by %s", data->title, fit->model->name);
    snprintf(slices, sizeof slices, "plane of incidence, %g nm", (double)a->lambda.lambda[0]);
    struct sr_plot_panel panels[2] = {
        {.kind = SR_PLOT_LINES,
         .title = slices,
         .x = {.label = "θ_{o}", .unit = "°", .from = -90, .to = 90, .step = 30},
         .y = {.label = "f", .unit = "sr^{-1}", .is_log = true},
         .curves = g->curves,
         .curve_count = 2 * SLICES},
        {.kind = SR_PLOT_LINES,
         .title = "residuals of all pairs",
         .x = {.label = "θ_{h}", .unit = "°", .from = 0, .to = 90, .step = 15},
         .y = {.label = "(model - data) / (model + data)", .unit = "%", .from = -100, .to = 100, .step = 25},
         .curves = &g->cloud,
         .curve_count = 1},
    };
    struct sr_plot_figure figure = {.title = title, .panels = panels, .panel_count = 2};
    return sr_plot_write(&figure, a->plot, error);
}

static int fit(const struct arguments *a, int argc, char **argv, struct sr_arena *arena)
{
    struct sr_specimen data, model;
    struct sr_error error = {0};
    struct sr_fit result;
    struct sr_fit_point *points;
    uint32_t point_count;
    const char *words[WORDS];
    int code = brdf_read_specimen(&brdf_fit, argc, argv, arena, &data);
    if (code)
        return code;
    int count = split(a->model, " \t", words);
    static bool quiet;
    struct sr_fit_options options = {.lambda = a->lambda.lambda,
                                     .lambda_count = a->lambda.count,
                                     .points = (uint32_t)a->points,
                                     .starts = (uint32_t)a->starts,
                                     .seed = (uint32_t)a->seed,
                                     .theta_max = a->theta_max,
                                     .metric = (enum sr_fit_metric)a->metric,
                                     .fixed_count = a->fixed_count,
                                     .fixed = a->fixed};
    if (sr_specimen_read(arena, count, words, &model, command_log(&quiet), &error) != SR_OK ||
        sr_fit_gather(arena, &data, &options, &points, &point_count, &error) != SR_OK ||
        sr_fit_points(arena, points, point_count, &model, &options, &result, &error) != SR_OK ||
        (a->plot && plot(a, &result, &data, arena, &error) != SR_OK))
        return command_fail(brdf_fit.name, &error);
    if (a->json)
        return print_json(&result, &data);
    print_text(&result, &data);
    return 0;
}

static int run(int argc, char **argv)
{
    struct arguments a = {.points = 4000, .starts = 8, .seed = 1, .theta_max = 80};
    brdf_parse_lambda(&brdf_fit, "450,550,650", &a.lambda);
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":", long_options, &index)) != -1) {
        bool ok = true;
        switch (option) {
        case 'm':
            a.model = optarg;
            break;
        case 'f':
            a.fixed_count = split(optarg, ",", a.fixed);
            break;
        case 'l':
            ok = brdf_parse_lambda(&brdf_fit, optarg, &a.lambda);
            break;
        case 'c':
            for (a.metric = 0; a.metric < 3 && strcmp(optarg, metrics[a.metric]) != 0;)
                ++a.metric;
            if (a.metric == 3)
                return command_usage(&brdf_fit, "--metric %s: cube-root, log or linear was expected", optarg);
            break;
        case 'p':
            ok = command_parse_uint(&brdf_fit, "points", optarg, 10, 1000000, &a.points);
            break;
        case 't':
            ok = command_parse_uint(&brdf_fit, "starts", optarg, 1, 1000, &a.starts);
            break;
        case 'g':
            ok = command_parse_float(&brdf_fit, "theta-max", optarg, 1, 89.9, &a.theta_max);
            break;
        case 's':
            ok = command_parse_uint(&brdf_fit, "seed", optarg, 0, UINT32_MAX, &a.seed);
            break;
        case 'o':
            a.plot = optarg;
            break;
        case 'j':
            a.json = true;
            break;
        default:
            return command_bad_option(&brdf_fit, long_options, option, argv);
        }
        if (!ok)
            return SR_ERROR_USAGE;
    }
    if (!a.model)
        return command_usage(&brdf_fit, "--model 'MODEL [name=value …]' was expected");
    struct sr_arena arena = {0};
    int code = fit(&a, argc, argv, &arena);
    sr_arena_free(&arena);
    return code;
}

const struct command brdf_fit = {"brdf fit", "the parameters with which a model comes nearest to data", help, run};
