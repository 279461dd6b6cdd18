/* SPDX-License-Identifier: MIT */
/* brdf plot: what is drawn as curves. Lobes in the plane of incidence, f over angles, albedo, the quality of sampling.
 */
#include "brdf_plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180;

/* ---- values ---- */

struct sr_plot_panel *plot_add_panel(struct plot_builder *b)
{
    if (b->panel_count == PLOT_PANELS) {
        sr_fail(b->error, SR_ERROR_USAGE, "a figure has at most %d panels", PLOT_PANELS);
        return NULL;
    }
    return &b->panels[b->panel_count++];
}

double *plot_numbers(struct plot_builder *b, size_t count)
{
    double *numbers = sr_arena_alloc(b->arena, count * sizeof *numbers);
    if (!numbers)
        sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    return numbers;
}

uint32_t plot_columns(const struct plot_request *r)
{
    return r->is_colour ? 1 : (uint32_t)r->lambda.count;
}

const char *plot_quantity(const struct plot_request *r)
{
    return r->has_cosine ? "f cos θ_{o}" : "f";
}

sr_vec3 plot_light(const struct plot_request *r)
{
    double t = r->theta_deg * degree, p = r->phi_deg * degree;
    return (sr_vec3){(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t)};
}

sr_vec3 plot_in_plane(const struct plot_request *r, double theta_deg)
{
    double t = theta_deg * degree, p = r->phi_deg * degree;
    return (sr_vec3){(float)(-sin(t) * cos(p)), (float)(-sin(t) * sin(p)), (float)cos(t)};
}

bool plot_transmits(const struct plot_request *r, uint32_t specimen)
{
    struct sr_specimen_at at;
    sr_specimen_at(&r->specimens[specimen], r->lambda.lambda, 1, &at);
    return at.bsdf.model && (sr_bsdf_lobes(&at.bsdf) & SR_LOBE_TRANSMISSION);
}

bool plot_is_random(const struct plot_request *r, uint32_t specimen)
{
    struct sr_specimen_at at;
    sr_specimen_at(&r->specimens[specimen], r->lambda.lambda, 1, &at);
    return at.bsdf.model && at.bsdf.model->is_random;
}

static bool any_transmits(const struct plot_request *r)
{
    for (uint32_t s = 0; s < r->specimen_count; ++s)
        if (plot_transmits(r, s))
            return true;
    return false;
}

sr_status plot_values(struct plot_builder *b, uint32_t specimen, const sr_vec3 *wo, const sr_vec3 *wi, size_t count,
                      double *values, double (*xyz)[3])
{
    const struct plot_request *r = b->request;
    // of models that are random: as many walks in all, whatever the count
    uint32_t seeds = (uint32_t)fmin(16384, fmax(32, 1e6 / (double)count));
    sr_spectrum *f = sr_arena_alloc(b->arena, count * sizeof *f);
    if (!f)
        return sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    if (!r->is_colour) {
        sr_specimen_f(&r->specimens[specimen], r->lambda.lambda, wo, wi, count, seeds, f);
        for (uint32_t k = 0; k < plot_columns(r); ++k)
            for (size_t i = 0; i < count; ++i)
                values[k * count + i] = (double)f[i][k] * (r->has_cosine ? (double)sr_abs_cos_theta(wo[i]) : 1);
        return SR_OK;
    }
    double(*sum)[3] = xyz ? xyz : sr_arena_alloc(b->arena, count * sizeof *sum);
    if (!sum)
        return sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    memset(sum, 0, count * sizeof *sum);
    for (int set = 0; set < SR_COLOUR_SETS; ++set) {
        sr_specimen_f(&r->specimens[specimen], sr_colour_lambda(set), wo, wi, count, seeds / 4, f);
        for (size_t i = 0; i < count; ++i)
            sr_colour_add(set, r->has_cosine ? f[i] * sr_abs_cos_theta(wo[i]) : f[i], sum[i]);
    }
    for (size_t i = 0; i < count; ++i)
        values[i] = sum[i][1];
    return SR_OK;
}

/* ---- curves ---- */

/* One for each specimen and wavelength over the same x; y is filled in by the caller. */
static struct sr_plot_curve *make_curves(struct plot_builder *b, const double *x, uint32_t count, uint32_t columns)
{
    const struct plot_request *r = b->request;
    uint32_t n = r->specimen_count * columns;
    struct sr_plot_curve *curves = sr_arena_alloc(b->arena, n * sizeof *curves);
    double *y = plot_numbers(b, (size_t)n * count);
    for (uint32_t i = 0; i < n && curves && y; ++i) {
        uint32_t s = i / columns, k = i % columns;
        const char *name = r->names[s];
        if (columns > 1)
            name = r->specimen_count > 1 ? sr_arena_printf(b->arena, "%s, %g nm", name, (double)r->lambda.lambda[k])
                                         : sr_arena_printf(b->arena, "%g nm", (double)r->lambda.lambda[k]);
        bool is_one = r->specimen_count == 1;
        curves[i] = (struct sr_plot_curve){.label = name,
                                           .x = x,
                                           .y = y + (size_t)i * count,
                                           .count = count,
                                           .colour = 1 + (int)(is_one ? k : s),
                                           .dash = is_one ? SR_PLOT_SOLID : (enum sr_plot_dash)(k % 4)};
    }
    if (!curves)
        sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    return b->error->status ? NULL : curves;
}

/* f over directions that are the same for all specimens. */
static struct sr_plot_curve *curves_of_f(struct plot_builder *b, const double *x, const sr_vec3 *wo, const sr_vec3 *wi,
                                         uint32_t count)
{
    uint32_t columns = plot_columns(b->request);
    struct sr_plot_curve *curves = make_curves(b, x, count, columns);
    for (uint32_t s = 0; curves && s < b->request->specimen_count; ++s)
        if (plot_values(b, s, wo, wi, count, (double *)curves[s * columns].y, NULL) != SR_OK)
            return NULL;
    return curves;
}

/* Points of random models lie apart, so that each has many walks. */
static double step_of(const struct plot_request *r)
{
    for (uint32_t s = 0; s < r->specimen_count; ++s)
        if (plot_is_random(r, s))
            return 1.5;
    return 0.125;
}

static sr_vec3 *vectors(struct plot_builder *b, uint32_t count)
{
    sr_vec3 *v = sr_arena_alloc(b->arena, count * sizeof *v);
    if (!v)
        sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    return v;
}

/* The light and the mirror's direction, and the share of the light that goes there as from a mirror (δ). */
static void add_marks(struct plot_builder *b, struct sr_plot_panel *panel, bool has_light)
{
    const struct plot_request *r = b->request;
    enum { MOST = 2 + SR_DELTAS };
    struct sr_plot_mark *marks = sr_arena_alloc(b->arena, MOST * sizeof *marks);
    uint32_t count = 0;
    if (!marks)
        return;
    if (has_light)
        marks[count++] = (struct sr_plot_mark){"light", -r->theta_deg};
    if (r->theta_deg > 0)
        marks[count++] = (struct sr_plot_mark){"mirror", r->theta_deg};
    for (uint32_t s = 0; s < r->specimen_count; ++s) {
        struct sr_delta deltas[SR_DELTAS];
        int n = sr_specimen_deltas(&r->specimens[s], r->lambda.lambda, plot_light(r), deltas);
        for (int i = 0; i < n; ++i) {
            sr_vec3 w = deltas[i].direction;
            double along = (double)w.x * -cos(r->phi_deg * degree) + (double)w.y * -sin(r->phi_deg * degree);
            double deg = atan2(along, (double)w.z) / degree;
            uint32_t k = 0;
            while (k < count && fabs(marks[k].x - deg) > 0.1)
                ++k;
            if (k == MOST)
                continue;
            if (k == count)
                marks[count++] = (struct sr_plot_mark){"", deg};
            const char *share = r->specimen_count == 1
                                    ? sr_arena_printf(b->arena, "mirror: δ %.3g", (double)deltas[i].albedo[0])
                                    : "mirror: δ";
            marks[k].label = share ? share : "";
            if (deltas[i].direction.z < 0 && r->specimen_count == 1)
                marks[k].label = sr_arena_printf(b->arena, "δ %.3g", (double)deltas[i].albedo[0]);
        }
    }
    panel->marks = marks;
    panel->mark_count = count;
}

/* Near the horizon f of many models grows without bounds: axes show the rest. */
static double largest_off_horizon(const struct sr_plot_curve *curves, uint32_t count, double margin_deg)
{
    double most = 0;
    for (uint32_t c = 0; c < count; ++c)
        for (uint32_t i = 0; i < curves[c].count; ++i)
            if (isfinite(curves[c].y[i]) && fabs(fabs(curves[c].x[i]) - 90) > margin_deg)
                most = fmax(most, curves[c].y[i]);
    return most;
}

static void settle_linear(struct sr_plot_axis *axis, const struct sr_plot_curve *curves, uint32_t count,
                          double margin_deg)
{
    double most = largest_off_horizon(curves, count, margin_deg);
    axis->from = 0;
    axis->to = most > 0 ? 1.06 * most : 1;
}

/* From what may be nought everywhere. */
static void settle_logarithm(struct sr_plot_axis *axis, const struct sr_plot_curve *curves, uint32_t count)
{
    double most = largest_off_horizon(curves, count, 4), least = most;
    for (uint32_t c = 0; c < count; ++c)
        for (uint32_t i = 0; i < curves[c].count; ++i)
            if (curves[c].y[i] > 0)
                least = fmin(least, curves[c].y[i]);
    axis->to = most > 0 ? pow(10, ceil(log10(most) - 1e-9)) : 1;
    axis->from = fmax(1e-6 * axis->to, most > 0 ? fmin(0.1 * axis->to, pow(10, floor(log10(least) + 1e-9))) : 1e-3);
}

static void finish(struct plot_builder *b, struct sr_plot_panel *panel, const struct sr_plot_curve *curves,
                   uint32_t columns)
{
    panel->curves = curves;
    panel->curve_count = b->request->specimen_count * columns;
    panel->has_no_legend = true; // the figure has one for all panels
    if (panel->y.is_log && panel->y.from == panel->y.to)
        settle_logarithm(&panel->y, curves, panel->curve_count);
}

sr_status plot_lobe(struct plot_builder *b, bool is_log)
{
    const struct plot_request *r = b->request;
    bool is_whole = any_transmits(r);
    double from = is_whole ? -180 : -90, step = step_of(r);
    uint32_t count = (uint32_t)lround(-2 * from / step) + 1;
    double *x = plot_numbers(b, count);
    sr_vec3 *wo = vectors(b, count), *wi = vectors(b, count);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!x || !wo || !wi || !panel)
        return b->error->status;
    for (uint32_t i = 0; i < count; ++i) {
        x[i] = from + step * i;
        wo[i] = plot_in_plane(r, x[i]);
        wi[i] = plot_light(r);
    }
    const struct sr_plot_curve *curves = curves_of_f(b, x, wo, wi, count);
    if (!curves)
        return b->error->status;
    *panel = (struct sr_plot_panel){
        .kind = SR_PLOT_POLAR,
        .title = is_log ? "Plane of incidence, logarithmic" : "Plane of incidence",
        .x = {.label = "θ_{o}", .unit = "°", .from = is_whole ? -180 : -90, .to = is_whole ? 180 : 90},
        .y = {.label = plot_quantity(r), .unit = "sr^{-1}", .is_log = is_log}};
    add_marks(b, panel, true);
    uint32_t n = r->specimen_count * plot_columns(r);
    if (!is_log)
        settle_linear(&panel->y, curves, n, 3);
    else {
        settle_logarithm(&panel->y, curves, n);
        panel->y.from = fmin(panel->y.from, 1e-4 * panel->y.to); // a lobe is told from a circle
    }
    finish(b, panel, curves, plot_columns(r));
    return SR_OK;
}

sr_status plot_theta(struct plot_builder *b)
{
    const struct plot_request *r = b->request;
    double step = step_of(r);
    uint32_t count = (uint32_t)lround(180 / step) + 1;
    double *x = plot_numbers(b, count);
    sr_vec3 *wo = vectors(b, count), *wi = vectors(b, count);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!x || !wo || !wi || !panel)
        return b->error->status;
    for (uint32_t i = 0; i < count; ++i) {
        x[i] = -90 + step * i;
        wo[i] = plot_in_plane(r, fmin(fmax(x[i], -89.999), 89.999));
        wi[i] = plot_light(r);
    }
    const struct sr_plot_curve *curves = curves_of_f(b, x, wo, wi, count);
    if (!curves)
        return b->error->status;
    *panel = (struct sr_plot_panel){.kind = SR_PLOT_LINES,
                                    .title = "Against the angle of view",
                                    .x = {.label = "θ_{o}", .unit = "°", .from = -90, .to = 90},
                                    .y = {.label = plot_quantity(r), .unit = "sr^{-1}", .is_log = r->is_log}};
    add_marks(b, panel, false);
    if (!r->is_log)
        settle_linear(&panel->y, curves, r->specimen_count * plot_columns(r), 8);
    finish(b, panel, curves, plot_columns(r));
    return SR_OK;
}

/* Both directions at theta_d from the half vector, across its plane of inclination: their cosines are equal, and there
 * is light for each theta_h below 90 deg. */
static void pair_about_half(double theta_h, double theta_d, sr_vec3 *wo, sr_vec3 *wi)
{
    double ch = cos(theta_h * degree), sh = sin(theta_h * degree), cd = cos(theta_d * degree),
           sd = sin(theta_d * degree);
    *wi = (sr_vec3){(float)(sh * cd), (float)sd, (float)(ch * cd)};
    *wo = (sr_vec3){(float)(sh * cd), (float)-sd, (float)(ch * cd)};
}

sr_status plot_half(struct plot_builder *b)
{
    const struct plot_request *r = b->request;
    double step = step_of(r);
    uint32_t count = (uint32_t)lround(90 / step) + 1;
    double *x = plot_numbers(b, count);
    sr_vec3 *wo = vectors(b, count), *wi = vectors(b, count);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!x || !wo || !wi || !panel)
        return b->error->status;
    for (uint32_t i = 0; i < count; ++i) {
        x[i] = step * i;
        pair_about_half(fmin(x[i], 89.999), r->theta_d_deg, &wo[i], &wi[i]);
    }
    const struct sr_plot_curve *curves = curves_of_f(b, x, wo, wi, count);
    if (!curves)
        return b->error->status;
    *panel = (struct sr_plot_panel){
        .kind = SR_PLOT_LINES,
        .title = sr_arena_printf(b->arena, "Against the half angle, θ_{d} = %g°", r->theta_d_deg),
        .x = {.label = "θ_{h}", .unit = "°", .from = 0, .to = 90},
        .y = {.label = plot_quantity(r), .unit = "sr^{-1}", .is_log = r->is_log}};
    if (!r->is_log)
        settle_linear(&panel->y, curves, r->specimen_count * plot_columns(r), 8);
    finish(b, panel, curves, plot_columns(r));
    return SR_OK;
}

/* ---- albedo ---- */

static void albedo_at(const struct plot_request *r, uint32_t specimen, sr_vec3 w, double *reflected,
                      double *transmitted, uint32_t stride)
{
    uint32_t draws = plot_is_random(r, specimen) ? 16384 : 4096;
    if (!r->is_colour) {
        struct sr_specimen_albedo a = sr_specimen_albedo(&r->specimens[specimen], r->lambda.lambda, w, draws);
        for (uint32_t k = 0; k < plot_columns(r) && k < SR_LAMBDA_COUNT; ++k) {
            reflected[k * stride] = (double)a.reflected[k];
            transmitted[k * stride] = (double)a.transmitted[k];
        }
        return;
    }
    double up[3] = {0}, down[3] = {0};
    for (int set = 0; set < SR_COLOUR_SETS; ++set) {
        struct sr_specimen_albedo a = sr_specimen_albedo(&r->specimens[specimen], sr_colour_lambda(set), w, draws / 4);
        sr_colour_add(set, a.reflected, up);
        sr_colour_add(set, a.transmitted, down);
    }
    *reflected = up[1];
    *transmitted = down[1];
}

sr_status plot_albedo(struct plot_builder *b)
{
    const struct plot_request *r = b->request;
    enum { COUNT = 61 };
    bool is_both = any_transmits(r);
    uint32_t columns = plot_columns(r), n = r->specimen_count * columns;
    double *x = plot_numbers(b, COUNT);
    struct sr_plot_curve *reflected = make_curves(b, x, COUNT, columns);
    double *transmitted = plot_numbers(b, (size_t)n * COUNT);
    struct sr_plot_curve *all = sr_arena_alloc(b->arena, 2 * n * sizeof *all);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!x || !reflected || !transmitted || !all || !panel)
        return sr_fail(b->error, SR_ERROR_RESOURCE, "not enough memory for a figure");
    double most = 0;
    for (uint32_t i = 0; i < COUNT; ++i) {
        x[i] = fmin(1.5 * i, 89.9);
        double t = x[i] * degree, p = r->phi_deg * degree;
        sr_vec3 w = {(float)(sin(t) * cos(p)), (float)(sin(t) * sin(p)), (float)cos(t)};
        for (uint32_t s = 0; s < r->specimen_count; ++s)
            albedo_at(r, s, w, (double *)reflected[s * columns].y + i, transmitted + (size_t)s * columns * COUNT + i,
                      COUNT);
    }
    for (uint32_t i = 0; i < n; ++i) {
        all[i] = reflected[i];
        all[n + i] = reflected[i];
        all[n + i].y = transmitted + (size_t)i * COUNT;
        all[n + i].dash = SR_PLOT_DASHED;
        all[n + i].label = NULL;
        for (uint32_t k = 0; k < COUNT; ++k)
            if (x[k] < 82) // beyond, some grow without bounds
                most = fmax(most, fmax(reflected[i].y[k], is_both ? all[n + i].y[k] : 0));
    }
    *panel = (struct sr_plot_panel){
        .kind = SR_PLOT_LINES,
        .title = is_both ? "Albedo: reflected, and transmitted (dashed)" : "Directional-hemispherical albedo",
        .x = {.label = "θ_{i}", .unit = "°", .from = 0, .to = 90},
        .y = {.label = "E", .unit = "1", .from = 0, .to = most > 1.02 ? 1.06 * most : 1.02}};
    finish(b, panel, all, columns);
    panel->curve_count = is_both ? 2 * n : n;
    return SR_OK;
}

/* ---- how well the sampler follows ---- */

/* pdf E / (f cos theta): 1 where as many samples are drawn as light is there; where it is small, samples that are
 * seldom drawn weigh much, and images have bright dots. */
static void sampling_of(const struct plot_request *r, uint32_t specimen, const double *x, uint32_t count, double *y)
{
    sr_vec3 wo = plot_light(r);
    struct sr_specimen_albedo a = sr_specimen_albedo(&r->specimens[specimen], r->lambda.lambda, wo, 4096);
    struct sr_specimen_at at;
    uint32_t seeds = plot_is_random(r, specimen) ? 4096 : 1;
    for (uint32_t seed = 0; seed < seeds; ++seed) {
        sr_specimen_at(&r->specimens[specimen], r->lambda.lambda, seed, &at);
        for (uint32_t i = 0; i < count; ++i) {
            sr_vec3 wi = plot_in_plane(r, x[i]);
            y[i] += (double)sr_bsdf_f(&at.bsdf, wo, wi, SR_IMPORTANCE)[0] * (double)sr_abs_cos_theta(wi) / seeds;
        }
    }
    for (uint32_t i = 0; i < count; ++i) {
        double p = (double)sr_bsdf_pdf(&at.bsdf, wo, plot_in_plane(r, x[i]), SR_IMPORTANCE);
        double share = y[i] / (double)(a.reflected[0] + a.transmitted[0]);
        y[i] = share > 0 && p > 0 && fabs(fabs(x[i]) - 90) > 0.6 ? p / share : (double)NAN; // not along the surface
    }
}

sr_status plot_sampling(struct plot_builder *b)
{
    const struct plot_request *r = b->request;
    double from = any_transmits(r) ? -180 : -90, step = step_of(r);
    uint32_t count = (uint32_t)lround(-2 * from / step) + 1;
    double *x = plot_numbers(b, count), least = INFINITY, most = 0;
    struct sr_plot_curve *curves = make_curves(b, x, count, 1);
    struct sr_plot_panel *panel = plot_add_panel(b);
    if (!x || !curves || !panel)
        return b->error->status;
    for (uint32_t i = 0; i < count; ++i)
        x[i] = from + step * i;
    for (uint32_t s = 0; s < r->specimen_count; ++s) {
        sampling_of(r, s, x, count, (double *)curves[s].y);
        for (uint32_t i = 0; i < count; ++i)
            if (curves[s].y[i] > 0) {
                least = fmin(least, curves[s].y[i]);
                most = fmax(most, curves[s].y[i]);
            }
    }
    if (!(most > 0)) { // nothing but delta lobes: the sampler knows them
        b->panel_count -= 1;
        return SR_OK;
    }
    *panel = (struct sr_plot_panel){.kind = SR_PLOT_LINES,
                                    .title = "Sampling: density over light, 1 is perfect",
                                    .x = {.label = "θ_{i} of samples", .unit = "°", .from = from, .to = -from},
                                    .y = {.label = "pdf E / (f cos θ_{i})",
                                          .unit = "1",
                                          .is_log = true,
                                          .from = fmax(1e-4, fmin(0.1, pow(10, floor(log10(least))))),
                                          .to = fmin(1e4, fmax(10, pow(10, ceil(log10(most)))))}};
    finish(b, panel, curves, 1);
    return SR_OK;
}
