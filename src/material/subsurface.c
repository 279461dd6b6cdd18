/* SPDX-License-Identifier: MIT */
/* Skin, milk, marble: a dielectric boundary, smooth or rough, and light that goes in at one point and comes out at
 * another.
 *
 * The medium below is told by name ("Skin1": measured, as medium/ has them, in 1/mm), by sigma_a and sigma_s [1/m], or
 * by what it looks like: reflectance, the share of entering light that comes out, and mfp, the mean free path [m]. Then
 *
 *     sigma_t = 1 / mfp,   sigma_s = albedo / mfp,   albedo solved from effective(albedo) = reflectance
 *
 * scale multiplies sigma_a and sigma_s, or mfp. A metre is whatever the scene takes for one; of names it is the
 * millimetre. Where nothing is told it is pbrt's default, close to milk. Pharr, Jakob & Humphreys 2016, 11.4.3; the
 * profile is subsurface/'s. */
#include "material/private.h"
#include "medium/medium.h"

struct subsurface {
    const char *name;
    struct bound_spectrum sigma_a, sigma_s; // [1/m]
    struct bound_spectrum reflectance, mfp; // [1], [m]
    float scale, eta, g;                    // [1]
    struct bound_ggx ggx;
    bool remap;
    const struct sr_diffusion *diffusion;
    const char *surplus; // what is given and ignored, or NULL
};

#define OFFSET(member) offsetof(struct subsurface, member)
static const struct sr_param params[] = {
    {SR_PARAM_STRING, "name", "1", 0, 0, NAN, OFFSET(name), "of a measured medium, such as Skin1"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "sigma_a", "1/m", 0, INFINITY, NAN, OFFSET(sigma_a.texture), "absorption"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "sigma_s", "1/m", 0, INFINITY, NAN, OFFSET(sigma_s.texture), "scattering"},
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, NAN, OFFSET(reflectance.texture),
     "share of entering light that comes out, in place of sigma_a and sigma_s"},
    {SR_PARAM_UNBOUNDED_TEXTURE, "mfp", "m", 0, INFINITY, NAN, OFFSET(mfp.texture),
     "mean free path, with reflectance; 1"},
    {SR_PARAM_FLOAT, "scale", "1", 0, INFINITY, 1, OFFSET(scale), "factor of sigma_a and sigma_s, or of mfp"},
    {SR_PARAM_FLOAT, "eta", "1", 0.2, 5, 1.33, OFFSET(eta), "index inside over index outside"},
    {SR_PARAM_FLOAT, "g", "1", -0.999, 0.999, 0, OFFSET(g),
     "mean cosine of scattering; of named media it is in sigma_s already"},
    {SR_PARAM_FLOAT_TEXTURE, "roughness", "1", 0, INFINITY, 0, OFFSET(ggx.roughness), "of both directions"},
    {SR_PARAM_FLOAT_TEXTURE, "uroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.u_roughness), "along the tangent"},
    {SR_PARAM_FLOAT_TEXTURE, "vroughness", "1", 0, INFINITY, NAN, OFFSET(ggx.v_roughness), "across the tangent"},
    {SR_PARAM_BOOL, "remaproughness", "1", 0, 1, 1, OFFSET(remap),
     "alpha is the root of roughness; else roughness itself"},
    {0},
};

static bool is_named(const struct subsurface *m)
{
    return m->name && m->name[0];
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct subsurface *m = self;
    struct sr_spd sigma_a = sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){0.0011f, 0.0024f, 0.014f});
    struct sr_spd sigma_s = sr_spd_from_rgb_unbounded(SR_SRGB, (struct sr_rgb){2.55f, 3.21f, 3.77f});
    if (is_named(m)) {
        if (!sr_medium_preset(m->name, &sigma_a, &sigma_s))
            return sr_fail(error, SR_ERROR_INPUT,
                           "there is no medium named \"%s\"; there are \"%s\", \"%s\", \"%s\", …", m->name,
                           sr_medium_preset_name(0), sr_medium_preset_name(1), sr_medium_preset_name(2));
        if (m->sigma_a.texture.model || m->sigma_s.texture.model || m->reflectance.texture.model ||
            m->mfp.texture.model || m->g != 0)
            m->surplus = "the medium is named: sigma_a, sigma_s, reflectance, mfp and g are ignored";
        m->sigma_a.texture = m->sigma_s.texture = m->reflectance.texture = m->mfp.texture =
            (struct sr_texture){NULL, NULL};
        m->g = 0;
    } else if (!m->sigma_a.texture.model != !m->sigma_s.texture.model) {
        return sr_fail(error, SR_ERROR_INPUT, "%s is given without %s",
                       m->sigma_a.texture.model ? "sigma_a" : "sigma_s",
                       m->sigma_a.texture.model ? "sigma_s" : "sigma_a");
    } else if (m->sigma_a.texture.model) {
        if (m->reflectance.texture.model || m->mfp.texture.model)
            m->surplus = "sigma_a and sigma_s are given: reflectance and mfp are ignored";
        m->reflectance.texture = (struct sr_texture){NULL, NULL};
    } else if (m->mfp.texture.model && !m->reflectance.texture.model) {
        m->surplus = "mfp is ignored: it goes with reflectance";
    }
    bind_spectrum(&m->sigma_a, sigma_a);
    bind_spectrum(&m->sigma_s, sigma_s);
    bind_spectrum(&m->reflectance, (struct sr_spd){.kind = SR_SPD_NONE});
    bind_spectrum(&m->mfp, sr_spd_constant(1));
    bind_ggx(&m->ggx, m->remap);
    m->diffusion = sr_diffusion_make((double)m->g, (double)m->eta, arena, error);
    return m->diffusion ? SR_OK : error->status;
}

static const char *remark(const void *self)
{
    return ((const struct subsurface *)self)->surplus;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct subsurface *m = self;
    struct sr_bsdf_dielectric *b = (void *)out->data;
    b->eta = m->eta;
    b->ggx = eval_ggx(&m->ggx, m->remap, c);
    out->model = &sr_bsdf_dielectric;
}

static bool bssrdf(const void *self, const struct sr_material_context *c, struct sr_bssrdf *out)
{
    const struct subsurface *m = self;
    out->diffusion = m->diffusion;
    out->eta = m->eta;
    if (m->reflectance.texture.model) {
        sr_spectrum reflectance = eval_albedo(&m->reflectance, c), mfp = eval_spectrum(&m->mfp, c) * m->scale;
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
            out->albedo[i] = sr_diffusion_albedo(m->diffusion, reflectance[i]);
            out->sigma_t[i] = 1 / sr_max(mfp[i], 1e-9f);
        }
        return true;
    }
    sr_spectrum sigma_a = sr_spectrum_clamp(eval_spectrum(&m->sigma_a, c) * m->scale, 0, 1e9f),
                sigma_s = sr_spectrum_clamp(eval_spectrum(&m->sigma_s, c) * m->scale, 0, 1e9f);
    out->sigma_t = sigma_a + sigma_s;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        out->albedo[i] = out->sigma_t[i] > 0 ? sr_min(sigma_s[i] / out->sigma_t[i], 1) : 0;
    return true;
}

const struct sr_material_model sr_material_subsurface = {
    .name = "subsurface",
    .params = params,
    .size = sizeof(struct subsurface),
    .prepare = prepare,
    .bsdf = bsdf,
    .bssrdf = bssrdf,
    .remark = remark,
    .is_isotropic = true,
};
