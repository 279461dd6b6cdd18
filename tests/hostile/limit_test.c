/* SPDX-License-Identifier: MIT */
/* The command under limits of its address space (ulimit -v), from nothing to plenty: it ends with a picture, or with a
 * message and without one. */
#define _GNU_SOURCE
#include "test.h"

#include "hostile/scenes.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static int run(const char *scene, const char *out, const char *words, size_t limit_B)
{
    int status;
    fflush(NULL);
    pid_t pid = fork();
    if (pid == 0) {
        int file = open(words, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        struct rlimit r = {limit_B, limit_B};
        dup2(file, 1);
        dup2(file, 2);
        alarm(TEST_FOREVER_S);
        setrlimit(RLIMIT_AS, &r);
        execl(SR_TEST_COMMAND, SR_TEST_COMMAND, "render", scene, "--spp", "1", "--threads", "2", "--out", out,
              (char *)NULL);
        _exit(126);
    }
    EXPECT(waitpid(pid, &status, 0) == pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(the_command_ends_well_under_any_limit_of_memory)
{
    if (is_slow_build())
        test_skip("sanitizers need the space");
    char out[1024], words[1024];
    const char *scene = hostile_scene("scene.pbrt");
    int pictures = 0, refusals = 0;
    snprintf(out, sizeof out, "%s/limited.png", test_folder());
    snprintf(words, sizeof words, "%s/words.txt", test_folder());
    for (size_t limit = 60; limit < 900; limit += limit / 5) {
        char *text;
        size_t size;
        struct sr_error error = {0};
        unlink(out);
        int code = run(scene, out, words, limit << 20);
        if (code == 127) // the loader of libraries found no room, before the program began
            continue;
        EXPECT(sr_file_read(words, 1 << 20, &text, &size, &error) == SR_OK);
        if (code != 0 && code != 4)
            test_fail(__FILE__, __LINE__, "%zu MiB: code %d, %.*s", limit, code, (int)size, text);
        EXPECT(code == 0 || size > 0);
        EXPECT_EQUAL_INT(sr_file_exists(out), code == 0);
        pictures += code == 0;
        refusals += code == 4;
        sr_free(text);
    }
    printf("[   NOTE   ] %d pictures, %d refusals\n", pictures, refusals);
    EXPECT(pictures > 0);
    unlink(words);
    unlink(out);
}
