/* SPDX-License-Identifier: MIT */
/* glTF 2.0 and GLB files as descriptions. What the files of this folder share; the door is sr_gltf_read.
 *
 * Everything that a file says is checked where it is read: types, ranges, indices, sizes against buffers. The first
 * mistake sticks in g->c.error, told with the file and a JSON pointer ("model.gltf: /accessors/3/count: …"); after it,
 * functions return harmless values, and loops end. Khronos Group, glTF 2.0 Specification, 2021 (ISO/IEC 12113:2022). */
#ifndef SR_IMPORT_GLTF_GLTF_H
#define SR_IMPORT_GLTF_GLTF_H

#include "import/describe.h"
#include "import/pbrt/compose.h"

#include <jansson.h>

/* One format of describe.c. */
sr_status sr_gltf_read(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                       struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error);
/* The same from memory: label stands for the path. */
sr_status sr_gltf_read_bytes(const char *label, const char *bytes, size_t size, const struct sr_import_options *options,
                             struct sr_arena *data, struct sr_log *log, struct sr_pbrt_description *out,
                             struct sr_error *error);

/* A value of the file and where it is: "/meshes/3/primitives/0". */
struct sr_gltf_at {
    json_t *json; // NULL: it is not there
    char pointer[120];
};

struct sr_gltf_buffer {
    const uint8_t *data;
    size_t size;
};

struct sr_gltf_node {
    bool is_of_scene;
    double world[4][4];
};

/* What a mesh is where several nodes show it. */
struct sr_gltf_object {
    uint32_t uses;    // by nodes of the scene, in the same pose
    const char *name; // of the object of the description; NULL: not made, or empty
    bool is_made;
    struct sr_box bounds;
    struct sr_gltf_part *parts; // one for each primitive; NULL: none has a form
};

struct sr_gltf {
    struct sr_compose c;
    const struct sr_import_options *options;
    json_t *root;
    struct sr_arena scratch;        // ends with the reading
    struct sr_gltf_buffer *buffers; // one for each of the file
    struct sr_gltf_buffer binary;   // of a GLB file
    struct sr_gltf_node *nodes;
    uint32_t node_count;
    struct sr_gltf_object *objects; // one for each mesh
    const char **images;            // names of files; NULL: not used yet
    uint64_t input_B;               // of JSON and buffers
    uint64_t made_B, most_B;        // [B] of arrays that have been made, and may be
    struct sr_array told;           // const char *, warnings
    struct sr_pbrt_names made;      // textures and media that have been composed
    struct sr_pbrt_names worn_names;
    struct sr_array worn; // materials.c
    struct sr_pbrt_names form_names;
    struct sr_array forms; // struct sr_gltf_form
    struct sr_box bounds;  // of all that was placed [m]
    uint32_t light_count;
    bool has_emissive;
    uint32_t variant1; // of KHR_materials_variants
};

static inline bool sr_gltf_is_well(const struct sr_gltf *g)
{
    return g->c.error->status == SR_OK;
}

/* ---- json.c: values with their places ---- */

SR_PRINTF(3, 4) void sr_gltf_fail(struct sr_gltf *g, const struct sr_gltf_at *at, const char *format, ...);
/* Once for each sentence. */
SR_PRINTF(3, 4) void sr_gltf_warn(struct sr_gltf *g, const struct sr_gltf_at *at, const char *format, ...);
void sr_gltf_note(struct sr_gltf *g, const char *what,
                  const char *why); // "what" is not taken over, with the reason, once

struct sr_gltf_at sr_gltf_list(struct sr_gltf *g, const char *key); // a list of the file's root; json NULL: none
uint32_t sr_gltf_count(const struct sr_gltf_at *list);              // 0 where there is none
struct sr_gltf_at sr_gltf_element(struct sr_gltf *g, const struct sr_gltf_at *list, uint32_t i); // an object
struct sr_gltf_at sr_gltf_entry(struct sr_gltf *g, const char *list, uint32_t i);                // the same of the root
struct sr_gltf_at sr_gltf_object(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key); // an object, or none
struct sr_gltf_at sr_gltf_array(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key);  // a list, or none
struct sr_gltf_at sr_gltf_extension(struct sr_gltf *g, const struct sr_gltf_at *at, const char *name);

double sr_gltf_number(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, double otherwise, double min,
                      double max);
uint64_t sr_gltf_size(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, uint64_t otherwise,
                      uint64_t max);
bool sr_gltf_bool(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, bool otherwise);
const char *sr_gltf_string(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key); // NULL: none
/* n numbers into out; false: there are none, out stays. */
bool sr_gltf_numbers(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, uint32_t n, double *out);
/* An index into a list of count, plus 1; 0: none. */
uint32_t sr_gltf_index1(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, uint32_t count);
uint32_t sr_gltf_index1_of(struct sr_gltf *g, const struct sr_gltf_at *at, uint32_t i,
                           uint32_t count); // the i-th of a list
uint32_t sr_gltf_root_count(struct sr_gltf *g, const char *key);
const char *sr_gltf_name(struct sr_gltf *g, const struct sr_gltf_at *at); // the name of a thing, or ""

/* Counts memory against what a file of this size may ask for: 16 times its bytes, and 48 MiB. false: an error. */
bool sr_gltf_charge(struct sr_gltf *g, const struct sr_gltf_at *at, uint64_t bytes);
/* Memory for arrays, followed by 16 readable bytes, within what a file of this size may ask for; NULL: an error. */
void *sr_gltf_array_for(struct sr_gltf *g, const struct sr_gltf_at *at, struct sr_arena *arena, uint64_t count,
                        size_t size);

/* ---- file.c, uri.c: bytes ---- */

bool sr_gltf_open(struct sr_gltf *g, const char *bytes, size_t size);
/* Bytes of an image or buffer: "data:" is decoded, names are read beside the file. */
bool sr_gltf_fetch(struct sr_gltf *g, const struct sr_gltf_at *at, const char *uri, struct sr_gltf_buffer *out);
bool sr_gltf_is_data_uri(const char *uri);
/* %41 -> A; NULL: not valid */
char *sr_gltf_unescape(struct sr_arena *arena, const char *uri);
/* The number of bytes written, SIZE_MAX: no base64. out has room for 3 / 4 of length + 3. */
size_t sr_gltf_base64(const char *text, size_t length, uint8_t *out);
struct sr_gltf_buffer sr_gltf_view(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, size_t *stride);

/* ---- accessor.c ---- */

struct sr_gltf_accessor {
    uint32_t count, components;
    uint32_t type; // 5120 BYTE … 5126 FLOAT
    bool normalized;
    const uint8_t *data; // NULL: zeros
    size_t stride;
    uint32_t sparse_count, sparse_type;
    const uint8_t *sparse_indices, *sparse_values;
    struct sr_gltf_at at;
};
/* index1 0: an empty one. components: expected, 0: any. */
struct sr_gltf_accessor sr_gltf_accessor(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key,
                                         uint32_t components);
void sr_gltf_floats(const struct sr_gltf_accessor *a, uint32_t i, float *out);            // components of them
uint32_t sr_gltf_whole(const struct sr_gltf_accessor *a, uint32_t i, uint32_t component); // of an unsigned integer type

/* ---- mesh.c, pose.c ---- */

enum { SR_GLTF_UV_SETS = 8 };

struct sr_gltf_mesh {
    uint32_t vertex_count, triangle_count;
    int32_t *indices;
    sr_vec3 *P, *N, *S;           // N, S: NULL if there are none
    sr_vec2 *uv[SR_GLTF_UV_SETS]; // as the file has them; NULL: none
    float *colours;               // four a vertex, linear; NULL: none
};

/* The joints' matrices, and how far morph targets are in. */
struct sr_gltf_pose {
    const double *weights; // of morph targets
    uint32_t weight_count;
    const float (*joints)[3][4]; // to the world; NULL: no skin
    uint32_t joint_count;
};
/* Where arrays go: positions, normals and tangents to words, the others to data; and which are wanted. */
struct sr_gltf_stores {
    struct sr_arena *words, *data;
    bool wants_tangents, wants_colours;
};
/* false: nothing to draw (told), or an error. uv_sets: bits. */
bool sr_gltf_read_mesh(struct sr_gltf *g, const struct sr_gltf_at *primitive, const struct sr_gltf_pose *pose,
                       uint32_t uv_sets, struct sr_gltf_stores stores, struct sr_gltf_mesh *out);
/* forms.c: what primitives of several meshes share, which differ by their materials alone. */
struct sr_gltf_form {
    uint32_t uses, triangles; // by primitives
    bool is_read;
    struct sr_gltf_mesh mesh;
    struct sr_box bounds;
    uint32_t object1; // of the description: the first that was made of it
};
struct sr_gltf_part { // a primitive
    uint32_t form1;
    bool is_made;
    const char *name; // of its object
};
void sr_gltf_find_forms(struct sr_gltf *g); // once the uses of meshes are counted
struct sr_gltf_form *sr_gltf_form_of(struct sr_gltf *g, uint32_t mesh,
                                     uint32_t primitive); // NULL: it stands for itself
/* pose.c: what a node wears. false: an error. Kept in arena. */
bool sr_gltf_read_pose(struct sr_gltf *g, uint32_t node, const struct sr_gltf_at *mesh, struct sr_arena *arena,
                       struct sr_gltf_pose *pose);

/* ---- textures.c ---- */

/* A "textureInfo" of a material. */
struct sr_gltf_texture {
    struct sr_gltf_at info; // json NULL: none
    uint32_t image1, set;
    double transform[6]; // in the file's coordinates: (u v) -> a u + b v + c, d u + e v + f
    const char *swrap, *twrap, *filter;
};
struct sr_gltf_texture sr_gltf_texture(struct sr_gltf *g, const struct sr_gltf_at *material, const char *key);
bool sr_gltf_is_identity(const double m[6]);
const char *sr_gltf_image(struct sr_gltf *g, uint32_t image); // the name under which it is read

/* Where a material is worn, and how its textures find their coordinates there. */
struct sr_gltf_surface {
    const char *name;                          // of the material: its own on primitives that need one
    bool is_split;                             // each triangle has its own vertices, with barycentric coordinates as uv
    const sr_vec2 *corner_uv[SR_GLTF_UV_SETS]; // if split; as the file has them
    const float *corner_colours;               // if split: four a corner, or NULL
    uint32_t corner_count;
    double uv_transform[6]; // U: of the mesh's uv
};
/* A composed texture, named after what it is for: channel NULL: the colour times factor; else one channel times
 * factor[0], plus offset. Its name. */
const char *sr_gltf_texelmap(struct sr_gltf *g, const struct sr_gltf_surface *s, const struct sr_gltf_texture *t,
                             const char *what, const char *channel, const double factor[3], double offset,
                             bool is_srgb);
bool sr_gltf_is_new(struct sr_gltf *g, const char *name); // remembers it

/* ---- materials.c, emission.c ---- */

/* What the file says of a material. */
struct sr_gltf_look {
    struct sr_gltf_at at;
    double colour[4], metal, roughness, normal_scale, cutoff, emission[3];
    double coat, coat_roughness, sheen[3], sheen_roughness, film, film_ior, film_nm[2], anisotropy, anisotropy_rotation;
    double transmission, ior, dispersion, specular, specular_colour[3], attenuation_m, attenuation[3], gloss;
    struct sr_gltf_texture base_texture, metal_texture, normal_texture, emission_texture, coat_texture,
        coat_roughness_texture, coat_normal_texture, sheen_texture, sheen_roughness_texture, film_texture,
        film_thickness_texture, anisotropy_texture, transmission_texture, specular_texture, specular_colour_texture,
        gloss_texture;
    int alpha; // 0 opaque, 1 mask, 2 blend
    bool is_double_sided, is_solid, is_glossy, is_unlit, is_emissive;
};
void sr_gltf_read_look(struct sr_gltf *g, uint32_t material1, struct sr_gltf_look *look);

/* What a material wants of the meshes that wear it. */
struct sr_gltf_needs {
    uint32_t uv_sets;  // bits
    uint32_t mesh_set; // the one that the mesh itself carries
    bool tangents;     // a normal map, or anisotropy
    double uv_transform[6];
};
struct sr_gltf_needs sr_gltf_needs_of(const struct sr_gltf_look *look);
/* Composes material and emission where they are new; sets c.material, c.area_light1, c.inside. *alpha: a float texture,
 * or NULL. */
void sr_gltf_wear(struct sr_gltf *g, const struct sr_gltf_look *look, const struct sr_gltf_surface *s,
                  const char **alpha);
uint32_t sr_gltf_emission(struct sr_gltf *g, const struct sr_gltf_look *look,
                          const struct sr_gltf_surface *s); // area light

/* ---- pose.c, places.c, lights.c, camera.c ---- */

void sr_gltf_compose_trs(const double t[3], const double q[4], const double s[3], double out[4][4]);
void sr_gltf_place_nodes(struct sr_gltf *g);
struct sr_transform sr_gltf_transform_of(const double m[4][4]);
uint32_t sr_gltf_material_of(struct sr_gltf *g, const struct sr_gltf_at *primitive); // from 1; 0: none
void sr_gltf_place_meshes(struct sr_gltf *g);
void sr_gltf_place_lights(struct sr_gltf *g);
void sr_gltf_place_camera(struct sr_gltf *g, sr_vec3 *key); // key: where a bright region of the sky does well

#endif
