/* SPDX-License-Identifier: MIT */
/* For the files of this room: one pass of samples over a picture. */
#ifndef SR_RENDER_PRIVATE_H
#define SR_RENDER_PRIVATE_H

#include "render/render.h"

struct sr_render_pass {
    struct sr_film *film;            // what the samples are added to
    uint32_t blocks;                 // of each pixel
    uint32_t first_replicate;        // block b is the replicate first_replicate + b
    uint32_t per_replicate;          // samples of a block; 0: the blocks are parts of one net of job->spp samples
    const uint32_t *counts;          // NULL, or instead of per_replicate for each pixel
    double start_s;                  // of the whole work
    double share_begin, share_end;   // [1] what of the whole work this pass is, for progress
};
/* Adds to the report. SR_CANCELLED: the film holds what there is. */
sr_status sr_render_pass(const struct sr_render_job *job, const struct sr_render_pass *pass, struct sr_render_report *report, struct sr_error *error);

/* adaptive.c */
sr_status sr_render_adaptive(const struct sr_render_job *job, struct sr_film **film, struct sr_render_report *report, struct sr_error *error);

#endif
