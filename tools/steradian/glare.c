/* SPDX-License-Identifier: MIT */
/* steradian glare: how much a picture of the whole field of view would dazzle. */
#include "command.h"

#include "glare/glare.h"
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: steradian glare IN [OPTIONS]\n"
    "\n"
    "Finds the sources of glare in a picture with luminances [cd/m^2] of half a sphere, and tells UGR, DGP, DGI, CGI and\n"
    "VCP, the vertical illuminance at the eye, and each source. Where the picture has standard errors, so have the indices.\n"
    "\n"
    "      --projection NAME  equidistant (Radiance's -vta), equisolid, orthographic or hemispherical (-vth), stereographic\n"
    "                         (-vts), equalarea or equirectangular (Camera \"spherical\"); pictures of steradian render\n"
    "                         know it themselves\n"
    "      --angle DEG        across the disk of a fisheye [deg] (default: 180)\n"
    "      --threshold CD     pixels brighter than that are glare [cd/m^2]\n"
    "      --factor F         instead: brighter than F times the mean of the task or of the field (default: 5)\n"
    "      --task X,Y,DEG     the task: around this pixel, half its angle [pixel, deg]\n"
    "      --peak CD          still brighter pixels are a source of their own [cd/m^2] (default: 50000)\n"
    "  -o, --outfile FILE     a picture in which the sources are coloured, .png\n"
    "      --json             all numbers as JSON on standard output\n"
    "\n"
    "Examples:\n"
    "  steradian render office.pbrt -o office.exr      (Camera \"fisheye\" \"string mapping\" \"equidistant\")\n"
    "  steradian glare office.exr -o sources.png\n"
    "  steradian glare photo.hdr --projection equidistant --angle 180 --threshold 2000 --json\n";

struct arguments {
    const char *input, *output;
    bool has_projection, json;
    struct sr_glare_options options;
};

enum { OPT_PROJECTION = 256, OPT_ANGLE, OPT_THRESHOLD, OPT_FACTOR, OPT_TASK, OPT_PEAK, OPT_JSON };

static const struct option long_options[] = {
    {"projection", required_argument, NULL, OPT_PROJECTION},
    {"angle", required_argument, NULL, OPT_ANGLE},
    {"threshold", required_argument, NULL, OPT_THRESHOLD},
    {"factor", required_argument, NULL, OPT_FACTOR},
    {"task", required_argument, NULL, OPT_TASK},
    {"peak", required_argument, NULL, OPT_PEAK},
    {"outfile", required_argument, NULL, 'o'},
    {"json", no_argument, NULL, OPT_JSON},
    {NULL, 0, NULL, 0},
};

static const char *const projections[] = {"equidistant",   "equisolid", "orthographic",
                                          "stereographic", "equalarea", "equirectangular"};

static bool find_projection(const char *name, size_t length, enum sr_glare_projection *out)
{
    if (length == strlen("hemispherical") && strncmp(name, "hemispherical", length) == 0) {
        *out = SR_GLARE_ORTHOGRAPHIC;
        return true;
    }
    for (int i = 0; i < 6; ++i)
        if (strlen(projections[i]) == length && strncmp(projections[i], name, length) == 0) {
            *out = (enum sr_glare_projection)i;
            return true;
        }
    return false;
}

static int parse(int argc, char **argv, struct arguments *a)
{
    const struct command *c = &command_glare;
    struct sr_glare_options *o = &a->options;
    int option, index = 0;
    bool ok = true;
    while (ok && (option = command_next_option(argc, argv, ":o:", long_options, &index)) != -1)
        switch (option) {
        case OPT_PROJECTION:
            a->has_projection = true;
            if (!find_projection(optarg, strlen(optarg), &o->projection))
                return command_usage(
                    c,
                    "--projection %s: equidistant, equisolid, orthographic, hemispherical, stereographic, equalarea or equirectangular was expected",
                    optarg);
            break;
        case OPT_ANGLE:
            ok = command_parse_float(c, "angle", optarg, 1, 180, &o->angle_deg);
            break;
        case OPT_THRESHOLD:
            ok = command_parse_float(c, "threshold", optarg, 1e-9, 1e12, &o->threshold);
            break;
        case OPT_FACTOR:
            ok = command_parse_float(c, "factor", optarg, 1e-9, 1e9, &o->factor);
            break;
        case OPT_TASK:
            ok = command_parse_floats(c, "task", optarg, 3, o->task);
            if (ok && !(o->task[2] > 0 && o->task[2] <= 90))
                return command_usage(c, "--task %s: X,Y,DEG was expected, half an angle up to 90 deg", optarg);
            break;
        case OPT_PEAK:
            ok = command_parse_float(c, "peak", optarg, 1e-9, 1e30, &o->peak);
            break;
        case OPT_JSON:
            a->json = true;
            break;
        case 'o':
            a->output = optarg;
            break;
        default:
            return command_bad_option(c, long_options, option, argv);
        }
    if (!ok)
        return SR_ERROR_USAGE;
    if (optind + 1 != argc)
        return command_usage(c, optind == argc ? "a picture was expected" : "one picture was expected, there are %d",
                             argc - optind);
    if (o->threshold > 0 && o->factor > 0)
        return command_usage(c, "--threshold or --factor was expected, not both");
    if (a->output && !sr_path_has_ending(a->output, ".png"))
        return command_usage(c, "%s: the ending .png was expected", a->output);
    a->input = argv[optind];
    return 0;
}

/* What steradian render wrote of its camera: "fisheye; mapping equisolid; fov 180". */
static sr_status recognise(struct arguments *a, const struct sr_image *image, struct sr_error *error)
{
    const char *camera = sr_image_get_attribute(image, "steradian.camera");
    const char *mapping = camera ? strstr(camera, "; mapping ") : NULL, *fov = camera ? strstr(camera, "; fov ") : NULL;
    if (a->has_projection)
        return SR_OK;
    if (mapping)
        mapping += strlen("; mapping ");
    if (!mapping || !find_projection(mapping, strcspn(mapping, ";"), &a->options.projection))
        return sr_fail(error, SR_ERROR_INPUT, "%s: %s; --projection NAME was expected", a->input,
                       camera ? "its camera is no fisheye and not spherical"
                              : "nothing tells how it maps directions to pixels");
    if (fov && a->options.angle_deg == 0)
        a->options.angle_deg = strtod(fov + strlen("; fov "), NULL);
    return SR_OK;
}

/* ---- output ---- */

static void print_text(const struct arguments *a, const struct sr_glare *g)
{
    printf("%s: %s", a->input, projections[a->options.projection]);
    if (a->options.projection <= SR_GLARE_STEREOGRAPHIC)
        printf(", %g deg across", a->options.angle_deg > 0 ? a->options.angle_deg : 180);
    printf(", %.6f sr\n", g->omega);
    printf("  vertical illuminance E_v    %.6g lx", g->E_v);
    if (g->has_errors)
        printf(" ± %.2g lx", 1.96 * g->E_v_error);
    printf(" (direct %.6g, indirect %.6g)\n", g->E_direct, g->E_indirect);
    printf("  mean luminance              %.6g cd/m^2\n", g->L_mean);
    if (!isnan(g->L_task))
        printf("  mean luminance of the task  %.6g cd/m^2\n", g->L_task);
    printf("  background luminance E_i/pi %.6g cd/m^2\n", g->L_background);
    printf("  threshold                   %.6g cd/m^2\n\n", g->threshold);
    for (int i = 0; i < SR_GLARE_INDICES; ++i) {
        printf("  %-15s", sr_glare_index_names[i]);
        bool is_small = i == SR_GLARE_DGP || i == SR_GLARE_DGP_LOW_LIGHT;
        if (isnan(g->index[i]))
            printf(" none, there is no source of glare\n");
        else if (isnan(g->error[i]))
            printf(is_small ? " %.4f\n" : " %.2f\n", g->index[i]);
        else
            printf(is_small ? " %.4f ± %.2g\n" : " %.2f ± %.2g\n", g->index[i], 1.96 * g->error[i]);
    }
    if (g->has_errors)
        printf("  (95 %%, by the standard errors of the pixels)\n");
    if (g->source_count)
        printf("\n  %6s %8s %8s %12s %11s %9s %9s %9s %8s\n", "source", "x", "y", "L [cd/m^2]", "omega [sr]", "E [lx]",
               "sigma [°]", "tau [°]", "P");
    for (uint32_t k = 0; k < g->source_count && k < 20; ++k) {
        const struct sr_glare_source *s = &g->sources[k];
        printf("  %6u %8.1f %8.1f %12.5g %11.5g %9.4g %8.1f %8.1f %8.3f\n", k + 1, s->x, s->y, s->L, s->omega, s->E,
               s->sigma_deg, s->tau_deg, s->position);
    }
    if (g->source_count > 20)
        printf("  … and %u more\n", g->source_count - 20);
}

static int print_json(const struct arguments *a, const struct sr_glare *g)
{
    json_t *indices = json_object(), *sources = json_array();
    for (int i = 0; i < SR_GLARE_INDICES; ++i)
        json_object_set_new(indices, sr_glare_index_names[i],
                            json_pack("{s:o, s:o, s:s}", "value", command_json_number(g->index[i]), "standard_error",
                                      command_json_number(g->error[i]), "unit", i == SR_GLARE_VCP ? "%" : "1"));
    for (uint32_t k = 0; k < g->source_count; ++k) {
        const struct sr_glare_source *s = &g->sources[k];
        json_array_append_new(
            sources,
            json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i}", "x", command_json_quantity(s->x, "pixel"), "y",
                      command_json_quantity(s->y, "pixel"), "L", command_json_quantity(s->L, "cd/m^2"), "omega",
                      command_json_quantity(s->omega, "sr"), "E", command_json_quantity(s->E, "lx"), "sigma",
                      command_json_quantity(s->sigma_deg, "deg"), "tau", command_json_quantity(s->tau_deg, "deg"),
                      "position_index", command_json_quantity(s->position, "1"), "pixels", (int)s->pixels));
    }
    return command_print_json(
        "glare",
        json_pack("{s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "file",
                  command_json_text(a->input), "projection", projections[a->options.projection], "solid_angle",
                  command_json_quantity(g->omega, "sr"), "E_v", command_json_quantity(g->E_v, "lx"),
                  "E_v_standard_error", command_json_quantity(g->has_errors ? g->E_v_error : (double)NAN, "lx"),
                  "E_direct", command_json_quantity(g->E_direct, "lx"), "E_indirect",
                  command_json_quantity(g->E_indirect, "lx"), "L_mean", command_json_quantity(g->L_mean, "cd/m^2"),
                  "L_task", command_json_quantity(g->L_task, "cd/m^2"), "L_background",
                  command_json_quantity(g->L_background, "cd/m^2"), "threshold",
                  command_json_quantity(g->threshold, "cd/m^2"), "indices", indices, "sources", sources));
}

/* Grey as the eye sees it, sources in colours. */
static sr_status write_picture(const struct arguments *a, const struct sr_image *image, const struct sr_glare *g,
                               struct sr_error *error)
{
    struct sr_image *mapped;
    struct sr_tone tone = {.op = SR_TONE_REINHARD, .is_auto = true};
    if (sr_image_tone_map(image, &tone, &mapped, error) != SR_OK)
        return error->status;
    for (size_t i = 0; i < (size_t)image->width * image->height; ++i) {
        uint8_t *p = mapped->bytes + i * mapped->channel_count;
        double grey = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
        struct sr_plot_colour c = sr_plot_palette((int)((g->labels[i] - 1) % 6));
        const float rgb[3] = {c.r, c.g, c.b};
        for (int k = 0; k < 3; ++k)
            p[k] = (uint8_t)(g->labels[i] ? 255 * (double)rgb[k] : grey);
    }
    sr_image_write(a->output, mapped, NULL, error);
    sr_image_free(mapped);
    return error->status;
}

static int run(int argc, char **argv)
{
    struct arguments a = {0};
    int code = parse(argc, argv, &a);
    if (code)
        return code;
    struct sr_error error = {0};
    struct sr_arena arena = {0};
    struct sr_image *image = NULL;
    struct sr_glare g;
    if (sr_image_read(a.input, &image, &error) == SR_OK && recognise(&a, image, &error) == SR_OK &&
        sr_glare_measure(image, &a.options, &arena, &g, &error) == SR_OK) {
        int channel[3];
        double weight[3];
        if (sr_image_luminance_weights(image, channel, weight) &&
            strcmp(image->channels[channel[0]].unit, "cd/m^2") != 0)
            fprintf(stderr, "warning: %s does not say that its values are in cd/m^2; they are taken to be\n", a.input);
        if (g.source_count > 1000)
            fprintf(
                stderr,
                "warning: %u sources: a noisy picture makes sources of single pixels; more samples or --threshold help\n",
                g.source_count);
        if (a.output)
            write_picture(&a, image, &g, &error);
        if (!error.status && a.json)
            code = print_json(&a, &g);
        else if (!error.status)
            print_text(&a, &g);
    }
    code = error.status ? command_fail("glare", &error) : code;
    sr_image_free(image);
    sr_arena_free(&arena);
    return code;
}

const struct command command_glare = {"glare", "UGR, DGP and other indices of glare, from a picture of the whole field",
                                      help, run};
