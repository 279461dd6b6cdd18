/* SPDX-License-Identifier: MIT */
/* Glare indices: pixels to sources, sources to sums, sums to indices; and how far the pixels' errors shift them.
 *
 *     Var(index) = SUM over pixels (d index / d L_pixel)^2 u_pixel^2
 *     d index / d L_pixel = (d index / d L_k) w_pixel / w_k + (d index / d E) c_pixel
 *
 * with k the pixel's source and E the direct or indirect illuminance. A pixel's u is the weighted sum of the errors of
 * its channels, as if these moved together: an upper bound. Sources are connected pixels above the threshold. Sources
 * of the formulas: glare.h. */
#include "glare/glare.h"

#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

const char *const sr_glare_index_names[SR_GLARE_INDICES] = {"UGR", "DGP", "DGP, low light", "DGI", "CGI", "VCP"};

double sr_glare_position(double sigma, double tau)
{
    tau = tau > 90 ? 90 : tau;
    double a = (35.2 - 0.31889 * tau - 1.22 * exp(-2 * tau / 9)) * 1e-3,
           b = (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5;
    return exp(a * sigma + b * sigma * sigma);
}

/* ---- pixels ---- */

struct pixel {
    float L, u;             // [cd/m^2]
    float omega, projected; // [sr]
    float d[3];             // camera space
    uint32_t source1;       // index of its source, from 1; 0: none. Before: parent in the forest of sources
};

struct field {
    uint32_t width, height;
    struct pixel *pixels;
};

static void set_fisheye(struct pixel *p, enum sr_fisheye kind, double rim, struct sr_sensor_raster raster, uint32_t x,
                        uint32_t y)
{
    double omega, projected, d[3] = {0, 0, 1};
    sr_fisheye_pixel(kind, rim, raster, x, y, &omega, &projected);
    if (!(omega > 0) || !sr_fisheye_direction(kind, rim, raster, x + 0.5, y + 0.5, d))
        return;
    p->omega = (float)omega;
    p->projected = (float)projected;
    for (int i = 0; i < 3; ++i)
        p->d[i] = (float)d[i];
}

/* Camera "spherical": by parts of the pixel, of which those in front count. */
static void set_spherical(struct pixel *p, bool is_equal_area, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    enum { PARTS = 4 };
    double omega = 0, projected = 0, mean[3] = {0, 0, 0};
    for (int k = 0; k < PARTS * PARTS; ++k) {
        double u = (x + (k % PARTS + 0.5) / PARTS) / width, v = (y + (k / PARTS + 0.5) / PARTS) / height, d[3], w;
        if (is_equal_area) {
            sr_vec3 s = sr_equal_area_square_to_sphere((sr_vec2){(float)u, (float)v});
            memcpy(d, (double[3]){(double)s.x, (double)s.z, (double)s.y}, sizeof d);
            w = 4 * pi / ((double)width * height * PARTS * PARTS);
        } else {
            double theta = pi * v, phi = 2 * pi * u, half = pi / (2.0 * height * PARTS);
            memcpy(d, (double[3]){sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi)}, sizeof d);
            w = 2 * pi / ((double)width * PARTS) * 2 * sin(theta) * sin(half);
        }
        if (d[2] <= 0)
            continue;
        omega += w;
        projected += w * d[2];
        for (int i = 0; i < 3; ++i)
            mean[i] += w * d[i];
    }
    double length = sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
    if (!(length > 0))
        return;
    p->omega = (float)omega;
    p->projected = (float)projected;
    for (int i = 0; i < 3; ++i)
        p->d[i] = (float)(mean[i] / length);
}

static sr_status set_luminances(const struct sr_image *image, struct field *f, bool *has_errors, struct sr_error *error)
{
    int channel[3], error_channel[3] = {-1, -1, -1};
    double weight[3];
    if (!sr_image_luminance_weights(image, channel, weight))
        return sr_fail(error, SR_ERROR_INPUT, "the picture has no luminance: channels R, G, B or Y are expected");
    *has_errors = true;
    for (int c = 0; c < 3; ++c) {
        char name[80] = "SE.";
        strncat(name, image->channels[channel[c]].name, sizeof name - 4);
        error_channel[c] = sr_image_find_channel(image, name);
        *has_errors = *has_errors && (error_channel[c] >= 0 || weight[c] == 0);
    }
    for (size_t i = 0; i < (size_t)f->width * f->height; ++i) {
        const float *at = image->floats + i * image->channel_count;
        double L = 0, u = 0;
        for (int c = 0; c < 3; ++c) {
            L += weight[c] != 0 ? weight[c] * (double)at[channel[c]] : 0;
            u += *has_errors && weight[c] != 0 ? fabs(weight[c]) * (double)at[error_channel[c]] : 0;
        }
        if (!isfinite(L) && f->pixels[i].omega > 0)
            return sr_fail(error, SR_ERROR_INPUT, "pixel %zu,%zu is infinite or not a number", i % f->width,
                           i / f->width);
        f->pixels[i].L = (float)fmax(L, 0);
        f->pixels[i].u = (float)(isfinite(u) ? u : 0);
    }
    return SR_OK;
}

/* ---- sources: a forest over the pixels, joined where neighbours are of one kind ---- */

static uint32_t root_of(struct field *f, uint32_t i)
{
    while (f->pixels[i].source1 != i + 1) {
        uint32_t up = f->pixels[i].source1 - 1;
        f->pixels[i].source1 = f->pixels[up].source1;
        i = up;
    }
    return i;
}

static int kind_of(const struct pixel *p, double threshold, double peak)
{
    return p->omega > 0 && (double)p->L > threshold ? (double)p->L > peak ? 2 : 1 : 0;
}

static void join_pixels(struct field *f, double threshold, double peak)
{
    for (uint32_t i = 0; i < f->width * f->height; ++i) {
        uint32_t x = i % f->width, y = i / f->width;
        int kind = kind_of(&f->pixels[i], threshold, peak);
        f->pixels[i].source1 = kind ? i + 1 : 0;
        const bool has[4] = {x > 0, y > 0, x > 0 && y > 0, x + 1 < f->width && y > 0};
        const uint32_t neighbour[4] = {i - 1, i - f->width, i - f->width - 1, i - f->width + 1};
        for (int k = 0; kind && k < 4; ++k)
            if (has[k] && kind_of(&f->pixels[neighbour[k]], threshold, peak) == kind) {
                uint32_t a = root_of(f, i), b = root_of(f, neighbour[k]);
                f->pixels[a > b ? a : b].source1 = (a > b ? b : a) + 1; // the first pixel in the picture is the root
            }
    }
}

struct draft {
    struct sr_glare_source s;
    double LE, d[3], x, y, variance;
};

/* Numbers the sources and sums them up; NULL: no memory or none. */
static struct draft *sum_sources(struct field *f, uint32_t *count)
{
    uint32_t n = f->width * f->height;
    *count = 0;
    for (uint32_t i = 0; i < n; ++i)
        *count += f->pixels[i].source1 == i + 1;
    struct draft *drafts = sr_alloc((*count + 1) * sizeof *drafts);
    uint32_t *number = sr_alloc((n + 1) * sizeof *number), next = 0;
    for (uint32_t i = 0; drafts && number && i < n; ++i) { // a root comes before all of its pixels
        struct pixel *p = &f->pixels[i];
        if (!p->source1)
            continue;
        uint32_t root = root_of(f, i);
        if (root == i)
            number[i] = next++;
        struct draft *t = &drafts[number[root]];
        double LE = (double)p->L * (double)p->omega;
        t->s.pixels += 1;
        t->s.omega += (double)p->omega;
        t->s.E += (double)p->L * (double)p->projected;
        t->LE += LE;
        t->variance += pow((double)p->u * (double)p->omega, 2);
        for (int c = 0; c < 3; ++c)
            t->d[c] += LE * (double)p->d[c];
        t->x += LE * (i % f->width + 0.5);
        t->y += LE * (i / f->width + 0.5);
    }
    for (uint32_t i = n; drafts && number && i-- > 0;) // last pixels first, so that roots are still roots when asked
        if (f->pixels[i].source1)
            f->pixels[i].source1 = number[root_of(f, i)] + 1 + n;
    for (uint32_t i = 0; drafts && number && i < n; ++i)
        f->pixels[i].source1 -= f->pixels[i].source1 ? n : 0;
    if (!number) {
        sr_free(drafts);
        drafts = NULL;
    }
    sr_free(number);
    for (uint32_t k = 0; drafts && k < *count; ++k) {
        struct draft *t = &drafts[k];
        t->s.L = t->LE / t->s.omega;
        t->s.L_error = sqrt(t->variance) / t->s.omega;
        t->s.sigma_deg = atan2(hypot(t->d[0], t->d[1]), t->d[2]) * 180 / pi;
        t->s.tau_deg = atan2(fabs(t->d[0]), t->d[1]) * 180 / pi;
        t->s.position = sr_glare_position(t->s.sigma_deg, t->s.tau_deg);
        t->s.x = t->x / t->LE;
        t->s.y = t->y / t->LE;
    }
    return drafts;
}

/* ---- indices ---- */

struct totals {
    double E_i, E_d, L_mean;
    uint32_t n;
};

static double term(enum sr_glare_index index, const struct sr_glare_source *s, double L, const struct totals *t)
{
    double P = s->position, w = s->omega;
    switch (index) {
    case SR_GLARE_DGI:
        return 0.478 * pow(L, 1.6) * pow(w / (P * P), 0.8) / (t->E_i / pi + 0.07 * sqrt(w) * L);
    case SR_GLARE_VCP:
        return 0.5 * L * (20.4 * w + 1.52 * pow(w, 0.2) - 0.075) / (P * pow(t->L_mean, 0.44));
    default:
        return L * L * w / (P * P);
    }
}

static double combine(enum sr_glare_index index, double sum, const struct totals *t)
{
    double E_v = t->E_i + t->E_d, dgp = 5.87e-5 * E_v + 0.0918 * log10(1 + sum / pow(E_v, 1.87)) + 0.16;
    switch (index) {
    case SR_GLARE_UGR:
        return 8 * log10(0.25 * pi / t->E_i * sum);
    case SR_GLARE_DGP:
        return dgp;
    case SR_GLARE_DGP_LOW_LIGHT: // Wienold 2012: a sigmoid below 1000 lx
        return E_v < 1000 ? dgp / (1 + exp(4 - 0.024 * E_v)) : dgp;
    case SR_GLARE_DGI:
        return 10 * log10(sum);
    case SR_GLARE_CGI:
        return 8 * log10(2 * (1 + t->E_d / 500) / E_v * sum);
    case SR_GLARE_VCP: {
        double dgr = pow(sum, pow(t->n, -0.0914));
        return 50 * erfc(-(6.374 - 1.3227 * log(dgr)) / sqrt(2));
    }
    default:
        return (double)NAN;
    }
}

static double evaluate(enum sr_glare_index index, const struct draft *drafts, const struct totals *t, double *sum)
{
    *sum = 0;
    for (uint32_t k = 0; k < t->n; ++k)
        *sum += term(index, &drafts[k].s, drafts[k].s.L, t);
    double value = t->E_i + t->E_d > 0 ? combine(index, *sum, t) : (double)NAN;
    return isfinite(value) ? value : (double)NAN;
}

/* Standard error by the pixels' own; slope: room for one number a source. */
static double propagate(enum sr_glare_index index, const struct field *f, const struct draft *drafts,
                        const struct totals *t, double omega, double *slope)
{
    double sum, ignored, by_E[2], by_mean = 0, h;
    evaluate(index, drafts, t, &sum);
    for (int k = 0; k < 2; ++k) { // indirect, direct
        struct totals less = *t, more = *t;
        h = 1e-4 * (k ? t->E_d + 1e-9 : t->E_i);
        *(k ? &less.E_d : &less.E_i) -= h;
        *(k ? &more.E_d : &more.E_i) += h;
        by_E[k] = (evaluate(index, drafts, &more, &ignored) - evaluate(index, drafts, &less, &ignored)) / (2 * h);
    }
    if (index == SR_GLARE_VCP) {
        struct totals less = *t, more = *t;
        h = 1e-4 * t->L_mean;
        less.L_mean -= h;
        more.L_mean += h;
        by_mean = (evaluate(index, drafts, &more, &ignored) - evaluate(index, drafts, &less, &ignored)) / (2 * h);
    }
    double by_sum = sum > 0 ? (combine(index, sum * 1.0001, t) - combine(index, sum * 0.9999, t)) / (2e-4 * sum) : 0;
    for (uint32_t k = 0; k < t->n; ++k) {
        double L = drafts[k].s.L;
        slope[k] = by_sum * (term(index, &drafts[k].s, L * 1.0001, t) - term(index, &drafts[k].s, L * 0.9999, t)) /
                   (2e-4 * L) / drafts[k].s.omega;
    }
    double variance = 0;
    for (size_t i = 0; i < (size_t)f->width * f->height; ++i) {
        const struct pixel *p = &f->pixels[i];
        double d = by_E[p->source1 ? 1 : 0] * (double)p->projected + by_mean * (double)p->omega / omega;
        if (p->source1)
            d += slope[p->source1 - 1] * (double)p->omega;
        variance += d * d * (double)p->u * (double)p->u;
    }
    return sqrt(variance);
}

static int compare_sources(const void *a, const void *b)
{
    double x = ((const struct sr_glare_source *)a)->E, y = ((const struct sr_glare_source *)b)->E;
    return (x < y) - (x > y);
}

/* ---- all together ---- */

/* Means over the field and the task, the threshold. */
static sr_status survey(const struct field *f, const struct sr_glare_options *o, struct sr_glare *g,
                        struct sr_error *error)
{
    double light = 0, task_omega = 0, task_light = 0, variance = 0;
    const float *axis = NULL;
    if (o->task[2] > 0) {
        if (!(o->task[0] >= 0 && o->task[0] < f->width && o->task[1] >= 0 && o->task[1] < f->height))
            return sr_fail(error, SR_ERROR_INPUT, "the task's middle %g,%g is outside of the picture", o->task[0],
                           o->task[1]);
        axis = f->pixels[(size_t)o->task[1] * f->width + (size_t)o->task[0]].d;
    }
    for (size_t i = 0; i < (size_t)f->width * f->height; ++i) {
        const struct pixel *p = &f->pixels[i];
        double omega = (double)p->omega, L = (double)p->L;
        g->omega += omega;
        light += L * omega;
        g->E_v += L * (double)p->projected;
        variance += pow((double)p->u * (double)p->projected, 2);
        if (axis && axis[0] * p->d[0] + axis[1] * p->d[1] + axis[2] * p->d[2] >= cosf(sr_radians((float)o->task[2]))) {
            task_omega += omega;
            task_light += L * omega;
        }
    }
    if (axis && !(task_omega > 0))
        return sr_fail(error, SR_ERROR_INPUT, "the task at %g,%g sees nothing of the field", o->task[0], o->task[1]);
    g->E_v_error = sqrt(variance);
    g->L_mean = light / g->omega;
    g->L_task = axis ? task_light / task_omega : (double)NAN;
    g->threshold = o->threshold > 0 ? o->threshold : (o->factor > 0 ? o->factor : 5) * (axis ? g->L_task : g->L_mean);
    return SR_OK;
}

static sr_status measure(struct field *f, const struct sr_glare_options *o, struct sr_arena *arena, struct sr_glare *g,
                         struct sr_error *error)
{
    if (survey(f, o, g, error) != SR_OK)
        return error->status;
    join_pixels(f, g->threshold, o->peak > 0 ? o->peak : 50000);
    struct draft *drafts = sum_sources(f, &g->source_count);
    double *slope = sr_alloc((g->source_count + 1) * sizeof *slope);
    struct sr_glare_source *kept = sr_arena_alloc(arena, (g->source_count + 1) * sizeof *kept);
    uint32_t *labels = sr_arena_alloc(arena, (size_t)f->width * f->height * sizeof *labels);
    if (!drafts || !slope || !kept || !labels)
        sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u sources of glare", g->source_count);
    else {
        for (uint32_t k = 0; k < g->source_count; ++k) {
            g->E_direct += drafts[k].s.E;
            kept[k] = drafts[k].s;
        }
        g->E_indirect = fmax(0, g->E_v - g->E_direct);
        g->L_background = g->E_indirect / pi;
        struct totals t = {g->E_indirect, g->E_direct, g->L_mean, g->source_count};
        double sum;
        for (int i = 0; i < SR_GLARE_INDICES; ++i) {
            enum sr_glare_index index = (enum sr_glare_index)i;
            bool needs_source = index != SR_GLARE_DGP && index != SR_GLARE_DGP_LOW_LIGHT;
            g->index[i] = needs_source && !t.n ? (double)NAN : evaluate(index, drafts, &t, &sum);
            g->error[i] =
                g->has_errors && isfinite(g->index[i]) ? propagate(index, f, drafts, &t, g->omega, slope) : (double)NAN;
        }
        qsort(kept, g->source_count, sizeof *kept, compare_sources);
        g->sources = kept;
        for (size_t i = 0; i < (size_t)f->width * f->height; ++i)
            labels[i] = f->pixels[i].source1;
        g->labels = labels;
    }
    sr_free(drafts);
    sr_free(slope);
    return error->status;
}

sr_status sr_glare_measure(const struct sr_image *image, const struct sr_glare_options *o, struct sr_arena *arena,
                           struct sr_glare *g, struct sr_error *error)
{
    *g = (struct sr_glare){0};
    bool is_fisheye = o->projection <= SR_GLARE_STEREOGRAPHIC;
    double angle = o->angle_deg > 0 ? o->angle_deg : 180;
    if (is_fisheye && !(angle <= 180))
        return sr_fail(error, SR_ERROR_USAGE, "a fisheye of %g deg: glare is judged from at most 180 deg", angle);
    if (!image->floats)
        return sr_fail(error, SR_ERROR_INPUT, "the picture has no luminances, it is made of bytes");
    if (image->x0 || image->y0 || image->width != image->full_width || image->height != image->full_height)
        return sr_fail(error, SR_ERROR_INPUT, "a part of a picture does not tell where it looks");
    if ((uint64_t)image->width * image->height > (1u << 30))
        return sr_fail(error, SR_ERROR_INPUT, "a picture of %u x %u pixels is too large for glare", image->width,
                       image->height);
    struct field f = {image->width, image->height, sr_alloc((size_t)image->width * image->height * sizeof *f.pixels)};
    if (!f.pixels)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u x %u pixels", image->width, image->height);
    for (uint32_t y = 0; y < f.height; ++y)
        for (uint32_t x = 0; x < f.width; ++x) {
            struct pixel *p = &f.pixels[(size_t)y * f.width + x];
            if (is_fisheye)
                set_fisheye(p, (enum sr_fisheye)o->projection, angle * pi / 360,
                            (struct sr_sensor_raster){f.width, f.height}, x, y);
            else
                set_spherical(p, o->projection == SR_GLARE_EQUAL_AREA, f.width, f.height, x, y);
        }
    sr_status status = set_luminances(image, &f, &g->has_errors, error);
    if (status == SR_OK)
        status = measure(&f, o, arena, g, error);
    sr_free(f.pixels);
    return status;
}
