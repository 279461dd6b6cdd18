/* SPDX-License-Identifier: MIT */
/* Private to this room: what Ward's model and its two descendants share; they differ in how they share out the cosines.
 *
 * With the unnormalised H = wo + wi and e = exp(-((H.x / ax)^2 + (H.y / ay)^2) / H.z^2), facets are drawn so that
 *
 *     pdf = e / (4 pi ax ay |wo.h| h.z^3)    [1/sr],    h = H / |H|, |wo.h| = |H| / 2
 *
 * B. Walter, Notes on the Ward BRDF, 2005 (the density). */
#ifndef SR_BSDF_WARD_H
#define SR_BSDF_WARD_H

#include "bsdf/facets.h"

struct ward {
    sr_spectrum reflectance, specular; // [1]
    float alpha_x, alpha_y;
    // of ready
    float share; // [1] how often the lobe is drawn
};

// rows of a table: one line each, or two
// clang-format off
#define WARD_PARAMS \
    { \
        {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.2, offsetof(struct ward, reflectance), \
         "share of the light that the matte part reflects"}, \
        {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.3, offsetof(struct ward, specular), "strength of the lobe"}, \
        {SR_PARAM_FLOAT, "alpha_x", "1", 0.001, 0.5, 0.15, offsetof(struct ward, alpha_x), \
         "slope width along the tangent: sqrt(2) times the root mean square slope"}, \
        {SR_PARAM_FLOAT, "alpha_y", "1", 0.001, 0.5, 0.15, offsetof(struct ward, alpha_y), "slope width across it"}, \
        {0} \
    }
// clang-format on

__attribute__((unused)) static void ward_ready(void *self, const struct sr_bsdf_at *at)
{
    struct ward *m = self;
    (void)at;
    m->alpha_x = larger(m->alpha_x, GGX_MIN_ALPHA);
    m->alpha_y = larger(m->alpha_y, GGX_MIN_ALPHA);
    float lobe = sr_spectrum_mean(m->specular), matte = sr_spectrum_mean(m->reflectance);
    m->share = lobe > 0 ? larger(lobe / (lobe + matte), 0.1f) : 0;
    if (!(matte > 0))
        m->share = 1;
}

__attribute__((unused)) static uint32_t ward_lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE;
}

/* The density of all that is drawn; *shape is e / (4 pi ax ay) where the lobe is seen, else 0. */
static inline float ward_pdf(const struct ward *m, sr_vec3 wo, sr_vec3 wi, float *shape, sr_vec3 *H)
{
    *shape = 0;
    if (!(wo.z * wi.z > 0))
        return 0;
    float matte = (1 - m->share) * fabsf(wi.z) * (1 / SR_PI);
    *H = sr_add(wo, wi);
    float length2 = sr_length2(*H), z2 = H->z * H->z, e = sr_sqr(H->x / m->alpha_x) + sr_sqr(H->y / m->alpha_y);
    if (!(length2 > 1e-20f) || !(e < 80 * z2))
        return matte;
    float level = expf(-e / z2) / (4 * SR_PI * m->alpha_x * m->alpha_y);
    float pdf = level * 2 * length2 / (fabsf(H->z) * z2); // 1 / (|wo.h| h.z^3) = (2 / |H|) (|H| / H.z)^3
    if (!(pdf < INFINITY))
        return matte;
    *shape = level;
    return m->share * pdf + matte;
}

/* Draws a direction; the rest of the sample is for f_pdf to fill in. */
static inline bool ward_sample(const struct ward *m, sr_vec3 wo, float u_lobe, sr_vec2 u, struct sr_bsdf_sample *s)
{
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION};
    if (u_lobe < m->share) {
        struct facets a = facets_of(SLOPES_BECKMANN, MASKING_SMITH, m->alpha_x, m->alpha_y);
        s->lobe |= SR_LOBE_GLOSSY;
        sr_vec3 h = facets_sample_projected(&a, u);
        s->wi = sr_reflect(wo, h); // the same for h and -h
        return wo.z * s->wi.z > 0 && wo.z * sr_dot(wo, h) > 0;
    }
    s->lobe |= SR_LOBE_DIFFUSE;
    s->wi = sr_warp_cosine_hemisphere(u);
    if (wo.z < 0)
        s->wi.z = -s->wi.z;
    return true;
}

/* f, pdf and sample of a model whose lobe is specular times factor(H, wo, wi) times e / (4 pi ax ay). */
#define WARD_FUNCTIONS(model, factor)                                                                                  \
    __attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi,                       \
                                                       enum sr_transport mode, float *p)                               \
    {                                                                                                                  \
        const struct ward *m = self;                                                                                   \
        (void)mode;                                                                                                    \
        float shape;                                                                                                   \
        sr_vec3 H;                                                                                                     \
        *p = ward_pdf(m, wo, wi, &shape, &H);                                                                          \
        if (!(*p > 0))                                                                                                 \
            return SR_BLACK;                                                                                           \
        sr_spectrum sum = m->reflectance * (1 / SR_PI);                                                                \
        return shape > 0 ? sum + m->specular * (shape * factor(H, wo, wi)) : sum;                                      \
    }                                                                                                                  \
    static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)                             \
    {                                                                                                                  \
        float unused;                                                                                                  \
        return model.f_pdf(self, wo, wi, mode, &unused); /* the same machine code: the same bits */                    \
    }                                                                                                                  \
    static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)                                 \
    {                                                                                                                  \
        float p;                                                                                                       \
        model.f_pdf(self, wo, wi, mode, &p);                                                                           \
        return p;                                                                                                      \
    }                                                                                                                  \
    static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,                  \
                       struct sr_bsdf_sample *s)                                                                       \
    {                                                                                                                  \
        if (!ward_sample(self, wo, u_lobe, u, s))                                                                      \
            return false;                                                                                              \
        s->f = f_pdf(self, wo, s->wi, mode, &s->pdf);                                                                  \
        return s->pdf > 0;                                                                                             \
    }

#endif
