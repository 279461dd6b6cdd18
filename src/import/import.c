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

/* Whether the scene is so far from the origin that floats tell: FAR times its size. Then *origin is moved to near its
 * middle, by a round number. */
static bool is_far(struct sr_box box, double origin[3])
{
    enum { FAR = 64 };
    sr_vec3 centre = sr_box_centre(box), diagonal = sr_box_diagonal(box);
    double distance = 0, size = (double)sr_max_component(diagonal);
    const float *c = &centre.x;
    for (int i = 0; i < 3; ++i)
        distance = fmax(distance, fabs((double)c[i]));
    if (sr_box_is_empty(box) || !isfinite(distance) || !(distance > FAR * size))
        return false;
    double step = exp2(ceil(log2(fmax(size, 0x1p-24 * distance))));
    for (int i = 0; i < 3; ++i)
        origin[i] += step * nearbyint((double)c[i] / step);
    return true;
}

static void tell_far(const char *path, const double o[3], struct sr_box box, struct sr_log *log)
{
    double distance = fmax(fabs(o[0]), fmax(fabs(o[1]), fabs(o[2]))),
           size = (double)sr_max_component(sr_box_diagonal(box)), step = distance * 0x1p-23;
    sr_log(
        log, step > 1e-3 * size ? SR_WARNING : SR_INFO,
        "%s: the scene is %.3g m large and stands at (%g, %g, %g) m: it is computed about there. What transforms place keeps its place; coordinates "
        "written out in shapes and meters are known to %.2g m",
        path, size, o[0], o[1], o[2], step);
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
    double origin[3] = {0, 0, 0};
    // again, about the middle; what stands very far away shows its size only then
    for (int i = 0; i < 3 && status == SR_OK && !result->stays && is_far(sr_scene_bounds(result->scene), origin); ++i) {
        sr_import_result_free(result);
        result->scene = sr_scene_create();
        if (!result->scene)
            return sr_fail(error, SR_ERROR_RESOURCE, "%s: not enough memory", path);
        memcpy(result->origin, origin, sizeof origin);
        status = import(path, options ? options : &nothing, result, NULL, error);
    }
    if (status == SR_OK && (origin[0] != 0 || origin[1] != 0 || origin[2] != 0))
        tell_far(path, origin, sr_scene_bounds(result->scene), log);
    if (status != SR_OK)
        sr_import_result_free(result);
    return status;
}

char *sr_import_identity(struct sr_arena *arena, const struct sr_import_options *options,
                         const struct sr_import_result *result)
{
    return sr_arena_printf(arena, "hash %016llx\nunits %s\ncamera %s\nvariant %s\nshifted %u %.9g\n",
                           (unsigned long long)result->hash, result->units == SR_UNITS_SI ? "si" : "photometric",
                           options->camera ? options->camera : "of the scene",
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
