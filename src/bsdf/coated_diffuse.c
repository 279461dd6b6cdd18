/* SPDX-License-Identifier: MIT */
/* Lacquer over paint: a dielectric coat, smooth or rough, over Lambert's base, with a medium between them.
 *
 * Where the medium does not scatter, all that the base does is forget directions, and the walks of layered.h collapse:
 *
 *     f = f_coat + A(wo) A(wi) / eta^2  rho / pi  SUM_{k<K} (rho Fi)^k                     [1/sr]
 *     A(w) = share that arrives at the base,    Fi = share of the base's light that the coat sends back to it
 *     K = (max_depth + 1) / 2   meetings with the base, as an event is one crossing
 *
 * Smooth coat:  A = (1 - F(w)) exp(-d / cos_t)   and   Fi = 2 INTEGRAL_0^1 F_inside(c) exp(-2 d / c) c dc   are
 * functions, so f is exact; for d = 0, Fi = 1 - (1 - F_diffuse) / eta^2. Rough coat: each factor is drawn once,
 * independently, so the product is unbiased without the cost of joining the walk at each bounce. Otherwise: the walk.
 *
 * J. L. Saunderson 1942; M. Elias & L. Simonot 2001; Guo, Hasan & Zhao 2018. */
#include "bsdf/layered.h"

static const struct sr_param params[] = {
    {SR_PARAM_ALBEDO, "reflectance", "1", 0, 1, 0.5, offsetof(struct sr_bsdf_coated, base_reflectance), "of the base"},
    {SR_PARAM_ALBEDO, "albedo", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, albedo),
     "of the medium between; black only absorbs"},
    {SR_PARAM_FLOAT, "coat_alpha_x", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, coat_ggx.alpha_x),
     "slope width of the coat along the tangent"},
    {SR_PARAM_FLOAT, "coat_alpha_y", "1", 0, 1, 0, offsetof(struct sr_bsdf_coated, coat_ggx.alpha_y),
     "slope width of the coat across it"},
    {SR_PARAM_FLOAT, "coat_eta", "1", 0.5, 3, 1.5, offsetof(struct sr_bsdf_coated, coat_eta),
     "index of refraction of the coat"},
    {SR_PARAM_FLOAT, "thickness", "1", 0, 10, 0.01, offsetof(struct sr_bsdf_coated, thickness),
     "of the medium, in mean free paths"},
    {SR_PARAM_FLOAT, "g", "1", -0.95, 0.95, 0, offsetof(struct sr_bsdf_coated, g),
     "mean cosine of scattering in the medium"},
    {SR_PARAM_INT, "max_depth", "1", 1, 100, 10, offsetof(struct sr_bsdf_coated, max_depth),
     "longest walk, in crossings and scatterings"},
    {SR_PARAM_INT, "sample_count", "1", 1, 64, 1, offsetof(struct sr_bsdf_coated, sample_count),
     "walks for one value of f"},
    {0},
};

static void ready(void *self, const struct sr_bsdf_at *at)
{
    ((struct sr_bsdf_coated *)self)->seed = at->seed;
}

static uint32_t lobes(const void *self)
{
    struct layers l = layers_of(self, false);
    uint32_t lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
    return lobe | (l.top.is_smooth ? (l.top.eta == 1 ? 0 : SR_LOBE_SPECULAR) : SR_LOBE_GLOSSY);
}

/* 2 E_3(x) = 2 INTEGRAL_0^1 c exp(-x / c) dc, from E_1 of Abramowitz & Stegun 5.1.53 and 5.1.56; error < 1e-6. */
static float twice_e3(float x)
{
    if (!(x > 0))
        return 1;
    if (x > 60)
        return 0;
    float e = exp_minus(x), e1;
    if (x < 1)
        e1 = minus_log(x) - 0.57721566f +
             x * (0.99999193f + x * (-0.24991055f + x * (0.05519968f + x * (-0.00976004f + x * 0.00107857f))));
    else
        e1 = e / x * (0.2677737343f + x * (8.6347608925f + x * (18.0590169730f + x * (8.5733287401f + x)))) /
             (3.9584969228f + x * (21.0996530827f + x * (25.6329561486f + x * (9.5733223454f + x))));
    return e * (1 - x) + x * x * e1;
}

/* Fi above, by Gauss-Legendre quadrature of 8 nodes in a variable that makes the integrand smooth. */
static float inner_reflectance(float eta, float thickness)
{
    static const float node[8] = {0.01985507f, 0.10166676f, 0.23723380f, 0.40828268f,
                                  0.59171732f, 0.76276620f, 0.89833324f, 0.98014493f};
    static const float weight[8] = {0.05061427f, 0.11119052f, 0.15685332f, 0.18134189f,
                                    0.18134189f, 0.15685332f, 0.11119052f, 0.05061427f};
    if (eta == 1)
        return 0;
    float d = 2 * thickness, sum = 0;
    if (eta < 1) { // no total reflection inside; c = v^2
        for (int i = 0; i < 8; ++i) {
            float v = node[i], c = v * v, unused;
            sum += weight[i] * fresnel_and_cos(c, 1 / eta, &unused) * exp_minus(d / c) * 4 * v * c;
        }
        return sum;
    }
    // x, the cosine outside: 2 c dc = 2 x dx / eta^2
    float invers2 = 1 / (eta * eta);
    for (int i = 0; i < 8; ++i) {
        float x = node[i], c = sqrtf(1 - (1 - x * x) * invers2);
        float r_p = (eta * x - c) / (eta * x + c), r_s = (x - eta * c) / (x + eta * c);
        sum += weight[i] * x * invers2 * (r_p * r_p + r_s * r_s) * exp_minus(d / c);
    }
    // total reflection from the critical angle to grazing
    float critical2 = 1 - invers2;
    return sum + critical2 * twice_e3(d / sqrtf(critical2));
}

static float arrival(const struct sr_bsdf_coated *c, float cos_outside)
{
    float cos_t, F = fresnel_and_cos(cos_outside, c->coat_eta, &cos_t);
    return F < 1 ? (1 - F) * crossing(c->thickness, (sr_vec3){0, 0, cos_t}) : 0;
}

/* rho SUM_{k<K} (rho Fi)^k */
static sr_spectrum bounces(const struct sr_bsdf_coated *c, float inner)
{
    sr_spectrum x = c->base_reflectance * inner, power = SR_ONE, square = x;
    for (int k = (c->max_depth + 1) / 2; k > 0; k >>= 1) {
        if (k & 1)
            power *= square;
        square *= square;
    }
    return c->base_reflectance * ((1 - power) / sr_spectrum_clamp(1 - x, 1e-6f, 1));
}

static bool is_closed(const struct layers *l)
{
    return l->top.is_smooth && !l->has_medium;
}

/* What sample chooses by: the share of light that the coat mirrors, and the largest share that the base returns. */
struct shares {
    float mirror;        // [1] F
    float arrival;       // [1] A(wo)
    sr_spectrum bounces; // [1]
    float probability;   // [1] of the mirror
};
static struct shares shares_of(const struct sr_bsdf_coated *c, float cos_o)
{
    struct shares s;
    float cos_t, inner = inner_reflectance(c->coat_eta, c->thickness);
    s.mirror = fresnel_and_cos(cos_o, c->coat_eta, &cos_t);
    s.arrival = s.mirror < 1 ? (1 - s.mirror) * crossing(c->thickness, (sr_vec3){0, 0, cos_t}) : 0;
    s.bounces = bounces(c, inner);
    float matte = s.arrival * sr_spectrum_max(s.bounces) * (1 - inner);
    s.probability = matte > 0 ? s.mirror / (s.mirror + matte) : 1;
    return s;
}

/* For weighing only: the coat's own lobe, and the base's as if the coat were smooth. One machine code for all who ask.
 */
__attribute__((noinline)) static float density(const struct layers *l, sr_vec3 wo, sr_vec3 wi)
{
    float cosine = wi.z * SR_INV_PI, top;
    interface_f_pdf(&l->top, wo, wi, SR_LOBE_REFLECTION | SR_LOBE_TRANSMISSION, &top);
    float F = fresnel(wo.z, l->c->coat_eta);
    return 0.9f * (top + (1 - F) * cosine) + 0.1f * cosine;
}

/* A rough coat over a medium that does not scatter. */
static sr_spectrum rough_f(const struct layers *l, sr_vec3 wo, sr_vec3 wi)
{
    const struct sr_bsdf_coated *c = l->c;
    float unused;
    sr_spectrum coat = SR_BLACK + interface_f_pdf(&l->top, wo, wi, SR_LOBE_REFLECTION, &unused), sum = SR_BLACK;
    struct sr_rng rng = rng_of(c->seed, wo, wi.x, wi.y, wi.z);
    int count = c->sample_count > 0 ? c->sample_count : 1;
    for (int n = 0; n < count; ++n) {
        struct interface_sample enter, leave, back;
        if (!draw_top(l, wo, SR_LOBE_TRANSMISSION, &rng, &enter) ||
            !draw_top(l, wi, SR_LOBE_TRANSMISSION, &rng, &leave))
            continue;
        sr_spectrum beta = c->base_reflectance * (enter.weight * crossing(c->thickness, enter.wi) * leave.weight *
                                                  crossing(c->thickness, leave.wi));
        sum += beta;
        sr_spectrum gain = c->base_reflectance;
        float most = sr_spectrum_max(gain), kept = 1;
        for (int k = (c->max_depth + 1) / 2; k > 1; --k) {
            sr_vec3 w = cosine_direction(uniform2(&rng));
            if (!(w.z > 0) || !draw_top(l, sr_neg(w), SR_LOBE_REFLECTION, &rng, &back))
                break;
            float Fi = back.weight * crossing(c->thickness, w) * crossing(c->thickness, back.wi);
            kept *= most * Fi;
            beta *= gain * Fi;
            if (kept < 0.25f) { // by lot
                float survive = 2 * kept;
                if (sr_rng_float(&rng) >= survive)
                    break;
                beta *= 1 / survive;
                kept = 0.5f;
            }
            sum += beta;
        }
    }
    return coat + sum * (SR_INV_PI / ((float)count * l->top.eta * l->top.eta));
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct sr_bsdf_coated *c = self;
    (void)mode;
    *p = 0;
    if (!(wo.z * wi.z > 0))
        return SR_BLACK;
    if (wo.z < 0) {
        wo = sr_neg(wo);
        wi = sr_neg(wi);
    }
    struct layers l = layers_of(c, false);
    if (!is_closed(&l)) {
        *p = density(&l, wo, wi);
        return l.has_medium || c->weighs_as_pbrt ? layered_f(&l, false, wo, wi) : rough_f(&l, wo, wi);
    }
    struct shares share = shares_of(c, wo.z);
    *p = (1 - share.probability) * (wi.z * SR_INV_PI);
    return share.bounces * (share.arrival * arrival(c, wi.z) * (SR_INV_PI / (c->coat_eta * c->coat_eta)));
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_coated_diffuse.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    if (!(wo.z * wi.z > 0))
        return 0;
    struct layers l = layers_of(self, false);
    if (is_closed(&l)) {
        float p;
        sr_bsdf_coated_diffuse.f_pdf(self, wo, wi, mode, &p);
        return p;
    }
    return density(&l, wo.z < 0 ? sr_neg(wo) : wo, wo.z < 0 ? sr_neg(wi) : wi);
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    (void)mode;
    const struct sr_bsdf_coated *c = self;
    struct layers l = layers_of(c, false);
    bool below = wo.z < 0, drawn;
    if (wo.z == 0)
        return false;
    if (below)
        wo = sr_neg(wo);
    if (is_closed(&l)) {
        struct shares share = shares_of(c, wo.z);
        *s = (struct sr_bsdf_sample){.eta = 1};
        if (u_lobe < share.probability) {
            s->wi = (sr_vec3){-wo.x, -wo.y, wo.z};
            s->pdf = share.probability;
            s->lobe = SR_LOBE_REFLECTION | SR_LOBE_SPECULAR;
            s->f = SR_BLACK + share.mirror / wo.z;
            drawn = share.mirror > 0;
        } else {
            s->wi = cosine_direction(u);
            s->pdf = (1 - share.probability) * (s->wi.z * SR_INV_PI);
            s->lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
            s->f = share.bounces * (share.arrival * arrival(c, s->wi.z) * (SR_INV_PI / (c->coat_eta * c->coat_eta)));
            drawn = s->pdf > 0;
        }
    } else
        drawn = layered_sample(&l, false, wo, u_lobe, u, s);
    if (below)
        s->wi = sr_neg(s->wi);
    return drawn;
}

static sr_spectrum albedo(const void *self, sr_vec3 wo)
{
    const struct sr_bsdf_coated *c = self;
    struct layers l = layers_of(c, false);
    if (!is_closed(&l) || c->thickness > 0)
        return SR_BLACK + NAN; // what the coat takes on the way out is an integral of its own
    float F = fresnel(fabsf(wo.z), c->coat_eta), inner = inner_reflectance(c->coat_eta, 0);
    return F + bounces(c, inner) * ((1 - F) * (1 - inner));
}

const struct sr_bsdf_model sr_bsdf_coated_diffuse = {
    .name = "coated_diffuse",
    .title = "Matte base under a dielectric coat",
    .source = "Y. Guo, M. Hasan & S. Zhao, Position-free Monte Carlo simulation for arbitrary layered BSDFs, 2018",
    .limits = "f is a random walk: right in the mean; ends after max_depth events",
    .params = params,
    .size = sizeof(struct sr_bsdf_coated),
    .is_random = true,
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .albedo = albedo,
};
