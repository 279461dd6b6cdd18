/* SPDX-License-Identifier: MIT */
/* From a name to its place in a list: open addressing, linear probing, at most half full. FNV-1a (Fowler, Noll, Vo). */
#include "import/pbrt/description.h"

#include <string.h>

static uint32_t hash_of(const char *name)
{
    uint32_t h = 2166136261u;
    for (; *name; ++name)
        h = (h ^ (unsigned char)*name) * 16777619u;
    return h ^ h >> 15;
}

/* The slot that holds the name, or the free one where it belongs. */
static uint32_t find_slot(const struct sr_pbrt_names *n, const char *name)
{
    uint32_t i = hash_of(name) & (n->slot_count - 1);
    while (n->slots[i].name && strcmp(n->slots[i].name, name) != 0)
        i = (i + 1) & (n->slot_count - 1);
    return i;
}

uint32_t sr_pbrt_names_find(const struct sr_pbrt_names *n, const char *name)
{
    return n->slot_count ? n->slots[find_slot(n, name)].index1 : 0;
}

bool sr_pbrt_names_add(struct sr_pbrt_names *n, const char *name, uint32_t index1)
{
    if (2 * (n->count + 1) > n->slot_count) {
        struct sr_pbrt_names grown = {.slot_count = n->slot_count ? 2 * n->slot_count : 64};
        grown.slots = sr_alloc(grown.slot_count * sizeof *grown.slots);
        if (!grown.slots)
            return false;
        for (uint32_t i = 0; i < n->slot_count; ++i)
            if (n->slots[i].name)
                grown.slots[find_slot(&grown, n->slots[i].name)] = n->slots[i];
        grown.count = n->count;
        sr_free(n->slots);
        *n = grown;
    }
    uint32_t i = find_slot(n, name);
    n->count += !n->slots[i].name;
    n->slots[i].name = name;
    n->slots[i].index1 = index1;
    return true;
}

void sr_pbrt_names_free(struct sr_pbrt_names *n)
{
    sr_free(n->slots);
    *n = (struct sr_pbrt_names){0};
}

void sr_pbrt_names_suggest(const struct sr_pbrt_names *n, struct sr_pbrt_suggestion *s)
{
    uint32_t best = UINT32_MAX; // of those equally near the first in the file
    for (uint32_t i = 0; i < n->slot_count; ++i) {
        if (!n->slots[i].name)
            continue;
        struct sr_pbrt_suggestion one = {.word = s->word};
        sr_pbrt_suggest(&one, n->slots[i].name);
        if (!s->best || one.distance < s->distance || (one.distance == s->distance && n->slots[i].index1 < best)) {
            *s = one;
            best = n->slots[i].index1;
        }
    }
}
