/* SPDX-License-Identifier: MIT */
/* A value over a surface: constant, image, checkerboard, …: one file a kind.
 *
 * A texture is two words, {model, self}; it may hold other textures. A texture of the scene file that is "spectrum" is
 * bound to a use (reflectance, unbounded quantity, emission) when it is made, which decides what its RGB means. */
#ifndef SR_TEXTURE_TEXTURE_H
#define SR_TEXTURE_TEXTURE_H

#include "base/base.h"
#include "math/math.h"
#include "spectrum/spectrum.h"

struct sr_texture_model;
struct sr_texture {
    const struct sr_texture_model *model; // NULL: not given
    const void *self;
};

/* How RGB values become spectra: SR_PARAM_ALBEDO, SR_PARAM_UNBOUNDED or SR_PARAM_ILLUMINANT, in a colour space. */
struct sr_texture_use {
    enum sr_param_kind rgb_use;
    enum sr_colour_space_id space;
};

/* One file of src/texture/ each; its struct's first fields are described by params. A kind that exists for numbers and
 * for spectra is two models of one name, each with its own table: exactly one of is_float and is_spectrum is set.
 *
 * The importer finds the model by name and type, fills the struct by the table, then calls `prepare` (may be NULL),
 * which checks, loads nothing, allocates from the arena, may set *self anew.
 *   - Children of a float texture are SR_PARAM_FLOAT_TEXTURE, as are weights ("amount", "scale") of a spectrum texture.
 *   - In a spectrum texture's table SR_PARAM_ALBEDO and SR_PARAM_ALBEDO_TEXTURE mean "of the parent's use": values and
 *     children are read as sr_texture_use.rgb_use says, and bounded as that use is.
 *   - A row that gives an image is SR_PARAM_FILE; the texels that the importer makes of it go to texels_offset.
 *   - 2-D textures list the mapping's rows in sr_mapping_params (offsets inside struct sr_mapping, which sits at
 *     mapping_offset); 3-D ones have a struct sr_transform world_to_texture at transform_offset. The importer sets both
 *     from the transform in force at the Texture directive. A texture may have both. */
struct sr_texture_model {
    const char *name; // the scene file's word: "imagemap"
    const struct sr_param *params;
    size_t size;
    bool is_float, is_spectrum;                             // which of the two eval functions exists
    size_t texels_offset, mapping_offset, transform_offset; // [B] in the struct; SR_TEXTURE_NOWHERE: has none
    sr_status (*prepare)(void *self, struct sr_texture_use use, struct sr_arena *arena, struct sr_error *error);
    /* Before prepare: takes over what another texture of this model, prepared for the same use, has made of the same
     * texels, if it would come out the same; prepare then does the rest. NULL: has nothing worth it. */
    void (*share)(void *self, const void *other);
    float (*eval_float)(const void *self, const struct sr_point *x);
    sr_spectrum (*eval_spectrum)(const void *self, const struct sr_point *x, const struct sr_wavelengths *w);
    /* true: the texture has one value everywhere, this one; NULL: never. Ask after prepare. */
    bool (*constant_float)(const void *self, float *value);
    bool (*constant_spectrum)(const void *self, struct sr_spd *value);
};
#define SR_TEXTURE_NOWHERE SIZE_MAX
extern const struct sr_texture_model *const sr_texture_models[];                       // ends with NULL
const struct sr_texture_model *sr_texture_model_find(const char *name, bool is_float); // NULL: unknown

static inline float sr_texture_float(struct sr_texture t, const struct sr_point *x)
{
    return t.model->eval_float(t.self, x);
}
static inline sr_spectrum sr_texture_spectrum(struct sr_texture t, const struct sr_point *x,
                                              const struct sr_wavelengths *w)
{
    return t.model->eval_spectrum(t.self, x, w);
}
struct sr_texture sr_texture_constant_float(struct sr_arena *arena, float value);
struct sr_texture sr_texture_constant_spectrum(struct sr_arena *arena, struct sr_spd value);
bool sr_texture_is_constant_float(struct sr_texture t, float *value); // true: the value everywhere
bool sr_texture_is_constant_spectrum(struct sr_texture t, struct sr_spd *value);

/* Texels in memory, made by the importer from an image: 8-bit stays 8-bit, everything else is float. */
struct sr_texels {
    uint32_t width, height, channels; // channels 1 (grey), 3 (RGB) or 4 (RGB and alpha)
    const uint8_t *bytes;             // width*height*channels, or NULL
    const float *floats;              // the same, linear; or NULL
    const float *decode;              // 256 linear values for bytes: sRGB, linear or a gamma (alpha: byte / 255)
    enum sr_colour_space_id space;    // of its RGB
};

/* The same as the model's texels_offset, mapping_offset and transform_offset; SIZE_MAX: nowhere. */
size_t sr_texture_texels_offset(const struct sr_texture_model *model);
size_t sr_texture_mapping_offset(const struct sr_texture_model *model);
size_t sr_texture_transform_offset(const struct sr_texture_model *model);

/* 2-D mapping: the parameters common to all 2-D textures. (u, v) -> (s, t) and its footprint. */
enum sr_mapping_kind { SR_MAPPING_UV, SR_MAPPING_SPHERICAL, SR_MAPPING_CYLINDRICAL, SR_MAPPING_PLANAR };
struct sr_mapping {
    int32_t kind;
    float uscale, vscale, udelta, vdelta;
    sr_vec3 v1, v2;                       // planar axes [1/m]
    struct sr_transform world_to_texture; // set by the importer from the transform at the directive
};
struct sr_mapped {
    sr_vec2 st;
    float dsdx, dsdy, dtdx, dtdy;
};
struct sr_mapped sr_mapping_apply(const struct sr_mapping *m, const struct sr_point *x);
/* Offsets inside struct sr_mapping. The planar axes' default (1,0,0) and (0,1,0) stands where the file gives none: NaN
 * (or zero) components are replaced when the texture is prepared. */
extern const struct sr_param sr_mapping_params[];

#endif
