/* SPDX-License-Identifier: MIT */
/* Arguments: options with suggestions where one is misspelt, and numbers that must be whole and in range.
 *
 * How far two words are apart is the least number of letters to insert, delete, replace or swap with the neighbour
 * (optimal string alignment; Damerau 1964, Levenshtein 1966). */
#include "command.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST = 63 }; // letters; longer words are near to nothing

static unsigned least(unsigned a, unsigned b)
{
    return a < b ? a : b;
}

static unsigned distance(const char *a, const char *b)
{
    unsigned d[LONGEST + 1][LONGEST + 1];
    unsigned n = (unsigned)strlen(a), m = (unsigned)strlen(b);
    for (unsigned i = 0; i <= n; ++i)
        for (unsigned j = 0; j <= m; ++j) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            unsigned differs = a[i - 1] != b[j - 1];
            d[i][j] = least(d[i - 1][j - 1] + differs, 1 + least(d[i - 1][j], d[i][j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = least(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[n][m];
}

const char *command_nearest(const char *word, const void *words, size_t stride, size_t count)
{
    const char *nearest = NULL;
    unsigned length = (unsigned)strlen(word), best = length / 3 + 2;
    for (size_t i = 0; i < count && length <= LONGEST; ++i) {
        const char *candidate;
        memcpy(&candidate, (const char *)words + i * stride, sizeof candidate);
        if (!candidate || strlen(candidate) > LONGEST)
            continue;
        unsigned d = distance(word, candidate);
        if (d < best && d < strlen(candidate)) {
            best = d;
            nearest = candidate;
        }
    }
    return nearest;
}

int command_next_option(int argc, char **argv, const char *letters, const struct option *options, int *index)
{
    opterr = 0;
    return getopt_long(argc, argv, letters, options, index);
}

int command_bad_option(const struct command *command, const struct option *options, int result, char **argv)
{
    const char *word = argv[optind - 1];
    if (result == ':')
        return command_usage(command, "%s: a value was expected after it", word);
    if (strncmp(word, "--", 2) != 0)
        return command_usage(command, "there is no option -%c", optopt);
    char name[256];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="), word + 2);
    size_t count = 0, beginning = 0, first = 0;
    for (; options[count].name; ++count) {
        if (strcmp(options[count].name, name) == 0)
            return command_usage(command, "--%s takes no value", name);
        if (strncmp(options[count].name, name, strlen(name)) == 0 && beginning++ == 0)
            first = count;
    }
    if (beginning > 1)
        return command_usage(command, "--%s begins %zu options, --%s is one of them", name, beginning,
                             options[first].name);
    if (beginning == 1)
        return command_usage(command, "--%s takes no value", options[first].name);
    const char *nearest = command_nearest(name, &options[0].name, sizeof options[0], count);
    return nearest ? command_usage(command, "there is no option --%s; did you mean --%s?", name, nearest)
                   : command_usage(command, "there is no option --%s", name);
}

bool command_parse_float(const struct command *command, const char *option, const char *text, double lo, double hi,
                         double *value)
{
    char *end;
    *value = strtod(text, &end);
    if (end != text && *end == 0 && *value >= lo && *value <= hi)
        return true;
    command_usage(command, "--%s %s: a number from %g to %g was expected", option, text, lo, hi);
    return false;
}

bool command_parse_uint(const struct command *command, const char *option, const char *text, uint64_t lo, uint64_t hi,
                        uint64_t *value)
{
    char *end;
    errno = 0;
    unsigned long long v = strtoull(text, &end, 10);
    *value = v;
    if (text[0] >= '0' && text[0] <= '9' && *end == 0 && errno == 0 && v >= lo && v <= hi)
        return true;
    command_usage(command, "--%s %s: a whole number from %llu to %llu was expected", option, text,
                  (unsigned long long)lo, (unsigned long long)hi);
    return false;
}

/* A number and what may stand behind it, with its factor. */
static bool parse_scaled(const struct command *command, const char *option, const char *text,
                         const char *const *suffixes, const double *factors, double most, const char *expected,
                         double *value)
{
    char *end;
    double number = strtod(text, &end);
    for (int i = 0; suffixes[i]; ++i)
        if (end != text && strcmp(end, suffixes[i]) == 0) {
            *value = number * factors[i];
            if (*value > 0 && *value < most)
                return true;
        }
    command_usage(command, "--%s %s: %s was expected", option, text, expected);
    return false;
}

bool command_parse_share(const struct command *command, const char *option, const char *text, double *value)
{
    return parse_scaled(command, option, text, (const char *const[]){"", "%", NULL}, (const double[]){1, 0.01}, 1,
                        "a share such as 0.1% or 0.001", value);
}

bool command_parse_time(const struct command *command, const char *option, const char *text, double *value_s)
{
    return parse_scaled(command, option, text, (const char *const[]){"", "s", "min", "h", NULL},
                        (const double[]){1, 1, 60, 3600}, 1e9, "a time such as 60s or 5min", value_s);
}

bool command_parse_units(const struct command *command, const char *text, enum sr_units *units)
{
    *units = strcmp(text, "si") == 0 ? SR_UNITS_SI : SR_UNITS_PHOTOMETRIC;
    if (*units == SR_UNITS_SI || strcmp(text, "photometric") == 0)
        return true;
    command_usage(command, "--units %s: photometric or si was expected", text);
    return false;
}

bool command_parse_floats(const struct command *command, const char *option, const char *text, int count,
                          double *values)
{
    const char *p = text;
    for (int i = 0; i < count; ++i) {
        char *end;
        values[i] = strtod(p, &end);
        bool last = i + 1 == count;
        if (end == p || !isfinite(values[i]) || (last ? *end != 0 : *end != ',' && *end != ' ')) {
            command_usage(command, "--%s %s: %d numbers with commas between them were expected", option, text, count);
            return false;
        }
        p = end + 1;
    }
    return true;
}
