/* SPDX-License-Identifier: MIT */
/* The BRDF laboratory: scattering models and measured data, evaluated, sampled, integrated and certified without a
 * scene.
 *
 * Directions are of unit length in the surface's own frame: normal +z, tangent +x; wo points toward the viewer, wi
 * toward the light, both away from the surface. f is in sr^-1, without the cosine. Where light passes into another
 * medium f is the radiance form. A struct sr_brdf never changes: any number of threads may use it at a time. */
#ifndef STERADIAN_BSDF_H
#define STERADIAN_BSDF_H

#include "base.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what there is ---- */

/* The name of the index-th model, such as "ward"; NULL past the last. */
SR_API const char *sr_brdf_model(int index);
/* "Ward 1992", the source and the limits in one sentence each; NULL for unknown models or where nothing is to be said.
 */
SR_API const char *sr_brdf_model_title(const char *model);
SR_API const char *sr_brdf_model_source(const char *model);
SR_API const char *sr_brdf_model_limits(const char *model);

enum sr_brdf_parameter_kind {
    SR_BRDF_NUMBER,  /* a number */
    SR_BRDF_INTEGER, /* a whole number */
    SR_BRDF_SWITCH,  /* true or false */
    SR_BRDF_CHOICE,  /* one of the words in text, which are parted by | */
    SR_BRDF_FILE,    /* a path */
    SR_BRDF_SPECTRUM /* a number for all wavelengths, a name ("metal-Au-eta"), rgb:R,G,B or nm:value,nm:value,... */
};
struct sr_brdf_parameter {
    enum sr_brdf_parameter_kind kind;
    const char *name, *unit, *text;
    double least;   /* [unit] */
    double most;    /* [unit] */
    double initial; /* [unit] where none is given */
};
/* The index-th parameter of a model; false past the last. */
SR_API bool sr_brdf_model_parameter(const char *model, int index, struct sr_brdf_parameter *parameter);

/* ---- one of them ---- */

struct sr_brdf;

/* Makes one from words as on the command line: "ward alpha_x=.1 alpha_y=.3", "diffuse reflectance=.3 + blinn_phong
 * specular=.4", a file of measured data, or "scene.pbrt:material". On failure *brdf is NULL and error (if not NULL, of
 * size error_size) holds one sentence: what is wrong, and what was expected. */
SR_API sr_status sr_brdf_create(const char *words, struct sr_brdf **brdf, char *error, size_t error_size);
SR_API void sr_brdf_destroy(struct sr_brdf *brdf); /* NULL is fine */

/* f [1/sr] and pdf [1/sr], with which sr_brdf_draw draws wi, for count pairs of directions at one wavelength. f or
 * pdf may be NULL. Mirrors and clear glass are 0 here: only samples find them. */
SR_API void sr_brdf_evaluate(const struct sr_brdf *brdf, double lambda_nm /* [nm] */, size_t count,
                             const float (*wo)[3], const float (*wi)[3], float *f /* [1/sr] */,
                             float *pdf /* [1/sr] */);

struct sr_brdf_sample {
    float wi[3]; /* [1] */
    float f;     /* [1/sr] of mirrors: f |cos_theta_i| / pdf is the share of light */
    float pdf;   /* [1/sr] of mirrors: the probability of being drawn; 0: nothing was drawn, the light is lost */
    bool is_mirror;
};
/* Draws count directions wi for as many wo from numbers u, each in [0, 1): first the choice of a lobe, then the
 * direction. Of other numbers nothing is drawn. */
SR_API void sr_brdf_draw(const struct sr_brdf *brdf, double lambda_nm /* [nm] */, size_t count, const float (*wo)[3],
                         const float (*u)[3], struct sr_brdf_sample *samples);

/* ---- reflectance between two solid angles (Nicodemus et al., NBS Monograph 160, 1977) ---- */

struct sr_brdf_reflectance {
    const char *name; /* "directional-hemispherical reflectance" */
    const char *unit; /* "1", or "sr^-1" where light leaves into a single direction */
    double value;     /* [unit] */
    double error;     /* [unit] bound of the cubature's error */
    double factor;    /* [1] reflectance factor: over that of a perfect diffuser in the same geometry */
};
/* From and to: "direction:THETA[,PHI]", "cone:THETA,PHI,HALF" or "hemisphere", in degrees. tolerance: relative, such as
 * 1e-6, from 1e-14 to 0.1. */
SR_API sr_status sr_brdf_reflectance(const struct sr_brdf *brdf, double lambda_nm /* [nm] */, const char *from,
                                     const char *to, double tolerance /* [1] */, struct sr_brdf_reflectance *out,
                                     char *error, size_t error_size);
/* The share of light from wo, theta_deg from the normal at azimuth phi_deg, that is scattered at all: the
 * directional-hemispherical reflectance, plus transmittance. By sampling; *standard_error may be NULL. NaN is what
 * nobody can know: the share of no samples, the error of one. */
SR_API double sr_brdf_albedo(const struct sr_brdf *brdf, double lambda_nm /* [nm] */, double theta_deg /* [deg] */,
                             double phi_deg /* [deg] */, uint32_t samples, double *standard_error /* [1] */);

/* ---- the certificate ---- */

enum sr_brdf_verdict { SR_BRDF_PASSED, SR_BRDF_DOCUMENTED, SR_BRDF_FAILED, SR_BRDF_SKIPPED };
/* Runs the laboratory's checks, on parameters drawn from the model's table (sets of them) or on the BRDF as it is (sets
 * 0), and tells each by a call: what was checked, the verdict, what was measured, the limit, and a sentence.
 * SR_ERROR_CHECK: one failed. */
SR_API sr_status sr_brdf_check(const struct sr_brdf *brdf, uint32_t sets, uint32_t seed,
                               void (*tell)(void *user, const char *check, enum sr_brdf_verdict verdict,
                                            double measured /* [1] */, double limit /* [1] */, const char *text),
                               void *user, char *error, size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
