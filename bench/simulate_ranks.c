/* SPDX-License-Identifier: MIT */
/* What a picture would take on more processors than there are: recorded costs of its units, dealt as steradian-mpi
 * deals them.
 *
 * Events: a thread ends a unit; a wish, a deal, a batch of finished units, a helper's farewell arrives. Rank 0 serves
 * what arrives one by one:
 *
 *     start = arrival + nap / 2 where it was idle, else when it is free
 *     busy for serve + bytes * (take + 1 / bandwidth)
 *
 * A message of B bytes is under way for  latency + B / bandwidth.  Deals come from the very code of steradian-mpi
 * (pool.c). Limits: threads of a rank do not slow each other down, rank 0's messages take no processor from its
 * threads, the network has no neighbours; the wait of a tile's blocks for each other is left out, and splats, whose
 * batches are fewer and larger. What it foretells is compared with real deals and messages by bench/rehearse-ranks.
 * docs/guide/many-machines.md */
#include "recorded.h"
#include "../tools/steradian-mpi/pool.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: simulate-ranks UNIT-LOG [OPTIONS]\n"
    "\n"
    "Replays the log of steradian-mpi --unit-log on so many ranks, and prints a table of times and efficiencies.\n"
    "\n"
    "      --ranks N[,N…]     (default: 1,2,3,4)\n"
    "      --threads T        of each rank (default: 1)\n"
    "      --pixels K         of a picture with K times as many pixels (default: 1)\n"
    "      --samples K        and K times as many samples (default: 1)\n"
    "      --latency S        of a message [s] (default: 2e-6)\n"
    "      --bandwidth B      [B/s] (default: 1e10)\n"
    "      --take S           [s] that rank 0 needs for a byte (default: that of the log)\n"
    "      --serve S          [s] that rank 0 needs for a message (default: 3e-6)\n"
    "      --unit-bytes B     of a finished unit (default: as in the log)\n"
    "      --nap S            [s] between looks for messages (default: 1e-3)\n"
    "      --load S           [s] that every rank loads before; the efficiency counts it (default: 0)\n"
    "      --tsv              the table with tabulators\n";

struct model {
    double latency_s, bytes_per_s, take_s, serve_s, nap_s, load_s, samples, unit_B;
    uint32_t threads, pixels;
};

/* ---- events ---- */

enum kind { UNIT_ENDS, WISH_ARRIVES, DEAL_ARRIVES, BATCH_ARRIVES, PASSED_ARRIVES };
struct event {
    double at_s;
    enum kind kind;
    uint32_t rank;
    struct deal deal;      // of a unit: its tile and block
    uint32_t units, tiles; // of a batch: how many are done with it
    double cost_s;         // of these units
};

struct rank {
    struct deal deals[4];
    uint32_t deal_count, idle;
    uint64_t position, waiting; // waiting: dealt and not begun
    bool is_asked, is_exhausted, has_share, has_passed;
    struct event batch; // what has not been sent
    double batch_since_s;
};

// steradian-mpi's: src/render/crew.c, pump.c
static const double BATCH_INTERVAL_S = 0.1;
enum { ENOUGH_B = 1 << 20, PIECE_B = 4 << 20, GREETINGS = 2 }; // a helper says that it is ready, and that it has ended

struct simulation {
    const struct recorded *log;
    const struct model *model;
    struct pool pool;
    struct rank *ranks;
    uint32_t rank_count;
    struct event *heap;
    size_t count, room;
    double owner_free_s, owner_busy_s, end_s, work_s;
    uint64_t messages;
    double bytes;
};

static void push(struct simulation *s, struct event e)
{
    if (s->count == s->room) {
        size_t room = s->room * 2 + 1024;
        s->heap = sr_realloc(s->heap, s->room * sizeof e, room * sizeof e);
        s->room = room;
        if (!s->heap)
            exit(SR_ERROR_RESOURCE);
    }
    size_t i = s->count++;
    for (; i && s->heap[(i - 1) / 2].at_s > e.at_s; i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = e;
}

static struct event pop(struct simulation *s)
{
    struct event top = s->heap[0], last = s->heap[--s->count];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < s->count; i = child) {
        child += child + 1 < s->count && s->heap[child + 1].at_s < s->heap[child].at_s;
        if (s->heap[child].at_s >= last.at_s)
            break;
        s->heap[i] = s->heap[child];
    }
    s->heap[i] = last;
    return top;
}

/* ---- what ranks do ---- */

static double way_s(const struct simulation *s, double bytes)
{
    return s->model->latency_s + bytes / s->model->bytes_per_s;
}

/* When rank 0 is through with what arrives at this time. */
static double served_s(struct simulation *s, double at_s, double bytes)
{
    double busy = s->model->serve_s + bytes * (s->model->take_s + 1 / s->model->bytes_per_s);
    double start = s->owner_free_s > at_s ? s->owner_free_s : at_s + s->model->nap_s / 2;
    s->owner_free_s = start + busy;
    s->owner_busy_s += busy;
    s->messages += 1 + (uint64_t)(bytes / PIECE_B);
    s->bytes += bytes;
    return s->owner_free_s;
}

static double unit_cost_s(const struct simulation *s, uint32_t tile, uint32_t block)
{
    return s->log->cost_s[(size_t)(tile / s->model->pixels) * s->log->blocks + block] * s->model->samples;
}

static bool take_deal(struct simulation *s, uint32_t r, struct deal *d)
{
    return pool_deal(&s->pool, s->model->threads, r, &s->ranks[r].has_share, d);
}

static void give(struct simulation *s, struct rank *rank, const struct deal *d)
{
    rank->deals[rank->deal_count++] = *d;
    rank->waiting += (uint64_t)deal_tiles(d) * s->log->blocks;
}

static void send_batch(struct simulation *s, struct rank *rank, uint32_t r, double now_s)
{
    rank->batch.kind = BATCH_ARRIVES;
    rank->batch.rank = r;
    rank->batch.at_s = now_s + s->model->nap_s / 2 + way_s(s, rank->batch.units * s->log->unit_B);
    push(s, rank->batch);
    rank->batch = (struct event){0};
    rank->batch_since_s = now_s;
}

/* Idle threads begin what there is; whoever runs short asks for more; a helper without work sends what it has and says
 * that it is through. */
static void go_on(struct simulation *s, uint32_t r, double now_s)
{
    struct rank *rank = &s->ranks[r];
    struct deal more;
    for (;;) {
        if (rank->deal_count == 0 && r == 0 && rank->idle && take_deal(s, 0, &more))
            give(s, rank, &more);
        if (rank->deal_count == 0 || rank->idle == 0)
            break;
        const struct deal *d = &rank->deals[0];
        uint32_t tiles = deal_tiles(d), tile = d->begin + (uint32_t)(rank->position % tiles) * d->step,
                 block = (uint32_t)(rank->position / tiles);
        double cost_s = unit_cost_s(s, tile, block);
        s->work_s += cost_s;
        push(s, (struct event){.at_s = now_s + cost_s, .kind = UNIT_ENDS, .rank = r, .deal = {tile, block, 1}});
        --rank->idle;
        --rank->waiting;
        if (++rank->position == (uint64_t)tiles * s->log->blocks) {
            memmove(&rank->deals[0], &rank->deals[1], --rank->deal_count * sizeof rank->deals[0]);
            rank->position = 0;
        }
    }
    if (r && !rank->is_asked && !rank->is_exhausted && rank->deal_count < 4 && rank->waiting <= s->model->threads) {
        rank->is_asked = true;
        push(s, (struct event){.at_s = now_s + s->model->nap_s / 2 + way_s(s, 0), .kind = WISH_ARRIVES, .rank = r});
    }
    if (r && rank->is_exhausted && !rank->has_passed && rank->deal_count == 0 && rank->idle == s->model->threads) {
        rank->has_passed = true;
        send_batch(s, rank, r, now_s);
        push(s, (struct event){.at_s = now_s + s->model->nap_s / 2 + way_s(s, 0), .kind = PASSED_ARRIVES, .rank = r});
    }
}

static void end_unit(struct simulation *s, const struct event *e)
{
    struct rank *rank = &s->ranks[e->rank];
    double cost_s = unit_cost_s(s, e->deal.begin, e->deal.end);
    bool is_tile_done = e->deal.end + 1 == s->log->blocks;
    ++rank->idle;
    if (e->rank == 0) {
        s->pool.cost_s += cost_s;
        s->pool.done += is_tile_done;
        s->end_s = fmax(s->end_s, e->at_s);
    } else {
        rank->batch.units += 1;
        rank->batch.tiles += is_tile_done;
        rank->batch.cost_s += cost_s;
        if (e->at_s - rank->batch_since_s >= BATCH_INTERVAL_S || rank->batch.units * s->log->unit_B >= ENOUGH_B)
            send_batch(s, rank, e->rank, e->at_s);
    }
    go_on(s, e->rank, e->at_s);
}

static void happen(struct simulation *s, struct event *e)
{
    struct rank *rank = &s->ranks[e->rank];
    struct event answer = {.kind = DEAL_ARRIVES, .rank = e->rank};
    switch (e->kind) {
    case UNIT_ENDS:
        end_unit(s, e);
        break;
    case WISH_ARRIVES:
        if (!take_deal(s, e->rank, &answer.deal))
            answer.deal = (struct deal){0, 0, 1};
        answer.at_s = served_s(s, e->at_s, 0) + way_s(s, 12) + s->model->nap_s / 2;
        push(s, answer);
        break;
    case DEAL_ARRIVES:
        rank->is_asked = false;
        if (e->deal.end > e->deal.begin)
            give(s, rank, &e->deal);
        else
            rank->is_exhausted = true;
        go_on(s, e->rank, e->at_s);
        break;
    case BATCH_ARRIVES:
        s->end_s = fmax(s->end_s, served_s(s, e->at_s, e->units * s->log->unit_B));
        s->pool.done += e->tiles;
        s->pool.cost_s += e->cost_s;
        break;
    case PASSED_ARRIVES:
        s->end_s = fmax(s->end_s, served_s(s, e->at_s, 0));
        s->messages += GREETINGS;
        break;
    }
}

static void simulate(const struct recorded *log, const struct model *m, uint32_t ranks, bool is_tsv)
{
    struct simulation s = {.log = log,
                           .model = m,
                           .rank_count = ranks,
                           .ranks = sr_alloc(ranks * sizeof *s.ranks),
                           .pool = {.tiles = log->tiles * m->pixels, .threads = ranks * m->threads}};
    if (!s.ranks)
        exit(SR_ERROR_RESOURCE);
    for (uint32_t r = 0; r < ranks; ++r)
        s.ranks[r].idle = m->threads;
    for (uint32_t r = 0; r < ranks; ++r)
        go_on(&s, r, 0);
    while (s.count) {
        struct event e = pop(&s);
        happen(&s, &e);
    }
    double cores = (double)ranks * m->threads, efficiency = s.work_s / (cores * (s.end_s + m->load_s));
    printf(is_tsv ? "%u\t%.0f\t%.4f\t%.4f\t%llu\t%.4g\t%.4f\n"
                  : "%8u %8.0f %12.3f s %10.2f %% %12llu %10.2f MB %9.2f %%\n",
           ranks, cores, s.end_s + m->load_s, efficiency * (is_tsv ? 1 : 100), (unsigned long long)s.messages,
           s.bytes * (is_tsv ? 1 : 1e-6), s.owner_busy_s / s.end_s * (is_tsv ? 1 : 100));
    sr_free(s.heap);
    sr_free(s.ranks);
}

int main(int argc, char **argv)
{
    struct model m = {.latency_s = 2e-6,
                      .bytes_per_s = 1e10,
                      .take_s = -1,
                      .serve_s = 3e-6,
                      .nap_s = 1e-3,
                      .samples = 1,
                      .threads = 1,
                      .pixels = 1};
    const char *ranks = "1,2,3,4", *path = NULL;
    bool is_tsv = false;
    const struct {
        const char *name;
        double *value;
    } numbers[] = {{"--latency", &m.latency_s}, {"--bandwidth", &m.bytes_per_s},
                   {"--take", &m.take_s},       {"--serve", &m.serve_s},
                   {"--nap", &m.nap_s},         {"--load", &m.load_s},
                   {"--samples", &m.samples},   {"--unit-bytes", &m.unit_B}};
    for (int i = 1; i < argc; ++i) {
        const char *value = i + 1 < argc ? argv[i + 1] : "0";
        bool is_known = false;
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; ++k)
            if (strcmp(argv[i], numbers[k].name) == 0) {
                *numbers[k].value = atof(value);
                is_known = true;
            }
        if (is_known) {
            ++i;
        } else if (strcmp(argv[i], "--ranks") == 0) {
            ranks = value, ++i;
        } else if (strcmp(argv[i], "--threads") == 0) {
            m.threads = (uint32_t)atoi(value), ++i;
        } else if (strcmp(argv[i], "--pixels") == 0) {
            m.pixels = (uint32_t)atoi(value), ++i;
        } else if (strcmp(argv[i], "--tsv") == 0) {
            is_tsv = true;
        } else if (argv[i][0] == '-' || path) {
            fputs(help, strcmp(argv[i], "--help") ? stderr : stdout);
            return strcmp(argv[i], "--help") ? SR_ERROR_USAGE : 0;
        } else {
            path = argv[i];
        }
    }
    struct recorded log;
    if (!path || m.threads < 1 || m.pixels < 1) {
        fputs(help, stderr);
        return SR_ERROR_USAGE;
    }
    if (!recorded_read(path, &log)) {
        fprintf(stderr, "simulate-ranks: %s: no units of a log are in it\n", path);
        return SR_ERROR_INPUT;
    }
    log.unit_B = m.unit_B > 0 ? m.unit_B : log.unit_B;
    m.take_s = m.take_s < 0 ? log.take_s : m.take_s;
    printf(is_tsv ? "ranks\tcores\ttime_s\tefficiency\tmessages\tbytes\trank0\n" : "%8s %8s %14s %12s %12s %13s %11s\n",
           "ranks", "cores", "time", "efficiency", "messages", "bytes", "rank 0");
    for (const char *p = ranks; *p; p += strcspn(p, ","), p += *p == ',')
        if (atoi(p) > 0)
            simulate(&log, &m, (uint32_t)atoi(p), is_tsv);
    recorded_free(&log);
    return 0;
}
