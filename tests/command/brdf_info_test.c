/* SPDX-License-Identifier: MIT */
/* brdf info: figures of a file that are known, exit codes, mistakes. */
#include "run.h"

static double value_of(json_t *object, const char *name)
{
    return json_number_value(json_object_get(json_object_get(object, name), "value"));
}

TEST(brdf_info_tells_what_a_file_is_worth)
{
    json_decref(json_of(run_expecting(0, "brdf convert diffuse reflectance=.5 -o matte.txt --json --lambda-count 3")));
    json_t *j = json_of(run_expecting(0, "brdf info matte.txt --json")),
           *f = json_array_get(json_object_get(j, "files"), 0);
    EXPECT_NEAR(value_of(f, "largest_albedo"), 0.5, 2e-3);
    EXPECT_NEAR(value_of(f, "reciprocity_max"), 0, 1e-5);
    EXPECT_NEAR(value_of(json_array_get(json_object_get(f, "scatter"), 4), "reflected"), 0.5, 2e-3);
    json_decref(j);
    const struct said *s = run_expecting(0, "brdf info matte.txt --quantity factor");
    EXPECT_SAYS(s->out, "reflectance factor");
    EXPECT_SAYS(s->out, "0.1591"); // 1/2 / pi
    EXPECT_SAYS(s->out, "reciprocity   kept");
    remove_file("matte.txt");
}

TEST(brdf_info_tells_of_files_that_make_light_and_of_those_it_cannot_read)
{
    put_file("bright.txt", "theta_i theta_o f\n0 0 1\n0 80 1\n80 0 1\n80 80 1\n");
    EXPECT_SAYS(run_expecting(1, "brdf info bright.txt --angles degrees")->out, "MAKES LIGHT");
    put_file("bright.txt", "theta_i theta_o f\n0 0 one\n");
    EXPECT_SAYS(run_expecting(3, "brdf info bright.txt")->err, "bright.txt:2: a number is expected");
    EXPECT_SAYS(run_expecting(2, "brdf info bright.txt --quantity loud")->err, "bsdf, cosine or factor");
    EXPECT_SAYS(run_expecting(2, "brdf info")->err, "a file of measured data was expected");
    remove_file("bright.txt");
}
