/* SPDX-License-Identifier: MIT */
/* Learned densities of directions: cells of places, trees of squares over the sphere.
 *
 *     p(w) ~ sqrt(E[(L(x, w) cos theta)^2])        [1/sr]
 *
 * which makes the estimate's second moment least where L is itself an estimate (Rath et al., Variance-aware path
 * guiding, 2020, eq. 8); two trees as by T. Mueller, M. Gross & J. Novak, Practical path guiding, 2017, but for the
 * first one, which splits cells at the mean of what fell into them, along positions and normals. The share of
 * directions that the BSDF keeps is that with the least
 *
 *     SUM noise pdf / pdf_k,  pdf_k = (1 - a_k) pdf_bsdf + a_k pdf_guide,
 *
 * the second moment that share a_k would have had, from the records of directions drawn otherwise. Limits: normals and
 * positions are cut to 20 bits of the bounds; sources of light smaller than 4 pi / 4^12 sr are not told apart. */
#include "integrator/guide.h"

#include <string.h>

enum {
    PLACE_BITS = 20,
    MOST_DEPTH = 12, // of trees of squares
    MOST_CELLS = 1 << 14,

    SPLIT_RECORDS = 1500, // in a cell, to split it
    MOST_SPLITS = 4,      // of a cell, one after the other, between two rounds
    NO_NODE = 0xffffffff
};
static const float fine_share = 0.02f;  // of a cell's light in a square, to split it
static const double doubt = 64;         // records that speak for the mean of all cells
static const double doubt_returns = 32; // returns, likewise
static const double worth = 0.97;       // of the second moment without guide: above, there is none
const float sr_guide_shares[SR_GUIDE_SHARES] = {0, 0.125f, 0.25f, 0.375f, 0.5f};
static const double record_most = 0x1p40, unit_of_mean = 0x1p-32; // integers of a record: see sr_guide_create

struct node {
    uint32_t child;       // the first of two; 0: a leaf
    uint32_t axis, split; // of an inner one: places below split are the first child's
    uint32_t cell;        // of a leaf
};

struct square {
    float mass[4];     // of the quarters: x + 2 y
    uint32_t child[4]; // 0: none
};
struct sums {
    uint64_t light[4]; // of quarters without a child
};

struct sr_guide {
    struct sr_box bounds;
    sr_vec3 scale; // [1/m] of positions
    double per_light, per_noise;
    struct sr_array nodes, cells, squares, sums;
};

/* ---- places ---- */

struct sr_guide_place sr_guide_place(const struct sr_guide *g, sr_vec3 p, sr_vec3 n)
{
    const float last = (1 << PLACE_BITS) - 1,
                of_normal = 0.125f * last; // a normal's whole range counts as a quarter of the bounds
    sr_vec3 d = sr_sub(p, g->bounds.lo);
    float x[6] = {d.x * g->scale.x,      d.y * g->scale.y,      d.z * g->scale.z,
                  (n.x + 1) * of_normal, (n.y + 1) * of_normal, (n.z + 1) * of_normal};
    struct sr_guide_place place;
    for (int i = 0; i < 6; ++i)
        place.of[i] = (uint32_t)sr_min(sr_max(x[i], 0), last); // 0 where the scene is wider than floats
    return place;
}

uint32_t sr_guide_find(const struct sr_guide *g, const struct sr_guide_place *place)
{
    const struct node *nodes = g->nodes.data, *n = nodes;
    while (n->child)
        n = &nodes[n->child + (place->of[n->axis] >= n->split)];
    return n->cell;
}

const struct sr_guide_cell *sr_guide_cell(const struct sr_guide *g, uint32_t number)
{
    return &((const struct sr_guide_cell *)g->cells.data)[number];
}

size_t sr_guide_cell_count(const struct sr_guide *g)
{
    return g->cells.count;
}

/* ---- directions ---- */

/* The quarter of the square that p is in; p becomes its place there. */
static inline int enter(sr_vec2 *p)
{
    p->x *= 2;
    p->y *= 2;
    int x = p->x >= 1, y = p->y >= 1;
    p->x -= (float)x;
    p->y -= (float)y;
    return x + 2 * y;
}

float sr_guide_pdf(const struct sr_guide *g, const struct sr_guide_cell *cell, sr_vec3 w)
{
    const struct square *squares = g->squares.data;
    sr_vec2 p = sr_equal_area_sphere_to_square(w);
    float pdf = SR_INV_PI / 4;
    for (uint32_t i = cell->root;;) {
        const struct square *s = &squares[i];
        int k = enter(&p);
        pdf *= 4 * s->mass[k] / ((s->mass[0] + s->mass[1]) + (s->mass[2] + s->mass[3]));
        if (!s->child[k] || !(pdf > 0))
            return pdf;
        i = s->child[k];
    }
}

/* One of two by their masses; u becomes even again. */
static inline int choose(float a, float b, float *u)
{
    float x = *u * (a + b);
    bool second = x >= a;
    *u = sr_clamp(second ? (x - a) / b : x / a, 0, SR_ONE_MINUS_EPSILON);
    return second;
}

float sr_guide_sample(const struct sr_guide *g, const struct sr_guide_cell *cell, sr_vec2 u, sr_vec3 *w)
{
    const struct square *squares = g->squares.data;
    sr_vec2 corner = {0, 0};
    float pdf = SR_INV_PI / 4, side = 1;
    for (uint32_t i = cell->root;;) {
        const struct square *s = &squares[i];
        const float *m = s->mass;
        int x = choose(m[0] + m[2], m[1] + m[3], &u.x), y = choose(m[x], m[x + 2], &u.y), k = x + 2 * y;
        pdf *= 4 * m[k] / ((m[0] + m[1]) + (m[2] + m[3]));
        side *= 0.5f;
        corner.x += (float)x * side;
        corner.y += (float)y * side;
        if (!s->child[k]) {
            *w = sr_equal_area_square_to_sphere((sr_vec2){corner.x + side * u.x, corner.y + side * u.y});
            return pdf;
        }
        i = s->child[k];
    }
}

/* ---- records ---- */

static inline void gain(uint64_t *sum, uint64_t x)
{
    __atomic_fetch_add(sum, x, __ATOMIC_RELAXED);
}

static inline uint64_t whole(double x)
{
    return x > 0 ? (uint64_t)(x < record_most ? x : record_most) : 0;
}

static void add_place(struct sr_guide_cell *cell, const struct sr_guide_place *place)
{
    gain(&cell->records, 1);
    for (int i = 0; i < 6; ++i) {
        gain(&cell->place[i], place->of[i]);
        gain(&cell->place2[i], (uint64_t)place->of[i] * place->of[i]);
    }
}

void sr_guide_add_return(struct sr_guide *g, uint32_t number, const struct sr_guide_place *place, int kind,
                         double brought, uint64_t cost)
{
    struct sr_guide_cell *cell = &((struct sr_guide_cell *)g->cells.data)[number];
    struct sr_guide_returns *r = &cell->returns[kind];
    add_place(cell, place);
    gain(&r->count, 1);
    gain(&r->brought, whole(brought * g->per_light));
    gain(&r->brought2, whole(brought * brought * g->per_noise));
    gain(&r->cost, cost);
}

void sr_guide_add(struct sr_guide *g, const struct sr_guide_record *r)
{
    struct sr_guide_cell *cell = &((struct sr_guide_cell *)g->cells.data)[r->cell];
    if (cell->has_light) {
        gain(&cell->measured[r->kind], 1);
        for (int k = 0; k < SR_GUIDE_SHARES; ++k) {
            float pdf = sr_guide_mix(sr_guide_shares[k], r->pdf_bsdf, r->pdf_guide);
            gain(&cell->moments[r->kind][k], whole(r->noise * g->per_noise * (double)(r->pdf / pdf)));
        }
    }
    if (!r->is_direction)
        return;
    add_place(cell, &r->place);
    uint64_t light = whole(r->light * g->per_light);
    if (light == 0)
        return;
    const struct square *squares = g->squares.data;
    sr_vec2 p = sr_equal_area_sphere_to_square(r->w);
    for (uint32_t i = cell->root;;) {
        int k = enter(&p);
        if (!squares[i].child[k]) {
            gain(&((struct sums *)g->sums.data)[i].light[k], light);
            return;
        }
        i = squares[i].child[k];
    }
}

/* ---- between rounds ---- */

/* The masses of a tree, sqrt(area sum) of each leaf, from its sums. */
static float weigh(struct sr_guide *g, uint32_t i, float area)
{
    struct square *s = &((struct square *)g->squares.data)[i];
    const struct sums *sums = &((const struct sums *)g->sums.data)[i];
    float total = 0;
    for (int k = 0; k < 4; ++k) {
        s->mass[k] = s->child[k] ? weigh(g, s->child[k], area / 4) : sqrtf(area / 4 * (float)sums->light[k]);
        total += s->mass[k];
    }
    return total;
}

static uint64_t sum_of(const struct sr_guide *g, uint32_t i)
{
    const struct square *s = &((const struct square *)g->squares.data)[i];
    const struct sums *sums = &((const struct sums *)g->sums.data)[i];
    uint64_t sum = 0;
    for (int k = 0; k < 4; ++k)
        sum += s->child[k] ? sum_of(g, s->child[k]) : sums->light[k];
    return sum;
}

/* Trees of squares while they are made anew. */
struct growth {
    struct sr_array squares, sums;
    bool has_failed;
};

/* A square of the new tree: where old is no node, an even one with that sum and mass. `shift` halves the sums so many
 * times. Returns its number. */
static uint32_t grow(struct growth *b, const struct sr_guide *g, uint32_t old, uint64_t sum, float mass, float least,
                     int depth, int shift)
{
    uint32_t number = (uint32_t)b->squares.count;
    if (!sr_array_push(&b->squares, sizeof(struct square)) || !sr_array_push(&b->sums, sizeof(struct sums))) {
        b->has_failed = true;
        return 0;
    }
    struct square s = {{0}, {0}};
    struct sums sums = {{0}};
    for (int k = 0; k < 4 && !b->has_failed; ++k) {
        uint32_t child = NO_NODE;
        uint64_t light = sum / 4;
        s.mass[k] = mass / 4;
        if (old != NO_NODE) {
            const struct square *o = &((const struct square *)g->squares.data)[old];
            s.mass[k] = o->mass[k];
            child = o->child[k] ? o->child[k] : NO_NODE;
            light = child != NO_NODE ? 0 : ((const struct sums *)g->sums.data)[old].light[k];
        }
        if (s.mass[k] > least && depth < MOST_DEPTH)
            s.child[k] = grow(b, g, child, light, s.mass[k], least, depth + 1, shift);
        else
            sums.light[k] = (child != NO_NODE ? sum_of(g, child) : light) >> shift;
    }
    if (b->has_failed)
        return 0;
    ((struct square *)b->squares.data)[number] = s;
    ((struct sums *)b->sums.data)[number] = sums;
    return number;
}

/* What all cells together say. */
struct verdict {
    double all[SR_GUIDE_KINDS][SR_GUIDE_SHARES]; // of a share, relative to none
    struct mean_return {
        double brought, brought2, cost;
    } mean[SR_GUIDE_KINDS];
};

static void judge(const struct sr_guide *g, struct verdict *v)
{
    const struct sr_guide_cell *cells = g->cells.data;
    double(*all)[SR_GUIDE_SHARES] = v->all;
    *v = (struct verdict){0};
    for (int kind = 0; kind < SR_GUIDE_KINDS; ++kind) {
        for (size_t i = 0; i < g->cells.count; ++i)
            for (int k = 0; k < SR_GUIDE_SHARES; ++k)
                all[kind][k] += (double)cells[i].moments[kind][k];
        for (int k = SR_GUIDE_SHARES; k-- > 0;)
            all[kind][k] = all[kind][0] > 0 ? all[kind][k] / all[kind][0] : -1;
        struct mean_return *m = &v->mean[kind];
        double n = 0;
        for (size_t i = 0; i < g->cells.count; ++i) {
            const struct sr_guide_returns *r = &cells[i].returns[kind];
            n += (double)r->count, m->brought += (double)r->brought, m->brought2 += (double)r->brought2,
                m->cost += (double)r->cost;
        }
        n = n > 0 ? n : 1;
        m->brought /= n, m->brought2 /= n, m->cost /= n;
    }
}

static float best_share(const struct sr_guide_cell *cell, int kind, const double all[SR_GUIDE_SHARES])
{
    if (all[0] < 0) // nothing has been measured yet
        return sr_guide_shares[SR_GUIDE_SHARES / 2];
    double n = (double)cell->measured[kind], none = n > 0 ? (double)cell->moments[kind][0] : 0,
           own = none > 0 ? n / none : 0, weight = own > 0 ? n : 0;
    double best = worth * (weight + doubt);
    int chosen = 0;
    for (int k = 1; k < SR_GUIDE_SHARES; ++k) {
        double moment = own * (double)cell->moments[kind][k] + doubt * all[k];
        if (moment < best) {
            best = moment;
            chosen = k;
        }
    }
    return sr_guide_shares[chosen];
}

/* What a cell's returns say, and the mean of all where there are few; the cell keeps its share of them. */
static void learn_returns(struct sr_guide_cell *cell, const struct sr_guide *g, const struct sr_guide_cell *old,
                          int kind, const struct mean_return *all, int shift)
{
    const struct sr_guide_returns *r = &old->returns[kind];
    double n = (double)r->count + doubt_returns, brought = (double)r->brought + doubt_returns * all->brought,
           brought2 = (double)r->brought2 + doubt_returns * all->brought2,
           cost = (double)r->cost + doubt_returns * all->cost;
    cell->returns[kind] =
        (struct sr_guide_returns){r->count >> shift, r->brought >> shift, r->brought2 >> shift, r->cost >> shift};
    cell->mean[kind] = brought > 0 ? (float)(brought / (n * g->per_light)) : 0;
    cell->worth[kind] = cost > 0 ? brought2 > 0 ? (float)sqrt(brought2 / (cost * g->per_noise)) : 0 : INFINITY;
}

/* How the records of a cell are spread. */
struct spread {
    double records, mean[6], variance[6];
};

static struct spread spread_of(const struct sr_guide_cell *cell)
{
    struct spread s = {.records = (double)cell->records};
    for (int i = 0; i < 6 && cell->records; ++i) {
        s.mean[i] = (double)cell->place[i] / s.records;
        s.variance[i] = (double)cell->place2[i] / s.records - s.mean[i] * s.mean[i];
    }
    return s;
}

/* Cuts it at its mean along the axis on which it is widest: it becomes one half, the other is returned, each as if all
 * were even. */
static struct spread halve(struct spread *s, struct node *split)
{
    for (uint32_t i = 1; i < 6; ++i)
        if (s->variance[i] > s->variance[split->axis])
            split->axis = i;
    uint32_t axis = split->axis;
    split->split = (uint32_t)ceil(s->mean[axis]);
    double step = sqrt(0.75 * s->variance[axis]);
    s->records /= 2;
    s->variance[axis] /= 4;
    struct spread other = *s;
    s->mean[axis] -= step;
    other.mean[axis] += step;
    return other;
}

static void free_arrays(struct sr_guide *g)
{
    sr_array_free(&g->nodes);
    sr_array_free(&g->cells);
    sr_array_free(&g->squares);
    sr_array_free(&g->sums);
}

static bool copy_nodes(const struct sr_guide *from, struct sr_guide *to)
{
    for (size_t i = 0; i < from->nodes.count; ++i) {
        struct node *n = sr_array_push(&to->nodes, sizeof *n);
        if (!n)
            return false;
        *n = ((const struct node *)from->nodes.data)[i];
    }
    return true;
}

/* The leaf's cell in the new guide; its sums halved `shift` times. */
static bool add_cell(struct sr_guide *next, const struct sr_guide *g, const struct sr_guide_cell *old, uint32_t leaf,
                     int shift, float mass, const struct verdict *v)
{
    struct sr_guide_cell *cell = sr_array_push(&next->cells, sizeof *cell);
    if (!cell)
        return false;
    struct growth growth = {.squares = next->squares, .sums = next->sums};
    *cell = (struct sr_guide_cell){.has_light = mass > 0};
    if (!shift) {
        cell->records = old->records;
        memcpy(cell->place, old->place, sizeof cell->place);
        memcpy(cell->place2, old->place2, sizeof cell->place2);
    }
    for (int kind = 0; kind < SR_GUIDE_KINDS; ++kind) {
        cell->share[kind] = best_share(old, kind, v->all[kind]);
        learn_returns(cell, g, old, kind, &v->mean[kind], shift + 1);
        cell->measured[kind] = old->measured[kind] >> (shift + 1); // what the coarser density was worth counts half
        for (int k = 0; k < SR_GUIDE_SHARES; ++k)
            cell->moments[kind][k] = old->moments[kind][k] >> (shift + 1);
    }
    cell->root = grow(&growth, g, old->root, 0, mass, mass > 0 ? fine_share * mass : INFINITY, 1,
                      shift + 1); // and so does what coarser cells have seen
    next->squares = growth.squares;
    next->sums = growth.sums;
    ((struct node *)next->nodes.data)[leaf].cell = (uint32_t)next->cells.count - 1;
    return !growth.has_failed;
}

static bool refine_leaf(struct sr_guide *next, const struct sr_guide *g, const struct sr_guide_cell *old,
                        struct spread spread, uint32_t leaf, int shift, float mass, const struct verdict *v)
{
    if (spread.records < SPLIT_RECORDS || shift >= MOST_SPLITS || next->nodes.count >= 2 * MOST_CELLS)
        return add_cell(next, g, old, leaf, shift, mass, v);
    struct node split = {.child = (uint32_t)next->nodes.count};
    struct spread other = halve(&spread, &split);
    if (!sr_array_push(&next->nodes, sizeof split) || !sr_array_push(&next->nodes, sizeof split))
        return false;
    ((struct node *)next->nodes.data)[leaf] = split;
    return refine_leaf(next, g, old, spread, split.child, shift + 1, mass, v) &&
           refine_leaf(next, g, old, other, split.child + 1, shift + 1, mass, v);
}

bool sr_guide_refine(struct sr_guide *g)
{
    struct sr_guide next = {
        .bounds = g->bounds, .scale = g->scale, .per_light = g->per_light, .per_noise = g->per_noise};
    struct verdict v;
    judge(g, &v);
    bool is_done = copy_nodes(g, &next);
    for (uint32_t i = 0; is_done && i < g->nodes.count; ++i) {
        const struct node *n = &((const struct node *)g->nodes.data)[i];
        const struct sr_guide_cell *cell = sr_guide_cell(g, n->cell);
        if (!n->child)
            is_done = refine_leaf(&next, g, cell, spread_of(cell), i, 0, weigh(g, cell->root, 4 * SR_PI), &v);
    }
    if (!is_done) {
        free_arrays(&next);
        return false;
    }
    free_arrays(g);
    *g = next;
    return true;
}

struct sr_guide *sr_guide_create(const struct sr_box *bounds, double light, double noise)
{
    struct sr_guide *g = sr_alloc(sizeof *g);
    if (!g)
        return NULL;
    g->bounds = *bounds;
    const float range = (float)(1 << PLACE_BITS);
    float side = sr_max(sr_max_component(sr_box_diagonal(*bounds)),
                        1e-30f); // the same along all axes, so that spreads can be compared
    g->scale = (sr_vec3){range / side, range / side, range / side};
    g->per_light = light > 0 ? 1 / (unit_of_mean * light) : 0;
    g->per_noise = noise > 0 ? 1 / (unit_of_mean * noise) : 0;
    struct node *root = sr_array_push(&g->nodes, sizeof *root);
    struct sr_guide_cell *cell = sr_array_push(&g->cells, sizeof *cell);
    if (!root || !cell || !sr_array_push(&g->squares, sizeof(struct square)) ||
        !sr_array_push(&g->sums, sizeof(struct sums))) {
        sr_guide_destroy(g);
        return NULL;
    }
    return g;
}

void sr_guide_destroy(struct sr_guide *g)
{
    if (g)
        free_arrays(g);
    sr_free(g);
}
