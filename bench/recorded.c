/* SPDX-License-Identifier: MIT */
/* The log of steradian-mpi --unit-log, read back: a line for each unit, and one about the messages at the end. */
#include "recorded.h"
#include "film/film.h"

#include <stdio.h>
#include <stdlib.h>

enum { UNIT_HEADER_B = 48 };

struct unit {
    uint32_t tile, block;
    struct recorded_tile place;
    double cost_s;
};

bool recorded_read(const char *path, struct recorded *r)
{
    FILE *file = fopen(path, "r");
    char line[512];
    uint64_t units = 0, room = 0;
    double bytes = 0, take_s = 0, sent = 0;
    struct unit *all = NULL, u;
    *r = (struct recorded){0};
    while (file && fgets(line, sizeof line, file)) {
        double messages;
        uint32_t rank;
        if (line[0] == '#' && sscanf(line, "# renderers %*d threads %*u messages %lf bytes %lf take_s %lf", &messages,
                                     &bytes, &take_s) == 3)
            continue;
        if (sscanf(line, "%u\t%u\t%u\t%u\t%u\t%u\t%u\t%lf", &u.tile, &u.block, &u.place.x, &u.place.y, &u.place.width,
                   &u.place.height, &rank, &u.cost_s) != 8)
            continue;
        if (units == room) {
            uint64_t more = 2 * room + 1024;
            all = sr_realloc(all, room * sizeof *all, more * sizeof *all);
            room = more;
            if (!all)
                exit(SR_ERROR_RESOURCE);
        }
        all[units++] = u;
        r->tiles = u.tile >= r->tiles ? u.tile + 1 : r->tiles;
        r->blocks = u.block >= r->blocks ? u.block + 1 : r->blocks;
        r->width = u.place.x + u.place.width > r->width ? u.place.x + u.place.width : r->width;
        r->height = u.place.y + u.place.height > r->height ? u.place.y + u.place.height : r->height;
        sent += rank > 0;
    }
    if (file)
        fclose(file);
    r->cost_s = units ? sr_alloc((size_t)r->tiles * r->blocks * sizeof *r->cost_s) : NULL;
    r->of_tile = units ? sr_alloc((size_t)r->tiles * sizeof *r->of_tile) : NULL;
    if (units && (!r->cost_s || !r->of_tile))
        exit(SR_ERROR_RESOURCE);
    for (uint64_t i = 0; i < units; ++i) {
        r->cost_s[(size_t)all[i].tile * r->blocks + all[i].block] = all[i].cost_s;
        r->of_tile[all[i].tile] = all[i].place;
    }
    sr_free(all);
    // nothing was sent: what a batch holds of a unit, with all channels (src/render/crew.c)
    r->unit_B = sent > 0 ? bytes / sent
                         : UNIT_HEADER_B +
                               (double)r->width * r->height / (r->tiles ? r->tiles : 1) * sizeof(struct sr_film_block);
    r->take_s = bytes > 0 ? take_s / bytes : 5e-10;
    return units > 0;
}

void recorded_free(struct recorded *r)
{
    sr_free(r->cost_s);
    sr_free(r->of_tile);
}

double recorded_total_s(const struct recorded *r)
{
    double sum_s = 0;
    for (size_t i = 0; i < (size_t)r->tiles * r->blocks; ++i)
        sum_s += r->cost_s[i];
    return sum_s;
}
