/* SPDX-License-Identifier: MIT */
/* A thin layer of dust on a Lambert surface: what the grains scatter once, and what shines through them.
 *
 *     f = albedo / (4 pi) p(a) / (mu_i + mu_o) (1 - T) + T reflectance / pi   [1/sr],
 *         T = exp(-thickness (1/mu_i + 1/mu_o))
 *     p = (1 - g^2) / (1 + 2 g cos a + g^2)^(3/2),  cos a = wi.wo  [1];   pdf = (1 + 2 mu_i) / (4 pi)   [1/sr]
 *
 * thickness is optical, through the layer along the normal; g > 0 sends light on, g < 0 back where it came from.
 * J. F. Blinn, Light reflection functions for simulation of clouds and dusty surfaces, 1982; phase law: L. Henyey &
 * J. Greenstein 1941. Limits: light that is scattered twice, or between grains and base, is missing. */
#include "bsdf/hemisphere.h"

struct dust {
    sr_spectrum albedo, reflectance;
    float thickness, g;
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "albedo", "1", 0, 1, 0.5, offsetof(struct dust, albedo), "share of light that a grain scatters"},
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.2, offsetof(struct dust, reflectance), "of the surface below"},
    {SR_PARAM_FLOAT, "thickness", "1", 0, 50, 0.5, offsetof(struct dust, thickness), "optical thickness of the layer"},
    {SR_PARAM_FLOAT, "g", "1", -0.9, 0.9, 0, offsetof(struct dust, g), "mean cosine of scattering by a grain"},
    {0},
};

static uint32_t lobes(const void *self)
{
    const struct dust *m = self;
    return sr_spectrum_is_black(m->albedo) && sr_spectrum_is_black(m->reflectance)
               ? 0
               : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct dust *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float way = m->thickness > 0 ? -m->thickness * (1 / sr_max(wo.z, 1e-20f) + 1 / sr_max(wi.z, 1e-20f)) : 0;
    float scattered = -expm1f(way), phase = henyey_greenstein(sr_dot(wo, wi), m->g);
    return m->albedo * (SR_INV_PI / 4 * phase * scattered / (wo.z + wi.z)) + m->reflectance * (SR_INV_PI * expf(way));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    return lobes(self) && upper(&wo, &wi) ? pdf_half_cosine(wi.z) : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)u_lobe;
    return finish(&sr_bsdf_dust, self, wo, draw_half_cosine(u), SR_LOBE_DIFFUSE, mode, s);
}

const struct sr_bsdf_model sr_bsdf_dust = {
    .name = "dust",
    .title = "Dust over a matte surface",
    .source = "J. F. Blinn, Light reflection functions for simulation of clouds and dusty surfaces, 1982",
    .limits = "Single scattering: thick layers of bright dust come out too dark.",
    .params = params,
    .size = sizeof(struct dust),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
};
