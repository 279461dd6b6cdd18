/* SPDX-License-Identifier: MIT */
/* Polygons into triangles. */
#ifndef SR_IMPORT_POLYGON_H
#define SR_IMPORT_POLYGON_H

#include "math/math.h"

enum { SR_POLYGON_MOST = 512 }; // corners; larger ones become fans

/* Corner k is P[corners[k * stride]]. Writes count - 2 triangles of numbers of corners, and takes its steps from
 * *budget: where it is spent, or no ear is found (a polygon that crosses itself), the rest is a fan. Returns false for
 * a fan that was not meant. */
bool sr_polygon_triangulate(const sr_vec3 *P, const int32_t *corners, uint32_t stride, uint32_t count, int64_t *budget,
                            uint32_t *triangles);

#endif
