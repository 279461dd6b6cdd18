/* SPDX-License-Identifier: MIT */
/* MediumInterface: which medium is on which side of a surface, around the camera, and at any point; and who renders
 * that. */
#include "test.h"

#include "import/import.h"

static struct sr_import_result result;
static char notes[4096];

static void keep(void *user, enum sr_severity level, const char *text)
{
    (void)user, (void)level;
    strncat(notes, text, sizeof notes - strlen(notes) - 1);
}

static sr_status import_with(const char *text, const char *integrator, struct sr_error *error)
{
    char path[512];
    snprintf(path, sizeof path, "%s/media.pbrt", test_folder());
    struct sr_log log = {.write = keep};
    struct sr_import_options options = {.integrator = integrator};
    notes[0] = 0;
    if (sr_file_write(path, text, strlen(text), error) != SR_OK)
        return error->status;
    return sr_import_pbrt(path, &options, &result, &log, error);
}

static void import(const char *text)
{
    struct sr_error error = {0};
    if (import_with(text, NULL, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

/* sigma_a of the medium at p, looking toward d; 0: vacuum. Media of the tests differ in it. */
static float thickness_at(sr_vec3 p, sr_vec3 d)
{
    const struct sr_medium *m = sr_scene_medium_at(result.scene, &(struct sr_ray){.o = p, .d = d, .t_max = INFINITY});
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){SR_LAMBDA_MIN, SR_LAMBDA_MAX}, 0.5f);
    struct sr_medium_at at = {.sigma_a = SR_BLACK};
    if (m)
        m->model->at(m->self, p, &w, &at);
    return at.sigma_a[0];
}

static float thickness(float x, float y, float z)
{
    sr_vec3 p = {x, y, z};
    float one = thickness_at(p, (sr_vec3){0, 0, 1});
    EXPECT(thickness_at(p, (sr_vec3){0.6f, 0.8f, 0}) == one);
    EXPECT(thickness_at(p, (sr_vec3){-0.6f, 0, -0.8f}) == one);
    return one;
}

#define MEDIUM(name, sigma)                                                                                            \
    "MakeNamedMedium \"" name "\" \"string type\" \"homogeneous\" \"spectrum sigma_a\" [300 " sigma " 900 " sigma "]\n"
#define MEDIA MEDIUM("thin", "1") MEDIUM("thick", "2")
#define BALL(radius) "Shape \"sphere\" \"float radius\" " radius "\n"

TEST(media_are_where_interfaces_say)
{
    import(MEDIA "MediumInterface \"\" \"thin\"\nCamera \"perspective\"\nWorldBegin\nMaterial \"interface\"\n"
                 "AttributeBegin MediumInterface \"thick\" \"thin\" " BALL(
                     "2") "AttributeEnd\n"
                          "AttributeBegin MediumInterface \"\" \"thick\" " BALL(
                              "1") "AttributeEnd\n"
                                   // same on both sides: nothing is said
                                   "Material \"diffuse\" MediumInterface \"thin\" \"thin\" " BALL("0.25"));
    EXPECT(sr_scene_has_media(result.scene) && sr_scene_has_interfaces(result.scene));
    EXPECT(sr_scene_sensor_medium(result.scene) != NULL);
    EXPECT(thickness(0.1f, 0, 0.5f) == 0);
    EXPECT(thickness(0.1f, 0, 0.1f) == 0);
    EXPECT(thickness(0.1f, 0, 1.5f) == 2);
    EXPECT(thickness(0.1f, 0, 2.5f) == 1);
    EXPECT(thickness(50, 20, 8) == 1);
    EXPECT_EQUAL_TEXT(result.integrator.model->name, "volpath");
    sr_import_result_free(&result);
}

TEST(what_is_around_is_what_the_outermost_surface_says)
{
    // the camera stands in the room's fog, the world outside is clear
    import(MEDIA "MediumInterface \"\" \"thick\"\nCamera \"perspective\"\nWorldBegin\nMaterial \"diffuse\"\n"
                 "MediumInterface \"thick\" \"\" " BALL("2"));
    EXPECT(sr_scene_has_media(result.scene) && !sr_scene_has_interfaces(result.scene));
    EXPECT(thickness(0, 0.1f, 0) == 2);
    EXPECT(thickness(0, 30, 0) == 0);
    sr_import_result_free(&result);
    import("WorldBegin\nMaterial \"interface\"\n" BALL("2"));
    EXPECT(!sr_scene_has_media(result.scene) && sr_scene_sensor_medium(result.scene) == NULL);
    EXPECT_EQUAL_INT((int)sr_scene_count(result.scene).quadrics, 1);
    EXPECT_EQUAL_TEXT(result.integrator.model->name, "path");
    sr_import_result_free(&result);
}

TEST(media_of_objects_go_with_their_instances)
{
    import(MEDIA "WorldBegin\nObjectBegin \"o\"\nMaterial \"interface\" MediumInterface \"thick\" \"\" " BALL(
        "1") "ObjectEnd\n"
             "Translate 5 0 0 Scale 1 1 -1 ObjectInstance \"o\"\n");
    EXPECT(sr_scene_has_media(result.scene) && sr_scene_has_interfaces(result.scene));
    EXPECT(thickness(5, 0.1f, 0.2f) == 2);
    EXPECT(thickness_at((sr_vec3){3, 0.1f, 0.2f}, (sr_vec3){1, 0, 0}) == 0);
    sr_import_result_free(&result);
}

TEST(estimators_without_media_say_so_or_give_way)
{
    static const char scene[] = MEDIA "MediumInterface \"thin\"\nCamera \"perspective\"\nWorldBegin\n" BALL("2");
    static const char *const asked[] = {"path", "bdpt,maxdepth=7", "lightpath", "sppm", "simplevolpath", "simplepath"};
    static const char *const given[] = {"path", "volpath", "volpath", "volpath", "simplevolpath", "simplepath"};
    for (int i = 0; i < 6; ++i) {
        struct sr_error error = {0};
        if (import_with(scene, asked[i], &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        EXPECT_EQUAL_TEXT(result.integrator.model->name, given[i]);
        EXPECT((strstr(notes, "knows no media") != NULL) == (i >= 1 && i <= 3));
        const char *blind = sr_integrator_blind(&result.integrator, result.scene);
        EXPECT((blind && strstr(blind, "vacuum")) == (i == 0 || i == 5));
        sr_import_result_free(&result);
    }
}

TEST(names_of_media_must_be_known)
{
    static const char *const texts[] = {
        MEDIA "WorldBegin\nMediumInterface \"thikc\" \"\" " BALL("1"),
        MEDIA "MediumInterface \"\" \"thikc\"\nCamera \"perspective\" WorldBegin " BALL("1"),
        MEDIA "WorldBegin\nMediumInterface \"\" \"thikc\" LightSource \"point\"",
    };
    for (int i = 0; i < 3; ++i) {
        struct sr_error error = {0};
        EXPECT(import_with(texts[i], NULL, &error) == SR_ERROR_INPUT);
        EXPECT(strstr(error.text, "no medium named \"thikc\": did you mean \"thick\"?") != NULL &&
               strstr(error.text, "media.pbrt:"));
    }
}
