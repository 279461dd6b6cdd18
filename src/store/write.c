/* SPDX-License-Identifier: MIT */
/* Writes a store: beside its name, to the disk, then under its name.
 *
 * rename is atomic and a folder's fsync makes it last (POSIX.1-2017; T. S. Pillai et al. 2014 show what file systems do
 * without). */
#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L
#include "store/layout.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

struct sr_store_out {
    struct sr_arena arena;
    char *path, *beside, *previous;
    int fd;
    struct store_header header;
};

uint32_t sr_store_crc_header(const void *header)
{
    return (uint32_t)crc32(0, header, STORE_ALIGN - sizeof(uint32_t));
}

uint32_t sr_store_crc_block(uint32_t section, uint64_t block, const void *data, size_t size)
{
    uint64_t place[2] = {section, block};
    return (uint32_t)crc32(crc32(0, (const Bytef *)place, sizeof place), data, (uInt)size);
}

char *sr_store_previous(struct sr_arena *arena, const char *path)
{
    return sr_arena_printf(arena, "%s~", path);
}

static sr_status fail_errno(const struct sr_store_out *out, const char *doing, struct sr_error *error)
{
    return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be %s: %s", out->path, doing, strerror(errno));
}

static bool write_all(int fd, const void *data, size_t size)
{
    const size_t most = 1u << 30; // Linux writes less than 2^31 at a time
    const char *bytes = data;
    while (size > 0) {
        ssize_t put = write(fd, bytes, size < most ? size : most);
        if (put < 0 && errno == EINTR)
            continue;
        if (put <= 0) {
            errno = put ? errno : ENOSPC;
            return false;
        }
        bytes += put;
        size -= (size_t)put;
    }
    return true;
}

/* The file of that name, for us alone: another writer may have renamed what we have opened. */
static bool lock(struct sr_store_out *out)
{
    struct stat ours, named;
    if (flock(out->fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK)
            return false;
        errno = 0; // a file system without locks
    }
    if (fstat(out->fd, &ours) != 0 || stat(out->beside, &named) != 0 || ours.st_ino != named.st_ino ||
        ours.st_dev != named.st_dev) {
        errno = EWOULDBLOCK;
        return false;
    }
    return ftruncate(out->fd, 0) == 0;
}

sr_status sr_store_create(const char *path, const char *kind, struct sr_store_out **result, struct sr_error *error)
{
    *result = NULL;
    struct sr_store_out *out = sr_alloc(sizeof *out);
    if (!out)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    out->fd = -1;
    out->path = sr_arena_string(&out->arena, path);
    out->beside = sr_arena_printf(&out->arena, "%s.new", path);
    out->previous = sr_store_previous(&out->arena, path);
    if (!out->path || !out->beside || !out->previous) {
        sr_store_abandon(out);
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    }
    memcpy(out->header.magic, STORE_MAGIC, sizeof out->header.magic);
    out->header.order = STORE_ORDER;
    out->header.format = STORE_FORMAT;
    snprintf(out->header.kind, sizeof out->header.kind, "%s", kind);
    struct stat st;
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) {
        sr_store_abandon(out);
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: it is no ordinary file", path);
    }
    out->fd = open(out->beside, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    sr_status status = SR_OK;
    if (out->fd < 0) {
        status = fail_errno(out, "written", error);
    } else if (!lock(out)) {
        status = errno == EWOULDBLOCK
                     ? sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: another process is writing it", path)
                     : fail_errno(out, "written", error);
        close(out->fd); // what is beside is not ours to remove
        out->fd = -1;
    }
    struct store_header none = {0}; // a file that is left here by a crash is no store
    if (status == SR_OK && !write_all(out->fd, &none, sizeof none))
        status = fail_errno(out, "written", error);
    out->header.size = sizeof none;
    if (status != SR_OK) {
        sr_store_abandon(out);
        return status;
    }
    *result = out;
    return SR_OK;
}

static bool put_padded(struct sr_store_out *out, const void *data, size_t size)
{
    static const char zeros[STORE_ALIGN];
    out->header.size += size + store_gap(size);
    return write_all(out->fd, data, size) && write_all(out->fd, zeros, store_gap(size));
}

struct summing {
    uint32_t section, *crc;
    const char *data;
    size_t size;
};

static void sum_block(void *context, uint64_t block)
{
    const struct summing *s = context;
    size_t at = (size_t)block * SR_STORE_BLOCK, n = s->size - at < SR_STORE_BLOCK ? s->size - at : SR_STORE_BLOCK;
    s->crc[block] = sr_store_crc_block(s->section, block, s->data + at, n);
}

sr_status sr_store_put(struct sr_store_out *out, const char *name, const void *data, size_t size,
                       struct sr_error *error)
{
    struct store_section section = {.size = size, .number = out->header.sections};
    if (strlen(name) >= sizeof section.name || out->header.sections >= SR_STORE_SECTIONS)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: has no room for a section \"%s\"", out->path, name);
    snprintf(section.name, sizeof section.name, "%s", name);
    section.crc = sr_store_crc_header(&section);
    size_t blocks = (size_t)store_blocks(size);
    uint32_t *crc = sr_alloc((blocks + 1) * sizeof *crc);
    if (!crc)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", out->path);
    sr_parallel_for(blocks < 64 ? 1 : sr_thread_count(), blocks, sum_block,
                    &(struct summing){section.number, crc, data, size});
    bool ok = put_padded(out, &section, sizeof section) && put_padded(out, data, size) &&
              put_padded(out, crc, blocks * sizeof *crc);
    sr_status status = ok ? SR_OK : fail_errno(out, "written", error);
    sr_free(crc);
    out->header.sections += 1;
    return status;
}

/* File systems that cannot do that for folders say EINVAL. */
bool sr_store_sync_folder(const char *path)
{
    char folder[4096];
    const char *slash = strrchr(path, '/');
    int n = slash ? (int)(slash - path) + 1 : 0;
    if (snprintf(folder, sizeof folder, "%.*s.", n, path) >= (int)sizeof folder)
        return true;
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return errno == EACCES; // may be written, not read
    bool ok = fsync(fd) == 0 || errno == EINVAL;
    int reason = errno;
    close(fd);
    errno = reason;
    return ok;
}

/* What is there becomes the previous generation, and keeps its own name meanwhile where the file system has links. */
static bool keep_previous(const struct sr_store_out *out)
{
    if (access(out->path, F_OK) != 0)
        return true;
    if ((unlink(out->previous) == 0 || errno == ENOENT) && link(out->path, out->previous) == 0)
        return true;
    return rename(out->path, out->previous) == 0;
}

sr_status sr_store_finish(struct sr_store_out *out, bool keeps_previous, struct sr_error *error)
{
    out->header.crc = sr_store_crc_header(&out->header);
    sr_status status = SR_OK;
    if (lseek(out->fd, 0, SEEK_SET) != 0 || !write_all(out->fd, &out->header, sizeof out->header) ||
        fsync(out->fd) != 0)
        status = fail_errno(out, "written", error);
    int fd = out->fd;
    if (status == SR_OK && keeps_previous && !keep_previous(out))
        status = fail_errno(out, "kept as the previous generation", error);
    if (status == SR_OK && rename(out->beside, out->path) != 0)
        status = fail_errno(out, "written", error);
    else if (status == SR_OK)
        out->fd = -1; // nothing beside any more
    if (out->fd < 0) {
        if (close(fd) != 0)
            status = fail_errno(out, "written", error);
        if (!sr_store_sync_folder(out->path))
            status = fail_errno(out, "brought to the disk", error);
    }
    sr_store_abandon(out);
    return status;
}

void sr_store_abandon(struct sr_store_out *out)
{
    if (!out)
        return;
    if (out->fd >= 0) {
        unlink(out->beside); // before others may lock it
        close(out->fd);
    }
    sr_arena_free(&out->arena);
    sr_free(out);
}
