/* SPDX-License-Identifier: MIT */
/* steradian info of a scene: read and finished like for a render, then told. */
#include "info.h"

#include "import/import.h"

#include <stdio.h>
#include <string.h>

enum { MAX_KINDS = 32 };

/* Lights by kind. */
struct kinds {
    const char *name[MAX_KINDS];
    unsigned long long count[MAX_KINDS];
    int n;
};

static struct kinds count_lights(const struct sr_scene *scene)
{
    struct kinds kinds = {0};
    const struct sr_lights *lights = sr_scene_lights(scene);
    for (uint32_t i = 0; i < lights->count; ++i) {
        const char *name = lights->lights[i].model == &sr_light_area ? "area (one for each triangle or patch)"
                                                                     : lights->lights[i].model->name;
        int k = 0;
        while (k < kinds.n && strcmp(kinds.name[k], name) != 0)
            ++k;
        if (k == MAX_KINDS)
            continue;
        kinds.name[k] = name;
        ++kinds.count[k];
        kinds.n = k == kinds.n ? k + 1 : kinds.n;
    }
    return kinds;
}

static double MiB(uint64_t bytes)
{
    return (double)bytes / 1048576;
}

static void print_scene(const char *path, const struct sr_import_result *r, unsigned warnings)
{
    struct sr_scene_counts c = sr_scene_count(r->scene);
    uint64_t duplicates = sr_scene_count_duplicates(r->scene);
    struct kinds lights = count_lights(r->scene);
    struct sr_box box = sr_scene_bounds(r->scene);
    const struct sr_film_settings *f = &r->film;
    const double *o = r->origin;
    printf("%s: a scene, hash %016llx, %u warning%s\n", path, (unsigned long long)r->hash, warnings,
           warnings == 1 ? "" : "s");
    printf("  sensor       %s\n", r->sensor.model->name);
    printf("  film         %d x %d pixels, colour space %s, imaging ratio %g [1], file \"%s\"\n", f->width, f->height,
           sr_colour_space(f->space)->name, sr_film_imaging_ratio(f), f->filename);
    if (f->x0 || f->y0 || f->x1 != f->width || f->y1 != f->height)
        printf("               rendered: x %d to %d, y %d to %d [pixel]\n", f->x0, f->x1 - 1, f->y0, f->y1 - 1);
    printf("  filter       %s, radius %g x %g pixels\n", r->filter.model->name, (double)r->filter.radius.x,
           (double)r->filter.radius.y);
    printf("  integrator   %s\n", sr_integrator_label(&r->integrator));
    printf("  sampler      %s, %u samples per pixel, seed %u\n",
           r->sampler == SR_SAMPLER_SOBOL ? "sobol" : "independent", r->spp, r->seed);
    printf("  wavelengths  %g to %g nm\n", (double)SR_LAMBDA_MIN, (double)SR_LAMBDA_MAX);
    printf("  lights       %llu", (unsigned long long)c.lights);
    for (int i = 0; i < lights.n; ++i)
        printf("%s %llu %s", i ? "," : ":", lights.count[i], lights.name[i]);
    printf(
        "\n  surfaces     %llu triangles, %llu patches, %llu quadrics, %llu curves; %llu instances of %llu objects\n",
        (unsigned long long)c.triangles, (unsigned long long)c.patches, (unsigned long long)c.quadrics,
        (unsigned long long)c.curves, (unsigned long long)c.instances, (unsigned long long)c.objects);
    if (c.degenerate || c.too_large || c.not_finite)
        printf("               never met: %llu primitives without area, %llu too large, %llu not finite\n",
               (unsigned long long)c.degenerate, (unsigned long long)c.too_large, (unsigned long long)c.not_finite);
    if (duplicates)
        printf("               %llu triangles have the corners of another one\n", (unsigned long long)duplicates);
    printf("  materials    %llu\n", (unsigned long long)c.materials);
    if (sr_box_is_empty(box))
        printf("  bounds       nothing there\n");
    else
        printf("  bounds       (%.9g, %.9g, %.9g) to (%.9g, %.9g, %.9g) m\n", (double)box.lo.x + o[0],
               (double)box.lo.y + o[1], (double)box.lo.z + o[2], (double)box.hi.x + o[0], (double)box.hi.y + o[1],
               (double)box.hi.z + o[2]);
    printf("  memory       geometry %.2f MiB, acceleration %.2f MiB, peak %.1f MiB\n", MiB(c.geometry_B),
           MiB(c.acceleration_B), MiB(sr_peak_memory_B()));
    printf("  time         read %.3f s, built %.3f s\n", r->read_s, c.build_s);
}

/* -0 is told as 0. */
static json_t *bounds_json(struct sr_box box, const double o[3])
{
    if (sr_box_is_empty(box))
        return json_null();
    return json_pack("{s:[f,f,f], s:[f,f,f], s:s}", "min", (double)box.lo.x + o[0], (double)box.lo.y + o[1],
                     (double)box.lo.z + o[2], "max", (double)box.hi.x + o[0], (double)box.hi.y + o[1],
                     (double)box.hi.z + o[2], "unit", "m");
}

static int print_scene_json(const char *path, const struct sr_import_result *r, unsigned warnings)
{
    struct sr_scene_counts c = sr_scene_count(r->scene);
    struct kinds kinds = count_lights(r->scene);
    const struct sr_film_settings *f = &r->film;
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->hash);
    json_t *lights = json_object();
    for (int i = 0; i < kinds.n; ++i)
        json_object_set_new(lights, strncmp(kinds.name[i], "area", 4) == 0 ? "area" : kinds.name[i],
                            json_integer((json_int_t)kinds.count[i]));
    json_t *j = json_pack(
        "{s:o, s:s, s:s, s:i, s:s, s:{s:i, s:i, s:i, s:i, s:i, s:i, s:s, s:s, s:o, s:o}, s:{s:s, s:o, s:o, s:s}, s:s,"
        " s:{s:s, s:I, s:I}, s:{s:o, s:o, s:s}, s:o, s:{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}, s:o, s:{s:I, s:I, "
        "s:I}, s:{s:o, s:o}}",
        "file", command_json_text(path), "kind", "scene", "hash", hash, "warnings", (int)warnings, "sensor",
        r->sensor.model->name, "film", "width", (int)f->width, "height", (int)f->height, "x0", (int)f->x0, "x1",
        (int)f->x1, "y0", (int)f->y0, "y1", (int)f->y1, "unit", "pixel", "colour_space",
        sr_colour_space(f->space)->name, "imaging_ratio", command_json_quantity(sr_film_imaging_ratio(f), "1"),
        "filename", command_json_text(f->filename), "filter", "name", r->filter.model->name, "radius_x",
        command_json_number((double)r->filter.radius.x), "radius_y", command_json_number((double)r->filter.radius.y),
        "unit", "pixel", "integrator", sr_integrator_label(&r->integrator), "sampler", "name",
        r->sampler == SR_SAMPLER_SOBOL ? "sobol" : "independent", "samples_per_pixel", (json_int_t)r->spp, "seed",
        (json_int_t)r->seed, "wavelengths", "min", command_json_number((double)SR_LAMBDA_MIN), "max",
        command_json_number((double)SR_LAMBDA_MAX), "unit", "nm", "lights", lights, "counts", "lights",
        (json_int_t)c.lights, "triangles", (json_int_t)c.triangles, "patches", (json_int_t)c.patches, "quadrics",
        (json_int_t)c.quadrics, "curves", (json_int_t)c.curves, "instances", (json_int_t)c.instances, "objects",
        (json_int_t)c.objects, "materials", (json_int_t)c.materials, "primitives_without_area",
        (json_int_t)c.degenerate, "primitives_too_large", (json_int_t)c.too_large, "primitives_not_finite",
        (json_int_t)c.not_finite, "duplicate_triangles", (json_int_t)sr_scene_count_duplicates(r->scene), "bounds",
        bounds_json(sr_scene_bounds(r->scene), r->origin), "memory", "geometry_B", (json_int_t)c.geometry_B,
        "acceleration_B", (json_int_t)c.acceleration_B, "peak_B", (json_int_t)sr_peak_memory_B(), "time", "read_s",
        command_json_number(r->read_s), "build_s", command_json_number(c.build_s));
    return command_print_json("info", j);
}

int info_scene(const struct info_arguments *a)
{
    bool quiet = a->quiet;
    struct sr_error error = {0};
    struct sr_log log = command_log(&quiet);
    struct sr_import_options options = {0};
    struct sr_import_result result;
    if (sr_import_pbrt(a->path, &options, &result, &log, &error) != SR_OK)
        return command_fail("info", &error);
    int code = 0;
    if (a->json)
        code = print_scene_json(a->path, &result, log.warning_count);
    else
        print_scene(a->path, &result, log.warning_count);
    sr_import_result_free(&result);
    return code;
}
