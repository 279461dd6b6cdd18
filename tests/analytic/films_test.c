/* SPDX-License-Identifier: MIT */
/* Films that keep more than colours: spectra in buckets, what is seen first, and its variance. */
#include "analytic/analytic.h"

static struct sr_image *picture(struct world *w, struct sr_film **film)
{
    struct sr_render_report report;
    struct sr_error error = {0};
    struct sr_image *image;
    w->job.spp = samples(w->job.spp);
    if (sr_render(&w->job, film, &report, &error) != SR_OK ||
        sr_render_image(*film, true, false, &image, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return image;
}

static double channel(const struct sr_image *image, const char *name, uint32_t x, uint32_t y)
{
    int c = sr_image_find_channel(image, name);
    if (c < 0)
        test_fail(__FILE__, __LINE__, "there is no channel %s", name);
    return (double)image->floats[sr_image_index(image, x, y) + (size_t)c];
}

/* A lamp of the spectrum 1 + (lambda - 500) / 400 in W m^-2 sr^-1 nm^-1, straight on: each bucket has its mean,
 * whatever the wavelengths' chance; through glass that disperses, too, where seven of eight wavelengths end on the way.
 */
static void buckets(bool is_dispersed)
{
    struct world w = world_of(
        "Option \"string units\" \"si\"\nLookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 10\nIntegrator \"path\" \"integer maxdepth\" 20\n"
        "Sampler \"zsobol\" \"integer pixelsamples\" 4096\nPixelFilter \"box\"\n"
        "Film \"spectral\" \"integer xresolution\" 2 \"integer yresolution\" 2 \"integer nbuckets\" 5 \"float lambdamin\" 400 \"float lambdamax\" 700\nWorldBegin\n"
        "LightSource \"infinite\" \"spectrum L\" [360 0.65 830 1.825]\n%s",
        is_dispersed ? "Material \"dielectric\" \"spectrum eta\" \"glass-SF11\" Shape \"sphere\" \"float radius\" 2\n"
                     : "");
    struct sr_film *film;
    struct sr_image *image = picture(&w, &film);
    static const char *const names[] = {"S0.430,000nm", "S0.490,000nm", "S0.550,000nm", "S0.610,000nm", "S0.670,000nm"};
    for (int b = 0; b < 5; ++b) {
        double expected = (1 + (430 + 60 * b - 500) / 400.0), mean = 0;
        for (uint32_t k = 0; k < 4; ++k)
            mean += channel(image, names[b], k & 1, k >> 1) / 4;
        printf("  %s %s %.6g, ours %.6g\n", is_dispersed ? "through glass" : "a lamp", names[b], expected, mean);
        EXPECT_RELATIVE(mean, expected,
                        is_slow_build() ? 0.5
                        : is_dispersed  ? 1.5e-2
                                        : 2e-3); // a clear ball in a furnace is not seen
    }
    sr_image_free(image);
    sr_film_destroy(film);
    world_free(&w);
}

TEST(buckets_hold_the_mean_of_their_wavelengths)
{
    buckets(false);
    buckets(true);
}

/* The colours of a film of spectra are those of an ordinary one. */
TEST(spectral_films_have_the_same_colours)
{
    double mean[2][3];
    for (int i = 0; i < 2; ++i) {
        struct world w = world_of(
            "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 30\nIntegrator \"path\"\nSampler \"zsobol\" \"integer pixelsamples\" 1024\n"
            "Film \"%s\" \"integer xresolution\" 8 \"integer yresolution\" 8 \"float iso\" 200\nWorldBegin\nLightSource \"infinite\" \"blackbody L\" 4000\n"
            "Material \"diffuse\" \"rgb reflectance\" [.8 .3 .2] Shape \"sphere\"\n",
            i ? "spectral" : "rgb");
        struct sr_film *film;
        struct sr_image *image = picture(&w, &film);
        for (int c = 0; c < 3; ++c) {
            mean[i][c] = 0;
            for (uint32_t k = 0; k < 64; ++k)
                mean[i][c] += (double)image->floats[sr_image_index(image, k % 8, k / 8) + (size_t)c] / 64;
        }
        sr_image_free(image);
        sr_film_destroy(film);
        world_free(&w);
    }
    for (int c = 0; c < 3; ++c)
        EXPECT_RELATIVE(mean[1][c], mean[0][c], is_slow_build() ? 0.2 : 3e-3);
}

/* A plane 4 m before the camera that is turned by 30 degrees: its place, normal and slope in closed form, in both
 * spaces. */
static void gbuffer(const char *space)
{
    bool is_world = strcmp(space, "world") == 0;
    struct world w = world_of(
        "LookAt 1 2 3  1 2 10  0 1 0 Camera \"perspective\" \"float fov\" 2\nIntegrator \"path\" \"integer maxdepth\" 1\n"
        "Sampler \"zsobol\" \"integer pixelsamples\" 256\nPixelFilter \"box\"\n"
        "Film \"gbuffer\" \"integer xresolution\" 21 \"integer yresolution\" 21 \"string coordinatesystem\" \"%s\"\nWorldBegin\n"
        "LightSource \"infinite\" \"float scale\" 1\nMaterial \"diffuse\" \"spectrum reflectance\" [360 .4 830 .4]\n"
        "Translate 1 2 7 Rotate 30 0 1 0 Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0  1 -1 0  -1 1 0  1 1 0]\n",
        space);
    struct sr_film *film;
    struct sr_image *image = picture(&w, &film);
    double shift[3] = {is_world ? 1 : 0, is_world ? 2 : 0, is_world ? 3 : 0},
           pixel = 2 * tan(3.14159265358979323846 / 180) / 21;
    // z = 4 - tan(30 deg) x, as the plane turns its right side toward the camera; x = k z
    for (uint32_t x = 3; x < 21; x += 7) {
        double k = ((double)x - 10) * pixel, slope = -tan(30 * 3.14159265358979323846 / 180), z = 4 / (1 - slope * k);
        EXPECT_NEAR(channel(image, "P.X", x, 10), k * z + shift[0], 2e-4);
        EXPECT_NEAR(channel(image, "P.Y", x, 10), shift[1], 2e-4);
        EXPECT_NEAR(channel(image, "P.Z", x, 10), z + shift[2], 2e-4);
        EXPECT_NEAR(channel(image, "N.X", x, 10), -0.5, 1e-5);
        EXPECT_NEAR(channel(image, "N.Z", x, 10), -sqrt(0.75), 1e-5);
        EXPECT_NEAR(channel(image, "Ns.X", x, 10), -0.5, 1e-5);
        EXPECT_NEAR(channel(image, "Albedo.G", x, 10), 0.4, 1e-3);
        double dzdx = 4 * slope * pixel / pow(1 - slope * k, 2);
        EXPECT_RELATIVE(channel(image, "dzdx", x, 10), 0.125 * dzdx, is_slow_build() ? 3 : 1e-2);
        EXPECT_NEAR(channel(image, "dzdy", x, 10), 0, 1e-6); // of 5e-4 in x
        EXPECT(channel(image, "RelativeVariance.G", x, 10) >= 0 && channel(image, "Variance.R", x, 10) >= 0);
    }
    sr_image_free(image);
    sr_film_destroy(film);
    world_free(&w);
}

TEST(gbuffers_hold_the_first_surface)
{
    gbuffer("camera");
    gbuffer("world");
}

/* A plane, half of which shines: a pixel across the border has samples of 0 and L, whose variance is L^2 p (1 - p). */
TEST(variances_are_those_of_one_sample)
{
    struct world w = world_of(
        "Translate 0 0 3 Camera \"orthographic\"\nIntegrator \"path\" \"integer maxdepth\" 0\nSampler \"independent\" \"integer pixelsamples\" 16384\nPixelFilter \"box\"\n"
        "Film \"gbuffer\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\n"
        "Material \"diffuse\" Shape \"bilinearmesh\" \"point3 P\" [-2 -2 0  2 -2 0  -2 2 0  2 2 0]\n"
        "AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\" \"float scale\" 5 \"bool twosided\" true\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-2 -2 -1  -.5 -2 -1  -2 2 -1  -.5 2 -1]\n");
    struct sr_film *film;
    struct sr_image *image = picture(&w, &film);
    double mean = channel(image, "G", 0, 0), p = 0.25, L = mean / p, variance = channel(image, "Variance.G", 0, 0);
    printf("  mean %.4f (%.4f), variance %.4f (at least %.4f)\n", mean, 5 * p, variance, L * L * p * (1 - p));
    EXPECT_RELATIVE(mean, 5 * p, is_slow_build() ? 0.3 : 0.06);
    EXPECT_RELATIVE(channel(image, "RelativeVariance.G", 0, 0), variance / mean, 1e-3);
    // wavelengths vary, too: of each lit sample by v, and then p v more
    EXPECT(is_slow_build() || (variance > 0.95 * L * L * p * (1 - p) && variance < 1.3 * L * L * p * (1 - p)));
    sr_image_free(image);
    sr_film_destroy(film);
    world_free(&w);
}

/* Bytes of a film of spectra do not depend on who does the work, nor does it forget them where sampling adapts. */
TEST(spectra_do_not_depend_on_threads)
{
    double sum[4];
    for (int i = 0; i < 4; ++i) {
        struct world w = world_of(
            "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 30\nIntegrator \"path\"\nSampler \"zsobol\" \"integer pixelsamples\" 64\n"
            "Film \"spectral\" \"integer xresolution\" 20 \"integer yresolution\" 20 \"integer nbuckets\" 3\nWorldBegin\n"
            "LightSource \"infinite\" \"blackbody L\" 4000\nMaterial \"diffuse\" Shape \"sphere\"\n");
        w.job.threads = i + 1;
        w.job.tile = i == 1 ? 7 : 16;
        w.job.adaptive.is_on = i == 3;
        w.job.spp = 64;
        struct sr_film *film;
        struct sr_render_report report;
        struct sr_error error = {0};
        EXPECT(sr_render(&w.job, &film, &report, &error) == SR_OK);
        sum[i] = 0;
        for (uint32_t k = 0; k < 1200; ++k)
            sum[i] += sr_film_bucket(film, k / 3 % 20, k / 60, k % 3) * (1 + k);
        sr_film_destroy(film);
        world_free(&w);
    }
    EXPECT(sum[0] == sum[1] && sum[0] == sum[2]);
    EXPECT_RELATIVE(sum[3], sum[0], 1e-2);
}

/* What cameras make of a perfect white, under their own white balance and others, and of a chart's worth of colours.
 * Least squares leave a few per cent; the luminance of white is nearly right, and daylight is white. */
TEST(cameras_see_white_as_white)
{
    int n = 0;
    for (; sr_film_camera_name(n); ++n) {
        static const double temperatures[] = {3200, 5000, 6500, 9000};
        for (int t = 0; t < 4; ++t) {
            double m[3][3];
            sr_film_camera_matrix((uint32_t)n + 1, temperatures[t], SR_SRGB, m);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    EXPECT(isfinite(m[i][j]) && fabs(m[i][j]) < 10);
        }
        struct world w = world_of(
            "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float shutterclose\" 0.5\nIntegrator \"path\"\n"
            "Sampler \"zsobol\" \"integer pixelsamples\" 1024\nFilm \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 \"float iso\" 200\n"
            "\"string sensor\" \"%s\"\nWorldBegin\nLightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"\n",
            sr_film_camera_name(n));
        struct sr_film *film;
        struct sr_image *image = picture(&w, &film);
        double rgb[3] = {channel(image, "R", 0, 0), channel(image, "G", 0, 0), channel(image, "B", 0, 0)};
        printf("  %-20s %.4f %.4f %.4f\n", sr_film_camera_name(n), rgb[0], rgb[1], rgb[2]);
        for (int c = 0; c < 3; ++c) // 0.5 s at ISO 200: the ratio is 1
            EXPECT_NEAR(rgb[c], 1, is_slow_build() ? 0.3 : 0.06);
        sr_image_free(image);
        sr_film_destroy(film);
        world_free(&w);
    }
    EXPECT_EQUAL_INT(n, 17);
}

/* The values are the integral of L times the curve: against a sum over the wavelengths, of a lamp at 530 nm alone. */
TEST(sensors_integrate_their_curves)
{
    struct sr_lambda_range all = {SR_LAMBDA_MIN, SR_LAMBDA_MAX};
    double sum[3] = {0};
    enum { N = 20000 };
    for (int i = 0; i < N; ++i) {
        struct sr_wavelengths w = sr_wavelengths_sample(all, ((float)i + 0.5f) / N);
        sr_spectrum L = SR_BLACK;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            L[k] = w.lambda[k] >= 520 && w.lambda[k] < 530;
        float v[3];
        sr_film_camera_values(1, L, &w, v);
        for (int c = 0; c < 3; ++c)
            sum[c] += (double)v[c] / N;
    }
    // the Canon EOS 100D at 520 and 530 nm, in the table's linear piece
    static const double expected[3] = {10 * (0.10054 + 0.09959) / 2, 10 * (1.0 + 0.83768) / 2,
                                       10 * (0.26207 + 0.14686) / 2};
    for (int c = 0; c < 3; ++c)
        EXPECT_RELATIVE(sum[c], expected[c], 2e-3);
}
