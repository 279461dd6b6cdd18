/* SPDX-License-Identifier: MIT */
/* Pictures: pixels with named channels and units. */
#ifndef STERADIAN_PICTURE_H
#define STERADIAN_PICTURE_H

#include "base.h"

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Opaque; whoever gets one destroys it. */
struct sr_picture;

SR_API uint32_t sr_picture_width(const struct sr_picture *picture);
SR_API uint32_t sr_picture_height(const struct sr_picture *picture);
SR_API uint32_t sr_picture_channel_count(const struct sr_picture *picture);
/* "R", "G", "B", "SE.R" (standard error of R), "depth", …; NULL past the end. */
SR_API const char *sr_picture_channel_name(const struct sr_picture *picture, uint32_t channel);
/* "cd/m^2", "m", "1", …; empty where none is known. */
SR_API const char *sr_picture_channel_unit(const struct sr_picture *picture, uint32_t channel);
/* Value of a channel at (x, y), the top row first, in the channel's unit. NaN outside the picture. */
SR_API float sr_picture_value(const struct sr_picture *picture, uint32_t x, uint32_t y, uint32_t channel);
/* All values: ((y * width) + x) * channel_count + channel, valid as long as the picture. */
SR_API const float *sr_picture_values(const struct sr_picture *picture);

/* Reads .exr, .png, .jpg, .tga, .qoi, .pfm, .hdr as linear floats. On failure *picture is NULL and error (if not NULL,
 * of size error_size) holds one sentence. */
SR_API sr_status sr_picture_read(const char *path, struct sr_picture **picture, char *error, size_t error_size);
/* Writes .exr, .pfm, .hdr, or .png with an exposure chosen from the picture; beside the name, then renamed. */
SR_API sr_status sr_picture_write(const struct sr_picture *picture, const char *path, char *error, size_t error_size);
SR_API void sr_picture_destroy(struct sr_picture *picture); /* NULL is fine */

#ifdef __cplusplus
}
#endif

#endif
