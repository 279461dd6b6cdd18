/* SPDX-License-Identifier: MIT */
/* Curves over x and y, with bands about them, points, and marks across the panel. */
#include "plot/private.h"

static sr_status settle(struct sr_plot_axis *x, struct sr_plot_axis *y, const struct sr_plot_panel *panel,
                        struct sr_error *error)
{
    struct plot_range over_x = {0}, over_y = {0};
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        for (uint32_t i = 0; i < panel->curves[c].count; ++i) {
            const struct sr_plot_curve *k = &panel->curves[c];
            sr_plot_range_add(&over_x, k->x[i], x->is_log);
            sr_plot_range_add(&over_y, k->y[i], y->is_log);
            if (k->low && k->high) {
                sr_plot_range_add(&over_y, k->low[i], y->is_log);
                sr_plot_range_add(&over_y, k->high[i], y->is_log);
            }
        }
    if (!sr_plot_axis_settle(x, &over_x, true) || !sr_plot_axis_settle(y, &over_y, false))
        return sr_fail(error, SR_ERROR_INPUT, "the panel \"%s\" has nothing finite%s to show",
                       panel->title ? panel->title : "", x->is_log || y->is_log ? " and positive" : "");
    return SR_OK;
}

static double place_x(struct plot_box box, const struct sr_plot_axis *x, double value)
{
    double t = sr_plot_place(x, value);
    return box.x0 + fmin(fmax(t, -2), 3) * (box.x1 - box.x0); // NaN: -2, and nobody draws it
}

static double place_y(struct plot_box box, const struct sr_plot_axis *y, double value)
{
    double t = sr_plot_place(y, value);
    return box.y1 - fmin(fmax(t, -2), 3) * (box.y1 - box.y0);
}

static void draw_band(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *x,
                      const struct sr_plot_axis *y, const struct sr_plot_curve *c, struct sr_plot_colour colour)
{
    colour.a = 0.2f;
    sr_canvas_colour(canvas, colour);
    for (uint32_t first = 0; first < c->count; ++first) { // each run without gaps
        uint32_t last = first;
        while (last < c->count && !isnan(c->x[last]) && !isnan(c->low[last]) && !isnan(c->high[last]))
            ++last;
        for (uint32_t i = first; i < last; ++i)
            cairo_line_to(canvas->cr, sr_canvas_round(place_x(box, x, c->x[i])),
                          sr_canvas_round(place_y(box, y, c->high[i])));
        for (uint32_t i = last; i-- > first;)
            cairo_line_to(canvas->cr, sr_canvas_round(place_x(box, x, c->x[i])),
                          sr_canvas_round(place_y(box, y, c->low[i])));
        cairo_fill(canvas->cr);
        first = last;
    }
}

static void draw_curve(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *x,
                       const struct sr_plot_axis *y, const struct sr_plot_curve *c, struct sr_plot_colour colour)
{
    sr_canvas_colour(canvas, colour);
    sr_canvas_dash(canvas, c->dash, c->width > 0 ? c->width : 1.6);
    bool is_down = false;
    for (uint32_t i = 0; i < c->count && !c->has_no_line; ++i) {
        if (isnan(c->x[i]) || isnan(c->y[i])) {
            is_down = false;
            continue;
        }
        double px = sr_canvas_round(place_x(box, x, c->x[i])), py = sr_canvas_round(place_y(box, y, c->y[i]));
        if (is_down)
            cairo_line_to(canvas->cr, px, py);
        else
            cairo_move_to(canvas->cr, px, py);
        is_down = true;
    }
    cairo_stroke(canvas->cr);
    cairo_set_dash(canvas->cr, NULL, 0, 0);
    for (uint32_t i = 0; i < c->count && c->has_points; ++i)
        if (!isnan(c->x[i]) && !isnan(c->y[i])) {
            cairo_arc(canvas->cr, place_x(box, x, c->x[i]), place_y(box, y, c->y[i]), 2.6, 0, 6.2831853);
            cairo_fill(canvas->cr);
        }
}

static void draw_marks(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *x,
                       const struct sr_plot_panel *panel)
{
    for (uint32_t i = 0; i < panel->mark_count; ++i) {
        double at = place_x(box, x, panel->marks[i].x);
        if (!(at >= box.x0 && at <= box.x1))
            continue;
        sr_canvas_colour(canvas, PLOT_SOFT_INK);
        sr_canvas_dash(canvas, SR_PLOT_DASHED, 1);
        sr_canvas_line(canvas, at, box.y0, at, box.y1);
        cairo_set_dash(canvas->cr, NULL, 0, 0);
        struct plot_type type = {.across = 1, .along_height = 1, .is_upward = true, .has_halo = true,
                                 .colour = PLOT_SOFT_INK};
        bool fits_left = at - box.x0 > 16;
        sr_canvas_text(canvas, fits_left ? at - 13 : at + 4, box.y0 + 6, &type, panel->marks[i].label);
    }
}

/* Where the curves run, a point each few px: what a legend must not lie on. */
static size_t trail(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *x,
                    const struct sr_plot_axis *y, const struct sr_plot_panel *panel, double (**points)[2])
{
    enum { STEPS = 8, MARK = 2000 }; // a word hidden is worse than a curve hidden
    size_t room = 0, count = 0;
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        room += (size_t)panel->curves[c].count * STEPS;
    *points = sr_arena_alloc(&canvas->arena, (room + panel->mark_count * MARK) * sizeof **points);
    if (!*points)
        return 0;
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        for (uint32_t i = 1; i < panel->curves[c].count; ++i) {
            const struct sr_plot_curve *k = &panel->curves[c];
            if (isnan(k->y[i]) || isnan(k->y[i - 1]) || isnan(k->x[i]) || isnan(k->x[i - 1]))
                continue;
            for (int s = 0; s < STEPS; ++s, ++count) {
                double t = (double)s / STEPS;
                (*points)[count][0] = (1 - t) * place_x(box, x, k->x[i - 1]) + t * place_x(box, x, k->x[i]);
                (*points)[count][1] = (1 - t) * place_y(box, y, k->y[i - 1]) + t * place_y(box, y, k->y[i]);
            }
        }
    for (uint32_t i = 0; i < panel->mark_count; ++i)
        for (int s = 0; s < MARK; ++s, ++count) {
            (*points)[count][0] = place_x(box, x, panel->marks[i].x) - (s % 2 ? 13 : 0);
            (*points)[count][1] = box.y0 + fmin(80, box.y1 - box.y0) * s / MARK;
        }
    return count;
}

sr_status sr_plot_draw_lines(struct plot_canvas *canvas, struct plot_box cell, const struct sr_plot_panel *panel,
                             struct sr_error *error)
{
    struct sr_plot_axis x = panel->x, y = panel->y;
    if (settle(&x, &y, panel, error) != SR_OK)
        return error->status;
    cell = sr_plot_title(canvas, cell, panel->title);
    struct plot_box box = sr_plot_frame(canvas, cell, &x, &y, 0, true);
    cairo_save(canvas->cr);
    cairo_rectangle(canvas->cr, box.x0, box.y0 - 1, box.x1 - box.x0, box.y1 - box.y0 + 2);
    cairo_clip(canvas->cr);
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        if (panel->curves[c].low && panel->curves[c].high)
            draw_band(canvas, box, &x, &y, &panel->curves[c], sr_plot_curve_colour(panel->curves, c));
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        draw_curve(canvas, box, &x, &y, &panel->curves[c], sr_plot_curve_colour(panel->curves, c));
    cairo_restore(canvas->cr);
    draw_marks(canvas, box, &x, panel);
    if (!panel->has_no_legend) {
        double(*points)[2];
        size_t count = trail(canvas, box, &x, &y, panel, &points);
        sr_plot_legend_corner(canvas, box, panel->curves, panel->curve_count, (const double(*)[2])points, count);
    }
    return SR_OK;
}
