/* SPDX-License-Identifier: MIT */
/* What shines: one file a kind; and how one is chosen among many.
 *
 * A light is two words, {model, self}. Radiance that leaves it is 683 lm/W times that in W m^-2 sr^-1 nm^-1, in scenes
 * that give photometric numbers, so that the integral with ybar is in cd/m^2 (docs/units.md). */
#ifndef SR_LIGHT_LIGHT_H
#define SR_LIGHT_LIGHT_H

#include "sample/sample.h"
#include "shape/shape.h"
#include "spectrum/spectrum.h"
#include "texture/texture.h"

struct sr_light_model;
struct sr_light {
    const struct sr_light_model *model;
    const void *self;
};

/* Light that would arrive at a reference point, were nothing in between. */
struct sr_light_sample {
    sr_spectrum L;  // radiance [.../sr]; for delta lights I/r^2 or E, and pdf is 1
    sr_vec3 wi;     // [1] toward the light
    float distance; // [m]; INFINITY for light from outside the scene
    sr_vec3 p;      // [m] where it leaves, off the light's surface, so that a ray may end there; unused at INFINITY
    sr_vec3 n;      // [1] the light's surface there, outside; 0: it has none
    float pdf;      // [1/sr]
    bool is_delta;  // no ray meets this light by chance, so that this sample has weight 1 (also area lights that are
                    // ghosts)
};

/* Light as it leaves, for paths that begin at lights. It carries the flux
 *
 *     L |cos theta| / (pmf pdf_area pdf_direction)         [lm], cos theta = 1 where there is no surface */
struct sr_light_ray {
    struct sr_point from; // where: p, p_error, n, uv; n is 0 at points and where light enters the scene from outside
    sr_vec3 w;            // [1] the way it travels
    sr_spectrum L;        // radiance; of points the intensity, of distant lights the irradiance across w
    float pdf_area;       // [1/m^2]; points: 1; from outside: across w, on the disk that the scene's sphere shows
    float pdf_direction;  // [1/sr]; distant lights: 1
    bool has_passed; // it has come through a portal: only if nothing is on its way from outside to `from` it may go on
    float pmf;       // [1] of this light among all; sr_lights_emit fills it and the next
    uint32_t light;
};

/* What the tree of lights knows of a light (Conty Estevez & Kulla 2018). */
struct sr_light_bounds {
    struct sr_box box; // [m]
    sr_vec3 axis;      // [1]
    float cos_theta_o; // [1] spread of the normals about the axis
    float cos_theta_e; // [1] reach of the emission beyond them
    float power;       // luminous integral of the emitted flux [cd sr], with a grain for light that nobody sees;
                       // 0: never chosen
    bool two_sided;
};

struct sr_light_model {
    const char *name;
    const struct sr_param *params;
    size_t size;
    bool is_infinite, is_delta;
    bool wants_octahedral_map; // of its image: latitude-longitude ones are to be made so first
    bool reads_own_file;       // its row of kind SR_PARAM_FILE names no image; prepare reads it
    /* Normalises (power, illuminance, scale), checks. For shapes' lights the shape is already in self. */
    sr_status (*prepare)(void *self, struct sr_arena *arena, struct sr_error *error);
    /* Once the scene's extent is known (infinite lights); may be NULL. */
    void (*place)(void *self, sr_vec3 scene_centre, float scene_radius);
    bool (*sample)(const void *self, const struct sr_point *reference, sr_vec2 u, const struct sr_wavelengths *w,
                   struct sr_light_sample *s);
    /* Density [1/sr] of sample() for wi; `there` is the point met on a shape, NULL for infinite lights. Delta lights:
     * 0. It may be 0 where light comes from (a uniform sky, the dim part of an image): that light is for the surface's
     * own choice of direction to find, with weight 1. */
    float (*pdf)(const void *self, const struct sr_point *reference, sr_vec3 wi, const struct sr_point *there);
    /* Radiance leaving `there` toward w (area lights), or arriving along a ray that escapes in direction -w (infinite,
     * there NULL). */
    sr_spectrum (*Le)(const void *self, const struct sr_point *there, sr_vec3 w,
                      const struct sr_wavelengths *wavelengths);
    /* Infinite lights: Le along a ray that escapes toward wi, and pdf, at once, both as seen from a place; NULL: it has
     * no Le. (What shines through a portal is not seen from everywhere; Le above does not ask.) */
    sr_spectrum (*Le_pdf)(const void *self, sr_vec3 from, sr_vec3 wi, const struct sr_wavelengths *wavelengths,
                          float *pdf);
    bool (*bounds)(const void *self, struct sr_light_bounds *bounds); // false: infinite, power alone is set
    /* A ray that leaves it, drawn in nearly the proportion of what it emits (time is the caller's), and the densities
     * with which it draws. n: of the light's surface there. */
    bool (*emit)(const void *self, sr_vec2 u_place, sr_vec2 u_direction, const struct sr_wavelengths *w,
                 struct sr_light_ray *ray);
    void (*emit_pdf)(const void *self, sr_vec3 n, sr_vec3 w, float *pdf_area, float *pdf_direction);
    float (*emit_weight)(const void *self); // of the light where paths begin [cd sr]; NULL: the power of its bounds
    float (*power)(const void *self); // luminous integral of the emitted flux [cd sr]; infinite: of what enters the
                                      // scene's sphere, and 0 for a uniform sky, which is never chosen
};
extern const struct sr_light_model *const sr_light_models[];           // ends with NULL
extern const struct sr_light_model sr_light_infinite, sr_light_portal; // the second where "portal" is given: one table
const struct sr_light_model *sr_light_model_find(const char *name);

/* The area light of one primitive: kept small, there may be a million. */
struct sr_light_area {
    struct sr_shape shape;
    uint32_t primitive;
    const struct sr_light_emission *emission; // shared by all primitives of the shape
    float area;                               // [m^2]
    bool is_ghost; // its surface is never met by rays (alpha 0 everywhere): only light sampling finds it, with weight 1
    // derived by sr_light_area_of: parallelograms and triangles are drawn by area where they look small, spheres by
    // their cone from outside; patches with an image half by its brightness, if (u, v) are their own
    enum { SR_LIGHT_ANY, SR_LIGHT_FLAT, SR_LIGHT_ROUND, SR_LIGHT_PICTURE } kind;
    union {
        struct sr_shape_flat flat;
        struct sr_shape_round round;
    };
    sr_vec3 centre;     // [m]
    float far2;         // [m^2] squared distance of the centre beyond which that is done
    float inverse_area; // [1/m^2]
    float off;          // [m] along the normal, beyond all rounding errors of points on it
};
struct sr_light_area sr_light_area_of(struct sr_shape shape, uint32_t primitive,
                                      const struct sr_light_emission *emission, bool is_ghost);
/* What AreaLightSource says. Prepared once for a shape (power needs the shape's whole area). */
struct sr_light_emission {
    struct sr_spd L; // as given
    float scale;     // [1]
    bool two_sided;
    float power; // [lm]; NaN: not given
    const char *filename;
    struct sr_texels texels; // image over the surface's (u, v), or width 0
    enum sr_colour_space_id space;
    bool is_absolute; // L is in W m^-2 sr^-1 nm^-1 as it stands, power in W
    // derived by sr_light_emission_prepare
    struct sr_spd emitted;  // radiance: L, made to have the luminance that scale and power ask for [.../(m^2 sr nm)]
    float derived_scale;    // the same factor for the image: of an RGB value's illuminant spectrum
    float luminance;        // [cd/m^2] mean over the surface
    float choice_luminance; // [cd/m^2] the same, never 0 for what glows at any wavelength
    const struct sr_piecewise2 *picture; // density of the image over (u, 1 - v); NULL: none, or of one brightness
};
extern const struct sr_param sr_light_emission_params[];
sr_status sr_light_emission_prepare(struct sr_light_emission *e, float total_area, struct sr_arena *arena,
                                    struct sr_error *error);
extern const struct sr_light_model sr_light_area;

/* How every self of sr_light_models[] begins (not struct sr_light_area): what the importer sets beside the parameters.
 */
struct sr_light_common {
    struct sr_transform light_to_world; // the transform in force at the directive
    struct sr_texels texels;            // of the image, for models that have a row of kind SR_PARAM_FILE
    enum sr_colour_space_id space;      // in force at the directive: its white shines where no spectrum is given
    bool is_absolute;                   // emission spectra are in W m^-2 sr^-1 nm^-1 as they stand, their power in W
};
/* Where its members sit in a model's self [B]; SIZE_MAX: nowhere (area lights; texels where no image is read). */
size_t sr_light_transform_offset(const struct sr_light_model *model);
size_t sr_light_texels_offset(const struct sr_light_model *model);
size_t sr_light_space_offset(const struct sr_light_model *model);
size_t sr_light_absolute_offset(const struct sr_light_model *model);

/* Latitude-longitude maps, twice as wide as high (u = phi / (2 pi), v = theta / pi from +z), made square octahedral
 * ones of the same resolution and the same mean luminance, for lights that want those. Texels are R, G and B
 * afterwards. */
bool sr_light_is_latitude_longitude(const struct sr_texels *t);
sr_status sr_light_make_square(struct sr_texels *t, struct sr_arena *arena, struct sr_error *error);

static inline bool sr_light_draw(struct sr_light light, const struct sr_point *reference, sr_vec2 u,
                                 const struct sr_wavelengths *w, struct sr_light_sample *s)
{
    return light.model->sample(light.self, reference, u, w, s);
}

/* The density of a light's own draw toward wi, where a surface's draw has met it. */
static inline float sr_light_density(struct sr_light light, const struct sr_point *reference, sr_vec3 wi,
                                     const struct sr_point *there)
{
    return light.model->pdf(light.self, reference, wi, there);
}

/* What comes from an infinite light along a ray that has escaped. */
static inline sr_spectrum sr_light_escaping(struct sr_light light, sr_vec3 from, sr_vec3 wi,
                                            const struct sr_wavelengths *w)
{
    float unused;
    return light.model->Le_pdf(light.self, from, wi, w, &unused);
}

/* ---- choosing among many ---- */

enum sr_light_choice { SR_LIGHTS_BVH, SR_LIGHTS_POWER, SR_LIGHTS_UNIFORM };

struct sr_lights {
    const struct sr_light *lights;
    uint32_t count;
    const uint32_t *infinite; // indices of the infinite lights that a ray can escape to: not the distant ones
    uint32_t infinite_count;
    enum sr_light_choice choice;
    const struct sr_table *white; // of the first light: worth knowing along a path; or NULL
    uint32_t only;    // 1 + the index of the one light that can be chosen, or 0 if there are several or none
    const void *tree; // private: nodes, each light's way to its leaf, alias table
};
/* Infinite lights must have been placed before. With SR_LIGHTS_BVH each infinite light has the same share as all others
 * together. Keeps `lights`. */
sr_status sr_lights_build(struct sr_arena *arena, const struct sr_light *lights, uint32_t count,
                          enum sr_light_choice choice, struct sr_lights *out, struct sr_error *error);
/* Chooses one for a receiver with normal x->ns (zero for volumes); false: none of those looked at can contribute. u is
 * used up. Only x->p and x->ns are read. */
bool sr_lights_pick_many(const struct sr_lights *lights, const struct sr_point *x, float u, uint32_t *index,
                         float *pmf);
static inline bool sr_lights_pick(const struct sr_lights *lights, const struct sr_point *x, float u, uint32_t *index,
                                  float *pmf)
{
    if (!lights->only)
        return sr_lights_pick_many(lights, x, u, index, pmf);
    *index = lights->only - 1;
    *pmf = 1;
    return true;
}
/* The probability with which pick would have chosen it. */
float sr_lights_pmf(const struct sr_lights *lights, const struct sr_point *x, uint32_t index);
/* The same in proportion to the area that glows, whoever looks: surfaces alone. Only x->p is read. */
bool sr_lights_pick_by_area(const struct sr_lights *lights, const struct sr_point *x, float u, uint32_t *index,
                            float *pmf);
float sr_lights_pmf_by_area(const struct sr_lights *lights, uint32_t index);

/* A ray that leaves one of the lights, which is chosen by its power. false: none. */
bool sr_lights_emit(const struct sr_lights *lights, float u_light, sr_vec2 u_place, sr_vec2 u_direction,
                    const struct sr_wavelengths *w, struct sr_light_ray *ray);
float sr_lights_emit_pmf(const struct sr_lights *lights, uint32_t index);
double sr_lights_emitted(const struct sr_lights *lights); // [cd sr] by all of them, as they are chosen by

#endif
