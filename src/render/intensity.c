/* SPDX-License-Identifier: MIT */
/* The virtual goniophotometer: what leaves the scene, sorted by direction.
 *
 *     I(cell) = flux that leaves into the cell / its solid angle          [cd] or [W/sr], with the spread of replicates
 *
 * Rays that leave a source without touching anything count as all others. Limits: a sky is no luminaire, its light
 * crosses the scene: refused. */
#include "render/measure.h"

enum { DEFAULT_REPLICATES = 16, DEFAULT_SAMPLES = 1 << 20 };

struct sorting {
    const struct sr_render_job *job;
    const struct sr_meter *meter;
    enum sr_system system;
    uint64_t n; // particles of each replicate
    uint32_t cells, stream;
    double *sums; // of replicate r, cell k: sums[r * cells + k]
};

struct sorted {
    const struct sorting *s;
    double *sums;
};

static void leave(void *user, enum sr_particle_event event, const struct sr_hit *hit, sr_vec3 d, sr_spectrum flux,
                  const struct sr_wavelengths *w)
{
    (void)hit;
    const struct sorted *to = user;
    double readings[SR_SYSTEM_COUNT];
    if (event != SR_PARTICLE_ESCAPED)
        return;
    sr_observe(flux, w, readings);
    double value = readings[to->s->system];
    if (isfinite(value))
        to->sums[to->s->meter->model->far(to->s->meter->self, d)] += value;
}

static void run_replicate(void *context, uint64_t r)
{
    const struct sorting *s = context;
    struct sorted to = {s, s->sums + r * s->cells};
    struct sr_particle_watch watch = {leave, &to};
    struct sr_worker worker = {0};
    for (uint64_t i = 0; i < s->n && ((i & 63) || !measure_is_cancelled(s->job)); ++i) {
        struct sr_sampler sampler = sr_sampler_start(s->job->sampler, s->job->seed, UINT32_MAX - s->stream,
                                                     UINT32_MAX - 2, (uint32_t)r, (uint32_t)i);
        struct sr_wavelengths w = sr_wavelengths_sample(s->job->lambda, sr_sample4(&sampler, SR_USE_FILM)[2]);
        sr_follow_particle(s->job->scene, &sampler, &w, &watch, &worker);
    }
}

static void read_table(const struct sorting *s, uint32_t R, struct sr_intensity_table *out)
{
    for (uint32_t k = 0; k < s->cells; ++k) {
        double c, gamma, solid_angle = s->meter->model->cell(s->meter->self, k, &c, &gamma);
        uint32_t plane = k % out->c_count, row = k / out->c_count;
        uint32_t from = row == 0 || row == out->gamma_count - 1 ? row * out->c_count : k; // the poles are in all planes
        struct sr_tally t = {0};
        for (uint32_t r = 0; r < R; ++r)
            sr_tally_add(&t, s->sums[(size_t)r * s->cells + from] / ((double)s->n * solid_angle));
        out->c[plane] = (float)c;
        out->gamma[row] = (float)gamma;
        out->I[(size_t)plane * out->gamma_count + row] = (float)t.mean;
        out->u[(size_t)plane * out->gamma_count + row] = (float)sr_tally_standard_error(&t);
    }
    struct sr_tally all = {0};
    for (uint32_t r = 0; r < R; ++r) {
        double flux = 0;
        for (uint32_t k = 0; k < s->cells; ++k)
            flux += s->sums[(size_t)r * s->cells + k] / (double)s->n;
        sr_tally_add(&all, flux);
    }
    out->flux = sr_quantity_of_tally(&all, sr_unit_of(SR_KIND_FLUX, s->system, false));
}

sr_status sr_measure_intensity(const struct sr_render_job *job, const struct sr_meter *meter,
                               const struct sr_measure_settings *settings, struct sr_arena *arena,
                               struct sr_intensity_table *out, struct sr_error *error)
{
    uint32_t R = settings->replicates ? settings->replicates : DEFAULT_REPLICATES;
    uint64_t samples = settings->samples ? settings->samples : DEFAULT_SAMPLES;
    *out = (struct sr_intensity_table){.unit = sr_unit_of(SR_KIND_INTENSITY, settings->system, false)};
    if (!meter->model->far)
        return sr_fail(error, SR_ERROR_USAGE, "a meter of kind %s has no far field", meter->model->name);
    if (R < 2 || R > 4096 || samples / R >= UINT32_MAX)
        return sr_fail(error, SR_ERROR_USAGE, "%u replicates of %llu particles: expected 2 to 4096 of less than 2^32",
                       R, (unsigned long long)(samples / R));
    const struct sr_lights *lights = sr_scene_lights(job->scene);
    for (uint32_t i = 0; i < lights->count; ++i)
        if (lights->lights[i].model->is_infinite)
            return sr_fail(
                error, SR_ERROR_INPUT,
                "the scene has light from outside (\"%s\"), which has no intensity: a goniophotometer wants luminaires alone",
                lights->lights[i].model->name);
    meter->model->raster(meter->self, &out->c_count, &out->gamma_count);
    struct sorting s = {.job = job,
                        .meter = meter,
                        .system = settings->system,
                        .n = (samples + R - 1) / R,
                        .cells = out->c_count * out->gamma_count,
                        .stream = settings->stream};
    struct sr_arena scratch = {0};
    s.sums = sr_arena_alloc(&scratch, (size_t)R * s.cells * sizeof *s.sums);
    out->c = sr_arena_alloc(arena, out->c_count * sizeof *out->c);
    out->gamma = sr_arena_alloc(arena, out->gamma_count * sizeof *out->gamma);
    out->I = sr_arena_alloc(arena, s.cells * sizeof *out->I);
    out->u = sr_arena_alloc(arena, s.cells * sizeof *out->u);
    if (!s.sums || !out->c || !out->gamma || !out->I || !out->u) {
        sr_arena_free(&scratch);
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory for %u directions", s.cells);
    }
    sr_parallel_for(job->threads > 0 ? job->threads : sr_thread_count(), R, run_replicate, &s);
    read_table(&s, R, out);
    out->samples = s.n * R;
    sr_arena_free(&scratch);
    return measure_is_cancelled(job) ? SR_CANCELLED : SR_OK;
}
