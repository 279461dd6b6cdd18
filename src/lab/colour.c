/* SPDX-License-Identifier: MIT */
/* Reflectances as an observer sees them under an illuminant.
 *
 *     rho_v = INTEGRAL rho(l) S(l) V(l) dl / INTEGRAL S(l) V(l) dl               [unit of rho]
 *     X = INTEGRAL R(l) S(l) xbar(l) dl / INTEGRAL S(l) ybar(l) dl, …            [1]
 *
 * with the reflectance factor R, from 360 to 830 nm by sums over 1 nm; rho is known every 5 nm and linear between,
 * which is enough for paints and metals and coarse for thick interference films. CIE 15:2018; observer CIE 1931. */
#include "lab/lab.h"

enum { STEP = 5, KNOTS = 95 }; // [nm]

sr_status sr_reflectance_colour(const struct sr_specimen *specimen, const struct sr_spd *illuminant,
                                const struct sr_beam *from, const struct sr_beam *to, double tolerance,
                                struct sr_reflectance_colour *out, struct sr_error *error)
{
    double rho[KNOTS + SR_LAMBDA_COUNT], bound[KNOTS + SR_LAMBDA_COUNT], over_perfect = 1;
    *out = (struct sr_reflectance_colour){.has_converged = true};
    for (int first = 0; first < KNOTS; first += SR_LAMBDA_COUNT) {
        sr_spectrum lambda = SR_BLACK;
        struct sr_reflectance r = {0};
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            lambda[l] = SR_LAMBDA_MIN + (float)(STEP * (first + l < KNOTS ? first + l : KNOTS - 1));
        if (sr_reflectance_cubature(specimen, lambda, from, to, tolerance, &r, error) != SR_OK)
            return error->status;
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
            rho[first + l] = r.value[l];
            bound[first + l] = r.error[l];
        }
        out->name = r.name;
        out->unit = r.unit;
        out->evaluations += r.evaluations;
        out->has_converged &= r.has_converged;
        over_perfect = M_PI / (r.projected_to > 0 ? r.projected_to : 1);
    }
    double white = 0;
    for (int nm = 0; nm <= STEP * (KNOTS - 1); ++nm) {
        int k = nm / STEP < KNOTS - 1 ? nm / STEP : KNOTS - 2;
        double lambda = (double)SR_LAMBDA_MIN + nm, t = (double)(nm - STEP * k) / STEP, xyz[3];
        double S = (double)sr_spd_at(illuminant, (float)lambda), value = (1 - t) * rho[k] + t * rho[k + 1];
        sr_observer_1931(lambda, xyz);
        white += S * xyz[1];
        out->luminous += S * xyz[1] * value;
        out->error += S * xyz[1] * ((1 - t) * bound[k] + t * bound[k + 1]);
        for (int c = 0; c < 3; ++c)
            out->xyz[c] += S * xyz[c] * value * over_perfect;
    }
    if (!(white > 0))
        return sr_fail(error, SR_ERROR_USAGE, "the illuminant has no light between 360 and 830 nm");
    out->luminous /= white;
    out->error /= white;
    for (int c = 0; c < 3; ++c)
        out->xyz[c] /= white;
    return SR_OK;
}
