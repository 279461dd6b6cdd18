/* SPDX-License-Identifier: MIT */
/* Pixel filters by importance sampling: positions are drawn in proportion to |f|, so a sample's weight is one number but
 * for its sign, and a sample belongs to one pixel.
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
    float x = expf(s * sr_sqr(p.x)) - expf(s * sr_sqr(f->xradius)), y = expf(s * sr_sqr(p.y)) - expf(s * sr_sqr(f->yradius));
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
static const struct sr_filter_model triangle_model = {"triangle", triangle_params, sizeof(struct triangle), triangle_value, radius_of};
static const struct sr_filter_model gaussian_model = {"gaussian", gaussian_params, sizeof(struct gaussian), gaussian_value, radius_of};
static const struct sr_filter_model mitchell_model = {"mitchell", mitchell_params, sizeof(struct mitchell), mitchell_value, radius_of};
static const struct sr_filter_model sinc_model = {"sinc", sinc_params, sizeof(struct sinc), sinc_value, radius_of};
const struct sr_filter_model *const sr_filter_models[] = {&box_model, &gaussian_model, &mitchell_model, &sinc_model, &triangle_model, NULL};

const struct sr_filter_model *sr_filter_model_find(const char *name)
{
    for (int i = 0; sr_filter_models[i]; ++i)
        if (strcmp(sr_filter_models[i]->name, name) == 0)
            return sr_filter_models[i];
    return NULL;
}

/* ---- drawing positions ---- */

enum { CELLS_PER_PIXEL = 32, MAX_CELLS = 512 };

static uint32_t cells(float radius)
{
    float n = ceilf(2 * radius * CELLS_PER_PIXEL);
    return (uint32_t)sr_clamp(n, 8, MAX_CELLS);
}

sr_status sr_filter_prepare(struct sr_arena *arena, const struct sr_filter_model *model, const void *self, struct sr_filter *out, struct sr_error *error)
{
    *out = (struct sr_filter){.model = model, .self = self, .radius = model->radius(self)};
    if (model == &box_model) // uniform: no table
        return SR_OK;
    out->nx = cells(out->radius.x);
    out->ny = cells(out->radius.y);
    size_t n = (size_t)out->nx * out->ny;
    float *magnitude = sr_arena_alloc(arena, n * sizeof *magnitude), *sign = sr_arena_alloc(arena, n * sizeof *sign);
    struct sr_piecewise2 *table = sr_arena_alloc(arena, sizeof *table);
    if (!magnitude || !sign || !table)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the pixel filter");
    double sum = 0, sum_magnitude = 0;
    for (uint32_t j = 0; j < out->ny; ++j)
        for (uint32_t i = 0; i < out->nx; ++i) {
            sr_vec2 p = {sr_lerp(((float)i + 0.5f) / (float)out->nx, -out->radius.x, out->radius.x),
                         sr_lerp(((float)j + 0.5f) / (float)out->ny, -out->radius.y, out->radius.y)};
            float f = model->value(self, p);
            magnitude[j * out->nx + i] = fabsf(f);
            sign[j * out->nx + i] = f < 0 ? -1 : 1;
            sum += (double)f;
            sum_magnitude += fabs((double)f);
        }
    if (!(sum > 0))
        return sr_fail(error, SR_ERROR_INPUT, "PixelFilter \"%s\": its integral is not positive, so it cannot be normalised", model->name);
    for (size_t i = 0; i < n; ++i)
        sign[i] *= (float)(sum_magnitude / sum);
    if (!sr_piecewise2_build(arena, magnitude, out->nx, out->ny, table))
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the pixel filter");
    out->table = table;
    out->sign_weights = sign;
    return SR_OK;
}

sr_vec2 sr_filter_sample(const struct sr_filter *f, sr_vec2 u, float *weight)
{
    sr_vec2 p = u;
    *weight = 1;
    if (f->table) {
        float pdf;
        p = sr_piecewise2_sample(f->table, u, &pdf);
        uint32_t i = (uint32_t)(p.x * (float)f->nx), j = (uint32_t)(p.y * (float)f->ny);
        i = i < f->nx ? i : f->nx - 1;
        j = j < f->ny ? j : f->ny - 1;
        *weight = f->sign_weights[j * f->nx + i];
    }
    return (sr_vec2){sr_lerp(p.x, -f->radius.x, f->radius.x), sr_lerp(p.y, -f->radius.y, f->radius.y)};
}
