/* SPDX-License-Identifier: MIT */
/* What the subcommands share: their table, arguments, messages, files to write, JSON. */
#ifndef SR_TOOLS_COMMAND_H
#define SR_TOOLS_COMMAND_H

#include "base/base.h"
#include "image/image.h"
#include "import/import.h"
#include "quantity/quantity.h"

#include <getopt.h>
#include <jansson.h>

/* One file each: arguments, calls, printing. Returns the exit code: 0 done, 1 a check failed or a target was missed,
 * 2 usage, 3 bad input, 4 out of resources, 129, 130 or 143 interrupted. */
struct command {
    const char *name, *summary, *help; // help NULL: it has subcommands, and helps by itself
    int (*run)(int argc, char **argv);
};
extern const struct command command_render, command_measure, command_info, command_compare, command_image, command_brdf,
    command_glare, command_validate, command_converge, command_formats, command_convert, command_merge;

/* ---- messages ---- */

/* Exit code of a status. */
int command_exit(sr_status status);
/* Prints "steradian NAME: error: text" and gives the exit code. */
int command_fail(const char *name, const struct sr_error *error);
/* Prints what is wrong with the arguments and how to get help; 2. */
SR_PRINTF(2, 3) int command_usage(const struct command *command, const char *format, ...);
/* Messages on standard error: warnings always, notes unless quiet. */
struct sr_log command_log(bool *quiet);

/* ---- arguments ---- */

/* getopt_long without messages of its own, and with ':' where a value is missing. */
int command_next_option(int argc, char **argv, const char *letters, const struct option *options, int *index);
/* What is wrong with the option that was just refused ('?' or ':'), and the nearest one that exists; 2. */
int command_bad_option(const struct command *command, const struct option *options, int result, char **argv);
/* The nearest of count words (spaced by stride bytes, the first member is the word), or NULL where none is near. */
const char *command_nearest(const char *word, const void *words, size_t stride, size_t count);

/* The whole of text as a number in the range; false and a message otherwise. */
bool command_parse_uint(const struct command *command, const char *option, const char *text, uint64_t lo, uint64_t hi,
                        uint64_t *value);
bool command_parse_float(const struct command *command, const char *option, const char *text, double lo, double hi,
                         double *value);
/* "0.1%" or "0.001", between 0 and 1 */
bool command_parse_share(const struct command *command, const char *option, const char *text, double *value);
/* "60", "60s", "5min", "1h" [s] */
bool command_parse_time(const struct command *command, const char *option, const char *text, double *value_s);
/* "photometric" or "si" */
bool command_parse_units(const struct command *command, const char *text, enum sr_units *units);
/* "a,b,c,d" or "a b c d": finite numbers */
bool command_parse_floats(const struct command *command, const char *option, const char *text, int count,
                          double *values);

/* Whether --estimator help was asked for; it has then been printed. */
bool command_tells_estimators(int argc, char **argv);

/* ---- images ---- */

/* The endings that images are written with. */
bool command_is_image_ending(const char *path);
/* Whether a file can be written there, by making and removing the temporary one beside it. */
sr_status command_check_output(const char *path, struct sr_error *error);
/* A text that is written whole when it is done, or not at all. Without a path nothing is: page->out is NULL. */
struct command_page {
    const char *path;
    FILE *out;
    char *text;
    size_t size;
};
sr_status command_page_open(const char *path, struct command_page *page, struct sr_error *error);
void command_page_close(struct command_page *page, struct sr_error *error); // with an error it is thrown away
/* "R,G,B,albedo": the channels of these names, and all of a group ("albedo" is albedo.R, albedo.G, albedo.B), in this
 * order. indices: room for image->channel_count of them. */
sr_status command_select_channels(const struct sr_image *image, const char *label, const char *list, uint32_t *indices,
                                  uint32_t *count, struct sr_error *error);

/* ---- JSON: NULL and numbers that are not finite become null ---- */

json_t *command_json_number(double value);
json_t *command_json_quantity(double value, const char *unit); // {"value": 1.5, "unit": "cd/m^2"}
/* {"unit", "value", "standard_uncertainty", "degrees_of_freedom", "coverage_factor", "expanded_uncertainty", "level":
 * 0.95}, and "upper_bound" where nothing was found */
json_t *command_json_measured(const struct sr_quantity *q);
json_t *command_json_text(const char *text); // bytes that are no UTF-8 become '?'
/* Prints it, and releases it; the exit code. */
int command_print_json(const char *name, json_t *json);

#endif
