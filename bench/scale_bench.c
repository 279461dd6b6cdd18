/* SPDX-License-Identifier: MIT */
/* How time and memory grow with triangles, lights, depth, pixels, wavelengths and threads: one line of JSON for each
 * point; a figure and a table of such lines, which may come from builds for 4, 8 and 16 wavelengths (bench/scale).
 *
 * Each point runs in a process of its own, which makes its scene, reads it, renders it and tells through a pipe. */
#include "scale_bench.h"
#include "import/import.h"
#include "plot/plot.h"
#include "render/render.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_POINTS = 12 };

/* What is varied, and over which numbers. */
struct series {
    const char *name, *axis;
    bool (*scene)(const char *folder, uint64_t n, char *path, size_t size); // writes it
    int count;
    uint64_t at[MAX_POINTS];
};

struct point {
    double read_s, build_s, path_ns, paths_per_s, rays_per_path, memory_B;
    double variance; // [1] of one path, relative to the square of the picture's mean, over pixels and colours
};

/* ---- scenes ---- */

static const char head[] =
    "LookAt %s\nCamera \"perspective\" \"float fov\" 40\nSampler \"zsobol\"\nIntegrator \"path\" \"integer maxdepth\" 8\nWorldBegin\n"
    "Material \"diffuse\" \"rgb reflectance\" [0.6 0.55 0.5]\n";

static FILE *begin(const char *folder, const char *name, const char *look, char *path, size_t size)
{
    snprintf(path, size, "%s/scale-%s.pbrt", folder, name);
    FILE *f = fopen(path, "w");
    if (f)
        fprintf(f, head, look);
    return f;
}

/* A rippled square of 2 m^2 triangles under a sky and a lamp, by a binary PLY file beside. */
static bool triangles(const char *folder, uint64_t n, char *path, size_t size)
{
    FILE *f = begin(folder, "triangles", "0 -3.2 2.4  0 0 0  0 0 1", path, size);
    char ply[4096];
    snprintf(ply, sizeof ply, "%s/scale.ply", folder);
    FILE *mesh = fopen(ply, "wb");
    if (!f || !mesh)
        return false;
    fputs(
        "LightSource \"infinite\" \"rgb L\" [0.4 0.45 0.5]\nShape \"plymesh\" \"string filename\" \"scale.ply\"\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [12 11 10]\n"
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-2 -2 4  -2 -1 4  -1 -1 4  -1 -2 4]\n",
        f);
    int32_t side = (int32_t)lrint(sqrt((double)n / 2)), corners = side + 1;
    fprintf(
        mesh,
        "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
        "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
        corners * corners, 2 * side * side);
    for (int32_t j = 0; j < corners; ++j)
        for (int32_t i = 0; i < corners; ++i) {
            float x = 2 * (float)i / (float)side - 1, y = 2 * (float)j / (float)side - 1,
                  p[3] = {x, y, 0.1f * sinf(17 * x) * cosf(13 * y) + 0.02f * sinf(91 * x + 57 * y)};
            fwrite(p, sizeof p, 1, mesh);
        }
    for (int32_t j = 0; j < side; ++j)
        for (int32_t i = 0; i < side; ++i) {
            int32_t a = j * corners + i, face[2][3] = {{a, a + 1, a + corners}, {a + 1, a + corners + 1, a + corners}};
            for (int k = 0; k < 2; ++k) {
                fputc(3, mesh);
                fwrite(face[k], sizeof face[k], 1, mesh);
            }
        }
    bool is_good = !ferror(f) && !ferror(mesh), is_closed = fclose(f) == 0;
    return fclose(mesh) == 0 && is_closed && is_good;
}

static void room(FILE *f)
{
    fputs(
        "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3  4 5 6 4 6 7  8 9 10 8 10 11  12 13 14 12 14 15  16 17 18 16 18 19]\n"
        "  \"point3 P\" [-1 0 -1  -1 0 1  1 0 1  1 0 -1   -1 2 -1  1 2 -1  1 2 1  -1 2 1   -1 0 1  -1 2 1  1 2 1  1 0 1\n"
        "                -1 0 -1  -1 2 -1  -1 2 1  -1 0 1   1 0 -1  1 0 1  1 2 1  1 2 -1]\n",
        f);
}

/* Small glowing triangles all over a room, of the same power together whatever their number. */
static bool lights(const char *folder, uint64_t n, char *path, size_t size)
{
    FILE *f = begin(folder, "lights", "0 1 -3.9  0 1 0  0 1 0", path, size);
    if (!f)
        return false;
    room(f);
    float side = 0.2f / sqrtf((float)n);
    fputs("AreaLightSource \"diffuse\" \"rgb L\" [20 18 15]\nShape \"trianglemesh\" \"integer indices\" [", f);
    for (uint64_t i = 0; i < 3 * n; ++i)
        fprintf(f, "%llu ", (unsigned long long)i);
    fputs("]\n \"point3 P\" [", f);
    for (uint64_t i = 0; i < n; ++i) {
        uint32_t key = sr_hash_combine((uint32_t)i, 1);
        float p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = 1.8f * ((float)(sr_hash_combine(key, (uint32_t)k) >> 8) * 0x1p-24f - 0.5f);
        for (int k = 0; k < 3; ++k)
            fprintf(f, "%g %g %g\n", (double)(p[0] + (k == 1 ? side : 0)), (double)(p[1] + 1 + (k == 2 ? side : 0)),
                    (double)(p[2] + (k ? 0 : side)));
    }
    fputs("]\n", f);
    bool is_good = !ferror(f);
    return (fclose(f) == 0) & is_good;
}

static bool one_lamp(const char *folder, uint64_t n, char *path, size_t size)
{
    (void)n;
    return lights(folder, 1, path, size);
}

static const struct series all_series[] = {
    {"triangles", "triangles", triangles, 5, {1000, 10000, 100000, 1000000, 10000000}},
    {"lights", "lights", lights, 6, {1, 10, 100, 1000, 10000, 100000}},
    {"depth", "longest path", one_lamp, 6, {1, 2, 4, 8, 16, 32}},
    {"pixels", "pixels", one_lamp, 5, {4096, 16384, 65536, 262144, 1048576}},
    {"wavelengths", "wavelengths", one_lamp, 1, {SR_LAMBDA_COUNT}},
    {"threads", "threads", one_lamp, 12, {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64}},
};
enum { SERIES = sizeof all_series / sizeof *all_series };

/* ---- one point ---- */

static double processor_s(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static int measure(const struct series *s, uint64_t n, const char *folder, int runs, struct point *p)
{
    char path[4096], estimator[64] = "path,maxdepth=8";
    if (!s->scene(folder, n, path, sizeof path)) {
        fprintf(stderr, "sr_bench: %s cannot be written\n", path);
        return 1;
    }
    bool is_pixels = strcmp(s->name, "pixels") == 0, is_threads = strcmp(s->name, "threads") == 0;
    uint32_t side = is_pixels ? (uint32_t)lrint(sqrt((double)n)) : 128;
    if (strcmp(s->name, "depth") == 0)
        snprintf(estimator, sizeof estimator, "path,maxdepth=%llu", (unsigned long long)n);
    struct sr_import_options options = {
        .spp = is_pixels ? 4 : 16, .width = side, .height = side, .integrator = estimator};
    struct sr_error error = {0};
    struct sr_log log = {0};
    struct sr_import_result scene;
    if (sr_import_pbrt(path, &options, &scene, &log, &error) != SR_OK) {
        fprintf(stderr, "sr_bench: %s\n", error.text);
        return 1;
    }
    struct sr_render_job job = sr_render_job_of(&scene);
    job.threads = is_threads ? (int)n : 1;
    double best = INFINITY; // the least of several runs: what others do on the machine only adds
    for (int i = 0; i < runs; ++i) {
        struct sr_film *film;
        struct sr_render_report report;
        double start_s = processor_s();
        if (sr_render(&job, &film, &report, &error) != SR_OK) {
            fprintf(stderr, "sr_bench: %s\n", error.text);
            return 1;
        }
        for (int c = 0; c < 3; ++c)
            p->variance += pow(sr_film_relative_error(film, (const double[3]){c == 0, c == 1, c == 2}), 2) * scene.spp /
                           (3 * runs);
        sr_film_destroy(film);
        // of one thread the processor's time, which others on the machine do not add to
        best = fmin(best, (is_threads ? report.render_s : processor_s() - start_s) / (double)report.paths);
        p->rays_per_path = (double)(report.rays + report.shadow_rays) / (double)report.paths;
    }
    p->read_s = scene.read_s;
    p->build_s = sr_scene_count(scene.scene).build_s;
    p->path_ns = 1e9 * best;
    p->paths_per_s = 1 / best;
    p->memory_B = (double)sr_peak_memory_B();
    sr_import_result_free(&scene);
    return 0;
}

static bool measure_apart(const struct series *s, uint64_t n, const char *folder, int runs, struct point *p)
{
    int ends[2];
    if (pipe(ends) != 0)
        return false;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        struct point mine = {0};
        int failed = measure(s, n, folder, runs, &mine);
        exit(failed || write(ends[1], &mine, sizeof mine) != sizeof mine);
    }
    close(ends[1]);
    bool is_good = child > 0 && read(ends[0], p, sizeof *p) == sizeof *p;
    close(ends[0]);
    int status = 1;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0 && is_good;
}

int bench_scale(const char *only, const char *folder, int runs)
{
    bool is_good = true, is_known = only == NULL;
    for (int i = 0; i < SERIES; ++i) {
        const struct series *s = &all_series[i];
        if (only && strcmp(only, s->name) != 0)
            continue;
        is_known = true;
        for (int k = 0; k < s->count; ++k) {
            if (strcmp(s->name, "threads") == 0 && s->at[k] > 4 && s->at[k] > (uint64_t)sr_thread_count())
                continue;
            struct point p;
            if (!measure_apart(s, s->at[k], folder, runs, &p)) {
                is_good = false;
                continue;
            }
            printf(
                "{\"scale\": \"%s\", \"n\": %llu, \"wavelengths\": %d, \"path_ns\": %.0f, \"paths_per_s\": %.0f, \"rays_per_path\": %.3f, \"variance\": %.4g, "
                "\"read_s\": %.4f, \"build_s\": %.4f, \"peak_memory_B\": %.0f}\n",
                s->name, (unsigned long long)s->at[k], SR_LAMBDA_COUNT, p.path_ns, p.paths_per_s, p.rays_per_path,
                p.variance, p.read_s, p.build_s, p.memory_B);
        }
    }
    if (!is_known)
        fprintf(stderr, "sr_bench: --scale=%s: expected triangles, lights, depth, pixels, wavelengths or threads\n",
                only);
    return !is_known ? 2 : !is_good;
}

/* ---- figure and table ---- */

struct results {
    double x[MAX_POINTS], path_us[MAX_POINTS], memory_MB[MAX_POINTS], load_s[MAX_POINTS], paths_per_s[MAX_POINTS],
        rays[MAX_POINTS], work_us[MAX_POINTS];
    uint32_t count;
};

static double number(const json_t *line, const char *name)
{
    return json_number_value(json_object_get(line, name));
}

static void read_lines(FILE *from, struct results results[SERIES])
{
    char text[4096];
    while (fgets(text, sizeof text, from)) {
        json_t *line = json_loads(text, 0, NULL);
        const char *name = json_string_value(json_object_get(line, "scale"));
        for (int i = 0; name && i < SERIES; ++i) {
            struct results *r = &results[i];
            if (strcmp(name, all_series[i].name) != 0 || r->count == MAX_POINTS)
                continue;
            uint32_t k = r->count++;
            r->x[k] = number(line, "n");
            r->path_us[k] = 1e-3 * number(line, "path_ns");
            r->paths_per_s[k] = number(line, "paths_per_s");
            r->rays[k] = number(line, "rays_per_path");
            r->memory_MB[k] = 1e-6 * number(line, "peak_memory_B");
            r->load_s[k] = number(line, "read_s") + number(line, "build_s");
            r->work_us[k] = r->path_us[k] * number(line, "variance");
        }
        json_decref(line);
    }
}

static sr_status draw(const struct results results[SERIES], const char *path, struct sr_error *error)
{
    struct sr_plot_curve c[3 * SERIES] = {0};
    struct sr_plot_panel panels[3 * SERIES] = {0};
    uint32_t n = 0;
    for (int i = 0; i < SERIES; ++i) {
        const struct results *r = &results[i];
        const char *name = all_series[i].name;
        bool is_threads = strcmp(name, "threads") == 0, is_triangles = strcmp(name, "triangles") == 0;
        const struct shown {
            const double *values;
            const char *label, *unit;
            bool is_shown;
        } shown[] = {
            {r->path_us, "time of a path", "µs", !is_threads},
            {r->paths_per_s, "paths a second", "s^{-1}", is_threads},
            {r->memory_MB, "peak memory", "MB",
             is_triangles || strcmp(name, "lights") == 0 || strcmp(name, "pixels") == 0},
            {r->load_s, "read and built", "s", is_triangles},
            {r->work_us, "time x variance of a path", "µs", strcmp(name, "wavelengths") == 0},
        };
        for (size_t k = 0; k < sizeof shown / sizeof *shown && r->count; ++k) {
            if (!shown[k].is_shown)
                continue;
            double most = 0;
            for (uint32_t j = 0; j < r->count; ++j)
                most = fmax(most, shown[k].values[j]);
            bool is_linear = is_threads || strcmp(name, "wavelengths") == 0;
            c[n] = (struct sr_plot_curve){
                .x = r->x, .y = shown[k].values, .count = r->count, .colour = 1 + (int)k % 4, .has_points = true};
            panels[n] = (struct sr_plot_panel){.x = {.label = all_series[i].axis,
                                                     .is_log = !is_linear,
                                                     .step = is_threads  ? 1
                                                             : is_linear ? 4
                                                                         : 0},
                                               .y = {.label = shown[k].label,
                                                     .unit = shown[k].unit,
                                                     .is_log = !is_linear,
                                                     .to = is_linear ? 1.1 * most : 0},
                                               .curves = &c[n],
                                               .curve_count = 1,
                                               .has_no_legend = true};
            ++n;
        }
    }
    struct sr_plot_figure figure = {
        .title = "How time and memory grow", .panels = panels, .panel_count = n, .columns = 4};
    return n ? sr_plot_write(&figure, path, error)
             : sr_fail(error, SR_ERROR_INPUT, "there are no lines of sr_bench --scale");
}

int bench_scale_draw(const char *lines, const char *figure)
{
    struct results results[SERIES] = {0};
    struct sr_error error = {0};
    FILE *from = fopen(lines, "r");
    if (!from) {
        fprintf(stderr, "sr_bench: %s cannot be read\n", lines);
        return 1;
    }
    read_lines(from, results);
    fclose(from);
    if (figure && draw(results, figure, &error) != SR_OK) {
        fprintf(stderr, "sr_bench: %s\n", error.text);
        return 1;
    }
    printf(
        "| varied | | time of a path [µs] | paths/s [k] | rays a path | time x variance of a path [µs] | read and built [s] | peak memory [MB] |\n|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < SERIES; ++i)
        for (uint32_t k = 0; k < results[i].count; ++k) {
            const struct results *r = &results[i];
            printf("| %s | %.0f | %.3g | %.0f | %.2f | %.3g | %.3g | %.1f |\n", all_series[i].axis, r->x[k],
                   r->path_us[k], 1e-3 * r->paths_per_s[k], r->rays[k], r->work_us[k], r->load_s[k], r->memory_MB[k]);
        }
    return 0;
}
