/* SPDX-License-Identifier: MIT */
/* Sums over a fixed binary tree, made with a stack.
 *
 *     S(level, k) = S(level - 1, 2 k) + S(level - 1, 2 k + 1),   S(0, i) = sample i,
 *         |error| <= log2(n) eps sum |sample|
 *
 * Floats do not add to the same sum in any order, but they do along the same tree: a run that is cut anywhere leaves
 * the largest nodes that lie within each piece (2 log2 n at most), and these join to the nodes of the run that was not
 * cut. What is not a full tree at the end of a block is folded from the right. N. Higham 1993, The accuracy of floating
 * point summation, for the bound; docs/decisions/0018-sums-over-a-tree.md. Limits: blocks of less than 2^32 samples. */
#include "render/private.h"

#include <string.h>

void sr_block_tree_begin(struct sr_block_tree *t, uint32_t first)
{
    t->first = t->next = first;
    t->depth = 0;
}

static double *buckets_of(const struct sr_block_tree *t, uint32_t node)
{
    return t->buckets + (size_t)node * t->bucket_count;
}

struct sr_film_block *sr_block_tree_sample(struct sr_block_tree *t, double **buckets)
{
    *buckets = NULL;
    if (SR_UNLIKELY(t->buckets)) {
        *buckets = buckets_of(t, t->depth);
        memset(*buckets, 0, t->bucket_count * sizeof **buckets);
    }
    t->nodes[t->depth] = (struct sr_film_block){0};
    return &t->nodes[t->depth];
}

static void join_last(struct sr_block_tree *t)
{
    uint32_t last = --t->depth;
    sr_film_block_join(&t->nodes[last - 1], &t->nodes[last]);
    if (SR_UNLIKELY(t->buckets)) {
        double *a = buckets_of(t, last - 1), *b = buckets_of(t, last);
        for (uint32_t i = 0; i < t->bucket_count; ++i)
            a[i] += b[i];
    }
}

void sr_block_tree_done(struct sr_block_tree *t)
{
    t->depth += 1;
    uint32_t i = t->next++;
    // a right half joins the left one, if that is here: its first sample is 2^level before its own first
    for (uint32_t size = 1; i & size && t->next - t->first >= 2 * size; size *= 2)
        join_last(t);
}

void sr_block_tree_fold(struct sr_block_tree *t)
{
    while (t->depth > 1)
        join_last(t);
}
