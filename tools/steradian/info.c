/* SPDX-License-Identifier: MIT */
/* steradian info: what is in a file, without rendering it: pictures here, scenes in info_scene.c, luminaires in
 * info_luminaire.c, checkpoints in info_store.c. */
#include "info.h"

#include "store/store.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian info FILE [--json] [--plot FIGURE] [-o OUT]\n"
    "\n"
    "Tells what a picture (EXR, PNG, JPEG, PFM, HDR, TGA) or a scene (.pbrt, .pbrt.gz, '-': a scene from standard\n"
    "input) contains, without rendering: sizes, channels with their units, attributes; sensor, film, lights, shapes,\n"
    "bounds, memory. Of a luminaire (.ies, .ldt): flux, peak, beam and field angles, efficacy, size, its words. Of a\n"
    "checkpoint (.srk) or a part of a picture (.srp): of which render it is, how far it has come, whether it is whole.\n"
    "\n"
    "      --json             the same as JSON on standard output\n"
    "  -o, --outfile FILE     writes a luminaire in the format of the ending, .ies (LM-63-2002) or .ldt\n"
    "      --plot FIGURE      a luminaire's intensity over directions as a polar diagram, .svg or .png\n"
    "  -q, --quiet            no notes about the scene; warnings and errors stay\n"
    "\n"
    "Examples:\n"
    "  steradian info scenes/cornell-box.pbrt\n"
    "  steradian info cornell.exr --json\n"
    "  steradian info lamp.ies --plot lamp.svg -o lamp.ldt\n";

static const struct option long_options[] = {
    {"json", no_argument, NULL, 'j'},
    {"outfile", required_argument, NULL, 'o'},
    {"plot", required_argument, NULL, 'p'},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

static bool has_ending_of(const char *path, const char *const *endings)
{
    for (; *endings; ++endings)
        if (sr_path_has_ending(path, *endings))
            return true;
    return false;
}

/* ---- pictures ---- */

static const char *unit_of(const struct sr_image_channel *channel)
{
    return channel->unit[0] ? channel->unit : "no unit";
}

static const char *type_of(const struct sr_image *image)
{
    return image->floats ? "float32" : image->encoding == SR_IMAGE_SRGB ? "8 bits, sRGB" : "8 bits, linear";
}

static int print_image(const char *path, const struct sr_image *image)
{
    printf("%s: a picture of %u x %u pixels, %u channels\n", path, image->width, image->height, image->channel_count);
    if (image->full_width != image->width || image->full_height != image->height || image->x0 || image->y0)
        printf("  part of %u x %u pixels, from (%d, %d)\n", image->full_width, image->full_height, image->x0,
               image->y0);
    if (image->has_chromaticities) {
        const double(*k)[2] = image->chromaticities;
        printf("  primaries [CIE 1931 x, y]: red %g, %g; green %g, %g; blue %g, %g; white %g, %g\n", k[0][0], k[0][1],
               k[1][0], k[1][1], k[2][0], k[2][1], k[3][0], k[3][1]);
    }
    printf("\n  %-14s %-9s %-14s %12s %12s %12s\n", "channel", "unit", "type", "mean", "min", "max");
    for (uint32_t c = 0; c < image->channel_count; ++c) {
        struct sr_image_statistics s;
        struct sr_error error = {0};
        if (sr_image_statistics(image, c, &s, &error) != SR_OK)
            return command_fail("info", &error);
        printf("  %-14s %-9s %-14s %12.6g %12.6g %12.6g", image->channels[c].name, unit_of(&image->channels[c]),
               type_of(image), s.mean, s.min, s.max);
        if (s.nan_count + s.infinite_count)
            printf("  (%llu NaN, %llu infinite)", (unsigned long long)s.nan_count,
                   (unsigned long long)s.infinite_count);
        putchar('\n');
    }
    if (image->attribute_count)
        printf("\n  attributes\n");
    for (uint32_t i = 0; i < image->attribute_count; ++i)
        printf("  %-30s %s\n", image->attributes[i].name, image->attributes[i].text);
    return 0;
}

static int print_image_json(const char *path, const struct sr_image *image)
{
    struct sr_error error = {0};
    json_t *channels = json_array(), *attributes = json_object(), *primaries = json_null();
    for (uint32_t c = 0; c < image->channel_count; ++c) {
        struct sr_image_statistics s;
        if (sr_image_statistics(image, c, &s, &error) != SR_OK)
            break;
        const char *unit = image->channels[c].unit[0] ? image->channels[c].unit : NULL;
        json_array_append_new(channels,
                              json_pack("{s:o, s:o, s:s, s:o, s:o, s:o, s:I, s:I}", "name",
                                        command_json_text(image->channels[c].name), "unit", command_json_text(unit),
                                        "type", type_of(image), "mean", command_json_number(s.mean), "min",
                                        command_json_number(s.min), "max", command_json_number(s.max), "nan",
                                        (json_int_t)s.nan_count, "infinite", (json_int_t)s.infinite_count));
    }
    if (error.status) {
        json_decref(channels);
        json_decref(attributes);
        return command_fail("info", &error);
    }
    for (uint32_t i = 0; i < image->attribute_count; ++i)
        json_object_set_new(attributes, image->attributes[i].name, command_json_text(image->attributes[i].text));
    if (image->has_chromaticities) {
        const double(*k)[2] = image->chromaticities;
        primaries = json_pack("{s:[f,f], s:[f,f], s:[f,f], s:[f,f], s:s}", "red", k[0][0], k[0][1], "green", k[1][0],
                              k[1][1], "blue", k[2][0], k[2][1], "white", k[3][0], k[3][1], "unit", "1");
    }
    return command_print_json(
        "info", json_pack("{s:o, s:s, s:{s:i, s:i, s:s}, s:{s:i, s:i, s:i, s:i, s:s}, s:o, s:o, s:o}", "file",
                          command_json_text(path), "kind", "picture", "size", "width", (int)image->width, "height",
                          (int)image->height, "unit", "pixel", "part_of", "width", (int)image->full_width, "height",
                          (int)image->full_height, "x0", (int)image->x0, "y0", (int)image->y0, "unit", "pixel",
                          "chromaticities", primaries, "channels", channels, "attributes", attributes));
}

/* ---- which kind of file ---- */

static int run(int argc, char **argv)
{
    static const char *const scenes[] = {".pbrt", ".pbrt.gz", ".gltf", ".glb", ".obj", ".stl", ".ply", NULL};
    static const char *const later[] = {".usd", ".usda", ".usdc", ".usdz", ".blend", ".fbx",
                                        ".dae", ".xml",  ".abc",  ".rad",  ".mtlx",  NULL};
    struct info_arguments a = {0};
    int option, index = 0;
    while ((option = command_next_option(argc, argv, ":o:q", long_options, &index)) != -1)
        switch (option) {
        case 'j':
            a.json = true;
            break;
        case 'o':
            a.outfile = optarg;
            break;
        case 'p':
            a.plot = optarg;
            break;
        case 'q':
            a.quiet = true;
            break;
        default:
            return command_bad_option(&command_info, long_options, option, argv);
        }
    if (optind + 1 != argc)
        return command_usage(&command_info,
                             optind == argc ? "a file was expected" : "one file was expected, there are %d",
                             argc - optind);
    a.path = argv[optind];
    if (strcmp(a.path, "-") == 0 || has_ending_of(a.path, scenes))
        return info_scene(&a);
    if (sr_path_has_ending(a.path, ".ies") || sr_path_has_ending(a.path, ".ldt"))
        return info_luminaire(&a);
    if (sr_store_is_store(a.path))
        return info_store(&a);

    if (a.plot || a.outfile)
        return command_usage(&command_info, "--plot and -o are for luminaires, .ies or .ldt");
    struct sr_error error = {0};
    struct sr_image *image = NULL;
    if (sr_file_exists(a.path) && has_ending_of(a.path, later))
        sr_fail(
            &error, SR_ERROR_INPUT,
            "%s: this kind of file is not supported yet; scenes are .pbrt or .pbrt.gz, .gltf, .glb, .obj, .stl and .ply, luminaires .ies or .ldt, pictures EXR, "
            "PNG, JPEG, PFM, HDR, TGA",
            a.path);
    else if (sr_file_exists(a.path) && (sr_path_has_ending(a.path, ".ply") || sr_path_has_ending(a.path, ".ply.gz")))
        sr_fail(&error, SR_ERROR_INPUT,
                "%s: a mesh alone is not understood; a scene (.pbrt) names it by Shape \"plymesh\" \"string filename\"",
                a.path);
    else if (sr_image_read(a.path, &image, &error) == SR_OK) {
        int code = a.json ? print_image_json(a.path, image) : print_image(a.path, image);
        sr_image_free(image);
        return code;
    } else if (strstr(error.text, "is no image that can be read")) {
        error = (struct sr_error){0};
        sr_fail(
            &error, SR_ERROR_INPUT,
            "%s: is neither a picture (EXR, PNG, JPEG, PFM, HDR, TGA) nor named like a scene (.pbrt, .pbrt.gz) or a luminaire (.ies, .ldt)",
            a.path);
    }
    return command_fail("info", &error);
}

const struct command command_info = {"info", "what is in a picture, a scene or a luminaire", help, run};
