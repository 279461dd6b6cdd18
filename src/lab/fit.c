/* SPDX-License-Identifier: MIT */
/* The parameters of a model that come nearest to data, and how well the data knows them.
 *
 *     minimise S(p) = sum_k (T(g_model(k; p)) - T(g_data(k)))^2,   g = f |cos theta_i|      [1/sr]
 *     cov(p) = S / (K - P) (J^T J)^-1                                                       of the fitted parameters
 *
 * T is the metric; k runs over pairs of directions and wavelengths. Parameters are held in their table's range by
 * p = lo + (hi - lo) (1 + sin t) / 2, or the same of log p where the range spans decades (F. James, MINUIT, 1975); the
 * uncertainties come back from t by dp/dt. Levenberg & Marquardt by MINPACK's lmdif (Moré, Garbow & Hillstrom 1980).
 * The residuals of a fit are mostly the model's misfit, not noise: the uncertainties say how sharply the minimum is
 * known, as if the misfit were scatter. */
#include "lab/lab.h"

#include <cminpack.h>
#include <stdio.h>
#include <string.h>

enum { EVALUATIONS_PER_PARAMETER = 400 };
#define TURN 6.283185307179586 // lmdif's steps are relative to t, which must not come near 0

struct unknown {
    const struct sr_param *row;
    int lane; // of a spectrum; -1: shared
    bool is_log;
};

struct problem {
    const struct sr_bsdf_model *model;
    const struct sr_fit_options *options;
    unsigned char *pattern; // data of the model before it gets ready: SR_BSDF_SIZE
    struct unknown unknowns[SR_FIT_PARAMETERS];
    int count;
    struct sr_fit_point *points;
    uint32_t point_count;
    double floor; // [1/sr] added before the logarithm
};

/* ---- parameters ---- */

static double from_unbound(const struct unknown *u, double t)
{
    double share = (1 + sin(t)) / 2, lo = u->row->min, hi = u->row->max;
    return u->is_log ? lo * pow(hi / lo, share) : lo + (hi - lo) * share;
}

static double to_unbound(const struct unknown *u, double p)
{
    double lo = u->row->min, hi = u->row->max, share = u->is_log ? log(p / lo) / log(hi / lo) : (p - lo) / (hi - lo);
    share = share > 0.999 ? 0.999 : share < 0.001 ? 0.001 : share; // at the very end the slope is 0, and nothing moves
    return asin(2 * share - 1) + TURN;
}

static double slope(const struct unknown *u, double t)
{
    double lo = u->row->min, hi = u->row->max, half_cos = cos(t) / 2;
    return u->is_log ? from_unbound(u, t) * log(hi / lo) * half_cos : (hi - lo) * half_cos;
}

static float *member(unsigned char *data, const struct unknown *u)
{
    return (float *)(void *)(data + u->row->offset) + (u->lane < 0 ? 0 : u->lane);
}

static bool is_spectrum(const struct sr_param *row)
{
    return row->kind == SR_PARAM_ALBEDO || row->kind == SR_PARAM_UNBOUNDED;
}

static bool is_fixed(const struct sr_fit_options *o, const char *name)
{
    for (int i = 0; i < o->fixed_count; ++i)
        if (strcmp(o->fixed[i], name) == 0)
            return true;
    return false;
}

// what the words of the specimen say of a row, into the model's data; the material's table has the same rows
static void take(const struct sr_material *m, const struct sr_param *row, const struct sr_param *mine,
                 sr_spectrum lambda, unsigned char *pattern)
{
    const char *from = (const char *)m->self + row->offset;
    void *to = pattern + mine->offset;
    if (row->kind == SR_PARAM_FLOAT_TEXTURE) {
        float value = (float)mine->initial;
        const struct sr_texture *t = (const void *)from;
        if (t->model)
            sr_texture_is_constant_float(*t, &value);
        memcpy(to, &value, sizeof value);
    } else if (is_spectrum(mine)) {
        struct sr_spd spd = sr_spd_constant((float)mine->initial);
        const struct sr_texture *t = (const void *)from;
        if (t->model)
            sr_texture_is_constant_spectrum(*t, &spd);
        sr_spectrum value = sr_spd_eval(&spd, lambda);
        memcpy(to, &value, sizeof value);
    } else {
        memcpy(to, from, row->kind == SR_PARAM_FILE ? sizeof(char *) : row->kind == SR_PARAM_BOOL ? sizeof(bool) : 4);
    }
}

static sr_status add_unknown(struct problem *p, const struct sr_param *row, int lane, struct sr_error *error)
{
    if (p->count == SR_FIT_PARAMETERS)
        return sr_fail(error, SR_ERROR_USAGE, "%s: more than %d numbers to fit: fix some, or ask for fewer wavelengths",
                       p->model->name, SR_FIT_PARAMETERS);
    if (!isfinite(row->min) || !isfinite(row->max))
        return sr_fail(error, SR_ERROR_USAGE, "%s: %s has no finite range: it cannot be fitted, only fixed",
                       p->model->name, row->name);
    bool is_log = row->min > 0 && row->max > 50 * row->min;
    p->unknowns[p->count++] = (struct unknown){row, lane, is_log};
    return SR_OK;
}

static sr_status begin(struct problem *p, struct sr_arena *arena, const struct sr_specimen *words,
                       struct sr_error *error)
{
    const struct sr_fit_options *o = p->options;
    if (words->part_count != 1 || words->parts[0].weight != 1 || !words->parts[0].model)
        return sr_fail(error, SR_ERROR_USAGE, "%s: one model of the list was expected, without a weight", words->title);
    p->model = words->parts[0].model;
    p->pattern = sr_arena_alloc(arena, SR_BSDF_SIZE);
    if (!p->pattern)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a fit");
    const struct sr_material *material = &words->parts[0].material;
    sr_status status = SR_OK;
    for (int i = 0; p->model->params[i].name && status == SR_OK; ++i) {
        const struct sr_param *row = &p->model->params[i];
        take(material, &material->model->params[i], row, o->lambda, p->pattern);
        if (is_fixed(o, row->name))
            continue;
        if (row->kind == SR_PARAM_FLOAT)
            status = add_unknown(p, row, -1, error);
        for (int lane = 0; is_spectrum(row) && lane < o->lambda_count && status == SR_OK; ++lane)
            status = add_unknown(p, row, lane, error);
    }
    for (int i = 0; i < o->fixed_count && status == SR_OK; ++i) {
        const struct sr_param *row = p->model->params;
        while (row->name && strcmp(row->name, o->fixed[i]) != 0)
            ++row;
        if (!row->name)
            status = sr_fail(error, SR_ERROR_USAGE, "%s has no parameter %s to be fixed", p->model->name, o->fixed[i]);
    }
    if (status == SR_OK && p->count == 0)
        status = sr_fail(error, SR_ERROR_USAGE, "%s: nothing is left to fit", p->model->name);
    if (status == SR_OK && p->model->load)
        status = p->model->load(p->pattern, arena, error);
    return status;
}

static void make_bsdf(const struct problem *p, const double *t, struct sr_bsdf *b)
{
    memcpy(b->data, p->pattern, SR_BSDF_SIZE);
    for (int i = 0; i < p->count; ++i)
        *member(b->data, &p->unknowns[i]) = (float)from_unbound(&p->unknowns[i], t[i]);
    b->model = p->model;
    if (b->model->ready)
        b->model->ready(b->data, &(struct sr_bsdf_at){p->options->lambda, p->options->seed});
}

/* ---- data ---- */

sr_status sr_fit_gather(struct sr_arena *arena, const struct sr_specimen *data, const struct sr_fit_options *o,
                        struct sr_fit_point **points, uint32_t *count, struct sr_error *error)
{
    static const uint32_t tries = 20;
    struct sr_specimen_at *at = sr_arena_alloc(arena, sizeof *at);
    *count = 0;
    *points = sr_arena_alloc(arena, o->points * sizeof **points);
    if (!*points || !at)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u points", (unsigned)o->points);
    sr_specimen_at(data, o->lambda, o->seed, at);
    struct sr_rng rng = sr_rng_seed(o->seed, 7);
    float cos_least = cosf(sr_radians((float)o->theta_max));
    for (uint64_t i = 0; i < (uint64_t)tries * o->points && *count < o->points; ++i) {
        float u[5];
        for (int k = 0; k < 5; ++k)
            u[k] = sr_rng_float(&rng);
        // even in theta, so that grazing directions get their share
        float theta = u[0] * sr_radians((float)o->theta_max), phi = 2 * SR_PI * u[1];
        sr_vec3 wo = {sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta)}, wi;
        struct sr_bsdf_sample s;
        if (i & 1)
            wi = sr_warp_cosine_hemisphere((sr_vec2){u[3], u[4]});
        else if (sr_bsdf_sample(&at->bsdf, wo, u[2], (sr_vec2){u[3], u[4]}, SR_RADIANCE, &s) &&
                 !(s.lobe & SR_LOBE_SPECULAR))
            wi = s.wi;
        else
            continue;
        if (wi.z < cos_least)
            continue;
        sr_spectrum f = sr_bsdf_f(&at->bsdf, wo, wi, SR_RADIANCE);
        if (sr_spectrum_is_black(f))
            continue;
        struct sr_fit_point *q = &(*points)[(*count)++];
        *q = (struct sr_fit_point){.wo = wo, .wi = wi};
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            q->data[k] = (double)f[k];
    }
    return *count ? SR_OK
                  : sr_fail(error, SR_ERROR_INPUT, "%s: there is no f above 0 within %g deg of the normal", data->title,
                            o->theta_max);
}

/* ---- least squares ---- */

static double in_metric(const struct problem *p, double g)
{
    return p->options->metric == SR_FIT_LINEAR ? g : p->options->metric == SR_FIT_LOG ? log(p->floor + g) : cbrt(g);
}

// MINPACK's: residuals r of all points for parameters t
static int residuals(void *self, int count, int n, const double *t, double *r, int flag)
{
    const struct problem *p = self;
    (void)count, (void)n, (void)flag;
    struct sr_bsdf b;
    make_bsdf(p, t, &b);
    for (uint32_t i = 0; i < p->point_count; ++i) {
        const struct sr_fit_point *q = &p->points[i];
        sr_spectrum f = sr_bsdf_f(&b, q->wo, q->wi, SR_RADIANCE);
        double cos_theta_i = (double)q->wi.z;
        for (int k = 0; k < p->options->lambda_count; ++k)
            *r++ = in_metric(p, (double)f[k] * cos_theta_i) - in_metric(p, q->data[k] * cos_theta_i);
    }
    return 0;
}

struct workspace {
    double *t, *best, *r, *jacobian, *diagonal, *qtf, *wa[3], *wa4;
    int *pivots;
};

static bool make_workspace(struct workspace *w, struct sr_arena *arena, size_t n, size_t m)
{
    double **vectors[] = {&w->t, &w->best, &w->diagonal, &w->qtf, &w->wa[0], &w->wa[1], &w->wa[2]};
    bool ok = true;
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; ++i)
        ok &= (*vectors[i] = sr_arena_alloc(arena, n * sizeof(double))) != NULL;
    ok &= (w->r = sr_arena_alloc(arena, m * sizeof(double))) != NULL;
    ok &= (w->wa4 = sr_arena_alloc(arena, m * sizeof(double))) != NULL;
    ok &= (w->jacobian = sr_arena_alloc(arena, n * m * sizeof(double))) != NULL;
    ok &= (w->pivots = sr_arena_alloc(arena, n * sizeof(int))) != NULL;
    return ok;
}

// from w->t to the minimum near it; the sum of squares there
static double descend(struct problem *p, struct workspace *w, int m, bool *has_converged)
{
    int evaluations;
    int info = lmdif(residuals, p, m, p->count, w->t, w->r, 1e-10, 1e-8, 0, EVALUATIONS_PER_PARAMETER * (p->count + 1),
                     1e-6, w->diagonal, 1, 10, 0, &evaluations, w->jacobian, m, w->pivots, w->qtf, w->wa[0], w->wa[1],
                     w->wa[2], w->wa4);
    *has_converged = info >= 1 && info <= 4;
    double norm = 0;
    for (int i = 0; i < m; ++i)
        norm += w->r[i] * w->r[i];
    return isfinite(norm) ? norm : INFINITY;
}

static void start_from(const struct problem *p, uint32_t start, struct sr_rng *rng, double *t)
{
    for (int i = 0; i < p->count; ++i) {
        const struct unknown *u = &p->unknowns[i];
        double given = to_unbound(u, (double)*member(p->pattern, u));
        t[i] = start == 0 ? given : asin(0.9 * (2 * (double)sr_rng_float(rng) - 1)) + TURN;
    }
}

/* ---- results ---- */

static const char *words_of(struct sr_arena *arena, const struct problem *p, const double *t,
                            const struct sr_specimen *given)
{
    enum { SIZE = 8192 };
    char *text = sr_arena_alloc(arena, SIZE);
    if (!text)
        return NULL;
    // what was given and stays, then what was found
    int n = snprintf(text, SIZE, "%s", p->model->name);
    char *copy = sr_arena_string(arena, given->title), *rest = copy;
    for (char *word; copy && (word = strtok_r(rest, " ", &rest));) {
        bool is_found = word == copy;
        for (int i = 0; i < p->count; ++i) {
            size_t length = strlen(p->unknowns[i].row->name);
            is_found |= strncmp(word, p->unknowns[i].row->name, length) == 0 && word[length] == '=';
        }
        if (!is_found && n < SIZE)
            n += snprintf(text + n, (size_t)(SIZE - n), " %s", word);
    }
    for (int i = 0; i < p->count && n < SIZE; ++i) {
        const struct unknown *u = &p->unknowns[i];
        double value = from_unbound(u, t[i]);
        if (u->lane <= 0)
            n += snprintf(text + n, (size_t)(SIZE - n), " %s=", u->row->name);
        if (u->lane >= 0 && p->options->lambda_count > 1 && n < SIZE)
            n += snprintf(text + n, (size_t)(SIZE - n), "%s%g:", u->lane ? "," : "",
                          (double)p->options->lambda[u->lane]);
        if (n < SIZE)
            n += snprintf(text + n, (size_t)(SIZE - n), "%.7g", value);
    }
    return text;
}

static void tell(struct problem *p, struct workspace *w, double sum, int m, struct sr_fit *fit)
{
    fit->degrees_of_freedom = m - p->count;
    bool is_singular = covar1(m, p->count, sum, w->jacobian, m, w->pivots, 1e-12, w->wa[0]) != 0;
    for (int i = 0; i < p->count; ++i) {
        const struct unknown *u = &p->unknowns[i];
        double t = w->best[i], variance = w->jacobian[(size_t)i * m + i];
        bool is_at_bound = fabs(cos(t)) < 2e-3 || is_singular;
        fit->parameters[i] = (struct sr_fit_parameter){
            .name = u->row->name,
            .unit = u->row->unit,
            .lambda = u->lane < 0 ? 0 : (double)p->options->lambda[u->lane],
            .value = from_unbound(u, t),
            .standard_uncertainty = is_at_bound ? NAN : fabs(slope(u, t)) * sqrt(variance),
            .is_at_bound = fabs(cos(t)) < 2e-3,
        };
    }
    fit->count = p->count;

    struct sr_bsdf b;
    make_bsdf(p, w->best, &b);
    double data2 = 0, metric2 = 0, miss2 = 0;
    for (uint32_t i = 0; i < p->point_count; ++i) {
        struct sr_fit_point *q = &p->points[i];
        sr_spectrum f = sr_bsdf_f(&b, q->wo, q->wi, SR_RADIANCE);
        double cosine = (double)q->wi.z;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            q->model[k] = (double)f[k];
        for (int k = 0; k < p->options->lambda_count; ++k) {
            data2 += q->data[k] * q->data[k] * cosine * cosine;
            miss2 += (q->model[k] - q->data[k]) * (q->model[k] - q->data[k]) * cosine * cosine;
            metric2 += in_metric(p, q->data[k] * cosine) * in_metric(p, q->data[k] * cosine);
        }
    }
    fit->rms = sqrt(sum / metric2);
    fit->rms_relative = sqrt(miss2 / data2);
    fit->points = p->points;
    fit->point_count = p->point_count;
    fit->model = p->model;
}

static double mean_of(const struct sr_fit_point *points, uint32_t count, int lambda_count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i)
        for (int k = 0; k < lambda_count; ++k)
            sum += points[i].data[k] * (double)points[i].wi.z;
    return sum / ((double)count * lambda_count);
}

sr_status sr_fit_points(struct sr_arena *arena, struct sr_fit_point *points, uint32_t count,
                        const struct sr_specimen *model, const struct sr_fit_options *options, struct sr_fit *fit,
                        struct sr_error *error)
{
    struct problem p = {.options = options, .points = points, .point_count = count};
    *fit = (struct sr_fit){0};
    if (begin(&p, arena, model, error) != SR_OK)
        return error->status;
    int m = (int)count * options->lambda_count;
    if (m < 4 * p.count)
        return sr_fail(error, SR_ERROR_INPUT, "%u pairs of directions are too few for %d parameters", (unsigned)count,
                       p.count);
    p.floor = 1e-3 * mean_of(points, count, options->lambda_count);
    struct workspace w;
    if (!make_workspace(&w, arena, (size_t)p.count, (size_t)m))
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %d residuals", m);

    double least = INFINITY;
    struct sr_rng rng = sr_rng_seed(options->seed, 8);
    for (uint32_t start = 0; start < (options->starts ? options->starts : 1); ++start) {
        bool has_converged;
        start_from(&p, start, &rng, w.t);
        double sum = descend(&p, &w, m, &has_converged);
        if (sum < least) {
            least = sum;
            memcpy(w.best, w.t, (size_t)p.count * sizeof(double));
        }
    }
    if (!(least < INFINITY))
        return sr_fail(error, SR_ERROR_CHECK, "%s: no start led to a finite model", p.model->name);
    memcpy(w.t, w.best, (size_t)p.count * sizeof(double));
    least = descend(&p, &w, m, &fit->has_converged); // once more from the best: its Jacobian
    memcpy(w.best, w.t, (size_t)p.count * sizeof(double));
    tell(&p, &w, least, m, fit);
    fit->words = words_of(arena, &p, w.best, model);
    return fit->words ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a fit");
}
