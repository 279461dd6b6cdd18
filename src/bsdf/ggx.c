/* SPDX-License-Identifier: MIT */
/* Trowbridge and Reitz's rough surface (GGX): microfacets whose slopes are those of an ellipsoid.
 *
 *     D(m) = 1 / (pi ax ay ((m.x/ax)^2 + (m.y/ay)^2 + m.z^2)^2)    [1/sr],    INTEGRAL D(m) m.z dm = 1
 *     G1(w) = 1 / (1 + Lambda(w)),  G(wo, wi) = 1 / (1 + Lambda(wo) + Lambda(wi))      [1]
 *
 * T. S. Trowbridge & K. P. Reitz 1975; B. Walter et al. 2007; E. Heitz 2014 (masking), Dupuy & Benyoub 2023 (sampling).
 * Single scattering only: what bounces between facets is lost. */
#include "bsdf/microfacet.h"

bool sr_ggx_is_smooth(struct sr_ggx g)
{
    return ggx_is_smooth(g);
}

float sr_ggx_D(struct sr_ggx g, sr_vec3 wm)
{
    return ggx_D(ggx_usable(g), wm);
}

float sr_ggx_G1(struct sr_ggx g, sr_vec3 w)
{
    float z = fabsf(w.z);
    return z > 0 ? 2 * z / (z + ggx_stretched(ggx_usable(g), w)) : 0;
}

float sr_ggx_G(struct sr_ggx g, sr_vec3 wo, sr_vec3 wi)
{
    g = ggx_usable(g);
    float zo = fabsf(wo.z), zi = fabsf(wi.z);
    return zo > 0 && zi > 0 ? 2 * zo * zi / (ggx_stretched(g, wo) * zi + ggx_stretched(g, wi) * zo) : 0;
}

float sr_ggx_visible_pdf(struct sr_ggx g, sr_vec3 w, sr_vec3 wm)
{
    g = ggx_usable(g);
    float c = w.z < 0 ? -sr_dot(w, wm) : sr_dot(w, wm);
    return c > 0 && wm.z > 0 ? 2 * ggx_D(g, wm) * c / (fabsf(w.z) + ggx_stretched(g, w)) : 0;
}

sr_vec3 sr_ggx_sample_visible(struct sr_ggx g, sr_vec3 w, sr_vec2 u)
{
    return ggx_sample_visible(ggx_usable(g), w, u);
}

float sr_ggx_roughness_to_alpha(float roughness)
{
    return sqrtf(larger(roughness, 0));
}
