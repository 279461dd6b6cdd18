/* SPDX-License-Identifier: MIT */
/* steradian converge: tables, plots, CSV and JSON of a study. */
#include "converge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *sampler_name(enum sr_sampler_kind kind)
{
    return kind == SR_SAMPLER_SOBOL ? "sobol" : "independent";
}

static int write_csv(const char *path, const struct converge_study *study)
{
    struct sr_error error = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    if (!f)
        return SR_ERROR_RESOURCE;
    fprintf(f, "estimator,sampler,samples,error,error_unit,time_s,slope,slope_low,slope_high\n");
    for (uint32_t i = 0; i < study->series_count; ++i) {
        const struct converge_series *s = &study->series[i];
        for (uint32_t k = 0; k < s->count; ++k) {
            fprintf(f, "%s,%s,%.0f,%.9g,%s,%.6g", s->estimator, sampler_name(s->sampler), s->n[k], s->error[k],
                    study->unit, s->time_s[k]);
            if (s->has_slope)
                fprintf(f, ",%.4f,%.4f,%.4f\n", s->slope.slope, s->slope.low, s->slope.high);
            else
                fputs(",,,\n", f);
        }
    }
    fclose(f);
    sr_file_write(path, text, size, &error);
    free(text);
    return error.status ? command_fail("converge", &error) : 0;
}

/* Points with the fitted line and its band over samples; points alone over time. */
static int write_plot(const char *path, const struct converge_study *study)
{
    static struct sr_plot_curve curves[2 * CONVERGE_SERIES], over_time[CONVERGE_SERIES];
    static char labels[CONVERGE_SERIES][256];
    uint32_t count = 0, time_count = 0;
    for (uint32_t i = 0; i < study->series_count; ++i) {
        const struct converge_series *s = &study->series[i];
        int colour = (int)i + 1;
        if (s->has_slope)
            snprintf(labels[i], sizeof labels[i], "%s: n^{%.2f ± %.2f}", s->label, s->slope.slope,
                     0.5 * (s->slope.high - s->slope.low));
        else
            snprintf(labels[i], sizeof labels[i], "%s", s->label);
        if (s->has_slope)
            curves[count++] = (struct sr_plot_curve){.x = s->n,
                                                     .y = s->slope.line,
                                                     .low = s->slope.line_low,
                                                     .high = s->slope.line_high,
                                                     .count = s->count,
                                                     .colour = colour,
                                                     .width = 1};
        curves[count++] = (struct sr_plot_curve){.x = s->n,
                                                 .y = s->error,
                                                 .count = s->count,
                                                 .colour = colour,
                                                 .has_points = true,
                                                 .has_no_line = s->has_slope};
        over_time[time_count++] = (struct sr_plot_curve){
            .x = s->time_s, .y = s->error, .count = s->count, .colour = colour, .has_points = true};
    }
    struct sr_plot_curve legend[CONVERGE_SERIES];
    for (uint32_t i = 0; i < time_count; ++i) {
        legend[i] = over_time[i];
        legend[i].label = labels[i];
    }
    const char *unit = strcmp(study->unit, "1") == 0 ? NULL : study->unit;
    struct sr_plot_panel panels[2] = {
        {.kind = SR_PLOT_LINES,
         .title = "error over samples",
         .x = {.label = "samples", .is_log = true},
         .y = {.label = "RMS error", .unit = unit, .is_log = true},
         .curves = curves,
         .curve_count = count,
         .has_no_legend = true},
        {.kind = SR_PLOT_LINES,
         .title = "error over time",
         .x = {.label = "processor time", .unit = "s", .is_log = true},
         .y = {.label = "RMS error", .unit = unit, .is_log = true},
         .curves = over_time,
         .curve_count = time_count,
         .has_no_legend = true},
    };
    struct sr_plot_figure figure = {.title = study->what,
                                    .panels = panels,
                                    .panel_count = 2,
                                    .legend = legend,
                                    .legend_count = time_count,
                                    .scale = 2};
    struct sr_error error = {0};
    return sr_plot_write(&figure, path, &error) == SR_OK ? 0 : command_fail("converge", &error);
}

int converge_write(const struct converge_arguments *a, const struct converge_study *study)
{
    int code = 0;
    for (int i = 0; code == 0 && i < a->output_count; ++i)
        code = sr_path_has_ending(a->outputs[i], ".csv") ? write_csv(a->outputs[i], study)
                                                         : write_plot(a->outputs[i], study);
    return code;
}

void converge_print(const struct converge_arguments *a, const struct converge_study *study)
{
    int width = 9;
    for (uint32_t i = 0; i < study->series_count; ++i)
        width = (int)strlen(study->series[i].label) > width ? (int)strlen(study->series[i].label) : width;
    printf("%s\nreference %.9g", study->what, study->reference);
    if (study->reference_u > 0)
        printf(" ± %.2g (standard uncertainty, taken out of the errors)", study->reference_u);
    printf("; errors [%s]: root mean square over %llu seeds\n\n%-*s  %-28s %12s %12s %10s\n", study->unit,
           (unsigned long long)a->seeds, width, "estimator", "slope (95 %)", "at first", "at last", "time [s]");
    for (uint32_t i = 0; i < study->series_count; ++i) {
        const struct converge_series *s = &study->series[i];
        char slope[64] = "-";
        if (s->has_slope)
            snprintf(slope, sizeof slope, "%.3f (%.3f … %.3f)", s->slope.slope, s->slope.low, s->slope.high);
        printf("%-*s  %-28s %12.4g %12.4g %10.3g\n", width, s->label, slope, s->error[0], s->error[s->count - 1],
               s->time_s[s->count - 1]);
    }
}

static json_t *numbers(const double *v, uint32_t count)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; ++i)
        json_array_append_new(list, command_json_number(v[i]));
    return list;
}

int converge_print_json(const struct converge_arguments *a, const struct converge_study *study)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < study->series_count; ++i) {
        const struct converge_series *s = &study->series[i];
        json_t *slope = s->has_slope ? json_pack("{s:f, s:f, s:f, s:f}", "value", s->slope.slope, "low", s->slope.low,
                                                 "high", s->slope.high, "level", 0.95)
                                     : json_null();
        json_array_append_new(list, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "estimator", s->estimator, "sampler",
                                              sampler_name(s->sampler), "samples", numbers(s->n, s->count), "error",
                                              numbers(s->error, s->count), "time_s", numbers(s->time_s, s->count),
                                              "slope", slope));
    }
    return command_print_json(
        "converge", json_pack("{s:o, s:s, s:o, s:o, s:I, s:o}", "what", command_json_text(study->what), "unit",
                              study->unit, "reference", command_json_number(study->reference), "reference_uncertainty",
                              command_json_number(study->reference_u), "seeds", (json_int_t)a->seeds, "series", list));
}
