/* SPDX-License-Identifier: MIT */
/* MakeNamedMedium: every kind through scene text, and what is told of mistakes. */
#include "test.h"

#include "import/import.h"

static struct sr_import_result result;
static struct sr_error error;
static char notes[4096];

static void keep(void *user, enum sr_severity level, const char *text)
{
    (void)user, (void)level;
    strncat(notes, text, sizeof notes - strlen(notes) - 1);
}

static sr_status import_medium(const char *parameters)
{
    char path[512], text[2048];
    struct sr_log log = {.write = keep};
    struct sr_import_options options = {.integrator = NULL};
    snprintf(path, sizeof path, "%s/named.pbrt", test_folder());
    snprintf(
        text, sizeof text,
        "WorldBegin\nTranslate 0 0 1 Scale 2 2 2\nMakeNamedMedium \"m\" %s\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\" \"float radius\" 3\n",
        parameters);
    notes[0] = 0;
    error = (struct sr_error){0};
    EXPECT(sr_file_write(path, text, strlen(text), &error) == SR_OK);
    return sr_import_pbrt(path, &options, &result, &log, &error);
}

static struct sr_medium_at look(const char *parameters, float x, float y, float z)
{
    struct sr_wavelengths w = sr_wavelengths_sample((struct sr_lambda_range){380, 720}, 0.3f);
    struct sr_medium_at at = {.g = NAN};
    if (import_medium(parameters) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    const struct sr_medium *m =
        sr_scene_medium_at(result.scene, &(struct sr_ray){.o = {x, y, z}, .d = {0, 0, 1}, .t_max = INFINITY});
    EXPECT(m != NULL);
    m->model->at(m->self, (sr_vec3){x, y, z}, &w, &at);
    sr_import_result_free(&result);
    return at;
}

static void expect_refusal(const char *parameters, const char *message)
{
    EXPECT_EQUAL_INT(import_medium(parameters), SR_ERROR_INPUT);
    if (!strstr(error.text, message))
        test_fail(__FILE__, __LINE__, "expected \"%s\": %s", message, error.text);
}

TEST(media_of_all_kinds_are_made_from_text)
{
    struct sr_medium_at at =
        look("\"string type\" \"homogeneous\" \"float scale\" 2 \"rgb sigma_a\" [ .5 .5 .5 ] \"float g\" .7", 0, 0, 1);
    EXPECT_NEAR(at.sigma_a[2], 1, 1e-3);
    EXPECT_NEAR(at.sigma_s[2], 2, 1e-6); // not given: 1
    EXPECT_NEAR(at.g, 0.7, 1e-6);
    at = look("\"string type\" \"homogeneous\" \"string preset\" \"Spectralon\" \"float scale\" 1000", 0, 0, 1);
    EXPECT_NEAR(at.sigma_a[1], 0, 0);
    EXPECT(at.sigma_s[1] > 10e3f && at.sigma_s[1] < 23e3f);
    at = look("\"string type\" \"uniformgrid\" \"integer nz\" 2 \"float density\" [ 1 3 ]", 1, 1,
              1 + 2 * 0.25f); // the voxels' boxes are twice as large
    EXPECT_NEAR(at.sigma_a[0], 1, 1e-5);
    at = look(
        "\"string type\" \"uniformgrid\" \"integer nz\" 2 \"float density\" [ 1 3 ] \"point3 p0\" [ 0 0 -1 ] \"rgb Le\" [ 2 2 2 ] \"float Lescale\" 3",
        1, 1, 1);
    EXPECT_NEAR(at.sigma_a[0], 2, 1e-5);
    EXPECT(at.Le[3] > 0);
    at = look("\"string type\" \"rgbgrid\" \"integer ny\" 2 \"rgb sigma_s\" [ 1 1 1 3 3 3 ]", 1, 1.5f, 2);
    EXPECT_NEAR(at.sigma_s[0], 3, 1e-2); // the middle of the second voxel
    EXPECT_NEAR(at.sigma_a[0], 1, 1e-6);
    at = look("\"string type\" \"cloud\" \"spectrum sigma_s\" [ 300 4 900 4 ]", 0, -0.5f, 1);
    EXPECT_NEAR(at.sigma_s[0], 4, 1e-5);
}

TEST(mistakes_in_media_are_told_with_their_place)
{
    expect_refusal(
        "\"string type\" \"smoke\"",
        "named.pbrt:3:1: MakeNamedMedium \"smoke\" is not supported yet; supported: homogeneous, uniformgrid, rgbgrid, cloud, nanovdb");
    expect_refusal("\"string type\" \"homogeneous\" \"string preset\" \"Wholmilk\"",
                   "there is no preset of a medium named \"Wholmilk\": did you mean \"Wholemilk\"?");
    expect_refusal("\"string type\" \"homogeneous\" \"float g\" 1", "is 1: expected -0.9999 to 0.9999");
    expect_refusal("\"string type\" \"uniformgrid\" \"float density\" [ 1 2 3 ] \"integer nx\" 2",
                   "\"density\" has 3 values: expected nx ny nz = 2 x 1 x 1 of them");
    expect_refusal("\"string type\" \"uniformgrid\" \"rgb density\" [ 1 2 3 ]", "wrong type");
    expect_refusal("\"string type\" \"uniformgrid\" \"float density\" 1 \"integer nx\" 0", "expected 1 to");
    expect_refusal("\"string type\" \"rgbgrid\" \"float sigma_a\" [ 1 2 3 ]", "wrong type: expected rgb");
    expect_refusal("\"string type\" \"nanovdb\"", "expected a parameter \"string filename\"");
    expect_refusal("\"string type\" \"nanovdb\" \"string filename\" \"none.nvdb\"", "none.nvdb");
    expect_refusal("\"string type\" \"nanovdb\" \"string filename\" \"named.pbrt\"", "is no NanoVDB file");
    EXPECT(import_medium("\"string type\" \"homogeneous\" \"rgb sigma_z\" [ 1 1 1 ]") == SR_OK);
    EXPECT(strstr(notes, "unused parameter \"rgb sigma_z\"") && strstr(notes, "did you mean \"sigma_"));
    sr_import_result_free(&result);
}
