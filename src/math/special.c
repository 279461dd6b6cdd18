/* SPDX-License-Identifier: MIT */
/* The incomplete gamma and beta functions, and the distributions of statistics that follow from them.
 *
 *     Q(a, x) = 1/Gamma(a) INTEGRAL_x^inf t^(a-1) e^-t dt,    I_x(a, b) = 1/B(a, b) INTEGRAL_0^x t^(a-1) (1-t)^(b-1) dt
 *     chi-square: Q(k/2, chi2/2);    Student, two-sided: I_(k/(k + t^2))(k/2, 1/2);    normal: erfc(z / sqrt 2)
 *
 * Power series and continued fractions of M. Abramowitz & I. Stegun 1964, 6.5.29, 6.5.31, 26.5.8, by W. Lentz's method
 * (1976); factors in front by Stirling's series so that large a and b cost no digits. About 1e-12 relative. */
#include "math/math.h"

static double log_gamma(double x)
{
    int sign;
    return lgamma_r(x, &sign);
}

// log Gamma(a) - [(a - 1/2) log a - a + log(2 pi)/2] for a >= 20
static double stirling_rest(double a)
{
    double r = 1 / (a * a);
    return (1.0 / 12 + r * (-1.0 / 360 + r * (1.0 / 1260 + r * (-1.0 / 1680 + r * (1.0 / 1188))))) / a;
}

static double nonzero(double x)
{
    return fabs(x) < 1e-300 ? 1e-300 : x;
}

// x^a e^-x / Gamma(a)
static double gamma_factor(double a, double x)
{
    if (a < 20)
        return exp(a * log(x) - x - log_gamma(a));
    double mu = (x - a) / a;
    return sqrt(a / (2 * M_PI)) * exp(a * (log1p(mu) - mu) - stirling_rest(a));
}

double sr_incomplete_gamma_upper(double a, double x)
{
    if (!(a > 0) || isnan(x))
        return (double)NAN;
    if (x <= 0)
        return 1;
    if (isinf(x))
        return 0;
    int most = 1000 + (int)fmin(1e8, 20 * sqrt(a));
    double factor = gamma_factor(a, x);
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (int k = 1; k < most && term > sum * 1e-17; ++k) {
            term *= x / (a + k);
            sum += term;
        }
        return 1 - factor * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / nonzero(b), h = d;
    for (int k = 1; k < most; ++k) {
        double numerator = -k * (k - a);
        b += 2;
        d = 1 / nonzero(numerator * d + b);
        c = nonzero(b + numerator / c);
        h *= c * d;
        if (fabs(c * d - 1) < 1e-16)
            break;
    }
    return factor * h;
}

// x^a y^b / B(a, b), y = 1 - x
static double beta_factor(double a, double b, double x, double y)
{
    if (a >= 20 && b >= 20) {
        double n = a + b, excess = x * b - y * a; // n (x - a / n), whichever of x and y is small
        double exponent = a * log1p(excess / a) + b * log1p(-excess / b);
        return sqrt(a * b / (2 * M_PI * n)) * exp(exponent + stirling_rest(n) - stirling_rest(a) - stirling_rest(b));
    }
    double large = fmax(a, b), small = fmin(a, b);
    double log_x = x < 0.5 ? log(x) : log1p(-y), log_y = y < 0.5 ? log(y) : log1p(-x);
    double rise; // log Gamma(a + b) - log Gamma(large)
    if (large < 20)
        rise = log_gamma(a + b) - log_gamma(large);
    else
        rise = (large - 0.5) * log1p(small / large) + small * log(a + b) - small + stirling_rest(a + b) -
               stirling_rest(large);
    return exp(a * log_x + b * log_y + rise - log_gamma(small));
}

// for x below the mean the fraction converges fast
static double beta_fraction(double a, double b, double x)
{
    double c = 1, d = 1 / nonzero(1 - (a + b) * x / (a + 1)), h = d;
    int most = 1000 + (int)fmin(1e8, 20 * sqrt(fmax(a, b)));
    for (int k = 1; k < most; ++k) {
        double even = k * (b - k) * x / ((a + 2 * k - 1) * (a + 2 * k));
        d = 1 / nonzero(1 + even * d);
        c = nonzero(1 + even / c);
        h *= c * d;
        double odd = -(a + k) * (a + b + k) * x / ((a + 2 * k) * (a + 2 * k + 1));
        d = 1 / nonzero(1 + odd * d);
        c = nonzero(1 + odd / c);
        h *= c * d;
        if (fabs(c * d - 1) < 1e-16)
            break;
    }
    return h;
}

// y = 1 - x, given apart because one of them may be tiny
static double incomplete_beta(double a, double b, double x, double y)
{
    if (!(a > 0) || !(b > 0) || isnan(x))
        return (double)NAN;
    if (x <= 0)
        return 0;
    if (y <= 0)
        return 1;
    double factor = beta_factor(a, b, x, y);
    if (x < (a + 1) / (a + b + 2))
        return factor * beta_fraction(a, b, x) / a;
    return 1 - factor * beta_fraction(b, a, y) / b;
}

double sr_incomplete_beta(double a, double b, double x)
{
    return incomplete_beta(a, b, x, 1 - x);
}

double sr_chi2_p(double chi2, double degrees)
{
    return sr_incomplete_gamma_upper(0.5 * degrees, 0.5 * chi2);
}

double sr_normal_p_two_sided(double z)
{
    return erfc(fabs(z) * M_SQRT1_2);
}

double sr_normal_quantile(double p)
{
    if (!(p > 0 && p < 1))
        return p == 0 ? -HUGE_VAL : p == 1 ? HUGE_VAL : (double)NAN;
    double tail = p < 0.5 ? p : 1 - p;
    // C. Hastings' estimate (1955; Abramowitz & Stegun 26.2.22, error 0.003), then Halley's method on erfc
    double t = sqrt(-2 * log(tail));
    double z = t - (2.30753 + 0.27061 * t) / (1 + t * (0.99229 + 0.04481 * t));
    for (int i = 0; i < 4; ++i) {
        double density = exp(-0.5 * z * z) / sqrt(2 * M_PI);
        double step = (0.5 * erfc(z * M_SQRT1_2) - tail) / fmax(density, 1e-320);
        z += step / (1 - 0.5 * z * step);
    }
    return p < 0.5 ? -z : z;
}

double sr_student_p_two_sided(double t, double degrees)
{
    if (degrees > 1e12)
        return sr_normal_p_two_sided(t);
    double t2 = t * t;
    if (isinf(t2))
        return 0;
    return incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t2), t2 / (degrees + t2));
}

double sr_student_quantile(double p, double degrees)
{
    if (!(p > 0 && p < 1) || !(degrees > 0))
        return p == 0 ? -HUGE_VAL : p == 1 ? HUGE_VAL : (double)NAN;
    if (p == 0.5)
        return 0;
    double tail = 2 * (p < 0.5 ? p : 1 - p);
    double lo = 0, hi = 1;
    while (sr_student_p_two_sided(hi, degrees) > tail && hi < 1e300)
        hi *= 2;
    // Newton's method, kept inside the bracket; the derivative is twice the density
    double log_factor =
        log(2 * beta_factor(0.5 * degrees, 0.5, 0.5, 0.5)) + 0.5 * (degrees + 1) * M_LN2 - 0.5 * log(degrees);
    double t = 0.5 * (lo + hi);
    for (int i = 0; i < 200; ++i) {
        double excess = sr_student_p_two_sided(t, degrees) - tail;
        if (excess > 0)
            lo = t;
        else
            hi = t;
        double density = exp(log_factor - 0.5 * (degrees + 1) * log1p(t * t / degrees));
        double next = t + excess / density;
        if (!(next > lo && next < hi))
            next = 0.5 * (lo + hi);
        double change = fabs(next - t);
        t = next;
        if (change <= 1e-15 * t)
            break;
    }
    return p < 0.5 ? -t : t;
}
