/* SPDX-License-Identifier: MIT */
/* A hair: a rough dielectric cylinder along x that absorbs inside, struck at the offset h from its axis.
 *
 *     f |cos_theta_i| = SUM_{p=0}^{3} M_p(theta_o, theta_i) A_p(theta_o) N_p(phi)       [1/sr]
 *     sin theta = w.x,   phi = atan2(w.z, w.y) of wi less that of wo;   p: R, TT, TRT, all that stays longer
 *     M = exp((ci co - si so - 1) / v) I0e(ci co / v) / (v (1 - exp(-2 / v))),   I0e(x) = exp(-x) I_0(x)
 *         v_0 = (0.726 b + 0.812 b^2 + 3.7 b^20)^2, b = beta_m;   v_1 = v_0 / 4, v_2 = v_3 = 4 v_0;
 *         wo is tilted by the scales before: by -2 alpha (R), alpha (TT), 4 alpha (TRT)
 *     N = logistic of width s = sqrt(pi / 8) (0.265 b + 1.194 b^2 + 5.372 b^22), b = beta_n, about
 *         2 p gamma_t - 2 gamma_o + p pi, cut to one turn;   N_3 = 1 / (2 pi)
 *     A_0 = F, A_1 = (1 - F)^2 T, A_2 = A_1 T F, A_3 = A_2 T F / (1 - T F)
 *     F = F(cos theta_o cos gamma_o),  T = exp(-2 sigma_a cos gamma_t / cos theta_t),  sin gamma_o = h,
 *     sin theta_t = sin theta_o / eta,  sin gamma_t = h cos theta_o / sqrt(eta^2 - sin^2 theta_o)
 *
 * M. J. Chiang, B. Bitterli, C. Tappan & B. Burley, A Practical and Controllable Hair and Fur Model for Production Path
 * Tracing, 2016, after Marschner et al. 2003 and d'Eon et al. 2011; four lobes as pbrt-v4 has them. M is written so
 * that it neither overflows nor needs a second form for small v; it and N integrate to 1, so that a hair that absorbs
 * nothing returns all light, from every direction.
 *
 * Light leaves on the whole sphere; z is the normal of the ribbon on which the hair is drawn, and only divides f.
 * Limits: not reciprocal (F and T know theta_o alone, scales tilt one side only, and f bears the ribbon's cosine); far
 * field: light leaves where it entered. From a colour c, sigma_a = (ln c / q)^2, q a fit over beta_n, for a head of
 * hair of it. From what hair is dyed with by nature, sigma_a = eumelanin s_e + pheomelanin s_p per radius: s_e = (.419,
 * .697, 1.37), s_p = (.187, .4, 1.05) for red, green, blue (d'Eon et al. 2011), taken at 610, 545 and 465 nm, and exp
 * of a parabola in lambda through these. */
#include "bsdf/microfacet.h"

#define LOBES SR_HAIR_LOBES

_Static_assert(sizeof(struct sr_bsdf_hair) <= SR_BSDF_SIZE, "too large for a BSDF at a point");

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "sigma_a", "1/radius", 0, 20, 0.3, offsetof(struct sr_bsdf_hair, sigma_a),
     "absorption inside"},
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct sr_bsdf_hair, reflectance),
     "colour of a head of such hair, where it is to give sigma_a"},
    {SR_PARAM_ENUM, "colour_from", "1", 0, 2, SR_HAIR_FROM_SIGMA_A, offsetof(struct sr_bsdf_hair, colour_from),
     "sigma_a|reflectance|melanin"},
    {SR_PARAM_FLOAT, "eumelanin", "1", 0, 8, 1.3, offsetof(struct sr_bsdf_hair, eumelanin),
     "concentration of what makes hair brown and black: 0.3 blond, 1.3 brown, 8 black"},
    {SR_PARAM_FLOAT, "pheomelanin", "1", 0, 8, 0, offsetof(struct sr_bsdf_hair, pheomelanin),
     "concentration of what makes hair yellow and red"},
    {SR_PARAM_FLOAT, "h", "1", -1, 1, 0, offsetof(struct sr_bsdf_hair, h), "offset from the axis, in radii"},
    {SR_PARAM_FLOAT, "eta", "1", 1.1, 2, 1.55, offsetof(struct sr_bsdf_hair, eta), "index of refraction"},
    {SR_PARAM_FLOAT, "beta_m", "1", 0.1, 1, 0.3, offsetof(struct sr_bsdf_hair, beta_m), "roughness along the hair"},
    {SR_PARAM_FLOAT, "beta_n", "1", 0.1, 1, 0.3, offsetof(struct sr_bsdf_hair, beta_n), "roughness around the hair"},
    {SR_PARAM_FLOAT, "scale_tilt", "deg", 0, 10, 2, offsetof(struct sr_bsdf_hair, alpha),
     "tilt of the scales towards the root"},
    {0},
};

static float power(float x, int n)
{
    float y = 1;
    for (; n > 0; n >>= 1, x *= x)
        if (n & 1)
            y *= x;
    return y;
}

static const float most_per_radius = 1e30f; // absorption [1]

/* Absorption per radius for concentrations of 1, between and beyond the three wavelengths at which it is known. */
static float melanin(float lambda, float red, float green, float blue)
{
    float r = lambda - 610, g = lambda - 545, b = lambda - 465; // [nm]
    return expf(logf(red) * g * b / (65 * 145) - logf(green) * r * b / (65 * 80) + logf(blue) * r * g / (145 * 80));
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct sr_bsdf_hair *m = self;
    float b = m->beta_m, n = m->beta_n;
    m->v[0] = sr_sqr(0.726f * b + 0.812f * b * b + 3.7f * power(b, 20));
    m->v[1] = 0.25f * m->v[0];
    m->v[2] = m->v[3] = 4 * m->v[0];
    m->s = sqrtf(SR_PI / 8) * (0.265f * n + 1.194f * n * n + 5.372f * power(n, 22));
    m->s_norm = tanhf(SR_PI / (2 * m->s));
    static const float turns[3] = {-2, 1, 4};
    for (int p = 0; p < 3; ++p) {
        m->sin_tilt[p] = sinf(turns[p] * sr_radians(m->alpha));
        m->cos_tilt[p] = cosf(turns[p] * sr_radians(m->alpha));
    }
    m->gamma_o = asinf(sr_clamp(m->h, -1, 1));
    m->sigma = m->sigma_a;
    if (m->colour_from == SR_HAIR_FROM_REFLECTANCE) {
        float n2 = n * n,
              q = 5.969f - 0.215f * n + 2.532f * n2 - 10.73f * n2 * n + 5.574f * n2 * n2 + 0.245f * n2 * n2 * n;
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            m->sigma[i] = sr_sqr(logf(sr_max(m->reflectance[i], 1e-30f)) / q);
    } else if (m->colour_from == SR_HAIR_FROM_MELANIN) {
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            m->sigma[i] = m->eumelanin * melanin(at->lambda[i], 0.419f, 0.697f, 1.37f) +
                          m->pheomelanin * melanin(at->lambda[i], 0.187f, 0.4f, 1.05f);
    }
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        m->sigma[i] = sr_min(m->sigma[i], most_per_radius); // an edge has no width, and 0 of something infinite is none
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION | SR_LOBE_GLOSSY;
}

/* exp(-x) I_0(x), x >= 0: the series, or where it is long Hankel's (Abramowitz & Stegun 9.6.12, 9.7.1); error < 1e-6.
 */
static float bessel_scaled(float x)
{
    if (x < 12) {
        float term = 1, sum = 1, q = 0.25f * x * x;
        for (int k = 1; k < 40 && term > 1e-9f * sum; ++k) {
            term *= q / (float)(k * k);
            sum += term;
        }
        return sum * expf(-x);
    }
    float y = 0.125f / x;
    return (1 + y * (1 + y * (4.5f + y * (37.5f + y * (459.375f + y * 7441.875f))))) / sqrtf(2 * SR_PI * x);
}
static float longitudinal(float v, float ci, float co, float si, float so)
{
    return expf((ci * co - si * so - 1) / v) * bessel_scaled(ci * co / v) / (v * (1 - expf(-2 / v)));
}
static float azimuthal(const struct sr_bsdf_hair *m, float phi)
{
    phi -= 2 * SR_PI * floorf(phi / (2 * SR_PI) + 0.5f); // -pi ... pi
    float e = expf(-fabsf(phi) / m->s);
    return e / (m->s * sr_sqr(1 + e) * m->s_norm);
}

/* All that follows from wo. */
struct view {
    float sine[LOBES], cosine[LOBES]; // of theta_o after the scales' tilt
    float phi, centre[3];             // [rad]
    sr_spectrum A[LOBES];             // [1]
    float share[LOBES];               // [1] for choosing
};
static struct view view_of(const struct sr_bsdf_hair *m, sr_vec3 wo)
{
    struct view w;
    float so = wo.x, co = sqrtf(wo.y * wo.y + wo.z * wo.z);
    for (int p = 0; p < 3; ++p) {
        w.sine[p] = so * m->cos_tilt[p] + co * m->sin_tilt[p];
        w.cosine[p] = fabsf(co * m->cos_tilt[p] - so * m->sin_tilt[p]);
    }
    w.sine[3] = so;
    w.cosine[3] = co;
    w.phi = atan2f(wo.z, wo.y);

    float sin_t = so / m->eta, cos_t = sr_safe_sqrt((1 - sin_t) * (1 + sin_t));
    float sin_gamma = sr_clamp(m->h * co / sqrtf(m->eta * m->eta - so * so), -1, 1);
    float cos_gamma = sr_safe_sqrt((1 - sin_gamma) * (1 + sin_gamma)), gamma_t = asinf(sin_gamma);
    for (int p = 0; p < 3; ++p)
        w.centre[p] = 2 * (float)p * gamma_t - 2 * m->gamma_o + (float)p * SR_PI;
    sr_spectrum T;
    float way = 2 * cos_gamma / cos_t;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        T[i] = expf(-m->sigma[i] * way);
    float unused, F = fresnel_and_cos(co * sr_safe_sqrt((1 - m->h) * (1 + m->h)), m->eta, &unused);
    F = sr_min(F, 0.9999f); // at the hair's edge: something must enter, lest 0 / 0
    w.A[0] = SR_BLACK + F;
    w.A[1] = sr_sqr(1 - F) * T;
    w.A[2] = w.A[1] * T * F;
    w.A[3] = w.A[2] * T * F / (1 - T * F);
    float sum = 0;
    for (int p = 0; p < LOBES; ++p)
        sum += w.share[p] = sr_spectrum_mean(w.A[p]);
    for (int p = 0; p < LOBES; ++p)
        w.share[p] = (1 - 0.01f * LOBES) * w.share[p] / sum + 0.01f; // none so seldom that its light comes as sparks
    return w;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *pdf)
{
    const struct sr_bsdf_hair *m = self;
    (void)mode;
    struct view w = view_of(m, wo);
    float si = wi.x, ci = sqrtf(wi.y * wi.y + wi.z * wi.z), phi = atan2f(wi.z, wi.y) - w.phi;
    sr_spectrum sum = SR_BLACK;
    *pdf = 0;
    for (int p = 0; p < LOBES; ++p) {
        float shape = longitudinal(m->v[p], ci, w.cosine[p], si, w.sine[p]) *
                      (p < 3 ? azimuthal(m, phi - w.centre[p]) : SR_INV_PI / 2);
        sum += w.A[p] * shape;
        *pdf += w.share[p] * shape;
    }
    if (!(fabsf(wi.z) > 0))
        return SR_BLACK;
    return sum / fabsf(wi.z);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_hair.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_hair.f_pdf(self, wo, wi, mode, &p);
    return p;
}

/* One number chooses the lobe, and what is left of it the turn about wo. */
static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct sr_bsdf_hair *m = self;
    struct view w = view_of(m, wo);
    int p = 0;
    while (p < LOBES - 1 && u_lobe >= w.share[p])
        u_lobe -= w.share[p++];
    float rest = sr_min(sr_max(u_lobe / w.share[p], 0), 1);
    float c = sr_max(1 + m->v[p] * logf(u.x + (1 - u.x) * expf(-2 / m->v[p])), -1), sine, cosine;
    sin_cos_turn(rest, &sine, &cosine);
    float si = sr_clamp(-c * w.sine[p] + sr_safe_sqrt((1 - c) * (1 + c)) * cosine * w.cosine[p], -1, 1);
    float ci = sr_safe_sqrt((1 - si) * (1 + si)), phi;
    if (p < 3) { // where the logistic's share below phi is u
        float x = sr_clamp(0.5f + (u.y - 0.5f) * m->s_norm, 1e-9f, 1 - 1e-7f);
        phi = w.centre[p] - m->s * logf(1 / x - 1);
    } else
        phi = 2 * SR_PI * u.y;
    phi += w.phi;
    *s = (struct sr_bsdf_sample){.eta = 1, .wi = sr_normalize((sr_vec3){si, ci * cosf(phi), ci * sinf(phi)})};
    s->lobe = SR_LOBE_GLOSSY | (sr_same_hemisphere(wo, s->wi) ? SR_LOBE_REFLECTION : SR_LOBE_TRANSMISSION);
    s->f = sr_bsdf_hair.f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0 && s->pdf < INFINITY && s->wi.z != 0;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    struct view w = view_of(self, wo);
    return w.A[0] + w.A[1] + w.A[2] + w.A[3];
}

const struct sr_bsdf_model sr_bsdf_hair = {
    .name = "hair",
    .title = "Hair (Chiang 2016)",
    .source = "M. J. Chiang, B. Bitterli, C. Tappan & B. Burley, A Practical and Controllable Hair and Fur Model, 2016",
    .limits = "a fibre along x seen from far away: light leaves where it entered; not reciprocal",
    .params = params,
    .size = sizeof(struct sr_bsdf_hair),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
    .asymmetry = 1,
};
