/* SPDX-License-Identifier: MIT */
/* A pbrt file to a finished scene: read, describe, finish. */
#include "import/import.h"

#include "import/pbrt/build.h"

#include <string.h>

static sr_status describe(struct sr_pbrt_build *b, enum sr_light_choice *choice)
{
    const struct sr_pbrt_description *d = b->d;
    b->textures = sr_arena_alloc(&b->scratch, d->textures.count * sizeof *b->textures);
    b->materials = sr_arena_alloc(&b->scratch, (d->materials.count + d->named_materials.count) * sizeof *b->materials);
    if (!b->textures || !b->materials)
        return sr_pbrt_no_memory(b);
    sr_status status = sr_pbrt_build_settings(b, choice);
    if (status == SR_OK)
        status = sr_pbrt_build_lights(b);
    if (status == SR_OK)
        status = sr_pbrt_build_shapes(b);
    if (status == SR_OK)
        status = sr_pbrt_finish_textures(b);
    return status;
}

static sr_status import(const char *path, const struct sr_import_options *options, struct sr_import_result *result,
                        struct sr_log *log, struct sr_error *error)
{
    double start_s = sr_clock_s();
    struct sr_pbrt_description d = {0};
    struct sr_pbrt_build b = {.d = &d,
                              .main_path = path,
                              .options = options,
                              .result = result,
                              .arena = sr_scene_arena(result->scene),
                              .log = log,
                              .error = error,
                              .threads = options->threads > 0 ? options->threads : sr_thread_count()};
    enum sr_light_choice choice = SR_LIGHTS_BVH;
    sr_status status = sr_pbrt_read(path, b.arena, log, &d, error);
    b.hash = d.hash;
    if (status == SR_OK)
        status = describe(&b, &choice);
    if (status == SR_OK && d.shapes.count + d.instances.count == 0 && d.lights.count == 0)
        sr_log(log, SR_WARNING, "%s: the scene is empty", path);
    result->hash = b.hash;
    sr_pbrt_images_free(&b);
    sr_array_free(&b.spectra);
    sr_array_free(&b.late_textures);
    sr_arena_free(&b.scratch);
    sr_pbrt_description_free(&d);
    result->read_s = sr_clock_s() - start_s;
    if (status == SR_OK && sr_scene_finish(result->scene, b.threads, choice) != SR_OK) {
        const struct sr_error *inner = sr_scene_error(result->scene);
        status = sr_fail(error, inner->status, "%s: %s", path, inner->text);
    }
    return status;
}

sr_status sr_import_pbrt(const char *path, const struct sr_import_options *options, struct sr_import_result *result,
                         struct sr_log *log, struct sr_error *error)
{
    static const struct sr_import_options nothing;
    *result = (struct sr_import_result){0};
    result->scene = sr_scene_create();
    if (!result->scene)
        return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", path);
    sr_status status = import(path, options ? options : &nothing, result, log, error);
    if (status != SR_OK)
        sr_import_result_free(result);
    return status;
}

void sr_import_result_free(struct sr_import_result *result)
{
    if (result->scene)
        sr_scene_destroy(result->scene);
    *result = (struct sr_import_result){0};
}
