/* SPDX-License-Identifier: MIT */
/* A camera and a sky for files that have none. */
#ifndef SR_IMPORT_FRAMING_H
#define SR_IMPORT_FRAMING_H

#include "import/import.h"
#include "import/pbrt/compose.h"

/* Film, and a camera in front, above and to the right, as near as it can see all of the box. up: y or z. Returns the
 * direction where a bright region of the sky does well. */
sr_vec3 sr_frame_camera(struct sr_compose *c, const struct sr_import_options *o, struct sr_box bounds, sr_vec3 up);
/* A grey sky of 0.25 to 0.75 cd/m^2, brightest above, with a region of 3 cd/m^2 around key. */
void sr_frame_sky(struct sr_compose *c, sr_vec3 key, sr_vec3 up);

#endif
