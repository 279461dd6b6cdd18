/* SPDX-License-Identifier: MIT */
/* What the files of this room share: a canvas that knows where its texts lie, boxes, axes. */
#ifndef SR_PLOT_PRIVATE_H
#define SR_PLOT_PRIVATE_H

#include "plot/plot.h"

#include <cairo.h>

struct plot_box {
    double x0, y0, x1, y1; // [px] y grows downward
};

/* ---- canvas.c ---- */

struct plot_text_box {
    struct plot_box box;
    char text[64];
};
struct plot_canvas {
    cairo_t *cr;
    cairo_surface_t *surface;
    double width, height; // [px]
    double pixels;        // [1] per px, of pictures that are drawn as pixels
    bool is_vector;
    const char *family;
    struct sr_array texts; // struct plot_text_box
    struct sr_arena arena; // of what drawing needs
    bool has_no_memory;    // something has been left out for that
};

struct plot_type { // how a text looks; zeroed: 11 px, black, its left end on the base line
    double size;   // [px]
    bool is_bold, is_upward;
    double across, along_height; // [1] which point of it is put there: 0 left … 1 right; 0 base line, 0.5 middle, 1 top
    struct sr_plot_colour colour;
    bool has_halo;
};

enum { PLOT_TICK_SIZE = 11, PLOT_LABEL_SIZE = 12, PLOT_TITLE_SIZE = 13 };

double sr_canvas_text_width(struct plot_canvas *canvas, const struct plot_type *type, const char *text);
void sr_canvas_text(struct plot_canvas *canvas, double x, double y, const struct plot_type *type, const char *text);
void sr_canvas_colour(struct plot_canvas *canvas, struct sr_plot_colour colour);
void sr_canvas_dash(struct plot_canvas *canvas, enum sr_plot_dash dash, double width);
void sr_canvas_line(struct plot_canvas *canvas, double x0, double y0, double x1, double y1);
/* A run of a curve as a path, without the points that it misses by less than a hair when they are left out. */
void sr_canvas_run(struct plot_canvas *canvas, const double (*points)[2], size_t count);
/* sRGB pixels, four bytes each as cairo keeps them, stretched over a box. */
sr_status sr_canvas_pixels(struct plot_canvas *canvas, const uint32_t *pixels, uint32_t width, uint32_t height,
                           struct plot_box box, bool is_smooth, struct sr_error *error);
static inline uint32_t sr_canvas_pixel(struct sr_plot_colour c)
{
    return 0xff000000u | (uint32_t)lrintf(c.r * 255) << 16 | (uint32_t)lrintf(c.g * 255) << 8 |
           (uint32_t)lrintf(c.b * 255);
}
static inline uint32_t sr_canvas_rgb(const uint8_t rgb[3])
{
    return 0xff000000u | (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
}
static inline double sr_canvas_round(double v) // to 1/16 px: shorter files
{
    return round(v * 16) / 16;
}

#define PLOT_INK ((struct sr_plot_colour){0.13f, 0.13f, 0.13f, 1})
#define PLOT_SOFT_INK ((struct sr_plot_colour){0.35f, 0.35f, 0.35f, 1})
#define PLOT_GRID ((struct sr_plot_colour){0.86f, 0.86f, 0.86f, 1})
#define PLOT_FINE_GRID ((struct sr_plot_colour){0.94f, 0.94f, 0.94f, 1})

/* ---- ticks.c ---- */

struct plot_range {
    double lo, hi;
    bool some;
};
void sr_plot_range_add(struct plot_range *range, double value, bool is_log);
/* Fills in from and to where they are equal; tight: as the data, else with some air. False: nothing to show. */
bool sr_plot_axis_settle(struct sr_plot_axis *axis, const struct plot_range *range, bool is_tight);
double sr_plot_place(const struct sr_plot_axis *axis, double value); // [1] 0 at from, 1 at to

/* ---- axes.c ---- */

void sr_plot_axis_title(const struct sr_plot_axis *axis, int exponent, char *text, size_t size);
/* The frame with ticks and labels around what is left of the cell, which is returned. right: [px] kept free. */
struct plot_box sr_plot_frame(struct plot_canvas *canvas, struct plot_box cell, struct sr_plot_axis *x,
                              struct sr_plot_axis *y, double right, bool has_grid);
/* A panel's title; what is left of the cell. */
struct plot_box sr_plot_title(struct plot_canvas *canvas, struct plot_box cell, const char *title);

/* ---- legend.c ---- */

struct sr_plot_colour sr_plot_curve_colour(const struct sr_plot_curve *curves, uint32_t i);
/* Rows of entries, centred in the box's width; the height that they take. NULL canvas->cr draws nothing. */
double sr_plot_legend_rows(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_curve *curves,
                           uint32_t count, bool draws);
/* One entry below the other, in the corner of the box where the fewest of the points lie. */
void sr_plot_legend_corner(struct plot_canvas *canvas, struct plot_box box, const struct sr_plot_curve *curves,
                           uint32_t count, const double (*points)[2], size_t point_count);

/* ---- svg.c ---- */

struct plot_bytes {
    struct sr_array array; // of char
    bool is_full;          // there was no memory for all
};
void sr_plot_bytes_add(struct plot_bytes *bytes, const void *data, size_t length);
/* cairo's SVG, a text that ends with NUL, without what changes from time to time and what goes without saying. */
void sr_plot_shorten_svg(const char *svg, struct plot_bytes *out);

/* ---- the kinds of panels ---- */

sr_status sr_plot_draw_lines(struct plot_canvas *, struct plot_box, const struct sr_plot_panel *, struct sr_error *);
sr_status sr_plot_draw_polar(struct plot_canvas *, struct plot_box, const struct sr_plot_panel *, struct sr_error *);
sr_status sr_plot_draw_map(struct plot_canvas *, struct plot_box, const struct sr_plot_panel *, struct sr_error *);
sr_status sr_plot_draw_picture(struct plot_canvas *, struct plot_box, const struct sr_plot_panel *, struct sr_error *);
sr_status sr_plot_draw_surface(struct plot_canvas *, struct plot_box, const struct sr_plot_panel *, struct sr_error *);

#endif
