/* SPDX-License-Identifier: MIT */
/* Lights with images and portals from scene text: what is taken, what is told, what is refused. */
#include "image/image.h"
#include "import/import.h"
#include "test.h"

static char notes[4096];

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user, (void)severity;
    snprintf(notes + strlen(notes), sizeof notes - strlen(notes), "%s\n", text);
}

static const char *write_image(const char *name, uint32_t width, uint32_t height)
{
    static char path[512];
    struct sr_image *image;
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    EXPECT(sr_image_create(width, height, 3, NULL, SR_IMAGE_FLOATS, &image, &error) == SR_OK);
    for (uint32_t i = 0; i < 3 * width * height; ++i)
        image->floats[i] = 1 + (float)(i % 5);
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    return path;
}

/* Imports the text after WorldBegin; the error's text, or "" */
static const char *import(const char *text, uint32_t *lights)
{
    static struct sr_error error;
    char path[512], scene[2048];
    struct sr_import_result result;
    struct sr_import_options options = {0};
    struct sr_log log = {.write = note};
    snprintf(path, sizeof path, "%s/s.pbrt", test_folder());
    snprintf(scene, sizeof scene, "WorldBegin\n%s\nShape \"sphere\"", text);
    error = (struct sr_error){0};
    notes[0] = 0;
    EXPECT(sr_file_write(path, scene, strlen(scene), &error) == SR_OK);
    if (sr_import_pbrt(path, &options, &result, &log, &error) == SR_OK && lights)
        *lights = sr_scene_lights(result.scene)->count;
    sr_import_result_free(&result);
    return error.text;
}

TEST(lights_take_latitude_longitude_maps_and_say_so)
{
    static const char *const lights[] = {"infinite", "goniometric"};
    for (int k = 0; k < 2; ++k) {
        char text[256];
        uint32_t count = 0;
        write_image("map.exr", 8, 4);
        snprintf(text, sizeof text, "LightSource \"%s\" \"string filename\" \"map.exr\"", lights[k]);
        EXPECT_EQUAL_TEXT(import(text, &count), "");
        EXPECT_EQUAL_INT(count, 1);
        EXPECT(strstr(notes, "8 x 4, taken as a latitude-longitude map") && strstr(notes, "octahedral one of 8 x 8"));
        write_image("map.exr", 8, 8);
        EXPECT_EQUAL_TEXT(import(text, &count), "");
        EXPECT(!strstr(notes, "latitude"));
        write_image("map.exr", 8, 5);
        EXPECT(strstr(import(text, NULL), ":2:1: LightSource") && strstr(import(text, NULL), "must be square") &&
               strstr(import(text, NULL), "8 x 5"));
    }
    uint32_t count = 0; // a projector takes any
    write_image("map.exr", 8, 5);
    EXPECT_EQUAL_TEXT(import("LightSource \"projection\" \"string filename\" \"map.exr\" \"float fov\" 40", &count),
                      "");
    EXPECT_EQUAL_INT(count, 1);
}

TEST(portals_are_read_and_checked)
{
    uint32_t count = 0;
    const char *head = "LightSource \"infinite\" \"point3 portal\" ";
    const struct {
        const char *rest, *error;
    } cases[] = {{"[0 0 3  0 1 3  2 1 3  2 0 3]", ""},
                 {"[0 0 3  0 1 3  2 1 3  2 0 3] \"string filename\" \"map.exr\" \"float illuminance\" 7", ""},
                 {"[0 0 3  0 1 3  2 1 3]", "has 3 corners: expected the 4 of a rectangle"},
                 {"[0 0 3  0 1 3  2 1 3  2 0.5 3]", "is no rectangle: expected 4 corners in turn"},
                 {"[0 0 3  0 1 3  2 1]", "portal"},
                 {"[0 0 3  0 1 3  2 1 3  2 0 3] \"rgb L\" [1 1 1] \"string filename\" \"map.exr\"", "not both"}};
    write_image("map.exr", 8, 8);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", head, cases[i].rest);
        const char *error = import(text, &count);
        EXPECT(strstr(error, cases[i].error) && (error[0] == 0) == (cases[i].error[0] == 0));
    }
    EXPECT_EQUAL_INT(count, 1);
}

TEST(lights_with_images_and_noise_refuse_nonsense)
{
    const struct {
        const char *text, *error;
    } cases[] = {
        {"LightSource \"goniometric\"", "needs the parameter \"filename\""},
        {"LightSource \"projection\" \"float fov\" 30", "needs the parameter \"filename\""},
        {"LightSource \"projection\" \"string filename\" \"map.exr\" \"float fov\" 200", "fov"},
        {"LightSource \"projection\" \"string filename\" \"map.exr\" \"float fov\" 0", "above 0 and below 180"},
        {"LightSource \"goniometric\" \"string filename\" \"none.exr\"", "none.exr"},
        {"Texture \"t\" \"float\" \"fbm\" \"integer octaves\" 65 Shape \"sphere\" \"texture alpha\" \"t\"", "octaves"},
        {"Texture \"t\" \"float\" \"wrinkled\" \"float roughness\" -1 Shape \"sphere\" \"texture alpha\" \"t\"",
         "roughness"},
        {"Texture \"t\" \"float\" \"directionmix\" \"vector3 dir\" [0 0 0] Shape \"sphere\" \"texture alpha\" \"t\"",
         "dir"},
        {"Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"map.exr\" \"string filter\" \"sharp\" Shape \"sphere\" \"texture alpha\" \"t\"",
         "filter"},
        {"Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"map.exr\" \"string encoding\" \"gamma -2\" Shape \"sphere\" \"texture alpha\" \"t\"",
         "gamma"}};
    write_image("map.exr", 8, 8);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const char *error = import(cases[i].text, NULL);
        if (!strstr(error, cases[i].error) || !strstr(error, "s.pbrt:2:"))
            test_fail(__FILE__, __LINE__, "case %zu: \"%s\", expected \"%s\"", i, error, cases[i].error);
    }
}
