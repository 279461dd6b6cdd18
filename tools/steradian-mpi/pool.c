/* SPDX-License-Identifier: MIT */
/* How the tiles of a picture are dealt to processes: a share of what remains, so that deals shrink towards the end.
 *
 *     n = remaining tiles * threads of the process / (SPLIT * threads of all),    at most LONGEST_S of work, at least 1
 *
 * Guided self-scheduling: C. Polychronopoulos & D. Kuck 1987, with SPLIT > 1 as tiles differ in cost. The limit in time
 * keeps what a slow process may hold small in long renders; before any cost is known, deals are a quarter of that.
 * Limits: a tile is never parted, so that the end waits for the dearest of the last tiles. */
#include "pool.h"

enum { SPLIT = 4, FIRST_SPLIT = 16 };
static const double LONGEST_S = 2; // [s] that a deal takes

bool pool_deal(struct pool *p, uint32_t threads, uint32_t process, bool *has_share, struct deal *deal)
{
    if (p->shares) {
        if (*has_share || process >= p->tiles)
            return false;
        *has_share = true;
        *deal = (struct deal){process, p->tiles, p->shares};
        return true;
    }
    if (p->next >= p->tiles)
        return false;
    uint32_t left = p->tiles - p->next;
    double n = (double)left * threads / ((double)(p->done ? SPLIT : FIRST_SPLIT) * p->threads);
    if (p->done && p->cost_s > 0) {
        double most = LONGEST_S * threads * (double)p->done / p->cost_s;
        n = n < most ? n : most;
    }
    uint32_t count = n > 1 ? (uint32_t)n : 1;
    *deal = (struct deal){p->next, p->next + count, 1};
    p->next += count;
    return true;
}

uint32_t deal_tiles(const struct deal *d)
{
    return (d->end - d->begin + d->step - 1) / d->step;
}
