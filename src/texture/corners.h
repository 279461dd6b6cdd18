/* SPDX-License-Identifier: MIT */
/* Private to this room: values that are given for each corner of each triangle of a mesh.
 *
 * The mesh tells its triangle by x->face (faceIndices 0, 1, 2, …) and the place in it by (u, v): the corners have (0,
 * 0), (1, 0) and (0, 1), so that (1 - u - v, u, v) are the barycentric coordinates. Two meshes never share such values.
 */
#ifndef SR_TEXTURE_CORNERS_H
#define SR_TEXTURE_CORNERS_H

#include "texture/texture.h"

/* The number of the first of three corners, and what each counts. */
static inline size_t corners_at(const struct sr_point *x, uint32_t triangle_count, float weight[3])
{
    float u = sr_clamp(x->uv.x, 0, 1), v = sr_clamp(x->uv.y, 0, 1 - u);
    weight[0] = 1 - u - v;
    weight[1] = u;
    weight[2] = v;
    uint32_t face = (uint32_t)x->face;
    return 3 * (size_t)(face < triangle_count ? face : 0);
}

#endif
