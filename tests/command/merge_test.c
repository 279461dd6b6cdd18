/* SPDX-License-Identifier: MIT */
/* Parts of a picture by the command: files to the last byte, and what is refused, with what is told. */
#define _POSIX_C_SOURCE 200809L
#include "run.h"

#include "base/base.h"

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define SMALL " --resolution 32,24 --spp 22 -q "

static char *bytes_of(const char *name, size_t *size)
{
    struct sr_error error = {0};
    char *data, path[600];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    if (sr_file_read(path, 1u << 30, &data, size, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return data;
}

static void expect_same_file(const char *a, const char *b)
{
    size_t size_a, size_b;
    char *data_a = bytes_of(a, &size_a), *data_b = bytes_of(b, &size_b);
    if (size_a != size_b || memcmp(data_a, data_b, size_a) != 0)
        test_fail(__FILE__, __LINE__, "%s and %s are not the same", a, b);
    sr_free(data_a);
    sr_free(data_b);
}

TEST(merged_files_are_those_of_one_render)
{
    run_expecting(0, "render " CORNELL SMALL "-o whole.exr -o whole.png -o whole.pfm -o whole.hdr --threads 2");
    run_expecting(0, "render " CORNELL SMALL "-o a.srp --sample-range 0-7 --threads 1");
    run_expecting(0, "render " CORNELL SMALL "-o b.srp --sample-range 7-8 --threads 3 --tile 5");
    run_expecting(0, "render " CORNELL SMALL "-o c.srp --sample-range 8-22 --tile 31");
    run_expecting(0, "merge c.srp a.srp b.srp -q -o merged.exr -o merged.png -o merged.pfm -o merged.hdr");
    expect_same_file("whole.exr", "merged.exr");
    expect_same_file("whole.png", "merged.png");
    expect_same_file("whole.pfm", "merged.pfm");
    expect_same_file("whole.hdr", "merged.hdr");
    run_expecting(0, "merge c.srp a.srp -q -o larger.srp");
    EXPECT_SAYS(run_expecting(0, "info larger.srp")->out, "samples 0-7, 8-22 of 0-22 of each pixel");
    json_t *j = json_of(run_expecting(0, "info larger.srp --json"));
    EXPECT_EQUAL_INT(json_array_size(json_object_get(j, "samples")), 2);
    EXPECT_EQUAL_INT(json_integer_value(json_object_get(j, "spp")), 22);
    json_decref(j);
    run_expecting(0, "merge b.srp larger.srp -q -o twice.exr");
    expect_same_file("whole.exr", "twice.exr");
    EXPECT_EQUAL_INT(count_files(".part-"), 0);
    EXPECT_EQUAL_INT(count_files(".srp.new"), 0);
}

TEST(even_parts_by_number_cover_all_samples)
{
    run_expecting(0, "render " CORNELL SMALL "-o whole.exr --replicates 11 --pixelbounds 3,20,4,19 --seed 9");
    for (int k = 1; k <= 4; ++k) {
        char text[400];
        snprintf(text, sizeof text,
                 "render " CORNELL SMALL "--replicates 11 --pixelbounds 3,20,4,19 --seed 9 --part %d/4 -o p%d.srp", k,
                 k);
        run_expecting(0, text);
    }
    const struct said *s = run_expecting(0, "merge p1.srp p2.srp p3.srp p4.srp -o merged.exr --json");
    EXPECT_SAYS(s->err, "4 parts: 17 x 15 pixels, 22 of 22 samples each");
    json_t *j = json_of(s);
    EXPECT(json_is_true(json_object_get(j, "complete")) && json_array_size(json_object_get(j, "parts")) == 4 &&
           json_array_size(json_object_get(j, "missing")) == 0);
    EXPECT_EQUAL_TEXT(json_string_value(json_object_get(json_object_get(j, "identity"), "seed")), "9");
    EXPECT_EQUAL_INT(json_integer_value(json_object_get(json_object_get(j, "counts"), "paths")), 17 * 15 * 22);
    json_decref(j);
    expect_same_file("whole.exr", "merged.exr");
}

/* Whether it is killed after that checkpoint is there. */
static bool kill_when_kept(const char *arguments, const char *checkpoint)
{
    char path[600];
    snprintf(path, sizeof path, "%s/%s", test_folder(), checkpoint);
    pid_t pid = start(arguments);
    int how = 0;
    for (double start_s = sr_clock_s(); access(path, F_OK) != 0 && sr_clock_s() - start_s < TEST_FOREVER_S;) {
        if (waitpid(pid, &how, WNOHANG) == pid)
            return false;
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    }
    kill(pid, SIGKILL);
    EXPECT(waitpid(pid, &how, 0) == pid);
    return WIFSIGNALED(how) && access(path, F_OK) == 0;
}

/* Killed as soon as something is kept of it. */
TEST(a_part_that_was_killed_goes_on)
{
    char part[400], text[500];
    snprintf(part, sizeof part, "render " CORNELL " --resolution 40,40 --spp %d --sample-range %d-%d -q",
             is_slow_build() ? 40 : 400, 3, is_slow_build() ? 30 : 300);
    snprintf(text, sizeof text, "%s -o uncut.srp", part);
    run_expecting(0, text);
    snprintf(text, sizeof text, "%s -o killed.srp --checkpoint-interval 0.02 --threads 1", part);
    bool is_killed = false;
    for (int i = 0; i < 20 && !is_killed; ++i) // it may end before we look
        is_killed = kill_when_kept(text, "killed.srp.srk");
    EXPECT(is_killed);
    snprintf(text, sizeof text, "%s -o killed.srp --resume", part);
    run_expecting(0, text);
    expect_same_file("uncut.srp", "killed.srp");
    EXPECT_EQUAL_INT(count_files("killed.srp.srk"), 0);
}

TEST(missing_samples_are_told_and_may_be_allowed)
{
    run_expecting(0, "render " CORNELL SMALL "-o m1.srp --sample-range 3-7");
    run_expecting(0, "render " CORNELL SMALL "-o m2.srp --sample-range 10-20 -o look.exr");
    struct sr_image *look = get_image("look.exr");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(look, "steradian.complete"), "no");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(look, "steradian.samplesPerPixel"), "10");
    sr_image_free(look);
    const struct said *s = run_expecting(1, "merge m1.srp m2.srp -o none.exr");
    EXPECT_SAYS(s->err, "samples are missing: 0-3, 7-10, 20-22 of 0-22");
    EXPECT_EQUAL_INT(count_files("none.exr"), 0);
    run_expecting(0, "merge m1.srp m2.srp -q -o partial.exr --allow-missing");
    struct sr_image *partial = get_image("partial.exr");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(partial, "steradian.complete"), "no");
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(partial, "steradian.samplesPerPixel"), "14");
    sr_image_free(partial);
}

TEST(foreign_parts_are_refused_by_name)
{
    run_expecting(0, "render " CORNELL SMALL "-o f.srp --sample-range 0-11");
    static const struct {
        const char *options, *told;
    } foreign[] = {
        {"--seed 2", "its seed is \"2\", and there it is \"0\""},
        {"--spp 24", "its spp is \"24\", and there it is \"22\""},
        {"--no-aov", "its aov is \"no\", and there it is \"yes\""},
        {"--replicates 2", "its replicates is \"2\", and there it is \"0\""},
        {"--estimator bdpt", "its estimator is \"bdpt\", and there it is \"path\""},
        {"--units si", "its scene.units is \"si\", and there it is \"photometric\""},
        {"--lambda 400,700", "its lambda is \"400 700 nm\", and there it is \"360 830 nm\""},
        {"--resolution 32,23", "its film.size is \"32 23\", and there it is \"32 24\""},
        {"--sampler independent", "its sampler is "},
    };
    for (size_t i = 0; i < sizeof foreign / sizeof foreign[0]; ++i) {
        char text[400];
        snprintf(text, sizeof text, "render " CORNELL SMALL "-o g.srp --sample-range 11-22 %s", foreign[i].options);
        run_expecting(0, text);
        const struct said *s = run_expecting(3, "merge f.srp g.srp -o none.exr");
        EXPECT_SAYS(s->err, "g.srp: is of another picture than f.srp");
        EXPECT_SAYS(s->err, foreign[i].told);
    }
    put_file(
        "other.pbrt",
        "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 24\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n");
    run_expecting(0, "render other.pbrt --spp 22 -q -o g.srp --sample-range 11-22");
    EXPECT_SAYS(run_expecting(3, "merge f.srp g.srp -o none.exr")->err, "its scene.hash is ");
    EXPECT_EQUAL_INT(count_files("none.exr"), 0);
}

TEST(parts_that_overlap_are_refused)
{
    run_expecting(0, "render " CORNELL SMALL "-o o1.srp --sample-range 0-11");
    run_expecting(0, "render " CORNELL SMALL "-o o2.srp --sample-range 10-22");
    EXPECT_SAYS(run_expecting(3, "merge o1.srp o2.srp -o none.exr")->err,
                "o2.srp: has samples 10-22, of which o1.srp has 0-11 already");
    EXPECT_SAYS(run_expecting(3, "merge o1.srp o1.srp -o none.exr")->err, "o1.srp has 0-11 already");
    EXPECT_EQUAL_INT(count_files("none.exr"), 0);
}

TEST(damaged_parts_are_refused)
{
    run_expecting(0, "render " CORNELL SMALL "-o d1.srp --sample-range 0-11 --resolution 5,4");
    run_expecting(0, "render " CORNELL SMALL "-o d2.srp --sample-range 11-22 --resolution 5,4");
    size_t size;
    char *data = bytes_of("d2.srp", &size), path[600];
    snprintf(path, sizeof path, "%s/bad.srp", test_folder());
    struct sr_error error = {0};
    for (int i = 0; i < 24; ++i) {
        size_t at = size / 24 * (size_t)i + (size_t)(i * 7 % 24);
        data[at] = (char)(data[at] ^ 1 << i % 8);
        EXPECT(sr_file_write(path, data, size, &error) == SR_OK);
        EXPECT_SAYS(run_expecting(3, "merge d1.srp bad.srp -o none.exr")->err, "bad.srp");
        data[at] = (char)(data[at] ^ 1 << i % 8);
    }
    EXPECT(sr_file_write(path, data, size - 1, &error) == SR_OK);
    EXPECT_SAYS(run_expecting(3, "merge d1.srp bad.srp -o none.exr")->err, "bad.srp");
    EXPECT(sr_file_write(path, data, size, &error) == SR_OK);
    run_expecting(0, "merge d1.srp bad.srp -q -o good.exr");
    sr_free(data);
    EXPECT_SAYS(run_expecting(3, "merge d1.srp absent.srp -o none.exr")->err, "absent.srp");
    put_file("text.srp", "not a part");
    EXPECT_SAYS(run_expecting(3, "merge text.srp -o none.exr")->err, "text.srp");
    EXPECT_EQUAL_INT(count_files("none.exr"), 0);
}

TEST(options_of_parts_that_make_no_sense_are_told)
{
    static const struct {
        const char *options, *told;
    } wrong[] = {
        {"--sample-range 0-4 -o a.exr", "-o FILE.srp"},
        {"--sample-range 0-4", "-o FILE.srp"},
        {"-o wrong.srp", "wrong.srp: a part of a picture needs --sample-range or --part"},
        {"--sample-range 4-4 -o wrong.srp", "A < B was expected"},
        {"--sample-range 4 -o wrong.srp", "A-B"},
        {"--sample-range -1-4 -o wrong.srp", "A-B"},
        {"--sample-range 20-23 -o wrong.srp", "samples 0-22 of each pixel were expected"},
        {"--part 0/4 -o wrong.srp", "1 <= K <= N"},
        {"--part 5/4 -o wrong.srp", "1 <= K <= N"},
        {"--part 1/23 -o wrong.srp", "22 parts at most"},
        {"--part 1/2 --sample-range 0-4 -o wrong.srp", "once"},
        {"--part 1/2 --adaptive -o wrong.srp", "adaptive"},
        {"--part 1/2 --error 1% -o wrong.srp", "adaptive"},
        {"--part 1/2 --write-partial 5 -o wrong.srp", "--write-partial"},
        {"--part 1/2 --irradiance 0,0,0,0,1,0 -o wrong.srp", "--irradiance"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        char text[400];
        snprintf(text, sizeof text, "render " CORNELL SMALL "%s", wrong[i].options);
        EXPECT_SAYS(run_expecting(2, text)->err, wrong[i].told);
    }
    EXPECT_SAYS(run_expecting(2, "merge -o a.exr")->err, "parts of a picture were expected");
    EXPECT_SAYS(run_expecting(2, "merge wrong.srp")->err, "-o FILE");
    EXPECT_SAYS(run_expecting(2, "merge wrong.srp -o a.jpg")->err, "a.jpg");
    EXPECT_SAYS(run_expecting(4, "merge wrong.srp -o no/such/folder.exr")->err, "no/such/folder.exr");
    EXPECT_EQUAL_INT(count_files("wrong.srp"), 0);
}
