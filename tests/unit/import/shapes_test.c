/* SPDX-License-Identifier: MIT */
/* Shapes of scene files that become others: strands of hair one shape, control meshes triangles. */
#include "import/import.h"
#include "test.h"

static char notes[4096];

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    size_t n = strlen(notes);
    if (severity == SR_WARNING)
        snprintf(notes + n, sizeof notes - n, "%s\n", text);
}

static struct sr_import_result result;
static struct sr_error error;

static sr_status import(const char *text)
{
    static char path[1024];
    struct sr_log log = {.write = note};
    struct sr_import_options options = {.threads = 1};
    snprintf(path, sizeof path, "%s/shapes.pbrt", test_folder());
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_file_write(path, text, strlen(text), &error), SR_OK);
    notes[0] = 0;
    return sr_import_pbrt(path, &options, &result, &log, &error);
}

static struct sr_scene_counts counts_of(const char *text)
{
    if (import(text) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_scene_counts counts = sr_scene_count(result.scene);
    sr_import_result_free(&result);
    return counts;
}

static void expect_error(const char *text, const char *says)
{
    EXPECT_EQUAL_INT(import(text), SR_ERROR_INPUT);
    if (!strstr(error.text, says))
        test_fail(__FILE__, __LINE__, "expected \"%s\" in \"%s\"", says, error.text);
}

#define STRAND "Shape \"curve\" \"point3 P\" [0 0 0 0 0 1 0 0 2 0 0 3] "

TEST(curves_with_all_else_in_common_are_one_shape)
{
    enum { strands = 300 };
    static char text[strands * 100 + 100];
    strcpy(text, "WorldBegin\n");
    for (int i = 0; i < strands; ++i)
        strcat(text, i % 2 ? STRAND "\n" : STRAND "\"float width0\" .1 \"string basis\" \"bspline\"\n");
    struct sr_scene_counts c = counts_of(text);
    EXPECT_EQUAL_INT(c.objects, 1);
    EXPECT_EQUAL_INT(c.curves, strands);
    EXPECT(c.geometry_B < 100000); // some 64 B a strand
}

TEST(curves_with_another_state_are_another_shape)
{
    static const char *const between[] = {
        "Material \"diffuse\"\n",
        "ReverseOrientation\n",
        "Translate 1 0 0\n",
        "Shape \"sphere\"\n",
        "Attribute \"shape\" \"float alpha\" 0.5\n",
        "#@ Name \"strand\"\n",
        "ObjectBegin \"o\"\n",
    };
    for (size_t i = 0; i < sizeof between / sizeof *between; ++i) {
        char text[1024];
        snprintf(text, sizeof text, "WorldBegin\n" STRAND "\n" STRAND "\n%s" STRAND "\n%s", between[i],
                 strstr(between[i], "Object") ? "ObjectEnd ObjectInstance \"o\"\n" : "");
        struct sr_scene_counts c = counts_of(text);
        EXPECT_EQUAL_INT(c.curves, 3);
        EXPECT_EQUAL_INT(c.objects, 2 + (c.quadrics > 0));
    }
    EXPECT_EQUAL_INT(counts_of("WorldBegin\n" STRAND "\n" STRAND "\"string type\" \"cylinder\"\n").objects, 2);
    // what changes nothing does not part them
    EXPECT_EQUAL_INT(counts_of("WorldBegin\n" STRAND "\nAttributeBegin\n" STRAND
                               "\nAttributeEnd\nAttributeBegin Identity\n" STRAND "AttributeEnd\n")
                         .objects,
                     1);
}

TEST(curves_stand_where_the_file_says)
{
    EXPECT_EQUAL_INT(
        import(
            "WorldBegin\nTranslate 10 0 0\nScale 2 2 2\nShape \"curve\" \"point3 P\" [0 0 0 0 0 1 0 0 2 0 0 3] \"float width\" 0.5\n"
            "Shape \"curve\" \"point3 P\" [0 5 0 0 5 1 0 5 2 0 5 3] \"float width\" 0.25\n"),
        SR_OK);
    struct sr_hit hit;
    for (int strand = 0; strand < 2; ++strand)
        for (int side = -1; side <= 1; side += 2) {
            float half = strand ? 0.25f : 0.5f, y = strand ? 10 : 0;
            struct sr_ray in = {.o = {0, y + (float)side * 0.99f * half, 3}, .d = {1, 0, 0}, .t_max = INFINITY},
                          out = in;
            out.o.y = y + (float)side * 1.01f * half;
            EXPECT(sr_raycast(result.scene, &in, &hit));
            EXPECT_NEAR(hit.t, 10, 1e-5);
            EXPECT_NEAR(hit.point.p.x, 10, 1e-5);
            EXPECT_NEAR(hit.point.uv.x, 0.5, 1e-5);
            EXPECT_NEAR(hit.point.uv.y, side < 0 ? 0.995 : 0.005, 1e-4); // b = (1 0 0) x (0 0 1) = (0 -1 0)
            EXPECT(!sr_raycast(result.scene, &out, &hit));
        }
    sr_import_result_free(&result);
}

TEST(what_is_wrong_with_a_curve_is_told_where_it_stands)
{
    expect_error("WorldBegin\n" STRAND "\n" STRAND "\nShape \"curve\" \"point3 P\" [0 0 0 1 1 1]\n",
                 "s.pbrt:4:1: Shape \"curve\": curve: 2 \"P\", expected 4");
    expect_error("WorldBegin\n" STRAND "\"integer degree\" 4\n", "expected 2 to 3");
    expect_error("WorldBegin\n" STRAND "\"string basis\" \"hermite\"\n", "expected bezier|bspline");
    expect_error("WorldBegin\n" STRAND "\"string type\" \"tube\"\n", "expected flat|ribbon|cylinder");
    expect_error("WorldBegin\n" STRAND "\"float width\" -1\n", "expected 0 or more");
    expect_error("WorldBegin\n" STRAND "\"string type\" \"ribbon\"\n", "0 \"N\", expected 2");
    expect_error("WorldBegin\nShape \"curve\"\n", "0 \"P\"");
    expect_error("WorldBegin\n#@ Name \"hair\"\n" STRAND "\n#@ Meter \"flux\" \"string surface\" \"hair\"\n",
                 "which turns to whoever looks");
    expect_error("WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 31\n", "expected 0 to 30");
    expect_error(
        "WorldBegin\nShape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2] \"integer levels\" 20\n",
        "at most");
    expect_error("WorldBegin\nShape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n", "\"indices\" is missing");
}

TEST(an_image_for_sampling_does_not_shine)
{
    const char *patch =
        "WorldBegin\nAreaLightSource \"diffuse\"\nShape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"string emissionfilename\" \"no.png\"\n";
    EXPECT_EQUAL_INT(counts_of(patch).lights, 1);
    EXPECT(strstr(notes, "shapes.pbrt:3:") && strstr(notes, "does not glow"));
}

TEST(curves_do_not_shine)
{
    struct sr_scene_counts c = counts_of("WorldBegin\nAreaLightSource \"diffuse\"\n" STRAND "\n" STRAND);
    EXPECT_EQUAL_INT(c.lights, 0);
    EXPECT(strstr(notes, "a curve cannot shine"));
    counts_of("WorldBegin\n" STRAND "\"normal N\" [0 1 0 0 1 0]\n");
    EXPECT(strstr(notes, "only ribbons have \"N\""));
}

/* A strip turns to the ray in the space of its object, at the ray's time: only then does the point lie on the ray. */
TEST(curves_of_instances_and_moving_ones_face_the_ray)
{
    static const char *const scenes[] = {
        "WorldBegin\nObjectBegin \"o\"\n" STRAND
        "ObjectEnd\nRotate 70 1 2 0\nScale 1 2 3\nTranslate 1 1 0\nObjectInstance \"o\"\n",
        "WorldBegin\nActiveTransform EndTime\nRotate 90 1 0 0\nActiveTransform All\n" STRAND "\n",
        "WorldBegin\nObjectBegin \"o\"\n" STRAND
        "ObjectEnd\nActiveTransform EndTime\nTranslate 2 0 0\nRotate 60 1 1 0\nActiveTransform All\nObjectInstance \"o\"\n",
    };
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; ++k) {
        if (import(scenes[k]) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        struct sr_box b = sr_scene_bounds(result.scene);
        struct sr_rng rng = sr_rng_seed(3, 1);
        int met = 0;
        for (int i = 0; i < 4000; ++i) {
            sr_vec3 v = {sr_rng_float(&rng), sr_rng_float(&rng), sr_rng_float(&rng)}, e = sr_box_diagonal(b);
            sr_vec3 aim = {b.lo.x + v.x * e.x, b.lo.y + v.y * e.y, b.lo.z + v.z * e.z};
            sr_vec3 d = sr_warp_uniform_sphere((sr_vec2){sr_rng_float(&rng), sr_rng_float(&rng)});
            struct sr_ray ray = {.o = sr_mad(aim, -20, d), .d = d, .time = sr_rng_float(&rng), .t_max = INFINITY};
            struct sr_hit hit;
            if (!sr_raycast(result.scene, &ray, &hit))
                continue;
            ++met;
            EXPECT_NEAR(sr_length(sr_sub(hit.point.p, sr_mad(ray.o, hit.t, d))), 0, 2e-3);
            EXPECT_EQUAL_INT(hit.point.time == ray.time, 1);
        }
        EXPECT(met > 100);
        sr_import_result_free(&result);
    }
}
