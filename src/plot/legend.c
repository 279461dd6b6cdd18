/* SPDX-License-Identifier: MIT */
/* Which colour is which curve: rows below a figure, or a box in the emptiest corner of a panel. */
#include "plot/private.h"

static const double sample = 26, gap = 6, apart = 18,
                    height = 17; // [px] line, before its text, between entries, of a row

struct sr_plot_colour sr_plot_curve_colour(const struct sr_plot_curve *curves, uint32_t i)
{
    if (curves[i].colour < 0)
        return (struct sr_plot_colour){0.55f, 0.55f, 0.55f, 1};
    return sr_plot_palette(curves[i].colour ? curves[i].colour - 1 : (int)i);
}

static void draw_entry(struct plot_canvas *canvas, double x, double y, const struct sr_plot_curve *curves, uint32_t i)
{
    const struct sr_plot_curve *c = &curves[i];
    struct sr_plot_colour colour = sr_plot_curve_colour(curves, i);
    if (c->low) {
        struct sr_plot_colour pale = colour;
        pale.a = 0.2f;
        sr_canvas_colour(canvas, pale);
        cairo_rectangle(canvas->cr, x, y - 5, sample, 10);
        cairo_fill(canvas->cr);
    }
    sr_canvas_colour(canvas, colour);
    if (!c->has_no_line) {
        sr_canvas_dash(canvas, c->dash, c->width > 0 ? c->width : 1.6);
        sr_canvas_line(canvas, x, y, x + sample, y);
        cairo_set_dash(canvas->cr, NULL, 0, 0);
    }
    if (c->has_points) {
        cairo_arc(canvas->cr, x + sample / 2, y, 2.6, 0, 6.2831853);
        cairo_fill(canvas->cr);
    }
    sr_canvas_text(canvas, x + sample + gap, y, &(struct plot_type){.along_height = 0.5}, c->label);
}

static double entry_width(struct plot_canvas *canvas, const struct sr_plot_curve *curve)
{
    return sample + gap + sr_canvas_text_width(canvas, &(struct plot_type){0}, curve->label);
}

double sr_plot_legend_rows(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_curve *curves,
                           uint32_t count, bool draws)
{
    double y = box.y0;
    for (uint32_t first = 0; first < count;) {
        double width = 0;
        uint32_t last = first;
        for (; last < count; ++last) {
            double more = curves[last].label ? entry_width(canvas, &curves[last]) + (width > 0 ? apart : 0) : 0;
            if (width > 0 && width + more > box.x1 - box.x0)
                break;
            width += more;
        }
        double x = (box.x0 + box.x1 - width) / 2;
        for (uint32_t i = first; i < last && draws; ++i)
            if (curves[i].label) {
                draw_entry(canvas, x, y + height / 2, curves, i);
                x += entry_width(canvas, &curves[i]) + apart;
            }
        y += width > 0 ? height : 0;
        first = last;
    }
    return y - box.y0;
}

void sr_plot_legend_corner(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_curve *curves,
                           uint32_t count, const double (*points)[2], size_t point_count)
{
    double width = 0, tall = 6;
    for (uint32_t i = 0; i < count; ++i)
        if (curves[i].label) {
            width = fmax(width, entry_width(canvas, &curves[i]) + 12);
            tall += height;
        }
    if (width == 0)
        return;
    // corners first, then the middles of the sides: the first of the emptiest
    static const double places[][2] = {{1, 0}, {0, 0}, {1, 1}, {0, 1}, {0.5, 0}, {0.5, 1}, {1, 0.5}, {0, 0.5}};
    size_t fewest = SIZE_MAX;
    struct plot_box best = box;
    for (size_t k = 0; k < sizeof places / sizeof places[0]; ++k) {
        double x = box.x0 + 6 + places[k][0] * (box.x1 - box.x0 - 12 - width);
        double y = box.y0 + 6 + places[k][1] * (box.y1 - box.y0 - 12 - tall);
        size_t inside = 0;
        for (size_t i = 0; i < point_count; ++i)
            inside += points[i][0] > x - 4 && points[i][0] < x + width + 4 && points[i][1] > y - 4 &&
                      points[i][1] < y + tall + 4;
        if (inside < fewest) {
            fewest = inside;
            best = (struct plot_box){x, y, x + width, y + tall};
        }
    }
    cairo_rectangle(canvas->cr, sr_canvas_round(best.x0), sr_canvas_round(best.y0), sr_canvas_round(width), tall);
    cairo_set_source_rgba(canvas->cr, 1, 1, 1, 0.86);
    cairo_fill_preserve(canvas->cr);
    sr_canvas_colour(canvas, PLOT_GRID);
    cairo_set_line_width(canvas->cr, 0.8);
    cairo_stroke(canvas->cr);
    double y = best.y0 + 3 + height / 2;
    for (uint32_t i = 0; i < count; ++i)
        if (curves[i].label) {
            draw_entry(canvas, best.x0 + 6, y, curves, i);
            y += height;
        }
}
