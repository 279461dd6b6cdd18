/* SPDX-License-Identifier: MIT */
/* Quantities of light: units that are checked, values with uncertainty, and the observers that weigh wavelengths.
 *
 * Everything that is measured leaves as a struct sr_quantity and is printed by sr_quantity_text. Geometry is a quantity
 * too: irradiance times an area of unit m^2 is a flux, and nothing else fits. */
#ifndef SR_QUANTITY_QUANTITY_H
#define SR_QUANTITY_QUANTITY_H

#include "base/base.h"
#include "math/math.h"
#include "spectrum/spectrum.h"

#include <steradian/quantity.h>

/* ---- units ---- */

enum sr_kind {
    SR_KIND_ENERGY,       // Q    J, lm s, umol
    SR_KIND_FLUX,         // Phi  W, lm, umol/s
    SR_KIND_FLUX_DENSITY, // E, M
    SR_KIND_INTENSITY,    // I
    SR_KIND_RADIANCE,     // L
    SR_KIND_EXPOSURE,     // H = integral E dt
    SR_KIND_COUNT
};
struct sr_unit sr_unit_of(enum sr_kind kind, enum sr_system system, bool is_spectral);
struct sr_unit sr_unit_power(int metre, int steradian, int second); // m^a sr^b s^c
bool sr_unit_equal(struct sr_unit a, struct sr_unit b);
/* "E_v", "E'_v" (scotopic), "E_v,F2", "E_v,F10", "E_e", "E_p", "E_p,PAR"; spectral: "E_e,lambda". For unit-less names
 * of readings. */
const char *sr_kind_symbol(enum sr_kind kind, enum sr_system system);
const char *sr_system_name(enum sr_system system); // "radiometric", "photopic", …
bool sr_system_find(const char *name, enum sr_system *system);

/* ---- values ---- */

/* A number that is exact. */
struct sr_quantity sr_quantity_exact(double value, struct sr_unit unit);
/* The mean of replicates with its standard uncertainty, n - 1 degrees. Nothing but zeros found by `samples` samples,
 * each at most `largest` [unit] (0: not known): value 0 with the bound 3 largest / samples (Hanley & Lippman-Hand
 * 1983). */
struct sr_quantity sr_quantity_of_tally(const struct sr_tally *replicates, struct sr_unit unit);
struct sr_quantity sr_quantity_bounded(double largest, double samples, struct sr_unit unit);

/* f of the means of `columns` (at most 8) numbers whose replicates are rows: by the delete-one jackknife, which takes
 * in how they go together and removes the bias of order 1/replicates that ratios have (Quenouille 1956, Tukey 1958). */
struct sr_quantity sr_quantity_jackknife(const double *rows, uint32_t replicates, uint32_t columns,
                                         double (*f)(const double *means), struct sr_unit unit);

/* Of independent a and b; degrees by Welch & Satterthwaite. Sums of different units are refused: SR_ERROR_USAGE, and
 * *out is not a number. */
sr_status sr_quantity_add(const struct sr_quantity *a, const struct sr_quantity *b, struct sr_quantity *out,
                          struct sr_error *error);
sr_status sr_quantity_subtract(const struct sr_quantity *a, const struct sr_quantity *b, struct sr_quantity *out,
                               struct sr_error *error);
struct sr_quantity sr_quantity_scale(const struct sr_quantity *a, double factor);
struct sr_quantity sr_quantity_product(const struct sr_quantity *a, const struct sr_quantity *b);
struct sr_quantity sr_quantity_ratio(const struct sr_quantity *a, const struct sr_quantity *b);
/* To another kind of the same system over a size that is exact: of an irradiance times m^2 a flux, of a radiance times
 * sr an irradiance. Refused unless the units meet. */
sr_status sr_quantity_times(const struct sr_quantity *a, double size, struct sr_unit of_size, struct sr_unit expected,
                            struct sr_quantity *out, struct sr_error *error);
/* nu = u^4 / sum(u_i^4 / nu_i) of u^2 = sum u_i^2 (GUM G.4.1); infinity where no part has finite degrees. */
double sr_effective_degrees(const double *u, const double *degrees, size_t count);

/* ---- integrals ---- */

/* A value and a bound of its error, for each wavelength. */
struct sr_estimate {
    double value[SR_LAMBDA_COUNT], error[SR_LAMBDA_COUNT]; // [unit] of what is integrated
};
/* y(x); its error is what the function itself does not know, as where it is an integral. */
typedef void sr_integrand(void *context, double x, struct sr_estimate *y);

/* The integral of y between the first and the last of the breaks (ascending, two or more; between them y is smooth as
 * far as is known), to an absolute error per wavelength (0: any). Intervals are halved where the error is largest,
 * `most` of them at most, and only while *budget (of evaluations, which the caller counts down) is positive. */
void sr_integrate(sr_integrand *f, void *context, const double *breaks, int count,
                  const double tolerance[SR_LAMBDA_COUNT], int most, const int64_t *budget, struct sr_estimate *out);

/* ---- observers ---- */

/* What one watt at lambda [nm] counts in the system: 1, 683 V(lambda) lm/W, 1700.05 V'(lambda) lm/W, lambda / (h c N_A)
 * umol/J. */
double sr_observer_at(enum sr_system system, double lambda);
/* Estimates of X in all systems from what a path carries: X_system = INTEGRAL observer(lambda) X_e(lambda) dlambda,
 * where X = 683 X_e per nm, as everywhere on paths (so that the photopic one is the Y of sr_spectrum_to_xyz). */
void sr_observe(sr_spectrum X, const struct sr_wavelengths *w, double readings[SR_SYSTEM_COUNT]);
/* INTEGRAL observer(lambda) s(lambda) dlambda from lo to hi [nm] by trapezoids of 1 nm: luminous where s is in W/nm. */
double sr_observer_integral(enum sr_system system, const struct sr_spd *s, double lo, double hi);

#endif
