/* SPDX-License-Identifier: MIT */
/* Transforms that differ at the shutter's two ends, as motions over the share of the shutter interval.
 *
 *     share = (t - shutteropen) / (shutterclose - shutteropen)
 *
 * TransformTimes says at what times t [s] the two transforms hold; in between pbrt interpolates what they are made of.
 */
#include "import/pbrt/build.h"

#include <string.h>

bool sr_pbrt_moves(const struct sr_pbrt_build *b, uint32_t transform)
{
    const struct sr_pbrt_transform *t = SR_PBRT_AT(b->d->transforms, struct sr_pbrt_transform, transform);
    return memcmp(t->start.m, t->end.m, sizeof t->start.m) != 0;
}

sr_status sr_pbrt_motion(struct sr_pbrt_build *b, uint32_t transform, enum sr_pbrt_place place, const char *what,
                         struct sr_location where, const struct sr_motion **out)
{
    struct sr_motion *m = sr_arena_alloc(b->arena, sizeof *m);
    if (!m)
        return sr_pbrt_no_memory(b);
    struct sr_transform start = sr_pbrt_transform_of(b, transform, place),
                        end = sr_pbrt_transform_at_end(b, transform, place);
    float open = b->shutter_open, length = b->shutter_close - open;
    float t0 = b->d->transform_start_time, t1 = b->d->transform_end_time;
    // a shutter that opens for no time sees one moment
    float begin = length > 0 ? (t0 - open) / length : t0 - open, finish = length > 0 ? (t1 - open) / length : t1 - open;
    if (!sr_motion_make(&start, &end, begin, finish, m))
        return sr_pbrt_fail(
            b->d, where, b->error, SR_ERROR_INPUT,
            "this %s moves between two transforms of which one mirrors and the other does not, or which are not affine: expected a "
            "way between them",
            what);
    if (!(length > 0)) {
        struct sr_transform now;
        sr_motion_at(m, 0, &now);
        sr_motion_make(&now, &now, 0, 1, m);
    }
    *out = m;
    return SR_OK;
}
