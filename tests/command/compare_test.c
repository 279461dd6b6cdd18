/* SPDX-License-Identifier: MIT */
/* compare and image: equal is equal, noise is noise, five per cent are found; conversions keep values and units. */
#include "run.h"

#define SMALL " --resolution 32,32 --spp 16 -q "

static void render_pair(void)
{
    run_expecting(0, "render " CORNELL SMALL "--seed 1 -o s1.exr");
    run_expecting(0, "render " CORNELL SMALL "--seed 2 -o s2.exr");
}

static const char *const limits[] = {"rmse", "rel_mse"};

TEST(compare_a_picture_with_itself)
{
    run_expecting(0, "render " CORNELL SMALL "--seed 1 -o s1.exr");
    json_t *j = json_of(run_expecting(0, "compare s1.exr s1.exr --json --all --max-rmse 0 --max-relmse 0 --max-z 0"));
    json_t *channels = json_object_get(j, "channels");
    EXPECT(json_array_size(channels) > 20);
    for (size_t i = 0; i < json_array_size(channels); ++i)
        for (int k = 0; k < 2; ++k)
            EXPECT_NEAR(
                json_number_value(json_object_get(json_object_get(json_array_get(channels, i), limits[k]), "value")), 0,
                0);
    json_decref(j);
}

TEST(compare_two_seeds_differ_by_noise_only)
{
    render_pair();
    json_t *j = json_of(run_expecting(0, "compare s1.exr s2.exr --json --max-z 5"));
    json_t *channels = json_object_get(j, "channels");
    EXPECT_EQUAL_INT(json_array_size(channels), 3);
    for (size_t i = 0; i < 3; ++i) {
        json_t *c = json_array_get(channels, i), *noise = json_object_get(c, "noise");
        EXPECT_EQUAL_TEXT(json_string_value(json_object_get(c, "unit")), "cd/m^2");
        EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(c, "rmse"), "unit")), "cd/m^2");
        EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(c, "rel_mse"), "unit")), "1");
        EXPECT(json_number_value(json_object_get(json_object_get(c, "rmse"), "value")) > 0);
        double z = json_number_value(json_object_get(noise, "z_of_mean")),
               p = json_number_value(json_object_get(noise, "p"));
        EXPECT(fabs(z) < 5 && z != 0);
        EXPECT_NEAR(p, sr_normal_p_two_sided(z), 1e-6);
    }
    json_decref(j);
    const struct said *s = run_expecting(1, "compare s1.exr s2.exr --max-rmse 0.001");
    EXPECT_SAYS(s->err, "R: RMSE");
    EXPECT_SAYS(s->err, "cd/m^2 is above the limit");
    EXPECT_SAYS(s->out, "pure noise");
    EXPECT_EQUAL_TEXT(run_expecting(0, "compare s1.exr s2.exr --max-z 5 -q")->out, "");
}

TEST(compare_finds_five_per_cent)
{
    run_expecting(0, "render " CORNELL " --resolution 24,24 --spp 512 -q --seed 1 -o s1.exr");
    struct sr_image *image = get_image("s1.exr");
    for (size_t p = 0; p < 24 * 24; ++p)
        for (uint32_t c = 0; c < 3; ++c)
            image->floats[p * image->channel_count + c] *= 1.05f;
    char path[512];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/brighter.exr", test_folder());
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    const struct said *s = run_expecting(1, "compare brighter.exr s1.exr --max-z 5 --json");
    EXPECT_SAYS(s->err, "|z| of the mean");
    json_t *j = json_of(s), *green = json_array_get(json_object_get(j, "channels"), 1);
    EXPECT_NEAR(json_number_value(json_object_get(json_object_get(green, "mean_ratio"), "value")), 1.05, 1e-5);
    EXPECT(json_number_value(json_object_get(json_object_get(green, "noise"), "z_of_mean")) > 5);
    EXPECT(json_is_false(json_object_get(j, "passed")));
    json_decref(j);
}

TEST(compare_refuses_what_cannot_be_compared)
{
    render_pair();
    run_expecting(0, "image s1.exr --crop 0,0,16,16 -o small.exr -q");
    const struct said *s = run_expecting(3, "compare s1.exr small.exr -o left.png");
    EXPECT_SAYS(s->err, "s1.exr is 32 x 32 pixels and small.exr is 16 x 16");
    EXPECT_SAYS(run_expecting(3, "compare s1.exr s2.exr --channel Q")->err, "it has R, G, B");
    run_expecting(0, "image s1.exr --channel R,G,B -o plain.exr -q");
    EXPECT_SAYS(run_expecting(3, "compare plain.exr plain.exr --max-z 5")->err, "standard errors");
    EXPECT_SAYS(run_expecting(4, "compare s1.exr s2.exr -o no/such/left.png")->err, "cannot be written");
    EXPECT_EQUAL_INT(count_files("left"), 0);
}

TEST(compare_refuses_numbers_of_different_units)
{
    render_pair();
    struct sr_image *image = get_image("s2.exr");
    sr_image_set_unit(image, (uint32_t)sr_image_find_channel(image, "G"), "W/(m^2 sr)");
    char path[512];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/watts.exr", test_folder());
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    EXPECT_SAYS(run_expecting(3, "compare s1.exr watts.exr")->err,
                "s1.exr has G in cd/m^2 and watts.exr has it in W/(m^2 sr)");
    run_expecting(0, "compare s1.exr watts.exr --channel R");
}

TEST(compare_knows_no_noise_of_single_samples)
{
    render_pair();
    run_expecting(0, "render " CORNELL " --resolution 32,32 --spp 1 -o one.exr -q");
    EXPECT_SAYS(run_expecting(3, "compare one.exr s1.exr --max-z 4")->err, "standard errors");
}

TEST(pictures_without_a_finite_pixel_have_no_mean)
{
    struct sr_image *image = NULL;
    render_pair();
    image = get_image("s1.exr");
    for (size_t i = 0; i < (size_t)image->width * image->height * image->channel_count; ++i)
        image->floats[i] = NAN;
    char path[512];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/none.exr", test_folder());
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    static const char *const commands[] = {"image none.exr --json", "info none.exr --json",
                                           "compare none.exr none.exr --json"};
    for (int i = 0; i < 3; ++i) {
        json_t *j = json_of(run_expecting(0, commands[i]));
        const json_t *channel = json_array_get(json_object_get(j, "channels"), 0);
        const json_t *mean = json_object_get(channel, i == 2 ? "mean_a" : "mean");
        EXPECT(json_is_null(i == 2 ? json_object_get(mean, "value") : mean));
        json_decref(j);
    }
    json_t *j = json_of(run_expecting(0, "image none.exr --statistics --json"));
    const json_t *L = json_object_get(json_object_get(j, "values"), "L_v");
    EXPECT(json_is_null(json_object_get(L, "least")) && json_is_null(json_object_get(L, "least_at")));
    json_decref(j);
    EXPECT_SAYS(run_expecting(0, "image none.exr --statistics")->out, "no pixel is finite");
}

TEST(compare_counts_what_is_not_finite_as_a_failure)
{
    render_pair();
    struct sr_image *image = get_image("s2.exr");
    image->floats[0] = NAN;
    char path[512];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/nan.exr", test_folder());
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    EXPECT_SAYS(run_expecting(1, "compare nan.exr s1.exr --max-z 5")->err, "R: 1 pixels are not finite");
    run_expecting(0, "compare nan.exr s1.exr");
    json_decref(json_of(run_expecting(0, "compare nan.exr s1.exr --json")));
    json_decref(json_of(run_expecting(0, "info nan.exr --json")));
}

TEST(compare_paints_the_difference)
{
    render_pair();
    EXPECT_SAYS(run_expecting(0, "compare s1.exr s2.exr -o difference.png --scale 2")->out,
                "the full colour stands for 2 cd/m^2");
    struct sr_image *image = get_image("difference.png");
    EXPECT_EQUAL_INT(image->width, 32);
    sr_image_free(image);
    json_t *j = json_of(run_expecting(0, "compare s1.exr s2.exr -o difference.png --json"));
    json_t *scale = json_object_get(json_object_get(j, "difference_picture"), "full_colour");
    EXPECT(json_number_value(json_object_get(scale, "value")) > 0);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(scale, "unit")), "cd/m^2");
    json_decref(j);
}

TEST(image_converts_and_keeps_values_and_units)
{
    run_expecting(0, "render " CORNELL SMALL "--seed 1 -o s1.exr");
    run_expecting(0, "image s1.exr -o copy.exr -q");
    run_expecting(0, "compare s1.exr copy.exr --all --max-rmse 0");
    struct sr_image *copy = get_image("copy.exr");
    EXPECT_EQUAL_TEXT(copy->channels[sr_image_find_channel(copy, "depth")].unit, "m");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(copy, "steradian.seed"), "1");
    sr_image_free(copy);
    run_expecting(0, "image s1.exr -o copy.pfm -q");
    run_expecting(0, "compare copy.pfm s1.exr --max-rmse 0");
    run_expecting(0, "image s1.exr --channel albedo -o albedo.pfm -q");
    struct sr_image *albedo = get_image("albedo.pfm"), *all = get_image("s1.exr");
    int red = sr_image_find_channel(all, "albedo.R"), blue = sr_image_find_channel(all, "albedo.B");
    for (size_t p = 0; p < 32 * 32; ++p) { // red is red though the file sorts blue first
        EXPECT_NEAR(albedo->floats[3 * p], all->floats[p * all->channel_count + (size_t)red], 0);
        EXPECT_NEAR(albedo->floats[3 * p + 2], all->floats[p * all->channel_count + (size_t)blue], 0);
    }
    sr_image_free(albedo);
    sr_image_free(all);
}

TEST(image_exposure_doubles_and_tones_differ)
{
    put_file("grey.pfm", "");
    struct sr_image *image;
    struct sr_error error = {0};
    EXPECT(sr_image_create(4, 4, 3, NULL, SR_IMAGE_FLOATS, &image, &error) == SR_OK);
    for (int i = 0; i < 48; ++i)
        image->floats[i] = 0.25f;
    char path[512];
    snprintf(path, sizeof path, "%s/grey.pfm", test_folder());
    EXPECT(sr_image_write(path, image, NULL, &error) == SR_OK);
    sr_image_free(image);
    EXPECT_SAYS(run_expecting(0, "image grey.pfm -o grey.png --exposure 1")->err, "exposure +1.00 EV");
    struct sr_image *png = get_image("grey.png");
    EXPECT_EQUAL_INT(png->bytes[0], 188); // sRGB of 0.5
    sr_image_free(png);
    run_expecting(0, "image grey.pfm -o grey.png --exposure 1 --tone reinhard -q");
    png = get_image("grey.png");
    EXPECT_EQUAL_INT(png->bytes[0], (int)(255 * sr_image_encode_srgb(0.5f * (1 + 0.5f / 16) / 1.5f) + 0.5f));
    sr_image_free(png);
}

TEST(image_crops_and_tells_statistics)
{
    run_expecting(0, "render " CORNELL SMALL "--seed 1 -o s1.exr");
    json_t *j = json_of(run_expecting(0, "image s1.exr --crop 3,5,7,6 --channel R,SE --json -o crop.exr -q"));
    EXPECT_EQUAL_INT(json_integer_value(json_object_get(json_object_get(j, "size"), "width")), 7);
    json_t *channels = json_object_get(j, "channels");
    EXPECT_EQUAL_INT(json_array_size(channels), 4);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_array_get(channels, 1), "name")), "SE.R");
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_array_get(channels, 1), "unit")), "cd/m^2");
    struct sr_image *crop = get_image("crop.exr"), *whole = get_image("s1.exr");
    double sum = 0;
    for (uint32_t y = 0; y < 6; ++y)
        for (uint32_t x = 0; x < 7; ++x)
            sum += (double)whole->floats[sr_image_index(whole, x + 3, y + 5)];
    EXPECT_RELATIVE(json_number_value(json_object_get(json_array_get(channels, 0), "mean")), sum / 42, 1e-6);
    EXPECT_EQUAL_INT(crop->x0, 3);
    sr_image_free(crop);
    sr_image_free(whole);
    json_decref(j);
    EXPECT_SAYS(run_expecting(3, "image s1.exr --crop 30,30,7,6")->err, "s1.exr");
    EXPECT_SAYS(run_expecting(0, "image s1.exr")->out, "deviation");
}

TEST(info_tells_pictures_and_scenes)
{
    run_expecting(0, "render " CORNELL SMALL "--seed 1 -o s1.exr");
    const struct said *s = run_expecting(0, "info s1.exr");
    EXPECT_SAYS(s->out, "32 x 32 pixels");
    EXPECT_SAYS(s->out, "cd/m^2");
    EXPECT_SAYS(s->out, "steradian.sceneHash");
    json_t *j = json_of(run_expecting(0, "info s1.exr --json"));
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(j, "attributes"), "steradian.samplesPerPixel")),
                      "16");
    json_decref(j);
    s = run_expecting(0, "info " CORNELL);
    EXPECT_SAYS(s->out, "perspective");
    EXPECT_SAYS(s->out, "30 triangles, 1 patches");
    EXPECT_SAYS(s->out, "360 to 830 nm");
    j = json_of(run_expecting(0, "info " CORNELL " --json"));
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(j, "bounds"), "unit")), "m");
    EXPECT_EQUAL_INT(json_integer_value(json_object_get(json_object_get(j, "lights"), "area")), 1);
    json_decref(j);
}
