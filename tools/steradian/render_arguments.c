/* SPDX-License-Identifier: MIT */
/* steradian render: its options, and which values they take. */
#include "render_command.h"

#include <string.h>

enum {
    OPT_SPP = 256,
    OPT_REPLICATES,
    OPT_SEED,
    OPT_THREADS,
    OPT_RESOLUTION,
    OPT_CROP,
    OPT_BOUNDS,
    OPT_LAMBDA,
    OPT_INTEGRATOR,
    OPT_SAMPLER,
    OPT_EXPOSURE,
    OPT_AOV,
    OPT_NO_AOV,
    OPT_PARTIAL,
    OPT_TILE,
    OPT_NO_PIXEL_JITTER,
    OPT_NO_LAMBDA_JITTER,
    OPT_QUICK,
    OPT_PIXEL,
    OPT_SAMPLE,
    OPT_REPLICATE,
    OPT_STATS,
    OPT_JSON,
    OPT_STAMP,
    OPT_IRRADIANCE,
    OPT_UNITS,
    OPT_ADAPTIVE,
    OPT_ERROR,
    OPT_TIME,
    OPT_CAMERA,
    OPT_VARIANT,
    OPT_RANGE,
    OPT_PART,
    OPT_CHECKPOINT,
    OPT_CHECKPOINT_INTERVAL,
    OPT_PROGRESS,
    OPT_NO_CHECKPOINT,
    OPT_RESUME,
};

static const struct option long_options[] = {
    {"outfile", required_argument, NULL, 'o'},
    {"spp", required_argument, NULL, OPT_SPP},
    {"replicates", required_argument, NULL, OPT_REPLICATES},
    {"seed", required_argument, NULL, OPT_SEED},
    {"threads", required_argument, NULL, OPT_THREADS},
    {"nthreads", required_argument, NULL, OPT_THREADS},
    {"resolution", required_argument, NULL, OPT_RESOLUTION},
    {"cropwindow", required_argument, NULL, OPT_CROP},
    {"pixelbounds", required_argument, NULL, OPT_BOUNDS},
    {"lambda", required_argument, NULL, OPT_LAMBDA},
    {"estimator", required_argument, NULL, OPT_INTEGRATOR},
    {"integrator", required_argument, NULL, OPT_INTEGRATOR},
    {"sampler", required_argument, NULL, OPT_SAMPLER},
    {"exposure", required_argument, NULL, OPT_EXPOSURE},
    {"aov", no_argument, NULL, OPT_AOV},
    {"no-aov", no_argument, NULL, OPT_NO_AOV},
    {"write-partial", required_argument, NULL, OPT_PARTIAL},
    {"checkpoint", required_argument, NULL, OPT_CHECKPOINT},
    {"checkpoint-interval", required_argument, NULL, OPT_CHECKPOINT_INTERVAL},
    {"progress", required_argument, NULL, OPT_PROGRESS},
    {"no-checkpoint", no_argument, NULL, OPT_NO_CHECKPOINT},
    {"resume", no_argument, NULL, OPT_RESUME},
    {"tile", required_argument, NULL, OPT_TILE},
    {"disable-pixel-jitter", no_argument, NULL, OPT_NO_PIXEL_JITTER},
    {"disable-wavelength-jitter", no_argument, NULL, OPT_NO_LAMBDA_JITTER},
    {"quick", no_argument, NULL, OPT_QUICK},
    {"camera", required_argument, NULL, OPT_CAMERA},
    {"variant", required_argument, NULL, OPT_VARIANT},
    {"pixel", required_argument, NULL, OPT_PIXEL},
    {"sample", required_argument, NULL, OPT_SAMPLE},
    {"replicate", required_argument, NULL, OPT_REPLICATE},
    {"stats", no_argument, NULL, OPT_STATS},
    {"units", required_argument, NULL, OPT_UNITS},
    {"adaptive", no_argument, NULL, OPT_ADAPTIVE},
    {"error", required_argument, NULL, OPT_ERROR},
    {"time", required_argument, NULL, OPT_TIME},
    {"sample-range", required_argument, NULL, OPT_RANGE},
    {"part", required_argument, NULL, OPT_PART},
    {"json", no_argument, NULL, OPT_JSON},
    {"irradiance", required_argument, NULL, OPT_IRRADIANCE},
    {"stamp", no_argument, NULL, OPT_STAMP},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

static bool take_numbers(struct render_arguments *a, int option, const char *name, const char *text)
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
        a->has_sample = true;
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->sample);
    case OPT_REPLICATE:
        return command_parse_uint(c, name, text, 0, UINT32_MAX, &a->replicate);
    case OPT_PIXEL:
        a->has_pixel = true;
        if (!command_parse_floats(c, name, text, 2, a->pixel))
            return false;
        if (a->pixel[0] >= 0 && a->pixel[1] >= 0 && a->pixel[0] == floor(a->pixel[0]) &&
            a->pixel[1] == floor(a->pixel[1]))
            return true;
        command_usage(c, "--pixel %s: X,Y in whole pixels from 0 up was expected", text);
        return false;
    case OPT_LAMBDA:
        if (!command_parse_floats(c, name, text, 2, a->lambda))
            return false;
        if (a->lambda[0] >= 100 && a->lambda[1] > a->lambda[0] && a->lambda[1] <= 20000)
            return true;
        command_usage(c, "--lambda %s: LO,HI in nm with 100 <= LO < HI <= 20000 was expected", text);
        return false;
    case OPT_IRRADIANCE:
        if (a->meter_count == RENDER_MAX_METERS) {
            command_usage(c, "at most %d irradiance meters", RENDER_MAX_METERS);
            return false;
        }
        return command_parse_floats(c, name, text, 6, a->meters[a->meter_count++]);
    case OPT_RESOLUTION:
        if (!command_parse_floats(c, name, text, 2, v))
            return false;
        if (!(v[0] >= 1 && v[0] <= 4e9 && v[1] >= 1 && v[1] <= 4e9 && v[0] == floor(v[0]) && v[1] == floor(v[1]))) {
            command_usage(c, "--resolution %s: W,H in whole pixels from 1 up was expected", text);
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
        if (v[0] >= 0 && v[0] < v[1] && v[1] <= 1 && v[2] >= 0 && v[2] < v[3] && v[3] <= 1)
            return true;
        command_usage(c, "--cropwindow %s: X0,X1,Y0,Y1 with 0 <= X0 < X1 <= 1 and 0 <= Y0 < Y1 <= 1 was expected",
                      text);
        return false;
    case OPT_BOUNDS:
        a->import.has_pixel_bounds = true;
        if (!command_parse_floats(c, name, text, 4, v))
            return false;
        for (int i = 0; i < 4; ++i)
            a->import.pixel_bounds[i] = (int32_t)sr_clamp((float)v[i], -2e9f, 2e9f);
        return true;
    case OPT_ERROR:
        a->adaptive.is_on = true;
        return command_parse_share(c, name, text, &a->adaptive.error);
    case OPT_TIME:
        a->adaptive.is_on = true;
        return command_parse_time(c, name, text, &a->adaptive.time_s);
    case OPT_CHECKPOINT_INTERVAL:
        return command_parse_time(c, name, text, &a->checkpoint_s);
    case OPT_PROGRESS:
        return command_parse_time(c, name, text, &a->progress_s);
    case OPT_UNITS:
        return command_parse_units(c, text, &a->import.units);
    case OPT_EXPOSURE:
        a->has_exposure = true;
        return command_parse_float(c, name, text, -100, 100, &a->exposure_EV);
    default:
        return command_parse_float(c, name, text, 0.01, 1e9, &a->partial_s);
    }
}

int render_parse(int argc, char **argv, struct render_arguments *a)
{
    *a = (struct render_arguments){
        .aov = true, .checkpoint_s = 60, .lambda = {(double)SR_LAMBDA_MIN, (double)SR_LAMBDA_MAX}};
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":o:q", long_options, &index)) != -1) {
        switch (option) {
        case 'o':
            if (a->output_count == RENDER_MAX_OUTPUTS)
                return command_usage(&command_render, "at most %d output files", RENDER_MAX_OUTPUTS);
            a->outputs[a->output_count++] = optarg;
            break;
        case 'q':
            a->quiet = true;
            break;
        case OPT_INTEGRATOR:
            a->import.integrator = optarg;
            break;
        case OPT_SAMPLER:
            a->sampler = optarg;
            break;
        case OPT_AOV:
            a->aov = true;
            break;
        case OPT_NO_AOV:
            a->aov = false;
            break;
        case OPT_NO_PIXEL_JITTER:
            a->no_pixel_jitter = true;
            break;
        case OPT_NO_LAMBDA_JITTER:
            a->no_lambda_jitter = true;
            break;
        case OPT_ADAPTIVE:
            a->adaptive.is_on = true;
            break;
        case OPT_CAMERA:
            a->import.camera = optarg;
            break;
        case OPT_VARIANT:
            a->import.variant = optarg;
            break;
        case OPT_RANGE:
        case OPT_PART:
            if (a->has_range)
                return command_usage(&command_render, "--sample-range or --part was expected, once");
            a->has_range = true;
            if (option == OPT_RANGE ? !render_parse_range(optarg, &a->range) : !render_parse_part(optarg, a->part))
                return SR_ERROR_USAGE;
            break;
        case OPT_CHECKPOINT:
            a->checkpoint = optarg;
            break;
        case OPT_NO_CHECKPOINT:
            a->no_checkpoint = true;
            break;
        case OPT_RESUME:
            a->resume = true;
            break;
        case OPT_QUICK:
            a->import.quick = true;
            break;
        case OPT_STATS:
            a->stats = true;
            break;
        case OPT_JSON:
            a->json = true;
            break;
        case OPT_STAMP:
            a->stamp = true;
            break;
        case '?':
        case ':':
            return command_bad_option(&command_render, long_options, option, argv);
        default:
            if (!take_numbers(a, option, long_options[index].name, optarg))
                return SR_ERROR_USAGE;
        }
    }
    if (a->sampler && strcmp(a->sampler, "sobol") != 0 && strcmp(a->sampler, "independent") != 0)
        return command_usage(&command_render, "--sampler %s: sobol or independent was expected", a->sampler);
    if (optind + 1 != argc)
        return command_usage(&command_render,
                             optind == argc ? "a scene file was expected" : "one scene file was expected, there are %d",
                             argc - optind);
    if (a->adaptive.is_on && a->replicates)
        return command_usage(&command_render,
                             "--replicates does not go with --adaptive, --error or --time: they have 16 of their own");
    if (a->no_checkpoint && (a->checkpoint || a->resume))
        return command_usage(&command_render, "--no-checkpoint does not go with --checkpoint or --resume");
    if (a->has_sample && !a->has_pixel)
        return command_usage(&command_render, "--sample needs --pixel: which pixel's sample?");
    a->scene = argv[optind];
    bool is_gltf = sr_path_has_ending(a->scene, ".gltf") || sr_path_has_ending(a->scene, ".glb");
    if ((a->import.camera || a->import.variant) && !is_gltf)
        return command_usage(&command_render, "--%s is for scenes in glTF: \"%s\" is none",
                             a->import.camera ? "camera" : "variant", a->scene);
    return a->has_range ? render_check_part(a) : 0;
}
