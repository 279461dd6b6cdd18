/* SPDX-License-Identifier: MIT */
/* Globally adaptive Gauss-Kronrod quadrature: 15 nodes an interval, 7 of which are Gauss's.
 *
 *     INTEGRAL f dx = SUM w_k f(x_k),   e = |K15 - G7|,   error = r min(1, (200 e / r)^1.5),   r = INTEGRAL |f - mean|
 *
 * The error is the usual estimate of QUADPACK (R. Piessens et al. 1983), never below the rounding; e itself bounds the
 * error of the 7 nodes, not of the 15. The errors that values bring along are integrated and added. A. Kronrod 1965. */
#include "quantity/quantity.h"

enum { NODES = 8, MOST = 400 };

static const double node[NODES] = {0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                                   0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                                   0.586087235467691130294144691693090, 0.405845151377397166906606412076961,
                                   0.207784955007898467600689403773245, 0};
static const double kronrod[NODES] = {0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
                                      0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
                                      0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
                                      0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
static const double gauss[NODES] = {0, 0.129484966168869693270611432679082, 0, 0.279705391489276667901467771423780,
                                    0, 0.381830050505118944950369775488975, 0, 0.417959183673469387755102040816327};

struct interval {
    double a, b;
    double key; // the largest error over its tolerance
    struct sr_estimate sum;
    double carried[SR_LAMBDA_COUNT]; // of the errors in sum: those of the values
};

static double estimate(double rough, double fine, double deviation, double magnitude)
{
    double e = fabs(fine - rough);
    if (deviation > 0 && e > 0)
        e = deviation * fmin(1, pow(200 * e / deviation, 1.5));
    return fmax(e, 1e-15 * magnitude);
}

static void measure(sr_integrand *f, void *context, const double *tolerance, struct interval *v)
{
    double half = 0.5 * (v->b - v->a), centre = 0.5 * (v->a + v->b);
    struct sr_estimate y[2 * NODES - 1];
    double weight[2 * NODES - 1];
    for (int k = 0; k < NODES; ++k) {
        weight[k] = weight[2 * NODES - 2 - k] = kronrod[k];
        f(context, centre - half * node[k], &y[k]);
        if (k < NODES - 1)
            f(context, centre + half * node[k], &y[2 * NODES - 2 - k]);
    }
    v->key = 0;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        double fine = 0, rough = 0, magnitude = 0, deviation = 0, carried = 0;
        for (int k = 0; k < 2 * NODES - 1; ++k) {
            double value = y[k].value[i];
            fine += weight[k] * value;
            rough += gauss[k < NODES ? k : 2 * NODES - 2 - k] * value;
            magnitude += weight[k] * fabs(value);
            carried += weight[k] * y[k].error[i];
        }
        for (int k = 0; k < 2 * NODES - 1; ++k)
            deviation += weight[k] * fabs(y[k].value[i] - 0.5 * fine);
        double own = half * estimate(rough, fine, deviation, magnitude);
        v->carried[i] = half * carried;
        v->sum.value[i] = half * fine;
        v->sum.error[i] = own + v->carried[i];
        v->key = fmax(v->key, tolerance[i] > 0 ? own / tolerance[i] : 0);
    }
}

void sr_integrate(sr_integrand *f, void *context, const double *breaks, int count,
                  const double tolerance[SR_LAMBDA_COUNT], int most, const int64_t *budget, struct sr_estimate *out)
{
    struct interval v[MOST];
    int n = 0;
    most = most < MOST ? most : MOST;
    for (int i = 0; i + 1 < count; ++i)
        if (breaks[i + 1] > breaks[i]) {
            v[n] = (struct interval){.a = breaks[i], .b = breaks[i + 1]};
            measure(f, context, tolerance, &v[n++]);
        }
    while (*budget > 0 && n > 0 && n < most) {
        double left = 0;
        int worst = 0;
        for (int i = 0; i < n; ++i) {
            left += v[i].key;
            worst = v[i].key > v[worst].key ? i : worst;
        }
        double middle = 0.5 * (v[worst].a + v[worst].b);
        if (left <= 1 || !(middle > v[worst].a && middle < v[worst].b))
            break;
        v[n] = (struct interval){.a = middle, .b = v[worst].b};
        v[worst].b = middle;
        measure(f, context, tolerance, &v[worst]);
        measure(f, context, tolerance, &v[n++]);
    }
    *out = (struct sr_estimate){0};
    for (int i = 0; i < n; ++i)
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
            out->value[l] += v[i].sum.value[l];
            out->error[l] += v[i].sum.error[l];
        }
}
