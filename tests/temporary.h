/* SPDX-License-Identifier: MIT */
/* Folders for a test's files, where TMPDIR says or where the system has them. */
#ifndef SR_TESTS_TEMPORARY_H
#define SR_TESTS_TEMPORARY_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

/* Makes one of a new name; false: it cannot be made. */
static inline bool make_temporary_folder(const char *name, char path[512])
{
    const char *parent = getenv("TMPDIR");
    int n = snprintf(path, 512, "%s/steradian-%s-XXXXXX", parent && parent[0] ? parent : P_tmpdir, name);
    return n < 512 && mkdtemp(path);
}

#endif
