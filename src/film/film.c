/* SPDX-License-Identifier: MIT */
/* Pixels as sums, and what the spread of their blocks says about their error.
 *
 *     mean = S / N,   S = sum over blocks of s_b,   N = sum of n_b
 *     var(mean) <= [ sum s_b^2 / n_b  -  S^2 / N ] / ((B - 1) N)
 *
 * With independent blocks (replicates) this is the unbiased estimate. The blocks of one scrambled net repel each other,
 * so that the mean varies less than this says: the estimate is conservative (docs/decisions/0003-error-bars.md). */
#include "film/film.h"

#include <string.h>

static const uint32_t MAX_SIDE = 1u << 20; // [pixel]

sr_status sr_film_create(const struct sr_film_settings *settings, bool with_aov, struct sr_film **out,
                         struct sr_error *error)
{
    *out = NULL;
    int64_t w = (int64_t)settings->x1 - settings->x0, h = (int64_t)settings->y1 - settings->y0;
    if (w <= 0 || h <= 0)
        return sr_fail(error, SR_ERROR_INPUT, "the picture has no pixels: crop x %d to %d, y %d to %d", settings->x0,
                       settings->x1, settings->y0, settings->y1);
    if (w > MAX_SIDE || h > MAX_SIDE)
        return sr_fail(error, SR_ERROR_RESOURCE, "a picture of %lld x %lld pixels is too large: at most %u a side",
                       (long long)w, (long long)h, MAX_SIDE);
    struct sr_film *film = sr_alloc(sizeof *film);
    size_t n = (size_t)w * (size_t)h;
    if (film) {
        film->pixels = sr_alloc(n * sizeof *film->pixels);
        film->aov = with_aov ? sr_alloc(n * sizeof *film->aov) : NULL;
        film->buckets = settings->buckets ? sr_alloc(n * settings->buckets * sizeof *film->buckets) : NULL;
    }
    if (!film || !film->pixels || (with_aov && !film->aov) || (settings->buckets && !film->buckets)) {
        sr_film_destroy(film);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a picture of %lld x %lld pixels", (long long)w,
                       (long long)h);
    }
    film->settings = *settings;
    film->width = (uint32_t)w;
    film->height = (uint32_t)h;
    film->has_aov = with_aov;
    *out = film;
    return SR_OK;
}

void sr_film_destroy(struct sr_film *film)
{
    if (!film)
        return;
    if (film->splats)
        sr_free(film->splats->words);
    sr_free(film->splats);
    sr_free(film->pixels);
    sr_free(film->aov);
    sr_free(film->buckets);
    sr_free(film);
}

double sr_film_imaging_ratio(const struct sr_film_settings *s)
{
    return (double)s->exposure_time * (double)s->iso / 100;
}

bool sr_film_is_radiance(const struct sr_film_settings *s)
{
    return fabs(sr_film_imaging_ratio(s) - 1) < 1e-6; // shutters are differences of floats
}

bool sr_film_is_luminance(const struct sr_film_settings *s)
{
    return !s->camera1 && !(s->white_balance > 0) && isinf(s->max_component) && sr_film_is_radiance(s);
}

void sr_film_response(const struct sr_film_settings *s, float rgb_from_xyz[3][3])
{
    const struct sr_colour_space *space = sr_colour_space(s->space);
    double balance[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (s->camera1) {
        sr_film_camera_matrix(s->camera1, s->white_balance > 0 ? (double)s->white_balance : 6500, s->space, balance);
    } else if (s->white_balance > 0) {
        double source[2];
        sr_daylight_xy((double)s->white_balance, source);
        sr_white_balance(source, space->xy[3], balance);
    }
    double imaging_ratio = sr_film_imaging_ratio(s);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double sum = 0;
            for (int k = 0; k < 3; ++k)
                sum += space->rgb_from_xyz[i][k] * balance[k][j];
            rgb_from_xyz[i][j] = (float)(sum * imaging_ratio);
        }
}

void sr_film_block_add(struct sr_film_block *b, const float rgb[3], bool is_finite)
{
    b->n += 1;
    if (!is_finite) {
        b->dropped += 1;
        return;
    }
    for (int c = 0; c < 3; ++c)
        b->rgb[c] += (double)rgb[c];
    b->largest = sr_max(b->largest, rgb[0] + rgb[1] + rgb[2]);
}

void sr_film_block_add_first(struct sr_film_block *b, const struct sr_first_hit *h)
{
    b->samples_seen += 1;
    if (!h->is_hit)
        return;
    struct sr_first_hit *s = &b->first_sum;
    if (b->hits++ == 0) {
        s->material = h->material; // numbers have no mean: the first sample's stand
        s->object = h->object;
    }
    for (int c = 0; c < 3; ++c)
        s->albedo[c] += h->albedo[c];
    s->n = sr_add(s->n, h->n);
    s->ns = sr_add(s->ns, h->ns);
    s->p = sr_add(s->p, h->p);
    s->depth += h->depth;
    s->uv = (sr_vec2){s->uv.x + h->uv.x, s->uv.y + h->uv.y};
    s->dzdx += h->dzdx;
    s->dzdy += h->dzdy;
    for (int c = 0; c < 3; ++c) {
        s->rgb[c] += h->rgb[c];
        b->square[c] += (double)h->rgb[c] * (double)h->rgb[c];
    }
}

static void join_first(struct sr_film_block *a, const struct sr_film_block *b)
{
    struct sr_first_hit *s = &a->first_sum;
    const struct sr_first_hit *t = &b->first_sum;
    if (a->hits == 0)
        s->material = t->material, s->object = t->object;
    for (int c = 0; c < 3; ++c) {
        s->albedo[c] += t->albedo[c];
        s->rgb[c] += t->rgb[c];
        a->square[c] += b->square[c];
    }
    s->n = sr_add(s->n, t->n);
    s->ns = sr_add(s->ns, t->ns);
    s->p = sr_add(s->p, t->p);
    s->depth += t->depth;
    s->uv = (sr_vec2){s->uv.x + t->uv.x, s->uv.y + t->uv.y};
    s->dzdx += t->dzdx;
    s->dzdy += t->dzdy;
    a->hits += b->hits;
    a->samples_seen += b->samples_seen;
}

void sr_film_block_join(struct sr_film_block *a, const struct sr_film_block *b)
{
    for (int c = 0; c < 3; ++c)
        a->rgb[c] += b->rgb[c];
    a->n += b->n;
    a->dropped += b->dropped;
    a->largest = sr_max(a->largest, b->largest);
    if (b->samples_seen)
        join_first(a, b);
}

void sr_film_store_buckets(struct sr_film *film, uint32_t x, uint32_t y, const double *buckets)
{
    uint32_t n = film->settings.buckets;
    double *to = film->buckets + ((size_t)y * film->width + x) * n;
    for (uint32_t i = 0; i < n; ++i)
        to[i] += buckets[i];
}

double sr_film_bucket(const struct sr_film *film, uint32_t x, uint32_t y, uint32_t bucket)
{
    size_t pixel = (size_t)y * film->width + x;
    return film->pixels[pixel].n ? film->buckets[pixel * film->settings.buckets + bucket] / film->pixels[pixel].n : 0;
}

void sr_film_store(struct sr_film *film, uint32_t x, uint32_t y, const struct sr_film_block *b)
{
    size_t i = (size_t)y * film->width + x;
    struct sr_film_pixel *p = &film->pixels[i];
    for (int c = 0; c < 3; ++c) {
        p->sum[c] += b->rgb[c];
        p->square[c] += b->n ? b->rgb[c] * b->rgb[c] / b->n : 0;
    }
    p->n += b->n;
    p->blocks += 1;
    p->dropped += b->dropped;
    p->largest = sr_max(p->largest, b->largest);
    if (!film->has_aov)
        return;
    struct sr_film_aov *a = &film->aov[i];
    const struct sr_first_hit *s = &b->first_sum;
    if (a->hits == 0) {
        a->material = s->material;
        a->object = s->object;
    }
    for (int c = 0; c < 3; ++c) {
        a->albedo[c] += s->albedo[c];
        a->n[c] += sr_component(s->n, c);
        a->ns[c] += sr_component(s->ns, c);
        a->p[c] += sr_component(s->p, c);
    }
    a->depth += s->depth;
    a->uv[0] += s->uv.x;
    a->uv[1] += s->uv.y;
    a->dzdx += s->dzdx;
    a->dzdy += s->dzdy;
    for (int c = 0; c < 3; ++c) {
        a->rgb[c] += (double)s->rgb[c];
        a->square[c] += b->square[c];
    }
    a->hits += b->hits;
    a->n_samples += b->samples_seen;
}

void sr_film_pixel_mean(const struct sr_film *film, uint32_t x, uint32_t y, double mean[3])
{
    const struct sr_film_pixel *p = &film->pixels[(size_t)y * film->width + x];
    for (int c = 0; c < 3; ++c)
        mean[c] = (p->n ? p->sum[c] / p->n : 0) + sr_film_splat_mean(film, (size_t)y * film->width + x, c);
}

/* Variance of the mean of channel c; NaN with fewer than two blocks. */
static double mean_variance(const struct sr_film_pixel *p, int c)
{
    if (p->blocks < 2)
        return NAN;
    double spread = p->square[c] - p->sum[c] * p->sum[c] / p->n;
    return fmax(0, spread) / ((double)(p->blocks - 1) * p->n);
}

static double pixel_variance(const struct sr_film *film, uint32_t x, uint32_t y, int c)
{
    double w[3] = {0, 0, 0};
    w[c] = 1;
    return mean_variance(&film->pixels[(size_t)y * film->width + x], c) +
           sr_film_splat_variance(film, x, y, x + 1, y + 1, w);
}

static void join_pixel(struct sr_film_pixel *a, const struct sr_film_pixel *b)
{
    if (b->n == 0)
        return;
    if (a->n == 0) {
        *a = *b;
        return;
    }
    // the sums of a film whose plain mean and spread are those of the halves together
    struct sr_film_pixel p = {.n = a->n + b->n,
                              .blocks = a->blocks + b->blocks - 1,
                              .dropped = a->dropped + b->dropped,
                              .largest = sr_max(a->largest, b->largest)};
    for (int c = 0; c < 3; ++c) {
        double mean = (a->sum[c] / a->n + b->sum[c] / b->n) / 2,
               variance = (mean_variance(a, c) + mean_variance(b, c)) / 4;
        p.sum[c] = mean * p.n;
        p.square[c] = p.sum[c] * mean + (isfinite(variance) ? variance * ((double)(p.blocks - 1) * p.n) : 0);
    }
    *a = p;
}

void sr_film_join_halves(struct sr_film *a, const struct sr_film *b)
{
    size_t count = (size_t)a->width * a->height, buckets = a->settings.buckets;
    for (size_t i = 0; i < count * buckets; ++i) { // means, and then sums of all samples
        uint32_t n = a->pixels[i / buckets].n, m = b->pixels[i / buckets].n;
        double mean = n && m ? (a->buckets[i] / n + b->buckets[i] / m) / 2
                      : n    ? a->buckets[i] / n
                      : m    ? b->buckets[i] / m
                             : 0;
        a->buckets[i] = mean * ((double)n + m);
    }
    for (size_t i = 0; i < count; ++i)
        join_pixel(&a->pixels[i], &b->pixels[i]);
    for (size_t i = 0; a->has_aov && i < count; ++i) {
        struct sr_film_aov *to = &a->aov[i];
        const struct sr_film_aov *from = &b->aov[i];
        if (to->hits == 0)
            to->material = from->material, to->object = from->object;
        for (int c = 0; c < 3; ++c) {
            to->albedo[c] += from->albedo[c];
            to->n[c] += from->n[c];
            to->ns[c] += from->ns[c];
            to->p[c] += from->p[c];
        }
        to->depth += from->depth;
        to->uv[0] += from->uv[0];
        to->uv[1] += from->uv[1];
        to->dzdx += from->dzdx;
        to->dzdy += from->dzdy;
        for (int c = 0; c < 3; ++c) {
            to->rgb[c] += from->rgb[c];
            to->square[c] += from->square[c];
        }
        to->hits += from->hits;
        to->n_samples += from->n_samples;
    }
}

double sr_film_relative_error(const struct sr_film *film, const double w[3])
{
    double mean = 0, variance = 0;
    size_t count = (size_t)film->width * film->height;
    for (size_t i = 0; i < count; ++i) {
        const struct sr_film_pixel *p = &film->pixels[i];
        double se = 0;
        for (int c = 0; c < 3; ++c) {
            mean += p->n ? w[c] * p->sum[c] / p->n : 0;
            se += fabs(w[c]) * sqrt(mean_variance(p, c));
        }
        variance += se * se;
    }
    return sqrt(variance * (double)count) / mean;
}

uint64_t sr_film_doubtful_pixels(const struct sr_film *film)
{
    uint64_t count = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; ++i) {
        const struct sr_film_pixel *p = &film->pixels[i];
        double sum = p->sum[0] + p->sum[1] + p->sum[2];
        count += p->n >= 16 && (double)p->largest > fmax(0.05, 16.0 / p->n) * sum;
    }
    return count;
}

/* Variances of five rows of a strip and its neighbours, for each channel; those that are not known are 0. */
enum { POOL = 2, ROWS = 2 * POOL + 1, STRIP = 64, COLUMNS = STRIP + 2 * POOL }; // pools of 5 x 5 pixels
struct variances {
    double variance[ROWS][3][COLUMNS], is_known[ROWS][3][COLUMNS]; // row y is at y % ROWS
};

static void fill_variances(const struct sr_film *film, int64_t x0, int64_t y, int columns, struct variances *v)
{
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < columns; ++k) {
            bool is_inside = x0 + k >= 0 && x0 + k < film->width && y >= 0 && y < film->height;
            double variance = is_inside ? pixel_variance(film, (uint32_t)(x0 + k), (uint32_t)y, c) : NAN;
            v->variance[(y + ROWS) % ROWS][c][k] = isfinite(variance) ? variance : 0;
            v->is_known[(y + ROWS) % ROWS][c][k] = isfinite(variance);
        }
}

/* The errors of a strip's row from it and `reach` neighbours to each side. */
static void pool_row(const struct variances *v, int64_t y, int width, int reach, double *standard_error)
{
    for (int c = 0; c < 3; ++c) {
        double sum[STRIP] = {0}, count[STRIP] = {0};
        const double *own = v->variance[y % ROWS][c] + reach;
        for (int64_t j = y - reach; j <= y + reach; ++j)
            for (int i = 0; i <= 2 * reach; ++i) {
                const double *variance = v->variance[(j + ROWS) % ROWS][c] + i,
                             *is_known = v->is_known[(j + ROWS) % ROWS][c] + i;
                for (int k = 0; k < width; ++k) {
                    sum[k] += variance[k];
                    count[k] += is_known[k];
                }
            }
        // the neighbours steady the estimate; a pixel that is seen to vary more than they do keeps its own
        for (int k = 0; k < width; ++k)
            standard_error[3 * k + c] = count[k] > 0 ? sqrt(fmax(sum[k] / count[k], own[k])) : NAN;
    }
}

void sr_film_errors(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, bool pooled,
                    double *standard_error)
{
    int reach = pooled ? POOL : 0;
    for (uint32_t x = x0; x < x1; x += STRIP) {
        int width = x1 - x < STRIP ? (int)(x1 - x) : STRIP;
        struct variances v;
        int64_t next = (int64_t)y0 - reach;
        for (int64_t y = y0; y < y1; ++y) {
            for (; next <= y + reach; ++next)
                fill_variances(film, (int64_t)x - reach, next, width + 2 * reach, &v);
            pool_row(&v, y, width, reach, standard_error + 3 * ((size_t)(y - y0) * (x1 - x0) + (x - x0)));
        }
    }
}

struct sr_film_mean sr_film_region_mean(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1,
                                        const double w[3])
{
    struct sr_film_mean m = {0};
    double variance = 0, fourth = 0, blocks = 0;
    double count = (double)(x1 - x0) * (double)(y1 - y0);
    for (uint32_t y = y0; y < y1; ++y)
        for (uint32_t x = x0; x < x1; ++x) {
            const struct sr_film_pixel *p = &film->pixels[(size_t)y * film->width + x];
            double se = 0;
            for (int c = 0; c < 3; ++c) {
                m.mean += (p->n ? w[c] * p->sum[c] / p->n : 0) +
                          w[c] * sr_film_splat_mean(film, (size_t)y * film->width + x, c);
                // the channels of a sample go together: standard deviations add, which is the upper bound
                double v = mean_variance(p, c);
                se += fabs(w[c]) * sqrt(isfinite(v) ? v : 0);
            }
            variance += se * se;
            fourth += se * se * se * se;
            blocks = p->blocks > blocks ? p->blocks : blocks;
        }
    if (film->splats) {
        double splats = sr_film_splat_variance(film, x0, y0, x1, y1, w);
        variance += splats;
        fourth += splats * splats * (blocks - 1) / (film->splats->groups - 1);
    }
    m.mean /= count;
    m.standard_error = blocks >= 2 ? sqrt(variance) / count : NAN;
    // Welch and Satterthwaite: many pixels of few blocks each have many degrees of freedom together
    m.degrees = fourth > 0 ? fmax(1, (blocks - 1) * variance * variance / fourth) : fmax(1, blocks - 1);
    return m;
}
