/* SPDX-License-Identifier: MIT */
/* What a region of a picture measures. */
#ifndef SR_TOOLS_IMAGE_REGION_H
#define SR_TOOLS_IMAGE_REGION_H

#include "command.h"

struct image_region {
    uint32_t x0, y0, x1, y1; // [pixel] x0 <= x < x1
};

/* Mean, least and most of luminance and colour with their uncertainty, printed or as JSON; the exit code. Several
 * pictures are replicates of one another. */
int image_print_region(const char *const *files, int count, const struct image_region *region, bool as_json);

#endif
