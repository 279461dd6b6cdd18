/* SPDX-License-Identifier: MIT */
/* A BSDF in double precision: reads the parameters of one in single precision by its model's table, row by row.
 *
 * The same table stands in both compilations, with offsets of its own in each; derived values are made anew from the
 * parameters. Models that read files have no twin, nor has a sum that contains one. */
#include "lab/twin.h"

#include "lab/lab.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 64 };

struct sr_twin {
    const void *bsdf;
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

sr_status sr_twin_make(struct sr_arena *arena, const struct sr_bsdf *bsdf, sr_spectrum lambda,
                       enum sr_twin_numbers numbers, const struct sr_twin **twin, struct sr_error *error)
{
    *twin = NULL;
    int model = model_index(bsdf->model);
    if (model < 0)
        return SR_OK;
    struct twin_row rows[ROWS] = {0};
    for (int i = 0; bsdf->model->params[i].name; ++i) {
        if (bsdf->model->params[i].kind == SR_PARAM_FILE || i == ROWS)
            return SR_OK;
        read_row(&bsdf->model->params[i], bsdf->data, numbers, &rows[i]);
    }
    double lambdas[SR_LAMBDA_COUNT];
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        lambdas[i] = number(lambda[i], numbers);
    const void *made;
    if (sr_double_make(arena, model, rows, lambdas, 0, &made, error) != SR_OK || !made)
        return error->status;
    struct sr_twin *t = sr_arena_alloc(arena, sizeof *t);
    if (!t)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the double-precision twin of %s", bsdf->model->name);
    t->bsdf = made;
    *twin = t;
    return SR_OK;
}

void sr_twin_f(const struct sr_twin *twin, const double wo[3], const double wi[3], enum sr_transport mode,
               double f[SR_LAMBDA_COUNT])
{
    double unused;
    sr_double_f_pdf(twin->bsdf, wo, wi, mode, f, &unused);
}

double sr_twin_pdf(const struct sr_twin *twin, const double wo[3], const double wi[3], enum sr_transport mode)
{
    double unused[SR_LAMBDA_COUNT], pdf;
    sr_double_f_pdf(twin->bsdf, wo, wi, mode, unused, &pdf);
    return pdf;
}
