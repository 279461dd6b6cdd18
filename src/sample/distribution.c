/* SPDX-License-Identifier: MIT */
/* Distributions to draw from: discrete by alias tables, piecewise constant by inversion.
 *
 *     alias: outcome = frac(n u) < threshold[i] ? i : other[i],  i = floor(n u);    pmf_i = w_i / SUM w      [1]
 *     piecewise: F(x) = INTEGRAL f,  x = F^-1(u),  pdf = f / INTEGRAL f                                [1/length]
 *
 * M. Vose, A Linear Algorithm for Generating Random Numbers with a Given Distribution, 1991. Weights that are negative
 * or no numbers count as zero. A float u has 24 bits and grants probabilities in steps of 2^-24: where outcomes are
 * many, u wants more (sr_with_more_bits). */
#include "sample/sample.h"

static double weight(float w)
{
    return w > 0 && isfinite(w) ? (double)w : 0;
}

static void pair_up(const float *weights, double sum, double *share, uint32_t *work, struct sr_alias *a)
{
    // small outcomes stack up from the front, large ones from the back
    uint32_t n = a->count, small = 0, large = n, heaviest = 0;
    for (uint32_t i = 0; i < n; ++i) {
        share[i] = weight(weights[i]) / sum * n;
        a->pmf[i] = (float)(weight(weights[i]) / sum);
        heaviest = share[i] > share[heaviest] ? i : heaviest;
        if (share[i] < 1)
            work[small++] = i;
        else
            work[--large] = i;
    }
    while (small > 0 && large < n) {
        uint32_t s = work[--small], l = work[large];
        a->threshold[s] = (float)share[s];
        a->other[s] = l;
        share[l] -= 1 - share[s];
        if (share[l] < 1) {
            ++large;
            work[small++] = l;
        }
    }
    // what is left is full up to rounding, except that nothing may draw an outcome of no weight
    while (small > 0 || large < n) {
        uint32_t i = small > 0 ? work[--small] : work[large++];
        a->threshold[i] = a->pmf[i] > 0 ? 1 : 0;
        a->other[i] = a->pmf[i] > 0 ? i : heaviest;
    }
}

bool sr_alias_build(struct sr_arena *arena, const float *weights, uint32_t count, struct sr_alias *a)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i)
        sum += weight(weights[i]);
    *a = (struct sr_alias){0};
    if (!(sum > 0))
        return false;
    struct sr_alias built = {.count = count};
    built.pmf = sr_arena_alloc(arena, count * sizeof *built.pmf);
    built.threshold = sr_arena_alloc(arena, count * sizeof *built.threshold);
    built.other = sr_arena_alloc(arena, count * sizeof *built.other);
    double *share = sr_alloc(count * sizeof *share);
    uint32_t *work = sr_alloc(count * sizeof *work);
    bool ok = built.pmf && built.threshold && built.other && share && work;
    if (ok) {
        pair_up(weights, sum, share, work, &built);
        *a = built;
    }
    sr_free(work);
    sr_free(share);
    return ok;
}

uint32_t sr_alias_sample(const struct sr_alias *a, double u, float *pmf, float *u_remapped)
{
    double scaled = u * a->count; // exact where u is a float
    uint32_t i = (uint32_t)scaled;
    i = i < a->count ? i : a->count - 1;
    float fraction = (float)(scaled - i), threshold = a->threshold[i];
    bool here = fraction < threshold;
    uint32_t outcome = here ? i : a->other[i];
    if (pmf)
        *pmf = a->pmf[outcome];
    if (u_remapped)
        *u_remapped =
            sr_min(here ? fraction / threshold : (fraction - threshold) / (1 - threshold), SR_ONE_MINUS_EPSILON);
    return outcome;
}

// f and cdf have been allocated; the steps of cdf are the probabilities that sampling and pdf share
static void integrate(const float *f, struct sr_piecewise1 *d)
{
    double sum = 0, running = 0;
    for (uint32_t i = 0; i < d->count; ++i) {
        d->f[i] = (float)weight(f[i]);
        sum += weight(f[i]);
    }
    for (uint32_t i = 0; i < d->count; ++i) {
        d->cdf[i] = sum > 0 ? (float)(running / sum) : (float)((double)i / d->count);
        running += weight(f[i]);
    }
    d->cdf[d->count] = 1;
    // the sums of both loops are the same: cells of zero at the end begin at exactly 1
    d->integral = sum * ((double)d->hi - (double)d->lo) / d->count;
}

// the last cell that begins at or below u, between two cells that do and need not
static uint32_t search(const float *cdf, uint32_t first, uint32_t last, float u)
{
    for (uint32_t size = last - first + 1; size > 1;) {
        uint32_t half = size / 2;
        first = cdf[first + half] <= u ? first + half : first;
        size -= half;
    }
    return first;
}

// guide[i] is the cell at u = (i - 1/2) / count, so that no rounding of count u leads astray (H. Chen & Y. Asau, 1974)
static void make_guide(struct sr_piecewise1 *d)
{
    for (uint32_t i = 0; i < d->count + 2; ++i)
        d->guide[i] =
            (uint16_t)search(d->cdf, i ? d->guide[i - 1] : 0, d->count - 1, (float)(((double)i - 0.5) / d->count));
}

enum { MOST_GUIDED = 65536 };

bool sr_piecewise1_build(struct sr_arena *arena, const float *f, uint32_t count, float lo, float hi,
                         struct sr_piecewise1 *d)
{
    *d = (struct sr_piecewise1){.count = count, .lo = lo, .hi = hi, .per_unit = (float)count / (hi - lo)};
    d->f = count ? sr_arena_alloc(arena, count * sizeof(float)) : NULL;
    d->cdf = count ? sr_arena_alloc(arena, ((size_t)count + 1) * sizeof(float)) : NULL;
    d->guide = count <= MOST_GUIDED ? sr_arena_alloc(arena, ((size_t)count + 2) * sizeof *d->guide) : NULL;
    if (!d->f || !d->cdf || (!d->guide && count <= MOST_GUIDED))
        return false;
    integrate(f, d);
    if (d->guide)
        make_guide(d);
    return true;
}

static inline uint32_t cell_of(const struct sr_piecewise1 *d, float x)
{
    float i = (x - d->lo) * d->per_unit;
    return i > 0 ? (uint32_t)sr_min(i, (float)(d->count - 1)) : 0;
}

static inline float density(const struct sr_piecewise1 *d, uint32_t cell)
{
    return (d->cdf[cell + 1] - d->cdf[cell]) * d->per_unit;
}

float sr_piecewise1_sample(const struct sr_piecewise1 *d, float u, float *pdf, uint32_t *cell)
{
    // the last cell that begins at or below u: it ends above u, so it is not empty
    uint32_t i = (uint32_t)(u * (float)d->count);
    uint32_t first =
        d->guide && i < d->count ? search(d->cdf, d->guide[i], d->guide[i + 2], u) : search(d->cdf, 0, d->count - 1, u);
    float within = (u - d->cdf[first]) / (d->cdf[first + 1] - d->cdf[first]);
    float x = d->lo + ((float)first + within) / d->per_unit;
    // rounding at an edge must not carry x to a neighbour whose density differs
    for (int k = 0; k < 64 && cell_of(d, x) != first; ++k)
        x = nextafterf(x, cell_of(d, x) > first ? d->lo : d->hi);
    if (pdf)
        *pdf = density(d, first);
    if (cell)
        *cell = first;
    return x;
}

float sr_piecewise1_pdf(const struct sr_piecewise1 *d, float x)
{
    return x >= d->lo && x <= d->hi ? density(d, cell_of(d, x)) : 0;
}

bool sr_piecewise2_build(struct sr_arena *arena, const float *f, uint32_t nx, uint32_t ny, struct sr_piecewise2 *d)
{
    *d = (struct sr_piecewise2){.nx = nx, .ny = ny};
    size_t columns = nx, rows = ny;
    if (columns == 0 || rows == 0)
        return false;
    d->conditional = sr_arena_alloc(arena, rows * sizeof *d->conditional);
    float *values = sr_arena_alloc(arena, rows * columns * sizeof(float));
    float *cdf = sr_arena_alloc(arena, rows * (columns + 1) * sizeof(float));
    uint16_t *guides = nx <= MOST_GUIDED ? sr_arena_alloc(arena, rows * (columns + 2) * sizeof *guides) : NULL;
    float *means = sr_alloc(rows * sizeof(float));
    bool ok = d->conditional && values && cdf && means && (guides || nx > MOST_GUIDED);
    for (size_t y = 0; ok && y < rows; ++y) {
        d->conditional[y] = (struct sr_piecewise1){.count = nx,
                                                   .lo = 0,
                                                   .hi = 1,
                                                   .per_unit = (float)nx,
                                                   .f = values + y * columns,
                                                   .cdf = cdf + y * (columns + 1),
                                                   .guide = guides ? guides + y * (columns + 2) : NULL};
        integrate(f + y * columns, &d->conditional[y]);
        if (guides)
            make_guide(&d->conditional[y]);
        means[y] = (float)d->conditional[y].integral;
    }
    ok = ok && sr_piecewise1_build(arena, means, ny, 0, 1, &d->marginal);
    d->integral = d->marginal.integral;
    sr_free(means);
    return ok;
}

sr_vec2 sr_piecewise2_sample(const struct sr_piecewise2 *d, sr_vec2 u, float *pdf)
{
    float pdf_x, pdf_y;
    uint32_t row;
    float y = sr_piecewise1_sample(&d->marginal, u.y, &pdf_y, &row);
    float x = sr_piecewise1_sample(&d->conditional[row], u.x, &pdf_x, NULL);
    if (pdf)
        *pdf = pdf_x * pdf_y;
    return (sr_vec2){x, y};
}

float sr_piecewise2_pdf(const struct sr_piecewise2 *d, sr_vec2 p)
{
    if (!(p.y >= 0 && p.y <= 1))
        return 0;
    return sr_piecewise1_pdf(&d->marginal, p.y) * sr_piecewise1_pdf(&d->conditional[cell_of(&d->marginal, p.y)], p.x);
}
