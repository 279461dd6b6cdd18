/* SPDX-License-Identifier: MIT */
/* A polished matte surface: a mirror's reflection by Fresnel's law, and below it matter that gets, and lets out,
 * exactly the light that the mirror leaves it.
 *
 *     mirror: R(c) = specular + (1 - specular)(1 - c)^5   [1], a delta function
 *     f   = 21 / (20 pi (1 - specular)) reflectance (1 - R(cos_theta_o)) (1 - R(cos_theta_i))   [1/sr]
 *     E   = R(cos_theta_o) + reflectance (1 - R(cos_theta_o)): 1 where reflectance = 1
 *
 * because 2 INTEGRAL c (1 - (1 - c)^5) dc = 20/21. P. Shirley, B. Smits, H. Hu & E. Lafortune, A practitioner's
 * assessment of light reflection models, 1997. Limits: Schlick's Fresnel; what matter sends back to itself at the
 * boundary is left out. */
#include "bsdf/hemisphere.h"

struct coupled {
    sr_spectrum reflectance, specular;
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct coupled, reflectance),
     "share of what the mirror leaves that the matter returns"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.05, offsetof(struct coupled, specular),
     "share that the mirror reflects at normal incidence"},
    {0},
};

static float grazing(float c) // (1 - c)^5
{
    float x = 1 - sr_min(c, 1), x2 = x * x;
    return x2 * x2 * x;
}

static sr_spectrum mirror(const struct coupled *m, float c)
{
    return m->specular + (1 - m->specular) * grazing(c);
}

static uint32_t lobes(const void *self)
{
    const struct coupled *m = self;
    bool matte = !sr_spectrum_is_black(m->reflectance * (1 - m->specular));
    return SR_LOBE_REFLECTION | SR_LOBE_SPECULAR | (matte ? SR_LOBE_DIFFUSE : 0u);
}

static float mirror_share(const struct coupled *m, float cos_o) // of the samples
{
    sr_spectrum R = mirror(m, cos_o);
    float mirrored = sr_spectrum_mean(R), matte = sr_spectrum_mean(m->reflectance * (1 - R));
    return matte > 0 ? mirrored / (mirrored + matte) : 1;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct coupled *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float k = 21 / (20 * SR_PI) * (1 - grazing(wo.z)) * (1 - grazing(wi.z));
    return m->reflectance * (1 - m->specular) * k;
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    return upper(&wo, &wi) ? (1 - mirror_share(self, wo.z)) * wi.z * SR_INV_PI : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct coupled *m = self;
    float cos_o = fabsf(wo.z), share = mirror_share(m, cos_o);
    if (u_lobe >= share)
        return finish(&sr_bsdf_coupled, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    if (wo.z == 0)
        return false;
    *s = (struct sr_bsdf_sample){.wi = {-wo.x, -wo.y, wo.z},
                                 .f = mirror(m, cos_o) / cos_o,
                                 .pdf = share,
                                 .eta = 1,
                                 .lobe = SR_LOBE_REFLECTION | SR_LOBE_SPECULAR};
    return sr_spectrum_is_finite(s->f);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct coupled *m = self;
    sr_spectrum R = mirror(m, sr_abs_cos_theta(wo));
    return R + m->reflectance * (1 - R);
}

const struct sr_bsdf_model sr_bsdf_coupled = {
    .name = "coupled",
    .title = "Coupled mirror and matte (Shirley 1997)",
    .source =
        "P. Shirley, B. Smits, H. Hu & E. Lafortune, A practitioner's assessment of light reflection models, 1997",
    .limits = "Schlick's Fresnel; no light goes to and fro between matter and boundary.",
    .params = params,
    .size = sizeof(struct coupled),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
    .largest_albedo = 1.005f, // toward grazing, where the table of what the gloss leaves over is interpolated
};
