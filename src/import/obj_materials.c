/* SPDX-License-Identifier: MIT */
/* Materials of OBJ files (MTL), as the nearest of ours.
 *
 * Phong's exponent Ns stands for slopes of width alpha = sqrt(2 / (Ns + 2)) [1] (Walter et al. 2007, 5.2); our
 * roughness is sqrt(alpha). Pr, Pm and norm are the widespread extension for physically based materials. d and Tr are
 * how much is there, not glass; glass is "illum" 4, 6, 7 or 9. Ke is radiance; of what unit the format does not say,
 * and it is taken as cd/m^2. */
#include "import/obj.h"

#include <stdio.h>
#include <string.h>

static const size_t max_text_B = (size_t)1 << 30;

/* ---- reading ---- */

static struct sr_rgb read_rgb(const char *p)
{
    double v[3] = {0, 0, 0};
    int n = sr_obj_numbers(p, 3, v);
    if (n == 1) // grey
        v[1] = v[2] = v[0];
    for (int i = 0; i < 3; ++i)
        v[i] = v[i] >= 0 && v[i] < 1e30 ? v[i] : 0;
    return (struct sr_rgb){(float)v[0], (float)v[1], (float)v[2]};
}

static float read_number(const char *p, float lo, float hi, float otherwise)
{
    double v;
    if (sr_obj_numbers(p, 1, &v) != 1 || !(v >= (double)lo))
        return otherwise;
    return v < (double)hi ? (float)v : hi;
}

/* -s u v w -o u v w -bm m -clamp on … NAME, which may have blanks in it */
static void read_map(struct sr_compose *c, const char *p, struct sr_obj_map *map)
{
    static const struct {
        const char *word;
        int words; // that follow at most, numbers but for the last kind
        bool are_numbers;
    } options[] = {{"-s", 3, true},       {"-o", 3, true},       {"-t", 3, true},      {"-mm", 2, true},
                   {"-bm", 1, true},      {"-boost", 1, true},   {"-texres", 1, true}, {"-clamp", 1, false},
                   {"-blendu", 1, false}, {"-blendv", 1, false}, {"-cc", 1, false},    {"-imfchan", 1, false},
                   {"-type", 1, false}};
    *map = (struct sr_obj_map){.scale = {1, 1}, .bump = 1};
    for (bool again = true; again && *(p = sr_obj_skip(p)) == '-';) {
        again = false;
        for (size_t i = 0; i < sizeof options / sizeof *options; ++i) {
            if (!sr_obj_is_word(p, options[i].word))
                continue;
            double v[3] = {options[i].word[1] == 's', options[i].word[1] == 's', 0};
            p = sr_obj_skip(p + sr_obj_word_length(p));
            int n = options[i].are_numbers ? sr_obj_numbers(p, options[i].words, v) : 1;
            if (strcmp(options[i].word, "-clamp") == 0)
                map->clamps = sr_obj_is_word(p, "on");
            for (int k = 0; k < n; ++k)
                p = sr_obj_skip(p + sr_obj_word_length(p));
            if (strcmp(options[i].word, "-s") == 0)
                memcpy(map->scale, (float[2]){(float)v[0], (float)v[1]}, sizeof map->scale);
            if (strcmp(options[i].word, "-o") == 0)
                memcpy(map->offset, (float[2]){(float)v[0], (float)v[1]}, sizeof map->offset);
            if (strcmp(options[i].word, "-bm") == 0)
                map->bump = (float)v[0];
            again = true;
            break;
        }
    }
    size_t n = strcspn(p, "\n");
    while (n > 0 && (p[n - 1] == ' ' || p[n - 1] == '\t' || p[n - 1] == '\r'))
        --n;
    char *name = n ? sr_pbrt_words(c->d, n + 1) : NULL;
    for (size_t i = 0; name && i < n; ++i)
        name[i] = p[i] == '\\' ? '/' : p[i];
    map->path = name;
}

static void read_line(struct sr_compose *c, const char *p, struct sr_obj_material *m)
{
    const struct {
        const char *word;
        struct sr_rgb *colour;
    } colours[] = {{"Kd", &m->Kd}, {"Ks", &m->Ks}, {"Ke", &m->Ke}, {"Tf", &m->Tf}};
    const struct {
        const char *word;
        struct sr_obj_map *map;
    } maps[] = {{"map_Kd", &m->map_Kd},   {"map_Ks", &m->map_Ks},     {"map_Ke", &m->map_Ke},
                {"map_d", &m->map_d},     {"map_bump", &m->map_bump}, {"bump", &m->map_bump},
                {"norm", &m->map_normal}, {"map_Kn", &m->map_normal}, {"map_Pr", &m->map_Pr},
                {"map_Pm", &m->map_Pm}};
    const char *rest = sr_obj_skip(p + sr_obj_word_length(p));
    for (size_t i = 0; i < sizeof colours / sizeof *colours; ++i)
        if (sr_obj_is_word(p, colours[i].word)) {
            if (sr_obj_is_word(rest, "spectral") || sr_obj_is_word(rest, "xyz"))
                sr_compose_warn(c, "%s: only red, green and blue are read", colours[i].word);
            else
                *colours[i].colour = read_rgb(rest);
            m->has_Kd = m->has_Kd || i == 0;
        }
    for (size_t i = 0; i < sizeof maps / sizeof *maps; ++i)
        if (sr_obj_is_word(p, maps[i].word))
            read_map(c, rest, maps[i].map);
    if (sr_obj_is_word(p, "Ns"))
        m->Ns = read_number(rest, 0, 1e6f, m->Ns);
    else if (sr_obj_is_word(p, "Ni"))
        m->Ni = read_number(rest, 0.1f, 10, m->Ni);
    else if (sr_obj_is_word(p, "d"))
        m->d = read_number(rest, 0, 1, m->d);
    else if (sr_obj_is_word(p, "Tr"))
        m->d = 1 - read_number(rest, 0, 1, 1 - m->d);
    else if (sr_obj_is_word(p, "Pr"))
        m->Pr = read_number(rest, 0, 1, m->Pr);
    else if (sr_obj_is_word(p, "Pm"))
        m->Pm = read_number(rest, 0, 1, m->Pm);
    else if (sr_obj_is_word(p, "illum"))
        m->illum = (int)read_number(rest, 0, 10, -1);
}

static void read_text(struct sr_compose *c, const char *text, struct sr_array *materials)
{
    struct sr_obj_material *m = NULL;
    int line = 1;
    for (const char *p = text; *p; p = sr_obj_next_line(p, &line)) {
        const char *word = sr_obj_skip(p);
        c->where.line = line;
        c->where.column = 1;
        if (sr_obj_is_word(word, "newmtl")) {
            const char *name = sr_obj_skip(word + 6);
            size_t n = strcspn(name, "\n");
            while (n > 0 && (name[n - 1] == ' ' || name[n - 1] == '\t' || name[n - 1] == '\r'))
                --n;
            if (!(m = sr_array_push(materials, sizeof *m))) {
                sr_fail(c->error, SR_ERROR_RESOURCE, "%s: not enough memory", c->path);
                return;
            }
            *m = (struct sr_obj_material){.where = c->where,
                                          .Kd = {0.8f, 0.8f, 0.8f},
                                          .Tf = {1, 1, 1},
                                          .Ns = 0,
                                          .Ni = 1.5f,
                                          .d = 1,
                                          .Pr = -1,
                                          .Pm = -1,
                                          .illum = -1};
            if (!(m->name = sr_pbrt_text(c->d, name, n)))
                m->name = "";
        } else if (m)
            read_line(c, word, m);
    }
}

void sr_obj_materials_read(struct sr_compose *c, const char *path, struct sr_array *materials)
{
    char *text;
    size_t size;
    struct sr_error error = {0};
    if (sr_file_read(path, max_text_B, &text, &size, &error) != SR_OK) {
        sr_compose_warn(c, "mtllib: %s", error.text);
        return;
    }
    c->where.file = sr_compose_word(c, path);
    c->d->text_B += size;
    c->d->hash = sr_pbrt_hash(c->d->hash, text, size);
    read_text(c, text, materials);
    sr_free(text);
}

/* ---- composing ---- */

static bool is_black(struct sr_rgb c)
{
    return c.r <= 0 && c.g <= 0 && c.b <= 0;
}

static float mean(struct sr_rgb c)
{
    return (c.r + c.g + c.b) / 3;
}

static struct sr_rgb clamp(struct sr_rgb c)
{
    return (struct sr_rgb){sr_min(c.r, 1), sr_min(c.g, 1), sr_min(c.b, 1)};
}

/* An image as a texture; its name, or NULL where the file is not there. */
static const char *compose_map(struct sr_compose *c, struct sr_obj_material *m, const struct sr_obj_map *map,
                               const char *what, bool is_float, float scale)
{
    char *path = map->path ? sr_path_beside(&c->d->words, m->where.file, map->path) : NULL;
    if (!path || !sr_file_exists(path)) {
        if (path)
            sr_compose_warn(c, "material \"%.100s\": %s: there is no file \"%.200s\"", m->name, what, path);
        return NULL;
    }
    sr_compose_string(c, "filename", map->path);
    if (is_float)
        sr_compose_string(c, "encoding", "linear");
    if (scale != 1)
        sr_compose_float(c, "scale", scale);
    if (map->clamps)
        sr_compose_string(c, "wrap", "clamp");
    const char *names[4] = {"uscale", "vscale", "udelta", "vdelta"};
    const float values[4] = {map->scale[0], map->scale[1], map->offset[0], map->offset[1]};
    for (int i = 0; i < 4; ++i)
        if (values[i] != (i < 2 ? 1 : 0))
            sr_compose_float(c, names[i], values[i]);
    const char *name = sr_compose_printf(c, "%.400s, %s", m->name, what);
    sr_compose_texture(c, name, is_float, "imagemap");
    m->is_textured = true;
    return name;
}

struct maps {
    const char *colour, *bump, *rough, *metal;
    const char *normal;
};

static void put_colour(struct sr_compose *c, const char *name, struct sr_rgb colour, const char *map)
{
    if (map)
        sr_compose_texture_name(c, name, map);
    else
        sr_compose_rgb(c, name, clamp(colour));
}

static void put_surface(struct sr_compose *c, const struct maps *maps)
{
    if (maps->bump)
        sr_compose_texture_name(c, "displacement", maps->bump);
    if (maps->normal)
        sr_compose_string(c, "normalmap", maps->normal);
}

static float slope(const struct sr_obj_material *m)
{
    return sqrtf(2 / (m->Ns + 2));
}

static void compose_glass(struct sr_compose *c, const struct sr_obj_material *m, const struct maps *maps)
{
    if (m->Ns > 0 && m->Ns < 1000) {
        sr_compose_float(c, "roughness", slope(m));
        sr_compose_bool(c, "remaproughness", false);
    }
    sr_compose_float(c, "eta", sr_min(sr_max(m->Ni, 1.0001f), 4));
    put_surface(c, maps);
    sr_compose_material(c, m->name, "dielectric");
}

static void compose_metal(struct sr_compose *c, const struct sr_obj_material *m, const struct maps *maps)
{
    sr_compose_rgb(c, "reflectance", clamp(m->Ks));
    sr_compose_float(c, "roughness", m->Ns > 0 && m->Ns < 1000 ? slope(m) : 0);
    sr_compose_bool(c, "remaproughness", false);
    put_surface(c, maps);
    sr_compose_material(c, m->name, "conductor");
}

/* A matte body under what shines: by the extension's numbers, or by Phong's. */
static void compose_layered(struct sr_compose *c, const struct sr_obj_material *m, const struct maps *maps)
{
    put_colour(c, "base_color", m->Kd, maps->colour);
    if (maps->metal)
        sr_compose_texture_name(c, "base_metalness", maps->metal);
    else if (m->Pm > 0)
        sr_compose_float(c, "base_metalness", m->Pm);
    if (maps->rough)
        sr_compose_texture_name(c, "specular_roughness", maps->rough);
    else
        sr_compose_float(c, "specular_roughness", m->Pr >= 0 ? m->Pr : m->Pm >= 0 ? 0.5f : sqrtf(slope(m)));
    sr_compose_float(c, "specular_ior", m->Ni > 1.05f ? sr_min(m->Ni, 3) : 1.5f);
    put_surface(c, maps);
    sr_compose_material(c, m->name, "openpbr");
}

static void compose_light(struct sr_compose *c, struct sr_obj_material *m)
{
    char *path = m->map_Ke.path ? sr_path_beside(&c->d->words, m->where.file, m->map_Ke.path) : NULL;
    bool has_image = path && sr_file_exists(path);
    if (is_black(m->Ke) && !has_image)
        return;
    if (has_image) {
        sr_compose_string(c, "filename", m->map_Ke.path);
        if (!is_black(m->Ke))
            sr_compose_float(c, "scale", mean(m->Ke));
    } else
        sr_compose_rgb(c, "L", m->Ke);
    m->area_light1 = sr_compose_area_light(c);
}

static bool is_glass(const struct sr_obj_material *m)
{
    return m->illum == 4 || m->illum == 6 || m->illum == 7 || m->illum == 9;
}

void sr_obj_material_wear(struct sr_compose *c, struct sr_obj_material *m)
{
    struct sr_location where = c->where;
    c->where = m->where;
    if (!m->is_composed) {
        m->is_composed = true;
        const char *name = m->name;
        for (unsigned k = 2; sr_pbrt_names_find(&c->d->material_names, m->name) && c->error->status == SR_OK; ++k)
            m->name = sr_compose_printf(c, "%.900s (%u)", name, k); // there is an earlier one of the same name
        bool is_metal =
            (is_black(m->Kd) && !m->map_Kd.path && !is_black(m->Ks) && m->Pm < 0) || (m->illum == 3 && is_black(m->Kd));
        bool shines = m->Pr >= 0 || m->Pm >= 0 || m->map_Pr.path || m->map_Pm.path ||
                      (!is_black(m->Ks) && m->Ns > 0 && m->illum != 0 && m->illum != 1);
        struct maps maps = {.colour = is_glass(m) || is_metal
                                          ? NULL
                                          : compose_map(c, m, &m->map_Kd, "map_Kd", false,
                                                        m->has_Kd && !is_black(m->Kd) ? mean(clamp(m->Kd)) : 1),
                            .bump = compose_map(c, m, &m->map_bump, "bump", true, m->map_bump.bump),
                            .rough = shines ? compose_map(c, m, &m->map_Pr, "map_Pr", true, 1) : NULL,
                            .metal = shines ? compose_map(c, m, &m->map_Pm, "map_Pm", true, 1) : NULL};
        char *normal = m->map_normal.path ? sr_path_beside(&c->d->words, m->where.file, m->map_normal.path) : NULL;
        maps.normal = normal && sr_file_exists(normal) ? m->map_normal.path : NULL;
        if (m->map_Ks.path)
            sr_compose_warn(c, "material \"%.100s\": map_Ks is left out", m->name);
        if (is_glass(m))
            compose_glass(c, m, &maps);
        else if (is_metal)
            compose_metal(c, m, &maps);
        else if (shines)
            compose_layered(c, m, &maps);
        else {
            put_colour(c, "reflectance", m->Kd, maps.colour);
            put_surface(c, &maps);
            sr_compose_material(c, m->name, "diffuse");
        }
        compose_light(c, m);
    }
    c->material = m->name;
    c->area_light1 = m->area_light1;
    c->where = where;
}

void sr_obj_material_alpha(struct sr_compose *c, const struct sr_obj_material *m)
{
    if (is_glass(m))
        return;
    struct sr_obj_material copy = *m;
    const char *name = sr_compose_printf(c, "%.400s, map_d", m->name);
    if (m->map_d.path &&
        (sr_pbrt_names_find(&c->d->float_textures, name) || compose_map(c, &copy, &m->map_d, "map_d", true, m->d)))
        sr_compose_texture_name(c, "alpha", name);
    else if (m->d < 1)
        sr_compose_float(c, "alpha", m->d);
}
