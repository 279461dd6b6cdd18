/* SPDX-License-Identifier: MIT */
/* Matrices of 4 x 4 in double: their products, inverses (elimination with pivots), and what directives make.
 *
 *     R = cos I + (1 - cos) k k^T + sin [k]x    (O. Rodrigues, 1840) */
#include "import/pbrt/matrix.h"

#include <string.h>

struct sr_matrix sr_matrix_identity(void)
{
    return (struct sr_matrix){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

struct sr_matrix sr_matrix_translate(const double d[3])
{
    return (struct sr_matrix){{{1, 0, 0, d[0]}, {0, 1, 0, d[1]}, {0, 0, 1, d[2]}, {0, 0, 0, 1}}};
}

struct sr_matrix sr_matrix_scale(const double s[3])
{
    return (struct sr_matrix){{{s[0], 0, 0, 0}, {0, s[1], 0, 0}, {0, 0, s[2], 0}, {0, 0, 0, 1}}};
}

static bool normalize(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; ++i)
        v[i] /= length;
    return length > 0;
}

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = a[j] * b[k] - a[k] * b[j];
    }
}

struct sr_matrix sr_matrix_rotate(double angle_deg, const double axis[3])
{
    double k[3] = {axis[0], axis[1], axis[2]};
    normalize(k);
    double turn = remainder(angle_deg, 360), quarter = turn / 90, angle = turn * (M_PI / 180);
    bool exact = quarter == nearbyint(quarter);
    double s = exact ? nearbyint(sin(angle)) : sin(angle), c = exact ? nearbyint(cos(angle)) : cos(angle);
    struct sr_matrix r = sr_matrix_identity();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double skew = i == j ? 0 : (j == (i + 1) % 3 ? -1 : 1) * k[3 - i - j];
            r.m[i][j] = (i == j ? c : 0) + (1 - c) * k[i] * k[j] + s * skew;
        }
    return r;
}

bool sr_matrix_look_at(const double eye[3], const double look[3], const double up[3], struct sr_matrix *out)
{
    double forward[3] = {look[0] - eye[0], look[1] - eye[1], look[2] - eye[2]}, u[3] = {up[0], up[1], up[2]}, right[3],
           upward[3];
    bool defined = normalize(forward) && normalize(u);
    cross(u, forward, right);
    defined &= sqrt(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]) > 1e-6;
    normalize(right);
    cross(forward, right, upward);
    const double *rows[3] = {right, upward, forward};
    *out = sr_matrix_identity();
    for (int i = 0; i < 3; ++i) {
        memcpy(out->m[i], rows[i], 3 * sizeof(double));
        out->m[i][3] = -(rows[i][0] * eye[0] + rows[i][1] * eye[1] + rows[i][2] * eye[2]);
    }
    return defined;
}

struct sr_matrix sr_matrix_multiply(const struct sr_matrix *a, const struct sr_matrix *b)
{
    struct sr_matrix c;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            c.m[i][j] = 0;
            for (int k = 0; k < 4; ++k)
                c.m[i][j] += a->m[i][k] * b->m[k][j];
        }
    return c;
}

struct sr_matrix sr_matrix_invert(const struct sr_matrix *matrix)
{
    double a[4][8] = {{0}};
    struct sr_matrix inverse;
    bool is_regular = true;
    for (int i = 0; i < 4; ++i) {
        memcpy(a[i], matrix->m[i], sizeof matrix->m[i]);
        a[i][4 + i] = 1;
    }
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int i = column + 1; i < 4; ++i)
            pivot = fabs(a[i][column]) > fabs(a[pivot][column]) ? i : pivot;
        is_regular &= fabs(a[pivot][column]) > 0 && isfinite(a[pivot][column]);
        double row[8];
        memcpy(row, a[pivot], sizeof row);
        memcpy(a[pivot], a[column], sizeof row);
        for (int j = 0; j < 8; ++j)
            a[column][j] = row[j] / row[column];
        for (int i = 0; i < 4; ++i) {
            double factor = i == column ? 0 : a[i][column];
            for (int j = 0; j < 8 && factor != 0; ++j)
                a[i][j] -= factor * a[column][j];
        }
    }
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            inverse.m[i][j] = is_regular ? a[i][4 + j] + 0 : (double)NAN; // + 0: no negative zeros
    return inverse;
}

struct sr_matrix sr_matrix_of(const struct sr_transform *t)
{
    struct sr_matrix a;
    for (int i = 0; i < 16; ++i)
        a.m[i / 4][i % 4] = (double)t->m[i / 4][i % 4];
    return a;
}

struct sr_transform sr_matrix_to_transform(const struct sr_matrix *a)
{
    struct sr_matrix inverse = sr_matrix_invert(a);
    struct sr_transform t;
    for (int i = 0; i < 16; ++i) {
        t.m[i / 4][i % 4] = (float)a->m[i / 4][i % 4];
        t.inverse[i / 4][i % 4] = (float)inverse.m[i / 4][i % 4];
    }
    return t;
}
