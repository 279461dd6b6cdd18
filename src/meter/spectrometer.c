/* SPDX-License-Identifier: MIT */
/* A spectrometer: the mean of a spectral quantity over bins, weighed by a bandpass.
 *
 *     X_k = INTEGRAL b(lambda - lambda_k) X(lambda) dlambda / INTEGRAL b dlambda       [per nm]
 *
 * b is a triangle or a rectangle of the given width at half height; a triangle as wide as the step counts every
 * wavelength once (CIE 233:2019). Limits: no stray light, no noise of its own. */
#include "meter/meter.h"

sr_status sr_spectrometer_prepare(double lo, double step, double hi, double fwhm, enum sr_meter_bandpass bandpass,
                                  struct sr_spectrometer *s, struct sr_error *error)
{
    *s = (struct sr_spectrometer){0};
    double count = floor((hi - lo) / step + 1e-6) + 1;
    if (!(lo >= 100 && hi <= 20000 && step > 0 && hi >= lo && count <= 4096))
        return sr_fail(
            error, SR_ERROR_INPUT,
            "wavelengths from %g by %g to %g nm: expected first, step, last, within 100 to 20000 nm, 4096 at most", lo,
            step, hi);
    double width = isnan(fwhm) ? step : fwhm;
    if (!(width > 0))
        return sr_fail(error, SR_ERROR_INPUT, "a bandpass of %g nm: expected more than 0", width);
    *s = (struct sr_spectrometer){
        .first = lo, .step = step, .fwhm = width, .count = (uint32_t)count, .bandpass = bandpass};
    return SR_OK;
}

void sr_spectrometer_add(const struct sr_spectrometer *s, sr_spectrum X, const struct sr_wavelengths *w, double *bins)
{
    bool is_triangle = s->bandpass == SR_BAND_TRIANGULAR;
    double reach = is_triangle ? s->fwhm : s->fwhm / 2, norm = 1 / ((double)SR_KM * SR_LAMBDA_COUNT * s->fwhm);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        if (!(w->pdf[i] > 0) || X[i] == 0)
            continue;
        double lambda = (double)w->lambda[i], x = (double)(X[i] / w->pdf[i]) * norm;
        double from = ceil((lambda - reach - s->first) / s->step), to = floor((lambda + reach - s->first) / s->step);
        for (double k = fmax(from, 0); k <= to && k < s->count; ++k) {
            double d = fabs(lambda - s->first - k * s->step);
            bins[(uint32_t)k] += is_triangle ? x * fmax(0, 1 - d / reach) : x;
        }
    }
}
