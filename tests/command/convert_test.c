/* SPDX-License-Identifier: MIT */
/* Scenes written anew: the same words, the same picture to the last bit, and nothing more to tidy the second time. */
#define _XOPEN_SOURCE 700
#include "run.h"

#include <ftw.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEAD "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 6\nCamera \"perspective\"\n"
#define LIGHT "LightSource \"infinite\"\n"

static char *contents(const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, name[0] == '/' ? "%.0s%s" : "%s/%s", test_folder(), name);
    char *bytes = NULL;
    size_t size;
    struct sr_error error = {0};
    if (sr_file_read(path, (size_t)1 << 30, &bytes, &size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return bytes;
}

static void expect_same_files(const char *a, const char *b, const char *what)
{
    char *one = contents(a), *other = contents(b);
    if (strcmp(one, other) != 0)
        test_fail(__FILE__, __LINE__, "%s and %s differ: %s", a, b, what);
    sr_free(one);
    sr_free(other);
}

static void expect_text(const char *text, const char *expected)
{
    put_file("in.pbrt", text);
    run_expecting(0, "convert in.pbrt -o out.pbrt");
    char *out = contents("out.pbrt");
    EXPECT_EQUAL_TEXT(out, expected);
    sr_free(out);
    run_expecting(0, "convert out.pbrt -o again.pbrt");
    expect_same_files("out.pbrt", "again.pbrt", "not the same the second time");
}

TEST(convert_puts_words_into_one_form)
{
    expect_text(
        "Camera\t\"perspective\"  \"float   fov\"[45.000]\n\n\n\nTranslate 0.10 1e+3 -0\nWorldBegin AttributeBegin Shape \"sphere\" \"point P\" []\n"
        "\"bool b\" \"true\" \"string s\" [\"a\\\"b\"] \"integer i\" [0x10 -3] \"float x\" 1.00000001 AttributeEnd\n",
        "Camera \"perspective\" \"float fov\" 45\n\nTranslate 0.1 1000 -0\nWorldBegin\nAttributeBegin\n"
        "    Shape \"sphere\" \"point3 P\" [ ] \"bool b\" true \"string s\" \"a\\\"b\" \"integer i\" [ 16 -3 ] \"float x\" 1\nAttributeEnd\n");
}

TEST(convert_keeps_comments_and_blank_lines)
{
    expect_text(
        "# first\n\n# second\nWorldBegin # trailing\n# own\nShape \"sphere\" # the radius:\n  \"float radius\" 2   # behind\n\n\n# last",
        "# first\n\n# second\nWorldBegin # trailing\n# own\n# the radius:\nShape \"sphere\" \"float radius\" 2 # behind\n\n# last\n");
}

TEST(convert_keeps_directives_in_comments)
{
    expect_text(
        "#@ Option \"string units\" \"si\"\nWorldBegin\n#@   Name   \"ball\"\nShape \"sphere\"\n#@ Meter \"irradiance\"\n#@ \"point3 p\" [0 0 0.50]\n#@ Unheard of\n",
        "#@ Option \"string units\" \"si\"\nWorldBegin\n#@ Name \"ball\"\nShape \"sphere\"\n#@ Meter \"irradiance\" \"point3 p\" [ 0 0 0.5 ]\n#@ Unheard of\n");
}

TEST(convert_writes_numbers_that_read_back_to_the_same)
{
    char text[8192] = "WorldBegin\nShape \"sphere\" \"float v\" [";
    uint32_t state = 1;
    for (int i = 0; i < 250; ++i) {
        state = state * 1664525u + 1013904223u;
        uint32_t bits = (state & 0x807fffffu) | (state % 200 + 27) << 23; // any sign and fraction, most exponents
        float v;
        memcpy(&v, &bits, 4);
        snprintf(text + strlen(text), sizeof text - strlen(text), " %.9g", (double)v);
    }
    strcat(text, " ]\n");
    put_file("in.pbrt", text);
    run_expecting(0, "convert in.pbrt -o out.pbrt");
    char *out = contents("out.pbrt");
    const char *a = text + strcspn(text, "[") + 1, *b = out + strcspn(out, "[") + 1;
    for (int i = 0; i < 250; ++i) {
        char *end_a, *end_b;
        float x = strtof(a, &end_a), y = strtof(b, &end_b);
        if (x != y || end_b - b > end_a - a + 24)
            test_fail(__FILE__, __LINE__, "number %d: %.9g became %.9g", i, (double)x, (double)y);
        a = end_a;
        b = end_b;
    }
    EXPECT(strlen(out) < strlen(text) + 200);
    sr_free(out);
}

TEST(convert_keeps_or_flattens_includes)
{
    put_file("in.pbrt", HEAD "WorldBegin\n" LIGHT "Include \"part.inc\"\nImport \"part.inc\"\n");
    put_file("part.inc", "Material \"diffuse\" # here\nShape \"sphere\"\n");
    run_expecting(0, "convert in.pbrt -o out.pbrt");
    char *kept = contents("out.pbrt");
    EXPECT_SAYS(kept, "Include \"part.inc\"\nImport \"part.inc\"\n");
    sr_free(kept);
    run_expecting(0, "convert in.pbrt -o out.pbrt --includes flatten");
    char *flat = contents("out.pbrt");
    EXPECT_SAYS(
        flat,
        "Material \"diffuse\" # here\nShape \"sphere\"\nAttributeBegin\n    Material \"diffuse\" # here\n    Shape \"sphere\"\nAttributeEnd\n");
    sr_free(flat);
    put_file("part.inc", "Include \"part.inc\"\n");
    EXPECT_SAYS(run_expecting(3, "convert in.pbrt -o out2.pbrt --includes flatten")->err, "includes itself");
    EXPECT_EQUAL_INT(count_files("out2"), 0);
}

TEST(convert_names_files_as_seen_from_the_output)
{
    char folder[1024];
    snprintf(folder, sizeof folder, "%s/deep", test_folder());
    mkdir(folder, 0777);
    put_file(
        "in.pbrt", HEAD
        "WorldBegin\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.pfm\"\n"
        "Material \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"k.spd\"\nInclude \"part.inc\"\n");
    put_file("part.inc", LIGHT "Shape \"sphere\"\n");
    put_file("t.pfm", "PF\n1 1\n-1\n............");
    put_file("k.spd", "400 1\n700 1\n");
    run_expecting(0, "convert in.pbrt -o deep/out.pbrt");
    char *out = contents("deep/out.pbrt");
    EXPECT_SAYS(out, "\"string filename\" \"../t.pfm\"");
    EXPECT_SAYS(out, "\"spectrum k\" \"../k.spd\"");
    EXPECT_SAYS(out, "\"spectrum eta\" \"metal-Cu-eta\"");
    EXPECT_SAYS(out, "Shape \"sphere\""); // Include is flattened where names would not be found from
    sr_free(out);
    run_expecting(0, "render deep/out.pbrt --spp 1 -o deep/a.pfm --quiet");
}

TEST(convert_sets_meshes_apart)
{
    put_file(
        "in.pbrt", HEAD
        "WorldBegin\n" LIGHT
        "Translate 0 0 4\nShape \"trianglemesh\" \"float alpha\" 1 \"integer indices\" [0 1 2 0 2 3] \"point2 uv\" [0 0 1 0 1 1 0 1]\n"
        "\"normal N\" [0 0 -1 0 0.1 -1 0 0 -1 0.1 0 -1] \"point3 P\" [-1 -1 0 1 -1 0.3 1 1 0 -1 1 0.1]\n");
    run_expecting(0, "convert in.pbrt -o out.pbrt --ply=3");
    char *out = contents("out.pbrt");
    EXPECT_SAYS(out, "Shape \"plymesh\" \"string filename\" \"out-0001.ply\" \"float alpha\" 1");
    sr_free(out);
    run_expecting(0, "render in.pbrt --spp 1 -o a.pfm --quiet");
    run_expecting(0, "render out.pbrt --spp 1 -o b.pfm --quiet");
    expect_same_files("a.pfm", "b.pfm", "the mesh in a file");
    run_expecting(0, "convert in.pbrt -o out.pbrt --ply=4");
    out = contents("out.pbrt");
    EXPECT_SAYS(out, "trianglemesh");
    sr_free(out);
}

TEST(convert_refuses_what_it_cannot_read)
{
    static const char *const bad[][2] = {
        {"WorldBegin\nShap \"sphere\"\n", "in.pbrt:2:1: Shap"},
        {"WorldBegin\nAttributeEnd\n", "AttributeEnd"},
        {"WorldBegin\nAttributeBegin\n", "end"},
        {"WorldBegin\nShape \"sphere\" \"flaot r\" 1\n", "flaot"},
        {"WorldBegin\nTranslate 1 2\n", "Translate"},
        {"Shape \"sphere\"\n", "WorldBegin"},
        {"WorldBegin\nShape \"sphere\" \"float r\" [1 2\n", "float r"},
        {"WorldBegin\nMaterial \"matte\" \"color Kd\" [1 1 1]\n", "color"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        put_file("in.pbrt", bad[i][0]);
        EXPECT_SAYS(run_expecting(3, "convert in.pbrt -o left.pbrt")->err, bad[i][1]);
        EXPECT_EQUAL_INT(count_files("left"), 0);
    }
    EXPECT_SAYS(run_expecting(3, "convert nowhere.pbrt -o left.pbrt")->err, "nowhere.pbrt");
    run_expecting(2, "convert in.pbrt");
    run_expecting(2, "convert -o left.pbrt");
    run_expecting(2, "convert in.pbrt -o - --ply");
    run_expecting(2, "convert in.pbrt -o left.pbrt --includes maybe");
    EXPECT_EQUAL_INT(count_files("left"), 0);
}

/* ---- the same picture, and the same text the second time ---- */

static int converted, rendered;

static void round_trip(const char *path)
{
    char words[2048];
    const char *folder = strrchr(path, '/');
    snprintf(words, sizeof words, "convert %s -o one.pbrt --quiet%s", path, strstr(path, "veach") ? " --ply=8" : "");
    run_expecting(0, words);
    run_expecting(0, "convert one.pbrt -o two.pbrt --quiet");
    char *one = contents("one.pbrt"), *two = contents("two.pbrt");
    if (strcmp(one, two) != 0)
        test_fail(__FILE__, __LINE__, "%s: not the same the second time", folder + 1);
    sr_free(one);
    sr_free(two);
    ++converted;
    snprintf(words, sizeof words, "render %s --spp 1 --resolution 16,12 -o before.pfm --quiet", path);
    if (run(words, NULL)->code != 0)
        return; // needs what is not there yet; then it is not this test's matter
    run_expecting(0, "render one.pbrt --spp 1 --resolution 16,12 -o after.pfm --quiet");
    expect_same_files("before.pfm", "after.pfm", folder + 1);
    ++rendered;
}

static int visit(const char *path, const struct stat *status, int type, struct FTW *place)
{
    (void)status;
    (void)place;
    if (type == FTW_F && sr_path_has_ending(path, ".pbrt") && !sr_path_has_ending(path, ".ref.pbrt")) {
        char *text = contents(path);
        if (strstr(text, "WorldBegin")) // else another file includes it
            round_trip(path);
        sr_free(text);
    }
    return 0;
}

TEST(convert_keeps_the_pictures_of_own_scenes)
{
    converted = rendered = 0;
    nftw(SR_TEST_SOURCE_DIR "/scenes", visit, 16, FTW_PHYS);
    EXPECT(converted >= 4 && rendered >= 4);
}

TEST(convert_keeps_the_pictures_of_reference_scenes)
{
    const char *cornell = test_reference_file("scenes/cornell-box");
    char folder[4096];
    snprintf(folder, sizeof folder, "%.*s", (int)(strlen(cornell) - strlen("/cornell-box")), cornell);
    converted = rendered = 0;
    nftw(folder, visit, 16, FTW_PHYS);
    EXPECT(converted >= 15 && rendered >= 10);
}

/* ---- pbrt-v3 ---- */

#define V4_FILM                                                                                                        \
    "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 9\nSampler \"independent\" \"integer pixelsamples\" 2\n"
#define V3_FILM                                                                                                        \
    "Film \"image\" \"integer xresolution\" 12 \"integer yresolution\" 9\nSampler \"random\" \"integer pixelsamples\" 2\n"
#define V4_BOX "PixelFilter \"box\"\n"
#define BALL "Translate 0 0 4\nShape \"sphere\" \"float radius\" 2\n"

/* The old scene, upgraded, is the new one. */
static void expect_upgrade(const char *old, const char *now)
{
    put_file("old.pbrt", old);
    put_file("now.pbrt", now);
    run_expecting(0, "convert old.pbrt --upgrade -o upgraded.pbrt --quiet");
    run_expecting(0, "render upgraded.pbrt -o old.pfm --quiet");
    run_expecting(0, "render now.pbrt -o now.pfm --quiet");
    expect_same_files("old.pfm", "now.pfm", old);
    run_expecting(0, "convert upgraded.pbrt -o again.pbrt --quiet");
    expect_same_files("upgraded.pbrt", "again.pbrt", "not the same the second time");
}

TEST(upgrade_materials_of_pbrt_v3)
{
    static const char *const pairs[][2] = {
        {"Material \"matte\" \"color Kd\" [.2 .4 .6]\n", "Material \"diffuse\" \"rgb reflectance\" [.2 .4 .6]\n"},
        {"Material \"matte\"\n", "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"},
        {"Material \"uber\" \"rgb Kd\" [.3 .3 .3] \"rgb Ks\" [0 0 0]\n",
         "Material \"diffuse\" \"rgb reflectance\" [.3 .3 .3]\n"},
        {"Material \"glass\" \"float index\" 1.3\n", "Material \"dielectric\" \"float eta\" 1.3\n"},
        {"Material \"mirror\" \"rgb Kr\" [.7 .7 .7]\n", "Material \"conductor\" \"rgb reflectance\" [.7 .7 .7]\n"},
        {"Material \"metal\" \"float roughness\" .25 \"bool remaproughness\" \"false\"\n",
         "Material \"conductor\" \"float roughness\" .25 \"bool remaproughness\" false\n"},
        {"Material \"translucent\" \"rgb Kd\" [.8 .4 .2] \"rgb reflect\" [.5 .5 .5] \"rgb transmit\" [.25 .25 .25] \"rgb Ks\" [0 0 0]\n",
         "Material \"diffusetransmission\" \"rgb reflectance\" [.4 .2 .1] \"rgb transmittance\" [.2 .1 .05]\n"},
        {"MakeNamedMaterial \"a\" \"string type\" \"matte\" \"rgb Kd\" [.1 .1 .1]\nMakeNamedMaterial \"a\" \"string type\" \"matte\" \"rgb Kd\" [.9 .9 .9]\nNamedMaterial \"a\"\n",
         "Material \"diffuse\" \"rgb reflectance\" [.9 .9 .9]\n"},
        {"Texture \"t\" \"color\" \"checkerboard\" \"color tex1\" [.2 .2 .2] \"color tex2\" [.8 .8 .8] \"float uscale\" 4\n"
         "Texture \"s\" \"color\" \"scale\" \"texture tex1\" \"t\" \"color tex2\" [.5 .5 .5]\nMaterial \"matte\" \"texture Kd\" \"s\"\n",
         "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [.2 .2 .2] \"rgb tex2\" [.8 .8 .8] \"float uscale\" 4\n"
         "Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" .5\nMaterial \"diffuse\" \"texture reflectance\" \"s\"\n"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; ++i) {
        char old[2048], now[2048];
        snprintf(
            old, sizeof old,
            V3_FILM
            "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\" \"color L\" [1 1 1] \"integer nsamples\" 4\n%s" BALL
            "WorldEnd\n",
            pairs[i][0]);
        snprintf(now, sizeof now,
                 V4_FILM V4_BOX
                 "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\" \"rgb L\" [1 1 1]\n%s" BALL,
                 pairs[i][1]);
        expect_upgrade(old, now);
    }
}

/* ln .25 = -1.3862944: alpha = 1.62142 - 1.1366990 + .3332422 - .0456121 + .0023664 */
TEST(upgrade_roughness_to_the_slopes_that_it_meant)
{
    put_file("old.pbrt", V3_FILM "WorldBegin\nMaterial \"metal\" \"float roughness\" .25\n");
    run_expecting(0, "convert old.pbrt --upgrade -o upgraded.pbrt --quiet");
    char *text = contents("upgraded.pbrt");
    const char *number = strstr(text, "\"float roughness\" ");
    EXPECT(number != NULL);
    EXPECT_NEAR(strtod(number + strlen("\"float roughness\" "), NULL), 0.7747183, 1e-6);
    EXPECT_SAYS(text, "\"bool remaproughness\" false");
    sr_free(text);
}

TEST(upgrade_lights_of_pbrt_v3)
{
    static const char *const pairs[][2] = {
        {"LightSource \"infinite\" \"rgb L\" [1 2 3] \"rgb scale\" [2 2 2]\n",
         "LightSource \"infinite\" \"rgb L\" [1 2 3] \"float scale\" 2\n"},
        {"LightSource \"point\" \"rgb I\" [4 4 4] \"rgb scale\" [1 .5 .25]\n",
         "LightSource \"point\" \"rgb I\" [4 2 1]\n"},
        // a flat spectrum of 3 has luminance 3 in units of the equal-energy white
        {"LightSource \"distant\" \"spectrum L\" [300 3 900 3]\n",
         "LightSource \"distant\" \"spectrum L\" [300 1 900 1] \"float scale\" 3\n"},
        {"AreaLightSource \"area\" \"color L\" [2 2 2] \"integer nsamples\" 4\n",
         "AreaLightSource \"diffuse\" \"rgb L\" [2 2 2]\n"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; ++i) {
        char old[2048], now[2048];
        snprintf(
            old, sizeof old,
            V3_FILM
            "PixelFilter \"gaussian\" \"float alpha\" 2 \"float xwidth\" 1\nCamera \"perspective\"\nWorldBegin\n%s" BALL,
            pairs[i][0]);
        snprintf(
            now, sizeof now,
            V4_FILM
            "PixelFilter \"gaussian\" \"float sigma\" .5 \"float xradius\" 1 \"float yradius\" 2\nCamera \"perspective\"\nWorldBegin\n%s" BALL,
            pairs[i][1]);
        expect_upgrade(old, now);
    }
}

TEST(upgrade_tells_what_it_approximates_and_where)
{
    put_file(
        "old.pbrt", V3_FILM
        "WorldBegin\nMaterial \"fourier\" \"string bsdffile\" \"a.bsdf\"\nShape \"cone\"\nTransformBegin\nMaterial \"matte\" \"float sigma\" 20\nTransformEnd\n"
        "LightSource \"infinite\" \"string mapname\" \"a.exr\"\n");
    const struct said *s = run_expecting(0, "convert old.pbrt --upgrade -o -");
    EXPECT_SAYS(s->err, "old.pbrt:4:1: Material \"fourier\"");
    EXPECT_SAYS(s->err, "old.pbrt:5:1: Shape \"cone\"");
    EXPECT_SAYS(s->err, "old.pbrt:7:1: what this sets held beyond TransformEnd");
    EXPECT_SAYS(s->err, "\"sigma\"");
    EXPECT_SAYS(s->err, "old.pbrt:9:1: LightSource \"infinite\"");
    EXPECT_SAYS(s->out, "\"string filename\" \"a.exr\"");
    EXPECT_SAYS(s->out, "PixelFilter \"box\"");
}

/* ---- other formats ---- */

TEST(convert_obj_to_what_pbrt_knows_or_to_our_own)
{
    put_file(
        "a.mtl",
        "newmtl shiny\nKd .6 .3 .1\nKs .5 .5 .5\nNs 98\nillum 2\nnewmtl gold\nKd 1 .8 .3\nPm .4\nPr .5\nnewmtl lamp\nKe 5 5 5\nnewmtl tex\nmap_Kd t.pfm\n");
    put_file("t.pfm", "PF\n1 1\n-1\n............");
    put_file(
        "a.obj",
        "mtllib a.mtl\nv -1 0 0\nv 1 0 0\nv 1 1 0\nv -1 1 0\nvt 0 0\ng one\nusemtl shiny\nf 1 2 3 4\ng two\nusemtl gold\nf 1 2 3\nusemtl lamp\nf 4 3 1\nusemtl tex\nf 1/1 2/1 4/1\n");
    run_expecting(0, "convert a.obj -o out.pbrt --quiet");
    char *out = contents("out.pbrt");
    EXPECT_SAYS(out, "MakeNamedMaterial \"shiny\"\n    \"string type\" \"coateddiffuse\"");
    EXPECT_SAYS(out, "\"float roughness\" 0.14142"); // sqrt(2 / 100)
    EXPECT_SAYS(out, "\"string materials\" [ \"gold, body\" \"gold, metal\" ]\n    \"float amount\" 0.4");
    EXPECT_SAYS(out, "AreaLightSource \"diffuse\" \"rgb L\" [ 5 5 5 ]");
    EXPECT_SAYS(out, "#@ Name \"two\"");
    EXPECT_SAYS(out, "\"string filename\" \"t.pfm\"");
    sr_free(out);
    run_expecting(0, "render out.pbrt --spp 1 --resolution 8,6 -o a.pfm --quiet");
    run_expecting(0, "convert out.pbrt -o again.pbrt --quiet");
    expect_same_files("out.pbrt", "again.pbrt", "not the same the second time");
    run_expecting(0, "convert a.obj -o own.pbrt --for steradian --quiet");
    out = contents("own.pbrt");
    EXPECT_SAYS(out, "\"openpbr\"");
    sr_free(out);
    run_expecting(0, "render own.pbrt --spp 1 --resolution 8,6 -o a.pfm --quiet");
    run_expecting(2, "convert a.obj -o -"); // where would meshes and the sky go?
}

/* Every model becomes text without a word that pbrt does not know. */
TEST(convert_gltf_models_to_what_pbrt_knows)
{
    static const char *const models[] = {"AlphaBlendModeTest", "BoxVertexColors", "NormalTangentTest",
                                         "TextureTransformTest", "TransmissionTest"};
    static const char *const ours[] = {"\"openpbr\"", "\"texelmap\"",  "\"attribute\"",
                                       "\"product\"", "\"threshold\"", "normalx"};
    for (size_t i = 0; i < sizeof models / sizeof *models; ++i) {
        char name[512], words[5000];
        snprintf(name, sizeof name, "gltf/%s/glTF/%s.gltf", models[i], models[i]);
        if (access(SR_TEST_REFERENCE_DIR "/gltf", R_OK) == 0 && strcmp(models[i], "NormalTangentTest") != 0 &&
            strcmp(models[i], "TransmissionTest") != 0)
            test_reference_file(name);
        else
            snprintf(name, sizeof name, "gltf/%s/glTF-Binary/%s.glb", models[i], models[i]);
        snprintf(words, sizeof words, "convert %s -o model.pbrt --quiet", test_reference_file(name));
        run_expecting(0, words);
        char *text = contents("model.pbrt");
        for (size_t k = 0; k < sizeof ours / sizeof *ours; ++k)
            if (strstr(text, ours[k]))
                test_fail(__FILE__, __LINE__, "%s: %s in what pbrt should read", models[i], ours[k]);
        sr_free(text);
        run_expecting(0, "render model.pbrt --spp 1 --resolution 16,12 -o a.pfm --quiet");
    }
}

TEST(convert_names_the_file_whose_text_would_be_refused)
{
    put_file("huge.pbrt", "Camera \"perspective\"\nWorldBegin\nShape \"sphere\" \"float radius\" 1e999\n");
    const struct said *s = run_expecting(3, "convert huge.pbrt -o out.pbrt");
    EXPECT_SAYS(s->err, "error: huge.pbrt: makes a text that would be refused: out.pbrt:3:31: inf");
}
