/* SPDX-License-Identifier: MIT */
/* For the files of this room: the tree of lights. */
#ifndef SR_LIGHT_TREE_H
#define SR_LIGHT_TREE_H

#include "light/light.h"

#define SR_LIGHT_TREE_WIDTH 8

/* Up to eight children: each a light or a node. 256 bytes, four cache lines. Bounds of a child are a sphere around its
 * box and a cone around its normals, rounded outward. */
struct sr_light_tree_node {
    sr_vec3 origin;      // [m] centres are origin + step * centre
    float step;          // [m]
    struct {             // pairs, so that a load of eight of them is two shifts away from either
        uint16_t centre; // [step]
        int16_t axis;    // [1/32767]
    } along[3][SR_LIGHT_TREE_WIDTH];
    struct {
        int16_t cos_o, cos_e; // [1/32767]
    } cone[SR_LIGHT_TREE_WIDTH];
    float radius[SR_LIGHT_TREE_WIDTH];   // [m]
    float power[SR_LIGHT_TREE_WIDTH];    // [cd sr] of one side; negative: two sides glow; 0: nothing there
    uint32_t child[SR_LIGHT_TREE_WIDTH]; // node, or SR_LIGHT_TREE_LEAF | light
    uint32_t parent;                     // node * 8 + child
} __attribute__((aligned(64)));

#define SR_LIGHT_TREE_LEAF 0x80000000u
#define SR_LIGHT_TREE_NOWHERE UINT32_MAX

struct sr_light_tree {
    struct sr_light_tree_node *nodes; // the root is first
    uint32_t node_count;
};

/* Of all lights with finite bounds and power; place[i] becomes node * 8 + child of light i and stays as it is for
 * others. */
sr_status sr_light_tree_build(struct sr_arena *arena, const struct sr_light *lights, uint32_t count,
                              struct sr_light_tree *tree, uint32_t *place, struct sr_error *error);
/* u in [0, 1), of more than 24 bits where there are many lights. */
bool sr_light_tree_pick(const struct sr_light_tree *tree, sr_vec3 p, sr_vec3 ns, double u, uint32_t *index, float *pmf);
float sr_light_tree_pmf(const struct sr_light_tree *tree, sr_vec3 p, sr_vec3 ns, uint32_t place);

#endif
