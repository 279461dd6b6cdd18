/* SPDX-License-Identifier: MIT */
/* Walking the tree of lights: at each node one of eight children is drawn in proportion to
 *
 *     power  cos(max(0, theta_w - theta_o - theta_b))  cos(max(0, theta_i - theta_b)) / max(d^2, r^2)
 *
 * with d the distance of the child's sphere of radius r, theta_b the half angle under which the sphere is seen, theta_w
 * the angle between the cone's axis and the direction to the receiver, theta_o the cone's half angle, theta_i the angle
 * at the receiver's normal (either side). Where theta_w - theta_o - theta_b is beyond the reach theta_e, no light can
 * come: 0. A. Conty Estevez, C. Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting, 2018; all eight
 * at a time, with sines and cosines times d, so that one division is left. The probability of a light does not need the
 * walk: it is the product over its ancestors. Limits: the bounds are conservative, so a walk may end at a node none of
 * whose children can contribute. */
#include "light/tree.h"

#define WIDTH SR_LIGHT_TREE_WIDTH

typedef float v8 __attribute__((vector_size(32)));
typedef int32_t v8i __attribute__((vector_size(32)));

// what rounding may take from a cosine; and the least weight of a child that may contribute, for the sake of spread
// normals
static const float slack = 2e-3f, least = 0.02f;

static inline v8 select(v8i mask, v8 a, v8 b)
{
    return (v8)((mask & (v8i)a) | (~mask & (v8i)b));
}

static inline v8 root(v8 a)
{
    v8 r = a;
    for (int i = 0; i < WIDTH; ++i)
        r[i] = sqrtf(a[i]);
    return r;
}

static inline v8 larger(v8 a, v8 b)
{
#ifdef __AVX__
    return __builtin_ia32_maxps256(a, b);
#else
    return select(a > b, a, b);
#endif
}

static inline v8 magnitude(v8 a)
{
    return (v8)((v8i)a & 0x7fffffff);
}

// the members of eight pairs of 16 bits: the first without sign, either with its sign, in units of 1/32767 (the machine
// is little-endian)
static inline v8i pairs(const void *p)
{
    v8i a;
    __builtin_memcpy(&a, p, sizeof a);
    return a;
}

static inline v8 first_unsigned(v8i a)
{
    return __builtin_convertvector(a & 0xffff, v8);
}

static inline v8 first(v8i a)
{
    return __builtin_convertvector(a << 16 >> 16, v8);
}

static inline v8 second(v8i a)
{
    return __builtin_convertvector(a >> 16, v8);
}

static inline v8 load(const float *p)
{
    v8 a;
    __builtin_memcpy(&a, p, sizeof a);
    return a;
}

// cos(max(0, a - b)) times d^2, given d cos a, d sin a, d cos b, d sin b
static inline v8 cosine_of_rest(v8 cos_a, v8 sin_a, v8 cos_b, v8 sin_b, v8 d2)
{
    return select(sin_a * cos_b - cos_a * sin_b <= 0, d2, cos_a * cos_b + sin_a * sin_b);
}

SR_INLINE v8 importance(const struct sr_light_tree_node *b, sr_vec3 p, sr_vec3 ns, bool has_normal)
{
    const v8 zero = {0};
    // from the centres to the receiver
    v8i along_x = pairs(b->along[0]), along_y = pairs(b->along[1]), along_z = pairs(b->along[2]), cone = pairs(b->cone);
    v8 dx = (p.x - b->origin.x) - b->step * first_unsigned(along_x);
    v8 dy = (p.y - b->origin.y) - b->step * first_unsigned(along_y);
    v8 dz = (p.z - b->origin.z) - b->step * first_unsigned(along_z);
    v8 d2 = dx * dx + dy * dy + dz * dz;
    v8 power = load(b->power), r = load(b->radius);
    v8i is_inside = d2 <= r * r;
    v8 reach2 = larger(larger(d2, r * r), zero + 1e-28f); // [m^2] no length: a lamp in the very origin has neither
    v8 cos_b = root(larger(d2 - r * r, zero));            // times d, like all that follow

    const float unit = 1 / 32767.0f;
    v8 cos_o = unit * first(cone), cos_e = unit * second(cone);
    v8 sin_o = root(larger(1 - cos_o * cos_o, zero));
    v8 cos_w = unit * (second(along_x) * dx + second(along_y) * dy + second(along_z) * dz);
    cos_w = select(power < 0, magnitude(cos_w), cos_w);
    v8 sin_w = root(larger(d2 - cos_w * cos_w, zero));

    v8 cos_x = cos_w * cos_o + sin_w * sin_o;
    v8 sin_x = sin_w * cos_o - cos_w * sin_o;
    v8 emitted = cosine_of_rest(cos_x, sin_x, cos_b, r, d2);
    emitted = select((sin_x <= 0) | is_inside, reach2, emitted);
    v8i can_reach = emitted >= (cos_e - slack) * reach2;

    v8 inverse = 1 / reach2;
    v8 weight = magnitude(power) * inverse * larger(emitted * inverse, zero + least);
    if (has_normal) {
        v8 cos_i = magnitude(ns.x * dx + ns.y * dy + ns.z * dz);
        v8 sin_i = root(larger(d2 - cos_i * cos_i, zero));
        v8 received = select(is_inside, reach2, cosine_of_rest(cos_i, sin_i, cos_b, r, d2));
        weight *= larger(received * inverse, zero + least);
    }
    return select(can_reach, weight, zero);
}

// of each and all before it
static inline v8 running_sum(v8 w)
{
    const v8 zero = {0};
    w += __builtin_shufflevector(zero, w, 0, 8, 9, 10, 11, 12, 13, 14);
    w += __builtin_shufflevector(zero, w, 0, 1, 8, 9, 10, 11, 12, 13);
    return w + __builtin_shufflevector(zero, w, 0, 1, 2, 3, 8, 9, 10, 11);
}

// Of the weights of the children: the sums up to and with each. Whoever has a weight keeps a share that the rounding of
// the sums cannot take, so that nobody is left out.
static inline v8 add_up(v8 w)
{
    const v8 zero = {0};
    v8 sums = running_sum(w), counts = running_sum(select(w > 0, zero + 1, zero));
    return sums + counts * (sums[WIDTH - 1] * 0x1p-21f);
}

// the share of child i, exactly as a choice by these sums grants it
static inline float share(const float upto[WIDTH + 1], unsigned i)
{
    return (upto[i + 1] - upto[i]) / upto[WIDTH];
}

// the number of sums that t has reached, but for the last
static inline unsigned count_reached(v8 upto, float t)
{
    v8i reached = upto <= t; // -1 for each
#ifdef __AVX__
    unsigned n = (unsigned)__builtin_popcount((unsigned)__builtin_ia32_movmskps256((v8)reached));
#else
    reached += __builtin_shufflevector(reached, reached, 4, 5, 6, 7, 0, 1, 2, 3);
    reached += __builtin_shufflevector(reached, reached, 2, 3, 0, 1, 6, 7, 4, 5);
    unsigned n = (unsigned)-(reached[0] + reached[1]);
#endif
    return n < WIDTH - 1 ? n : WIDTH - 1;
}

static bool has_length(sr_vec3 n)
{
    return (n.x != 0) | (n.y != 0) | (n.z != 0);
}

bool sr_light_tree_pick(const struct sr_light_tree *tree, sr_vec3 p, sr_vec3 ns, double u, uint32_t *index, float *pmf)
{
    bool has_normal = has_length(ns);
    float probability = 1;
    uint32_t at = 0;
    for (;;) {
        const struct sr_light_tree_node *node = &tree->nodes[at];
        v8 sums = add_up(importance(node, p, ns, has_normal));
        float upto[WIDTH + 1] = {0}, t = (float)(u * (double)sums[WIDTH - 1]);
        __builtin_memcpy(upto + 1, &sums, sizeof sums);
        if (!(sums[WIDTH - 1] > 0))
            return false;
        unsigned i = count_reached(sums, t);          // counted, since branches would be mispredicted
        while (SR_UNLIKELY(!(upto[i + 1] > upto[i]))) // rounding led past the last
            --i;
        probability *= share(upto, i);
        if (node->child[i] & SR_LIGHT_TREE_LEAF) { // nothing is left to choose
            *index = node->child[i] & ~SR_LIGHT_TREE_LEAF;
            *pmf = probability;
            return probability > 0;
        }
        u = (u * (double)sums[WIDTH - 1] - (double)upto[i]) / (double)(upto[i + 1] - upto[i]);
        u = u < 0 ? 0 : u < 0x1.fffffffffffffp-1 ? u : 0x1.fffffffffffffp-1;
        at = node->child[i];
    }
}

float sr_light_tree_pmf(const struct sr_light_tree *tree, sr_vec3 p, sr_vec3 ns, uint32_t place)
{
    bool has_normal = has_length(ns);
    float probability = 1;
    while (place != SR_LIGHT_TREE_NOWHERE) {
        const struct sr_light_tree_node *node = &tree->nodes[place / WIDTH];
        v8 sums = add_up(importance(node, p, ns, has_normal));
        float upto[WIDTH + 1] = {0};
        __builtin_memcpy(upto + 1, &sums, sizeof sums);
        if (!(upto[place % WIDTH + 1] > upto[place % WIDTH]))
            return 0;
        probability *= share(upto, place % WIDTH);
        place = node->parent;
    }
    return probability;
}
