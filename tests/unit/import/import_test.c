/* SPDX-License-Identifier: MIT */
/* Files to finished scenes: what is bound, what is refused, and that light and geometry mean what the format says. */
#include "import/import.h"
#include "test.h"

static char notes[8192];

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    size_t n = strlen(notes);
    if (severity == SR_WARNING)
        snprintf(notes + n, sizeof notes - n, "%s\n", text);
}

static struct sr_import_result result;
static struct sr_error error;

static const char *scene_path(void)
{
    static char path[1024];
    snprintf(path, sizeof path, "%s/s.pbrt", test_folder());
    return path;
}

static sr_status import_with(const char *text, const struct sr_import_options *options)
{
    struct sr_log log = {.write = note};
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_file_write(scene_path(), text, strlen(text), &e), SR_OK);
    notes[0] = 0;
    error = (struct sr_error){0};
    return sr_import_pbrt(scene_path(), options, &result, &log, &error);
}

static void import(const char *text)
{
    struct sr_import_options options = {.threads = 1};
    if (import_with(text, &options) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

/* `message` stands behind the path of the file */
static void expect_error(const char *text, const char *message)
{
    char expected[2048];
    struct sr_import_options options = {.threads = 1};
    EXPECT_EQUAL_INT(import_with(text, &options), SR_ERROR_INPUT);
    snprintf(expected, sizeof expected, "%s:%s", scene_path(), message);
    EXPECT_EQUAL_TEXT(error.text, expected);
    EXPECT(result.scene == NULL);
}

static void expect_warning(const char *text, const char *message)
{
    import(text);
    if (!strstr(notes, message))
        test_fail(__FILE__, __LINE__, "expected the warning \"%s\", there was: %s", message, notes);
    sr_import_result_free(&result);
}

#define BALL "Shape \"sphere\" "

TEST(what_is_not_supported_says_so_and_what_is)
{
    expect_error("WorldBegin\nShape \"cone\"", "2:1: Shape \"cone\" is not supported yet; supported: trianglemesh, "
                                               "bilinearmesh, sphere, disk, cylinder, loopsubdiv, curve, plymesh");
    expect_error(
        "WorldBegin\nMaterial \"velvet\"\n" BALL,
        "2:1: Material \"velvet\" is not supported yet; supported: diffuse, diffusetransmission, conductor, "
        "dielectric, thindielectric, coateddiffuse, coatedconductor, mix, interface, hair, subsurface, and the models of "
        "'steradian brdf list'");
    expect_error(
        "WorldBegin\nLightSource \"lantern\"",
        "2:1: LightSource \"lantern\" is not supported yet; supported: point, spot, ies, goniometric, projection, distant, infinite");
    expect_error(
        "Camera \"pinhole\"\nWorldBegin",
        "1:1: Camera \"pinhole\" is not supported yet; supported: perspective, orthographic, spherical, fisheye, realistic");
    expect_error("Camera \"realistic\"\nWorldBegin", "1:1: Camera \"realistic\": expected \"string lensfile\"");
    expect_error(
        "Sampler \"sobol\" \"string randomization\" \"dice\"\nWorldBegin",
        "1:17: \"string randomization\" of Sampler \"sobol\" is \"dice\": expected none, permutedigits, fastowen or owen");
    expect_error("Film \"plate\"\nWorldBegin",
                 "1:1: Film \"plate\" is not supported yet; supported: rgb, gbuffer, spectral");
    expect_error("Film \"spectral\" \"float lambdamin\" 700 \"float lambdamax\" 400\nWorldBegin",
                 "1:1: Film \"spectral\": lambdamin 700 nm must be less than lambdamax 400 nm");
    expect_error("Film \"spectral\" \"integer nbuckets\" 0\nWorldBegin",
                 "1:17: \"integer nbuckets\" of Film \"spectral\" is 0: expected 1 to 4096");
    expect_error("Film \"gbuffer\" \"string coordinatesystem\" \"screen\"\nWorldBegin",
                 "1:16: \"string coordinatesystem\" of Film \"gbuffer\" is \"screen\": expected camera|world");
    expect_error("WorldBegin\nMediumInterface \"fog\" \"\"\n" BALL, "2:1: there is no medium named \"fog\"");
    expect_error(
        "Film \"rgb\"\n\"string sensor\" \"nikon_d580\" WorldBegin",
        "2:1: there is no sensor \"nikon_d580\": expected cie1931 or the name of a camera: did you mean \"nikon_d850\"?");
    expect_error(
        "WorldBegin Texture \"t\" \"spectrum\" \"marzipan\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\" " BALL,
        "1:12: Texture \"marzipan\" is not supported yet; supported: constant, scale, mix, bilerp, checkerboard, "
        "imagemap, dots, directionmix, marble, texelmap, attribute, product");
    expect_error(
        "WorldBegin Texture \"t\" \"float\" \"marble\"\nShape \"sphere\" \"texture alpha\" \"t\"",
        "1:12: Texture \"marble\" is not supported yet; supported: constant, scale, mix, bilerp, checkerboard, "
        "imagemap, dots, directionmix, fbm, wrinkled, windy, texelmap, attribute, threshold");
    expect_error(
        "WorldBegin Texture \"t\" \"spectrum\" \"ptex\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\" " BALL,
        "1:12: Texture \"t\": Ptex files are not read: bake it into an image over the surface's (u, v) and use \"imagemap\"");
}

TEST(wrong_parameters_tell_where_and_what_was_expected)
{
    expect_error("WorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ .5 1.5 0 ]\n" BALL,
                 "2:20: \"rgb reflectance\" of Material \"diffuse\" has the component 1.5: expected 0 to 1, for it is "
                 "a reflectance");
    expect_error("WorldBegin\nShape \"sphere\" \"float radius\" -1",
                 "2:16: \"float radius\" of Shape \"sphere\" is -1: expected 0 or more m");
    expect_error("WorldBegin\nShape \"sphere\" \"string radius\" \"1\"",
                 "2:16: \"string radius\" of Shape \"sphere\" has the wrong type: expected float");
    expect_error("WorldBegin\nShape \"sphere\" \"float radius\" [ 1 2 ]",
                 "2:16: \"float radius\" of Shape \"sphere\" has 2 values: expected 1");
    expect_error("WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"chekcs\"\nTexture \"checks\" \"spectrum\" "
                 "\"constant\" " BALL,
                 "2:20: \"texture reflectance\": there is no spectrum texture \"chekcs\": did you mean \"checks\"?");
    expect_error(
        "WorldBegin\nTexture \"a\" \"float\" \"constant\" Material \"diffuse\" \"texture reflectance\" \"a\" " BALL,
        "2:51: \"texture reflectance\": \"a\" is a float texture: expected a spectrum texture");
    expect_error("WorldBegin\nTexture \"a\" \"float\" \"scale\" \"texture tex\" \"a\" Material \"diffuse\" \"texture "
                 "displacement\" \"a\" " BALL,
                 "2:29: \"texture tex\": texture \"a\" is made of itself");
    expect_error("WorldBegin\nNamedMaterial \"wod\" MakeNamedMaterial \"wood\" \"string type\" \"diffuse\" " BALL,
                 "2:1: there is no material named \"wod\": did you mean \"wood\"?");
    expect_error("WorldBegin\nMakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [ \"m\" \"m\" ] "
                 "NamedMaterial \"m\" " BALL,
                 "2:1: MakeNamedMaterial \"m\" is a mix of itself");
    expect_error("WorldBegin\nObjectInstance \"tee\" ObjectBegin \"tree\" ObjectEnd",
                 "2:1: ObjectInstance \"tee\": no object has this name: did you mean \"tree\"?");
    expect_error("WorldBegin\nMaterial \"conductor\" \"spectrum eta\" \"metal-Au-etta\" " BALL,
                 "2:22: \"spectrum eta\": \"metal-Au-etta\" is neither the name of a spectrum nor a file: did you mean "
                 "\"metal-Au-eta\"?");
    expect_error("WorldBegin\nLightSource \"infinite\" \"blackbody L\" 0",
                 "2:24: \"blackbody L\": expected one temperature above 0 K");
    expect_error("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]",
                 "2:1: Shape \"trianglemesh\": trianglemesh: index 3 at place 2 is out of range, expected 0 to 2 as "
                 "there are 3 \"P\"");
    expect_error("Sampler \"zsobol\" \"integer pixelsamples\" 0 WorldBegin",
                 "1:18: \"integer pixelsamples\" of Sampler \"zsobol\" is 0: expected 1 to 1.07374e+09");
}

TEST(textures_may_be_nested_but_not_without_end)
{
    static char text[1 << 16];
    for (int depth = 30; depth <= 120; depth += 90) {
        size_t n = (size_t)snprintf(text, sizeof text, "WorldBegin Texture \"t0\" \"float\" \"constant\"\n");
        for (int i = 1; i <= depth; ++i)
            n += (size_t)snprintf(text + n, sizeof text - n,
                                  "Texture \"t%d\" \"float\" \"scale\" \"texture tex\" \"t%d\"\n", i, i - 1);
        snprintf(text + n, sizeof text - n, "Material \"diffuse\" \"texture displacement\" \"t%d\" " BALL, depth);
        struct sr_import_options options = {.threads = 1};
        EXPECT_EQUAL_INT(import_with(text, &options), depth == 30 ? SR_OK : SR_ERROR_INPUT);
        EXPECT(depth == 30 || strstr(error.text, "textures are nested more than 64 deep"));
        sr_import_result_free(&result);
    }
}

TEST(odd_things_are_warned_of)
{
    expect_warning(
        "WorldBegin\nMaterial \"diffuse\" \"float reflectence\" .5\n" BALL,
        "s.pbrt:2:20: unused parameter \"float reflectence\" of Material \"diffuse\": did you mean \"reflectance\"?");
    expect_warning("WorldBegin\nShape \"sphere\" \"float zzz\" .5",
                   "s.pbrt:2:16: unused parameter \"float zzz\" of Shape \"sphere\"\n");
    expect_warning(
        "WorldBegin\nMaterial \"none\"\n" BALL,
        "s.pbrt:2:1: Material \"none\" is deprecated: \"interface\" is the name of the material that is none");
    expect_warning("WorldBegin AreaLightSource \"diffuse\" ObjectBegin \"a\"\n" BALL "ObjectEnd ObjectInstance \"a\"",
                   "s.pbrt:2:1: a shape of an object cannot shine");
    import("WorldBegin Attribute \"shape\" \"float nobody\" 1 " BALL); // defaults need not be used
    EXPECT_EQUAL_TEXT(notes, "");
    sr_import_result_free(&result);
}

TEST(settings_are_those_of_the_file_unless_options_say_otherwise)
{
    const char *text = "Film \"rgb\" \"integer xresolution\" 400 \"integer yresolution\" [ 200 ] \"float cropwindow\" "
                       "[ .25 .5 .1 1 ] \"float iso\" 200 \"string "
                       "filename\" \"out.exr\" ColorSpace \"rec2020\" Sampler \"independent\" \"integer pixelsamples\" "
                       "100 \"integer seed\" 5\n"
                       "Camera \"orthographic\" \"float shutterclose\" .5 PixelFilter \"box\" Integrator "
                       "\"simplepath\" \"integer maxdepth\" 7\n"
                       "Option \"bool disable-pixel-jitter\" true WorldBegin " BALL;
    import(text);
    const struct sr_film_settings *f = &result.film;
    EXPECT(f->width == 400 && f->height == 200 && f->x0 == 100 && f->x1 == 200 && f->y0 == 20 && f->y1 == 200);
    EXPECT(f->iso == 200 && f->exposure_time == 0.5f && f->space == SR_SRGB); // ColorSpace stands behind Film
    EXPECT_EQUAL_TEXT(f->filename, "out.exr");
    EXPECT(result.sampler == SR_SAMPLER_INDEPENDENT && result.spp == 100 && result.seed == 5 && !result.jitter_pixel &&
           result.jitter_lambda);
    EXPECT_EQUAL_TEXT(result.integrator.model->name, "simplepath");
    EXPECT_EQUAL_TEXT(result.filter.model->name, "box");
    EXPECT_EQUAL_TEXT(result.sensor.model->name, "orthographic");
    uint64_t hash = result.hash;
    sr_import_result_free(&result);

    struct sr_import_options o = {.threads = 2,
                                  .spp = 64,
                                  .width = 80,
                                  .height = 40,
                                  .has_crop = true,
                                  .crop_window = {0, 0.5f, 0, 1},
                                  .quick = true,
                                  .integrator = "sppm"};
    EXPECT_EQUAL_INT(import_with(text, &o), SR_OK);
    EXPECT(f->width == 20 && f->height == 10 && f->x1 == 10 && result.spp == 16 && result.hash == hash);
    EXPECT_EQUAL_TEXT(result.integrator.model->name, "caustics");
    sr_import_result_free(&result);

    import("WorldBegin " BALL); // pbrt's defaults
    EXPECT(f->width == 1280 && f->height == 720 && f->x1 == 1280 && result.spp == 16 &&
           result.sampler == SR_SAMPLER_SOBOL && result.hash != hash);
    EXPECT_EQUAL_TEXT(f->filename, "s.exr");
    EXPECT_EQUAL_TEXT(result.integrator.model->name, "path");
    EXPECT_EQUAL_TEXT(result.filter.model->name, "gaussian");
    sr_import_result_free(&result);
}

/* What the camera sees in a pixel's middle. */
static bool look(sr_vec2 at, struct sr_hit *hit)
{
    struct sr_sensor_ray r;
    EXPECT(result.sensor.model->ray(result.sensor.self, at, (sr_vec2){0.5f, 0.5f}, 0.5f, &r));
    return sr_raycast(result.scene, &r.ray, hit);
}

/* integral of Le ybar over wavelength by steps of 1 nm: luminance [cd/m^2] */
static double luminance(const struct sr_hit *hit, sr_vec3 w)
{
    double sum = 0;
    for (int first = 360; first <= 830; first += SR_LAMBDA_COUNT) {
        struct sr_wavelengths wl = {.pdf = SR_ONE};
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            wl.lambda[i] = (float)(first + i);
        sr_spectrum L = hit ? sr_hit_Le(result.scene, hit, w, &wl)
                            : sr_escape_Le(result.scene, &(struct sr_ray){.d = w, .t_max = INFINITY}, &wl);
        for (int i = 0; i < SR_LAMBDA_COUNT && first + i <= 830; ++i)
            sum += (double)L[i] * sr_luminous_efficiency(first + i);
    }
    return sum;
}

static double luminance_of_disk(const char *emission)
{
    char text[1024];
    struct sr_hit hit;
    snprintf(text, sizeof text,
             "Camera \"perspective\" WorldBegin Translate 0 0 5 ReverseOrientation AreaLightSource \"diffuse\" %s "
             "Shape \"disk\" \"float radius\" 2",
             emission);
    import(text);
    EXPECT(look((sr_vec2){640, 360}, &hit));
    double L_v = luminance(&hit, (sr_vec3){0, 0, -1});
    EXPECT_NEAR(luminance(&hit, (sr_vec3){0, 0, 1}), 0, 0); // the back is dark
    sr_import_result_free(&result);
    return L_v;
}

/* A spectrum has luminance 1 before scale; rgb (1,1,1) too; power [lm] spreads over pi A. */
TEST(emission_has_the_luminance_that_the_format_promises)
{
    EXPECT_RELATIVE(luminance_of_disk(""), 1, 1e-4);
    EXPECT_RELATIVE(luminance_of_disk("\"float scale\" 7"), 7, 1e-4);
    EXPECT_RELATIVE(luminance_of_disk("\"rgb L\" [ 3 3 3 ]"), 3, 2e-3);
    EXPECT_RELATIVE(luminance_of_disk("\"rgb L\" [ 3 3 3 ] \"float scale\" 2"), 6, 2e-3);
    EXPECT_RELATIVE(luminance_of_disk("\"blackbody L\" 3000 \"float scale\" 2"), 2, 1e-4);
    EXPECT_RELATIVE(luminance_of_disk("\"spectrum L\" [ 400 5 700 5 ] \"float scale\" 2"), 2, 1e-4);
    EXPECT_RELATIVE(luminance_of_disk("\"spectrum L\" \"stdillum-D65\""), 1, 1e-4);
    EXPECT_RELATIVE(luminance_of_disk("\"float power\" 100"), 100 / (3.14159265 * 3.14159265 * 4), 1e-4);
    import("WorldBegin LightSource \"infinite\" \"float illuminance\" 31.4159265");
    EXPECT_RELATIVE(luminance(NULL, (sr_vec3){0, 0, -1}), 10, 1e-4);
    sr_import_result_free(&result);
}

TEST(shapes_stand_where_their_transforms_put_them)
{
    struct sr_hit hit;
    import("LookAt 0 0 -10  0 0 0  0 1 0 Camera \"orthographic\" \"float screenwindow\" [ -8 8 -8 8 ] Film \"rgb\" "
           "\"integer xresolution\" 16 \"integer yresolution\" 16\n"
           "WorldBegin ObjectBegin \"o\" Translate 0 0 1 Shape \"sphere\" \"float radius\" 1 ObjectEnd\n"
           "AttributeBegin Translate 5 0 0 Scale 2 2 2 ObjectInstance \"o\" AttributeEnd AttributeBegin Translate -5 4 "
           "0 ObjectInstance \"o\" AttributeEnd\n"
           "Material \"conductor\" AttributeBegin Rotate 90 0 0 1 Translate -5 5 0 Shape \"disk\" AttributeEnd");
    // the camera looks along +z with +x to the right: pixel (x, y) sees world (x - 8, 8 - y)
    EXPECT(look((sr_vec2){13, 8}, &hit));
    EXPECT_NEAR(hit.point.p.z, 0, 1e-4); // 2 (1 - 1)
    EXPECT_NEAR(hit.point.p.x, 5, 1e-4);
    EXPECT(look((sr_vec2){3, 4}, &hit));
    EXPECT_NEAR(hit.point.p.z, 0, 1e-4);
    EXPECT(look((sr_vec2){14.5f, 8}, &hit) && !look((sr_vec2){15.5f, 8}, &hit) && !look((sr_vec2){4.5f, 4}, &hit) &&
           !look((sr_vec2){8, 8}, &hit));
    EXPECT(look((sr_vec2){3, 13}, &hit)); // rotated: (-5, 5) goes to (-5, -5)
    EXPECT_EQUAL_TEXT(hit.material->model->name, "conductor");
    EXPECT_EQUAL_INT(sr_scene_count(result.scene).instances, 2);
    sr_import_result_free(&result);
}

TEST(ply_quads_become_patches_in_the_right_order)
{
    char path[1024];
    struct sr_error e = {0};
    struct sr_hit hit;
    const char *ply = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float "
                      "z\nproperty float u\nproperty float v\n"
                      "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                      "-2 -2 0 0 0\n2 -2 0 1 0\n2 2 0 1 1\n-2 2 0 0 1\n-2 4 1 0 2\n2 4 0 1 2\n4 0 1 2 3\n4 3 2 5 4\n";
    snprintf(path, sizeof path, "%s/q.ply", test_folder());
    EXPECT_EQUAL_INT(sr_file_write(path, ply, strlen(ply), &e), SR_OK);
    import("LookAt 0 0 -10  0 0 0  0 1 0 Camera \"orthographic\" \"float screenwindow\" [ -8 8 -8 8 ] Film \"rgb\" "
           "\"integer xresolution\" 16 \"integer yresolution\" 16\n"
           "WorldBegin Shape \"plymesh\" \"string filename\" \"q.ply\"");
    EXPECT(look((sr_vec2){9, 7}, &hit)); // (1, 1, 0): uv 3/4 3/4
    EXPECT_NEAR(hit.point.uv.x, 0.75, 1e-5);
    EXPECT_NEAR(hit.point.uv.y, 0.75, 1e-5);
    EXPECT(look((sr_vec2){7, 5}, &hit)); // (-1, 3): bilinear z = 3/4 1/2
    EXPECT_NEAR(hit.point.p.z, 0.375, 1e-4);
    EXPECT(look((sr_vec2){6.25f, 6.25f}, &hit) && look((sr_vec2){9.75f, 9.75f}, &hit) &&
           !look((sr_vec2){10.5f, 8}, &hit));
    sr_import_result_free(&result);
    expect_error("WorldBegin\nShape \"plymesh\"", "2:1: Shape \"plymesh\": expected \"string filename\"");
}

TEST(alpha_cuts_holes)
{
    struct sr_hit hit;
    const char *camera =
        "LookAt 0 0 -10  0 0 0  0 1 0 Camera \"orthographic\" \"float screenwindow\" [ -8 8 -8 8 ] Film \"rgb\" "
        "\"integer xresolution\" 16 \"integer "
        "yresolution\" 16 WorldBegin Texture \"a\" \"float\" \"checkerboard\" \"float uscale\" 2 \"float vscale\" 2 ";
    char text[2048];
    snprintf(text, sizeof text,
             "%s Shape \"bilinearmesh\" \"point3 P\" [ -8 -8 0 8 -8 0 -8 8 0 8 8 0 ] \"texture alpha\" \"a\"", camera);
    import(text);
    EXPECT(look((sr_vec2){4, 12}, &hit) && look((sr_vec2){12, 4}, &hit) && !look((sr_vec2){4, 4}, &hit) &&
           !look((sr_vec2){12, 12}, &hit));
    sr_import_result_free(&result);
    snprintf(text, sizeof text, "%s Attribute \"shape\" \"float alpha\" 0 Shape \"sphere\" \"float radius\" 4", camera);
    import(text);
    EXPECT(!look((sr_vec2){8, 8}, &hit));
    sr_import_result_free(&result);
}

TEST(spectra_come_from_names_and_files)
{
    char path[1024];
    struct sr_error e = {0};
    const char *spd = "# a step\n400 0.25\n700 0.25 # end\n";
    snprintf(path, sizeof path, "%s/r.spd", test_folder());
    EXPECT_EQUAL_INT(sr_file_write(path, spd, strlen(spd), &e), SR_OK);
    import("WorldBegin AreaLightSource \"diffuse\" \"spectrum L\" \"r.spd\" Material \"conductor\" \"spectrum eta\" "
           "\"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\" " BALL
           "Material \"diffuse\" \"spectrum reflectance\" \"r.spd\" " BALL);
    EXPECT_EQUAL_TEXT(notes, "");
    sr_import_result_free(&result);
    EXPECT_EQUAL_INT(sr_file_write(path, "400 x", 5, &e), SR_OK);
    struct sr_import_options options = {.threads = 1};
    EXPECT_EQUAL_INT(import_with("WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"r.spd\" " BALL, &options),
                     SR_ERROR_INPUT);
    EXPECT(strstr(error.text, "r.spd:1: expected wavelengths (nm) and values, all of them numbers") != NULL);
}

/* Cut or changed anywhere, a scene is finished or refused with a reason. */
TEST(a_damaged_scene_is_finished_or_refused)
{
    static const char scene[] =
        "LookAt 3 4 1.5  .5 .5 0  0 0 1 Camera \"perspective\" \"float fov\" 45 Sampler \"halton\" \"integer "
        "pixelsamples\" 128\n"
        "Film \"rgb\" \"integer xresolution\" [40] \"integer yresolution\" 40 WorldBegin LightSource \"infinite\" "
        "\"rgb L\" [ .4 .45 .5 ]\n"
        "AttributeBegin AreaLightSource \"diffuse\" \"blackbody L\" 5000 \"float power\" 3 Shape \"disk\" "
        "AttributeEnd\n"
        "ObjectBegin \"o\" Shape \"sphere\" \"float radius\" 1 ObjectEnd ObjectInstance \"o\"\n"
        "Texture \"c\" \"spectrum\" \"checkerboard\" \"float uscale\" [16] \"rgb tex1\" [.1 .1 .1] Texture \"s\" "
        "\"spectrum\" \"scale\" \"texture tex\" \"c\" \"float scale\" .5\n"
        "Material \"coateddiffuse\" \"texture reflectance\" \"s\" \"float roughness\" .1 Translate 0 0 -1\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 0 20 -20 0 -20 20 0 20 20 0 ] \"point2 uv\" [ 0 0 1 0 1 1 0 1 "
        "]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 0 0 1 ] \"integer indices\" [ 0 1 2 1 2 3 ] \"normal "
        "N\" [ 0 0 1 0 0 1 0 0 1 0 0 1 ]\n";
    size_t size = sizeof scene - 1;
    uint32_t state = 99;
    struct sr_import_options options = {.threads = 1};
    for (int i = 0; i < 500; ++i) {
        char text[sizeof scene];
        memcpy(text, scene, sizeof scene);
        state = state * 1664525u + 1013904223u;
        if (i < 200)
            text[size * (size_t)i / 200] = 0;
        else
            text[(state >> 8) % size] = (char)(32 + (state >> 3) % 95);
        sr_status status = import_with(text, &options);
        EXPECT(status == SR_OK ||
               ((status == SR_ERROR_INPUT || status == SR_ERROR_RESOURCE) && error.text[0] && !result.scene));
        sr_import_result_free(&result);
    }
}
