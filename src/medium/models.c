/* SPDX-License-Identifier: MIT */
/* The list of media, and what they share: drawing from Henyey & Greenstein's phase function. */
#include "medium/medium.h"

#include <string.h>

extern const struct sr_medium_model sr_medium_homogeneous, sr_medium_uniform_grid, sr_medium_rgb_grid, sr_medium_cloud,
    sr_medium_nanovdb;

const struct sr_medium_model *const sr_medium_models[] = {
    &sr_medium_homogeneous, &sr_medium_uniform_grid, &sr_medium_rgb_grid, &sr_medium_cloud, &sr_medium_nanovdb, NULL,
};

const struct sr_medium_model *sr_medium_model_find(const char *name)
{
    for (int i = 0; sr_medium_models[i]; ++i)
        if (strcmp(sr_medium_models[i]->name, name) == 0)
            return sr_medium_models[i];
    return NULL;
}

/* Inverted in a form that does not cancel, neither for g near 0 nor near 1: with q = (1 - g^2) / (1 - g + 2 g u) the
 * density is (1 - g^2) / (4 pi q^3), and 1 -+ cos theta are products. */
float sr_phase_hg_sample(sr_vec3 d, float g, sr_vec2 u, sr_vec3 *out)
{
    float scale = 1 / (1 - g + 2 * g * u.x), q = (1 - g) * (1 + g) * scale;
    float from_end = g > 0 ? (1 - g) * (1 - u.x) * scale * (q + 1 - g)
                           : (1 + g) * u.x * scale * (q + 1 + g); // 1 - cos theta where g > 0, else 1 + cos theta
    float sin_theta = sqrtf(sr_max(0, from_end * (2 - from_end))), s, c;
    sr_sin_cos_turn(u.y, &s, &c);
    struct sr_frame frame = sr_frame_from_z(d);
    *out = sr_to_world(&frame, (sr_vec3){sin_theta * c, sin_theta * s, g > 0 ? 1 - from_end : from_end - 1});
    return SR_INV_PI / 4 * (1 - g) * (1 + g) / (q * q * q);
}
