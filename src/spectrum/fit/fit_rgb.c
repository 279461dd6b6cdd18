/* SPDX-License-Identifier: MIT */
/* Fits the tables that turn RGB into smooth spectra; runs once, while the library is built.
 *
 *     s(t) = 1/2 + x / (2 sqrt(1 + x^2)),   x = a t^2 + b t + c,   t = (lambda - 360 nm) / 470 nm
 *
 * For each RGB of a grid it seeks a, b, c such that the colour of s under the space's illuminant is RGB:
 * Gauss-Newton on the difference in CIELAB, by 1 nm sums over the CIE 1931 observer. The grid: which component is
 * largest; that component z at knots smoothstep(smoothstep(k / 63)); the other two divided by z at 64 even knots.
 * W. Jakob and J. Hanika, A Low-Dimensional Function Space for Efficient Spectral Upsampling, 2019.
 *
 * Colours that no reflectance can have end at the nearest the method finds, with |a|, |b|, |c| <= 200. */
#include "spectrum/data.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LANES 8
#define BLOCKS 59   // 59 * 8 = 472 >= 471 wavelengths
#define LIMIT 200.0 // of the coefficients: the edge of a spectrum is then about 2 nm wide
#define GOOD 1e-8   // [ΔE^2] squared difference that counts as none
#define ITERATIONS 30
#define START 32 // the brightness knot where each column begins

typedef float lanes __attribute__((vector_size(LANES * sizeof(float))));

struct problem {
    lanes weight[3][BLOCKS]; // observer times illuminant [1]; sums to the white's XYZ with Y = 1
    lanes t[BLOCKS];
    double white[3];
    double xyz_from_rgb[3][3];
    struct sr_rgb_table *table;
    int next; // row to be done next
    pthread_mutex_t lock;
};

struct fit {
    double c[3];   // a, b, c
    double lab[3]; // of the spectrum's colour
    double jacobian[3][3];
    double error; // [ΔE^2]
};

static double smoothstep(double x)
{
    return x * x * (3 - 2 * x);
}

// CIELAB's compression and its slope
static double compress(double t, double *slope)
{
    const double edge = 6.0 / 29;
    if (t > edge * edge * edge) {
        double root = cbrt(t);
        *slope = root / (3 * t);
        return root;
    }
    *slope = 1 / (3 * edge * edge);
    return t / (3 * edge * edge) + 4.0 / 29;
}

// CIELAB of XYZ, and the matrix of its derivatives
static void cielab(const double white[3], const double xyz[3], double lab[3], double d[3][3])
{
    double f[3], slope[3];
    for (int i = 0; i < 3; ++i) {
        f[i] = compress(xyz[i] / white[i], &slope[i]);
        slope[i] /= white[i];
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
    double D[3][3] = {
        {0, 116 * slope[1], 0}, {500 * slope[0], -500 * slope[1], 0}, {0, 200 * slope[1], -200 * slope[2]}};
    memcpy(d, D, sizeof(D));
}

static double sum(lanes v)
{
    return ((double)v[0] + (double)v[4]) + ((double)v[1] + (double)v[5]) +
           (((double)v[2] + (double)v[6]) + ((double)v[3] + (double)v[7]));
}

// colour of the spectrum, its derivatives by a, b, c, and the distance to the target
static void look(const struct problem *p, const double target[3], struct fit *fit)
{
    lanes zero = {0}, xyz[3] = {zero, zero, zero},
          d[3][3] = {{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    lanes a = zero + (float)fit->c[0], b = zero + (float)fit->c[1], c = zero + (float)fit->c[2];
    for (int i = 0; i < BLOCKS; ++i) {
        lanes t = p->t[i];
        lanes x = (a * t + b) * t + c;
        lanes root = 1.0f + x * x;
        for (int k = 0; k < LANES; ++k)
            root[k] = sqrtf(root[k]);
        lanes inverse = 0.5f / root;
        lanes s = 0.5f + x * inverse;
        lanes ds = inverse / (1.0f + x * x), dst = ds * t, dstt = dst * t; // by c, b, a
        for (int k = 0; k < 3; ++k) {
            lanes w = p->weight[k][i];
            xyz[k] += w * s;
            d[k][0] += w * dstt;
            d[k][1] += w * dst;
            d[k][2] += w * ds;
        }
    }
    double value[3], by[3][3], lab_by_xyz[3][3];
    for (int k = 0; k < 3; ++k) {
        value[k] = sum(xyz[k]);
        for (int j = 0; j < 3; ++j)
            by[k][j] = sum(d[k][j]);
    }
    cielab(p->white, value, fit->lab, lab_by_xyz);
    fit->error = 0;
    for (int i = 0; i < 3; ++i) {
        fit->error += (target[i] - fit->lab[i]) * (target[i] - fit->lab[i]);
        for (int j = 0; j < 3; ++j)
            fit->jacobian[i][j] =
                lab_by_xyz[i][0] * by[0][j] + lab_by_xyz[i][1] * by[1][j] + lab_by_xyz[i][2] * by[2][j];
    }
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// Cramer's rule by columns: jacobian * step = residual; false where it is singular
static bool solve(const double jacobian[3][3], const double residual[3], double step[3])
{
    double column[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            column[j][i] = jacobian[i][j];
    double det = determinant(column[0], column[1], column[2]);
    if (!(fabs(det) > 1e-18))
        return false;
    step[0] = determinant(residual, column[1], column[2]) / det;
    step[1] = determinant(column[0], residual, column[2]) / det;
    step[2] = determinant(column[0], column[1], residual) / det;
    return isfinite(step[0]) && isfinite(step[1]) && isfinite(step[2]);
}

// Gauss-Newton with step halving, from where the coefficients stand
static void improve(const struct problem *p, const double rgb[3], double c[3])
{
    double xyz[3], target[3], ignore[3][3];
    for (int i = 0; i < 3; ++i)
        xyz[i] = p->xyz_from_rgb[i][0] * rgb[0] + p->xyz_from_rgb[i][1] * rgb[1] + p->xyz_from_rgb[i][2] * rgb[2];
    cielab(p->white, xyz, target, ignore);

    struct fit now = {.c = {c[0], c[1], c[2]}};
    look(p, target, &now);
    for (int i = 0; i < ITERATIONS && now.error > GOOD; ++i) {
        double residual[3] = {target[0] - now.lab[0], target[1] - now.lab[1], target[2] - now.lab[2]}, step[3];
        if (!solve(now.jacobian, residual, step))
            break;
        struct fit next;
        double share = 1;
        int tries = 0;
        do {
            double most = 0;
            for (int k = 0; k < 3; ++k) {
                next.c[k] = now.c[k] + share * step[k];
                most = fmax(most, fabs(next.c[k]));
            }
            for (int k = 0; k < 3 && most > LIMIT; ++k)
                next.c[k] *= LIMIT / most;
            look(p, target, &next);
            share /= 2;
        } while (next.error >= now.error && ++tries < 6);
        if (next.error >= now.error)
            break;
        bool stuck = next.error > 0.9999 * now.error;
        now = next;
        if (stuck)
            break;
    }
    memcpy(c, now.c, sizeof(now.c));
}

static void store(const double c[3], float out[3])
{
    const double k = 1 / 470.0, t0 = -360 / 470.0; // t = k lambda + t0
    out[0] = (float)(c[0] * k * k);
    out[1] = (float)(2 * c[0] * k * t0 + c[1] * k);
    out[2] = (float)(c[0] * t0 * t0 + c[1] * t0 + c[2]);
}

// one row: all x and z for a largest component and y
static void fit_row(const struct problem *p, int largest, int j)
{
    const int n = SR_RGB_RESOLUTION;
    for (int i = 0; i < n; ++i) {
        double start[3] = {0};
        for (int pass = 0; pass < 2; ++pass) {
            double c[3];
            memcpy(c, start, sizeof(c));
            for (int k = pass ? START - 1 : START; pass ? k >= 0 : k < n; k += pass ? -1 : 1) {
                double z = (double)p->table->knots[k], rgb[3];
                rgb[largest] = z;
                rgb[(largest + 1) % 3] = z * i / (n - 1);
                rgb[(largest + 2) % 3] = z * j / (n - 1);
                improve(p, rgb, c);
                if (k == START)
                    memcpy(start, c, sizeof(c));
                store(c, p->table->coefficients[largest][k][j][i]);
            }
        }
    }
}

static void *work(void *context)
{
    struct problem *p = context;
    for (;;) {
        pthread_mutex_lock(&p->lock);
        int row = p->next++;
        pthread_mutex_unlock(&p->lock);
        if (row >= 3 * SR_RGB_RESOLUTION)
            return NULL;
        fit_row(p, row / SR_RGB_RESOLUTION, row % SR_RGB_RESOLUTION);
    }
}

static void pose(struct problem *p, const struct sr_colour_space *space)
{
    const struct sr_table *light = space->illuminant;
    for (int i = 0; i < BLOCKS * LANES; ++i) {
        bool inside = i < SR_OBSERVER_COUNT;
        double lambda = 360.0 + (inside ? i : SR_OBSERVER_COUNT - 1);
        double at = (lambda - (double)light->first) / (double)light->step;
        int k = (int)at < light->count - 2 ? (int)at : light->count - 2;
        double power = (1 - (at - k)) * (double)light->values[k] + (at - k) * (double)light->values[k + 1];
        p->t[i / LANES][i % LANES] = (float)((lambda - 360) / 470);
        for (int c = 0; c < 3; ++c) {
            double w = inside ? sr_data_observer[i][c] * power / space->illuminant_luminous_integral : 0;
            p->weight[c][i / LANES][i % LANES] = (float)w;
            p->white[c] += w;
        }
    }
    memcpy(p->xyz_from_rgb, space->xyz_from_rgb, sizeof(p->xyz_from_rgb));
}

static int fit_space(const struct sr_colour_space *space, const char *name)
{
    static struct sr_rgb_table table;
    memset(&table, 0, sizeof(table));
    static struct problem p; // static for its alignment
    memset(&p, 0, sizeof(p));
    p.table = &table;
    for (int k = 0; k < SR_RGB_RESOLUTION; ++k)
        table.knots[k] = (float)smoothstep(smoothstep(k / (double)(SR_RGB_RESOLUTION - 1)));
    pose(&p, space);
    pthread_mutex_init(&p.lock, NULL);
    pthread_t helper;
    bool helped = pthread_create(&helper, NULL, work, &p) == 0;
    work(&p);
    if (helped)
        pthread_join(helper, NULL);

    FILE *file = fopen(name, "wb");
    bool written = file && fwrite(&table, sizeof(table), 1, file) == 1;
    if (!file || fclose(file) != 0 || !written) {
        fprintf(stderr, "fit_rgb: cannot write %s\n", name);
        return 1;
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc != 1 + SR_COLOUR_SPACE_COUNT) {
        fprintf(stderr, "usage: fit_rgb SRGB.bin DCI_P3.bin REC2020.bin ACES2065_1.bin\n");
        return 2;
    }
    for (int i = 0; i < SR_COLOUR_SPACE_COUNT; ++i)
        if (fit_space(&sr_data_colour_spaces[i], argv[1 + i]))
            return 1;
    return 0;
}
