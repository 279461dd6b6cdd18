/* SPDX-License-Identifier: MIT */
/* When memory ends: of all allocations between the name of a scene and the file of its picture, each fails in a run of
 * its own. Whichever it is, the run ends with SR_ERROR_RESOURCE and a sentence, nothing is left allocated, and no file
 * is half written.
 *
 * Counted are the allocations of the library itself, those of zlib, libpng, OpenEXR and expat that are made through it,
 * and the blocks of Embree's. What other libraries take by malloc is asked for anew in malloc_test.c. */
#include "test.h"

#include "hostile/scenes.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

/* What a child tells about its runs. */
struct tally {
    uint64_t number, count, failures, tolerated;
    char what[4096];
};

static void complain(struct tally *t, const char *path, const char *what, const struct sr_error *error)
{
    snprintf(t->what, sizeof t->what, "%s, allocation %llu: %s: %s", path, (unsigned long long)t->number, what,
             error->text);
    _exit(1);
}

static void try_all(const char *path, uint64_t most, struct tally *t)
{
    char out[1024];
    struct sr_error error = {0};
    snprintf(out, sizeof out, "%s/out.exr", test_folder());
    if (hostile_render(path, out, &error) != SR_OK) // also fills what is made once
        complain(t, path, "does not render", &error);
    uint64_t live = sr_alloc_live(), before = sr_alloc_count();
    hostile_render(path, out, &error);
    t->count = sr_alloc_count() - before;
    if (sr_alloc_live() != live)
        complain(t, path, "leaves memory behind where nothing fails", &error);
    for (uint64_t k = 0; k < t->count; k += most ? t->count / most + 1 : 1) {
        unlink(out);
        error = (struct sr_error){0};
        t->number = k;
        alarm(TEST_FOREVER_S);
        sr_alloc_fail(k, 1);
        sr_status status = hostile_render(path, out, &error);
        sr_alloc_fail(0, 0);
        ++t->failures;
        t->tolerated += status == SR_OK;
        if (status != SR_OK && (status != SR_ERROR_RESOURCE || !error.text[0]))
            complain(t, path, "another end than SR_ERROR_RESOURCE", &error);
        if ((status == SR_OK) != sr_file_exists(out))
            complain(t, path, "a picture after a failure, or none after success", &error);
        if (sr_alloc_live() != live)
            complain(t, path, "memory is left behind", &error);
    }
    unlink(out);
    _exit(0);
}

static void try_scene(const char *path)
{
    struct tally *t = mmap(NULL, sizeof *t, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    EXPECT(t != MAP_FAILED);
    const char *effort = getenv("STERADIAN_TEST_EFFORT");
    uint64_t most = effort && atof(effort) >= 10 ? 0 : is_slow_build() ? 4 : 15; // all: half an hour
    fflush(NULL);
    pid_t pid = fork();
    if (pid == 0) {
        const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM};
        for (size_t i = 0; i < sizeof signals / sizeof *signals; ++i) // the test library would go on with the next test
            signal(signals[i], SIG_DFL);
        try_all(path, most, t);
    }
    int status;
    EXPECT(waitpid(pid, &status, 0) == pid);
    if (WIFSIGNALED(status))
        test_fail(__FILE__, __LINE__, "%s, allocation %llu: signal %d", path, (unsigned long long)t->number,
                  WTERMSIG(status));
    if (WEXITSTATUS(status) != 0)
        test_fail(__FILE__, __LINE__, "%s", t->what[0] ? t->what : path);
    printf("[   NOTE   ] %s: %llu allocations, %llu made to fail, %llu of them did not matter\n",
           strrchr(path, '/') + 1, (unsigned long long)t->count, (unsigned long long)t->failures,
           (unsigned long long)t->tolerated);
    munmap(t, sizeof *t);
}

TEST(each_allocation_of_a_scene_with_everything_may_fail)
{
    try_scene(hostile_scene("scene.pbrt"));
}

TEST(each_allocation_of_a_lens_may_fail)
{
    try_scene(hostile_scene("lens.pbrt"));
}

TEST(each_allocation_of_the_estimators_may_fail)
{
    static const char *const names[] = {"path", "bdpt", "sppm", "lightpath", "ambientocclusion", "randomwalk"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i)
        try_scene(hostile_estimator(names[i], ""));
    try_scene(hostile_estimator("guidedpath", "\"string guiding\" \"on\""));
    try_scene(hostile_estimator("roulettepath", "\"string learned\" \"on\""));
}

TEST(each_allocation_of_other_formats_may_fail)
{
    static const char *const names[] = {"model.gltf", "model.glb", "model.obj", "model.stl", "model.ply"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i)
        try_scene(hostile_scene(names[i]));
}
