/* SPDX-License-Identifier: MIT */
/* steradian convert: scenes of any format as pbrt-v4 text. */
#include "command.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "steradian convert: scenes as pbrt-v4 text\n\n"
    "Usage: steradian convert [OPTIONS] IN -o OUT.pbrt\n\n"
    "IN is a pbrt-v4 file (\"-\": standard input), which is written anew in one form, in its order and with its names and\n"
    "comments; a pbrt-v3 file with --upgrade; or glTF, GLB, OBJ, STL or PLY.\n\n"
    "  -o, --output FILE    the text; \"-\": standard output\n"
    "  --upgrade            IN is in the format of pbrt-v3; what can only be approximated is warned about, with its place\n"
    "  --ply[=VERTICES]     triangle meshes of more than so many vertices (100) become PLY files beside OUT; for other\n"
    "                       formats than pbrt's this is the default, --ply=0 keeps them in the text\n"
    "  --includes keep|flatten\n"
    "                       whether Include stays, or the text that it means takes its place; kept by default where OUT\n"
    "                       lies beside IN and nothing is upgraded\n"
    "  --for pbrt|steradian materials that pbrt does not know become the nearest that it knows (the default), or stay\n"
    "  -q, --quiet          warnings and errors only\n\n"
    "Names of files are told anew as seen from OUT's folder. Numbers are written with as few digits as read back to the same\n"
    "value, so the picture stays the same, bit by bit. OUT is read back before it is written, and never half-written.\n\n"
    "Examples:\n"
    "  steradian convert scene.pbrt -o tidy.pbrt\n"
    "  steradian convert scene.pbrt -o - | less\n"
    "  steradian convert old/scene.pbrt --upgrade -o new/scene.pbrt --ply\n"
    "  steradian convert chair.glb -o chair.pbrt\n";

enum { FIRST = 256, UPGRADE, PLY, INCLUDES, FOR };

static bool parse_word(const char *option, const char *text, const char *yes, const char *no, bool *value)
{
    *value = strcmp(text, yes) == 0;
    if (*value || strcmp(text, no) == 0)
        return true;
    command_usage(&command_convert, "--%s %s: %s or %s was expected", option, text, yes, no);
    return false;
}

static sr_status write_text(const char *path, const char *text, size_t size, struct sr_error *error)
{
    if (strcmp(path, "-") != 0)
        return sr_file_write(path, text, size, error);
    if (fwrite(text, 1, size, stdout) != size || fflush(stdout) != 0)
        return sr_fail(error, SR_ERROR_RESOURCE, "standard output: cannot be written");
    return SR_OK;
}

static bool is_pbrt(const char *path)
{
    static const char *const others[] = {".gltf", ".glb", ".obj", ".stl", ".ply"};
    for (size_t i = 0; i < sizeof others / sizeof *others; ++i)
        if (sr_path_has_ending(path, others[i]))
            return false;
    return true;
}

static bool same_folder(const char *a, const char *b)
{
    const char *slash_a = strrchr(a, '/'), *slash_b = strrchr(b, '/');
    size_t n = slash_a ? (size_t)(slash_a - a) : 0, m = slash_b ? (size_t)(slash_b - b) : 0;
    return n == m && !slash_a == !slash_b && memcmp(a, b, n) == 0;
}

static int run(int argc, char **argv)
{
    static const struct option options[] = {{"output", required_argument, NULL, 'o'},
                                            {"upgrade", no_argument, NULL, UPGRADE},
                                            {"ply", optional_argument, NULL, PLY},
                                            {"includes", required_argument, NULL, INCLUDES},
                                            {"for", required_argument, NULL, FOR},
                                            {"quiet", no_argument, NULL, 'q'},
                                            {NULL, 0, NULL, 0}};
    struct sr_convert_options o = {0};
    bool quiet = false, has_includes = false, has_ply = false;
    uint64_t vertices = 100;
    for (int c; (c = command_next_option(argc, argv, ":o:q", options, NULL)) != -1;) {
        bool ok = true;
        switch (c) {
        case 'o':
            o.out = optarg;
            break;
        case 'q':
            quiet = true;
            break;
        case UPGRADE:
            o.upgrades = true;
            break;
        case PLY:
            has_ply = true;
            ok = !optarg || command_parse_uint(&command_convert, "ply", optarg, 0, UINT32_MAX, &vertices);
            break;
        case INCLUDES:
            has_includes = true;
            ok = parse_word("includes", optarg, "flatten", "keep", &o.flattens);
            break;
        case FOR:
            ok = parse_word("for", optarg, "steradian", "pbrt", &o.for_steradian);
            break;
        default:
            return command_bad_option(&command_convert, options, c, argv);
        }
        if (!ok)
            return SR_ERROR_USAGE;
    }
    if (optind + 1 != argc)
        return command_usage(&command_convert,
                             optind == argc ? "a scene was expected" : "one scene was expected, not %d", argc - optind);
    const char *in = argv[optind];
    if (!o.out)
        return command_usage(&command_convert, "-o FILE was expected, or -o - for standard output");
    if (strcmp(o.out, "-") == 0 && (has_ply ? vertices > 0 : !is_pbrt(in)))
        return command_usage(&command_convert,
                             "meshes cannot be written beside standard output: --ply=0 keeps them in the text");
    o.ply_above = has_ply || !is_pbrt(in) ? (uint32_t)vertices : 0;
    if (!has_includes)
        o.flattens = o.upgrades || !same_folder(in, o.out);
    struct sr_log log = command_log(&quiet);
    struct sr_error error = {0};
    char *text;
    size_t size;
    if (strcmp(o.out, "-") != 0 && command_check_output(o.out, &error) != SR_OK)
        return command_fail("convert", &error);
    if (sr_convert(in, &o, &text, &size, &log, &error) == SR_OK)
        write_text(o.out, text, size, &error);
    sr_free(text);
    return error.status == SR_OK ? 0 : command_fail("convert", &error);
}

const struct command command_convert = {
    .name = "convert", .summary = "write scenes as pbrt-v4 text, tidied or upgraded", .help = help, .run = run};
