/* SPDX-License-Identifier: MIT */
/* A film as sections of a store: its arrays as they lie in memory. */
#include "render/render.h"

#include <stdio.h>
#include <string.h>

/* The splats' counters: groups, paths of each group, dropped, and the unit's bits. */
enum { DROPPED = SR_SPLAT_GROUPS + 1, UNIT, PATHS_COUNT };

struct part {
    const char *name;
    void *data;
    size_t size; // [B]
};
enum { FILM_PARTS = 5 };

/* Its arrays; those that it has not got are NULL. */
static void parts_of(const struct sr_film *film, uint64_t paths[PATHS_COUNT], struct part parts[FILM_PARTS])
{
    size_t n = (size_t)film->width * film->height;
    const struct sr_film_splats *s = film->splats;
    parts[0] = (struct part){"pixels", film->pixels, n * sizeof *film->pixels};
    parts[1] = (struct part){"aov", film->aov, n * sizeof *film->aov};
    parts[2] = (struct part){"buckets", film->buckets, n * film->settings.buckets * sizeof *film->buckets};
    parts[3] = (struct part){"splats", s ? s->words : NULL, s ? n * sr_film_splats_B(s->groups) : 0};
    parts[4] = (struct part){"paths", s ? paths : NULL, PATHS_COUNT * sizeof *paths};
}

sr_status sr_film_put(struct sr_store_out *out, const char *name, const struct sr_film *film, struct sr_error *error)
{
    uint64_t paths[PATHS_COUNT] = {0};
    struct part parts[FILM_PARTS];
    if (film->splats) {
        paths[0] = film->splats->groups;
        memcpy(&paths[1], film->splats->paths, sizeof film->splats->paths);
        paths[DROPPED] = film->splats->dropped;
        memcpy(&paths[UNIT], &film->splats->unit, sizeof film->splats->unit);
    }
    parts_of(film, paths, parts);
    sr_status status = SR_OK;
    for (int i = 0; i < FILM_PARTS && status == SR_OK; ++i) {
        char section[SR_STORE_NAME];
        snprintf(section, sizeof section, "%s.%s", name, parts[i].name);
        if (parts[i].data)
            status = sr_store_put(out, section, parts[i].data, parts[i].size, error);
    }
    return status;
}

sr_status sr_film_get(const struct sr_store_in *in, const char *path, const char *name, struct sr_film *film,
                      struct sr_error *error)
{
    uint64_t paths[PATHS_COUNT];
    struct part parts[FILM_PARTS];
    parts_of(film, paths, parts);
    for (int i = 0; i < FILM_PARTS; ++i) {
        char section[SR_STORE_NAME];
        size_t size;
        snprintf(section, sizeof section, "%s.%s", name, parts[i].name);
        const void *data = sr_store_get(in, section, &size);
        if (!data != !parts[i].data || (data && size != parts[i].size))
            return sr_fail(error, SR_ERROR_INPUT, "%s: its section \"%s\" has %zu bytes, and this picture's has %zu",
                           path, section, size, parts[i].data ? parts[i].size : 0);
        if (data)
            memcpy(parts[i].data, data, size);
    }
    if (!film->splats)
        return SR_OK;
    if (paths[0] != film->splats->groups)
        return sr_fail(error, SR_ERROR_INPUT, "%s: has %llu groups of paths from the lights, and this picture %u", path,
                       (unsigned long long)paths[0], film->splats->groups);
    if (memcmp(&paths[UNIT], &film->splats->unit, sizeof film->splats->unit) != 0)
        return sr_fail(error, SR_ERROR_INPUT,
                       "%s: light from paths of the lights is in another unit than this picture's", path);
    memcpy(film->splats->paths, &paths[1], sizeof film->splats->paths);
    film->splats->dropped = paths[DROPPED];
    return SR_OK;
}

struct sr_film *sr_film_twin(const struct sr_film *film, struct sr_error *error)
{
    struct sr_film *twin;
    if (sr_film_create(&film->settings, film->has_aov, &twin, error) == SR_OK && film->splats &&
        sr_film_add_splats(twin, film->splats->groups, film->splats->unit, error) != SR_OK) {
        sr_film_destroy(twin);
        twin = NULL;
    }
    return twin;
}

void sr_film_copy(struct sr_film *to, const struct sr_film *from)
{
    uint64_t ignored[PATHS_COUNT];
    struct part a[FILM_PARTS], b[FILM_PARTS];
    parts_of(to, ignored, a);
    parts_of(from, ignored, b);
    for (int i = 0; i < FILM_PARTS - 1; ++i)
        if (b[i].data)
            memcpy(a[i].data, b[i].data, b[i].size);
    if (!from->splats)
        return;
    memcpy(to->splats->paths, from->splats->paths, sizeof to->splats->paths);
    to->splats->dropped = from->splats->dropped;
}
