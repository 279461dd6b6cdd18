/* SPDX-License-Identifier: MIT */
/* Names of files as a scene means them, and a hash of all that was read. */
#include "import/pbrt/build.h"

#include <string.h>

/* A file in memory has its name as it is. From the folder of the first scene file; where nothing is there, from the
 * folder of the file that names it. */
char *sr_pbrt_resolve(struct sr_pbrt_build *b, struct sr_arena *arena, const char *name, struct sr_location where)
{
    if (sr_pbrt_memory_file(b->d, name))
        return sr_arena_string(arena, name);
    char *path = sr_path_beside(arena, b->main_path, name);
    if (!path || !where.file || sr_file_exists(path))
        return path;
    char *nearer = sr_path_beside(arena, where.file, name);
    return nearer && sr_file_exists(nearer) ? nearer : path;
}

/* Eight bytes a step: multiply by an odd constant, fold the upper half into the lower. */
uint64_t sr_pbrt_hash(uint64_t hash, const void *data, size_t size)
{
    const char *p = data;
    uint64_t word = size, h = hash;
    for (size_t left = size;; left -= 8, p += 8) {
        h = (h ^ word) * 0x9fb21c651e98df25u;
        h ^= h >> 32;
        if (left == 0)
            return h;
        word = 0;
        memcpy(&word, p, left < 8 ? left : 8);
        if (left < 8) {
            h = (h ^ word) * 0x9fb21c651e98df25u;
            return h ^ h >> 32;
        }
    }
}

void sr_pbrt_hash_file(struct sr_pbrt_build *b, const char *path)
{
    static const char *const images[] = {".exr", ".png", ".jpg", ".jpeg", ".tga", ".hdr", ".pfm", ".qoi"};
    for (size_t i = 0; i < sizeof images / sizeof images[0]; ++i)
        if (sr_path_has_ending(path, images[i]))
            return;
    char *data;
    size_t size;
    struct sr_error ignored = {0}; // whoever wants the file will say so
    if (sr_pbrt_memory_file(b->d, path) || sr_file_read(path, (size_t)64 << 30, &data, &size, &ignored) != SR_OK)
        return;
    b->hash = sr_pbrt_hash(b->hash, data, size);
    sr_free(data);
}
