/* SPDX-License-Identifier: MIT */
/* Path tracing whose paths live on by what a pilot has learned: what those bring that go on from such a place, and what
 * it takes.
 *
 *     survive = c beta sqrt(E[X^2] / C) sqrt(C_all / V_all)        within [least_survival, 1]
 *
 * X is what one path brings that goes on there with a throughput of 1, C what it costs; V_all and C_all are the
 * variance and the cost of a sample, the former relative to how bright the picture is. With c = 1 that makes variance
 * times cost least for independent samples (A. Rath, P. Grittmann, S. Herholz, P. Weier & P. Slusallek, EARS:
 * efficiency-aware Russian roulette and splitting, 2022, eq. 19; going by radiance: J. Vorba & J. Krivanek,
 * Adjoint-driven Russian roulette and splitting, 2016); those of a net differ less than the pilot's independent ones,
 * and the lots' noise does not become less by that, so fewer die here. Who survives carries the others' share, so each
 * sample is unbiased whatever has been learned.
 *
 * The pilot takes a share of the picture's samples on top, with numbers of its own, and throws them away; what it
 * learns is frozen before the picture's first sample. Its last round follows plain paths as well, from the same places
 * on the sensor; where the variance times the cost is not less than theirs, path.c does the picture. Limits: as
 * path.c's without translucent bodies; a meter, which has no pilot, is read by plain paths. */
#include "integrator/guide.h"
#include "integrator/path.h"
#include "integrator/vertices.h"

#include <stdio.h>

enum { LEARNED_AUTO, LEARNED_ON, LEARNED_OFF };
enum { MOST_RETURNS = 64 };                                                  // of a path
enum { MOST_PILOT = 1 << 21, LEAST_PILOT = 1 << 13, FIRST_ROUND = 1 << 11 }; // [paths]
enum { CHUNK = 256 }; // [pairs of paths] that a thread takes at a time

// a price list of what the pilot counts, so that its verdict depends on no clock
enum { RAY_COST = 10, SHADOW_COST = 6, VERTEX_COST = 12, WALK_COST = 5 };
static const double least_gain = 0.9;     // of variance times cost, for the lots to pay
static const float boldness = 2;          // c
static const float least_survival = 0.1f; // what brings much rarely may have been missed
static const double dark = 0.3;           // of the picture's mean: what is darker counts as if it were so bright

struct roulette {
    struct sr_path path;
    int32_t learned;
    float pilot;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct roulette, path.max_depth), "most scatterings of a path"},
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct roulette, path.light_sampler),
     "bvh|power|uniform|exhaustive"},
    {SR_PARAM_ENUM, "learned", "1", 0, 2, 0, offsetof(struct roulette, learned), "auto|on|off"},
    {SR_PARAM_FLOAT, "pilot", "1", 0, 10, 0.06, offsetof(struct roulette, pilot),
     "samples of the pilot, for each sample of the picture"},
    {.name = NULL},
};

/* What the samples of a picture share. */
struct shared {
    struct sr_guide *guide; // NULL: nothing has been learned yet
    bool is_on;
    double mean; // of the picture
    double rate; // c sqrt(C_all / V_all); 0: not known yet
};

/* ---- what a path of the pilot remembers ---- */

struct step {
    struct sr_guide_place place;
    uint32_t cell;
    int kind;
    sr_spectrum before, beta; // L before it, and what further light is multiplied by
    uint64_t spent;           // before it
};

struct lesson {
    struct step steps[MOST_RETURNS];
    int count;
    bool is_plain;
    uint32_t key; // of numbers after the sensor's
    struct sr_box places;
    double brought, brought2; // sums
    uint64_t returns;
    double weight; // of variance in such a part of the picture
    double total;  // L
};

static float mean_of(sr_spectrum s, const struct sr_wavelengths *w)
{
    return sr_wavelengths_secondary_terminated(w) ? s[0] : sr_spectrum_mean(s);
}

static uint64_t cost_of(const struct sr_worker *w)
{
    return RAY_COST * w->rays + SHADOW_COST * w->shadow_rays + VERTEX_COST * w->vertices;
}

/* Once the path has ended: what came of each step. */
static void learn(struct lesson *l, const struct shared *shared, sr_spectrum L, const struct sr_wavelengths *w,
                  const struct sr_worker *worker)
{
    l->total = (double)mean_of(L, w);
    for (int i = 0; i < l->count; ++i) {
        const struct step *s = &l->steps[i];
        double brought = (double)(mean_of(L - s->before, w) / mean_of(s->beta, w));
        if (!isfinite(brought))
            continue;
        if (shared->guide)
            sr_guide_add_return(shared->guide, s->cell, &s->place, s->kind, brought, cost_of(worker) - s->spent);
        l->brought += brought;
        l->brought2 += brought * brought;
        l->returns += 1;
    }
}

/* ---- a path ---- */

/* The share of the paths at x that go on. */
static float survival(const struct shared *shared, const struct sr_guide_cell *cell, int kind, sr_spectrum beta,
                      float eta_scale, int bounce, const struct sr_wavelengths *w, float *rate, struct lesson *lesson)
{
    if (bounce == 0 && shared->guide) { // the first surface tells how bright the picture is here
        double bright = shared->rate > 0 ? (double)cell->mean[kind] : shared->mean,
               weight = 1 / (bright * bright + dark * dark * shared->mean * shared->mean);
        *rate = (float)(shared->rate * sqrt(weight));
        if (lesson)
            lesson->weight = weight;
    }
    if (!(shared->rate > 0)) // as plain paths do
        return bounce > 1 ? sr_clamp(sr_spectrum_max(beta) * eta_scale, 0.05f, 1) : 1;
    if (bounce == 0)
        return 1;
    float survive = *rate * mean_of(beta, w) * cell->worth[kind];
    return survive < 1 ? sr_max(survive, least_survival) : 1;
}

static sr_spectrum walk(const struct roulette *m, const struct sr_scene *scene, const struct sr_path_start *start,
                        const struct sr_sampler *sampler, const struct shared *shared, struct lesson *lesson,
                        struct sr_wavelengths *w, struct sr_hit *first, struct sr_worker *worker)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    bool has_footprints = sr_scene_has_footprints(scene);
    float width = 0, spread = has_footprints ? 0.5f * (sr_length(start->dddx) + sr_length(start->dddy)) : 0;
    struct sr_ray ray = start->ray;
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    float pdf = INFINITY, eta_scale = 1, rate = 0;
    bool is_scattered = false;
    struct sr_point from;
    for (int bounce = 0, passed = 0;;) {
        uint32_t group = SR_USE_BOUNCE + 2 * (uint32_t)bounce;
        sr_u4 u_light, u_bsdf;
        sr_sample8(sampler, group, &u_light, &u_bsdf);
        struct sr_hit x;
        bool is_hit = bounce == 0 && (first || has_footprints) ? sr_trace(scene, &ray, &x, worker)
                                                               : sr_trace_bare(scene, &ray, &x, worker);
        if (first && bounce == 0)
            *first = is_hit ? x : (struct sr_hit){.t = INFINITY};
        if (!is_hit || x.light != SR_NO_LIGHT) {
            struct sr_path_start now = {.ray = ray, .receiver = isinf(pdf) ? NULL : &from, .pdf = pdf};
            L += beta * sr_met_at_once(scene, &now, is_hit ? &x : NULL, ray.d, w);
        }
        if (!is_hit || (x.material && bounce == m->path.max_depth))
            return L;
        struct sr_bsdf bsdf = {.model = NULL};
        struct sr_frame frame;
        if (x.material) {
            if (has_footprints) {
                sr_path_footprint(start, &x, bounce == 0, is_scattered, spread, &width);
                if (first && bounce == 0)
                    first->point = x.point;
            }
            uint32_t seed = sampler->key + sampler->sample * 0x9e3779b9u + group * 0x85ebca6bu; // random walks hash it
            if (SR_LIKELY(x.is_plain))
                sr_material_shade_plain(x.material, x.lambert, &x.point, sr_neg(ray.d), u_bsdf[3], seed, w, &bsdf,
                                        &frame);
            else
                sr_material_shade(x.material, &x.point, sr_neg(ray.d), u_bsdf[3], seed, w, &bsdf, &frame);
        }
        if (!bsdf.model) {
            if (++passed > 1000)
                return L;
            ray = sr_leave(&x.point, ray.d);
            continue;
        }
        worker->vertices += 1;
        sr_vec3 wo = sr_to_local(&frame, sr_neg(ray.d));
        if (wo.z == 0)
            return L;

        // a path that is not expected to bring much for its cost ends by lot, before it has cost anything here
        struct step step = {.kind = !sr_bsdf_is_diffuse(&bsdf)};
        const struct sr_guide_cell *cell = NULL;
        if (shared->guide) {
            step.place = sr_guide_place(shared->guide, x.point.p, sr_face_forward(x.point.n, sr_neg(ray.d)));
            step.cell = sr_guide_find(shared->guide, &step.place);
            cell = sr_guide_cell(shared->guide, step.cell);
        }
        float survive = survival(shared, cell, step.kind, beta, eta_scale, bounce, w, &rate, lesson);
        if (survive < 1) {
            if (u_light[3] >= survive)
                return L;
            beta *= 1 / survive;
        }
        if (lesson) {
            lesson->places = sr_box_add(lesson->places, x.point.p);
            step.before = L, step.beta = beta, step.spent = cost_of(worker);
            if (lesson->count < MOST_RETURNS)
                lesson->steps[lesson->count++] = step;
        }

        struct sr_light_sample l;
        sr_spectrum L_direct;
        bool is_lit = sr_bsdf_lobes(&bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY) &&
                      sr_path_direct(lights, &x.point, &frame, &bsdf, wo, u_light, w, &l, &L_direct);
        struct sr_bsdf_sample s;
        bool goes_on = sr_bsdf_sample(&bsdf, wo, u_bsdf[2], (sr_vec2){u_bsdf[0], u_bsdf[1]}, SR_RADIANCE, &s);
        if (is_lit && sr_unoccluded(scene, &x.point, &l, worker))
            L += beta * L_direct;
        if (!goes_on)
            return L;
        beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
        if (!(sr_spectrum_max(beta) > 0))
            return L;
        pdf = s.lobe & SR_LOBE_SPECULAR ? INFINITY
              : s.pdf_is_proportional   ? sr_bsdf_pdf(&bsdf, wo, s.wi, SR_RADIANCE)
                                        : s.pdf;
        if (s.lobe & SR_LOBE_TRANSMISSION)
            eta_scale *= s.eta * s.eta;
        is_scattered |= !(s.lobe & SR_LOBE_SPECULAR);
        from = x.point;
        ray = sr_leave(&x.point, sr_to_world(&frame, s.wi));
        ++bounce;
    }
}

static sr_spectrum roulette_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                              const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                              struct sr_worker *worker)
{
    const struct roulette *m = self;
    const struct shared *shared = worker->shared;
    if (!shared || start->receiver || !shared->is_on)
        return sr_integrator_path.L(&m->path, scene, start, sampler, w, first, worker);
    struct lesson *lesson = worker->held;
    if (!lesson)
        return walk(m, scene, start, sampler, shared, NULL, w, first, worker);
    struct sr_sampler own = *sampler;
    own.key ^= lesson->key;
    sr_spectrum L = lesson->is_plain ? sr_integrator_path.L(&m->path, scene, start, &own, w, first, worker)
                                     : walk(m, scene, start, &own, shared, lesson, w, first, worker);
    learn(lesson, shared, L, w, worker);
    return L;
}

/* ---- the pilot ---- */

/* Sums of a chunk's paths. [0]: by lots that have been learned; [1]: plain paths. */
struct tally {
    struct sr_box places;
    double sum, brought, brought2, variance[2];
    uint64_t pairs, returns, rays, shadow_rays, vertices, cost[2];
};

struct round {
    const struct sr_picture_plan *plan;
    struct shared *shared;
    uint32_t number, pairs;
    bool compares;         // plain paths as well
    struct tally *tallies; // of each chunk
};

/* Two paths from the same place on the sensor, of the same wavelengths: what they differ by is what the lots can
 * change. */
static void try_pair(const struct round *r, uint32_t i, struct tally *t, struct sr_worker *worker)
{
    const struct sr_picture_plan *plan = r->plan;
    // pixels by a net over the picture; replicates from the other end than the picture's
    struct sr_sampler where = sr_sampler_start(plan->sampler, plan->seed, UINT32_MAX, UINT32_MAX - 1, r->number, i);
    sr_u4 u = sr_sample4(&where, SR_USE_FILM);
    uint32_t x = plan->x0 + (uint32_t)(u[0] * (float)plan->width),
             y = plan->y0 + (uint32_t)(u[1] * (float)plan->height);
    struct sr_sampler sampler = sr_sampler_start(plan->sampler, plan->seed, x, y, UINT32_MAX - r->number, i);
    double total[2][2] = {{0}}, weight = 0;
    for (int plain = 0; plain <= r->compares; ++plain)
        for (uint32_t k = 0; k < 2; ++k) {
            struct lesson lesson = {.is_plain = plain, .key = k * 0x9e3779b9u, .places = t->places};
            worker->held = &lesson;
            uint64_t before = cost_of(worker), vertices = worker->vertices;
            plan->try(plan->picture, x, y, &sampler, worker);
            t->cost[plain] += cost_of(worker) - before + (plain ? 0 : WALK_COST * (worker->vertices - vertices));
            total[plain][k] = lesson.total;
            if (plain)
                continue;
            weight = lesson.weight; // of the first surface, and so the same for both
            t->places = lesson.places;
            t->brought += lesson.brought;
            t->brought2 += lesson.brought2;
            t->returns += lesson.returns;
        }
    double of_lots = total[0][0] - total[0][1], of_plain = total[1][0] - total[1][1],
           mean = 0.5 * (total[0][0] + total[0][1]);
    if (!isfinite(of_lots) || !isfinite(of_plain))
        return;
    t->sum += mean;
    t->variance[0] += 0.5 * weight * of_lots * of_lots;
    t->variance[1] += 0.5 * weight * of_plain * of_plain;
    t->pairs += 1;
}

static void try_chunk(void *context, uint64_t chunk)
{
    const struct round *r = context;
    struct tally *t = &r->tallies[chunk];
    *t = (struct tally){.places = sr_box_empty()};
    if (r->plan->cancel && atomic_load_explicit(r->plan->cancel, memory_order_relaxed))
        return;
    struct sr_worker worker = {.shared = r->shared};
    for (uint32_t i = (uint32_t)chunk * CHUNK; i < ((uint32_t)chunk + 1) * CHUNK && i < r->pairs; ++i)
        try_pair(r, i, t, &worker);
    t->rays = worker.rays;
    t->shadow_rays = worker.shadow_rays;
    t->vertices = worker.vertices;
}

/* One round of the pilot; the sum of its chunks in their order. */
static struct tally try_round(const struct round *r)
{
    uint32_t chunks = (r->pairs + CHUNK - 1) / CHUNK;
    struct tally sum = {.places = sr_box_empty()};
    sr_parallel_for(r->plan->threads, chunks, try_chunk, (void *)r);
    for (uint32_t i = 0; i < chunks; ++i) {
        const struct tally *t = &r->tallies[i];
        sum.places = sr_box_union(sum.places, t->places);
        sum.sum += t->sum, sum.pairs += t->pairs;
        sum.brought += t->brought, sum.brought2 += t->brought2, sum.returns += t->returns;
        for (int k = 0; k < 2; ++k)
            sum.variance[k] += t->variance[k], sum.cost[k] += t->cost[k];
        sum.rays += t->rays, sum.shadow_rays += t->shadow_rays, sum.vertices += t->vertices;
    }
    r->plan->counted->rays += sum.rays;
    r->plan->counted->shadow_rays += sum.shadow_rays;
    r->plan->counted->vertices += sum.vertices;
    return sum;
}

/* The first round only finds the range of things, the second one is still by lots as plain paths have them, each later
 * one by what those before it have learned. */
static sr_status run_pilot(const struct sr_picture_plan *plan, struct shared *shared, uint32_t pairs,
                           struct tally *last, struct sr_error *error)
{
    struct round r = {.plan = plan, .shared = shared, .pairs = FIRST_ROUND / 2};
    r.tallies = sr_alloc((pairs / CHUNK + 1) * sizeof *r.tallies);
    if (!r.tallies)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the pilot of roulette");
    *last = try_round(&r);
    double n = last->returns ? (double)last->returns : 1;
    shared->mean = last->pairs ? last->sum / (double)last->pairs : 0;
    shared->guide = sr_guide_create(&last->places, last->brought / n, last->brought2 / n);
    bool is_complete = shared->guide;
    for (uint32_t done = r.pairs; is_complete && done < pairs; done += r.pairs) {
        // each round is as long as all before it, and a shorter rest goes with the last one
        r.pairs = pairs - done < done + done / 2 ? pairs - done : done;
        r.number += 1;
        r.compares = done + r.pairs >= pairs;
        *last = try_round(&r);
        is_complete = sr_guide_refine(shared->guide);
        shared->rate =
            last->variance[0] > 0 ? (double)boldness * sqrt(0.5 * (double)last->cost[0] / last->variance[0]) : 0;
    }
    sr_free(r.tallies);
    return is_complete ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for what roulette goes by");
}

static void end(void *p)
{
    struct shared *shared = p;
    sr_guide_destroy(shared->guide);
    sr_free(shared);
}

/* A picture's lots: by what has been learned where that makes variance times cost less, by the pilot's own counting. */
static sr_status begin(const void *self, const struct sr_scene *scene, const struct sr_picture_plan *plan, void **out,
                       struct sr_error *error)
{
    const struct roulette *m = self;
    (void)scene;
    double wanted = (double)m->pilot * plan->spp * plan->width * plan->height;
    if (m->learned == LEARNED_OFF || (m->learned == LEARNED_AUTO && wanted < LEAST_PILOT)) {
        snprintf(plan->remark, SR_PICTURE_REMARK, "roulette goes by throughput: %s",
                 m->learned == LEARNED_OFF ? "learning is off" : "there are too few samples to learn from");
        return SR_OK;
    }
    uint32_t paths = wanted < LEAST_PILOT ? LEAST_PILOT : wanted > MOST_PILOT ? MOST_PILOT : (uint32_t)wanted;
    struct shared *shared = sr_alloc(sizeof *shared);
    if (!shared)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for what roulette goes by");
    shared->is_on = true;
    struct tally last;
    sr_status status = run_pilot(plan, shared, paths / 2, &last, error);
    if (status != SR_OK) {
        end(shared);
        return status;
    }
    double variance = last.variance[1] > 0 ? last.variance[0] / last.variance[1] : 1,
           cost = last.cost[1] ? (double)last.cost[0] / (double)last.cost[1] : 1;
    bool pays = last.variance[1] > 0 && variance * cost < least_gain;
    shared->is_on = m->learned == LEARNED_ON || pays;
    snprintf(plan->remark, SR_PICTURE_REMARK,
             "roulette goes by %s: by a pilot of %u paths (%zu cells), learning makes variance x %.3g, time x %.3g",
             shared->is_on ? "what has been learned" : "throughput", paths, sr_guide_cell_count(shared->guide),
             variance, cost);
    *out = shared;
    return SR_OK;
}

const struct sr_integrator_model sr_integrator_roulette_path = {
    .name = "roulettepath",
    .text =
        "path, whose roulette goes by what a pilot has learned of what paths bring and what they cost, where that pays",
    .params = params,
    .size = sizeof(struct roulette),
    .L = roulette_L,
    .knows_receivers = true,
    .begin = begin,
    .end = end,
};
