/* SPDX-License-Identifier: MIT */
/* Monte Carlo integration as an experiment: integrals with known values, and how fast errors fall.
 *
 *     error(n) = sqrt(1/S SUM over seeds of (I_n - I)^2) ~ C n^slope */
#ifndef SR_STUDY_STUDY_H
#define SR_STUDY_STUDY_H

#include "sample/sample.h"

enum { SR_STUDY_STRATEGIES = 2, SR_STUDY_POINTS = 64 };

/* An integral over [0, 1] or its square, and ways to sample it: f(x) / p(x) for x drawn by numbers u, v in (0, 1). */
struct sr_study_integral {
    const char *name, *formula;
    int dimensions;
    double value;
    struct {
        const char *name, *density;
        double (*estimate)(double u, double v);
    } strategies[SR_STUDY_STRATEGIES]; // name NULL: none
};
extern const struct sr_study_integral sr_study_integrals[]; // ends with name NULL
const struct sr_study_integral *sr_study_integral_find(const char *name);

/* Root mean square error of means of n samples, over `seeds` independent nets; *time_s: of one mean, on the processor.
 */
double sr_study_error(const struct sr_study_integral *integral, int strategy, enum sr_sampler_kind sampler,
                      uint32_t seed, uint32_t n, uint32_t seeds, double *time_s);

/* The straight line through log error over log x, by least squares, with 95 % bounds of its slope and of itself. */
struct sr_study_slope {
    double slope, low, high;                                                             // [1]
    double line[SR_STUDY_POINTS], line_low[SR_STUDY_POINTS], line_high[SR_STUDY_POINTS]; // [unit of error] at each x
};
/* Points that are not above 0 are left out; false: fewer than three are left. */
bool sr_study_fit(const double *x, const double *error, uint32_t count, struct sr_study_slope *out);

#endif
