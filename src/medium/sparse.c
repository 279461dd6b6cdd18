/* SPDX-License-Identifier: MIT */
/* Looking into a sparse grid (sparse.h): three steps down, one for all eight neighbours where they share a leaf. The
 * layout is that of OpenVDB's leaves and lower nodes (K. Museth, VDB: High-Resolution Sparse Volumes with Dynamic
 * Topology, 2013), under one table. Files hold values also where nothing is active, beyond the box of what is: those
 * are not meant. */
#include "medium/sparse.h"

/* The leaf around (i, j, k), or NULL, and a constant. */
static inline const float *leaf_at(const struct sr_sparse *g, int32_t i, int32_t j, int32_t k, float *constant)
{
    uint32_t x = (uint32_t)(i >> 7) - (uint32_t)g->first[0], y = (uint32_t)(j >> 7) - (uint32_t)g->first[1],
             z = (uint32_t)(k >> 7) - (uint32_t)g->first[2];
    *constant = g->background;
    if (x >= (uint32_t)g->n[0] || y >= (uint32_t)g->n[1] || z >= (uint32_t)g->n[2])
        return NULL;
    int32_t block = g->table[((size_t)z * (size_t)g->n[1] + y) * (size_t)g->n[0] + x];
    int32_t leaf = block < 0 ? block : g->blocks[block].leaves[(i >> 3 & 15) << 8 | (j >> 3 & 15) << 4 | (k >> 3 & 15)];
    if (leaf >= 0)
        return g->leaves[leaf].values;
    *constant = g->tiles[~leaf];
    return NULL;
}

static inline bool is_in_box(const struct sr_sparse *g, int32_t i, int32_t j, int32_t k)
{
    return i >= g->least[0] && i <= g->most[0] && j >= g->least[1] && j <= g->most[1] && k >= g->least[2] &&
           k <= g->most[2];
}

static float value_at(const struct sr_sparse *g, int32_t i, int32_t j, int32_t k)
{
    if (!is_in_box(g, i, j, k))
        return 0;
    float constant;
    const float *leaf = leaf_at(g, i, j, k, &constant);
    return leaf ? leaf[(i & 7) << 6 | (j & 7) << 3 | (k & 7)] : constant;
}

float sr_sparse_at(const struct sr_sparse *g, sr_vec3 index)
{
    const float most = 0x1p30f;
    if (!(fabsf(index.x) < most && fabsf(index.y) < most && fabsf(index.z) < most))
        return 0;
    float x = floorf(index.x), y = floorf(index.y), z = floorf(index.z), v[8], constant;
    int32_t i = (int32_t)x, j = (int32_t)y, k = (int32_t)z;
    if ((i & 7) < 7 && (j & 7) < 7 && (k & 7) < 7 && is_in_box(g, i, j, k) && is_in_box(g, i + 1, j + 1, k + 1)) {
        const float *leaf = leaf_at(g, i, j, k, &constant);
        if (!leaf)
            return constant;
        leaf += (i & 7) << 6 | (j & 7) << 3 | (k & 7);
        for (int c = 0; c < 8; ++c)
            v[c] = leaf[(c & 1) << 6 | (c & 2) << 2 | c >> 2];
    } else
        for (int c = 0; c < 8; ++c)
            v[c] = value_at(g, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
    float fx = index.x - x, fy = index.y - y, fz = index.z - z;
    return sr_lerp(fz, sr_lerp(fy, sr_lerp(fx, v[0], v[1]), sr_lerp(fx, v[2], v[3])),
                   sr_lerp(fy, sr_lerp(fx, v[4], v[5]), sr_lerp(fx, v[6], v[7])));
}

/* first … last of a side: what of it lies in the part of 2^shift numbers that begins at `start`. */
static bool overlap(const int64_t first[3], const int64_t last[3], const int64_t start[3], int shift, int64_t from[3],
                    int64_t to[3])
{
    bool is_any = true;
    for (int k = 0; k < 3; ++k) {
        int64_t end = start[k] + ((int64_t)1 << shift) - 1;
        from[k] = first[k] > start[k] ? first[k] : start[k];
        to[k] = last[k] < end ? last[k] : end;
        is_any &= from[k] <= to[k];
    }
    return is_any;
}

static float largest_of_leaf(const float *values, const int64_t from[3], const int64_t to[3])
{
    float largest = -INFINITY;
    for (int64_t i = from[0]; i <= to[0]; ++i)
        for (int64_t j = from[1]; j <= to[1]; ++j)
            for (int64_t k = from[2]; k <= to[2]; ++k)
                largest = sr_max(values[(i & 7) << 6 | (j & 7) << 3 | (k & 7)], largest);
    return largest;
}

static float largest_of_block(const struct sr_sparse *g, const struct sr_sparse_block *block, const int64_t start[3],
                              const int64_t first[3], const int64_t last[3])
{
    float largest = -INFINITY;
    int64_t from[3], to[3];
    if (!overlap(first, last, start, 7, from, to))
        return largest;
    for (int64_t i = from[0] >> 3; i <= to[0] >> 3; ++i)
        for (int64_t j = from[1] >> 3; j <= to[1] >> 3; ++j)
            for (int64_t k = from[2] >> 3; k <= to[2] >> 3; ++k) {
                int32_t leaf = block->leaves[(i & 15) << 8 | (j & 15) << 4 | (k & 15)];
                const int64_t corner[3] = {i * 8, j * 8, k * 8};
                int64_t a[3], b[3];
                overlap(first, last, corner, 3, a, b);
                largest = sr_max(leaf < 0 ? g->tiles[~leaf] : largest_of_leaf(g->leaves[leaf].values, a, b), largest);
            }
    return largest;
}

float sr_sparse_largest(const struct sr_sparse *g, const double lo[3], const double hi[3])
{
    int64_t first[3], last[3], from[3], to[3];
    bool is_in_box = true, is_in_table = true, is_any = true;
    for (int k = 0; k < 3; ++k) {
        const double far = 0x1p40;
        int64_t lower = (int64_t)fmin(fmax(floor(lo[k]), -far), far),
                upper = (int64_t)fmin(fmax(ceil(hi[k]), -far), far);
        int64_t table_end = (int64_t)g->first[k] + g->n[k] - 1;
        first[k] = lower > g->least[k] ? lower : g->least[k];
        last[k] = upper < g->most[k] ? upper : g->most[k];
        is_any &= first[k] <= last[k];
        is_in_box &= first[k] == lower && last[k] == upper;
        from[k] = first[k] >> 7 > g->first[k] ? first[k] >> 7 : g->first[k];
        to[k] = last[k] >> 7 < table_end ? last[k] >> 7 : table_end;
        is_in_table &= from[k] == first[k] >> 7 && to[k] == last[k] >> 7;
    }
    if (!is_any)
        return 0;
    float largest = is_in_table ? -INFINITY : g->background;
    if (!is_in_box)
        largest = sr_max(largest, 0);
    for (int64_t z = from[2]; z <= to[2]; ++z)
        for (int64_t y = from[1]; y <= to[1]; ++y)
            for (int64_t x = from[0]; x <= to[0]; ++x) {
                int32_t block =
                    g->table[((z - g->first[2]) * g->n[1] + (y - g->first[1])) * g->n[0] + (x - g->first[0])];
                const int64_t start[3] = {x * 128, y * 128, z * 128};
                largest = sr_max(
                    block < 0 ? g->tiles[~block] : largest_of_block(g, &g->blocks[block], start, first, last), largest);
            }
    return largest;
}
