/* SPDX-License-Identifier: MIT */
/* What the files of this room share: the integrands of photon beam diffusion, made ready for one g and eta. */
#ifndef SR_SUBSURFACE_PRIVATE_H
#define SR_SUBSURFACE_PRIVATE_H

#include "subsurface/subsurface.h"

#include <math.h>

enum { SUBSURFACE_NODES = 64 };
struct subsurface_kernel {
    double g, eta;
    double critical;                                 // depth below which light leaves at the distance 1 [1]
    double A, C_phi, C_E;                            // of the boundary [1]
    double z[SUBSURFACE_NODES], w[SUBSURFACE_NODES]; // depths [mean free path]
};
struct subsurface_kernel subsurface_kernel_of(double g, double eta);
double subsurface_single(const struct subsurface_kernel *k, double albedo, double r);
double subsurface_multiple(const struct subsurface_kernel *k, double albedo, double r);

#endif
