/* SPDX-License-Identifier: MIT */
/* The sampler: nets, independence, convergence; hashes and the small generator. */
#include "sample/sample.h"

#include "test.h"

static sr_u4 draw(uint32_t key, uint32_t sample, uint32_t group)
{
    struct sr_sampler s = {.key = key, .sample = sample, .kind = SR_SAMPLER_SOBOL};
    return sr_sample4(&s, group);
}

// a direct computation of Sobol's sequence, bit by bit, from the recurrence
static uint32_t sobol(uint32_t index, int dimension)
{
    static const struct {
        int degree;
        uint32_t a, m[3];
    } polynomial[4] = {{0, 0, {0}}, {1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};
    uint32_t m[32], x = 0;
    int s = polynomial[dimension].degree;
    for (int k = 0; k < 32; ++k) {
        if (s == 0)
            m[k] = 1;
        else if (k < s)
            m[k] = polynomial[dimension].m[k];
        else {
            m[k] = m[k - s] ^ m[k - s] << s;
            for (int i = 1; i < s; ++i)
                if (polynomial[dimension].a >> (s - 1 - i) & 1)
                    m[k] ^= m[k - i] << i;
        }
        if (index >> k & 1)
            x ^= m[k] << (31 - k);
    }
    return x;
}

static uint32_t reverse(uint32_t x)
{
    uint32_t r = 0;
    for (int i = 0; i < 32; ++i)
        r |= (x >> i & 1) << (31 - i);
    return r;
}

TEST(sobol_table_holds_the_published_sequence)
{
    for (uint32_t k = 0; k < 4096; ++k) {
        uint32_t index = sr_hash_u32(k);
        sr_u4_bits x = {0, 0, 0, 0};
        for (int byte = 0; byte < 4; ++byte)
            x ^= sr_sobol_table[byte][sr_reversed_byte[index >> (8 * byte) & 255]];
        for (int d = 0; d < 4; ++d)
            EXPECT_EQUAL_INT(reverse(x[d]), sobol(index, d));
    }
    // the first points of the second dimension are 0, 1/2, 3/4, 1/4, 5/8, …
    EXPECT_EQUAL_INT(sobol(3, 1) >> 28, 4);
    EXPECT_EQUAL_INT(sobol(4, 1) >> 28, 10);
    EXPECT_EQUAL_INT(sr_reversed_byte[1], 128);
}

static void expect_net(uint32_t key, uint32_t group, uint32_t first, int k)
{
    static unsigned char filled[1 << 12];
    uint32_t n = 1u << k;
    for (int cut = 0; cut <= k; ++cut) {
        memset(filled, 0, n);
        for (uint32_t i = 0; i < n; ++i) {
            sr_u4 u = draw(key, first + i, group);
            uint32_t cell =
                (uint32_t)(u[0] * (float)(1u << cut)) << (k - cut) | (uint32_t)(u[1] * (float)(1u << (k - cut)));
            EXPECT(!filled[cell]);
            filled[cell] = 1;
        }
    }
    for (int d = 2; d < 4; ++d) {
        memset(filled, 0, n);
        for (uint32_t i = 0; i < n; ++i) {
            uint32_t cell = (uint32_t)(draw(key, first + i, group)[d] * (float)n);
            EXPECT(!filled[cell]);
            filled[cell] = 1;
        }
    }
}

TEST(aligned_blocks_are_nets_of_every_shape)
{
    for (int k = 0; k <= 12; ++k)
        for (uint32_t group = 0; group < 4; ++group) {
            uint32_t key = sr_hash_u32(group * 17 + (uint32_t)k), n = 1u << k;
            expect_net(key, group * 1009, 0, k);
            expect_net(key, group, n, k);
            expect_net(key, group, 5 * n, k);
            expect_net(key, group, 0x30000u + 3 * n, k); // beyond the first 65536
            expect_net(key, group, 0xfff00000u, k);
        }
    // across the border of the blocks in which the index is shuffled
    static unsigned char filled[1 << 17];
    for (uint32_t i = 0; i < 1u << 17; ++i) {
        uint32_t cell = (uint32_t)(draw(3, i, 9)[1] * 0x1p17f);
        EXPECT(!filled[cell]);
        filled[cell] = 1;
    }
}

TEST(numbers_stay_below_one_and_repeat)
{
    for (uint32_t i = 0; i < 300000; ++i) {
        sr_u4 u = draw(i * 7, i & 63, i >> 4), v = draw(i * 7, i & 63, i >> 4);
        for (int d = 0; d < 4; ++d)
            EXPECT(u[d] >= 0 && u[d] < 1 && u[d] == v[d]);
    }
    EXPECT(sr_bits_to_u4((sr_u4_bits){~0u, 0, 0, 0})[0] < 1);
}

TEST(each_point_alone_is_uniform_over_the_keys)
{
    // any one sample, and pairs of lanes of it, over many pixels
    for (uint32_t kind = 0; kind < 2; ++kind)
        for (uint32_t sample = 0; sample < 300; sample = sample * 3 + 1) {
            static double one[4][256], pair[6][256], expected[256];
            memset(one, 0, sizeof one);
            memset(pair, 0, sizeof pair);
            int n = 16384;
            for (int i = 0; i < n; ++i) {
                struct sr_sampler s =
                    sr_sampler_start((enum sr_sampler_kind)kind, 1, (uint32_t)i & 127, (uint32_t)i >> 7, 0, sample);
                sr_u4 u = sr_sample4(&s, sample % 5);
                for (int d = 0, q = 0; d < 4; ++d) {
                    one[d][(int)(u[d] * 256)] += 1;
                    for (int e = d + 1; e < 4; ++e)
                        pair[q++][(int)(u[d] * 16) * 16 + (int)(u[e] * 16)] += 1;
                }
            }
            for (int i = 0; i < 256; ++i)
                expected[i] = n / 256.0;
            for (int d = 0; d < 4; ++d)
                EXPECT_CHI2(one[d], expected, 256);
            for (int q = 0; q < 6; ++q)
                EXPECT_CHI2(pair[q], expected, 256);
        }
}

TEST(scrambled_means_are_unbiased)
{
    for (int n = 1; n <= 64; n *= 4) {
        struct sr_tally mean = {0}, product = {0};
        for (uint32_t key = 0; key < 4000; ++key) {
            double a = 0, b = 0;
            for (uint32_t i = 0; i < (uint32_t)n; ++i) {
                sr_u4 u = draw(sr_hash_u32(key), i, 3);
                a += (double)(u[0] * u[0]) / n;
                b += (double)(u[0] * u[1] * u[2] * u[3]) / n;
            }
            sr_tally_add(&mean, a);
            sr_tally_add(&product, b);
        }
        EXPECT_MEAN(mean, 1.0 / 3);
        EXPECT_MEAN(product, 1.0 / 16);
    }
}

TEST(groups_keys_and_seeds_are_uncorrelated)
{
    // sample by sample between groups of one pixel, and between neighbours and replicates in one group
    for (int kind = 0; kind < 2; ++kind)
        for (int other = 0; other < 5; ++other) {
            struct sr_tally product[16] = {{0}};
            for (uint32_t pixel = 0; pixel < 3000; ++pixel) {
                double sum[16] = {0};
                for (uint32_t i = 0; i < 16; ++i) {
                    enum sr_sampler_kind k = (enum sr_sampler_kind)kind;
                    struct sr_sampler s = sr_sampler_start(k, 5, pixel, 7, 0, i), t = s;
                    uint32_t group = 4;
                    if (other == 0 || other == 1)
                        group = other == 0 ? 5 : 4 + 256;
                    else
                        t = sr_sampler_start(k, other == 2 ? 6 : 5, pixel + (other == 3), 7, other == 4, i);
                    sr_u4 u = sr_sample4(&s, 4), v = sr_sample4(&t, group);
                    for (int c = 0; c < 16; ++c)
                        sum[c] += (double)((u[c / 4] - 0.5f) * (v[c % 4] - 0.5f));
                }
                for (int c = 0; c < 16; ++c)
                    sr_tally_add(&product[c], sum[c]);
            }
            for (int c = 0; c < 16; ++c)
                EXPECT_MEAN(product[c], 0);
        }
}

// root mean square error of an integral over the square, times over many keys
static double rms_error(uint32_t kind, uint32_t n, bool padded)
{
    double sum = 0, exact = (1 - cos(1.0)) * (M_E - 1);
    uint32_t runs = 200;
    for (uint32_t key = 0; key < runs; ++key) {
        double estimate = 0;
        for (uint32_t i = 0; i < n; ++i) {
            struct sr_sampler s = {.key = sr_hash_u32(key + 99), .sample = i, .kind = kind};
            sr_u4 u = sr_sample4(&s, 2);
            double y = (double)(padded ? sr_sample4(&s, 3)[0] : u[1]);
            estimate += sin((double)u[0]) * exp(y) / n;
        }
        sum += (estimate - exact) * (estimate - exact) / runs;
    }
    return sqrt(sum);
}

TEST(smooth_integrals_converge_with_the_power_three_halves)
{
    double slope = log(rms_error(SR_SAMPLER_SOBOL, 1024, false) / rms_error(SR_SAMPLER_SOBOL, 16, false)) / log(64);
    double padded = log(rms_error(SR_SAMPLER_SOBOL, 1024, true) / rms_error(SR_SAMPLER_SOBOL, 16, true)) / log(64);
    double random =
        log(rms_error(SR_SAMPLER_INDEPENDENT, 1024, false) / rms_error(SR_SAMPLER_INDEPENDENT, 16, false)) / log(64);
    EXPECT(slope < -1.2 && slope > -1.8);
    EXPECT_NEAR(random, -0.5, 0.06);
    // padding adds only the part that depends on both numbers at once: never worse than random
    EXPECT(padded < -0.45);
    EXPECT(rms_error(SR_SAMPLER_SOBOL, 256, true) < 0.35 * rms_error(SR_SAMPLER_INDEPENDENT, 256, false));
}

TEST(owen_scrambling_has_the_variance_of_a_random_nested_scramble)
{
    // the mean of u over a net of n: each point is uniform within its own interval, variance 1 / (12 n^3)
    for (uint32_t n = 1; n <= 256; n *= 4)
        for (int d = 0; d < 4; ++d) {
            struct sr_tally squared = {0};
            for (uint32_t key = 0; key < 4000; ++key) {
                double mean = 0;
                for (uint32_t i = 0; i < n; ++i)
                    mean += (double)draw(sr_hash_u32(key + 7), i, 1)[d] / n;
                sr_tally_add(&squared, (mean - 0.5) * (mean - 0.5) * 12 * n * n * n);
            }
            EXPECT_NEAR(squared.mean, 1, 0.15);
        }
}

TEST(hashes_of_bytes_avalanche_and_tell_lengths_apart)
{
    for (size_t size = 1; size <= 40; size = size * 2 + 1) {
        unsigned char bytes[64] = {0};
        struct sr_tally flips = {0};
        for (uint64_t round = 0; round < 64; ++round) {
            for (size_t i = 0; i < size; ++i)
                bytes[i] = (unsigned char)sr_hash_u32((uint32_t)(round * 64 + i));
            uint64_t h = sr_hash_bytes(bytes, size, 1);
            for (size_t bit = 0; bit < 8 * size; ++bit) {
                bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
                int flipped = __builtin_popcountll(h ^ sr_hash_bytes(bytes, size, 1));
                bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
                sr_tally_add(&flips, flipped);
                EXPECT(flipped > 8 && flipped < 56);
            }
        }
        EXPECT_MEAN(flips, 32);
        EXPECT_NEAR(sr_tally_variance(&flips), 16, 16 * 5 * sqrt(2.0 / (double)flips.n));
    }
    unsigned char zeros[64] = {0};
    for (size_t a = 0; a < 64; ++a)
        for (size_t b = 0; b < a; ++b)
            EXPECT(sr_hash_bytes(zeros, a, 0) != sr_hash_bytes(zeros, b, 0));
    EXPECT(sr_hash_bytes("abc", 3, 0) != sr_hash_bytes("abc", 3, 1));
}

TEST(pcg32_gives_its_published_numbers)
{
    struct sr_rng rng = sr_rng_seed(42, 54);
    uint32_t published[6] = {0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e};
    for (int i = 0; i < 6; ++i)
        EXPECT_EQUAL_INT(sr_rng_u32(&rng), published[i]);
}

static bool same4(sr_u4 a, sr_u4 b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

TEST(numbers_in_pairs_and_drawn_ahead_are_those_of_groups_alone)
{
    const uint32_t starts[] = {0, 1, 13, 255, 65520, 65527, 65528, 65535, 65536, 1u << 20};
    for (int kind = SR_SAMPLER_SOBOL; kind <= SR_SAMPLER_INDEPENDENT; ++kind) {
        for (size_t j = 0; j < SR_AHEAD * (sizeof starts / sizeof *starts); ++j) {
            sr_u8 ahead[SR_AHEAD_GROUPS / 2 * SR_AHEAD];
            struct sr_sampler start = {
                .key = sr_hash_u32((uint32_t)j), .sample = starts[j / SR_AHEAD], .kind = (uint32_t)kind};
            uint32_t count = 1 + (uint32_t)j % SR_AHEAD, drawn = sr_sampler_draw_ahead(&start, count, ahead);
            bool is_ahead = kind == SR_SAMPLER_SOBOL && start.sample < 65528;
            EXPECT(drawn == (is_ahead ? SR_AHEAD_GROUPS : 0));
            for (uint32_t k = 0; k < count; ++k) {
                struct sr_sampler alone = start, with = start;
                alone.sample += k;
                with = alone, with.drawn = drawn, with.ahead = ahead + k;
                for (uint32_t group = 0; group < SR_AHEAD_GROUPS + 3; ++group) {
                    sr_u4 a, b, c, d;
                    sr_sample8(&with, group, &a, &b);
                    sr_sample8(&alone, group, &c, &d);
                    EXPECT(same4(a, c) && same4(b, d));
                    EXPECT(same4(c, sr_sample4(&alone, group)) && same4(d, sr_sample4(&alone, group + 1)));
                }
            }
        }
    }
}
