/* SPDX-License-Identifier: MIT */
/* converge and --estimator as a user meets them. */
#include "run.h"

static double slope_of(json_t *root, size_t i)
{
    return json_number_value(
        json_object_get(json_object_get(json_array_get(json_object_get(root, "series"), i), "slope"), "value"));
}

TEST(converge_tells_the_slopes_of_an_integral)
{
    json_t *root = json_of(run_expecting(
        0, "converge --integral smooth-2d --samples 16:1024 --seeds 64 --json -o c.svg -o c.png -o c.csv"));
    EXPECT_EQUAL_INT(json_array_size(json_object_get(root, "series")), 4); // two strategies, two samplers
    EXPECT_NEAR(slope_of(root, 0), -1.4, 0.2);                             // uniform, a scrambled net
    EXPECT_NEAR(slope_of(root, 1), -0.5, 0.1);                             // uniform, independent
    json_decref(root);
    EXPECT_EQUAL_INT(count_files("c.svg") + count_files("c.png") + count_files("c.csv"), 3);
}

TEST(converge_finds_that_aiming_at_the_light_beats_the_uniform_hemisphere)
{
    json_t *root = json_of(
        run_expecting(0, "converge " CORNELL
                         " -e uniform-hemisphere -e light-area --maxdepth 1 --resolution 8,8 --samples 1:16 --seeds 4 "
                         "--json --strip strip.png --strip-spp 1"));
    json_t *series = json_object_get(root, "series");
    double error[2];
    for (size_t i = 0; i < 2; ++i)
        error[i] = json_number_value(json_array_get(json_object_get(json_array_get(series, i), "error"), 4));
    EXPECT(error[1] > 0 && error[0] > 5 * error[1]);
    json_decref(root);
    EXPECT_EQUAL_INT(count_files("strip.png"), 1);
}

TEST(converge_studies_a_meter_against_its_closed_form_and_leaves_out_who_is_blind)
{
    const struct said *s =
        run_expecting(0, "converge " SR_TEST_SOURCE_DIR
                         "/scenes/meters.pbrt --meter desk --reference 167.0796 -e light-area -e uniform-area "
                         "--samples 16:1024 --json");
    EXPECT_SAYS(s->err, "uniform-area is left out: point");
    json_t *root = json_of(s);
    EXPECT_EQUAL_INT(json_array_size(json_object_get(root, "series")), 1);
    EXPECT(slope_of(root, 0) < -0.6);
    json_decref(root);
}

TEST(converge_refuses_what_makes_no_sense)
{
    EXPECT_SAYS(run_expecting(2, "converge --integral disk-2d --samples 16:64:nan")->err, "--samples 16:64:nan");
    EXPECT_SAYS(run_expecting(2, "converge --integral disk-2d --samples 16:64k")->err, "--samples 16:64k");
    EXPECT_SAYS(run_expecting(2, "converge --integral foo")->err, "--integral list");
    EXPECT_SAYS(run_expecting(2, "converge --integral disk-2d -e path")->err, "do not go with it");
    EXPECT_SAYS(run_expecting(2, "converge " CORNELL " -e path,maxdepth=2")->err, "--maxdepth");
    EXPECT_SAYS(run_expecting(2, "converge " CORNELL " --samples 8:4")->err, "1 <= A < B");
    EXPECT_SAYS(run_expecting(2, "converge " CORNELL " --meter foo")->err, "there is no meter");
}

TEST(estimators_are_chosen_by_name_and_by_strategy)
{
    EXPECT_SAYS(run_expecting(0, "render --estimator help")->out, "light-solid-angle");
    EXPECT_SAYS(
        run_expecting(
            0,
            "render " CORNELL
            " --estimator uniform-hemisphere+light-area:power,maxdepth=2 --resolution 4,4 --spp 1 -o e.exr -q --json")
            ->out,
        "\"uniform-hemisphere+light-area:power\"");
    EXPECT_SAYS(run_expecting(2, "render " CORNELL " --estimator foo -o e.exr")->err, "there is no estimator \"foo\"");
    EXPECT_SAYS(run_expecting(2, "render " CORNELL " --estimator path,maxdepth=x -o e.exr")->err, "whole number");
    put_file("point.pbrt",
             "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2\nWorldBegin\nLightSource \"point\"\n");
    EXPECT_SAYS(run_expecting(0, "render point.pbrt --estimator bsdf --spp 1 -q -o e.exr")->err,
                "point, spot and distant lights are missing");
}
