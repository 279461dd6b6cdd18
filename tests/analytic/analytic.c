/* SPDX-License-Identifier: MIT */
/* Scenes from text, estimates with standard errors, verdicts. */
#include "analytic/analytic.h"

#include <stdarg.h>

double effort(void)
{
    const char *text = getenv("STERADIAN_TEST_EFFORT");
    double factor = text ? atof(text) : 1;
    return (factor > 0 ? factor : 1) / (is_slow_build() ? 64 : 1);
}

uint32_t samples(double n)
{
    return (uint32_t)fmin(fmax(ceil(n * effort()), 8), 4e9);
}

/* ---- verdicts ---- */

static int failures;

double z_of(struct estimate e, double value)
{
    double d = e.mean - value;
    if (!(e.error > 0))
        return d == 0 ? 0 : copysign(INFINITY, d);
    double t = fabs(d) / e.error;
    if (t > 30)
        return copysign(t, d);
    return copysign(-sr_normal_quantile(fmax(sr_student_p_two_sided(t, e.degrees), 1e-300) / 2), d);
}

void check(const struct row *row, const char *how, struct estimate e, double goal)
{
    double z = z_of(e, row->value), relative = e.mean / row->value - 1, relative_error = e.error / fabs(row->value);
    // a slow build takes few samples, too few for a tail of a distribution: it looks for faults of memory
    bool is_right = fabs(z) < (is_slow_build() ? 10 : 4.9) || fabs(relative) <= FLOAT_GOAL;
    bool is_sharp =
        is_slow_build() || relative_error <= goal / sqrt(fmax(1, fmin(effort(), goal * goal / (GOAL * GOAL))));
    printf("  %-12s %-10s %-16.12g %-16.10g +- %-9.2e %+9.2e %7.2f %s%s\n", row->id, how, row->value, e.mean, e.error,
           relative, z, is_right ? "" : "WRONG ", is_sharp ? "" : "NOT SHARP");
    failures += !is_right || !is_sharp;
}

void run_rows(const char *title, const struct row *rows)
{
    failures = 0;
    setvbuf(stdout, NULL, _IOLBF, 0);
    printf("%s\n  %-12s %-10s %-16s %-16s    %-9s %9s %7s\n", title, "id", "how", "value", "ours", "SE", "relative",
           "z");
    const char *only = getenv("STERADIAN_TEST_ROWS"); // how their ids begin
    for (const struct row *row = rows; row->id; ++row)
        if (!only || strncmp(row->id, only, strlen(only)) == 0)
            row->measure(row);
    if (failures)
        test_fail(__FILE__, __LINE__, "%s: %d measurements are wrong or not sharp", title, failures);
}

/* ---- scenes ---- */

struct world world_of(const char *format, ...)
{
    static char text[1 << 19], path[512];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    EXPECT(length > 0 && length < (int)sizeof text);
    snprintf(path, sizeof path, "%s/analytic.pbrt", test_folder());
    struct sr_error error = {0};
    struct sr_log silent = {0};
    struct sr_import_options options = {0};
    struct world w = {0};
    if (sr_file_write(path, text, (size_t)length, &error) != SR_OK ||
        sr_import_pbrt(path, &options, &w.scene, &silent, &error) != SR_OK)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    w.job = sr_render_job_of(&w.scene);
    w.job.seed = 1;
    return w;
}

void world_free(struct world *w)
{
    sr_import_result_free(&w->scene);
}

const char *receiver_text(const double p[3], const double n[3])
{
    static char text[1024];
    sr_vec3 z = sr_normalize((sr_vec3){(float)n[0], (float)n[1], (float)n[2]});
    struct sr_frame f = sr_frame_from_z(z);
    double t[3] = {(double)f.x.x, (double)f.x.y, (double)f.x.z}, b[3] = {(double)f.y.x, (double)f.y.y, (double)f.y.z};
    double N[3] = {(double)z.x, (double)z.y, (double)z.z}, v[4][3], eye[3];
    for (int i = 0; i < 3; ++i) {
        eye[i] = p[i] + 0.01 * (N[i] + 0.5 * t[i]);
        for (int k = 0; k < 4; ++k)
            v[k][i] = p[i] + 1e-3 * ((k & 1 ? 1 : -1) * t[i] + (k & 2 ? 1 : -1) * b[i]);
    }
    snprintf(
        text, sizeof text,
        "LookAt %.9g %.9g %.9g  %.9g %.9g %.9g  %.9g %.9g %.9g\nCamera \"perspective\" \"float fov\" 0.01\n"
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nPixelFilter \"box\"\nWorldBegin\n"
        "AttributeBegin\n" GREY
        "Shape \"bilinearmesh\" \"point3 P\" [%.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g]\nAttributeEnd\n",
        eye[0], eye[1], eye[2], p[0], p[1], p[2], N[0], N[1], N[2], v[0][0], v[0][1], v[0][2], v[1][0], v[1][1],
        v[1][2], v[2][0], v[2][1], v[2][2], v[3][0], v[3][1], v[3][2]);
    return text;
}

/* ---- estimates ---- */

struct estimating {
    const struct sr_render_job *job;
    draw_ray *draw;
    const void *context;
    uint32_t x, y, n;
    const double *xyz;
    double *sums; // of each replicate
};

static void draw_replicate(void *context, uint64_t r)
{
    struct estimating *e = context;
    const struct sr_render_job *job = e->job;
    struct sr_worker worker = {0};
    double sum = 0;
    for (uint32_t i = 0; i < e->n; ++i) {
        struct sr_sampler sampler = sr_sampler_start(job->sampler, job->seed, 17, 4, (uint32_t)r, i);
        sr_u4 u = sr_sample4(&sampler, SR_USE_FILM), v = sr_sample4(&sampler, SR_USE_LENS);
        struct sr_wavelengths w = sr_wavelengths_sample(job->lambda, v[2]);
        struct drawn d = e->draw(e->context, (sr_vec2){u[0], u[1]}, (sr_vec2){u[2], u[3]});
        if (d.weight == 0)
            continue;
        struct sr_path_start start = {.ray = {.o = d.o, .d = d.d, .t_max = INFINITY}};
        start.medium = sr_scene_medium_at(job->scene, &start.ray);
        sr_spectrum L = job->integrator.model->L(job->integrator.self, job->scene, &start, &sampler, &w, NULL, &worker);
        sum += d.weight * (double)sr_spectrum_to_xyz(L, &w).y;
    }
    e->sums[r] = sum;
}

static void pixel_replicate(void *context, uint64_t r)
{
    struct estimating *e = context;
    struct sr_worker worker = {0};
    const struct sr_colour_space *space = sr_colour_space(e->job->film.space);
    double sum[3] = {0}, total = 0;
    for (uint32_t i = 0; i < e->n; ++i) {
        float rgb[3];
        sr_render_sample(e->job, e->x, e->y, (uint32_t)r, i, rgb, NULL, &worker);
        for (int c = 0; c < 3; ++c)
            sum[c] += (double)rgb[c];
    }
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            total += e->xyz[i] * space->xyz_from_rgb[i][c] * sum[c];
    e->sums[r] = total;
}

static struct estimate run_once(struct estimating *e, void (*replicate)(void *, uint64_t))
{
    double sums[REPLICATES] = {0};
    e->sums = sums;
    sr_parallel_for(sr_thread_count(), REPLICATES, replicate, e);
    struct sr_tally tally = {0};
    for (int r = 0; r < REPLICATES; ++r)
        sr_tally_add(&tally, sums[r] / e->n);
    return (struct estimate){tally.mean, sr_tally_standard_error(&tally), REPLICATES - 1};
}

/* Whoever asks names the most samples. A sixteenth of them, or a quarter, are enough where they are much sharper than
 * any row demands: the spread alone decides, not what it is around. */
static struct estimate run(struct estimating *e, void (*replicate)(void *, uint64_t))
{
    uint32_t most = e->n;
    for (uint32_t part = 16; part > 1; part /= 4) {
        e->n = most / part;
        if (e->n < 256)
            continue;
        struct estimate got = run_once(e, replicate);
        if (got.error <= 0.25 * GOAL * fabs(got.mean))
            return got;
        if (got.error > 4 * GOAL * fabs(got.mean))
            break;
    }
    e->n = most;
    return run_once(e, replicate);
}

struct estimate mean_luminance(const struct sr_render_job *job, draw_ray *draw, const void *context, double n_samples)
{
    struct estimating e = {.job = job, .draw = draw, .context = context, .n = samples(n_samples)};
    return run(&e, draw_replicate);
}

struct estimate pixel_mean(const struct sr_render_job *job, uint32_t x, uint32_t y, double n_samples,
                           const double xyz[3])
{
    struct estimating e = {.job = job, .x = x, .y = y, .n = samples(n_samples), .xyz = xyz};
    return run(&e, pixel_replicate);
}

struct estimate scaled(struct estimate e, double factor)
{
    return (struct estimate){e.mean * factor, e.error * fabs(factor), e.degrees};
}

void check_irradiance(const struct row *row, const double p[3], const double n[3], const char *content,
                      struct effort n_samples, double factor)
{
    static const struct {
        const char *how, *integrator;
    } ways[] = {
        {"meter", "Integrator \"path\" \"integer maxdepth\" 0\n"},
        {"path", "Integrator \"path\" \"integer maxdepth\" 1\n"},
        {"lights", "Integrator \"simplepath\" \"integer maxdepth\" 1\n"},
        {"surface", "Integrator \"simplepath\" \"integer maxdepth\" 1 \"bool samplelights\" false\n"},
    };
    double count[] = {n_samples.meter, n_samples.path, n_samples.lights, n_samples.surface};
    for (int i = 0; i < 4; ++i) {
        if (count[i] == 0)
            continue;
        struct world w = world_of("%s%s%s", ways[i].integrator, receiver_text(p, n), content);
        struct estimate e;
        if (i == 0) {
            struct sr_irradiance E =
                sr_render_irradiance(&w.job, (sr_vec3){(float)p[0], (float)p[1], (float)p[2]},
                                     (sr_vec3){(float)n[0], (float)n[1], (float)n[2]}, samples(count[i]), REPLICATES);
            e = (struct estimate){E.E_v, E.E_v_error, E.degrees};
        } else {
            e = scaled(pixel_mean(&w.job, 0, 0, count[i], (const double[]){0, 1, 0}), (double)SR_PI / RECEIVER_RHO);
        }
        check(row, ways[i].how, scaled(e, factor), GOAL);
        world_free(&w);
    }
}
