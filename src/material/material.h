/* SPDX-License-Identifier: MIT */
/* A BSDF model bound to textures: gives the BSDF at a point. One file a material, named by the scene file's word. */
#ifndef SR_MATERIAL_MATERIAL_H
#define SR_MATERIAL_MATERIAL_H

#include "bsdf/bsdf.h"
#include "subsurface/subsurface.h"
#include "texture/texture.h"

/* All that a material may look at. */
struct sr_material_context {
    const struct sr_point *x;
    sr_vec3 wo;               // [1] in the world
    struct sr_wavelengths *w; // a dispersive material ends the secondary wavelengths
    float u;                  // [1] uniform number for stochastic choices (mix); may be rescaled and used again
    uint32_t seed;            // of this vertex, for random walks
};

struct sr_material {
    const struct sr_material_model *model; // NULL: interface, light passes as if nothing were there
    const void *self;
    struct sr_texture displacement;  // bump [m], or none: the scene file's "displacement", of any material
    struct sr_texels normal_map;     // width 0: none; "normalmap": numbers, bytes count as byte / 255
    const struct sr_texture *normal; // NULL: none; three float textures, "normalx", "normaly", "normalz": along
                                     // tangent, dp/dv's side, and ns; instead of the map [1]
};

/* A BSDF model needs no file here: its material follows from its table. Those that have one give the words of pbrt, or
 * more than the BSDF's own parameters. The importer fills the (zeroed) struct by the table, calls sr_material_prepare
 * once, and from then on the material never changes. Textures that a table leaves out may be of NULL model: the
 * defaults are known. */
struct sr_material_model {
    const char *name; // the scene file's word
    const struct sr_param *params;
    size_t size;
    sr_status (*prepare)(void *self, struct sr_arena *arena, struct sr_error *error); // may be NULL
    void (*bsdf)(const void *self, const struct sr_material_context *c, struct sr_bsdf *out);
    bool is_isotropic; // unless it has a roughness of its own along the tangent: "uroughness" or "vroughness" in a name
    /* mix: the part that is here, and what is left of the uniform number; NULL for all others */
    const struct sr_material *(*choose)(const void *self, struct sr_material_context *c);
    /* Light that the BSDF lets in comes out elsewhere, by this. false: not here. NULL: never. */
    bool (*bssrdf)(const void *self, const struct sr_material_context *c, struct sr_bssrdf *out);
    // once prepared: one sentence on what is given in vain; NULL, or returns NULL
    const char *(*remark)(const void *self);
};
const struct sr_material_model *sr_material_model(int i); // all that scenes may name, the i-th; NULL past the end
const struct sr_material_model *sr_material_model_find(const char *name);
/* The one that follows from the BSDF's table, also where a file of this room bears the same name. */
const struct sr_material_model *sr_material_of_bsdf(const struct sr_bsdf_model *bsdf);
sr_status sr_material_prepare(const struct sr_material_model *model, void *self, struct sr_arena *arena,
                              struct sr_error *error);

/* Whether anything of the material may look at the footprint of a point: a texture that is not constant, or a bump map.
 */
bool sr_material_has_footprint(const struct sr_material *material);

/* Whether it looks at no more of a point than p, n and ns: no texture, no map, no preferred tangent. */
bool sr_material_is_plain(const struct sr_material *material);

/* The reflectance of a plain material that is Lambert's with one colour everywhere; NULL: it is not. */
const struct sr_sigmoid *sr_material_lambert(const struct sr_material *material);

/* The BSDF and the frame of a plain material at x, which most often is Lambert's. */
static inline void sr_material_shade_plain(const struct sr_material *material, const struct sr_sigmoid *lambert,
                                           struct sr_point *x, sr_vec3 wo, float u, uint32_t seed,
                                           struct sr_wavelengths *w, struct sr_bsdf *out, struct sr_frame *frame)
{
    *frame = sr_frame_from_z(x->ns);
    if (SR_LIKELY(lambert != NULL)) {
        out->model = &sr_bsdf_diffuse;
        ((struct sr_bsdf_diffuse *)(void *)out->data)->reflectance = sr_sigmoid_eval(*lambert, w->lambda);
        return;
    }
    struct sr_material_context c = {x, wo, w, u, seed};
    material->model->bsdf(material->self, &c, out);
}

/* The BSDF at x and the frame it lives in: applies mix, bump and normal map (which turn x->ns, x->dpdus), then asks the
 * model. out->model NULL: interface. */
void sr_material_shade(const struct sr_material *material, struct sr_point *x, sr_vec3 wo, float u, uint32_t seed,
                       struct sr_wavelengths *w, struct sr_bsdf *out, struct sr_frame *frame);

/* The BSSRDF at x, as sr_material_shade with the same numbers has left it (mixes choose alike). false: there is none.
 */
bool sr_material_bssrdf(const struct sr_material *material, struct sr_point *x, sr_vec3 wo, float u, uint32_t seed,
                        struct sr_wavelengths *w, struct sr_bssrdf *out);
/* Whether the material, or one that it is mixed of, has one. */
bool sr_material_has_bssrdf(const struct sr_material *material);

#endif
