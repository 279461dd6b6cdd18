/* SPDX-License-Identifier: MIT */
/* Makes src/bsdf/sheen_ltc_table.h: cc -O3 scripts/sheen_table.c -o /tmp/sheen_table -lm && /tmp/sheen_table >
 * src/bsdf/sheen_ltc_table.h
 *
 * For each roughness alpha and viewer's cosine z light is followed at random through a layer of fibres that stand on a
 * black ground: thickness 1, density 1, albedo 1, mirroring microflakes of the SGGX distribution with S = diag(1, 1,
 * sigma^2), sigma = alpha^2 (Zeltner, Burley & Chiang 2022; Heitz et al. 2015). What leaves above gives the share R,
 * and the linear transformation that makes the directions likeliest:
 *
 *     p(w) = w.z A^2 / (pi |(A w.x + B w.z, A w.y, w.z)|^4)   [1/sr],     maximum of SUM weight ln p
 *
 * found by iteration: with u = weight / |...|^2, B = -A SUM u x z / SUM u z^2, and A likewise. To standard error: how
 * far the fit lies from what was simulated. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROWS = 32, COLUMNS = 32, WALKS = 40000, MOST = 6 * WALKS, FEW = 2000, CELLS = 12 };

static uint64_t state;
static double uniform(void) // splitmix64 (Steele, Lea & Flood 2014)
{
    uint64_t x = state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return ((double)((x ^ (x >> 31)) >> 11) + 0.5) / 9007199254740992.0;
}

struct vec {
    double x, y, z;
};
static struct vec unit(struct vec v)
{
    double l = 1 / sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return (struct vec){v.x * l, v.y * l, v.z * l};
}

/* A mirroring flake as w sees them: a point of the half sphere that faces S^1/2 w, uniform as seen; its normal by
 * S^1/2. */
static struct vec scattered(struct vec w, double sigma, double u, double v)
{
    struct vec c = unit((struct vec){w.x, w.y, sigma * w.z});
    double sign = c.z < 0 ? -1 : 1, a = -1 / (sign + c.z), b = c.x * c.y * a, r = sqrt(u), z = sqrt(1 - u);
    double p = r * cos(2 * M_PI * v), q = r * sin(2 * M_PI * v);
    struct vec m = {p * (1 + sign * c.x * c.x * a) + q * b + z * c.x,
                    p * sign * b + q * (sign + c.y * c.y * a) + z * c.y, -p * sign * c.x - q * c.y + z * c.z};
    m.z *= sigma;
    m = unit(m);
    double d = 2 * (w.x * m.x + w.y * m.y + w.z * m.z);
    return unit((struct vec){d * m.x - w.x, d * m.y - w.y, d * m.z - w.z});
}

static struct {
    float x, y, z, weight;
} left[MOST];
static int count;

/* Light that comes in against v; at each leg the share that leaves is told, and the rest collides. */
static void walk(struct vec v, double sigma, int k)
{
    struct vec d = {-v.x, -v.y, -v.z};
    double depth = 0, weight = 1;
    double first[3] = {fmod(k * 0.8191725133961645, 1), fmod(k * 0.6710436067037893, 1),
                       fmod(k * 0.5497004779019703, 1)};
    for (int leg = 0;; ++leg) {
        double rate = sqrt(d.x * d.x + d.y * d.y + sigma * sigma * d.z * d.z) / fabs(d.z);
        double passes = exp(-rate * (d.z > 0 ? depth : 1 - depth));
        if (d.z > 0 && weight * passes > 0 && count < MOST) {
            left[count].x = (float)d.x;
            left[count].y = (float)d.y;
            left[count].z = (float)d.z;
            left[count++].weight = (float)(weight * passes);
        }
        weight *= 1 - passes;
        if (weight < 0.1) {
            if (uniform() * 0.1 > weight)
                return;
            weight = 0.1;
        }
        double t = -log1p(-(leg ? uniform() : first[0]) * (1 - passes)) / rate;
        depth = fmin(fmax(depth + (d.z > 0 ? -t : t), 0), 1);
        d = scattered((struct vec){-d.x, -d.y, -d.z}, sigma, leg ? uniform() : first[1], leg ? uniform() : first[2]);
    }
}

static void fit(bool is_even, double *A, double *B, double *total)
{
    *total = 0;
    for (int i = 0; i < count; ++i)
        *total += (double)left[i].weight;
    if (count < FEW / 10)
        return; // the directions of the column before will do
    for (int pass = 0; pass < 60; ++pass) {
        double s = 0, p = 0, q = 0, a = *A, b = *B;
        for (int i = 0; i < count; ++i) {
            double x = (double)left[i].x, y = (double)left[i].y, z = (double)left[i].z, v = a * x + b * z;
            double u = (double)left[i].weight / (v * v + a * a * y * y + z * z);
            s += u * (x * x + y * y);
            p += is_even ? 0 : u * x * z; // from the normal no azimuth is preferred
            q += u * z * z;
        }
        *A = sqrt(*total / (2 * (s - p * p / q)));
        *B = -*A * p / q;
        if (fabs(*A - a) + fabs(*B - b) < 1e-5)
            break;
    }
}

/* Half the integral of |simulated - fitted|, in cells that have one probability each if the fit is right. */
static double difference(double A, double B, double total)
{
    double cell[CELLS][CELLS] = {{0}}, sum = 0;
    for (int i = 0; i < count; ++i) {
        double x = A * (double)left[i].x + B * (double)left[i].z, y = A * (double)left[i].y, z = (double)left[i].z;
        int ring = (int)(CELLS * (x * x + y * y) / (x * x + y * y + z * z)),
            sector = (int)(CELLS * fabs(atan2(y, x)) / M_PI);
        cell[ring < CELLS ? ring : CELLS - 1][sector < CELLS ? sector : CELLS - 1] += (double)left[i].weight / total;
    }
    for (int i = 0; i < CELLS * CELLS; ++i)
        sum += fabs(cell[i / CELLS][i % CELLS] - 1.0 / (CELLS * CELLS)) / 2;
    return sum;
}

int main(void)
{
    printf("/* SPDX-License-Identifier: MIT */\n"
           "/* Private to this room: linearly transformed cosines that fit a layer of fibres, see sheen_ltc.c.\n *\n"
           " * Written by scripts/sheen_table.c; its head tells how. Row i: alpha = 0.1 + 0.9 i / 31; column j: cos "
           "theta_o = (j / "
           "31)^2.\n * Each: A [1e-5], B [1e-5], the share of light R [1e-6]. */\n"
           "#ifndef SR_BSDF_SHEEN_LTC_TABLE_H\n#define SR_BSDF_SHEEN_LTC_TABLE_H\n\n#include <stdint.h>\n\n"
           "enum { SHEEN_ROWS = %d, SHEEN_COLUMNS = %d };\n// clang-format off\n"
           "static const int32_t sheen_ltc_table[SHEEN_ROWS][SHEEN_COLUMNS][3] = {\n",
           ROWS, COLUMNS);
    for (int i = 0; i < ROWS; ++i) {
        double alpha = 0.1 + 0.9 * i / (ROWS - 1), worst = 0, light = 0, A = 0.1, B = 0;
        for (int j = 0; j < COLUMNS; ++j) {
            double t = (double)j / (COLUMNS - 1), z = fmax(t * t, 1e-5), total;
            state = (uint64_t)(i * COLUMNS + j) << 40;
            count = 0;
            int walks = 0;
            while (walks < WALKS || (count < FEW && walks < 10 * WALKS)) // from sharp fibres light seldom returns
                walk((struct vec){sqrt(1 - z * z), 0, z}, alpha * alpha, ++walks);
            fit(j == COLUMNS - 1, &A, &B, &total);
            double d = total > 0 ? difference(A, B, total) : 0;
            worst = fmax(worst, d * total / walks);
            light += d / COLUMNS;
            printf("%s{%ld,%ld,%ld},%s", j % 6 == 0 ? j ? "\n     " : "    {" : "", lround(A * 1e5), lround(B * 1e5),
                   lround(total / walks * 1e6), j == COLUMNS - 1 ? "},\n" : "");
        }
        fprintf(stderr, "alpha %.3f: of the light %.3f goes elsewhere, mean over z; at most %.3f of what arrives\n",
                alpha, light, worst);
    }
    printf("};\n// clang-format on\n\n#endif\n");
    return 0;
}
