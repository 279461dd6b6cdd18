/* SPDX-License-Identifier: MIT */
/* Values with standard uncertainty and degrees of freedom.
 *
 *     u(f)^2 = SUM (df/dx_i)^2 u_i^2,    nu = u^4 / SUM ((df/dx_i) u_i)^4 / nu_i
 *
 * GUM, JCGM 100:2008, 5.1.2 and G.4.1. Limits: x_i independent, and f nearly linear over their uncertainty: a ratio
 * whose divisor is known to worse than some percent needs a jackknife over replicates. */
#include "quantity/quantity.h"

struct sr_quantity sr_quantity_exact(double value, struct sr_unit unit)
{
    return (struct sr_quantity){.value = value, .degrees = INFINITY, .unit = unit};
}

struct sr_quantity sr_quantity_of_tally(const struct sr_tally *replicates, struct sr_unit unit)
{
    return (struct sr_quantity){
        .value = replicates->mean,
        .u = replicates->n > 1 ? sr_tally_standard_error(replicates) : NAN,
        .degrees = replicates->n > 1 ? (double)(replicates->n - 1) : 0,
        .unit = unit,
    };
}

struct sr_quantity sr_quantity_bounded(double largest, double samples, struct sr_unit unit)
{
    return (struct sr_quantity){.u = NAN, .upper = samples > 0 ? 3 * largest / samples : 0, .unit = unit};
}

struct sr_quantity sr_quantity_jackknife(const double *rows, uint32_t replicates, uint32_t columns,
                                         double (*f)(const double *means), struct sr_unit unit)
{
    double sum[8] = {0}, means[8], R = replicates;
    struct sr_tally left_out = {0};
    for (uint32_t r = 0; r < replicates; ++r)
        for (uint32_t c = 0; c < columns; ++c)
            sum[c] += rows[(size_t)r * columns + c];
    for (uint32_t r = 0; r < replicates; ++r) {
        for (uint32_t c = 0; c < columns; ++c)
            means[c] = (sum[c] - rows[(size_t)r * columns + c]) / (R - 1);
        sr_tally_add(&left_out, f(means));
    }
    for (uint32_t c = 0; c < columns; ++c)
        means[c] = sum[c] / R;
    // u^2 = (R - 1)/R SUM (left out - their mean)^2
    return (struct sr_quantity){.value = R * f(means) - (R - 1) * left_out.mean,
                                .u = sqrt(left_out.m2 * (R - 1) / R),
                                .degrees = R - 1,
                                .unit = unit};
}

double sr_quantity_expanded(const struct sr_quantity *q, double level)
{
    double p = 0.5 + level / 2;
    if (!(level >= 0 && level <= 1))
        return NAN;
    return (isinf(q->degrees) ? sr_normal_quantile(p) : sr_student_quantile(p, q->degrees)) * q->u;
}

double sr_effective_degrees(const double *u, const double *degrees, size_t count)
{
    double square = 0, sum = 0;
    for (size_t i = 0; i < count; ++i) {
        double v = u[i] * u[i];
        square += v;
        sum += v > 0 ? v * v / degrees[i] : 0;
    }
    return sum > 0 ? square * square / sum : INFINITY;
}

/* A bound counts as an uncertainty as wide as it is: on the safe side. */
static double part(const struct sr_quantity *q)
{
    return q->upper > 0 ? q->upper : q->u;
}

/* What two parts of the uncertainty make together. */
static void combine(struct sr_quantity *out, double u_a, const struct sr_quantity *a, double u_b,
                    const struct sr_quantity *b)
{
    out->u = sqrt(u_a * u_a + u_b * u_b);
    out->degrees =
        sr_effective_degrees((double[]){u_a, u_b},
                             (double[]){a->upper > 0 ? INFINITY : a->degrees, b->upper > 0 ? INFINITY : b->degrees}, 2);
}

static sr_status add(const struct sr_quantity *a, double sign, const struct sr_quantity *b, struct sr_quantity *out,
                     struct sr_error *error)
{
    *out = (struct sr_quantity){.value = NAN, .u = NAN, .unit = a->unit};
    if (!sr_unit_equal(a->unit, b->unit)) {
        char left[96], right[96];
        return sr_fail(error, SR_ERROR_USAGE, "%s and %s cannot be added or subtracted",
                       sr_unit_text(a->unit, left, sizeof left), sr_unit_text(b->unit, right, sizeof right));
    }
    out->value = a->value + sign * b->value;
    combine(out, part(a), a, part(b), b);
    return SR_OK;
}

sr_status sr_quantity_add(const struct sr_quantity *a, const struct sr_quantity *b, struct sr_quantity *out,
                          struct sr_error *error)
{
    return add(a, 1, b, out, error);
}

sr_status sr_quantity_subtract(const struct sr_quantity *a, const struct sr_quantity *b, struct sr_quantity *out,
                               struct sr_error *error)
{
    return add(a, -1, b, out, error);
}

struct sr_quantity sr_quantity_scale(const struct sr_quantity *a, double factor)
{
    struct sr_quantity out = *a;
    out.value *= factor;
    out.u *= fabs(factor);
    out.upper *= fabs(factor);
    return out;
}

static struct sr_unit multiply_units(struct sr_unit a, struct sr_unit b, int sign)
{
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
        a.flux[i] = (int8_t)(a.flux[i] + sign * b.flux[i]);
    a.second = (int8_t)(a.second + sign * b.second);
    a.metre = (int8_t)(a.metre + sign * b.metre);
    a.steradian = (int8_t)(a.steradian + sign * b.steradian);
    a.nanometre = (int8_t)(a.nanometre + sign * b.nanometre);
    return a;
}

struct sr_quantity sr_quantity_product(const struct sr_quantity *a, const struct sr_quantity *b)
{
    struct sr_quantity out = {.value = a->value * b->value, .unit = multiply_units(a->unit, b->unit, 1)};
    combine(&out, b->value * part(a), a, a->value * part(b), b);
    return out;
}

struct sr_quantity sr_quantity_ratio(const struct sr_quantity *a, const struct sr_quantity *b)
{
    struct sr_quantity out = {.value = a->value / b->value, .unit = multiply_units(a->unit, b->unit, -1)};
    combine(&out, part(a) / b->value, a, out.value / b->value * part(b), b);
    return out;
}

sr_status sr_quantity_times(const struct sr_quantity *a, double size, struct sr_unit of_size, struct sr_unit expected,
                            struct sr_quantity *out, struct sr_error *error)
{
    *out = sr_quantity_scale(a, size);
    out->unit = multiply_units(a->unit, of_size, 1);
    if (sr_unit_equal(out->unit, expected))
        return SR_OK;
    char from[96], by[96], to[96];
    *out = (struct sr_quantity){.value = NAN, .u = NAN, .unit = expected};
    return sr_fail(error, SR_ERROR_USAGE, "%s times %s is not %s", sr_unit_text(a->unit, from, sizeof from),
                   sr_unit_text(of_size, by, sizeof by), sr_unit_text(expected, to, sizeof to));
}
