/* SPDX-License-Identifier: MIT */
/* What reading and writing of OpenEXR files share. */
#ifndef SR_IMAGE_EXR_H
#define SR_IMAGE_EXR_H

#include "image/codec.h"

#include <openexr.h>

/* A file that is read or written, by one thread. */
struct sr_exr_job {
    const struct sr_image_source *source;
    struct sr_array *out;
    char message[256];  // the library's first complaint
    bool has_no_memory; // which the library may call by another name
};
/* Where this thread's complaints go: NULL, nowhere. Returns where they went before. */
struct sr_exr_job *sr_exr_enter(struct sr_exr_job *job);
/* Enters it. */
exr_context_initializer_t sr_exr_begin(struct sr_exr_job *job);
/* sr_alloc, which remembers that there was no memory. */
void *sr_exr_alloc(size_t size);

/* exr_write.c */
sr_status sr_exr_encode(const struct sr_image *image, const struct sr_image_write_options *options,
                        struct sr_array *out, struct sr_error *error);

#endif
