/* SPDX-License-Identifier: MIT */
#include "agree/render_helper.h"

bool import_scene(const char *path, const struct sr_import_options *options, struct sr_import_result *scene,
                  struct sr_error *error)
{
    struct sr_import_options none = {0};
    struct sr_log silent = {0};
    return sr_import_pbrt(path, options ? options : &none, scene, &silent, error) == SR_OK;
}

struct sr_film *render_or_fail(const struct sr_render_job *job, struct sr_render_report *report)
{
    struct sr_error error = {0};
    struct sr_film *film;
    if (sr_render(job, &film, report, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return film;
}

const char *scene_file(const char *name, const char *text)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    struct sr_error error = {0};
    if (sr_file_write(path, text, strlen(text), &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    return path;
}
