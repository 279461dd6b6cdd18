/* SPDX-License-Identifier: MIT */
/* For the estimators of this room: a pilot, which learns before a picture's first sample, and judges whether that pays.
 *
 * It takes a share of the picture's samples on top, with numbers of its own, in rounds, and throws them away: the first
 * one finds the range of things, each later one goes by what those before it have learned (guide.h). Then nothing
 * changes any more. Where the variance times the cost is not less than that of plain paths, path.c does the picture.
 * What costs what is counted, so that no verdict depends on a clock; a meter has no pilot. */
#ifndef SR_INTEGRATOR_PILOT_H
#define SR_INTEGRATOR_PILOT_H

#include "integrator/guide.h"
#include "integrator/path.h"

/* The beginning of an estimator's parameters. */
struct sr_pilot_path {
    struct sr_path path;
    int32_t learning; // auto|on|off
    float pilot;
};
// rows of a table: one line each, or two
// clang-format off
#define SR_PILOT_PARAMS(learning_name) \
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct sr_pilot_path, path.max_depth), \
     "most scatterings of a path"}, \
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct sr_pilot_path, path.light_sampler), \
     "bvh|power|uniform|exhaustive"}, \
    {SR_PARAM_ENUM, learning_name, "1", 0, 2, 0, offsetof(struct sr_pilot_path, learning), "auto|on|off"}, \
    {SR_PARAM_FLOAT, "pilot", "1", 0, 10, 0.06, offsetof(struct sr_pilot_path, pilot), \
     "samples of the pilot, for each sample of the picture"}
// clang-format on

/* What paths of a pilot add up to. [0]: by what has been learned; [1]: plain paths. */
struct sr_pilot_tally {
    struct sr_box places; // where paths have been
    double sum;           // of the pairs' means
    double variance[2], cost[2];
    double light, noise; // sums, and of a round means: see sr_guide_create
    uint64_t pairs, lights, noises;
    uint64_t rays, shadow_rays, vertices;
};

void sr_pilot_add(struct sr_pilot_tally *sum, const struct sr_pilot_tally *t);

struct sr_pilot;

/* A pair of paths through one pixel: what they differ by is the noise that learning can change. */
struct sr_pilot_pair {
    uint32_t x, y;   // [pixel]
    sr_vec2 place;   // in the picture [1]
    uint32_t number; // in its round
};

struct sr_pilot_kind {
    const char *on, *off, *what; // "paths are guided", "paths are not guided", "guiding"
    size_t size;                 // of what the picture's samples share: begins with a struct sr_pilot
    /* Takes a pair, and adds to its thread's tally. Threads do that at the same time. */
    void (*try)(struct sr_pilot *pilot, const struct sr_pilot_pair *pair, struct sr_pilot_tally *tally,
                struct sr_worker *worker);
    /* After each round, of which that is the sum: what follows from it for the next one. */
    void (*learn)(struct sr_pilot *pilot, struct sr_pilot_tally *tally);
};

struct sr_pilot {
    const struct sr_pilot_kind *kind;
    const struct sr_picture_plan *plan; // until the picture begins
    struct sr_guide *guide;             // NULL: the first round is under way
    double mean;                        // of the picture, by the first round
    uint32_t round;
    bool is_last; // the last round has begun
    bool is_on;   // samples go by what has been learned
};

/* Hooks of the estimator's model. */
sr_status sr_pilot_begin(const struct sr_pilot_kind *kind, const struct sr_pilot_path *m,
                         const struct sr_picture_plan *plan, void **shared, struct sr_error *error);
void sr_pilot_end(void *shared);

/* What a sample goes by; NULL: it is a plain path. */
static inline struct sr_pilot *sr_pilot_of(const struct sr_path_start *start, const struct sr_worker *worker)
{
    struct sr_pilot *pilot = worker->shared;
    return pilot && !start->receiver && pilot->is_on ? pilot : NULL;
}

/* One path of a pair, with the numbers of that replicate, counted from the other end than the picture's; the estimator
 * finds held in the worker. */
static inline void sr_pilot_try(const struct sr_pilot *pilot, const struct sr_pilot_pair *pair, uint32_t replicate,
                                void *held, struct sr_worker *worker)
{
    const struct sr_picture_plan *plan = pilot->plan;
    struct sr_sampler sampler =
        sr_sampler_start(plan->sampler, plan->seed, pair->x, pair->y, UINT32_MAX - replicate, pair->number);
    worker->held = held;
    plan->try(plan->picture, pair->x, pair->y, &sampler, worker);
}

/* A price list of what a plain path does; what learning takes on top is the estimator's. */
static inline uint64_t sr_pilot_cost(const struct sr_worker *w)
{
    return 10 * w->rays + 6 * w->shadow_rays + 12 * w->vertices;
}

static inline float sr_pilot_mean(sr_spectrum s, const struct sr_wavelengths *w)
{
    return sr_wavelengths_secondary_terminated(w) ? s[0] : sr_spectrum_mean(s);
}

#endif
