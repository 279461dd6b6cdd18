/* SPDX-License-Identifier: MIT */
/* brdf plot: one panel for each specimen. Lobes in space, image slices, lit balls. */
#include "brdf_plot.h"

#include <math.h>
#include <stdio.h>

static const double degree = 3.14159265358979323846 / 180;

static uint8_t byte_of(float linear)
{
    return (uint8_t)lrintf(255 * sr_clamp(sr_srgb_encode(sr_clamp(linear, 0, 1)), 0, 1));
}

/* ---- lobes in space ---- */

/* Radii of a lobe in shares of the largest that is not next to the horizon, where some models grow without bounds: in
 * proportion to f, or to its logarithm over five powers of ten. */
static double radius_of(double value, double most, bool is_log)
{
    if (!(value > 0) || !(most > 0))
        return 0;
    return fmin(1.15, is_log ? fmax(0, 1 + log10(value / most) / 5) : value / most);
}

static const struct sr_plot_body *ground(struct plot_builder *b, double radius, bool is_seen_through)
{
    enum { ROWS = 7, COLUMNS = 49 };
    struct sr_plot_body *body = sr_arena_alloc(b->arena, sizeof *body);
    double(*p)[3] = sr_arena_alloc(b->arena, sizeof *p * ROWS * COLUMNS);
    if (!body || !p)
        return NULL;
    for (int i = 0; i < ROWS; ++i)
        for (int k = 0; k < COLUMNS; ++k) {
            double phi = 2 * 3.14159265358979 * k / (COLUMNS - 1), r = radius * i / (ROWS - 1);
            p[i * COLUMNS + k][0] = r * cos(phi);
            p[i * COLUMNS + k][1] = r * sin(phi);
        }
    *body = (struct sr_plot_body){.points = (const double(*)[3])p,
                                  .rows = ROWS,
                                  .columns = COLUMNS,
                                  .is_flat = true,
                                  .is_ground = !is_seen_through,
                                  .edge = {0.80f, 0.80f, 0.80f, 1},
                                  .fill = {0.955f, 0.955f, 0.955f, is_seen_through ? 0 : 1}};
    return body;
}

/* A polar grid of directions about a pole, whose rings are narrow inside, cut off at the surface. */
static void lobe_grid(sr_vec3 pole, uint32_t rows, uint32_t columns, double sign, sr_vec3 *w)
{
    for (uint32_t i = 0; i < rows; ++i)
        for (uint32_t k = 0; k < columns; ++k) {
            double phi = 2 * 3.14159265358979323846 * k / (columns - 1);
            double t = (double)i / (rows - 1), a = 0.35 * t + 0.65 * t * t; // share of the way to the horizon
            struct sr_frame frame = sr_frame_from_zx(pole, (sr_vec3){0, 1, 0});
            double c = cos(phi), s = sin(phi);
            // the angle from the pole to the horizon along phi
            double across = (double)frame.x.z * c + (double)frame.y.z * s;
            double end = atan2((double)pole.z, -across), angle = a * (end > 0 ? end : end + 3.14159265358979323846);
            sr_vec3 side = sr_add(sr_scale((float)c, frame.x), sr_scale((float)s, frame.y));
            sr_vec3 d = sr_add(sr_scale((float)cos(angle), pole), sr_scale((float)sin(angle), side));
            if (i + 1 == rows || d.z < 1e-4f)
                d.z = 1e-4f;
            d = sr_normalize(d);
            d.z *= (float)sign;
            w[i * columns + k] = d;
        }
}

struct lobe {
    uint32_t rows, columns, count;
    double (*points)[3];
    double *values, (*xyz)[3];
    sr_vec3 *wo, *wi;
    double most;
};

static sr_status allocate_lobe(struct plot_builder *b, struct lobe *lobe, uint32_t rows, uint32_t columns)
{
    size_t count = (size_t)rows * columns;
    *lobe = (struct lobe){.rows = rows,
                          .columns = columns,
                          .count = (uint32_t)count,
                          .points = sr_arena_alloc(b->arena, count * sizeof *lobe->points),
                          .xyz = sr_arena_alloc(b->arena, count * sizeof *lobe->xyz),
                          .wo = sr_arena_alloc(b->arena, count * sizeof(sr_vec3)),
                          .wi = sr_arena_alloc(b->arena, count * sizeof(sr_vec3)),
                          .values = sr_arena_alloc(b->arena, count * SR_LAMBDA_COUNT * sizeof(double))};
    return lobe->points && lobe->xyz && lobe->wo && lobe->wi && lobe->values
               ? SR_OK
               : sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
}

static uint32_t evaluate(struct plot_builder *b, uint32_t specimen, struct lobe *lobe)
{
    uint32_t top = 0;
    for (uint32_t i = 0; i < lobe->count; ++i)
        lobe->wi[i] = plot_light(b->request);
    if (plot_values(b, specimen, lobe->wo, lobe->wi, lobe->count, lobe->values, lobe->xyz) != SR_OK)
        return 0;
    for (uint32_t i = 0; i < lobe->count; ++i)
        if (isfinite(lobe->values[i]) && lobe->values[i] > lobe->most && fabsf(lobe->wo[i].z) > 0.03f) {
            lobe->most = lobe->values[i];
            top = i;
        }
    return top;
}

/* The lobe on one side of the surface, its mesh about where a coarse one finds it largest. */
static sr_status make_lobe(struct plot_builder *b, uint32_t specimen, double sign, struct lobe *lobe)
{
    const struct plot_request *r = b->request;
    bool is_random = plot_is_random(r, specimen);
    sr_vec3 light = plot_light(r), mirror = {-light.x, -light.y, light.z}, pole = mirror;
    struct lobe coarse;
    if (allocate_lobe(b, &coarse, 19, 49) != SR_OK ||
        allocate_lobe(b, lobe, is_random ? 37 : 73, is_random ? 61 : 121) != SR_OK)
        return b->error->status;
    lobe_grid((sr_vec3){0, 0, 1}, coarse.rows, coarse.columns, sign, coarse.wo);
    if (!is_random) {
        uint32_t top = evaluate(b, specimen, &coarse);
        sr_vec3 there = coarse.wo[top];
        there.z = sr_max(fabsf(there.z), 0.08f);
        double at_mirror[SR_LAMBDA_COUNT];
        sr_vec3 w = {mirror.x, mirror.y, (float)sign * mirror.z};
        if (plot_values(b, specimen, &w, &light, 1, at_mirror, NULL) == SR_OK && coarse.most > 1.05 * at_mirror[0])
            pole = sr_normalize(there);
    }
    lobe_grid(pole, lobe->rows, lobe->columns, sign, lobe->wo);
    evaluate(b, specimen, lobe);
    return b->error->status;
}

/* The lobe's own colour: of all its light together, at full strength. */
static struct sr_plot_colour colour_of_lobe(const struct lobe *lobe, size_t count)
{
    double sum[3] = {0};
    for (size_t i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c)
            sum[c] += lobe->xyz[i][c];
    struct sr_rgb rgb =
        sr_rgb_from_xyz(sr_colour_space(SR_SRGB), (struct sr_xyz){(float)sum[0], (float)sum[1], (float)sum[2]});
    float most = sr_max(rgb.r, sr_max(rgb.g, rgb.b));
    if (!(most > 0))
        return (struct sr_plot_colour){0.5f, 0.5f, 0.5f, 1};
    return (struct sr_plot_colour){(float)byte_of(0.75f * rgb.r / most) / 255,
                                   (float)byte_of(0.75f * rgb.g / most) / 255,
                                   (float)byte_of(0.75f * rgb.b / most) / 255, 1};
}

static struct sr_plot_colour darker(struct sr_plot_colour c)
{
    double lab[3];
    sr_plot_oklab_from_colour(c, lab);
    lab[0] *= 0.66;
    return sr_plot_colour_from_oklab(lab);
}

static void scaled(sr_vec3 w, double length, double out[3])
{
    out[0] = length * (double)w.x;
    out[1] = length * (double)w.y;
    out[2] = length * (double)w.z;
}

static uint32_t add_arrows(struct plot_builder *b, uint32_t specimen, struct sr_plot_arrow *arrows)
{
    const struct plot_request *r = b->request;
    const struct sr_plot_colour orange = {0.835f, 0.369f, 0, 1}, ink = {0.15f, 0.15f, 0.15f, 1},
                                green = {0, 0.5f, 0.36f, 1};
    sr_vec3 light = plot_light(r), mirror = {-light.x, -light.y, light.z};
    struct sr_delta deltas[SR_DELTAS];
    uint32_t count = 0;
    bool is_slanted = r->theta_deg > 0;
    arrows[count] =
        (struct sr_plot_arrow){.label = is_slanted ? "ω_{i}" : "n, ω_{i}", .colour = orange, .points_back = true};
    double near = r->zoom > 1 ? 1 / r->zoom : 1; // what is seen of them
    scaled(light, 1.3 * near, arrows[count++].to);
    if (is_slanted) {
        arrows[count] = (struct sr_plot_arrow){.label = "mirror", .colour = green, .dash = SR_PLOT_DASHED};
        scaled(mirror, near < 1 ? 1.12 : 1.3, arrows[count++].to);
        arrows[count++] = (struct sr_plot_arrow){.to = {0, 0, 1.25 * near}, .label = "n", .colour = ink};
    }
    int n = sr_specimen_deltas(&r->specimens[specimen], r->lambda.lambda, light, deltas);
    for (int i = 0; i < n; ++i) {
        double share = (double)deltas[i].albedo[0];
        arrows[count] =
            (struct sr_plot_arrow){.label = sr_arena_printf(b->arena, "δ %.3g", share), .colour = sr_plot_palette(0)};
        scaled(deltas[i].direction, fmax(0.12, share), arrows[count++].to);
    }
    return count;
}

sr_status plot_body(struct plot_builder *b, uint32_t specimen)
{
    const struct plot_request *r = b->request;
    bool is_both = plot_transmits(r, specimen);
    uint32_t sides = is_both ? 2 : 1;
    struct lobe lobes[2];
    struct sr_plot_body *bodies = sr_arena_alloc(b->arena, 3 * sizeof *bodies);
    struct sr_plot_arrow *arrows = sr_arena_alloc(b->arena, (3 + SR_DELTAS) * sizeof *arrows);
    const struct sr_plot_body *plane = ground(b, 1.05, is_both);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!bodies || !arrows || !plane || !panel)
        return sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    double most = 0;
    bodies[0] = *plane;
    for (uint32_t side = 0; side < sides; ++side) {
        if (make_lobe(b, specimen, side ? -1 : 1, &lobes[side]) != SR_OK)
            return b->error->status;
        most = fmax(most, lobes[side].most);
    }
    for (uint32_t side = 0; side < sides; ++side) {
        struct lobe *lobe = &lobes[side];
        for (uint32_t i = 0; i < lobe->count; ++i)
            scaled(lobe->wo[i], radius_of(lobe->values[i], most, r->is_log), lobe->points[i]);
        struct sr_plot_colour fill = {0.40f, 0.62f, 0.86f, 1};
        if (r->is_colour)
            fill = colour_of_lobe(lobe, lobe->count);
        bodies[1 + side] = (struct sr_plot_body){.points = (const double(*)[3])lobe->points,
                                                 .rows = lobe->rows,
                                                 .columns = lobe->columns,
                                                 .fill = fill,
                                                 .edge = darker(fill),
                                                 .edge_every = lobe->rows / 12};
    }
    *panel = (struct sr_plot_panel){
        .kind = SR_PLOT_SURFACE,
        .title = r->specimen_count > 1 ? r->names[specimen] : "Lobe in space",
        .x.label = most > 0 ? sr_arena_printf(b->arena, "largest %s = %.3g sr^{-1}%s", plot_quantity(r), most,
                                              r->is_log ? "; radius: logarithm, 5 decades" : "")
                            : "delta lobes only (δ: share of the light)",
        .bodies = bodies,
        .body_count = 1 + (most > 0 ? sides : 0),
        .arrows = arrows,
        .arrow_count = add_arrows(b, specimen, arrows),
        .view = {r->phi_deg + r->view_deg[0],
                 r->view_deg[1] > 0 ? r->view_deg[1]
                 : is_both          ? 16
                                    : 24,
                 r->zoom}};
    return SR_OK;
}

/* ---- image slices ---- */

sr_status plot_slice(struct plot_builder *b, uint32_t specimen)
{
    const struct plot_request *r = b->request;
    enum { SIDE = 180, COUNT = SIDE * SIDE };
    struct lobe slice;
    uint8_t *pixels = sr_arena_alloc(b->arena, (size_t)COUNT * 3);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!panel || !pixels)
        return sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    if (allocate_lobe(b, &slice, SIDE, SIDE) != SR_OK)
        return b->error->status;
    for (int row = 0; row < SIDE; ++row)
        for (int column = 0; column < SIDE; ++column) {
            double h = (column + 0.5) * 90 / SIDE * degree, d = (row + 0.5) * 90 / SIDE * degree;
            int i = row * SIDE + column;
            slice.wi[i] = (sr_vec3){(float)(sin(h) * cos(d)), (float)sin(d), (float)(cos(h) * cos(d))};
            slice.wo[i] = (sr_vec3){slice.wi[i].x, -slice.wi[i].y, slice.wi[i].z};
        }
    if (plot_values(b, specimen, slice.wo, slice.wi, COUNT, slice.values, slice.xyz) != SR_OK)
        return b->error->status;
    double most = 0, least = INFINITY;
    for (int i = 0; i < COUNT; ++i)
        if (slice.values[i] > 0 && isfinite(slice.values[i])) {
            most = fmax(most, slice.values[i]);
            least = fmin(least, slice.values[i]);
        }
    bool is_flat = !(most > 1.02 * least);
    *panel = (struct sr_plot_panel){
        .kind = SR_PLOT_MAP,
        .title = r->specimen_count > 1 ? r->names[specimen] : "Image slice, φ_{d} = 90°",
        .x = {.label = "θ_{h}", .unit = "°", .from = 0, .to = 90, .step = 30},
        .y = {.label = "θ_{d}", .unit = "°", .from = 0, .to = 90, .step = 30},
        .z = {.label = plot_quantity(r), .unit = "sr^{-1}", .is_log = !is_flat && most > 20 * least},
        .values = slice.values,
        .rows = SIDE,
        .columns = SIDE};
    if (!(most > 0))
        panel->z.to = 1; // nought everywhere
    else if (panel->z.is_log) {
        panel->z.from = fmax(least, most * 1e-5);
        panel->z.to = most;
    }
    if (r->is_colour && most > 0) {
        // as bright as a white diffuser where f = 1/pi; what is brighter goes to white by a soft shoulder
        for (int i = 0; i < COUNT; ++i) {
            const double *c = slice.xyz[(SIDE - 1 - i / SIDE) * SIDE + i % SIDE];
            double y = 3.14159265358979 * c[1], k = 3.14159265358979 * (1 + y / 64) / (1 + y) * 1.3;
            struct sr_rgb rgb = sr_rgb_from_xyz(
                sr_colour_space(SR_SRGB), (struct sr_xyz){(float)(k * c[0]), (float)(k * c[1]), (float)(k * c[2])});
            pixels[3 * i] = byte_of(rgb.r);
            pixels[3 * i + 1] = byte_of(rgb.g);
            pixels[3 * i + 2] = byte_of(rgb.b);
        }
        panel->pixels = pixels;
    }
    return SR_OK;
}

/* ---- lit balls ---- */

sr_status plot_ball(struct plot_builder *b, uint32_t specimen)
{
    const struct plot_request *r = b->request;
    enum { SIZE = 280 };
    uint8_t *pixels = sr_arena_alloc(b->arena, (size_t)SIZE * SIZE * 3);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!panel || !pixels)
        return sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    *panel =
        (struct sr_plot_panel){.kind = SR_PLOT_PICTURE,
                               .title = r->specimen_count > 1 ? r->names[specimen] : "A ball of it",
                               .x.label = r->light == SR_BALL_SKY ? "sky and a round light, D65" : "a distant sun, D65",
                               .pixels = pixels,
                               .rows = SIZE,
                               .columns = SIZE};
    return sr_specimen_ball(&r->specimens[specimen], r->light, SIZE, r->samples, pixels, b->error);
}
