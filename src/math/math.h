/* SPDX-License-Identifier: MIT */
/* Vectors, frames, transforms, boxes, quadrature and statistics.
 *
 * Geometry has verbs (sr_dot, sr_add), light has operators (sr_spectrum): a radiance can never be added to a direction.
 */
#ifndef SR_MATH_MATH_H
#define SR_MATH_MATH_H

#include "base/base.h"

#include <math.h>

#define SR_PI 3.14159265358979323846f
#define SR_INV_PI 0.31830988618379067154f
#define SR_ONE_MINUS_EPSILON 0x1.fffffep-1f // the largest float below 1
#define SR_MACHINE_EPSILON 0x1p-24f         // half an ulp of 1

typedef struct sr_vec2 {
    float x, y;
} sr_vec2;
typedef struct sr_vec3 {
    float x, y, z;
} sr_vec3;

static inline float sr_sqr(float x)
{
    return x * x;
}
/* The lesser and the greater; b where a is not a number. (fminf and fmaxf promise more about NaN, and are calls.) */
static inline float sr_min(float a, float b)
{
    return a < b ? a : b;
}
static inline float sr_max(float a, float b)
{
    return a > b ? a : b;
}
static inline float sr_clamp(float x, float lo, float hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}
static inline float sr_lerp(float t, float a, float b)
{
    return (1 - t) * a + t * b;
}
static inline float sr_safe_sqrt(float x)
{
    return sqrtf(x > 0 ? x : 0);
}
static inline float sr_radians(float deg)
{
    return deg * (SR_PI / 180);
}
/* Higham's bound of n roundings: |error| <= gamma(n) |value|. */
static inline float sr_gamma(int n)
{
    return (float)n * SR_MACHINE_EPSILON / (1 - (float)n * SR_MACHINE_EPSILON);
}
/* a b - c d without the cancellation of the plain form (Kahan). */
static inline float sr_difference_of_products(float a, float b, float c, float d)
{
    float cd = c * d;
    return fmaf(a, b, -cd) + fmaf(-c, d, cd);
}

static inline sr_vec3 sr_add(sr_vec3 a, sr_vec3 b)
{
    return (sr_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline sr_vec3 sr_sub(sr_vec3 a, sr_vec3 b)
{
    return (sr_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline sr_vec3 sr_scale(float s, sr_vec3 a)
{
    return (sr_vec3){s * a.x, s * a.y, s * a.z};
}
static inline sr_vec3 sr_neg(sr_vec3 a)
{
    return (sr_vec3){-a.x, -a.y, -a.z};
}
static inline sr_vec3 sr_mad(sr_vec3 a, float s, sr_vec3 b) // a + s b
{
    return (sr_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline float sr_dot(sr_vec3 a, sr_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline sr_vec3 sr_cross(sr_vec3 a, sr_vec3 b)
{
    return (sr_vec3){sr_difference_of_products(a.y, b.z, a.z, b.y), sr_difference_of_products(a.z, b.x, a.x, b.z),
                     sr_difference_of_products(a.x, b.y, a.y, b.x)};
}
static inline float sr_length2(sr_vec3 a)
{
    return sr_dot(a, a);
}
static inline float sr_length(sr_vec3 a)
{
    return sqrtf(sr_dot(a, a));
}
static inline sr_vec3 sr_normalize(sr_vec3 a)
{
    return sr_scale(1 / sr_length(a), a);
}
static inline sr_vec3 sr_face_forward(sr_vec3 n, sr_vec3 v) // n, turned to the side of v
{
    return sr_dot(n, v) < 0 ? sr_neg(n) : n;
}
static inline float sr_max_component(sr_vec3 a)
{
    return sr_max(a.x, sr_max(a.y, a.z));
}
static inline float sr_component(sr_vec3 a, int axis)
{
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
static inline bool sr_is_finite(sr_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
/* The angle between two unit vectors [rad], accurate also near 0 and pi (Kahan). */
static inline float sr_angle_between(sr_vec3 a, sr_vec3 b)
{
    if (sr_dot(a, b) < 0)
        return SR_PI - 2 * asinf(sr_min(1, sr_length(sr_add(a, b)) / 2));
    return 2 * asinf(sr_min(1, sr_length(sr_sub(b, a)) / 2));
}

/* In a local frame the normal is z. */
static inline float sr_cos_theta(sr_vec3 w)
{
    return w.z;
}
static inline float sr_abs_cos_theta(sr_vec3 w)
{
    return fabsf(w.z);
}
static inline bool sr_same_hemisphere(sr_vec3 a, sr_vec3 b)
{
    return a.z * b.z > 0;
}

/* ---- frames: three orthonormal axes ---- */

struct sr_frame {
    sr_vec3 x, y, z;
};
/* Duff et al. 2017; z must be of unit length. */
static inline struct sr_frame sr_frame_from_z(sr_vec3 z)
{
    float sign = copysignf(1, z.z);
    float a = -1 / (sign + z.z);
    float b = z.x * z.y * a;
    return (struct sr_frame){
        .x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x},
        .y = {b, sign + z.y * z.y * a, -z.y},
        .z = z,
    };
}
struct sr_frame sr_frame_from_zx(sr_vec3 z, sr_vec3 x); // x is made orthogonal to z; falls back to from_z
static inline sr_vec3 sr_to_local(const struct sr_frame *f, sr_vec3 w)
{
    return (sr_vec3){sr_dot(w, f->x), sr_dot(w, f->y), sr_dot(w, f->z)};
}
static inline sr_vec3 sr_to_world(const struct sr_frame *f, sr_vec3 w)
{
    return sr_add(sr_add(sr_scale(w.x, f->x), sr_scale(w.y, f->y)), sr_scale(w.z, f->z));
}

/* ---- rays ---- */

struct sr_ray {
    sr_vec3 o;       // origin [m]
    sr_vec3 d;       // direction, unit length unless said otherwise
    float time;      // [1] share of the shutter interval
    float t_max;     // [m]
    bool is_outward; // it leaves a closed mesh, and goes away from what that encloses
};

/* ---- transforms: a matrix and its inverse, rows first, acting on column vectors ---- */

struct sr_transform {
    float m[4][4];
    float inverse[4][4];
};
struct sr_transform sr_transform_identity(void);
struct sr_transform sr_transform_from_matrix(const float m[4][4]); // inverse in double; check sr_transform_is_valid
struct sr_transform sr_transform_translate(sr_vec3 d);
struct sr_transform sr_transform_scale(sr_vec3 s);
struct sr_transform sr_transform_rotate(float angle_deg, sr_vec3 axis);
/* world to camera: the camera at eye looks along +z at look, y is up, x to the right (left-handed, as pbrt) */
struct sr_transform sr_transform_look_at(sr_vec3 eye, sr_vec3 look, sr_vec3 up);
struct sr_transform sr_transform_multiply(const struct sr_transform *a, const struct sr_transform *b); // a b
struct sr_transform sr_transform_invert(const struct sr_transform *t);
bool sr_transform_is_valid(const struct sr_transform *t); // finite, and its linear part invertible
bool sr_transform_is_identity(const struct sr_transform *t);
bool sr_transform_swaps_handedness(const struct sr_transform *t);
sr_vec3 sr_transform_point(const struct sr_transform *t, sr_vec3 p); // with division by w
sr_vec3 sr_transform_vector(const struct sr_transform *t, sr_vec3 v);
sr_vec3 sr_transform_normal(const struct sr_transform *t, sr_vec3 n); // by the inverse transpose; not normalised
sr_vec3 sr_inverse_point(const struct sr_transform *t, sr_vec3 p);
sr_vec3 sr_inverse_vector(const struct sr_transform *t, sr_vec3 v);
/* The point and a bound of its absolute error, given the error of p (may be zero). */
sr_vec3 sr_transform_point_error(const struct sr_transform *t, sr_vec3 p, sr_vec3 p_error, sr_vec3 *error);

/* ---- boxes ---- */

struct sr_box {
    sr_vec3 lo, hi;
};
struct sr_box sr_box_empty(void);
struct sr_box sr_box_add(struct sr_box b, sr_vec3 p);
struct sr_box sr_box_union(struct sr_box a, struct sr_box b);
struct sr_box sr_box_transform(const struct sr_transform *t, struct sr_box b);
bool sr_box_is_empty(struct sr_box b);
bool sr_box_contains(struct sr_box b, sr_vec3 p);
sr_vec3 sr_box_centre(struct sr_box b);
sr_vec3 sr_box_diagonal(struct sr_box b);
void sr_box_bounding_sphere(struct sr_box b, sr_vec3 *centre, float *radius);

/* ---- motion: a transform that changes while the shutter is open ---- */

struct sr_motion {
    struct sr_transform start, end;
    float begin, finish; // [1] shares of the shutter interval: before and after them it stands
    bool moves;          // start is not end
    double T[3], T_change[3], S[3][3], S_change[3][3], R[3][3], R_sine[3][3], R_versine[3][3], angle; // motion.c
};
/* false: there is no way between them, as one of them mirrors, or is no affine map. finish <= begin: it jumps. */
bool sr_motion_make(const struct sr_transform *start, const struct sr_transform *end, float begin, float finish,
                    struct sr_motion *out);
void sr_motion_at(const struct sr_motion *m, float time,
                  struct sr_transform *out); // time: share of the shutter interval
/* Holds all that moves in a box from time0 to time1. */
struct sr_box sr_motion_box(const struct sr_motion *m, struct sr_box box, float time0, float time1);

/* ---- a point of a surface, as geometry ---- */

struct sr_point {
    sr_vec3 p;                    // [m]
    sr_vec3 p_error;              // [m] bound of the rounding error of p, per axis
    sr_vec3 n;                    // [1] geometric normal: the side that counts as outside
    sr_vec3 ns;                   // [1] shading normal, on the side of n
    sr_vec3 dpdu, dpdv;           // [m] derivatives of p by the texture coordinates
    sr_vec3 dpdus;                // [m] shading tangent: gives the frame's x axis
    sr_vec3 dndu, dndv;           // [1] derivatives of the shading normal
    sr_vec2 uv;                   // [1] texture coordinates
    sr_vec3 dpdx, dpdy;           // [m] footprint: change of p from one pixel (or sample spacing) to the next
    float dudx, dudy, dvdx, dvdy; // [1] footprint in texture coordinates
    float time;                   // [1] share of the shutter interval
    int32_t face;                 // face index that the mesh gives, or 0
    int8_t outward; // of a closed mesh: 1: n points away from what it encloses; -1: toward it; 0: of nothing such
};
/* Whether w leads out of the closed mesh that x lies on. */
SR_INLINE bool sr_is_outward(const struct sr_point *x, sr_vec3 w)
{
    return sr_dot(w, x->n) * (float)x->outward > 0;
}

/* An origin for a ray that leaves x toward w: off the surface by no more than the error of p, never through it. */
SR_INLINE sr_vec3 sr_point_offset(const struct sr_point *x, sr_vec3 w)
{
    typedef float quad __attribute__((vector_size(16)));
    typedef int32_t quad_bits __attribute__((vector_size(16)));
    float d = fabsf(x->n.x) * x->p_error.x + fabsf(x->n.y) * x->p_error.y + fabsf(x->n.z) * x->p_error.z;
    quad offset = (sr_dot(w, x->n) < 0 ? -d : d) * (quad){x->n.x, x->n.y, x->n.z, 0};
    quad o = (quad){x->p.x, x->p.y, x->p.z, 0} + offset;
    // away from p by at least one more ulp, so that rounding never brings it back
    quad ulp = (quad)((quad_bits)o & INT32_MAX) * 0x1p-23f + 0x1p-126f;
    o += (quad)((quad_bits)ulp | ((quad_bits)offset & INT32_MIN));
    return (sr_vec3){o[0], o[1], o[2]};
}

/* ---- angles ---- */

/* Sine and cosine of x in -pi/4 … pi/4 [rad], by Taylor's series: off by less than 1e-7, the sine relative to itself.
 */
SR_INLINE void sr_sin_cos_eighth(float x, float *s, float *c)
{
    float x2 = x * x;
    *s = x + x * x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880))));
    *c = 1 + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
}
/* The same of a share of the whole turn in 0 … 1; less than half the price of sinf and cosf. */
SR_INLINE void sr_sin_cos_turn(float turn, float *s, float *c)
{
    int quarter = (int)(4 * turn + 0.5f);
    float x, y;
    sr_sin_cos_eighth((turn - 0.25f * (float)quarter) * (2 * SR_PI), &y, &x);
    bool odd = quarter & 1;
    float a = odd ? y : x, b = odd ? x : y;
    *c = (quarter + 1) & 2 ? -a : a;
    *s = quarter & 2 ? -b : b;
}
/* The arc tangent of x in 0 … 1 [rad], by a polynomial through the arc's Chebyshev points: off by less than 2e-7 of
 * itself. */
SR_INLINE float sr_atan_eighth(float x)
{
    float t = x * x, t2 = t * t, t4 = t2 * t2;
    return x *
           ((1 - 0.33333036f * t) + t2 * (0.19991872f - 0.14197798f * t) +
            t4 * ((0.10618371f - 0.07456855f * t) + t2 * (0.042137623f - 0.015731249f * t)) + t4 * t4 * 0.0027662835f);
}

/* The angle of (x, y) from the x axis in 0 … 2 pi [rad], off by less than 1e-6; 0 for (0, 0). */
SR_INLINE float sr_angle_of(float y, float x)
{
    float a = fabsf(x), b = fabsf(y), larger = a > b ? a : b, lesser = a > b ? b : a;
    float angle = sr_atan_eighth(larger > 0 ? lesser / larger : 0);
    angle = b > a ? SR_PI / 2 - angle : angle;
    angle = x < 0 ? SR_PI - angle : angle;
    return y < 0 ? 2 * SR_PI - angle : angle;
}

/* ---- spherical coordinates ---- */

static inline sr_vec3 sr_spherical_direction(float sin_theta, float cos_theta, float phi)
{
    return (sr_vec3){sin_theta * cosf(phi), sin_theta * sinf(phi), cos_theta};
}
/* Equal-area map of the square [0,1]^2 to the sphere and back (Clarberg 2008): octahedral, the layout of pbrt's
 * environment images. (0.5,0.5) is +z, the corners are -z. */
sr_vec3 sr_equal_area_square_to_sphere(sr_vec2 p);
sr_vec2 sr_equal_area_sphere_to_square(sr_vec3 d);

/* ---- noise ---- */

/* Perlin's gradient noise of 2002, pbrt's: about -1 … 1, 0 at all whole numbers, repeats after 256. */
float sr_noise(sr_vec3 p);
/* The sum of octaves of noise, each of 1.99 times the frequency and omega times the height of the one before; dpdx,
 * dpdy: the footprint, below which no octave is drawn (zero: all are). turbulence adds the octaves' absolute values. */
float sr_fbm(sr_vec3 p, sr_vec3 dpdx, sr_vec3 dpdy, float omega, int octaves);
float sr_turbulence(sr_vec3 p, sr_vec3 dpdx, sr_vec3 dpdy, float omega, int octaves);

/* ---- quadrature ---- */

/* Nodes and weights of n-point Gauss-Legendre quadrature on [a, b]. n <= 512. */
void sr_gauss_legendre(int n, double a, double b, double *x, double *w);

/* ---- statistics ---- */

/* Count, mean and sum of squared deviations (Welford); two tallies merge (Chan). Zeroed = empty. */
struct sr_tally {
    uint64_t n;
    double mean, m2, max;
};
void sr_tally_add(struct sr_tally *t, double x);
void sr_tally_merge(struct sr_tally *t, const struct sr_tally *other);
double sr_tally_variance(const struct sr_tally *t);       // of one draw, unbiased
double sr_tally_standard_error(const struct sr_tally *t); // of the mean

double sr_normal_p_two_sided(double z);
double sr_normal_quantile(double p);
double sr_student_p_two_sided(double t, double degrees);
double sr_student_quantile(double p, double degrees); // p in (0, 1): 0.975 for a two-sided 95 % interval
double sr_chi2_p(double chi2, double degrees);        // probability of a larger value
double sr_incomplete_gamma_upper(double a, double x); // Q(a, x), regularised
double sr_incomplete_beta(double a, double b, double x);

/* Pearson's test of counts against expectations; cells expecting fewer than min_expected are pooled. Returns the
 * p-value; 0 when something was drawn where nothing was expected. */
double sr_chi2_test(const double *observed, const double *expected, size_t cells, double min_expected, double *chi2,
                    int *degrees);

#endif
