/* SPDX-License-Identifier: MIT */
/* A rendered picture into files, with what others need to know of it as attributes. */
#define _POSIX_C_SOURCE 200809L
#include "picture.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

/* "fisheye; mapping equisolid; fov 180": words and numbers of the camera, so that others know where each pixel looks.
 */
static void camera_text(const struct sr_sensor *sensor, char *text, size_t size)
{
    int n = snprintf(text, size, "%s", sensor->model->name);
    for (const struct sr_param *p = sensor->model->params; p->name && n < (int)size; ++p) {
        const char *value = (const char *)sensor->self + p->offset;
        if (p->kind == SR_PARAM_FLOAT && isfinite(*(const float *)(const void *)value))
            n += snprintf(text + n, size - (size_t)n, "; %s %g", p->name, (double)*(const float *)(const void *)value);
        if (p->kind != SR_PARAM_ENUM)
            continue;
        const char *choice = p->text;
        for (int32_t skip = *(const int32_t *)(const void *)value; skip > 0 && strchr(choice, '|'); --skip)
            choice = strchr(choice, '|') + 1;
        n += snprintf(text + n, size - (size_t)n, "; %s %.*s", p->name, (int)strcspn(choice, "|"), choice);
    }
}

char *picture_about(struct sr_arena *arena, const struct sr_render_job *job, uint64_t scene_hash, enum sr_units units)
{
    char camera[400];
    camera_text(&job->sensor, camera, sizeof camera);
    return sr_arena_printf(
        arena,
        "steradian.version %s\nsteradian.sceneHash %016llx\nsteradian.seed %u\nsteradian.replicates %u\n"
        "steradian.integrator %s\nsteradian.camera %s\nsteradian.lambda %g..%g nm\nsteradian.units %s\n",
        SR_VERSION, (unsigned long long)scene_hash, job->seed, job->replicates, sr_integrator_label(&job->integrator),
        camera, (double)job->lambda.lo, (double)job->lambda.hi, units == SR_UNITS_SI ? "si" : "photometric");
}

static void describe(struct sr_image *image, const struct picture *p, struct sr_error *error)
{
    char name[64], text[512];
    snprintf(text, sizeof text, "%.9g", picture_mean_spp(p->film));
    sr_image_set_attribute(image, "steradian.samplesPerPixel", text, error);
    for (const char *line = p->about; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        int n = (int)strcspn(line, " \n"), end = (int)strcspn(line, "\n");
        snprintf(name, sizeof name, "%.*s", n, line);
        snprintf(text, sizeof text, "%.*s", end > n ? end - n - 1 : 0, line + n + (end > n));
        sr_image_set_attribute(image, name, text, error);
    }
    if (!p->is_complete)
        sr_image_set_attribute(image, "steradian.complete", "no", error);
    if (p->has_stamp) {
        time_t now = time(NULL);
        struct tm utc;
        gmtime_r(&now, &utc);
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
        sr_image_set_attribute(image, "steradian.date", text, error);
        snprintf(text, sizeof text, "%.3f", p->elapsed_s);
        sr_image_set_attribute(image, "steradian.renderTimeSeconds", text, error);
    }
}

sr_status picture_write(const struct picture *p, const char *const *names, int count, struct sr_error *error)
{
    struct sr_image *image;
    if (sr_render_image(p->film, true, p->is_replicated, &image, error) != SR_OK)
        return error->status;
    describe(image, p, error);
    struct sr_image_write_options options = {
        .tone = {.op = SR_TONE_LINEAR, .is_auto = !p->has_exposure, .exposure_EV = (float)p->exposure_EV}};
    for (int i = 0; i < count; ++i)
        if (command_is_image_ending(names[i]))
            sr_image_write(names[i], image, &options, error);
    sr_image_free(image);
    return error->status;
}

/* ---- in words ---- */

struct sr_quantity picture_mean_luminance(const struct sr_film *film)
{
    const struct sr_colour_space *space = sr_colour_space(film->settings.space);
    struct sr_film_mean L = sr_film_region_mean(film, 0, 0, film->width, film->height, space->xyz_from_rgb[1]);
    struct sr_unit unit = {0};
    if (sr_film_is_luminance(&film->settings))
        unit = sr_unit_of(SR_KIND_RADIANCE, SR_PHOTOPIC, false);
    return (struct sr_quantity){.value = L.mean, .u = L.standard_error, .degrees = L.degrees, .unit = unit};
}

void picture_print_mean(const struct sr_film *film, bool is_conservative)
{
    struct sr_quantity L = picture_mean_luminance(film);
    bool is_luminance = sr_film_is_luminance(&film->settings);
    char text[128];
    fprintf(stderr, "%s %s%s\n", is_luminance ? "mean luminance" : "mean of the picture",
            sr_quantity_text(is_luminance ? "L_v" : "Y", &L, text, sizeof text),
            is_conservative && isfinite(L.u) ? ", conservative" : "");
    if (!is_luminance)
        fprintf(
            stderr,
            "note: the picture is as its film is set (sensor, shutter and iso, white balance, maxcomponentvalue): its values are no luminances\n");
}

double picture_mean_spp(const struct sr_film *film)
{
    double sum = 0, count = (double)film->width * film->height;
    for (size_t i = 0; i < (size_t)film->width * film->height; ++i)
        sum += film->pixels[i].n;
    return sum / count;
}
