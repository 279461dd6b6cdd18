/* SPDX-License-Identifier: MIT */
/* The CIE 1931 standard observer: from spectra to XYZ.
 *
 *     X = INTEGRAL L(lambda) xbar(lambda) dlambda  [unit of L times nm],   and Y with ybar, Z with zbar
 *
 * Integrals of known spectra are sums by 1 nm from 360 to 830 nm (CIE 015:2018); those of paths are Monte Carlo
 * means of L xbar / pdf, with the functions linear between the samples and zero outside. ybar is V(lambda) of CIE
 * 1924. */
#include "spectrum/data.h"

#include <string.h>

typedef float quad __attribute__((vector_size(16)));

void sr_observer_1931(double lambda, double xyz[3])
{
    double at = lambda - (double)SR_LAMBDA_MIN;
    if (!(at >= 0 && at <= SR_OBSERVER_COUNT - 1)) {
        xyz[0] = xyz[1] = xyz[2] = 0;
        return;
    }
    int i = at < SR_OBSERVER_COUNT - 1 ? (int)at : SR_OBSERVER_COUNT - 2;
    double t = at - i;
    for (int k = 0; k < 3; ++k)
        xyz[k] = (1 - t) * sr_data_observer[i][k] + t * sr_data_observer[i + 1][k];
}

double sr_luminous_efficiency(double lambda)
{
    double xyz[3];
    sr_observer_1931(lambda, xyz);
    return xyz[1];
}

void sr_spd_xyz(const struct sr_spd *s, double xyz[3])
{
    xyz[0] = xyz[1] = xyz[2] = 0;
    for (int i = 0; i < SR_OBSERVER_COUNT; ++i) {
        double value = (double)sr_spd_at(s, SR_LAMBDA_MIN + (float)i);
        for (int k = 0; k < 3; ++k)
            xyz[k] += value * sr_data_observer[i][k];
    }
}

double sr_spd_luminous_integral(const struct sr_spd *s)
{
    double xyz[3];
    sr_spd_xyz(s, xyz);
    return xyz[1];
}

struct sr_xyz sr_spectrum_to_xyz(sr_spectrum L, const struct sr_wavelengths *w)
{
    sr_spectrum at = w->lambda - SR_LAMBDA_MIN;
    sr_spectrum_int counts = (at >= 0.0f) & (at <= (float)(SR_OBSERVER_COUNT - 1)) & (w->pdf > 0.0f);
    at = sr_spectrum_select(counts, at, SR_BLACK);
    sr_spectrum weight = sr_spectrum_select(counts, L / w->pdf, SR_BLACK);
    sr_spectrum_int i = __builtin_convertvector(at, sr_spectrum_int);
    sr_spectrum upper = weight * (at - __builtin_convertvector(i, sr_spectrum)), lower = weight - upper;
    // from memory a number comes to all four places at once, and an offset needs no more arithmetic
    uint32_t offsets[SR_LAMBDA_COUNT];
    float lowers[SR_LAMBDA_COUNT], uppers[SR_LAMBDA_COUNT];
    i *= (sr_lane)sizeof(quad);
    memcpy(offsets, &i, sizeof offsets);
    memcpy(lowers, &lower, sizeof lowers);
    memcpy(uppers, &upper, sizeof uppers);
    quad sums[2] = {{0}}; // two, so that additions wait less for each other
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
        const quad *row = (const quad *)(const void *)((const char *)sr_data_observer_f +
                                                       offsets[k]); // the last row is followed by a zero one
        sums[k & 1] += lowers[k] * row[0] + uppers[k] * row[1];
    }
    quad sum = (sums[0] + sums[1]) * (1.0f / SR_LAMBDA_COUNT);
    return (struct sr_xyz){sum[0], sum[1], sum[2]};
}
