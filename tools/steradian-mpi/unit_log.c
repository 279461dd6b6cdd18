/* SPDX-License-Identifier: MIT */
/* steradian-mpi: a table of what each unit has cost, for bench/simulate-ranks. Its last line tells what the messages
 * have cost. */
#include "ranks.h"

bool unit_log_open(struct crew *c, const char *path)
{
    if (!path || c->hooks.is_helper)
        return true;
    c->unit_log = fopen(path, "w");
    if (!c->unit_log) {
        fprintf(stderr, "steradian-mpi: error: %s: cannot be written\n", path);
        return false;
    }
    fprintf(c->unit_log, "tile\tblock\tx\ty\twidth\theight\trank\tcost_s\tend_s\n");
    return true;
}

void unit_log_note(struct crew *c, const struct sr_crew_unit *u)
{
    if (c->unit_log)
        fprintf(c->unit_log, "%u\t%u\t%u\t%u\t%u\t%u\t%d\t%.6f\t%.6f\n", u->tile, u->block, u->x0, u->y0, u->x1 - u->x0,
                u->y1 - u->y0, crew_taking_from, u->cost_s, sr_clock_s() - c->start_s);
}

void unit_log_close(struct crew *c)
{
    if (!c->unit_log)
        return;
    fprintf(c->unit_log,
            "# renderers %d threads %u messages %llu bytes %llu take_s %.6f elapsed_s %.6f passes_s %.6f\n",
            c->place.renderers, c->pool.threads, (unsigned long long)c->messages, (unsigned long long)c->message_B,
            c->took_s, sr_clock_s() - c->start_s, c->passes_s);
    if (fclose(c->unit_log) != 0)
        fprintf(stderr, "warning: the unit log could not be written\n");
}
