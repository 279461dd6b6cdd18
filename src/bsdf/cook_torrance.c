/* SPDX-License-Identifier: MIT */
/* Cook and Torrance's surface: Beckmann's facets in V-shaped grooves, over a matte part.
 *
 *     f = reflectance / pi + specular F(c) D(m) G / (4 |zo| |zi|)                  [1/sr],    c = |wo.m|
 *     D = exp(-tan^2 / alpha^2) / (pi alpha^2 m.z^4)                               [1/sr]
 *     G = min(1, 2 m.z |zo| / c, 2 m.z |zi| / c)                                   [1]
 *
 * F is Fresnel's, exact, of the index eta + i k relative to the outside; k = 0 is a plastic. The paper prints 1 / pi in
 * the place of 1 / 4: constant = inv_pi gives that, with the D above, for comparing with pictures that were made so. It
 * is 4 / pi too bright and has no derivation; 1 / 4 is |dm / dwi| times |wo.m| and keeps E <= 1. Energy is kept where
 * specular + reflectance <= 1. The paper's sum over several alpha is a sum of such materials. Facets are drawn as the
 * grooves show them (Heitz & d'Eon 2014): the weight of a sample is F G2 / G1 <= F. R. L. Cook & K. E. Torrance, A
 * reflectance model for computer graphics, 1982. */
#include "bsdf/facets.h"

struct cook_torrance {
    sr_spectrum reflectance, specular, eta, k; // [1]
    float alpha;
    int32_t constant;
    // of ready
    float matte, facing; // [1] means of reflectance and of specular F(1)
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.2, offsetof(struct cook_torrance, reflectance),
     "share of the light that the matte part reflects"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.8, offsetof(struct cook_torrance, specular),
     "share of the light that meets facets"},
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 1.5, offsetof(struct cook_torrance, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 0, offsetof(struct cook_torrance, k), "absorption index"},
    {SR_PARAM_FLOAT, "alpha", "1", 0.001, 1, 0.3, offsetof(struct cook_torrance, alpha),
     "slope width: the paper's m, sqrt(2) times the root mean square slope"},
    {SR_PARAM_ENUM, "constant", "1", 0, 1, 0, offsetof(struct cook_torrance, constant), "quarter|inv_pi"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct cook_torrance *m = self;
    (void)at;
    m->matte = sr_spectrum_mean(m->reflectance);
    m->facing = sr_spectrum_mean(m->specular * conductor_fresnel(1, m->eta, m->k));
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE;
}

static struct facets facets(const struct cook_torrance *m)
{
    return facets_of(SLOPES_BECKMANN, MASKING_V, m->alpha, m->alpha);
}

/* How often facets are drawn: by the share of light that they send, as Schlick's formula guesses it. */
static float facet_share(const struct cook_torrance *m, sr_vec3 wo)
{
    float d = 1 - sr_min(fabsf(wo.z), 1), d2 = d * d;
    float facets = m->facing + (sr_spectrum_mean(m->specular) - m->facing) * (d2 * d2 * d);
    if (!(m->matte > 0))
        return 1;
    return facets > 0 ? larger(facets / (facets + m->matte), 0.1f) : 0;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct cook_torrance *m = self;
    (void)mode;
    *p = 0;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    struct facets a = facets(m);
    float share = facet_share(m, wo), pdf_m, cos_m;
    float shape = facets_reflection(&a, wo, wi, &pdf_m, &cos_m);
    *p = share * pdf_m + (1 - share) * fabsf(wi.z) * (1 / SR_PI);
    sr_spectrum sum = m->reflectance * (1 / SR_PI);
    if (shape > 0)
        sum += m->specular * conductor_fresnel(cos_m, m->eta, m->k) * (m->constant ? shape * (4 / SR_PI) : shape);
    return sum;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_cook_torrance.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_cook_torrance.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct cook_torrance *m = self;
    struct facets a = facets(m);
    float share = facet_share(m, wo), shape, cos_m;
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION};
    if (u_lobe < share) {
        s->lobe |= SR_LOBE_GLOSSY;
        if (!facets_sample_reflection(&a, wo, u_lobe / share, u, &s->wi, &shape, &s->pdf, &cos_m))
            return false;
    } else {
        s->lobe |= SR_LOBE_DIFFUSE;
        s->wi = sr_warp_cosine_hemisphere(u);
        if (wo.z < 0)
            s->wi.z = -s->wi.z;
    }
    s->f = sr_bsdf_cook_torrance.f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0;
}

const struct sr_bsdf_model sr_bsdf_cook_torrance = {
    .name = "cook_torrance",
    .title = "Cook and Torrance",
    .source = "R. L. Cook & K. E. Torrance, A reflectance model for computer graphics, 1982",
    .limits =
        "Grooves make a crease in f where masking begins; with the constant 1/pi it returns up to 4/pi of the light",
    .params = params,
    .size = sizeof(struct cook_torrance),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = 1.274f,
};
