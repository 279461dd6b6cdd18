/* SPDX-License-Identifier: MIT */
/* A BSDF in double precision: reads the parameters of one in single precision by its model's table, row by row.
 *
 * The same table stands in both compilations, with offsets of its own in each; derived values are made anew from the
 * parameters. Models of measured data have no twin, nor has a sum that contains one. */
#include "lab/twin.h"

#include "lab/private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 64 };

struct sr_twin {
    int count;
    struct part {
        const void *bsdf;     // in double precision
        double weight, share; // [1] of f; of the density
    } parts[SR_SPECIMEN_PARTS];
};

/* The shortest decimal that rounds to this float. */
static double decimal(float x)
{
    char text[32];
    for (int digits = 1; digits < 9; ++digits) {
        snprintf(text, sizeof text, "%.*g", digits, (double)x);
        if (strtof(text, NULL) == x)
            return strtod(text, NULL);
    }
    return (double)x;
}

static double number(float x, enum sr_twin_numbers numbers)
{
    return numbers == SR_TWIN_DECIMAL ? decimal(x) : (double)x;
}

static int model_index(const struct sr_bsdf_model *model)
{
    for (int i = 0; sr_bsdf_models[i]; ++i)
        if (sr_bsdf_models[i] == model)
            return i;
    return -1;
}

static void read_row(const struct sr_param *p, const unsigned char *data, enum sr_twin_numbers numbers,
                     struct twin_row *row)
{
    const void *member = data + p->offset;
    if (p->kind == SR_PARAM_FLOAT) {
        float x;
        memcpy(&x, member, sizeof x);
        row->number[0] = number(x, numbers);
    } else if (p->kind == SR_PARAM_ALBEDO || p->kind == SR_PARAM_UNBOUNDED) {
        sr_spectrum s;
        memcpy(&s, member, sizeof s);
        for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
            row->number[i] = number(s[i], numbers);
    } else if (p->kind == SR_PARAM_FILE) {
        memcpy(&row->file, member, sizeof row->file);
    } else if (p->kind == SR_PARAM_BOOL) {
        bool flag;
        memcpy(&flag, member, sizeof flag);
        row->number[0] = flag;
    } else {
        int32_t integer;
        memcpy(&integer, member, sizeof integer);
        row->number[0] = integer;
    }
}

static sr_status make_part(struct sr_arena *arena, const struct sr_bsdf *bsdf, sr_spectrum lambda,
                           enum sr_twin_numbers numbers, const void **part, struct sr_error *error)
{
    *part = NULL;
    int model = model_index(bsdf->model);
    if (model < 0)
        return SR_OK;
    struct twin_row rows[ROWS] = {0};
    for (int i = 0; bsdf->model->params[i].name; ++i) {
        if (i == ROWS)
            return SR_OK;
        read_row(&bsdf->model->params[i], bsdf->data, numbers, &rows[i]);
    }
    double lambdas[SR_LAMBDA_COUNT];
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambdas[i] = number(lambda[i], numbers);
    return sr_double_make(arena, model, rows, lambdas, 0, part, error);
}

sr_status sr_twin_make(struct sr_arena *arena, const struct sr_bsdf *bsdf, sr_spectrum lambda,
                       enum sr_twin_numbers numbers, const struct sr_twin **twin, struct sr_error *error)
{
    *twin = NULL;
    struct sum sum = {.parts = bsdf, .count = 1, .weight = {1}, .share = {1}};
    if (bsdf->model == &lab_sum || bsdf->model == &lab_random_sum)
        memcpy(&sum, bsdf->data, sizeof sum);
    struct sr_twin *t = sr_arena_alloc(arena, sizeof *t);
    if (!t)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the double-precision twin of %s", bsdf->model->name);
    for (int j = 0; j < sum.count; ++j) {
        if (!(sum.share[j] > 0)) // reflects nothing
            continue;
        struct part *part = &t->parts[t->count++];
        part->weight = number(sum.weight[j], numbers);
        part->share = (double)sum.share[j];
        if (make_part(arena, &sum.parts[j], lambda, numbers, &part->bsdf, error) != SR_OK)
            return error->status;
        if (!part->bsdf)
            return SR_OK;
    }
    *twin = t;
    return SR_OK;
}

static double f_pdf(const struct sr_twin *t, const double wo[3], const double wi[3], enum sr_transport mode,
                    double f[SR_LAMBDA_COUNT])
{
    double pdf = 0;
    memset(f, 0, SR_LAMBDA_COUNT * sizeof *f);
    for (int j = 0; j < t->count; ++j) {
        double part_f[SR_LAMBDA_COUNT], part_pdf;
        sr_double_f_pdf(t->parts[j].bsdf, wo, wi, mode, part_f, &part_pdf);
        pdf += t->parts[j].share * part_pdf;
        for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
            f[l] += t->parts[j].weight * part_f[l];
    }
    return pdf;
}

void sr_twin_f(const struct sr_twin *twin, const double wo[3], const double wi[3], enum sr_transport mode,
               double f[SR_LAMBDA_COUNT])
{
    f_pdf(twin, wo, wi, mode, f);
}

double sr_twin_pdf(const struct sr_twin *twin, const double wo[3], const double wi[3], enum sr_transport mode)
{
    double unused[SR_LAMBDA_COUNT];
    return f_pdf(twin, wo, wi, mode, unused);
}

int sr_twin_part_count(const struct sr_twin *twin)
{
    return twin->count;
}

bool sr_twin_sample(const struct sr_twin *twin, int part, const double wo[3], double u_lobe, const double u[2],
                    struct twin_sample *s)
{
    const struct part *p = &twin->parts[part];
    if (!sr_double_sample(p->bsdf, wo, u_lobe, u, SR_RADIANCE, s))
        return false;
    for (int l = 0; l < SR_LAMBDA_COUNT; ++l)
        s->f[l] *= p->weight;
    return true;
}
