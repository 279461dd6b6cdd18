/* SPDX-License-Identifier: MIT */
/* steradian measure: what the meters of a scene read, with the uncertainty of each reading. */
#include "measure_command.h"
#include "render_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: steradian measure SCENE.pbrt [OPTIONS]\n"
    "       steradian measure SCENE.pbrt --points < POINTS\n"
    "       steradian measure SCENE.pbrt --rays < RAYS\n"
    "\n"
    "Reads the meters of a scene ('-': standard input): lines such as\n"
    "  #@ Meter \"irradiance\" \"string name\" \"desk\" \"point3 p\" [0 0 0.8] \"normal n\" [0 0 1]\n"
    "Each reading is printed with its expanded uncertainty (95 %, Student), from independent replicates.\n"
    "\n"
    "  -m, --meter NAME       this meter only (may be repeated; default: all)\n"
    "      --budget           the uncertainty budget of each meter: the spread of the replicates, and every\n"
    "                         #@ Uncertainty of the scene, by measuring with its parameter shifted both ways\n"
    "      --list             the meters of the scene, without measuring\n"
    "      --quantity LIST    radiometric, photopic (default), scotopic, cones2, cones10, photon, par, or all\n"
    "      --spectrum LO:STEP:HI   also spectral readings at these wavelengths [nm]\n"
    "      --fwhm NM          width of their bandpass (default: STEP)\n"
    "      --bandpass KIND    triangular (default) or rectangular\n"
    "      --colour           also X Y Z, x y, u' v', CCT and Duv\n"
    "      --error E          go on until the expanded uncertainty is E of the reading: 0.1% or 0.001\n"
    "      --time T           take about this long for each meter: 60s, 5min, 1h\n"
    "      --samples N        samples of each meter (default: 65536; streams 4096; maps 1024 a cell);\n"
    "                         with --error or --time: the most\n"
    "      --replicates R     independently scrambled nets, 2 or more (default: 16)\n"
    "      --estimator NAME   (also --integrator) in place of the scene's; --estimator help lists them\n"
    "      --seed S, --threads N, --sampler sobol|independent, --lambda LO,HI, --units WORD\n"
    "                         as of steradian render\n"
    "      --points           lines \"x y z nx ny nz\" [m] on standard input: irradiance there\n"
    "      --rays             lines \"x y z dx dy dz\" [m]: radiance that arrives from there\n"
    "                         out comes, for each line, the reading and its expanded uncertainty\n"
    "      --balance          where the light of the scene goes: emitted, absorbed by each material and shape, escaped\n"
    "  -o, --outfile FILE     where an irradiance map is written: .exr or .pfm, with its standard error; or an intensity\n"
    "                         distribution: .ies, .ldt, or .csv with its standard uncertainty\n"
    "      --json             the readings as JSON; of streams a line of JSON for each line\n"
    "  -q, --quiet            no notes; warnings and errors stay\n"
    "\n"
    "Ctrl-C (SIGINT), SIGTERM and SIGHUP print what there is.\n"
    "Exit codes: 0 done, 1 a target of --error was missed, 2 usage, 3 a bad scene or line, 4 out of resources,\n"
    "129/130/143 interrupted.\n"
    "\n"
    "Examples:\n"
    "  steradian measure scenes/meters.pbrt\n"
    "  steradian measure scenes/meters.pbrt --meter desk --error 0.1% --quantity photopic,par --json\n"
    "  echo \"0 0 0.8  0 0 1\" | steradian measure scenes/meters.pbrt --points\n";

enum {
    OPT_LIST = 256,
    OPT_QUANTITY,
    OPT_SPECTRUM,
    OPT_FWHM,
    OPT_BANDPASS,
    OPT_COLOUR,
    OPT_ERROR,
    OPT_TIME,
    OPT_SAMPLES,
    OPT_REPLICATES,
    OPT_ESTIMATOR,
    OPT_SEED,
    OPT_THREADS,
    OPT_SAMPLER,
    OPT_LAMBDA,
    OPT_POINTS,
    OPT_RAYS,
    OPT_JSON,
    OPT_UNITS,
    OPT_BALANCE,
    OPT_BUDGET,
};

static const struct option long_options[] = {
    {"meter", required_argument, NULL, 'm'},
    {"list", no_argument, NULL, OPT_LIST},
    {"budget", no_argument, NULL, OPT_BUDGET},
    {"quantity", required_argument, NULL, OPT_QUANTITY},
    {"spectrum", required_argument, NULL, OPT_SPECTRUM},
    {"fwhm", required_argument, NULL, OPT_FWHM},
    {"bandpass", required_argument, NULL, OPT_BANDPASS},
    {"colour", no_argument, NULL, OPT_COLOUR},
    {"error", required_argument, NULL, OPT_ERROR},
    {"time", required_argument, NULL, OPT_TIME},
    {"samples", required_argument, NULL, OPT_SAMPLES},
    {"replicates", required_argument, NULL, OPT_REPLICATES},
    {"estimator", required_argument, NULL, OPT_ESTIMATOR},
    {"integrator", required_argument, NULL, OPT_ESTIMATOR},
    {"seed", required_argument, NULL, OPT_SEED},
    {"threads", required_argument, NULL, OPT_THREADS},
    {"sampler", required_argument, NULL, OPT_SAMPLER},
    {"lambda", required_argument, NULL, OPT_LAMBDA},
    {"units", required_argument, NULL, OPT_UNITS},
    {"points", no_argument, NULL, OPT_POINTS},
    {"rays", no_argument, NULL, OPT_RAYS},
    {"outfile", required_argument, NULL, 'o'},
    {"balance", no_argument, NULL, OPT_BALANCE},
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

/* ---- arguments ---- */

/* "photopic,par" */
static bool take_systems(struct measure_arguments *a, const char *text)
{
    memset(a->systems, 0, sizeof a->systems);
    bool is_first = true;
    for (const char *p = text;; ++p) {
        char name[64];
        size_t n = strcspn(p, ",");
        snprintf(name, sizeof name, "%.*s", (int)n, p);
        enum sr_system system;
        if (strcmp(name, "all") == 0) {
            memset(a->systems, 1, sizeof a->systems);
        } else if (sr_system_find(name, &system)) {
            a->systems[system] = true;
            if (is_first)
                a->settings.system = system; // the target looks at the first
        } else {
            const char *names[SR_SYSTEM_COUNT];
            for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
                names[i] = sr_system_name((enum sr_system)i);
            const char *nearest = command_nearest(name, names, sizeof *names, SR_SYSTEM_COUNT);
            command_usage(&command_measure, "--quantity %s: there is no \"%s\"%s%s%s", text, name,
                          nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
            return false;
        }
        is_first = false;
        p += n;
        if (!*p)
            return true;
    }
}

static bool take_spectrum(struct measure_arguments *a, const char *text)
{
    char rest;
    a->has_spectrum = true;
    if (sscanf(text, "%lf:%lf:%lf%c", &a->spectrum[0], &a->spectrum[1], &a->spectrum[2], &rest) == 3)
        return true;
    command_usage(&command_measure, "--spectrum %s: LO:STEP:HI in nm was expected", text);
    return false;
}

static bool take_value(struct measure_arguments *a, int option, const char *name, const char *text)
{
    const struct command *c = &command_measure;
    uint64_t n;
    switch (option) {
    case 'm':
        if (a->meter_count < MEASURE_MAX_METERS) {
            a->meters[a->meter_count++] = text;
            return true;
        }
        command_usage(c, "at most %d times --meter", MEASURE_MAX_METERS);
        return false;
    case OPT_QUANTITY:
        return take_systems(a, text);
    case OPT_SPECTRUM:
        return take_spectrum(a, text);
    case OPT_FWHM:
        return command_parse_float(c, name, text, 1e-3, 1000, &a->fwhm);
    case OPT_BANDPASS:
        a->has_bandpass = true;
        a->bandpass = strcmp(text, "rectangular") == 0 ? SR_BAND_RECTANGULAR : SR_BAND_TRIANGULAR;
        if (a->bandpass == SR_BAND_RECTANGULAR || strcmp(text, "triangular") == 0)
            return true;
        command_usage(c, "--bandpass %s: triangular or rectangular was expected", text);
        return false;
    case OPT_ERROR:
        return command_parse_share(c, name, text, &a->settings.error);
    case OPT_TIME:
        return command_parse_time(c, name, text, &a->settings.time_s);
    case OPT_SAMPLES:
        return command_parse_uint(c, name, text, 2, (uint64_t)1 << 40, &a->settings.samples);
    case OPT_REPLICATES:
        return command_parse_uint(c, name, text, 2, 4096, &n) && (a->settings.replicates = (uint32_t)n, true);
    case OPT_SEED:
        a->has_seed = true;
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->seed);
    case OPT_UNITS:
        return command_parse_units(c, text, &a->import.units);
    case OPT_THREADS:
        return command_parse_uint(c, name, text, 1, 1024, &a->threads);
    default: // lambda
        if (!command_parse_floats(c, name, text, 2, a->lambda))
            return false;
        if (a->lambda[0] >= 100 && a->lambda[1] > a->lambda[0] && a->lambda[1] <= 20000)
            return true;
        command_usage(c, "--lambda %s: LO,HI in nm with 100 <= LO < HI <= 20000 was expected", text);
        return false;
    }
}

static int parse(int argc, char **argv, struct measure_arguments *a)
{
    *a = (struct measure_arguments){
        .lambda = {(double)SR_LAMBDA_MIN, (double)SR_LAMBDA_MAX}, .fwhm = NAN, .settings.system = SR_PHOTOPIC};
    a->systems[SR_PHOTOPIC] = true;
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":m:o:q", long_options, &index)) != -1) {
        switch (option) {
        case 'o':
            a->outfile = optarg;
            break;
        case 'q':
            a->quiet = true;
            break;
        case OPT_LIST:
            a->list = true;
            break;
        case OPT_BUDGET:
            a->budget = true;
            break;
        case OPT_COLOUR:
            a->colour = true;
            break;
        case OPT_POINTS:
            a->input = MEASURE_POINTS;
            break;
        case OPT_RAYS:
            a->input = MEASURE_RAYS;
            break;
        case OPT_BALANCE:
            a->balance = true;
            break;
        case OPT_JSON:
            a->json = true;
            break;
        case OPT_ESTIMATOR:
            a->import.integrator = optarg;
            break;
        case OPT_SAMPLER:
            a->sampler = optarg;
            break;
        case '?':
        case ':':
            return command_bad_option(&command_measure, long_options, option, argv);
        default:
            if (!take_value(a, option, option == 'm' ? "meter" : long_options[index].name, optarg))
                return SR_ERROR_USAGE;
        }
    }
    if (a->sampler && strcmp(a->sampler, "sobol") != 0 && strcmp(a->sampler, "independent") != 0)
        return command_usage(&command_measure, "--sampler %s: sobol or independent was expected", a->sampler);
    if (optind + 1 != argc)
        return command_usage(&command_measure,
                             optind == argc ? "a scene file was expected" : "one scene file was expected, there are %d",
                             argc - optind);
    a->scene = argv[optind];
    if (a->budget && (a->input != MEASURE_METERS || a->outfile || a->balance || a->has_spectrum || a->colour ||
                      a->settings.error > 0 || a->settings.time_s > 0 || strcmp(a->scene, "-") == 0))
        return command_usage(
            &command_measure,
            "--budget measures the meters of a scene file by --samples: without --points, --rays, --balance, --spectrum, --colour, --error, --time, -o");
    if (!a->has_spectrum && (!isnan(a->fwhm) || a->has_bandpass))
        return command_usage(&command_measure,
                             "--fwhm and --bandpass are those of --spectrum LO:STEP:HI, which is missing");
    if (a->balance && (a->input != MEASURE_METERS || a->meter_count || a->outfile || a->has_spectrum || a->colour ||
                       a->list || a->settings.error > 0 || a->settings.time_s > 0))
        return command_usage(
            &command_measure,
            "--balance is of the whole scene, by --samples: without --points, --rays, --meter, --list, --spectrum, --colour, --error, --time, -o");
    if (a->input != MEASURE_METERS && strcmp(a->scene, "-") == 0)
        return command_usage(&command_measure,
                             "standard input cannot hold the scene and what is to be measured: expected a scene file");
    if (a->input != MEASURE_METERS && (a->meter_count || a->outfile || a->has_spectrum || a->colour || a->list))
        return command_usage(
            &command_measure,
            "--points and --rays print one reading a line: --meter, --list, --spectrum, --colour and -o do not go with them");
    return 0;
}

/* ---- what a meter shows ---- */

const char *measure_symbol(const struct sr_meter *meter, enum sr_system system, char text[64])
{
    const char *suffix = meter->model->suffix;
    snprintf(text, 64, "%s%s%s", sr_kind_symbol(meter->model->kind, system), *suffix ? "," : "", suffix);
    return text;
}

bool measure_wants_colour(const struct measure_arguments *a, const struct sr_meter *meter)
{
    return a->colour || sr_meter_common(meter)->reading == SR_READ_COLOUR;
}

sr_status measure_spectrometer(const struct measure_arguments *a, const struct sr_meter *meter,
                               struct sr_spectrometer *s, struct sr_error *error)
{
    const struct sr_meter_common *c = sr_meter_common(meter);
    const float *l = c->lambda.data;
    *s = (struct sr_spectrometer){0};
    if (a->has_spectrum) {
        if (sr_spectrometer_prepare(a->spectrum[0], a->spectrum[1], a->spectrum[2], a->fwhm, a->bandpass, s, error) ==
            SR_ERROR_INPUT)
            error->status = SR_ERROR_USAGE; // these wavelengths are of no file
        return error->status;
    }
    if (c->reading != SR_READ_SPECTRUM)
        return SR_OK;
    bool is_given = c->lambda.count == 3;
    return sr_spectrometer_prepare(is_given ? (double)l[0] : 380, is_given ? (double)l[1] : 10,
                                   is_given ? (double)l[2] : 780, (double)c->fwhm, (enum sr_meter_bandpass)c->bandpass,
                                   s, error);
}

/* ---- all together ---- */

struct sr_render_job measure_job(const struct measure_arguments *a, const struct sr_import_result *scene)
{
    struct sr_render_job job = sr_render_job_of(scene);
    if (a->sampler)
        job.sampler = strcmp(a->sampler, "sobol") == 0 ? SR_SAMPLER_SOBOL : SR_SAMPLER_INDEPENDENT;
    if (a->has_seed)
        job.seed = (uint32_t)a->seed;
    job.lambda = (struct sr_lambda_range){(float)a->lambda[0], (float)a->lambda[1]};
    job.jitter_lambda = true;
    job.threads = (int)a->threads;
    job.cancel = &render_interrupted;
    return job;
}

static int list_meters(const struct measure_arguments *a, const struct sr_import_result *scene)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < scene->meter_count; ++i) {
        const struct sr_meter *m = &scene->meters[i];
        const char *name = sr_meter_common(m)->name;
        if (a->json)
            json_array_append_new(list,
                                  json_pack("{s:o, s:s, s:s, s:s}", "name", command_json_text(name), "kind",
                                            m->model->name, "quantity", m->model->what, "definition", m->model->law));
        else
            printf("%-16s %s: %s\n", name, m->model->what, m->model->law);
    }
    if (a->json)
        return command_print_json("measure", json_pack("{s:o}", "meters", list));
    json_decref(list);
    return 0;
}

/* Marks the meters that are asked for; the exit code of a mistake that has been told, or 0. */
static int choose(const struct measure_arguments *a, const struct sr_import_result *scene, bool *chosen)
{
    for (uint32_t i = 0; i < scene->meter_count; ++i)
        chosen[i] = a->meter_count == 0;
    for (int k = 0; k < a->meter_count; ++k) {
        const char **names = calloc(scene->meter_count + 1, sizeof *names);
        bool is_known = false;
        for (uint32_t i = 0; i < scene->meter_count; ++i) {
            if (names)
                names[i] = sr_meter_common(&scene->meters[i])->name;
            if (strcmp(sr_meter_common(&scene->meters[i])->name, a->meters[k]) == 0)
                is_known = chosen[i] = true;
        }
        if (!is_known) {
            const char *nearest =
                names ? command_nearest(a->meters[k], names, sizeof *names, scene->meter_count) : NULL;
            int code = command_usage(&command_measure, "%s has no meter \"%s\"%s%s%s", a->scene, a->meters[k],
                                     nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
            free(names);
            return code;
        }
        free(names);
    }
    return 0;
}

static json_t *settings_json(const struct measure_arguments *a, const struct sr_render_job *job, enum sr_units units)
{
    return json_pack("{s:s, s:s, s:s, s:I, s:I, s:o, s:f, s:{s:f, s:f, s:s}}", "units",
                     units == SR_UNITS_SI ? "si" : "photometric", "estimator", sr_integrator_label(&job->integrator),
                     "sampler", job->sampler == SR_SAMPLER_SOBOL ? "sobol" : "independent", "seed",
                     (json_int_t)job->seed, "replicates",
                     (json_int_t)(a->settings.replicates ? a->settings.replicates : 16), "target",
                     a->settings.error > 0 ? json_real(a->settings.error) : json_null(), "level", 0.95, "wavelengths",
                     "min", (double)job->lambda.lo, "max", (double)job->lambda.hi, "unit", "nm");
}

/* The map's file, and what there is to say about it. */
static sr_status write_map(const struct measure_arguments *a, const struct sr_render_job *job,
                           const struct sr_meter *meter, struct sr_error *error)
{
    struct sr_image *image;
    struct sr_measure_settings s = a->settings;
    s.error = s.time_s = 0;
    sr_status status = sr_measure_map(job, meter, &s, &image, error);
    if (!image)
        return status;
    const char *blind = sr_integrator_blind(&job->integrator, job->scene);
    if (blind)
        fprintf(stderr, "warning: map \"%s\": %s\n", sr_meter_common(meter)->name, blind);
    struct sr_image_write_options options = {.tone = {.op = SR_TONE_LINEAR, .is_auto = true}};
    if (sr_image_write(a->outfile, image, &options, error) == SR_OK && !a->quiet)
        fprintf(stderr, "note: %u x %u cells of \"%s\" written to %s\n", image->width, image->height,
                sr_meter_common(meter)->name, a->outfile);
    sr_image_free(image);
    return error->status ? error->status : status;
}

static int measure_scene(const struct measure_arguments *a, const struct sr_import_result *scene, const bool *chosen)
{
    struct sr_error error = {0};
    struct sr_render_job job = measure_job(a, scene);
    struct sr_arena arena = {0};
    int width = 0, maps = 0;
    bool is_on_target = true, is_complete = true;
    for (uint32_t i = 0; i < scene->meter_count; ++i) {
        int length = (int)strlen(sr_meter_common(&scene->meters[i])->name);
        width = chosen[i] && length > width ? length : width;
        maps += chosen[i] && scene->meters[i].model->raster;
    }
    if (a->outfile && maps != 1)
        return command_usage(&command_measure,
                             "-o writes one map or intensity distribution, and %d are asked for: choose with --meter",
                             maps);
    json_t *list = json_array();
    for (uint32_t i = 0; i < scene->meter_count && is_complete && !error.status; ++i) {
        const struct sr_meter *meter = &scene->meters[i];
        if (!chosen[i])
            continue;
        struct sr_measure_settings s = a->settings;
        struct sr_measurement m;
        s.stream = i;
        s.with_colour = measure_wants_colour(a, meter);
        if (measure_spectrometer(a, meter, &s.spectrometer, &error) != SR_OK)
            break;
        sr_status status = sr_measure(&job, meter, &s, &arena, &m, &error);
        if (status != SR_OK && status != SR_CANCELLED)
            break;
        is_complete = m.is_complete;
        is_on_target = is_on_target && m.is_on_target;
        if (a->json)
            json_array_append_new(list, measure_json(a, meter, &s.spectrometer, &m));
        else
            measure_print(a, meter, &s.spectrometer, &m, width);
        for (uint32_t k = 0; k < m.remark_count; ++k)
            fprintf(stderr, "warning: meter \"%s\": %s\n", sr_meter_common(meter)->name, m.remarks[k]);
        if (a->outfile && meter->model->raster && is_complete)
            meter->model->far ? measure_write_intensity(a, &job, meter, &error) : write_map(a, &job, meter, &error);
    }
    sr_arena_free(&arena);
    if (error.status && error.status != SR_CANCELLED) {
        json_decref(list);
        return command_fail("measure", &error);
    }
    int code = 0;
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)scene->hash);
    if (a->json)
        code = command_print_json("measure",
                                  json_pack("{s:s, s:o, s:s, s:b, s:o, s:o}", "version", SR_VERSION, "scene",
                                            command_json_text(a->scene), "scene_hash", hash, "complete", is_complete,
                                            "settings", settings_json(a, &job, scene->units), "meters", list));
    else
        json_decref(list);
    if (!is_complete || atomic_load(&render_interrupted)) {
        fprintf(stderr, "steradian measure: interrupted; what there was has been printed\n");
        return render_interrupt_exit();
    }
    return code ? code : is_on_target ? 0 : 1;
}

static int run(int argc, char **argv)
{
    if (command_tells_estimators(argc, argv))
        return 0;
    struct measure_arguments a;
    int code = parse(argc, argv, &a);
    if (code)
        return code;
    a.import.threads = (int)a.threads;
    struct sr_error error = {0};
    struct sr_log log = command_log(&a.quiet);
    struct sr_import_result scene;
    if (a.outfile && command_check_output(a.outfile, &error) != SR_OK)
        return command_fail("measure", &error);
    if (sr_import_pbrt(a.scene, &a.import, &scene, &log, &error) != SR_OK)
        return command_fail("measure", &error);
    bool *chosen = calloc(scene.meter_count + 1, sizeof *chosen);
    if (!chosen)
        code = SR_ERROR_RESOURCE;
    else if (a.input != MEASURE_METERS) {
        struct sr_render_job job = measure_job(&a, &scene);
        const char *blind = sr_integrator_blind(&job.integrator, job.scene);
        if (blind)
            fprintf(stderr, "warning: %s: estimator %s: %s\n", a.scene, sr_integrator_label(&job.integrator), blind);
        render_catch_interrupts();
        code = measure_stream(&a, &job);
    } else if (a.balance) {
        struct sr_render_job job = measure_job(&a, &scene);
        render_catch_interrupts();
        code = measure_balance(&a, &job);
    } else if (scene.meter_count == 0) {
        fprintf(stderr,
                "steradian measure: error: %s: the scene has no meters; a line such as\n"
                "  #@ Meter \"irradiance\" \"string name\" \"desk\" \"point3 p\" [0 0 0.8] \"normal n\" [0 0 1]\n"
                "in its world makes one, and --points and --rays need none\n",
                a.scene);
        code = SR_ERROR_INPUT;
    } else if (a.list) {
        code = list_meters(&a, &scene);
    } else if ((code = choose(&a, &scene, chosen)) == 0) {
        render_catch_interrupts();
        code = a.budget ? measure_budget(&a, &scene, chosen) : measure_scene(&a, &scene, chosen);
    }
    free(chosen);
    sr_import_result_free(&scene);
    return code;
}

const struct command command_measure = {"measure", "what the meters of a scene read, with uncertainty", help, run};
