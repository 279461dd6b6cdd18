/* SPDX-License-Identifier: MIT */
/* Efficiency over cores, from tables of simulate-ranks --tsv and rehearse-ranks. */
#include "base/base.h"
#include "plot/plot.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: plot-ranks OUT.svg|OUT.png LABEL=TABLE.tsv [LABEL=TABLE.tsv…]\n"
    "\n"
    "Draws the tables' fourth column (efficiency) over their second (cores). A label that begins with '+' has points and no line,\n"
    "in the colour of the one before.\n";

enum { TABLES = 8, ROWS = 256 };

static uint32_t read_table(const char *path, double *cores, double *efficiency)
{
    FILE *file = fopen(path, "r");
    char line[512];
    uint32_t rows = 0;
    while (file && rows < ROWS && fgets(line, sizeof line, file))
        rows += sscanf(line, "%*f %lf %*f %lf", &cores[rows], &efficiency[rows]) == 2;
    if (file)
        fclose(file);
    for (uint32_t i = 0; i < rows; ++i)
        efficiency[i] *= 100;
    return rows;
}

int main(int argc, char **argv)
{
    static double cores[TABLES][ROWS], efficiency[TABLES][ROWS];
    struct sr_plot_curve curves[TABLES];
    uint32_t count = 0;
    int colour = 0;
    for (int i = 2; i < argc && count < TABLES; ++i, ++count) {
        char *path = strchr(argv[i], '=');
        if (!path)
            break;
        *path++ = 0;
        bool is_points = argv[i][0] == '+';
        colour += !is_points || !colour;
        curves[count] = (struct sr_plot_curve){.label = argv[i] + is_points,
                                               .x = cores[count],
                                               .y = efficiency[count],
                                               .colour = colour,
                                               .has_points = is_points,
                                               .has_no_line = is_points,
                                               .count = read_table(path, cores[count], efficiency[count])};
        if (!curves[count].count) {
            fprintf(stderr, "plot-ranks: %s: no rows of a table are in it\n", path);
            return SR_ERROR_INPUT;
        }
    }
    if (count == 0) {
        fputs(help, stderr);
        return SR_ERROR_USAGE;
    }
    struct sr_plot_panel panel = {.kind = SR_PLOT_LINES,
                                  .x = {.label = "cores", .is_log = true, .from = 1, .to = 1e5},
                                  .y = {.label = "efficiency", .unit = "%", .from = 0, .to = 100},
                                  .curves = curves,
                                  .curve_count = count,
                                  .has_no_legend = true};
    struct sr_plot_figure figure = {.panels = &panel,
                                    .panel_count = 1,
                                    .width = 640,
                                    .height = 440,
                                    .legend = curves,
                                    .legend_count = count,
                                    .scale = 2};
    struct sr_error error = {0};
    if (sr_plot_write(&figure, argv[1], &error) != SR_OK)
        fprintf(stderr, "plot-ranks: error: %s\n", error.text);
    return (int)error.status;
}
