/* SPDX-License-Identifier: MIT */
/* The public world: it checks the arguments and calls import and render. */
#include <steradian/world.h>

#include "api/private.h"
#include "quantity/quantity.h"

struct listener {
    void (*warn)(void *user, const char *text);
    void *user;
};

static void pass_on(void *user, enum sr_severity severity, const char *text)
{
    const struct listener *l = user;
    if (l->warn && severity == SR_WARNING)
        l->warn(l->user, text);
}

sr_status sr_world_load(const char *path, void (*warn)(void *user, const char *text), void *user,
                        struct sr_world **world, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct listener listener = {warn, user};
    struct sr_log log = {.write = pass_on, .user = &listener};
    struct sr_import_options options = {0};
    struct sr_world *w = sr_alloc(sizeof *w);
    *world = NULL;
    if (!w)
        sr_fail(&e, SR_ERROR_RESOURCE, "%s: not enough memory", path);
    else if (sr_import_pbrt(path, &options, &w->import, &log, &e) == SR_OK) {
        *world = w;
        return SR_OK;
    }
    sr_free(w);
    return api_tell(&e, error, error_size);
}

void sr_world_destroy(struct sr_world *world)
{
    if (!world)
        return;
    sr_import_result_free(&world->import);
    sr_free(world);
}

sr_status api_settle(struct sr_render_job *job, int threads, float lambda_min_nm, float lambda_max_nm,
                     struct sr_error *error)
{
    job->threads = threads;
    job->lambda.lo = lambda_min_nm != 0 ? lambda_min_nm : job->lambda.lo; // NaN is no 0
    job->lambda.hi = lambda_max_nm != 0 ? lambda_max_nm : job->lambda.hi;
    if (threads < 0)
        return sr_fail(error, SR_ERROR_USAGE, "%d threads: 0, for all processors, or more was expected", threads);
    if (job->lambda.lo >= 100 && job->lambda.lo < job->lambda.hi && job->lambda.hi <= 20000)
        return SR_OK;
    return sr_fail(error, SR_ERROR_USAGE, "wavelengths from %g to %g nm: 100 <= min < max <= 20000 was expected",
                   (double)job->lambda.lo, (double)job->lambda.hi);
}

struct caller {
    const struct sr_render_settings *settings;
    atomic_bool stop;
};

static void ask_caller(void *user, const struct sr_render_progress *p)
{
    struct caller *c = user;
    if (!c->settings->progress(c->settings->user, p->share))
        atomic_store(&c->stop, true);
}

sr_status sr_world_render(const struct sr_world *world, const struct sr_render_settings *settings,
                          struct sr_picture **picture, char *error, size_t error_size)
{
    struct sr_error e = {0};
    struct sr_render_settings none = {0};
    struct caller caller = {.settings = settings ? settings : &none};
    const struct sr_render_settings *s = caller.settings;
    struct sr_render_job job = sr_render_job_of(&world->import);
    *picture = NULL;
    job.spp = s->spp ? s->spp : job.spp;
    job.replicates = s->replicates;
    job.seed = s->has_seed ? s->seed : job.seed;
    job.with_aov = s->with_auxiliary;
    if (api_settle(&job, s->threads, s->lambda_min_nm, s->lambda_max_nm, &e) != SR_OK)
        return api_tell(&e, error, error_size);
    if (s->progress) {
        job.progress = ask_caller;
        job.progress_interval_s = 0.1;
        job.user = &caller;
        job.cancel = &caller.stop;
    }
    struct sr_film *film;
    struct sr_render_report report;
    struct sr_image *image;
    sr_status status = sr_render(&job, &film, &report, &e);
    if (!film)
        return api_tell(&e, error, error_size);
    sr_status made = sr_render_image(film, true, job.replicates > 0, &image, &e);
    sr_film_destroy(film);
    if (made != SR_OK || api_wrap_image(image, picture, &e) != SR_OK)
        return api_tell(&e, error, error_size);
    return status;
}

sr_status sr_world_irradiance(const struct sr_world *world, const double point_m[3], const double normal[3],
                              uint32_t samples, uint32_t replicates, struct sr_quantity *E_v, struct sr_quantity *E_e)
{
    struct sr_render_job job = sr_render_job_of(&world->import);
    double length = hypot(hypot(normal[0], normal[1]), normal[2]);
    sr_vec3 p = sr_render_place(&job, point_m),
            n = {(float)(normal[0] / length), (float)(normal[1] / length), (float)(normal[2] / length)};
    if (samples < 1 || replicates < 2 || !sr_is_finite(p) || !sr_is_finite(n) || !(sr_length(n) > 0))
        return SR_ERROR_USAGE;
    struct sr_irradiance E = sr_render_irradiance(&job, p, n, samples, replicates);
    if (isnan(E.E_v))
        return SR_ERROR_RESOURCE;
    if (E_v)
        *E_v = (struct sr_quantity){.value = E.E_v,
                                    .u = E.E_v_error,
                                    .degrees = E.degrees,
                                    .unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, false)};
    if (E_e)
        *E_e = (struct sr_quantity){.value = E.E_e,
                                    .u = E.E_e_error,
                                    .degrees = E.degrees,
                                    .unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_RADIOMETRIC, false)};
    return SR_OK;
}
