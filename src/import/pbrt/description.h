/* SPDX-License-Identifier: MIT */
/* What a pbrt file says, before anything is made of it: a list of entities, each with its parameters and with the
 * graphics state that held where it stood. Reading fills it (parse.c, state.c), building reads it (build.c).
 *
 * Everything lives in two arenas, its own, `words`, and one that is lent to it, `data`; a scene copies what it keeps.
 */
#ifndef SR_IMPORT_PBRT_DESCRIPTION_H
#define SR_IMPORT_PBRT_DESCRIPTION_H

#include "import/pbrt/matrix.h"
#include "spectrum/spectrum.h"

/* ---- parameters ---- */

enum sr_pbrt_type {
    SR_PBRT_BOOL,
    SR_PBRT_FLOAT,
    SR_PBRT_INTEGER,
    SR_PBRT_POINT2,
    SR_PBRT_VECTOR2,
    SR_PBRT_POINT3,
    SR_PBRT_VECTOR3,
    SR_PBRT_NORMAL,
    SR_PBRT_STRING_TYPE,
    SR_PBRT_TEXTURE,
    SR_PBRT_RGB,
    SR_PBRT_BLACKBODY,
    SR_PBRT_SPECTRUM,
};
const char *sr_pbrt_type_name(enum sr_pbrt_type type);

struct sr_pbrt_param {
    enum sr_pbrt_type type;
    enum sr_colour_space_id space; // in force where it stands
    const char *name;
    struct sr_location where;
    uint32_t count;  // of the values below
    bool is_text;    // a spectrum that is a name
    bool is_default; // came from an Attribute directive: need not be used
    bool used;
    const float *floats;        // BOOL and INTEGER: NULL
    const int32_t *ints;        // BOOL (0, 1) and INTEGER
    const char *const *strings; // STRING, TEXTURE, SPECTRUM by name
};

struct sr_pbrt_params {
    struct sr_pbrt_param *items; // the entity's own first, then those of Attribute
    uint32_t count;
};

/* ---- entities ---- */

struct sr_pbrt_entity {
    const char *directive; // "Shape"
    const char *model;     // "trianglemesh"
    const char *name;      // of named materials, textures, media; NULL
    struct sr_pbrt_params params;
    struct sr_location where;
    enum sr_colour_space_id space;
    uint32_t transform; // index
};

/* The current transform at the shutter's opening and closing. */
struct sr_pbrt_transform {
    struct sr_matrix start, end;
};

struct sr_pbrt_texture {
    struct sr_pbrt_entity entity;
    bool is_float; // else spectrum
};

/* A material is referred to by its place in the list of Material directives, or by its name. */
struct sr_pbrt_material_ref {
    uint32_t index;   // in materials, where name is NULL
    const char *name; // of a MakeNamedMaterial anywhere in the file
    struct sr_location where;
};

struct sr_pbrt_shape {
    struct sr_pbrt_entity entity;
    struct sr_pbrt_material_ref material;
    uint32_t area_light1; // index from 1 in area_lights; 0: dark
    uint32_t object1;     // index from 1 in objects; 0: the world
    bool reverse_orientation;
    const char *inside, *outside; // media; "" or NULL: none
    struct sr_location medium_where;
    const char *name; // of "#@ Name", or NULL
};

struct sr_pbrt_light {
    struct sr_pbrt_entity entity;
    const char *outside; // medium
    struct sr_location medium_where;
};

struct sr_pbrt_object {
    const char *name;
    struct sr_location where;
    uint32_t
        like1; // index from 1: it has one shape, which is that of this earlier object in another material; 0: its own
};
struct sr_pbrt_instance {
    const char *name;
    struct sr_location where;
    uint32_t transform;
};

enum { SR_PBRT_MAX_FILES = 1 << 16 }; // one that is included twice counts twice

struct sr_pbrt_file {
    const char *path;        // compared as a pointer with sr_location.file
    struct sr_location from; // the Include or Import that named it; file NULL: the first file
    uint32_t is_open;        // being read now
};

/* A file that lies in memory, such as an image inside of a GLB file; asked for by its name. */
struct sr_pbrt_memory_file {
    const char *name;
    const void *data; // kept by one of the arenas
    size_t size;
};

struct sr_pbrt_option {
    const char *name; // lower case, without - and _
    struct sr_pbrt_param value;
};

/* Names and the places in a list that they stand for, from 1. Zeroed = empty. */
struct sr_pbrt_names {
    struct sr_pbrt_name_slot {
        const char *name; // NULL: free
        uint32_t index1;
    } * slots;
    uint32_t slot_count, count;
};

struct sr_pbrt_description {
    struct sr_arena *data;
    struct sr_arena words;
    char *chunk; // small things are cut from it
    size_t chunk_left;
    struct sr_array files; // struct sr_pbrt_file *
    struct sr_log *log;

    /* one each; where == 0 lines: not given. Models are the words of the file, or pbrt's defaults. */
    struct sr_pbrt_entity camera, film, sampler, filter, integrator, accelerator;
    const char *camera_medium;
    struct sr_location camera_medium_where;
    enum sr_colour_space_id film_space;
    float transform_start_time, transform_end_time; // [s]
    bool has_world;                                 // WorldBegin was there

    struct sr_array options;         // struct sr_pbrt_option
    struct sr_array transforms;      // struct sr_pbrt_transform
    struct sr_array materials;       // struct sr_pbrt_entity, in the order of Material directives; [0] is the default
    struct sr_array named_materials; // struct sr_pbrt_entity
    struct sr_array textures;        // struct sr_pbrt_texture
    struct sr_array media;           // struct sr_pbrt_entity
    struct sr_array lights;          // struct sr_pbrt_light
    struct sr_array area_lights;     // struct sr_pbrt_entity
    struct sr_array shapes;          // struct sr_pbrt_shape
    struct sr_array objects;         // struct sr_pbrt_object
    struct sr_array instances;       // struct sr_pbrt_instance
    struct sr_array meters;          // struct sr_pbrt_entity
    struct sr_array uncertainties;   // struct sr_pbrt_entity
    struct sr_array memory_files;    // struct sr_pbrt_memory_file

    struct sr_pbrt_names object_names, material_names, medium_names, float_textures, spectrum_textures;

    bool reads_v3; // knows types of parameters that pbrt-v3 had: color, xyz
    size_t text_B; // that has been read
    uint64_t hash; // of it
};

/* Reads a file and all that it includes. data must outlive the description. The description is valid (and
 * must be freed) also after a failure. */
sr_status sr_pbrt_read(const char *path, struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                       struct sr_error *error);
/* The same from memory: label stands for the path. */
sr_status sr_pbrt_read_text(const char *label, const char *text, size_t size, struct sr_arena *data, struct sr_log *log,
                            struct sr_pbrt_description *out, struct sr_error *error);
void sr_pbrt_description_free(struct sr_pbrt_description *d);
/* An empty scene with pbrt's defaults: materials[0] is what shapes wear without a word, transforms[0] is none at all.
 * false: no memory. */
bool sr_pbrt_description_start(struct sr_pbrt_description *d, struct sr_arena *data, struct sr_log *log);
/* NULL: there is none of that name. */
const struct sr_pbrt_memory_file *sr_pbrt_memory_file(const struct sr_pbrt_description *d, const char *name);

#define SR_PBRT_AT(array, type, i) (&((type *)(array).data)[i])

/* ---- small services ---- */

uint64_t sr_pbrt_hash(uint64_t hash, const void *data, size_t size); // of data, going on from hash

/* Cut from the words arena: 16-byte aligned, zeroed, followed by 16 readable bytes. NULL: no memory. */
void *sr_pbrt_words(struct sr_pbrt_description *d, size_t size);
const char *sr_pbrt_text(struct sr_pbrt_description *d, const char *text, size_t length); // a copy, ended by NUL

/* "file:line:column: " (without line 0) and the sentence, and from where the file was included. */
SR_PRINTF(5, 6)
sr_status sr_pbrt_fail(const struct sr_pbrt_description *d, struct sr_location where, struct sr_error *error,
                       sr_status status, const char *format, ...);
SR_PRINTF(3, 4)
void sr_pbrt_warn(const struct sr_pbrt_description *d, struct sr_location where, const char *format, ...);

/* Remembers the candidate nearest to a misspelt word (optimal string alignment distance, case ignored). */
struct sr_pbrt_suggestion {
    const char *word, *best;
    int distance;
};
void sr_pbrt_suggest(struct sr_pbrt_suggestion *s, const char *candidate);
/* `: did you mean "best"?`, or nothing where nothing is near. */
const char *sr_pbrt_suggestion_text(const struct sr_pbrt_suggestion *s, char buffer[160]);

bool sr_pbrt_names_add(struct sr_pbrt_names *n, const char *name, uint32_t index1); // false: no memory
uint32_t sr_pbrt_names_find(const struct sr_pbrt_names *n, const char *name);       // 0: none
void sr_pbrt_names_suggest(const struct sr_pbrt_names *n, struct sr_pbrt_suggestion *s);
void sr_pbrt_names_free(struct sr_pbrt_names *n);

/* The entity's parameter of that name, whatever its type; NULL: not given. find marks it used. */
struct sr_pbrt_param *sr_pbrt_peek(const struct sr_pbrt_params *params, const char *name);
struct sr_pbrt_param *sr_pbrt_find(const struct sr_pbrt_params *params, const char *name);
/* Values of a parameter of that name and type; the first initial value where there is none. A wrong type is an error.
 */
sr_status sr_pbrt_get_float(const struct sr_pbrt_description *d, const struct sr_pbrt_params *p, const char *name,
                            float *value, struct sr_error *e);
sr_status sr_pbrt_get_int(const struct sr_pbrt_description *d, const struct sr_pbrt_params *p, const char *name,
                          int32_t *value, struct sr_error *e);
sr_status sr_pbrt_get_bool(const struct sr_pbrt_description *d, const struct sr_pbrt_params *p, const char *name,
                           bool *value, struct sr_error *e);
sr_status sr_pbrt_get_string(const struct sr_pbrt_description *d, const struct sr_pbrt_params *p, const char *name,
                             const char **value, struct sr_error *e);

#endif
