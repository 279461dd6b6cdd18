/* SPDX-License-Identifier: MIT */
/* The uncertainty budget of an integrating sphere: its sensitivity to the wall is known (Jacquez & Kuppenheim 1955). */
#include "run.h"

/* rho = 0.99, a port of f = 0.02 of the sphere: Phi = (1 - f) / (1 - rho (1 - f)) */
#define SPHERE(declared)                                                                                               \
    "Integrator \"path\" \"integer maxdepth\" 2000\n" declared "WorldBegin\n"                                          \
    "LightSource \"point\" \"float power\" 1\n"                                                                        \
    "MakeNamedMaterial \"wall\" \"string type\" \"diffuse\" \"spectrum reflectance\" [360 0.99 830 0.99]\n"            \
    "NamedMaterial \"wall\"\n#@ Name \"wall\"\nShape \"sphere\" \"float radius\" 0.15 \"float zmax\" 0.144\n"          \
    "#@ Meter \"flux\" \"string name\" \"Phi\" \"string surface\" \"wall\" \"string side\" \"back\"\n"
#define WALL                                                                                                           \
    "#@ Uncertainty \"reflectance\" \"string material\" \"wall\" \"string parameter\" \"reflectance\" \"float u\" 0.001\n"
#define LAMP                                                                                                           \
    "#@ Uncertainty \"lamp\" \"string light\" \"#1\" \"string parameter\" \"power\" \"float a\" 0.01 \"bool relative\" true\n"

static double number(json_t *j, const char *name)
{
    json_t *value = json_object_get(j, name);
    if (!json_is_number(value))
        test_fail(__FILE__, __LINE__, "%s is no number", name);
    return json_number_value(value);
}

TEST(budget_of_an_integrating_sphere_has_its_sensitivities)
{
    put_file("sphere.pbrt", SPHERE(LAMP WALL));
    json_t *j = json_of(run_expecting(0, "measure sphere.pbrt --budget --samples 16384 --json"));
    json_t *budget = json_array_get(json_object_get(j, "budgets"), 0), *sources = json_object_get(budget, "sources"),
           *total = json_object_get(budget, "combined");
    json_t *replicates = json_array_get(sources, 0), *lamp = json_array_get(sources, 1),
           *wall = json_array_get(sources, 2);
    double f = 0.02, rho = 0.99, loop = 1 - rho * (1 - f), phi = (1 - f) / loop, y = number(replicates, "value"),
           u_A = number(replicates, "u");
    EXPECT_NEAR(y, phi, 5 * u_A);
    EXPECT_RELATIVE(number(wall, "sensitivity"), (1 - f) * (1 - f) / (loop * loop), 0.05);
    // D5: the wall's radiance, which is rho Phi, at 0.989 over that at 0.990; the same random numbers go along nearly
    // the same paths
    EXPECT_NEAR(number(wall, "low") * 0.989 / (y * 0.99), 0.967183203051, 0.003);
    EXPECT_RELATIVE(number(lamp, "u"), 0.01 / sqrt(3), 1e-6);
    EXPECT_RELATIVE(number(lamp, "sensitivity"), y, 1e-4); // the reading goes with the power
    double part_lamp = number(lamp, "contribution"), part_wall = number(wall, "contribution");
    double u = sqrt(u_A * u_A + part_lamp * part_lamp + part_wall * part_wall);
    EXPECT_RELATIVE(number(total, "standard_uncertainty"), u, 1e-6);
    EXPECT_RELATIVE(number(total, "degrees_of_freedom"), pow(u / u_A, 4) * 15,
                    1e-5); // Welch & Satterthwaite: only type A has finite ones
    json_decref(j);
    const struct said *s = run_expecting(0, "measure sphere.pbrt --budget --samples 64");
    EXPECT_SAYS(s->out, "rectangular");
    EXPECT_SAYS(s->out, "combined standard uncertainty");
}

TEST(budget_without_declared_uncertainties_is_that_of_the_replicates)
{
    put_file("plain.pbrt", SPHERE(""));
    EXPECT_SAYS(run_expecting(0, "measure plain.pbrt --budget --samples 64")->err, "declares no uncertainty");
    run_expecting(2, "measure plain.pbrt --budget --error 1%");
}

TEST(declared_uncertainties_that_make_no_sense_are_refused)
{
    static const char *const wrong[][2] = {
        {"\"string material\" \"floor\" \"string parameter\" \"reflectance\" \"float u\" 0.001",
         "there is no material \"floor\""},
        {"\"string material\" \"wall\" \"string parameter\" \"roughness\" \"float u\" 0.001",
         "gives no numbers for \"roughness\""},
        {"\"string material\" \"wall\" \"string parameter\" \"type\" \"float u\" 0.001",
         "gives no numbers for \"type\""},
        {"\"string light\" \"#2\" \"string parameter\" \"power\" \"float u\" 0.001", "there is no light \"#2\""},
        {"\"string light\" \"#1\" \"string parameter\" \"power\"", "one of \"u\", \"a\""},
        {"\"string light\" \"#1\" \"string parameter\" \"power\" \"float u\" 1 \"float a\" 1", "one of \"u\", \"a\""},
        {"\"string parameter\" \"power\" \"float u\" 1", "expected one of \"material\""},
        {"\"string light\" \"#1\" \"string parameter\" \"power\" \"float u\" -1", "expected 0 or more"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        char text[2048];
        snprintf(text, sizeof text, "#@ Uncertainty \"it\" %s\n%s", wrong[i][0], SPHERE(""));
        put_file("wrong.pbrt", text);
        EXPECT_SAYS(run_expecting(3, "measure wrong.pbrt --budget --samples 64")->err, wrong[i][1]);
    }
    // shifted beyond what a reflectance may be
    put_file(
        "beyond.pbrt",
        SPHERE(
            "#@ Uncertainty \"it\" \"string material\" \"wall\" \"string parameter\" \"reflectance\" \"float u\" 1\n"));
    EXPECT_SAYS(run_expecting(3, "measure beyond.pbrt --budget --samples 64")->err, "expected 0 to 1");
}
