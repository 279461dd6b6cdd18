/* SPDX-License-Identifier: MIT */
/* Checkpoints: the sums of a render and how far it has come, on disk at intervals, and back.
 *
 * A film's sums with the number of blocks in each pixel are all that a render knows: every sample's numbers follow from
 * the scene and the seed. So whoever goes on from them comes to the same bytes (docs/decisions/0019-checkpoints.md). */
#define _POSIX_C_SOURCE 200809L
#include "render/private.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char kind[] = "checkpoint";
static const double retry_s = 30;            // after a failure
static const uint32_t COMPLETE = UINT32_MAX; // the pass of a render whose work is done

/* The section "progress". */
struct progress {
    uint32_t pass, first_dropped[4], has_dropped;
    uint64_t paths, rays, shadow_rays, vertices, dropped;
    double render_s, share;
    int64_t time_s;
};

static const char *film_name(const struct sr_keeper *k, uint32_t i)
{
    return k->film_count == 1 ? "film" : i ? "half1" : "half0";
}

/* ---- writing ---- */

static sr_status put_all(struct sr_keeper *k, struct sr_store_out *out, const struct progress *progress,
                         const struct sr_film *changed, const struct sr_film *instead, struct sr_error *error)
{
    sr_status status = sr_store_put(out, "identity", k->keep->identity, strlen(k->keep->identity) + 1, error);
    if (status == SR_OK)
        status = sr_store_put(out, "progress", progress, sizeof *progress, error);
    for (uint32_t i = 0; i < k->film_count && status == SR_OK; ++i) {
        status = sr_film_put(out, film_name(k, i), k->films[i] == changed ? instead : k->films[i], error);
        size_t n = (size_t)k->films[i]->width * k->films[i]->height;
        if (status == SR_OK && k->counts[i])
            status = sr_store_put(out, i ? "counts1" : "counts0", k->counts[i], n * sizeof *k->counts[i], error);
    }
    return status == SR_OK && k->part ? sr_part_put(out, k->part, error) : status;
}

/* Tells each kind of failure once, and when it is over. */
static void tell(struct sr_keeper *k, const struct sr_error *error)
{
    bool is_well = error->status == SR_OK;
    k->kept.written += is_well;
    k->kept.failed += !is_well;
    k->kept.is_behind = !is_well;
    if (!is_well && strcmp(k->told, error->text) != 0)
        sr_log(k->keep->log, SR_WARNING, "checkpoint %s; the render goes on, and tries again", error->text);
    else if (is_well && k->told[0])
        sr_log(k->keep->log, SR_INFO, "checkpoint %s: written again", k->keep->path);
    snprintf(k->told, sizeof k->told, "%s", error->text);
}

static bool write_now(struct sr_keeper *k, const struct sr_render_report *r, double share,
                      const struct sr_film *changed, const struct sr_film *instead)
{
    struct progress progress = {.pass = k->pass,
                                .first_dropped = {r->dropped_x, r->dropped_y, r->dropped_replicate, r->dropped_sample},
                                .has_dropped = r->dropped > 0,
                                .paths = r->paths,
                                .rays = r->rays,
                                .shadow_rays = r->shadow_rays,
                                .vertices = r->vertices,
                                .dropped = r->dropped,
                                .render_s = r->render_s,
                                .share = share,
                                .time_s = (int64_t)time(NULL)};
    struct sr_error error = {0};
    struct sr_store_out *out;
    double start_s = sr_clock_s();
    if (sr_store_create(k->keep->path, kind, &out, &error) == SR_OK) {
        if (put_all(k, out, &progress, changed, instead, &error) != SR_OK)
            sr_store_abandon(out);
        else if (sr_store_finish(out, !k->loses_file, &error) == SR_OK)
            k->loses_file = false;
    }
    k->kept.write_s += sr_clock_s() - start_s;
    tell(k, &error);
    return error.status == SR_OK;
}

void sr_keeper_write(struct sr_keeper *k, const struct sr_render_report *report, double share)
{
    if (k->keep)
        write_now(k, report, share, NULL, NULL);
}

void sr_keeper_end(struct sr_keeper *k, struct sr_render_report *report)
{
    sr_film_destroy(k->copy);
    k->copy = NULL;
    report->kept = k->kept;
}

static sr_status keep_complete(const struct sr_render_job *job, struct sr_film *film, struct sr_render_part *part,
                               struct sr_render_report *report, struct sr_error *error)
{
    struct sr_keeper k = {
        .keep = job->keep, .films = {film}, .film_count = 1, .part = part, .pass = COMPLETE, .kept = report->kept};
    if (!write_now(&k, report, 1, NULL, NULL))
        sr_fail(error, SR_ERROR_RESOURCE, "%s", k.told);
    report->kept = k.kept;
    return error->status;
}

sr_status sr_render_checkpoint(const struct sr_render_job *job, const struct sr_film *film,
                               struct sr_render_report *report, struct sr_error *error)
{
    return keep_complete(job, (struct sr_film *)(uintptr_t)film, NULL, report, error); // the film is read alone
}

sr_status sr_render_part_checkpoint(const struct sr_render_job *job, struct sr_render_part *part,
                                    struct sr_render_report *report, struct sr_error *error)
{
    return keep_complete(job, sr_part_splats_film(part), part, report, error);
}

void sr_render_forget(const struct sr_render_keep *keep)
{
    struct sr_arena arena = {0};
    char *previous = sr_store_previous(&arena, keep->path);
    struct sr_store_out *out;
    struct sr_error ignored = {0};
    if (sr_store_create(keep->path, kind, &out, &ignored) == SR_OK) // what a killed writer may have left beside
        sr_store_abandon(out);
    unlink(keep->path);
    if (previous)
        unlink(previous);
    sr_arena_free(&arena);
}

/* ---- at intervals, beside the workers ---- */

struct sr_keeper_watch {
    struct sr_keeper *keeper;
    struct sr_keeper_view view;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool is_over;
};

/* Workers wait while the film is copied, not while it is written; without memory for a copy they wait for both. */
static bool write_beside(struct sr_keeper_watch *w)
{
    struct sr_keeper *k = w->keeper;
    struct sr_error ignored = {0};
    if (!k->copy && !k->part && !k->keep->has_no_copy) // a part is large
        k->copy = sr_film_twin(w->view.film, &ignored);
    struct sr_render_report report;
    w->view.hold(w->view.run);
    double start_s = sr_clock_s();
    double share = w->view.tell(w->view.run, &report);
    bool is_done = false;
    if (k->copy)
        sr_film_copy(k->copy, w->view.film);
    else
        is_done = write_now(k, &report, share, NULL, NULL);
    k->kept.stall_s += sr_clock_s() - start_s;
    w->view.let_go(w->view.run);
    return k->copy ? write_now(k, &report, share, w->view.film, k->copy) : is_done;
}

static void *watch_film(void *user)
{
    struct sr_keeper_watch *w = user;
    double wait_s = w->keeper->keep->interval_s;
    pthread_mutex_lock(&w->lock);
    double next_s = sr_clock_s() + wait_s;
    while (!w->is_over) {
        struct timespec until = {.tv_sec = (time_t)next_s, .tv_nsec = (long)((next_s - floor(next_s)) * 1e9)};
        pthread_cond_timedwait(&w->changed, &w->lock, &until);
        if (w->is_over || sr_clock_s() < next_s)
            continue;
        pthread_mutex_unlock(&w->lock);
        bool is_well = write_beside(w);
        pthread_mutex_lock(&w->lock);
        next_s = sr_clock_s() + (is_well ? wait_s : fmin(wait_s, retry_s));
    }
    pthread_mutex_unlock(&w->lock);
    return NULL;
}

struct sr_keeper_watch *sr_keeper_watch_begin(struct sr_keeper *k, const struct sr_keeper_view *view)
{
    struct sr_keeper_watch *w = k && k->keep ? sr_alloc(sizeof *w) : NULL;
    if (!w)
        return NULL;
    w->keeper = k;
    w->view = *view;
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC); // as sr_clock_s
    pthread_cond_init(&w->changed, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_mutex_init(&w->lock, NULL);
    if (pthread_create(&w->thread, NULL, watch_film, w) == 0)
        return w;
    sr_log(k->keep->log, SR_WARNING, "checkpoint %s: no thread to be had for it", k->keep->path);
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    sr_free(w);
    return NULL;
}

void sr_keeper_watch_end(struct sr_keeper_watch *w)
{
    if (!w)
        return;
    pthread_mutex_lock(&w->lock);
    w->is_over = true;
    pthread_cond_signal(&w->changed);
    pthread_mutex_unlock(&w->lock);
    pthread_join(w->thread, NULL);
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    sr_free(w);
}

/* ---- back ---- */

static const struct progress *progress_of(const struct sr_store_in *in)
{
    size_t size;
    const struct progress *p = sr_store_get(in, "progress", &size);
    return p && size == sizeof *p ? p : NULL;
}

static const char *identity_of(const struct sr_store_in *in)
{
    size_t size;
    const char *text = sr_store_get(in, "identity", &size);
    return text && size > 0 && text[size - 1] == 0 ? text : NULL;
}

bool sr_render_checkpoint_tells(const struct sr_store_in *in, struct sr_render_progress_kept *out)
{
    const struct progress *p = progress_of(in);
    const char *identity = identity_of(in);
    if (strcmp(sr_store_kind(in), kind) != 0 || !p || !identity)
        return false;
    *out = (struct sr_render_progress_kept){.identity = identity,
                                            .share = p->share,
                                            .render_s = p->render_s,
                                            .paths = p->paths,
                                            .rays = p->rays,
                                            .shadow_rays = p->shadow_rays,
                                            .dropped = p->dropped,
                                            .time_s = p->time_s,
                                            .is_complete = p->pass == COMPLETE};
    return true;
}

/* The file, or the generation before it where it is damaged. NULL without an error: there is none. */
static struct sr_store_in *open_either(struct sr_keeper *k, const char *previous, const char **path,
                                       struct sr_error *error)
{
    struct sr_store_in *in = NULL;
    struct sr_error first = {0};
    *path = k->keep->path;
    bool is_there = sr_file_exists(k->keep->path), has_previous = sr_file_exists(previous);
    if (is_there && sr_store_open(k->keep->path, kind, &in, &first) == SR_OK)
        return in;
    if (!has_previous) {
        if (is_there)
            sr_fail(error, first.status, "%s; there is no %s to go on from instead", first.text, previous);
        return NULL;
    }
    *path = previous;
    struct sr_error second = {0};
    if (sr_store_open(previous, kind, &in, &second) != SR_OK) {
        if (is_there)
            sr_fail(error, first.status, "%.450s; the generation before it: %.450s", first.text, second.text);
        else
            *error = second;
        return NULL;
    }
    k->loses_file = is_there;
    sr_log(k->keep->log, SR_WARNING, "%s%sgoing on from the generation before it, %s",
           is_there ? first.text : k->keep->path, is_there ? "; " : " is not there; ", previous);
    return in;
}

static sr_status take(struct sr_keeper *k, const struct sr_store_in *in, const char *path,
                      struct sr_render_report *report, struct sr_error *error)
{
    const struct progress *p = progress_of(in);
    const char *identity = identity_of(in);
    struct sr_render_difference d;
    if (!p || !identity)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: has no sections \"identity\" and \"progress\" as this program writes them", path);
    if (sr_render_identity_differs(identity, k->keep->identity, &d))
        return sr_fail(error, SR_ERROR_INPUT, "%s: belongs to another render: its %s is %s, and here it is %s", path,
                       d.key, d.theirs, d.ours);
    k->is_complete = p->pass == COMPLETE;
    if (!k->is_complete && p->pass >= 2 * k->film_count)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is in pass %u, which this render has not got", path, p->pass);
    uint32_t films = k->is_complete ? 1 : k->film_count;
    for (uint32_t i = 0; i < films; ++i) {
        if (sr_film_get(in, path, k->is_complete ? "film" : film_name(k, i), k->films[i], error) != SR_OK)
            return error->status;
        if (k->is_complete || !k->counts[i])
            continue;
        size_t n = (size_t)k->films[i]->width * k->films[i]->height * sizeof *k->counts[i], size;
        const void *counts = sr_store_get(in, i ? "counts1" : "counts0", &size);
        if (!counts || size != n)
            return sr_fail(error, SR_ERROR_INPUT, "%s: has no counts of samples", path);
        memcpy(k->counts[i], counts, n);
    }
    if (k->part && sr_part_get(in, path, k->part, error) != SR_OK)
        return error->status;
    k->pass = p->pass;
    k->kept.is_resumed = true;
    k->kept.resumed_share = p->share;
    *report = (struct sr_render_report){.render_s = p->render_s,
                                        .paths = p->paths,
                                        .rays = p->rays,
                                        .shadow_rays = p->shadow_rays,
                                        .vertices = p->vertices,
                                        .dropped = p->dropped,
                                        .dropped_x = p->first_dropped[0],
                                        .dropped_y = p->first_dropped[1],
                                        .dropped_replicate = p->first_dropped[2],
                                        .dropped_sample = p->first_dropped[3],
                                        .is_complete = k->is_complete};
    return SR_OK;
}

sr_status sr_keeper_resume(struct sr_keeper *k, struct sr_render_report *report, struct sr_error *error)
{
    if (!k->keep || !k->keep->resumes)
        return SR_OK;
    struct sr_arena arena = {0};
    const char *path, *previous = sr_store_previous(&arena, k->keep->path);
    if (!previous)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", k->keep->path);
    struct sr_store_in *in = open_either(k, previous, &path, error);
    if (in)
        take(k, in, path, report, error);
    else if (error->status == SR_OK)
        sr_log(k->keep->log, SR_INFO, "%s is not there: the render begins anew", k->keep->path);
    if (error->status == SR_OK && in)
        sr_log(k->keep->log, SR_INFO, "going on from %s: %.1f %% is done", path, 100 * k->kept.resumed_share);
    sr_store_close(in);
    sr_arena_free(&arena);
    return error->status;
}
