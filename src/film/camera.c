/* SPDX-License-Identifier: MIT */
/* What the sensors of 17 cameras make of light, and how colours are made of that.
 *
 *     s_c = integral of L c dlambda,      XYZ = M s,      M minimises sum over patches |M s(patch) - XYZ(patch)|^2
 *
 * The patches of a chart are seen by the camera under daylight of the white balance's temperature (below 4000 K a black
 * body) and wanted as they look under the output's white; both are relative to a white's green and Y, and M is scaled
 * so that the luminance of white is right. A. Langlands & L. Fascione, PhysLight, 2020; Pharr, Jakob & Humphreys,
 * Physically Based Rendering, 2023, 5.4.2. Limits: curves are 0 beyond 380 … 720 nm; colours that the chart lacks may
 * come out otherwise than an observer sees them. */
#include "film/camera_data.h"
#include "film/film.h"

#include <string.h>

enum { FIRST_NM = 380, STEP_NM = 10, LAST_NM = 730 };

const char *sr_film_camera_name(int i)
{
    return i >= 0 && i < CAMERAS ? camera_data[i].name : NULL;
}

void sr_film_camera_values(uint32_t camera1, sr_spectrum L, const struct sr_wavelengths *w, float values[3])
{
    const struct camera_data *camera = &camera_data[camera1 - 1];
    values[0] = values[1] = values[2] = 0;
    for (int k = 0; k < SR_LAMBDA_COUNT; ++k) {
        float at = (w->lambda[k] - FIRST_NM) * (1.0f / STEP_NM);
        if (!(at >= 0 && at < CURVE_COUNT - 1) || !(w->pdf[k] > 0))
            continue;
        int i = (int)at;
        float t = at - (float)i, share = L[k] / (w->pdf[k] * SR_LAMBDA_COUNT) * 1e-5f;
        for (int c = 0; c < 3; ++c)
            values[c] += share * sr_lerp(t, (float)camera->curves[c][i], (float)camera->curves[c][i + 1]);
    }
}

static double curve_at(const struct camera_data *camera, int c, int nm)
{
    int i = (nm - FIRST_NM) / STEP_NM;
    double t = (nm - FIRST_NM) % STEP_NM / (double)STEP_NM;
    if (nm < FIRST_NM || i >= CURVE_COUNT - 1)
        return 0;
    return 1e-5 * ((1 - t) * camera->curves[c][i] + t * camera->curves[c][i + 1]);
}

static double patch_at(int patch, int nm)
{
    int i = (nm - FIRST_NM) / STEP_NM;
    double t = (nm - FIRST_NM) % STEP_NM / (double)STEP_NM;
    if (nm < FIRST_NM || nm > LAST_NM)
        return 0;
    return 1e-3 *
           (i + 1 < PATCH_COUNT ? (1 - t) * patch_data[patch][i] + t * patch_data[patch][i + 1] : patch_data[patch][i]);
}

/* Of daylight, or of a black body [relative]; beyond the table as at its ends. */
static double source_at(double T, int nm)
{
    T *= 1.4388 / 1.4380; // of names given before 1968
    if (T < 4000)
        return pow(560.0 / nm, 5) * expm1(1.4388e7 / (560 * T)) / expm1(1.4388e7 / (nm * T));
    double xy[2], m, at = (double)(nm < FIRST_NM ? FIRST_NM : nm > LAST_NM ? LAST_NM : nm) - FIRST_NM;
    sr_daylight_xy(T, xy);
    m = 0.0241 + 0.2562 * xy[0] - 0.7341 * xy[1];
    double share[3] = {1, (-1.3515 - 1.7703 * xy[0] + 5.9114 * xy[1]) / m,
                       (0.0300 - 31.4424 * xy[0] + 30.0717 * xy[1]) / m},
           sum = 0;
    int i = (int)at / STEP_NM < PATCH_COUNT - 2 ? (int)at / STEP_NM : PATCH_COUNT - 2;
    double t = at / STEP_NM - i;
    for (int k = 0; k < 3; ++k)
        sum += share[k] * ((1 - t) * (double)daylight_data[k][i] + t * (double)daylight_data[k][i + 1]);
    return sum;
}

/* A x = b for three right sides at once: normal equations of the fit, by cofactors. */
static void solve(const double a[3][3], const double b[3][3], double x[3][3])
{
    double c[3][3], determinant = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            c[i][j] = a[(i + 1) % 3][(j + 1) % 3] * a[(i + 2) % 3][(j + 2) % 3] -
                      a[(i + 1) % 3][(j + 2) % 3] * a[(i + 2) % 3][(j + 1) % 3];
    for (int j = 0; j < 3; ++j)
        determinant += a[0][j] * c[0][j];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            x[i][j] = (c[0][i] * b[0][j] + c[1][i] * b[1][j] + c[2][i] * b[2][j]) / determinant;
}

void sr_film_camera_matrix(uint32_t camera1, double T, enum sr_colour_space_id space, double xyz_from_camera[3][3])
{
    const struct camera_data *camera = &camera_data[camera1 - 1];
    struct sr_spd white = {.kind = SR_SPD_TABLE, .scale = 1, .table = sr_colour_space(space)->illuminant};
    double seen[PATCHES][3] = {{0}}, wanted[PATCHES][3] = {{0}}, green = 0, luminance = 0, white_Y = 0;
    for (int nm = SR_LAMBDA_MIN; (float)nm <= SR_LAMBDA_MAX; ++nm) {
        double source = source_at(T, nm), target = (double)sr_spd_at(&white, (float)nm), observer[3], curve[3];
        sr_observer_1931(nm, observer);
        for (int c = 0; c < 3; ++c)
            curve[c] = curve_at(camera, c, nm);
        green += source * curve[1];
        luminance += source * observer[1];
        white_Y += target * observer[1];
        for (int p = 0; p < PATCHES; ++p)
            for (int c = 0; c < 3; ++c) {
                seen[p][c] += source * patch_at(p, nm) * curve[c];
                wanted[p][c] += target * patch_at(p, nm) * observer[c];
            }
    }
    double AtA[3][3] = {{0}}, AtB[3][3] = {{0}}, x[3][3];
    for (int p = 0; p < PATCHES; ++p)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                AtA[i][j] += seen[p][i] * seen[p][j] / (green * green);
                AtB[i][j] += seen[p][i] * wanted[p][j] * luminance / (green * green * white_Y);
            }
    solve((const double(*)[3])AtA, (const double(*)[3])AtB, x);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            xyz_from_camera[i][j] = x[j][i];
}
