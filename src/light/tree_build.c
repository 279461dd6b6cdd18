/* SPDX-License-Identifier: MIT */
/* Building the tree of lights: ranges of lights are split where
 *
 *     cost = SUM over both sides  power * spread * extent^2 * (largest extent / extent along the split)
 *
 * is least among 12 bins along each axis (surface area and orientation heuristic of Conty Estevez & Kulla 2018; spread
 * ~ 2 pi (1 - cos_theta_o) + pi (1 - cos_theta_e) stands for their solid angle, extent^2 for their area). Two splits after
 * another make nodes of eight; the bounds that are stored come afterwards, from below, in double and rounded outward.
 * Limits: one thread; about a second for a million lights. */
#include "light/tree.h"

#define WIDTH SR_LIGHT_TREE_WIDTH
#define BINS 12

struct item {
    struct sr_box box;
    sr_vec3 axis;
    float cos_o, cos_e;
    float power; // of one side; negative: two sides glow
    uint32_t light;
};

struct range {
    uint32_t begin, end;
};

struct build {
    struct item *items;
    struct sr_array nodes;
    uint32_t *place;
    float slop; // [m] rounding of coordinates of this size
    bool has_memory;
};

// a part of the lights while a split is sought
struct part {
    struct sr_box box;
    sr_vec3 axes;
    float cos_o, cos_e, power;
    uint32_t count;
};

static sr_vec3 centre_of(const struct item *i)
{
    return sr_scale(0.5f, sr_add(i->box.lo, i->box.hi));
}

static struct sr_box grow(struct sr_box a, struct sr_box b)
{
    return (struct sr_box){{fminf(a.lo.x, b.lo.x), fminf(a.lo.y, b.lo.y), fminf(a.lo.z, b.lo.z)},
                           {fmaxf(a.hi.x, b.hi.x), fmaxf(a.hi.y, b.hi.y), fmaxf(a.hi.z, b.hi.z)}};
}

static struct part empty_part(void)
{
    return (struct part){.box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}, .cos_o = 1, .cos_e = 1};
}

static void join(struct part *a, const struct part *b)
{
    a->box = grow(a->box, b->box);
    a->axes = sr_add(a->axes, b->axes);
    a->cos_o = fminf(a->cos_o, b->cos_o);
    a->cos_e = fminf(a->cos_e, b->cos_e);
    a->power += b->power;
    a->count += b->count;
}

static struct part part_of(const struct item *i)
{
    // two-sided ones count with whichever side is up, so that opposite normals agree
    bool is_turned = i->power < 0 && (i->axis.z < 0 || (i->axis.z == 0 && (i->axis.y < 0 || (i->axis.y == 0 && i->axis.x < 0))));
    return (struct part){i->box, is_turned ? sr_neg(i->axis) : i->axis, i->cos_o, i->cos_e, fabsf(i->power), 1};
}

static float cost_of(const struct part *a)
{
    // axes spread evenly over a cap have the mean (1 + cos) / 2; the widest of their own cones comes on top
    float mean = fminf(sr_length(a->axes) / (float)a->count, 1);
    float cos_cap = fmaxf(2 * mean - 1, -1), sin_cap = sr_safe_sqrt(1 - cos_cap * cos_cap);
    float sin_o = sr_safe_sqrt(1 - a->cos_o * a->cos_o);
    bool is_all = sin_cap * a->cos_o + cos_cap * sin_o < 0;
    float cos_o = is_all ? -1 : cos_cap * a->cos_o - sin_cap * sin_o;
    float spread = 2 * SR_PI * (1 - cos_o) + SR_PI * (1 - a->cos_e);
    return a->power * spread * sr_length2(sr_sub(a->box.hi, a->box.lo));
}

static int bin_of(float x, float lo, float scale)
{
    int i = (int)((x - lo) * scale);
    return i < 0 ? 0 : i < BINS ? i : BINS - 1;
}

// a place to divide the range, both sides non-empty; reorders the range
static uint32_t split(struct build *b, struct range range)
{
    struct item *items = b->items;
    struct sr_box centres = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = range.begin; i < range.end; ++i) {
        sr_vec3 c = centre_of(&items[i]);
        centres = grow(centres, (struct sr_box){c, c});
    }
    sr_vec3 extent = sr_sub(centres.hi, centres.lo);
    float largest = sr_max_component(extent), best_cost = INFINITY, best_limit = 0;
    int best_axis = -1;
    struct part bins[3][BINS];
    float scale[3];
    for (int a = 0; a < 3; ++a) {
        scale[a] = sr_component(extent, a) > 1e-6f * largest ? (float)BINS / sr_component(extent, a) : 0;
        for (int k = 0; k < BINS; ++k)
            bins[a][k] = empty_part();
    }
    for (uint32_t i = range.begin; largest > 0 && i < range.end; ++i) {
        struct part one = part_of(&items[i]);
        sr_vec3 c = centre_of(&items[i]);
        for (int a = 0; a < 3; ++a)
            if (scale[a] > 0)
                join(&bins[a][bin_of(sr_component(c, a), sr_component(centres.lo, a), scale[a])], &one);
    }
    for (int a = 0; a < 3; ++a) {
        if (!(scale[a] > 0))
            continue;
        float below[BINS];
        struct part sum = empty_part();
        for (int k = 0; k < BINS - 1; ++k) {
            join(&sum, &bins[a][k]);
            below[k] = sum.count ? cost_of(&sum) : NAN;
        }
        sum = empty_part();
        for (int k = BINS - 1; k > 0; --k) {
            join(&sum, &bins[a][k]);
            float cost = sum.count ? (below[k - 1] + cost_of(&sum)) * (largest / sr_component(extent, a)) : NAN;
            if (cost < best_cost) {
                best_cost = cost;
                best_axis = a;
                best_limit = (float)k;
            }
        }
    }
    uint32_t middle = range.begin + (range.end - range.begin) / 2;
    if (best_axis < 0) // all centres are one, or the costs are no numbers
        return middle;
    uint32_t i = range.begin, j = range.end;
    while (i < j) {
        int k = bin_of(sr_component(centre_of(&items[i]), best_axis), sr_component(centres.lo, best_axis), scale[best_axis]);
        if ((float)k < best_limit) {
            ++i;
        } else {
            struct item t = items[i];
            items[i] = items[--j];
            items[j] = t;
        }
    }
    return i > range.begin && i < range.end ? i : middle;
}

/* Eight ranges or fewer: the longest is split until none is longer than eight; then short ones are opened while there is
 * room, so that few nodes are almost empty. */
static int ranges_of(struct build *b, struct range all, struct range *ranges)
{
    int n = 1;
    ranges[0] = all;
    while (n < WIDTH) {
        int longest = 0;
        for (int i = 1; i < n; ++i)
            if (ranges[i].end - ranges[i].begin > ranges[longest].end - ranges[longest].begin)
                longest = i;
        struct range r = ranges[longest];
        if (r.end - r.begin <= WIDTH)
            break;
        uint32_t middle = split(b, r);
        ranges[longest].end = middle;
        ranges[n++] = (struct range){middle, r.end};
    }
    for (;;) {
        int shortest = -1;
        for (int i = 0; i < n; ++i) {
            uint32_t length = ranges[i].end - ranges[i].begin;
            if (length > 1 && length <= (uint32_t)(WIDTH - n + 1) && (shortest < 0 || length < ranges[shortest].end - ranges[shortest].begin))
                shortest = i;
        }
        if (shortest < 0)
            return n;
        struct range r = ranges[shortest];
        ranges[shortest].end = r.begin + 1;
        for (uint32_t i = r.begin + 1; i < r.end; ++i)
            ranges[n++] = (struct range){i, i + 1};
    }
}

// the bounds of all the children, no smaller than any
static struct item enclose(const struct item *children, int n)
{
    struct item all = {.box = children[0].box, .cos_e = 1};
    sr_vec3 sum = {0, 0, 0}, axes[WIDTH];
    bool is_two_sided = false;
    for (int i = 0; i < n; ++i)
        is_two_sided |= children[i].power < 0;
    for (int i = 0; i < n; ++i) {
        all.box = grow(all.box, children[i].box);
        all.cos_e = fminf(all.cos_e, children[i].cos_e);
        all.power += fabsf(children[i].power);
        axes[i] = children[i].axis;
        if (is_two_sided && sr_dot(axes[i], sum) < 0)
            axes[i] = sr_neg(axes[i]);
        sum = sr_add(sum, axes[i]);
    }
    float length = sr_length(sum);
    all.axis = length > 1e-3f ? sr_scale(1 / length, sum) : axes[0];
    float widest = 0;
    for (int i = 0; i < n; ++i)
        widest = fmaxf(widest, sr_angle_between(all.axis, axes[i]) + acosf(sr_clamp(children[i].cos_o, -1, 1)) + 1e-4f);
    all.cos_o = widest < SR_PI ? cosf(widest) : -1;
    if (is_two_sided)
        all.power = -all.power;
    return all;
}

static int16_t round_down(float cosine)
{
    return (int16_t)fmaxf(floorf(cosine * 32767 - 0.01f), -32767);
}

static void store(const struct build *b, struct sr_light_tree_node *node, int slot, const struct item *child)
{
    sr_vec3 c = centre_of(child);
    const float at[3] = {c.x - node->origin.x, c.y - node->origin.y, c.z - node->origin.z};
    const float axis[3] = {child->axis.x, child->axis.y, child->axis.z};
    double off2 = 0, dot = 0, length2 = 0;
    for (int a = 0; a < 3; ++a) {
        node->centre[a][slot] = (uint16_t)(node->step > 0 ? sr_clamp(roundf(at[a] / node->step), 0, 65535) : 0);
        node->axis[a][slot] = (int16_t)lrintf(axis[a] * 32767);
        double off = (double)node->centre[a][slot] * (double)node->step - (double)at[a], q = node->axis[a][slot];
        off2 += off * off;
        dot += q * (double)axis[a];
        length2 += q * q;
    }
    node->radius[slot] = (float)((sqrt(off2) + (double)sr_length(sr_sub(child->box.hi, child->box.lo)) / 2) * (1 + 1e-6)) + b->slop;
    double turned = length2 > 0 ? acos(fmin(dot / sqrt(length2), 1)) : 0;
    double widest = acos(sr_clamp(child->cos_o, -1, 1)) + turned;
    node->cos_o[slot] = widest < (double)SR_PI ? round_down((float)cos(widest)) : -32767;
    node->cos_e[slot] = round_down(child->cos_e);
    node->power[slot] = child->power;
}

static struct item build_node(struct build *b, struct range all, uint32_t parent)
{
    uint32_t self = (uint32_t)b->nodes.count;
    if (!sr_array_push(&b->nodes, sizeof(struct sr_light_tree_node))) {
        b->has_memory = false;
        return b->items[all.begin];
    }
    struct range ranges[WIDTH];
    struct item children[WIDTH];
    uint32_t links[WIDTH];
    int n = ranges_of(b, all, ranges);
    struct sr_box centres = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < n; ++i) {
        uint32_t place = self * WIDTH + (uint32_t)i;
        children[i] = b->items[ranges[i].begin];
        links[i] = children[i].light | SR_LIGHT_TREE_LEAF;
        if (ranges[i].end - ranges[i].begin == 1) {
            b->place[children[i].light] = place;
        } else {
            links[i] = (uint32_t)b->nodes.count;
            children[i] = build_node(b, ranges[i], place);
        }
        sr_vec3 c = centre_of(&children[i]);
        centres = grow(centres, (struct sr_box){c, c});
    }
    struct sr_light_tree_node *node = (struct sr_light_tree_node *)b->nodes.data + self;
    node->parent = parent;
    node->origin = centres.lo;
    node->step = sr_max_component(sr_sub(centres.hi, centres.lo)) / 65535;
    for (int i = 0; i < n; ++i) {
        store(b, node, i, &children[i]);
        node->child[i] = links[i];
    }
    return enclose(children, n);
}

// what is known of the lights that have a place, as items; how many
static uint32_t collect(struct build *b, const struct sr_light *lights, uint32_t count)
{
    uint32_t n = 0;
    float farthest = 0;
    for (uint32_t i = 0; i < count; ++i) {
        struct sr_light_bounds l;
        if (lights[i].model->is_infinite || !lights[i].model->bounds(lights[i].self, &l) || !(l.power > 0))
            continue;
        sr_vec3 lo = l.box.lo, hi = l.box.hi;
        b->items[n++] = (struct item){l.box, l.axis, l.cos_theta_o, l.cos_theta_e, l.two_sided ? -l.power / 2 : l.power, i};
        farthest = fmaxf(farthest, fmaxf(fmaxf(fabsf(lo.x), fabsf(hi.x)), fmaxf(fmaxf(fabsf(lo.y), fabsf(hi.y)), fmaxf(fabsf(lo.z), fabsf(hi.z)))));
    }
    b->slop = farthest * 8 * SR_MACHINE_EPSILON;
    return n;
}

sr_status sr_light_tree_build(struct sr_arena *arena, const struct sr_light *lights, uint32_t count, struct sr_light_tree *tree,
                              uint32_t *place, struct sr_error *error)
{
    *tree = (struct sr_light_tree){0};
    struct build b = {.place = place, .has_memory = true};
    b.items = count < SR_LIGHT_TREE_LEAF / WIDTH ? sr_alloc((size_t)count * sizeof *b.items) : NULL;
    if (!b.items)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for a tree of %u lights", count);
    uint32_t n = collect(&b, lights, count);
    if (n)
        build_node(&b, (struct range){0, n}, SR_LIGHT_TREE_NOWHERE);
    sr_free(b.items);
    tree->node_count = (uint32_t)b.nodes.count;
    tree->nodes = n && b.has_memory ? sr_arena_copy(arena, b.nodes.data, b.nodes.count * sizeof *tree->nodes) : NULL;
    sr_array_free(&b.nodes);
    return n && !tree->nodes ? sr_fail(error, SR_ERROR_RESOURCE, "no memory for a tree of %u lights", count) : SR_OK;
}
