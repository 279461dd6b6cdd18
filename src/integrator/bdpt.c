/* SPDX-License-Identifier: MIT */
/* Bidirectional path tracing: a path from the sensor and one from a light, and every way to join the two.
 *
 *     I = sum over s, t of E[ w_s,t f(x) / p_s,t(x) ],     w_s,t = p_s,t^b / sum over s', t' of p_s',t'^b,   b = 2 or 1
 *
 * s vertices from the light, t from the sensor. The density p of a path by area is a product over its vertices, so that
 * neighbouring strategies differ by one factor: p_s-1,t+1 / p_s,t = p(x_t from the sensor) / p(x_t from the light), and
 * all ratios are running products of these. s = 0: the sensor's path meets a light. s = 1: a place on a light is drawn
 * for the receiver, with a density of its own, c times that with which light paths begin. t = 1: the vertex is told to
 * the target. E. Veach, Robust Monte Carlo methods for light transport simulation, 1997, 10; E. Lafortune & Y. Willems
 * 1993. Limits: paths of more than 100 scatterings are not followed. */
#include "integrator/vertices.h"

enum heuristic { POWER, BALANCE };

struct bdpt {
    int32_t max_depth;
    int32_t light_sampler; // enum sr_light_choice; the scene was finished with it
    int32_t heuristic;
    bool regularize, visualize_strategies, visualize_weights;
};

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct bdpt, max_depth),
     "most scatterings of a path; 100 at most are followed"},
    {SR_PARAM_ENUM, "lightsampler", "1", 0, 3, 0, offsetof(struct bdpt, light_sampler), "bvh|power|uniform|exhaustive"},
    {SR_PARAM_ENUM, "heuristic", "1", 0, 1, 0, offsetof(struct bdpt, heuristic), "power|balance"},
    {SR_PARAM_BOOL, "regularize", "1", 0, 1, 0, offsetof(struct bdpt, regularize),
     "accepted; never done, for it is biased"},
    {SR_PARAM_BOOL, "visualizestrategies", "1", 0, 1, 0, offsetof(struct bdpt, visualize_strategies),
     "accepted; nothing is written"},
    {SR_PARAM_BOOL, "visualizeweights", "1", 0, 1, 0, offsetof(struct bdpt, visualize_weights),
     "accepted; nothing is written"},
    {.name = NULL},
};

/* What one sample is made of. */
struct pair {
    const struct bdpt *m;
    const struct sr_scene *scene;
    const struct sr_path_start *start;
    struct sr_wavelengths *w;
    struct sr_worker *worker;
    int max_depth, t_count, s_count;
    uint32_t light; // of the path y
    double c;       // of y[0] for y[1]
    sr_spectrum L;
    struct sr_vertex z[SR_MAX_SCATTERINGS + 2], y[SR_MAX_SCATTERINGS + 1]; // from the sensor, from a light
};

/* ---- weights ---- */

/* A vertex of a whole path, from the sensor on. */
struct step {
    float from_sensor, from_light; // densities
    bool is_delta;
};

/* c: density of drawing the light's vertex for its receiver over that with which light paths begin there. */
static float weight(const struct pair *p, const struct step *v, int n, int t, double c, bool is_hittable)
{
    int s = n - t;
    double own = s == 1 ? c : 1, sum = 1, ratio = 1;
    bool is_balance = p->m->heuristic == BALANCE;
    for (int i = t - 1; i >= 1 && ratio > 0; --i) { // i vertices from the sensor
        ratio *= (double)v[i].from_light / (double)v[i].from_sensor;
        if (v[i].is_delta || v[i - 1].is_delta || (i == 1 && !p->worker->target))
            continue;
        double r = ratio * (n - i == 1 ? c : 1) / own;
        sum += is_balance ? r : r * r;
    }
    ratio = 1;
    for (int i = t; i < n && ratio > 0; ++i) { // i + 1 vertices from the sensor
        ratio *= (double)v[i].from_sensor / (double)v[i].from_light;
        int left = n - i - 1;
        if (left == 0 ? !is_hittable : v[i].is_delta || v[i + 1].is_delta)
            continue;
        double r = ratio * (left == 1 ? c : 1) / own;
        sum += is_balance ? r : r * r;
    }
    return isfinite(sum) ? (float)(1 / sum) : 0;
}

static bool is_hittable(struct sr_light light)
{
    return !light.model->is_delta &&
           !(light.model == &sr_light_area && ((const struct sr_light_area *)light.self)->is_ghost);
}

/* c for a light vertex as seen from its receiver, wi toward it; s: NULL, or how it has been drawn with pmf. */
static double receiver_share(const struct pair *p, uint32_t index, const struct sr_vertex *light_vertex,
                             const struct sr_vertex *receiver, sr_vec3 wi, float pmf, const struct sr_light_sample *s)
{
    const struct sr_lights *lights = sr_scene_lights(p->scene);
    struct sr_light light = lights->lights[index];
    float pdf = 1;
    if (s)
        pdf = s->pdf;
    else if (!light.model->is_delta)
        pdf = light.model->pdf(light.self, &receiver->x, wi, light_vertex->is_outside ? NULL : &light_vertex->x);
    if (!s)
        pmf = pdf > 0 ? sr_lights_pmf(lights, &receiver->x, index) : 0;
    if (!light.model->is_delta && pdf > 0)
        pdf = sr_vertex_density(pdf, receiver, light_vertex);
    return light_vertex->pdf > 0 ? (double)pmf * (double)pdf / (double)light_vertex->pdf : 0;
}

/* Densities of a light path's beginning: of the vertex at the light and of its receiver. */
static void light_densities(const struct pair *p, uint32_t index, struct sr_vertex *light_vertex,
                            const struct sr_vertex *receiver, sr_vec3 wi, float *of_receiver)
{
    const struct sr_lights *lights = sr_scene_lights(p->scene);
    struct sr_light light = lights->lights[index];
    float pdf_area, pdf_direction, pmf = sr_lights_emit_pmf(lights, index);
    light.model->emit_pdf(light.self, light_vertex->x.n, sr_neg(wi), &pdf_area, &pdf_direction);
    light_vertex->pdf = pmf * (light_vertex->is_outside ? pdf_direction : pdf_area);
    *of_receiver = light_vertex->is_outside ? pdf_area * sr_vertex_cos(receiver, wi)
                                            : sr_vertex_density(pdf_direction, light_vertex, receiver);
}

// density of the vertex before v on its own path, drawn at v by what arrives along `in`
static float backward(const struct sr_vertex *v, const struct sr_vertex *last, sr_vec3 in, enum sr_transport mode)
{
    sr_vec3 local = sr_to_local(&v->frame, in);
    return sr_vertex_density(sr_bsdf_pdf(&v->bsdf, local, v->local_to_last, mode), v, last);
}

// density of a new vertex, drawn at v toward d
static float forward(const struct sr_vertex *v, const struct sr_vertex *next, sr_vec3 d, enum sr_transport mode)
{
    return sr_vertex_density(sr_bsdf_pdf(&v->bsdf, v->local_to_last, sr_to_local(&v->frame, d), mode), v, next);
}

static void steps_of_sensor(const struct pair *p, int t, struct step *v)
{
    for (int i = 0; i < t; ++i)
        v[i] = (struct step){p->z[i].pdf, p->z[i].pdf_back, p->z[i].is_delta};
    v[t - 1].is_delta = false; // it is joined to, whatever has been drawn there
}

static void steps_of_light(const struct pair *p, int s, int n, struct step *v)
{
    for (int j = 0; j < s; ++j)
        v[n - 1 - j] = (struct step){p->y[j].pdf_back, p->y[j].pdf, p->y[j].is_delta};
    v[n - s].is_delta = false;
}

/* ---- strategies ---- */

// s = 0
static void meet(void *user, int count, const struct sr_hit *hit, sr_vec3 d, float pdf_direction, sr_spectrum beta)
{
    struct pair *p = user;
    const struct sr_lights *lights = sr_scene_lights(p->scene);
    if (count == 1) {
        p->L += sr_met_at_once(p->scene, p->start, hit, d, p->w);
        return;
    }
    const struct sr_vertex *last = &p->z[count - 1];
    struct sr_vertex *end = &p->z[count]; // not kept
    end->is_outside = !hit;
    end->x = hit ? hit->point : (struct sr_point){.p = {0, 0, 0}};
    for (uint32_t k = 0; k < (hit ? 1 : lights->infinite_count); ++k) {
        uint32_t index = hit ? hit->light : lights->infinite[k];
        struct sr_light light = lights->lights[index];
        sr_spectrum Le = hit ? light.model->Le(light.self, &hit->point, sr_neg(d), p->w)
                             : sr_light_escaping(light, last->x.p, d, p->w);
        if (!sr_spectrum_any(Le > 0.0f))
            continue;
        struct step v[SR_MAX_SCATTERINGS + 2];
        int n = count + 1;
        steps_of_sensor(p, count, v);
        v[count - 1].is_delta = last->is_delta;
        v[count] = (struct step){.from_sensor = sr_vertex_density(pdf_direction, last, end)};
        light_densities(p, index, end, last, d, &v[count - 1].from_light);
        v[count].from_light = end->pdf;
        double c = last->is_delta ? 0 : receiver_share(p, index, end, last, d, 0, NULL);
        p->L += beta * Le * weight(p, v, n, n, c, true);
    }
}

// s = 1
static void join_light(struct pair *p, const struct sr_sampler *sampler, int t)
{
    const struct sr_lights *lights = sr_scene_lights(p->scene);
    const struct sr_vertex *a = &p->z[t - 1];
    sr_u4 u = sr_sample4(sampler, SR_USE_BOUNCE + 2 * (uint32_t)(t - 2));
    uint32_t index;
    float pmf;
    struct sr_light_sample l;
    if (!sr_lights_pick(lights, &a->x, u[2], &index, &pmf) ||
        !sr_light_draw(lights->lights[index], &a->x, (sr_vec2){u[0], u[1]}, p->w, &l))
        return;
    sr_vec3 wi = sr_to_local(&a->frame, l.wi);
    sr_spectrum f = sr_bsdf_f(&a->bsdf, a->local_to_last, wi, SR_RADIANCE);
    sr_spectrum gain = a->beta * f * l.L * (sr_abs_cos_theta(wi) / (pmf * l.pdf));
    if (!sr_spectrum_any(gain > 0.0f) || !sr_unoccluded(p->scene, &a->x, &l, p->worker))
        return;

    struct sr_vertex end;
    end.is_outside = isinf(l.distance);
    end.x = (struct sr_point){.p = l.p, .n = l.n};
    struct step v[SR_MAX_SCATTERINGS + 3];
    int n = t + 1;
    steps_of_sensor(p, t, v);
    v[t] = (struct step){.from_sensor = forward(a, &end, l.wi, SR_RADIANCE)};
    light_densities(p, index, &end, a, l.wi, &v[t - 1].from_light);
    v[t].from_light = end.pdf;
    if (t > 2)
        v[t - 2].from_light = backward(a, &p->z[t - 2], l.wi, SR_IMPORTANCE);
    double c = receiver_share(p, index, &end, a, l.wi, pmf, &l);
    if (c > 0) // all lights that are drawn for receivers begin paths, too
        p->L += gain * weight(p, v, n, t, c, !l.is_delta);
}

// s, t >= 2
static void join(struct pair *p, int s, int t)
{
    const struct sr_vertex *a = &p->z[t - 1], *b = &p->y[s - 1];
    sr_vec3 d = sr_sub(b->x.p, a->x.p);
    float r2 = sr_length2(d), r = sqrtf(r2);
    if (!b->is_connectible || !(r2 > 0))
        return;
    sr_vec3 w = sr_scale(1 / r, d), back = sr_neg(w), wi = sr_to_local(&a->frame, w);
    sr_spectrum f = sr_bsdf_f(&a->bsdf, a->local_to_last, wi, SR_RADIANCE);
    sr_spectrum gain = a->beta * f * (sr_abs_cos_theta(wi) / r2);
    if (!sr_spectrum_any(gain > 0.0f))
        return;
    gain *= sr_vertex_leaving(b, back) * b->beta;
    if (!sr_spectrum_any(gain > 0.0f) || !sr_vertices_see(p->scene, a, sr_point_offset(&b->x, back), w, r, p->worker))
        return;

    struct step v[2 * SR_MAX_SCATTERINGS + 3];
    int n = s + t;
    steps_of_sensor(p, t, v);
    steps_of_light(p, s, n, v);
    v[t].from_sensor = forward(a, b, w, SR_RADIANCE);
    v[t + 1].from_sensor = backward(b, &p->y[s - 2], back, SR_RADIANCE);
    v[t - 1].from_light = forward(b, a, back, SR_IMPORTANCE);
    if (t > 2)
        v[t - 2].from_light = backward(a, &p->z[t - 2], w, SR_IMPORTANCE);
    p->L += gain * weight(p, v, n, t, p->c, is_hittable(sr_scene_lights(p->scene)->lights[p->light]));
}

// t = 1
static void tell(struct pair *p, const struct sr_target *target, const struct sr_sampler *sampler, int s)
{
    const struct sr_vertex *b = &p->y[s - 1];
    sr_u4 u = sr_sample4(sampler, SR_USE_LIGHT_PATH + 2 + 2 * (uint32_t)(s - 2));
    struct sr_sensor_view view;
    sr_spectrum gain;
    if (!sr_vertex_seen(b, target, (sr_vec2){u[0], u[1]}, &view, &gain) ||
        !sr_vertices_see(p->scene, b, view.p, view.wi, view.distance, p->worker))
        return;
    struct step v[SR_MAX_SCATTERINGS + 2];
    int n = s + 1;
    v[0] = (struct step){1, 1, false};
    steps_of_light(p, s, n, v);
    v[1].from_sensor = view.weight * sr_vertex_cos(b, view.wi) / target->pixels;
    v[2].from_sensor = backward(b, &p->y[s - 2], view.wi, SR_RADIANCE);
    gain *= weight(p, v, n, 1, p->c, is_hittable(sr_scene_lights(p->scene)->lights[p->light]));
    target->add(target->user, view.raster, gain, p->w);
}

static sr_spectrum bdpt_L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                          const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                          struct sr_worker *worker)
{
    const struct bdpt *m = self;
    const struct sr_target *target = worker->target;
    const struct sr_sampler *light_sampler = target ? &target->sampler : sampler;
    struct pair p; // not cleared: it is large
    p.m = m;
    p.scene = scene;
    p.start = start;
    p.w = w;
    p.worker = worker;
    p.max_depth = m->max_depth < SR_MAX_SCATTERINGS ? m->max_depth : SR_MAX_SCATTERINGS;
    p.L = SR_BLACK;

    struct sr_vertex *z = p.z;
    z[0].x = (struct sr_point){.p = start->ray.o, .time = start->ray.time};
    z[0].is_outside = z[0].is_delta = z[0].is_connectible = false;
    z[0].pdf = z[0].pdf_back = 1;
    struct sr_walk walk = {.scene = scene,
                           .mode = SR_RADIANCE,
                           .start = start,
                           .sampler = sampler,
                           .first_group = SR_USE_BOUNCE,
                           .max_scatterings = p.max_depth,
                           .w = w,
                           .worker = worker,
                           .met = meet,
                           .user = &p,
                           .first = first};
    p.t_count = sr_walk_vertices(&walk, start->ray, SR_ONE, 1, z);

    walk.mode = SR_IMPORTANCE;
    walk.start = target && target->middle ? target->middle : start;
    walk.has_time = true; // a path is joined at one time
    walk.time = start->ray.time;
    walk.sampler = light_sampler;
    walk.first_group = SR_USE_LIGHT_PATH + 2;
    walk.met = NULL;
    walk.first = NULL;
    struct sr_light_path path = sr_light_vertices(&walk, p.y);
    p.s_count = path.count;
    p.light = path.light;
    if (p.s_count > 1) {
        sr_vec3 wi = p.y[1].to_last;
        p.c = receiver_share(&p, p.light, &p.y[0], &p.y[1], wi, 0, NULL);
    }

    for (int t = 2; t <= p.t_count; ++t) {
        if (!z[t - 1].is_connectible)
            continue;
        join_light(&p, sampler, t);
        for (int s = 2; s <= p.s_count && s + t - 2 <= p.max_depth; ++s)
            join(&p, s, t);
    }
    for (int s = 2; target && s <= p.s_count; ++s)
        tell(&p, target, light_sampler, s);
    return p.L;
}

static const char *blind(const void *self, const struct sr_scene *scene)
{
    (void)scene;
    return sr_long_paths_missing(((const struct bdpt *)self)->max_depth);
}

const struct sr_integrator_model sr_integrator_bdpt = {
    .blind = blind,
    .name = "bdpt",
    .text = "paths from the sensor and from the lights, joined in all ways, weighed by their densities",
    .params = params,
    .size = sizeof(struct bdpt),
    .L = bdpt_L,
    .knows_receivers = true,
    .splats = true,
};
