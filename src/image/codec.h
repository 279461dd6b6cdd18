/* SPDX-License-Identifier: MIT */
/* What a file format promises to the rest of this room, and the help that all formats share. Not for other rooms. */
#ifndef SR_IMAGE_CODEC_H
#define SR_IMAGE_CODEC_H

#include "image/image.h"

/* The bytes of a file. */
struct sr_image_source {
    const char *label; // path, for messages
    const uint8_t *data;
    size_t size;                     // [B]
    enum sr_image_encoding encoding; // what whole numbers mean
    bool is_proven;                  // all its pixels have been unpacked once
};

struct sr_image_codec {
    const char *name;
    const char *endings[4];                            // ".jpg", … ended by NULL
    bool (*is_mine)(const uint8_t *data, size_t size); // by the first bytes; NULL: the ending decides
    sr_status (*decode)(const struct sr_image_source *source, struct sr_image **image, struct sr_error *error);
    /* Appends to `out` (bytes). NULL: this format is only read. */
    sr_status (*encode)(const struct sr_image *image, const struct sr_image_write_options *options,
                        struct sr_array *out, struct sr_error *error);
};

extern const struct sr_image_codec sr_image_codec_exr, sr_image_codec_png, sr_image_codec_jpeg, sr_image_codec_tga,
    sr_image_codec_pfm, sr_image_codec_hdr, sr_image_codec_qoi;

/* Whether the pixels are more than the size of the file backs, and not yet proven: such an image has memory for one
 * row. */
bool sr_image_is_trial(const struct sr_image_source *source, const struct sr_image *image);
/* Where the row y of an image goes that sr_image_create_for has made; all rows of a trial go to the same place. */
void *sr_image_row(const struct sr_image_source *source, const struct sr_image *image, uint32_t y);
/* sr_image_create, but first refuses what the size of the file cannot back; or a trial, whose pixels are for
 * sr_image_row alone. */
sr_status sr_image_create_for(const struct sr_image_source *source, uint64_t width, uint64_t height,
                              uint32_t channel_count, const char *const *names, enum sr_image_type type,
                              struct sr_image **image, struct sr_error *error);
bool sr_image_put(struct sr_array *out, const void *bytes, size_t size);
/* Value [unit] of element i (pixel * channel_count + channel) of an image of either type. */
float sr_image_value(const struct sr_image *image, size_t i, uint32_t channel);

#endif
