/* SPDX-License-Identifier: MIT */
/* Wavelengths, spectral values, spectral distributions, colour and photometry.
 *
 * A path carries SR_LAMBDA_COUNT wavelengths at a time; sr_spectrum holds one value for each, and has operators:
 * f * L * cos_theta_i. Spectral distributions over all wavelengths are struct sr_spd. */
#ifndef SR_SPECTRUM_SPECTRUM_H
#define SR_SPECTRUM_SPECTRUM_H

#include "base/base.h"
#include "math/math.h"

#ifndef SR_LAMBDA_COUNT
#define SR_LAMBDA_COUNT 8
#endif

typedef float sr_spectrum __attribute__((vector_size(SR_LAMBDA_COUNT * sizeof(float))));
#ifdef SR_DOUBLE // the laboratory compiles the models a second time with double in place of float
typedef int64_t sr_lane;
#define SR_LANE_MAX INT64_MAX
#else
typedef int32_t sr_lane; // an integer of the size of a component
#define SR_LANE_MAX INT32_MAX
#endif
typedef sr_lane sr_spectrum_int __attribute__((vector_size(SR_LAMBDA_COUNT * sizeof(sr_lane))));

#define SR_BLACK ((sr_spectrum){0})
#define SR_ONE (SR_BLACK + 1.0f)

/* For each component a where the mask (of a comparison) is true, b elsewhere: C has no ?: for vectors. */
static inline sr_spectrum sr_spectrum_select(sr_spectrum_int mask, sr_spectrum a, sr_spectrum b)
{
    return (sr_spectrum)((mask & (sr_spectrum_int)a) | (~mask & (sr_spectrum_int)b));
}
static inline sr_spectrum sr_spectrum_abs(sr_spectrum s)
{
    return (sr_spectrum)((sr_spectrum_int)s & SR_LANE_MAX);
}
/* In pairs, so that no step waits for all before it. */
static inline float sr_spectrum_max(sr_spectrum s)
{
    for (int n = SR_LAMBDA_COUNT / 2; n > 0; n /= 2)
        for (int i = 0; i < n; ++i)
            s[i] = s[i] > s[i + n] ? s[i] : s[i + n];
    return s[0];
}
static inline float sr_spectrum_mean(sr_spectrum s)
{
    for (int n = SR_LAMBDA_COUNT / 2; n > 0; n /= 2)
        for (int i = 0; i < n; ++i)
            s[i] += s[i + n];
    return s[0] * (1.0f / SR_LAMBDA_COUNT);
}
/* Whether the mask (of a comparison) is true for any component. */
static inline bool sr_spectrum_any(sr_spectrum_int mask)
{
#if defined(__AVX__) && SR_LAMBDA_COUNT == 8 && !defined(float)
    return __builtin_ia32_movmskps256((sr_spectrum)mask) != 0;
#else
    typedef uint64_t words __attribute__((vector_size(sizeof(sr_spectrum_int))));
    words w = (words)mask;
    uint64_t any = 0;
    for (size_t i = 0; i < sizeof w / sizeof any; ++i)
        any |= w[i];
    return any != 0;
#endif
}
static inline bool sr_spectrum_is_black(sr_spectrum s)
{
    return !sr_spectrum_any(s != 0.0f);
}
static inline bool sr_spectrum_is_finite(sr_spectrum s)
{
    return !sr_spectrum_any(s - s != 0.0f); // NaN where s is not finite
}
static inline sr_spectrum sr_spectrum_sqrt(sr_spectrum s)
{
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        s[i] = sqrtf(s[i] > 0 ? s[i] : 0);
    return s;
}
static inline sr_spectrum sr_spectrum_clamp(sr_spectrum s, float lo, float hi)
{
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        s[i] = sr_clamp(s[i], lo, hi);
    return s;
}
sr_spectrum sr_spectrum_exp(sr_spectrum s);

/* ---- wavelengths ---- */

#define SR_LAMBDA_MIN 360.0f // [nm] where the observer's tables begin
#define SR_LAMBDA_MAX 830.0f // [nm]

struct sr_lambda_range {
    float lo, hi; // [nm]
};

struct sr_wavelengths {
    sr_spectrum lambda;           // [nm]
    sr_spectrum pdf;              // [1/nm]; secondary wavelengths that dispersion has ended have pdf 0
    const struct sr_table *known; // a table that has been looked up already, or NULL
    sr_spectrum known_values;     // its values at lambda
};

/* Stratified wavelengths: u moves all of them together by a lattice rotation; density proportional to
 * sech^2(0.0072 (lambda - 538)) on the range (Radziszewski et al. 2009), which follows the observer. u in [0, 1),
 * range.lo < range.hi. */
struct sr_wavelengths sr_wavelengths_sample(struct sr_lambda_range range, float u);
/* The same in two steps: what follows from the range alone, and the draw. */
struct sr_lambda_law {
    struct sr_lambda_range range;
    float e_lo, growth, above_lo, above_hi; // e, e_hi / e_lo - 1, 1 + e_lo, 1 + e_hi [1]
};
struct sr_lambda_law sr_lambda_law(struct sr_lambda_range range);
struct sr_wavelengths sr_wavelengths_draw(const struct sr_lambda_law *law, float u);
/* After dispersion only the first wavelength goes on, with 1/SR_LAMBDA_COUNT of its density. Idempotent. */
void sr_wavelengths_terminate_secondary(struct sr_wavelengths *w);
static inline bool sr_wavelengths_secondary_terminated(const struct sr_wavelengths *w)
{
    return w->pdf[1] == 0;
}

/* ---- spectral distributions ---- */

/* Coefficients of s(lambda) = 1/2 + x / (2 sqrt(1 + x^2)), x = c0 lambda^2 + c1 lambda + c2 (Jakob & Hanika 2019). */
struct sr_sigmoid {
    float c0, c1, c2;
};

/* Samples at first, first + step, …; linear between them, zero outside. */
struct sr_table {
    float first, step; // [nm]
    int32_t count;
    float values[]; // in the unit of what it describes
};

enum sr_spd_kind {
    SR_SPD_NONE = 0,   // not given
    SR_SPD_CONSTANT,   // scale
    SR_SPD_TABLE,      // scale * table(lambda)
    SR_SPD_SIGMOID,    // scale * sigmoid(lambda)
    SR_SPD_ILLUMINANT, // scale * sigmoid(lambda) * table(lambda)
    SR_SPD_BLACKBODY,  // scale * Planck(lambda, temperature) / Planck's maximum
};

/* A plain value: 32 bytes, copied freely. The table belongs to an arena or to the library and outlives it. */
struct sr_spd {
    enum sr_spd_kind kind;
    float scale;
    struct sr_sigmoid sigmoid;
    float temperature; // [K]
    const struct sr_table *table;
};

sr_spectrum sr_spd_eval(const struct sr_spd *s, sr_spectrum lambda);
/* The same at the wavelengths of a path, which may know the table. */
sr_spectrum sr_spd_along(const struct sr_spd *s, const struct sr_wavelengths *w);
/* Looks the table up for all of a path: the white that most of its lights share. NULL: nothing. */
void sr_wavelengths_know(struct sr_wavelengths *w, const struct sr_table *table);
float sr_spd_at(const struct sr_spd *s, float lambda); // one wavelength [nm]
float sr_spd_max(const struct sr_spd *s);              // over the observer's range; ILLUMINANT: of samples by 1 nm
static inline bool sr_spd_is_constant(const struct sr_spd *s)
{
    return s->kind == SR_SPD_CONSTANT;
}
sr_spectrum sr_sigmoid_eval(struct sr_sigmoid c, sr_spectrum lambda);

struct sr_spd sr_spd_constant(float value);
/* (lambda, value) pairs, two or more, strictly increasing in lambda; linear between them, zero outside (as pbrt). Even
 * pairs are kept as they are, others resampled to an even table of 1 nm (finer where the pairs are closer). NULL table
 * and an error when they make no sense. */
struct sr_spd sr_spd_from_samples(struct sr_arena *arena, const float *lambda, const float *values, int count,
                                  struct sr_error *error);
/* Planck's law normalised to a maximum of 1. T in kelvin. */
struct sr_spd sr_spd_blackbody(float T);
/* One of pbrt's names ("metal-Cu-eta", "stdillum-D65", "glass-BK7", …), their aliases, or our own. Kind NONE if
 * unknown. Illuminants are scaled as their sources print them, about 100; pbrt's "stdillum-D50" is not CIE's,
 * "illum-cieD50" is. */
struct sr_spd sr_spd_named(const char *name);
const char *sr_spd_name(int i); // the i-th known name, or NULL past the end

/* Spectral radiance of a black body [W m^-2 sr^-1 nm^-1] (CODATA 2019). lambda in nm, T in K. */
double sr_planck(double lambda, double T);

/* Integral over the observer's range by 1 nm steps of s(lambda) ybar(lambda) [nm]. Times 683 lm/W: luminous. */
double sr_spd_luminous_integral(const struct sr_spd *s);
void sr_spd_xyz(const struct sr_spd *s, double xyz[3]); // integrals with xbar, ybar, zbar by 1 nm steps, not normalised

/* ---- the observer ---- */

#define SR_KM 683.0f                 // [lm/W] luminous efficacy at 540 THz
#define SR_CIE_Y_INTEGRAL 106.856895 // [nm] integral of ybar, the constant that renderers use

struct sr_xyz {
    float x, y, z;
};
/* Monte Carlo estimate of the integrals of L xbar, L ybar, L zbar over wavelength, from one path's wavelengths. */
struct sr_xyz sr_spectrum_to_xyz(sr_spectrum L, const struct sr_wavelengths *w);
/* CIE 1931 colour matching functions at lambda [nm], linear between 1 nm samples; ybar is V(lambda). */
void sr_observer_1931(double lambda, double xyz[3]);
double sr_luminous_efficiency(double lambda); // V(lambda), CIE 1924 [1]

/* ---- colour spaces and RGB ---- */

enum sr_colour_space_id { SR_SRGB, SR_DCI_P3, SR_REC2020, SR_ACES2065_1, SR_COLOUR_SPACE_COUNT };

struct sr_rgb {
    float r, g, b;
};

struct sr_colour_space {
    const char *name;                              // pbrt's: "srgb", "dci-p3", "rec2020", "aces2065-1"
    double xy[4][2];                               // chromaticities of red, green, blue, white
    double rgb_from_xyz[3][3], xyz_from_rgb[3][3]; // white has Y = 1
    const struct sr_table *illuminant;             // the white's standard illuminant, scaled as its source gives it
    double illuminant_luminous_integral;           // [nm * its unit] integral of illuminant * ybar, 1 nm steps
};
const struct sr_colour_space *sr_colour_space(enum sr_colour_space_id id);
bool sr_colour_space_find(const char *name, enum sr_colour_space_id *id);

struct sr_rgb sr_rgb_from_xyz(const struct sr_colour_space *space, struct sr_xyz xyz);
struct sr_xyz sr_xyz_from_rgb(const struct sr_colour_space *space, struct sr_rgb rgb);
float sr_srgb_encode(float linear);
float sr_srgb_decode(float encoded);
/* White balance: a von Kries (Bradford) matrix in XYZ from one white's chromaticity to another's. */
void sr_white_balance(const double source_xy[2], const double target_xy[2], double matrix[3][3]);
/* Chromaticity of CIE daylight of that correlated colour temperature [K], 4000 … 25000 K. */
void sr_daylight_xy(double T, double xy[2]);

/* Sigmoid whose colour under the space's illuminant is rgb (each in 0 … 1): from tables fitted at build time. */
struct sr_sigmoid sr_rgb_to_sigmoid(enum sr_colour_space_id space, struct sr_rgb rgb);
struct sr_spd sr_spd_from_rgb_albedo(enum sr_colour_space_id space, struct sr_rgb rgb);     // each in 0 … 1
struct sr_spd sr_spd_from_rgb_unbounded(enum sr_colour_space_id space, struct sr_rgb rgb);  // scale 2 max(rgb), as pbrt
struct sr_spd sr_spd_from_rgb_illuminant(enum sr_colour_space_id space, struct sr_rgb rgb); // times the illuminant

#endif
