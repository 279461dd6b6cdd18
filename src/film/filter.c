/* SPDX-License-Identifier: MIT */
/* Pixel filters by importance sampling: positions are drawn in proportion to |f|, so a sample's weight is one number
 * but for its sign, and a sample belongs to one pixel.
 *
 *     value = integral f(p) L(p) dp / integral f(p) dp = E[ sign(f) L ] integral|f| / integral f
 *
 * Ernst, Stamminger & Greiner 2006. Gaussian and Mitchell as in pbrt: a product of one function along each axis. */
#include "film/film.h"

#include <string.h>

/* ---- the functions ---- */

struct box {
    float xradius, yradius; // [pixel]
};
struct triangle {
    float xradius, yradius; // [pixel]
};
struct gaussian {
    float xradius, yradius; // [pixel]
    float sigma;            // [pixel]
};
struct mitchell {
    float xradius, yradius; // [pixel]
    float B, C;             // [1]
};
struct sinc {
    float xradius, yradius; // [pixel]
    float tau;              // [1]
};

#define RADIUS(type, initial)                                                                                          \
    {SR_PARAM_FLOAT, "xradius", "pixel", 1e-3, 1e3, initial, offsetof(struct type, xradius), "half width"},            \
    {                                                                                                                  \
        SR_PARAM_FLOAT, "yradius", "pixel", 1e-3, 1e3, initial, offsetof(struct type, yradius), "half height"          \
    }

static const struct sr_param box_params[] = {RADIUS(box, 0.5), {.name = NULL}};
static const struct sr_param triangle_params[] = {RADIUS(triangle, 2), {.name = NULL}};
static const struct sr_param gaussian_params[] = {
    RADIUS(gaussian, 1.5),
    {SR_PARAM_FLOAT, "sigma", "pixel", 1e-3, 1e3, 0.5, offsetof(struct gaussian, sigma), "standard deviation"},
    {.name = NULL},
};
static const struct sr_param mitchell_params[] = {
    RADIUS(mitchell, 2),
    {SR_PARAM_FLOAT, "B", "1", -10, 10, 1.0 / 3, offsetof(struct mitchell, B), "Mitchell & Netravali 1988"},
    {SR_PARAM_FLOAT, "C", "1", -10, 10, 1.0 / 3, offsetof(struct mitchell, C), "Mitchell & Netravali 1988"},
    {.name = NULL},
};
static const struct sr_param sinc_params[] = {
    RADIUS(sinc, 4),
    {SR_PARAM_FLOAT, "tau", "1", 1e-3, 1e3, 3, offsetof(struct sinc, tau), "cycles before the window closes"},
    {.name = NULL},
};

static sr_vec2 radius_of(const void *self) // every filter's struct begins with its two radii
{
    const struct box *b = self;
    return (sr_vec2){b->xradius, b->yradius};
}

static float box_value(const void *self, sr_vec2 p)
{
    (void)self, (void)p;
    return 1;
}

static float triangle_value(const void *self, sr_vec2 p)
{
    const struct triangle *f = self;
    return sr_max(0, f->xradius - fabsf(p.x)) * sr_max(0, f->yradius - fabsf(p.y));
}

/* shifted so that it ends at zero at the radius */
static float gaussian_value(const void *self, sr_vec2 p)
{
    const struct gaussian *f = self;
    float s = -0.5f / sr_sqr(f->sigma);
    float x = expf(s * sr_sqr(p.x)) - expf(s * sr_sqr(f->xradius)),
          y = expf(s * sr_sqr(p.y)) - expf(s * sr_sqr(f->yradius));
    return sr_max(0, x) * sr_max(0, y);
}

static float mitchell_1(float x, float B, float C) // on [-2, 2]
{
    x = fabsf(x);
    if (x <= 1)
        return ((12 - 9 * B - 6 * C) * x * x * x + (-18 + 12 * B + 6 * C) * x * x + (6 - 2 * B)) / 6;
    if (x <= 2)
        return ((-B - 6 * C) * x * x * x + (6 * B + 30 * C) * x * x + (-12 * B - 48 * C) * x + (8 * B + 24 * C)) / 6;
    return 0;
}

static float mitchell_value(const void *self, sr_vec2 p)
{
    const struct mitchell *f = self;
    return mitchell_1(2 * p.x / f->xradius, f->B, f->C) * mitchell_1(2 * p.y / f->yradius, f->B, f->C);
}

static float sinc_1(float x)
{
    x = SR_PI * fabsf(x);
    return x < 1e-3f ? 1 - x * x / 6 : sinf(x) / x;
}

static float sinc_value(const void *self, sr_vec2 p)
{
    const struct sinc *f = self;
    if (fabsf(p.x) > f->xradius || fabsf(p.y) > f->yradius)
        return 0;
    return sinc_1(p.x) * sinc_1(p.x / f->tau) * sinc_1(p.y) * sinc_1(p.y / f->tau);
}

static const struct sr_filter_model box_model = {"box", box_params, sizeof(struct box), box_value, radius_of};
static const struct sr_filter_model triangle_model = {"triangle", triangle_params, sizeof(struct triangle),
                                                      triangle_value, radius_of};
static const struct sr_filter_model gaussian_model = {"gaussian", gaussian_params, sizeof(struct gaussian),
                                                      gaussian_value, radius_of};
static const struct sr_filter_model mitchell_model = {"mitchell", mitchell_params, sizeof(struct mitchell),
                                                      mitchell_value, radius_of};
static const struct sr_filter_model sinc_model = {"sinc", sinc_params, sizeof(struct sinc), sinc_value, radius_of};
const struct sr_filter_model *const sr_filter_models[] = {&box_model,  &gaussian_model, &mitchell_model,
                                                          &sinc_model, &triangle_model, NULL};

const struct sr_filter_model *sr_filter_model_find(const char *name)
{
    for (int i = 0; sr_filter_models[i]; ++i)
        if (strcmp(sr_filter_models[i]->name, name) == 0)
            return sr_filter_models[i];
    return NULL;
}

/* ---- drawing positions ----
 *
 * Every filter is a product of one function along x and one along y. Each axis has a table of the positions that divide
 * the integral of |f| into equal shares, linear between them: a position costs one look-up, and the map is monotone, so
 * that numbers that are well spread stay so. Within a share (1/2048) the density is even instead of following f. Where
 * f changes its sign is remembered by position. */

enum { STEPS = 8 }; // of the quadrature, for each share

static double along(const struct sr_filter *f, int axis, sr_vec2 peak, double at)
{
    sr_vec2 p = peak;
    *(axis == 0 ? &p.x : &p.y) = (float)at;
    return (double)f->model->value(f->self, p);
}

// where f is largest in magnitude: neither factor is 0 there
static sr_vec2 find_peak(const struct sr_filter *f)
{
    sr_vec2 peak = {0, 0};
    enum { GRID = 33 }; // odd: has the middle
    for (int j = 0; j < GRID; ++j)
        for (int i = 0; i < GRID; ++i) {
            sr_vec2 p = {((float)i / (GRID - 1) * 2 - 1) * f->radius.x, ((float)j / (GRID - 1) * 2 - 1) * f->radius.y};
            if (fabsf(f->model->value(f->self, p)) > 1.001f * fabsf(f->model->value(f->self, peak)))
                peak = p;
        }
    return peak;
}

/* false: too many changes of sign, or no integral. *mean_sign: expectation of the sign of what is drawn. */
static bool divide_axis(struct sr_filter_axis *a, const struct sr_filter *f, int axis, sr_vec2 peak, double *mean_sign,
                        double *integral)
{
    enum { CELLS = SR_FILTER_SHARES * STEPS };
    double radius = (double)(axis == 0 ? f->radius.x : f->radius.y), width = 2 * radius / CELLS, all = 0;
    *integral = 0;
    for (int i = 0; i < CELLS; ++i) {
        double value = along(f, axis, peak, -radius + (i + 0.5) * width);
        all += fabs(value);
        *integral += value * width;
    }
    if (!(all > 0) || !isfinite(all))
        return false;
    double sum = 0;
    int next = 0;
    for (int i = 0; i < CELLS; ++i) {
        double value = along(f, axis, peak, -radius + (i + 0.5) * width), cell = fabs(value);
        bool is_negative = value < 0;
        if (i == 0)
            a->begins_negative = is_negative;
        else if (value != 0 && is_negative != (a->begins_negative ^ (a->sign_changes & 1))) {
            if (a->sign_changes == SR_FILTER_SIGN_CHANGES)
                return false;
            a->change[a->sign_changes++] = (float)(-radius + i * width);
        }
        for (; next < SR_FILTER_SHARES && cell > 0 && sum + cell >= all * next / SR_FILTER_SHARES; ++next)
            a->position[next] = (float)(-radius + (i + fmax(0, (all * next / SR_FILTER_SHARES - sum) / cell)) * width);
        sum += cell;
    }
    double end = radius; // nothing is drawn where f is 0
    for (int i = CELLS; i-- > 0 && along(f, axis, peak, -radius + (i + 0.5) * width) == 0;)
        end = -radius + i * width;
    for (; next <= SR_FILTER_SHARES; ++next)
        a->position[next] = (float)end;

    *mean_sign = 0;
    for (int i = 0; i < SR_FILTER_SHARES; ++i) { // of each share, the part of its width that is positive
        double lo = (double)a->position[i], hi = (double)a->position[i + 1], at = lo,
               sign = a->begins_negative ? -1 : 1, signed_width = 0;
        for (uint32_t k = 0; k < a->sign_changes; ++k, sign = -sign) {
            double change = fmin(fmax((double)a->change[k], lo), hi);
            signed_width += sign * (change - at);
            at = change;
        }
        signed_width += sign * (hi - at);
        *mean_sign += (hi > lo ? signed_width / (hi - lo) : 1) / SR_FILTER_SHARES;
    }
    return true;
}

sr_status sr_filter_prepare(struct sr_arena *arena, const struct sr_filter_model *model, const void *self,
                            struct sr_filter *out, struct sr_error *error)
{
    *out = (struct sr_filter){.model = model, .self = self, .radius = model->radius(self)};
    if (model == &box_model) { // uniform: no table
        out->inverse_integral = 1 / (4 * (double)out->radius.x * (double)out->radius.y);
        return SR_OK;
    }
    struct sr_filter_axis *axes = sr_arena_alloc(arena, 2 * sizeof *axes);
    if (!axes)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the pixel filter");
    sr_vec2 peak = find_peak(out);
    double signs[2], integrals[2];
    for (int i = 0; i < 2; ++i)
        if (!divide_axis(&axes[i], out, i, peak, &signs[i], &integrals[i]))
            return sr_fail(
                error, SR_ERROR_INPUT,
                "PixelFilter \"%s\": it is zero, not finite, or changes its sign more than %d times along an axis",
                model->name, SR_FILTER_SIGN_CHANGES);
    double mean_sign = signs[0] * signs[1];
    mean_sign = model->value(self, peak) < 0 ? -mean_sign : mean_sign; // f = f(x, peak) f(peak, y) / f(peak, peak)
    if (!(mean_sign > 1e-6))
        return sr_fail(error, SR_ERROR_INPUT,
                       "PixelFilter \"%s\": its integral is not positive, so it cannot be normalised", model->name);
    out->weight = (float)((model->value(self, peak) < 0 ? -1 : 1) / mean_sign);
    out->inverse_integral = (double)model->value(self, peak) / (integrals[0] * integrals[1]);
    out->axes[0] = &axes[0];
    out->axes[1] = memcmp(&axes[0], &axes[1], sizeof axes[0]) == 0 ? &axes[0] : &axes[1];
    return SR_OK;
}

static inline float draw(const struct sr_filter_axis *a, float u, float *weight)
{
    float at = u * SR_FILTER_SHARES;
    int i = (int)at; // u < 1
    float x = sr_lerp(at - (float)i, a->position[i], a->position[i + 1]);
    if (SR_UNLIKELY(a->sign_changes | a->begins_negative)) {
        bool is_negative = a->begins_negative;
        for (uint32_t k = 0; k < a->sign_changes; ++k)
            is_negative ^= x >= a->change[k];
        *weight = is_negative ? -*weight : *weight;
    }
    return x;
}

sr_vec2 sr_filter_sample(const struct sr_filter *f, sr_vec2 u, float *weight)
{
    if (SR_UNLIKELY(!f->axes[0])) {
        *weight = 1;
        return (sr_vec2){sr_lerp(u.x, -f->radius.x, f->radius.x), sr_lerp(u.y, -f->radius.y, f->radius.y)};
    }
    *weight = f->weight;
    float x = draw(f->axes[0], u.x, weight);
    return (sr_vec2){x, draw(f->axes[1], u.y, weight)};
}
