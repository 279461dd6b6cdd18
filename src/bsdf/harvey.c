/* SPDX-License-Identifier: MIT */
/* Polished optics as Harvey and Shack found them: stray light with a shoulder, about what is mirrored.
 *
 *     f = b0 (1 + r^2 / l^2)^(s / 2)       [1/sr],    r = |(wo + wi)_xy|, zero toward the mirror direction      [1]
 *
 * and a mirror's share, specular, beside it. Reciprocal, and invariant under shifts in the plane of direction cosines.
 * Most is scattered at normal incidence, the total integrated scatter
 *
 *     TIS = (2 pi b0 l^2 / (s + 2)) ((1 + 1 / l^2)^((s + 2) / 2) - 1),   s = -2: pi b0 l^2 ln(1 + 1 / l^2)       [1]
 *
 * Where that and specular are more than 1, b0 is lowered until they are not. Drawn exactly (harvey.h).
 * J. E. Harvey, Light-scattering characteristics of optical surfaces, 1976. */
#include "bsdf/harvey.h"

struct harvey_shack {
    sr_spectrum b0, specular; // [1/sr], [1]
    float l, s;               // [1]
    // of ready
    struct harvey harvey;
    float mirrors; // [1] how often the mirror is drawn
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "b0", "1/sr", 0, 100, 0.1, offsetof(struct harvey_shack, b0), "height of the shoulder"},
    {SR_PARAM_FLOAT, "l", "1", 1e-3, 1, 0.01, offsetof(struct harvey_shack, l), "its width, as a sine"},
    {SR_PARAM_FLOAT, "s", "1", -4, 0, -1.5, offsetof(struct harvey_shack, s), "slope beyond"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0, offsetof(struct harvey_shack, specular),
     "share of the light that is mirrored"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct harvey_shack *m = self;
    (void)at;
    m->l = sr_max(m->l, 1e-4f);
    m->harvey = (struct harvey){m->l, -m->s};
    float l2 = m->l * m->l, scatter = SR_PI * l2 * harvey_power(log1pf(1 / l2), 1 + 0.5f * m->s); // TIS / b0
    sr_spectrum room = (1 - m->specular) / scatter;
    m->b0 = sr_spectrum_select(m->b0 < room, m->b0, room);
    float mirrored = sr_spectrum_mean(m->specular), scattered = scatter * sr_spectrum_mean(m->b0);
    m->mirrors = mirrored > 0 ? scattered > 0 ? sr_clamp(mirrored / (mirrored + scattered), 0.1f, 0.9f) : 1 : 0;
}

static uint32_t lobes(const void *self)
{
    const struct harvey_shack *m = self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | (m->mirrors > 0 ? SR_LOBE_SPECULAR : 0);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct harvey_shack *m = self;
    (void)mode;
    if (!sr_same_hemisphere(wo, wi))
        return SR_BLACK;
    return m->b0 * expf(0.5f * m->s * log1pf(harvey_r2(wo, wi) / sr_sqr(m->l)));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct harvey_shack *m = self;
    (void)mode;
    if (!sr_same_hemisphere(wo, wi))
        return 0;
    return (1 - m->mirrors) * fabsf(wi.z) * harvey_pdf(&m->harvey, harvey_r2(wo, wi), harvey_reach(wo));
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct harvey_shack *m = self;
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

const struct sr_bsdf_model sr_bsdf_harvey = {
    .name = "harvey",
    .title = "Harvey and Shack's stray light",
    .source = "J. E. Harvey, Light-scattering characteristics of optical surfaces, 1976",
    .limits = "For smooth, clean, polished surfaces; b0 is lowered where more than all light would return",
    .params = params,
    .size = sizeof(struct harvey_shack),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
};
