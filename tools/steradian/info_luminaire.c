/* SPDX-License-Identifier: MIT */
/* steradian info of a luminaire: what its file makes of it, as numbers and as a polar diagram. */
#include "info.h"

#include "measured/measured.h"
#include "plot/plot.h"

#include <math.h>
#include <stdio.h>

static const char *format_name(const struct sr_photometry *p, char text[32])
{
    snprintf(text, 32, p->format == SR_PHOTOMETRY_LDT ? "EULUMDAT" : "IES LM-63-%d", p->year);
    return text;
}

static const char *symmetry_name(const struct sr_photometry *p)
{
    static const char *const names[] = {"none", "about the vertical axis", "to the plane C0-C180",
                                        "to the plane C90-C270", "to both planes"};
    return names[p->symmetry];
}

static void print_text(const char *path, const struct sr_photometry *p, const struct sr_photometry_report *r)
{
    char format[32];
    printf("%s: a luminaire, %s\n", path, format_name(p, format));
    printf("  flux                   %.6g lm, %.4g %% of it downward\n", r->flux, 100 * r->flux_down / r->flux);
    if (isnan(p->lamp_flux))
        printf("  lamps                  %u, absolute photometry\n", p->lamp_count);
    else
        printf("  lamps                  %u with %.6g lm together; light output ratio %.4g %%\n", p->lamp_count,
               (double)p->lamp_flux, 100 * r->light_output_ratio);
    if (p->power_W > 0)
        printf("  power                  %.6g W, %.4g lm/W\n", (double)p->power_W, r->efficacy);
    printf("  peak                   %.6g cd at C %g°, gamma %g°\n", r->peak, r->peak_c, r->peak_gamma);
    printf("  beam angle (50 %%)      %.1f° in C0-C180, %.1f° in C90-C270\n", r->beam[0], r->beam[1]);
    printf("  field angle (10 %%)     %.1f° in C0-C180, %.1f° in C90-C270\n", r->field[0], r->field[1]);
    printf("  luminous opening       %g m along C0-C180, %g m along C90-C270, %g m high%s\n", (double)p->along_c0,
           (double)p->along_c90, (double)p->height, p->is_round ? ", round" : "");
    printf("  angles                 %u C-planes from %g° to %g°, %u gamma from %g° to %g°; symmetry %s\n", p->c_count,
           (double)p->c[0], (double)p->c[p->c_count - 1], p->gamma_count, (double)p->gamma[0],
           (double)p->gamma[p->gamma_count - 1], symmetry_name(p));
    for (uint32_t i = 0; i < p->word_count; ++i)
        printf("  %-22s %s\n", p->words[i].key, p->words[i].text);
    if (p->note[0])
        printf("  note                   %s\n", p->note);
}

static int print_json(const char *path, const struct sr_photometry *p, const struct sr_photometry_report *r)
{
    char format[32];
    json_t *words = json_array();
    for (uint32_t i = 0; i < p->word_count; ++i)
        json_array_append_new(words, json_pack("{s:o, s:o}", "key", command_json_text(p->words[i].key), "text",
                                               command_json_text(p->words[i].text)));
    json_t *angles = json_pack("{s:i, s:i, s:s}", "C_planes", (int)p->c_count, "gamma", (int)p->gamma_count, "symmetry",
                               symmetry_name(p));
    json_t *peak =
        json_pack("{s:o, s:o, s:o}", "intensity", command_json_quantity(r->peak, "cd"), "C",
                  command_json_quantity(r->peak_c, "deg"), "gamma", command_json_quantity(r->peak_gamma, "deg"));
#define PAIR(a)                                                                                                        \
    json_pack("{s:o, s:o}", "C0-C180", command_json_quantity((a)[0], "deg"), "C90-C270",                               \
              command_json_quantity((a)[1], "deg"))
    json_t *opening = json_pack("{s:o, s:o, s:o, s:b}", "along_C0", command_json_quantity((double)p->along_c0, "m"),
                                "along_C90", command_json_quantity((double)p->along_c90, "m"), "height",
                                command_json_quantity((double)p->height, "m"), "round", (int)p->is_round);
    return command_print_json(
        "info",
        json_pack("{s:o, s:s, s:s, s:o, s:o, s:o, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "file",
                  command_json_text(path), "kind", "luminaire", "format", format_name(p, format), "flux",
                  command_json_quantity(r->flux, "lm"), "flux_downward", command_json_quantity(r->flux_down, "lm"),
                  "lamp_flux", command_json_quantity((double)p->lamp_flux, "lm"), "lamps", (int)p->lamp_count,
                  "light_output_ratio", command_json_quantity(r->light_output_ratio, "1"), "power",
                  command_json_quantity(p->power_W > 0 ? (double)p->power_W : (double)NAN, "W"), "efficacy",
                  command_json_quantity(r->efficacy, "lm/W"), "peak", peak, "beam_angle", PAIR(r->beam), "field_angle",
                  PAIR(r->field), "opening", opening, "angles", angles, "words", words, "note",
                  command_json_text(p->note)));
#undef PAIR
}

/* The planes C0-C180 and C90-C270, nadir at the bottom. */
static sr_status plot(const char *path, const struct sr_photometry *p, const char *title, struct sr_error *error)
{
    enum { POINTS = 721 };
    double x[POINTS], y[2][POINTS];
    for (int i = 0; i < POINTS; ++i) {
        x[i] = -180 + 0.5 * i;
        for (int k = 0; k < 2; ++k)
            y[k][i] = sr_photometry_intensity(p, 90 * k + (x[i] < 0 ? 180 : 0), fabs(x[i]));
    }
    bool is_axial = p->symmetry == SR_PHOTOMETRY_AXIAL;
    struct sr_plot_curve curves[] = {
        {.label = is_axial ? "all C-planes" : "C0 right, C180 left", .x = x, .y = y[0], .count = POINTS},
        {.label = "C90 right, C270 left", .x = x, .y = y[1], .count = POINTS, .dash = SR_PLOT_DASHED}};
    struct sr_plot_panel panel = {.kind = SR_PLOT_POLAR,
                                  .x = {.label = "γ", .unit = "°"},
                                  .y = {.label = "I", .unit = "cd"},
                                  .curves = curves,
                                  .curve_count = is_axial ? 1 : 2,
                                  .points_down = true};
    struct sr_plot_figure figure = {
        .title = title, .width = 520, .height = 580, .panels = &panel, .panel_count = 1, .scale = 2};
    return sr_plot_write(&figure, path, error);
}

int info_luminaire(const struct info_arguments *a)
{
    struct sr_error error = {0};
    struct sr_arena arena = {0};
    const struct sr_photometry *p;
    int code = 0;
    if (sr_photometry_read(a->path, &arena, &p, &error) == SR_OK) {
        struct sr_photometry_report report;
        sr_photometry_report(p, &report);
        const char *name = sr_photometry_word(p, "LUMINAIRE");
        struct sr_photometry written = *p;
        written.year = p->format == SR_PHOTOMETRY_LDT || p->year < 2002 ? 2002 : p->year;
        if (a->outfile)
            sr_photometry_write(a->outfile, &written, &error);
        if (error.status || (a->plot && plot(a->plot, p, name ? name : a->path, &error) != SR_OK))
            code = command_fail("info", &error);
        else if (a->json)
            code = print_json(a->path, p, &report);
        else
            print_text(a->path, p, &report);
    } else
        code = command_fail("info", &error);
    sr_arena_free(&arena);
    return code;
}
