/* SPDX-License-Identifier: MIT */
/* What a meter reads, without chance: light that arrives at a point, or that a point reflects, by adaptive cubature.
 *
 *     INTEGRAL g(wi) L(wi) dwi = SUM over lights of  INTEGRAL over the unit square of  g(wi(u)) L V / p(wi(u)) du
 *         [1/nm]
 *
 * g: a meter's response, or f(wo, wi) |cos theta_i| of the surface that it looks at. A light's own draw wi(u), with its
 * density p, is the change of variables: over the light's area or its solid angle, so that V = 1 leaves it smooth. What
 * shines from outside is integrated over the meter's draw, or over cosine-weighted directions. Lights that are delta
 * functions are one evaluation. Each variable by Gauss-Kronrod rules, one within the other (sr_integrate); wavelengths
 * by trapezoids of 1 nm at most. The bound is that of the cubature and the difference of trapezoids of one and of two
 * steps. Limits: light of which no node sees anything is missed, and nothing tells. */
#include "render/measure.h"

#include <stdio.h>

#define SHARE 0.25 // of a tolerance goes to the inner integral
#define LEAST 1e-2 // [1] of the brightest wavelength: darker ones need not be more exact than that
enum { OUTER = 60, INNER = 40, EVALUATIONS = 1 << 19 };

/* One group of wavelengths at one place. */
struct task {
    const struct sr_render_job *job;
    const struct sr_meter *meter; // NULL: the surface is looked at
    struct sr_bsdf bsdf;          // of it
    sr_vec3 wo;
    struct sr_point x;
    struct sr_frame frame;
    struct sr_wavelengths w;
    struct sr_light light;
    double inner_tolerance[SR_LAMBDA_COUNT];
    double u; // outer variable
    int64_t budget;
    struct sr_worker worker;
};

/* ---- the integrand ---- */

static sr_spectrum weight_of(const struct task *t, sr_vec3 wi)
{
    return t->meter ? SR_ONE * t->meter->model->response(t->meter->self, wi)
                    : sr_bsdf_f(&t->bsdf, t->wo, wi, SR_RADIANCE) * sr_abs_cos_theta(wi);
}

// directions for light from outside; returns their density [1/sr]
static float direction(const struct task *t, sr_vec2 u, sr_vec3 *wi)
{
    if (t->meter)
        return t->meter->model->sample(t->meter->self, (sr_u4){u.x, u.y, 0.5f, 0.5f}, wi);
    uint32_t lobes = sr_bsdf_lobes(&t->bsdf);
    bool both = lobes & SR_LOBE_REFLECTION && lobes & SR_LOBE_TRANSMISSION, first = !both || u.x < 0.5f;
    if (both)
        u.x = u.x < 0.5f ? 2 * u.x : 2 * u.x - 1;
    *wi = sr_warp_cosine_hemisphere(u);
    float pdf = sr_warp_cosine_hemisphere_pdf(wi->z) * (both ? 0.5f : 1);
    bool is_reflected = both ? first : lobes & SR_LOBE_REFLECTION;
    if ((t->wo.z > 0) != is_reflected)
        wi->z = -wi->z;
    return pdf;
}

static sr_spectrum arriving(struct task *t, sr_vec2 u)
{
    struct sr_light_sample s;
    sr_vec3 wi;
    if (t->light.model->is_infinite && !t->light.model->is_delta) {
        float pdf = direction(t, u, &wi);
        if (!(pdf > 0))
            return SR_BLACK;
        s = (struct sr_light_sample){.wi = sr_to_world(&t->frame, wi), .distance = INFINITY, .pdf = pdf};
        s.L = sr_light_escaping(t->light, t->x.p, s.wi, &t->w);
    } else {
        if (!sr_light_draw(t->light, &t->x, u, &t->w, &s) || !(s.pdf > 0))
            return SR_BLACK;
        wi = sr_to_local(&t->frame, s.wi);
    }
    sr_spectrum L = weight_of(t, wi) * s.L * (1 / s.pdf);
    return sr_spectrum_any(L != 0.0f) && sr_unoccluded(t->job->scene, &t->x, &s, &t->worker) ? L : SR_BLACK;
}

static void inner(void *context, double v, struct sr_estimate *y)
{
    struct task *t = context;
    --t->budget;
    sr_spectrum L = arriving(t, (sr_vec2){(float)t->u, (float)v});
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        y->value[l] = (double)L[l];
        y->error[l] = 0;
    }
}

static const double breaks[3] = {0, 0.5, 1}; // disks and hemispheres have seams there

static void outer(void *context, double u, struct sr_estimate *y)
{
    struct task *t = context;
    t->u = u;
    sr_integrate(inner, t, breaks, 3, t->inner_tolerance, INNER, &t->budget, y);
}

/* ---- all lights ---- */

static void add(struct sr_estimate *sum, const struct sr_estimate *more)
{
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        sum->value[l] += more->value[l];
        sum->error[l] += more->error[l];
    }
}

static void integrate_light(struct task *t, double relative, struct sr_estimate *y)
{
    double tolerance[SR_LAMBDA_COUNT] = {0}, brightest = 0;
    if (t->light.model->is_delta) {
        t->u = 0.5;
        inner(t, 0.5, y);
        return;
    }
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        t->inner_tolerance[l] = 0;
    sr_integrate(outer, t, breaks, 3, tolerance, OUTER, &t->budget, y); // how bright it is, roughly
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        brightest = fmax(brightest, fabs(y->value[l]));
    if (!(brightest > 0))
        return;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        tolerance[l] = relative * fmax(fabs(y->value[l]), LEAST * brightest);
        t->inner_tolerance[l] = SHARE * tolerance[l];
    }
    sr_integrate(outer, t, breaks, 3, tolerance, OUTER, &t->budget, y);
}

static void integrate_lights(struct task *t, double relative, struct sr_estimate *sum)
{
    const struct sr_lights *lights = sr_scene_lights(t->job->scene);
    for (uint32_t i = 0; i < lights->count && !measure_is_cancelled(t->job); ++i) {
        struct sr_estimate y;
        t->light = lights->lights[i];
        integrate_light(t, relative, &y);
        add(sum, &y);
    }
}

/* ---- where light arrives ---- */

static void add_exact(struct sr_estimate *sum, sr_spectrum L)
{
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        sum->value[l] += (double)L[l];
}

/* The surface that a meter sees along its ray, with what glows on the way. Returns why it cannot be integrated, or
 * NULL; is_met: whether there is one that scatters. */
static const char *look(struct task *t, const struct sr_meter_place *at, struct sr_estimate *sum, bool *is_met)
{
    sr_vec3 d;
    t->meter->model->sample(t->meter->self, (sr_u4){0.5f, 0.5f, 0.5f, 0.5f}, &d);
    d = sr_to_world(&at->frame, d);
    struct sr_ray ray = sr_leave(&at->x, d);
    *is_met = false;
    for (int passed = 0; passed < 1000; ++passed) {
        struct sr_hit hit;
        if (!sr_trace(t->job->scene, &ray, &hit, &t->worker)) {
            add_exact(sum, sr_escape_Le(t->job->scene, &ray, &t->w));
            return NULL;
        }
        add_exact(sum, sr_hit_Le(t->job->scene, &hit, sr_neg(d), &t->w));
        t->bsdf.model = NULL;
        t->x = hit.point;
        if (hit.material) {
            if (hit.material->model->choose)
                return "the surface that the meter sees is a mix, one of whose parts is drawn at each look";
            sr_material_shade(hit.material, &t->x, sr_neg(d), 0.5f, 0, &t->w, &t->bsdf, &t->frame);
        }
        if (t->bsdf.model)
            break;
        ray = sr_leave(&hit.point, d);
    }
    *is_met = t->bsdf.model;
    if (!*is_met)
        return NULL;
    t->meter = NULL;
    t->wo = sr_to_local(&t->frame, sr_neg(d));
    uint32_t lobes = sr_bsdf_lobes(&t->bsdf);
    *is_met = lobes != 0 && t->wo.z != 0;
    return lobes & SR_LOBE_SPECULAR   ? "the surface that the meter sees is a mirror or clear, in part at least"
           : t->bsdf.model->is_random ? "the surface that the meter sees scatters by a random walk"
           : sr_wavelengths_secondary_terminated(&t->w) ? "the surface that the meter sees disperses light"
                                                        : NULL;
}

/* ---- wavelengths ---- */

struct job {
    const struct measuring *m;
    struct sr_meter_place at;
    bool is_ray;
    struct sr_lambda_range range; // [nm]
    uint32_t points;              // odd
    double step;                  // [nm]
    struct sr_quadrature settings;
    struct group {
        struct sr_wavelengths w;
        struct sr_estimate y;
        const char *why_not; // NULL: done
        uint64_t evaluations;
    } * groups;
};

/* Trapezoids as wavelengths of a path, which counts each as X / (SR_LAMBDA_COUNT pdf) [nm]; stride 2: every other one.
 */
static struct sr_wavelengths grid(const struct job *j, uint64_t group, uint32_t stride)
{
    struct sr_wavelengths w = {.known = NULL};
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
        uint64_t i = group * SR_LAMBDA_COUNT + (uint64_t)l;
        bool is_inside = i < j->points && i % stride == 0;
        double width = j->step * stride * (i == 0 || i + 1 == j->points ? 0.5 : 1);
        w.lambda[l] = i + 1 < j->points ? (float)((double)j->range.lo + j->step * (double)i) : j->range.hi;
        w.pdf[l] = is_inside ? (float)(1 / (SR_LAMBDA_COUNT * width)) : INFINITY;
    }
    return w;
}

static void integrate_group(void *context, uint64_t i)
{
    const struct job *j = context;
    struct group *g = &j->groups[i];
    struct task t = {.job = j->m->job,
                     .meter = j->m->meter,
                     .x = j->at.x,
                     .frame = j->at.frame,
                     .w = grid(j, i, 1),
                     .budget = EVALUATIONS};
    g->y = (struct sr_estimate){0};
    g->w = t.w;
    bool is_met = true;
    if (j->is_ray)
        g->why_not = look(&t, &j->at, &g->y, &is_met);
    if (!g->why_not && is_met && (!j->is_ray || j->settings.max_depth > 0))
        integrate_lights(&t, (double)j->settings.tolerance, &g->y);
    g->evaluations = (uint64_t)(EVALUATIONS - t.budget);
}

/* Sums over the groups: channels by one step, by two, and of the bounds. */
static bool sum_groups(const struct job *j, uint32_t count, double *fine, double *coarse, double *bound,
                       uint64_t *evaluations)
{
    bool is_finite = true;
    for (uint32_t i = 0; i < count; ++i) {
        sr_spectrum X, e;
        double looked_at;
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l) {
            X[l] = (float)j->groups[i].y.value[l];
            e[l] = (float)j->groups[i].y.error[l];
        }
        struct sr_wavelengths w2 = grid(j, i, 2);
        is_finite &= measure_add(j->m, X, &j->groups[i].w, fine, &looked_at) &&
                     measure_add(j->m, X, &w2, coarse, &looked_at) &&
                     measure_add(j->m, e, &j->groups[i].w, bound, &looked_at);
        *evaluations += j->groups[i].evaluations;
    }
    return is_finite;
}

/* Bounds are taken as half the width of an even distribution (GUM 4.3.7), with what float leaves of the digits. */
static void set(struct sr_quantity *q, double value, double bound)
{
    q->value = value;
    q->u = hypot(bound / sqrt(3), 1e-6 * fabs(value));
    q->degrees = INFINITY;
}

static void set_colours(const double xyz[3], const double bound[3], struct sr_measurement *out)
{
    double c[SR_COLOUR_COUNT] = {xyz[0], xyz[1], xyz[2]}, u2[SR_COLOUR_COUNT] = {0};
    sr_colour_of(c);
    for (int k = 0; k < 3; ++k) {
        double moved[SR_COLOUR_COUNT] = {xyz[0], xyz[1], xyz[2]}, u = hypot(bound[k] / sqrt(3), 1e-6 * xyz[k]);
        moved[k] += u;
        sr_colour_of(moved);
        for (int i = 0; i < SR_COLOUR_COUNT; ++i)
            u2[i] += (moved[i] - c[i]) * (moved[i] - c[i]);
    }
    for (int i = 0; i < SR_COLOUR_COUNT; ++i)
        out->colour[i] = (struct sr_quantity){.value = c[i],
                                              .u = sqrt(u2[i]),
                                              .degrees = INFINITY,
                                              .unit = i <= SR_COLOUR_Z ? out->value[SR_PHOTOPIC].unit
                                                                       : (struct sr_unit){.second = 0}};
}

/* ---- the whole ---- */

/* Why this meter in this scene is no integral over two variables; NULL: it is. */
static const char *refusal(const struct measuring *m, int32_t max_depth, struct sr_meter_place *at, bool *is_ray)
{
    const struct sr_meter_model *model = m->meter->model;
    struct sr_meter_place other;
    if (model->far || model->raster || !model->place(m->meter->self, (sr_vec2){0.25f, 0.25f}, at) ||
        !model->place(m->meter->self, (sr_vec2){0.75f, 0.625f}, &other) || sr_length2(sr_sub(at->x.p, other.x.p)) > 0)
        return "the meter has an area";
    measure_settle(m->job->scene, at);
    *is_ray = model->is_ray && model->is_ray(m->meter->self);
    if (max_depth > (*is_ray ? 1 : 0))
        return *is_ray
                   ? "light that is reflected more than once is asked for (quadrature,maxdepth=1 takes one reflection)"
                   : "light that has been reflected is asked for (quadrature,maxdepth=0 takes what comes straight from lights)";
    const struct sr_lights *lights = sr_scene_lights(m->job->scene);
    for (uint32_t i = 0; i < lights->count; ++i) {
        struct sr_light light = lights->lights[i];
        if (light.model == &sr_light_portal)
            return "the sky shines through a portal, whose edges no rule knows";
        if (light.model->is_infinite && !light.model->is_delta &&
            ((const struct sr_light_common *)light.self)->texels.width)
            return "the sky is an image, whose small bright parts no rule would be sure to meet";
    }
    return NULL;
}

static sr_status refuse(const char *why, struct sr_error *error)
{
    return sr_fail(error, SR_ERROR_USAGE,
                   "the estimator quadrature integrates over the directions at one point, and %s; use path", why);
}

/* One grid of wavelengths; sums: fine, coarse and bound, m->channels each. */
static sr_status integrate_range(struct job *j, struct sr_lambda_range range, struct sr_arena *scratch, double *sums,
                                 struct sr_measurement *out, struct sr_error *error)
{
    uint32_t channels = j->m->channels, intervals = 2 * (uint32_t)fmax(4, ceil((double)(range.hi - range.lo) / 2));
    j->range = range;
    j->points = intervals + 1;
    j->step = ((double)range.hi - (double)range.lo) / intervals;
    uint32_t count = (j->points + SR_LAMBDA_COUNT - 1) / SR_LAMBDA_COUNT;
    j->groups = sr_arena_alloc(scratch, count * sizeof *j->groups);
    if (!j->groups)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to measure");
    for (uint32_t i = 0; i < count; ++i)
        j->groups[i] = (struct group){.why_not = NULL};
    sr_parallel_for(j->m->job->threads > 0 ? j->m->job->threads : sr_thread_count(), count, integrate_group, j);
    if (measure_is_cancelled(j->m->job))
        return SR_CANCELLED;
    for (uint32_t i = 0; i < count; ++i)
        if (j->groups[i].why_not)
            return refuse(j->groups[i].why_not, error);
    for (uint32_t c = 0; c < 3 * channels; ++c)
        sums[c] = 0;
    if (!sum_groups(j, count, sums, sums + channels, sums + 2 * channels, &out->samples))
        ++out->dropped;
    for (uint32_t c = 0; c < channels; ++c)
        sums[2 * channels + c] += fabs(sums[c] - sums[channels + c]);
    return SR_OK;
}

sr_status measure_by_quadrature(const struct measuring *m, struct sr_measurement *out, struct sr_error *error)
{
    struct job j = {.m = m, .settings = *(const struct sr_quadrature *)m->job->integrator.self};
    const char *why_not = refusal(m, j.settings.max_depth, &j.at, &j.is_ray);
    if (why_not)
        return refuse(why_not, error);
    double start_s = sr_clock_s();
    struct sr_arena scratch = {0};
    double *sums = sr_arena_alloc(&scratch, 3 * (size_t)m->channels * sizeof *sums),
           *bound = sums + 2 * (size_t)m->channels;
    sr_status status = sums ? integrate_range(&j, m->job->lambda, &scratch, sums, out, error)
                            : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to measure");
    if (status == SR_OK) {
        for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
            set(&out->value[i], sums[i], bound[i]);
        if (m->settings->with_colour)
            set_colours((double[]){sums[MEASURE_X], sums[SR_PHOTOPIC], sums[MEASURE_Z]},
                        (double[]){bound[MEASURE_X], bound[SR_PHOTOPIC], bound[MEASURE_Z]}, out);
    }
    const struct sr_quantity *q = &out->value[m->settings->system];
    double share = status == SR_OK ? bound[m->settings->system] / fabs(q->value) : 0;
    if (status == SR_OK &&
        m->settings->spectrometer.count) { // whose bins may reach beyond what all else is summed over
        status = integrate_range(&j, m->lambda, &scratch, sums, out, error);
        for (uint32_t k = 0; status == SR_OK && k < m->settings->spectrometer.count; ++k)
            set(&out->spectrum[k], sums[MEASURE_BINS + k], bound[MEASURE_BINS + k]);
    }
    sr_arena_free(&scratch);
    out->elapsed_s = sr_clock_s() - start_s;
    out->is_complete = status == SR_OK;
    if (status != SR_OK)
        return status;
    out->hits = q->value != 0 ? out->samples : 0;
    out->is_on_target = m->settings->error == 0 || sr_quantity_expanded(q, 0.95) <= m->settings->error * fabs(q->value);
    if (out->hits == 0)
        snprintf(out->remarks[out->remark_count++], sizeof out->remarks[0], "no node of the cubature has found light");
    else if (share > 10 * (double)j.settings.tolerance)
        snprintf(
            out->remarks[out->remark_count++], sizeof out->remarks[0],
            "the bound of the error is %.1g of the reading where %.1g was aimed at: the integrand has edges, or wavelengths between which light changes",
            share, (double)j.settings.tolerance);
    if (out->dropped)
        snprintf(out->remarks[out->remark_count++], sizeof out->remarks[0],
                 "some values were not finite and count as nothing");
    return SR_OK;
}
