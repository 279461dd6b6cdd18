/* SPDX-License-Identifier: MIT */
/* Reads a store, and trusts nothing of it: sizes are checked against the file's own before they are used, then every
 * bit. */
#define _POSIX_C_SOURCE 200809L
#include "store/layout.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct sr_store_in {
    const char *path; // of the caller, while it is opened
    char *bytes;
    uint64_t size; // [B]
    struct store_header header;
    struct place {
        uint64_t begin, size, sums; // [B] data, its size, checksums
    } * places;
    uint64_t first_bad; // the first block of it that does not match its checksum; UINT64_MAX: none
    uint32_t section;   // that is being checked
};

static bool read_all(int fd, char *bytes, uint64_t size)
{
    while (size > 0) {
        ssize_t got = read(fd, bytes, size < 1u << 30 ? (size_t)size : 1u << 30);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        bytes += got;
        size -= (uint64_t)got;
    }
    return true;
}

static sr_status check_header(struct sr_store_in *in, const char *kind, struct sr_error *error)
{
    struct store_header *h = &in->header;
    if (in->size < sizeof *h || memcmp(in->bytes, STORE_MAGIC, sizeof STORE_MAGIC) != 0)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: is no checkpoint or part of Steradian's, or its first bytes are damaged", in->path);
    memcpy(h, in->bytes, sizeof *h);
    if (h->order == __builtin_bswap32(STORE_ORDER))
        return sr_fail(error, SR_ERROR_INPUT, "%s: was written on a machine of the other byte order", in->path);
    if (h->crc != sr_store_crc_header(h))
        return sr_fail(error, SR_ERROR_INPUT, "%s: is damaged: its header (bytes 0 to 63) does not match its checksum",
                       in->path);
    if (h->order != STORE_ORDER || h->format != STORE_FORMAT)
        return sr_fail(error, SR_ERROR_INPUT, "%s: has the format %u, this program knows %d", in->path, h->format,
                       STORE_FORMAT);
    if (!memchr(h->kind, 0, sizeof h->kind) || h->sections > SR_STORE_SECTIONS)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is damaged: its header (bytes 0 to 63) makes no sense", in->path);
    if (kind && strcmp(kind, h->kind) != 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is a %s, and a %s was expected", in->path, h->kind, kind);
    if (h->size != in->size)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is damaged: has %llu bytes, and %llu were written", in->path,
                       (unsigned long long)in->size, (unsigned long long)h->size);
    return SR_OK;
}

static sr_status fail_gap(const struct sr_store_in *in, uint64_t at, const char *name, struct sr_error *error)
{
    return sr_fail(error, SR_ERROR_INPUT, "%s: is damaged at byte %llu: the gap in section \"%s\" is not zero",
                   in->path, (unsigned long long)at, name);
}

static bool is_zero(const char *bytes, size_t n)
{
    for (size_t i = 0; i < n; ++i)
        if (bytes[i])
            return false;
    return true;
}

/* Where sections lie; nothing reaches beyond the file. */
static sr_status find_sections(struct sr_store_in *in, struct sr_error *error)
{
    uint64_t at = sizeof in->header;
    for (uint32_t i = 0; i < in->header.sections; ++i) {
        struct store_section s;
        if (in->size - at < sizeof s)
            return sr_fail(error, SR_ERROR_INPUT, "%s: is damaged: ends within section %u", in->path, i);
        memcpy(&s, in->bytes + at, sizeof s);
        if (s.crc != sr_store_crc_header(&s) || s.number != i || !memchr(s.name, 0, sizeof s.name))
            return sr_fail(error, SR_ERROR_INPUT,
                           "%s: is damaged: the header of section %u (bytes %llu to %llu) does not match its checksum",
                           in->path, i, (unsigned long long)at, (unsigned long long)at + 63);
        at += sizeof s;
        uint64_t left = in->size - at, sums = store_blocks(s.size) * sizeof(uint32_t);
        if (s.size > left || store_gap(s.size) > left - s.size ||
            sums + store_gap(sums) > left - s.size - store_gap(s.size))
            return sr_fail(error, SR_ERROR_INPUT,
                           "%s: is damaged: section \"%s\" of %llu bytes reaches beyond the end of the file", in->path,
                           s.name, (unsigned long long)s.size);
        struct place *p = &in->places[i];
        *p = (struct place){.begin = at, .size = s.size, .sums = at + s.size + store_gap(s.size)};
        if (!is_zero(in->bytes + at + s.size, store_gap(s.size)))
            return fail_gap(in, at + s.size, s.name, error);
        if (!is_zero(in->bytes + p->sums + sums, store_gap(sums)))
            return fail_gap(in, p->sums + sums, s.name, error);
        at = p->sums + sums + store_gap(sums);
    }
    if (at != in->size)
        return sr_fail(error, SR_ERROR_INPUT, "%s: is damaged: more follows after its last section", in->path);
    return SR_OK;
}

static const char *name_of(const struct sr_store_in *in, uint32_t number)
{
    return in->bytes + in->places[number].begin - sizeof(struct store_section);
}

static void check_block(void *context, uint64_t block)
{
    struct sr_store_in *in = context;
    const struct place *p = &in->places[in->section];
    uint64_t at = block * SR_STORE_BLOCK;
    size_t n = p->size - at < SR_STORE_BLOCK ? (size_t)(p->size - at) : SR_STORE_BLOCK;
    uint32_t crc;
    memcpy(&crc, in->bytes + p->sums + block * sizeof crc, sizeof crc);
    if (crc == sr_store_crc_block(in->section, block, in->bytes + p->begin + at, n))
        return;
    uint64_t first = __atomic_load_n(&in->first_bad, __ATOMIC_RELAXED);
    while (block < first &&
           !__atomic_compare_exchange_n(&in->first_bad, &first, block, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
        continue;
}

static sr_status check_data(struct sr_store_in *in, struct sr_error *error)
{
    for (in->section = 0; in->section < in->header.sections; ++in->section) {
        const struct place *p = &in->places[in->section];
        uint64_t blocks = store_blocks(p->size);
        in->first_bad = UINT64_MAX;
        sr_parallel_for(blocks < 64 ? 1 : sr_thread_count(), blocks, check_block, in);
        if (in->first_bad != UINT64_MAX)
            return sr_fail(
                error, SR_ERROR_INPUT,
                "%s: is damaged: section \"%s\" does not match its checksum in the block at byte %llu of the file",
                in->path, name_of(in, in->section), (unsigned long long)(p->begin + in->first_bad * SR_STORE_BLOCK));
    }
    return SR_OK;
}

static sr_status load(struct sr_store_in *in, int fd, struct sr_error *error)
{
    struct stat st;
    if (fstat(fd, &st) != 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: cannot be read: %s", in->path, strerror(errno));
    if (!S_ISREG(st.st_mode))
        return sr_fail(error, SR_ERROR_INPUT, "%s: is no ordinary file", in->path);
    in->size = (uint64_t)st.st_size;
    in->bytes = sr_alloc((size_t)in->size + 1);
    if (!in->bytes)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory for its %llu bytes", in->path,
                       (unsigned long long)in->size);
    errno = 0;
    if (!read_all(fd, in->bytes, in->size))
        return sr_fail(error, SR_ERROR_INPUT, "%s: cannot be read: %s", in->path,
                       errno ? strerror(errno) : "it has become shorter meanwhile");
    return SR_OK;
}

sr_status sr_store_open(const char *path, const char *kind, struct sr_store_in **result, struct sr_error *error)
{
    *result = NULL;
    struct sr_store_in *in = sr_alloc(sizeof *in);
    if (!in)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", path);
    in->path = path;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    sr_status status = fd < 0 ? sr_fail(error, SR_ERROR_INPUT, "%s: cannot be opened: %s", path, strerror(errno))
                              : load(in, fd, error);
    if (fd >= 0)
        close(fd);
    if (status == SR_OK)
        status = check_header(in, kind, error);
    if (status == SR_OK && !(in->places = sr_alloc((in->header.sections + 1) * sizeof *in->places)))
        status = sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to read it", path);
    if (status == SR_OK)
        status = find_sections(in, error);
    if (status == SR_OK)
        status = check_data(in, error);
    if (status != SR_OK) {
        sr_store_close(in);
        return status;
    }
    *result = in;
    return SR_OK;
}

const char *sr_store_kind(const struct sr_store_in *in)
{
    return in->header.kind;
}

bool sr_store_section(const struct sr_store_in *in, uint32_t number, const char **name, size_t *size)
{
    if (number >= in->header.sections)
        return false;
    *name = name_of(in, number);
    *size = (size_t)in->places[number].size;
    return true;
}

const void *sr_store_get(const struct sr_store_in *in, const char *name, size_t *size)
{
    for (uint32_t i = 0; i < in->header.sections; ++i)
        if (strcmp(name_of(in, i), name) == 0) {
            *size = (size_t)in->places[i].size;
            return in->bytes + in->places[i].begin;
        }
    *size = 0;
    return NULL;
}

void sr_store_close(struct sr_store_in *in)
{
    if (!in)
        return;
    sr_free(in->bytes);
    sr_free(in->places);
    sr_free(in);
}

bool sr_store_is_store(const char *path)
{
    char magic[sizeof STORE_MAGIC];
    struct stat st;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool is = fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && read_all(fd, magic, sizeof magic) &&
              memcmp(magic, STORE_MAGIC, sizeof magic) == 0;
    if (fd >= 0)
        close(fd);
    return is;
}
