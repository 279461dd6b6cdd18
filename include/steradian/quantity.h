/* SPDX-License-Identifier: MIT */
/* Measured quantities: a value with its standard uncertainty, degrees of freedom and unit, as the GUM reports them. */
#ifndef STERADIAN_QUANTITY_H
#define STERADIAN_QUANTITY_H

#include "base.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* In what light is counted. */
enum sr_system {
    SR_RADIOMETRIC, /* W */
    SR_PHOTOPIC,    /* lm, V(lambda), CIE 1924 */
    SR_SCOTOPIC,    /* lm, V'(lambda), CIE 1951 */
    SR_CONES_2,     /* lm, V_F(lambda) of 2 degrees, CIE 170-2:2015 */
    SR_CONES_10,    /* lm, V_F(lambda) of 10 degrees, CIE 170-2:2015 */
    SR_PHOTON,      /* umol/s, of all wavelengths */
    SR_PAR,         /* umol/s, of 400 … 700 nm: what plants use */
    SR_SYSTEM_COUNT
};

/* A unit as powers: of flux in each system, and of s, m, sr and nm. Zeroed: the number 1. */
struct sr_unit {
    int8_t flux[SR_SYSTEM_COUNT];
    int8_t second, metre, steradian, nanometre;
};

struct sr_quantity {
    double value;   /* [unit] */
    double u;       /* [unit] standard uncertainty; NaN: not known */
    double degrees; /* [1] of freedom of u, for Student's interval; infinity: u is known exactly */
    double upper;   /* [unit] one-sided bound of 95 %, where value is 0 because nothing was found; 0: does not apply */
    struct sr_unit unit;
};

/* k u, half the width of the interval that covers the truth with that probability (Student). [unit] */
SR_API double sr_quantity_expanded(const struct sr_quantity *q, double level /* [1] such as 0.95 */);
/* "lx", "cd/m^2", "scotopic lx", "W/(m^2 sr nm)", "umol/(m^2 s)"; cut off at size. Returns text. */
SR_API char *sr_unit_text(struct sr_unit unit, char *text, size_t size);
/* "E = 19.894 lx ± 0.021 lx (95 %, k = 2.13, ν = 15)" in UTF-8, rounded to what the uncertainty supports; NULL name:
 * from the value on. Returns text. */
SR_API char *sr_quantity_text(const char *name, const struct sr_quantity *q, char *text, size_t size);

#ifdef __cplusplus
}
#endif

#endif
