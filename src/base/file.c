/* SPDX-License-Identifier: MIT */
/* Files: read whole, written beside and renamed. */
#define _POSIX_C_SOURCE 200809L
#include "base/base.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

// a larger piece with what the old one holds; NULL: nothing is left of either
static char *grow(char *old, size_t used, size_t size)
{
    char *grown = sr_realloc(old, used, size);
    if (!grown)
        sr_free(old);
    return grown;
}

/* Whether someone may still come and write to a pipe that has given nothing; naps a little if so. */
static bool may_be_written(int fd, int *naps)
{
    struct pollfd at = {.fd = fd, .events = POLLIN};
    if (poll(&at, 1, 0) > 0 && at.revents & POLLHUP) // it was written to, and is over
        return false;
    nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    ++*naps;
    return true;
}

/* All bytes of a descriptor, of known size or not. */
static sr_status read_all(int fd, const char *path, size_t expected, bool is_pipe, size_t max_size, char **data,
                          size_t *size, struct sr_error *error)
{
    enum { MOST_NAPS = 500 }; // 10 s
    int naps = 0;
    size_t capacity = expected ? expected : 1 << 16, n = 0;
    char *bytes = sr_alloc(capacity + 1);
    while (bytes) {
        ssize_t got = read(fd, bytes + n, capacity - n);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0 && errno == EAGAIN && fcntl(fd, F_SETFL, O_RDONLY) == 0) // somebody writes: it takes what it takes
            continue;
        if (got == 0 && n == 0 && is_pipe && naps < MOST_NAPS && may_be_written(fd, &naps))
            continue;
        if (got == 0 && n == 0 && naps == MOST_NAPS) {
            sr_free(bytes);
            return sr_fail(error, SR_ERROR_INPUT, "%s: is a pipe that nobody writes to", path);
        }
        if (got < 0) {
            sr_free(bytes);
            return sr_fail(error, SR_ERROR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
        }
        n += (size_t)got;
        if (got == 0)
            break;
        if (n > max_size) {
            sr_free(bytes);
            return sr_fail(error, SR_ERROR_INPUT, "%s: is larger than %zu bytes, the limit for this kind of file", path,
                           max_size);
        }
        if (n == capacity) {
            char extra; // most files are as long as they say: look before growing
            ssize_t more;
            do
                more = read(fd, &extra, 1);
            while (more < 0 && errno == EINTR);
            if (more <= 0)
                break;
            bytes = grow(bytes, n, 2 * capacity + 1);
            capacity *= 2;
            if (bytes)
                bytes[n++] = extra;
        }
    }
    if (!bytes)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory for its %zu bytes", path, n);
    bytes[n] = 0;
    *data = bytes;
    *size = n;
    return SR_OK;
}

static sr_status gunzip(const char *path, size_t max_size, char **data, size_t *size, struct sr_error *error)
{
    z_stream z = {0};
    if (inflateInit2(&z, 15 + 16) != Z_OK)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot start unpacking", path);
    size_t in_left = *size, capacity = *size * 4 + 4096, n = 0;
    const char *in = *data;
    char *out = sr_alloc(capacity + 1);
    int status = Z_OK;
    while (out && status != Z_STREAM_END) {
        if (z.avail_in == 0) {
            z.next_in = (Bytef *)(uintptr_t)in;
            z.avail_in = (uInt)(in_left < 1u << 30 ? in_left : 1u << 30);
            in += z.avail_in;
            in_left -= z.avail_in;
        }
        size_t room = capacity - n;
        z.next_out = (Bytef *)out + n;
        z.avail_out = (uInt)(room < 1u << 30 ? room : 1u << 30);
        uInt before = z.avail_out;
        status = inflate(&z, Z_NO_FLUSH);
        n += before - z.avail_out;
        if (status == Z_STREAM_END && (z.avail_in || in_left)) // another member follows
            status = inflateReset(&z);
        if (n > max_size || (status != Z_OK && status != Z_STREAM_END))
            break;
        if (n == capacity) {
            out = grow(out, n, 2 * capacity + 1);
            capacity *= 2;
        }
    }
    inflateEnd(&z);
    if (!out)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to unpack it", path);
    if (n > max_size || status != Z_STREAM_END) {
        sr_free(out);
        return n > max_size
                   ? sr_fail(error, SR_ERROR_INPUT,
                             "%s: unpacks to more than %zu bytes, the limit for this kind of file", path, max_size)
                   : sr_fail(error, SR_ERROR_INPUT, "%s: is damaged or cut short: it does not unpack as gzip", path);
    }
    out[n] = 0;
    sr_free(*data);
    *data = out;
    *size = n;
    return SR_OK;
}

/* What has no size may have no end either: no more than a quarter of the machine's memory. */
static size_t most_without_size(size_t max_size)
{
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    size_t quarter = pages > 0 && page > 0 ? (size_t)pages / 4 * (size_t)page : (size_t)1 << 30;
    return max_size < quarter ? max_size : quarter;
}

sr_status sr_file_read(const char *path, size_t max_size, char **data, size_t *size, struct sr_error *error)
{
    *data = NULL;
    *size = 0;
    bool is_stdin = strcmp(path, "-") == 0;
    int fd = is_stdin ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return sr_fail(error, SR_ERROR_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    struct stat st;
    sr_status status = SR_OK;
    if (fstat(fd, &st) != 0)
        status = sr_fail(error, SR_ERROR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
    else if (S_ISDIR(st.st_mode))
        status = sr_fail(error, SR_ERROR_INPUT, "%s: is a folder, a file was expected", path);
    else if (S_ISBLK(st.st_mode) || (S_ISCHR(st.st_mode) && !is_stdin && !isatty(fd)))
        status = sr_fail(error, SR_ERROR_INPUT, "%s: is a device, a file was expected", path);
    else if (S_ISREG(st.st_mode) && (uint64_t)st.st_size > max_size)
        status = sr_fail(error, SR_ERROR_INPUT, "%s: is larger than %zu bytes, the limit for this kind of file", path,
                         max_size);
    else
        status = S_ISREG(st.st_mode) ? read_all(fd, path, (size_t)st.st_size, false, max_size, data, size, error)
                                     : read_all(fd, path, 0, S_ISFIFO(st.st_mode) && !is_stdin,
                                                most_without_size(max_size), data, size, error);
    if (!is_stdin)
        close(fd);
    if (status == SR_OK && *size > 2 && (*data)[0] == '\x1f' && (*data)[1] == '\x8b') {
        status = gunzip(path, max_size, data, size, error);
        if (status != SR_OK) {
            sr_free(*data);
            *data = NULL;
        }
    }
    return status;
}

sr_status sr_file_write(const char *path, const void *data, size_t size, struct sr_error *error)
{
    struct sr_arena scratch = {0};
    char *beside = sr_arena_printf(&scratch, "%s.part-%ld", path, (long)getpid());
    if (!beside)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
    struct stat st;
    if (stat(path, &st) == 0 && S_ISDIR(st.st_mode)) {
        sr_arena_free(&scratch);
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: it is a folder", path);
    }
    // pipes and devices cannot be renamed onto
    bool is_special = stat(path, &st) == 0 && !S_ISREG(st.st_mode);
    int fd = open(is_special ? path : beside,
                  is_special ? O_WRONLY | O_CLOEXEC : O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    bool ok = fd >= 0;
    for (size_t n = 0; ok && n < size;) {
        ssize_t put = write(fd, (const char *)data + n, size - n);
        if (put < 0 && errno == EINTR)
            continue;
        ok = put > 0;
        n += ok ? (size_t)put : 0;
    }
    ok = ok && (is_special || fsync(fd) == 0);
    int reason = errno;
    if (fd >= 0 && close(fd) != 0 && ok) {
        reason = errno;
        ok = false;
    }
    if (ok && !is_special && rename(beside, path) != 0) {
        reason = errno;
        ok = false;
    }
    if (!ok && fd >= 0 && !is_special)
        unlink(beside);
    sr_arena_free(&scratch);
    return ok ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: %s", path, strerror(reason));
}

bool sr_file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

char *sr_path_beside(struct sr_arena *arena, const char *from, const char *name)
{
    const char *slash = strrchr(from, '/');
    if (name[0] == '/' || !slash)
        return sr_arena_string(arena, name);
    return sr_arena_printf(arena, "%.*s/%s", (int)(slash - from), from, name);
}

bool sr_path_has_ending(const char *path, const char *ending)
{
    size_t n = strlen(path), m = strlen(ending);
    return n >= m && strcasecmp(path + n - m, ending) == 0;
}
