/* SPDX-License-Identifier: MIT */
/* Scattering as somebody measured it: files of BSDF data, read, judged, evaluated, sampled and written. (Luminaires:
 * photometry.h.)
 *
 * Directions are those of the room bsdf/: local, normal +z, wo toward the viewer, wi toward the light, both pointing
 * away from the surface. f is in sr^-1, without the cosine, whatever the file keeps. */
#ifndef SR_MEASURED_MEASURED_H
#define SR_MEASURED_MEASURED_H

#include "measured/photometry.h"
#include "sample/sample.h"
#include "spectrum/spectrum.h"

enum sr_measured_format {
    SR_MEASURED_MERL,      // MERL binary: 90 x 90 x 180 doubles, three times (Matusik et al. 2003)
    SR_MEASURED_RGL,       // RGL/EPFL tensor file, adaptive (Dupuy & Jakob 2018)
    SR_MEASURED_POLARISED, // tensor file of Mueller matrices (Baek et al. 2020): its intensity
    SR_MEASURED_KLEMS,     // LBNL/WINDOW XML, matrices over Klems' patches
    SR_MEASURED_TREE,      // LBNL/Radiance XML, tensor trees of rank 3 and 4
    SR_MEASURED_CORNELL,   // Cornell's irregular goniometer data
    SR_MEASURED_ASTM,      // ASTM E1392 text
    SR_MEASURED_ABG,       // coefficients A, B, g
    SR_MEASURED_TABLE,     // plain text, one measurement a line
};
const char *sr_measured_format_name(enum sr_measured_format format);

/* What a file's numbers are, where its format leaves that open (TABLE, ASTM, CORNELL; TABLE and ASTM may say it). */
enum sr_measured_quantity {
    SR_MEASURED_AUTO,         // as the file says, else the BSDF
    SR_MEASURED_BSDF,         // f [1/sr]
    SR_MEASURED_TIMES_COSINE, // f cos_theta_o [1/sr]: radiant intensity over flux, "cosine-corrected"
    SR_MEASURED_FACTOR,       // pi f [1]: reflectance factor, against a perfect diffuser
};
enum sr_measured_angles { SR_MEASURED_ANGLES_AUTO, SR_MEASURED_DEGREES, SR_MEASURED_RADIANS };
struct sr_measured_options { // all zero: as the file says
    int32_t quantity;        // enum sr_measured_quantity
    int32_t angles;          // enum sr_measured_angles, for TABLE and ASTM
};

/* Data of one file; never changes once read. */
struct sr_measured;

/* The format is told by the content, never by the file's ending. Everything is kept in the arena: less than a small
 * multiple of the file's size, and at most 16 MB for drawing directions. What is wrong is told as file, place,
 * expectation. */
sr_status sr_measured_read(const char *path, const struct sr_measured_options *options, struct sr_arena *arena,
                           const struct sr_measured **out, struct sr_error *error);
/* The same from bytes in memory; name is for messages. The bytes may go when it returns. */
sr_status sr_measured_parse(const char *name, const void *data, size_t size, const struct sr_measured_options *options,
                            struct sr_arena *arena, const struct sr_measured **out, struct sr_error *error);

enum { SR_MEASURED_REFLECTION = 1, SR_MEASURED_TRANSMISSION = 2 };
uint32_t sr_measured_sides(const struct sr_measured *m); // which of both the data has

/* f [1/sr] at wavelengths [nm]. No allocation, no locks. Beyond the measured wavelengths the nearest one counts. RGB
 * becomes a spectrum by the uplift of the room spectrum/. */
sr_spectrum sr_measured_f(const struct sr_measured *m, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda);
/* Density [1/sr] of directions that sample draws, in proportion to the mean of f |cos_theta_i| over the wavelengths. */
float sr_measured_pdf(const struct sr_measured *m, sr_vec3 wo, sr_vec3 wi);
/* False: the draw is lost below the horizon; pdf then integrates to less than 1 by that share. */
bool sr_measured_sample(const struct sr_measured *m, sr_vec3 wo, float u_lobe, sr_vec2 u, sr_vec3 *wi, float *pdf);
/* Share of the light that arrives from wi which leaves on wi's side (SR_MEASURED_REFLECTION) or on the other, by
 * quadrature with n^2 nodes; exact where the data are constant over patches. */
sr_spectrum sr_measured_albedo(const struct sr_measured *m, sr_vec3 wi, uint32_t side, sr_spectrum lambda, int n);

/* ---- what the data are worth ---- */

enum { SR_MEASURED_REPORT_ANGLES = 9 };
struct sr_measured_report {
    const char *format, *description; // description as the file gives it; "" where it gives none
    const char *quantity;             // "BSDF", "BSDF times cosine", "reflectance factor": as it was read
    const char *note;                 // what was assumed where the file is silent; "" for nothing
    uint32_t sides;
    int channels; // 1 grey, 3 RGB unless is_spectral
    bool is_spectral, is_isotropic;
    float lambda_min, lambda_max; // [nm] of spectral data
    uint64_t values;              // numbers in the file that describe scattering
    uint64_t invalid;             // of them marked as invalid (MERL), not a number (POLARISED) or negative: taken as 0
    float theta_i_min, theta_i_max; // [deg] angular coverage of incidence
    float theta_o_min, theta_o_max; // [deg] and of leaving
    double coverage;                // [1] share of all pairs of directions (by projected solid angle) inside of it
    struct {
        double theta;                  // [deg] of the light that arrives: 0, 10, … 80
        double reflected, transmitted; // [1] total integrated scatter, mean of 8 wavelengths
    } scatter[SR_MEASURED_REPORT_ANGLES];
    double largest_albedo; // [1] most light returned for 1 that arrives, reflected and transmitted, any wavelength
    double largest_theta, largest_phi;               // [deg] from where it arrives; theta above 90: from behind
    double largest_lambda;                           // [nm]
    double reciprocity_mean;                         // [1] mean of |f(a, b) - f(b, a)| over mean of f, by random pairs
    double reciprocity_max;                          // [1] largest |f(a, b) - f(b, a)| / the greater of them
    double reciprocity_theta[2], reciprocity_phi[2]; // [deg] of that pair
};
void sr_measured_report(const struct sr_measured *m, struct sr_measured_report *out);

/* ---- writers: of anything that can be evaluated ---- */

typedef sr_spectrum (*sr_measured_source)(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda); // f [1/sr]

/* MERL binary: linear sRGB of each cell's centre under D65; isotropic reflection only. 33 MiB. */
sr_status sr_measured_write_merl(const char *path, sr_measured_source f, void *user, struct sr_error *error);
/* Plain text over a full grid; zero members take the defaults. */
struct sr_measured_table_grid {
    int theta_count;  // 19: from 0 to 89 deg
    int phi_count;    // 25: of the difference of azimuths, from 0 to 180 deg; anisotropic: of both, over the turn
    int lambda_count; // 10
    float lambda_min, lambda_max; // [nm] 380, 740
    bool is_anisotropic, has_transmission;
};
sr_status sr_measured_write_table(const char *path, const struct sr_measured_table_grid *grid, sr_measured_source f,
                                  void *user, struct sr_error *error);
/* RGL's adaptive tensor file, isotropic, spectral: readable by all who read theirs. */
struct sr_measured_rgl_grid {
    int theta_count;              // 16 directions of incidence
    int resolution;               // 32 x 32 directions of leaving
    int lambda_count;             // 16
    float lambda_min, lambda_max; // [nm] 360, 810
};
sr_status sr_measured_write_rgl(const char *path, const struct sr_measured_rgl_grid *grid, sr_measured_source f,
                                void *user, struct sr_error *error);

#endif
