/* SPDX-License-Identifier: MIT */
/* steradian-mpi: a table of what each unit has cost, for bench/simulate-ranks. Its last line tells what the messages
 * have cost. */
#include "ranks.h"

#include <string.h>
#include <sys/stat.h>

static const char first_line[] = "tile\tblock\tx\ty\twidth\theight\trank\tcost_s\tend_s\n";

/* Whether the path holds something else than a log: a picture, or the scene. */
static bool would_be_lost(const char *path)
{
    struct stat about;
    char line[sizeof first_line] = "";
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size == 0)
        return false;
    FILE *file = fopen(path, "r");
    bool is_log = file && fgets(line, sizeof line, file) && strcmp(line, first_line) == 0;
    if (file)
        fclose(file);
    return !is_log;
}

bool unit_log_open(struct crew *c, const char *path)
{
    if (!path || c->hooks.is_helper)
        return true;
    if (would_be_lost(path)) {
        fprintf(stderr, "steradian-mpi: error: --unit-log %s: is no unit log: it would be lost\n", path);
        return false;
    }
    c->unit_log = fopen(path, "w");
    if (!c->unit_log) {
        fprintf(stderr, "steradian-mpi: error: %s: cannot be written\n", path);
        return false;
    }
    fputs(first_line, c->unit_log);
    return true;
}

void unit_log_note(struct crew *c, const struct sr_crew_unit *u)
{
    if (c->unit_log)
        fprintf(c->unit_log, "%u\t%u\t%u\t%u\t%u\t%u\t%d\t%.6f\t%.6f\n", u->tile, u->block, u->x0, u->y0, u->x1 - u->x0,
                u->y1 - u->y0, crew_taking_from, u->cost_s, sr_clock_s() - c->start_s);
}

bool unit_log_close(struct crew *c)
{
    if (!c->unit_log)
        return true;
    fprintf(c->unit_log,
            "# renderers %d threads %u messages %llu bytes %llu take_s %.6f elapsed_s %.6f passes_s %.6f\n",
            c->place.renderers, c->pool.threads, (unsigned long long)c->messages, (unsigned long long)c->message_B,
            c->took_s, sr_clock_s() - c->start_s, c->passes_s);
    bool is_written = !ferror(c->unit_log);
    if (fclose(c->unit_log) == 0 && is_written)
        return true;
    fprintf(stderr, "steradian-mpi: error: the unit log could not be written\n");
    return false;
}
