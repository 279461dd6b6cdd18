/* SPDX-License-Identifier: MIT */
/* steradian info of a checkpoint or a part of a picture: of which render, how far, and whether it is whole. */
#define _POSIX_C_SOURCE 200809L
#include "info.h"

#include "render/render.h"
#include "store/store.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

/* Lines "key value" as an object. */
static json_t *settings_json(const char *identity)
{
    json_t *settings = json_object();
    for (const char *p = identity; p && *p; p += strcspn(p, "\n"), p += *p == '\n') {
        char line[1200];
        snprintf(line, sizeof line, "%.*s", (int)strcspn(p, "\n"), p);
        char *value = strchr(line, ' ');
        if (value)
            *value++ = 0;
        json_object_set_new(settings, line, command_json_text(value ? value : ""));
    }
    return settings;
}

static void print(const char *path, const struct sr_store_in *in, const struct sr_render_part *part,
                  const char *identity, const struct sr_render_progress_kept *p, const char *date)
{
    const char *name;
    size_t size;
    printf("%s: a %s, whole\n", path, sr_store_kind(in));
    if (p)
        printf(
            "  %.2f %% of the work in %.1f s; written %s\n  %llu paths, %llu rays, %llu shadow rays, %llu samples were not finite\n",
            100 * p->share, p->render_s, date, (unsigned long long)p->paths, (unsigned long long)p->rays,
            (unsigned long long)p->shadow_rays, (unsigned long long)p->dropped);
    struct sr_render_range r;
    for (size_t i = 0; part && sr_render_part_range(part, i, &r); ++i)
        printf("%s %u-%u", i ? "," : "  samples", r.begin, r.end);
    if (part)
        printf(" of 0-%u of each pixel\n", sr_render_part_spp(part));
    printf("\n  %-24s %12s\n", "section", "bytes");
    for (uint32_t i = 0; sr_store_section(in, i, &name, &size); ++i)
        printf("  %-24s %12zu\n", name, size);
    if (identity)
        printf("\n  what makes its bytes\n");
    for (const char *q = identity; q && *q; q += strcspn(q, "\n"), q += *q == '\n')
        printf("  %-24.*s %.*s\n", (int)strcspn(q, " \n"), q, (int)strcspn(q + strcspn(q, " \n"), "\n"),
               q + strcspn(q, " \n"));
}

static int print_json(const char *path, const struct sr_store_in *in, const struct sr_render_part *part,
                      const char *identity, const struct sr_render_progress_kept *p, const char *date)
{
    json_t *j = json_pack("{s:o, s:s}", "file", command_json_text(path), "kind", sr_store_kind(in));
    if (j && p)
        json_object_set_new(j, "progress",
                            json_pack("{s:f, s:f, s:s, s:I, s:I, s:I, s:I}", "share", p->share, "render_s", p->render_s,
                                      "written", date, "paths", (json_int_t)p->paths, "rays", (json_int_t)p->rays,
                                      "shadow_rays", (json_int_t)p->shadow_rays, "dropped_samples",
                                      (json_int_t)p->dropped));
    json_t *samples = part ? json_array() : NULL;
    struct sr_render_range r;
    for (size_t i = 0; part && sr_render_part_range(part, i, &r); ++i)
        json_array_append_new(samples, json_pack("[I, I]", (json_int_t)r.begin, (json_int_t)r.end));
    if (j && part) {
        json_object_set_new(j, "samples", samples);
        json_object_set_new(j, "spp", json_integer(sr_render_part_spp(part)));
    }
    if (j && identity)
        json_object_set_new(j, "settings", settings_json(identity));
    return command_print_json("info", j);
}

int info_store(const struct info_arguments *a)
{
    struct sr_error error = {0};
    struct sr_store_in *in;
    if (sr_store_open(a->path, NULL, &in, &error) != SR_OK)
        return command_fail("info", &error);
    struct sr_render_part *part = NULL;
    if (strcmp(sr_store_kind(in), "part") == 0 && sr_render_part_read(a->path, &part, &error) != SR_OK) {
        sr_store_close(in);
        return command_fail("info", &error);
    }
    struct sr_render_progress_kept p;
    bool has_progress = sr_render_checkpoint_tells(in, &p);
    size_t size;
    const char *identity = sr_store_get(in, "identity", &size);
    if (!identity || size == 0 || identity[size - 1] != 0)
        identity = NULL;
    char date[32] = "";
    if (has_progress) {
        time_t time_s = (time_t)p.time_s;
        struct tm utc;
        if (gmtime_r(&time_s, &utc))
            strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    }
    int code = 0;
    if (a->json)
        code = print_json(a->path, in, part, identity, has_progress ? &p : NULL, date);
    else
        print(a->path, in, part, identity, has_progress ? &p : NULL, date);
    sr_store_close(in);
    sr_render_part_destroy(part);
    return code;
}
