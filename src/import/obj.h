/* SPDX-License-Identifier: MIT */
/* Wavefront OBJ and its materials, STL, and PLY alone, as scenes. Formats of import/describe.h. */
#ifndef SR_IMPORT_OBJ_H
#define SR_IMPORT_OBJ_H

#include "import/describe.h"
#include "import/pbrt/compose.h"

sr_status sr_obj_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error);
sr_status sr_stl_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error);
sr_status sr_ply_scene_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                            struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error);
/* From memory; text[size] must be NUL. label stands for the path, beside which materials are looked for. */
sr_status sr_obj_read_text(const char *label, const char *text, size_t size, const struct sr_import_options *options,
                           struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                           struct sr_error *error);
sr_status sr_stl_read_bytes(const char *label, const char *bytes, size_t size, const struct sr_import_options *options,
                            struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                            struct sr_error *error);

/* ---- lines of words: both files of OBJ ---- */

/* Blanks are skipped, also the end of a line behind a backslash. At the line's end: *p is '\n' or NUL. */
const char *sr_obj_skip(const char *p);
const char *sr_obj_next_line(const char *p, int *line);
bool sr_obj_is_word(const char *p, const char *word); // the line's first word, in any case
size_t sr_obj_word_length(const char *p);
/* Up to count numbers; how many there are. */
int sr_obj_numbers(const char *p, int count, double *values);

/* ---- obj_materials.c ---- */

struct sr_obj_map {
    const char *path; // NULL: none
    float scale[2], offset[2], bump;
    bool clamps;
};
struct sr_obj_material {
    const char *name;
    struct sr_location where;
    struct sr_rgb Kd, Ks, Ke, Tf;
    float Ns, Ni, d, Pr, Pm; // Pr, Pm negative: not given
    int illum;               // negative: not given
    bool has_Kd;
    struct sr_obj_map map_Kd, map_Ks, map_Ke, map_d, map_bump, map_normal, map_Pr, map_Pm;
    bool is_composed;
    bool is_textured;
    uint32_t area_light1;
};
/* Adds the file's materials to the array (struct sr_obj_material). A file that is not there is a warning. */
void sr_obj_materials_read(struct sr_compose *c, const char *path, struct sr_array *materials);
/* Composes it if that has not been done; sets c->material and c->area_light1. */
void sr_obj_material_wear(struct sr_compose *c, struct sr_obj_material *m);
/* The parameter "alpha" of a shape that wears it. */
void sr_obj_material_alpha(struct sr_compose *c, const struct sr_obj_material *m);

#endif
