/* SPDX-License-Identifier: MIT */
/* What the files of brdf plot share: what is asked for, and panels that are being put together. */
#ifndef SR_TOOLS_BRDF_PLOT_H
#define SR_TOOLS_BRDF_PLOT_H

#include "brdf.h"

#include "plot/plot.h"

enum { PLOT_SPECIMENS = 8, PLOT_PANELS = 32 };

struct plot_request {
    struct sr_specimen specimens[PLOT_SPECIMENS];
    const char *names[PLOT_SPECIMENS]; // as legends show them
    uint32_t specimen_count;
    double theta_deg, phi_deg; // toward the light
    double theta_d_deg;        // of plots over the half angle
    struct brdf_lambda lambda;
    bool is_colour;  // as the eye sees it, in place of single wavelengths
    bool is_log;     // f on a logarithmic axis, and radii of bodies
    bool has_cosine; // f cos theta_o in place of f
    enum sr_ball_light light;
    double zoom;
    double view_deg[2]; // from where bodies are seen: azimuth against the light's, elevation; nought: side on
    uint32_t samples;   // of balls, per pixel
};

/* A figure that is being put together; everything lies in the arena. */
struct plot_builder {
    const struct plot_request *request;
    struct sr_arena *arena;
    struct sr_error *error;
    struct sr_plot_panel panels[PLOT_PANELS];
    uint32_t panel_count;
};
struct sr_plot_panel *plot_add_panel(struct plot_builder *b);
double *plot_numbers(struct plot_builder *b, size_t count); // NULL and an error where there is no memory

/* What is plotted: of each specimen, for each of the columns (wavelengths; one column where colour is asked for). */
uint32_t plot_columns(const struct plot_request *r);
/* Values [1/sr] (f, or f cos theta_o) of pairs: column after column, count each. xyz may be NULL. */
sr_status plot_values(struct plot_builder *b, uint32_t specimen, const sr_vec3 *wo, const sr_vec3 *wi, size_t count,
                      double *values, double (*xyz)[3]);
const char *plot_quantity(const struct plot_request *r); // "f", "f cos θ_{o}"
sr_vec3 plot_light(const struct plot_request *r);
/* A direction in the plane of incidence, theta [°] from the normal, positive on the mirror's side. */
sr_vec3 plot_in_plane(const struct plot_request *r, double theta_deg);
/* Whether f is a random estimate: fewer points, more seeds. */
bool plot_is_random(const struct plot_request *r, uint32_t specimen);
bool plot_transmits(const struct plot_request *r, uint32_t specimen);

/* brdf_plot_curves.c */
sr_status plot_lobe(struct plot_builder *b, bool is_log);
sr_status plot_theta(struct plot_builder *b);
sr_status plot_half(struct plot_builder *b);
sr_status plot_albedo(struct plot_builder *b);
sr_status plot_sampling(struct plot_builder *b);
/* brdf_plot_fields.c */
sr_status plot_body(struct plot_builder *b, uint32_t specimen);
sr_status plot_slice(struct plot_builder *b, uint32_t specimen);
sr_status plot_ball(struct plot_builder *b, uint32_t specimen);
/* brdf_plot_classic.c: the field's classic figure into a folder; the exit code */
int plot_classic(const char *folder, bool is_quiet);

#endif
