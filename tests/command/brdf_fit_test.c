/* SPDX-License-Identifier: MIT */
/* brdf convert and fit: what is written is read back and found again; formats lose what they say; mistakes are told. */
#include "run.h"

static double value_of(json_t *object, const char *name)
{
    return json_number_value(json_object_get(json_object_get(object, name), "value"));
}

TEST(brdf_convert_then_fit_finds_the_parameters)
{
    static const char *const files[] = {"g.binary", "g.bsdf", "g.txt"};
    for (int i = 0; i < 3; ++i) {
        char line[512];
        snprintf(line, sizeof line, "brdf convert conductor eta=.3 k=3 alpha_x=.3 alpha_y=.3 -o %s --json%s", files[i],
                 i == 2 ? " --theta 46 --phi 73 --lambda-count 2" : "");
        json_t *j = json_of(run_expecting(0, line));
        EXPECT(value_of(j, "rms_difference") < (i == 0 ? 2e-3 : 2e-2)); // interpolation; MERL's grid is dense
        EXPECT(!json_is_true(json_object_get(j, "lost_mirrors")) &&
               !json_is_true(json_object_get(j, "lost_transmission")));
        json_decref(j);

        snprintf(line, sizeof line,
                 "brdf fit %s --model conductor --lambda 550 --points 1500 --starts 4 --json --plot fit.svg", files[i]);
        j = json_of(run_expecting(0, line));
        json_t *parameters = json_object_get(j, "parameters");
        EXPECT_EQUAL_INT(json_array_size(parameters), 4);
        for (size_t k = 2; k < 4; ++k) { // eta and k of a smooth curve are known less well
            json_t *p = json_array_get(parameters, k);
            EXPECT(strncmp(json_string_value(json_object_get(p, "name")), "alpha_", 6) == 0);
            EXPECT_RELATIVE(json_number_value(json_object_get(p, "value")), 0.3, i == 0 ? 5e-3 : 2e-2);
        }
        EXPECT(value_of(j, "rms_of_f_cos") < 2e-2);
        json_decref(j);
        EXPECT_EQUAL_INT(count_files("fit.svg"), 1);
        remove_file("fit.svg");
        remove_file(files[i]);
    }
}

TEST(brdf_convert_tells_what_is_lost)
{
    const struct said *s = run_expecting(0, "brdf convert dielectric eta=1.5 -o glass.bsdf");
    EXPECT_SAYS(s->out, "mirror");
    EXPECT_SAYS(s->out, "passes through");
    remove_file("glass.bsdf");
    s = run_expecting(
        0, "brdf convert diffuse_transmission -o leaf.txt --transmission --theta 10 --phi 13 --lambda-count 2");
    EXPECT(!strstr(s->out, "passes through"));
    remove_file("leaf.txt");
}

TEST(brdf_convert_and_fit_refuse_nonsense)
{
    EXPECT_SAYS(run_expecting(2, "brdf convert diffuse")->err, "-o FILE");
    EXPECT_SAYS(run_expecting(2, "brdf convert diffuse -o a.jpg")->err, ".binary");
    EXPECT_SAYS(run_expecting(2, "brdf convert diffuse -o a.txt --lambda-range 700,400")->err, "LO,HI");
    EXPECT(run("brdf convert diffuse -o no/such/folder/a.txt", NULL)->code >= 3);
    EXPECT_SAYS(run_expecting(2, "brdf fit diffuse")->err, "--model");
    EXPECT_SAYS(run_expecting(2, "brdf fit diffuse --model diffuse --metric cubic")->err, "cube-root");
    EXPECT_SAYS(run_expecting(2, "brdf fit diffuse --model ward --fix colour")->err, "colour");
    EXPECT_SAYS(run("brdf fit conductor --model diffuse", NULL)->err, "no f above 0"); // a mirror
    EXPECT_EQUAL_INT(count_files("a."), 0);
}
