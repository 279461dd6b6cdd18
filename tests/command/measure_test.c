/* SPDX-License-Identifier: MIT */
/* steradian measure as a user runs it: readings that are right, lines in and out, and what is said when something is
 * wrong. */
#define _POSIX_C_SOURCE 200809L
#include "run.h"

#include <signal.h>
#include <time.h>

#define BENCH SR_TEST_SOURCE_DIR "/scenes/meters.pbrt"

static const json_t *meter_of(const json_t *j, const char *name)
{
    size_t i;
    const json_t *m;
    json_array_foreach(json_object_get(j, "meters"), i,
                       m) if (strcmp(json_string_value(json_object_get(m, "name")), name) == 0) return m;
    test_fail(__FILE__, __LINE__, "there is no meter %s", name);
}

static double number_of(const json_t *j, const char *key)
{
    const json_t *v = json_object_get(j, key);
    if (!json_is_number(v))
        test_fail(__FILE__, __LINE__, "there is no number %s", key);
    return json_number_value(v);
}

static void expect_reading(const json_t *all, const char *name, const char *unit, double truth)
{
    const json_t *q = json_object_get(json_object_get(meter_of(all, name), "readings"), "photopic");
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(q, "unit")), unit);
    double value = number_of(q, "value"), u = number_of(q, "standard_uncertainty");
    if (!(fabs(value - truth) <= 5 * u))
        test_fail(__FILE__, __LINE__, "%s: %.9g +- %.2g, expected %.9g", name, value, u, truth);
}

/* The closed forms that stand in the scene: a disk of 1000 cd/m^2, radius 0.5 at z = 3, and a point of 100 cd at (1.5,
 * 0, 2.8). */
TEST(measure_reads_the_bench_as_its_closed_forms_say)
{
    const struct said *s = run_expecting(0, "measure " BENCH " --json -q --samples 65536");
    EXPECT_EQUAL_TEXT(s->err, "");
    json_t *j = json_of(s);
    double pi = 3.14159265358979323846, h = 1.8, a = atan(0.5 / h), r2 = 1.5 * 1.5 + 1.6 * 1.6, I = 100 / r2,
           cosine = 1.6 / sqrt(r2), sine = 1.5 / sqrt(r2);
    expect_reading(j, "desk", "lx", 1000 * pi * 0.25 / (0.25 + 2.2 * 2.2) + 12.8);
    expect_reading(j, "lamp, ray", "cd/m^2", 1000);
    expect_reading(j, "lamp, cone", "cd/m^2", 1000);
    expect_reading(j, "face", "lx", 1000 * (a - sin(a) * cos(a)) + I * sine / pi);
    expect_reading(j, "face, to +x", "lx", 1000 * (a - sin(a) * cos(a)) + I * 2 * sine / pi);
    expect_reading(j, "dome", "lx", 1000 * pi / 2 * (1 - cos(a) + sin(a) * sin(a) / 2) + I * (1 + cosine) / 4);
    expect_reading(j, "ball", "lx", 1000 * pi / 2 * (1 - cos(a)) + I / 4);
    expect_reading(j, "fluence", "lx", 1000 * 2 * pi * (1 - cos(a)) + I);
    expect_reading(j, "out of ball", "lm", -400 * pi);
    EXPECT(json_is_true(json_object_get(j, "complete")));
    const json_t *colour = json_object_get(meter_of(j, "colour"), "colour"),
                 *spectrum = json_object_get(meter_of(j, "spectrum"), "spectrum");
    EXPECT_NEAR(number_of(json_object_get(colour, "x"), "value"), 0.44757, 2e-5);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(colour, "CCT"), "unit")), "K");
    EXPECT_NEAR(number_of(json_object_get(colour, "CCT"), "value"), 2855.5, 0.1);
    EXPECT_EQUAL_INT(json_array_size(json_object_get(spectrum, "value")), 7);
    json_decref(j);
}

TEST(measure_prints_readings_with_their_intervals)
{
    const struct said *s = run_expecting(0, "measure " BENCH " --meter desk --quantity photopic,radiometric,par -q");
    EXPECT_SAYS(s->out, "E_v = 167.");
    EXPECT_SAYS(s->out, " lx ± ");
    EXPECT_SAYS(s->out, "(95 %, k = 2.13, ν = 15)");
    EXPECT_SAYS(s->out, "desk  E_e = 1.3");
    EXPECT_SAYS(s->out, "umol/(m^2 s)");
    EXPECT(!strstr(s->out, "ball"));
    s = run_expecting(0, "measure " BENCH " --list");
    EXPECT_SAYS(s->out, "semicylindrical irradiance: 1/π ∫ L sin θ (1 + cos φ) dω");
}

TEST(measure_reaches_a_target_or_says_that_it_did_not)
{
    const struct said *s = run_expecting(0, "measure " BENCH " -m desk --error 0.1% --json -q");
    json_t *j = json_of(s);
    const json_t *q = json_object_get(json_object_get(meter_of(j, "desk"), "readings"), "photopic");
    EXPECT(number_of(q, "expanded_uncertainty") <= 0.001 * number_of(q, "value"));
    EXPECT(number_of(meter_of(j, "desk"), "pilot_samples") > 0);
    json_decref(j);
    s = run_expecting(1, "measure " BENCH " -m desk --error 0.0001% --samples 8000 -q");
    EXPECT_SAYS(s->err, "was asked for");
}

TEST(measure_streams_points_and_rays)
{
    put_file("points", "# the desk\n0 0 0.8  0 0 1\n\n0 0 0.8, 0 0 2 # longer normal\n");
    const struct said *s = run("measure " BENCH " --points -q", "points");
    EXPECT_EQUAL_INT(s->code, 0);
    double E[2], U[2];
    EXPECT_EQUAL_INT(sscanf(s->out, "%lf %lf\n%lf %lf", &E[0], &U[0], &E[1], &U[1]), 4);
    for (int i = 0; i < 2; ++i)
        EXPECT(fabs(E[i] - 167.1007) < 3 * U[i] && U[i] < 1);
    put_file("rays", "0 0 1  0 0 1\n0 0 1  0 0 -1\n");
    s = run("measure " BENCH " --rays --json -q", "rays");
    EXPECT_EQUAL_INT(s->code, 0);
    EXPECT_SAYS(s->out, "{\"line\":1,\"p_m\":[0.0,0.0,1.0],\"direction\":[0.0,0.0,1.0],\"readings\":{\"photopic\":{");
    put_file("bad", "0 0 1  0 0 1\n1 2 3\n");
    s = run("measure " BENCH " --points -q", "bad");
    EXPECT_EQUAL_INT(s->code, 3);
    EXPECT_SAYS(s->err, "standard input:2: this line cannot be read: expected six numbers, x y z nx ny nz");
    put_file("bad", "0 0 1  0 0 0\n");
    s = run("measure " BENCH " --rays -q", "bad");
    EXPECT_EQUAL_INT(s->code, 3);
    EXPECT_SAYS(s->err, "no direction");
}

TEST(measure_writes_a_map_with_its_error)
{
    put_file(
        "map.pbrt",
        "WorldBegin LightSource \"infinite\" \"float scale\" 1\n"
        "#@ Meter \"irradiancemap\" \"string name\" \"map\" \"vector3 u\" [1 0 0] \"vector3 v\" [0 1 0] \"integer nx\" 4 \"integer ny\" 3\n");
    run_expecting(0, "measure map.pbrt -o map.exr -q");
    struct sr_image *image = get_image("map.exr");
    EXPECT(image->width == 4 && image->height == 3 && sr_image_find_channel(image, "SE.Y") >= 0);
    int y = sr_image_find_channel(image, "Y");
    for (size_t i = 0; i < 12; ++i)
        EXPECT_RELATIVE(image->floats[i * image->channel_count + (size_t)y], 3.14159265, 2e-3);
    EXPECT_EQUAL_TEXT(image->channels[y].unit, "lx");
    sr_image_free(image);
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " -o map.exr -m ball")->err,
                "-o writes one map or intensity distribution, and 0 are asked for");
}

TEST(measure_says_what_is_wrong)
{
    EXPECT_SAYS(run_expecting(2, "measure")->err, "a scene file was expected");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --meter dask")->err,
                "has no meter \"dask\"; did you mean \"desk\"?");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --quantity photopik")->err, "did you mean \"photopic\"?");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --error 200%")->err, "--error 200%");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --spectrum 400-700")->err, "LO:STEP:HI in nm was expected");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --eror 1%")->err, "did you mean --error?");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --points --list")->err, "do not go with them");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --fwhm 5")->err, "--spectrum LO:STEP:HI, which is missing");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --bandpass triangular")->err,
                "--spectrum LO:STEP:HI, which is missing");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --spectrum 700:10:400")->err,
                "wavelengths from 700 by 10 to 400 nm");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --balance --meter desk")->err, "--balance is of the whole scene");
    EXPECT_SAYS(run_expecting(2, "measure " BENCH " --balance --error 1%")->err, "--balance is of the whole scene");
    EXPECT_SAYS(run_expecting(3, "measure " CORNELL)->err, "the scene has no meters");
    put_file(
        "dark.pbrt",
        "WorldBegin Shape \"sphere\" LightSource \"point\" \"point3 from\" [0 0 3]\n#@ Meter \"fluence\" \"string name\" \"inside\"\n");
    const struct said *s = run_expecting(0, "measure dark.pbrt");
    EXPECT_SAYS(s->err, "warning: meter \"inside\": no light found in 65536 samples");
    EXPECT_SAYS(s->err, "inside shape number 1");
    EXPECT_SAYS(s->out, "inside  E_v,o = 0 lx (nothing was found, and no bound is known)");
}

TEST(measure_when_interrupted_prints_what_there_is)
{
    put_file(
        "long.pbrt",
        "WorldBegin LightSource \"infinite\"\nAreaLightSource \"diffuse\" Shape \"sphere\" \"float radius\" 0.1\nTranslate 0 0 3\n"
        "#@ Meter \"irradiance\" \"normal n\" [0 0 -1] \"string name\" \"m\"\n");
    pid_t pid = start("measure long.pbrt --samples 100000000000 -q");
    wait_until_caught(pid, SIGINT);
    nanosleep(&(struct timespec){.tv_nsec = 500000000}, NULL);
    kill(pid, SIGINT);
    const struct said *s = finish(pid);
    EXPECT_EQUAL_INT(s->code, 130);
    EXPECT_SAYS(s->out, "m  E_v = ");
    EXPECT_SAYS(s->err, "interrupted; what there was has been printed");
}
