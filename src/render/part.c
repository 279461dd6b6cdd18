/* SPDX-License-Identifier: MIT */
/* Parts of a picture: sums of some of its samples, which become the whole picture's to the last bit.
 *
 *     a part = { S(level, k) of the largest nodes that lie within its samples },
 *         S(level, k) = S(level - 1, 2 k) + S(level - 1, 2 k + 1)
 *
 * The tree is that of block_tree.c. Two halves of a node are joined wherever both are there, so that the order of parts
 * does not matter; a block whose samples are all there is folded as an uncut one. Splats are integers (film/splat.c)
 * and add. Limits: for each pixel a part holds as many sums as it has nodes: 2 log2(n) of a cut block, and one of each
 * whole block. */
#include "render/part.h"

#include <string.h>

sr_status sr_part_no_memory(struct sr_error *error)
{
    return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a part of the picture");
}

/* Number of a block's first sample. */
static uint64_t begin_of(uint32_t spp, uint32_t blocks, uint32_t block)
{
    return (uint64_t)spp * block / blocks;
}

size_t sr_part_pixels(const struct sr_render_part *part)
{
    return (size_t)part->film->width * part->film->height;
}

static uint64_t block_begin(const struct sr_render_part *part, uint32_t block)
{
    return begin_of(part->spp, part->blocks, block);
}

uint32_t sr_part_block_size(const struct sr_render_part *part, uint32_t block)
{
    return (uint32_t)(block_begin(part, block + 1) - block_begin(part, block));
}

bool sr_part_node_alloc(const struct sr_render_part *part, struct part_node *node)
{
    size_t pixels = sr_part_pixels(part);
    uint32_t buckets = part->film->settings.buckets;
    node->colours = sr_alloc(pixels * sizeof *node->colours);
    node->firsts = part->film->has_aov ? sr_alloc(pixels * sizeof *node->firsts) : NULL;
    node->buckets = buckets ? sr_alloc(pixels * buckets * sizeof *node->buckets) : NULL;
    return node->colours && (node->firsts || !part->film->has_aov) && (node->buckets || !buckets);
}

void sr_part_node_free(struct part_node *node)
{
    sr_free(node->colours);
    sr_free(node->firsts);
    sr_free(node->buckets);
    node->colours = NULL, node->firsts = NULL, node->buckets = NULL;
}

static bool is_power_of_two(uint32_t n)
{
    return n && (n & (n - 1)) == 0;
}

bool sr_part_node_is_valid(const struct sr_render_part *part, const struct part_node *node)
{
    if (node->block >= part->blocks)
        return false;
    uint32_t n = sr_part_block_size(part, node->block);
    if (node->begin == 0 && node->count == n)
        return true;
    return is_power_of_two(node->count) && node->begin % node->count == 0 && node->begin < n &&
           node->count <= n - node->begin;
}

void sr_render_part_destroy(struct sr_render_part *part)
{
    if (!part)
        return;
    for (size_t i = 0; i < part->node_count; ++i)
        sr_part_node_free(&part->nodes[i]);
    sr_free(part->nodes);
    sr_film_destroy(part->film);
    sr_free(part->identity);
    sr_free(part->about);
    sr_free(part);
}

/* ---- a pixel's sums as the film has them, and as they are kept ---- */

static void keep_vector(float to[3], sr_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

static void keep(struct part_node *node, size_t pixel, const struct sr_film_block *b)
{
    struct part_colour *c = &node->colours[pixel];
    memcpy(c->rgb, b->rgb, sizeof c->rgb);
    c->largest = b->largest;
    c->dropped = b->dropped;
    if (!node->firsts)
        return;
    const struct sr_first_hit *s = &b->first_sum;
    struct part_first *f = &node->firsts[pixel];
    *f = (struct part_first){.depth = s->depth,
                             .uv = {s->uv.x, s->uv.y},
                             .dzdx = s->dzdx,
                             .dzdy = s->dzdy,
                             .material = s->material,
                             .object = s->object,
                             .hits = b->hits,
                             .samples_seen = b->samples_seen};
    memcpy(f->square, b->square, sizeof f->square);
    memcpy(f->albedo, s->albedo, sizeof f->albedo);
    memcpy(f->rgb, s->rgb, sizeof f->rgb);
    keep_vector(f->n, s->n);
    keep_vector(f->ns, s->ns);
    keep_vector(f->p, s->p);
}

static struct sr_film_block kept(const struct part_node *node, size_t pixel)
{
    const struct part_colour *c = &node->colours[pixel];
    struct sr_film_block b = {.n = node->count, .dropped = c->dropped, .largest = c->largest};
    memcpy(b.rgb, c->rgb, sizeof b.rgb);
    if (!node->firsts)
        return b;
    const struct part_first *f = &node->firsts[pixel];
    b.first_sum = (struct sr_first_hit){.n = {f->n[0], f->n[1], f->n[2]},
                                        .ns = {f->ns[0], f->ns[1], f->ns[2]},
                                        .p = {f->p[0], f->p[1], f->p[2]},
                                        .depth = f->depth,
                                        .uv = {f->uv[0], f->uv[1]},
                                        .material = f->material,
                                        .object = f->object,
                                        .dzdx = f->dzdx,
                                        .dzdy = f->dzdy};
    memcpy(b.first_sum.albedo, f->albedo, sizeof f->albedo);
    memcpy(b.first_sum.rgb, f->rgb, sizeof f->rgb);
    memcpy(b.square, f->square, sizeof b.square);
    b.hits = f->hits;
    b.samples_seen = f->samples_seen;
    return b;
}

/* ---- what a render fills ---- */

/* Calls visit for each node of the samples in range, by block and begin. */
static void visit_nodes(uint32_t spp, uint32_t blocks, struct sr_render_range range,
                        void (*visit)(void *context, struct part_node node), void *context)
{
    for (uint32_t b = 0; b < blocks; ++b) {
        uint64_t first = begin_of(spp, blocks, b), end = begin_of(spp, blocks, b + 1);
        uint32_t n = (uint32_t)(end - first), at = range.begin > first ? (uint32_t)(range.begin - first) : 0;
        uint32_t to = range.end < end ? range.end > first ? (uint32_t)(range.end - first) : 0 : n;
        while (at < to) {
            uint32_t size = 1;
            while (at % (2 * size) == 0 && to - at >= 2 * size)
                size *= 2;
            if (at == 0 && to == n)
                size = n;
            visit(context, (struct part_node){.block = b, .begin = at, .count = size});
            at += size;
        }
    }
}

static void count_node(void *context, struct part_node node)
{
    (void)node;
    *(uint64_t *)context += 1;
}

uint64_t sr_part_nodes(uint32_t spp, uint32_t blocks, struct sr_render_range range)
{
    uint64_t count = 0;
    visit_nodes(spp, blocks, range, count_node, &count);
    return count;
}

size_t sr_part_node_B(const struct sr_render_job *job)
{
    return sizeof(struct part_colour) + (job->with_aov || job->film.is_gbuffer ? sizeof(struct part_first) : 0) +
           job->film.buckets * sizeof(double);
}

static void make_node(void *context, struct part_node node)
{
    struct sr_render_part *part = context;
    struct part_node *n = &part->nodes[part->node_count++];
    *n = node;
    if (!sr_part_node_alloc(part, n))
        sr_part_node_free(n);
}

sr_status sr_part_create(const struct sr_render_job *job, uint32_t blocks, struct sr_render_range range,
                         struct sr_render_part **out, struct sr_error *error)
{
    *out = NULL;
    struct sr_render_part *part = sr_alloc(sizeof *part);
    if (!part)
        return sr_part_no_memory(error);
    *part = (struct sr_render_part){.spp = job->spp, .replicates = job->replicates, .blocks = blocks};
    if (sr_film_create(&job->film, job->with_aov, &part->film, error) == SR_OK) {
        part->nodes = sr_alloc(sr_part_nodes(job->spp, blocks, range) * sizeof *part->nodes);
        if (part->nodes)
            visit_nodes(job->spp, blocks, range, make_node, part);
        bool is_done = part->nodes != NULL;
        for (size_t i = 0; i < part->node_count; ++i)
            is_done &= part->nodes[i].colours != NULL;
        if (!is_done)
            sr_part_no_memory(error);
    }
    if (error->status == SR_OK)
        *out = part;
    else
        sr_render_part_destroy(part);
    return error->status;
}

struct sr_film *sr_part_splats_film(struct sr_render_part *part)
{
    return part->film;
}

struct sr_render_report *sr_part_report(struct sr_render_part *part)
{
    return &part->report;
}

static size_t first_node_of(const struct sr_render_part *part, uint32_t block)
{
    size_t lo = 0, hi = part->node_count;
    while (lo < hi) {
        size_t middle = (lo + hi) / 2;
        if (part->nodes[middle].block < block)
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo;
}

void sr_part_keep(struct sr_render_part *part, uint32_t block, uint32_t x, uint32_t y, const struct sr_block_tree *tree)
{
    size_t pixel = (size_t)y * part->film->width + x, first = first_node_of(part, block);
    for (uint32_t i = 0; i < tree->depth; ++i) {
        struct part_node *node = &part->nodes[first + i];
        keep(node, pixel, &tree->nodes[i]);
        if (node->buckets)
            memcpy(node->buckets + pixel * tree->bucket_count, tree->buckets + (size_t)i * tree->bucket_count,
                   tree->bucket_count * sizeof *node->buckets);
    }
}

/* ---- joining ---- */

/* Node b, which follows, becomes a part of a. */
static void join_nodes(const struct sr_render_part *part, struct part_node *a, struct part_node *b)
{
    size_t pixels = sr_part_pixels(part), buckets = part->film->settings.buckets;
    for (size_t i = 0; i < pixels; ++i) {
        struct sr_film_block left = kept(a, i), right = kept(b, i);
        sr_film_block_join(&left, &right);
        keep(a, i, &left);
    }
    for (size_t i = 0; i < pixels * buckets; ++i)
        a->buckets[i] += b->buckets[i];
    a->count += b->count;
    sr_part_node_free(b);
}

static bool are_halves(const struct part_node *a, const struct part_node *b)
{
    return a->block == b->block && a->count == b->count && is_power_of_two(a->count) &&
           a->begin % (2 * (uint64_t)a->count) == 0 && a->begin + a->count == b->begin;
}

static void remove_node(struct sr_render_part *part, size_t i)
{
    memmove(&part->nodes[i], &part->nodes[i + 1], (part->node_count - i - 1) * sizeof *part->nodes);
    part->node_count -= 1;
}

/* Joins what has become complete about node i. */
static void join_about(struct sr_render_part *part, size_t i)
{
    uint32_t block = part->nodes[i].block;
    for (;;) {
        if (i + 1 < part->node_count && are_halves(&part->nodes[i], &part->nodes[i + 1])) {
            join_nodes(part, &part->nodes[i], &part->nodes[i + 1]);
            remove_node(part, i + 1);
        } else if (i > 0 && are_halves(&part->nodes[i - 1], &part->nodes[i])) {
            --i;
        } else {
            break;
        }
    }
    // all of the block, which is no full tree
    size_t first = first_node_of(part, block), end = first;
    uint32_t at = 0;
    while (end < part->node_count && part->nodes[end].block == block && part->nodes[end].begin == at)
        at += part->nodes[end++].count;
    if (at == sr_part_block_size(part, block))
        for (; end - first > 1; --end) {
            join_nodes(part, &part->nodes[end - 2], &part->nodes[end - 1]);
            remove_node(part, end - 1);
        }
}

static bool put_node(struct sr_render_part *part, struct part_node *node)
{
    size_t i = first_node_of(part, node->block);
    while (i < part->node_count && part->nodes[i].block == node->block && part->nodes[i].begin < node->begin)
        ++i;
    struct part_node *grown =
        sr_realloc(part->nodes, part->node_count * sizeof *grown, (part->node_count + 1) * sizeof *grown);
    if (!grown)
        return false;
    part->nodes = grown;
    memmove(&grown[i + 1], &grown[i], (part->node_count - i) * sizeof *grown);
    part->node_count += 1;
    grown[i] = *node;
    *node = (struct part_node){0};
    join_about(part, i);
    return true;
}

static void add_splats(struct sr_film_splats *a, const struct sr_film_splats *b, size_t pixels)
{
    for (size_t i = 0; i < pixels * 3 * a->groups; ++i) {
        uint64_t low = a->words[2 * i] + b->words[2 * i];
        a->words[2 * i + 1] += b->words[2 * i + 1] + (low < b->words[2 * i]);
        a->words[2 * i] = low;
    }
    for (uint32_t g = 0; g < a->groups; ++g)
        a->paths[g] += b->paths[g];
    a->dropped += b->dropped;
}

/* Samples of the camera's that were dropped: the first of them is told. */
static bool tells_dropped(const struct sr_render_part *part)
{
    return part->report.dropped > (part->film->splats ? part->film->splats->dropped : 0);
}

static void add_report(struct sr_render_part *to, const struct sr_render_part *from)
{
    struct sr_render_report *a = &to->report;
    const struct sr_render_report *b = &from->report;
    uint32_t first_a[4] = {a->dropped_x, a->dropped_y, a->dropped_replicate, a->dropped_sample};
    uint32_t first_b[4] = {b->dropped_x, b->dropped_y, b->dropped_replicate, b->dropped_sample};
    if (tells_dropped(from) && (!tells_dropped(to) || sr_render_is_earlier(first_b, first_a)))
        a->dropped_x = first_b[0], a->dropped_y = first_b[1], a->dropped_replicate = first_b[2],
        a->dropped_sample = first_b[3];
    a->paths += b->paths;
    a->rays += b->rays;
    a->shadow_rays += b->shadow_rays;
    a->vertices += b->vertices;
    a->dropped += b->dropped;
}

static struct sr_render_range range_of(const struct sr_render_part *part, size_t node)
{
    uint32_t begin = (uint32_t)block_begin(part, part->nodes[node].block) + part->nodes[node].begin;
    return (struct sr_render_range){begin, begin + part->nodes[node].count};
}

bool sr_render_part_range(const struct sr_render_part *part, size_t number, struct sr_render_range *out)
{
    size_t i = 0;
    for (size_t k = 0; i < part->node_count; ++k) {
        *out = range_of(part, i);
        for (++i; i < part->node_count && range_of(part, i).begin == out->end; ++i)
            out->end = range_of(part, i).end;
        if (k == number)
            return true;
    }
    return false;
}

sr_status sr_render_part_add(struct sr_render_part *to, struct sr_render_part *from, struct sr_error *error)
{
    if (to->spp != from->spp || to->blocks != from->blocks || to->replicates != from->replicates ||
        to->film->width != from->film->width || to->film->height != from->film->height ||
        to->film->has_aov != from->film->has_aov || to->film->settings.buckets != from->film->settings.buckets ||
        !to->film->splats != !from->film->splats ||
        (to->film->splats && (to->film->splats->groups != from->film->splats->groups ||
                              to->film->splats->unit != from->film->splats->unit)))
        return sr_fail(error, SR_ERROR_INPUT, "the parts are not of one picture");
    struct sr_render_range a, b;
    for (size_t i = 0; sr_render_part_range(to, i, &a); ++i)
        for (size_t k = 0; sr_render_part_range(from, k, &b); ++k)
            if (a.begin < b.end && b.begin < a.end)
                return sr_fail(error, SR_ERROR_INPUT, "samples %u-%u are in both parts",
                               a.begin > b.begin ? a.begin : b.begin, a.end < b.end ? a.end : b.end);
    add_report(to, from);
    if (to->film->splats)
        add_splats(to->film->splats, from->film->splats, sr_part_pixels(to));
    for (size_t i = 0; i < from->node_count; ++i)
        if (!put_node(to, &from->nodes[i]))
            return sr_part_no_memory(error);
    return SR_OK;
}

/* ---- a picture ---- */

bool sr_render_part_is_complete(const struct sr_render_part *part)
{
    struct sr_render_range r;
    return sr_render_part_range(part, 0, &r) && r.begin == 0 && r.end == part->spp;
}

struct sr_film *sr_render_part_film(struct sr_render_part *part)
{
    struct sr_film *film = part->film;
    uint32_t buckets = film->settings.buckets;
    memset(film->pixels, 0, sr_part_pixels(part) * sizeof *film->pixels);
    if (film->has_aov)
        memset(film->aov, 0, sr_part_pixels(part) * sizeof *film->aov);
    if (buckets)
        memset(film->buckets, 0, sr_part_pixels(part) * buckets * sizeof *film->buckets);
    for (size_t i = 0; i < part->node_count; ++i)
        for (uint32_t y = 0; y < film->height; ++y)
            for (uint32_t x = 0; x < film->width; ++x) {
                size_t pixel = (size_t)y * film->width + x;
                struct sr_film_block b = kept(&part->nodes[i], pixel);
                sr_film_store(film, x, y, &b);
                if (buckets)
                    sr_film_store_buckets(film, x, y, part->nodes[i].buckets + pixel * buckets);
            }
    part->report.is_complete = sr_render_part_is_complete(part);
    return film;
}

/* ---- what it is of ---- */

const struct sr_render_report *sr_render_part_report(const struct sr_render_part *part)
{
    return &part->report;
}

bool sr_render_part_is_replicated(const struct sr_render_part *part)
{
    return part->replicates > 0;
}

uint32_t sr_render_part_spp(const struct sr_render_part *part)
{
    return part->spp;
}

const char *sr_render_part_identity(const struct sr_render_part *part)
{
    return part->identity;
}

const char *sr_render_part_about(const struct sr_render_part *part)
{
    return part->about;
}
