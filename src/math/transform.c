/* SPDX-License-Identifier: MIT */
/* Transforms of points, vectors and normals: a 4 x 4 matrix beside its inverse.
 *
 *     p' = M p / w,    v' = L v,    n' = L^-T n,
 *         |error of p'| <= gamma(3) (|L| |p| + |t|) + (1 + gamma(3)) |L| |error of p|
 *
 * L is the linear part, t the translation. Inverses are made in double by elimination with pivots. The error bound
 * follows N. Higham, Accuracy and Stability of Numerical Algorithms, 2002, 3.1; it takes the matrix as exact and as
 * affine. */
#include "math/math.h"

#include <string.h>

static void to_double(const float m[4][4], double d[4][4])
{
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            d[i][j] = (double)m[i][j];
}

static void to_float(const double m[4][4], float f[4][4])
{
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            f[i][j] = (float)m[i][j];
}

static void swap_rows(double a[4], double b[4])
{
    for (int j = 0; j < 4; ++j) {
        double t = a[j];
        a[j] = b[j];
        b[j] = t;
    }
}

// Gauss-Jordan; a is consumed; false when singular
static bool invert(double a[4][4], double inverse[4][4])
{
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            inverse[i][j] = i == j;
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int i = column + 1; i < 4; ++i)
            if (fabs(a[i][column]) > fabs(a[pivot][column]))
                pivot = i;
        if (!(fabs(a[pivot][column]) > 0) || !isfinite(a[pivot][column]))
            return false;
        if (pivot != column) {
            swap_rows(a[pivot], a[column]);
            swap_rows(inverse[pivot], inverse[column]);
        }
        double scale = 1 / a[column][column];
        for (int j = 0; j < 4; ++j) {
            a[column][j] *= scale;
            inverse[column][j] *= scale;
        }
        for (int i = 0; i < 4; ++i) {
            double factor = a[i][column];
            if (i == column || factor == 0)
                continue;
            for (int j = 0; j < 4; ++j) {
                a[i][j] -= factor * a[column][j];
                inverse[i][j] -= factor * inverse[column][j];
            }
        }
    }
    return true;
}

// the transform of a matrix in double; where there is no inverse, NaN stands in its place
static struct sr_transform from_double(const double m[4][4])
{
    struct sr_transform t;
    double a[4][4], inverse[4][4];
    memcpy(a, m, sizeof a);
    to_float(m, t.m);
    if (!invert(a, inverse))
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                inverse[i][j] = (double)NAN;
    to_float(inverse, t.inverse);
    return t;
}

struct sr_transform sr_transform_identity(void)
{
    return sr_transform_scale((sr_vec3){1, 1, 1});
}

struct sr_transform sr_transform_from_matrix(const float m[4][4])
{
    double d[4][4];
    to_double(m, d);
    return from_double(d);
}

struct sr_transform sr_transform_translate(sr_vec3 d)
{
    return (struct sr_transform){
        .m = {{1, 0, 0, d.x}, {0, 1, 0, d.y}, {0, 0, 1, d.z}, {0, 0, 0, 1}},
        .inverse = {{1, 0, 0, -d.x}, {0, 1, 0, -d.y}, {0, 0, 1, -d.z}, {0, 0, 0, 1}},
    };
}

struct sr_transform sr_transform_scale(sr_vec3 s)
{
    return (struct sr_transform){
        .m = {{s.x, 0, 0, 0}, {0, s.y, 0, 0}, {0, 0, s.z, 0}, {0, 0, 0, 1}},
        .inverse = {{1 / s.x, 0, 0, 0}, {0, 1 / s.y, 0, 0}, {0, 0, 1 / s.z, 0}, {0, 0, 0, 1}},
    };
}

// O. Rodrigues, 1840: R = cos I + (1 - cos) k k^T + sin [k]x
struct sr_transform sr_transform_rotate(float angle_deg, sr_vec3 axis)
{
    double k[3] = {(double)axis.x, (double)axis.y, (double)axis.z};
    double length = sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]);
    for (int i = 0; i < 3; ++i)
        k[i] /= length;

    // quarter turns come out exact
    double turn = remainder((double)angle_deg, 360), quarter = turn / 90;
    double angle = turn * (M_PI / 180);
    bool exact = quarter == nearbyint(quarter);
    double s = exact ? nearbyint(sin(angle)) : sin(angle), c = exact ? nearbyint(cos(angle)) : cos(angle);

    struct sr_transform t = {.m = {[3] = {0, 0, 0, 1}}, .inverse = {[3] = {0, 0, 0, 1}}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            double skew = i == j ? 0 : (j == (i + 1) % 3 ? -1 : 1) * k[3 - i - j];
            double r = (i == j ? c : 0) + (1 - c) * k[i] * k[j] + s * skew;
            t.m[i][j] = t.inverse[j][i] = (float)r;
        }
    }
    return t;
}

static bool normalize(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; ++i)
        v[i] /= length;
    return length > 1e-7;
}

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = a[j] * b[k] - a[k] * b[j];
    }
}

struct sr_transform sr_transform_look_at(sr_vec3 eye, sr_vec3 look, sr_vec3 up)
{
    double e[3] = {(double)eye.x, (double)eye.y, (double)eye.z};
    double forward[3] = {(double)look.x - e[0], (double)look.y - e[1], (double)look.z - e[2]};
    double u[3] = {(double)up.x, (double)up.y, (double)up.z}, right[3], upward[3];
    normalize(forward);
    normalize(u);
    cross(u, forward, right);
    bool defined = normalize(right);
    cross(forward, right, upward);

    double world_from_camera[4][4] = {[3] = {0, 0, 0, 1}};
    for (int i = 0; i < 3; ++i) {
        world_from_camera[i][0] = defined ? right[i] : (double)NAN;
        world_from_camera[i][1] = upward[i];
        world_from_camera[i][2] = forward[i];
        world_from_camera[i][3] = e[i];
    }
    struct sr_transform t = from_double(world_from_camera);
    return sr_transform_invert(&t);
}

static void multiply(const float a[4][4], const float b[4][4], float c[4][4])
{
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            double sum = 0;
            for (int k = 0; k < 4; ++k)
                sum += (double)a[i][k] * (double)b[k][j];
            c[i][j] = (float)sum;
        }
    }
}

struct sr_transform sr_transform_multiply(const struct sr_transform *a, const struct sr_transform *b)
{
    struct sr_transform t;
    multiply(a->m, b->m, t.m);
    multiply(b->inverse, a->inverse, t.inverse);
    return t;
}

struct sr_transform sr_transform_invert(const struct sr_transform *t)
{
    struct sr_transform inverse;
    memcpy(inverse.m, t->inverse, sizeof inverse.m);
    memcpy(inverse.inverse, t->m, sizeof inverse.inverse);
    return inverse;
}

static double determinant(const struct sr_transform *t)
{
    double m[4][4];
    to_double(t->m, m);
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

bool sr_transform_is_valid(const struct sr_transform *t)
{
    double size = 1; // product of the rows' lengths: Hadamard's bound of the determinant
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j)
            if (!isfinite(t->m[i][j]) || !isfinite(t->inverse[i][j]))
                return false;
        if (i < 3)
            size *= hypot(hypot((double)t->m[i][0], (double)t->m[i][1]), (double)t->m[i][2]);
    }
    return fabs(determinant(t)) > 1e-12 * size;
}

bool sr_transform_is_identity(const struct sr_transform *t)
{
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            if (t->m[i][j] != (i == j ? 1.0f : 0.0f))
                return false;
    return true;
}

bool sr_transform_swaps_handedness(const struct sr_transform *t)
{
    return determinant(t) < 0;
}

static sr_vec3 apply_to_vector(const float m[4][4], sr_vec3 v)
{
    return (sr_vec3){m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                     m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

static sr_vec3 apply_to_point(const float m[4][4], sr_vec3 p)
{
    sr_vec3 q = sr_add(apply_to_vector(m, p), (sr_vec3){m[0][3], m[1][3], m[2][3]});
    float w = m[3][0] * p.x + m[3][1] * p.y + m[3][2] * p.z + m[3][3];
    return w == 1 ? q : (sr_vec3){q.x / w, q.y / w, q.z / w};
}

sr_vec3 sr_transform_point(const struct sr_transform *t, sr_vec3 p)
{
    return apply_to_point(t->m, p);
}

sr_vec3 sr_transform_vector(const struct sr_transform *t, sr_vec3 v)
{
    return apply_to_vector(t->m, v);
}

sr_vec3 sr_transform_normal(const struct sr_transform *t, sr_vec3 n)
{
    const float(*m)[4] = t->inverse;
    return (sr_vec3){m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z, m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
                     m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
}

sr_vec3 sr_inverse_point(const struct sr_transform *t, sr_vec3 p)
{
    return apply_to_point(t->inverse, p);
}

sr_vec3 sr_inverse_vector(const struct sr_transform *t, sr_vec3 v)
{
    return apply_to_vector(t->inverse, v);
}

sr_vec3 sr_transform_point_error(const struct sr_transform *t, sr_vec3 p, sr_vec3 p_error, sr_vec3 *error)
{
    float bound[3], gamma4 = sr_gamma(4); // a product, two sums, and that with the translation
    for (int i = 0; i < 3; ++i) {
        const float *row = t->m[i];
        float size = fabsf(row[0] * p.x) + fabsf(row[1] * p.y) + fabsf(row[2] * p.z) + fabsf(row[3]);
        float carried = fabsf(row[0]) * p_error.x + fabsf(row[1]) * p_error.y + fabsf(row[2]) * p_error.z;
        bound[i] = gamma4 * size + (1 + gamma4) * carried;
    }
    *error = (sr_vec3){bound[0], bound[1], bound[2]};
    return apply_to_point(t->m, p);
}
