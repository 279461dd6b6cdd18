/* SPDX-License-Identifier: MIT */
/* Transforms of the description into the space in which the scene is computed.
 *
 * Coordinates are floats: at a distance of a million sizes nothing is left of what stands there. So the middle of a
 * scene that is far away becomes the origin o [m], and what leads into the world, M, becomes
 *
 *     T(-o) M    in double, rounded once to float.
 *
 * A scene near the origin stays where it is: o = 0. */
#include "import/pbrt/build.h"

static struct sr_transform placed(const struct sr_pbrt_build *b, const struct sr_matrix *m, enum sr_pbrt_place place)
{
    struct sr_matrix a = place == SR_PBRT_FROM_WORLD ? sr_matrix_invert(m) : *m;
    const double *o = b->result->origin;
    for (int i = 0; i < 3 && place != SR_PBRT_TO_OBJECT; ++i)
        for (int j = 0; j < 4 && o[i] != 0; ++j)
            a.m[i][j] -= o[i] * a.m[3][j];
    return sr_matrix_to_transform(&a);
}

struct sr_transform sr_pbrt_transform_of(const struct sr_pbrt_build *b, uint32_t index, enum sr_pbrt_place place)
{
    return placed(b, &SR_PBRT_AT(b->d->transforms, struct sr_pbrt_transform, index)->start, place);
}

struct sr_transform sr_pbrt_transform_at_end(const struct sr_pbrt_build *b, uint32_t index, enum sr_pbrt_place place)
{
    return placed(b, &SR_PBRT_AT(b->d->transforms, struct sr_pbrt_transform, index)->end, place);
}
