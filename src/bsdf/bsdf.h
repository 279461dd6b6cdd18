/* SPDX-License-Identifier: MIT */
/* How matter scatters light at a point: one file a model, nothing but numbers in and out.
 *
 * Directions are in the local frame: normal +z, tangent +x; wo toward the viewer, wi toward the light, both pointing
 * away from the surface. f is in sr^-1, without the cosine. Where light passes into another medium, f is the radiance
 * form (with the factor eta^2) when mode is SR_RADIANCE, and the form for light paths when SR_IMPORTANCE. */
#ifndef SR_BSDF_BSDF_H
#define SR_BSDF_BSDF_H

#include "sample/sample.h"
#include "spectrum/spectrum.h"

enum sr_transport { SR_RADIANCE, SR_IMPORTANCE };

/* What a BSDF consists of, and what a sample is. */
enum {
    SR_LOBE_REFLECTION = 1,
    SR_LOBE_TRANSMISSION = 2,
    SR_LOBE_DIFFUSE = 4,
    SR_LOBE_GLOSSY = 8,
    SR_LOBE_SPECULAR = 16, // delta functions: f and pdf are 0, only sample finds them
};

struct sr_bsdf_sample {
    sr_vec3 wi;
    sr_spectrum f; // [1/sr]; for delta lobes f / pdf * |cos_theta_i| is the weight
    float pdf;     // [1/sr]; for delta lobes the probability of the lobe
    float eta;     // [1] relative index on the path's way if the sample is a transmission into another medium, else 1
    uint32_t lobe; // SR_LOBE_* of what was drawn
    bool pdf_is_proportional; // f and pdf share an unknown factor (random walks): use pdf() for weighing
};

#define SR_BSDF_SIZE                                                                                                   \
    (48 * sizeof(float) + 10 * sizeof(sr_spectrum)) // [B] of the largest model's data: 512 for 8 wavelengths

/* What a model may want to know of the path, besides its parameters. */
struct sr_bsdf_at {
    sr_spectrum lambda; // [nm]
    uint32_t seed;      // of this vertex: f of a random walk
};

/* A model is one file. Its table is all that scene files, laboratory, documents and tests know of its parameters; the
 * kinds are FLOAT (float), INT and ENUM (int32_t), BOOL (bool), FILE (const char *), ALBEDO and UNBOUNDED (sr_spectrum,
 * already at the path's wavelengths). Every parameter has a finite default inside its range. */
struct sr_bsdf_model {
    const char *name;   // hapke: the word of scene files and of the laboratory
    const char *title;  // "Hapke 1981, with roughness"
    const char *source; // "B. Hapke, Bidirectional reflectance spectroscopy, 1981, eq. 16"; NULL: see the file's head
    const char *limits; // one sentence: where the model must not be trusted; NULL: nowhere
    const struct sr_param *params;
    size_t size; // <= SR_BSDF_SIZE
    /* Once for a material, when its FILE members are known: reads files, fills in pointers to what lasts as long as the
     * arena. Sees the numbers of INT, ENUM, BOOL and FILE rows only. NULL: nothing to do. */
    sr_status (*load)(void *self, struct sr_arena *arena, struct sr_error *error);
    /* At each hit, when the table's members are filled in, before any other call: what follows from them and is needed
     * often. Parameters that a texture has driven out of their range are in it again. NULL: nothing to do. */
    void (*ready)(void *self, const struct sr_bsdf_at *at);
    uint32_t (*lobes)(const void *self);
    sr_spectrum (*f)(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode);
    float (*pdf)(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode);
    bool (*sample)(const void *self, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                   struct sr_bsdf_sample *s);
    /* f and pdf at once, where sharing work pays; NULL: the two are called. Must equal them bit for bit. */
    sr_spectrum (*f_pdf)(const void *self, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode, float *pdf);
    /* directional albedo E(wo) per wavelength, in the form for importance, where a closed form is known; NULL, or NaN
     * for these parameters: nobody knows one. */
    sr_spectrum (*albedo)(const void *self, sr_vec3 wo);
    bool is_random; // f is itself an unbiased estimate: it depends on a seed in the data (for some parameters; pdf is a
                    // plain function, but where sample says pdf_is_proportional it serves for weighing only)
    /* What a model breaks by its nature, as documented amounts that a certificate measures against; 0: it keeps the
     * law. */
    float asymmetry;      // [1] most |f(a, b) - f(b, a)| / the larger of them, over its parameters
    float largest_albedo; // [1] most light that it returns for 1 that arrives, where above 1
};

/* The models: a new one is its file and its line here. */
#define SR_BSDF_MODELS(X)                                                                                              \
    X(diffuse)                                                                                                         \
    X(diffuse_transmission)                                                                                            \
    X(oren_nayar)                                                                                                      \
    X(eon)                                                                                                             \
    X(minnaert)                                                                                                        \
    X(phong_modified)                                                                                                  \
    X(blinn_phong)                                                                                                     \
    X(ashikhmin_shirley)                                                                                               \
    X(lafortune)                                                                                                       \
    X(poulin_fournier)                                                                                                 \
    X(strauss)                                                                                                         \
    X(coupled)                                                                                                         \
    X(lommel_seeliger)                                                                                                 \
    X(lunar)                                                                                                           \
    X(dust)                                                                                                            \
    X(hapke)                                                                                                           \
    X(spectralon)                                                                                                      \
    X(abg)                                                                                                             \
    X(harvey)                                                                                                          \
    X(conductor)                                                                                                       \
    X(dielectric)                                                                                                      \
    X(microfacet)                                                                                                      \
    X(beckmann_conductor)                                                                                              \
    X(cook_torrance)                                                                                                   \
    X(he)                                                                                                              \
    X(torrance_sparrow)                                                                                                \
    X(ward)                                                                                                            \
    X(ward_duer)                                                                                                       \
    X(ward_gmd)                                                                                                        \
    X(microfacet_dielectric)                                                                                           \
    X(beckmann_dielectric)                                                                                             \
    X(ggx_conductor_ms)                                                                                                \
    X(ggx_dielectric_ms)                                                                                               \
    X(thin_dielectric)                                                                                                 \
    X(coated_diffuse)                                                                                                  \
    X(coated_conductor)                                                                                                \
    X(thin_film_conductor)                                                                                             \
    X(thin_film_dielectric)                                                                                            \
    X(multilayer_conductor)                                                                                            \
    X(multilayer_dielectric)                                                                                           \
    X(measured)                                                                                                        \
    X(sheen)                                                                                                           \
    X(sheen_ltc)                                                                                                       \
    X(disney)                                                                                                          \
    X(hair)                                                                                                            \
    X(principled)                                                                                                      \
    X(openpbr)

#define SR_BSDF_DECLARE(name) extern const struct sr_bsdf_model sr_bsdf_##name;
SR_BSDF_MODELS(SR_BSDF_DECLARE)
extern const struct sr_bsdf_model *const sr_bsdf_models[]; // in the order of the list; ends with NULL
const struct sr_bsdf_model *sr_bsdf_model_find(const char *name);

/* A BSDF at a point: plain data, no pointers to temporaries. */
struct sr_bsdf {
    const struct sr_bsdf_model *model; // NULL: the surface does not scatter, light passes as if it were not there
    _Alignas(64) unsigned char data[SR_BSDF_SIZE];
};

/* Before a call that returns a spectrum compilers leave the upper halves of the vector registers as they are, because
 * of the value that will come back in them; the mathematical library's plain functions are several times slower then.
 */
static inline void sr_bsdf_clean_vectors(void)
{
#ifdef __AVX__
    __builtin_ia32_vzeroupper();
#endif
}

/* Lambert's law, f = rho / pi, in line since most surfaces have it: the model of diffuse.c is these three. */
struct sr_bsdf_diffuse {
    sr_spectrum reflectance; // [1] rho
};
static inline uint32_t sr_diffuse_lobes(const struct sr_bsdf_diffuse *m)
{
    return sr_spectrum_is_black(m->reflectance) ? 0 : SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
}
static inline sr_spectrum sr_diffuse_f_pdf(const struct sr_bsdf_diffuse *m, sr_vec3 wo, sr_vec3 wi, float *pdf)
{
    bool is_reflected = sr_same_hemisphere(wo, wi);
    *pdf = is_reflected ? fabsf(wi.z) * SR_INV_PI : 0;
    return m->reflectance * (is_reflected ? SR_INV_PI : 0);
}
static inline bool sr_diffuse_sample(const struct sr_bsdf_diffuse *m, sr_vec3 wo, sr_vec2 u, struct sr_bsdf_sample *s)
{
    sr_vec3 wi = sr_warp_cosine_hemisphere(u);
    wi.z = copysignf(wi.z, wo.z);
    s->wi = wi;
    s->f = m->reflectance * SR_INV_PI;
    s->pdf = fabsf(wi.z) * SR_INV_PI;
    s->eta = 1;
    s->lobe = SR_LOBE_REFLECTION | SR_LOBE_DIFFUSE;
    s->pdf_is_proportional = false;
    return s->pdf > 0 && wo.z != 0 && sr_diffuse_lobes(m);
}

static inline bool sr_bsdf_is_diffuse(const struct sr_bsdf *b)
{
    return SR_LIKELY(b->model == &sr_bsdf_diffuse);
}
static inline uint32_t sr_bsdf_lobes(const struct sr_bsdf *b)
{
    return sr_bsdf_is_diffuse(b) ? sr_diffuse_lobes((const void *)b->data) : b->model->lobes(b->data);
}
static inline sr_spectrum sr_bsdf_f(const struct sr_bsdf *b, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    sr_bsdf_clean_vectors();
    return b->model->f(b->data, wo, wi, mode);
}
static inline float sr_bsdf_pdf(const struct sr_bsdf *b, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode)
{
    return b->model->pdf(b->data, wo, wi, mode);
}
static inline sr_spectrum sr_bsdf_f_pdf(const struct sr_bsdf *b, sr_vec3 wo, sr_vec3 wi, enum sr_transport mode,
                                        float *pdf)
{
    if (sr_bsdf_is_diffuse(b))
        return sr_diffuse_f_pdf((const void *)b->data, wo, wi, pdf);
    sr_bsdf_clean_vectors();
    if (b->model->f_pdf)
        return b->model->f_pdf(b->data, wo, wi, mode, pdf);
    *pdf = b->model->pdf(b->data, wo, wi, mode);
    return b->model->f(b->data, wo, wi, mode);
}
static inline bool sr_bsdf_sample(const struct sr_bsdf *b, sr_vec3 wo, float u_lobe, sr_vec2 u, enum sr_transport mode,
                                  struct sr_bsdf_sample *s)
{
    return sr_bsdf_is_diffuse(b) ? sr_diffuse_sample((const void *)b->data, wo, u, s)
                                 : b->model->sample(b->data, wo, u_lobe, u, mode, s);
}

/* Fresnel reflectance, unpolarised. eta = index behind the surface / index on wo's side; cos_theta signed: negative
 * means from behind. */
float sr_fresnel_dielectric(float cos_theta_i, float eta);
sr_spectrum sr_fresnel_conductor(float cos_theta_i, sr_spectrum eta, sr_spectrum k);
/* Reflectance of a dielectric for Lambertian incidence from the thin side, n > 1 (Walsh 1926); from inside: 1 -
 * (1-F)/n^2 */
double sr_fresnel_diffuse(double n);
/* Snell's law about the normal n; false at total reflection. *eta_path is the relative index along the way of wt. */
bool sr_refract(sr_vec3 wi, sr_vec3 n, float eta, float *eta_path, sr_vec3 *wt);
static inline sr_vec3 sr_reflect(sr_vec3 wo, sr_vec3 n)
{
    return sr_sub(sr_scale(2 * sr_dot(wo, n), n), wo);
}

/* Trowbridge-Reitz (GGX) microfacets, anisotropic, Smith height-correlated. */
struct sr_ggx {
    float alpha_x, alpha_y; // [1] slope widths
};
bool sr_ggx_is_smooth(struct sr_ggx g); // so smooth that it counts as a mirror: max alpha < 1e-3
// the functions below raise each alpha to 1e-4 at least
float sr_ggx_D(struct sr_ggx g, sr_vec3 wm);                      // [1/sr]
float sr_ggx_G1(struct sr_ggx g, sr_vec3 w);                      // [1]
float sr_ggx_G(struct sr_ggx g, sr_vec3 wo, sr_vec3 wi);          // [1]
float sr_ggx_visible_pdf(struct sr_ggx g, sr_vec3 w, sr_vec3 wm); // [1/sr] of visible normals
sr_vec3 sr_ggx_sample_visible(struct sr_ggx g, sr_vec3 w, sr_vec2 u);
float sr_ggx_roughness_to_alpha(float roughness); // pbrt's: sqrt(roughness)

/* Plain data of the models that materials of their own fill in; all others keep theirs in their file, filled in by the
 * table. Each spectrum is at the path's wavelengths. */
struct sr_bsdf_diffuse_transmission {
    sr_spectrum reflectance, transmittance; // [1]
};
struct sr_bsdf_conductor {
    sr_spectrum eta, k; // [1] relative to the outside
    struct sr_ggx ggx;
};
struct sr_bsdf_dielectric {
    float eta; // [1] inside over outside
    struct sr_ggx ggx;
};
struct sr_bsdf_thin_dielectric {
    float eta;         // [1]
    bool sums_as_pbrt; // the bounces in the pane are summed for the mean of the polarisations, as pbrt-v4 does, not for
                       // each: T is too small by up to 0.02. For comparing images only.
};
/* A dielectric coat over a base, with an optional medium between (position-free random walk, Guo, Hasan & Zhao 2018).
 */
struct sr_bsdf_coated {
    sr_spectrum base_reflectance; // [1]  coateddiffuse
    sr_spectrum base_eta, base_k; // [1]  coatedconductor, relative to the coat
    sr_spectrum albedo;           // [1]  single-scattering albedo of the medium; black: it only absorbs
    struct sr_ggx coat_ggx, base_ggx;
    float coat_eta;  // [1]
    float thickness; // [1] optical: in units of the medium's mean free path
    float g;         // [1] Henyey-Greenstein
    int32_t max_depth, sample_count;
    uint32_t seed;       // of this vertex: f is a random walk
    bool weighs_as_pbrt; // reproduces a bias of pbrt-v4: light through a rough coat is 2 to 12 % too bright (of f, not
                         // of sample). For comparing images only.
};

/* A fibre along x; what stands below `derived` is made by the model's ready. */
enum { SR_HAIR_FROM_SIGMA_A, SR_HAIR_FROM_REFLECTANCE, SR_HAIR_FROM_MELANIN };
enum { SR_HAIR_LOBES = 4 }; // R, TT, TRT, the rest
struct sr_bsdf_hair {
    sr_spectrum sigma_a;          // [1/radius]
    sr_spectrum reflectance;      // [1]
    float h, eta, beta_m, beta_n; // [1]
    float eumelanin, pheomelanin; // [1] concentrations
    float alpha;                  // [deg]
    int32_t colour_from;
    // derived
    sr_spectrum sigma;                 // [1/radius]
    float v[SR_HAIR_LOBES], s, s_norm; // s_norm: share of the logistic that lies within one turn
    float sin_tilt[3], cos_tilt[3];
    float gamma_o; // [rad]
};

/* How light that has wandered below a surface leaves it: f = T(theta_i) / (pi (1 - F_diffuse)), whatever wo above.
 * Belongs to the material "subsurface" and stands in no list. */
struct sr_bsdf_exit {
    float eta;   // [1] inside over outside
    float scale; // [1/sr] 1 / (pi INTEGRAL T cos / pi dw)
};
extern const struct sr_bsdf_model sr_bsdf_exit;
void sr_bsdf_exit_make(struct sr_bsdf *b, float eta);

#endif
