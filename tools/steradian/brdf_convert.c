/* SPDX-License-Identifier: MIT */
/* steradian brdf convert: any specimen as a file of measured data; then reads it back and tells what the format has
 * cost. */
#include "brdf.h"
#include "measured/measured.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian brdf convert SPECIMEN … -o FILE [OPTIONS]\n"
    "\n"
    "Writes models or measured data as a table of measurements, then reads the file back and tells how far it is from "
    "the\n"
    "specimen. The format is that of the ending, or of --format:\n"
    "  .binary, .merl   merl: linear sRGB, isotropic, reflection\n"
    "  .bsdf            rgl: adaptive tensor file, spectral, isotropic, reflection\n"
    "  .txt             table: plain text over a grid of angles and wavelengths\n"
    "\n"
    "  -o, --output FILE         needed\n"
    "      --format WORD         merl, rgl or table\n"
    "      --theta N             directions of incidence of rgl (16), angles from the normal of a table (19)\n"
    "      --phi N               azimuths of a table (25)\n"
    "      --resolution N        rgl: N x N directions of leaving (32)\n"
    "      --lambda-range LO,HI  wavelengths of rgl (360,810) and tables (380,740) [nm]\n"
    "      --lambda-count N      how many (16; 10)\n"
    "      --anisotropic         a table of all azimuths\n"
    "      --transmission        a table of both sides\n"
    "      --seed N              of models whose f is a random estimate (1)\n"
    "      --json                what it has cost as JSON on standard output\n"
    "\n"
    "Examples:\n"
    "  steradian brdf convert ward_gmd alpha_x=.2 alpha_y=.2 -o ward.binary\n"
    "  steradian brdf convert hapke -o moon.txt --lambda-range 400,700 --lambda-count 4\n"
    "  steradian brdf convert sample.binary -o sample.bsdf --resolution 64\n";

static const struct option long_options[] = {
    {"output", required_argument, NULL, 'o'},
    {"format", required_argument, NULL, 'f'},
    {"theta", required_argument, NULL, 't'},
    {"phi", required_argument, NULL, 'p'},
    {"resolution", required_argument, NULL, 'r'},
    {"lambda-range", required_argument, NULL, 'l'},
    {"lambda-count", required_argument, NULL, 'n'},
    {"anisotropic", no_argument, NULL, 'a'},
    {"transmission", no_argument, NULL, 'b'},
    {"seed", required_argument, NULL, 's'},
    {"json", no_argument, NULL, 'j'},
    {NULL, 0, NULL, 0},
};

enum format { MERL, RGL, TABLE, FORMATS };
static const char *const formats[FORMATS] = {"merl", "rgl", "table"};

struct arguments {
    const char *output, *format;
    uint64_t theta, phi, resolution, lambda_count, seed;
    double lambda_range[2]; // [nm]
    bool anisotropic, transmission, json;
};

/* The specimen as a writer asks for it: at the last wavelengths until others are wanted. */
struct source {
    const struct sr_specimen *specimen;
    uint32_t seed;
    struct sr_specimen_at at;
};

static sr_spectrum f(void *user, sr_vec3 wo, sr_vec3 wi, sr_spectrum lambda)
{
    struct source *s = user;
    if (sr_spectrum_any(lambda != s->at.lambda))
        sr_specimen_at(s->specimen, lambda, s->seed, &s->at);
    return sr_bsdf_f(&s->at.bsdf, wo, wi, SR_RADIANCE);
}

static bool find_format(const struct arguments *a, enum format *format)
{
    const char *dot = strrchr(a->output, '.');
    const char *word = a->format                                                           ? a->format
                       : dot && (strcmp(dot, ".binary") == 0 || strcmp(dot, ".merl") == 0) ? "merl"
                       : dot && strcmp(dot, ".bsdf") == 0                                  ? "rgl"
                       : dot && strcmp(dot, ".txt") == 0                                   ? "table"
                                                                                           : "";
    int i = 0;
    while (i < FORMATS && strcmp(word, formats[i]) != 0)
        ++i;
    *format = (enum format)i;
    return i < FORMATS;
}

static sr_status write_file(const struct arguments *a, enum format format, struct source *source,
                            struct sr_error *error)
{
    float lo = (float)a->lambda_range[0], hi = (float)a->lambda_range[1];
    if (format == MERL)
        return sr_measured_write_merl(a->output, f, source, error);
    if (format == RGL) {
        struct sr_measured_rgl_grid grid = {.theta_count = (int)a->theta,
                                            .resolution = (int)a->resolution,
                                            .lambda_count = (int)a->lambda_count,
                                            .lambda_min = lo,
                                            .lambda_max = hi};
        return sr_measured_write_rgl(a->output, &grid, f, source, error);
    }
    struct sr_measured_table_grid grid = {.theta_count = (int)a->theta,
                                          .phi_count = (int)a->phi,
                                          .lambda_count = (int)a->lambda_count,
                                          .lambda_min = lo,
                                          .lambda_max = hi,
                                          .is_anisotropic = a->anisotropic,
                                          .has_transmission = a->transmission};
    return sr_measured_write_table(a->output, &grid, f, source, error);
}

/* rms of (file - specimen) |cos theta_i| over that of the specimen, over directions within 80 deg of the normal; MERL
 * keeps colours only, so of it the mean over wavelengths counts */
static double difference(const struct sr_measured *file, struct source *source, bool is_rgb)
{
    sr_spectrum lambda = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambda[i] = 430 + 240 * (float)i / (SR_LAMBDA_COUNT - 1);
    struct sr_rng rng = sr_rng_seed(1, 1);
    double miss = 0, all = 0;
    for (int n = 0; n < 20000; ++n) {
        sr_vec3 w[2];
        for (int k = 0; k < 2; ++k) {
            float u = sr_rng_float(&rng);
            w[k] = sr_warp_cosine_hemisphere((sr_vec2){0.97f * u, sr_rng_float(&rng)}); // sin^2 of 80 deg
        }
        sr_spectrum written = sr_measured_f(file, w[0], w[1], lambda), wanted = f(source, w[0], w[1], lambda);
        for (int i = 0; i < (is_rgb ? 1 : SR_LAMBDA_COUNT); ++i) {
            double a = (double)(is_rgb ? sr_spectrum_mean(written) : written[i]),
                   b = (double)(is_rgb ? sr_spectrum_mean(wanted) : wanted[i]), c = (double)w[1].z;
            miss += (a - b) * (a - b) * c * c;
            all += b * b * c * c;
        }
    }
    return all > 0 ? sqrt(miss / all) : 0;
}

static int convert(const struct arguments *a, const struct sr_specimen *specimen, struct sr_arena *arena)
{
    static struct source source;
    struct sr_error error = {0};
    enum format format;
    if (!find_format(a, &format))
        return command_usage(
            &brdf_convert,
            "%s: an ending of .binary, .merl, .bsdf or .txt was expected, or --format merl, rgl or table", a->output);
    source = (struct source){.specimen = specimen, .seed = (uint32_t)a->seed};
    sr_specimen_at(specimen, SR_BLACK + 550, source.seed, &source.at);
    uint32_t lobes = sr_bsdf_lobes(&source.at.bsdf);
    const struct sr_measured *file;
    if (write_file(a, format, &source, &error) != SR_OK ||
        sr_measured_read(a->output, NULL, arena, &file, &error) != SR_OK)
        return command_fail(brdf_convert.name, &error);
    double rms = difference(file, &source, format == MERL);
    bool lost_mirrors = lobes & SR_LOBE_SPECULAR,
         lost_transmission = (lobes & SR_LOBE_TRANSMISSION) && !(format == TABLE && a->transmission);
    if (a->json)
        return command_print_json(
            brdf_convert.name, json_pack("{s:o, s:o, s:s, s:o, s:b, s:b}", "specimen",
                                         command_json_text(specimen->title), "file", command_json_text(a->output),
                                         "format", formats[format], "rms_difference", command_json_quantity(rms, "1"),
                                         "lost_mirrors", lost_mirrors, "lost_transmission", lost_transmission));
    printf("%s: %s as %s; read back it differs by %.3g %% (rms of f cos theta_i%s, within 80 deg)\n", a->output,
           specimen->title, formats[format], 100 * rms, format == MERL ? ", mean over wavelengths" : "");
    if (lost_mirrors)
        printf("note: what the specimen reflects or transmits as a mirror has no f, and is not in the file\n");
    if (lost_transmission)
        printf("note: what passes through is not in the file%s\n", format == TABLE ? " (--transmission)" : "");
    return 0;
}

static int run(int argc, char **argv)
{
    struct arguments a = {.seed = 1};
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":o:", long_options, &index)) != -1) {
        bool ok = true;
        switch (option) {
        case 'o':
            a.output = optarg;
            break;
        case 'f':
            a.format = optarg;
            break;
        case 't':
            ok = command_parse_uint(&brdf_convert, "theta", optarg, 2, 181, &a.theta);
            break;
        case 'p':
            ok = command_parse_uint(&brdf_convert, "phi", optarg, 2, 361, &a.phi);
            break;
        case 'r':
            ok = command_parse_uint(&brdf_convert, "resolution", optarg, 4, 512, &a.resolution);
            break;
        case 'l':
            ok = command_parse_floats(&brdf_convert, "lambda-range", optarg, 2, a.lambda_range);
            if (ok && !(a.lambda_range[0] >= 200 && a.lambda_range[1] > a.lambda_range[0] && a.lambda_range[1] <= 3000))
                return command_usage(&brdf_convert, "--lambda-range %s: LO,HI between 200 and 3000 nm was expected",
                                     optarg);
            break;
        case 'n':
            ok = command_parse_uint(&brdf_convert, "lambda-count", optarg, 1, 471, &a.lambda_count);
            break;
        case 'a':
            a.anisotropic = true;
            break;
        case 'b':
            a.transmission = true;
            break;
        case 's':
            ok = command_parse_uint(&brdf_convert, "seed", optarg, 0, UINT32_MAX, &a.seed);
            break;
        case 'j':
            a.json = true;
            break;
        default:
            return command_bad_option(&brdf_convert, long_options, option, argv);
        }
        if (!ok)
            return SR_ERROR_USAGE;
    }
    if (!a.output)
        return command_usage(&brdf_convert, "-o FILE was expected");
    struct sr_arena arena = {0};
    struct sr_specimen specimen;
    int code = brdf_read_specimen(&brdf_convert, argc, argv, &arena, &specimen);
    if (code == 0)
        code = convert(&a, &specimen, &arena);
    sr_arena_free(&arena);
    return code;
}

const struct command brdf_convert = {"brdf convert", "write a specimen as a file of measured data", help, run};
