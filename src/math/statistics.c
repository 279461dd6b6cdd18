/* SPDX-License-Identifier: MIT */
/* Tallies of random draws, and Pearson's test of counts against expectations.
 *
 *     mean += (x - mean) / n,    m2 += (x - old mean) (x - new mean),    variance = m2 / (n - 1)
 *     chi2 = SUM (observed - expected)^2 / expected,    cells - 1 degrees of freedom
 *
 * B. Welford 1962; T. Chan, G. Golub & R. LeVeque 1979; K. Pearson 1900. */
#include "math/math.h"

void sr_tally_add(struct sr_tally *t, double x)
{
    t->max = t->n == 0 || x > t->max ? x : t->max;
    t->n++;
    double deviation = x - t->mean;
    t->mean += deviation / (double)t->n;
    t->m2 += deviation * (x - t->mean);
}

void sr_tally_merge(struct sr_tally *t, const struct sr_tally *other)
{
    if (other->n == 0)
        return;
    if (t->n == 0) {
        *t = *other;
        return;
    }
    double n = (double)t->n, m = (double)other->n, difference = other->mean - t->mean;
    t->mean += difference * m / (n + m);
    t->m2 += other->m2 + difference * difference * n * m / (n + m);
    t->max = fmax(t->max, other->max);
    t->n += other->n;
}

double sr_tally_variance(const struct sr_tally *t)
{
    return t->n > 1 ? t->m2 / (double)(t->n - 1) : 0;
}

double sr_tally_standard_error(const struct sr_tally *t)
{
    return t->n > 1 ? sqrt(sr_tally_variance(t) / (double)t->n) : 0;
}

double sr_chi2_test(const double *observed, const double *expected, size_t cells, double min_expected, double *chi2,
                    int *degrees)
{
    double sum = 0, last_o = 0, last_e = 0, pool_o = 0, pool_e = 0;
    int bins = 0;
    bool impossible = false;
    for (size_t i = 0; i < cells; ++i) {
        impossible |= !(expected[i] > 0) && observed[i] > 0;
        bool alone = expected[i] >= min_expected;
        double o = observed[i], e = expected[i];
        if (!alone) {
            o = pool_o += observed[i];
            e = pool_e += expected[i];
            if (pool_e < min_expected)
                continue;
            pool_o = pool_e = 0;
        }
        // one bin is held back, to take what may be left in the pool
        if (bins++ > 0)
            sum += (last_o - last_e) * (last_o - last_e) / last_e;
        last_o = o;
        last_e = e;
    }
    last_o += pool_o;
    last_e += pool_e;
    if (last_e > 0)
        sum += (last_o - last_e) * (last_o - last_e) / last_e;
    *chi2 = impossible ? HUGE_VAL : sum;
    *degrees = bins > 1 ? bins - 1 : 0;
    if (impossible)
        return 0;
    return *degrees > 0 ? sr_chi2_p(sum, *degrees) : 1;
}
