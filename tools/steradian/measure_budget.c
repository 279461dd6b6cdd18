/* SPDX-License-Identifier: MIT */
/* steradian measure --budget: which uncertainties a reading has, and what each contributes.
 *
 *     u_c^2 = u_A^2 + SUM (c_i u_i)^2,    c_i = (y(x_i + u_i) - y(x_i - u_i)) / (2 u_i),
 *         nu = u_c^4 / SUM (c_i u_i)^4 / nu_i
 *
 * GUM, JCGM 100:2008, 5.1.3 and G.4; type A: the replicates; type B: what the scene declares, each measured with the
 * same random numbers on both sides, so that their noise is the same as far as paths go alike. Limits: inputs are
 * independent; declared uncertainties have infinitely many degrees of freedom. */
#include "measure_command.h"
#include "render_command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_DECLARED = 250 };

/* One line of a budget. */
struct contribution {
    double low, high; // readings with the parameter shifted down and up
    double noise;     // standard uncertainty of half their difference, were they independent: an upper bound
};

static double half_difference(const struct contribution *c)
{
    return (c->high - c->low) / 2;
}

/* The chosen meters of the scene with one parameter shifted; false: an error, or cancelled. */
static bool measure_shifted(const struct measure_arguments *a, uint32_t shifted, double shift, const bool *chosen,
                            struct contribution *out, uint32_t stride, struct sr_error *error)
{
    struct sr_import_options options = a->import;
    struct sr_import_result scene;
    options.shifted = shifted;
    options.shift = shift;
    if (sr_import_pbrt(a->scene, &options, &scene, NULL, error) != SR_OK)
        return false;
    struct sr_render_job job = measure_job(a, &scene);
    struct sr_arena arena = {0};
    bool is_complete = true;
    for (uint32_t i = 0; i < scene.meter_count && is_complete; ++i) {
        struct sr_measurement m;
        struct sr_measure_settings s = a->settings;
        s.stream = i;
        if (!chosen[i])
            continue;
        is_complete = sr_measure(&job, &scene.meters[i], &s, &arena, &m, error) == SR_OK;
        struct contribution *c = &out[i * stride];
        *(shift > 0 ? &c->high : &c->low) = m.value[s.system].value;
        c->noise = hypot(c->noise, m.value[s.system].u / 2);
    }
    sr_arena_free(&arena);
    sr_import_result_free(&scene);
    return is_complete;
}

/* ---- what is printed ---- */

struct budget {
    const char *meter, *symbol;
    const struct sr_quantity *y;
    const struct sr_declared_uncertainty *declared;
    const struct contribution *parts;
    uint32_t count;
};

static struct sr_quantity combined(const struct budget *b)
{
    struct sr_quantity out = *b->y;
    double u[MOST_DECLARED + 1] = {b->y->u}, degrees[MOST_DECLARED + 1] = {b->y->degrees}, square = b->y->u * b->y->u;
    for (uint32_t k = 0; k < b->count; ++k) {
        u[k + 1] = half_difference(&b->parts[k]);
        degrees[k + 1] = INFINITY;
        square += u[k + 1] * u[k + 1];
    }
    out.u = sqrt(square);
    out.degrees = sr_effective_degrees(u, degrees, b->count + 1);
    return out;
}

static double sensitivity(const struct budget *b, uint32_t k)
{
    return b->declared[k].u > 0 ? half_difference(&b->parts[k]) / b->declared[k].u : 0;
}

static void print_budget(const struct budget *b)
{
    char text[256], unit[96];
    struct sr_quantity total = combined(b);
    printf("%s\n  %-24s %12s %12s %4s %-12s %14s %14s %5s\n", b->meter, "source", "value", "u", "type", "distribution",
           "sensitivity", "contribution", "ν");
    printf("  %-24s %12.6g %12.3g %4s %-12s %14g %14.3g %4.4g\n", "replicates", b->y->value, b->y->u, "A", "Student",
           1.0, b->y->u, b->y->degrees);
    for (uint32_t k = 0; k < b->count; ++k) {
        double part = fabs(half_difference(&b->parts[k]));
        printf("  %-24s %12.6g %12.3g %4s %-12s %14.6g %14.3g %6s%s\n", b->declared[k].name, b->declared[k].value,
               b->declared[k].u, "B", b->declared[k].is_rectangular ? "rectangular" : "normal", sensitivity(b, k), part,
               "∞", part < 2 * b->parts[k].noise ? "  (may be noise)" : "");
    }
    printf("  contributions in %s; combined standard uncertainty %.3g\n  %s\n\n",
           sr_unit_text(b->y->unit, unit, sizeof unit), total.u,
           sr_quantity_text(b->symbol, &total, text, sizeof text));
}

static json_t *budget_json(const struct budget *b)
{
    struct sr_quantity total = combined(b);
    json_t *sources = json_array();
    json_array_append_new(sources,
                          json_pack("{s:s, s:s, s:o, s:o, s:f, s:o, s:o}", "source", "replicates", "type", "A", "value",
                                    command_json_number(b->y->value), "u", command_json_number(b->y->u), "sensitivity",
                                    1.0, "contribution", command_json_number(b->y->u), "degrees_of_freedom",
                                    command_json_number(b->y->degrees)));
    for (uint32_t k = 0; k < b->count; ++k) {
        const struct contribution *c = &b->parts[k];
        json_array_append_new(sources, json_pack("{s:o, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:n}", "source",
                                                 command_json_text(b->declared[k].name), "type", "B", "distribution",
                                                 b->declared[k].is_rectangular ? "rectangular" : "normal", "value",
                                                 command_json_number(b->declared[k].value), "u",
                                                 command_json_number(b->declared[k].u), "sensitivity",
                                                 command_json_number(sensitivity(b, k)), "contribution",
                                                 command_json_number(fabs(half_difference(c))), "low",
                                                 command_json_number(c->low), "high", command_json_number(c->high),
                                                 "noise", command_json_number(c->noise), "degrees_of_freedom"));
    }
    return json_pack("{s:o, s:o, s:o, s:o}", "meter", command_json_text(b->meter), "symbol",
                     command_json_text(b->symbol), "combined", command_json_measured(&total), "sources", sources);
}

/* ---- all together ---- */

/* Budgets of the chosen meters, printed or in the list; false: an error, or cancelled. */
static bool tell_budgets(const struct measure_arguments *a, const struct sr_import_result *scene, const bool *chosen,
                         const struct contribution *parts, json_t *list, struct sr_error *error)
{
    struct sr_render_job job = measure_job(a, scene);
    struct sr_arena arena = {0};
    bool is_complete = true;
    for (uint32_t i = 0; i < scene->meter_count && is_complete; ++i) {
        struct sr_measurement m;
        struct sr_measure_settings s = a->settings;
        char symbol[64];
        s.stream = i;
        if (!chosen[i])
            continue;
        is_complete = sr_measure(&job, &scene->meters[i], &s, &arena, &m, error) == SR_OK;
        struct budget b = {.meter = sr_meter_common(&scene->meters[i])->name,
                           .symbol = measure_symbol(&scene->meters[i], s.system, symbol),
                           .y = &m.value[s.system],
                           .declared = scene->uncertainties,
                           .parts = &parts[i * (scene->uncertainty_count + 1)],
                           .count = scene->uncertainty_count};
        if (is_complete && a->json)
            json_array_append_new(list, budget_json(&b));
        else if (is_complete)
            print_budget(&b);
    }
    sr_arena_free(&arena);
    return is_complete;
}

int measure_budget(const struct measure_arguments *a, const struct sr_import_result *scene, const bool *chosen)
{
    uint32_t count = scene->uncertainty_count, stride = count + 1;
    struct sr_error error = {0};
    struct contribution *parts =
        count <= MOST_DECLARED ? calloc((size_t)scene->meter_count * stride, sizeof *parts) : NULL;
    if (!parts)
        sr_fail(&error, SR_ERROR_RESOURCE, "%u uncertainties of %u meters are too many: at most %d", count,
                scene->meter_count, MOST_DECLARED);
    bool is_complete = parts != NULL;
    for (uint32_t k = 0; k < count && is_complete; ++k)
        is_complete = measure_shifted(a, k + 1, -1, chosen, parts + k, stride, &error) &&
                      measure_shifted(a, k + 1, 1, chosen, parts + k, stride, &error);
    json_t *list = json_array();
    is_complete = is_complete && tell_budgets(a, scene, chosen, parts, list, &error);
    free(parts);
    if (is_complete && a->json)
        return command_print_json("measure", json_pack("{s:s, s:o, s:o}", "version", SR_VERSION, "scene",
                                                       command_json_text(a->scene), "budgets", list));
    json_decref(list);
    if (atomic_load(&render_interrupted))
        return render_interrupt_exit();
    if (is_complete && count == 0 && !a->quiet)
        fprintf(
            stderr,
            "note: the scene declares no uncertainty; a line such as\n"
            "  #@ Uncertainty \"wall\" \"string material\" \"wall\" \"string parameter\" \"reflectance\" \"float u\" 0.001\n");
    return is_complete ? 0 : command_fail("measure", &error);
}
