/* SPDX-License-Identifier: MIT */
/* Lines, texts and pixels through cairo; each text leaves its box, so that what cannot be read can be found.
 *
 * Texts have two marks, _{…} and ^{…}: set smaller, below or above the line. */
#include "plot/private.h"

#include <stdio.h>
#include <string.h>

static const double small = 0.72, down = 0.22, up = 0.38; // [em]

static void set_font(struct plot_canvas *canvas, const struct plot_type *type, double share)
{
    cairo_select_font_face(canvas->cr, canvas->family, CAIRO_FONT_SLANT_NORMAL,
                           type->is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(canvas->cr, (type->size > 0 ? type->size : PLOT_TICK_SIZE) * share);
}

/* Walks along the runs of the text from (x, y); draws them, or adds their outlines to the path. The width. */
static double run_along(struct plot_canvas *canvas, double x, double y, const struct plot_type *type, const char *text,
                        bool draws, bool is_path)
{
    double size = type->size > 0 ? type->size : PLOT_TICK_SIZE, pen = 0;
    for (const char *p = text; *p;) {
        double shift = 0, share = 1;
        size_t length = strlen(p);
        const char *begin = p, *next = p + length;
        if ((p[0] == '_' || p[0] == '^') && p[1] == '{' && strchr(p, '}')) {
            shift = p[0] == '_' ? down : -up;
            share = small;
            begin = p + 2;
            length = (size_t)(strchr(p, '}') - begin);
            next = begin + length + 1;
        } else {
            for (const char *q = p + 1; *q; ++q)
                if ((q[0] == '_' || q[0] == '^') && q[1] == '{') {
                    length = (size_t)(q - p);
                    next = q;
                    break;
                }
        }
        char run[256];
        if (length >= sizeof run)
            length = sizeof run - 1;
        memcpy(run, begin, length);
        run[length] = 0;
        set_font(canvas, type, share);
        cairo_text_extents_t extents;
        cairo_text_extents(canvas->cr, run, &extents);
        if (draws) {
            cairo_move_to(canvas->cr, x + pen, y + shift * size);
            if (is_path)
                cairo_text_path(canvas->cr, run);
            else
                cairo_show_text(canvas->cr, run);
        }
        pen += extents.x_advance;
        p = next;
    }
    return pen;
}

double sr_canvas_text_width(struct plot_canvas *canvas, const struct plot_type *type, const char *text)
{
    return run_along(canvas, 0, 0, type, text, false, false);
}

void sr_canvas_text(struct plot_canvas *canvas, double x, double y, const struct plot_type *type, const char *text)
{
    if (!text || !*text)
        return;
    double size = type->size > 0 ? type->size : PLOT_TICK_SIZE, width = sr_canvas_text_width(canvas, type, text);
    double left = -type->across * width, base = 0.73 * size * type->along_height;
    cairo_save(canvas->cr);
    cairo_translate(canvas->cr, x, y);
    if (type->is_upward)
        cairo_rotate(canvas->cr, -3.14159265358979 / 2);
    if (type->has_halo) {
        cairo_set_source_rgba(canvas->cr, 1, 1, 1, 0.85);
        cairo_set_line_width(canvas->cr, 3);
        cairo_set_dash(canvas->cr, NULL, 0, 0);
        cairo_new_path(canvas->cr);
        run_along(canvas, left, base, type, text, true, true);
        cairo_stroke(canvas->cr);
    }
    sr_canvas_colour(canvas, type->colour.a > 0 ? type->colour : PLOT_INK);
    run_along(canvas, left, base, type, text, true, false);
    cairo_new_path(canvas->cr);
    cairo_restore(canvas->cr);

    bool has_below = strstr(text, "_{") != NULL, has_above = strstr(text, "^{") != NULL;
    double top = base - (has_above ? 0.95 : 0.76) * size, bottom = base + (has_below ? 0.3 : 0.02) * size;
    struct plot_box box = {x + left, y + top, x + left + width, y + bottom};
    if (type->is_upward)
        box = (struct plot_box){x + top, y - left - width, x + bottom, y - left};
    struct plot_text_box *kept = sr_array_push(&canvas->texts, sizeof *kept);
    if (!kept) {
        canvas->has_no_memory = true;
        return;
    }
    kept->box = box;
    snprintf(kept->text, sizeof kept->text, "%s", text);
}

void sr_canvas_colour(struct plot_canvas *canvas, struct sr_plot_colour c)
{
    if (c.a >= 1)
        cairo_set_source_rgb(canvas->cr, (double)c.r, (double)c.g, (double)c.b);
    else
        cairo_set_source_rgba(canvas->cr, (double)c.r, (double)c.g, (double)c.b, (double)c.a);
}

void sr_canvas_dash(struct plot_canvas *canvas, enum sr_plot_dash dash, double width)
{
    static const double patterns[][4] = {{0}, {4.5, 2.5}, {1, 2}, {5, 2, 1, 2}};
    static const int counts[] = {0, 2, 2, 4};
    double lengths[4];
    for (int i = 0; i < counts[dash]; ++i)
        lengths[i] = patterns[dash][i] * (width > 1 ? width : 1);
    cairo_set_dash(canvas->cr, lengths, counts[dash], 0);
    cairo_set_line_width(canvas->cr, width);
}

void sr_canvas_line(struct plot_canvas *canvas, double x0, double y0, double x1, double y1)
{
    cairo_move_to(canvas->cr, sr_canvas_round(x0), sr_canvas_round(y0));
    cairo_line_to(canvas->cr, sr_canvas_round(x1), sr_canvas_round(y1));
    cairo_stroke(canvas->cr);
}

/* Keeps the point that lies farthest from the chord, and so on in both halves (Ramer 1972, Douglas & Peucker 1973). */
static void keep(const double (*p)[2], size_t first, size_t last, bool *kept)
{
    const double hair = 0.06; // [px]
    while (last > first + 1) {
        double dx = p[last][0] - p[first][0], dy = p[last][1] - p[first][1], length2 = dx * dx + dy * dy, most = 0;
        size_t farthest = first;
        for (size_t i = first + 1; i < last; ++i) {
            double x = p[i][0] - p[first][0], y = p[i][1] - p[first][1];
            double t = length2 > 0 ? fmin(1, fmax(0, (x * dx + y * dy) / length2)) : 0;
            double off = hypot(x - t * dx, y - t * dy);
            if (off > most) {
                most = off;
                farthest = i;
            }
        }
        if (most < hair)
            return;
        kept[farthest] = true;
        keep(p, first, farthest, kept);
        first = farthest;
    }
}

void sr_canvas_run(struct plot_canvas *canvas, const double (*points)[2], size_t count)
{
    bool *kept = sr_alloc(count + 1);
    canvas->has_no_memory |= !kept;
    if (kept && count > 2)
        keep(points, 0, count - 1, kept);
    for (size_t i = 0; i < count; ++i) {
        double x = sr_canvas_round(points[i][0]), y = sr_canvas_round(points[i][1]);
        if (i == 0)
            cairo_move_to(canvas->cr, x, y);
        else if (!kept || kept[i] || i + 1 == count)
            cairo_line_to(canvas->cr, x, y);
    }
    sr_free(kept);
}

sr_status sr_canvas_pixels(struct plot_canvas *canvas, const uint32_t *pixels, uint32_t width, uint32_t height,
                           struct plot_box box, bool is_smooth, struct sr_error *error)
{
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
    if (cairo_surface_status(image) != CAIRO_STATUS_SUCCESS) {
        cairo_surface_destroy(image);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a picture of %u x %u pixels", width, height);
    }
    cairo_surface_flush(image);
    for (uint32_t y = 0; y < height; ++y)
        memcpy(cairo_image_surface_get_data(image) + (size_t)y * (size_t)cairo_image_surface_get_stride(image),
               pixels + (size_t)y * width, (size_t)width * sizeof *pixels);
    cairo_surface_mark_dirty(image);
    cairo_save(canvas->cr);
    cairo_translate(canvas->cr, box.x0, box.y0);
    cairo_scale(canvas->cr, (box.x1 - box.x0) / width, (box.y1 - box.y0) / height);
    cairo_set_source_surface(canvas->cr, image, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(canvas->cr), is_smooth ? CAIRO_FILTER_GOOD : CAIRO_FILTER_NEAREST);
    cairo_pattern_set_extend(cairo_get_source(canvas->cr), CAIRO_EXTEND_PAD);
    cairo_rectangle(canvas->cr, 0, 0, width, height);
    cairo_fill(canvas->cr);
    cairo_restore(canvas->cr);
    cairo_surface_destroy(image);
    return SR_OK;
}
