/* SPDX-License-Identifier: MIT */
/* What reading carries along: the graphics state, its stack, and where in which file it is. */
#ifndef SR_IMPORT_PBRT_PARSER_H
#define SR_IMPORT_PBRT_PARSER_H

#include "import/pbrt/description.h"
#include "import/pbrt/lexer.h"
#include "import/pbrt/params.h"

enum sr_pbrt_attribute {
    SR_PBRT_OF_SHAPE,
    SR_PBRT_OF_LIGHT,
    SR_PBRT_OF_MATERIAL,
    SR_PBRT_OF_MEDIUM,
    SR_PBRT_OF_TEXTURE,
    SR_PBRT_ATTRIBUTE_COUNT,
};

struct sr_pbrt_state {
    struct sr_pbrt_transform ctm;
    uint32_t transform;    // its index in the description; UINT32_MAX: not stored yet
    bool at_start, at_end; // which of the two transforms are being changed
    bool reverse_orientation;
    struct sr_pbrt_material_ref material;
    uint32_t area_light1;
    const char *inside, *outside; // media
    struct sr_location medium_where;
    enum sr_colour_space_id space;
    struct sr_pbrt_params attributes[SR_PBRT_ATTRIBUTE_COUNT];
};

struct sr_pbrt_saved_state {
    struct sr_pbrt_state state;
    struct sr_location where;
    bool is_object;
};

struct sr_pbrt_coordinates {
    const char *name;
    struct sr_pbrt_transform transform;
};

struct sr_pbrt_parser {
    struct sr_pbrt_description *d;
    struct sr_error *error;
    const char *main_path;
    struct sr_pbrt_lexer *lexer; // of the file being read
    const char *directive;       // being read
    struct sr_location where;    // where it stands
    struct sr_pbrt_scratch scratch;
    struct sr_pbrt_state state;
    struct sr_array stack;       // struct sr_pbrt_saved_state
    struct sr_array coordinates; // struct sr_pbrt_coordinates
    uint32_t object1;            // being defined; 0: none
    uint32_t depth;              // of Include
    bool has_warned_transform, has_warned_motion;
    struct sr_array annotations; // struct sr_pbrt_annotation of the file being read, not yet looked at
    const char *shape_name;      // of "#@ Name", for the next shape
    struct sr_location shape_name_where;
};

/* A directive: its word, where it may stand, what it does. The list ends with a NULL word. */
enum { SR_PBRT_IN_OPTIONS = 1, SR_PBRT_IN_WORLD = 2, SR_PBRT_ANYWHERE = 3 };
struct sr_pbrt_directive {
    const char *word;
    int block;
    sr_status (*read)(struct sr_pbrt_parser *parser);
};
extern const struct sr_pbrt_directive sr_pbrt_directives[];
extern const struct sr_pbrt_directive sr_pbrt_annotations[]; // those of comments: "#@ Meter"

/* The arguments of a directive. */
sr_status sr_pbrt_read_string(struct sr_pbrt_parser *parser, const char *expected, const char **text);
sr_status sr_pbrt_read_numbers(struct sr_pbrt_parser *parser, int count, double *values);
sr_status sr_pbrt_read_entity(struct sr_pbrt_parser *parser, const char *expected, struct sr_pbrt_params defaults,
                              struct sr_pbrt_entity *entity);

/* Reads another file in the place where it is named. */
sr_status sr_pbrt_include(struct sr_pbrt_parser *parser, const char *name);

/* The current transform's index in the description; UINT32_MAX: no memory. */
uint32_t sr_pbrt_store_transform(struct sr_pbrt_parser *parser);

/* transforms.c */
sr_status sr_pbrt_read_identity(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_translate(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_scale(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_rotate(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_look_at(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_transform(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_concat_transform(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_coordinate_system(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_coord_sys_transform(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_active_transform(struct sr_pbrt_parser *p);
sr_status sr_pbrt_read_transform_times(struct sr_pbrt_parser *p);
sr_status sr_pbrt_name_coordinates(struct sr_pbrt_parser *p, const char *name, const struct sr_pbrt_transform *t);

#endif
