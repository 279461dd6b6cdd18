/* SPDX-License-Identifier: MIT */
/* A path on its way from the sensor, one surface per turn, for estimators that differ from path.c by how a direction is
 * drawn or by who lives on. path.c takes the same steps in fewer instructions. */
#ifndef SR_INTEGRATOR_WAY_H
#define SR_INTEGRATOR_WAY_H

#include "integrator/path.h"
#include "integrator/shade.h"
#include "integrator/vertices.h"

struct sr_way {
    const struct sr_scene *scene;
    const struct sr_sampler *sampler;
    struct sr_wavelengths *w;
    struct sr_hit *first;
    struct sr_worker *worker;
    sr_spectrum L, beta; // brought so far [W m^-2 sr^-1 nm^-1], and what further light is multiplied by [1]
    struct sr_ray ray;
    float outside;     // beta of light from outside the scene, over beta [1]
    float pdf;         // that chose the ray [1/sr]; infinite: no light sampling could compete
    float eta_scale;   // what refraction has made of beta, and will undo [1]
    bool is_scattered; // by more than mirrors and clear glass
    int bounce, passed;
    struct sr_cone cone;
    struct sr_point from; // where it was scattered last
    // where it is
    sr_u4 u_light, u_bsdf;
    struct sr_hit x;
    struct sr_bsdf bsdf;
    struct sr_frame frame;
    sr_vec3 wo;
};

static inline void sr_way_begin(struct sr_way *p, const struct sr_scene *scene, const struct sr_path_start *start,
                                const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                                struct sr_worker *worker)
{
    p->scene = scene, p->sampler = sampler, p->w = w, p->first = first, p->worker = worker;
    p->L = SR_BLACK, p->beta = SR_ONE;
    p->ray = start->ray;
    p->pdf = INFINITY, p->eta_scale = p->outside = 1;
    p->is_scattered = false;
    p->bounce = p->passed = 0;
    p->cone = sr_cone_of(start, sr_scene_has_footprints(scene));
    if (start->receiver) {
        p->from = *start->receiver;
        p->pdf = start->pdf;
    }
}

/* Light that reaches the path at once where the ray meets x, or nothing (NULL). */
static inline sr_spectrum sr_way_meet(const struct sr_way *p, const struct sr_hit *x)
{
    struct sr_path_start now = {.ray = p->ray, .receiver = isinf(p->pdf) ? NULL : &p->from, .pdf = p->pdf};
    return p->beta * sr_met_at_once(p->scene, &now, x, p->ray.d, p->w);
}

enum sr_arrival { SR_ARRIVAL_END, SR_ARRIVAL_NOTHING, SR_ARRIVAL_SURFACE };

/* Goes to what the ray meets. met: light from there, weighed, which L has gained; counts: it is this path's to find. */
static inline enum sr_arrival sr_way_arrive(struct sr_way *p, int max_depth, bool counts, sr_spectrum *met)
{
    uint32_t group = SR_USE_BOUNCE + 2 * (uint32_t)p->bounce;
    sr_sample8(p->sampler, group, &p->u_light, &p->u_bsdf);
    struct sr_hit *x = &p->x;
    bool is_first = p->bounce == 0;
    bool is_hit = is_first && (p->first || p->cone.is_wanted) ? sr_trace(p->scene, &p->ray, x, p->worker)
                                                              : sr_trace_bare(p->scene, &p->ray, x, p->worker);
    if (is_first && p->first)
        *p->first = is_hit ? *x : (struct sr_hit){.t = INFINITY};
    *met = SR_BLACK;
    if (counts && (!is_hit || x->light != SR_NO_LIGHT)) {
        *met = is_hit ? sr_way_meet(p, x) : p->outside * sr_way_meet(p, NULL);
        p->L += *met;
    }
    if (!is_hit || (x->material && p->bounce == max_depth))
        return SR_ARRIVAL_END;
    sr_cone_meet(&p->cone, x, is_first, p->is_scattered, p->first);
    if (!sr_shade_plain(x, p->ray.d, p->u_bsdf[3], sr_shade_seed(p->sampler, group), p->w, &p->bsdf, &p->frame))
        return sr_pass_by(x, &p->ray, &p->passed) ? SR_ARRIVAL_NOTHING : SR_ARRIVAL_END;
    p->worker->vertices += 1;
    p->wo = sr_to_local(&p->frame, sr_neg(p->ray.d));
    return p->wo.z != 0 ? SR_ARRIVAL_SURFACE : SR_ARRIVAL_END;
}

/* Whether lights are sampled here. */
static inline bool sr_way_is_open(const struct sr_way *p)
{
    return sr_bsdf_lobes(&p->bsdf) & (SR_LOBE_DIFFUSE | SR_LOBE_GLOSSY);
}

/* Light straight from a light; false: none. */
static inline bool sr_way_direct(const struct sr_way *p, struct sr_light_sample *l, sr_spectrum *L)
{
    return sr_path_direct(sr_scene_lights(p->scene), &p->x.point, &p->frame, &p->bsdf, p->wo, p->u_light, p->w, l, L);
}

/* Goes on as s says, which was drawn with that density; beta is the caller's. */
static inline void sr_way_leave(struct sr_way *p, const struct sr_bsdf_sample *s, float pdf)
{
    bool is_specular = s->lobe & SR_LOBE_SPECULAR;
    p->pdf = is_specular ? INFINITY : pdf;
    if (s->lobe & SR_LOBE_TRANSMISSION)
        p->eta_scale *= s->eta * s->eta;
    p->is_scattered |= !is_specular;
    p->from = p->x.point;
    p->ray = sr_leave(&p->x.point, sr_to_world(&p->frame, s->wi));
    p->bounce += 1;
}

/* Gains light straight from a light, which is weighed against the BSDF's directions. */
static inline void sr_way_gain_direct(struct sr_way *p)
{
    struct sr_light_sample l;
    sr_spectrum L;
    if (sr_way_is_open(p) && sr_way_direct(p, &l, &L) && sr_unoccluded(p->scene, &p->x.point, &l, p->worker))
        p->L += p->beta * L;
}

/* Goes on as the BSDF says; false: the path ends. */
static inline bool sr_way_scatter(struct sr_way *p)
{
    struct sr_bsdf_sample s;
    if (!sr_bsdf_sample(&p->bsdf, p->wo, p->u_bsdf[2], (sr_vec2){p->u_bsdf[0], p->u_bsdf[1]}, SR_RADIANCE, &s))
        return false;
    p->beta *= s.f * (sr_abs_cos_theta(s.wi) / s.pdf);
    if (!(sr_spectrum_max(p->beta) > 0))
        return false;
    sr_way_leave(p, &s, s.pdf_is_proportional ? sr_bsdf_pdf(&p->bsdf, p->wo, s.wi, SR_RADIANCE) : s.pdf);
    return true;
}

/* A path that carries little ends by lot, and those that survive carry its share: what of all they stand for [1]. 0: it
 * ends. There is no lot over light from outside the scene, as in path.c; counts: it is this path's to find. */
static inline float sr_way_lot(struct sr_way *p, float carried, bool counts)
{
    carried *= p->eta_scale;
    p->outside = 1;
    if (!(carried < 1) || p->bounce <= 1)
        return 1;
    float survive = sr_survival(carried);
    bool has_outside = sr_scene_lights(p->scene)->infinite_count > 0;
    if (p->u_light[3] < survive) {
        p->outside = has_outside ? survive : 1;
        return 1 / survive;
    }
    if (counts && has_outside && sr_sees_outside(p->scene, &p->from, p->ray.d, p->worker))
        p->L += sr_way_meet(p, NULL);
    return 0;
}

#endif
