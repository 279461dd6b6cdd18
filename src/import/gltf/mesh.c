/* SPDX-License-Identifier: MIT */
/* A primitive's triangles, in the pose that the file shows.
 *
 *     triangles  3 i, 3 i + 1, 3 i + 2;   strip  i, i + 1 + i mod 2, i + 2 - i mod 2;   fan  i + 1, i + 2, 0
 *     morphed:   p' = p + SUM w_t d_t                     the same for normals and tangents
 *     skinned:   p' = SUM w_j J_j p / SUM w_j,   n' = adj(SUM w_j J_j)^T n   J_j: to the world, from the bind pose
 *
 * glTF 2.0, 3.7. Only the vertices that the triangles use are kept: files share one buffer among many primitives. */
#include "import/gltf/gltf.h"

#include <stdio.h>
#include <string.h>

/* ---- triangles ---- */

static uint32_t corner_of(uint32_t mode, uint32_t triangle, uint32_t k)
{
    if (mode == 5)
        return k == 0 ? triangle : k == 1 ? triangle + 1 + triangle % 2 : triangle + 2 - triangle % 2;
    if (mode == 6)
        return k == 2 ? 0 : triangle + 1 + k;
    return 3 * triangle + k;
}

static uint32_t read_mode(struct sr_gltf *g, const struct sr_gltf_at *at)
{
    static const char *const names[] = {"points", "lines", "a line loop", "a line strip"};
    uint32_t mode = (uint32_t)sr_gltf_size(g, at, "mode", 4, 6);
    if (mode < 4)
        sr_gltf_warn(g, at, "%s have no surface and are left out", names[mode]);
    return mode;
}

/* Corners as numbers of the file's vertices. */
static bool read_triangles(struct sr_gltf *g, const struct sr_gltf_at *at, uint32_t mode, uint32_t position_count,
                           struct sr_arena *data, struct sr_gltf_mesh *m)
{
    struct sr_gltf_accessor list = sr_gltf_accessor(g, at, "indices", 1);
    if (list.count && (list.type == 5120 || list.type == 5122 || list.type == 5126))
        sr_gltf_fail(g, &list.at, "indices need a componentType without sign");
    uint32_t count = list.count ? list.count : position_count;
    m->triangle_count = mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
    if (sr_gltf_is_well(g) && m->triangle_count == 0)
        sr_gltf_warn(g, at, "has %u vertices, which is no triangle, and is left out", count);
    if (m->triangle_count == 0 ||
        !(m->indices = sr_gltf_array_for(g, at, data, 3 * (uint64_t)m->triangle_count, sizeof(int32_t))))
        return false;
    for (uint32_t t = 0; t < m->triangle_count; ++t)
        for (uint32_t k = 0; k < 3; ++k) {
            uint32_t corner = corner_of(mode, t, k), vertex = list.count ? sr_gltf_whole(&list, corner, 0) : corner;
            if (vertex >= position_count) {
                sr_gltf_fail(g, &list.at, "index %u at place %u: there are %u vertices", vertex, corner,
                             position_count);
                return false;
            }
            m->indices[3 * (size_t)t + k] = (int32_t)vertex;
        }
    return true;
}

/* The file's numbers of the vertices that are used, in order; indices then count in this list. NULL: no memory. */
static uint32_t *compact(struct sr_gltf *g, const struct sr_gltf_at *at, struct sr_arena *scratch,
                         struct sr_gltf_mesh *m)
{
    size_t corners = 3 * (size_t)m->triangle_count;
    int32_t lo = INT32_MAX, hi = 0;
    for (size_t i = 0; i < corners; ++i) {
        lo = m->indices[i] < lo ? m->indices[i] : lo;
        hi = m->indices[i] > hi ? m->indices[i] : hi;
    }
    uint32_t range = (uint32_t)(hi - lo) + 1;
    int32_t *number1 = sr_gltf_array_for(g, at, scratch, range, sizeof *number1);
    uint32_t *used =
        number1 ? sr_gltf_array_for(g, at, scratch, range < corners ? range : corners, sizeof *used) : NULL;
    if (!used)
        return NULL;
    for (size_t i = 0; i < corners; ++i)
        number1[m->indices[i] - lo] = 1;
    for (uint32_t i = 0; i < range; ++i)
        if (number1[i]) {
            used[m->vertex_count] = (uint32_t)lo + i;
            number1[i] = (int32_t)++m->vertex_count;
        }
    for (size_t i = 0; i < corners; ++i)
        m->indices[i] = number1[m->indices[i] - lo] - 1;
    return used;
}

/* ---- attributes ---- */

struct reader {
    struct sr_gltf *g;
    struct sr_gltf_at attributes, targets;
    const struct sr_gltf_pose *pose;
    const uint32_t *used;
    uint32_t position_count;
};

static struct sr_gltf_accessor open_attribute(struct reader *r, const struct sr_gltf_at *attributes, const char *name,
                                              uint32_t components)
{
    struct sr_gltf_accessor a = sr_gltf_accessor(r->g, attributes, name, components);
    if (a.count && a.count < r->position_count) {
        sr_gltf_fail(r->g, &a.at, "has %u elements as %s, where there are %u vertices", a.count, name,
                     r->position_count);
        a.count = 0;
    }
    return a;
}

/* Three numbers a vertex, morphed. wide: tangents have a fourth, which is left. NULL: the file has none. */
static sr_vec3 *read_vectors(struct reader *r, const char *name, uint32_t components, struct sr_arena *arena,
                             uint32_t count)
{
    struct sr_gltf_accessor a = open_attribute(r, &r->attributes, name, components);
    sr_vec3 *out = a.count ? sr_gltf_array_for(r->g, &a.at, arena, count, sizeof *out) : NULL;
    float v[16];
    for (uint32_t i = 0; i < count && out; ++i) {
        sr_gltf_floats(&a, r->used[i], v);
        out[i] = (sr_vec3){v[0], v[1], v[2]};
    }
    for (uint32_t t = 0; t < r->pose->weight_count && out; ++t) {
        struct sr_gltf_at target = sr_gltf_element(r->g, &r->targets, t);
        struct sr_gltf_accessor d =
            r->pose->weights[t] != 0 ? open_attribute(r, &target, name, 3) : (struct sr_gltf_accessor){0};
        for (uint32_t i = 0; i < count && d.count; ++i) {
            sr_gltf_floats(&d, r->used[i], v);
            out[i] = sr_mad(out[i], (float)r->pose->weights[t], (sr_vec3){v[0], v[1], v[2]});
        }
    }
    return out;
}

static void read_uv(struct reader *r, uint32_t set, struct sr_arena *arena, struct sr_gltf_mesh *m)
{
    char name[24];
    snprintf(name, sizeof name, "TEXCOORD_%u", set);
    struct sr_gltf_accessor a = open_attribute(r, &r->attributes, name, 2);
    sr_vec2 *uv = a.count ? sr_gltf_array_for(r->g, &a.at, arena, m->vertex_count, sizeof *uv) : NULL;
    float v[16];
    for (uint32_t i = 0; i < m->vertex_count && uv; ++i) {
        sr_gltf_floats(&a, r->used[i], v);
        uv[i] = (sr_vec2){isfinite(v[0]) ? v[0] : 0, isfinite(v[1]) ? v[1] : 0};
    }
    m->uv[set] = uv;
}

static void read_colours(struct reader *r, struct sr_arena *arena, struct sr_gltf_mesh *m)
{
    struct sr_gltf_accessor a = open_attribute(r, &r->attributes, "COLOR_0", 0);
    if (a.count && a.components != 3 && a.components != 4)
        sr_gltf_fail(r->g, &a.at, "has %u numbers in an element: expected 3 or 4, as COLOR_0", a.components);
    m->colours = a.count ? sr_gltf_array_for(r->g, &a.at, arena, m->vertex_count, 4 * sizeof(float)) : NULL;
    float v[16];
    for (uint32_t i = 0; i < m->vertex_count && m->colours; ++i) {
        v[3] = 1;
        sr_gltf_floats(&a, r->used[i], v);
        for (int k = 0; k < 4; ++k)
            m->colours[4 * (size_t)i + k] = v[k] >= 0 ? sr_min(v[k], 1) : 0;
    }
}

/* ---- skins ---- */

enum { JOINT_SETS = 4 };

static bool blend(struct reader *r, const struct sr_gltf_accessor joints[], const struct sr_gltf_accessor weights[],
                  uint32_t vertex, float out[3][4])
{
    float sum = 0, w[16];
    memset(out, 0, 12 * sizeof(float));
    for (int s = 0; s < JOINT_SETS && weights[s].count; ++s) {
        sr_gltf_floats(&weights[s], vertex, w);
        for (uint32_t k = 0; k < 4; ++k) {
            uint32_t joint = sr_gltf_whole(&joints[s], vertex, k);
            if (!(w[k] != 0))
                continue;
            if (joint >= r->pose->joint_count) {
                sr_gltf_fail(r->g, &joints[s].at, "joint %u of vertex %u: the skin has %u", joint, vertex,
                             r->pose->joint_count);
                return false;
            }
            const float *from = &r->pose->joints[joint][0][0];
            for (int i = 0; i < 12; ++i)
                (&out[0][0])[i] += w[k] * from[i];
            sum += w[k];
        }
    }
    for (int i = 0; i < 12; ++i)
        (&out[0][0])[i] *= sum != 0 ? 1 / sum : 1;
    return true;
}

static sr_vec3 along(const float m[3][4], sr_vec3 v)
{
    return (sr_vec3){m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                     m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

static void skin(struct reader *r, struct sr_gltf_mesh *m)
{
    struct sr_gltf_accessor joints[JOINT_SETS] = {{0}}, weights[JOINT_SETS] = {{0}};
    for (int s = 0; s < JOINT_SETS; ++s) {
        char name[24];
        snprintf(name, sizeof name, "WEIGHTS_%d", s);
        weights[s] = open_attribute(r, &r->attributes, name, 4);
        snprintf(name, sizeof name, "JOINTS_%d", s);
        joints[s] = open_attribute(r, &r->attributes, name, 4);
        if (joints[s].count && joints[s].type != 5121 && joints[s].type != 5123)
            sr_gltf_fail(r->g, &joints[s].at, "JOINTS need the componentType 5121 or 5123");
        if (!joints[s].count)
            weights[s].count = 0;
    }
    float t[3][4];
    for (uint32_t i = 0; i < m->vertex_count && sr_gltf_is_well(r->g); ++i) {
        if (!blend(r, joints, weights, r->used[i], t))
            return;
        m->P[i] = sr_add(along(t, m->P[i]), (sr_vec3){t[0][3], t[1][3], t[2][3]});
        if (m->S)
            m->S[i] = along(t, m->S[i]);
        if (!m->N)
            continue;
        sr_vec3 a = {t[0][0], t[0][1], t[0][2]}, b = {t[1][0], t[1][1], t[1][2]}, c = {t[2][0], t[2][1], t[2][2]},
                n = m->N[i];
        sr_vec3 turned = {sr_dot(sr_cross(b, c), n), sr_dot(sr_cross(c, a), n), sr_dot(sr_cross(a, b), n)};
        m->N[i] = sr_dot(a, sr_cross(b, c)) < 0 ? sr_neg(turned) : turned;
    }
}

/* ---- all of it ---- */

bool sr_gltf_read_mesh(struct sr_gltf *g, const struct sr_gltf_at *primitive, const struct sr_gltf_pose *pose,
                       uint32_t uv_sets, struct sr_gltf_stores stores, struct sr_gltf_mesh *out)
{
    *out = (struct sr_gltf_mesh){0};
    struct sr_gltf_at draco = sr_gltf_extension(g, primitive, "KHR_draco_mesh_compression");
    struct reader r = {.g = g,
                       .attributes = sr_gltf_object(g, primitive, "attributes"),
                       .targets = sr_gltf_array(g, primitive, "targets"),
                       .pose = pose};
    uint32_t mode = read_mode(g, primitive);
    struct sr_gltf_accessor positions = sr_gltf_accessor(g, &r.attributes, "POSITION", 3);
    if (sr_gltf_is_well(g) && positions.count && draco.json && !positions.data)
        sr_gltf_fail(g, &draco, "compressed by KHR_draco_mesh_compression, which is not supported");
    if (sr_gltf_is_well(g) && !positions.count)
        sr_gltf_warn(g, primitive, "has no POSITION and is left out");
    r.position_count = positions.count;
    if (!positions.count || mode < 4 || !read_triangles(g, primitive, mode, positions.count, stores.data, out))
        return false;
    struct sr_arena scratch = {0};
    uint64_t made_B = g->made_B;
    r.used = compact(g, primitive, &scratch, out);
    uint64_t scratch_B = g->made_B - made_B;
    if (pose->weight_count && sr_gltf_count(&r.targets) < pose->weight_count)
        sr_gltf_fail(g, primitive, "has %u morph targets, and there are %u weights", sr_gltf_count(&r.targets),
                     pose->weight_count);
    if (r.used && sr_gltf_is_well(g)) {
        out->P = read_vectors(&r, "POSITION", 3, stores.words, out->vertex_count);
        out->N = read_vectors(&r, "NORMAL", 3, stores.words, out->vertex_count);
        if (stores.wants_tangents)
            out->S = read_vectors(&r, "TANGENT", 4, stores.words, out->vertex_count);
        for (uint32_t set = 0; set < SR_GLTF_UV_SETS; ++set)
            if (uv_sets >> set & 1)
                read_uv(&r, set, stores.data, out);
        if (stores.wants_colours)
            read_colours(&r, stores.data, out);
        if (pose->joints && sr_gltf_is_well(g))
            skin(&r, out);
    }
    sr_arena_free(&scratch);
    g->made_B -= scratch_B;
    return sr_gltf_is_well(g) && out->P;
}
