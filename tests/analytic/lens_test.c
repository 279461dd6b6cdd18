/* SPDX-License-Identifier: MIT */
/* Cameras with lenses of real surfaces: focal length by the lensmaker's equation, sharpness, magnification, and what
 * arrives on the film, by closed forms.
 *
 *     1/f = (n - 1) [1/R1 - 1/R2 + (n - 1) d / (n R1 R2)]
 *
 * A stop as the last surface is its own exit pupil: a disk of the field's radiance, whatever lens is before it. */
#include "analytic/analytic.h"

static const double luminance[3] = {0, 1, 0};
static const double n_glass = 1.5, R1_mm = 60, R2_mm = -60, d_mm = 6;

static const char *write_file(const char *name, const char *text)
{
    static char path[512];
    struct sr_error error = {0};
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    if (sr_file_write(path, text, strlen(text), &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return path;
}

static double focal_length_mm(void)
{
    return 1 / ((n_glass - 1) * (1 / R1_mm - 1 / R2_mm + (n_glass - 1) * d_mm / (n_glass * R1_mm * R2_mm)));
}

/* A biconvex lens, and 10 mm behind it a stop of 20 mm. */
static const char singlet[] =
    "# radius thickness index diameter [mm]\n60 6 1.5 50\n-60 10 0 50 # towards the stop\n0 50 0 20\n";

static struct world camera(const char *lens, const char *more, int size, const char *content)
{
    write_file("lens.dat", lens);
    return world_of(
        "Camera \"realistic\" \"string lensfile\" \"lens.dat\" %s\nIntegrator \"path\" \"integer maxdepth\" 0\n"
        "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d \"float diagonal\" 10\nPixelFilter \"box\"\nWorldBegin\n%s",
        more, size, size, content);
}

/* Mean place where rays from a point of the film (raster) cross z = distance, and the root mean square about it [m]. */
static void cross_at(const struct world *w, sr_vec2 raster, double distance, double mean[2], double *spread)
{
    double sum[2] = {0}, square = 0;
    int n = 0;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
            struct sr_sensor_ray r;
            sr_vec2 u = {((float)i + 0.5f) / 64, ((float)j + 0.5f) / 64};
            if (!w->job.sensor.model->ray(w->job.sensor.self, raster, u, 0, &r))
                continue;
            double t = (distance - (double)r.ray.o.z) / (double)r.ray.d.z,
                   x = (double)r.ray.o.x + t * (double)r.ray.d.x, y = (double)r.ray.o.y + t * (double)r.ray.d.y;
            sum[0] += x, sum[1] += y, square += x * x + y * y, ++n;
        }
    EXPECT(n > 1000);
    mean[0] = sum[0] / n, mean[1] = sum[1] / n;
    *spread = sqrt(fmax(0, square / n - mean[0] * mean[0] - mean[1] * mean[1]));
}

TEST(a_lens_is_sharp_where_it_is_focused)
{
    static const double distance = 2;
    struct world w = camera(singlet, "\"float focusdistance\" 2 \"float aperturediameter\" 2", 100, "");
    double at[2], near[2], far[2], spread, spread_near, spread_far;
    cross_at(&w, (sr_vec2){50, 50}, distance, at, &spread);
    cross_at(&w, (sr_vec2){50, 50}, 0.9 * distance, near, &spread_near);
    cross_at(&w, (sr_vec2){50, 50}, 1.1 * distance, far, &spread_far);
    // u + s = D + (between the principal planes), f by the lensmaker; the planes of a lens in air, from its vertices
    double f = focal_length_mm(), inset1 = f * (n_glass - 1) * d_mm / (n_glass * -R2_mm),
           inset2 = f * (n_glass - 1) * d_mm / (n_glass * R1_mm);
    double K = 1e3 * distance - (d_mm - inset1 - inset2), u = 0.5 * (K - sqrt(K * (K - 4 * f))),
           magnification = (K - u) / u;
    printf("  f %.4f mm, magnification %.4f; spread at focus %.3g m, 10 %% off %.3g and %.3g m\n", f, magnification,
           spread, spread_near, spread_far);
    EXPECT(spread < 0.2 * spread_near &&
           spread < 0.2 * spread_far); // a simple lens is not sharp for want of Gauss, but of Seidel
    EXPECT_NEAR(at[0], 0, 1e-5);
    // a point of the film 10 pixels off the axis: 10 mm are the diagonal of 100 x 100
    double pixel = 10e-3 / hypot(100, 100), right[2], up[2];
    cross_at(&w, (sr_vec2){60, 50}, distance, right, &spread);
    cross_at(&w, (sr_vec2){50, 40}, distance, up, &spread);
    EXPECT_RELATIVE(right[0], 10 * pixel * magnification, 2e-3); // third-order distortion
    EXPECT_RELATIVE(up[1], 10 * pixel * magnification, 2e-3);
    EXPECT_NEAR(right[1], 0, 1e-5);
    world_free(&w);
}

/* E / L of a disk of radius a at height z over a plane, r off its axis: the form factor of a disk to a parallel
 * element. */
static double disk(double a, double z, double r)
{
    double b = z * z + a * a + r * r;
    return (double)SR_PI / 2 * (1 - (z * z + r * r - a * a) / sqrt(b * b - 4 * r * r * a * a));
}

TEST(the_film_gets_what_the_exit_pupil_sends)
{
    // focus moves the lens and its stop: the rear plane's distance is read from a ray on the axis
    double f = focal_length_mm(), inset1 = f * (n_glass - 1) * d_mm / (n_glass * -R2_mm),
           inset2 = f * (n_glass - 1) * d_mm / (n_glass * R1_mm);
    double K = 1e6 - (d_mm - inset1 - inset2), u = 0.5 * (K - sqrt(K * (K - 4 * f))),
           z = u - inset2 - 10; // from the rear principal plane to the stop
    static const double diameters[] = {20, 8, 2};
    for (int i = 0; i < 3; ++i) {
        char more[128];
        snprintf(more, sizeof more, "\"float focusdistance\" 1000 \"float aperturediameter\" %g", diameters[i]);
        struct world w = camera(singlet, more, 101, "LightSource \"infinite\" \"float scale\" 1\n");
        for (int x = 50; x <= 100; x += 50) {
            double r = (x - 50) * 10 / hypot(101, 101), expected = disk(diameters[i] / 2, z, r);
            struct estimate e = pixel_mean(&w.job, (uint32_t)x, 50, 4096, luminance);
            printf("  f/%-5.2f %2d pixels off: %.6g, ours %.6g +- %.2g, pi / (4 N^2 + 1) %.6g\n", z / diameters[i],
                   x - 50, expected, e.mean, e.error, (double)SR_PI / (4 * z * z / diameters[i] / diameters[i] + 1));
            EXPECT(fabs(z_of(e, expected)) < 4.9 || fabs(e.mean / expected - 1) < 1e-5);
            EXPECT(is_slow_build() || e.error < 2e-3 * e.mean);
        }
        world_free(&w);
    }
}

TEST(apertures_of_all_shapes_let_as_much_through)
{
    static const char *const shapes[] = {"", "gaussian", "square", "pentagon", "star"};
    double round = 0;
    for (int i = 0; i < 5; ++i) {
        char more[128];
        snprintf(more, sizeof more,
                 "\"float focusdistance\" 1000 \"float aperturediameter\" 6 \"string aperture\" \"%s\"", shapes[i]);
        struct world w = camera(singlet, more, 101, "LightSource \"infinite\" \"float scale\" 1\n");
        struct estimate e = pixel_mean(&w.job, 50, 50, 4096, luminance);
        round = i ? round : e.mean;
        printf("  %-9s %.6g +- %.2g\n", shapes[i], e.mean, e.error);
        EXPECT_RELATIVE(e.mean, round, 4.9 * e.error / e.mean + 5e-3); // cos^4 differs over the pupil
        world_free(&w);
    }
}

/* Vignetting: an exit pupil in many lenses' own shapes must lie in the bounds from which it is drawn. Six surfaces
 * about a stop. */
TEST(exit_pupils_are_drawn_whole)
{
    struct world w = camera(
        "38.2 6.2 1.67 50\n95.3 0.5 0 48\n27.1 9.5 1.69 40\n1e4 3.5 1.6 34\n18.0 7.5 0 28\n0 8.5 0 20\n-20.4 3.2 1.61 28\n1e4 9.2 1.69 36\n-31.2 0.4 0 36\n"
        "150 5.8 1.72 40\n-58.1 42 0 40\n",
        "\"float focusdistance\" 5 \"float aperturediameter\" 14", 64, "LightSource \"infinite\" \"float scale\" 1\n");
    for (int x = 32; x < 64; x += 31) {
        // shares of rays that get through near the rectangle's borders: none, or the pupil is cut
        int border = 0, inside = 0;
        for (int i = 0; i < 4000; ++i) {
            float v = ((float)i + 0.5f) / 4000, edge = 0.004f * (float)(i % 4) / 4;
            sr_vec2 u[4] = {{edge, v}, {1 - edge, v}, {v, edge}, {v, 1 - edge}};
            struct sr_sensor_ray r;
            for (int k = 0; k < 4; ++k)
                border += w.job.sensor.model->ray(w.job.sensor.self, (sr_vec2){(float)x, 10}, u[k], 0, &r);
            inside += w.job.sensor.model->ray(w.job.sensor.self, (sr_vec2){(float)x, 10},
                                              (sr_vec2){0.3f + 0.4f * v, 0.5f}, 0, &r);
        }
        EXPECT_EQUAL_INT(border, 0);
        EXPECT(inside > 2000);
    }
    world_free(&w);
}

static void expect_refusal(const char *lens, const char *more, const char *told)
{
    char path[512], text[1024];
    struct sr_import_options options = {0};
    struct sr_import_result scene;
    struct sr_log silent = {0};
    struct sr_error error = {0};
    write_file("bad.dat", lens);
    snprintf(text, sizeof text, "Camera \"realistic\" \"string lensfile\" \"bad.dat\" %s\nWorldBegin\n", more);
    snprintf(path, sizeof path, "%s", write_file("bad.pbrt", text));
    EXPECT(sr_import_pbrt(path, &options, &scene, &silent, &error) != SR_OK);
    if (!strstr(error.text, told) || !strstr(error.text, "bad.pbrt:1:"))
        test_fail(__FILE__, __LINE__, "told: %s\nexpected: %s", error.text, told);
}

TEST(lenses_that_are_none_are_refused)
{
    expect_refusal("", "", "0 numbers: expected four");
    expect_refusal("1 2 3", "", "3 numbers: expected four");
    expect_refusal("60 6 1.5 50\n-60 ten 0 50", "", "bad.dat:2: expected a number");
    expect_refusal("60 6 1.5 50\n-60 1e999 0 50", "", "bad.dat:2: expected a number");
    expect_refusal("60 6 0.5 50\n-60 50 0 50", "", "surface 1 is 60 6 0.5 50");
    expect_refusal("60 6 1.5 50\n-60 50 0 -1", "", "surface 2 is");
    expect_refusal("60 -6 1.5 50\n-60 50 0 50", "", "surface 1 is");
    expect_refusal("60 6 1.5 50\n-60 50 0 50", "\"float focusdistance\" 0.1",
                   "focusdistance 0.1 m is too short for a lens of the focal length 61.02 mm");
    expect_refusal("-60 6 1.5 50\n60 50 0 50", "", "too short"); // it spreads light
    expect_refusal("60 6 1.5 50\n-60 50 0 50", "\"float aperturediameter\" 0", "aperturediameter");
    expect_refusal("60 6 1.5 50\n-60 50 0 50", "\"string aperture\" \"no-such-image.png\"", "no-such-image.png");
    expect_refusal(singlet, "\"string aperture\" 5", "");
}

/* Nobody knows which ray of the lens meets a point: light paths alone make no picture, both ends together do without
 * that. */
TEST(light_is_traced_to_a_lens_or_it_is_refused)
{
    static const char content[] =
        "LightSource \"point\" \"point3 from\" [.3 .5 1]\nTranslate 0 0 3 Material \"diffuse\" Shape \"sphere\" \"float radius\" .7\n";
    struct world w = camera(singlet, "\"float aperturediameter\" 20 \"float focusdistance\" 3", 5, content);
    struct estimate by[2];
    static const char *const names[] = {"path", "bdpt"};
    for (int i = 0; i < 2; ++i) {
        struct sr_error error = {0};
        char text[64];
        snprintf(text, sizeof text, "%s,maxdepth=2", names[i]);
        EXPECT(sr_integrator_parse(text, NULL, sr_scene_arena(w.scene.scene), &w.job.integrator, &error) == SR_OK);
        by[i] = pixel_mean(&w.job, 2, 2, 2048, luminance);
        printf("  %s %.6g +- %.2g\n", names[i], by[i].mean, by[i].error);
    }
    EXPECT(by[0].mean > 0 && fabs(by[0].mean - by[1].mean) < 5 * hypot(by[0].error, by[1].error));
    struct sr_film *film;
    struct sr_render_report report;
    struct sr_error error = {0};
    EXPECT(sr_integrator_parse("lightpath", NULL, sr_scene_arena(w.scene.scene), &w.job.integrator, &error) == SR_OK);
    EXPECT(sr_render(&w.job, &film, &report, &error) != SR_OK && strstr(error.text, "the sensor realistic cannot say"));
    world_free(&w);
}
