/* SPDX-License-Identifier: MIT */
/* steradian render --sample-range, --part: some of a picture's samples into a file for steradian merge. */
#include "render_command.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "A-B" or "K/N": two whole numbers and nothing else. */
static bool parse_pair(const char *text, char between, uint64_t values[2])
{
    for (int i = 0; i < 2; ++i) {
        char *end;
        if (*text < '0' || *text > '9')
            return false;
        errno = 0;
        values[i] = strtoull(text, &end, 10);
        if (errno || *end != (i ? 0 : between))
            return false;
        text = end + 1;
    }
    return true;
}

bool render_parse_range(const char *text, struct sr_render_range *range)
{
    uint64_t v[2];
    if (!parse_pair(text, '-', v) || v[0] >= v[1] || v[1] > UINT32_MAX) {
        command_usage(&command_render,
                      "--sample-range %s: A-B with A < B was expected, as in 0-16 for the first 16 samples", text);
        return false;
    }
    *range = (struct sr_render_range){(uint32_t)v[0], (uint32_t)v[1]};
    return true;
}

bool render_parse_part(const char *text, uint64_t part[2])
{
    if (parse_pair(text, '/', part) && part[0] >= 1 && part[0] <= part[1] && part[1] <= UINT32_MAX)
        return true;
    command_usage(&command_render, "--part %s: K/N with 1 <= K <= N was expected, as in 3/16 for the third of 16 parts",
                  text);
    return false;
}

int render_check_part(const struct render_arguments *a)
{
    const struct command *c = &command_render;
    if (a->adaptive.is_on)
        return command_usage(
            c,
            "adaptive sampling decides by the values of all samples which ones follow: its pictures cannot be made in parts");
    if (a->partial_s > 0)
        return command_usage(c, "--write-partial does not go with a part, which is written when it is whole");
    if (a->meter_count)
        return command_usage(c, "--irradiance does not go with a part of a picture: 'steradian measure' reads meters");
    int parts = 0;
    for (int i = 0; i < a->output_count; ++i)
        parts += sr_path_has_ending(a->outputs[i], PART_ENDING);
    if (parts != 1)
        return command_usage(c, "a part of a picture needs one file to go to: -o FILE" PART_ENDING);
    return 0;
}

/* The samples that were asked for. */
static int resolve(const struct render_arguments *a, uint32_t spp, struct sr_render_range *range)
{
    uint64_t K = a->part[0], N = a->part[1];
    *range = a->range;
    if (N > spp)
        return command_usage(&command_render, "--part %llu/%llu: there are %u samples of each pixel: %u parts at most",
                             (unsigned long long)K, (unsigned long long)N, spp, spp);
    if (N)
        *range = (struct sr_render_range){(uint32_t)((K - 1) * spp / N), (uint32_t)(K * spp / N)};
    if (range->end > spp)
        return command_usage(
            &command_render,
            "--sample-range %u-%u: samples 0-%u of each pixel were expected: --spp, or the scene, says %u",
            range->begin, range->end, spp, spp);
    return 0;
}

static const char *part_name(const struct render_arguments *a)
{
    int i = 0;
    while (!sr_path_has_ending(a->outputs[i], PART_ENDING))
        ++i;
    return a->outputs[i];
}

/* What there is of a part that has been written. */
static int tell(struct rendering *r, struct sr_render_part *part)
{
    const struct render_arguments *a = r->arguments;
    struct sr_error error = {0};
    const struct sr_film *film = sr_render_part_film(part);
    const struct sr_render_report *report = sr_render_part_report(part);
    if (a->output_count > 1 && render_write_outputs(r, film, report->render_s, report->is_complete, &error) != SR_OK)
        return command_fail("render", &error);
    if (report->dropped)
        render_print_replay(r, report);
    if (!a->quiet) {
        render_print_summary(r, film, report);
        fprintf(stderr, "%s: samples %u-%u of 0-%u of each pixel\n", part_name(a), r->range.begin, r->range.end,
                r->job->spp);
    }
    return a->json ? render_print_json(r, film, report, json_array()) : 0;
}

static int render_and_write(struct rendering *r, struct render_keeping *keeping, const char *identity)
{
    struct sr_error error = {0};
    struct sr_render_part *part;
    struct sr_render_report report;
    render_catch_interrupts();
    sr_status status = sr_render_samples(r->job, r->range, &part, &report, &error);
    if (r->on_terminal)
        fputs("\r\033[K", stderr);
    if (status == SR_CANCELLED) {
        fprintf(stderr, "steradian render: interrupted; no part has been written\n");
        int code = render_keep_end(keeping, r->job, NULL, NULL, &report, false);
        return code ? code : render_interrupt_exit();
    }
    if (status != SR_OK)
        return command_fail("render", &error);
    bool is_written = sr_render_part_write(part, identity, r->about, part_name(r->arguments), &error) == SR_OK;
    if (!is_written)
        command_fail("render", &error);
    int code = render_keep_end(keeping, r->job, NULL, part, &report, is_written);
    if (is_written) {
        int told = tell(r, part);
        code = code ? code : told;
    }
    sr_render_part_destroy(part);
    return is_written ? code : SR_ERROR_RESOURCE;
}

int render_part(struct rendering *r, struct sr_render_job *job, const char *identity)
{
    struct sr_error error = {0};
    int code = resolve(r->arguments, job->spp, &r->range);
    if (code)
        return code;
    struct sr_arena arena = {0};
    const char *of_part = sr_arena_printf(&arena, "%ssamples %u-%u\n", identity, r->range.begin, r->range.end);
    if (!of_part)
        sr_fail(&error, SR_ERROR_RESOURCE, "not enough memory for what the part is of");
    if (error.status || render_check_memory(job, &r->range, &error) != SR_OK) {
        sr_arena_free(&arena);
        return command_fail("render", &error);
    }
    struct render_keeping keeping;
    code = render_keep_begin(r->arguments, r->scene, of_part, job, &keeping);
    r->keep = job->keep;
    if (!code)
        code = render_and_write(r, &keeping, identity);
    sr_arena_free(&keeping.arena);
    sr_arena_free(&arena);
    return code;
}
