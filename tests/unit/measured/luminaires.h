/* SPDX-License-Identifier: MIT */
/* Luminaires made of formulas, so that what is read from their files is known. */
#ifndef TEST_MEASURED_LUMINAIRES_H
#define TEST_MEASURED_LUMINAIRES_H

#include "measured/measured.h"
#include "test.h"

#define RADIANS (3.14159265358979323846 / 180)

/* I(C, gamma) [cd] */
typedef double intensity_of(double c, double gamma);

/* 100 lm down, I = 100 / pi cos gamma */
static inline double lambertian(double c, double gamma)
{
    (void)c;
    return gamma < 90 ? 100 / 3.14159265358979323846 * cos(gamma * RADIANS) : 0;
}
/* 100 lm: I = 100 / (4 pi) */
static inline double isotropic(double c, double gamma)
{
    (void)c, (void)gamma;
    return 100 / (4 * 3.14159265358979323846);
}
/* 2 pi I0 / 21 lm with I0 = 1000 cd */
static inline double cos20(double c, double gamma)
{
    (void)c;
    return gamma < 90 ? 1000 * pow(cos(gamma * RADIANS), 20) : 0;
}
/* no symmetry at all, light everywhere */
static inline double lopsided(double c, double gamma)
{
    double g = gamma * RADIANS, a = c * RADIANS;
    return 50 + 30 * cos(g) + sin(g) * (12 * cos(a) + 7 * sin(a) + 5 * sin(2 * a));
}
static inline double c0_symmetric(double c, double gamma)
{
    return 50 + 30 * cos(gamma * RADIANS) + sin(gamma * RADIANS) * (12 * cos(c * RADIANS) + 5 * cos(2 * c * RADIANS));
}
static inline double c90_symmetric(double c, double gamma)
{
    return 50 + 30 * cos(gamma * RADIANS) + sin(gamma * RADIANS) * (12 * sin(c * RADIANS) + 5 * cos(2 * c * RADIANS));
}
static inline double quadrant(double c, double gamma)
{
    return 50 + 30 * cos(gamma * RADIANS) + sin(gamma * RADIANS) * 5 * cos(2 * c * RADIANS);
}

/* c_steps intervals over the planes that the symmetry keeps, gamma_steps over 0 … 180. */
static inline struct sr_photometry luminaire_make(struct sr_arena *arena, enum sr_photometry_symmetry symmetry,
                                                  intensity_of *I, uint32_t c_steps, uint32_t gamma_steps)
{
    static const float first[] = {0, 0, 0, 90, 0}, length[] = {360, 0, 180, 180, 90};
    uint32_t c_count = symmetry == SR_PHOTOMETRY_AXIAL        ? 1
                       : symmetry == SR_PHOTOMETRY_ALL_PLANES ? c_steps
                                                              : c_steps + 1,
             gamma_count = gamma_steps + 1;
    float *c = sr_arena_alloc(arena, c_count * sizeof *c), *gamma = sr_arena_alloc(arena, gamma_count * sizeof *gamma);
    float *candela = sr_arena_alloc(arena, (size_t)c_count * gamma_count * sizeof *candela);
    for (uint32_t i = 0; i < c_count; ++i)
        c[i] = first[symmetry] + length[symmetry] * (float)i / (float)(c_steps ? c_steps : 1);
    for (uint32_t j = 0; j < gamma_count; ++j)
        gamma[j] = 180 * (float)j / (float)gamma_steps;
    for (uint32_t i = 0; i < c_count; ++i)
        for (uint32_t j = 0; j < gamma_count; ++j)
            candela[i * gamma_count + j] = (float)I((double)c[i], (double)gamma[j]);
    static const struct sr_photometry_word words[] = {{"MANUFAC", "Formula & Sons"},
                                                      {"LUMINAIRE", "a lamp of numbers"}};
    return (struct sr_photometry){.symmetry = symmetry,
                                  .c_count = c_count,
                                  .gamma_count = gamma_count,
                                  .c = c,
                                  .gamma = gamma,
                                  .candela = candela,
                                  .lamp_count = 2,
                                  .lamp_flux = 1200,
                                  .power_W = 12.5f,
                                  .along_c0 = 0.3f,
                                  .along_c90 = 1.2f,
                                  .height = 0.05f,
                                  .words = words,
                                  .word_count = 2,
                                  .note = ""};
}

#endif
