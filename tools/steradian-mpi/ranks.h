/* SPDX-License-Identifier: MIT */
/* steradian-mpi: what its parts share. The main thread alone talks MPI (pump.c); `steradian render` runs in a second
 * one, and meets the others through the hooks of a crew (crew.c). */
#ifndef SR_TOOLS_MPI_RANKS_H
#define SR_TOOLS_MPI_RANKS_H

#include "pool.h"
#include "render/render.h"

#include <pthread.h>
#include <stdio.h>

enum { RANKS_HOST = 64, RANKS_TEXT = 4096, RANKS_DEALS = 4 };

/* ---- place.c: who renders ---- */

struct rank {
    char host[RANKS_HOST];
    int node_leader; // the first rank of its node
    int threads;     // that it renders with; 0: it waits for the first rank of its node
};

struct place {
    int rank, ranks;
    int renderers, hosts;
    struct rank *all; // [ranks]
};
/* Collective. each: every rank renders. wanted_threads 0: as many as processors are there. */
void place_find(struct place *p, bool each, int wanted_threads);

/* ---- crew.c: the render's side ---- */

/* Bytes on their way. */
struct parcel {
    struct parcel *next;
    uint8_t *bytes;
    size_t size;
};

enum meeting { MEETING_NOT, MEETING_WANTED, MEETING_HELD, MEETING_FAILED };

struct crew {
    struct sr_render_crew hooks;
    struct place place;
    uint32_t number;      // among the processes that render
    char *identity;       // what all of them must agree upon, "key value" lines; from the meeting on
    pthread_mutex_t lock; // guards all that follows
    pthread_cond_t changed;

    enum meeting meeting;
    int failed_status; // 0, or what another one has ended with
    char failure[RANKS_TEXT];
    bool is_over; // a helper: nothing more is wanted

    const struct sr_crew_pass *pass; // NULL: between passes
    uint64_t pass_number;
    struct pool pool;               // the owner's
    bool has_share;                 // the owner's
    struct deal deals[RANKS_DEALS]; // this process's own, the first one is under way
    int deal_count;
    uint64_t position;           // in the first deal
    bool is_exhausted, is_asked; // a helper: no more will come; more has been asked for
    bool is_ended;               // the pass, on this side
    bool is_taking;              // the owner's pump: the pass must stay
    int passed;                  // the owner: helpers who are through with it

    struct parcel *out, **out_end; // a helper's bytes for the owner
    size_t out_B;
    void *shared; // the owner: to be sent to all; a helper: to be filled
    size_t shared_B;
    struct parcel *in; // a helper: what has been shared and nobody has asked for yet

    FILE *unit_log;                // NULL: none
    double start_s, took_s;        // the owner: when the render met, time of its pump in taking
    double pass_start_s, passes_s; // the owner: from a pass's beginning to its end, all of them
    uint64_t messages, message_B;
};
void crew_begin(struct crew *c);
/* Whoever calls has the lock. Units that are dealt to this process and not begun. */
uint64_t crew_waiting_units(const struct crew *c);
extern _Thread_local int crew_taking_from; // the rank whose units are being taken

/* ---- unit_log.c: what units have cost ---- */

/* NULL, and for helpers: none. false: it cannot be written, which has been told. */
bool unit_log_open(struct crew *c, const char *path);
void unit_log_note(struct crew *c, const struct sr_crew_unit *u);
bool unit_log_close(struct crew *c);

/* ---- pump.c: MPI's side ---- */

/* What this process's render came to; the lock guards it, too. */
struct ending {
    bool is_ended;
    int code;
    char text[RANKS_TEXT]; // of a helper: what it has said
};
/* Serves until all is over; the exit code. */
int pump(struct crew *c, struct ending *own);
/* A rank that does not render waits; 0. */
int pump_wait(void);
/* For a helper: what it says goes here until all have met. */
void hush_begin(void);
void hush_end(void);
void hush_text(char text[RANKS_TEXT]);

#endif
