/* SPDX-License-Identifier: MIT */
/* Cloth's sheen, and dust: what comes back from a layer of fibres that stand upright, after any number of bounces.
 *
 *     f = reflectance R(zo) D(wi) / zi   [1/sr],    D = zi A^2 / (pi |(A x + B zi, A y, zi)|^4)   [1/sr]
 *
 * x and y are wi's coordinates in the frame whose x axis is wo's azimuth; R, A and B are functions of alpha and of zo,
 * in a table of ours: the layer has the thickness 1, the density 1 and no absorption, its microflakes mirror and have
 * the SGGX distribution of fibres along the normal with cross-section alpha^2; light is followed through it at random,
 * R is the share that comes back, and A and B are those which make its directions likeliest (scripts/sheen_table.c).
 * What passes is lost: a material puts this on top of something else. D is a cosine lobe under a linear map, hence
 * drawn exactly, and every sample weighs the same. T. Zeltner, B. Burley & M. J.-Y. Chiang, Practical
 * multiple-scattering sheen using linearly transformed cosines, 2022; E. Heitz et al., The SGGX microflake
 * distribution, 2015. */
#include "bsdf/hemisphere.h"
#include "bsdf/sheen_ltc_table.h"

struct sheen_ltc {
    sr_spectrum reflectance; // [1]
    float alpha;
    // of ready
    int32_t row;   // of the table
    float between; // [1] share of the next row
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 1, offsetof(struct sheen_ltc, reflectance), "colour of the fibres"},
    {SR_PARAM_FLOAT, "alpha", "1", 0.1, 1, 0.5, offsetof(struct sheen_ltc, alpha),
     "roughness: square root of the fibres' cross-section from above"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct sheen_ltc *m = self;
    (void)at;
    float where = sr_clamp((m->alpha - 0.1f) / 0.9f, 0, 1) * (SHEEN_ROWS - 1);
    m->row = where < SHEEN_ROWS - 2 ? (int32_t)where : SHEEN_ROWS - 2;
    m->between = where - (float)m->row;
}

static uint32_t lobes(const void *self)
{
    (void)self;
    return SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}

struct lobe {
    float A, B, R;
    float cos_x, sin_x; // of the viewer's azimuth
};

static struct lobe lobe_of(const struct sheen_ltc *m, sr_vec3 wo)
{
    float where = sqrtf(sr_min(fabsf(wo.z), 1)) * (SHEEN_COLUMNS - 1), sine = sqrtf(sin2_theta(wo)), v[3];
    int i = where < SHEEN_COLUMNS - 2 ? (int)where : SHEEN_COLUMNS - 2;
    float t = where - (float)i;
    for (int k = 0; k < 3; ++k) {
        const int32_t(*lower)[3] = &sheen_ltc_table[m->row][i], (*upper)[3] = &sheen_ltc_table[m->row + 1][i];
        v[k] = sr_lerp(m->between, sr_lerp(t, (float)lower[0][k], (float)lower[1][k]),
                       sr_lerp(t, (float)upper[0][k], (float)upper[1][k]));
    }
    return (struct lobe){1e-5f * v[0], 1e-5f * v[1], 1e-6f * v[2], sine > 0 ? wo.x / sine : 1,
                         sine > 0 ? wo.y / sine : 0};
}

/* D / zi */
static float shape(const struct lobe *l, sr_vec3 wi)
{
    float x = wi.x * l->cos_x + wi.y * l->sin_x, y = wi.y * l->cos_x - wi.x * l->sin_x, z = fabsf(wi.z);
    float length2 = sr_sqr(l->A * x + l->B * z) + sr_sqr(l->A * y) + z * z;
    return SR_INV_PI * sr_sqr(l->A / length2);
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct sheen_ltc *m = self;
    (void)mode;
    *p = 0;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    struct lobe l = lobe_of(m, wo);
    float D = shape(&l, wi);
    *p = fabsf(wi.z) * D;
    return *p > 0 ? m->reflectance * (l.R * D) : SR_BLACK;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_sheen_ltc.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_sheen_ltc.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    struct lobe l = lobe_of(self, wo);
    (void)u_lobe;
    sr_vec3 h = sr_warp_cosine_hemisphere(u);
    float x = (h.x - l.B * h.z) / l.A, y = h.y / l.A;
    sr_vec3 wi = sr_normalize((sr_vec3){x * l.cos_x - y * l.sin_x, x * l.sin_x + y * l.cos_x, h.z});
    return finish(&sr_bsdf_sheen_ltc, self, wo, wi, SR_LOBE_DIFFUSE, mode, s);
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sheen_ltc *m = self;
    return m->reflectance * lobe_of(m, wo).R;
}

const struct sr_bsdf_model sr_bsdf_sheen_ltc = {
    .name = "sheen_ltc",
    .title = "Sheen of upright fibres, all bounces",
    .source = "T. Zeltner, B. Burley & M. J.-Y. Chiang, Practical multiple-scattering sheen using linearly transformed "
              "cosines, 2022",
    .limits = "A lobe that is fitted: not reciprocal where little light goes; what passes between the fibres is lost",
    .params = params,
    .size = sizeof(struct sheen_ltc),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
    .asymmetry = 1,
};
