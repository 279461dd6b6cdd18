/* SPDX-License-Identifier: MIT */
/* The gate: who looks at the whole film while it grows, for progress and checkpoints, has it alone. */
#define _POSIX_C_SOURCE 200809L
#include "render/pass.h"

void sr_gate_enter(struct run *run)
{
    pthread_mutex_lock(&run->gate_lock);
    while (run->is_closed)
        pthread_cond_wait(&run->gate, &run->gate_lock);
    run->active += 1;
    pthread_mutex_unlock(&run->gate_lock);
}

void sr_gate_leave(struct run *run)
{
    pthread_mutex_lock(&run->gate_lock);
    if (--run->active == 0)
        pthread_cond_broadcast(&run->gate);
    pthread_mutex_unlock(&run->gate_lock);
}

static void hold(void *user)
{
    struct run *run = user;
    pthread_mutex_lock(&run->gate_lock);
    run->is_closed = true;
    while (run->active > 0)
        pthread_cond_wait(&run->gate, &run->gate_lock);
    pthread_mutex_unlock(&run->gate_lock);
    pthread_mutex_lock(&run->progress_lock);
    pthread_rwlock_wrlock(&run->film_lock);
}

static void let_go(void *user)
{
    struct run *run = user;
    pthread_rwlock_unlock(&run->film_lock);
    pthread_mutex_unlock(&run->progress_lock);
    pthread_mutex_lock(&run->gate_lock);
    run->is_closed = false;
    pthread_cond_broadcast(&run->gate);
    pthread_mutex_unlock(&run->gate_lock);
}

void sr_run_report(const struct run *run, struct sr_render_report *report)
{
    *report = run->base;
    report->paths += run->paths;
    report->rays += run->rays;
    report->shadow_rays += run->shadow_rays;
    report->vertices += run->vertices;
    report->dropped += run->dropped;
    if (run->has_dropped) {
        report->dropped_x = run->first_dropped[0], report->dropped_y = run->first_dropped[1];
        report->dropped_replicate = run->first_dropped[2], report->dropped_sample = run->first_dropped[3];
    }
    report->render_s = sr_clock_s() - run->pass->start_s;
    report->is_complete = !run->cancelled;
}

uint64_t sr_run_units(const struct run *run)
{
    return (uint64_t)run->tiles_x * run->tiles_y * (run->end_block - run->first_block);
}

/* Share of the whole work that is done [1]. */
double sr_run_share(const struct run *run, uint64_t units_done)
{
    const struct sr_render_pass *pass = run->pass;
    double share = (double)units_done / (double)sr_run_units(run);
    return pass->share_begin + share * (pass->share_end - pass->share_begin);
}

static double tell(void *user, struct sr_render_report *report)
{
    struct run *run = user;
    sr_run_report(run, report);
    return sr_run_share(run, run->units_done);
}

void sr_run_tell_progress(struct run *run, uint64_t units_done)
{
    const struct sr_render_job *job = run->job;
    if (!job->progress || pthread_mutex_trylock(&run->progress_lock) != 0)
        return;
    double now = sr_clock_s();
    if (now - run->last_progress_s >= job->progress_interval_s) {
        run->last_progress_s = now;
        double elapsed = now - run->pass->start_s, share = sr_run_share(run, units_done);
        pthread_rwlock_wrlock(&run->film_lock);
        struct sr_render_progress p = {
            .share = share,
            .elapsed_s = elapsed,
            .left_s = share > 0 ? elapsed * (1 - share) / share : NAN,
            .rays = run->base.rays + run->base.shadow_rays + atomic_load(&run->rays) + atomic_load(&run->shadow_rays),
            .film = run->film,
        };
        job->progress(job->user, &p);
        pthread_rwlock_unlock(&run->film_lock);
    }
    pthread_mutex_unlock(&run->progress_lock);
}

struct sr_keeper_view sr_gate_view(struct run *run)
{
    return (struct sr_keeper_view){.run = run, .film = run->film, .hold = hold, .let_go = let_go, .tell = tell};
}

void sr_gate_begin(struct run *run)
{
    pthread_rwlock_init(&run->film_lock, NULL);
    pthread_mutex_init(&run->progress_lock, NULL);
    pthread_mutex_init(&run->gate_lock, NULL);
    pthread_cond_init(&run->gate, NULL);
    run->last_progress_s = sr_clock_s();
}

void sr_gate_end(struct run *run)
{
    pthread_cond_destroy(&run->gate);
    pthread_mutex_destroy(&run->gate_lock);
    pthread_rwlock_destroy(&run->film_lock);
    pthread_mutex_destroy(&run->progress_lock);
}
