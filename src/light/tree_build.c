/* SPDX-License-Identifier: MIT */
/* Building the tree of lights: ranges of lights are split where
 *
 *     cost = SUM over both sides  power * spread * extent^2 * (largest extent / extent along the split)
 *
 * is least among 12 bins along each axis (surface area and orientation heuristic of Conty Estevez & Kulla 2018; spread
 * ~ 2 pi (1 - cos_theta_o) + pi (1 - cos_theta_e) stands for their solid angle, extent^2 for their area). Two splits
 * after another make nodes of eight; the bounds that are stored come afterwards, from below, in double and rounded
 * outward. Limits: one thread; about a second for a million lights. */
#include "light/tree.h"

#define WIDTH SR_LIGHT_TREE_WIDTH
#define BINS 12

typedef float v4 __attribute__((vector_size(16)));
typedef int32_t v4i __attribute__((vector_size(16)));

// a light, or bounds of several, so packed that joining two is a minimum, a maximum and a sum
struct item {
    v4 lo;  // [m] of the box; cos_o
    v4 hi;  // [m] of the box; -cos_e
    v4 sum; // axis; power of one side [cd sr]
    uint32_t light;
    bool is_two_sided;
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

// a part of the lights while a split is sought: sum holds the sum of axes
struct part {
    v4 lo, hi, sum;
    uint32_t count;
};

static inline v4 smaller(v4 a, v4 b)
{
    v4i mask = a < b;
    return (v4)((mask & (v4i)a) | (~mask & (v4i)b));
}

static inline v4 larger(v4 a, v4 b)
{
    v4i mask = a > b;
    return (v4)((mask & (v4i)a) | (~mask & (v4i)b));
}

static inline sr_vec3 vec3(v4 a)
{
    return (sr_vec3){a[0], a[1], a[2]};
}

static inline v4 centre_of(const struct item *i)
{
    return 0.5f * (i->lo + i->hi);
}

static struct part empty_part(void)
{
    return (struct part){.lo = {INFINITY, INFINITY, INFINITY, 1}, .hi = {-INFINITY, -INFINITY, -INFINITY, -1}};
}

static inline void join(struct part *a, v4 lo, v4 hi, v4 sum, uint32_t count)
{
    a->lo = smaller(a->lo, lo);
    a->hi = larger(a->hi, hi);
    a->sum += sum;
    a->count += count;
}

// two-sided ones count with whichever side is up, so that opposite normals agree
static inline v4 upward(const struct item *i)
{
    bool is_turned =
        i->is_two_sided && (i->sum[2] < 0 || (i->sum[2] == 0 && (i->sum[1] < 0 || (i->sum[1] == 0 && i->sum[0] < 0))));
    return is_turned ? i->sum * (v4){-1, -1, -1, 1} : i->sum;
}

static float cost_of(const struct part *a)
{
    // axes spread evenly over a cap have the mean (1 + cos) / 2; the widest of their own cones comes on top
    float length = sr_length(vec3(a->sum)) / (float)a->count, mean = length < 1 ? length : 1;
    float cos_cap = 2 * mean - 1, sin_cap = sr_safe_sqrt(1 - cos_cap * cos_cap);
    float widest = a->lo[3], sin_o = sr_safe_sqrt(1 - widest * widest);
    bool is_all = sin_cap * widest + cos_cap * sin_o < 0;
    float cos_o = is_all ? -1 : cos_cap * widest - sin_cap * sin_o;
    float spread = 2 * SR_PI * (1 - cos_o) + SR_PI * (1 + a->hi[3]);
    return a->sum[3] * spread * sr_length2(vec3(a->hi - a->lo));
}

static int bin_of(float x, float lo, float scale)
{
    float i = (x - lo) * scale; // none at all where the range is wider than floats
    return i > 0 ? (int)sr_min(i, BINS - 1) : 0;
}

// a place to divide the range, both sides non-empty; reorders the range
static uint32_t split(struct build *b, struct range range)
{
    struct item *items = b->items;
    v4 lo = centre_of(&items[range.begin]), hi = lo;
    for (uint32_t i = range.begin + 1; i < range.end; ++i) {
        v4 c = centre_of(&items[i]);
        lo = smaller(lo, c);
        hi = larger(hi, c);
    }
    v4 extent = hi - lo;
    float largest = sr_max_component(vec3(extent)), best_cost = INFINITY;
    int best_axis = -1, best_limit = 0;
    struct part bins[3][BINS];
    float scale[3];
    for (int a = 0; a < 3; ++a) {
        scale[a] = extent[a] > 1e-6f * largest ? (float)BINS / extent[a] : 0;
        for (int k = 0; k < BINS; ++k)
            bins[a][k] = empty_part();
    }
    for (uint32_t i = range.begin; largest > 0 && i < range.end; ++i) {
        v4 up = upward(&items[i]), c = centre_of(&items[i]);
        for (int a = 0; a < 3; ++a)
            join(&bins[a][bin_of(c[a], lo[a], scale[a])], items[i].lo, items[i].hi, up, 1);
    }
    for (int a = 0; a < 3; ++a) {
        if (!(scale[a] > 0))
            continue;
        float below[BINS];
        struct part sum = empty_part();
        for (int k = 0; k < BINS - 1; ++k) {
            const struct part *bin = &bins[a][k];
            join(&sum, bin->lo, bin->hi, bin->sum, bin->count);
            below[k] = bin->count || k == 0 ? (sum.count ? cost_of(&sum) : NAN) : below[k - 1];
        }
        sum = empty_part();
        float above = NAN;
        for (int k = BINS - 1; k > 0; --k) {
            const struct part *bin = &bins[a][k];
            if (bin->count) {
                join(&sum, bin->lo, bin->hi, bin->sum, bin->count);
                above = cost_of(&sum);
            }
            float cost = (below[k - 1] + above) * (largest / extent[a]);
            if (cost < best_cost) {
                best_cost = cost;
                best_axis = a;
                best_limit = k;
            }
        }
    }
    uint32_t middle = range.begin + (range.end - range.begin) / 2;
    if (best_axis < 0) // all centres are one, or the costs are no numbers
        return middle;
    uint32_t i = range.begin, j = range.end;
    while (i < j) {
        if (bin_of(centre_of(&items[i])[best_axis], lo[best_axis], scale[best_axis]) < best_limit) {
            ++i;
        } else {
            struct item t = items[i];
            items[i] = items[--j];
            items[j] = t;
        }
    }
    return i > range.begin && i < range.end ? i : middle;
}

/* Eight ranges or fewer: the longest is split until none is longer than eight; then short ones are opened while there
 * is room, so that few nodes are almost empty. */
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
            if (length > 1 && length <= (uint32_t)(WIDTH - n + 1) &&
                (shortest < 0 || length < ranges[shortest].end - ranges[shortest].begin))
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
    struct item all = children[0];
    sr_vec3 sum = {0, 0, 0}, axes[WIDTH];
    float power = 0, widest = 0;
    for (int i = 0; i < n; ++i)
        all.is_two_sided |= children[i].is_two_sided;
    for (int i = 0; i < n; ++i) {
        all.lo = smaller(all.lo, children[i].lo);
        all.hi = larger(all.hi, children[i].hi);
        power += children[i].sum[3];
        axes[i] = vec3(children[i].sum);
        if (all.is_two_sided && sr_dot(axes[i], sum) < 0)
            axes[i] = sr_neg(axes[i]);
        sum = sr_add(sum, axes[i]);
    }
    float length = sr_length(sum);
    sr_vec3 axis = length > 1e-3f ? sr_scale(1 / length, sum) : axes[0];
    for (int i = 0; i < n; ++i) {
        float angle = sr_angle_between(axis, axes[i]) + acosf(sr_clamp(children[i].lo[3], -1, 1)) + 1e-4f;
        widest = angle > widest ? angle : widest;
    }
    all.lo[3] = widest < SR_PI ? cosf(widest) : -1;
    all.sum = (v4){axis.x, axis.y, axis.z, power};
    return all;
}

static int16_t round_down(float cosine)
{
    return (int16_t)sr_max(floorf(cosine * 32767 - 0.01f), -32767);
}

static void store(const struct build *b, struct sr_light_tree_node *node, int slot, const struct item *child)
{
    v4 at = centre_of(child) - (v4){node->origin.x, node->origin.y, node->origin.z, 0};
    double off2 = 0, dot = 0, length2 = 0;
    for (int a = 0; a < 3; ++a) {
        node->along[a][slot].centre =
            (uint16_t)(node->step > 0 ? sr_min(sr_max(at[a] / node->step + 0.5f, 0), 65535) : 0);
        node->along[a][slot].axis = (int16_t)lrintf(child->sum[a] * 32767);
        double off = (double)node->along[a][slot].centre * (double)node->step - (double)at[a],
               q = node->along[a][slot].axis;
        off2 += off * off;
        dot += q * (double)child->sum[a];
        length2 += q * q;
    }
    node->radius[slot] =
        (float)((sqrt(off2) + (double)sr_length(vec3(child->hi - child->lo)) / 2) * (1 + 1e-6)) + b->slop;
    double turned = length2 > 0 ? acos(fmin(dot / sqrt(length2), 1)) : 0;
    double widest = acos((double)sr_clamp(child->lo[3], -1, 1)) + turned;
    node->cone[slot].cos_o = widest < (double)SR_PI ? round_down((float)cos(widest)) : -32767;
    node->cone[slot].cos_e = round_down(-child->hi[3]);
    node->power[slot] = child->is_two_sided ? -child->sum[3] : child->sum[3];
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
    v4 lo = {INFINITY, INFINITY, INFINITY, 0}, hi = -lo;
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
        lo = smaller(lo, centre_of(&children[i]));
        hi = larger(hi, centre_of(&children[i]));
    }
    struct sr_light_tree_node *node = (struct sr_light_tree_node *)b->nodes.data + self;
    node->parent = parent;
    node->origin = vec3(lo);
    node->step = sr_max_component(vec3(hi - lo)) / 65535;
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
        v4 lo = {l.box.lo.x, l.box.lo.y, l.box.lo.z, l.cos_theta_o},
           hi = {l.box.hi.x, l.box.hi.y, l.box.hi.z, -l.cos_theta_e};
        b->items[n++] =
            (struct item){lo, hi, {l.axis.x, l.axis.y, l.axis.z, l.two_sided ? l.power / 2 : l.power}, i, l.two_sided};
        for (int a = 0; a < 3; ++a)
            farthest = sr_max(farthest, sr_max(fabsf(lo[a]), fabsf(hi[a])));
    }
    b->slop = farthest * 8 * SR_MACHINE_EPSILON;
    return n;
}

sr_status sr_light_tree_build(struct sr_arena *arena, const struct sr_light *lights, uint32_t count,
                              struct sr_light_tree *tree, uint32_t *place, struct sr_error *error)
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
