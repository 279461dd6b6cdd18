/* SPDX-License-Identifier: MIT */
/* Path tracing and volumetric path tracing take the same parameters, and without media they are the same. */
#ifndef SR_INTEGRATOR_PATH_H
#define SR_INTEGRATOR_PATH_H

#include "integrator/integrator.h"

struct sr_path {
    int32_t max_depth;     // most scatterings of a path
    int32_t light_sampler; // enum sr_light_choice; the scene was finished with it
    bool regularize;
};
extern const struct sr_param sr_path_params[];
extern const struct sr_integrator_model sr_integrator_path, sr_integrator_volpath;

#endif
