/* SPDX-License-Identifier: MIT */
/* steradian render: what it writes and when: at the end, when interrupted, every so many seconds, and on request. */
#define _POSIX_C_SOURCE 200809L
#include "render_command.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* ---- before any work ---- */

int render_output_count(const struct render_arguments *a)
{
    return a->output_count ? a->output_count : 1;
}

const char *render_output_name(const struct render_arguments *a, const struct sr_import_result *scene, int i)
{
    return a->output_count ? a->outputs[i] : scene->film.filename;
}

int render_check_outputs(const struct render_arguments *a, const struct sr_import_result *scene)
{
    struct sr_error error = {0};
    for (int i = 0; i < render_output_count(a); ++i) {
        const char *name = render_output_name(a, scene, i);
        if (command_check_output(name, &error) != SR_OK)
            break;
        if (!command_is_image_ending(name) && a->output_count)
            return command_usage(&command_render, "%s: the ending .exr, .png, .pfm or .hdr was expected", name);
        if (!command_is_image_ending(name))
            sr_fail(&error, SR_ERROR_INPUT,
                    "%s: the scene's own file name is \"%s\"; .exr, .png, .pfm and .hdr can be written: use -o",
                    a->scene, name);
    }
    return error.status ? command_fail("render", &error) : 0;
}

/* What one pixel needs: sums while rendering, then all channels as floats, once as an image and once as a file. */
static double pixel_B(const struct sr_render_job *job)
{
    double channels = job->with_aov ? 25 : 7;
    uint32_t groups = job->replicates ? job->replicates : 4; // of splats
    double splats_B = job->integrator.model->splats ? (double)sr_film_splats_B(groups < SR_SPLAT_GROUPS ? groups : SR_SPLAT_GROUPS) : 0;
    double adaptive_B = job->adaptive.is_on ? sizeof(struct sr_film_pixel) + (job->with_aov ? sizeof(struct sr_film_aov) : 0) + 32 : 0;
    return splats_B + adaptive_B + (double)sizeof(struct sr_film_pixel) + (job->with_aov ? (double)sizeof(struct sr_film_aov) : 0) +
           2 * channels * sizeof(float);
}

sr_status render_check_memory(const struct sr_render_job *job, struct sr_error *error)
{
    double width = (double)job->film.x1 - job->film.x0, height = (double)job->film.y1 - job->film.y0;
    double needed_B = width * height * pixel_B(job);
    double there_B = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    if (there_B > 0 && needed_B > there_B)
        return sr_fail(error, SR_ERROR_RESOURCE,
                       "a picture of %.0f x %.0f pixels needs %.3g GiB of memory, this machine has %.3g GiB", width,
                       height, needed_B / 1073741824, there_B / 1073741824);
    return SR_OK;
}

/* ---- writing ---- */

/* "fisheye; mapping equisolid; fov 180": words and numbers of the camera, so that others know where each pixel looks. */
static void describe_camera(struct sr_image *image, const struct sr_sensor *sensor, struct sr_error *error)
{
    char text[400];
    int n = snprintf(text, sizeof text, "%s", sensor->model->name);
    for (const struct sr_param *p = sensor->model->params; p->name && n < (int)sizeof text; ++p) {
        const char *value = (const char *)sensor->self + p->offset;
        if (p->kind == SR_PARAM_FLOAT && isfinite(*(const float *)(const void *)value))
            n += snprintf(text + n, sizeof text - (size_t)n, "; %s %g", p->name, (double)*(const float *)(const void *)value);
        if (p->kind != SR_PARAM_ENUM)
            continue;
        const char *choice = p->text;
        for (int32_t skip = *(const int32_t *)(const void *)value; skip > 0 && strchr(choice, '|'); --skip)
            choice = strchr(choice, '|') + 1;
        n += snprintf(text + n, sizeof text - (size_t)n, "; %s %.*s", p->name, (int)strcspn(choice, "|"), choice);
    }
    sr_image_set_attribute(image, "steradian.camera", text, error);
}

static void describe(struct sr_image *image, const struct rendering *r, const struct sr_film *film, double elapsed_s, bool is_complete,
                     struct sr_error *error)
{
    char text[64];
#define ATTRIBUTE(name, ...)                                                                                           \
    do {                                                                                                               \
        snprintf(text, sizeof text, __VA_ARGS__);                                                                      \
        sr_image_set_attribute(image, name, text, error);                                                              \
    } while (0)
    ATTRIBUTE("steradian.version", "%s", SR_VERSION);
    ATTRIBUTE("steradian.sceneHash", "%016llx", (unsigned long long)r->scene->hash);
    ATTRIBUTE("steradian.seed", "%u", r->job->seed);
    ATTRIBUTE("steradian.samplesPerPixel", "%.9g", render_mean_spp(film));
    ATTRIBUTE("steradian.replicates", "%u", r->job->replicates);
    ATTRIBUTE("steradian.integrator", "%s", sr_integrator_label(&r->job->integrator));
    describe_camera(image, &r->job->sensor, error);
    ATTRIBUTE("steradian.lambda", "%g..%g nm", (double)r->job->lambda.lo, (double)r->job->lambda.hi);
    ATTRIBUTE("steradian.units", "%s", r->scene->units == SR_UNITS_SI ? "si" : "photometric");
    if (!is_complete)
        ATTRIBUTE("steradian.complete", "no");
    if (r->arguments->stamp) {
        time_t now = time(NULL);
        struct tm utc;
        gmtime_r(&now, &utc);
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
        sr_image_set_attribute(image, "steradian.date", text, error);
        ATTRIBUTE("steradian.renderTimeSeconds", "%.3f", elapsed_s);
    }
#undef ATTRIBUTE
}

sr_status render_write_outputs(const struct rendering *r, const struct sr_film *film, double elapsed_s,
                               bool is_complete, struct sr_error *error)
{
    struct sr_image *image;
    if (sr_render_image(film, true, r->job->replicates > 0 || r->job->adaptive.is_on, &image, error) != SR_OK)
        return error->status;
    describe(image, r, film, elapsed_s, is_complete, error);
    const struct render_arguments *a = r->arguments;
    struct sr_image_write_options options = {
        .tone = {.op = SR_TONE_LINEAR, .is_auto = !a->has_exposure, .exposure_EV = (float)a->exposure_EV}};
    for (int i = 0; i < render_output_count(a); ++i)
        sr_image_write(render_output_name(a, r->scene, i), image, &options, error);
    sr_image_free(image);
    return error->status;
}

/* ---- signals: flags, looked at by those who work ---- */

atomic_bool render_interrupted;
static atomic_int interrupt_signal;
static atomic_bool is_partial_wanted;

static void on_interrupt(int number)
{
    if (atomic_exchange(&interrupt_signal, number))
        _exit(128 + number); // asked twice: at once
    atomic_store(&render_interrupted, true);
}

static void on_request(int number)
{
    (void)number;
    atomic_store(&is_partial_wanted, true);
}

static void catch (int number, void (*handler)(int))
{
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, NULL);
}

void render_catch_requests(void)
{
    catch (SIGUSR1, on_request);
}

void render_catch_interrupts(void)
{
    catch (SIGINT, on_interrupt);
    catch (SIGTERM, on_interrupt);
}

int render_interrupt_exit(void)
{
    int number = atomic_load(&interrupt_signal);
    return 128 + (number ? number : SIGINT);
}

/* ---- progress ---- */

/* "12 s", "3 min 05 s", "2 h 03 min" */
static const char *duration(double s, char text[32])
{
    if (!isfinite(s) || s > 3.6e9)
        snprintf(text, 32, "?");
    else if (s < 59.5)
        snprintf(text, 32, "%.0f s", s);
    else if (s < 3570)
        snprintf(text, 32, "%d min %02d s", (int)(s + 0.5) / 60, (int)(s + 0.5) % 60);
    else
        snprintf(text, 32, "%d h %02d min", (int)(s / 60 + 0.5) / 60, (int)(s / 60 + 0.5) % 60);
    return text;
}

static void print_progress(const struct sr_render_progress *p)
{
    enum { CELLS = 24 };
    char bar[CELLS + 1], elapsed[32], left[32];
    for (int i = 0; i < CELLS; ++i)
        bar[i] = i < p->share * CELLS ? '#' : '.';
    bar[CELLS] = 0;
    fprintf(stderr, "\r%5.1f %% %s  %s, %s left, %.2f M rays/s\033[K", 100 * p->share, bar,
            duration(p->elapsed_s, elapsed), duration(p->left_s, left),
            p->elapsed_s > 0 ? 1e-6 * (double)p->rays / p->elapsed_s : 0);
}

void render_on_progress(void *user, const struct sr_render_progress *p)
{
    struct rendering *r = user;
    const struct render_arguments *a = r->arguments;
    if (r->on_terminal)
        print_progress(p);
    bool is_asked = atomic_exchange(&is_partial_wanted, false);
    if (!is_asked && !(a->partial_s > 0 && p->elapsed_s - r->last_partial_s >= a->partial_s))
        return;
    r->last_partial_s = p->elapsed_s;
    struct sr_error error = {0};
    const char *line_end = r->on_terminal ? "\n" : "";
    if (render_write_outputs(r, p->film, p->elapsed_s, false, &error) != SR_OK)
        fprintf(stderr, "%swarning: %s\n", line_end, error.text); // the render goes on
    else if (is_asked && !a->quiet)
        fprintf(stderr, "%swritten as it is now, %.1f %% done\n", line_end, 100 * p->share);
}
