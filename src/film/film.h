/* SPDX-License-Identifier: MIT */
/* What remembers: the pixel filter, the sensor's response, sums and the statistics that give error bars.
 *
 * A pixel's samples come in blocks: parts of one scrambled net (ordinary images), or independently scrambled replicates
 * (measurements). For each block only its sum is remembered, as sums of block sums and of their squares. */
#ifndef SR_FILM_FILM_H
#define SR_FILM_FILM_H

#include "math/math.h"
#include "sample/sample.h"
#include "spectrum/spectrum.h"

/* ---- pixel filters, by importance sampling: a sample's weight is constant but for its sign ---- */

struct sr_filter_model {
    const char *name;
    const struct sr_param *params;
    size_t size;
    float (*value)(const void *self, sr_vec2 p); // [1] not normalised; p from the pixel's centre [pixel]
    sr_vec2 (*radius)(const void *self);         // [pixel]
};
extern const struct sr_filter_model *const sr_filter_models[]; // ends with NULL
const struct sr_filter_model *sr_filter_model_find(const char *name);

enum { SR_FILTER_SHARES = 2048, SR_FILTER_SIGN_CHANGES = 64 };
struct sr_filter_axis {
    float position[SR_FILTER_SHARES +
                   1]; // [pixel] from the pixel's centre: between two of them lies an equal share of |f|
    float change[SR_FILTER_SIGN_CHANGES]; // [pixel] where f changes its sign
    uint32_t sign_changes;
    bool begins_negative;
};
struct sr_filter {
    const struct sr_filter_model *model;
    const void *self;
    sr_vec2 radius;                       // [pixel]
    const struct sr_filter_axis *axes[2]; // x and y, one and the same if they are equal; NULL: uniform
    float weight;                         // [1] integral |f| / integral f, as drawn
    double inverse_integral;              // [1/pixel^2] of f
};
sr_status sr_filter_prepare(struct sr_arena *arena, const struct sr_filter_model *model, const void *self,
                            struct sr_filter *out, struct sr_error *error);
/* Offset from the pixel's centre [pixel]; *weight so that the mean of weight * L is the filtered value. */
sr_vec2 sr_filter_sample(const struct sr_filter *f, sr_vec2 u, float *weight);

/* ---- settings ---- */

struct sr_film_settings {
    int32_t width, height;             // [pixel] of the whole picture
    int32_t x0, x1, y0, y1;            // [pixel] the part that is rendered: x0 <= x < x1
    enum sr_colour_space_id space;     // of the output
    float iso;                         // 100
    float exposure_time;               // [s] shutter close - open
    float white_balance;               // [K]; 0: none
    float max_component;               // infinity: no clamping; of the sensor's values, before white balance
    uint32_t camera1;                  // number from 1 of the camera whose sensor it is; 0: the CIE's observer of 1931
    uint32_t buckets;                  // of wavelengths that are kept apart; 0: none
    float lambda_min, lambda_max;      // [nm] that they share evenly
    float bucket_scale;                // of radiance as scenes have it: 1/683 gives W m^-2 sr^-1 nm^-1
    bool is_gbuffer;                   // keeps what is seen first: P, N and Ns, dzdx and dzdy
    const struct sr_motion *camera;    // of a G-buffer: camera to world, for dzdx and dzdy
    const struct sr_motion *of_points; // the same for P, N and Ns; NULL: they are in the world
    const char *filename;
};
/* Cameras by number, NULL where they end; what a sensor takes of a path; and what is made of that, fitted to a chart
 * under light of the white balance's temperature [K]. */
const char *sr_film_camera_name(int i);
void sr_film_camera_values(uint32_t camera1, sr_spectrum L, const struct sr_wavelengths *w, float values[3]);
void sr_film_camera_matrix(uint32_t camera1, double T, enum sr_colour_space_id space, double xyz_from_camera[3][3]);
/* RGB of the output space from XYZ of the path, or from the camera's values: white balance and imaging ratio =
 * exposure_time * iso / 100 included. */
void sr_film_response(const struct sr_film_settings *s, float rgb_from_xyz[3][3]);
double sr_film_imaging_ratio(const struct sr_film_settings *s); // [1]
bool sr_film_is_radiance(const struct sr_film_settings *s);     // whether that is 1
/* Whether the picture's values are luminances [cd/m^2]: of the CIE's observer, not exposed, balanced or limited. */
bool sr_film_is_luminance(const struct sr_film_settings *s);

/* ---- a film ---- */

/* What a sample's first surface was, for the auxiliary channels. */
struct sr_first_hit {
    bool is_hit;
    float albedo[3];           // [1] RGB in the output space
    sr_vec3 n, ns, p;          // [1] [1] [m]
    float depth;               // [m] distance along the ray
    sr_vec2 uv;                // [1]
    uint32_t material, object; // numbers, from 1; 0: none
    float dzdx, dzdy;          // [m] change of the depth along the camera's axis, of a G-buffer
    float rgb[3];              // of the sample, for a G-buffer's variance
};

/* One pixel's sums while a block is being made, owned by a worker. */
struct sr_film_block {
    double rgb[3];
    uint32_t n;                    // samples taken, dropped ones included
    uint32_t dropped;              // samples that were not finite: counted as zero
    float largest;                 // R + G + B of the brightest sample
    struct sr_first_hit first_sum; // sums of the continuous members
    uint32_t hits, samples_seen;
    double square[3]; // of rgb over hits
};

struct sr_film_pixel {
    double sum[3];    // of all samples
    double square[3]; // sum over blocks of (block sum)^2 / (samples of the block)
    uint32_t n, blocks, dropped;
    float largest; // R + G + B of the brightest sample
};

/* ---- splats: light that paths from the lights bring to any place of the picture ----
 *
 * Sums are integers of 128 bits, so that they do not depend on the order in which threads add to them; each pixel has
 * one for each channel and group of paths. A value beyond 2^95 units is dropped and counted: 2^32 splats of a pixel
 * cannot overflow. docs/decisions/0011-splats.md */
enum { SR_SPLAT_GROUPS = 16 }; // at most; independent replicates beyond them share a group
struct sr_film_splats {
    uint32_t groups;                 // 2 or more: their spread tells the error
    double unit;                     // [the picture's] of the sums: a power of two
    uint64_t *words;                 // [pixel][channel][group][low, high]
    uint64_t paths[SR_SPLAT_GROUPS]; // begun at the lights, of each group
    uint64_t dropped;                // values that were not finite or too large
};

struct sr_film {
    struct sr_film_settings settings;
    uint32_t width, height;        // of the rendered part
    struct sr_film_pixel *pixels;  // width * height
    struct sr_film_splats *splats; // NULL: none
    bool has_aov;
    struct sr_film_aov {
        float albedo[3], n[3], ns[3], p[3], depth, uv[2]; // sums over hits
        uint32_t hits, n_samples;
        uint32_t material, object;
        float dzdx, dzdy;
        double rgb[3], square[3]; // sums over hits
    } * aov;
    double *buckets; // [pixel][bucket] sums, or NULL
};
void sr_film_store_buckets(struct sr_film *film, uint32_t x, uint32_t y, const double *buckets);
/* Mean over the bucket of the radiance, times bucket_scale and the imaging ratio. */
double sr_film_bucket(const struct sr_film *film, uint32_t x, uint32_t y, uint32_t bucket);
sr_status sr_film_create(const struct sr_film_settings *settings, bool with_aov, struct sr_film **out,
                         struct sr_error *error);
void sr_film_destroy(struct sr_film *film);
void sr_film_block_add(struct sr_film_block *b, const float rgb[3], bool is_finite);
void sr_film_block_add_first(struct sr_film_block *b, const struct sr_first_hit *h);
/* Adds b's samples, which come after a's. Sums are taken along a fixed tree of sample numbers, so that they do not
 * depend on who made which samples (docs/decisions/0018-sums-over-a-tree.md). */
void sr_film_block_join(struct sr_film_block *a, const struct sr_film_block *b);
void sr_film_store(struct sr_film *film, uint32_t x, uint32_t y,
                   const struct sr_film_block *b); // x, y in the rendered part

/* Makes room for splats; [B] for each pixel, to be known before. */
sr_status sr_film_add_splats(struct sr_film *film, uint32_t groups, double unit, struct sr_error *error);
size_t sr_film_splats_B(uint32_t groups);
/* rgb is what the mean over all places of the whole picture's raster would be multiplied by the filter there: each
 * pixel whose filter reaches `raster` gains f rgb, and a pixel's value is the mean over paths. Threads may call it at
 * the same time. */
void sr_film_splat(struct sr_film *film, const struct sr_filter *filter, uint32_t group, sr_vec2 raster,
                   const float rgb[3]);
void sr_film_splat_paths(struct sr_film *film, uint32_t group, uint64_t paths); // so many paths have been begun
/* All sums that are not 0, as bytes that another film can add; then they are 0. NULL: no memory. */
uint8_t *sr_film_splats_pack(struct sr_film *film, size_t *size);
bool sr_film_splats_add(struct sr_film *film, const uint8_t *bytes, size_t size); // false: these are no such bytes
double sr_film_splat_mean(const struct sr_film *film, size_t pixel, int channel);
/* Variance of the mean of w . rgb over the pixels x0 <= x < x1, y0 <= y < y1, summed: paths splat neighbours together.
 */
double sr_film_splat_variance(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1,
                              const double w[3]);

void sr_film_pixel_mean(const struct sr_film *film, uint32_t x, uint32_t y, double mean[3]);
/* The standard errors of the means of the pixels x0 <= x < x1, y0 <= y < y1, [y - y0][x - x0][3]. Ordinary images: the
 * spread of the blocks, pooled over 5 x 5 pixels, conservative; measurements (replicates): of the pixel's own blocks,
 * Student with blocks - 1 degrees. */
void sr_film_errors(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, bool pooled,
                    double *standard_error);
/* Makes a the picture of two halves of independent blocks, (mean a + mean b) / 2 for each pixel whatever their numbers
 * of samples, with the error and the degrees of freedom of that mean. Where one of them has no samples the other one's
 * mean stands. */
void sr_film_join_halves(struct sr_film *a, const struct sr_film *b);
/* Root mean square of the pixels' standard errors over the mean, of a linear form w . rgb [1]; blocks are replicates.
 */
double sr_film_relative_error(const struct sr_film *film, const double w[3]);

/* How many pixels' errors are not to be trusted, as one sample brings more than 5 % of the light, or 16 times its due
 * where that is more: the next such sample may not have come. Pixels that have fewer than 16 samples are not judged. */
uint64_t sr_film_doubtful_pixels(const struct sr_film *film);

/* Mean over a rectangle of pixels of a linear form (w . rgb), with its standard error and degrees of freedom. Pixels
 * are independent, so their variances add. */
struct sr_film_mean {
    double mean, standard_error, degrees;
};
struct sr_film_mean sr_film_region_mean(const struct sr_film *film, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1,
                                        const double w[3]);

#endif
