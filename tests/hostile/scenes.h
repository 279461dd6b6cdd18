/* SPDX-License-Identifier: MIT */
/* Small scenes that have to do with all readers, written into the test's folder. */
#ifndef TEST_HOSTILE_SCENES_H
#define TEST_HOSTILE_SCENES_H

#include "import/import.h"

/* The path of one of them: scene.pbrt, lens.pbrt, model.gltf, model.glb, model.obj, model.stl, model.ply. Static
 * buffer. */
const char *hostile_scene(const char *name);
/* scene.pbrt with another estimator. */
const char *hostile_estimator(const char *name, const char *parameters);
/* From a name to a picture in a file. */
sr_status hostile_render(const char *path, const char *out, struct sr_error *error);

#endif
