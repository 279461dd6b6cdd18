/* SPDX-License-Identifier: MIT */
/* Glare from a picture of all that an eye sees: bright sources, the illuminance of the eye, and the indices made of
 * them.
 *
 *     E_v = INTEGRAL L cos theta dw [lx],   E_d of the sources, E_i = E_v - E_d,   L_b = E_i / pi [cd/m^2] (CIE 117)
 *     UGR = 8 log10(0.25 / L_b SUM L^2 w / P^2)                                      CIE 117:1995
 *     DGP = 5.87e-5 E_v + 0.0918 log10(1 + SUM L^2 w / (E_v^1.87 P^2)) + 0.16        Wienold & Christoffersen 2006
 *     DGI = 10 log10(0.478 SUM L^1.6 W^0.8 / (L_b + 0.07 w^0.5 L)),  W = w / P^2    Hopkinson 1972, Chauvel et al. 1982
 *     CGI = 8 log10(2 (1 + E_d/500) / (E_d + E_i) SUM L^2 w / P^2)                   Einhorn 1979
 *     VCP = 100 Phi(6.374 - 1.3227 ln DGR), DGR = (SUM M)^(n^-0.0914),
 *           M = 0.5 L (20.4 w + 1.52 w^0.2 - 0.075) / (P F^0.44), F the mean luminance   Guth 1963
 *
 * w [sr] a source's solid angle, P its position index (Guth 1963; below the line of sight as beside it, Iwata &
 * Osterhaus 2010). Limits: one view direction; pixels' errors are taken as independent of each other; who sees how
 * (age, adaptation) is not in it. */
#ifndef SR_GLARE_GLARE_H
#define SR_GLARE_GLARE_H

#include "image/image.h"
#include "math/math.h"
#include "sensor/sensor.h"

enum sr_glare_projection {
    SR_GLARE_EQUIDISTANT, // the first four as enum sr_fisheye
    SR_GLARE_EQUISOLID,
    SR_GLARE_ORTHOGRAPHIC,
    SR_GLARE_STEREOGRAPHIC,
    SR_GLARE_EQUAL_AREA, // Camera "spherical" and its mappings; the half in front of it counts
    SR_GLARE_EQUIRECTANGULAR,
};

struct sr_glare_options {
    enum sr_glare_projection projection;
    double angle_deg; // across the disk of a fisheye; 0: 180
    double
        threshold;  // [cd/m^2] of glare sources; 0: factor times the mean luminance of the task, or of the whole field
    double factor;  // [1] 0: 5
    double task[3]; // x, y [pixel] and half its angle [deg]; angle 0: no task
    double peak;    // [cd/m^2] above which pixels make a source of their own within another; 0: 50000; INFINITY: never
};

struct sr_glare_source {
    uint32_t pixels;
    double L, L_error; // [cd/m^2] mean over its solid angle
    double omega;      // [sr]
    double E;          // [lx] of the eye
    double position;   // [1] Guth's index P
    double sigma_deg,
        tau_deg; // [deg] from the line of sight; from the vertical plane of it: 0 above, 90 beside, 180 below
    double x, y; // [pixel] its middle
};

enum sr_glare_index {
    SR_GLARE_UGR,
    SR_GLARE_DGP,
    SR_GLARE_DGP_LOW_LIGHT,
    SR_GLARE_DGI,
    SR_GLARE_CGI,
    SR_GLARE_VCP,
    SR_GLARE_INDICES
};
extern const char *const sr_glare_index_names[SR_GLARE_INDICES];

struct sr_glare {
    double omega;                                            // [sr] seen in all
    double E_v, E_v_error;                                   // [lx]
    double E_direct, E_indirect;                             // [lx]
    double L_mean, L_task, L_background, threshold;          // [cd/m^2]
    double index[SR_GLARE_INDICES], error[SR_GLARE_INDICES]; // NaN: there is no such number without a source
    bool has_errors;                                         // the picture told the standard errors of its pixels
    const struct sr_glare_source *sources;                   // brightest E first
    uint32_t source_count;
    const uint32_t *labels; // of each pixel: number of its source, from 1 in the order of the picture; 0: none
};

/* Channels in cd/m^2 (R, G, B; X, Y, Z; Y), standard errors in SE.R and so on. sources and labels are in the arena. */
sr_status sr_glare_measure(const struct sr_image *image, const struct sr_glare_options *options, struct sr_arena *arena,
                           struct sr_glare *out, struct sr_error *error);

/* Guth's position index; tau above 90 deg counts as 90. */
double sr_glare_position(double sigma_deg, double tau_deg);

#endif
