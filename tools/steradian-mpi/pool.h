/* SPDX-License-Identifier: MIT */
/* How the tiles of a picture are dealt to processes: large deals first, small ones at the end. */
#ifndef SR_TOOLS_MPI_POOL_H
#define SR_TOOLS_MPI_POOL_H

#include <stdbool.h>
#include <stdint.h>

/* Tiles begin, begin + step … < end. */
struct deal {
    uint32_t begin, end, step;
};

struct pool {
    uint32_t tiles, next; // next: the first that nobody has
    uint32_t threads;     // of all processes
    uint32_t shares;      // 0, or each of so many processes gets one share alone, by its number
    double cost_s;        // [s] of all tiles that are done, of one thread
    uint64_t done;        // how many these are
};

/* The next tiles for a process with so many threads; false: there are none left. has_share: a process's own, where
 * there are shares. */
bool pool_deal(struct pool *p, uint32_t threads, uint32_t process, bool *has_share, struct deal *deal);
uint32_t deal_tiles(const struct deal *d);

#endif
