/* SPDX-License-Identifier: MIT */
/* The rendering equation by any set of strategies, each of which takes one sample at each vertex.
 *
 *     L(x, wo) = Le(x, wo) + integral f(wo, wi) L(x, wi) |cos theta_i| dwi        [W m^-2 sr^-1 nm^-1]
 *     estimate of what lights bring: SUM over i of  w_i(wi) h(wi) Le / p_i(wi),     SUM over i of w_i = 1
 *
 * h = f |cos theta_i| is written once; strategies differ in p_i alone. w_i: balance p_i / SUM p, power p_i^2 / SUM p^2
 * (Veach 1997), mean 1 / n over those that could have found it. What other surfaces bring comes along one of the
 * directions: the BSDF's if that is in the set, else the cosine's, else the uniform one's; where the set has no
 * directions at all, the BSDF's, whose ray then counts only such light as no strategy of the set can draw. Mirrors and
 * clear glass are always followed. */
#include "integrator/shade.h"
#include "integrator/strategies.h"

#include <string.h>

enum heuristic { BALANCE, POWER, MEAN };
enum { FROM_NOWHERE = -1, BY_NONE_OF_SET = -2, GROUPS = 1 + SR_STRATEGY_COUNT };

struct estimator {
    const char *strategies; // names joined by '+'
    int32_t heuristic;      // enum heuristic
    int32_t max_depth;      // most surfaces at which a path is scattered
    // derived
    bool has[SR_STRATEGY_COUNT];
    int going_on;    // the strategy whose direction the path takes
    bool finds_rays; // the set has directions
    const char *label;
};

static const struct sr_param params[] = {
    {SR_PARAM_STRING, "strategies", "1", 0, 0, 0, offsetof(struct estimator, strategies), "bsdf+light-solid-angle"},
    {SR_PARAM_ENUM, "heuristic", "1", 0, 2, 0, offsetof(struct estimator, heuristic), "balance|power|mean"},
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 5, offsetof(struct estimator, max_depth), "most scatterings of a path"},
    {.name = NULL},
};

static sr_status prepare(void *self, struct sr_arena *arena, struct sr_error *error)
{
    struct estimator *e = self;
    memset(e->has, 0, sizeof e->has);
    for (const char *p = e->strategies;;) {
        size_t length = strcspn(p, "+");
        int i = 0;
        while (i < SR_STRATEGY_COUNT &&
               (strlen(sr_strategies[i].name) != length || strncmp(sr_strategies[i].name, p, length) != 0))
            ++i;
        if (i == SR_STRATEGY_COUNT)
            return sr_fail(error, SR_ERROR_INPUT,
                           "there is no strategy \"%.*s\"; there are %s, %s, %s, %s, %s and %s, to be joined by '+'",
                           (int)length, p, sr_strategies[0].name, sr_strategies[1].name, sr_strategies[2].name,
                           sr_strategies[3].name, sr_strategies[4].name, sr_strategies[5].name);
        if (e->has[i])
            return sr_fail(error, SR_ERROR_INPUT, "the strategy \"%s\" is named twice", sr_strategies[i].name);
        e->has[i] = true;
        if (!p[length])
            break;
        p += length + 1;
    }
    e->finds_rays = e->has[SR_BY_BSDF] || e->has[SR_BY_COSINE] || e->has[SR_BY_UNIFORM];
    e->going_on = e->has[SR_BY_BSDF] || !e->finds_rays ? SR_BY_BSDF
                  : e->has[SR_BY_COSINE]               ? SR_BY_COSINE
                                                       : SR_BY_UNIFORM;
    static const char *const names[] = {"balance", "power", "mean"};
    e->label = strchr(e->strategies, '+') ? sr_arena_printf(arena, "%s:%s", e->strategies, names[e->heuristic])
                                          : e->strategies;
    return e->label ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
}

static const char *blind(const void *self, const struct sr_scene *scene)
{
    const struct estimator *e = self;
    const struct sr_lights *lights = sr_scene_lights(scene);
    bool finds_points = false, finds_unmet = false, has_unmet = false;
    for (int i = 0; i < SR_STRATEGY_COUNT; ++i) {
        finds_points |= e->has[i] && sr_strategies[i].finds_points;
        finds_unmet |= e->has[i] && sr_strategies[i].finds_unmet;
    }
    for (uint32_t i = 0; i < lights->count; ++i) {
        struct sr_light light = lights->lights[i];
        has_unmet |= light.model == &sr_light_area && ((const struct sr_light_area *)light.self)->is_ghost;
    }
    if (!finds_points && sr_has_delta_lights(scene))
        return "point, spot and distant lights are missing: no direction and no point of a surface that these strategies draw leads to "
               "them; add light-area or light-solid-angle";
    if (has_unmet && !finds_unmet)
        return "lights whose surface is invisible (alpha 0) are missing: no ray meets them; add an area strategy";
    return NULL;
}

static const char *label(const void *self)
{
    return ((const struct estimator *)self)->label;
}

/* What a path carries along. */
struct walk {
    const struct estimator *e;
    const struct sr_scene *scene;
    const struct sr_lights *lights;
    const struct sr_sampler *sampler;
    struct sr_wavelengths *w;
    struct sr_worker *worker;
};

// w_i of an arrival that strategy `by` has found from v
static float weight_of(const struct walk *t, const struct sr_vertex *v, int by, const struct sr_arrival *a)
{
    if (by == FROM_NOWHERE)
        return 1;
    double sum = 0, mine = 0;
    int count = 0;
    for (int i = 0; i < SR_STRATEGY_COUNT; ++i) {
        if (!t->e->has[i])
            continue;
        double p = (double)sr_strategies[i].density(v, t->lights, a);
        p = t->e->heuristic == POWER ? p * p : t->e->heuristic == MEAN ? p > 0 : p;
        sum += p;
        mine = i == by ? p : mine;
        count += p > 0;
    }
    if (by == BY_NONE_OF_SET || count == 0)
        return count == 0;
    return (float)(mine / sum);
}

static struct sr_arrival arrival(const struct sr_vertex *v, sr_vec3 world, uint32_t light, const struct sr_point *there)
{
    return (struct sr_arrival){
        .world = world, .wi = sr_to_local(&v->frame, world), .light = light, .there = there, .is_met = true};
}

/* Light of a surface that a ray from v has met, toward v. */
static sr_spectrum glow(const struct walk *t, const struct sr_vertex *v, int by, const struct sr_hit *hit, sr_vec3 d)
{
    sr_spectrum Le = sr_hit_Le(t->scene, hit, sr_neg(d), t->w);
    if (by == FROM_NOWHERE || !sr_spectrum_any(Le > 0.0f))
        return Le;
    struct sr_arrival a = arrival(v, d, hit->light, &hit->point);
    return Le * weight_of(t, v, by, &a);
}

/* Light from outside the scene along a ray from v. */
static sr_spectrum escape(const struct walk *t, const struct sr_vertex *v, int by, const struct sr_ray *ray)
{
    if (by == FROM_NOWHERE)
        return sr_escape_Le(t->scene, ray, t->w);
    sr_spectrum L = SR_BLACK;
    for (uint32_t i = 0; i < t->lights->infinite_count; ++i) {
        struct sr_arrival a = arrival(v, ray->d, t->lights->infinite[i], NULL);
        struct sr_light light = t->lights->lights[a.light];
        L += sr_light_escaping(light, ray->o, ray->d, t->w) * weight_of(t, v, by, &a);
    }
    return L;
}

/* Light along a direction that the path does not take. */
static sr_spectrum look(const struct walk *t, const struct sr_vertex *v, int by, sr_vec3 d)
{
    struct sr_ray ray = sr_leave(&v->hit.point, d);
    sr_spectrum L = SR_BLACK;
    for (int passed = 0; passed < 1000; ++passed) {
        struct sr_hit hit;
        if (!sr_trace(t->scene, &ray, &hit, t->worker))
            return L + escape(t, v, by, &ray);
        L += glow(t, v, by, &hit, d);
        if (hit.material)
            break;
        ray = sr_leave(&hit.point, d);
    }
    return L;
}

/* Light that a strategy of area form has drawn. */
static sr_spectrum drawn_light(const struct walk *t, const struct sr_vertex *v, int by, sr_u4 u)
{
    const struct sr_point *x = &v->hit.point;
    uint32_t index;
    float density;
    struct sr_shape_sample s;
    struct sr_light_sample l;
    if (!sr_strategies[by].light(v, t->lights, u, &index, &density, &s))
        return SR_BLACK;
    struct sr_light light = t->lights->lights[index];
    struct sr_point there = {0};
    struct sr_arrival a;
    if (light.model == &sr_light_area) {
        const struct sr_light_area *m = light.self;
        sr_vec3 way = sr_sub(s.p, x->p);
        float r = sr_length(way);
        if (!(r > 0))
            return SR_BLACK;
        there = (struct sr_point){.p = s.p, .p_error = s.p_error, .n = s.n, .uv = s.uv};
        a = arrival(v, sr_scale(1 / r, way), index, &there);
        a.is_met = !m->is_ghost;
        l = (struct sr_light_sample){.L = light.model->Le(light.self, &there, sr_neg(a.world), t->w),
                                     .wi = a.world,
                                     .distance = r,
                                     .p = sr_point_offset(&there, sr_neg(a.world))};
    } else {
        if (!sr_light_draw(light, x, (sr_vec2){u[0], u[1]}, t->w, &l))
            return SR_BLACK;
        a = arrival(v, l.wi, index, NULL);
        a.is_delta = l.is_delta;
        a.is_met = !l.is_delta;
        density *= l.pdf;
    }
    sr_spectrum L = sr_vertex_weight(v, a.wi) * l.L;
    if (!sr_spectrum_any(L != 0.0f) || !sr_unoccluded(t->scene, x, &l, t->worker))
        return SR_BLACK;
    return L * (weight_of(t, v, by, &a) / density);
}

/* What lights bring, by all strategies but the one that goes on. */
static sr_spectrum direct(const struct walk *t, const struct sr_vertex *v, uint32_t group)
{
    sr_spectrum L = SR_BLACK;
    for (int i = 0; i < SR_STRATEGY_COUNT; ++i) {
        if (!t->e->has[i] || i == t->e->going_on)
            continue;
        sr_u4 u = sr_sample4(t->sampler, group + 1 + (uint32_t)i);
        if (sr_strategies[i].light) {
            L += drawn_light(t, v, i, u);
            continue;
        }
        sr_vec3 wi;
        float pdf = sr_strategies[i].direction(v, u, &wi);
        sr_spectrum weight = pdf > 0 ? sr_vertex_weight(v, wi) * (1 / pdf) : SR_BLACK;
        if (sr_spectrum_any(weight != 0.0f))
            L += weight * look(t, v, i, sr_to_world(&v->frame, wi));
    }
    return L;
}

/* The path's next direction. beta gains h / p; eta_scale what refraction has made of it. false: the path ends. */
static bool go_on(const struct walk *t, const struct sr_vertex *v, uint32_t group, float coin, sr_vec3 *wi, int *by,
                  sr_spectrum *beta, float *eta_scale, bool *is_scattered)
{
    int going_on = t->e->going_on;
    sr_u4 u = sr_sample4(t->sampler, group + 1 + (uint32_t)going_on);
    uint32_t lobes = v->receiver ? SR_LOBE_DIFFUSE : sr_bsdf_lobes(&v->bsdf);
    bool must_be_specular = false;
    if (going_on != SR_BY_BSDF && lobes & SR_LOBE_SPECULAR) { // no density draws a mirror's direction: either, by lot
        must_be_specular = !(lobes & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY)) || coin < 0.5f;
        *beta *= lobes & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY) ? 2.0f : 1.0f;
    }
    *by = t->e->has[going_on] ? going_on : BY_NONE_OF_SET;
    if (going_on != SR_BY_BSDF && !must_be_specular) {
        float pdf = sr_strategies[going_on].direction(v, u, wi);
        *beta *= pdf > 0 ? sr_vertex_weight(v, *wi) * (1 / pdf) : SR_BLACK;
        *is_scattered = true;
        return sr_spectrum_any(*beta != 0.0f);
    }
    if (v->receiver) {
        float pdf = v->receiver->sample(v->receiver->self, u, wi);
        *beta *= pdf > 0 ? v->receiver->response(v->receiver->self, *wi) / pdf : 0;
        return sr_spectrum_any(*beta != 0.0f);
    }
    struct sr_bsdf_sample s;
    if (!sr_bsdf_sample(&v->bsdf, v->wo, u[2], (sr_vec2){u[0], u[1]}, SR_RADIANCE, &s))
        return false;
    bool is_specular = s.lobe & SR_LOBE_SPECULAR;
    if (must_be_specular && !is_specular)
        return false;
    if (is_specular)
        *by = FROM_NOWHERE;
    *is_scattered |= !is_specular;
    *wi = s.wi;
    *beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
    if (s.lobe & SR_LOBE_TRANSMISSION)
        *eta_scale *= s.eta * s.eta;
    return sr_spectrum_any(*beta != 0.0f);
}

/* From a sensor ray, or from a receiver (start then holds nothing). */
static sr_spectrum walk(const struct walk *t, const struct sr_path_start *start, const struct sr_receiver *receiver,
                        struct sr_hit *first)
{
    sr_spectrum L = SR_BLACK, beta = SR_ONE;
    struct sr_ray ray = start->ray;
    struct sr_vertex vertices[2] = {{.receiver = receiver}};
    struct sr_vertex *v = &vertices[0], *from = &vertices[1];
    int by = FROM_NOWHERE, passed = 0;
    float eta_scale = 1;
    struct sr_cone cone = sr_cone_of(start, sr_scene_has_footprints(t->scene));
    bool is_scattered = receiver;
    if (receiver) {
        v->hit.point = receiver->x;
        v->frame = receiver->frame;
        v->above = true;
        v->below = !receiver->is_upper;
    }

    for (int bounce = receiver ? -1 : 0;;) {
        uint32_t group = SR_USE_BOUNCE + GROUPS * (uint32_t)(bounce + (receiver ? 1 : 0));
        sr_u4 u = sr_sample4(t->sampler, group);
        if (bounce >= 0) {
            struct sr_hit *x = &v->hit;
            bool is_hit = sr_trace(t->scene, &ray, x, t->worker);
            if (first && bounce == 0)
                *first = is_hit ? *x : (struct sr_hit){.t = INFINITY};
            if (!is_hit)
                return L + beta * escape(t, from, by, &ray);
            L += beta * glow(t, from, by, x, ray.d);
            if (x->material && bounce == t->e->max_depth)
                return L;
            sr_cone_meet(&cone, x, bounce == 0, is_scattered, first);
            v->receiver = NULL;
            if (!sr_shade(x, ray.d, u[0], sr_hash_combine(t->sampler->key + t->sampler->sample, group), t->w, &v->bsdf,
                          &v->frame)) {
                if (!sr_pass_by(x, &ray, &passed))
                    return L;
                continue;
            }
            t->worker->vertices += 1;
            v->wo = sr_to_local(&v->frame, sr_neg(ray.d));
            uint32_t lobes = sr_bsdf_lobes(&v->bsdf);
            bool reflects = lobes & SR_LOBE_REFLECTION, transmits = lobes & SR_LOBE_TRANSMISSION;
            v->above = v->wo.z > 0 ? reflects : transmits;
            v->below = v->wo.z > 0 ? transmits : reflects;
            if (lobes == 0 || v->wo.z == 0)
                return L;
        }

        if (v->receiver || sr_bsdf_lobes(&v->bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY))
            L += beta * direct(t, v, group);
        sr_vec3 wi;
        if (!go_on(t, v, group, u[2], &wi, &by, &beta, &eta_scale, &is_scattered))
            return L;
        ++bounce;
        if (by == BY_NONE_OF_SET && bounce == t->e->max_depth && t->lights->infinite_count == 0)
            return L; // nothing that this last ray may meet would count
        ray = sr_leave(&v->hit.point, sr_to_world(&v->frame, wi));
        struct sr_vertex *free = from;
        from = v;
        v = free;

        // a path that carries little ends by lot, and those that survive carry its share
        float carried = sr_max(sr_spectrum_max(beta), sr_spectrum_max(-beta)) * eta_scale; // net fluxes may be negative
        if (carried < 1 && bounce > 1) {
            float survive = sr_survival(carried);
            if (u[3] >= survive)
                return L;
            beta *= 1 / survive;
        }
    }
}

static sr_spectrum L(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                     const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                     struct sr_worker *worker)
{
    struct walk t = {self, scene, sr_scene_lights(scene), sampler, w, worker};
    return walk(&t, start, NULL, first);
}

static sr_spectrum gather(const void *self, const struct sr_scene *scene, const struct sr_receiver *receiver,
                          const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_worker *worker)
{
    struct walk t = {self, scene, sr_scene_lights(scene), sampler, w, worker};
    return walk(&t, &(struct sr_path_start){0}, receiver, NULL);
}

const struct sr_integrator_model sr_integrator_estimator = {
    .name = "estimator",
    .text = "paths from the sensor by any set of strategies",
    .params = params,
    .size = sizeof(struct estimator),
    .L = L,
    .gather = gather,
    .prepare = prepare,
    .blind = blind,
    .label = label,
};
