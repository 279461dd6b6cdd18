/* SPDX-License-Identifier: MIT */
/* What the parts of steradian render share: the arguments, and a render that is running. */
#ifndef SR_TOOLS_RENDER_H
#define SR_TOOLS_RENDER_H

#include "picture.h"

enum { RENDER_MAX_OUTPUTS = 8, RENDER_MAX_METERS = 16 };
#define PART_ENDING ".srp" // of files that hold a part of a picture

struct render_arguments {
    const char *scene, *outputs[RENDER_MAX_OUTPUTS];
    int output_count;
    struct sr_import_options import;
    struct sr_render_adaptive adaptive;
    uint64_t seed, replicates, threads, tile, sample, replicate;
    bool has_seed, has_pixel, has_sample, aov, quiet, json, stats, no_pixel_jitter, no_lambda_jitter, has_exposure,
        stamp;
    double pixel[2], exposure_EV, partial_s;
    double lambda[2]; // [nm]
    const char *sampler;
    bool has_range; // some of the samples only: a part of the picture
    struct sr_render_range range;
    uint64_t part[2];       // instead, number K of N even ranges; N = 0: not asked for
    const char *checkpoint; // NULL: beside the first output
    double checkpoint_s;    // between checkpoints
    double progress_s;      // between lines; 0: a bar, where there is a terminal
    bool no_checkpoint, resume;
    double meters[RENDER_MAX_METERS][6]; // [m] point, [1] normal
    int meter_count;
};

/* A render while it runs. */
struct rendering {
    const struct render_arguments *arguments;
    const struct sr_import_result *scene;
    const struct sr_render_job *job;
    const char *about;                      // of picture_about
    struct sr_render_range range;           // of a part
    const struct sr_render_keep *keep;      // NULL: none
    double last_partial_s, last_progress_s; // [s]
    double cpu_s;                           // of the processors, for rendering, in this run alone [s]
    bool on_terminal;                       // a bar is drawn there
};

/* Set by a program whose processes render together; all zero: this one renders alone. */
struct render_crew {
    const struct sr_render_crew *hooks;
    const char *identity; // set by the render, before it meets the others
    int threads;          // that a process takes where --threads does not say
    int processes;
};
extern struct render_crew render_crew;

/* ---- render.c ---- */

/* How to see the first sample that was not finite again. */
void render_print_replay(const struct rendering *r, const struct sr_render_report *report);

/* ---- render_arguments.c ---- */

/* Fills the arguments; 0, or the exit code of a mistake that has been told. */
int render_parse(int argc, char **argv, struct render_arguments *a);

/* ---- render_part.c ---- */

/* "A-B", "K/N" */
bool render_parse_range(const char *text, struct sr_render_range *range);
bool render_parse_part(const char *text, uint64_t part[2]);
/* What does not go with a part. 0, or the exit code of a mistake that has been told. */
int render_check_part(const struct render_arguments *a);
/* Renders some of the samples and writes them; the exit code. identity: of the picture. */
int render_part(struct rendering *r, struct sr_render_job *job, const char *identity);

/* ---- render_output.c ---- */

/* The files to write: those of -o, or the scene's own. */
int render_output_count(const struct render_arguments *a);
const char *render_output_name(const struct render_arguments *a, const struct sr_import_result *scene, int i);
/* Endings that are known, folders that can be written: before any work. 0, or the exit code of a failure that has been
 * told. scene: NULL while it is not read yet. */
int render_check_outputs(const struct render_arguments *a, const struct sr_import_result *scene);
/* Whether so many of the picture fit into this machine's memory, with what belongs to it. */
bool render_has_room(const struct sr_render_job *job, int copies);
/* The same for one, with a message. range: NULL, or of the part. */
sr_status render_check_memory(const struct sr_render_job *job, const struct sr_render_range *range,
                              struct sr_error *error);
sr_status render_write_outputs(const struct rendering *r, const struct sr_film *film, double elapsed_s,
                               bool is_complete, struct sr_error *error);

/* SIGUSR1 asks for a partial picture; from the first moment, so that it never kills. */
void render_catch_requests(void);
/* SIGINT, SIGTERM and SIGHUP (unless it is ignored: nohup) end the program at once, by 130, 143 or 129: while it loads.
 */
void render_end_by_interrupts(void);
/* They end the work, and what there is gets written; a second one ends the program at once. */
void render_catch_interrupts(void);
extern atomic_bool render_interrupted;
int render_interrupt_exit(void); // 130, 143 or 129
void render_on_progress(void *user, const struct sr_render_progress *p);

/* ---- render_keep.c ---- */

/* A render's checkpoint. */
struct render_keeping {
    struct sr_arena arena;
    struct sr_render_keep keep; // path NULL: none
    struct sr_log log;
    bool is_asked_for;
    const char *outputs[RENDER_MAX_OUTPUTS];
    int output_count;
};
/* Where and how the job is kept; 0, or the exit code of a failure that has been told. */
int render_keep_begin(const struct render_arguments *a, const struct sr_import_result *scene, const char *identity,
                      struct sr_render_job *job, struct render_keeping *k);
/* After the outputs: is_written, whether they could be. Removes what is not needed any more, tells what is left; the
 * exit code. */
int render_keep_end(struct render_keeping *k, const struct sr_render_job *job, const struct sr_film *film,
                    struct sr_render_part *part, struct sr_render_report *report,
                    bool is_written); // of a film, or of a part

/* ---- render_summary.c ---- */

/* Measures and, unless quiet, prints; returns the list for the JSON. */
json_t *render_measure(const struct render_arguments *a, const struct sr_render_job *job);
/* Whether --error asked for less noise than the picture has. */
bool render_missed_target(const struct rendering *r, const struct sr_film *film);
void render_print_summary(const struct rendering *r, const struct sr_film *film, const struct sr_render_report *report);
/* Takes meters over; the exit code. */
int render_print_json(const struct rendering *r, const struct sr_film *film, const struct sr_render_report *report,
                      json_t *meters);

#endif
