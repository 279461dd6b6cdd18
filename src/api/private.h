/* SPDX-License-Identifier: MIT */
/* What the public functions share. */
#ifndef SR_API_PRIVATE_H
#define SR_API_PRIVATE_H

#include "import/import.h"
#include "render/render.h"

struct sr_world {
    struct sr_import_result import;
};

struct sr_picture {
    struct sr_image *image; // of floats
};

/* The error's sentence into the caller's buffer; gives its status. */
sr_status api_tell(const struct sr_error *error, char *text, size_t size);
/* Takes the image. */
sr_status api_wrap_image(struct sr_image *image, struct sr_picture **picture, struct sr_error *error);

/* What the caller says of threads and wavelengths [nm], each 0 for what the job has: 0 <= threads, and
 * 100 <= min < max <= 20000. */
sr_status api_settle(struct sr_render_job *job, int threads, float lambda_min_nm, float lambda_max_nm,
                     struct sr_error *error);

#endif
