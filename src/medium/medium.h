/* SPDX-License-Identifier: MIT */
/* How a volume absorbs, emits and scatters light: one file a medium.
 *
 *     dL/ds = -(sigma_a + sigma_s) L + sigma_a Le + sigma_s integral p(w, w') L(w') dw'     [W m^-3 sr^-1 nm^-1]
 *
 * A medium is two words, {model, self}. Along a ray it tells segments, each with a majorant of sigma_t that holds in
 * all of it; what a path does with them (delta and ratio tracking) is the integrator's. */
#ifndef SR_MEDIUM_MEDIUM_H
#define SR_MEDIUM_MEDIUM_H

#include "base/base.h"
#include "math/math.h"
#include "sample/sample.h"
#include "spectrum/spectrum.h"

struct sr_medium_model;
struct sr_medium {
    const struct sr_medium_model *model;
    const void *self;
};

/* The medium at a point, at the path's wavelengths. */
struct sr_medium_at {
    sr_spectrum sigma_a, sigma_s; // [1/m]
    sr_spectrum Le;               // radiance of the medium where it is thick; it emits sigma_a Le on each metre
    float g;                      // [1] mean cosine of scattering, Henyey & Greenstein
};

/* A piece of a ray and what sigma_t cannot exceed there. */
struct sr_medium_segment {
    float t0, t1;         // [m] along the ray
    sr_spectrum majorant; // [1/m]; of a uniform medium sigma_t itself
};

/* Where a walk along a ray has come to; each medium keeps its own state in it. */
struct sr_medium_walk {
    sr_vec3 o, d;      // in the medium's grid
    float t, t_max;    // [m] along the ray in the world, whose direction has unit length
    sr_spectrum scale; // [1/m] of the grid's numbers
    float next[3], step[3];
    int32_t cell[3], way[3], end[3];
    const void *grid;
};

struct sr_medium_model {
    const char *name; // the scene file's word: "homogeneous"
    const struct sr_param *params;
    size_t size;
    bool is_uniform; // the same everywhere: one segment, and `at` does not look at p
    /* Checks and derives; grids make their coarse grid of majorants. */
    sr_status (*prepare)(void *self, struct sr_arena *arena, struct sr_error *error);
    void (*at)(const void *self, sr_vec3 p, const struct sr_wavelengths *w,
               struct sr_medium_at *out); // p in the world [m]
    /* Segments of the ray o + t d, 0 <= t <= t_max, in order; where there is none the medium is empty. d of unit
     * length. */
    void (*begin)(const void *self, sr_vec3 o, sr_vec3 d, float t_max, const struct sr_wavelengths *w,
                  struct sr_medium_walk *walk);
    bool (*next)(const void *self, struct sr_medium_walk *walk, struct sr_medium_segment *segment);
    bool (*glows)(const void *self); // whether Le can be other than 0
};
extern const struct sr_medium_model *const sr_medium_models[]; // ends with NULL
const struct sr_medium_model *sr_medium_model_find(const char *name);

/* How every self begins: what the importer sets beside the parameters. */
struct sr_medium_common {
    struct sr_transform medium_to_world; // the transform in force at MakeNamedMedium
    enum sr_colour_space_id space;       // in force there
    bool is_absolute;                    // Le is in W m^-2 sr^-1 nm^-1 as it stands
};

/* Measured liquids and solids by name ("Wholemilk"; pbrt's 47): both coefficients as rgb of sRGB, in 1/mm; sigma_s is
 * the reduced one, sigma_s (1 - g). false: unknown. */
bool sr_medium_preset(const char *name, struct sr_spd *sigma_a, struct sr_spd *sigma_s);
const char *sr_medium_preset_name(int i); // NULL past the end

/* Henyey & Greenstein 1941: p(cos theta) [1/sr], theta between the directions of travel before and after. */
static inline float sr_phase_hg(float cos_theta, float g)
{
    float denominator = 1 + g * g - 2 * g * cos_theta;
    return SR_INV_PI / 4 * (1 - g * g) / (denominator * sqrtf(sr_max(denominator, 1e-12f)));
}
/* Draws the direction of travel after scattering of light that travels along d; returns its density = p [1/sr]. */
float sr_phase_hg_sample(sr_vec3 d, float g, sr_vec2 u, sr_vec3 *out);

#endif
