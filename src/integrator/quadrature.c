/* SPDX-License-Identifier: MIT */
/* The name and the parameters of the reference without chance. Meters are read by render/quadrature.c, which knows
 * their responses; along a single ray of a picture there is nothing to integrate by it. */
#include "integrator/integrator.h"

static const struct sr_param params[] = {
    {SR_PARAM_INT, "maxdepth", "1", 0, 1e6, 0, offsetof(struct sr_quadrature, max_depth),
     "0: light straight from lights; 1: reflected once, for rays"},
    {SR_PARAM_FLOAT, "tolerance", "1", 1e-7, 0.1, 2e-6, offsetof(struct sr_quadrature, tolerance),
     "relative error to aim at"},
    {.name = NULL},
};

static sr_spectrum no_number(const void *self, const struct sr_scene *scene, const struct sr_path_start *start,
                             const struct sr_sampler *sampler, struct sr_wavelengths *w, struct sr_hit *first,
                             struct sr_worker *worker)
{
    (void)self, (void)scene, (void)start, (void)sampler, (void)w, (void)worker;
    if (first)
        *first = (struct sr_hit){.t = INFINITY};
    return SR_BLACK + NAN;
}

static const char *blind(const void *self, const struct sr_scene *scene)
{
    (void)self;
    return sr_scene_moves(scene) ? "what moves stands as when the shutter opens: cubature does not integrate over time"
                                 : NULL;
}

const struct sr_integrator_model sr_integrator_quadrature = {
    .blind = blind,
    .name = "quadrature",
    .text = "meters at a point by adaptive cubature, without chance",
    .params = params,
    .size = sizeof(struct sr_quadrature),
    .L = no_number,
};
