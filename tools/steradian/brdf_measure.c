/* SPDX-License-Identifier: MIT */
/* steradian brdf measure: a virtual gonioreflectometer, which makes a table of BSDF values of a piece of geometry. */
#include "brdf.h"

#include "import/import.h"
#include "render/render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char help[] =
    "Usage: steradian brdf measure SCENE.pbrt -o TABLE.txt --patch X0,X1,Y0,Y1 [OPTIONS]\n"
    "\n"
    "Lights a patch of a specimen by parallel beams and sorts what it sends back by direction. The scene's geometry is the\n"
    "specimen: it lies in the plane z = 0, its normal is +z, its lights and camera do not matter, and it reaches beyond the\n"
    "patch by some of its structure's widths. The table (f in 1/sr, averaged over cells of directions, by wavelengths) is\n"
    "read by Material \"measured\" and by all other parts of steradian brdf.\n"
    "\n"
    "  -o, --outfile FILE     the table, .txt\n"
    "      --patch X0,X1,Y0,Y1  where the beam falls [m]\n"
    "      --incidence N      angles of incidence: the middles of N even steps from 0 to 90 deg (default: 9)\n"
    "      --azimuths N       azimuths of incidence, for specimens with a direction (default: 1, which takes the mean over\n"
    "                         all of them, and makes an isotropic table)\n"
    "      --cells T,P        cells of the hemisphere: T of the polar angle, P of the azimuth over the whole turn, or of\n"
    "                         isotropic tables over half of it (default: 18,18; with --azimuths 18,36)\n"
    "      --samples N        paths for each direction of incidence (default: 1000000)\n"
    "      --replicates R     independently scrambled nets (default: 16)\n"
    "      --seed S, --threads N\n"
    "\n"
    "Examples:\n"
    "  steradian brdf measure grooves.pbrt -o grooves.txt --patch -0.1,0.1,-0.1,0.1 --azimuths 12\n"
    "  steradian brdf reflectance grooves.txt --from direction:30 --to hemisphere\n";

struct arguments {
    const char *scene, *output;
    double patch[4], cells[2];
    bool has_patch, has_cells;
    uint64_t incidence, azimuths, samples, replicates, seed, threads;
};

enum { OPT_PATCH = 256, OPT_INCIDENCE, OPT_AZIMUTHS, OPT_CELLS, OPT_SAMPLES, OPT_REPLICATES, OPT_SEED, OPT_THREADS };

static const struct option long_options[] = {
    {"outfile", required_argument, NULL, 'o'},
    {"patch", required_argument, NULL, OPT_PATCH},
    {"incidence", required_argument, NULL, OPT_INCIDENCE},
    {"azimuths", required_argument, NULL, OPT_AZIMUTHS},
    {"cells", required_argument, NULL, OPT_CELLS},
    {"samples", required_argument, NULL, OPT_SAMPLES},
    {"replicates", required_argument, NULL, OPT_REPLICATES},
    {"seed", required_argument, NULL, OPT_SEED},
    {"threads", required_argument, NULL, OPT_THREADS},
    {NULL, 0, NULL, 0},
};

static int parse(int argc, char **argv, struct arguments *a)
{
    const struct command *c = &brdf_measure;
    *a = (struct arguments){.incidence = 9, .azimuths = 1, .samples = 1000000, .replicates = 16, .seed = 1};
    int option, index = 0;
    bool ok = true;
    while (ok && (option = command_next_option(argc, argv, ":o:", long_options, &index)) != -1)
        switch (option) {
        case 'o':
            a->output = optarg;
            break;
        case OPT_PATCH:
            a->has_patch = ok = command_parse_floats(c, "patch", optarg, 4, a->patch);
            break;
        case OPT_INCIDENCE:
            ok = command_parse_uint(c, "incidence", optarg, 1, 90, &a->incidence);
            break;
        case OPT_AZIMUTHS:
            ok = command_parse_uint(c, "azimuths", optarg, 1, 360, &a->azimuths);
            break;
        case OPT_CELLS:
            a->has_cells = ok = command_parse_floats(c, "cells", optarg, 2, a->cells);
            break;
        case OPT_SAMPLES:
            ok = command_parse_uint(c, "samples", optarg, 32, (uint64_t)1 << 40, &a->samples);
            break;
        case OPT_REPLICATES:
            ok = command_parse_uint(c, "replicates", optarg, 2, 4096, &a->replicates);
            break;
        case OPT_SEED:
            ok = command_parse_uint(c, "seed", optarg, 0, UINT32_MAX, &a->seed);
            break;
        case OPT_THREADS:
            ok = command_parse_uint(c, "threads", optarg, 1, 1024, &a->threads);
            break;
        default:
            return command_bad_option(c, long_options, option, argv);
        }
    if (!ok)
        return SR_ERROR_USAGE;
    if (optind + 1 != argc)
        return command_usage(c, "one scene file was expected");
    if (!a->output || !a->has_patch || !(a->patch[1] > a->patch[0] && a->patch[3] > a->patch[2]))
        return command_usage(c, "-o TABLE.txt and --patch X0,X1,Y0,Y1 with X0 < X1 and Y0 < Y1 were expected");
    if (!a->has_cells)
        a->cells[0] = 18, a->cells[1] = a->azimuths > 1 ? 36 : 18;
    for (int i = 0; i < 2; ++i)
        if (!(a->cells[i] >= 2 && a->cells[i] <= 720 && a->cells[i] == floor(a->cells[i])))
            return command_usage(c, "--cells: T,P from 2 to 720 were expected");
    a->scene = argv[optind];
    return 0;
}

/* One line a cell: its middle, and f at each wavelength. */
static void put_rows(FILE *out, const struct sr_gonio_beam *b, const struct sr_gonio_scatter *s)
{
    for (size_t c = 0; c < s->cells; ++c) {
        double theta = 90 * ((double)(c / b->phi_count) + 0.5) / b->theta_count,
               phi = (b->is_isotropic ? 180 : 360) * ((double)(c % b->phi_count) + 0.5) / b->phi_count;
        fprintf(out, "%.6g %.6g %.6g %.6g", (double)b->theta_i * 180 / M_PI, (double)b->phi_i * 180 / M_PI, theta, phi);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            fprintf(out, " %.6g", s->f[c * SR_LAMBDA_COUNT + (size_t)i]);
        fputc('\n', out);
    }
}

static sr_status measure(const struct arguments *a, const struct sr_import_result *scene, FILE *out,
                         struct sr_error *error)
{
    struct sr_gonio g = {.scene = scene->scene,
                         .seed = (uint32_t)a->seed,
                         .replicates = (uint32_t)a->replicates,
                         .threads = (int)a->threads};
    uint64_t each = a->samples / a->replicates;
    g.samples = each < 1 ? 1 : each > UINT32_MAX ? UINT32_MAX : (uint32_t)each;
    struct sr_gonio_beam b = {.x0 = a->patch[0],
                              .x1 = a->patch[1],
                              .y0 = a->patch[2],
                              .y1 = a->patch[3],
                              .is_isotropic = a->azimuths == 1,
                              .theta_count = (uint32_t)a->cells[0],
                              .phi_count = (uint32_t)a->cells[1]};
    fprintf(
        out,
        "# measured on %s by steradian %s, %llu paths a direction\n# quantity: bsdf\n# angles: degrees\ntheta_i phi_i theta_o phi_o",
        a->scene, SR_VERSION, (unsigned long long)g.samples * g.replicates);
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i) {
        b.lambda[i] = 400 + 300 * (float)i / (SR_LAMBDA_COUNT - 1);
        fprintf(out, " %.6gnm", (double)b.lambda[i]);
    }
    fputc('\n', out);
    printf("%8s %8s %14s %12s %10s %14s\n", "theta_i", "phi_i", "reflected [1]", "± (95 %)", "through", "± of f [%]");
    for (uint32_t i = 0; i < a->incidence && !error->status; ++i)
        for (uint32_t j = 0; j < a->azimuths && !error->status; ++j) {
            struct sr_arena arena = {0};
            struct sr_gonio_scatter s;
            b.theta_i = (float)(M_PI / 2 * (i + 0.5) / (double)a->incidence);
            b.phi_i = (float)(2 * M_PI * j / (double)a->azimuths);
            b.stream = i * (uint32_t)a->azimuths + j;
            if (sr_gonio_scatter(&g, &b, &arena, &s, error) == SR_OK) {
                put_rows(out, &b, &s);
                int middle = SR_LAMBDA_COUNT / 2;
                double sum = 0, u = 0; // of all cells, each by its share
                for (size_t c = 0; c < s.cells; ++c) {
                    sum += s.f[c * SR_LAMBDA_COUNT + (size_t)middle];
                    u += s.f_error[c * SR_LAMBDA_COUNT + (size_t)middle];
                }
                printf("%8.2f %8.2f %14.5f %12.2g %10.5f %14.2g\n", (double)b.theta_i * 180 / M_PI,
                       (double)b.phi_i * 180 / M_PI, s.reflected[middle], 1.96 * s.reflected_error[middle],
                       s.transmitted[middle], sum > 0 ? 196 * u / sum : 0);
                if (s.missed > 0)
                    fprintf(
                        stderr,
                        "warning: %.3g %% of the beam from theta_i %.4g deg met nothing: the specimen is too small for the patch\n",
                        100 * s.missed, (double)b.theta_i * 180 / M_PI);
            }
            sr_arena_free(&arena);
        }
    return error->status;
}

static int run(int argc, char **argv)
{
    struct arguments a;
    int code = parse(argc, argv, &a);
    if (code)
        return code;
    bool quiet = true;
    struct sr_error error = {0};
    struct sr_log log = command_log(&quiet);
    struct sr_import_options options = {.threads = (int)a.threads};
    struct sr_import_result scene;
    if (command_check_output(a.output, &error) != SR_OK ||
        sr_import_pbrt(a.scene, &options, &scene, &log, &error) != SR_OK)
        return command_fail("brdf measure", &error);
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        sr_fail(&error, SR_ERROR_RESOURCE, "not enough memory for a table");
    else {
        measure(&a, &scene, out, &error);
        fclose(out);
        if (!error.status)
            sr_file_write(a.output, text, size, &error);
        free(text);
    }
    sr_import_result_free(&scene);
    return error.status ? command_fail("brdf measure", &error) : 0;
}

const struct command brdf_measure = {"brdf measure", "a table of a piece of geometry: a virtual gonioreflectometer",
                                     help, run};
