/* SPDX-License-Identifier: MIT */
/* Signals: what there is gets written; nothing half-written stays. */
#define _POSIX_C_SOURCE 200809L
#include "run.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

static void nap(double s)
{
    struct timespec t = {.tv_sec = (time_t)s, .tv_nsec = (long)((s - floor(s)) * 1e9)};
    nanosleep(&t, NULL);
}

static const char *in_folder(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    return path;
}

/* Sends the signal as soon as the file is there, and tells how long that took [s]; kills the render and fails when it
 * does not come. */
static double send_when_there(pid_t pid, int number, const char *file)
{
    double start_s = sr_clock_s();
    while (!sr_file_exists(in_folder(file))) {
        if (sr_clock_s() - start_s > TEST_FOREVER_S) {
            kill(pid, SIGKILL);
            test_fail(__FILE__, __LINE__, "%s never comes", file);
        }
        nap(0.02);
    }
    kill(pid, number);
    return sr_clock_s() - start_s;
}

static void expect_partial(const char *name)
{
    struct sr_image *image = get_image(name);
    EXPECT_EQUAL_INT(image->width, 256);
    EXPECT_EQUAL_TEXT(sr_image_get_attribute(image, "steradian.complete"), "no");
    sr_image_free(image);
    char beside[64];
    snprintf(beside, sizeof beside, "%s.part-", name);
    EXPECT_EQUAL_INT(count_files(beside), 0);
}

/* Minutes of work in units of milliseconds, on any number of processors: its first partial picture tells that it runs.
 */
#define LONG "render " CORNELL " --resolution 256,256 --spp 5000 --threads 2 "
#define STEADY LONG "--write-partial 0.1 -o "

static void expect_interrupted(int number, int code)
{
    remove_file("stopped.exr");
    remove_file("stopped.exr.srk");
    pid_t pid = start(STEADY "stopped.exr");
    double waited_s = send_when_there(pid, number, "stopped.exr"), sent_s = sr_clock_s();
    const struct said *s = finish(pid);
    EXPECT_EQUAL_INT(s->code, code);
    EXPECT(sr_clock_s() - sent_s < 20 + 20 * waited_s);
    EXPECT_SAYS(s->err, "interrupted; what there was has been written");
    EXPECT_SAYS(s->err, "--resume goes on from");
    EXPECT(sr_file_exists(in_folder("stopped.exr.srk")));
    expect_partial("stopped.exr");
}

TEST(signal_interrupt_writes_what_there_is)
{
    expect_interrupted(SIGINT, 130);
}

TEST(signal_terminate_writes_what_there_is)
{
    expect_interrupted(SIGTERM, 143);
}

/* What has been splatted cannot be taken back: the samples of a pixel that come in together must not take hours. */
TEST(signal_ends_paths_from_both_ends_at_any_number_of_samples)
{
    remove_file("endless.exr");
    remove_file("endless.exr.srk");
    pid_t pid =
        start("render " CORNELL " --resolution 16,16 --spp 1073741824 --threads 2 --estimator bdpt -q -o endless.exr");
    wait_until_caught(pid, SIGTERM);
    nap(0.3);
    kill(pid, SIGTERM);
    EXPECT_EQUAL_INT(finish(pid)->code, 143);
    EXPECT(sr_file_exists(in_folder("endless.exr.srk")));
}

/* The terminal or the connection has ended. */
TEST(signal_hangup_writes_what_there_is)
{
    signal(SIGHUP, SIG_DFL);
    expect_interrupted(SIGHUP, 129);
}

TEST(signal_hangup_does_not_matter_under_nohup)
{
    remove_file("stopped.exr");
    signal(SIGHUP, SIG_IGN); // children inherit it
    pid_t pid = start(STEADY "stopped.exr");
    signal(SIGHUP, SIG_DFL);
    send_when_there(pid, SIGHUP, "stopped.exr");
    nap(0.3);
    EXPECT_EQUAL_INT(kill(pid, 0), 0);
    remove_file("stopped.exr");
    send_when_there(pid, SIGTERM, "stopped.exr"); // another partial picture has come: it renders
    EXPECT_EQUAL_INT(finish(pid)->code, 143);
}

TEST(signal_a_second_one_ends_at_once)
{
    remove_file("twice.exr");
    pid_t pid = start(STEADY "twice.exr");
    send_when_there(pid, SIGSTOP, "twice.exr");
    kill(pid, SIGINT);
    kill(pid, SIGTERM);
    kill(pid, SIGCONT); // they come together, in either order
    const struct said *s = finish(pid);
    EXPECT(s->code == 130 || s->code == 143);
    EXPECT(!strstr(s->err, "what there was"));
    char beside[64];
    snprintf(beside, sizeof beside, "twice.exr.part-%d", (int)pid);
    remove_file(beside);
    remove_file("twice.exr.srk");
}

TEST(signal_interrupt_is_told_in_the_json)
{
    remove_file("told.exr");
    pid_t pid = start(STEADY "told.exr --json -q");
    send_when_there(pid, SIGINT, "told.exr");
    const struct said *s = finish(pid);
    EXPECT_EQUAL_INT(s->code, 130);
    json_t *j = json_of(s);
    EXPECT(json_is_false(json_object_get(j, "complete")));
    json_decref(j);
}

TEST(signal_request_writes_a_partial_picture_and_the_render_goes_on)
{
    remove_file("asked.exr");
    // no partial pictures but the one that is asked for
    pid_t pid = start(LONG "-o asked.exr");
    wait_until_caught(pid, SIGUSR1);
    for (double start_s = sr_clock_s();
         !sr_file_exists(in_folder("asked.exr")) && sr_clock_s() - start_s < TEST_FOREVER_S;) {
        kill(pid, SIGUSR1);
        nap(0.1);
    }
    sr_image_free(get_image("asked.exr")); // whole, though the render goes on
    nap(0.3);
    kill(pid, SIGINT); // so it is still there
    const struct said *s = finish(pid);
    EXPECT_EQUAL_INT(s->code, 130);
    EXPECT_SAYS(s->err, "written as it is now, ");
    expect_partial("asked.exr");
}

TEST(signal_request_never_kills)
{
    pid_t pid = start("render " CORNELL " --resolution 32,32 --spp 16 -o calm.exr");
    wait_until_caught(pid, SIGUSR1);
    for (int i = 0; i < 20; ++i) {
        kill(pid, SIGUSR1);
        nap(0.005);
    }
    EXPECT_EQUAL_INT(finish(pid)->code, 0);
}
