/* SPDX-License-Identifier: MIT */
/* Paths that learn, where light comes from or what it brings to go on: against path tracing and closed forms, whatever
 * has been learned; the same bytes for any threads; off where it does not pay. |z| < 4.9 for the difference of the
 * seeds' means. */
#include "analytic/analytic.h"

#define SMALL(estimator, depth)                                                                                        \
    "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 8 PixelFilter \"box\"\nIntegrator \"" estimator   \
    "\" \"integer maxdepth\" " depth "\n"
#define QUAD(a, b, c, d) "Shape \"bilinearmesh\" \"point3 P\" [" a " " b " " c " " d "]\n"
#define LOOK_ASIDE "LookAt -.8 .2 -.8  .3 -.5 .3  0 1 0 Camera \"perspective\" \"float fov\" 80\n"
/* A box of 2 m about the origin, of six squares. */
#define BOX                                                                                                            \
    QUAD("-1 -1 -1", "-1 -1 1", "1 -1 -1", "1 -1 1")                                                                   \
    QUAD("-1 1 -1", "1 1 -1", "-1 1 1", "1 1 1")                                                                       \
    QUAD("-1 -1 -1", "1 -1 -1", "-1 1 -1", "1 1 -1")                                                                   \
    QUAD("-1 -1 1", "-1 1 1", "1 -1 1", "1 1 1") QUAD("-1 -1 -1", "-1 1 -1", "-1 -1 1", "-1 1 1")                      \
        QUAD("1 -1 -1", "1 -1 1", "1 1 -1", "1 1 1")
/* The box lit by a spot of its ceiling alone, which a lamp in a black tube throws there; a glossy ball, a coated one
 * and a glass one. */
#define LAMP_IN_A_TUBE                                                                                                                                                                   \
    LOOK_ASIDE                                                                                                                                                                           \
    "WorldBegin\n" GREY BOX                                                                                                                                                              \
    "AttributeBegin Translate .5 .2 .5 Rotate -90 1 0 0 Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"cylinder\" \"float radius\" .1 \"float zmin\" -.02 \"float zmax\" .3\n" \
    "AreaLightSource \"diffuse\" \"float scale\" 300 Shape \"disk\" \"float radius\" .08 AttributeEnd\n"                                                                                 \
    "AttributeBegin Material \"conductor\" \"float roughness\" .3 Translate -.2 -.7 .5 Shape \"sphere\" \"float radius\" .3 AttributeEnd\n"                                              \
    "AttributeBegin Material \"coateddiffuse\" \"float roughness\" .2 Translate .4 -.7 -.3 Shape \"sphere\" \"float radius\" .3 AttributeEnd\n"                                          \
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
    double sum = 0, rgb[3];
    for (uint32_t i = 0; i < film->width * film->height; ++i) {
        sr_film_pixel_mean(film, i % film->width, i / film->width, rgb);
        sum += y[0] * rgb[0] + y[1] * rgb[1] + y[2] * rgb[2];
    }
    return sum / (film->width * film->height);
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

/* Walls that shine a little, and the spot of the lamp in its tube: both ways to the walls' light and the way to the
 * spot, which is guided, weigh much. From the lights' end all of it is found without any of this. */
TEST(guided_paths_find_what_light_paths_find)
{
    struct world w = world_of(LOOK_ASIDE SMALL(
        "lightpath",
        "2") "WorldBegin\n" GLOW_BOTH GREY BOX
             "AttributeBegin Translate .5 .2 .5 Rotate -90 1 0 0 Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"cylinder\" \"float radius\" .1 \"float zmin\" -.02 \"float zmax\" .3\n"
             "AreaLightSource \"diffuse\" \"float scale\" 30000 Shape \"disk\" \"float radius\" .08 AttributeEnd\n");
    struct sr_arena arena = {0};
    struct world g = guided(w, "guidedpath,guiding=on,pilot=1", &arena);
    uint32_t spp = is_slow_build() ? 8 : 256, seeds = is_slow_build() ? 4 : 12;
    struct estimate a = mean_of_seeds(&w, spp, seeds), b = mean_of_seeds(&g, spp, seeds);
    double z = z_of((struct estimate){b.mean - a.mean, sqrt(a.error * a.error + b.error * b.error), a.degrees}, 0);
    printf("  light paths %.5g +- %.2g, guided %.5g +- %.2g, z %.2f\n", a.mean, a.error, b.mean, b.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || (a.error < 0.01 * a.mean && b.error < 0.01 * b.mean));
    sr_arena_free(&arena);
    world_free(&w);
}

/* In a closed room whose walls shine and reflect, L = Le / (1 - rho) in all places and directions. */
TEST(guided_paths_keep_the_light_of_a_furnace)
{
    struct world w = world_of("LookAt 0 0 0  1 .3 .2  0 1 0 Camera \"perspective\" \"float fov\" 90\n" SMALL(
        "path", "60") "WorldBegin\n" GLOW_BOTH GREY BOX);
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
    struct world w = world_of(LOOK_ASIDE SMALL(
        "path",
        "6") "WorldBegin\n" GREY BOX
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

/* ---- roulette by what has been learned ---- */

#define LAMP                                                                                                           \
    "AttributeBegin AreaLightSource \"diffuse\" \"float scale\" 20 Translate 0 .99 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" .2 AttributeEnd\n"
#define WHITE "Material \"diffuse\" \"rgb reflectance\" [.9 .9 .9]\n"
/* A white room with a lamp and a ball of glass. */
#define WHITE_ROOM                                                                                                     \
    LOOK_ASIDE                                                                                                         \
    "WorldBegin\n" WHITE BOX LAMP                                                                                      \
    "AttributeBegin Material \"dielectric\" Translate .2 -.7 .3 Shape \"sphere\" \"float radius\" .3 AttributeEnd\n"
/* A grey one whose floor is nearly black: what it sends on carries little and is all that one sees there. */
#define DARK_FLOOR                                                                                                     \
    LOOK_ASIDE "WorldBegin\n" GREY BOX LAMP "Material \"diffuse\" \"rgb reflectance\" [.03 .05 .04]\n" QUAD(           \
        "-1 -.9 -1", "-1 -.9 1", "1 -.9 -1", "1 -.9 1")

static void expect_light_of_plain_paths(const char *name, const char *scene, uint32_t spp)
{
    struct world w = world_of(scene);
    uint32_t seeds = is_slow_build() ? 4 : 8;
    spp = is_slow_build() ? 8 : spp;
    struct sr_arena arena = {0};
    struct world g = guided(w, "roulettepath,learned=on,pilot=0.01", &arena);
    struct estimate a = mean_of_seeds(&w, 2 * spp, seeds), b = mean_of_seeds(&g, spp, seeds);
    double z = z_of((struct estimate){b.mean - a.mean, sqrt(a.error * a.error + b.error * b.error), a.degrees}, 0);
    printf("  %s: paths %.5g +- %.2g, by lots that have been learned %.5g +- %.2g, z %.2f\n", name, a.mean, a.error,
           b.mean, b.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || b.error < 0.03 * b.mean);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(learned_roulette_finds_the_light_of_plain_paths)
{
    expect_light_of_plain_paths("tube", SMALL("path", "6") LAMP_IN_A_TUBE, 256);
    if (is_slow_build())
        return;
    expect_light_of_plain_paths("white room", SMALL("path", "40") WHITE_ROOM, 32);
    expect_light_of_plain_paths("dark floor", SMALL("path", "20") DARK_FLOOR, 64);
}

TEST(learned_roulette_keeps_the_light_of_a_furnace)
{
    struct world w = world_of("LookAt 0 0 0  1 .3 .2  0 1 0 Camera \"perspective\" \"float fov\" 90\n" SMALL(
        "path", "60") "WorldBegin\n" GLOW_BOTH GREY BOX);
    struct sr_arena arena = {0};
    struct world g = guided(w, "roulettepath,learned=on,pilot=2", &arena);
    struct estimate e = mean_of_seeds(&g, is_slow_build() ? 8 : 64, 8);
    double z = z_of(e, 2);
    printf("  furnace: %.6g +- %.2g, z %.2f\n", e.mean, e.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || e.error < 0.004);
    sr_arena_free(&arena);
    world_free(&w);
}

TEST(learned_roulette_does_not_depend_on_threads_or_tiles)
{
    struct world w = world_of(SMALL("path", "20") DARK_FLOOR);
    struct sr_arena arena = {0};
    struct world g = guided(w, "roulettepath,learned=on", &arena);
    double mean[6];
    for (int i = 0; i < 6; ++i) {
        struct sr_render_report report;
        g.job.threads = 1 + i % 3;
        g.job.tile = i < 3 ? 16 : 3;
        g.job.spp = 16;
        struct sr_film *film = film_of(&g.job, &report);
        EXPECT(strncmp(report.remark, "roulette goes by what has been learned", 38) == 0);
        mean[i] = film_luminance(film);
        sr_film_destroy(film);
        EXPECT(mean[i] > 0 && mean[i] == mean[0]);
    }
    sr_arena_free(&arena);
    world_free(&w);
}

/* Whether the pilot says that learning pays; if not, the picture is that of path, bit for bit. */
static bool learning_pays(const char *name, const char *scene, float pilot)
{
    struct world w = world_of(scene);
    struct sr_arena arena = {0};
    char text[64];
    snprintf(text, sizeof text, "roulettepath,pilot=%g", (double)pilot);
    struct world g = guided(w, text, &arena);
    struct sr_render_report report, plain_report;
    w.job.spp = g.job.spp = 16;
    struct sr_film *plain = film_of(&w.job, &plain_report), *film = film_of(&g.job, &report);
    printf("  %s: %s\n", name, report.remark);
    bool pays = strstr(report.remark, "by what has been learned: by a pilot") != NULL;
    EXPECT(pays || strstr(report.remark, "by throughput: by a pilot") != NULL);
    EXPECT(pays == (film_luminance(film) != film_luminance(plain)));
    sr_film_destroy(film);
    sr_film_destroy(plain);
    sr_arena_free(&arena);
    world_free(&w);
    return pays;
}

TEST(roulette_is_learned_where_that_pays)
{
    if (is_slow_build())
        test_skip("too few samples to learn from in a slow build");
    EXPECT(learning_pays("white room", SMALL("path", "40") WHITE_ROOM, 10));
    EXPECT(!learning_pays("tube", SMALL("path", "6") LAMP_IN_A_TUBE, 10));
}

TEST(pictures_with_few_samples_do_not_learn_roulette)
{
    struct world w = world_of(SMALL("path", "6") LAMP_IN_A_TUBE);
    struct sr_arena arena = {0};
    struct world g = guided(w, "roulettepath", &arena);
    struct sr_render_report report;
    g.job.spp = 16;
    sr_film_destroy(film_of(&g.job, &report));
    EXPECT(strstr(report.remark, "too few samples") != NULL);
    sr_arena_free(&arena);
    world_free(&w);
}
