/* SPDX-License-Identifier: MIT */
/* steradian image: pictures from one format into another, cut, toned, or told as numbers. */
#include "command.h"
#include "image_false.h"
#include "image_region.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian image IN [-o OUT] [OPTIONS]\n"
    "       steradian image IN [IN…] --region X0,Y0,X1,Y1 --statistics\n"
    "\n"
    "Reads EXR, PNG, JPEG, PFM, HDR or TGA and writes .exr, .png, .pfm or .hdr, by the ending of OUT. Numbers keep\n"
    "their units, except in a PNG, which is for looking at. Without -o the statistics are printed.\n"
    "\n"
    "  -o, --outfile FILE     what to write\n"
    "      --exposure EV      of a PNG: values are multiplied by 2^EV [EV] (default: chosen from the picture)\n"
    "      --tone CURVE       of a PNG: linear (default), reinhard or filmic\n"
    "      --crop X0,Y0,W,H   this part of the picture [pixel]\n"
    "      --channel NAMES    these channels or groups only, such as depth or albedo or SE.R,SE.G,SE.B; three of them\n"
    "                         are shown as red, green and blue, one is shown as grey\n"
    "      --false-colour     a figure, .png or .svg: luminance (or the one channel chosen) in colours, with a legend\n"
    "      --scale LO,HI      of --false-colour: the ends of the legend [unit of the channel] (default: 0 and what\n"
    "                         99.9 % of the pixels stay below)\n"
    "      --log              of --false-colour: a logarithmic legend\n"
    "      --contours         of --false-colour: lines at the numbers of the legend\n"
    "      --title TEXT       of --false-colour: above the figure\n"
    "      --stats            mean, deviation, percentiles and odd values of each channel\n"
    "      --statistics       luminance and colour of the region as a measurement: mean with its uncertainty, least, most.\n"
    "                         Several pictures are replicates: independent renders with other seeds\n"
    "      --region X0,Y0,X1,Y1   from pixel X0,Y0 to before X1,Y1 (default: the whole picture)\n"
    "      --json             the statistics as JSON on standard output\n"
    "  -q, --quiet            no notes; warnings and errors stay\n"
    "\n"
    "Examples:\n"
    "  steradian image cornell.exr -o cornell.png --exposure -4 --tone filmic\n"
    "  steradian image cornell.exr -o albedo.png --channel albedo --exposure 0\n"
    "  steradian image cornell.exr --crop 100,100,64,64 --channel R,G,B --stats\n"
    "  steradian image sky.hdr -o sky.exr\n"
    "  steradian image seed1.exr seed2.exr seed3.exr --region 20,20,40,40 --statistics\n"
    "  steradian image room.exr --false-colour --scale 1,1000 --log --contours -o luminance.png\n";

struct arguments {
    const char *input, *output, *channels;
    const char *const *inputs;
    int input_count;
    bool has_exposure, has_tone, has_crop, has_region, measures, stats, json, quiet, is_false;
    double region[4]; // [pixel]
    struct false_colour false_colour;
    double exposure_EV, crop[4];
    enum sr_tone_operator tone;
};

enum {
    OPT_EXPOSURE = 256,
    OPT_TONE,
    OPT_CROP,
    OPT_CHANNEL,
    OPT_STATS,
    OPT_JSON,
    OPT_REGION,
    OPT_STATISTICS,
    OPT_FALSE,
    OPT_SCALE,
    OPT_LOG,
    OPT_CONTOURS,
    OPT_TITLE
};

static const struct option long_options[] = {
    {"outfile", required_argument, NULL, 'o'},
    {"exposure", required_argument, NULL, OPT_EXPOSURE},
    {"tone", required_argument, NULL, OPT_TONE},
    {"crop", required_argument, NULL, OPT_CROP},
    {"channel", required_argument, NULL, OPT_CHANNEL},
    {"false-colour", no_argument, NULL, OPT_FALSE},
    {"false-color", no_argument, NULL, OPT_FALSE},
    {"scale", required_argument, NULL, OPT_SCALE},
    {"log", no_argument, NULL, OPT_LOG},
    {"contours", no_argument, NULL, OPT_CONTOURS},
    {"title", required_argument, NULL, OPT_TITLE},
    {"stats", no_argument, NULL, OPT_STATS},
    {"statistics", no_argument, NULL, OPT_STATISTICS},
    {"region", required_argument, NULL, OPT_REGION},
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

static bool parse_tone(const char *text, enum sr_tone_operator *tone)
{
    static const char *const names[] = {"linear", "reinhard", "filmic"};
    for (int i = 0; i < 3; ++i)
        if (strcmp(text, names[i]) == 0) {
            *tone = (enum sr_tone_operator)i;
            return true;
        }
    command_usage(&command_image, "--tone %s: linear, reinhard or filmic was expected", text);
    return false;
}

static bool parse_crop(const char *text, double crop[4])
{
    if (!command_parse_floats(&command_image, "crop", text, 4, crop))
        return false;
    for (int i = 0; i < 4; ++i)
        if (!(crop[i] >= (i < 2 ? 0 : 1) && crop[i] <= 1 << 30 && crop[i] == floor(crop[i]))) {
            command_usage(&command_image, "--crop %s: X0,Y0,W,H in whole pixels was expected", text);
            return false;
        }
    return true;
}

static bool parse_region(const char *text, double r[4])
{
    if (!command_parse_floats(&command_image, "region", text, 4, r))
        return false;
    bool is_whole = true;
    for (int i = 0; i < 4; ++i)
        is_whole &= r[i] >= 0 && r[i] <= 1 << 30 && r[i] == floor(r[i]);
    if (is_whole && r[0] < r[2] && r[1] < r[3])
        return true;
    command_usage(&command_image, "--region %s: X0,Y0,X1,Y1 in whole pixels with X0 < X1 and Y0 < Y1 was expected",
                  text);
    return false;
}

static int parse(int argc, char **argv, struct arguments *a)
{
    const struct command *c = &command_image;
    *a = (struct arguments){0};
    struct false_colour *f = &a->false_colour;
    int option, index = 0;
    bool ok = true;
    while (ok && (option = command_next_option(argc, argv, ":o:q", long_options, &index)) != -1)
        switch (option) {
        case 'o':
            a->output = optarg;
            break;
        case 'q':
            a->quiet = true;
            break;
        case OPT_EXPOSURE:
            a->has_exposure = true;
            ok = command_parse_float(c, "exposure", optarg, -100, 100, &a->exposure_EV);
            break;
        case OPT_TONE:
            a->has_tone = true;
            ok = parse_tone(optarg, &a->tone);
            break;
        case OPT_CROP:
            a->has_crop = true;
            ok = parse_crop(optarg, a->crop);
            break;
        case OPT_CHANNEL:
            a->channels = optarg;
            break;
        case OPT_FALSE:
            a->is_false = true;
            break;
        case OPT_SCALE:
            f->has_scale = true;
            ok = command_parse_floats(c, "scale", optarg, 2, f->scale);
            break;
        case OPT_LOG:
            f->is_log = true;
            break;
        case OPT_CONTOURS:
            f->has_contours = true;
            break;
        case OPT_TITLE:
            f->title = optarg;
            break;
        case OPT_REGION:
            a->has_region = true;
            ok = parse_region(optarg, a->region);
            break;
        case OPT_STATISTICS:
            a->measures = true;
            break;
        case OPT_STATS:
            a->stats = true;
            break;
        case OPT_JSON:
            a->json = true;
            break;
        default:
            return command_bad_option(c, long_options, option, argv);
        }
    if (!ok)
        return SR_ERROR_USAGE;
    a->inputs = (const char *const *)argv + optind;
    a->input_count = argc - optind;
    if (a->has_region && !a->measures)
        return command_usage(c, "--region is for --statistics, which was not asked for");
    if (a->measures && (a->output || a->has_crop || a->channels || a->stats || a->is_false))
        return command_usage(c, "--statistics goes with --region and --json only");
    if (a->measures && optind < argc)
        return 0;
    if (optind + 1 != argc)
        return command_usage(c, optind == argc ? "a picture was expected" : "one picture was expected, there are %d",
                             argc - optind);
    a->input = argv[optind];
    if ((f->has_scale || f->is_log || f->has_contours || f->title) && !a->is_false)
        return command_usage(c, "--scale, --log, --contours and --title belong to --false-colour");
    if (f->has_scale && !(f->scale[1] > f->scale[0] && f->scale[0] >= 0 && (f->scale[0] > 0 || !f->is_log)))
        return command_usage(c, "--scale %g,%g: LO below HI was expected%s", f->scale[0], f->scale[1],
                             f->is_log ? ", and above 0" : "");
    if (a->is_false) {
        if (!a->output || !(sr_path_has_ending(a->output, ".png") || sr_path_has_ending(a->output, ".svg")))
            return command_usage(c, "--false-colour needs -o with the ending .png or .svg");
        if (a->has_exposure || a->has_tone)
            return command_usage(c,
                                 "--false-colour shows values as they are: --exposure and --tone do not belong to it");
    } else if (a->output && !command_is_image_ending(a->output))
        return command_usage(c, "%s: the ending .exr, .png, .pfm or .hdr was expected", a->output);
    if ((a->has_exposure || a->has_tone) && !(a->output && sr_path_has_ending(a->output, ".png")))
        return command_usage(c, "--exposure and --tone are for a .png; other formats keep the values and their units");
    a->stats |= a->json || !a->output;
    return 0;
}

/* ---- chosen channels ---- */

/* A picture of some channels; where they are to be shown and are three, they become R, G, B. */
static sr_status pick_channels(const struct arguments *a, const struct sr_image *image, struct sr_image **picked,
                               struct sr_error *error)
{
    struct sr_arena arena = {0};
    uint32_t count = 0, *indices = sr_arena_alloc(&arena, image->channel_count * sizeof *indices);
    const char **names = sr_arena_alloc(&arena, image->channel_count * sizeof *names);
    bool is_shown = a->output && !a->is_false && !sr_path_has_ending(a->output, ".exr");
    *picked = NULL;
    if (!indices || !names)
        sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to choose channels");
    else
        command_select_channels(image, a->input, a->channels, indices, &count, error);
    if (!error->status && is_shown && count != 1 && count != 3)
        sr_fail(error, SR_ERROR_USAGE, "%s: one channel or three can be written there, %s are %u", a->output,
                a->channels, count);
    for (uint32_t i = 0; !error->status && i < count; ++i)
        names[i] = is_shown && count == 3 ? (const char *[]){"R", "G", "B"}[i] : image->channels[indices[i]].name;
    if (!error->status &&
        sr_image_create(image->width, image->height, count, names, SR_IMAGE_FLOATS, picked, error) == SR_OK) {
        struct sr_image *out = *picked;
        for (uint32_t i = 0; i < count; ++i)
            sr_image_set_unit(out, i, image->channels[indices[i]].unit);
        for (uint32_t i = 0; i < image->attribute_count; ++i)
            sr_image_set_attribute(out, image->attributes[i].name, image->attributes[i].text, error);
        out->has_chromaticities = image->has_chromaticities;
        memcpy(out->chromaticities, image->chromaticities, sizeof out->chromaticities);
        out->x0 = image->x0, out->y0 = image->y0;
        out->full_width = image->full_width, out->full_height = image->full_height;
        for (size_t p = 0; p < (size_t)image->width * image->height; ++p)
            for (uint32_t i = 0; i < count; ++i)
                out->floats[p * count + i] = image->floats[p * image->channel_count + indices[i]];
    }
    sr_arena_free(&arena);
    return error->status;
}

/* ---- statistics ---- */

static void print_statistics_row(const struct sr_image_channel *channel, const struct sr_image_statistics *s)
{
    printf("%-12s %-9s %11.5g %11.5g %11.5g %11.5g %11.5g %11.5g %11.5g %9llu %9llu %6llu %6llu\n", channel->name,
           channel->unit[0] ? channel->unit : "no unit", s->mean, s->deviation, s->min, s->percentile_1,
           s->percentile_50, s->percentile_99, s->max, (unsigned long long)s->zero_count,
           (unsigned long long)s->negative_count, (unsigned long long)s->nan_count,
           (unsigned long long)s->infinite_count);
}

static json_t *statistics_json(const struct sr_image_channel *channel, const struct sr_image_statistics *s)
{
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:{s:s, s:I, s:I, s:I, s:I, s:I}}", "name",
        command_json_text(channel->name), "unit", command_json_text(channel->unit[0] ? channel->unit : NULL), "mean",
        command_json_number(s->mean), "deviation", command_json_number(s->deviation), "min",
        command_json_number(s->min), "percentile_1", command_json_number(s->percentile_1), "percentile_5",
        command_json_number(s->percentile_5), "percentile_50", command_json_number(s->percentile_50), "percentile_95",
        command_json_number(s->percentile_95), "percentile_99", command_json_number(s->percentile_99), "max",
        command_json_number(s->max), "sum", command_json_number(s->sum), "pixels", "unit", "1", "finite",
        (json_int_t)s->count, "zero", (json_int_t)s->zero_count, "negative", (json_int_t)s->negative_count, "nan",
        (json_int_t)s->nan_count, "infinite", (json_int_t)s->infinite_count);
}

static int print_statistics(const struct arguments *a, const struct sr_image *image)
{
    json_t *channels = json_array();
    struct sr_error error = {0};
    if (!a->json) {
        printf("%s: %u x %u pixels\n\n", a->input, image->width, image->height);
        printf("%-12s %-9s %11s %11s %11s %11s %11s %11s %11s %9s %9s %6s %6s\n", "channel", "unit", "mean",
               "deviation", "min", "1 %", "50 %", "99 %", "max", "zero", "negative", "NaN", "inf");
    }
    for (uint32_t c = 0; c < image->channel_count; ++c) {
        struct sr_image_statistics s;
        if (sr_image_statistics(image, c, &s, &error) != SR_OK)
            break;
        if (a->json)
            json_array_append_new(channels, statistics_json(&image->channels[c], &s));
        else
            print_statistics_row(&image->channels[c], &s);
    }
    if (error.status || !a->json) {
        json_decref(channels);
        return error.status ? command_fail("image", &error) : 0;
    }
    return command_print_json("image", json_pack("{s:o, s:{s:i, s:i, s:s}, s:o}", "file", command_json_text(a->input),
                                                 "size", "width", (int)image->width, "height", (int)image->height,
                                                 "unit", "pixel", "channels", channels));
}

/* ---- all together ---- */

static sr_status write_output(const struct arguments *a, const struct sr_image *image, struct sr_error *error)
{
    if (a->is_false)
        return image_write_false_colour(a->output, image, &a->false_colour, error);
    bool is_png = sr_path_has_ending(a->output, ".png");
    float exposure_EV = a->has_exposure ? (float)a->exposure_EV : 0;
    if (is_png && image->floats && !a->has_exposure)
        exposure_EV = sr_image_auto_exposure(image);
    struct sr_image_write_options options = {.tone = {.op = a->tone, .exposure_EV = exposure_EV}};
    if (sr_image_write(a->output, image, &options, error) == SR_OK && !a->quiet) {
        fprintf(stderr, "%s: %u x %u pixels", a->output, image->width, image->height);
        if (is_png && image->floats)
            fprintf(stderr, ", exposure %+.2f EV%s", (double)exposure_EV, a->has_exposure ? "" : " (chosen)");
        fputc('\n', stderr);
    }
    return error->status;
}

/* Crop, channels; the image may be replaced. */
static sr_status prepare(const struct arguments *a, struct sr_image **image, struct sr_error *error)
{
    struct sr_image *part;
    if (a->has_crop) {
        struct sr_error inner = {0};
        if (sr_image_crop(*image, (uint32_t)a->crop[0], (uint32_t)a->crop[1], (uint32_t)a->crop[2],
                          (uint32_t)a->crop[3], &part, &inner) != SR_OK)
            return sr_fail(error, inner.status == SR_ERROR_USAGE ? SR_ERROR_INPUT : inner.status, "%s: %s", a->input,
                           inner.text);
        sr_image_free(*image);
        *image = part;
    }
    // bytes stay bytes unless somebody wants other light in them
    if ((a->has_exposure || a->has_tone || a->channels || a->is_false) && sr_image_to_float(*image, error) != SR_OK)
        return error->status;
    if (a->channels && pick_channels(a, *image, &part, error) == SR_OK) {
        sr_image_free(*image);
        *image = part;
    }
    return error->status;
}

static int measure_region(const struct arguments *a)
{
    struct image_region region = {(uint32_t)a->region[0], (uint32_t)a->region[1], (uint32_t)a->region[2],
                                  (uint32_t)a->region[3]};
    if (!a->has_region) {
        struct sr_error error = {0};
        struct sr_image *image;
        if (sr_image_read(a->inputs[0], &image, &error) != SR_OK)
            return command_fail("image", &error);
        region = (struct image_region){0, 0, image->width, image->height};
        sr_image_free(image);
    }
    return image_print_region(a->inputs, a->input_count, &region, a->json);
}

static int run(int argc, char **argv)
{
    struct arguments a;
    int code = parse(argc, argv, &a);
    if (code)
        return code;
    if (a.measures)
        return measure_region(&a);
    struct sr_error error = {0};
    struct sr_image *image = NULL;
    if (sr_image_read(a.input, &image, &error) == SR_OK && prepare(&a, &image, &error) == SR_OK && a.output)
        write_output(&a, image, &error);
    code = error.status ? command_fail("image", &error) : a.stats ? print_statistics(&a, image) : 0;
    sr_image_free(image);
    return code;
}

const struct command command_image = {"image", "convert, crop, tone-map, and tell the values of a picture", help, run};
