/* SPDX-License-Identifier: MIT */
/* What a ray has met: a surface that scatters, or one that only parts media, behind which the path goes on as it was.
 */
#ifndef SR_INTEGRATOR_SHADE_H
#define SR_INTEGRATOR_SHADE_H

#include "integrator/integrator.h"

enum { SR_MOST_PASSED = 1000 }; // surfaces that do not scatter, of one path

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

/* The ray goes on behind x; false: the path has passed enough. */
static inline bool sr_pass(const struct sr_hit *x, struct sr_ray *ray, int *passed)
{
    *ray = sr_leave(&x->point, ray->d);
    return ++*passed <= SR_MOST_PASSED;
}

#endif
