/* SPDX-License-Identifier: MIT */
/* Guided paths: against path tracing and closed forms, whatever has been learned; the same bytes for any threads; off where it
 * does not pay. |z| < 4.9 for the difference of the seeds' means. */
#include "analytic/analytic.h"

#define SMALL(estimator, depth) \
    "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 8 PixelFilter \"box\"\nIntegrator \"" estimator "\" \"integer maxdepth\" " depth "\n"
#define QUAD(a, b, c, d) "Shape \"bilinearmesh\" \"point3 P\" [" a " " b " " c " " d "]\n"
/* A box of 2 m about the origin, of six squares. */
#define BOX                                                                                                                                                \
    QUAD("-1 -1 -1", "-1 -1 1", "1 -1 -1", "1 -1 1") QUAD("-1 1 -1", "1 1 -1", "-1 1 1", "1 1 1") QUAD("-1 -1 -1", "1 -1 -1", "-1 1 -1", "1 1 -1")         \
    QUAD("-1 -1 1", "-1 1 1", "1 -1 1", "1 1 1") QUAD("-1 -1 -1", "-1 1 -1", "-1 -1 1", "-1 1 1") QUAD("1 -1 -1", "1 -1 1", "1 1 -1", "1 1 1")
/* The box lit by a spot of its ceiling alone, which a lamp in a black tube throws there; a glossy ball, a coated one and a glass one. */
#define LAMP_IN_A_TUBE                                                                                                                                     \
    "LookAt -.8 .2 -.8  .3 -.5 .3  0 1 0 Camera \"perspective\" \"float fov\" 80\nWorldBegin\n" GREY BOX                                                    \
    "AttributeBegin Translate .5 .2 .5 Rotate -90 1 0 0 Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"cylinder\" \"float radius\" .1 \"float zmin\" -.02 \"float zmax\" .3\n" \
    "AreaLightSource \"diffuse\" \"float scale\" 300 Shape \"disk\" \"float radius\" .08 AttributeEnd\n"                                                    \
    "AttributeBegin Material \"conductor\" \"float roughness\" .3 Translate -.2 -.7 .5 Shape \"sphere\" \"float radius\" .3 AttributeEnd\n"                   \
    "AttributeBegin Material \"coateddiffuse\" \"float roughness\" .2 Translate .4 -.7 -.3 Shape \"sphere\" \"float radius\" .3 AttributeEnd\n"               \
    "AttributeBegin Material \"dielectric\" Translate .1 .2 .2 Shape \"sphere\" \"float radius\" .1 AttributeEnd\n"

static struct sr_film *film_of(const struct sr_render_job *job, struct sr_render_report *report)
{
    struct sr_film *film;
    struct sr_error error = {0};
    if (sr_render(job, &film, report, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return film;
}

static double film_luminance(const struct sr_film *film)
{
    const double *y = sr_colour_space(SR_SRGB)->xyz_from_rgb[1];
    double sum = 0, n = 0;
    for (uint32_t i = 0; i < film->width * film->height; ++i, ++n)
        sum += (y[0] * film->pixels[i].sum[0] + y[1] * film->pixels[i].sum[1] + y[2] * film->pixels[i].sum[2]) / film->pixels[i].n;
    return sum / n;
}

static struct estimate mean_of_seeds(const struct world *w, uint32_t spp, uint32_t seeds)
{
    struct sr_tally t = {0};
    for (uint32_t seed = 1; seed <= seeds; ++seed) {
        struct sr_render_job job = w->job;
        struct sr_render_report report;
        job.seed = seed;
        job.spp = spp;
        struct sr_film *film = film_of(&job, &report);
        sr_tally_add(&t, film_luminance(film));
        sr_film_destroy(film);
    }
    return (struct estimate){t.mean, sr_tally_standard_error(&t), (double)(t.n - 1)};
}

/* The same world by another estimator, which belongs to the arena. */
static struct world guided(struct world w, const char *settings, struct sr_arena *arena)
{
    struct sr_error error = {0};
    if (sr_integrator_parse(settings, &w.scene.integrator, arena, &w.job.integrator, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return w;
}

TEST(guided_paths_find_the_light_of_plain_paths)
{
    struct world w = world_of(SMALL("path", "6") LAMP_IN_A_TUBE);
    uint32_t seeds = is_slow_build() ? 4 : 16, spp = is_slow_build() ? 16 : 128;
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath,guiding=on,pilot=2", &arena);
    struct estimate a = mean_of_seeds(&w, 2 * spp, seeds), b = mean_of_seeds(&g, spp, seeds);
    double z = z_of((struct estimate){b.mean - a.mean, sqrt(a.error * a.error + b.error * b.error), a.degrees}, 0);
    printf("  paths %.5g +- %.2g, guided %.5g +- %.2g, z %.2f\n", a.mean, a.error, b.mean, b.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || b.error < 0.04 * b.mean);
    sr_arena_free(&arena);
    world_free(&w);
}

/* In a closed room whose walls shine and reflect, L = Le / (1 - rho) in all places and directions. */
TEST(guided_paths_keep_the_light_of_a_furnace)
{
    struct world w = world_of("LookAt 0 0 0  1 .3 .2  0 1 0 Camera \"perspective\" \"float fov\" 90\n" SMALL("path", "60") "WorldBegin\n" GLOW_BOTH GREY BOX);
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath,guiding=on,pilot=2", &arena);
    struct estimate e = mean_of_seeds(&g, is_slow_build() ? 8 : 64, 8);
    double z = z_of(e, 2);
    printf("  furnace: %.6g +- %.2g, z %.2f\n", e.mean, e.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || e.error < 0.004);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(guided_paths_do_not_depend_on_threads_or_tiles)
{
    struct world w = world_of(SMALL("path", "6") LAMP_IN_A_TUBE);
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath,guiding=on,pilot=4", &arena);
    double mean[6];
    for (int i = 0; i < 6; ++i) {
        struct sr_render_report report;
        g.job.threads = 1 + i % 3;
        g.job.tile = i < 3 ? 16 : 3;
        g.job.spp = 16;
        struct sr_film *film = film_of(&g.job, &report);
        EXPECT(strncmp(report.remark, "paths are guided", 16) == 0);
        mean[i] = film_luminance(film);
        sr_film_destroy(film);
        EXPECT(mean[i] > 0 && mean[i] == mean[0]);
    }
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(guiding_switches_itself_off_where_it_does_not_pay)
{
    // a lamp that all of the box sees
    struct world w = world_of("LookAt -.8 .2 -.8  .3 -.5 .3  0 1 0 Camera \"perspective\" \"float fov\" 80\n" SMALL("path", "6") "WorldBegin\n" GREY BOX
                              "AttributeBegin AreaLightSource \"diffuse\" \"float scale\" 20 Translate 0 .99 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" .3 AttributeEnd\n");
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath,pilot=6", &arena);
    struct sr_render_report report;
    w.job.spp = g.job.spp = 64;
    struct sr_film *plain = film_of(&w.job, &report), *film = film_of(&g.job, &report);
    printf("  box: %s\n", report.remark);
    EXPECT(strncmp(report.remark, "paths are not guided: by a pilot", 32) == 0);
    EXPECT(film_luminance(film) == film_luminance(plain)); // then the picture is that of path, bit for bit
    sr_film_destroy(film);
    sr_film_destroy(plain);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(guiding_switches_itself_on_where_it_pays)
{
    if (is_slow_build())
        test_skip("too few samples to learn from in a slow build");
    struct world w = world_of(SMALL("path", "2") LAMP_IN_A_TUBE);
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath,pilot=4", &arena);
    struct sr_render_report report;
    g.job.spp = 512;
    struct sr_film *film = film_of(&g.job, &report);
    printf("  tube: %s\n", report.remark);
    EXPECT(strncmp(report.remark, "paths are guided", 16) == 0);
    sr_film_destroy(film);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(pictures_with_few_samples_are_not_guided)
{
    struct world w = world_of(SMALL("path", "6") LAMP_IN_A_TUBE);
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath", &arena);
    struct sr_render_report report;
    g.job.spp = 16;
    struct sr_film *film = film_of(&g.job, &report);
    EXPECT(strstr(report.remark, "too few samples") != NULL);
    EXPECT(report.rays < 7 * report.paths); // no pilot has been traced
    sr_film_destroy(film);
    sr_arena_free(&arena);
    world_free(&w);
}
