/* SPDX-License-Identifier: MIT */
/* Scenes far from the origin, turned, and of other sizes: what is measured does not know. */
#include "agree/render_helper.h"

struct reading {
    double E;
    struct sr_box bounds;
    double origin[3];
    int warnings;
};

/* An object, defined where nothing is placed yet. */
static const char object[] =
    "ObjectBegin \"ball\"\nTranslate 0 0 0.1\nShape \"sphere\" \"float radius\" 0.2\nObjectEnd\n";
static const char by_chance[] = "\"path\" \"integer maxdepth\" 60",
                  by_quadrature[] = "\"quadrature\" \"integer maxdepth\" 0 \"float tolerance\" 1e-6";

/* E at `at` of the scene's text behind `before`, which places all of it. */
static struct reading measure_by(const char *integrator, const char *before, const char *world, const double at[3],
                                 sr_vec3 n, uint32_t samples)
{
    char text[2048];
    snprintf(text, sizeof text,
             "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nIntegrator %s\nWorldBegin\n%s%s\n%s\n",
             integrator, object, before, world);
    struct sr_import_result scene;
    struct sr_import_options options = {.threads = 1};
    struct sr_log log = {0};
    struct sr_error error = {0};
    if (sr_import_pbrt(scene_file("far.pbrt", text), &options, &scene, &log, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.threads = 1;
    memcpy(job.origin, scene.origin, sizeof job.origin);
    struct reading r = {.bounds = sr_scene_bounds(scene.scene), .warnings = (int)log.warning_count};
    memcpy(r.origin, scene.origin, sizeof r.origin);
    r.E = sr_render_irradiance(&job, sr_render_place(&job, at), n, samples, 2).E_v;
    sr_import_result_free(&scene);
    return r;
}

static struct reading measure(const char *before, const char *world, const double at[3], sr_vec3 n, uint32_t samples)
{
    return measure_by(by_chance, before, world, at, n, samples);
}

/* A closed sphere that shines and reflects half: E = pi L / (1 - 1/2). */
static const char furnace[] =
    "AttributeBegin\nReverseOrientation\nMaterial \"diffuse\" \"float reflectance\" 0.5\nAreaLightSource \"diffuse\" \"float scale\" 1\n"
    "Shape \"sphere\"\nAttributeEnd\n";
/* A square of 1 m x 1 m and 1 cd/m^2, 1 m above the receiver: E = 0.752274688454 lx (Howell; Hamilton & Morgan, 1952).
 */
static const char square[] =
    "AreaLightSource \"diffuse\" \"float scale\" 1\nMaterial \"diffuse\" \"float reflectance\" 0\n"
    "Shape \"bilinearmesh\" \"point3 P\" [-0.5 -0.5 1  -0.5 0.5 1  0.5 -0.5 1  0.5 0.5 1]\n";
/* A mesh and an instance beside a lamp of two triangles. */
static const char meshes[] =
    "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" 3\n"
    "Shape \"trianglemesh\" \"integer indices\" [0 2 1 0 3 2] \"point3 P\" [-0.5 -0.5 1  0.5 -0.5 1  0.5 0.5 1  -0.5 0.5 1]\nAttributeEnd\n"
    "AttributeBegin\nTranslate 0.6 0 0.1\nRotate 30 0 1 0\nObjectInstance \"ball\"\nAttributeEnd\n"
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-2 -2 -0.2  2 -2 -0.2  2 2 -0.2  -2 2 -0.2]\n";
static const char *const worlds[] = {furnace, square, meshes};

TEST(far_from_the_origin_all_is_as_it_is_there)
{
    uint32_t samples = is_slow_build() ? 256 : 8192;
    for (int i = 0; i < 3; ++i) {
        struct reading here = measure("", worlds[i], (double[3]){0, 0, 0}, (sr_vec3){0, 0, 1}, samples);
        if (i == 0)
            EXPECT_RELATIVE(here.E, 2 * M_PI, is_slow_build() ? 0.05 : 1e-2);
        if (i == 1)
            EXPECT_RELATIVE(here.E, 0.752274688454, is_slow_build() ? 0.05 : 1e-3);
        EXPECT_EQUAL_INT(here.warnings, 0);
        EXPECT_EQUAL_INT(here.origin[0] != 0, 0);
        double largest = 0;
        for (int k = 0; k <= 7; ++k) {
            double o = pow(10, k);
            char before[200];
            snprintf(before, sizeof before, "Translate %.17g %.17g %.17g", o, o, o);
            struct reading there = measure(before, worlds[i], (double[3]){o, o, o}, (sr_vec3){0, 0, 1}, samples);
            EXPECT_RELATIVE(there.E, here.E, 1e-4);
            largest = fmax(largest, fabs(there.E / here.E - 1));
            static const double sizes[3] = {2, 1, 4}; // [m]
            EXPECT_EQUAL_INT(there.origin[0] != 0, o > 64 * sizes[i]);
        }
        fprintf(stderr, "  scene %d: changes of E up to %.1e\n", i, largest);
    }
}

/* 0.37 m beside round numbers, where the steps of float are 0.0078 m. */
TEST(what_transforms_place_far_away_keeps_its_place)
{
    uint32_t samples = is_slow_build() ? 256 : 8192;
    const double o[3] = {100000.37, -200000.12, 300000.81};
    char before[200];
    snprintf(before, sizeof before, "Translate %.17g %.17g %.17g", o[0], o[1], o[2]);
    for (int i = 0; i < 3; ++i) {
        struct reading here = measure("", worlds[i], (double[3]){0, 0, 0}, (sr_vec3){0, 0, 1}, samples),
                       there = measure(before, worlds[i], o, (sr_vec3){0, 0, 1}, samples);
        EXPECT_RELATIVE(there.E, here.E, 1e-4);
        fprintf(stderr, "  scene %d, no round place: a change of E of %.1e\n", i, there.E / here.E - 1);
        EXPECT_EQUAL_INT(there.warnings, 1);
        EXPECT_NEAR((double)there.bounds.hi.x + there.origin[0] - o[0], (double)here.bounds.hi.x, 1e-5);
    }
}

/* Pictures too: the camera, its points in the world, and all that moves. */
TEST(pictures_of_far_places_are_the_same_bytes)
{
    static const double o[] = {0, 131072, 16777216};
    struct sr_film *films[3];
    struct sr_import_result scenes[3];
    for (int i = 0; i < 3; ++i) {
        char text[2048];
        snprintf(
            text, sizeof text,
            "Translate 0 0 4\nRotate -60 1 0 0\nTranslate %.9g %.9g %.9g\nCamera \"perspective\" \"float shutterclose\" 1\nSampler \"sobol\" \"integer pixelsamples\" 4\n"
            "Film \"gbuffer\" \"integer xresolution\" 24 \"integer yresolution\" 24 \"string coordinatesystem\" \"world\"\nWorldBegin\n%sTranslate %.9g %.9g %.9g\n"
            "Texture \"t\" \"spectrum\" \"checkerboard\" \"integer dimension\" 3 \"rgb tex1\" [0.2 0.5 0.8]\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n"
            "LightSource \"point\" \"point3 from\" [1 -1 2]\nLightSource \"infinite\"\n%s"
            "AttributeBegin\nActiveTransform EndTime\nTranslate 0.5 0 0\nActiveTransform All\nShape \"sphere\" \"float radius\" 0.3\nAttributeEnd\n",
            -o[i], -o[i], -o[i], object, o[i], o[i], o[i], meshes);
        struct sr_error error = {0};
        if (!import_scene(scene_file("far.pbrt", text), NULL, &scenes[i], &error))
            test_fail(__FILE__, __LINE__, "%s", error.text);
        struct sr_render_job job = sr_render_job_of(&scenes[i]);
        struct sr_render_report report;
        job.with_aov = true;
        films[i] = render_or_fail(&job, &report);
        EXPECT_EQUAL_INT(report.dropped, 0);
        EXPECT_EQUAL_INT(memcmp(films[i]->pixels, films[0]->pixels, 24 * 24 * sizeof *films[0]->pixels), 0);
    }
    for (int i = 2; i >= 0; --i) {
        sr_film_destroy(films[i]);
        sr_import_result_free(&scenes[i]);
    }
}

TEST(turned_scenes_measure_the_same)
{
    for (int k = 0; k < 5; ++k) {
        float angle = 37 * (float)(k + 1);
        sr_vec3 axis = {1, -2, (float)k - 1.5f};
        struct sr_transform turn = sr_transform_rotate(angle, axis);
        char before[100];
        snprintf(before, sizeof before, "Rotate %.9g %.9g %.9g %.9g", (double)angle, (double)axis.x, (double)axis.y,
                 (double)axis.z);
        struct reading r = measure_by(by_quadrature, before, square, (double[3]){0, 0, 0},
                                      sr_transform_normal(&turn, (sr_vec3){0, 0, 1}), 1);
        EXPECT_RELATIVE(r.E, 0.752274688454, 1e-5);
    }
}

/* Seven lamps of all sizes and kinds, some hidden. */
static const char lamps[] =
    "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" 3\nTranslate 1 0 1\nShape \"sphere\" \"float radius\" 0.01\nTranslate -2 0.5 0\n"
    "Shape \"sphere\" \"float radius\" 0.2\nTranslate 0 -2 0\nShape \"disk\" \"float radius\" 0.3\nTranslate 1 0 -0.5\nShape \"cylinder\" \"float radius\" 0.1\n"
    "Shape \"trianglemesh\" \"integer indices\" [0 2 1 0 3 2] \"point3 P\" [-0.5 -0.5 1  0.5 -0.5 1  0.5 0.5 1  -0.5 0.5 1]\nAttributeEnd\n"
    "LightSource \"infinite\" \"float scale\" 0.3\nMaterial \"conductor\" \"float roughness\" 0.3\n"
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-2 -2 -0.2  2 -2 -0.2  2 2 -0.2  -2 2 -0.2]\n"
    "Material \"dielectric\"\nTranslate 0.3 0.2 0.4\nShape \"sphere\" \"float radius\" 0.2\n";

TEST(scenes_of_any_size_measure_the_same)
{
    static const char *const all[] = {furnace, square, meshes, lamps};
    uint32_t samples = is_slow_build() ? 256 : 4096;
    for (int i = 0; i < 4; ++i) {
        struct reading here = measure("", all[i], (double[3]){0, 0, 0}, (sr_vec3){0, 0, 1}, samples);
        // by powers of two nearly to the last bit: the places of meters are known to a micrometre at best, lamps told
        // apart to a nanometre
        double largest = 0;
        for (int k = -20; k <= 20; k += 10) {
            char before[100];
            snprintf(before, sizeof before, "Scale %.17g %.17g %.17g", exp2(k), exp2(k), exp2(k));
            double E = measure(before, all[i], (double[3]){0, 0, 0}, (sr_vec3){0, 0, 1}, samples).E;
            EXPECT_RELATIVE(E, here.E, 1e-5);
            largest = fmax(largest, fabs(E / here.E - 1));
        }
        fprintf(stderr, "  scene %d: changes of E with its size up to %.1e\n", i, largest);
        EXPECT_RELATIVE(measure("Scale 1000 1000 1000", all[i], (double[3]){0, 0, 0}, (sr_vec3){0, 0, 1}, samples).E,
                        here.E, 1e-3);
    }
}

static struct sr_film *picture_of(const char *integrator, double brightness, struct sr_import_result *scene)
{
    char text[4096];
    int n = snprintf(
        text, sizeof text,
        "LookAt 0.5 -3 1  0 0 0.3  0 0 1\nCamera \"perspective\" \"float fov\" 50\nSampler \"sobol\" \"integer pixelsamples\" 16\n"
        "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24\nIntegrator \"%s\" \"integer maxdepth\" 20\nWorldBegin\n",
        integrator);
    snprintf(
        text + n, sizeof text - (size_t)n,
        "AttributeBegin\nAreaLightSource \"diffuse\" \"float scale\" %.9g\nTranslate 0.5 0 1\nShape \"sphere\" \"float radius\" 0.1\n"
        "Shape \"disk\" \"float radius\" 0.3\nAttributeEnd\nLightSource \"infinite\" \"float scale\" %.9g\nLightSource \"point\" \"point3 from\" [1 -1 1] \"float scale\" %.9g\n"
        "Material \"diffuse\" \"rgb reflectance\" [0.7 0.5 0.2]\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-2 -2 -0.2  2 -2 -0.2  2 2 -0.2  -2 2 -0.2]\n"
        "Material \"conductor\" \"float roughness\" 0.2\nShape \"sphere\" \"float radius\" 0.3\nMaterial \"dielectric\"\nTranslate 0.6 -0.6 0.2\nShape \"sphere\" \"float radius\" 0.2\n",
        3 * brightness, 0.1 * brightness, brightness);
    struct sr_error error = {0};
    if (!import_scene(scene_file("lights.pbrt", text), NULL, scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(scene);
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    EXPECT_EQUAL_INT(report.dropped, 0);
    return film;
}

/* The lights times a power of two: the picture times the same, to the last bit, sums of splats too. */
TEST(pictures_are_linear_in_the_lights)
{
    static const char *const integrators[] = {"path", "volpath", "bdpt", "lightpath"};
    for (int i = 0; i < 4; ++i) {
        struct sr_import_result scene, bright_scene;
        struct sr_film *film = picture_of(integrators[i], 1, &scene);
        double light = 0;
        for (int k = -30; k <= 30; k += 20) {
            struct sr_film *bright = picture_of(integrators[i], exp2(k), &bright_scene);
            for (size_t p = 0; p < 24 * 24; ++p)
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(bright->pixels[p].sum[c], ldexp(film->pixels[p].sum[c], k), 0);
                    EXPECT_NEAR(bright->pixels[p].square[c], ldexp(film->pixels[p].square[c], 2 * k), 0);
                    light += film->pixels[p].sum[c];
                    if (film->splats) {
                        double splats = sr_film_splat_mean(film, p, c);
                        EXPECT_NEAR(ldexp(sr_film_splat_mean(bright, p, c), -k), splats, 0);
                        light += fabs(splats);
                    }
                }
            sr_film_destroy(bright);
            sr_import_result_free(&bright_scene);
        }
        EXPECT(light > 0);
        sr_film_destroy(film);
        sr_import_result_free(&scene);
    }
}
