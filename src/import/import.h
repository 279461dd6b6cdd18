/* SPDX-License-Identifier: MIT */
/* Words and files into scenes: pbrt-v4 files and the meshes and images that they name; glTF and others by their
 * endings. */
#ifndef SR_IMPORT_IMPORT_H
#define SR_IMPORT_IMPORT_H

#include "film/film.h"
#include "integrator/integrator.h"
#include "meter/meter.h"
#include "scene/scene.h"
#include "sensor/sensor.h"

/* What the numbers of emission spectra mean: shapes alone, scaled to luminance 1 as in pbrt; or W m^-2 sr^-1 nm^-1 as
 * they stand (docs/units.md). */
enum sr_units { SR_UNITS_OF_SCENE, SR_UNITS_PHOTOMETRIC, SR_UNITS_SI };

/* What the caller wants otherwise than the file says; zero members leave the file's word. */
struct sr_import_options {
    int threads;             // for reading and building; 0: all processors
    uint32_t spp;            // samples per pixel
    uint32_t width, height;  // [pixel]
    bool has_crop;           // crop_window: x0 x1 y0 y1 as shares of the picture
    float crop_window[4];    // [1]
    bool has_pixel_bounds;   // pixel_bounds: x0 x1 y0 y1
    int32_t pixel_bounds[4]; // [pixel]
    bool quick;              // for a first look: a quarter of the width, height and samples
    enum sr_units units;     // SR_UNITS_OF_SCENE: what the file says, or photometric
    uint32_t shifted;        // number from 1 of the declared uncertainty whose parameter is shifted; 0: none
    double shift;            // by so many standard uncertainties
    const char *integrator;  // NULL, or the estimator to use instead of the file's
    const char *camera;      // of glTF files: its name or number from 1; NULL: the first
    const char *variant;     // of glTF files: the name or number from 1 of a variant of materials; NULL: none
};

/* A standard uncertainty that the file declares of one of its numbers: "#@ Uncertainty" (docs/guide/budget.md). */
struct sr_declared_uncertainty {
    const char *name;    // of what is uncertain
    double value, u;     // in the unit of the parameter; of a spectrum or rgb the first number
    bool is_rectangular; // given as half the width of a rectangle: u = a / sqrt(3); else normal
};

/* Everything that a render needs; owned by the scene's arena but for the scene itself. */
struct sr_import_result {
    struct sr_scene *scene;
    double origin[3]; // [m] of the scene's space, in the file's: other than 0 where the scene is far away for its size
    struct sr_sensor sensor;
    struct sr_filter filter;
    struct sr_integrator integrator;
    struct sr_film_settings film;
    enum sr_sampler_kind sampler;
    uint32_t spp, seed;
    bool jitter_pixel, jitter_lambda;
    enum sr_units units;           // SR_UNITS_PHOTOMETRIC or SR_UNITS_SI
    const struct sr_meter *meters; // of the file, in its order; each has a name
    uint32_t meter_count;
    const struct sr_declared_uncertainty *uncertainties;
    uint32_t uncertainty_count;
    bool stays;    // Option "rendercoordsys" "world": wherever it is
    uint64_t hash; // of all bytes that were read: scene files, meshes, images
    double read_s; // [s] reading and describing, without building
};

/* Reads a scene of any format (describe.h) and finishes it. path "-" is standard input, pbrt's. On failure the result
 * is empty and the error says what, where (file:line:column) and what was expected. */
sr_status sr_import_pbrt(const char *path, const struct sr_import_options *options, struct sr_import_result *result,
                         struct sr_log *log, struct sr_error *error);
void sr_import_result_free(struct sr_import_result *result);
/* What of a scene makes a picture's bytes, as lines "key value": the hash, and options that change what the bytes mean.
 * NULL: no memory. */
char *sr_import_identity(struct sr_arena *arena, const struct sr_import_options *options,
                         const struct sr_import_result *result);

/* ---- scenes as text ---- */

struct sr_convert_options {
    const char *out;    // where the text will lie, for the names of files in it; "-": in the current folder
    bool upgrades;      // from pbrt-v3
    bool flattens;      // text of included files takes the place of Include and Import
    uint32_t ply_above; // triangle meshes of more vertices become PLY files beside the text; 0: none does
    bool for_steradian; // materials and textures that pbrt does not know stay as they are; else the nearest that it
                        // knows
};
/* A scene of any format as pbrt-v4 text, which is read back before it is given. Free *text with sr_free. */
sr_status sr_convert(const char *path, const struct sr_convert_options *options, char **text, size_t *size,
                     struct sr_log *log, struct sr_error *error);

/* One material of a scene, without the rest: by the name of its MakeNamedMaterial, or "#2" for the second Material
 * directive. NULL in *out: an interface. Everything is kept in the arena. */
sr_status sr_import_pbrt_material(const char *path, const char *name, struct sr_arena *arena,
                                  const struct sr_material **out, struct sr_log *log, struct sr_error *error);

/* One thing that scene files may name, for manuals. name "": what all of the kind have. */
struct sr_import_plugin {
    const char *kind; // "Shape", "Texture float", …; "directive", "annotation": words, without parameters
    const char *name;
    const struct sr_param *params; // NULL: none
};
void sr_import_plugins(void (*visit)(void *context, const struct sr_import_plugin *plugin), void *context);

#endif
