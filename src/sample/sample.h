/* SPDX-License-Identifier: MIT */
/* Random numbers that are pure functions, warps with their densities, and distributions to draw from.
 *
 * Every number is a function of (seed, pixel, replicate, sample, dimension): no state to share, any sample of any image
 * can be recomputed alone, and bytes do not depend on who computes what. */
#ifndef SR_SAMPLE_SAMPLE_H
#define SR_SAMPLE_SAMPLE_H

#include "math/math.h"

/* ---- hashes ---- */

static inline uint32_t sr_hash_u32(uint32_t x) // a bijection with full avalanche ("lowbias32" form)
{
    x ^= x >> 16;
    x *= 0x21f0aaadu;
    x ^= x >> 15;
    x *= 0xd35a2d97u;
    x ^= x >> 15;
    return x;
}
static inline uint32_t sr_hash_combine(uint32_t a, uint32_t b)
{
    return sr_hash_u32(a * 0x9e3779b9u + sr_hash_u32(b + 0x7f4a7c15u));
}
uint64_t sr_hash_bytes(const void *data, size_t size, uint64_t seed);
static inline float sr_u32_to_float(uint32_t x) // [0, 1), 24 bits
{
    return (float)(x >> 8) * 0x1p-24f;
}

/* A small stateful generator (PCG32) for random walks inside one vertex; seeded by a hash, never shared. */
struct sr_rng {
    uint64_t state, increment;
};
struct sr_rng sr_rng_seed(uint64_t seed, uint64_t stream);
uint32_t sr_rng_u32(struct sr_rng *rng);
static inline float sr_rng_float(struct sr_rng *rng)
{
    return sr_u32_to_float(sr_rng_u32(rng));
}

/* ---- the sampler ---- */

enum sr_sampler_kind {
    SR_SAMPLER_SOBOL,       // Owen-scrambled Sobol' nets, four dimensions at a time, shuffled between groups
    SR_SAMPLER_INDEPENDENT, // uniform, independent
};

typedef float sr_u4 __attribute__((vector_size(4 * sizeof(float))));
typedef float sr_u8 __attribute__((vector_size(8 * sizeof(float))));
struct sr_sampler {
    uint32_t key;       // hash of seed, pixel and replicate
    uint32_t sample;    // index in the pixel's net
    uint32_t kind;      // enum sr_sampler_kind
    uint32_t drawn;     // groups below this one have been drawn ahead; 0: none
    const sr_u8 *ahead; // of groups 2 k and 2 k + 1: ahead[k * SR_AHEAD]
};
struct sr_sampler sr_sampler_start(enum sr_sampler_kind kind, uint32_t seed, uint32_t pixel_x, uint32_t pixel_y,
                                   uint32_t replicate, uint32_t sample);
/* The numbers of the first groups for s->sample and those after it, up to SR_AHEAD of them, exactly as sr_sample8 gives
 * them: what depends on the pixel alone is worked out once, and samples do not wait for each other. Returns how many
 * groups have been drawn; sample k finds its own from out[k] on. */
enum { SR_AHEAD = 8, SR_AHEAD_GROUPS = 8 };
uint32_t sr_sampler_draw_ahead(const struct sr_sampler *s, uint32_t count, sr_u8 out[SR_AHEAD_GROUPS / 2 * SR_AHEAD]);

/* Four numbers in [0, 1) for one purpose ("group"); within a group the four are one 4-D Sobol' net whose components x,
 * y form a (0,2)-sequence: give x, y to what matters most.
 *
 *     i' = shuffle(i; key, group),    x = reverse(owen(S_0[i'_0] ^ S_1[i'_1] ^ …; key, group, lane)) 2^-32
 *
 * S holds bit-reversed Sobol' points for each byte of the index (S. Joe & F. Kuo 2008). Owen's nested scrambling is a
 * hash in which each bit depends on lower ones only (S. Laine & T. Karras 2011, constants by N. Vegdahl 2021);
 * shuffling the index the same way makes groups independent (B. Burley, Practical Hash-based Owen Scrambling, 2020).
 * The shuffle stays within blocks of 65536, so that smaller indices need two look-ups. */
typedef uint32_t sr_u4_bits __attribute__((vector_size(16)));
typedef uint32_t sr_u8_bits __attribute__((vector_size(32)));
extern const sr_u4_bits sr_sobol_table[4][256];
extern const uint8_t sr_reversed_byte[256];
sr_u4_bits sr_sobol_high(uint32_t high_half, uint32_t *seed); // what an index >= 65536 adds

static inline sr_u4 sr_bits_to_u4(sr_u4_bits x) // [0, 1), 24 bits
{
    typedef int32_t sr_i4 __attribute__((vector_size(16)));
    return __builtin_convertvector((sr_i4)(x >> 8), sr_u4) * 0x1p-24f;
}

static inline sr_u4_bits sr_reverse_bits_u4(sr_u4_bits x)
{
    typedef uint8_t sr_bytes16 __attribute__((vector_size(16)));
    sr_bytes16 bytes = (sr_bytes16)x;
    x = (sr_u4_bits)__builtin_shufflevector(bytes, bytes, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}

SR_INLINE uint32_t sr_index_begin(uint32_t sample) // < 65536: what all groups make of it
{
    uint32_t i = (uint32_t)sr_reversed_byte[sample & 255] << 8 | sr_reversed_byte[sample >> 8 & 255];
    return i ^ i * 0x3d20adeau;
}
SR_INLINE uint32_t sr_index_shuffle(uint32_t i, uint32_t seed)
{
    i = (i + seed) * (seed >> 16 | 1);
    i ^= i * 0x05526c56u;
    return i ^ i * 0x53a22864u;
}
SR_INLINE sr_u8_bits sr_index_shuffle8(sr_u8_bits i, uint32_t seed) // the same, of eight indices
{
    i = (i + seed) * (seed >> 16 | 1);
    i ^= i * 0x05526c56u;
    return i ^ i * 0x53a22864u;
}
SR_INLINE sr_u4_bits sr_sobol_point(uint32_t i)
{
    return sr_sobol_table[1][i & 255] ^ sr_sobol_table[0][i >> 8 & 255];
}

static inline sr_u4 sr_sample4(const struct sr_sampler *s, uint32_t group)
{
    // 64 bits for the purpose, a third and a fourth product for the lanes; the key has been hashed well already
    typedef uint64_t sr_wide2 __attribute__((vector_size(16)));
    uint64_t wide = (s->key ^ (uint64_t)group << 32) * 0x9e3779b97f4a7c15ull;
    wide = (wide ^ wide >> 32) * 0xd6e8feb86659fd93ull;
    wide ^= wide >> 32;
    uint64_t index = s->sample;
    if (SR_UNLIKELY(s->kind == SR_SAMPLER_INDEPENDENT)) {
        wide = (wide ^ index << 32 ^ index) * 0x9e3779b97f4a7c15ull;
        wide = (wide ^ wide >> 29) * 0xbf58476d1ce4e5b9ull;
        wide ^= wide >> 32;
    }
    sr_wide2 product = {wide * 0xbf58476d1ce4e5b9ull, wide * 0x94d049bb133111ebull};
    sr_u4_bits lane = (sr_u4_bits)(product ^ product >> 32);
    if (SR_UNLIKELY(s->kind == SR_SAMPLER_INDEPENDENT)) {
        lane *= 0x21f0aaadu;
        lane ^= lane >> 15;
        lane *= 0xd35a2d97u;
        return sr_bits_to_u4(lane ^ lane >> 15);
    }

    uint32_t seed = (uint32_t)wide;
    sr_u4_bits x = {0, 0, 0, 0};
    if (SR_UNLIKELY(index >> 16))
        x = sr_sobol_high((uint32_t)index >> 16, &seed);
    x ^= sr_sobol_point(sr_index_shuffle(sr_index_begin((uint32_t)index), seed));

    x ^= x * 0x3d20adeau;
    x += lane;
    x *= lane >> 16 | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return sr_bits_to_u4(sr_reverse_bits_u4(x));
}

/* Eight numbers from two points of a net, each scrambled in its own way. */
SR_INLINE sr_u8 sr_scramble8(sr_u4_bits point0, sr_u4_bits point1, sr_u8_bits add, sr_u8_bits multiply)
{
    typedef int32_t sr_i8 __attribute__((vector_size(32)));
    typedef uint8_t sr_bytes32 __attribute__((vector_size(32)));
    sr_u8_bits x = __builtin_shufflevector(point0, point1, 0, 1, 2, 3, 4, 5, 6, 7);
    x ^= x * 0x3d20adeau;
    x += add;
    x *= multiply;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    sr_bytes32 b = (sr_bytes32)x;
    x = (sr_u8_bits)__builtin_shufflevector(b, b, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12, 19, 18, 17, 16,
                                            23, 22, 21, 20, 27, 26, 25, 24, 31, 30, 29, 28);
#ifdef __AVX2__ // the bits of a byte by two looks into a table of sixteen
    typedef char sr_chars32 __attribute__((vector_size(32)));
    const sr_chars32 mirrored = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15,
                                 0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
    x = (sr_u8_bits)__builtin_ia32_pshufb256(mirrored, (sr_chars32)(x & 0x0f0f0f0fu)) << 4 |
        (sr_u8_bits)__builtin_ia32_pshufb256(mirrored, (sr_chars32)(x >> 4 & 0x0f0f0f0fu));
#else
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
#endif
    return __builtin_convertvector((sr_i8)(x >> 8), sr_u8) * 0x1p-24f;
}

/* What the pixel makes of a group and the one after it: how indices are shuffled, and how the eight lanes are
 * scrambled. */
struct sr_pair_seeds {
    uint32_t seed[2];
    sr_u8_bits lane;
};
SR_INLINE struct sr_pair_seeds sr_pair_seeds(uint32_t key, uint32_t group)
{
    typedef uint64_t sr_wide4 __attribute__((vector_size(32)));
    uint64_t wide[2] = {(key ^ (uint64_t)group << 32) * 0x9e3779b97f4a7c15ull,
                        (key ^ (uint64_t)(group + 1) << 32) * 0x9e3779b97f4a7c15ull};
    for (int k = 0; k < 2; ++k) {
        wide[k] = (wide[k] ^ wide[k] >> 32) * 0xd6e8feb86659fd93ull;
        wide[k] ^= wide[k] >> 32;
    }
    sr_wide4 product = {wide[0] * 0xbf58476d1ce4e5b9ull, wide[0] * 0x94d049bb133111ebull,
                        wide[1] * 0xbf58476d1ce4e5b9ull, wide[1] * 0x94d049bb133111ebull};
    return (struct sr_pair_seeds){.seed = {(uint32_t)wide[0], (uint32_t)wide[1]},
                                  .lane = (sr_u8_bits)(product ^ product >> 32)};
}

/* The numbers of group and of group + 1, exactly as sr_sample4 gives them, for two thirds of the price; for nearly
 * nothing where they have been drawn ahead. */
static inline void sr_sample8(const struct sr_sampler *s, uint32_t group, sr_u4 *first, sr_u4 *second)
{
    sr_u8 u;
    if (group < s->drawn && !(group & 1)) {
        u = s->ahead[group / 2 * SR_AHEAD];
    } else if (SR_UNLIKELY(s->kind == SR_SAMPLER_INDEPENDENT || s->sample >> 16)) {
        *first = sr_sample4(s, group);
        *second = sr_sample4(s, group + 1);
        return;
    } else {
        struct sr_pair_seeds p = sr_pair_seeds(s->key, group);
        uint32_t i = sr_index_begin(s->sample);
        u = sr_scramble8(sr_sobol_point(sr_index_shuffle(i, p.seed[0])), sr_sobol_point(sr_index_shuffle(i, p.seed[1])),
                         p.lane, p.lane >> 16 | 1);
    }
    *first = __builtin_shufflevector(u, u, 0, 1, 2, 3);
    *second = __builtin_shufflevector(u, u, 4, 5, 6, 7);
}

/* ---- warps: uniform numbers to shapes, with densities ---- */

SR_INLINE sr_vec2 sr_warp_disk(sr_vec2 u) // concentric (Shirley & Chiu 1997), pdf 1/pi
{
    float a = 2 * u.x - 1, b = 2 * u.y - 1, s, c;
    bool wide = fabsf(a) > fabsf(b);
    float r = wide ? a : b, across = wide ? b : a;
    sr_sin_cos_eighth(SR_PI / 4 * (across / (r != 0 ? r : 1)), &s, &c);
    float x = r * c, y = r * s;
    return wide ? (sr_vec2){x, y} : (sr_vec2){y, x};
}
sr_vec3 sr_warp_uniform_sphere(sr_vec2 u);             // pdf 1/(4 pi) sr^-1
sr_vec3 sr_warp_uniform_hemisphere(sr_vec2 u);         // pdf 1/(2 pi) sr^-1
SR_INLINE sr_vec3 sr_warp_cosine_hemisphere(sr_vec2 u) // over the disk (Malley), pdf cos/pi sr^-1
{
    sr_vec2 d = sr_warp_disk(u);
    return (sr_vec3){d.x, d.y, sr_safe_sqrt(1 - d.x * d.x - d.y * d.y)};
}
static inline float sr_warp_cosine_hemisphere_pdf(float cos_theta)
{
    return cos_theta > 0 ? cos_theta * SR_INV_PI : 0;
}
sr_vec3 sr_warp_uniform_cone(sr_vec2 u, float one_minus_cos_max); // around +z, pdf 1/(2 pi (1 - cos)) sr^-1
static inline sr_vec2 sr_warp_triangle(sr_vec2 u) // barycentrics of vertices 0 and 1 (Heitz 2019), uniform by area
{
    bool upper = u.y > u.x;
    float half = 0.5f * (upper ? u.x : u.y), rest = (upper ? u.y : u.x) - half; // no branch to mispredict
    return (sr_vec2){upper ? half : rest, upper ? rest : half};
}
float sr_warp_exponential(float u, float a); // density a exp(-a x)
/* Bilinear density on the unit square with corner weights w[0]=(0,0), w[1]=(1,0), w[2]=(0,1), w[3]=(1,1). */
sr_vec2 sr_warp_bilinear(sr_vec2 u, const float w[4]);
float sr_warp_bilinear_pdf(sr_vec2 p, const float w[4]);

/* Uniform directions in the spherical triangle of v seen from p (Arvo 1995): barycentrics and pdf [1/sr]; pdf 0 = none.
 */
void sr_spherical_triangle_sample(const sr_vec3 v[3], sr_vec3 p, sr_vec2 u, float barycentric[3], float *pdf);
float sr_spherical_triangle_pdf(const sr_vec3 v[3],
                                sr_vec3 p); // of every direction within, exactly as sample says [1/sr]
sr_vec2 sr_spherical_triangle_invert(const sr_vec3 v[3], sr_vec3 p, sr_vec3 w); // the u that gives direction w
double sr_spherical_triangle_area(sr_vec3 a, sr_vec3 b,
                                  sr_vec3 c); // of unit vectors [sr] (Van Oosterom & Strackee 1983)
/* The same for a rectangle with corner s and edges ex, ey (Urena et al. 2013): the point, and pdf [1/sr]. */
sr_vec3 sr_spherical_rectangle_sample(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey, sr_vec2 u, float *pdf);
float sr_spherical_rectangle_pdf(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey); // exactly as sample says [1/sr]
sr_vec2 sr_spherical_rectangle_invert(sr_vec3 p, sr_vec3 s, sr_vec3 ex, sr_vec3 ey, sr_vec3 on_rectangle);

/* ---- distributions ---- */

/* Discrete choice in O(1) (Vose 1991). */
struct sr_alias {
    uint32_t count;
    float *pmf;       // [1] of each outcome
    float *threshold; // [1]
    uint32_t *other;
};
bool sr_alias_build(struct sr_arena *arena, const float *weights, uint32_t count,
                    struct sr_alias *a); // false: all zero or no memory
uint32_t sr_alias_sample(const struct sr_alias *a, double u, float *pmf, float *u_remapped); // NULL where not wanted
/* u in [0, 1) with bits of a hash below its own 24, which are too few to choose among very many outcomes */
static inline double sr_with_more_bits(float u, uint32_t hash)
{
    return (double)u + ((double)hash + 0.5) * 0x1p-56;
}

/* Piecewise constant on [lo, hi]. A function that is zero everywhere gives the uniform density. */
struct sr_piecewise1 {
    uint32_t count;
    float lo, hi;
    double integral;
    float *f;       // count values
    float *cdf;     // count + 1 values
    float per_unit; // cells [1/length of the interval's unit]
    uint16_t
        *guide; // count + 2 cells: where to look for u between guide[i] and guide[i + 2], i = floor(count u); or NULL
};
bool sr_piecewise1_build(struct sr_arena *arena, const float *f, uint32_t count, float lo, float hi,
                         struct sr_piecewise1 *d);
float sr_piecewise1_sample(const struct sr_piecewise1 *d, float u, float *pdf, uint32_t *cell);
float sr_piecewise1_pdf(const struct sr_piecewise1 *d, float x);

/* Piecewise constant on [0,1]^2, rows first. */
struct sr_piecewise2 {
    uint32_t nx, ny;
    double integral;
    struct sr_piecewise1 marginal;     // over y
    struct sr_piecewise1 *conditional; // over x, one a row
};
bool sr_piecewise2_build(struct sr_arena *arena, const float *f, uint32_t nx, uint32_t ny, struct sr_piecewise2 *d);
sr_vec2 sr_piecewise2_sample(const struct sr_piecewise2 *d, sr_vec2 u, float *pdf);
float sr_piecewise2_pdf(const struct sr_piecewise2 *d, sr_vec2 p);

#endif
