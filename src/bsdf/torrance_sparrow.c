/* SPDX-License-Identifier: MIT */
/* Torrance and Sparrow's surface: mirrors in V-shaped grooves, their tilts normally distributed, over a matte part.
 *
 *     f = reflectance / pi + specular F(c) D(m) G / (4 |zo| |zi|)                  [1/sr],    c = |wo.m|
 *     D = N exp(-theta_m^2 / alpha^2),    N so that INTEGRAL D(m) m.z dm = 1       [1/sr]
 *     G = min(1, 2 m.z |zo| / c, 2 m.z |zi| / c)                                   [1]
 *
 * The paper leaves the constant of D to a measurement at one angle; ours is that of a surface whose facets cover it
 * once. Its alpha is 1 / c of the paper, where tilts are in degrees. F is exact, of the index eta + i k relative to the
 * outside. Blinn (1977) found G's short form, valid for facets that are seen in any direction. K. E. Torrance & E. M.
 * Sparrow, Theory for off-specular reflection from roughened surfaces, 1967. */
#include "bsdf/facets.h"

struct torrance_sparrow {
    sr_spectrum reflectance, specular, eta, k; // [1]
    float alpha;                               // [rad]
    // of ready
    float scale;         // [1/sr] N
    float cut;           // [1] 1 - exp(-(pi / 2 alpha)^2): share of an unbounded distribution of tilts
    float matte, facing; // [1] means of reflectance and of specular F(1)
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.2, offsetof(struct torrance_sparrow, reflectance),
     "share of the light that the matte part reflects"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.8, offsetof(struct torrance_sparrow, specular),
     "share of the light that meets facets"},
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 1.5, offsetof(struct torrance_sparrow, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 0, offsetof(struct torrance_sparrow, k), "absorption index"},
    {SR_PARAM_FLOAT, "alpha", "rad", 0.001, 1, 0.3, offsetof(struct torrance_sparrow, alpha),
     "width of the tilts: sqrt(2) times their root mean square along an axis"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    static const float x[8] = {0.0950125098f, 0.2816035508f, 0.4580167777f, 0.6178762444f,
                               0.7554044084f, 0.8656312024f, 0.9445750231f, 0.9894009350f};
    static const float w[8] = {0.1894506105f, 0.1826034150f, 0.1691565194f, 0.1495959888f,
                               0.1246289713f, 0.0951585117f, 0.0622535239f, 0.0271524594f};
    struct torrance_sparrow *m = self;
    (void)at;
    m->alpha = larger(m->alpha, GGX_MIN_ALPHA);
    m->matte = sr_spectrum_mean(m->reflectance);
    m->facing = sr_spectrum_mean(m->specular * conductor_fresnel(1, m->eta, m->k));
    // 1 / N = pi INTEGRAL_0^(pi/2) exp(-(t / alpha)^2) sin(2 t) dt, by Gauss and Legendre's rule of 16 points
    float half = sr_min(SR_PI / 2, 4.5f * m->alpha) / 2, sum = 0;
    for (int i = 0; i < 8; ++i) {
        float lo = half * (1 - x[i]), hi = half * (1 + x[i]);
        sum += w[i] * (expf(-sr_sqr(lo / m->alpha)) * sinf(2 * lo) + expf(-sr_sqr(hi / m->alpha)) * sinf(2 * hi));
    }
    m->scale = 1 / (SR_PI * half * sum);
    m->cut = -expm1f(-sr_sqr(SR_PI / 2 / m->alpha));
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE;
}

static float facet_share(const struct torrance_sparrow *m, sr_vec3 wo)
{
    float d = 1 - sr_min(fabsf(wo.z), 1), d2 = d * d;
    float facets = m->facing + (sr_spectrum_mean(m->specular) - m->facing) * (d2 * d2 * d);
    if (!(m->matte > 0))
        return 1;
    return facets > 0 ? larger(facets / (facets + m->matte), 0.1f) : 0;
}

/* Tilts are drawn by the density 2 t exp(-(t / alpha)^2) / (alpha^2 cut), azimuths evenly, and of each pair of a
 * groove's facets the one that is seen: over the cosine |wo.m| the density is D' min(1 / |zo|, 2 m.z / |wo.m|) [1/sr],
 * where D' is as D but for a factor near 1. */
__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct torrance_sparrow *m = self;
    (void)mode;
    *p = 0;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    float share = facet_share(m, wo);
    *p = (1 - share) * fabsf(wi.z) * (1 / SR_PI);
    sr_spectrum sum = m->reflectance * (1 / SR_PI);
    sr_vec3 h;
    float cos_m;
    if (!mirror_facet(wo, wi, &h, &cos_m))
        return sum;
    float sine = sqrtf(h.x * h.x + h.y * h.y), tilt = atan2f(sine, fabsf(h.z));
    float zo = fabsf(wo.z), zi = fabsf(wi.z), e = expf(-sr_sqr(tilt / m->alpha));
    float drawn = (sine > 1e-6f ? tilt / sine : 1) * e / (SR_PI * m->alpha * m->alpha * m->cut); // D' m.z
    *p += share * 0.25f * drawn * sr_min(1 / (zo * fabsf(h.z)), 2 / cos_m);
    float G = sr_min(1 / sr_min(zo, zi), 2 * fabsf(h.z) / cos_m) / larger(zo, zi);
    if (*p > 0 && e > 0)
        sum += m->specular * conductor_fresnel(cos_m, m->eta, m->k) * (0.25f * m->scale * e * G);
    return sum;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_torrance_sparrow.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_torrance_sparrow.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct torrance_sparrow *m = self;
    float share = facet_share(m, wo), side = wo.z < 0 ? -1.0f : 1.0f;
    if (wo.z == 0)
        return false;
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION};
    if (u_lobe < share) {
        s->lobe |= SR_LOBE_GLOSSY;
        float tilt = m->alpha * sqrtf(-log1pf(-u.y * m->cut)), sine, cosine;
        sin_cos_turn(u.x, &sine, &cosine);
        sr_vec3 h = {sinf(tilt) * cosine, sinf(tilt) * sine, side * cosf(tilt)}, other = {-h.x, -h.y, h.z};
        float c = larger(sr_dot(wo, h), 0), d = larger(sr_dot(wo, other), 0);
        s->wi = sr_reflect(wo, u_lobe / share * (c + d) < c ? h : other);
    } else {
        s->lobe |= SR_LOBE_DIFFUSE;
        s->wi = sr_warp_cosine_hemisphere(u);
        s->wi.z *= side;
    }
    s->f = sr_bsdf_torrance_sparrow.f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0 && s->pdf < INFINITY;
}

const struct sr_bsdf_model sr_bsdf_torrance_sparrow = {
    .name = "torrance_sparrow",
    .title = "Torrance and Sparrow",
    .source = "K. E. Torrance & E. M. Sparrow, Theory for off-specular reflection from roughened surfaces, 1967",
    .limits = "Grooves make a crease in f where masking begins; light that bounces in a groove is lost",
    .params = params,
    .size = sizeof(struct torrance_sparrow),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
};
