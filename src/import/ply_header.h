/* SPDX-License-Identifier: MIT */
/* The head of a PLY file: which elements follow, how many of each, and what properties they have. */
#ifndef SR_IMPORT_PLY_HEADER_H
#define SR_IMPORT_PLY_HEADER_H

#include "base/base.h"

enum sr_ply_type {
    SR_PLY_INT8,
    SR_PLY_UINT8,
    SR_PLY_INT16,
    SR_PLY_UINT16,
    SR_PLY_INT32,
    SR_PLY_UINT32,
    SR_PLY_FLOAT32,
    SR_PLY_FLOAT64
};
enum sr_ply_format { SR_PLY_ASCII, SR_PLY_LITTLE_ENDIAN, SR_PLY_BIG_ENDIAN };

struct sr_ply_property {
    char name[32];
    bool is_list;
    enum sr_ply_type count_type, type;
    uint32_t offset; // [B] from the element's start, where no list comes before
};

enum { SR_PLY_MAX_ELEMENTS = 16, SR_PLY_MAX_PROPERTIES = 64 };

struct sr_ply_element {
    char name[32];
    uint64_t count;
    struct sr_ply_property properties[SR_PLY_MAX_PROPERTIES];
    uint32_t property_count;
    uint32_t list_count;
    uint32_t least_size; // [B] of one in the file, lists empty
};

struct sr_ply_header {
    enum sr_ply_format format;
    struct sr_ply_element elements[SR_PLY_MAX_ELEMENTS];
    uint32_t element_count;
    size_t size; // [B] of the head itself
};

static inline uint32_t sr_ply_type_size(enum sr_ply_type type)
{
    static const uint8_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

sr_status sr_ply_header_read(const char *label, const char *data, size_t size, struct sr_ply_header *header,
                             struct sr_error *error);
int sr_ply_find_property(const struct sr_ply_element *element, const char *name); // -1: none

#endif
