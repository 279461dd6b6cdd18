/* SPDX-License-Identifier: MIT */
/* Materials that pbrt does not know, as the nearest that it knows. */
#ifndef SR_IMPORT_PBRT_CLOSEST_H
#define SR_IMPORT_PBRT_CLOSEST_H

#include "import/pbrt/print.h"

/* Changes the material; textures that it needs are printed first. What is lost is told in the log. */
sr_status sr_pbrt_closest_material(struct sr_pbrt_description *d, struct sr_pbrt_entity *e, struct sr_print *out, struct sr_error *error);

#endif
