/* SPDX-License-Identifier: MIT */
/* He, Torrance, Sillion and Greenberg's surface: waves on a rough plane, from a mirror in the infrared to facets in the
 * blue.
 *
 *     f    = delta part + specular F(c) (4 c^2 / h.z^2) S D / (pi |zo| |zi|) + reflectance / pi           [1/sr]
 *     D    = (pi^2 tau^2 / (4 lambda^2)) SUM_{m >= 1} g^m exp(-g) / (m! m) exp(-(v tau)^2 / (4 m))         [1]
 *     g    = (2 pi sigma (|zo| + |zi|) / lambda)^2,   v = 2 pi |(wo + wi)_xy| / lambda                     [1], [1/um]
 *
 * with h the half vector, c = |wo.h|. The mirror's share is specular F exp(-g) S. sigma is the root mean square height
 * that is seen, sigma0 / sqrt(1 + x^2) with x exp(x^2 / 2) = (K(wo) + K(wi)) / sqrt(8 pi), K = tan erfc(tau / (2 sigma0
 * tan)); S is the product of S1 = (1 - erfc(q) / 2) / (1 + L), L = (exp(-q^2) / (sqrt(pi) q) - erfc(q)) / 2, q = tau /
 * (2 sigma0 tan). The wave number in v, the exp(-q^2) in L and G = 4 c^2 / h.z^2 follow the authors' corrections. For g
 * >> 1 it becomes Beckmann's facets with alpha = 2 sigma / tau. Unpolarised; wavelengths are those of the path. X. D.
 * He, K. E. Torrance, F. X. Sillion & D. P. Greenberg, A comprehensive physical model for light reflection, 1991. */
#include "bsdf/facets.h"

struct he {
    sr_spectrum reflectance, specular, eta, k; // [1]
    float sigma, tau;                          // [um]
    // of ready
    sr_spectrum lambda; // [um]
    float longest;      // [um]
    float matte;        // [1] mean of reflectance
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct he, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct he, k), "absorption index"},
    {SR_PARAM_FLOAT, "sigma", "um", 0.01, 2, 0.18, offsetof(struct he, sigma), "root mean square height"},
    {SR_PARAM_FLOAT, "tau", "um", 1, 20, 3, offsetof(struct he, tau), "autocorrelation length of the heights"},
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0, offsetof(struct he, reflectance),
     "share of the light that the matte part reflects"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 1, offsetof(struct he, specular),
     "share of the light that meets the rough plane"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct he *m = self;
    m->lambda = at->lambda * 1e-3f;
    m->longest = sr_spectrum_max(m->lambda);
    m->matte = sr_spectrum_mean(m->reflectance);
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_SPECULAR | SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE;
}

static float cotangent(sr_vec3 w)
{
    return fabsf(w.z) / sqrtf(larger(w.x * w.x + w.y * w.y, 1e-20f));
}
static float shadowing(const struct he *m, sr_vec3 w) // S1
{
    float q = m->tau / (2 * m->sigma) * cotangent(w);
    if (q > 6)
        return 1;
    float far = erfcf(q);
    // (1 - far / 2) / (1 + L), times q above and below
    return (1 - 0.5f * far) * q / (q + 0.5f * (expf(-q * q) * 0.56418958f - q * far));
}
static float tilt(const struct he *m, sr_vec3 w) // K
{
    float cot = larger(cotangent(w), 1e-20f), q = m->tau / (2 * m->sigma) * cot;
    return q > 6 ? 0 : erfcf(q) / cot;
}
/* (2 pi sigma (zo + zi))^2 [um^2]: g times lambda^2 */
static float phase2(const struct he *m, sr_vec3 wo, sr_vec3 wi)
{
    float goal = (tilt(m, wo) + tilt(m, wi)) * 0.19947114f, x = goal < 1 ? goal : sqrtf(2 * logf(goal)) + 0.5f;
    for (int i = 0; i < 10 && goal > 1e-6f; ++i)
        x -= (x - goal * expf(-0.5f * x * x)) / (1 + x * x);
    return sr_sqr(2 * SR_PI * m->sigma * (fabsf(wo.z) + fabsf(wi.z))) / (1 + x * x);
}

/* SUM_{m >= 1} g^m exp(-g) / (m! m) exp(-c / m) */
static float series(float g, float c)
{
    if (g > 600) { // two terms in 1 / g
        float x = c / g;
        return x < 80 ? expf(-x) / g * (1 + (x * x - 4 * x + 2) / (2 * g)) : 0;
    }
    if (g <= 20) {
        float sum = 0, term = g * expf(-g);
        int last = (int)(g + 10 * sqrtf(g) + 12);
        for (int m = 1; m <= last; ++m) {
            float r = 1 / (float)m;
            if (c * r < 80)
                sum += term * r * expf(-c * r);
            term *= g / (float)(m + 1);
        }
        return sum;
    }
    // a smooth bell over m: the sum is its integral, and that is a sum over fewer points
    float middle = g;
    for (int i = 0; i < 3; ++i) // where terms are largest: ln(g / m) + c / m^2 = 0
        middle += (logf(g / middle) + c / (middle * middle)) / (1 / middle + 2 * c / (middle * middle * middle));
    if (!(c / middle < 80))
        return 0;
    float step = 0.9f * sqrtf(middle), sum = 0;
    for (int i = -8; i <= 8; ++i) {
        float m = middle + step * (float)i, d = m - g;
        if (m < 1)
            continue;
        float r = 1 / m;
        float power = d - m * log1pf(d / g) - r * (1.0f / 12 - r * r * (1.0f / 360)) - c * r; // Stirling
        sum += expf(power) * r * sqrtf(r);
    }
    return sum * step * 0.39894228f; // 1 / sqrt(2 pi)
}

struct shares {
    float mirror, facets, plane, even; // probabilities
    float alpha, width2;               // [1] slope width; variance of (wo + wi)_xy along an axis
};
static struct shares shares(const struct he *m, sr_vec3 wo)
{
    struct shares s;
    float g2 = phase2(m, wo, wo), S = sr_sqr(shadowing(m, wo)), g = g2 / sr_sqr(m->longest), whole = 0;
    s.mirror = 0;
    sr_spectrum F = m->specular * conductor_fresnel(fabsf(wo.z), m->eta, m->k);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float power = -sr_min(g2 / sr_sqr(m->lambda[i]), 80);
        s.mirror += F[i] * expf(power) * S / SR_LAMBDA_COUNT;
        whole -= F[i] * expm1f(power) * S / SR_LAMBDA_COUNT;
    }
    // no differences of shares near 1: at grazing nearly all is mirrored, and the rest must keep its digits
    float rest = whole + m->matte, sum = s.mirror + rest;
    s.mirror = s.mirror > 1e-7f * sum ? s.mirror / sum : 0;
    rest = s.mirror > 0 ? rest / sum : 1;
    float lobe = whole > 0 ? 0.95f * larger(whole / (whole + m->matte), 0.1f) : 0;
    s.even = rest * (1 - lobe);
    s.plane = rest * lobe * larger(0.1f, 0.9f / (1 + g));
    s.facets = rest * lobe - s.plane;
    s.alpha = larger(2 * m->sigma / m->tau * sqrtf(larger(1.2f, 4 / larger(g, 1e-6f))), GGX_MIN_ALPHA);
    s.width2 = sr_sqr(m->longest / m->tau) / (2 * SR_PI * SR_PI);
    return s;
}

static float density(const struct shares *s, sr_vec3 wo, sr_vec3 wi)
{
    sr_vec3 H = sr_add(wo, wi);
    float xy2 = H.x * H.x + H.y * H.y, z2 = H.z * H.z, length2 = xy2 + z2, zi = fabsf(wi.z);
    float p = s->even * zi * (1 / SR_PI);
    if (xy2 < 160 * s->width2)
        p += s->plane * zi * expf(-xy2 / (2 * s->width2)) / (2 * SR_PI * s->width2);
    float e = xy2 / sr_sqr(s->alpha);
    if (length2 > 1e-20f && e < 80 * z2)
        p += s->facets * expf(-e / z2) * length2 / (2 * SR_PI * sr_sqr(s->alpha) * z2 * fabsf(H.z));
    return p;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct he *m = self;
    (void)mode;
    *p = 0;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    struct shares s = shares(m, wo);
    *p = density(&s, wo, wi);
    if (!(*p > 0 && *p < INFINITY)) {
        *p = 0;
        return SR_BLACK;
    }
    sr_spectrum sum = m->reflectance * (1 / SR_PI);
    sr_vec3 H = sr_add(wo, wi);
    float length2 = sr_length2(H), zo = fabsf(wo.z), zi = fabsf(wi.z);
    if (!(length2 > 1e-20f) || !(H.z * H.z > 1e-12f * length2))
        return sum;
    float cos_h = 0.5f * sqrtf(length2), G = length2 / (H.z * H.z) * length2; // 4 c^2 / h.z^2 with c = |H| / 2
    float S = shadowing(m, wo) * shadowing(m, wi), g2 = phase2(m, wo, wi);
    float c2 = sr_sqr(SR_PI * m->tau) * (H.x * H.x + H.y * H.y);
    float scale = G * S * SR_PI * m->tau * m->tau / (4 * larger(zo * zi, 1e-20f));
    sr_spectrum D = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float per = 1 / sr_sqr(m->lambda[i]);
        D[i] = scale * per * series(g2 * per, c2 * per);
    }
    return sum + m->specular * conductor_fresnel(cos_h, m->eta, m->k) * D;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_he.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_he.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct he *m = self;
    if (wo.z == 0)
        return false;
    struct shares share = shares(m, wo);
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION};
    if (u_lobe < share.mirror) {
        s->lobe |= SR_LOBE_SPECULAR;
        s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
        s->pdf = share.mirror;
        sr_spectrum g = phase2(m, wo, wo) / (m->lambda * m->lambda);
        s->f = m->specular * conductor_fresnel(fabsf(wo.z), m->eta, m->k) * sr_spectrum_exp(-g) *
               (sr_sqr(shadowing(m, wo)) / fabsf(wo.z));
        return true;
    }
    u_lobe -= share.mirror;
    s->lobe |= SR_LOBE_GLOSSY;
    float sine, cosine;
    sin_cos_turn(u.x, &sine, &cosine);
    if (u_lobe < share.facets) {
        struct facets a = facets_of(SLOPES_BECKMANN, MASKING_SMITH, share.alpha, share.alpha);
        sr_vec3 h = facets_sample_projected(&a, u);
        s->wi = sr_reflect(wo, h);
        if (!(wo.z * s->wi.z > 0 && wo.z * sr_dot(wo, h) > 0))
            return false;
    } else if (u_lobe < share.facets + share.plane) {
        float r = sqrtf(-2 * share.width2 * log1pf(-u.y)), x = r * cosine - wo.x, y = r * sine - wo.y;
        float z2 = 1 - x * x - y * y;
        if (!(z2 > 0))
            return false;
        s->wi = (sr_vec3){x, y, wo.z < 0 ? -sqrtf(z2) : sqrtf(z2)};
    } else {
        s->lobe ^= SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE;
        s->wi = sr_warp_cosine_hemisphere(u);
        if (wo.z < 0)
            s->wi.z = -s->wi.z;
    }
    s->f = f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0;
}

const struct sr_bsdf_model sr_bsdf_he = {
    .name = "he",
    .title = "He, Torrance, Sillion and Greenberg",
    .source = "X. D. He et al., A comprehensive physical model for light reflection, 1991",
    .limits = "For heights that change over more than a wavelength; returns up to 8 percent too much at grazing angles",
    .params = params,
    .size = sizeof(struct he),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = 1.09f,
};
