/* SPDX-License-Identifier: MIT */
/* Anisotropic Phong: an elliptic highlight with Schlick's Fresnel, over a matte part that gives way to it at grazing.
 *
 *     f = sqrt((nx + 1)(ny + 1)) / (8 pi) (n.h)^((nx hx^2 + ny hy^2) / (1 - (n.h)^2))
 *         F / (wo.h max(cos_theta_o, cos_theta_i))
 *         + 28 / (23 pi) reflectance (1 - specular) (1 - (1 - cos_theta_i / 2)^5) (1 - (1 - cos_theta_o / 2)^5)
 *         [1/sr]
 *     F = specular + (1 - specular)(1 - wo.h)^5
 *     pdf = p_d cos_theta_i / pi + p_s sqrt((nx + 1)(ny + 1)) / (2 pi) (n.h)^(...) / (4 wo.h)   [1/sr]
 *
 * M. Ashikhmin & P. Shirley, An anisotropic Phong BRDF model, 2000. Limits: broad highlights lose light; Schlick's
 * Fresnel is off by several hundredths for metals. */
#include "bsdf/hemisphere.h"

struct ashikhmin_shirley {
    sr_spectrum reflectance, specular;
    float exponent_x, exponent_y;
    float N; // by ready: sqrt((nx + 1)(ny + 1)) / (8 pi)
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.4, offsetof(struct ashikhmin_shirley, reflectance),
     "share of what is not reflected by the surface that the matte part returns"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.05, offsetof(struct ashikhmin_shirley, specular),
     "reflectance of the surface at normal incidence"},
    {SR_PARAM_FLOAT, "exponent_x", "1", 1, 1e5, 100, offsetof(struct ashikhmin_shirley, exponent_x),
     "sharpness of the highlight along the tangent"},
    {SR_PARAM_FLOAT, "exponent_y", "1", 1, 1e5, 100, offsetof(struct ashikhmin_shirley, exponent_y),
     "sharpness across it"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct ashikhmin_shirley *m = self;
    (void)at;
    m->N = sqrtf((m->exponent_x + 1) * (m->exponent_y + 1)) / (8 * SR_PI);
}

static uint32_t lobes(const void *self)
{
    (void)self; // Fresnel's highlight remains where specular is 0
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | SR_LOBE_DIFFUSE;
}

static float power5(float x)
{
    float x2 = x * x;
    return x2 * x2 * x;
}

/* share of the samples for the matte part: what it returns against what the surface does, seen from there */
static float diffuse_share(const struct ashikhmin_shirley *m, float cos_o)
{
    float fresnel = power5(1 - cos_o), d = sr_spectrum_mean(m->reflectance * (1 - m->specular)) * (1 - fresnel);
    float s = sr_spectrum_mean(m->specular + (1 - m->specular) * fresnel);
    return d > 0 ? sr_clamp(d / (d + s), 0, 0.9f) : 0;
}

/* N (n.h)^(...), and wo.h; wo and wi above the surface */
static float highlight(const struct ashikhmin_shirley *m, sr_vec3 wo, sr_vec3 wi, float *cos_h)
{
    sr_vec3 h = sr_add(wo, wi);
    *cos_h = 0.5f * sr_length(h);
    if (!(*cos_h > 1e-10f))
        return 0;
    float x2 = h.x * h.x, y2 = h.y * h.y, sin2 = x2 + y2;
    float n = sin2 > 0 ? (m->exponent_x * x2 + m->exponent_y * y2) / sin2 : m->exponent_x;
    return m->N * power_of_cos(sin2, h.z * h.z, n);
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct ashikhmin_shirley *m = self;
    float cos_h;
    (void)mode;
    if (!upper(&wo, &wi))
        return SR_BLACK;
    float shape = highlight(m, wo, wi, &cos_h);
    float matte = 28 / (23 * SR_PI) * (1 - power5(1 - wo.z / 2)) * (1 - power5(1 - wi.z / 2));
    sr_spectrum value = m->reflectance * (1 - m->specular) * matte;
    if (!(shape > 0))
        return value;
    sr_spectrum F = m->specular + (1 - m->specular) * power5(1 - sr_min(cos_h, 1));
    return value + F * (shape / (cos_h * sr_max(wo.z, wi.z)));
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    const struct ashikhmin_shirley *m = self;
    (void)mode;
    if (!upper(&wo, &wi))
        return 0;
    float cos_h, shape = highlight(m, wo, wi, &cos_h), d = diffuse_share(m, wo.z);
    return d * wi.z * SR_INV_PI + (shape > 0 ? (1 - d) * shape / cos_h : 0);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct ashikhmin_shirley *m = self;
    const struct sr_bsdf_model *model = &sr_bsdf_ashikhmin_shirley;
    if (u_lobe < diffuse_share(m, fabsf(wo.z)))
        return finish(model, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    float x, y, n; // azimuth: tan phi = sqrt((nx + 1) / (ny + 1)) tan(turn)
    sr_sin_cos_turn(u.y, &y, &x);
    x *= sqrtf(m->exponent_y + 1);
    y *= sqrtf(m->exponent_x + 1);
    float r2 = x * x + y * y;
    n = (m->exponent_x * x * x + m->exponent_y * y * y) / r2;
    float log_c = logf(sr_max(1 - u.x, 1e-30f)) / (n + 1), sine = sr_safe_sqrt(-expm1f(2 * log_c)) / sqrtf(r2);
    sr_vec3 up = {wo.x, wo.y, fabsf(wo.z)}, h = {sine * x, sine * y, expf(log_c)};
    return sr_dot(up, h) > 0 && finish(model, self, wo, sr_reflect(up, h), SR_LOBE_GLOSSY, mode, s);
}

const struct sr_bsdf_model sr_bsdf_ashikhmin_shirley = {
    .name = "ashikhmin_shirley",
    .title = "Ashikhmin-Shirley",
    .source = "M. Ashikhmin & P. Shirley, An anisotropic Phong BRDF model, 2000",
    .limits = "Broad highlights lose light; Schlick's Fresnel is off by hundredths for metals.",
    .params = params,
    .size = sizeof(struct ashikhmin_shirley),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
};
