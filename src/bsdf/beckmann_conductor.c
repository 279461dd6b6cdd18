/* SPDX-License-Identifier: MIT */
/* A metal with Beckmann's microfacets: the slopes of its surface are distributed normally.
 *
 *     f   = F(|wo.m|) D(m) G(wo, wi) / (4 |zo| |zi|)                               [1/sr]
 *     D   = exp(-(m.x^2 / ax^2 + m.y^2 / ay^2) / m.z^2) / (pi ax ay m.z^4)         [1/sr]
 *     G   = 1 / (1 + Lambda(wo) + Lambda(wi))                                      [1]
 *     Lambda(w) = (exp(-a^2) / (a sqrt(pi)) - erfc(a)) / 2,    1 / a = sqrt((ax w.x)^2 + (ay w.y)^2) / |w.z|
 *
 * alpha is sqrt(2) times the root mean square of the slopes along its axis; eta and k are relative to the outside.
 * Lambda is Smith's, exactly, not its usual rational fit. Facets are drawn as they are seen: pdf = D / (4 |zo| (1 +
 * Lambda(wo))), the weight of a sample is F G2 / G1 <= F. P. Beckmann & A. Spizzichino 1963; B. Smith 1967; E. Heitz
 * 2014; E. Heitz & E. d'Eon 2014. A mirror (both alpha below 1e-3) is a delta function. What scatters twice is lost. */
#include "bsdf/facets.h"

struct beckmann_conductor {
    sr_spectrum eta, k; // [1]
    float alpha_x, alpha_y;
    bool is_smooth;
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct beckmann_conductor, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct beckmann_conductor, k), "absorption index"},
    {SR_PARAM_FLOAT, "alpha_x", "1", 0, 1, 0.3, offsetof(struct beckmann_conductor, alpha_x),
     "slope width along the tangent"},
    {SR_PARAM_FLOAT, "alpha_y", "1", 0, 1, 0.3, offsetof(struct beckmann_conductor, alpha_y), "slope width across it"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct beckmann_conductor *m = self;
    (void)at;
    m->is_smooth = ggx_is_smooth((struct sr_ggx){m->alpha_x, m->alpha_y});
}

static uint32_t lobes(const void *self)
{
    const struct beckmann_conductor *m = self;
    return SR_LOBE_REFLECTION | (m->is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY);
}

static struct facets facets(const struct beckmann_conductor *m)
{
    return facets_of(SLOPES_BECKMANN, MASKING_SMITH, m->alpha_x, m->alpha_y);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct beckmann_conductor *m = self;
    (void)mode;
    *p = 0;
    if (m->is_smooth)
        return SR_BLACK;
    struct facets a = facets(m);
    float cos_m, shape = facets_reflection(&a, wo, wi, p, &cos_m);
    return shape > 0 ? conductor_fresnel(cos_m, m->eta, m->k) * shape : SR_BLACK;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_beckmann_conductor.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_beckmann_conductor.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct beckmann_conductor *m = self;
    (void)mode;
    if (wo.z == 0)
        return false;
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = lobes(self)};
    if (m->is_smooth) {
        s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
        s->pdf = 1;
        s->f = conductor_fresnel(fabsf(wo.z), m->eta, m->k) / fabsf(wo.z);
        return true;
    }
    struct facets a = facets(m);
    float shape, cos_m;
    if (!facets_sample_reflection(&a, wo, u_lobe, u, &s->wi, &shape, &s->pdf, &cos_m))
        return false;
    s->f = conductor_fresnel(cos_m, m->eta, m->k) * shape;
    return true;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct beckmann_conductor *m = self;
    return m->is_smooth ? conductor_fresnel(fabsf(wo.z), m->eta, m->k) : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_beckmann_conductor = {
    .name = "beckmann_conductor",
    .title = "Metal with Beckmann's microfacets",
    .source = "E. Heitz, Understanding the masking-shadowing function in microfacet-based BRDFs, 2014, eqs. 72 and 99",
    .limits = "Light that bounces between facets is lost: up to 54 % of it at alpha = 1",
    .params = params,
    .size = sizeof(struct beckmann_conductor),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
