/* SPDX-License-Identifier: MIT */
/* Numbers that a scene may hold, and that floats, integers or the ray caster cannot: each scene comes to an end, and
 * its samples are finite, or counted as dropped. Under sanitizers a cast that does not fit its integer fails as well.
 */
#include "test.h"

#include "import/import.h"
#include "render/render.h"

#include <math.h>

static uint32_t side = 6; // [pixel] of the pictures
static double mean_G;     // of the picture last rendered

static uint64_t render_text(const char *text)
{
    char path[1024];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/numbers.pbrt", test_folder());
    if (sr_file_write(path, text, strlen(text), &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_import_options options = {.threads = 1, .width = side, .height = side, .spp = 1};
    struct sr_import_result r;
    struct sr_log log = {0};
    if (sr_import_pbrt(path, &options, &r, &log, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&r);
    job.spp = 4;
    job.threads = 1;
    struct sr_film *film;
    struct sr_render_report report;
    EXPECT_EQUAL_INT(sr_render(&job, &film, &report, &error), SR_OK);
    mean_G = 0;
    for (uint32_t i = 0; i < film->width * film->height; ++i) {
        double mean[3];
        sr_film_pixel_mean(film, i % film->width, i / film->width, mean);
        EXPECT(isfinite(mean[0]) && isfinite(mean[1]) && isfinite(mean[2]));
        mean_G += mean[1] / (film->width * film->height);
    }
    sr_film_destroy(film);
    sr_import_result_free(&r);
    return report.dropped;
}

static uint64_t render(const char *estimator, const char *world)
{
    char text[4096];
    snprintf(text, sizeof text,
             "LookAt 0 0 4 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40\n%s\nWorldBegin\n%s\n"
             "Shape \"sphere\" \"float radius\" 0.2\n",
             estimator, world);
    return render_text(text);
}

#define SKY "LightSource \"infinite\"\n"
#define FLOOR                                                                                                          \
    "Shape \"trianglemesh\" \"point3 P\" [-9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1] \"integer indices\" [0 1 2 0 2 3]\n"

TEST(rays_beyond_what_can_be_cast_meet_nothing)
{
    render_text("LookAt 0 0 1e20 0 0 0 0 1 0 Camera \"perspective\" WorldBegin " SKY FLOOR);
    render_text("Translate -1e20 0 0 Camera \"orthographic\" \"float lensradius\" 1e20 WorldBegin " SKY FLOOR);
    render("Integrator \"ambientocclusion\" \"float maxdistance\" 1e20", SKY FLOOR);
    render("Integrator \"bdpt\"", SKY "LightSource \"point\" \"point3 from\" [1e20 0 0]\n" FLOOR);
    render("Integrator \"caustics\"", "LightSource \"point\" \"point3 from\" [0 1e20 0]\n" FLOOR);
}

TEST(instances_are_where_they_are_whatever_their_scale)
{
    render("", SKY FLOOR);
    double plain = mean_G;
    for (int exponent = 5; exponent <= 18; ++exponent)
        for (int k = 0; k < 4; ++k) { // larger or smaller than its object, standing or moving
            char text[1024];
            const char *s = k & 1 ? "-" : "", *t = k & 1 ? "" : "-",
                       *moving = "ActiveTransform EndTime Translate 1e-3 0 0 ActiveTransform All";
            snprintf(
                text, sizeof text,
                SKY
                "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [-9e%s%d -9e%s%d -1e%s%d 9e%s%d -9e%s%d -1e%s%d "
                "9e%s%d 9e%s%d -1e%s%d -9e%s%d 9e%s%d -1e%s%d] \"integer indices\" [0 1 2 0 2 3] ObjectEnd "
                "AttributeBegin %s Scale 1e%s%d 1e%s%d 1e%s%d ObjectInstance \"o\" AttributeEnd",
                s, exponent, s, exponent, s, exponent, s, exponent, s, exponent, s, exponent, s, exponent, s, exponent,
                s, exponent, s, exponent, s, exponent, s, exponent, k & 2 ? moving : "", t, exponent, t, exponent, t,
                exponent);
            render("", text);
            if (exponent <= (k & 1 ? 6 : 11)) // beyond, products of three lengths leave floats, and nothing is met
                EXPECT_NEAR(mean_G / plain, 1, 1e-4);
        }
}

TEST(textures_and_hair_of_huge_numbers_are_shaded)
{
    static const char *const marble[] = {"float scale", "float variation", "float roughness"};
    for (int i = 0; i < 3; ++i) {
        char text[512];
        snprintf(text, sizeof text,
                 SKY "Texture \"m\" \"spectrum\" \"marble\" \"%s\" 1e300\n"
                     "Material \"diffuse\" \"texture reflectance\" \"m\"\n" FLOOR,
                 marble[i]);
        render("", text);
    }
    render("", SKY "Material \"hair\" \"rgb sigma_a\" [1e300 1 1]\n" FLOOR);
    render("", SKY "Material \"hair\" \"float eumelanin\" 1e300\n" FLOOR);
}

TEST(lights_beyond_floats_of_each_other_are_chosen_among)
{
    render("", "LightSource \"point\" \"point3 from\" [3e38 0 0] LightSource \"point\" \"point3 from\" [-3e38 0 0]\n"
               "LightSource \"point\" \"point3 from\" [0 3 3] AttributeBegin AreaLightSource \"diffuse\" "
               "Translate 0 3e38 0 Shape \"disk\" AttributeEnd\n" FLOOR);
}

TEST(photons_far_from_the_origin_for_their_radius_are_found)
{
    render("Integrator \"caustics\" \"float radius\" 1e-12", SKY
           "LightSource \"point\" \"point3 from\" [0 0 3] Material \"dielectric\" Shape \"sphere\" \"float radius\" .5 "
           "Material \"diffuse\" " FLOOR);
}

/* Where a majorant of 1e20 holds for places with a density of 1 all steps are too short to be taken. */
TEST(null_collisions_without_end_are_given_up_and_counted)
{
    static const char *const estimators[] = {"Integrator \"volpath\"", "Integrator \"simplevolpath\""};
    side = 3; // each of its paths takes a while
    for (int i = 0; i < 2; ++i) {
        uint64_t dropped =
            render(estimators[i],
                   SKY "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" [1 2 3 4 1e20 6 7 8] "
                       "\"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2\n"
                       "AttributeBegin Material \"interface\" MediumInterface \"m\" \"\" "
                       "Shape \"sphere\" \"float radius\" 1.5 AttributeEnd\n"
                       "LightSource \"point\" \"point3 from\" [0 3 3] Shape \"sphere\"\n");
        EXPECT(dropped > 0);
    }
    side = 6;
}
