/* SPDX-License-Identifier: MIT */
/* Gauss-Legendre quadrature: exact for polynomials up to degree 2 n - 1.
 *
 *     INTEGRAL_a^b f(x) dx = SUM w_i f(x_i),    P_n(x_i) = 0,    w_i = 2 / ((1 - x_i^2) P_n'(x_i)^2)   on [-1, 1]
 *
 * Nodes by Newton's method from Tricomi's estimate; to rounding for n <= 512. */
#include "math/math.h"

void sr_gauss_legendre(int n, double a, double b, double *x, double *w)
{
    double centre = 0.5 * (a + b), half = 0.5 * (b - a);
    for (int i = 0; i < (n + 1) / 2; ++i) {
        double z = cos(M_PI * (i + 0.75) / (n + 0.5)), slope = 1;
        if (2 * i + 1 == n)
            z = 0;
        for (int turn = 0; turn < 100; ++turn) {
            double p = 1, previous = 0;
            for (int k = 1; k <= n; ++k) {
                double next = ((2 * k - 1) * z * p - (k - 1) * previous) / k;
                previous = p;
                p = next;
            }
            slope = n * (z * p - previous) / (z * z - 1);
            double step = p / slope;
            z -= step;
            if (fabs(step) < 1e-15)
                break;
        }
        x[i] = centre - half * z;
        x[n - 1 - i] = centre + half * z;
        w[i] = w[n - 1 - i] = 2 * half / ((1 - z * z) * slope * slope);
    }
}
