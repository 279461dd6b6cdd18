/* SPDX-License-Identifier: MIT */
#include "import/pbrt/description.h"
#include "test.h"

static char warnings[4096];

static void note(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    (void)severity;
    size_t n = strlen(warnings);
    snprintf(warnings + n, sizeof warnings - n, "%s\n", text);
}

struct parsed {
    struct sr_arena data;
    struct sr_pbrt_description d;
    struct sr_error error;
    struct sr_log log;
};

static sr_status parse(struct parsed *p, const char *text)
{
    *p = (struct parsed){.log = {.write = note}};
    warnings[0] = 0;
    return sr_pbrt_read_text("a.pbrt", text, strlen(text), &p->data, &p->log, &p->d, &p->error);
}

static void forget(struct parsed *p)
{
    sr_pbrt_description_free(&p->d);
    sr_arena_free(&p->data);
}

static void expect_error(const char *text, const char *message)
{
    struct parsed p;
    EXPECT_EQUAL_INT(parse(&p, text), SR_ERROR_INPUT);
    EXPECT_EQUAL_TEXT(p.error.text, message);
    forget(&p);
}

TEST(errors_tell_file_line_column_and_what_was_expected)
{
    expect_error("WorldBegin\nShap \"sphere\"", "a.pbrt:2:1: unknown directive Shap: did you mean \"Shape\"?");
    expect_error("WorldBegin\nShape sphere", "a.pbrt:2:7: Shape: sphere: expected the name of a kind of shape");
    expect_error("Shape \"sphere\"", "a.pbrt:1:1: Shape may not stand before WorldBegin: expected after it");
    expect_error("WorldBegin Camera \"perspective\"",
                 "a.pbrt:1:12: Camera may not stand after WorldBegin: expected before it");
    expect_error("WorldBegin\n AttributeEnd", "a.pbrt:2:2: AttributeEnd without AttributeBegin before it");
    expect_error("WorldBegin\n\nAttributeBegin", "a.pbrt:3:1: AttributeBegin without AttributeEnd");
    expect_error("WorldBegin AttributeBegin ObjectEnd",
                 "a.pbrt:1:27: ObjectEnd: expected AttributeEnd, which belongs to line 1");
    expect_error("WorldBegin ObjectBegin \"a\" ObjectBegin \"b\"",
                 "a.pbrt:1:28: ObjectBegin \"b\" inside of another object: expected ObjectEnd before it");
    expect_error("WorldBegin ObjectBegin \"a\" ObjectInstance \"a\"",
                 "a.pbrt:1:28: ObjectInstance \"a\" inside of an object: expected outside");
    expect_error("Translate 1 2", "a.pbrt:1:14: Translate: the file ends: expected 3 numbers");
    expect_error("Translate 1 2 x", "a.pbrt:1:15: Translate: x: expected 3 numbers");
    expect_error("Scale 1 0 1", "a.pbrt:1:1: Scale 1 0 1: expected three numbers other than 0");
    expect_error("Transform [1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1]",
                 "a.pbrt:1:1: Transform: expected a transform that can be inverted");
    expect_error("Rotate 10 0 0 0", "a.pbrt:1:1: Rotate about the axis 0 0 0: expected an axis of some length");
    expect_error("ActiveTransform Never", "a.pbrt:1:17: ActiveTransform: expected All, StartTime or EndTime");
    expect_error("ColorSpace \"cmyk\"",
                 "a.pbrt:1:1: ColorSpace \"cmyk\": expected srgb, dci-p3, rec2020 or aces2065-1");
    expect_error("1 2 3", "a.pbrt:1:1: the number 1 stands alone: expected a directive");
    expect_error("Identity", "a.pbrt: the file ends before WorldBegin: expected a scene");
    expect_error("Option \"bool disable-pixel-jiter\" true",
                 "a.pbrt:1:8: Option: unknown option \"disable-pixel-jiter\": did you mean \"disablepixeljitter\"?");
    expect_error("WorldBegin Texture \"t\" \"colour\" \"constant\"",
                 "a.pbrt:1:12: Texture \"t\" \"colour\": expected \"float\" or \"spectrum\"");
    expect_error("WorldBegin Texture \"t\" \"float\" \"constant\"\nTexture \"t\" \"float\" \"constant\"",
                 "a.pbrt:2:1: Texture \"t\": the name is taken, by a.pbrt:1");
    expect_error("WorldBegin MakeNamedMaterial \"m\" \"float a\" 1",
                 "a.pbrt:1:12: MakeNamedMaterial \"m\": expected a parameter \"string type\"");
    expect_error(
        "Attribute \"lamp\" \"float a\" 1",
        "a.pbrt:1:1: Attribute \"lamp\": expected \"shape\", \"light\", \"material\", \"medium\" or \"texture\"");
    expect_error("Include \"/nowhere/at/all.pbrt\"",
                 "a.pbrt:1:1: /nowhere/at/all.pbrt: cannot be opened: No such file or directory");
}

TEST(wrong_values_tell_what_their_type_wants)
{
    expect_error("Film \"rgb\" \"integer xresolution\" [ 1.5 ]",
                 "a.pbrt:1:36: 1.5 is no value for \"integer xresolution\": expected a whole number of 32 bits");
    expect_error("Film \"rgb\" \"float a\" [ 1 2 z ]", "a.pbrt:1:28: z is no value for \"float a\": expected a number");
    expect_error("Film \"rgb\" \"float a\" [ 1 2",
                 "a.pbrt:1:27: the file ends among the values of \"float a\": expected a number");
    expect_error("Film \"rgb\" \"bool a\" maybe",
                 "a.pbrt:1:21: maybe is no value for \"bool a\": expected true or false");
    expect_error("Film \"rgb\" \"string a\" 5",
                 "a.pbrt:1:23: 5 is no value for \"string a\": expected a string in quotes");
    expect_error("Film \"rgb\" \"rgb a\" [ 1 2 ]", "a.pbrt:1:12: \"rgb a\" has 2 values: expected a multiple of 3");
    expect_error("Film \"rgb\" \"rgb a\" [ 1 -2 3 ]",
                 "a.pbrt:1:12: \"rgb a\" has the component -2: expected 0 or more");
    expect_error("Film \"rgb\" \"spectrum a\" [ 400 1 400 2 ]",
                 "a.pbrt:1:12: \"spectrum a\" has the wavelength 400 after 400: expected pairs of wavelength (nm, "
                 "increasing) and value");
    expect_error(
        "Film \"rgb\" \"floot a\" 1",
        "a.pbrt:1:12: unknown parameter type \"floot\"; expected bool, float, integer, point2, point3, vector2, "
        "vector3, normal, string, texture, rgb, blackbody or spectrum: did you mean \"float\"?");
    expect_error("Film \"rgb\" \"float\" 1",
                 "a.pbrt:1:12: parameter \"float\": expected \"type name\", such as \"float radius\"");
}

TEST(every_parameter_type_is_read)
{
    struct parsed p;
    EXPECT_EQUAL_INT(
        parse(&p, "Film \"rgb\" \"float f\" 1.5 \"integer i\" [ -3 4 0x10 ] \"bool b\" true \"bool c\" [ \"false\" "
                  "true ] \"point2 p2\" [ 1 2 ] "
                  "\"point P\" [ 1 2 3 4 5 6 ] \"vector2 v\" [1 2] \"vector3 w\" [1 2 3]\"normal3 N\" [0 0 1] \"normal "
                  "n\" [0 1 0] "
                  "\"string s\" [ \"x\" \"y\" ] \"texture t\" \"tex\" \"rgb c1\" [ .1 .2 .3 ] \"blackbody k\" 6500 "
                  "\"spectrum m\" \"metal-Ag-k\" \"spectrum d\" [ 400 1 700 2 ] WorldBegin"),
        SR_OK);
    const struct sr_pbrt_params *f = &p.d.film.params;
    EXPECT_EQUAL_INT(f->count, 16);
    EXPECT_NEAR(f->items[0].floats[0], 1.5, 0);
    EXPECT_EQUAL_INT(f->items[1].ints[0] + f->items[1].ints[1] * 10 + f->items[1].ints[2] * 100, -3 + 40 + 1600);
    EXPECT(f->items[2].ints[0] == 1 && f->items[3].ints[0] == 0 && f->items[3].ints[1] == 1);
    EXPECT_EQUAL_INT(f->items[5].type, SR_PBRT_POINT3);
    EXPECT_NEAR(f->items[5].floats[5], 6, 0);
    EXPECT_EQUAL_INT(f->items[8].type, SR_PBRT_NORMAL);
    EXPECT_EQUAL_TEXT(f->items[10].strings[1], "y");
    EXPECT_EQUAL_TEXT(f->items[11].strings[0], "tex");
    EXPECT(f->items[14].is_text && strcmp(f->items[14].strings[0], "metal-Ag-k") == 0);
    EXPECT(!f->items[15].is_text && f->items[15].count == 4);
    forget(&p);
}

TEST(shapes_remember_the_state_where_they_stand)
{
    struct parsed p;
    EXPECT_EQUAL_INT(
        parse(&p,
              "WorldBegin Shape \"a\"\n"
              "AttributeBegin Material \"conductor\" Translate 1 2 3 AreaLightSource \"diffuse\" ReverseOrientation\n"
              "Attribute \"shape\" \"float alpha\" 0.5 Attribute \"shape\" \"float alpha\" 0.25 \"float beta\" 1\n"
              "Shape \"b\" \"float radius\" 2\n"
              "AttributeEnd Shape \"c\" NamedMaterial \"m\" ColorSpace \"rec2020\" Shape \"d\" \"rgb r\" [1 1 1]"),
        SR_OK);
    EXPECT_EQUAL_INT(p.d.shapes.count, 4);
    const struct sr_pbrt_shape *s = p.d.shapes.data;
    const struct sr_pbrt_transform *t = p.d.transforms.data;
    EXPECT(s[0].material.index == 0 && s[0].area_light1 == 0 && !s[0].reverse_orientation);
    EXPECT(s[1].material.index == 1 && s[1].area_light1 == 1 && s[1].reverse_orientation);
    EXPECT_NEAR(t[s[1].entity.transform].start.m[1][3], 2, 0);
    EXPECT_NEAR(sr_pbrt_find(&s[1].entity.params, "alpha")->floats[0], 0.25, 0); // the newest default
    EXPECT(sr_pbrt_find(&s[1].entity.params, "beta")->is_default);
    EXPECT(s[2].material.index == 0 && s[2].area_light1 == 0 && !s[2].reverse_orientation &&
           s[2].entity.params.count == 0);
    EXPECT_NEAR(t[s[2].entity.transform].start.m[1][3], 0, 0);
    EXPECT_EQUAL_TEXT(s[3].material.name, "m");
    EXPECT_EQUAL_INT(s[3].entity.params.items[0].space, SR_REC2020);
    forget(&p);
}

static sr_vec3 through(const struct sr_matrix *a, sr_vec3 p)
{
    struct sr_transform t = sr_matrix_to_transform(a);
    return sr_transform_point(&t, p);
}

TEST(transforms_compose_from_the_right)
{
    struct parsed p;
    EXPECT_EQUAL_INT(parse(&p,
                           "Translate 0 0 5 CoordinateSystem \"x\" Camera \"perspective\" WorldBegin\n"
                           "Translate 1 0 0 Scale 2 2 2 Shape \"a\"\n"
                           "Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1 ] Shape \"b\"\n"
                           "CoordSysTransform \"camera\" Shape \"c\" CoordSysTransform \"x\" Shape \"d\"\n"
                           "Identity Rotate 90 0 0 1 Shape \"e\" ActiveTransform EndTime Translate 1 0 0 Shape \"f\""),
                     SR_OK);
    const struct sr_pbrt_shape *s = p.d.shapes.data;
    const struct sr_pbrt_transform *t = p.d.transforms.data;
    sr_vec3 q = through(&t[s[0].entity.transform].start, (sr_vec3){1, 1, 1});
    EXPECT(q.x == 3 && q.y == 2 && q.z == 2);
    q = through(&t[s[1].entity.transform].start, (sr_vec3){0, 0, 0});
    EXPECT(q.x == 7 && q.y == 8 && q.z == 9);
    EXPECT_NEAR(t[s[2].entity.transform].start.m[2][3], -5, 0);
    EXPECT_NEAR(t[s[3].entity.transform].start.m[2][3], 5, 0);
    q = through(&t[s[4].entity.transform].start, (sr_vec3){1, 0, 0});
    EXPECT_NEAR(q.y, 1, 1e-6);
    EXPECT_NEAR(t[s[5].entity.transform].start.m[0][3], 0, 1e-6);
    EXPECT_NEAR(t[s[5].entity.transform].end.m[1][3], 1, 1e-6);
    EXPECT(strstr(warnings, "moves") == NULL);
    forget(&p);
}

TEST(names_are_found_among_many)
{
    struct sr_pbrt_names names = {0};
    char text[2000][8];
    for (uint32_t i = 0; i < 2000; ++i) {
        snprintf(text[i], sizeof text[i], "n%u", i);
        EXPECT_EQUAL_INT(sr_pbrt_names_find(&names, text[i]), 0);
        EXPECT(sr_pbrt_names_add(&names, text[i], i + 1));
    }
    for (uint32_t i = 0; i < 2000; ++i)
        EXPECT_EQUAL_INT(sr_pbrt_names_find(&names, text[i]), i + 1);
    EXPECT_EQUAL_INT(sr_pbrt_names_find(&names, "n2000"), 0);
    EXPECT_EQUAL_INT(names.count, 2000);
    sr_pbrt_names_free(&names);
}

TEST(warnings_tell_what_is_odd)
{
    struct parsed p;
    EXPECT_EQUAL_INT(parse(&p, "WorldBegin TransformBegin TransformEnd TransformBegin TransformEnd\nCoordSysTransform "
                               "\"wurld\"\nWorldEnd"),
                     SR_OK);
    EXPECT_EQUAL_INT(p.log.warning_count, 3);
    EXPECT(strstr(warnings, "a.pbrt:2:1: CoordSysTransform \"wurld\": no coordinate system has this name; the "
                            "transform stays as it is: did you mean \"world\"?"));
    forget(&p);
}

static void write_text(const char *path, const char *text)
{
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_file_write(path, text, strlen(text), &e), SR_OK);
}

TEST(includes_nest_and_errors_tell_the_way)
{
    char path[4][1024], expected[4096];
    static const char *const names[] = {"main.pbrt", "b.pbrt", "c.pbrt", "loop.pbrt"};
    for (int i = 0; i < 4; ++i)
        snprintf(path[i], sizeof path[i], "%s/%s", test_folder(), names[i]);
    write_text(path[0], "WorldBegin\n  Include \"b.pbrt\"\nShape \"z\"");
    write_text(path[1], "Translate 1 0 0\nImport \"c.pbrt\"");
    write_text(path[2], "Translate 0 1 0 Shape \"y\"\nShape \"q\" \"float r\" oops");
    write_text(path[3], "Include \"loop.pbrt\"");
    struct parsed p = {0};
    EXPECT_EQUAL_INT(sr_pbrt_read(path[0], &p.data, NULL, &p.d, &p.error), SR_ERROR_INPUT);
    snprintf(
        expected, sizeof expected,
        "%s:2:21: oops is no value for \"float r\": expected a number (included from %s:2:1) (included from %s:2:3)",
        path[2], path[1], path[0]);
    EXPECT_EQUAL_TEXT(p.error.text, expected);
    forget(&p);
    p = (struct parsed){0};
    EXPECT_EQUAL_INT(sr_pbrt_read(path[3], &p.data, NULL, &p.d, &p.error), SR_ERROR_INPUT);
    EXPECT(strstr(p.error.text, "this file is being read already") != NULL);
    forget(&p);
    // Include leaves its transform behind, Import does not
    write_text(path[2], "Translate 0 1 0 Shape \"y\"");
    p = (struct parsed){0};
    EXPECT_EQUAL_INT(sr_pbrt_read(path[0], &p.data, NULL, &p.d, &p.error), SR_OK);
    const struct sr_pbrt_shape *s = p.d.shapes.data;
    const struct sr_pbrt_transform *t = p.d.transforms.data;
    EXPECT_EQUAL_INT(p.d.shapes.count, 2);
    EXPECT(t[s[0].entity.transform].start.m[0][3] == 1 && t[s[0].entity.transform].start.m[1][3] == 1);
    EXPECT(t[s[1].entity.transform].start.m[0][3] == 1 && t[s[1].entity.transform].start.m[1][3] == 0);
    forget(&p);
}

/* Cut anywhere, or with a byte changed anywhere, a scene is read or refused; nothing else happens. */
TEST(a_damaged_scene_is_read_or_refused)
{
    static const char scene[] =
        "LookAt 3 4 1.5  .5 .5 0  0 0 1\nCamera \"perspective\" \"float fov\" 45\nSampler \"halton\" \"integer "
        "pixelsamples\" 128\n"
        "Film \"rgb\" \"string filename\" \"simple.png\" \"integer xresolution\" [400]\nWorldBegin\n# light\n"
        "LightSource \"infinite\" \"rgb L\" [ .4 .45 .5 ] \"spectrum I\" [ 400 1 500 2e0 "
        "]\nAttributeBegin\nAreaLightSource \"diffuse\" \"blackbody L\" 5000\n"
        "ObjectBegin \"o\" Shape \"sphere\" \"float radius\" 1 ObjectEnd AttributeEnd ObjectInstance \"o\"\n"
        "Texture \"checks\" \"spectrum\" \"checkerboard\" \"float uscale\" [16] \"rgb tex1\" [.1 .1 .1] \"string "
        "a\\\"b\" \"c\"\n"
        "Material \"diffuse\" \"texture reflectance\" \"checks\" Translate 0 0 -1 ConcatTransform [1 0 0 0 0 1 0 0 0 0 "
        "1 0 0 0 0 1]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ -20 -20 0 20 -20 0 -20 20 0 20 20 0 ] \"point2 uv\" [ 0 0 1 0 1 1 0 1 ] "
        "\"bool b\" [ true \"false\" ]\n";
    size_t size = sizeof scene - 1;
    uint32_t state = 12345;
    for (int i = 0; i < 3000; ++i) {
        char *copy = malloc(size + 1); // of its own size, so that a sanitizer sees the end
        EXPECT(copy != NULL);
        memcpy(copy, scene, size + 1);
        state = state * 1664525u + 1013904223u;
        size_t n = i < (int)size ? (size_t)i : size;
        if (i >= (int)size)
            copy[(state >> 8) % size] = (char)(state >> 3);
        char *cut = malloc(n + 1);
        EXPECT(cut != NULL);
        memcpy(cut, copy, n);
        cut[n] = 0;
        struct sr_arena data = {0};
        struct sr_pbrt_description d;
        struct sr_error e = {0};
        sr_status status = sr_pbrt_read_text("cut.pbrt", cut, n, &data, NULL, &d, &e);
        EXPECT(status == SR_OK || (status == SR_ERROR_INPUT && e.text[0]));
        sr_pbrt_description_free(&d);
        sr_arena_free(&data);
        free(copy);
        free(cut);
    }
}
