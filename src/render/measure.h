/* SPDX-License-Identifier: MIT */
/* What the files that measure share: sums of samples, replicate by replicate. */
#ifndef SR_RENDER_MEASURE_H
#define SR_RENDER_MEASURE_H

#include "render/render.h"

/* Of one sample, and sums of them: the systems, then X and Z (Y is the photopic one), then the bins of a spectrum. */
enum { MEASURE_X = SR_SYSTEM_COUNT, MEASURE_Z, MEASURE_BINS };

struct measure_sums {
    uint64_t samples, hits, dropped; // hits: samples that found light; dropped: not finite
    double largest, least, total;    // of |sample| in the system that is looked at
    double *channels;                // of each replicate
};

struct measuring {
    const struct sr_render_job *job;
    const struct sr_meter *meter;
    const struct sr_measure_settings *settings;
    uint32_t replicates, channels;
    uint32_t stream, round;                            // which random numbers
    uint32_t cell;                                     // of a map; UINT32_MAX: no map
    enum { AIM_NEVER, AIM_AT_DELTAS, AIM_AT_ALL } aim; // from the meter straight at lights
    struct sr_lambda_range lambda; // [nm] the job's, and what the spectrometer's outer bins reach beyond it
};

/* One sample: adds to channels; what it was in the system that is looked at. false: not finite, and not added. */
bool measure_sample(const struct measuring *m, uint32_t replicate, uint32_t sample, struct sr_worker *worker,
                    double *channels, double *looked_at, bool *is_hit);
/* Adds what arrives at a path's wavelengths to channels; false: not finite, and not added. */
bool measure_add(const struct measuring *m, sr_spectrum X, const struct sr_wavelengths *w, double *channels,
                 double *looked_at);
/* Where a meter stands is known to a micrometre or, in scenes smaller than that allows, to eight roundings of their
 * size: a surface there may be on its other side. (A ground to the horizon is no size to go by.) */
static inline void measure_settle(const struct sr_scene *scene, struct sr_meter_place *at)
{
    float off = sr_min(1e-6f, 0x1p-21f * sr_max_component(sr_box_diagonal(sr_scene_bounds(scene)))); // [m]
    at->x.p_error = sr_add(at->x.p_error, (sr_vec3){off, off, off});
}
/* Where that sample is taken; false: nowhere. */
bool measure_place(const struct measuring *m, uint32_t replicate, uint32_t sample, struct sr_meter_place *at);
/* Adds samples [begin, end) of a replicate; false: cancelled, the sums are of no use. */
bool measure_run(const struct measuring *m, uint32_t replicate, uint64_t begin, uint64_t end,
                 struct measure_sums *sums);
bool measure_is_cancelled(const struct sr_render_job *job);
/* Settles what all samples have in common. */
void measure_prepare(struct measuring *m);

/* The reading without chance, by cubature: fills in all but what has been cleared. */
sr_status measure_by_quadrature(const struct measuring *m, struct sr_measurement *out, struct sr_error *error);

/* What there is to say about a finished measurement; where nothing has been found, readings become bounds. */
void measure_remarks(const struct measuring *m, struct sr_measurement *out);

#endif
