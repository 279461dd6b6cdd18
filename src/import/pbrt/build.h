/* SPDX-License-Identifier: MIT */
/* From a description to a scene: parameters into the models' structs by their tables, names into things. */
#ifndef SR_IMPORT_PBRT_BUILD_H
#define SR_IMPORT_PBRT_BUILD_H

#include "image/image.h"
#include "import/import.h"
#include "import/pbrt/description.h"
#include "import/ply.h"

/* One texture, made for the uses that have been asked for: FLOAT, ALBEDO, UNBOUNDED, ILLUMINANT. */
struct sr_pbrt_bound_texture {
    struct sr_texture made[4];
    uint64_t parts[4];
    bool is_being_made, has_warned;
};
/* A texture that reads an image: what takes long is done last, for all of them at a time. */
struct sr_pbrt_late_texture {
    const struct sr_pbrt_entity *entity;
    const struct sr_texture_model *model;
    void *self;
    struct sr_texture_use use;
    const char *path; // of the image
    struct sr_location where;
    float gamma;
    const struct sr_pbrt_late_texture *like; // an earlier one of the same texels and use; or NULL
    struct sr_arena arena;
    struct sr_error error;
};
struct sr_pbrt_built_material {
    struct sr_material *material; // NULL: interface
    uint64_t parts;
    bool is_being_made, is_made;
};

/* A shape with a name, for meters; several may have the same. */
struct sr_pbrt_named_shape {
    const char *name;
    struct sr_shape shape;
    bool is_of_object;
    bool moves;
};

/* Textures of textures and mixes of mixes: rendering goes down as deep. */
enum { SR_PBRT_MAX_DEPTH = 64, SR_PBRT_MAX_PARTS = 1 << 16 };

struct sr_pbrt_build {
    struct sr_pbrt_description *d;
    const char *main_path;
    const struct sr_import_options *options;
    struct sr_import_result *result;
    struct sr_arena *arena;  // the scene's
    struct sr_arena scratch; // ends with the import
    struct sr_log *log;
    struct sr_error *error;
    int threads;
    uint64_t hash;
    float shutter_open, shutter_close; // [s]
    float edge_scale;                  // [1] of "edgelength"
    bool is_borrowing;   // what is bound copies its runs, or ends before the description does: they stay where they lie
    float film_diagonal; // [m]
    bool is_in_world;    // a G-buffer's points
    int depth;           // of textures and materials being made
    uint64_t parts;      // of what is being made, each as often as it is used: so often are they walked and evaluated

    struct sr_array named_shapes;             // struct sr_pbrt_named_shape, in the order of the file
    struct sr_array images;                   // struct sr_pbrt_image
    struct sr_array spectra;                  // struct sr_pbrt_spectrum_file
    struct sr_array late_textures;            // struct sr_pbrt_late_texture
    struct sr_pbrt_bound_texture *textures;   // one for each of the description
    struct sr_pbrt_built_material *materials; // first those of Material directives, then the named ones
    struct sr_medium *media;                  // one for each of the description; without model: not made yet
    bool has_told_normalisation;              // that emission spectra are scaled to luminance 1
    bool has_warned_units;                    // that a spectrum may be meant otherwise
    bool has_warned_curve_normals;            // that only ribbons have them
};

/* What the values of an entity are for, where its table alone does not say it. */
struct sr_pbrt_use {
    enum sr_param_kind
        parent;    // for rows "of the parent's use" in tables of spectrum textures; otherwise SR_PARAM_ALBEDO
    bool is_child; // the table is a spectrum texture's
};

/* bind.c: fills a zeroed struct by its table. Defaults where nothing is given; wrong types and values are errors. */
sr_status sr_pbrt_bind(struct sr_pbrt_build *b, const struct sr_param *table, const struct sr_pbrt_entity *e,
                       struct sr_pbrt_use use, void *self);
/* Warns of parameters that nobody has asked for; tables (may be NULL) give the words to suggest. */
void sr_pbrt_warn_unused(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_param *table,
                         const struct sr_param *more);
sr_status sr_pbrt_no_memory(struct sr_pbrt_build *b);
/* "file:line:column: Material \"diffuse\": …" around a message that knows no place. */
sr_status sr_pbrt_wrap(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_error *inner);
/* "… is not supported yet; supported: a, b, c" */
sr_status sr_pbrt_unsupported(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const char *const *names,
                              size_t count);

/* files.c */
char *sr_pbrt_resolve(struct sr_pbrt_build *b, struct sr_arena *arena, const char *name, struct sr_location where);
/* Adds to the scene's hash what is in a file that a model reads by itself; images are known by those who decode them.
 */
void sr_pbrt_hash_file(struct sr_pbrt_build *b, const char *path);

/* spectra.c: the value of a parameter as a spectrum of one kind (ALBEDO, UNBOUNDED, ILLUMINANT). */
sr_status sr_pbrt_spectrum(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const struct sr_pbrt_param *p,
                           enum sr_param_kind kind, struct sr_spd *out);

/* images.c: each file is read once; path is resolved. gamma 0: sRGB, 1: linear, else the exponent of its bytes.
 * for_good: the texels outlive the import. */
sr_status sr_pbrt_texels(struct sr_pbrt_build *b, const char *path, struct sr_location where, float gamma,
                         bool for_good, struct sr_texels *out);
/* Reads the images that all late textures name, several at a time, so that sr_pbrt_texels finds them. */
sr_status sr_pbrt_images_read_ahead(struct sr_pbrt_build *b);
sr_status sr_pbrt_encoding(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, const char *word, float *gamma);
void sr_pbrt_images_free(struct sr_pbrt_build *b);

/* textures.c: a named texture, made for one use: SR_PARAM_FLOAT_TEXTURE, or the kind of spectrum. */
sr_status sr_pbrt_finish_textures(struct sr_pbrt_build *b); // the late ones
sr_status sr_pbrt_named_texture(struct sr_pbrt_build *b, const struct sr_pbrt_param *p, bool is_float,
                                enum sr_param_kind use, struct sr_texture *out);

/* materials.c */
void sr_pbrt_tell_normalisation(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e); // once
sr_status sr_pbrt_material(struct sr_pbrt_build *b, const struct sr_pbrt_material_ref *ref,
                           const struct sr_material **out);
sr_status sr_pbrt_materials(struct sr_pbrt_build *b, const struct sr_pbrt_param *p, struct sr_slice *out);

/* media.c: the medium of that name, made once; none where there is no name. */
sr_status sr_pbrt_medium(struct sr_pbrt_build *b, const char *name, struct sr_location where, struct sr_medium *out);

/* uncertainties.c: those that the file declares; the one that the options name is added to its parameter, before
 * anything is built. */
sr_status sr_pbrt_uncertainties(struct sr_pbrt_build *b);

/* curves.c: the shape of the run of curves that begins at s, in that placement; *run: how many directives it is made
 * of. */
bool sr_pbrt_is_curve(const struct sr_pbrt_shape *s);
sr_status sr_pbrt_curves(struct sr_pbrt_build *b, const struct sr_pbrt_shape *s,
                         const struct sr_shape_placement *placement, struct sr_shape *shape, size_t *run);

/* displace.c: the mesh with vertices moved along their normals, after its edges have been made shorter than edge_length
 * [m]. */
sr_status sr_pbrt_displace(struct sr_ply_mesh *ply, const struct sr_transform *object_to_world, float edge_length,
                           struct sr_texture displacement, struct sr_error *error);

/* lights.c and shapes.c add to the scene; settings.c fills the rest of the result. */
sr_status sr_pbrt_build_lights(struct sr_pbrt_build *b);
sr_status sr_pbrt_emission(struct sr_pbrt_build *b, uint32_t area_light1, float area,
                           const struct sr_light_emission **out);
sr_status sr_pbrt_build_shapes(struct sr_pbrt_build *b);
sr_status sr_pbrt_build_meters(struct sr_pbrt_build *b); // after the shapes
sr_status sr_pbrt_build_settings(struct sr_pbrt_build *b, enum sr_light_choice *choice);
/* Once the scene is finished: estimators that know media where there are some, the quickest where there are none. */
sr_status sr_pbrt_settle_integrator(struct sr_pbrt_build *b);

/* Tables that belong to no model of a room. */
extern const struct sr_param sr_pbrt_option_params[];
extern const struct sr_param sr_pbrt_spectral_params[], sr_pbrt_gbuffer_params[];
extern const struct sr_param *const sr_pbrt_film_params,
    *const sr_pbrt_sampler_params, *const sr_pbrt_shape_params, *const sr_pbrt_ply_params,
                                                                    *const sr_pbrt_material_params,
                                                                        *const sr_pbrt_uncertainty_params;

/* lens.c: the files of a camera with a lens. */
sr_status sr_pbrt_lens(struct sr_pbrt_build *b, const struct sr_pbrt_entity *e, struct sr_sensor_lens *lens);

/* placing.c: the transform when the shutter opens (closes), into the scene's space: the world, or about
 * b->result->origin. Those of shapes of objects lead into the object's space; the camera's lead out of the world, and
 * are turned round. */
enum sr_pbrt_place { SR_PBRT_TO_WORLD, SR_PBRT_TO_OBJECT, SR_PBRT_FROM_WORLD };
struct sr_transform sr_pbrt_transform_of(const struct sr_pbrt_build *b, uint32_t index, enum sr_pbrt_place place);
struct sr_transform sr_pbrt_transform_at_end(const struct sr_pbrt_build *b, uint32_t index, enum sr_pbrt_place place);
static inline enum sr_pbrt_place sr_pbrt_place_of(const struct sr_pbrt_shape *s)
{
    return s->object1 ? SR_PBRT_TO_OBJECT : SR_PBRT_TO_WORLD;
}

/* motion.c: whether a transform differs at the shutter's ends; and the motion between them. */
bool sr_pbrt_moves(const struct sr_pbrt_build *b, uint32_t transform);
sr_status sr_pbrt_motion(struct sr_pbrt_build *b, uint32_t transform, enum sr_pbrt_place place, const char *what,
                         struct sr_location where, const struct sr_motion **out);

#endif
