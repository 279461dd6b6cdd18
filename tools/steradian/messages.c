/* SPDX-License-Identifier: MIT */
/* What subcommands say when something is wrong, and how they end then. */
#include "command.h"

#include <stdarg.h>
#include <stdio.h>

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
        fprintf(stderr, "note: %s\n", text);
}

struct sr_log command_log(bool *quiet)
{
    return (struct sr_log){.write = write_log, .user = quiet};
}
