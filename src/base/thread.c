/* SPDX-License-Identifier: MIT */
/* Threads: POSIX, started for one piece of work and joined; and the clock. */
#define _GNU_SOURCE
#include "base/base.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif
#if defined(__linux__)
#include <sched.h>
#endif

enum { MAX_THREADS = 1024 };

int sr_thread_count(void)
{
#if defined(__linux__)
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        return CPU_COUNT(&set);
#endif
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (int)n : 1;
}

static uint64_t float_mode(void)
{
    uint64_t mode = 0;
#if defined(__x86_64__)
    mode = _mm_getcsr();
#elif defined(__aarch64__)
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
#endif
    return mode;
}

static void set_float_mode(uint64_t mode)
{
#if defined(__x86_64__)
    _mm_setcsr((unsigned)mode);
#elif defined(__aarch64__)
    __asm__ volatile("msr fpcr, %0" ::"r"(mode));
#else
    (void)mode;
#endif
}

/* Denormals cost a hundred cycles each and carry no light; Embree expects them flushed as well. */
static void flush_denormals(void)
{
#if defined(__x86_64__)
    set_float_mode(float_mode() | 0x8040u); // FTZ, DAZ
#elif defined(__aarch64__)
    set_float_mode(float_mode() | 1ull << 24); // FZ
#endif
}

struct start {
    void (*work)(void *context, int thread);
    void *context;
    int thread;
};

static void *begin(void *p)
{
    struct start *s = p;
    flush_denormals();
    s->work(s->context, s->thread);
    return NULL;
}

void sr_parallel(int threads, void (*work)(void *context, int thread), void *context)
{
    if (threads > MAX_THREADS)
        threads = MAX_THREADS;
    pthread_t ids[MAX_THREADS];
    struct start starts[MAX_THREADS];
    int started = 0;
    for (int i = 0; i < threads; ++i) {
        starts[started] = (struct start){work, context, i};
        if (pthread_create(&ids[started], NULL, begin, &starts[started]) != 0)
            break;
        ++started;
    }
    uint64_t mode = float_mode();
    for (int i = started; i < threads; ++i) // no more threads to be had: do their part here
        begin(&(struct start){work, context, i});
    set_float_mode(mode); // the caller's own
    for (int i = 0; i < started; ++i)
        pthread_join(ids[i], NULL);
}

struct counted {
    void (*work)(void *context, uint64_t i);
    void *context;
    atomic_ullong next;
    uint64_t count;
};

static void take(void *context, int thread)
{
    (void)thread;
    struct counted *c = context;
    for (;;) {
        uint64_t i = atomic_fetch_add_explicit(&c->next, 1, memory_order_relaxed);
        if (i >= c->count)
            return;
        c->work(c->context, i);
    }
}

void sr_parallel_for(int threads, uint64_t count, void (*work)(void *context, uint64_t i), void *context)
{
    struct counted c = {.work = work, .context = context, .count = count};
    if ((uint64_t)threads > count)
        threads = (int)count;
    sr_parallel(threads, take, &c);
}

static double read_clock_s(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double sr_clock_s(void)
{
    return read_clock_s(CLOCK_MONOTONIC);
}

double sr_cpu_s(void)
{
    return read_clock_s(CLOCK_PROCESS_CPUTIME_ID);
}

uint64_t sr_peak_memory_B(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
#if defined(__APPLE__)
    return (uint64_t)usage.ru_maxrss;
#else
    return (uint64_t)usage.ru_maxrss * 1024;
#endif
}
