/* SPDX-License-Identifier: MIT */
/* steradian image --false-colour: luminance, illuminance or any one channel in colours, with a legend in its unit. */
#ifndef SR_TOOLS_IMAGE_FALSE_H
#define SR_TOOLS_IMAGE_FALSE_H

#include "command.h"

struct false_colour {
    bool has_scale, is_log, has_contours;
    double scale[2]; // [unit of the channel]
    const char *title;
};

/* Writes a .png or .svg of the picture's luminance, or of its only channel. */
sr_status image_write_false_colour(const char *path, const struct sr_image *image, const struct false_colour *how,
                                   struct sr_error *error);

#endif
