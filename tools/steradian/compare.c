/* SPDX-License-Identifier: MIT */
/* steradian compare: how far two pictures are apart, and whether by more than their noise.
 *
 *     RMSE = sqrt(<(a-b)^2>) [unit],  relMSE = <(a-b)^2 / (b^2 + 0.01 <b>^2)> [1],
 *     z = sum (a-b) / sqrt(sum (SE_a^2 + SE_b^2)) [1],  p = P(|N(0,1)| > |z|)
 *
 * Limits: z takes the pixels as independent; where errors are told conservatively |z| is smaller than it should be. */
#include "command.h"

#include "math/math.h"

#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian compare A B [-o DIFFERENCE.png] [OPTIONS]\n"
    "\n"
    "Compares picture A with the reference B, channel by channel: mean, RMSE, relMSE, largest difference; and where\n"
    "either has standard errors (channels SE.R, …) whether they differ by more than their noise.\n"
    "\n"
    "  -o, --outfile FILE     a picture of the difference: white equal, red A is more, blue B is more\n"
    "      --scale X          the difference that gets the full colour [unit] (default: its 99th percentile)\n"
    "      --channel NAMES    these channels or groups, such as R,G,B or albedo (default: the picture's colour)\n"
    "      --all              every channel that both have\n"
    "      --max-rmse X       fail where a channel's RMSE is above X [unit of the channel]\n"
    "      --max-relmse X     fail where a channel's relMSE is above X [1]\n"
    "      --max-z X          fail where a channel's |z| of the mean is above X [1]\n"
    "      --json             the numbers as JSON on standard output\n"
    "  -q, --quiet            no table; warnings and errors stay\n"
    "\n"
    "With a limit, pixels that are not finite in A or B fail too.\n"
    "Exit codes: 0 within the limits, 1 a limit is exceeded, 2 usage, 3 bad input (also: sizes differ), 4 cannot "
    "write.\n"
    "\n"
    "Examples:\n"
    "  steradian compare mine.exr reference.exr\n"
    "  steradian compare seed1.exr seed2.exr --max-z 5 --quiet && echo 'the same, as far as noise lets us see'\n"
    "  steradian compare a.exr b.exr -o difference.png --scale 2 --json\n";

struct arguments {
    const char *a, *b, *output, *channels;
    double scale, max_rmse, max_rel_mse, max_z; // NaN: no limit
    bool all, json, quiet;
};

enum { OPT_SCALE = 256, OPT_CHANNEL, OPT_ALL, OPT_MAX_RMSE, OPT_MAX_RELMSE, OPT_MAX_Z, OPT_JSON };

static const struct option long_options[] = {
    {"outfile", required_argument, NULL, 'o'},
    {"scale", required_argument, NULL, OPT_SCALE},
    {"channel", required_argument, NULL, OPT_CHANNEL},
    {"all", no_argument, NULL, OPT_ALL},
    {"max-rmse", required_argument, NULL, OPT_MAX_RMSE},
    {"max-relmse", required_argument, NULL, OPT_MAX_RELMSE},
    {"max-z", required_argument, NULL, OPT_MAX_Z},
    {"json", no_argument, NULL, OPT_JSON},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

static int parse(int argc, char **argv, struct arguments *a)
{
    const struct command *c = &command_compare;
    *a = (struct arguments){.max_rmse = (double)NAN, .max_rel_mse = (double)NAN, .max_z = (double)NAN};
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
        case OPT_CHANNEL:
            a->channels = optarg;
            break;
        case OPT_ALL:
            a->all = true;
            break;
        case OPT_JSON:
            a->json = true;
            break;
        case OPT_SCALE:
            ok = command_parse_float(c, "scale", optarg, 1e-30, 1e30, &a->scale);
            break;
        case OPT_MAX_RMSE:
            ok = command_parse_float(c, "max-rmse", optarg, 0, 1e30, &a->max_rmse);
            break;
        case OPT_MAX_RELMSE:
            ok = command_parse_float(c, "max-relmse", optarg, 0, 1e30, &a->max_rel_mse);
            break;
        case OPT_MAX_Z:
            ok = command_parse_float(c, "max-z", optarg, 0, 1e30, &a->max_z);
            break;
        default:
            return command_bad_option(c, long_options, option, argv);
        }
    if (!ok)
        return SR_ERROR_USAGE;
    if (optind + 2 != argc)
        return command_usage(c, "two pictures were expected, there %s %d", argc - optind == 1 ? "is" : "are",
                             argc - optind);
    if (a->channels && a->all)
        return command_usage(c, "--channel and --all do not go together");
    if (a->output && !command_is_image_ending(a->output))
        return command_usage(c, "%s: the ending .png, .exr, .pfm or .hdr was expected", a->output);
    a->a = argv[optind];
    a->b = argv[optind + 1];
    return 0;
}

/* ---- which channels count ---- */

static bool is_colour_channel(const char *name)
{
    static const char *const names[] = {"R", "G", "B", "X", "Y", "Z", "A"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

/* Leaves in the comparison what the user asked for. */
static sr_status keep_chosen(const struct arguments *a, const struct sr_image *image,
                             struct sr_image_comparison *comparison, struct sr_error *error)
{
    if (a->all)
        return SR_OK;
    uint32_t kept = 0, chosen_count = 0;
    uint32_t *chosen = sr_alloc(image->channel_count * sizeof *chosen);
    if (!chosen)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory to compare two images");
    if (a->channels && command_select_channels(image, a->a, a->channels, chosen, &chosen_count, error) != SR_OK) {
        sr_free(chosen);
        return error->status;
    }
    for (uint32_t i = 0; i < comparison->channel_count; ++i) {
        const char *name = comparison->channels[i].name;
        bool keep = !a->channels && is_colour_channel(name);
        for (uint32_t k = 0; k < chosen_count; ++k)
            keep |= strcmp(image->channels[chosen[k]].name, name) == 0;
        if (keep)
            comparison->channels[kept++] = comparison->channels[i];
    }
    sr_free(chosen);
    if (kept)
        comparison->channel_count = kept;
    else if (a->channels)
        return sr_fail(error, SR_ERROR_INPUT, "%s: has none of the channels %s that could be compared", a->b,
                       a->channels);
    return SR_OK;
}

/* Numbers of different units have no difference. */
static sr_status check_units(const struct arguments *a, const struct sr_image *x, const struct sr_image *y,
                             const struct sr_image_comparison *comparison, struct sr_error *error)
{
    for (uint32_t i = 0; i < comparison->channel_count; ++i) {
        const char *name = comparison->channels[i].name;
        const char *in_a = x->channels[sr_image_find_channel(x, name)].unit,
                   *in_b = y->channels[sr_image_find_channel(y, name)].unit;
        if (in_a[0] && in_b[0] && strcmp(in_a, in_b) != 0)
            return sr_fail(error, SR_ERROR_INPUT, "%s has %s in %s and %s has it in %s: the same unit was expected",
                           a->a, name, in_a, a->b, in_b);
    }
    return SR_OK;
}

/* ---- limits ---- */

static const char *unit_of(const struct sr_image_difference *d)
{
    return d->unit[0] ? d->unit : "no unit";
}

static bool exceeds(const struct sr_image_difference *d, const char *what, double value, const char *unit, double limit)
{
    if (!(value > limit)) // no limit: NaN
        return false;
    fprintf(stderr, "steradian compare: %s: %s = %.6g %s is above the limit of %.6g %s\n", d->name, what, value, unit,
            limit, unit);
    return true;
}

/* How many limits are exceeded; they are told. */
static unsigned check_limits(const struct arguments *a, const struct sr_image_comparison *comparison)
{
    unsigned exceeded = 0;
    bool has_limit = !isnan(a->max_rmse) || !isnan(a->max_rel_mse) || !isnan(a->max_z);
    for (uint32_t i = 0; i < comparison->channel_count; ++i) {
        const struct sr_image_difference *d = &comparison->channels[i];
        exceeded += exceeds(d, "RMSE", d->rmse, unit_of(d), a->max_rmse);
        exceeded += exceeds(d, "relMSE", d->rel_mse, "[1]", a->max_rel_mse);
        exceeded += exceeds(d, "|z| of the mean", fabs(d->mean_z), "[1]", a->max_z);
        if (has_limit && d->skipped_count) {
            fprintf(stderr, "steradian compare: %s: %llu pixels are not finite\n", d->name,
                    (unsigned long long)d->skipped_count);
            ++exceeded;
        }
    }
    return exceeded;
}

/* ---- telling ---- */

static void print_table(const struct arguments *a, const struct sr_image *image,
                        const struct sr_image_comparison *comparison)
{
    printf("A %s, reference B %s: %u x %u pixels\n\n", a->a, a->b, image->width, image->height);
    printf("%-12s %-9s %12s %12s %9s %12s %11s %12s  at pixel\n", "channel", "unit", "mean A", "mean B", "A/B [1]",
           "RMSE", "relMSE [1]", "max |A-B|");
    bool has_z = false;
    for (uint32_t i = 0; i < comparison->channel_count; ++i) {
        const struct sr_image_difference *d = &comparison->channels[i];
        printf("%-12s %-9s %12.6g %12.6g %9.6f %12.6g %11.4g %12.6g  ", d->name, unit_of(d), d->mean_a, d->mean_b,
               d->mean_ratio, d->rmse, d->rel_mse, d->max_difference);
        if (d->count)
            printf("%u,%u", d->max_x, d->max_y);
        else
            printf("none");
        if (d->skipped_count)
            printf("; %llu pixels not finite, left out", (unsigned long long)d->skipped_count);
        putchar('\n');
        has_z |= d->has_z;
    }
    if (!has_z) {
        printf("\nNeither has standard errors: whether this is noise cannot be told.\n");
        return;
    }
    printf("\n%-12s %10s %10s %10s %10s %10s %10s %12s\n", "all [1]", "z of mean", "p", "|z| > 2", "|z| > 3", "|z| > 4",
           "max |z|", "chi2/pixel");
    for (uint32_t i = 0; i < comparison->channel_count; ++i) {
        const struct sr_image_difference *d = &comparison->channels[i];
        if (d->has_z)
            printf("%-12s %10.3f %10.3g %10.5f %10.5f %10.5f %10.2f %12.4f\n", d->name, d->mean_z,
                   sr_normal_p_two_sided(d->mean_z), d->share_above_2, d->share_above_3, d->share_above_4, d->max_z,
                   d->chi2_per_pixel);
    }
    printf("%-12s %10s %10s %10s %10s %10s %10s %12s\n", "pure noise", "0 ± 1", "", "0.04550", "0.00270", "0.00006", "",
           "1");
}

static json_t *channel_json(const struct sr_image_difference *d)
{
    const char *unit = d->unit[0] ? d->unit : NULL; // null: nobody said
    json_t *j = json_pack(
        "{s:o, s:o, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:{s:i, s:i, s:s}}", "name",
        command_json_text(d->name), "unit", command_json_text(unit), "pixels", (json_int_t)d->count,
        "pixels_not_finite", (json_int_t)d->skipped_count, "mean_a", command_json_quantity(d->mean_a, unit), "mean_b",
        command_json_quantity(d->mean_b, unit), "mean_ratio", command_json_quantity(d->mean_ratio, "1"), "bias",
        command_json_quantity(d->bias, unit), "rmse", command_json_quantity(d->rmse, unit), "rel_mse",
        command_json_quantity(d->rel_mse, "1"), "max_difference", command_json_quantity(d->max_difference, unit),
        "max_at", "x", (int)d->max_x, "y", (int)d->max_y, "unit", "pixel");
    if (j && d->count == 0)
        json_object_set_new(j, "max_at", json_null());
    if (j && d->has_z)
        json_object_set_new(j, "noise",
                            json_pack("{s:s, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "unit", "1", "pixels",
                                      (json_int_t)d->z_count, "z_of_mean", command_json_number(d->mean_z), "p",
                                      command_json_number(sr_normal_p_two_sided(d->mean_z)), "share_above_2",
                                      command_json_number(d->share_above_2), "share_above_3",
                                      command_json_number(d->share_above_3), "share_above_4",
                                      command_json_number(d->share_above_4), "max_z", command_json_number(d->max_z),
                                      "chi2_per_pixel", command_json_number(d->chi2_per_pixel)));
    return j;
}

static int print_comparison_json(const struct arguments *a, const struct sr_image *image,
                                 const struct sr_image_comparison *comparison, double used_scale, unsigned exceeded)
{
    json_t *channels = json_array();
    for (uint32_t i = 0; i < comparison->channel_count; ++i)
        json_array_append_new(channels, channel_json(&comparison->channels[i]));
    json_t *j = json_pack("{s:o, s:o, s:{s:i, s:i, s:s}, s:o, s:{s:o, s:o, s:o}, s:i, s:b}", "a",
                          command_json_text(a->a), "b", command_json_text(a->b), "size", "width", (int)image->width,
                          "height", (int)image->height, "unit", "pixel", "channels", channels, "limits", "rmse",
                          command_json_number(a->max_rmse), "rel_mse", command_json_number(a->max_rel_mse), "z_of_mean",
                          command_json_number(a->max_z), "limits_exceeded", (int)exceeded, "passed", exceeded == 0);
    if (j && a->output)
        json_object_set_new(
            j, "difference_picture",
            json_pack("{s:o, s:o}", "file", command_json_text(a->output), "full_colour",
                      command_json_quantity(used_scale,
                                            comparison->channels[0].unit[0] ? comparison->channels[0].unit : NULL)));
    return command_print_json("compare", j);
}

/* ---- all together ---- */

static sr_status write_difference(const struct arguments *a, const struct sr_image *x, const struct sr_image *y,
                                  double *used_scale, struct sr_error *error)
{
    struct sr_image *picture;
    if (sr_image_difference_picture(x, y, a->scale, &picture, used_scale, error) == SR_OK)
        sr_image_write(a->output, picture, NULL, error);
    sr_image_free(picture);
    return error->status;
}

static int compare(const struct arguments *a, const struct sr_image *x, const struct sr_image *y)
{
    struct sr_error error = {0};
    struct sr_image_comparison comparison = {0};
    double used_scale = (double)NAN;
    if (x->width != y->width || x->height != y->height)
        sr_fail(&error, SR_ERROR_INPUT, "%s is %u x %u pixels and %s is %u x %u: the same size was expected", a->a,
                x->width, x->height, a->b, y->width, y->height);
    bool ok = !error.status && sr_image_compare(x, y, &comparison, &error) == SR_OK &&
              keep_chosen(a, x, &comparison, &error) == SR_OK && check_units(a, x, y, &comparison, &error) == SR_OK;
    bool has_z = false;
    for (uint32_t i = 0; ok && i < comparison.channel_count; ++i)
        has_z |= comparison.channels[i].has_z;
    if (ok && !isnan(a->max_z) && !has_z)
        sr_fail(&error, SR_ERROR_INPUT, "--max-z needs standard errors (channels SE.R, …), neither %s nor %s has them",
                a->a, a->b);
    if (!error.status && a->output)
        write_difference(a, x, y, &used_scale, &error);
    if (error.status) {
        sr_image_comparison_free(&comparison);
        return command_fail("compare", &error);
    }
    if (!a->quiet && !a->json)
        print_table(a, x, &comparison);
    if (!a->quiet && !a->json && a->output)
        printf("\n%s: red A is more, blue B is more, the full colour stands for %.4g %s\n", a->output, used_scale,
               unit_of(&comparison.channels[0]));
    fflush(stdout);
    unsigned exceeded = check_limits(a, &comparison);
    int code = a->json ? print_comparison_json(a, x, &comparison, used_scale, exceeded) : 0;
    sr_image_comparison_free(&comparison);
    return code ? code : exceeded ? SR_ERROR_CHECK : 0;
}

static int run(int argc, char **argv)
{
    struct arguments a;
    int code = parse(argc, argv, &a);
    if (code)
        return code;
    struct sr_error error = {0};
    struct sr_image *x = NULL, *y = NULL;
    if (sr_image_read(a.a, &x, &error) == SR_OK)
        sr_image_read(a.b, &y, &error);
    code = error.status ? command_fail("compare", &error) : compare(&a, x, y);
    sr_image_free(x);
    sr_image_free(y);
    return code;
}

const struct command command_compare = {
    "compare", "how far two pictures are apart, and whether by more than their noise", help, run};
