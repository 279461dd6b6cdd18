/* SPDX-License-Identifier: MIT */
/* What the bytes of a store are, for those who write and read them. */
#ifndef SR_STORE_LAYOUT_H
#define SR_STORE_LAYOUT_H

#include "store/store.h"

enum { STORE_FORMAT = 1, STORE_ALIGN = 64 };
static const uint32_t STORE_ORDER = 0x01020304; // reads otherwise on machines of the other byte order
static const char STORE_MAGIC[8] = {'\x89', 'S', 'R', 'K', '\r', '\n', '\x1a', '\n'}; // damaged by any transfer as text

struct store_header {
    char magic[8];
    uint32_t order, format;
    char kind[SR_STORE_KIND];
    uint64_t size; // [B] of the file
    uint32_t sections, unused[4];
    uint32_t crc; // of all before
};
struct store_section {
    char name[SR_STORE_NAME];
    uint64_t size; // [B] of the data
    uint32_t number, unused[2];
    uint32_t crc; // of all before
};
_Static_assert(sizeof(struct store_header) == STORE_ALIGN && sizeof(struct store_section) == STORE_ALIGN,
               "written as they stand");

/* CRC-32 of a header of either kind before its last member. */
uint32_t sr_store_crc_header(const void *header);
/* CRC-32 of a block and of where it belongs. */
uint32_t sr_store_crc_block(uint32_t section, uint64_t block, const void *data, size_t size);

static inline uint64_t store_blocks(uint64_t size)
{
    return size / SR_STORE_BLOCK + (size % SR_STORE_BLOCK != 0);
}

/* size + gap is a multiple of the alignment. */
static inline size_t store_gap(uint64_t size)
{
    return (size_t)(-size % STORE_ALIGN);
}

#endif
