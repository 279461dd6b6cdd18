/* SPDX-License-Identifier: MIT */
/* steradian converge: errors of a scene's picture, or of one of its meters' readings.
 *
 *     error^2 = mean over seeds of (X - R)^2 / R^2                               of a reading, R its reference
 *     error^2 = mean over seeds and pixels of (Y - R)^2 / (R^2 + 0.01 mean(R)^2)
 *         of luminances, dark pixels not overrated
 *
 * less the reference's own variance. All estimators have the same maxdepth as the reference, or they would not converge
 * to it. Pixels look through their middles, so that the edges of what is seen, which no estimator of light helps, have
 * no say. Time is that of the processors, so that what else a machine does matters little. */
#include "converge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char reference_estimator[] = "bsdf+light-solid-angle:power";

static sr_status open_scene(const struct converge_arguments *a, uint32_t width, uint32_t height,
                            struct sr_import_result *scene, struct sr_error *error)
{
    bool quiet = true;
    struct sr_log log = command_log(&quiet);
    struct sr_import_options options = a->import;
    options.width = width;
    options.height = height;
    return sr_import_pbrt(a->scene, &options, scene, &log, error);
}

/* The scene with a picture of `width` pixels, in its own shape, unless the arguments say how large. */
static sr_status open_small(const struct converge_arguments *a, uint32_t width, struct sr_import_result *scene,
                            struct sr_error *error)
{
    if (a->resolution[0] >= 1)
        return open_scene(a, (uint32_t)a->resolution[0], (uint32_t)a->resolution[1], scene, error);
    if (open_scene(a, 0, 0, scene, error) != SR_OK)
        return error->status;
    double height = (double)width * scene->film.height / scene->film.width;
    sr_import_result_free(scene);
    return open_scene(a, width, height < 1 ? 1 : (uint32_t)height, scene, error);
}

static struct sr_render_job job_of(const struct converge_arguments *a, const struct sr_import_result *scene)
{
    struct sr_render_job job = sr_render_job_of(scene);
    job.seed = (uint32_t)a->seed;
    job.jitter_pixel = false;
    job.jitter_lambda = true;
    job.threads = (int)a->threads;
    return job;
}

/* The luminances of a picture's pixels, and the variances of their means or NULL. */
static sr_status luminances(const struct sr_render_job *job, double *Y, double *variance, struct sr_error *error)
{
    struct sr_film *film;
    struct sr_render_report report;
    if (sr_render(job, &film, &report, error) != SR_OK)
        return error->status;
    const double *y_of_rgb = sr_colour_space(job->film.space)->xyz_from_rgb[1];
    for (uint32_t i = 0; i < film->width * film->height; ++i) {
        double mean[3], u[3];
        sr_film_pixel_mean(film, i % film->width, i / film->width, mean);
        Y[i] = y_of_rgb[0] * mean[0] + y_of_rgb[1] * mean[1] + y_of_rgb[2] * mean[2];
        if (variance) { // channels go together: at most the square of the sum
            sr_film_errors(film, i % film->width, i / film->width, i % film->width + 1, i / film->width + 1, false, u);
            variance[i] = pow(y_of_rgb[0] * u[0] + y_of_rgb[1] * u[1] + y_of_rgb[2] * u[2], 2);
        }
    }
    sr_film_destroy(film);
    return SR_OK;
}

/* What there is to compare with: a picture or a reading that took long. */
struct reference {
    uint32_t pixels;       // 0: a reading
    double *Y, *weight;    // of pixels: luminance, 1 / (Y^2 + 0.01 mean^2)
    double mean, variance; // variance of a reading [unit^2], of a picture relative and weighed [1]
};

static sr_status picture_error(const struct sr_render_job *base, const struct converge_arguments *a,
                               const struct reference *r, double *Y, double *error2, double *time_s,
                               struct sr_error *error)
{
    *error2 = *time_s = 0;
    for (uint64_t s = 0; s < a->seeds; ++s) {
        struct sr_render_job job = *base;
        job.seed = sr_hash_combine((uint32_t)a->seed + 1 + (uint32_t)s, job.spp);
        clock_t start = clock();
        if (luminances(&job, Y, NULL, error) != SR_OK)
            return error->status;
        double one_s = (double)(clock() - start) / CLOCKS_PER_SEC;
        for (uint32_t i = 0; i < r->pixels; ++i)
            *error2 += (Y[i] - r->Y[i]) * (Y[i] - r->Y[i]) * r->weight[i] / ((double)r->pixels * (double)a->seeds);
        *time_s += one_s / (double)a->seeds;
    }
    *error2 -= r->variance;
    return SR_OK;
}

static sr_status picture_reference(const struct sr_render_job *base, const struct converge_arguments *a,
                                   struct sr_arena *arena, struct reference *r, struct sr_error *error)
{
    struct sr_render_job job = *base;
    job.replicates = 16;
    job.spp = (uint32_t)fmin(fmax(16 * (double)a->last, 1024), 1 << 28);
    job.seed = sr_hash_combine((uint32_t)a->seed, 0x5eed);
    r->pixels = (uint32_t)((base->film.x1 - base->film.x0) * (base->film.y1 - base->film.y0));
    r->Y = sr_arena_alloc(arena, r->pixels * sizeof *r->Y);
    r->weight = sr_arena_alloc(arena, r->pixels * sizeof *r->weight);
    if (!r->Y || !r->weight)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    if (luminances(&job, r->Y, r->weight, error) != SR_OK)
        return error->status;
    for (uint32_t i = 0; i < r->pixels; ++i)
        r->mean += r->Y[i] / r->pixels;
    for (uint32_t i = 0; i < r->pixels; ++i) {
        double variance = r->weight[i];
        r->weight[i] = 1 / (r->Y[i] * r->Y[i] + 0.01 * r->mean * r->mean);
        r->variance += variance * r->weight[i] / r->pixels;
    }
    return SR_OK;
}

static sr_status read_meter(const struct sr_render_job *job, const struct sr_meter *meter, uint64_t n, uint32_t seeds,
                            struct sr_arena *arena, struct sr_measurement *m, struct sr_error *error)
{
    struct sr_measure_settings settings = {.samples = n * seeds, .replicates = seeds, .system = SR_PHOTOPIC};
    return sr_measure(job, meter, &settings, arena, m, error);
}

static const struct sr_meter *find_meter(const struct sr_import_result *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->meter_count; ++i)
        if (strcmp(sr_meter_common(&scene->meters[i])->name, name) == 0)
            return &scene->meters[i];
    return NULL;
}

static sr_status run_series(const struct converge_arguments *a, struct sr_render_job job, const struct sr_meter *meter,
                            const struct reference *r, double *Y, struct sr_arena *arena,
                            struct converge_series *series, struct sr_error *error)
{
    for (uint64_t n = a->first; n <= a->last && series->count < SR_STUDY_POINTS; n *= a->factor, ++series->count) {
        double error2, time_s;
        if (meter) {
            struct sr_measurement m;
            job.seed = sr_hash_combine((uint32_t)a->seed + 1, (uint32_t)n);
            clock_t start = clock();
            if (read_meter(&job, meter, n, (uint32_t)a->seeds, arena, &m, error) != SR_OK)
                return error->status;
            double u = m.value[SR_PHOTOPIC].u, S = (double)a->seeds, d = m.value[SR_PHOTOPIC].value - r->mean;
            // u^2 = 1/(S (S - 1)) SUM (X_s - mean)^2
            error2 = ((S - 1) * u * u + d * d - r->variance) / (r->mean * r->mean);
            time_s = (double)(clock() - start) / CLOCKS_PER_SEC / S;
        } else {
            job.spp = (uint32_t)n;
            if (picture_error(&job, a, r, Y, &error2, &time_s, error) != SR_OK)
                return error->status;
        }
        series->n[series->count] = (double)n;
        series->error[series->count] = sqrt(fmax(error2, 0));
        series->time_s[series->count] = time_s;
    }
    return SR_OK;
}

static sr_status run_all(const struct converge_arguments *a, const struct sr_import_result *scene,
                         struct sr_arena *arena, struct converge_study *study, struct sr_error *error)
{
    struct sr_render_job job = job_of(a, scene);
    const struct sr_meter *meter = a->meter ? find_meter(scene, a->meter) : NULL;
    if (a->meter && !meter)
        return sr_fail(error, SR_ERROR_USAGE, "%s: there is no meter \"%s\"; steradian measure --list tells them",
                       a->scene, a->meter);
    struct reference r = {0};
    struct sr_integrator base = scene->integrator;
    if (a->max_depth && sr_integrator_parse(sr_arena_printf(arena, "path,maxdepth=%s", a->max_depth), &base, arena,
                                            &base, error) != SR_OK)
        return error->status;
    if (sr_integrator_parse(reference_estimator, &base, arena, &job.integrator, error) != SR_OK)
        return error->status;
    if (meter && isfinite(a->reference)) {
        r.mean = a->reference;
    } else if (meter) {
        struct sr_measurement m;
        if (read_meter(&job, meter, (uint64_t)fmax(64 * (double)a->last, 65536), 16, arena, &m, error) != SR_OK)
            return error->status;
        r.mean = m.value[SR_PHOTOPIC].value;
        r.variance = m.value[SR_PHOTOPIC].u * m.value[SR_PHOTOPIC].u;
    } else if (picture_reference(&job, a, arena, &r, error) != SR_OK) {
        return error->status;
    }
    if (!(fabs(r.mean) > 0))
        return sr_fail(error, SR_ERROR_INPUT, "%s: the reference is black, so that there is no relative error",
                       a->scene);
    study->reference = r.mean;
    study->reference_u = sqrt(r.variance) * (meter ? 1 : r.mean);
    study->unit = "1";
    study->what = sr_arena_printf(arena, "%s, %s: relative error", a->scene, meter ? a->meter : "luminance of pixels");
    double *Y =
        meter ? NULL : sr_arena_alloc(arena, (size_t)scene->film.width * (size_t)scene->film.height * sizeof *Y);
    if (!meter && !Y)
        return sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
    for (int e = 0; e < a->estimator_count; ++e) {
        if (sr_integrator_parse(a->estimators[e], &base, arena, &job.integrator, error) != SR_OK)
            return error->status;
        const char *blind = sr_integrator_blind(&job.integrator, scene->scene);
        if (blind) {
            fprintf(stderr, "warning: %s is left out: %s\n", a->estimators[e], blind);
            continue;
        }
        for (int sampler = 0; sampler < 2; ++sampler) {
            if (!a->samplers[sampler])
                continue;
            struct converge_series *series = &study->series[study->series_count++];
            series->estimator = a->estimators[e];
            series->sampler = job.sampler = (enum sr_sampler_kind)sampler;
            if (run_series(a, job, meter, &r, Y, arena, series, error) != SR_OK)
                return error->status;
        }
    }
    return study->series_count ? SR_OK : sr_fail(error, SR_ERROR_USAGE, "no estimator is left");
}

int converge_scene(const struct converge_arguments *a, struct converge_study *study, struct sr_arena *arena)
{
    struct sr_error error = {0};
    struct sr_import_result scene;
    if (open_small(a, 32, &scene, &error) != SR_OK)
        return command_fail("converge", &error);
    run_all(a, &scene, arena, study, &error);
    sr_import_result_free(&scene);
    return error.status ? command_fail("converge", &error) : 0;
}

/* ---- the strip ---- */

static sr_status strip_picture(const struct sr_render_job *job, float *exposure_EV, struct sr_arena *arena,
                               struct sr_plot_panel *panel, struct sr_error *error)
{
    struct sr_film *film;
    struct sr_render_report report;
    struct sr_image *image = NULL;
    if (sr_render(job, &film, &report, error) != SR_OK)
        return error->status;
    if (sr_render_image(film, false, false, &image, error) == SR_OK) {
        if (isnan(*exposure_EV))
            *exposure_EV = sr_image_auto_exposure(image);
        struct sr_image *mapped;
        struct sr_tone tone = {.op = SR_TONE_LINEAR, .exposure_EV = *exposure_EV};
        if (sr_image_tone_map(image, &tone, &mapped, error) == SR_OK) {
            size_t count = (size_t)mapped->width * mapped->height;
            uint8_t *pixels = sr_arena_alloc(arena, 3 * count);
            for (size_t i = 0; pixels && i < 3 * count; ++i)
                pixels[i] = mapped->bytes[i / 3 * mapped->channel_count + i % 3];
            *panel = (struct sr_plot_panel){
                .kind = SR_PLOT_PICTURE, .pixels = pixels, .rows = mapped->height, .columns = mapped->width};
            if (!pixels)
                sr_fail(error, SR_ERROR_RESOURCE, "not enough memory");
            sr_image_free(mapped);
        }
        sr_image_free(image);
    }
    sr_film_destroy(film);
    return error->status;
}

int converge_strip(const struct converge_arguments *a, struct sr_arena *arena)
{
    struct sr_error error = {0};
    struct sr_import_result scene;
    struct converge_arguments whole = *a;
    whole.resolution[0] = whole.resolution[1] = 0;
    if (open_small(&whole, 240, &scene, &error) != SR_OK)
        return command_fail("converge", &error);
    struct sr_render_job job = job_of(a, &scene);
    job.jitter_pixel = true;
    job.spp = (uint32_t)a->strip_spp;
    struct sr_integrator base = scene.integrator;
    if (a->max_depth)
        sr_integrator_parse(sr_arena_printf(arena, "path,maxdepth=%s", a->max_depth), &base, arena, &base, &error);
    struct sr_plot_panel panels[CONVERGE_ESTIMATORS];
    uint32_t count = 0;
    float exposure_EV = NAN;
    // the exposure of the last one, which is the best by custom, serves all
    for (int e = a->estimator_count - 1; e >= 0 && !error.status; --e)
        if (sr_integrator_parse(a->estimators[e], &base, arena, &job.integrator, &error) == SR_OK &&
            strip_picture(&job, &exposure_EV, arena, &panels[e], &error) == SR_OK) {
            panels[e].title = a->estimators[e];
            ++count;
        }
    double aspect = (double)scene.film.height / scene.film.width;
    sr_import_result_free(&scene);
    char title[64];
    snprintf(title, sizeof title, "%llu samples for each pixel", (unsigned long long)a->strip_spp);
    uint32_t columns = count < 5 ? count : 5, rows = columns ? (count + columns - 1) / columns : 1;
    struct sr_plot_figure figure = {.title = title,
                                    .panels = panels,
                                    .panel_count = count,
                                    .columns = columns,
                                    .width = 290.0 * columns,
                                    .height = 60 + rows * (290 * aspect + 50)};
    if (!error.status)
        sr_plot_write(&figure, a->strip, &error);
    return error.status ? command_fail("converge", &error) : 0;
}
