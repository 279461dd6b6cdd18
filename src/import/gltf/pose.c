/* SPDX-License-Identifier: MIT */
/* The pose that the file shows: nodes in the world, joints of skins, weights of morph targets.
 *
 *     world = parent's world  T R S,  or the node's matrix;      J_j = world of joint j  inverse bind matrix j
 *
 * glTF 2.0, 3.5 and 3.7.3. Animations are not played. */
#include "import/gltf/gltf.h"

#include <string.h>

/* ---- nodes ---- */

static void multiply(const double a[4][4], const double b[4][4], double out[4][4])
{
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + a[i][3] * b[3][j];
}

void sr_gltf_compose_trs(const double t[3], const double q[4], const double s[3], double out[4][4])
{
    double length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], k = length2 > 0 ? 2 / length2 : 0;
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[3][3] = {{1 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w)},
                            {k * (x * y + z * w), 1 - k * (x * x + z * z), k * (y * z - x * w)},
                            {k * (x * z - y * w), k * (y * z + x * w), 1 - k * (x * x + y * y)}};
    memset(out, 0, 16 * sizeof(double));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            out[i][j] = r[i][j] * s[j];
        out[i][3] = t[i];
    }
    out[3][3] = 1;
}

static void read_local(struct sr_gltf *g, const struct sr_gltf_at *node, double out[4][4])
{
    double columns[16], t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    if (sr_gltf_numbers(g, node, "matrix", 16, columns)) {
        for (int i = 0; i < 16; ++i)
            out[i % 4][i / 4] = columns[i];
        return;
    }
    sr_gltf_numbers(g, node, "translation", 3, t);
    sr_gltf_numbers(g, node, "rotation", 4, q);
    sr_gltf_numbers(g, node, "scale", 3, s);
    sr_gltf_compose_trs(t, q, s, out);
}

struct pending {
    uint32_t node, parent1;
};

/* Places all nodes below one, without recursion: a chain may be as long as the file. */
static void place_below(struct sr_gltf *g, uint32_t root, struct sr_array *stack)
{
    struct pending *p = sr_array_push(stack, sizeof *p);
    if (p)
        *p = (struct pending){root, 0};
    while (stack->count && sr_gltf_is_well(g)) {
        struct pending next = ((struct pending *)stack->data)[--stack->count];
        struct sr_gltf_node *node = &g->nodes[next.node];
        struct sr_gltf_at at = sr_gltf_entry(g, "nodes", next.node);
        if (node->is_of_scene) {
            sr_gltf_fail(g, &at, "is below more than one node, or below itself");
            return;
        }
        double local[4][4];
        read_local(g, &at, local);
        node->is_of_scene = true;
        if (next.parent1)
            multiply(g->nodes[next.parent1 - 1].world, local, node->world);
        else
            memcpy(node->world, local, sizeof local);
        struct sr_gltf_at children = sr_gltf_array(g, &at, "children");
        for (uint32_t i = sr_gltf_count(&children); i-- > 0 && sr_gltf_is_well(g);) {
            uint32_t child1 = sr_gltf_index1_of(g, &children, i, g->node_count);
            p = child1 ? sr_array_push(stack, sizeof *p) : NULL;
            if (p)
                *p = (struct pending){child1 - 1, next.node + 1};
            else
                sr_fail(g->c.error, SR_ERROR_RESOURCE, "%s: not enough memory", g->c.path);
        }
    }
}

/* The nodes of the scene that the file shows, or of its first; without scenes all that are nobody's children. */
void sr_gltf_place_nodes(struct sr_gltf *g)
{
    struct sr_gltf_at root = {.json = g->root};
    uint32_t scene_count = sr_gltf_root_count(g, "scenes"), scene1 = sr_gltf_index1(g, &root, "scene", scene_count);
    g->node_count = sr_gltf_root_count(g, "nodes");
    g->nodes = sr_gltf_array_for(g, NULL, &g->scratch, g->node_count, sizeof *g->nodes);
    struct sr_array stack = {0};
    if (g->nodes && scene_count) {
        if (scene_count > 1)
            sr_log(g->c.d->log, SR_INFO, "%s: has %u scenes; scene %u is read", g->c.path, scene_count,
                   scene1 ? scene1 - 1 : 0);
        struct sr_gltf_at scene = sr_gltf_entry(g, "scenes", scene1 ? scene1 - 1 : 0),
                          nodes = sr_gltf_array(g, &scene, "nodes");
        for (uint32_t i = 0; i < sr_gltf_count(&nodes) && sr_gltf_is_well(g); ++i) {
            uint32_t node1 = sr_gltf_index1_of(g, &nodes, i, g->node_count);
            if (node1)
                place_below(g, node1 - 1, &stack);
        }
    } else if (g->nodes) {
        bool *is_child = sr_gltf_array_for(g, NULL, &g->scratch, g->node_count, sizeof *is_child);
        for (uint32_t i = 0; i < g->node_count && sr_gltf_is_well(g); ++i) {
            struct sr_gltf_at node = sr_gltf_entry(g, "nodes", i), children = sr_gltf_array(g, &node, "children");
            for (uint32_t k = 0; k < sr_gltf_count(&children) && sr_gltf_is_well(g); ++k) {
                uint32_t child1 = sr_gltf_index1_of(g, &children, k, g->node_count);
                if (child1)
                    is_child[child1 - 1] = true;
            }
        }
        for (uint32_t i = 0; i < g->node_count && sr_gltf_is_well(g); ++i)
            if (!is_child[i])
                place_below(g, i, &stack);
    }
    sr_array_free(&stack);
}

struct sr_transform sr_gltf_transform_of(const double m[4][4])
{
    float f[4][4];
    for (int i = 0; i < 16; ++i)
        f[i / 4][i % 4] = (float)m[i / 4][i % 4];
    return sr_transform_from_matrix((const float(*)[4])f);
}

/* ---- skins and weights ---- */

static bool read_joints(struct sr_gltf *g, const struct sr_gltf_at *skin, struct sr_arena *arena,
                        struct sr_gltf_pose *pose)
{
    struct sr_gltf_at joints = sr_gltf_array(g, skin, "joints");
    uint32_t count = sr_gltf_count(&joints);
    struct sr_gltf_accessor bind = sr_gltf_accessor(g, skin, "inverseBindMatrices", 16);
    if (sr_gltf_is_well(g) && count == 0)
        sr_gltf_fail(g, skin, "expected a list of \"joints\"");
    if (bind.count && bind.count < count)
        sr_gltf_fail(g, &bind.at, "has %u matrices, and there are %u joints", bind.count, count);
    float(*out)[3][4] = sr_gltf_array_for(g, skin, arena, count, sizeof *out);
    for (uint32_t j = 0; j < count && out && sr_gltf_is_well(g); ++j) {
        uint32_t node1 = sr_gltf_index1_of(g, &joints, j, g->node_count);
        if (!node1)
            return false;
        double inverse[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, product[4][4];
        float columns[16];
        if (bind.count) {
            sr_gltf_floats(&bind, j, columns);
            for (int i = 0; i < 16; ++i)
                inverse[i % 4][i / 4] = (double)columns[i];
        }
        if (!g->nodes[node1 - 1].is_of_scene) {
            struct sr_gltf_at at = sr_gltf_entry(g, "nodes", node1 - 1);
            sr_gltf_fail(g, &at, "is a joint of a skin, and not in the scene");
            return false;
        }
        multiply(g->nodes[node1 - 1].world, inverse, product);
        for (int i = 0; i < 12; ++i)
            (&out[j][0][0])[i] = (float)product[i / 4][i % 4];
    }
    pose->joints = (const float(*)[3][4])out;
    pose->joint_count = count;
    return out && sr_gltf_is_well(g);
}

bool sr_gltf_read_pose(struct sr_gltf *g, uint32_t node, const struct sr_gltf_at *mesh, struct sr_arena *arena,
                       struct sr_gltf_pose *pose)
{
    *pose = (struct sr_gltf_pose){0};
    struct sr_gltf_at at = sr_gltf_entry(g, "nodes", node), weights = sr_gltf_array(g, &at, "weights");
    const struct sr_gltf_at *owner = weights.json ? &at : mesh;
    weights = sr_gltf_array(g, owner, "weights");
    uint32_t count = sr_gltf_count(&weights);
    double *values = count ? sr_gltf_array_for(g, &weights, arena, count, sizeof *values) : NULL;
    if (values && sr_gltf_numbers(g, owner, "weights", count, values)) {
        pose->weights = values;
        pose->weight_count = count;
    }
    uint32_t skin1 = sr_gltf_index1(g, &at, "skin", sr_gltf_root_count(g, "skins"));
    if (skin1) {
        struct sr_gltf_at skin = sr_gltf_entry(g, "skins", skin1 - 1);
        return read_joints(g, &skin, arena, pose);
    }
    return sr_gltf_is_well(g);
}
