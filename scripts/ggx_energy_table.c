/* SPDX-License-Identifier: MIT */
/* Makes the tables of what Trowbridge and Reitz's facets send on at the first bounce:
 *
 *     cc -O3 scripts/ggx_energy_table.c -o /tmp/table -lm
 *     /tmp/table metal > src/bsdf/ggx_energy.h
 *     /tmp/table glass > src/bsdf/ggx_glass_energy.h
 *
 *     E(z) = INTEGRAL p(m) (F G2 / G1 + (1 - F) G2' / G1) dm    [1]
 *
 * over the facets as the viewer sees them, p(m), by the map of the square on them (Dupuy & Benyoub 2023): the half turn
 * by the midpoint rule, and on each of its lines panels of Gauss's rule, split where the reflected or the refracted
 * direction comes to lie in the surface and where total reflection begins. Metal: F = 1. Glass: Fresnel's F, G2 = 1 /
 * (1 + a + b), G2' = B(1 + a, 1 + b) with Smith's a and b (facets_interface.h). */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { POINTS = 8 };
static int lines, panels;

struct facet {
    double alpha, eta, zo, so; // eta 0: metal
    double vx, vz;             // the viewer in the space where slopes are those of a hemisphere
    double cosine;             // of the line's azimuth
};
/* What a facet does; edges: the functions that change sign where the integrand has an edge. */
static double sent(const struct facet *f, double u, double edges[3])
{
    double z = (1 - u) * (1 + f->vz) - f->vz, r = sqrt(fmax((1 - z) * (1 + z), 0)), a = f->alpha;
    double mx = a * (r * f->cosine + f->vx), my2 = a * a * r * r * (1 - f->cosine) * (1 + f->cosine), mz = z + f->vz;
    double l = 1 / sqrt(mx * mx + my2 + mz * mz), so = f->so, zo = f->zo, ro = sqrt(fmax((1 - zo) * (1 + zo), 0));
    mx *= l;
    mz *= l;
    double c = ro * mx + zo * mz, zi = 2 * c * mz - zo, sum = 0, F = 1;
    edges[0] = zi;
    edges[1] = edges[2] = 1;
    if (f->eta > 0) {
        double t2 = 1 - (1 - c * c) / (f->eta * f->eta), ct = sqrt(fmax(t2, 0)), n = f->eta;
        double p = (n * c - ct) / (n * c + ct), s = (c - n * ct) / (c + n * ct);
        F = t2 > 0 ? (p * p + s * s) / 2 : 1;
        double zt = -zo / n + (c / n - ct) * mz;
        edges[1] = t2;
        edges[2] = t2 > 0 ? -zt : 1;
        if (t2 > 0 && zt < 0) {
            double st = sqrt(zt * zt + a * a * (1 - zt) * (1 + zt));
            double up = (so / zo - 1) / 2, down = (st / -zt - 1) / 2; // Smith's Lambda
            if (down < 1e6)
                sum += (1 - F) * exp(lgamma(2 + up) + lgamma(1 + down) - lgamma(2 + up + down));
        }
    }
    if (zi > 0) {
        double si = sqrt(zi * zi + a * a * (1 - zi) * (1 + zi));
        sum += F * zi * (zo + so) / (so * zi + si * zo);
    }
    return sum;
}

static const double node[POINTS] = {0.01985507175123188, 0.10166676129318664, 0.23723379504183550, 0.40828267875217510,
                                    0.59171732124782490, 0.76276620495816450, 0.89833323870681340, 0.98014492824876810};
static const double share[POINTS] = {0.05061426814518813, 0.11119051722668724, 0.15685332293894364,
                                     0.18134189168918100, 0.18134189168918100, 0.15685332293894364,
                                     0.11119051722668724, 0.05061426814518813};

static double between(const struct facet *f, double a, double b)
{
    double ea[3], eb[3], em[3], sum = 0;
    sent(f, a, ea);
    sent(f, b, eb);
    for (int k = 0; k < 3; ++k)
        if ((ea[k] > 0) != (eb[k] > 0) && b - a > 1e-13) {
            double lo = a, hi = b;
            for (int i = 0; i < 50; ++i) {
                double m = (lo + hi) / 2;
                sent(f, m, em);
                *((em[k] > 0) == (ea[k] > 0) ? &lo : &hi) = m;
            }
            if (lo - a > 1e-14 && b - hi > 1e-14)
                return between(f, a, lo) + between(f, hi, b);
        }
    for (int i = 0; i < POINTS; ++i) { // eased, as square roots may begin or end here
        double t = node[i];
        sum += (b - a) * share[i] * 6 * t * (1 - t) * sent(f, a + (b - a) * t * t * (3 - 2 * t), em);
    }
    return sum;
}

static double energy(double alpha, double z, double eta)
{
    struct facet f = {.alpha = alpha, .eta = eta, .zo = z, .so = sqrt(z * z + alpha * alpha * (1 - z) * (1 + z))};
    double sum = 0;
    f.vx = alpha * sqrt(fmax((1 - z) * (1 + z), 0)) / f.so;
    f.vz = z / f.so;
    for (int k = 0; k < lines; ++k) {
        f.cosine = cos(M_PI * (k + 0.5) / lines);
        for (int i = 0; i < panels; ++i) // finer toward the steep facets at 1
            sum += between(&f, 1 - pow(1 - (double)i / panels, 4), 1 - pow(1 - (i + 1.0) / panels, 4)) / lines;
    }
    return sum;
}

/* z = alpha p / (1 + alpha - p) with p = q or, finer at the horizon, q^(3/2) */
static double cosine_of(double p, double alpha)
{
    return fmax(alpha * p / (1 + alpha - p), 1e-4 * alpha);
}

/* One row over z, in units of 1 / scale; ends a row of the table. */
static void row(double alpha, double eta, int columns, double scale, const char *end)
{
    for (int j = 0; j < columns; ++j) {
        double q = (double)j / (columns - 1), z = cosine_of(eta > 0 ? q * sqrt(q) : q, alpha);
        printf("%s%ld%s",
               j % 16 ? ""
               : j    ? "\n     "
                      : "    {",
               lround(scale * energy(alpha, z, eta)), j < columns - 1 ? "," : end);
    }
}

static void metal(void)
{
    enum { ROWS = 48, COLUMNS = 64 };
    lines = 1024;
    panels = 12;
    printf(
        "/* SPDX-License-Identifier: MIT */\n"
        "/* Private to this room: what Trowbridge and Reitz's facets reflect at the first bounce where F = 1 (Smith, "
        "height-correlated).\n"
        " *\n"
        " *     E(z) = INTEGRAL D G / (4 z) dwi    [1e-6],    z = cos_theta\n"
        " *\n"
        " * Row i: alpha = (i / 47)^2 (row 0: its limit, 1e-4); column j: z = alpha q / (1 + alpha - q), q = j / 63 "
        "(column "
        "0: its limit).\n"
        " * Written by scripts/ggx_energy_table.c, whose head tells how, to 1e-6; a test does some of it again. */\n"
        "#ifndef SR_BSDF_GGX_ENERGY_H\n#define SR_BSDF_GGX_ENERGY_H\n\n#include <stdint.h>\n\n"
        "enum { ENERGY_ROWS = %d, ENERGY_COLUMNS = %d };\n// clang-format off\n"
        "static const int32_t ggx_energy[ENERGY_ROWS][ENERGY_COLUMNS] = {\n",
        ROWS, COLUMNS);
    for (int i = 0; i < ROWS; ++i)
        row(fmax(i * i / (double)((ROWS - 1) * (ROWS - 1)), 1e-4), 0, COLUMNS, 1e6, "},\n");
}

static void glass(void)
{
    enum { INDICES = 12, ROWS = 16, COLUMNS = 32 };
    lines = 96;
    panels = 8;
    printf("/* SPDX-License-Identifier: MIT */\n"
           "/* Private to this room: what facets of glass reflect and transmit at the first bounce (Trowbridge & "
           "Reitz; Smith).\n"
           " *\n"
           " *     E(z) = INTEGRAL f |zi| dwi    [1e-5],    z = cos_theta, f in the form for importance\n"
           " *\n"
           " * First 0: from the thin side, 1: from the dense one; second k: the larger index over the smaller, 1.1 "
           "(3 / 1.1)^(k / 11);\n"
           " * row i: alpha = (i / 15)^2 (row 0: its limit, 1e-4); column j: z = alpha p / (1 + alpha - p), p = (j / "
           "31)^(3 / 2) (column 0: its limit).\n"
           " * Written by scripts/ggx_energy_table.c, whose head tells how. */\n"
           "#ifndef SR_BSDF_GGX_GLASS_ENERGY_H\n#define SR_BSDF_GGX_GLASS_ENERGY_H\n\n#include <stdint.h>\n\n"
           "enum { GLASS_INDICES = %d, GLASS_ROWS = %d, GLASS_COLUMNS = %d };\n// clang-format off\n"
           "static const int32_t glass_energy[2][GLASS_INDICES][GLASS_ROWS][GLASS_COLUMNS] = {{\n",
           INDICES, ROWS, COLUMNS);
    for (int side = 0; side < 2; ++side)
        for (int k = 0; k < INDICES; ++k) {
            double n = 1.1 * pow(3 / 1.1, (double)k / (INDICES - 1));
            printf("   {\n");
            for (int i = 0; i < ROWS; ++i)
                row(fmax(i * i / (double)((ROWS - 1) * (ROWS - 1)), 1e-4), side ? 1 / n : n, COLUMNS, 1e5,
                    i < ROWS - 1      ? "},\n"
                    : k < INDICES - 1 ? "}},\n"
                    : side == 0       ? "}}}, {\n"
                                      : "}}}\n");
        }
}

int main(int count, char **words)
{
    if (count != 2 || (strcmp(words[1], "metal") != 0 && strcmp(words[1], "glass") != 0)) {
        fprintf(stderr, "usage: ggx_energy_table metal|glass\n");
        return 2;
    }
    strcmp(words[1], "metal") == 0 ? metal() : glass();
    printf("};\n// clang-format on\n\n#endif\n");
    return 0;
}
