/* SPDX-License-Identifier: MIT */
/* Parameters that several materials have: microfacets and metals.
 *
 *     alpha = sqrt(roughness) where roughness is remapped, else alpha = roughness                       [1]
 *     of a metal known by its reflectance r at normal incidence alone: eta = 1, k = 2 sqrt(r) / sqrt(1 - r)
 *
 * The second solves r = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2) for eta = 1. r is held below 0.9999, where k is 200.
 * Pharr, Jakob & Humphreys 2023, 10.5. */
#include "material/private.h"

static struct sr_ggx ggx_of(float u, float v, bool remap)
{
    u = sr_max(u, 0);
    v = sr_max(v, 0);
    struct sr_ggx g = {remap ? sr_ggx_roughness_to_alpha(u) : u, remap ? sr_ggx_roughness_to_alpha(v) : v};
    if (!sr_ggx_is_smooth(g)) { // one axis may be polished while the other is not: slopes stay finite
        g.alpha_x = sr_max(g.alpha_x, 1e-4f);
        g.alpha_y = sr_max(g.alpha_y, 1e-4f);
    }
    return g;
}

void bind_ggx(struct bound_ggx *b, bool remap)
{
    b->u.texture = b->u_roughness.model ? b->u_roughness : b->roughness;
    b->v.texture = b->v_roughness.model ? b->v_roughness : b->roughness;
    bind_float(&b->u, 0);
    bind_float(&b->v, 0);
    b->is_constant = b->u.is_constant && b->v.is_constant;
    if (b->is_constant)
        b->constant = ggx_of(b->u.constant, b->v.constant, remap);
}

struct sr_ggx eval_ggx_textures(const struct bound_ggx *b, bool remap, const struct sr_material_context *c)
{
    return ggx_of(eval_float(&b->u, c), eval_float(&b->v, c), remap);
}

sr_status bind_metal(struct bound_metal *b, struct sr_error *error)
{
    if (b->reflectance.texture.model) {
        if (b->eta.texture.model || b->k.texture.model)
            return sr_fail(error, SR_ERROR_INPUT, "a metal is given by its reflectance or by eta and k, not by both");
        bind_spectrum(&b->reflectance, (struct sr_spd){.kind = SR_SPD_NONE});
        return SR_OK;
    }
    bind_spectrum(&b->eta, sr_spd_named("metal-Cu-eta"));
    bind_spectrum(&b->k, sr_spd_named("metal-Cu-k"));
    return SR_OK;
}

void eval_metal(const struct bound_metal *b, const struct sr_material_context *c, sr_spectrum *eta, sr_spectrum *k)
{
    if (b->reflectance.texture.model) {
        sr_spectrum r = sr_spectrum_clamp(eval_spectrum(&b->reflectance, c), 0, 0.9999f);
        *eta = SR_ONE;
        *k = 2 * sr_spectrum_sqrt(r / (1 - r));
        return;
    }
    *eta = eval_spectrum(&b->eta, c);
    *k = eval_spectrum(&b->k, c);
}
