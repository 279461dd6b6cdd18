/* SPDX-License-Identifier: MIT */
/* steradian render: what it writes and when: at the end, when interrupted, every so many seconds, and on request. */
#define _POSIX_C_SOURCE 200809L
#include "render_command.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
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
        if (a->has_range && sr_path_has_ending(name, PART_ENDING))
            continue;
        if (!a->has_range && sr_path_has_ending(name, PART_ENDING))
            return command_usage(&command_render, "%s: a part of a picture needs --sample-range or --part", name);
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
    double splats_B = job->integrator.model->splats
                          ? (double)sr_film_splats_B(groups < SR_SPLAT_GROUPS ? groups : SR_SPLAT_GROUPS)
                          : 0;
    double adaptive_B =
        job->adaptive.is_on ? sizeof(struct sr_film_pixel) + (job->with_aov ? sizeof(struct sr_film_aov) : 0) + 32 : 0;
    return splats_B + adaptive_B + (double)sizeof(struct sr_film_pixel) +
           (job->with_aov ? (double)sizeof(struct sr_film_aov) : 0) + 2 * channels * sizeof(float);
}

static double memory_there_B(void)
{
    return (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
}

static double pixels_of(const struct sr_render_job *job)
{
    return ((double)job->film.x1 - job->film.x0) * ((double)job->film.y1 - job->film.y0);
}

bool render_has_room(const struct sr_render_job *job, int copies)
{
    return !(copies * pixels_of(job) * pixel_B(job) > memory_there_B());
}

sr_status render_check_memory(const struct sr_render_job *job, const struct sr_render_range *range,
                              struct sr_error *error)
{
    double needed_B = pixels_of(job) * (pixel_B(job) + (range ? sr_render_samples_B(job, *range) : 0)),
           there_B = memory_there_B();
    if (there_B > 0 && needed_B > there_B)
        return sr_fail(
            error, SR_ERROR_RESOURCE, "a picture of %d x %d pixels needs %.3g GiB of memory, this machine has %.3g GiB",
            job->film.x1 - job->film.x0, job->film.y1 - job->film.y0, needed_B / 1073741824, there_B / 1073741824);
    return SR_OK;
}

/* ---- writing ---- */

sr_status render_write_outputs(const struct rendering *r, const struct sr_film *film, double elapsed_s,
                               bool is_complete, struct sr_error *error)
{
    const struct render_arguments *a = r->arguments;
    const char *names[RENDER_MAX_OUTPUTS];
    for (int i = 0; i < render_output_count(a); ++i)
        names[i] = render_output_name(a, r->scene, i);
    struct picture p = {.film = film,
                        .about = r->about,
                        .is_replicated = r->job->replicates > 0 || r->job->adaptive.is_on,
                        .is_complete = is_complete,
                        .has_exposure = a->has_exposure,
                        .exposure_EV = a->exposure_EV,
                        .has_stamp = a->stamp,
                        .elapsed_s = elapsed_s};
    return picture_write(&p, names, render_output_count(a), error);
}

/* ---- signals: flags, looked at by those who work ---- */

atomic_bool render_interrupted;
static atomic_int interrupt_signal;
static atomic_bool is_partial_wanted, is_deferred;

static void on_interrupt(int number)
{
    if (atomic_exchange(&interrupt_signal, number) || !atomic_load(&is_deferred))
        _exit(128 + number); // asked twice, or nothing is there yet: at once
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

void render_end_by_interrupts(void)
{
    catch (SIGINT, on_interrupt);
    catch (SIGTERM, on_interrupt);
    struct sigaction before; // a terminal or a connection that ends; nohup says that it does not matter
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        catch (SIGHUP, on_interrupt);
}

void render_catch_interrupts(void)
{
    atomic_store(&is_deferred, true);
    render_end_by_interrupts();
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

/* A bar that grows in place, or a line of a log. */
static void print_progress(const struct sr_render_progress *p, bool in_place)
{
    enum { CELLS = 24 };
    char bar[CELLS + 3] = "", elapsed[32], left[32];
    for (int i = 0; in_place && i < CELLS; ++i)
        bar[i] = i < p->share * CELLS ? '#' : '.';
    if (in_place)
        memcpy(bar + CELLS, "  ", sizeof "  ");
    fprintf(stderr, "%s%5.1f %% %s%s, %s left, %.2f M rays/s%s", in_place ? "\r" : "", 100 * p->share, bar,
            duration(p->elapsed_s, elapsed), duration(p->left_s, left),
            p->elapsed_s > 0 ? 1e-6 * (double)p->rays / p->elapsed_s : 0, in_place ? "\033[K" : "\n");
}

void render_on_progress(void *user, const struct sr_render_progress *p)
{
    struct rendering *r = user;
    const struct render_arguments *a = r->arguments;
    if (r->on_terminal) {
        print_progress(p, true);
    } else if (a->progress_s > 0 && !a->quiet && p->elapsed_s - r->last_progress_s >= a->progress_s) {
        print_progress(p, false);
        r->last_progress_s = p->elapsed_s;
    }
    bool is_asked = atomic_exchange(&is_partial_wanted, false);
    if (a->has_range)
        return; // a part is written when it is whole
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
