/* SPDX-License-Identifier: MIT */
#ifndef SR_BENCH_TARGETS_H
#define SR_BENCH_TARGETS_H

#include <jansson.h>
#include <stdio.h>

/* A table of what the cases' lines have reached; nothing where they have none of what is wanted. */
void print_targets(FILE *out, json_t *const *lines, size_t count);

#endif
