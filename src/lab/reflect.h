/* SPDX-License-Identifier: MIT */
/* Private to this room: what the two ways to a reflectance share. */
#ifndef SR_LAB_REFLECT_H
#define SR_LAB_REFLECT_H

#include "lab/lab.h"

/* A direction (z), or all directions within `half` of it, in polar coordinates about it: alpha from z, beta from x. */
struct lab_region {
    bool is_direction, is_hemisphere;
    double x[3], y[3], z[3]; // [1]
    double half;             // [rad]
    double projected;        // [sr]
};
sr_status sr_beam_check(const struct sr_beam *beam, struct sr_error *error);
struct lab_region sr_region_of(const struct sr_beam *beam);
void sr_region_direction(const struct lab_region *r, double alpha, double beta, double w[3]);
void sr_region_angles(const struct lab_region *r, const double w[3], double *alpha, double *beta);
bool sr_region_contains(const struct lab_region *r, const double w[3]);

void sr_reflectance_describe(const struct sr_beam *from, const struct sr_beam *to,
                             struct sr_reflectance *out); // all but the numbers
void sr_reflectance_factor(struct sr_reflectance *out);   // from the value

/* sr_reflectance_cubature in single precision, whether there is a twin or not. */
sr_status sr_reflectance_cubature_single(const struct sr_specimen *specimen, sr_spectrum lambda,
                                         const struct sr_beam *from, const struct sr_beam *to, double tolerance,
                                         struct sr_reflectance *out, struct sr_error *error);

#endif
