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
 * The pilot (pilot.h) learns what comes of going on (guide.c). Its last round follows plain paths as well, from the
 * same places on the sensor. Limits: as path.c's without translucent bodies. */
#include "integrator/pilot.h"
#include "integrator/way.h"

enum { MOST_RETURNS = 64 };               // of a path
enum { WALK_COST = 5 };                   // what a vertex takes on top: see sr_pilot_cost
static const float boldness = 2;          // c
static const float least_survival = 0.1f; // what brings much rarely may have been missed
static const double dark = 0.3;           // of the picture's mean: what is darker counts as if it were so bright

static const struct sr_param params[] = {
    SR_PILOT_PARAMS("learned"),
    {.name = NULL},
};

/* What the samples of a picture share. */
struct shared {
    struct sr_pilot pilot;
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
    struct sr_pilot_tally tally;
    double weight; // of variance in such a part of the picture
    double total;  // L
};

/* Once the path has ended: what came of each step. */
static void learn(struct lesson *l, const struct shared *shared, sr_spectrum L, const struct sr_wavelengths *w,
                  const struct sr_worker *worker)
{
    l->total = (double)sr_pilot_mean(L, w);
    for (int i = 0; i < l->count; ++i) {
        const struct step *s = &l->steps[i];
        double brought = (double)(sr_pilot_mean(L - s->before, w) / sr_pilot_mean(s->beta, w));
        if (!isfinite(brought))
            continue;
        if (shared->pilot.guide)
            sr_guide_add_return(shared->pilot.guide, s->cell, &s->place, s->kind, brought,
                                sr_pilot_cost(worker) - s->spent);
        l->tally.light += brought, l->tally.lights += 1;
        l->tally.noise += brought * brought, l->tally.noises += 1;
    }
}

/* ---- a path ---- */

/* The share of the paths that go on where this one is. */
static float survival(const struct shared *shared, const struct sr_guide_cell *cell, int kind, const struct sr_way *p,
                      float *rate, struct lesson *lesson)
{
    double mean = shared->pilot.mean;
    if (p->bounce == 0 && cell) { // the first surface tells how bright the picture is here
        double bright = shared->rate > 0 ? (double)cell->mean[kind] : mean,
               weight = 1 / (bright * bright + dark * dark * mean * mean);
        *rate = (float)(shared->rate * sqrt(weight));
        if (lesson)
            lesson->weight = weight;
    }
    if (!(shared->rate > 0)) // as plain paths do
        return p->bounce > 1 ? sr_survival(sr_spectrum_max(p->beta) * p->eta_scale) : 1;
    if (p->bounce == 0)
        return 1;
    float survive = *rate * sr_pilot_mean(p->beta, p->w) * cell->worth[kind];
    return survive < 1 ? sr_max(survive, least_survival) : 1;
}

static sr_spectrum walk(const struct shared *shared, int max_depth, struct lesson *lesson, struct sr_way *p)
{
    float rate = 0;
    for (;;) {
        sr_spectrum met;
        enum sr_arrival arrival = sr_way_arrive(p, max_depth, true, &met);
        if (arrival == SR_ARRIVAL_END)
            return p->L;
        if (arrival == SR_ARRIVAL_NOTHING)
            continue;

        // a path that is not expected to bring much for its cost ends by lot, before it has cost anything here
        struct step step = {.kind = !sr_bsdf_is_diffuse(&p->bsdf)};
        const struct sr_guide_cell *cell = NULL;
        if (shared->pilot.guide) {
            step.place =
                sr_guide_place(shared->pilot.guide, p->x.point.p, sr_face_forward(p->x.point.n, sr_neg(p->ray.d)));
            step.cell = sr_guide_find(shared->pilot.guide, &step.place);
            cell = sr_guide_cell(shared->pilot.guide, step.cell);
        }
        float survive = survival(shared, cell, step.kind, p, &rate, lesson);
        if (survive < 1) {
            if (p->u_light[3] >= survive)
                return p->L;
            p->beta *= 1 / survive;
        }
        if (lesson) {
            lesson->tally.places = sr_box_add(lesson->tally.places, p->x.point.p);
            step.before = p->L, step.beta = p->beta, step.spent = sr_pilot_cost(p->worker);
            if (lesson->count < MOST_RETURNS)
                lesson->steps[lesson->count++] = step;
        }

        sr_way_gain_direct(p);
        if (!sr_way_scatter(p))
            return p->L;
    }
}

static sr_spectrum roulette_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                              const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                              struct sr_worker *worker)
{
    const struct sr_pilot_path *m = self;
    const struct shared *shared = (const struct shared *)sr_pilot_of(start, worker);
    struct lesson *lesson = shared ? worker->held : NULL;
    struct sr_sampler own = *sampler;
    own.key ^= lesson ? lesson->key : 0;
    sr_spectrum L;
    if (!shared || (lesson && lesson->is_plain)) {
        L = sr_integrator_path.L(&m->path, scene, start, &own, w, first, worker);
    } else {
        struct sr_way way;
        sr_way_begin(&way, scene, start, &own, w, first, worker);
        L = walk(shared, m->path.max_depth, lesson, &way);
    }
    if (lesson)
        learn(lesson, shared, L, w, worker);
    return L;
}

/* ---- the pilot ---- */

static void try_pair(struct sr_pilot *pilot, const struct sr_pilot_pair *pair, struct sr_pilot_tally *t,
                     struct sr_worker *worker)
{
    double total[2][2] = {{0}}, weight = 0;
    for (int plain = 0; plain <= pilot->is_last;
         ++plain) // both from the same place on the sensor, of the same wavelengths
        for (uint32_t k = 0; k < 2; ++k) {
            struct lesson lesson = {.is_plain = plain, .key = k * 0x9e3779b9u, .tally.places = sr_box_empty()};
            uint64_t before = sr_pilot_cost(worker), vertices = worker->vertices;
            sr_pilot_try(pilot, pair, pilot->round, &lesson, worker);
            lesson.tally.cost[plain] =
                (double)(sr_pilot_cost(worker) - before + (plain ? 0 : WALK_COST * (worker->vertices - vertices)));
            total[plain][k] = lesson.total;
            sr_pilot_add(t, &lesson.tally);
            weight = plain ? weight : lesson.weight; // of the first surface, and so the same for both
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

/* The first two rounds are by lots as plain paths have them. */
static void set_rate(struct sr_pilot *pilot, struct sr_pilot_tally *t)
{
    if (pilot->guide)
        ((struct shared *)pilot)->rate =
            t->variance[0] > 0 ? (double)boldness * sqrt(0.5 * t->cost[0] / t->variance[0]) : 0;
}

static const struct sr_pilot_kind kind = {.on = "roulette goes by what has been learned",
                                          .off = "roulette goes by throughput",
                                          .what = "learning",
                                          .size = sizeof(struct shared),
                                          .try = try_pair,
                                          .learn = set_rate};

static sr_status begin(const void *self, const struct sr_scene *scene, const struct sr_picture_plan *plan,
                       void **shared, struct sr_error *error)
{
    (void)scene;
    return sr_pilot_begin(&kind, self, plan, shared, error);
}

const struct sr_integrator_model sr_integrator_roulette_path = {
    .name = "roulettepath",
    .text =
        "path, whose roulette goes by what a pilot has learned of what paths bring and what they cost, where that pays",
    .params = params,
    .size = sizeof(struct sr_pilot_path),
    .L = roulette_L,
    .knows_receivers = true,
    .begin = begin,
    .end = sr_pilot_end,
};
