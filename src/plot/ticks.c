/* SPDX-License-Identifier: MIT */
/* Where an axis has ticks, and what stands beside them.
 *
 * Linear axes step by 1, 2 or 5 times a power of ten, whichever gives the count nearest the wanted one; degrees by
 * divisors of 90. Logarithmic axes have a tick at each power of ten, or each n-th where there are many, and at 2 and 5
 * times it where there are few. */
#include "plot/private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double nice_step(double span, int wanted, bool is_angle)
{
    static const double angles[] = {1, 2, 5, 10, 15, 30, 45, 90, 180};
    double raw = span / wanted, best = 0, distance = INFINITY;
    if (is_angle && span >= 8) {
        for (size_t i = 0; i < sizeof angles / sizeof angles[0]; ++i)
            if (fabs(log(angles[i] / raw)) < distance) {
                distance = fabs(log(angles[i] / raw));
                best = angles[i];
            }
        return best;
    }
    double power = pow(10, floor(log10(raw)));
    for (int i = 0; i < 4; ++i) {
        double step = power * (const double[]){1, 2, 5, 10}[i];
        if (fabs(log(step / raw)) < distance) {
            distance = fabs(log(step / raw));
            best = step;
        }
    }
    return best;
}

/* A true minus sign, as wide as a figure. */
static void print_number(char *out, size_t size, double value, int decimals)
{
    snprintf(out, size, "%s%.*f", value < 0 ? "−" : "", decimals, fabs(value));
}

static void linear_ticks(const struct sr_plot_axis *axis, double lo, double hi, int wanted, struct sr_plot_ticks *t)
{
    bool is_angle = axis->unit && strcmp(axis->unit, "°") == 0;
    double span = hi - lo, step = axis->step > 0 ? axis->step : nice_step(span, wanted, is_angle);
    while (span / step > SR_PLOT_TICKS - 2)
        step *= 2;
    double largest = fmax(fabs(lo), fabs(hi));
    int magnitude = (int)floor(log10(largest) + 1e-9);
    t->exponent = magnitude >= 5 || magnitude <= -4 ? magnitude : 0;
    double unit = pow(10, t->exponent);
    int decimals = 0;
    while (decimals < 9 && fabs(step / unit * pow(10, decimals) - round(step / unit * pow(10, decimals))) > 1e-6)
        ++decimals;
    int parts = is_angle ? 3 : 5;
    double first = ceil((lo - 1e-9 * span) / step);
    for (int i = 0; i < SR_PLOT_TICKS && (first + i) * step <= hi + 1e-9 * span; ++i) {
        double value = (first + i) * step;
        t->at[t->count] = value;
        print_number(t->label[t->count++], sizeof t->label[0], value / unit, decimals);
    }
    for (double k = ceil((lo - 1e-9 * span) / step * parts); k * step / parts <= hi + 1e-9 * span; ++k)
        if (fmod(fabs(k), parts) > 0.5 && t->minor_count < 4 * SR_PLOT_TICKS)
            t->minor[t->minor_count++] = k * step / parts;
}

static void add_logarithmic(struct sr_plot_ticks *t, double mantissa, int power)
{
    if (t->count >= SR_PLOT_TICKS)
        return;
    char *label = t->label[t->count];
    t->at[t->count++] = mantissa * pow(10, power);
    if (power >= -2 && power <= 3)
        print_number(label, sizeof t->label[0], mantissa * pow(10, power), power < 0 ? -power : 0);
    else if (mantissa == 1)
        snprintf(label, sizeof t->label[0], "10^{%s%d}", power < 0 ? "−" : "", abs(power));
    else
        snprintf(label, sizeof t->label[0], "%g·10^{%s%d}", mantissa, power < 0 ? "−" : "", abs(power));
}

static void logarithmic_ticks(double lo, double hi, int wanted, struct sr_plot_ticks *t)
{
    double from = log10(lo), to = log10(hi), tolerance = 1e-9 * (to - from);
    int stride = (int)ceil((to - from) / (wanted > 1 ? wanted : 1) - 1e-9);
    stride = stride < 1 ? 1 : stride;
    bool is_short = to - from < 2.5;
    for (int power = (int)floor(from); power <= (int)ceil(to); ++power)
        for (int mantissa = 1; mantissa < 10; ++mantissa) {
            double at = power + log10(mantissa);
            if (at < from - tolerance || at > to + tolerance)
                continue;
            bool is_major = mantissa == 1 ? ((power % stride) + stride) % stride == 0
                                          : is_short && (mantissa == 2 || mantissa == 5);
            if (is_major)
                add_logarithmic(t, mantissa, power);
            else if (t->minor_count < 4 * SR_PLOT_TICKS && (stride == 1 || mantissa == 1))
                t->minor[t->minor_count++] = mantissa * pow(10, power);
        }
}

void sr_plot_ticks(const struct sr_plot_axis *axis, int wanted, struct sr_plot_ticks *ticks)
{
    *ticks = (struct sr_plot_ticks){0};
    double lo = fmin(axis->from, axis->to), hi = fmax(axis->from, axis->to);
    if (!isfinite(lo) || !isfinite(hi) || !(hi > lo) || (axis->is_log && !(lo > 0)))
        return;
    if (axis->is_log)
        logarithmic_ticks(lo, hi, wanted, ticks);
    else
        linear_ticks(axis, lo, hi, wanted < 2 ? 2 : wanted, ticks);
}

/* ---- from the data to an axis ---- */

void sr_plot_range_add(struct plot_range *range, double value, bool is_log)
{
    if (!isfinite(value) || (is_log && !(value > 0)))
        return;
    range->lo = range->some ? fmin(range->lo, value) : value;
    range->hi = range->some ? fmax(range->hi, value) : value;
    range->some = true;
}

bool sr_plot_axis_settle(struct sr_plot_axis *axis, const struct plot_range *range, bool is_tight)
{
    if (axis->from != axis->to)
        return isfinite(axis->from) && isfinite(axis->to) && (!axis->is_log || (axis->from > 0 && axis->to > 0));
    if (!range->some)
        return false;
    double lo = range->lo, hi = range->hi;
    if (axis->is_log) {
        lo = fmax(lo, hi * 1e-6);
        axis->from = is_tight ? lo : pow(10, floor(log10(lo) + 1e-9));
        axis->to = is_tight ? hi : pow(10, ceil(log10(hi) - 1e-9));
        if (!(axis->to > axis->from)) {
            axis->from /= 10;
            axis->to *= 10;
        }
        return true;
    }
    if (!is_tight) {
        double margin = 0.05 * (hi - lo);
        bool from_zero = lo >= 0 && lo < 0.6 * hi;
        lo = from_zero ? 0 : lo - margin;
        hi += from_zero ? 0.06 * hi : margin;
    }
    if (!(hi - lo > 1e-12 * fmax(fabs(lo), fabs(hi)))) { // a constant
        double half = fabs(hi) > 0 ? 0.1 * fabs(hi) : 1;
        lo -= half;
        hi += half;
    }
    axis->from = lo;
    axis->to = hi;
    return true;
}

double sr_plot_place(const struct sr_plot_axis *axis, double value)
{
    if (!axis->is_log)
        return (value - axis->from) / (axis->to - axis->from);
    if (isnan(value))
        return value;
    if (!(value > 0))
        return -1; // nothing is as far down as one likes: one axis below the axis
    return fmax(-1, log(value / axis->from) / log(axis->to / axis->from));
}
