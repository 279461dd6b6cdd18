/* SPDX-License-Identifier: MIT */
/* The laboratory on the command line: words become specimens, numbers come with units, mistakes are told. */
#include "run.h"

TEST(brdf_list_and_show)
{
    EXPECT_SAYS(run_expecting(0, "brdf list")->out, "conductor");
    const struct said *s = run_expecting(0, "brdf show conductor");
    EXPECT_SAYS(s->out, "alpha_x");
    EXPECT_SAYS(s->out, "0.02 … 8");
    json_t *j = json_of(run_expecting(0, "brdf show diffuse --json")),
           *row = json_array_get(json_object_get(j, "parameters"), 0);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(row, "name")), "reflectance");
    EXPECT_NEAR(json_number_value(json_object_get(row, "default")), 0.5, 0);
    EXPECT_NEAR(json_number_value(json_object_get(row, "max")), 1, 0);
    json_decref(j);
    EXPECT_SAYS(run_expecting(3, "brdf show conducter")->err, "did you mean \"conductor\"");
    EXPECT_SAYS(run_expecting(2, "brdf evl")->err, "did you mean \"eval\"");
    EXPECT_SAYS(run_expecting(0, "brdf eval --help")->out, "--wi THETA[,PHI]");
    EXPECT_SAYS(run_expecting(0, "brdf --help")->out, "reflectance");
}

static double quantity(json_t *j, const char *name)
{
    return json_number_value(json_object_get(json_object_get(j, name), "value"));
}

TEST(brdf_eval_gives_f_and_pdf)
{
    json_t *j = json_of(run_expecting(0, "brdf eval diffuse reflectance=.25 --wi 60 --wo 20 --json"));
    EXPECT_NEAR(json_number_value(json_array_get(json_object_get(json_object_get(j, "f"), "value"), 0)),
                0.25 / 3.14159265, 1e-8);
    EXPECT_NEAR(quantity(j, "pdf"), 0.5 / 3.14159265, 1e-7);
    json_decref(j);
    // f of a sum is the sum of f, whatever the wavelength
    j = json_of(run_expecting(0,
                              "brdf eval .5*diffuse reflectance=.4 + 2*diffuse reflectance=400:0,600:1 --wi 10 --wo 70 "
                              "--lambda 450,500 --json"));
    json_t *f = json_object_get(json_object_get(j, "f"), "value");
    EXPECT_NEAR(json_number_value(json_array_get(f, 0)), (0.2 + 2 * 0.25) / 3.14159265, 1e-6);
    EXPECT_NEAR(json_number_value(json_array_get(f, 1)), (0.2 + 2 * 0.5) / 3.14159265, 1e-6);
    json_decref(j);
}

TEST(brdf_specimens_come_from_scenes)
{
    put_file("mixed.pbrt",
             "WorldBegin\n"
             "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"spectrum reflectance\" [ 360 0.2 830 0.2 ]\n"
             "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"spectrum reflectance\" [ 360 0.6 830 0.6 ]\n"
             "MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [ \"a\" \"b\" ]\n"
             "  \"float amount\" 0.25\n"
             "Material \"diffuse\" \"spectrum reflectance\" [ 360 0.9 830 0.9 ]\n"
             "Shape \"sphere\"\n");
    char words[600];
    const struct {
        const char *name;
        double reflectance;
    } expected[] = {{"a", 0.2}, {"b", 0.6}, {"m", 0.75 * 0.2 + 0.25 * 0.6}, {"#1", 0.9}};
    for (int i = 0; i < 4; ++i) {
        snprintf(words, sizeof words, "brdf eval mixed.pbrt:%s --wi 10 --wo 70 --json", expected[i].name);
        json_t *j = json_of(run_expecting(0, words));
        EXPECT_NEAR(json_number_value(json_array_get(json_object_get(json_object_get(j, "f"), "value"), 0)),
                    expected[i].reflectance / 3.14159265, 1e-6);
        json_decref(j);
    }
    EXPECT_SAYS(run_expecting(3, "brdf eval mixed.pbrt:c --wi 0 --wo 0")->err, "no material named \"c\"");
    EXPECT_SAYS(run_expecting(3, "brdf eval mixed.pbrt:#2 --wi 0 --wo 0")->err, "1 Material directives");
}

TEST(brdf_tells_what_is_wrong_with_words)
{
    static const struct {
        const char *words, *says;
    } wrong[] = {
        {"diffus", "did you mean diffuse?"},
        {"diffuse reflectanc=1", "did you mean reflectance?"},
        {"diffuse reflectance=1.5", "0 to 1 was expected"},
        {"diffuse reflectance=rgb:1,2,0", "numbers from 0 to 1"},
        {"diffuse reflectance=400:1", "two or more pairs"},
        {"diffuse reflectance=600:1,400:0", "must increase"},
        {"diffuse reflectance=.5 reflectance=.6", "given twice"},
        {"diffuse reflectance=metal-Au-et", "did you mean metal-Au-eta?"},
        {"conductor alpha_x=2", "a number from 0 to 1"},
        {"conductor alpha_x", "name=value was expected"},
        {"-1*diffuse", "weight"},
        {"0*diffuse", "weight of a part is above 0"},
    };
    char words[300];
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        snprintf(words, sizeof words, "brdf eval --wi 0 --wo 0 -- %s", wrong[i].words);
        const struct said *s = run(words, NULL);
        EXPECT(s->code == 3 || s->code == 2);
        EXPECT_SAYS(s->err, wrong[i].says);
    }
    EXPECT_SAYS(run_expecting(2, "brdf eval diffuse --wi 0 --wo 0 --lambda 100")->err, "200 to 3000 nm");
    EXPECT_SAYS(run_expecting(2, "brdf eval diffuse --wi 0")->err, "--wo THETA");
    EXPECT_SAYS(run_expecting(2, "brdf eval diffuse + --wi 0 --wo 0")->err, "either side of +");
}

TEST(brdf_reflectance_of_known_surfaces)
{
    json_t *j = json_of(run_expecting(0, "brdf reflectance diffuse reflectance=.5 --geometry 8/di --json"));
    json_t *value = json_array_get(json_object_get(j, "values"), 0);
    EXPECT_NEAR(quantity(value, "reflectance"), 0.5, 1e-8);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(j, "name")), "directional-hemispherical reflectance");
    json_decref(j);
    j = json_of(run_expecting(0, "brdf reflectance diffuse reflectance=.5 --geometry 45/0 --xyz A --json"));
    EXPECT_NEAR(quantity(j, "luminous_reflectance"), 0.5 / 3.14159265, 1e-6);
    json_decref(j);
    EXPECT_SAYS(run_expecting(2, "brdf reflectance diffuse --from hemisphere")->err, "--to direction:");
    EXPECT_SAYS(run_expecting(2, "brdf reflectance diffuse --geometry 8/d")->err, "8/di");
    EXPECT_SAYS(run_expecting(2, "brdf reflectance diffuse --from cone:80,0,20 --to hemisphere")->err, "horizon");
    EXPECT_SAYS(run_expecting(3, "brdf reflectance diffuse --geometry 45/0 --xyz nothing")->err, "illuminant");
}

TEST(brdf_check_passes_what_is_sound_and_fails_what_is_not)
{
    const struct said *s = run_expecting(0, "brdf check diffuse --quick --samples 4096 --soak 100000");
    EXPECT_SAYS(s->out, "reciprocity");
    EXPECT_SAYS(s->out, "soak");
    json_t *j = json_of(run_expecting(0, "brdf check conductor alpha_x=.3 alpha_y=.3 --samples 4096 --json"));
    EXPECT(json_is_true(json_object_get(j, "passed")));
    json_decref(j);
    // twice the light: exit 1, and the words say what is wrong
    s = run_expecting(1, "brdf check 2*diffuse reflectance=.9 --samples 4096");
    EXPECT_SAYS(s->out, "energy            FAILED");
    EXPECT_SAYS(s->out, "E = 1.8");
    EXPECT_SAYS(run_expecting(2, "brdf check --all diffuse")->err, "was not expected");
}
