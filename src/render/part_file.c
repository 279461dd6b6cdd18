/* SPDX-License-Identifier: MIT */
/* Parts of a picture as files: a store (store/store.h) of the kind "part".
 *
 *     identity   lines "key value": what makes the bytes of the picture
 *     about      what else is to be told of the picture, as the writer likes
 *     head       struct head
 *     nodes      struct node_head for each node of the samples' trees
 *     colours N, firsts N, buckets N   sums of the N-th node, pixel by pixel
 *     splats     struct splats_head, then integers of 128 bits [pixel][channel][group]
 *
 * Nothing of a file is believed: sizes are compared before memory is taken for them, numbers before they are used.
 * Limits: SR_STORE_SECTIONS sections, so that a part has about 1300 nodes at most. */
#include "render/part.h"

#include <stdio.h>
#include <string.h>

static const char KIND[] = "part", WORDS[] = "the part is not one that this version writes";

struct head {
    int32_t width, height, x0, x1, y0, y1, space;
    float iso, exposure_time, white_balance, max_component;
    uint32_t camera1, buckets;
    float lambda_min, lambda_max, bucket_scale;
    uint32_t is_gbuffer, has_aov, spp, replicates, blocks, groups;
    uint32_t dropped_x, dropped_y, dropped_sample, dropped_replicate;
    uint64_t paths, rays, shadow_rays, vertices, dropped;
};
struct node_head {
    uint32_t block, begin, count;
};
struct splats_head {
    uint64_t dropped, paths[SR_SPLAT_GROUPS];
    double unit;
};
_Static_assert(sizeof(struct head) == 26 * 4 + 5 * 8 && sizeof(struct node_head) == 12, "written as they stand");
enum { NAME = SR_STORE_NAME, MOST_BUCKETS = 1 << 16 };

static const char *name_of(const char *what, size_t number, char name[NAME])
{
    snprintf(name, NAME, "%s %zu", what, number);
    return name;
}

static size_t words_B(const struct sr_film *film)
{
    return (size_t)film->width * film->height * sr_film_splats_B(film->splats->groups);
}

/* ---- writing ---- */

static struct head head_of(const struct sr_render_part *part)
{
    const struct sr_film_settings *f = &part->film->settings;
    const struct sr_render_report *r = &part->report;
    return (struct head){
        .width = f->width,
        .height = f->height,
        .x0 = f->x0,
        .x1 = f->x1,
        .y0 = f->y0,
        .y1 = f->y1,
        .space = (int32_t)f->space,
        .iso = f->iso,
        .exposure_time = f->exposure_time,
        .white_balance = f->white_balance,
        .max_component = f->max_component,
        .camera1 = f->camera1,
        .buckets = f->buckets,
        .lambda_min = f->lambda_min,
        .lambda_max = f->lambda_max,
        .bucket_scale = f->bucket_scale,
        .is_gbuffer = f->is_gbuffer,
        .has_aov = part->film->has_aov,
        .spp = part->spp,
        .replicates = part->replicates,
        .blocks = part->blocks,
        .groups = part->film->splats ? part->film->splats->groups : 0,
        .dropped_x = r->dropped_x,
        .dropped_y = r->dropped_y,
        .dropped_sample = r->dropped_sample,
        .dropped_replicate = r->dropped_replicate,
        .paths = r->paths,
        .rays = r->rays,
        .shadow_rays = r->shadow_rays,
        .vertices = r->vertices,
        .dropped = r->dropped,
    };
}

sr_status sr_part_put(struct sr_store_out *out, const struct sr_render_part *part, struct sr_error *error)
{
    size_t pixels = sr_part_pixels(part);
    char name[NAME];
    struct node_head *nodes = sr_alloc(part->node_count * sizeof *nodes);
    if (!nodes)
        return sr_part_no_memory(error);
    for (size_t i = 0; i < part->node_count; ++i)
        nodes[i] = (struct node_head){part->nodes[i].block, part->nodes[i].begin, part->nodes[i].count};
    sr_store_put(out, "nodes", nodes, part->node_count * sizeof *nodes, error);
    sr_free(nodes);
    for (size_t i = 0; i < part->node_count && error->status == SR_OK; ++i) {
        const struct part_node *n = &part->nodes[i];
        sr_store_put(out, name_of("colours", i, name), n->colours, pixels * sizeof *n->colours, error);
        if (n->firsts)
            sr_store_put(out, name_of("firsts", i, name), n->firsts, pixels * sizeof *n->firsts, error);
        if (n->buckets)
            sr_store_put(out, name_of("buckets", i, name), n->buckets,
                         pixels * part->film->settings.buckets * sizeof *n->buckets, error);
    }
    return error->status;
}

static void put_splats(struct sr_store_out *out, const struct sr_film *film, struct sr_error *error)
{
    const struct sr_film_splats *s = film->splats;
    struct splats_head head = {.dropped = s->dropped, .unit = s->unit};
    memcpy(head.paths, s->paths, sizeof head.paths);
    sr_store_put(out, "splats", &head, sizeof head, error);
    sr_store_put(out, "splat words", s->words, words_B(film), error);
}

sr_status sr_render_part_write(const struct sr_render_part *part, const char *identity, const char *about,
                               const char *path, struct sr_error *error)
{
    size_t kinds = 1 + (size_t)part->film->has_aov + (part->film->settings.buckets > 0);
    if (part->node_count * kinds + 8 > SR_STORE_SECTIONS)
        return sr_fail(
            error, SR_ERROR_RESOURCE,
            "%s: the part has %zu sums for each pixel, a file holds %zu: parts of fewer samples were expected", path,
            part->node_count, (SR_STORE_SECTIONS - 8) / kinds);
    struct sr_store_out *out;
    if (sr_store_create(path, KIND, &out, error) != SR_OK)
        return error->status;
    struct head head = head_of(part);
    sr_store_put(out, "identity", identity, strlen(identity) + 1, error);
    sr_store_put(out, "about", about, strlen(about) + 1, error);
    sr_store_put(out, "head", &head, sizeof head, error);
    sr_part_put(out, part, error);
    if (part->film->splats)
        put_splats(out, part->film, error);
    if (error->status == SR_OK)
        return sr_store_finish(out, false, error);
    sr_store_abandon(out);
    return error->status;
}

/* ---- reading ---- */

/* The section if it has this many bytes, else NULL and the error. */
static const void *get(const struct sr_store_in *in, const char *name, uint64_t size, struct sr_error *error)
{
    size_t B = 0;
    const void *data = sr_store_get(in, name, &B);
    if (data && B == size)
        return data;
    sr_fail(error, SR_ERROR_INPUT, "%s: \"%s\" has %zu bytes instead of %llu", WORDS, name, data ? B : 0,
            (unsigned long long)size);
    return NULL;
}

static char *get_text(const struct sr_store_in *in, const char *name, struct sr_error *error)
{
    size_t B = 0;
    const char *data = sr_store_get(in, name, &B);
    char *text = NULL;
    if (!data || B == 0 || memchr(data, 0, B) != data + B - 1)
        sr_fail(error, SR_ERROR_INPUT, "%s: \"%s\" is no text", WORDS, name);
    else if ((text = sr_alloc(B)))
        memcpy(text, data, B);
    else
        sr_part_no_memory(error);
    return text;
}

static bool is_camera(uint32_t camera1)
{
    for (uint32_t i = 0; i < camera1; ++i)
        if (!sr_film_camera_name((int)i))
            return false;
    return true;
}

/* Whether all numbers of a head are within what a job can have. */
static bool is_sound(const struct head *h)
{
    int64_t w = (int64_t)h->x1 - h->x0, height = (int64_t)h->y1 - h->y0;
    bool has_blocks = h->blocks >= 1 && h->blocks <= h->spp && h->spp <= 1u << 30;
    bool has_replicates = h->replicates == 0 || (h->replicates == h->blocks && h->spp % h->replicates == 0);
    return w > 0 && height > 0 && w <= 1 << 20 && height <= 1 << 20 && h->space >= 0 &&
           h->space < SR_COLOUR_SPACE_COUNT && h->buckets <= MOST_BUCKETS && h->is_gbuffer <= 1 && h->has_aov <= 1 &&
           is_camera(h->camera1) && has_blocks && has_replicates &&
           (h->groups == 0 || (h->groups >= 2 && h->groups <= SR_SPLAT_GROUPS));
}

static void get_splats(const struct sr_store_in *in, struct sr_film *film, uint32_t groups, struct sr_error *error)
{
    uint64_t size = (uint64_t)film->width * film->height * sr_film_splats_B(groups);
    const struct splats_head *head = get(in, "splats", sizeof *head, error);
    const void *words = get(in, "splat words", size, error);
    if (!head || !words)
        return;
    int exponent;
    if (!(frexp(head->unit, &exponent) == 0.5)) {
        sr_fail(error, SR_ERROR_INPUT, "the unit of its splats is %g: a power of two was expected", head->unit);
        return;
    }
    if (sr_film_add_splats(film, groups, head->unit, error) != SR_OK)
        return;
    memcpy(film->splats->paths, head->paths, sizeof head->paths);
    film->splats->dropped = head->dropped;
    memcpy(film->splats->words, words, size);
}

/* One kind of a node's sums. */
static void get_sums(const struct sr_store_in *in, const char *what, size_t number, void *to, uint64_t size,
                     struct sr_error *error)
{
    char name[NAME];
    const void *from = get(in, name_of(what, number, name), size, error);
    if (from)
        memcpy(to, from, size);
}

static void get_all_sums(const struct sr_store_in *in, struct sr_render_part *part, size_t i, struct sr_error *error)
{
    struct part_node *n = &part->nodes[i];
    size_t pixels = sr_part_pixels(part);
    get_sums(in, "colours", i, n->colours, pixels * sizeof *n->colours, error);
    if (n->firsts)
        get_sums(in, "firsts", i, n->firsts, pixels * sizeof *n->firsts, error);
    if (n->buckets)
        get_sums(in, "buckets", i, n->buckets, pixels * part->film->settings.buckets * sizeof *n->buckets, error);
}

sr_status sr_part_get(const struct sr_store_in *in, const char *path, struct sr_render_part *part,
                      struct sr_error *error)
{
    struct sr_error own = {0};
    const struct node_head *nodes = get(in, "nodes", part->node_count * sizeof *nodes, &own);
    for (size_t i = 0; i < part->node_count && own.status == SR_OK; ++i) {
        const struct part_node *n = &part->nodes[i];
        if (nodes[i].block != n->block || nodes[i].begin != n->begin || nodes[i].count != n->count)
            sr_fail(&own, SR_ERROR_INPUT, "%s", WORDS);
        else
            get_all_sums(in, part, i, &own);
    }
    return own.status ? sr_fail(error, own.status, "%s: %s", path, own.text) : SR_OK;
}

static void get_node(const struct sr_store_in *in, struct sr_render_part *part, struct node_head head,
                     struct sr_error *error)
{
    size_t i = part->node_count;
    struct part_node *n = &part->nodes[i];
    *n = (struct part_node){.block = head.block, .begin = head.begin, .count = head.count};
    bool is_after =
        i == 0 || n[-1].block < n->block || (n[-1].block == n->block && n[-1].begin + n[-1].count <= n->begin);
    if (!is_after || !sr_part_node_is_valid(part, n)) {
        sr_fail(error, SR_ERROR_INPUT, "%s: samples %u+%u of block %u", WORDS, n->begin, n->count, n->block);
        return;
    }
    part->node_count += 1;
    if (sr_part_node_alloc(part, n))
        get_all_sums(in, part, i, error);
    else
        sr_part_no_memory(error);
}

static void get_part(const struct sr_store_in *in, struct sr_render_part *part, struct sr_error *error)
{
    const struct head *h = get(in, "head", sizeof *h, error);
    part->identity = h ? get_text(in, "identity", error) : NULL;
    part->about = h ? get_text(in, "about", error) : NULL;
    size_t B = 0, count;
    const struct node_head *nodes = sr_store_get(in, "nodes", &B);
    count = B / sizeof *nodes;
    if (error->status == SR_OK &&
        (!is_sound(h) || !nodes || count == 0 || count > SR_STORE_SECTIONS || B % sizeof *nodes != 0))
        sr_fail(error, SR_ERROR_INPUT, "%s", WORDS);
    if (error->status != SR_OK)
        return;
    struct sr_film_settings f = {.width = h->width,
                                 .height = h->height,
                                 .x0 = h->x0,
                                 .x1 = h->x1,
                                 .y0 = h->y0,
                                 .y1 = h->y1,
                                 .space = (enum sr_colour_space_id)h->space,
                                 .iso = h->iso,
                                 .exposure_time = h->exposure_time,
                                 .white_balance = h->white_balance,
                                 .max_component = h->max_component,
                                 .camera1 = h->camera1,
                                 .buckets = h->buckets,
                                 .lambda_min = h->lambda_min,
                                 .lambda_max = h->lambda_max,
                                 .bucket_scale = h->bucket_scale,
                                 .is_gbuffer = h->is_gbuffer};
    // the file is as large as the picture, or the picture is not believed
    uint64_t pixels = (uint64_t)((int64_t)h->x1 - h->x0) * (uint64_t)((int64_t)h->y1 - h->y0);
    if (!get(in, "colours 0", pixels * sizeof(struct part_colour), error) ||
        (h->has_aov && !get(in, "firsts 0", pixels * sizeof(struct part_first), error)) ||
        (h->buckets && !get(in, "buckets 0", pixels * h->buckets * sizeof(double), error)) ||
        sr_film_create(&f, h->has_aov, &part->film, error) != SR_OK)
        return;
    part->spp = h->spp, part->replicates = h->replicates, part->blocks = h->blocks;
    part->report = (struct sr_render_report){.paths = h->paths,
                                             .rays = h->rays,
                                             .shadow_rays = h->shadow_rays,
                                             .vertices = h->vertices,
                                             .dropped = h->dropped,
                                             .dropped_x = h->dropped_x,
                                             .dropped_y = h->dropped_y,
                                             .dropped_sample = h->dropped_sample,
                                             .dropped_replicate = h->dropped_replicate};
    if (h->groups)
        get_splats(in, part->film, h->groups, error);
    part->nodes = sr_alloc(count * sizeof *part->nodes);
    if (!part->nodes)
        sr_part_no_memory(error);
    for (size_t i = 0; i < count && error->status == SR_OK; ++i)
        get_node(in, part, nodes[i], error);
}

sr_status sr_render_part_read(const char *path, struct sr_render_part **out, struct sr_error *error)
{
    *out = NULL;
    struct sr_store_in *in;
    if (sr_store_open(path, KIND, &in, error) != SR_OK)
        return error->status;
    struct sr_render_part *part = sr_alloc(sizeof *part);
    struct sr_error own = {0};
    if (part)
        get_part(in, part, &own);
    else
        sr_part_no_memory(&own);
    sr_store_close(in);
    if (own.status == SR_OK) {
        *out = part;
        return SR_OK;
    }
    sr_render_part_destroy(part);
    return sr_fail(error, own.status, "%s: %s", path, own.text);
}
