/* SPDX-License-Identifier: MIT */
/* steradian render: a scene file into an image file, with error bars and a radiometric summary. */
#include "render_command.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "Usage: steradian render SCENE [-o OUT.exr] [OPTIONS]\n"
    "\n"
    "Renders a scene, pbrt-v4 ('-': standard input), .gltf or .glb. Without -o the file's own name for the picture is used.\n"
    "An .exr holds the picture, its standard error, and auxiliary channels as float32; .png is tone-mapped.\n"
    "\n"
    "  -o, --outfile FILE     .exr, .png, .pfm or .hdr; may be given several times\n"
    "      --spp N            samples per pixel (default: the scene's)\n"
    "      --adaptive         more samples where the picture is noisy, spp on average, without bias\n"
    "      --error E          (adaptive) as many as a relative root mean square error of E takes: 1% or 0.01\n"
    "      --time T           (adaptive) as many as fit into this time: 60s, 5min, 1h; with both: whichever is less;\n"
    "                         --spp is then the most (default: 65536)\n"
    "      --replicates R     R >= 2 independently scrambled nets: Student intervals, for measurements\n"
    "      --seed S           another seed, another independent picture (default: the scene's)\n"
    "      --threads N        (also --nthreads) default: all processors\n"
    "      --resolution W,H   instead of the scene's [pixel]\n"
    "      --cropwindow X0,X1,Y0,Y1   render this share of the picture\n"
    "      --pixelbounds X0,X1,Y0,Y1  render these pixels\n"
    "      --lambda LO,HI     wavelength range [nm] (default: 360,830)\n"
    "      --estimator NAME[,key=value…]  (also --integrator) in place of the scene's: path, bdpt, or strategies such as\n"
    "                         uniform-hemisphere+light-area:power; --estimator help lists them\n"
    "      --units WORD       what emission spectra mean: photometric (default: only shapes, as pbrt) or si\n"
    "                         (W m^-2 sr^-1 nm^-1 as they stand); default: the scene's\n"
    "      --sampler KIND     sobol (default) or independent\n"
    "      --exposure EV      exposure of a PNG in stops (default: chosen from the picture)\n"
    "      --aov, --no-aov    auxiliary channels in the EXR (default: with them)\n"
    "      --sample-range A-B  samples A <= i < B of each pixel's 0 to spp, into a part: -o FILE.srp; 'steradian merge'\n"
    "                         makes the picture of all parts (an image beside it shows this part alone)\n"
    "      --part K/N         the same, with the K-th (1 to N) of N even ranges: for job arrays\n"
    "      --progress T       a line of progress every T (10s, 1min), for logs; without it a terminal shows a bar, and\n"
    "                         nothing else shows anything\n"
    "      --write-partial S  write the output every S seconds while rendering\n"
    "      --checkpoint FILE  keep the render in this file while it goes on (default: the first output's name with .srk)\n"
    "      --checkpoint-interval T  so often: 60s (default), 5min, 1h; the file goes when the picture has been written\n"
    "      --no-checkpoint    keep nothing\n"
    "      --resume           go on from the checkpoint, to the same bytes; without one begin anew; refuses another scene's,\n"
    "                         other settings' or another program's\n"
    "      --tile N           side of a work tile [pixel] (default: 16 or less; the bytes do not depend on it)\n"
    "      --disable-pixel-jitter, --disable-wavelength-jitter\n"
    "      --camera NAME      (glTF) the camera of this name, or number from 1; default: the first\n"
    "      --variant NAME     (glTF) the variant of materials of this name, or number from 1; default: none\n"
    "      --quick            a quarter of the size and of the samples\n"
    "      --pixel X,Y --sample K [--replicate R]   one sample alone, printed: what made this pixel?\n"
    "      --irradiance PX,PY,PZ,NX,NY,NZ  also measure E at this point [m] with this normal (may be repeated)\n"
    "      --stats            more numbers about the scene and the work\n"
    "      --json             the summary as JSON on standard output\n"
    "      --stamp            write date and render time into the EXR, whose bytes then differ from run to run\n"
    "  -q, --quiet            no progress, no summary; warnings and errors stay\n"
    "\n"
    "While it renders: Ctrl-C (SIGINT), SIGTERM and SIGHUP (a terminal that goes, but not under nohup) write a checkpoint\n"
    "and what there is, and end with 130, 143 or 129, a second\n"
    "one ends at once; SIGUSR1 writes what there is and goes on (kill -USR1 PID).\n"
    "Exit codes: 0 done, 1 the error of --error was missed, 2 usage, 3 a bad scene, 4 the output, or a checkpoint that was asked "
    "for\nor is needed, cannot be written, or memory is short, 129/130/143 interrupted.\n"
    "\n"
    "Examples:\n"
    "  steradian render scenes/cornell-box.pbrt -o cornell.exr -o cornell.png\n"
    "  steradian render scene.pbrt -o out.pfm --spp 256 --seed 2 --quiet\n"
    "  steradian render model.glb --camera 2 -o model.png\n"
    "  zcat scene.pbrt.gz | steradian render - -o out.exr --json\n";

/* ---- one sample alone ---- */

static int print_sample(const struct render_arguments *a, const struct sr_render_job *job)
{
    if (a->pixel[0] >= job->film.width || a->pixel[1] >= job->film.height)
        return command_usage(&command_render, "--pixel %.0f,%.0f: the picture has %d x %d pixels", a->pixel[0],
                             a->pixel[1], job->film.width, job->film.height);
    struct sr_worker worker = {0};
    struct sr_first_hit first;
    float rgb[3];
    bool is_finite = sr_render_sample(job, (uint32_t)a->pixel[0], (uint32_t)a->pixel[1], (uint32_t)a->replicate,
                                      (uint32_t)a->sample, rgb, &first, &worker);
    printf("pixel %u,%u sample %llu: RGB %.9g %.9g %.9g cd/m^2%s; %llu rays, %llu shadow rays, %llu surfaces\n",
           (unsigned)a->pixel[0], (unsigned)a->pixel[1], (unsigned long long)a->sample, (double)rgb[0], (double)rgb[1],
           (double)rgb[2], is_finite ? "" : " (not finite)", (unsigned long long)worker.rays,
           (unsigned long long)worker.shadow_rays, (unsigned long long)worker.vertices);
    const double *o = job->origin;
    if (first.is_hit)
        printf("first surface: p %.9g %.9g %.9g m, n %.6g %.6g %.6g, object %u, material %u\n",
               (double)first.p.x + o[0], (double)first.p.y + o[1], (double)first.p.z + o[2], (double)first.n.x,
               (double)first.n.y, (double)first.n.z, first.object, first.material);
    return 0;
}

/* ---- all together ---- */

struct render_crew render_crew;

/* It has no film and writes nothing: another process does. */
static bool is_helper(void)
{
    return render_crew.hooks && render_crew.hooks->is_helper;
}

enum { MOST_SPP = 1 << 16 }; // where --error or --time says how many are needed

/* The side of a work tile [pixel]: small where a pixel takes many samples, so that a unit of work ends within seconds
 * and progress, partial pictures and Ctrl-C need not wait. The bytes of the picture do not depend on it. */
static int choose_tile(const struct render_arguments *a, const struct sr_import_result *scene)
{
    // where paths from the lights bring light to the picture, a unit must end before a checkpoint can be written;
    // processes that render together are dealt whole tiles, with all their blocks
    double unit_samples = scene->integrator.model->splats ? 1 << 15 : 1 << 17, blocks = render_crew.hooks ? 1
                                                                                        : a->replicates
                                                                                            ? (double)a->replicates
                                                                                            : 4;
    double side = sqrt(unit_samples * blocks / scene->spp);
    return a->tile ? (int)a->tile : side < 1 ? 1 : side > 16 ? 16 : (int)side;
}

static struct sr_render_job make_job(const struct render_arguments *a, const struct sr_import_result *scene,
                                     bool with_aov, struct rendering *r)
{
    bool has_target = a->adaptive.error > 0 || a->adaptive.time_s > 0;
    struct sr_render_job job = sr_render_job_of(scene);
    if (a->sampler)
        job.sampler = strcmp(a->sampler, "sobol") == 0 ? SR_SAMPLER_SOBOL : SR_SAMPLER_INDEPENDENT;
    if (a->has_seed)
        job.seed = (uint32_t)a->seed;
    if (has_target && !a->import.spp)
        job.spp = MOST_SPP;
    job.adaptive = a->adaptive;
    job.replicates = (uint32_t)a->replicates;
    job.lambda = (struct sr_lambda_range){(float)a->lambda[0], (float)a->lambda[1]};
    job.jitter_pixel &= !a->no_pixel_jitter;
    job.jitter_lambda &= !a->no_lambda_jitter;
    job.with_aov = with_aov;
    job.threads = a->threads ? (int)a->threads : render_crew.threads;
    job.crew = render_crew.hooks;
    job.tile = choose_tile(a, scene);
    job.progress = render_on_progress;
    job.progress_interval_s = 0.5;
    job.user = r;
    job.cancel = &render_interrupted;
    return job;
}

void render_print_replay(const struct rendering *r, const struct sr_render_report *report)
{
    const struct render_arguments *a = r->arguments;
    const struct sr_render_job *job = r->job;
    fprintf(stderr,
            "warning: %s: %llu samples were not finite and count as zero; to see the first again, add to the same "
            "command: --pixel %u,%u --sample %u",
            a->scene, (unsigned long long)report->dropped, report->dropped_x, report->dropped_y,
            report->dropped_sample);
    if (job->replicates || job->adaptive.is_on)
        fprintf(stderr, " --replicate %u", report->dropped_replicate);
    fputc('\n', stderr);
}

static int finish(struct rendering *r, struct render_keeping *keeping, const struct sr_film *film,
                  struct sr_render_report *report)
{
    const struct render_arguments *a = r->arguments;
    struct sr_error error = {0};
    bool is_written = render_write_outputs(r, film, report->render_s, report->is_complete, &error) == SR_OK;
    if (!is_written)
        command_fail("render", &error);
    if (!report->is_complete && is_written)
        fprintf(stderr, "steradian render: interrupted; what there was has been written\n");
    int code = render_keep_end(keeping, r->job, film, NULL, report, is_written);
    if (!is_written)
        return SR_ERROR_RESOURCE;
    if (report->dropped)
        render_print_replay(r, report);
    if (!a->quiet)
        render_print_summary(r, film, report);
    json_t *meters = report->is_complete ? render_measure(a, r->job) : json_array();
    int print_code = 0;
    if (a->json)
        print_code = render_print_json(r, film, report, meters);
    else
        json_decref(meters);
    if (code)
        return code;
    if (report->is_complete)
        return print_code ? print_code : render_missed_target(r, film) ? SR_ERROR_CHECK : 0;
    return render_interrupt_exit();
}

static int render_scene(const struct render_arguments *a, const struct sr_import_result *scene, struct sr_arena *arena)
{
    bool wants_exr = false;
    for (int i = 0; i < render_output_count(a); ++i)
        wants_exr |= a->has_range || sr_path_has_ending(render_output_name(a, scene, i), ".exr");
    struct rendering r = {
        .arguments = a, .scene = scene, .on_terminal = !a->quiet && !(a->progress_s > 0) && isatty(STDERR_FILENO)};
    struct sr_render_job job = make_job(a, scene, a->aov && wants_exr, &r);
    r.job = &job;
    r.about = picture_about(arena, &job, scene->hash, scene->units);
    const char *blind = sr_integrator_blind(&job.integrator, job.scene);
    if (blind)
        fprintf(stderr, "warning: %s: estimator %s: %s\n", a->scene, sr_integrator_label(&job.integrator), blind);
    if (a->has_pixel)
        return print_sample(a, &job);

    struct sr_error error = {0};
    const char *of_scene = sr_import_identity(arena, &a->import, scene),
               *identity = sr_render_identity(arena, &job, of_scene);
    if (!r.about || !of_scene || !identity)
        sr_fail(&error, SR_ERROR_RESOURCE, "not enough memory for what the picture is of");
    if (error.status)
        return command_fail("render", &error);
    int code = is_helper() ? 0 : render_check_outputs(a, scene);
    if (code)
        return code;
    if (a->has_range)
        return render_part(&r, &job, identity);
    struct render_keeping keeping = {0};
    if (!is_helper())
        code = render_keep_begin(a, scene, identity, &job, &keeping);
    render_crew.identity = identity;
    r.keep = job.keep;
    if (!code && render_check_memory(&job, NULL, &error) != SR_OK)
        code = command_fail("render", &error);
    if (!code) {
        if (!is_helper())
            render_catch_interrupts();
        struct sr_film *film;
        struct sr_render_report report;
        double before_s = sr_cpu_s();
        sr_render(&job, &film, &report, &error);
        r.cpu_s = sr_cpu_s() - before_s;
        if (r.on_terminal)
            fputs("\r\033[K", stderr);
        code = film && is_helper() ? 0 : film ? finish(&r, &keeping, film, &report) : command_fail("render", &error);
        sr_film_destroy(film);
    }
    sr_arena_free(&keeping.arena);
    return code;
}

static int run(int argc, char **argv)
{
    if (command_tells_estimators(argc, argv))
        return 0;
    render_catch_requests();
    if (!is_helper())
        render_end_by_interrupts();
    struct render_arguments a;
    int code = render_parse(argc, argv, &a);
    if (!code && render_crew.hooks && a.has_range)
        code = command_usage(&command_render,
                             "parts of a picture are for processes that do not know each other: use steradian render");
    if (!code && render_crew.processes > 1 && strcmp(a.scene, "-") == 0)
        code =
            command_usage(&command_render,
                          "a scene from standard input reaches one process only: write it to a file that all can read");
    if (!code && a.output_count && !a.has_pixel && !is_helper())
        code = render_check_outputs(&a, NULL);
    if (code)
        return code;
    a.import.threads = a.threads ? (int)a.threads : render_crew.threads;
    struct sr_error error = {0};
    struct sr_log log = command_log(&a.quiet);
    struct sr_import_result scene;
    const uint32_t most = 1u << 20; // what the film takes [pixel]
    if (a.import.width > most || a.import.height > most)
        sr_fail(&error, SR_ERROR_RESOURCE, "a picture of %u x %u pixels is too large: at most %u a side",
                a.import.width, a.import.height, most);
    else
        sr_import_pbrt(a.scene, &a.import, &scene, &log, &error);
    if (error.status)
        return command_fail("render", &error);
    struct sr_arena arena = {0};
    code = render_scene(&a, &scene, &arena);
    sr_arena_free(&arena);
    sr_import_result_free(&scene);
    return code;
}

const struct command command_render = {"render", "a scene file into an image file, with error bars", help, run};
