/* SPDX-License-Identifier: MIT */
/* Figures: curves, polar diagrams, maps, pictures and surfaces with labelled axes, as SVG and PNG.
 *
 * A figure is described by plain structs and written by one call; nothing is kept between calls, and the same
 * description gives the same bytes. Lengths are in px, of which an SVG has 96 to the inch and a PNG `scale` pixels
 * each.
 *
 * Texts are UTF-8 with two marks: _{below} and ^{above} the line, as in "θ_{o}" and "sr^{-1}". Where a figure says
 * nothing (zeros), it gets what suits the data. */
#ifndef SR_PLOT_PLOT_H
#define SR_PLOT_PLOT_H

#include "math/math.h"

/* ---- colours ---- */

struct sr_plot_colour {
    float r, g, b, a; // [1] 0 … 1, sRGB as encoded
};
/* Eight colours that people with any colour vision can tell apart, black last (after Okabe & Ito 2008;
 * their yellow, faint on white, gives way to a brown). i may be any number. */
struct sr_plot_colour sr_plot_palette(int i);

enum sr_plot_scale {
    SR_PLOT_PERCEPTUAL, // from dark to light, in even steps of lightness
    SR_PLOT_DIVERGING,  // blue to red through white: for signed quantities
};
struct sr_plot_colour sr_plot_scale_colour(enum sr_plot_scale scale, double t); // t in 0 … 1; NaN: grey

/* Björn Ottosson's OKLab (2020): L 0 … 1, a and b about -0.3 … 0.3, to sRGB and back. Colours out of gamut are cut. */
struct sr_plot_colour sr_plot_colour_from_oklab(const double lab[3]);
void sr_plot_oklab_from_colour(struct sr_plot_colour colour, double lab[3]);

/* ---- axes ---- */

struct sr_plot_axis {
    const char *label; // the quantity: "θ_{o}"
    const char *unit;  // "°", "sr^{-1}"; NULL: none to be shown
    bool is_log;
    double from, to; // [unit] equal: from the data
    double step;     // [unit] from tick to tick; 0: what is nice
};

/* Positions and labels of the ticks that axes draw. */
enum { SR_PLOT_TICKS = 64 };
struct sr_plot_ticks {
    int count, minor_count;
    double at[SR_PLOT_TICKS], minor[4 * SR_PLOT_TICKS]; // [unit]
    char label[SR_PLOT_TICKS][40];
    int exponent; // labels are in units of 10^exponent
};
/* About `wanted` ticks from `from` to `to`, steps of 1, 2, 5 times a power of ten; of degrees also 15, 30, 45, 90. */
void sr_plot_ticks(const struct sr_plot_axis *axis, int wanted, struct sr_plot_ticks *ticks);

/* ---- panels ---- */

enum sr_plot_dash { SR_PLOT_SOLID, SR_PLOT_DASHED, SR_PLOT_DOTTED, SR_PLOT_DASH_DOT };

struct sr_plot_curve {
    const char *label;   // for the legend; NULL: none
    const double *x, *y; // [unit of the axes] in polar panels angle [°] from the top, clockwise, and radius; NaN: a gap
    const double *low, *high; // [unit of y] a band about it; NULL: none
    uint32_t count;
    int colour; // 1 … : of the palette; 0: the panel's next; -1: grey
    enum sr_plot_dash dash;
    double width; // [px] 0: 1.6
    bool has_points, has_no_line;
};

/* Something worth a word: a line across the panel, or along a radius. */
struct sr_plot_mark {
    const char *label;
    double x; // [unit of x]
};

enum sr_plot_kind {
    SR_PLOT_LINES, // curves over x and y
    SR_PLOT_POLAR, // curves over angle x [°] and radius y; half a disc where x is within -90 … 90, else a whole one
    SR_PLOT_MAP,   // values over x and y, in colours
    SR_PLOT_PICTURE, // pixels
    SR_PLOT_SURFACE, // bodies in space
};

/* A grid of points in space; its meshes are drawn as shaded quadrilaterals with edges. */
struct sr_plot_body {
    const double (*points)[3]; // [any] rows * columns, row by row
    uint32_t rows, columns;
    struct sr_plot_colour fill;         // a = 0: edges only
    struct sr_plot_colour edge;         // a = 0: no edges
    uint32_t edge_every;                // only each n-th line of the grid has edges; 0: each
    bool is_flat;                       // not shaded
    bool is_ground;                     // drawn before all else: nothing lies behind it
    const struct sr_plot_colour *fills; // of each quadrilateral, (rows - 1) * (columns - 1); NULL: fill
};
struct sr_plot_arrow {
    double from[3], to[3];
    const char *label;
    struct sr_plot_colour colour;
    enum sr_plot_dash dash;
    bool has_no_head, points_back; // toward `from`, the head on the way: light that arrives
};
struct sr_plot_view {
    double azimuth, elevation; // [°] of the eye about the z axis from +x, and above the plane; parallel projection
    double zoom;               // [1] about the middle of the bodies that are no ground; 0: 1
};

struct sr_plot_panel {
    enum sr_plot_kind kind;
    const char *title;
    struct sr_plot_axis x, y, z; // z: of a map's values
    const struct sr_plot_curve *curves;
    const struct sr_plot_mark *marks;
    uint32_t curve_count, mark_count;
    bool has_no_legend;
    bool points_down; // a polar panel: a whole disc, its angles from the bottom, positive ones to the right, as lamps
                      // hang

    const double *values;  // [unit of z] of a map: rows * columns, the lowest y first; NaN: no value
    const uint8_t *pixels; // [1] of a picture: sRGB, three bytes each, the top row first; of a map: in place of values
    uint32_t rows, columns;
    enum sr_plot_scale scale;
    bool has_no_frame; // a map without its x and y axes: a picture of values, its meshes as square as the box lets them
                       // be
    bool has_contours; // of a map: lines at the ticks of its scale

    const struct sr_plot_body *bodies;
    const struct sr_plot_arrow *arrows;
    uint32_t body_count, arrow_count;
    struct sr_plot_view view;
};

struct sr_plot_figure {
    const char *title, *subtitle;
    double width, height; // [px] 0: 420 by 340 for each panel
    uint32_t columns;     // of panels; 0: as many as there are, up to three
    const struct sr_plot_panel *panels;
    uint32_t panel_count;
    const struct sr_plot_curve *legend; // one for the whole figure, below it
    uint32_t legend_count;
    double scale; // [1] pixels of a PNG for each px; 0: 1
};

/* ---- writing ---- */

enum sr_plot_format { SR_PLOT_SVG, SR_PLOT_PNG };

/* What the figure says where; for those who must be sure that it can be read. */
struct sr_plot_check {
    uint32_t texts;     // drawn
    uint32_t outside;   // of them not wholly in the figure
    uint32_t overlaps;  // pairs that lie over each other
    char offender[160]; // the first that is outside or overlaps
};

/* The figure as bytes, to be freed with sr_free. check may be NULL. Fails where a panel has nothing finite to show. */
sr_status sr_plot_encode(const struct sr_plot_figure *figure, enum sr_plot_format format, char **data, size_t *size,
                         struct sr_plot_check *check, struct sr_error *error);
/* The same to a file, .svg or .png by its ending. */
sr_status sr_plot_write(const struct sr_plot_figure *figure, const char *path, struct sr_error *error);
sr_status sr_plot_write_checked(const struct sr_plot_figure *figure, const char *path, struct sr_plot_check *check,
                                struct sr_error *error);

#endif
