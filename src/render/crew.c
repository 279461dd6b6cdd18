/* SPDX-License-Identifier: MIT */
/* What a helper has made, as bytes that the owner of the picture adds to its film.
 *
 * A batch: its header, then each unit's header with the sums of its pixels (and their wavelengths' buckets), then what
 * its paths have splatted. Numbers are as they stand in memory: all processes run the same program on the same kind of
 * processor.
 *
 * Splats of a unit can come long before the unit is done, so that a batch is closed only when all units that began in
 * it are done; meanwhile others begin in a second batch. */
#define _POSIX_C_SOURCE 200809L
#include "render/private.h"

#include <pthread.h>
#include <string.h>

static const double PLAIN_INTERVAL_S = 0.1, SPLATS_INTERVAL_S = 2;
static const double PACKING_SHARE = 0.02; // [1] of a helper's time that may go into packing splats
enum { ENOUGH_B = 1 << 20 };              // of plain units

struct batch_header {
    uint64_t units_B, splats_B;
    struct sr_render_counts counts;
};

struct unit_header {
    struct sr_crew_unit unit;
    uint32_t pixels, none;
    uint64_t size; // [B] of what follows
};

/* A pixel's sums without what is seen first. */
struct lean_block {
    double rgb[3];
    uint32_t n, dropped;
    float largest, none;
};

struct sr_crew_batch {
    uint8_t *bytes; // header and units
    size_t size, room;
    struct sr_render_counts counts;
    struct sr_film splats; // its member of this name: NULL where there are none
    int under_way;
    bool is_closing;
};

struct sr_crew_batches {
    const struct sr_render_crew *crew;
    uint32_t buckets;
    bool is_full, has_failed; // is_full: blocks with all members
    pthread_mutex_t lock;
    struct sr_crew_batch batch[2];
    int current;
    double opened_s, interval_s;
};

static void add_counts(struct sr_render_counts *a, const struct sr_render_counts *b)
{
    a->paths += b->paths;
    a->rays += b->rays;
    a->shadow_rays += b->shadow_rays;
    a->vertices += b->vertices;
    a->dropped += b->dropped;
    if (b->has_dropped && (!a->has_dropped || sr_render_is_earlier(b->first_dropped, a->first_dropped))) {
        memcpy(a->first_dropped, b->first_dropped, sizeof a->first_dropped);
        a->has_dropped = 1;
    }
}

/* ---- what a crew agrees upon ---- */

sr_status sr_crew_film_create(const struct sr_render_job *job, struct sr_film **film, struct sr_error *error)
{
    bool is_helper = job->crew && job->crew->is_helper;
    struct sr_film_settings settings = job->film;
    if (is_helper)
        settings.buckets = 0;
    return sr_film_create(&settings, job->with_aov && !is_helper, film, error);
}

sr_status sr_crew_share(const struct sr_render_job *job, uint32_t *numbers, size_t count, struct sr_error *error)
{
    return job->crew ? job->crew->share(job->crew->self, numbers, count * sizeof *numbers, error) : SR_OK;
}

sr_status sr_crew_share_keeper(const struct sr_render_job *job, struct sr_keeper *keeper, struct sr_error *error)
{
    uint32_t numbers[] = {keeper->pass, keeper->kept.is_resumed, keeper->is_complete};
    sr_status status = sr_crew_share(job, numbers, sizeof numbers / sizeof numbers[0], error);
    keeper->pass = numbers[0];
    keeper->kept.is_resumed = numbers[1];
    keeper->is_complete = numbers[2];
    return status;
}

/* ---- writing ---- */

struct sr_crew_batches *sr_crew_batches_create(const struct sr_render_job *job, const struct sr_film *film,
                                               struct sr_error *error)
{
    struct sr_crew_batches *b = sr_alloc(sizeof *b);
    if (!b) {
        sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
        return NULL;
    }
    *b = (struct sr_crew_batches){.crew = job->crew,
                                  .buckets = job->film.buckets,
                                  .is_full = job->with_aov,
                                  .opened_s = sr_clock_s(),
                                  .interval_s = film->splats ? SPLATS_INTERVAL_S : PLAIN_INTERVAL_S};
    pthread_mutex_init(&b->lock, NULL);
    for (int i = 0; i < 2; ++i) {
        struct sr_film *splats = &b->batch[i].splats;
        *splats = (struct sr_film){.settings = film->settings, .width = film->width, .height = film->height};
        if (film->splats && sr_film_add_splats(splats, film->splats->groups, film->splats->unit, error) != SR_OK) {
            sr_crew_batches_destroy(b);
            return NULL;
        }
    }
    return b;
}

void sr_crew_batches_destroy(struct sr_crew_batches *b)
{
    if (!b)
        return;
    for (int i = 0; i < 2; ++i) {
        if (b->batch[i].splats.splats)
            sr_free(b->batch[i].splats.splats->words);
        sr_free(b->batch[i].splats.splats);
        sr_free(b->batch[i].bytes);
    }
    pthread_mutex_destroy(&b->lock);
    sr_free(b);
}

/* Room for so many more bytes at the batch's end, zero; NULL: no memory. */
static void *grow(struct sr_crew_batch *batch, size_t size)
{
    size_t header_B = batch->size ? 0 : sizeof(struct batch_header), end = batch->size + header_B + size;
    if (end > batch->room) {
        size_t room = end + end / 2;
        uint8_t *grown = sr_realloc(batch->bytes, batch->room, room);
        if (!grown)
            return NULL;
        batch->bytes = grown;
        batch->room = room;
    }
    batch->size = end;
    return batch->bytes + end - size;
}

/* The batch goes to the owner and is empty again. */
static bool hand_over(struct sr_crew_batches *b, struct sr_crew_batch *batch)
{
    if (!grow(batch, 0))
        return false;
    struct batch_header header = {.units_B = batch->size - sizeof header, .counts = batch->counts};
    if (batch->splats.splats) {
        size_t size;
        uint8_t *splats = sr_film_splats_pack(&batch->splats, &size);
        void *to = splats ? grow(batch, size) : NULL;
        if (to)
            memcpy(to, splats, size);
        sr_free(splats);
        if (!to)
            return false;
        header.splats_B = size;
    }
    memcpy(batch->bytes, &header, sizeof header);
    b->crew->hand(b->crew->self, batch->bytes, batch->size);
    batch->bytes = NULL;
    batch->size = batch->room = 0;
    batch->counts = (struct sr_render_counts){0};
    return true;
}

struct sr_crew_batch *sr_crew_enter(struct sr_crew_batches *b, struct sr_film **splats)
{
    pthread_mutex_lock(&b->lock);
    struct sr_crew_batch *batch = &b->batch[b->current];
    ++batch->under_way;
    pthread_mutex_unlock(&b->lock);
    *splats = &batch->splats;
    return batch;
}

static bool put_unit(const struct sr_crew_batches *b, struct sr_crew_batch *batch, const struct sr_crew_unit *unit,
                     uint32_t pixels, const struct sr_film_block *blocks, const double *buckets)
{
    size_t buckets_B = (size_t)pixels * b->buckets * sizeof *buckets;
    size_t blocks_B = pixels * (b->is_full ? sizeof *blocks : sizeof(struct lean_block));
    struct unit_header header = {.unit = *unit, .pixels = pixels, .size = blocks_B + buckets_B};
    uint8_t *to = grow(batch, sizeof header + blocks_B + buckets_B);
    if (!to)
        return false;
    memcpy(to, &header, sizeof header);
    to += sizeof header;
    if (b->is_full)
        memcpy(to, blocks, blocks_B);
    for (size_t i = 0; !b->is_full && i < pixels; ++i) {
        struct lean_block lean = {.n = blocks[i].n, .dropped = blocks[i].dropped, .largest = blocks[i].largest};
        memcpy(lean.rgb, blocks[i].rgb, sizeof lean.rgb);
        memcpy(to + i * sizeof lean, &lean, sizeof lean);
    }
    if (b->buckets)
        memcpy(to + blocks_B, buckets, buckets_B);
    return true;
}

void sr_crew_leave(struct sr_crew_batches *b, struct sr_crew_batch *batch, const struct sr_crew_unit *unit,
                   uint32_t pixels, const struct sr_film_block *blocks, const double *buckets,
                   const struct sr_render_counts *counts)
{
    pthread_mutex_lock(&b->lock);
    bool has_splats = batch->splats.splats;
    if (pixels)
        b->has_failed |= !put_unit(b, batch, unit, pixels, blocks, buckets);
    add_counts(&batch->counts, counts);
    --batch->under_way;
    double now = sr_clock_s();
    struct sr_crew_batch *open = &b->batch[b->current], *other = &b->batch[!b->current];
    bool is_due = now - b->opened_s >= b->interval_s || (!has_splats && open->size >= ENOUGH_B);
    if (is_due && !has_splats) {
        b->has_failed |= !hand_over(b, open);
        b->opened_s = now;
    } else if (is_due && !other->is_closing && !other->under_way) {
        open->is_closing = true;
        b->current = !b->current;
        b->opened_s = now;
    }
    if (batch->is_closing && !batch->under_way) {
        // nobody else touches it: the others of this process go on while it is packed. Batches leave in the order they
        // were closed, as the next one cannot be closed before this one is through
        pthread_mutex_unlock(&b->lock);
        bool is_ok = hand_over(b, batch);
        pthread_mutex_lock(&b->lock);
        b->has_failed |= !is_ok;
        b->interval_s = fmax(SPLATS_INTERVAL_S, (sr_clock_s() - now) / PACKING_SHARE);
        batch->is_closing = false;
    }
    pthread_mutex_unlock(&b->lock);
}

bool sr_crew_finish(struct sr_crew_batches *b)
{
    return hand_over(b, &b->batch[b->current]) && !b->has_failed;
}

/* ---- reading ---- */

static void read_unit(struct sr_crew_reader *r, const struct unit_header *header, const uint8_t *from)
{
    struct sr_film *film = r->film;
    const struct sr_crew_unit *unit = &header->unit;
    uint32_t width = unit->x1 - unit->x0;
    size_t block_B = film->has_aov ? sizeof(struct sr_film_block) : sizeof(struct lean_block);
    const double *buckets = (const double *)(const void *)(from + header->pixels * block_B);
    for (uint32_t i = 0; i < header->pixels; ++i, from += block_B, buckets += film->settings.buckets) {
        uint32_t x = unit->x0 + i % width, y = unit->y0 + i / width;
        if (r->had && r->had[(size_t)y * film->width + x] > r->blocks_before + unit->block)
            continue;
        struct sr_film_block block = {0};
        if (film->has_aov) {
            memcpy(&block, from, sizeof block);
        } else {
            struct lean_block lean;
            memcpy(&lean, from, sizeof lean);
            memcpy(block.rgb, lean.rgb, sizeof block.rgb);
            block.n = lean.n, block.dropped = lean.dropped, block.largest = lean.largest;
        }
        if (film->settings.buckets)
            sr_film_store_buckets(film, x, y, buckets);
        sr_film_store(film, x, y, &block);
    }
    r->units += header->pixels == width * (unit->y1 - unit->y0);
}

void sr_crew_read(struct sr_crew_reader *r, const void *bytes, size_t size)
{
    struct batch_header header;
    const uint8_t *at = bytes, *end = at + size;
    memcpy(&header, at, sizeof header);
    at += sizeof header;
    add_counts(&r->counts, &header.counts);
    const uint8_t *splats = at + header.units_B;
    while (at < splats) {
        struct unit_header unit;
        memcpy(&unit, at, sizeof unit);
        at += sizeof unit;
        read_unit(r, &unit, at);
        at += unit.size;
        if (r->crew->note)
            r->crew->note(r->crew->self, &unit.unit);
    }
    if (header.splats_B)
        sr_film_splats_add(r->film, splats, (size_t)(end - splats));
}
