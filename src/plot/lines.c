/* SPDX-License-Identifier: MIT */
/* Curves over x and y, with bands about them, points, and marks across the panel. */
#include "plot/private.h"

enum { MARK = 1000 }; // points that a mark's word counts for, that no legend lies on it

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
    double(*run)[2] = sr_arena_alloc(&canvas->arena, ((size_t)c->count + 1) * sizeof *run);
    canvas->has_no_memory |= !run;
    size_t length = 0;
    for (uint32_t i = 0; i <= c->count && run && !c->has_no_line; ++i) {
        if (i < c->count && !isnan(c->x[i]) && !isnan(c->y[i])) {
            run[length][0] = place_x(box, x, c->x[i]);
            run[length++][1] = place_y(box, y, c->y[i]);
        } else {
            sr_canvas_run(canvas, (const double(*)[2])run, length);
            length = 0;
        }
    }
    cairo_stroke(canvas->cr);
    cairo_set_dash(canvas->cr, NULL, 0, 0);
    for (uint32_t i = 0; i < c->count && c->has_points; ++i)
        if (!isnan(c->x[i]) && !isnan(c->y[i])) {
            cairo_arc(canvas->cr, place_x(box, x, c->x[i]), place_y(box, y, c->y[i]), 2.6, 0, 6.2831853);
            cairo_fill(canvas->cr);
        }
}

/* Where the curves run, a point each few px: what a legend must not lie on. */
static size_t trail(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *x,
                    const struct sr_plot_axis *y, const struct sr_plot_panel *panel, double (**points)[2])
{
    enum { STEPS = 8 };
    size_t room = 0, count = 0;
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        room += (size_t)panel->curves[c].count * STEPS;
    *points = sr_arena_alloc(&canvas->arena, (room + (size_t)panel->mark_count * MARK + 1) * sizeof **points);
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
    return count;
}

/* Marks with their words along the line, above or below, where fewer points of curves lie. Their places join the
 * points, each so often that no legend goes there. */
static size_t draw_marks(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_axis *x,
                         const struct sr_plot_panel *panel, double (*points)[2], size_t count)
{
    size_t total = count;
    for (uint32_t i = 0; i < panel->mark_count; ++i) {
        double at = place_x(box, x, panel->marks[i].x);
        if (!(at >= box.x0 && at <= box.x1))
            continue;
        sr_canvas_colour(canvas, PLOT_SOFT_INK);
        sr_canvas_dash(canvas, SR_PLOT_DASHED, 1);
        sr_canvas_line(canvas, at, box.y0, at, box.y1);
        cairo_set_dash(canvas->cr, NULL, 0, 0);
        struct plot_type type = {.along_height = 1, .is_upward = true, .has_halo = true, .colour = PLOT_SOFT_INK};
        double length = sr_canvas_text_width(canvas, &type, panel->marks[i].label) + 10;
        double left = at - box.x0 > 16 ? at - 13 : at + 4;
        size_t above = 0, below = 0;
        for (size_t k = 0; k < count; ++k)
            if (points[k][0] > left - 3 && points[k][0] < left + 14) {
                above += points[k][1] < box.y0 + length;
                below += points[k][1] > box.y1 - length;
            }
        bool is_above = above <= below;
        type.across = is_above ? 1 : 0;
        sr_canvas_text(canvas, left, is_above ? box.y0 + 6 : box.y1 - 6, &type, panel->marks[i].label);
        for (int k = 0; k < MARK; ++k, ++total) {
            points[total][0] = left + 6;
            points[total][1] = is_above ? box.y0 + length * k / MARK : box.y1 - length * k / MARK;
        }
    }
    return total;
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
    double(*points)[2];
    size_t count = trail(canvas, box, &x, &y, panel, &points);
    if (!points)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the panel \"%s\"",
                       panel->title ? panel->title : "");
    count = draw_marks(canvas, box, &x, panel, points, count);
    if (!panel->has_no_legend)
        sr_plot_legend_corner(canvas, box, panel->curves, panel->curve_count, (const double(*)[2])points, count);
    return SR_OK;
}
