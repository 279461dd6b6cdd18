/* SPDX-License-Identifier: MIT */
/* A figure: panels in rows and columns, a title above and a legend below, as SVG or PNG.
 *
 * The bytes depend on the description alone. Texts are drawn as outlines, so an SVG looks the same wherever it is
 * shown; the font is DejaVu Sans or what the system has in its place, and without any font that which is built into
 * cairo. */
#include "plot/private.h"

#include <cairo-svg.h>
#include <stdio.h>

static cairo_status_t write_bytes(void *closure, const unsigned char *data, unsigned int length)
{
    struct plot_bytes *bytes = closure;
    sr_plot_bytes_add(bytes, data, length);
    return bytes->is_full ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

/* ---- layout ---- */

static uint32_t columns_of(const struct sr_plot_figure *figure)
{
    uint32_t columns = figure->columns ? figure->columns : figure->panel_count < 3 ? figure->panel_count : 3;
    return columns > figure->panel_count ? figure->panel_count : columns;
}

static sr_status draw_panel(struct plot_canvas *canvas, struct plot_box cell, const struct sr_plot_panel *panel,
                            struct sr_error *error)
{
    switch (panel->kind) {
    case SR_PLOT_LINES:
        return sr_plot_draw_lines(canvas, cell, panel, error);
    case SR_PLOT_POLAR:
        return sr_plot_draw_polar(canvas, cell, panel, error);
    case SR_PLOT_MAP:
        return sr_plot_draw_map(canvas, cell, panel, error);
    case SR_PLOT_PICTURE:
        return sr_plot_draw_picture(canvas, cell, panel, error);
    case SR_PLOT_SURFACE:
        return sr_plot_draw_surface(canvas, cell, panel, error);
    }
    return sr_fail(error, SR_ERROR_USAGE, "there is no kind %d of panels", (int)panel->kind);
}

static sr_status draw_figure(struct plot_canvas *canvas, const struct sr_plot_figure *figure, struct sr_error *error)
{
    struct plot_box inside = {12, 8, canvas->width - 12, canvas->height - 8};
    cairo_set_source_rgb(canvas->cr, 1, 1, 1);
    cairo_paint(canvas->cr);
    if (figure->title) {
        struct plot_type type = {.size = 15, .is_bold = true, .across = 0.5, .along_height = 1};
        while (type.size > 9 && sr_canvas_text_width(canvas, &type, figure->title) > inside.x1 - inside.x0)
            type.size -= 0.5;
        sr_canvas_text(canvas, canvas->width / 2, inside.y0 + 4, &type, figure->title);
        inside.y0 += 26;
    }
    if (figure->subtitle) {
        struct plot_type type = {.across = 0.5, .along_height = 1, .colour = PLOT_SOFT_INK};
        while (type.size > 7 && sr_canvas_text_width(canvas, &type, figure->subtitle) > inside.x1 - inside.x0)
            type.size -= 0.5;
        sr_canvas_text(canvas, canvas->width / 2, inside.y0 + 2, &type, figure->subtitle);
        inside.y0 += 20;
    }
    if (figure->legend_count) {
        double tall = sr_plot_legend_rows(canvas, inside, figure->legend, figure->legend_count, false);
        struct plot_box rows = {inside.x0, inside.y1 - tall, inside.x1, inside.y1};
        sr_plot_legend_rows(canvas, rows, figure->legend, figure->legend_count, true);
        inside.y1 -= tall + 6;
    }
    uint32_t columns = columns_of(figure), rows = (figure->panel_count + columns - 1) / columns;
    double gap = 14, wide = (inside.x1 - inside.x0 - gap * (columns - 1)) / columns;
    double tall = (inside.y1 - inside.y0 - gap * (rows - 1)) / rows;
    for (uint32_t i = 0; i < figure->panel_count && !error->status; ++i) {
        double x = inside.x0 + (wide + gap) * (i % columns), y = inside.y0 + (tall + gap) * (i / columns);
        draw_panel(canvas, (struct plot_box){x, y, x + wide, y + tall}, &figure->panels[i], error);
    }
    return error->status;
}

static void check_texts(const struct plot_canvas *canvas, struct sr_plot_check *check)
{
    const struct plot_text_box *t = canvas->texts.data;
    *check = (struct sr_plot_check){.texts = (uint32_t)canvas->texts.count};
    for (size_t i = 0; i < canvas->texts.count; ++i) {
        struct plot_box a = t[i].box;
        if (a.x0 < 0 || a.y0 < 0 || a.x1 > canvas->width || a.y1 > canvas->height) {
            ++check->outside;
            if (!check->offender[0])
                snprintf(check->offender, sizeof check->offender, "\"%s\" is outside", t[i].text);
        }
        for (size_t k = 0; k < i; ++k) {
            struct plot_box b = t[k].box;
            if (fmin(a.x1, b.x1) - fmax(a.x0, b.x0) > 0.5 && fmin(a.y1, b.y1) - fmax(a.y0, b.y0) > 0.5) {
                ++check->overlaps;
                if (!check->offender[0])
                    snprintf(check->offender, sizeof check->offender, "\"%s\" lies over \"%s\"", t[i].text, t[k].text);
            }
        }
    }
}

/* ---- writing ---- */

static cairo_surface_t *make_surface(const struct plot_canvas *canvas, struct plot_bytes *bytes)
{
    if (!canvas->is_vector)
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)lround(canvas->width * canvas->pixels),
                                          (int)lround(canvas->height * canvas->pixels));
    cairo_surface_t *surface = cairo_svg_surface_create_for_stream(write_bytes, bytes, canvas->width, canvas->height);
    cairo_svg_surface_restrict_to_version(surface, CAIRO_SVG_VERSION_1_1);
    cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
    return surface;
}

/* The family if the system has any font at all. */
static const char *find_family(cairo_t *cr)
{
    cairo_text_extents_t extents = {0};
    cairo_select_font_face(cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_text_extents(cr, "m", &extents);
    return cairo_status(cr) == CAIRO_STATUS_SUCCESS && extents.x_advance > 0 ? "DejaVu Sans" : "@cairo:";
}

static void settle_text(cairo_t *cr) // the same measures on both kinds of surfaces
{
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr, options);
    cairo_font_options_destroy(options);
}

static sr_status encode(const struct sr_plot_figure *figure, struct plot_canvas *canvas, struct plot_bytes *raw,
                        struct plot_bytes *out, struct sr_error *error)
{
    canvas->surface = make_surface(canvas, raw);
    canvas->cr = cairo_create(canvas->surface);
    settle_text(canvas->cr);
    canvas->family = find_family(canvas->cr);
    if (!canvas->is_vector)
        cairo_scale(canvas->cr, canvas->pixels, canvas->pixels);
    draw_figure(canvas, figure, error);
    if (!error->status && canvas->has_no_memory)
        sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    cairo_status_t status = cairo_status(canvas->cr);
    cairo_destroy(canvas->cr);
    if (status == CAIRO_STATUS_SUCCESS && !canvas->is_vector && !error->status)
        status = cairo_surface_write_to_png_stream(canvas->surface, write_bytes, out);
    cairo_surface_finish(canvas->surface);
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_status(canvas->surface);
    cairo_surface_destroy(canvas->surface);
    if (!error->status && status != CAIRO_STATUS_SUCCESS)
        sr_fail(error, SR_ERROR_RESOURCE, "a figure of %g x %g px cannot be drawn: %s", canvas->width, canvas->height,
                cairo_status_to_string(status));
    if (!error->status && canvas->is_vector) {
        sr_plot_bytes_add(raw, "", 1); // an end for those who look ahead
        sr_plot_shorten_svg(raw->array.data, out);
        if (raw->is_full || out->is_full)
            sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    }
    return error->status;
}

sr_status sr_plot_encode(const struct sr_plot_figure *figure, enum sr_plot_format format, char **data, size_t *size,
                         struct sr_plot_check *check, struct sr_error *error)
{
    *data = NULL;
    *size = 0;
    if (!figure->panel_count)
        return sr_fail(error, SR_ERROR_USAGE, "a figure has one panel at least");
    uint32_t columns = columns_of(figure), rows = (figure->panel_count + columns - 1) / columns;
    struct plot_canvas canvas = {.width = figure->width > 0 ? figure->width : 420.0 * columns,
                                 .height = figure->height > 0 ? figure->height : 340.0 * rows,
                                 .pixels = format == SR_PLOT_SVG ? 2
                                           : figure->scale > 0   ? figure->scale
                                                                 : 1,
                                 .is_vector = format == SR_PLOT_SVG};
    if (!(canvas.width * canvas.pixels <= 16384 && canvas.height * canvas.pixels <= 16384))
        return sr_fail(error, SR_ERROR_INPUT, "a figure of %g x %g px is too large", canvas.width, canvas.height);
    struct plot_bytes raw = {0}, out = {0};
    if (encode(figure, &canvas, &raw, &out, error) == SR_OK) {
        *data = out.array.data;
        *size = out.array.count;
        if (check)
            check_texts(&canvas, check);
    } else {
        sr_array_free(&out.array);
    }
    sr_array_free(&raw.array);
    sr_array_free(&canvas.texts);
    sr_arena_free(&canvas.arena);
    return error->status;
}

sr_status sr_plot_write(const struct sr_plot_figure *figure, const char *path, struct sr_error *error)
{
    return sr_plot_write_checked(figure, path, NULL, error);
}

sr_status sr_plot_write_checked(const struct sr_plot_figure *figure, const char *path, struct sr_plot_check *check,
                                struct sr_error *error)
{
    bool is_svg = sr_path_has_ending(path, ".svg");
    if (!is_svg && !sr_path_has_ending(path, ".png"))
        return sr_fail(error, SR_ERROR_USAGE, "%s: a figure's name ends with .svg or .png", path);
    char *data;
    size_t size;
    if (sr_plot_encode(figure, is_svg ? SR_PLOT_SVG : SR_PLOT_PNG, &data, &size, check, error) != SR_OK)
        return error->status;
    sr_file_write(path, data, size, error);
    sr_free(data);
    return error->status;
}
