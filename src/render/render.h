/* SPDX-License-Identifier: MIT */
/* Jobs: a finished scene, a sensor and a film; work units, workers, progress; and the film as an image with units.
 *
 * A work unit is a tile times a block of samples. Each pixel's sums are added in the order of the blocks, whoever
 * computes them, so that the bytes do not depend on threads or tiles. */
#ifndef SR_RENDER_RENDER_H
#define SR_RENDER_RENDER_H

#include "film/film.h"
#include "image/image.h"
#include "integrator/integrator.h"
#include "meter/meter.h"
#include "quantity/quantity.h"
#include "sensor/sensor.h"
#include "store/store.h"

#include <stdatomic.h>

struct sr_import_result;

/* What a progress callback is told. */
struct sr_render_progress {
    double share;               // [1] of the work that is done
    double elapsed_s;           // [s]
    double left_s;              // [s] estimated; NaN: not known yet
    uint64_t rays;              // so far, shadow rays included
    const struct sr_film *film; // as it is now; pixels of running units may be a block behind
};

/* Samples where the picture is noisy. Two halves of independent replicates: a pilot of each says where the other one's
 * further samples go, so that no sample has a say in how much it counts, and every pixel's expectation is that of an
 * even share (docs/decisions/0013-adaptive-sampling.md). */
struct sr_render_adaptive {
    bool is_on;
    double error;  // [1] relative root mean square error of the picture to aim at; 0: none
    double time_s; // [s] to aim at; 0: none. Bytes then depend on the machine's speed
    // without either, spp samples per pixel are taken on average; with one, at most as many
};

/* Sums on disk, so that a render that ends before its time can go on (docs/decisions/0019-checkpoints.md). */
struct sr_render_keep {
    const char *path;     // the file; the generation before it has a ~ at its end
    const char *identity; // of this render: sr_render_identity
    double interval_s;    // between checkpoints
    bool has_no_copy;     // there is no memory for a second film: workers wait while it is written
    bool resumes;         // goes on from the file if there is one; refuses one that belongs to another render
    struct sr_log *log;   // told what does not work while the render goes on
};

/* ---- a crew: processes that work on one picture ----
 *
 * Each has a scene of its own and calls sr_render with the same job. One of them, the owner, keeps the film and tells
 * of it; the helpers hand what they have made over to it, as bytes. A tile is dealt to one process, which makes all its
 * blocks in order, so that the film's sums are the same for any crew (docs/decisions/0020-ranks.md). How bytes travel
 * is the crew's. */

/* What has been done, in sums; so small that it goes with every batch of bytes. */
struct sr_render_counts {
    uint64_t paths, rays, shadow_rays, vertices, dropped;
    uint32_t has_dropped, first_dropped[4]; // x, y, replicate, sample: the first in picture order
};

/* A unit that is in the film, for whoever keeps a log. */
struct sr_crew_unit {
    uint32_t tile, block;
    uint32_t x0, y0, x1, y1; // [pixel] of the rendered part
    double cost_s;           // [s] of a processor
};

/* One pass over the picture, as a crew sees it. */
struct sr_crew_pass {
    uint32_t tiles, blocks;
    bool is_dealt_once; // each process should get one share of the tiles, at even distances: what its samples share is
                        // dear
    int threads;
    void *run;
    void (*take)(void *run, const void *bytes,
                 size_t size); // the owner's: what a helper has handed over; one at a time
    void (*tick)(void *run);   // the owner's: to be called while end waits
};

struct sr_render_crew {
    void *self;
    bool is_helper;
    /* All have loaded the scene; fails if another could not, or is about to make something else. */
    sr_status (*meet)(void *self, struct sr_error *error);
    /* The owner's bytes become everybody's; before, between and after passes. */
    sr_status (*share)(void *self, void *data, size_t size, struct sr_error *error);
    sr_status (*begin)(void *self, const struct sr_crew_pass *pass, struct sr_error *error);
    /* A unit (tile + tiles * block) for a thread of this process, a tile's blocks in order. May wait. false: no more.
     */
    bool (*next)(void *self, uint64_t *unit);
    /* A helper's bytes for the owner's take, in order; from sr_alloc, taken over. */
    void (*hand)(void *self, void *bytes, size_t size);
    void (*note)(void *self, const struct sr_crew_unit *unit); // NULL, or called by the owner for each unit of its own
    /* The owner: once all that was dealt out has been taken, or given up where the render was cancelled. A helper: at
     * once. */
    sr_status (*end)(void *self, bool is_cancelled, struct sr_error *error);
};

struct sr_render_job {
    const struct sr_scene *scene;
    struct sr_sensor sensor;
    struct sr_filter filter;
    struct sr_integrator integrator;
    struct sr_film_settings film;
    enum sr_sampler_kind sampler;
    uint32_t seed;
    uint32_t spp;        // samples per pixel, in all
    uint32_t replicates; // 0: an ordinary image; R >= 2: R independently scrambled nets, for Student's intervals
    struct sr_render_adaptive adaptive; // then replicates is not looked at
    struct sr_lambda_range lambda;      // [nm]
    double origin[3]; // [m] of the scene's space, as the import gives it: other than 0 where the scene is far away
    bool jitter_pixel, jitter_lambda; // false only to look into things
    bool with_aov;
    int threads;                       // 0: all processors
    int tile;                          // [pixel] side of a tile; 0: 16
    const struct sr_render_crew *crew; // NULL: this process alone
    struct sr_ray_log *log;            // NULL, or where the first thread's rays are recorded
    const struct sr_render_keep *keep; // NULL: nothing is kept

    void (*progress)(void *user,
                     const struct sr_render_progress *p); // NULL: nobody asks; called by one thread at a time
    double progress_interval_s;
    void *user;
    const atomic_bool *cancel; // NULL, or set by somebody who wants to stop; what is done is kept
};

/* The picture that a scene's file asks for: all its samples, the visible wavelengths, all processors. The scene stays
 * the import's. */
struct sr_render_job sr_render_job_of(const struct sr_import_result *scene);

/* A point of the world [m], where the scene has it. */
static inline sr_vec3 sr_render_place(const struct sr_render_job *job, const double world[3])
{
    return (sr_vec3){(float)(world[0] - job->origin[0]), (float)(world[1] - job->origin[1]),
                     (float)(world[2] - job->origin[2])};
}

struct sr_render_report {
    double render_s;
    uint64_t paths, rays, shadow_rays, vertices;
    uint64_t dropped;                                                 // samples that were not finite
    uint32_t dropped_x, dropped_y, dropped_sample, dropped_replicate; // the first of them, for replay
    bool is_complete;
    char remark[SR_PICTURE_REMARK]; // what the estimator has to say of this picture, or empty
    struct sr_render_kept {
        uint32_t written, failed; // checkpoints
        bool is_behind;           // the last one that was tried is not on disk
        bool is_resumed;          // the render began with a checkpoint
        double stall_s, write_s;  // workers waited, the writer worked
        double resumed_share;     // [1] of the work that was there already; 0: a new render
    } kept;
};

/* Renders into a new film. Cancelled: SR_CANCELLED, and the film holds what there is. Times and counts of a render that
 * has been resumed are those of all its runs. */
sr_status sr_render(const struct sr_render_job *job, struct sr_film **film, struct sr_render_report *report,
                    struct sr_error *error);

/* ---- identity.c: what makes the bytes, as lines "key value" ---- */

/* scene: lines about the scene (sr_import_identity). NULL: no memory. */
char *sr_render_identity(struct sr_arena *arena, const struct sr_render_job *job, const char *scene);
struct sr_render_difference {
    char key[96], theirs[160], ours[160];
};
/* The first key whose values are not the same; false: there is none. */
bool sr_render_identity_differs(const char *theirs, const char *ours, struct sr_render_difference *d);

/* ---- checkpoint.c ---- */

/* Keeps a render whose work is done, where its picture could not be written. */
sr_status sr_render_checkpoint(const struct sr_render_job *job, const struct sr_film *film,
                               struct sr_render_report *report, struct sr_error *error);
/* A picture that has been written needs no checkpoint any more: removes all generations. */
void sr_render_forget(const struct sr_render_keep *keep);
/* What a checkpoint says of its render; false: it is none, or an older program's. */
struct sr_render_progress_kept {
    const char *identity;
    double share; // [1]
    double render_s;
    uint64_t paths, rays, shadow_rays, dropped;
    int64_t time_s; // when it was written, since 1970
    bool is_complete;
};
bool sr_render_checkpoint_tells(const struct sr_store_in *in, struct sr_render_progress_kept *out);

/* ---- film_store.c: a film in a store ---- */

/* Sections NAME.pixels, and where the film has them NAME.aov, NAME.buckets, NAME.splats, NAME.paths. */
sr_status sr_film_put(struct sr_store_out *out, const char *name, const struct sr_film *film, struct sr_error *error);
/* Into a film of the same settings, made with sr_film_create and sr_film_add_splats; path for the message. */
sr_status sr_film_get(const struct sr_store_in *in, const char *path, const char *name, struct sr_film *film,
                      struct sr_error *error);

/* ---- parts of a picture: some of its samples, rendered anywhere ----
 *
 * Each pixel's samples are numbered 0 <= i < spp; with replicates, sample k of replicate r is number r spp / replicates
 * + k. Parts of disjoint ranges that cover all numbers, in any order, become the picture that sr_render makes, to the
 * last bit (docs/decisions/0018-sums-over-a-tree.md). */
struct sr_render_part;
struct sr_render_range {
    uint32_t begin, end; // begin <= i < end
};
/* Renders these samples of each pixel. Fails for adaptive jobs, whose samples depend on each other's values. Cancelled:
 * SR_CANCELLED, and there is no part. If it is kept (job->keep), the range belongs to the identity. */
sr_status sr_render_samples(const struct sr_render_job *job, struct sr_render_range range, struct sr_render_part **part,
                            struct sr_render_report *report, struct sr_error *error);
/* Keeps a part whose work is done, where it could not be written; before sr_render_part_film is asked for. */
sr_status sr_render_part_checkpoint(const struct sr_render_job *job, struct sr_render_part *part,
                                    struct sr_render_report *report, struct sr_error *error);
/* [B] for each pixel of the sums of such a part. */
double sr_render_samples_B(const struct sr_render_job *job, struct sr_render_range range);
void sr_render_part_destroy(struct sr_render_part *part); // NULL is allowed
/* The number-th of the ranges that a part has, in ascending order; false where there are no more. */
bool sr_render_part_range(const struct sr_render_part *part, size_t number, struct sr_render_range *range);
bool sr_render_part_is_complete(const struct sr_render_part *part);
/* Moves the samples of `from` into `to`. Parts that have a sample in common or are not of one picture's shape are
 * refused, and then nothing has been moved; whether they are of one picture's identity is the caller's to know. */
sr_status sr_render_part_add(struct sr_render_part *to, struct sr_render_part *from, struct sr_error *error);
/* The picture of the samples that are there; it belongs to the part. */
struct sr_film *sr_render_part_film(struct sr_render_part *part);
const struct sr_render_report *sr_render_part_report(const struct sr_render_part *part);
bool sr_render_part_is_replicated(const struct sr_render_part *part);
/* Samples of each pixel of the whole picture. */
uint32_t sr_render_part_spp(const struct sr_render_part *part);
/* Two texts go with a part: the identity of what was rendered, and whatever else is to be told of the picture. */
sr_status sr_render_part_write(const struct sr_render_part *part, const char *identity, const char *about,
                               const char *path, struct sr_error *error);
sr_status sr_render_part_read(const char *path, struct sr_render_part **part, struct sr_error *error);
const char *sr_render_part_identity(const struct sr_render_part *part); // of a part that has been read
const char *sr_render_part_about(const struct sr_render_part *part);

/* One sample of one pixel, alone: RGB as it would be added to the film. Returns whether it is finite. */
bool sr_render_sample(const struct sr_render_job *job, uint32_t x, uint32_t y, uint32_t replicate, uint32_t sample,
                      float rgb[3], struct sr_first_hit *first, struct sr_worker *worker);

/* ---- measuring ---- */

struct sr_measure_settings {
    uint64_t samples;                    // in all, rounded up to whole replicates; 0: 65536; with a target: the most
    uint32_t replicates;                 // independently scrambled nets, for Student's interval; 0: 16, else 2 or more
    double error;                        // [1] relative expanded uncertainty (95 %) to reach; 0: none
    double time_s;                       // [s] that it may take, about; 0: as long as it takes
    enum sr_system system;               // whose uncertainty is looked at
    uint32_t stream;                     // which random numbers: another for each meter that is to be independent
    struct sr_spectrometer spectrometer; // count 0: none
    bool with_colour;
};

enum { SR_MEASURE_REMARKS = 6 };

/* What a meter reads. The estimate is that of the last round alone, whose size was settled before it began, so that
 * neither a target nor a limit of time biases it. */
struct sr_measurement {
    struct sr_quantity value[SR_SYSTEM_COUNT]; // over the job's wavelengths
    struct sr_quantity
        colour[SR_COLOUR_COUNT];     // if asked for: u by the jackknife; X Y Z as the photopic value, CCT in K
    struct sr_quantity *spectrum;    // of bins; NULL: none
    uint64_t samples, hits, dropped; // of the last round; hits: found light; dropped: not finite, count as nothing
    uint64_t pilot_samples;          // of the rounds before it
    double largest_share;            // [1] of the largest sample in the sum of all
    double elapsed_s;
    bool is_complete;  // false: cancelled
    bool is_on_target; // true also where there was none
    uint32_t remark_count;
    char remarks[SR_MEASURE_REMARKS][400]; // sentences about what is not as it should be
};

/* Measures one meter. Spectra are kept in the arena. Fails for lack of memory or for settings that make no sense;
 * cancelled: SR_CANCELLED, and the result is what there is (not a number, where that is nothing). */
sr_status sr_measure(const struct sr_render_job *job, const struct sr_meter *meter,
                     const struct sr_measure_settings *settings, struct sr_arena *arena, struct sr_measurement *out,
                     struct sr_error *error);
/* A map, as an image with the channels Y (in the settings' system) and SE.Y; samples are those of each cell. */
sr_status sr_measure_map(const struct sr_render_job *job, const struct sr_meter *meter,
                         const struct sr_measure_settings *settings, struct sr_image **image, struct sr_error *error);

/* Where the light of a scene goes, by particles from its lights; [0] photopic [lm], [1] radiometric [W]. */
struct sr_balance {
    struct sr_quantity emitted[2], absorbed[2], escaped[2];
    struct sr_quantity in_media[2]; // a part of absorbed
    struct sr_quantity given_up[2]; // still under way after 100000 scatterings
    struct sr_quantity closure[2];  // emitted less all others
    uint32_t materials, objects;
    struct sr_quantity (*by_material)[2], (*by_object)[2]; // absorbed; material and object numbers less 1
    uint64_t samples, dropped;
};
sr_status sr_measure_balance(const struct sr_render_job *job, const struct sr_measure_settings *settings,
                             struct sr_arena *arena, struct sr_balance *out, struct sr_error *error);

/* What a meter of the far field sees: the luminaire that the scene is. Kept in the arena. */
struct sr_intensity_table {
    uint32_t c_count, gamma_count;
    float *c, *gamma;    // [deg]
    float *I, *u;        // mean over the cell and its standard uncertainty, plane by plane [unit]
    struct sr_unit unit; // cd, W/sr
    struct sr_quantity flux;
    uint64_t samples;
};
sr_status sr_measure_intensity(const struct sr_render_job *job, const struct sr_meter *meter,
                               const struct sr_measure_settings *settings, struct sr_arena *arena,
                               struct sr_intensity_table *out, struct sr_error *error);

/* A thin case: irradiance at p on a surface element with normal n. */
struct sr_irradiance {
    double E_v, E_v_error; // [lx]
    double E_e, E_e_error; // [W/m^2] over the job's wavelength range
    double degrees;        // of freedom, for Student's interval
};
struct sr_irradiance sr_render_irradiance(const struct sr_render_job *job, sr_vec3 p, sr_vec3 n, uint32_t samples,
                                          uint32_t replicates);

/* ---- a gonioreflectometer: gonio.c ---- */

struct sr_gonio {
    const struct sr_scene *scene;
    uint32_t seed, samples, replicates; // samples: paths of each replicate
    int threads;                        // 0: all processors
};

/* Parallel light on a patch of a specimen that lies in the plane z = 0, its normal +z. The patch is where the beam
 * crosses the plane above all of the specimen; the specimen must reach beyond what it lights. */
struct sr_gonio_beam {
    double x0, x1, y0, y1; // [m]
    float theta_i, phi_i;  // [rad] where the light comes from
    bool is_isotropic;     // averaged over all azimuths of the specimen; cells over 0 … pi of the difference
    uint32_t theta_count, phi_count; // cells of the hemisphere, even in both angles
    float lambda[SR_LAMBDA_COUNT];   // [nm]
    uint32_t stream;                 // which random numbers
};
struct sr_gonio_scatter {
    size_t cells;
    const double *f, *f_error; // [1/sr] (theta * phi_count + phi) * SR_LAMBDA_COUNT
    double reflected[SR_LAMBDA_COUNT],
        reflected_error[SR_LAMBDA_COUNT]; // [1] of what arrives, into the upper hemisphere
    double transmitted[SR_LAMBDA_COUNT];  // [1] into the lower one
    double missed;                        // [1] of the beam that met nothing
};
sr_status sr_gonio_scatter(const struct sr_gonio *g, const struct sr_gonio_beam *beam, struct sr_arena *arena,
                           struct sr_gonio_scatter *out, struct sr_error *error);

/* The film as an image: R G B, and with error bars SE.R SE.G SE.B, samples, and the auxiliary channels if it has them.
 * Luminance-like channels are in cd/m^2. */
sr_status sr_render_image(const struct sr_film *film, bool with_error, bool is_replicated, struct sr_image **image,
                          struct sr_error *error);

#endif
