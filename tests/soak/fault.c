/* SPDX-License-Identifier: MIT */
/* A disk that fails at will: LD_PRELOADed, it counts the calls that write files whose names contain FAULT_FILE, and
 * from the FAULT_AT-th on makes FAULT_COUNT of them (default 1) fail with the number FAULT_ERRNO; or it kills the
 * process there where that is 0. FAULT_THEN kills it so many calls after the first failure. FAULT_LOG gets a line for
 * each call that was hit. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

enum { MOST_FDS = 4096 };
static unsigned char is_watched[MOST_FDS];
static int calls;

static long number(const char *name, long otherwise)
{
    const char *text = getenv(name);
    return text ? strtol(text, NULL, 10) : otherwise;
}

static int is_ours(const char *path)
{
    const char *part = getenv("FAULT_FILE");
    return part && path && strstr(path, part) != NULL;
}

static void say(const char *what)
{
    const char *log = getenv("FAULT_LOG");
    FILE *f = log ? fopen(log, "a") : NULL;
    if (!f)
        return;
    fprintf(f, "%s\n", what);
    fclose(f);
}

/* Whether this call is to fail; errno is set then. */
static int fails(const char *what)
{
    long at = number("FAULT_AT", 0), count = number("FAULT_COUNT", 1), then = number("FAULT_THEN", 0),
         reason = number("FAULT_ERRNO", 0);
    int now = __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED);
    if (at == 0 || now < at)
        return 0;
    if ((now == at && reason == 0) || (then && now >= at + then)) {
        say(what);
        kill(getpid(), SIGKILL);
    }
    if (now >= at + count || reason == 0)
        return 0;
    if (now == at)
        say(what);
    errno = (int)reason;
    return 1;
}

#define REAL(type, name, ...)                                                                                          \
    static type (*real)(__VA_ARGS__);                                                                                  \
    if (!real)                                                                                                         \
    real = (type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, #name)

static int watch(int fd, const char *path)
{
    if (fd >= 0 && fd < MOST_FDS)
        is_watched[fd] = (unsigned char)is_ours(path);
    return fd;
}

static int is_fd_ours(int fd)
{
    return fd >= 0 && fd < MOST_FDS && is_watched[fd];
}

static mode_t mode_of(int flags, va_list arguments)
{
    return flags & O_CREAT ? (mode_t)va_arg(arguments, unsigned) : 0;
}

/* Folders are ours too: they are opened to be brought to the disk. */
static int wants(const char *path, int flags)
{
    return (is_ours(path) && (flags & O_ACCMODE) != O_RDONLY) || (flags & O_DIRECTORY);
}

#define OPEN(name)                                                                                                     \
    int name(const char *path, int flags, ...)                                                                         \
    {                                                                                                                  \
        REAL(int, name, const char *, int, ...);                                                                       \
        va_list arguments;                                                                                             \
        va_start(arguments, flags);                                                                                    \
        mode_t mode = mode_of(flags, arguments);                                                                       \
        va_end(arguments);                                                                                             \
        if (!wants(path, flags))                                                                                       \
            return real(path, flags, mode);                                                                            \
        if (fails("open"))                                                                                             \
            return -1;                                                                                                 \
        int fd = real(path, flags, mode);                                                                              \
        if (flags & O_DIRECTORY && fd >= 0 && fd < MOST_FDS)                                                           \
            is_watched[fd] = 1;                                                                                        \
        else                                                                                                           \
            watch(fd, path);                                                                                           \
        return fd;                                                                                                     \
    }
OPEN(open)
OPEN(open64)

ssize_t write(int fd, const void *data, size_t size)
{
    REAL(ssize_t, write, int, const void *, size_t);
    if (is_fd_ours(fd) && fails("write")) {
        if (size > 1)
            real(fd, data, size / 2); // a part of it has got there
        return -1;
    }
    return real(fd, data, size);
}

int fsync(int fd)
{
    REAL(int, fsync, int);
    return is_fd_ours(fd) && fails("fsync") ? -1 : real(fd);
}

int close(int fd)
{
    REAL(int, close, int);
    int has_failed = is_fd_ours(fd) && fails("close"), reason = errno;
    if (fd >= 0 && fd < MOST_FDS)
        is_watched[fd] = 0;
    int result = real(fd); // the descriptor is gone in any case
    if (has_failed)
        errno = reason;
    return has_failed ? -1 : result;
}

#define TRUNCATE(name, type)                                                                                           \
    int name(int fd, type size)                                                                                        \
    {                                                                                                                  \
        REAL(int, name, int, type);                                                                                    \
        return is_fd_ours(fd) && fails("ftruncate") ? -1 : real(fd, size);                                             \
    }
TRUNCATE(ftruncate, off_t)
TRUNCATE(ftruncate64, off64_t)

int rename(const char *from, const char *to)
{
    REAL(int, rename, const char *, const char *);
    return is_ours(to) && fails("rename") ? -1 : real(from, to);
}

int link(const char *from, const char *to)
{
    REAL(int, link, const char *, const char *);
    return is_ours(to) && fails("link") ? -1 : real(from, to);
}

int unlink(const char *path)
{
    REAL(int, unlink, const char *);
    return is_ours(path) && fails("unlink") ? -1 : real(path);
}
