/* SPDX-License-Identifier: MIT */
/* Maps: every cell of a rectangle is measured by itself, with its own random numbers and its own error. On a shape,
 * points are drawn by area and sorted into cells by their texture coordinates:
 *
 *     E_c = SUM over points in c of weight E / SUM of weight,    of each replicate */
#include "render/measure.h"

enum { CELL_SAMPLES = 1024, CELL_REPLICATES = 16, MOST_REPLICATES = 256 };

struct mapping {
    struct measuring m;
    uint64_t n; // samples of each replicate
    struct sr_image *image;
};

static void store(const struct mapping *map, uint64_t cell, const struct sr_tally *tally)
{
    // rows of an image go down, v goes up
    uint32_t x = (uint32_t)cell % map->image->width, y = map->image->height - 1 - (uint32_t)cell / map->image->width;
    float *pixel = map->image->floats + sr_image_index(map->image, x, y);
    pixel[0] = (float)tally->mean;
    pixel[1] = (float)sr_tally_standard_error(tally);
}

/* ---- cell by cell ---- */

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
    store(map, cell, &tally);
}

/* ---- by texture coordinates ---- */

struct cell {
    double sum, weight;
};
struct scattering {
    const struct mapping *map;
    uint64_t cells, n; // n: points of each replicate
    struct cell *of;   // of replicate r: of[r * cells + c]
};

static void scatter(void *context, uint64_t r)
{
    const struct scattering *s = context;
    const struct measuring *m = &s->map->m;
    struct sr_worker worker = {0};
    for (uint64_t i = 0; i < s->n; ++i) {
        double channels[MEASURE_BINS] = {0}, looked_at;
        bool is_hit;
        struct sr_meter_place at;
        if ((i & 63) == 0 && measure_is_cancelled(m->job))
            return;
        uint32_t c = measure_place(m, (uint32_t)r, (uint32_t)i, &at) ? m->meter->model->cell_of(m->meter->self, &at)
                                                                     : UINT32_MAX;
        if (c == UINT32_MAX || !measure_sample(m, (uint32_t)r, (uint32_t)i, &worker, channels, &looked_at, &is_hit))
            continue;
        struct cell *cell = &s->of[r * s->cells + c];
        cell->sum += channels[m->settings->system];
        cell->weight += (double)at.weight;
    }
}

static sr_status scatter_all(const struct mapping *map, struct sr_error *error)
{
    uint32_t R = map->m.replicates;
    struct scattering s = {.map = map, .cells = (uint64_t)map->image->width * map->image->height};
    double n = (double)map->n * (double)s.cells;
    s.n = n < 0x1p31 ? (uint64_t)n : (uint64_t)1 << 31;
    struct sr_arena arena = {0};
    if (!(s.of = sr_arena_alloc(&arena, s.cells * R * sizeof *s.of)))
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u replicates of a map of %u x %u cells", R,
                       map->image->width, map->image->height);
    sr_parallel_for(map->m.job->threads > 0 ? map->m.job->threads : sr_thread_count(), R, scatter, &s);
    for (uint64_t c = 0; c < s.cells; ++c) {
        struct sr_tally tally = {0};
        for (uint32_t r = 0; r < R; ++r)
            if (s.of[r * s.cells + c].weight > 0)
                sr_tally_add(&tally, s.of[r * s.cells + c].sum / s.of[r * s.cells + c].weight);
        if (tally.n > 1)
            store(map, c, &tally);
    }
    sr_arena_free(&arena);
    return SR_OK;
}

/* ---- the whole ---- */

sr_status sr_measure_map(const struct sr_render_job *job, const struct sr_meter *meter,
                         const struct sr_measure_settings *settings, struct sr_image **image, struct sr_error *error)
{
    struct sr_measure_settings s = *settings;
    s.replicates = s.replicates ? s.replicates : CELL_REPLICATES;
    s.samples = s.samples ? s.samples : CELL_SAMPLES;
    s.spectrometer.count = 0;
    *image = NULL;
    if (!meter->model->raster || meter->model->far)
        return sr_fail(error, SR_ERROR_USAGE, "a meter of kind %s makes no map", meter->model->name);
    if (job->integrator.model == &sr_integrator_quadrature)
        return sr_fail(error, SR_ERROR_USAGE,
                       "the estimator quadrature reads meters at a point, and a map is a mean over cells; use path");
    if (s.replicates < 2 || s.replicates > MOST_REPLICATES)
        return sr_fail(error, SR_ERROR_USAGE, "%u replicates: expected 2 to %d", (unsigned)s.replicates,
                       MOST_REPLICATES);
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
        .m = {.cell = UINT32_MAX,
              .job = job,
              .meter = meter,
              .settings = &s,
              .replicates = s.replicates,
              .channels = MEASURE_BINS,
              .stream = s.stream << 26,
              .lambda = job->lambda},
        .n = (s.samples + s.replicates - 1) / s.replicates,
        .image = made,
    };
    measure_prepare(&map.m);
    for (uint64_t i = 0; i < 2 * (uint64_t)width * height; ++i)
        made->floats[i] = NAN; // until measured
    if (!sr_meter_common(meter)->surface_name) {
        sr_parallel_for(job->threads > 0 ? job->threads : sr_thread_count(), (uint64_t)width * height, measure_cell,
                        &map);
    } else if (scatter_all(&map, error) != SR_OK) {
        sr_image_free(made);
        return error->status;
    }
    *image = made;
    return measure_is_cancelled(job) ? SR_CANCELLED : SR_OK;
}
