/* SPDX-License-Identifier: MIT */
/* Any file that we read, as a description: the format is known by the ending of its name. */
#ifndef SR_IMPORT_DESCRIBE_H
#define SR_IMPORT_DESCRIBE_H

#include "import/import.h"
#include "import/pbrt/description.h"

/* One format: one row in describe.c. read: as sr_pbrt_read, with what the caller wants of the file. */
struct sr_import_format {
    const char *ending; // ".gltf"
    sr_status (*read)(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error);
};
/* NULL: pbrt's format, which is what all other names are taken for. */
const struct sr_import_format *sr_import_format_of(const char *path);

/* data must outlive what is made of the description. The description is valid (and must be freed) also after a failure.
 */
sr_status sr_describe(const char *path, const struct sr_import_options *options, struct sr_arena *data,
                      struct sr_log *log, struct sr_pbrt_description *out, struct sr_error *error);

#endif
