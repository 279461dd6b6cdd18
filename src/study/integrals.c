/* SPDX-License-Identifier: MIT */
/* Definite integrals that one can do by hand, to see what an estimator makes of them.
 *
 *     I = INTEGRAL f dx,        I_n = 1/n SUM f(x_i) / p(x_i),    x_i drawn with density p
 *
 * Smooth, peaked, with a jump and with a pole: scrambled nets fall as n^-3/2, n^-3/2 late, n^-3/4, and between n^-1/2
 * and n^-3/2 (A. Owen 1997; Z. He & X. Wang 2015 for jumps); independent numbers as n^-1/2 always, if the variance is
 * finite. */
#include "study/study.h"

#include <string.h>
#include <time.h>

static const double pi = 3.14159265358979323846, width = 0.03;

static double smooth1_uniform(double u, double v)
{
    (void)v;
    return exp(u);
}
static double smooth1_linear(double u, double v) // p = (1 + x) / 1.5
{
    (void)v;
    double x = sqrt(1 + 3 * u) - 1;
    return exp(x) * 1.5 / (1 + x);
}

static double peak(double x)
{
    double t = (x - 0.5) / width;
    return exp(-0.5 * t * t);
}
static double peak_uniform(double u, double v)
{
    (void)v;
    return peak(u);
}
static double peak_cauchy(double u, double v) // p = a / (2 atan(1 / (2 a)) ((x - 1/2)^2 + a^2))
{
    (void)v;
    double a = 1.5 * width, half = atan(0.5 / a), t = a * tan((2 * u - 1) * half);
    return peak(0.5 + t) * 2 * half * (t * t + a * a) / a;
}

static double smooth2_uniform(double u, double v)
{
    return cos(0.5 * pi * u) * exp(v);
}
static double smooth2_linear(double u, double v) // p = 2 (1 - x): towards where the cosine is large
{
    double rest = sqrt(1 - u); // 1 - x
    return cos(0.5 * pi * (1 - rest)) * exp(v) / (2 * rest);
}

static double disk_uniform(double u, double v)
{
    return u * u + v * v < 1;
}

static double pole_uniform(double u, double v)
{
    return 1 / sqrt(sqrt(u * v));
}
static double pole_third(double u, double v) // p = 4/9 (x y)^(-1/3)
{
    return 2.25 * pow(u * v, 0.125);
}

const struct sr_study_integral sr_study_integrals[] = {
    {"smooth-1d",
     "e^x over [0, 1]",
     1,
     1.71828182845904523536,
     {{"uniform", "1", smooth1_uniform}, {"importance", "(1 + x) / 1.5", smooth1_linear}}},
    {"peaked-1d",
     "exp(-((x - 0.5) / 0.03)^2 / 2) over [0, 1]",
     1,
     0.0751988482389300, // sigma sqrt(2 pi) erf(0.5 / (sigma sqrt 2))
     {{"uniform", "1", peak_uniform}, {"importance", "Cauchy, half width 0.045", peak_cauchy}}},
    {"smooth-2d",
     "cos(pi x / 2) e^y over [0, 1]^2",
     2,
     1.09389217923098, // 2 (e - 1) / pi
     {{"uniform", "1", smooth2_uniform}, {"importance", "2 (1 - x)", smooth2_linear}}},
    {"disk-2d", "1 where x^2 + y^2 < 1, over [0, 1]^2", 2, 0.78539816339744830962, {{"uniform", "1", disk_uniform}}},
    {"pole-2d",
     "(x y)^(-1/4) over [0, 1]^2",
     2,
     16.0 / 9,
     {{"uniform", "1", pole_uniform}, {"importance", "4/9 (x y)^(-1/3)", pole_third}}},
    {.name = NULL},
};

const struct sr_study_integral *sr_study_integral_find(const char *name)
{
    for (const struct sr_study_integral *i = sr_study_integrals; i->name; ++i)
        if (strcmp(i->name, name) == 0)
            return i;
    return NULL;
}

double sr_study_error(const struct sr_study_integral *integral, int strategy, enum sr_sampler_kind sampler,
                      uint32_t seed, uint32_t n, uint32_t seeds, double *time_s)
{
    const double half = 0x1p-25; // numbers are the middles of cells of 2^-24, never 0
    double squares = 0;
    clock_t start = clock();
    for (uint32_t s = 0; s < seeds; ++s) {
        double sum = 0;
        for (uint32_t i = 0; i < n; ++i) {
            struct sr_sampler numbers = sr_sampler_start(sampler, seed, n, 0, s, i);
            sr_u4 u = sr_sample4(&numbers, 0);
            sum += integral->strategies[strategy].estimate((double)u[0] + half, (double)u[1] + half);
        }
        double d = sum / n - integral->value;
        squares += d * d;
    }
    *time_s = (double)(clock() - start) / CLOCKS_PER_SEC / seeds;
    return sqrt(squares / seeds);
}
