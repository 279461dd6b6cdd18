/* SPDX-License-Identifier: MIT */
/* Benchmarks: named cases, one line of JSON each; ratios come from one run.
 *
 * For each case, medians of several runs of
 *   paths/s of one thread and of all threads, rays/s, the efficiency of all threads, and that of rays alone (what the
 *   machine gives: caches and clocks are shared),
 *   ray-replay efficiency eta = (time of the bare ray caster for the very rays of the render) / (time of the render),
 *   shares of wasted work: scattering vertices without a shadow ray (mirrors among them), and shadow rays that are
 * blocked, time to read, to build the acceleration structure, from nothing to a first sample of each pixel; peak
 * memory. Each case runs in a process of its own, so that its peak memory is its own. --bsdf times the scattering
 * models instead. */
#include "bsdf_bench.h"
#include "scale_bench.h"
#include "targets.h"
#include "import/import.h"
#include "render/render.h"

#include <getopt.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const cases[] = {"cornell", "mesh", "glossy", "emitters"};
enum { CASES = sizeof cases / sizeof cases[0], MAX_RUNS = 15 };

struct settings {
    const char *folder, *only, *scene;
    uint32_t spp, size, seed;
    int runs;
};

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *v, int n)
{
    qsort(v, (size_t)n, sizeof *v, by_value);
    return v[n / 2];
}

static void warn(void *user, enum sr_severity severity, const char *text)
{
    (void)user;
    if (severity == SR_WARNING)
        fprintf(stderr, "warning: %s\n", text);
}

static double timed_render(const struct sr_render_job *job, int threads, struct sr_render_report *report)
{
    struct sr_render_job one = *job;
    one.threads = threads;
    struct sr_error error = {0};
    struct sr_film *film;
    if (sr_render(&one, &film, report, &error) != SR_OK) {
        fprintf(stderr, "sr_bench: %s\n", error.text);
        exit(1);
    }
    sr_film_destroy(film);
    return report->render_s;
}

struct replay {
    const struct sr_scene *scene;
    const struct sr_ray_log *log;
    atomic_ullong met; // keeps the rays from being optimised away
};

static void replay(void *context, int thread)
{
    (void)thread;
    struct replay *r = context;
    atomic_fetch_add(&r->met, sr_scene_replay(r->scene, r->log));
}

/* The rays of a render by the bare ray caster: all of them by each of so many threads. */
static double timed_replay(const struct sr_scene *scene, const struct sr_ray_log *log, int threads)
{
    struct replay r = {.scene = scene, .log = log};
    double start = sr_clock_s();
    sr_parallel(threads, replay, &r);
    return sr_clock_s() - start;
}

/* From nothing to one sample of each pixel. */
static double time_to_first_pixel(const struct sr_render_job *job, double start_s)
{
    struct sr_render_job first = *job;
    struct sr_render_report report;
    first.spp = 1;
    timed_render(&first, sr_thread_count(), &report);
    return sr_clock_s() - start_s;
}

/* Shadow rays that meet something, for nothing. Reorders the log. */
static uint64_t blocked_rays(const struct sr_scene *scene, const struct sr_ray_log *log)
{
    struct sr_ray_log shadows = {.rays = log->rays};
    for (uint64_t i = 0; i < log->count; ++i)
        if (log->rays[i].is_shadow)
            shadows.rays[shadows.count++] = log->rays[i];
    return sr_scene_replay(scene, &shadows);
}

static int run_case(const struct settings *s, const char *name, const char *path)
{
    double start_s = sr_clock_s();
    struct sr_import_options options = {.spp = s->spp, .width = s->size, .height = s->size};
    struct sr_log log = {.write = warn};
    struct sr_error error = {0};
    struct sr_import_result scene;
    if (sr_import_pbrt(path, &options, &scene, &log, &error) != SR_OK) {
        fprintf(stderr, "sr_bench: %s\n", error.text);
        return 1;
    }
    struct sr_scene_counts counts = sr_scene_count(scene.scene);
    struct sr_render_job job = sr_render_job_of(&scene);
    job.seed = s->seed;
    double first_pixel_s = time_to_first_pixel(&job, start_s);
    struct sr_render_report report;
    timed_render(&job, 1, &report); // warms the caches, and tells how many rays there are
    uint64_t peak_B = sr_peak_memory_B();
    int threads = sr_thread_count();
    struct sr_ray_log rays = {.capacity = report.rays + report.shadow_rays};
    rays.rays = sr_alloc(rays.capacity * sizeof *rays.rays);
    if (!rays.rays)
        return 1;
    job.log = &rays;
    timed_render(&job, 1, &report);
    job.log = NULL;

    double one[MAX_RUNS], all[MAX_RUNS], bare[MAX_RUNS], bare_all[MAX_RUNS];
    for (int i = 0; i < s->runs; ++i) { // in turn, so that a drift of the machine's speed meets all
        one[i] = timed_render(&job, 1, &report);
        all[i] = timed_render(&job, threads, &report);
        bare[i] = timed_replay(scene.scene, &rays, 1);
        bare_all[i] = timed_replay(scene.scene, &rays, threads);
    }
    double spread = 0, t_one = median(one, s->runs), t_all = median(all, s->runs), t_bare = median(bare, s->runs),
           t_bare_all = median(bare_all, s->runs);
    spread = (one[s->runs - 1] - one[0]) / t_one;
    double n_rays = (double)(report.rays + report.shadow_rays), n_shadow = (double)report.shadow_rays;
    double unlit = 1 - n_shadow / (double)report.vertices,
           blocked = n_shadow > 0 ? (double)blocked_rays(scene.scene, &rays) / n_shadow : 0;
    printf(
        "{\"case\": \"%s\", \"width\": %d, \"height\": %d, \"spp\": %u, \"runs\": %d, \"spread\": %.3f, \"paths_per_s_1\": %.0f, \"paths_per_s\": %.0f, "
        "\"threads\": %d, \"thread_efficiency\": %.3f, \"bare_thread_efficiency\": %.3f, \"rays_per_s_1\": %.0f, \"rays_per_path\": %.3f, \"shadow_rays_per_path\": %.3f, \"unlit_vertices\": %.3f, \"blocked_shadow_rays\": %.3f, \"eta\": %.3f, "
        "\"bare_ns_per_ray\": %.1f, \"read_s\": %.3f, \"build_s\": %.3f, \"first_pixel_s\": %.3f, \"peak_memory_B\": %llu, \"triangles\": %llu}\n",
        name, scene.film.width, scene.film.height, scene.spp, s->runs, spread, (double)report.paths / t_one,
        (double)report.paths / t_all, threads, t_one / (t_all * threads), t_bare / t_bare_all, n_rays / t_one,
        (double)report.rays / (double)report.paths, n_shadow / (double)report.paths, unlit, blocked, t_bare / t_one,
        1e9 * t_bare / n_rays, scene.read_s, counts.build_s, first_pixel_s, (unsigned long long)peak_B,
        (unsigned long long)counts.triangles);
    sr_free(rays.rays);
    sr_import_result_free(&scene);
    return 0;
}

/* Reading and building alone, of real scenes; the rows of docs/performance.md. */
static const char *const large_scenes[] = {"bathroom/scene-v4", "staircase2/scene-v4", "coffee/scene-v4",
                                           "teapot-full/scene-v4", "metal-instances/metal"};

static int run_load(const char *name, const char *path)
{
    struct sr_import_options options = {.spp = 1, .width = 8, .height = 8};
    struct sr_log log = {.write = warn};
    struct sr_error error = {0};
    struct sr_import_result scene;
    double start_s = sr_clock_s();
    if (sr_import_pbrt(path, &options, &scene, &log, &error) != SR_OK) {
        fprintf(stderr, "sr_bench: %s\n", error.text);
        return 1;
    }
    double load_s = sr_clock_s() - start_s;
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    double cpu_s = (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec; // of all threads
    struct sr_scene_counts counts = sr_scene_count(scene.scene);
    uint64_t peak_B = sr_peak_memory_B();
    struct sr_render_job job = sr_render_job_of(&scene);
    double first_pixel_s = time_to_first_pixel(&job, start_s);
    printf(
        "{\"case\": \"load %s\", \"load_s\": %.3f, \"cpu_s\": %.3f, \"read_s\": %.3f, \"build_s\": %.3f, \"first_pixel_s\": %.3f, \"threads\": %d, \"peak_memory_B\": %llu, \"triangles\": %llu}\n",
        name, load_s, cpu_s, scene.read_s, counts.build_s, first_pixel_s, sr_thread_count(), (unsigned long long)peak_B,
        (unsigned long long)counts.triangles);
    sr_import_result_free(&scene);
    return 0;
}

/* A case in a process of its own, which prints its line; the line, too, is kept. */
static json_t *lines[CASES + sizeof large_scenes / sizeof *large_scenes];
static size_t line_count;

static int run_apart(const struct settings *s, const char *name, const char *path)
{
    int ends[2];
    if (pipe(ends) != 0)
        return 1;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        exit(s ? run_case(s, name, path) : run_load(name, path));
    }
    close(ends[1]);
    char line[4096];
    FILE *from = fdopen(ends[0], "r");
    while (from && fgets(line, sizeof line, from)) {
        fputs(line, stdout);
        json_t *object = json_loads(line, 0, NULL);
        if (object && line_count < sizeof lines / sizeof *lines)
            lines[line_count++] = object;
        else
            json_decref(object);
    }
    if (from)
        fclose(from);
    int status = 1;
    return child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status) ? 1 : WEXITSTATUS(status);
}

static int load_apart(const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/scenes/%s.pbrt", SR_BENCH_REFERENCE_DIR, name);
    if (sr_file_exists(path))
        return run_apart(NULL, name, path);
    fprintf(stderr, "sr_bench: %s is not there: left out\n", path);
    return 0;
}

static bool make_scenes(const char *folder)
{
    char path[4096], command[9000];
    snprintf(path, sizeof path, "%s/emitters.pbrt", folder);
    if (sr_file_exists(path))
        return true;
    snprintf(command, sizeof command, "python3 '%s/bench/make-scenes' '%s'", SR_BENCH_SOURCE_DIR, folder);
    return system(command) == 0;
}

int main(int argc, char **argv)
{
    static const struct option options[] = {
        {"case", required_argument, NULL, 'c'}, {"scene", required_argument, NULL, 'f'},
        {"spp", required_argument, NULL, 's'},  {"size", required_argument, NULL, 'z'},
        {"runs", required_argument, NULL, 'r'}, {"folder", required_argument, NULL, 'd'},
        {"bsdf", optional_argument, NULL, 'b'}, {"scale", optional_argument, NULL, 'g'},
        {"draw", required_argument, NULL, 'w'}, {"figure", required_argument, NULL, 'i'},
        {"help", no_argument, NULL, 'h'},       {NULL, 0, NULL, 0},
    };
    struct settings s = {.folder = SR_BENCH_BUILD_DIR "/bench-scenes", .spp = 16, .size = 256, .runs = 3, .seed = 1};
    const char *scale = NULL, *figure = NULL, *draw = NULL;
    int option;
    while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1)
        switch (option) {
        case 'c':
            s.only = optarg;
            break;
        case 'f':
            s.scene = optarg;
            break;
        case 's':
            s.spp = (uint32_t)strtoul(optarg, NULL, 10);
            break;
        case 'z':
            s.size = (uint32_t)strtoul(optarg, NULL, 10);
            break;
        case 'r':
            s.runs = (int)strtol(optarg, NULL, 10);
            break;
        case 'd':
            s.folder = optarg;
            break;
        case 'b':
            return bench_bsdfs(optarg);
        case 'g':
            scale = optarg ? optarg : "";
            break;
        case 'w':
            draw = optarg;
            break;
        case 'i':
            figure = optarg;
            break;
        default:
            printf(
                "Usage: sr_bench --bsdf[=MODEL]\n       sr_bench --scale[=triangles|lights|depth|pixels|wavelengths|threads] [--runs N]\n       sr_bench --draw LINES-OF-SCALE [--figure FILE.svg|.png]\n       sr_bench [--case cornell|mesh|glossy|emitters|load] [--scene FILE] [--spp N] [--size PIXELS] [--runs N] [--folder SCENES]\n");
            return option == 'h' ? 0 : 2;
        }
    if (draw)
        return bench_scale_draw(draw, figure);
    s.runs = s.runs < 1 ? 1 : s.runs > MAX_RUNS ? MAX_RUNS : s.runs;
    if (s.scene)
        return run_apart(&s, s.scene, s.scene);
    if (!make_scenes(s.folder)) {
        fprintf(stderr, "sr_bench: the scenes cannot be made in %s\n", s.folder);
        return 1;
    }
    if (scale)
        return bench_scale(*scale ? scale : NULL, s.folder, s.runs);
    int failed = 0;
    for (int i = 0; i < CASES; ++i) {
        if (s.only && strcmp(s.only, cases[i]) != 0)
            continue;
        char path[4096];
        snprintf(path, sizeof path, "%s/%s.pbrt", s.folder, cases[i]);
        failed |= run_apart(&s, cases[i], path);
    }
    for (size_t i = 0; i < sizeof large_scenes / sizeof *large_scenes && (!s.only || strcmp(s.only, "load") == 0); ++i)
        failed |= load_apart(large_scenes[i]);
    print_targets(stderr, lines, line_count);
    for (size_t i = 0; i < line_count; ++i)
        json_decref(lines[i]);
    return failed;
}
