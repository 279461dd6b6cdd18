/* SPDX-License-Identifier: MIT */
/* steradian-mpi: the main thread, which alone talks MPI. Probes and short naps, so that it leaves the processor to
 * those who render.
 *
 * To the owner:     READY identity, WANT, DATA piece …, PASSED, ENDED code and text
 * From the owner:   GO, DEAL tiles or none, STOP, SHARE piece …, END
 *
 * Messages of one sender arrive in order, so that a helper's PASSED comes after all its DATA. Longer bytes go in
 * pieces; the first tells how many there are in all. */
#define _POSIX_C_SOURCE 200809L
#include "ranks.h"

#include "render_command.h"

#include <mpi.h>
#include <string.h>
#include <time.h>

enum tag { READY = 1, WANT, DATA, PASSED, ENDED, GO, DEAL, STOP, SHARE, END };
enum { PIECE_B = 4 << 20, MOST_SENDS = 64 };
static const double NAP_S = 1e-3, LONG_NAP_S = 0.05, LAST_WAIT_S = 3;

/* ---- bytes to others ---- */

struct sending {
    MPI_Request request;
    uint8_t *bytes;
};

/* What is on its way from this process. */
struct outbox {
    struct sending *sends;
    size_t count, room;
};

static void nap(double s)
{
    nanosleep(&(struct timespec){(time_t)s, (long)((s - (double)(time_t)s) * 1e9)}, NULL);
}

static void *need(void *p)
{
    if (!p) {
        fprintf(stderr, "steradian-mpi: not enough memory for messages\n");
        MPI_Abort(MPI_COMM_WORLD, SR_ERROR_RESOURCE);
    }
    return p;
}

/* Takes bytes over. */
static void send_owned(struct outbox *o, int to, enum tag tag, uint8_t *bytes, size_t size)
{
    if (o->count == o->room) {
        size_t room = 2 * o->room + 16;
        o->sends = need(sr_realloc(o->sends, o->room * sizeof *o->sends, room * sizeof *o->sends));
        o->room = room;
    }
    struct sending *s = &o->sends[o->count++];
    s->bytes = bytes;
    MPI_Isend(bytes, (int)size, MPI_BYTE, to, tag, MPI_COMM_WORLD, &s->request);
}

static void send(struct outbox *o, int to, enum tag tag, const void *bytes, size_t size)
{
    uint8_t *copy = need(sr_alloc(size));
    if (size)
        memcpy(copy, bytes, size);
    send_owned(o, to, tag, copy, size);
}

/* In pieces, the first one of which begins with the size of all. */
static void send_long(struct outbox *o, int to, enum tag tag, const uint8_t *bytes, size_t size)
{
    uint64_t total = size;
    for (size_t at = 0, first = sizeof total; first || at < size; first = 0) {
        size_t piece = size - at < PIECE_B ? size - at : PIECE_B;
        uint8_t *copy = need(sr_alloc(first + piece));
        if (first)
            memcpy(copy, &total, sizeof total);
        memcpy(copy + first, bytes + at, piece);
        send_owned(o, to, tag, copy, first + piece);
        at += piece;
    }
}

/* Lets go of what has been sent. */
static void tidy(struct outbox *o)
{
    size_t kept = 0;
    for (size_t i = 0; i < o->count; ++i) {
        int is_done;
        MPI_Test(&o->sends[i].request, &is_done, MPI_STATUS_IGNORE);
        if (is_done)
            sr_free(o->sends[i].bytes);
        else
            o->sends[kept++] = o->sends[i];
    }
    o->count = kept;
}

/* ---- bytes from others ---- */

struct message {
    int from, tag;
    uint8_t *bytes; // a NUL after the last one
    size_t size;
};

/* A long message on its way here. */
struct inbox {
    uint8_t *bytes;
    uint64_t total, have;
};

static bool receive(struct message *m)
{
    int is_there, size;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &is_there, &status);
    if (!is_there)
        return false;
    MPI_Get_count(&status, MPI_BYTE, &size);
    *m = (struct message){.from = status.MPI_SOURCE,
                          .tag = status.MPI_TAG,
                          .size = (size_t)size,
                          .bytes = need(sr_alloc((size_t)size + 1))};
    MPI_Recv(m->bytes, size, MPI_BYTE, m->from, m->tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return true;
}

/* Whether the long message is whole with this piece. */
static bool collect(struct inbox *in, const struct message *m)
{
    const uint8_t *bytes = m->bytes;
    size_t size = m->size;
    if (!in->bytes) {
        memcpy(&in->total, bytes, sizeof in->total);
        bytes += sizeof in->total;
        size -= sizeof in->total;
        in->bytes = need(sr_alloc(in->total + 1));
        in->have = 0;
    }
    memcpy(in->bytes + in->have, bytes, size);
    in->have += size;
    return in->have == in->total;
}

/* ---- the owner ---- */

enum state { LOADING, IS_READY, IN_STEP, HAS_ENDED };

struct owner {
    struct crew *crew;
    struct outbox out;
    struct helper {
        enum state state;
        char *identity;
        bool wants, has_share, has_passed;
        struct inbox in;
    } * helpers;     // by rank
    bool is_stopped; // this pass: all have been told
    uint64_t pass_number;
};

static void say_failed(struct crew *c, int rank, int status, const char *text)
{
    if (c->failed_status)
        return;
    static const char prefix[] = "steradian render: error: ";
    if (strncmp(text, prefix, sizeof prefix - 1) == 0)
        text += sizeof prefix - 1;
    c->failed_status = status;
    snprintf(c->failure, sizeof c->failure, "rank %d on %s: %.*s", rank, c->place.all[rank].host,
             (int)strcspn(text, "\n"), text);
    pthread_cond_broadcast(&c->changed);
}

static void to_all(struct owner *o, enum tag tag)
{
    for (int i = 1; i < o->crew->place.ranks; ++i)
        if (o->crew->place.all[i].threads && o->helpers[i].state != HAS_ENDED)
            send(&o->out, i, tag, NULL, 0);
}

/* The first line of the identities that differs, told as the failure of that rank. */
static void compare_identities(struct crew *c, int rank, const char *theirs)
{
    const char *ours = c->identity;
    while (*ours && *theirs) {
        size_t n = strcspn(ours, "\n"), m = strcspn(theirs, "\n");
        if (n != m || memcmp(ours, theirs, n) != 0) {
            char text[RANKS_TEXT / 2];
            snprintf(text, sizeof text, "would make another picture: it has \"%.*s\", rank 0 has \"%.*s\"", (int)m,
                     theirs, (int)n, ours);
            say_failed(c, rank, SR_ERROR_INPUT, text);
            return;
        }
        ours += n + (ours[n] != 0);
        theirs += m + (theirs[m] != 0);
    }
    if (*ours || *theirs)
        say_failed(c, rank, SR_ERROR_INPUT, "would make another picture");
}

static void hold_meeting(struct owner *o)
{
    struct crew *c = o->crew;
    if (c->meeting != MEETING_WANTED)
        return;
    for (int i = 1; i < c->place.ranks; ++i)
        if (c->place.all[i].threads && o->helpers[i].state == LOADING)
            return;
    for (int i = 1; i < c->place.ranks; ++i)
        if (o->helpers[i].state == IS_READY)
            compare_identities(c, i, o->helpers[i].identity);
    if (c->failed_status)
        return;
    to_all(o, GO);
    for (int i = 1; i < c->place.ranks; ++i)
        o->helpers[i].state = c->place.all[i].threads ? IN_STEP : HAS_ENDED;
    c->meeting = MEETING_HELD;
    pthread_cond_broadcast(&c->changed);
}

static void take(struct owner *o, int from)
{
    struct crew *c = o->crew;
    struct inbox *in = &o->helpers[from].in;
    const struct sr_crew_pass *pass = c->pass;
    c->message_B += in->total;
    if (pass) { // or the render has been cancelled, and waits no more
        c->is_taking = true;
        pthread_mutex_unlock(&c->lock);
        crew_taking_from = from;
        double start_s = sr_clock_s();
        pass->take(pass->run, in->bytes, in->total);
        start_s = sr_clock_s() - start_s;
        pthread_mutex_lock(&c->lock);
        c->took_s += start_s;
        c->is_taking = false;
        pthread_cond_broadcast(&c->changed);
    }
    sr_free(in->bytes);
    *in = (struct inbox){0};
}

static void hear(struct owner *o, struct message *m)
{
    struct crew *c = o->crew;
    struct helper *h = &o->helpers[m->from];
    ++c->messages;
    switch (m->tag) {
    case READY:
        h->identity = (char *)m->bytes;
        m->bytes = NULL;
        h->state = IS_READY;
        break;
    case WANT:
        h->wants = true;
        break;
    case DATA:
        if (collect(&h->in, m))
            take(o, m->from);
        break;
    case PASSED:
        h->has_passed = true;
        ++c->passed;
        pthread_cond_broadcast(&c->changed);
        break;
    case ENDED: {
        int code;
        memcpy(&code, m->bytes, sizeof code);
        h->state = HAS_ENDED;
        if (code)
            say_failed(c, m->from, code, (char *)m->bytes + sizeof code);
        else if (c->meeting != MEETING_HELD)
            say_failed(c, m->from, SR_ERROR_USAGE, "has ended without a render");
        break;
    }
    }
}

static void deal_out(struct owner *o)
{
    struct crew *c = o->crew;
    if (c->pass_number != o->pass_number) {
        o->pass_number = c->pass_number;
        o->is_stopped = false;
        for (int i = 1; i < c->place.ranks; ++i)
            o->helpers[i].has_share = o->helpers[i].has_passed = false;
    }
    if (!c->pass)
        return;
    if (!o->is_stopped && (atomic_load(&render_interrupted) || c->failed_status)) {
        to_all(o, STOP);
        o->is_stopped = true;
    }
    uint32_t number = 0;
    for (int i = 1; i < c->place.ranks; ++i) {
        struct helper *h = &o->helpers[i];
        number += c->place.all[i].threads > 0;
        if (!h->wants || h->has_passed || o->is_stopped) // who has passed speaks of the next one
            continue;
        struct deal deal;
        bool has_deal = pool_deal(&c->pool, (uint32_t)c->place.all[i].threads, number, &h->has_share, &deal);
        send(&o->out, i, DEAL, &deal, has_deal ? sizeof deal : 0);
        h->wants = false;
    }
}

static void share_out(struct owner *o)
{
    struct crew *c = o->crew;
    if (!c->shared)
        return;
    for (int i = 1; i < c->place.ranks; ++i)
        if (o->helpers[i].state == IN_STEP)
            send_long(&o->out, i, SHARE, c->shared, c->shared_B);
    c->shared = NULL;
    pthread_cond_broadcast(&c->changed);
}

static int pump_owner(struct crew *c, const struct ending *own)
{
    struct owner o = {.crew = c, .helpers = need(sr_alloc((size_t)c->place.ranks * sizeof *o.helpers))};
    bool is_over = false;
    double over_s = INFINITY;
    for (;;) {
        struct message m;
        pthread_mutex_lock(&c->lock);
        bool has_heard = false;
        while (receive(&m)) {
            hear(&o, &m);
            sr_free(m.bytes);
            has_heard = true;
        }
        if (c->meeting != MEETING_HELD && o.helpers)
            hold_meeting(&o);
        deal_out(&o);
        share_out(&o);
        bool all_ended = true;
        for (int i = 1; i < c->place.ranks; ++i)
            all_ended &= !c->place.all[i].threads || o.helpers[i].state == HAS_ENDED;
        if (own->is_ended && !is_over) {
            for (int i = 1; i < c->place.ranks; ++i)
                send(&o.out, i, END, NULL, 0);
            is_over = true;
            over_s = sr_clock_s() + LAST_WAIT_S;
        }
        pthread_mutex_unlock(&c->lock);
        tidy(&o.out);
        if (is_over && all_ended && o.out.count == 0)
            return own->code;
        if (is_over &&
            sr_clock_s() > over_s) { // one of them does not answer: the work is done, or has failed, without it
            MPI_Abort(MPI_COMM_WORLD, own->code);
            return own->code;
        }
        if (!has_heard)
            nap(NAP_S);
    }
}

/* ---- a helper ---- */

static void obey(struct crew *c, struct inbox *in, const struct message *m)
{
    switch (m->tag) {
    case GO:
        hush_end();
        c->meeting = MEETING_HELD;
        break;
    case DEAL:
        c->is_asked = false;
        c->is_exhausted = m->size == 0;
        if (m->size)
            memcpy(&c->deals[c->deal_count++], m->bytes, sizeof c->deals[0]);
        break;
    case SHARE:
        if (collect(in, m)) {
            struct parcel *parcel = need(sr_alloc(sizeof *parcel)), **last = &c->in;
            *parcel = (struct parcel){.bytes = in->bytes, .size = in->total};
            while (*last)
                last = &(*last)->next;
            *last = parcel;
            *in = (struct inbox){0};
        }
        break;
    default: // STOP, END
        c->is_exhausted = true;
        c->is_over |= m->tag == END;
        atomic_store(&render_interrupted, true);
        break;
    }
    pthread_cond_broadcast(&c->changed);
}

/* What the render has asked for or made. */
static void serve(struct crew *c, struct outbox *o)
{
    if (c->meeting == MEETING_WANTED) {
        send(o, 0, READY, c->identity, strlen(c->identity));
        c->meeting = MEETING_NOT;
    }
    while (c->out && o->count < MOST_SENDS) {
        struct parcel *parcel = c->out;
        send_long(o, 0, DATA, parcel->bytes, parcel->size);
        c->out_B -= parcel->size;
        c->out = parcel->next;
        if (!c->out)
            c->out_end = &c->out;
        sr_free(parcel->bytes);
        sr_free(parcel);
        pthread_cond_broadcast(&c->changed);
    }
    if (c->shared && c->in) {
        struct parcel *parcel = c->in;
        memcpy(c->shared, parcel->bytes, parcel->size < c->shared_B ? parcel->size : c->shared_B);
        c->in = parcel->next;
        sr_free(parcel->bytes);
        sr_free(parcel);
        c->shared = NULL;
        pthread_cond_broadcast(&c->changed);
    }
    if (!c->pass)
        return;
    if (c->is_ended && !c->out) {
        send(o, 0, PASSED, NULL, 0);
        c->pass = NULL;
        pthread_cond_broadcast(&c->changed);
    } else if (!c->is_ended && !c->is_exhausted && !c->is_asked && c->deal_count < RANKS_DEALS &&
               crew_waiting_units(c) <= (uint64_t)c->pass->threads) {
        send(o, 0, WANT, NULL, 0);
        c->is_asked = true;
    }
}

static int pump_helper(struct crew *c, struct ending *own)
{
    struct outbox out = {0};
    struct inbox in = {0};
    bool has_told = false;
    for (;;) {
        struct message m;
        bool has_heard = false;
        pthread_mutex_lock(&c->lock);
        while (receive(&m)) {
            obey(c, &in, &m);
            sr_free(m.bytes);
            has_heard = true;
        }
        serve(c, &out);
        bool is_over = c->is_over;
        if (own->is_ended && !has_told && !c->out) {
            uint8_t text[sizeof own->code + RANKS_TEXT];
            memcpy(text, &own->code, sizeof own->code);
            memcpy(text + sizeof own->code, own->text, sizeof own->text);
            send(&out, 0, ENDED, text, sizeof text);
            has_told = true;
        } else if (is_over && !has_told) { // loading a scene still, or letting go of it: nobody waits for that
            int code = 0;
            send(&out, 0, ENDED, &code, sizeof code);
            has_told = true;
        }
        pthread_mutex_unlock(&c->lock);
        tidy(&out);
        if (is_over && has_told && out.count == 0)
            return 0;
        if (!has_heard)
            nap(NAP_S);
    }
}

int pump(struct crew *c, struct ending *own)
{
    return c->hooks.is_helper ? pump_helper(c, own) : pump_owner(c, own);
}

int pump_wait(void)
{
    for (struct message m;; nap(LONG_NAP_S))
        if (receive(&m)) {
            sr_free(m.bytes);
            return 0;
        }
}
