/* SPDX-License-Identifier: MIT */
/* Bodies in space: meshes in parallel projection, the farthest drawn first, so that the near ones hide them.
 *
 * With the eye at azimuth a and elevation e, a point (x, y, z) is seen at
 *     right = -x sin a + y cos a        up = -(x cos a + y sin a) sin e + z cos e
 * and lies nearer by (x cos a + y sin a) cos e + z sin e. The painter's order is that of the meshes' centres: right
 * where meshes are small against the distances between bodies; bodies that cut through each other need fine meshes. */
#include "plot/private.h"

#include <stdlib.h>

struct eye {
    double right[3], up[3], toward[3];
    double scale, x, y; // [px] per unit, and of the origin
};

struct piece { // a mesh, or a bit of an arrow
    double depth;
    uint32_t order; // where depths are equal
    bool is_ground;
    uint32_t corners;
    uint32_t edges; // bit k: the edge from corner k to the next is drawn
    double p[4][3];
    struct sr_plot_colour fill, edge;
    enum sr_plot_dash dash;
    double width;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double seen_x(const struct eye *eye, const double p[3])
{
    return eye->x + eye->scale * dot(eye->right, p);
}

static double seen_y(const struct eye *eye, const double p[3])
{
    return eye->y - eye->scale * dot(eye->up, p);
}

static struct eye look(const struct sr_plot_view *view)
{
    double a = view->azimuth * 3.14159265358979 / 180, e = view->elevation * 3.14159265358979 / 180;
    return (struct eye){.right = {-sin(a), cos(a), 0},
                        .up = {-cos(a) * sin(e), -sin(a) * sin(e), cos(e)},
                        .toward = {cos(a) * cos(e), sin(a) * cos(e), sin(e)}};
}

/* Lit from above the eye's left shoulder, the back as well as the front; some light comes from everywhere. */
static struct sr_plot_colour shaded(struct sr_plot_colour colour, const struct eye *eye, const struct piece *piece)
{
    double a[3], b[3];
    for (int k = 0; k < 3; ++k) {
        a[k] = piece->p[2][k] - piece->p[0][k];
        b[k] = piece->p[3][k] - piece->p[1][k];
    }
    double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    double length = sqrt(dot(n, n)), light[3], lab[3];
    if (!(length > 0))
        return colour;
    double side = dot(n, eye->toward) < 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k)
        light[k] = 0.62 * eye->toward[k] + 0.62 * eye->up[k] - 0.48 * eye->right[k];
    double lit = fmax(0, side * dot(n, light) / length);
    sr_plot_oklab_from_colour(colour, lab);
    double factor = 0.62 + 0.5 * lit;
    lab[0] = fmin(0.98, lab[0] * factor);
    struct sr_plot_colour out = sr_plot_colour_from_oklab(lab);
    out.a = colour.a;
    return out;
}

static int by_depth(const void *a, const void *b)
{
    const struct piece *x = a, *y = b;
    if (x->is_ground != y->is_ground)
        return x->is_ground ? -1 : 1;
    if (x->depth != y->depth)
        return x->depth < y->depth ? -1 : 1;
    return x->order < y->order ? -1 : x->order > y->order;
}

static void add(struct plot_canvas *canvas, struct sr_array *pieces, const struct eye *eye, struct piece piece)
{
    double sum = 0;
    for (uint32_t i = 0; i < piece.corners; ++i) {
        sum += dot(eye->toward, piece.p[i]);
        if (!isfinite(sum))
            return;
    }
    piece.depth = sum / piece.corners;
    piece.order = (uint32_t)pieces->count;
    struct piece *kept = sr_array_push(pieces, sizeof *kept);
    canvas->has_no_memory |= !kept;
    if (kept)
        *kept = piece;
}

static void add_body(struct plot_canvas *canvas, struct sr_array *pieces, const struct eye *eye,
                     const struct sr_plot_body *body)
{
    for (uint32_t row = 0; row + 1 < body->rows; ++row)
        for (uint32_t column = 0; column + 1 < body->columns; ++column) {
            struct piece piece = {.corners = 4, .edge = body->edge, .width = 0.55, .is_ground = body->is_ground};
            const uint32_t at[4][2] = {{row, column}, {row, column + 1}, {row + 1, column + 1}, {row + 1, column}};
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 3; ++k)
                    piece.p[i][k] = body->points[(size_t)at[i][0] * body->columns + at[i][1]][k];
            uint32_t n = body->edge_every ? body->edge_every : 1;
            piece.edges = (row % n == 0 ? 1u : 0) | ((column + 1) % n == 0 ? 2u : 0) | ((row + 1) % n == 0 ? 4u : 0) |
                          (column % n == 0 ? 8u : 0);
            piece.fill = body->fills ? body->fills[(size_t)row * (body->columns - 1) + column] : body->fill;
            if (!body->is_flat && piece.fill.a > 0)
                piece.fill = shaded(piece.fill, eye, &piece);
            add(canvas, pieces, eye, piece);
        }
}

static void add_arrow(struct plot_canvas *canvas, struct sr_array *pieces, const struct eye *eye,
                      const struct sr_plot_arrow *arrow)
{
    enum { BITS = 48 };
    const double *tail = arrow->from;
    double d[3] = {arrow->to[0] - tail[0], arrow->to[1] - tail[1], arrow->to[2] - tail[2]};
    double length = sqrt(dot(d, d)), head = arrow->has_no_head ? 0 : fmin(0.3 * length, 10 / eye->scale);
    if (!(length > 0))
        return;
    double shown = arrow->points_back ? 1 : (length - 0.8 * head) / length; // the line does not blunt the tip
    for (int i = 0; i < BITS; ++i) { // in bits: each lies before or behind of what is near it
        if (arrow->dash != SR_PLOT_SOLID && i % 2)
            continue;
        struct piece piece = {.corners = 2, .edges = 1, .edge = arrow->colour, .width = 1.8};
        for (int k = 0; k < 3; ++k) {
            piece.p[0][k] = tail[k] + d[k] * shown * i / BITS;
            piece.p[1][k] = tail[k] + d[k] * shown * (i + 1) / BITS;
        }
        add(canvas, pieces, eye, piece);
    }
    if (head > 0) { // a triangle that faces the eye
        double side[3] = {d[1] * eye->toward[2] - d[2] * eye->toward[1], d[2] * eye->toward[0] - d[0] * eye->toward[2],
                          d[0] * eye->toward[1] - d[1] * eye->toward[0]};
        double wide = sqrt(dot(side, side)), sense = arrow->points_back ? -1 : 1;
        double tip = arrow->points_back ? 0.78 * length : length;
        struct piece piece = {.corners = 3, .fill = arrow->colour};
        for (int k = 0; k < 3; ++k) {
            double along = d[k] / length, off = wide > 0 ? side[k] / wide * 0.38 * head : 0;
            piece.p[0][k] = tail[k] + along * tip;
            piece.p[1][k] = tail[k] + along * (tip - sense * head) + off;
            piece.p[2][k] = tail[k] + along * (tip - sense * head) - off;
        }
        add(canvas, pieces, eye, piece);
    }
}

static void draw(struct plot_canvas *canvas, cairo_t *cr, const struct eye *eye, const struct sr_array *pieces)
{
    const struct piece *p = pieces->data;
    cairo_t *before = canvas->cr;
    canvas->cr = cr;
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    for (size_t i = 0; i < pieces->count; ++i) {
        for (uint32_t k = 0; k < p[i].corners; ++k)
            cairo_line_to(cr, sr_canvas_round(seen_x(eye, p[i].p[k])), sr_canvas_round(seen_y(eye, p[i].p[k])));
        if (p[i].corners > 2)
            cairo_close_path(cr);
        if (p[i].fill.a > 0) {
            sr_canvas_colour(canvas, p[i].fill);
            cairo_fill_preserve(cr);
        }
        cairo_set_line_width(cr, p[i].width);
        if (p[i].fill.a >= 1 && p[i].corners == 4 && p[i].edges != 15) { // closes the seams between meshes
            sr_canvas_colour(canvas, p[i].fill);
            cairo_stroke(cr);
        }
        cairo_new_path(cr);
        for (uint32_t k = 0; k < p[i].corners && p[i].edge.a > 0; ++k) {
            const double *from = p[i].p[k], *to = p[i].p[(k + 1) % p[i].corners];
            if (!(p[i].edges >> k & 1))
                continue;
            cairo_move_to(cr, sr_canvas_round(seen_x(eye, from)), sr_canvas_round(seen_y(eye, from)));
            cairo_line_to(cr, sr_canvas_round(seen_x(eye, to)), sr_canvas_round(seen_y(eye, to)));
        }
        sr_canvas_colour(canvas, p[i].edge);
        cairo_stroke(cr);
        cairo_new_path(cr);
    }
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
    canvas->cr = before;
}

/* So many meshes are no drawing any more: as pixels they take less room in a file. Three times as fine and without
 * smoothing of their own, then made smaller: no seams show between them. */
static sr_status draw_pixels(struct plot_canvas *canvas, struct plot_box box, const struct eye *eye,
                             const struct sr_array *pieces, struct sr_error *error)
{
    const double finer = 3;
    double wide = ceil((box.x1 - box.x0) * canvas->pixels), tall = ceil((box.y1 - box.y0) * canvas->pixels);
    cairo_surface_t *fine = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(wide * finer), (int)(tall * finer));
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)wide, (int)tall);
    cairo_t *cr = cairo_create(fine);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_paint(cr);
    cairo_set_antialias(cr, CAIRO_ANTIALIAS_NONE);
    cairo_scale(cr, canvas->pixels * finer, canvas->pixels * finer);
    cairo_translate(cr, -box.x0, -box.y0);
    draw(canvas, cr, eye, pieces);
    bool is_good = cairo_status(cr) == CAIRO_STATUS_SUCCESS;
    cairo_destroy(cr);

    cr = cairo_create(image);
    cairo_scale(cr, 1 / finer, 1 / finer);
    cairo_set_source_surface(cr, fine, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cr), CAIRO_FILTER_GOOD);
    cairo_paint(cr);
    is_good &= cairo_status(cr) == CAIRO_STATUS_SUCCESS;
    cairo_destroy(cr);
    cairo_surface_destroy(fine);

    cairo_save(canvas->cr);
    cairo_translate(canvas->cr, round(box.x0 * canvas->pixels) / canvas->pixels,
                    round(box.y0 * canvas->pixels) / canvas->pixels);
    cairo_scale(canvas->cr, 1 / canvas->pixels, 1 / canvas->pixels);
    cairo_set_source_surface(canvas->cr, image, 0, 0);
    cairo_paint(canvas->cr);
    cairo_restore(canvas->cr);
    cairo_surface_destroy(image);
    return is_good ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a picture of a surface");
}

struct extent {
    struct plot_range x, y;
};

static void reach(struct extent *e, const struct eye *eye, const double p[3])
{
    sr_plot_range_add(&e->x, dot(eye->right, p), false);
    sr_plot_range_add(&e->y, dot(eye->up, p), false);
}

/* The scale at which all is within the box; zoomed in, the bodies are in its middle. */
static bool fit(struct eye *eye, struct plot_box box, const struct sr_plot_panel *panel)
{
    struct extent all = {0}, bodies = {0};
    for (uint32_t b = 0; b < panel->body_count; ++b)
        for (size_t i = 0; i < (size_t)panel->bodies[b].rows * panel->bodies[b].columns; ++i) {
            reach(&all, eye, panel->bodies[b].points[i]);
            if (!panel->bodies[b].is_ground)
                reach(&bodies, eye, panel->bodies[b].points[i]);
        }
    for (uint32_t a = 0; a < panel->arrow_count; ++a) {
        reach(&all, eye, panel->arrows[a].from);
        reach(&all, eye, panel->arrows[a].to);
    }
    if (!all.x.some || !(all.x.hi > all.x.lo || all.y.hi > all.y.lo))
        return false;
    eye->scale = fmin((box.x1 - box.x0) / (all.x.hi - all.x.lo), (box.y1 - box.y0) / (all.y.hi - all.y.lo));
    double zoom = panel->view.zoom > 0 ? panel->view.zoom : 1;
    eye->scale *= zoom;
    struct extent middle = zoom > 1 && bodies.x.some ? bodies : all;
    eye->x = (box.x0 + box.x1) / 2 - eye->scale * (middle.x.lo + middle.x.hi) / 2;
    eye->y = (box.y0 + box.y1) / 2 + eye->scale * (middle.y.lo + middle.y.hi) / 2;
    return isfinite(eye->scale);
}

static void label_arrows(struct plot_canvas *canvas, struct plot_box cell, const struct eye *eye,
                         const struct sr_plot_panel *panel)
{
    for (uint32_t a = 0; a < panel->arrow_count; ++a) {
        const struct sr_plot_arrow *arrow = &panel->arrows[a];
        if (!arrow->label)
            continue;
        double x = seen_x(eye, arrow->to), y = seen_y(eye, arrow->to);
        double dx = x - seen_x(eye, arrow->from), dy = y - seen_y(eye, arrow->from), d = hypot(dx, dy);
        struct plot_type type = {.size = PLOT_LABEL_SIZE, .has_halo = true, .colour = arrow->colour};
        double half = sr_canvas_text_width(canvas, &type, arrow->label) / 2;
        x += d > 0 ? dx / d * (6 + half) : 0;
        y += d > 0 ? dy / d * 12 : 0;
        type.across = 0.5;
        type.along_height = 0.5;
        x = fmin(fmax(x, cell.x0 + half + 1), cell.x1 - half - 1);
        y = fmin(fmax(y, cell.y0 + 9), cell.y1 - 9);
        sr_canvas_text(canvas, x, y, &type, arrow->label);
    }
}

sr_status sr_plot_draw_surface(struct plot_canvas *canvas, struct plot_box cell, const struct sr_plot_panel *panel,
                               struct sr_error *error)
{
    enum { MANY = 500 };
    cell = sr_plot_title(canvas, cell, panel->title);
    if (panel->x.label) {
        struct plot_type type = {.across = 0.5, .colour = PLOT_SOFT_INK};
        sr_canvas_text(canvas, (cell.x0 + cell.x1) / 2, cell.y1 - 5, &type, panel->x.label);
        cell.y1 -= 18;
    }
    struct eye eye = look(&panel->view);
    struct plot_box box = {cell.x0 + 26, cell.y0 + 14, cell.x1 - 26, cell.y1 - 10};
    if (!fit(&eye, box, panel))
        return sr_fail(error, SR_ERROR_INPUT, "the panel \"%s\" has nothing finite to show",
                       panel->title ? panel->title : "");
    struct sr_array pieces = {0};
    for (uint32_t b = 0; b < panel->body_count; ++b)
        add_body(canvas, &pieces, &eye, &panel->bodies[b]);
    for (uint32_t a = 0; a < panel->arrow_count; ++a)
        add_arrow(canvas, &pieces, &eye, &panel->arrows[a]);
    if (pieces.count)
        qsort(pieces.data, pieces.count, sizeof(struct piece), by_depth);
    if (pieces.count > MANY) {
        draw_pixels(canvas, cell, &eye, &pieces, error);
    } else {
        cairo_save(canvas->cr);
        cairo_rectangle(canvas->cr, cell.x0, cell.y0, cell.x1 - cell.x0, cell.y1 - cell.y0);
        cairo_clip(canvas->cr);
        draw(canvas, canvas->cr, &eye, &pieces);
        cairo_restore(canvas->cr);
    }
    sr_array_free(&pieces);
    if (!error->status)
        label_arrows(canvas, cell, &eye, panel);
    return error->status;
}
