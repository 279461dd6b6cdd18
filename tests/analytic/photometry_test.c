/* SPDX-License-Identifier: MIT */
/* Spectra, colour and photometry end to end: a glowing sheet in front of a camera, and luminous against radiant
 * quantities. */
#include "analytic/analytic.h"

static struct world sheet(const char *spectrum)
{
    return world_of(
        "Integrator \"path\" \"integer maxdepth\" 0\nCamera \"perspective\" \"float fov\" 10\n"
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\n"
        "AreaLightSource \"diffuse\" %s \"float scale\" 1 \"bool twosided\" true\nTranslate 0 0 1 Shape \"disk\" \"float radius\" 100\n",
        spectrum);
}

static const char *spectrum_of(const struct row *row)
{
    static char text[64];
    if (row->a > 0)
        snprintf(text, sizeof text, "\"blackbody L\" %.9g", row->a);
    else
        snprintf(text, sizeof text, "\"spectrum L\" %s",
                 row->a == 0                    ? "[360 1 830 1]"
                 : row->a == -1 || row->a == -4 ? "\"stdillum-A\""
                 : row->a == -2                 ? "\"stdillum-D65\""
                                                : "\"stdillum-D50\"");
    return text;
}

/* Our illuminant A is CIE's formula; the catalogue's is a table of 5 nm between which it interpolates. The table's own
 * error, the difference to I8 (which is the formula's), is added to the uncertainty. */
static struct estimate or_practical(const struct row *row, struct estimate e)
{
    if (row->a == -1)
        e.error = hypot(e.error, fabs(row->value) * (row->b == 2 ? 1.2e-4 : 2.9e-5));
    return e;
}

/* b: 0 x, 1 y. The chromaticity is X / (X + Y + Z); Y is 1 by the light's normalisation, but is measured, too. */
static void chromaticity(const struct row *row)
{
    struct world w = sheet(spectrum_of(row));
    double n = 512;
    struct estimate part = pixel_mean(&w.job, 0, 0, n, (const double[]){row->b == 0, row->b == 1, 0});
    struct estimate sum = pixel_mean(&w.job, 0, 0, n, (const double[]){1, 1, 1});
    // the two have the same samples; adding their relative errors is the upper bound
    double ratio = part.mean / sum.mean;
    check(row, "film",
          or_practical(row,
                       (struct estimate){ratio, ratio * (part.error / part.mean + sum.error / sum.mean), part.degrees}),
          GOAL);
    world_free(&w);
}
static void tristimulus(const struct row *row)
{
    struct world w = sheet(spectrum_of(row));
    double n = 512;
    struct estimate part = pixel_mean(&w.job, 0, 0, n, (const double[]){row->b == 0, 0, row->b == 2}),
                    Y = pixel_mean(&w.job, 0, 0, n, (const double[]){0, 1, 0});
    double ratio = 100 * part.mean / Y.mean;
    check(
        row, "film",
        or_practical(row, (struct estimate){ratio, ratio * (part.error / part.mean + Y.error / Y.mean), part.degrees}),
        GOAL);
    world_free(&w);
}

/* Luminous over radiant exitance of a blackbody. The meter counts 400 to 700 nm; I5 says which part of the whole that
 * is. */
static struct sr_irradiance measured(struct sr_render_job job, float lo, float hi)
{
    job.lambda = (struct sr_lambda_range){lo, hi};
    return sr_render_irradiance(&job, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 1}, samples(2048), REPLICATES);
}
static void efficacy(const struct row *row)
{
    static const double part_400_700 = 0.0652716939857; // I5.2856
    struct world w = sheet("\"blackbody L\" 2856");
    struct sr_irradiance all = measured(w.job, SR_LAMBDA_MIN, SR_LAMBDA_MAX), seen = measured(w.job, 400, 700);
    double K = all.E_v / seen.E_e * part_400_700 * row->b;
    check(row, "meter", (struct estimate){K, K * (all.E_v_error / all.E_v + seen.E_e_error / seen.E_e), all.degrees},
          GOAL);
    world_free(&w);
}
/* The part of 400 to 700 nm, of that which the meter sees: its ratio to the part of 500 to 600 nm is left, and is known
 * from I2's formula. */
static double planck_part(double T, double lo, double hi)
{
    double x[64], weight[64], sum = 0;
    sr_gauss_legendre(64, lo * 1e-9, hi * 1e-9, x, weight);
    for (int i = 0; i < 64; ++i)
        sum += weight[i] * 2 * 6.62607015e-34 * 299792458. * 299792458. / pow(x[i], 5) /
               expm1(6.62607015e-34 * 299792458. / (x[i] * 1.380649e-23 * T));
    return sum / (5.67037441918e-8 * pow(T, 4) / (double)SR_PI);
}
static void part_of_planck(const struct row *row)
{
    char text[64];
    snprintf(text, sizeof text, "\"blackbody L\" %.9g", row->a);
    struct world w = sheet(text);
    struct sr_irradiance wide = measured(w.job, 400, 700), narrow = measured(w.job, 500, 600);
    double part = wide.E_e / narrow.E_e * planck_part(row->a, 500, 600);
    check(row, "meter",
          (struct estimate){part, part * (wide.E_e_error / wide.E_e + narrow.E_e_error / narrow.E_e), wide.degrees},
          GOAL);
    world_free(&w);
}
/* Nearly monochromatic light: lumens a watt, times b watts. */
static void monochromatic(const struct row *row)
{
    struct world w = sheet("\"spectrum L\" [360 1 830 1]");
    struct sr_irradiance E = measured(w.job, (float)row->a - 0.02f, (float)row->a + 0.02f);
    double lumens = E.E_v / E.E_e * row->b;
    check(row, "meter", (struct estimate){lumens, lumens * (E.E_v_error / E.E_v + E.E_e_error / E.E_e), E.degrees},
          GOAL);
    world_free(&w);
}

const struct row photometry_rows[] = {
    {"I8.x", "illuminant A, the formula", 0.447573548572, chromaticity, -4, 0},
    {"I8.y", "", 0.407439392691, chromaticity, -4, 1},
    {"I10.2856.x", "blackbody of 2856 K", 0.447535144304, chromaticity, 2856, 0},
    {"I10.2856.y", "", 0.407428289726, chromaticity, 2856, 1},
    {"I10.6500.x", "blackbody of 6500 K", 0.313525880402, chromaticity, 6500, 0},
    {"I10.6500.y", "", 0.323628304672, chromaticity, 6500, 1},
    {"I6ex", "equal energy", 0.333314380777, chromaticity, 0, 0},
    {"I6ey", "", 0.333287705799, chromaticity, 0, 1},
    {"I7.A.x", "illuminant A", 0.44756076888, chromaticity, -1, 0},
    {"I7.A.y", "", 0.407431233766, chromaticity, -1, 1},
    {"I7.A.X", "", 109.849400779, tristimulus, -1, 0},
    {"I7.A.Z", "", 35.5907906259, tristimulus, -1, 2},
    {"I7.D65.x", "illuminant D65", 0.312726932468, chromaticity, -2, 0},
    {"I7.D65.y", "", 0.329023221548, chromaticity, -2, 1},
    {"I7.D65.X", "", 95.0470702331, tristimulus, -2, 0},
    {"I7.D65.Z", "", 108.882845502, tristimulus, -2, 2},
    {"I7.D50.x", "illuminant D50", 0.336805575569, chromaticity, -3, 0},
    {"I7.D50.y", "", 0.357981649164, chromaticity, -3, 1},
    {"I7.D50.X", "", 94.0845924243, tristimulus, -3, 0},
    {"I7.D50.Z", "", 85.2593354939, tristimulus, -3, 2},
    {"I11.2856", "blackbody of 2856 K, Km = 683.002 [lm/W]", 16.4462797642, efficacy, 0, 683.002 / 683},
    {"I5.2856", "its part of 400 to 700 nm", 0.0652716939857, part_of_planck, 2856, 0},
    {"I5.5778", "the same of 5778 K", 0.366659443156, part_of_planck, 5778, 0},
    {"I12", "1 W of 555 nm [lm]", 683.0, monochromatic, 555, 1},
    {"I12b", "1 mW of 532 nm [lm]", 0.6044293192, monochromatic, 532, 1e-3},
    {.id = NULL},
};

TEST(photometry_of_glowing_things_is_that_of_the_tables)
{
    run_rows("photometry", photometry_rows);
}
