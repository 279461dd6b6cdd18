/* SPDX-License-Identifier: MIT */
/* The identity of a render: whatever changes the bytes changes it, and the difference is told by name. */
#include "render/render.h"
#include "test.h"

static const char small[] = "hash 0123\nunits si\n";

static struct sr_render_job ordinary(void)
{
    static struct {
        int32_t max_depth;
        float rest[16];
    } self = {.max_depth = 5};
    static struct {
        float fov[64];
    } sensor;
    const struct sr_integrator_model *path = sr_integrator_model_find("path");
    return (struct sr_render_job){.seed = 1,
                                  .spp = 16,
                                  .integrator = {path, &self},
                                  .sensor = {sr_sensor_models[0], &sensor},
                                  .film = {.width = 8, .height = 8, .x1 = 8, .y1 = 8, .exposure_time = 1, .iso = 100},
                                  .lambda = {360, 830}};
}

static void expect_differs(const char *a, const char *b, const char *key, const char *theirs, const char *ours)
{
    struct sr_render_difference d;
    EXPECT(sr_render_identity_differs(a, b, &d));
    EXPECT_EQUAL_TEXT(d.key, key);
    EXPECT_EQUAL_TEXT(d.theirs, theirs);
    EXPECT_EQUAL_TEXT(d.ours, ours);
}

TEST(what_makes_the_bytes_stands_in_the_identity)
{
    struct sr_arena arena = {0};
    struct sr_render_job job = ordinary();
    struct sr_render_difference d;
    const char *first = sr_render_identity(&arena, &job, small);
    EXPECT(first && strstr(first, "scene.hash 0123\nscene.units si\n") && strstr(first, "\nspp 16\n") &&
           strstr(first, "\nestimator.maxdepth 5\n"));
    job.threads = 7;
    job.tile = 3;
    EXPECT(!sr_render_identity_differs(first, sr_render_identity(&arena, &job, small), &d));
    job.spp = 64;
    expect_differs(first, sr_render_identity(&arena, &job, small), "spp", "16", "64");
    job = ordinary();
    job.film.x1 = 4;
    expect_differs(first, sr_render_identity(&arena, &job, small), "film.crop", "0 8 0 8", "0 4 0 8");
    job = ordinary();
    job.seed = 2;
    expect_differs(first, sr_render_identity(&arena, &job, small), "seed", "1", "2");
    job = ordinary();
    expect_differs(first, sr_render_identity(&arena, &job, "hash 0124\nunits si\n"), "scene.hash", "0123", "0124");
    job.adaptive = (struct sr_render_adaptive){.is_on = true};
    EXPECT(sr_render_identity_differs(first, sr_render_identity(&arena, &job, small), &d));
    sr_arena_free(&arena);
}

TEST(keys_that_only_one_has_are_differences)
{
    expect_differs("a 1\n", "a 1\nb 2\n", "b", "nothing", "2");
    expect_differs("a 1\nb 2 3\n", "a 1\n", "b", "2 3", "nothing");
    expect_differs("", "a 1\n", "a", "nothing", "1");
    struct sr_render_difference d;
    EXPECT(!sr_render_identity_differs("a 1\nab 2\n", "ab 2\na 1\n", &d)); // their order means nothing
}
