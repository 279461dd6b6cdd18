/* SPDX-License-Identifier: MIT */
/* Each parameter of pbrt's materials: a value changes what is scattered, and a texture of that value is as good as the
 * value. */
#include "import/import.h"
#include "test.h"

static char notes[4096];

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    if (severity == SR_WARNING && strlen(notes) + strlen(text) + 2 < sizeof notes)
        strcat(strcat(notes, text), "\n");
}

static const char *scene_path(void)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/materials.pbrt", test_folder());
    return path;
}

static sr_status import(const char *text, struct sr_import_result *result, struct sr_error *error)
{
    struct sr_import_options options = {.threads = 1};
    struct sr_log log = {.write = note};
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_file_write(scene_path(), text, strlen(text), &e), SR_OK);
    notes[0] = 0;
    return sr_import_pbrt(scene_path(), &options, result, &log, error);
}

/* Numbers that follow from all that a material says at one point, off the middle of a patch. */
enum { NUMBERS = 192 };
struct print {
    float x[NUMBERS];
    int count;
};

static void put3(struct print *p, float x, float y, float z)
{
    EXPECT(p->count + 3 <= NUMBERS);
    p->x[p->count++] = x;
    p->x[p->count++] = y;
    p->x[p->count++] = z;
}
static void put(struct print *p, sr_spectrum s)
{
    put3(p, s[0], s[SR_LAMBDA_COUNT / 2 - 1], s[SR_LAMBDA_COUNT - 2]);
}

static struct print print_of(const char *material, const char *parameter)
{
    char text[4096];
    snprintf(
        text, sizeof text,
        "WorldBegin\nTexture \"f\" \"float\" \"constant\" \"float value\" 0.35\nTexture \"s\" \"spectrum\" \"constant\" \"rgb value\" [0.2 0.35 0.7]\n"
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"conductor\" \"float roughness\" 0.5\n"
        "Material %s %s\nShape \"bilinearmesh\" \"point3 P\" [-1 -1 0  1 -1 0  -1 1 0  1 1 0]\n",
        material, parameter);
    struct sr_import_result result;
    struct sr_error error = {0};
    if (import(text, &result, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s %s: %s", material, parameter, error.text);
    if (notes[0])
        test_fail(__FILE__, __LINE__, "%s %s: %s", material, parameter, notes);
    struct print print = {.count = 0};
    struct sr_hit hit;
    struct sr_ray down = {.o = {0.4f, 0.62f, 1}, .d = {0, 0, -1}, .t_max = INFINITY};
    EXPECT(sr_raycast(result.scene, &down, &hit));
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, 0.3f);
    struct sr_frame frame;
    struct sr_bsdf bsdf;
    struct sr_bssrdf body;
    sr_vec3 wo = sr_normalize((sr_vec3){0.5f, 0.2f, 0.6f});
    sr_material_shade(hit.material, &hit.point, wo, 0.4f, 99, &w, &bsdf, &frame);
    put3(&print, frame.z.x, frame.z.y, frame.z.z);
    put(&print, w.pdf);
    if (sr_material_bssrdf(hit.material, &hit.point, wo, 0.4f, 99, &w, &body)) {
        put(&print, body.albedo);
        put(&print, body.sigma_t);
        put(&print, sr_bssrdf_profile(&body, 0.1f, NULL));
    }
    wo = sr_to_local(&frame, wo);
    static const float turns[6] = {0.02f, 0.2f, 0.3f, 0.55f, 0.75f, 0.97f};
    for (int i = 0; i < 6; ++i) {
        struct sr_bsdf_sample s;
        sr_vec3 wi =
            sr_spherical_direction(sinf(0.3f + 0.4f * (float)i), cosf(0.3f + 0.4f * (float)i), 1.1f * (float)i);
        put(&print, sr_bsdf_f(&bsdf, wo, wi, SR_RADIANCE));
        if (sr_bsdf_sample(&bsdf, wo, turns[i], (sr_vec2){0.3f, 0.8f}, SR_RADIANCE, &s)) {
            put(&print, s.f * (sr_abs_cos_theta(s.wi) / s.pdf));
            put3(&print, s.wi.x, s.wi.y, s.wi.z);
            put(&print, SR_BLACK + s.pdf);
        }
    }
    sr_import_result_free(&result);
    return print;
}

static bool are_alike(struct print a, struct print b)
{
    if (a.count != b.count)
        return false;
    for (int i = 0; i < a.count; ++i)
        if (!(fabsf(a.x[i] - b.x[i]) <= 1e-5f * fabsf(a.x[i])))
            return false;
    return true;
}

/* base: parameters without which this one does nothing. texture: "f", "s" or none. */
struct parameter {
    const char *material, *base, *type, *name, *value, *texture;
};
#define F "0.35", "f"
#define S "[0.2 0.35 0.7]", "s"
#define ROUGH "\"float roughness\" 0.2"
#define CLOUDY "\"float albedo\" 0.8 \"float thickness\" 0.7 \"float g\" 0.1"
#define LACQUER "\"float interface.roughness\" 0.1 \"float conductor.roughness\" 0.2"
static const struct parameter parameters[] = {
    {"diffuse", "", "rgb", "reflectance", S},
    {"coateddiffuse", "", "rgb", "reflectance", S},
    {"coateddiffuse", "", "float", "roughness", F},
    {"coateddiffuse", ROUGH, "float", "uroughness", F},
    {"coateddiffuse", ROUGH, "float", "vroughness", F},
    {"coateddiffuse", ROUGH, "bool", "remaproughness", "false", NULL},
    {"coateddiffuse", ROUGH, "float", "thickness", F},
    {"coateddiffuse", ROUGH, "float", "eta", "1.7", NULL},
    {"coateddiffuse", "", "spectrum", "eta", "\"glass-BK7\"", NULL},
    {"coateddiffuse", ROUGH, "integer", "maxdepth", "1", NULL},
    {"coateddiffuse", ROUGH, "integer", "nsamples", "4", NULL},
    {"coateddiffuse", CLOUDY, "float", "g", F},
    {"coateddiffuse", CLOUDY, "rgb", "albedo", S},
    {"coatedconductor", LACQUER, "float", "interface.roughness", F},
    {"coatedconductor", LACQUER, "float", "interface.uroughness", F},
    {"coatedconductor", LACQUER, "float", "interface.vroughness", F},
    {"coatedconductor", LACQUER, "float", "interface.eta", "1.7", NULL},
    {"coatedconductor", LACQUER, "float", "thickness", F},
    {"coatedconductor", LACQUER, "spectrum", "conductor.eta", "\"metal-Au-eta\"", NULL},
    {"coatedconductor", LACQUER, "rgb", "conductor.eta", S},
    {"coatedconductor", LACQUER, "rgb", "conductor.k", S},
    {"coatedconductor", LACQUER, "rgb", "reflectance", S},
    {"coatedconductor", LACQUER, "float", "conductor.roughness", F},
    {"coatedconductor", LACQUER, "float", "conductor.uroughness", F},
    {"coatedconductor", LACQUER, "float", "conductor.vroughness", F},
    {"coatedconductor", LACQUER, "bool", "remaproughness", "false", NULL},
    {"coatedconductor", LACQUER, "integer", "maxdepth", "1", NULL},
    {"coatedconductor", LACQUER, "integer", "nsamples", "4", NULL},
    {"coatedconductor", LACQUER " " CLOUDY, "float", "g", F},
    {"coatedconductor", LACQUER " " CLOUDY, "rgb", "albedo", S},
    {"conductor", ROUGH, "rgb", "eta", S},
    {"conductor", ROUGH, "rgb", "k", S},
    {"conductor", ROUGH, "spectrum", "k", "\"metal-Al-k\"", NULL},
    {"conductor", ROUGH, "rgb", "reflectance", S},
    {"conductor", "", "float", "roughness", F},
    {"conductor", "", "float", "uroughness", F},
    {"conductor", "", "float", "vroughness", F},
    {"conductor", ROUGH, "bool", "remaproughness", "false", NULL},
    {"dielectric", "", "float", "eta", "1.8", NULL},
    {"dielectric", "", "spectrum", "eta", "\"glass-SF11\"", NULL},
    {"dielectric", "", "float", "roughness", F},
    {"dielectric", "", "float", "uroughness", F},
    {"dielectric", "", "float", "vroughness", F},
    {"dielectric", ROUGH, "bool", "remaproughness", "false", NULL},
    {"thindielectric", "", "float", "eta", "1.8", NULL},
    {"thindielectric", "", "spectrum", "eta", "\"glass-SF11\"", NULL},
    {"diffusetransmission", "", "rgb", "reflectance", S},
    {"diffusetransmission", "", "rgb", "transmittance", S},
    {"diffusetransmission", "", "float", "scale", "0.5", NULL},
    {"hair", "", "rgb", "sigma_a", S},
    {"hair", "", "rgb", "reflectance", S},
    {"hair", "", "rgb", "color", S},
    {"hair", "", "float", "eumelanin", F},
    {"hair", "", "float", "pheomelanin", F},
    {"hair", "\"float eumelanin\" 0.1", "float", "pheomelanin", F},
    {"hair", "", "float", "eta", "1.4", NULL},
    {"hair", "", "float", "beta_m", F},
    {"hair", "", "float", "beta_n", F},
    {"hair", "", "float", "alpha", F},
    {"subsurface", "", "string", "name", "\"Apple\"", NULL},
    {"subsurface", "\"rgb sigma_s\" [1 2 3]", "rgb", "sigma_a", S},
    {"subsurface", "\"rgb sigma_a\" [1 2 3]", "rgb", "sigma_s", S},
    {"subsurface", "", "rgb", "reflectance", S},
    {"subsurface", "\"rgb reflectance\" [0.6 0.5 0.4]", "rgb", "mfp", S},
    {"subsurface", "", "float", "scale", "3", NULL},
    {"subsurface", "", "float", "eta", "1.5", NULL},
    {"subsurface", "", "float", "g", "0.5", NULL},
    {"subsurface", "", "float", "roughness", F},
    {"subsurface", "", "float", "uroughness", F},
    {"subsurface", "", "float", "vroughness", F},
    {"subsurface", ROUGH, "bool", "remaproughness", "false", NULL},
    {"mix", "\"string materials\" [\"a\" \"b\"]", "float", "amount", F},
};

TEST(each_parameter_of_a_material_works_and_takes_a_texture_where_it_may)
{
    for (size_t i = 0; i < sizeof parameters / sizeof parameters[0]; ++i) {
        const struct parameter *p = &parameters[i];
        char material[64], given[1024], textured[1024], without[512], needle[64];
        snprintf(material, sizeof material, "\"%s\"", p->material);
        snprintf(needle, sizeof needle, " %s\"", p->name);
        snprintf(without, sizeof without, "%s", p->base);
        char *found = strstr(without, needle);
        if (found) { // the base has the parameter with another value: out with it, up to the next
            char *begin = found, *end = strchr(found + strlen(needle), '"');
            while (*begin != '"')
                --begin;
            memmove(begin, end ? end : "", strlen(end ? end : "") + 1);
        }
        snprintf(given, sizeof given, "%s \"%s %s\" %s", without, p->type, p->name, p->value);
        struct print changed = print_of(material, given);
        bool is_only_complete_with_it = strcmp(p->material, "subsurface") == 0 && strncmp(p->name, "sigma_", 6) == 0;
        if (!is_only_complete_with_it && are_alike(print_of(material, p->base), changed))
            test_fail(__FILE__, __LINE__, "%s: %s changes nothing", p->material, given);
        if (!p->texture)
            continue;
        snprintf(textured, sizeof textured, "%s \"texture %s\" \"%s\"", without, p->name, p->texture);
        if (!are_alike(changed, print_of(material, textured)))
            test_fail(__FILE__, __LINE__, "%s: %s is another than %s", p->material, textured, given);
    }
}

static void expect_refusal(const char *material, const char *message)
{
    char text[1024];
    snprintf(text, sizeof text, "WorldBegin\nMaterial %s\nShape \"sphere\"", material);
    struct sr_import_result result;
    struct sr_error error = {0};
    EXPECT_EQUAL_INT(import(text, &result, &error), SR_ERROR_INPUT);
    if (!strstr(error.text, "materials.pbrt:2:") || !strstr(error.text, message))
        test_fail(__FILE__, __LINE__, "%s: expected \"%s\", there was \"%s\"", material, message, error.text);
}

static void expect_warning(const char *material, const char *message)
{
    char text[1024];
    snprintf(
        text, sizeof text,
        "WorldBegin\nMakeNamedMaterial \"i\" \"string type\" \"interface\" MakeNamedMaterial \"d\" \"string type\" \"diffuse\"\nMaterial %s\nShape \"sphere\"",
        material);
    struct sr_import_result result;
    struct sr_error error = {0};
    if (import(text, &result, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    sr_import_result_free(&result);
    if (!strstr(notes, "materials.pbrt:3:") || !strstr(notes, message))
        test_fail(__FILE__, __LINE__, "%s: expected \"%s\", there was \"%s\"", material, message, notes);
}

TEST(materials_refuse_what_makes_no_sense)
{
    expect_refusal("\"subsurface\" \"string name\" \"Ketchop\"", "there is no medium named \"Ketchop\"");
    expect_refusal("\"subsurface\" \"rgb sigma_a\" [1 1 1]", "sigma_a is given without sigma_s");
    expect_refusal("\"subsurface\" \"rgb sigma_s\" [1 1 1]", "sigma_s is given without sigma_a");
    expect_refusal("\"subsurface\" \"rgb reflectance\" [1 1 1.5]", "reflectance");
    expect_refusal("\"subsurface\" \"float eta\" 0", "expected 0.2 to 5");
    expect_refusal("\"subsurface\" \"float g\" 1", "expected -0.999 to 0.999");
    expect_refusal("\"subsurface\" \"float scale\" -1", "expected 0 or more");
    expect_refusal("\"hair\" \"float beta_m\" 1.5", "expected 0 to 1");
    expect_refusal("\"hair\" \"float eumelanin\" -1", "expected 0 or more");
    expect_refusal("\"hair\" \"float eta\" 0.5", "expected 1 or more");
    expect_refusal("\"measured\"", "needs the parameter filename");
    expect_refusal("\"measured\" \"string filename\" \"nowhere.bsdf\"", "nowhere.bsdf");
    expect_refusal("\"conductor\" \"rgb reflectance\" [1 1 1] \"rgb k\" [1 1 1]", "not by both");
    expect_refusal("\"mix\"", "a mix is of two materials");
    expect_refusal("\"mix\" \"string materials\" [\"a\" \"b\"]", "no material named \"a\"");
}

TEST(materials_tell_what_is_given_in_vain)
{
    expect_warning("\"hair\" \"rgb sigma_a\" [1 1 1] \"float eumelanin\" 1", "sigma_a is given");
    expect_warning("\"hair\" \"rgb color\" [.1 .1 .1] \"float eumelanin\" 1", "a colour is given");
    expect_warning("\"subsurface\" \"string name\" \"Apple\" \"float g\" 0.5", "the medium is named");
    expect_warning("\"subsurface\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [1 1 1] \"rgb mfp\" [1 1 1]",
                   "sigma_a and sigma_s are given");
    expect_warning("\"subsurface\" \"rgb mfp\" [1 1 1]", "mfp is ignored");
    expect_warning("\"mix\" \"string materials\" [\"i\" \"d\"]", "\"i\" is an interface");
    expect_warning("\"mix\" \"string materials\" [\"d\" \"d\"] \"float displacement\" 1",
                   "unused parameter \"float displacement\"");
    expect_warning("\"coateddiffuse\" \"float interface.roughness\" 1",
                   "unused parameter \"float interface.roughness\"");
}
