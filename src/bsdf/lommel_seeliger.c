/* SPDX-License-Identifier: MIT */
/* Dark dust, such as the Moon's: light that is scattered once, evenly in all directions, by a thick layer of grains.
 *
 *     f(wo, wi) = albedo / (4 pi (cos_theta_o + cos_theta_i))   [1/sr],    pdf = (1 + 2 cos_theta_i) / (4 pi)   [1/sr]
 *     E(wo)     = albedo / 2 (1 - mu ln((1 + mu) / mu)),  mu = |cos_theta_o|   [1]
 *
 * albedo is that of a grain. H. v. Seeliger, Zur Photometrie der Saturnringe, 1887; S. Chandrasekhar, Radiative
 * Transfer, 1950. Limits: what is scattered twice is missing, so that bright dust comes out too dark. */
#include "bsdf/hemisphere.h"

struct lommel_seeliger {
    sr_spectrum albedo;
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "albedo", "1", 0, 1, 0.3, offsetof(struct lommel_seeliger, albedo),
     "share of light that a grain scatters"},
    {0},
};

static uint32_t lobes(const void *self)
{
    const struct lommel_seeliger *m = self;
    return sr_spectrum_is_black(m->albedo) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct lommel_seeliger *m = self;
    (void)mode;
    if (!upper(&wo, &wi)) // the side that is looked at is the side that reflects
        return SR_BLACK;
    return m->albedo * (SR_INV_PI / 4 / (wo.z + wi.z));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    return lobes(self) && upper(&wo, &wi) ? pdf_half_cosine(wi.z) : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)u_lobe; // one lobe: nothing to choose
    return finish(&sr_bsdf_lommel_seeliger, self, wo, draw_half_cosine(u), SR_LOBE_DIFFUSE, mode, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct lommel_seeliger *m = self;
    float mu = sr_abs_cos_theta(wo);
    return m->albedo * (mu > 0 ? (1 - mu * logf((1 + mu) / mu)) / 2 : 0.5f);
}

const struct sr_bsdf_model sr_bsdf_lommel_seeliger = {
    .name = "lommel_seeliger",
    .title = "Lommel-Seeliger",
    .source = "H. v. Seeliger, Zur Photometrie der Saturnringe, 1887",
    .limits = "Single scattering: bright dust comes out too dark.",
    .params = params,
    .size = sizeof(struct lommel_seeliger),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
};
