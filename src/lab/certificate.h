/* SPDX-License-Identifier: MIT */
/* What the files of the certificate share. */
#ifndef SR_LAB_CERTIFICATE_H
#define SR_LAB_CERTIFICATE_H

#include "lab/lab.h"

/* ---- subject.c: what a certificate is about: a specimen, or a model with drawn parameters ---- */

struct subject {
    const struct sr_specimen *specimen; // NULL: drawn
    const struct sr_bsdf_model *model;  // whose table was drawn from
    const struct sr_bsdf *b;            // at.bsdf
    bool is_random;                     // f of these parameters depends on the seed
    bool is_proportional;               // some sample knows its density up to a factor only
    bool transmits;
    double asymmetry, largest_albedo;             // [1] documented; the albedo is 1 where nothing is
    _Alignas(64) unsigned char raw[SR_BSDF_SIZE]; // parameters as drawn, before the model got ready
    struct sr_specimen_at at;
};

/* How a set of parameters is drawn; also which end of a row's range is asked for. */
struct lab_drawing {
    int row;     // -1: all rows at random; else this row of the table is at its end
    bool at_max; // which end
    bool plain;  // the other rows have their defaults
    bool broad;  // no slopes below 0.01 [1], for quadratures: a ridge of 1e-4 by 1 would ask for 1e8 points
};
/* Draws within the table's ranges. What models load goes to the arena. */
sr_status lab_draw(const struct sr_bsdf_model *model, struct sr_rng *rng, struct lab_drawing how,
                   struct sr_arena *arena, struct subject *s, struct sr_error *error);
void lab_subject_of_specimen(const struct sr_specimen *specimen, struct subject *s);
void lab_reseed(struct subject *s, uint32_t seed); // another random walk, where f is one
/* "alpha_x = 0.02, eta = 1.5", of spectra the value at one wavelength. */
void lab_describe(const struct subject *s, int wavelength, char *text, size_t size);
/* Whether certificates can draw from the table: files cannot be drawn. */
bool lab_can_draw(const struct sr_bsdf_model *model);

/* ---- directions ---- */

static inline float lab_u(struct sr_rng *rng)
{
    return sr_rng_float(rng);
}
static inline sr_vec2 lab_square(struct sr_rng *rng)
{
    float x = sr_rng_float(rng);
    return (sr_vec2){x, sr_rng_float(rng)};
}
sr_vec3 lab_sphere(struct sr_rng *rng);   // uniform
sr_vec3 lab_anywhere(struct sr_rng *rng); // often grazing, sometimes vertical
static inline double lab_theta_deg(sr_vec3 w)
{
    return atan2(sqrt((double)(w.x * w.x + w.y * w.y)), (double)w.z) * 180 / M_PI;
}
static inline double lab_phi_deg(sr_vec3 w)
{
    return atan2((double)w.y, (double)w.x) * 180 / M_PI;
}

/* ---- what the parts of a certificate find ---- */

enum check {
    CHECK_FINITE,
    CHECK_NON_NEGATIVE,
    CHECK_RECIPROCITY,
    CHECK_ADJOINT,
    CHECK_ENERGY,
    CHECK_ALBEDO,
    CHECK_NORMALISATION,
    CHECK_LOST,
    CHECK_SAMPLING,
    CHECK_LIGHT,
    CHECK_F_PDF,
    CHECK_SAMPLE,
    CHECK_SUPPORT,
    CHECK_LOBES,
    CHECK_DOUBLE,
    CHECK_GRAZING,
    CHECK_NORMAL,
    CHECK_ENDS,
    CHECKS
};

struct finding {
    uint64_t count;  // of things looked at; 0: skipped
    double measured; // [unit of the check] the worst
    bool failed;
    char text[200]; // of the worst; where nothing was looked at: why
};

struct findings {
    struct finding of[CHECKS];
    double lost, lost_variance, lost_slack; // [samples] in excess of what the density leaves over, over all sets
    double light_z;                         // [1] sum of z of the moment 1
    uint32_t light_count;
    uint64_t evaluations;
};

struct certifying {
    const struct sr_certificate_options *options;
    struct findings *findings;
    struct sr_error *error; // of the resources that checks take
    struct subject *subject;
    struct sr_rng rng;
    uint32_t samples;    // of one statistical test
    uint32_t directions; // viewers of each set
    double p;            // [1] below which one statistical test of the family fails
    double z;            // [1] the same as deviations of a normal distribution, two-sided
};

/* Records a measurement: the greatest is kept, with its text, and any failure. Takes the text's arguments as printf. */
SR_PRINTF(5, 6)
void lab_find(struct certifying *c, enum check check, double measured, bool failed, const char *format, ...);
/* Only where nothing was looked at in any set. */
void lab_skip(struct certifying *c, enum check check, const char *why);

// finite, not negative, reciprocal, adjoint, agreeing, of the lobes it tells
void lab_check_pairs(struct certifying *c);
void lab_check_extremes(struct certifying *c); // grazing and vertical
void lab_check_double(struct certifying *c);
void lab_check_sampling(struct certifying *c); // normalisation, chi-square, moments of light
void lab_check_energy(struct certifying *c);   // largest albedo, closed form
/* One parameter at an end of its range: finite, not negative, of no more energy than elsewhere. */
void lab_check_end(struct certifying *c, const char *name, bool at_max);
/* Largest E(wo) [1] over wavelengths by n samples that fill the square evenly; *k: of which wavelength. */
double lab_albedo(struct subject *s, sr_vec3 wo, uint32_t n, int *k);
/* Whether E(wo) at a wavelength is above what is allowed, by fresh random samples; their mean and its standard error.
 */
bool lab_gains_energy(struct certifying *c, sr_vec3 wo, int k, double *mean, double *error);
/* What f and pdf change under directions that are a few roundings apart: the largest of sixteen movements, fourfold. */
void lab_sensitivity(const struct subject *s, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode, sr_spectrum *df,
                     float *dpdf);
/* The difference of two values beyond the slack, relative to the larger; NaN counts as 1. */
double lab_apart(double a, double b, double slack);
/* Beyond z deviations, what a mean of bounded summands may be off by: ln(2 / p) times the largest share of a single one
 * (Bernstein 1924, with the largest that was met for the bound). Means of few bright walks are not normally
 * distributed. */
static inline double lab_bernstein(const struct certifying *c, double largest)
{
    return log(2 / c->p) * largest;
}
#define LAB_EQUAL 2e-3 // [1] relative deviation between values that ought to be equal
/* A partner for wo: anywhere, where the sampler looks, near the mirror direction, or straight back. */
sr_vec3 lab_partner(struct certifying *c, sr_vec3 wo);
/* f, pdf and a sample at a pair of directions: NaN, infinite or negative values are found. The soak calls it. */
bool lab_check_values(struct certifying *c, enum check finite, enum check negative, sr_vec3 wo, sr_vec3 wi);

#endif
