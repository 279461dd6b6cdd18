/* SPDX-License-Identifier: MIT */
/* steradian converge: how the error of estimators falls with samples and with time. */
#include "converge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: steradian converge SCENE.pbrt [OPTIONS]\n"
    "       steradian converge --integral NAME [OPTIONS]\n"
    "\n"
    "Runs estimators and samplers with more and more samples and prints how their error falls: the root mean\n"
    "square over independent seeds, against a reference, with fitted slopes and their 95 % bounds.\n"
    "\n"
    "  -e, --estimator NAME   an estimator (may be repeated; --estimator help lists them); default:\n"
    "                         uniform-hemisphere, cosine-hemisphere, light-area, light-solid-angle and\n"
    "                         bsdf+light-solid-angle\n"
    "      --sampler KIND     sobol, independent, or both (default: sobol; of integrals both)\n"
    "      --samples A:B[:F]  from A to B samples by a factor of F (default 1:64:2 a pixel, 16:4096:2 else)\n"
    "      --seeds S          independent runs of each (default 8; of readings and integrals 32)\n"
    "  -m, --meter NAME       study this meter's photopic reading, not the picture\n"
    "      --reference V      the true reading; default: much longer by bsdf+light-solid-angle:power\n"
    "      --maxdepth N       most scatterings, for all (default: the scene's)\n"
    "      --resolution W,H   of the picture (default: the scene's shape, 32 pixels wide)\n"
    "      --integral NAME    a built-in integral: smooth-1d, peaked-1d, smooth-2d, disk-2d, pole-2d, or list\n"
    "  -o, --outfile FILE     .svg or .png: the plots; .csv: the numbers (may be given several times)\n"
    "      --strip FILE.png   the picture by each estimator with the same number of samples, side by side\n"
    "      --strip-spp N      that number (default 16)\n"
    "      --seed S, --threads N\n"
    "      --json             all numbers as JSON\n"
    "  -q, --quiet            no notes\n"
    "\n"
    "Exit codes: 0 done, 2 usage, 3 a bad scene, 4 out of resources.\n"
    "\n"
    "Examples:\n"
    "  steradian converge --integral peaked-1d -o peak.svg\n"
    "  steradian converge scenes/cornell-box.pbrt -e uniform-hemisphere -e light-area -o box.svg --strip box.png\n"
    "  steradian converge scenes/meters.pbrt --meter desk -e light-area -e light-solid-angle --reference 167.0796\n";

enum {
    OPT_SAMPLER = 256,
    OPT_SAMPLES,
    OPT_SEEDS,
    OPT_REFERENCE,
    OPT_RESOLUTION,
    OPT_INTEGRAL,
    OPT_STRIP,
    OPT_STRIP_SPP,
    OPT_MAX_DEPTH,
    OPT_SEED,
    OPT_THREADS,
    OPT_JSON
};

static const struct option long_options[] = {
    {"estimator", required_argument, NULL, 'e'},
    {"sampler", required_argument, NULL, OPT_SAMPLER},
    {"samples", required_argument, NULL, OPT_SAMPLES},
    {"seeds", required_argument, NULL, OPT_SEEDS},
    {"meter", required_argument, NULL, 'm'},
    {"reference", required_argument, NULL, OPT_REFERENCE},
    {"resolution", required_argument, NULL, OPT_RESOLUTION},
    {"integral", required_argument, NULL, OPT_INTEGRAL},
    {"outfile", required_argument, NULL, 'o'},
    {"strip", required_argument, NULL, OPT_STRIP},
    {"strip-spp", required_argument, NULL, OPT_STRIP_SPP},
    {"maxdepth", required_argument, NULL, OPT_MAX_DEPTH},
    {"seed", required_argument, NULL, OPT_SEED},
    {"threads", required_argument, NULL, OPT_THREADS},
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

/* "A:B" or "A:B:F" */
static bool take_samples(struct converge_arguments *a, const char *text)
{
    unsigned long long v[3] = {0, 0, 2};
    int end[2] = {0, 0}; // behind A:B, and behind A:B:F
    sscanf(text, "%llu:%llu%n:%llu%n", &v[0], &v[1], &end[0], &v[2], &end[1]);
    if (text[0] && (end[1] ? !text[end[1]] : end[0] && !text[end[0]]) && !strchr(text, '-') && v[0] >= 1 &&
        v[1] > v[0] && v[1] <= 1u << 26 && v[2] >= 2 && v[2] <= 1024) {
        a->first = v[0], a->last = v[1], a->factor = v[2], a->has_spp = true;
        return true;
    }
    command_usage(&command_converge,
                  "--samples %s: A:B or A:B:F was expected, 1 <= A < B <= 67108864 and a factor F from 2 to 1024",
                  text);
    return false;
}

static bool take(struct converge_arguments *a, int option, const char *name, const char *text)
{
    const struct command *c = &command_converge;
    switch (option) {
    case 'e':
        if (a->estimator_count == CONVERGE_ESTIMATORS) {
            command_usage(c, "at most %d estimators", CONVERGE_ESTIMATORS);
            return false;
        }
        if (strstr(text, "maxdepth=")) {
            command_usage(c, "-e %s: all estimators must have the reference's depth; --maxdepth N sets it", text);
            return false;
        }
        a->estimators[a->estimator_count++] = text;
        return true;
    case 'm':
        a->meter = text;
        return true;
    case 'o':
        if (a->output_count == CONVERGE_OUTPUTS ||
            !(sr_path_has_ending(text, ".svg") || sr_path_has_ending(text, ".png") ||
              sr_path_has_ending(text, ".csv"))) {
            command_usage(c, "-o %s: at most %d files with the ending .svg, .png or .csv were expected", text,
                          CONVERGE_OUTPUTS);
            return false;
        }
        a->outputs[a->output_count++] = text;
        return true;
    case OPT_SAMPLER:
        a->samplers[SR_SAMPLER_SOBOL] = strcmp(text, "independent") != 0;
        a->samplers[SR_SAMPLER_INDEPENDENT] = strcmp(text, "sobol") != 0;
        if (strcmp(text, "sobol") == 0 || strcmp(text, "independent") == 0 || strcmp(text, "both") == 0)
            return true;
        command_usage(c, "--sampler %s: sobol, independent or both was expected", text);
        return false;
    case OPT_SAMPLES:
        return take_samples(a, text);
    case OPT_SEEDS:
        return command_parse_uint(c, name, text, 2, 4096, &a->seeds);
    case OPT_REFERENCE:
        return command_parse_float(c, name, text, -1e30, 1e30, &a->reference);
    case OPT_RESOLUTION:
        if (!command_parse_floats(c, name, text, 2, a->resolution))
            return false;
        for (int i = 0; i < 2; ++i)
            if (!(a->resolution[i] >= 1 && a->resolution[i] <= 4096 && a->resolution[i] == floor(a->resolution[i]))) {
                command_usage(c, "--resolution %s: W,H in whole pixels from 1 to 4096 was expected", text);
                return false;
            }
        return true;
    case OPT_INTEGRAL:
        a->integral = text;
        return true;
    case OPT_STRIP:
        a->strip = text;
        return sr_path_has_ending(text, ".png") ||
               (command_usage(c, "--strip %s: the ending .png was expected", text), false);
    case OPT_STRIP_SPP:
        return command_parse_uint(c, name, text, 1, 1 << 20, &a->strip_spp);
    case OPT_MAX_DEPTH:
        a->max_depth = text;
        return true;
    case OPT_SEED:
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->seed);
    case OPT_THREADS:
        return command_parse_uint(c, name, text, 1, 1024, &a->threads);
    case OPT_JSON:
        return a->json = true;
    default:
        return a->quiet = true;
    }
}

static int parse(int argc, char **argv, struct converge_arguments *a)
{
    *a = (struct converge_arguments){.reference = NAN, .strip_spp = 16, .factor = 2};
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":e:m:o:q", long_options, &index)) != -1) {
        if (option == '?' || option == ':')
            return command_bad_option(&command_converge, long_options, option, argv);
        if (!take(a, option, option < 256 ? "" : long_options[index].name, optarg))
            return SR_ERROR_USAGE;
    }
    if (a->integral ? optind != argc : optind + 1 != argc)
        return command_usage(&command_converge, a->integral ? "--integral stands without a scene"
                                                            : "one scene file, or --integral, was expected");
    if (a->integral && (a->estimator_count || a->meter || a->strip))
        return command_usage(
            &command_converge,
            "--integral is sampled in its own ways: --estimator, --meter and --strip do not go with it");
    a->scene = argv[optind];
    bool is_light = a->integral || a->meter;
    if (!a->has_spp)
        a->first = is_light ? 16 : 1, a->last = is_light ? 4096 : 64;
    if (!a->seeds)
        a->seeds = is_light ? 32 : 8;
    if (!a->samplers[0] && !a->samplers[1])
        a->samplers[SR_SAMPLER_SOBOL] = true, a->samplers[SR_SAMPLER_INDEPENDENT] = a->integral;
    if (!a->integral && !a->estimator_count) {
        static const char *const usual[] = {"uniform-hemisphere", "cosine-hemisphere", "light-area",
                                            "light-solid-angle", "bsdf+light-solid-angle"};
        memcpy(a->estimators, usual, sizeof usual);
        a->estimator_count = 5;
    }
    return 0;
}

static int list_integrals(void)
{
    for (const struct sr_study_integral *i = sr_study_integrals; i->name; ++i) {
        printf("%-10s  %s = %.12g\n", i->name, i->formula, i->value);
        for (int s = 0; s < SR_STUDY_STRATEGIES && i->strategies[s].name; ++s)
            printf("  %-12s p = %s\n", i->strategies[s].name, i->strategies[s].density);
    }
    return 0;
}

static int converge_integral(const struct converge_arguments *a, struct converge_study *study)
{
    const struct sr_study_integral *integral = sr_study_integral_find(a->integral);
    if (!integral)
        return command_usage(&command_converge, "--integral %s: there is none of this name; --integral list tells them",
                             a->integral);
    study->what = integral->formula;
    study->unit = "1";
    study->reference = integral->value;
    for (int s = 0; s < SR_STUDY_STRATEGIES && integral->strategies[s].name; ++s)
        for (int sampler = 0; sampler < 2; ++sampler) {
            if (!a->samplers[sampler])
                continue;
            struct converge_series *series = &study->series[study->series_count++];
            series->estimator = integral->strategies[s].name;
            series->sampler = (enum sr_sampler_kind)sampler;
            for (uint64_t n = a->first; n <= a->last && series->count < SR_STUDY_POINTS;
                 n *= a->factor, ++series->count) {
                series->n[series->count] = (double)n;
                series->error[series->count] =
                    sr_study_error(integral, s, series->sampler, (uint32_t)a->seed, (uint32_t)n, (uint32_t)a->seeds,
                                   &series->time_s[series->count]);
            }
        }
    return 0;
}

static int run(int argc, char **argv)
{
    if (command_tells_estimators(argc, argv))
        return 0;
    struct converge_arguments a;
    int code = parse(argc, argv, &a);
    if (code)
        return code;
    if (a.integral && strcmp(a.integral, "list") == 0)
        return list_integrals();
    struct sr_arena arena = {0};
    struct converge_study *study = calloc(1, sizeof *study);
    code = !study ? SR_ERROR_RESOURCE : a.integral ? converge_integral(&a, study) : converge_scene(&a, study, &arena);
    for (uint32_t i = 0; code == 0 && i < study->series_count; ++i) {
        struct converge_series *s = &study->series[i];
        bool is_one_sampler = !(a.samplers[0] && a.samplers[1]);
        snprintf(s->label, sizeof s->label, "%s%s%s", s->estimator, is_one_sampler ? "" : ", ",
                 is_one_sampler                   ? ""
                 : s->sampler == SR_SAMPLER_SOBOL ? "sobol"
                                                  : "independent");
        s->has_slope = sr_study_fit(s->n, s->error, s->count, &s->slope);
    }
    if (code == 0)
        code = converge_write(&a, study);
    if (code == 0 && a.strip)
        code = converge_strip(&a, &arena);
    if (code == 0 && a.json)
        code = converge_print_json(&a, study);
    else if (code == 0)
        converge_print(&a, study);
    sr_arena_free(&arena);
    free(study);
    return code;
}

const struct command command_converge = {"converge", "how errors fall with samples and time, by estimator and sampler",
                                         help, run};
