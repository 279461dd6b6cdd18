/* SPDX-License-Identifier: MIT */
/* The list of media, and what they share: drawing from Henyey & Greenstein's phase function. */
#include "medium/medium.h"

#include <string.h>

const struct sr_medium_model *const sr_medium_models[] = {NULL};

const struct sr_medium_model *sr_medium_model_find(const char *name)
{
    for (int i = 0; sr_medium_models[i]; ++i)
        if (strcmp(sr_medium_models[i]->name, name) == 0)
            return sr_medium_models[i];
    return NULL;
}

float sr_phase_hg_sample(sr_vec3 d, float g, sr_vec2 u, sr_vec3 *out)
{
    float cos_theta;
    if (fabsf(g) < 1e-3f) { // the inversion cancels: 1 - 2 u + its first order in g
        float even = 1 - 2 * u.x;
        cos_theta = -even + 1.5f * g * (1 - even * even);
    } else {
        float q = (1 - g * g) / (1 - g + 2 * g * u.x);
        cos_theta = (1 + g * g - q * q) / (2 * g);
    }
    cos_theta = sr_clamp(cos_theta, -1, 1);
    float sin_theta = sqrtf(sr_max(0, 1 - cos_theta * cos_theta)), s, c;
    sr_sin_cos_turn(u.y, &s, &c);
    struct sr_frame frame = sr_frame_from_z(d);
    *out = sr_to_world(&frame, (sr_vec3){sin_theta * c, sin_theta * s, cos_theta});
    return sr_phase_hg(cos_theta, g);
}
