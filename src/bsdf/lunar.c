/* SPDX-License-Identifier: MIT */
/* The Moon after Hapke's first theory: Lommel-Seeliger's law, grains that scatter as Lambert's spheres, and the shadows
 * that vanish when the Sun stands behind the viewer, so that the full Moon outshines two half Moons by far.
 *
 *     a = angle between wo and wi (phase angle, 0: Sun behind the viewer)   [rad],   g = compaction, t = forward
 *     f = reflectance 2 / (3 pi) R(a) ((sin a + (pi - a) cos a) / pi + t (1 - cos a)^2) / (cos_theta_i + cos_theta_o)
 *         [1/sr]
 *     R = 2 - tan a / (2 g) (1 - e)(3 - e),  e = exp(-g / tan a),  where a < pi / 2, else 1;   R(0) = 2
 *     pdf = (1 + 2 cos_theta_i) / (4 pi)   [1/sr]
 *
 * B. W. Hapke, A theoretical photometric function for the lunar surface, 1963; the sphere's phase law: E. Schoenberg
 * 1929. g is 0.4 (porous: narrow surge) to 0.8; Hapke's fit to the Moon is g = 0.6, t = 0.1. reflectance is no albedo:
 * with it at 1 and t > 0.2, more light leaves near grazing than arrives. Limits: single scattering, smooth relief: a
 * full disk without limb darkening. */
#include "bsdf/hemisphere.h"

struct lunar {
    sr_spectrum reflectance;
    float compaction, forward;
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.2, offsetof(struct lunar, reflectance), "brightness of the grains"},
    {SR_PARAM_FLOAT, "compaction", "1", 0.05, 2, 0.6, offsetof(struct lunar, compaction),
     "how closely the grains lie: width of the surge about the Sun's direction"},
    {SR_PARAM_FLOAT, "forward", "1", 0, 0.5, 0.1, offsetof(struct lunar, forward), "light that grains send on"},
    {0},
};

static uint32_t lobes(const void *self)
{
    const struct lunar *m = self;
    return sr_spectrum_is_black(m->reflectance) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct lunar *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float c = sr_clamp(sr_dot(wo, wi), -1, 1), s = sr_min(sr_length(sr_cross(wo, wi)), 1), a = atan2f(s, c);
    float phase = (s + (SR_PI - a) * c) * SR_INV_PI + m->forward * sr_sqr(1 - c);
    float R = 1, x = m->compaction * c; // x / s = g / tan a
    if (x > 1e-5f * s) {
        float lit = -expm1f(-x / sr_max(s, 1e-30f)); // 1 - e
        R = 2 - s / (2 * x) * lit * (2 + lit);
    }
    return m->reflectance * (2 / (3 * SR_PI) * R * sr_max(phase, 0) / (wo.z + wi.z));
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
    return finish(&sr_bsdf_lunar, self, wo, draw_half_cosine(u), SR_LOBE_DIFFUSE, mode, s);
}

const struct sr_bsdf_model sr_bsdf_lunar = {
    .name = "lunar",
    .title = "Lunar (Hapke 1963)",
    .source = "B. W. Hapke, A theoretical photometric function for the lunar surface, 1963",
    .limits = "Single scattering on smooth relief: for dark, porous ground.",
    .params = params,
    .size = sizeof(struct lunar),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .largest_albedo = 1.55f, // toward grazing: reflectance 1, compaction 2, forward 0.5
};
