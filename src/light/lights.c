/* SPDX-License-Identifier: MIT */
/* Choosing one light among many: by the tree, by power alone, or evenly.
 *
 *     estimate = L / (pmf pdf)
 *
 * With the tree, infinite lights that can be drawn (images, distant lights) have the share 1 / (n + 1) each, the tree
 * the rest. Only lights with power are chosen; where there is but one, it is chosen always. */
#include "light/tree.h"

#include <string.h>

#define NEVER UINT32_MAX          // place of a light that is not chosen
#define INFINITE (UINT32_MAX - 1) // of one that is, outside the tree

struct choice {
    struct sr_light_tree tree;
    struct sr_alias alias;        // power: over all lights
    const double *area, *emitted; // [m^2] that glows, [cd sr] that leaves before each block of lights, and in all
    const uint32_t *place;        // of each light: in the tree, NEVER or INFINITE
    const uint32_t *choosable;    // uniform: those with power
    uint32_t choosable_count;
    const uint32_t *outside; // tree: infinite lights with power
    uint32_t outside_count;
    float share; // tree: of each of those, and of the tree
};

static float power_of(struct sr_light light)
{
    struct sr_light_bounds b;
    light.model->bounds(light.self, &b);
    return b.power > 0 && isfinite(b.power) ? b.power : 0;
}

enum { BLOCK = 32 }; // lights of which one sum is kept
static uint32_t block_count(uint32_t lights)
{
    return lights / BLOCK + (lights % BLOCK != 0);
}

// [m^2] of a surface that may shine
static float glowing_area(struct sr_light light)
{
    const struct sr_light_area *m = light.self;
    return light.model == &sr_light_area && m->emission->choice_luminance > 0 ? m->area : 0;
}

static const struct sr_table *white_of(struct sr_light light)
{
    if (light.model != &sr_light_area)
        return sr_colour_space(((const struct sr_light_common *)light.self)->space)->illuminant;
    const struct sr_light_emission *e = ((const struct sr_light_area *)light.self)->emission;
    return e->texels.width                        ? sr_colour_space(e->texels.space)->illuminant
           : e->emitted.kind == SR_SPD_ILLUMINANT ? e->emitted.table
                                                  : NULL;
}

static float emitted_by(struct sr_light light)
{
    if (!light.model->emit)
        return 0;
    float weight = light.model->emit_weight ? light.model->emit_weight(light.self) : power_of(light);
    return weight > 0 && isfinite(weight) ? weight : 0;
}

typedef float weight_of(struct sr_light light);

static double *before_blocks(struct sr_arena *arena, const struct sr_lights *l, weight_of *weight)
{
    uint32_t blocks = block_count(l->count);
    double *before = sr_arena_alloc(arena, (blocks + 1) * sizeof *before), sum = 0;
    for (uint32_t b = 0; before && b <= blocks; ++b) {
        before[b] = sum;
        for (uint32_t i = b * BLOCK; i < l->count && i < (b + 1) * BLOCK; ++i)
            sum += (double)weight(l->lights[i]);
    }
    return before;
}

static sr_status build_choice(struct sr_arena *arena, struct sr_lights *l, struct sr_error *error)
{
    uint32_t n = l->count, infinite_count = 0;
    struct choice *c = sr_arena_alloc(arena, sizeof *c);
    uint32_t *place = sr_arena_alloc(arena, n * sizeof *place);
    uint32_t *choosable = sr_alloc(n * sizeof *choosable), *outside = sr_alloc(n * sizeof *outside),
             *infinite = sr_alloc(n * sizeof *infinite);
    float *weights = sr_alloc(n * sizeof *weights);
    bool is_built = c && place && choosable && outside && infinite && weights;
    for (uint32_t i = 0; is_built && i < n; ++i) {
        const struct sr_light_model *model = l->lights[i].model;
        weights[i] = power_of(l->lights[i]);
        place[i] = weights[i] > 0 ? INFINITE : NEVER;
        if (model->is_infinite && !model->is_delta)
            infinite[infinite_count++] = i;
        if (model->is_infinite && weights[i] > 0)
            outside[c->outside_count++] = i;
        if (weights[i] > 0)
            choosable[c->choosable_count++] = i;
    }
    if (is_built) {
        c->place = place;
        c->outside = sr_arena_copy(arena, outside, c->outside_count * sizeof *outside);
        l->infinite = sr_arena_copy(arena, infinite, infinite_count * sizeof *infinite);
        l->infinite_count = infinite_count;
        l->only = c->choosable_count == 1 ? choosable[0] + 1 : 0;
        c->choosable = l->choice == SR_LIGHTS_UNIFORM
                           ? sr_arena_copy(arena, choosable, c->choosable_count * sizeof *choosable)
                           : NULL;
        is_built = c->outside && l->infinite && (c->choosable || l->choice != SR_LIGHTS_UNIFORM);
    }
    if (is_built && l->choice == SR_LIGHTS_POWER && c->choosable_count > 1)
        is_built = sr_alias_build(arena, weights, n, &c->alias);
    if (is_built) {
        c->area = before_blocks(arena, l, glowing_area);
        c->emitted = before_blocks(arena, l, emitted_by);
        is_built = c->area && c->emitted;
    }
    sr_free(choosable);
    sr_free(outside);
    sr_free(infinite);
    sr_free(weights);
    if (!is_built)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory to choose among %u lights", n);
    l->tree = c;
    bool has_finite = c->choosable_count > c->outside_count;
    c->share = 1 / (float)(c->outside_count + (has_finite ? 1 : 0));
    return l->choice == SR_LIGHTS_BVH && has_finite ? sr_light_tree_build(arena, l->lights, n, &c->tree, place, error)
                                                    : SR_OK;
}

sr_status sr_lights_build(struct sr_arena *arena, const struct sr_light *lights, uint32_t count,
                          enum sr_light_choice choice, struct sr_lights *out, struct sr_error *error)
{
    *out = (struct sr_lights){
        .lights = lights, .count = count, .choice = choice, .white = count ? white_of(lights[0]) : NULL};
    return count ? build_choice(arena, out, error) : SR_OK;
}

/* The 24 bits of u do not suffice to reach each of a million lights with its probability: what is below them comes from
 * a hash of u and the place. */
static double with_more_bits(float u, sr_vec3 p)
{
    uint32_t bits[4];
    memcpy(&bits[0], &u, 4);
    memcpy(&bits[1], &p, 12);
    return sr_with_more_bits(u, sr_hash_combine(bits[0] ^ (bits[1] * 0x85ebca6bu), bits[2] ^ (bits[3] * 0xc2b2ae35u)));
}

bool sr_lights_pick_many(const struct sr_lights *lights, const struct sr_point *x, float u, uint32_t *index, float *pmf)
{
    const struct choice *c = lights->tree;
    if (!c || c->choosable_count == 0)
        return false;
    if (lights->choice == SR_LIGHTS_UNIFORM) {
        uint32_t i = (uint32_t)(with_more_bits(u, x->p) * c->choosable_count);
        *index = c->choosable[i < c->choosable_count ? i : c->choosable_count - 1];
        *pmf = 1 / (float)c->choosable_count;
        return true;
    }
    if (lights->choice == SR_LIGHTS_POWER) {
        *index = sr_alias_sample(&c->alias, with_more_bits(u, x->p), pmf, NULL);
        return *pmf > 0;
    }
    double v = c->tree.node_count > 1 ? with_more_bits(u, x->p) : (double)u;
    if (c->outside_count) {
        v /= (double)c->share;
        uint32_t i = (uint32_t)v;
        if (i < c->outside_count || !c->tree.nodes) {
            *index = c->outside[i < c->outside_count ? i : c->outside_count - 1];
            *pmf = c->share;
            return true;
        }
        v = fmin(v - (double)c->outside_count, 0x1.fffffffffffffp-1);
    }
    if (!sr_light_tree_pick(&c->tree, x->p, x->ns, v, index, pmf))
        return false;
    *pmf *= c->share;
    return true;
}

float sr_lights_pmf(const struct sr_lights *lights, const struct sr_point *x, uint32_t index)
{
    const struct choice *c = lights->tree;
    if (!c || c->place[index] == NEVER)
        return 0;
    if (c->choosable_count == 1)
        return 1;
    if (lights->choice == SR_LIGHTS_UNIFORM)
        return 1 / (float)c->choosable_count;
    if (lights->choice == SR_LIGHTS_POWER)
        return c->alias.pmf[index];
    return c->place[index] == INFINITE ? c->share
                                       : c->share * sr_light_tree_pmf(&c->tree, x->p, x->ns, c->place[index]);
}

static bool pick_by(const struct sr_lights *lights, const double *before, weight_of *weight, double u, uint32_t *index,
                    float *pmf)
{
    uint32_t lo = 0, hi = block_count(lights->count);
    double total = before[hi], left = u * total;
    if (!(total > 0))
        return false;
    while (hi - lo > 1) {
        uint32_t middle = lo + (hi - lo) / 2;
        if (before[middle] <= left)
            lo = middle;
        else
            hi = middle;
    }
    left -= before[lo];
    uint32_t end = (lo + 1) * BLOCK < lights->count ? (lo + 1) * BLOCK : lights->count, last = UINT32_MAX;
    double of_last = 0;
    for (uint32_t i = lo * BLOCK; i < end; ++i) {
        double w = (double)weight(lights->lights[i]);
        if (w > 0) {
            last = i;
            of_last = w;
        }
        left -= w;
        if (left < 0)
            break;
    }
    *index = last;
    *pmf = (float)(of_last / total);
    return *pmf > 0;
}

static float pmf_by(const struct sr_lights *lights, const double *before, weight_of *weight, uint32_t index)
{
    double total = before[block_count(lights->count)];
    return total > 0 ? (float)((double)weight(lights->lights[index]) / total) : 0;
}

bool sr_lights_pick_by_area(const struct sr_lights *lights, const struct sr_point *x, float u, uint32_t *index,
                            float *pmf)
{
    const struct choice *c = lights->tree;
    return c && pick_by(lights, c->area, glowing_area, with_more_bits(u, x->p), index, pmf);
}

float sr_lights_pmf_by_area(const struct sr_lights *lights, uint32_t index)
{
    const struct choice *c = lights->tree;
    return c ? pmf_by(lights, c->area, glowing_area, index) : 0;
}

bool sr_lights_emit(const struct sr_lights *lights, float u_light, sr_vec2 u_place, sr_vec2 u_direction,
                    const struct sr_wavelengths *w, struct sr_light_ray *ray)
{
    const struct choice *c = lights->tree;
    double u = with_more_bits(u_light, (sr_vec3){u_place.x, u_place.y, u_direction.x});
    if (!c || !pick_by(lights, c->emitted, emitted_by, u, &ray->light, &ray->pmf))
        return false;
    uint32_t index = ray->light;
    float pmf = ray->pmf;
    struct sr_light light = lights->lights[index];
    if (!light.model->emit(light.self, u_place, u_direction, w, ray))
        return false;
    ray->light = index;
    ray->pmf = pmf;
    return true;
}

float sr_lights_emit_pmf(const struct sr_lights *lights, uint32_t index)
{
    const struct choice *c = lights->tree;
    return c ? pmf_by(lights, c->emitted, emitted_by, index) : 0;
}

double sr_lights_emitted(const struct sr_lights *lights)
{
    const struct choice *c = lights->tree;
    return c ? c->emitted[block_count(lights->count)] : 0;
}
