/* SPDX-License-Identifier: MIT */
/* Light thrown by mirrors and clear glass, by photons: against the image of a lamp behind a mirror, and against path
 * tracing where that finds the lamp by chance. |t| of the seeds' means < 4.9 standard deviations. */
#include "analytic/analytic.h"

#define FLOOR_SEEN_FROM_ABOVE                                                                                          \
    "LookAt 0 -.3 1.5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" .5 Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 PixelFilter \"box\"\n"
#define PHOTONS                                                                                                        \
    "Integrator \"sppm\" \"integer maxdepth\" 6 \"float radius\" .1 \"integer photonsperiteration\" 20000\nWorldBegin\n"
#define GREY_FLOOR GREY "Shape \"disk\" \"float radius\" 20\n"

static struct estimate mean_of_seeds(const struct world *w, uint32_t spp)
{
    struct sr_tally t = {0};
    for (uint32_t seed = 1; seed <= (is_slow_build() ? 4u : 16u); ++seed) {
        struct sr_render_job job = w->job;
        struct sr_film *film;
        struct sr_render_report report;
        struct sr_error error = {0};
        job.seed = seed;
        job.spp = spp;
        if (sr_render(&job, &film, &report, &error) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        double sum = 0;
        const double *y = sr_colour_space(SR_SRGB)->xyz_from_rgb[1];
        for (int i = 0; i < 4; ++i)
            sum += (y[0] * film->pixels[i].sum[0] + y[1] * film->pixels[i].sum[1] + y[2] * film->pixels[i].sum[2]) /
                   film->pixels[i].n / 4;
        sr_tally_add(&t, sum);
        sr_film_destroy(film);
    }
    return (struct estimate){t.mean, sr_tally_standard_error(&t), (double)(t.n - 1)};
}

// Fresnel's reflectance of a metal, unpolarised, cos: of the angle of incidence
static double metal(double cosine, double eta, double k)
{
    double c2 = cosine * cosine, s2 = 1 - c2, t0 = eta * eta - k * k - s2, a2b2 = sqrt(t0 * t0 + 4 * eta * eta * k * k);
    double a = sqrt(fmax(0, (a2b2 + t0) / 2)), rs = (a2b2 + c2 - 2 * a * cosine) / (a2b2 + c2 + 2 * a * cosine);
    double rp = rs * (c2 * a2b2 + s2 * s2 - 2 * a * cosine * s2) / (c2 * a2b2 + s2 * s2 + 2 * a * cosine * s2);
    return (rs + rp) / 2;
}

/* A spot throws all of its light on the mirror x = -1; the floor is lit by its image at (-2.5, 0, 1). */
TEST(caustics_of_a_mirror_are_the_light_of_an_image)
{
    struct world w = world_of(
        FLOOR_SEEN_FROM_ABOVE PHOTONS GREY_FLOOR
        "LightSource \"spot\" \"spectrum I\" \"stdillum-D65\" \"float scale\" 50 \"point3 from\" [.5 0 1] \"point3 to\" [-1 0 .4] \"float coneangle\" 15 \"float conedeltaangle\" .01\n"
        "Material \"conductor\" \"spectrum eta\" [360 .2 830 .2] \"spectrum k\" [360 3 830 3] \"float roughness\" 0\n"
        "Translate -1 0 0 Rotate 90 0 1 0 Shape \"disk\" \"float radius\" 5\n");
    double d = sqrt(7.25), expected = 0.5 / 3.14159265358979323846 * 50 * metal(2.5 / d, .2, 3) / (d * d * d);
    struct estimate e = mean_of_seeds(&w, 8);
    double z = z_of(e, expected);
    printf("  mirror: %.6g +- %.2g, image %.6g, z %.2f\n", e.mean, e.error, expected, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || e.error < 0.01 * expected);
    world_free(&w);
}

TEST(caustics_of_dispersive_glass_agree_with_path_tracing)
{
#define PANE                                                                                                                                        \
    "AttributeBegin AreaLightSource \"diffuse\" \"float scale\" 100 Translate 0 .5 4 Shape \"sphere\" \"float radius\" 1 AttributeEnd\n" GREY_FLOOR \
    "Material \"dielectric\" \"spectrum eta\" \"glass-F11\"\n"                                                                                      \
    "Translate 0 0 2 Shape \"disk\" \"float radius\" 20 Translate 0 0 .3 Shape \"disk\" \"float radius\" 20\n"
    struct world photons = world_of(
        "LookAt 0 -.3 1.5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" .5 Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 PixelFilter \"box\"\n"
        "Integrator \"caustics\" \"integer maxdepth\" 6 \"float radius\" .3 \"integer photonsperiteration\" 50000\nWorldBegin\n" PANE);
    struct world paths =
        world_of(FLOOR_SEEN_FROM_ABOVE "Integrator \"path\" \"integer maxdepth\" 6\nWorldBegin\n" PANE);
    struct estimate a = mean_of_seeds(&photons, 4), b = mean_of_seeds(&paths, samples(16384));
    double z = z_of((struct estimate){a.mean - b.mean, sqrt(a.error * a.error + b.error * b.error), a.degrees}, 0);
    printf("  glass: photons %.6g +- %.2g, paths %.6g +- %.2g, z %.2f\n", a.mean, a.error, b.mean, b.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || (a.error < 0.08 * b.mean && b.error < 0.02 * b.mean)); // each seed has four colours only
    world_free(&photons);
    world_free(&paths);
}

TEST(caustics_do_not_depend_on_threads)
{
    struct world w = world_of(
        FLOOR_SEEN_FROM_ABOVE PHOTONS GREY_FLOOR
        "LightSource \"point\" \"point3 from\" [0 0 3] Material \"dielectric\" Translate 0 0 1 Shape \"sphere\" \"float radius\" .4\n");
    double mean[3];
    for (int threads = 1; threads <= 3; ++threads) {
        w.job.threads = threads;
        mean[threads - 1] = mean_of_seeds(&w, 2).mean;
    }
    EXPECT(mean[0] > 0 && mean[0] == mean[1] && mean[1] == mean[2]);
    world_free(&w);
}
