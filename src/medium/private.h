/* SPDX-License-Identifier: MIT */
/* For the files of this room. */
#ifndef SR_MEDIUM_PRIVATE_H
#define SR_MEDIUM_PRIVATE_H

#include "medium/medium.h"

/* Makes Le as bright as a scene says: `scale` times luminance 1 [cd/m^2] as pbrt does, rgb times a white of luminance 1, or what
 * an absolute spectrum says. Kind NONE (dark) where nothing is left of it. */
sr_status sr_medium_set_emission(struct sr_spd *Le, const struct sr_medium_common *common, float scale, struct sr_error *error);

/* What a black body radiates whose spectrum a scene scales by its maximum; of absolute scenes Planck's law. Below 100 K: nothing. */
sr_spectrum sr_medium_blackbody(float temperature, bool is_absolute, const struct sr_wavelengths *w);

#endif
