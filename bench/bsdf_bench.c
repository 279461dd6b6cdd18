/* SPDX-License-Identifier: MIT */
/* How long f, pdf and sample of each model take, in ns of one processor: one line of JSON a model.
 *
 * Directions are drawn before: wo of the upper hemisphere in proportion to the cosine, wi as the sampler draws it and,
 * every second one, in proportion to the cosine. Parameters are the table's defaults, with slopes of at least 0.3, so
 * that models which can be mirrors are not. Medians of several runs of the processor's time; a value is for all
 * wavelengths. */
#include "bsdf_bench.h"

#include "bsdf/bsdf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PAIRS = 1024, TURNS = 20, RUNS = 9 };

struct pair {
    sr_vec3 wo, wi;
    float u_lobe;
    sr_vec2 u;
};

static double processor_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool defaults(const struct sr_bsdf_model *m, struct sr_arena *arena, struct sr_bsdf *b)
{
    struct sr_error error = {0};
    *b = (struct sr_bsdf){.model = m};
    for (const struct sr_param *p = m->params; p->name; ++p) {
        void *member = b->data + p->offset;
        float v = (float)p->initial;
        sr_spectrum even = SR_BLACK + v;
        if (strstr(p->name, "alpha"))
            v = sr_max(v, sr_min(0.3f, (float)p->max));
        if (p->kind == SR_PARAM_FLOAT)
            memcpy(member, &v, sizeof v);
        else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
            memcpy(member, &(int32_t){(int32_t)v}, sizeof(int32_t));
        else if (p->kind == SR_PARAM_BOOL)
            memcpy(member, &(bool){v != 0}, sizeof(bool));
        else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED)
            memcpy(member, &even, sizeof even);
    }
    return !m->load || m->load(b->data, arena, &error) == SR_OK; // false: it needs a file
}

static const struct sr_bsdf_at *at(void)
{
    static struct sr_bsdf_at a;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        a.lambda[i] = 400 + 300 * (float)i / SR_LAMBDA_COUNT;
    return &a;
}

static void draw(const struct sr_bsdf *b, struct pair *pairs)
{
    struct sr_rng rng = sr_rng_seed(1, 1);
    for (int i = 0; i < PAIRS; ++i) {
        float u[7];
        for (int k = 0; k < 7; ++k)
            u[k] = sr_rng_float(&rng);
        struct pair *p = &pairs[i];
        *p = (struct pair){.wo = sr_warp_cosine_hemisphere((sr_vec2){u[0], u[1]}),
                           .wi = sr_warp_cosine_hemisphere((sr_vec2){u[2], u[3]}),
                           .u_lobe = u[4],
                           .u = {u[5], u[6]}};
        struct sr_bsdf_sample s;
        if (i % 2 && sr_bsdf_sample(b, p->wo, p->u_lobe, p->u, SR_RADIANCE, &s))
            p->wi = s.wi;
    }
}

enum what { EVAL, PDF, EVAL_PDF, SAMPLE, READY, WHATS };
static const char *const names[WHATS] = {"eval_ns", "pdf_ns", "eval_pdf_ns", "sample_ns", "ready_ns"};

/* One sum keeps the compiler from leaving work out. */
static float work(enum what what, struct sr_bsdf *b, const struct pair *pairs)
{
    float sum = 0;
    for (int i = 0; i < PAIRS; ++i) {
        const struct pair *p = &pairs[i];
        struct sr_bsdf_sample s;
        float pdf;
        if (what == EVAL) {
            sum += sr_bsdf_f(b, p->wo, p->wi, SR_RADIANCE)[0];
        } else if (what == PDF) {
            sum += sr_bsdf_pdf(b, p->wo, p->wi, SR_RADIANCE);
        } else if (what == EVAL_PDF) {
            sum += sr_bsdf_f_pdf(b, p->wo, p->wi, SR_RADIANCE, &pdf)[0] + pdf;
        } else if (what == SAMPLE) {
            sum += sr_bsdf_sample(b, p->wo, p->u_lobe, p->u, SR_RADIANCE, &s) ? s.pdf : 0;
        } else if (b->model->ready) {
            b->model->ready(b->data, at());
        }
    }
    return sum;
}

struct job {
    const char *only;
    int found;
};

static void measure_all(void *context, int thread)
{
    static struct pair pairs[PAIRS];
    struct job *job = context;
    const char *only = job->only;
    (void)thread;
    volatile float sink = 0;
    for (int m = 0; sr_bsdf_models[m]; ++m) {
        struct sr_arena arena = {0};
        struct sr_bsdf b;
        if ((only && strcmp(only, sr_bsdf_models[m]->name) != 0) || !defaults(sr_bsdf_models[m], &arena, &b)) {
            sr_arena_free(&arena);
            continue;
        }
        ++job->found;
        if (b.model->ready)
            b.model->ready(b.data, at());
        draw(&b, pairs);
        printf("{\"model\":\"%s\",\"wavelengths\":%d", b.model->name, SR_LAMBDA_COUNT);
        for (enum what w = EVAL; w < WHATS; ++w) {
            double ns[RUNS];
            for (int run = 0; run < RUNS; ++run) {
                double start = processor_ns();
                for (int turn = 0; turn < TURNS; ++turn)
                    sink = sink + work(w, &b, pairs);
                ns[run] = (processor_ns() - start) / (TURNS * PAIRS);
            }
            qsort(ns, RUNS, sizeof *ns, by_value);
            printf(",\"%s\":%.1f", names[w], ns[RUNS / 2]);
        }
        printf("}\n");
        fflush(stdout);
        sr_arena_free(&arena);
    }
}

int bench_bsdfs(const char *only)
{
    struct job job = {.only = only};
    sr_parallel(1, measure_all, &job); // as renders run: denormals are flushed
    if (!job.found)
        fprintf(stderr, "sr_bench: there is no model \"%s\" that needs no file\n", only ? only : "");
    return job.found ? 0 : 2;
}
