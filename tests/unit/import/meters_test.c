/* SPDX-License-Identifier: MIT */
/* Comments that are directives: where they count and where not, what meters take from them, what is told of mistakes.
 */
#include "import/import.h"
#include "import/pbrt/description.h"
#include "test.h"

static char told[8192];

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    size_t n = strlen(told);
    if (severity == SR_WARNING)
        snprintf(told + n, sizeof told - n, "%s\n", text);
}

static struct sr_import_result result;
static struct sr_error error;

static sr_status import_again(void)
{
    char path[1024];
    struct sr_log log = {.write = note};
    snprintf(path, sizeof path, "%s/m.pbrt", test_folder());
    told[0] = 0;
    error = (struct sr_error){0};
    return sr_import_pbrt(path, NULL, &result, &log, &error);
}

static sr_status try_import(const char *text)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/m.pbrt", test_folder());
    error = (struct sr_error){0};
    EXPECT_EQUAL_INT(sr_file_write(path, text, strlen(text), &error), SR_OK);
    return import_again();
}

static void import(const char *text)
{
    if (try_import(text) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

static void expect_error(const char *text, const char *part)
{
    EXPECT_EQUAL_INT(try_import(text), SR_ERROR_INPUT);
    if (!strstr(error.text, part))
        test_fail(__FILE__, __LINE__, "\"%s\" was expected in: %s", part, error.text);
}

static void expect_warning(const char *text, const char *part)
{
    import(text);
    if (!strstr(told, part))
        test_fail(__FILE__, __LINE__, "\"%s\" was expected in: %s", part, told);
    sr_import_result_free(&result);
}

#define SPHERE "Shape \"sphere\"\n"
#define METER "#@ Meter \"irradiance\" \"string name\" \"a\" \"point3 p\" [1 2 3] \"normal n\" [0 1 0]\n"

static const char *name_of(uint32_t i)
{
    EXPECT(i < result.meter_count);
    return sr_meter_common(&result.meters[i])->name;
}

static struct sr_meter_place place_of(uint32_t i)
{
    struct sr_meter_place at;
    EXPECT(i < result.meter_count && result.meters[i].model->place(result.meters[i].self, (sr_vec2){0.5f, 0.5f}, &at));
    return at;
}

TEST(meters_stand_where_their_transform_puts_them)
{
    import(
        "WorldBegin " SPHERE METER
        "Translate 10 0 0\n#@ Meter \"irradiance\" \"point3 p\" [1 2 3]\nScale 2 2 2\n#@ Meter \"fluence\" \"point3 p\" [1 2 3]\n");
    EXPECT_EQUAL_INT(result.meter_count, 3);
    EXPECT_EQUAL_TEXT(name_of(0), "a");
    EXPECT_EQUAL_TEXT(name_of(1), "meter 2");
    EXPECT_NEAR(place_of(0).x.p.x, 1, 0);
    EXPECT_NEAR(place_of(0).frame.z.y, 1, 0);
    EXPECT_NEAR(place_of(1).x.p.x, 11, 0);
    EXPECT_NEAR(place_of(1).frame.z.z, 1, 0); // the normal's default
    EXPECT_NEAR(place_of(2).x.p.x, 12, 0);
    EXPECT_EQUAL_TEXT(told, "");
    sr_import_result_free(&result);
}

TEST(directives_in_comments_go_over_lines_of_their_own_and_no_others)
{
    // lines right below go on; anything between ends it; the parameters of the shape around are the shape's
    import(
        "WorldBegin\nShape \"sphere\"\n#@ Meter \"radiance\"   # a comment in a comment\n   #@ \"string name\" \"one\"\n#@\t\"vector3 d\" [1\n#@ 0 0]\n"
        "  \"float radius\" 2\n#@ Meter \"fluence\" \"string name\" \"two\"\n\n#@ Meter \"fluence\" \"string name\" \"three\"");
    EXPECT_EQUAL_INT(result.meter_count, 3);
    EXPECT_EQUAL_TEXT(name_of(0), "one");
    EXPECT_NEAR(place_of(0).frame.z.x, 1, 0);
    EXPECT_EQUAL_TEXT(name_of(2), "three");
    EXPECT_NEAR(sr_scene_bounds(result.scene).hi.z, 2, 1e-6); // the radius
    EXPECT_EQUAL_TEXT(told, "");
    sr_import_result_free(&result);
}

TEST(comments_and_strings_stay_what_they_are)
{
    import("WorldBegin " SPHERE
           "# @ Meter \"fluence\"\n#@Meter \"fluence\"\n## #@ Meter \"fluence\"\n# see #@ Meter \"fluence\"\n"
           "MakeNamedMaterial \"#@ Meter\" \"string type\" \"diffuse\"\nNamedMaterial \"#@ Meter\"\n" SPHERE);
    EXPECT_EQUAL_INT(result.meter_count, 0);
    EXPECT_EQUAL_TEXT(told, "");
    sr_import_result_free(&result);
}

TEST(a_scene_without_its_meters_is_the_same_scene)
{
    struct sr_arena data = {0};
    struct sr_error e = {0};
    size_t shapes[2], transforms[2];
    static const char *const texts[] = {
        "WorldBegin\nTranslate 1 2 3\nShape \"sphere\" \"float radius\" 2\nAttributeBegin Shape \"disk\" AttributeEnd\n",
        "WorldBegin\n#@ Name \"x\"\nTranslate 1 2 3\nShape \"sphere\" #@ Meter \"flux\"\n \"float radius\" 2\n" METER
        "AttributeBegin Shape \"disk\" " METER "AttributeEnd\n#@ Unknown \"a\" 1 [2 3]\n"};
    for (int i = 0; i < 2; ++i) {
        struct sr_pbrt_description d;
        EXPECT_EQUAL_INT(sr_pbrt_read_text("a", texts[i], strlen(texts[i]), &data, NULL, &d, &e), SR_OK);
        shapes[i] = d.shapes.count;
        transforms[i] = d.transforms.count;
        EXPECT_EQUAL_INT(d.meters.count, i ? 3 : 0);
        sr_pbrt_description_free(&d);
    }
    EXPECT(shapes[0] == shapes[1] && transforms[0] <= transforms[1]);
    sr_arena_free(&data);
}

TEST(unknown_comments_are_told_and_left)
{
    expect_warning("WorldBegin " SPHERE
                   "#@ Metre \"irradiance\" \"string name\" \"desk\"\n#@ \"point3 p\" [0 0 1]\n" METER,
                   "m.pbrt:2:4: #@ Metre is not known, and stays a comment: did you mean \"Meter\"?");
    import("WorldBegin " SPHERE "#@ Frobnicate 1 2 [3\n#@ Meter \"fluence\"\n");
    EXPECT_EQUAL_INT(result.meter_count, 1);
    sr_import_result_free(&result);
    expect_warning("WorldBegin " SPHERE "#@ Name \"late\"\n", "#@ Name \"late\": no shape comes after it");
}

TEST(mistakes_in_meters_tell_place_and_remedy)
{
    expect_error(METER "WorldBegin " SPHERE, "m.pbrt:1:4: Meter may not stand before WorldBegin");
    expect_error("WorldBegin " SPHERE "#@ Meter \"iradiance\"\n",
                 "m.pbrt:2:4: Meter \"iradiance\": there is no such kind of meter: did you mean \"irradiance\"?");
    expect_error("WorldBegin " SPHERE "#@ Meter irradiance\n",
                 "m.pbrt:2:10: Meter: irradiance: expected the name of a kind of meter");
    expect_error("WorldBegin " SPHERE "#@ Meter \"irradiance\" \"point3 p\" [1 2\n",
                 "among the values of \"point3 p\"");
    expect_error("WorldBegin " SPHERE "#@ Meter \"irradiance\" \"float p\" 3\n", "has the wrong type: expected point3");
    expect_error("WorldBegin " SPHERE "#@ Meter \"irradiance\" \"normal n\" [0 0 0]\n", "\"n\" has no direction");
    expect_error("WorldBegin " SPHERE "#@ Meter \"radiance\" \"float halfangle\" 200\n",
                 "is 200: expected 0 to 180 deg");
    expect_error("WorldBegin " SPHERE "#@ Meter \"semicylindrical\" \"vector3 facing\" [0 0 2]\n", "is along the axis");
    expect_error("WorldBegin " SPHERE METER METER,
                 "m.pbrt:3:4: Meter \"irradiance\": the name \"a\" is taken, by line 2");
    expect_error("WorldBegin " SPHERE "#@ Meter \"flux\"\n", "expected \"vector3 u\" and \"vector3 v\"");
    expect_error("WorldBegin " SPHERE
                 "#@ Meter \"irradiance\" \"string reading\" \"spectrum\" \"float lambda\" [400 -1 700]\n",
                 "first, step, last");
    expect_error("WorldBegin " SPHERE "#@ Meter \"irradiance\" \"string reading\" \"light\"\n",
                 "expected value|spectrum|colour");
    expect_error("WorldBegin\n#@ Name \"ball\"\n" SPHERE "#@ Meter \"flux\" \"string surface\" \"bal\"\n",
                 "m.pbrt:4:17: Meter \"flux\": no shape has the name \"bal\"");
    expect_error("WorldBegin\n#@ Name \"ball\"\n" SPHERE "#@ Meter \"fluence\" \"string surface\" \"ball\"\n",
                 "does not measure on a shape");
    expect_error("WorldBegin ObjectBegin \"o\"\n#@ Name \"ball\"\n" SPHERE
                 "ObjectEnd\n#@ Meter \"flux\" \"string surface\" \"ball\"\n",
                 "belongs to an object");
    expect_error("WorldBegin ObjectBegin \"o\"\n" SPHERE METER "ObjectEnd\n", "Meter inside of an object");
    expect_warning("WorldBegin " SPHERE "#@ Meter \"irradiance\" \"normal normals\" [0 0 1]\n",
                   "unused parameter \"normal normals\" of Meter \"irradiance\"");
}

TEST(shapes_of_one_name_are_one_surface)
{
    import("WorldBegin\n#@ Name \"s\"\n" SPHERE
           "Translate 5 0 0\n#@ Name \"s\"\nShape \"disk\" \"float radius\" 2\n" SPHERE
           "#@ Meter \"flux\" \"string surface\" \"s\"\n");
    EXPECT_EQUAL_INT(result.meter_count, 1);
    EXPECT_RELATIVE(sr_meter_common(&result.meters[0])->surface.area, 8 * (double)SR_PI, 1e-5); // 4 pi + 4 pi
    int on_disk = 0;
    struct sr_meter_place at;
    for (int i = 0; i < 1000; ++i) {
        EXPECT(result.meters[0].model->place(result.meters[0].self, (sr_vec2){((float)i + 0.5f) / 1000, 0.3f}, &at));
        EXPECT_RELATIVE(at.weight, 8 * (double)SR_PI, 1e-5);
        on_disk += at.x.p.x > 2;
    }
    EXPECT(abs(on_disk - 500) < 5);
    sr_import_result_free(&result);
}

TEST(no_directive_in_a_comment_is_lost_when_memory_ends)
{
    static const char text[] = "WorldBegin\n" METER SPHERE "#@ Meter \"fluence\" \"string name\" \"b\"\n";
    import(text);
    uint32_t meters = result.meter_count;
    sr_import_result_free(&result);
    uint64_t before = sr_alloc_count();
    EXPECT_EQUAL_INT(import_again(), SR_OK);
    uint64_t all = sr_alloc_count() - before;
    sr_import_result_free(&result);
    for (uint64_t i = 0; i < all; ++i) {
        sr_alloc_fail(i, 1);
        sr_status status = import_again();
        sr_alloc_fail(0, 0);
        EXPECT(status == SR_OK || status == SR_ERROR_RESOURCE);
        if (status != SR_OK)
            continue;
        EXPECT_EQUAL_INT(result.meter_count, meters);
        sr_import_result_free(&result);
    }
}
