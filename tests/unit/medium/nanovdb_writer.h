/* SPDX-License-Identifier: MIT */
/* Writes small NanoVDB files for tests: a box of index space whose values a function gives, in a tree of one root,
 * upper and lower nodes and leaves, by the layout of version 32. Shared with the fuzz target. */
#ifndef TEST_MEDIUM_NANOVDB_WRITER_H
#define TEST_MEDIUM_NANOVDB_WRITER_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct nanovdb_spec {
    const char *name;
    uint32_t type;    // 1: float, 13 to 15: Fp4, Fp8, Fp16, 16: FpN of 2 bits
    int lo[3], hi[3]; // both included
    float (*value)(int i, int j, int k);
    bool has_tiles;             // leaves that are all of one value become constants of their parents
    float elsewhere;            // what nodes hold beyond the box
    double matrix[9], shift[3]; // index to world
    bool has_checksum;
};

struct nanovdb_file {
    uint8_t *data; // by malloc
    size_t size;
};

enum { VDB_META = 16, VDB_META_B = 176, VDB_UPPER_B = 270400, VDB_LOWER_B = 33856, VDB_ROOT = 672 + 64 };

static inline void vdb_put(uint8_t *at, const void *value, size_t size)
{
    memcpy(at, value, size);
}
static inline void vdb_put32(uint8_t *at, uint32_t value)
{
    vdb_put(at, &value, 4);
}
static inline void vdb_put64(uint8_t *at, uint64_t value)
{
    vdb_put(at, &value, 8);
}
static inline int vdb_floor(int x, int size)
{
    return (x >= 0 ? x : x - size + 1) / size * size;
}

/* Grows by a node; returns where it begins. */
static inline size_t vdb_add(struct nanovdb_file *f, size_t size)
{
    f->data = realloc(f->data, f->size + size);
    if (!f->data)
        abort();
    memset(f->data + f->size, 0, size);
    f->size += size;
    return f->size - size;
}

static inline float vdb_value(const struct nanovdb_spec *s, int i, int j, int k)
{
    bool is_within = i >= s->lo[0] && i <= s->hi[0] && j >= s->lo[1] && j <= s->hi[1] && k >= s->lo[2] && k <= s->hi[2];
    return is_within ? s->value(i, j, k) : 0;
}

static inline uint32_t vdb_bits(const struct nanovdb_spec *s) // of a value
{
    return s->type == 13 ? 4 : s->type == 14 ? 8 : s->type == 15 ? 16 : s->type == 16 ? 2 : 32;
}

static inline size_t vdb_leaf(struct nanovdb_file *f, const struct nanovdb_spec *s, const int c[3])
{
    float v[512], least = INFINITY, most = -INFINITY;
    for (int n = 0; n < 512; ++n) {
        v[n] = vdb_value(s, c[0] + (n >> 6), c[1] + (n >> 3 & 7), c[2] + (n & 7));
        least = fminf(least, v[n]);
        most = fmaxf(most, v[n]);
    }
    uint32_t bits = vdb_bits(s);
    size_t at = vdb_add(f, 96 + 64 * (size_t)bits);
    vdb_put(f->data + at, c, 12);
    vdb_put32(f->data + at + 12, s->type == 16 ? 1u << 29 : 0);
    if (bits == 32) {
        vdb_put(f->data + at + 96, v, sizeof v);
        return at;
    }
    uint32_t steps = (1u << bits) - 1;
    float quantum = (most - least) / (float)steps;
    vdb_put(f->data + at + 80, &least, 4);
    vdb_put(f->data + at + 84, &quantum, 4);
    for (uint32_t n = 0; n < 512; ++n) {
        uint32_t q = quantum > 0 ? (uint32_t)lrintf((v[n] - least) / quantum) : 0, bit = n * bits;
        uint32_t word;
        memcpy(&word, f->data + at + 96 + bit / 32 * 4, 4);
        vdb_put32(f->data + at + 96 + bit / 32 * 4, word | q << bit % 32);
    }
    return at;
}

/* The children of size `size` within the parent at c: each becomes a node, a constant, or nothing. */
static inline bool vdb_is_constant(const struct nanovdb_spec *s, const int c[3], int size)
{
    float first = vdb_value(s, c[0], c[1], c[2]);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            for (int k = 0; k < size; ++k)
                if (vdb_value(s, c[0] + i, c[1] + j, c[2] + k) != first)
                    return false;
    return true;
}
static inline bool vdb_is_empty(const struct nanovdb_spec *s, const int c[3], int size)
{
    for (int k = 0; k < 3; ++k)
        if (c[k] > s->hi[k] || c[k] + size - 1 < s->lo[k])
            return true;
    return false;
}

static inline size_t vdb_node(struct nanovdb_file *f, const struct nanovdb_spec *s, const int c[3], bool is_upper)
{
    int side = is_upper ? 32 : 16, size = is_upper ? 128 : 8;
    size_t at = vdb_add(f, is_upper ? VDB_UPPER_B : VDB_LOWER_B), mask = is_upper ? 4128 : 544,
           table = is_upper ? 8256 : 1088;
    for (int n = 0; n < side * side * side; ++n) {
        const int child[3] = {c[0] + n / side / side * size, c[1] + n / side % side * size, c[2] + n % side * size};
        if (vdb_is_empty(s, child, size)) {
            vdb_put(f->data + at + table + 8 * (size_t)n, &s->elsewhere, 4);
            continue;
        }
        float first = vdb_value(s, child[0], child[1], child[2]);
        if (s->has_tiles && vdb_is_constant(s, child, size)) {
            vdb_put(f->data + at + table + 8 * (size_t)n, &first, 4);
            continue;
        }
        size_t node = is_upper ? vdb_node(f, s, child, false) : vdb_leaf(f, s, child);
        vdb_put64(f->data + at + table + 8 * (size_t)n, node - at);
        f->data[at + mask + (size_t)n / 8] |= (uint8_t)(1u << n % 8);
    }
    return at;
}

static inline uint32_t vdb_crc(const uint8_t *data, size_t size)
{
    uint32_t crc = ~0u;
    for (size_t i = 0; i < size; ++i)
        for (int bit = 0; bit < 8; ++bit)
            crc = crc >> 1 ^ (((crc ^ (uint32_t)(data[i] >> bit)) & 1) ? 0xedb88320u : 0);
    return ~crc;
}

static inline void vdb_header(uint8_t *d, const struct nanovdb_spec *s, size_t grid_B)
{
    const double *m = s->matrix;
    double inverse[9], world[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) { // cofactors
            int a = (j + 1) % 3, b = (j + 2) % 3, e = (i + 1) % 3, g = (i + 2) % 3;
            inverse[3 * i + j] = m[3 * a + e] * m[3 * b + g] - m[3 * a + g] * m[3 * b + e];
        }
    double determinant = m[0] * inverse[0] + m[1] * inverse[3] + m[2] * inverse[6];
    for (int i = 0; i < 9; ++i)
        inverse[i] /= determinant;
    for (int corner = 0; corner < 8; ++corner)
        for (int i = 0; i < 3; ++i) {
            double x = s->shift[i];
            for (int j = 0; j < 3; ++j)
                x += m[3 * i + j] * (corner >> j & 1 ? s->hi[j] + 1 : s->lo[j]);
            world[i] = fmin(world[i], x);
            world[3 + i] = fmax(world[3 + i], x);
        }
    vdb_put64(d, 0x304244566f6e614eull);
    vdb_put64(d + 8, ~0ull);
    vdb_put32(d + 16, 32u << 21 | 4u << 10 | 2);
    vdb_put32(d + 28, 1);
    vdb_put64(d + 32, grid_B);
    strncpy((char *)d + 40, s->name, 255);
    vdb_put(d + 296 + 88, m, sizeof s->matrix);
    vdb_put(d + 296 + 160, inverse, sizeof inverse);
    vdb_put(d + 296 + 232, s->shift, sizeof s->shift);
    vdb_put(d + 560, world, sizeof world);
    vdb_put32(d + 632, 2); // fog
    vdb_put32(d + 636, s->type);
    vdb_put64(d + 672 + 24, 64); // the root follows the tree
    vdb_put(d + VDB_ROOT, s->lo, 12);
    vdb_put(d + VDB_ROOT + 12, s->hi, 12);
}

/* Adds one grid as a segment of its own. */
static inline void nanovdb_write(struct nanovdb_file *f, const struct nanovdb_spec *s)
{
    struct nanovdb_file grid = {0};
    int tiles[3], origin[3];
    for (int k = 0; k < 3; ++k) {
        origin[k] = vdb_floor(s->lo[k], 4096);
        tiles[k] = (vdb_floor(s->hi[k], 4096) - origin[k]) / 4096 + 1;
    }
    uint32_t count = (uint32_t)(tiles[0] * tiles[1] * tiles[2]);
    vdb_add(&grid, VDB_ROOT + 64 + 32 * count);
    vdb_put32(grid.data + VDB_ROOT + 24, count);
    for (uint32_t t = 0; t < count; ++t) {
        int c[3] = {origin[0] + 4096 * (int)(t % (uint32_t)tiles[0]),
                    origin[1] + 4096 * (int)(t / (uint32_t)tiles[0] % (uint32_t)tiles[1]),
                    origin[2] + 4096 * (int)(t / (uint32_t)tiles[0] / (uint32_t)tiles[1])};
        size_t upper = vdb_node(&grid, s, c, true);
        uint8_t *tile = grid.data + VDB_ROOT + 64 + 32 * t;
        vdb_put64(tile, (uint64_t)((uint32_t)c[2] >> 12) | (uint64_t)((uint32_t)c[1] >> 12) << 21 |
                            (uint64_t)((uint32_t)c[0] >> 12) << 42);
        vdb_put64(tile + 8, upper - VDB_ROOT);
    }
    vdb_header(grid.data, s, grid.size);
    if (s->has_checksum)
        vdb_put32(grid.data + 8, vdb_crc(grid.data + 16, VDB_ROOT + 64 + 32 * count - 16));
    size_t name_B = strlen(s->name) + 1, at = vdb_add(f, VDB_META + VDB_META_B + name_B + grid.size);
    uint8_t *d = f->data + at;
    vdb_put64(d, 0x304244566f6e614eull);
    vdb_put32(d + 8, 32u << 21 | 4u << 10 | 2);
    vdb_put32(d + 12, 1);
    vdb_put64(d + 16, grid.size);
    vdb_put64(d + 24, grid.size);
    vdb_put32(d + 16 + 136, (uint32_t)name_B);
    vdb_put32(d + 16 + 172, 32u << 21 | 4u << 10 | 2);
    vdb_put(d + VDB_META + VDB_META_B, s->name, name_B);
    vdb_put(d + VDB_META + VDB_META_B + name_B, grid.data, grid.size);
    free(grid.data);
}

#endif
