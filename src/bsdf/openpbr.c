/* SPDX-License-Identifier: MIT */
/* OpenPBR's surface (version 1.1): fuzz over coat over a mixture of metal, glass and glossy-diffuse matter.
 *
 *     f = w_f C_f f_fuzz + (1 - w_f max(E_f(ci), E_f(co))) (w_c f_coat + SUM_l f_l lerp(w_c, 1, a K_l))       [1/sr]
 *     metal:   m w_s F82(cd) D G / (4 ci co)
 *     gloss:   (1 - m)(1 - t) C_s F(cd, eta_s) D G / (4 ci co)
 *     matte:   (1 - m)(1 - t) (1 - E_s(ci))(1 - E_s(co)) / (1 - <E_s>) f_EON(w_b C_b)
 *     glass:   (1 - m) t C_s F D G / (4 ci co)
 *              through it (1 - m) t C_t (1 - F) D G |wi.m| |wo.m| / (ci co (wi.m + wo.m / eta)^2)
 *     under the coat:  a = C_c^((1 / mu_i + 1 / mu_o) / 2), mu the cosines inside it;
 *         K_matte = (1 - E_c(ci))(1 - E_c(co)) / (1 - <E_c>) d,   K of the others = min(1 - E_c(ci), 1 - E_c(co)) d;
 *         d = lerp(darkening, 1, (1 - k) / (1 - k E_b)),
 *         k = the coat's reflectance from inside: Fresnel's for mirrors, 1 - (1 - <F>) / eta_c^2 for what is rough
 *
 * Names, weights, F82 (metals), the index under a coat, its roughening of what is below, alpha_x = r^2 sqrt(2 / (1 + (1
 * - a)^2)), alpha_y = (1 - a) alpha_x are OpenPBR's; EON: Portsmouth, Kutz & Hill 2024; fuzz: Estevez & Kulla 2017
 * (sheen.c, estevez). Z. Andersson, P. Edmondson, J. Guertault, A. Herubel, A. King, P. Kutz et al., OpenPBR
 * Surface 1.1, 2024.
 *
 * What differs from a full solution of the layers, and from OpenPBR's own suggestions: layers are joined by directional
 * albedos E of the layer above (tables of Schlick's split, made when the first material is loaded) in a form that is
 * the same from both sides, which OpenPBR leaves open, and which returns up to 1.1 times what arrives at grazing; light
 * is lost between facets; fuzz is not Zeltner's. Not here: subsurface scattering, volumes of transmission_depth,
 * dispersion, coat anisotropy, opacity, emission; they belong to media, other models and the scene. Light is refracted
 * by the index that specular_weight has changed, so that it is the same from both sides. From below, what is not glass
 * looks as from above.
 *
 * Thin walls: the glass is a pane without roughness for what goes through it; it reflects 2 F / (1 + F), all bounces
 * inside. Thin film: metal and gloss reflect lerp(weight, F, |r|^2), with r = (r_01 + r_12 e) / (1 + r_01 r_12 e), e =
 * exp(4 pi i n d cos / lambda) of both polarisations, above a base of the real index that reflects as the base does at
 * normal incidence (as L. Belcour & P. Barla 2017 and glTF's iridescence); glass has no film. For the matter below, the
 * film's mean over phases counts. */
#include "bsdf/burley.h"
#include "bsdf/charlie.h"

#include <pthread.h>

struct openpbr {
    sr_spectrum base_color, specular_color, transmission_color, coat_color, fuzz_color; // [1]
    sr_spectrum rho, again, edge,
        absorb;         // derived: EON's colour, and what it scatters again; F82's subtrahend; ln C_c / 2
    sr_spectrum lambda; // derived [nm], where there is a film
    float base_weight, base_diffuse_roughness, base_metalness, specular_weight, specular_roughness,
        specular_roughness_anisotropy, specular_ior, transmission_weight, coat_weight, coat_roughness, coat_ior,
        coat_darkening, fuzz_weight, fuzz_roughness;   // [1]
    float thin_walled, film_weight, film_um, film_ior; // [1] [1] [um] [1]
    // derived
    struct sr_ggx ggx, coat;
    float metal, gloss, glass;           // [1] shares
    float eta, eta_s;                    // [1] of the glass, 1: light goes straight on; of the gloss under the coat
    float gloss0, gloss_mean;            // [1] F at normal incidence, 1 / (1 - <E_s>)
    float coat0, coat_mean, coat_inside; // [1] the same of the coat; k of rough matter
    float A;                             // EON's
    float alpha, coat_alpha;             // [1] for the tables: geometric means
    struct charlie fuzz;
    float pane; // [1] index of a thin wall's glass; 0: solid
};
_Static_assert(sizeof(struct openpbr) <= SR_BSDF_SIZE, "too large for a BSDF at a point");

static const struct sr_param params[] = {
    {SR_PARAM_FLOAT, "base_weight", "1", 0, 1, 1, offsetof(struct openpbr, base_weight), "scales base_color"},
    {SR_PARAM_ALBEDO, "base_color", "1", 0, 1, 0.8, offsetof(struct openpbr, base_color),
     "of matte matter and of metal"},
    {SR_PARAM_FLOAT, "base_diffuse_roughness", "1", 0, 1, 0, offsetof(struct openpbr, base_diffuse_roughness),
     "0: Lambert, 1: roughest"},
    {SR_PARAM_FLOAT, "base_metalness", "1", 0, 1, 0, offsetof(struct openpbr, base_metalness), "share of metal"},
    {SR_PARAM_FLOAT, "specular_weight", "1", 0, 2, 1, offsetof(struct openpbr, specular_weight),
     "scales the reflectance at normal incidence"},
    {SR_PARAM_ALBEDO, "specular_color", "1", 0, 1, 1, offsetof(struct openpbr, specular_color),
     "tints gloss, and metal at its edge"},
    {SR_PARAM_FLOAT, "specular_roughness", "1", 0, 1, 0.3, offsetof(struct openpbr, specular_roughness),
     "square root of the slope width"},
    {SR_PARAM_FLOAT, "specular_roughness_anisotropy", "1", 0, 0.95, 0,
     offsetof(struct openpbr, specular_roughness_anisotropy), "stretches along the tangent"},
    {SR_PARAM_FLOAT, "specular_ior", "1", 1.05, 3, 1.5, offsetof(struct openpbr, specular_ior),
     "index of refraction of the base"},
    {SR_PARAM_FLOAT, "transmission_weight", "1", 0, 1, 0, offsetof(struct openpbr, transmission_weight),
     "share of glass in what is not metal"},
    {SR_PARAM_ALBEDO, "transmission_color", "1", 0, 1, 1, offsetof(struct openpbr, transmission_color),
     "tints light at each passage"},
    {SR_PARAM_FLOAT, "coat_weight", "1", 0, 1, 0, offsetof(struct openpbr, coat_weight), "share that is coated"},
    {SR_PARAM_ALBEDO, "coat_color", "1", 0, 1, 1, offsetof(struct openpbr, coat_color),
     "transmittance of the coat, there and back, at normal incidence"},
    {SR_PARAM_FLOAT, "coat_roughness", "1", 0, 1, 0, offsetof(struct openpbr, coat_roughness),
     "square root of the slope width of the coat"},
    {SR_PARAM_FLOAT, "coat_ior", "1", 1.05, 3, 1.6, offsetof(struct openpbr, coat_ior),
     "index of refraction of the coat"},
    {SR_PARAM_FLOAT, "coat_darkening", "1", 0, 1, 1, offsetof(struct openpbr, coat_darkening),
     "how much of the coat's inner reflections is counted"},
    {SR_PARAM_FLOAT, "fuzz_weight", "1", 0, 1, 0, offsetof(struct openpbr, fuzz_weight), "share that is fuzzy"},
    {SR_PARAM_ALBEDO, "fuzz_color", "1", 0, 1, 1, offsetof(struct openpbr, fuzz_color), "of the fibres"},
    {SR_PARAM_FLOAT, "fuzz_roughness", "1", 0.1, 1, 0.5, offsetof(struct openpbr, fuzz_roughness),
     "how far the fibres spread from the horizon"},
    {SR_PARAM_FLOAT, "thin_walled", "1", 0, 1, 0, offsetof(struct openpbr, thin_walled),
     "above 0.5: the glass is a pane"},
    {SR_PARAM_FLOAT, "thin_film_weight", "1", 0, 1, 0, offsetof(struct openpbr, film_weight),
     "share that bears a film"},
    {SR_PARAM_FLOAT, "thin_film_thickness", "um", 0, 10, 0.5, offsetof(struct openpbr, film_um), "of the film"},
    {SR_PARAM_FLOAT, "thin_film_ior", "1", 1, 3, 1.4, offsetof(struct openpbr, film_ior),
     "index of refraction of the film"},
    {0},
};

/* ---- directional albedos: of facets whose F is 1, of facets whose F is (1 - cd)^5, and of fuzz ---- */

enum { NODES_MU = 32, NODES_R = 16, WHOLE = 0, GRAZING = 1, FUZZ = 2 };
static float tables[3][NODES_R][NODES_MU]; // over roughness and cosine, both from 0 to 1
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void make_tables(void)
{
    enum { N = 16 };
    for (int j = 0; j < NODES_R; ++j)
        for (int i = 0; i < NODES_MU; ++i) {
            float r = (float)j / (NODES_R - 1), alpha = sr_max(r * r, 1e-3f);
            float mu = sr_max((float)i / (NODES_MU - 1), 1e-3f);
            sr_vec3 wo = {sqrtf(1 - mu * mu), 0, mu}, wi;
            struct charlie fuzz = charlie_of(sr_max(r, 0.1f));
            float whole = 0, grazing = 0, fuzzy = 0;
            for (int k = 0; k < N * N; ++k) {
                float u = ((float)(k / N) + 0.5f) / N, v = ((float)(k % N) + 0.5f) / N, weight, unused, cd;
                if (ggx_sample_reflection((struct sr_ggx){alpha, alpha}, wo, (sr_vec2){0.5f * u, v}, &wi, &weight,
                                          &unused, &cd)) {
                    whole += weight;
                    grazing += weight * schlick_weight(cd);
                }
                float z = v * v, s = sqrtf(1 - z * z); // dz = 2 v dv, half a turn
                wi = (sr_vec3){s * cosf(SR_PI * u), s * sinf(SR_PI * u), z};
                fuzzy += 2 * SR_PI * 2 * v * z * charlie_D(&fuzz, wo, wi) * estevez_V(&fuzz, z, mu);
            }
            tables[WHOLE][j][i] = whole / (N * N);
            tables[GRAZING][j][i] = grazing / (N * N);
            tables[FUZZ][j][i] = fuzzy / (N * N);
        }
}

static float look_up(int table, float r, float mu)
{
    float y = sr_clamp(r, 0, 1) * (NODES_R - 1), x = sr_clamp(mu, 0, 1) * (NODES_MU - 1);
    int j = y < NODES_R - 2 ? (int)y : NODES_R - 2, i = x < NODES_MU - 2 ? (int)x : NODES_MU - 2;
    float(*t)[NODES_MU] = &tables[table][j];
    x -= (float)i;
    return sr_lerp(y - (float)j, sr_lerp(x, t[0][i], t[0][i + 1]), sr_lerp(x, t[1][i], t[1][i + 1]));
}
/* Of facets with Schlick's F from F0. */
static float gloss_albedo(float alpha, float F0, float mu)
{
    float r = sqrtf(alpha);
    return F0 * look_up(WHOLE, r, mu) + (1 - F0) * look_up(GRAZING, r, mu);
}
static float mean_transmittance(float alpha, float F0) // 2 INTEGRAL (1 - E) mu dmu
{
    float sum = 0;
    for (int i = 0; i < 16; ++i) {
        float mu = ((float)i + 0.5f) / 16;
        sum += 2 * mu * (1 - gloss_albedo(alpha, F0, mu)) / 16;
    }
    return sum;
}

static sr_status load(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)self;
    (void)arena;
    (void)error;
    pthread_once(&once, make_tables);
    return SR_OK;
}

/* ---- what follows from the parameters ---- */

static struct sr_ggx ggx_of(float roughness, float anisotropy)
{
    float along = roughness * roughness * sqrtf(2 / (1 + sr_sqr(1 - anisotropy)));
    return (struct sr_ggx){sr_max(along, 1e-3f), sr_max((1 - anisotropy) * along, 1e-3f)};
}
static float normal_reflectance(float eta)
{
    return sr_sqr((eta - 1) / (eta + 1));
}

static void ready(void *self, const struct sr_bsdf_at *at)
{
    struct openpbr *m = self;
    m->metal = m->base_metalness;
    m->gloss = (1 - m->metal) * (1 - m->transmission_weight);
    m->glass = (1 - m->metal) * m->transmission_weight;
    m->rho = m->base_weight * m->base_color;

    // F82: Schlick's curve from rho, less what makes it specular_color times itself at the cosine 1/7
    const float c82 = 1 / 7.0f, w82 = schlick_weight(c82), bump = c82 * (1 - c82) * w82;
    m->edge = (m->rho + (1 - m->rho) * w82) * (1 - m->specular_color) / bump;

    // specular_weight scales F0; under a coat the index is relative to it
    float under = sr_lerp(m->coat_weight, m->specular_ior, m->specular_ior / m->coat_ior);
    under = under < 1 ? 1 / under : under;
    float e = sqrtf(sr_min(m->specular_weight * normal_reflectance(m->specular_ior), 0.8f));
    float e_s = sqrtf(sr_min(m->specular_weight * normal_reflectance(under), 0.8f));
    m->eta = (1 + e) / (1 - e);
    m->pane = m->thin_walled > 0.5f && m->eta > 1 ? m->eta : 0;
    if (m->pane > 0 || m->eta < 1 + 1e-3f) // turns light by less than slopes of floats tell
        m->eta = 1;
    m->eta_s = (1 + e_s) / (1 - e_s);
    m->gloss0 = normal_reflectance(m->eta_s);
    if (m->film_weight > 0) {
        m->lambda = at->lambda;
        float a = normal_reflectance(m->film_ior), b = normal_reflectance(m->eta_s / m->film_ior);
        m->gloss0 = sr_lerp(m->film_weight, m->gloss0, (a + b - 2 * a * b) / (1 - a * b));
    }

    float r2 = sr_sqr(m->specular_roughness), c2 = sr_sqr(m->coat_roughness);
    float rough = sqrtf(sqrtf(sr_min(1, r2 * r2 + 2 * c2 * c2)));
    m->ggx = ggx_of(sr_lerp(m->coat_weight, m->specular_roughness, rough), m->specular_roughness_anisotropy);
    m->coat = ggx_of(m->coat_roughness, 0);
    m->alpha = sqrtf(m->ggx.alpha_x * m->ggx.alpha_y);
    m->coat_alpha = m->coat.alpha_x;
    m->gloss_mean = 1 / mean_transmittance(m->alpha, m->gloss0);
    m->coat0 = normal_reflectance(m->coat_ior);
    m->coat_mean = m->coat_inside = 1;
    m->absorb = SR_BLACK;
    if (m->coat_weight > 0) {
        m->coat_mean = 1 / mean_transmittance(m->coat_alpha, m->coat0);
        m->coat_inside = (float)sr_fresnel_diffuse(1 / (double)m->coat_ior);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            m->absorb[i] = 0.5f * logf(sr_max(m->coat_color[i], 1e-6f));
    }

    float k1 = 0.5f - 2 / (3 * SR_PI), k2 = 2 / 3.0f - 28 / (15 * SR_PI), r = m->base_diffuse_roughness;
    m->A = 1 / (1 + k1 * r);
    float lost = (k1 - k2) * r * m->A; // by the first scattering, on the mean
    m->again = SR_BLACK;
    if (lost > 0)
        m->again = m->rho * m->rho * ((1 - lost) * SR_INV_PI / lost) / (1 - m->rho * lost);
    m->fuzz = charlie_of(m->fuzz_roughness);
}

static uint32_t lobes(const void *self)
{
    const struct openpbr *m = self;
    return SR_LOBE_REFLECTION | SR_LOBE_GLOSSY | (m->gloss > 0 ? SR_LOBE_DIFFUSE : 0) |
           (m->glass > 0 ? SR_LOBE_TRANSMISSION : 0) | (m->glass > 0 && m->eta == 1 ? SR_LOBE_SPECULAR : 0);
}

/* ---- lobes ---- */

static float eon_missing(const struct openpbr *m, float mu) // of the first scattering's albedo
{
    float S = sr_safe_sqrt((1 - mu) * (1 + mu));
    float G = S * (atan2f(S, mu) - S * mu) + (2 / 3.0f) * S * (mu * (1 + S + S * S) / (1 + S) - 1);
    return sr_max(0, m->base_diffuse_roughness * m->A * (0.5f - 2 / (3 * SR_PI) - SR_INV_PI * G));
}
static sr_spectrum eon(const struct openpbr *m, sr_vec3 wo, sr_vec3 wi, float co, float ci)
{
    float s = wo.x * wi.x + wo.y * wi.y;
    float first = SR_INV_PI * m->A * sr_max(0, 1 + m->base_diffuse_roughness * s / (s > 0 ? sr_max(co, ci) : 1));
    sr_spectrum value = m->rho * first;
    if (m->base_diffuse_roughness > 0)
        value += m->again * (eon_missing(m, co) * eon_missing(m, ci));
    return value;
}

/* Reflectance of the film on a base of real index n, for light that comes at the cosine c. */
static sr_spectrum film(const struct openpbr *m, sr_spectrum n, float c)
{
    c = sr_max(c, 1e-3f); // where all is reflected, phases are 0 / 0
    float s2 = (1 - c) * (1 + c), n1 = m->film_ior, c1 = sr_safe_sqrt(1 - s2 / (n1 * n1));
    float s01 = (c - n1 * c1) / (c + n1 * c1), p01 = (n1 * c - c1) / (n1 * c + c1);
    sr_spectrum R;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        float c2 = sr_safe_sqrt(1 - s2 / (n[i] * n[i])),
              twice = 2 * cosf(4 * SR_PI * n1 * (1e3f * m->film_um) * c1 / m->lambda[i]);
        float s12 = (n1 * c1 - n[i] * c2) / (n1 * c1 + n[i] * c2), p12 = (n[i] * c1 - n1 * c2) / (n[i] * c1 + n1 * c2);
        float s = s01 * s12, p = p01 * p12;
        R[i] = 0.5f * ((s01 * s01 + s12 * s12 + s * twice) / (1 + s * s + s * twice) +
                       (p01 * p01 + p12 * p12 + p * twice) / (1 + p * p + p * twice));
    }
    return sr_spectrum_clamp(R, 0, 1);
}

static sr_spectrum metal_fresnel(const struct openpbr *m, float c)
{
    sr_spectrum F = m->rho + (1 - m->rho) * schlick_weight(c) - m->edge * (c * (1 - c) * schlick_weight(c));
    return sr_spectrum_clamp(F * sr_min(m->specular_weight, 1), 0, 1);
}

static float pane_reflectance(const struct openpbr *m, float c)
{
    float unused, F = fresnel_and_cos(c, m->pane, &unused);
    return 2 * F / (1 + F);
}

/* Reflectances of a facet seen at the cosine c, without and with the glass, and the share of samples that pass through.
 */
struct facet {
    sr_spectrum metal, all; // [1] metal: its share counted
    sr_spectrum gloss;      // [1] Fresnel's, or the film's
    float glass;            // [1] the same
    float through;
};
static struct facet facet_of(const struct openpbr *m, float c, bool below)
{
    float unused;
    struct facet f = {.metal = metal_fresnel(m, c), .gloss = SR_BLACK + fresnel_and_cos(c, m->eta_s, &unused)};
    if (m->film_weight > 0) {
        sr_spectrum root = sr_spectrum_sqrt(sr_spectrum_clamp(m->rho, 0, 0.98f));
        f.metal += m->film_weight * (film(m, (1 + root) / (1 - root), c) - f.metal);
        f.gloss += m->film_weight * (film(m, SR_BLACK + m->eta_s, c) - f.gloss);
    }
    f.metal *= m->metal;
    f.glass = m->pane > 0 ? pane_reflectance(m, c) : fresnel_and_cos(c, below ? 1 / m->eta : m->eta, &unused);
    f.all = f.metal + (m->gloss * f.gloss + m->glass * f.glass);
    float T = m->eta == 1 ? 0 : m->glass * (1 - f.glass);
    f.through = T > 0 ? T / (T + sr_spectrum_mean(f.all)) : 0;
    return f;
}

static sr_spectrum coat_transmittance(const struct openpbr *m, float way) // way: 1 / mu, summed
{
    if (sr_spectrum_is_black(m->absorb))
        return SR_ONE;
    return sr_spectrum_exp(m->absorb * way);
}
static float inside_coat(const struct openpbr *m, float c) // 1 / mu
{
    return 1 / sqrtf(1 - (1 - c) * (1 + c) / (m->coat_ior * m->coat_ior));
}
/* d above, for a base of albedo E under a coat that reflects k from inside. */
static sr_spectrum darkening(const struct openpbr *m, float k, sr_spectrum E)
{
    return 1 + m->coat_darkening * ((1 - k) / (1 - k * E) - 1);
}

struct choice { // [1] probabilities
    float fuzz, coat, diffuse, straight, specular;
};
static struct choice choices(const struct openpbr *m, float co, bool below)
{
    float opaque = below ? m->metal + m->gloss : 1, unused;
    float F = fresnel_and_cos(co, m->eta_s, &unused);
    struct choice c = {.diffuse = m->gloss * sr_spectrum_mean(m->rho),
                       .straight = m->eta == 1 ? m->glass : 0,
                       .specular = m->metal * sr_spectrum_mean(m->rho) + m->gloss * F + 1e-3f};
    float straight = m->pane > 0 ? 1 - pane_reflectance(m, co) : 1;
    c.straight *= straight;
    if (m->eta != 1 || m->pane > 0)
        c.specular += m->glass * (m->eta != 1 ? 1 : 1 - straight);
    if (m->film_weight > 0)
        c.specular += m->film_weight * (m->gloss * m->gloss0 + 0.2f * m->metal);
    if (m->fuzz_weight > 0)
        c.fuzz = opaque * m->fuzz_weight * look_up(FUZZ, m->fuzz.alpha, co);
    if (m->coat_weight > 0)
        c.coat = opaque * m->coat_weight * gloss_albedo(m->coat_alpha, m->coat0, co);
    float sum = 1 / (c.fuzz + c.coat + c.diffuse + c.straight + c.specular);
    return (struct choice){c.fuzz * sum, c.coat * sum, c.diffuse * sum, c.straight * sum, c.specular * sum};
}

/* Transmittance of fuzz and coat for light that the glass lets through, at the cosine outside. */
static sr_spectrum through_layers(const struct openpbr *m, float above)
{
    sr_spectrum T = m->transmission_color;
    if (m->fuzz_weight > 0)
        T *= 1 - m->fuzz_weight * sr_min(1, look_up(FUZZ, m->fuzz.alpha, above));
    if (m->coat_weight > 0)
        T *=
            1 +
            m->coat_weight *
                (coat_transmittance(m, inside_coat(m, above)) * (1 - gloss_albedo(m->coat_alpha, m->coat0, above)) - 1);
    return T;
}

static sr_spectrum transmission(const struct openpbr *m, const struct choice *choose, sr_vec3 wo, sr_vec3 wi,
                                enum sr_transport mode, float *pdf)
{
    struct turn t;
    if (!(m->glass > 0) || m->eta == 1 || !turn_at(wo, wi, m->eta, &t))
        return SR_BLACK;
    struct facet facet = facet_of(m, t.cos_o, wo.z < 0);
    float co = fabsf(wo.z), ci = fabsf(wi.z), so = ggx_stretched(m->ggx, wo), si = ggx_stretched(m->ggx, wi);
    float seen = 2 * ggx_D(m->ggx, t.m) * t.cos_o * t.jacobian;
    *pdf = choose->specular * facet.through * seen / (co + so);
    float value = m->glass * (1 - turn_fresnel(&t)) * seen / (so * ci + si * co), above = wo.z > 0 ? co : ci;
    if (mode == SR_RADIANCE)
        value /= t.eta * t.eta;
    return through_layers(m, above) * value;
}

__attribute__((noinline)) static sr_spectrum f_pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                                   float *p)
{
    const struct openpbr *m = self;
    *p = 0;
    if (wo.z == 0 || wi.z == 0)
        return SR_BLACK;
    bool below = wo.z < 0;
    float ci = fabsf(wi.z), co = fabsf(wo.z), c_base, pdf_base;
    struct choice choose = choices(m, co, below);
    if (wo.z * wi.z < 0)
        return transmission(m, &choose, wo, wi, mode, p);
    float shape = ggx_reflection(m->ggx, wo, wi, &pdf_base, &c_base);
    if (!(c_base > 0))
        return SR_BLACK;
    struct facet facet = facet_of(m, c_base, below);
    *p = choose.specular * (1 - facet.through) * pdf_base + choose.diffuse * ci * SR_INV_PI;
    sr_spectrum metal = facet.metal * shape, gloss = m->specular_color * (m->gloss * facet.gloss * shape);
    sr_spectrum inside = m->specular_color * (m->glass * facet.glass * shape);
    sr_spectrum matte = SR_BLACK;
    if (m->gloss > 0)
        matte = eon(m, wo, wi, co, ci) * (m->gloss * m->gloss_mean * (1 - gloss_albedo(m->alpha, m->gloss0, co)) *
                                          (1 - gloss_albedo(m->alpha, m->gloss0, ci)));
    if (!below) { // glass bears the layers on its outside only
        gloss += inside;
        inside = SR_BLACK;
    }
    float opaque = below ? m->metal + m->gloss : 1;
    sr_spectrum value = metal + gloss + matte;
    if (m->coat_weight > 0) {
        float pdf_c, c, unused, shape_c = ggx_reflection(m->coat, wo, wi, &pdf_c, &c);
        float Ti = 1 - gloss_albedo(m->coat_alpha, m->coat0, ci), To = 1 - gloss_albedo(m->coat_alpha, m->coat0, co);
        float mirror = sqrtf(fresnel_and_cos(ci, m->coat_ior, &unused) * fresnel_and_cos(co, m->coat_ior, &unused));
        float k = sr_lerp(m->specular_roughness, mirror, m->coat_inside), through = sr_min(Ti, To);
        sr_spectrum under = metal * (darkening(m, k, m->rho) * through) +
                            gloss * (darkening(m, k, SR_BLACK + m->gloss0) * through) +
                            matte * (darkening(m, m->coat_inside, m->rho) * (Ti * To * m->coat_mean));
        under *= coat_transmittance(m, inside_coat(m, ci) + inside_coat(m, co));
        value += m->coat_weight * (under - value);
        value += m->coat_weight * opaque * fresnel_and_cos(c, m->coat_ior, &unused) * shape_c;
        *p += choose.coat * pdf_c;
    }
    if (m->fuzz_weight > 0) {
        float E = sr_max(look_up(FUZZ, m->fuzz.alpha, ci), look_up(FUZZ, m->fuzz.alpha, co));
        value *= 1 - m->fuzz_weight * sr_min(E, 1);
        value += m->fuzz_color * (opaque * m->fuzz_weight * charlie_D(&m->fuzz, wo, wi) * estevez_V(&m->fuzz, ci, co));
        *p += choose.fuzz * (SR_INV_PI / 2);
    }
    return value + inside;
}

static sr_spectrum f(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float unused;
    return sr_bsdf_openpbr.f_pdf(self, wo, wi, mode, &unused); // the same machine code: the same bits
}

static float pdf(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    float p;
    sr_bsdf_openpbr.f_pdf(self, wo, wi, mode, &p);
    return p;
}

static bool sample(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s)
{
    const struct openpbr *m = self;
    if (wo.z == 0)
        return false;
    bool below = wo.z < 0, transmits = false;
    sr_vec3 up = below ? sr_neg(wo) : wo;
    struct choice choose = choices(m, up.z, below);
    *s = (struct sr_bsdf_sample){.eta = 1, .lobe = SR_LOBE_REFLECTION | SR_LOBE_GLOSSY};
    if (u_lobe < choose.fuzz) {
        float z = 1 - u.x, r = sr_safe_sqrt((1 - z) * (1 + z)), sine, cosine;
        sin_cos_turn(u.y, &sine, &cosine);
        s->wi = (sr_vec3){r * cosine, r * sine, z};
    } else if ((u_lobe -= choose.fuzz) < choose.diffuse) {
        s->wi = sr_warp_cosine_hemisphere(u);
        s->lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
    } else if ((u_lobe -= choose.diffuse) < choose.straight) {
        s->wi = sr_neg(wo);
        s->lobe = SR_LOBE_TRANSMISSION | SR_LOBE_SPECULAR;
        s->pdf = choose.straight;
        s->f = through_layers(m, up.z) * (m->glass / up.z * (m->pane > 0 ? 1 - pane_reflectance(m, up.z) : 1));
        return true;
    } else if ((u_lobe -= choose.straight) < choose.coat)
        s->wi = sr_reflect(up, ggx_sample_visible(m->coat, up, u));
    else {
        float rest = (u_lobe - choose.coat) / choose.specular, cos_t, eta = below ? 1 / m->eta : m->eta;
        sr_vec3 h = ggx_sample_visible(m->ggx, up, u);
        float c = sr_dot(up, h);
        if (!(c > 0))
            return false;
        transmits = rest < facet_of(m, c, below).through;
        if (transmits) {
            fresnel_and_cos(c, eta, &cos_t);
            s->wi = sr_mad(sr_scale(-1 / eta, up), c / eta - cos_t, h);
            s->eta = eta;
            s->lobe = SR_LOBE_TRANSMISSION | SR_LOBE_GLOSSY;
        } else
            s->wi = sr_reflect(up, h);
    }
    if (s->wi.z == 0 || (s->wi.z < 0) != transmits)
        return false;
    s->wi = sr_normalize(below ? sr_neg(s->wi) : s->wi);
    s->f = sr_bsdf_openpbr.f_pdf(self, wo, s->wi, mode, &s->pdf);
    return s->pdf > 0 && s->pdf < INFINITY;
}

const struct sr_bsdf_model sr_bsdf_openpbr = {
    .name = "openpbr",
    .title = "OpenPBR surface 1.1",
    .source = "OpenPBR Surface 1.1, Academy Software Foundation, 2024",
    .limits = "layers are joined by their directional albedos, not solved; no subsurface scattering, volumes or "
              "dispersion; fuzz is Charlie's",
    .params = params,
    .size = sizeof(struct openpbr),
    .load = load,
    .ready = ready,
    .lobes = lobes,
    .f = f,
    .pdf = pdf,
    .sample = sample,
    .f_pdf = f_pdf,
    .largest_albedo = 1.1f,
};
