/* SPDX-License-Identifier: MIT */
/* steradian render: where its checkpoint is, and what is told of it. */
#define _POSIX_C_SOURCE 200809L
#include "render_command.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* Beside the first output, if that is a file: not beside a pipe or a device. */
static const char *default_path(struct render_keeping *k, const char *output)
{
    struct stat st;
    if (stat(output, &st) == 0 && !S_ISREG(st.st_mode))
        return NULL;
    return sr_arena_printf(&k->arena, "%s.srk", output);
}

int render_keep_begin(const struct render_arguments *a, const struct sr_import_result *scene, const char *identity,
                      struct sr_render_job *job, struct render_keeping *k)
{
    *k = (struct render_keeping){.log = command_log((bool *)(uintptr_t)&a->quiet),
                                 .is_asked_for = a->checkpoint || a->resume};
    if (a->no_checkpoint)
        return 0;
    struct sr_error error = {0};
    const char *path = a->checkpoint ? a->checkpoint : default_path(k, render_output_name(a, scene, 0));
    if (!path && a->resume)
        return command_usage(&command_render,
                             "--resume: the output is no file to keep a checkpoint beside: use --checkpoint FILE");
    if (!path)
        return 0;
    if (a->checkpoint && command_check_output(path, &error) != SR_OK)
        return command_fail("render", &error);
    for (int i = 0; i < render_output_count(a); ++i)
        if (strcmp(path, render_output_name(a, scene, i)) == 0)
            return command_usage(&command_render, "--checkpoint %s: that is where the picture goes", path);
    struct stat st;
    bool is_something = stat(path, &st) == 0 && !(S_ISREG(st.st_mode) && st.st_size == 0);
    if (a->checkpoint && !a->resume && is_something && !sr_store_is_store(path)) {
        sr_fail(&error, SR_ERROR_INPUT, "%s: is no checkpoint: it would be lost", path);
        return command_fail("render", &error);
    }
    if (!a->resume && sr_file_exists(path) && !a->quiet)
        fprintf(
            stderr,
            "note: %s is there of a render that has not ended; this one begins anew and will replace it (--resume goes on from it)\n",
            path);
    k->keep = (struct sr_render_keep){.path = path,
                                      .identity = identity,
                                      .interval_s = a->checkpoint_s,
                                      .resumes = a->resume,
                                      .has_no_copy = !render_has_room(job, 2),
                                      .log = &k->log};
    k->output_count = render_output_count(a);
    for (int i = 0; i < k->output_count; ++i)
        k->outputs[i] = render_output_name(a, scene, i);
    job->keep = &k->keep;
    return 0;
}

/* The checkpoint goes only when the pictures are where no power cut takes them from. */
static void forget(const struct render_keeping *k, const struct sr_render_keep *keep)
{
    bool ok = true;
    for (int i = 0; i < k->output_count; ++i)
        ok &= sr_store_sync_folder(k->outputs[i]);
    if (ok)
        sr_render_forget(keep);
}

int render_keep_end(struct render_keeping *k, const struct sr_render_job *job, const struct sr_film *film,
                    struct sr_render_part *part, struct sr_render_report *report, bool is_written)
{
    const struct sr_render_keep *keep = job->keep;
    if (!keep)
        return 0;
    struct sr_error error = {0};
    bool is_kept = report->kept.written > 0 && !report->kept.is_behind;
    if (report->is_complete && !is_written) { // all the work, for when there is room again
        is_kept = (part ? sr_render_part_checkpoint(job, part, report, &error)
                        : sr_render_checkpoint(job, film, report, &error)) == SR_OK;
        fprintf(stderr,
                is_kept ? "steradian render: the work is done and kept in %s: --resume writes the picture\n"
                        : "steradian render: nor can %s\n",
                is_kept ? keep->path : error.text);
        return SR_ERROR_RESOURCE;
    }
    if (report->is_complete) {
        if (report->kept.written || report->kept.is_resumed)
            forget(k, keep);
        return k->is_asked_for && report->kept.is_behind ? SR_ERROR_RESOURCE : 0;
    }
    if (is_kept)
        fprintf(stderr, "steradian render: the same command with --resume goes on from %s\n", keep->path);
    return is_kept ? 0 : SR_ERROR_RESOURCE;
}
