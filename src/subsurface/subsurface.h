/* SPDX-License-Identifier: MIT */
/* Light that enters a translucent body at one point and leaves it at another: the profile over their distance.
 *
 *     S(po, wo, pi, wi) = T(wo) S_r(|po - pi|) S_w(wi)      [m^-2 sr^-1]
 *
 * T is Fresnel's transmission, S_w the diffuse exit that bsdf/ has, and S_r(r) [1/m^2] photon beam diffusion on a flat
 * half space (Habel, Christensen & Jarosz 2013), tabulated once for each pair of g and eta. */
#ifndef SR_SUBSURFACE_SUBSURFACE_H
#define SR_SUBSURFACE_SUBSURFACE_H

#include "spectrum/spectrum.h"

/* The two parts of S_r(r) for a mean free path of 1 [m], all else in that unit: light scattered once, and more often.
 * albedo = sigma_s / sigma_t in 0 … 1. Single scattering is infinite at r = 0. */
double sr_diffusion_single(double albedo, double g, double eta, double r);
double sr_diffusion_multiple(double albedo, double g, double eta, double r);

/* 2 pi r S_r over albedo and optical radius r sigma_t; between nodes Catmull-Rom splines. */
enum { SR_DIFFUSION_ALBEDOS = 100, SR_DIFFUSION_RADII = 64 };
struct sr_diffusion {
    float albedo[SR_DIFFUSION_ALBEDOS], radius[SR_DIFFUSION_RADII];
    float profile[SR_DIFFUSION_ALBEDOS][SR_DIFFUSION_RADII];    // [1/mean free path]
    float cumulative[SR_DIFFUSION_ALBEDOS][SR_DIFFUSION_RADII]; // integral of the spline from 0 [1]
    float effective[SR_DIFFUSION_ALBEDOS];                      // all of it: what comes out of what has entered [1]
    float reach[SR_DIFFUSION_ALBEDOS]; // optical radius within which all but 1e-4 of it comes out
};
/* g in (-1, 1), eta > 0. */
const struct sr_diffusion *sr_diffusion_make(double g, double eta, struct sr_arena *arena, struct sr_error *error);
/* What comes out of what has entered, and the albedo by which that is the given share. */
float sr_diffusion_effective(const struct sr_diffusion *d, float albedo);
float sr_diffusion_albedo(const struct sr_diffusion *d, float effective);

/* A body at the path's wavelengths. */
struct sr_bssrdf {
    const struct sr_diffusion *diffusion;
    sr_spectrum sigma_t; // [1/m]
    sr_spectrum albedo;  // [1]
    float eta;           // [1] inside over outside
};
/* S_r(r) [1/m^2]. pdf: by area of the plane, with which sr_bssrdf_sample draws for each wavelength [1/m^2]; may be
 * NULL. */
sr_spectrum sr_bssrdf_profile(const struct sr_bssrdf *b, float r, sr_spectrum *pdf);
/* A distance [m] drawn for the wavelength i; < 0: none. */
float sr_bssrdf_sample(const struct sr_bssrdf *b, int i, float u);
/* Distance within which the wavelength i is drawn and looked for [m]; 0: nowhere. */
float sr_bssrdf_reach(const struct sr_bssrdf *b, int i);

#endif
