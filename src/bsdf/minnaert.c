/* SPDX-License-Identifier: MIT */
/* A disk that darkens or brightens to its limb, by a power of both cosines.
 *
 *     f   = reflectance (k + 1) / (2 pi) (cos_theta_i cos_theta_o)^(k - 1)   [1/sr]
 *     pdf = (k + 1) / (2 pi) cos_theta_i^k   [1/sr],     E = reflectance cos_theta_o^(k - 1)   [1]
 *
 * k = 1 is Lambert's surface; the Moon has about 0.5 (no limb darkening at full phase), cloudy planets about 0.9. In
 * the planetary form I/F = B0 mu0^k mu^(k-1), B0 = reflectance (k + 1) / 2. Cosines below 1e-6 see nothing. M.
 * Minnaert, The reciprocity principle in lunar photometry, 1941. Limits: no phase angle enters; with k < 1 it returns
 * more light than arrives near grazing, without bound. */
#include "bsdf/hemisphere.h"

struct minnaert {
    sr_spectrum reflectance;
    float k;
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct minnaert, reflectance),
     "share of light that is reflected at normal incidence"},
    {SR_PARAM_FLOAT, "k", "1", 0.5, 2, 1.2, offsetof(struct minnaert, k), "limb darkening; 1: none of its own"},
    {0},
};

#define LEAST_COSINE 1e-6f

static bool seen(sr_vec3 *wo, sr_vec3 *wi)
{
    return upper(wo, wi) && wo->z >= LEAST_COSINE && wi->z >= LEAST_COSINE;
}

static uint32_t lobes(const void *self)
{
    const struct minnaert *m = self;
    return sr_spectrum_is_black(m->reflectance) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct minnaert *m = self;
    (void)mode;
    if (!seen(&wo, &wi))
        return SR_BLACK;
    return m->reflectance * ((m->k + 1) * 0.5f * SR_INV_PI * powf(wo.z * wi.z, m->k - 1));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct minnaert *m = self;
    (void)mode;
    return lobes(m) && seen(&wo, &wi) ? (m->k + 1) * 0.5f * SR_INV_PI * powf(wi.z, m->k) : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct minnaert *m = self;
    (void)u_lobe;
    sr_vec3 wi = draw_power_of_cos((sr_vec3){0, 0, 1}, m->k, u);
    return finish(&sr_bsdf_minnaert, self, wo, wi, SR_LOBE_DIFFUSE, mode, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct minnaert *m = self;
    float mu = sr_abs_cos_theta(wo);
    return mu < LEAST_COSINE ? SR_BLACK : m->reflectance * powf(mu, m->k - 1);
}

const struct sr_bsdf_model sr_bsdf_minnaert = {
    .name = "minnaert",
    .title = "Minnaert",
    .source = "M. Minnaert, The reciprocity principle in lunar photometry, 1941",
    .limits = "With k < 1 it returns more light than arrives near grazing.",
    .params = params,
    .size = sizeof(struct minnaert),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
    .largest_albedo = 1000, // LEAST_COSINE^(k - 1) where k = 0.5
};
