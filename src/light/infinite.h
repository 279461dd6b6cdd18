/* SPDX-License-Identifier: MIT */
/* What the sky and the sky through a window share. Not for other rooms. */
#ifndef SR_LIGHT_INFINITE_H
#define SR_LIGHT_INFINITE_H

#include "light/pixels.h"

/* What a texel radiates, scale times sigmoid times white, and how densely it is drawn: in one place, for one look-up.
 */
struct cell {
    struct sr_sigmoid sigmoid;
    float scale;   // [1]
    float density; // [1] over the square
};

struct sr_infinite {
    struct sr_light_common common;
    struct sr_spd L;
    float scale, illuminance; // [1] [lx]
    const char *filename;
    struct sr_slice portal; // sr_vec3: corners, for sr_light_portal
    // derived
    float factor;                 // of the texels' illuminant spectra
    const struct sr_table *white; // of those
    const struct cell *cells;     // one a texel; NULL: too many
    struct sr_piecewise2 density; // over the square
    struct sr_light_turn turn;
    bool is_rotation;        // or a mirror: solid angles stay
    float luminance, choice; // [cd/m^2] mean over the sphere
    sr_vec3 centre;          // of the scene's sphere [m]
    float radius;            // [m]
};

extern const struct sr_param sr_infinite_params[];
sr_status sr_infinite_prepare(void *self, struct sr_arena *arena, struct sr_error *error);
sr_spectrum sr_infinite_Le(const struct sr_infinite *m, sr_vec3 wi,
                           const struct sr_wavelengths *w);              // that arrives from wi
float sr_infinite_blurred_grey(const struct sr_infinite *m, sr_vec3 wi); // of the image, between the texels' centres

static inline bool sr_infinite_is_image(const struct sr_infinite *m)
{
    return m->common.texels.width > 0;
}

#endif
