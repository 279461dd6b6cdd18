/* SPDX-License-Identifier: MIT */
/* The slope of an error: least squares in logarithms, with Student's bounds.
 *
 *     y = a + b (x - mean x),    u^2(b) = s^2 / SUM (x - mean x)^2,
 *         u^2(y(x)) = s^2 (1/k + (x - mean x)^2 / SUM (x - mean x)^2)
 *
 * s^2: residual variance with k - 2 degrees of freedom (N. Draper & H. Smith, Applied Regression Analysis, 1998, ch.
 * 1). Limits: a line is taken for granted; errors that bend are the mean of their slopes, and their residuals widen the
 * band. */
#include "study/study.h"

bool sr_study_fit(const double *x, const double *error, uint32_t count, struct sr_study_slope *out)
{
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0, rest = 0;
    uint32_t k = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (x[i] > 0 && error[i] > 0) {
            mean_x += log(x[i]);
            mean_y += log(error[i]);
            ++k;
        }
    if (k < 3)
        return false;
    mean_x /= k;
    mean_y /= k;
    for (uint32_t i = 0; i < count; ++i)
        if (x[i] > 0 && error[i] > 0) {
            double dx = log(x[i]) - mean_x;
            xx += dx * dx;
            xy += dx * (log(error[i]) - mean_y);
        }
    if (!(xx > 0))
        return false;
    out->slope = xy / xx;
    for (uint32_t i = 0; i < count; ++i)
        if (x[i] > 0 && error[i] > 0)
            rest += pow(log(error[i]) - mean_y - out->slope * (log(x[i]) - mean_x), 2);
    double t = sr_student_quantile(0.975, k - 2), s = sqrt(rest / (k - 2));
    out->low = out->slope - t * s / sqrt(xx);
    out->high = out->slope + t * s / sqrt(xx);
    for (uint32_t i = 0; i < count && i < SR_STUDY_POINTS; ++i) {
        double dx = log(x[i]) - mean_x, y = mean_y + out->slope * dx, u = t * s * sqrt(1.0 / k + dx * dx / xx);
        out->line[i] = exp(y);
        out->line_low[i] = exp(y - u);
        out->line_high[i] = exp(y + u);
    }
    return true;
}
