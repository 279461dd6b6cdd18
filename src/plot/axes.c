/* SPDX-License-Identifier: MIT */
/* Frame, grid, ticks and labels of a panel over x and y: margins follow from what the labels measure. */
#include "plot/private.h"

#include <stdio.h>
#include <stdlib.h>

void sr_plot_axis_title(const struct sr_plot_axis *axis, int exponent, char *text, size_t size)
{
    char power[32] = "";
    if (exponent)
        snprintf(power, sizeof power, "10^{%s%d}%s", exponent < 0 ? "−" : "", abs(exponent), axis->unit ? " " : "");
    const char *label = axis->label ? axis->label : "", *unit = axis->unit ? axis->unit : "";
    if (*unit || exponent)
        snprintf(text, size, "%s [%s%s]", label, power, unit);
    else
        snprintf(text, size, "%s", label);
}

struct plot_box sr_plot_title(struct plot_canvas *canvas, struct plot_box cell, const char *title)
{
    if (!title)
        return cell;
    struct plot_type type = {.size = PLOT_TITLE_SIZE, .across = 0.5, .along_height = 1};
    while (type.size > 8 && sr_canvas_text_width(canvas, &type, title) > cell.x1 - cell.x0 - 8)
        type.size -= 0.5;
    sr_canvas_text(canvas, (cell.x0 + cell.x1) / 2, cell.y0 + 4, &type, title);
    cell.y0 += PLOT_TITLE_SIZE + 11;
    return cell;
}

static double widest(struct plot_canvas *canvas, const struct sr_plot_ticks *ticks)
{
    double width = 0;
    for (int i = 0; i < ticks->count; ++i)
        width = fmax(width, sr_canvas_text_width(canvas, &(struct plot_type){0}, ticks->label[i]));
    return width;
}

/* As many ticks on x as find room without touching. */
static void ticks_across(struct plot_canvas *canvas, const struct sr_plot_axis *x, double width,
                         struct sr_plot_ticks *ticks)
{
    for (int wanted = (int)fmax(2, width / 45); wanted >= 1; --wanted) {
        sr_plot_ticks(x, wanted, ticks);
        if (ticks->count * (widest(canvas, ticks) + 9) < width)
            return;
    }
}

static void grid(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *axis, const double *at,
                 int count, bool is_x)
{
    for (int i = 0; i < count; ++i) {
        double t = sr_plot_place(axis, at[i]);
        if (is_x)
            sr_canvas_line(canvas, box.x0 + t * (box.x1 - box.x0), box.y0, box.x0 + t * (box.x1 - box.x0), box.y1);
        else
            sr_canvas_line(canvas, box.x0, box.y1 - t * (box.y1 - box.y0), box.x1, box.y1 - t * (box.y1 - box.y0));
    }
}

struct plot_box sr_plot_frame(struct plot_canvas *canvas, struct plot_box cell, struct sr_plot_axis *x,
                              struct sr_plot_axis *y, double right, bool has_grid)
{
    struct sr_plot_ticks x_ticks, y_ticks;
    struct plot_type label = {.size = PLOT_LABEL_SIZE, .across = 0.5};
    struct plot_box box = {cell.x0, cell.y0 + 7, cell.x1 - right, cell.y1 - 20 - (x->label ? 20 : 0)};
    sr_plot_ticks(y, (int)fmax(2, (box.y1 - box.y0) / 38), &y_ticks);
    box.x0 += widest(canvas, &y_ticks) + 9 + (y->label ? 22 : 0);
    ticks_across(canvas, x, box.x1 - box.x0, &x_ticks);
    if (x_ticks.count && right < 1) { // the last label may stand out by half its width
        double last = sr_plot_place(x, x_ticks.at[x->from < x->to ? x_ticks.count - 1 : 0]);
        double half = widest(canvas, &x_ticks) / 2;
        box.x1 -= fmax(4, half - (1 - last) * (box.x1 - box.x0) + 2);
    }

    if (has_grid) {
        cairo_set_line_width(canvas->cr, 0.8);
        sr_canvas_colour(canvas, PLOT_FINE_GRID);
        if (x->is_log)
            grid(canvas, box, x, x_ticks.minor, x_ticks.minor_count, true);
        if (y->is_log)
            grid(canvas, box, y, y_ticks.minor, y_ticks.minor_count, false);
        sr_canvas_colour(canvas, PLOT_GRID);
        grid(canvas, box, x, x_ticks.at, x_ticks.count, true);
        grid(canvas, box, y, y_ticks.at, y_ticks.count, false);
    }
    sr_canvas_colour(canvas, PLOT_SOFT_INK);
    cairo_set_line_width(canvas->cr, 1);
    for (int i = 0; i < x_ticks.count + x_ticks.minor_count; ++i) {
        bool is_minor = i >= x_ticks.count;
        double t = sr_plot_place(x, is_minor ? x_ticks.minor[i - x_ticks.count] : x_ticks.at[i]);
        double at = box.x0 + t * (box.x1 - box.x0);
        sr_canvas_line(canvas, at, box.y1, at, box.y1 + (is_minor ? 2.5 : 4));
        if (!is_minor)
            sr_canvas_text(canvas, at, box.y1 + 7, &(struct plot_type){.across = 0.5, .along_height = 1},
                           x_ticks.label[i]);
        sr_canvas_colour(canvas, PLOT_SOFT_INK);
    }
    for (int i = 0; i < y_ticks.count + y_ticks.minor_count; ++i) {
        bool is_minor = i >= y_ticks.count;
        double t = sr_plot_place(y, is_minor ? y_ticks.minor[i - y_ticks.count] : y_ticks.at[i]);
        double at = box.y1 - t * (box.y1 - box.y0);
        sr_canvas_line(canvas, box.x0, at, box.x0 - (is_minor ? 2.5 : 4), at);
        if (!is_minor)
            sr_canvas_text(canvas, box.x0 - 7, at, &(struct plot_type){.across = 1, .along_height = 0.5},
                           y_ticks.label[i]);
        sr_canvas_colour(canvas, PLOT_SOFT_INK);
    }
    char text[256];
    sr_plot_axis_title(x, x_ticks.exponent, text, sizeof text);
    sr_canvas_text(canvas, (box.x0 + box.x1) / 2, cell.y1 - 6, &label, text);
    sr_plot_axis_title(y, y_ticks.exponent, text, sizeof text);
    label.is_upward = true;
    sr_canvas_text(canvas, cell.x0 + 14, (box.y0 + box.y1) / 2, &label, text);
    sr_canvas_colour(canvas, PLOT_SOFT_INK);
    cairo_rectangle(canvas->cr, sr_canvas_round(box.x0), sr_canvas_round(box.y0), sr_canvas_round(box.x1 - box.x0),
                    sr_canvas_round(box.y1 - box.y0));
    cairo_stroke(canvas->cr);
    return box;
}
