/* SPDX-License-Identifier: MIT */
/* Materials of glTF as "openpbr": the table of docs/guide/gltf.md.
 *
 *     metallic-roughness:  base_color, base_metalness, specular_roughness; F0 by the index of refraction, 1.5
 *     anisotropy s:        a_t = lerp(r^2, 1, s^2), a_b = r^2,
 *                          as r' sqrt(2 / (1 + (1 - a)^2)) = a_t, a = 1 - a_b / a_t
 *     specular-glossiness: F0 = max(specular) as an index of refraction, its tint as specular_color,
 *                          roughness = 1 - glossiness
 *     volume:              sigma_a = -ln(attenuationColor) / attenuationDistance                        [1/m]
 *
 * glTF 2.0, 3.9 and appendix B; the extensions KHR_materials_*. What has no counterpart is told by its name. */
#include "import/gltf/gltf.h"

#include "medium/medium.h"

#include <string.h>

/* ---- reading ---- */

static void numbers3(struct sr_gltf *g, const struct sr_gltf_at *at, const char *key, double out[3])
{
    sr_gltf_numbers(g, at, key, 3, out);
    for (int i = 0; i < 3; ++i)
        out[i] = out[i] >= 0 ? out[i] : 0;
}

static void read_layers(struct sr_gltf *g, struct sr_gltf_look *m)
{
    struct sr_gltf_at at = sr_gltf_extension(g, &m->at, "KHR_materials_clearcoat");
    m->coat = sr_gltf_number(g, &at, "clearcoatFactor", 0, 0, 1);
    m->coat_roughness = sr_gltf_number(g, &at, "clearcoatRoughnessFactor", 0, 0, 1);
    m->coat_texture = sr_gltf_texture(g, &at, "clearcoatTexture");
    m->coat_roughness_texture = sr_gltf_texture(g, &at, "clearcoatRoughnessTexture");
    m->coat_normal_texture = sr_gltf_texture(g, &at, "clearcoatNormalTexture");
    at = sr_gltf_extension(g, &m->at, "KHR_materials_sheen");
    numbers3(g, &at, "sheenColorFactor", m->sheen);
    m->sheen_roughness = sr_gltf_number(g, &at, "sheenRoughnessFactor", 0, 0, 1);
    m->sheen_texture = sr_gltf_texture(g, &at, "sheenColorTexture");
    m->sheen_roughness_texture = sr_gltf_texture(g, &at, "sheenRoughnessTexture");
    at = sr_gltf_extension(g, &m->at, "KHR_materials_iridescence");
    m->film = sr_gltf_number(g, &at, "iridescenceFactor", 0, 0, 1);
    m->film_ior = sr_gltf_number(g, &at, "iridescenceIor", 1.3, 1, 10);
    m->film_nm[0] = sr_gltf_number(g, &at, "iridescenceThicknessMinimum", 100, 0, 1e6);
    m->film_nm[1] = sr_gltf_number(g, &at, "iridescenceThicknessMaximum", 400, 0, 1e6);
    m->film_texture = sr_gltf_texture(g, &at, "iridescenceTexture");
    m->film_thickness_texture = sr_gltf_texture(g, &at, "iridescenceThicknessTexture");
    at = sr_gltf_extension(g, &m->at, "KHR_materials_anisotropy");
    m->anisotropy = sr_gltf_number(g, &at, "anisotropyStrength", 0, 0, 1);
    m->anisotropy_rotation = sr_gltf_number(g, &at, "anisotropyRotation", 0, -1e6, 1e6);
    m->anisotropy_texture = sr_gltf_texture(g, &at, "anisotropyTexture");
}

static void read_volume(struct sr_gltf *g, struct sr_gltf_look *m)
{
    struct sr_gltf_at at = sr_gltf_extension(g, &m->at, "KHR_materials_transmission");
    m->transmission = sr_gltf_number(g, &at, "transmissionFactor", 0, 0, 1);
    m->transmission_texture = sr_gltf_texture(g, &at, "transmissionTexture");
    at = sr_gltf_extension(g, &m->at, "KHR_materials_volume");
    m->is_solid = sr_gltf_number(g, &at, "thicknessFactor", 0, 0, INFINITY) > 0;
    m->attenuation_m = sr_gltf_number(g, &at, "attenuationDistance", INFINITY, 0, INFINITY);
    numbers3(g, &at, "attenuationColor", m->attenuation);
    at = sr_gltf_extension(g, &m->at, "KHR_materials_ior");
    m->ior = sr_gltf_number(g, &at, "ior", 1.5, 0, INFINITY);
    at = sr_gltf_extension(g, &m->at, "KHR_materials_dispersion");
    m->dispersion = sr_gltf_number(g, &at, "dispersion", 0, 0, INFINITY);
    at = sr_gltf_extension(g, &m->at, "KHR_materials_specular");
    m->specular = sr_gltf_number(g, &at, "specularFactor", 1, 0, 1);
    numbers3(g, &at, "specularColorFactor", m->specular_colour);
    m->specular_texture = sr_gltf_texture(g, &at, "specularTexture");
    m->specular_colour_texture = sr_gltf_texture(g, &at, "specularColorTexture");
}

static void read_gloss(struct sr_gltf *g, const struct sr_gltf_at *at, struct sr_gltf_look *m)
{
    double colour[4] = {1, 1, 1, 1}, specular[3] = {1, 1, 1};
    sr_gltf_numbers(g, at, "diffuseFactor", 4, colour);
    numbers3(g, at, "specularFactor", specular);
    m->gloss = sr_gltf_number(g, at, "glossinessFactor", 1, 0, 1);
    m->base_texture = sr_gltf_texture(g, at, "diffuseTexture");
    m->gloss_texture = sr_gltf_texture(g, at, "specularGlossinessTexture");
    memcpy(m->colour, colour, sizeof colour);
    m->metal = 0;
    double most = fmax(specular[0], fmax(specular[1], specular[2])), root = sqrt(fmin(most, 0.249));
    for (int i = 0; i < 3; ++i)
        m->specular_colour[i] = most > 0 ? specular[i] / most : 1;
    m->ior = (1 + root) / (1 - root);
    m->specular = most > 0.249 ? fmin(most / 0.249, 2) : 1; // an index of 3 is the model's greatest, and doubled
    m->is_glossy = true;
    if (most > 0.5)
        sr_gltf_note(g, "KHR_materials_pbrSpecularGlossiness",
                     "reflectances beyond 0.5 at normal incidence are taken as 0.5");
}

/* Material 0 is that of primitives without. */
void sr_gltf_read_look(struct sr_gltf *g, uint32_t material1, struct sr_gltf_look *m)
{
    *m = (struct sr_gltf_look){
        .colour = {1, 1, 1, 1}, .specular_colour = {1, 1, 1}, .attenuation = {1, 1, 1}, .normal_scale = 1};
    if (material1)
        m->at = sr_gltf_entry(g, "materials", material1 - 1);
    struct sr_gltf_at pbr = sr_gltf_object(g, &m->at, "pbrMetallicRoughness");
    sr_gltf_numbers(g, &pbr, "baseColorFactor", 4, m->colour);
    m->metal = sr_gltf_number(g, &pbr, "metallicFactor", 1, 0, 1);
    m->roughness = sr_gltf_number(g, &pbr, "roughnessFactor", 1, 0, 1);
    m->base_texture = sr_gltf_texture(g, &pbr, "baseColorTexture");
    m->metal_texture = sr_gltf_texture(g, &pbr, "metallicRoughnessTexture");
    m->normal_texture = sr_gltf_texture(g, &m->at, "normalTexture");
    m->normal_scale = sr_gltf_number(g, &m->normal_texture.info, "scale", 1, -1e6, 1e6);
    m->is_double_sided = sr_gltf_bool(g, &m->at, "doubleSided", false);
    const char *mode = sr_gltf_string(g, &m->at, "alphaMode");
    m->alpha = !mode || strcmp(mode, "OPAQUE") == 0 ? 0
               : strcmp(mode, "MASK") == 0          ? 1
               : strcmp(mode, "BLEND") == 0         ? 2
                                                    : 3;
    if (m->alpha == 3)
        sr_gltf_fail(g, &m->at, "alphaMode \"%.20s\": expected OPAQUE, MASK or BLEND", mode);
    m->cutoff = sr_gltf_number(g, &m->at, "alphaCutoff", 0.5, 0, INFINITY);
    numbers3(g, &m->at, "emissiveFactor", m->emission);
    m->emission_texture = sr_gltf_texture(g, &m->at, "emissiveTexture");
    struct sr_gltf_at strength = sr_gltf_extension(g, &m->at, "KHR_materials_emissive_strength");
    double factor = sr_gltf_number(g, &strength, "emissiveStrength", 1, 0, 1e30);
    for (int i = 0; i < 3; ++i)
        m->emission[i] *= factor;
    if (json_object_get(m->at.json, "occlusionTexture"))
        sr_gltf_note(g, "occlusionTexture", "not needed, for light is blocked by what is there");
    read_layers(g, m);
    read_volume(g, m);
    struct sr_gltf_at gloss = sr_gltf_extension(g, &m->at, "KHR_materials_pbrSpecularGlossiness");
    struct sr_gltf_at unlit = sr_gltf_extension(g, &m->at, "KHR_materials_unlit");
    if (gloss.json)
        read_gloss(g, &gloss, m);
    m->is_unlit = unlit.json != NULL;
    if (m->is_unlit) {
        memcpy(m->emission, m->colour, sizeof m->emission);
        m->emission_texture = m->base_texture;
    }
    for (int i = 0; i < 4; ++i)
        m->colour[i] = fmin(fmax(m->colour[i], 0), 1);
    m->is_emissive = fmax(m->emission[0], fmax(m->emission[1], m->emission[2])) > 0;
    if (!m->is_emissive)
        m->emission_texture.info.json = NULL;
}

/* All textures that look for coordinates of their own. */
static int textures_of(const struct sr_gltf_look *m, const struct sr_gltf_texture *list[20])
{
    const struct sr_gltf_texture *all[] = {&m->emission_texture,
                                           &m->normal_texture,
                                           &m->base_texture,
                                           &m->metal_texture,
                                           &m->transmission_texture,
                                           &m->specular_texture,
                                           &m->specular_colour_texture,
                                           &m->coat_texture,
                                           &m->coat_roughness_texture,
                                           &m->sheen_texture,
                                           &m->sheen_roughness_texture,
                                           &m->gloss_texture,
                                           &m->film_texture,
                                           &m->film_thickness_texture};
    int n = 0;
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        if (all[i]->info.json)
            list[n++] = all[i];
    return n;
}

struct sr_gltf_needs sr_gltf_needs_of(const struct sr_gltf_look *m)
{
    struct sr_gltf_needs needs = {.uv_transform = {1, 0, 0, 0, 1, 0}};
    const struct sr_gltf_texture *list[20];
    int n = textures_of(m, list);
    needs.mesh_set = n ? list[0]->set : 0;
    for (int i = 0; i < n; ++i)
        needs.uv_sets |= 1u << list[i]->set;
    const double *t = m->emission_texture.transform;
    if (m->emission_texture.info.json && t[0] * t[4] - t[1] * t[3] != 0)
        memcpy(needs.uv_transform, t, sizeof needs.uv_transform);
    needs.tangents = m->normal_texture.info.json || m->anisotropy > 0;
    if (needs.tangents && !n)
        needs.uv_sets = 1;
    return needs;
}

/* ---- composing ---- */

struct maker {
    struct sr_gltf *g;
    const struct sr_gltf_look *m;
    const struct sr_gltf_surface *s;
};

/* What a parameter becomes: the name of a texture, or a number. Textures come before the material that names them. */
struct number {
    const char *texture; // NULL: the value
    double value;
};

static struct number textured(const struct maker *k, const char *what, double factor, const struct sr_gltf_texture *t,
                              const char *channel)
{
    if (!t->info.json || factor == 0)
        return (struct number){NULL, factor};
    double f[3] = {factor, factor, factor};
    return (struct number){sr_gltf_texelmap(k->g, k->s, t, what, channel, f, 0, strcmp(channel, "a") == 0), factor};
}

static void put(const struct maker *k, const char *name, struct number n, double initial)
{
    if (n.texture)
        sr_compose_texture_name(&k->g->c, name, n.texture);
    else if (n.value != initial)
        sr_compose_float(&k->g->c, name, (float)n.value);
}

struct colour {
    const char *texture; // NULL: the value
    double value[3];
};

static struct sr_rgb rgb_of(const double v[3])
{
    return (struct sr_rgb){(float)fmin(v[0], 1), (float)fmin(v[1], 1), (float)fmin(v[2], 1)};
}

static struct colour textured_colour(const struct maker *k, const char *what, const double factor[3],
                                     const struct sr_gltf_texture *t)
{
    struct colour c = {NULL, {factor[0], factor[1], factor[2]}};
    if (t->info.json)
        c.texture = sr_gltf_texelmap(k->g, k->s, t, what, NULL, factor, 0, true);
    return c;
}

static void put_colour(const struct maker *k, const char *name, const struct colour *c)
{
    if (c->texture)
        sr_compose_texture_name(&k->g->c, name, c->texture);
    else
        sr_compose_rgb(&k->g->c, name, rgb_of(c->value));
}

static void put_corners(const struct maker *k)
{
    sr_compose_floats(&k->g->c, SR_PBRT_FLOAT, "values", k->s->corner_colours, 4 * (size_t)k->s->corner_count);
    sr_compose_int(&k->g->c, "components", 4);
}

/* factor x texture x colours of the vertices */
static struct colour base_colour(const struct maker *k)
{
    struct colour c = textured_colour(k, "base_color", k->m->colour, &k->m->base_texture);
    if (!k->s->corner_colours)
        return c;
    struct sr_compose *to = &k->g->c;
    const char *vertex = sr_compose_printf(to, "%s.vertex_color", k->s->name);
    if (sr_gltf_is_new(k->g, vertex)) {
        put_corners(k);
        sr_compose_texture(to, vertex, false, "attribute");
    }
    if (!c.texture && c.value[0] == 1 && c.value[1] == 1 && c.value[2] == 1)
        return (struct colour){.texture = vertex};
    const char *product = sr_compose_printf(to, "%s.base_color*vertex_color", k->s->name);
    if (sr_gltf_is_new(k->g, product)) {
        put_colour(k, "tex1", &c);
        sr_compose_texture_name(to, "tex2", vertex);
        sr_compose_texture(to, product, false, "product");
    }
    return (struct colour){.texture = product};
}

/* The alpha of a primitive: the name of a float texture, or NULL where it is opaque. */
static const char *alpha_of(const struct maker *k)
{
    struct sr_compose *to = &k->g->c;
    if (k->m->alpha == 0)
        return NULL;
    struct number a = textured(k, "alpha", k->m->colour[3], &k->m->base_texture, "a");
    if (k->s->corner_colours) {
        const char *vertex = sr_compose_printf(to, "%s.vertex_alpha", k->s->name),
                   *product = sr_compose_printf(to, "%s.alpha*vertex_alpha", k->s->name);
        if (sr_gltf_is_new(k->g, product)) {
            put_corners(k);
            sr_compose_int(to, "component", 3);
            sr_compose_texture(to, vertex, true, "attribute");
            sr_compose_texture_name(to, "tex", vertex);
            put(k, "scale", a, 1);
            sr_compose_texture(to, product, true, "scale");
        }
        a.texture = product;
    }
    const char *result = sr_compose_printf(to, "%s.opacity", k->s->name);
    if (k->m->alpha == 1) {
        if (sr_gltf_is_new(k->g, result)) {
            put(k, "tex", a, 1);
            sr_compose_float(to, "cutoff", (float)k->m->cutoff);
            sr_compose_texture(to, result, true, "threshold");
        }
        return result;
    }
    if (a.texture || a.value >= 1)
        return a.texture;
    if (sr_gltf_is_new(k->g, result)) {
        sr_compose_float(to, "value", (float)a.value);
        sr_compose_texture(to, result, true, "constant");
    }
    return result;
}

/* normal = (2 texel - 1) (scale, scale, 1), along tangent, bitangent and normal */
static void put_normal(const struct maker *k, const char *const names[3])
{
    static const char *const params[3] = {"normalx", "normaly", "normalz"};
    for (int i = 0; i < 3 && names[0]; ++i)
        sr_compose_texture_name(&k->g->c, params[i], names[i]);
}
static void make_normal(const struct maker *k, const char *names[3])
{
    static const char *const channels[3] = {"r", "g", "b"}, *const what[3] = {"normal.x", "normal.y", "normal.z"};
    for (int i = 0; i < 3 && k->m->normal_texture.info.json; ++i) {
        double scale = i < 2 ? k->m->normal_scale : 1, f[3] = {2 * scale, 0, 0};
        names[i] = sr_gltf_texelmap(k->g, k->s, &k->m->normal_texture, what[i], channels[i], f, -scale, false);
    }
}

/* The medium inside, if light is lost there: its name, or NULL. */
static const char *inside_of(const struct maker *k)
{
    const struct sr_gltf_look *m = k->m;
    double least = fmin(m->attenuation[0], fmin(m->attenuation[1], m->attenuation[2]));
    if (!m->is_solid || m->transmission == 0 || isinf(m->attenuation_m) || least >= 1)
        return NULL;
    if (!sr_medium_model_find("homogeneous")) {
        sr_gltf_warn(k->g, &m->at, "KHR_materials_volume: media are not supported: nothing is lost inside");
        return NULL;
    }
    const char *name = sr_compose_printf(&k->g->c, "%s.volume", k->s->name);
    if (sr_gltf_is_new(k->g, name)) {
        double sigma[3];
        for (int i = 0; i < 3; ++i)
            sigma[i] = -log(fmax(fmin(m->attenuation[i], 1), 1e-6)) / fmax(m->attenuation_m, 1e-6);
        sr_compose_rgb(&k->g->c, "sigma_a", (struct sr_rgb){(float)sigma[0], (float)sigma[1], (float)sigma[2]});
        sr_compose_rgb(&k->g->c, "sigma_s", (struct sr_rgb){0, 0, 0});
        sr_compose_medium(&k->g->c, name, "homogeneous");
    }
    return name;
}

static void put_roughness(const struct maker *k, struct number roughness)
{
    const struct sr_gltf_look *m = k->m;
    if (m->anisotropy == 0) {
        put(k, "specular_roughness", roughness, 0.3);
        return;
    }
    double r = fmax(m->roughness, 1e-3), across = r * r, along = across + (1 - across) * m->anisotropy * m->anisotropy,
           ratio = across / along;
    if (roughness.texture || m->anisotropy_texture.info.json)
        sr_gltf_warn(k->g, &m->at,
                     "KHR_materials_anisotropy: strength and roughness are taken as their factors, without textures");
    sr_compose_float(&k->g->c, "specular_roughness_anisotropy", (float)fmin(1 - ratio, 0.95));
    sr_compose_float(&k->g->c, "specular_roughness", (float)fmin(sqrt(along / sqrt(2 / (1 + ratio * ratio))), 1));
}

struct film {
    struct number weight, um;
};

static struct film film_of(const struct maker *k)
{
    const struct sr_gltf_look *m = k->m;
    struct film f = {textured(k, "iridescence", m->film, &m->film_texture, "r"),
                     {NULL, fmin(m->film_nm[1] * 1e-3, 10)}};
    if (m->film > 0 && m->film_thickness_texture.info.json) {
        double scale[3] = {(m->film_nm[1] - m->film_nm[0]) * 1e-3};
        f.um.texture = sr_gltf_texelmap(k->g, k->s, &m->film_thickness_texture, "iridescence_thickness", "g", scale,
                                        m->film_nm[0] * 1e-3, false);
    }
    return f;
}

static void put_film(const struct maker *k, struct film f)
{
    if (!f.weight.texture && f.weight.value == 0)
        return;
    put(k, "thin_film_weight", f.weight, 0);
    put(k, "thin_film_thickness", f.um, 0.5);
    put(k, "thin_film_ior", (struct number){NULL, fmin(k->m->film_ior, 3)}, 1.4);
    if (k->m->transmission > 0)
        sr_gltf_note(k->g, "KHR_materials_iridescence", "glass shows no film, only what is opaque");
}

static void make_material(const struct maker *k)
{
    const struct sr_gltf_look *m = k->m;
    struct sr_compose *to = &k->g->c;
    if (m->is_unlit) {
        sr_compose_rgb(to, "reflectance", (struct sr_rgb){0, 0, 0});
        sr_compose_material(to, k->s->name, "diffuse");
        return;
    }
    // textures first
    const char *normal[3] = {NULL, NULL, NULL};
    make_normal(k, normal);
    struct colour base = base_colour(k), specular_colour, sheen = {0};
    struct number metal = textured(k, "metalness", m->metal, &m->metal_texture, "b"), roughness, specular;
    if (m->is_glossy && m->gloss_texture.info.json) {
        double f[3] = {-m->gloss, 0, 0};
        roughness = (struct number){sr_gltf_texelmap(k->g, k->s, &m->gloss_texture, "roughness", "a", f, 1, true), 0};
        specular_colour = textured_colour(k, "specular_color", m->specular_colour, &m->gloss_texture);
        specular = (struct number){NULL, m->specular};
    } else {
        roughness = m->is_glossy ? (struct number){NULL, 1 - m->gloss}
                                 : textured(k, "roughness", m->roughness, &m->metal_texture, "g");
        double most = fmax(1, fmax(m->specular_colour[0], fmax(m->specular_colour[1], m->specular_colour[2]))), tint[3];
        for (int i = 0; i < 3; ++i)
            tint[i] = m->specular_colour[i] / most;
        specular_colour = textured_colour(k, "specular_color", tint, &m->specular_colour_texture);
        specular = textured(k, "specular", fmin(m->specular * most, 2), &m->specular_texture, "a");
    }
    struct film film = film_of(k);
    struct number transmission = textured(k, "transmission", m->transmission, &m->transmission_texture, "r");
    struct number coat = textured(k, "clearcoat", m->coat, &m->coat_texture, "r");
    struct number coat_roughness =
        textured(k, "clearcoat_roughness", m->coat_roughness, &m->coat_roughness_texture, "g");
    struct number sheen_roughness =
        textured(k, "sheen_roughness", m->sheen_roughness, &m->sheen_roughness_texture, "a");
    double most_sheen = fmin(fmax(m->sheen[0], fmax(m->sheen[1], m->sheen[2])), 1), tint[3];
    for (int i = 0; i < 3; ++i)
        tint[i] = most_sheen > 0 ? m->sheen[i] / most_sheen : 1;
    if (most_sheen > 0)
        sheen = textured_colour(k, "sheen_color", tint, &m->sheen_texture);

    put_normal(k, normal);
    put_colour(k, "base_color", &base);
    put(k, "base_metalness", metal, 0);
    put_roughness(k, roughness);
    bool is_metal = !metal.texture && metal.value == 1;
    if (!is_metal) { // glTF's metals know neither index nor specular
        if (m->ior < 1.05 && m->ior >= 1)
            specular = (struct number){NULL, 0};
        else
            put(k, "specular_ior", (struct number){NULL, m->ior == 0 ? 3 : fmin(m->ior, 3)}, 1.5);
        put(k, "specular_weight", specular, 1);
        if (specular_colour.texture || rgb_of(specular_colour.value).r != 1 || rgb_of(specular_colour.value).g != 1 ||
            rgb_of(specular_colour.value).b != 1)
            put_colour(k, "specular_color", &specular_colour);
    }
    if (transmission.texture || transmission.value > 0) {
        put(k, "transmission_weight", transmission, 0);
        put_colour(k, "transmission_color", &base);
        if (!m->is_solid)
            sr_compose_float(to, "thin_walled", 1);
    }
    if (coat.texture || coat.value > 0) {
        put(k, "coat_weight", coat, 0);
        put(k, "coat_roughness", coat_roughness, 0);
        sr_compose_float(to, "coat_ior", 1.5f);
        sr_compose_float(to, "coat_darkening", 0);
    }
    if (most_sheen > 0) {
        put(k, "fuzz_weight", (struct number){NULL, most_sheen}, 0);
        put_colour(k, "fuzz_color", &sheen);
        put(k, "fuzz_roughness", sheen_roughness, 0.5);
    }
    put_film(k, film);
    sr_compose_material(to, k->s->name, "openpbr");
}

static void tell_what_is_missing(struct sr_gltf *g, const struct sr_gltf_look *m)
{
    if (m->coat > 0 && m->coat_normal_texture.info.json && m->coat_normal_texture.image1 != m->normal_texture.image1)
        sr_gltf_warn(g, &m->at, "clearcoatNormalTexture is not supported: the coat has the normal of what is below");
    if (m->dispersion > 0 && m->transmission > 0)
        sr_gltf_warn(g, &m->at,
                     "KHR_materials_dispersion is not supported: one index of refraction for all wavelengths");
    if (m->transmission > 0 && !m->is_solid && m->roughness > 0)
        sr_gltf_note(g, "KHR_materials_transmission",
                     "light goes straight through thin surfaces, also through rough ones");
    if (m->is_solid && m->transmission == 0)
        sr_gltf_note(g, "KHR_materials_volume", "has no meaning without transmission");
    if (m->anisotropy > 0 && m->anisotropy_rotation != 0)
        sr_gltf_note(g, "anisotropyRotation", "turns the tangents of the mesh");
}

/* ---- one material on one primitive ---- */

struct worn {
    const char *alpha, *inside;
    uint32_t area_light1;
};

void sr_gltf_wear(struct sr_gltf *g, const struct sr_gltf_look *m, const struct sr_gltf_surface *s, const char **alpha)
{
    struct sr_compose *to = &g->c;
    uint32_t number1 = sr_pbrt_names_find(&g->worn_names, s->name);
    if (!number1) {
        struct maker k = {g, m, s};
        to->transform = 0;
        tell_what_is_missing(g, m);
        struct worn made = {.alpha = alpha_of(&k), .inside = inside_of(&k)};
        make_material(&k);
        if (m->is_emissive)
            made.area_light1 = sr_gltf_emission(g, m, s);
        struct worn *slot = sr_gltf_is_well(g) ? sr_array_push(&g->worn, sizeof *slot) : NULL;
        if (!slot || !sr_pbrt_names_add(&g->worn_names, sr_compose_word(to, s->name), (uint32_t)g->worn.count)) {
            sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
            return;
        }
        *slot = made;
        number1 = (uint32_t)g->worn.count;
    }
    const struct worn *worn = SR_PBRT_AT(g->worn, struct worn, number1 - 1);
    to->material = sr_compose_word(to, s->name);
    to->area_light1 = worn->area_light1;
    to->inside = worn->inside;
    *alpha = worn->alpha;
}
