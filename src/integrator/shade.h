/* SPDX-License-Identifier: MIT */
/* What a ray has met: a surface that scatters, or one that only parts media, behind which the path goes on as it was.
 */
#ifndef SR_INTEGRATOR_SHADE_H
#define SR_INTEGRATOR_SHADE_H

#include "integrator/integrator.h"

enum { SR_MOST_PASSED = 1000 }; // surfaces that do not scatter, of one path

/* For random walks within a material, which hash it; group: of the vertex' numbers. */
static inline uint32_t sr_shade_seed(const struct sr_sampler *sampler, uint32_t group)
{
    return sampler->key + sampler->sample * 0x9e3779b9u + group * 0x85ebca6bu;
}

/* The BSDF and the frame at x for a ray of direction d; false: nothing scatters there. u and seed choose what materials
 * leave to chance. */
static inline bool sr_shade(struct sr_hit *x, sr_vec3 d, float u, uint32_t seed, struct sr_wavelengths *w,
                            struct sr_bsdf *bsdf, struct sr_frame *frame)
{
    bsdf->model = NULL;
    if (x->material)
        sr_material_shade(x->material, &x->point, sr_neg(d), u, seed, w, bsdf, frame);
    return bsdf->model != NULL;
}

/* The same in less time where the material is plain; the frame may be turned about its normal. */
static inline bool sr_shade_plain(struct sr_hit *x, sr_vec3 d, float u, uint32_t seed, struct sr_wavelengths *w,
                                  struct sr_bsdf *bsdf, struct sr_frame *frame)
{
    if (!SR_LIKELY(x->material && x->is_plain)) // no material looks at nothing, and is plain
        return sr_shade(x, d, u, seed, w, bsdf, frame);
    sr_material_shade_plain(x->material, x->lambert, &x->point, sr_neg(d), u, seed, w, bsdf, frame);
    return bsdf->model != NULL;
}

/* The share of paths that go on where each carries so much [1]; whoever does carries the others' share. The root, for
 * such lots are worth what they save only where little is carried, be it by dark surfaces or after many bounces: with
 * the share carried itself, dark scenes lose most of their paths early (docs/performance.md). */
static inline float sr_survival(float carried)
{
    return sr_clamp(sqrtf(carried), 0.05f, 1);
}

/* Whether nothing is between x and the outside of the scene. */
static inline bool sr_sees_outside(const struct sr_scene *scene, const struct sr_point *x, sr_vec3 wi,
                                   struct sr_worker *worker)
{
    return sr_unoccluded(scene, x, &(struct sr_light_sample){.wi = wi, .distance = INFINITY}, worker);
}

/* The ray goes on behind x; false: the path has passed enough. */
static inline bool sr_pass_by(const struct sr_hit *x, struct sr_ray *ray, int *passed)
{
    *ray = sr_leave(&x->point, ray->d);
    return ++*passed <= SR_MOST_PASSED;
}

/* The cone of a sensor ray along its path, for footprints. */
struct sr_cone {
    const struct sr_path_start *start;
    bool is_wanted;
    float spread; // [1]
    float width;  // at the path's last surface [m]
};

static inline struct sr_cone sr_cone_of(const struct sr_path_start *start, bool is_wanted)
{
    return (struct sr_cone){start, is_wanted, is_wanted ? 0.5f * (sr_length(start->dddx) + sr_length(start->dddy)) : 0,
                            0};
}

/* The footprint of the path at x; first: NULL, or the copy of its first surface. Before x is shaded. */
static inline void sr_cone_meet(struct sr_cone *c, struct sr_hit *x, bool is_first, bool is_scattered,
                                struct sr_hit *first)
{
    if (!c->is_wanted || !x->material)
        return;
    sr_path_footprint(c->start, x, is_first, is_scattered, c->spread, &c->width);
    if (is_first && first)
        first->point = x->point;
}

#endif
