/* SPDX-License-Identifier: MIT */
/* The rounds of a pilot, and its verdict:
 *
 *     learning pays   <=>   V_learned C_learned < 0.9 V_plain C_plain
 *
 * V: variance of a sample, C: its cost, both by the last round. Pairs of paths are tried in chunks, whose sums are
 * joined in their order, and what is learned is a sum of integers: neither depends on threads. */
#include "integrator/pilot.h"

#include <stdio.h>

enum { MOST_PATHS = 1 << 21, LEAST_PATHS = 1 << 13, FIRST_ROUND = 1 << 10 }; // the latter in pairs
enum { CHUNK = 256 };                                                        // [pairs] that a thread takes at a time
enum { LEARNING_AUTO, LEARNING_ON, LEARNING_OFF };
static const double least_gain = 0.9; // of variance times cost

struct round {
    struct sr_pilot *pilot;
    uint32_t pairs;
    struct sr_pilot_tally *tallies; // of each chunk
};

static void try_chunk(void *context, uint64_t chunk)
{
    const struct round *r = context;
    const struct sr_picture_plan *plan = r->pilot->plan;
    struct sr_pilot_tally *t = &r->tallies[chunk];
    *t = (struct sr_pilot_tally){.places = sr_box_empty()};
    if (plan->cancel && atomic_load_explicit(plan->cancel, memory_order_relaxed))
        return;
    struct sr_worker worker = {.shared = r->pilot};
    for (uint32_t i = (uint32_t)chunk * CHUNK; i < ((uint32_t)chunk + 1) * CHUNK && i < r->pairs; ++i) {
        // pixels by a net over the picture
        struct sr_sampler where =
            sr_sampler_start(plan->sampler, plan->seed, UINT32_MAX, UINT32_MAX - 1, r->pilot->round, i);
        sr_u4 u = sr_sample4(&where, SR_USE_FILM);
        struct sr_pilot_pair pair = {plan->x0 + (uint32_t)(u[0] * (float)plan->width),
                                     plan->y0 + (uint32_t)(u[1] * (float)plan->height),
                                     {u[0], u[1]},
                                     i};
        r->pilot->kind->try(r->pilot, &pair, t, &worker);
    }
    t->rays = worker.rays;
    t->shadow_rays = worker.shadow_rays;
    t->vertices = worker.vertices;
}

void sr_pilot_add(struct sr_pilot_tally *sum, const struct sr_pilot_tally *t)
{
    sum->places = sr_box_union(sum->places, t->places);
    sum->sum += t->sum, sum->pairs += t->pairs;
    sum->light += t->light, sum->lights += t->lights;
    sum->noise += t->noise, sum->noises += t->noises;
    for (int k = 0; k < 2; ++k)
        sum->variance[k] += t->variance[k], sum->cost[k] += t->cost[k];
    sum->rays += t->rays, sum->shadow_rays += t->shadow_rays, sum->vertices += t->vertices;
}

/* The sum of its chunks in their order. */
static struct sr_pilot_tally try_round(const struct round *r)
{
    uint32_t chunks = (r->pairs + CHUNK - 1) / CHUNK;
    struct sr_pilot_tally sum = {.places = sr_box_empty()};
    sr_parallel_for(r->pilot->plan->threads, chunks, try_chunk, (void *)r);
    for (uint32_t i = 0; i < chunks; ++i)
        sr_pilot_add(&sum, &r->tallies[i]);
    sum.light /= sum.lights ? (double)sum.lights : 1;
    sum.noise /= sum.noises ? (double)sum.noises : 1;
    struct sr_worker *counted = r->pilot->plan->counted;
    counted->rays += sum.rays, counted->shadow_rays += sum.shadow_rays, counted->vertices += sum.vertices;
    return sum;
}

/* Sum of the last round; false: no memory. */
static bool run(struct sr_pilot *pilot, uint32_t pairs, struct sr_pilot_tally *sum)
{
    struct round r = {
        .pilot = pilot, .pairs = FIRST_ROUND, .tallies = sr_alloc((pairs / CHUNK + 1) * sizeof *r.tallies)};
    if (!r.tallies)
        return false;
    *sum = try_round(&r);
    pilot->mean = sum->pairs ? sum->sum / (double)sum->pairs : 0;
    pilot->kind->learn(pilot, sum);
    pilot->guide = sr_guide_create(&sum->places, sum->light, sum->noise);
    bool is_complete = pilot->guide;
    for (uint32_t done = r.pairs; is_complete && done < pairs; done += r.pairs) {
        // each round is as long as all before it, and a shorter rest goes with the last one
        r.pairs = pairs - done < done + done / 2 ? pairs - done : done;
        pilot->round += 1;
        pilot->is_last = done + r.pairs >= pairs;
        *sum = try_round(&r);
        pilot->kind->learn(pilot, sum);
        is_complete = sr_guide_refine(pilot->guide);
    }
    sr_free(r.tallies);
    return is_complete;
}

void sr_pilot_end(void *shared)
{
    struct sr_pilot *pilot = shared;
    sr_guide_destroy(pilot->guide);
    sr_free(pilot);
}

sr_status sr_pilot_begin(const struct sr_pilot_kind *kind, const struct sr_pilot_path *m,
                         const struct sr_picture_plan *plan, void **shared, struct sr_error *error)
{
    double wanted = (double)m->pilot * plan->spp * plan->width * plan->height;
    if (m->learning == LEARNING_OFF) {
        snprintf(plan->remark, SR_PICTURE_REMARK, "%s: %s is off", kind->off, kind->what);
        return SR_OK;
    }
    if (m->learning == LEARNING_AUTO && wanted < LEAST_PATHS) {
        snprintf(plan->remark, SR_PICTURE_REMARK, "%s: there are too few samples to learn from", kind->off);
        return SR_OK;
    }
    uint32_t paths = wanted < LEAST_PATHS ? LEAST_PATHS : wanted > MOST_PATHS ? MOST_PATHS : (uint32_t)wanted;
    struct sr_pilot *pilot = sr_alloc(kind->size);
    if (!pilot)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a pilot");
    *pilot = (struct sr_pilot){.kind = kind, .plan = plan, .is_on = true};
    struct sr_pilot_tally last;
    if (!run(pilot, paths / 2, &last)) {
        sr_pilot_end(pilot);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for what a pilot learns");
    }
    double variance = last.variance[1] > 0 ? last.variance[0] / last.variance[1] : 1,
           cost = last.cost[1] > 0 ? last.cost[0] / last.cost[1] : 1;
    bool pays = last.variance[1] > 0 && variance * cost < least_gain;
    pilot->is_on = m->learning == LEARNING_ON || pays;
    pilot->plan = NULL;
    snprintf(plan->remark, SR_PICTURE_REMARK,
             "%s: by a pilot of %u paths (%zu cells), %s makes variance x %.3g, time x %.3g",
             pilot->is_on ? kind->on : kind->off, paths, sr_guide_cell_count(pilot->guide), kind->what, variance, cost);
    *shared = pilot;
    return SR_OK;
}
