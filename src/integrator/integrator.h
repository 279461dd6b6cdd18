/* SPDX-License-Identifier: MIT */
/* The estimators of the rendering equation: one file each. */
#ifndef SR_INTEGRATOR_INTEGRATOR_H
#define SR_INTEGRATOR_INTEGRATOR_H

#include "film/film.h"
#include "scene/scene.h"

/* What one thread owns while it renders. */
struct sr_worker {
    uint64_t rays, shadow_rays, paths, vertices; // counted, never shared
    struct sr_ray_log *log;                      // NULL, or where every ray is recorded for replay
};

/* The way a sample's numbers are used: group = SR_USE_CAMERA, then SR_USE_BOUNCE + 2 * bounce (light) and + 1 (bsdf). */
enum { SR_USE_CAMERA = 0, SR_USE_LENS = 1, SR_USE_BOUNCE = 2 };

struct sr_integrator_model {
    const char *name;
    const struct sr_param *params;
    size_t size;
    /* Radiance arriving along the ray, per wavelength. first: NULL, or filled with the first surface. */
    sr_spectrum (*L)(const void *self, const struct sr_scene *scene, const struct sr_ray *ray, const struct sr_sampler *sampler,
                     struct sr_wavelengths *w, struct sr_hit *first, struct sr_worker *worker);
};
extern const struct sr_integrator_model *const sr_integrator_models[]; // ends with NULL
const struct sr_integrator_model *sr_integrator_model_find(const char *name);

struct sr_integrator {
    const struct sr_integrator_model *model;
    const void *self;
};

#endif
