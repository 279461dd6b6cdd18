/* SPDX-License-Identifier: MIT */
/* Reads one grid out of a NanoVDB file (K. Museth, NanoVDB: A GPU-Friendly and Portable VDB Data Structure, 2021) into
 * a sparse grid of our own: what the file says of its own layout is believed only after it has been found to lie within
 * the file, once, here.
 *
 *     segment: magic, version, number of grids, codec;  per grid 176 bytes and its name;  then the grids
 *     grid: header (672 bytes), tree (64), root and its tiles, upper nodes (32^3 children), lower nodes (16^3),
 *         leaves (8^3 values)
 *
 * Layout and reading of values are PNanoVDB.h's, through a buffer that gives 0 outside of the grid. Values are float,
 * or numbers of 1 to 16 bits that each leaf scales (Fp4, Fp8, Fp16, FpN). Codecs: none and zip. Limits: version 32; a
 * span of 2^22 blocks of 128^3. */
#include "medium/sparse.h"

#include <stdio.h>
#include <string.h>

typedef struct pnanovdb_buf_t {
    const uint8_t *data;
    uint64_t size;
} pnanovdb_buf_t;
static inline uint32_t pnanovdb_buf_read_uint32(pnanovdb_buf_t buf, uint64_t at)
{
    uint32_t value = 0;
    if (at <= buf.size && buf.size - at >= sizeof value)
        memcpy(&value, buf.data + at, sizeof value);
    return value;
}
static inline uint64_t pnanovdb_buf_read_uint64(pnanovdb_buf_t buf, uint64_t at)
{
    uint64_t value = 0;
    if (at <= buf.size && buf.size - at >= sizeof value)
        memcpy(&value, buf.data + at, sizeof value);
    return value;
}
typedef uint32_t pnanovdb_grid_type_t;
#define PNANOVDB_C
#define PNANOVDB_BUF_CUSTOM
#define PNANOVDB_GRID_TYPE_GET(type, what) pnanovdb_grid_type_constants[type].what
#include <nanovdb/PNanoVDB.h>

_Static_assert(PNANOVDB_MAJOR_VERSION_NUMBER == 32, "another layout");

#define MAGIC(last) (PNANOVDB_MAGIC_NUMBER - ((uint64_t)'0' << 56) + ((uint64_t)(last) << 56)) // "NanoVDB" and a digit
enum {
    SEGMENT_B = 16,
    META_B = 176,
    UPPER_CHILDREN = 32 * 32 * 32,
    LOWER_CHILDREN = 16 * 16 * 16,
    MOST_BLOCKS = 1 << 22
};
enum codec { NO_CODEC, ZIP, BLOSC };

struct file {
    const char *path;
    struct sr_error *error;
};

SR_PRINTF(2, 3) static sr_status refuse(const struct file *f, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return sr_fail(f->error, SR_ERROR_INPUT, "%s: %s", f->path, text);
}

/* ---- a tree ---- */

struct tree {
    const struct file *file;
    pnanovdb_buf_t buf;
    uint32_t type;
    pnanovdb_root_handle_t root;
    uint32_t tile_count;
    bool no_negative;
    struct sr_sparse *out;
    int32_t *table;
    struct sr_sparse_block *blocks;
    struct sr_sparse_leaf *leaves;
    uint64_t block_count, leaf_count; // found
    struct sr_array tiles;            // float
    uint64_t constant_count;          // of those as large as an upper node
};

#define LAYOUT(tree, what) PNANOVDB_GRID_TYPE_GET((tree)->type, what)

/* The node at base + offset, when all of it lies in the grid. */
static bool find_node(const struct tree *t, uint64_t base, int64_t offset, uint64_t size, uint64_t *at)
{
    *at = base + (uint64_t)offset;
    return (offset > 0) == (*at > base) && *at <= t->buf.size && t->buf.size - *at >= size;
}

static void root_tile_start(const struct tree *t, pnanovdb_root_tile_handle_t tile, int32_t start[3]) // [blocks]
{
    uint64_t key = pnanovdb_root_tile_get_key(t->buf, tile);
    for (int k = 0; k < 3; ++k) // 20 bits each, z lowest, of signed numbers
        start[k] = (int32_t)((uint32_t)(key >> 21 * (2 - k)) << 12) / 128;
}

static float check_value(const struct tree *t, float v)
{
    return t->no_negative && v < 0 ? 0 : v;
}

static sr_status no_memory(const struct tree *t)
{
    return sr_fail(t->file->error, SR_ERROR_RESOURCE, "%s: not enough memory for its grid", t->file->path);
}

/* The number that stands for a constant. */
static sr_status add_tile(struct tree *t, float value, int32_t *number)
{
    value = check_value(t, value);
    const float *known = t->tiles.data;
    for (size_t i = t->tiles.count > 4 ? t->tiles.count - 4 : 0; i < t->tiles.count; ++i)
        if (known[i] == value) {
            *number = ~(int32_t)i;
            return SR_OK;
        }
    if (!isfinite(value))
        return refuse(t->file, "holds values that are infinite or no numbers");
    if (t->tiles.count >= INT32_MAX)
        return refuse(t->file, "has more constants than are supported");
    float *slot = sr_array_push(&t->tiles, sizeof *slot);
    if (!slot)
        return no_memory(t);
    *slot = value;
    *number = ~(int32_t)(t->tiles.count - 1);
    return SR_OK;
}

static sr_status read_leaf(struct tree *t, uint64_t at)
{
    const pnanovdb_leaf_handle_t leaf = {{at}};
    float *to = t->leaves[t->leaf_count++].values;
    pnanovdb_address_t values = pnanovdb_leaf_get_table_address(t->type, t->buf, leaf, 0);
    uint32_t log_bits = t->type == PNANOVDB_GRID_TYPE_FP4 ? 2 : t->type == PNANOVDB_GRID_TYPE_FP8 ? 3 : 4;
    if (t->type == PNANOVDB_GRID_TYPE_FPN) {
        log_bits = pnanovdb_leaf_get_bbox_dif_and_flags(t->buf, leaf) >> 29;
        if (log_bits > 4 || t->buf.size - at - LAYOUT(t, leaf_off_table) < (uint64_t)64 << log_bits)
            return refuse(t->file, "is damaged: a leaf reaches beyond its grid");
    }
    if (t->type == PNANOVDB_GRID_TYPE_FLOAT)
        memcpy(to, t->buf.data + values.byte_offset, sizeof t->leaves->values);
    else
        for (int32_t n = 0; n < 512; ++n) {
            const pnanovdb_coord_t place = {n >> 6, n >> 3 & 7, n & 7};
            to[n] = pnanovdb_leaf_fp_read_float(t->buf, values, &place, log_bits);
        }
    for (int n = 0; n < 512; ++n) {
        if (!isfinite(to[n]))
            return refuse(t->file, "holds values that are infinite or no numbers");
        to[n] = check_value(t, to[n]);
    }
    return SR_OK;
}

static sr_status read_lower(struct tree *t, uint64_t at)
{
    const pnanovdb_lower_handle_t lower = {{at}};
    int32_t *to = t->blocks[t->block_count++].leaves;
    for (uint32_t n = 0; n < LOWER_CHILDREN; ++n) {
        pnanovdb_address_t entry = pnanovdb_lower_get_table_address(t->type, t->buf, lower, n);
        if (!pnanovdb_lower_get_child_mask(t->buf, lower, n)) {
            if (add_tile(t, pnanovdb_read_float(t->buf, entry), &to[n]) != SR_OK)
                return t->file->error->status;
            continue;
        }
        uint64_t leaf;
        if (!find_node(t, at, pnanovdb_read_int64(t->buf, entry), LAYOUT(t, leaf_size), &leaf))
            return refuse(t->file, "is damaged: a node has a leaf outside of its grid");
        to[n] = (int32_t)t->leaf_count;
        if (read_leaf(t, leaf) != SR_OK)
            return t->file->error->status;
    }
    return SR_OK;
}

/* ---- first what is there, and where ---- */

struct span {
    int64_t lo[3], hi[3]; // [blocks]
};
static void span_add(struct span *s, const int32_t start[3], int32_t size)
{
    for (int k = 0; k < 3; ++k) {
        s->lo[k] = start[k] < s->lo[k] ? start[k] : s->lo[k];
        s->hi[k] = (int64_t)start[k] + size > s->hi[k] ? (int64_t)start[k] + size : s->hi[k];
    }
}

static sr_status survey_lower(struct tree *t, uint64_t at)
{
    const pnanovdb_lower_handle_t lower = {{at}};
    ++t->block_count;
    for (uint32_t word = 0; word < LOWER_CHILDREN / 32; ++word)
        t->leaf_count += pnanovdb_uint32_countbits(pnanovdb_read_uint32(
            t->buf, pnanovdb_address_offset(lower.address, PNANOVDB_LOWER_OFF_CHILD_MASK + 4 * word)));
    // a tree has no node twice, so that all of them fit into its grid
    if (t->block_count > t->buf.size / LAYOUT(t, lower_size) || t->leaf_count > t->buf.size / LAYOUT(t, leaf_size))
        return refuse(t->file, "is damaged: its grid has more nodes than room");
    return SR_OK;
}

static sr_status survey_upper(struct tree *t, uint64_t at, const int32_t start[3], struct span *span)
{
    const pnanovdb_upper_handle_t upper = {{at}};
    for (uint32_t n = 0; n < UPPER_CHILDREN; ++n) {
        const int32_t place[3] = {start[0] + (int32_t)(n >> 10), start[1] + (int32_t)(n >> 5 & 31),
                                  start[2] + (int32_t)(n & 31)};
        pnanovdb_address_t entry = pnanovdb_upper_get_table_address(t->type, t->buf, upper, n);
        if (pnanovdb_upper_get_child_mask(t->buf, upper, n)) {
            uint64_t lower;
            if (!find_node(t, at, pnanovdb_read_int64(t->buf, entry), LAYOUT(t, lower_size), &lower))
                return refuse(t->file, "is damaged: a node has a child outside of its grid");
            span_add(span, place, 1);
            if (survey_lower(t, lower) != SR_OK)
                return t->file->error->status;
        } else if (pnanovdb_read_float(t->buf, entry) != t->out->background)
            span_add(span, place, 1);
    }
    return SR_OK;
}

/* ---- then the values ---- */

static int32_t *table_entry(struct tree *t, const int32_t place[3])
{
    const struct sr_sparse *g = t->out;
    for (int k = 0; k < 3; ++k)
        if (place[k] < g->first[k] || place[k] - g->first[k] >= g->n[k])
            return NULL; // of the background's value
    return &t->table[((size_t)(place[2] - g->first[2]) * (size_t)g->n[1] + (size_t)(place[1] - g->first[1])) *
                         (size_t)g->n[0] +
                     (size_t)(place[0] - g->first[0])];
}

static sr_status read_upper(struct tree *t, uint64_t at, const int32_t start[3])
{
    const pnanovdb_upper_handle_t upper = {{at}};
    for (uint32_t n = 0; n < UPPER_CHILDREN; ++n) {
        const int32_t place[3] = {start[0] + (int32_t)(n >> 10), start[1] + (int32_t)(n >> 5 & 31),
                                  start[2] + (int32_t)(n & 31)};
        int32_t *to = table_entry(t, place);
        if (!to)
            continue;
        pnanovdb_address_t entry = pnanovdb_upper_get_table_address(t->type, t->buf, upper, n);
        if (pnanovdb_upper_get_child_mask(t->buf, upper, n)) {
            *to = (int32_t)t->block_count;
            if (read_lower(t, at + (uint64_t)pnanovdb_read_int64(t->buf, entry)) != SR_OK)
                return t->file->error->status;
        } else if (add_tile(t, pnanovdb_read_float(t->buf, entry), to) != SR_OK)
            return t->file->error->status;
    }
    return SR_OK;
}

static sr_status read_root_constant(struct tree *t, float value, const int32_t start[3], struct span *span)
{
    if (value == t->out->background)
        return SR_OK;
    if (span) {
        span_add(span, start, 32);
        return ++t->constant_count <= MOST_BLOCKS / UPPER_CHILDREN
                   ? SR_OK
                   : refuse(t->file, "its grid has more constants of 4096^3 voxels than are supported");
    }
    int32_t number;
    if (add_tile(t, value, &number) != SR_OK)
        return t->file->error->status;
    for (int32_t n = 0; n < UPPER_CHILDREN; ++n)
        *table_entry(t, (int32_t[]){start[0] + (n >> 10), start[1] + (n >> 5 & 31), start[2] + (n & 31)}) = number;
    return SR_OK;
}

/* The tiles of the root, one by one; the first time, with `span`, only what is there. */
static sr_status go_through(struct tree *t, struct span *span)
{
    uint64_t uppers = 0;
    for (uint32_t i = 0; i < t->tile_count; ++i) {
        pnanovdb_root_tile_handle_t tile = pnanovdb_root_get_tile(t->type, t->root, i);
        int32_t start[3];
        root_tile_start(t, tile, start);
        int64_t child = pnanovdb_root_tile_get_child(t->buf, tile);
        if (child == 0) {
            float value = pnanovdb_read_float(t->buf, pnanovdb_root_tile_get_value_address(t->type, t->buf, tile));
            if (read_root_constant(t, value, start, span) != SR_OK)
                return t->file->error->status;
            continue;
        }
        uint64_t upper;
        if (!find_node(t, t->root.address.byte_offset, child, LAYOUT(t, upper_size), &upper) ||
            ++uppers > t->buf.size / LAYOUT(t, upper_size))
            return refuse(t->file, "is damaged: the root has a child outside of its grid");
        if ((span ? survey_upper(t, upper, start, span) : read_upper(t, upper, start)) != SR_OK)
            return t->file->error->status;
    }
    return SR_OK;
}

/* Sizes first, then room, then values. */
static sr_status read_tree(struct tree *t, struct sr_arena *arena)
{
    struct sr_sparse *g = t->out;
    struct span span = {{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
    if (go_through(t, &span) != SR_OK)
        return t->file->error->status;
    uint64_t entries = 1;
    for (int k = 0; k < 3; ++k) {
        if (span.hi[k] <= span.lo[k])
            return refuse(t->file, "its grid is empty");
        g->first[k] = (int32_t)span.lo[k];
        g->n[k] = (int32_t)(span.hi[k] - span.lo[k]); // below 2^25
        entries *= (uint64_t)g->n[k];
        if (entries > MOST_BLOCKS)
            return refuse(t->file, "its grid spans %d x %d x %d blocks of 128 voxels a side: at most %d are supported",
                          (int)(span.hi[0] - span.lo[0]), (int)(span.hi[1] - span.lo[1]),
                          (int)(span.hi[2] - span.lo[2]), MOST_BLOCKS);
    }
    t->table = sr_arena_alloc(arena, entries * sizeof *t->table);
    t->blocks = sr_arena_alloc(arena, (t->block_count + 1) * sizeof *t->blocks);
    t->leaves = sr_arena_alloc(arena, (t->leaf_count + 1) * sizeof *t->leaves);
    int32_t background;
    if (!t->table || !t->blocks || !t->leaves)
        return no_memory(t);
    if (add_tile(t, g->background, &background) != SR_OK)
        return t->file->error->status;
    for (uint64_t i = 0; i < entries; ++i)
        t->table[i] = background;
    t->block_count = t->leaf_count = 0;
    if (go_through(t, NULL) != SR_OK)
        return t->file->error->status;
    g->table = t->table;
    g->blocks = t->blocks;
    g->leaves = t->leaves;
    g->tiles = sr_arena_copy(arena, t->tiles.data, t->tiles.count * sizeof(float));
    g->background = check_value(t, g->background);
    return g->tiles ? SR_OK : no_memory(t);
}

/* ---- a grid ---- */

/* CRC-32 (ISO 3309) of the few bytes before the nodes. */
static uint32_t checksum(const uint8_t *data, size_t size)
{
    uint32_t crc = ~0u;
    for (size_t i = 0; i < size; ++i) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; ++bit)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

static sr_status read_map(const struct tree *t, pnanovdb_grid_handle_t grid)
{
    struct sr_sparse *g = t->out;
    const pnanovdb_map_handle_t map = pnanovdb_grid_get_map(t->buf, grid);
    const pnanovdb_coord_t least = pnanovdb_root_get_bbox_min(t->buf, t->root),
                           most = pnanovdb_root_get_bbox_max(t->buf, t->root);
    bool is_finite = true;
    memcpy(g->least, &least, sizeof g->least);
    memcpy(g->most, &most, sizeof g->most);
    for (uint32_t i = 0; i < 3; ++i) {
        g->lo[i] = pnanovdb_grid_get_world_bbox(t->buf, grid, i);
        g->hi[i] = pnanovdb_grid_get_world_bbox(t->buf, grid, 3 + i);
        if (g->least[i] > g->most[i] || !(g->lo[i] < g->hi[i]) || !isfinite(g->hi[i] - g->lo[i]))
            return refuse(t->file, "its grid has no bounding box");
        g->to_index[i][3] = 0;
        for (uint32_t j = 0; j < 3; ++j) {
            g->to_index[i][j] = pnanovdb_map_get_invmatd(t->buf, map, 3 * i + j);
            g->to_index[i][3] -= g->to_index[i][j] * pnanovdb_map_get_vecd(t->buf, map, j);
            is_finite &= isfinite(g->to_index[i][j]) != 0;
        }
        is_finite &= isfinite(g->to_index[i][3]) != 0;
    }
    return is_finite ? SR_OK
                     : refuse(t->file, "its grid has no place in space: the map of it is infinite or no number");
}

static bool is_supported(uint32_t type)
{
    return type == PNANOVDB_GRID_TYPE_FLOAT || (type >= PNANOVDB_GRID_TYPE_FP4 && type <= PNANOVDB_GRID_TYPE_FPN);
}

static sr_status read_grid(struct tree *t, struct sr_arena *arena)
{
    const pnanovdb_grid_handle_t grid = {{0}};
    uint64_t magic = pnanovdb_grid_get_magic(t->buf, grid), size = pnanovdb_grid_get_grid_size(t->buf, grid);
    uint32_t version = pnanovdb_grid_get_version(t->buf, grid);
    uint32_t class = pnanovdb_grid_get_grid_class(t->buf, grid);
    t->type = pnanovdb_grid_get_grid_type(t->buf, grid);
    if ((magic != MAGIC('0') && magic != MAGIC('1')) || size > t->buf.size)
        return refuse(t->file, "is damaged: a grid does not begin or end where it should");
    t->buf.size = size;
    if (version >> 21 != PNANOVDB_MAJOR_VERSION_NUMBER)
        return refuse(t->file, "has a grid of version %u of NanoVDB: expected 32", version >> 21);
    if (!is_supported(t->type))
        return refuse(t->file, "has values of type %u: expected float, Fp4, Fp8, Fp16 or FpN", t->type);
    if (class != PNANOVDB_GRID_CLASS_FOG_VOLUME && class != PNANOVDB_GRID_CLASS_UNKNOWN)
        return refuse(t->file, "is no volume of fog, but of class %u of NanoVDB", class);
    const pnanovdb_tree_handle_t tree = pnanovdb_grid_get_tree(t->buf, grid);
    uint64_t after_tree = tree.address.byte_offset + PNANOVDB_TREE_SIZE, root = 0;
    if (!find_node(t, tree.address.byte_offset, (int64_t)pnanovdb_tree_get_node_offset_root(t->buf, tree),
                   LAYOUT(t, root_size), &root) ||
        root < after_tree)
        return refuse(t->file, "is damaged: its tree has no root");
    t->root.address.byte_offset = root;
    t->tile_count = pnanovdb_root_get_tile_count(t->buf, t->root);
    uint64_t head_B = root + LAYOUT(t, root_size) + (uint64_t)t->tile_count * LAYOUT(t, root_tile_size);
    if (head_B > t->buf.size)
        return refuse(t->file, "is damaged: its root reaches beyond the grid");
    uint32_t expected = (uint32_t)pnanovdb_grid_get_checksum(t->buf, grid); // other versions count other bytes
    if ((version >> 10 & 2047) == PNANOVDB_MINOR_VERSION_NUMBER && expected != ~0u && root == after_tree &&
        expected != checksum(t->buf.data + 16, head_B - 16))
        return refuse(t->file, "is damaged: the checksum of its grid is wrong");
    t->out->background =
        pnanovdb_read_float(t->buf, pnanovdb_address_offset(t->root.address, LAYOUT(t, root_off_background)));
    return read_map(t, grid) == SR_OK ? read_tree(t, arena) : t->file->error->status;
}

/* ---- a file ---- */

struct meta {
    uint64_t grid_B, file_B;
    const char *name; // ends with NUL
    enum codec codec;
};

static sr_status read_packed(struct tree *t, const uint8_t *data, const struct meta *m, struct sr_arena *arena)
{
    if (m->codec == BLOSC)
        return refuse(t->file, "is packed by BLOSC: write it with the codec ZIP or NONE");
    if (m->codec == NO_CODEC) {
        t->buf = (pnanovdb_buf_t){data, m->grid_B < m->file_B ? m->grid_B : m->file_B};
        return read_grid(t, arena);
    }
    uint64_t packed_B = 0;
    if (m->file_B >= sizeof packed_B)
        memcpy(&packed_B, data, sizeof packed_B);
    if (m->codec != ZIP || m->file_B < sizeof packed_B || packed_B > m->file_B - sizeof packed_B ||
        m->grid_B / 1040 > packed_B) // deflate's most
        return refuse(t->file, "is damaged: the size of a packed grid cannot be");
    uint8_t *unpacked = sr_alloc(m->grid_B);
    if (!unpacked)
        return no_memory(t);
    sr_status status = SR_OK;
    t->buf = (pnanovdb_buf_t){unpacked, m->grid_B};
    if (!sr_inflate(data + sizeof packed_B, packed_B, unpacked, m->grid_B))
        status = refuse(t->file, "is damaged: a grid does not unpack");
    else
        status = read_grid(t, arena);
    sr_free(unpacked);
    return status;
}

static uint32_t number(const uint8_t *data, size_t size)
{
    uint32_t value = 0;
    memcpy(&value, data, size);
    return value;
}

/* The grids of a segment whose descriptions begin at *at; is_found: the wanted one was read. */
static sr_status read_segment(struct tree *t, const uint8_t *data, size_t size, size_t *at, const char *name,
                              char names[256], bool *is_found, struct sr_arena *arena)
{
    uint32_t count = number(data + *at + 12, 2);
    size_t meta = *at + SEGMENT_B, body = meta;
    for (uint32_t i = 0; i < count; ++i) { // where the grids begin
        if (size - body < META_B || size - body - META_B < number(data + body + 136, 4))
            return refuse(t->file, "is cut short among the descriptions of its grids");
        body += META_B + number(data + body + 136, 4);
    }
    for (uint32_t i = 0; i < count; ++i) {
        const uint8_t *d = data + meta;
        uint32_t name_B = number(d + 136, 4);
        struct meta m = {.codec = number(d + 168, 2), .name = (const char *)d + META_B};
        memcpy(&m.grid_B, d, 8);
        memcpy(&m.file_B, d + 8, 8);
        meta += META_B + name_B;
        if (!name_B || m.name[name_B - 1])
            return refuse(t->file, "is damaged: the name of a grid does not end");
        if (m.file_B > size - body)
            return refuse(t->file, "is cut short: the grid \"%.64s\" is not all there", m.name);
        if (strcmp(m.name, name) == 0) {
            *is_found = true;
            return read_packed(t, data + body, &m, arena);
        }
        size_t used = strlen(names);
        snprintf(names + used, 256 - used, "%s\"%.64s\"", used ? ", " : "", m.name);
        body += m.file_B;
    }
    *at = body;
    return SR_OK;
}

sr_status sr_sparse_parse(const char *path, const uint8_t *data, size_t size, const char *name, bool must,
                          bool no_negative, struct sr_sparse *out, struct sr_arena *arena, struct sr_error *error)
{
    const struct file file = {path, error};
    char names[256] = "";
    bool is_found = false;
    sr_status status = SR_OK;
    *out = (struct sr_sparse){0};
    struct tree tree = {.file = &file, .no_negative = no_negative, .out = out};
    for (size_t at = 0; (at == 0 || at < size) && status == SR_OK && !is_found;) {
        uint64_t magic = 0;
        if (size - at >= SEGMENT_B)
            memcpy(&magic, data + at, sizeof magic);
        if (magic != MAGIC('0') && magic != MAGIC('2'))
            status = refuse(&file, at ? "is cut short, or damaged after its first grids" : "is no NanoVDB file");
        else if (number(data + at + 8, 4) >> 21 != PNANOVDB_MAJOR_VERSION_NUMBER)
            status = refuse(&file, "is of version %u of NanoVDB: expected 32", number(data + at + 8, 4) >> 21);
        else
            status = read_segment(&tree, data, size, &at, name, names, &is_found, arena);
    }
    sr_array_free(&tree.tiles);
    if (status == SR_OK && !is_found && must)
        return refuse(&file, "has no grid \"%s\"; it has %s", name, names[0] ? names : "none");
    return status;
}

sr_status sr_sparse_read(const char *path, const char *name, bool must, bool no_negative, struct sr_sparse *out,
                         struct sr_arena *arena, struct sr_error *error)
{
    char *data;
    size_t size;
    if (sr_file_read(path, (size_t)1 << 36, &data, &size, error) != SR_OK)
        return error->status;
    sr_status status = sr_sparse_parse(path, (const uint8_t *)data, size, name, must, no_negative, out, arena, error);
    sr_free(data);
    return status;
}
