/* SPDX-License-Identifier: MIT */
/* Sums over a fixed tree: of its definition, and of any cut. */
#include "render/private.h"
#include "test.h"

#include <string.h>

enum { N = 200, BUCKETS = 3 };

static struct sr_block_tree tree, pieces[2];
static double tree_buckets[SR_BLOCK_TREE_NODES * BUCKETS];

static void value_of(uint32_t i, float rgb[3])
{
    struct sr_rng rng = sr_rng_seed(i, 3);
    for (int c = 0; c < 3; ++c)
        rgb[c] = powf(10, 12 * sr_rng_float(&rng) - 6) * (sr_rng_float(&rng) < .3f ? -1 : 1);
}

static void make(struct sr_block_tree *t, uint32_t begin, uint32_t end)
{
    sr_block_tree_begin(t, begin);
    for (uint32_t i = begin; i < end; ++i) {
        float rgb[3];
        double *buckets;
        value_of(i, rgb);
        struct sr_film_block *b = sr_block_tree_sample(t, &buckets);
        sr_film_block_add(b, rgb, true);
        sr_film_block_add_first(b, &(struct sr_first_hit){.is_hit = i > 2, .depth = rgb[0], .material = i});
        if (buckets)
            buckets[i % BUCKETS] = (double)rgb[1];
        sr_block_tree_done(t);
    }
}

/* The definition: of samples [begin, end) of a block that has n. */
static double sum_of(uint32_t begin, uint32_t size, uint32_t n)
{
    float rgb[3];
    value_of(begin, rgb);
    if (size == 1)
        return (double)rgb[0];
    uint32_t half = size / 2;
    return begin + half < n ? sum_of(begin, half, n) + sum_of(begin + half, half, n) : sum_of(begin, half, n);
}

TEST(the_sum_of_a_block_is_that_of_its_tree)
{
    tree.buckets = tree_buckets;
    tree.bucket_count = BUCKETS;
    for (uint32_t n = 1; n <= N; ++n) {
        make(&tree, 0, n);
        int full = __builtin_popcount(n);
        EXPECT(tree.depth == (uint32_t)full);
        sr_block_tree_fold(&tree);
        double wanted = sum_of(0, 256, n), buckets = 0, sums = 0;
        EXPECT(memcmp(&tree.nodes[0].rgb[0], &wanted, sizeof wanted) == 0);
        EXPECT(tree.nodes[0].n == n && tree.nodes[0].samples_seen == n && tree.nodes[0].hits == (n > 3 ? n - 3 : 0));
        EXPECT(tree.nodes[0].first_sum.material == (n > 3 ? 3u : 0)); // of the first sample that has hit something
        for (int i = 0; i < BUCKETS; ++i)
            buckets += tree_buckets[i], sums += fabs(tree_buckets[i]);
        EXPECT_NEAR(buckets, tree.nodes[0].rgb[1], 1e-14 * sums * N);
    }
    tree.buckets = NULL;
}

/* Halves that are there are joined: whole pieces of a cut run are those of the whole run. */
TEST(any_cut_leaves_nodes_that_join_to_the_same_sum)
{
    for (uint32_t cut = 0; cut <= N; ++cut) {
        make(&pieces[0], 0, cut);
        make(&pieces[1], cut, N);
        struct {
            struct sr_film_block b;
            uint32_t begin, size;
        } stack[2 * SR_BLOCK_TREE_NODES];
        uint32_t depth = 0, at = 0;
        for (int p = 0; p < 2; ++p)
            for (uint32_t i = 0; i < pieces[p].depth; ++i) {
                uint32_t size = pieces[p].nodes[i].n;
                EXPECT((size & (size - 1)) == 0 && at % size == 0); // a node of the tree
                stack[depth].b = pieces[p].nodes[i], stack[depth].begin = at, stack[depth++].size = size;
                at += size;
                for (; depth > 1 && stack[depth - 1].size == stack[depth - 2].size &&
                       stack[depth - 2].begin % (2 * stack[depth - 2].size) == 0;
                     --depth) {
                    sr_film_block_join(&stack[depth - 2].b, &stack[depth - 1].b);
                    stack[depth - 2].size *= 2;
                }
            }
        EXPECT(at == N);
        for (; depth > 1; --depth)
            sr_film_block_join(&stack[depth - 2].b, &stack[depth - 1].b);
        make(&tree, 0, N);
        sr_block_tree_fold(&tree);
        EXPECT(memcmp(&stack[0].b, &tree.nodes[0], sizeof tree.nodes[0]) == 0);
    }
}
