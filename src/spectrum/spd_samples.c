/* SPDX-License-Identifier: MIT */
/* Spectra from pairs (lambda [nm], value), linear between them and zero outside, as even tables.
 *
 * Pairs that stand evenly are taken as they are. Others are resampled from the first to the last wavelength by steps
 * of 1 nm or, where pairs are closer, of half their least distance (at most SAMPLES_MAX steps); between the samples
 * the table is then linear again, so a kink is off by less than one step. */
#include "spectrum/spectrum.h"

#define SAMPLES_MAX 65536

static bool make_sense(const float *lambda, const float *values, int count, struct sr_error *error)
{
    if (count < 2) {
        sr_fail(error, SR_ERROR_INPUT, "a spectrum needs two pairs of wavelength and value or more, and has %d", count);
        return false;
    }
    for (int i = 0; i < count; ++i) {
        if (!isfinite(lambda[i]) || lambda[i] <= 0 || !isfinite(values[i])) {
            sr_fail(error, SR_ERROR_INPUT,
                    "pair %d of a spectrum is (%g nm, %g): wavelengths are positive, and both are finite numbers",
                    i + 1, (double)lambda[i], (double)values[i]);
            return false;
        }
        if (i > 0 && !(lambda[i] > lambda[i - 1])) {
            sr_fail(error, SR_ERROR_INPUT, "the wavelengths of a spectrum must increase, but %g nm comes after %g nm",
                    (double)lambda[i], (double)lambda[i - 1]);
            return false;
        }
    }
    return true;
}

struct sr_spd sr_spd_from_samples(struct sr_arena *arena, const float *lambda, const float *values, int count,
                                  struct sr_error *error)
{
    const struct sr_spd none = {.kind = SR_SPD_NONE};
    if (!make_sense(lambda, values, count, error))
        return none;

    double first = (double)lambda[0], width = (double)lambda[count - 1] - first;
    double even = width / (count - 1), least = width;
    bool is_even = true;
    for (int i = 1; i < count; ++i) {
        least = fmin(least, (double)lambda[i] - (double)lambda[i - 1]);
        is_even = is_even && fabs((double)lambda[i] - (first + i * even)) < 1e-4;
    }
    int steps = count - 1;
    if (!is_even)
        steps = (int)fmin(ceil(width / fmin(1, least < 1 ? least / 2 : 1)), SAMPLES_MAX);

    struct sr_table *table = sr_arena_alloc(arena, sizeof(*table) + (size_t)(steps + 1) * sizeof(float));
    if (!table) {
        sr_fail(error, SR_ERROR_RESOURCE, "no memory for a spectrum of %d samples", steps + 1);
        return none;
    }
    table->first = lambda[0];
    table->step = (float)(width / steps);
    table->count = steps + 1;
    for (int i = 0, k = 0; i <= steps; ++i) {
        if (is_even) {
            table->values[i] = values[i];
            continue;
        }
        double at = first + width * i / steps;
        while (k < count - 2 && at >= (double)lambda[k + 1])
            ++k;
        double t = fmin((at - (double)lambda[k]) / ((double)lambda[k + 1] - (double)lambda[k]), 1);
        table->values[i] = (float)((1 - t) * (double)values[k] + t * (double)values[k + 1]);
    }
    return (struct sr_spd){.kind = SR_SPD_TABLE, .scale = 1, .table = table};
}
