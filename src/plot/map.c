/* SPDX-License-Identifier: MIT */
/* Values over x and y as colours, with the scale beside them; and pictures as they are. */
#include "plot/private.h"

static const double bar = 13, bar_gap = 10; // [px]

/* The scale of colours at the right edge of the cell: the width that it takes. */
static double scale_width(struct plot_canvas *canvas, const struct sr_plot_axis *z, double tall,
                          struct sr_plot_ticks *ticks)
{
    double width = 0;
    sr_plot_ticks(z, (int)fmax(2, tall / 38), ticks);
    for (int i = 0; i < ticks->count; ++i)
        width = fmax(width, sr_canvas_text_width(canvas, &(struct plot_type){0}, ticks->label[i]));
    return bar_gap + bar + 8 + width + 4 + (z->label ? 20 : 0);
}

static sr_status draw_scale(struct plot_canvas *canvas, struct plot_box box, double right, const struct sr_plot_axis *z,
                            const struct sr_plot_ticks *ticks, enum sr_plot_scale scale, struct sr_error *error)
{
    enum { STEPS = 128 };
    uint32_t pixels[STEPS];
    struct plot_box place = {box.x1 + bar_gap, box.y0, box.x1 + bar_gap + bar, box.y1};
    for (int i = 0; i < STEPS; ++i)
        pixels[STEPS - 1 - i] = sr_canvas_pixel(sr_plot_scale_colour(scale, (i + 0.5) / STEPS));
    if (sr_canvas_pixels(canvas, pixels, 1, STEPS, place, false, error) != SR_OK)
        return error->status;
    sr_canvas_colour(canvas, PLOT_SOFT_INK);
    cairo_set_line_width(canvas->cr, 1);
    cairo_rectangle(canvas->cr, place.x0, place.y0, bar, place.y1 - place.y0);
    cairo_stroke(canvas->cr);
    for (int i = 0; i < ticks->count; ++i) {
        double y = box.y1 - sr_plot_place(z, ticks->at[i]) * (box.y1 - box.y0);
        sr_canvas_colour(canvas, PLOT_SOFT_INK);
        sr_canvas_line(canvas, place.x1, y, place.x1 + 4, y);
        sr_canvas_text(canvas, place.x1 + 7, y, &(struct plot_type){.along_height = 0.5}, ticks->label[i]);
    }
    char text[256];
    sr_plot_axis_title(z, ticks->exponent, text, sizeof text);
    struct plot_type label = {.size = PLOT_LABEL_SIZE, .across = 0.5, .is_upward = true};
    sr_canvas_text(canvas, right - 6, (box.y0 + box.y1) / 2, &label, text);
    return SR_OK;
}

static uint32_t value_pixel(const struct sr_plot_panel *panel, const struct sr_plot_axis *z, uint32_t row,
                            uint32_t column)
{
    double value = panel->values[(size_t)row * panel->columns + column];
    double t = isnan(value) ? value : fmax(0, fmin(1, sr_plot_place(z, value)));
    return sr_canvas_pixel(sr_plot_scale_colour(panel->scale, t));
}

/* Lines where the values, linear between the middles of their meshes, pass through a level. */
static void draw_contours(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_panel *panel,
                          double level)
{
    double wide = (box.x1 - box.x0) / panel->columns, tall = (box.y1 - box.y0) / panel->rows;
    for (uint32_t j = 0; j + 1 < panel->rows; ++j)
        for (uint32_t i = 0; i + 1 < panel->columns; ++i) {
            static const int corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
            double v[5], points[4][2];
            int count = 0;
            for (int k = 0; k < 5; ++k)
                v[k] = panel->values[(size_t)(j + corner[k][1]) * panel->columns + i + corner[k][0]] - level;
            for (int k = 0; k < 4; ++k) {
                if ((v[k] < 0) == (v[k + 1] < 0) || isnan(v[k]) || isnan(v[k + 1]))
                    continue;
                double t = v[k] / (v[k] - v[k + 1]);
                points[count][0] = box.x0 + wide * (i + 0.5 + corner[k][0] + t * (corner[k + 1][0] - corner[k][0]));
                points[count++][1] = box.y1 - tall * (j + 0.5 + corner[k][1] + t * (corner[k + 1][1] - corner[k][1]));
            }
            for (int k = 0; k + 1 < count; k += 2) {
                cairo_move_to(canvas->cr, points[k][0], points[k][1]);
                cairo_line_to(canvas->cr, points[k + 1][0], points[k + 1][1]);
            }
        }
}

/* The largest box of the map's proportions in the cell, right px kept free. */
static struct plot_box picture_box(struct plot_box cell, const struct sr_plot_panel *panel, double right)
{
    double size = fmin((cell.x1 - cell.x0 - right) / panel->columns, (cell.y1 - cell.y0 - 14) / panel->rows);
    double x = (cell.x0 + cell.x1 - right - size * panel->columns) / 2,
           y = (cell.y0 + cell.y1 - size * panel->rows) / 2;
    return (struct plot_box){x, y, x + size * panel->columns, y + size * panel->rows};
}

sr_status sr_plot_draw_map(struct plot_canvas *canvas, struct plot_box cell, const struct sr_plot_panel *panel,
                           struct sr_error *error)
{
    struct sr_plot_axis x = panel->x, y = panel->y, z = panel->z;
    struct plot_range range = {0};
    size_t count = (size_t)panel->rows * panel->columns;
    for (size_t i = 0; i < count && !panel->pixels; ++i)
        sr_plot_range_add(&range, panel->values[i], z.is_log);
    if (panel->scale == SR_PLOT_DIVERGING && range.some && !z.is_log && z.from == z.to) {
        z.to = fmax(fabs(range.lo), fabs(range.hi)); // nought is white
        z.from = -z.to;
    }
    if (!panel->pixels && !sr_plot_axis_settle(&z, &range, true))
        return sr_fail(error, SR_ERROR_INPUT, "the panel \"%s\" has no finite%s value",
                       panel->title ? panel->title : "", z.is_log ? " and positive" : "");
    if (!panel->has_no_frame && (x.from == x.to || y.from == y.to))
        return sr_fail(error, SR_ERROR_INPUT, "the map \"%s\" does not tell what its axes reach from and to",
                       panel->title ? panel->title : "");
    cell = sr_plot_title(canvas, cell, panel->title);
    struct sr_plot_ticks ticks;
    double right = panel->pixels ? 0 : scale_width(canvas, &z, cell.y1 - cell.y0 - 60, &ticks);
    struct plot_box box =
        panel->has_no_frame ? picture_box(cell, panel, right) : sr_plot_frame(canvas, cell, &x, &y, right, false);

    // each pixel of the picture lies within one value: no reader blurs them
    uint32_t wide = (uint32_t)ceil((box.x1 - box.x0) * canvas->pixels);
    uint32_t tall = (uint32_t)ceil((box.y1 - box.y0) * canvas->pixels);
    uint32_t *pixels = sr_arena_alloc(&canvas->arena, (size_t)wide * tall * sizeof *pixels);
    if (!pixels)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a map of %u x %u pixels", wide, tall);
    for (uint32_t j = 0; j < tall; ++j)
        for (uint32_t i = 0; i < wide; ++i) {
            uint32_t row = (uint32_t)((uint64_t)j * panel->rows / tall); // from the top
            uint32_t column = (uint32_t)((uint64_t)i * panel->columns / wide);
            pixels[(size_t)j * wide + i] =
                panel->pixels ? sr_canvas_rgb(&panel->pixels[3 * ((size_t)row * panel->columns + column)])
                              : value_pixel(panel, &z, panel->rows - 1 - row, column);
        }
    if (sr_canvas_pixels(canvas, pixels, wide, tall, box, false, error) != SR_OK)
        return error->status;
    if (panel->has_contours && !panel->pixels) {
        for (int i = 0; i < ticks.count; ++i)
            draw_contours(canvas, box, panel, ticks.at[i]);
        sr_canvas_colour(canvas, (struct sr_plot_colour){1, 1, 1, 0.9f});
        cairo_set_line_width(canvas->cr, 0.8);
        cairo_stroke(canvas->cr);
    }
    sr_canvas_colour(canvas, PLOT_SOFT_INK);
    cairo_set_line_width(canvas->cr, 1);
    cairo_rectangle(canvas->cr, box.x0, box.y0, box.x1 - box.x0, box.y1 - box.y0);
    cairo_stroke(canvas->cr);
    double edge = panel->has_no_frame ? fmin(cell.x1, box.x1 + right) : cell.x1;
    return panel->pixels ? SR_OK : draw_scale(canvas, box, edge, &z, &ticks, panel->scale, error);
}

sr_status sr_plot_draw_picture(struct plot_canvas *canvas, struct plot_box cell, const struct sr_plot_panel *panel,
                               struct sr_error *error)
{
    if (!panel->pixels || !panel->rows || !panel->columns)
        return sr_fail(error, SR_ERROR_INPUT, "the picture \"%s\" has no pixels", panel->title ? panel->title : "");
    cell = sr_plot_title(canvas, cell, panel->title);
    if (panel->x.label) {
        struct plot_type type = {.across = 0.5, .colour = PLOT_SOFT_INK};
        sr_canvas_text(canvas, (cell.x0 + cell.x1) / 2, cell.y1 - 5, &type, panel->x.label);
        cell.y1 -= 18;
    }
    uint32_t *pixels = sr_arena_alloc(&canvas->arena, (size_t)panel->rows * panel->columns * sizeof *pixels);
    if (!pixels)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a picture of %u x %u pixels", panel->columns,
                       panel->rows);
    for (size_t i = 0; i < (size_t)panel->rows * panel->columns; ++i)
        pixels[i] = sr_canvas_rgb(&panel->pixels[3 * i]);
    double size = fmin((cell.x1 - cell.x0 - 8) / panel->columns, (cell.y1 - cell.y0 - 4) / panel->rows);
    double cx = (cell.x0 + cell.x1) / 2, cy = (cell.y0 + cell.y1) / 2;
    double half_x = size * panel->columns / 2, half_y = size * panel->rows / 2;
    struct plot_box box = {cx - half_x, cy - half_y, cx + half_x, cy + half_y};
    return sr_canvas_pixels(canvas, pixels, panel->columns, panel->rows, box, true, error);
}
