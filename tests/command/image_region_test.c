/* SPDX-License-Identifier: MIT */
/* Regions of pictures as measurements: one picture by its pixels' errors, several by their spread, both of the same
 * truth. */
#include "run.h"

static json_t *value_of(json_t *j, const char *form, const char *name)
{
    return json_object_get(json_object_get(json_object_get(json_object_get(j, "values"), form), "mean"), name);
}

TEST(regions_of_one_picture_and_of_replicates_agree)
{
    char arguments[512], files[256] = "";
    for (int seed = 1; seed <= 6; ++seed) {
        snprintf(arguments, sizeof arguments,
                 "render " CORNELL " --resolution 32,32 --spp 32 --replicates 16 --seed %d -o r%d.exr -q --no-aov",
                 seed, seed);
        run_expecting(0, arguments);
        snprintf(files + strlen(files), sizeof files - strlen(files), "r%d.exr ", seed);
    }
    snprintf(arguments, sizeof arguments, "image %s--region 4,20,28,30 --statistics --json", files);
    json_t *all = json_of(run_expecting(0, arguments)),
           *one = json_of(run_expecting(0, "image r1.exr --region 4,20,28,30 --statistics --json"));
    double mean = json_number_value(value_of(all, "L_v", "value")),
           u = json_number_value(value_of(all, "L_v", "standard_uncertainty"));
    double m1 = json_number_value(value_of(one, "L_v", "value")),
           u1 = json_number_value(value_of(one, "L_v", "standard_uncertainty"));
    EXPECT_EQUAL_INT(json_integer_value(json_object_get(all, "pictures")), 6);
    EXPECT_NEAR(json_number_value(value_of(all, "L_v", "degrees_of_freedom")), 5, 0);
    EXPECT_EQUAL_TEXT(json_string_value(value_of(all, "L_v", "unit")), "cd/m^2");
    EXPECT_NEAR(m1, mean, 5 * hypot(u, u1));
    // six pictures have a sixth of the variance, known to a third; one adds its channels' errors, which is the upper
    // bound
    EXPECT(u1 > 0.9 * u && u1 < 8 * u);
    double Y = 0.2126 * json_number_value(value_of(one, "R", "value")) +
               0.7152 * json_number_value(value_of(one, "G", "value")) +
               0.0722 * json_number_value(value_of(one, "B", "value"));
    EXPECT_RELATIVE(Y, m1, 1e-3);
    double ratio = json_number_value(value_of(all, "R/G", "value")),
           plain = json_number_value(value_of(all, "R", "value")) / json_number_value(value_of(all, "G", "value"));
    EXPECT_RELATIVE(ratio, plain, 0.01);
    double u_R =
        json_number_value(value_of(all, "R", "standard_uncertainty")) / json_number_value(value_of(all, "R", "value"));
    EXPECT(json_number_value(value_of(all, "R/G", "standard_uncertainty")) <
           2 * ratio * u_R); // the same paths: the ratio is known as well as they are
    json_decref(all);
    json_decref(one);
}

TEST(regions_are_told_in_words)
{
    run_expecting(0, "render " CORNELL " --resolution 16,16 --spp 32 --replicates 16 -o w.exr -q --no-aov");
    const struct said *s = run_expecting(0, "image w.exr --statistics");
    EXPECT_SAYS(s->out, "region 0,0 to 16,16: 16 x 16 pixels of w.exr");
    EXPECT_SAYS(s->out, "L_v  mean ");
    EXPECT_SAYS(s->out, "taken for independent");
    run_expecting(2, "image w.exr --region 0,0,4,4");
    run_expecting(2, "image w.exr --region 4,4,4,8 --statistics");
    EXPECT_SAYS(run_expecting(3, "image w.exr --region 0,0,17,4 --statistics")->err, "the region ends at 17,4");
}

TEST(regions_without_light_are_not_called_exactly_dark)
{
    put_file("night.pbrt",
             "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\nShape \"sphere\"\n");
    run_expecting(0, "render night.pbrt --spp 4 -o night.exr -q");
    const struct said *s = run_expecting(0, "image night.exr --statistics");
    EXPECT_SAYS(s->out, "L_v  mean 0 cd/m^2 (uncertainty not known)");
}
