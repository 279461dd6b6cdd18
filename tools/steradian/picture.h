/* SPDX-License-Identifier: MIT */
/* A rendered picture and what its files tell of it, whoever has its sums: one render, or parts that have become one. */
#ifndef SR_TOOLS_PICTURE_H
#define SR_TOOLS_PICTURE_H

#include "command.h"

#include "import/import.h"
#include "render/render.h"

struct picture {
    const struct sr_film *film;
    const char *about;  // of picture_about
    bool is_replicated; // error bars are each pixel's own
    bool is_complete;
    bool has_exposure;
    double exposure_EV; // of a PNG
    bool has_stamp;     // date and time go into the file, whose bytes then differ from run to run
    double elapsed_s;
};
/* What is known of a picture beforehand, as lines "attribute value". NULL: no memory. */
char *picture_about(struct sr_arena *arena, const struct sr_render_job *job, uint64_t scene_hash, enum sr_units units);
/* Writes the files whose endings are images'; the others are somebody else's. */
sr_status picture_write(const struct picture *p, const char *const *names, int count, struct sr_error *error);

struct sr_quantity picture_mean_luminance(const struct sr_film *film);     // a number where the film tells no luminance
void picture_print_mean(const struct sr_film *film, bool is_conservative); // to standard error
/* Mean samples per pixel. */
double picture_mean_spp(const struct sr_film *film);

#endif
