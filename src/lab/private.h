/* SPDX-License-Identifier: MIT */
/* What the files of this room share. */
#ifndef SR_LAB_PRIVATE_H
#define SR_LAB_PRIVATE_H

#include "lab/lab.h"

/* ---- sum.c: the sum of the parts of a specimen, as a model: data is a struct sum ---- */

extern const struct sr_bsdf_model lab_sum, lab_random_sum;
struct sum {
    const struct sr_bsdf *parts;
    int count;
    float weight[SR_SPECIMEN_PARTS]; // [1] of f
    float share[SR_SPECIMEN_PARTS];  // [1] probability that sample chooses the part
};

#endif
