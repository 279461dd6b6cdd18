/* SPDX-License-Identifier: MIT */
/* The same scene, seed and settings give the same bytes, whoever does the work. */
#include "agree/render_helper.h"

static uint64_t hash_of(struct sr_render_job job, int threads, int tile)
{
    job.threads = threads;
    job.tile = tile;
    job.with_aov = true;
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    struct sr_image *image;
    struct sr_error error = {0};
    void *bytes;
    size_t size;
    if (sr_render_image(film, true, job.replicates > 0, &image, &error) != SR_OK ||
        sr_image_encode(".exr", image, NULL, &bytes, &size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    uint64_t hash = sr_hash_bytes(bytes, size, 1);
    sr_free(bytes);
    sr_image_free(image);
    sr_film_destroy(film);
    return hash;
}

static void expect_one_hash(const char *integrator, uint32_t replicates)
{
    struct sr_import_result scene;
    struct sr_error error = {0};
    struct sr_import_options options = {.width = 70, .height = 50, .spp = 8, .integrator = integrator};
    if (!import_scene(SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt", &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.replicates = replicates;
    uint64_t one = hash_of(job, 1, 16);
    static const int threads[] = {1, 2, 3, 7}, tiles[] = {5, 8, 16, 64};
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            EXPECT(hash_of(job, threads[i], tiles[k]) == one);
    job.seed += 1;
    EXPECT(hash_of(job, 2, 16) != one); // another seed is another picture: the hash can tell
    sr_import_result_free(&scene);
}

TEST(bytes_do_not_depend_on_threads_or_tiles)
{
    expect_one_hash(NULL, 0);
}

TEST(bytes_of_replicates_do_not_depend_on_threads_or_tiles)
{
    expect_one_hash(NULL, 4);
}

TEST(bytes_of_media_do_not_depend_on_threads_or_tiles)
{
    struct sr_import_result scene;
    struct sr_error error = {0};
    struct sr_import_options options = {.width = 64, .height = 40, .spp = 8};
    if (!import_scene(test_reference_file("scenes/spotfog/spotfog.ref.pbrt"), &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    EXPECT_EQUAL_TEXT(job.integrator.model->name, "volpath");
    uint64_t one = hash_of(job, 1, 16);
    EXPECT(hash_of(job, 2, 5) == one && hash_of(job, 3, 64) == one && hash_of(job, 7, 8) == one);
    job.seed += 1;
    EXPECT(hash_of(job, 2, 16) != one);
    sr_import_result_free(&scene);
}

TEST(bytes_of_splats_do_not_depend_on_threads_or_tiles)
{
    expect_one_hash("lightpath", 0);
    expect_one_hash("bdpt", 4);
}

TEST(bytes_of_what_moves_do_not_depend_on_threads_or_tiles)
{
    struct sr_import_options options = {.width = 70, .height = 50, .spp = 8};
    struct sr_import_result scene;
    struct sr_error error = {0};
    if (!import_scene(
            scene_file(
                "moving.pbrt",
                "LookAt 0 0 -3.4  0 0 0  0 1 0 ActiveTransform EndTime Rotate 9 1 2 3 ActiveTransform All Camera \"perspective\"\n"
                "Film \"rgb\" \"string filename\" \"a.exr\" WorldBegin LightSource \"infinite\"\n"
                "ActiveTransform EndTime Rotate 50 2 -1 1 Translate .3 .2 .1 ActiveTransform All\n"
                "Translate .1 0 0 Scale .5 .6 .7 Shape \"sphere\" Shape \"cylinder\" \"float radius\" 1.2\n"),
            &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    uint64_t one = hash_of(job, 1, 16);
    EXPECT(hash_of(job, 2, 8) == one && hash_of(job, 3, 64) == one && hash_of(job, 7, 5) == one);
    sr_import_result_free(&scene);
}

TEST(one_sample_alone_is_what_the_render_added)
{
    struct sr_import_result scene;
    struct sr_error error = {0};
    struct sr_import_options options = {.width = 16, .height = 16, .spp = 4};
    if (!import_scene(SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt", &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    struct sr_render_report report;
    struct sr_film *film = render_or_fail(&job, &report);
    struct sr_worker worker = {0};
    for (uint32_t y = 0; y < 16; y += 5)
        for (uint32_t x = 0; x < 16; x += 3) {
            double sum[3] = {0}, mean[3];
            for (uint32_t i = 0; i < 4; ++i) {
                float rgb[3];
                EXPECT(sr_render_sample(&job, x, y, 0, i, rgb, NULL, &worker));
                for (int c = 0; c < 3; ++c)
                    sum[c] += (double)rgb[c];
            }
            sr_film_pixel_mean(film, x, y, mean);
            for (int c = 0; c < 3; ++c)
                EXPECT(mean[c] == sum[c] / 4);
        }
    sr_film_destroy(film);
    sr_import_result_free(&scene);
}

/* No allocation after the start: twice the samples, the same number of calls. */
static void expect_no_allocation(const char *integrator)
{
    struct sr_import_result scene;
    struct sr_error error = {0};
    struct sr_import_options options = {.width = 32, .height = 32, .spp = 4, .integrator = integrator};
    if (!import_scene(SR_TEST_SOURCE_DIR "/scenes/cornell-box.pbrt", &options, &scene, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    struct sr_render_job job = sr_render_job_of(&scene);
    uint64_t calls[2];
    for (int i = 0; i < 2; ++i) {
        job.spp = i ? 32 : 4;
        struct sr_render_report report;
        uint64_t before = sr_alloc_count();
        sr_film_destroy(render_or_fail(&job, &report));
        calls[i] = sr_alloc_count() - before;
    }
    EXPECT_EQUAL_INT(calls[1], calls[0]);
    sr_import_result_free(&scene);
}

TEST(samples_allocate_nothing)
{
    expect_no_allocation(NULL);
    expect_no_allocation("lightpath");
    expect_no_allocation("bdpt");
}
