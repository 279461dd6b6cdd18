/* SPDX-License-Identifier: MIT */
/* What subcommands write: image files that must be writable before work begins, chosen channels, JSON with units. */
#define _POSIX_C_SOURCE 200809L
#include "command.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- files ---- */

bool command_is_image_ending(const char *path)
{
    static const char *const endings[] = {".exr", ".png", ".pfm", ".hdr"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; ++i)
        if (sr_path_has_ending(path, endings[i]))
            return true;
    return false;
}

sr_status command_check_output(const char *path, struct sr_error *error)
{
    struct stat st;
    bool exists = stat(path, &st) == 0;
    if (exists && S_ISDIR(st.st_mode))
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: it is a folder", path);
    if (exists && !S_ISREG(st.st_mode)) // a pipe or a device
        return access(path, W_OK) == 0
                   ? SR_OK
                   : sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: %s", path, strerror(errno));
    char beside[4096];
    if (snprintf(beside, sizeof beside, "%s.part-%ld", path, (long)getpid()) >= (int)sizeof beside)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: %s", path, strerror(ENAMETOOLONG));
    int fd = open(beside, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: cannot be written: %s", path, strerror(errno));
    close(fd);
    unlink(beside);
    return SR_OK;
}

sr_status command_page_open(const char *path, struct command_page *page, struct sr_error *error)
{
    *page = (struct command_page){.path = path};
    if (!path)
        return SR_OK;
    if (command_check_output(path, error) != SR_OK)
        return error->status;
    page->out = open_memstream(&page->text, &page->size);
    return page->out ? SR_OK : sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", path);
}

void command_page_close(struct command_page *page, struct sr_error *error)
{
    if (!page->out)
        return;
    bool is_whole = !ferror(page->out);
    if ((fclose(page->out) != 0 || !is_whole) && !error->status)
        sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory to write it", page->path);
    if (!error->status)
        sr_file_write(page->path, page->text, page->size, error);
    free(page->text);
    *page = (struct command_page){0};
}

/* ---- channels ---- */

/* Whether name is the word itself, or of its group: albedo.R of albedo. */
static bool is_in_group(const char *name, const char *group)
{
    size_t n = strlen(group);
    return strncmp(name, group, n) == 0 && (name[n] == 0 || name[n] == '.');
}

/* Files keep channels by the alphabet; colours are wanted as red, green, blue. */
static int rank(const char *name)
{
    static const char order[] = "RGBA";
    const char *dot = strrchr(name, '.'), *last = dot ? dot + 1 : name;
    const char *at = last[0] && !last[1] ? strchr(order, last[0]) : NULL;
    return at ? (int)(at - order) : (int)sizeof order;
}

static sr_status unknown_channel(const struct sr_image *image, const char *label, const char *name,
                                 struct sr_error *error)
{
    char list[512] = "";
    size_t n = 0;
    for (uint32_t c = 0; c < image->channel_count && n < sizeof list - 80; ++c)
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%s", c ? ", " : "", image->channels[c].name);
    return sr_fail(error, SR_ERROR_INPUT, "%s: has no channel \"%s\"; it has %s", label, name, list);
}

sr_status command_select_channels(const struct sr_image *image, const char *label, const char *list, uint32_t *indices,
                                  uint32_t *count, struct sr_error *error)
{
    *count = 0;
    for (const char *p = list;; ++p) {
        size_t length = strcspn(p, ",");
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)length, p);
        bool is_known = false;
        for (int r = 0; r <= (int)sizeof "RGBA"; ++r)
            for (uint32_t c = 0; c < image->channel_count; ++c) {
                const char *candidate = image->channels[c].name;
                if (rank(candidate) != r || !is_in_group(candidate, name))
                    continue;
                bool is_taken = false;
                for (uint32_t i = 0; i < *count; ++i)
                    is_taken |= indices[i] == c;
                is_known = true;
                if (!is_taken)
                    indices[(*count)++] = c;
            }
        if (!is_known)
            return unknown_channel(image, label, name, error);
        p += length;
        if (!*p)
            return SR_OK;
    }
}

/* ---- JSON ---- */

json_t *command_json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *command_json_text(const char *text)
{
    if (!text)
        return json_null();
    json_t *j = json_string(text);
    if (j)
        return j;
    char plain[1024];
    size_t n = 0;
    for (; text[n] && n + 1 < sizeof plain; ++n)
        plain[n] = (signed char)text[n] > 0 ? text[n] : '?';
    plain[n] = 0;
    return json_string(plain);
}

json_t *command_json_quantity(double value, const char *unit)
{
    return json_pack("{s:o, s:o}", "value", command_json_number(value), "unit", command_json_text(unit));
}

json_t *command_json_measured(const struct sr_quantity *q)
{
    char unit[96];
    double U = sr_quantity_expanded(q, 0.95), k = U / q->u;
    json_t *j = json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:f}", "unit",
                          command_json_text(sr_unit_text(q->unit, unit, sizeof unit)), "value",
                          command_json_number(q->value), "standard_uncertainty", command_json_number(q->u),
                          "degrees_of_freedom", command_json_number(q->degrees), "coverage_factor",
                          command_json_number(k), "expanded_uncertainty", command_json_number(U), "level", 0.95);
    if (j && q->upper > 0)
        json_object_set_new(j, "upper_bound", json_real(q->upper));
    return j;
}

int command_print_json(const char *name, json_t *json)
{
    struct sr_error error = {0};
    if (!json)
        sr_fail(&error, SR_ERROR_RESOURCE, "not enough memory for the JSON");
    else if (json_dumpf(json, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) != 0 || putchar('\n') == EOF ||
             fflush(stdout) != 0)
        sr_fail(&error, SR_ERROR_RESOURCE, "standard output cannot be written: %s", strerror(errno));
    json_decref(json);
    return error.status ? command_fail(name, &error) : 0;
}
