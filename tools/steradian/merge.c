/* SPDX-License-Identifier: MIT */
/* steradian merge: parts of a picture into the picture that one render would have made, to the last bit. */
#include "picture.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian merge PART.srp … -o OUT.exr [OPTIONS]\n"
    "\n"
    "Makes the picture of parts that 'steradian render --sample-range A-B' or '--part K/N' has written, anywhere and in any\n"
    "order: the bytes are those of one render of all samples. Nothing but the parts is needed. Refused are parts of another\n"
    "scene, seed, setting or program, parts that have a sample in common, and damaged files.\n"
    "\n"
    "  -o, --outfile FILE     .exr, .png, .pfm or .hdr; or .srp: a larger part, which may be merged further; may be given\n"
    "                         several times\n"
    "      --allow-missing    a picture of the samples that are there; the EXR then says steradian.complete = no\n"
    "      --exposure EV      exposure of a PNG in stops (default: chosen from the picture)\n"
    "      --json             what was merged, as JSON on standard output\n"
    "  -q, --quiet            no summary; warnings and errors stay\n"
    "\n"
    "Exit codes: 0 done, 1 samples are missing (which ones is told), 2 usage, 3 a part is damaged, foreign or overlaps, 4 the\n"
    "output cannot be written or memory is short.\n"
    "\n"
    "Examples:\n"
    "  for k in 1 2 3 4; do steradian render scene.pbrt --part $k/4 -o part-$k.srp; done\n"
    "  steradian merge part-*.srp -o scene.exr -o scene.png\n"
    "  steradian merge part-1.srp part-3.srp -o look.png --allow-missing\n"
    "  steradian merge night-1/*.srp -o night-1.srp\n";

enum { OPT_ALLOW = 256, OPT_EXPOSURE, OPT_JSON, MAX_OUTPUTS = 8 };
static const char part_ending[] = ".srp";

static const struct option long_options[] = {
    {"outfile", required_argument, NULL, 'o'},
    {"allow-missing", no_argument, NULL, OPT_ALLOW},
    {"exposure", required_argument, NULL, OPT_EXPOSURE},
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

struct arguments {
    const char *outputs[MAX_OUTPUTS], *const *parts;
    int output_count, part_count;
    bool allows_missing, has_exposure, json, quiet, wants_picture;
    double exposure_EV;
};

/* Samples, and where they came from. */
struct piece {
    struct sr_render_range range;
    const char *file;
};

struct merging {
    struct arguments a;
    struct sr_render_part *all; // of all parts so far
    struct sr_array pieces;     // of struct piece
};

static int parse(int argc, char **argv, struct arguments *a)
{
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":o:q", long_options, &index)) != -1)
        switch (option) {
        case 'o':
            if (a->output_count == MAX_OUTPUTS)
                return command_usage(&command_merge, "at most %d output files", MAX_OUTPUTS);
            if (!command_is_image_ending(optarg) && !sr_path_has_ending(optarg, part_ending))
                return command_usage(&command_merge, "%s: the ending .exr, .png, .pfm, .hdr or .srp was expected",
                                     optarg);
            a->wants_picture |= command_is_image_ending(optarg);
            a->outputs[a->output_count++] = optarg;
            break;
        case OPT_ALLOW:
            a->allows_missing = true;
            break;
        case OPT_EXPOSURE:
            a->has_exposure = true;
            if (!command_parse_float(&command_merge, "exposure", optarg, -100, 100, &a->exposure_EV))
                return SR_ERROR_USAGE;
            break;
        case OPT_JSON:
            a->json = true;
            break;
        case 'q':
            a->quiet = true;
            break;
        default:
            return command_bad_option(&command_merge, long_options, option, argv);
        }
    a->parts = (const char *const *)&argv[optind];
    a->part_count = argc - optind;
    if (a->part_count == 0)
        return command_usage(
            &command_merge,
            "parts of a picture were expected: files that 'steradian render --sample-range' has written");
    if (a->output_count == 0)
        return command_usage(&command_merge, "-o FILE was expected: where does the picture go?");
    return 0;
}

/* ---- parts, one after the other ---- */

static sr_status check_identity(const struct merging *m, const char *file, const struct sr_render_part *part,
                                struct sr_error *error)
{
    struct sr_render_difference d;
    if (!sr_render_identity_differs(sr_render_part_identity(part), sr_render_part_identity(m->all), &d))
        return SR_OK;
    return sr_fail(error, SR_ERROR_INPUT, "%s: is of another picture than %s: its %s is \"%s\", and there it is \"%s\"",
                   file, m->a.parts[0], d.key, d.theirs, d.ours);
}

static sr_status check_overlap(const struct merging *m, const char *file, struct sr_render_range r,
                               struct sr_error *error)
{
    const struct piece *pieces = m->pieces.data;
    for (size_t i = 0; i < m->pieces.count; ++i)
        if (r.begin < pieces[i].range.end && pieces[i].range.begin < r.end)
            return sr_fail(error, SR_ERROR_INPUT, "%s: has samples %u-%u, of which %s has %u-%u already", file, r.begin,
                           r.end, pieces[i].file, pieces[i].range.begin, pieces[i].range.end);
    return SR_OK;
}

/* Notes where the samples of a part come from. */
static sr_status add_pieces(struct merging *m, const char *file, const struct sr_render_part *part,
                            struct sr_error *error)
{
    struct sr_render_range r;
    for (size_t i = 0; sr_render_part_range(part, i, &r); ++i) {
        if (check_overlap(m, file, r, error) != SR_OK)
            return error->status;
        struct piece *p = sr_array_push(&m->pieces, sizeof *p);
        if (!p)
            return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %d parts", m->a.part_count);
        *p = (struct piece){r, file};
    }
    return SR_OK;
}

static sr_status add_file(struct merging *m, const char *file, struct sr_error *error)
{
    struct sr_render_part *part;
    if (sr_render_part_read(file, &part, error) != SR_OK)
        return error->status;
    if (m->all && check_identity(m, file, part, error) != SR_OK) {
        sr_render_part_destroy(part);
        return error->status;
    }
    add_pieces(m, file, part, error);
    if (!m->all) {
        m->all = part;
        return error->status;
    }
    if (error->status == SR_OK)
        sr_render_part_add(m->all, part, error);
    sr_render_part_destroy(part);
    return error->status;
}

/* ---- the picture ---- */

/* The number-th range of samples that no part has; false: there are no more. */
static bool missing(const struct sr_render_part *part, size_t number, struct sr_render_range *out)
{
    uint32_t at = 0;
    struct sr_render_range r;
    for (size_t i = 0;; ++i) {
        bool is_there = sr_render_part_range(part, i, &r);
        *out = (struct sr_render_range){at, is_there ? r.begin : sr_render_part_spp(part)};
        if (out->begin < out->end && number-- == 0)
            return true;
        if (!is_there)
            return false;
        at = r.end;
    }
}

static int tell_missing(const struct merging *m)
{
    enum { MOST = 8 };
    struct sr_render_range r;
    size_t i = 0;
    fprintf(stderr, "steradian merge: samples are missing:");
    for (; missing(m->all, i, &r) && i < MOST; ++i)
        fprintf(stderr, "%s %u-%u", i ? "," : "", r.begin, r.end);
    fprintf(stderr, "%s of 0-%u\nRender them with --sample-range A-B, or look at what there is with --allow-missing.\n",
            missing(m->all, i, &r) ? " and others" : "", sr_render_part_spp(m->all));
    return SR_ERROR_CHECK;
}

static json_t *range_json(struct sr_render_range r)
{
    return json_pack("[I, I]", (json_int_t)r.begin, (json_int_t)r.end);
}

static int print_json(const struct merging *m, const struct sr_film *film)
{
    json_t *outputs = json_array(), *parts = json_array(), *lacks = json_array(), *identity = json_object();
    for (int i = 0; i < m->a.output_count; ++i)
        json_array_append_new(outputs, command_json_text(m->a.outputs[i]));
    const struct piece *pieces = m->pieces.data;
    for (size_t i = 0; i < m->pieces.count; ++i)
        json_array_append_new(parts, json_pack("{s:o, s:o}", "file", command_json_text(pieces[i].file), "samples",
                                               range_json(pieces[i].range)));
    struct sr_render_range r;
    for (size_t i = 0; missing(m->all, i, &r); ++i)
        json_array_append_new(lacks, range_json(r));
    for (const char *p = sr_render_part_identity(m->all); *p; p += strcspn(p, "\n"), p += *p == '\n') {
        char key[96], value[512];
        int n = (int)strcspn(p, " \n"), end = (int)strcspn(p, "\n");
        snprintf(key, sizeof key, "%.*s", n, p);
        snprintf(value, sizeof value, "%.*s", end > n ? end - n - 1 : 0, p + n + (end > n));
        json_object_set_new(identity, key, command_json_text(value));
    }
    struct sr_quantity L = picture_mean_luminance(film);
    const struct sr_render_report *report = sr_render_part_report(m->all);
    return command_print_json(
        "merge",
        json_pack("{s:s, s:o, s:b, s:o, s:o, s:I, s:o, s:o, s:{s:I, s:I, s:I, s:I, s:I}}", "version", SR_VERSION,
                  "outputs", outputs, "complete", sr_render_part_is_complete(m->all), "parts", parts, "missing", lacks,
                  "spp", (json_int_t)sr_render_part_spp(m->all), "mean_luminance", command_json_measured(&L),
                  "identity", identity, "counts", "paths", (json_int_t)report->paths, "rays", (json_int_t)report->rays,
                  "shadow_rays", (json_int_t)report->shadow_rays, "vertices", (json_int_t)report->vertices,
                  "dropped_samples", (json_int_t)report->dropped));
}

static void print_summary(const struct merging *m, const struct sr_film *film)
{
    const struct sr_render_report *report = sr_render_part_report(m->all);
    picture_print_mean(film, !sr_render_part_is_replicated(m->all));
    fprintf(stderr, "%d part%s: %u x %u pixels, %.6g of %u samples each; %llu paths, %llu rays\n", m->a.part_count,
            m->a.part_count > 1 ? "s" : "", film->width, film->height, picture_mean_spp(film),
            sr_render_part_spp(m->all), (unsigned long long)report->paths,
            (unsigned long long)(report->rays + report->shadow_rays));
}

static int write_all(const struct merging *m, struct sr_error *error)
{
    const struct arguments *a = &m->a;
    const char *about = sr_render_part_about(m->all);
    for (int i = 0; i < a->output_count; ++i)
        if (sr_path_has_ending(a->outputs[i], part_ending) &&
            sr_render_part_write(m->all, sr_render_part_identity(m->all), about, a->outputs[i], error) != SR_OK)
            return command_fail("merge", error);
    bool is_complete = sr_render_part_is_complete(m->all);
    if (a->wants_picture && !is_complete && !a->allows_missing)
        return tell_missing(m);
    struct picture p = {.film = sr_render_part_film(m->all),
                        .about = about,
                        .is_replicated = sr_render_part_is_replicated(m->all),
                        .is_complete = is_complete,
                        .has_exposure = a->has_exposure,
                        .exposure_EV = a->exposure_EV};
    if (a->wants_picture && picture_write(&p, a->outputs, a->output_count, error) != SR_OK)
        return command_fail("merge", error);
    const struct sr_render_report *report = sr_render_part_report(m->all);
    if (report->dropped)
        fprintf(
            stderr,
            "warning: %llu samples were not finite and count as zero; the first is of pixel %u,%u, sample %u, replicate %u\n",
            (unsigned long long)report->dropped, report->dropped_x, report->dropped_y, report->dropped_sample,
            report->dropped_replicate);
    if (!a->quiet)
        print_summary(m, p.film);
    return a->json ? print_json(m, p.film) : 0;
}

static int run(int argc, char **argv)
{
    struct merging m = {0};
    struct sr_error error = {0};
    int code = parse(argc, argv, &m.a);
    if (code)
        return code;
    for (int i = 0; i < m.a.output_count; ++i)
        if (command_check_output(m.a.outputs[i], &error) != SR_OK)
            return command_fail("merge", &error);
    for (int i = 0; i < m.a.part_count && error.status == SR_OK; ++i)
        add_file(&m, m.a.parts[i], &error);
    code = error.status ? command_fail("merge", &error) : write_all(&m, &error);
    sr_render_part_destroy(m.all);
    sr_array_free(&m.pieces);
    return code;
}

const struct command command_merge = {"merge", "parts of a picture into the picture, to the last bit", help, run};
