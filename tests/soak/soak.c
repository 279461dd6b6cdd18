/* SPDX-License-Identifier: MIT */
/* Rays whose answers are known, by the thousand million: sr_soak [rays [threads [watertight | self-hits | floors [first
 * body [last body]]]]].
 *
 * A leak is told with its body, aim and ray number, from which cast_from_inside makes the same ray again.
 * Of n trials without a fault the share of faults is below 3.0 / n with 95 % confidence (1 - 0.05^(1/n)). */
#include "truth/rays.h"

#include <inttypes.h>
#include <limits.h>

void test_fail(const char *file, int line, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    test_print_failure(file, line, format, arguments);
    va_end(arguments);
    exit(1);
}

enum { CHUNK = 1 << 14 };

struct run {
    const struct closed_mesh *mesh;
    int number;
    enum aim aim;
    const struct convex_surface *convex;
    const struct tilted_floor *floor;
    uint64_t rays, done, leaks, shadows, inward, missed;
};

static void chunk(void *context, uint64_t i)
{
    struct run *r = context;
    uint64_t begin = i * CHUNK, end = begin + CHUNK < r->rays ? begin + CHUNK : r->rays;
    if (r->mesh) {
        struct leaks l = cast_from_inside(r->mesh, r->aim, begin, end);
        __atomic_fetch_add(&r->done, l.rays, __ATOMIC_RELAXED);
        __atomic_fetch_add(&r->leaks, l.leaks, __ATOMIC_RELAXED);
        __atomic_fetch_add(&r->shadows, l.shadows, __ATOMIC_RELAXED);
        if (l.leaks + l.shadows)
            fprintf(stderr, "leak: body %d, %s, ray %" PRIu64 "\n", r->number, aim_names[r->aim], l.last);
    } else {
        struct self_hits h = r->floor ? leave_floor(r->floor, begin, end) : leave_convex(r->convex, begin, end);
        __atomic_fetch_add(&r->done, h.rays, __ATOMIC_RELAXED);
        __atomic_fetch_add(&r->leaks, h.hits, __ATOMIC_RELAXED);
        __atomic_fetch_add(&r->inward, h.inward, __ATOMIC_RELAXED);
        __atomic_fetch_add(&r->missed, h.missed, __ATOMIC_RELAXED);
    }
}

static void cast(struct run *r, uint64_t rays, int threads)
{
    r->rays = rays;
    sr_parallel_for(threads, (rays + CHUNK - 1) / CHUNK, chunk, r);
}

static uint64_t watertight(uint64_t rays, int threads, int first, int last)
{
    static const struct body_at {
        enum body body;
        double offset; // [radii]
        bool is_instance;
    } bodies[] = {{BODY_BALL, 0, 0},   {BODY_BALL, 1e3, 0},   {BODY_BALL, 1e5, 0},   {BODY_BALL, 1e7, 0},
                  {BODY_SPIKES, 0, 0}, {BODY_SPIKES, 1e3, 0}, {BODY_SPIKES, 1e5, 0}, {BODY_CUBE, 0, 0},
                  {BODY_CUBE, 1e3, 0}, {BODY_CUBE, 1e5, 0},   {BODY_BALL, 0, 1},     {BODY_SPIKES, 1e3, 1}};
    enum { N = sizeof bodies / sizeof *bodies };
    uint64_t faults = 0, all = 0;
    for (int i = first; i < N && i <= last; ++i) {
        const struct body_at *b = &bodies[i];
        struct closed_mesh m = make_closed_mesh(b->body, 160, 1, b->offset, b->is_instance);
        printf("%-6s %6" PRIu32 " triangles, at %5g radii%s: leaks", body_names[b->body], m.triangles, b->offset,
               b->is_instance ? ", instance" : "");
        uint64_t done = 0, shadows = 0;
        for (int aim = 0; aim < AIMS; ++aim) {
            struct run r = {.mesh = &m, .number = i, .aim = (enum aim)aim};
            cast(&r, rays / (N * AIMS), threads);
            printf(" %s %" PRIu64 ",", aim_names[aim], r.leaks);
            done += r.done, shadows += r.shadows, faults += r.leaks + r.shadows;
        }
        printf(" of visibility %" PRIu64 ", of %" PRIu64 " rays\n", shadows, done);
        fflush(stdout);
        all += done;
        free_closed_mesh(&m);
    }
    printf("watertight: %" PRIu64 " faults in %" PRIu64 " rays: a share below %.2g with 95 %% confidence\n", faults,
           all, faults ? 1.0 : 3.0 / (double)all);
    return faults;
}

static uint64_t self_hits(uint64_t rays, int threads)
{
    uint64_t faults = 0, all = 0;
    for (int kind = 0; kind < CONVEXES; ++kind)
        for (int is_instance = 0; is_instance < 2; ++is_instance) {
            uint64_t done = 0, hits = 0, inward = 0, missed = 0;
            for (int k = -6; k <= 6; ++k) {
                struct convex_surface s = make_convex((enum convex)kind, pow(10, k), is_instance);
                struct run r = {.convex = &s};
                cast(&r, rays / (CONVEXES * 26) / 4,
                     threads); // about half of the points meet the shape, each casts 8 rays
                done += r.done, hits += r.leaks, inward += r.inward, missed += r.missed;
                if (r.leaks + r.missed)
                    printf("  scale 1e%d: %" PRIu64 " hits of %" PRIu64 ", %" PRIu64 " misses\n", k, r.leaks, r.done,
                           r.missed);
                free_convex(&s);
            }
            printf("%s%s, 1e-6 to 1e6 m: %" PRIu64 " self-hits of %" PRIu64 " rays; inward %" PRIu64
                   " missed of %" PRIu64 "\n",
                   convex_names[kind], is_instance ? ", instance" : "", hits, done, missed, inward);
            fflush(stdout);
            all += done + inward, faults += hits + missed;
        }
    printf("self-hits: %" PRIu64 " faults in %" PRIu64 " rays: a share below %.2g with 95 %% confidence\n", faults, all,
           faults ? 1.0 : 3.0 / (double)all);
    return faults;
}

/* A floor has 8 rays of each of 10000 points. */
static uint64_t floors(uint64_t rays, int threads)
{
    const uint64_t points = 10000;
    uint64_t faults = 0, done = 0;
    for (uint64_t i = 0; done < rays; ++i) {
        struct tilted_floor f = make_floor(i / 2, i & 1, false);
        struct run r = {.floor = &f};
        cast(&r, points, threads);
        if (r.leaks)
            printf("  floor %" PRIu64 "%s: %" PRIu64 " hits of %" PRIu64 "\n", i / 2, i & 1 ? ", by pairs" : "",
                   r.leaks, r.done);
        done += r.done, faults += r.leaks;
        free_floor(&f);
    }
    printf("floors: %" PRIu64 " faults in %" PRIu64 " rays: a share below %.2g with 95 %% confidence\n", faults, done,
           faults ? 1.0 : 3.0 / (double)done);
    return faults;
}

int main(int argc, char **argv)
{
    uint64_t rays = argc > 1 ? strtoull(argv[1], NULL, 10) : 1000000000;
    int threads = argc > 2 ? atoi(argv[2]) : sr_thread_count();
    const char *what = argc > 3 ? argv[3] : "";
    uint64_t faults = 0;
    if (!*what || strcmp(what, "watertight") == 0)
        faults += watertight(rays, threads, argc > 4 ? atoi(argv[4]) : 0, argc > 5 ? atoi(argv[5]) : INT_MAX);
    if (!*what || strcmp(what, "self-hits") == 0)
        faults += self_hits(rays, threads);
    if (!*what || strcmp(what, "floors") == 0)
        faults += floors(rays, threads);
    return faults != 0;
}
