/* SPDX-License-Identifier: MIT */
/* The exponential of every component.
 *
 *     exp(x) = 2^n exp(r),   n = round(x / ln 2),   |r| <= ln(2) / 2
 *
 * with the Taylor polynomial of degree 7 for exp(r): its remainder is below 6e-9; relative error < 2e-7 in all. Below
 * -87.33 (where floats become denormal) the result is 0, above 88.72 it is infinite, and NaN stays NaN. */
#include "spectrum/spectrum.h"

sr_spectrum sr_spectrum_exp(sr_spectrum s)
{
#ifdef SR_DOUBLE
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        s[i] = exp(s[i]);
    return s;
#else
    // ln 2 in two parts, so that n ln 2 is subtracted without loss (Cody and Waite)
    const float ln2_high = 0x1.62ep-1f, ln2_low = 0x1.0bfbe8p-15f, shift = 0x1.8p23f;
    sr_spectrum x = sr_spectrum_select(s < -88.0f, SR_BLACK - 88.0f, s);
    x = sr_spectrum_select(x > 89.0f, SR_BLACK + 89.0f, x);
    sr_spectrum n = (x * 1.44269504f + shift) - shift;
    sr_spectrum r = (x - n * ln2_high) - n * ln2_low;
    sr_spectrum p = 1.0f / 5040 * r + 1.0f / 720;
    p = p * r + 1.0f / 120;
    p = p * r + 1.0f / 24;
    p = p * r + 1.0f / 6;
    p = p * r + 0.5f;
    p = p * r * r + r + 1.0f;

    // 2^n in two factors: n may be 128
    sr_spectrum_int k = __builtin_convertvector(n, sr_spectrum_int), half = k >> 1;
    sr_spectrum low = (sr_spectrum)((half + 127) << 23), high = (sr_spectrum)((k - half + 127) << 23);
    sr_spectrum y = sr_spectrum_select(s < -87.3365f, SR_BLACK, p * low * high);
    return sr_spectrum_select(s > 88.7228f, SR_BLACK + INFINITY, y);
#endif
}
