/* SPDX-License-Identifier: MIT */
/* Materials and textures that pbrt does not know, as the nearest that it knows. */
#ifndef SR_IMPORT_PBRT_CLOSEST_H
#define SR_IMPORT_PBRT_CLOSEST_H

#include "import/pbrt/format.h"

/* Changes the material; textures that it needs are printed first. What is lost is told in the log. */
sr_status sr_pbrt_closest_material(struct sr_pbrt_description *d, struct sr_pbrt_entity *e, struct sr_print *out,
                                   struct sr_error *error);
/* Changes the texture; is_made: its image was written beside out, and its name is told from there. */
sr_status sr_pbrt_closest_texture(struct sr_pbrt_description *d, struct sr_arena *arena, const char *main_path,
                                  const char *out, struct sr_pbrt_texture *t, bool *is_made, struct sr_error *error);
/* Normals by three textures become a normal map: before the textures change. */
sr_status sr_pbrt_closest_normals(struct sr_pbrt_description *d, struct sr_pbrt_entity *e, struct sr_error *error);
bool sr_pbrt_is_normal_texture(const struct sr_pbrt_description *d, const char *name);

#endif
