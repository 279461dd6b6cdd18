/* SPDX-License-Identifier: MIT */
/* What the files of this room share: parameters that are evaluated at hits, folded to numbers where they are constant.
 *
 * A table's row points to the texture inside one of these structs; prepare calls the bind function, which looks whether
 * the texture is constant. Evaluating a folded parameter calls no texture. */
#ifndef SR_MATERIAL_PRIVATE_H
#define SR_MATERIAL_PRIVATE_H

#include "material/material.h"

extern const struct sr_material_model sr_material_diffuse, sr_material_diffuse_transmission, sr_material_conductor,
    sr_material_dielectric, sr_material_thin_dielectric, sr_material_coated_diffuse, sr_material_coated_conductor,
    sr_material_mix, sr_material_interface, sr_material_hair, sr_material_subsurface;

/* A spectrum. */
struct bound_spectrum {
    struct sr_texture texture;
    struct sr_spd constant; // kind SR_SPD_NONE: ask the texture
};

/* `otherwise` (may be of kind NONE) stands where the scene gives no texture. */
static inline void bind_spectrum(struct bound_spectrum *b, struct sr_spd otherwise)
{
    b->constant = b->texture.model ? (struct sr_spd){.kind = SR_SPD_NONE} : otherwise;
    struct sr_spd value;
    if (sr_texture_is_constant_spectrum(b->texture, &value))
        b->constant = value;
}
static inline sr_spectrum eval_spectrum(const struct bound_spectrum *b, const struct sr_material_context *c)
{
    if (b->constant.kind == SR_SPD_CONSTANT)
        return SR_BLACK + b->constant.scale;
    if (b->constant.kind != SR_SPD_NONE)
        return sr_spd_eval(&b->constant, c->w->lambda);
    return sr_texture_spectrum(b->texture, c->x, c->w);
}
static inline sr_spectrum eval_albedo(const struct bound_spectrum *b, const struct sr_material_context *c)
{
    return sr_spectrum_clamp(eval_spectrum(b, c), 0, 1);
}

/* A number. */
struct bound_float {
    struct sr_texture texture;
    bool is_constant;
    float constant;
};
static inline void bind_float(struct bound_float *b, float otherwise)
{
    b->constant = otherwise;
    b->is_constant = !b->texture.model || sr_texture_is_constant_float(b->texture, &b->constant);
}
static inline float eval_float(const struct bound_float *b, const struct sr_material_context *c)
{
    return b->is_constant ? b->constant : sr_texture_float(b->texture, c->x);
}

/* Microfacets: roughness along u and v; where those are not given, one roughness for both. */
struct bound_ggx {
    struct sr_texture roughness, u_roughness, v_roughness;
    struct bound_float u, v;
    bool is_constant;
    struct sr_ggx constant;
};
void bind_ggx(struct bound_ggx *b, bool remap);
struct sr_ggx eval_ggx_textures(const struct bound_ggx *b, bool remap, const struct sr_material_context *c);
static inline struct sr_ggx eval_ggx(const struct bound_ggx *b, bool remap, const struct sr_material_context *c)
{
    return b->is_constant ? b->constant : eval_ggx_textures(b, remap, c);
}

/* The index of a dielectric at the first wavelength. Where it is not the same at all wavelengths, the others end here:
 * they would be refracted elsewhere. */
static inline float eval_index(const struct bound_spectrum *b, const struct sr_material_context *c)
{
    if (SR_LIKELY(b->constant.kind == SR_SPD_CONSTANT))
        return b->constant.scale > 0 ? b->constant.scale : 1;
    sr_spectrum eta = eval_spectrum(b, c);
    for (int i = 1; i < SR_LAMBDA_COUNT; ++i)
        if (eta[i] != eta[0]) {
            sr_wavelengths_terminate_secondary(c->w);
            break;
        }
    return eta[0] > 0 ? eta[0] : 1; // a table of the scene may end before the observer's range does
}

/* Index and absorption of a metal, given as such or by its reflectance at normal incidence. */
struct bound_metal {
    struct bound_spectrum eta, k, reflectance;
};
sr_status bind_metal(struct bound_metal *b, struct sr_error *error);
void eval_metal(const struct bound_metal *b, const struct sr_material_context *c, sr_spectrum *eta, sr_spectrum *k);

#endif
