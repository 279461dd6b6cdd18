/* SPDX-License-Identifier: MIT */
/* steradian: light, computed and measured. One file a subcommand; this one knows their names. */
#include "command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <errno.h>

static const struct command *const commands[] = {&command_render};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

int command_exit(sr_status status)
{
    return status == SR_CANCELLED ? 130 : (int)status;
}

int command_fail(const char *name, const struct sr_error *error)
{
    fprintf(stderr, "steradian %s: error: %s\n", name, error->text);
    return command_exit(error->status);
}

int command_usage(const struct command *command, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "steradian %s: ", command->name);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\nTry 'steradian %s --help'.\n", command->name);
    va_end(arguments);
    return SR_ERROR_USAGE;
}

static void write_log(void *user, enum sr_severity severity, const char *text)
{
    const bool *quiet = user;
    if (severity == SR_WARNING)
        fprintf(stderr, "warning: %s\n", text);
    else if (!*quiet)
        fprintf(stderr, "%s\n", text);
}

struct sr_log command_log(bool *quiet)
{
    return (struct sr_log){.write = write_log, .user = quiet};
}

bool command_parse_float(const struct command *command, const char *option, const char *text, double lo, double hi, double *value)
{
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    if (end != text && *end == 0 && *value >= lo && *value <= hi)
        return true;
    command_usage(command, "--%s %s: a number from %g to %g was expected", option, text, lo, hi);
    return false;
}

bool command_parse_uint(const struct command *command, const char *option, const char *text, uint64_t lo, uint64_t hi, uint64_t *value)
{
    char *end;
    errno = 0;
    unsigned long long v = strtoull(text, &end, 10);
    *value = v;
    if (end != text && *end == 0 && errno == 0 && text[0] != '-' && v >= lo && v <= hi)
        return true;
    command_usage(command, "--%s %s: a whole number from %llu to %llu was expected", option, text, (unsigned long long)lo, (unsigned long long)hi);
    return false;
}

bool command_parse_floats(const struct command *command, const char *option, const char *text, int count, double *values)
{
    const char *p = text;
    for (int i = 0; i < count; ++i) {
        char *end;
        values[i] = strtod(p, &end);
        bool last = i + 1 == count;
        if (end == p || (last ? *end != 0 : *end != ',' && *end != ' ')) {
            command_usage(command, "--%s %s: %d numbers with commas between them were expected", option, text, count);
            return false;
        }
        p = end + 1;
    }
    return true;
}

static void print_help(FILE *out)
{
    fprintf(out, "steradian: light, computed and measured\n\nUsage: steradian SUBCOMMAND [OPTIONS] …\n\n");
    for (int i = 0; i < COMMANDS; ++i)
        fprintf(out, "  %-10s %s\n", commands[i]->name, commands[i]->summary);
    fprintf(out, "\n'steradian SUBCOMMAND --help' tells more, with examples.\n\n"
                 "Exit codes: 0 done, 1 a check failed, 2 usage, 3 bad input, 4 out of resources, 130/143 interrupted.\n");
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "--help";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_help(argc > 1 ? stdout : stderr);
        return argc > 1 ? 0 : SR_ERROR_USAGE;
    }
    if (strcmp(name, "--version") == 0) {
        printf("steradian %s\n", SR_VERSION);
        return 0;
    }
    for (int i = 0; i < COMMANDS; ++i)
        if (strcmp(name, commands[i]->name) == 0) {
            for (int k = 2; k < argc && strcmp(argv[k], "--") != 0; ++k)
                if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0) {
                    fputs(commands[i]->help, stdout);
                    return 0;
                }
            return commands[i]->run(argc - 1, argv + 1);
        }
    fprintf(stderr, "steradian: there is no subcommand \"%s\"\n", name);
    print_help(stderr);
    return SR_ERROR_USAGE;
}
