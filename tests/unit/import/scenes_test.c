/* SPDX-License-Identifier: MIT */
/* Every scene of the reference folder is read completely. */
#define _XOPEN_SOURCE 700
#include "import/import.h"
#include "import/pbrt/description.h"
#include "test.h"

#include <ftw.h>

static char paths[256][512];
static int path_count;

static int note_scene(const char *path, const struct stat *st, int type, struct FTW *where)
{
    (void)st;
    (void)where;
    bool is_part = strstr(path, "/geometry/") || strstr(path, "/models/"); // read by Include
    if (type == FTW_F && sr_path_has_ending(path, ".pbrt") && !is_part && path_count < 256)
        snprintf(paths[path_count++], sizeof paths[0], "%s", path);
    return 0;
}

TEST(every_reference_scene_is_read)
{
    const char *folder = test_reference_file("scenes");
    path_count = 0;
    EXPECT_EQUAL_INT(nftw(folder, note_scene, 16, FTW_PHYS), 0);
    EXPECT(path_count > 50);
    size_t shapes = 0, bytes = 0;
    double time_s = 0;
    for (int i = 0; i < path_count; ++i) {
        struct sr_arena data = {0};
        struct sr_pbrt_description d;
        struct sr_error e = {0};
        double start = sr_clock_s();
        if (sr_pbrt_read(paths[i], &data, NULL, &d, &e) != SR_OK)
            test_fail(__FILE__, __LINE__, "%s", e.text);
        time_s += sr_clock_s() - start;
        shapes += d.shapes.count;
        bytes += d.text_B;
        sr_pbrt_description_free(&d);
        sr_arena_free(&data);
    }
    printf("[   NOTE   ] %d scenes, %zu shapes, %.1f MB of text at %.0f MB/s\n", path_count, shapes,
           (double)bytes * 1e-6, (double)bytes * 1e-6 / time_s);
    EXPECT(shapes > 10000);
}

TEST(text_full_of_numbers_is_read_fast)
{
    struct sr_arena data = {0};
    struct sr_pbrt_description d;
    struct sr_error e = {0};
    const char *path = test_reference_file("scenes/killeroo/killeroo-gold.pbrt");
    double best = 0;
    for (int i = 0; i < 20; ++i) {
        double start = sr_clock_s();
        EXPECT_EQUAL_INT(sr_pbrt_read(path, &data, NULL, &d, &e), SR_OK);
        double rate = (double)d.text_B * 1e-6 / (sr_clock_s() - start);
        best = rate > best ? rate : best;
        sr_pbrt_description_free(&d);
        sr_arena_free(&data);
    }
    printf("[   NOTE   ] killeroo-gold: %.0f MB/s\n", best);
}

/* Cut at 200 places, each reference scene is read or refused with a reason. */
TEST(a_reference_scene_cut_anywhere_never_harms)
{
    const char *path = test_reference_file("scenes/features/shapes/all-shapes.pbrt");
    char *text;
    size_t size;
    struct sr_error e = {0};
    EXPECT_EQUAL_INT(sr_file_read(path, 1 << 20, &text, &size, &e), SR_OK);
    for (size_t i = 0; i < 200; ++i) {
        size_t n = size * i / 200;
        char *cut = malloc(n + 1);
        EXPECT(cut != NULL);
        memcpy(cut, text, n);
        cut[n] = 0;
        struct sr_arena data = {0};
        struct sr_pbrt_description d;
        e = (struct sr_error){0};
        sr_status status = sr_pbrt_read_text(path, cut, n, &data, NULL, &d, &e);
        EXPECT(status == SR_OK || (status == SR_ERROR_INPUT && e.text[0]));
        sr_pbrt_description_free(&d);
        sr_arena_free(&data);
        free(cut);
    }
    sr_free(text);
}

/* Every reference scene is finished, or what it asks for is not there yet, and the message says so. */
TEST(every_reference_scene_is_finished_or_clearly_refused)
{
    const char *folder = test_reference_file("scenes");
    path_count = 0;
    EXPECT_EQUAL_INT(nftw(folder, note_scene, 16, FTW_PHYS), 0);
    int finished = 0, refused = 0;
    double time_s = 0;
    for (int i = 0; i < path_count; ++i) {
        if (!strstr(paths[i], ".ref.pbrt"))
            continue;
        struct sr_import_result r;
        struct sr_error e = {0};
        double start = sr_clock_s();
        sr_status status = sr_import_pbrt(paths[i], NULL, &r, NULL, &e);
        time_s += sr_clock_s() - start;
        finished += status == SR_OK;
        refused += status != SR_OK;
        if (status != SR_OK && !strstr(e.text, "not supported yet"))
            test_fail(__FILE__, __LINE__, "%s", e.text);
        sr_import_result_free(&r);
    }
    printf("[   NOTE   ] %d finished, %d refused, %.2f s\n", finished, refused, time_s);
    EXPECT(finished >= 25);
}
