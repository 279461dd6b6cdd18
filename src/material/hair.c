/* SPDX-License-Identifier: MIT */
/* Hair and fur on curves, which are struck at h = 2 v - 1 radii from their axis; on other shapes likewise by their v.
 *
 * What absorbs inside is told as such (sigma_a), by the colour of a head of such hair (reflectance; color is its older
 * name), or by what nature dyes hair with, whose absorption for red, green and blue,
 *
 *     sigma_a = eumelanin (0.419, 0.697, 1.37) + pheomelanin (0.187, 0.4, 1.05)      [1/radius]
 *
 * becomes a spectrum as any unbounded RGB of sRGB does; eumelanin 1.3, which is brown, where nothing is told. The first
 * that is given counts. d'Eon et al. 2011; Pharr, Jakob & Humphreys 2023, 9.9. The fibre's axis is the tangent dp/du.
 */
#include "material/private.h"

struct hair {
    struct bound_spectrum sigma_a, reflectance;
    struct sr_texture color;
    struct bound_float eumelanin, pheomelanin, eta, beta_m, beta_n, alpha;
    struct sr_spd melanin; // where both concentrations are the same everywhere
};

#define OFFSET(member) offsetof(struct hair, member)
static const struct sr_param params[] = {
    {SR_PARAM_UNBOUNDED_TEXTURE, "sigma_a", "1/radius", 0, INFINITY, NAN, OFFSET(sigma_a.texture), "absorption inside"},
    {SR_PARAM_ALBEDO_TEXTURE, "reflectance", "1", 0, 1, NAN, OFFSET(reflectance.texture),
     "colour of a head of such hair, in place of sigma_a"},
    {SR_PARAM_ALBEDO_TEXTURE, "color", "1", 0, 1, NAN, OFFSET(color), "the same, where there is no reflectance"},
    {SR_PARAM_FLOAT_TEXTURE, "eumelanin", "1", 0, INFINITY, NAN, OFFSET(eumelanin.texture),
     "concentration of what makes hair brown and black; 0.3 blond, 1.3 brown, 8 black"},
    {SR_PARAM_FLOAT_TEXTURE, "pheomelanin", "1", 0, INFINITY, NAN, OFFSET(pheomelanin.texture),
     "concentration of what makes hair yellow and red"},
    {SR_PARAM_FLOAT_TEXTURE, "eta", "1", 1, INFINITY, 1.55, OFFSET(eta.texture), "index of refraction"},
    {SR_PARAM_FLOAT_TEXTURE, "beta_m", "1", 0, 1, 0.3, OFFSET(beta_m.texture), "roughness along the hair"},
    {SR_PARAM_FLOAT_TEXTURE, "beta_n", "1", 0, 1, 0.3, OFFSET(beta_n.texture), "roughness around the hair"},
    {SR_PARAM_FLOAT_TEXTURE, "alpha", "deg", -90, 90, 2, OFFSET(alpha.texture), "tilt of the scales towards the root"},
    {0},
};

static struct sr_spd melanin(float eumelanin, float pheomelanin)
{
    float e = sr_max(eumelanin, 0), p = sr_max(pheomelanin, 0);
    return sr_spd_from_rgb_unbounded(
        SR_SRGB, (struct sr_rgb){0.419f * e + 0.187f * p, 0.697f * e + 0.4f * p, 1.37f * e + 1.05f * p});
}

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    (void)arena, (void)error;
    struct hair *m = self;
    struct sr_spd none = {.kind = SR_SPD_NONE};
    if (!m->reflectance.texture.model)
        m->reflectance.texture = m->color;
    bind_spectrum(&m->sigma_a, none);
    bind_spectrum(&m->reflectance, none);
    bind_float(&m->eumelanin, m->pheomelanin.texture.model ? 0 : 1.3f);
    bind_float(&m->pheomelanin, 0);
    bind_float(&m->eta, 1.55f);
    bind_float(&m->beta_m, 0.3f);
    bind_float(&m->beta_n, 0.3f);
    bind_float(&m->alpha, 2);
    if (m->eumelanin.is_constant && m->pheomelanin.is_constant)
        m->melanin = melanin(m->eumelanin.constant, m->pheomelanin.constant);
    return SR_OK;
}

static const char *remark(const void *self)
{
    const struct hair *m = self;
    bool is_dyed = m->eumelanin.texture.model || m->pheomelanin.texture.model;
    if (m->sigma_a.texture.model && (m->reflectance.texture.model || is_dyed))
        return "sigma_a is given: reflectance, color, eumelanin and pheomelanin are ignored";
    if (m->reflectance.texture.model && is_dyed)
        return "a colour is given: eumelanin and pheomelanin are ignored";
    return NULL;
}

static void bsdf(const void *self, const struct sr_material_context *c, struct sr_bsdf *out)
{
    const struct hair *m = self;
    struct sr_bsdf_hair *b = (void *)out->data;
    *b = (struct sr_bsdf_hair){
        .h = sr_clamp(2 * c->x->uv.y - 1, -1, 1),
        .eta = sr_max(eval_float(&m->eta, c), 1.01f), // something must be reflected and something enter
        .beta_m = sr_clamp(eval_float(&m->beta_m, c), 0.01f, 1),
        .beta_n = sr_clamp(eval_float(&m->beta_n, c), 0.01f, 1),
        .alpha = eval_float(&m->alpha, c),
    };
    if (m->sigma_a.texture.model) {
        b->sigma_a = sr_spectrum_clamp(eval_spectrum(&m->sigma_a, c), 0, INFINITY);
    } else if (m->reflectance.texture.model) {
        b->colour_from = SR_HAIR_FROM_REFLECTANCE;
        b->reflectance = eval_albedo(&m->reflectance, c);
    } else {
        struct sr_spd s = m->melanin.kind != SR_SPD_NONE
                              ? m->melanin
                              : melanin(eval_float(&m->eumelanin, c), eval_float(&m->pheomelanin, c));
        b->sigma_a = sr_spd_eval(&s, c->w->lambda);
    }
    out->model = &sr_bsdf_hair;
    sr_bsdf_hair.ready(b, &(struct sr_bsdf_at){c->w->lambda, c->seed});
}

const struct sr_material_model sr_material_hair = {
    .name = "hair",
    .params = params,
    .size = sizeof(struct hair),
    .prepare = prepare,
    .bsdf = bsdf,
    .remark = remark,
};
