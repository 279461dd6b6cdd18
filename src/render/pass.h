/* SPDX-License-Identifier: MIT */
/* A pass over the picture while it runs: what its units, its workers and whoever looks at its film share. */
#ifndef SR_RENDER_PASS_H
#define SR_RENDER_PASS_H

#include "render/private.h"

#include <pthread.h>

struct run {
    const struct sr_render_job *job;
    const struct sr_render_pass *pass;
    struct sr_film *film;
    struct sr_picture picture;
    uint32_t tile, tiles_x, tiles_y, blocks;
    uint32_t first_block, end_block; // that are to be made
    struct sr_render_report base;    // of what came before this pass
    uint32_t *had;                   // blocks of each pixel that a resumed render began with; NULL: a new one
    atomic_ullong next_unit;
    atomic_uint *tile_blocks;                                  // how many blocks of a tile are in the film
    atomic_ullong rays, shadow_rays, vertices, paths, dropped; // of what is in the film
    atomic_ullong units_done;
    atomic_bool cancelled;
    pthread_rwlock_t film_lock; // stores share it, whoever looks at the whole film has it alone
    pthread_mutex_t
        gate_lock; // guards the gate: where units change the film long before they store, none may be under way
    pthread_cond_t gate;
    uint32_t active; // workers that are past the gate
    bool is_closed;
    pthread_mutex_t progress_lock; // guards the members below; locks are taken in this order: gate, progress, film
    double last_progress_s;
    uint32_t first_dropped[4]; // x, y, replicate, sample
    bool has_dropped;
    struct sr_film_block *scratch;   // tile * tile for each thread
    struct sr_block_tree *trees;     // one for each thread
    double *buckets;                 // as many times the film's buckets; NULL: it has none
    void *shared;                    // of the integrator's samples
    struct sr_crew_batches *batches; // NULL: the film is here, else where a helper's units go
};

/* ---- unit.c ---- */

bool sr_run_is_cancelled(struct run *run);
void sr_run_remember_dropped(struct run *run, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample);
void sr_run_count(struct run *run, const struct sr_render_counts *c);
/* One unit, with a thread's own memory. When it is cancelled it stores the pixels that are done and returns false: at
 * once, or, with splats, when the pixel at hand is done, for its splats cannot be taken back. */
bool sr_run_do_unit(struct run *run, uint64_t unit, struct sr_film_block *scratch, double *buckets,
                    struct sr_block_tree *tree, struct sr_splatting *splatting, struct sr_worker *worker);

/* ---- gate.c ---- */

uint64_t sr_run_units(const struct run *run); // that the pass has
/* Share of the whole work that is done [1]. */
double sr_run_share(const struct run *run, uint64_t units_done);
void sr_run_report(const struct run *run, struct sr_render_report *report);
void sr_run_tell_progress(struct run *run, uint64_t units_done);
/* A worker is about to begin a unit, and has ended it, where units change the film before they store. */
void sr_gate_enter(struct run *run);
void sr_gate_leave(struct run *run);
/* The run as keepers see it; its locks. */
struct sr_keeper_view sr_gate_view(struct run *run);
void sr_gate_begin(struct run *run);
void sr_gate_end(struct run *run);

#endif
