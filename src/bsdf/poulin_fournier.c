/* SPDX-License-Identifier: MIT */
/* A brushed or woven surface: parallel cylinders of radius 1 along x, a distance d apart, sunk into ground at the
 * height h above their axes; light that is scattered once, with all shadowing and masking between the cylinders.
 *
 *     f  = 1 / (d mu_i mu_o) INTEGRAL over what is lit and seen of fm(n) (n.wi)(n.wo) ds   [1/sr],
 *         n = (0, cos g, sin g)
 *     fm = reflectance / pi + specular (e + 2) / (2 pi) max(0, 2 (n.wi)(n.wo) - wi.wo)^e,
 *         e = exponent (modified Phong)
 *
 * Across x, let w be r (cos a, sin a). A point g of a cylinder sees w between the neighbour's tangent and its own:
 * a + asin(max(-1, 1 - d sin a)) <= g <= a + pi/2 where a <= pi/2, mirrored where a > pi/2; the ground's visible part
 * is as plain. What is lit and seen is one interval of g and one of the ground. With p = (a_i + a_o) / 2,
 *
 *     (n.wi)(n.wo) = r_i r_o cos(g - a_i) cos(g - a_o),     2 (n.wi)(n.wo) - wi.wo = r_i r_o cos 2(g - p) - x_i x_o
 *
 * so that the matte part has a closed form, and the highlight, a peak about p, is left to Gauss's rule of 12 points on
 * either side of it. pdf: cosine for the matte part; for the highlight a normal by how much of it wo sees, and Phong's
 * lobe about its mirror direction, summed over the normals by the same rule. P. Poulin & A. Fournier, A model for
 * anisotropic reflection, 1990, who fit polynomials where this integrates. Limits: light that is reflected twice is
 * missing; scratches (cylinders taken away) are not covered. */
#include "bsdf/hemisphere.h"

struct poulin_fournier {
    sr_spectrum reflectance, specular;
    float distance, height, exponent;
    float least, half_width, diffuse_share; // by ready: asin h [rad], sqrt(1 - h^2), of the samples
};

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.4, offsetof(struct poulin_fournier, reflectance),
     "share of light that cylinders and ground return evenly"},
    {SR_PARAM_ALBEDO, "specular", "1", 0, 1, 0.4, offsetof(struct poulin_fournier, specular),
     "share in the highlight; the two together not above 1"},
    {SR_PARAM_FLOAT, "distance", "1", 2, 10, 2, offsetof(struct poulin_fournier, distance),
     "between the cylinders' axes, in radii"},
    {SR_PARAM_FLOAT, "height", "1", 0, 0.95, 0, offsetof(struct poulin_fournier, height),
     "of the ground above the axes, in radii"},
    {SR_PARAM_FLOAT, "exponent", "1", 1, 1e4, 30, offsetof(struct poulin_fournier, exponent),
     "sharpness of the highlight"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct poulin_fournier *m = self;
    float d = sr_spectrum_mean(m->reflectance), s = sr_spectrum_mean(m->specular);
    (void)at;
    m->half_width = sqrtf((1 - m->height) * (1 + m->height));
    m->least = atan2f(m->height, m->half_width);
    m->diffuse_share = d > 0 ? d / (d + s) : 0;
}

static uint32_t lobes(const void *self)
{
    const struct poulin_fournier *m = self;
    uint32_t kind = (sr_spectrum_is_black(m->reflectance) ? 0u : SR_LOBE_DIFFUSE) |
                    (sr_spectrum_is_black(m->specular) ? 0u : SR_LOBE_GLOSSY);
    return kind ? SR_LOBE_REFLECTION | kind : 0;
}

#define LEAST_COSINE 1e-6f

struct across {           // of one direction, in the plane across the cylinders
    float r, a;           // length, angle [rad]
    float g0, g1, y0, y1; // visible on the cylinder at y = 0 [rad], and of the ground up to the next one
};

static struct across across_of(const struct poulin_fournier *m, sr_vec3 w)
{
    struct across v = {.r = sqrtf(w.y * w.y + w.z * w.z), .a = atan2f(w.z, w.y)};
    float sine = w.z / v.r, cosine = fabsf(w.y) / v.r, d = m->distance; // as if toward +y
    float lean = w.y < 0 ? SR_PI - v.a : v.a;
    // asin(max(-1, 1 - d sine)), exact at grazing too
    float blocked = SR_PI / 2 - 2 * asinf(sqrtf(sr_min(0.5f * d * sine, 1)));
    float g0 = sr_max(m->least, lean + blocked), g1 = sr_min(SR_PI - m->least, lean + SR_PI / 2);
    float y0 = m->half_width, y1 = d - m->half_width;
    if (cosine > m->height) // less steep than where the next cylinder leaves the ground
        y1 = sr_min(y1, d + (m->height * cosine - 1) / sine);
    v.g0 = w.y < 0 ? SR_PI - g1 : g0;
    v.g1 = w.y < 0 ? SR_PI - g0 : g1;
    v.y0 = w.y < 0 ? d - y1 : y0;
    v.y1 = w.y < 0 ? d - y0 : y1;
    return v;
}

static float common(float a0, float a1, float b0, float b1)
{
    return sr_max(0, sr_min(a1, b1) - sr_max(a0, b0));
}

/* INTEGRAL of c(g)^e k(g) dg over g0 ... g1, c = r_i r_o cos 2(g - p) - x_i x_o; k = cos(g - a_o), and cos(g - a_i)
 * with both */
static float highlight(const struct poulin_fournier *m, const struct across *o, const struct across *i, float xx,
                       float g0, float g1, bool both)
{
    static const float node[6] = {0.00921968287664038f, 0.0479413718147626f, 0.115048662902848f,
                                  0.206341022856691f,   0.31608425050091f,   0.437383295744266f};
    static const float weight[6] = {0.0235876681932559f, 0.0534696629976592f, 0.0800391642716731f,
                                    0.101583713361533f,  0.116746268269177f,  0.124573522906701f};
    float p = 0.5f * (o->a + i->a), R = o->r * i->r, e = m->exponent, top = R - xx, sum = 0;
    if (!(top > 0))
        return 0;
    // beyond reach, c^e is below e^-18 of its peak, or c below 0
    float edge = sr_clamp((top * expf(-18 / e) + xx) / sr_max(R, 1e-20f), -1, 1), reach = 0.5f * acosf(edge);
    for (int side = 0; side < 2; ++side) {
        float lo = sr_max(g0, side ? p : p - reach), hi = sr_min(g1, side ? p + reach : p);
        if (!(hi > lo))
            continue;
        for (int k = 0; k < 12; ++k) {
            float t = k < 6 ? node[k] : 1 - node[11 - k], g = lo + (hi - lo) * t, s = sinf(g - p);
            float lost = 2 * R * s * s; // top - c
            float power = expf(e * (logf(top) + log1pf(-sr_min(lost / top, 1))));
            float part = weight[k < 6 ? k : 11 - k] * (hi - lo) * power * sr_max(0, cosf(g - o->a));
            sum += both ? part * sr_max(0, cosf(g - i->a)) : part;
        }
    }
    return sum;
}

/* INTEGRAL cos(g - a) dg: how much of the cylinder's width is seen, for r = 1 */
static float seen_width(const struct across *v)
{
    return v->g1 > v->g0 ? sinf(v->g1 - v->a) - sinf(v->g0 - v->a) : 0;
}

/* INTEGRAL cos(g - a_i) cos(g - a_o) dg = (w cos(a_o - a_i) + sin w cos(2 m - a_o - a_i)) / 2, about m, w wide; at
 * grazing these two are almost opposite, so = w cos(m - a_o) cos(m - a_i) - (w - sin w) cos(2 m - a_o - a_i) / 2 */
static float seen_and_lit(const struct across *o, const struct across *i, float g0, float g1)
{
    float w = g1 - g0, m = 0.5f * (g0 + g1), x = m - o->a, y = m - i->a, w2 = w * w;
    float rest = w < 0.5f ? w * w2 / 6 * (1 - w2 / 20 * (1 - w2 / 42)) : w - sinf(w);
    return w * cosf(x) * cosf(y) - 0.5f * rest * cosf(x + y);
}

static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode, float *pdf)
{
    const struct poulin_fournier *m = self;
    (void)mode;
    *pdf = 0;
    if (!lobes(m) || !upper(&wo, &wi) || wo.z < LEAST_COSINE || wi.z < LEAST_COSINE)
        return SR_BLACK;
    struct across o = across_of(m, wo), i = across_of(m, wi);
    float e = m->exponent, scale = (e + 2) * 0.5f * SR_INV_PI, rr = o.r * i.r, xx = wo.x * wi.x, d = m->distance;
    float g0 = sr_max(o.g0, i.g0), g1 = sr_min(o.g1, i.g1), ground = common(o.y0, o.y1, i.y0, i.y1) * wo.z * wi.z;
    float mirrored = sr_max(0, wo.z * wi.z - xx - wo.y * wi.y), floor_power = mirrored > 0 ? powf(mirrored, e) : 0;
    bool shines = m->diffuse_share < 1;

    float matte = ground, gloss = shines ? ground * floor_power : 0;
    if (g1 > g0) {
        matte += sr_max(0, rr * seen_and_lit(&o, &i, g0, g1));
        if (shines)
            gloss += rr * highlight(m, &o, &i, xx, g0, g1, true);
    }
    *pdf = m->diffuse_share * wi.z * SR_INV_PI;
    if (shines) { // normals by what wo sees of them: r cos(g - a) of d mu_o
        float normals =
            (o.y1 > o.y0 ? o.y1 - o.y0 : 0) * wo.z * floor_power + o.r * highlight(m, &o, &i, xx, o.g0, o.g1, false);
        float whole = (o.y1 > o.y0 ? o.y1 - o.y0 : 0) * wo.z + o.r * seen_width(&o);
        *pdf += whole > 0 ? (1 - m->diffuse_share) * (e + 1) * 0.5f * SR_INV_PI * normals / whole : 0;
    }
    if (!(*pdf > 0))
        return SR_BLACK;
    return (m->reflectance * (SR_INV_PI * matte) + m->specular * (scale * gloss)) * (1 / (d * wo.z * wi.z));
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_poulin_fournier.f_pdf(self, wo, wi, mode, &unused);
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_poulin_fournier.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct poulin_fournier *m = self;
    const struct sr_bsdf_model *model = &sr_bsdf_poulin_fournier;
    if (!lobes(m) || fabsf(wo.z) < LEAST_COSINE)
        return false;
    if (u_lobe < m->diffuse_share)
        return finish(model, self, wo, sr_warp_cosine_hemisphere(u), SR_LOBE_DIFFUSE, mode, s);
    float v = sr_min((u_lobe - m->diffuse_share) / (1 - m->diffuse_share), SR_ONE_MINUS_EPSILON);
    sr_vec3 up = {wo.x, wo.y, fabsf(wo.z)}, n = {0, 0, 1};
    struct across o = across_of(m, up);
    float ground = (o.y1 > o.y0 ? o.y1 - o.y0 : 0) * up.z, cylinder = o.r * seen_width(&o);
    v *= ground + cylinder;
    if (v < cylinder) { // sin(g - a_o) is even over what is seen
        float g = o.a + asinf(sr_clamp(sinf(o.g0 - o.a) + v / o.r, -1, 1));
        n = (sr_vec3){0, cosf(g), sinf(g)};
    }
    sr_vec3 wi = draw_power_of_cos(sr_normalize(sr_reflect(up, n)), m->exponent, u);
    return finish(model, self, wo, wi, SR_LOBE_GLOSSY, mode, s);
}

const struct sr_bsdf_model sr_bsdf_poulin_fournier = {
    .name = "poulin_fournier",
    .title = "Poulin-Fournier, cylinders",
    .source = "P. Poulin & A. Fournier, A model for anisotropic reflection, 1990",
    .limits = "Single scattering between cylinders.",
    .params = params,
    .size = sizeof(struct poulin_fournier),
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
};
