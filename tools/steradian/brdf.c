/* SPDX-License-Identifier: MIT */
/* steradian brdf: the laboratory's subcommands, and what they share. */
#include "brdf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct command *const parts[] = {&brdf_list,  &brdf_info, &brdf_show,    &brdf_eval, &brdf_reflectance,
                                              &brdf_check, &brdf_fit,  &brdf_convert, &brdf_plot, &brdf_measure};
enum { PARTS = sizeof parts / sizeof parts[0] };

static void print_help(FILE *out)
{
    fprintf(out, "Usage: steradian brdf SUBCOMMAND …\n"
                 "\n"
                 "The laboratory: scattering models and measured data without a scene.\n"
                 "\n");
    for (int i = 0; i < PARTS; ++i)
        fprintf(out, "  %-12s %s\n", parts[i]->name + strlen("brdf "), parts[i]->summary);
    fprintf(out,
            "\n"
            "A specimen is told by words:\n"
            "  MODEL [name=value …]     a model of 'steradian brdf list', with the parameters of 'brdf show MODEL'\n"
            "  FILE [name=value …]      measured data\n"
            "  SCENE.pbrt:MATERIAL      a material of a scene: its name, or #2 for the second Material directive\n"
            "  .3*PART + .7*PART        a weighted sum\n"
            "A value is a number; for spectra also a name (metal-Au-eta), a file of \"nm value\" lines, rgb:R,G,B, or\n"
            "nm:value,nm:value,… Directions are THETA,PHI in degrees from the normal, both away from the surface.\n"
            "\n"
            "'steradian brdf SUBCOMMAND --help' tells more, with examples.\n");
}

static int run(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "--help";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        print_help(argc > 1 ? stdout : stderr);
        return argc > 1 ? 0 : SR_ERROR_USAGE;
    }
    const char *names[PARTS];
    for (int i = 0; i < PARTS; ++i) {
        names[i] = parts[i]->name + strlen("brdf ");
        if (strcmp(name, names[i]) != 0)
            continue;
        for (int k = 2; k < argc && strcmp(argv[k], "--") != 0; ++k)
            if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0) {
                fputs(parts[i]->help, stdout);
                return 0;
            }
        return parts[i]->run(argc - 1, argv + 1);
    }
    const char *nearest = command_nearest(name, names, sizeof names[0], PARTS);
    return nearest ? command_usage(&command_brdf, "there is no subcommand \"%s\"; did you mean \"%s\"?", name, nearest)
                   : command_usage(&command_brdf, "there is no subcommand \"%s\"", name);
}

int brdf_read_specimen(const struct command *command, int argc, char **argv, struct sr_arena *arena,
                       struct sr_specimen *specimen)
{
    static bool quiet;
    struct sr_error error = {0};
    if (optind >= argc)
        return command_usage(command, "a model, a file of measured data, or SCENE.pbrt:MATERIAL was expected");
    if (sr_specimen_read(arena, argc - optind, (const char *const *)(argv + optind), specimen, command_log(&quiet),
                         &error) != SR_OK)
        return command_fail(command->name, &error);
    return 0;
}

bool brdf_parse_direction(const struct command *command, const char *option, const char *text, double angles[2],
                          double direction[3])
{
    angles[1] = 0;
    char *end;
    angles[0] = strtod(text, &end);
    bool ok = end != text;
    if (ok && *end == ',') {
        const char *second = end + 1;
        angles[1] = strtod(second, &end);
        ok = end != second;
    }
    if (!ok || *end || !(angles[0] >= 0 && angles[0] <= 180) || !(fabs(angles[1]) <= 360)) {
        command_usage(command, "--%s %s: THETA[,PHI] in degrees was expected, THETA from 0 to 180", option, text);
        return false;
    }
    double rad = M_PI / 180, s = angles[0] == 180 ? 0 : sin(angles[0] * rad);
    direction[0] = s * cos(angles[1] * rad);
    direction[1] = s * sin(angles[1] * rad);
    direction[2] = angles[0] == 90 ? 0 : cos(angles[0] * rad);
    return true;
}

struct brdf_lambda brdf_default_lambda(void)
{
    return (struct brdf_lambda){SR_BLACK + 550, 1};
}

bool brdf_parse_lambda(const struct command *command, const char *text, struct brdf_lambda *out)
{
    *out = (struct brdf_lambda){0};
    for (const char *p = text;;) {
        char *end;
        double nm = strtod(p, &end);
        if (end == p || !(nm >= 200 && nm <= 3000) || (*end && *end != ',') || out->count == SR_LAMBDA_COUNT) {
            command_usage(command, "--lambda %s: up to %d wavelengths from 200 to 3000 nm were expected", text,
                          SR_LAMBDA_COUNT);
            return false;
        }
        for (int i = out->count++; i < SR_LAMBDA_COUNT; ++i)
            out->lambda[i] = (float)nm;
        if (!*end)
            return true;
        p = end + 1;
    }
}

const char *brdf_lobe_words(uint32_t lobes, char text[128])
{
    static const char *const words[] = {"reflection", "transmission", "diffuse", "glossy", "specular"};
    text[0] = 0;
    for (int i = 0; i < 5; ++i)
        if (lobes & (1u << i)) {
            if (text[0])
                strcat(text, ", ");
            strcat(text, words[i]);
        }
    return text[0] ? text : "none";
}

const struct command command_brdf = {"brdf", "the BRDF laboratory: list, show, evaluate, measure and check models",
                                     NULL, run};
