/* SPDX-License-Identifier: MIT */
/* For the files of this room: one sample of a picture, one pass of samples over it. */
#ifndef SR_RENDER_PRIVATE_H
#define SR_RENDER_PRIVATE_H

#include "render/render.h"

/* ---- picture_sample.c ---- */

/* What all samples of a job take from the sensor's film. */
struct sr_response {
    float rgb_from_xyz[3][3];
    struct sr_lambda_law law;
    uint32_t buckets;
    float lambda_min, lambda_step;     // [nm] of a bucket
    float imaging_ratio, bucket_scale; // the latter with the former
    bool (*ray)(const void *sensor, sr_vec2 raster, sr_vec2 u_lens, float u_time, struct sr_sensor_ray *out);
    bool is_bare; // of the ray: nobody looks at its differentials
};

/* What all samples of a picture share. */
struct sr_picture {
    const struct sr_render_job *job;
    struct sr_film *film;
    struct sr_response response;
    struct sr_path_start middle; // a ray of the sensor's, for the footprints of light paths
    bool has_middle;
};
void sr_picture_begin(struct sr_picture *picture, const struct sr_render_job *job, struct sr_film *film);
/* One sample of a picture, on its way from numbers to what the film adds. */
struct sr_picture_sample {
    struct sr_wavelengths w;
    struct sr_path_start start;
    float weight, view_weight;
    sr_spectrum L; // [W m^-2 sr^-1 nm^-1]
    float rgb[3];
    bool is_finite;
    struct sr_first_hit first; // only where it has been asked for
};
enum { SR_PICTURE_SAMPLES = SR_AHEAD };
/* Samples of one pixel, from start->sample on, up to SR_PICTURE_SAMPLES of them. */
void sr_picture_samples(const struct sr_picture *picture, uint32_t x, uint32_t y, const struct sr_sampler *start,
                        uint32_t count, bool with_first, struct sr_picture_sample *out, struct sr_worker *worker);
void sr_picture_add_to_buckets(const struct sr_picture *picture, const struct sr_picture_sample *s, double *buckets);

/* Where paths from the lights are told, by one thread. */
struct sr_splatting {
    const struct sr_picture *picture;
    struct sr_film *film; // whose splats they are
    uint32_t group;
    struct sr_target target; // its user is the struct itself: whoever keeps it says where that is
};
struct sr_splatting sr_splatting_begin(const struct sr_picture *picture);
/* The path that goes with sample i of the pixel: all of them are points of one net, in the order of the samples. */
void sr_splatting_aim(struct sr_splatting *s, uint32_t pixel, uint32_t replicate, uint32_t i);
/* One path from the lights with the target's numbers. */
void sr_picture_splat(const struct sr_picture *picture, struct sr_worker *worker);

/* ---- block_tree.c ---- */

/* Sums of consecutive samples over the fixed binary tree of their numbers, counted from their block's begin: node
 * (level, k) is the sum of samples k 2^level <= i < (k + 1) 2^level, its left half joined with its right one. */
enum {
    SR_BLOCK_TREE_NODES = 64
}; // at most 31 growing ones, then at most 32 shrinking ones, and the sample that is being made
struct sr_block_tree {
    uint32_t first, next; // samples first <= i < next are in the nodes, from left to right
    uint32_t depth;       // nodes that there are
    uint32_t bucket_count;
    double *buckets; // [SR_BLOCK_TREE_NODES][bucket_count]; NULL: none
    struct sr_film_block nodes[SR_BLOCK_TREE_NODES];
};
void sr_block_tree_begin(struct sr_block_tree *t, uint32_t first);
/* The next sample's sums, all zero, to be filled before it is told to be done. */
struct sr_film_block *sr_block_tree_sample(struct sr_block_tree *t, double **buckets);
void sr_block_tree_done(struct sr_block_tree *t);
/* Joins all nodes, from the right, into the first one: the sum of the block where all its samples are there. */
void sr_block_tree_fold(struct sr_block_tree *t);

/* ---- pass.c ---- */

struct sr_keeper;
struct sr_render_pass {
    struct sr_film *film;     // what the samples are added to
    struct sr_keeper *keeper; // NULL: nothing is kept
    uint32_t blocks_before;   // of each pixel, from earlier passes
    uint32_t blocks;          // of each pixel
    uint32_t first_replicate; // block b is the replicate first_replicate + b
    uint32_t per_replicate;   // samples of a block; 0: the blocks are parts of one net of job->spp samples
    const uint32_t *counts;   // NULL, or instead of per_replicate for each pixel
    double start_s;           // of the whole work
    struct sr_render_part
        *part; // NULL, or what takes the sums of the samples in range; the film then takes splats only
    struct sr_render_range range;
    double share_begin, share_end; // [1] what of the whole work this pass is, for progress
};
/* Adds to the report. SR_CANCELLED: the film holds what there is. */
sr_status sr_render_pass(const struct sr_render_job *job, const struct sr_render_pass *pass,
                         struct sr_render_report *report, struct sr_error *error);

/* ---- unit.c ---- */

/* Whether the sample x, y, replicate, number comes before the other, in picture order. */
bool sr_render_is_earlier(const uint32_t a[4], const uint32_t b[4]);

/* ---- part.c ---- */

sr_status sr_part_create(const struct sr_render_job *job, uint32_t blocks, struct sr_render_range range,
                         struct sr_render_part **out, struct sr_error *error);
/* How many sums it has for each pixel, and [B] of each of them. */
uint64_t sr_part_nodes(uint32_t spp, uint32_t blocks, struct sr_render_range range);
size_t sr_part_node_B(const struct sr_render_job *job);
struct sr_film *sr_part_splats_film(struct sr_render_part *part); // what the pass's film is
struct sr_render_report *sr_part_report(struct sr_render_part *part);
/* The sums of all nodes in a store, and back into a part of the same nodes. */
sr_status sr_part_put(struct sr_store_out *out, const struct sr_render_part *part, struct sr_error *error);
sr_status sr_part_get(const struct sr_store_in *in, const char *path, struct sr_render_part *part,
                      struct sr_error *error);
/* Keeps a pixel's sums of the samples of a block that the part has. Threads may call it for different pixels or blocks.
 */
void sr_part_keep(struct sr_render_part *part, uint32_t block, uint32_t x, uint32_t y,
                  const struct sr_block_tree *tree);

/* ---- film_store.c ---- */

struct sr_film *sr_film_twin(const struct sr_film *film, struct sr_error *error); // empty; NULL: no memory
void sr_film_copy(struct sr_film *to, const struct sr_film *from);                // to a twin

/* ---- checkpoint.c ---- */

/* A render that is kept. All zero but for what is given: nothing is. */
struct sr_keeper {
    const struct sr_render_keep *keep; // NULL: nothing is kept
    struct sr_film *films[2];          // all that the sums are in
    uint32_t film_count;
    uint32_t *counts[2];         // NULL, or of each pixel: what an adaptive render has settled
    struct sr_render_part *part; // NULL, or what takes the sums; films[0] then takes splats and counts blocks
    uint32_t pass;               // that is under way, or comes next
    bool is_complete;            // after sr_keeper_resume: films[0] is the picture
    bool loses_file;             // what is in the file is damaged: it does not become the previous generation
    struct sr_film *copy;        // of the film that is being rendered
    char told[1024];             // the last failure that has been told
    struct sr_render_kept kept;
};
/* Fills the films and all others from the file, if that is wanted and it is there. */
sr_status sr_keeper_resume(struct sr_keeper *k, struct sr_render_report *report, struct sr_error *error);
/* Writes what there is while nobody else changes it. */
void sr_keeper_write(struct sr_keeper *k, const struct sr_render_report *report, double share);
/* What is kept of the render goes into the report. */
void sr_keeper_end(struct sr_keeper *k, struct sr_render_report *report);

/* A pass that is under way, for those who look at its film. */
struct sr_keeper_view {
    void *run;
    struct sr_film *film;
    void (*hold)(void *run); // no samples come in until it is let go
    void (*let_go)(void *run);
    double (*tell)(
        void *run,
        struct sr_render_report *report); // with the film: its counts and times; the share of the work that is done
};
struct sr_keeper_watch *sr_keeper_watch_begin(struct sr_keeper *k,
                                              const struct sr_keeper_view *view); // NULL: nothing is kept
void sr_keeper_watch_end(struct sr_keeper_watch *watch);

/* ---- crew.c: a helper's finished units as bytes ---- */

/* A film for this process's sums: a helper's has no more than splats and numbers of blocks. */
sr_status sr_crew_film_create(const struct sr_render_job *job, struct sr_film **film, struct sr_error *error);
/* A helper goes on where the owner does. */
sr_status sr_crew_share_keeper(const struct sr_render_job *job, struct sr_keeper *keeper, struct sr_error *error);
/* The owner's numbers become everybody's; nothing where there is no crew. */
sr_status sr_crew_share(const struct sr_render_job *job, uint32_t *numbers, size_t count, struct sr_error *error);

/* Units are collected in batches. With splats a batch has an accumulator of its own, so that it holds units and all
 * that their paths have splatted, or nothing of either: units that begin go into the one batch, while those of the
 * other come to an end. */
struct sr_crew_batches;
struct sr_crew_batch;
struct sr_crew_batches *sr_crew_batches_create(const struct sr_render_job *job, const struct sr_film *film,
                                               struct sr_error *error);
void sr_crew_batches_destroy(struct sr_crew_batches *b);
/* A unit begins; *splats: where its splats go. With splats, only when the tile's block before has left. */
struct sr_crew_batch *sr_crew_enter(struct sr_crew_batches *b, struct sr_film **splats);
/* It ends; a tile's units leave in order. The first so many pixels are done. */
void sr_crew_leave(struct sr_crew_batches *b, struct sr_crew_batch *batch, const struct sr_crew_unit *unit,
                   uint32_t pixels, const struct sr_film_block *blocks, const double *buckets,
                   const struct sr_render_counts *counts);
/* Hands over what is left, once no unit is under way; false: memory was short and units are missing. */
bool sr_crew_finish(struct sr_crew_batches *b);

/* What reads batches into the film. */
struct sr_crew_reader {
    struct sr_film *film;
    const struct sr_render_crew *crew;
    const uint32_t *had;            // NULL, or of each pixel: this many blocks are there already
    uint32_t blocks_before;         // the pass's block 0 is each pixel's block of this number
    struct sr_render_counts counts; // of what has been read
    uint64_t units;
};
void sr_crew_read(struct sr_crew_reader *r, const void *bytes, size_t size);

/* adaptive.c */
sr_status sr_render_adaptive(const struct sr_render_job *job, struct sr_film **film, struct sr_render_report *report,
                             struct sr_error *error);

#endif
