/* SPDX-License-Identifier: MIT */
/* steradian brdf reflectance: what of the light from one solid angle leaves into another (Nicodemus et al. 1977). */
#include "brdf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian brdf reflectance SPECIMEN … --from BEAM --to BEAM [OPTIONS]\n"
    "       steradian brdf reflectance SPECIMEN … --geometry NAME [OPTIONS]\n"
    "\n"
    "The reflectance between any two of direction, cone and hemisphere, with an error bound, its name after Nicodemus, "
    "and\n"
    "the reflectance factor: over that of a perfect diffuser in the same geometry.\n"
    "\n"
    "  BEAM is  direction:THETA[,PHI]   [deg]\n"
    "           cone:THETA,PHI,HALF     [deg] axis and half angle, all of it above the horizon\n"
    "           hemisphere\n"
    "      --from BEAM         whence light comes\n"
    "      --to BEAM           whither it goes\n"
    "      --geometry NAME     of an instrument: 8/di (8 degrees to hemisphere, as an integrating sphere with its "
    "gloss trap\n"
    "                          closed), di/8, 45/0, 0/45, 0/di\n"
    "      --lambda NM[,NM …]  wavelengths [nm], up to " BRDF_MOST_LAMBDAS " (550)\n"
    "      --xyz ILLUMINANT    all wavelengths instead: luminous reflectance and XYZ under D65, A or any named "
    "spectrum\n"
    "      --tolerance X       relative, of the cubature (1e-8; 1e-5 with --xyz)\n"
    "      --samples N         by Monte Carlo in N samples instead; --seed N\n"
    "      --json              the same as JSON on standard output\n"
    "\n"
    "Examples:\n"
    "  steradian brdf reflectance conductor alpha_x=.3 alpha_y=.3 --from direction:45 --to hemisphere\n"
    "  steradian brdf reflectance oren_nayar --geometry 45/0 --xyz D65\n"
    "  steradian brdf reflectance ward --from cone:45,0,5 --to cone:45,180,5 --samples 1000000 --json\n";

static const struct option long_options[] = {
    {"from", required_argument, NULL, 'f'},     {"to", required_argument, NULL, 't'},
    {"geometry", required_argument, NULL, 'g'}, {"lambda", required_argument, NULL, 'l'},
    {"xyz", required_argument, NULL, 'x'},      {"tolerance", required_argument, NULL, 'e'},
    {"samples", required_argument, NULL, 'n'},  {"seed", required_argument, NULL, 's'},
    {"json", no_argument, NULL, 'j'},           {NULL, 0, NULL, 0},
};

static const struct {
    const char *name, *from, *to;
} geometries[] = {
    {"8/di", "direction:8", "hemisphere"},   {"di/8", "hemisphere", "direction:8"},
    {"45/0", "direction:45", "direction:0"}, {"0/45", "direction:0", "direction:45"},
    {"0/di", "direction:0", "hemisphere"},
};
enum { GEOMETRIES = sizeof geometries / sizeof geometries[0] };

struct arguments {
    const char *from_text, *to_text, *xyz;
    struct sr_beam from, to;
    struct brdf_lambda lambda;
    double tolerance;
    uint64_t samples, seed;
    bool json, has_lambda;
};

static int print_colour(const struct arguments *a, const struct sr_specimen *specimen)
{
    struct sr_error error = {0};
    char name[80];
    snprintf(name, sizeof name, "stdillum-%s", a->xyz);
    struct sr_spd illuminant = sr_spd_named(a->xyz);
    if (illuminant.kind == SR_SPD_NONE)
        illuminant = sr_spd_named(name);
    struct sr_reflectance_colour r;
    if (illuminant.kind == SR_SPD_NONE)
        sr_fail(&error, SR_ERROR_INPUT,
                "--xyz %s: the name of an illuminant was expected, such as D65, A, F11 or stdillum-D65", a->xyz);
    else
        sr_reflectance_colour(specimen, &illuminant, &a->from, &a->to, a->tolerance > 0 ? a->tolerance : 1e-5, &r,
                              &error);
    if (error.status)
        return command_fail("brdf reflectance", &error);
    double sum = r.xyz[0] + r.xyz[1] + r.xyz[2];
    if (a->json)
        return command_print_json(
            "brdf reflectance",
            json_pack("{s:o, s:s, s:s, s:s, s:s, s:o, s:o, s:{s:[o,o,o], s:s}, s:{s:[o,o], s:s}, s:I, s:b}", "specimen",
                      command_json_text(specimen->title), "name", r.name, "from", a->from_text, "to", a->to_text,
                      "illuminant", a->xyz, "luminous_reflectance", command_json_quantity(r.luminous, r.unit), "error",
                      command_json_quantity(r.error, r.unit), "factor_xyz", "value", command_json_number(r.xyz[0]),
                      command_json_number(r.xyz[1]), command_json_number(r.xyz[2]), "unit", "1", "chromaticity",
                      "value", command_json_number(sum > 0 ? r.xyz[0] / sum : NAN),
                      command_json_number(sum > 0 ? r.xyz[1] / sum : NAN), "unit", "1", "evaluations",
                      (json_int_t)r.evaluations, "has_converged", r.has_converged));
    printf("%s\n%s, from %s to %s, under %s\n\n", specimen->title, r.name, a->from_text, a->to_text, a->xyz);
    printf("luminous reflectance  %.7g +- %.1g %s\n", r.luminous, r.error, r.unit);
    printf("reflectance factor    X %.6f  Y %.6f  Z %.6f [1], 1 of the perfect diffuser", r.xyz[0], r.xyz[1], r.xyz[2]);
    if (sum > 0)
        printf("; x %.5f  y %.5f", r.xyz[0] / sum, r.xyz[1] / sum);
    printf("\n%s", r.has_converged ? "" : "note: the cubature has not reached its tolerance\n");
    return 0;
}

static int print(const struct arguments *a, const struct sr_specimen *specimen)
{
    struct sr_error error = {0};
    struct sr_reflectance r = {0};
    if (a->samples)
        sr_reflectance_monte_carlo(specimen, a->lambda.lambda, &a->from, &a->to, a->samples, (uint32_t)a->seed, &r,
                                   &error);
    else
        sr_reflectance_cubature(specimen, a->lambda.lambda, &a->from, &a->to, a->tolerance > 0 ? a->tolerance : 1e-8,
                                &r, &error);
    if (error.status)
        return command_fail("brdf reflectance", &error);
    const char *kind = a->samples ? "standard error" : "error bound";
    if (a->json) {
        json_t *values = json_array();
        for (int i = 0; i < a->lambda.count; ++i)
            json_array_append_new(values, json_pack("{s:o, s:o, s:o, s:o}", "lambda",
                                                    command_json_quantity((double)a->lambda.lambda[i], "nm"),
                                                    "reflectance", command_json_quantity(r.value[i], r.unit), "error",
                                                    command_json_quantity(r.error[i], r.unit), "factor",
                                                    command_json_quantity(r.factor[i], "1")));
        return command_print_json(
            "brdf reflectance",
            json_pack("{s:o, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:I, s:b}", "specimen",
                      command_json_text(specimen->title), "name", r.name, "from", a->from_text, "to", a->to_text,
                      "method", a->samples ? "Monte Carlo" : "adaptive cubature", "error_kind", kind, "values", values,
                      "projected_from", command_json_quantity(r.projected_from, "sr"), "projected_to",
                      command_json_quantity(r.projected_to, "sr"), "evaluations", (json_int_t)r.evaluations,
                      "has_converged", r.has_converged));
    }
    printf("%s\n%s, from %s to %s\n\n", specimen->title, r.name, a->from_text, a->to_text);
    printf("%12s %16s [%s] %15s %16s\n", "lambda [nm]", "reflectance", r.unit, kind, "factor [1]");
    for (int i = 0; i < a->lambda.count; ++i)
        printf("%12g %16.10g %*s %15.2g %16.10g\n", (double)a->lambda.lambda[i], r.value[i], (int)strlen(r.unit) + 2,
               "", r.error[i], r.factor[i]);
    printf("\nprojected solid angles %.8g sr and %.8g sr; %llu evaluations\n", r.projected_from, r.projected_to,
           (unsigned long long)r.evaluations);
    if (!r.has_converged)
        printf("note: the cubature has not reached its tolerance: the error bound says what it reached\n");
    return 0;
}

static bool set_geometry(struct arguments *a, const char *name)
{
    for (int i = 0; i < GEOMETRIES; ++i)
        if (strcmp(geometries[i].name, name) == 0) {
            a->from_text = geometries[i].from;
            a->to_text = geometries[i].to;
            return true;
        }
    command_usage(&brdf_reflectance, "--geometry %s: one of 8/di, di/8, 45/0, 0/45, 0/di was expected", name);
    return false;
}

static bool parse_beam(const char *option, const char *text, struct sr_beam *beam)
{
    struct sr_error error = {0};
    if (!text) {
        command_usage(&brdf_reflectance, "--%s direction:THETA[,PHI], cone:THETA,PHI,HALF or hemisphere was expected",
                      option);
        return false;
    }
    if (sr_beam_read(text, beam, &error) != SR_OK) {
        command_usage(&brdf_reflectance, "--%s %s", option, error.text);
        return false;
    }
    return true;
}

static int run(int argc, char **argv)
{
    struct arguments a = {.lambda = brdf_default_lambda(), .seed = 1};
    int option, index = 0;
    bool ok = true;
    while (ok && (option = command_next_option(argc, argv, ":", long_options, &index)) != -1)
        switch (option) {
        case 'f':
            a.from_text = optarg;
            break;
        case 't':
            a.to_text = optarg;
            break;
        case 'g':
            ok = set_geometry(&a, optarg);
            break;
        case 'l':
            ok = brdf_parse_lambda(&brdf_reflectance, optarg, &a.lambda);
            a.has_lambda = true;
            break;
        case 'x':
            a.xyz = optarg;
            break;
        case 'e':
            ok = command_parse_float(&brdf_reflectance, "tolerance", optarg, 1e-14, 0.1, &a.tolerance);
            break;
        case 'n':
            ok = command_parse_uint(&brdf_reflectance, "samples", optarg, 100, 1000000000000, &a.samples);
            break;
        case 's':
            ok = command_parse_uint(&brdf_reflectance, "seed", optarg, 0, UINT32_MAX, &a.seed);
            break;
        case 'j':
            a.json = true;
            break;
        default:
            return command_bad_option(&brdf_reflectance, long_options, option, argv);
        }
    if (!ok || !parse_beam("from", a.from_text, &a.from) || !parse_beam("to", a.to_text, &a.to))
        return SR_ERROR_USAGE;
    if (a.xyz && (a.has_lambda || a.samples))
        return command_usage(&brdf_reflectance, "--xyz is of all wavelengths, by cubature: no --%s goes with it",
                             a.samples ? "samples" : "lambda");
    struct sr_arena arena = {0};
    struct sr_specimen specimen;
    int code = brdf_read_specimen(&brdf_reflectance, argc, argv, &arena, &specimen);
    if (code == 0)
        code = a.xyz ? print_colour(&a, &specimen) : print(&a, &specimen);
    sr_arena_free(&arena);
    return code;
}

const struct command brdf_reflectance = {"brdf reflectance", "reflectance between directions, cones and hemispheres",
                                         help, run};
