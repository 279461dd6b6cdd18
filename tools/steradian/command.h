/* SPDX-License-Identifier: MIT */
/* What the subcommands share: their table, messages, numbers from arguments. */
#ifndef SR_TOOLS_COMMAND_H
#define SR_TOOLS_COMMAND_H

#include "base/base.h"

#include <getopt.h>

/* One file each: arguments, calls, printing. Returns the exit code: 0 done, 1 a check failed or a target was missed,
 * 2 usage, 3 bad input, 4 out of resources, 130 or 143 interrupted. */
struct command {
    const char *name, *summary, *help;
    int (*run)(int argc, char **argv);
};
extern const struct command command_render, command_info, command_compare, command_image;

/* Exit code of a status. */
int command_exit(sr_status status);
/* Prints "steradian NAME: error: text" and gives the exit code. */
int command_fail(const char *name, const struct sr_error *error);
/* Prints what is wrong with the arguments and how to get help; 2. */
SR_PRINTF(2, 3) int command_usage(const struct command *command, const char *format, ...);

/* Messages on standard error: warnings always, notes unless quiet. */
struct sr_log command_log(bool *quiet);

/* The whole of text as a number in the range; false and a message otherwise. */
bool command_parse_uint(const struct command *command, const char *option, const char *text, uint64_t lo, uint64_t hi, uint64_t *value);
bool command_parse_float(const struct command *command, const char *option, const char *text, double lo, double hi, double *value);
/* "a,b,c,d" or "a b c d" */
bool command_parse_floats(const struct command *command, const char *option, const char *text, int count, double *values);

#endif
