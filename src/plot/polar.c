/* SPDX-License-Identifier: MIT */
/* Curves over an angle and a radius: how lobes are shown. Angles run from the top, clockwise: the normal points up.
 *
 * The radius is in proportion to the value, or to its logarithm over the axis' lowest value, which lies in the centre.
 */
#include "plot/private.h"

#include <stdio.h>
#include <stdlib.h>

struct disc {
    double cx, cy, radius; // [px]
    double from, to;       // [°]
    bool is_whole;
    double up;          // [1] 1: angles run from the top, -1: from the bottom
    double left, right; // [px] of the cell
};

static const double pi = 3.14159265358979;
static const double ring = 15; // [px] where the angles stand, beyond the disc

static double across(const struct disc *d, double angle_deg, double r)
{
    return d->cx + r * sin(angle_deg * pi / 180);
}

static double height(const struct disc *d, double angle_deg, double r)
{
    return d->cy - d->up * r * cos(angle_deg * pi / 180);
}

static sr_status settle(struct sr_plot_axis *radius, bool *is_whole, const struct sr_plot_panel *panel,
                        struct sr_error *error)
{
    struct plot_range range = {0};
    *is_whole = panel->x.from < -91 || panel->x.to > 91;
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        for (uint32_t i = 0; i < panel->curves[c].count; ++i) {
            sr_plot_range_add(&range, panel->curves[c].y[i], radius->is_log);
            if (panel->x.from == panel->x.to)
                *is_whole |= fabs(panel->curves[c].x[i]) > 91;
        }
    if (!radius->is_log && radius->from == radius->to && range.some) {
        radius->from = 0; // an area about the centre means nothing else
        radius->to = range.hi > 0 ? 1.04 * range.hi : 1;
    }
    if (!sr_plot_axis_settle(radius, &range, false))
        return sr_fail(error, SR_ERROR_INPUT, "the panel \"%s\" has nothing finite%s to show",
                       panel->title ? panel->title : "", radius->is_log ? " and positive" : "");
    if (radius->is_log && panel->y.from == panel->y.to)
        radius->from = fmin(radius->from, 1e-4 * radius->to); // a lobe is told from a circle
    return SR_OK;
}

static void arc(struct plot_canvas *canvas, const struct disc *d, double r)
{
    cairo_new_sub_path(canvas->cr);
    cairo_arc(canvas->cr, d->cx, d->cy, r, (d->from - 90) * pi / 180, (d->to - 90) * pi / 180);
    if (d->is_whole)
        cairo_close_path(canvas->cr);
    cairo_stroke(canvas->cr);
}

/* Puts a text beyond the disc, on the side where it does not touch it. */
static void text_beyond(struct plot_canvas *canvas, const struct disc *d, double angle_deg, double beyond,
                        struct plot_type type, const char *text)
{
    type.across = 0.5 - 0.5 * sin(angle_deg * pi / 180);
    type.along_height = 0.5 - 0.5 * d->up * cos(angle_deg * pi / 180);
    double width = sr_canvas_text_width(canvas, &type, text), x = across(d, angle_deg, d->radius + beyond);
    x = fmin(fmax(x, d->left + type.across * width), d->right - (1 - type.across) * width);
    sr_canvas_text(canvas, x, height(d, angle_deg, d->radius + beyond), &type, text);
}

static bool is_near_mark(const struct sr_plot_panel *panel, double angle_deg, double within_deg)
{
    for (uint32_t i = 0; i < panel->mark_count; ++i)
        if (fabs(panel->marks[i].x - angle_deg) < within_deg)
            return true;
    return false;
}

static void draw_angles(struct plot_canvas *canvas, const struct disc *d, const struct sr_plot_panel *panel)
{
    cairo_set_line_width(canvas->cr, 0.8);
    for (int deg = (int)d->from; deg <= (int)d->to - (d->is_whole ? 30 : 0); deg += 30) {
        sr_canvas_colour(canvas, PLOT_GRID);
        sr_canvas_line(canvas, d->cx, d->cy, across(d, deg, d->radius), height(d, deg, d->radius));
        char text[32];
        snprintf(text, sizeof text, "%s%d°", deg < 0 && d->up > 0 ? "−" : "", abs(deg));
        if (!is_near_mark(panel, deg, 9))
            text_beyond(canvas, d, deg, 5, (struct plot_type){0}, text);
    }
    if (panel->x.label) {
        static const double places[] = {45, -45, 15, -15, 75, -75};
        double place = places[0];
        for (size_t i = 0; i < sizeof places / sizeof places[0]; ++i)
            if (!is_near_mark(panel, places[i], 14)) {
                place = places[i];
                break;
            }
        text_beyond(canvas, d, place, 8, (struct plot_type){.size = PLOT_LABEL_SIZE}, panel->x.label);
    }
    for (uint32_t i = 0; i < panel->mark_count; ++i) {
        double deg = panel->marks[i].x;
        sr_canvas_colour(canvas, PLOT_SOFT_INK);
        sr_canvas_dash(canvas, SR_PLOT_DASHED, 1);
        sr_canvas_line(canvas, d->cx, d->cy, across(d, deg, d->radius), height(d, deg, d->radius));
        cairo_set_dash(canvas->cr, NULL, 0, 0);
        text_beyond(canvas, d, deg, 5, (struct plot_type){.colour = PLOT_SOFT_INK}, panel->marks[i].label);
    }
}

static void draw_radii(struct plot_canvas *canvas, const struct disc *d, const struct sr_plot_axis *radius)
{
    struct sr_plot_ticks ticks;
    sr_plot_ticks(radius, (int)fmax(2, d->radius / 38), &ticks);
    struct plot_type type = {
        .size = PLOT_TICK_SIZE - 1, .across = 0.5, .along_height = d->is_whole ? 0.5 : 1, .has_halo = d->is_whole};
    double last = -INFINITY;
    for (int i = 0; i < ticks.count; ++i) {
        double r = sr_plot_place(radius, ticks.at[i]) * d->radius;
        sr_canvas_colour(canvas, PLOT_GRID);
        cairo_set_line_width(canvas->cr, 0.8);
        if (r > 0.5)
            arc(canvas, d, r);
        double half = sr_canvas_text_width(canvas, &type, ticks.label[i]) / 2;
        if (r - half < last + 6 || (d->is_whole && (r < 0.5 || r + half > d->radius)))
            continue;
        last = r + half;
        sr_canvas_text(canvas, d->cx + r, d->cy + (d->is_whole ? 0 : 5), &type, ticks.label[i]);
    }
    char text[256];
    sr_plot_axis_title(radius, ticks.exponent, text, sizeof text);
    struct plot_type label = {.size = PLOT_LABEL_SIZE, .across = 0.5, .along_height = 1};
    sr_canvas_text(canvas, d->cx + (d->is_whole ? 0 : d->radius / 2), d->cy + (d->is_whole ? d->radius + ring + 8 : 20),
                   &label, text);
    sr_canvas_colour(canvas, PLOT_SOFT_INK);
    cairo_set_line_width(canvas->cr, 1);
    arc(canvas, d, d->radius);
    if (!d->is_whole)
        sr_canvas_line(canvas, d->cx - d->radius, d->cy, d->cx + d->radius, d->cy);
}

static void draw_curve(struct plot_canvas *canvas, const struct disc *d, const struct sr_plot_axis *radius,
                       const struct sr_plot_curve *c, struct sr_plot_colour colour)
{
    double(*run)[2] = sr_arena_alloc(&canvas->arena, ((size_t)c->count + 1) * sizeof *run);
    canvas->has_no_memory |= !run;
    size_t length = 0;
    for (uint32_t i = 0; i <= c->count && run; ++i) {
        if (i < c->count && !isnan(c->x[i]) && !isnan(c->y[i])) {
            double r = fmin(fmax(sr_plot_place(radius, c->y[i]), 0), 3) * d->radius;
            run[length][0] = across(d, c->x[i], r);
            run[length++][1] = height(d, c->x[i], r);
        } else {
            sr_canvas_run(canvas, (const double(*)[2])run, length);
            length = 0;
        }
    }
    sr_canvas_colour(canvas, colour);
    sr_canvas_dash(canvas, c->dash, c->width > 0 ? c->width : 1.6);
    cairo_stroke(canvas->cr);
    cairo_set_dash(canvas->cr, NULL, 0, 0);
}

sr_status sr_plot_draw_polar(struct plot_canvas *canvas, struct plot_box cell, const struct sr_plot_panel *panel,
                             struct sr_error *error)
{
    struct sr_plot_axis radius = panel->y;
    struct disc d = {.from = -90, .to = 90, .up = panel->points_down ? -1 : 1, .left = cell.x0, .right = cell.x1};
    if (settle(&radius, &d.is_whole, panel, error) != SR_OK)
        return error->status;
    d.is_whole |= panel->points_down;
    if (d.is_whole) {
        d.from = -180;
        d.to = 180;
    }
    cell = sr_plot_title(canvas, cell, panel->title);
    double rows =
        panel->has_no_legend ? 0 : sr_plot_legend_rows(canvas, cell, panel->curves, panel->curve_count, false);
    double below = d.is_whole ? 2 * ring + 8 : 38, side = 34;
    double wide = cell.x1 - cell.x0, tall = cell.y1 - cell.y0 - rows - below - ring - 5;
    d.radius = fmin(wide / 2 - side, d.is_whole ? tall / 2 : tall);
    if (!(d.radius > 20))
        return sr_fail(error, SR_ERROR_INPUT, "the panel \"%s\" is too small", panel->title ? panel->title : "");
    double spare = tall - (d.is_whole ? 2 : 1) * d.radius;
    d.cx = (cell.x0 + cell.x1) / 2;
    d.cy = cell.y0 + spare / 2 + ring + 5 + d.radius;
    draw_angles(canvas, &d, panel);
    draw_radii(canvas, &d, &radius);

    cairo_save(canvas->cr);
    cairo_arc(canvas->cr, d.cx, d.cy, d.radius + 1, 0, 2 * pi);
    cairo_clip(canvas->cr);
    for (uint32_t c = 0; c < panel->curve_count; ++c)
        draw_curve(canvas, &d, &radius, &panel->curves[c], sr_plot_curve_colour(panel->curves, c));
    cairo_restore(canvas->cr);
    if (rows > 0)
        sr_plot_legend_rows(canvas, (struct plot_box){cell.x0, d.cy + (d.is_whole ? d.radius : 0) + below, cell.x1, 0},
                            panel->curves, panel->curve_count, true);
    return SR_OK;
}
