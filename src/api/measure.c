/* SPDX-License-Identifier: MIT */
/* The public side of meters: it checks the arguments and calls render. */
#include <steradian/world.h>

#include "api/private.h"

#include <stdio.h>
#include <string.h>

size_t sr_world_meter_count(const struct sr_world *world)
{
    return world->import.meter_count;
}

bool sr_world_meter(const struct sr_world *world, size_t index, struct sr_world_meter *out)
{
    *out = (struct sr_world_meter){0};
    if (index >= world->import.meter_count)
        return false;
    const struct sr_meter *m = &world->import.meters[index];
    *out = (struct sr_world_meter){.name = sr_meter_common(m)->name,
                                   .kind = m->model->name,
                                   .quantity = m->model->what,
                                   .definition = m->model->law};
    if (m->model->raster)
        m->model->raster(m->self, &out->width, &out->height);
    return true;
}

static sr_status settle(const struct sr_world *world, size_t index, const struct sr_measure_options *o,
                        struct sr_render_job *job, struct sr_measure_settings *s, struct sr_error *error)
{
    *job = sr_render_job_of(&world->import);
    job->seed = o->has_seed ? o->seed : job->seed;
    *s = (struct sr_measure_settings){.samples = o->samples,
                                      .replicates = o->replicates,
                                      .error = o->error,
                                      .time_s = o->time_s,
                                      .system = o->system,
                                      .stream = (uint32_t)index};
    if (index >= world->import.meter_count)
        return sr_fail(error, SR_ERROR_USAGE, "there is no meter %zu: the scene has %u, numbered from 0", index,
                       (unsigned)world->import.meter_count);
    if ((unsigned)o->system >= SR_SYSTEM_COUNT)
        return sr_fail(error, SR_ERROR_USAGE, "there is no system %d", (int)o->system);
    if (api_settle(job, o->threads, o->lambda_min_nm, o->lambda_max_nm, error) != SR_OK || o->spectrum_count == 0)
        return error->status;
    double last = o->spectrum_first_nm + o->spectrum_step_nm * ((double)o->spectrum_count - 1);
    if (!o->spectrum)
        return sr_fail(error, SR_ERROR_USAGE, "a spectrum of %zu readings needs room for them", o->spectrum_count);
    if (!(o->spectrum_fwhm_nm >= 0 && o->spectrum_fwhm_nm <= 1000))
        return sr_fail(error, SR_ERROR_USAGE, "a bandpass of %g nm: 0, for the step, to 1000 was expected",
                       o->spectrum_fwhm_nm);
    if (sr_spectrometer_prepare(o->spectrum_first_nm, o->spectrum_step_nm, last,
                                o->spectrum_fwhm_nm > 0 ? o->spectrum_fwhm_nm : NAN, SR_BAND_TRIANGULAR,
                                &s->spectrometer, error) == SR_ERROR_INPUT)
        error->status = SR_ERROR_USAGE; // the wavelengths are the caller's, of no file
    return error->status;
}

sr_status sr_world_measure(const struct sr_world *world, size_t index, const struct sr_measure_options *options,
                           struct sr_world_reading *reading, char *error, size_t error_size)
{
    static const struct sr_measure_options defaults;
    const struct sr_measure_options *o = options ? options : &defaults;
    struct sr_error e = {0};
    struct sr_render_job job;
    struct sr_measure_settings s;
    struct sr_measurement m;
    struct sr_arena arena = {0};
    memset(reading, 0, sizeof *reading);
    if (settle(world, index, o, &job, &s, &e) == SR_OK &&
        sr_measure(&job, &world->import.meters[index], &s, &arena, &m, &e) == SR_OK) {
        memcpy(reading->value, m.value, sizeof reading->value);
        reading->samples = m.samples;
        reading->samples_with_light = m.hits;
        reading->elapsed_s = m.elapsed_s;
        reading->is_on_target = m.is_on_target;
        size_t used = 0;
        for (uint32_t i = 0; i < m.remark_count && used < sizeof reading->remarks; ++i)
            used += (size_t)snprintf(reading->remarks + used, sizeof reading->remarks - used, "%s%s", i ? "\n" : "",
                                     m.remarks[i]);
        for (uint32_t k = 0; k < s.spectrometer.count && k < o->spectrum_count; ++k)
            o->spectrum[k] = m.spectrum[k];
    }
    sr_arena_free(&arena);
    return api_tell(&e, error, error_size);
}

sr_status sr_world_measure_map(const struct sr_world *world, size_t index, const struct sr_measure_options *options,
                               struct sr_picture **picture, char *error, size_t error_size)
{
    static const struct sr_measure_options defaults;
    struct sr_error e = {0};
    struct sr_render_job job;
    struct sr_measure_settings s;
    struct sr_image *image;
    *picture = NULL;
    if (options && options->spectrum_count > 0)
        sr_fail(&e, SR_ERROR_USAGE, "a map holds no spectra: spectrum_count of 0 was expected");
    else if (settle(world, index, options ? options : &defaults, &job, &s, &e) == SR_OK &&
             sr_measure_map(&job, &world->import.meters[index], &s, &image, &e) == SR_OK)
        api_wrap_image(image, picture, &e);
    return api_tell(&e, error, error_size);
}
