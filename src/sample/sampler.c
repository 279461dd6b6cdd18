/* SPDX-License-Identifier: MIT */
/* Hashes, a small generator, and the start of a sampler with what it draws ahead.
 *
 *     hash of bytes:  h <- fold(h ^ w, K) for each word w of 64 bits,    fold(x, K) = low(x K) ^ high(x K)
 *     PCG32:          s <- 6364136223846793005 s + c,    output = rotate(high bits of (s >> 18 ^ s), s >> 59)
 *
 * M. O'Neill, PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms, 2014. None of these is
 * cryptographic. Bytes are read as little-endian words. */
#include "sample/sample.h"

#include <string.h>

// the finaliser of a 64-bit hash; constants by D. Stafford (2011), variant 13
static uint64_t avalanche(uint64_t x)
{
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ull;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebull;
    return x ^ x >> 31;
}

static uint64_t fold(uint64_t x, uint64_t k)
{
    unsigned __int128 product = (unsigned __int128)x * k;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

uint64_t sr_hash_bytes(const void *data, size_t size, uint64_t seed)
{
    const unsigned char *bytes = data;
    uint64_t h = avalanche(seed + 0x9e3779b97f4a7c15ull) ^ (uint64_t)size * 0xa0761d6478bd642full;
    for (; size >= 8; size -= 8, bytes += 8) {
        uint64_t w;
        memcpy(&w, bytes, 8);
        h = fold(h ^ w, 0xe7037ed1a0b428dbull) + 0x8ebc6af09c88c6e3ull;
    }
    uint64_t tail = 0;
    for (size_t i = 0; i < size; ++i)
        tail |= (uint64_t)bytes[i] << (8 * i);
    return avalanche(fold(h ^ tail, 0xe7037ed1a0b428dbull));
}

struct sr_rng sr_rng_seed(uint64_t seed, uint64_t stream)
{
    struct sr_rng rng = {.state = 0, .increment = stream << 1 | 1};
    sr_rng_u32(&rng);
    rng.state += seed;
    sr_rng_u32(&rng);
    return rng;
}

uint32_t sr_rng_u32(struct sr_rng *rng)
{
    uint64_t old = rng->state;
    rng->state = old * 6364136223846793005ull + rng->increment;
    uint32_t mixed = (uint32_t)((old >> 18 ^ old) >> 27), turn = (uint32_t)(old >> 59);
    return mixed >> turn | mixed << (-turn & 31);
}

struct sr_sampler sr_sampler_start(enum sr_sampler_kind kind, uint32_t seed, uint32_t pixel_x, uint32_t pixel_y,
                                   uint32_t replicate, uint32_t sample)
{
    uint32_t key =
        sr_hash_combine(sr_hash_combine(sr_hash_combine(sr_hash_u32(seed ^ 0x2545f491u), pixel_x), pixel_y), replicate);
    return (struct sr_sampler){.key = key, .sample = sample, .kind = kind};
}

sr_u4_bits sr_sobol_high(uint32_t high_half, uint32_t *seed)
{
    *seed = sr_hash_combine(*seed, high_half);
    return sr_sobol_table[2][sr_reversed_byte[high_half & 255]] ^ sr_sobol_table[3][sr_reversed_byte[high_half >> 8]];
}

uint32_t sr_sampler_draw_ahead(const struct sr_sampler *s, uint32_t count, sr_u8 out[SR_AHEAD_GROUPS / 2 * SR_AHEAD])
{
    if (s->kind == SR_SAMPLER_INDEPENDENT || (s->sample + SR_AHEAD) >> 16)
        return 0;
    sr_u8_bits begun;
    for (uint32_t k = 0; k < SR_AHEAD; ++k)
        begun[k] = sr_index_begin(s->sample + k);
    for (uint32_t pair = 0; pair < SR_AHEAD_GROUPS / 2; ++pair) {
        struct sr_pair_seeds p = sr_pair_seeds(s->key, 2 * pair);
        sr_u8_bits multiply = p.lane >> 16 | 1;
        uint32_t i[2][SR_AHEAD];
        for (int half = 0; half < 2; ++half) {
            sr_u8_bits shuffled = sr_index_shuffle8(begun, p.seed[half]);
            memcpy(i[half], &shuffled, sizeof shuffled);
        }
        for (uint32_t k = 0; k < count; ++k)
            out[pair * SR_AHEAD + k] = sr_scramble8(sr_sobol_point(i[0][k]), sr_sobol_point(i[1][k]), p.lane, multiply);
    }
    return SR_AHEAD_GROUPS;
}
