/* SPDX-License-Identifier: MIT */
/* Scenes in SI units: emission spectra are W m^-2 sr^-1 nm^-1 as they stand, power is in W; what is not a spectrum
 * stays as it is. */
#include "analytic/analytic.h"

#define SI "#@ Option \"string units\" \"si\"\n"
#define FLAT "[360 1 830 1]"
#define PLANCK_LUMINANCE 19749726.1611 // [cd/m^2] I11b: black body of 2856 K
#define V_INTEGRAL 106.856917101       // [nm] I6Y

struct unit_case {
    const char *name, *world;
    double E_v, E_e; // [lx] [W/m^2] expected at the origin, normal +z; NaN: not compared
};

static double infinity_disk = 10000. / 10001; // share of a hemisphere that a disk of 100 m fills from 1 m

/* Against the truth in both readings; false and a line where one is off. */
static bool is_right(const char *name, const char *what, double value, double error, double truth)
{
    double z = (value - truth) / hypot(error, 1e-5 * truth);
    bool ok = isnan(truth) || (fabs(z) < 4.9 && (is_slow_build() || error <= GOAL * truth * 8));
    printf("  %-44s %-4s %16.8g %16.8g %10.2g %6.2f%s\n", name, what, truth, value, error, z, ok ? "" : "  WRONG");
    return ok;
}

static bool measure(const struct unit_case *c)
{
    struct world w = world_of("%s", c->world);
    struct sr_irradiance E =
        sr_render_irradiance(&w.job, (sr_vec3){0, 0, 0}, (sr_vec3){0, 0, 1}, samples(1024), REPLICATES);
    bool ok = is_right(c->name, "E_v", E.E_v, E.E_v_error, c->E_v);
    ok = is_right(c->name, "E_e", E.E_e, E.E_e_error, c->E_e) && ok;
    world_free(&w);
    return ok;
}

TEST(spectra_in_si_units_are_taken_as_they_stand)
{
    double pi = (double)SR_PI, flat_lx = 683 * V_INTEGRAL;
    const double radius = 0.5, share = radius * radius / (radius * radius + 1); // of a disk at 1 m
    const struct unit_case cases[] = {
        {"black body, large disk",
         SI "WorldBegin\nAreaLightSource \"diffuse\" \"blackbody L\" 2856 \"bool twosided\" true\n"
            "Translate 0 0 1 Shape \"disk\" \"float radius\" 100\n",
         pi * PLANCK_LUMINANCE * infinity_disk, NAN},
        {"uniform sky of 1 W m^-2 sr^-1 nm^-1", SI "WorldBegin\nLightSource \"infinite\" \"spectrum L\" " FLAT "\n",
         pi * flat_lx, pi * 470},
        {"the same, twice", SI "WorldBegin\nLightSource \"infinite\" \"spectrum L\" " FLAT " \"float scale\" 2\n",
         2 * pi * flat_lx, 2 * pi * 470},
        {"sky of 100 W/m^2",
         SI "WorldBegin\nLightSource \"infinite\" \"spectrum L\" " FLAT " \"float illuminance\" 100\n",
         100 * flat_lx / 470, 100},
        {"sun of 1 W m^-2 nm^-1",
         SI "WorldBegin\nLightSource \"distant\" \"point3 from\" [0 0 1] \"point3 to\" [0 0 0] \"spectrum L\" " FLAT
            "\n",
         flat_lx, 470},
        {"point of 1 W sr^-1 nm^-1 at 2 m",
         SI "WorldBegin\nLightSource \"point\" \"point3 from\" [0 0 2] \"spectrum I\" " FLAT "\n", flat_lx / 4,
         470. / 4},
        {"point of 10 W at 1 m",
         SI "WorldBegin\nLightSource \"point\" \"point3 from\" [0 0 1] \"spectrum I\" " FLAT " \"float power\" 10\n",
         10 / (4 * pi) * flat_lx / 470, 10 / (4 * pi)},
        {"disk of 10 W",
         SI "WorldBegin\nAreaLightSource \"diffuse\" \"spectrum L\" " FLAT " \"float power\" 10\nReverseOrientation "
            "Shape \"disk\" \"float height\" 1 \"float radius\" 0.5\n",
         10 / (radius * radius * pi) * share * flat_lx / 470, 10 / (radius * radius * pi) * share},
        {"white sky stays photometric", SI "WorldBegin\nLightSource \"infinite\" \"float scale\" 3\n", 3 * pi, NAN},
        {"grey sky stays photometric", SI "WorldBegin\nLightSource \"infinite\" \"rgb L\" [0.5 0.5 0.5]\n", 0.5 * pi,
         NAN},
        {"without the option: luminance 1", "WorldBegin\nLightSource \"infinite\" \"spectrum L\" " FLAT "\n", pi, NAN},
        {"the option undone",
         SI
         "#@ Option \"string units\"\n#@   \"photometric\"\nWorldBegin\nLightSource \"infinite\" \"spectrum L\" " FLAT
         "\n",
         pi, NAN},
        {"no directive, a comment",
         "#@Option nothing\n# @ Option nothing\nWorldBegin\nLightSource \"infinite\" \"spectrum L\" " FLAT "\n", pi,
         NAN},
    };
    bool ok = true;
    printf("units\n  %-44s %-4s %16s %16s %10s %6s\n", "case", "", "truth", "measured", "error", "z");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
        ok &= measure(&cases[i]);
    EXPECT(ok);
}

TEST(the_picture_of_a_black_body_has_its_luminance)
{
    struct world w = world_of(
        SI
        "Integrator \"path\" \"integer maxdepth\" 0\nCamera \"perspective\" \"float fov\" 10\n"
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\n"
        "AreaLightSource \"diffuse\" \"blackbody L\" 2856 \"bool twosided\" true\nTranslate 0 0 1 Shape \"disk\" \"float radius\" 100\n");
    struct estimate e = pixel_mean(&w.job, 0, 0, 512, (const double[]){0, 1, 0});
    EXPECT(is_right("black body", "L_v", e.mean, e.error, PLANCK_LUMINANCE));
    world_free(&w);
}

/* ---- what is told ---- */

struct told {
    int warnings;
    char text[2048];
};

static void remember(void *user, enum sr_severity severity, const char *text)
{
    struct told *t = user;
    t->warnings += severity == SR_WARNING;
    if (severity == SR_WARNING)
        snprintf(t->text, sizeof t->text, "%s", text);
}

static struct told import(const char *text, enum sr_units units, enum sr_units expected, sr_status status)
{
    char path[512];
    snprintf(path, sizeof path, "%s/units.pbrt", test_folder());
    FILE *f = fopen(path, "w");
    EXPECT(f && fputs(text, f) >= 0 && fclose(f) == 0);
    struct told told = {0};
    struct sr_log log = {.write = remember, .user = &told};
    struct sr_error error = {0};
    struct sr_import_result result;
    struct sr_import_options options = {.units = units};
    EXPECT_EQUAL_INT(sr_import_pbrt(path, &options, &result, &log, &error), status);
    if (status == SR_OK) {
        EXPECT_EQUAL_INT(result.units, expected);
        sr_import_result_free(&result);
    } else
        snprintf(told.text, sizeof told.text, "%s", error.text);
    return told;
}

TEST(spectra_that_look_otherwise_than_they_count_are_told_once)
{
#define SKY(spectrum) "LightSource \"infinite\" \"spectrum L\" " spectrum "\n"
    struct told t = import("WorldBegin\n" SKY("[360 1e4 830 2e4]") SKY("[360 1e4 830 2e4]"), SR_UNITS_OF_SCENE,
                           SR_UNITS_PHOTOMETRIC, SR_OK);
    EXPECT(t.warnings == 1 && strstr(t.text, "looks absolute (up to 20000)"));
    t = import("WorldBegin\n" SKY("[360 1e4 830 2e4]"), SR_UNITS_SI, SR_UNITS_SI, SR_OK);
    EXPECT_EQUAL_INT(t.warnings, 0);
    t = import("WorldBegin\n" SKY("[360 1 830 100]") SKY("\"stdillum-D65\"")
                   SKY("[360 1e4 830 2e4] \"float illuminance\" 7"),
               SR_UNITS_OF_SCENE, SR_UNITS_PHOTOMETRIC, SR_OK);
    EXPECT_EQUAL_INT(t.warnings, 0);
    t = import(SI "WorldBegin\n" SKY("\"stdillum-D65\""), SR_UNITS_OF_SCENE, SR_UNITS_SI, SR_OK);
    EXPECT(t.warnings == 1 && strstr(t.text, "relative spectrum"));
    t = import(SI "WorldBegin\n" SKY("\"stdillum-D65\" \"float illuminance\" 7"), SR_UNITS_OF_SCENE, SR_UNITS_SI,
               SR_OK);
    EXPECT_EQUAL_INT(t.warnings, 0);
    import(SI "WorldBegin\n" SKY("[360 1 830 1]"), SR_UNITS_PHOTOMETRIC, SR_UNITS_PHOTOMETRIC, SR_OK);
    t = import("#@ Option \"string units\" \"imperial\"\nWorldBegin\n", SR_UNITS_OF_SCENE, SR_UNITS_SI, SR_ERROR_INPUT);
    EXPECT(strstr(t.text, "units.pbrt:1:") && strstr(t.text, "expected \"photometric\" or \"si\""));
    t = import("#@ Opton \"string units\" \"si\"\nWorldBegin\n", SR_UNITS_OF_SCENE, SR_UNITS_PHOTOMETRIC, SR_OK);
    EXPECT(t.warnings == 2 && strstr(t.text, "the scene is empty")); // the misspelt word is told of first
    t = import("#@ Opton \"string units\" \"si\"\nWorldBegin\n" SKY("\"stdillum-D65\""), SR_UNITS_OF_SCENE,
               SR_UNITS_PHOTOMETRIC, SR_OK);
    EXPECT(t.warnings == 1 && strstr(t.text, "units.pbrt:1:4") && strstr(t.text, "did you mean \"Option\"?"));
}
