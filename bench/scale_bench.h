/* SPDX-License-Identifier: MIT */
#ifndef SR_BENCH_SCALE_BENCH_H
#define SR_BENCH_SCALE_BENCH_H

/* Prints how cost grows; only: NULL, or one of triangles, lights, depth, pixels, threads; figure: NULL, or an SVG or PNG to draw. */
int bench_scale(const char *only, const char *folder, int runs, const char *figure);

#endif
