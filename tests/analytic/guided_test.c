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
    QUAD("-1 -1 1", "-1 1 1", "1 -1 1", "1 1 1")                                                                       \
    QUAD("-1 -1 -1", "-1 1 -1", "-1 -1 1", "-1 1 1") QUAD("1 -1 -1", "1 -1 1", "1 1 -1", "1 1 1")
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

/* A world by its own estimator, and by one that learns. */
struct both {
    struct world plain, learned;
    struct sr_arena arena;
};

static struct both both_of(const char *scene, const char *estimator)
{
    struct both b = {.plain = world_of("%s", scene)};
    struct sr_error error = {0};
    b.learned = b.plain;
    if (sr_integrator_parse(estimator, &b.plain.scene.integrator, &b.arena, &b.learned.job.integrator, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return b;
}

static void both_free(struct both *b)
{
    sr_arena_free(&b->arena);
    world_free(&b->plain);
}

/* Means of seeds, of spp[0] and spp[1] samples; goal: relative standard error of both. */
static void expect_same_light(const char *name, const char *scene, const char *estimator, const uint32_t spp[2],
                              uint32_t seeds, double goal)
{
    struct both both = both_of(scene, estimator);
    uint32_t slow = is_slow_build() ? 8 : 1;
    struct estimate a = mean_of_seeds(&both.plain, spp[0] / slow, is_slow_build() ? 4 : seeds),
                    b = mean_of_seeds(&both.learned, spp[1] / slow, is_slow_build() ? 4 : seeds);
    double z = z_of((struct estimate){b.mean - a.mean, sqrt(a.error * a.error + b.error * b.error), a.degrees}, 0);
    printf("  %s: %.5g +- %.2g, %s %.5g +- %.2g, z %.2f\n", name, a.mean, a.error, estimator, b.mean, b.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || (a.error < goal * a.mean && b.error < goal * b.mean));
    both_free(&both);
}

/* In a closed room whose walls shine and reflect, L = Le / (1 - rho) in all places and directions. */
static void expect_light_of_furnace(const char *estimator)
{
    struct both both = both_of("LookAt 0 0 0  1 .3 .2  0 1 0 Camera \"perspective\" \"float fov\" 90\n" SMALL(
                                   "path", "60") "WorldBegin\n" GLOW_BOTH GREY BOX,
                               estimator);
    struct estimate e = mean_of_seeds(&both.learned, is_slow_build() ? 8 : 64, 8);
    double z = z_of(e, 2);
    printf("  furnace: %.6g +- %.2g, z %.2f\n", e.mean, e.error, z);
    EXPECT(fabs(z) < 4.9);
    EXPECT(is_slow_build() || e.error < 0.004);
    both_free(&both);
}

static void expect_the_same_for_any_threads_and_tiles(const char *scene, const char *estimator, const char *remark)
{
    struct both both = both_of(scene, estimator);
    struct sr_render_job *job = &both.learned.job;
    double mean[6];
    for (int i = 0; i < 6; ++i) {
        struct sr_render_report report;
        job->threads = 1 + i % 3;
        job->tile = i < 3 ? 16 : 3;
        job->spp = 16;
        struct sr_film *film = film_of(job, &report);
        EXPECT(strncmp(report.remark, remark, strlen(remark)) == 0);
        mean[i] = film_luminance(film);
        sr_film_destroy(film);
        EXPECT(mean[i] > 0 && mean[i] == mean[0]);
    }
    both_free(&both);
}

/* Whether the pilot says that learning pays (on: how its remark begins then); if not, the picture is that of path, bit
 * for bit. */
static bool learning_pays(const char *name, const char *scene, const char *estimator, uint32_t spp, const char *on,
                          const char *off)
{
    struct both both = both_of(scene, estimator);
    struct sr_render_report report, plain_report;
    both.plain.job.spp = both.learned.job.spp = spp;
    struct sr_film *plain = film_of(&both.plain.job, &plain_report), *film = film_of(&both.learned.job, &report);
    printf("  %s: %s\n", name, report.remark);
    bool pays = strncmp(report.remark, on, strlen(on)) == 0;
    EXPECT(pays || strncmp(report.remark, off, strlen(off)) == 0);
    EXPECT(strstr(report.remark, ": by a pilot of ") != NULL);
    EXPECT(pays == (film_luminance(film) != film_luminance(plain)));
    sr_film_destroy(film);
    sr_film_destroy(plain);
    both_free(&both);
    return pays;
}

static void expect_nothing_learned_from_few_samples(const char *estimator)
{
    struct both both = both_of(SMALL("path", "6") LAMP_IN_A_TUBE, estimator);
    struct sr_render_report report;
    both.learned.job.spp = 16;
    sr_film_destroy(film_of(&both.learned.job, &report));
    EXPECT(strstr(report.remark, "too few samples") != NULL);
    EXPECT(report.rays < 7 * report.paths); // no pilot has been traced
    both_free(&both);
}

/* ---- directions by what has been learned ---- */

/* guiding=on says so in any case; then the picture is another than path's, so some are guided. */
static bool guiding_pays(const char *name, const char *scene, const char *estimator, uint32_t spp)
{
    return learning_pays(name, scene, estimator, spp, "paths are guided", "paths are not guided");
}

TEST(guided_paths_find_the_light_of_plain_paths)
{
    expect_same_light("tube", SMALL("path", "6") LAMP_IN_A_TUBE, "guidedpath,guiding=on,pilot=2",
                      (const uint32_t[]){256, 128}, 16, 0.04);
}

/* Walls that shine a little, and the spot of the lamp in its tube: both ways to the walls' light and the way to the
 * spot, which is guided, weigh much. From the lights' end all of it is found without any of this. */
TEST(guided_paths_find_what_light_paths_find)
{
    expect_same_light(
        "light paths",
        LOOK_ASIDE SMALL(
            "lightpath",
            "2") "WorldBegin\n" GLOW_BOTH GREY
            BOX "AttributeBegin Translate .5 .2 .5 Rotate -90 1 0 0 Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"cylinder\" \"float radius\" .1 \"float zmin\" -.02 \"float zmax\" .3\n"
                 "AreaLightSource \"diffuse\" \"float scale\" 30000 Shape \"disk\" \"float radius\" .08 AttributeEnd\n",
        "guidedpath,guiding=on,pilot=1", (const uint32_t[]){256, 256}, 12, 0.01);
}

/* A wall that shines on a floor: a lamp so large that samples of it and guided directions count about as much, and
 * nothing else is there. */
#define SHINING_WALL                                                                                                   \
    LOOK_ASIDE SMALL("path", "2") "WorldBegin\n" GREY QUAD("-1 -1 -1", "-1 -1 1", "1 -1 -1", "1 -1 1")                 \
        BLACK GLOW_BOTH QUAD("1 -1 -1", "1 -1 1", "1 1 -1", "1 1 1")

TEST(light_samples_and_guided_directions_share_their_light)
{
    const char *estimator = "guidedpath,guiding=on,pilot=2";
    expect_same_light("shining wall", SHINING_WALL, estimator, (const uint32_t[]){512, 512}, 16, 0.0002);
    EXPECT(guiding_pays("wall", SHINING_WALL, estimator, 64));
}

TEST(guided_paths_keep_the_light_of_a_furnace)
{
    expect_light_of_furnace("guidedpath,guiding=on,pilot=2");
}

/* Half a sphere below the sky, seen from its centre: paths that end by lot lose none of the sky's light, which only
 * they find. */
TEST(guided_paths_find_all_of_the_sky)
{
    expect_same_light("bowl",
                      "LookAt 0 0 0  0 0 -1  0 1 0 Camera \"perspective\" \"float fov\" 100\n" SMALL(
                          "path", "12") "WorldBegin\nLightSource \"infinite\"\n" GREY
                                        "Shape \"sphere\" \"float radius\" 1 \"float zmax\" 0\n",
                      "guidedpath,guiding=on,pilot=2", (const uint32_t[]){512, 512}, 16, 0.002);
}

TEST(guided_paths_do_not_depend_on_threads_or_tiles)
{
    expect_the_same_for_any_threads_and_tiles(SMALL("path", "6") LAMP_IN_A_TUBE, "guidedpath,guiding=on,pilot=4",
                                              "paths are guided");
}

TEST(guiding_switches_itself_off_where_it_does_not_pay)
{
    // a lamp that all of the box sees
    EXPECT(!guiding_pays(
        "box",
        LOOK_ASIDE SMALL("path", "6") "WorldBegin\n" GREY
            BOX "AttributeBegin AreaLightSource \"diffuse\" \"float scale\" 20 Translate 0 .99 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" .3 AttributeEnd\n",
        "guidedpath,pilot=6", 64));
}

TEST(guiding_switches_itself_on_where_it_pays)
{
    if (is_slow_build())
        test_skip("too few samples to learn from in a slow build");
    EXPECT(guiding_pays("tube", SMALL("path", "2") LAMP_IN_A_TUBE, "guidedpath,pilot=4", 512));
}

TEST(pictures_with_few_samples_are_not_guided)
{
    expect_nothing_learned_from_few_samples("guidedpath");
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

TEST(learned_roulette_finds_the_light_of_plain_paths)
{
    const char *estimator = "roulettepath,learned=on,pilot=0.01";
    expect_same_light("tube", SMALL("path", "6") LAMP_IN_A_TUBE, estimator, (const uint32_t[]){512, 256}, 8, 0.03);
    if (is_slow_build())
        return;
    expect_same_light("white room", SMALL("path", "40") WHITE_ROOM, estimator, (const uint32_t[]){64, 32}, 8, 0.03);
    expect_same_light("dark floor", SMALL("path", "20") DARK_FLOOR, estimator, (const uint32_t[]){128, 64}, 8, 0.03);
}

TEST(learned_roulette_keeps_the_light_of_a_furnace)
{
    expect_light_of_furnace("roulettepath,learned=on,pilot=2");
}

TEST(learned_roulette_does_not_depend_on_threads_or_tiles)
{
    expect_the_same_for_any_threads_and_tiles(SMALL("path", "20") DARK_FLOOR, "roulettepath,learned=on",
                                              "roulette goes by what has been learned");
}

static bool lots_pay(const char *name, const char *scene)
{
    return learning_pays(name, scene, "roulettepath,pilot=10", 16, "roulette goes by what has been learned",
                         "roulette goes by throughput");
}

TEST(roulette_is_learned_where_that_pays)
{
    if (is_slow_build())
        test_skip("too few samples to learn from in a slow build");
    EXPECT(lots_pay("white room", SMALL("path", "40") WHITE_ROOM));
    EXPECT(!lots_pay("tube", SMALL("path", "6") LAMP_IN_A_TUBE));
}

TEST(pictures_with_few_samples_do_not_learn_roulette)
{
    expect_nothing_learned_from_few_samples("roulettepath");
}
