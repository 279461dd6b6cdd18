/* SPDX-License-Identifier: MIT */
/* For the files of this room: a grid most of which is empty. */
#ifndef SR_MEDIUM_SPARSE_H
#define SR_MEDIUM_SPARSE_H

#include "medium/medium.h"

/* Values at whole numbers of index space, in leaves of 8^3, 16^3 of them in a block; blocks lie in a table. Wherever a
 * number of a leaf or a block may stand, ~n stands for the constant tiles[n]. */
struct sr_sparse_block {
    int32_t leaves[16 * 16 * 16]; // z fastest
};
struct sr_sparse_leaf {
    float values[8 * 8 * 8]; // z fastest
};
struct sr_sparse {
    double to_index[3][4];     // from the medium's space
    double lo[3], hi[3];       // the box around what is there, in the medium's space [m]
    int32_t least[3], most[3]; // and in index space, both included; outside all is 0
    int32_t first[3], n[3];    // of the table, in blocks
    const int32_t *table;      // of blocks, x fastest
    const struct sr_sparse_block *blocks;
    const struct sr_sparse_leaf *leaves;
    const float *tiles;
    float background; // outside of the table, within the box
};

/* The grid of that name of a NanoVDB file. When there is none: with `must` an error that tells what there is, else a
 * grid without table. Values below 0 become 0 where `no_negative`. */
sr_status sr_sparse_read(const char *path, const char *name, bool must, bool no_negative, struct sr_sparse *out,
                         struct sr_arena *arena, struct sr_error *error);
/* The same from memory. */
sr_status sr_sparse_parse(const char *path, const uint8_t *data, size_t size, const char *name, bool must,
                          bool no_negative, struct sr_sparse *out, struct sr_arena *arena, struct sr_error *error);

float sr_sparse_at(const struct sr_sparse *g, sr_vec3 index); // linear between the values
/* The largest value at whole numbers between two corners of index space, both included. */
float sr_sparse_largest(const struct sr_sparse *g, const double lo[3], const double hi[3]);

#endif
