/* SPDX-License-Identifier: MIT */
/* Observers: what one watt counts at each wavelength.
 *
 *     X = INTEGRAL K(lambda) X_e(lambda) dlambda
 *     K = 1 W/W,  K_m V(lambda) lm/W,  lambda / (h c N_A) umol/J = 0.00835935 umol/J per nm
 *
 * CIE 018:2019; CIE 170-2:2015; CODATA 2019 (h, c and N_A are exact). K_m = 683 lm/W is rounded as usual: the tabulated
 * V at 540 THz (555.016 nm in air) gives 683.0016 lm/W, 2.3e-6 more. Limits: efficiencies linear between samples by 1
 * nm. */
#include "quantity/private.h"

#include <string.h>

typedef float quad __attribute__((vector_size(16)));

#define UMOL_PER_J_NM (1e-3 / (6.62607015e-34 * 299792458 * 6.02214076e23)) // [umol/(J nm)]

double sr_observer_at(enum sr_system system, double lambda)
{
    if (system == SR_RADIOMETRIC)
        return 1;
    if (system >= SR_PHOTON)
        return system == SR_PAR && !(lambda >= 400 && lambda <= 700) ? 0 : lambda * UMOL_PER_J_NM;
    double at = lambda - (double)SR_LAMBDA_MIN;
    if (!(at >= 0 && at <= EFFICIENCY_COUNT - 1))
        return 0;
    int i = (int)at, column = system - SR_PHOTOPIC;
    double t = at - i;
    return sr_data_efficacy[column] *
           ((1 - t) * (double)sr_data_efficiency[i][column] + t * (double)sr_data_efficiency[i + 1][column]);
}

double sr_observer_integral(enum sr_system system, const struct sr_spd *s, double lo, double hi)
{
    int steps = hi > lo ? (int)ceil(hi - lo) : 1;
    double step = (hi - lo) / steps, sum = 0;
    for (int i = 0; i <= steps; ++i) {
        double lambda = lo + step * i, weight = i == 0 || i == steps ? step / 2 : step;
        sum += weight * sr_observer_at(system, lambda) * (double)sr_spd_at(s, (float)lambda);
    }
    return sum;
}

void sr_observe(sr_spectrum X, const struct sr_wavelengths *w, double readings[SR_SYSTEM_COUNT])
{
    quad seen = {0};
    float energy = 0, photons = 0, par = 0;
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
        if (!(w->pdf[k] > 0))
            continue;
        float weight = X[k] / w->pdf[k], lambda = w->lambda[k], at = lambda - SR_LAMBDA_MIN;
        energy += weight;
        photons += weight * lambda;
        par += lambda >= 400 && lambda <= 700 ? weight * lambda : 0;
        if (!(at >= 0 && at <= (float)(EFFICIENCY_COUNT - 1)))
            continue;
        int i = (int)at;
        quad lower, upper;
        memcpy(&lower, sr_data_efficiency[i], sizeof lower);
        memcpy(&upper, sr_data_efficiency[i + 1], sizeof upper);
        seen += weight * (lower + (at - (float)i) * (upper - lower));
    }
    double watt = 1 / ((double)SR_KM * SR_LAMBDA_COUNT);
    readings[SR_RADIOMETRIC] = (double)energy * watt;
    for (int column = 0; column < 4; ++column)
        readings[SR_PHOTOPIC + column] = sr_data_efficacy[column] * (double)seen[column] * watt;
    readings[SR_PHOTON] = UMOL_PER_J_NM * (double)photons * watt;
    readings[SR_PAR] = UMOL_PER_J_NM * (double)par * watt;
}
