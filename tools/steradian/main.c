/* SPDX-License-Identifier: MIT */
/* steradian: light, computed and measured. One file a subcommand; this one knows their names. */
#include "command.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const struct command *const commands[] = {
    &command_render, &command_merge, &command_measure, &command_converge, &command_info,    &command_compare,
    &command_image,  &command_brdf,  &command_glare,   &command_validate, &command_formats, &command_convert};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void print_help(FILE *out)
{
    fprintf(out, "steradian: light, computed and measured\n\nUsage: steradian SUBCOMMAND [OPTIONS] …\n\n");
    for (int i = 0; i < COMMANDS; ++i)
        fprintf(out, "  %-10s %s\n", commands[i]->name, commands[i]->summary);
    fprintf(
        out,
        "\n'steradian SUBCOMMAND --help' tells more, with examples. 'steradian --version' tells the version.\n\n"
        "Examples:\n"
        "  steradian render scenes/cornell-box.pbrt -o cornell.exr -o cornell.png\n"
        "  steradian info cornell.exr\n"
        "  steradian compare cornell.exr reference.exr -o difference.png --max-z 5\n"
        "  steradian image cornell.exr -o cornell.png --exposure -4 --tone filmic\n"
        "\n"
        "Exit codes: 0 done, 1 a check failed, 2 usage, 3 bad input, 4 out of resources, 129/130/143 interrupted.\n");
}

static int run(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "--help";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_help(argc > 1 ? stdout : stderr);
        return argc > 1 ? 0 : SR_ERROR_USAGE;
    }
    if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
        printf("steradian %s (%s), %d wavelengths a path\n", SR_VERSION, sr_isa(), SR_LAMBDA_COUNT);
        return 0;
    }
    for (int i = 0; i < COMMANDS; ++i)
        if (strcmp(name, commands[i]->name) == 0) {
            for (int k = 2; commands[i]->help && k < argc && strcmp(argv[k], "--") != 0; ++k)
                if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0) {
                    fputs(commands[i]->help, stdout);
                    return 0;
                }
            return commands[i]->run(argc - 1, argv + 1);
        }
    const char *names[COMMANDS];
    for (int i = 0; i < COMMANDS; ++i)
        names[i] = commands[i]->name;
    const char *nearest = command_nearest(name, names, sizeof names[0], COMMANDS);
    fprintf(stderr, "steradian: there is no subcommand \"%s\"", name);
    if (nearest)
        fprintf(stderr, "; did you mean \"%s\"?", nearest);
    fprintf(stderr, "\nTry 'steradian --help'.\n");
    return SR_ERROR_USAGE;
}

int main(int argc, char **argv)
{
    int code = run(argc, argv);
    struct sr_error error = {0};
    if ((fflush(stdout) == 0 && !ferror(stdout)) || code > 1) // what else is wrong has been told
        return code;
    sr_fail(&error, SR_ERROR_RESOURCE, "standard output cannot be written: %s", strerror(errno));
    return command_fail(argc > 1 ? argv[1] : "", &error);
}
