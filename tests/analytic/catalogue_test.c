/* SPDX-License-Identifier: MIT */
/* Are all rows of the catalogue here, with their values? Those of the groups A, B, C, D, G, H, I, J and not among ours
 * are in the list below, with the reason. Skipped where the catalogue is absent. */
#include "analytic/analytic.h"

static const struct {
    const char *id, *why;
} elsewhere[] = {
    {"A4", "no cos^n spot among the lights"},
    {"B17", "a solid angle: unit tests of shapes and of sampling"},
    {"B18", "as B17"},
    {"D3g", "an angle, used by D2 and D3"},
    {"D7", "net exchange of heat, no photometric quantity"},
    {"D12f", "an approximation of six patches; D13 is the answer"},
    {"D12w", "as D12f"},
    {"D12c", "as D12f"},
    {"G1.45s", "light has no polarisation here; G1.45 is the mean"},
    {"G1.45p", "as G1.45s"},
    {"G1.80s", "as G1.45s"},
    {"G1.80p", "as G1.45s"},
    {"G2", "the angle at which G2s is measured"},
    {"G7.1s", "as G1.45s; the mean is G7.1"},
    {"G7.1p", "as G7.1s"},
    {"G10.1.450", "no thin films"},
    {"G10.1.550", "no thin films"},
    {"G10.1.650", "no thin films"},
    {"G10.2.450", "no thin films"},
    {"G10.2.550", "no thin films"},
    {"G10.2.650", "no thin films"},
    {"H5.1.0.0.5", "paths without end in a half-space that absorbs nothing; its slabs are H11"},
    {"H5.1.0.1.0", "as H5.1.0.0.5"},
    {"I1", "a constant"},
    {"I2.2856", "unit tests of spectrum"},
    {"I2.5778", "as I2.2856"},
    {"I2.300", "as I2.2856"},
    {"I3", "as I2.2856"},
    {"I4", "as I2.2856"},
    {"I6X", "as I2.2856"},
    {"I6Y", "as I2.2856"},
    {"I6Z", "as I2.2856"},
    {"I7.A.X5", "a sum of 5 nm, not ours"},
    {"I7.A.Z5", "as I7.A.X5"},
    {"I7.D65.X5", "as I7.A.X5"},
    {"I7.D65.Z5", "as I7.A.X5"},
    {"I7.D50.X5", "as I7.A.X5"},
    {"I7.D50.Z5", "as I7.A.X5"},
    {"I9.x", "unit tests of spectrum"},
    {"I9.y", "as I9.x"},
    {"I11b.2856", "lights are scaled to a luminance; I11 is the efficacy"},
    {"I12c", "a constant"},
    {"J1a", "an approximation of J1"},
    {"J2a.15", "an approximation of J2.15"},
    {"J2a.40", "an approximation of J2.40"},
    {"J4", "a distance inside of the camera; J5 depends on it"},
};

static const struct row *find(const char *id)
{
    const struct row *const tables[] = {source_rows,     exchange_rows, enclosure_rows, fresnel_rows,
                                        photometry_rows, camera_rows,   media_rows};
    for (int t = 0; t < 7; ++t)
        for (const struct row *row = tables[t]; row->id; ++row)
            if (strcmp(row->id, id) == 0)
                return row;
    return NULL;
}

static bool is_elsewhere(const char *id)
{
    for (size_t i = 0; i < sizeof elsewhere / sizeof elsewhere[0]; ++i)
        if (strcmp(elsewhere[i].id, id) == 0)
            return true;
    return false;
}

TEST(catalogue_of_closed_forms_is_complete)
{
    FILE *file = fopen(test_reference_file("validation_cases.tsv"), "r");
    EXPECT(file != NULL);
    char line[4096];
    int rows = 0, wrong = 0;
    while (fgets(line, sizeof line, file)) {
        char *column[6] = {line};
        for (int i = 1; i < 6; ++i) {
            column[i] = column[i - 1] ? strchr(column[i - 1], '\t') : NULL;
            if (column[i])
                *column[i]++ = 0;
        }
        if (!column[5] || !strchr("ABCDGHIJ", line[0]))
            continue;
        const struct row *row = find(line);
        bool is_right = row ? fabs(row->value - atof(column[5])) <= 1e-11 * fabs(row->value) : is_elsewhere(line);
        if (!is_right)
            printf("  %s: %s\n", line, row ? "another value" : "neither here nor elsewhere");
        wrong += !is_right;
        rows += row != NULL;
    }
    fclose(file);
    printf("%d rows of the catalogue are measured here\n", rows);
    EXPECT_EQUAL_INT(wrong, 0);
    EXPECT(rows > 70);
}
