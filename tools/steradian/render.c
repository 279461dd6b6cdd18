/* SPDX-License-Identifier: MIT */
/* steradian render: a scene file into an image file, with error bars and a radiometric summary. */
#include "command.h"

#include "import/import.h"
#include "render/render.h"

#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char help[] =
    "Usage: steradian render SCENE.pbrt [-o OUT.exr] [OPTIONS]\n"
    "\n"
    "Renders a pbrt-v4 scene ('-': standard input). Without -o the file's own name for the picture is used.\n"
    "An .exr holds the picture, its standard error, and auxiliary channels as float32; .png is tone-mapped.\n"
    "\n"
    "  -o, --outfile FILE     .exr, .png, .pfm or .hdr; may be given several times\n"
    "      --spp N            samples per pixel (default: the scene's)\n"
    "      --replicates R     R >= 2 independently scrambled nets: Student intervals, for measurements\n"
    "      --seed S           another seed, another independent picture (default: the scene's)\n"
    "      --threads N        (also --nthreads) default: all processors\n"
    "      --resolution W,H   instead of the scene's [pixel]\n"
    "      --cropwindow X0,X1,Y0,Y1   render this share of the picture\n"
    "      --pixelbounds X0,X1,Y0,Y1  render these pixels\n"
    "      --lambda LO,HI     wavelength range [nm] (default: 360,830)\n"
    "      --integrator NAME  another estimator than the scene's: path, simplepath, randomwalk, ambientocclusion\n"
    "      --sampler KIND     sobol (default) or independent\n"
    "      --exposure EV      exposure of a PNG in stops (default: chosen from the picture)\n"
    "      --aov, --no-aov    auxiliary channels in the EXR (default: with them)\n"
    "      --write-partial S  write the output every S seconds while rendering\n"
    "      --tile N           side of a work tile [pixel] (default: 16; the bytes do not depend on it)\n"
    "      --disable-pixel-jitter, --disable-wavelength-jitter\n"
    "      --quick            a quarter of the size and of the samples\n"
    "      --pixel X,Y --sample K [--replicate R]   one sample alone, printed: what made this pixel?\n"
    "      --irradiance PX,PY,PZ,NX,NY,NZ  also measure E at this point [m] with this normal (may be repeated)\n"
    "      --stats            more numbers about the scene and the work\n"
    "      --json             the summary as JSON on standard output\n"
    "      --stamp            write date and render time into the EXR, whose bytes then differ from run to run\n"
    "  -q, --quiet            no progress, no summary; warnings and errors stay\n"
    "\n"
    "Examples:\n"
    "  steradian render scenes/cornell-box.pbrt -o cornell.exr -o cornell.png\n"
    "  steradian render scene.pbrt -o out.pfm --spp 256 --seed 2 --quiet\n"
    "  zcat scene.pbrt.gz | steradian render - -o out.exr --json\n";

enum { MAX_OUTPUTS = 8, MAX_METERS = 16, METER_SAMPLES = 4096, METER_REPLICATES = 32 };

struct arguments {
    const char *scene, *outputs[MAX_OUTPUTS];
    int output_count;
    struct sr_import_options import;
    uint64_t seed, replicates, threads, tile, sample, replicate;
    bool has_seed, has_pixel, aov, quiet, json, stats, no_pixel_jitter, no_lambda_jitter, has_exposure, stamp;
    double pixel[2], exposure_EV, partial_s, lambda[2];
    const char *sampler;
    double meters[MAX_METERS][6]; // point and normal
    int meter_count;
};

enum {
    OPT_SPP = 256, OPT_REPLICATES, OPT_SEED, OPT_THREADS, OPT_RESOLUTION, OPT_CROP, OPT_BOUNDS, OPT_LAMBDA, OPT_INTEGRATOR, OPT_SAMPLER,
    OPT_EXPOSURE, OPT_AOV, OPT_NO_AOV, OPT_PARTIAL, OPT_TILE, OPT_NO_PIXEL_JITTER, OPT_NO_LAMBDA_JITTER, OPT_QUICK, OPT_PIXEL, OPT_SAMPLE,
    OPT_REPLICATE, OPT_STATS, OPT_JSON, OPT_STAMP, OPT_IRRADIANCE,
};

static const struct option long_options[] = {
    {"outfile", required_argument, NULL, 'o'}, {"spp", required_argument, NULL, OPT_SPP}, {"replicates", required_argument, NULL, OPT_REPLICATES},
    {"seed", required_argument, NULL, OPT_SEED}, {"threads", required_argument, NULL, OPT_THREADS}, {"nthreads", required_argument, NULL, OPT_THREADS},
    {"resolution", required_argument, NULL, OPT_RESOLUTION}, {"cropwindow", required_argument, NULL, OPT_CROP},
    {"pixelbounds", required_argument, NULL, OPT_BOUNDS}, {"lambda", required_argument, NULL, OPT_LAMBDA},
    {"integrator", required_argument, NULL, OPT_INTEGRATOR}, {"sampler", required_argument, NULL, OPT_SAMPLER},
    {"exposure", required_argument, NULL, OPT_EXPOSURE}, {"aov", no_argument, NULL, OPT_AOV}, {"no-aov", no_argument, NULL, OPT_NO_AOV},
    {"write-partial", required_argument, NULL, OPT_PARTIAL}, {"tile", required_argument, NULL, OPT_TILE},
    {"disable-pixel-jitter", no_argument, NULL, OPT_NO_PIXEL_JITTER}, {"disable-wavelength-jitter", no_argument, NULL, OPT_NO_LAMBDA_JITTER},
    {"quick", no_argument, NULL, OPT_QUICK}, {"pixel", required_argument, NULL, OPT_PIXEL}, {"sample", required_argument, NULL, OPT_SAMPLE},
    {"replicate", required_argument, NULL, OPT_REPLICATE}, {"stats", no_argument, NULL, OPT_STATS}, {"json", no_argument, NULL, OPT_JSON},
    {"irradiance", required_argument, NULL, OPT_IRRADIANCE}, {"stamp", no_argument, NULL, OPT_STAMP}, {"quiet", no_argument, NULL, 'q'}, {NULL, 0, NULL, 0},
};

static bool take_numbers(struct arguments *a, int option, const char *name, const char *text)
{
    const struct command *c = &command_render;
    double v[4];
    uint64_t n;
    switch (option) {
    case OPT_SPP:
        return command_parse_uint(c, name, text, 1, 1u << 30, &n) && (a->import.spp = (uint32_t)n, true);
    case OPT_REPLICATES:
        return command_parse_uint(c, name, text, 2, 1u << 20, &a->replicates);
    case OPT_SEED:
        a->has_seed = true;
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->seed);
    case OPT_THREADS:
        return command_parse_uint(c, name, text, 1, 1024, &a->threads);
    case OPT_TILE:
        return command_parse_uint(c, name, text, 1, 1024, &a->tile);
    case OPT_SAMPLE:
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->sample);
    case OPT_REPLICATE:
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->replicate);
    case OPT_PIXEL:
        a->has_pixel = true;
        return command_parse_floats(c, name, text, 2, a->pixel);
    case OPT_LAMBDA:
        if (!command_parse_floats(c, name, text, 2, a->lambda))
            return false;
        if (a->lambda[0] >= 100 && a->lambda[1] > a->lambda[0] && a->lambda[1] <= 20000)
            return true;
        command_usage(c, "--lambda %s: LO,HI in nm with 100 <= LO < HI <= 20000 was expected", text);
        return false;
    case OPT_IRRADIANCE:
        if (a->meter_count == MAX_METERS) {
            command_usage(c, "at most %d irradiance meters", MAX_METERS);
            return false;
        }
        return command_parse_floats(c, name, text, 6, a->meters[a->meter_count++]);
    case OPT_RESOLUTION:
        if (!command_parse_floats(c, name, text, 2, v))
            return false;
        if (!(v[0] >= 1 && v[0] <= 2e9 && v[1] >= 1 && v[1] <= 2e9)) {
            command_usage(c, "--resolution %s: two sizes from 1 pixel up were expected", text);
            return false;
        }
        a->import.width = (uint32_t)v[0], a->import.height = (uint32_t)v[1];
        return true;
    case OPT_CROP:
        a->import.has_crop = true;
        if (!command_parse_floats(c, name, text, 4, v))
            return false;
        for (int i = 0; i < 4; ++i)
            a->import.crop_window[i] = (float)v[i];
        return true;
    case OPT_BOUNDS:
        a->import.has_pixel_bounds = true;
        if (!command_parse_floats(c, name, text, 4, v))
            return false;
        for (int i = 0; i < 4; ++i)
            a->import.pixel_bounds[i] = (int32_t)sr_clamp((float)v[i], -2e9f, 2e9f);
        return true;
    case OPT_EXPOSURE:
        a->has_exposure = true;
        return command_parse_float(c, name, text, -100, 100, &a->exposure_EV);
    default:
        return command_parse_float(c, name, text, 0.01, 1e9, &a->partial_s);
    }
}

static int parse(int argc, char **argv, struct arguments *a)
{
    *a = (struct arguments){.aov = true, .lambda = {(double)SR_LAMBDA_MIN, (double)SR_LAMBDA_MAX}};
    int option, index = 0;
    optind = 1;
    while ((option = getopt_long(argc, argv, "o:qh", long_options, &index)) != -1) {
        switch (option) {
        case 'o':
            if (a->output_count == MAX_OUTPUTS)
                return command_usage(&command_render, "at most %d output files", MAX_OUTPUTS);
            a->outputs[a->output_count++] = optarg;
            break;
        case 'q': a->quiet = true; break;
        case OPT_INTEGRATOR: a->import.integrator = optarg; break;
        case OPT_SAMPLER: a->sampler = optarg; break;
        case OPT_AOV: a->aov = true; break;
        case OPT_NO_AOV: a->aov = false; break;
        case OPT_NO_PIXEL_JITTER: a->no_pixel_jitter = true; break;
        case OPT_NO_LAMBDA_JITTER: a->no_lambda_jitter = true; break;
        case OPT_QUICK: a->import.quick = true; break;
        case OPT_STATS: a->stats = true; break;
        case OPT_JSON: a->json = true; break;
        case OPT_STAMP: a->stamp = true; break;
        case '?': return command_usage(&command_render, "the options above were not understood");
        default:
            if (!take_numbers(a, option, long_options[index].name, optarg))
                return SR_ERROR_USAGE;
        }
    }
    if (a->sampler && strcmp(a->sampler, "sobol") != 0 && strcmp(a->sampler, "independent") != 0)
        return command_usage(&command_render, "--sampler %s: sobol or independent was expected", a->sampler);
    if (optind + 1 != argc)
        return command_usage(&command_render, optind == argc ? "a scene file was expected" : "one scene file was expected, there are %d", argc - optind);
    a->scene = argv[optind];
    return 0;
}

/* ---- writing ---- */

static bool is_known_ending(const char *path)
{
    return sr_path_has_ending(path, ".exr") || sr_path_has_ending(path, ".png") || sr_path_has_ending(path, ".pfm") || sr_path_has_ending(path, ".hdr");
}

struct running {
    const struct arguments *arguments;
    const struct sr_import_result *scene;
    const struct sr_render_job *job;
    double last_partial_s;
    bool on_terminal;
    int exit_code; // of writing
};

static void describe(struct sr_image *image, const struct running *r, double elapsed_s, struct sr_error *error)
{
    char text[64];
#define ATTRIBUTE(name, ...)                                                                                           \
    do {                                                                                                               \
        snprintf(text, sizeof text, __VA_ARGS__);                                                                      \
        sr_image_set_attribute(image, name, text, error);                                                              \
    } while (0)
    ATTRIBUTE("steradian.version", "%s", SR_VERSION);
    ATTRIBUTE("steradian.sceneHash", "%016llx", (unsigned long long)r->scene->hash);
    ATTRIBUTE("steradian.seed", "%u", r->job->seed);
    ATTRIBUTE("steradian.samplesPerPixel", "%u", r->job->spp);
    ATTRIBUTE("steradian.replicates", "%u", r->job->replicates);
    ATTRIBUTE("steradian.integrator", "%s", r->job->integrator.model->name);
    ATTRIBUTE("steradian.lambda", "%g..%g nm", (double)r->job->lambda.lo, (double)r->job->lambda.hi);
    if (r->arguments->stamp) {
        time_t now = time(NULL);
        struct tm utc;
        gmtime_r(&now, &utc);
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
        sr_image_set_attribute(image, "steradian.date", text, error);
        ATTRIBUTE("steradian.renderTimeSeconds", "%.3f", elapsed_s);
    }
#undef ATTRIBUTE
}

static sr_status write_outputs(const struct running *r, const struct sr_film *film, double elapsed_s, struct sr_error *error)
{
    struct sr_image *image;
    if (sr_render_image(film, true, r->job->replicates > 0, &image, error) != SR_OK)
        return error->status;
    describe(image, r, elapsed_s, error);
    const struct arguments *a = r->arguments;
    struct sr_image_write_options options = {.tone = {.op = SR_TONE_LINEAR, .is_auto = !a->has_exposure, .exposure_EV = (float)a->exposure_EV}};
    const char *const *names = a->output_count ? a->outputs : &r->scene->film.filename;
    for (int i = 0; i < (a->output_count ? a->output_count : 1); ++i)
        sr_image_write(names[i], image, &options, error);
    sr_image_free(image);
    return error->status;
}

/* ---- progress ---- */

static atomic_bool interrupted;
static volatile sig_atomic_t interrupt_signal;

static void on_signal(int number)
{
    if (interrupt_signal)
        _exit(128 + number); // asked twice: at once
    interrupt_signal = number;
    atomic_store(&interrupted, true);
}

static void on_progress(void *user, const struct sr_render_progress *p)
{
    struct running *r = user;
    if (r->on_terminal)
        fprintf(stderr, "\r%5.1f %%  %.0f s, %.0f s left, %.2f M rays/s   ", 100 * p->share, p->elapsed_s, p->left_s, 1e-6 * (double)p->rays / p->elapsed_s);
    if (r->arguments->partial_s > 0 && p->elapsed_s - r->last_partial_s >= r->arguments->partial_s) {
        struct sr_error error = {0};
        if (write_outputs(r, p->film, p->elapsed_s, &error) != SR_OK)
            fprintf(stderr, "\nwarning: %s\n", error.text); // the render goes on
        r->last_partial_s = p->elapsed_s;
    }
}

/* ---- the summary ---- */

static struct sr_film_mean mean_luminance(const struct sr_film *film)
{
    const struct sr_colour_space *space = sr_colour_space(film->settings.space);
    return sr_film_region_mean(film, 0, 0, film->width, film->height, space->xyz_from_rgb[1]);
}

static double rate(double count, double time_s)
{
    return time_s > 0 ? count / time_s : 0;
}

static void print_meters(const struct arguments *a, const struct sr_render_job *job, json_t *list)
{
    for (int i = 0; i < a->meter_count; ++i) {
        const double *m = a->meters[i];
        struct sr_irradiance E = sr_render_irradiance(job, (sr_vec3){(float)m[0], (float)m[1], (float)m[2]}, (sr_vec3){(float)m[3], (float)m[4], (float)m[5]},
                                                      METER_SAMPLES, METER_REPLICATES);
        double k = sr_student_quantile(0.975, E.degrees);
        if (!a->quiet)
            fprintf(stderr, "irradiance at (%g, %g, %g) m, normal (%g, %g, %g): E_v = %.5g lx ± %.2g lx, E_e = %.5g W/m^2 ± %.2g W/m^2 (95 %%, k = %.2f, ν = %g)\n",
                    m[0], m[1], m[2], m[3], m[4], m[5], E.E_v, k * E.E_v_error, E.E_e, k * E.E_e_error, k, E.degrees);
        json_array_append_new(list, json_pack("{s:[f,f,f], s:[f,f,f], s:{s:s, s:f, s:f}, s:{s:s, s:f, s:f}, s:f, s:f}", "point_m", m[0], m[1], m[2], "normal",
                                              m[3], m[4], m[5], "E_v", "unit", "lx", "value", E.E_v, "standard_uncertainty", E.E_v_error, "E_e", "unit", "W/m^2",
                                              "value", E.E_e, "standard_uncertainty", E.E_e_error, "degrees_of_freedom", E.degrees, "coverage_factor", k));
    }
}

static void print_summary(const struct running *r, const struct sr_film *film, const struct sr_render_report *report, const struct sr_scene_counts *counts)
{
    struct sr_film_mean L = mean_luminance(film);
    double k = sr_student_quantile(0.975, L.degrees);
    const char *kind = r->job->replicates ? "" : ", conservative";
    fprintf(stderr, "mean luminance L_v = %.6g cd/m^2 ± %.2g cd/m^2 (95 %%, k = %.2f%s)\n", L.mean, k * L.standard_error, k, kind);
    fprintf(stderr, "%u x %u pixels, %u samples each; %.2f s, %.2f M paths/s, %.2f M rays/s\n", film->width, film->height, r->job->spp,
            report->render_s, 1e-6 * rate((double)report->paths, report->render_s), 1e-6 * rate((double)(report->rays + report->shadow_rays), report->render_s));
    if (r->arguments->stats)
        fprintf(stderr,
                "scene: %llu triangles, %llu patches, %llu quadrics, %llu instances, %llu lights, %llu materials; read %.2f s, built %.2f s\n"
                "memory: geometry %.1f MiB, acceleration %.1f MiB, peak %.1f MiB; rays %llu, shadow rays %llu, vertices %llu; left out: %llu primitives without area\n",
                (unsigned long long)counts->triangles, (unsigned long long)counts->patches, (unsigned long long)counts->quadrics,
                (unsigned long long)counts->instances, (unsigned long long)counts->lights, (unsigned long long)counts->materials, r->scene->read_s,
                counts->build_s, (double)counts->geometry_B / 1048576, (double)counts->acceleration_B / 1048576, (double)sr_peak_memory_B() / 1048576,
                (unsigned long long)report->rays, (unsigned long long)report->shadow_rays, (unsigned long long)report->vertices, (unsigned long long)counts->degenerate);
}

static void print_json(const struct running *r, const struct sr_film *film, const struct sr_render_report *report, const struct sr_scene_counts *counts, json_t *meters)
{
    struct sr_film_mean L = mean_luminance(film);
    double k = sr_student_quantile(0.975, L.degrees);
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->scene->hash);
    json_t *outputs = json_array();
    for (int i = 0; i < r->arguments->output_count; ++i)
        json_array_append_new(outputs, json_string(r->arguments->outputs[i]));
    if (!r->arguments->output_count)
        json_array_append_new(outputs, json_string(r->scene->film.filename));
    json_t *j = json_pack(
        "{s:s, s:s, s:o, s:b, s:{s:i, s:i, s:I, s:I, s:I}, s:{s:s, s:f, s:f, s:f, s:f, s:f, s:f}, s:{s:f, s:f, s:f, s:f, s:f, s:I}, s:{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}}",
        "version", SR_VERSION, "scene_hash", hash, "outputs", outputs, "complete", report->is_complete,
        "settings", "width", (int)film->width, "height", (int)film->height, "spp", (json_int_t)r->job->spp, "seed", (json_int_t)r->job->seed,
        "replicates", (json_int_t)r->job->replicates,
        "mean_luminance", "unit", "cd/m^2", "value", L.mean, "standard_uncertainty", L.standard_error, "degrees_of_freedom", L.degrees,
        "coverage_factor", k, "expanded_uncertainty", k * L.standard_error, "level", 0.95,
        "time", "read_s", r->scene->read_s, "build_s", counts->build_s, "render_s", report->render_s,
        "paths_per_s", rate((double)report->paths, report->render_s), "rays_per_s", rate((double)(report->rays + report->shadow_rays), report->render_s),
        "peak_memory_B", (json_int_t)sr_peak_memory_B(),
        "counts", "triangles", (json_int_t)counts->triangles, "lights", (json_int_t)counts->lights, "paths", (json_int_t)report->paths,
        "rays", (json_int_t)report->rays, "shadow_rays", (json_int_t)report->shadow_rays, "vertices", (json_int_t)report->vertices,
        "dropped_samples", (json_int_t)report->dropped, "primitives_without_area", (json_int_t)counts->degenerate);
    if (!j)
        return;
    json_object_set(j, "irradiance", meters);
    json_dumpf(j, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    putchar('\n');
    json_decref(j);
}

static int print_sample(const struct arguments *a, const struct sr_render_job *job)
{
    struct sr_worker worker = {0};
    struct sr_first_hit first;
    float rgb[3];
    bool is_finite = sr_render_sample(job, (uint32_t)a->pixel[0], (uint32_t)a->pixel[1], (uint32_t)a->replicate, (uint32_t)a->sample, rgb, &first, &worker);
    printf("pixel %u,%u sample %llu: RGB %.9g %.9g %.9g cd/m^2%s; %llu rays, %llu shadow rays, %llu surfaces\n", (unsigned)a->pixel[0], (unsigned)a->pixel[1],
           (unsigned long long)a->sample, (double)rgb[0], (double)rgb[1], (double)rgb[2], is_finite ? "" : " (not finite)", (unsigned long long)worker.rays,
           (unsigned long long)worker.shadow_rays, (unsigned long long)worker.vertices);
    if (first.is_hit)
        printf("first surface: p %.9g %.9g %.9g m, n %.6g %.6g %.6g, object %u, material %u\n", (double)first.p.x, (double)first.p.y, (double)first.p.z,
               (double)first.n.x, (double)first.n.y, (double)first.n.z, first.object, first.material);
    return 0;
}

/* ---- all together ---- */

static int check_outputs(const struct arguments *a, const struct sr_import_result *scene)
{
    for (int i = 0; i < (a->output_count ? a->output_count : 1); ++i) {
        const char *name = a->output_count ? a->outputs[i] : scene->film.filename;
        if (!is_known_ending(name))
            return command_usage(&command_render, "%s: the ending .exr, .png, .pfm or .hdr was expected", name);
    }
    return 0;
}

static int render_scene(const struct arguments *a, struct sr_import_result *scene)
{
    bool wants_exr = a->output_count == 0 && sr_path_has_ending(scene->film.filename, ".exr");
    for (int i = 0; i < a->output_count; ++i)
        wants_exr |= sr_path_has_ending(a->outputs[i], ".exr");
    struct running r = {.arguments = a, .scene = scene, .on_terminal = !a->quiet && isatty(STDERR_FILENO)};
    struct sr_render_job job = {
        .scene = scene->scene, .sensor = scene->sensor, .filter = scene->filter, .integrator = scene->integrator, .film = scene->film,
        .sampler = !a->sampler ? scene->sampler : strcmp(a->sampler, "sobol") == 0 ? SR_SAMPLER_SOBOL : SR_SAMPLER_INDEPENDENT,
        .seed = a->has_seed ? (uint32_t)a->seed : scene->seed, .spp = scene->spp, .replicates = (uint32_t)a->replicates,
        .lambda = {(float)a->lambda[0], (float)a->lambda[1]}, .jitter_pixel = scene->jitter_pixel && !a->no_pixel_jitter,
        .jitter_lambda = scene->jitter_lambda && !a->no_lambda_jitter, .with_aov = a->aov && wants_exr, .threads = (int)a->threads, .tile = (int)a->tile,
        .progress = on_progress, .progress_interval_s = 0.5, .user = &r, .cancel = &interrupted,
    };
    r.job = &job;
    if (a->has_pixel)
        return print_sample(a, &job);
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);

    struct sr_error error = {0};
    struct sr_film *film;
    struct sr_render_report report;
    sr_status status = sr_render(&job, &film, &report, &error);
    if (r.on_terminal)
        fputs("\r\033[K", stderr);
    if (!film)
        return command_fail("render", &error);
    if (write_outputs(&r, film, report.render_s, &error) != SR_OK) {
        sr_film_destroy(film);
        return command_fail("render", &error);
    }
    if (report.dropped)
        fprintf(stderr, "warning: %llu samples were not finite and count as zero; the first again: steradian render %s --seed %u --pixel %u,%u --sample %u --replicate %u\n",
                (unsigned long long)report.dropped, a->scene, job.seed, report.dropped_x, report.dropped_y, report.dropped_sample, report.dropped_replicate);
    struct sr_scene_counts counts = sr_scene_count(scene->scene);
    if (!a->quiet)
        print_summary(&r, film, &report, &counts);
    json_t *meters = json_array();
    print_meters(a, &job, meters);
    if (a->json)
        print_json(&r, film, &report, &counts, meters);
    json_decref(meters);
    sr_film_destroy(film);
    if (status == SR_CANCELLED) {
        fprintf(stderr, "steradian render: interrupted; what there was has been written\n");
        return 128 + (interrupt_signal ? interrupt_signal : SIGINT);
    }
    return 0;
}

static int run(int argc, char **argv)
{
    struct arguments a;
    int usage = parse(argc, argv, &a);
    if (usage)
        return usage;
    a.import.threads = (int)a.threads;
    struct sr_error error = {0};
    struct sr_log log = command_log(&a.quiet);
    struct sr_import_result scene;
    if (sr_import_pbrt(a.scene, &a.import, &scene, &log, &error) != SR_OK)
        return command_fail("render", &error);
    int code = check_outputs(&a, &scene);
    if (!code)
        code = render_scene(&a, &scene);
    sr_import_result_free(&scene);
    return code;
}

const struct command command_render = {"render", "a scene file into an image file, with error bars", help, run};
