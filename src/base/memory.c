/* SPDX-License-Identifier: MIT */
/* Memory: the only file that asks the system for it. Three lifetimes use it through arenas: scene, job, scratch. */
#define _DEFAULT_SOURCE // madvise
#include "base/base.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static atomic_ullong alloc_count, free_count;
static uint64_t fail_first, fail_count; // for tests

/* What is large is read all over: large pages spare the processor most of the looking up of addresses. */
static const size_t LARGE_PAGE = 2 << 20; // [B]

static size_t round_up(size_t size, size_t to)
{
    return (size + to - 1) & ~(to - 1);
}

static bool count_one(void)
{
    return atomic_fetch_add_explicit(&alloc_count, 1, memory_order_relaxed) - fail_first >= fail_count;
}

static void count_end(bool is_one)
{
    atomic_fetch_add_explicit(&free_count, is_one, memory_order_relaxed);
}

bool sr_alloc_allowed(void)
{
    count_end(true);
    return count_one();
}

void sr_alloc_fail(uint64_t after, uint64_t count)
{
    fail_first = sr_alloc_count() + after;
    fail_count = count;
}

void *sr_alloc(size_t size)
{
    if (!count_one() || size > SIZE_MAX / 4) {
        count_end(true);
        return NULL;
    }
    bool is_large = size >= LARGE_PAGE;
    size_t whole = round_up(size ? size : 1, 64);
    void *p = is_large ? aligned_alloc(LARGE_PAGE, round_up(whole, LARGE_PAGE)) : aligned_alloc(64, whole);
#ifdef MADV_HUGEPAGE
    if (p && is_large) // the rest after the last whole page would be wasted
        madvise(p, whole / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE);
#endif
    if (p)
        memset(p, 0, whole);
    count_end(!p);
    return p;
}

void *sr_realloc(void *p, size_t old_size, size_t new_size)
{
    void *q = sr_alloc(new_size);
    if (q && p) {
        memcpy(q, p, old_size < new_size ? old_size : new_size);
        sr_free(p);
    }
    return q;
}

void sr_free(void *p)
{
    count_end(p != NULL);
    free(p);
}

uint64_t sr_alloc_live(void)
{
    return sr_alloc_count() - atomic_load_explicit(&free_count, memory_order_relaxed);
}

uint64_t sr_alloc_count(void)
{
    return atomic_load_explicit(&alloc_count, memory_order_relaxed);
}

/* ---- arenas: a list of blocks, each twice the last up to 4 MiB; large things get a block of their own ---- */

struct sr_arena_block {
    struct sr_arena_block *next;
    size_t size; // [B] that can be handed out
    _Alignas(64) char bytes[];
};

enum { FIRST_BLOCK = 16 * 1024, LAST_BLOCK = 4 * 1024 * 1024 };

void *sr_arena_alloc(struct sr_arena *arena, size_t size)
{
    if (size > SIZE_MAX / 4)
        return NULL;
    size = round_up(size ? size : 1, 64);
    if (!arena->blocks || arena->blocks->size - arena->used < size) {
        size_t grown = arena->blocks ? arena->blocks->size * 2 : FIRST_BLOCK;
        size_t block_size = grown < LAST_BLOCK ? grown : LAST_BLOCK;
        bool is_large = size > block_size / 4 && arena->blocks;
        if (is_large || size > block_size)
            block_size = size;
        struct sr_arena_block *block = sr_alloc(sizeof *block + block_size);
        if (!block)
            return NULL;
        block->size = block_size;
        if (is_large) { // behind the newest, which still has room
            block->next = arena->blocks->next;
            arena->blocks->next = block;
            arena->total += size;
            return block->bytes;
        }
        block->next = arena->blocks;
        arena->blocks = block;
        arena->used = 0;
    }
    void *p = arena->blocks->bytes + arena->used;
    arena->used += size;
    arena->total += size;
    return p;
}

void *sr_arena_copy(struct sr_arena *arena, const void *data, size_t size)
{
    void *p = sr_arena_alloc(arena, size);
    if (p && size)
        memcpy(p, data, size);
    return p;
}

char *sr_arena_string(struct sr_arena *arena, const char *text)
{
    return sr_arena_copy(arena, text, strlen(text) + 1);
}

char *sr_arena_printf(struct sr_arena *arena, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    va_list again;
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    char *text = length < 0 ? NULL : sr_arena_alloc(arena, (size_t)length + 1);
    if (text)
        vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    va_end(arguments);
    return text;
}

void sr_arena_adopt(struct sr_arena *to, struct sr_arena *from)
{
    if (!to->blocks) {
        *to = *from;
    } else if (from->blocks) { // behind the newest, which still has room
        struct sr_arena_block *last = from->blocks;
        while (last->next)
            last = last->next;
        last->next = to->blocks->next;
        to->blocks->next = from->blocks;
        to->total += from->total;
    }
    *from = (struct sr_arena){0};
}

void sr_arena_free(struct sr_arena *arena)
{
    for (struct sr_arena_block *block = arena->blocks; block;) {
        struct sr_arena_block *next = block->next;
        sr_free(block);
        block = next;
    }
    *arena = (struct sr_arena){0};
}

/* ---- growable arrays ---- */

bool sr_array_reserve(struct sr_array *array, size_t count, size_t element_size)
{
    if (count <= array->capacity)
        return true;
    size_t capacity = array->capacity ? array->capacity : 16;
    while (capacity < count)
        capacity *= 2;
    if (capacity > SIZE_MAX / 8 / element_size)
        return false;
    void *data = sr_realloc(array->data, array->count * element_size, capacity * element_size);
    if (!data)
        return false;
    array->data = data;
    array->capacity = capacity;
    return true;
}

void *sr_array_push(struct sr_array *array, size_t element_size)
{
    if (!sr_array_reserve(array, array->count + 1, element_size))
        return NULL;
    return (char *)array->data + element_size * array->count++;
}

void sr_array_free(struct sr_array *array)
{
    sr_free(array->data);
    *array = (struct sr_array){0};
}
