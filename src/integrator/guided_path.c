/* SPDX-License-Identifier: MIT */
/* Path tracing whose directions are drawn by what a pilot has learned of where light comes from, where that pays.
 *
 *     p(wi) = (1 - a) p_bsdf(wi) + a p_guide(x, wi)        [1/sr]
 *
 * One direction is drawn from the mixture, and the mixture stands in every weight (Veach 1997, power heuristic, against
 * directions toward lights), so each sample is unbiased whatever has been learned. T. Mueller, M. Gross & J. Novak,
 * Practical path guiding, 2017.
 *
 * The pilot takes a share of the picture's samples on top, with numbers of its own, and throws them away; what it
 * learns is frozen before the picture's first sample (guide.c). It weighs the paths that it has drawn from the mixture
 * as plain path tracing would have found them:
 *
 *     E_plain[F^2] = E[SUM_de c_d c_e W_min(d,e)],  W_d = PRODUCT over the first d scatterings of p / p_bsdf,
 *
 * c_d being what a path gains after d scatterings; where the variance saved is not worth the time, path.c does the
 * picture. Limits: as path.c's without translucent bodies; a meter, which has no pilot, is read by plain paths. */
#include "integrator/guide.h"
#include "integrator/path.h"
#include "integrator/shade.h"
#include "integrator/vertices.h"

#include <stdio.h>

enum { GUIDE_AUTO, GUIDE_ON, GUIDE_OFF };
enum { MOST_RECORDS = 16 };                                                  // of a path
enum { MOST_PILOT = 1 << 21, LEAST_PILOT = 1 << 13, FIRST_ROUND = 1 << 11 }; // [paths]
enum { CHUNK = 256 }; // [pairs of paths] that a thread takes at a time
enum { TILES = 24 };  // along each side of the picture

// a price list of what the pilot counts, so that its verdict depends on no clock [1]
static const double ray_cost = 1, shadow_cost = 0.6, vertex_cost = 1.2, walk_cost = 0.45, guide_cost = 1.1;
static const double least_gain = 0.9; // of variance times time, for guiding to pay

struct guided {
    struct sr_path path;
    int32_t guiding;
    float pilot;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct guided, path.max_depth), "most scatterings of a path"},
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct guided, path.light_sampler),
     "bvh|power|uniform|exhaustive"},
    {SR_PARAM_ENUM, "guiding", "1", 0, 2, 0, offsetof(struct guided, guiding), "auto|on|off"},
    {SR_PARAM_FLOAT, "pilot", "1", 0, 10, 0.06, offsetof(struct guided, pilot),
     "samples of the pilot, for each sample of the picture"},
    {.name = NULL},
};

/* What the samples of a picture share. */
struct shared {
    struct sr_guide *guide; // NULL: nothing has been learned yet
    bool is_guiding;
    bool is_exploring; // every cell draws some directions by the guide, so that its worth is known everywhere
    /* Variance counts by how bright the picture is there, so that its dark parts have a say: 1 / (mean^2 + (0.1 mean of
     * all)^2) of tiles. */
    double mean, weight[TILES * TILES];
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
    struct sr_box places;
    double importance;   // [1] of variance in this part of the picture
    double light, noise; // means' sums: see sr_guide_create
    uint64_t lights, noises;
    double total, square, plain; // of the path: F, F^2, and the latter's expectation without guide [of L]
    double weight, weighed;      // W_d; SUM c_d W_d
    uint32_t guided;             // vertices where the guide has had a say
};

static float mean_of(sr_spectrum s, const struct sr_wavelengths *w)
{
    return sr_wavelengths_secondary_terminated(w) ? s[0] : sr_spectrum_mean(s);
}

/* L has gained by c. */
static void note_gain(struct lesson *l, sr_spectrum c, const struct sr_wavelengths *w)
{
    double gain = (double)mean_of(c, w);
    l->plain += gain * (gain * l->weight + 2 * l->weighed);
    l->weighed += gain * l->weight;
    l->total += gain;
}

/* Once the path has ended: what came of each step. */
static void learn(struct lesson *l, const struct shared *shared, sr_spectrum L, const struct sr_wavelengths *w)
{
    for (int i = 0; i < l->count; ++i) {
        struct step *s = &l->steps[i];
        sr_spectrum gained = L - s->before, arrived = SR_BLACK;
        for (int k = 0; k < SR_LAMBDA_COUNT; ++k)
            arrived[k] = s->beta[k] > 0 ? gained[k] / s->beta[k] : 0;
        double c = (double)mean_of(gained, w), light = (double)(mean_of(arrived, w) * s->cosine);
        s->record.noise = c * c * l->importance;
        s->record.light = light * light / (double)s->record.pdf;
        if (!isfinite(s->record.noise) || !isfinite(s->record.light))
            continue;
        if (shared->guide)
            sr_guide_add(shared->guide, &s->record);
        l->noise += s->record.noise;
        l->noises += 1;
        if (s->record.is_direction) {
            l->light += s->record.light;
            l->lights += 1;
        }
    }
    l->square = l->total * l->total;
}

/* ---- a path ---- */

/* The share of directions that the guide draws at x, its cell told. 0: none. */
static float guided_share(const struct shared *shared, const struct sr_point *x, sr_vec3 d, const struct sr_bsdf *bsdf,
                          const struct sr_guide_cell **cell, struct sr_guide_record *record)
{
    record->place = sr_guide_place(shared->guide, x->p, sr_face_forward(x->n, sr_neg(d)));
    record->cell = sr_guide_find(shared->guide, &record->place);
    *cell = sr_guide_cell(shared->guide, record->cell);
    record->kind = !sr_bsdf_is_diffuse(bsdf);
    float share = (*cell)->has_light ? (*cell)->share[record->kind] : 0;
    return shared->is_exploring && (*cell)->has_light ? sr_max(share, 0.2f) : share;
}

/* sr_path_direct against the mixture. */
static bool direct(const struct sr_lights *lights, const struct shared *shared, const struct sr_guide_cell *cell,
                   float share, const struct sr_point *x, const struct sr_frame *frame, const struct sr_bsdf *bsdf,
                   sr_vec3 wo, sr_u4 u, const struct sr_wavelengths *w, struct sr_light_sample *l, sr_spectrum *L)
{
    uint32_t index;
    float pmf, pdf_bsdf;
    if (!sr_lights_pick(lights, x, u[2], &index, &pmf) ||
        !sr_light_draw(lights->lights[index], x, (sr_vec2){u[0], u[1]}, w, l))
        return false;
    sr_vec3 wi = sr_to_local(frame, l->wi);
    sr_spectrum fL = sr_bsdf_f_pdf(bsdf, wo, wi, SR_RADIANCE, &pdf_bsdf) * l->L * sr_abs_cos_theta(wi);
    if (!sr_spectrum_any(fL > 0.0f))
        return false;
    float pdf = pmf * l->pdf,
          other = l->is_delta ? 0 : (1 - share) * pdf_bsdf + share * sr_guide_pdf(shared->guide, cell, l->wi);
    *L = fL * (sr_mis_weight(pdf, other) / pdf);
    return true;
}

/* Draws wi from the mixture: f |cos theta| / p in *gain; the densities in the record. false: the path ends. */
static bool draw(const struct shared *shared, const struct sr_guide_cell *cell, float share,
                 const struct sr_frame *frame, const struct sr_bsdf *bsdf, sr_vec3 wo, sr_u4 u, bool is_learning,
                 struct sr_bsdf_sample *s, sr_spectrum *gain, struct sr_guide_record *r)
{
    bool wants_guide = share > 0 || (is_learning && cell && cell->has_light);
    sr_vec2 u2 = {u[0], u[1]};
    if (u[2] < share) {
        r->pdf_guide = sr_guide_sample(shared->guide, cell, u2, &r->w);
        *s = (struct sr_bsdf_sample){.wi = sr_to_local(frame, r->w), .eta = 1, .lobe = SR_LOBE_GLOSSY};
        s->f = sr_bsdf_f_pdf(bsdf, wo, s->wi, SR_RADIANCE, &r->pdf_bsdf);
        s->lobe |= sr_same_hemisphere(wo, s->wi) ? SR_LOBE_REFLECTION : SR_LOBE_TRANSMISSION;
    } else {
        if (!sr_bsdf_sample(bsdf, wo, (u[2] - share) / (1 - share), u2, SR_RADIANCE, s))
            return false;
        r->w = sr_to_world(frame, s->wi);
        bool is_delta = s->lobe & SR_LOBE_SPECULAR;
        r->pdf_bsdf = s->pdf_is_proportional && !is_delta ? sr_bsdf_pdf(bsdf, wo, s->wi, SR_RADIANCE) : s->pdf;
        r->pdf_guide = wants_guide && !is_delta ? sr_guide_pdf(shared->guide, cell, r->w) : 0;
    }
    r->is_direction = !(s->lobe & SR_LOBE_SPECULAR);
    r->pdf = (1 - share) * r->pdf_bsdf + share * r->pdf_guide;
    // what the BSDF has drawn may share an unknown factor with its density: then only their ratio is known, and it is
    // weighed against the guide by a density like it
    float weight = u[2] < share              ? 1 / r->pdf
                   : share > 0 && r->pdf > 0 ? r->pdf_bsdf / (r->pdf * s->pdf)
                                             : 1 / ((1 - share) * s->pdf);
    *gain = s->f * (sr_abs_cos_theta(s->wi) * weight);
    return true;
}

static sr_spectrum walk(const struct guided *m, const struct sr_scene *scene, const struct sr_path_start *start,
                        const struct sr_sampler *sampler, const struct shared *shared, struct lesson *lesson,
                        struct sr_wavelengths *w, struct sr_hit *first, struct sr_worker *worker)
{
    const struct sr_lights *lights = sr_scene_lights(scene);
    bool has_footprints = sr_scene_has_footprints(scene);
    float width = 0, spread = has_footprints ? 0.5f * (sr_length(start->dddx) + sr_length(start->dddy)) : 0;
    struct sr_ray ray = start->ray;
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    sr_spectrum unguided =
        SR_ONE; // beta, had the BSDF drawn these directions: what lives on by it does so however it was found
    float pdf = INFINITY, eta_scale = 1;
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
            sr_spectrum met = beta * sr_met_at_once(scene, &now, is_hit ? &x : NULL, ray.d, w);
            L += met;
            if (lesson)
                note_gain(lesson, met, w);
        }
        if (!is_hit || (x.material && bounce == m->path.max_depth))
            return L;
        if (x.material && has_footprints) {
            sr_path_footprint(start, &x, bounce == 0, is_scattered, spread, &width);
            if (first && bounce == 0)
                first->point = x.point;
        }
        struct sr_bsdf bsdf;
        struct sr_frame frame;
        uint32_t seed = sampler->key + sampler->sample * 0x9e3779b9u + group * 0x85ebca6bu; // random walks hash it
        if (!sr_shade_plain(&x, ray.d, u_bsdf[3], seed, w, &bsdf, &frame)) {
            if (!sr_pass(&x, &ray, &passed))
                return L;
            continue;
        }
        worker->vertices += 1;
        sr_vec3 wo = sr_to_local(&frame, sr_neg(ray.d));
        if (wo.z == 0)
            return L;
        const struct sr_guide_cell *cell = NULL;
        struct sr_guide_record record = {0};
        float share = 0;
        // where no direction has a density, none is guided; nor where the next surface is not looked at but for its own
        // light
        bool is_guidable = sr_bsdf_lobes(&bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY) && bounce + 1 < m->path.max_depth;
        if (is_guidable && shared->guide)
            share = guided_share(shared, &x.point, ray.d, &bsdf, &cell, &record);
        struct sr_light_sample l;
        sr_spectrum L_direct;
        bool is_lit =
            sr_bsdf_lobes(&bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY) &&
            (share > 0 ? direct(lights, shared, cell, share, &x.point, &frame, &bsdf, wo, u_light, w, &l, &L_direct)
                       : sr_path_direct(lights, &x.point, &frame, &bsdf, wo, u_light, w, &l, &L_direct));
        struct sr_bsdf_sample s;
        sr_spectrum gain;
        bool goes_on = draw(shared, cell, share, &frame, &bsdf, wo, u_bsdf, lesson != NULL, &s, &gain, &record);
        if (is_lit && sr_unoccluded(scene, &x.point, &l, worker)) {
            L += beta * L_direct;
            if (lesson)
                note_gain(lesson, beta * L_direct, w);
        }
        if (!goes_on)
            return L;
        beta *= gain;
        unguided *= gain * (record.pdf_bsdf > 0 ? record.pdf / record.pdf_bsdf : 0);
        pdf = s.lobe & SR_LOBE_SPECULAR ? INFINITY : record.pdf;
        if (lesson) {
            lesson->guided += share > 0;
            lesson->weight *= record.pdf_bsdf > 0 ? (double)(record.pdf / record.pdf_bsdf) : 0;
            lesson->places = sr_box_add(lesson->places, x.point.p);
            if (is_guidable && lesson->count < MOST_RECORDS)
                lesson->steps[lesson->count++] =
                    (struct step){.record = record, .before = L, .beta = beta, .cosine = sr_abs_cos_theta(s.wi)};
        }
        if (s.lobe & SR_LOBE_TRANSMISSION)
            eta_scale *= s.eta * s.eta;
        is_scattered |= !(s.lobe & SR_LOBE_SPECULAR);
        from = x.point;
        ray = sr_leave(&x.point, sr_to_world(&frame, s.wi));
        ++bounce;
        if (!(sr_spectrum_max(beta) > 0))
            return L;
        float carried = sr_spectrum_max(unguided) * eta_scale;
        if (carried < 1 && bounce > 1) {
            float survive = sr_max(carried, 0.05f);
            if (u_light[3] >= survive)
                return L;
            beta *= 1 / survive;
            unguided *= 1 / survive;
        }
    }
}

static sr_spectrum guided_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                            const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                            struct sr_worker *worker)
{
    const struct guided *m = self;
    const struct shared *shared = worker->shared;
    if (!shared || start->receiver || !shared->is_guiding)
        return sr_integrator_path.L(&m->path, scene, start, sampler, w, first, worker);
    struct lesson *lesson = worker->held;
    sr_spectrum L = walk(m, scene, start, sampler, shared, lesson, w, first, worker);
    if (lesson)
        learn(lesson, shared, L, w);
    return L;
}

/* ---- the pilot ---- */

/* Sums of a chunk's paths. */
struct tally {
    struct sr_box places;
    double light, noise, sum;
    double variance, saved; // of pairs: of guided paths, and what plain paths have more
    uint64_t lights, noises, pairs, rays, shadow_rays, vertices, guided;
};

struct round {
    const struct sr_picture_plan *plan;
    struct shared *shared;
    uint32_t number, pairs;
    struct tally *tallies; // of each chunk
};

static void try_pair(const struct round *r, uint32_t i, struct tally *t, struct sr_worker *worker)
{
    const struct sr_picture_plan *plan = r->plan;
    // pixels by a net over the picture; replicates from the other end than the picture's
    struct sr_sampler where = sr_sampler_start(plan->sampler, plan->seed, UINT32_MAX, UINT32_MAX - 1, r->number, i);
    sr_u4 u = sr_sample4(&where, SR_USE_FILM);
    uint32_t x = plan->x0 + (uint32_t)(u[0] * (float)plan->width),
             y = plan->y0 + (uint32_t)(u[1] * (float)plan->height);
    uint32_t tile = (uint32_t)(u[0] * TILES) + TILES * (uint32_t)(u[1] * TILES);
    double importance = r->shared->weight[tile], total[2], saved = 0;
    for (uint32_t k = 0; k < 2; ++k) {
        struct lesson lesson = {.weight = 1, .importance = importance, .places = t->places};
        worker->held = &lesson;
        struct sr_sampler sampler =
            sr_sampler_start(plan->sampler, plan->seed, x, y, UINT32_MAX - 2 * r->number - k, i);
        plan->try(plan->picture, x, y, &sampler, worker);
        total[k] = lesson.total;
        if (!isfinite(lesson.square) || !isfinite(lesson.plain))
            return;
        t->places = lesson.places;
        t->light += lesson.light;
        t->lights += lesson.lights;
        t->noise += lesson.noise;
        t->noises += lesson.noises;
        t->guided += lesson.guided;
        saved += 0.5 * importance * (lesson.plain - lesson.square);
    }
    double mean = 0.5 * (total[0] + total[1]);
    t->sum += mean;
    if (r->shared->mean > 0) {
        __atomic_fetch_add(&r->shared->sum[tile], (uint64_t)fmin(fmax(mean / r->shared->mean, 0) * 0x1p20, 0x1p40),
                           __ATOMIC_RELAXED);
        __atomic_fetch_add(&r->shared->count[tile], 1, __ATOMIC_RELAXED);
    }
    t->variance +=
        0.5 * importance * (total[0] - total[1]) * (total[0] - total[1]); // what both have in common leaves no trace
    t->saved += saved;
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
        sum.light += t->light, sum.lights += t->lights;
        sum.noise += t->noise, sum.noises += t->noises;
        sum.sum += t->sum, sum.variance += t->variance, sum.saved += t->saved, sum.pairs += t->pairs;
        sum.rays += t->rays, sum.shadow_rays += t->shadow_rays, sum.vertices += t->vertices, sum.guided += t->guided;
    }
    r->plan->counted->rays += sum.rays;
    r->plan->counted->shadow_rays += sum.shadow_rays;
    r->plan->counted->vertices += sum.vertices;
    return sum;
}

/* After a round: how much variance counts in each tile; four paths as bright as the mean stand for what is not known
 * yet. */
static void weigh_tiles(struct shared *shared, const struct tally *t)
{
    if (!(shared->mean > 0) && t->pairs)
        shared->mean = t->sum / (double)t->pairs;
    for (int i = 0; i < TILES * TILES; ++i) {
        double mean = shared->mean * ((double)shared->sum[i] * 0x1p-20 + 4) / ((double)shared->count[i] + 4),
               all = 0.1 * shared->mean;
        shared->weight[i] = shared->mean > 0 ? 1 / (mean * mean + all * all) : 1;
    }
}

/* What the pilot says of plain paths against guided ones. */
struct verdict {
    double variance, time; // [1] guided over plain
    bool pays;
};

static struct verdict judge(const struct tally *t)
{
    double plain = t->variance + t->saved;
    double time = ray_cost * (double)t->rays + shadow_cost * (double)t->shadow_rays + vertex_cost * (double)t->vertices;
    double more = walk_cost * (double)t->vertices + guide_cost * (double)t->guided;
    struct verdict v = {.variance = plain > 0 ? t->variance / plain : 1, .time = time > 0 ? 1 + more / time : 1};
    v.pays = plain > 0 && v.variance * v.time < least_gain;
    return v;
}

static sr_status run_pilot(const struct sr_picture_plan *plan, struct shared *shared, uint32_t pairs,
                           struct tally *last, struct sr_error *error)
{
    struct round r = {.plan = plan, .shared = shared, .pairs = FIRST_ROUND / 2};
    r.tallies = sr_alloc((pairs / CHUNK + 1) * sizeof *r.tallies);
    if (!r.tallies)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the pilot of guided paths");
    weigh_tiles(shared, &(struct tally){0});
    *last = try_round(&r);
    weigh_tiles(shared, last);
    double light = last->lights ? last->light / (double)last->lights : 0,
           noise = last->noises ? last->noise / (double)last->noises * shared->weight[0]
                                : 0; // all tiles weigh the same so far
    shared->guide = sr_guide_create(&last->places, light, noise);
    bool is_complete = shared->guide;
    for (uint32_t done = r.pairs; is_complete && done < pairs; done += r.pairs) {
        // each round is as long as all before it, and a shorter rest goes with the last one
        r.pairs = pairs - done < done + done / 2 ? pairs - done : done;
        r.number += 1;
        shared->is_exploring = done + r.pairs < pairs;
        *last = try_round(&r);
        weigh_tiles(shared, last);
        is_complete = sr_guide_refine(shared->guide);
    }
    shared->is_exploring = false;
    sr_free(r.tallies);
    return is_complete ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the guide of paths");
}

static void end(void *p)
{
    struct shared *shared = p;
    sr_guide_destroy(shared->guide);
    sr_free(shared);
}

static sr_status begin(const void *self, const struct sr_scene *scene, const struct sr_picture_plan *plan, void **out,
                       struct sr_error *error)
{
    const struct guided *m = self;
    (void)scene;
    double wanted = (double)m->pilot * plan->spp * plan->width * plan->height;
    if (m->guiding == GUIDE_OFF || (m->guiding == GUIDE_AUTO && wanted < LEAST_PILOT)) {
        snprintf(plan->remark, SR_PICTURE_REMARK, "paths are not guided: %s",
                 m->guiding == GUIDE_OFF ? "guiding is off" : "there are too few samples to learn from");
        return SR_OK;
    }
    uint32_t paths = wanted < LEAST_PILOT ? LEAST_PILOT : wanted > MOST_PILOT ? MOST_PILOT : (uint32_t)wanted;
    struct shared *shared = sr_alloc(sizeof *shared);
    if (!shared)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for the guide of paths");
    shared->is_guiding = true;
    struct tally last;
    sr_status status = run_pilot(plan, shared, paths / 2, &last, error);
    if (status != SR_OK) {
        end(shared);
        return status;
    }
    struct verdict v = judge(&last);
    shared->is_guiding = m->guiding == GUIDE_ON || v.pays;
    snprintf(plan->remark, SR_PICTURE_REMARK,
             "paths are %sguided: by a pilot of %u paths (%zu cells), guiding makes variance x %.3g, time x %.3g",
             shared->is_guiding ? "" : "not ", paths, sr_guide_cell_count(shared->guide), v.variance, v.time);
    *out = shared;
    return SR_OK;
}

const struct sr_integrator_model sr_integrator_guided_path = {
    .name = "guidedpath",
    .text = "path, with directions drawn by what a pilot has learned of where light comes from, where that pays",
    .params = params,
    .size = sizeof(struct guided),
    .L = guided_L,
    .knows_receivers = true,
    .begin = begin,
    .end = end,
};
