/* SPDX-License-Identifier: MIT */
/* Between the two precisions: what both compilations can say, in double and int alone.
 *
 * double/bridge.c is compiled in double precision, twin.c in single; a model is known to both by its place in the list.
 */
#ifndef SR_LAB_TWIN_H
#define SR_LAB_TWIN_H

#include "spectrum/spectrum.h"

/* One row of a model's table. FLOAT, INT, ENUM and BOOL stand in number[0]. */
struct twin_row {
    double number[SR_LAMBDA_COUNT];
    const char *file;
};
struct twin_sample {
    double wi[3], f[SR_LAMBDA_COUNT], pdf;
    uint32_t lobe;
    bool pdf_is_proportional;
};

/* Makes the model's data in double precision out of its rows. *bsdf is NULL where the model has no twin. */
sr_status sr_double_make(struct sr_arena *arena, int model, const struct twin_row *rows,
                         const double lambda[SR_LAMBDA_COUNT], uint32_t seed, const void **bsdf,
                         struct sr_error *error);
void sr_double_f_pdf(const void *bsdf, const double wo[3], const double wi[3], int mode, double f[SR_LAMBDA_COUNT],
                     double *pdf);
bool sr_double_sample(const void *bsdf, const double wo[3], double u_lobe, const double u[2], int mode,
                      struct twin_sample *s);

/* In single precision's file. A part's own sample, whose f bears the part's weight. */
struct sr_twin;
int sr_twin_part_count(const struct sr_twin *twin);
bool sr_twin_sample(const struct sr_twin *twin, int part, const double wo[3], double u_lobe, const double u[2],
                    struct twin_sample *s);

#endif
