/* SPDX-License-Identifier: MIT */
/* The benchmark of the scattering models. */
#ifndef SR_BENCH_BSDF_BENCH_H
#define SR_BENCH_BSDF_BENCH_H

int bench_bsdfs(const char *only); // the name of one model, or NULL for all; returns the program's status

#endif
