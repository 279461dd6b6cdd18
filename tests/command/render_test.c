/* SPDX-License-Identifier: MIT */
/* The Cornell box, small: every format, JSON with units, one sample alone, standard input. */
#include "run.h"

#define TINY " --resolution 32,32 --spp 4 "

TEST(render_writes_every_format_alike)
{
    run_expecting(0, "render " CORNELL TINY "-o c.exr -o c.png -o c.pfm -o c.hdr --quiet");
    struct sr_image *exr = get_image("c.exr"), *pfm = get_image("c.pfm"), *hdr = get_image("c.hdr"),
                    *png = get_image("c.png");
    static const char *const names[] = {"R", "G", "B"};
    for (uint32_t c = 0; c < 3; ++c) {
        EXPECT_EQUAL_INT(sr_image_find_channel(exr, names[c]), c);
        EXPECT_EQUAL_TEXT(exr->channels[c].unit, "cd/m^2");
    }
    EXPECT(sr_image_find_channel(exr, "SE.R") > 0 && sr_image_find_channel(exr, "depth") > 0 &&
           sr_image_find_channel(exr, "albedo.G") > 0);
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(exr, "steradian.samplesPerPixel"), "4");
    EXPECT(sr_image_get_attribute(exr, "steradian.complete") == NULL);
    double sum = 0;
    for (uint32_t y = 0; y < 32; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const float *e = exr->floats + sr_image_index(exr, x, y), *p = pfm->floats + sr_image_index(pfm, x, y),
                        *h = hdr->floats + sr_image_index(hdr, x, y);
            float largest = fmaxf(e[0], fmaxf(e[1], e[2]));
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(p[c], e[c], 0);
                EXPECT_NEAR(h[c], fmaxf(e[c], 0), largest / 127); // eight bits beside a common exponent
                sum += (double)e[c];
            }
        }
    EXPECT(sum > 0);
    EXPECT(png->bytes != NULL && png->width == 32 && png->height == 32);
    sr_image_free(exr);
    sr_image_free(pfm);
    sr_image_free(hdr);
    sr_image_free(png);
    EXPECT_EQUAL_INT(count_files(".part-"), 0);
}

TEST(render_is_quiet_when_asked)
{
    const struct said *s = run_expecting(0, "render " CORNELL TINY "-o c.exr --quiet");
    EXPECT_EQUAL_TEXT(s->out, "");
    EXPECT_EQUAL_TEXT(s->err, "");
    EXPECT_SAYS(run_expecting(0, "render " CORNELL TINY "-o c.exr")->err, "cd/m^2 ±");
}

TEST(render_tells_logs_how_far_it_is_when_asked)
{
#define FOR_SECONDS "render " CORNELL " --resolution 96,96 --threads 1 -o c.exr --spp "
    const char *const spp = is_slow_build() ? "60" : "150";
    char command[256];
    snprintf(command, sizeof command, FOR_SECONDS "%s --progress 0.01s", spp);
    const struct said *s = run_expecting(0, command);
    EXPECT_SAYS(s->err, " left, ");
    EXPECT(!strchr(s->err, '\r'));
    snprintf(command, sizeof command, FOR_SECONDS "%s", spp);
    EXPECT(!strstr(run_expecting(0, command)->err, " left, "));
}

TEST(render_writes_the_same_bytes_again)
{
    run_expecting(0, "render " CORNELL TINY "-o one.pfm -q --threads 1");
    run_expecting(0, "render " CORNELL TINY "-o two.pfm -q --threads 3 --tile 5");
    struct sr_image *one = get_image("one.pfm"), *two = get_image("two.pfm");
    EXPECT(memcmp(one->floats, two->floats, 32 * 32 * 3 * sizeof(float)) == 0);
    sr_image_free(one);
    sr_image_free(two);
}

static double number_at(json_t *j, const char *a, const char *b)
{
    json_t *value = json_object_get(json_object_get(j, a), b);
    if (!json_is_number(value))
        test_fail(__FILE__, __LINE__, "%s.%s is no number", a, b);
    return json_number_value(value);
}

TEST(render_json_has_units_and_uncertainty)
{
    json_t *j = json_of(
        run_expecting(0, "render " CORNELL TINY "-o c.exr -q --json --replicates 2 --irradiance 0.278,0,0.2796,0,1,0"));
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(j, "mean_luminance"), "unit")), "cd/m^2");
    double value = number_at(j, "mean_luminance", "value"), u = number_at(j, "mean_luminance", "standard_uncertainty");
    EXPECT(value > 0 && u > 0);
    EXPECT_RELATIVE(number_at(j, "mean_luminance", "expanded_uncertainty"),
                    number_at(j, "mean_luminance", "coverage_factor") * u, 1e-6);
    EXPECT_NEAR(number_at(j, "settings", "spp"), 4, 0);
    EXPECT_NEAR(number_at(j, "counts", "paths"), 32 * 32 * 4, 0);
    EXPECT(json_is_true(json_object_get(j, "complete")));
    json_t *meter = json_array_get(json_object_get(j, "irradiance"), 0);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(meter, "E_v"), "unit")), "lx");
    EXPECT(number_at(meter, "E_v", "value") > 0);
    json_decref(j);
    // one block of samples has no error: null, and the JSON still parses
    j = json_of(run_expecting(0, "render " CORNELL " --resolution 8,8 --spp 1 -o c.exr -q --json"));
    EXPECT(json_is_null(json_object_get(json_object_get(j, "mean_luminance"), "standard_uncertainty")));
    json_decref(j);
}

TEST(render_aims_at_an_error_and_tells_when_it_missed)
{
    json_t *j = json_of(run_expecting(0, "render " CORNELL " --resolution 16,16 --error 10% -o c.exr -q --json"));
    double reached = json_number_value(json_object_get(j, "relative_error"));
    EXPECT(reached > 0.03 && reached <= 0.11);
    EXPECT(json_is_true(json_object_get(json_object_get(j, "settings"), "adaptive")));
    EXPECT(number_at(j, "settings", "spp") > 40);
    json_decref(j);
    EXPECT_SAYS(run_expecting(1, "render " CORNELL " --resolution 8,8 --error 0.1% --spp 16 -o c.exr")->err,
                "aimed at 0.1 %: missed");
    EXPECT_SAYS(run_expecting(0, "render " CORNELL " --resolution 8,8 --adaptive --spp 16 -o c.exr")->err,
                "samples each on average");
    EXPECT_SAYS(run_expecting(0, "render " CORNELL " --resolution 8,8 --time 0.2s -o c.exr")->err,
                "relative error of the picture");
    EXPECT_SAYS(run_expecting(2, "render " CORNELL " --error 200% -o c.exr")->err,
                "a share such as 0.1% or 0.001 was expected");
    run_expecting(2, "render " CORNELL " --time soon -o c.exr");
    run_expecting(2, "render " CORNELL " --adaptive --replicates 4 --spp 8 -o c.exr");
}

TEST(render_tells_in_which_units)
{
    EXPECT_SAYS(run_expecting(0, "render " CORNELL " --resolution 8,8 --spp 1 -o c.exr")->err, "photometric units");
    EXPECT_SAYS(run_expecting(0, "render " CORNELL " --resolution 8,8 --spp 1 -o c.exr --units si")->err, "SI units");
    EXPECT_SAYS(run_expecting(0, "info c.exr")->out, "steradian.units                si");
    run_expecting(2, "render " CORNELL " --units imperial -o c.exr");
}

TEST(render_one_sample_alone_and_again)
{
    char first[MAX_SAID];
    snprintf(first, sizeof first, "%s", run_expecting(0, "render " CORNELL TINY "--pixel 16,20 --sample 3")->out);
    EXPECT_SAYS(first, "pixel 16,20 sample 3: RGB ");
    EXPECT_SAYS(first, "cd/m^2");
    EXPECT_SAYS(first, "first surface: p ");
    EXPECT_EQUAL_TEXT(run_expecting(0, "render " CORNELL TINY "--pixel 16,20 --sample 3")->out, first);
    run_expecting(2, "render " CORNELL TINY "--pixel 32,0 --sample 0");
    EXPECT_EQUAL_INT(count_files("cornell-box"), 0);
}

TEST(render_and_info_read_standard_input)
{
    const struct said *s = run("render - " TINY "-o stdin.pfm --quiet", CORNELL);
    EXPECT_EQUAL_INT(s->code, 0);
    run_expecting(0, "render " CORNELL TINY "-o file.pfm --quiet");
    struct sr_image *a = get_image("stdin.pfm"), *b = get_image("file.pfm");
    EXPECT(memcmp(a->floats, b->floats, 32 * 32 * 3 * sizeof(float)) == 0);
    sr_image_free(a);
    sr_image_free(b);
    s = run("info - --json", CORNELL);
    json_t *j = json_of(s);
    EXPECT_NEAR(number_at(j, "counts", "triangles"), 30, 0);
    json_decref(j);
}

TEST(render_crops)
{
    run_expecting(0, "render " CORNELL TINY "-o whole.exr --quiet");
    run_expecting(0, "render " CORNELL TINY "-o part.exr --quiet --pixelbounds 8,16,4,20");
    struct sr_image *whole = get_image("whole.exr"), *part = get_image("part.exr");
    EXPECT_EQUAL_INT(part->width, 8);
    EXPECT_EQUAL_INT(part->height, 16);
    EXPECT_EQUAL_INT(part->x0, 8);
    EXPECT_EQUAL_INT(part->y0, 4);
    EXPECT_EQUAL_INT(part->full_width, 32);
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 8; ++x)
            for (uint32_t c = 0; c < 3; ++c)
                EXPECT_NEAR(part->floats[sr_image_index(part, x, y) + c],
                            whole->floats[sr_image_index(whole, x + 8, y + 4) + c], 0);
    sr_image_free(whole);
    sr_image_free(part);
}

/* Exposed, balanced, limited or seen by a camera, a picture's values are no luminances, and nobody is to take them so.
 */
TEST(render_calls_no_exposed_picture_luminance)
{
    static const char *const films[] = {"\"float iso\" 200", "\"string sensor\" \"nikon_d850\"",
                                        "\"float whitebalance\" 3000", "\"float maxcomponentvalue\" 1",
                                        "\"float iso\" 100"};
    for (int i = 0; i < 5; ++i) {
        char scene[1024];
        snprintf(scene, sizeof scene,
                 "Camera \"fisheye\" \"string mapping\" \"equidistant\"\n"
                 "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 %s\n"
                 "Sampler \"zsobol\" \"integer pixelsamples\" 4\nWorldBegin\n"
                 "LightSource \"infinite\" \"rgb L\" [1 1 1] \"float scale\" 100\n",
                 films[i]);
        put_file("exposed.pbrt", scene);
        bool is_luminance = i == 4;
        const struct said *s = run_expecting(0, "render exposed.pbrt -o exposed.exr");
        EXPECT((strstr(s->err, "mean luminance L_v = ") != NULL) == is_luminance);
        EXPECT((strstr(s->err, "no luminances") != NULL) == !is_luminance);
        struct sr_image *image = get_image("exposed.exr");
        EXPECT_EQUAL_TEXT(image->channels[sr_image_find_channel(image, "G")].unit, is_luminance ? "cd/m^2" : "");
        EXPECT_EQUAL_TEXT(image->channels[sr_image_find_channel(image, "SE.G")].unit, is_luminance ? "cd/m^2" : "");
        EXPECT_EQUAL_TEXT(image->channels[sr_image_find_channel(image, "depth")].unit, "m");
        sr_image_free(image);
        s = run_expecting(0, "glare exposed.exr");
        EXPECT((strstr(s->err, "does not say that its values are in cd/m^2") != NULL) == !is_luminance);
        run_expecting(0, "render exposed.pbrt --part 1/1 -o exposed.srp -q --no-checkpoint");
        run_expecting(0, "merge exposed.srp -o merged.exr -q");
        json_t *j = json_of(run_expecting(0, "merge exposed.srp -o merged.exr --json"));
        EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(j, "mean_luminance"), "unit")),
                          is_luminance ? "cd/m^2" : "1");
        json_decref(j);
    }
}
