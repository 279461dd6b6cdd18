/* SPDX-License-Identifier: MIT */
/* Light tracing and bidirectional path tracing against path tracing, which shares neither their densities nor their
 * weights: pictures of small scenes, in quarters, by channel. Each picture is 16 independent replicates; |z| < 4.9 in
 * every quarter, pooled chi-square p > 1e-6. Goal: relative standard errors of 1 %, which STERADIAN_TEST_EFFORT=n
 * lessens by sqrt(n). */
#include "agree/render_helper.h"

enum { SIDE = 16, REPLICATES = 16, QUARTERS = 4 };

struct means {
    struct sr_film_mean of[QUARTERS][3];
};

static double effort(void)
{
    const char *text = getenv("STERADIAN_TEST_EFFORT");
    double n = text ? atof(text) : 1;
    return n > 0 ? n : 1;
}

static struct means render_by(const char *path, const char *integrator, uint32_t spp, uint32_t seed)
{
    struct sr_import_options options = {.integrator = integrator, .width = SIDE, .height = SIDE};
    struct sr_import_result scene;
    struct sr_error error = {0};
    if (!import_scene(path, &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.replicates = REPLICATES;
    job.spp = REPLICATES * (uint32_t)ceil(spp * effort() / REPLICATES);
    job.seed = seed;
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    EXPECT_EQUAL_INT(report.dropped, 0);
    struct means m;
    for (uint32_t q = 0; q < QUARTERS; ++q)
        for (int c = 0; c < 3; ++c) {
            double w[3] = {0, 0, 0};
            w[c] = 1;
            uint32_t x = q % 2 * (SIDE / 2), y = q / 2 * (SIDE / 2);
            m.of[q][c] = sr_film_region_mean(film, x, y, x + SIDE / 2, y + SIDE / 2, w);
        }
    sr_film_destroy(film);
    sr_import_result_free(&scene);
    return m;
}

static void compare(const char *name, const char *by, const char *with, const struct means *a, const struct means *b)
{
    double chi2 = 0, worst = 0, relative = 0, mean_a = 0, mean_b = 0;
    int n = 0;
    for (int q = 0; q < QUARTERS; ++q)
        for (int c = 0; c < 3; ++c) {
            const struct sr_film_mean *x = &a->of[q][c], *y = &b->of[q][c];
            double vx = x->standard_error * x->standard_error, vy = y->standard_error * y->standard_error, v = vx + vy;
            mean_a += x->mean;
            mean_b += y->mean;
            if (!(v > 0)) {
                EXPECT_NEAR(x->mean, y->mean, 1e-5 * fabs(y->mean));
                continue;
            }
            double degrees = v * v / (vx * vx / x->degrees + vy * vy / y->degrees), t = (x->mean - y->mean) / sqrt(v);
            double p = sr_student_p_two_sided(t, degrees), z = p > 0 ? fabs(sr_normal_quantile(fmin(p / 2, 0.5))) : 40;
            chi2 += z * z / 3; // a quarter's channels go together
            ++n;
            worst = fmax(worst, z);
            relative = fmax(relative, sqrt(v) / fabs(y->mean));
        }
    double p = n ? sr_chi2_p(chi2, QUARTERS) : 1;
    printf("  %-28s %-9s / %-9s %.5f  worst |z| %.2f  p %.3g  relative error to %.2g %%\n", name, by, with,
           mean_a / mean_b, worst, p, 100 * relative);
    EXPECT(worst < 4.9 && p > 1e-6);
}

#define HEAD "LookAt 0 0 -3.4  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 40 "
#define FILM                                                                                                           \
    "PixelFilter \"box\" Film \"rgb\" \"string filename\" \"a.exr\" Integrator \"path\" \"integer maxdepth\" 5 WorldBegin\n"
#define WHITE "Material \"diffuse\" \"rgb reflectance\" [.7 .7 .7]\n"
#define FLOOR "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 -1  1 -1 -1  -1 -1 1  1 -1 1]\n"
#define BACK "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 1  1 -1 1  -1 1 1  1 1 1]\n"
#define ROOM                                                                                                                             \
    WHITE FLOOR BACK                                                                                                                     \
        "Shape \"bilinearmesh\" \"point3 P\" [-1 1 -1  1 1 -1  -1 1 1  1 1 1]\n"                                                         \
        "Material \"diffuse\" \"rgb reflectance\" [.7 .1 .1] Shape \"bilinearmesh\" \"point3 P\" [-1 -1 -1  -1 -1 1  -1 1 -1  -1 1 1]\n" \
        "Material \"diffuse\" \"rgb reflectance\" [.1 .7 .1] Shape \"bilinearmesh\" \"point3 P\" [1 -1 -1  1 -1 1  1 1 -1  1 1 1]\n"
#define LAMP                                                                                                           \
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [15 15 15] Material \"diffuse\" \"float reflectance\" 0\n"   \
    "Shape \"bilinearmesh\" \"point3 P\" [-.3 .9 -.3  .3 .9 -.3  -.3 .9 .3  .3 .9 .3] AttributeEnd\n"
#define BALL(x, y, z, r)                                                                                               \
    "AttributeBegin Translate " x " " y " " z " Shape \"sphere\" \"float radius\" " r " AttributeEnd\n"

static const struct {
    const char *name, *text;
    uint32_t path_spp, bdpt_spp, light_spp; // 0: cannot see it all
} scenes[] = {
    {"a room", HEAD FILM ROOM LAMP, 256, 64, 256},
    {"glossy metal",
     HEAD FILM ROOM LAMP "Material \"conductor\" \"float roughness\" .3\n" BALL("-.3", "-.5", ".2", ".5"), 256, 64,
     256},
    {"a point light", HEAD FILM ROOM "LightSource \"point\" \"point3 from\" [.2 .3 -.4] \"float power\" 40\n", 256, 64,
     256},
    {"a spot light",
     HEAD FILM ROOM
     "LightSource \"spot\" \"point3 from\" [0 .9 -.5] \"point3 to\" [-.6 -1 .8] \"float power\" 40 \"float coneangle\" 40 \"float conedeltaangle\" 25\n",
     256, 64, 256},
    {"a distant light",
     HEAD FILM WHITE FLOOR BACK BALL(
         "0", "-.4", "0",
         ".6") "LightSource \"distant\" \"point3 from\" [1 2 -2] \"point3 to\" [0 0 0] \"float illuminance\" 3\n",
     128, 64, 512},
    {"a uniform sky",
     HEAD FILM WHITE FLOOR BACK BALL("0", "-.4", "0", ".6") "LightSource \"infinite\" \"float scale\" 1\n", 128, 64,
     512},
    {"lamp and sky and spot",
     HEAD FILM WHITE FLOOR BACK LAMP BALL(
         "0", "-.4", "0",
         ".6") "LightSource \"infinite\" \"float scale\" .5\n"
               "LightSource \"spot\" \"point3 from\" [-.9 .9 -.9] \"point3 to\" [0 -1 0] \"float power\" 20\n",
     128, 64, 512},
    {"a lamp of two sides",
     HEAD FILM ROOM
     "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [4 8 4] \"bool twosided\" true Rotate 30 1 0 0 Shape \"disk\" \"float radius\" .3 AttributeEnd\n",
     256, 64, 256},
    {"a ball and a tube that glow",
     HEAD FILM ROOM "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [3 3 3]\n" BALL(
         "-.5", ".4", ".2",
         ".2") "Translate .5 .2 0 Rotate 60 1 1 0 Scale 1 1 1.5 Shape \"cylinder\" \"float radius\" .1 \"float zmin\" -.3 \"float zmax\" .3 AttributeEnd\n",
     256, 64, 256},
    {"a thin lens",
     "LookAt 0 0 -3.4  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 40 \"float lensradius\" .2 \"float focaldistance\" 3\n" FILM
         ROOM LAMP BALL("-.3", "-.5", ".2", ".5"),
     256, 64, 256},
    {"parallel rays",
     "LookAt 0 0 -3.4  0 0 0  0 1 0 Camera \"orthographic\" \"float screenwindow\" [-1 1 -1 1] \"float lensradius\" .1 \"float focaldistance\" 3\n" FILM
         ROOM LAMP BALL("-.3", "-.5", ".2", ".5"),
     256, 64, 256},
    {"all around",
     "LookAt 0 0 -.5  0 0 0  0 1 0 Camera \"spherical\" \"string mapping\" \"equalarea\"\n" FILM ROOM LAMP BALL(
         "-.3", "-.5", ".4", ".4"),
     256, 64, 256},
    {"all around by angles",
     "LookAt 0 0 -.5  0 0 0  0 1 0 Camera \"spherical\" \"string mapping\" \"equirectangular\"\n" FILM ROOM LAMP BALL(
         "-.3", "-.5", ".4", ".4"),
     256, 64, 256},
    {"a wide filter with lobes",
     HEAD
     "PixelFilter \"mitchell\" Film \"rgb\" \"string filename\" \"a.exr\" Integrator \"path\" \"integer maxdepth\" 3 WorldBegin\n" ROOM
         LAMP,
     256, 64, 256},
    {"instances",
     HEAD FILM ROOM LAMP "ObjectBegin \"b\" Material \"diffuse\" \"rgb reflectance\" [.2 .5 .8]\n" BALL(
         "0", "0", "0",
         ".4") "ObjectEnd\n"
               "AttributeBegin Translate -.4 -.5 .3 Scale 1 .5 1 ObjectInstance \"b\" AttributeEnd AttributeBegin Translate .5 .1 .2 Scale .5 .5 .5 ObjectInstance \"b\" AttributeEnd\n",
     256, 64, 256},
    {"smooth normals",
     HEAD FILM ROOM LAMP WHITE
     "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-.5 -.6 -.2  .5 -.6 -.2  .4 .4 .4  -.6 .4 .4]\n"
     "\"normal N\" [-.6 -.2 -.8  .6 -.2 -.8  .5 .7 -.5  -.5 .7 -.5]\n",
     256, 64, 256},
    {"leaves",
     HEAD FILM ROOM LAMP
     "Material \"diffusetransmission\" \"rgb reflectance\" [.2 .3 .1] \"rgb transmittance\" [.3 .5 .2]\n"
     "Shape \"bilinearmesh\" \"point3 P\" [-.6 -.2 -.4  .6 -.2 -.4  -.6 .3 .4  .6 .3 .4]\n",
     256, 64, 256},
    {"frosted glass",
     HEAD FILM ROOM LAMP
     "Material \"dielectric\" \"float roughness\" .4 \"float eta\" 1.5\n" BALL("-.2", "-.4", ".1", ".5"),
     512, 128, 512},
    {"a mirror, by both ends",
     HEAD FILM ROOM LAMP "Material \"conductor\" \"float roughness\" 0\n" BALL("-.3", "-.5", ".2", ".5"), 512, 128, 0},
    {"glass that disperses",
     HEAD FILM ROOM "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [2 2 2]\n" BALL(
         "0", ".5", "0", ".4") "AttributeEnd\n"
                               "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"\n" BALL("-.3", "-.5", "0",
                                                                                                ".45"),
     1024, 256, 0},
    {"varnish",
     HEAD FILM ROOM LAMP "Material \"coateddiffuse\" \"rgb reflectance\" [.6 .3 .2] \"float roughness\" .3\n" BALL(
         "-.3", "-.5", ".2", ".5"),
     256, 64, 256},
    {"glow behind an interface",
     HEAD FILM ROOM LAMP "AttributeBegin Material \"interface\" AreaLightSource \"diffuse\" \"rgb L\" [1 2 3]\n" BALL(
         "-.3", "-.3", ".2", ".3") "AttributeEnd\n",
     256, 64, 256},
    {"things that move",
     HEAD FILM ROOM LAMP "AttributeBegin ActiveTransform EndTime Translate .8 .7 0 ActiveTransform All\n" BALL(
         "-.5", "-.5", ".1",
         ".4") "AttributeEnd\n"
               "ObjectBegin \"b\" Material \"diffuse\" \"rgb reflectance\" [.2 .5 .8]\n" BALL(
                   "0", "0", "0",
                   ".3") "ObjectEnd\n"
                         "AttributeBegin Translate .5 -.4 .2 ActiveTransform EndTime Rotate 90 0 0 1 Translate .1 .3 0 Scale 1 2 1 ActiveTransform All ObjectInstance \"b\" AttributeEnd\n",
     512, 128, 512},
    {"a camera that moves",
     "LookAt 0 0 -3.4  0 0 0  0 1 0 ActiveTransform EndTime Rotate 25 .2 1 .3 Translate .4 .3 .5 Scale .8 1.4 1.1 ActiveTransform All\n"
     "Camera \"perspective\" \"float fov\" 40 \"float lensradius\" .1 \"float focaldistance\" 3\n" FILM ROOM LAMP
     "ActiveTransform EndTime Translate .5 .5 0 ActiveTransform All\n" BALL("-.3", "-.5", ".2", ".5"),
     512, 128, 512},
    {"a camera that moves and sees all around",
     "LookAt 0 0 -.5  0 0 0  0 1 0 ActiveTransform EndTime Rotate 60 .2 1 .3 Translate .2 .3 .1 Scale .8 1.4 1.1 ActiveTransform All\n"
     "Camera \"spherical\" \"string mapping\" \"equirectangular\"\n" FILM ROOM LAMP BALL("-.3", "-.5", ".4", ".4"),
     256, 64, 256},
};

TEST(paths_from_both_ends_bring_the_same_light)
{
    const char *only = getenv("STERADIAN_TEST_ROWS");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; ++i) {
        if (only && !strstr(scenes[i].name, only))
            continue;
        const char *path = scene_file("adjoint.pbrt", scenes[i].text);
        struct means by_path = render_by(path, "path", scenes[i].path_spp, 1);
        struct means by_both = render_by(path, "bdpt", scenes[i].bdpt_spp, 2);
        compare(scenes[i].name, "bdpt", "path", &by_both, &by_path);
        if (scenes[i].light_spp) {
            struct means by_light = render_by(path, "lightpath", scenes[i].light_spp, 3);
            compare(scenes[i].name, "lightpath", "path", &by_light, &by_path);
        }
    }
}

/* A point light through a clear ball: no path from a sensor meets either. The ball is out of sight, as paths from the
 * lights do not see it. */
TEST(paths_from_both_ends_bring_the_same_caustic)
{
    const char *path = scene_file(
        "caustic.pbrt",
        "LookAt 0 -.9 -1.5  0 -1 1  0 1 0 Camera \"perspective\" \"float fov\" 30 " FILM WHITE FLOOR BACK
        "LightSource \"point\" \"point3 from\" [.1 1.2 .2] \"float power\" 40 Material \"dielectric\" \"float eta\" 1.5\n" BALL(
            "0", "0", ".3", ".35"));
    struct means by_both = render_by(path, "bdpt", 256, 2), by_light = render_by(path, "lightpath", 512, 3),
                 by_path = render_by(path, "path", 64, 1);
    compare("a caustic of a point light", "bdpt", "lightpath", &by_both, &by_light);
    double seen = 0, missed = 0;
    for (int q = 0; q < QUARTERS; ++q) {
        seen += by_both.of[q][1].mean;
        missed += by_path.of[q][1].mean;
    }
    printf("  path sees %.3f of it\n", missed / seen);
    EXPECT(missed < 0.95 * seen); // or there is no caustic in the picture
}

/* The scene for which bidirectional path tracing was shown first; pbrt's picture has standard errors of its own. */
TEST(bidirectional_paths_agree_with_the_reference_of_veach_s_room)
{
    const char *path = test_reference_file("scenes/veach-bidir/scene-v4.ref.pbrt");
    static const double mean[3] = {0.38358382, 0.35001176, 0.326257},
                        error_of_mean[3] = {0.00163, 0.000927, 0.000403}; // pbrt-v4, 256 samples
    struct sr_import_options options = {.integrator = "bdpt"};
    struct sr_import_result scene;
    struct sr_error error = {0};
    if (!import_scene(path, &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.spp = job.replicates = 4;
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    for (int c = 0; c < 3; ++c) {
        double w[3] = {0, 0, 0};
        w[c] = 1;
        struct sr_film_mean m = sr_film_region_mean(film, 0, 0, film->width, film->height, w);
        double u = hypot(m.standard_error, error_of_mean[c]);
        printf("  %c: %.5f +- %.5f, reference %.5f +- %.5f, t %.2f\n", "RGB"[c], m.mean, m.standard_error, mean[c],
               error_of_mean[c], (m.mean - mean[c]) / u);
        EXPECT(sr_student_p_two_sided((m.mean - mean[c]) / u, fmax(3, m.degrees)) > 1e-6);
        EXPECT(m.standard_error < 0.01 * m.mean);
    }
    sr_film_destroy(film);
    sr_import_result_free(&scene);
}
