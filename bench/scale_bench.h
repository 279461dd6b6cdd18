/* SPDX-License-Identifier: MIT */
#ifndef SR_BENCH_SCALE_BENCH_H
#define SR_BENCH_SCALE_BENCH_H

/* Prints lines that tell how cost grows; only: NULL, or one of triangles, lights, depth, pixels, wavelengths, threads.
 */
int bench_scale(const char *only, const char *folder, int runs);
/* A table of a file of such lines on standard output; figure: NULL, or an SVG or PNG to draw. */
int bench_scale_draw(const char *lines, const char *figure);

#endif
