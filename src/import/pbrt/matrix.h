/* SPDX-License-Identifier: MIT */
/* Transforms while a description is read: in double, so that what stands far from the origin keeps its place. */
#ifndef SR_IMPORT_PBRT_MATRIX_H
#define SR_IMPORT_PBRT_MATRIX_H

#include "math/math.h"

/* Rows first, acting on column vectors. Affine or not; translations in m. */
struct sr_matrix {
    double m[4][4];
};
struct sr_matrix sr_matrix_identity(void);
struct sr_matrix sr_matrix_translate(const double d[3]);
struct sr_matrix sr_matrix_scale(const double s[3]);
struct sr_matrix sr_matrix_rotate(double angle_deg, const double axis[3]); // quarter turns are exact
/* World to camera, as sr_transform_look_at; false: the view has no direction, or up is along it. */
bool sr_matrix_look_at(const double eye[3], const double look[3], const double up[3], struct sr_matrix *out);
struct sr_matrix sr_matrix_multiply(const struct sr_matrix *a, const struct sr_matrix *b); // a b
struct sr_matrix sr_matrix_invert(const struct sr_matrix *a); // NaN where there is no inverse
struct sr_matrix sr_matrix_of(const struct sr_transform *t);
struct sr_transform sr_matrix_to_transform(const struct sr_matrix *a); // rounded once

#endif
