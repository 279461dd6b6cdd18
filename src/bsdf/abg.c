/* SPDX-License-Identifier: MIT */
/* Polish, dust and scratches on optics: the ABg law of stray-light programs, about what is mirrored.
 *
 *     f = A / (B + r^g)       [1/sr],    r = |(wo + wi)_xy|, zero toward the mirror direction      [1]
 *
 * and a mirror's share, specular, beside it. Reciprocal, and invariant under shifts in the plane of direction cosines.
 * Flat below r = B^(1/g), g the slope beyond; g = 0 is Lambert's A / (B + 1). Most is scattered at normal incidence,
 * the total integrated scatter TIS = 2 pi A INTEGRAL_0^1 r / (B + r^g) dr (g = 2: pi A ln(1 + 1 / B)); where that and
 * specular are more than 1, A is lowered until they are not. Drawn by the Harvey law with l = B^(1/g), which is nowhere
 * off by more than 2^|1 - g/2| (harvey.h). J. E. Harvey, Light-scattering characteristics of optical surfaces, 1976; R.
 * N. Pfisterer, Approximated scatter models for stray light analysis, 2011. */
#include "bsdf/harvey.h"

struct abg {
    sr_spectrum A, specular; // [1/sr], [1]
    float B, g;              // [1]
    // of ready
    struct harvey harvey;
    float mirrors; // [1] how often the mirror is drawn
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "A", "1/sr", 0, 1, 0.0025, offsetof(struct abg, A), "height, times B"},
    {SR_PARAM_FLOAT, "B", "1", 1e-6, 1, 0.001, offsetof(struct abg, B), "r^g where the flat part ends"},
    {SR_PARAM_FLOAT, "g", "1", 0, 3, 1.8, offsetof(struct abg, g), "slope beyond"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0, offsetof(struct abg, specular), "share of the light that is mirrored"},
    {0},
};

static float law(const struct abg *m, float r2) // f / A
{
    return 1 / (m->B + powf(r2, 0.5f * m->g));
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    static const float x[4] = {0.0694318442f, 0.330009478f, 0.669990522f, 0.930568156f};
    static const float w[4] = {0.173927423f, 0.326072577f, 0.326072577f, 0.173927423f};
    struct abg *m = self;
    (void)at;
    m->B = sr_max(m->B, 1e-6f);
    m->harvey = (struct harvey){m->g > 0.05f ? sr_clamp(powf(m->B, 1 / m->g), 1e-6f, 10) : 1, m->g > 0.05f ? m->g : 0};
    float scatter = 0; // TIS / A
    for (int i = 0; i < 4; ++i)
        for (int half = 0; half < 2; ++half) {
            float r = harvey_draw(&m->harvey, 0.5f * (x[i] + (float)half), 1), r2 = r * r;
            scatter += 0.5f * w[i] * law(m, r2) / harvey_pdf(&m->harvey, r2, 1);
        }
    sr_spectrum room = (1 - m->specular) / (1.001f * scatter); // the rule's error
    m->A = sr_spectrum_select(m->A < room, m->A, room);
    float mirrored = sr_spectrum_mean(m->specular), scattered = scatter * sr_spectrum_mean(m->A);
    m->mirrors = mirrored > 0 ? scattered > 0 ? sr_clamp(mirrored / (mirrored + scattered), 0.1f, 0.9f) : 1 : 0;
}

static uint32_t lobes(const void *self)
{
    const struct abg *m = self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | (m->mirrors > 0 ? SR_LOBE_SPECULAR : 0);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct abg *m = self;
    (void)mode;
    return sr_same_hemisphere(wo, wi) ? m->A * law(m, harvey_r2(wo, wi)) : SR_BLACK;
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct abg *m = self;
    (void)mode;
    if (!sr_same_hemisphere(wo, wi))
        return 0;
    return (1 - m->mirrors) * fabsf(wi.z) * harvey_pdf(&m->harvey, harvey_r2(wo, wi), harvey_reach(wo));
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct abg *m = self;
    if (wo.z == 0)
        return false;
    if (u_lobe < m->mirrors)
        return harvey_mirror(wo, m->specular, m->mirrors, s);
    sr_vec3 wi;
    if (!harvey_direction(&m->harvey, wo, u, &wi))
        return false;
    *s = (struct sr_bsdf_sample){.wi = wi, .eta = 1, .lobe = SR_LOBE_REFLECTION | SR_LOBE_GLOSSY};
    s->f = f(self, wo, wi, mode);
    s->pdf = pdf(self, wo, wi, mode);
    return s->pdf > 0 && s->pdf < INFINITY;
}

const struct sr_bsdf_model sr_bsdf_abg = {
    .name = "abg",
    .title = "ABg stray light",
    .source = "J. E. Harvey, Light-scattering characteristics of optical surfaces, 1976",
    .limits =
        "A fit to data at one angle, near the mirror direction; A is lowered where more than all light would return",
    .params = params,
    .size = sizeof(struct abg),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
};
