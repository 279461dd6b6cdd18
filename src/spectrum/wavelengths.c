/* SPDX-License-Identifier: MIT */
/* Wavelengths of a path: where the observer sees well, they are dense.
 *
 *     p(lambda) ~ sech^2(a (lambda - b)),   a = 0.0072 / nm,   b = 538 nm           [1/nm]
 *
 * With e(lambda) = exp(2 a (lambda - b)) the distribution function is e / (1 + e), so for a range lo … hi and u in
 * [0, 1)
 *
 *     lambda = lo + log(1 + delta) / (2 a),   delta = u d (1 + e_lo) / (1 + e_hi - u d e_lo),   d = e_hi / e_lo - 1
 *     p(lambda) = 2 a (1 + delta) (1 + e_lo) (1 + e_hi) / (d (1 + e_lo (1 + delta))^2)
 *
 * which loses no digits in narrow ranges or in the tails. Lane i takes u + i / SR_LAMBDA_COUNT mod 1.
 * M. Radziszewski, K. Boryczko, W. Alda, An improved technique for full spectral rendering, 2009.
 * Ranges must be of positive width. Beyond 3000 nm the density has all but vanished: e is held there, so that the
 * result stays finite. */
#include "spectrum/spectrum.h"

#define SLOPE 0.0144f // 2 a [1/nm]
#define CENTRE 538.0f // b [nm]
#define TAIL 36.0f    // largest exponent

// natural logarithm of w >= 1; absolute error < 1e-7 max(1, log w)
static sr_spectrum logarithm(sr_spectrum w)
{
    sr_spectrum_int bits = (sr_spectrum_int)w;
    // w = 2^k m with m in [sqrt(1/2), sqrt(2))
    sr_spectrum_int k = (bits - 0x3f3504f3) >> 23;
    sr_spectrum m = (sr_spectrum)(bits - (k << 23));
    // log m = 2 artanh(q), q = (m - 1) / (m + 1), |q| < 0.172
    sr_spectrum q = (m - 1.0f) / (m + 1.0f), q2 = q * q;
    sr_spectrum series = ((2.0f / 9 * q2 + 2.0f / 7) * q2 + 2.0f / 5) * q2 + 2.0f / 3;
    return __builtin_convertvector(k, sr_spectrum) * 0.693147181f + (q * q2 * series + 2.0f * q);
}

struct sr_lambda_law sr_lambda_law(struct sr_lambda_range range)
{
    float x = SLOPE * (range.lo - CENTRE), y = SLOPE * (range.hi - range.lo);
    y = y < TAIL ? y : TAIL;
    sr_spectrum exponents = SR_BLACK + y;
    exponents[0] = x < TAIL ? x : TAIL;
    sr_spectrum exponentials = sr_spectrum_exp(exponents);
    float e_lo = exponentials[0], d = exponentials[1] - 1;
    if (y < 0.25f) // the series keeps the digits that the difference loses
        d = y * (1 + y / 2 * (1 + y / 3 * (1 + y / 4 * (1 + y / 5 * (1 + y / 6)))));
    return (struct sr_lambda_law){range, e_lo, d, 1 + e_lo, 1 + e_lo * (1 + d)};
}

struct sr_wavelengths sr_wavelengths_draw(const struct sr_lambda_law *law, float u)
{
    sr_spectrum v;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        v[i] = (float)i / SR_LAMBDA_COUNT;
    v += u;
    v = sr_spectrum_select(v >= 1.0f, v - 1.0f, v);

    float e_lo = law->e_lo, d = law->growth;
    sr_spectrum share = v * d;
    sr_spectrum grown = 1.0f + share * law->above_lo / (law->above_lo + e_lo * (d - share)); // 1 + delta

    struct sr_wavelengths w;
    w.known = NULL;
    sr_spectrum lambda = law->range.lo + logarithm(grown) * (1 / SLOPE);
    w.lambda = sr_spectrum_select(lambda > law->range.hi, SR_BLACK + law->range.hi, lambda);
    sr_spectrum inverse = 1.0f / (1.0f + e_lo * grown);
    w.pdf = SLOPE / d * grown * (law->above_lo * inverse) * (law->above_hi * inverse);
    return w;
}

struct sr_wavelengths sr_wavelengths_sample(struct sr_lambda_range range, float u)
{
    struct sr_lambda_law law = sr_lambda_law(range);
    return sr_wavelengths_draw(&law, u);
}

void sr_wavelengths_terminate_secondary(struct sr_wavelengths *w)
{
    if (sr_wavelengths_secondary_terminated(w))
        return;
    sr_spectrum pdf = SR_BLACK;
    pdf[0] = w->pdf[0] / SR_LAMBDA_COUNT;
    w->pdf = pdf;
}
