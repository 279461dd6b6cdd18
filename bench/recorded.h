/* SPDX-License-Identifier: MIT */
/* What the units of a picture have cost: the log of steradian-mpi --unit-log, read back. */
#ifndef SR_BENCH_RECORDED_H
#define SR_BENCH_RECORDED_H

#include "base/base.h"

struct recorded_tile {
    uint32_t x, y, width, height; // [pixel]
};

struct recorded {
    uint32_t tiles, blocks, width, height;
    double *cost_s; // [tile * blocks + block], of one thread
    struct recorded_tile *of_tile;
    double unit_B; // that a helper's unit takes on its way
    double take_s; // that rank 0 needs for a byte of it
};

/* false: no such file, or no units are in it. */
bool recorded_read(const char *path, struct recorded *r);
void recorded_free(struct recorded *r);
double recorded_total_s(const struct recorded *r);

#endif
