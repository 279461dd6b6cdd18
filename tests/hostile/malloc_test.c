/* SPDX-License-Identifier: MIT */
/* Allocations that libraries make by themselves (JSON, JPEG, streams of the C library, the ray caster's tasks): a
 * sample of them fails, one in each run. The run ends with a status and a sentence, or goes on; it does not crash,
 * hang, or leave anything of ours behind.
 *
 * malloc, calloc and realloc are this program's own, as a linker finds them first. Limits: with the GNU C library
 * alone, and not under sanitizers, which have their own. */
#include "test.h"

#include "hostile/scenes.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define IS_SANITIZED 1
#endif
#endif

#if defined(__GLIBC__) && !defined(IS_SANITIZED)

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *p, size_t size);

static atomic_ullong calls;
static atomic_ullong fails_at = UINT64_MAX; // number of the call

static bool is_allowed(void)
{
    bool is = atomic_fetch_add_explicit(&calls, 1, memory_order_relaxed) !=
              atomic_load_explicit(&fails_at, memory_order_relaxed);
    if (!is)
        errno = ENOMEM;
    return is;
}

void *malloc(size_t size)
{
    return is_allowed() ? __libc_malloc(size) : NULL;
}

void *calloc(size_t count, size_t size)
{
    return is_allowed() ? __libc_calloc(count, size) : NULL;
}

void *realloc(void *p, size_t size)
{
    return is_allowed() ? __libc_realloc(p, size) : NULL;
}

struct tally {
    uint64_t number, count, tried, ends[3]; // went on, refused for memory, refused otherwise
    char what[2048];
};

static void try_all(const char *path, uint64_t most, struct tally *t)
{
    char out[1024];
    struct sr_error error = {0};
    snprintf(out, sizeof out, "%s/out.png", test_folder());
    if (hostile_render(path, out, &error) != SR_OK)
        _exit(2);
    uint64_t live = sr_alloc_live(), before = atomic_load(&calls);
    hostile_render(path, out, &error);
    t->count = atomic_load(&calls) - before;
    for (uint64_t k = 0; k < t->count; k += most ? t->count / most + 1 : 1) {
        error = (struct sr_error){0};
        t->number = k;
        alarm(TEST_FOREVER_S);
        atomic_store(&fails_at, atomic_load(&calls) + k);
        sr_status status = hostile_render(path, out, &error);
        atomic_store(&fails_at, UINT64_MAX);
        ++t->tried;
        ++t->ends[status == SR_OK ? 0 : status == SR_ERROR_RESOURCE ? 1 : 2];
        if ((status == SR_OK) != (error.status == SR_OK) || (status != SR_OK && !error.text[0]) ||
            sr_alloc_live() != live) {
            snprintf(t->what, sizeof t->what, "status %d, \"%s\", %llu allocations left", (int)status, error.text,
                     (unsigned long long)(sr_alloc_live() - live));
            _exit(1);
        }
    }
    unlink(out);
    _exit(0);
}

TEST(allocations_of_libraries_may_fail)
{
    static const char *const names[] = {"scene.pbrt", "model.gltf", "model.glb", "model.obj"};
    const char *effort = getenv("STERADIAN_TEST_EFFORT");
    uint64_t most = effort && atof(effort) >= 10 ? 300 : 5;
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        struct tally *t = mmap(NULL, sizeof *t, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        EXPECT(t != MAP_FAILED);
        const char *path = hostile_scene(names[i]);
        fflush(NULL);
        pid_t pid = fork();
        if (pid == 0) {
            for (int s = 1; s < 32; ++s) // the test library would go on with the next test
                signal(s, SIG_DFL);
            try_all(path, most, t);
        }
        int status;
        EXPECT(waitpid(pid, &status, 0) == pid);
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
            test_fail(__FILE__, __LINE__, "%s, allocation %llu of %llu: %s %d %s", names[i],
                      (unsigned long long)t->number, (unsigned long long)t->count,
                      WIFEXITED(status) ? "code" : "signal", WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status),
                      t->what);
        printf(
            "[   NOTE   ] %s: %llu allocations of libraries, %llu made to fail: %llu did not matter, %llu ended for want of memory, %llu otherwise\n",
            names[i], (unsigned long long)t->count, (unsigned long long)t->tried, (unsigned long long)t->ends[0],
            (unsigned long long)t->ends[1], (unsigned long long)t->ends[2]);
        munmap(t, sizeof *t);
    }
}

#endif
