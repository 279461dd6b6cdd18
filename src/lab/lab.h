/* SPDX-License-Identifier: MIT */
/* The BRDF laboratory: a BSDF as a specimen, read from words; its reflectances, its certificate.
 *
 * A specimen is what `steradian brdf` is told on the command line; it needs no scene. Directions are those of the room
 * bsdf/: local, normal +z, both away from the surface. */
#ifndef SR_LAB_LAB_H
#define SR_LAB_LAB_H

#include "bsdf/bsdf.h"
#include "material/material.h"

/* ---- specimens ---- */

enum { SR_SPECIMEN_PARTS = 8 };

/* A weighted sum of BSDFs. One part of weight 1 is the plain case. */
struct sr_specimen {
    const char *title; // the words it was read from
    int part_count;
    struct sr_specimen_part {
        struct sr_material material;
        float weight;                      // [1]
        const struct sr_bsdf_model *model; // NULL: the material of a scene
    } parts[SR_SPECIMEN_PARTS];
};

/* Reads words: MODEL [name=value …], or a file of measured data, or SCENE.pbrt:MATERIAL; parts are joined by "+", and a
 * part may begin with a weight: .3*MODEL. A value is a number, for spectra also a name (metal-Au-eta), a file of "nm
 * value" lines, or rgb:R,G,B or nm:value,nm:value,…. Unknown names and values out of range are errors that say what was
 * expected. Everything is kept in the arena. */
sr_status sr_specimen_read(struct sr_arena *arena, int count, const char *const *words, struct sr_specimen *specimen,
                           struct sr_log log, struct sr_error *error);

/* A specimen at wavelengths [nm]: what can be evaluated. at->bsdf points into *at: do not copy it. */
struct sr_specimen_at {
    sr_spectrum lambda;  // [nm]
    struct sr_bsdf bsdf; // of one part; or the sum of parts[], a model of its own
    struct sr_bsdf parts[SR_SPECIMEN_PARTS];
};
void sr_specimen_at(const struct sr_specimen *specimen, sr_spectrum lambda, uint32_t seed, struct sr_specimen_at *at);

/* ---- the same models in double precision ---- */

/* Every model's file is compiled a second time with double in place of float. The twin of a BSDF (of one model, or a
 * sum) has the parameters of its table; *twin is NULL where there is none (measured data). A parameter is a float; the
 * twin has either that number, or the shortest decimal that rounds to it: what somebody has typed. */
struct sr_twin;
enum sr_twin_numbers { SR_TWIN_SAME, SR_TWIN_DECIMAL };
sr_status sr_twin_make(struct sr_arena *arena, const struct sr_bsdf *bsdf, sr_spectrum lambda,
                       enum sr_twin_numbers numbers, const struct sr_twin **twin, struct sr_error *error);
void sr_twin_f(const struct sr_twin *twin, const double wo[3], const double wi[3], enum sr_transport mode,
               double f[SR_LAMBDA_COUNT]); // [1/sr]
double sr_twin_pdf(const struct sr_twin *twin, const double wo[3], const double wi[3],
                   enum sr_transport mode); // [1/sr]

/* ---- reflectance between solid angles (Nicodemus et al. 1977) ---- */

enum sr_beam_kind { SR_BEAM_DIRECTION, SR_BEAM_CONE, SR_BEAM_HEMISPHERE };
struct sr_beam {
    enum sr_beam_kind kind;
    double theta, phi; // [deg] of the direction or of the cone's axis
    double half_angle; // [deg] of the cone, above 0; no part of it may lie below the horizon
};
sr_status sr_beam_read(const char *text, struct sr_beam *beam,
                       struct sr_error *error); // direction:T[,P] cone:T,P,H hemisphere

struct sr_reflectance {
    const char *name;                    // Nicodemus': "biconical reflectance", …
    const char *unit;                    // "1", or "sr^-1" where light leaves into a single direction
    double value[SR_LAMBDA_COUNT];       // [unit]
    double error[SR_LAMBDA_COUNT];       // [unit] cubature: a bound; Monte Carlo: the standard error
    double factor[SR_LAMBDA_COUNT];      // [1] reflectance factor: over that of a perfect diffuser in the same geometry
    double projected_from, projected_to; // [sr] projected solid angles
    uint64_t evaluations;
    bool has_converged;
};
/* By adaptive cubature of the specimen in double where it has a twin, to a relative tolerance; delta lobes are counted
 * where they can be (directional-hemispherical) and refused elsewhere. */
sr_status sr_reflectance_cubature(const struct sr_specimen *specimen, sr_spectrum lambda, const struct sr_beam *from,
                                  const struct sr_beam *to, double tolerance, struct sr_reflectance *out,
                                  struct sr_error *error);
/* By the specimen's own sampler where light is gathered, in `samples` samples. */
sr_status sr_reflectance_monte_carlo(const struct sr_specimen *specimen, sr_spectrum lambda, const struct sr_beam *from,
                                     const struct sr_beam *to, uint64_t samples, uint32_t seed,
                                     struct sr_reflectance *out, struct sr_error *error);

/* What an observer sees of it under an illuminant: by cubature at every 5 nm, linear between. */
struct sr_reflectance_colour {
    const char *name, *unit; // of the reflectance
    double luminous;         // [unit] INTEGRAL rho S V / INTEGRAL S V
    double error;            // [unit] bound of the luminous one, of the cubature alone
    double xyz[3];           // [1] tristimulus values of the reflectance factor: Y = 1 of the perfect diffuser
    uint64_t evaluations;
    bool has_converged;
};
sr_status sr_reflectance_colour(const struct sr_specimen *specimen, const struct sr_spd *illuminant,
                                const struct sr_beam *from, const struct sr_beam *to, double tolerance,
                                struct sr_reflectance_colour *out, struct sr_error *error);

/* ---- the certificate ---- */

enum sr_verdict {
    SR_PASSED,
    SR_DOCUMENTED,
    SR_FAILED,
    SR_SKIPPED
}; // DOCUMENTED: deviates by what the model's table says
struct sr_check {
    const char *name; // "reciprocity"
    enum sr_verdict verdict;
    double measured, limit; // [unit]
    const char *unit;
    uint64_t count; // of pairs, samples, or statistical tests
    char text[200]; // where and how: "largest at theta_o = 71 deg, alpha = 0.02"
};
struct sr_certificate {
    struct sr_check checks[24];
    int count;
    bool passed;          // no check failed
    uint64_t evaluations; // of f, pdf or sample, about
};
struct sr_certificate_options {
    uint32_t sets;    // parameter sets drawn from the table; 0: only the parameters given
    uint32_t samples; // per set for statistical tests
    uint32_t seed;
    double significance; // [1] of the whole family of statistical tests, such as 1e-6
};
/* Of a model with parameters drawn from its table, or, options->sets = 0, of the specimen as it is. */
sr_status sr_certify(const struct sr_specimen *specimen, const struct sr_certificate_options *options,
                     struct sr_certificate *out, struct sr_error *error);
/* The same for a model that no list knows; how the tests see that broken models are caught. */
sr_status sr_certify_model(const struct sr_bsdf_model *model, const struct sr_certificate_options *options,
                           struct sr_certificate *out, struct sr_error *error);
/* Calls f, pdf and sample, `calls` times in all, over parameter sets and directions of all kinds, and looks for NaN,
 * infinite and negative values only: adds a check "soak" to the certificate. Of the specimen as it is where
 * options->sets is 0 or its parameters cannot be drawn. */
sr_status sr_soak(const struct sr_specimen *specimen, uint64_t calls, const struct sr_certificate_options *options,
                  struct sr_certificate *certificate, struct sr_error *error);

/* ---- fitting ---- */

/* How residuals are counted, for g = f |cos theta_i|: the cube root weighs dark and bright parts of a lobe alike as
 * eyes do; the logarithm counts relative errors (above a thousandth of the mean); linear counts light. */
enum sr_fit_metric { SR_FIT_CUBE_ROOT, SR_FIT_LOG, SR_FIT_LINEAR };

enum { SR_FIT_PARAMETERS = 64 };
struct sr_fit_options {
    sr_spectrum lambda; // [nm] at which the data is asked; spectra get one value for each of the first
    int lambda_count;   // of them, 1 … SR_LAMBDA_COUNT; all other parameters are shared
    uint32_t points;    // pairs of directions
    uint32_t starts;    // from where the search begins: the given parameters, and others from the table's ranges
    uint32_t seed;
    double theta_max; // [deg] of wi and wo
    enum sr_fit_metric metric;
    int fixed_count;
    const char *const *fixed; // names of parameters that stay as they are
};
struct sr_fit_parameter {
    const char *name, *unit;
    double lambda;               // [nm] of a value of a spectrum; 0: for all
    double value;                // [unit]
    double standard_uncertainty; // [unit] of the residuals' scatter; NaN where the value stands at an end of its range
    bool is_at_bound;
};
struct sr_fit_point {
    sr_vec3 wo, wi;
    double data[SR_LAMBDA_COUNT], model[SR_LAMBDA_COUNT]; // [1/sr] f
};
struct sr_fit {
    const struct sr_bsdf_model *model;
    struct sr_fit_parameter parameters[SR_FIT_PARAMETERS];
    int count;
    double degrees_of_freedom; // [1] residuals less parameters
    double rms;                // [1] of the residuals in the metric, over that of the data
    double rms_relative;       // [1] of (model - data) |cos theta_i|, over that of the data
    bool has_converged;
    const char *words; // the fitted specimen, to be read by sr_specimen_read
    const struct sr_fit_point *points;
    uint32_t point_count;
};
/* Pairs of directions where a specimen has data (f above 0), half where its sampler sends light, half over the
 * hemisphere. */
sr_status sr_fit_gather(struct sr_arena *arena, const struct sr_specimen *data, const struct sr_fit_options *options,
                        struct sr_fit_point **points, uint32_t *count, struct sr_error *error);
/* Least squares (Levenberg & Marquardt) of a model of the list to these points, whose model values it fills in. `model`
 * gives the model, the first starting point and what is fixed; it must have one part of weight 1. Keeps all in the
 * arena. */
sr_status sr_fit_points(struct sr_arena *arena, struct sr_fit_point *points, uint32_t count,
                        const struct sr_specimen *model, const struct sr_fit_options *options, struct sr_fit *fit,
                        struct sr_error *error);

/* ---- what pictures of a specimen show ---- */

/* f [1/sr] of pairs of directions, radiance form; where f is a random estimate, its mean over that many seeds. */
void sr_specimen_f(const struct sr_specimen *specimen, sr_spectrum lambda, const sr_vec3 *wo, const sr_vec3 *wi,
                   size_t count, uint32_t seeds, sr_spectrum *f);
/* What becomes of light that arrives from w, by the specimen's sampler with that many draws of a Sobol' net. */
struct sr_specimen_albedo {
    sr_spectrum reflected, transmitted; // [1] shares of the arriving flux
};
struct sr_specimen_albedo sr_specimen_albedo(const struct sr_specimen *specimen, sr_spectrum lambda, sr_vec3 w,
                                             uint32_t draws);
/* Where light from w goes as from a mirror or through a pane, and its share; how many there are. */
struct sr_delta {
    sr_vec3 direction;
    sr_spectrum albedo; // [1]
};
enum { SR_DELTAS = 4 };
int sr_specimen_deltas(const struct sr_specimen *specimen, sr_spectrum lambda, sr_vec3 w,
                       struct sr_delta deltas[SR_DELTAS]);

/* Colour under D65 by 48 wavelengths of 8 nm from 384 to 760 nm: a few sets after each other. Of values that are 1 at
 * all wavelengths, Y is 1 and the colour is white. */
enum { SR_COLOUR_SETS = 48 / SR_LAMBDA_COUNT };
sr_spectrum sr_colour_lambda(int set);
void sr_colour_add(int set, sr_spectrum values, double xyz[3]);

/* A ball of the specimen, seen from afar, as sRGB: size * size * 3 bytes, the top row first, on white. The sky has a
 * bright round light of 24 deg at the upper left, over a horizon; point: nothing but a sun of half a degree there.
 * Light passes through a ball that transmits. The tangent runs along the circles of latitude. */
enum sr_ball_light { SR_BALL_SKY, SR_BALL_POINT };
sr_status sr_specimen_ball(const struct sr_specimen *specimen, enum sr_ball_light light, uint32_t size,
                           uint32_t samples, uint8_t *srgb, struct sr_error *error);

#endif
