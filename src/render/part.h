/* SPDX-License-Identifier: MIT */
/* For the files of a part of a picture: its sums by nodes of the samples' trees, and how parts become one. */
#ifndef SR_RENDER_PART_H
#define SR_RENDER_PART_H

#include "render/private.h"
#include "store/store.h"

/* What a pixel has of one node, as it is kept and written: no gaps, little-endian. */
struct part_colour {
    double rgb[3];
    float largest;
    uint32_t dropped;
};
struct part_first {
    double square[3];
    float albedo[3], n[3], ns[3], p[3], depth, uv[2], dzdx, dzdy, rgb[3];
    uint32_t material, object, hits, samples_seen;
};
_Static_assert(sizeof(struct part_colour) == 32 && sizeof(struct part_first) == 120, "written as they stand");

/* Samples begin <= i < begin + count of a block, counted from the block's begin: a node of its tree, or all of it. */
struct part_node {
    uint32_t block, begin, count;
    struct part_colour *colours; // of each pixel
    struct part_first *firsts;   // NULL: without auxiliary channels
    double *buckets;             // [pixel][bucket]; NULL: none
};

struct sr_render_part {
    struct sr_film *film; // its splats, and the picture once the part has become one
    uint32_t spp, replicates, blocks;
    struct part_node *nodes; // by block and begin; they do not overlap
    size_t node_count;
    struct sr_render_report report;
    char *identity, *about; // NULL: it has not been read
};

size_t sr_part_pixels(const struct sr_render_part *part);
/* Samples of a block. */
uint32_t sr_part_block_size(const struct sr_render_part *part, uint32_t block);
/* Memory of a node's sums, all zero. */
bool sr_part_node_alloc(const struct sr_render_part *part, struct part_node *node);
void sr_part_node_free(struct part_node *node);
/* Whether it is a node that a part may have. */
bool sr_part_node_is_valid(const struct sr_render_part *part, const struct part_node *node);
sr_status sr_part_no_memory(struct sr_error *error);

#endif
