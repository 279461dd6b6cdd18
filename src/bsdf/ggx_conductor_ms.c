/* SPDX-License-Identifier: MIT */
/* A rough metal that keeps the light which bounces between its facets: Trowbridge and Reitz's, with compensation.
 *
 *     f    = F(|wo.m|) D(m) G(wo, wi) / (4 |zo| |zi|) + Fms (1 - E(zo)) (1 - E(zi)) / (pi (1 - E_avg))     [1/sr]
 *     Fms  = F_avg^2 E_avg / (1 - F_avg (1 - E_avg)),    F_avg = 2 INTEGRAL_0^1 F(c) c dc                  [1]
 *     E(z) = the share that the first term returns where F = 1,    E_avg = 2 INTEGRAL_0^1 E(z) z dz        [1]
 *
 * Reciprocal; with F = 1 it returns all light (to 3e-4, the error of the table). What bounces is taken to leave without
 * remembering its direction, after F_avg at each bounce: colours deepen with roughness as measured metals' do.
 * E is a table of ours, see ggx_energy.h. One alpha for all azimuths: two would need a table of two dimensions more.
 * C. Kulla & A. Conty, Revisiting physically based shading at Imageworks, 2017; the square of F_avg counts the first
 * bounce once. */
#include "bsdf/ggx_energy.h"
#include "bsdf/microfacet.h"

struct ggx_conductor_ms {
    sr_spectrum eta, k; // [1]
    float alpha;
    // of ready
    sr_spectrum again; // [1] Fms / (pi (1 - E_avg)), without what dies as 1 - E does
    float again_mean;  // [1] of Fms
    int32_t row;       // of the table
    float between;     // [1] share of the next row
    bool is_smooth;
};

static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED, "eta", "1", 0.02, 8, 0.2, offsetof(struct ggx_conductor_ms, eta), "index of refraction"},
    {SR_PARAM_UNBOUNDED, "k", "1", 0, 10, 3.9, offsetof(struct ggx_conductor_ms, k), "absorption index"},
    {SR_PARAM_FLOAT, "alpha", "1", 0, 1, 0.3, offsetof(struct ggx_conductor_ms, alpha), "slope width"},
    {0},
};

/* 1 - E(z) of the first term; the table holds E in millionths, and differences of whole numbers lose no digits */
static float lost(const struct ggx_conductor_ms *m, float z)
{
    z = sr_min(fabsf(z), 1);
    float where = z * (1 + m->alpha) / (z + m->alpha) * (ENERGY_COLUMNS - 1);
    int i = where < ENERGY_COLUMNS - 2 ? (int)where : ENERGY_COLUMNS - 2;
    float t = where - (float)i;
    const int32_t *lower = &ggx_energy[m->row][i], *upper = &ggx_energy[m->row + 1][i];
    float a = sr_lerp(t, (float)(1000000 - lower[0]), (float)(1000000 - lower[1])),
          b = sr_lerp(t, (float)(1000000 - upper[0]), (float)(1000000 - upper[1]));
    return larger(1e-6f * sr_lerp(m->between, a, b), 0);
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    static const float x[12] = {0.00921968288f, 0.0479413718f, 0.115048663f, 0.206341023f, 0.316084251f, 0.437383296f,
                                0.562616704f,   0.683915749f,  0.793658977f, 0.884951337f, 0.952058628f, 0.990780317f};
    static const float w[6] = {0.0235876682f, 0.0534696630f, 0.0800391643f, 0.101583713f, 0.116746268f, 0.124573523f};
    struct ggx_conductor_ms *m = self;
    (void)at;
    m->is_smooth = m->alpha < GGX_SMOOTH;
    if (m->is_smooth)
        return;
    m->alpha = sr_min(m->alpha, 1);
    float where = sqrtf(m->alpha) * (ENERGY_ROWS - 1);
    m->row = where < ENERGY_ROWS - 2 ? (int32_t)where : ENERGY_ROWS - 2;
    m->between = where - (float)m->row;
    sr_spectrum F = SR_BLACK;
    for (int i = 0; i < 12; ++i) // Gauss and Legendre's rule
        F += conductor_fresnel(x[i], m->eta, m->k) * (2 * w[i < 6 ? i : 11 - i] * x[i]);
    F = sr_spectrum_clamp(F, 0, 1);
    // 1 - E_avg, by z = alpha (e^(v L) - 1), as 1 - E falls like alpha^2 / z^2 beyond alpha
    float L = log1pf(1 / m->alpha), rest = 0;
    for (int i = 0; i < 12; ++i) {
        float z = m->alpha * expm1f(x[i] * L);
        rest += 2 * w[i < 6 ? i : 11 - i] * L * (z + m->alpha) * z * lost(m, z);
    }
    sr_spectrum share = F * F * (1 - rest) / (1 - F * rest);
    m->again = share / (SR_PI * larger(rest, 1e-9f));
    m->again_mean = sr_spectrum_mean(share);
    if (rest < 1e-4f) { // next to nothing bounces, less than the table knows
        m->again = SR_BLACK;
        m->again_mean = 0;
    }
}

static uint32_t lobes(const void *self)
{
    const struct ggx_conductor_ms *m = self;
    return SR_LOBE_REFLECTION | (m->is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE);
}

static float single_share(const struct ggx_conductor_ms *m, float lost_o)
{
    return (1 - lost_o) / (1 - lost_o + lost_o * m->again_mean);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct ggx_conductor_ms *m = self;
    (void)mode;
    *p = 0;
    if (m->is_smooth || !(wo.z * wi.z > 0))
        return SR_BLACK;
    struct sr_ggx ggx = {m->alpha, m->alpha};
    float cos_m, pdf_m, shape = ggx_reflection(ggx, wo, wi, &pdf_m, &cos_m);
    float lost_o = lost(m, wo.z), share = single_share(m, lost_o);
    *p = share * pdf_m + (1 - share) * fabsf(wi.z) * (1 / SR_PI);
    sr_spectrum sum = m->again * (lost_o * lost(m, wi.z));
    return shape > 0 ? sum + conductor_fresnel(cos_m, m->eta, m->k) * shape : sum;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_ggx_conductor_ms.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_ggx_conductor_ms.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct ggx_conductor_ms *m = self;
    if (wo.z == 0)
        return false;
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION};
    if (m->is_smooth) {
        s->lobe |= SR_LOBE_SPECULAR;
        s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
        s->pdf = 1;
        s->f = conductor_fresnel(fabsf(wo.z), m->eta, m->k) / fabsf(wo.z);
        return true;
    }
    if (u_lobe < single_share(m, lost(m, wo.z))) {
        float weight, cos_m;
        s->lobe |= SR_LOBE_GLOSSY;
        if (!ggx_sample_reflection((struct sr_ggx){m->alpha, m->alpha}, wo, u, &s->wi, &weight, &s->pdf, &cos_m))
            return false;
    } else {
        s->lobe |= SR_LOBE_DIFFUSE;
        s->wi = sr_warp_cosine_hemisphere(u);
        if (wo.z < 0)
            s->wi.z = -s->wi.z;
    }
    s->f = f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0 && s->pdf < INFINITY;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct ggx_conductor_ms *m = self;
    return m->is_smooth ? conductor_fresnel(fabsf(wo.z), m->eta, m->k) : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_ggx_conductor_ms = {
    .name = "ggx_conductor_ms",
    .title = "Rough metal with all its bounces",
    .source = "C. Kulla & A. Conty, Revisiting physically based shading at Imageworks, 2017",
    .limits = "What bounces twice forgets its direction; one roughness for all azimuths",
    .params = params,
    .size = sizeof(struct ggx_conductor_ms),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
    .largest_albedo = 1.001f,
};
