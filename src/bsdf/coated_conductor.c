/* SPDX-License-Identifier: MIT */
/* Lacquer over metal: a dielectric coat, smooth or rough, over a conductor, with a medium between them.
 *
 * f is estimated by the walks of layered.h. The base's eta and k are relative to the coat. The density, which serves
 * for weighing only, is that of the coat's own lobe and of one reflection from the base, seen through the coat:
 *
 *     smooth coat:  pdf_base(refracted wo, wi) dw_inside/dw_outside,
 *         dw_inside/dw_outside = cos_outside / (eta^2 cos_inside)
 *     rough coat:   a lobe of slope variance  eta^2 alpha_base^2 + (eta - 1)^2 alpha_coat^2 / 2
 *
 * because a slope x of the base turns the ray by 2 x inside and 2 eta x outside, and a slope of the coat, met twice,
 * turns it by (eta - 1) x each time. Guo, Hasan & Zhao 2018. */
#include "bsdf/layered.h"

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 6, 0.2, offsetof(struct sr_bsdf_coated, base_eta),
     "index of the metal relative to the coat"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct sr_bsdf_coated, base_k),
     "absorption index relative to the coat"},
    {SR_PARAM_ALBEDO, "albedo", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, albedo),
     "of the medium between; black only absorbs"},
    {SR_PARAM_FLOAT, "coat_alpha_x", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, coat_ggx.alpha_x),
     "slope width of the coat along the tangent"},
    {SR_PARAM_FLOAT, "coat_alpha_y", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, coat_ggx.alpha_y),
     "slope width of the coat across it"},
    {SR_PARAM_FLOAT, "base_alpha_x", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, base_ggx.alpha_x),
     "slope width of the metal along the tangent"},
    {SR_PARAM_FLOAT, "base_alpha_y", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, base_ggx.alpha_y),
     "slope width of the metal across it"},
    {SR_PARAM_FLOAT, "coat_eta", "1", 0.5, 3, 1.5, offsetof(struct sr_bsdf_coated, coat_eta),
     "index of refraction of the coat"},
    {SR_PARAM_FLOAT, "thickness", "1", 0, 10, 0.01, offsetof(struct sr_bsdf_coated, thickness),
     "of the medium, in mean free paths"},
    {SR_PARAM_FLOAT, "g", "1", -0.95, 0.95, 0, offsetof(struct sr_bsdf_coated, g),
     "mean cosine of scattering in the medium"},
    {SR_PARAM_INT, "max_depth", "1", 1, 100, 10, offsetof(struct sr_bsdf_coated, max_depth),
     "longest walk, in crossings and scatterings"},
    {SR_PARAM_INT, "sample_count", "1", 1, 64, 1, offsetof(struct sr_bsdf_coated, sample_count),
     "walks for one value of f"},
    {0},
};

static bool is_delta(const struct layers *l)
{
    return l->top.is_smooth && l->base_is_smooth && !l->has_medium;
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    ((struct sr_bsdf_coated *)self)->seed = at->seed;
}

static uint32_t lobes(const void *self)
{
    struct layers l = layers_of(self, true);
    if (is_delta(&l))
        return SR_LOBE_REFLECTION | SR_LOBE_SPECULAR;
    return SR_LOBE_REFLECTION | (l.has_medium ? SR_LOBE_DIFFUSE : 0) |
           (l.top.is_smooth && l.base_is_smooth ? 0 : SR_LOBE_GLOSSY) |
           (l.top.is_smooth && (l.top.eta != 1 || l.base_is_smooth) ? SR_LOBE_SPECULAR : 0);
}

/* One machine code for all who ask. */
__attribute__((noinline)) static float density(const struct layers *l, sr_vec3 wo, sr_vec3 wi)
{
    const struct sr_bsdf_coated *c = l->c;
    if (is_delta(l))
        return 0;
    float eta = c->coat_eta, top = 0, base = 0, cos_m;
    float cos_to, cos_ti, Fo = fresnel_and_cos(wo.z, eta, &cos_to), Fi = fresnel_and_cos(wi.z, eta, &cos_ti);
    if (l->top.is_smooth) {
        if (!l->base_is_smooth && Fo < 1 && Fi < 1) {
            sr_vec3 in = {-wo.x / eta, -wo.y / eta, cos_to}, out = {-wi.x / eta, -wi.y / eta, cos_ti};
            ggx_reflection(l->base, in, out, &base, &cos_m);
            base *= wi.z / (eta * eta * cos_ti);
        }
    } else {
        interface_f_pdf(&l->top, wo, wi, SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION, &top);
        float s = sr_sqr(eta), t = 0.5f * sr_sqr(eta - 1);
        struct sr_ggx seen = {sr_min(1, sqrtf(s * sr_sqr(l->base.alpha_x) + t * sr_sqr(l->top.ggx.alpha_x))),
                              sr_min(1, sqrtf(s * sr_sqr(l->base.alpha_y) + t * sr_sqr(l->top.ggx.alpha_y)))};
        ggx_reflection(ggx_usable(seen), wo, wi, &base, &cos_m);
    }
    // what the medium scatters, and what meets the base again and again, goes anywhere
    float anywhere = l->has_medium ? 1 - 0.9f * crossing(2 * c->thickness, (sr_vec3){0, 0, 1}) : 0.1f;
    return (1 - anywhere) * (top + (1 - Fo) * base) + anywhere * wi.z * SR_INV_PI;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    (void)mode;
    *p = 0;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    if (wo.z < 0) {
        wo = sr_neg(wo);
        wi = sr_neg(wi);
    }
    struct layers l = layers_of(self, true);
    if (is_delta(&l))
        return SR_BLACK;
    *p = density(&l, wo, wi);
    return layered_f(&l, true, wo, wi);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_coated_conductor.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    (void)mode;
    if (!(wo.z * wi.z > 0))
        return 0;
    struct layers l = layers_of(self, true);
    return density(&l, wo.z < 0 ? sr_neg(wo) : wo, wo.z < 0 ? sr_neg(wi) : wi);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)mode;
    if (wo.z == 0)
        return false;
    struct layers l = layers_of(self, true);
    bool below = wo.z < 0;
    if (!layered_sample(&l, true, below ? sr_neg(wo) : wo, u_lobe, u, s))
        return false;
    if (below)
        s->wi = sr_neg(s->wi);
    return true;
}

const struct sr_bsdf_model sr_bsdf_coated_conductor = {
    .name = "coated_conductor",
    .title = "Metal under a dielectric coat",
    .source = "Y. Guo, M. Hasan & S. Zhao, Position-free Monte Carlo simulation for arbitrary layered BSDFs, 2018",
    .limits = "f is a random walk: right in the mean, noisy where the coat is narrow one way and wide the other; ends "
              "after max_depth events",
    .params = params,
    .size = sizeof(struct sr_bsdf_coated),
    .is_random = true,
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
};
