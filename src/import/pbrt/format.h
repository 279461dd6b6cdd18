/* SPDX-License-Identifier: MIT */
/* What writes pbrt-v4 text: from pbrt files, and from descriptions of anything else. */
#ifndef SR_IMPORT_PBRT_FORMAT_H
#define SR_IMPORT_PBRT_FORMAT_H

#include "import/import.h"
#include "import/pbrt/print.h"

sr_status sr_pbrt_format(const char *path, const struct sr_convert_options *o, struct sr_print *out, struct sr_log *log,
                         struct sr_error *error);
/* The description of a file of any format. Images that lay in the file are written beside the text. */
sr_status sr_pbrt_write(const char *path, const struct sr_convert_options *o, struct sr_print *out, struct sr_log *log,
                        struct sr_error *error);
/* Whether two files lie in one folder. */
bool sr_path_same_folder(const char *a, const char *b);
/* A file's name as seen from the folder of another one; NULL: one of the folders is not there, or no memory. */
const char *sr_path_seen_from(struct sr_arena *arena, const char *from, const char *file);
/* "folder/scene-0001.ply" for "folder/scene.pbrt" */
const char *sr_convert_beside(struct sr_arena *arena, const char *out, const char *name,
                              const char *ending); // "folder/scene-name.png"
const char *sr_convert_mesh_name(struct sr_arena *arena, const char *out, uint32_t number);

#endif
