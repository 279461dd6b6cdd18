/* SPDX-License-Identifier: MIT */
/* The field's classic figure: six scattering models as bodies in space, with the light's and the mirror's direction.
 *
 * As viewers of BRDFs have shown them since the nineties: Lambert's hemisphere, the sum of a matte and a glossy part,
 * microfacets, a brushed metal from near, the Moon and a layer of dust, which throw light back to where it comes from.
 */
#include "brdf_plot.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const struct {
    const char *title, *words[8];
    double at[4]; // [°] theta of the light; the eye's azimuth from the light's, and elevation; [1] zoom
} lobes[] = {
    {"Lambert", {"diffuse", "reflectance=.5"}, {45, 78, 24, 1}},
    {"Blinn–Phong + Lambert", {"blinn_phong", "reflectance=.5", "specular=.12", "exponent=60"}, {45, 78, 24, 1}},
    {"Cook–Torrance", {"cook_torrance", "reflectance=.15", "alpha=.25"}, {40, 78, 24, 1}},
    {"Ward, anisotropic, from near",
     {"ward", "reflectance=.1", "specular=.3", "alpha_x=.12", "alpha_y=.4"},
     {40, 55, 30, 1.6}},
    {"Hapke / Lommel–Seeliger: the Moon", {"lunar"}, {50, 78, 24, 1}},
    {"Lommel–Seeliger: dust", {"dust", "g=-.25", "thickness=1"}, {50, 78, 24, 1}},
};
enum { LOBES = sizeof lobes / sizeof lobes[0], SIDE_X = 360, SIDE_Y = 310 };

static sr_status draw(uint32_t k, struct plot_request *r, struct plot_builder *b)
{
    int count = 0;
    while (count < 8 && lobes[k].words[count])
        ++count;
    *r = (struct plot_request){.specimen_count = 1,
                               .theta_deg = lobes[k].at[0],
                               .phi_deg = 180,
                               .lambda = brdf_default_lambda(),
                               .zoom = lobes[k].at[3],
                               .view_deg = {lobes[k].at[1], lobes[k].at[2]}};
    static bool quiet = true;
    b->request = r;
    if (sr_specimen_read(b->arena, count, lobes[k].words, &r->specimens[0], command_log(&quiet), b->error) != SR_OK ||
        plot_body(b, 0) != SR_OK)
        return b->error->status;
    b->panels[b->panel_count - 1].title = lobes[k].title;
    b->panels[b->panel_count - 1].x.label = sr_arena_printf(b->arena, "%s", r->specimens[0].title);
    return SR_OK;
}

static sr_status write(const char *folder, const char *ending, const struct sr_plot_figure *figure,
                       struct sr_arena *arena, struct sr_error *error)
{
    const char *path = sr_arena_printf(arena, "%s/classic.%s", folder, ending);
    return path ? sr_plot_write(figure, path, error)
                : sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for a name");
}

int plot_classic(const char *folder, bool is_quiet)
{
    static struct plot_request requests[LOBES];
    struct sr_arena arena = {0};
    struct sr_error error = {0};
    struct plot_builder b = {.arena = &arena, .error = &error};
    mkdir(folder, 0777); // where it cannot be made, writing tells
    for (uint32_t k = 0; k < LOBES && !error.status; ++k)
        draw(k, &requests[k], &b);
    struct sr_plot_figure all = {.title = "Six ways to scatter light",
                                 .subtitle = "f in proportion; λ = 550 nm",
                                 .width = 3 * SIDE_X,
                                 .height = 2 * SIDE_Y + 60,
                                 .columns = 3,
                                 .panels = b.panels,
                                 .panel_count = b.panel_count};
    if (!error.status && write(folder, "svg", &all, &arena, &error) == SR_OK)
        write(folder, "png", &all, &arena, &error);
    sr_arena_free(&arena);
    if (error.status)
        return command_fail("brdf plot", &error);
    if (!is_quiet)
        fprintf(stderr, "%s/classic.svg and classic.png are drawn\n", folder);
    return 0;
}
