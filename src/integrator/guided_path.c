/* SPDX-License-Identifier: MIT */
/* Path tracing whose directions are drawn by what a pilot has learned of where light comes from, where that pays.
 *
 * One direction is drawn from the mixture of both (mixture.h), and the mixture stands in every weight (Veach 1997,
 * power heuristic, against directions toward lights), so each sample is unbiased whatever has been learned. T. Mueller,
 * M. Gross & J. Novak, Practical path guiding, 2017.
 *
 * What the pilot (pilot.h) learns is from where light comes (guide.c). It weighs the paths that it has drawn from the
 * mixture as plain path tracing would have found them:
 *
 *     E_plain[F^2] = E[SUM_de c_d c_e W_min(d,e)],  W_d = PRODUCT over the first d scatterings of p / p_bsdf,
 *
 * c_d being what a path gains after d scatterings. Limits: as path.c's without translucent bodies. */
#include "integrator/mixture.h"
#include "integrator/pilot.h"
#include "integrator/way.h"

enum { MOST_RECORDS = 16 }; // of a path
enum { TILES = 24 };        // along each side of the picture
static const double walk_cost = 4.5,
                    guide_cost = 11; // what a vertex takes on top, and one that is guided: see sr_pilot_cost

static const struct sr_param params[] = {
    SR_PILOT_PARAMS("guiding"),
    {.name = NULL},
};

/* What the samples of a picture share. */
struct shared {
    struct sr_pilot pilot;
    /* Variance counts by how bright the picture is there, so that its dark parts have a say: 1 / (mean^2 + (0.1 mean of
     * all)^2) of tiles. */
    double weight[TILES * TILES];
    uint64_t sum[TILES * TILES], count[TILES * TILES]; // of paths, in units of 2^-20 of the first round's mean
};

/* ---- what a path of the pilot remembers ---- */

struct step {
    struct sr_guide_record record;
    sr_spectrum before, beta; // L before it, and what further light is multiplied by
    float cosine;
};

struct lesson {
    struct step steps[MOST_RECORDS];
    int count;
    double importance; // [1] of variance in this part of the picture
    struct sr_pilot_tally tally;
    double total, plain;    // of the path: F, and the expectation of F^2 without guide [of L]
    double weight, weighed; // W_d; SUM c_d W_d
    uint32_t guided;        // vertices where the guide has had a say
};

/* L has gained by c. */
static void note_gain(struct lesson *l, sr_spectrum c, const struct sr_wavelengths *w)
{
    double gain = (double)sr_pilot_mean(c, w);
    if (gain == 0)
        return;
    l->plain += gain * (gain * l->weight + 2 * l->weighed);
    l->weighed += gain * l->weight;
    l->total += gain;
}

/* Once the path has ended: what came of each step. */
static void learn(struct lesson *l, const struct sr_pilot *pilot, sr_spectrum L, const struct sr_wavelengths *w)
{
    for (int i = 0; i < l->count; ++i) {
        struct step *s = &l->steps[i];
        sr_spectrum gained = L - s->before, arrived = SR_BLACK;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            arrived[k] = s->beta[k] > 0 ? gained[k] / s->beta[k] : 0;
        double c = (double)sr_pilot_mean(gained, w), light = (double)(sr_pilot_mean(arrived, w) * s->cosine);
        s->record.noise = c * c * l->importance;
        s->record.light = light * light / (double)s->record.pdf;
        if (!isfinite(s->record.noise) || !isfinite(s->record.light))
            continue;
        if (pilot->guide)
            sr_guide_add(pilot->guide, &s->record);
        l->tally.noise += s->record.noise;
        l->tally.noises += 1;
        if (s->record.is_direction) {
            l->tally.light += s->record.light;
            l->tally.lights += 1;
        }
    }
}

/* ---- a path ---- */

/* The cell where the path is, and the share of directions that it draws. */
static void set_cell(const struct sr_pilot *pilot, const struct sr_way *p, struct sr_mixture *m,
                     struct sr_guide_record *record)
{
    record->place = sr_guide_place(pilot->guide, p->x.point.p, sr_face_forward(p->x.point.n, sr_neg(p->ray.d)));
    record->cell = sr_guide_find(pilot->guide, &record->place);
    record->kind = !sr_bsdf_is_diffuse(&p->bsdf);
    m->cell = sr_guide_cell(pilot->guide, record->cell);
    if (!m->cell->has_light)
        return;
    m->share = m->cell->share[record->kind];
    if (!pilot->is_last) // every cell draws some directions by the guide, so that its worth is known everywhere
        m->share = sr_max(m->share, 0.2f);
}

/* sr_path_direct against the mixture. */
static bool direct(const struct sr_mixture *m, const struct sr_way *p, struct sr_light_sample *l, sr_spectrum *L)
{
    const struct sr_lights *lights = sr_scene_lights(p->scene);
    sr_u4 u = p->u_light;
    uint32_t index;
    float pmf, pdf_bsdf;
    if (!sr_lights_pick(lights, &p->x.point, u[2], &index, &pmf) ||
        !sr_light_draw(lights->lights[index], &p->x.point, (sr_vec2){u[0], u[1]}, p->w, l))
        return false;
    sr_vec3 wi = sr_to_local(&p->frame, l->wi);
    sr_spectrum fL = sr_bsdf_f_pdf(&p->bsdf, p->wo, wi, SR_RADIANCE, &pdf_bsdf) * l->L * sr_abs_cos_theta(wi);
    if (!sr_spectrum_any(fL > 0.0f))
        return false;
    float pdf = pmf * l->pdf, other = l->is_delta ? 0 : sr_mixture_pdf(m, l->wi, pdf_bsdf);
    *L = fL * (sr_mis_weight(pdf, other) / pdf);
    return true;
}

static sr_spectrum walk(const struct sr_pilot *pilot, int max_depth, struct lesson *lesson, struct sr_way *p)
{
    // beta, had the BSDF drawn these directions: what lives on by it does so however it was found
    sr_spectrum unguided = SR_ONE;
    for (;;) {
        sr_spectrum met;
        enum sr_arrival arrival = sr_way_arrive(p, max_depth, true, &met);
        if (lesson)
            note_gain(lesson, met, p->w);
        if (arrival == SR_ARRIVAL_END)
            return p->L;
        if (arrival == SR_ARRIVAL_NOTHING)
            continue;
        struct sr_mixture m = {.guide = pilot->guide, .bsdf = &p->bsdf, .frame = &p->frame, .wo = p->wo};
        struct sr_guide_record record = {0};
        // where no direction has a density, none is guided; nor where the next surface is not looked at but for its own
        // light
        bool is_guidable = sr_way_is_open(p) && p->bounce + 1 < max_depth;
        if (is_guidable && m.guide)
            set_cell(pilot, p, &m, &record);
        struct sr_light_sample l;
        sr_spectrum L_direct, gain;
        bool is_lit =
            sr_way_is_open(p) && (m.share > 0 ? direct(&m, p, &l, &L_direct) : sr_way_direct(p, &l, &L_direct));
        struct sr_bsdf_sample s;
        bool goes_on = sr_mixture_sample(&m, p->u_bsdf, lesson != NULL, &s, &gain, &record);
        if (is_lit && sr_unoccluded(p->scene, &p->x.point, &l, p->worker)) {
            p->L += p->beta * L_direct;
            if (lesson)
                note_gain(lesson, p->beta * L_direct, p->w);
        }
        if (!goes_on)
            return p->L;
        float ratio = record.pdf_bsdf > 0 ? record.pdf / record.pdf_bsdf : 0;
        p->beta *= gain;
        unguided *= gain * ratio;
        if (lesson) {
            lesson->guided += m.share > 0;
            lesson->weight *= (double)ratio;
            lesson->tally.places = sr_box_add(lesson->tally.places, p->x.point.p);
            if (is_guidable && lesson->count < MOST_RECORDS)
                lesson->steps[lesson->count++] =
                    (struct step){.record = record, .before = p->L, .beta = p->beta, .cosine = sr_abs_cos_theta(s.wi)};
        }
        sr_way_leave(p, &s, record.pdf);
        if (!(sr_spectrum_max(p->beta) > 0))
            return p->L;
        sr_spectrum before = p->L;
        float stands_for = sr_way_lot(p, sr_spectrum_max(unguided), true);
        if (lesson)
            note_gain(lesson, p->L - before, p->w);
        if (stands_for == 0)
            return p->L;
        p->beta *= stands_for;
        unguided *= stands_for;
    }
}

static sr_spectrum guided_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                            const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                            struct sr_worker *worker)
{
    const struct sr_pilot_path *m = self;
    const struct sr_pilot *pilot = sr_pilot_of(start, worker);
    if (!pilot)
        return sr_integrator_path.L(&m->path, scene, start, sampler, w, first, worker);
    struct lesson *lesson = worker->held;
    struct sr_way way;
    sr_way_begin(&way, scene, start, sampler, w, first, worker);
    sr_spectrum L = walk(pilot, m->path.max_depth, lesson, &way);
    if (lesson)
        learn(lesson, pilot, L, w);
    return L;
}

/* ---- the pilot ---- */

static void try_pair(struct sr_pilot *pilot, const struct sr_pilot_pair *pair, struct sr_pilot_tally *t,
                     struct sr_worker *worker)
{
    struct shared *shared = (struct shared *)pilot;
    uint32_t tile = (uint32_t)(pair->place.x * TILES) + TILES * (uint32_t)(pair->place.y * TILES);
    double importance = pilot->mean > 0 ? shared->weight[tile] : 1, total[2], saved = 0;
    for (uint32_t k = 0; k < 2; ++k) {
        struct lesson lesson = {.weight = 1, .importance = importance, .tally.places = sr_box_empty()};
        uint64_t before = sr_pilot_cost(worker), vertices = worker->vertices;
        sr_pilot_try(pilot, pair, 2 * pilot->round + k, &lesson, worker);
        double cost = (double)(sr_pilot_cost(worker) - before);
        lesson.tally.cost[0] = cost + walk_cost * (double)(worker->vertices - vertices) + guide_cost * lesson.guided;
        lesson.tally.cost[1] = cost;
        total[k] = lesson.total;
        saved += 0.5 * importance * (lesson.plain - total[k] * total[k]);
        if (!isfinite(saved))
            return;
        sr_pilot_add(t, &lesson.tally);
    }
    double mean = 0.5 * (total[0] + total[1]),
           variance = 0.5 * importance * (total[0] - total[1]) *
                      (total[0] - total[1]); // what both have in common leaves no trace
    t->sum += mean;
    if (pilot->mean > 0) {
        __atomic_fetch_add(&shared->sum[tile], (uint64_t)fmin(fmax(mean / pilot->mean, 0) * 0x1p20, 0x1p40),
                           __ATOMIC_RELAXED);
        __atomic_fetch_add(&shared->count[tile], 1, __ATOMIC_RELAXED);
    }
    t->variance[0] += variance;
    t->variance[1] += variance + saved;
    t->pairs += 1;
}

/* How much variance counts in each tile; four paths as bright as the mean stand for what is not known yet. */
static void weigh_tiles(struct sr_pilot *pilot, struct sr_pilot_tally *t)
{
    struct shared *shared = (struct shared *)pilot;
    for (int i = 0; i < TILES * TILES; ++i) {
        double mean = pilot->mean * ((double)shared->sum[i] * 0x1p-20 + 4) / ((double)shared->count[i] + 4),
               all = 0.1 * pilot->mean;
        shared->weight[i] = pilot->mean > 0 ? 1 / (mean * mean + all * all) : 1;
    }
    if (!pilot->guide)
        t->noise *= shared->weight[0]; // all tiles weigh the same so far
}

static const struct sr_pilot_kind kind = {.on = "paths are guided",
                                          .off = "paths are not guided",
                                          .what = "guiding",
                                          .size = sizeof(struct shared),
                                          .try = try_pair,
                                          .learn = weigh_tiles};

static sr_status begin(const void *self, const struct sr_scene *scene, const struct sr_picture_plan *plan,
                       void **shared, struct sr_error *error)
{
    (void)scene;
    return sr_pilot_begin(&kind, self, plan, shared, error);
}

const struct sr_integrator_model sr_integrator_guided_path = {
    .name = "guidedpath",
    .text = "path, with directions drawn by what a pilot has learned of where light comes from, where that pays",
    .params = params,
    .size = sizeof(struct sr_pilot_path),
    .L = guided_L,
    .knows_receivers = true,
    .begin = begin,
    .end = sr_pilot_end,
};
