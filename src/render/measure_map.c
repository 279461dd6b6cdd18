/* SPDX-License-Identifier: MIT */
/* Maps: every cell is measured by itself, with its own random numbers and its own error. */
#include "render/measure.h"

enum { CELL_SAMPLES = 1024, CELL_REPLICATES = 16, MOST_REPLICATES = 256 };

struct mapping {
    struct measuring m;
    uint64_t n; // samples of each replicate
    struct sr_image *image;
};

static void measure_cell(void *context, uint64_t cell)
{
    const struct mapping *map = context;
    struct measuring m = map->m;
    m.cell = (uint32_t)cell;
    m.stream = (uint32_t)cell ^ map->m.stream;
    struct sr_tally tally = {0};
    for (uint32_t r = 0; r < m.replicates; ++r) {
        double channels[MEASURE_BINS] = {0};
        struct measure_sums sums = {.channels = channels};
        if (measure_is_cancelled(m.job) || !measure_run(&m, r, 0, map->n, &sums))
            return;
        sr_tally_add(&tally, channels[m.settings->system] / (double)map->n);
    }
    // rows of an image go down, v goes up
    uint32_t x = (uint32_t)cell % map->image->width, y = map->image->height - 1 - (uint32_t)cell / map->image->width;
    float *pixel = map->image->floats + sr_image_index(map->image, x, y);
    pixel[0] = (float)tally.mean;
    pixel[1] = (float)sr_tally_standard_error(&tally);
}

sr_status sr_measure_map(const struct sr_render_job *job, const struct sr_meter *meter, const struct sr_measure_settings *settings, struct sr_image **image,
                         struct sr_error *error)
{
    struct sr_measure_settings s = *settings;
    s.replicates = s.replicates ? s.replicates : CELL_REPLICATES;
    s.samples = s.samples ? s.samples : CELL_SAMPLES;
    s.spectrometer.count = 0;
    *image = NULL;
    if (!meter->model->raster || meter->model->far)
        return sr_fail(error, SR_ERROR_USAGE, "a meter of kind %s makes no map", meter->model->name);
    if (s.replicates < 2 || s.replicates > MOST_REPLICATES)
        return sr_fail(error, SR_ERROR_USAGE, "%u replicates: expected 2 to %d", (unsigned)s.replicates, MOST_REPLICATES);
    uint32_t width, height;
    meter->model->raster(meter->self, &width, &height);
    struct sr_image *made;
    static const char *const names[] = {"Y", "SE.Y"};
    if (sr_image_create(width, height, 2, names, SR_IMAGE_FLOATS, &made, error) != SR_OK)
        return error->status;
    char unit[32];
    sr_unit_text(sr_unit_of(meter->model->kind, s.system, false), unit, sizeof unit);
    sr_image_set_unit(made, 0, unit);
    sr_image_set_unit(made, 1, unit);
    struct mapping map = {
        .m = {.job = job, .meter = meter, .settings = &s, .replicates = s.replicates, .channels = MEASURE_BINS, .stream = s.stream << 26,
              .lambda = job->lambda},
        .n = (s.samples + s.replicates - 1) / s.replicates, .image = made,
    };
    measure_prepare(&map.m);
    for (uint64_t i = 0; i < 2 * (uint64_t)width * height; ++i)
        made->floats[i] = NAN; // until measured
    sr_parallel_for(job->threads > 0 ? job->threads : sr_thread_count(), (uint64_t)width * height, measure_cell, &map);
    *image = made;
    return measure_is_cancelled(job) ? SR_CANCELLED : SR_OK;
}
