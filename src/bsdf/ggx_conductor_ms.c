/* SPDX-License-Identifier: MIT */
/* A rough metal that keeps the light which bounces between its facets: Trowbridge and Reitz's, with compensation.
 *
 *     f    = F(|wo.m|) D(m) G(wo, wi) / (4 |zo| |zi|) + Fms (1 - E(zo)) (1 - E(zi)) / (pi (1 - E_avg))     [1/sr]
 *     Fms  = F_avg^2 E_avg / (1 - F_avg (1 - E_avg)),    F_avg = 2 INTEGRAL_0^1 F(c) c dc                  [1]
 *     E(z) = the share that the first term returns where F = 1,    E_avg = 2 INTEGRAL_0^1 E(z) z dz        [1]
 *
 * Reciprocal; with F = 1 it returns all light (to 3e-4, the error of the table). What bounces is taken to leave without
 * remembering its direction, after F_avg at each bounce: colours deepen with roughness as measured metals' do.
 * E is tabulated once, when first asked for, by a quadrature over visible normals: 64 z by 64 alpha, both even in their
 * square roots. One alpha for all azimuths: two would need a table of two dimensions more.
 * C. Kulla & A. Conty, Revisiting physically based shading at Imageworks, 2017; the square of F_avg counts the first bounce
 * once. */
#include "bsdf/microfacet.h"

#include <pthread.h>

enum { NODES = 64, AZIMUTHS = 24, HEIGHTS = 48 };

static float table[NODES][NODES]; // E by sqrt(alpha), sqrt(z)
static float mean[NODES];         // E_avg by sqrt(alpha)
static pthread_once_t once = PTHREAD_ONCE_INIT;

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

/* E = mean of G2 / G1 over the visible normals: even in azimuth and in height above the far end of a cap of the sphere. */
static double albedo_by_quadrature(double z, double alpha, const double *x, const double *w)
{
    double v_length = sqrt(alpha * alpha * (1 - z * z) + z * z), sum = 0;
    double vx = alpha * sqrt(1 - z * z) / v_length, vz = z / v_length, area = z + v_length; // 2 s(wo)
    for (int i = 0; i < HEIGHTS; ++i) {
        double height = (1 - x[i]) * (1 + vz) - vz, r = sqrt(1 - height * height);
        for (int j = 0; j < AZIMUTHS; ++j) {
            double phi = (j + 0.5) * 3.14159265358979324 / AZIMUTHS;
            double mx = alpha * (r * cos(phi) + vx), my = alpha * r * sin(phi), mz = height + vz;
            double c = (mx * sqrt(1 - z * z) + mz * z) / (mx * mx + my * my + mz * mz); // |wo.m| / |m|
            double ix = 2 * c * mx - sqrt(1 - z * z), iy = 2 * c * my, iz = 2 * c * mz - z;
            if (iz > 0) // zi (zo + so) / (so zi + si zo)
                sum += w[i] * iz * area / (v_length * iz + sqrt(alpha * alpha * (ix * ix + iy * iy) + iz * iz) * z);
        }
    }
    return sum / AZIMUTHS;
}

static void make_table(void)
{
    double x[HEIGHTS], w[HEIGHTS], t[3], v[3];
    sr_gauss_legendre(HEIGHTS, 0, 1, x, w);
    for (int i = 0; i < NODES; ++i) {
        double alpha = (double)i * i / ((NODES - 1) * (NODES - 1)), sum = 0;
        for (int j = 0; j < NODES; ++j) {
            double z = (double)j * j / ((NODES - 1) * (NODES - 1));
            table[i][j] = i > 0 ? (float)albedo_by_quadrature(z > 1e-6 ? z : 1e-6, alpha, x, w) : 1;
        }
        for (int j = 0; j + 1 < NODES; ++j) { // 2 E z dz = 4 E t^3 dt, exact for what interpolation gives
            sr_gauss_legendre(3, 0, 1, t, v);
            for (int k = 0; k < 3; ++k) {
                double root = (j + t[k]) / (NODES - 1);
                sum += v[k] * 4 * root * root * root / (NODES - 1) *
                       ((double)table[i][j] + t[k] * (double)(table[i][j + 1] - table[i][j]));
            }
        }
        mean[i] = (float)sum;
    }
}

static sr_status load(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)self;
    (void)arena;
    (void)error;
    pthread_once(&once, make_table);
    return SR_OK;
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    static const float x[6] = {0.0337652429f, 0.1693953068f, 0.3806904070f, 0.6193095930f, 0.8306046932f, 0.9662347571f};
    static const float w[6] = {0.0856622462f, 0.1803807865f, 0.2339569673f, 0.2339569673f, 0.1803807865f, 0.0856622462f};
    struct ggx_conductor_ms *m = self;
    (void)at;
    m->is_smooth = m->alpha < GGX_SMOOTH;
    if (m->is_smooth)
        return;
    float where = sqrtf(sr_min(m->alpha, 1)) * (NODES - 1);
    m->row = where < NODES - 2 ? (int32_t)where : NODES - 2;
    m->between = where - (float)m->row;
    sr_spectrum F = SR_BLACK;
    for (int i = 0; i < 6; ++i)
        F += conductor_fresnel(x[i], m->eta, m->k) * (2 * w[i] * x[i]);
    F = sr_spectrum_clamp(F, 0, 1);
    float E = sr_lerp(m->between, mean[m->row], mean[m->row + 1]);
    sr_spectrum share = F * F * E / (1 - F * (1 - E));
    m->again = share / (SR_PI * larger(1 - E, 1e-6f));
    m->again_mean = sr_spectrum_mean(share);
}

static uint32_t lobes(const void *self)
{
    const struct ggx_conductor_ms *m = self;
    return SR_LOBE_REFLECTION | (m->is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE);
}

/* 1 - E(z) of the first term */
static float lost(const struct ggx_conductor_ms *m, float z)
{
    float where = sqrtf(sr_min(fabsf(z), 1)) * (NODES - 1);
    int i = where < NODES - 2 ? (int)where : NODES - 2;
    float t = where - (float)i;
    float a = sr_lerp(t, table[m->row][i], table[m->row][i + 1]);
    float b = sr_lerp(t, table[m->row + 1][i], table[m->row + 1][i + 1]);
    return 1 - sr_lerp(m->between, a, b);
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
    .load = load,
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
    .largest_albedo = 1.001f,
};
