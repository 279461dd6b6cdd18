/* SPDX-License-Identifier: MIT */
/* What sphere, disk and cylinder share: object space in double, and the way from there to the world. Private to the
 * room. */
#ifndef SR_SHAPE_QUADRIC_H
#define SR_SHAPE_QUADRIC_H

#include "shape/shape.h"

typedef struct sr_dvec3 {
    double x, y, z;
} sr_dvec3;

static inline double sr_ddot(sr_dvec3 a, sr_dvec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline sr_dvec3 sr_dscale(double s, sr_dvec3 a)
{
    return (sr_dvec3){s * a.x, s * a.y, s * a.z};
}
static inline sr_dvec3 sr_dvec(sr_vec3 a)
{
    return (sr_dvec3){(double)a.x, (double)a.y, (double)a.z};
}
static inline sr_vec3 sr_dround(sr_dvec3 a)
{
    return (sr_vec3){(float)a.x, (float)a.y, (float)a.z};
}
/* A v + w c of the rows [A c]. */
static inline sr_dvec3 sr_affine(const double m[3][4], sr_dvec3 v, double w)
{
    return (sr_dvec3){m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z + m[0][3] * w,
                      m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z + m[1][3] * w,
                      m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z + m[2][3] * w};
}

/* A point in object space: position, unit normal (outside as built), derivatives by u and v. */
struct sr_quadric_point {
    sr_dvec3 p, n, dpdu, dpdv, dndu, dndv;
    sr_vec2 uv;
};

/* Checks that the transform is affine and invertible, and derives what is needed of it. */
sr_status sr_quadric_place(struct sr_shape_quadric *q, const char *name, const struct sr_shape_placement *placement,
                           bool *flip_normals, struct sr_error *error);
/* Checks and clamps phi_max to 0 … 360 deg; returns radians. */
sr_status sr_quadric_angle(const char *name, float phi_max_deg, float *phi_max_rad, struct sr_error *error);
/* The box of the ellipse or ellipsoid around centre with the object half axes, widened by rounding; is_box: of the
 * cylinder instead. */
struct sr_box sr_quadric_box(const struct sr_shape_quadric *q, sr_dvec3 centre, sr_dvec3 half, bool is_box);
struct sr_box sr_quadric_box_outward(sr_dvec3 lo, sr_dvec3 hi);

void sr_quadric_surface(const struct sr_shape_quadric *q, const struct sr_quadric_point *o, struct sr_point *x);
/* p, p_error, n and ns alone, of the point p with normal n in object space. */
void sr_quadric_bare_surface(const struct sr_shape_quadric *q, sr_dvec3 p, sr_dvec3 n, struct sr_point *x);
/* World area over object area where the object's unit normal is n: |det| |M^-T n|. */
double sr_quadric_area_scale(const struct sr_shape_quadric *q, sr_dvec3 n);
/* Fills s from a point drawn with density pdf_object by area in object space [1/m^2]; false if it cannot be used. */
bool sr_quadric_sample(const struct sr_shape_quadric *q, sr_dvec3 p, sr_dvec3 n, sr_vec2 uv, double pdf_object,
                       const struct sr_point *reference, struct sr_shape_sample *s);
float sr_quadric_pdf(const struct sr_shape_quadric *q, sr_dvec3 n, double pdf_object, const struct sr_point *reference,
                     const struct sr_point *there);

/* phi of (x, y) in [0, 2 pi). */
static inline double sr_quadric_phi(double x, double y)
{
    double phi = atan2(y, x);
    return phi < 0 ? phi + 2 * 3.14159265358979323846 : phi;
}
static inline float sr_quadric_phif(double x, double y)
{
    return sr_angle_of((float)y, (float)x);
}

/* Roots t0 <= t1 of a t^2 + 2 b t + c = 0, given b^2 - a c without cancellation. */
static inline bool sr_quadric_roots(double a, double b, double c, double discriminant, double t[2])
{
    if (!(discriminant >= 0) || a == 0)
        return false;
    double q = -(b + copysign(sqrt(discriminant), b));
    double t0 = q / a, t1 = q != 0 ? c / q : t0;
    t[0] = t0 < t1 ? t0 : t1;
    t[1] = t0 < t1 ? t1 : t0;
    return true;
}

#endif
