/* SPDX-License-Identifier: MIT */
/* The public laboratory through its header alone: what it lists, makes, evaluates, draws, integrates and refuses. */
#include "test.h"

#include <steradian/bsdf.h>

#define PI 3.14159265358979324

static struct sr_brdf *make(const char *words)
{
    char error[256] = "";
    struct sr_brdf *b;
    if (sr_brdf_create(words, &b, error, sizeof error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s: %s", words, error);
    return b;
}

TEST(models_tell_their_parameters)
{
    int count = 0;
    for (const char *name; (name = sr_brdf_model(count)); ++count) {
        struct sr_brdf_parameter p;
        for (int k = 0; sr_brdf_model_parameter(name, k, &p); ++k) {
            EXPECT(p.name && p.unit && p.text);
            EXPECT(p.kind == SR_BRDF_FILE || p.kind == SR_BRDF_CHOICE || p.kind == SR_BRDF_SWITCH ||
                   (p.least <= p.initial && p.initial <= p.most));
        }
    }
    EXPECT(count >= 7);
    struct sr_brdf_parameter p;
    EXPECT(sr_brdf_model_parameter("diffuse", 0, &p));
    EXPECT(strcmp(p.name, "reflectance") == 0 && p.kind == SR_BRDF_SPECTRUM && p.initial == 0.5);
    EXPECT(!sr_brdf_model_parameter("diffuse", 1, &p) && !sr_brdf_model_parameter("nothing", 0, &p));
    EXPECT(!sr_brdf_model(-1) && !sr_brdf_model_title("nothing"));
}

TEST(lambert_is_evaluated_drawn_and_integrated)
{
    struct sr_brdf *b = make("diffuse reflectance=.4");
    const float wo[2][3] = {{0, 0, 1}, {0.6f, 0, 0.8f}}, wi[2][3] = {{0, 0.6f, 0.8f}, {0, 0, -1}};
    float f[2], pdf[2];
    sr_brdf_evaluate(b, 550, 2, wo, wi, f, pdf);
    EXPECT_NEAR(f[0], 0.4 / PI, 1e-7);
    EXPECT_NEAR(pdf[0], 0.8 / PI, 1e-7);
    EXPECT(f[1] == 0 && pdf[1] == 0);

    const float u[1][3] = {{0.5f, 0.25f, 0.75f}};
    struct sr_brdf_sample s;
    sr_brdf_draw(b, 550, 1, wo, u, &s);
    EXPECT(!s.is_mirror && s.wi[2] > 0);
    EXPECT_NEAR(s.f * s.wi[2] / s.pdf, 0.4, 1e-6);

    double error;
    EXPECT_NEAR(sr_brdf_albedo(b, 550, 60, 0, 1000, &error), 0.4, 1e-6);
    struct sr_brdf_reflectance r;
    char text[256] = "";
    EXPECT(sr_brdf_reflectance(b, 550, "direction:30", "hemisphere", 1e-6, &r, text, sizeof text) == SR_OK);
    EXPECT_NEAR(r.value, 0.4, 1e-6);
    EXPECT(strstr(r.name, "hemispherical") != NULL && strcmp(r.unit, "1") == 0);
    EXPECT(sr_brdf_reflectance(b, 550, "cone:80,0,20", "hemisphere", 1e-6, &r, text, sizeof text) != SR_OK && text[0]);
    sr_brdf_destroy(b);
}

TEST(sums_add_what_their_parts_scatter)
{
    struct sr_brdf *one = make("diffuse reflectance=.2"), *two = make("conductor alpha_x=.3 alpha_y=.3"),
                   *both = make("diffuse reflectance=.2 + conductor alpha_x=.3 alpha_y=.3"),
                   *mix = make(".25*diffuse reflectance=.2 + .75*conductor alpha_x=.3 alpha_y=.3");
    const float wo[1][3] = {{0.6f, 0, 0.8f}}, wi[1][3] = {{-0.48f, 0.36f, 0.8f}};
    float a, b, sum, weighed;
    sr_brdf_evaluate(one, 550, 1, wo, wi, &a, NULL);
    sr_brdf_evaluate(two, 550, 1, wo, wi, &b, NULL);
    sr_brdf_evaluate(both, 550, 1, wo, wi, &sum, NULL);
    sr_brdf_evaluate(mix, 550, 1, wo, wi, &weighed, NULL);
    EXPECT(a > 0 && b > 0);
    EXPECT_RELATIVE(sum, a + b, 1e-6);
    EXPECT_RELATIVE(weighed, 0.25f * a + 0.75f * b, 1e-6);
    sr_brdf_destroy(one), sr_brdf_destroy(two), sr_brdf_destroy(both), sr_brdf_destroy(mix);
}

TEST(what_makes_no_sense_is_told)
{
    const struct {
        const char *words, *told;
    } cases[] = {
        {"", "expected"},
        {"difuse", "diffuse"},
        {"diffuse reflectence=.5", "reflectance"},
        {"diffuse reflectance=2", "reflectance"},
        {"diffuse reflectance=bright", "reflectance"},
        {"diffuse +", "part"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char error[256] = "";
        struct sr_brdf *b;
        sr_status status = sr_brdf_create(cases[i].words, &b, error, sizeof error);
        if (status == SR_OK || b || !strstr(error, cases[i].told))
            test_fail(__FILE__, __LINE__, "\"%s\": %d, \"%s\"", cases[i].words, status, error);
    }
    sr_brdf_destroy(NULL);
}

static void count_verdicts(void *user, const char *check, enum sr_brdf_verdict verdict, double measured, double limit,
                           const char *text)
{
    (void)check, (void)measured, (void)limit, (void)text;
    ((int *)user)[verdict] += 1;
}

TEST(lambert_has_a_certificate)
{
    struct sr_brdf *b = make("diffuse reflectance=.9");
    int verdicts[4] = {0};
    char error[256] = "";
    sr_status status = sr_brdf_check(b, 0, 1, count_verdicts, verdicts, error, sizeof error);
    if (status != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error);
    EXPECT(verdicts[SR_BRDF_PASSED] >= 6 && verdicts[SR_BRDF_FAILED] == 0);
    sr_brdf_destroy(b);
}

TEST(what_nobody_can_know_is_not_a_number)
{
    struct sr_brdf *b = make("conductor alpha_x=.3 alpha_y=.3");
    double error = 0;
    EXPECT(isnan(sr_brdf_albedo(b, 550, 30, 0, 0, &error)) && isnan(error));
    EXPECT(sr_brdf_albedo(b, 550, 30, 0, 1, &error) > 0 && isnan(error));
    EXPECT(isnan(sr_brdf_albedo(b, 550, NAN, 0, 16, &error)) && isnan(error));

    const float wo[1][3] = {{0.6f, 0, 0.8f}},
                u[][3] = {
                    {NAN, 0.5f, 0.5f}, {0.5f, NAN, 0.5f}, {0.5f, 0.5f, INFINITY}, {1, 0.5f, 0.5f}, {-1, 0.5f, 0.5f}};
    for (size_t i = 0; i < sizeof u / sizeof u[0]; ++i) {
        struct sr_brdf_sample s = {.pdf = 1};
        sr_brdf_draw(b, 550, 1, wo, &u[i], &s);
        EXPECT(s.pdf == 0);
    }
    struct sr_brdf_reflectance r;
    char text[256] = "";
    const double wrong[][2] = {{NAN, 1e-4}, {-1, 1e-4}, {550, 0}, {550, -1}, {550, NAN}, {550, INFINITY}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i)
        EXPECT_EQUAL_INT(
            sr_brdf_reflectance(b, wrong[i][0], "direction:30", "hemisphere", wrong[i][1], &r, text, sizeof text),
            SR_ERROR_USAGE);
    sr_brdf_destroy(b);
}
