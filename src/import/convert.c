/* SPDX-License-Identifier: MIT */
/* A scene as pbrt-v4 text, and the names of files as seen from where it will lie. */
#include "import/describe.h"
#include "import/pbrt/format.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* of a file that may not be there yet; ends without a slash, but for the root */
static bool absolute_folder(const char *path, char folder[PATH_MAX])
{
    char text[PATH_MAX];
    const char *slash = strrchr(path, '/');
    if (slash && (size_t)(slash - path) + 2 > sizeof text)
        return false;
    snprintf(text, sizeof text, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
    return realpath(text, folder) != NULL;
}

bool sr_path_same_folder(const char *a, const char *b)
{
    char folder_a[PATH_MAX], folder_b[PATH_MAX];
    return absolute_folder(a, folder_a) && absolute_folder(b, folder_b) && strcmp(folder_a, folder_b) == 0;
}

const char *sr_path_seen_from(struct sr_arena *arena, const char *from, const char *file)
{
    char there[PATH_MAX], here[PATH_MAX], up[PATH_MAX] = "";
    if (!absolute_folder(file, there) || !absolute_folder(from, here))
        return NULL;
    size_t common = 0, i = 0;
    for (;; ++i) { // whole names of folders that both begin with
        bool ends_there = there[i] == 0 || there[i] == '/', ends_here = here[i] == 0 || here[i] == '/';
        if (ends_there && ends_here)
            common = i;
        if (there[i] != here[i] || there[i] == 0)
            break;
    }
    for (const char *c = here + common; *c; ++c)
        if (*c == '/' && c[1] && strlen(up) + 4 < sizeof up)
            strcat(up, "../");
    const char *rest = there + common, *slash = strrchr(file, '/');
    rest += *rest == '/';
    return sr_arena_printf(arena, "%s%s%s%s", up, rest, *rest ? "/" : "", slash ? slash + 1 : file);
}

const char *sr_convert_beside(struct sr_arena *arena, const char *out, const char *name, const char *ending)
{
    const char *slash = strrchr(out, '/'), *dot = strrchr(out, '.');
    int length = dot && (!slash || dot > slash + 1) && dot > out ? (int)(dot - out) : (int)strlen(out);
    char *path = sr_arena_printf(arena, "%.*s-%.200s%s", length, out, name, ending);
    for (char *c = path ? path + length + 1 : NULL; c && *c; ++c) // names within files are anybody's
        if (strchr("/\\:*?\"<>|#", *c) || (unsigned char)*c < 32)
            *c = '_';
    return path;
}

const char *sr_convert_mesh_name(struct sr_arena *arena, const char *out, uint32_t number)
{
    char name[16];
    snprintf(name, sizeof name, "%04u", (unsigned)number);
    return sr_convert_beside(arena, out, name, ".ply");
}

/* What does not read back is not worth writing. */
static sr_status read_back(const char *from, const char *path, const struct sr_print *out, struct sr_error *error)
{
    struct sr_arena data = {0};
    struct sr_error refused = {0};
    struct sr_pbrt_description d = {0};
    sr_status status = sr_pbrt_read_text(path, out->text ? out->text : "", out->size, &data, NULL, &d, &refused);
    if (status != SR_OK)
        sr_fail(error, status, "%s: makes a text that would be refused: %s", from, refused.text);
    sr_pbrt_description_free(&d);
    sr_arena_free(&data);
    return status;
}

sr_status sr_convert(const char *path, const struct sr_convert_options *o, char **text, size_t *size,
                     struct sr_log *log, struct sr_error *error)
{
    struct sr_print out = {0};
    sr_status status = sr_import_format_of(path) ? sr_pbrt_write(path, o, &out, log, error)
                                                 : sr_pbrt_format(path, o, &out, log, error);
    if (status == SR_OK && out.has_failed)
        status = sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", path);
    if (status == SR_OK)
        status = read_back(path, o->out, &out, error);
    if (status != SR_OK) {
        sr_free(out.text);
        out = (struct sr_print){0};
    }
    *text = out.text;
    *size = out.size;
    return status;
}
