/* SPDX-License-Identifier: MIT */
/* Private to this room: adaptive quadrature of functions that have a value for each wavelength, and may be integrals
 * themselves. */
#ifndef SR_LAB_ADAPTIVE_H
#define SR_LAB_ADAPTIVE_H

#include "spectrum/spectrum.h"

/* A value and a bound of its error, for each wavelength. */
struct lab_estimate {
    double value[SR_LAMBDA_COUNT], error[SR_LAMBDA_COUNT];
};
/* y(x); its error is what the function itself does not know, as where it is an integral. */
typedef void lab_integrand(void *context, double x, struct lab_estimate *y);

/* The integral of y between the first and the last of the breaks (ascending, two or more; between them y is smooth as far
 * as is known), to an absolute error per wavelength. Intervals are halved where the error is largest, `most` of them at
 * most, and only while *budget (of evaluations, which the caller counts down) is positive. */
void sr_integrate(lab_integrand *f, void *context, const double *breaks, int count,
                  const double tolerance[SR_LAMBDA_COUNT], int most, const int64_t *budget, struct lab_estimate *out);

#endif
