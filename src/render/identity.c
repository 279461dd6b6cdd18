/* SPDX-License-Identifier: MIT */
/* What makes the bytes of a picture, as text: two runs whose identities are equal give equal bytes, and sums of one may
 * be continued by the other. Threads, tiles, outputs and times have no say in them, and do not stand here. What scene
 * files hold is known by their hash; what they leave to the program and its options stands here by name. */
#include "render/render.h"

#include <stdio.h>
#include <string.h>

/* What levels do not tell of processors between two of them. */
#if defined(__AVX512F__)
static const char instructions[] = "avx512";
#elif defined(__AVX2__) && defined(__FMA__)
static const char instructions[] = "avx2+fma";
#elif defined(__AVX__)
static const char instructions[] = "avx";
#elif defined(__aarch64__)
static const char instructions[] = "arm64";
#else
static const char instructions[] = "baseline";
#endif

struct text {
    struct sr_array bytes; // NUL is not among them
    bool has_failed;
};

SR_PRINTF(2, 3) static void add_line(struct text *t, const char *format, ...)
{
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(line, sizeof line - 1, format, arguments);
    va_end(arguments);
    n = n < (int)sizeof line - 1 ? n : (int)sizeof line - 2;
    for (int i = 0; i < n; ++i)
        if (line[i] == '\n')
            line[i] = ' ';
    line[n++] = '\n';
    if (t->has_failed || !sr_array_reserve(&t->bytes, t->bytes.count + (size_t)n, 1)) {
        t->has_failed = true;
        return;
    }
    memcpy((char *)t->bytes.data + t->bytes.count, line, (size_t)n);
    t->bytes.count += (size_t)n;
}

/* Numbers and words of a model; what its files and spectra hold is the scene's. */
static void add_params(struct text *t, const char *what, const struct sr_param *params, const void *self)
{
    for (const struct sr_param *p = params; p && p->name; ++p) {
        const void *v = (const char *)self + p->offset;
        const float *f = v;
        if (p->kind == SR_PARAM_BOOL)
            add_line(t, "%s.%s %s", what, p->name, *(const bool *)v ? "yes" : "no");
        else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
            add_line(t, "%s.%s %d", what, p->name, *(const int32_t *)v);
        else if (p->kind == SR_PARAM_FLOAT)
            add_line(t, "%s.%s %.9g", what, p->name, (double)*f);
        else if (p->kind == SR_PARAM_STRING)
            add_line(t, "%s.%s %s", what, p->name, *(const char *const *)v ? *(const char *const *)v : "");
        else if (p->kind == SR_PARAM_POINT2)
            add_line(t, "%s.%s %.9g %.9g", what, p->name, (double)f[0], (double)f[1]);
        else if (p->kind == SR_PARAM_POINT3 || p->kind == SR_PARAM_VECTOR3 || p->kind == SR_PARAM_NORMAL3)
            add_line(t, "%s.%s %.9g %.9g %.9g", what, p->name, (double)f[0], (double)f[1], (double)f[2]);
    }
}

static void add_film(struct text *t, const struct sr_film_settings *f)
{
    add_line(t, "film.size %d %d", f->width, f->height);
    add_line(t, "film.crop %d %d %d %d", f->x0, f->x1, f->y0, f->y1);
    add_line(t, "film.space %d", (int)f->space);
    add_line(t, "film.iso %.9g", (double)f->iso);
    add_line(t, "film.exposure_time %.9g s", (double)f->exposure_time);
    add_line(t, "film.white_balance %.9g K", (double)f->white_balance);
    add_line(t, "film.max_component %.9g", (double)f->max_component);
    add_line(t, "film.camera %u", f->camera1);
    add_line(t, "film.buckets %u %.9g %.9g %.9g", f->buckets, (double)f->lambda_min, (double)f->lambda_max,
             (double)f->bucket_scale);
    add_line(t, "film.gbuffer %s", f->is_gbuffer ? f->of_points ? "camera" : "world" : "no");
}

char *sr_render_identity(struct sr_arena *arena, const struct sr_render_job *job, const char *scene)
{
    struct text t = {0};
    add_line(&t, "format 1");
    add_line(&t, "version %s", SR_VERSION);
    add_line(&t, "compiler %s", __VERSION__);
    add_line(&t, "instruction_set %s (%s)", sr_isa(), instructions);
    for (const char *p = scene; p && *p; p += strcspn(p, "\n"), p += *p == '\n')
        add_line(&t, "scene.%.*s", (int)strcspn(p, "\n"), p);
    add_line(&t, "seed %u", job->seed);
    add_line(&t, "spp %u", job->spp);
    add_line(&t, "replicates %u", job->replicates);
    add_line(&t, "adaptive %s", job->adaptive.is_on ? "yes" : "no");
    if (job->adaptive.is_on) {
        add_line(&t, "adaptive.error %.17g", job->adaptive.error);
        add_line(&t, "adaptive.time %.17g s", job->adaptive.time_s);
    }
    add_line(&t, "estimator %s", sr_integrator_label(&job->integrator));
    add_params(&t, "estimator", job->integrator.model->params, job->integrator.self);
    add_film(&t, &job->film);
    add_line(&t, "aov %s", job->with_aov || job->film.is_gbuffer ? "yes" : "no");
    add_line(&t, "sensor %s", job->sensor.model->name);
    add_params(&t, "sensor", job->sensor.model->params, job->sensor.self);
    add_line(&t, "filter %s", job->filter.model ? job->filter.model->name : "none");
    if (job->filter.model)
        add_params(&t, "filter", job->filter.model->params, job->filter.self);
    add_line(&t, "sampler %d", (int)job->sampler);
    add_line(&t, "wavelengths %d", SR_LAMBDA_COUNT);
    add_line(&t, "lambda %.9g %.9g nm", (double)job->lambda.lo, (double)job->lambda.hi);
    add_line(&t, "jitter.pixel %s", job->jitter_pixel ? "yes" : "no");
    add_line(&t, "jitter.lambda %s", job->jitter_lambda ? "yes" : "no");
    char *text = t.has_failed ? NULL : sr_arena_printf(arena, "%.*s", (int)t.bytes.count, (const char *)t.bytes.data);
    sr_array_free(&t.bytes);
    return text;
}

/* The line of the key that `line` begins with, or NULL. */
static const char *find_key(const char *text, const char *line)
{
    size_t n = strcspn(line, " \n");
    for (const char *p = text; *p; p += strcspn(p, "\n"), p += *p == '\n')
        if (strncmp(p, line, n) == 0 && strcspn(p, " \n") == n)
            return p;
    return NULL;
}

/* What stands after the key. */
static void copy_value(const char *line, char *value, size_t size)
{
    const char *p = line ? line + strcspn(line, " \n") : " nothing";
    p += *p == ' ';
    snprintf(value, size, "%.*s", (int)strcspn(p, "\n"), p);
}

bool sr_render_identity_differs(const char *theirs, const char *ours, struct sr_render_difference *d)
{
    for (int turn = 0; turn < 2; ++turn) {
        const char *from = turn ? theirs : ours, *other = turn ? ours : theirs;
        for (const char *p = from; *p; p += strcspn(p, "\n"), p += *p == '\n') {
            const char *q = find_key(other, p);
            size_t n = strcspn(p, "\n");
            if (q && strcspn(q, "\n") == n && memcmp(p, q, n) == 0)
                continue;
            snprintf(d->key, sizeof d->key, "%.*s", (int)strcspn(p, " \n"), p);
            copy_value(turn ? p : q, d->theirs, sizeof d->theirs);
            copy_value(turn ? q : p, d->ours, sizeof d->ours);
            return true;
        }
    }
    return false;
}
