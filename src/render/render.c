/* SPDX-License-Identifier: MIT */
/* Jobs: what can be rendered, and whole pictures or parts of their samples from one pass. */
#include "import/import.h"
#include "render/private.h"

// MOST_AT_ONCE: of a pixel with splats, which come in together: a render that is to end waits for so many samples
enum { ORDINARY_BLOCKS = 4, MOST_AT_ONCE = 8192 };

struct sr_render_job sr_render_job_of(const struct sr_import_result *scene)
{
    return (struct sr_render_job){
        .scene = scene->scene,
        .origin = {scene->origin[0], scene->origin[1], scene->origin[2]},
        .sensor = scene->sensor,
        .filter = scene->filter,
        .integrator = scene->integrator,
        .film = scene->film,
        .sampler = scene->sampler,
        .seed = scene->seed,
        .spp = scene->spp,
        .lambda = {SR_LAMBDA_MIN, SR_LAMBDA_MAX},
        .jitter_pixel = scene->jitter_pixel,
        .jitter_lambda = scene->jitter_lambda,
    };
}

/* Whether paths from the lights bring light to any place of the picture. */
static bool has_splats(const struct sr_render_job *job)
{
    return job->integrator.model->splats && job->sensor.model->connect && !job->film.buckets;
}

/* The unit of splats: 2^-60 or so of the picture's values if all that the lights emit went evenly through the scene's
 * bounds, so that lights twice as bright make sums of the same bits. A splat is its value's share of all pixels, 2^-20
 * of it in a megapixel: what is 2^-30 as bright keeps ten bits, what is 2^55 as bright still fits. */
static double splat_unit(const struct sr_render_job *job)
{
    struct sr_box box = sr_scene_bounds(job->scene);
    double diagonal = (double)sr_length(sr_sub(box.hi, box.lo));
    double ratio = sr_film_imaging_ratio(&job->film);
    double value = sr_lights_emitted(sr_scene_lights(job->scene)) / (diagonal * diagonal) * ratio;
    return value > 0x1p-900 && value < 0x1p900 ? ldexp(1, ilogb(value) - 60) : 0x1p-56;
}

static sr_status add_splats(const struct sr_render_job *job, struct sr_film *film, uint32_t blocks,
                            struct sr_error *error)
{
    return has_splats(job) ? sr_film_add_splats(film, blocks, splat_unit(job), error) : SR_OK;
}

/* What cannot be rendered. */
static sr_status check(const struct sr_render_job *job, struct sr_error *error)
{
    if (job->spp < 1 || job->spp > 1u << 30)
        return sr_fail(error, SR_ERROR_USAGE, "%u samples per pixel: 1 to 2^30 were expected", job->spp);
    if (job->integrator.model == &sr_integrator_quadrature)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "the estimator quadrature reads meters and makes no pictures: a pixel is an integral of more than two "
            "dimensions; use path");
    if (job->integrator.model->splat && !job->sensor.model->connect)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "the estimator %s needs to know which ray of the sensor meets a given point, and the sensor %s cannot say; use path or bdpt",
            job->integrator.model->name, job->sensor.model->name);
    if (job->integrator.model->splat && job->film.buckets)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "the estimator %s brings light to the picture as colours, which a film of spectra cannot take; use path or bdpt",
            job->integrator.model->name);
    if (job->adaptive.is_on && (has_splats(job) || job->integrator.model->begin))
        return sr_fail(
            error, SR_ERROR_USAGE,
            "the estimator %s works on the whole picture at a time, and cannot spend samples on some pixels alone",
            job->integrator.model->name);
    if (!job->adaptive.is_on && (job->replicates == 1 || (job->replicates && job->spp % job->replicates != 0)))
        return sr_fail(error, SR_ERROR_USAGE,
                       "%u samples per pixel cannot be split into %u replicates of equal size (2 or more)", job->spp,
                       job->replicates);
    return SR_OK;
}

static struct sr_render_pass pass_of(const struct sr_render_job *job)
{
    uint32_t blocks = ORDINARY_BLOCKS;
    // where samples of a number share something over the whole picture, all pixels take them one after the other
    if (job->spp < ORDINARY_BLOCKS || job->integrator.model->by_turns)
        blocks = job->spp;
    else if (has_splats(job) && job->spp / ORDINARY_BLOCKS > MOST_AT_ONCE)
        blocks = job->spp / MOST_AT_ONCE;
    return (struct sr_render_pass){.share_end = 1,
                                   .blocks = job->replicates ? job->replicates : blocks,
                                   .per_replicate = job->replicates ? job->spp / job->replicates : 0};
}

static void count_lost_splats(const struct sr_film *film, struct sr_render_report *report)
{
    report->dropped += film->splats ? film->splats->dropped : 0;
}

sr_status sr_render(const struct sr_render_job *wanted, struct sr_film **film, struct sr_render_report *report,
                    struct sr_error *error)
{
    struct sr_render_job own = *wanted, *job = &own;
    own.with_aov |= own.film.is_gbuffer;
    *film = NULL;
    *report = (struct sr_render_report){0};
    if (check(job, error) != SR_OK)
        return error->status;
    if (job->crew && job->crew->meet(job->crew->self, error) != SR_OK)
        return error->status;
    if (job->adaptive.is_on)
        return sr_render_adaptive(job, film, report, error);
    if (sr_crew_film_create(job, film, error) != SR_OK)
        return error->status;
    struct sr_render_pass pass = pass_of(job);
    struct sr_keeper keeper = {.keep = job->keep, .films = {*film}, .film_count = 1};
    pass.film = *film;
    pass.keeper = &keeper;
    sr_status status = add_splats(job, *film, pass.blocks, error);
    if (status == SR_OK)
        status = sr_keeper_resume(&keeper, report, error);
    if (status == SR_OK)
        status = sr_crew_share_keeper(job, &keeper, error);
    pass.start_s = sr_clock_s() - report->render_s;
    if (status == SR_OK && !keeper.is_complete)
        status = sr_render_pass(job, &pass, report, error);
    sr_keeper_end(&keeper, report);
    if (!keeper.is_complete) // else they have been counted
        count_lost_splats(*film, report);
    if (status != SR_OK && status != SR_CANCELLED) {
        sr_film_destroy(*film);
        *film = NULL;
    }
    return status;
}

double sr_render_samples_B(const struct sr_render_job *job, struct sr_render_range range)
{
    return (double)sr_part_nodes(job->spp, pass_of(job).blocks, range) * (double)sr_part_node_B(job);
}

sr_status sr_render_samples(const struct sr_render_job *wanted, struct sr_render_range range,
                            struct sr_render_part **part, struct sr_render_report *report, struct sr_error *error)
{
    struct sr_render_job own = *wanted, *job = &own;
    own.with_aov |= own.film.is_gbuffer;
    *part = NULL;
    *report = (struct sr_render_report){0};
    if (check(job, error) != SR_OK)
        return error->status;
    if (job->adaptive.is_on)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "adaptive sampling decides by the values of all samples which ones follow: its pictures cannot be made in parts");
    if (job->crew)
        return sr_fail(
            error, SR_ERROR_USAGE,
            "a range of samples is made by one process: parts are for processes that do not know each other");
    if (range.begin >= range.end || range.end > job->spp)
        return sr_fail(error, SR_ERROR_USAGE, "samples %u-%u: a range within 0-%u was expected", range.begin, range.end,
                       job->spp);
    struct sr_render_pass pass = pass_of(job);
    pass.range = range;
    sr_status status = sr_part_create(job, pass.blocks, range, &pass.part, error);
    if (status != SR_OK)
        return status;
    pass.film = sr_part_splats_film(pass.part);
    struct sr_keeper keeper = {.keep = job->keep, .films = {pass.film}, .film_count = 1, .part = pass.part};
    pass.keeper = &keeper;
    status = add_splats(job, pass.film, pass.blocks, error);
    if (status == SR_OK)
        status = sr_keeper_resume(&keeper, report, error);
    pass.start_s = sr_clock_s() - report->render_s;
    if (status == SR_OK && !keeper.is_complete)
        status = sr_render_pass(job, &pass, report, error);
    sr_keeper_end(&keeper, report);
    if (!keeper.is_complete)
        count_lost_splats(pass.film, report);
    *sr_part_report(pass.part) = *report;
    if (status == SR_OK)
        *part = pass.part;
    else
        sr_render_part_destroy(pass.part);
    return status;
}
