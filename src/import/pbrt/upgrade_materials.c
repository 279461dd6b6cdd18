/* SPDX-License-Identifier: MIT */
/* pbrt-v3's materials as pbrt-v4's.
 *
 * Slopes: pbrt-v3 took alpha = 1.62142 + 0.819955 x + 0.1734 x^2 + 0.0171201 x^3 + 0.000640711 x^4, x = ln
 * max(roughness, 0.001), pbrt-v4 takes alpha = sqrt(roughness): roughness that is a number becomes alpha itself, with
 * "remaproughness" false. */
#include "import/pbrt/closest.h"
#include "import/pbrt/statement.h"

#include <stdio.h>
#include <string.h>

static bool is(const char *a, const char *b)
{
    return strcmp(a, b) == 0;
}

static void warn(struct sr_pbrt_upgrade *u, const char *model, const char *text)
{
    sr_pbrt_warn(u->p->d, u->s->where, "%s \"%s\": %s", u->s->word, model, text);
}

static void set_colour(struct sr_pbrt_upgrade *u, const char *name, float grey)
{
    sr_pbrt_edit_set(u, SR_PBRT_RGB, name, (const float[]){grey, grey, grey}, 3);
}

/* Takes it away; a warning where it was another grey than the one that its absence means now. */
static bool lose(struct sr_pbrt_upgrade *u, const char *model, const char *name, float initial, float meant)
{
    float value;
    bool is_given = sr_pbrt_edit_find(u, name) != NULL, is_grey = sr_pbrt_edit_grey(u, name, initial, &value);
    sr_pbrt_edit_remove(u, name);
    if (is_given && !(is_grey && value == meant)) {
        char text[128];
        snprintf(text, sizeof text, "\"%s\" is left out: pbrt-v4 has no place for it", name);
        warn(u, model, text);
    }
    return is_grey && value == meant;
}

static float slope(float roughness)
{
    float x = logf(roughness > 1e-3f ? roughness : 1e-3f);
    return 1.62142f + x * (0.819955f + x * (0.1734f + x * (0.0171201f + x * 0.000640711f)));
}

/* initial: roughness where none is given; negative: smooth */
static void upgrade_roughness(struct sr_pbrt_upgrade *u, const char *model, float initial)
{
    static const char *const names[] = {"roughness", "uroughness", "vroughness"};
    const struct sr_pbrt_param *remap = sr_pbrt_edit_find(u, "remaproughness");
    bool is_remapped = !(remap && remap->ints && !remap->ints[0]), has_any = false, has_texture = false;
    for (int i = 0; i < 3; ++i) {
        const struct sr_pbrt_param *p = sr_pbrt_edit_find(u, names[i]);
        has_any = has_any || p;
        has_texture = has_texture || (p && p->type == SR_PBRT_TEXTURE);
    }
    if (!has_any && initial >= 0)
        sr_pbrt_edit_float(u, names[0], initial);
    if (!is_remapped || (!has_any && initial < 0))
        return;
    if (has_texture) {
        warn(u, model,
             "the texture of its roughness means other slopes in pbrt-v4 (alpha = sqrt(roughness)): see to it");
        return;
    }
    for (int i = 0; i < 3; ++i) {
        float value;
        if (sr_pbrt_edit_find(u, names[i]) && sr_pbrt_edit_grey(u, names[i], 0, &value))
            sr_pbrt_edit_float(u, names[i], value == 0 && initial < 0 ? 0 : slope(value));
    }
    sr_pbrt_edit_set(u, SR_PBRT_BOOL, "remaproughness", &(int32_t){0}, 1);
}

static void rename_colour(struct sr_pbrt_upgrade *u, const char *from, const char *to, float initial)
{
    if (!sr_pbrt_edit_find(u, from))
        set_colour(u, from, initial);
    sr_pbrt_edit_rename(u, from, to);
}

static const char *matte(struct sr_pbrt_upgrade *u)
{
    lose(u, "matte", "sigma", 0, 0);
    rename_colour(u, "Kd", "reflectance", 0.5f);
    return "diffuse";
}

/* plastic, uber, substrate: a matte body with a clear coat, unless nothing shines */
static const char *coated(struct sr_pbrt_upgrade *u, const char *model, float Kd, float Ks)
{
    float shine;
    bool is_grey = sr_pbrt_edit_grey(u, "Ks", Ks, &shine);
    sr_pbrt_edit_rename(u, "index", "eta");
    rename_colour(u, "Kd", "reflectance", Kd);
    lose(u, model, "Kr", 0, 0);
    lose(u, model, "Kt", 0, 0);
    lose(u, model, "opacity", 1, 1);
    if (is_grey && shine == 0) {
        static const char *const gone[] = {"Ks", "roughness", "uroughness", "vroughness", "remaproughness", "eta"};
        for (size_t i = 0; i < sizeof gone / sizeof *gone; ++i)
            sr_pbrt_edit_remove(u, gone[i]);
        return "diffuse";
    }
    sr_pbrt_edit_remove(u, "Ks");
    warn(u, model, "\"coateddiffuse\" instead: its coat reflects what Fresnel's equations say, whatever \"Ks\" was");
    upgrade_roughness(u, model, 0.1f);
    return "coateddiffuse";
}

static const char *glass(struct sr_pbrt_upgrade *u)
{
    sr_pbrt_edit_rename(u, "index", "eta");
    lose(u, "glass", "Kr", 1, 1);
    lose(u, "glass", "Kt", 1, 1);
    upgrade_roughness(u, "glass", -1);
    return "dielectric";
}

static const char *mirror(struct sr_pbrt_upgrade *u)
{
    rename_colour(u, "Kr", "reflectance", 0.9f);
    sr_pbrt_edit_float(u, "roughness", 0);
    return "conductor";
}

static const char *metal(struct sr_pbrt_upgrade *u)
{
    lose(u, "metal", "Kr", 1, 1);
    upgrade_roughness(u, "metal", 0.01f);
    return "conductor";
}

/* What is reflected and what is let through: Kd times a share each. */
static const char *translucent(struct sr_pbrt_upgrade *u)
{
    static const char *const names[2][2] = {{"reflect", "reflectance"}, {"transmit", "transmittance"}};
    static const float half[3] = {0.5f, 0.5f, 0.5f}, quarter[3] = {0.25f, 0.25f, 0.25f};
    static const char *const gone[] = {"Kd", "Ks", "roughness", "remaproughness"};
    const struct sr_pbrt_param *Kd = sr_pbrt_edit_find(u, "Kd");
    struct sr_pbrt_param colour =
        Kd ? *Kd : (struct sr_pbrt_param){.type = SR_PBRT_RGB, .name = "Kd", .count = 3, .floats = quarter};
    lose(u, "translucent", "Ks", 0.25f, 0);
    for (int i = 0; i < 2; ++i) {
        const struct sr_pbrt_param *share = sr_pbrt_edit_find(u, names[i][0]);
        const float *s = !share ? half : share->type == SR_PBRT_RGB && share->count == 3 ? share->floats : NULL;
        if (s && colour.type == SR_PBRT_RGB && colour.count == 3) {
            float product[3] = {s[0] * colour.floats[0], s[1] * colour.floats[1], s[2] * colour.floats[2]};
            sr_pbrt_edit_remove(u, names[i][0]);
            sr_pbrt_edit_set(u, SR_PBRT_RGB, names[i][1], product, 3);
            continue;
        }
        float grey; // of a texture: the share must be one number, which is "scale" of both
        bool is_grey = sr_pbrt_edit_grey(u, names[i][0], 0.5f, &grey);
        sr_pbrt_edit_remove(u, names[i][0]);
        struct sr_pbrt_param *p = sr_pbrt_edit_set(u, SR_PBRT_FLOAT, names[i][1], &grey, 1);
        if (p) {
            *p = colour;
            p->name = names[i][1];
        }
        if (!is_grey || (sr_pbrt_edit_find(u, "scale") && sr_pbrt_edit_find(u, "scale")->floats[0] != grey))
            warn(u, "translucent", "\"reflect\" and \"transmit\" are not the same number: one \"scale\" for both");
        else if (grey != 1)
            sr_pbrt_edit_float(u, "scale", grey);
    }
    for (size_t i = 0; i < sizeof gone / sizeof *gone; ++i)
        sr_pbrt_edit_remove(u, gone[i]);
    return "diffusetransmission";
}

static const char *mix(struct sr_pbrt_upgrade *u)
{
    static const char *const names[] = {"namedmaterial2", "namedmaterial1"}; // the amount was that of the first
    const char *words[2] = {"", ""};
    float amount;
    for (int i = 0; i < 2; ++i) {
        const struct sr_pbrt_param *p = sr_pbrt_edit_find(u, names[i]);
        if (p && p->strings)
            words[i] = p->strings[0];
        else
            warn(u, "mix", "two materials by name were expected");
        sr_pbrt_edit_remove(u, names[i]);
    }
    for (int i = 0; i < 2; ++i)
        words[i] = sr_pbrt_upgrade_name(u, "material", words[i]);
    sr_pbrt_edit_set(u, SR_PBRT_STRING_TYPE, "materials", words, 2);
    const struct sr_pbrt_param *p = sr_pbrt_edit_find(u, "amount");
    if (p && p->type != SR_PBRT_TEXTURE) {
        if (!sr_pbrt_edit_grey(u, "amount", 0.5f, &amount)) {
            warn(u, "mix", "a coloured \"amount\" becomes the mean of red, green and blue");
            if (p->floats && p->count == 3)
                amount = (p->floats[0] + p->floats[1] + p->floats[2]) / 3;
        }
        sr_pbrt_edit_float(u, "amount", amount);
    }
    return "mix";
}

/* Our "principled" has the same words; pbrt gets what it knows of them. */
static const char *disney(struct sr_pbrt_upgrade *u)
{
    static const char *const gone[] = {"sheen",       "sheentint",       "clearcoat", "clearcoatgloss", "speculartint",
                                       "anisotropic", "scatterdistance", "thin",      "difftrans",      "flatness"};
    rename_colour(u, "color", "reflectance", 0.5f);
    sr_pbrt_edit_rename(u, "spectrans", "specular_transmission");
    for (size_t i = 0; i < sizeof gone / sizeof *gone; ++i)
        lose(u, "disney", gone[i], 0, 0);
    if (u->for_steradian)
        return "principled";
    warn(u, "disney", "the nearest of pbrt-v4's materials instead");
    const char *name = u->s->strings[0];
    if (is(u->s->word, "Material") && !(name = sr_arena_printf(u->arena, "disney %d", ++u->count)))
        name = "disney";
    struct sr_pbrt_entity e = {
        .directive = u->s->word, .model = "principled", .name = name, .params = u->s->params, .where = u->s->where};
    sr_pbrt_closest_material(u->p->d, &e, u->out, u->p->error);
    struct sr_pbrt_param *items = sr_pbrt_words(u->p->d, (e.params.count + 16) * sizeof *items);
    if (items) {
        memcpy(items, e.params.items, e.params.count * sizeof *items);
        u->s->params = (struct sr_pbrt_params){items, e.params.count};
        u->room = e.params.count + 16;
    }
    return e.model;
}

static const char *subsurface(struct sr_pbrt_upgrade *u, const char *model)
{
    if (is(model, "kdsubsurface")) {
        rename_colour(u, "Kd", "reflectance", 0.5f);
        if (!sr_pbrt_edit_find(u, "mfp"))
            set_colour(u, "mfp", 1);
    }
    sr_pbrt_edit_rename(u, "index", "eta");
    lose(u, model, "Kr", 1, 1);
    lose(u, model, "Kt", 1, 1);
    upgrade_roughness(u, model, -1);
    return "subsurface";
}

void sr_pbrt_upgrade_material(struct sr_pbrt_upgrade *u, const char **model)
{
    sr_pbrt_edit_rename(u, "bumpmap", "displacement");
    const char *old = *model;
    if (is(old, "matte"))
        *model = matte(u);
    else if (is(old, "plastic") || is(old, "uber"))
        *model = coated(u, old, 0.25f, 0.25f);
    else if (is(old, "substrate"))
        *model = coated(u, old, 0.5f, 0.5f);
    else if (is(old, "glass"))
        *model = glass(u);
    else if (is(old, "mirror"))
        *model = mirror(u);
    else if (is(old, "metal"))
        *model = metal(u);
    else if (is(old, "translucent"))
        *model = translucent(u);
    else if (is(old, "mix"))
        *model = mix(u);
    else if (is(old, "disney"))
        *model = disney(u);
    else if (is(old, "subsurface") || is(old, "kdsubsurface"))
        *model = subsurface(u, old);
    else if (is(old, "fourier")) {
        warn(u, old, "pbrt-v4 reads no such files (\"measured\" reads others): diffuse instead");
        sr_pbrt_edit_remove(u, "bsdffile");
        *model = "diffuse";
    } else if (is(old, "") || is(old, "none"))
        *model = "interface";
    else if (!is(old, "hair"))
        warn(u, old, "pbrt-v3 has no such material: it stays as it is");
}
