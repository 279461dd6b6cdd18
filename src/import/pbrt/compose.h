/* SPDX-License-Identifier: MIT */
/* Descriptions made of other things than pbrt files: what a reader of glTF or OBJ calls.
 *
 * Parameters come first, then the entity that takes them:
 *
 *     sr_compose_rgb(&c, "reflectance", (struct sr_rgb){1, 0, 0});
 *     sr_compose_material(&c, "red", "diffuse");
 *     c.material = "red";
 *     sr_compose_floats(&c, SR_PBRT_POINT3, "P", positions, 3 * count);
 *     sr_compose_ints(&c, "indices", indices, 3 * triangles);
 *     sr_compose_shape(&c, "trianglemesh");
 *
 * The first mistake sticks in the error and is what sr_compose_end returns; until then all calls are harmless. Words
 * are copied. Numbers of floats and ints stay where they are: in d->data where a scene may keep them (indices, uv,
 * floats), in d->words otherwise (P and N, which the placement of a shape copies), followed by 16 readable bytes. */
#ifndef SR_IMPORT_PBRT_COMPOSE_H
#define SR_IMPORT_PBRT_COMPOSE_H

#include "import/pbrt/description.h"

struct sr_compose {
    struct sr_pbrt_description *d;
    struct sr_error *error;
    const char *path;       // of the file
    struct sr_array params; // struct sr_pbrt_param, since the last entity

    /* the graphics state, for the caller to set; everything that is added takes what is here */
    struct sr_location where; // for messages: the file, and a line where it has lines (0: none)
    uint32_t transform;       // of shapes, lights, textures and instances; 0: none
    const char *material;     // by name; NULL: pbrt's grey
    uint32_t area_light1;     // 0: dark
    uint32_t object1;         // 0: the world
    bool reverse_orientation;
    const char *inside, *outside; // media; NULL: none
};

/* d is made anew; it is valid, and must be freed, whatever happens. */
void sr_compose_begin(struct sr_compose *c, const char *path, struct sr_arena *data, struct sr_log *log,
                      struct sr_pbrt_description *d, struct sr_error *error);
sr_status sr_compose_end(struct sr_compose *c);

uint32_t sr_compose_matrix(struct sr_compose *c, const struct sr_matrix *a);
uint32_t sr_compose_transform(struct sr_compose *c, const struct sr_transform *t); // its number, for c->transform
/* A copy, kept as long as the description. */
const char *sr_compose_word(struct sr_compose *c, const char *word);
SR_PRINTF(2, 3) const char *sr_compose_printf(struct sr_compose *c, const char *format, ...);

/* ---- parameters of the next entity ---- */

void sr_compose_bool(struct sr_compose *c, const char *name, bool value);
void sr_compose_int(struct sr_compose *c, const char *name, int32_t value);
void sr_compose_float(struct sr_compose *c, const char *name, float value);
void sr_compose_string(struct sr_compose *c, const char *name, const char *value);
void sr_compose_texture_name(struct sr_compose *c, const char *name, const char *texture);
void sr_compose_rgb(struct sr_compose *c, const char *name, struct sr_rgb value);
void sr_compose_spectrum(struct sr_compose *c, const char *name, const char *spectrum); // by its name: "metal-Cu-eta"
void sr_compose_blackbody(struct sr_compose *c, const char *name, float kelvin);
void sr_compose_tuple(struct sr_compose *c, enum sr_pbrt_type type, const char *name,
                      sr_vec3 value); // POINT3, VECTOR3, NORMAL
/* Runs of count numbers (not of points), not copied: see above. */
void sr_compose_floats(struct sr_compose *c, enum sr_pbrt_type type, const char *name, const float *values,
                       size_t count);
void sr_compose_ints(struct sr_compose *c, const char *name, const int32_t *values, size_t count);

/* ---- entities: they take the parameters ---- */

/* "Film", "Sampler", "PixelFilter", "Integrator": there is one of each. */
void sr_compose_setting(struct sr_compose *c, const char *directive, const char *model);
/* Camera space as pbrt's: x to the right, y up, looks along z. */
void sr_compose_camera(struct sr_compose *c, const char *model, const struct sr_transform *camera_to_world);
void sr_compose_material(struct sr_compose *c, const char *name, const char *model); // MakeNamedMaterial
void sr_compose_texture(struct sr_compose *c, const char *name, bool is_float, const char *model);
void sr_compose_medium(struct sr_compose *c, const char *name, const char *model);
void sr_compose_light(struct sr_compose *c, const char *model);
uint32_t sr_compose_area_light(struct sr_compose *c); // "diffuse"; its number, for c->area_light1
void sr_compose_shape(struct sr_compose *c, const char *model);
void sr_compose_named_shape(struct sr_compose *c, const char *name, const char *model); // for meters: "#@ Name"
uint32_t sr_compose_object(struct sr_compose *c, const char *name);                     // its number, for c->object1
void sr_compose_instance(struct sr_compose *c, const char *object);                     // placed by c->transform

/* A file that lies in memory: where an image is asked for by this name, these bytes are read. Not copied; d->words or
 * d->data must hold them. */
void sr_compose_file(struct sr_compose *c, const char *name, const void *data, size_t size);

/* The error, told of c->where. */
SR_PRINTF(3, 4) sr_status sr_compose_fail(struct sr_compose *c, sr_status status, const char *format, ...);
SR_PRINTF(2, 3) void sr_compose_warn(struct sr_compose *c, const char *format, ...);

#endif
