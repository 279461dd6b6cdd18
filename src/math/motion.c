/* SPDX-License-Identifier: MIT */
/* A transform that changes while the shutter is open: moved, turned and stretched evenly between its two ends.
 *
 *     M = T R S,      M(x) = T(x) R(x) S(x),      T(x) = (1 - x) T0 + x T1,    S(x) = (1 - x) S0 + x S1,
 *     R(x) = (1 + sin(x theta) K + (1 - cos(x theta)) K^2) R0,       x = (time - begin) / (finish - begin), in 0 … 1
 *
 * R is the rotation nearest to M's linear part and S = R^T M the symmetric rest (polar decomposition: N. Higham, 1986);
 * where M mirrors, S does, all of it. K is the cross product with the axis of R1 R0^T, the shorter way round, as slerp
 * has it (K. Shoemake, Animating rotation with quaternion curves, 1985); the decomposition is that of Shoemake & Duff,
 * 1992. Limits: both ends mirror or neither does; turns of more than half a circle cannot be told from what is left of
 * them. */
#include "math/math.h"

#include <string.h>

static void multiply(const double a[3][3], const double b[3][3], double c[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

static void transpose(const double a[3][3], double t[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            t[i][j] = a[j][i];
}

// the transposed inverse; 0: there is none
static double cofactors(const double a[3][3], double c[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
            c[i][j] = a[k][m] * a[l][n] - a[k][n] * a[l][m];
        }
    double determinant = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            c[i][j] /= determinant;
    return determinant;
}

// M = R S, R a rotation; false where M has no inverse
static bool decompose(const struct sr_transform *t, double T[3], double R[3][3], double S[3][3])
{
    double M[3][3], other[3][3];
    for (int i = 0; i < 3; ++i) {
        T[i] = (double)t->m[i][3];
        for (int j = 0; j < 3; ++j)
            M[i][j] = (double)t->m[i][j];
    }
    memcpy(R, M, sizeof M);
    double change = INFINITY;
    for (int step = 0; step < 100 && change > 1e-15; ++step) {
        double determinant = cofactors((const double(*)[3])R, other);
        if (!(fabs(determinant) > 0) || !isfinite(determinant))
            return false;
        change = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                double next = 0.5 * (R[i][j] + other[i][j]);
                change = fmax(change, fabs(next - R[i][j]));
                R[i][j] = next;
            }
    }
    if (cofactors((const double(*)[3])R, other) < 0)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                R[i][j] = -R[i][j];
    transpose((const double(*)[3])R, other);
    multiply((const double(*)[3])other, (const double(*)[3])M, S);
    return true;
}

// axis of unit length and angle in 0 … pi of a rotation
static double axis_of(const double D[3][3], double k[3])
{
    double v[3] = {D[2][1] - D[1][2], D[0][2] - D[2][0], D[1][0] - D[0][1]}; // 2 sin(theta) k
    double sine = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), cosine = D[0][0] + D[1][1] + D[2][2] - 1;
    memcpy(k, v, sizeof v);
    if (cosine < 0) { // the symmetric part knows it better: (D + D^T) / 2 - cos(theta) = (1 - cos(theta)) k k^T
        int c = D[0][0] > D[1][1] ? (D[0][0] > D[2][2] ? 0 : 2) : (D[1][1] > D[2][2] ? 1 : 2);
        for (int i = 0; i < 3; ++i)
            k[i] = 0.5 * (D[i][c] + D[c][i]) - (i == c ? 0.5 * cosine : 0);
        double along = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
        if (along < 0)
            for (int i = 0; i < 3; ++i)
                k[i] = -k[i];
    }
    double length = sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]);
    for (int i = 0; i < 3; ++i)
        k[i] = length > 0 ? k[i] / length : i == 2;
    return atan2(sine, cosine);
}

static bool is_affine(const struct sr_transform *t)
{
    return t->m[3][0] == 0 && t->m[3][1] == 0 && t->m[3][2] == 0 && t->m[3][3] == 1;
}

bool sr_motion_make(const struct sr_transform *start, const struct sr_transform *end, float begin, float finish,
                    struct sr_motion *out)
{
    *out = (struct sr_motion){.start = *start, .end = *end, .begin = begin, .finish = finish};
    out->moves = memcmp(start->m, end->m, sizeof start->m) != 0;
    double R0[3][3], R1[3][3], S1[3][3], T1[3], inverse[3][3], D[3][3], k[3];
    if (!out->moves)
        return true;
    if (!is_affine(start) || !is_affine(end) || !decompose(start, out->T, R0, out->S) || !decompose(end, T1, R1, S1) ||
        sr_transform_swaps_handedness(start) != sr_transform_swaps_handedness(end))
        return false;
    transpose((const double(*)[3])R0, inverse);
    multiply((const double(*)[3])R1, (const double(*)[3])inverse, D);
    out->angle = axis_of((const double(*)[3])D, k);
    const double K[3][3] = {{0, -k[2], k[1]}, {k[2], 0, -k[0]}, {-k[1], k[0], 0}};
    memcpy(out->R, R0, sizeof R0);
    multiply(K, (const double(*)[3])R0, out->R_sine);
    multiply(K, (const double(*)[3])out->R_sine, out->R_versine);
    for (int i = 0; i < 3; ++i) {
        out->T_change[i] = T1[i] - out->T[i];
        for (int j = 0; j < 3; ++j)
            out->S_change[i][j] = S1[i][j] - out->S[i][j];
    }
    return true;
}

// x in 0 … 1 of the way
static double way(const struct sr_motion *m, float time)
{
    double length = (double)m->finish - (double)m->begin;
    return time <= m->begin ? 0 : time >= m->finish ? 1 : ((double)time - (double)m->begin) / length;
}

static void rotation(const struct sr_motion *m, double x, double R[3][3])
{
    double s = sin(0.5 * x * m->angle), c = cos(0.5 * x * m->angle), sine = 2 * s * c, versine = 2 * s * s;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            R[i][j] = m->R[i][j] + sine * m->R_sine[i][j] + versine * m->R_versine[i][j];
}

static void stretch(const struct sr_motion *m, double x, double S[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            S[i][j] = m->S[i][j] + x * m->S_change[i][j];
}

void sr_motion_at(const struct sr_motion *m, float time, struct sr_transform *out)
{
    double x = m->moves ? way(m, time) : 0;
    if (x <= 0 || x >= 1) {
        *out = x <= 0 ? m->start : m->end;
        return;
    }
    double R[3][3], S[3][3], L[3][3], inverse[3][3], T[3]; // inverse: transposed
    rotation(m, x, R);
    stretch(m, x, S);
    multiply((const double(*)[3])R, (const double(*)[3])S, L);
    cofactors((const double(*)[3])L, inverse);
    for (int i = 0; i < 3; ++i)
        T[i] = m->T[i] + x * m->T_change[i];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            out->m[i][j] = (float)L[i][j];
            out->inverse[i][j] = (float)inverse[j][i];
        }
        out->m[i][3] = (float)T[i];
        out->inverse[i][3] = (float)-(inverse[0][i] * T[0] + inverse[1][i] * T[1] + inverse[2][i] * T[2]);
        out->m[3][i] = out->inverse[3][i] = 0;
    }
    out->m[3][3] = out->inverse[3][3] = 1;
}

static double length_of_product(const double a[3][3], const double v[3])
{
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        sum += pow(a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2], 2);
    return sqrt(sum);
}

/* Corners go along curves p(x); between two places h apart a curve is off its chord by at most h^2 / 8 max |p''|, and
 * |p''| <= theta^2 |S c| + 2 theta |S' c|, for T'' = S'' = 0. */
struct sr_box sr_motion_box(const struct sr_motion *m, struct sr_box box, float time0, float time1)
{
    if (!m->moves)
        return sr_box_transform(&m->start, box);
    double x0 = way(m, time0), x1 = way(m, time1), S0[3][3], S1[3][3], bend = 0;
    int steps = 1 + (int)(20 * m->angle * (x1 - x0));
    double h = (x1 - x0) / steps;
    stretch(m, x0, S0);
    stretch(m, x1, S1);
    struct sr_box all = sr_box_empty();
    for (int corner = 0; corner < 8; ++corner) {
        double c[3] = {(double)(corner & 1 ? box.hi.x : box.lo.x), (double)(corner & 2 ? box.hi.y : box.lo.y),
                       (double)(corner & 4 ? box.hi.z : box.lo.z)};
        double size = fmax(length_of_product((const double(*)[3])S0, c), length_of_product((const double(*)[3])S1, c));
        bend = fmax(bend, m->angle * (m->angle * size + 2 * length_of_product((const double(*)[3])m->S_change, c)));
        for (int step = 0; step <= steps; ++step) {
            double R[3][3], S[3][3], x = x0 + h * step, q[3], p[3];
            rotation(m, x, R);
            stretch(m, x, S);
            for (int i = 0; i < 3; ++i)
                q[i] = S[i][0] * c[0] + S[i][1] * c[1] + S[i][2] * c[2];
            for (int i = 0; i < 3; ++i)
                p[i] = m->T[i] + x * m->T_change[i] + R[i][0] * q[0] + R[i][1] * q[1] + R[i][2] * q[2];
            all = sr_box_add(all, (sr_vec3){(float)p[0], (float)p[1], (float)p[2]});
        }
    }
    // and the roundings of whoever moves a point by sr_motion_at
    sr_vec3 lo = all.lo, hi = all.hi;
    float largest = sr_max(sr_max_component((sr_vec3){fabsf(lo.x), fabsf(lo.y), fabsf(lo.z)}),
                           sr_max_component((sr_vec3){fabsf(hi.x), fabsf(hi.y), fabsf(hi.z)}));
    float pad = (float)(bend * h * h / 8) * (1 + 1e-5f) + 16 * SR_MACHINE_EPSILON * largest;
    sr_vec3 by = {pad, pad, pad};
    return (struct sr_box){sr_sub(lo, by), sr_add(hi, by)};
}
