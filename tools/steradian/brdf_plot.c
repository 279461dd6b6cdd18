/* SPDX-License-Identifier: MIT */
/* steradian brdf plot: pictures of specimens. Arguments here; panels in brdf_plot_curves.c and brdf_plot_fields.c. */
#include "brdf_plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char help[] =
    "Usage: steradian brdf plot SPECIMEN … [--vs SPECIMEN …]… -o FILE.svg|.png [OPTIONS]\n"
    "       steradian brdf plot --classic FOLDER\n"
    "\n"
    "Draws a specimen, or several in the same panels. Light comes from theta_i, phi_i and the viewer moves: theta_o "
    "is\n"
    "positive on the side of the mirror's direction. δ with a number is a delta lobe, and its share of the light.\n"
    "\n"
    "  -o, --output FILE      where to; the ending says how\n"
    "      --vs               the words that follow are another specimen\n"
    "  -k, --kind KIND[,KIND] what to draw (body,lobe,lobe-log,albedo):\n"
    "                           body      the lobe in space\n"
    "                           lobe      f in the plane of incidence, polar;  lobe-log: its logarithm\n"
    "                           theta     f against theta_o                    half: against the half angle\n"
    "                           albedo    what is reflected and transmitted of light from theta_i\n"
    "                           slice     f over theta_h and theta_d, as an image\n"
    "                           sampling  the sampler's density over f cos theta\n"
    "                           ball      a lit ball\n"
    "                           all       each of these\n"
    "      --wi THETA[,PHI]   toward the light [deg] (45,180)\n"
    "      --theta-d DEG      difference angle of the kind half [deg] (30)\n"
    "      --lambda NM[,NM …] wavelengths [nm], up to " BRDF_MOST_LAMBDAS " (550)\n"
    "      --colour           as the eye sees it under D65: luminous f, colours of bodies and slices\n"
    "      --log              f on logarithmic axes; bodies with the logarithm for a radius\n"
    "      --cosine           f cos theta_o in place of f\n"
    "      --light sky|point  of balls (sky)\n"
    "      --samples N        of balls, for each pixel (64)\n"
    "      --name TEXT        what legends call the specimen before it (its words)\n"
    "      --title TEXT       above the figure (the specimen's words)\n"
    "      --size W,H         of the figure [px] (340 by 300 for each panel)\n"
    "      --columns N        of panels\n"
    "      --scale S          pixels of a PNG for each px [1] (1)\n"
    "      --view AZ,EL       from where bodies are seen: azimuth from the light's, elevation [deg] (78,24)\n"
    "      --zoom Z           of bodies [1] (1)\n"
    "      --classic FOLDER   the field's classic figure: lobes in space of six models, classic.svg and .png\n"
    "  -q, --quiet            no notes\n"
    "\n"
    "Examples:\n"
    "  steradian brdf plot diffuse reflectance=.5 -o lambert.svg\n"
    "  steradian brdf plot conductor eta=metal-Au-eta k=metal-Au-k alpha_x=.2 alpha_y=.2 --lambda 450,550,650 -o "
    "gold.svg\n"
    "  steradian brdf plot conductor alpha_x=.1 alpha_y=.1 --vs conductor alpha_x=.3 alpha_y=.3 -k theta,half --log -o "
    "alpha.svg\n"
    "  steradian brdf plot coated_diffuse -k ball,slice --colour -o coat.png --scale 2\n"
    "  steradian brdf plot --classic docs/figures\n";

static const struct option long_options[] = {
    {"output", required_argument, NULL, 'o'},
    {"vs", no_argument, NULL, 'v'},
    {"kind", required_argument, NULL, 'k'},
    {"wi", required_argument, NULL, 'i'},
    {"theta-d", required_argument, NULL, 'd'},
    {"lambda", required_argument, NULL, 'l'},
    {"colour", no_argument, NULL, 'c'},
    {"log", no_argument, NULL, 'g'},
    {"cosine", no_argument, NULL, 'C'},
    {"light", required_argument, NULL, 'L'},
    {"samples", required_argument, NULL, 's'},
    {"name", required_argument, NULL, 'n'},
    {"title", required_argument, NULL, 't'},
    {"size", required_argument, NULL, 'S'},
    {"columns", required_argument, NULL, 'K'},
    {"scale", required_argument, NULL, 'e'},
    {"zoom", required_argument, NULL, 'z'},
    {"view", required_argument, NULL, 'V'},
    {"classic", required_argument, NULL, 'x'},
    {"quiet", no_argument, NULL, 'q'},
    {NULL, 0, NULL, 0},
};

enum kind { BODY, LOBE, LOBE_LOG, THETA, HALF, ALBEDO, SLICE, SAMPLING, BALL, KINDS };
static const char *const kind_names[KINDS] = {"body",   "lobe",  "lobe-log", "theta", "half",
                                              "albedo", "slice", "sampling", "ball"};
enum { WORDS = 256 };

struct arguments {
    struct plot_request request;
    const char *words[PLOT_SPECIMENS][WORDS];
    int word_counts[PLOT_SPECIMENS];
    enum kind kinds[KINDS];
    uint32_t kind_count;
    const char *output, *title, *classic;
    double width, height, scale;
    uint64_t columns;
    bool quiet;
};

static bool parse_kinds(struct arguments *a, const char *text)
{
    a->kind_count = 0;
    for (const char *p = text; *p;) {
        size_t n = strcspn(p, ",");
        char word[32];
        snprintf(word, sizeof word, "%.*s", (int)n, p);
        p += n + (p[n] == ',');
        if (strcmp(word, "all") == 0) {
            for (a->kind_count = 0; a->kind_count < KINDS; ++a->kind_count)
                a->kinds[a->kind_count] = (enum kind)a->kind_count;
            continue;
        }
        int k = 0;
        while (k < KINDS && strcmp(kind_names[k], word) != 0)
            ++k;
        if (k == KINDS || a->kind_count == KINDS) {
            const char *nearest = command_nearest(word, kind_names, sizeof kind_names[0], KINDS);
            command_usage(&brdf_plot, "--kind %s: there is no kind \"%s\"%s%s%s", text, word,
                          nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
            return false;
        }
        a->kinds[a->kind_count++] = (enum kind)k;
    }
    if (a->kind_count == 0)
        command_usage(&brdf_plot, "--kind: a kind was expected");
    return a->kind_count > 0;
}

static bool parse_light_direction(struct plot_request *r, const char *text)
{
    double angles[2], unused[3];
    if (!brdf_parse_direction(&brdf_plot, "wi", text, angles, unused))
        return false;
    if (angles[0] >= 90) {
        command_usage(&brdf_plot, "--wi %s: light from above was expected, below 90 deg from the normal", text);
        return false;
    }
    r->theta_deg = angles[0];
    r->phi_deg = strchr(text, ',') ? angles[1] : 180;
    return true;
}

static bool parse_option(struct arguments *a, int option, char **argv)
{
    struct plot_request *r = &a->request;
    const struct command *c = &brdf_plot;
    uint32_t last = r->specimen_count - 1;
    uint64_t samples;
    double size[2];
    switch (option) {
    case 1: // a word of the specimen
        if (a->word_counts[last] == WORDS) {
            command_usage(c, "a specimen has at most %d words", WORDS);
            return false;
        }
        a->words[last][a->word_counts[last]++] = optarg;
        return true;
    case 'v':
        if (r->specimen_count == PLOT_SPECIMENS || !a->word_counts[last]) {
            command_usage(c,
                          a->word_counts[last] ? "--vs: at most %d specimens are drawn together"
                                               : "--vs: a specimen was expected before it",
                          PLOT_SPECIMENS);
            return false;
        }
        ++r->specimen_count;
        return true;
    case 'o':
        a->output = optarg;
        return true;
    case 'k':
        return parse_kinds(a, optarg);
    case 'i':
        return parse_light_direction(r, optarg);
    case 'd':
        return command_parse_float(c, "theta-d", optarg, 0, 89.9, &r->theta_d_deg);
    case 'l':
        return brdf_parse_lambda(c, optarg, &r->lambda);
    case 'c':
        return r->is_colour = true;
    case 'g':
        return r->is_log = true;
    case 'C':
        return r->has_cosine = true;
    case 'L':
        r->light = strcmp(optarg, "point") == 0 ? SR_BALL_POINT : SR_BALL_SKY;
        if (r->light == SR_BALL_SKY && strcmp(optarg, "sky") != 0) {
            command_usage(c, "--light %s: sky or point was expected", optarg);
            return false;
        }
        return true;
    case 's':
        if (!command_parse_uint(c, "samples", optarg, 1, 1 << 16, &samples))
            return false;
        r->samples = (uint32_t)samples;
        return true;
    case 'n':
        r->names[last] = optarg;
        return true;
    case 't':
        a->title = optarg;
        return true;
    case 'S':
        if (!command_parse_floats(c, "size", optarg, 2, size))
            return false;
        a->width = size[0];
        a->height = size[1];
        if (!(a->width >= 100 && a->height >= 100 && a->width <= 8192 && a->height <= 8192)) {
            command_usage(c, "--size %s: 100 to 8192 px each way were expected", optarg);
            return false;
        }
        return true;
    case 'K':
        return command_parse_uint(c, "columns", optarg, 1, PLOT_PANELS, &a->columns);
    case 'e':
        return command_parse_float(c, "scale", optarg, 0.25, 8, &a->scale);
    case 'z':
        return command_parse_float(c, "zoom", optarg, 0.1, 10, &r->zoom);
    case 'V':
        return command_parse_floats(c, "view", optarg, 2, r->view_deg);
    case 'x':
        a->classic = optarg;
        return true;
    case 'q':
        return a->quiet = true;
    default:
        command_bad_option(c, long_options, option, argv);
        return false;
    }
}

static sr_status add_panels(struct plot_builder *b, enum kind kind)
{
    static sr_status (*const for_each[KINDS])(struct plot_builder *, uint32_t) = {
        [BODY] = plot_body, [SLICE] = plot_slice, [BALL] = plot_ball};
    static sr_status (*const together[KINDS])(struct plot_builder *) = {
        [THETA] = plot_theta, [HALF] = plot_half, [ALBEDO] = plot_albedo, [SAMPLING] = plot_sampling};
    if (kind == LOBE || kind == LOBE_LOG)
        return plot_lobe(b, kind == LOBE_LOG);
    if (together[kind])
        return together[kind](b);
    for (uint32_t s = 0; s < b->request->specimen_count && !b->error->status; ++s)
        for_each[kind](b, s);
    return b->error->status;
}

/* What all panels are seen at. */
static const char *subtitle(const struct plot_request *r, struct sr_arena *arena)
{
    char nm[128] = "";
    size_t n = 0;
    for (int i = 0; i < r->lambda.count && n < sizeof nm - 16; ++i)
        n += (size_t)snprintf(nm + n, sizeof nm - n, "%s%g", i ? ", " : "λ = ", (double)r->lambda.lambda[i]);
    snprintf(nm + n, sizeof nm - n, " nm");
    if (r->is_colour)
        snprintf(nm, sizeof nm, "as the eye sees it under D65");
    return r->phi_deg == 180
               ? sr_arena_printf(arena, "%s; light from θ_{i} = %g°", nm, r->theta_deg)
               : sr_arena_printf(arena, "%s; light from θ_{i} = %g°, φ_{i} = %g°", nm, r->theta_deg, r->phi_deg);
}

/* One entry for each specimen, or for each wavelength of the only one; what the first panel of curves shows. */
static void add_legend(const struct plot_builder *b, struct sr_plot_figure *figure)
{
    for (uint32_t i = 0; i < b->panel_count && !figure->legend_count; ++i)
        if (b->panels[i].curve_count > 1 && b->panels[i].curves[1].label) {
            figure->legend = b->panels[i].curves;
            figure->legend_count = b->panels[i].curve_count;
        }
}

static int plot(struct arguments *a, struct sr_arena *arena)
{
    struct plot_request *r = &a->request;
    struct sr_error error = {0};
    struct plot_builder b = {.request = r, .arena = arena, .error = &error};
    for (uint32_t s = 0; s < r->specimen_count; ++s) {
        if (sr_specimen_read(arena, a->word_counts[s], a->words[s], &r->specimens[s], command_log(&a->quiet), &error) !=
            SR_OK)
            return command_fail("brdf plot", &error);
        if (!r->names[s])
            r->names[s] = r->specimens[s].title;
    }
    for (uint32_t i = 0; i < a->kind_count && !error.status; ++i)
        add_panels(&b, a->kinds[i]);
    if (!error.status && !b.panel_count)
        sr_fail(&error, SR_ERROR_INPUT, "nothing to draw: all light goes as from a mirror");
    uint32_t columns = a->columns           ? (uint32_t)a->columns
                       : b.panel_count < 4  ? b.panel_count
                       : b.panel_count == 4 ? 2
                                            : 3;
    if (columns > b.panel_count)
        columns = b.panel_count;
    uint32_t rows = columns ? (b.panel_count + columns - 1) / columns : 1;
    struct sr_plot_figure figure = {.title = a->title                 ? a->title
                                             : r->specimen_count == 1 ? r->names[0]
                                                                      : NULL,
                                    .subtitle = a->kind_count == 1 && a->kinds[0] == BALL ? NULL : subtitle(r, arena),
                                    .panels = b.panels,
                                    .panel_count = b.panel_count,
                                    .columns = columns,
                                    .scale = a->scale};
    add_legend(&b, &figure);
    figure.width = a->width > 0 ? a->width : fmax(400, 340 * columns + 20);
    figure.height = a->height > 0 ? a->height
                                  : 300 * rows + (figure.title ? 36 : 16) + (figure.subtitle ? 20 : 0) +
                                        (figure.legend_count ? 26 : 0);
    struct sr_plot_check check = {0};
    if (!error.status)
        sr_plot_write_checked(&figure, a->output, &check, &error);
    if (error.status)
        return command_fail("brdf plot", &error);
    struct sr_log log = command_log(&a->quiet);
    if (check.outside || check.overlaps)
        sr_log(&log, SR_WARNING, "%s: %s; a larger --size, or a shorter --name, would help", a->output, check.offender);
    return 0;
}

static int run(int argc, char **argv)
{
    static struct arguments a;
    a = (struct arguments){.request = {.specimen_count = 1,
                                       .theta_deg = 45,
                                       .phi_deg = 180,
                                       .theta_d_deg = 30,
                                       .lambda = brdf_default_lambda(),
                                       .samples = 64,
                                       .view_deg = {78, 0}},
                           .kinds = {BODY, LOBE, LOBE_LOG, ALBEDO},
                           .kind_count = 4};
    int option, index = 0;
    while ((option = command_next_option(argc, argv, "-:o:k:q", long_options, &index)) != -1)
        if (!parse_option(&a, option, argv))
            return SR_ERROR_USAGE;
    for (int i = optind; i < argc; ++i) { // after "--"
        optarg = argv[i];
        if (!parse_option(&a, 1, argv))
            return SR_ERROR_USAGE;
    }
    if (a.classic)
        return plot_classic(a.classic, a.quiet);
    if (!a.word_counts[a.request.specimen_count - 1])
        return command_usage(&brdf_plot, "a model, a file of measured data, or SCENE.pbrt:MATERIAL was expected");
    if (!a.output)
        return command_usage(&brdf_plot, "-o FILE.svg or -o FILE.png was expected");
    if (!sr_path_has_ending(a.output, ".svg") && !sr_path_has_ending(a.output, ".png"))
        return command_usage(&brdf_plot, "-o %s: a name that ends with .svg or .png was expected", a.output);
    struct sr_arena arena = {0};
    int code = plot(&a, &arena);
    sr_arena_free(&arena);
    return code;
}

const struct command brdf_plot = {"brdf plot", "pictures: lobes, curves, slices, balls", help, run};
