/* SPDX-License-Identifier: MIT */
/* What a colorimeter shows of X, Y, Z.
 *
 *     x = X/(X+Y+Z),   u' = 4X/(X+15Y+3Z),   v' = 9Y/(X+15Y+3Z)                       CIE 015:2018
 *     CCT = argmin over T of |(u, v) - (u, v)_Planck(T)|,   v = 2/3 v'
 *     Duv = that least distance, positive above the locus                             ANSI C78.377
 *
 * The locus is computed by 1 nm steps, not tabulated; the minimum is found in 1/T, in which the locus is run through
 * evenly. */
#include "meter/meter.h"

const char *const sr_colour_names[SR_COLOUR_COUNT] = {"X", "Y", "Z", "x", "y", "u'", "v'", "CCT", "Duv"};

static void planck_uv(double inverse_T, double uv[2])
{
    double X = 0, Y = 0, Z = 0;
    for (int lambda = (int)SR_LAMBDA_MIN; lambda <= (int)SR_LAMBDA_MAX; lambda += 1) {
        double bar[3], L = sr_planck(lambda, 1 / inverse_T);
        sr_observer_1931(lambda, bar);
        X += L * bar[0];
        Y += L * bar[1];
        Z += L * bar[2];
    }
    double sum = X + 15 * Y + 3 * Z;
    uv[0] = 4 * X / sum;
    uv[1] = 6 * Y / sum;
}

static double distance2(double inverse_T, double u, double v)
{
    double uv[2];
    planck_uv(inverse_T, uv);
    return (uv[0] - u) * (uv[0] - u) + (uv[1] - v) * (uv[1] - v);
}

void sr_colour_of(double c[SR_COLOUR_COUNT])
{
    double X = c[SR_COLOUR_X], Y = c[SR_COLOUR_Y], Z = c[SR_COLOUR_Z], sum = X + Y + Z, sum_uv = X + 15 * Y + 3 * Z;
    c[SR_COLOUR_x] = X / sum;
    c[SR_COLOUR_y] = Y / sum;
    c[SR_COLOUR_u] = 4 * X / sum_uv;
    c[SR_COLOUR_v] = 9 * Y / sum_uv;
    c[SR_COLOUR_CCT] = c[SR_COLOUR_DUV] = NAN;
    if (!(sum > 0) || !(sum_uv > 0))
        return;
    // the nearest of points 10 mireds apart, then golden section between its neighbours (Kiefer 1953)
    double u = c[SR_COLOUR_u], v = c[SR_COLOUR_v] * 2 / 3, best = INFINITY, at = 0;
    enum { MIREDS = 1000, STRIDE = 10 };
    for (int m = STRIDE; m <= MIREDS; m += STRIDE) {
        double d = distance2(m * 1e-6, u, v);
        if (d < best) {
            best = d;
            at = m;
        }
    }
    double a = (at - STRIDE < 1 ? 1 : at - STRIDE) * 1e-6, b = (at + STRIDE) * 1e-6, golden = 0.6180339887498949;
    double p = b - golden * (b - a), q = a + golden * (b - a), fp = distance2(p, u, v), fq = distance2(q, u, v);
    while (b - a > 1e-10) {
        if (fp < fq) {
            b = q, q = p, fq = fp;
            p = b - golden * (b - a), fp = distance2(p, u, v);
        } else {
            a = p, p = q, fp = fq;
            q = a + golden * (b - a), fq = distance2(q, u, v);
        }
    }
    double inverse_T = (a + b) / 2, uv[2];
    planck_uv(inverse_T, uv);
    c[SR_COLOUR_DUV] = copysign(hypot(u - uv[0], v - uv[1]), v - uv[1]);
    bool is_at_end = inverse_T < 1.1e-6 || inverse_T > MIREDS * 1e-6;
    c[SR_COLOUR_CCT] = fabs(c[SR_COLOUR_DUV]) <= 0.05 && !is_at_end ? 1 / inverse_T : NAN;
}
