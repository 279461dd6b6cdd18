/* SPDX-License-Identifier: MIT */
/* The surface of a translucent body, seen by light that comes out of it after many scatterings: diffuse but for
 * Fresnel.
 *
 *     f(wo, wi) = T(theta_i) / (pi t),   t = 2 INTEGRAL_0^1 T(mu) mu dmu = 1 - F_diffuse(eta)      [1/sr]
 *
 * so that light arriving from all sides enters with the share t, and the BSSRDF's spatial part keeps its normalisation
 * (Christensen & Burley 2015; Pharr, Jakob & Humphreys 2016, 11.4.2). The radiance form has the factor eta^2, which
 * cancels the 1 / eta^2 of the refraction at the other end. Limits: T of a smooth boundary, also where the material is
 * rough. */
#include "bsdf/bsdf.h"

void sr_bsdf_exit_make(struct sr_bsdf *b, float eta)
{
    struct sr_bsdf_exit *m = (void *)b->data;
    m->eta = eta;
    m->scale = (float)(1 / (1 - sr_fresnel_diffuse((double)eta))) * SR_INV_PI;
    b->model = &sr_bsdf_exit;
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct sr_bsdf_exit *m = self;
    if (!sr_same_hemisphere(wo, wi))
        return SR_BLACK;
    float form = mode == SR_RADIANCE ? m->eta * m->eta : 1;
    return SR_BLACK + (1 - sr_fresnel_dielectric(fabsf(wi.z), m->eta)) * m->scale * form;
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)self, (void)mode;
    return sr_same_hemisphere(wo, wi) ? fabsf(wi.z) * SR_INV_PI : 0;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)u_lobe;
    sr_vec3 wi = sr_warp_cosine_hemisphere(u);
    wi.z = copysignf(wi.z, wo.z);
    *s = (struct sr_bsdf_sample){
        .wi = wi, .f = f(self, wo, wi, mode), .pdf = fabsf(wi.z) * SR_INV_PI, .eta = 1, .lobe = lobes(self)};
    return s->pdf > 0;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    (void)self, (void)wo;
    return SR_ONE;
}

const struct sr_bsdf_model sr_bsdf_exit = {
    .name = "exit",
    .title = "Exit from a translucent body",
    .params = (const struct sr_param[]){{0}},
    .size = sizeof(struct sr_bsdf_exit),
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .albedo = albedo,
    .asymmetry = 1,
};
