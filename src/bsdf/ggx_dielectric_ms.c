/* SPDX-License-Identifier: MIT */
/* Ground glass that keeps the light which bounces between its facets: Trowbridge and Reitz's, with compensation.
 *
 *     f  = f1 + f2                                                        [1/sr], in the form for importance
 *     f1 = one event at a facet: F D G / (4 |zo| |zi|), or what is refracted (microfacet_dielectric.c, masking beta)
 *     f2 = L_a(zo) L_b(zi) / (pi l_b) (1 - t_a where wo and wi are on the same side, t_a where not)
 *     L_a(z) = 1 - E_a(z), what f1 loses of the light on the side a;    l_a = 2 INTEGRAL_0^1 L_a(z) z dz    [1]
 *
 * Light that f1 loses leaves without remembering its direction: a share t_a on the other side, the rest on its own.
 * Nothing is lost then, and f is reciprocal, f(a, b) / n_b^2 = f(b, a) / n_a^2, if n_a^2 l_a t_a is the same for both
 * sides: the flux that crosses under even light. How much that is the theory does not tell; it is taken as on the
 * smooth boundary, of the smaller of both losses: t_a = (1 - F) min(l_a, l_b) / l_a from outside, F Fresnel's mean over
 * diffuse light. The inside is the denser side. E is a table of ours in the index, alpha and z, cubic between its
 * nodes: ggx_glass_energy.h. After C. Kulla & A. Conty, Revisiting physically based shading at Imageworks, 2017; single
 * events: Walter et al. 2007. */
#include "bsdf/facets_interface.h"
#include "bsdf/ggx_glass_energy.h"

struct ggx_dielectric_ms {
    float eta, alpha; // [1] inside over outside; slope width
    // of ready; [0]: of the outside, [1]: of the inside
    float lost[2][GLASS_COLUMNS]; // [1] L at the table's z
    float mean[2];                // [1] l
    float crosses[2];             // [1] t
};

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "eta", "1", 1.1, 3, 1.5, offsetof(struct ggx_dielectric_ms, eta),
     "index of refraction: inside over outside"},
    {SR_PARAM_FLOAT, "alpha", "1", 0, 1, 0.3, offsetof(struct ggx_dielectric_ms, alpha), "slope width"},
    {0},
};

static struct rough_interface boundary(const struct ggx_dielectric_ms *m)
{
    return rough_interface_of(m->eta, SLOPES_GGX, PASSING_BETA, m->alpha, m->alpha);
}

/* Lagrange's weights of the four nodes about x, of n; the first of them. */
static int cubic(float x, int n, float w[4])
{
    int i = x > 1 ? (int)x - 1 : 0;
    i = i < n - 4 ? i : n - 4;
    float t = x - (float)i;
    w[0] = (t - 1) * (t - 2) * (t - 3) * (-1.0f / 6);
    w[1] = t * (t - 2) * (t - 3) * 0.5f;
    w[2] = t * (t - 1) * (t - 3) * -0.5f;
    w[3] = t * (t - 1) * (t - 2) * (1.0f / 6);
    return i;
}

static float lost(const struct ggx_dielectric_ms *m, float z, int side)
{
    z = sr_min(fabsf(z), 1);
    float w[4], where = powf(z * (1 + m->alpha) / (z + m->alpha), 2.0f / 3) * (GLASS_COLUMNS - 1);
    const float *L = &m->lost[side][cubic(where, GLASS_COLUMNS, w)];
    return sr_clamp(w[0] * L[0] + w[1] * L[1] + w[2] * L[2] + w[3] * L[3], 0, 1);
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    static const float x[12] = {0.00921968288f, 0.0479413718f, 0.115048663f, 0.206341023f, 0.316084251f, 0.437383296f,
                                0.562616704f,   0.683915749f,  0.793658977f, 0.884951337f, 0.952058628f, 0.990780317f};
    static const float w[6] = {0.0235876682f, 0.0534696630f, 0.0800391643f, 0.101583713f, 0.116746268f, 0.124573523f};
    struct ggx_dielectric_ms *m = self;
    (void)at;
    if (boundary(m).is_smooth)
        return;
    m->alpha = sr_min(m->alpha, 1);
    m->eta = sr_clamp(m->eta, 1.1f, 3);
    float n = m->eta, u[4], v[4];
    int k = cubic(sr_clamp(logf(n / 1.1f) * 0.996711506f, 0, 1) * (GLASS_INDICES - 1), GLASS_INDICES,
                  u); // over ln(3 / 1.1)
    int i = cubic(sqrtf(m->alpha) * (GLASS_ROWS - 1), GLASS_ROWS, v);
    for (int side = 0; side < 2; ++side)
        for (int j = 0; j < GLASS_COLUMNS; ++j) {
            float sum = 0;
            for (int a = 0; a < 4; ++a)
                for (int b = 0; b < 4; ++b)
                    sum += u[a] * v[b] * (float)(100000 - glass_energy[side][k + a][i + b][j]);
            m->lost[side][j] = 1e-5f * sum;
        }
    float log_z = log1pf(1 / m->alpha);
    for (int side = 0; side < 2; ++side) { // by z = alpha (e^(v L) - 1), as L falls like alpha^2 / z^2 beyond alpha
        float sum = 0;
        for (int p = 0; p < 12; ++p) {
            float z = m->alpha * expm1f(x[p] * log_z);
            sum += 2 * w[p < 6 ? p : 11 - p] * log_z * (z + m->alpha) * z * lost(m, z, side);
        }
        m->mean[side] = larger(sum, 1e-9f);
    }
    float passes = 1 - (float)sr_fresnel_diffuse((double)n); // of diffuse light from outside
    float least = sr_min(m->mean[0], m->mean[1]);
    m->crosses[0] = passes * least / m->mean[0];
    m->crosses[1] = passes * least / (n * n * m->mean[1]);
}

static uint32_t lobes(const void *self)
{
    return SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION |
           (boundary(self).is_smooth ? SR_LOBE_SPECULAR : SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct ggx_dielectric_ms *m = self;
    struct rough_interface a = boundary(m);
    *p = 0;
    if (a.is_smooth || wo.z == 0 || wi.z == 0)
        return SR_BLACK;
    bool transmits = wo.z * wi.z < 0;
    int from = wo.z < 0, to = wi.z < 0;
    float single_pdf, value = rough_interface_f_pdf(&a, wo, wi, &single_pdf), L = lost(m, wo.z, from);
    float share = L * (transmits ? m->crosses[from] : 1 - m->crosses[from]) * SR_INV_PI;
    *p = (1 - L) * single_pdf + share * fabsf(wi.z);
    value += share * lost(m, wi.z, to) / m->mean[to];
    if (mode == SR_RADIANCE && transmits)
        value *= sr_sqr(wo.z > 0 ? 1 / m->eta : m->eta);
    if (!(*p > 0 && *p < INFINITY)) {
        *p = 0;
        return SR_BLACK;
    }
    return SR_BLACK + value;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_ggx_dielectric_ms.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_ggx_dielectric_ms.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct ggx_dielectric_ms *m = self;
    struct rough_interface a = boundary(m);
    struct interface_sample i;
    int from = wo.z < 0;
    if (wo.z == 0)
        return false;
    float L = a.is_smooth ? 0 : lost(m, wo.z, from);
    if (u_lobe >= L) {
        if (!rough_interface_sample(&a, wo, sr_min((u_lobe - L) / (1 - L), SR_ONE_MINUS_EPSILON), u, &i))
            return false;
        *s = rough_interface_told(&a, &i, mode);
        if (a.is_smooth)
            return true;
    } else {
        bool transmits = u_lobe < L * m->crosses[from];
        *s = (struct sr_bsdf_sample){.wi = sr_warp_cosine_hemisphere(u), .eta = 1};
        s->lobe = SR_LOBE_DIFFUSE | (transmits ? SR_LOBE_TRANSMISSION : SR_LOBE_REFLECTION);
        if (transmits)
            s->eta = from ? 1 / m->eta : m->eta;
        if (transmits != (wo.z < 0))
            s->wi.z = -s->wi.z;
    }
    s->f = f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0;
}

/* In the form for importance: nothing is lost. */
static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    (void)wo;
    return boundary(self).is_smooth ? SR_ONE : SR_BLACK + NAN;
}

const struct sr_bsdf_model sr_bsdf_ggx_dielectric_ms = {
    .name = "ggx_dielectric_ms",
    .title = "Ground glass with all its bounces",
    .source = "After C. Kulla & A. Conty, Revisiting physically based shading at Imageworks, 2017",
    .limits =
        "What bounces twice forgets its direction; how much of it crosses is a guess; one roughness for all azimuths",
    .params = params,
    .size = sizeof(struct ggx_dielectric_ms),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
    .largest_albedo = 1.012f,
};
