/* SPDX-License-Identifier: MIT */
/* Spectral distributions: a constant, an even table, a sigmoid, a sigmoid times a table, or a black body.
 *
 *     table       v_i + (v_{i+1} - v_i) (x - i),  x = (lambda - first) / step;  zero outside the table
 *     sigmoid     1/2 + x / (2 sqrt(1 + x^2)),    x = (c0 lambda + c1) lambda + c2
 *     black body  (x / x_m)^5 expm1(x_m) / expm1(x),  x = c2 / (lambda T),  x_m = 4.9651… where Planck's law is largest
 *
 * Values are scaled by what they mean: reflectance [1], or radiance in the unit of their source. */
#include "spectrum/data.h"

#define PLANCK_H 6.62607015e-34     // [J s]
#define LIGHT_C 299792458.0         // [m/s]
#define BOLTZMANN_K 1.380649e-23    // [J/K]
#define C2_NM_K 1.438776877503933e7 // h c / k [nm K]
#define PEAK 4.965114231744276      // solves x = 5 (1 - exp(-x)): Wien's law
#define PEAK_EXPM1 142.3249151279

// values i and i + 1 for each of the indices
static inline void neighbours(const float *values, sr_spectrum_int i, sr_spectrum *v0, sr_spectrum *v1)
{
#if SR_LAMBDA_COUNT == 8 && !defined(float) // eight loads of pairs, since compilers make sixteen
    typedef double pairs __attribute__((vector_size(32)));
    double pair[8];
    for (int k = 0; k < 8; ++k)
        __builtin_memcpy(&pair[k], &values[i[k]], sizeof pair[k]);
    sr_spectrum a = (sr_spectrum)(pairs){pair[0], pair[1], pair[4], pair[5]},
                b = (sr_spectrum)(pairs){pair[2], pair[3], pair[6], pair[7]};
    *v0 = __builtin_shufflevector(a, b, 0, 2, 8, 10, 4, 6, 12, 14);
    *v1 = __builtin_shufflevector(a, b, 1, 3, 9, 11, 5, 7, 13, 15);
#else
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
        (*v0)[k] = values[i[k]];
        (*v1)[k] = values[i[k] + 1];
    }
#endif
}

static sr_spectrum table_eval(const struct sr_table *table, sr_spectrum lambda)
{
    float last = (float)(table->count - 1);
    sr_spectrum x = (lambda - table->first) * (1 / table->step);
    sr_spectrum_int inside = (lambda >= table->first) & (x <= last + 1e-4f); // a last sample at lambda exactly counts
    x = sr_spectrum_select(x > 0.0f, x, SR_BLACK);
    sr_spectrum below = sr_spectrum_select(x < last - 1, x, SR_BLACK + (last - 1));
    sr_spectrum_int i = __builtin_convertvector(below, sr_spectrum_int);
    sr_spectrum v0, v1;
    neighbours(table->values, i, &v0, &v1);
    sr_spectrum t = x - __builtin_convertvector(i, sr_spectrum);
    t = sr_spectrum_select(t < 1.0f, t, SR_ONE);
    return sr_spectrum_select(inside, v0 + t * (v1 - v0), SR_BLACK);
}

sr_spectrum sr_sigmoid_eval(struct sr_sigmoid c, sr_spectrum lambda)
{
    sr_spectrum x = (c.c0 * lambda + c.c1) * lambda + c.c2;
    sr_spectrum root = 1.0f + x * x;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        root[i] = sqrtf(root[i]);
    return 0.5f + 0.5f * (x / root);
}

static sr_spectrum blackbody_eval(float T, sr_spectrum lambda)
{
    sr_spectrum x = (float)C2_NM_K / T / lambda, y = x * (float)(1 / PEAK), y2 = y * y;
    sr_spectrum expm1 = sr_spectrum_exp(x) - 1.0f;
    // small x: the series keeps the digits that the difference loses
    sr_spectrum series = x * (1.0f + x * (0.5f + x * (1.0f / 6 + x * (1.0f / 24))));
    expm1 = sr_spectrum_select(x < 0.1f, series, expm1);
    sr_spectrum value = y2 * y2 * y * (float)PEAK_EXPM1 / expm1;
    return sr_spectrum_select(x < 88.0f, value, SR_BLACK);
}

sr_spectrum sr_spd_eval(const struct sr_spd *s, sr_spectrum lambda)
{
    switch (s->kind) {
    case SR_SPD_NONE:
        break;
    case SR_SPD_CONSTANT:
        return SR_BLACK + s->scale;
    case SR_SPD_TABLE:
        return s->scale * table_eval(s->table, lambda);
    case SR_SPD_SIGMOID:
        return s->scale * sr_sigmoid_eval(s->sigmoid, lambda);
    case SR_SPD_ILLUMINANT:
        return s->scale * sr_sigmoid_eval(s->sigmoid, lambda) * table_eval(s->table, lambda);
    case SR_SPD_BLACKBODY:
        return s->scale * blackbody_eval(s->temperature, lambda);
    }
    return SR_BLACK;
}

void sr_wavelengths_know(struct sr_wavelengths *w, const struct sr_table *table)
{
    w->known = table;
    if (table)
        w->known_values = table_eval(table, w->lambda);
}

sr_spectrum sr_spd_along(const struct sr_spd *s, const struct sr_wavelengths *w)
{
    if (s->kind == SR_SPD_ILLUMINANT && SR_LIKELY(s->table == w->known))
        return s->scale * sr_sigmoid_eval(s->sigmoid, w->lambda) * w->known_values;
    return sr_spd_eval(s, w->lambda);
}

float sr_spd_at(const struct sr_spd *s, float lambda)
{
    return sr_spd_eval(s, SR_BLACK + lambda)[0];
}

static float sigmoid_max(struct sr_sigmoid c)
{
    // the sigmoid rises with its polynomial, which is largest at an end or at its vertex
    float vertex = c.c0 < 0 ? sr_clamp(-c.c1 / (2 * c.c0), SR_LAMBDA_MIN, SR_LAMBDA_MAX) : SR_LAMBDA_MIN;
    sr_spectrum lambda = SR_BLACK + vertex;
    lambda[0] = SR_LAMBDA_MIN;
    lambda[1] = SR_LAMBDA_MAX;
    return sr_spectrum_max(sr_sigmoid_eval(c, lambda));
}

static float table_max(const struct sr_spd *s)
{
    const struct sr_table *table = s->table;
    float max = sr_max(sr_spd_at(s, SR_LAMBDA_MIN), sr_spd_at(s, SR_LAMBDA_MAX));
    for (int32_t i = 0; i < table->count; ++i) {
        float lambda = table->first + (float)i * table->step;
        if (lambda >= SR_LAMBDA_MIN && lambda <= SR_LAMBDA_MAX)
            max = sr_max(max, s->scale * table->values[i]);
    }
    return max;
}

float sr_spd_max(const struct sr_spd *s)
{
    float max = 0;
    switch (s->kind) {
    case SR_SPD_NONE:
        return 0;
    case SR_SPD_CONSTANT:
        return s->scale;
    case SR_SPD_TABLE:
        return table_max(s);
    case SR_SPD_SIGMOID:
        return s->scale * sigmoid_max(s->sigmoid);
    case SR_SPD_BLACKBODY:
        return sr_spd_at(s, sr_clamp((float)(C2_NM_K / PEAK) / s->temperature, SR_LAMBDA_MIN, SR_LAMBDA_MAX));
    case SR_SPD_ILLUMINANT:
        for (float lambda = SR_LAMBDA_MIN; lambda <= SR_LAMBDA_MAX; ++lambda)
            max = sr_max(max, sr_spd_at(s, lambda));
        return max;
    }
    return 0;
}

struct sr_spd sr_spd_constant(float value)
{
    return (struct sr_spd){.kind = SR_SPD_CONSTANT, .scale = value};
}

struct sr_spd sr_spd_blackbody(float T)
{
    return (struct sr_spd){.kind = SR_SPD_BLACKBODY, .scale = 1, .temperature = T};
}

double sr_planck(double lambda, double T)
{
    double l = lambda * 1e-9; // [m]
    double x = PLANCK_H * LIGHT_C / (l * BOLTZMANN_K * T);
    return 2e-9 * PLANCK_H * LIGHT_C * LIGHT_C / (l * l * l * l * l * expm1(x));
}
