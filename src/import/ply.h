/* SPDX-License-Identifier: MIT */
/* Triangles and quads from PLY files: ascii, binary of both byte orders, packed by gzip or not. */
#ifndef SR_IMPORT_PLY_H
#define SR_IMPORT_PLY_H

#include "base/base.h"
#include "math/math.h"

struct sr_ply_mesh {
    sr_vec3 *P;            // [m] vertex_count of them, followed by 16 readable bytes
    sr_vec3 *N;            // [1] or NULL
    sr_vec2 *uv;           // [1] or NULL
    int32_t *triangles;    // three vertices each
    int32_t *quads;        // four vertices each, in order around the face
    int32_t *face_indices; // one for each triangle, then one for each quad; or NULL
    uint32_t vertex_count, triangle_count, quad_count;
    uint32_t fan_count;     // polygons of more than four corners: each became a fan of triangles
    uint32_t dropped_count; // faces of fewer than three corners: left out
    struct sr_arena memory; // of all the arrays
};

/* Every claim of the file is checked against its size before memory is asked for. */
sr_status sr_ply_read(const char *path, struct sr_ply_mesh *mesh, struct sr_error *error);
/* From memory, not packed; data[size] must be NUL. label stands for the path in messages. */
sr_status sr_ply_decode(const char *label, const char *data, size_t size, struct sr_ply_mesh *mesh,
                        struct sr_error *error);
void sr_ply_free(struct sr_ply_mesh *mesh);

#endif
