/* SPDX-License-Identifier: MIT */
/* Film, pixel filter, camera, sampler, integrator and options: everything that a render needs besides the scene.
 *
 * With a crop window the pixels ceil(width x0) ... ceil(width x1) - 1 are rendered, and likewise in y. */
#include "import/describe.h"
#include "import/pbrt/build.h"

#include <string.h>

static const struct sr_pbrt_use plain = {SR_PARAM_ALBEDO, false};

/* ---- film ---- */

struct film {
    int32_t width, height;
    float iso, white_balance, max_component, diagonal;
    bool savefp16;
    int32_t buckets, coordinates;
    float lambda_min, lambda_max;
    const char *sensor, *filename;
    struct sr_slice crop_window, pixel_bounds;
};
#define MEMBER(name) offsetof(struct film, name)
static const struct sr_param film_params[] = {
    {SR_PARAM_INT, "xresolution", "pixel", 1, 1 << 20, 1280, MEMBER(width), "width"},
    {SR_PARAM_INT, "yresolution", "pixel", 1, 1 << 20, 720, MEMBER(height), "height"},
    {SR_PARAM_FLOATS, "cropwindow", "1", 0, 1, NAN, MEMBER(crop_window), "x0 x1 y0 y1 as shares of the picture"},
    {SR_PARAM_INTS, "pixelbounds", "pixel", 0, 1 << 20, NAN, MEMBER(pixel_bounds), "x0 x1 y0 y1"},
    {SR_PARAM_FLOAT, "diagonal", "mm", 0, INFINITY, 35, MEMBER(diagonal),
     "of the film behind a realistic camera's lens"},
    {SR_PARAM_FLOAT, "iso", "1", 0, INFINITY, 100, MEMBER(iso), "the picture times iso/100"},
    {SR_PARAM_FLOAT, "whitebalance", "K", 0, INFINITY, 0, MEMBER(white_balance),
     "correlated colour temperature; 0: none"},
    {SR_PARAM_FLOAT, "maxcomponentvalue", "1", 0, INFINITY, INFINITY, MEMBER(max_component),
     "larger values of the sensor are scaled down"},
    {SR_PARAM_BOOL, "savefp16", "1", 0, 1, 1, MEMBER(savefp16), "read; files are written with 32 bits"},
    {SR_PARAM_STRING, "sensor", "1", 0, 0, 0, MEMBER(sensor), "cie1931"},
    {SR_PARAM_STRING, "filename", "1", 0, 0, NAN, MEMBER(filename), NULL},
    {.name = NULL},
};
const struct sr_param sr_pbrt_spectral_params[] = {
    {SR_PARAM_INT, "nbuckets", "1", 1, 4096, 16, MEMBER(buckets), "ranges of wavelengths that are kept apart"},
    {SR_PARAM_FLOAT, "lambdamin", "nm", 1, 1e5, 360, MEMBER(lambda_min), "where the first begins"},
    {SR_PARAM_FLOAT, "lambdamax", "nm", 1, 1e5, 830, MEMBER(lambda_max), "where the last ends"},
    {.name = NULL},
};
const struct sr_param sr_pbrt_gbuffer_params[] = {
    {SR_PARAM_ENUM, "coordinatesystem", "1", 0, 1, 0, MEMBER(coordinates), "camera|world"},
    {.name = NULL},
};
const struct sr_param *const sr_pbrt_film_params = film_params;

static int32_t clamp_int(double v, int32_t lo, int32_t hi)
{
    return v < lo ? lo : v > hi ? hi : (int32_t)v;
}

static sr_status set_region(struct sr_pbrt_build *b, const struct film *f, struct sr_film_settings *s)
{
    const struct sr_import_options *o = b->options;
    const float *crop = o->has_crop ? o->crop_window : f->crop_window.count == 4 ? f->crop_window.data : NULL;
    const int32_t *bounds = o->has_pixel_bounds          ? o->pixel_bounds
                            : f->pixel_bounds.count == 4 ? f->pixel_bounds.data
                                                         : NULL;
    if ((f->crop_window.count && f->crop_window.count != 4) || (f->pixel_bounds.count && f->pixel_bounds.count != 4))
        return sr_pbrt_fail(b->d, b->d->film.where, b->error, SR_ERROR_INPUT,
                            "Film: cropwindow and pixelbounds: expected four numbers, x0 x1 y0 y1");
    if (o->has_crop && !o->has_pixel_bounds)
        bounds = NULL;
    int32_t w = s->width, h = s->height;
    s->x0 = s->y0 = 0;
    s->x1 = w;
    s->y1 = h;
    if (bounds) { // counted in the picture of the file's own size
        double x = o->has_pixel_bounds ? 1 : (double)w / f->width, y = o->has_pixel_bounds ? 1 : (double)h / f->height;
        s->x0 = clamp_int(ceil(bounds[0] * x), 0, w);
        s->x1 = clamp_int(ceil(bounds[1] * x), 0, w);
        s->y0 = clamp_int(ceil(bounds[2] * y), 0, h);
        s->y1 = clamp_int(ceil(bounds[3] * y), 0, h);
    } else if (crop) {
        s->x0 = clamp_int(ceilf((float)w * sr_min(crop[0], crop[1])), 0, w);
        s->x1 = clamp_int(ceilf((float)w * sr_max(crop[0], crop[1])), 0, w);
        s->y0 = clamp_int(ceilf((float)h * sr_min(crop[2], crop[3])), 0, h);
        s->y1 = clamp_int(ceilf((float)h * sr_max(crop[2], crop[3])), 0, h);
    }
    if (s->x0 >= s->x1 || s->y0 >= s->y1)
        return sr_pbrt_fail(b->d, b->d->film.where, b->error, SR_ERROR_INPUT,
                            "Film: no pixel is inside of the part to render, x %d to %d, y %d to %d", (int)s->x0,
                            (int)s->x1, (int)s->y0, (int)s->y1);
    return SR_OK;
}

/* "scene.exr" for "folder/scene.pbrt" and "folder/scene.glb" */
static const char *default_filename(struct sr_pbrt_build *b)
{
    const char *slash = strrchr(b->main_path, '/'), *name = slash ? slash + 1 : b->main_path;
    const struct sr_import_format *format = sr_import_format_of(b->main_path);
    const char *dot = format ? strrchr(name, '.') : strstr(name, ".pbrt");
    if (strcmp(name, "-") == 0)
        return "steradian.exr";
    return sr_arena_printf(b->arena, "%.*s.exr", dot ? (int)(dot - name) : (int)strlen(name), name);
}

static sr_status build_film(struct sr_pbrt_build *b)
{
    const struct sr_pbrt_entity *e = &b->d->film;
    const char *const supported[] = {"rgb", "gbuffer", "spectral"};
    struct film f = {0};
    bool is_gbuffer = strcmp(e->model, "gbuffer") == 0, is_spectral = strcmp(e->model, "spectral") == 0;
    if (strcmp(e->model, "rgb") != 0 && !is_gbuffer && !is_spectral)
        return sr_pbrt_unsupported(b, e, supported, 3);
    const struct sr_param *own = is_spectral ? sr_pbrt_spectral_params : is_gbuffer ? sr_pbrt_gbuffer_params : NULL;
    sr_status status = sr_pbrt_bind(b, film_params, e, plain, &f);
    if (status == SR_OK && own)
        status = sr_pbrt_bind(b, own, e, plain, &f);
    if (status != SR_OK)
        return status;
    uint32_t camera1 = 0;
    if (strcmp(f.sensor, "cie1931") != 0) {
        struct sr_pbrt_suggestion near = {.word = f.sensor};
        char buffer[160];
        while (sr_film_camera_name((int)camera1) && strcmp(sr_film_camera_name((int)camera1), f.sensor) != 0)
            sr_pbrt_suggest(&near, sr_film_camera_name((int)camera1++));
        if (!sr_film_camera_name((int)camera1))
            return sr_pbrt_fail(b->d, sr_pbrt_find(&e->params, "sensor")->where, b->error, SR_ERROR_INPUT,
                                "there is no sensor \"%s\": expected cie1931 or the name of a camera%s", f.sensor,
                                sr_pbrt_suggestion_text(&near, buffer));
        ++camera1;
    }
    if (is_spectral && !(f.lambda_min < f.lambda_max))
        return sr_pbrt_fail(b->d, e->where, b->error, SR_ERROR_INPUT,
                            "Film \"spectral\": lambdamin %g nm must be less than lambdamax %g nm",
                            (double)f.lambda_min, (double)f.lambda_max);
    b->is_in_world = f.coordinates == 1;
    const struct sr_import_options *o = b->options;
    int32_t w = o->width ? clamp_int(o->width, 1, 1 << 20) : f.width,
            h = o->height ? clamp_int(o->height, 1, 1 << 20) : f.height;
    if (o->quick) {
        w = w > 4 ? w / 4 : 1;
        h = h > 4 ? h / 4 : 1;
    }
    b->film_diagonal = 1e-3f * f.diagonal;
    const char *filename = f.filename && f.filename[0] ? f.filename : default_filename(b);
    if (!filename)
        return sr_pbrt_no_memory(b);
    b->result->film = (struct sr_film_settings){.width = w,
                                                .height = h,
                                                .space = b->d->film_space,
                                                .iso = f.iso,
                                                .exposure_time = 1,
                                                .white_balance = f.white_balance,
                                                .max_component = f.max_component,
                                                .camera1 = camera1,
                                                .is_gbuffer = is_gbuffer,
                                                .buckets = is_spectral ? (uint32_t)f.buckets : 0,
                                                .lambda_min = f.lambda_min,
                                                .lambda_max = f.lambda_max,
                                                .filename = filename};
    sr_pbrt_warn_unused(b, e, film_params, own);
    return set_region(b, &f, &b->result->film);
}

/* ---- filter ---- */

static sr_status build_filter(struct sr_pbrt_build *b)
{
    const struct sr_pbrt_entity *e = &b->d->filter;
    const struct sr_filter_model *m = sr_filter_model_find(e->model);
    if (!m) {
        const char *names[16];
        size_t n = 0;
        for (; sr_filter_models[n] && n < 16; ++n)
            names[n] = sr_filter_models[n]->name;
        return sr_pbrt_unsupported(b, e, names, n);
    }
    void *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_bind(b, m->params, e, plain, self);
    if (status != SR_OK)
        return status;
    struct sr_error inner = {0};
    if (sr_filter_prepare(b->arena, m, self, &b->result->filter, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    sr_pbrt_warn_unused(b, e, m->params, NULL);
    return SR_OK;
}

/* ---- camera ---- */

static sr_status build_sensor(struct sr_pbrt_build *b)
{
    const struct sr_pbrt_entity *e = &b->d->camera;
    const struct sr_sensor_model *m = sr_sensor_model_find(e->model);
    if (!m) {
        const char *names[16];
        size_t n = 0;
        for (; sr_sensor_models[n] && n < 16; ++n)
            names[n] = sr_sensor_models[n]->name;
        return sr_pbrt_unsupported(b, e, names, n);
    }
    void *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_bind(b, m->params, e, plain, self);
    if (status != SR_OK)
        return status;
    if (m->wants_lens && sr_pbrt_lens(b, e, &((struct sr_sensor_with_lens *)self)->lens) != SR_OK)
        return b->error->status;
    struct sr_transform camera_to_world = sr_pbrt_transform_of(b, e->transform, SR_PBRT_FROM_WORLD);
    struct sr_sensor_raster raster = {(uint32_t)b->result->film.width, (uint32_t)b->result->film.height};
    struct sr_error inner = {0};
    const struct sr_motion *motion = NULL;
    const struct sr_sensor_common *common = self;
    b->shutter_open = sr_min(common->shutter_open, common->shutter_close);
    b->shutter_close = sr_max(common->shutter_open, common->shutter_close);
    if (sr_pbrt_moves(b, e->transform)) {
        if (sr_pbrt_motion(b, e->transform, SR_PBRT_FROM_WORLD, "Camera", e->where, &motion) != SR_OK)
            return b->error->status;
        camera_to_world = sr_transform_identity();
    }
    if (m->prepare(self, raster, &camera_to_world, b->arena, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    b->result->sensor = (struct sr_sensor){m, self};
    if (motion && sr_sensor_move(b->result->sensor, motion, b->arena, &b->result->sensor, &inner) != SR_OK)
        return sr_pbrt_wrap(b, e, &inner);
    if (b->result->film.is_gbuffer) {
        struct sr_motion *still = sr_arena_alloc(b->arena, sizeof *still);
        if (!still || !sr_motion_make(&camera_to_world, &camera_to_world, 0, 1, still))
            return sr_pbrt_no_memory(b);
        b->result->film.camera = motion ? motion : still;
        b->result->film.of_points = b->is_in_world ? NULL : b->result->film.camera;
        const double *o = b->result->origin;
        if (b->is_in_world && (o[0] != 0 || o[1] != 0 || o[2] != 0)) {
            struct sr_motion *back = sr_arena_alloc(b->arena, sizeof *back);
            struct sr_transform away = sr_transform_translate((sr_vec3){(float)-o[0], (float)-o[1], (float)-o[2]});
            if (!back || !sr_motion_make(&away, &away, 0, 1, back))
                return sr_pbrt_no_memory(b);
            b->result->film.of_points = back;
        }
    }
    // what a sensor without colour curves of its own makes of the shutter: the picture times the seconds
    b->result->film.exposure_time = common->shutter_close - common->shutter_open;
    if (!(b->result->film.exposure_time > 0)) {
        sr_pbrt_warn(b->d, e->where,
                     "the shutter closes when it opens and the picture would be black: taken as open for 1 s");
        b->result->film.exposure_time = 1;
    }
    sr_pbrt_warn_unused(b, e, m->params, NULL);
    return SR_OK;
}

/* ---- sampler ---- */

struct sampler {
    int32_t spp, x_samples, y_samples, seed;
    bool jitter;
    const char *randomization;
};
static const struct sr_param sampler_params[] = {
    {SR_PARAM_INT, "pixelsamples", "1", 1, 1 << 30, NAN, offsetof(struct sampler, spp), "samples per pixel"},
    {SR_PARAM_INT, "xsamples", "1", 1, 1 << 15, 4, offsetof(struct sampler, x_samples), "of stratified"},
    {SR_PARAM_INT, "ysamples", "1", 1, 1 << 15, 4, offsetof(struct sampler, y_samples), "of stratified"},
    {SR_PARAM_BOOL, "jitter", "1", 0, 1, 1, offsetof(struct sampler, jitter), "of stratified; read"},
    {SR_PARAM_INT, "seed", "1", INT32_MIN, INT32_MAX, 0, offsetof(struct sampler, seed), "of the random numbers"},
    {SR_PARAM_STRING, "randomization", "1", 0, 0, NAN, offsetof(struct sampler, randomization),
     "none, permutedigits, fastowen or owen: nets are Owen-scrambled all the same"},
    {.name = NULL},
};
const struct sr_param *const sr_pbrt_sampler_params = sampler_params;

static sr_status build_sampler(struct sr_pbrt_build *b)
{
    static const char *const names[] = {"zsobol",  "paddedsobol", "halton",     "sobol",
                                        "pmj02bn", "stratified",  "independent"};
    const struct sr_pbrt_entity *e = &b->d->sampler;
    size_t n = sizeof names / sizeof *names, i = 0;
    while (i < n && strcmp(names[i], e->model) != 0)
        ++i;
    if (i == n)
        return sr_pbrt_unsupported(b, e, names, n);
    struct sampler s = {0};
    sr_status status = sr_pbrt_bind(b, sampler_params, e, plain, &s);
    if (status != SR_OK)
        return status;
    static const char *const words[] = {"", "none", "permutedigits", "fastowen", "owen"};
    int word = 0;
    while (s.randomization && word < 5 && strcmp(words[word], s.randomization) != 0)
        ++word;
    if (word == 5)
        return sr_pbrt_fail(
            b->d, sr_pbrt_find(&e->params, "randomization")->where, b->error, SR_ERROR_INPUT,
            "\"string randomization\" of Sampler \"%s\" is \"%s\": expected none, permutedigits, fastowen or owen",
            e->model, s.randomization);
    bool is_independent = strcmp(e->model, "independent") == 0;
    if (e->where.file && !is_independent &&
        (strcmp(e->model, "halton") == 0 || strcmp(e->model, "stratified") == 0 || strcmp(e->model, "pmj02bn") == 0 ||
         word == 1 || word == 2))
        sr_log(
            b->log, SR_INFO,
            "%s:%d: Sampler \"%s\": Sobol' nets, scrambled as Owen did, take its place: the picture's mean is the same",
            e->where.file, e->where.line, e->model);
    uint32_t spp = s.spp ? (uint32_t)s.spp : is_independent ? 4 : 16;
    if (strcmp(e->model, "stratified") == 0)
        spp = (uint32_t)s.x_samples * (uint32_t)s.y_samples;
    spp = b->options->spp ? b->options->spp : spp;
    if (b->options->quick)
        spp = spp > 4 ? spp / 4 : 1;
    b->result->spp = spp;
    b->result->seed = (uint32_t)s.seed;
    b->result->sampler = is_independent ? SR_SAMPLER_INDEPENDENT : SR_SAMPLER_SOBOL;
    sr_pbrt_warn_unused(b, e, sampler_params, NULL);
    return SR_OK;
}

/* ---- integrator ---- */

/* pbrt's estimators that are not here, and what they are chosen for: light that mirrors and glass throw */
static bool is_done_by_photons(const char *name)
{
    return strcmp(name, "mlt") == 0 || strcmp(name, "sppm") == 0;
}

/* The file's own integrator; or what the options name, with the file's numbers where both have them. */
static sr_status build_integrator(struct sr_pbrt_build *b, enum sr_light_choice *choice)
{
    struct sr_pbrt_entity e = b->d->integrator;
    const char *other = b->options->integrator, *light_sampler = "bvh";
    bool is_foreign = is_done_by_photons(e.model);
    if (is_foreign) {
        if (e.where.file && !other)
            sr_log(
                b->log, SR_INFO,
                "%s:%d:%d: Integrator \"%s\": rendered by \"caustics\", path tracing with photons behind mirrors and glass",
                e.where.file, e.where.line, e.where.column, e.model);
        e.model = "caustics";
    }
    if (!other && strcmp(e.model, "function") == 0)
        return sr_pbrt_fail(
            b->d, e.where, b->error, SR_ERROR_INPUT,
            "Integrator \"function\" makes no picture of a scene: the errors of samplers over known functions are told by `steradian converge`");
    if (other && !sr_integrator_model_find(e.model))
        e.model = "path";
    const struct sr_integrator_model *m = sr_integrator_model_find(e.model);
    if (!m) {
        const char *names[16];
        size_t n = 0;
        for (; sr_integrator_models[n] && n < 16; ++n)
            names[n] = sr_integrator_models[n]->name;
        return sr_pbrt_unsupported(b, &e, names, n);
    }
    void *self = sr_arena_alloc(b->arena, m->size);
    if (!self)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_bind(b, m->params, &e, plain, self);
    if (status == SR_OK)
        status = sr_pbrt_get_string(b->d, &e.params, "lightsampler", &light_sampler, b->error);
    *choice = strcmp(light_sampler, "power") == 0     ? SR_LIGHTS_POWER
              : strcmp(light_sampler, "uniform") == 0 ? SR_LIGHTS_UNIFORM
                                                      : SR_LIGHTS_BVH;
    if (status == SR_OK && !other && !is_foreign)
        sr_pbrt_warn_unused(b, &e, m->params, NULL);
    if (status == SR_OK && m->prepare)
        status = m->prepare(self, b->arena, b->error);
    struct sr_integrator own = {m, self};
    b->result->integrator = own;
    if (status == SR_OK && other)
        status = sr_integrator_parse(is_done_by_photons(other) ? "caustics" : other, &own, b->arena,
                                     &b->result->integrator, b->error);
    return status;
}

/* ---- options ---- */

static sr_status build_options(struct sr_pbrt_build *b)
{
    static const char *const harmless[] = {"rendercoordsys", "wavefront", "pixelstats", "msereferenceimage",
                                           "msereferenceout"};
    b->edge_scale = 1;
    b->result->jitter_pixel = b->result->jitter_lambda = true;
    b->result->units = b->options->units;
    for (size_t i = 0; i < b->d->options.count; ++i) {
        const struct sr_pbrt_option *o = SR_PBRT_AT(b->d->options, struct sr_pbrt_option, i);
        bool is_on = o->value.type == SR_PBRT_BOOL && o->value.count == 1 && o->value.ints[0];
        bool is_bool = strcmp(o->name, "disablepixeljitter") == 0 || strcmp(o->name, "disablewavelengthjitter") == 0;
        if (is_bool && (o->value.type != SR_PBRT_BOOL || o->value.count != 1))
            return sr_pbrt_fail(b->d, o->value.where, b->error, SR_ERROR_INPUT, "Option \"%s\": expected one bool",
                                o->value.name);
        if (strcmp(o->name, "rendercoordsys") == 0)
            b->result->stays = o->value.type == SR_PBRT_STRING_TYPE && o->value.count == 1 &&
                               strcmp(o->value.strings[0], "world") == 0;
        if (strcmp(o->name, "disablepixeljitter") == 0)
            b->result->jitter_pixel = !is_on;
        else if (strcmp(o->name, "disablewavelengthjitter") == 0)
            b->result->jitter_lambda = !is_on;
        else if (strcmp(o->name, "seed") == 0) {
            if (o->value.type != SR_PBRT_INTEGER || o->value.count != 1)
                return sr_pbrt_fail(b->d, o->value.where, b->error, SR_ERROR_INPUT,
                                    "Option \"seed\": expected one integer");
            if (!sr_pbrt_find(&b->d->sampler.params, "seed")) // the sampler's own word counts more
                b->result->seed = (uint32_t)o->value.ints[0];
        } else if (strcmp(o->name, "displacementedgescale") == 0) {
            bool is_number =
                o->value.count == 1 && (o->value.type == SR_PBRT_FLOAT || o->value.type == SR_PBRT_INTEGER);
            b->edge_scale = !is_number                       ? 0
                            : o->value.type == SR_PBRT_FLOAT ? o->value.floats[0]
                                                             : (float)o->value.ints[0];
            if (!(b->edge_scale > 0) || !isfinite(b->edge_scale))
                return sr_pbrt_fail(b->d, o->value.where, b->error, SR_ERROR_INPUT,
                                    "Option \"%s\": expected one positive number", o->value.name);
        } else if (strcmp(o->name, "units") == 0) {
            const char *word = o->value.type == SR_PBRT_STRING_TYPE && o->value.count == 1 ? o->value.strings[0] : "";
            bool is_si = strcmp(word, "si") == 0;
            if (!is_si && strcmp(word, "photometric") != 0)
                return sr_pbrt_fail(b->d, o->value.where, b->error, SR_ERROR_INPUT,
                                    "Option \"units\": expected \"photometric\" or \"si\"");
            if (b->options->units == SR_UNITS_OF_SCENE)
                b->result->units = is_si ? SR_UNITS_SI : SR_UNITS_PHOTOMETRIC;
        } else {
            bool is_harmless = false;
            for (size_t k = 0; k < sizeof harmless / sizeof *harmless; ++k)
                is_harmless = is_harmless || strcmp(o->name, harmless[k]) == 0;
            if (is_harmless)
                sr_log(b->log, SR_INFO, "%s:%d:%d: Option \"%s\" is about how pbrt works inside: it does nothing here",
                       o->value.where.file, o->value.where.line, o->value.where.column, o->name);
            else if (is_on || o->value.type != SR_PBRT_BOOL)
                sr_pbrt_warn(b->d, o->value.where, "Option \"%s\" is not supported yet and does nothing",
                             o->value.name);
        }
    }
    if (b->result->units == SR_UNITS_OF_SCENE)
        b->result->units = SR_UNITS_PHOTOMETRIC;
    return SR_OK;
}

static sr_status build_sensor_medium(struct sr_pbrt_build *b)
{
    struct sr_medium medium;
    sr_status status = sr_pbrt_medium(b, b->d->camera_medium, b->d->camera_medium_where, &medium);
    sr_scene_set_sensor_medium(b->result->scene, medium);
    return status;
}

sr_status sr_pbrt_settle_integrator(struct sr_pbrt_build *b)
{
    struct sr_integrator *i = &b->result->integrator;
    bool has_media = sr_scene_has_media(b->result->scene);
    const char *name = i->model->name;
    if (strcmp(name, "volpath") == 0 && !has_media)
        i->model = sr_integrator_model_find("path"); // which takes the same parameters
    if (!has_media || (strcmp(name, "bdpt") != 0 && strcmp(name, "lightpath") != 0 && strcmp(name, "caustics") != 0))
        return SR_OK;
    sr_log(b->log, SR_WARNING,
           "%s: \"%s\" knows no media here: \"volpath\" renders this scene instead, with the same expectation",
           b->main_path, name);
    struct sr_integrator own = *i;
    return sr_integrator_parse("volpath", &own, b->arena, i, b->error);
}

sr_status sr_pbrt_build_settings(struct sr_pbrt_build *b, enum sr_light_choice *choice)
{
    sr_status status = build_film(b);
    if (status == SR_OK)
        status = build_filter(b);
    if (status == SR_OK)
        status = build_sensor(b);
    if (status == SR_OK)
        status = build_sampler(b);
    if (status == SR_OK)
        status = build_options(b);
    if (status == SR_OK)
        status = build_sensor_medium(b);
    // pbrt's lights are divided by the integral of ybar, 106.857 nm, and its buckets multiplied by it
    b->result->film.bucket_scale = b->result->units == SR_UNITS_SI ? 1 / 683.0f : 106.856895f;
    return status == SR_OK ? build_integrator(b, choice) : status;
}
