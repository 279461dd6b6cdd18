/* SPDX-License-Identifier: MIT */
/* Where an interval cannot be trusted: nothing found, little found, one sample that outweighs all, a meter that sees
 * nothing.
 *
 * Where none of n independent samples finds light, the share of those that would is below 1 - 0.05^(1/n), about 3/n,
 * with 95 % confidence (Hanley & Lippman-Hand 1983). Times what such a sample can bring, that bounds the reading. */
#include "render/measure.h"

#include <stdio.h>

enum { LOOK_AROUND = 256, FEW_HITS = 30 };

SR_PRINTF(2, 3) static void remark(struct sr_measurement *out, const char *format, ...)
{
    if (out->remark_count == SR_MEASURE_REMARKS)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(out->remarks[out->remark_count++], sizeof out->remarks[0], format, arguments);
    va_end(arguments);
}

/* ---- what lies around ---- */

struct surroundings {
    uint32_t rays, met, near, inner; // rays that met something; within a hair's breadth; the inner side of it
    uint32_t object;                 // that all of them met; 0: several
    float nearest_m;
};

static struct surroundings look_around(const struct measuring *m)
{
    struct surroundings s = {.nearest_m = INFINITY};
    float hair = 1e-4f * sr_length(sr_box_diagonal(sr_scene_bounds(m->job->scene)));
    for (uint32_t i = 0; i < LOOK_AROUND; ++i) {
        struct sr_sampler sampler = sr_sampler_start(SR_SAMPLER_SOBOL, 1, 0, 0, 0, i);
        sr_u4 u = sr_sample4(&sampler, 0), v = sr_sample4(&sampler, 1);
        struct sr_meter_place at;
        sr_vec3 wi;
        if (!m->meter->model->place(m->meter->self, (sr_vec2){v[0], v[1]}, &at) ||
            !(m->meter->model->sample(m->meter->self, u, &wi) > 0))
            continue;
        measure_settle(m->job->scene, &at);
        struct sr_ray ray = sr_leave(&at.x, sr_to_world(&at.frame, wi));
        struct sr_hit hit;
        ++s.rays;
        if (!sr_raycast(m->job->scene, &ray, &hit))
            continue;
        s.object = s.met == 0 || s.object == hit.object ? hit.object : 0;
        ++s.met;
        s.inner += sr_dot(hit.point.n, ray.d) > 0;
        s.near += hit.t < hair;
        s.nearest_m = hit.t < s.nearest_m ? hit.t : s.nearest_m;
    }
    return s;
}

/* ---- bounds ---- */

/* The largest radiance of the scene's area lights in a system; 0: there is one, or another light, of which it is not
 * known. */
static double largest_radiance(const struct measuring *m, enum sr_system system)
{
    const struct sr_lights *lights = sr_scene_lights(m->job->scene);
    double largest = 0;
    for (uint32_t i = 0; i < lights->count; ++i) {
        if (lights->lights[i].model != &sr_light_area)
            return 0;
        const struct sr_light_emission *e = ((const struct sr_light_area *)lights->lights[i].self)->emission;
        if (e->texels.width)
            return 0;
        largest = fmax(largest,
                       sr_observer_integral(system, &e->emitted, (double)m->job->lambda.lo, (double)m->job->lambda.hi) /
                           (double)SR_KM);
    }
    return largest;
}

static void tell_nothing_found(const struct measuring *m, const struct surroundings *s, struct sr_measurement *out)
{
    const struct sr_lights *lights = sr_scene_lights(m->job->scene);
    if (lights->count == 0) {
        remark(out, "the scene has no lights");
        return;
    }
    double extent = m->meter->model->extent(m->meter->self);
    for (int i = 0; i < SR_SYSTEM_COUNT; ++i)
        out->value[i] = sr_quantity_bounded(extent * largest_radiance(m, (enum sr_system)i), (double)out->samples,
                                            out->value[i].unit);
    char text[96];
    const struct sr_quantity *q = &out->value[m->settings->system];
    sr_unit_text(q->unit, text, sizeof text);
    if (q->upper > 0)
        remark(
            out,
            "no light found in %llu samples; below %.2g %s at 95 %%, if no sample that finds light brings more than the brightest light seen from everywhere",
            (unsigned long long)out->samples, q->upper, text);
    else
        remark(
            out,
            "no light found in %llu samples: fewer than %.2g of them bring light (95 %%); what such a sample would bring is not known, so there is no bound",
            (unsigned long long)out->samples, 3.0 / (double)out->samples);
    if (s->met == s->rays && s->inner == s->rays && s->object)
        remark(
            out,
            "the meter seems to lie inside shape number %u of the scene: all of %u rays from it meet the inner side of that shape",
            s->object, s->rays);
    else if (s->met == s->rays && s->rays)
        remark(
            out,
            "every ray from the meter ends at a surface, the nearest %.3g m away: it may be shut in where no light comes",
            (double)s->nearest_m);
}

void measure_remarks(const struct measuring *m, struct sr_measurement *out)
{
    const struct sr_integrator_model *integrator = m->job->integrator.model;
    const char *blind = sr_integrator_blind(&m->job->integrator, m->job->scene);
    if (blind)
        remark(out, "%s", blind);
    if (integrator->splat && m->meter->model->is_ray && m->meter->model->is_ray(m->meter->self))
        remark(
            out,
            "paths from the lights do not meet a meter that looks along one ray: only what comes straight from a light is in the reading");
    if (out->samples == 0)
        return;
    struct surroundings s = look_around(m);
    if (out->hits == 0 && out->dropped == 0)
        tell_nothing_found(m, &s, out);
    else if (out->hits < FEW_HITS && out->hits < out->samples)
        remark(out, "only %llu of %llu samples have found light: the interval cannot be trusted",
               (unsigned long long)out->hits, (unsigned long long)out->samples);
    else if (out->largest_share > 0.1)
        remark(
            out,
            "one sample makes up %.0f %% of the reading: the interval cannot be trusted; more samples, or an estimator that finds this light better, are needed",
            100 * out->largest_share);
    if (2 * s.near > s.rays)
        remark(
            out,
            "a surface lies %.2g m in front of the meter and hides most of what it looks at: is it meant to be on the other side?",
            (double)s.nearest_m);
    if (out->dropped)
        remark(out, "%llu of %llu samples were not finite and count as nothing", (unsigned long long)out->dropped,
               (unsigned long long)out->samples);
    const struct sr_quantity *q = &out->value[m->settings->system];
    if (m->settings->error > 0 && !out->is_on_target && out->hits)
        remark(out, "the uncertainty is %.2g %% where %.2g %% was asked for: %s",
               100 * sr_quantity_expanded(q, 0.95) / fabs(q->value), 100 * m->settings->error,
               m->settings->time_s > 0 || m->settings->samples
                   ? "the limit came first, or the last round, whose size was settled before it, fell short"
                   : "the last round, whose size was settled before it, fell short; the interval holds all the same");
}
