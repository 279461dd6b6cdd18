/* SPDX-License-Identifier: MIT */
/* What the bench has reached beside what it is to reach. */
#include "targets.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* A number of a case's line; reached is number / per, per NULL: 1. */
static const struct target {
    const char *what, *name, *number, *per, *unit;
    double wanted;
    bool is_most; // at most as much, not at least
} targets[] = {
    {"ray-replay efficiency", "cornell", "eta", NULL, "", 0.65, false},
    {"ray-replay efficiency", "glossy", "eta", NULL, "", 0.65, false},
    {"ray-replay efficiency", "emitters", "eta", NULL, "", 0.65, false},
    {"ray-replay efficiency", "mesh", "eta", NULL, "", 0.75, false},
    {"efficiency of all threads", "cornell", "thread_efficiency", NULL, "", 0.97, false},
    {"efficiency of all threads", "mesh", "thread_efficiency", NULL, "", 0.97, false},
    {"efficiency of all threads", "glossy", "thread_efficiency", NULL, "", 0.97, false},
    {"efficiency of all threads", "emitters", "thread_efficiency", NULL, "", 0.97, false},
    {"peak memory", "mesh", "peak_memory_B", "triangles", "B/triangle", 90, true},
};

// what a run of this program cannot tell
static const char elsewhere[] =
    "Elsewhere: speed at equal error and time to the first pixel against another renderer, bench/compare-renderers (>= 6 and >= 3\n"
    "times pbrt-v4's); closed forms to 1.25e-4, make validate; error bars, tests/analytic/coverage_test.c; scattering models,\n"
    "steradian brdf check --all; one SHA-256 over threads and tiles, tests/agree; wrong builds caught, make mutants.\n";

void print_targets(FILE *out, json_t *const *lines, size_t count)
{
    bool has_any = false;
    for (size_t t = 0; t < sizeof targets / sizeof *targets; ++t)
        for (size_t i = 0; i < count; ++i) {
            const struct target *a = &targets[t];
            const char *name = json_string_value(json_object_get(lines[i], "case"));
            const json_t *number = json_object_get(lines[i], a->number),
                         *per = a->per ? json_object_get(lines[i], a->per) : NULL;
            if (!name || strcmp(name, a->name) != 0 || !json_is_number(number) ||
                (a->per && !(json_number_value(per) > 0)))
                continue;
            double reached = json_number_value(number) / (per ? json_number_value(per) : 1);
            if (!has_any)
                fprintf(out, "\n%-28s %-10s %14s %9s\n", "what", "case", "wanted", "reached");
            has_any = true;
            fprintf(out, "%-28s %-10s %s %11.4g %9.3g  %s %s\n", a->what, a->name, a->is_most ? "<=" : ">=", a->wanted,
                    reached, a->unit, (a->is_most ? reached <= a->wanted : reached >= a->wanted) ? "" : "MISSED");
        }
    if (has_any)
        fputs(elsewhere, out);
}
