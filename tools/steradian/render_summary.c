/* SPDX-License-Identifier: MIT */
/* steradian render: what it tells when it is done: means with their uncertainty, meters, counts, times. */
#include "render_command.h"

#include <math.h>
#include <stdio.h>

enum { METER_SAMPLES = 4096, METER_REPLICATES = 32 };

/* The noise of the picture, of what --error speaks [1]; NaN where it is not known. */
static double relative_error(const struct rendering *r, const struct sr_film *film)
{
    return r->job->adaptive.is_on ? sr_film_relative_error(film, sr_colour_space(film->settings.space)->xyz_from_rgb[1])
                                  : NAN;
}

bool render_missed_target(const struct rendering *r, const struct sr_film *film)
{
    double goal = r->job->adaptive.error;
    return goal > 0 && !(relative_error(r, film) <= 1.1 * goal); // the error itself is known to some percent
}

/* Of how many pixels the error bars are told to be doubtful: of more than one in twenty, or it is not told. */
static uint64_t doubtful(const struct rendering *r, const struct sr_film *film)
{
    uint64_t count = sr_film_doubtful_pixels(film);
    bool tells_errors = r->job->replicates || r->job->adaptive.is_on;
    return tells_errors && count > (uint64_t)film->width * film->height / 20 ? count : 0;
}

static double rate(double count, double time_s)
{
    return time_s > 0 ? count / time_s : 0;
}

json_t *render_measure(const struct render_arguments *a, const struct sr_render_job *job)
{
    json_t *list = json_array();
    for (int i = 0; i < a->meter_count; ++i) {
        const double *m = a->meters[i];
        struct sr_irradiance E =
            sr_render_irradiance(job, sr_render_place(job, m), (sr_vec3){(float)m[3], (float)m[4], (float)m[5]},
                                 METER_SAMPLES, METER_REPLICATES);
        struct sr_quantity E_v = {.value = E.E_v, .u = E.E_v_error, .degrees = E.degrees};
        struct sr_quantity E_e = {.value = E.E_e, .u = E.E_e_error, .degrees = E.degrees};
        E_v.unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_PHOTOPIC, false);
        E_e.unit = sr_unit_of(SR_KIND_FLUX_DENSITY, SR_RADIOMETRIC, false);
        char seen[128], energy[128];
        if (!a->quiet)
            fprintf(stderr, "irradiance at (%g, %g, %g) m, normal (%g, %g, %g): %s, %s\n", m[0], m[1], m[2], m[3], m[4],
                    m[5], sr_quantity_text("E_v", &E_v, seen, sizeof seen),
                    sr_quantity_text("E_e", &E_e, energy, sizeof energy));
        json_array_append_new(list, json_pack("{s:[f,f,f], s:[f,f,f], s:o, s:o}", "point_m", m[0], m[1], m[2], "normal",
                                              m[3], m[4], m[5], "E_v", command_json_measured(&E_v), "E_e",
                                              command_json_measured(&E_e)));
    }
    return list;
}

void render_print_summary(const struct rendering *r, const struct sr_film *film, const struct sr_render_report *report)
{
    struct sr_scene_counts all = sr_scene_count(r->scene->scene), *counts = &all;
    picture_print_mean(film, !r->job->replicates && !r->job->adaptive.is_on);
    fprintf(stderr, "%u x %u pixels, %.6g samples each%s, %s units; %.2f s, %.2f M paths/s, %.2f M rays/s\n",
            film->width, film->height, picture_mean_spp(film), r->job->adaptive.is_on ? " on average" : "",
            r->scene->units == SR_UNITS_SI ? "SI" : "photometric", report->render_s,
            1e-6 * rate((double)report->paths, report->render_s),
            1e-6 * rate((double)(report->rays + report->shadow_rays), report->render_s));
    if (report->remark[0])
        fprintf(stderr, "%s\n", report->remark);
    if (r->job->adaptive.is_on)
        fprintf(stderr, "relative error of the picture %.3g %%", 100 * relative_error(r, film));
    if (r->job->adaptive.is_on && r->job->adaptive.error > 0)
        fprintf(stderr, ", aimed at %.3g %%%s", 100 * r->job->adaptive.error,
                render_missed_target(r, film) ? ": missed" : "");
    if (r->job->adaptive.is_on)
        fputc('\n', stderr);
    if (doubtful(r, film))
        fprintf(
            stderr,
            "warning: in %llu of %llu pixels one sample brings much of the light: their error bars may be too short\n",
            (unsigned long long)doubtful(r, film), (unsigned long long)film->width * film->height);
    if (r->arguments->stats)
        fprintf(
            stderr,
            "scene: %llu triangles, %llu patches, %llu quadrics, %llu curves, %llu instances, %llu lights, %llu materials; read "
            "%.2f s, built %.2f s\n"
            "memory: geometry %.1f MiB, acceleration %.1f MiB, peak %.1f MiB; rays %llu, shadow rays %llu, "
            "vertices %llu; never met: %llu primitives without area, %llu too large, %llu not finite; %llu duplicate triangles\n",
            (unsigned long long)counts->triangles, (unsigned long long)counts->patches,
            (unsigned long long)counts->quadrics, (unsigned long long)counts->curves,
            (unsigned long long)counts->instances, (unsigned long long)counts->lights,
            (unsigned long long)counts->materials, r->scene->read_s, counts->build_s,
            (double)counts->geometry_B / 1048576, (double)counts->acceleration_B / 1048576,
            (double)sr_peak_memory_B() / 1048576, (unsigned long long)report->rays,
            (unsigned long long)report->shadow_rays, (unsigned long long)report->vertices,
            (unsigned long long)counts->degenerate, (unsigned long long)counts->too_large,
            (unsigned long long)counts->not_finite, (unsigned long long)sr_scene_count_duplicates(r->scene->scene));
}

/* The settings that made the picture, enough to make it again. */
static json_t *settings_json(const struct rendering *r, const struct sr_film *film)
{
    const struct sr_render_job *job = r->job;
    json_t *j = json_pack(
        "{s:o, s:s, s:i, s:i, s:s, s:f, s:I, s:I, s:b, s:s, s:s, s:{s:o, s:o, s:s}}", "scene",
        command_json_text(r->arguments->scene), "units", r->scene->units == SR_UNITS_SI ? "si" : "photometric", "width",
        (int)film->width, "height", (int)film->height, "size_unit", "pixel", "spp", picture_mean_spp(film), "seed",
        (json_int_t)job->seed, "replicates", (json_int_t)job->replicates, "adaptive", job->adaptive.is_on, "integrator",
        sr_integrator_label(&job->integrator), "sampler", job->sampler == SR_SAMPLER_SOBOL ? "sobol" : "independent",
        "wavelengths", "min", command_json_number((double)job->lambda.lo), "max",
        command_json_number((double)job->lambda.hi), "unit", "nm");
    if (j && r->range.end)
        json_object_set_new(j, "sample_range",
                            json_pack("[I, I]", (json_int_t)r->range.begin, (json_int_t)r->range.end));
    return j;
}

int render_print_json(const struct rendering *r, const struct sr_film *film, const struct sr_render_report *report,
                      json_t *meters)
{
    struct sr_scene_counts counts = sr_scene_count(r->scene->scene);
    struct sr_quantity L = picture_mean_luminance(film);
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->scene->hash);
    json_t *outputs = json_array();
    for (int i = 0; i < render_output_count(r->arguments); ++i)
        json_array_append_new(outputs, command_json_text(render_output_name(r->arguments, r->scene, i)));
    json_t *j = json_pack(
        "{s:s, s:s, s:o, s:b, s:o, s:o, s:{s:f, s:f, s:f, s:f, s:f, s:f, s:I}, s:{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, "
        "s:I, s:I, s:I, s:I, s:I, s:I, s:I}, s:o, s:o}",
        "version", SR_VERSION, "scene_hash", hash, "outputs", outputs, "complete", report->is_complete, "settings",
        settings_json(r, film), "mean_luminance", command_json_measured(&L), "time", "read_s", r->scene->read_s,
        "build_s", counts.build_s, "render_s", report->render_s, "render_cpu_s", r->cpu_s, "paths_per_s",
        rate((double)report->paths, report->render_s), "rays_per_s",
        rate((double)(report->rays + report->shadow_rays), report->render_s), "peak_memory_B",
        (json_int_t)sr_peak_memory_B(), "counts", "triangles", (json_int_t)counts.triangles, "patches",
        (json_int_t)counts.patches, "quadrics", (json_int_t)counts.quadrics, "curves", (json_int_t)counts.curves,
        "lights", (json_int_t)counts.lights, "paths", (json_int_t)report->paths, "rays", (json_int_t)report->rays,
        "shadow_rays", (json_int_t)report->shadow_rays, "vertices", (json_int_t)report->vertices, "dropped_samples",
        (json_int_t)report->dropped, "primitives_without_area", (json_int_t)counts.degenerate, "primitives_too_large",
        (json_int_t)counts.too_large, "primitives_not_finite", (json_int_t)counts.not_finite, "duplicate_triangles",
        (json_int_t)sr_scene_count_duplicates(r->scene->scene), "doubtful_pixels",
        (json_int_t)sr_film_doubtful_pixels(film), "irradiance", meters, "relative_error",
        command_json_number(relative_error(r, film)));
    const struct sr_render_kept *kept = &report->kept;
    if (j && r->keep)
        json_object_set_new(j, "checkpoint",
                            json_pack("{s:o, s:i, s:i, s:f, s:f, s:f}", "file", command_json_text(r->keep->path),
                                      "written", (int)kept->written, "failed", (int)kept->failed, "stall_s",
                                      kept->stall_s, "write_s", kept->write_s, "resumed_share", kept->resumed_share));
    return command_print_json("render", j);
}
