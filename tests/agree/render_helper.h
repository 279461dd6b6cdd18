/* SPDX-License-Identifier: MIT */
/* Scene files rendered inside a test. */
#ifndef SR_TESTS_AGREE_RENDER_HELPER_H
#define SR_TESTS_AGREE_RENDER_HELPER_H

#include "test.h"

#include "import/import.h"
#include "render/render.h"

/* Imports the scene or fails the test; text of an error goes to *error_text where it is not NULL, and false comes back.
 */
bool import_scene(const char *path, const struct sr_import_options *options, struct sr_import_result *scene,
                  struct sr_error *error);
/* A job with the scene's own settings. */
/* The film, or a failed test. */
struct sr_film *render_or_fail(const struct sr_render_job *job, struct sr_render_report *report);
/* A scene text as a file in the test's folder; static buffer. */
const char *scene_file(const char *name, const char *text);

#endif
