/* SPDX-License-Identifier: MIT */
/* The models in double precision, as twin.h shows them. Compiled behind prefix.h: float means double here. */
#include "bsdf/bsdf.h"
#include "lab/twin.h"

_Static_assert(sizeof(float) == 8, "this file belongs to the double-precision build");

static sr_vec3 direction(const double w[3])
{
    return (sr_vec3){w[0], w[1], w[2]};
}

static void spread(sr_spectrum s, double out[SR_LAMBDA_COUNT])
{
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        out[i] = s[i];
}

static sr_spectrum gather(const double in[SR_LAMBDA_COUNT])
{
    sr_spectrum s = SR_BLACK;
    for (int i = 0; i < SR_LAMBDA_COUNT; ++i)
        s[i] = in[i];
    return s;
}

sr_status sr_double_make(struct sr_arena *arena, int model, const struct twin_row *rows,
                         const double lambda[SR_LAMBDA_COUNT], uint32_t seed, const void **bsdf, struct sr_error *error)
{
    *bsdf = NULL;
    const struct sr_bsdf_model *m = sr_bsdf_models[model];
    if (!m->name)
        return SR_OK;
    struct sr_bsdf *b = sr_arena_alloc(arena, sizeof *b);
    if (!b)
        return sr_fail(error, SR_ERROR_RESOURCE, "no memory for the double-precision twin of %s", m->name);
    b->model = m;
    for (int i = 0; m->params[i].name; ++i) {
        const struct sr_param *p = &m->params[i];
        void *member = b->data + p->offset;
        if (p->kind == SR_PARAM_FLOAT)
            memcpy(member, &rows[i].number[0], sizeof(double));
        else if (p->kind == SR_PARAM_BOOL)
            memcpy(member, &(bool){rows[i].number[0] != 0}, sizeof(bool));
        else if (p->kind == SR_PARAM_INT || p->kind == SR_PARAM_ENUM)
            memcpy(member, &(int32_t){(int32_t)rows[i].number[0]}, sizeof(int32_t));
        else if (p->kind == SR_PARAM_FILE)
            memcpy(member, &rows[i].file, sizeof rows[i].file);
        else {
            sr_spectrum s = gather(rows[i].number);
            memcpy(member, &s, sizeof s);
        }
    }
    if (m->load && m->load(b->data, arena, error) != SR_OK)
        return error->status;
    struct sr_bsdf_at at = {.lambda = gather(lambda), .seed = seed};
    if (m->ready)
        m->ready(b->data, &at);
    *bsdf = b;
    return SR_OK;
}

void sr_double_f_pdf(const void *bsdf, const double wo[3], const double wi[3], int mode, double f[SR_LAMBDA_COUNT],
                     double *pdf)
{
    spread(sr_bsdf_f_pdf(bsdf, direction(wo), direction(wi), (enum sr_transport)mode, pdf), f);
}

bool sr_double_sample(const void *bsdf, const double wo[3], double u_lobe, const double u[2], int mode,
                      struct twin_sample *s)
{
    struct sr_bsdf_sample sample;
    if (!sr_bsdf_sample(bsdf, direction(wo), u_lobe, (sr_vec2){u[0], u[1]}, (enum sr_transport)mode, &sample))
        return false;
    *s = (struct twin_sample){.wi = {sample.wi.x, sample.wi.y, sample.wi.z},
                              .pdf = sample.pdf,
                              .lobe = sample.lobe,
                              .pdf_is_proportional = sample.pdf_is_proportional};
    spread(sample.f, s->f);
    return true;
}
