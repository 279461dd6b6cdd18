/* SPDX-License-Identifier: MIT */
/* A render that is stopped again and again and gone on with has the sums of one that was left alone: films, counts, and
 * all. */
#include "agree/render_helper.h"

#include <sys/stat.h>
#include <unistd.h>

/* Stops a render after so many progress calls. */
struct stopper {
    atomic_bool is_stopped;
    int left;
};

static void on_progress(void *user, const struct sr_render_progress *p)
{
    struct stopper *s = user;
    (void)p;
    if (s->left-- <= 0)
        atomic_store(&s->is_stopped, true);
}

static bool are_equal(const struct sr_film *a, const struct sr_film *b)
{
    size_t n = (size_t)a->width * a->height;
    bool same =
        memcmp(a->pixels, b->pixels, n * sizeof *a->pixels) == 0 && memcmp(a->aov, b->aov, n * sizeof *a->aov) == 0;
    if (a->buckets)
        same &= memcmp(a->buckets, b->buckets, n * a->settings.buckets * sizeof *a->buckets) == 0;
    if (a->splats)
        same &= memcmp(a->splats->words, b->splats->words, n * sr_film_splats_B(a->splats->groups)) == 0 &&
                memcmp(a->splats->paths, b->splats->paths, sizeof a->splats->paths) == 0;
    return same;
}

static const char *beside(const char *ending)
{
    static char path[2][600];
    static int turn;
    turn ^= 1;
    snprintf(path[turn], sizeof path[turn], "%s/kept.srk%s", test_folder(), ending);
    return path[turn];
}

static void expect_same_sums(struct sr_render_job job)
{
    static const int threads[] = {1, 2, 3, 7}, tiles[] = {5, 8, 16, 3};
    struct sr_render_report alone, report = {0};
    job.with_aov = true;
    job.threads = 2;
    struct sr_film *expected = render_or_fail(&job, &alone), *film = NULL;
    struct sr_arena arena = {0};
    const char *identity = sr_render_identity(&arena, &job, "hash 1\n");
    EXPECT(identity);
    char path[600];
    snprintf(path, sizeof path, "%s", beside(""));
    struct sr_render_keep keep = {.path = path, .identity = identity, .interval_s = 0.002, .resumes = true};
    job.keep = &keep;
    int stops = 0;
    for (sr_status status = SR_CANCELLED; status == SR_CANCELLED; ++stops) {
        struct sr_error error = {0};
        struct stopper stopper = {.left = 5 + 3 * stops};
        job.threads = threads[stops % 4];
        job.tile = tiles[stops / 4 % 4];
        job.progress = on_progress;
        job.progress_interval_s = 0;
        job.user = &stopper;
        job.cancel = &stopper.is_stopped;
        sr_film_destroy(film);
        status = sr_render(&job, &film, &report, &error);
        if (status != SR_OK && status != SR_CANCELLED)
            test_fail(__FILE__, __LINE__, "%s", error.text);
        EXPECT(stops < 1000 && !report.kept.is_behind);
    }
    EXPECT(stops > 3); // or nothing was shown
    EXPECT(are_equal(film, expected));
    EXPECT(report.paths == alone.paths && report.rays == alone.rays && report.shadow_rays == alone.shadow_rays &&
           report.vertices == alone.vertices && report.dropped == alone.dropped);
    sr_render_forget(&keep);
    EXPECT(!sr_file_exists(beside("")) && !sr_file_exists(beside("~")) && !sr_file_exists(beside(".new")));
    sr_film_destroy(film);
    sr_film_destroy(expected);
    sr_arena_free(&arena);
}

static void expect_resumes(const char *integrator, uint32_t replicates, uint32_t buckets, bool is_adaptive)
{
    struct sr_import_result scene;
    struct sr_error error = {0};
    struct sr_import_options options = {
        .width = 40, .height = 30, .spp = is_slow_build() ? 16 : 64, .integrator = integrator};
    if (!import_scene(SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt", &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.replicates = replicates;
    job.adaptive.is_on = is_adaptive;
    job.film.buckets = buckets;
    job.film.lambda_min = 400, job.film.lambda_max = 700, job.film.bucket_scale = 1;
    expect_same_sums(job);
    sr_import_result_free(&scene);
}

TEST(resumed_sums_are_those_of_a_render_that_was_left_alone)
{
    expect_resumes(NULL, 0, 0, false);
    expect_resumes(NULL, 8, 0, false);
    expect_resumes(NULL, 0, 5, false);
}

TEST(resumed_splats_are_those_of_a_render_that_was_left_alone)
{
    expect_resumes("bdpt", 0, 0, false);
    expect_resumes("lightpath", 4, 0, false);
}

TEST(resumed_halves_are_those_of_a_render_that_was_left_alone)
{
    expect_resumes(NULL, 0, 0, true);
}

/* Where the work is done and the picture could not be written. */
TEST(finished_work_can_be_kept)
{
    struct sr_import_result scene;
    struct sr_error error = {0};
    struct sr_import_options options = {.width = 20, .height = 15, .spp = 4, .integrator = "bdpt"};
    if (!import_scene(SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt", &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.with_aov = true;
    struct sr_arena arena = {0};
    struct sr_render_keep keep = {.path = beside(""),
                                  .identity = sr_render_identity(&arena, &job, "hash 1\n"),
                                  .interval_s = 60,
                                  .resumes = true};
    job.keep = &keep;
    struct sr_render_report first, second;
    struct sr_film *film = render_or_fail(&job, &first);
    EXPECT(first.kept.written == 0 && sr_render_checkpoint(&job, film, &first, &error) == SR_OK &&
           first.kept.written == 1);
    struct sr_film *again = render_or_fail(&job, &second);
    EXPECT(are_equal(film, again) && second.kept.resumed_share == 1 && second.is_complete &&
           second.rays == first.rays && second.dropped == first.dropped);
    sr_render_forget(&keep);
    sr_film_destroy(film);
    sr_film_destroy(again);
    sr_arena_free(&arena);
    sr_import_result_free(&scene);
}
