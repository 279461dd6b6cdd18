/* SPDX-License-Identifier: MIT */
/* Luminaires as somebody measured them: intensity over directions, from IES LM-63 and EULUMDAT files and back.
 *
 * Directions are those of C-planes: gamma 0 points down (local -z), 90 to the horizon, 180 up; C 0 is local +x, C 90
 * local +y, so that seen from above C runs against the clock.
 *
 *     d = (sin gamma cos C, sin gamma sin C, -cos gamma)              [1]
 *     Phi = INTEGRAL I(C, gamma) sin gamma dgamma dC                  [lm], exact for the intensity between the
 *                                                                     angles, which is bilinear in C and gamma
 *
 * IES LM-63-1986, -1991, -1995, -2002, -2019; EULUMDAT: A. W. Stockmar 1990, 1998. Limits: far field only; types A and
 * B are resampled to C-planes; TILT is understood for a luminaire that hangs as it was measured. */
#ifndef SR_MEASURED_PHOTOMETRY_H
#define SR_MEASURED_PHOTOMETRY_H

#include "sample/sample.h"

enum sr_photometry_format { SR_PHOTOMETRY_IES, SR_PHOTOMETRY_LDT };

/* Which planes are kept; the numbers are EULUMDAT's Isym. */
enum sr_photometry_symmetry {
    SR_PHOTOMETRY_ALL_PLANES, // 0 <= C < 360
    SR_PHOTOMETRY_AXIAL,      // one
    SR_PHOTOMETRY_C0_C180,    // 0 … 180: I(C) = I(-C)
    SR_PHOTOMETRY_C90_C270,   // 90 … 270: I(C) = I(180 - C)
    SR_PHOTOMETRY_QUADRANT,   // 0 … 90: both
};

struct sr_photometry_word {
    const char *key; // as in IES files, without brackets: "MANUFAC"; "" for lines that have none
    const char *text;
};

struct sr_photometry {
    enum sr_photometry_format format;
    int year; // of LM-63: 1986, 1991, 1995, 2002, 2019
    enum sr_photometry_symmetry symmetry;
    uint32_t c_count, gamma_count; // [1]
    const float *c, *gamma;        // [deg] increasing
    const float *candela;          // [cd] c_count * gamma_count, plane by plane; all of the file's factors are in them
    uint32_t lamp_count;           // [1]
    float lamp_flux;               // [lm] of all lamps together; NaN: absolute photometry
    float power_W;                 // [W] that it draws; 0: not told
    float along_c0, along_c90,
        height; // [m] of the luminous opening, along C0-C180, along C90-C270, vertically; 0: a point
    bool is_round;
    const struct sr_photometry_word *words;
    uint32_t word_count;
    const char *note; // what was assumed where the file leaves it open, and what is odd; "" for nothing
};

/* The format is told by the content. Everything is kept in the arena. What is wrong is told as file:line: what. */
sr_status sr_photometry_read(const char *path, struct sr_arena *arena, const struct sr_photometry **out,
                             struct sr_error *error);
sr_status sr_photometry_parse(const char *name, const void *data, size_t size, struct sr_arena *arena,
                              const struct sr_photometry **out, struct sr_error *error);
/* Whether a file made of these bytes would be taken for a luminaire: by its first lines. */
bool sr_photometry_is(const void *data, size_t size);

/* Intensity [cd], bilinear between the angles, 0 above and below the measured ones. */
double sr_photometry_intensity(const struct sr_photometry *p, double c_deg, double gamma_deg);
double sr_photometry_intensity_along(const struct sr_photometry *p, sr_vec3 d); // d: local, of unit length
/* Flux [lm] between two angles gamma. */
double sr_photometry_flux(const struct sr_photometry *p, double gamma_from, double gamma_to);
const char *sr_photometry_word(const struct sr_photometry *p, const char *key); // or NULL

struct sr_photometry_report {
    double flux, flux_down;          // [lm]
    double peak, peak_c, peak_gamma; // [cd], [deg]
    double beam[2],
        field[2];    // [deg] full angles where 50 % and 10 % of the plane's peak are crossed: C0-C180, C90-C270
    double efficacy; // [lm/W] NaN: not known
    double light_output_ratio; // [1] flux over that of the lamps; NaN: not known
};
void sr_photometry_report(const struct sr_photometry *p, struct sr_photometry_report *out);

/* By the ending .ies or .ldt. IES files are of p->year, or of 2002 where it is 0. Texts that are longer than the format
 * allows are cut. Not kept: TILT; in LDT words without a line there; in IES all but length, width and height of the
 * opening. */
sr_status sr_photometry_write(const char *path, const struct sr_photometry *p, struct sr_error *error);
/* The same as a text, which is followed by a NUL; to be freed with sr_free. */
sr_status sr_photometry_print(const struct sr_photometry *p, enum sr_photometry_format format, char **text,
                              size_t *size, struct sr_error *error);

/* ---- drawing directions in proportion to intensity ---- */

struct sr_photometry_guide {
    struct sr_piecewise2 *density; // over C / 360 and gamma / 180
    double *cosine;                // of the borders of its rows
    double flux;                   // [lm] of the photometry
};
bool sr_photometry_guide_build(const struct sr_photometry *p, struct sr_arena *arena,
                               struct sr_photometry_guide *guide);
sr_vec3 sr_photometry_sample(const struct sr_photometry_guide *guide, sr_vec2 u, float *pdf); // local; pdf [1/sr]
float sr_photometry_pdf(const struct sr_photometry_guide *guide, sr_vec3 d);                  // [1/sr]

#endif
