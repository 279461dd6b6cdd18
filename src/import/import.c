/* SPDX-License-Identifier: MIT */
/* A file to a finished scene: read, describe, finish. */
#include "import/import.h"

#include "import/describe.h"
#include "import/pbrt/build.h"

#include <stdlib.h>
#include <string.h>

/* What ends with the import. */
static void release(struct sr_pbrt_build *b)
{
    sr_pbrt_images_free(b);
    sr_array_free(&b->named_shapes);
    sr_array_free(&b->spectra);
    sr_array_free(&b->late_textures);
    sr_arena_free(&b->scratch);
    sr_pbrt_description_free(b->d);
}

static sr_status make_room(struct sr_pbrt_build *b)
{
    const struct sr_pbrt_description *d = b->d;
    b->textures = sr_arena_alloc(&b->scratch, d->textures.count * sizeof *b->textures);
    b->materials = sr_arena_alloc(&b->scratch, (d->materials.count + d->named_materials.count) * sizeof *b->materials);
    b->media = sr_arena_alloc(&b->scratch, d->media.count * sizeof *b->media);
    return b->textures && b->materials && b->media ? SR_OK : sr_pbrt_no_memory(b);
}

static sr_status describe(struct sr_pbrt_build *b, enum sr_light_choice *choice)
{
    sr_status status = make_room(b);
    if (status == SR_OK)
        status = sr_pbrt_build_settings(b, choice);
    if (status == SR_OK)
        status = sr_pbrt_build_lights(b);
    if (status == SR_OK)
        status = sr_pbrt_build_shapes(b);
    if (status == SR_OK)
        status = sr_pbrt_build_meters(b);
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
    sr_status status = sr_describe(path, options, &b.scratch, log, &d, error);
    b.hash = d.hash;
    if (status == SR_OK)
        status = sr_pbrt_uncertainties(&b);
    if (status == SR_OK)
        status = describe(&b, &choice);
    if (status == SR_OK && d.shapes.count + d.instances.count == 0 && d.lights.count == 0)
        sr_log(log, SR_WARNING, "%s: the scene is empty", path);
    result->hash = b.hash;
    release(&b);
    result->read_s = sr_clock_s() - start_s;
    if (status == SR_OK && sr_scene_finish(result->scene, b.threads, choice) != SR_OK) {
        const struct sr_error *inner = sr_scene_error(result->scene);
        status = sr_fail(error, inner->status, "%s: %s", path, inner->text);
    }
    if (status == SR_OK)
        sr_scene_tell_degenerate(result->scene, log);
    if (status == SR_OK)
        status = sr_pbrt_settle_integrator(&b);
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

char *sr_import_identity(struct sr_arena *arena, const struct sr_import_options *options, const struct sr_import_result *result)
{
    return sr_arena_printf(arena, "hash %016llx\nunits %s\ncamera %s\nvariant %s\nshifted %u %.9g\n", (unsigned long long)result->hash,
                           result->units == SR_UNITS_SI ? "si" : "photometric", options->camera ? options->camera : "of the scene",
                           options->variant ? options->variant : "of the scene", options->shifted, options->shift);
}

sr_status sr_import_pbrt_material(const char *path, const char *name, struct sr_arena *arena,
                                  const struct sr_material **out, struct sr_log *log, struct sr_error *error)
{
    static const struct sr_import_options nothing;
    struct sr_import_result result = {0};
    struct sr_pbrt_description d = {0};
    struct sr_pbrt_build b = {.d = &d,
                              .main_path = path,
                              .options = &nothing,
                              .result = &result,
                              .arena = arena,
                              .log = log,
                              .error = error,
                              .threads = 1};
    *out = NULL;
    sr_status status = sr_describe(path, &nothing, &b.scratch, log, &d, error);
    b.hash = d.hash;
    struct sr_pbrt_material_ref ref = {.name = name, .where = {path, 1, 1}};
    if (status == SR_OK && name[0] == '#') { // the list's first is what shapes wear before any directive
        char *end;
        unsigned long number = strtoul(name + 1, &end, 10);
        if (*end || number < 1 || number >= d.materials.count)
            status =
                sr_fail(error, SR_ERROR_INPUT, "%s: there is no material %s: the scene has %zu Material directives",
                        path, name, d.materials.count - 1);
        ref = (struct sr_pbrt_material_ref){.index = (uint32_t)number, .where = {path, 1, 1}};
    }
    if (status == SR_OK)
        status = make_room(&b);
    if (status == SR_OK)
        status = sr_pbrt_material(&b, &ref, out);
    if (status == SR_OK)
        status = sr_pbrt_finish_textures(&b);
    release(&b);
    return status;
}

void sr_import_result_free(struct sr_import_result *result)
{
    if (result->scene)
        sr_scene_destroy(result->scene);
    *result = (struct sr_import_result){0};
}
