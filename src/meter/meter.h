/* SPDX-License-Identifier: MIT */
/* What measures: which rays a meter takes in, and with what weight.
 *
 *     reading = INTEGRAL over the meter's area, over all directions, of  response(x, wi) L(x, wi)  dwi dA(x)
 *
 * wi points from the meter toward where light comes from. A meter is two words, {model, self}, one file for each group
 * of models; a detector (in struct sr_meter_common, which every self begins with) says what is made of the wavelengths.
 */
#ifndef SR_METER_METER_H
#define SR_METER_METER_H

#include "quantity/quantity.h"
#include "sample/sample.h"

/* Where a meter takes light in: one point of it. */
struct sr_meter_place {
    struct sr_point x;     // n is 0 where there is no surface: a point free in space
    struct sr_frame frame; // of response, sample and pdf
    float weight;          // 1 / density: [m^2] of meters with an area, 1 of points
};

/* A surface to measure on, as the meter sees it: points drawn by area. */
struct sr_meter_surface {
    const void *self;
    double area; // [m^2]
    /* p, p_error, n, ns and uv of a point; returns its density [1/m^2], 0: none. */
    float (*draw)(const void *self, sr_vec2 u, struct sr_point *x);
};

enum sr_meter_reading { SR_READ_VALUE, SR_READ_SPECTRUM, SR_READ_COLOUR };
enum sr_meter_bandpass { SR_BAND_TRIANGULAR, SR_BAND_RECTANGULAR };

/* How every self begins; set by the rows of sr_meter_common_params. */
struct sr_meter_common {
    const char *name;                // NULL: none given
    const char *surface_name;        // of a shape, or NULL
    int32_t reading;                 // enum sr_meter_reading
    int32_t bandpass;                // enum sr_meter_bandpass
    struct sr_slice lambda;          // [nm] first, step, last
    float fwhm;                      // [nm] width of the bandpass at half its height; NaN: the step
    struct sr_meter_surface surface; // by whom it prepares: that of the name, or the meter's own
};
extern const struct sr_param sr_meter_common_params[];

struct sr_meter_model {
    const char *name;   // the scene file's word
    const char *what;   // "cylindrical irradiance"
    const char *law;    // its definition, in one line
    const char *suffix; // of its symbol: "cyl" of E_v,cyl; "" for none
    enum sr_kind kind;
    const struct sr_param *params; // beside the common ones
    size_t size;
    bool wants_surface; // looks at common.surface_name
    /* meter_to_world: the transform in force. */
    sr_status (*prepare)(void *self, const struct sr_transform *meter_to_world, struct sr_arena *arena,
                         struct sr_error *error);
    bool (*place)(const void *self, sr_vec2 u, struct sr_meter_place *place);
    float (*response)(const void *self, sr_vec3 wi);         // wi local, unit length; may be negative (net flux)
    float (*sample)(const void *self, sr_u4 u, sr_vec3 *wi); // returns its pdf [1/sr], of rays 1; 0: none
    float (*pdf)(const void *self, sr_vec3 wi);              // [1/sr]
    bool (*is_ray)(const void *self); // takes in one direction alone: no light can be aimed at from it. NULL: does not
    double (*extent)(const void *self); // INTEGRAL |response| dwi dA: what a radiance of 1 from everywhere reads
    /* Maps: how many cells; place draws within the cell. NULL: one reading. */
    void (*raster)(const void *self, uint32_t *width, uint32_t *height);
    bool (*place_in)(const void *self, uint32_t cell, sr_vec2 u, struct sr_meter_place *place);
    uint32_t (*cell_of)(const void *self,
                        const struct sr_meter_place *place); // on a named shape: by u and v; UINT32_MAX: none
    /* Meters of the far field: they count light that leaves the scene, wherever from, by its direction w. They have no
     * place; the reading is the flux. far: the cell of w; cell: the middle of a cell [deg] and its solid angle [sr].
     * NULL: others. */
    uint32_t (*far)(const void *self, sr_vec3 w);
    double (*cell)(const void *self, uint32_t cell, double *c_deg, double *gamma_deg);
};
extern const struct sr_meter_model *const sr_meter_models[]; // ends with NULL
const struct sr_meter_model *sr_meter_model_find(const char *name);

struct sr_meter {
    const struct sr_meter_model *model;
    const void *self;
};
static inline const struct sr_meter_common *sr_meter_common(const struct sr_meter *m)
{
    return m->self;
}
/* Meters that a program makes: at a point of a surface element, and along a ray (half_angle 0) or a cone [rad]. */
struct sr_meter sr_meter_irradiance_at(struct sr_arena *arena, sr_vec3 p, sr_vec3 n);
struct sr_meter sr_meter_radiance_along(struct sr_arena *arena, sr_vec3 p, sr_vec3 d, float half_angle);

/* ---- the spectrometer ---- */

/* Bins at first, first + step, …: the mean of the spectral quantity, weighed by the bandpass. */
struct sr_spectrometer {
    double first, step, fwhm; // [nm]
    uint32_t count;           // 0: none
    enum sr_meter_bandpass bandpass;
};
/* From LO, STEP, HI; fwhm NaN: the step. Refuses what is no ascending list of at most 4096 bins. */
sr_status sr_spectrometer_prepare(double lo, double step, double hi, double fwhm, enum sr_meter_bandpass bandpass,
                                  struct sr_spectrometer *s, struct sr_error *error);
/* Adds an estimate from a path's wavelengths: X is 683 times the spectral quantity, as everywhere on paths. */
void sr_spectrometer_add(const struct sr_spectrometer *s, sr_spectrum X, const struct sr_wavelengths *w, double *bins);

/* ---- the colorimeter ---- */

enum {
    SR_COLOUR_X,
    SR_COLOUR_Y,
    SR_COLOUR_Z,
    SR_COLOUR_x,
    SR_COLOUR_y,
    SR_COLOUR_u,
    SR_COLOUR_v,
    SR_COLOUR_CCT,
    SR_COLOUR_DUV,
    SR_COLOUR_COUNT
};
extern const char *const sr_colour_names[SR_COLOUR_COUNT]; // "X" … "CCT", "Duv"
/* XYZ given, the rest computed: x y; u' v' of 1976; correlated colour temperature [K] and the signed distance Duv from
 * Planck's locus in the diagram of 1960. NaN: black; CCT also where Duv is beyond 0.05, for which it has no meaning
 * (CIE 015:2018). */
void sr_colour_of(double values[SR_COLOUR_COUNT]);

#endif
